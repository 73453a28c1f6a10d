"""Colocated pairs: an output is the motion of what its input drives.

Input: a model. Output: the pairs of output and input whose rows of C and columns of B are the same in its
equations, up to a positive number and a power of s.

    (m s^2 + k) x = F,  V = s x         F acts on x alone, and V is s x: colocated

An input that acts on nodes stands in their balances. Where an output is that combination of the same nodes,
b^T x times s^k, the function is ``s^k b^T Z(s)^-1 b``: without damping, poles and zeros of such a function
alternate along the imaginary axis (Foster 1924), and feedback of a colocated rate only takes energy out.
"""

from __future__ import annotations

from symflex.algebra import LAPLACE, Factored
from symflex.equations import Equations
from symflex.library.elements import Variable
from symflex.model import Model
from symflex.transfer.of_model import assemble_for_checks


def colocated(model: Model) -> tuple[tuple[str, str], ...]:
    """Return the colocated pairs of a model's outputs and inputs, as its equations have them."""
    equations = assemble_for_checks(model)
    columns = {v.owner: _column(equations, v) for v in equations.inputs}
    pairs = []
    for row in equations.outputs:
        form = dict(row.form.terms)
        for source, column in columns.items():
            ratios = [form[v] / -column[v] for v in column if v in form]
            if not column or form.keys() != column.keys() or not row.divisor.is_one:
                continue
            if all((ratio / ratios[0]).is_one for ratio in ratios) and _is_rate(ratios[0]):
                pairs.append((row.name, source))
    return tuple(pairs)


def _column(equations: Equations, source: Variable) -> dict[Variable, Factored]:
    """Return what an input delivers to the balance of each node, negative; nothing if it acts elsewhere."""
    column: dict[Variable, Factored] = {}
    for row in equations.rows:
        for variable, coefficient in row.form.terms:
            if variable != source:
                continue
            if row.role != "balance" or row.about.kind != "node":
                return {}
            column[row.about] = coefficient
    return column


def _is_rate(ratio: Factored) -> bool:
    """Tell whether a ratio is a positive number times a power of s."""
    s = ratio.ring.generator(LAPLACE)
    return ratio.unit > 0 and all(factor == s for factor, _ in ratio.factors)
