"""Residues against partial fractions, modal masses and the functions' own derivatives, all from elsewhere."""

from dataclasses import replace
from pathlib import Path

import mpmath
import numpy as np
import pytest
import scipy.signal

from symflex import pipeline
from symflex.analysis.rational import expand_at_pole, expand_at_zero, find_residues
from symflex.analysis.rational.laurent import limit_at_zero
from symflex.balls import to_complex_mpmath
from symflex.errors import UncertifiedError
from symflex.roots import Modes
from symflex.roots.locate import locate
from tests.independent import classics
from tests.unit.analysis.rods import CLAMPED_ROD, FREE_ROD, bound, rational
from tests.unit.roots import distributed_models as distributed

CLASSICS = Path(__file__).parents[4] / "derivations" / "classics"


def upper(residues):
    return [residue for residue in residues if residue.root.im > 0]


def assert_holds(ball, expected, digits=20):
    """The value lies in the ball, which is small."""
    expected = mpmath.mpmathify(expected)
    middle = to_complex_mpmath(ball)
    assert abs(middle - expected) <= mpmath.mpf(10) ** -digits * abs(expected) + float(ball.rad())
    assert float(ball.rad()) <= 10.0**-digits * float(abs(ball).upper())


def test_a_double_pole_at_zero_by_hand():
    # (s + 3)/(s^2 (s + 1)) = 3/s^2 - 2/s + 2/(s + 1)
    zero, one = find_residues(rational("(s + 3)/(s^2*(s + 1))"))
    assert [float(c.real) for c in zero.coefficients] == [-2, 3]
    assert [float(c.real) for c in one.coefficients] == [2]
    assert not zero.is_estimate
    assert not one.is_estimate


@pytest.mark.parametrize(
    ("function", "limit"),
    [
        (rational("(s + 3)/(s + 4)"), 0.75),
        (rational("s^2/(s + 1)"), 0),
        (rational("-1/s"), -np.inf),
        (rational("sqrt(s + 4)/(sqrt(s + 4) + 3)"), 0.4),
        (rational("1/sqrt(s)"), np.inf),
        (bound(CLAMPED_ROD, "X/F"), 1),  # l/(E A)
        (bound(CLAMPED_ROD, "V/F"), 0),
        (bound(FREE_ROD, "Y/F"), np.inf),
    ],
)
def test_limits_at_zero_are_those_of_the_closed_forms(function, limit):
    found = limit_at_zero(function)
    assert (float(found.mid()), float(found.rad()) < 1e-16) == (limit, True)


def test_the_limit_is_not_said_where_a_root_of_s_has_a_pole_at_zero():
    with pytest.raises(UncertifiedError, match="near s = 0"):
        limit_at_zero(rational("1/(sqrt(s + 4) - 2)"))


def test_partial_fractions_are_those_of_scipy():
    def text(c):
        return " + ".join(f"({x})*s^{len(c) - 1 - i}" for i, x in enumerate(c))

    for kind, num, den in (
        ("real", [1, 3], [1, 6, 11, 6]),
        ("complex", [2, -1, 5], [1, 2, 30, 8, 100]),
        ("double", [1, 4], [1, 4, 5, 2]),
    ):
        found = find_residues(rational(f"({text(num)})/({text(den)})"))
        r, p, k = scipy.signal.residue(num, den)
        assert k.size == 0
        s = 0.3 + 0.7j
        powers = [1 + sum(abs(q - pole) < 1e-5 for q in p[:i]) for i, pole in enumerate(p)]
        expected = sum(c / (s - pole) ** n for c, pole, n in zip(r, p, powers, strict=True))
        total = sum(
            complex(c.mid()) / (s - complex(residue.root.enclosure().mid())) ** n
            for residue in found
            for n, c in enumerate(residue.coefficients, 1)
        )
        assert total == pytest.approx(expected, rel=1e-12), kind
        assert total == pytest.approx(np.polyval(num, s) / np.polyval(den, s), rel=1e-12), kind


def test_residues_of_a_constant_with_roots_in_its_coefficients():
    # sqrt(2) s/(s^2 - 2) = (sqrt(2)/2) (1/(s - sqrt 2) + 1/(s + sqrt 2))
    for residue in find_residues(rational("sqrt(2)*s/(s^2 - sqrt(2)^2)"), digits=30):
        with mpmath.workdps(40):
            assert_holds(residue.value, 1 / mpmath.sqrt(2), 30)


def test_the_modal_mass_of_a_cantilever_is_a_quarter_with_the_tip_at_two():
    # Blevins 1979, table 8-1: phi = cosh - cos - sigma (sinh - sin), phi(l) = +-2, integral of phi^2 = l.
    with mpmath.workdps(40):
        v = classics.values(CLASSICS / "clamped_free.toml")
        x_1 = mpmath.mpf(classics.CLAMPED_FREE)
        model = pipeline.load(CLASSICS / "clamped_free.toml")
        (tf,) = pipeline.derive_bound(model, [("W_mid", "F")])
        found = upper(find_residues(tf, Modes(3), 25))
        for residue, guess in zip(found, (x_1, 4.694091, 7.854757), strict=True):
            x = classics.refined(lambda y: mpmath.cos(y) * mpmath.cosh(y) + 1, guess)
            sigma = (mpmath.sinh(x) - mpmath.sin(x)) / (mpmath.cosh(x) + mpmath.cos(x))

            def shape(at, x=x, sigma=sigma):
                q = x * at
                return mpmath.cosh(q) - mpmath.cos(q) - sigma * (mpmath.sinh(q) - mpmath.sin(q))

            omega = classics.beam_frequency(x, v)
            mass = v["rho"] * v["A"] * v["l"]
            # phi(l/2) phi(l)/(m (s^2 + omega^2)) has this residue at j omega
            assert_holds(residue.value, shape(mpmath.mpf(1) / 2) * shape(1) / (2j * omega * mass), 25)


def test_mobilities_of_a_sliding_free_beam_are_sums_of_products_of_mode_shapes():
    # w'(0) = w'''(0) = 0 leave cos and cosh; the free end joins them; tan x + tanh x = 0.
    tf = distributed.bound(distributed.SLIDING_FREE, 1)
    found = upper(find_residues(tf, Modes(4), 20))
    with mpmath.workdps(30):
        for n, residue in enumerate(found, 1):
            x = classics.refined(lambda y: mpmath.tan(y) + mpmath.tanh(y), (n - 0.25) * mpmath.pi)

            def shape(at, x=x):
                return mpmath.cos(x * at) / mpmath.cos(x) + mpmath.cosh(x * at) / mpmath.cosh(x)

            norm = mpmath.quad(lambda at: shape(at) ** 2, [0, 0.5, 1])
            # s phi(0) phi(x)/(norm (s^2 + omega^2)) has this residue at j omega
            assert_holds(residue.value, shape(0) * shape(1) / (2 * norm), 20)


def test_high_modes_cost_no_digits():
    residue = upper(find_residues(distributed.bound(distributed.SLIDING_FREE), Modes(40)))[-1]
    with mpmath.workdps(60):
        x = classics.refined(lambda y: mpmath.tan(y) + mpmath.tanh(y), 39.75 * mpmath.pi)
        # far from the ends the shape is a cosine: residue 1 but for exp(-x)
        assert abs(to_complex_mpmath(residue.value) - 1) < 10 * mpmath.exp(-x) + mpmath.mpf(10) ** -15


def test_a_lossy_line_has_the_residues_of_its_tangent():
    # (s + 1) tanh(g)/g with g^2 = (s + 1)(s + 3): (s + 1)/(s + 2) at every pole
    for residue in find_residues(distributed.bound(distributed.LINE), Modes(3)):
        p = to_complex_mpmath(residue.pole)
        assert_holds(residue.value, (p + 1) / (p + 2), 14)


def test_a_delay_in_a_loop():
    # 1/(s + 2 exp(-s/2)): at a pole exp(-p/2) = -p/2, so the residue is 1/(1 + p/2)
    for residue in find_residues(distributed.bound(distributed.DELAY_LOOP), Modes(3)):
        assert_holds(residue.value, 1 / (1 + to_complex_mpmath(residue.pole) / 2), 14)


def test_poles_that_cannot_be_told_apart_are_refused():
    tf = rational("1/(s + 1)")
    (residue,) = find_residues(tf)
    with pytest.raises(UncertifiedError, match="SF405"):
        expand_at_pole(tf, replace(residue.root, certified=False), 15)


def test_laurent_series_of_rational_functions_by_hand():
    for expression, order, expected in [
        ("(s + 2)/(s^3*(s + 1))", -3, [2, -1, 1, -1]),
        ("s^2/(s + 2)", 2, [0.5]),
        ("3", 0, [3]),
    ]:
        series = expand_at_zero(rational(expression), 0, 20)
        assert series.order == order, (expression, order, expected)
        assert [float(c.real.mid()) for c in series.coefficients] == expected, (expression, order, expected)


def test_the_laurent_series_of_a_free_beam():
    # Bishop & Johnson 1960: (cos x sinh x - sin x cosh x)/(x^3 (1 - cos x cosh x)), x^4 = -s^2
    series = expand_at_zero(distributed.bound(distributed.FREE), 2, 30)
    with mpmath.workdps(80):
        s = mpmath.mpf(10) ** -5
        x = mpmath.root(-(s**2), 4)
        above = mpmath.cos(x) * mpmath.sinh(x) - mpmath.sin(x) * mpmath.cosh(x)
        exact = above / (x**3 * (1 - mpmath.cos(x) * mpmath.cosh(x)))
        terms = sum(to_complex_mpmath(series.coefficient(k)) * s**k for k in range(-2, 3))
        assert series.order == -2
        assert abs(terms - exact) < s**4  # the next term


@pytest.mark.slow
def test_a_field_without_names_for_its_wavenumbers():
    # The third derivative leaves no formula for the roots: series of the exponential of a matrix.
    text = """
symflex = 1
[parameters]
c = "0.5 1/m"
l = "1 m"
T = "1 s^2/m^4"
[fields.w]
domain = ["0", "l"]
equation = "w'''' + c*w''' + T*s^2*w = 0"
conditions = ["w(0) = 0", "w'(0) = 0", "w''(l) = 0", "w'''(l) = -u"]
[inputs]
u = {}
[outputs]
y = "w(l)"
"""
    tf = bound(text, "y/u")
    series = expand_at_zero(tf, 0, 20)
    # At s = 0, w'''' + c w''' = 0 gives w''' = -exp(c (l - x)), and w'' vanishes at l.
    with mpmath.workdps(30):
        c = mpmath.mpf(1) / 2
        slope = mpmath.quad(lambda x: (1 - x) * (mpmath.exp(c * (1 - x)) - 1) / c, [0, 1])
        assert_holds(series.coefficient(0), slope, 15)
    # Neither numerator nor denominator is 0 there, and balls show it.
    assert not series.is_estimate
    for residue in upper(find_residues(tf, Modes(1))):
        # the mean over a circle about the pole
        p, r, n = complex(residue.pole.mid()), 0.3, 64
        circle = [r * np.exp(2j * np.pi * k / n) for k in range(n)]
        mean = sum(tf(p + z) * z for z in circle) / n
        assert complex(residue.value.mid()) == pytest.approx(mean, rel=1e-12)


FLOATING = """
symflex = 1
parameters = {{ E = 7e10, I = 1.2e-9, rho = 2700, A = 1.5e-4, l = 1, k_f = 1e4, c_f = 2{more} }}
inputs.F = {{ force = "x" }}
outputs.Y = "y"
[elements.arm]
type = "beam"
between = ["x", "y"]
E = "E"
I = "I"
rho = "rho"
A = "A"
l = "l"
k_f = "k_f"
c_f = "c_f"
"""


@pytest.mark.parametrize(
    ("declared", "used"),
    [
        (", N = 200", 'N = "N"'),
        pytest.param(
            ", G = 2.6e10, kappa = 0.85",
            'theory = "timoshenko"\nG = "G"\nkappa = "kappa"',
            marks=pytest.mark.slow,
        ),
    ],
    ids=["two wavenumbers of which one vanishes at the pole", "thick"],
)
def test_a_free_beam_on_a_lossy_foundation_translates_as_the_oscillator_that_its_mass_makes(declared, used):
    model = pipeline.loads(FLOATING.format(more=declared) + used)
    residues = upper(find_residues(pipeline.derive_bound(model, [("Y", "F")])[0]))
    mass, damping, stiffness = mpmath.mpf("0.405"), 2, 10**4
    with mpmath.workdps(40):
        pole = (-damping + mpmath.sqrt(mpmath.mpc(damping**2 - 4 * mass * stiffness))) / (2 * mass)
        # 1/(m s^2 + c s + k) near its pole
        found = min(residues, key=lambda r: abs(complex(r.pole.mid()) - complex(pole)))
        assert_holds(found.coefficients[0], 1 / (2 * mass * pole + damping), 14)
    assert not found.is_estimate


def test_a_slender_free_beam_on_a_lossy_foundation_translates_and_turns_at_one_pole():
    model = pipeline.loads(FLOATING.format(more=""))
    residues = upper(find_residues(pipeline.derive_bound(model, [("Y", "F")])[0]))
    mass, damping, stiffness = mpmath.mpf("0.405"), 2, 10**4
    with mpmath.workdps(40):
        pole = (-damping + mpmath.sqrt(mpmath.mpc(damping**2 - 4 * mass * stiffness))) / (2 * mass)
        # From end to end turning counts (l/2)(-l/2)/(l^2/12) = -3 times what translating does.
        assert_holds(residues[0].coefficients[0], -2 / (2 * mass * pole + damping), 14)


@pytest.mark.slow  # twenty modes
def test_modes_with_a_node_at_the_output_have_next_to_no_residue():
    # Pinned beams with a layer between them bend together or against each other, with the same shapes. A
    # moment at the end of one is read at 3/10, where both modes 10 stand still.
    text = """
    symflex = 1
    [parameters]
    B = "4e6 N*m^2"
    m = "100 kg/m"
    K = "1e5 N/m^2"
    l = "10 m"
    a = "3 m"
    [fields.w]
    unknowns = ["w", "v"]
    domain = ["0", "l"]
    equations = ["B*w'''' + m*s^2*w + K*(w - v) = 0", "B*v'''' + m*s^2*v + K*(v - w) = 0"]
    conditions = [
        "w(0) = 0", "w''(0) = 0", "w(l) = 0", "B*w''(l) = M",
        "v(0) = 0", "v''(0) = 0", "v(l) = 0", "v''(l) = 0",
    ]
    [inputs]
    M = { unit = "N*m" }
    [outputs]
    Y = "w(a)"
    """
    beams = pipeline.bind(pipeline.derive_all(pipeline.loads(text))[0])
    poles = [r for r in locate(beams, Modes(20), 15, with_zeros=False).complete().all_poles if r.im > 0]
    found = {float(r.im.mid()): expand_at_pole(beams, r, 15)[1].principal_part[0] for r in poles}
    expected = []
    for wave in np.arange(1, 11) * np.pi / 10:
        for omega in (200 * wave**2, np.hypot(200 * wave**2, 2000**0.5)):
            # The modal mass is m*l, the moment acts on the slope, and 1/(s^2 + omega^2) leaves 1/(2 j omega).
            expected.append((omega, wave * abs(np.sin(3 * wave)) / (100 * 10) / (2 * omega)))
    assert sorted(found) == pytest.approx(sorted(omega for omega, _ in expected), rel=1e-12)
    for residue, (_, size) in zip([found[omega] for omega in sorted(found)], sorted(expected), strict=True):
        assert float(abs(residue).upper()) == pytest.approx(size, rel=1e-12, abs=1e-18)
