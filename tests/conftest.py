"""What tests share: one thread each, how one asks for a program or a library, and what each costs."""

import os
import shutil
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

# Tests run side by side: threads that wait for each other in small matrices only double the work.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# Hundreds of tests start the program anew. Where bytecode is not kept, each compiles the whole package first.
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

# Neither how fast a machine is nor chance decides whether a test passes; new cases are what fuzzing is for.
settings.register_profile(
    "same",
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
    derandomize=True,
    database=None,
    print_blob=False,
)
settings.load_profile("same")

REQUIRE_TOOLS = "SYMFLEX_REQUIRE_TOOLS"
REASON = "which is not installed"
TEST_TIMES = "SYMFLEX_TEST_TIMES"
"""Names a file; every test adds a line with its seconds of CPU, ``quick`` or ``slow``, and its name."""


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item):
    before = _seconds_of_cpu()
    result = yield
    if file := os.environ.get(TEST_TIMES):
        kind = "slow" if item.get_closest_marker("slow") else "quick"
        with Path(file).open("a", encoding="utf-8") as times:
            times.write(f"{_seconds_of_cpu() - before:.2f} {kind} {item.nodeid}\n")
    return result


def _seconds_of_cpu():
    """Return what this process and those it has waited for have used so far."""
    return sum(os.times()[:4])


def pytest_runtest_setup(item):
    for marker in item.iter_markers("needs_tool"):
        for name in marker.args:
            _require("program", name, shutil.which(name) is not None)
    for marker in item.iter_markers("needs_module"):
        for name in marker.args:
            _require("library", name, find_spec(name) is not None)


def _require(kind, name, is_there):
    if is_there:
        return
    if os.environ.get(REQUIRE_TOOLS) == "1":
        pytest.fail(f"needs the {kind} {name}, {REASON}, and {REQUIRE_TOOLS}=1", pytrace=False)
    pytest.skip(f"needs the {kind} {name}, {REASON}")


def pytest_terminal_summary(terminalreporter):
    lacking = [
        report
        for outcome in ("skipped", "failed", "error")
        for report in terminalreporter.stats.get(outcome, [])
        if REASON in str(report.longrepr)
    ]
    if lacking:
        terminalreporter.write_sep(
            "=", f"{len(lacking)} tests did not run for want of a program or library", yellow=True
        )
