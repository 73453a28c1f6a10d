"""Figures of stability that a specification asks for."""

import pytest

import symflex
from symflex.cli import run
from tests.unit.refusals import refusal

LOOP = """
symflex = 1
parameters = { K = { value = 1, range = [0.1, 4] }, T = { value = "0.5 s", range = ["0.1 s", "2 s"] } }
inputs = { r = {} }
outputs = { Y = "y" }
signals = { y = "K*exp(-s*T)/s*(r - y)" }
[figures.wall]
"""


@pytest.mark.parametrize("over", ['["K", "T"]', '"T"'])
def test_a_named_figure_of_stability_is_drawn(over, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "loop.toml").write_text(f'{LOOP}kind = "stability"\nover = {over}\n')
    assert run(["plot", "loop.toml", "wall"]) == 0
    assert (tmp_path / "loop_wall.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.parametrize(
    ("keys", "code"),
    [
        ('kind = "stability"', "SF214"),
        ('kind = "stability"\nover = ["K", "T", "K"]', "SF208"),
        ('kind = "stability"\nover = []', "SF208"),
        ('kind = "stability"\nover = "Q"', "SF210"),
        ('kind = "bode"\nover = "K"', "SF207"),
    ],
)
def test_what_is_no_figure_of_stability_is_refused(keys, code):
    assert refusal(symflex.loads, LOOP + keys) == f"SpecError {code}"
