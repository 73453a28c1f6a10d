"""Where an input acts and what an output measures, as coordinates of nodes; and which of them are one place.

Input: a model, and its equations. Output: coordinates with signs; two of them are a relative motion, and a
force between two nodes. And the same model in which every place is written in one way: ends of elements as
their nodes, and values that a condition such as ``w_2(l/2) = w_1(l/2)`` makes equal alike. So of a beam of
two fields, with the force a jump of the shear in a condition of ``w_2``, the output ``w_1(l/2)`` is
``w_2(l/2)``, on which the force does work.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

from symflex.algebra import Factored
from symflex.equations import Equations
from symflex.expressions import (
    Attribute,
    Call,
    Equation,
    Expression,
    Name,
    Negative,
    Number,
    Product,
    Sum,
    is_number,
    names,
    replace_values,
)
from symflex.library.elements import COMPONENTS, Domain, LinearForm, LineElement, Variable
from symflex.library.elements.lumped import CurrentSource, ForceSource, TorqueSource, VoltageSource
from symflex.model import Input, Model, PlacedElement
from symflex.model.model import INPUT_KINDS, NetworkNode, NodeReference
from symflex.model.network import variable_of
from symflex.model.signs import Line

Coordinates = tuple[tuple[Variable, int], ...]  # one, or two with opposite signs; the first counts once

PAIR = 2


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredCoordinate:
    """An output that is ``factor`` times one coordinate, or times the difference of two."""

    coordinates: Coordinates  # what it measures
    factor: Factored  # over the equations' ring, ``s`` for a velocity


def acting(model: Model, source: Input) -> Coordinates:
    """Return where a force, torque or current acts, or the only signal that drives it; else nothing."""
    kind = INPUT_KINDS.get(source.kind)
    if kind is not None and not kind.is_imposed:
        return _at(model, source.nodes, kind.domain)
    element = driven_source(model, source)
    if element is None or isinstance(element.element, VoltageSource):
        return ()
    ((port, references),) = element.nodes
    match dict(element.domains)[port]:
        case "planar" | "plane":
            return ()
        case domain:
            return _at(model, references, domain)


def driven_source(model: Model, source: Input) -> PlacedElement | None:
    """Return the source element that a free signal drives, and that alone; ``None`` without such."""
    if source.kind != "signal":
        return None
    constants = {p.name for p in model.parameters} | {d.name for d in model.definitions} | {"pi"}
    users = [
        use
        for use, e in expressions_of(model)
        if any(getattr(n, "name", "") == source.name for n in names(e))
    ]
    use = users[0] if len(users) == 1 else None
    if use is None or not isinstance(use.element, ForceSource | TorqueSource | CurrentSource | VoltageSource):
        return None
    named = {str(getattr(n, "name", "")) for _, e in use.values for n in names(e)}
    return use if named <= constants | {source.name} else None


def expressions_of(
    model: Model, *, with_outputs: bool = True
) -> Iterator[tuple[PlacedElement | None, Expression]]:
    """Yield all expressions but definitions."""
    yield from ((use, e) for use in model.elements for _, e in use.values)
    yield from ((None, signal.expression) for signal in model.signals)
    yield from ((None, output.expression) for output in model.outputs if with_outputs)
    for field in model.fields:
        yield from ((None, e) for e in (*field.equations, *field.conditions))


def holds(expression: Expression, name: str) -> bool:
    """Tell whether a name stands in an expression."""
    return any(isinstance(n, Name) and n.name == name for n in names(expression))


def _at(model: Model, references: tuple[NodeReference, ...], domain: Domain) -> Coordinates:
    nodes = {n.name: n for n in model.nodes}
    signed = [
        (variable_of(r, nodes[r.node], domain), sign)
        for r, sign in zip(references, (1, -1), strict=False)
        if not r.is_ground
    ]
    signed.sort(key=lambda coordinate: str(coordinate[0]))
    return tuple((v, sign * signed[0][1]) for v, sign in signed)


def measured(equations: Equations, output: str) -> MeasuredCoordinate | None:
    """Return what an output measures, ``None`` if neither a coordinate nor the difference of two."""
    row = next(o for o in equations.outputs if o.name == output)
    terms = _in_nodes(equations, row.form)
    if terms is None or not 0 < len(terms) <= PAIR or any(v.kind != "node" for v in terms):
        return None
    (lead, factor), *others = sorted(terms.items(), key=lambda term: str(term[0]))
    if any(not (coefficient + factor).is_zero for _, coefficient in others):
        return None
    return MeasuredCoordinate(((lead, 1), *((v, -1) for v, _ in others)), factor)


def _in_nodes(equations: Equations, form: LinearForm) -> Mapping[Variable, Factored] | None:
    """Return a form with its signals replaced by what they equal, ``None`` where they form a loop."""
    laws = {row.about: row.form for row in equations.rows if row.role == "signal"}
    terms = collected(form)
    for _ in range(len(laws) + 1):
        dependent = next((v for v in terms if v in laws), None)
        if dependent is None:
            return terms
        coefficient = terms.pop(dependent)
        law = collected(laws[dependent])
        pivot = law.pop(dependent, None)
        if pivot is None:
            return None
        for variable, value in law.items():
            change = -coefficient * value / pivot
            terms[variable] = terms[variable] + change if variable in terms else change
        terms = {v: c for v, c in terms.items() if not c.is_zero}
    return None


def collected(form: LinearForm) -> dict[Variable, Factored]:
    """Return the coefficient of every variable in a form, those that are zero left out."""
    total: dict[Variable, Factored] = {}
    for variable, coefficient in form.terms:
        total[variable] = total[variable] + coefficient if variable in total else coefficient
    return {v: c for v, c in total.items() if not c.is_zero}


def in_one_way(model: Model) -> Model:
    """Return a model whose places are written in one way: ends of elements as nodes, equal points alike.

    Points are equal by the parameters' values where they have some.

    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... parameters.l = "2 m"
    ... elements.bar = { type = "rod", between = ["ground", "x"], E = 1, A = 1, rho = 1, l = "l" }
    ... inputs.F = { force = "x" }
    ... outputs.U = "s*bar.u(l/2 + 1 m)"
    ... ''')
    >>> from symflex.expressions import format_expression
    >>> format_expression(in_one_way(model).outputs[0].expression)
    's*x'
    """
    line = Line.of_numbers(model.definitions, ((p.name, p.value) for p in model.parameters))
    ends = {
        (f"{use.name}.{name}", line.key(position)): shown
        for use in model.elements
        if isinstance(use.element, LineElement)
        for name, position, shown in _ends(model, use, use.element)
    }
    spelled: dict[Hashable, Expression] = {}
    unknowns = {u for field in model.fields for u in field.unknowns}

    def written(expression: Expression) -> Expression:
        changed: dict[Expression, Expression] = {}
        for call in (n for n in names(expression) if isinstance(n, Call)):
            position = line.key(call.argument) if call.name in unknowns or "." in call.name else None
            if call.name in unknowns:
                changed[call] = replace(call, argument=spelled.setdefault(position, call.argument))
            elif not call.order and (call.name, position) in ends:
                changed[call] = ends[call.name, position]
        return replace_values(expression, changed)

    for field in model.fields:
        for end in (field.start, field.end):
            spelled.setdefault(line.key(end), end)
    fields = [
        replace(
            f,
            conditions=tuple(replace(c, left=written(c.left), right=written(c.right)) for c in f.conditions),
        )
        for f in model.fields
    ]
    signals = [replace(each, expression=written(each.expression)) for each in model.signals]
    outputs = [replace(each, expression=written(each.expression)) for each in model.outputs]
    return replace(model, fields=tuple(fields), signals=tuple(signals), outputs=tuple(outputs))


def _ends(
    model: Model, use: PlacedElement, element: LineElement
) -> Iterator[tuple[str, Expression, Expression]]:
    """Yield what the motion of an element's ends is called, the place, and the node that moves so."""
    (_, references), *_ = use.nodes
    nodes = {node.name: node for node in model.nodes}
    read_otherwise = {each.name for each in model.signals} | {each.name for each in model.inputs}
    domain = element.ports[0].domain
    for reference, position in zip(
        references, (Number(Fraction(0)), dict(use.values)[element.length]), strict=True
    ):
        if reference.is_ground or reference.node in read_otherwise:
            continue
        for component, called in zip(element.ends, element.along, strict=False):
            picked = replace(reference, component=component) if domain in COMPONENTS else reference
            moved = variable_of(picked, nodes[reference.node], domain)
            shown = Attribute(moved.owner, moved.component) if moved.component else Name(moved.owner)
            for name in called:
                yield name, position, shown


def parted_at(model: Model, output: str) -> Model:
    """Return a model whose element is two where an output shows its motion, which is that of a node then.

    Nothing is changed where the output shows no point, or more than one, or elements lie in the plane.

    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... elements.bar = { type = "rod", between = ["ground", "x"], E = 1, A = 1, rho = 1, l = 2 }
    ... inputs.F = { force = "x" }
    ... outputs.V = "s*bar.u(0.5 m)"
    ... ''')
    >>> from symflex.expressions import format_expression
    >>> parted = parted_at(model, "V")
    >>> format_expression(parted.outputs[0].expression)
    's*point of bar'
    >>> [[reference.node for reference in dict(use.nodes)["between"]] for use in parted.elements]
    [['ground', 'point of bar'], ['point of bar', 'x']]
    """
    (wanted,) = (o for o in model.outputs if o.name == output)
    calls = {n for n in names(wanted.expression) if isinstance(n, Call)}
    if len(calls) != 1:
        return model
    (call,) = calls
    owner, _, quantity = call.name.partition(".")
    use = next((u for u in model.elements if u.name == owner), None)
    if use is None or not isinstance(use.element, LineElement) or call.order:
        return model
    element = use.element
    ((port, (first, second)),) = use.nodes
    domain = dict(use.domains)[port]
    components = zip(element.ends, element.along, strict=False)
    component = next((c for c, called in components if quantity in called), None)
    if component is None or domain == "plane":
        return model
    point = f"point of {owner}"  # no name contains blanks
    node = NetworkNode(point, domain)
    remaining = Sum((dict(use.values)[element.length], Negative(call.argument)))

    def piece(name: str, ends: tuple[NodeReference, ...], long: Expression) -> PlacedElement:
        values = tuple((n, long if n == element.length else v) for n, v in use.values)
        return replace(use, name=name, nodes=((port, ends),), values=values)

    between = NodeReference(point)
    pieces = (
        piece(owner, (first, between), call.argument),
        piece(f"{owner} beyond", (between, second), remaining),
    )
    elements = tuple(p for u in model.elements for p in (pieces if u is use else (u,)))
    shown: Expression = Attribute(point, component) if domain in COMPONENTS else Name(point)
    changed = replace(wanted, expression=replace_values(wanted.expression, {call: shown}))
    return replace(
        model, nodes=(*model.nodes, node), elements=elements, outputs=(changed,), figures=(), published=()
    )


def joined_values(model: Model) -> list[list[Expression]]:
    """Return the groups of values that conditions make equal.

    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... inputs.F = {}
    ... outputs.U = "u(1)"
    ... fields.u = { domain = [0, 1], equation = "u'' = u", conditions = ["u(0) = 0", "u(1) = v(1)"] }
    ... fields.v = { domain = [1, 2], equation = "v'' = v", conditions = ["v'(1) = u'(1) + F", "v(2) = 0"] }
    ... ''')
    >>> from symflex.expressions import format_expression
    >>> [[format_expression(value) for value in group] for group in joined_values(model)]
    [['u(1)', 'v(1)']]
    """
    groups: list[list[Expression]] = []
    for field in model.fields:
        for condition in field.conditions:
            equal = _equal(model, condition)
            if equal is None:
                continue
            met = [g for g in groups if any(value in g for value in equal)]
            joined = [value for group in met for value in group]
            joined += [value for value in equal if value not in joined]
            groups = [*(g for g in groups if g not in met), joined]
    return groups


def seen_at_the_input(model: Model, output: str, source: Input) -> Model:
    """Return the model with an output written in the field's value or node on which an input acts."""
    (wanted,) = (o for o in model.outputs if o.name == output)
    unknowns = {u for f in model.fields for u in f.unknowns}
    shown = {n for n in names(wanted.expression) if isinstance(n, Call) and n.name in unknowns}
    group = next((g for g in joined_values(model) if all(v in g for v in shown)), []) if shown else []
    loaded = {
        unknown
        for field in model.fields
        if any(holds(condition, source.name) for condition in field.conditions)
        for unknown in field.unknowns
    }
    chosen = next((v for v in group if (v.name in loaded if isinstance(v, Call) else not loaded)), None)
    if chosen is None:
        return model
    changed = replace(wanted, expression=replace_values(wanted.expression, dict.fromkeys(shown, chosen)))
    return replace(model, outputs=tuple(changed if o is wanted else o for o in model.outputs))


def _equal(model: Model, condition: Equation) -> tuple[Expression, Expression] | None:
    """Return the two values that a condition says are equal, ``None`` when it says anything else."""
    left, right = condition.left, condition.right
    if is_number(left, 0):
        left, right = right, left
    if is_number(right, 0) and isinstance(left, Sum) and len(left.terms) == PAIR:
        plus = [term for term in left.terms if not isinstance(term, Negative)]
        minus = [term.operand for term in left.terms if isinstance(term, Negative)]
        if len(plus) != 1:
            return None
        left, right = plus[0], minus[0]
    if isinstance(left, Product) and isinstance(right, Product) and left.factors[:-1] == right.factors[:-1]:
        left, right = left.factors[-1], right.factors[-1]
    return (left, right) if _is_value(model, left) and _is_value(model, right) else None


def _is_value(model: Model, side: Expression) -> bool:
    match side:
        case Call(name=name):
            return any(name in field.unknowns for field in model.fields)
        case Name(name=name) | Attribute(owner=name):
            return any(node.name == name for node in model.nodes)
    return False
