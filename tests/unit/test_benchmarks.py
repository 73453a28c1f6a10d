"""The command line of the benchmarks, with benchmarks that take no time, and the table of errors."""

import json

import pytest

from benchmarks import __main__ as command
from benchmarks import errors
from benchmarks.measure import Claim, Measured, Measurement


@pytest.fixture
def extents(monkeypatch):
    """Put two benchmarks in place of all, and return what they were asked for, run by run."""
    asked = []

    def good(extent):
        asked.append(("good", extent))
        claims = [Claim("ratio", 2.0, 3.0), Claim("seconds", 9.0, 1.0, is_ratio=False)]
        return Measured([Measurement("a task", "a way", 0.5, extent.limit)], claims, ("a table",))

    def bad(extent):
        asked.append(("bad", extent))
        return Measured([], [Claim("lost", 2.0, 1.0), Claim("stopped", 2.0, float("nan"))])

    monkeypatch.setattr(command, "BENCHMARKS", {"good": good, "bad": bad})
    return asked


def test_benchmarks_that_are_named_run_alone_and_without_names_all(extents):
    assert command.main(["good", "good", "--limit", "7", "--quick"]) == 0
    assert [(name, extent.limit, extent.is_quick) for name, extent in extents] == [("good", 7.0, True)]
    extents.clear()
    assert command.main([]) == 0
    assert [name for name, _ in extents] == ["good", "bad"]


def test_a_name_of_no_benchmark_is_refused_with_those_there_are(extents, capsys):
    with pytest.raises(SystemExit) as refused:
        command.main(["good", "frame"])
    assert refused.value.code == 2
    assert "no benchmark is called 'frame'; there are good, bad" in capsys.readouterr().err
    assert not extents


def test_a_ratio_fails_the_check_after_three_runs_and_a_time_never(extents, capsys):
    assert command.main(["good", "--check"]) == 0
    assert command.main(["bad", "--check"]) == 1
    assert [name for name, _ in extents] == ["good", "bad", "bad", "bad"]
    out = capsys.readouterr().out
    assert "| seconds | at least 9 | 1 | MISSED |" in out
    assert "| stopped | at least 2 | stopped | MISSED |" in out
    assert "\na table\n" in out


def test_a_quick_run_has_ratios_alone(extents, capsys, tmp_path):
    command.main(["--quick", "--json", str(tmp_path / "all.json")])
    assert "seconds" not in capsys.readouterr().out
    claims = json.loads((tmp_path / "all.json").read_text())["claims"]
    assert [(c["text"], c["measured"], c["holds"]) for c in claims] == [
        ("ratio", 3.0, True),
        ("lost", 1.0, False),
        ("stopped", None, False),
    ]


def test_the_documented_table_of_errors_has_every_model_and_target():
    table = errors.documented()
    assert set(table) == set(errors.MODELS)
    assert all(list(row) == list(errors.TARGETS) for row in table.values())
