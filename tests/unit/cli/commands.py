"""Running the command line inside the test's process."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import pytest

from symflex.cli import run

ROOT = Path(__file__).parents[3]
WORKED = ROOT / "derivations"
TWO_MASS = WORKED / "eppinger1988" / "two_mass.toml"

# Undamped on purpose: the roots are 0 and +-j sqrt(k/m), that is +-3j.
OSCILLATOR = """
symflex = 1
title = "Mass on a spring"
parameters = { m = "2 kg", k = "18 N/m" }
inputs  = { F = { force = "x" } }
outputs = { X = "x", V = "s*x" }
[elements]
body = { type = "mass", at = "x", m = "m" }
wall = { type = "spring", between = ["x", "ground"], k = "k" }
[figures.paper]
kind = "bode"
of = ["V/F"]
[figures.later]
kind = "step"
"""
SYMBOLIC = OSCILLATOR.replace('m = "2 kg"', "m = {}")
WRONG = OSCILLATOR.replace('"18 N/m"', '"18 N"').replace('"s*x"', '"s*y"')
FLOATING = OSCILLATOR.replace('m = "m"', 'm = "0*m"').replace('k = "k"', 'k = "0*k"')


@dataclass(frozen=True)
class Result:
    """What one command did."""

    code: int
    out: str
    err: str

    @property
    def json(self):
        return json.loads(self.out)


class Shell:
    """A folder with the models above, and the command line run there."""

    def __init__(self, folder, capture):
        self.folder = folder
        self._capture = capture

    def __call__(self, *arguments):
        self._capture.readouterr()
        code = run([str(a) for a in arguments])
        captured = self._capture.readouterr()
        return Result(code, captured.out, captured.err)


@pytest.fixture
def shell(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name, text in {"x": OSCILLATOR, "symbolic": SYMBOLIC, "wrong": WRONG, "floating": FLOATING}.items():
        (tmp_path / f"{name}.toml").write_text(text, encoding="utf-8")
    return Shell(tmp_path, capsys)
