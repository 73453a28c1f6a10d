"""Whether the names of a printed formula are known, told from its tree."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE
from symflex.errors import Diagnostic
from symflex.errors.diagnostic import nearest
from symflex.expressions import FUNCTIONS, Attribute, Call, Derivative, Expression, Name, Power, names, nodes
from symflex.model.points import Line

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence

    from symflex.model.model import Model, Published

NUMBERS = Line({}, frozenset(), frozenset(), {})
"""Knows the value of numbers alone."""


@dataclass(frozen=True, slots=True)
class Readable:
    """What the names of a model mean in its printed formulas."""

    constants: frozenset[str]  # ``s``, ``pi`` and parameters
    definitions: Mapping[str, Expression]  # the model's, which a ``where`` line of the same name hides
    varying: Mapping[str, str]  # what may not stand there, in words: nodes, blocks, signals, outputs, inputs
    broken: frozenset[str]  # names whose declaration holds a mistake of its own; nothing is said about them


def readable_names(model: Model, broken: Collection[str] = ()) -> Readable:
    """Return what the names of a model mean in its printed formulas."""
    kinds = (
        (model.nodes, "a node"),
        (model.blocks, "a block"),
        (model.signals, "a signal"),
        (model.outputs, "an output"),
        (model.inputs, "an input"),
    )
    return Readable(
        frozenset(p.name for p in model.parameters) | {LAPLACE, "pi"},
        {d.name: d.expression for d in model.definitions},
        {item.name: what for group, what in kinds for item in group},
        frozenset(broken),
    )


def check_printed(published: Published, readable: Readable) -> list[Diagnostic]:
    """Return everything wrong with the names and exponents of a printed formula.

    SF210 an unknown name or function, SF212 a name that may not stand there, SF215 lines that use each other
    in a circle, SF225 an exponent that is not a number.
    """
    known = {**readable.definitions, **dict(published.where)}
    roots = [published.expression, *([published.scale] if published.scale is not None else [])]
    problems: list[Diagnostic] = []
    for expression in (*roots, *(e for _, e in published.where)):
        problems += _name_problems(expression, known, readable)
        problems += _exponent_problems(expression)
    return problems or _circles(roots, known)


def _name_problems(
    expression: Expression, known: Collection[str], readable: Readable
) -> Iterator[Diagnostic]:
    for node in names(expression):
        if isinstance(node, Attribute | Derivative) or (isinstance(node, Call) and node.order):
            message = "only s, pi, parameters, definitions and 'where' names may stand in a printed formula"
            yield Diagnostic("SF212", message, node.span)
        elif node.name in readable.broken:
            continue
        elif isinstance(node, Call) and node.name not in FUNCTIONS:
            hint = nearest(node.name, FUNCTIONS) or "a product needs '*'"
            yield Diagnostic("SF210", f"unknown function '{node.name[:64]}'", node.span, hint)
        elif isinstance(node, Name) and node.name not in known and node.name not in readable.constants:
            yield _unknown(node, known, readable)


def _unknown(node: Name, known: Collection[str], readable: Readable) -> Diagnostic:
    described = readable.varying.get(node.name)
    if described is not None:
        message = f"'{node.name}' is {described}; a printed formula holds s and constants only"
        hint = "define it in 'where' if the print means something else"
        return Diagnostic("SF212", message, node.span, hint)
    close = nearest(node.name, {*known, *readable.constants})
    hint = f"{close} else define it in 'where'" if close else "define it in 'where'"
    return Diagnostic("SF210", f"unknown name '{node.name[:64]}' in a printed formula", node.span, hint)


def _exponent_problems(expression: Expression) -> Iterator[Diagnostic]:
    for part in nodes(expression):
        if isinstance(part, Power) and (names(part.exponent) or NUMBERS.value(part.exponent) is None):
            message = "an exponent in a printed formula is a rational number"
            yield Diagnostic("SF225", message, part.exponent.span or part.span)


def _circles(roots: Sequence[Expression], known: Mapping[str, Expression]) -> list[Diagnostic]:
    """Return the first circle among the lines that occur; the walk is not recursive, chains may be long."""
    done: set[str] = set()
    followed: list[str] = []
    pending = [(name, False) for root in reversed(roots) for name in reversed(_used(root, known))]
    while pending:
        name, is_left = pending.pop()
        if is_left:
            done.add(followed.pop())
        elif name in followed:
            circle = " -> ".join((*followed[followed.index(name) :], name))
            message = f"lines of a printed formula use each other in a circle: {circle}"
            return [Diagnostic("SF215", message, known[name].span)]
        elif name not in done:
            followed.append(name)
            pending.append((name, True))
            pending += [(other, False) for other in reversed(_used(known[name], known))]
    return []


def _used(expression: Expression, known: Collection[str]) -> list[str]:
    return [n.name for n in names(expression) if isinstance(n, Name) and n.name in known]
