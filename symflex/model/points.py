"""Where points along x lie, as far as expressions of parameters say.

A point or length is read as a polynomial in the parameters (exponents may be negative). Of a difference that
is such a polynomial the sign is known when all its coefficients agree, since parameters are positive, or when
all parameters in it have values.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING

from symflex.expressions import Expression, Name, Negative, Number, Power, Product, Quotient, Sum
from symflex.model.analysis import PI_NEARLY
from symflex.model.linearity import integer_exponent
from symflex.model.units import lower

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterable, Mapping

    from symflex.model.model import Definition, ExactValue

Monomial = tuple[tuple[str, int], ...]
Polynomial = dict[Monomial, Fraction]

TERM_LIMIT = 64
DEGREE_LIMIT = 64
BIT_LIMIT = 4_000
"""Lengths people write stay far below; beyond, no sign is told rather than much computed."""


@dataclass(frozen=True)
class Line:
    """The parameters that places along x are made of.

    Examples
    --------
    >>> l, half = Name("l"), Quotient(Name("l"), Number(Fraction(2)))
    >>> line = Line({}, frozenset({"l"}), frozenset(), {})
    >>> line.sign(Sum((l, Negative(half)))), line.sign(Sum((half, Negative(l)))), line.sign(Name("x_s"))
    (1, -1, None)
    """

    definitions: Mapping[str, Expression]  # opened where they occur; each uses only earlier ones
    # positive and nonnegative: parameters by what is assumed of them.
    positive: frozenset[str]
    nonnegative: frozenset[str]
    values: Mapping[str, Fraction]  # of those that have one
    _opened: dict[str, Polynomial | None] = field(default_factory=dict, repr=False)

    @staticmethod
    def of_numbers(
        definitions: Iterable[Definition], values: Iterable[tuple[str, ExactValue | None]]
    ) -> Line:
        """Return the line of parameters of which nothing is known but the values of some."""
        numbers = {name: v.rational * PI_NEARLY**v.pi_power for name, v in values if v is not None}
        return Line({d.name: d.expression for d in definitions}, frozenset(), frozenset(), numbers)

    def __post_init__(self) -> None:
        """Open the definitions in order, so that a long chain is not followed at once."""
        for name, expression in self.definitions.items():
            self._opened[name] = self._read(expression)

    def sign(self, difference: Expression) -> int | None:
        """Return the sign of an expression, ``None`` where it cannot be told."""
        polynomial = self._read(difference)
        if polynomial is None:
            return None
        if not polynomial:
            return 0
        signs = {1 if c > 0 else -1 for c in polynomial.values()}
        used = {name for monomial in polynomial for name, _ in monomial}
        if len(signs) == 1 and used <= self.positive | self.nonnegative | {"pi"}:
            certain = self.positive | {"pi"}
            if any(all(name in certain for name, _ in monomial) for monomial in polynomial):
                return signs.pop()
        value = self._value(polynomial)
        return None if value is None else (value > 0) - (value < 0)

    def value(self, place: Expression) -> Fraction | None:
        """Return the number a place is with the parameters' values."""
        polynomial = self._read(place)
        return None if polynomial is None else self._value(polynomial)

    def key(self, place: Expression) -> Hashable:
        """Return what is equal of equal places: the number, else the polynomial, else the place as written.

        >>> half = Quotient(Name("l"), Number(Fraction(2)))
        >>> line = Line({}, frozenset({"l"}), frozenset(), {})
        >>> line.key(half) == line.key(Product((Number(Fraction(1, 2)), Name("l"))))
        True
        """
        polynomial = self._read(place)
        if polynomial is None:
            return place
        value = self._value(polynomial)
        return frozenset(polynomial.items()) if value is None else value

    def _value(self, polynomial: Polynomial) -> Fraction | None:
        total = Fraction(0)
        for monomial, coefficient in polynomial.items():
            product = coefficient
            for name, exponent in monomial:
                known = PI_NEARLY if name == "pi" else self.values.get(name)
                if known is None or (known == 0 and exponent < 0):
                    return None
                product *= known**exponent
            total += product
        return total

    def _read(self, expression: Expression) -> Polynomial | None:
        match lower(expression):  # a quantity is a number here
            case Number(value):
                return {(): value} if value else {}
            case Name(name):
                return self._name(name)
            case Negative(operand):
                inner = self._read(operand)
                return None if inner is None else {m: -c for m, c in inner.items()}
            case Sum(terms):
                parts = [self._read(t) for t in terms]
                return None if None in parts else _sum([p for p in parts if p is not None])
            case Product(factors):
                result: Polynomial | None = {(): Fraction(1)}
                for factor in factors:
                    other = self._read(factor)
                    result = None if result is None or other is None else _product(result, other)
                return result
            case Quotient(numerator, denominator):
                top, bottom = self._read(numerator), self._read(denominator)
                inverse = None if bottom is None else _power(bottom, -1)
                return None if top is None or inverse is None else _product(top, inverse)
            case Power(base, exponent):
                inner, n = self._read(base), integer_exponent(exponent)
                return None if inner is None or n is None else _power(inner, n)
            case _:
                return None

    def _name(self, name: str) -> Polynomial | None:
        return self._opened[name] if name in self._opened else {((name, 1),): Fraction(1)}


def _sum(parts: list[Polynomial]) -> Polynomial | None:
    total: Polynomial = {}
    for part in parts:
        for monomial, coefficient in part.items():
            total[monomial] = total.get(monomial, Fraction(0)) + coefficient
    kept = {m: c for m, c in total.items() if c}
    small = all(max(c.numerator.bit_length(), c.denominator.bit_length()) < BIT_LIMIT for c in kept.values())
    return kept if small and len(kept) <= TERM_LIMIT else None


def _product(left: Polynomial, right: Polynomial) -> Polynomial | None:
    if len(left) * len(right) > TERM_LIMIT:
        return None
    parts: list[Polynomial] = []
    for one, a in left.items():
        for other, b in right.items():
            exponents = dict(one)
            for name, e in other:
                exponents[name] = exponents.get(name, 0) + e
            if any(abs(e) > DEGREE_LIMIT for e in exponents.values()):
                return None
            monomial = tuple(sorted((n, e) for n, e in exponents.items() if e))
            parts.append({monomial: a * b})
    return _sum(parts)


def _power(base: Polynomial, exponent: int) -> Polynomial | None:
    """Return a power of a single term; sums are not multiplied out."""
    if exponent == 1:
        return base
    if len(base) != 1 or abs(exponent) > DEGREE_LIMIT:
        return None
    ((monomial, coefficient),) = base.items()
    if any(abs(e * exponent) > DEGREE_LIMIT for _, e in monomial):
        return None
    return _sum([{tuple((n, e * exponent) for n, e in monomial if exponent): coefficient**exponent}])
