"""Isolation of simple roots whatever guesses propose, and what is said where they do not separate."""

from __future__ import annotations

from flint import acb, acb_poly, arb

from symflex.balls import precision
from symflex.roots import PolynomialInS
from symflex.roots.polynomials.isolation import isolations

# (s - 1)(s + 2)((s + 3)^2 + 16), and the roots in the closed upper half-plane
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
        (), (1.01, 1.02, -3 + 4j), (1, -2), (1, -2, 5), (1, -2, -3 + 4j, 7), (0.5 + 1e-30j, 0.5, 0.5),
    ]:  # fmt: skip
        first, asked = proposing(*wrong)
        second, asked_too = proposing(1.1, -2.1, -3 + 4.1j)
        discs = isolated(first, second)[-1]
        assert holds_each_once(discs, ROOTS), wrong
        assert len(discs) == 3, wrong
        assert asked[0] == asked_too[0] == 4, wrong
