"""A machine without what stores energy right at a port, and so with the same sign of the real part there.

Input: a model and a port.
Output: a model whose driving-point impedance differs from that of the first by ``m s + k/s``.

A mass, or a spring to ground, at the node of a port adds to the impedance what is imaginary on the axis, so
that ``Re Z``, and with it the sign of ``Re Y = Re Z/abs(Z)^2``, stays what it is. A mass at the tip makes Y
turn to -90 degrees as the frequency grows, where no bound tells a sign; without it the beam or the damper
behind it decides, at a clear angle.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE, Factored, by_powers, degree_in
from symflex.expressions import Attribute, names, names_among, number
from symflex.library.elements import COMPONENTS
from symflex.model import ContactPort, Model, PlacedElement
from symflex.model.model import Definition
from symflex.model.network import variable_of

if TYPE_CHECKING:
    from symflex.transfer import BoundTransferFunction

STORES = frozenset(
    "mass spring inertia torsion_spring capacitor inductor acoustic_mass acoustic_compliance".split()
)
"""Elements that only store energy, where their value is a real number."""
BODY = "rigid_body"  # its mass moves with y alone where the centre is at the node


def without_storage(model: Model, port: ContactPort) -> Model:
    """Return a model without the elements at a port that only store energy."""
    measured = {
        n.owner if isinstance(n, Attribute) else n.name for _, e in model.expressions() for n in names(e)
    }
    varying = {LAPLACE, *(b.name for b in model.blocks), *_of_s(model.definitions, model)}
    kept = []
    for use in model.elements:
        if use.name in measured or any(names_among(e, varying) for _, e in use.all_values):
            kept.append(use)
        elif use.element.type_name == BODY and _is_body_at(use, port, model):
            kept.append(replace(use, values=tuple((n, number(0) if n == "m" else e) for n, e in use.values)))
        elif not (use.element.type_name in STORES and _is_at(use, port, model)):
            kept.append(use)
    return replace(model, elements=tuple(kept)) if kept else model


def without_ladder(bound: BoundTransferFunction) -> BoundTransferFunction:
    """Return a function with the same sign of the real part, without the ``c s`` by which Y or 1/Y grows.

    Such are a mass in equations of motion, and the coil and the capacitor of a filter at a port, one after
    the other (Cauer 1926). Beside their powers of s, what is left of the real part far out has few digits.
    """
    ring = bound.ratio.ring
    s, kernels = ring.generator(ring.names[0]), {k.generator for k in bound.kernels.kernels}
    parts = [f.expand() for f in (bound.ratio.numerator(), bound.ratio.denominator())]
    for _ in range(degree_in(parts[0], 0) + degree_in(parts[1], 0)):
        above = int(degree_in(parts[1], 0) > degree_in(parts[0], 0))
        leads = [by_powers(ring, f) for f in parts]
        degree, other = (max(leads[i]) for i in (above, 1 - above))
        lead, lower = leads[above][degree], leads[1 - above][other]
        if degree != other + 1 or kernels & ring.used_in((lead, lower)):
            break
        parts[above] = lower * parts[above] - lead * s * parts[1 - above]
        parts[1 - above] *= lower
        if parts[above].is_zero():
            return replace(bound, ratio=Factored.number(ring, 0), parts=None, hidden=())
    ratio = Factored.polynomial(ring, parts[0]) / Factored.polynomial(ring, parts[1])
    return replace(bound, ratio=ratio, parts=None, hidden=())


def _of_s(definitions: tuple[Definition, ...], model: Model) -> set[str]:
    """Return the names of definitions that depend on s."""
    varying = {LAPLACE, *(b.name for b in model.blocks)}
    for _ in definitions:
        varying |= {d.name for d in definitions if names_among(d.expression, varying)}
    return varying


def _is_at(use: PlacedElement, port: ContactPort, model: Model) -> bool:
    """Tell whether an element lies between a port and ground, or between both nodes of a port."""
    if any(name == "eta_s" and e != number(0) for name, e in use.values):
        return False
    nodes = {n.name: n for n in model.nodes}
    ((_, ends),) = use.nodes
    at, own = (
        {variable_of(r, nodes[r.node], port.domain) for r in references if not r.is_ground}
        for references in (ends, port.nodes)
    )
    return at == own and {domain for _, domain in use.domains} == {port.domain}


def _is_body_at(use: PlacedElement, port: ContactPort, model: Model) -> bool:
    """Tell whether the mass of a body acts on the deflection at a port alone."""
    values, ((_, (end,)),) = dict(use.values), use.nodes
    nodes = {n.name: n for n in model.nodes}
    (first, *others) = port.nodes
    return (
        not any(not r.is_ground for r in others)
        and nodes[end.node].domain == "planar"
        and len(COMPONENTS["planar"]) > 1
        and (first.node, first.component or "y") == (end.node, "y")
        and values.get("cg", number(0)) == number(0)
    )
