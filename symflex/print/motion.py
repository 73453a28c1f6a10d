"""Linear equations of motion as text and JSON: what ``[equations]`` and ``[energy]`` became.

Input: a resolved model. Output: values at rest, linear equations, matrices of mass, damping and stiffness.

    at rest   x = x_0, i = i_0
    linear    m*s^2*x - 2*C*i_0^2/x_0^3*x + 2*C*i_0/x_0^2*i = 0
"""

from __future__ import annotations

from textwrap import wrap
from typing import TYPE_CHECKING

from symflex.expressions import Equation, format_expression

if TYPE_CHECKING:
    from symflex.model import Model

MATRICES = ("mass", "damping", "stiffness")
WIDTH = 80  # columns of a terminal


def motion_json(model: Model) -> dict[str, object]:
    """Return the equations with, of nonlinear ones, the values at rest and the matrices."""
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
        lines.append("  at rest")
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


def _linear(model: Model) -> list[str]:
    point = model.operating_point
    equations = [x.expression for x in model.signals if isinstance(x.expression, Equation)]
    return [format_expression(e) for e in (equations if point is None else point.linear)]
