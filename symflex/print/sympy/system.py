"""Exact transfer functions for SymPy's control package.

Input: a transfer function, with symbols or with numbers. Output: ``sympy.physics.control.TransferFunction``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy
from sympy.physics.control import TransferFunction as SympyTransferFunction

from symflex.algebra import LAPLACE
from symflex.expressions import Name, substitute
from symflex.model.units import exact_expression
from symflex.print.sympy.expression import symbols_of, to_sympy
from symflex.state_space import not_rational
from symflex.transfer import BoundTransferFunction

if TYPE_CHECKING:
    from collections.abc import Mapping

    from flint import fmpz_mpoly

    from symflex.algebra import Factored
    from symflex.expressions import Expression
    from symflex.transfer import TransferFunction

PI = "pi"


def sympy_system(function: TransferFunction | BoundTransferFunction) -> SympyTransferFunction:
    """Return numerator and denominator as polynomials in ``s`` with exact coefficients.

    Symbols bear the parameters' assumptions; numbers are rational, with pi and roots where the model has
    them. Raises ModelError: SF235 when it is not rational in s; BudgetError: SF501 when its polynomials are
    too large to be multiplied out.

    Examples
    --------
    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... parameters = {m = "2 kg", b = "0.1 N*s/m"}
    ... elements.body = {type = "mass", at = "x", m = "m"}
    ... elements.loss = {type = "damper", between = ["x", "ground"], b = "b"}
    ... inputs.F = {force = "x"}
    ... outputs.V = "s*x"
    ... ''')
    >>> (tf,) = pipeline.derive_all(model)
    >>> sympy_system(tf), sympy_system(pipeline.bind(tf))
    (TransferFunction(1, b + m*s, s), TransferFunction(10, 20*s + 1, s))
    """
    if function.is_distributed:
        raise not_rational(function.name)
    numbers: dict[str, Expression] = {}
    if isinstance(function, BoundTransferFunction):
        source = function.source
        numbers = {name: exact_expression(value) for name, value in function.values}
    else:
        source = function
    symbols = symbols_of(source.model)
    s = to_sympy(Name(LAPLACE), symbols)
    images = {c.generator: to_sympy(substitute(c.expression, numbers), symbols) for c in source.constants}
    images = {**symbols, LAPLACE: s, PI: sympy.pi, **images}
    ratio = function.ratio
    num, den = (_polynomial(part, images) for part in (ratio.numerator(), ratio.denominator()))
    return SympyTransferFunction(num, den, s)


def _polynomial(value: Factored, images: Mapping[str, sympy.Expr]) -> sympy.Expr:
    """Return a product of polynomials multiplied out, by powers of s."""
    polynomial: fmpz_mpoly = value.expand()
    names = value.ring.names
    parts: dict[int, list[sympy.Expr]] = {}
    for monomial, coefficient in polynomial.terms():
        factors = [images[n] ** int(e) for n, e in zip(names[1:], monomial[1:], strict=True) if e]
        parts.setdefault(int(monomial[0]), []).append(sympy.Mul(int(coefficient), *factors))
    s = images[LAPLACE]
    return sympy.Add(*(sympy.Add(*terms) * s**power for power, terms in parts.items()))
