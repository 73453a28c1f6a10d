"""What was read from an expression, compared with the expression: in numbers, at one random point.

Input: an expression, what it was read as over the exact ring, and the point of a prime field at which that
ring's generators have numbers. Output: nothing, or InternalError (SF991) where the two differ.

    "2*k*(x - y)", read as 2 k x - 2 k y    at k = 3, x = 5, y = 1 modulo a prime:  24 and 24

A value of the point is a number for every generator, unknown and derivative, and arithmetic is that of the
field: two rational functions that agree there are almost surely equal (Schwartz 1980, Zippel 1979).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import reduce
from random import Random

from symflex.algebra import Factored, residue
from symflex.errors import REPORT, BudgetError, Diagnostic, InternalError, ModelError, SymflexError
from symflex.expressions import Expression, Negative, Number, Power, Product, Quotient, Sum, format_expression
from symflex.library.elements import LinearForm
from symflex.model.linearity import integer_exponent

FAULT = "SF991"
Point = tuple["Mapping[str, int]", int]  # a number for every generator, and the prime


def compare(expression: Expression, read: int | None, leaf: Callable[[Expression], int], prime: int) -> None:
    """Compare what was read of an expression with its tree, unless either has no value; SF991 otherwise."""
    try:
        written = None if read is None else _number(expression, leaf, prime)
    except (KeyError, ZeroDivisionError):
        return
    if written is not None and (written - (read or 0)) % prime:
        message = f"'{format_expression(expression)[:200]}' was not read as it is written"
        raise InternalError(Diagnostic(FAULT, message, expression.span, REPORT))


def number_of(terms: Iterable[tuple[object, Factored]], point: Point) -> int | None:
    """Return the number a combination of unknowns is at a point, None if it has none there."""
    total = 0
    try:
        for unknown, value in terms:
            total += residue(value, *point) * at_random(unknown, point[1])
    except (KeyError, ZeroDivisionError):
        return None
    return total


def at_random(unknown: object, prime: int) -> int:
    """Return the number that stands for an unknown, the same in every run."""
    return Random(str(unknown)).randrange(1, prime)


def number_of_form(value: Factored | LinearForm, point: Point) -> int | None:
    """Return the number a value or a combination is at a point, None if it has none there."""
    if not isinstance(value, Factored):
        return number_of(value.terms, point)
    try:
        return residue(value, *point)
    except (KeyError, ZeroDivisionError):
        return None


def error_of(problems: Sequence[Diagnostic]) -> SymflexError:
    """Return the exception for problems met while equations are assembled: a fault of symflex comes first."""
    if faults := [problem for problem in problems if problem.code == FAULT]:
        return InternalError(*faults)
    is_budget = all(problem.code.startswith("SF5") for problem in problems)
    return (BudgetError if is_budget else ModelError)(*problems)


def _number(expression: Expression, leaf: Callable[[Expression], int], prime: int) -> int:
    def number(node: Expression) -> int:
        match node:
            case Number(exact):
                return exact.numerator * pow(exact.denominator, -1, prime) % prime
            case Negative(operand):
                return -number(operand)
            case Sum(terms):
                return sum(map(number, terms)) % prime
            case Product(factors):
                return reduce(lambda a, b: a * b % prime, map(number, factors), 1)
            case Quotient(above, below):
                return number(above) * _inverse(number(below), prime)
            case Power(base, exponent) if (count := integer_exponent(exponent)) is not None:
                value = number(base)
                return pow(value if count >= 0 else _inverse(value, prime), abs(count), prime)
        return leaf(node)

    return number(expression)


def _inverse(value: int, prime: int) -> int:
    if value % prime == 0:
        raise ZeroDivisionError
    return pow(value, -1, prime)
