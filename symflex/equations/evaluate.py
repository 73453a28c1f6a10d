"""What names, calls and blocks stand for in the expressions of one model, over the exact ring.

Input: an expression of a model, wherever it stands. Output: what :mod:`symflex.model.dynamics` reads it as.

    "2*k*(x - y)"    2 k x - 2 k y, a form in the unknowns x and y
    "K*P*x" of a block P = 1/(s - 1)    K x/(s - 1), with the pole that P is written with
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from math import isqrt, prod
from typing import TYPE_CHECKING

from symflex.algebra import (
    LAPLACE,
    PRIME,
    Factored,
    Radicals,
    Ring,
    composed,
    in_lowest_terms,
    residue,
    terms_of,
)
from symflex.equations.against_text import compare, number_of_form
from symflex.errors import BudgetError, Diagnostic, ModelError
from symflex.expressions import (
    Attribute,
    Call,
    Derivative,
    Expression,
    Name,
    format_expression,
    names,
    names_among,
    substitute,
)
from symflex.library.blocks import StateSpaceBlock
from symflex.library.elements import LinearForm, Variable
from symflex.model import ModelScope, PlacedBlock
from symflex.model.dynamics import Dynamics, ExpressionReader
from symflex.model.model import RootOfS

if TYPE_CHECKING:
    from flint import fmpz_mpoly

OPENED_PARTS = 1_000
OPENED_DEPTH = 200


@dataclass(frozen=True)
class ExactEvaluator(ExpressionReader):
    """Evaluates the expressions of one model."""

    ring: Ring  # generators: s, parameters, definitions, pi and elementary functions of constants
    scope: ModelScope  # what names mean
    blocks: Mapping[str, Dynamics[Factored]]  # of blocks, and of definitions that are no letters
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
    varying: Collection[str] = ()  # generators other than s that depend on it: definitions, delays
    # What the names in a block's formula stand for.
    given: Mapping[str, Dynamics[Factored]] = field(default_factory=dict)

    @cached_property
    def s(self) -> Factored:
        """The Laplace variable."""
        generator = Factored.generator(self.ring, LAPLACE)
        if self.root is None:
            return generator
        plain = replace(self, root=None, is_constant=True)
        return (generator**self.root.order - plain.constant(self.root.shift)) / plain.constant(
            self.root.slope
        )

    @cached_property
    def opener(self) -> Opener:
        """Opens the definitions inside the arguments of functions."""
        return Opener(self.definitions)

    @cached_property
    def _of_constants(self) -> ExactEvaluator:
        return self if self.is_constant else replace(self, is_constant=True)

    def along_x(self) -> ExactEvaluator:
        """Return the same for what may vary along x."""
        return replace(self, scope=self.scope.varying())

    def constant(self, expression: Expression) -> Factored:
        """Return the value of an expression without unknowns; SF224 division by zero, SF501 too large."""
        return self.read_constant(expression).value

    def read_constant(self, expression: Expression) -> Dynamics[Factored]:
        """Return what an expression without unknowns is read as, with the same errors."""
        return ExpressionReader.read_constant(self._of_constants, expression)

    def linear(self, expression: Expression) -> LinearForm:
        """Return an expression of unknowns and inputs as a linear form; zero is the empty form."""
        return self.read_linear(expression).value

    def read_linear(self, expression: Expression) -> Dynamics[LinearForm]:
        """Return what an expression of unknowns and inputs is read as."""
        reading = self.read(expression)
        if isinstance(reading.value, LinearForm):
            return Dynamics(reading.value, reading.poles)
        if reading.value.is_zero:
            return Dynamics(LinearForm(), reading.poles)
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
        found = number_of_form(self.series(expression).value, self.place)
        if found is None:
            raise KeyError
        return found

    def read(self, expression: Expression) -> Dynamics[Factored | LinearForm]:
        """Return what an expression is read as, compared with its tree at the point."""
        try:
            reading = self.series(expression)
            value, poles = reading.value, reading.poles
            if isinstance(value, LinearForm):
                value = without_squares(value, self.radicals)
            elif self.radicals:
                value = self.radicals.tidy(value)
            poles = self.radicals.tidy(poles) if self.radicals else poles
            if expression.children and self.is_decided:
                compare(expression, number_of_form(value, self.place), self.number_of_leaf, self.prime)
            return Dynamics(value, poles)
        except BudgetError as error:
            located = (replace(d, span=d.span or expression.span) for d in error.diagnostics)
            raise BudgetError(*located) from None

    def leaf(self, expression: Expression) -> Dynamics[Factored | LinearForm]:
        """Return what a name, a call or a derivative is."""
        match expression:
            case Name() | Attribute():
                return self._name(expression)
            case Call(name) if name in self.fields and self.field_value is not None:
                if expression not in self.states:
                    self.states[expression] = self.field_value(expression)
                return Dynamics(self.states[expression], self.one)
            case Call(name, argument):
                return Dynamics(self._call(expression, name, argument), self.one)
            case Derivative(name, order):
                derivative = Variable("field", name, "'" * order)
                return Dynamics(LinearForm.of((derivative, self.one)), self.one)
        raise TypeError(f"unexpected expression {type(expression).__name__}")

    def _name(self, expression: Name | Attribute) -> Dynamics[Factored | LinearForm]:
        if expression.name in self.given:
            return self.given[expression.name]
        is_shared = len(self.scope.meanings.get(expression.name, ())) > 1
        meaning = self.scope.lookup(expression, constant=self.is_constant and is_shared)
        if meaning.kind == "block" or (meaning.kind == "definition" and meaning.name in self.blocks):
            return self._block(expression, meaning.name)
        if meaning.kind == "through" and meaning.variable is not None:
            return Dynamics(self.through[meaning.variable], self.one)
        if meaning.variable is not None:
            return Dynamics(LinearForm.of((meaning.variable, self.one)), self.one)
        value = self.s if meaning.name == LAPLACE else Factored.generator(self.ring, meaning.name)
        return Dynamics(value, self.one)

    def _block(self, expression: Name | Attribute, name: str) -> Dynamics[Factored]:
        if name not in self.blocks:
            # Only while kernels are surveyed: everywhere else every block has a value.
            message = "a delay inside a field's equation or a length is not available"
            hint = "wavenumbers would depend on it; a delayed load may come from a signal: "
            hint += '[signals] load = "exp(-s*T)*..."'
            raise ModelError(Diagnostic("SF910", message, expression.span, hint))
        return self.blocks[name]

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
        if inner.is_zero and name in ("sin", "tan", "sinh", "tanh", "atan"):
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

    >>> from symflex.expressions import Negative, Sum
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


def shared_by_sides(value: Factored) -> Factored:
    """Return what numerator and denominator have in common, which sums leave in both.

    >>> ring = Ring(("s",))
    >>> s = Factored.generator(ring, "s")
    >>> str(shared_by_sides(s / (s - 1) - 3 / ((s - 1) * (s + 2))))
    '(s - 1)'
    """
    if value.ring.is_sparse:  # its polynomials have no greatest common divisor
        used = value.ring.used_in(f for f, _ in value.factors)
        dense = Ring(tuple(name for name in value.ring.names if name in used))
        return _carried(shared_by_sides(_carried(value, dense)), value.ring)
    return in_lowest_terms(value.numerator(), value.denominator())[1]


def _carried(value: Factored, ring: Ring) -> Factored:
    """Return a value over another ring that has the names in it."""

    def image(factor: fmpz_mpoly) -> Factored:
        total = ring.constant(0)
        for monomial, coefficient in terms_of(factor):
            powers = (ring.generator(value.ring.names[i]) ** e for i, e in monomial)
            total += prod(powers, start=ring.constant(int(coefficient)))
        return Factored.polynomial(ring, total)

    return value.map_factors(ring, image)


def read_block(block: PlacedBlock, evaluator: ExactEvaluator) -> Dynamics[Factored]:
    """Return what a block is read as that is no other model's and no delay; ZeroDivisionError."""
    entries = {name: evaluator.read_constant(e) for name, e in block.values}
    if block.formula is not None:
        try:
            return replace(evaluator, given=entries).read_constant(block.formula)
        except ModelError as error:
            raise ZeroDivisionError from error  # the only thing that can be wrong with a formula of its own
    assert isinstance(block.block, StateSpaceBlock)
    values = {LAPLACE: evaluator.s} | {name: reading.value for name, reading in entries.items()}
    # Each entry is a subsystem in series with others: det(s - A) with the entries' own poles cleared.
    within = prod((reading.poles for reading in entries.values()), start=evaluator.one)
    poles = evaluator.in_s(block.block.characteristic(values) * within)
    return Dynamics(block.block.transfer(values), poles)
