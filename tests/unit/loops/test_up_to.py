"""Stability over parameters inside wavenumbers: critical loads and speeds of books, recomputed by mpmath.

Expected values: roots of 4 x 4 determinants of exponentials with mpmath, 30 digits, f = 0 and df/ds = 0 where
two poles meet on the axis. Beck (1952), Gregory and Paidoussis (1966), Bolotin (1963), Euler (1744).
"""

from dataclasses import replace
from fractions import Fraction
from math import pi, sqrt

import mpmath
import numpy as np
import pytest
from flint import acb, acb_series

from symflex import loads
from symflex.balls import precision, series_terms
from symflex.loops.over import characteristic
from symflex.loops.patches import patch
from symflex.loops.stability_map import PoleCount
from symflex.loops.up_to import BoxesUpTo, Path, PolesUpTo

BECK, BECK_OMEGA = 20.0509536189737, 11.0155576409229  # EI/l^2, rad/s

COLUMN = """
symflex = 1
parameters = {{ EI = 1, c = 0.001, L = 1, m = 1, P = 10 }}
inputs = {{ F = {{}} }}
outputs = {{ Y = "w(L)" }}
[fields.w]
domain = ["0", "L"]
equation = "{bending} + P*w'' + m*s^2*w = 0"
conditions = ["w(0) = 0", "w'(0) = 0", "w''(L) = 0", "{shear} = -F"]
"""
FOLLOWER = COLUMN.format(bending="EI*w''''", shear="EI*w'''(L)")
DEAD = COLUMN.format(bending="EI*w''''", shear="EI*w'''(L) + P*w'(L)")
LOSSY = COLUMN.format(bending="(EI + c*s)*w''''", shear="EI*w'''(L)")

PIPE = """
symflex = 1
parameters = { EI = 1, L = 1, m_t = 1, beta = 0.2, U = 3 }
inputs = { F = {} }
outputs = { Y = "w(L)" }
[fields.w]
domain = ["0", "L"]
equation = "EI*w'''' + U^2*w'' + 2*sqrt(beta)*U*s*w' + m_t*s^2*w = 0"
conditions = ["w(0) = 0", "w'(0) = 0", "w''(L) = 0", "EI*w'''(L) = -F"]
"""

PANEL = """
symflex = 1
parameters = { D = 1, L = 1, m = 1, q = 200 }
inputs = { M = {} }
outputs = { Y = "w'(L)" }
[fields.w]
domain = ["0", "L"]
equation = "D*w'''' + q*w' + m*s^2*w = 0"
conditions = ["w(0) = 0", "w''(0) = 0", "w(L) = 0", "D*w''(L) = M"]
"""


BELT = """
symflex = 1
parameters = { EI = 1, N = 1, rho = 1, L = 1, v = 2 }
inputs = { M = {} }
outputs = { Y = "w'(L)" }
[fields.w]
domain = ["0", "L"]
equation = "EI*w'''' - (N - rho*v^2)*w'' + 2*rho*v*s*w' + rho*s^2*w = 0"
conditions = ["w(0) = 0", "w''(0) = 0", "w(L) = 0", "EI*w''(L) = M"]
"""
LIMP = BELT.replace("EI = 1", "EI = 0.01")


def the_boundary(found, value, omega, change):
    (boundary,) = found.proved.boundaries
    assert abs(float(boundary.gain.mid()) / value - 1) < 1e-10
    assert [float(w.mid()) for w in boundary.frequencies] == pytest.approx([omega], rel=1e-10)
    assert found.proved.change(0) == change


def test_a_patch_holds_the_function_on_discs_up_to_their_rims():
    def exponentials(s, p):
        return (s * p).exp()

    made = patch(exponentials, 1 + 2j, 0.125, 2.0, 0.125)
    assert made is not None
    shares = np.exp(2j * pi * np.arange(7) / 7)
    for s, p in [(x, y) for x in shares for y in shares]:
        value = sum(c * s**i * p**k for (i, k), c in np.ndenumerate(made.coefficients))
        assert abs(value - np.exp((1 + 2j + s / 8) * (2 + p / 8))) < made.error < 1e-3


def test_the_error_of_a_patch_holds_where_its_bound_is_nearly_attained():
    # 1/(4.6 - p) is finite on a disc of 4 alone, so that coefficients fall as slowly as the bound allows.
    made = patch(lambda s, p: s * 0 + 1 / (acb(4.6) - p), 0j, 1.0, 0.0, 1.0)
    assert made is not None
    for p in np.exp(2j * pi * np.arange(7) / 7):
        value = sum(c * p**k for k, c in enumerate(made.coefficients[0]))
        assert abs(value - 1 / (4.6 - p)) < made.error < 1e-5


def test_a_patch_is_as_wide_as_discs_of_both_and_its_error():
    # |s + 2 p - v| may be 0 up to v = 0.1 + 2*0.05, and s^2/2 + p s turns up to s = 0.1 + 0.05.
    line = patch(lambda s, p: s + 2 * p, 0j, 1.0, 0.0, 1.0)
    bowl = patch(lambda s, p: s * s / 2 + p * s, 0j, 1.0, 0.0, 1.0)
    assert line is not None and bowl is not None
    for share, is_open in [(0.999, True), (1.001, False)]:
        assert line.on(share * 0.2, 0.1, 0.0, 0.05)[0].may_vanish is is_open
        assert bowl.on(share * 0.15, 0.1, 0.0, 0.05)[0].may_turn is is_open
    # Off the middle of both, where s + 2 p = 0.
    assert line.on(-0.6 + 0j, 0.0, 0.3, 0.0)[0].may_vanish
    assert not line.on(0.6 + 0j, 0.0, 0.3, 0.0)[0].may_vanish
    steep = patch(lambda s, p: s + 1 / (4.6 - p) - 1 / acb(4.6), 0j, 1.0, 0.0, 1.0)
    assert steep is not None
    near = steep.error / 2 * 4.6**2  # where its value is half of the error
    assert steep.on(0j, 0.0, near, 0.0)[0].may_vanish
    assert not steep.on(0j, 0.0, 9 * near, 0.0)[0].may_vanish


def test_a_patch_tells_where_a_function_and_its_slope_vanish():
    def square(s, p):
        return s * s + p

    made = patch(square, 0j, 1.0, 0.25, 0.5)
    assert made is not None
    at_root, _ = made.on(0.5j, 0.05, 0.25, 0.01)
    beside, _ = made.on(0.5j, 0.05, 0.25 + 0.2, 0.01)
    at_turn, _ = made.on(0j, 0.05, 0.25, 0.01)
    assert (at_root.may_vanish, at_root.may_turn) == (True, False)
    assert not beside.may_vanish
    assert (at_turn.may_vanish, at_turn.may_turn) == (False, True)


def test_a_patch_is_refused_where_a_function_has_a_pole():
    def pole(s, p):
        return 1 / (s - p)

    assert patch(pole, 1j, 1.0, 0.0, 0.5) is None
    assert patch(lambda s, _: s * acb("nan"), 1j, 1.0, 0.0, 0.5) is None


def test_poles_of_a_column_under_a_follower_load_meet_on_the_axis():
    model = loads(FOLLOWER)
    found = model.stability(over="P", limits=(20, 20.1), up_to_hz=2.5, digits=11)
    the_boundary(found, BECK, BECK_OMEGA, 2)
    assert not found.certified and found.counted_up_to_hz == pytest.approx(2.5)
    assert [i.poles.word for i in found.proved.intervals] == ["marginal", "unstable"]
    assert found.proved.verdict.word == "unknown"  # poles beyond are not counted


def test_a_column_under_a_dead_load_buckles_at_a_quarter_of_pi_squared():
    found = loads(DEAD).stability(over="P", limits=(2.4, 2.5), up_to_hz=1, digits=11)
    (boundary,) = found.proved.boundaries
    assert abs(float(boundary.gain.mid()) - pi**2 / 4) < 1e-11
    assert [float(w.mid()) for w in boundary.frequencies] == [0]
    assert [(i.poles.right, i.poles.axis) for i in found.proved.intervals] == [(0, 2), (1, 0)]


def test_a_part_in_which_a_pole_comes_below_the_frequency_is_marginal():
    # Its first mode has the frequency 1.8751040687^2/sqrt(m): 1.5 rad/s at m = 5.49.
    bar = loads(DEAD.replace(" + P*w''", "").replace(" + P*w'(L)", ""))
    found = bar.stability(over="m", limits=(4, 7), up_to_hz=1.5 / (2 * pi))
    assert [each.poles.word for each in found.proved.intervals] == ["marginal"]


def test_a_belt_that_moves_buckles_where_its_stiffness_is_spent():
    # rho v^2 = N + EI pi^2/l^2. Its poles are on the axis below, as waves turn round with s.
    found = loads(BELT).stability(over="v", limits=(3.2, 3.4), up_to_hz=1, digits=10)
    (boundary,) = found.proved.boundaries
    assert abs(float(boundary.gain.mid()) - sqrt(1 + pi**2)) < 1e-10
    assert [float(w.mid()) for w in boundary.frequencies] == [0]
    assert [i.poles.word for i in found.proved.intervals] == ["marginal", "unstable"]


def test_long_series_of_modes_are_those_of_the_matrix_exponential():
    # Fundamental functions along a belt about s = 2 + 5 j: sums over four roots, and by exp(A l) at s + 1/8.
    model = loads(BELT).resolved
    tf, (factor,) = characteristic(model, ("v",), ((Fraction(3), Fraction(4)),)).at_rest
    with precision(128), series_terms(24):
        kernels = characteristic(model, ("v",), ((Fraction(3), Fraction(4)),)).kernels(
            tf, ((Fraction(3),) * 2,)
        )
        by_modes = replace(kernels, expands_modes=True)
        series = by_modes.polynomial(factor, by_modes.at(acb_series([acb(2, 5), 1], 24)))
        by_matrix = replace(kernels, is_modal=False)
        value = by_matrix.polynomial(factor, by_matrix.at(acb(2.125, 5)))
        total = sum((series[k] / acb(8) ** k for k in range(24)), acb(0))
    assert abs(complex(total) / complex(value) - 1) < 1e-14


def test_patches_keep_their_digits_where_wavenumbers_nearly_meet():
    # At EI = 0.01 and v = 1 series about s = 0.19 j lose more digits than 64 bits have.
    limits = Fraction(1, 2), Fraction(2)
    function = characteristic(loads(LIMP).resolved, ("v",), (limits,))
    poles = PolesUpTo.of(function, (limits,), pi, 128)
    made = poles._patch_on(0, poles.axis, 3, (Fraction(7, 8), Fraction(17, 16)))
    assert made is not None and made.error < 1e-4 * abs(made.coefficients[0, 0])


@pytest.mark.slow
def test_a_belt_with_little_stiffness_buckles_next_to_its_wave_speed():
    found = loads(LIMP).stability(over="v", limits=(1, 1.0625), up_to_hz=0.5, digits=10)
    (boundary,) = found.proved.boundaries
    assert abs(float(boundary.gain.mid()) - sqrt(1 + 0.01 * pi**2)) < 1e-10
    assert [i.poles.word for i in found.proved.intervals] == ["marginal", "unstable"]


def test_up_to_a_frequency_a_chart_is_decided_on_both_sides_of_a_boundary():
    # Euler: P = pi^2 EI/4.
    ranges = {"P": (2, 3), "EI": (0.95, 1.05)}
    chart = loads(DEAD).stability(over=("P", "EI"), ranges=ranges, up_to_hz=1, resolve=0.6)
    assert not chart.certified and chart.radius == pytest.approx(2 * pi)
    assert {region.verdict.word for region in chart.regions} == {"marginal", "unstable"}
    for part in (part for part in chart.boxes if part.region >= 0):
        (low, high), (soft, stiff) = part.box
        is_right = bool(chart.regions[part.region].verdict.right)
        assert is_right == (float(low) > pi**2 / 4 * float(stiff)) != (float(high) < pi**2 / 4 * float(soft))
    assert chart.boundaries == [] and chart.to_json_dict()["counted_up_to_rad_per_s"] == chart.radius


def test_a_load_along_a_beam_adds_no_pole_where_its_waves_vanish():
    # The beam is stable up to Omega = pi^2 sqrt(EI/(m L^4)), whatever loads it: sin(pi x/L) has the stiffness
    # EI pi^4/L^4 - m Omega^2. A load q is divided by m*s^2 + c*s - m*Omega^2, which has a root on the right.
    spin = """
symflex = 1
parameters = { EI = 1, tau = 0.01, c = 0.5, m = 1, L = 1, Omega = 2 }
inputs = { q = {} }
outputs = { Y = "w(0.7*L)" }
[fields.w]
domain = ["0", "L"]
equation = "EI*(1 + tau*s)*w'''' + (m*s^2 + c*s - m*Omega^2)*w = q"
conditions = ["w(0) = 0", "w''(0) = 0", "w(L) = 0", "w''(L) = 0"]
"""
    found = loads(spin).stability(over="Omega", limits=(1, 5))
    assert found.is_stable is not False
    for part in found.proved.intervals:
        assert part.poles.right == 0


@pytest.mark.slow
def test_a_pipe_flutters_at_the_speed_of_gregory_and_paidoussis():
    found = loads(PIPE).stability(over="U", limits=(5, 6), up_to_hz=5)
    the_boundary(found, 5.59140437782707, 13.7146998005345, 2)
    assert [i.poles.word for i in found.proved.intervals] == ["stable", "unstable"]


@pytest.mark.slow
def test_loss_takes_half_of_the_critical_load_of_a_column():
    # With loss all poles in the right half-plane have a bound, and all are counted.
    found = loads(LOSSY).stability(over="P")
    the_boundary(found, 10.9391219969785, 5.39862478360082, 2)
    assert found.certified and found.is_stable


@pytest.mark.slow
def test_a_panel_flutters_where_its_two_lowest_poles_meet():
    found = loads(PANEL).stability(over="q", limits=(100, 500), up_to_hz=15)
    the_boundary(found, 343.3564262798, 32.4315638843160, 2)


def test_a_pole_at_rest_is_counted_beside_the_waves():
    model = loads(
        """symflex = 1
        parameters = { l = "1 m" }
        [elements]
        wall = { type = "fixed", at = "a" }
        arm = { type = "beam", between = ["a", "b"], EI = "100 N*m^2", rhoA = "1 kg/m", l = "l" }
        push = { type = "force_source", at = "b.y", f = "u" }
        [signals]
        u = "F/s"
        [inputs]
        F = { unit = "N/s" }
        [outputs]
        Y = "b.y"
        """
    )
    found = model.stability(over="l", limits=(0.9, 1.1), up_to_hz=10, digits=10)
    # By hand: 0, and one pair, 3.5160 sqrt(EI/rhoA)/l^2 = 5.6 Hz; the next one is above 29 Hz.
    assert [(each.poles.right, each.poles.axis) for each in found.proved.intervals] == [(0, 3)]


STRING = """
symflex = 1
parameters = { N = 1, rho = 1, l = 1, v = 0.5 }
inputs = { y_0 = {} }
outputs = { Y = "w(l/2)" }
[fields.w]
domain = ["0", "l"]
equation = "(N - rho*v^2)*w'' - 2*rho*v*s*w' - rho*s^2*w = 0"
conditions = ["w(0) = 0", "w(l) = y_0"]
"""


@pytest.mark.slow
@pytest.mark.parametrize("limits", [(0.5, 1.5), (0.5, 1)])
def test_where_waves_are_ever_shorter_nothing_is_decided(limits):
    # Poles at j n pi (1 - v^2): none below 0.1 Hz up to v = 0.89, and infinitely many at v = 1, amid the
    # range or at its end, where w'' has no coefficient.
    found = loads(STRING).stability(over="v", limits=limits, up_to_hz=0.1)
    first = found.proved.intervals[0]
    assert (first.poles.right, first.poles.axis) == (0, 0)
    assert 0.6 < float(first.high.mid()) < 0.9 and float(first.high.rad()) < 1e-12
    assert any("loses its highest derivative" in reason for reason in found.proved.reasons)


@pytest.mark.parametrize(
    ("kind", "signs"), [("axis", (1,)), ("axis", (-1, 1)), ("arc", (1,)), ("arc", (-1, 1))]
)
def test_a_piece_of_a_path_reaches_no_farther_from_its_middle_than_its_ends(kind, signs):
    path = Path(kind, Fraction(3), 4, signs)
    for sign in signs:
        low, high = sorted((Fraction(sign, 4), Fraction(sign, 2)))
        middle = path.middle((low, high))
        farthest = max(float(abs(path.at(x) - middle).upper()) for x in (low, high))
        assert farthest <= path.reach((low, high)) <= 1.02 * farthest
        assert all(path.box((low, high)).contains(path.at(x).mid()) for x in (low, high))


def test_a_beam_that_no_function_sees_is_counted_too():
    # By hand: 3.516 sqrt(EI/rhoA)/l^2 = 5.6 Hz of the first, 2.8 Hz of the other; the next are beyond 15 Hz.
    text = """symflex = 1
        parameters = { l = "1 m" }
        [elements]
        wall = { type = "fixed", at = "a" }
        seen = { type = "beam", between = ["a", "b"], EI = "100 N*m^2", rhoA = "1 kg/m", l = "l" }
        other = { type = "beam", between = ["a", "c"], EI = "100 N*m^2", rhoA = "4 kg/m", l = "l" }
        [inputs]
        F = { force = "b.y" }
        [outputs]
        Y = "b.y"
        """
    found = loads(text).stability(over="l", limits=(0.95, 1.05), up_to_hz=10, digits=8)
    assert [(each.poles.right, each.poles.axis) for each in found.proved.intervals] == [(0, 4)]


def test_no_patch_stands_for_a_function_with_a_constant_that_its_parameter_changes():
    # sqrt(beta) would stay what it is in the middle.
    ends = (Fraction(1, 8), Fraction(1, 4))
    for name in ("beta", "U"):
        poles = PolesUpTo.of(characteristic(loads(PIPE).resolved, (name,), (ends,)), (ends,), 5.0, 64)
        assert (poles._patch_on(0, poles.axis, 1, ends) is None) == (name == "beta")


CLAMPED = """
symflex = 1
parameters = {{ {parameters} }}
inputs = {{ q = {{}} }}
outputs = {{ Y = "{at}" }}
[fields.w]
domain = ["0", "1"]
equation = "{equation} + s^2*w = q"
conditions = ["w(0) = 0", "w'(0) = 0", "{first}", "{second}"]
"""
COMPRESSED = "w'''' + P*w''"


def at_tip(p, w):
    """Return u, u', u'', u''' at 1 of two solutions of u'''' + p u'' = w^2 u with u(0) = u'(0) = 0."""
    half = mpmath.sqrt(p * p / 4 + w * w)
    a, b = mpmath.sqrt(half + p / 2), mpmath.sqrt(half - p / 2)
    s, c, sh, ch = mpmath.sin(a), mpmath.cos(a), mpmath.sinh(b), mpmath.cosh(b)
    return (
        (ch - c, b * sh + a * s, b * b * ch + a * a * c, b**3 * sh - a**3 * s),
        (sh / b - s / a, ch - c, b * sh + a * s, b * b * ch + a * a * c),
    )


def flutter(guess, shear):
    """Return load and frequency where two poles of a column with u'' = 0 and a shear at its tip meet."""

    def value(p, w):
        one, two = at_tip(p, w)
        return one[2] * shear(two, p, w) - two[2] * shear(one, p, w)

    with mpmath.mp.workdps(30):
        found = mpmath.findroot(lambda p, w: [value(p, w), mpmath.diff(lambda x: value(p, x), w)], guess)
    return float(found[0]), float(found[1])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("parameters", "equation", "ends", "limits", "expected"),
    [
        # On an elastic foundation Beck's load stays what it is (Smith and Herrmann 1972).
        (
            "P = 10, k = 50",
            COMPRESSED + " + k*w",
            ("w''(1) = 0", "w'''(1) = 0"),
            (20, 20.1),
            (BECK, sqrt(BECK_OMEGA**2 + 50)),
        ),
        # A load along a fixed line: the adjoint of Beck's column (Reut 1939).
        (
            "P = 10",
            COMPRESSED,
            ("w''(1) + P*w(1) = 0", "w'''(1) + P*w'(1) = 0"),
            (20, 20.1),
            (BECK, BECK_OMEGA),
        ),
        # With a mass at its tip (Pflueger 1950).
        (
            "P = 10, M = 0.5",
            COMPRESSED,
            ("w''(1) = 0", "w'''(1) = M*s^2*w(1)"),
            (16, 16.1),
            flutter((16, 7.2), lambda u, _, w: u[3] + w * w * u[0] / 2),
        ),
        # A force that turns with three quarters of the slope.
        (
            "P = 10, h = 0.75",
            COMPRESSED,
            ("w''(1) = 0", "w'''(1) + (1 - h)*P*w'(1) = 0"),
            (17.1, 17.2),
            flutter((17.2, 9.6), lambda u, p, _: u[3] + p * u[1] / 4),
        ),
        # Divergence, clamped and pinned: tan x = x.
        ("P = 10", COMPRESSED, ("w(1) = 0", "w''(1) = 0"), (20, 20.3), (4.493409457909064**2, 0)),
        # A pipe and a belt, clamped at both ends, lose their stiffness as a column does, at 4 pi^2.
        (
            "V = 5, m = 0.3",
            "w'''' + m*V^2*w'' + 2*m*V*s*w'",
            ("w(1) = 0", "w'(1) = 0"),
            (11.4, 11.5),
            (2 * pi / sqrt(0.3), 0),
        ),
        (
            "v = 5",
            "w'''' - (1 - v^2)*w'' + 2*v*s*w'",
            ("w(1) = 0", "w'(1) = 0"),
            (6.3, 6.4),
            (sqrt(1 + 4 * pi**2), 0),
        ),
    ],
    ids=["foundation", "reut", "pflueger", "subtangential", "clamped_pinned", "pipe", "belt"],
)
def test_a_critical_load_is_that_of_the_book(parameters, equation, ends, limits, expected):
    value, omega = expected
    at, up_to_hz, change = ("w(1)", 2.5, 2) if omega else ("w(1/2)", 1, 1)
    first, second = ends
    text = CLAMPED.format(parameters=parameters, equation=equation, at=at, first=first, second=second)
    found = loads(text).stability(over=parameters[0], limits=limits, up_to_hz=up_to_hz, digits=12)
    # Modes on the axis meet and leave it, or one leaves it through 0; the load itself has no poles.
    assert [part.poles for part in found.proved.intervals] == [PoleCount(0, 2 * change), PoleCount(change, 0)]
    (boundary,) = found.proved.boundaries
    assert float(boundary.gain.mid()) == pytest.approx(value, rel=1e-11)
    assert [float(w.mid()) for w in boundary.frequencies] == pytest.approx([omega], rel=1e-10)
    assert found.proved.change(0) == change


def poles_up_to(text, name, limits, radius):
    function = characteristic(loads(text).resolved, (name,), (limits,), has_complex_waves=True)
    return PolesUpTo.of(function, (limits,), radius, 128)


def of_polynomials(poles, *coefficients):
    """Return the same search of polynomials in s, in place of the model's factors."""
    tf, _ = poles.function.at_rest
    s, ring = tf.ratio.ring.generator("s"), tf.ratio.ring
    factors = [sum((c * s**k for k, c in enumerate(each)), ring.constant(0)) for each in coefficients]
    vars(poles).update(_factors=tuple((f, 1) for f in factors), _moving=[*range(len(factors))])
    return poles


def test_a_factor_that_is_there_twice_has_its_poles_twice():
    # A column below Beck's load has two pairs up to 2.5 Hz on the axis; beyond, one pole in each quadrant.
    poles, twice = (poles_up_to(FOLLOWER, "P", (Fraction(19), Fraction(21)), 5 * pi) for _ in range(2))
    vars(twice)["_factors"] = tuple((f, 2) for f, _ in poles._factors)
    for load, right, axis in [(19, 0, 4), (21, 2, 0)]:
        counts = [each.count([Fraction(load)], each.radius) for each in (poles, twice)]
        assert [(c.right, c.axis) for c in counts] == [(right, axis), (2 * right, 2 * axis)]


@pytest.mark.parametrize(("meets", "expected"), [((-6, 1), False), ((6, 1), True), ((-7, 1), True)])
def test_an_arc_is_free_if_no_factor_meets_it(meets, expected):
    poles = of_polynomials(poles_up_to(FOLLOWER, "P", (Fraction(19), Fraction(21)), 6), (1, 1), meets)
    values = poles._on(((Fraction(20), Fraction(20)),))
    assert poles._is_free(values, poles._path("arc", Fraction(6))) is expected


@pytest.mark.parametrize(("factor", "is_free"), [((-15, 2), False), ((-14, 2), True)])
def test_a_box_is_open_while_a_pole_may_meet_its_arc(factor, is_free):
    # 7.5 is the radius of the arc; the axis is clear.
    poles = of_polynomials(poles_up_to(FOLLOWER, "P", (Fraction(19), Fraction(21)), 6), factor)
    box = BoxesUpTo(poles).narrowed(BoxesUpTo(poles).whole(poles.ranges))
    assert poles.axis.end == Fraction(15, 2) and box.is_bounded
    assert not box.pieces[0] and bool(box.pieces[-1]) is not is_free


def test_poles_meet_within_the_piece_that_is_asked_for_or_none_is_known():
    load, omega = Fraction(BECK), Fraction(BECK_OMEGA)
    poles, wide = poles_up_to(FOLLOWER, "P", (Fraction(19), Fraction(21)), 5 * pi), Fraction(1, 10**4)
    ends = load - Fraction(1, 10**9), load + Fraction(1, 10**9)
    low, high = poles._meeting(ends, 0, (omega - wide, omega + wide))
    assert low < omega < high and high - low < wide
    assert poles._meeting(ends, 0, (omega - 3, omega - 3 + wide)) is None


def test_a_piece_below_0_belongs_to_the_cell_it_lies_in():
    text = COLUMN.format(bending="EI*w'''' + j*c*s*w", shear="EI*w'''(L)")
    poles = poles_up_to(text, "P", (Fraction(1), Fraction(2)), 10)
    part = Fraction(1, poles.axis.cells)
    values = poles._on(poles.ranges)
    for number in (-2, -1, 0, 1):
        vars(poles)["_patches"] = {}
        poles._bound(values, poles._moving[0], poles.axis, (number * part, (number + 1) * part))
        assert {key[2] for key in poles._patches} == {number}


@pytest.mark.parametrize(
    ("limits", "loses", "bare", "wide"),
    [
        # A string at its wave speed, 1: its waves are s/(1 - v), 1.25 s at both ends; three times as many.
        (("0.2", "1.8"), True, ["0.85", "1.15"], ["0.7", "1.3"]),
        (("0.2", "0.9"), True, ["0.85"], ["0.7"]),
        (("1.1", "1.8"), True, ["1.2"], ["1.28"]),
        (("1.05", "1.3"), True, [], ["1.25"]),
        (("0.2", "0.4"), False, [], ["0.2", "0.39"]),
    ],
)
def test_next_to_its_wave_speed_a_string_is_bare(limits, loses, bare, wide):
    poles = poles_up_to(STRING, "v", tuple(map(Fraction, limits)), 1.0)
    assert poles._may_lose_order is loses
    for starts, expected in [(bare, True), (wide, False)]:
        for start in map(Fraction, starts):
            assert poles.is_bare((start, start + Fraction(1, 100))) is expected
    if poles.ranges[0][1] > 1 > poles.ranges[0][0]:  # a part with the wave speed in it is too near if narrow
        for half, expected in [(Fraction(1, 1000), True), (Fraction(2, 5), False)]:
            assert poles.is_bare((1 - half, 1 + half)) is expected


def test_poles_without_end_below_the_real_axis_are_no_less_without_end():
    # -(1 + 5 j) P s/5 is minus the square of n pi: all poles n^2 pi^2 (1 - 5 j)/(5.2 P) are on the right.
    text = COLUMN.format(bending="w''", shear="w'''(L)").split("[fields.w]")[0].replace("w(L)", "w'(1)")
    text += """[fields.w]
domain = ["0", "1"]
equation = "w'' + 0.2*P*s*w {sign} j*P*s*w = 0"
conditions = ["w(0) = 0", "w(1) = F"]
"""
    ranges = ((Fraction(1), Fraction(2)),)
    for sign in "+-":
        model = loads(text.replace("{sign}", sign)).resolved
        assert isinstance(
            characteristic(model, ("P",), ranges, has_complex_waves=True).whole(ranges).radius, str
        )
