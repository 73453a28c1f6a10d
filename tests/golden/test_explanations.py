"""What a reader is told about the zeros of the models in ``derivations/``.

``explanations/MODEL.OUT.IN.txt`` holds what ``symflex roots --explain`` prints below the tables. What it says
is known from the sources: the clamped-free beam from Miu (1991), the winding from the motor's law, the real
pairs from Eppinger and Seering (1988). The numbers are tested elsewhere against independent ones.
"""

import json
from pathlib import Path

import pytest

from symflex.cli import run

EXPLANATIONS = Path(__file__).parent / "explanations"
DERIVATIONS = Path(__file__).parents[2] / "derivations"
NAMES = sorted(path.stem for path in EXPLANATIONS.glob("*.txt"))


def arguments(name):
    model, output, source = name.split(".")
    (path,) = DERIVATIONS.glob(f"*/{model}.toml")
    return ["roots", str(path), "--tf", f"{output}/{source}", "--digits", "8", "--explain"]


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] if n.startswith("robot_axis") else []) for n in NAMES]
)
def test_an_explanation_reads_as_expected(name, capsys):
    assert run(arguments(name)) == 0
    printed = capsys.readouterr().out
    told = printed[printed.index("zeros of ") :]
    assert told == (EXPLANATIONS / f"{name}.txt").read_text(encoding="utf-8")
    assert max(map(len, told.splitlines())) <= 80


def test_json_holds_the_explanation_only_when_asked_for(capsys):
    given = arguments("two_mass.V_act.F")
    assert run([*given, "--json"]) == 0
    explanation = json.loads(capsys.readouterr().out)["explanation"]
    assert explanation["kind"] == "colocated"
    assert explanation["status"] == "proved"
    assert explanation["spec"] == 'hold = { type = "fixed", at = "x_act" }'
    assert explanation["power_of_s"] == 1
    (part,) = explanation["parts"]
    assert (part["elements"], part["poles"], part["driven"]) == (["tip_side", "drive", "damping"], 2, False)
    assert (part["fields"], part["signals"]) == ([], [])
    assert run([a for a in (*given, "--json") if a != "--explain"]) == 0
    assert "explanation" not in json.loads(capsys.readouterr().out)
