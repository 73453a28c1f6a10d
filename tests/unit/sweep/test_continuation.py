"""Roots carried along a sweep: the same as those of a search at every point, and right."""

import cmath
from dataclasses import replace
from fractions import Fraction
from math import pi

import mpmath
import numpy as np
import pytest
from flint import arb
from mpmath import mp, mpf
from scipy.optimize import brentq

import symflex
from symflex.loops.boxes import CharacteristicFunction
from symflex.options import SweepOptions
from symflex.roots.functions.kernel_function import KernelFunction
from symflex.roots.pole_zero_map import StabilityVerdict
from symflex.sweep import plan_sweep, points
from symflex.sweep.continuation import Carried, Continuation, _Circle, _end_of_straight
from symflex.sweep.design import derived
from symflex.sweep.points import RootSolver, solve_roots
from tests.unit.sweep.models import BEAM, LOOP, STEEL, TWO_RESONANCES

DAMPED = (
    STEEL
    + """l = "1 m"
eta = "1e-5 s"
b = { value = "2 N*s/m", assume = "nonnegative" }
[elements]
arm   = { type = "beam", between = ["p", "q"], E = "E", I = "I", rho = "rho", A = "A", l = "l", eta = "eta" }
wall  = { type = "fixed", at = "p" }
dash  = { type = "damper", between = ["q", "ground"], b = "b" }
[inputs]
F = { force = "q" }
[outputs]
X = "q"
"""
)
ROD = """
symflex = 1
[parameters]
E = "200 GPa"
A = "1 cm^2"
rho = "7800 kg/m^3"
b = "1 kN*s/m"
[elements]
rod  = { type = "rod", between = ["p", "q"], E = "E", A = "A", rho = "rho", l = "1 m" }
wall = { type = "fixed", at = "p" }
tip  = { type = "mass", at = "q", m = "1 kg" }
dash = { type = "damper", between = ["q", "ground"], b = "b" }
[inputs]
F = { force = "q" }
[outputs]
X = "q"
"""
DELAYED = """
symflex = 1
[parameters]
K = 0.1
T = "10 ms"
[blocks]
D = { type = "delay", T = "T" }
[signals]
x = "(F - 1e4*K*D*x)/(s^2 + 20*s + 1e4)"
[inputs]
F = {}
[outputs]
X = "x"
"""
TIMOSHENKO = DAMPED.replace(
    'eta = "eta" }', 'eta = "eta", theory = "timoshenko", G = "80 GPa", kappa = "5/6" }'
)
OSCILLATOR = """
symflex = 1
[parameters]
m = { value = "1 kg", assume = "nonnegative" }
b = { value = "1 N*s/m", assume = "nonnegative" }
[signals]
x = "F/(m*s^2 + b*s + 1)"
[inputs]
F = {}
[outputs]
X = "x"
"""


def planned(text, over, **given):
    model = symflex.loads(text).resolved
    return plan_sweep(model, SweepOptions(tuple(over), **given))


def solved(text, over, **given):
    """Return the rows of a sweep in one go, and of its points one by one, each without those before it."""
    task, design = planned(text, over, **given)
    together, tf = solve_roots(task)(design.points), derived(task)
    alone = []
    for point in design.points:
        solver = RootSolver(tf, task.names, task.of, task.region)
        solver._quotient = solver._continuation = None
        alone.append(solver(point))
    return together, points._rows(alone)


def same(together, alone):
    return [
        name
        for name, values in alone.items()
        if not np.array_equal(values, together[name], equal_nan=values.dtype.kind == "f")
    ]


def residual(s, b):
    """Cantilever: w(0) = w'(0) = 0, w''(l) = 0, EI (1 + eta s) w'''(l) = b s w(l); length 1, EI 800."""
    stiffness = 800 * (1 + mpf("1e-5") * s)
    k = mpmath.root(-mpf("3.768") * s**2 / stiffness, 4)
    c, ch, sn, sh = mpmath.cos(k), mpmath.cosh(k), mpmath.sin(k), mpmath.sinh(k)
    # w = A (cosh kx - cos kx) + B (sinh kx - sin kx).
    moment = [ch + c, sh + sn]
    shear = [
        stiffness * k**3 * (sh - sn) - b * s * (ch - c),
        stiffness * k**3 * (ch + c) - b * s * (sh - sn),
    ]
    return (moment[0] * shear[1] - moment[1] * shear[0]) / (ch * ch * k**3)


def test_poles_of_a_damped_beam_are_carried_and_right(monkeypatch):
    searches = []
    locate = points.locate
    monkeypatch.setattr(points, "locate", lambda *given: searches.append(given) or locate(*given))
    task, design = planned(DAMPED, ["b=1:3:lin:12"], modes=3)
    rows = solve_roots(task)(design.points)
    assert len(searches) == 1
    assert rows["status"].tolist() == [[1, 1, 1]] * 12 and not rows["point_status"].any()
    with mp.workdps(40):
        for i in (5, 11):
            b = mpf(design.points[i][0].rational.numerator) / design.points[i][0].rational.denominator
            for re, im, radius in zip(rows["re"][i], rows["im"][i], rows["radius"][i], strict=True):
                start = mpmath.mpc(float(re), float(im))
                root = mpmath.findroot(lambda s, b=b: residual(s, b), start)
                assert abs(root - start) <= radius < 1e-15 * abs(root)


@pytest.mark.parametrize(
    ("text", "over", "given"),
    [
        (OSCILLATOR, ["b=0.5:3.5:lin:13"], {}),  # a double root at b = 2
        (OSCILLATOR, ["m=0,1,2", "b=0,1"], {}),  # the order changes with m = 0
        (TWO_RESONANCES, ["k_1=1:9:lin:12"], {}),  # frequencies cross
        (TWO_RESONANCES, ["k_1=3,3.5,4,4.5"], {"of": "zeros"}),  # a resonance cancels at 4
        (LOOP, ["K=1,3,12"], {}),  # a pole crosses the axis
    ],
)
def test_a_sweep_of_polynomials_is_that_of_its_points(text, over, given):
    assert not same(*solved(text, over, **given))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "over", "given"),
    [
        (DAMPED, ["b=1:400:log:20"], {"modes": 3}),  # a pair meets the real axis
        (DAMPED, ["b=0:2:lin:5"], {"modes": 3}),  # b = 0 takes a term away
        (DAMPED, ["eta=1e-5:2e-4:log:6"], {"modes": 3}),  # roots accumulate ever nearer
        (DAMPED, ["l=0.9:1.1:lin:4", "b=1:3:lin:5"], {"modes": 2}),
        (DAMPED, ["l=0.5:2:log:8"], {"modes": 3}),  # steps too long for a proof between points
        (DAMPED, ["b=1:3:lin:5"], {"modes": 3, "of": "zeros"}),
        (DAMPED, ["l=0.9:1.1:lin:10"], {"band": (1, 200)}),  # a root enters the band
        (DAMPED, ["b=+-20%", "E=+-5%", "l=+-2%"], {"draws": 8, "modes": 3}),
        (BEAM, ["m=0:2:lin:8"], {"modes": 4}),  # on the axis, with a rigid body
        (BEAM, ["m=0.5:2:lin:8"], {"modes": 4, "of": "zeros"}),
        (ROD, ["b=3e3:4.5e3:lin:12"], {"modes": 3}),  # about the impedance of the rod, 3950 N s/m
        (DELAYED, ["K=0.05:0.3:lin:12"], {"modes": 3}),  # a pair crosses the imaginary axis
        (TIMOSHENKO, ["b=1:3:lin:5"], {"modes": 2}),
    ],
)
def test_a_sweep_of_waves_is_that_of_its_points(text, over, given):
    assert not same(*solved(text, over, **given))


def test_roots_are_not_carried_past_a_double_root():
    """As the damper grows a pair meets the real axis, and becomes two roots: not one of them twice."""
    together, alone = solved(DAMPED, ["b=80,85,90,95"], modes=1)
    assert np.sum(alone["im"] == 0, axis=1).tolist()[0] == 0 < np.sum(alone["im"] == 0, axis=1).tolist()[-1]
    assert not same(together, alone)


@pytest.fixture(scope="module")
def carried():
    """What carries the lowest poles of a damped beam over b, and these at b = 2 N s/m."""
    task, design = planned(DAMPED, ["b=2,3"], modes=1)
    continuation = Continuation.of(derived(task), task.names, "poles", task.region)
    at = continuation.begin(design.points[0], [complex(-1.07475047370624, 51.2219649399906)], 0)
    assert at is not None
    return continuation, at


def test_roots_that_are_alike_or_shared_are_not_carried(carried):
    continuation, at = carried
    guess = at.roots[0].enclosure().mid()
    assert continuation._roots(at.sides, [guess]) is not None
    assert continuation._roots(at.sides, [guess, guess]) is None
    assert continuation._roots((at.sides[0], at.sides[0]), [guess]) is None  # the other side is 0 there


def test_no_verdict_is_carried_to_a_root_that_may_be_on_either_side_of_the_axis(carried):
    continuation, at = carried
    (root,) = at.roots
    stable = StabilityVerdict("stable", 0, True, "")
    assert continuation._keeps(stable, at)
    unsure = replace(root, re=arb(0, 1e-3))
    assert not continuation._keeps(stable, replace(at, roots=(unsure,)))


def test_a_straight_way_leads_past_a_point_all_of_whose_roots_are_within_the_contour(carried):
    _, at = carried
    (root,) = at.roots
    outside = replace(root, im=root.im * 1e6)
    start, end, between = (replace(at, numbers=(Fraction(n),)) for n in (1, 3, 2))
    assert _end_of_straight([start, between, end], 0, 2) == 2
    assert _end_of_straight([start, replace(between, roots=(root, outside)), end], 0, 2) == 1
    beside = replace(between, numbers=(Fraction(4),))
    assert _end_of_straight([start, beside, end], 0, 2) == 1


def test_roots_of_which_two_became_real_are_not_carried(carried):
    continuation, at = carried
    real = replace(at.roots[0], im=arb(0), is_real=True)
    point = planned(DAMPED, ["b=2,3"], modes=1)[1].points[1]
    assert continuation._following([at], point) is not None
    changed = replace(continuation)
    vars(changed)["_roots"] = lambda sides, guesses: (real,)
    assert changed._following([at], point) is None


def test_roots_that_may_hide_at_0_are_carried_neither_at_first_nor_on_the_way(carried):
    continuation, at = carried
    points = planned(DAMPED, ["b=2,3"], modes=1)[1].points
    hiding = replace(continuation)
    vars(hiding)["_hides_at_zero"] = lambda at_zero, numbers: True
    assert hiding.begin(points[0], [complex(at.roots[0])], 0) is None
    assert hiding._following([at], points[1]) is None


@pytest.mark.parametrize("side", [0, 1])
def test_roots_next_to_which_others_accumulate_are_not_carried(carried, side):
    continuation, at = carried
    sides = [KernelFunction(each.bound, each.part, each) for each in at.sides]
    guesses = [at.roots[0].enclosure().mid()]
    assert continuation._roots(tuple(sides), guesses) is not None
    vars(sides[side])["is_analytic_on"] = lambda disc, bits: False
    assert continuation._roots(tuple(sides), guesses) is None


def test_on_a_straight_way_no_pole_may_cross_the_axis():
    # s^2 + 20 s + 1e4 (1 + K exp(-s T)): with s = j w, K^2 = (1 - w^2/1e4)^2 + (w/500)^2 and the phase of
    # that is that of the delay, pi - w T: K = 0.2013 at w = 100.2... found by bisection beside.
    def phase(w):
        return np.angle((1e4 - w * w + 20j * w) / 1e4 / -np.exp(-0.01j * w))

    w = brentq(phase, 90, 130)
    crossing = abs(1e4 - w * w + 20j * w) / 1e4
    task, design = planned(DELAYED, [f"K={0.8 * crossing},{0.9 * crossing},{1.1 * crossing}"], modes=1)
    continuation = Continuation.of(derived(task), task.names, "poles", task.region)
    at = [Carried(tuple(x.rational for x in p), (), (None, None), 0, 0) for p in design.points]
    assert continuation._keeps_side(at[0], at[1])
    assert not continuation._keeps_side(at[1], at[2])
    assert not continuation._keeps_side(at[0], at[2])
    assert not continuation._is_clear_between(at[0], at[2], 1000)


def test_a_part_of_a_circle_is_clear_if_no_root_is_on_it_up_to_its_ends(carried):
    continuation, at = carried
    (root,), own = at.roots, at.sides[0]
    factors = tuple(f for f, _ in own.part.factors)
    function = CharacteristicFunction(
        continuation.tf, ("b",), continuation._values, chosen=factors, are_positive=True
    )
    z, b = cmath.log(complex(root)), at.numbers[0]
    for height, angle, expected in [(0, 0, None), (0.05, 0, True), (-0.05, 0, True), (0, 0.05, True)]:
        for share in (0.02, 0.5, 0.98):
            circle = _Circle.of(function, ((b, b),), [True], (z.real + height,) * 2, pi)
            first = (z.imag + angle - 0.02 * share) / pi
            assert circle.is_clear(first, first + 0.02 / pi) is expected
    # So it is where the radius changes: the root is met at one end of the way, or not at all.
    for ends, expected in [((0.02, -0.001), None), ((0.001, -0.02), None), ((0.04, 0.02), True)]:
        circle = _Circle.of(
            function, ((b, b + Fraction(1, 10**6)),), [True], tuple(z.real + x for x in ends), pi
        )
        first = (z.imag - 0.001) / pi
        assert circle.is_clear(first, first + 0.002 / pi) is expected
