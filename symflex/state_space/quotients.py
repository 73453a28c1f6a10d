"""Quotients of polynomials in lowest terms: the field in which state equations are solved.

Input: polynomials of a :class:`symflex.algebra.Ring` free of s. Output: :class:`FieldElement`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import fmpz_mpoly

    from symflex.algebra import Ring


@dataclass(frozen=True, slots=True, eq=False)
class FieldElement:
    """A quotient of integer polynomials in lowest terms.

    Parameters
    ----------
    num, den : fmpz_mpoly
        Coprime; the denominator's leading coefficient is positive.

    Examples
    --------
    >>> from symflex.algebra import Ring
    >>> ring = Ring(("s", "k", "m"))
    >>> k, m = (FieldElement.of(ring.generator(n), ring.constant(1)) for n in "km")
    >>> print(k / m + k / m)
    (2*k)/(m)
    >>> (k / m - k / m).is_zero
    True
    """

    num: fmpz_mpoly
    den: fmpz_mpoly

    @staticmethod
    def of(num: fmpz_mpoly, den: fmpz_mpoly) -> FieldElement:
        """Return a quotient in lowest terms.

        Raises
        ------
        ZeroDivisionError
            When the denominator is zero.
        """
        if den.is_zero():
            message = "division by zero"
            raise ZeroDivisionError(message)
        common = num.gcd(den)
        if not common.is_one():
            num, den = num / common, den / common
        if int(den.leading_coefficient()) < 0:
            num, den = -num, -den
        return FieldElement(num, den)

    @staticmethod
    def number(ring: Ring, value: int) -> FieldElement:
        """Return an integer."""
        return FieldElement(ring.constant(value), ring.constant(1))

    @property
    def is_zero(self) -> bool:
        """True for zero."""
        return bool(self.num.is_zero())

    @property
    def is_one(self) -> bool:
        """True for one."""
        return bool(self.num.is_one() and self.den.is_one())

    @property
    def size(self) -> int:
        """Number of terms."""
        return len(self.num) + len(self.den)

    def __add__(self, other: FieldElement) -> FieldElement:
        if self.is_zero:
            return other
        if other.is_zero:
            return self
        if self.den == other.den:
            return FieldElement.of(self.num + other.num, self.den)
        return FieldElement.of(self.num * other.den + other.num * self.den, self.den * other.den)

    def __neg__(self) -> FieldElement:
        return FieldElement(-self.num, self.den)

    def __sub__(self, other: FieldElement) -> FieldElement:
        return self + (-other)

    def __mul__(self, other: FieldElement) -> FieldElement:
        if self.is_one or other.is_zero:
            return other
        if other.is_one or self.is_zero:
            return self
        return FieldElement.of(self.num * other.num, self.den * other.den)

    def __truediv__(self, other: FieldElement) -> FieldElement:
        if other.is_one:
            return self
        return FieldElement.of(self.num * other.den, self.den * other.num)

    def __str__(self) -> str:
        return f"({self.num})/({self.den})"


Vector = dict[int, FieldElement]
"""Entries other than zero, by position."""


def combined(left: Vector, right: Vector, factor: FieldElement | None = None) -> Vector:
    """Return ``left + factor*right``, or ``left + right``, without entries that are zero."""
    result = dict(left)
    for position, value in right.items():
        addend = value if factor is None else value * factor
        total = result[position] + addend if position in result else addend
        if total.is_zero:
            result.pop(position, None)
        else:
            result[position] = total
    return result


def applied(vector: Vector, rows: Sequence[Vector]) -> Vector:
    """Return ``vector * matrix`` for a matrix given by its rows."""
    result: Vector = {}
    for position, value in vector.items():
        result = combined(result, rows[position], value)
    return result


def transposed(rows: Sequence[Vector], columns: int) -> list[Vector]:
    """Return the columns of a matrix given by its rows."""
    result: list[Vector] = [{} for _ in range(columns)]
    for i, row in enumerate(rows):
        for j, value in row.items():
            result[j][i] = value
    return result
