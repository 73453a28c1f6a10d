"""The beam that lies between an input and an output, and whether waves travel in it at a real s.

In a beam that bends without loss the spatial exponents at a real s are ``mu*(+-1 +-j)`` with a real mu: every
solution grows or decays along x, none travels. Real zeros of noncolocated transfer functions come of such
nonpropagating bending (Miu 1991).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.analysis.explanation.comparison import opened
from symflex.analysis.explanation.coordinates import acting, measured
from symflex.analysis.explanation.parts import SUPPORTS, coordinates_of
from symflex.expressions import Call, Derivative, Name, format_expression, names
from symflex.library.elements import Variable
from symflex.library.elements.beam import Beam
from symflex.library.elements.massless_beam import MasslessBeam

if TYPE_CHECKING:
    from collections.abc import Collection

    from symflex.algebra import Factored
    from symflex.equations import Equations
    from symflex.model import Input, Model, Output, PlacedElement

BENDING_ORDER = 4


@dataclass(frozen=True, slots=True)
class Bending:
    """A beam between input and output.

    Parameters
    ----------
    name : str
        The element or field.
    is_massless : bool
        It bends without waves.
    is_evanescent : bool
        Proved: at every real s > 0 all its solutions grow or decay along x, and none travels.
    """

    name: str
    is_massless: bool
    is_evanescent: bool


def bending_between(model: Model, equations: Equations, output: Output, source: Input) -> Bending | None:
    """Return the beam without which input and output are not connected, or the field they both belong to.

    Parameters
    ----------
    model : Model
        Resolved.
    equations : Equations
        Assembled from it.
    output, source : Output, Input
        The pair.
    """
    motion = measured(equations, output.name)
    if motion is not None:
        starts = {v for v, _ in acting(model, source)} or _driven(model, source)
        ends = {v for v, _ in motion.coordinates}
        for use in model.elements:
            if not isinstance(use.element, Beam | MasslessBeam):
                continue
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
    found: set[Variable] = set()
    for use in model.elements:
        written = {n.name for _, e in use.values for n in names(e) if isinstance(n, Name)}
        if written & mentioned:
            found |= set(coordinates_of(model, use))
    nodes = {n.name: n for n in model.nodes}
    for reference in source.nodes:
        if not reference.is_ground:
            found |= {Variable("node", reference.node, c) for c in nodes[reference.node].components}
    return found


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
            if any(isinstance(n, Name) and n.name == source.name for n in names(condition))
            for n in names(condition)
            if isinstance(n, Call) and n.name in field.unknowns
        ]
        places = [{format_expression(call.argument) for call in calls} for calls in (shown, loaded)]
        is_beam = len(field.unknowns) == 1 and order == BENDING_ORDER
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
