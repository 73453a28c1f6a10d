import os
import signal
import subprocess
import sys
import time

import pytest

from symflex.cli import COMMANDS
from symflex.cli.budgeting import Memory

FREE_OF_WORK = {"new", "examples", "elements", "units", "schema", "lsp"}
ENDLESS = "while True: pass"
SELF = """
import sys, os, signal
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell ignores it for what it runs beside itself
from symflex.cli import main, budgeting
from symflex.cli import formulas
import symflex.pipeline
def load(*given, **more):
    {body}
symflex.pipeline.load = load
main(["check", "x.toml", *sys.argv[1:]])
"""
linux = pytest.mark.skipif(sys.platform != "linux", reason="elsewhere a command is not watched")


def started(body, *options):
    """Start a command that does something else in place of reading its specification."""
    code = SELF.format(body=body)
    return subprocess.Popen(
        [sys.executable, "-c", code, *options], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def ended(process):
    try:
        out, err = process.communicate(timeout=120)
    except subprocess.TimeoutExpired:
        process.kill()  # and with it what works for it
        raise
    return process.returncode, out, err


def test_every_command_that_works_has_a_budget_of_time_and_memory(shell):
    for command in [c for c in COMMANDS if c not in FREE_OF_WORK]:
        text = shell(command, "--help").out
        assert "--budget SECONDS" in text, command
        assert "--memory SIZE" in text, command


def test_a_time_that_is_no_positive_number_is_a_usage_error(shell):
    for given in ("nan", "inf", "-inf", "-1", "0", "1e400", "x", ""):
        done = shell("check", "x.toml", "--budget", given)
        assert (done.code, "--budget" in done.err) == (2, True), given


def test_a_memory_that_is_no_amount_is_a_usage_error(shell):
    for given in ("nan GB", "0 GB", "-1 GB", "1 kB", "2", "1e3 GB", "GB", "٣ GB"):
        done = shell("check", "x.toml", "--memory", given)
        assert (done.code, "--memory" in done.err) == (2, True), given


def test_memory_is_read_in_decimal_and_binary_units():
    for given, bytes_ in (("500 MB", 5 * 10**8), ("4gb", 4 * 10**9), ("1 GiB", 2**30)):
        assert Memory().convert(given, None, None) == bytes_, (given, bytes_)


def test_a_command_called_from_python_does_not_answer_for_what_its_caller_holds(shell, monkeypatch):
    for place in ("budget.peak_memory", "budget.memory_held", "cli.budgeting.memory_held"):
        monkeypatch.setattr(f"symflex.{place}", lambda: 10**11)
    assert shell("roots", "x.toml").code == 0


@pytest.mark.slow
@linux
def test_what_ends_a_command_is_said_with_its_code():
    """A budget of time that nobody asks, one of memory, libraries that abort or crash, an exit of its own."""
    for body, options, code, said in (
        (ENDLESS, ("--budget", "0.5"), 5, "SF506"),
        # A bytearray would say of itself that its buffers are exported: CPython drops it half made.
        ("block = b'x' * 10**9", ("--memory", "500 MB"), 5, "SF504"),
        ("from flint import fmpz; x = fmpz(1) << 16 * 10**9", ("--memory", "500 MB"), 5, "SF504"),
        ("os.kill(os.getpid(), 11)", (), 5, "SF508"),
        ("os.write(2, b'Impossible inverse'); os.abort()", (), 5, "crashed: Impossible inverse"),
        ("sys.exit(3)", (), 3, ""),
        # Beyond what systems count it is no limit.
        ("sys.exit(3)", ("--memory", "999999999 TB"), 3, ""),
    ):
        found = ended(started(body, *options))
        assert found[:2] == (code, ""), (body, options)
        assert said in found[2] if said else not found[2], (body, options)
        assert "Traceback" not in found[2], (body, options)
        assert found[2].startswith("error[SF") or not said, (body, options)


def worker_of(process):
    """Return the process that does the work of another, once it is there."""
    path = f"/proc/{process.pid}/task/{process.pid}/children"
    for _ in range(2000):
        with open(path) as file:
            children = file.read().split()
        if children:
            return int(children[0])
        time.sleep(0.01)
    pytest.fail("no process works")


def is_gone(pid):
    for _ in range(2000):
        try:
            with open(f"/proc/{pid}/stat") as file:
                if file.read().split()[2] == "Z":
                    return True
        except OSError:
            return True
        time.sleep(0.01)
    return False


@pytest.mark.slow
@linux
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
def test_a_signal_is_passed_on(name):
    process = started(ENDLESS)
    worker = worker_of(process)
    time.sleep(0.5)
    os.kill(process.pid, getattr(signal, name))
    code, _, err = ended(process)
    assert (code, "Traceback" in err) == (128 + getattr(signal, name), False)
    assert is_gone(worker)


@pytest.mark.slow
@linux
def test_the_work_ends_with_who_watches_it():
    process = started(ENDLESS)
    worker = worker_of(process)
    time.sleep(0.5)
    process.kill()
    assert ended(process)[0] == -signal.SIGKILL
    assert is_gone(worker)


FULL = pytest.mark.skipif(not os.path.exists("/dev/full"), reason="there is no full device")


@FULL
@pytest.mark.parametrize("arguments", [("--help",), ("check", "x.toml")], ids=" ".join)
def test_what_cannot_be_printed_is_an_error_with_a_code(arguments, shell):
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "symflex", *arguments],
            cwd=shell.folder,
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert (done.returncode, "SF903" in done.stderr, "Traceback" in done.stderr) == (2, True, False)


def test_a_program_without_standard_output_works(shell):
    code = "import os, sys; os.close(1); os.execv(sys.executable, [sys.executable, '-m', 'symflex', 'new'])"
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, cwd=shell.folder, stderr=subprocess.PIPE, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
