"""Lagrange's equations of ``[energy]``: equations of motion from the energies of a mechanism.

Input: the section. Output: a :class:`~symflex.model.model.Signal` for every coordinate q and every
multiplier, whose expression is a nonlinear equation, made linear by :mod:`symflex.model.operating_point`.

    coordinates = ["x", "theta"]
    kinetic     = "M*x'^2/2 + m*((x + l*sin(theta))')^2/2 + m*((l*cos(theta))')^2/2"
    potential   = "m*g*l*cos(theta)"
    dissipation = "b*x'^2/2"                 # Rayleigh's: half of the power that is lost
    forces      = { x = "F" }                # generalised forces
    constraints = ["x^2 + y^2 = l^2"]        # holonomic; each brings a multiplier, lambda_1

    (dT/dq')' - dT/dq + dV/dq + dD/dq' = Q + sum of lambda_k dc_k/dq

A coordinate that elements or inputs are attached to is a node: its equation acts there as a source does.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

from symflex.algebra import LAPLACE
from symflex.errors import Diagnostic, Span, SpecError, Text
from symflex.expressions import (
    Derivative,
    Equation,
    Expression,
    Name,
    format_expression,
    negative,
    number,
    parse,
    product_of,
    sum_of,
)
from symflex.expressions import nodes as walk
from symflex.expressions.derivative import derivative, rate, without_brackets
from symflex.library.elements import ELEMENTS
from symflex.model.constants_at_rest import Constants
from symflex.model.declarations import in_order
from symflex.model.fields import name_problem, parsed
from symflex.model.model import NodeReference, OperatingPoint, Signal
from symflex.model.network import AsWritten, Draft, DraftElement
from symflex.model.operating_point import (
    NOWHERE,
    SMOOTH,
    AtRest,
    in_s,
    linearised,
    note_divisions,
    read_operating_point,
)
from symflex.model.reading import Reader
from symflex.model.settings import Setting, settled
from symflex.model.spec import KeyValue, TableValue

KEYS = ("coordinates", "kinetic", "potential", "dissipation", "forces", "constraints", "doc")
EXAMPLE = 'for instance coordinates = ["x"], kinetic = "m*x\'^2/2", potential = "k*x^2/2"'
SOURCES = {"translation": ("force_source", "f"), "rotation": ("torque_source", "tau")}


def read_energy(
    reader: Reader, section: TableValue | None, constants: Constants, cycles: AsWritten
) -> tuple[Signal, ...]:
    """Return an equation for every coordinate and every constraint."""
    if section is None:
        return ()
    what, taken = "[energy]", constants.expressions
    reader.keys(section, KEYS, what, EXAMPLE)
    given = section.get("coordinates")
    if given is None:
        reader.note("SF214", f"{what} has no coordinates", section.span, EXAMPLE)
        return ()
    coordinates = reader.strings(given, f"coordinates of {what}", "an array of names") or ()
    for text in coordinates:
        problem = name_problem(text.value, taken, {})
        if problem is not None:
            reader.note(problem[0], problem[1], text.span, problem[2])
    constraints = section.get("constraints")
    texts = reader.strings(constraints, f"constraints of {what}") if constraints else ()
    equations = [
        replace(e, left=cycles.read(e.left), right=cycles.read(e.right)) for e in parsed(reader, texts) or ()
    ]
    kinetic, potential, dissipation = (
        cycles.read(reader.read(partial(parse, brackets=True), reader.text(section, key, what)) or number(0))
        for key in KEYS[1:4]
    )
    forces = _read_forces(reader, section.get("forces"), [t.value for t in coordinates], cycles)
    note_divisions(reader, constants, (kinetic, potential, dissipation, *equations, *forces.values()))
    if reader.problems:
        raise SpecError(*reader.problems)  # of unknowns without equation nothing true can be said

    def varies(node: Expression) -> bool:
        return isinstance(node, Name | Derivative) and node.name not in {*taken, LAPLACE, "pi"}

    try:
        plain = [without_brackets(e, varies) for e in (kinetic, potential, dissipation)]
    except ValueError as error:
        raise _no_derivative(error, section.span) from None
    mechanism = _Mechanism(coordinates, plain[0], plain[1], plain[2], forces, equations)
    mechanism.check_rates(reader, section.span)
    if reader.problems:
        raise SpecError(*reader.problems)
    try:
        return mechanism.motion(varies)
    except ValueError as error:
        raise _no_derivative(error, section.span) from None


def _read_forces(
    reader: Reader, entry: KeyValue | None, coordinates: Sequence[str], cycles: AsWritten
) -> dict[str, Expression]:
    """Return the generalised forces, by coordinates."""
    forces: dict[str, Expression] = {}
    what = "[energy]"
    table = reader.table(entry, f"forces of {what}", 'for instance forces = { x = "F" }') if entry else None
    for force in table.entries if table else ():
        if force.key not in coordinates:
            message = f"'{force.key}' is not a coordinate of {what}"
            reader.note("SF210", message, force.key_span, f"coordinates: {', '.join(coordinates)}")
            continue
        value = reader.expression(force.value, f"force on '{force.key}'", quantities=False)
        if value is not None:
            forces[force.key] = cycles.read(value)
    return forces


@dataclass(frozen=True, slots=True)
class _Mechanism:
    """What ``[energy]`` says: energies, what acts, and what holds."""

    coordinates: Sequence[Text]
    kinetic: Expression
    potential: Expression
    dissipation: Expression
    forces: Mapping[str, Expression]
    constraints: Sequence[Equation]

    def _held(self) -> list[tuple[str, Expression]]:
        """Return what every constraint holds at zero, with its multiplier."""
        residuals = (sum_of([e.left, negative(e.right)]) for e in self.constraints)
        return [(f"lambda_{k}", residual) for k, residual in enumerate(residuals, 1)]

    def check_rates(self, reader: Reader, span: Span) -> None:
        """Note rates of a higher order than an energy has, and s."""
        parts = [(self.kinetic, 1), (self.potential, 0), (self.dissipation, 1)]
        parts += [(residual, 0) for _, residual in self._held()]
        for node, most in ((n, most) for part, most in parts for n in walk(part)):
            if node == Name(LAPLACE) or (isinstance(node, Derivative) and node.order > most):
                message = f"'{format_expression(node)}' has no place in this part of [energy]"
                hint = "kinetic and dissipation have first rates, x'; potential and constraints have none"
                reader.note("SF222", message, node.span or span, hint)

    def motion(self, varies: Callable[[Expression], bool]) -> tuple[Signal, ...]:
        """Return Lagrange's equations of the first kind; ValueError for what has no derivative."""
        signals = []
        for text in self.coordinates:
            q, speed = Name(text.value), Derivative(text.value, 1)
            terms = [
                rate(derivative(self.kinetic, speed), varies),
                negative(derivative(self.kinetic, q)),
                derivative(self.potential, q),
                derivative(self.dissipation, speed),
                *(negative(product_of([Name(m), derivative(c, q)])) for m, c in self._held()),
            ]
            force = self.forces.get(text.value, number(0))
            signals.append(Signal(text.value, Equation(sum_of(terms), force, span=text.span), text.span))
        signals += [
            Signal(m, replace(e, left=c, right=number(0)), e.span)
            for e, (m, c) in zip(self.constraints, self._held(), strict=True)
        ]
        return tuple(signals)


def _no_derivative(error: ValueError, span: Span | None) -> SpecError:
    message = f"'{format_expression(error.args[0])}' has no derivative"
    return SpecError(Diagnostic("SF222", message, error.args[0].span or span, SMOOTH))


def with_motion(
    reader: Reader,
    sections: Mapping[str, TableValue | None],
    draft: Draft,
    taken: Collection[str],
    cycles: AsWritten,
    settings: Mapping[str, Setting],
) -> tuple[Draft, OperatingPoint | None]:
    """Return a draft whose ``[equations]`` and ``[energy]`` are linear, and the point at which they are."""
    constants = Constants({**dict.fromkeys(taken), **{d.name: d.expression for d in draft.definitions}})
    constants.declare(draft.declared, cycles.eager)
    energy = read_energy(reader, sections["energy"], constants, cycles)
    inputs = {d.input.name for d in draft.inputs}
    loads = {x.name for x in (*draft.signals, *energy)} | inputs
    nodes = {r.node for e in draft.elements for _, references in e.nodes for r in references}
    nodes |= {a.reference.node for source in draft.inputs for a in source.attachments()}
    at_rest = read_operating_point(reader, sections["operating_point"], taken, loads | nodes, cycles)
    made = settled(reader, at_rest.declared, settings) if at_rest else ()
    constants.declare(made, cycles.eager)
    parameters = {p.name: p for p in (*draft.declared, *made)}
    if energy:
        at_rest = _with_multipliers(at_rest or NOWHERE, [x.name for x in energy])
    signals, found, point, solved = linearised(
        reader,
        (*draft.signals, *energy),
        at_rest,
        inputs,
        loads | nodes,
        constants,
    )
    declared = []
    for p in parameters.values():
        if p.name in solved and p.quantity is not None:
            counted = 0 if p.name in cycles.eager else p.quantity.cycles
            quantity = replace(p.quantity, magnitude=solved[p.name], pi_power=0, cycles=counted)
            declared.append(replace(p, quantity=quantity))
        elif all(d.name != p.name for d in found):
            declared.append(p)
    definitions = in_order(reader, [*draft.definitions, *found])
    moving = loads | nodes
    outputs = tuple(replace(o, expression=in_s(o.expression, moving)) for o in draft.outputs)
    signals = tuple(replace(x, expression=in_s(x.expression, moving)) for x in signals)
    draft = replace(
        draft, declared=tuple(declared), definitions=definitions, signals=signals, outputs=outputs
    )
    return _hung(draft, {x.name for x in energy}), point


def _with_multipliers(at_rest: AtRest, unknowns: Sequence[str]) -> AtRest:
    """Return what is known at equilibrium, with names for multipliers of no given value."""
    multipliers = tuple(name for name in unknowns if name.startswith("lambda_"))
    unnamed = {m: Name(f"{m}_0") for m in multipliers if m not in at_rest.values}
    return replace(
        at_rest,
        values={**at_rest.values, **unnamed},
        multipliers=tuple(v.name for v in unnamed.values()),
        coordinates=tuple(name for name in unknowns if name not in multipliers),
        constraints=multipliers,
    )


def _hung(draft: Draft, coordinates: Collection[str]) -> Draft:
    """Return a draft with a source in place of the equation of every coordinate that is a node."""
    ports = ((port, r) for e in draft.elements for port, references in e.nodes for r in references)
    domains = {r.node: port.domain for port, r in ports}
    domains |= {a.reference.node: a.domain for source in draft.inputs for a in source.attachments()}
    kept, sources = list[Signal](), list(draft.elements)
    for signal in draft.signals:
        kind, value = SOURCES.get(domains.get(signal.name, ""), ("", ""))
        equation, span = signal.expression, signal.span
        if signal.name not in coordinates or not kind or not isinstance(equation, Equation) or span is None:
            kept.append(signal)
            continue
        acts = replace(sum_of([equation.right, negative(equation.left)]), span=span)
        nodes = ((ELEMENTS[kind].ports[0], (NodeReference(signal.name, span=span),)),)
        sources.append(DraftElement(f"motion_{signal.name}", ELEMENTS[kind], nodes, ((value, acts),), span))
    return replace(draft, elements=tuple(sources), signals=tuple(kept))
