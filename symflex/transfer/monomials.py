"""Sparse polynomials prepared for evaluation, so that products shared by successive terms are made once."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import fmpz_mpoly

Step = tuple[int, tuple[int, ...], int]
"""How many factors of the last product stay, which powers follow, and the term's integer."""


@dataclass(frozen=True, slots=True)
class Plan:
    """How to evaluate one polynomial.

    Parameters
    ----------
    powers : tuple of (int, int)
        Positions of generators, and exponents, that occur.
    steps : tuple of Step
        One per term.
    """

    powers: tuple[tuple[int, int], ...]
    steps: tuple[Step, ...]

    def value(self, one: Any, powers: Sequence[Any]) -> Any:  # noqa: ANN401
        """Return the polynomial's value from those of the powers, of the same kind as ``one``."""
        products = [one]
        total = one * 0
        for kept, following, coefficient in self.steps:
            del products[kept + 1 :]
            product = products[-1]
            for i in following:
                product = product * powers[i]
                products.append(product)
            total = total + product * coefficient
        return total


@dataclass
class MonomialPlans:
    """The plans of the polynomials of one ring, each made once."""

    _known: dict[int, tuple[fmpz_mpoly, Plan]] = field(default_factory=dict)

    def of(self, polynomial: fmpz_mpoly) -> Plan:
        """Return the plan of a polynomial."""
        known = self._known.get(id(polynomial))
        if known is None:
            # The polynomial is kept as well: as long as it lives, its id is its own.
            known = self._known[id(polynomial)] = (polynomial, _plan(polynomial))
        return known[1]


def _plan(polynomial: fmpz_mpoly) -> Plan:
    numbers: dict[tuple[int, int], int] = {}
    steps: list[Step] = []
    last: tuple[int, ...] = ()
    for monomial, coefficient in polynomial.terms():
        factors = ((i, int(e)) for i, e in enumerate(monomial) if e)
        powers = tuple(numbers.setdefault(power, len(numbers)) for power in factors)
        kept = 0
        while kept < min(len(last), len(powers)) and last[kept] == powers[kept]:
            kept += 1
        steps.append((kept, powers[kept:], int(coefficient)))
        last = powers
    return Plan(tuple(numbers), tuple(steps))
