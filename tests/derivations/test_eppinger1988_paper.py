"""The paper's own LaTeX, judged: what is right, and every misprint of V_act/F.

The right formulas are those of sliding_free_beam.toml, checked to 30 digits against solves that share no code
(tests/derivations/test_eppinger1988_beams.py).
"""

import pytest

from symflex import pipeline
from symflex.papers.source import read_paper
from symflex.report.referee import referee
from tests.house.repository import ROOT

FOLDER = ROOT / "derivations" / "eppinger1988"


def judged(*models):
    loaded = [pipeline.load(FOLDER / f"{name}.toml") for name in models]
    return {j.label: j for j in referee(read_paper(FOLDER / "formulas.tex"), loaded)}


@pytest.mark.slow
def test_the_rigid_body_and_the_cascade_of_resonances_are_right_as_printed():
    found = judged("rigid_body", "polynomial_resonance")
    assert [found[f"eq:{name}"].verdict for name in ("rb", "acc", "cascade")] == ["equal"] * 3
    assert found["eq:resonance"].reason.startswith("it defines R_i")


@pytest.mark.slow
def test_every_misprint_of_the_sliding_beam_is_named():
    found = judged("sliding_free_beam")
    said = found["eq:act"].slip
    assert found["eq:act"].verdict == "different"
    for slip in (
        "brackets are missing",
        "the bar of a root is too short",
        "2*C^2 should be 6*C^2",
        "-1 should be -1/2",
    ):
        assert slip in said
    assert "it is sqrt(E*I*rho*A) times the derived function" in found["eq:tip"].slip
