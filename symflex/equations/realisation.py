"""The states an expression is written with: what cancels between blocks in it is a hidden mode, not nothing.

Input: an expression as written, and an evaluator for its parts.
Output: the product of all denominators in s along its products, cancelled or not.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE, Factored, degree_in, least_common_multiple
from symflex.expressions import Expression, Name, Negative, Power, Product, Quotient, Sum

if TYPE_CHECKING:
    from symflex.equations.evaluate import Evaluator


def written_denominator(expression: Expression, evaluator: Evaluator) -> Factored:
    """Return the denominator in s of an expression before anything cancels.

    A product of blocks has the poles of every factor, also where a zero of the next one cancels them; a sum
    needs those of each term once.

    Parameters
    ----------
    expression : Expression
        As written; it has been evaluated without error before.
    evaluator : Evaluator
        For blocks and constant parts.
    """
    one = Factored.number(evaluator.ring, 1)
    match expression:
        case Name(name) if name in evaluator.blocks and evaluator.is_block(expression):
            return _in_s(evaluator.blocks[name].denominator())
        case Negative(operand):
            return written_denominator(operand, evaluator)
        case Product(factors):
            result = one
            for factor in factors:
                result = result * written_denominator(factor, evaluator)
            return result
        case Quotient(numerator, denominator):
            below = _in_s(evaluator.constant(denominator).numerator())
            return written_denominator(numerator, evaluator) * below
        case Power(base, exponent):
            n = int(evaluator.constant(exponent).unit)
            if n >= 0:
                return written_denominator(base, evaluator) ** n
            return _in_s(evaluator.constant(base).numerator()) ** -n
        case Sum(terms):
            return least_common_multiple(one, (written_denominator(t, evaluator) for t in terms))
    return one


def _in_s(value: Factored) -> Factored:
    """Return the factors that contain s."""
    s = value.ring.index[LAPLACE]
    return value.filter(lambda factor: bool(degree_in(factor, s)))
