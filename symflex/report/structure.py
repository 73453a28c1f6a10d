"""Where a model bends and gives way, whether an output is taken where an input acts, and what limits count.

Eppinger and Seering (1988, "Discussion") divide flexibility into that of the base, the transmission and the
links. Here the three are distinguished by what a compliance joins: one with an end on ground belongs to the
base; between moving parts one in bending belongs to a link, one in tension or torsion to the transmission.
None of them is what an axis touches: a compliance on ground whose force an output or a signal shows, as that
of a force sensor, is a contact.

How many poles and zeros a lumped model keeps when its compliances are rigid, or its damping taken away: every
stiffness (or damping coefficient) is multiplied by one new symbol, and the transfer function is derived with
that symbol alone among numbers. The leading (or trailing) coefficient in it of numerator and denominator is
the limit as the symbol grows without bound (or vanishes): an exact polynomial in s, whose degree counts the
roots that stay.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from typing import Final, Literal

from flint import fmpz_mpoly

from symflex import pipeline
from symflex.algebra import LAPLACE, Factored, Ring
from symflex.analysis.explanation.coordinates import in_one_way, joined_values
from symflex.expressions import (
    Attribute,
    Call,
    Derivative,
    Expression,
    Name,
    format_expression,
    names,
    product_of,
)
from symflex.library.fields import BEAM_ORDER
from symflex.model import Input, Model, ModelParameter, Output, PlacedElement, with_numbers
from symflex.print.forms.naming import names_of

Place = Literal["base", "transmission", "link", "contact"]
PLACES: Final[tuple[Place, ...]] = ("base", "transmission", "link", "contact")


@dataclass(frozen=True, slots=True)
class Compliance:
    """A part that gives way."""

    name: str  # the element or field
    is_bending: bool  # it bends; else it is stretched or twisted
    place: Place  # ``base``, ``transmission``, ``link`` or ``contact``


def compliances(model: Model) -> tuple[Compliance, ...]:
    """Return what gives way in a model, in the order of its text."""
    compliant = []
    for use in model.elements:
        if use.element.compliance:
            is_bending = use.element.compliance == "bending"
            is_grounded = any(r.is_ground for _, references in use.nodes for r in references)
            location = _place(is_bending, is_grounded=is_grounded)
            if is_grounded and _is_felt(model, use):
                location = "contact"
            compliant.append(Compliance(use.name, is_bending, location))
    for field in model.fields:
        orders = [n.order for e in field.equations for n in names(e) if isinstance(n, Derivative)]
        is_bending = max(orders, default=0) >= BEAM_ORDER or len(field.unknowns) > 1
        compliant.append(Compliance(field.name, is_bending, _place(is_bending, is_grounded=False)))
    return tuple(compliant)


def is_colocated(model: Model, output: Output, source: Input) -> bool | None:
    """Tell whether an output is taken where an input acts; None if one of them is at no place."""
    model = in_one_way(model)
    (output,) = (each for each in model.outputs if each.name == output.name)
    starts, ends = _acted_on(model, source), _shown(model, output)
    if not starts or not ends:
        return None
    joined = set(starts)
    groups = [
        _places(use)
        for use in model.elements
        # Where a side has two nodes, only their difference follows.
        if use.element.moves_as_one
        and not any(p.reacts and len(dict(use.nodes)[p.name]) > 1 for p in use.element.ports)
    ]
    groups += [{_place_of(model, value) for value in group} for group in joined_values(model)]
    grown = True
    while grown:
        reached = [group for group in groups if group & joined and not group <= joined]
        joined |= {node for group in reached for node in group}
        grown = bool(reached)
    return ends <= joined


def _place(is_bending: bool, *, is_grounded: bool) -> Place:
    if is_grounded:
        return "base"
    return "link" if is_bending else "transmission"


def _is_felt(model: Model, use: PlacedElement) -> bool:
    """Return whether an output or a signal shows an element's force, by name or as stiffness times place."""
    places = _places(use)
    stiffness = set().union(*(_named(value) for _, value in use.values))
    shown = [x.expression for x in model.outputs] + [x.expression for x in model.signals]
    for expression in shown:
        if stiffness and stiffness | places <= _named(expression):
            return True
        if any(isinstance(n, Attribute) and n.owner == use.name for n in names(expression)):
            return True
    return False


def _places(use: PlacedElement) -> set[str]:
    return {r.node for _, references in use.nodes for r in references if not r.is_ground}


def _acted_on(model: Model, source: Input) -> set[str]:
    """Return the nodes an input acts on, directly or through signals, and the points of fields."""
    nodes = {r.node for r in source.nodes if not r.is_ground}
    mentioned = {source.name}
    for _ in model.signals:
        mentioned |= {x.name for x in model.signals if _named(x.expression) & mentioned}
    for use in model.elements:
        if any(_named(e) & mentioned for _, e in use.values):
            nodes |= _places(use)
    for field in model.fields:
        for condition in field.conditions:
            if _named(condition) & mentioned:
                nodes |= _points(condition, field.unknowns)
    return nodes


def _shown(model: Model, output: Output) -> set[str]:
    """Return the nodes and points whose motion an output is made of."""
    nodes = {n.name for n in model.nodes}
    signals = {x.name: x.expression for x in model.signals}
    pending, seen, shown = [output.expression], set(), set()
    while pending:
        expression = pending.pop()
        for name in _named(expression):
            if name in nodes:
                shown.add(name)
            elif name in signals and name not in seen:
                seen.add(name)
                pending.append(signals[name])
        for field in model.fields:
            shown |= _points(expression, field.unknowns)
    return shown


def _named(expression: Expression) -> set[str]:
    return {
        n.owner if isinstance(n, Attribute) else n.name
        for n in names(expression)
        if isinstance(n, Name | Attribute)
    }


def _place_of(model: Model, value: Expression) -> str:
    """Return the node, or the point of a field, that a value belongs to."""
    if isinstance(value, Attribute):
        return value.owner
    if isinstance(value, Name):
        return value.name
    (point,) = {p for field in model.fields for p in _points(value, field.unknowns)}
    return point


def _points(expression: Expression, unknowns: tuple[str, ...]) -> set[str]:
    # No node bears such a name.
    calls = [n for n in names(expression) if isinstance(n, Call) and n.name in unknowns]
    return {f"{unknowns[0]}({format_expression(n.argument)})" for n in calls}


Values = tuple[tuple[str, "Expression"], ...]
Counts = tuple[int, int]  # zeros and poles
RigidCounts = tuple[int | None, int]  # the same; no zeros of a function that vanishes, or grows without bound
RESONANCES: Final = ("omega_p", "omega_z")  # what grows in a resonance block as compliances become rigid


def rigid_counts(model: Model) -> Mapping[tuple[str, str], RigidCounts]:
    """Return the zeros and poles of every transfer function as all compliances become rigid, None for others.

    Zeros are None where nothing moves; distributed models and those without compliances have no such limit.
    """
    return _limits(model, lambda use: use.element.stiffness, RESONANCES, max)


def undamped_counts(model: Model) -> Mapping[tuple[str, str], Counts]:
    """Return the zeros and poles as all dampers vanish; of distributed or undamped models none."""
    limits = _limits(model, lambda use: use.element.damping, (), min)
    return {pair: (zeros, poles) for pair, (zeros, poles) in limits.items() if zeros is not None}


def _limits(
    model: Model,
    of_element: Callable[[PlacedElement], str | None],
    of_resonance: Collection[str],
    choose: Callable[[list[int]], int],
) -> dict[tuple[str, str], RigidCounts]:
    if model.is_distributed:
        return {}
    taken = names_of(model)
    symbol = "scale"
    while symbol in taken:
        symbol += "_x"

    def scaled(values: Values, keys: Collection[str | None]) -> Values:
        return tuple((k, product_of([Name(symbol), e]) if k in keys else e) for k, e in values)

    elements = tuple(replace(e, values=scaled(e.values, {of_element(e)})) for e in model.elements)
    blocks = tuple(
        replace(b, values=scaled(b.values, of_resonance))
        if b.block is not None and b.block.type_name == "resonance"
        else b
        for b in model.blocks
    )
    if elements == model.elements and blocks == model.blocks:
        return {}
    given = with_numbers(replace(model, elements=elements, blocks=blocks))
    given = replace(given, parameters=(*given.parameters, ModelParameter(symbol, None)))
    counts = {}
    for tf in pipeline.derive_all(given, model.transfer_functions):
        ring = tf.ratio.ring
        if tf.ratio.is_zero or symbol not in ring.index:
            continue
        above, power = _limit(ring, tf.ratio.numerator(), symbol, choose)
        below, other_power = _limit(ring, tf.ratio.denominator(), symbol, choose)
        common = _degree(ring, above.gcd(below))
        zeros = _degree(ring, above) - common if power == other_power else None
        counts[tf.output.name, tf.input.name] = (zeros, _degree(ring, below) - common)
    return counts


def _limit(
    ring: Ring, value: Factored, symbol: str, choose: Callable[[list[int]], int]
) -> tuple[fmpz_mpoly, int]:
    """Return the limits of all factors, multiplied, and the power of the symbol that goes with them."""
    index = ring.index[symbol]
    product, power = ring.constant(1), 0
    for factor, exponent in value.factors:
        terms = {tuple(map(int, monomial)): int(c) for monomial, c in factor.terms()}
        kept = choose([monomial[index] for monomial in terms])
        limit = {(*m[:index], 0, *m[index + 1 :]): c for m, c in terms.items() if m[index] == kept}
        product, power = product * ring.context.from_dict(limit) ** exponent, power + kept * exponent
    return product, power


def _degree(ring: Ring, polynomial: fmpz_mpoly) -> int:
    return int(polynomial.degrees()[ring.index[LAPLACE]])
