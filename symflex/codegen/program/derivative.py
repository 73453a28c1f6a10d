"""Derivatives in s of straight-line code: forward differentiation, one assignment after another.

Input: a :class:`~symflex.codegen.program.nodes.Straight`.
Output: the same code with one more assignment for each that varies with s, and every value followed by its
derivative. ``t = s + k; t*t`` becomes ``t = s + k; dt = 1; t*t, 1*t + t*1``, with factors of one left out:

    t_1 = k + s, values t_1*t_1    becomes    t_1 = k + s, values t_1*t_1, t_1 + t_1

The chain rule holds of every node, so the derivative of a composition is exact; its rounding errors are those
of the operations (Griewank and Walther, Evaluating Derivatives, 2008, chapter 3).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import reduce
from typing import Final

from symflex.codegen.program import nodes as tree

_TWO = tree.RealNumber(Fraction(2))


def differentiated(code: tree.Straight) -> tree.Straight:
    """Return code whose values are those of ``code``, each followed by its derivative in s.

    Assignments of constants stay as they are; what does not vary with s has the derivative ``0``.
    """
    assigned: dict[str, tree.CodeNode | None] = {a.name: None for a in code.constants}
    assignments: list[tree.Assignment] = []
    for a in code.assignments:
        assignments.append(a)
        slope = _derivative(a.value, assigned)
        if slope is not None and not isinstance(slope, tree.RealNumber):
            assignments.append(tree.Assignment(f"slope of {a.name}", slope))
            slope = tree.Assigned(f"slope of {a.name}")
        assigned[a.name] = slope
    values: list[tree.CodeNode] = []
    for value in code.values:
        values += (value, _derivative(value, assigned) or tree.RealNumber(Fraction(0)))
    return tree.Straight(code.constants, tuple(assignments), tuple(values))


def _derivative(node: tree.CodeNode, assigned: dict[str, tree.CodeNode | None]) -> tree.CodeNode | None:
    """Return the derivative in s, None if it is zero; ``assigned`` has those of assigned names."""

    def slope(of: tree.CodeNode) -> tree.CodeNode | None:
        return _derivative(of, assigned)

    match node:
        case tree.Laplace():
            return tree.ONE
        case tree.InverseLaplace():
            return tree.Negate(tree.Multiply((node, node)))
        case tree.Assigned(name):
            return assigned[name]
        case tree.Item(tree.Assigned(name), position):
            inner = assigned[name]
            return None if inner is None else tree.Item(inner, position)
        case tree.Add(terms):
            return _total([slope(t) for t in terms])
        case tree.Negate(operand):
            inner = slope(operand)
            return None if inner is None else tree.Negate(inner)
        case tree.Multiply(factors):
            parts = [
                _product((*factors[:i], inner, *factors[i + 1 :]))
                for i, factor in enumerate(factors)
                if (inner := slope(factor)) is not None
            ]
            return _total(parts)
        case tree.Divide(above, below):
            rise, fall = slope(above), slope(below)
            if fall is None:
                return None if rise is None else tree.Divide(rise, below)
            change = tree.Negate(_product((tree.Divide(above, below), fall)))
            return tree.Divide(change if rise is None else tree.Add((rise, change)), below)
    return _of_composed(node, assigned)


_SLOPES: Final[dict[str, Callable[[tree.CodeNode, tree.CodeNode], tree.CodeNode]]] = {
    "exp": lambda node, x: node,
    "sqrt": lambda node, x: tree.Divide(tree.ONE, tree.Multiply((_TWO, node))),
    "log": lambda node, x: tree.Divide(tree.ONE, x),
    "sin": lambda node, x: tree.Apply("cos", x),
    "cos": lambda node, x: tree.Negate(tree.Apply("sin", x)),
    "sinh": lambda node, x: tree.Apply("cosh", x),
    "cosh": lambda node, x: tree.Apply("sinh", x),
    "tan": lambda node, x: tree.Add((tree.ONE, tree.Multiply((node, node)))),
    "tanh": lambda node, x: tree.Add((tree.ONE, tree.Negate(tree.Multiply((node, node))))),
    "atan": lambda node, x: tree.Divide(tree.ONE, tree.Add((tree.ONE, tree.Multiply((x, x))))),
}  # derivatives of elementary functions, from ``node``, the function of x, and x


def _of_composed(node: tree.CodeNode, assigned: dict[str, tree.CodeNode | None]) -> tree.CodeNode | None:
    def slope(of: tree.CodeNode) -> tree.CodeNode | None:
        return _derivative(of, assigned)

    match node:
        case tree.LargerRoot(_, middle, product):  # of x^2 - 2*m*x + p, without cancellation
            rise, fall = slope(middle), slope(product)
            total = _total([rise and _product((rise, node)), fall and tree.Negate(tree.Divide(fall, _TWO))])
            return total and tree.Divide(total, tree.Add((node, tree.Negate(middle))))
        case tree.RootFactor():
            return slope(node.spelled)
        case tree.ToComplex(operand) | tree.Within(operand):
            return slope(operand)
        case tree.Apply("abs"):  # sets a radius, or adds less than a rounding: both may be held
            return None
        case tree.Apply(function, argument):
            inner, outer = slope(argument), function.removeprefix("complex_")
            return inner and _product((_SLOPES[outer](node, argument), inner))
        case tree.Solutions(coefficients, terms):
            slopes = [slope(c) for c in coefficients]
            if not any(slopes):
                return None
            zero = tree.RealNumber(Fraction(0))
            return tree.SolutionSlopes(coefficients, tuple(x or zero for x in slopes), terms)
    return None  # numbers, parameters and their powers


def _total(terms: Sequence[tree.CodeNode | None]) -> tree.CodeNode | None:
    nonzero = tuple(t for t in terms if t is not None)
    return tree.Add(nonzero) if len(nonzero) > 1 else nonzero[0] if nonzero else None


def _product(factors: Sequence[tree.CodeNode]) -> tree.CodeNode:
    """Return a product without factors of one, the sign before it."""
    sign = reduce(lambda minus, f: minus ^ isinstance(f, tree.Negate), factors, False)
    plain = [f.operand if isinstance(f, tree.Negate) else f for f in factors]
    factors_kept = tuple(f for f in plain if f != tree.ONE) or (tree.ONE,)
    product = tree.Multiply(factors_kept) if len(factors_kept) > 1 else factors_kept[0]
    return tree.Negate(product) if sign else product
