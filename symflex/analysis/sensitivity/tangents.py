"""Numerators and denominators with their derivatives, in balls, along s or along one parameter.

Input: a transfer function with symbols, and values of its parameters.
Output: for any polynomial of its ring a value and a derivative, what wavenumbers and kernels contribute
included. Derivatives are carried forward from s or the parameter, through functions of constants, the
coefficients of the dispersion relations, wavenumbers and lengths, to the kernels (Griewank and Walther 2008,
chapter 3).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from flint import acb, acb_series, arb, arb_series, fmpz_mpoly

from symflex.algebra import FUNCTIONS, LAPLACE, Factored, Kernel, PolynomialMemo
from symflex.expressions import Call, Expression, fold
from symflex.transfer.balls import EvaluationPlan, ball, enclosure, plan
from symflex.transfer.enclose_kernels import fundamental_functions

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from symflex.model import ExactValue
    from symflex.transfer import TransferFunction


Point = dict[str, acb_series]
"""The generators of a ring to first order."""


@dataclass(frozen=True, eq=False)
class Tangents:
    """Evaluates what a transfer function is made of, to first order.

    Examples
    --------
    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... parameters.a = "3"
    ... inputs.u = {}
    ... outputs.y = "u/(a^2 + 1)"
    ... ''')
    >>> tf = pipeline.derive_all(model)[0]
    >>> tangents = Tangents(tf, {p.name: p.value for p in model.parameters})
    >>> tangents.product(tf.den, tangents.along("a", acb(0)))
    10.0000000000000 + 6.00000000000000*x + O(x^2)
    """

    tf: TransferFunction  # with symbols
    values: Mapping[str, ExactValue]  # of all parameters that occur

    def along(self, direction: str, s: acb) -> Point:
        """Return all generators at ``s`` [rad/s], with their derivatives at the current precision.

        ``direction`` is ``"s"``, or a parameter. On a ball wavenumbers take one branch each; where one is
        zero, or two are equal, values are not finite.
        """
        real = {name: first_order(enclosure(v)(), int(name == direction)) for name, v in self.values.items()}
        point = {LAPLACE: _series(s, acb(int(direction == LAPLACE))), "pi": _complex(first_order(arb.pi()))}
        point.update((name, _complex(value)) for name, value in real.items())
        for constant in self.tf.constants:
            if constant.generator in self._used:
                point[constant.generator] = _complex(constant_tangent(constant.expression, real))
        for law in self.tf.kernels.dispersions:
            coefficients = [self.product(c, point) for c in law.characteristic]
            shift = self.product(law.shift, point)
            point.update(law.roots(coefficients, _root))
            solutions: dict[Factored, tuple[acb_series, ...]] = {}
            for kernel in self.tf.kernels.kernels_of(law):
                length = self.product(kernel.length, point)
                if kernel.function == "fundamental":
                    if kernel.length not in solutions:
                        solutions[kernel.length] = _fundamental(coefficients, length)
                    point[kernel.generator] = solutions[kernel.length][kernel.order]
                else:
                    rate = point[kernel.wavenumber] if kernel.wavenumber else -shift
                    point[kernel.generator] = _kernel(kernel, rate * length)
        return point

    def polynomial(self, polynomial: fmpz_mpoly, point: Point) -> tuple[acb, acb]:
        """Return the value of a polynomial of the ring, and its derivative."""
        value = self._sum(polynomial, point)
        return value[0], value[1]

    def product(self, value: Factored, point: Point) -> acb_series:
        """Return a product of powers of polynomials to first order."""
        total = _series(acb(ball(value.unit)), acb(0))
        for factor, exponent in value.factors:
            total = total * _power(self._sum(factor, point), exponent)
        return total

    def _sum(self, polynomial: fmpz_mpoly, point: Point) -> acb_series:
        prepared = self._plans(polynomial)
        names = self.tf.ratio.ring.names
        return _lifted(prepared.value([_power(point[names[i]], e) for i, e in prepared.powers]))

    @cached_property
    def _plans(self) -> PolynomialMemo[EvaluationPlan]:
        return PolynomialMemo(plan)

    @cached_property
    def _used(self) -> frozenset[str]:
        """The generators that occur; constants that do not may have no value."""
        parts = (self.tf.num, self.tf.den, *self.tf.kernels.values)
        return self.tf.ratio.ring.used_in(factor for part in parts for factor, _ in part.factors)


def _series(value: acb, slope: acb) -> acb_series:
    return acb_series([value, slope], 2)


def _complex(value: arb_series) -> acb_series:
    return _series(acb(value[0]), acb(value[1]))


def _lifted(value: acb | acb_series) -> acb_series:
    return _series(value, acb(0)) if isinstance(value, acb) else value


def _power(base: acb_series, exponent: int) -> acb_series:
    value, slope = base[0], base[1]
    return _series(value**exponent, exponent * value ** (exponent - 1) * slope)


def _root(value: acb_series) -> acb_series:
    """Return a square root that is one analytic branch on the whole ball, wherever the ball lies."""
    middle = value[0].mid()
    root = (value[0] / middle).sqrt() * middle.sqrt()
    return _series(root, value[1] / (2 * root))


def _kernel(kernel: Kernel, argument: acb_series) -> acb_series:
    x = argument[0]
    match kernel.function:
        case "exp":
            value = slope = x.exp()
        case "cosh":
            value, slope = x.cosh(), x.sinh()
        case "sinh":
            value, slope = x.sinh(), x.cosh()
        case "cos":
            value, slope = x.cos(), -x.sin()
        case _:
            value, slope = x.sin(), x.cos()
    return _series(value, slope * argument[1])


def _fundamental(coefficients: Sequence[acb_series], length: acb_series) -> tuple[acb_series, ...]:
    """Return ``h, h', ..., h^(n-1)`` at a length that may vary as the coefficients do."""
    found = [_lifted(h) for h in fundamental_functions(coefficients, length[0])]
    # One derivative more follows from the equation h^(n) + ... + c_0 h = 0.
    highest = -sum((c[0] * h[0] for c, h in zip(coefficients, found, strict=True)), acb(0))
    following = [*(h[0] for h in found[1:]), highest]
    return tuple(_series(h[0], h[1] + f * length[1]) for h, f in zip(found, following, strict=True))


def first_order(value: arb, slope: arb | int = 0) -> arb_series:
    """Return ``value + slope*x``, to first order in x."""
    return arb_series([value, arb(slope)], 2)


def constant_tangent(expression: Expression, values: Mapping[str, arb_series]) -> arb_series:
    """Return an expression of constants to first order, at the current precision.

    Not finite where the expression has no derivative, such as ``sqrt(k)`` at ``k = 0``.

    Examples
    --------
    >>> from symflex.expressions import Name
    >>> root = Call("sqrt", Name("k"))
    >>> constant_tangent(root, {"k": first_order(arb(4), 1)})
    2.00000000000000 + 0.250000000000000*x + O(x^2)
    """
    return fold(
        expression,
        number=lambda value: first_order(ball(value)),
        name=lambda name: first_order(arb.pi()) if name == "pi" else values[name],
        power=lambda base, exponent: _real_power(base, constant_tangent(exponent, values)),
        call=_called,
        quotient=_quotient,
    )


def _called(call: Call, argument: arb_series) -> arb_series:
    function = FUNCTIONS[call.name]
    # A constant argument has no slope, also where the function has none.
    slope = arb(0) if argument[1].is_zero() else function.derivative(argument[0]) * argument[1]
    return first_order(function.evaluate(argument[0]), slope)


def _quotient(above: arb_series, below: arb_series) -> arb_series:
    quotient = above[0] / below[0]
    return first_order(quotient, (above[1] - quotient * below[1]) / below[0])


def _real_power(base: arb_series, exponent: arb_series) -> arb_series:
    value = base[0] ** exponent[0]
    slope = arb(0)
    if not base[1].is_zero():
        slope = slope + exponent[0] * base[0] ** (exponent[0] - 1) * base[1]
    if not exponent[1].is_zero():
        slope = slope + value * base[0].log() * exponent[1]
    return first_order(value, slope)
