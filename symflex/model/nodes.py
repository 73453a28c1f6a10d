"""Which domain each node has, from what is attached to it."""

from __future__ import annotations

from dataclasses import dataclass
from heapq import heapify, heappop, heappush
from typing import TYPE_CHECKING

from symflex.errors import Diagnostic
from symflex.library.elements import Variable
from symflex.model.model import NetworkNode
from symflex.quantities import unit_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.library.elements import Domain, Element
    from symflex.library.elements.element import PortDomain
    from symflex.model.model import NodeReference
    from symflex.quantities import Dimension


@dataclass(frozen=True, slots=True)
class Coupling:
    """What a coupling says about the domains of its two sides."""

    element: Element  # whose ``ratio`` has a unit that depends on both domains
    # port and partner_port: this side and the other side.
    port: str
    partner_port: str
    partner: NodeReference  # the node at the other side
    ratio: Dimension | None  # what the given ratio is measured in, when that is known

    def suggested(self, partner: Domain) -> Domain:
        """Return the domain for this side that the ratio's unit asks for, or else its partner's."""
        if self.ratio is None:
            return partner
        for domain in (partner, *DOMAINS):
            unit = self.element.unit_of("ratio", {self.port: domain, self.partner_port: partner})
            if unit_of(unit).dimension == self.ratio:
                return domain
        return partner


@dataclass(frozen=True, slots=True)
class Attachment:
    """One port at one node; a coupling's port has no domain of its own."""

    reference: NodeReference
    domain: PortDomain
    who: str
    coupling: Coupling | None = None


DOMAINS: tuple[Domain, ...] = ("translation", "rotation", "electrical")
WORDS = {
    "translation": "a displacement",
    "rotation": "an angle",
    "electrical": "a voltage",
    "planar": "a planar node",
}


def infer_nodes(attachments: Sequence[Attachment]) -> tuple[tuple[NetworkNode, ...], list[Diagnostic]]:
    """Return the nodes in order of appearance, with every contradiction found.

    A node touched by a planar element, or named with ``.y`` or ``.theta``, is planar; translational
    elements then act on y and rotational ones on theta. Otherwise all elements must agree.
    """
    problems: list[Diagnostic] = []
    first: dict[str, Attachment] = {}
    claims: dict[str, dict[str, Attachment]] = {}
    for attachment in attachments:
        reference = attachment.reference
        if reference.is_ground:
            continue
        first.setdefault(reference.node, attachment)
        claim = "planar" if reference.component else attachment.domain
        claims.setdefault(reference.node, {}).setdefault(claim, attachment)
    nodes: dict[str, NetworkNode] = {}
    for name, claimed in claims.items():
        span = first[name].reference.span
        definite = [d for d in claimed if d in DOMAINS]
        if "planar" in claimed:
            if "electrical" in claimed:
                one, other = (d for d in claimed if d in ("planar", "electrical"))
                problems.append(_contradiction(name, claimed[one], claimed[other]))
            nodes[name] = NetworkNode(name, "planar", span)
            continue
        for other in definite[1:]:
            problems.append(_contradiction(name, claimed[definite[0]], claimed[other]))
        if definite:
            nodes[name] = NetworkNode(name, definite[0], span)
    _spread(attachments, nodes, first)
    return tuple(nodes[name] for name in first), problems


def _spread(
    attachments: Sequence[Attachment], nodes: dict[str, NetworkNode], first: dict[str, Attachment]
) -> None:
    """Give nodes that only couplings touch a domain that suits the ratio's unit (translation at last)."""
    waiting: dict[str, list[int]] = {}
    for i, attachment in enumerate(attachments):
        if attachment.coupling is not None and not attachment.reference.is_ground:
            waiting.setdefault(attachment.coupling.partner.node, []).append(i)
    ready = [i for node in nodes for i in waiting.get(node, ())]
    heapify(ready)
    while ready:
        attachment = attachments[heappop(ready)]
        name, coupling = attachment.reference.node, attachment.coupling
        if coupling is None or name in nodes:
            continue
        domain = coupling.suggested(domain_of(coupling.partner, nodes[coupling.partner.node]))
        nodes[name] = NetworkNode(name, domain, first[name].reference.span)
        for i in waiting.get(name, ()):
            heappush(ready, i)
    for name, attachment in first.items():
        nodes.setdefault(name, NetworkNode(name, "translation", attachment.reference.span))


def domain_of(reference: NodeReference, node: NetworkNode) -> Domain:
    """Return the domain a one-variable port sees at a node; a bare planar node is its deflection y."""
    if node.domain == "planar":
        return "rotation" if reference.component == "theta" else "translation"
    return node.domain


def variable_of(reference: NodeReference, node: NetworkNode, domain: PortDomain) -> Variable:
    """Return the across variable a port of the given domain acts on."""
    if node.domain != "planar":
        return Variable("node", node.name)
    component = reference.component or ("theta" if domain == "rotation" else "y")
    return Variable("node", node.name, component)


def _contradiction(name: str, one: Attachment, other: Attachment) -> Diagnostic:
    claims = ["planar" if a.reference.component else a.domain for a in (one, other)]
    hint = (
        "use two nodes and couple them, with a transformer for instance; a node that both moves and turns "
        "is planar: name its parts with .y and .theta"
    )
    if "electrical" in claims:
        hint = "use two nodes and couple them, with a dc_motor or a gyrator for instance"
    return Diagnostic(
        "SF220",
        f"node '{name}' is {WORDS[claims[0]]} for {one.who} and {WORDS[claims[1]]} for {other.who}",
        other.reference.span,
        hint,
    )
