"""Sparse integer polynomials in any number of generators: what assembling a large model needs of a ring.

An ``fmpz_mpoly`` spends a byte per generator on every monomial, which is nothing for hundreds of names and
all there is for hundreds of thousands. Entries of a network's equations have a handful of terms, so here a
monomial names its generators only. There are no common divisors, no substitutions, and no large products.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import gcd

Monomial = tuple[tuple[int, int], ...]  # positions of generators, ascending, with their exponents


class SparsePolynomial:
    """An integer polynomial as a mapping of monomials to coefficients; immutable.

    The operations are those of ``fmpz_mpoly`` that equations are assembled with, under the same names.

    >>> ring = SparseContext(("s", "k", "b"))
    >>> s, k, b = (ring.gen(i) for i in range(3))
    >>> (b * s + k) ** 2 - k * k
    s^2*b^2 + 2*s*k*b
    """

    __slots__ = ("_hash", "context", "parts")

    def __init__(self, context: SparseContext, parts: Mapping[Monomial, int]) -> None:
        self.context = context
        self.parts = parts
        self._hash = 0

    def __len__(self) -> int:
        return len(self.parts)

    def __eq__(self, other: object) -> bool:
        return self is other or (isinstance(other, SparsePolynomial) and self.parts == other.parts)

    def __hash__(self) -> int:
        if not self._hash:
            self._hash = hash(frozenset(self.parts.items()))
        return self._hash

    def __add__(self, other: SparsePolynomial) -> SparsePolynomial:
        total = dict(self.parts)
        for monomial, coefficient in other.parts.items():
            value = total.get(monomial, 0) + coefficient
            if value:
                total[monomial] = value
            else:
                del total[monomial]
        return SparsePolynomial(self.context, total)

    def __neg__(self) -> SparsePolynomial:
        return SparsePolynomial(self.context, {m: -c for m, c in self.parts.items()})

    def __sub__(self, other: SparsePolynomial) -> SparsePolynomial:
        return self + -other

    def __mul__(self, other: SparsePolynomial | int) -> SparsePolynomial:
        if isinstance(other, int):
            return SparsePolynomial(self.context, {m: c * other for m, c in self.parts.items() if other})
        total: dict[Monomial, int] = {}
        for left, a in self.parts.items():
            for right, b in other.parts.items():
                monomial = _merged(left, right, 1)
                total[monomial] = total.get(monomial, 0) + a * b
        return SparsePolynomial(self.context, {m: c for m, c in total.items() if c})

    def __pow__(self, exponent: int) -> SparsePolynomial:
        if len(self.parts) == 1:
            ((monomial, coefficient),) = self.parts.items()
            raised = tuple((i, e * exponent) for i, e in monomial) if exponent else ()
            return SparsePolynomial(self.context, {raised: coefficient**exponent})
        result = self.context.constant(1)
        for _ in range(exponent):
            result = result * self
        return result

    def __truediv__(self, divisor: SparsePolynomial) -> SparsePolynomial:
        """Return the exact quotient by a divisor of one term."""
        if len(divisor.parts) != 1:
            raise ValueError("a sparse polynomial is divided by single terms only")
        ((below, number),) = divisor.parts.items()
        parts: dict[Monomial, int] = {}
        for monomial, coefficient in self.parts.items():
            quotient, remainder = divmod(coefficient, number)
            reduced = _merged(monomial, below, -1)
            if remainder or any(e < 0 for _, e in reduced):
                raise ValueError("the quotient is not a polynomial")
            parts[reduced] = quotient
        return SparsePolynomial(self.context, parts)

    def is_zero(self) -> bool:
        """Tell whether it is zero."""
        return not self.parts

    def is_one(self) -> bool:
        """Tell whether it is the number one."""
        return self.parts == {(): 1}

    def is_constant(self) -> bool:
        """Tell whether it contains no generator."""
        return not any(self.parts)

    def term_content(self) -> SparsePolynomial:
        """Return the largest term that divides all terms, with positive coefficient."""
        common: dict[int, int] | None = None
        number = 0
        for monomial, coefficient in self.parts.items():
            number = gcd(number, coefficient)
            if common is None:
                common = dict(monomial)
                continue
            if common:
                here = dict(monomial)
                common = {i: min(e, here[i]) for i, e in common.items() if i in here}
        return SparsePolynomial(self.context, {tuple((common or {}).items()): number} if number else {})

    def leading_coefficient(self) -> int:
        """Return the coefficient of the first term in lexicographic order."""
        return max(self.parts.items(), key=lambda term: _place(term[0]))[1] if self.parts else 0

    def terms(self) -> Iterator[tuple[Monomial, int]]:
        """Yield monomials, which name their generators only, with coefficients, in lexicographic order."""
        yield from self.ordered()

    def ordered(self) -> list[tuple[Monomial, int]]:
        """Return the terms as :meth:`terms` yields them."""
        if len(self.parts) == 1:
            return list(self.parts.items())
        return sorted(self.parts.items(), key=lambda term: _place(term[0]), reverse=True)

    def __str__(self) -> str:
        names = self.context.names
        text = ""
        for monomial, coefficient in self.terms():
            factors = [names[i] if e == 1 else f"{names[i]}^{e}" for i, e in monomial]
            if abs(coefficient) != 1 or not factors:
                factors.insert(0, str(abs(coefficient)))
            sign = ("-" if coefficient < 0 else "") if not text else " - " if coefficient < 0 else " + "
            text += sign + "*".join(factors)
        return text or "0"

    __repr__ = __str__


class SparseContext:
    """The generators of sparse polynomials."""

    __slots__ = ("_generators", "names")

    def __init__(self, names: Sequence[str]) -> None:
        self.names = names
        self._generators: dict[int, SparsePolynomial] = {}

    def gen(self, i: int) -> SparsePolynomial:
        """Return the generator at a position, always the same object."""
        known = self._generators.get(i)
        if known is None:
            known = self._generators[i] = SparsePolynomial(self, {((i, 1),): 1})
        return known

    def constant(self, value: int) -> SparsePolynomial:
        """Return an integer."""
        return SparsePolynomial(self, {(): int(value)} if value else {})


def _merged(left: Monomial, right: Monomial, sign: int) -> Monomial:
    if not right:
        return left
    total = dict(left)
    for i, e in right:
        total[i] = total.get(i, 0) + sign * e
    return tuple(sorted((i, e) for i, e in total.items() if e))


def _place(monomial: Monomial) -> tuple[tuple[int, int], ...]:
    """Return what sorts monomials as the lexicographic order does: earlier generators count most."""
    return tuple([(-i, e) for i, e in monomial])
