"""Networks of line elements solved in balls at a point, with pivots, so that few bits are lost.

Input: a :class:`LineNetwork` and balls for its parameters.
Output: balls around a transfer function and its slope. Line elements are relations of the states at their
ends, made of short pieces as in :mod:`symflex.algebra.line_networks`, however long they are. Values come with
their derivatives by s: (v, v').
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import ceil, inf, log2, prod
from operator import truediv
from typing import TYPE_CHECKING

from flint import acb, acb_mat, acb_series, arb, ctx, fmpq

from symflex.algebra import LAPLACE

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from symflex.equations.line_network import Element, LineNetwork

Dual = tuple[acb, acb]
"""A value, and its derivative by s."""

Table = list[list[acb]]

LONGEST = 8.0
"""Norm of A l up to which a line element is not halved: exp(8) costs twelve bits."""

TINY = 1e-300
"""What is smaller counts as this where only sizes matter."""

FLOOR = -40.0
"""Logarithm to base 2 of a coefficient that states without any are scaled by."""


@dataclass(frozen=True, eq=False)
class EnclosedNetwork:
    """A transfer function of a network with numbers, evaluated in balls at one precision."""

    responses: NetworkResponses  # of all outputs to all inputs
    # output, source: their numbers in the network's table.
    output: int
    source: int

    def value_and_slope(self, s: acb) -> tuple[acb, acb]:
        """Return balls around the value and around ``G'(s)/G(s)``; not finite near a pole."""
        with ctx.workprec(self.responses.bits):
            value, slope = self.responses.at(s)[self.output].get(self.source, (acb(0), acb(0)))
            return value, slope / value


@dataclass(frozen=True, eq=False)
class NetworkResponses:
    """A network with numbers, solved in balls at one precision, once at each point."""

    bits: int  # the precision everything is computed at
    network: LineNetwork
    constants: Mapping[str, acb]  # its names but for s
    _known: dict[complex, list[dict[int, Dual]]] = field(default_factory=dict)

    def at(self, s: acb) -> list[dict[int, Dual]]:
        """Return, per output, what it is per unit of each input, by their numbers; what is zero lacks."""
        point = complex(s)
        if acb(point.real, point.imag) != s:
            return self._solved(s)
        if point not in self._known:
            self._known[point] = self._solved(s)
        return self._known[point]

    def _solved(self, s: acb) -> list[dict[int, Dual]]:
        size = self.network.table[0]
        rows: list[dict[int, Dual]] = [{} for _ in range(size + len(self.network.equations.outputs))]
        for row, column, (value, slope) in self._coefficients(s):
            known, own = rows[row].get(column, (acb(0), acb(0)))
            rows[row][column] = known + value, own + slope
        rows, outputs = rows[:size], rows[size:]
        active: list[dict[int, Dual]] = []
        left = sorted(rows, key=lambda row: -min(row))
        for k in range(size):
            while left and min(left[-1]) <= k:
                active.append(left.pop())
            pivot = max((r for r in active if k in r), key=lambda r: _share(r, k))
            active = [r for r in active if r is not pivot]
            value, slope = pivot.pop(k)
            for other in (r for r in (*active, *outputs) if k in r):
                above, own = other.pop(k)
                factor = above / value
                tilt = (own - factor * slope) / value
                for at, (x, dx) in pivot.items():
                    known, was = other.get(at, (acb(0), acb(0)))
                    other[at] = known - factor * x, was - tilt * x - factor * dx
        return [{column - size: x for column, x in row.items()} for row in outputs]

    def _coefficients(self, s: acb) -> Iterator[tuple[int, int, Dual]]:
        """Yield what stands in the matrix: row, column and value."""
        entries = self._entries(s)
        _, _, _, lumped, groups = self.network.table
        for row, column, entry in lumped:
            yield row, column, entries[entry]
        for positions, signs, elements in groups:
            for element in elements:
                yield from _relation(positions, signs, element, entries)

    def _entries(self, s: acb) -> list[Dual]:
        line = acb_series([s, acb(1)], 2)
        found = self.network.values(
            name=lambda name: line if name == LAPLACE else acb_series([self.constants[name]], 2),
            number=lambda x: acb_series([acb(arb(fmpq(x.numerator, x.denominator)))], 2),
            total=lambda terms: sum(terms[1:], terms[0]),
            product=prod,
            quotient=truediv,
            power=lambda base, exponent: prod([base] * exponent),
            exponential=lambda x: x.exp(),
        )
        return [(acb(x[0]), acb(x[1])) for x in map(acb_series, found)]


def _share(row: Mapping[int, Dual], k: int) -> arb:
    """Return how large a coefficient of a row is beside its largest."""
    return row[k][0].abs_lower() / max(x.abs_upper() for x, _ in row.values())


def _relation(
    positions: tuple[tuple[int, int], ...], signs: tuple[int, ...], element: Element, entries: list[Dual]
) -> Iterator[tuple[int, int, Dual]]:
    """Yield the coefficients of a line element's relation ``P z(0) + Q z(l) = 0``."""
    first, coefficients, length, start, end = element
    n, (reach, stretch) = len(signs), entries[length]
    matrix = {
        place: (entries[e][0] * reach, entries[e][1] * reach + entries[e][0] * stretch)
        for place, e in zip(positions, coefficients, strict=True)
    }
    scales = _scales(matrix, n)
    matrix = {(i, j): _scaled(x, scales[j] - scales[i]) for (i, j), x in matrix.items()}
    norm = max(sum(float(abs(x).upper()) for (i, _), (x, _) in matrix.items() if i == k) for k in range(n))
    halvings = max(0, ceil(log2(norm / LONGEST))) if norm else 0
    # The derivative of exp(A l) by s stands beside it in the exponential of a block matrix.
    both = acb_mat(2 * n, 2 * n)
    for (i, j), x in matrix.items():
        value, slope = _scaled(x, -halvings)
        both[i, j] = both[n + i, n + j] = value
        both[i, n + j] = slope
    grown = both.exp().table()
    minus = [[acb(-(i == j)) for j in range(n)] for i in range(n)]
    values = [[*row[:n], *m] for row, m in zip(grown, minus, strict=False)]
    slopes = [[*row[n:], *[acb(0)] * n] for row in grown[:n]]
    for _ in range(halvings):
        values, slopes = _doubled(values, slopes)
    for i in range(n):
        for j in range(n):
            for column, k, sign in ((start[j], j, 1), (end[j], n + j, signs[j])):
                if column >= 0:
                    yield first + i, column, _scaled((sign * values[i][k], sign * slopes[i][k]), -scales[j])


def _scaled(x: Dual, power: int) -> Dual:
    """Return a value times a power of two."""
    factor = arb(2) ** power
    return x[0] * factor, x[1] * factor


def _size(x: acb) -> float:
    """Return the logarithm to base 2 of about the size of a value."""
    upper = float(x.abs_upper())
    return log2(max(upper, TINY)) if upper < inf else float(x.abs_upper().log() / arb(2).log())


def _scales(matrix: Mapping[tuple[int, int], Dual], n: int) -> list[int]:
    """Return powers of two by which states are scaled so that rows and columns are alike."""
    sizes = {place: _size(x) for place, (x, _) in matrix.items()}
    scales = [0.0] * n
    for _ in range(4):
        for k in range(n):
            above = [x + scales[j] - scales[k] for (i, j), x in sizes.items() if i == k != j]
            below = [x + scales[k] - scales[i] for (i, j), x in sizes.items() if j == k != i]
            scales[k] += 0.5 * (max([FLOOR, *above]) - max([FLOOR, *below]))
    return [round(x) for x in scales]


def _doubled(values: Table, slopes: Table) -> tuple[Table, Table]:
    """Return the relation of two elements in a row, without the state between them, and its derivative."""
    n = len(values)
    zeros = [acb(0)] * n
    inner, inner_slopes = ([row[n:] for row in x] + [row[:n] for row in x] for x in (values, slopes))
    outer, outer_slopes = (
        [[*row[:n], *zeros] for row in x] + [[*zeros, *row[n:]] for row in x] for x in (values, slopes)
    )
    chosen = _pivots([[complex(x.mid()) for x in row] for row in inner])
    others = [i for i in range(2 * n) if i not in chosen]

    def rows(table: Table, numbers: Sequence[int]) -> acb_mat:
        return acb_mat([table[i] for i in numbers])

    pivots = rows(inner, chosen).transpose()
    weights = pivots.solve(rows(inner, others).transpose()).transpose()
    drift = rows(inner_slopes, others) - weights * rows(inner_slopes, chosen)
    tilts = pivots.solve(drift.transpose()).transpose()
    found = rows(outer, others) - weights * rows(outer, chosen)
    change = rows(outer_slopes, others) - weights * rows(outer_slopes, chosen) - tilts * rows(outer, chosen)
    powers = [arb(2) ** -round(max(map(_size, row))) for row in found.table()]
    scaled, also = (
        [[x * p for x in row] for row, p in zip(t.table(), powers, strict=True)] for t in (found, change)
    )
    return scaled, also


def _pivots(rows: list[list[complex]]) -> list[int]:
    """Return the rows that partial pivoting chooses, one a column."""
    left = dict(enumerate(rows))
    chosen: list[int] = []
    for k in range(len(rows[0])):
        i = max(left, key=lambda i: abs(left[i][k]))
        pivot = left.pop(i)
        chosen.append(i)
        if pivot[k]:
            for row in left.values():
                factor = row[k] / pivot[k]
                for j in range(k, len(row)):
                    row[j] -= factor * pivot[j]
    return chosen
