"""Running a program in double precision, with the operations of generated code in the same order."""

from __future__ import annotations

from fractions import Fraction
from math import isfinite
from sys import float_info
from typing import TYPE_CHECKING, Any

import numpy as np
from flint import arb, ctx, fmpq

from symflex.emit.program.nodes import (
    Add,
    Apply,
    Assignment,
    Branch,
    Constant,
    Divide,
    InverseLaplace,
    Laplace,
    Multiply,
    Negate,
    Node,
    Parameter,
    Power,
    Program,
    Reference,
)
from symflex.errors import Diagnostic, ModelError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike, NDArray

CONSTANT_BITS = 256

NUMPY_FUNCTIONS = {name: name for name in ("sqrt", "exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh")}
"""What numpy calls each of the elementary functions."""


def nearest_double(value: Fraction, pi_power: int = 0) -> float:
    """Return the double nearest to ``value * pi**pi_power``.

    Raises
    ------
    ModelError
        SF233 when it is too large or too small for double precision.

    Examples
    --------
    >>> from fractions import Fraction
    >>> nearest_double(Fraction(1, 10)), nearest_double(Fraction(1), 1)
    (0.1, 3.141592653589793)
    """
    if value == 0:
        return 0.0
    try:
        if pi_power == 0:
            result = float(value)
        else:
            with ctx.workprec(CONSTANT_BITS):
                result = float((arb(fmpq(value.numerator, value.denominator)) * arb.pi() ** pi_power).mid())
    except OverflowError:
        result = float("inf")
    if not isfinite(result) or abs(result) < float_info.min:
        size = "large" if abs(result) > 1 else "small"
        raise ModelError(Diagnostic("SF233", f"a number of this model is too {size} for double precision"))
    return result


def evaluate(program: Program, s: ArrayLike, values: Mapping[str, ArrayLike]) -> NDArray[np.complex128]:
    """Return the values of a program, exactly those that the generated code returns.

    Parameters
    ----------
    program : Program
        Of one transfer function.
    s : array_like of complex
        Laplace variable [rad/s].
    values : mapping of str to array_like
        Every parameter, by its name in the model; broadcast against ``s``.

    Returns
    -------
    ndarray of complex
        Of the shape that ``s`` and the parameters broadcast to. Poles and overflows are inf or nan.
    """
    point = np.asarray(s, dtype=complex)[()]
    given = {name: _number(values[name]) for name in program.parameters}
    run = _Run(point, given)
    with np.errstate(all="ignore"):
        run.assign(program.constants)
        value = run.branch(program.near)
        if program.far is not None:
            is_far = np.abs(point) > program.limit
            if np.any(is_far):
                value = np.where(is_far, run.branch(program.far), value)
    shape = np.broadcast_shapes(np.shape(point), *(np.shape(v) for v in given.values()))
    return np.array(np.broadcast_to(value, shape), dtype=complex)


def _number(value: ArrayLike) -> Any:  # noqa: ANN401
    array = np.asarray(value)
    return array.astype(complex if array.dtype.kind == "c" else float)[()]


class _Run:
    """The values computed so far."""

    def __init__(self, s: Any, parameters: Mapping[str, Any]) -> None:  # noqa: ANN401
        self._s = s
        self._parameters = parameters
        self._assigned: dict[str, Any] = {}

    def assign(self, assignments: tuple[Assignment, ...]) -> None:
        for assignment in assignments:
            self._assigned[assignment.name] = self._value(assignment.value)

    def branch(self, branch: Branch) -> Any:  # noqa: ANN401
        self.assign(branch.assignments)
        return self._value(branch.value)

    def _value(self, node: Node) -> Any:  # noqa: ANN401
        match node:
            case Constant(value, pi_power):
                return nearest_double(value, pi_power)
            case Parameter(name):
                return self._parameters[name]
            case Reference(name):
                return self._assigned[name]
            case Laplace():
                return self._s
            case InverseLaplace():
                return 1.0 / self._s
            case Add(terms):
                total = self._value(terms[0])
                for term in terms[1:]:
                    if isinstance(term, Negate):
                        total = total - self._value(term.operand)
                    else:
                        total = total + self._value(term)
                return total
            case Multiply(factors):
                product = self._value(factors[0])
                for factor in factors[1:]:
                    product = product * self._value(factor)
                return product
            case Divide(numerator, denominator):
                return self._value(numerator) / self._value(denominator)
            case Power(base, exponent):
                return self._value(base) ** exponent
            case Negate(operand):
                return -self._value(operand)
            case Apply(function, argument):
                return getattr(np, NUMPY_FUNCTIONS[function])(self._value(argument))
        message = f"no value for {type(node).__name__}"
        raise TypeError(message)
