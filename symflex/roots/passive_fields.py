"""Passive fields, semi-infinite ones too: no pole lies in the right half-plane.

The states of a field are displacements q and the forces p that do work on them, ``q' = a q + C p`` and
``p' = G q - a^T p`` up to signs. Then ``q* p`` changes along x by ``C* |p|^2 + G |q|^2``, and between its
ends by nothing where at each end one of the two vanishes.

    (E I w'')'' + rho A s^2 w = 0, w = w' = 0 at one end, free at the other
    s^2 int rho A |w|^2 + int E I |w''|^2 = 0, so that s^2 is real and negative

Here 1/C and G are polynomials ``k + c s + m s^2`` without negative coefficients, of stiffness, damping and
mass, and so is what holds an end; over s their real parts are not negative where that of s is positive
(Anderson & Vongpanitlerd 1973, Network Analysis and Synthesis, chapter 2). The same is true of ``s^2 C`` and
``s^2/G``. Where ``v' = -(R + L s) i`` and ``i' = -(G + C s) v`` the charge ``i/s`` is a displacement and v
its force. Where a layer couples displacements G is a symmetric matrix with semidefinite coefficients of 1, s
and s^2.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain, combinations, permutations, product

from flint import arb

from symflex.algebra import LAPLACE, Factored, by_powers, composed, degree_in, evaluated
from symflex.balls import precision
from symflex.equations import Continuum, Equations, assemble
from symflex.expressions import Call, Name
from symflex.library.elements import LinearForm, Terms, Variable, put_in
from symflex.model import ExactValue, Model
from symflex.model.along import COORDINATE, varies_along_x
from symflex.model.signs import Line, sign_between, sign_of, value_along

BITS = 128
MOST_STATES = 6  # most states of a field whose displacements and forces are identified by trial
MOST_TOGETHER = 4  # displacements that are coupled, whose energies take determinants of all choices
LOSS, INERTIA = 1, 2  # the powers of s of a damping and of a mass
LINE = 2  # states of a field whose waves go to and fro
BEAM = 4  # states of a field whose equation is of fourth order
Matrix = list[list[Factored]]
Pair = tuple[int, int, int]  # numbers of a displacement and its force, and the sign of their work


def fields_supply_nothing(model: Model, values: Mapping[str, ExactValue]) -> tuple[bool, bool, Equations]:
    """Tell whether it is proved that nothing in a model of fields supplies energy but its inputs.

    The second tells whether whatever moves in fields loses energy; with no elements, no pole lies on the
    imaginary axis but at 0. The third are the equations. ``values`` are those of the parameters. Elements
    have to be those of passive circuits, and sources that a field's end follows, as those of a line.
    Nothing is known where the equations of a field are of no such form as those above.
    """
    with precision(BITS):
        equations = assemble(replace(model, outputs=(), figures=(), published=()), is_cut=True)
        fields = _Fields(equations, values)
        is_passive = fields.are_passive()
        return is_passive, is_passive and replace(fields, are_lossy=True).are_passive(), equations


@dataclass(frozen=True, slots=True)
class _Paired:
    """A field with the states that do work on one another."""

    field: Continuum
    states: Matrix  # in terms of those of the field
    pairs: tuple[Pair, ...]


@dataclass(frozen=True)
class _Fields:
    """The equations of fields, with numbers."""

    equations: Equations
    values: Mapping[str, ExactValue]
    are_lossy: bool = False  # only what is lost counts, not what is stored

    def are_passive(self) -> bool:
        """Tell whether all fields and what holds their ends are passive, passive circuits included."""
        acting = {v for field in self.equations.continua for v in field.loads}
        if any(v.kind != "input" for v in acting):
            return False
        if any(value.depends_on(LAPLACE) for _, value in self.equations.definitions):
            return False  # what hides s behind a name is not seen to depend on it
        pairs = [list(self._paired(field)) for field in self.equations.continua]
        ways = max(map(len, pairs), default=0) if all(pairs) else 0
        return any(self._ends_are_passive([own[min(k, len(own) - 1)] for own in pairs]) for k in range(ways))

    def _paired(self, field: Continuum) -> Iterator[_Paired]:
        """Yield the pairs of a field with which it is passive: its energy may be written in several ways."""
        if len(field.system.states) % 2:
            return
        for matrix, states, known in _canonical(field):
            for pairs in _pairings(len(matrix)) if known is None else known:
                if (
                    _is_reciprocal(matrix, pairs)
                    and _begins_without_force(field, pairs)
                    and self._supplies_nothing(field, matrix, pairs)
                ):
                    yield _Paired(field, states, pairs)

    def _supplies_nothing(self, field: Continuum, matrix: Matrix, pairs: Sequence[Pair]) -> bool:
        """Tell whether what is stored and lost along a field is positive but at rest."""
        resting = set[int]()
        for q, p, sign in pairs:
            give = matrix[q][p] * sign
            powers = set[int]() if give.is_zero else self._stored(1 / give, field)
            if powers is None:
                return False
            if powers & self._counted:
                resting.add(p)
        for group in _joined(len(pairs), lambda i, j: not matrix[pairs[i][1]][pairs[j][0]].is_zero):
            together = [pairs[i] for i in group]
            held = [[matrix[p][q] * sign for q, _, _ in together] for _, p, sign in together]
            powers = self._held(held, field)
            if powers is None:
                return False
            if powers & self._counted:
                resting |= {q for q, _, _ in together}
        # A state at rest has no slope; if that is made of one other state alone, it rests, too.
        size = range(len(matrix))
        while True:
            moving = [
                (i, [j for j in size if not matrix[i][j].is_zero and j not in resting]) for i in resting
            ]
            more = {row[0] for i, row in moving if len(row) == 1 and self._keeps(matrix[i][row[0]])}
            if not more:
                return len(resting) == len(matrix)
            resting |= more

    @property
    def _counted(self) -> set[int]:
        """The powers of s whose energy is looked at: of stiffness, damping and mass, or of damping alone."""
        return {LOSS} if self.are_lossy else {0, LOSS, INERTIA}

    def _keeps(self, value: Factored) -> bool:
        """Tell whether a coefficient vanishes nowhere in the right half-plane, nor on the axis but at 0."""
        return not self.are_lossy or len(_coefficients(value) or ()) == 1

    def _held(self, held: Matrix, field: Continuum | None) -> set[int] | None:
        """Return the powers of s whose energy holds all displacements, ``None`` where one may be negative."""
        own = held[0][0]
        if len(held) == 1:
            return set() if own.is_zero else self._stored(own, field) if field else self._powers(own, None)
        parts = [[_coefficients(value) for value in row] for row in held]
        if len(held) > MOST_TOGETHER or any(part is None for row in parts for part in row):
            return None
        powers = {power for row in parts for part in row for power in part or ()}
        if max(powers, default=0) > INERTIA:
            return None
        definite, size = set[int](), range(len(held))
        for power in powers:
            matrix = [[(part or {}).get(power, own * 0) for part in row] for row in parts]
            for chosen in chain.from_iterable(combinations(size, n + 1) for n in size):
                minor = _determinant([[matrix[i][j] for j in chosen] for i in chosen])
                if not minor.is_zero and self._sign(minor, field) != 1:
                    return None
                if not minor.is_zero and len(chosen) == len(held):
                    definite.add(power)
        return definite

    def _ends_are_passive(self, fields: Sequence[_Paired]) -> bool:
        """Tell whether no energy comes in at the ends, if all inputs rest."""
        ends = [(each, *end) for each in fields for end in self._ends(each.field)]
        forces = {v for each, _, _, given in ends for _, p, _ in each.pairs if (v := given[p]) is not None}
        known = self._eliminated(forces)
        if known is None:
            return False
        states: list[list[Terms]] = []
        for each, _, place, given in ends:
            rows = [[_at(x, place) for x in row] for row in each.states]
            states.append([free_terms(LinearForm.of(*zip(given, row, strict=True)), known) for row in rows])
        shifts = [free[q] for (each, *_), free in zip(ends, states, strict=True) for q, _, _ in each.pairs]
        # What moves with a velocity v is q = v/s: it is v/s that is free.
        slow = {v: _laplace(c) for form in shifts for v, c in form.items() if _is_over_s(c)}
        supplied: dict[tuple[Variable, Variable], Factored] = {}
        for (each, side, _, _), unscaled in zip(ends, states, strict=True):
            free = [{v: c * slow[v] if v in slow else c for v, c in form.items()} for form in unscaled]
            for q, p, sign in each.pairs:
                if any(a.depends_on(LAPLACE) for a in free[q].values()):
                    return False
                for (one, a), (other, b) in product(free[q].items(), free[p].items()):
                    work = a * b * (side * sign)
                    supplied[one, other] = supplied.get((one, other), work * 0) + work
        drawn = {both: -work for both, work in supplied.items() if not work.is_zero}
        taken = self._taken(known)
        if taken is None or not all(moved in slow for moved, _ in taken):
            return False
        for both, work in taken.items():
            left = drawn.pop(both, work * 0) - work
            if not left.is_zero:
                return False
        if any((j, i) not in drawn or not (drawn[j, i] - work).is_zero for (i, j), work in drawn.items()):
            return False
        moved = list(dict.fromkeys(one for one, _ in drawn))
        works = [[drawn.get((one, other), fields[0].field.start * 0) for other in moved] for one in moved]
        return all(
            self._held([[works[i][j] for j in group] for i in group], None) is not None
            for group in _joined(len(moved), lambda i, j: not works[i][j].is_zero)
        )

    def _eliminated(self, forces: set[Variable]) -> dict[Variable, Terms] | None:
        """Return what conditions say of states by those that stay free; None with unstable divisors."""
        known: dict[Variable, Terms] = {}
        for row in (row for row in self.equations.rows if row.role == "condition"):
            parts = free_terms(row.form, known)
            chosen = min(parts, key=lambda v: v not in forces, default=None)
            if chosen is not None:
                own = parts.pop(chosen)
                if self._powers(own, None) is None and self._powers(-own, None) is None:
                    return None
                known[chosen] = {v: -c / own for v, c in parts.items()}
                known = {v: put_in(c, known) for v, c in known.items()}
        return known

    def _taken(self, known: Mapping[Variable, Terms]) -> dict[tuple[Variable, Variable], Factored] | None:
        """Return what circuits take from fields, as products of a node's effort with a flow; None if unknown.

        A balance is what flows out through elements, minus what sources deliver. It is zero, and so is the
        power of the elements minus that of the sources.
        """
        flows: dict[Variable, Terms] = {}
        for row in (row for row in self.equations.rows if row.role == "signal"):
            parts = free_terms(row.form, known)
            own = parts.pop(row.about, None)
            if own is None or any(v.kind != "field" for v in parts):
                return None
            flows[row.about] = {v: -c / own for v, c in parts.items()}
        taken: dict[tuple[Variable, Variable], Factored] = {}
        for row in (row for row in self.equations.rows if row.role == "balance"):
            for source, share in row.form.terms:
                if source not in flows:
                    continue
                if not share.is_constant:
                    return None
                sign = 1 if share.unit > 0 else -1  # a balance is multiplied by what numbers have below
                for flow, c in flows[source].items():
                    taken[row.about, flow] = taken.get((row.about, flow), c * 0) - c * sign
        return {both: work for both, work in taken.items() if not work.is_zero}

    def _ends(self, field: Continuum) -> list[tuple[int, Factored, Sequence[Variable | None]]]:
        """Return per end -1 where x begins and 1 where it ends, its place, and the states there."""
        side = -1 if self._number(field.length) > 0 else 1
        there = [v for v, _ in field.final]
        return [(side, field.start, field.initial), (-side, field.start + field.length, there)]

    def _stored(self, value: Factored, field: Continuum) -> set[int] | None:
        """Return the powers of s in a value or in its counterpart, ``None`` where it may supply energy."""
        powers = self._powers(value, field)
        return self._powers(_laplace(value) ** 2 / value, field) if powers is None else powers

    def _powers(self, value: Factored, field: Continuum | None) -> set[int] | None:
        """Return the powers of s in a value, ``None`` where one of them may have a negative coefficient."""
        parts = _coefficients(value)
        if parts is None or max(parts, default=0) > INERTIA:
            return None
        return set(parts) if all(self._sign(part, field) == 1 for part in parts.values()) else None

    def _sign(self, value: Factored, field: Continuum | None) -> int | None:
        """Return the sign of a value all along a field, but for its ends; ``None`` where it is not told."""
        sign = 1 if value.unit > 0 else -1
        for factor, exponent in value.factors:
            own = self._sign_of_factor(Factored.polynomial(value.ring, factor), field) if exponent % 2 else 1
            if own is None:
                return None
            sign *= own
        return sign

    def _sign_of_factor(self, value: Factored, field: Continuum | None) -> int | None:
        if field is None or not any(n in value.ring.index and value.depends_on(n) for n in self._along):
            return sign_of(self._number(value))
        (low, is_zero_first), (high, is_zero_last) = (
            (self._number(place), _at(value, place).is_zero)
            for _, place, _ in sorted(self._ends(field), key=lambda end: end[0])
        )
        slope = value.slope(COORDINATE) if len(self._along) == 1 else None
        return sign_between(
            (low, high),
            lambda x: self._number(value, x),
            lambda x: None if slope is None else self._number(slope, x),
            (is_zero_first, is_zero_last),
        )

    @cached_property
    def _along(self) -> tuple[str, ...]:
        """The generators that vary along x."""
        return (COORDINATE, *(n for n, c in self._functions.items() if varies_along_x(c)))

    @cached_property
    def _functions(self) -> Mapping[str, Call]:
        return {c.generator: c.expression for c in self.equations.constants}

    @cached_property
    def _line(self) -> Line:
        return Line.of_numbers(self.equations.model.definitions, self.values.items())

    def _number(self, value: Factored, x: arb | None = None) -> arb:
        """Return a value on a ball of x; not a number where a parameter has none."""
        at = arb("nan") if x is None else x

        def generator(name: str) -> arb:
            found = value_along(self._functions.get(name, Name(name)), at, self._line)
            return arb("nan") if found is None else found

        number: arb = evaluated(value, generator, arb(1))
        return number


def _canonical(field: Continuum) -> Iterator[tuple[Matrix, Matrix, Sequence[tuple[Pair, ...]] | None]]:
    """Yield equations of a field with their states, with forces first and as they are, and the pairs."""
    matrix = [list(row) for row in field.system.matrix]
    n, zero = len(matrix), matrix[0][0] * 0
    unit = [[zero + int(i == j) for j in range(n)] for i in range(n)]
    # Finite solutions at a tip are told in the field's own states.
    if None not in field.initial:
        if n % BEAM == 0 and all(_is_slope(matrix, i) for i in range(n) if i % BEAM != BEAM - 1):
            beams = range(0, n, BEAM)
            # The moment turns, and the shear force moves against its sign.
            pairs = [
                tuple(pair for i in beams for pair in ((i + 1, i + 2, sign), (i, i + 3, -sign)))
                for sign in (1, -1)
            ]
            yield from ((*each, None if n <= MOST_STATES else pairs) for each in _bent(matrix, unit))
        elif all(_is_slope(matrix, i) for i in range(0, n, 2)):
            m = n // 2
            pairs = [tuple((i, m + i, sign) for i in range(m)) for sign in (1, -1)]
            yield from ((*each, None if n <= MOST_STATES else pairs) for each in _stretched(matrix, unit))
    if n <= MOST_STATES:
        yield matrix, unit, None
    if n == LINE:
        s = _laplace(zero)
        for i, j in ((0, 1), (1, 0)):  # a state over s: the charge of a current, the flux of a voltage
            rates = [list(row) for row in matrix]
            rates[i][j], rates[j][i] = matrix[i][j] / s, matrix[j][i] * s
            yield rates, [[x / s for x in row] if k == i else row for k, row in enumerate(unit)], None


def _pairings(n: int) -> Iterator[tuple[Pair, ...]]:
    """Yield every way to tell n states into displacements and forces that do work on them."""
    for chosen in combinations(range(n), n // 2):
        others = [i for i in range(n) if i not in chosen]
        for forces, signs in product(permutations(others), product((1, -1), repeat=n // 2)):
            yield tuple(zip(chosen, forces, signs, strict=True))


def _joined(n: int, is_joined: Callable[[int, int], bool]) -> Iterator[list[int]]:
    """Yield which of n hang together."""
    left = list(range(n))
    while left:
        group = [left.pop(0)]
        for one in group:
            more = [other for other in left if is_joined(one, other)]
            group += more
            left = [other for other in left if other not in more]
        yield group


def _determinant(matrix: Matrix) -> Factored:
    """Return the determinant of a small matrix, by its first row."""
    first, *rest = matrix
    if not rest:
        return first[0]
    total = first[0] * 0
    for j, x in enumerate(first):
        total = total + x * _determinant([[*row[:j], *row[j + 1 :]] for row in rest]) * (-1) ** j
    return total


def _coefficients(value: Factored) -> dict[int, Factored] | None:
    """Return the coefficients of a polynomial in s, ``None`` where a value is none."""
    if value.is_zero:
        return {}
    moving = value.filter(lambda factor: degree_in(factor, 0) > 0)
    if not moving.denominator().is_one:
        return None
    rest = value / moving
    parts = by_powers(value.ring, moving.expand())
    return {power: Factored.polynomial(value.ring, part) * rest for power, part in parts.items()}


def _laplace(value: Factored) -> Factored:
    return Factored.polynomial(value.ring, value.ring.context.gen(0))


def _is_over_s(value: Factored) -> bool:
    return value.depends_on(LAPLACE) and not (value * _laplace(value)).depends_on(LAPLACE)


def _is_slope(matrix: Matrix, i: int) -> bool:
    """Tell whether the slope of a state is the next one, and nothing else."""
    return all(x.is_one if j == i + 1 else x.is_zero for j, x in enumerate(matrix[i]))


def _moves(value: Factored) -> bool:
    return COORDINATE in value.ring.index and value.depends_on(COORDINATE)


def _bent(matrix: Matrix, unit: Matrix) -> Iterator[tuple[Matrix, Matrix]]:
    """Yield w'''' = a w'' + a' w' + b w as (w'')'' - (a w')' - b w = 0, whose force is w''' - a w'.

    All of it is multiplied by what it was divided by, so that damping stays with its stiffness. Several beams
    may be joined along x, each b being a matrix.
    """
    n, zero, rows, states = len(matrix), matrix[0][0] * 0, [], []

    def row(entries: Mapping[int, Factored]) -> list[Factored]:
        return [entries.get(j, zero) for j in range(n)]

    for i in range(0, n, BEAM):
        law = list(matrix[i + BEAM - 1])
        load, slope, tension, odd = law[i : i + BEAM]
        change = tension.slope(COORDINATE) if _moves(tension) else zero
        common = load.denominator()
        law[i + 1] = law[i + 2] = zero
        alone = all(x.is_zero for j, x in enumerate(law) if j % BEAM)
        if load.is_zero or _moves(common) or not odd.is_zero or not (slope - change).is_zero or not alone:
            return
        held = tension * common
        states += [*unit[i : i + 2], row({i + 2: common}), row({i + 1: -held, i + 3: common})]
        rows += [unit[i + 1], row({i + 2: 1 / common}), row({i + 1: held, i + 3: zero + 1})]
        rows.append([x * common for x in law])
    yield rows, states


def _stretched(matrix: Matrix, unit: Matrix) -> Iterator[tuple[Matrix, Matrix]]:
    """Yield K u'' = (B^T - B) u' + D u with forces K u' + B u, for every B of one entry per pair.

    Of a beam that shears u is w and phi, K is k G A and E I, and B holds -k G A: k G A (w' - phi) is a force.
    """
    m, zero = len(matrix) // 2, matrix[0][0] * 0
    moved = [[matrix[2 * i + 1][2 * j + 1] for j in range(m)] for i in range(m)]
    held = [[matrix[2 * i + 1][2 * j] for j in range(m)] for i in range(m)]
    scale: list[Factored] = []
    for i in range(m):
        # Entries of B^T - B have both signs, those of D one: that tells all factors from those before.
        told = [-scale[j] * moved[j][i] / moved[i][j] for j in range(i) if not moved[i][j].is_zero]
        told += [scale[j] * held[j][i] / held[i][j] for j in range(i) if not held[i][j].is_zero]
        told += [x.denominator() for x in (held[i][i], *moved[i]) if not x.is_zero]
        scale.append(next(iter(told), zero + 1))
    both = [(i, j) for i in range(m) for j in range(i + 1)]
    if any(k.is_zero or _moves(k) for k in scale) or not all(
        (scale[i] * moved[i][j] + scale[j] * moved[j][i]).is_zero for i, j in both
    ):
        return
    coupled = [(i, j) for i, j in both if not moved[i][j].is_zero]
    for turned in product((False, True), repeat=len(coupled)):
        b = [[zero] * m for _ in range(m)]
        for (i, j), is_turned in zip(coupled, turned, strict=True):
            row, column = (j, i) if is_turned else (i, j)
            b[row][column] = -scale[row] * moved[row][column]
        # u' = (p - B u)/K and p' = B^T u' + D u.
        rows = [
            [*(-x / k for x in b[i]), *(1 / k if j == i else zero for j in range(m))]
            for i, k in enumerate(scale)
        ]
        forces = [
            list(chain(*((x, k if j == i else zero) for j, x in enumerate(b[i]))))
            for i, k in enumerate(scale)
        ]
        for i in range(m):
            taken = [sum((b[k][i] * b[k][j] / scale[k] for k in range(m)), zero) for j in range(m)]
            own = [held[i][j] * scale[i] - x for j, x in enumerate(taken)]
            rows.append([*own, *(b[j][i] / scale[j] for j in range(m))])
        yield rows, [*unit[::2], *forces]


def _is_reciprocal(matrix: Matrix, pairs: Sequence[Pair]) -> bool:
    """Tell whether the work of pairs changes by nothing but squares of displacements and forces."""
    for (q, p, sign), (other, force, its) in product(pairs, repeat=2):
        held = matrix[p][other] * sign - matrix[force][q] * its
        if q != other and not (matrix[q][force].is_zero and held.is_zero):
            return False
        carried = matrix[q][other]
        if carried.depends_on(LAPLACE) or not (carried * sign + matrix[force][p] * its).is_zero:
            return False
    return True


def _begins_without_force(field: Continuum, pairs: Iterable[Pair]) -> bool:
    """Tell whether no force acts where a field begins at a tip."""
    if None not in field.initial:
        return True
    laws = [law.singular for _, law in field.parts]
    if len(laws) != 1 or laws[0] is None:
        return False
    values = laws[0].at_start()
    return all(x.is_zero for _, p, _ in pairs for x in values[p])


def free_terms(form: LinearForm, known: Mapping[Variable, Terms] | None = None) -> Terms:
    """Return the terms of a form where inputs rest, with ``known`` forms put in."""
    return put_in({v: c for v, c in LinearForm.total([form]).terms if v.kind != "input"}, known or {})


def _at(value: Factored, place: Factored) -> Factored:
    """Return what varies along x at a place."""
    images = {COORDINATE: place} if COORDINATE in value.ring.index else {}
    return composed(value, images)
