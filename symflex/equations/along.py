"""Coefficients that vary along x, exactly: their derivatives, and their values at points.

Input: an evaluator of what varies along x, and the functions of x among the ring's generators.
Output: :class:`AlongX`. The derivative of ``exp(-2*a*x)`` is ``-2*a`` times the same generator, its value at
l is another one, ``exp(-2*a*l)``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from symflex.algebra import Factored, composed
from symflex.equations.evaluate import ExactEvaluator
from symflex.expressions import Call, Expression, substitute
from symflex.model.along import COORDINATE
from symflex.model.brackets import slope_along_x


@dataclass(frozen=True, eq=False)
class AlongX:
    """The generators that vary along x."""

    evaluator: ExactEvaluator  # of what varies along x
    functions: tuple[tuple[str, Call], ...]  # of x, by the names of their generators

    @property
    def names(self) -> tuple[str, ...]:
        """The generators that vary."""
        return (COORDINATE, *(name for name, _ in self.functions))

    @cached_property
    def _slopes(self) -> Mapping[str, Factored]:
        one = self.evaluator.s**0
        slopes = {COORDINATE: one}
        for name, call in self.functions:
            slope = slope_along_x(call)
            slopes[name] = one * 0 if slope is None else self.evaluator.constant(slope)
        return slopes

    def varies(self, value: Factored) -> bool:
        """Tell whether a value varies along x."""
        return any(value.depends_on(name) for name in self.names)

    def slope(self, value: Factored) -> Factored:
        """Return the derivative of a value along x."""
        rates = (value.slope(name) * slope for name, slope in self._slopes.items() if value.depends_on(name))
        return sum(rates, value * 0)

    def at(self, value: Factored, point: Expression) -> Factored:
        """Return a value at a point, an expression without the coordinate."""
        if not self.varies(value):
            return value
        position = {COORDINATE: point}
        images = {COORDINATE: self.evaluator.constant(point)}
        images |= {n: self.evaluator.constant(substitute(call, position)) for n, call in self.functions}
        return composed(value, images)
