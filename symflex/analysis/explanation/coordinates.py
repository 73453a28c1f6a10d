"""Where an input acts and what an output measures, as coordinates of nodes.

Input: a model, and its equations.
Output: coordinates with signs; two of them are a relative motion, and a force between two nodes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.algebra import Factored
from symflex.expressions import names
from symflex.library.elements import Variable
from symflex.library.elements.source import CurrentSource, ForceSource, TorqueSource, VoltageSource
from symflex.model.input_kinds import INPUT_KINDS
from symflex.model.nodes import variable_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from symflex.equations import Equations
    from symflex.expressions import Expression
    from symflex.library.elements import Domain, LinearForm
    from symflex.model import Input, Model, NodeReference, PlacedElement

Coordinates = tuple[tuple[Variable, int], ...]
"""One coordinate, or two with opposite signs; the first counts once."""

PAIR = 2


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredCoordinate:
    """An output that is ``factor`` times one coordinate, or times the difference of two."""

    coordinates: Coordinates  # what it measures
    factor: Factored  # over the equations' ring, ``s`` for a velocity


def acting(model: Model, source: Input) -> Coordinates:
    """Return where a force, torque or current acts; nothing for other inputs.

    A free signal acts where it is all that drives a source.

    Examples
    --------
    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... elements.body = { type = "mass", at = "x", m = 1 }
    ... elements.coil = { type = "force_source", at = "x", f = "3*u" }
    ... inputs.u = {}
    ... outputs.y = "x"
    ... ''')
    >>> [(str(v), sign) for v, sign in acting(model, model.inputs[0])]
    [('x', 1)]
    """
    kind = INPUT_KINDS.get(source.kind)
    if kind is not None and not kind.is_imposed:
        return _at(model, source.nodes, kind.domain)
    element = driven_source(model, source)
    if element is None or isinstance(element.element, VoltageSource):
        return ()
    ((port, references),) = element.nodes
    domain = dict(element.domains)[port]
    return () if domain == "planar" else _at(model, references, domain)


def driven_source(model: Model, source: Input) -> PlacedElement | None:
    """Return the source element that a free signal drives, and that alone; ``None`` without such."""
    if source.kind != "signal":
        return None
    constants = {p.name for p in model.parameters} | {d.name for d in model.definitions} | {"pi"}
    users = [use for use, e in _element_values(model) if _mentions(e, source.name)]
    others = [e for e in _other_expressions(model) if _mentions(e, source.name)]
    if len(users) != 1 or others:
        return None
    (use,) = users
    if not isinstance(use.element, ForceSource | TorqueSource | CurrentSource | VoltageSource):
        return None
    written = {str(getattr(n, "name", "")) for _, e in use.values for n in names(e)}
    return use if written <= constants | {source.name} else None


def _element_values(model: Model) -> Iterator[tuple[PlacedElement, Expression]]:
    for use in model.elements:
        for _, expression in use.values:
            yield use, expression


def _other_expressions(model: Model) -> Iterator[Expression]:
    yield from (signal.expression for signal in model.signals)
    yield from (output.expression for output in model.outputs)
    for field in model.fields:
        yield from (*field.equations, *field.conditions)


def _mentions(expression: Expression, name: str) -> bool:
    return any(getattr(n, "name", "") == name for n in names(expression))


def _at(model: Model, references: tuple[NodeReference, ...], domain: Domain) -> Coordinates:
    nodes = {n.name: n for n in model.nodes}
    signs = (1, -1)
    found = [
        (variable_of(r, nodes[r.node], domain), sign)
        for r, sign in zip(references, signs, strict=False)
        if not r.is_ground
    ]
    return same_sign(tuple(found))


def same_sign(coordinates: Coordinates) -> Coordinates:
    """Return the coordinates in the order of their names, the first with a plus."""
    ordered = sorted(coordinates, key=lambda found: str(found[0]))
    lead = ordered[0][1] if ordered else 1
    return tuple((v, sign * lead) for v, sign in ordered)


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
    terms = _collected(form)
    for _ in range(len(laws) + 1):
        found = next((v for v in terms if v in laws), None)
        if found is None:
            return terms
        coefficient = terms.pop(found)
        law = _collected(laws[found])
        own = law.pop(found, None)
        if own is None:
            return None
        for variable, value in law.items():
            change = -coefficient * value / own
            terms[variable] = terms[variable] + change if variable in terms else change
        terms = {v: c for v, c in terms.items() if not c.is_zero}
    return None


def _collected(form: LinearForm) -> dict[Variable, Factored]:
    found: dict[Variable, Factored] = {}
    for variable, coefficient in form.terms:
        found[variable] = found[variable] + coefficient if variable in found else coefficient
    return {v: c for v, c in found.items() if not c.is_zero}
