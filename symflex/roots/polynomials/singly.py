"""Roots of a polynomial proved one by one, without the others: what a search that was broken off can show.

Input: a square-free polynomial. Output: discs that hold exactly one root each.

With a bound M on abs(p'') in the disc of radius R about z, abs(p(w) - p'(z)(w - z)) <= abs(p(z)) + M R^2/2
in it. Where that is less than abs(p'(z)) R, p has as many roots in the disc as its linear part, one (Rouche).
The bound is the sum of the moduli of all terms, far too large where they cancel, and good enough for the very
small discs that Newton's method ends in.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flint import acb, acb_poly, arb, arb_poly

from symflex.roots.polynomials.discs import Disc, LevelPolynomial, overlapping_pairs, with_mirrors
from symflex.roots.polynomials.guesses import guess_by_laguerre
from symflex.roots.polynomials.isolation import first_bits, goal_of
from symflex.roots.precision import precision

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from symflex.budget import Budget
    from symflex.roots.problem import PolynomialInS

STEPS = 4
"""Newton steps beyond the digits wanted: each doubles the digits."""
BOUND_BITS = 64
"""Of bounds, which need few digits."""


def prove_singly(
    polynomial: PolynomialInS, digits: int, budget: Budget, *, in_square: bool
) -> Iterator[Disc]:
    """Yield discs with exactly one root each, disjoint, the roots nearest to 0 first as a rule.

    The polynomial in s, or in z = s^2, is square-free and without the root 0; digits are those of
    :func:`symflex.roots.polynomials.isolation.isolations`. The budget is heeded between roots and between
    steps: SF506.

    Examples
    --------
    >>> from symflex.budget import Budget
    >>> from symflex.roots.problem import PolynomialInS
    >>> discs = prove_singly(PolynomialInS.from_integers([2, -3, 1]), 10, Budget(), in_square=False)
    >>> [round(float(disc.centre.real.mid()), 12) for disc in discs]
    [1.0, 2.0]
    """
    bits = first_bits(polynomial, digits)
    goal = goal_of(digits, in_square=in_square)
    found: list[Disc] = []
    with precision(bits):
        level = LevelPolynomial.of(acb_poly(polynomial.enclosure()), budget)
        bend = arb_poly([abs(c).upper() for c in level.slope.derivative()])
        guesses = guess_by_laguerre(level.value, budget)
    while True:
        # Between two roots the precision is the caller's.
        with precision(bits):
            guess = next(guesses, None)
            if guess is None:
                return
            disc = _single(level, bend, level.polish(guess, goal).centre, goal)
            if disc is None or overlapping_pairs(with_mirrors([*found, disc])):
                continue
            found.append(disc)
        yield disc


def _single(level: LevelPolynomial, bend: arb_poly, centre: acb, goal: Callable[[acb], arb]) -> Disc | None:
    """Return a disc about a point next to a root that holds this root alone."""
    for _ in range(STEPS):
        level.budget.spend()
        slope = level.slope(centre)
        step = level.value(centre) / slope
        if not step.is_finite():
            return None
        radius = (goal(centre) / 2).mid() if step == 0 else (2 * step).abs_upper()
        if radius <= goal(centre) and _holds_one(bend, centre, slope, step, radius):
            return Disc(centre, radius)
        moved = (centre - step).mid()
        centre = acb(moved.real) if centre.imag == 0 else moved
    return None


def _holds_one(bend: arb_poly, centre: acb, slope: acb, step: acb, radius: arb) -> bool:
    """Tell whether step + M R^2/(2 slope) < R."""
    with precision(BOUND_BITS):
        most = bend((centre.abs_upper() + radius).upper())
        rest = step.abs_upper() + most * radius * radius / (2 * slope.abs_lower())
        return bool(rest < radius)


def differs_from_zero(polynomial: PolynomialInS, box: acb, bits: int) -> bool:
    """Tell whether a polynomial is proved to have no root in a box.

    Examples
    --------
    >>> from symflex.roots.problem import PolynomialInS
    >>> polynomial = PolynomialInS.from_integers([2, -3, 1])
    >>> [differs_from_zero(polynomial, acb(arb(x, 0.01)), 64) for x in (1.5, 1.005)]
    [True, False]
    """
    with precision(bits):
        value = acb_poly(polynomial.enclosure())
        centre, radius = box.mid(), (box - box.mid()).abs_upper()
        steepest = arb_poly([abs(c).upper() for c in value.derivative()])
        change = steepest((centre.abs_upper() + radius).upper()) * radius
        return bool(value(centre).abs_lower() > change.upper())
