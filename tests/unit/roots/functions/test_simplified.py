"""Waves that are not reflected leave one exponential, which has no roots."""

from __future__ import annotations

from math import sqrt

import pytest

from symflex import pipeline

HEAD = """
symflex = 1
[parameters]
E = "210 GPa"
A = "3 cm^2"
rho = "7850 kg/m^3"
l = "0.7 m"
m = "2 kg"
k = "1 kN/m"
[definitions]
b = "A*sqrt(E*rho)"
[inputs]
F = { force = "x" }
[outputs]
X = "x"
[elements]
bar = { type = "rod", between = ["x", "y"], E = "E", A = "A", rho = "rho", l = "l" }
end = { type = "damper", between = ["y", "ground"], b = "b" }
"""
IMPEDANCE = 3e-4 * sqrt(210e9 * 7850)


def poles(text):
    model = pipeline.loads(text)
    (bound,) = pipeline.derive_for_roots(model, model.transfer_functions[:1])
    found = pipeline.roots(bound)
    assert found.certificate.certified
    return sorted((float(p.re), float(p.im)) for p in found.poles)


def test_a_rod_with_a_matched_end_is_a_damper_of_its_impedance():
    parts = {
        "": [0],
        'body = { type = "mass", at = "x", m = "m" }': [-IMPEDANCE / 2, 0],
        'spring = { type = "spring", between = ["x", "ground"], k = "k" }': [-1000 / IMPEDANCE],
        'other = { type = "damper", between = ["x", "ground"], b = "2*b" }': [0],
    }
    for part, expected in parts.items():
        found = poles(HEAD + part)
        assert [re for re, _ in found] == pytest.approx(expected, rel=1e-12), part
        assert not any(im for _, im in found), part


def test_a_rod_whose_end_is_nearly_matched_has_its_poles_far_left():
    # exp(2 s l/c) = (b - z)/(b + z) with z the impedance: s = c/(2 l) ln(1/21) + j n pi c/l
    found = poles(
        HEAD.replace('b = "b"', 'b = "1.1*b"')
        .replace('"x", "y"]', '"ground", "y"]')
        .replace('"x" }', '"y" }')
        .replace('X = "x"', 'X = "y"')
    )
    speed = sqrt(210e9 / 7850)
    assert found[0][0] == pytest.approx(speed / 1.4 * -3.044522437723423, rel=1e-9)


def test_a_string_that_absorbs_every_wave_delays_alone():
    text = """
    symflex = 1
    parameters = { N = "100 N", rho = "1000 kg/m^3", A = "10 mm^2", l = "1 m", b = "1 N*s/m" }
    inputs.y_0 = { displacement = "left" }
    outputs.Y = "right"
    elements.wire = { type = "string", between = ["left", "right"], N = "N", rho = "rho", A = "A", l = "l" }
    elements.dash = { type = "damper", between = ["right", "ground"], b = "b" }
    """
    assert not poles(text)
