"""Poles and zeros of distributed systems, against characteristic equations solved by mpmath."""

import cmath
import itertools
import re
from fractions import Fraction
from importlib import import_module

import mpmath
import numpy as np
import pytest
from mpmath import cos, cosh, findroot, mp, mpc, mpf, pi, sin, sinh, sqrt, tan, tanh

from symflex import pipeline
from symflex.analysis.response import respond
from symflex.balls import precision
from symflex.errors import BudgetError, ModelError
from symflex.roots import Band, Budget, Mode, Modes, Rectangle
from symflex.roots.counting import winding
from symflex.roots.distributed.side import Proof, Side
from symflex.roots.locate import locate
from symflex.roots.root import overlap
from tests.unit.roots.distributed_models import (
    BEAM,
    DELAY_LOOP,
    FREE,
    KELVIN_VOIGT,
    PARAMETERS,
    SLIDING_FREE,
    bound,
)
from tests.unit.roots.stand_ins import poles_by

DIGITS = 40


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(DIGITS + 15):
        yield


def found(text, region, number=0, digits=DIGITS):
    return pipeline.roots(bound(text, number), region, digits)


def upper(roots):
    """Return the roots with im >= 0 as numbers of mpmath, without those at 0."""
    printed = [root.decimal(DIGITS) for root in roots if not root.is_zero]
    return [mpc(p.re, p.im) for p in printed if not p.im.startswith("-")]


def agree(computed, expected, digits=DIGITS - 1):
    assert len(computed) == len(expected)
    for one, other in zip(computed, expected, strict=True):
        assert abs(one - other) <= mpf(10) ** -digits * abs(other)


def test_poles_and_zeros_of_the_sliding_free_beam_are_those_of_its_equations():
    shown = found(SLIDING_FREE, Modes(3))
    poles, zeros = upper(shown.poles), upper(shown.zeros)
    # On the axis, with s = j x^2: tan x + tanh x = 0, and sinh 2q + sin 2q = 0 as the source prints it.
    x = [findroot(lambda x: tan(x) + mpmath.tanh(x), (n - mpf(1) / 4) * pi) for n in range(1, 4)]
    agree(poles, [mpc(0, each**2) for each in x])
    for s in poles:
        q = sqrt(s / 2)
        assert abs(sinh(2 * q) + sin(2 * q)) < mpf(10) ** -(DIGITS - 8) * abs(sinh(2 * q)), s
    # The actuator held: clamped-free, cos x cosh x = -1 with s = j x^2, and 2 + cosh 2q + cos 2q = 0.
    x = [findroot(lambda x: cos(x) + 1 / cosh(x), (n - mpf(1) / 2) * pi) for n in range(1, 4)]
    agree(zeros, [mpc(0, each**2) for each in x])
    q = sqrt(zeros[2] / 2)
    assert abs(2 + cosh(2 * q) + cos(2 * q)) < mpf(10) ** -(DIGITS - 8) * abs(cosh(2 * q))
    # Both members of each pair are listed by frequency, after the pole at 0, and radii hold the error.
    assert [(root.im > 0, root.im < 0) for root in shown.poles] == [
        (False, False),
        *[(True, False), (False, True)] * 3,
    ]
    for root, s in zip((root for root in shown.poles if root.im > 0), poles, strict=True):
        assert abs(mpf(root.decimal(15).im) - s.imag) <= mpf(root.decimal(15).radius)


def test_tip_zeros_of_the_sliding_free_beam_are_real_pairs_where_cos_q_cosh_q_vanishes():
    # q = (n - 1/2) pi, s = +-2 q^2.
    expected = [sign * 2 * ((n - mpf(1) / 2) * pi) ** 2 for n in (1, 2, 3) for sign in (-1, 1)]
    zeros = found(SLIDING_FREE, Modes(3), 1).zeros
    agree(upper(zeros), expected)
    assert all(root.is_real for root in zeros)


@pytest.mark.slow
def test_where_kelvin_voigt_poles_accumulate_a_neighbourhood_is_left_out_and_all_others_are_found():
    eta, expected = mpf("0.004"), []
    for n in range(1, 60):
        w = (n * pi) ** 2
        if eta * w > 2:
            both = [-eta * w**2 / 2 * (1 + sign * sqrt(1 - 4 / (eta * w) ** 2)) for sign in (1, -1)]
            expected += [s for s in both if -1000 < s < -262.5]
    result = found(
        KELVIN_VOIGT, Rectangle(Fraction(-1000), Fraction(0), Fraction(-1), Fraction(1)), digits=12
    )
    outside = [s.real for s in upper(result.poles) if s.real < -262.5]
    agree(sorted(outside), sorted(expected), 11)
    # A rectangle of 5 % each way in ln(s), and the disc that holds it.
    (part,) = result.excluded
    assert (part.re, part.im) == pytest.approx((-250, 0))
    assert part.radius == pytest.approx(250 * abs(cmath.exp(0.05 + 0.05j) - 1))


def test_a_root_counted_twice_has_its_multiplicity():
    # Two equal sliding-free beams in a row of signals: every pole is double.
    text = (
        SLIDING_FREE.replace('V_tip = "s*q"', 'V_tip = "s*q"\nboth = "y"')
        .replace(
            "[inputs]",
            f"""
arm_2   = {{ type = "beam", between = ["p_2", "q_2"], {'E = "E", I = "I", rho = "rho", A = "A"'}, l = "l" }}
slide_2 = {{ type = "slider", at = "p_2" }}
push    = {{ type = "force_source", at = "p_2", f = "p*k" }}
[signals]
y = "p_2"
[inputs]""",
        )
        .replace('l   = "1 m"', 'l   = "1 m"\nk = "1 N/m"')
    )
    poles = [root for root in found(text, Modes(4), 2, digits=20).poles if root.im > 0]
    assert [root.multiplicity for root in poles] == [2, 2]


def test_a_search_beyond_its_budget_says_what_it_found(monkeypatch):
    monkeypatch.setattr(winding, "WORK_LIMIT", 12_000)
    result = found(DELAY_LOOP, Modes(30), digits=12)
    expected = sorted((2 * mpmath.lambertw(-1, k) for k in range(31)), key=abs)
    poles = upper(result.poles)
    agree(poles, expected[: len(poles)], 11)
    assert 0 < len(poles) < 30
    assert result.certificate.is_exceeded
    assert not result.certificate.certified
    assert re.search(r"takes too long; \d+ modes were found up to .* Hz", result.certificate.reason)


def test_a_million_modes_are_refused_at_once():
    with pytest.raises(BudgetError, match="SF505"):
        found(SLIDING_FREE, Modes(10**6))


# -------------------------------------- what each engine accepts, that they agree, and modes by number


def sliding_free(n):
    """Return omega of a mode of the sliding-free beam: s = j x^2 with tan x + tanh x = 0."""
    return findroot(lambda x: tan(x) + tanh(x), (n - mpf(1) / 4) * pi) ** 2


def agrees(root, omega):
    printed = root.decimal(DIGITS)
    return abs(mpf(printed.im) - omega) <= mpf(printed.radius) < mpf(10) ** (2 - DIGITS) * omega


def poles_of(region, engine):
    return poles_by(engine, bound(SLIDING_FREE, 0), region, DIGITS)


def test_two_hundred_modes_are_complete_and_on_the_axis():
    poles = [root for root in poles_of(Modes(200), "lossless") if root.im > 0]
    assert len(poles) == 200
    assert all(root.on_imaginary_axis for root in poles)
    assert all(agrees(poles[n - 1], sliding_free(n)) for n in (1, 2, 57, 199, 200))


def test_a_mode_is_found_by_its_number():
    for number in [1, 2, 3, 10, 1000, 10**6]:
        upper, lower = poles_of(Mode(number), "lossless")
        assert agrees(upper, sliding_free(number))
        assert lower.im < 0, number


def test_a_mode_beyond_the_last_is_none():
    lumped = bound("symflex = 1\n[elements]\nm = { type = 'mass', at = 'x', m = '1 kg' }\n"
                   "k = { type = 'spring', between = ['x', 'ground'], k = '1 N/m' }\n"
                   "[inputs]\nF = { force = 'x' }\n[outputs]\nX = 'x'\n", 0)  # fmt: skip
    assert len(locate(lumped, Mode(1), 15).poles) == 2
    assert locate(lumped, Mode(2), 15).poles == ()


SMALL = Fraction(1, 10**6)


def test_a_region_about_0_holds_the_rigid_body_poles_only():
    for text, region in (
        (FREE, Rectangle(-SMALL, SMALL, -SMALL, SMALL)),
        (FREE, Rectangle(Fraction(0), Fraction(0), Fraction(0), Fraction(0))),
        (FREE, Band(Fraction(0), SMALL)),
        (FREE, Band(Fraction(0), Fraction(0))),
        (KELVIN_VOIGT, Rectangle(-SMALL, SMALL, -SMALL, SMALL)),
    ):
        shown = locate(bound(text, 0), region, 15)
        assert shown.certificate.certified, region
        assert [root.multiplicity for root in shown.poles] == ([2] if text is FREE else []), region


# ----------------------------------------------------------------------- poles and zeros that coincide


# Rods of equal travel time between ground and a mass: that they swing against each other while it rests is
# hidden, at n pi.
TWO_RODS = """
symflex = 1
[parameters]
E     = "1 Pa"
rho   = "1 kg/m^3"
E_2   = "3 Pa"
rho_2 = "3 kg/m^3"
A     = "1 m^2"
l     = "1 m"
[elements]
one  = { type = "rod", between = ["x", "ground"], E = "E", rho = "rho", A = "A", l = "l" }
two  = { type = "rod", between = ["x", "ground"], E = "E_2", rho = "rho_2", A = "A", l = "l" }
mass = { type = "mass", at = "x", m = "2 kg" }
[inputs]
F = { force = "x" }
[outputs]
N = "one.f"
"""


def resting_hub():
    model = pipeline.loads(TWO_RODS)
    with pytest.MonkeyPatch.context() as patch:  # so that the search meets what is common to both rods
        patch.setattr(import_module("symflex.transfer.bind"), "_in_step", lambda *_: [])
        return pipeline.derive_bound(model, model.transfer_functions)[0]


@pytest.mark.slow
@pytest.mark.parametrize("is_counted_at_once", [True, False])
def test_a_search_repeated_with_proof_keeps_hidden_modes_hidden(monkeypatch, is_counted_at_once):
    if not is_counted_at_once:
        monkeypatch.setattr(Side, "counted", lambda self: Proof(0, 0, "for this test"))
    shown = locate(resting_hub(), Modes(2), 12)
    assert ("subdivision" in shown.certificate.engine) is not is_counted_at_once
    assert shown.certificate.certified
    # 2 s^2 + 4 s coth(s) = 0 on s = j w: w = 2 cot(w), one root in each interval (n pi, (n + 1/2) pi).
    expected = [
        findroot(lambda w: w * sin(w) - 2 * cos(w), (n * pi, (n + mpf(1) / 2) * pi), solver="anderson")
        for n in range(2)
    ]
    assert [float(root.im) for root in shown.poles if root.im > 0] == pytest.approx(
        [float(w) for w in expected]
    )
    assert shown.zeros == ()
    assert [float(h.root.im) for h in shown.hidden if h.root.im > 0] == pytest.approx([float(pi)])
    assert {h.cause for h in shown.hidden} == {"coincident"}


@pytest.mark.slow
def test_no_root_of_a_search_broken_off_is_a_pole_and_a_zero():
    source = resting_hub()
    for looks in (140, 440):
        with Budget(looks, clock=itertools.count().__next__).entered():
            shown = locate(source, Modes(3), 12)
        with precision(128):
            assert not any(overlap(pole, zero) for pole in shown.poles for zero in shown.zeros), looks


# ----------------------------------------------- kernels that numbers make constant, zero or undefined


WITHOUT_LENGTH = f"""{PARAMETERS}
x_g = "0.5 m"
[elements]
arm = {{ type = "beam", between = ["p", "q"], {BEAM}, l = "l - x_g" }}
[inputs]
F = {{ force = "q" }}
[outputs]
Y = "q"
"""

# E I w'''' + k w = 0, free: nothing depends on s.
STATIC = """
symflex = 1
[fields.w]
domain = ["0", "l"]
equation = "EI*w'''' + k*w = 0"
conditions = ["w''(0) = 0", "EI*w'''(0) = F", "w''(l) = 0", "w'''(l) = 0"]
[parameters]
EI = "100 N*m^2"
k  = "5 kN/m^2"
l  = "2 m"
[inputs]
F = { unit = "N" }
[outputs]
Y = "w(0)"
"""

# exp(-s T)/cosh(s): poles at j pi/2 (2 n - 1); only the numerator is lopsided in s.
DELAYED_ROD = """
symflex = 1
[parameters]
c = "1 m/s"
l = "1 m"
T = "1 ms"
[blocks]
D = { type = "delay", T = "T" }
[fields.u]
domain = ["0", "l"]
equation = "c^2*u'' = s^2*u"
conditions = ["u(0) = D*F", "u'(l) = 0"]
[inputs]
F = {}
[outputs]
X = "u(l)"
"""


def test_a_beam_without_length_is_refused():
    (tf,) = pipeline.derive_all(pipeline.loads(WITHOUT_LENGTH))
    with pytest.raises(ModelError, match="SF231"):
        locate(pipeline.bind(tf, {"x_g": 1}))


def test_what_does_not_depend_on_s_has_no_poles_and_a_flat_response():
    source = bound(STATIC)
    assert locate(source).poles == ()
    magnitude = respond(source, [1.0, 1000.0]).magnitude
    assert magnitude[0] == pytest.approx(magnitude[1])


def test_poles_on_the_axis_have_no_damping_beside_a_delayed_input_and_the_phase_passes_them():
    source = bound(DELAYED_ROD)
    assert [root.damping_ratio() for root in locate(source, Modes(2)).poles] == [0.0] * 4
    # cosh(j omega) = cos(omega) changes its sign at pi/2 and 3 pi/2; the delay lags by omega T.
    phase = respond(source, [1.0, 3.0, 6.0]).phase
    assert phase == pytest.approx([-0.001, -np.pi - 0.003, -2 * np.pi - 0.006])
    # As near to a pole as doubles allow.
    assert respond(source, [np.pi / 2, 3.0]).phase[1] == pytest.approx(-np.pi - 0.003)


@pytest.mark.slow
def test_frequencies_beyond_doubles_are_a_typed_error():
    # The first is about sqrt(E I/(rho A)) = 1e168 rad/s; squares of it are beyond doubles.
    text = """
symflex = 1
inputs.F = { force = "q" }
outputs.Y = "q"
[elements]
arm  = { type = "beam", between = ["ground", "q"], E = 9e3, I = 8e62, A = 7e-270, rho = 0.26, l = 1 }
load = { type = "mass", at = "q", m = 165 }
"""
    with pytest.raises(BudgetError) as failed:
        locate(pipeline.derive_bound(pipeline.loads(text), [("Y", "F")])[0], Modes(1))
    assert failed.value.diagnostics[0].code == "SF505"


def test_frequencies_whose_product_is_no_double_are_found():
    # Of a free rod: n pi/l sqrt(E/rho).
    text = """
symflex = 1
elements.bar = { type = "rod", between = ["p", "q"], E = 7e-188, A = 3, rho = 7, l = 1e100 }
inputs.F = { force = "p" }
outputs.Y = "q"
"""
    shown = locate(pipeline.derive_bound(pipeline.loads(text), [("Y", "F")])[0], Modes(2))
    expected = [0, *(n * np.pi / 1e100 * 1e-94 for n in (1, 2))]
    upper = sorted(float(p.im.mid()) for p in shown.poles if p.im >= 0)
    assert upper[: len(expected)] == pytest.approx(expected, rel=1e-12, abs=0)
