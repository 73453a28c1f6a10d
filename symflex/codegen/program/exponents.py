"""Polynomials in kernels as sums of exponentials, in exact arithmetic.

Input: a polynomial over the ring of kernels.
Output: a :class:`KernelSum`: per product of functions ``exp(sum(a_i q_i)) cos(sum(b_i q_i))``, one for
every wavenumber, a polynomial in s, the parameters and the wavenumbers.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING

from symflex.algebra.exponential_sum import spread

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from flint import fmpz_mpoly

    from symflex.algebra import Dispersion, Factored, Kernel, KernelTable, Ring

Term = tuple[tuple[tuple[int, int], ...], int]
"""Pairs ``(a_i, b_i)``, one per length, and 0 for the cosine or 1 for the sine; the first b that is not zero
is positive."""

Key = tuple[Term, ...]
"""One term per family."""

Single = tuple[int, int, int]
"""``(a, b, parity)`` of one length; b is not negative."""


@dataclass(frozen=True, slots=True, eq=False)
class Family:
    """A wavenumber with its base lengths, or a delay."""

    dispersion: Dispersion  # whose wavenumber it is
    wavenumber: str  # generator; empty for a delay or a shift
    lengths: tuple[Factored, ...]  # [m]; [s] for a delay
    # Per length, the functions ``cosh``, ``sinh``, ``cos``, ``sin``, ``exp``, with the positions of their
    # generators.
    kernels: tuple[tuple[tuple[str, int], ...], ...]

    @property
    def is_circular(self) -> bool:
        """True when cosine and sine occur besides the hyperbolic functions."""
        return self.dispersion.kind == "bending"


def families_of(ring: Ring, table: KernelTable) -> tuple[Family, ...]:
    """Return the families of a table; fundamental functions have none."""
    found: dict[tuple[str, int], dict[int, list[tuple[str, int]]]] = {}
    firsts: dict[tuple[str, int], Kernel] = {}
    lengths: dict[int, Factored] = {}
    for kernel in table.kernels:
        if kernel.function == "fundamental":
            continue
        key = (kernel.wavenumber, id(kernel.dispersion))
        firsts.setdefault(key, kernel)
        lengths[id(kernel.length)] = kernel.length
        own = found.setdefault(key, {}).setdefault(id(kernel.length), [])
        own.append((kernel.function, ring.index[kernel.generator]))
    return tuple(
        Family(
            firsts[key].dispersion,
            firsts[key].wavenumber,
            tuple(lengths[i] for i in own),
            tuple(tuple(functions) for functions in own.values()),
        )
        for key, own in found.items()
    )


@dataclass(frozen=True, eq=False)
class KernelSum:
    """``unit * sum(coefficient * product of terms)``."""

    unit: Fraction  # in front
    terms: Mapping[Key, fmpz_mpoly]  # coefficients are free of the kernels that have families

    def without_content(self) -> tuple[KernelSum, fmpz_mpoly]:
        """Return the sum with the common factor of all coefficients taken out, and that factor."""
        polynomials = list(self.terms.values())
        common = polynomials[0]
        for polynomial in polynomials[1:]:
            common = common.gcd(polynomial)
        if int(common.leading_coefficient()) < 0:
            common = -common
        return replace(self, terms={k: p / common for k, p in self.terms.items()}), common

    def in_lengths(self, changes: Sequence[Sequence[Sequence[int]]]) -> KernelSum:
        """Return the sum in other base lengths.

        Parameters
        ----------
        changes : sequence of matrices of int
            Per family and old length, its multiples of the new ones.
        """
        terms = {}
        for key, polynomial in self.terms.items():
            moved = []
            for (pairs, parity), matrix in zip(key, changes, strict=True):
                count = len(matrix[0])
                new = tuple(
                    (
                        sum(a * row[k] for (a, _), row in zip(pairs, matrix, strict=True)),
                        sum(b * row[k] for (_, b), row in zip(pairs, matrix, strict=True)),
                    )
                    for k in range(count)
                )
                term, sign = canonical(new, parity)
                polynomial = polynomial * sign  # noqa: PLW2901
                moved.append(term)
            terms[tuple(moved)] = polynomial
        return replace(self, terms=terms)


def canonical(pairs: tuple[tuple[int, int], ...], parity: int) -> tuple[Term, int]:
    """Return a term with a positive first angle, and the sign that this costs; 0 when it vanishes."""
    first = next((b for _, b in pairs if b), 0)
    if first == 0:
        return (pairs, 0), 0 if parity else 1
    if first > 0:
        return (pairs, parity), 1
    return (tuple((a, -b) for a, b in pairs), parity), -1 if parity else 1


def expand(ring: Ring, polynomial: fmpz_mpoly, families: Sequence[Family]) -> KernelSum:
    """Return a polynomial in kernels as a sum of exponentials."""
    positions = {i for family in families for own in family.kernels for _, i in own}
    collected: dict[Key, dict[tuple[int, ...], Fraction]] = {}
    for monomial, coefficient in polynomial.terms():
        exponents = [int(e) for e in monomial]
        rest = tuple(0 if i in positions else e for i, e in enumerate(exponents))
        products: dict[Key, Fraction] = {(): Fraction(int(coefficient))}
        for family in families:
            powers = tuple(
                tuple(
                    {f: exponents[i] for f, i in own}.get(f, 0) for f in ("cosh", "sinh", "cos", "sin", "exp")
                )
                for own in family.kernels
            )
            products = {(*key, t): x * y for key, x in products.items() for t, y in _joint(powers)}
        for key, x in products.items():
            terms = collected.setdefault(key, {})
            terms[rest] = terms.get(rest, Fraction(0)) + x
    # All denominators are powers of two.
    scale = max((x.denominator for terms in collected.values() for x in terms.values()), default=1)
    found = {}
    for key, terms in collected.items():
        whole = {m: int(x * scale) for m, x in terms.items() if x}
        if whole:
            found[key] = ring.context.from_dict(whole)
    return KernelSum(Fraction(1, scale), found)


@cache
def _joint(powers: tuple[tuple[int, int, int, int, int], ...]) -> tuple[tuple[Term, Fraction], ...]:
    """Return a product of powers of the kernels of one wavenumber, for all lengths together."""
    found: dict[Term, Fraction] = {((), 0): Fraction(1)}
    for own in powers:
        longer: dict[Term, Fraction] = defaultdict(Fraction)
        for (pairs, parity), x in found.items():
            for (a, b, other), y in _product(*own):
                # Products of cosines and sines as sums of those of the sum and the difference.
                for sign in (1, -1) if b and any(c for _, c in pairs) else (1,):
                    term, number = _combined(pairs, parity, (a, b, other), sign)
                    if number:
                        longer[term] += x * y * number
        found = longer
    return tuple((t, x) for t, x in found.items() if x)


def _combined(
    pairs: tuple[tuple[int, int], ...], parity: int, single: Single, sign: int
) -> tuple[Term, Fraction]:
    a, b, other = single
    is_single = b == 0 or not any(c for _, c in pairs)
    if is_single:
        term, number = canonical((*pairs, (a, b)), max(parity, other))
        return term, Fraction(number)
    term, number = canonical((*pairs, (a, sign * b)), parity ^ other)
    half = Fraction(number, 2)
    if parity and other:
        # sin A sin B = (cos(A - B) - cos(A + B))/2
        return term, -half * sign
    if other:
        # cos A sin B = (sin(A + B) - sin(A - B))/2
        return term, half * sign
    return term, half


@cache
def _product(cosh: int, sinh: int, cos: int, sin: int, exp: int) -> tuple[tuple[Single, Fraction], ...]:
    """Return a product of powers of the kernels of one length; ``exp`` is exp(-q)."""
    half = Fraction(1, 2)
    hyperbolic = {a - exp: x * half ** (cosh + sinh) for a, x in spread(cosh, sinh).items()}
    # exp(j b q) with Gaussian coefficients; 1/j^sin is taken out.
    circular = {b: y * half ** (cos + sin) for b, y in spread(cos, sin).items()}
    sign = -1 if sin % 4 in (2, 3) else 1
    waves: dict[tuple[int, int], Fraction] = {}
    for b, weight in circular.items():
        if b >= 0 and weight:
            # Odd powers of sin leave odd sums: 1/j times (e^jbq - e^-jbq) is 2 sin.
            waves[b, sin % 2] = weight * sign * (1 if b == 0 else 2)
    return tuple(
        ((a, b, parity), x * y) for a, x in hyperbolic.items() if x for (b, parity), y in waves.items() if y
    )


def derivative_at_zero(term: Term, position: int, order: int) -> tuple[tuple[Term, int], ...]:
    """Return the derivative of a term with respect to ``q_position`` at zero, as a combination of terms.

    Examples
    --------
    >>> [derivative_at_zero((((1, 1),), 0), 0, k) for k in range(3)]
    [(((((0, 0),), 0), 1),), (((((0, 0),), 0), 1),), ()]
    """
    pairs, parity = term
    a, b = pairs[position]
    real, imaginary = 1, 0
    for _ in range(order):
        real, imaginary = a * real - b * imaginary, a * imaginary + b * real
    rest = (*pairs[:position], (0, 0), *pairs[position + 1 :])
    # Re (z e^jR) = Re z cos R - Im z sin R, and Im (z e^jR) = Im z cos R + Re z sin R.
    parts = ((0, imaginary), (1, real)) if parity else ((0, real), (1, -imaginary))
    found = []
    for kind, number in parts:
        image, sign = canonical(rest, kind)
        if number * sign:
            found.append((image, number * sign))
    return tuple(found)
