"""Polynomials with known roots, built with exact rational arithmetic."""

from __future__ import annotations

from fractions import Fraction

from flint import arb, fmpz_mpoly_ctx, fmpz_poly

from symflex.roots import PolynomialInS, RealConstant, RootProblem


def multiply(a, b):
    product = [Fraction(0)] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            product[i + j] += x * y
    return product


def from_roots(roots):
    coefficients = [Fraction(1)]
    for root in roots:
        coefficients = multiply(coefficients, [-Fraction(root), Fraction(1)])
    return coefficients


def problem(*coefficients):
    return RootProblem.from_rationals([Fraction(c) for c in coefficients])


def problem_of(polynomial: fmpz_poly, exponent: int = 1):
    return RootProblem(((PolynomialInS.from_integers([int(c) for c in polynomial.coeffs()]), exponent),))


def chain(masses, m, k, b):
    """Characteristic polynomial of equal masses, the first tied to ground, the last free."""
    joint, mass = fmpz_poly([k, b]), fmpz_poly([0, 0, m])
    before, now = fmpz_poly([1]), mass + joint
    for _ in range(masses - 1):
        before, now = now, (mass + 2 * joint) * now - joint * joint * before
    return now


def with_constant(name, evaluate, rows):
    """Coefficients as functions of one generator: ``rows`` is called with it and the constant one."""
    context = fmpz_mpoly_ctx.get([name], "lex")
    (generator,) = context.gens()
    coefficients = tuple(rows(generator, context.constant(1)))
    return PolynomialInS(coefficients, context, (RealConstant(name, evaluate),))


def with_pi(rows):
    return with_constant("pi", arb.pi, rows)


def with_root_of_two(rows):
    return with_constant("sqrt(2)", lambda: arb(2).sqrt(), rows)
