"""Roots proved one by one, of polynomials whose roots are known."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import acb, acb_poly, arb, arb_poly, fmpz_poly

from symflex.budget import Budget
from symflex.errors import BudgetError
from symflex.roots import precision
from symflex.roots.polynomials import isolation
from symflex.roots.polynomials.discs import LevelPolynomial
from symflex.roots.polynomials.isolation import _holds_one, _single, differs_from_zero, prove_singly
from symflex.roots.problem import PolynomialInS


def with_roots(*factors):
    """Return a polynomial from ascending integer factors."""
    product = fmpz_poly([1])
    for factor in factors:
        product *= fmpz_poly(factor)
    return PolynomialInS.from_integers([int(c) for c in product.coeffs()])


def real(value):
    fraction = Fraction(value)
    return [-fraction.numerator, fraction.denominator]


PAIR = [25, 6, 1]
CASES = {
    "apart": ([real(1), real(-4), PAIR], [1, -4, -3 + 4j]),
    "close": ([real("1"), real("1000001/1000000"), real(90)], [1, 1.000001, 90]),
    "far": ([real(10**9), real("1/1000000000"), PAIR], [1e9, 1e-9, -3 + 4j]),
}


@pytest.mark.parametrize("digits", [10, 80])
@pytest.mark.parametrize("name", CASES)
def test_every_disc_holds_one_root_and_every_root_has_one(name, digits):
    factors, roots = CASES[name]
    discs = list(prove_singly(with_roots(*factors), digits, Budget(), in_square=False))
    assert len(discs) == len(roots)
    with precision(600):
        for root in roots:
            exact = acb(root) if name != "close" or root != 1.000001 else acb(arb(1000001) / 1000000)
            exact = acb(arb(1) / 10**9) if root == 1e-9 else exact
            near = [d for d in discs if abs(d.centre - exact) < d.radius]
            assert len(near) == 1
            assert near[0].is_real is (complex(root).imag == 0)
            assert near[0].radius < abs(exact) * arb(10) ** -digits


def test_in_the_square_discs_are_small_enough_for_the_roots_digits():
    # z = -4: s = 2j; the same relative accuracy and some more.
    (disc,) = prove_singly(with_roots(real(-4)), 30, Budget(), in_square=True)
    with precision(600):
        assert abs(disc.centre + 4) < disc.radius
        assert disc.radius < arb(10) ** -30


def test_no_disc_is_returned_of_roots_that_are_not_told_apart(monkeypatch):
    monkeypatch.setattr(
        isolation, "guess_by_laguerre", lambda value, budget: iter([acb(1.01), acb(0.99), acb(5.1)])
    )
    discs = list(prove_singly(with_roots(real(1), real(5)), 10, Budget(), in_square=False))
    assert [round(float(d.centre.real.mid()), 6) for d in discs] == [1, 5]


def test_a_guess_that_leads_nowhere_is_left_out(monkeypatch):
    # Between both roots the slope vanishes.
    monkeypatch.setattr(isolation, "guess_by_laguerre", lambda value, budget: iter([acb(3), acb(5.1)]))
    discs = list(prove_singly(with_roots(real(1), real(5)), 10, Budget(), in_square=False))
    assert [round(float(d.centre.real.mid()), 6) for d in discs] == [5]


def test_the_budget_is_spent_at_every_step():
    class Spent(Budget):
        def spend(self):
            raise BudgetError

    with pytest.raises(BudgetError):
        list(prove_singly(with_roots(real(1)), 10, Spent(), in_square=False))


def level_of(*factors):
    level = LevelPolynomial.of(acb_poly(with_roots(*factors).enclosure()), Budget())
    return level, arb_poly([abs(c).upper() for c in level.slope.derivative()])


def test_newtons_steps_go_on_until_the_disc_is_as_small_as_wanted():
    with precision(400):
        level, bend = level_of(real(2), real(-7))
        disc = _single(level, bend, acb(arb("2.000001").mid()), lambda centre: arb(10) ** -40)
        assert disc.radius <= arb(10) ** -40
        assert abs(disc.centre - 2) < disc.radius
        # Four steps from so far away do not reach a thousand digits.
        assert _single(level, bend, acb(arb("2.000001").mid()), lambda centre: arb(10) ** -1000) is None


def test_a_root_met_exactly_gets_a_disc_of_half_the_size_wanted():
    with precision(100):
        level, bend = level_of(real(2), real(-7))
        disc = _single(level, bend, acb(2), lambda centre: arb(0.25))
        assert (disc.centre, float(disc.radius)) == (acb(2), 0.125)


def test_a_disc_is_twice_newtons_step():
    with precision(100):
        level, bend = level_of(real(2))
        # p = s - 2 bends nowhere: the step from 2.5 is 0.5.
        disc = _single(level, bend, acb(2.5), lambda centre: arb(1))
        assert float(disc.radius) == pytest.approx(1)


def test_a_real_centre_stays_real_and_another_moves_in_the_plane():
    with precision(200):
        level, bend = level_of(PAIR)
        disc = _single(level, bend, acb("-3.001", "4.002").mid(), lambda centre: arb(10) ** -20)
        assert abs(disc.centre - acb(-3, 4)) < disc.radius
        level, bend = level_of(real(2), PAIR)
        assert _single(level, bend, acb(arb("2.0001").mid()), lambda centre: arb(10) ** -20).is_real


@pytest.mark.parametrize(("step", "held"), [(0.7499, True), (0.7501, False), (0.9, False)])
def test_one_root_is_held_where_step_and_bend_stay_below_the_radius(step, held):
    # M = 2 of p'' = 2, at abs(p') = 4: 2 R^2 / 8 = R / 4 for R = 1.
    assert _holds_one(arb_poly([2]), acb(3, 4), acb(0, 4), acb(step), arb(1)) is held
    assert _holds_one(arb_poly([2]), acb(3, 4), acb(0, -4), acb(0, -step), arb(1)) is held


@pytest.mark.parametrize(("bound", "held"), [(1.99, True), (2.01, False)])
def test_the_bend_is_bounded_as_far_as_the_disc_reaches(bound, held):
    # M = bound * (5 + 1)/6; at abs(p') = 1 and R = 1 half of it.
    assert _holds_one(arb_poly([0, bound / 6]), acb(3, 4), acb(1), acb(0), arb(1)) is held


@pytest.mark.parametrize(("scale", "apart"), [(0.999, True), (1.001, False)])
def test_a_polynomial_differs_from_zero_where_its_slope_cannot_take_it_there(scale, apart):
    # (s - 1)(s - 4) is -2 at 2, and abs(2 s - 5) <= 2 (2 + r) + 5 within r: (9 + 2 r) r = 2 at the edge.
    edge = (97**0.5 - 9) / 4
    box = acb(arb(2, scale * edge), arb(0))
    assert differs_from_zero(with_roots(real(1), real(4)), box, 100) is apart


@pytest.mark.parametrize("where", [(1, 0), (-3, 4), (-3, -4)])
@pytest.mark.parametrize("size", [1e-3, 1e-12])
def test_a_box_about_a_root_never_differs_from_zero(where, size):
    value = with_roots(real(1), PAIR)
    for off in (0, 0.9, -0.9):
        box = acb(arb(where[0] + off * size, size), arb(where[1] - off * size, size))
        assert not differs_from_zero(value, box, 200)
    beside = acb(arb(where[0] + 30 * size, size), arb(where[1], size))
    assert differs_from_zero(value, beside, 200)
