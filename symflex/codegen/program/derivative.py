"""Derivatives of straight-line code in s or in parameters: forward differentiation, step by step.

Input: a :class:`~symflex.codegen.program.nodes.Straight`, and what to differentiate by.
Output: the same code with one more assignment for each that varies, and every value followed by its
derivatives. ``t = s + k; t*t`` becomes ``t = s + k; dt = 1; t*t, 1*t + t*1``, with factors of one left out:

    t_1 = k + s, values t_1*t_1    becomes    t_1 = k + s, values t_1*t_1, t_1 + t_1

The chain rule holds of every node, so the derivative of a composition is exact; its rounding errors are those
of the operations (Griewank and Walther, Evaluating Derivatives, 2008, chapter 3).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import reduce
from typing import Final

from symflex.algebra import LAPLACE
from symflex.codegen.program import nodes as tree

_TWO = tree.RealNumber(Fraction(2))
_OPAQUE = (tree.FundamentalMinors, tree.ScaledSum, tree.Solve)
_Slopes = dict[str, tree.CodeNode | None]  # derivatives of assigned names, None for those that vanish


def is_differentiable(code: tree.Straight) -> bool:
    """Tell whether every step of code has a derivative here: what follows or solves equations has none."""
    return not any(isinstance(node, _OPAQUE) for node in code.nodes())


def differentiated(code: tree.Straight, names: Sequence[str] = (LAPLACE,)) -> tree.Straight:
    """Return code whose values are those of ``code``, each followed by its derivatives in s or parameters.

    What does not vary has the derivative ``0``.
    """
    chains = [(_Along(name), name) for name in names]
    sections: list[tuple[tree.Assignment, ...]] = []
    for section in (code.constants, code.assignments):
        assignments: list[tree.Assignment] = []
        for a in section:
            assignments.append(a)
            for along, name in chains:
                slope = along.derivative(a.value)
                if slope is not None and not isinstance(slope, tree.RealNumber):
                    label = f"slope of {a.name}" + ("" if name == LAPLACE else f" in {name}")
                    assignments.append(tree.Assignment(label, slope))
                    slope = tree.Assigned(label)
                along.assigned[a.name] = slope
        sections.append(tuple(assignments))
    values: list[tree.CodeNode] = []
    for value in code.values:
        slopes = (along.derivative(value) for along, _ in chains)
        values += (value, *(slope or tree.RealNumber(Fraction(0)) for slope in slopes))
    return tree.Straight(sections[0], sections[1], tuple(values))


class _Along:
    """Derivatives in s or in a parameter, None where they are zero."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.assigned: _Slopes = {}  # of assigned names

    def derivative(self, node: tree.CodeNode) -> tree.CodeNode | None:
        """Return the derivative of an expression."""
        slope = self.derivative
        match node:
            case tree.Laplace():
                return tree.ONE if self.name == LAPLACE else None
            case tree.ParameterValue(name):
                return tree.ONE if self.name == name else None
            case tree.InverseLaplace():
                return tree.Negate(tree.Multiply((node, node))) if self.name == LAPLACE else None
            case tree.Assigned(name):
                return self.assigned.get(name)
            case tree.Item(tree.Assigned(name), position):
                inner = self.assigned.get(name)
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
            case tree.IntegerPower(base, exponent):
                inner = slope(base)
                lower = base if exponent == 2 else tree.IntegerPower(base, exponent - 1)  # noqa: PLR2004
                return inner and _product((tree.RealNumber(Fraction(exponent)), lower, inner))
            case tree.Divide(above, below):
                rise, fall = slope(above), slope(below)
                if fall is None:
                    return None if rise is None else tree.Divide(rise, below)
                change = tree.Negate(_product((tree.Divide(above, below), fall)))
                return tree.Divide(change if rise is None else tree.Add((rise, change)), below)
        return self._of_composed(node)

    def _of_composed(self, node: tree.CodeNode) -> tree.CodeNode | None:
        slope = self.derivative
        match node:
            case tree.LargerRoot(_, middle, product):  # of x^2 - 2*m*x + p, without cancellation
                rise, fall = slope(middle), slope(product)
                halves = [rise and _product((rise, node)), fall and tree.Negate(tree.Divide(fall, _TWO))]
                total = _total(halves)
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
        return None  # numbers


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
