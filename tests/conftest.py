"""What all tests share: how a test that runs a program outside Python asks for it."""

from __future__ import annotations

import os
import shutil

import pytest

REQUIRE_TOOLS = "SYMFLEX_REQUIRE_TOOLS"
REASON = "needs the program"


def pytest_runtest_setup(item):
    for marker in item.iter_markers("needs_tool"):
        for name in marker.args:
            _require(name)


def _require(name):
    if shutil.which(name) is not None:
        return
    if os.environ.get(REQUIRE_TOOLS) == "1":
        pytest.fail(f"{REASON} {name}, which is not installed, and {REQUIRE_TOOLS}=1", pytrace=False)
    pytest.skip(f"{REASON} {name}, which is not installed")


def pytest_terminal_summary(terminalreporter):
    lacking = [
        report
        for outcome in ("skipped", "failed", "error")
        for report in terminalreporter.stats.get(outcome, [])
        if REASON in str(report.longrepr)
    ]
    if lacking:
        terminalreporter.write_sep(
            "=", f"{len(lacking)} tests did not run for want of a program outside Python", yellow=True
        )
