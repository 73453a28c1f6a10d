"""Brackets with primes, opened by the product rule.

Input: an equation or condition of a field as it is read, and the names of unknowns.
Output: the same without brackets; coefficients that vary along x are expressions of the coordinate.

    (E*I*(1 - x/l)*w'')' = 0           E*I*(1 - x/l)*w''' - E*I/l*w'' = 0
    (E*I*(1 - x/l)*w'')'(l) = -F       E*I*(1 - l/l)*w'''(l) - E*I/l*w''(l) = -F
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

from symflex.errors import Diagnostic, Span
from symflex.expressions import (
    Call,
    Derivative,
    Differentiated,
    Equation,
    Expression,
    Name,
    Negative,
    Power,
    Product,
    Quotient,
    Sum,
    format_expression,
    negative,
    nodes,
    number,
    power,
    product_of,
    quotient,
    replace_node,
    replace_values,
    substitute,
    sum_of,
)
from symflex.model.linearity import integer_exponent
from symflex.model.scope import COORDINATE

OPENED_LIMIT = 3_000  # parts of an equation with its brackets opened: some hundred lines


def open_brackets(
    equation: Equation, unknowns: Collection[str], *, has_coordinate: bool, is_condition: bool
) -> tuple[Equation, list[Diagnostic]]:
    """Return an equation or condition without brackets that bear primes, and what is wrong with these."""
    # Where a model ``has_coordinate`` not, x is something else, and constant.
    if not any(isinstance(n, Differentiated) for n in nodes(equation)):
        return equation, []
    opener = _Opener(frozenset(unknowns), has_coordinate, is_condition)
    left, right = (opener.opened(side) for side in equation.children)
    if not opener.problems and len(nodes(left)) + len(nodes(right)) > OPENED_LIMIT:
        opener.refuse(equation.span)
    return (equation if opener.problems else Equation(left, right, span=equation.span)), opener.problems


def named_brackets(
    equations: Sequence[Equation], unknowns: Sequence[str]
) -> tuple[tuple[Equation, ...], tuple[str, ...]]:
    """Return equations in which what a bracket differentiates is an unknown of its own, and all unknowns."""
    # Its equation comes after the others. Brackets are opened where that would add to the order in x, or
    # leave an unknown without a derivative. No coefficient is differentiated then: ``(E*I*w'')'' = p``
    # becomes ``M'' = p`` and ``E*I*w'' = M``.
    opened, names = list(equations), list(unknowns)
    while bracket := next((n for e in opened for n in nodes(e) if isinstance(n, Differentiated)), None):
        name = f"({format_expression(bracket.operand)})"
        named = [
            *_with(opened, bracket, Derivative(name, bracket.order)),
            Equation(bracket.operand, Name(name)),
        ]
        if _order(named, [*names, name]) == _order(opened, names):
            opened, names = named, [*names, name]
        else:
            opener = _Opener(frozenset(names), has_coordinate=True, is_condition=False)
            opened = _with(opened, bracket, opener.opened(bracket))
    return tuple(opened), tuple(names)


def _with(equations: Sequence[Equation], old: Expression, new: Expression) -> list[Equation]:
    return [Equation(*(replace_node(side, old, new) for side in e.children), span=e.span) for e in equations]


def _order(equations: Sequence[Equation], unknowns: Sequence[str]) -> tuple[int, int]:
    """Return the order in x of a system, and how many unknowns have no derivative."""
    opener = _Opener(frozenset(unknowns), has_coordinate=True, is_condition=False)
    highest = dict.fromkeys(unknowns, 0)
    for node in (n for e in equations for side in e.children for n in nodes(opener.opened(side))):
        if isinstance(node, Derivative) and node.name in highest:
            highest[node.name] = max(highest[node.name], node.order)
    return sum(highest.values()), list(highest.values()).count(0)


@dataclass(frozen=True)
class _Opener:
    """Opens the brackets of one equation, and notes what is wrong with them."""

    unknowns: frozenset[str]
    has_coordinate: bool
    is_condition: bool
    problems: list[Diagnostic] = field(default_factory=list)
    coordinate: str = COORDINATE  # what is differentiated by

    def refuse(self, span: Span | None) -> None:
        """Note what grows too large."""
        message = f"more than {OPENED_LIMIT} terms when all derivatives are expanded"
        hint = "make the differentiated expression an unknown with an equation of its own"
        self.problems.append(Diagnostic("SF103", message, span, hint))

    def opened(self, expression: Expression) -> Expression:
        """Return an expression without brackets."""
        if not any(isinstance(n, Differentiated) for n in nodes(expression)):
            return expression
        match expression:
            case Differentiated():
                return self._bracket(expression)
            case Negative(operand):
                result = negative(self.opened(operand))
            case Sum(terms):
                result = sum_of([self.opened(t) for t in terms])
            case Product(factors):
                result = product_of([self.opened(f) for f in factors])
            case Quotient(above, below):
                result = Quotient(self.opened(above), self.opened(below))
            case _:
                message = (
                    "a bracket with primes may only be added, or multiplied by something without unknowns"
                )
                self.problems.append(Diagnostic("SF223", message, expression.span))
                return expression
        return _placed(result, expression.span)

    def _bracket(self, bracket: Differentiated) -> Expression:
        message = hint = ""
        if bracket.point is None and self.is_condition:
            message = "a bracket with primes varies along x; only its value at a point is allowed here"
            hint = f"evaluate it at a point: (...){chr(39) * bracket.order}(0)"
        fixed = [n for n in nodes(bracket.operand) if isinstance(n, Call) and n.name in self.unknowns]
        if fixed or (bracket.point is not None and not self.is_condition):
            message = "this is the value at one point; this place needs something that varies along x"
            hint = "leave the point out; what holds at a point belongs in the conditions"
        if message:
            location = fixed[0].span if fixed else bracket.span
            self.problems.append(Diagnostic("SF241", message, location, hint))
            return bracket
        slope = self._slope(bracket)
        if bracket.point is None or self.problems:
            return slope
        return _at(slope, bracket.point, self.unknowns, has_coordinate=self.has_coordinate)

    def _slope(self, bracket: Differentiated) -> Expression:
        """Return a bracket with its primes carried out."""
        inner = replace(self, is_condition=False)
        operand: Expression | None = inner.opened(bracket.operand)
        for _ in range(bracket.order):
            operand = None if operand is None else self.slope(operand)
            if operand is not None and len(nodes(operand)) > OPENED_LIMIT:
                self.refuse(bracket.span)
                return bracket
        return _placed(number(0) if operand is None else operand, bracket.span)

    def slope(self, expression: Expression) -> Expression | None:
        """Return the derivative along x, None if an expression is constant."""
        match expression:
            case Name(name) if name in self.unknowns:
                return Derivative(name, 1, span=expression.span)
            case Name(name) if name == self.coordinate and self.has_coordinate:
                return number(1)
            case Derivative(name, order):
                return Derivative(name, order + 1, span=expression.span)
            case Negative(operand):
                slope = self.slope(operand)
                return None if slope is None else negative(slope)
            case Sum(terms):
                slopes = [s for s in map(self.slope, terms) if s is not None]
                return sum_of(slopes) if slopes else None
            case Product(factors):
                return self._product(factors, expression.span)
            case Quotient(above, below):
                return self._quotient(above, below)
            case Power(base, exponent):
                return self._power(base, exponent)
            case Call(name, argument, 0) if name in SLOPES:
                slope = self.slope(argument)
                return None if slope is None else product_of([SLOPES[name](expression), slope])
        return None

    def _product(self, factors: tuple[Expression, ...], span: Span | None) -> Expression | None:
        terms = []
        for i, factor in enumerate(factors):
            slope = self.slope(factor)
            if slope is not None:
                others = (*factors[:i], *factors[i + 1 :])
                terms.append(_placed(product_of([*others, slope]), span))
        return sum_of(terms) if terms else None

    def _quotient(self, above: Expression, below: Expression) -> Expression | None:
        up, down = self.slope(above), self.slope(below)
        terms = [] if up is None else [quotient(up, below)]
        if down is not None:
            terms.append(negative(quotient(product_of([above, down]), power(below, 2))))
        return sum_of(terms) if terms else None

    def _power(self, base: Expression, exponent: Expression) -> Expression | None:
        slope, value = self.slope(base), integer_exponent(exponent)
        if slope is None or not value:
            return None  # an exponent that is no integer is noted with what is not opened
        lower = number(1) if value == 1 else power(base, value - 1) if value > 0 else None
        if lower is None:
            return negative(quotient(product_of([number(-value), slope]), power(base, 1 - value)))
        return product_of([number(value), lower, slope])


def slope_along_x(expression: Expression, name: str = COORDINATE) -> Expression | None:
    """Return the derivative of a coefficient along x, or in another name, None if it is constant."""
    return _Opener(frozenset(), has_coordinate=True, is_condition=False, coordinate=name).slope(expression)


def _at(
    expression: Expression, point: Expression, unknowns: Collection[str], *, has_coordinate: bool
) -> Expression:
    """Return what varies along x, at a point."""
    values: dict[Expression, Expression] = {
        n: Call(n.name, point, n.order, span=n.span) for n in nodes(expression) if isinstance(n, Derivative)
    }
    bare: dict[str, Expression] = {u: Call(u, point, span=expression.span) for u in unknowns}
    if has_coordinate:
        bare[COORDINATE] = point
    return substitute(replace_values(expression, values), bare)


def _placed(expression: Expression, span: Span | None) -> Expression:
    return expression if expression.span else replace(expression, span=span)


def _same(name: str) -> Callable[[Call], Expression]:
    return lambda call: Call(name, call.argument, span=call.span)


def _one_over(of: Callable[[Call], Expression]) -> Callable[[Call], Expression]:
    return lambda call: quotient(number(1), of(call))


SLOPES: Mapping[str, Callable[[Call], Expression]] = {
    "sqrt": _one_over(lambda call: product_of([number(2), call])),
    "exp": _same("exp"),
    "log": _one_over(lambda call: call.argument),
    "sin": _same("cos"),
    "cos": lambda call: negative(_same("sin")(call)),
    "tan": lambda call: sum_of([number(1), power(call, 2)]),
    "sinh": _same("cosh"),
    "cosh": _same("sinh"),
    "tanh": lambda call: sum_of([number(1), negative(power(call, 2))]),
    "atan": _one_over(lambda call: sum_of([number(1), power(call.argument, 2)])),
}
"""The derivatives of the functions, by what they are a call of."""
