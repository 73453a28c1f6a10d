import signal
import subprocess
import sys
import time

import pytest

from tests.house.repository import ROOT
from tests.unit.cli.commands import OSCILLATOR

PATIENCE = 30  # seconds within which a loaded machine has printed


def until(stream, text):
    """Read lines until one has a text."""
    end = time.monotonic() + PATIENCE
    lines = []
    while time.monotonic() < end:
        lines.append(stream.readline())
        if text in lines[-1]:
            return lines
    raise AssertionError(lines)


@pytest.mark.skipif(sys.platform == "win32", reason="Ctrl-C is sent as a signal")
def test_a_watched_command_runs_again_when_its_file_is_saved_and_ends_with_ctrl_c(tmp_path):
    file = tmp_path / "x.toml"
    file.write_text(OSCILLATOR)
    command = [sys.executable, "-m", "symflex", "check", str(file), "--watch"]
    with subprocess.Popen(
        command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, bufsize=1
    ) as process:
        try:
            assert any("x.toml: ok" in line for line in until(process.stdout, "watching"))
            file.write_text(OSCILLATOR.replace("18 N/m", "18 N/mm/mm"))
            assert any("error[SF203]" in line for line in until(process.stdout, "watching"))
            (tmp_path / "beside.toml").write_text("")
            until(process.stdout, "watching")
        finally:
            process.send_signal(signal.SIGINT)
        assert process.wait(PATIENCE) == 0
