"""Linear equations of motion as text and JSON: what ``[equations]`` and ``[energy]`` became.

Input: a resolved model. Output: equilibrium values, linear equations, matrices of mass, damping, stiffness.

    at equilibrium  x = x_0, i = i_0
    linear          m*s^2*x - 2*C*i_0^2/x_0^3*x + 2*C*i_0/x_0^2*i = 0
"""

from __future__ import annotations

from itertools import chain, repeat
from textwrap import wrap
from typing import TYPE_CHECKING

from flint import arb

from symflex.expressions import Equation, format_expression
from symflex.print.text import WIDTH

if TYPE_CHECKING:
    from symflex.model import Model
    from symflex.model.model import FoundValue

SOLVED = "solved at equilibrium: "
DIGITS = 6  # of values in a terminal
JSON_DIGITS = 15
MATRICES = ("mass", "damping", "stiffness")


def motion_json(model: Model) -> dict[str, object]:
    """Return the equations with, of nonlinear ones, the values at equilibrium and the matrices."""
    point = model.operating_point
    linear = _linear(model)
    document: dict[str, object] = {"equations": linear}
    if point is not None:
        document["operating_point"] = {name: format_expression(value) for name, value in point.values}
        if point.coordinates:
            document["coordinates"] = list(point.coordinates)
            document |= {
                name: [[format_expression(entry) for entry in row] for row in matrix]
                for name, matrix in zip(MATRICES, point.matrices, strict=True)
            }
    return document


def motion_text(model: Model) -> str:
    """Return the same as lines for a terminal."""
    point, lines = model.operating_point, list[str]()
    if point is not None and point.values:
        lines.append("  at equilibrium")
        lines += [f"    {name} = {format_expression(value)}" for name, value in point.values]
        shown = {format_expression(value) for _, value in point.values}
        own = [d for d in model.definitions if d.name in shown]
        lines += [f"    {d.name} = {format_expression(d.expression)}" for d in own]
    linear = _linear(model)
    lines += ["  linear equations"] if linear else ["  no [equations] and no [energy]"]
    for each in linear:
        lines += wrap(each, WIDTH, initial_indent="    ", subsequent_indent="      ")
    if point is not None and point.coordinates:
        for name, matrix in zip(MATRICES, point.matrices, strict=True):
            rows = [[format_expression(entry) for entry in row] for row in matrix]
            widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
            padded = [[e.rjust(w) for e, w in zip(row, widths, strict=True)] for row in rows]
            lines.append(f"  {name} matrix of {', '.join(point.coordinates)}")
            if sum(widths) + 2 * len(widths) < WIDTH:
                lines += ["    " + "  ".join(row) for row in padded]
                continue
            for i, row in enumerate(rows, 1):
                lines += [f"    ({i}, {j})  {entry}" for j, entry in enumerate(row, 1) if entry != "0"]
    return "\n".join(lines)


def solved_json(model: Model, digits: int = JSON_DIGITS) -> dict[str, object]:
    """Return the values that were solved for, each beside the declared one; nothing without any."""
    solved = _solved(model)
    if not solved:
        return {}
    from symflex.roots.root import real_json  # imports numpy

    entries = [
        {"name": v.name, **(real_json(v.ball, digits) or {}), "unit": unit, "declared": v.declared_text}
        for v, unit in solved
    ]
    return {"solved_at_rest": entries}


def solved_text(model: Model, digits: int = DIGITS, above: str | None = None) -> list[str]:
    """Return the same as lines for a terminal; a radius bounds the distance from the printed value."""
    shown = [f"{name} = {value}" for name, value in solved_values(model, digits)]
    heads = chain([SOLVED], repeat(" " * len(SOLVED)))
    lines = [f"  {head}{line}" for head, line in zip(heads, shown, strict=False)]
    return lines if above is None or not lines else [above, *lines]


def solved_values(model: Model, digits: int = DIGITS) -> list[tuple[str, str]]:
    """Return names and values that were solved for: ``0.516996 um (radius 6.0e-9 um, declared 0.1 um)``."""
    shown = []
    for v, own in _solved(model):
        unit = "" if own == "1" else own
        from symflex.roots.root import decimals  # imports numpy

        printed = decimals(v.ball, arb(0), digits).readable
        parts = (("", printed.re), ("radius ", printed.radius), ("declared ", v.declared_text))
        value, *more = (f"{word}{text} {unit}".rstrip() for word, text in parts if text is not None)
        shown.append((v.name, f"{value} ({', '.join(more)})"))
    return shown


def _solved(model: Model) -> list[tuple[FoundValue, str]]:
    """Return the values that were solved for with their units; that of an input has its unit."""
    point = model.operating_point
    if point is None:
        return []
    units = {format_expression(value): name for name, value in point.values}
    own = {source.name: source.unit for source in model.inputs}
    return [(v, v.unit or own.get(units.get(v.name, ""), "")) for v in point.found]


def _linear(model: Model) -> list[str]:
    point = model.operating_point
    equations = [x.expression for x in model.signals if isinstance(x.expression, Equation)]
    return [format_expression(e) for e in (equations if point is None else point.linear)]
