"""Programs of the angular frequency, made shorter where it is positive.

Input: a :class:`Piecewise` program of the angular frequency in real arithmetic.
Output: the same without signs of what is positive: abs(omega) is omega there.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

from symflex.codegen.program import nodes as tree

if TYPE_CHECKING:
    from collections.abc import Callable

TWO = tree.RealNumber(Fraction(2))


def for_positive(program: tree.Piecewise) -> tree.Piecewise:
    """Return a program of the angular frequency as one for positive ones, with no power of j above one.

    Values stay the same to the last bit; signs and doublings go where they cost nothing.
    """
    tests = _each(program.tests, _positive)
    conditions = tuple(replace(c, quantity=_everywhere(c.quantity, _positive)) for c in program.conditions)
    turn, is_negative = (program.turn or 0) % 2, (program.turn or 0) > 1
    code = []
    for piece in program.code:
        if piece.is_complex:
            code.append(piece)
            continue
        own = _each(piece.code, _positive)
        if is_negative:
            num, den = own.values
            own = replace(own, values=_negated(num, den, {a.name for a in own.constants}))
        code.append(replace(piece, code=own))
    return replace(program, tests=tests, conditions=conditions, code=tuple(code), turn=turn)


def _each(code: tree.Straight, change: Callable[[tree.CodeNode], tree.CodeNode]) -> tree.Straight:
    return tree.Straight(
        tuple(tree.Assignment(a.name, _everywhere(a.value, change)) for a in code.constants),
        tuple(tree.Assignment(a.name, _everywhere(a.value, change)) for a in code.assignments),
        tuple(_everywhere(v, change) for v in code.values),
    )


def _everywhere(node: tree.CodeNode, change: Callable[[tree.CodeNode], tree.CodeNode]) -> tree.CodeNode:
    """Return an expression changed from the leaves up."""
    return change(node.with_children(_everywhere(c, change) for c in node.children))


def _positive(node: tree.CodeNode) -> tree.CodeNode:
    match node:
        case tree.Apply("abs", tree.Laplace()):
            return tree.Laplace()
        case tree.Multiply((factor, tree.Assigned() as x)) if factor == TWO:
            return tree.Add((x, x))
        case tree.Apply(
            function, tree.Negate(tree.Multiply((tree.RealNumber() | tree.ParameterValue() as first, *rest)))
        ):
            return tree.Apply(function, tree.Multiply((tree.Negate(first), *rest)))
    return node


def _negated(
    num: tree.CodeNode, den: tree.CodeNode, constants: set[str]
) -> tuple[tree.CodeNode, tree.CodeNode]:
    """Return numerator and denominator of minus a quotient; the sign goes to a number if there is one."""
    if (above := _signed(num, constants)) is not None:
        return above, den
    if (below := _signed(den, constants)) is not None:
        return num, below
    return tree.Negate(num), den


def _signed(node: tree.CodeNode, constants: set[str]) -> tree.CodeNode | None:
    """Return minus a product whose first factor is a number, ``None`` if it is no such product."""
    match node:
        case tree.RealNumber() | tree.ParameterValue():
            return tree.Negate(node)
        case tree.Assigned(name) if name in constants:
            return tree.Negate(node)
        case tree.Multiply((first, *rest)) if (changed := _signed(first, constants)) is not None:
            return tree.Multiply((changed, *rest))
    return None
