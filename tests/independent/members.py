"""Random networks of beams, rods, shafts and strings as boundary-value problems.

The specification and the boundary-value problem are made of the same numbers, and of nothing else.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mpmath import exp, mp, mpc, mpf

from tests.independent.boundary_value import DIGITS, Form, Problem, bending, rod, shaft, string, timoshenko
from tests.random_models import GROUND, LUMPS, MEMBERS, random_members
from tests.random_models import to_toml as specification

if TYPE_CHECKING:
    from tests.independent.boundary_value import Number, Rows, Values
    from tests.random_models import Element, Network

__all__ = ["driven", "is_seen", "random_members", "read", "response", "specification"]


def driven(network: Network) -> str:
    """Return the node where a network is driven."""
    return network.inputs[0].nodes[0]


def read(network: Network) -> str:
    """Return the node where a network is read."""
    return network.outputs[0][1][0].quantity


def is_seen(network: Network) -> bool:
    """Tell whether what drives a network moves what is read: not where ground or nothing is between them."""
    found, pending = {driven(network)}, [driven(network)]
    while pending:
        here = pending.pop()
        ends = [e.port("between") for e in network.elements if e.kind in MEMBERS]
        near = {end for pair in ends if here in pair for end in pair} - {GROUND}
        near |= {e.port("at")[0] for e in network.elements for term in e.source if term.quantity == here}
        pending += near - found
        found |= near
    return read(network) in found


def response(network: Network, s: complex) -> Number:
    """Return what is read per unit of what drives, by one linear system at one frequency [rad/s]."""
    with mp.workdps(DIGITS):
        return _response(network, mpc(s))


def _response(network: Network, s: Number) -> Number:
    problem = Problem()
    bends = any(element.kind == "beam" for element in network.elements)
    width = 2 if bends else 1
    names = [name for name, _ in network.coordinates]
    across = {name: [problem.unknown() for _ in range(width)] for name in names}
    across[GROUND] = [Form()] * width
    needed = {name: [Form()] * width for name in across}

    def load(at: str, component: int, force: Form) -> None:
        added = list(needed[at])
        added[component] = added[component] + force
        needed[at] = added

    for element in network.elements:
        values = {key: mpf(parameter.number) for key, parameter in element.values}
        if element.kind in MEMBERS:
            line = problem.line(_rows(element, values, s))
            start, end = line.start, line.at(values["l"])
            for name, state in zip(element.port("between"), (start, end), strict=True):
                problem.require(*(x - y for x, y in zip(state[:width], across[name], strict=True)))
            # What it takes to hold the two ends, see the head of boundary_value.
            loads = ([start[3], -start[2]], [-end[3], end[2]]) if bends else ([-start[1]], [end[1]])
            for name, forces in zip(element.port("between"), loads, strict=True):
                for i, force in enumerate(forces):
                    load(name, i, force)
        elif element.source:  # minus a gain times a late displacement
            (term,), (delay,) = element.source, network.blocks
            ((_, late),) = delay.values
            factor = mpf(term.gains[0].number) * exp(-s * mpf(late.number))
            load(element.port("at")[0], 0, across[term.quantity][0] * factor)
        else:
            name, _, component = element.ports[0][1][0].partition(".")
            power = next(kinds.index(element.kind) for kinds in LUMPS if element.kind in kinds)
            i = int(component == "theta" and bends)
            (value,) = values.values()
            load(name, i, across[name][i] * (value * s**power))
    load(driven(network), 0, Form({}, -1))
    for name in names:
        problem.require(*needed[name])
    return problem.solve()(across[read(network)][0])


def _rows(member: Element, values: Values, s: Number) -> Rows:
    if member.kind != "beam":
        return {"rod": rod, "shaft": shaft, "string": string}[member.kind](values, s)
    if member.theory == "timoshenko":
        return timoshenko(values, s)
    return bending(values, s, rotary=member.theory == "rayleigh")
