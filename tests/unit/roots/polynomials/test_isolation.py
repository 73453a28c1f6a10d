"""Isolation of simple roots whatever guesses propose, and what is said where they do not separate."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import acb, acb_poly, arb, arb_poly, fmpz_poly

from symflex.budget import Budget
from symflex.errors import BudgetError, UncertifiedError
from symflex.roots import PolynomialInS, precision
from symflex.roots.polynomials import isolation
from symflex.roots.polynomials.discs import LevelPolynomial
from symflex.roots.polynomials.isolation import (
    _holds_one,
    _single,
    differs_from_zero,
    first_bits,
    goal_of,
    isolations,
    prove_singly,
)
from tests.unit.roots.root_problems import with_pi

# (s - 1)(s + 2)((s + 3)^2 + 16), and the roots in the closed upper half plane
COEFFICIENTS, ROOTS = [-50, 13, 29, 7, 1], (1, -2, -3 + 4j)


def proposing(*guesses):
    """Return an engine that proposes these, and how often it was asked."""
    asked = []

    def propose(polynomial: acb_poly):
        asked.append(polynomial.degree())
        return tuple(acb(each) for each in guesses) if guesses else None

    return propose, asked


def isolated(*proposers, coefficients=COEFFICIENTS, digits=20, in_square=False):
    polynomial = PolynomialInS.from_integers(coefficients)
    return list(isolations(polynomial, digits, in_square=in_square, proposers=proposers))


def holds_each_once(discs, roots):
    with precision(400):
        return [sum(bool(abs(disc.centre - root) <= disc.radius) for disc in discs) for root in roots] == [
            1
        ] * len(roots)


def test_each_disc_holds_one_root_to_the_digits_wanted():
    for digits in [5, 20, 200]:
        propose, _ = proposing(1.01, -1.99, -3 + 3.9j)
        (discs,) = isolated(propose, digits=digits)
        assert len(discs) == 3, digits
        assert holds_each_once(discs, ROOTS), digits
        assert all(disc.radius < arb(10) ** -digits and disc.count == 1 for disc in discs), digits
        assert [disc.is_real for disc in discs] == [True, True, False], digits


def test_guesses_that_do_not_lead_to_all_roots_are_passed_on_to_the_next_engine():
    for wrong in [
        (),
        (1.01, 1.02, -3 + 4j),
        (1, -2),
        (1, -2, 5),
        (1, -2, -3 + 4j, 7),
        (0.5 + 1e-30j, 0.5, 0.5),
    ]:
        first, asked = proposing(*wrong)
        second, asked_too = proposing(1.1, -2.1, -3 + 4.1j)
        discs = isolated(first, second)[-1]
        assert holds_each_once(discs, ROOTS), wrong
        assert len(discs) == 3, wrong
        assert asked[0] == asked_too[0] == 4, wrong


def test_engines_are_asked_once_and_what_they_led_to_is_refined():
    propose, asked = proposing(1.01, -1.99, -3 + 3.9j)
    every = isolated(propose, digits=60)
    assert len(asked) == 1
    assert all(holds_each_once(discs, ROOTS) for discs in every)


def test_two_roots_closer_than_the_first_precision_are_taken_apart():
    # (s - 1)(s - 1 - 1e-40), times 1e40
    propose, _ = proposing(1, 1.0000001)
    close = [10**40 + 1, -(2 * 10**40 + 1), 10**40]
    discs = isolated(propose, coefficients=close, digits=5)[-1]
    assert [disc.count for disc in discs] == [1, 1]
    with precision(500):
        tiny = arb(10) ** -40
        assert holds_each_once(discs, (acb(1), acb(1 + tiny)))
        one, other = discs
        assert abs(one.centre - other.centre) > one.radius + other.radius


def test_where_roots_do_not_separate_it_is_said_at_which_precision_and_why():
    for polynomial, bits, hint in [
        (
            PolynomialInS.from_integers(COEFFICIENTS),
            64 * first_bits(PolynomialInS.from_integers(COEFFICIENTS), 10) + 2048,
            "its roots lie too close together or differ in size by hundreds of decades",
        ),
        (
            with_pi(lambda pi, one: (pi, one, one, one, one)),
            4 * first_bits(PolynomialInS.from_integers(COEFFICIENTS), 10) + 2048,
            "look for constants in its coefficients that satisfy a relation",
        ),
    ]:
        with pytest.raises(UncertifiedError) as failed:
            list(isolations(polynomial, 10, in_square=False, proposers=[]))
        (diagnostic,) = failed.value.diagnostics
        assert diagnostic.code == "SF404", (polynomial, bits)
        assert diagnostic.message == f"roots of a polynomial of degree 4 do not separate at {bits} bits"
        assert diagnostic.hint == hint, (polynomial, bits)


def test_a_hidden_double_root_comes_out_as_one_disc_of_two():
    # (s - pi)^2 with pi^2 twice: as of two constants that are one.
    polynomial = with_pi(lambda pi, one: (pi**2, -2 * pi, one))
    propose, _ = proposing(3.14, 3.15)
    discs = list(isolations(polynomial, 8, in_square=False, proposers=[propose]))[-1]
    assert [disc.count for disc in discs] == [2]
    with precision(4000):
        assert abs(discs[0].centre - arb.pi()) <= discs[0].radius < 1e-8


def test_the_first_precision_grows_with_digits_and_degree():
    # 10 digits take 33.2 bits and 16 to spare.
    assert first_bits(PolynomialInS.from_integers(COEFFICIENTS), 10) == 34 + 16 + 2 * 4 + 64


def test_an_error_is_small_against_the_smaller_part_of_a_root():
    for z, in_square, size in [
        (acb(-5), False, 5),
        (acb(-5), True, 5),
        (acb(3, 4), False, 3),
        (acb(-4, 3), False, 3),
        (acb(3, 4), True, 4),
        (acb(30, 4), True, 4),
    ]:
        # abs(im z) = 2 abs(re s) abs(im s), so that of a square its imaginary part counts.
        assert float(goal_of(3, in_square=in_square)(z)) == pytest.approx(size * 1e-5)


def test_a_spent_budget_ends_the_isolation():
    polynomial = PolynomialInS.from_integers(COEFFICIENTS)
    clock = iter(range(1000)).__next__
    propose, _ = proposing(1.01, -1.99, -3 + 3.9j)
    with pytest.raises(BudgetError, match="SF506"):
        list(
            isolations(
                polynomial, 10, in_square=False, proposers=[propose], budget=Budget(seconds=1, clock=clock)
            )
        )


# ----------------------------------------------------------------------------- roots proved one by one


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


def test_every_disc_holds_one_root_and_every_root_has_one():
    for digits in [10, 80]:
        for name, (factors, roots) in CASES.items():
            discs = list(prove_singly(with_roots(*factors), digits, Budget(), in_square=False))
            assert len(discs) == len(roots), (digits, name)
            with precision(600):
                for root in roots:
                    exact = acb(root) if name != "close" or root != 1.000001 else acb(arb(1000001) / 1000000)
                    exact = acb(arb(1) / 10**9) if root == 1e-9 else exact
                    near = [d for d in discs if abs(d.centre - exact) < d.radius]
                    assert len(near) == 1, (digits, name)
                    assert near[0].is_real is (complex(root).imag == 0), (digits, name)
                    assert near[0].radius < abs(exact) * arb(10) ** -digits, name


def test_in_the_square_discs_are_small_enough_for_the_roots_digits():
    # z = -4: s = 2j; the same relative accuracy and some more.
    (disc,) = prove_singly(with_roots(real(-4)), 30, Budget(), in_square=True)
    with precision(600):
        assert abs(disc.centre + 4) < disc.radius
        assert disc.radius < arb(10) ** -30


def test_no_disc_is_returned_of_roots_not_told_apart_or_of_a_guess_that_leads_nowhere(monkeypatch):
    monkeypatch.setattr(
        isolation, "guess_by_laguerre", lambda value, budget: iter([acb(1.01), acb(0.99), acb(5.1)])
    )
    discs = list(prove_singly(with_roots(real(1), real(5)), 10, Budget(), in_square=False))
    assert [round(float(d.centre.real.mid()), 6) for d in discs] == [1, 5]
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


def test_a_root_met_exactly_gets_half_the_size_wanted_and_others_twice_newtons_step():
    with precision(100):
        level, bend = level_of(real(2), real(-7))
        disc = _single(level, bend, acb(2), lambda centre: arb(0.25))
        assert (disc.centre, float(disc.radius)) == (acb(2), 0.125)
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


def test_one_root_is_held_where_step_and_bend_stay_below_the_radius_as_far_as_the_disc_reaches():
    for step, held in [(0.7499, True), (0.7501, False), (0.9, False)]:
        # M = 2 of p'' = 2, at abs(p') = 4: 2 R^2 / 8 = R / 4 for R = 1.
        assert _holds_one(arb_poly([2]), acb(3, 4), acb(0, 4), acb(step), arb(1)) is held
        assert _holds_one(arb_poly([2]), acb(3, 4), acb(0, -4), acb(0, -step), arb(1)) is held
    for bound, held in [(1.99, True), (2.01, False)]:
        # M = bound * (5 + 1)/6; at abs(p') = 1 and R = 1 half of it.
        assert _holds_one(arb_poly([0, bound / 6]), acb(3, 4), acb(1), acb(0), arb(1)) is held


def test_a_polynomial_differs_from_zero_where_its_slope_cannot_take_it_there():
    for scale, apart in [(0.999, True), (1.001, False)]:
        # (s - 1)(s - 4) is -2 at 2, and abs(2 s - 5) <= 2 (2 + r) + 5 within r: (9 + 2 r) r = 2 at the edge.
        edge = (97**0.5 - 9) / 4
        box = acb(arb(2, scale * edge), arb(0))
        assert differs_from_zero(with_roots(real(1), real(4)), box, 100) is apart, scale


def test_a_box_about_a_root_never_differs_from_zero():
    for where in [(1, 0), (-3, 4), (-3, -4)]:
        for size in [1e-3, 1e-12]:
            value = with_roots(real(1), PAIR)
            for off in (0, 0.9, -0.9):
                box = acb(arb(where[0] + off * size, size), arb(where[1] - off * size, size))
                assert not differs_from_zero(value, box, 200), (where, size)
            beside = acb(arb(where[0] + 30 * size, size), arb(where[1], size))
            assert differs_from_zero(value, beside, 200), (where, size)
