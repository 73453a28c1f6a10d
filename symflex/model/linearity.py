"""Whether an expression is linear in the unknowns and rational in the rest, told from its tree alone."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Literal

from symflex.algebra import FUNCTIONS, LAPLACE
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
    is_number,
    names,
)
from symflex.model.scope import outside, without_point

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from symflex.errors import Span
    from symflex.model.scope import ModelScope

Degree = Literal["constant", "linear", "unknown"]
"""What an expression is in what varies in time; ``unknown`` when it holds a name that means nothing."""

EXPONENT_LIMIT = 64
SHOWN_PROBLEMS = 20
ORDER_LIMIT = 24
"""Of a derivative at a point; what is beyond the field's own order follows from its equations."""
FUNCTION_HINT = "functions of s enter through [fields], through distributed elements, and as delays"
LINEARISE = "linearise about an operating point, so that only one factor varies in time"


def integer_exponent(exponent: Expression) -> int | None:
    """Return the value of an integer literal, possibly negated, or ``None``."""
    if isinstance(exponent, Negative):
        inner = integer_exponent(exponent.operand)
        return None if inner is None else -inner
    if isinstance(exponent, Number) and exponent.value.denominator == 1:
        return int(exponent.value)
    return None


def check_expression(expression: Expression, scope: ModelScope, *, constant: bool) -> list[Diagnostic]:
    """Return everything wrong with an expression apart from its units.

    Parameters
    ----------
    expression : Expression
        As parsed.
    scope : ModelScope
        The model's names.
    constant : bool
        True where no unknown may stand.
    """
    problems: list[Diagnostic] = []
    degree = _degree(expression, scope, constant, problems)
    if not constant and degree == "constant" and not problems and not is_number(expression, 0):
        problems.append(without_signal(expression.span))
    return problems


def check_equation(equation: Equation, scope: ModelScope) -> list[Diagnostic]:
    """Return everything wrong with an equation or condition of a field apart from its units.

    Parameters
    ----------
    equation : Equation
        As parsed.
    scope : ModelScope
        The model's names; :meth:`ModelScope.within` the field for one of its equations.
    """
    problems: list[Diagnostic] = []
    sides = (equation.left, equation.right)
    terms = [t for side in sides for t in (side.terms if isinstance(side, Sum) else (side,))]
    _degree(Sum(tuple(terms), span=equation.span), scope, False, problems)
    return problems


def without_signal(span: Span | None) -> Diagnostic:
    """Return the diagnostic of a constant that stands where something that varies in time must."""
    return Diagnostic(
        "SF221",
        "this is constant: there is no node, signal, element quantity or input in it",
        span,
        "a linear model is driven by its inputs alone; multiply by an input",
    )


def _degree(expression: Expression, scope: ModelScope, constant: bool, problems: list[Diagnostic]) -> Degree:
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
            return _sum_degree([(term, walk(term)) for term in terms if not is_number(term, 0)], problems)
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
            if is_number(denominator, 0):
                problems.append(Diagnostic("SF224", "division by zero", denominator.span))
            return _strongest([top, bottom])
        case Power(base, exponent):
            return _power_degree(expression, walk(base), exponent, problems)
        case Call():
            return _call_degree(expression, scope, constant, problems)
        case Derivative():
            return _derivative_degree(expression, scope, problems)
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
        half = isinstance(exponent, Quotient) or is_number(exponent, Fraction(1, 2))
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
            Diagnostic(
                "SF103",
                f"exponent {value} is larger than {EXPONENT_LIMIT}",
                exponent.span,
                "write a product of lower powers, in blocks of their own",
            )
        )
    if base == "linear" and value != 1:
        problems.append(
            Diagnostic(
                "SF222", "a power of a quantity that varies in time is not linear", power.span, LINEARISE
            )
        )
    return base


def _call_degree(call: Call, scope: ModelScope, constant: bool, problems: list[Diagnostic]) -> Degree:
    owner, dot, _ = call.name.partition(".")
    if owner in scope.broken and call.name not in (*FUNCTIONS, *scope.along):
        return "unknown"
    if dot and call.name not in scope.along:
        problems.append(_not_along(call, scope))
        return "unknown"
    if (call.name in scope.unknowns and call.name not in FUNCTIONS) or call.name in scope.along:
        return _value_degree(call, scope, constant, problems)
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
                'exp(-s*T) is the block { type = "delay", T = "T" }' if call.name == "exp" else FUNCTION_HINT,
            )
        )
    return inner


def _value_degree(call: Call, scope: ModelScope, constant: bool, problems: list[Diagnostic]) -> Degree:
    """Return the degree of a field at a point."""
    written = f"{call.name}{chr(39) * call.order}(...)"
    if scope.inside:
        message = f"{written} is the value at one point; the equations of a field hold at every x"
        hint = "write the unknown bare here; what holds at a point belongs in the conditions"
        problems.append(Diagnostic("SF241", message, call.span, hint))
        return "unknown"
    if constant:
        message = f"{written} varies in time; only parameters, definitions, s and pi may stand here"
        problems.append(Diagnostic("SF212", message, call.span))
        return "unknown"
    if call.order > ORDER_LIMIT:
        message = f"a derivative of order {call.order}; at most {ORDER_LIMIT} is allowed"
        hint = "the field's equation gives higher derivatives by lower ones"
        problems.append(Diagnostic("SF103", message, call.span, hint))
    _degree(call.argument, scope, True, problems)
    return "linear"


def _derivative_degree(derivative: Derivative, scope: ModelScope, problems: list[Diagnostic]) -> Degree:
    """Return the degree of a field differentiated along x and not evaluated."""
    name, span = derivative.name, derivative.span
    if name in scope.inside:
        return "linear"
    if name in scope.unknowns:
        written = name + "'" * derivative.order
        described = f"a derivative of an unknown of field '{scope.unknowns[name]}'"
        problem = outside(written, described, span) if scope.inside else without_point(name, written, span)
    elif name in scope.broken:
        return "unknown"
    elif scope.inside:
        hint = nearest(name, scope.inside) or "its unknowns: " + ", ".join(sorted(scope.inside))
        problem = Diagnostic("SF210", f"'{name}' is not an unknown of this field", span, hint)
    else:
        problem = _derivative(span)
    problems.append(problem)
    return "unknown"


def _derivative(span: Span | None) -> Diagnostic:
    message = "a derivative along x may be taken only of an unknown of [fields]"
    return Diagnostic("SF223", message, span, "a derivative in time is written with s: s*x")


def _not_along(call: Call, scope: ModelScope) -> Diagnostic:
    """Return the diagnostic of ``owner.name(...)`` where that is no quantity along x."""
    owner, _, name = call.name.partition(".")
    offered = [each for each in scope.along if each.partition(".")[0] == owner]
    if name in scope.owners.get(owner, ()) and not offered:
        hint = f"write '{call.name}*(...)' to multiply"
        return Diagnostic("SF210", f"'{call.name}' has no points along x", call.span, hint)
    if offered:
        hint = "it offers " + ", ".join(f"{each}(...)" for each in offered)
        return Diagnostic("SF210", f"'{owner}' has no quantity '{name}' along x", call.span, hint)
    hints = nearest(owner, {each.partition(".")[0] for each in scope.along})
    hints = hints or "a beam, rod, shaft or string has points along x"
    return Diagnostic("SF210", f"no element along x is called '{owner}'", call.span, hints)


def _unknown_function(call: Call, scope: ModelScope) -> Diagnostic:
    meanings = scope.meanings.get(call.name)
    if meanings:
        message = f"'{call.name}' is {meanings[0].described}, not a function"
        return Diagnostic("SF210", message, call.span, f"write '{call.name}*(...)' to multiply")
    hint = nearest(call.name, FUNCTIONS) or "functions: " + ", ".join(FUNCTIONS)
    return Diagnostic("SF210", f"unknown function '{call.name}'", call.span, hint)
