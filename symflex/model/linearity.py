"""Whether an expression is linear in the unknowns and rational in the rest; its tree alone decides."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import partial
from typing import Literal

from symflex.algebra import FUNCTIONS, LAPLACE, Factored, Ring
from symflex.errors import Diagnostic, Span, SpecError, nearest
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
    fold,
    format_expression,
    is_number,
    names,
    names_among,
)
from symflex.model.scope import IN_TIME, ModelScope, outside, without_point

Degree = Literal["constant", "linear", "unknown"]
"""What an expression is in what varies in time; ``unknown`` when it contains a name that means nothing."""

EXPONENT_LIMIT = 64  # as in the text of an expression, see :mod:`symflex.expressions.limits`
SHOWN_PROBLEMS = 20  # more of one expression than anybody reads
ORDER_LIMIT = 24  # highest derivative at a point; those beyond a field's order follow from its equations
DELAY_HINT = "write a delay in [signals] as exp(-s*T), with T free of s, or as a block of type delay"
FUNCTION_HINT = "of s, roots of one a*s + b are available, and exp, sinh, cosh and tanh of their multiples"
NONLINEAR = frozenset(
    "sign sgn abs fabs sat saturate saturation min max floor ceil round mod deadzone backlash relay".split()
)
OPERATORS = frozenset("d der ddt diff dot deriv derivative velocity int integral integrate".split())
LINEARISE = "linearise about an operating point, so that only one factor varies in time"
AT_REST = "write it in [equations], and the values at equilibrium in [operating_point]: symflex linearises it"
RATIO = "a quotient of two is a transfer function: make the denominator an input, and the numerator an output"


def integer_exponent(exponent: Expression) -> int | None:
    """Return the value of an integer literal, possibly negated, or ``None``."""
    if isinstance(exponent, Negative):
        inner = integer_exponent(exponent.operand)
        return None if inner is None else -inner
    if isinstance(exponent, Number) and exponent.value.denominator == 1:
        return int(exponent.value)
    return None


def rational_exponent(exponent: Expression) -> Fraction | None:
    """Return the value of a literal such as 0.5, 3/2 or -1/2, or ``None``."""
    match exponent:
        case Number(value):
            return value
        case Negative(operand):
            inner = rational_exponent(operand)
            return None if inner is None else -inner
        case Quotient(Number(above), Number(below)) if below:
            return above / below
    return None


def factored_of(
    expression: Expression, ring: Ring, name: Callable[[str], Factored] | None = None
) -> Factored:
    """Return an expression as a quotient of polynomials; functions, and names by default, are generators."""

    def generator(name: str) -> Factored:
        return Factored.generator(ring, name)

    def raised(base: Factored, exponent: Expression) -> Factored:
        if (integer := integer_exponent(exponent)) is None:
            raise TypeError
        return base**integer

    number = partial(Factored.number, ring)
    named, text = name or generator, format_expression
    return fold(expression, number=number, name=named, power=raised, call=lambda c, _: generator(text(c)))


def check_expression(expression: Expression, scope: ModelScope, *, constant: bool) -> list[Diagnostic]:
    """Return everything wrong with an expression apart from its units; no unknown may stand in a constant."""
    degrees = _Degrees(scope, constant)
    degree = degrees.of(expression)
    if not constant and degree == "constant" and not degrees.problems and not is_number(expression, 0):
        problem = without_signal(expression.span)
        if any(n.name == LAPLACE for n in names(expression)):
            hint = "a function of s belongs in [definitions], or multiply by an input"
            problem = replace(problem, hint=hint)
        degrees.problems.append(problem)
    return degrees.problems


def check_equation(equation: Equation, scope: ModelScope, *, acts: bool = False) -> list[Diagnostic]:
    """Return everything wrong with an equation or condition of a field apart from its units."""
    degrees = _Degrees(scope, constant=False)
    sides = (equation.left, equation.right)
    terms = [t for side in sides for t in (side.terms if isinstance(side, Sum) else (side,))]
    degree = degrees.of(Sum(tuple(terms), span=equation.span))
    if acts and degree == "constant" and not degrees.problems:
        degrees.problems.append(without_signal(equation.span))
    return degrees.problems


def without_signal(span: Span | None) -> Diagnostic:
    """Return the diagnostic of a constant that stands where something that varies in time must."""
    message = "this is constant: there is no node, signal, element quantity or input in it"
    hint = "a linear model is driven by its inputs alone; multiply by an input"
    return Diagnostic("SF221", message, span, hint)


@dataclass(frozen=True)
class _Degrees:
    """Finds the degree of every part of an expression, and notes ``x*F`` (SF222) and ``x + 1`` (SF221)."""

    scope: ModelScope
    constant: bool
    problems: list[Diagnostic] = field(default_factory=list)

    @property
    def linearise(self) -> str:
        """What to do with a term that is not linear: fields have no operating point."""
        return LINEARISE if self.scope.inside or self.scope.unknowns else AT_REST

    def note(self, code: str, message: str, span: Span | None, hint: str | None = None) -> None:
        self.problems.append(Diagnostic(code, message, span, hint))

    def of(self, expression: Expression) -> Degree:
        match expression:
            case Number():
                return "constant"
            case Name() | Attribute():
                return self._name(expression)
            case Negative(operand):
                return self.of(operand)
            case Sum(terms):
                return self._sum([term for term in terms if not is_number(term, 0)])
            case Product(factors):
                degrees = [self.of(factor) for factor in factors]
                if degrees.count("linear") > 1:
                    message = "a product of two quantities that vary in time is not linear"
                    self.note("SF222", message, expression.span, self.linearise)
                return _strongest(degrees)
            case Quotient(numerator, denominator):
                top, bottom = self.of(numerator), self.of(denominator)
                if bottom == "linear":
                    message = "division by a quantity that varies in time is not linear"
                    hint = RATIO if top == "linear" else self.linearise
                    self.note("SF222", message, denominator.span, hint)
                if is_number(denominator, 0):
                    self.note("SF224", "division by zero", denominator.span)
                return _strongest([top, bottom])
            case Power():
                return self._power(expression)
            case Call():
                return self._call(expression)
            case Derivative():
                return self._derivative(expression)
        raise TypeError(f"unexpected expression {type(expression).__name__}")

    def _name(self, expression: Name | Attribute) -> Degree:
        if len(self.problems) >= SHOWN_PROBLEMS:
            return "unknown"
        try:
            kind = self.scope.lookup(expression, constant=self.constant).kind
        except SpecError as error:
            self.problems.extend(error.diagnostics)
            return "unknown"
        if kind == "broken":
            return "unknown"
        return "linear" if kind in ("variable", "through") else "constant"

    def _sum(self, terms: Sequence[Expression]) -> Degree:
        degrees = [self.of(term) for term in terms]
        total = _strongest(degrees)
        for term, degree in zip(terms, degrees, strict=True):
            if total == "linear" and degree == "constant":
                message = (
                    "this term is constant and the others vary in time; a linear model has no constant terms"
                )
                self.note("SF221", message, term.span, "leave it out, or multiply it by an input")
        return total

    def _power(self, power: Power) -> Degree:
        base, exponent = self.of(power.base), power.exponent
        value = integer_exponent(exponent)
        if value is None:
            half = isinstance(exponent, Quotient) or is_number(exponent, Fraction(1, 2))
            hint = "write sqrt(x) for a square root" if half else "write one number, such as 2 or -1"
            if names_among(power.base, (LAPLACE,)):
                hint = "of s, write one number over at most 12, as s^0.5; all roots are of one a*s + b"
            elif isinstance(power.base, Name | Number) and names_among(exponent, (LAPLACE,)):
                hint = "an exponential function is exp(...), as in exp(-s*T)"
            self.note("SF225", "an exponent must be an integer number", exponent.span or power.span, hint)
            return base
        if abs(value) > EXPONENT_LIMIT:
            message = f"exponent {value} is larger than {EXPONENT_LIMIT}"
            hint = "write a product of lower powers, in blocks of their own"
            self.note("SF103", message, exponent.span, hint)
        if base == "linear" and value != 1:
            message = "a power of a quantity that varies in time is not linear"
            self.note("SF222", message, power.span, self.linearise)
        return base

    def _call(self, call: Call) -> Degree:
        scope = self.scope
        owner, dot, _ = call.name.partition(".")
        if owner in scope.broken and call.name not in (*FUNCTIONS, *scope.along):
            return "unknown"
        if dot and call.name not in scope.along:
            self.problems.append(_not_along(call, scope))
            return "unknown"
        if (call.name in scope.unknowns and call.name not in FUNCTIONS) or call.name in scope.along:
            return self._value(call)
        if call.order:
            self.problems.append(_derivative(call.span))
            return "unknown"
        if call.name not in FUNCTIONS:
            self.problems.append(_unknown_function(call, scope))
            return "unknown"
        inner = self.of(call.argument)
        if inner == "linear":
            message = f"{call.name} of a quantity that varies in time is not linear"
            self.note("SF222", message, call.span, self.linearise)
            return "unknown"
        if names_among(call.argument, (LAPLACE,)):
            message = f"{call.name} of an expression in s is not available yet"
            self.note("SF910", message, call.span, DELAY_HINT if call.name == "exp" else FUNCTION_HINT)
        return inner

    def _value(self, call: Call) -> Degree:
        """Return the degree of a field at a point."""
        written = f"{call.name}{chr(39) * call.order}(...)"
        if self.scope.inside:
            message = f"{written} is the value at one point; the equations of a field hold at every x"
            hint = "write the unknown without a point here; what holds at a point belongs in the conditions"
            self.note("SF241", message, call.span, hint)
            return "unknown"
        if self.constant:
            message = f"{written} varies in time; only parameters, definitions, s and pi are allowed here"
            self.note("SF212", message, call.span)
            return "unknown"
        if call.order > ORDER_LIMIT:
            message = f"this derivative is of order {call.order}; at most {ORDER_LIMIT} is allowed"
            hint = "the field's equation gives higher derivatives by lower ones"
            self.note("SF103", message, call.span, hint)
        replace(self, constant=True).of(call.argument)
        return "linear"

    def _derivative(self, derivative: Derivative) -> Degree:
        """Return the degree of a field differentiated along x and not evaluated."""
        name, span, scope = derivative.name, derivative.span, self.scope
        if name in scope.inside:
            return "linear"
        if name in scope.unknowns:
            written = name + "'" * derivative.order
            described = f"a derivative of an unknown of field '{scope.unknowns[name]}'"
            problem = (
                outside(written, described, span) if scope.inside else without_point(name, written, span)
            )
        elif name in scope.broken:
            return "unknown"
        elif scope.inside:
            hint = nearest(name, scope.inside) or "its unknowns: " + ", ".join(sorted(scope.inside))
            problem = Diagnostic("SF210", f"'{name}' is not an unknown of this field", span, hint)
        else:
            problem = _derivative(span)
        self.problems.append(problem)
        return "unknown"


def _strongest(degrees: Iterable[Degree]) -> Degree:
    kinds = set(degrees)
    return "linear" if "linear" in kinds else "unknown" if "unknown" in kinds else "constant"


def _derivative(span: Span | None) -> Diagnostic:
    return Diagnostic("SF223", "only an unknown of [fields] has a derivative along x", span, IN_TIME)


def _not_along(call: Call, scope: ModelScope) -> Diagnostic:
    """Return the diagnostic of ``owner.name(...)`` where that is not a quantity along x."""
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
        hint = f"write '{call.name}*(...)' to multiply"
        hint += f"; {IN_TIME}" * (call.name == "d") + "; a node has no '(t)'" * (" node " in message)
        return Diagnostic("SF210", message, call.span, hint)
    if call.name.lower() in OPERATORS:
        hint = f"{IN_TIME}, and an integral x/s"
        return Diagnostic("SF210", f"unknown function '{call.name}'", call.span, hint)
    if call.name.lower() in NONLINEAR:
        hint = LINEARISE if scope.unknowns else AT_REST
        hint = f"of a parameter K it is sqrt(K^2); else {hint}" if "abs" in call.name.lower() else hint
        return Diagnostic("SF222", f"{call.name} is not linear", call.span, hint)
    hint = nearest(call.name, [*FUNCTIONS, *scope.unknowns]) or "functions: " + ", ".join(FUNCTIONS)
    hint += "; unknowns of fields: " + ", ".join(scope.unknowns) if scope.unknowns else ""
    return Diagnostic("SF210", f"unknown function '{call.name}'", call.span, hint)
