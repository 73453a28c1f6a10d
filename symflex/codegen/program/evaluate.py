"""Running a program in double precision, with the operations of generated code in the same order.

What generated code of distributed systems needs besides arithmetic is copied into modules: functions that use
numpy and each other, and nothing else.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, partial, reduce
from math import isfinite
from operator import mul
from sys import float_info
from typing import TYPE_CHECKING, Any

import numpy as np
from flint import arb

from symflex.algebra.line_networks import network_value
from symflex.along.doubles import fundamental_minors
from symflex.balls import ball, precision
from symflex.codegen.program import nodes as tree
from symflex.codegen.program.derivative import differentiated, is_differentiable
from symflex.errors import Diagnostic, ModelError
from symflex.transfer.nested_form import CONSTANT_BITS

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


NUMPY_FUNCTIONS = {  # what numpy calls each of the elementary functions, and the magnitude
    name: name for name in ("sqrt", "exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "atan", "abs")
} | {"complex_sqrt": "sqrt"}

CIRCLE_SHARE, CIRCLE_POINTS = 1e-6, 4
"""Radius of the circle around a parameter, as a share of it, and points on it: what resonances with a damping
ratio of 1e-4 leave out is 1e-8 of the derivative, and rounding leaves about 1e-9."""


def nearest_double(value: Fraction, pi_power: int = 0) -> float:
    """Return the double nearest to ``value * pi**pi_power``; SF233 when there is none."""
    if value == 0:
        return 0.0
    try:
        if pi_power == 0:
            result = float(value)
        else:
            with precision(CONSTANT_BITS):
                result = float((ball(value) * arb.pi() ** pi_power).mid())
    except OverflowError:
        result = float("inf")
    if not isfinite(result) or abs(result) < float_info.min:
        size = "large" if abs(result) > 1 else "small"
        message = f"a number of this model is too {size} for double precision"
        hint = (
            "choose units in which values are closer to 1, such as mm and t; commands that compute "
            "exactly can still use it"
        )
        raise ModelError(Diagnostic("SF233", message, None, hint))
    return result


def evaluate(
    program: tree.Piecewise, s: ArrayLike, values: Mapping[str, ArrayLike]
) -> NDArray[np.complex128]:
    """Return the values of a program, exactly those that the generated code returns.

    ``s`` is in rad/s, the angular frequency for real arithmetic; ``values`` are all parameters, by name. They
    broadcast together; poles and overflows are inf or nan.
    """
    point = np.asarray(s, dtype=float if program.is_real else complex)[()]
    given = {name: _number(values[name]) for name in program.parameters}
    shape = np.broadcast_shapes(np.shape(point), *(np.shape(v) for v in given.values()))
    columns = [np.broadcast_to(v, shape).reshape(-1) if np.ndim(v) else v for v in (point, *given.values())]
    turn = 1 if program.turn is None else (1, 1j, -1, -1j)[program.turn % 4]
    with np.errstate(all="ignore"):
        number = numbers_of_pieces(program, columns[0], dict(zip(given, columns[1:], strict=True)))
        number = np.broadcast_to(number, (np.prod(shape, dtype=int),))
        result = np.empty(number.shape, dtype=complex)
        for n in np.unique(number):
            where = number == n
            chosen = [
                np.broadcast_to(c, number.shape)[where] if i == 0 or np.ndim(c) else c
                for i, c in enumerate(columns)
            ]
            piece = program.code[program.pieces[int(n)]]
            sample = 1j * chosen[0] if piece.is_complex else chosen[0]
            piece_values = value_of_piece(piece, sample, dict(zip(given, chosen[1:], strict=True)))
            result[where] = piece_values if piece.is_complex else turn * piece_values
    return result.reshape(shape)


def numbers_of_pieces(
    program: tree.Piecewise, point: Values, given: Mapping[str, Values]
) -> NDArray[np.int64]:
    """Return the number that the conditions make of every point, which broadcasts with the parameters."""
    run = _ProgramRun(point, given, program.tests)
    number = np.zeros(np.shape(point), dtype=int)
    for i, condition in enumerate(program.conditions):
        tested = run.value(condition.quantity)
        scale = run.value(condition.scale)
        # The far piece of a lumped program begins beyond the limit.
        is_below = np.less_equal if program.is_lumped else np.less
        is_small = is_below(np.abs(tested), condition.limit / np.abs(scale))
        number = number + 2**i * (is_small if condition.limit else np.real(scale * tested) < 0.0)
    return number


def value_of_piece(piece: tree.CodePiece, point: Values, given: Mapping[str, Values]) -> Values:
    """Return the value that a piece computes, wherever its argument lies."""
    parts = partial(_values_of, piece.code, given)
    if piece.circle:
        return mean_over_circle(parts, point, piece.circle)
    num, *den = parts(point)
    return num / den[0] if den else num


def number_of(node: tree.CodeNode, numbers: Mapping[str, Values]) -> Values:
    """Return the value of an expression that depends on no argument, ``None`` for one that does.

    ``numbers`` are the values of assignments that depend on no argument either.
    """
    for part in node.walk():
        if isinstance(part, (tree.ParameterValue, tree.Laplace, tree.InverseLaplace)):
            return None
        if isinstance(part, tree.Assigned) and part.name not in numbers:
            return None
    run = _ProgramRun(None, {}, tree.Straight((), (), ()))
    run.assigned.update(numbers)
    return run.value(node)


def values_of(code: tree.Straight, values: Mapping[str, complex]) -> tuple[float, NDArray[np.float64]]:
    """Return the value that code of parameters alone computes, and after it the others."""
    first, *others = _values_of(code, values, None)
    return float(first), np.array(others, np.float64)


def _number(value: ArrayLike) -> Values:
    array = np.asarray(value)
    return array.astype(complex if array.dtype.kind == "c" else float)[()]


def _values_of(code: tree.Straight, parameters: Mapping[str, Values], s: Values) -> list[Values]:
    run = _ProgramRun(s, parameters, code)
    return [run.value(node) for node in code.values]


class _ProgramRun:
    """The values computed so far."""

    def __init__(self, s: Values, parameters: Mapping[str, Values], code: tree.Straight) -> None:
        self._s = s
        self._parameters = parameters
        self.assigned: dict[str, Values] = {}
        for assignment in code.every:
            self.assigned[assignment.name] = self.value(assignment.value)

    def value(self, node: tree.CodeNode) -> Values:
        """Return the value of an expression: a number, an array, or a list of these."""
        match node:
            case tree.RealNumber(value, pi_power):
                return nearest_double(value, pi_power)
            case tree.ComplexNumber(real, imaginary):
                return complex(nearest_double(real), nearest_double(imaginary))
            case tree.ToComplex(operand):
                return (1 + 0j) * self.value(operand)
            case tree.LargerRoot() | tree.RootFactor():
                return self.value(node.spelled)
            case tree.ParameterValue(name):
                return self._parameters[name]
            case tree.Assigned(name):
                return self.assigned[name]
            case tree.Laplace():
                return self._s
            case tree.InverseLaplace():
                return 1.0 / self._s
            case tree.Add((first, *others)):
                return reduce(self._plus, others, self.value(first))
            case tree.Multiply(factors):
                return reduce(mul, map(self.value, factors))
            case tree.Divide(numerator, denominator):
                return self.value(numerator) / self.value(denominator)
            case tree.IntegerPower(base, exponent):
                return self.value(base) ** exponent
            case tree.Negate(operand):
                return -self.value(operand)
            case tree.Apply("complex_exp", argument):
                return complex_exp(np.asarray(self.value(argument), dtype=complex)[()])
            case tree.Apply(function, argument):
                return getattr(np, NUMPY_FUNCTIONS[function])(self.value(argument))
        return self._lists(node)

    def _plus(self, total: Values, term: tree.CodeNode) -> Values:
        if isinstance(term, tree.Negate):
            return total - self.value(term.operand)
        return total + self.value(term)

    def _lists(self, node: tree.CodeNode) -> Values:
        """Return the value of what takes lists or gives them, and of a point that may lie outside."""
        match node:
            case tree.Within(point, end):
                z = self.value(point)
                return np.where(np.abs(z) <= end, z, np.nan)
            case tree.Solutions(coefficients, terms):
                given = [self.value(c) for c in coefficients]
                return series_solutions(given, terms)
            case tree.SolutionSlopes(coefficients, slopes, terms):
                pairs = zip(coefficients, slopes, strict=True)
                given = [_FirstOrder(self.value(c), self.value(x)) for c, x in pairs]
                return [solution.slope for solution in series_solutions(given, terms)]
            case tree.FundamentalMinors(start, length, bases, along, places, wanted):
                ends = self.value(start), self.value(length)
                given = [np.atleast_1d(self.value(b)) for b in bases]
                of_x = partial(_values_of, along, self._parameters)
                return fundamental_minors(of_x, *ends, given, places, wanted, node.beginning)
            case tree.ScaledSum(amplitudes, exponents):
                return scaled_sum([self.value(a) for a in amplitudes], [self.value(e) for e in exponents])
            case tree.Solve(entries, network, output, source):
                return network_value([self.value(e) for e in entries], network, output, source)
            case tree.Item(values, position):
                return self.value(values)[position]
        raise TypeError(type(node).__name__)


@dataclass(frozen=True, slots=True)
class _FirstOrder:
    """A value and its derivative, for sums and products of such values and numbers."""

    value: Values
    slope: Values

    def __add__(self, other: _FirstOrder | float) -> _FirstOrder:
        if isinstance(other, _FirstOrder):
            return _FirstOrder(self.value + other.value, self.slope + other.slope)
        return _FirstOrder(self.value + other, self.slope)

    def __sub__(self, other: _FirstOrder) -> _FirstOrder:
        return self + -1.0 * other

    def __mul__(self, other: _FirstOrder) -> _FirstOrder:
        slope = self.slope * other.value + self.value * other.slope
        return _FirstOrder(self.value * other.value, slope)

    def __rmul__(self, number: float) -> _FirstOrder:
        return _FirstOrder(number * self.value, number * self.slope)

    def __truediv__(self, number: float) -> _FirstOrder:
        return 1 / number * self


@dataclass(frozen=True, eq=False)
class Gradient:
    """A program of complex s, and its derivatives in some of its parameters.

    Where code follows a member along x, or solves a network, derivatives are means over a circle around the
    parameter (Cauchy's formula): eight digits or more. Elsewhere they are exact up to rounding.
    """

    program: tree.Piecewise
    names: tuple[str, ...]

    @cached_property
    def _code(self) -> tuple[tree.Straight, ...] | None:
        """The code of pieces with derivatives, None where some step has none."""
        if not all(is_differentiable(piece.code) for piece in self.program.code):
            return None
        return tuple(differentiated(piece.code, self.names) for piece in self.program.code)

    def __call__(
        self, s: NDArray[np.complex128], values: Mapping[str, complex]
    ) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Return values at points, shape (n,), and derivatives, shape (n, p)."""
        if self._code is None:
            slopes = [self._mean(s, values, name) for name in self.names]
            return evaluate(self.program, s, values), np.stack(slopes, axis=1)
        both = np.empty((s.size, 1 + len(self.names)), complex)
        given = {name: values[name] for name in self.program.parameters}
        with np.errstate(all="ignore"):
            number = np.broadcast_to(numbers_of_pieces(self.program, s, given), s.shape)
            for n in np.unique(number):
                where, i = number == n, self.program.pieces[int(n)]
                parts = partial(_values_of, self._code[i], given)
                both[where] = self._piece(parts, s[where], self.program.code[i].circle).T
        return both[:, 0], both[:, 1:]

    def _piece(
        self, parts: Callable[[Values], Sequence[Values]], s: NDArray[np.complex128], points: int
    ) -> NDArray[np.complex128]:
        """Return value and derivatives, shape (1 + p, n), as :func:`value_of_piece` returns the value."""

        def rows(s: NDArray[np.complex128]) -> NDArray[np.complex128]:
            made = [np.broadcast_to(value, s.shape) for value in parts(s)]
            return np.array(made, complex).reshape(-1, 1 + len(self.names), s.size)

        sides = rows(s)
        if points:
            _, _, center, radius = sides
            total = np.zeros((2, 1 + len(self.names), s.size), complex)
            for k in range(points):
                above, below, growth, _ = rows(s + radius[0] * np.exp(2j * np.pi * (k + 0.5) / points))
                for side, part in zip(total, (above, below), strict=True):
                    scale = np.exp(growth[0] - center[0])
                    side[0] += part[0] * scale
                    side[1:] += (part[1:] + part[0] * growth[1:]) * scale
            sides = total
        if len(sides) == 1:
            return np.asarray(sides[0], np.complex128)
        above, below = sides[:2]
        value = above[0] / below[0]
        return np.concatenate((value[np.newaxis], (above[1:] - value * below[1:]) / below[0]))

    def _mean(self, s: NDArray[np.complex128], values: Mapping[str, complex], name: str) -> Values:
        """Return the derivative in a parameter, as a mean over a circle."""
        radius = CIRCLE_SHARE * (abs(values[name]) or 1.0)
        count = 2 if self.program.minors else CIRCLE_POINTS  # laws along x are followed with real parameters
        turns = np.exp(2j * np.pi * np.arange(count) / count)[:, np.newaxis]
        turns = turns.real if self.program.minors else turns
        around = evaluate(self.program, s[np.newaxis], {**values, name: values[name] + radius * turns})
        return np.mean(around / turns, axis=0) / radius


Values = Any  # a number, an array of numbers, or a list of these: what numpy calculates with, one way for all


def complex_exp(z: Values) -> Values:
    """Return exp(z); one tangent costs less than the cosine and sine in np.exp."""
    t = np.tan(0.5 * z.imag)
    square = t * t
    scale = np.exp(z.real) / (1.0 + square)
    if not np.ndim(z):
        # A numpy number: dividing by a Python zero would raise.
        return np.complex128(complex(scale * (1.0 - square), scale * 2.0 * t))
    value = np.empty_like(z)
    value.real = scale * (1.0 - square)
    value.imag = scale * (2.0 * t)
    return value


def series_solutions(coefficients: list[Values], terms: int) -> list[Values]:
    """Return the solutions of a linear differential equation at 1, by Taylor series.

    The equation is y^(n) + c_(n-1) y^(n-1) + ... + c_0 y = 0; solution k starts from
    y^(k)(0) = 1 and zeros for the other derivatives below n.
    """
    n = len(coefficients)
    used = [i for i in range(n) if np.any(coefficients[i])]
    solutions = []
    first = 1
    for k in range(n):
        zero = 0.0 * coefficients[0]
        derivatives = [zero + 1.0 if i == k else zero for i in range(n)]
        total = derivatives[k] / first
        first *= k + 1
        factorial = 1
        for m in range(1, terms):
            factorial *= m
            if m >= n:
                following = zero
                for i in used:
                    following = following - coefficients[i] * derivatives[i]
                derivatives = [*derivatives[1:], following]
                total = total + following / factorial
        solutions.append(total)
    return solutions


def scaled_sum(amplitudes: list[Values], exponents: list[Values]) -> list[Values]:
    """Return a sum of amplitudes times exponentials over the largest one, and the logarithm of that."""
    growth = np.real(exponents[0])
    for exponent in exponents[1:]:
        growth = np.maximum(growth, np.real(exponent))
    total = 0.0
    for amplitude, exponent in zip(amplitudes, exponents, strict=True):
        relative = np.asarray(exponent - growth, dtype=complex)[()]
        total = total + amplitude * complex_exp(relative)
    return [total, growth]


def mean_over_circle(parts: Callable[[Values], Sequence[Values]], s: Values, points: int) -> Values:
    """Return numerator over denominator, each the mean of its values on a circle.

    Both are analytic, so the mean is the value at the center s, where the formula
    itself cancels. parts returns numerator, denominator, the logarithm of what both
    were divided by, and the radius.
    """
    _, _, center, radius = parts(s)
    num, den = 0.0, 0.0
    for k in range(points):
        turn = np.exp(2j * np.pi * (k + 0.5) / points)
        above, below, growth, _ = parts(s + radius * turn)
        scale = np.exp(growth - center)
        num = num + above * scale
        den = den + below * scale
    return num / den
