"""Printed formulas of members whose coefficients vary along x."""

from __future__ import annotations

import pytest

from symflex import pipeline
from symflex.print.forms import print_form
from symflex.print.json_format import derive_json
from symflex.print.text import derive_text

ROD = """
symflex = 1
parameters = {E = {}, A_0 = {}, rho = {}, l = {}, Z_1 = {}}
[elements.bar]
type = "rod"
between = ["ground", "tip"]
E = "E"
A = "A_0*(1 - x/(2*l))"
rho = "rho"
l = "l"
[inputs]
F = {force = "tip"}
[outputs]
u = "tip"
"""


@pytest.fixture(scope="module")
def rod():
    model = pipeline.loads(ROD)
    (found,) = pipeline.derive_all(model)
    return found


def test_the_differential_equations_of_a_tapered_rod_are_where_lines(rod):
    # u' = f/(E A) and f' = rho A s^2 u (Graff 1975, section 2.1); Z is a parameter's letter here.
    text = derive_text(rod, print_form(rod)).splitlines()
    assert [line.strip() for line in text[2:5]] == ["Y_12(l)", "-------", "Y_22(l)"]
    assert [line.removeprefix("  where").strip() for line in text[6:9]] == [
        "Y_1j' = 2*l/(E*A_0*(2*l - x))*Y_2j",
        "Y_2j' = A_0*rho*s^2*(2*l - x)/(2*l)*Y_1j",
        "Y_ij(0) = delta_ij",
    ]


def test_latex_and_json_hold_the_same_lines(rod):
    entry = derive_json(rod, print_form(rod))
    assert [name for name, _ in entry["laws"]] == ["Y_1j", "Y_2j", "Y_ij"]
    assert r"\frac{Y_{12}(l)}{Y_{22}(l)}" in entry["latex"]
    assert r"\delta_{\mathrm{ij}}" in entry["latex"]
