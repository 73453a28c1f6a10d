"""Polynomials as recurrences: the structure of a chain or tree found again in its determinant.

Input: an exact polynomial and an expression for each of its generators.
Output: an expression on the forge, in which equal sub-determinants are computed once.

A polynomial is split as ``v**k * q + r`` with ``r`` free of v, and q and r are stripped of common factors. For masses
in series, ``p_k = m_k s^2 u_k + w_k p_(k+1)`` and ``u_k = p_(k+1) + w_k u_(k+1)`` come out: linear in the number of
masses where the expanded polynomial grows exponentially, and backward stable in the parameters, so that nothing is
lost between resonances, where the expanded polynomial cancels.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import gcd
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import fmpz_mpoly

    from symflex.emit.program.forge import Forge
    from symflex.emit.program.polynomials import Images
    from symflex.kernels import Ring

SPLIT_LIMIT = 2000
"""Number of terms beyond which looking for structure takes longer than it is worth."""

FACTOR_LIMIT = 400

Monomial = tuple[int, ...]
Terms = tuple[tuple[Monomial, int], ...]
"""Monomials in the ring's order with their coefficients."""


@dataclass
class Recurrence:
    """Makes expressions of polynomials of one ring, each distinct one once.

    Parameters
    ----------
    forge : Forge
        Where expressions are made.
    ring : Ring
        Of the polynomials.
    images : Images
        An expression for each generator.
    """

    forge: Forge
    ring: Ring
    images: Images
    _known: dict[Terms, tuple[int, int]] = field(default_factory=dict)
    _wanted: set[Terms] = field(default_factory=set)

    def evaluate(self, polynomial: fmpz_mpoly) -> tuple[int, int]:
        """Return the expression of a polynomial and its degree in s."""
        return self._general(tuple((tuple(int(e) for e in m), int(c)) for m, c in polynomial.terms()))

    def _general(self, terms: Terms) -> tuple[int, int]:
        integer, content, rest = _stripped(terms)
        value, degree = self._primitive(rest)
        outside, power = self._monomial(content)
        pi_power = content[self.images.pi]
        return self.forge.multiply([self.forge.constant(integer, pi_power), *outside, value]), degree + power

    def _monomial(self, exponents: Monomial) -> tuple[list[int], int]:
        factors, degree = [], 0
        for i, exponent in enumerate(exponents):
            if exponent and i != self.images.pi:
                degree += exponent * self.images.degrees[i]
                # In the far branch s over its own power is one.
                if not (self.images.is_far and i == 0):
                    factors.append(self.forge.power(self.images.values[i], exponent))
        return factors, degree

    def _primitive(self, terms: Terms) -> tuple[int, int]:
        """Return a polynomial without content."""
        if len(terms) == 1:
            return self.forge.constant(1), 0
        if terms not in self._known:
            self._known[terms] = self._product(terms) or self._split(terms)
        return self._known[terms]

    def _product(self, terms: Terms) -> tuple[int, int] | None:
        """Return the product of the irreducible factors, ``None`` when there is only one."""
        if len(terms) > FACTOR_LIMIT:
            return None
        constant, factors = self.ring.context.from_dict(dict(terms)).factor()
        if len(factors) == 1 and factors[0][1] == 1:
            return None
        values, total = [self.forge.constant(int(constant))], 0
        for factor, exponent in factors:
            value, degree = self.evaluate(factor)
            values.append(self.forge.power(value, int(exponent)))
            total += degree * int(exponent)
        return self.forge.multiply(values), total

    def _split(self, terms: Terms) -> tuple[int, int]:
        parts = min((_parts(terms, v) for v in _variables(terms)), key=self._cost)
        self._wanted.update(_stripped(part)[2] for part in parts)
        return self._sum([self._general(part) for part in parts])

    def _cost(self, parts: Sequence[Terms]) -> tuple[int, int]:
        """Return how many terms, and generators, a split leaves to do; the first of equals is taken."""
        new = [rest for rest in (_stripped(part)[2] for part in parts) if rest not in self._wanted]
        return sum(map(len, new)), sum(len(_variables(rest)) for rest in new)

    def _sum(self, parts: Sequence[tuple[int, int]]) -> tuple[int, int]:
        total = max(degree for _, degree in parts)
        if not self.images.is_far:
            return self.forge.add([value for value, _ in parts]), total
        inverse = self.images.values[0]
        raised = [self.forge.multiply([v, self.forge.power(inverse, total - d)]) for v, d in parts]
        return self.forge.add(raised), total


def _variables(terms: Terms) -> list[int]:
    return [i for i, exponents in enumerate(zip(*(m for m, _ in terms), strict=True)) if any(exponents)]


def _parts(terms: Terms, variable: int) -> tuple[Terms, ...]:
    """Return the terms with a variable and those without."""
    inside = tuple(t for t in terms if t[0][variable])
    outside = tuple(t for t in terms if not t[0][variable])
    if outside:
        return inside, outside
    message = "a polynomial without content has a term free of each generator"
    raise ValueError(message)


def _stripped(terms: Terms) -> tuple[int, Monomial, Terms]:
    """Return the integer and the monomial that all terms share, and the rest, its first coefficient positive."""
    content = tuple(map(min, zip(*(m for m, _ in terms), strict=True)))
    integer = gcd(*(c for _, c in terms))
    integer = -integer if terms[0][1] < 0 else integer
    rest = tuple((tuple(e - f for e, f in zip(m, content, strict=True)), c // integer) for m, c in terms)
    return integer, content, rest
