"""Adding up how far an argument turns, on functions whose turns are known; windings of known polynomials."""

from __future__ import annotations

from cmath import exp, log, phase
from dataclasses import dataclass, field
from itertools import pairwise, product
from math import asin, inf, pi

import pytest
from flint import acb, arb

from symflex.balls import precision
from symflex.budget import Budget
from symflex.errors import BudgetError
from symflex.roots.counting.argument_principle import CertifiedWinding, LogarithmicLine, _angle, _whole
from symflex.roots.counting.local_series import BLURRED, LocalSeries, SeriesSteps, _followed
from symflex.roots.counting.winding import Cell, RootOnPathError, Winding, total_turn
from symflex.roots.functions.kernel_function import ROOM, Sample, angle, deviation
from tests.unit.roots.known_functions import KnownFunction, exact


def test_a_disc_is_seen_from_0_at_twice_the_arc_sine_rounded_up():
    for off, size, seen in [
        (0, 1, 0),
        (1, 2, pi / 6),
        (0.999, 1, asin(0.999)),
        (1, 1, pi / 2),
        (3, 1, 3 * pi / 2),
    ]:
        assert angle(arb(off), arb(size)) == pytest.approx(seen, rel=1e-7)
    assert angle(arb(1) / 3, arb(1)) >= asin(1 / 3)


def test_a_ball_of_values_turns_as_far_as_its_disc_is_seen():
    for ball, turned in [
        (acb(arb(4, 0), arb(0)), 0),
        (acb(arb(4, 2), arb(0)), pi / 6),
        (acb(arb(0), arb(-4, 2)), pi / 6),
        (acb(arb(0, 1), arb(0)), inf),
        (acb(arb("nan"), arb(0)), inf),
        (acb(arb(1, 2), arb(0)), pi),
    ]:
        assert deviation(ball) == pytest.approx(turned, rel=1e-6)


def spiral(turns, *, bound=lambda start, end: 6 * (end - start)):
    """Return a change of argument that is uniform, and notes its steps."""
    steps = []

    def change(start, end):
        off = bound(start, end)
        steps.append((start, end, off <= ROOM))
        return off, arb(2 * pi * turns * (end - start)) if off <= ROOM else arb(1000)

    return change, steps


def test_steps_cover_the_path_once_and_none_is_taken_that_may_have_turned_by_more():
    for first in [0.01, 0.3, 1, 5]:
        change, steps = spiral(2.5)
        assert float(total_turn(change, first, 1e-6)) == pytest.approx(5 * pi)
        taken = [(start, end) for start, end, short in steps if short]
        assert (taken[0][0], taken[-1][1]) == (0, 1), first
        assert all(a[1] == b[0] for a, b in pairwise(taken)), first
        assert steps[0][1] == min(1, first)
    change, steps = spiral(1, bound=lambda start, end: ROOM * (end - start) / 0.125)
    total_turn(change, 0.125, 1e-6)
    assert all(end - start <= 0.125 for start, end, short in steps if short)
    assert steps[0][2]


def test_a_root_on_the_path_ends_in_steps_that_are_too_short():
    change, steps = spiral(1, bound=lambda start, end: inf if start <= 0.5 <= end else 0.1)
    with pytest.raises(RootOnPathError):
        total_turn(change, 0.2, 1e-3)
    assert 1e-3 <= min(end - start for start, end, _ in steps) < 2.1e-3


# ------------------------------------------------------------------------------------- certified paths


def test_a_steps_ball_holds_the_path_and_its_reach_the_distance_from_its_middle():
    for start, path in product(
        [0.0, 0.2, 0.75],
        [
            LogarithmicLine(complex(1, 0), complex(1, pi)),
            LogarithmicLine(complex(-2, pi / 2), complex(3, pi / 2)),
            LogarithmicLine(complex(2, -1), complex(-1, 2)),
            LogarithmicLine(complex(40, 3), complex(40, -3)),
        ],
    ):
        end = min(1.0, start + 0.125)
        with precision(64):
            ball, centre, reach = path.step(start, end)
            ends = path.step(start, end)[0]
        with precision(200):
            for i in range(65):
                t = start + (end - start) * i / 64
                point = path.point(t)
                assert ball.overlaps(point), (start, path)
                assert abs(point - centre).lower() <= reach * (1 + 2.0**-30), (start, path)
            assert ends.contains(path.point((start + end) / 2).mid())
            # No larger than it has to be.
            length = sum(
                abs(path.point(start + i / 512) - path.point(start + (i + 1) / 512)) for i in range(64)
            )
            assert reach < length * 0.74, (start, path)


def test_an_end_is_met_exactly_and_doubles_nearest_to_pi_stand_for_pi():
    with precision(200):
        assert LogarithmicLine(0j, complex(0, pi)).point(1).contains(acb(-1))
        assert LogarithmicLine(complex(0, -pi / 2), 1j).point(0).contains(acb(0, -1))
        assert LogarithmicLine(complex(1, 0), complex(2, 0)).point(1).contains(acb(2).exp())
        assert float(abs(LogarithmicLine(0j, complex(0, pi)).point(1) + 1).upper()) < 1e-50
        for share in (1, -1, 0.5, -0.5):
            assert _angle(share * pi).overlaps(share * arb.pi()), share
            assert not _angle(share * pi).contains(arb(share * pi)), share
        assert (_angle(1.5), _angle(0.0)) == (arb(1.5), 0)


def test_turns_are_whole_where_one_integer_is_in_the_ball():
    assert _whole(arb(-2, 0.9)) == -2
    for ball in (arb(0.5, 0.1), arb(1, 1.1)):
        with pytest.raises(RootOnPathError):
            _whole(ball)


@dataclass(frozen=True, eq=False)
class Followed(KnownFunction):
    """A known product with what windings ask of a function; its exponents may be negative."""

    cancels: bool = False
    work: int = 0
    levels: list = field(default_factory=list)

    def turn_of_exponentials(self, ball, start, end, bits):
        return None

    def enclosed(self, s, bits):
        self.levels.append(bits)
        return super().enclosed(s, bits)

    def order_at_zero(self):
        return self.power * sum(e * sum(bool(r == 0) for r in roots) for roots, e in self.roots)

    def at_logarithm(self, z):
        point = acb(z.real, z.imag).exp()
        values = [(*self.value_and_slope(i, point), e) for i, (_, e) in enumerate(self.roots)]
        if any(value == 0 for value, _, _ in values):
            return None
        total = sum(e * log(complex(value)) for value, _, e in values)
        slope = sum(e * complex(point * change / value) for value, change, e in values)
        return Sample(total * self.power, slope * self.power)

    def reach(self, radius):
        return radius

    def count_inside(self, within):
        return self.power * sum(e * sum(within(complex(r)) for r in roots) for roots, e in self.roots)


PRODUCTS = {
    "simple": (((1, (0, 2), (0, -2)), 1),),
    "double": (((1, 1), 1), (((-3, 1), (-3, -1)), 2)),
    "quotient": (((4, (1, 1), (1, -1)), 1), (((2, 3), (2, -3), -5), -1)),
    "at zero": (((0, 0, 3), 1), ((-2,), 3)),
}
CELLS = [Cell(-1, 1, -1, 1), Cell(0.5, 2, -2, 2), Cell(-0.5, 2.5, 0.1, 3.1), Cell(1, 1.7, 0.5, pi)]


def test_a_cell_holds_as_many_roots_as_were_put_there():
    for power, cell, name, kind in product([1, 2], CELLS, PRODUCTS, [Winding, CertifiedWinding]):
        function = Followed(PRODUCTS[name], power=power)
        expected = function.count_inside(lambda root, cell=cell: root != 0 and cell.holds(log(root)))
        try:
            assert kind(function).count(cell) == expected, (power, name)
        except RootOnPathError:
            # The cell's edge at pi is the negative real axis.
            assert cell.left == pi, (power, name, kind)
            assert any(
                complex(r).real < 0 == complex(r).imag for roots, _ in function.roots for r in roots
            ), (power, cell, name, kind)


def test_a_disc_about_0_holds_as_many_roots_as_were_put_there():
    for name, radius in product(PRODUCTS, [0.5, 1.5, 2.5, 3.05, 10]):
        function = Followed(PRODUCTS[name])
        expected = function.count_inside(lambda root, radius=radius: abs(root) < radius)
        found = CertifiedWinding(function).count_within(float(log(radius).real), pi)
        assert found == expected, (name, radius)


def test_a_turn_is_the_change_of_the_argument():
    for start, end in [(0j, 2 + 0j), (0.3 + 0.2j, 1 + 2j), (2 + 3j, -1 + 0.5j), (1j, 3j)]:
        function = Followed((((9, (-5, 8)), 2), (((0, 30),), -1)))
        values = [
            sum(
                phase(complex(function.value_and_slope(i, acb(z.real, z.imag).exp())[0])) * e
                for i, (_, e) in enumerate(function.roots)
            )
            for z in (start, end)
        ]
        certified = CertifiedWinding(function).certified_turn(start, end)
        plain = Winding(function).turn(start, end)
        difference = values[1] - values[0]
        assert (float(certified) - difference) / (2 * pi) == pytest.approx(
            round((float(certified) - difference) / (2 * pi)), abs=1e-9
        ), start
        assert plain == pytest.approx(float(certified)), start
        assert float(certified.rad()) < 1e-9, start


@dataclass(frozen=True, eq=False)
class Made(Followed):
    """A function whose values a test makes of the product's, s and bits; it notes where it is asked."""

    make: object = None
    asked: list = field(default_factory=list)

    def value(self, s, bits):
        self.asked.append(s)
        with precision(bits):
            own = super().value(s, bits)
            return self.make(own, s, bits) if self.make else own


BESIDE = (((-18,), 1),)
"""Seen from 2, at 20."""


def test_a_power_series_tells_how_far_a_step_turns():
    for radius, turned in [(0.05, True), (0.3, True), (1.2, False)]:
        # One root is a unit away from the middle of the step.
        function = Followed((((1, (-4, 2)), 1),))
        steps = SeriesSteps(function)
        with precision(200):
            start, end = acb(2) - arb(radius) * acb(0, 1), acb(2) + arb(radius) * acb(0, 1)
            exact_turn = sum(
                ((end - root).arg() - (start - root).arg() for root in function.roots[0][0]), arb(0)
            )
        bound, turn = steps.change(acb(2), arb(radius), start, end, 64)
        if turned:
            assert bound <= ROOM, radius
            assert turn.overlaps(exact_turn), radius
            assert float(turn.rad()) < 1e-5, radius
        else:
            # The disc holds the root: the argument may wind.
            assert bound > ROOM, radius


def steep():
    """Return ``((s + 98)/100)^600``: about 2 like ``exp(6 (s - 2))``."""
    return Made((), make=lambda own, s, bits: ((s + 98) / 100) ** 600)


def turn_of_steep(start, end):
    with precision(200):
        return 600 * ((end + 98).arg() - (start + 98).arg())


def test_what_grows_like_an_exponential_is_followed_by_the_steps_own_series():
    start, end = acb(2, -0.5), acb(2, 0.5)
    bound, turn = SeriesSteps(steep()).change(acb(2), arb(0.5), start, end, 64)
    assert bound <= ROOM
    assert turn.overlaps(turn_of_steep(start, end))
    assert float(turn.rad()) < 1e-5
    assert turn > 5.9
    # 1.1 left of the middle the function is exp(6.6) smaller, and lost in the wide series.
    steps = SeriesSteps(steep())
    assert steps.change(acb(2), arb(0.5), acb(2, -0.5), acb(2, 0.5), 64)[0] <= ROOM
    steps.change(acb(2), arb(1), acb(2, -1), acb(2, 1), 64)
    start, end = acb(arb(0.9), -0.45), acb(arb(0.9), 0.45)
    bound, turn = steps.change(acb(0.9), arb(0.45), start, end, 64)
    assert bound <= ROOM
    assert turn.overlaps(turn_of_steep(start, end))


def test_a_function_far_smaller_than_its_bound_takes_more_terms_whatever_its_size():
    # 1 + (x/1.02)^155 is 1 in the middle, and exp(212) on four times the radius.
    for size in (0, -8000):
        flat = Made((), make=lambda own, s, bits, n=size: (1 + ((s - 2) * 50 / 51) ** 155) * arb(10) ** n)
        bound, turn = SeriesSteps(flat).change(acb(2), arb(1), acb(2, -1), acb(2, 1), 64)
        assert bound == pytest.approx(asin((50 / 51) ** 155), rel=1e-4), size
        with precision(200):
            # j^155 = -j
            assert turn.overlaps(-2 * ((arb(50) / 51) ** 155).atan()), size
        assert float(turn.rad()) < 1e-5, size


def test_a_small_difference_of_large_terms_and_a_middle_not_told_from_0_are_no_obstacle():
    def difference(own, s, bits, size):
        term = arb(10) ** size * arb.pi()
        return (own + term) - term

    def blurred(own, s, bits, least):
        return own + (acb(arb(0, 1000), arb(0, 1000)) if bits < least else acb(0))

    for make, given, bits in (
        (difference, 35, 64),
        (difference, 35, 100),
        (difference, 90, 160),
        (blurred, 300, 64),
        (blurred, 900, 500),
    ):
        function = Made(BESIDE, make=lambda own, s, level, make=make, given=given: make(own, s, level, given))
        bound, turn = SeriesSteps(function).change(acb(2), arb(1), acb(2, -1), acb(2, 1), bits)
        assert bound <= ROOM, (make, given)
        assert turn.overlaps(2 * (arb(1) / 20).atan()), (make, given)
        assert float(turn.rad()) < 1e-5, (make, given)


def test_of_a_function_that_is_0_everywhere_nothing_is_told():
    steps = SeriesSteps(Made((), make=lambda own, s, bits: acb(0)))
    assert steps.change(acb(2), arb(1), acb(1), acb(3), 64)[0] == inf


def test_a_step_reaches_as_far_as_its_middle_may_lie_off():
    for off, is_told in [(0.9, False), (3, True)]:
        # The middle is told to half a unit, the step goes half a unit further.
        steps = SeriesSteps(Followed(((((arb(2) + off, 0),), 1),)))
        bound, _ = steps.change(acb(arb(2, 0.5), 0), arb(0.5), acb(2), acb(2), 64)
        assert (bound <= ROOM) is is_told, off


def test_what_a_product_of_series_is_cut_off_by_is_bounded_by_cauchys_estimate():
    for unit, (extra, is_sharp) in product([(1, 0), (0, 1), (0.6, -0.8)], [(1.2e-8, True), (1.4e-8, False)]):
        # A constant 1 with 13 terms, on three times the radius: 3^-13/(1 - 1/3) = 9.41e-7, at most 2^-20.
        missing = extra / (0.25**13 / 0.75)
        with precision(160):
            series = LocalSeries(acb(2), (acb(*unit), *[acb(0)] * 11, acb("1e-30")), arb(4), arb(missing))
            bound, turn = _followed(series, acb(2), arb(1), acb(1), acb(3))
            assert (bound < 1e-5) is is_sharp, unit
            assert is_sharp or bound == BLURRED, unit
            assert turn.contains(0), (unit, extra)
            assert float(turn.rad()) >= 2 * (9.408e-7 + extra) * 0.99, unit
            assert float(turn.rad()) <= 2 * (9.408e-7 + extra) * 1.5, unit


def test_a_series_is_bounded_where_it_is_largest():
    for terms, is_sharp in [(14, False), (15, True)]:
        # 1 + x^2/2 on three times the radius is up to 5.5; 5.5 * 1.5 / 3^14 is more than 2^-20, a third less.
        with precision(160):
            coefficients = (acb(1), acb(0), acb(0.5), *[acb(0)] * (terms - 4), acb("1e-30"))
            bound, _ = _followed(
                LocalSeries(acb(2), coefficients, arb(4), arb(0)), acb(2), arb(1), acb(1), acb(3)
            )
            assert bound == (pytest.approx(asin(0.5), rel=1e-4) if is_sharp else BLURRED), terms


def exponential(rate, terms):
    found = [acb(1)]
    for n in range(1, terms):
        found.append(found[-1] * rate / n)
    return tuple(found)


def test_an_exponential_turns_by_itself_and_leaves_nothing():
    for growth in [(0.5, 0), (0, 2), (-1, -0.75)]:
        with precision(200):
            rate = acb(*growth)
            series = LocalSeries(acb(2), exponential(rate, 60), arb(8), arb(1e9))
            bound, turn = _followed(series, acb(2), arb(0.5), acb(2, -0.5), acb(2.25, 0.25))
            assert bound < 1e-12, growth
            assert turn.overlaps((rate * acb(0.25, 0.75)).imag), growth
            assert float(turn.rad()) < 1e-12, growth


def test_what_is_cut_off_or_missing_counts_by_both_factors_where_they_are_largest():
    for terms, is_sharp in [(18, False), (19, True)]:
        # exp(x) and exp(-x) are up to exp(3) on three times the radius: exp(6) * 1.5/3^19 is less than 2^-20.
        with precision(160):
            series = LocalSeries(acb(2), exponential(1, terms), arb(100), arb(0))
            assert (_followed(series, acb(2), arb(1), acb(1), acb(3))[0] < BLURRED) is is_sharp, terms
    for extra, is_sharp in [(0.9, True), (1.1, False)]:
        # Divided by exp(2x), on a radius of one.
        missing = extra * 2.0**-20 * exp(-2).real / (0.25**40 / 0.75)
        with precision(160):
            series = LocalSeries(acb(2), exponential(2, 40), arb(4), arb(missing))
            bound, turn = _followed(series, acb(2), arb(1), acb(2, -1), acb(2, 1))
            assert (bound < BLURRED) is is_sharp, extra
            assert turn.contains(4), extra
            assert float(turn.rad()) > 2 * extra * 2.0**-20


def test_a_coefficient_counts_with_all_that_it_may_be_also_0_in_the_middle():
    for order in [1, 2, 5]:
        coefficients = [acb(1), *[acb(0)] * 20, acb("1e-30")]
        coefficients[order] = acb(arb(0, 0.5))
        with precision(160):
            series = LocalSeries(acb(2), tuple(coefficients), arb(4), arb(0))
            bound, _ = _followed(series, acb(2), arb(1), acb(1), acb(3))
        assert bound == pytest.approx(asin(0.5), rel=1e-4), order
    for coefficients in [
        (1,),
        (0, 1, 2),
        (acb(arb(0, 1)), 1, 2),
        (acb("nan"), 1, 1),
        (1, 1, acb("nan")),
        (1, acb("inf"), 1),
    ]:
        series = LocalSeries(acb(2), tuple(acb(c) for c in coefficients), arb(8), arb(0))
        assert _followed(series, acb(2), arb(0.5), acb(1.5), acb(2.5))[0] == inf, coefficients


@dataclass(frozen=True, eq=False)
class Exponentials(Followed):
    """A function whose sum of exponentials tells how far it turns on short steps only."""

    longest: float = 0.05

    def turn_of_exponentials(self, ball, start, end, bits):
        off = float(abs(end - start).upper()) / self.longest
        turn = arb(0)
        for roots, exponent in self.roots:
            for root in roots:
                turn += exponent * ((end - root) / (start - root)).arg()
        return (off, turn) if off <= ROOM else (off, arb(-77))


CELL = Cell(0, 1.5, 0.2, 3)


def in_cell(function):
    return function.count_inside(lambda root: CELL.holds(log(root)))


def test_series_help_where_steps_are_too_long_for_exponentials():
    @dataclass(frozen=True, eq=False)
    class Function(Exponentials):
        is_analytic: bool = True

        def is_analytic_on(self, ball, bits):
            self.levels.append(bits)
            return self.is_analytic

    for tries_series, is_analytic in product((True, False), repeat=2):
        function = Function(PRODUCTS["double"], is_analytic=is_analytic)
        winding = CertifiedWinding(function, tries_series=tries_series)
        assert winding.count(CELL) == in_cell(function), (tries_series, is_analytic)
        assert function.levels or not tries_series, is_analytic


def test_series_serve_alone_where_no_step_is_short_enough_for_exponentials():
    @dataclass(frozen=True, eq=False)
    class Hopeless(Followed):
        wrong: int = 0

        def turn_of_exponentials(self, ball, start, end, bits):
            return 2 * ROOM, arb(self.wrong)

    for wrong in (77, -77):
        function = Hopeless(PRODUCTS["double"], wrong=wrong)
        assert CertifiedWinding(function, tries_series=True).count(CELL) == in_cell(function), wrong
        with pytest.raises(RootOnPathError):
            CertifiedWinding(function).count(CELL)


def test_small_cells_and_functions_without_a_formula_are_counted():
    for name in ["simple", "double"]:
        function = Followed(PRODUCTS[name])
        around, half = log(exact(function.roots[0][0][0])), 1e-5
        cell = Cell(around.real - half, around.real + half, around.imag - half, around.imag + half)
        expected = function.count_inside(lambda root, cell=cell: cell.holds(log(root)))
        assert expected >= 1, name
        assert CertifiedWinding(function).count(cell) == expected, name
    function = Followed(PRODUCTS["double"], cancels=True)
    assert CertifiedWinding(function).count(CELL) == in_cell(function)


def test_a_step_on_which_nothing_is_known_proves_nothing():
    @dataclass(frozen=True, eq=False)
    class Unknown(Followed):
        broken: str = ""

        def enclosed_about(self, ball, centre, bits):
            found = super().enclosed_about(ball, centre, bits)
            if self.broken == "slope":
                return [(v, acb("nan"), e) for v, d, e in found]
            return [(acb(arb(0, 1)), d, e) for v, d, e in found]

    for broken in ("value", "slope"):
        winding = CertifiedWinding(Unknown(PRODUCTS["double"], broken=broken))
        assert winding._change(LogarithmicLine(1j, 2 + 1j), 0.0, 0.01, 64)[0] == inf, broken


@dataclass(frozen=True, eq=False)
class Lost(Followed):
    """A function that is not told from 0 with fewer bits than so many."""

    least: float = inf

    def blurred(self, found, bits):
        blur = acb(arb(0, 1e3), arb(0, 1e3)) if bits < self.least else acb(0)
        return [(value + blur, slope, e) for value, slope, e in found]

    def enclosed(self, s, bits):
        return self.blurred(super().enclosed(s, bits), bits)

    def enclosed_about(self, ball, centre, bits):
        return self.blurred(super().enclosed_about(ball, centre, bits), bits)


def test_the_precision_is_raised_where_a_factor_is_lost_and_the_path_ends_where_it_stays_lost():
    for least in (200, 1000):
        function = Lost(PRODUCTS["simple"], least=least)
        assert CertifiedWinding(function).count(Cell(-1, 0.5, -1, 1)) == 1
        assert max(function.levels) < 4 * least
    with pytest.raises(RootOnPathError):
        CertifiedWinding(Lost(PRODUCTS["simple"])).count(Cell(-1, 0.5, -1, 1))


# ----------------------------------------------------------------------------------- cells and samples


def test_a_cell_has_a_centre_and_a_size_and_is_cut_across_its_longer_side():
    assert (Cell(1, 3, 2, 5).centre, Cell(1, 3, 2, 5).size, Cell(0, 7, 2, 5).size) == (2 + 3.5j, 3, 7)
    for cell, parts in [
        (Cell(0, 4, 0, 2), (Cell(0, 1, 0, 2), Cell(1, 4, 0, 2))),
        (Cell(1, 3, 2, 6), (Cell(1, 3, 2, 3), Cell(1, 3, 3, 6))),
        (Cell(0, 4, 1, 5), (Cell(0, 1, 1, 5), Cell(1, 4, 1, 5))),
    ]:
        assert cell.split(0.25) == parts, cell


def test_a_cell_holds_points_inside_and_in_its_margin():
    for margin, inside, outside in (
        (0, [2 + 3j], [1 + 3j, 3 + 3j, 2 + 2j, 2 + 5j, 9 + 3j]),
        (0.2, [0.9 + 3j, 3.1 + 3j, 2 + 1.9j, 2 + 5.1j], [0.7 + 3j, 3.3 + 3j, 2 + 1.7j, 2 + 5.3j]),
    ):
        held = [z for z in inside + outside if Cell(1, 3, 2, 5).holds(z, margin)]
        assert held == inside, margin


def test_what_is_left_around_a_hole_is_the_cell_without_it():
    cell = Cell(0, 4, 0, 3)
    for hole in (
        *(Cell(1, 2, 1, 2), Cell(-1, 2, 1, 2), Cell(3, 9, -1, 9), Cell(1, 2, -5, 5), Cell(-9, 9, -9, 9)),
        # Holes that only touch.
        *(Cell(4, 5, 0, 3), Cell(-2, 0, 0, 3), Cell(0, 4, 3, 4), Cell(0, 4, -1, 0)),
    ):
        left = cell.without(hole)
        if not (hole.low < 4 and hole.high > 0 and hole.right < 3 and hole.left > 0):
            assert left == (cell,), hole
        for x in range(1, 40, 2):
            for y in range(1, 30, 2):
                z = complex(x / 10 + 0.01, y / 10 + 0.01)
                assert sum(part.holds(z) for part in left) == (not hole.holds(z)), (hole, z)


def test_within_the_smallest_radius_are_only_roots_at_0_and_it_stays_away_from_holes():
    for name, given in PRODUCTS.items():
        function = Followed(given)
        z = Winding(function).smallest(pi)
        least = min(abs(complex(r)) for roots, _ in function.roots for r in roots if r != 0)
        assert log(least).real - 8 < z < log(least).real, name
    function = Followed(PRODUCTS["simple"])
    hole = Cell(-9, -8, 0, 1)
    assert Winding(function).smallest(pi, [hole]) <= -9 - log(2).real


def refused(call):
    """Return the code, message and hint with which a call is refused."""
    with pytest.raises(BudgetError) as caught:
        call()
    (found,) = caught.value.diagnostics
    return found.code, found.message, found.hint


FEWER = "ask for fewer modes or a smaller region"


def test_a_function_without_a_lowest_root_is_said_to_have_none():
    class Wrong(Followed):
        def order_at_zero(self):
            return 5

    hint = "ask for a band, which needs no lowest root"
    winding = Winding(Wrong(PRODUCTS["simple"]))
    assert refused(lambda: winding.smallest(pi)) == ("SF505", "the lowest root cannot be found", hint)


def test_work_has_an_end_where_no_time_is_given():
    too_long = "SF505", "the search for roots takes too long", FEWER
    assert refused(Winding(Followed(PRODUCTS["simple"], work=5_000_001)).spend) == too_long
    Winding(Followed(PRODUCTS["simple"], work=5_000_000)).spend()
    with Budget(1000.0).entered():
        Winding(Followed(PRODUCTS["simple"], work=5_000_001)).spend()
    winding = Winding(Followed(PRODUCTS["simple"]))
    code, _, hint = refused(lambda: winding.turn(0j, complex(0, 3e6)))
    assert (code, hint) == ("SF505", FEWER)
