"""Values of printed expressions in mpmath numbers: a second reader of the grammar.

Python reads the text once ``^`` is ``**``; only arithmetic, names and the grammar's functions are allowed.
"""

from __future__ import annotations

import ast
import operator
from typing import TYPE_CHECKING, Any

import mpmath

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

Number = Any  # mpmath's numbers have no types

FUNCTIONS: dict[str, Callable[[Number], Number]] = {
    name: getattr(mpmath, name)
    for name in ("sqrt", "exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "atan")
}
OPERATORS: dict[type[ast.operator], Callable[[Number, Number], Number]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}


def evaluate(text: str, values: Mapping[str, Number], where: Sequence[tuple[str, str]] = ()) -> Number:
    """Return the value of a printed expression.

    Parameters
    ----------
    text : str
        The expression.
    values : mapping
        What s and the parameters are.
    where : sequence of (name, expression)
        The closed names, in any order.

    Raises
    ------
    ValueError
        When the text contains anything else than arithmetic.

    Examples
    --------
    >>> print(evaluate("-2*C^2/m", {"m": mpmath.mpf(4)}, [("C", "cosh(0) + 1")]))
    -2.0
    """
    known = dict(values)
    open_names = dict(where)

    def value(node: ast.expr) -> Number:
        match node:
            case ast.BinOp():
                return OPERATORS[type(node.op)](value(node.left), value(node.right))
            case ast.UnaryOp(op=ast.USub()):
                return -value(node.operand)
            case ast.Call(func=ast.Name(id=name), args=[argument]) if name in FUNCTIONS:
                return FUNCTIONS[name](value(argument))
            case ast.Constant(value=int()):
                return mpmath.mpf(node.value)
            case ast.Constant(value=float()):
                return mpmath.mpf(ast.get_source_segment(source, node))
            case ast.Name(id="pi"):
                return +mpmath.pi
            case ast.Name(id=name):
                if name not in known:
                    known[name] = evaluate(open_names[name], values, where)
                return known[name]
        message = f"not arithmetic: {ast.dump(node)}"
        raise ValueError(message)

    source = text.replace("^", "**")
    return value(ast.parse(source, mode="eval").body)


def distance_to_root(
    text: str, values: Mapping[str, Number], where: Sequence[tuple[str, str]], s: Number
) -> Number:
    """Return how far the root of a printed function near ``s`` is, relative to ``s``: one step of Newton's.

    Examples
    --------
    >>> mpmath.nstr(distance_to_root("m*s^2 - 2", {"m": mpmath.mpf(2)}, (), mpmath.mpf("1.001")), 3)
    '0.000999'
    """

    def function(at: Number) -> Number:
        return evaluate(text, {**values, "s": at}, where)

    h = s * mpmath.ldexp(1, -mpmath.mp.prec // 3)
    slope = (function(s + h) - function(s - h)) / (2 * h)
    return abs(function(s) / slope / s)
