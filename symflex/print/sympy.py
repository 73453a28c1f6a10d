"""Expressions and systems of SymPy, made only when a user asks for them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import sympy
from flint import fmpz_mpoly

from symflex.algebra import LAPLACE, Factored
from symflex.expressions import FUNCTIONS, Bessel, Call, Expression, Name, fold, substitute
from symflex.model import Model
from symflex.model.units import exact_expression
from symflex.state_space import not_rational
from symflex.transfer import BoundTransferFunction, TransferFunction

if TYPE_CHECKING:
    from sympy.physics.control import TransferFunction as SympyTransferFunction


def symbols_of(model: Model) -> dict[str, sympy.Symbol]:
    """Return one SymPy symbol per parameter, with its assumption; others are made without any."""
    symbols = {p.name: sympy.Symbol(p.name, **{p.assume: True}) for p in model.parameters}
    return symbols | {p.name: sympy.I for p in model.parameters if p.is_imaginary}


def to_sympy(expression: Expression, symbols: Mapping[str, sympy.Symbol]) -> sympy.Expr:
    """Return an expression in SymPy, in the same nesting; functions of x without a formula are undefined."""
    table = {**symbols, "pi": sympy.pi}

    def called(call: Call, argument: sympy.Expr) -> sympy.Expr:
        if isinstance(call, Bessel):
            index = sympy.Rational(call.index.numerator, call.index.denominator)
            return getattr(sympy, f"bessel{call.kind.lower()}")(index, argument)
        if call.name in FUNCTIONS:
            return getattr(sympy, call.name)(argument)
        function, x = sympy.Function(call.name), sympy.Dummy("x")
        return sympy.Subs(function(x).diff(x, call.order), x, argument) if call.order else function(argument)

    return fold(
        expression,
        number=lambda value: sympy.Rational(value.numerator, value.denominator),
        name=lambda name: table[name] if name in table else sympy.Symbol(name),
        power=lambda base, exponent: base ** to_sympy(exponent, symbols),
        call=called,
        total=lambda terms: sympy.Add(*terms),
        product=lambda factors: sympy.Mul(*factors),
    )


def sympy_system(function: TransferFunction | BoundTransferFunction) -> SympyTransferFunction:
    """Return numerator and denominator as polynomials in ``s`` with exact coefficients; SF235, SF501."""
    from sympy.physics.control import TransferFunction as SympyTransferFunction  # takes a while

    if not function.is_rational:
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
    images = {**symbols, LAPLACE: s, "pi": sympy.pi, **images}
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
