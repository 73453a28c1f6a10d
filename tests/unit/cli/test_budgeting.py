from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

import pytest

from symflex.cli import COMMANDS
from symflex.cli.budgeting import Memory

FREE_OF_WORK = {"new", "elements", "units"}
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


@pytest.mark.parametrize("command", [c for c in COMMANDS if c not in FREE_OF_WORK])
def test_every_command_that_works_has_a_budget_of_time_and_memory(command, shell):
    text = shell(command, "--help").out
    assert "--budget SECONDS" in text
    assert "--memory SIZE" in text


@pytest.mark.parametrize("given", ["nan", "inf", "-inf", "-1", "0", "1e400", "x", ""])
def test_a_time_that_is_no_positive_number_is_a_usage_error(given, shell):
    done = shell("check", "x.toml", "--budget", given)
    assert (done.code, "--budget" in done.err) == (2, True)


@pytest.mark.parametrize("given", ["nan GB", "0 GB", "-1 GB", "1 kB", "2", "1e3 GB", "GB", "٣ GB"])
def test_a_memory_that_is_no_amount_is_a_usage_error(given, shell):
    done = shell("check", "x.toml", "--memory", given)
    assert (done.code, "--memory" in done.err) == (2, True)


@pytest.mark.parametrize(("given", "bytes_"), [("500 MB", 5 * 10**8), ("4gb", 4 * 10**9), ("1 GiB", 2**30)])
def test_memory_is_read_in_decimal_and_binary_units(given, bytes_):
    assert Memory().convert(given, None, None) == bytes_


@pytest.mark.slow
@linux
def test_a_memory_beyond_what_systems_count_is_no_limit():
    assert ended(started("sys.exit(3)", "--memory", "999999999 TB"))[::2] == (3, "")


def test_a_command_called_from_python_does_not_answer_for_what_its_caller_holds(shell, monkeypatch):
    for place in ("budget.peak_memory", "budget.memory_held", "cli.budgeting.memory_held"):
        monkeypatch.setattr(f"symflex.{place}", lambda: 10**11)
    assert shell("roots", "x.toml").code == 0


@pytest.mark.slow
@linux
def test_what_cannot_be_asked_is_ended_and_said():
    code, out, err = ended(started(ENDLESS, "--budget", "0.5"))
    assert (code, out) == (5, "")
    assert "SF506" in err
    assert "Traceback" not in err


@pytest.mark.slow
@linux
def test_what_takes_more_memory_than_given_is_told_so():
    code, _, err = ended(started("block = bytearray(b'x') * 10**9", "--memory", "500 MB"))
    assert (code, "SF504" in err) == (5, True)


@pytest.mark.slow
@linux
def test_a_library_that_aborts_for_want_of_memory_is_told_so():
    code, _, err = ended(started("from flint import fmpz; x = fmpz(1) << 16 * 10**9", "--memory", "500 MB"))
    assert (code, "SF504" in err) == (5, True)


@pytest.mark.slow
@linux
def test_a_library_that_crashes_is_an_error_with_a_code():
    code, _, err = ended(started("os.kill(os.getpid(), 11)"))
    assert (code, "SF508" in err) == (5, True)


@pytest.mark.slow
@linux
def test_the_exit_code_is_that_of_the_process_that_worked():
    assert ended(started("sys.exit(3)"))[0] == 3


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
@pytest.mark.parametrize("arguments", [("--help",), ("elements",), ("new",), ("check", "x.toml")])
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
