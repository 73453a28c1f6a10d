"""Isolation of the simple roots of one real polynomial: all at growing precision, or one by one.

Input: a square-free polynomial and the digits wanted. Output: disjoint discs in the closed upper half plane
that, with their mirror images, hold all roots. A cluster that the constants' balls never tell apart comes out
as one disc with its count.

One by one, without the others, is what a search that was broken off can show. With a bound M on abs(p'') in
the disc of radius R about z, abs(p(w) - p'(z)(w - z)) <= abs(p(z)) + M R^2/2 in it. Where that is less than
abs(p'(z)) R, p has as many roots in the disc as its linear part, one (Rouche). The bound is the sum of the
moduli of all terms, far too large where they cancel, and good enough for the very small discs that Newton's
method ends in.
"""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING

from flint import acb, acb_poly, arb, arb_poly

from symflex.errors import Diagnostic, UncertifiedError
from symflex.roots.polynomials.discs import (
    Disc,
    LevelPolynomial,
    Proposer,
    complete,
    groups,
    guess_by_laguerre,
    middle_of,
    overlapping_pairs,
    with_mirrors,
)
from symflex.roots.precision import bits_for_digits, precision

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from symflex.budget import Budget
    from symflex.roots.problem import PolynomialInS

    Goal = Callable[[acb], arb]


GUARD_DIGITS = 2
"""Beyond those wanted."""
LARGEST_CLUSTER = 64
"""Roots of one disc that are parted by a polynomial of their own."""
EXTRA_BITS = 64
"""At first, beyond the digits and two bits a degree."""
GROWTH_WITH_CONSTANTS = 4
GROWTH_EXACT = 64
GROWTH_FLOOR = 2048


def isolations(
    polynomial: PolynomialInS,
    digits: int,
    *,
    in_square: bool,
    proposers: Sequence[Proposer],
    budget: Budget | None = None,
) -> Iterator[tuple[Disc, ...]]:
    """Enclose every root of a square-free polynomial, ever closer.

    The polynomial in s, or in z = s^2, is of positive degree and without the root 0. Yielded are discs of all
    roots, at last with so many correct digits in each nonzero component of the roots s, or at the bound on
    precision; a ``count`` above one marks roots that could not be told apart within that bound. The next one
    of the ``proposers`` is asked when a guess does not certify.

    SF404 when the bound on precision is reached without isolating discs, SF506 when the time is over.
    """
    bits = first_bits(polynomial, digits)
    growth = GROWTH_EXACT if polynomial.is_exact else GROWTH_WITH_CONSTANTS
    limit = growth * bits + GROWTH_FLOOR
    goal = goal_of(digits, in_square=in_square)
    known: tuple[acb, ...] | None = None
    while True:
        with precision(bits):
            level = LevelPolynomial.of(acb_poly(polynomial.enclosure()), budget)
            discs = _solve(level, goal, proposers, known, last=bits >= limit)
            enough = discs is not None and all(disc.radius <= goal(disc.centre) for disc in discs)
        if discs is not None:
            # Outside the block: what takes the discs has its own precision.
            yield discs
            if enough or bits >= limit:
                return
            known = tuple(disc.centre for disc in discs)
        if bits >= limit:
            message = f"roots of a polynomial of degree {polynomial.degree} do not separate at {limit} bits"
            hint = (
                "its roots lie too close together or differ in size by hundreds of decades"
                if polynomial.is_exact
                else "look for constants in its coefficients that satisfy a relation"
            )
            raise UncertifiedError(Diagnostic("SF404", message, hint=hint))
        bits = min(2 * bits, limit)


def first_bits(polynomial: PolynomialInS, digits: int) -> int:
    """Return the precision to begin with, for so many digits."""
    return bits_for_digits(digits) + 2 * polynomial.degree + EXTRA_BITS


def goal_of(digits: int, *, in_square: bool) -> Goal:
    """Return the largest radius about z that leaves each component of s the digits wanted.

    For s = sqrt(z) an error e of z moves s by e / (2 abs(s)), and abs(im z) = 2 abs(re s) abs(im s).
    """

    def goal(z: acb) -> arb:
        if z.imag == 0:
            size = z.abs_lower()
        elif in_square:
            size = abs(z.imag)
        else:
            size = abs(z.real).min(abs(z.imag))
        return size / arb(10) ** (digits + GUARD_DIGITS)

    return goal


def _solve(
    level: LevelPolynomial,
    goal: Goal,
    proposers: Sequence[Proposer],
    known: tuple[acb, ...] | None,
    *,
    last: bool,
) -> tuple[Disc, ...] | None:
    """Ask for guesses, those of the level before first, until one certifies."""
    for guesses in chain([known], (propose(level.value) for propose in proposers)):
        discs = None if guesses is None else _certify(level, goal, proposers, guesses, last=last)
        if discs is not None:
            return discs
    return None


def _certify(
    level: LevelPolynomial,
    goal: Goal,
    proposers: Sequence[Proposer],
    guesses: Sequence[acb],
    *,
    last: bool,
) -> tuple[Disc, ...] | None:
    """Return discs proved to hold all roots, with clusters taken apart (or, at last, surrounded)."""
    discs = [level.polish(guess, goal) for guess in guesses]
    if complete(discs, level.degree):
        return tuple(discs)
    resolved = _resolve(level, goal, proposers, groups(with_mirrors(discs)), last=last)
    return resolved if resolved is not None and complete(resolved, level.degree) else None


def _resolve(
    level: LevelPolynomial,
    goal: Goal,
    proposers: Sequence[Proposer],
    clusters: Sequence[Sequence[Disc]],
    *,
    last: bool,
) -> tuple[Disc, ...] | None:
    """Take clusters apart, those in the lower half plane left to their mirror images."""
    resolved: list[Disc] = []
    for cluster in clusters:
        middle = middle_of(cluster)
        if middle.imag < 0:
            continue
        if len(cluster) == 1:
            resolved.extend(cluster)
            continue
        apart = _take_apart(level, goal, proposers, cluster, middle, last=last)
        if apart is None and last:
            disc = level.surround(middle, len(cluster))
            apart = None if disc is None else (disc,)
        if apart is None:
            return None
        resolved.extend(apart)
    return tuple(resolved)


def _take_apart(
    level: LevelPolynomial,
    goal: Goal,
    proposers: Sequence[Proposer],
    cluster: Sequence[Disc],
    middle: acb,
    *,
    last: bool,
) -> tuple[Disc, ...] | None:
    """Separate one cluster, and the smaller clusters it may consist of."""
    if len(cluster) > LARGEST_CLUSTER:
        return None
    discs = level.separate(middle, len(cluster), goal, proposers)
    if discs is None:
        return None
    smaller = groups(with_mirrors(discs) if middle.imag == 0 else discs)
    if max(len(each) for each in smaller) >= len(cluster):
        return None
    return _resolve(level, goal, proposers, smaller, last=last)


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
    """Tell whether a polynomial is proved to have no root in a box."""
    with precision(bits):
        value = acb_poly(polynomial.enclosure())
        centre, radius = box.mid(), (box - box.mid()).abs_upper()
        steepest = arb_poly([abs(c).upper() for c in value.derivative()])
        change = steepest((centre.abs_upper() + radius).upper()) * radius
        return bool(value(centre).abs_lower() > change.upper())
