"""Ctrl-C ends a report and its processes at once, with the exit code of shells and without a traceback."""

import os
import signal
import subprocess
import sys
import time

import pytest

from tests.house.repository import ROOT

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes are found in /proc")

LOADING = """
import sys, time
class Slow:
    def find_spec(self, name, *_):
        if name == "symflex.cli":
            print("loading", flush=True)
            time.sleep(60)
sys.meta_path.insert(0, Slow())
from symflex.__main__ import main
main()
"""
AGAIN = """
import signal
from symflex import cli
def work(*_, **__):
    try:
        signal.raise_signal(signal.SIGINT)
    except KeyboardInterrupt:
        signal.raise_signal(signal.SIGINT)
        return cli.STOPPED
cli.run = work
cli.main([])
"""


def started(*arguments):
    """Start Python in a session of its own, which listens to Ctrl-C whatever started the tests."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        return subprocess.Popen(
            [sys.executable, *arguments],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
        )
    finally:
        signal.signal(signal.SIGINT, before)


def in_session(session):
    """Return the processes of a session that have not ended."""
    found = []
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{name}/stat") as file:
                state, _, _, own = file.read().rpartition(")")[2].split()[:4]
        except OSError:
            continue
        found += [int(name)] if int(own) == session and state != "Z" else []
    return found


def test_ctrl_c_while_the_command_line_is_loaded_leaves_no_traceback():
    process = started("-c", LOADING)
    assert process.stdout.readline() == "loading\n"
    process.send_signal(signal.SIGINT)
    assert process.communicate(timeout=20) == ("", "stopped\n")
    assert process.returncode == 130


def test_a_second_ctrl_c_does_not_meet_the_program_while_it_ends():
    process = started("-c", AGAIN)
    assert process.communicate(timeout=20) == ("", "")
    assert process.returncode == 130


@pytest.mark.slow
@pytest.mark.parametrize("is_group", [True, False])
@pytest.mark.parametrize("moment", [0.3, 1.0, 3.0, "workers"])
def test_ctrl_c_ends_a_report_and_its_workers(tmp_path, is_group, moment):
    folder = ROOT / "derivations" / "eppinger1988"
    process = started("-m", "symflex", "report", str(folder), "-o", str(tmp_path / "r"), "--jobs", "2")
    if moment == "workers":
        deadline = time.monotonic() + 120
        while len(in_session(process.pid)) < 5 and time.monotonic() < deadline:  # two, and what starts these
            time.sleep(0.1)
        time.sleep(2)
    else:
        time.sleep(moment)
    if is_group:
        os.killpg(process.pid, signal.SIGINT)
    else:
        process.send_signal(signal.SIGINT)
    begun = time.monotonic()
    _, err = process.communicate(timeout=60)
    assert time.monotonic() - begun < 10
    assert (process.returncode, "Traceback" in err) == (130, False), err
    assert err.rstrip().endswith("stopped")
    while in_session(process.pid) and time.monotonic() - begun < 10:
        time.sleep(0.05)
    assert in_session(process.pid) == []
