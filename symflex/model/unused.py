"""What a specification declares and nothing uses, which is all the trace that many a typing error leaves."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from symflex.errors import Diagnostic, Span, nearest
from symflex.expressions import Attribute, names
from symflex.library.blocks import ROOT
from symflex.library.elements import LineElement

if TYPE_CHECKING:
    from symflex.model.model import Definition, Model, PlacedElement

SHOWN = 4
A_SLIP = 5  # letters of a word in which one may be wrong, as in 'gripper' for 'griper'; two in twice as many
SHORTEST = 3  # letters of a word in which one wrong letter is a typing error: 'fl' and 'fr' are both meant
WORD = re.compile(r"\d+|[A-Z]?[a-z]+|[A-Z]+")  # the parts of a name: 'tip_left2' and 'tipLeft2' have three


def unused(model: Model) -> tuple[Diagnostic, ...]:
    """Return a warning for every loose node (SF650) and for every name that nothing uses (SF651)."""
    used = _uses(model)
    return (*_loose_nodes(model, used), *_unused_names(model, used))


def unnamed_definitions(model: Model) -> tuple[Definition, ...]:
    """Return the definitions that no expression names; a sum among them may stand in a print all the same."""
    used = _uses(model)
    return tuple(d for d in model.definitions if not used.get(d.name, set()) - {d.name})


def unused_name(kind: str, name: str, span: Span | None) -> Diagnostic:
    """Return the warning that nothing uses what bears a name."""
    hint = "remove it, or use it where you wrote another name by mistake"
    return Diagnostic("SF651", f"nothing uses {kind} '{name}'", span, hint, "warning")


def _uses(model: Model) -> dict[str, set[str]]:
    """Return, by name, the owners of the expressions it stands in."""
    used: dict[str, set[str]] = {}
    printed = [e for p in model.published for e in (p.expression, p.scale, *(e for _, e in p.where))]
    printed += [table.prints for table in model.tables]
    point = model.operating_point
    at_rest = () if point is None else (*(e for _, e in point.values), *point.equations)
    others = (("", e) for e in (*printed, *at_rest) if e is not None)
    for owner, expression in (*model.expressions(), *others):
        for n in names(expression):
            used.setdefault(n.owner if isinstance(n, Attribute) else n.name, set()).add(owner)
    return used


def _unused_names(model: Model, used: Mapping[str, set[str]]) -> Iterator[Diagnostic]:
    shared = {p.name for b in model.blocks if b.submodel is not None for p in b.submodel.parameters}
    shared |= {n for f in model.figures for n in (f.gain, *f.over)}
    for parameter in model.settable:
        if parameter.name not in shared and not used.get(parameter.name):
            yield unused_name("parameter", parameter.name, parameter.span)
    for source in model.inputs:
        if source.kind == "signal" and not used.get(source.name):
            yield unused_name("input", source.name, source.span)
    groups = (
        ("block", ((b.name, (b.name,), b.span) for b in model.blocks if b.block is not ROOT)),
        ("signal", ((x.name, (x.name,), x.span) for x in model.signals)),
        ("field", ((f.name, f.unknowns, f.span) for f in model.fields)),
    )
    # Conditions join two fields, whichever of them lists these.
    joined = {x for f in model.fields for n in f.unknowns for x in used.get(n, ()) if x != f.name}
    for kind, items in groups:
        for name, borne, span in items:
            users = {owner for n in borne for owner in used.get(n, ())} - {name}
            if not users and not (kind == "field" and name in joined):
                yield unused_name(kind, name, span)


def free_ends(model: Model) -> tuple[tuple[PlacedElement, str], ...]:
    """Return the ends of beams, rods and the like whose node nothing else in the model names."""
    read, touching = _named_nodes(model, _uses(model)), _touching(model)
    return tuple(
        (use, reference.node)
        for use in model.elements
        if isinstance(use.element, LineElement)
        for _, references in use.nodes
        for reference in references
        if not reference.is_ground and reference.node not in read and len(touching[reference.node]) == 1
    )


def _named_nodes(model: Model, used: Mapping[str, set[str]]) -> set[str]:
    return {*used, *(r.node for source in model.inputs for r in source.nodes)}


def _touching(model: Model) -> dict[str, dict[str, PlacedElement]]:
    """Return, by node, the elements that touch it."""
    touching: dict[str, dict[str, PlacedElement]] = {}
    for use in model.elements:
        for _, references in use.nodes:
            for reference in references:
                touching.setdefault(reference.node, {})[use.name] = use
    return touching


def _loose_nodes(model: Model, used: Mapping[str, set[str]]) -> Iterator[Diagnostic]:
    read, touching = _named_nodes(model, used), _touching(model)
    everything = [n.name for n in model.nodes]
    for node in model.nodes:
        uses = tuple(touching.get(node.name, {}).values())
        if node.name in read or not uses:
            continue
        joined = {r.node for use in uses for _, references in use.nodes for r in references} - {node.name}
        # Elements without mass that join two nodes carry nothing with one of them free.
        are_branches = all(
            not isinstance(use.element, LineElement) and [len(r) for _, r in use.nodes] == [2] for use in uses
        )
        ends = [r for use in uses for _, references in use.nodes for r in references if r.node == node.name]
        # What two ends of one element meet at, two windings in series for instance, is not loose either.
        if len(ends) > 1 and not (are_branches and len(joined) <= 1):
            continue
        others = [name for name in (*everything, "ground") if name != node.name and name not in joined]
        close = nearest(node.name, others)
        if isinstance(uses[0].element, LineElement):
            # The free end of a beam is usual: only what looks like another name was hardly meant.
            others = [name for name in others if _looks_like(node.name, name)]
            if not others:
                continue
            close = nearest(node.name, others)
        who = [f"{use.element.type_name} '{use.name}'" for use in uses]
        shown = " and ".join(who) if len(who) <= SHOWN else f"{who[0]} and {len(who) - 1} other branches"
        verb, change = ("touches", "it changes") if len(uses) == 1 else ("touch", "they change")
        end = f"{change} nothing" if are_branches else "that end is free"
        message = f"only {shown} {verb} node '{node.name}' and nothing reads it: {end}"
        hint = close or "attach something to it, or read it in an output"
        yield Diagnostic("SF650", message, node.span, hint, "warning")


def _looks_like(name: str, other: str) -> bool:
    """Tell whether one name is hardly meant beside another: the same letters, or one word with a slip.

    Numbers and short words tell nodes apart: 'tip_1' and 'tip_2', 'fl' and 'fr' are meant as they stand.
    """
    if name.lower().replace("_", "") == other.lower().replace("_", ""):
        return True
    one, two = ([word.lower() for word in WORD.findall(each)] for each in (name, other))
    if len(one) != len(two):
        return False
    different = [pair for pair in zip(one, two, strict=True) if pair[0] != pair[1]]
    return len(different) == 1 and _slipped(*different[0])


def _slipped(word: str, other: str) -> bool:
    """Tell whether two words have the same letters, but for one or, in long words, a few."""
    longest = max(len(word), len(other))
    if word.isdigit() or other.isdigit() or longest < SHORTEST:
        return False
    if sorted(word) == sorted(other):
        return True
    from difflib import SequenceMatcher  # most models have a use for all their names

    same = sum(block.size for block in SequenceMatcher(None, word, other).get_matching_blocks())
    return longest - same <= max(1, longest // A_SLIP)
