"""From a model to state equations whose states are quantities of the model.

Input: a resolved model, and which outputs and inputs are wanted. Output: :class:`StateSpace`, proved.

The equations ``A(s) x + B(s) u = 0`` of all elements are brought to Popov form, which says of every node,
current and signal how many of its derivatives are independent: these are the states. One that follows an
input directly, or its derivatives, stands for what is left when that part is taken away. The result is
substituted into the model's equations, which it must satisfy identically.

Example: a mass on a spring and a damper, pushed by F and read at its node.

    before    (m s^2 + b s + k) x = F
    after     states x, v:   s x = v,   s v = -(k/m) x - (b/m) v + (1/m) F,   X = x
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from symflex.algebra import LAPLACE, Factored, Radicals, Ring
from symflex.equations import ConstantFunction, Equations, assemble, radicals_of
from symflex.equations.elimination import explain_singular
from symflex.errors import Diagnostic, ModelError
from symflex.expressions import Attribute, Expression, Name, names, product_of
from symflex.expressions import power as power_of
from symflex.library.elements import CIRCUITS, LinearForm, Variable
from symflex.library.elements.element import ACROSS_UNIT, COMPONENT_DOMAIN, COMPONENT_UNIT
from symflex.model import Model
from symflex.model.loss_factors import check_causal
from symflex.quantities import unit_of
from symflex.state_space.opened import opened, with_filters_apart
from symflex.state_space.popov import (
    FieldElement,
    Row,
    SolvedRows,
    Vector,
    add_term,
    applied,
    combined,
    solve,
)
from symflex.transfer.derive import nested_transfer

DISPLACEMENT, FLOW, VOLTAGE, SIGNAL = 0, 5, 6, 7
"""Weights of unknowns, where a derivative counts 4. What weighs most in an equation is solved for: velocities
(4) are states rather than currents and forces (5), these rather than voltages and signals, all of them rather
than accelerations (8); and a current's derivative (9) follows from voltages and signals."""

PARTIAL = "partial"  # a filter's partial state: what drives it over its denominator (Wolovich 1974)
REST = "_rest"  # added to the name of a state from which a part that follows inputs directly is taken away

THROUGH_UNITS = {**COMPONENT_UNIT, "v": "V"}
RATES = {"m": ("m", "m/s", "m/s^2"), "rad": ("rad", "rad/s", "rad/s^2")}
NAMES_OF_RATES = ("", "_dot", "_ddot")


def realise(model: Model, pairs: Sequence[tuple[str, str]] | None = None) -> StateSpace:
    """Return one realisation with the outputs and inputs of the given pairs, all by default.

    Other inputs are zero. All states of the model are in it, uncontrollable and unobservable ones too.
    """
    check_causal(model, "a state-space model")
    if model.is_distributed:
        raise not_rational("the model")
    pairs = model.transfer_functions if pairs is None else pairs
    outputs = tuple(dict.fromkeys(output for output, _ in pairs))
    inputs = tuple(dict.fromkeys(source for _, source in pairs))
    plain = opened(model)
    builder = _built(plain, outputs, inputs)
    divided = with_filters_apart(plain)
    if divided is not plain:
        other = _built(divided, outputs, inputs)
        # More states would be ones that filters with a common denominator share.
        if len(other.solved.states) == len(builder.solved.states):
            builder = other
    return replace(builder.state_space(outputs, inputs), model=model)


def _built(model: Model, outputs: Sequence[str], inputs: Sequence[str]) -> _Realisation:
    equations = assemble(model, nested_transfer)
    radicals = radicals_of(equations.ring, equations.constants, model.parameters)
    rows = _Rows.of(equations, outputs, inputs, radicals)
    shown = {_owner(n) for o in model.outputs if o.name in outputs for n in names(o.expression)}
    solved = solve(rows.rows, _weights(rows, model, shown))
    if solved is None:
        raise explain_singular(equations)
    return _Realisation(model, equations.ring, equations.constants, radicals, rows, solved)


def realise_quotient(
    ratio: Factored,
    constants: tuple[ConstantFunction, ...],
    radicals: Radicals,
    model: Model,
    pair: tuple[str, str],
) -> StateSpace:
    """Return state equations of a rational function of s in a model that is not rational itself."""
    output, source = pair
    ring = ratio.ring
    y = Variable("value", output)
    row: Row = {}
    for power, value in _powers(ring, ratio.denominator(), radicals).items():
        row[0, power] = value
    for power, value in _powers(ring, ratio.numerator(), radicals).items():
        row[1, power] = -value
    one = FieldElement.number(ring, 1)
    columns = {y: 0, Variable("input", source): 1}
    rows = _Rows((y,), (source,), ((y, "signal"),), (row,), ({(0, 0): one},)).with_partial_states(columns)
    solved = solve(rows.rows, [(SIGNAL, 0)])
    if solved is None:
        raise AssertionError("a denominator is not zero")
    return _Realisation(model, ring, constants, radicals, rows, solved).state_space((output,), (source,))


def not_rational(what: str) -> ModelError:
    """Return the error for beams, rods and delays where finitely many states are wanted."""
    message = f"{what} is not rational: beams, rods and delays have infinitely many states"
    hint = (
        "'symflex rational' approximates it with finitely many; in Python, H.rational(modes=N) has the "
        "same methods"
    )
    return ModelError(Diagnostic("SF235", message, None, hint))


def _owner(name: Expression) -> str:
    match name:
        case Name(owner) | Attribute(owner):
            return owner
    return ""


@dataclass(frozen=True, eq=False)
class _Rows:
    """The equations with columns by number: unknowns first, then inputs."""

    # unknowns and inputs: what the columns are.
    unknowns: tuple[Variable, ...]
    inputs: tuple[str, ...]
    about: tuple[tuple[Variable, str], ...]  # per row what it determines, and its role
    rows: tuple[Row, ...]  # each is zero
    results: tuple[Row, ...]  # per output what it is, not yet reduced

    @staticmethod
    def of(equations: Equations, outputs: Sequence[str], inputs: Sequence[str], radicals: Radicals) -> _Rows:
        ring = equations.ring
        filtered = {o.name for o in equations.outputs if o.name in outputs and o.divisor.depends_on(LAPLACE)}
        own = tuple(Variable("value", name) for name in outputs if name in filtered)
        unknowns = (*equations.unknowns, *own)
        everything = (*unknowns, *(Variable("input", name) for name in inputs))
        columns = {variable: j for j, variable in enumerate(everything)}
        about: list[tuple[Variable, str]] = [(row.about, row.role) for row in equations.rows]
        rows = [_row(ring, row.form, columns, radicals) for row in equations.rows]
        results: list[Row] = []
        by_name = {o.name: o for o in equations.outputs}
        for name in outputs:
            row = _row(ring, by_name[name].form, columns, radicals)
            divisor = _powers(ring, by_name[name].divisor, radicals)
            if name in filtered:
                column = columns[Variable("value", name)]
                for power, value in divisor.items():
                    add_term(row, (column, power), -value)
                about.append((Variable("value", name), "signal"))
                rows.append(row)
                results.append({(column, 0): FieldElement.number(ring, 1)})
            else:
                results.append({key: value / divisor[0] for key, value in row.items()})
        collected = _Rows(unknowns, tuple(inputs), tuple(about), tuple(rows), tuple(results))
        return collected.with_partial_states(columns)

    def with_partial_states(self, columns: Mapping[Variable, int]) -> _Rows:
        """Return the equations with ``den z = x``, and ``num z`` for y, in place of every ``den y = num x``.

        Otherwise derivatives of x, and of inputs with it, would be part of the states.
        """
        filters: dict[int, tuple[int, dict[int, FieldElement], Row]] = {}
        for i, (variable, role) in enumerate(self.about):
            parts = _as_filter(self.rows[i], columns[variable]) if role == "signal" else None
            if parts is not None:
                filters[columns[variable]] = (i, *parts)
        rows = list(self.rows)
        for i, _, row in filters.values():
            rows[i] = row

        def put_in(row: Row, own: int | None) -> Row:
            result: Row = {}
            for (column, power), value in row.items():
                if column in filters and column != own:
                    for above, factor in filters[column][1].items():
                        add_term(result, (column, power + above), value * factor)
                else:
                    add_term(result, (column, power), value)
            return result

        owner = {i: column for column, (i, _, _) in filters.items()}
        unknowns = tuple(
            Variable(v.kind, v.owner, PARTIAL) if j in filters else v for j, v in enumerate(self.unknowns)
        )
        about = tuple((unknowns[columns[v]] if columns.get(v) in filters else v, r) for v, r in self.about)
        changed = tuple(put_in(row, owner.get(i)) for i, row in enumerate(rows))
        return _Rows(unknowns, self.inputs, about, changed, tuple(put_in(row, None) for row in self.results))


def _as_filter(row: Row, column: int) -> tuple[dict[int, FieldElement], Row] | None:
    """Return num and the row ``den z - x`` of a row ``den y - num x``, ``None`` if num is constant."""
    parts: dict[int, dict[int, FieldElement]] = {}
    for (other, power), value in row.items():
        if other != column:
            parts.setdefault(other, {})[power] = value
    if not parts or not any(other == column and power for other, power in row):
        return None
    num: dict[int, FieldElement] | None = None
    result = {key: value for key, value in row.items() if key[0] == column}
    for other, powers in parts.items():
        lead = powers[max(powers)]
        monic = {power: value / lead for power, value in powers.items()}
        if max(monic) == 0:
            return None
        if num is not None and (
            num.keys() != monic.keys() or any(not (num[i] - monic[i]).is_zero for i in num)
        ):
            return None
        num = monic
        result[other, 0] = lead
    return None if num is None else (num, result)


def _row(ring: Ring, form: LinearForm, columns: Mapping[Variable, int], radicals: Radicals) -> Row:
    """Return a form by columns and powers of s; inputs that are not wanted are zero."""
    row: Row = {}
    for variable, coefficient in form.terms:
        if variable in columns:
            for power, value in _powers(ring, coefficient, radicals).items():
                add_term(row, (columns[variable], power), value)
    return row


def _powers(ring: Ring, value: Factored, radicals: Radicals) -> dict[int, FieldElement]:
    """Return the coefficients of the powers of s in a polynomial."""
    one = ring.constant(1)
    parts = [*enumerate(ring.coefficients(value.expand()))][::-1]  # as they print, the highest first
    values = [(power, FieldElement.of(part, one, radicals)) for power, part in parts]
    return {power: value for power, value in values if not value.is_zero}


def _weights(rows: _Rows, model: Model, shown: set[str]) -> list[tuple[int, int]]:
    """Return how readily each unknown is solved for.

    Nodes with inertia or capacitance and currents of inductances are states first, then nodes that outputs
    show; constraint forces last.
    """
    domains = {n.name: n.domain for n in model.nodes}
    columns = {variable: j for j, variable in enumerate(rows.unknowns)}
    stores, is_constraint = set(), set()
    for (variable, role), row in zip(rows.about, rows.rows, strict=True):
        is_moving = variable.kind == "node" and domains.get(variable.owner) not in CIRCUITS
        if variable in columns and (columns[variable], 2 if is_moving else 1) in row:
            stores.add(variable)
        if role == "constraint":
            is_constraint.add(variable)

    def weight(variable: Variable) -> int:
        if variable.kind == "node":
            return VOLTAGE if domains.get(variable.owner) in CIRCUITS else DISPLACEMENT
        return FLOW if variable.kind == "through" else SIGNAL

    def readiness(j: int) -> tuple[bool, bool, bool, int]:
        v = rows.unknowns[j]
        is_shown = v.kind == "node" and v.owner in shown
        return (v in is_constraint, v not in stores, not is_shown, j)

    ranks = {j: rank for rank, j in enumerate(sorted(range(len(rows.unknowns)), key=readiness))}
    return [(weight(v), ranks[j]) for j, v in enumerate(rows.unknowns)]


@dataclass(frozen=True, eq=False)
class _Realisation:
    model: Model
    ring: Ring
    constants: tuple[ConstantFunction, ...]
    radicals: Radicals
    rows: _Rows
    solved: SolvedRows

    def state_space(self, outputs: Sequence[str], inputs: Sequence[str]) -> StateSpace:
        """Return the realisation, proved."""
        keys = self.solved.states
        place = {key: k for k, key in enumerate(keys)}
        a: list[Vector] = []
        driven: list[dict[int, Vector]] = []
        for column, power in keys:
            one = FieldElement.number(self.ring, 1)
            states, flows = self._divided(self.solved.reduced({(column, power + 1): one}), place)
            a.append(states)
            driven.append(flows)
        direct, b = _divided_by(a, driven)
        c: list[Vector] = []
        d: list[Vector] = []
        for name, result in zip(outputs, self.rows.results, strict=True):
            states, flows = self._divided(self.solved.reduced(result), place)
            total = _followed(states, flows, direct)
            if any(row for power, row in total.items() if power):
                sources = sorted({j for power, row in total.items() if power for j in row})
                pairs = ", ".join(f"{name}/{inputs[j]}" for j in sources)
                message = f"{pairs} has more zeros than poles: no state equations have its output"
                hint = "leave it out, or take an output with fewer derivatives"
                raise ModelError(Diagnostic("SF236", message, None, hint))
            c.append(states)
            d.append(total.get(0, {}))
        self._prove(a, b, direct, place)
        shown = {o.name: o.unit for o in self.model.outputs}
        given = {i.name: i.unit or str(i.dimension or "") for i in self.model.inputs}
        return StateSpace(
            self.model,
            self.ring,
            self.constants,
            self.radicals,
            self._states(keys, direct),
            tuple(Channel(name, given[name]) for name in inputs),
            tuple(Channel(name, shown[name]) for name in outputs),
            tuple(a),
            tuple(b),
            tuple(c),
            tuple(d),
        )

    def _divided(self, row: Row, place: Mapping[tuple[int, int], int]) -> tuple[Vector, dict[int, Vector]]:
        """Return the part of a reduced row in states, and per power of s that in inputs."""
        count = len(self.rows.unknowns)
        flows: dict[int, Vector] = {}
        states: Vector = {}
        for (column, power), value in row.items():
            if column < count:
                states[place[column, power]] = value
            else:
                flows.setdefault(power, {})[column - count] = value
        return states, flows

    def _prove(
        self,
        a: Sequence[Vector],
        b: Sequence[Vector],
        direct: Sequence[Mapping[int, Vector]],
        place: Mapping[tuple[int, int], int],
    ) -> None:
        """Substitute states and inputs for the unknowns in every equation of the model, which must vanish.

        Because the equations have one solution, the transfer functions are the model's then.
        """
        one = FieldElement.number(self.ring, 1)
        count = len(self.rows.unknowns)
        realised: dict[int, list[tuple[Vector, dict[int, Vector]]]] = {}
        for row in self.rows.rows:
            states: Vector = {}
            flows: dict[int, Vector] = {}
            for (column, power), value in row.items():
                if column >= count:
                    flows[power] = combined(flows.get(power, {}), {column - count: one}, value)
                    continue
                if column not in realised:
                    own, given = self._divided(self.solved.reduced({(column, 0): one}), place)
                    realised[column] = [(own, _followed(own, given, direct))]
                while len(realised[column]) <= power:
                    own, given = realised[column][-1]
                    raised = {i + 1: part for i, part in given.items()}
                    raised[0] = applied(own, b)
                    realised[column].append((applied(own, a), raised))
                own, given = realised[column][power]
                states = combined(states, own, value)
                for i, part in given.items():
                    flows[i] = combined(flows.get(i, {}), part, value)
            if states or any(flows.values()):
                raise AssertionError("the state equations do not satisfy the model's")

    def _states(
        self, keys: Sequence[tuple[int, int]], direct: Sequence[Mapping[int, Vector]]
    ) -> tuple[State, ...]:
        one = FieldElement.number(self.ring, 1)
        states: list[State] = []
        taken: set[str] = set()
        for (column, order), parts in zip(keys, direct, strict=True):
            variable = self.rows.unknowns[column]
            terms: Combination = ((derivative(quantity_of(variable), order), one),)
            for i, part in sorted(parts.items()):
                for j, value in sorted(part.items()):
                    terms = (*terms, (derivative(Name(self.rows.inputs[j]), i), -value))
            rate = NAMES_OF_RATES[order] if order < len(NAMES_OF_RATES) else f"_dot{order}"
            label = str(variable).replace(".", "_") + rate + (REST if parts else "")
            while label in taken:
                label += "_"
            taken.add(label)
            states.append(State(label, terms, unit_of_quantity(self.model, variable, order)))
        return tuple(states)


def unit_of_quantity(model: Model, variable: Variable, power: int) -> str:
    """Return the SI unit of a derivative of an unknown, empty when it is not known."""
    domains = {n.name: n.domain for n in model.nodes}
    if variable.kind == "node":
        domain = COMPONENT_DOMAIN.get(variable.component) or domains.get(variable.owner)
        unit = ACROSS_UNIT.get(str(domain), "")
    elif variable.component in THROUGH_UNITS:
        unit = THROUGH_UNITS.get(variable.component, "")
    elif variable in dict(model.signal_units):
        unit = str(dict(model.signal_units)[variable])
    else:
        unit = next((o.unit for o in model.outputs if variable == Variable("value", o.name)), "")
    if not unit or not power:
        return unit
    if unit in RATES and power < len(RATES[unit]):
        return RATES[unit][power]
    return str(unit_of(unit).dimension / unit_of("s").dimension ** power)


def quantity_of(variable: Variable) -> Expression:
    """Return an unknown as models write it."""
    return Attribute(variable.owner, variable.component) if variable.component else Name(variable.owner)


def derivative(quantity: Expression, order: int) -> Expression:
    """Return a derivative of a quantity in time."""
    return product_of([power_of(Name(LAPLACE), order), quantity])


def _divided_by(
    a: Sequence[Vector], driven: Sequence[Mapping[int, Vector]]
) -> tuple[list[dict[int, Vector]], list[Vector]]:
    """Return ``P(s)`` and B of ``q(s) = (s - A) P(s) + B``: ``z - P u`` has the states' equations without s.

    With ``s z = A z + q(s) u`` it is ``s (z - P u) = A (z - P u) + B u``.
    """
    highest = max((power for parts in driven for power in parts), default=0)
    parts: list[dict[int, Vector]] = [{} for _ in a]
    rest = [dict(given.get(highest, {})) for given in driven]
    for power in range(highest - 1, -1, -1):
        for k, row in enumerate(rest):
            if row:
                parts[k][power] = row
        rest = [combined(applied(a[k], rest), driven[k].get(power, {})) for k in range(len(a))]
    return parts, rest


def _followed(
    states: Vector, flows: Mapping[int, Vector], direct: Sequence[Mapping[int, Vector]]
) -> dict[int, Vector]:
    """Return the part in inputs of a sum of states and inputs, when states become those without P u."""
    total = {power: dict(row) for power, row in flows.items()}
    for k, value in states.items():
        for power, row in direct[k].items():
            total[power] = combined(total.get(power, {}), row, value)
    return {power: row for power, row in total.items() if row}


Combination = tuple[tuple["Expression", FieldElement], ...]  # a sum of quantities, with coefficients


@dataclass(frozen=True, slots=True)
class State:
    """One state."""

    name: str  # letters, digits and underscores; ``x_tip_dot`` for the derivative of ``x_tip``
    # What it is: ``s*x_tip``; or a sum of such quantities, inputs among them. ``name.partial`` is the partial
    # state of a filter: what drives it over its denominator.
    terms: Combination
    unit: str  # SI unit, empty when unknown


@dataclass(frozen=True, slots=True)
class Channel:
    """An input or output."""

    name: str
    unit: str


@dataclass(frozen=True, eq=False)
class StateSpace:
    """``s w = A w + B u``, ``y = C w + D u``, exact in parameters, pi and functions of constants."""

    model: Model  # where it comes from; its parameters may have been replaced by numbers
    ring: Ring  # what numerators and denominators of the entries are polynomials of
    constants: tuple[ConstantFunction, ...]  # what the ring's function generators stand for
    radicals: Radicals  # the relations of roots among them
    # states, inputs and outputs: the names of w, u, y.
    states: tuple[State, ...]
    inputs: tuple[Channel, ...]
    outputs: tuple[Channel, ...]
    # a, b, c and d: the rows of the matrices, without entries that are zero.
    a: tuple[Vector, ...]
    b: tuple[Vector, ...]
    c: tuple[Vector, ...]
    d: tuple[Vector, ...]
    is_minimal: bool = False  # almost everywhere every state is controllable and observable

    def __repr__(self) -> str:
        counts = f"{self.order} states, {len(self.inputs)} inputs, {len(self.outputs)} outputs"
        return f"<StateSpace: {counts}>"

    @property
    def order(self) -> int:
        """Number of states."""
        return len(self.states)

    @property
    def matrices(self) -> tuple[tuple[str, tuple[Vector, ...], tuple[int, int]], ...]:
        """Per matrix its letter, its rows, and how many rows and columns it has."""
        n, m, p = len(self.states), len(self.inputs), len(self.outputs)
        return (("A", self.a, (n, n)), ("B", self.b, (n, m)), ("C", self.c, (p, n)), ("D", self.d, (p, m)))
