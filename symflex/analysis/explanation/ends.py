"""What holds the ends of beams, rods, shafts and strings, and what lies between an input and an output.

Input: the variables at rest, or a field's conditions. Output: words like "clamped at x_act, free at x_tip".

In a beam that bends without damping the spatial exponents at a real s are ``mu*(+-1 +-j)`` with a real mu:
every solution grows or decays along x, none travels. Real zeros of noncolocated transfer functions come of
such nonpropagating bending (Miu 1991).
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from symflex.algebra import Factored
from symflex.analysis.explanation.coordinates import acting, holds, measured
from symflex.analysis.explanation.parts import SUPPORTS, coordinates_of, opened
from symflex.equations import Equations
from symflex.expressions import Call, Derivative, Equation, Name, format_expression, is_number, names
from symflex.library.elements import COMPONENTS, LineElement, Variable
from symflex.library.elements.line import Beam
from symflex.library.elements.rigid import MasslessBeam
from symflex.library.fields import BEAM_ORDER
from symflex.model import FieldProblem, Input, Model, NodeReference, Output, PlacedElement

BENDING = {(True, True): "clamped", (True, False): "pinned", (False, True): "sliding", (False, False): "free"}
"""Names of ends by whether deflection and slope are held."""
BY_ORDERS: dict[int, dict[tuple[int, ...], str]] = {
    4: {(0, 1): "clamped", (0, 2): "pinned", (1, 3): "sliding", (2, 3): "free"},
    2: {(0,): "held", (1,): "free"},
}  # names by the derivatives that vanish there, for an equation of that order in x


def is_line(use: PlacedElement) -> bool:
    """Tell whether an element extends along x."""
    return isinstance(use.element, LineElement | MasslessBeam)


def ends_of_element(model: Model, use: PlacedElement, resting: Collection[Variable]) -> str:
    """Return how both ends of a line element are held, given the coordinates at rest."""
    (_, references), *_ = use.nodes
    domain = dict(use.domains)["between"]
    return ", ".join(_end(model, use, r, domain in COMPONENTS, resting) for r in references)


def _end(
    model: Model, use: PlacedElement, reference: NodeReference, is_planar: bool, resting: Collection[Variable]
) -> str:
    if reference.is_ground:
        return f"{'clamped' if is_planar else 'held'} at ground"
    coordinates = tuple(v for v in coordinates_of(model, use) if v.owner == reference.node)
    if is_planar:
        *across, theta = (v in resting for v in coordinates)
        held = " and ".join(v.component for v in coordinates if v in resting)
        word = f"held in {held}" if any(across) != all(across) else BENDING[any(across), theta]
    else:
        word = "held" if all(v in resting for v in coordinates) else "free"
    free = [v for v in coordinates if v not in resting]
    carried = [
        other.name
        for other in model.elements
        if other is not use
        and not isinstance(other.element, SUPPORTS)
        and any(v in free for v in coordinates_of(model, other))
    ]
    with_others = f" with {', '.join(carried)}" if carried else ""
    return f"{word} at {reference.node}{with_others}"


def ends_of_field(field: FieldProblem) -> str:
    """Return how both ends of a field of one unknown are held; nothing when no word stands for it.

    A force or moment that an input applies leaves the end what it is.

    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... inputs.F = {}
    ... outputs.U = "u(1)"
    ... [fields.u]
    ... domain = ["0", "1"]
    ... equation = "u'' - s^2*u = 0"
    ... conditions = ["u(0) = 0", "u'(1) = F"]
    ... ''')
    >>> ends_of_field(model.fields[0])
    'held at x = 0, free at x = 1'
    """
    if len(field.unknowns) != 1:
        return ""
    order = max((n.order for e in field.equations for n in names(e) if isinstance(n, Derivative)), default=0)
    known = BY_ORDERS.get(order)
    at: dict[str, list[int]] = {format_expression(end): [] for end in (field.start, field.end)}
    for condition in field.conditions:
        call = _single(condition, field.unknowns[0])
        position = None if call is None else format_expression(call.argument)
        if call is None or position not in at:
            return ""
        at[str(position)].append(call.order)
    words = [None if known is None else known.get(tuple(sorted(orders))) for orders in at.values()]
    if len(at) == 1 or any(word is None for word in words):
        return ""
    return ", ".join(f"{word} at x = {position}" for word, position in zip(words, at, strict=True))


def _single(condition: Equation, unknown: str) -> Call | None:
    """Return the one value of the field in a condition that puts nothing but inputs beside it."""
    calls = [n for n in names(condition) if isinstance(n, Call)]
    matching = [c for c in calls if c.name == unknown]
    sides = (condition.left, condition.right)
    if len(matching) != 1 or len(calls) != 1:
        return None
    other = next(side for side in sides if matching[0] not in names(side))
    plain = is_number(other, 0)
    read = names(other)
    return matching[0] if plain or (len(read) == 1 and isinstance(read[0], Name)) else None


@dataclass(frozen=True, slots=True)
class Bending:
    """A beam between input and output."""

    name: str  # the element or field
    is_massless: bool  # it bends without waves
    is_evanescent: bool  # proved: at every real s > 0 all solutions grow or decay along x, none travels


def bending_between(model: Model, equations: Equations, output: Output, source: Input) -> Bending | None:
    """Return the beam without which input and output are not connected, or the field they both belong to."""
    motion = measured(equations, output.name)
    if motion is not None:
        starts = {v for v, _ in acting(model, source)} or _driven(model, source)
        ends = {v for v, _ in motion.coordinates}
        for use in model.elements:
            if not isinstance(use.element, Beam | MasslessBeam):
                continue  # a member of a frame stretches besides: waves travel along it
            if not _reach(model, starts, without=None).isdisjoint(ends) and _reach(
                model, starts, without=use
            ).isdisjoint(ends):
                is_massless = isinstance(use.element, MasslessBeam)
                return Bending(use.name, is_massless, not is_massless and _is_evanescent(equations))
        return None
    return _field_between(model, equations, output, source)


def _driven(model: Model, source: Input) -> set[Variable]:
    """Return the coordinates of the elements an input drives, directly or through signals."""
    mentioned = {source.name}
    for _ in model.signals:
        mentioned |= {
            x.name
            for x in model.signals
            if any(isinstance(n, Name) and n.name in mentioned for n in names(x.expression))
        }
    driven: set[Variable] = set()
    for use in model.elements:
        written = {n.name for _, e in use.values for n in names(e) if isinstance(n, Name)}
        if written & mentioned:
            driven |= set(coordinates_of(model, use))
    nodes = {n.name: n for n in model.nodes}
    for reference in source.nodes:
        if not reference.is_ground:
            driven |= {Variable("node", reference.node, c) for c in nodes[reference.node].components}
    return driven


def _reach(model: Model, starts: Collection[Variable], without: PlacedElement | None) -> set[Variable]:
    """Return the coordinates that elements, but one, connect with the given ones; supports connect none."""
    groups = [
        set(coordinates_of(model, use))
        for use in model.elements
        if use is not without and not isinstance(use.element, SUPPORTS)
    ]
    # The deflection and slope of a node belong together, whatever acts on only one of them.
    groups += [{Variable("node", n.name, c) for c in n.components} for n in model.nodes]
    reached = set(starts)
    grown = True
    while grown:
        joined = [group for group in groups if group & reached and not group <= reached]
        reached |= {v for group in joined for v in group}
        grown = bool(joined)
    return reached


def _field_between(model: Model, equations: Equations, output: Output, source: Input) -> Bending | None:
    for field in model.fields:
        order = max(n.order for e in field.equations for n in names(e) if isinstance(n, Derivative))
        shown = [n for n in names(output.expression) if isinstance(n, Call) and n.name in field.unknowns]
        loaded = [
            n
            for condition in field.conditions
            if holds(condition, source.name)
            for n in names(condition)
            if isinstance(n, Call) and n.name in field.unknowns
        ]
        places = [{format_expression(call.argument) for call in calls} for calls in (shown, loaded)]
        is_beam = len(field.unknowns) == 1 and order == BEAM_ORDER
        if is_beam and all(places) and places[0].isdisjoint(places[1]):
            return Bending(field.name, False, _is_evanescent(equations))
    return None


def _is_evanescent(equations: Equations) -> bool:
    """Prove that no beam of a model passes waves at a real s > 0: ``4 mu^4 = c_0`` is positive there."""
    waves = equations.propagation
    if waves is None:
        return False
    laws = [law for law in waves.table.dispersions if law.kind not in ("exponential", "wave")]
    real = {p.name for p in equations.model.parameters if p.assume == "real"}
    return bool(laws) and all(
        law.kind == "bending"
        and law.shift.is_zero
        and _is_positive(opened(equations, waves.embed(law.characteristic[0])), real)
        for law in laws
    )


def _is_positive(value: Factored, real: Collection[str]) -> bool:
    """Tell whether a product is certainly positive for s > 0 and positive parameters."""
    if value.unit <= 0 or any(value.depends_on(name) for name in real if name in value.ring.index):
        return False
    return all(int(c) > 0 for factor, _ in value.factors for c in factor.coeffs())
