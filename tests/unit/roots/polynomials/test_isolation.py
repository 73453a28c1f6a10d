"""Isolation of simple roots whatever guesses propose, and what is said where they do not separate."""

from __future__ import annotations

import pytest
from flint import acb, acb_poly, arb

from symflex.balls import precision
from symflex.budget import Budget
from symflex.errors import BudgetError, UncertifiedError
from symflex.roots import PolynomialInS
from symflex.roots.polynomials.isolation import first_bits, goal_of, isolations
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
    with Budget(seconds=1, clock=clock).entered(), pytest.raises(BudgetError, match="SF506"):
        list(isolations(polynomial, 10, in_square=False, proposers=[propose]))
