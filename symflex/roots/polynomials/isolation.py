"""Isolation of the simple roots of one real polynomial, all at growing precision.

Input: a square-free polynomial and the digits wanted. Output: disjoint discs in the closed upper half-plane
that, with their mirror images, contain all roots. A cluster that the balls of constants never separate
becomes one disc with its count.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import chain

from flint import acb, acb_poly, arb

from symflex.balls import bits_for_digits, precision
from symflex.errors import Diagnostic, UncertifiedError
from symflex.roots.polynomials.discs import (
    Disc,
    LevelPolynomial,
    Proposer,
    complete,
    groups,
    middle_of,
    with_mirrors,
)
from symflex.roots.problem import PolynomialInS

Goal = Callable[[acb], arb]


GUARD_DIGITS = 2  # digits beyond those wanted
EXTRA_BITS = 64  # bits at first, beyond the digits and two bits a degree
GROWTH_WITH_CONSTANTS = 4
GROWTH_EXACT = 64
GROWTH_FLOOR = 2048


def isolations(
    polynomial: PolynomialInS, digits: int, *, in_square: bool, proposers: Sequence[Proposer]
) -> Iterator[tuple[Disc, ...]]:
    """Enclose every root of a square-free polynomial in s or s^2 without the root 0, ever closer.

    Discs with a ``count`` above one are not separated within the bound on precision; SF404, SF506 if none.
    """
    bits = first_bits(polynomial, digits)
    growth = GROWTH_EXACT if polynomial.is_exact else GROWTH_WITH_CONSTANTS
    limit = growth * bits + GROWTH_FLOOR
    goal = goal_of(digits, in_square=in_square)
    known: tuple[acb, ...] | None = None
    while True:
        with precision(bits):
            level = LevelPolynomial.of(acb_poly(polynomial.enclosure()))
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
        component = abs(z.imag) if in_square else abs(z.real).min(abs(z.imag))
        size = z.abs_lower() if z.imag == 0 else component
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
        discs = None if guesses is None else _certify(level, goal, guesses, last=last)
        if discs is not None:
            return discs
    return None


def _certify(
    level: LevelPolynomial, goal: Goal, guesses: Sequence[acb], *, last: bool
) -> tuple[Disc, ...] | None:
    """Return discs proved to hold all roots, at last with those that touch each other as one."""
    discs = [level.polish(guess, goal) for guess in guesses]
    if last and not complete(discs, level.degree):
        middles = [(middle_of(group), group) for group in groups(with_mirrors(discs))]
        enclosures = [
            group[0] if len(group) == 1 else level.surround(middle, len(group))
            for middle, group in middles
            if not middle.imag < 0  # others are mirror images
        ]
        discs = [disc for disc in enclosures if disc is not None]
    return tuple(discs) if complete(discs, level.degree) else None
