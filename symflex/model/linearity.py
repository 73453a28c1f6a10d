"""Whether an expression is linear in the unknowns and rational in the rest, told from its tree alone."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Literal

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
    from collections.abc import Iterable, Sequence

    from symflex.errors import Span
    from symflex.model.scope import Scope

Degree = Literal["constant", "linear", "unknown"]
"""What an expression is in what varies in time; ``unknown`` when it holds a name that means nothing."""

EXPONENT_LIMIT = 64
SHOWN_PROBLEMS = 20
LINEARISE = "linearise about an operating point, so that only one factor varies in time"


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
    if not constant and degree == "constant" and not problems and not _is_zero(expression):
        problems.append(without_signal(expression.span))
    return problems


def without_signal(span: Span | None) -> Diagnostic:
    """Return the diagnostic of a constant that stands where something that varies in time must."""
    return Diagnostic(
        "SF221",
        "this is constant: there is no node, signal, element quantity or input in it",
        span,
        "a linear model is driven by its inputs alone; multiply by an input",
    )


def _is_zero(expression: Expression) -> bool:
    return isinstance(expression, Number) and expression.value == 0


def _degree(expression: Expression, scope: Scope, constant: bool, problems: list[Diagnostic]) -> Degree:
    """Return the degree of an expression; note what is wrong."""

    def walk(node: Expression) -> Degree:
        return _degree(node, scope, constant, problems)

    match expression:
        case Number():
            return "constant"
        case Name() | Attribute():
            if len(problems) >= SHOWN_PROBLEMS:
                return "unknown"
            try:
                meaning = scope.lookup(expression, constant=constant)
            except SpecError as error:
                problems.extend(error.diagnostics)
                return "unknown"
            if meaning.kind == "broken":
                return "unknown"
            return "linear" if meaning.kind in ("variable", "through") else "constant"
        case Negative(operand):
            return walk(operand)
        case Sum(terms):
            return _sum_degree([(term, walk(term)) for term in terms if not _is_zero(term)], problems)
        case Product(factors):
            degrees = [walk(factor) for factor in factors]
            if degrees.count("linear") > 1:
                problems.append(
                    Diagnostic(
                        "SF222",
                        "a product of two quantities that vary in time is not linear",
                        expression.span,
                        LINEARISE,
                    )
                )
            return _strongest(degrees)
        case Quotient(numerator, denominator):
            top, bottom = walk(numerator), walk(denominator)
            if bottom == "linear":
                problems.append(
                    Diagnostic(
                        "SF222",
                        "division by a quantity that varies in time is not linear",
                        denominator.span,
                        LINEARISE,
                    )
                )
            if _is_zero(denominator):
                problems.append(Diagnostic("SF224", "division by zero", denominator.span))
            return _strongest([top, bottom])
        case Power(base, exponent):
            return _power_degree(expression, walk(base), exponent, problems)
        case Call():
            return _call_degree(expression, scope, constant, problems)
        case Derivative() | Equation():
            problems.append(_derivative(expression.span))
            return "unknown"
    message = f"unexpected expression {type(expression).__name__}"
    raise TypeError(message)


def _strongest(degrees: Iterable[Degree]) -> Degree:
    found = set(degrees)
    return "linear" if "linear" in found else "unknown" if "unknown" in found else "constant"


def _sum_degree(terms: Sequence[tuple[Expression, Degree]], problems: list[Diagnostic]) -> Degree:
    total = _strongest(degree for _, degree in terms)
    if total == "linear":
        problems += [
            Diagnostic(
                "SF221",
                "this term is constant and the others vary in time; a linear model has no constant terms",
                term.span,
                "leave it out, or multiply it by an input",
            )
            for term, degree in terms
            if degree == "constant"
        ]
    return total


def _power_degree(power: Power, base: Degree, exponent: Expression, problems: list[Diagnostic]) -> Degree:
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
                "write sqrt(x) for a square root" if half else "write one number, such as 2 or -1",
            )
        )
        return base
    if abs(value) > EXPONENT_LIMIT:
        problems.append(
            Diagnostic("SF103", f"exponent {value} is larger than {EXPONENT_LIMIT}", exponent.span)
        )
    if base == "linear" and value != 1:
        problems.append(
            Diagnostic(
                "SF222", "a power of a quantity that varies in time is not linear", power.span, LINEARISE
            )
        )
    return base


def _call_degree(call: Call, scope: Scope, constant: bool, problems: list[Diagnostic]) -> Degree:
    if call.name in scope.broken and call.name not in FUNCTIONS:
        return "unknown"
    if call.order:
        problems.append(_derivative(call.span))
        return "unknown"
    if call.name not in FUNCTIONS:
        problems.append(_unknown_function(call, scope))
        return "unknown"
    inner = _degree(call.argument, scope, constant, problems)
    if inner == "linear":
        message = f"{call.name} of a quantity that varies in time is not linear"
        problems.append(Diagnostic("SF222", message, call.span, LINEARISE))
        return "unknown"
    if any(isinstance(n, Name) and n.name == LAPLACE for n in names(call.argument)):
        problems.append(
            Diagnostic(
                "SF910",
                f"{call.name} of an expression in s is not available yet",
                call.span,
                "this version derives rational transfer functions",
            )
        )
    return inner


def _derivative(span: Span | None) -> Diagnostic:
    message = "a derivative along x may stand only in [fields]"
    return Diagnostic("SF223", message, span, "a derivative in time is written with s: s*x")


def _unknown_function(call: Call, scope: Scope) -> Diagnostic:
    meanings = scope.meanings.get(call.name)
    if meanings:
        message = f"'{call.name}' is {meanings[0].described}, not a function"
        return Diagnostic("SF210", message, call.span, f"write '{call.name}*(...)' to multiply")
    hint = nearest(call.name, FUNCTIONS) or "functions: " + ", ".join(FUNCTIONS)
    return Diagnostic("SF210", f"unknown function '{call.name}'", call.span, hint)
