"""The distributed parts of a model: their equations, the kernels they need, and their transfer matrices.

Input: a model and an evaluator over the ring without kernels.
Output: a :class:`Distributed`, with the ring that has generators for every fundamental function that occurs.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import factorial, pi, prod

from symflex.algebra import Dispersion, Factored, Radicals
from symflex.algebra.dispersion import SingularStart
from symflex.algebra.propagators import WAVENUMBER_NAMES, Propagation, propagate
from symflex.algebra.ring import terms_of
from symflex.budget import spend
from symflex.equations.against_text import at_random, compare, error_of, number_of
from symflex.equations.along import AlongX
from symflex.equations.evaluate import ExactEvaluator
from symflex.equations.singular_ends import CUT, UnsolvedEndError, singular_start
from symflex.errors import BudgetError, Diagnostic, ModelError, Span, SymflexError
from symflex.expressions import (
    Call,
    Derivative,
    Equation,
    Expression,
    Name,
    Negative,
    Number,
    Sum,
    format_expression,
    names,
)
from symflex.library.elements import LinearForm, Variable
from symflex.library.elements.line import LineElement
from symflex.library.fields import (
    FIELDS,
    Component,
    FieldEquation,
    FieldSystem,
    components,
    first_order,
    text,
    varies,
    varying_components,
)
from symflex.library.partial_fractions import Matrix
from symflex.model import ExactValue, FieldProblem, Model, PlacedElement
from symflex.model.along import COORDINATE, varies_along_x
from symflex.model.brackets import named_brackets

POLYNOMIAL = -1  # the dispersion of field equations whose exponents are zero: solutions need no kernel


@dataclass(frozen=True, slots=True, eq=False)
class Medium:
    """A field's equations with the dispersion of every uncoupled part."""

    system: FieldSystem
    parts: tuple[tuple[Component, int], ...]

    along: AlongX | None = None  # where its coefficients vary along x
    origin: Factored | None = None  # the end that is taken for a start, if a stiffness vanishes there
    is_turned: bool = False  # whether that is where x ends
    held: frozenset[str] = frozenset()  # states that are zero there, or follow from others, in what is finite

    def laws(self, propagation: Propagation) -> tuple[tuple[tuple[int, ...], Dispersion], ...]:
        """Return the states that are coupled, and their law, where coefficients vary along x."""
        laws = propagation.table.dispersions
        return () if self.along is None else tuple((p.states, laws[number]) for p, number in self.parts)

    def way(self, position: Factored) -> Factored:
        """Return how far a point of a line element is from where its state is taken for a start."""
        return position - self.origin if self.is_turned and self.origin is not None else position


@dataclass(frozen=True, eq=False)
class FieldSolution:
    """The general solution of one field: its state at any point in terms of its state at the start."""

    field: FieldProblem  # as resolved
    medium: Medium  # its equations
    inputs: tuple[Variable, ...]  # what loads it all along
    origin: Factored  # the start, over the ring without kernels: where x begins, or the end that is singular
    filtered: tuple[tuple[Variable, LinearForm], ...] = ()  # the loads that are filters, and of what

    @property
    def initial(self) -> tuple[Variable | None, ...]:
        """The unknowns: the state at the start, None what a finite one leaves out."""
        medium = self.medium
        return tuple(
            None if name in medium.held else Variable("field", self.field.name, name)
            for name in medium.system.states
        )


def _local(
    medium: Medium, unknown: str, order: int, propagation: Propagation, point: Expression
) -> tuple[list[Factored], list[Factored]]:
    """Return a derivative of a state in terms of the state, and of the inputs, at the same point."""
    states, axes = medium.system.states, medium.system.axes
    zero = medium.system.matrix[0][0] * 0
    turned = {} if axes is None else axes.readings()
    if unknown in turned:
        highest, row = 0, list(turned[unknown])
    else:
        highest = max(k for k in range(order + 1) if unknown + "'" * k in states)
        row = [zero + int(state == unknown + "'" * highest) for state in states]
    matrix, loads, along = medium.system.matrix, medium.system.loads, medium.along
    direct = [zero for _ in loads]
    for _ in range(order - highest):
        slopes = [zero] * len(row) if along is None else [along.slope(x) for x in row]
        # Loads are uniform along x, and so is what they did before; where they are not, that moves as well.
        moved = [zero] * len(direct) if along is None else [along.slope(x) for x in direct]
        direct = [_dot(row, column, x) for column, x in zip(loads, moved, strict=True)]
        row = [_dot(row, [line[j] for line in matrix], slopes[j]) for j in range(len(states))]
    if along is not None:
        try:
            row, direct = ([along.at(x, point) for x in values] for values in (row, direct))
        except ZeroDivisionError:
            at = format_expression(point)
            message = f"{unknown}{chr(39) * order}({at}) is not known: a stiffness vanishes at x = {at}"
            hint = "leave the condition out: symflex uses only solutions that are finite there"
            raise ModelError(Diagnostic("SF250", message, point.span, hint)) from None
    return [propagation.embed(x) for x in row], [propagation.embed(x) for x in direct]


State = tuple[tuple["Variable | None", Factored], ...]  # per state, what it equals, times what; None for zero


@dataclass(frozen=True, eq=False)
class AlongPoint:
    """A quantity at a point of a line element or field."""

    owner: str  # the element's or field's name
    medium: Medium  # its equations
    initial: tuple[Variable | None, ...]  # a field's state at its start
    inputs: tuple[Variable, ...]  # what loads it all along
    length: Factored  # of a line element
    at: Factored  # distance from the start
    unknown: str
    order: int  # of its derivative
    point: Expression  # as it is written

    def value(self, state: State, propagation: Propagation) -> LinearForm:
        """Return the quantity in terms of the state at the point."""
        row, direct = _local(self.medium, self.unknown, self.order, propagation, self.point)
        terms = [(v, c * factor) for (v, factor), c in zip(state, row, strict=True)]
        return LinearForm.of(*terms, *zip(self.inputs, direct, strict=True))


def guess(value: Factored, numbers: Mapping[str, ExactValue | None]) -> float:
    """Return about what a value is, to tell which of two points along x comes first."""
    doubles = {n: float(v.rational) * pi**v.pi_power for n, v in numbers.items() if v is not None} | {
        "pi": pi
    }
    names = value.ring.names
    product = float(value.unit)
    for factor, exponent in value.factors:
        terms = (int(c) * prod(doubles.get(names[i], 1.0) ** e for i, e in m) for m, c in terms_of(factor))
        product *= sum(terms) ** exponent
    return product


def _dot(left: Iterable[Factored], right: Iterable[Factored], zero: Factored) -> Factored:
    return sum((a * b for a, b in zip(left, right, strict=True)), zero)


@dataclass(frozen=True, eq=False)
class Distributed:
    """Everything the equations need of a model's distributed parts."""

    propagation: Propagation  # the rings and generators
    transmissions: Mapping[str, Matrix]  # per line element, the transfer matrix of its length
    delays: Mapping[str, Factored]  # per delay block, ``exp(-s*T)``
    solutions: Mapping[str, FieldSolution]  # per unknown of a field, the solution of its field
    evaluator: ExactEvaluator  # over the ring without kernels, for points
    lines: Mapping[str, tuple[Medium, Factored]]  # per line element, its equations and its length
    along: Mapping[str, str]  # per quantity of a line element along x, the state of its field theory

    @property
    def is_split(self) -> bool:
        """True when what is coupled has several laws somewhere, or equal wavenumbers."""
        media = [*(medium for medium, _ in self.lines.values()), *(s.medium for s in self.solutions.values())]
        return any(part.is_share for medium in media for part, _ in medium.parts)

    @property
    def turned(self) -> frozenset[str]:
        """The line elements whose state follows from that at their second end, a tip."""
        return frozenset(name for name, (medium, _) in self.lines.items() if medium.is_turned)

    def place(self, call: Call) -> AlongPoint:
        """Return the quantity that a call names."""
        owner, dot, _ = call.name.partition(".")
        at = self.evaluator.constant(call.argument)
        if dot:
            medium, length = self.lines[owner]
            unknown = self.along[call.name]
            return AlongPoint(owner, medium, (), (), length, at, unknown, call.order, call.argument)
        solution = self.solutions[call.name]
        at, name = at - solution.origin, solution.field.name
        arguments = solution.medium, solution.initial, solution.inputs
        return AlongPoint(name, *arguments, at, at, call.name, call.order, call.argument)

    def value(self, call: Call, states: Mapping[str, Sequence[Variable | None]]) -> LinearForm:
        """Return an unknown, quantity or derivative at a call's point, given states at first ends."""
        owner, dot, _ = call.name.partition(".")
        at, inputs = self.evaluator.constant(call.argument), tuple[Variable, ...]()
        if dot:
            medium, _ = self.lines[owner]
            initial, name, length = states[owner], self.along[call.name], medium.way(at)
        else:
            solution = self.solutions[call.name]
            medium, initial, inputs = solution.medium, solution.initial, solution.inputs
            name, length = call.name, at - solution.origin
        zero = Factored.number(self.propagation.ring, 0)
        row, direct = _local(medium, name, call.order, self.propagation, call.argument)
        transfer = transfer_matrix(medium, length, self.propagation)
        terms = [(v, _dot(row, [line[j] for line in transfer], zero)) for j, v in enumerate(initial)]
        if inputs and not length.is_zero:
            driven = _driven(medium, length, self.propagation)
            direct = [d + _dot(row, column, zero) for d, column in zip(direct, driven, strict=True)]
        return LinearForm.total(LinearForm.of(x) for x in (*terms, *zip(inputs, direct, strict=True)))


class _Demands:
    """Collects dispersions, each once, with the lengths it is needed at."""

    def __init__(
        self,
        along: AlongX | None,
        settled: Callable[[Factored], Factored] | None,
        root: Callable[[Factored], Factored | None],
        *,
        is_followed: bool,
    ) -> None:
        self.along = along
        self.settled = settled  # of components(), None if wavenumbers get no names
        self.root = root  # one of a square's two, None if it has none
        self.is_followed = is_followed
        self.keys: dict[tuple[str, ...], int] = {}
        self.found: dict[tuple[str, ...], tuple[Component, ...]] = {}
        self.demands: list[tuple[Dispersion, list[Factored]]] = []

    def medium(
        self, name: str, system: FieldSystem, span: Span | None, ends: tuple[Expression, Expression]
    ) -> Medium:
        """Return the system with the numbers of its dispersions; ``ends`` are those of x."""
        followed = self.is_followed and system.axes is None
        if self.along is not None and (followed or varies(system, self.along.names)):
            return self._varying(name, system, span, self.along, ends)
        parts = []
        key = tuple(text(x) for row in system.matrix for x in row)
        try:
            # Members of one material and section have equal equations, mostly.
            components_of = self.found.get(key) or components(system, self.settled)
        except BudgetError as error:
            raise BudgetError(*(replace(d, span=span) for d in error.diagnostics)) from None
        self.found[key] = components_of
        for part in components_of:
            law = part.characteristic
            if law.kind == "polynomial":
                parts.append((part, POLYNOMIAL))
                continue
            dispersion = Dispersion(name, law.kind, law.coefficients, law.shift, meets=part.meets)  # type: ignore[arg-type]
            key = (law.kind, *law.key, *map(text, part.meets))
            number, scale = self._multiple(key, dispersion) or (self._number(key, dispersion), None)
            parts.append((replace(part, scale=scale), number))
        return Medium(system, tuple(parts))

    def _varying(
        self,
        name: str,
        system: FieldSystem,
        span: Span | None,
        along: AlongX,
        ends: tuple[Expression, Expression],
    ) -> Medium:
        if system.axes is not None:
            message = f"a frame member that varies along x ('{name}') is not available yet"
            hint = "cut it into uniform pieces, or model its bending as a beam"
            raise ModelError(Diagnostic("SF910", message, span, hint))
        components = varying_components(system)
        singular_parts = [[_singular(part, along, end, name, span) for part in components] for end in ends]
        singular = [any(singular_part) for singular_part in singular_parts]
        if all(singular):
            message = f"stiffnesses vanish at both ends of '{name}'"
            hint = "cut it in two between them, so that each part has one such end"
            raise ModelError(Diagnostic("SF910", message, span, hint))
        singular_part, origin = singular_parts[singular[1]], along.evaluator.constant(ends[singular[1]])
        parts, held = [], set[str]()
        for part, start in zip(components, singular_part, strict=True):
            law = Dispersion(name, "varying", (), origin * 0, (), part.matrix, (origin,), start, span)
            key = ("varying", text(origin), *(text(x) for row in part.matrix for x in row))
            parts.append((part, self._number(key, law)))
            free = range(len(part.matrix)) if start is None else start.free
            held |= {system.states[i] for j, i in enumerate(part.states) if j not in free}
            if not set(free) >= set(range(len(part.states), len(part.matrix))):
                message = (
                    f"a load on '{name}' does not vanish where its stiffness does and would move it "
                    "without bound"
                )
                raise ModelError(Diagnostic("SF910", message, span, "put the load into the conditions"))
        return Medium(system, tuple(parts), along, origin, singular[1], frozenset(held))

    def delay(self, name: str, s: Factored, time: Factored) -> int:
        """Return the number of the dispersion that all delays share, or decays of one power of a root."""
        number = self._number(("delay", text(s)), Dispersion(name, "exponential", (), s))
        self.demands[number][1].append(time)
        return number

    def need(self, medium: Medium, length: Factored) -> None:
        """Note a length a medium is needed at."""
        for part, number in medium.parts:
            if number != POLYNOMIAL:
                self.demands[number][1].append(part.scaled(length))

    def _multiple(self, key: tuple[str, ...], law: Dispersion) -> tuple[int, Factored] | None:
        """Return the number of a law, and the factor by which the wavenumbers of another exceed its own."""
        n = law.order
        if key in self.keys or self.settled is None or law.kind not in WAVENUMBER_NAMES:
            return None
        c = [self.settled(x) for x in law.characteristic]
        for number, (known, _) in enumerate(self.demands):
            if known.kind != law.kind or any(not x.is_zero for x in (law.shift, known.shift)):
                continue
            of = [self.settled(x) for x in known.characteristic]
            if law.meets or known.meets or of[0].is_zero or (ratio := c[0] / of[0]).depends_on("s"):
                continue
            root = self.root(ratio)
            scale = root if root is None or law.kind == "wave" else self.root(root)
            if scale is not None and all(
                (a - b * scale ** (n - k)).is_zero for k, (a, b) in enumerate(zip(c, of, strict=True))
            ):
                return number, scale
        return None

    def _number(self, key: tuple[str, ...], dispersion: Dispersion) -> int:
        if key not in self.keys:
            self.keys[key] = len(self.demands)
            self.demands.append((dispersion, []))
        return self.keys[key]


def survey(
    model: Model,
    evaluator: ExactEvaluator,
    expressions: Iterable[Expression],
    *,
    is_nameless: bool = False,
    is_cut: bool = False,
    is_followed: bool = False,
    functions: tuple[tuple[str, Call], ...] | None = None,
) -> Distributed | None:
    """Return the distributed parts of a model, ``None`` when it has none; flags are those of ``assemble``.

    The evaluator is over the ring without kernels; ``functions`` are those of x, if any. SF305.
    """
    moving = None if functions is None else AlongX(evaluator.along_x(), functions)
    is_nameless = is_nameless or is_cut
    settled = None if is_nameless or evaluator.ring.is_sparse else evaluator.settled
    radicals = evaluator.radicals or Radicals(evaluator.ring)
    demands = _Demands(moving, settled, radicals.either_root, is_followed=is_followed)
    lines: list[tuple[str, Medium, Factored]] = []
    delays: list[tuple[str, int, Factored]] = []
    solutions: dict[str, FieldSolution] = {}
    along: dict[str, str] = {}
    s = evaluator.s
    try:
        for use in model.elements:
            if isinstance(use.element, LineElement):
                medium, length = _line(use, evaluator, demands, s)
                if medium.held:
                    _check_tip(model, use, is_second=medium.is_turned)
                lines.append((use.name, medium, length))
                axes = medium.system.axes
                read = (*medium.system.states, *(() if axes is None else axes.readings()))
                for state, quantity in zip(read, use.element.along, strict=True):
                    along.update((f"{use.name}.{name}", state) for name in quantity)
        for _, medium, length in () if is_cut else lines:
            demands.need(medium, -length if medium.is_turned else length)
        for block in model.blocks:
            if block.block is not None and block.block.kernel_time:
                time = evaluator.constant(dict(block.values)[block.block.kernel_time])
                times = dict(block.values).get("m")  # of the exponential of a root, the power of that
                rate = s
                if isinstance(times, Number):
                    rate = Factored.generator(evaluator.ring, "s") ** int(times.value)
                delays.append((block.name, demands.delay(block.name, rate, time), time))
        for field in model.fields:
            solution = _solution(field, evaluator, demands)
            solutions.update(dict.fromkeys(field.unknowns, solution))
        for call in (c for e in expressions for c in names(e) if isinstance(c, Call) and not is_cut):
            if call.name in solutions:
                solution = solutions[call.name]
                demands.need(solution.medium, evaluator.constant(call.argument) - solution.origin)
            elif call.name in along:
                owner = call.name.partition(".")[0]
                medium = next(medium for name, medium, _ in lines if name == owner)
                demands.need(medium, medium.way(evaluator.constant(call.argument)))
    except SymflexError as error:
        spend()
        raise error_of([*error.diagnostics]) from None
    if not (lines or delays or solutions):
        return None
    wanted: Sequence[tuple[Dispersion, Sequence[Factored]]] = demands.demands
    if is_nameless:  # the kernels are fundamental functions
        kept = ("exponential", "varying")
        wanted = [(d if d.kind in kept else replace(d, kind="general"), lengths) for d, lengths in wanted]
    propagation = propagate(evaluator.ring, wanted)
    one = Factored.number(propagation.ring, 1)
    return Distributed(
        propagation,
        {
            name: transfer_matrix(medium, -length if medium.is_turned else length, propagation)
            for name, medium, length in lines
            if not is_cut
        },
        {
            name: one if time.is_zero else propagation.fundamental(number, time)[0]
            for name, number, time in delays
        },
        solutions,
        evaluator,
        {name: (medium, length) for name, medium, length in lines},
        along,
    )


def _line(
    use: PlacedElement, evaluator: ExactEvaluator, demands: _Demands, s: Factored
) -> tuple[Medium, Factored]:
    element = use.element
    if not isinstance(element, LineElement):
        raise TypeError(f"'{use.name}' is not a line element")
    evaluator = evaluator.along_x()
    values = {name: evaluator.constant(e) for name, e in use.all_values}
    zero = s * 0
    for parameter in element.parameters:
        if not parameter.of:
            values.setdefault(parameter.name, zero)
    chosen = {c.name: c.default for c in element.choices} | dict(use.choices)
    try:
        system = FIELDS[element.theory(chosen)](s, values)
    except ZeroDivisionError:
        message = f"a stiffness of {element.type_name} '{use.name}' is zero"
        raise ModelError(Diagnostic("SF224", message, use.span)) from None
    ends = Number(Fraction(0)), dict(use.all_values)[element.length]
    return demands.medium(use.name, system, use.span, ends), values[element.length]


def _check_tip(model: Model, use: PlacedElement, *, is_second: bool) -> None:
    """Refuse what acts on the end of an element at which a stiffness vanishes."""
    tip = dict(use.nodes)["between"][is_second]
    touching = [r for other in model.elements for _, references in other.nodes for r in references]
    touching += [r for given in model.inputs for r in given.nodes]
    if tip.is_ground or sum(r.node == tip.node for r in touching) > 1:
        message = f"a stiffness of {use.element.type_name} '{use.name}' vanishes at its end '{tip.node}', "
        message += "which can be neither held nor loaded: it would move without bound"
        hint = "make the section small there but not zero, or leave the end free"
        raise ModelError(Diagnostic("SF250", message, use.span, hint))


def _solution(field: FieldProblem, evaluator: ExactEvaluator, demands: _Demands) -> FieldSolution:
    given, unknowns = field.equations, field.unknowns
    written = field.written[: len(given)]
    if written not in ((), given) and any(map(varies_along_x, given)):
        given, unknowns = named_brackets(written, unknowns)
    inside = replace(evaluator, scope=evaluator.scope.within(unknowns))
    equations: list[FieldEquation] = []
    filtered: dict[Variable, LinearForm] = {}
    for equation in (read_equation(e, unknowns, inside) for e in given):
        loads: dict[Hashable, Factored] = {}
        for source, value in equation.loads.items():
            if isinstance(source, Variable) and not inside.in_s(value.denominator()).is_one:
                load = Variable("value", field.name, f"load_{len(filtered) + 1}")
                filtered[load], loads[load] = LinearForm.of((source, value)), inside.one
            else:
                loads[source] = value
        equations.append(replace(equation, loads=loads))
    inputs = tuple(dict.fromkeys(v for e in equations for v in e.loads if isinstance(v, Variable)))
    zero = Factored.number(evaluator.ring, 0)
    system = first_order(unknowns, inputs, equations, zero)
    if system is None:
        raise ModelError(
            Diagnostic(
                "SF305",
                f"the equations of field '{field.name}' do not determine the highest derivatives of "
                + " and ".join(field.unknowns),
                field.span,
                "eliminate an unknown by hand, or differentiate an equation",
            )
        )
    if static := [u for u in field.unknowns if u not in system.states]:
        message = f"the equations of field '{field.name}' contain no derivative of " + " and ".join(static)
        hint = "substitute what it equals in the other equations and conditions"
        raise ModelError(Diagnostic("SF305", message, field.span, hint))
    span, ends = field.equations[0].span or field.span, (field.start, field.end)
    medium = demands.medium(field.name, system, span, ends)
    for part, number in medium.parts:
        # A polynomial share of a law that splits is refused as the whole law would be.
        is_refused = part.coefficients and (number != POLYNOMIAL or part.is_share)
        if is_refused and part.coefficients[0].is_zero and _is_loaded(part, system):
            message = (
                f"field '{field.name}' has a solution that is constant in x, so a uniform load on it "
                "is not available"
            )
            raise ModelError(Diagnostic("SF910", message, field.span, "put the load into the conditions"))
    origin = medium.origin or evaluator.constant(field.start)
    return FieldSolution(field, medium, inputs, origin, tuple(filtered.items()))


def _singular(
    part: Component, along: AlongX, end: Expression, name: str, span: Span | None
) -> SingularStart | None:
    """Return the solutions of a part that are finite at an end, None if all are."""
    way = Factored.generator(part.matrix[0][0].ring, COORDINATE) - along.evaluator.constant(end)
    try:
        return singular_start(part.matrix, way, COORDINATE, lambda value: along.at(value, end))
    except UnsolvedEndError as error:
        why, hint = str(error), error.hint
    except ZeroDivisionError:
        why, hint = "a function of x also vanishes there, and solutions are not power series", CUT
    message = f"a stiffness of '{name}' vanishes at x = {format_expression(end)}: {why}"
    raise ModelError(Diagnostic("SF250", message, span, hint))


def _is_loaded(part: Component, system: FieldSystem) -> bool:
    return not all(load[i].is_zero for load in system.loads for i in part.states)


def _fundamental(
    part: Component, number: int, length: Factored, propagation: Propagation
) -> tuple[Factored, ...]:
    """Return ``h, ..., h^(n-1)`` of a part at a length."""
    n = len(part.coefficients)
    if number != POLYNOMIAL:
        functions = propagation.fundamental(number, part.scaled(length), part.multiplicity)
        if part.scale is None:
            return functions
        scale = propagation.embed(part.scale)
        return tuple(h * scale ** (k + 1 - n) for k, h in enumerate(functions))
    x = propagation.embed(length)
    return tuple(_monomial(x, n - 1 - k) for k in range(n))


def _monomial(x: Factored, power: int) -> Factored:
    return x**power * Fraction(1, factorial(power))


def transfer_matrix(medium: Medium, length: Factored, propagation: Propagation) -> Matrix:
    """Return ``exp(A length)`` over the ring of propagators."""
    zero = Factored.number(propagation.ring, 0)
    size = len(medium.system.states)
    entries = [[zero] * size for _ in range(size)]
    for part, number in medium.parts:
        h = _fundamental(part, number, length, propagation)
        for i, row in enumerate(part.states):
            for j, column in enumerate(part.states):
                if part.matrix:
                    entries[row][column] = h[i * len(part.matrix) + j]
                for k, b in enumerate(part.adjugate):
                    if not b[i][j].is_zero:
                        entries[row][column] += h[k] * propagation.embed(b[i][j])
    return tuple(map(tuple, entries))


def _driven(medium: Medium, length: Factored, propagation: Propagation) -> list[list[Factored]]:
    """Return, per load, the state at a distance from the start that a unit of it causes from rest."""
    zero = Factored.number(propagation.ring, 0)
    one = zero + 1
    columns = [[zero] * len(medium.system.states) for _ in medium.system.loads]
    for part, number in medium.parts:
        n = len(part.states) if part.matrix else len(part.coefficients)
        if not _is_loaded(part, medium.system):
            continue
        h = _fundamental(part, number, length, propagation)
        if part.matrix:
            for k, column in enumerate(columns):
                for i, row in enumerate(part.states):
                    column[row] = h[i * len(part.matrix) + n + k]
            continue
        if number == POLYNOMIAL:
            integral = _monomial(propagation.embed(length), n)
        else:
            remainder = one - h[n - 1]
            for k in range(1, n):
                remainder = remainder - propagation.embed(part.coefficients[k]) * h[k - 1]
            integral = remainder / propagation.embed(part.coefficients[0])
        integrals = (integral, *h[: n - 1])
        for load, column in zip(medium.system.loads, columns, strict=True):
            b = [propagation.embed(load[i]) for i in part.states]
            for i, row in enumerate(part.states):
                for k, matrix in enumerate(part.adjugate):
                    weight = _dot([propagation.embed(x) for x in matrix[i]], b, zero)
                    column[row] = column[row] + integrals[k] * weight
    return columns


def read_equation(equation: Equation, unknowns: Collection[str], evaluator: ExactEvaluator) -> FieldEquation:
    """Return coefficients of an equation linear in unknowns, derivatives and loads, in a field's scope."""

    def leaf(node: Expression) -> int:
        match node:
            case Name(name) if name in unknowns:
                return at_random(Variable("field", name), evaluator.prime)
            case Derivative(name, order):
                return at_random(Variable("field", name, "'" * order), evaluator.prime)
        return evaluator.number_of_leaf(node)

    one = evaluator.s**0
    sides = [
        evaluator.linear(term) * (one * sign)
        for side, sign in ((equation.left, 1), (equation.right, -1))
        for term in (side.terms if isinstance(side, Sum) else (side,))
    ]
    terms = LinearForm.total(sides).terms
    if evaluator.is_decided:
        difference = Sum((equation.left, Negative(equation.right)), span=equation.span)
        compare(difference, number_of(terms, evaluator.place), leaf, evaluator.prime)
    return FieldEquation(
        {(v.owner, len(v.component)): c for v, c in terms if v.kind == "field"},
        {v: c for v, c in terms if v.kind != "field"},
    )
