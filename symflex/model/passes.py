"""What rewrites a draft on its way from text to model, one pass after another, in the order of ``PASSES``.

Input: a draft as it was read. Output: a draft in which frequencies are in radians, equations are linear,
fields have no brackets, nodes have a domain, and roots of s, delays and j are blocks and numbers.

Example: ``F = "k*x*exp(-s*T)"`` with T in ms passes all of them unchanged but that of delays, which names
``exp(-s*T)`` as a block ``delay_1``. A pass relies on those before it: motion is linear in what counts no
cycles any more, and delays are sought where roots of s are named.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from symflex.model.branches import with_branches
from symflex.model.declarations import one_of
from symflex.model.fields import read_fields, with_brackets_opened
from symflex.model.loss_factors import with_imaginary_unit
from symflex.model.network import infer_nodes
from symflex.model.reading import QuantityLiteral, Reader
from symflex.model.scope import COORDINATE
from symflex.model.units import constant_measure, declared_quantities
from symflex.model.written_delays import with_written_delays

if TYPE_CHECKING:
    from symflex.model.network import Draft
    from symflex.model.settings import Setting
    from symflex.model.spec import TableValue


@dataclass(frozen=True)
class Specified:
    """What a pass may look up besides the draft, and where it notes what is wrong."""

    reader: Reader
    sections: Mapping[str, TableValue | None]
    settings: Mapping[str, Setting]


def with_turns_read(given: Specified, draft: Draft) -> Draft:
    """Return a draft in which every frequency stands as it is meant."""
    quantities = declared_quantities(draft.declared, draft.inherited)
    literals = (d.expression for d in draft.definitions)
    written = [*quantities.values(), *(e.quantity for e in literals if isinstance(e, QuantityLiteral))]
    # A pitch that a block brings may be in radians by now; a formula may still divide it by 2 pi.
    written += [one_of(p.written_unit) for p in draft.inherited if p.written_unit]
    if not any(q is not None and q.cycles for q in written):
        return draft
    from symflex.model.cycles import converted  # few models need it

    draft, cycles = converted(given.reader, draft, quantities)
    return replace(draft, cycles=cycles)


def with_motion_linear(given: Specified, draft: Draft) -> Draft:
    """Return a draft whose equations of motion are linear, with the point at which they are."""
    if not any(given.sections[name] for name in ("equations", "operating_point", "energy")):
        return draft
    from symflex.model.energy import with_motion  # four modules that few models need

    draft, point = with_motion(
        given.reader, given.sections, draft, draft.constants, draft.cycles, given.settings
    )
    return replace(draft, point=point)


def with_fields(given: Specified, draft: Draft) -> Draft:
    """Return a draft with what ``[fields]`` says, without brackets with primes."""
    constants = draft.constants
    fields = read_fields(given.reader, given.sections["fields"], constants)
    has_coordinate = COORDINATE not in constants | draft.loads
    meant = tuple(f.rewritten(draft.cycles.read) for f in fields)
    return replace(draft, fields=with_brackets_opened(given.reader, meant, has_coordinate=has_coordinate))


def with_ports(given: Specified, draft: Draft) -> Draft:
    """Return a draft in which every port is at a node."""
    if not given.sections["ports"]:
        return draft
    from symflex.model.ports import with_port_nodes  # few models have one

    return with_port_nodes(given.reader, given.sections["ports"], draft)


def with_nodes(given: Specified, draft: Draft) -> Draft:
    """Return a draft in which every node has a domain, by what is attached to it."""
    measure = constant_measure(draft.declared, draft.inherited, draft.definitions)
    attached = [a for element in draft.elements for a in element.attachments(measure)]
    nodes, contradictions = infer_nodes([*attached, *(a for i in draft.inputs for a in i.attachments())])
    given.reader.take(contradictions)
    return replace(draft, nodes=nodes)


@dataclass(frozen=True)
class Pass:
    """A pass with what it is for."""

    name: str
    does: str
    apply: Callable[[Specified, Draft], Draft]


PASSES = (
    Pass("cycles", "f in Hz and n in rpm become 2 pi f, where the product has no 2 pi", with_turns_read),
    Pass("motion", "energies and equations become linear at the operating point", with_motion_linear),
    Pass("fields", "field equations are read, their brackets opened", with_fields),
    Pass("ports", "a port of an input and an output becomes a node", with_ports),
    Pass("nodes", "every node gets the domain of what is attached to it", with_nodes),
    Pass("roots of s", "s^(1/2), and exp of it, become blocks", lambda _, d: with_branches(d, d.names)),
    Pass("delays", "exp(-s*T) becomes a block", lambda _, d: with_written_delays(d, d.names)),
    Pass("imaginary unit", "j becomes a number", lambda given, d: with_imaginary_unit(given.reader, d)),
)


def rewritten(given: Specified, draft: Draft) -> Draft:
    """Return a draft after all passes."""
    for each in PASSES:
        draft = each.apply(given, draft)
    return draft
