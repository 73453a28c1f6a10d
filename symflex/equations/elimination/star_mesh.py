"""Elimination of a sparse network without multiplying anything out.

Input: :class:`symflex.equations.Equations`, and which transfer functions are wanted.
Output: a :class:`Elimination`: every quotient as two steps of one straight-line program.

A node's balance is kept as the impedance Z from the node to ground, and the impedances w to its neighbours:
``(Z + w_1 + w_2 + ...) x = w_1 x_1 + w_2 x_2 + ... + F``. Eliminating the node joins its neighbours by
``w_j w_k / (Z + w_1 + ...)`` and each to ground by ``w_j Z / (Z + w_1 + ...)``: the star-mesh transformation
(Rosen, "A new network theorem", Journal of the IEE 62, 1924), which as a way of elimination without
subtraction is that of Grassmann, Taksar and Heyman ("Regenerative analysis and steady state distributions for
Markov chains", Operations Research 33, 1985). For a chain it writes down the recurrence of Holzer (1921).
It holds for any row whose sum over some columns is known, so the same code serves constraints, motors and
signals. Which unknown is next is Markowitz's rule (1957): the one that can make the fewest new entries.

Example: a mass m_1 on a spring k_1 to ground, a spring k_2 from it to a mass m_2 that F acts on.

    before    (Z_1 + k_2) x_1 = k_2 x_2            Z_1 = m_1 s^2 + k_1
              (Z_2 + k_2) x_2 = k_2 x_1 + F        Z_2 = m_2 s^2

Node 1 has one neighbour, so no w_j w_k arises; node 2 is joined to ground by k_2 Z_1 / (Z_1 + k_2), which is
the spring k_2 in series with Z_1:

    after     (Z_2 + k_2 Z_1/(Z_1 + k_2)) x_2 = F

No difference is taken: every entry is made by adding, multiplying and dividing.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from heapq import heapify, heappop, heappush
from typing import TYPE_CHECKING

from symflex.algebra.straight_line import ONE, ZERO, Step, StraightLine, Workbench
from symflex.budget import spend, uncollected
from symflex.equations.elimination.singular import explain_singular
from symflex.errors import Diagnostic, ModelError
from symflex.library.elements import LinearForm, Variable

if TYPE_CHECKING:
    from symflex.algebra.propagators import Propagation, Propagator
    from symflex.equations import Equations

KEPT_LAST = 8  # rows an input may act on and be eliminated last; one that acts on more acts everywhere

NO_UNKNOWN = -2  # own column of a row of no unknown, such as a field's condition; inputs have -1

EXPLAINED = 2_500  # unknowns up to which a singular system is explained: that takes a dense matrix


@dataclass(frozen=True, eq=False)
class Elimination:
    """Quotients as steps of a straight-line program."""

    program: StraightLine  # over the generators of the equations; definitions stand for their values
    quotients: tuple[tuple[int, int], ...]  # per pair, numerator and denominator, maybe no polynomials
    pivots: tuple[int, ...]  # what was divided by: the product of these is the determinant, up to its sign
    waves: tuple[Waves, ...] = ()  # what generators that are functions of others stand for


@dataclass(frozen=True, slots=True)
class Waves:
    """Fundamental functions of one dispersion at one length, whose arguments are earlier steps."""

    generators: tuple[tuple[int, int], ...]  # their positions, and orders, or ``EXPONENTIAL``
    coefficients: tuple[int, ...]  # ``c_0, ..., c_(n-1)`` of the monic characteristic polynomial
    shift: int  # of its roots: the generator of order ``EXPONENTIAL`` is ``exp(-shift*length)``
    length: int

    @property
    def arguments(self) -> tuple[int, ...]:
        """The steps the functions are functions of."""
        return (*self.coefficients, self.shift, self.length)


@dataclass(slots=True)
class _NetworkRow:
    """``pivot * x = sum(entries)``: entries are minus the coefficients, each a list of terms to be added.

    With ``implicit`` that column's coefficient is not stored: it is the sum of ``ground`` and of the entries
    in columns of the same class, ``ground`` being the sum of coefficients over these columns.
    """

    entries: dict[int, list[int]]
    own: int
    implicit: int = -1
    ground: list[int] = field(default_factory=list)
    load: list[int] = field(default_factory=list)
    is_balance: bool = False

    def copy(self) -> _NetworkRow:
        """Return the row for an elimination of its own, which sets the load."""
        entries = {column: terms.copy() for column, terms in self.entries.items()}
        return replace(self, entries=entries, ground=self.ground.copy())


@dataclass(frozen=True, slots=True)
class _SolvedUnknown:
    """``below * x = sum(entries[k] * x_k) + load``."""

    column: int
    below: int
    entries: dict[int, int]
    load: int


def eliminate(equations: Equations, pairs: Sequence[tuple[str, str]]) -> Elimination:
    """Return transfer functions by output and input as nested quotients; SF30x for singular equations."""
    if len(equations.rows) != len(equations.unknowns):
        raise _singular(equations, ())
    with uncollected():
        return _eliminate(equations, pairs)


def _eliminate(equations: Equations, pairs: Sequence[tuple[str, str]]) -> Elimination:
    bench = Workbench(equations.ring.names)
    index = equations.ring.index
    for name, value in equations.definitions:
        bench.define(index[name], bench.factored(value))
    waves = () if equations.propagation is None else tuple(_waves(equations.propagation, bench))
    network = _Network.of(equations, bench)
    outputs = {o.name: o for o in equations.outputs}
    fractions: dict[tuple[str, str], tuple[int, int]] = {}
    pivots: tuple[int, ...] = ()
    sources = dict.fromkeys(source for _, source in pairs)
    for source in sources:
        wanted = [o for o, i in dict.fromkeys(pairs) if i == source]
        rows = [network.output(outputs[name].form, source) for name in wanted]
        run = _StarMesh(network, source, is_only=len(sources) == 1)
        pivots = tuple(solved.below for solved in run.solved)
        quotients = run.quotients([row for row, _ in rows], [load for _, load in rows])
        for name, (num, den) in zip(wanted, quotients, strict=True):
            fractions[name, source] = (num, bench.multiply(bench.factored(outputs[name].divisor), den))
    return Elimination(bench.finished(), tuple(fractions[pair] for pair in pairs), pivots, waves)


def _waves(propagation: Propagation, bench: Workbench) -> Iterable[Waves]:
    """Yield what the generators of a nameless propagation are functions of."""
    index, embed = propagation.ring.index, propagation.embed
    groups: dict[tuple[int, int], list[Propagator]] = {}
    for p in propagation.propagators:
        groups.setdefault((p.dispersion, p.length), []).append(p)
    for (number, position), group in groups.items():
        law = propagation.table.dispersions[number]
        yield Waves(
            tuple((index[p.generator], p.order) for p in group),
            tuple(bench.factored(embed(c)) for c in law.characteristic),
            bench.factored(embed(law.shift)),
            bench.factored(embed(propagation.lengths[number][position])),
        )


def _singular(equations: Equations, columns: Sequence[int]) -> ModelError:
    if len(equations.unknowns) <= EXPLAINED:
        return explain_singular(equations)
    names = ", ".join(f"'{equations.unknowns[c]}'" for c in columns[:6])
    return ModelError(Diagnostic("SF304", f"nothing determines {names or 'the system'}"))


@dataclass(frozen=True, eq=False)
class _Network:
    """The rows as steps of a workbench, the same for every input."""

    equations: Equations
    bench: Workbench
    columns: dict[tuple[str, str, str], int]
    classes: list[int]
    rows: list[tuple[_NetworkRow, dict[str, list[int]]]]

    @staticmethod
    def of(equations: Equations, bench: Workbench) -> _Network:
        columns: dict[tuple[str, str, str], int] = {
            (v.kind, v.owner, v.component): i for i, v in enumerate(equations.unknowns)
        }
        domains = {n.name: n.domain for n in equations.model.nodes}
        kinds: dict[tuple[str, str], int] = {}
        classes: list[int] = []
        for v in equations.unknowns:
            # Displacements add up with displacements, not with angles.
            kind = (domains.get(v.owner, ""), v.component)
            classes.append(kinds.setdefault(kind, len(kinds)) if v.kind == "node" else -1)
        network = _Network(equations, bench, columns, classes, [])
        for row in equations.rows:
            network.rows.append(network._row(row.about, row.form, is_balance=row.role == "balance"))
        network._part()
        return network

    def _part(self) -> None:
        """Part the classes of nodes that only ratios join, as gears do: their differences mean nothing."""
        parts = list(range(len(self.classes)))

        def part(column: int) -> int:
            while parts[column] != column:
                parts[column] = column = parts[parts[column]]
            return column

        for row, _ in self.rows:
            if self._is_ratio(row):
                continue
            first: dict[int, int] = {}
            for c in (row.implicit, *row.entries):
                if c >= 0 <= self.classes[c]:
                    parts[part(c)] = part(first.setdefault(self.classes[c], c))
        self.classes[:] = [kind if kind < 0 else part(c) for c, kind in enumerate(self.classes)]

    def _is_ratio(self, row: _NetworkRow) -> bool:
        """Tell whether a row contains two nodes, and not their difference."""
        match [*row.entries.values()]:
            case [one, other] if row.implicit < 0:
                return bool(self.bench.add([*one, *other]))
        return False

    def _row(
        self, about: Variable, form: LinearForm, *, is_balance: bool
    ) -> tuple[_NetworkRow, dict[str, list[int]]]:
        """Return a row, and what inputs contribute to it."""
        bench, columns = self.bench, self.columns
        own_column = columns.get((about.kind, about.owner, about.component), NO_UNKNOWN)
        row = _NetworkRow({}, own_column, is_balance=is_balance)
        loads: dict[str, list[int]] = {}
        diagonal: list[int] = []
        for variable, coefficient in form.terms:
            # Variables as keys would cost as much as all the rest.
            column = columns.get((variable.kind, variable.owner, variable.component), -1)
            if column == own_column:
                diagonal.append(bench.factored(coefficient))
            elif column < 0:
                loads.setdefault(variable.owner, []).append(bench.factored(coefficient, -1))
            else:
                row.entries.setdefault(column, []).append(bench.factored(coefficient, -1))
        ground = self._ground(row, diagonal) if is_balance else None
        if ground is None:
            if diagonal:
                row.entries[own_column] = [bench.negate(d) for d in diagonal]
        else:
            row.implicit, row.ground = own_column, ground
        return row, loads

    def _ground(self, row: _NetworkRow, diagonal: list[int]) -> list[int] | None:
        """Return what joins a node to ground: its own terms but for those of branches to other nodes."""
        nonzero: dict[int, int] = {}
        for step in diagonal:
            nonzero[step] = nonzero.get(step, 0) + 1
        kind = self.classes[row.own]
        for column, steps in row.entries.items():
            if self.classes[column] == kind:
                for step in steps:
                    if not nonzero.get(step):
                        return None
                    nonzero[step] -= 1
        ground: list[int] = []
        for step in diagonal:
            if nonzero[step]:
                nonzero[step] -= 1
                ground.append(step)
        return ground

    def output(self, form: LinearForm, source: str) -> tuple[dict[int, int], int]:
        """Return an output's coefficients by column, and that of the input."""
        terms: dict[int, list[int]] = {}
        load: list[int] = []
        for variable, coefficient in form.terms:
            step = self.bench.factored(coefficient)
            column = self.columns.get((variable.kind, variable.owner, variable.component), -1)
            if column >= 0:
                terms.setdefault(column, []).append(step)
            elif variable.owner == source:
                load.append(step)
        sums = {c: self.bench.add(steps) for c, steps in terms.items()}
        return {c: step for c, step in sums.items() if step}, self.bench.add(load)


class _StarMesh:
    """One elimination, for one input."""

    def __init__(self, network: _Network, source: str, *, is_only: bool = False) -> None:
        self.network = network
        self.bench = network.bench
        self.rows: list[_NetworkRow | None] = []
        size = len(network.classes)
        self.users: list[dict[int, None]] = [{} for _ in range(size)]
        self.hidden: list[int] = [0] * size
        """Per column, how many rows contain it implicitly."""
        self.handed: dict[int, dict[int, None]] = {}
        """Per column, the rows other than its own that do."""
        self.solved: list[_SolvedUnknown] = []
        loaded = 0
        for i, (row, loads) in enumerate(network.rows):
            copied = row if is_only else row.copy()
            copied.load = list(loads.get(source, ())) if loads else []
            loaded += bool(copied.load)
            for column in copied.entries:
                self.users[column][i] = None
            self.rows.append(copied)
            if copied.implicit >= 0:
                self.hidden[copied.implicit] += 1
        self.keeps_last = loaded <= KEPT_LAST
        self._eliminate()

    # ------------------------------------------------------------------------------------------- ordering

    def _cost(self, row: _NetworkRow) -> int:
        """Return how many entries the elimination of a row can make at most."""
        entries, users, hidden = row.entries, self.users, self.hidden
        column = row.own
        width = len(entries) + (row.implicit >= 0)
        if row.implicit == column or column in entries:
            return (width - 1) * (len(users[column]) + hidden[column] - 1)
        counts = [len(users[c]) + hidden[c] for c in entries]
        if row.implicit >= 0:
            counts.append(len(users[row.implicit]) + hidden[row.implicit])
        return (width - 1) * (min(counts, default=1) - 1)

    def _eliminate(self) -> None:
        rows = self.rows
        keeps_last = self.keeps_last
        heap = [
            (keeps_last and bool(row.load), self._cost(row), row.is_balance, i)
            for i, row in enumerate(rows)
            if row is not None
        ]
        heapify(heap)
        while heap:
            spend()
            is_late, cost, is_balance, i = heappop(heap)
            row = rows[i]
            if row is None:
                continue
            now = self._cost(row)
            late_now = keeps_last and bool(row.load)
            if now > cost or late_now != is_late:
                heappush(heap, (late_now, now, is_balance, i))
                continue
            for j in self._pivot(i, row):
                changed = rows[j]
                if changed is not None:
                    heappush(
                        heap, (keeps_last and bool(changed.load), self._cost(changed), changed.is_balance, j)
                    )

    # -------------------------------------------------------------------------------------------- a pivot

    def _pivot(self, i: int, row: _NetworkRow) -> list[int]:
        """Eliminate an unknown by a row; return the rows that changed."""
        bench, users = self.bench, self.users
        add, classes = bench.add, self.network.classes
        values: dict[int, int] = {}
        for column, terms in row.entries.items():
            del users[column][i]
            step = terms[0] if len(terms) == 1 else add(terms)
            if step:
                values[column] = step
        ground = ZERO
        if row.implicit >= 0:
            self.hidden[row.implicit] -= 1
            ground = add(row.ground)
            if bench.kinds[ground] > Step.NUMBER:
                bench.roles.setdefault(ground, "Z")
            kind = classes[row.implicit]
            row_sum = add([ground, *(v for c, v in values.items() if classes[c] == kind)])
            if row_sum:
                values[row.implicit] = bench.negate(row_sum)
        if not values:
            raise _singular(self.network.equations, [row.own])
        pivot = self._chosen(row, values)
        below = bench.negate(values.pop(pivot))
        load = add(row.load)
        if bench.kinds[below] == Step.NEGATE:
            # The sign goes to the other side, where it often meets another one.
            below = bench.negate(below)
            values = {c: bench.negate(v) for c, v in values.items()}
            load = bench.negate(load)
            ground = bench.negate(ground)
        self.rows[i] = None
        self.solved.append(_SolvedUnknown(pivot, below, values, load))
        return self._substitute(row, pivot, below, values, ground, load)

    def _chosen(self, row: _NetworkRow, values: dict[int, int]) -> int:
        """Return the column to eliminate: the row's own, else by a number, else the one used least."""
        if row.own in values:
            return row.own
        kinds, operands = self.bench.kinds, self.bench.operands

        def rank(column: int) -> tuple[bool, int, int]:
            step = values[column]
            inner = operands[step][0] if kinds[step] == Step.NEGATE else step
            return kinds[inner] != Step.NUMBER, len(self.users[column]) + self.hidden[column], column

        return min(values, key=rank)

    def _substitute(
        self, row: _NetworkRow, pivot: int, below: int, values: dict[int, int], ground: int, load: int
    ) -> list[int]:
        bench, users = self.bench, self.users
        classes = self.network.classes
        kind = classes[row.implicit] if row.implicit >= 0 else -2
        sums: dict[int, int] = {kind: ground}
        changed = list(users[pivot])
        if self.hidden[pivot]:
            changed += [j for j in self._holders(pivot) if j not in users[pivot]]
        quotients: dict[int, int] = {}
        mine: dict[int, int] = {}
        for j in changed:
            other = self._row(j)
            if other.implicit == pivot:
                value = self._unfold(j, other, pivot, values)
            else:
                value = bench.add(other.entries.pop(pivot))
            mine[j] = value
            quotients[j] = bench.divide(value, below) if value else ZERO
        users[pivot] = {}
        is_mirrored = self._is_mirrored(mine, values)
        for j, quotient in quotients.items():
            if not quotient:
                continue
            other = self._row(j)
            if load:
                other.load.append(bench.multiply(quotient, load))
            if other.implicit >= 0:
                wanted = classes[other.implicit]
                if wanted not in sums:
                    sums[wanted] = self._row_sum(wanted, pivot, below, values)
                if sums[wanted]:
                    other.ground.append(bench.multiply(quotient, sums[wanted]))
            if not is_mirrored:
                self._join(j, other, quotient, values)
        if is_mirrored:
            self._join_all(quotients, values)
        return changed

    def _is_mirrored(self, mine: dict[int, int], values: dict[int, int]) -> bool:
        """Tell whether row and column of a pivot agree, and every row involved holds its own column."""
        if len(mine) != len(values):
            return False
        rows = self.rows
        for j, value in mine.items():
            row = rows[j]
            if row is None or row.implicit != row.own or values.get(row.own, -1) != value:
                return False
        return True

    def _join(self, j: int, row: _NetworkRow, quotient: int, values: dict[int, int]) -> None:
        multiply = self.bench.multiply
        for column, value in values.items():
            if column != row.implicit:
                self._enter(j, row, column, multiply(quotient, value))

    def _join_all(self, quotients: dict[int, int], values: dict[int, int]) -> None:
        """Join all neighbours of a node by branches, the same in both directions."""
        multiply, enter = self.bench.multiply, self._enter
        items = [(j, q, self._row(j)) for j, q in quotients.items()]
        for a, (j, quotient, row) in enumerate(items):
            for k, _, other in items[a + 1 :]:
                product = multiply(quotient, values[other.own])
                enter(j, row, other.own, product)
                enter(k, other, row.own, product)

    def _enter(self, j: int, row: _NetworkRow, column: int, product: int) -> None:
        """Add a term to an entry."""
        entry = row.entries.get(column)
        if entry is None:
            row.entries[column] = [product]
            self.users[column][j] = None
        else:
            entry.append(product)

    def _row(self, j: int) -> _NetworkRow:
        """Return a row that is not eliminated yet."""
        row = self.rows[j]
        if row is None:
            raise AssertionError
        return row

    def _holders(self, column: int) -> list[int]:
        """Return the rows that contain a column implicitly: its own, or one it was handed to."""
        rows = self.rows
        candidates = (column, *self.handed.get(column, ()))
        return [
            j for j in dict.fromkeys(candidates) if (row := rows[j]) is not None and row.implicit == column
        ]

    def _unfold(self, j: int, row: _NetworkRow, pivot: int, values: dict[int, int]) -> int:
        """Return an implicit entry, and hand its place to another column that the pivot row brings in."""
        bench, classes = self.bench, self.network.classes
        kind = classes[pivot]
        self.hidden[pivot] -= 1
        entries = {c: bench.add(t) for c, t in row.entries.items()}
        row_sum = bench.add([bench.add(row.ground), *(v for c, v in entries.items() if classes[c] == kind)])
        row.implicit = next((c for c in values if classes[c] == kind), -1)
        if row.implicit >= 0:
            self.hidden[row.implicit] += 1
            self.handed.setdefault(row.implicit, {})[j] = None
            row.entries.pop(row.implicit, None)
            self.users[row.implicit].pop(j, None)
        else:
            row.ground = []
        row.entries.pop(pivot, None)
        return bench.negate(row_sum)

    def _row_sum(self, kind: int, pivot: int, below: int, values: dict[int, int]) -> int:
        """Return the sum of a row's coefficients over the columns of a class."""
        bench, classes = self.bench, self.network.classes
        terms = [bench.negate(v) for c, v in values.items() if classes[c] == kind]
        if classes[pivot] == kind:
            terms.insert(0, below)
        return bench.add(terms)

    # ------------------------------------------------------------------------------------ the other way

    def quotients(self, outputs: Sequence[dict[int, int]], loads: Sequence[int]) -> list[tuple[int, int]]:
        """Return numerator and denominator of every output, a combination of unknowns and the input."""
        bench = self.bench
        needed = {c for row in outputs for c in row}
        for solved in self.solved:
            if solved.column in needed:
                needed.update(solved.entries)
        last = self.solved[-1] if self.solved else None
        loaded = [solved for solved in self.solved if solved.load]
        # With the input on the last row alone, everything is in proportion to the last unknown.
        is_single = last is not None and loaded == [last]
        unknowns: dict[int, int] = {}
        for solved in reversed(self.solved):
            if solved.column not in needed:
                continue
            if is_single and solved is last:
                unknowns[solved.column] = ONE
                continue
            terms = [
                bench.multiply(bench.divide(value, solved.below), unknowns[c])
                for c, value in solved.entries.items()
                if unknowns[c]
            ]
            if solved.load:
                terms.append(bench.divide(solved.load, solved.below))
            unknowns[solved.column] = bench.add(terms) if terms else ZERO
        fractions: list[tuple[int, int]] = []
        for row, load in zip(outputs, loads, strict=True):
            total = bench.add([ZERO, *(bench.multiply(value, unknowns[c]) for c, value in row.items())])
            if is_single and last is not None:
                above = bench.add([bench.multiply(last.load, total), bench.multiply(load, last.below)])
                fractions.append((above, last.below if above else ONE))
                continue
            fractions.append(self._fraction(bench.add([total, load])))
        return fractions

    def _fraction(self, value: int) -> tuple[int, int]:
        bench = self.bench
        is_negative = bench.kinds[value] == Step.NEGATE
        inner = bench.operands[value][0] if is_negative else value
        if bench.kinds[inner] != Step.DIVIDE:
            return value, ONE
        above, below = bench.operands[inner]
        return (bench.negate(above) if is_negative else above), below
