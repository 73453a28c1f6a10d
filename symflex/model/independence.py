"""Whether conditions, or a field's equations, repeat or contradict one another, told from their trees alone.

Every one is a linear form in the fields' values, at points or along x, and in what drives them. Coefficients
are compared at a random point of a prime field, where equal ones are equal and different ones differ, almost
surely. Conditions that only the differential equations tie together are found later, with the equations.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from random import Random
from typing import TypeVar

from symflex.algebra import PRIME
from symflex.errors import SpecError
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
)
from symflex.library.elements import Variable
from symflex.model.linearity import integer_exponent
from symflex.model.scope import CONSTANT_KINDS, ModelScope
from symflex.model.units import lower

Key = TypeVar("Key")
Place = tuple[str, int, int]  # unknown, point modulo the prime (zero along x), order of derivative
Form = dict["Place | Variable | None", int]  # a linear form; None is the constant one


@dataclass(frozen=True, slots=True)
class Repetition:
    """A condition or equation that repeats ``others``, or ``contradicts`` them by its right side."""

    condition: int
    others: tuple[int, ...]
    contradicts: bool


@dataclass(frozen=True)
class RandomPoint:
    """Expressions of one model at a random point of a prime field, the same in every run."""

    scope: ModelScope
    definitions: Mapping[str, Expression]
    _opened: dict[str, int] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        """Open the definitions in order, so that a long chain is not followed at once."""
        for name, expression in self.definitions.items():
            try:
                self._opened[name] = self.constant(expression)
            except (ZeroDivisionError, SpecError):
                self._opened[name] = _random(name)  # what is wrong with it is reported there

    def within(self, unknowns: Iterable[str]) -> RandomPoint:
        """Return the same point for the equations of the field with these unknowns."""
        return replace(self, scope=self.scope.within(unknowns))

    def constant(self, expression: Expression) -> int:
        """Return the value of an expression without unknowns; it may raise ZeroDivisionError."""
        return self.form(expression).get(None, 0)

    def form(self, expression: Expression) -> Form:
        """Return a linear expression as a form; it may raise ZeroDivisionError."""
        match lower(expression):
            case Number(value):
                return _scaled({None: value.numerator}, _inverse(value.denominator))
            case Name() | Attribute() as name:
                return self._name(name)
            case Negative(operand):
                return _scaled(self.form(operand), -1)
            case Sum(terms):
                return _total([self.form(t) for t in terms])
            case Product(factors):
                result: Form = {None: 1}
                for other in map(self.form, factors):
                    varies = other.keys() - {None}
                    one, factor = (other, result) if varies else (result, other)
                    result = _scaled(one, factor.get(None, 0))
                return result
            case Quotient(numerator, denominator):
                return _scaled(self.form(numerator), _inverse(self.constant(denominator)))
            case Power(base, exponent):
                return self._power(self.form(base), integer_exponent(exponent) or 0)
            case Call(name, argument, order):
                at = self.constant(argument)
                if name in self.scope.unknowns:
                    return {(name, at, order): 1}
                if name in self.scope.along:
                    return {Variable("through", name, f"{order} at {at}"): 1}
                return {None: _random(f"{name}({at})")}
            case Derivative(name, order):
                return {(name, 0, order): 1}
        raise TypeError(f"unexpected expression {type(expression).__name__}")

    def condition(self, equation: Equation) -> Form:
        """Return left minus right."""
        return _total([self.form(equation.left), _scaled(self.form(equation.right), -1)])

    def _name(self, expression: Name | Attribute) -> Form:
        if isinstance(expression, Name) and expression.name in self.scope.inside:
            return {(expression.name, 0, 0): 1}
        try:
            meaning = self.scope.lookup(expression, constant=False)
        except SpecError:  # in a point or a denominator only a constant is meant
            meaning = self.scope.lookup(expression, constant=True)
        if meaning.variable is not None and meaning.kind not in CONSTANT_KINDS:
            return {meaning.variable: 1}
        if meaning.kind != "definition":
            return {None: _random(meaning.name)}
        return {None: self._opened[meaning.name]}

    @staticmethod
    def _power(base: Form, exponent: int) -> Form:
        if exponent == 1:
            return base
        value = base.get(None, 0)
        return {None: pow(value if exponent > 0 else _inverse(value), abs(exponent), PRIME)}


def repetitions(forms: Sequence[Form]) -> list[Repetition]:
    """Return every condition or equation that repeats or contradicts earlier ones."""
    # One with a right side that contains more than inputs is passed over: nodes and signals may meet it.
    repeated: list[Repetition] = []
    reduced: list[tuple[Place, Form, dict[int, int]]] = []
    for number, form in enumerate(forms):
        remainder: Form = dict(form)
        origin: dict[int, int] = {number: 1}
        for pivot, row, made_of in reduced:
            factor = remainder.get(pivot, 0)
            if factor:
                remainder = _total([remainder, _scaled(row, -factor)])
                origin = _total([origin, _scaled(made_of, -factor)])
        pivot_here = next((k for k in remainder if isinstance(k, tuple)), None)
        if pivot_here is not None:
            inverse = _inverse(remainder[pivot_here])
            reduced.append((pivot_here, _scaled(remainder, inverse), _scaled(origin, inverse)))
            continue
        remaining = [k for k in remainder if k is not None and not isinstance(k, tuple)]
        if all(v.kind == "input" for v in remaining):
            repeated.append(
                Repetition(number, tuple(sorted(i for i in origin if i != number)), bool(remainder))
            )
    return repeated


def _total(forms: Sequence[Mapping[Key, int]]) -> dict[Key, int]:
    total: dict[Key, int] = {}
    for form in forms:
        for key, value in form.items():
            total[key] = (total.get(key, 0) + value) % PRIME
    return {k: v for k, v in total.items() if v}


def _scaled(form: Mapping[Key, int], factor: int) -> dict[Key, int]:
    return {k: v for k, c in form.items() if (v := c * factor % PRIME)}


def _inverse(value: int) -> int:
    if value % PRIME == 0:
        raise ZeroDivisionError("division by zero")
    return pow(value, -1, PRIME)


def _random(text: str) -> int:
    return Random(text).randrange(1, PRIME)
