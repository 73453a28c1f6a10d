"""From expressions to linear forms over the exact ring.

Also the states an expression is written with, the product of all denominators in s along its products: what
cancels between blocks in it is a hidden mode, not nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from math import isqrt, prod

from symflex.algebra import (
    LAPLACE,
    PRIME,
    Factored,
    Radicals,
    Ring,
    composed,
    degree_in,
    least_common_multiple,
    residue,
)
from symflex.equations.against_text import compare, number_of_form
from symflex.errors import BudgetError, Diagnostic, ModelError
from symflex.expressions import (
    Attribute,
    Call,
    Derivative,
    Expression,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    format_expression,
    names,
    names_among,
    substitute,
)
from symflex.library.blocks import StateSpaceBlock, TransferFunctionBlock
from symflex.library.elements import LinearForm, Variable
from symflex.model import ModelScope, PlacedBlock
from symflex.model.linearity import factored_of
from symflex.model.model import RootOfS

OPENED_PARTS = 1_000
OPENED_DEPTH = 200


def transfer_of(block: PlacedBlock, values: Mapping[str, Factored]) -> Factored:
    """Return the transfer function of a block that is no other model's, for values of s and its parameters.

    Raises ZeroDivisionError.

    >>> from symflex.library.blocks import BLOCKS
    >>> from symflex.model import PlacedBlock
    >>> ring = Ring(("s", "k"))
    >>> values = {name: Factored.generator(ring, name) for name in ring.names}
    >>> (transfer_of(PlacedBlock("G", BLOCKS["integrator"]), values) * values["s"] / values["k"]).is_one
    True
    """
    if block.formula is None:
        assert isinstance(block.block, StateSpaceBlock)
        return block.block.transfer(values)
    return factored_of(block.formula, values[LAPLACE].ring, values.__getitem__)


@dataclass(frozen=True)
class ExactEvaluator:
    """Evaluates the expressions of one model."""

    ring: Ring  # generators: s, parameters, definitions, pi and elementary functions of constants
    scope: ModelScope  # what names mean
    blocks: Mapping[str, Factored]  # transfer functions of blocks, and of definitions that are no letters
    through: Mapping[Variable, LinearForm]  # the elements' through quantities
    definitions: Mapping[str, Expression]  # opened inside the arguments of functions
    point: Mapping[str, int] = field(default_factory=dict)  # random, of a prime field
    prime: int = PRIME
    fields: Collection[str] = ()  # the unknowns of fields
    radicals: Radicals | None = None  # relations of the roots among the generators
    field_value: Callable[[Call], LinearForm] | None = None  # of a field at a point
    # What calls of fields were found to be.
    states: dict[Expression, LinearForm] = field(default_factory=dict, repr=False)
    root: RootOfS | None = None  # where the ring's s stands for a root of s
    is_constant: bool = False  # where only constants may stand, a parameter may share its name with a node
    varying: Collection[str] = ()  # definitions that depend on s

    @cached_property
    def s(self) -> Factored:
        """The Laplace variable."""
        own = Factored.generator(self.ring, LAPLACE)
        if self.root is None:
            return own
        plain = replace(self, root=None, is_constant=True)
        return (own**self.root.order - plain.constant(self.root.shift)) / plain.constant(self.root.slope)

    @cached_property
    def opener(self) -> Opener:
        """Opens the definitions inside the arguments of functions."""
        return Opener(self.definitions)

    @cached_property
    def _of_constants(self) -> ExactEvaluator:
        return replace(self, is_constant=True)

    def along_x(self) -> ExactEvaluator:
        """Return the same for what may vary along x."""
        return replace(self, scope=self.scope.varying())

    def constant(self, expression: Expression) -> Factored:
        """Return the value of an expression without unknowns; SF224 division by zero, SF501 too large."""
        if not self.is_constant:
            return self._of_constants.constant(expression)
        value = self.value(expression)
        if isinstance(value, LinearForm):
            message = f"'{format_expression(expression)}' must be constant"
            raise ModelError(Diagnostic("SF212", message, expression.span))
        return value

    def linear(self, expression: Expression) -> LinearForm:
        """Return an expression of unknowns and inputs as a linear form; zero is the empty form."""
        value = self.value(expression)
        if isinstance(value, LinearForm):
            return value
        if value.is_zero:
            return LinearForm()
        raise ModelError(Diagnostic("SF221", "the expression has a term without an unknown", expression.span))

    @property
    def place(self) -> tuple[Mapping[str, int], int]:
        """The point, and its prime."""
        return self.point, self.prime

    @cached_property
    def is_decided(self) -> bool:
        """Whether values at the point decide what is equal: there roots of numbers are roots."""
        return bool(self.point) and (not self.radicals or self.radicals.point() is not None)

    def number_of_leaf(self, expression: Expression) -> int:
        """Return the number a name or a call is at the point; KeyError where it has none."""
        found = number_of_form(self._evaluate(expression), self.place)
        if found is None:
            raise KeyError
        return found

    def is_block(self, expression: Name) -> bool:
        """Tell whether a name is read as a block, or as a definition with poles."""
        kind = self.scope.lookup(expression, constant=False).kind
        return expression.name in self.blocks and kind in ("block", "definition")

    def value(self, expression: Expression) -> Factored | LinearForm:
        """Return the value of an expression, of constants or of unknowns."""
        try:
            value = self._evaluate(expression)
            if isinstance(value, LinearForm):
                value = without_squares(value, self.radicals)
            elif self.radicals:
                value = self.radicals.tidy(value)
            if expression.children and self.is_decided:
                compare(expression, number_of_form(value, self.place), self.number_of_leaf, self.prime)
            return value
        except BudgetError as error:
            located = (replace(d, span=d.span or expression.span) for d in error.diagnostics)
            raise BudgetError(*located) from None

    def _evaluate(self, expression: Expression) -> Factored | LinearForm:
        match expression:
            case Number(value):
                return Factored.number(self.ring, value)
            case Name() | Attribute():
                return self._name(expression)
            case Negative(operand):
                return self._evaluate(operand) * Factored.number(self.ring, -1)
            case Sum(terms):
                return self._sum(expression, terms)
            case Product(factors):
                result: Factored | LinearForm = Factored.number(self.ring, 1)
                for factor in factors:
                    result = _product(result, self._evaluate(factor), expression)
                return result
            case Quotient(numerator, denominator):
                divisor = self.constant(denominator)
                if self.vanishes(divisor):
                    raise ModelError(
                        Diagnostic("SF224", "division by zero", denominator.span or expression.span)
                    )
                return self._evaluate(numerator) * divisor**-1
            case Power(base, exponent):
                return self._power(expression, base, exponent)
            case Call(name) if name in self.fields and self.field_value is not None:
                if expression not in self.states:
                    self.states[expression] = self.field_value(expression)
                return self.states[expression]
            case Call(name, argument):
                return self._call(expression, name, argument)
            case Derivative(name, order):
                derivative = Variable("field", name, "'" * order)
                return LinearForm.of((derivative, Factored.number(self.ring, 1)))
        raise TypeError(f"unexpected expression {type(expression).__name__}")

    def _name(self, expression: Name | Attribute) -> Factored | LinearForm:
        is_shared = len(self.scope.meanings.get(expression.name, ())) > 1
        meaning = self.scope.lookup(expression, constant=self.is_constant and is_shared)
        if meaning.kind == "block" or (meaning.kind == "definition" and meaning.name in self.blocks):
            return self._block(expression, meaning.name)
        if meaning.kind == "through" and meaning.variable is not None:
            return self.through[meaning.variable]
        if meaning.variable is not None:
            return LinearForm.of((meaning.variable, Factored.number(self.ring, 1)))
        return self.s if meaning.name == LAPLACE else Factored.generator(self.ring, meaning.name)

    def _block(self, expression: Name | Attribute, name: str) -> Factored:
        if name not in self.blocks:
            # Only while kernels are surveyed: everywhere else every block has a value.
            message = "a delay inside a field's equation or a length is not available"
            hint = "wavenumbers would depend on it; a delayed load may come from a signal: "
            hint += '[signals] load = "exp(-s*T)*..."'
            raise ModelError(Diagnostic("SF910", message, expression.span, hint))
        return self.blocks[name]

    def _sum(self, expression: Sum, terms: tuple[Expression, ...]) -> Factored | LinearForm:
        values = [self._evaluate(term) for term in terms]
        forms = [v for v in values if isinstance(v, LinearForm)]
        constants = [v for v in values if isinstance(v, Factored) and not v.is_zero]
        if not forms:
            return sum(constants, Factored.number(self.ring, 0))
        if constants:
            raise ModelError(Diagnostic("SF221", "the sum has a term without an unknown", expression.span))
        return LinearForm.total(forms)

    def _power(self, expression: Power, base: Expression, exponent: Expression) -> Factored | LinearForm:
        value = self._evaluate(base)
        power = self.constant(exponent)
        n = int(power.unit)
        if isinstance(value, LinearForm):
            if n == 1:
                return value
            raise ModelError(Diagnostic("SF222", "a power of an unknown is not linear", expression.span))
        if n < 0 and self.vanishes(value):
            raise ModelError(Diagnostic("SF224", "division by zero", expression.span))
        return value**n

    def vanishes(self, value: Factored) -> bool:
        """Tell whether a value is zero, also where it only is with its definitions opened."""
        if value.is_zero:
            return True
        used = [name for name in self.definitions if value.depends_on(name)]
        if not used or any(name not in self.point for name in used):
            return False
        try:
            return residue(value, self.point, self.prime) == 0
        except ZeroDivisionError:
            return False  # a block that divides by zero, which is reported at the block

    def settled(self, value: Factored) -> Factored:
        """Return a value with its definitions opened, and with no squares of square roots in it."""
        for name in reversed(tuple(self.definitions)):
            if value.depends_on(name):
                value = composed(value, {name: self.constant(self.definitions[name])})
        return value if self.radicals is None else self.radicals.reduced(value)

    def _call(self, expression: Call, name: str, argument: Expression) -> Factored:
        inner = self.constant(argument)
        opened = self.opener.open(expression)
        inside = {n.name for n in names(opened) if isinstance(n, Name)}
        if LAPLACE in inside or inner.depends_on(LAPLACE):
            message = f"{name} of an expression in s is not available yet"
            hint = "write a delay as a block of type delay; waves come with rods, beams and [fields]"
            raise ModelError(Diagnostic("SF910", message, expression.span, hint))
        if block := next((n for n in self.blocks if n in inside), None):
            message = f"{name} of a block ('{block}') is not available yet"
            hint = "blocks may be added, multiplied, divided and raised to integer powers"
            raise ModelError(Diagnostic("SF910", message, expression.span, hint))
        if name == "sqrt" and inner.is_constant and (root := exact_root(inner.unit)) is not None:
            return Factored.number(self.ring, root)
        if inner.is_zero and name in ("sin", "tan", "sinh", "tanh"):
            return Factored.number(self.ring, 0)
        if inner.is_zero and name in ("cos", "cosh", "exp"):
            return Factored.number(self.ring, 1)
        return Factored.generator(self.ring, format_expression(opened))


def without_squares(form: LinearForm, radicals: Radicals | None) -> LinearForm:
    """Return a combination without squares of roots: ``sqrt(x)^2`` is ``x``."""
    return LinearForm.of(*((v, radicals.tidy(c)) for v, c in form.terms)) if radicals else form


@dataclass(frozen=True)
class Opener:
    """Puts definitions into the arguments of functions."""

    definitions: Mapping[str, Expression]  # each uses only earlier ones
    _opened: dict[str, Expression] = field(default_factory=dict, repr=False)

    def open(self, call: Call) -> Call:
        """Return a function call whose argument contains no definition; SF103 if that is too large."""
        used = set(names_among(call, self.definitions))
        for name in reversed(tuple(self.definitions)):
            if name in used and name not in self._opened:
                used.update(names_among(self.definitions[name], self.definitions))
        for name, expression in self.definitions.items():
            if name in used and name not in self._opened:
                self._opened[name] = self._substituted(expression, call)
        opened = self._substituted(call, call)
        if not isinstance(opened, Call):
            raise TypeError("a call stays a call")
        return opened

    def _substituted(self, expression: Expression, call: Call) -> Expression:
        parts, depth = extent(expression)
        inner = [extent(self._opened[name]) for name in names_among(expression, self.definitions)]
        parts += sum(count for count, _ in inner)
        depth += max((levels for _, levels in inner), default=0)
        if parts > OPENED_PARTS or depth > OPENED_DEPTH:
            message = (
                f"the argument of {call.name} is too large once its definitions are substituted: more than "
                f"{OPENED_PARTS} parts or {OPENED_DEPTH} levels"
            )
            hint = "declare the value of the argument as a parameter"
            raise ModelError(Diagnostic("SF103", message, call.span, hint))
        return substitute(expression, self._opened) if inner else expression


def extent(expression: Expression) -> tuple[int, int]:
    """Return how many parts a tree has, and how many levels.

    >>> extent(Sum((Name("x"), Negative(Name("y")))))
    (4, 3)
    """
    parts, deepest, pending = 0, 0, [(expression, 1)]
    while pending:
        node, level = pending.pop()
        parts += 1
        deepest = max(deepest, level)
        pending += [(child, level + 1) for child in node.children]
    return parts, deepest


def exact_root(value: Fraction) -> Fraction | None:
    """Return the square root of a rational number when it is rational."""
    if value < 0:
        return None
    top, bottom = isqrt(value.numerator), isqrt(value.denominator)
    exact = top * top == value.numerator and bottom * bottom == value.denominator
    return Fraction(top, bottom) if exact else None


def _product(
    left: Factored | LinearForm, right: Factored | LinearForm, expression: Expression
) -> Factored | LinearForm:
    if not isinstance(right, LinearForm):
        return left * right
    if isinstance(left, LinearForm):
        raise ModelError(Diagnostic("SF222", "a product of two unknowns is not linear", expression.span))
    return right * left


def written_poles(
    block: PlacedBlock,
    values: Mapping[str, Factored],
    evaluator: ExactEvaluator,
    poles: Mapping[str, Factored],
) -> Factored:
    """Return the denominator in s of a block before anything cancels, from ``values`` as in transfer_of."""
    if isinstance(block.block, StateSpaceBlock):
        return _in_s(block.block.characteristic(values))
    if isinstance(block.block, TransferFunctionBlock):
        given = dict(block.values)
        return written_denominator(Quotient(given["num"], given["den"]), evaluator, poles)
    below = evaluator.blocks[block.name].denominator()
    if isinstance(block.formula, Quotient):
        below = factored_of(block.formula.denominator, evaluator.ring, values.__getitem__).numerator()
    within = (written_denominator(e, evaluator, poles) for _, e in block.values)
    return least_common_multiple(_in_s(below), within)


def written_denominator(
    expression: Expression, evaluator: ExactEvaluator, poles: Mapping[str, Factored]
) -> Factored:
    """Return the denominator in s of an expression before anything cancels; ``poles`` are those of blocks.

    A product of blocks has the poles of every factor; a sum needs those of each term once.
    """
    one = Factored.number(evaluator.ring, 1)
    match expression:
        case Name(name) if evaluator.is_block(expression):
            return poles.get(name, one)
        case Negative(operand):
            return written_denominator(operand, evaluator, poles)
        case Product(factors):
            return prod((written_denominator(factor, evaluator, poles) for factor in factors), start=one)
        case Quotient(numerator, denominator):
            below = _inverted(denominator, evaluator, poles)
            return written_denominator(numerator, evaluator, poles) * below
        case Power(base, exponent):
            n = int(evaluator.constant(exponent).unit)
            if n >= 0:
                return written_denominator(base, evaluator, poles) ** n
            return _inverted(base, evaluator, poles) ** -n
        case Sum(terms):
            return least_common_multiple(one, (written_denominator(t, evaluator, poles) for t in terms))
    return one


def cancelled_poles(
    expression: Expression, below: Factored, evaluator: ExactEvaluator, poles: Mapping[str, Factored]
) -> Factored:
    """Return the poles that cancelled above what is left ``below`` an expression: they stay modes."""
    return least_common_multiple(below, (written_denominator(expression, evaluator, poles),)) / below


def _inverted(expression: Expression, evaluator: ExactEvaluator, poles: Mapping[str, Factored]) -> Factored:
    """Return the denominator in s of an expression's inverse: its zeros, and the poles that cancel in it."""
    value = evaluator.constant(expression)
    zeros = _in_s(value.numerator(), evaluator.varying)
    return zeros * cancelled_poles(expression, value.denominator(), evaluator, poles)


def _in_s(value: Factored, varying: Collection[str] = ()) -> Factored:
    """Return the factors that contain s, or a definition that does."""
    places = [value.ring.index[name] for name in (LAPLACE, *varying) if name in value.ring.index]
    return value.filter(lambda factor: any(degree_in(factor, place) for place in places))
