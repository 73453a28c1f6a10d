"""Equations turned round: some outputs are given, and as many inputs follow from them.

Input: the equations of a model, and pairs of an output that is imposed and an input that is free to follow.
Output: equations whose unknowns hold these inputs, and whose inputs are these outputs.

    before    m s^2 x - F = 0,  X = x            F given, X follows
    after     m s^2 x - F = 0,  x - X = 0        X given, F follows:  F/X = m s^2

Their determinant is that of the system bordered by the outputs' rows and the inputs' columns. Over that of
the system it is the determinant of the pairs' transfer functions (Schur 1917): where these are singular, the
equations are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import prod

from symflex.algebra import Factored
from symflex.equations.equations import Equations, OutputRow
from symflex.library.elements import EquationRow, LinearForm, Variable


def impose(equations: Equations, imposed: Sequence[tuple[str, str]]) -> Equations:
    """Return the equations with outputs given and inputs among the unknowns."""
    one = Factored.number(equations.ring, 1)
    rows = {row.name: row for row in equations.outputs}
    given = {v.owner: v for v in equations.inputs}
    freed = {u: given[u] for _, u in imposed}
    outputs = {y: Variable("input", y) for y, _ in imposed}
    laws = (
        EquationRow(Variable("value", y), rows[y].form + LinearForm.of((v, -rows[y].divisor)), "constraint")
        for y, v in outputs.items()
    )
    # What an output is multiplied by, but for its own filters, is no dynamics of what imposes it.
    cleared = equations.cleared
    if cleared is not None:
        cleared = prod((rows[y].divisor / rows[y].poles for y in outputs), start=cleared)
    answers = (OutputRow(u, LinearForm.of((v, one)), one, one) for u, v in freed.items())
    return replace(
        equations,
        unknowns=(*equations.unknowns, *freed.values()),
        inputs=(*(v for v in equations.inputs if v.owner not in freed), *outputs.values()),
        rows=(*equations.rows, *laws),
        outputs=(*(row for row in equations.outputs if row.name not in outputs), *answers),
        cleared=cleared,
    )
