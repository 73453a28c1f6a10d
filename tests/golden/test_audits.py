"""Printed formulas, right and wrong, and what a reader is told about them.

Each ``audit/NAME.toml`` holds printed formulas; ``audit/NAME.txt`` holds the whole output of
``symflex audit NAME.toml``. What is wrong with each formula is known beforehand: the paper's colocated beam
has 2*C^2 for 6*C^2 and -1 for -1/2 (checked against a boundary-value solve), the others were made wrong.
"""

from pathlib import Path

import pytest

from symflex.cli import run

AUDITS = Path(__file__).parent / "audit"
NAMES = sorted(path.stem for path in AUDITS.glob("*.toml"))


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] if n == "paper_beam" else []) for n in NAMES]
)
def test_an_audit_reads_as_expected(name, monkeypatch, capsys):
    monkeypatch.chdir(AUDITS)
    assert run(["audit", f"{name}.toml"]) == 0
    assert capsys.readouterr().out == (AUDITS / f"{name}.txt").read_text(encoding="utf-8")


def test_every_expectation_has_its_specification():
    assert sorted(path.stem for path in AUDITS.glob("*.txt")) == NAMES


def printed(name):
    return (AUDITS / f"{name}.txt").read_text(encoding="utf-8")


def test_the_papers_colocated_formula_needs_six_c_squared_and_one_half():
    rows = [line.split() for line in printed("paper_beam").splitlines()]
    assert ["numerator", "2*C^2", "6*C^2"] in rows
    assert ["factor", "-1", "-1/2"] in rows


def test_the_papers_colocated_numerator_is_a_square():
    assert "(C^2 + S^2 + 1)^2" in printed("paper_beam")


def test_the_papers_tip_formula_is_proved():
    assert "V_tip/F   proved equal" in printed("paper_beam")


def test_the_papers_rigid_body_formula_is_proved():
    assert "V_tip/V_cmd   proved equal" in printed("rigid_body")
