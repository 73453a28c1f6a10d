"""Sparse polynomials prepared for evaluation, so that products shared by successive terms are made once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from flint import acb, acb_series

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import fmpz_mpoly

Value = acb | acb_series
"""A number, or a power series in the displacement from one."""

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

    def value(self, powers: Sequence[Value]) -> Value:
        """Return the polynomial's value from those of the powers."""
        products: list[Value] = [acb(1)]
        total: Value = acb(0)
        for kept, following, coefficient in self.steps:
            del products[kept + 1 :]
            product = products[-1]
            for i in following:
                product = product * powers[i]
                products.append(product)
            total = total + product * coefficient
        return total


def plan(polynomial: fmpz_mpoly) -> Plan:
    """Return how to evaluate a polynomial."""
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
