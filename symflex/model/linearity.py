"""Whether an expression is linear in the unknowns and rational in the rest, told from its tree alone."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from symflex.errors import Diagnostic, SpecError
from symflex.errors.diagnostic import nearest
from symflex.expressions import (
    Attribute,
    Call,
    Derivative,
    Equation,
    Expression,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    names,
)
from symflex.kernels import FUNCTIONS, LAPLACE

if TYPE_CHECKING:
    from symflex.model.scope import Scope

EXPONENT_LIMIT = 64


def integer_exponent(exponent: Expression) -> int | None:
    """Return the value of an integer literal, possibly negated, or ``None``."""
    if isinstance(exponent, Negative):
        inner = integer_exponent(exponent.operand)
        return None if inner is None else -inner
    if isinstance(exponent, Number) and exponent.value.denominator == 1:
        return int(exponent.value)
    return None


def check_expression(expression: Expression, scope: Scope, *, constant: bool) -> list[Diagnostic]:
    """Return everything wrong with an expression apart from its units.

    Parameters
    ----------
    expression : Expression
        As parsed.
    scope : Scope
        The model's names.
    constant : bool
        True where no unknown may stand.
    """
    problems: list[Diagnostic] = []
    degree = _degree(expression, scope, constant, problems)
    if degree == "mixed" and not problems:
        problems.append(
            Diagnostic(
                "SF221",
                "the expression has a term without a node, signal or input; a linear model has none",
                expression.span,
            )
        )
    if not constant and degree == "constant" and not problems and not _is_zero(expression):
        problems.append(
            Diagnostic(
                "SF221",
                "the expression contains no node, signal, element quantity or input",
                expression.span,
                "only signals can drive a linear model; multiply by an input",
            )
        )
    return problems


def _is_zero(expression: Expression) -> bool:
    return isinstance(expression, Number) and expression.value == 0


def _degree(expression: Expression, scope: Scope, constant: bool, problems: list[Diagnostic]) -> str:
    """Return ``constant``, ``linear`` or ``mixed`` (a sum of both); note what is wrong."""

    def walk(node: Expression) -> str:
        return _degree(node, scope, constant, problems)

    match expression:
        case Number():
            return "constant"
        case Name() | Attribute():
            try:
                meaning = scope.lookup(expression, constant=constant)
            except SpecError as error:
                problems.extend(error.diagnostics)
                return "linear" if not constant else "constant"
            return "linear" if meaning.kind in ("variable", "through") else "constant"
        case Negative(operand):
            return walk(operand)
        case Sum(terms):
            degrees = {walk(term) for term in terms if not _is_zero(term)}
            return degrees.pop() if len(degrees) == 1 else ("mixed" if degrees else "constant")
        case Product(factors):
            moving = [d for d in (walk(factor) for factor in factors) if d != "constant"]
            if len(moving) > 1:
                problems.append(
                    Diagnostic(
                        "SF222",
                        "a product of two quantities that vary in time is not linear",
                        expression.span,
                        "linearise about an operating point; one factor must be constant",
                    )
                )
            return moving[0] if moving else "constant"
        case Quotient(numerator, denominator):
            top, bottom = walk(numerator), walk(denominator)
            if bottom != "constant":
                problems.append(
                    Diagnostic("SF222", "division by a quantity that varies in time", denominator.span)
                )
            if _is_zero(denominator):
                problems.append(Diagnostic("SF224", "division by zero", denominator.span))
            return top
        case Power(base, exponent):
            return _power_degree(expression, walk(base), exponent, problems)
        case Call():
            return _call_degree(expression, scope, problems)
        case Derivative() | Equation():
            problems.append(
                Diagnostic("SF223", "a derivative along x may stand only in [fields]", expression.span)
            )
            return "constant"
    message = f"unexpected expression {type(expression).__name__}"
    raise TypeError(message)


def _power_degree(power: Power, base: str, exponent: Expression, problems: list[Diagnostic]) -> str:
    value = integer_exponent(exponent)
    if value is None:
        half = isinstance(exponent, Quotient) or (
            isinstance(exponent, Number) and exponent.value == Fraction(1, 2)
        )
        problems.append(
            Diagnostic(
                "SF225",
                "an exponent must be an integer number",
                exponent.span or power.span,
                "write sqrt(x) for a square root" if half else None,
            )
        )
        return base
    if abs(value) > EXPONENT_LIMIT:
        problems.append(
            Diagnostic("SF103", f"exponent {value} is larger than {EXPONENT_LIMIT}", exponent.span)
        )
    if base != "constant" and value != 1:
        problems.append(
            Diagnostic("SF222", "a power of a quantity that varies in time is not linear", power.span)
        )
    return base


def _call_degree(call: Call, scope: Scope, problems: list[Diagnostic]) -> str:
    if call.name not in FUNCTIONS or call.order:
        problems.append(
            Diagnostic(
                "SF210",
                f"unknown function '{call.name}'",
                call.span,
                nearest(call.name, FUNCTIONS) or "functions: " + ", ".join(FUNCTIONS),
            )
        )
        return "constant"
    inner: list[Diagnostic] = []
    _degree(call.argument, scope, True, inner)
    problems.extend(inner)
    if any(isinstance(n, Name) and n.name == LAPLACE for n in names(call.argument)):
        problems.append(
            Diagnostic(
                "SF910",
                f"{call.name} of an expression in s is not available yet",
                call.span,
                "this version derives rational transfer functions",
            )
        )
    return "constant"
