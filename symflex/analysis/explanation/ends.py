"""What holds the ends of beams, rods, shafts and strings, in the words of the field.

Input: the variables at rest, or a field's conditions. Output: such as "clamped at x_act, free at x_tip".
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.analysis.explanation.parts import SUPPORTS, coordinates_of
from symflex.expressions import Call, Derivative, Name, format_expression, is_number, names
from symflex.library.elements import LineElement, Variable
from symflex.library.elements.massless_beam import MasslessBeam

if TYPE_CHECKING:
    from collections.abc import Collection

    from symflex.expressions import Equation, Expression
    from symflex.model import Field, Model, NodeReference, PlacedElement

BENDING = {(True, True): "clamped", (True, False): "pinned", (False, True): "sliding", (False, False): "free"}
"""By whether deflection and slope are held."""
BY_ORDERS: dict[int, dict[tuple[int, ...], str]] = {
    4: {(0, 1): "clamped", (0, 2): "pinned", (1, 3): "sliding", (2, 3): "free"},
    2: {(0,): "held", (1,): "free"},
}
"""By the derivatives that vanish at an end, for an equation of that order in x."""
PAIR = 2


def is_line(use: PlacedElement) -> bool:
    """Tell whether an element extends along x."""
    return isinstance(use.element, LineElement | MasslessBeam)


def ends_of_element(model: Model, use: PlacedElement, resting: Collection[Variable]) -> str:
    """Return how both ends of a line element are held.

    Parameters
    ----------
    model : Model
        Where it stands.
    use : PlacedElement
        A line element.
    resting : collection of Variable
        The coordinates at rest.
    """
    (_, references), *_ = use.nodes
    domain = dict(use.domains)["between"]
    return ", ".join(_end(model, use, r, domain == "planar", resting) for r in references)


def _end(
    model: Model, use: PlacedElement, reference: NodeReference, is_planar: bool, resting: Collection[Variable]
) -> str:
    if reference.is_ground:
        return f"{'clamped' if is_planar else 'held'} at ground"
    if is_planar:
        own = tuple(Variable("node", reference.node, c) for c in ("y", "theta"))
        word = BENDING[own[0] in resting, own[1] in resting]
    else:
        own = tuple(v for v in coordinates_of(model, use) if v.owner == reference.node)
        word = "held" if all(v in resting for v in own) else "free"
    free = [v for v in own if v not in resting]
    carried = [
        other.name
        for other in model.elements
        if other is not use
        and not isinstance(other.element, SUPPORTS)
        and any(v in free for v in coordinates_of(model, other))
    ]
    with_others = f" with {', '.join(carried)}" if carried else ""
    return f"{word} at {reference.node}{with_others}"


def ends_of_field(field: Field) -> str:
    """Return how both ends of a field of one unknown are held; nothing when no word stands for it.

    A force or moment that an input applies leaves the end what it is.

    Examples
    --------
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
        place = None if call is None else format_expression(call.argument)
        if call is None or place not in at:
            return ""
        at[str(place)].append(call.order)
    words = [None if known is None else known.get(tuple(sorted(orders))) for orders in at.values()]
    if len(at) != PAIR or any(word is None for word in words):
        return ""
    return ", ".join(f"{word} at x = {place}" for word, place in zip(words, at, strict=True))


def _single(condition: Equation, unknown: str) -> Call | None:
    """Return the one value of the field in a condition that puts nothing but inputs beside it."""
    calls = [n for n in names(condition) if isinstance(n, Call)]
    own = [c for c in calls if c.name == unknown]
    sides = (condition.left, condition.right)
    if len(own) != 1 or len(calls) != 1:
        return None
    other = next(side for side in sides if own[0] not in names(side))
    plain = is_number(other, 0)
    return own[0] if plain or _is_load(other) else None


def _is_load(side: Expression) -> bool:
    found = names(side)
    return len(found) == 1 and isinstance(found[0], Name)
