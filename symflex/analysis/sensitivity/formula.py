"""The derivative of a root with respect to a parameter, as a formula."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy

if TYPE_CHECKING:
    from collections.abc import Sequence


def sensitivity_formula(
    den: sympy.Expr,
    where: Sequence[tuple[sympy.Symbol, sympy.Expr]],
    s: sympy.Symbol,
    parameter: sympy.Symbol,
) -> tuple[sympy.Expr, sympy.Expr]:
    """Return numerator and denominator of ``ds/dp = -(d den/dp)/(d den/ds)`` at simple roots of ``den``.

    Factors that do not hold the parameter, whose roots stay where they are, and factors that are zero at
    s = 0 only are left out; of a power, its base is taken. Where nothing is left, no root moves: 0 and 1.

    Parameters
    ----------
    den : Expr
        A denominator or numerator.
    where : sequence of (Symbol, Expr)
        Names that stand for expressions, to be put in.
    s, parameter : Symbol
        What ``den`` is differentiated by.

    Examples
    --------
    >>> s, m, k = sympy.symbols("s m k")
    >>> sensitivity_formula(s * (m * s**2 + k) ** 2, (), s, k)
    (-1, 2*m*s)
    """
    kept = sympy.Integer(1)
    for factor in sympy.Mul.make_args(den):
        opened = _opened(factor, where)
        base, exponent = opened.as_base_exp()
        if exponent.is_Integer and exponent > 0:
            opened = base
        if opened.has(parameter) and opened.has(sympy.Add):
            kept *= opened
    slope = sympy.diff(kept, s)
    return (sympy.Integer(0), sympy.Integer(1)) if slope == 0 else (-sympy.diff(kept, parameter), slope)


def _opened(expression: sympy.Expr, where: Sequence[tuple[sympy.Symbol, sympy.Expr]]) -> sympy.Expr:
    # Lines may stand in any order, but none goes round in a circle.
    while any(expression.has(name) for name, _ in where):
        expression = expression.subs(where)
    return expression
