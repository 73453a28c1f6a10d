"""From expressions to values with the subsystems they are written with: all that holds s is read here.

Input: an expression of a model, and what its names stand for. Output: a :class:`Dynamics`: its value, and
the product of all denominators in s along its products.

    "(s - 1)*P" of a block P = 1/(s - 1)    value 1, written poles s - 1, all of which cancelled

A product is a series connection of its factors, and a sum a parallel one of its terms; a subsystem that
several terms of a sum share is one. What stands in the poles but no longer below the value is a mode that one
side of the product does not control, or the other does not observe (Kalman 1963): a hidden mode of the model,
not nothing. Delays count as s does: ``1 - 2 exp(-s T)`` has zeros, and what is divided by it has poles.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property
from typing import Generic, TypeVar

from symflex.algebra import LAPLACE, Factored, Ring, common_denominator, degree_in, least_common_multiple
from symflex.errors import Diagnostic, ModelError, Span
from symflex.expressions import (
    Expression,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    format_expression,
)
from symflex.library.elements import LinearForm
from symflex.model.linearity import integer_exponent

Kind_co = TypeVar("Kind_co", bound="Factored | LinearForm", covariant=True)


@dataclass(frozen=True, slots=True)
class Dynamics(Generic[Kind_co]):
    """What an expression is, and the subsystems it is written with."""

    value: Kind_co  # of constants, or of unknowns
    poles: Factored  # the product of denominators in s before anything cancels

    @property
    def below(self) -> Factored:
        """The denominator of the value."""
        if isinstance(self.value, Factored):
            return self.value.denominator()
        return common_denominator(self.poles.ring, self.value.coefficients)

    @property
    def hidden(self) -> Factored:
        """The poles that cancelled above what is left below: they stay modes."""
        below = self.below
        return self.poles if below.is_one else least_common_multiple(below, (self.poles,)) / below

    @property
    def kept(self) -> Factored:
        """The poles that did not cancel."""
        return self.poles / self.hidden


class ExpressionReader(ABC):
    """Reads expressions over a ring."""

    ring: Ring
    varying: Collection[str]  # generators other than s that depend on it: definitions, delays

    @abstractmethod
    def leaf(self, expression: Expression) -> Dynamics[Factored | LinearForm]:
        """Return what a name or a call is."""

    def read(self, expression: Expression) -> Dynamics[Factored | LinearForm]:
        """Return what an expression of constants or of unknowns is read as."""
        return self.series(expression)

    def read_constant(self, expression: Expression) -> Dynamics[Factored]:
        """Return what an expression without unknowns is read as; SF212 if there is one."""
        reading = self.read(expression)
        if isinstance(reading.value, LinearForm):
            message = f"'{format_expression(expression)}' must be constant"
            raise ModelError(Diagnostic("SF212", message, expression.span))
        return Dynamics(reading.value, reading.poles)

    def vanishes(self, value: Factored) -> bool:
        """Tell whether a value is zero."""
        return value.is_zero

    @cached_property
    def one(self) -> Factored:
        """The ring's one: the poles of what has no dynamics."""
        return Factored.number(self.ring, 1)

    def in_s(self, value: Factored) -> Factored:
        """Return the factors that depend on s, directly or through a definition or a delay."""
        places = [self.ring.index[name] for name in (LAPLACE, *self.varying) if name in self.ring.index]
        return value.filter(lambda factor: any(degree_in(factor, index) for index in places))

    def series(self, expression: Expression) -> Dynamics[Factored | LinearForm]:
        """Return what an expression is, its products in series, its sums in parallel."""
        match expression:
            case Number(value):
                return Dynamics(Factored.number(self.ring, value), self.one)
            case Negative(operand):
                return self._times(self.series(operand), Factored.number(self.ring, -1), self.one)
            case Sum(terms):
                return self._sum(expression, terms)
            case Product(factors):
                result: Dynamics[Factored | LinearForm] = Dynamics(self.one, self.one)
                for factor in factors:
                    result = self._product(result, self.series(factor), expression)
                return result
            case Quotient(numerator, denominator):
                inverse = self._inverse(self.read_constant(denominator), denominator.span or expression.span)
                return self._times(self.series(numerator), inverse.value, inverse.poles)
            case Power(base, exponent):
                return self._power(expression, base, exponent)
        return self.leaf(expression)

    def _times(
        self, reading: Dynamics[Factored | LinearForm], factor: Factored, poles: Factored
    ) -> Dynamics[Factored | LinearForm]:
        """Return a reading in series with a constant; nothing is connected where the product is zero."""
        value, poles = reading.value * factor, reading.poles * poles
        coefficients = (value,) if isinstance(value, Factored) else value.coefficients
        if not poles.is_one and all(map(self.vanishes, coefficients)):
            return Dynamics(value * Factored.number(self.ring, 0), self.one)
        return Dynamics(value, poles)

    def _product(
        self,
        left: Dynamics[Factored | LinearForm],
        right: Dynamics[Factored | LinearForm],
        expression: Expression,
    ) -> Dynamics[Factored | LinearForm]:
        if not isinstance(right.value, LinearForm):
            return self._times(left, right.value, right.poles)
        if isinstance(left.value, LinearForm):
            raise ModelError(Diagnostic("SF222", "a product of two unknowns is not linear", expression.span))
        return self._times(right, left.value, left.poles)

    def _inverse(self, reading: Dynamics[Factored], span: Span | None) -> Dynamics[Factored]:
        """Return one over a constant: its poles are the zeros of that, and the poles that cancelled in it."""
        value = reading.value
        if self.vanishes(value):
            raise ModelError(Diagnostic("SF224", "division by zero", span))
        return Dynamics(value**-1, self.in_s(value.numerator()) * reading.hidden)

    def _sum(self, expression: Sum, terms: tuple[Expression, ...]) -> Dynamics[Factored | LinearForm]:
        readings = [self.series(term) for term in terms]
        poles = least_common_multiple(self.one, (r.poles for r in readings if not r.poles.is_one))
        forms = [r.value for r in readings if isinstance(r.value, LinearForm)]
        constants = [r.value for r in readings if isinstance(r.value, Factored) and not r.value.is_zero]
        if not forms:
            return Dynamics(sum(constants, Factored.number(self.ring, 0)), poles)
        if constants:
            raise ModelError(Diagnostic("SF221", "the sum has a term without an unknown", expression.span))
        return Dynamics(LinearForm.total(forms), poles)

    def _power(
        self, expression: Power, base: Expression, exponent: Expression
    ) -> Dynamics[Factored | LinearForm]:
        reading = self.series(base)
        n = integer_exponent(exponent)
        if n is None:
            raise TypeError("an exponent is an integer")
        if isinstance(reading.value, LinearForm):
            if n == 1:
                return reading
            raise ModelError(Diagnostic("SF222", "a power of an unknown is not linear", expression.span))
        factor = Dynamics(reading.value, reading.poles)
        factor = self._inverse(factor, expression.span) if n < 0 else factor
        return Dynamics(factor.value ** abs(n), factor.poles ** abs(n))
