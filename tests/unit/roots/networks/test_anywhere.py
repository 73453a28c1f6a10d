"""Poles and zeros with losses, loops, delays and sensors elsewhere, against closed forms."""

from __future__ import annotations

from fractions import Fraction
from math import log, pi

import pytest

from symflex.roots.region import Band, Mode, Modes, Rectangle
from tests.unit.roots.networks.network_models import BEAM, located, omegas, specification

ROD = 'type = "rod", E = "1 Pa", A = "1 m^2", rho = "1 kg/m^3"'
"""Unit stiffness, unit mass per length: waves travel a metre in a second."""


def dashpot(b, node="a"):
    return f'd = {{ type = "damper", between = ["{node}", "ground"], b = "{b} N*s/m" }}'


def damped_rod(b):
    """Return a rod of a metre, in two pieces, with a dashpot at its tip."""
    pieces = [
        f'r_{i} = {{ {ROD}, l = "0.5 m", between = ["{a}", "{c}"] }}'
        for i, (a, c) in enumerate((("ground", "m"), ("m", "a")))
    ]
    return specification("\n".join([*pieces, dashpot(b)]))


@pytest.mark.parametrize("b", [0.3, 0.9])
def test_a_rod_with_a_dashpot_has_its_poles_on_a_line(b):
    # cosh s + b sinh s = 0: s = ln((1 - b)/(1 + b))/2 + j pi (k + 1/2).
    found = located(damped_rod(b), Modes(4))
    assert found.certificate.certified
    assert found.certificate.engine == "cramer"
    assert omegas(found.poles) == pytest.approx([pi * (k + 0.5) for k in range(4)], rel=1e-11)
    for pole in found.poles:
        assert float(pole.re) == pytest.approx(log((1 - b) / (1 + b)) / 2, rel=1e-11)


def test_zeros_of_a_damped_rod_at_its_tip_are_those_of_the_clamped_one():
    found = located(damped_rod(0.3), Modes(3))
    assert omegas(found.zeros) == pytest.approx([pi, 2 * pi, 3 * pi], rel=1e-11)


def test_what_is_passive_is_stable():
    assert located(damped_rod(0.3), Modes(2)).verdict.word == "stable"


def test_a_dashpot_that_supplies_energy_puts_poles_into_the_right_half_plane():
    found = located(damped_rod(-0.3), Modes(2))
    assert found.verdict.word == "unstable"
    assert all(float(pole.re) == pytest.approx(log(1.3 / 0.7) / 2, rel=1e-9) for pole in found.poles)


def test_a_strong_dashpot_has_real_poles():
    # b > 1: s = ln((b - 1)/(b + 1))/2 + j pi k.
    found = located(damped_rod(3.0), Modes(3))
    real = [pole for pole in found.poles if pole.is_real]
    assert [float(pole.re) for pole in real] == pytest.approx([log(0.5) / 2], rel=1e-11)


def test_forty_digits_are_correct():
    found = located(damped_rod(3.0), Modes(1), 40)
    # ln(1/2)/2 to forty digits.
    assert found.poles[0].decimal(40).re.startswith("-0.346573590279972654708616060729088284")


@pytest.mark.parametrize(
    ("region", "count"),
    [
        (Band(Fraction(1, 5), Fraction(1)), 2),
        (Rectangle(Fraction(-1), Fraction(0), Fraction(0), Fraction(8)), 3),
        (Mode(3), 2),
    ],
)
def test_regions_hold_what_lies_in_them(region, count):
    # abs(s)/(2 pi) is about 0.26, 0.75, 1.25; of a mode both conjugates are shown.
    poles = located(damped_rod(0.3), region).poles
    assert len(poles) == count if not isinstance(region, Band) else len(poles) == 4


def test_zeros_of_a_sensor_elsewhere_may_be_real():
    # Force at a cantilever's tip, deflection in its middle: zeros +-sigma (Spector & Flashner 1990).
    elements = "\n".join(
        f'b_{i} = {{ {BEAM}, l = "0.25 m", between = ["{a}", "{b}"] }}'
        for i, (a, b) in enumerate((("ground", "m"), ("m", "a")))
    )
    found = located(specification(elements, outputs='X = "m.y"'), Modes(3))
    assert found.certificate.certified
    assert found.certificate.engine == "wittrick-williams, cramer"
    assert any(zero.is_real for zero in found.zeros)
    assert all(zero.is_real or zero.on_imaginary_axis for zero in found.zeros)
    assert all(pole.on_imaginary_axis for pole in found.poles)


def test_a_members_force_is_read():
    # Force in a rod held at one end, at that end: 1/cosh: no zeros at all, so fewer than asked for are found.
    text = specification(f'r = {{ {ROD}, l = "1 m", between = ["a", "ground"] }}', outputs='X = "r.f"')
    found = located(text, Band(Fraction(0), Fraction(1)))
    assert found.zeros == ()
    assert omegas(found.poles) == pytest.approx([pi * 0.5, pi * 1.5], rel=1e-11)
    assert all(pole.on_imaginary_axis for pole in found.poles)


def test_a_free_rod_with_a_dashpot_has_one_pole_at_rest():
    # It comes to rest anywhere: s (sinh s + b cosh s) = 0.
    elements = f'r = {{ {ROD}, l = "1 m", between = ["a", "c"] }}\n' + dashpot(0.3, "c")
    found = located(specification(elements), Modes(2))
    assert [pole.multiplicity for pole in found.poles if pole.is_zero] == [1]


def test_a_delayed_loop_has_the_poles_of_its_equation():
    # k = 1: s^2 m + c s + K exp(-s T) = 0 on a mass, without any member: only the delay is distributed.
    text = """symflex = 1
[elements]
m = { type = "mass", at = "a", m = "1 kg" }
d = { type = "damper", between = ["a", "ground"], b = "2 N*s/m" }
f = { type = "force_source", at = "a", f = "K*D*(r - a)" }
[parameters]
K = "3 N/m"
[blocks]
D = { type = "delay", T = "0.5 s" }
[inputs]
r = {}
[outputs]
X = "a"
"""
    from mpmath import findroot, mp

    found = located(text, Band(Fraction(0), Fraction(3)), source="r")
    assert found.certificate.certified
    for pole in found.poles:
        s = complex(float(pole.re), float(pole.im))
        root = findroot(lambda z: z * z + 2 * z + 3 * mp.exp(-z / 2), s)
        assert complex(root) == pytest.approx(s, rel=1e-10)
