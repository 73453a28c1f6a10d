"""How large a determinant would become when multiplied out, estimated before anything is.

Input: the equations and their elimination in nested form.
Output: about how many terms the expanded determinant has.
"""

from __future__ import annotations

from math import inf, log
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE, terms_of
from symflex.equations.elimination.straight_line import Step

if TYPE_CHECKING:
    from symflex.equations import Equations
    from symflex.equations.elimination.star_mesh import Elimination

LARGEST = 700.0
"""Logarithms beyond this overflow a double."""


def expanded_terms(equations: Equations, elimination: Elimination) -> float:
    """Return about how many terms the determinant has with its sub-impedances closed.

    The determinant of a network is the sum over its spanning forests (Kirchhoff 1847), each one term with
    coefficient one: with one for every sub-impedance and parameter its value is their number. Elsewhere
    signs may cancel, and it is an estimate. A determinant in few symbols has no more terms than these have
    monomials up to the degrees they can reach.

    Examples
    --------
    >>> from symflex import pipeline
    >>> from symflex.equations.elimination import eliminate
    >>> equations = pipeline.assemble(pipeline.loads('''
    ... symflex = 1
    ... parameters = {m_1 = {}, m_2 = {}, k = {}}
    ... elements.first = {type = "mass", at = "x", m = "m_1"}
    ... elements.second = {type = "mass", at = "y", m = "m_2"}
    ... elements.spring = {type = "spring", between = ["x", "y"], k = "k"}
    ... inputs.F = {force = "x"}
    ... outputs.X = "x"
    ... '''))
    >>> round(expanded_terms(equations, eliminate(equations, [("X", "F")])))
    3
    """
    exponent = min(_forests(elimination), _monomials(equations))
    return inf if exponent > LARGEST else 2.718281828459045**exponent


def _forests(elimination: Elimination) -> float:
    """Return the logarithm of the product of the pivots where every closed sum and generator is one."""
    program = elimination.program
    values: list[float] = []
    for i, (kind, args) in enumerate(zip(program.kinds, program.operands, strict=True)):
        if kind == Step.GENERATOR or program.roles.get(i) == "w":
            value = 1.0
        elif kind == Step.NUMBER:
            value = 1.0 if args[0] else 0.0
        elif kind == Step.ADD:
            value = sum(values[x] for x in args)
        elif kind == Step.MULTIPLY:
            value = 1.0
            for x in args:
                value *= values[x]
        elif kind == Step.DIVIDE:
            below = values[args[1]]
            value = values[args[0]] / below if below else 1.0
        elif kind == Step.NEGATE:
            value = -values[args[0]]
        else:
            value = values[args[0]] ** args[1]
        values.append(value)
    return sum(log(abs(values[x])) for x in elimination.pivots if values[x])


def _monomials(equations: Equations) -> float:
    """Return the logarithm of how many monomials the generators have, up to their degrees in all rows."""
    names = equations.ring.names
    degrees: dict[object, int] = {}
    for row in equations.rows:
        here: dict[object, int] = {}
        for _, coefficient in row.form.terms:
            for factor, exponent in coefficient.factors:
                terms = list(terms_of(factor))
                used = {i: e for monomial, _ in terms for i, e in monomial}
                if len(terms) > 1 and any(names[i] not in (LAPLACE, "pi") for i in used):
                    here[tuple(terms)] = max(here.get(tuple(terms), 0), exponent)
                    continue
                for i, e in used.items():
                    here[i] = max(here.get(i, 0), e * exponent)
        for key, degree in here.items():
            degrees[key] = degrees.get(key, 0) + max(degree, 0)
    return sum(log(1 + degree) for degree in degrees.values())
