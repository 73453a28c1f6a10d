"""Adding up how far an argument turns, on functions whose turns are known; windings of known polynomials."""

from __future__ import annotations

from cmath import exp, log
from dataclasses import dataclass, field
from itertools import product
from math import asin, pi

import pytest
from flint import acb, arb

from symflex.balls import precision
from symflex.roots.counting.argument_principle import CertifiedWinding, LogarithmicLine, _whole
from symflex.roots.counting.local_series import BLURRED, LocalSeries, SeriesSteps, _followed
from symflex.roots.counting.winding import Cell, RootOnPathError, Winding, total_turn
from symflex.roots.functions.entire import Sample
from symflex.roots.functions.kernel_function import ROOM, angle
from tests.unit.roots.known_functions import KnownFunction


def test_a_disc_is_seen_from_0_at_twice_the_arc_sine_rounded_up():
    for off, size, seen in [
        (0, 1, 0), (1, 2, pi / 6), (0.999, 1, asin(0.999)), (1, 1, pi / 2), (3, 1, 3 * pi / 2),
    ]:  # fmt: skip
        assert angle(arb(off), arb(size)) == pytest.approx(seen, rel=1e-7)
    assert angle(arb(1) / 3, arb(1)) >= asin(1 / 3)


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


def test_a_cell_about_the_negative_axis_is_counted_by_its_upper_half():
    cell = Cell(0.5, 2.0, pi - 0.5, pi + 0.5)
    assert len(cell.upper_edges) == 3
    assert CertifiedWinding(Followed(PRODUCTS["double"])).count(cell) == 4
    assert CertifiedWinding(Followed(PRODUCTS["at zero"])).count(cell) == 3
    assert not Cell(0.5, 2.0, pi - 0.5, pi + 0.4).upper_edges


def test_steps_leap_where_another_bound_makes_them_small_no_longer():
    calls = []

    def change(start, end):
        calls.append(start)
        return (5.0 if start == 0 and end > 1e-4 else 1e-3), arb(end - start)

    assert total_turn(change, 1.0, 1e-9).contains(1)
    assert len(calls) < 30


def test_a_disc_about_0_holds_as_many_roots_as_were_put_there():
    for name, radius in product(PRODUCTS, [0.5, 1.5, 2.5, 3.05, 10]):
        function = Followed(PRODUCTS[name])
        expected = function.count_inside(lambda root, radius=radius: abs(root) < radius)
        found = CertifiedWinding(function).count_within(float(log(radius).real), pi)
        assert found == expected, (name, radius)


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
            # The disc contains the root: the argument may wind.
            assert bound > ROOM, radius


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
