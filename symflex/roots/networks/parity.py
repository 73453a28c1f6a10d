"""Whether determinants of equations are even or odd in s, so that their roots mirror each other in the axis.

Input: equations between an input and an output.
Output: of denominator and numerator, whether the one and the other is even or odd: proved, or not known.

Example: a mass on a spring, driven through its velocity, ``[m s^2 + k]`` and ``[s]``: even, and odd.

A determinant is a sum of products with one entry from each row and each column. Let every row i and every
column j have a parity, 0 or 1, so that each entry is even where both are the same and odd where they differ.
Then all products have the same parity. The determinant is that of the blocks the equations fall into; no
product has an entry outside of them. Fundamental functions of members are even in s where the coefficients
of their law, their lengths and shifts are.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from itertools import product
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE, Factored, terms_of
from symflex.roots.networks.blocks import blocks_of

if TYPE_CHECKING:
    from symflex.roots.networks.cramer import CramerEquations


def mirrored(cramer: CramerEquations) -> tuple[bool, bool]:
    """Tell of denominator and of numerator whether it is proved to be even or odd in s."""
    numeric = cramer.numeric
    moving = numeric.moving(LAPLACE)

    @cache
    def of_name(name: str) -> int | None:
        """Return 0 for a generator that is even in s, 1 for an odd one; None if it is neither."""
        if name in numeric.definitions:
            return of_value(numeric.definitions[name])
        if name in numeric.waves_of:
            waves = numeric.waves_of[name]
            parts = (*waves.law.characteristic, waves.law.shift, waves.length)
            return 0 if all(part.is_zero or of_value(part) == 0 for part in parts) else None
        if name in numeric.functions and name in moving:
            return None
        return int(name == LAPLACE)

    def of_value(value: Factored) -> int | None:
        total, names = 0, value.ring.names
        for factor, exponent in value.factors:
            parities: set[int] = set()
            for monomial, _ in terms_of(factor):
                found = [(of_name(names[i]), power) for i, power in monomial]
                if any(parity is None for parity, _ in found):
                    return None
                parities.add(sum((parity or 0) * power for parity, power in found) % 2)
            if len(parities) > 1:
                return None
            total += exponent * sum(parities)
        return total % 2

    entries = [{j: of_value(x) for j, x in row.items() if not x.is_zero} for row in cramer.entries]
    size = len(entries) - 1
    inner = [{j: x for j, x in row.items() if j < size} for row in entries[:size]]
    return _has_parity(inner) and of_value(cramer.divisor) is not None, _has_parity(entries)


def _has_parity(entries: Sequence[Mapping[int, int | None]]) -> bool:
    """Tell whether rows and columns have parities that make up those of all entries.

    >>> _has_parity([{0: 0, 1: 1}, {0: 1, 1: 0}]), _has_parity([{0: 0, 1: 1}, {0: 0, 1: 0}])
    (True, False)
    >>> _has_parity([{0: None, 1: 1}, {0: 1}])
    True
    """
    beside: dict[int, dict[int, int | None]] = {}  # rows, and columns j as -1 - j
    for rows, columns in blocks_of(entries) or ():
        for i, j in product(rows, columns):
            if j in entries[i]:
                beside.setdefault(i, {})[-1 - j] = entries[i][j]
                beside.setdefault(-1 - j, {})[i] = entries[i][j]
    known: dict[int, int] = {}
    for start in beside:
        pending = [] if start in known else [start]
        known.setdefault(start, 0)
        while pending:
            here = pending.pop()
            for there, parity in beside[here].items():
                if parity is None:
                    return False
                if there not in known:
                    known[there] = known[here] ^ parity
                    pending.append(there)
                elif known[there] != known[here] ^ parity:
                    return False
    return True
