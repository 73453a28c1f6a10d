"""From a printed formula, or a derived function, to an element of the exact field."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import prod

from symflex.algebra import Dispersion, Factored, Kernel
from symflex.audit.field import Arithmetic, GrowError, UnreadError, ground_of
from symflex.errors import BudgetError, Diagnostic, SpecError
from symflex.expressions import Call, Expression, Name, Negative, Number, Power, Product, Quotient, Sum
from symflex.model import Model, Published
from symflex.model.analysis import check_printed, lines_in_order, readable_names
from symflex.transfer import TransferFunction
from symflex.transfer.enclose import rational_value
from symflex.transfer.expansion import compose_rational

MOST_GROWTHS = 200


@dataclass(frozen=True)
class Formula:
    """A printed formula whose names are all known."""

    expression: Expression  # as printed
    scale: Expression | None  # what the print leaves out
    # The ``where`` lines and the model's definitions that occur, each after those it uses.
    lines: tuple[tuple[str, Expression], ...]
    parameters: frozenset[str]  # the model's parameters

    @property
    def whole(self) -> Expression:
        """The printed expression times the scale."""
        return self.expression if self.scale is None else Product((self.expression, self.scale))


def formula_of(published: Published, model: Model) -> Formula:
    """Return a printed formula with its lines in order; SpecError has every problem, each at its place."""
    problems = check_printed(published, readable_names(model))
    roots = [published.expression, *([published.scale] if published.scale is not None else [])]
    pending = [] if problems else [e for _, e in reversed(published.where)] + roots[::-1]
    while pending:
        part = pending.pop()
        pending.extend(part.children)
        # Stricter than when the model was read, where 2^2 is a number too: here it would be no exponent.
        if isinstance(part, Power) and rational_value(part.exponent, {}) is None:
            message = "an exponent in a printed formula is a rational number"
            problems.append(Diagnostic("SF225", message, part.exponent.span or part.span))
    if problems:
        raise SpecError(*problems)
    meanings = {d.name: d.expression for d in model.definitions} | dict(published.where)
    parameters = frozenset(p.name for p in model.parameters)
    occurring, _ = lines_in_order(roots, meanings)
    lines = tuple((name, meanings[name]) for name in occurring)
    return Formula(published.expression, published.scale, lines, parameters)


@dataclass(frozen=True, eq=False)
class FormulaReading:
    """A printed formula and a derived function over one field."""

    field: Arithmetic  # where both live
    formula: Formula  # the printed one
    lines: Mapping[str, Factored]  # values of its lines
    # printed and derived: values of both.
    printed: Factored
    derived: Factored

    def value(self, expression: Expression, hole: Expression | None = None) -> Factored:
        """Return the value of an expression of the formula, with ``hole`` (the very node) left open."""
        return _FormulaReader(self.field, self.lines, hole).value(expression)


def read(formula: Formula, tf: TransferFunction) -> FormulaReading:
    """Return both functions over the smallest field that contains them; UnreadError if there is none."""
    ground = ground_of([(p.name, p.assume != "real") for p in tf.model.parameters])
    for _ in range(MOST_GROWTHS):
        field = Arithmetic(ground)
        try:
            lines = formula_lines(field, formula)
            printed = _FormulaReader(field, lines).value(formula.whole)
            return FormulaReading(field, formula, lines, printed, derived_value(field, tf))
        except GrowError as more:
            ground = more.ground
    raise UnreadError("it has too many different roots and functions")


def formula_lines(field: Arithmetic, formula: Formula) -> dict[str, Factored]:
    """Return the values of a formula's lines."""
    lines: dict[str, Factored] = {}
    for name, expression in formula.lines:
        lines[name] = _FormulaReader(field, lines).value(expression)
    return lines


@dataclass(frozen=True)
class _FormulaReader:
    """Evaluates one expression."""

    field: Arithmetic
    lines: Mapping[str, Factored]
    hole: Expression | None = None

    def value(self, expression: Expression) -> Factored:
        try:
            return self._value(expression)
        except BudgetError as error:
            placed = (replace(d, span=d.span or expression.span) for d in error.diagnostics)
            raise BudgetError(*placed) from None

    def _value(self, expression: Expression) -> Factored:
        if expression is self.hole:
            return self.field.hole
        match expression:
            case Number(value):
                return self.field.number(value)
            case Name(name):
                line = self.lines.get(name)
                return self.field.name(name) if line is None else line
            case Negative(operand):
                return -self._value(operand)
            case Sum(terms):
                return sum((self._value(term) for term in terms), self.field.number(0))
            case Product(factors):
                return prod((self._value(factor) for factor in factors), start=self.field.number(1))
            case Quotient(numerator, denominator):
                divisor = self._value(denominator)
                if self.field.is_zero(divisor):
                    raise _division(denominator, expression)
                return self._value(numerator) / divisor
            case Power(base, exponent):
                power = rational_value(exponent, {}) or Fraction(0)
                inner = self._value(base)
                if power < 0 and self.field.is_zero(inner):
                    raise _division(base, expression)
                return self.field.power(inner, power)
            case Call(name, argument):
                return self._call(expression, name, self._value(argument))
        raise TypeError(f"unexpected expression {type(expression).__name__}")

    def _call(self, expression: Call, name: str, argument: Factored) -> Factored:
        try:
            return self.field.function(name, self.field.reduced(argument))
        except ZeroDivisionError:
            raise _division(expression, expression) from None


def _division(part: Expression, formula: Expression) -> SpecError:
    return SpecError(Diagnostic("SF224", "a printed formula divides by zero", part.span or formula.span))


def derived_value(field: Arithmetic, tf: TransferFunction) -> Factored:
    """Return a derived transfer function over the field."""
    ring, table = tf.ratio.ring, tf.kernels
    images = {name: field.name(name) for name in field.ground.names}
    for constant in tf.constants:
        if tf.ratio.depends_on(constant.generator):
            images[constant.generator] = _FormulaReader(field, {}).value(constant.expression)

    def image(factor_names: Sequence[str], value: Factored) -> Factored:
        chosen = [images.get(n) for n in factor_names]
        result = field.number(value.unit)
        for factor, exponent in value.factors:
            result = result * compose_rational(field.ring, factor, chosen) ** exponent
        return result

    for dispersion in table.dispersions:
        images.update(_wavenumbers(field, dispersion, lambda v: image(ring.names, v)))
    for kernel in table.kernels:
        if tf.ratio.depends_on(kernel.generator):
            images[kernel.generator] = _kernel(field, kernel, images, lambda v: image(ring.names, v))
    return image(ring.names, tf.ratio)


def _wavenumbers(
    field: Arithmetic, dispersion: Dispersion, image: Callable[[Factored], Factored]
) -> dict[str, Factored]:
    match dispersion.kind:
        case "bending":
            power, root = image(dispersion.characteristic[0]) / 4, Fraction(1, 4)
        case "wave":
            power, root = -image(dispersion.characteristic[0]), Fraction(1, 2)
        case "pair":
            middle, half = -image(dispersion.characteristic[2]) / 2, Fraction(1, 2)
            apart = field.power(field.reduced(middle * middle - image(dispersion.characteristic[0])), half)
            squares = (field.reduced(middle + apart), field.reduced(middle - apart))
            roots = (field.power(square, half) for square in squares)
            return dict(zip(dispersion.wavenumbers, roots, strict=True))
        case "exponential":
            return {}
        case _:
            raise UnreadError("the derived function has wavenumbers without a closed form")
    return {dispersion.wavenumbers[0]: field.power(power, root)}


def _kernel(
    field: Arithmetic, kernel: Kernel, images: Mapping[str, Factored], image: Callable[[Factored], Factored]
) -> Factored:
    length = image(kernel.length)
    if kernel.function == "exp":
        return field.function("exp", -image(kernel.dispersion.shift) * length)
    if kernel.function == "fundamental":
        raise UnreadError("the derived function has kernels without a closed form")
    return field.function(kernel.function, images[kernel.wavenumber] * length)
