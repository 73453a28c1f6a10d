"""The coefficients of a field's differential equation, read from its expression."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.errors import Diagnostic, ModelError
from symflex.expressions import Derivative, Expression, Name, Negative, Product, Quotient, Sum, nodes
from symflex.library.elements import Variable
from symflex.library.fields import FieldEquation

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from symflex.algebra import Factored
    from symflex.equations.evaluate import ExactEvaluator
    from symflex.expressions import Equation

Key = tuple[str, int] | Variable
Terms = dict[Key, "Factored"]


@dataclass(frozen=True, slots=True, eq=False)
class ReadEquation:
    """``sum(terms[u, k] * d^k u/dx^k) + sum(loads[v] * v) = 0``."""

    terms: Mapping[tuple[str, int], Factored]
    loads: Mapping[Variable, Factored]

    def named(self) -> FieldEquation:
        """Return the equation with its loads under the variables' names."""
        return FieldEquation(self.terms, {str(v): c for v, c in self.loads.items()})


def read_equation(equation: Equation, unknowns: Collection[str], evaluator: ExactEvaluator) -> ReadEquation:
    """Return the coefficients of an equation, linear in unknowns, their derivatives and loads."""
    terms: Terms = {}
    for side, sign in ((equation.left, 1), (equation.right, -1)):
        for key, value in _read(side, unknowns, evaluator).items():
            terms[key] = terms[key] + value * sign if key in terms else value * sign
    kept = {k: c for k, c in terms.items() if not c.is_zero}
    return ReadEquation(
        {k: c for k, c in kept.items() if not isinstance(k, Variable)},
        {k: c for k, c in kept.items() if isinstance(k, Variable)},
    )


def _read(expression: Expression, unknowns: Collection[str], evaluator: ExactEvaluator) -> Terms:
    one = evaluator.s**0
    match expression:
        case Name(name) if name in unknowns:
            return {(name, 0): one}
        case Derivative(name, order):
            return {(name, order): one}
        case Negative(operand):
            return {k: -c for k, c in _read(operand, unknowns, evaluator).items()}
        case Sum(terms):
            total: Terms = {}
            for term in terms:
                for key, value in _read(term, unknowns, evaluator).items():
                    total[key] = total[key] + value if key in total else value
            return total
        case Product(factors):
            varying = [f for f in factors if _varies(f, unknowns, evaluator)]
            scale = one
            for factor in factors:
                if factor not in varying:
                    scale = scale * evaluator.constant(factor)
            if len(varying) != 1:
                return _constant(expression, scale)
            return {k: c * scale for k, c in _read(varying[0], unknowns, evaluator).items()}
        case Quotient(numerator, denominator):
            below = evaluator.constant(denominator)
            if evaluator.vanishes(below):
                raise ModelError(Diagnostic("SF224", "division by zero", denominator.span))
            return {k: c / below for k, c in _read(numerator, unknowns, evaluator).items()}
    form = evaluator.linear(expression)
    return dict(form.terms)


def _constant(expression: Expression, value: Factored) -> Terms:
    if value.is_zero:
        return {}
    raise ModelError(Diagnostic("SF221", "the equation has a term without an unknown", expression.span))


def _varies(expression: Expression, unknowns: Collection[str], evaluator: ExactEvaluator) -> bool:
    """Tell whether an expression holds an unknown, an input or a signal."""

    def varies(node: Expression) -> bool:
        if not isinstance(node, Name):
            return isinstance(node, Derivative)
        return node.name in unknowns or evaluator.scope.lookup(node, constant=False).variable is not None

    return any(varies(node) for node in nodes(expression))
