"""The equations of a network of line elements as a table of numbers, for solving at frequencies.

Input: :class:`Equations` of a distributed model.
Output: a :class:`LineNetwork`: which entries stand where, in an order in which the matrix is a narrow band.

A mass m that hangs on a rod has the unknowns u, f_a and f, what moves and what the rod delivers at both ends:

    -1 f + m s^2 u = F         three lumped entries, -1, m s^2 and -1 (of the input)
    z(l) = T z(0)              the rod, z(0) = (0, f_a), z(l) = (u, -f), a line of the table

See :mod:`symflex.algebra.line_networks` for what is done with it.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import count as count_from
from typing import TypeVar

from flint import fmpz_mpoly

from symflex.algebra import Factored
from symflex.algebra.ring import terms_of
from symflex.equations.equations import Continuum, Equations
from symflex.library.elements import LinearForm, Variable
from symflex.library.fields import coupled_states
from symflex.library.partial_fractions import Matrix

Value = TypeVar("Value")

Lumped = tuple[int, int, int]  # row, column, entry
Element = tuple[int, tuple[int, ...], int, tuple[int, ...], tuple[int, ...]]
"""First row, entries of coefficients, entry of the length, unknowns at the start and at the end."""
Group = tuple[tuple[tuple[int, int], ...], tuple[int, ...], tuple[Element, ...]]
"""Positions of the coefficients, signs of the state at the end, and the elements."""
Table = tuple[int, int, int, tuple[Lumped, ...], tuple[Group, ...]]
"""Unknowns, height and width of the window in which they are eliminated, lumped entries, groups."""


@dataclass(frozen=True, eq=False)
class LineNetwork:
    """``A(s) x + B u = 0``, ``y = C x + D u``; line elements are relations of the states at their ends."""

    equations: Equations  # cut, see :func:`symflex.equations.assemble.assemble`
    table: Table  # see :mod:`symflex.algebra.line_networks`
    entries: tuple[tuple[Factored, ...], ...]  # what the table's entries are sums of

    def numbers(self, output: str, source: str) -> tuple[int, int]:
        """Return the numbers that an output and an input have in the table."""
        outputs = [o.name for o in self.equations.outputs]
        return outputs.index(output), [v.owner for v in self.equations.inputs].index(source)

    def values(  # one argument for each kind of operation
        self,
        *,
        name: Callable[[str], Value],
        number: Callable[[Fraction], Value],
        total: Callable[[list[Value]], Value],
        product: Callable[[list[Value]], Value],
        quotient: Callable[[Value, Value], Value],
        power: Callable[[Value, int], Value],
        exponential: Callable[[Value], Value],
    ) -> list[Value]:
        """Return the entries in whatever arithmetic the values of names, s and parameters, have."""
        values_by_name: dict[str, Value] = {}
        definitions, delays = dict(self.equations.definitions), self.equations.delays

        def generator(key: str) -> Value:
            if key not in values_by_name:
                if key in definitions:
                    values_by_name[key] = value(definitions[key])
                elif key in delays:
                    values_by_name[key] = exponential(
                        product([number(Fraction(-1)), *map(value, delays[key])])
                    )
                else:
                    values_by_name[key] = name(key)
            return values_by_name[key]

        def polynomial(names: Sequence[str], factor: fmpz_mpoly) -> Value:
            return total(
                [
                    product([number(Fraction(c)), *(power(generator(names[i]), int(e)) for i, e in monomial)])
                    for monomial, c in terms_of(factor)
                ]
            )

        def value(x: Factored) -> Value:
            parts: tuple[list[Value], list[Value]] = [number(x.unit)], []
            for factor, exponent in x.factors:
                parts[exponent < 0].append(power(polynomial(x.ring.names, factor), abs(exponent)))
            return quotient(product(parts[0]), product(parts[1])) if parts[1] else product(parts[0])

        return [total([value(x) for x in terms]) for terms in self.entries]


@dataclass(frozen=True, slots=True)
class _Part:
    """An uncoupled part of a line element."""

    pattern: tuple[tuple[int, int], ...]
    signs: tuple[int, ...]
    coefficients: tuple[int, ...]
    length: int
    start: tuple[int, ...]
    end: tuple[int, ...]


class _Entries:
    """Sums of values, each once."""

    def __init__(self) -> None:
        self.values: list[tuple[Factored, ...]] = []
        self._known: dict[object, int] = {}

    def number(self, *terms: Factored) -> int:
        key = tuple((x.unit, *((tuple(terms_of(f)), e) for f, e in x.factors)) for x in terms)
        if key not in self._known:
            self._known[key] = len(self.values)
            self.values.append(terms)
        return self._known[key]


def line_network(equations: Equations) -> LineNetwork:
    """Return the table of equations that are cut where states of line elements are unknowns."""
    turned = [_turned(i, c) for i, c in enumerate(equations.continua)]
    unknowns = [*equations.unknowns, *(v for _, forms in turned for v, _ in forms)]
    rows = [*(r.form for r in equations.rows), *(form for _, forms in turned for _, form in forms)]
    # What is uniform along x is a part of the state that does not vary; at its end it is an unknown more.
    size = len(unknowns) + sum(len(c.loads) for c in equations.continua)
    columns = {v: i for i, v in enumerate(unknowns)} | {v: size + i for i, v in enumerate(equations.inputs)}
    entries = _Entries()
    more = count_from(len(unknowns))
    parts = [part for c, _ in turned for part in _parts(c, columns, more, entries)]
    touched = [[columns[v] for v, _ in row.terms] for row in rows] + [[*p.start, *p.end] for p in parts]
    touched = [[c for c in columns_of if 0 <= c < size] for columns_of in touched]
    position = [*_band_order(size, touched), *range(size, size + len(equations.inputs)), -1]
    spans = [
        (min(reached), max(reached))
        for reached in ([position[c] for c in columns_of] for columns_of in touched)
    ]
    numbers: dict[int, int] = {}
    count = height = width = end = 0
    for i in sorted(range(len(spans)), key=lambda i: spans[i]):
        numbers[i] = count
        count += 1 if i < len(rows) else len(parts[i - len(rows)].signs)
        end = max(end, spans[i][1] + 1)
        height, width = max(height, count - spans[i][0]), max(width, end - spans[i][0])
    at = {v: position[c] for v, c in columns.items()}
    lumped = [x for i, row in enumerate(rows) for x in _lumped(numbers[i], row, at, entries)]
    for i, output in enumerate(equations.outputs):
        lumped += _lumped(size + i, output.form * output.divisor**-1, at, entries)
    groups: dict[tuple[tuple[tuple[int, int], ...], tuple[int, ...]], list[Element]] = {}
    for i, p in enumerate(parts):
        start, end_ = (tuple(position[c] for c in state) for state in (p.start, p.end))
        element = (numbers[len(rows) + i], p.coefficients, p.length, start, end_)
        groups.setdefault((p.pattern, p.signs), []).append(element)
    kinds = tuple((*key, tuple(found)) for key, found in groups.items())
    return LineNetwork(equations, (size, height, width, tuple(lumped), kinds), tuple(entries.values))


def _turned(number: int, continuum: Continuum) -> tuple[Continuum, list[tuple[Variable, LinearForm]]]:
    """Return a member at an angle in its own axes, with its states there and what these are equal to."""
    axes, matrix = continuum.system.axes, continuum.system.matrix
    if axes is None or len(coupled_states(len(matrix), _places(matrix))) > 1:
        return continuum, []
    one = axes.cos**0
    system, readings = axes.own, axes.readings()
    forms: list[tuple[Variable, LinearForm]] = []
    states: list[list[tuple[Variable | None, int]]] = []
    for end, known in enumerate(([(v, 1) for v in continuum.initial], continuum.final)):
        state = list(known)
        for i, name in enumerate(system.states):
            if name in readings:
                variable = Variable("field", continuum.name, f"{name}({number}, {end})")
                terms = [(v, c * sign) for (v, sign), c in zip(known, readings[name], strict=True)]
                forms.append((variable, LinearForm.of((variable, -one), *terms)))
                state[i] = variable, 1
        states.append(state)
    initial = tuple(v for v, _ in states[0])
    return replace(continuum, system=system, initial=initial, final=tuple(states[1])), forms


def _places(matrix: Matrix) -> list[tuple[int, int]]:
    return [(i, j) for i, row in enumerate(matrix) for j, x in enumerate(row) if not x.is_zero]


def _parts(
    continuum: Continuum, columns: Mapping[Variable, int], more: Iterator[int], entries: _Entries
) -> Iterator[_Part]:
    system, loads = continuum.system, continuum.system.loads
    n = len(system.states)
    values = {(i, j): system.matrix[i][j] for i, j in _places(system.matrix)}
    values |= {(i, n + k): x for k, load in enumerate(loads) for i, x in enumerate(load) if not x.is_zero}
    variables = (*continuum.initial, *continuum.loads)
    initial = [-1 if v is None else columns[v] for v in variables]
    final = [(-1 if v is None else columns[v], sign) for v, sign in continuum.final]
    final += [(next(more), 1) for _ in loads]
    for states in coupled_states(n + len(loads), values):
        position = {state: i for i, state in enumerate(states)}
        within = {(position[i], position[j]): x for (i, j), x in values.items() if i in position}
        yield _Part(
            tuple(within),
            tuple(final[i][1] for i in states),
            tuple(entries.number(x) for x in within.values()),
            entries.number(continuum.length),
            tuple(initial[i] for i in states),
            tuple(final[i][0] for i in states),
        )


def _lumped(row: int, form: LinearForm, at: Mapping[Variable, int], entries: _Entries) -> Iterator[Lumped]:
    found: dict[int, list[Factored]] = {}
    for variable, coefficient in form.terms:
        found.setdefault(at[variable], []).append(coefficient)
    for column, terms in found.items():
        yield row, column, entries.number(*terms)


def _band_order(count: int, rows: Sequence[Sequence[int]]) -> list[int]:
    """Return places of unknowns such that those in one row stand close (Cuthill & McKee 1969, reversed).

    >>> _band_order(4, [[0, 3], [3, 1], [1, 2]])
    [3, 1, 0, 2]
    """
    of_column: list[list[int]] = [[] for _ in range(count)]
    for i, row in enumerate(rows):
        for c in row:
            of_column[c].append(i)
    degree = [len({c for i in row_numbers for c in rows[i]}) for row_numbers in of_column]
    found: list[int] = []
    seen: set[int] = set()
    for start in sorted(range(count), key=lambda c: degree[c]):
        if start in seen:
            continue
        # From the far end of a walk the levels are narrow.
        far = start
        for _ in range(2):
            far = _walk(far, rows, of_column, degree)[-1]
        order = _walk(far, rows, of_column, degree)
        seen.update(order)
        found += reversed(order)
    position = [0] * count
    for i, c in enumerate(found):
        position[c] = i
    return position


def _walk(
    start: int, rows: Sequence[Sequence[int]], of_column: Sequence[Sequence[int]], degree: Sequence[int]
) -> list[int]:
    """Return the unknowns connected to one, breadth first."""
    found, pending, seen = list[int](), deque([start]), {start}
    done: set[int] = set()
    while pending:
        c = pending.popleft()
        found.append(c)
        fresh = {x for i in of_column[c] if i not in done for x in rows[i]} - seen
        done.update(of_column[c])
        seen |= fresh
        pending.extend(sorted(fresh, key=lambda x: (degree[x], x)))
    return found
