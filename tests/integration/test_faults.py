"""Faults injected into commands that write; see tests/tools/faults.py, which runs longer."""

import re
import subprocess
import sys

import pytest

from tests.house.repository import ROOT


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="forks, and limits files as Linux does")
def test_faults_leave_nothing_torn_and_nothing_lost():
    command = [sys.executable, "-m", "tests.tools.faults", "--count", "24"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert sum(map(int, re.findall(r"(\d+) ended the command", done.stdout))) > 9
