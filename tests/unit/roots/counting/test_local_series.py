"""Local series of polynomials, whose coefficients and roots are known, at the edge of what they prove."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import product

import pytest
from flint import acb, arb

from symflex.balls import precision
from symflex.roots.counting.local_series import LocalSeries, bound_on_circle, sampled_series
from tests.unit.roots.known_functions import KnownFunction

CENTRE = acb(2, 3)


def known(*roots, power=1, exponent=1):
    return KnownFunction(((roots, exponent),), scale=1, power=power)


def offsets(*values):
    """Return roots that lie so far from the centre along the real axis."""
    return [(arb(2) + arb(v), arb(3)) for v in values]


def taylor(values):
    """Return the coefficients of prod(x - v) from the elementary symmetric polynomials."""
    found = [Fraction(1)]
    for v in values:
        found = [a - Fraction(v) * b for a, b in zip([0, *found], [*found, 0], strict=True)]
    return found


FOUR = (Fraction(1, 2), Fraction(-1, 4), Fraction(3), Fraction(-5))


def test_coefficients_are_enclosed_however_few_values_there_are():
    for (points, terms), shrunk in product([(20, 16), (8, 8), (5, 16), (6, 3)], [0.25, 2.0**-6]):
        function = known(*offsets(*(float(v) for v in FOUR)))
        reach = arb(8)
        bound = bound_on_circle(function, CENTRE, reach, 32)
        series = sampled_series(function, CENTRE, reach, bound, 200, points, terms, shrunk)
        assert len(series.coefficients) == min(points, terms), shrunk
        expected = [*taylor(FOUR), *([0] * 20)]
        with precision(200):
            for found, exact in zip(series.coefficients, expected, strict=False):
                assert found.contains(
                    acb(arb(int(Fraction(exact).numerator)) / int(Fraction(exact).denominator))
                ), (points, shrunk)


def test_the_bound_on_a_circle_is_at_least_the_largest_value_wherever_it_lies_and_close_to_it():
    for arcs in [1, 2, 16, 32]:
        # Of (s - c + 1/2)^3 on the unit circle about c: (3/2)^3, at the right.
        function = known(*offsets(-0.5, -0.5, -0.5))
        bound = float(bound_on_circle(function, CENTRE, arb(1), arcs))
        assert bound >= 1.5**3, arcs
        if arcs == 32:
            assert bound < 1.5**3 * 1.6, arcs
    for direction in [(1, 0), (-1, 0), (0, 1), (0, -1), (-0.6, 0.8), (0.8, -0.6)]:
        opposite = (arb(2) - arb(direction[0]) * 0.9, arb(3) - arb(direction[1]) * 0.9)
        bound = bound_on_circle(known(*[opposite] * 6), CENTRE, arb(1), 16)
        assert float(bound) >= 1.9**6 * (1 - 1e-9), direction


def test_nothing_is_bounded_where_a_function_branches():
    @dataclass(frozen=True, eq=False)
    class Branching(KnownFunction):
        def is_analytic_on(self, ball, bits):
            return not ball.contains(acb(2, 4))

    function = Branching((((0,), 1),))
    assert bound_on_circle(function, CENTRE, arb(0.99), 8) is not None
    assert bound_on_circle(function, CENTRE, arb(1.01), 8) is None


def told(*sizes, reach=8.0, bound=0.0):
    return LocalSeries(CENTRE, tuple(acb(size) for size in sizes), arb(reach), arb(bound))


def test_one_term_has_to_outweigh_all_others():
    for sizes, radius, count in [
        ([3, 1, 1], 1, 0),
        ([1, 3, 1], 1, 1),
        ([-1, 1, 2.5], 1, 2),
        ([1, 2, 1], 1, None),
        ([1, 2.01, 1], 1, 1),
        ([1, 1.99, 1], 1, None),
        # Of radius two the highest terms have four and two times their weight.
        ([1, 2.6, 1], 2, 1),
        ([1, 2.5, 1], 2, None),
        ([1, 1, 1], 2, 2),
        ([0, 0, 0], 1, None),
    ]:
        assert told(*sizes).count(arb(radius)) == count


def test_one_term_and_what_is_missing_have_to_be_weighed_within_the_reach():
    for bound, count in [(0.99, 1), (1.01, None)]:
        # Three terms: bound * (1/8)^3 / (1 - 1/8) on the unit circle, here as much as 1 at bound = 448.
        assert told(1, 3, 1, bound=448 * bound).count(arb(1)) == count
    for radius, count in [(7.99, 0), (8, None), (9, None)]:
        assert told(1).count(arb(radius)) == count


def test_a_series_about_another_point_within_its_reach_is_taylors():
    values = (Fraction(1, 2), Fraction(-1), Fraction(3, 4))
    coefficients = taylor(values)
    series = told(*(float(c) for c in coefficients), reach=8.0, bound=700.0)
    (found, rest) = series.around(CENTRE + acb("0.25"), arb("0.5"))
    assert [complex(c) for c in found] == pytest.approx(
        [float(c) for c in taylor([v - Fraction(1, 4) for v in values])]
    )
    # Terms from the fourth on, at 0.75 of 8.
    assert float(rest) == pytest.approx(700 * (0.75 / 8) ** 4 / (1 - 0.75 / 8), rel=1e-9)
    for radius, is_told in [(6.9, True), (7.1, False)]:
        assert (told(1, 2, 3).around(CENTRE + acb(0, 1), arb(radius)) is not None) is is_told


def test_the_middle_of_some_roots_is_their_mean_if_the_highest_term_is_known():
    for values in [(0.01,), (0.01, -0.03), (0.01, 0.02, -0.06)]:
        near = [Fraction(v).limit_denominator(100) for v in values]
        coefficients = taylor([*near])
        mean = 2 + float(sum(near)) / len(near)
        found = told(*(float(c) for c in coefficients)).middle(len(values))
        assert complex(found) == pytest.approx(mean + 3j), values
        assert float(found.real.rad()) == 0, values
    assert told(1, 1, 0).middle(2) is None


def test_the_error_of_few_values_is_cauchys():
    # a_(n + points) r^points is what n values cannot tell from a_n, at most bound (r/R)^points / R^n.
    function = known(*offsets(0.5))
    series = sampled_series(function, CENTRE, arb(8), arb(1000), 400, 10, 10, 0.25)
    with precision(400):
        for n, coefficient in enumerate(series.coefficients):
            aliased = 1000 * 0.25**10 / (1 - 0.25**10) / 8.0**n
            assert float(coefficient.real.rad()) == pytest.approx(aliased, rel=1e-6)
            assert float(coefficient.imag.rad()) == pytest.approx(aliased, rel=1e-6)
