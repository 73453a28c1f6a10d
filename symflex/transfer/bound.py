"""A transfer function with numbers: exact coefficients, and its values in balls and doubles.

Input: exact coefficients over a ring of s, pi and functions of constants, with what the kernels are.
Output: the value at any complex frequency, in balls of any precision or right to the last bit of a double.

Example: ``1 / (2 s^2 + 3 s + 5)`` at s = 1j rad/s is ``1 / (3 + 3j)``, whatever terms of other models cancel:
the precision is raised until the ball is narrower than the last bit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cache, cached_property
from math import prod
from typing import TYPE_CHECKING, ClassVar, Literal

from flint import acb, acb_poly, acb_series, arb, fmpz_mpoly

from symflex.algebra import NO_KERNELS, Factored, KernelTable, PolynomialMemo, Radicals, Ring, degree_in
from symflex.balls import EvaluationPlan, at_centre, ball, expansion, plan, precision, value_at
from symflex.budget import spend
from symflex.equations import radicals_of
from symflex.expressions import Call
from symflex.model import ExactValue
from symflex.model.along import is_tapered, varies_along_x
from symflex.transfer.double_value import double_value
from symflex.transfer.enclose import enclosure, later

if TYPE_CHECKING:
    from symflex.algebra.modal_sum import ModalSums
    from symflex.along.matrices import VaryingMatrices
    from symflex.transfer.enclose_kernels import KernelValues
    from symflex.transfer.transfer_function import HiddenFactor, TransferFunction


@dataclass(frozen=True)
class BoundRoot:
    """The principal branch of ``(slope*s + shift)^(1/order)``, which functions have in place of s."""

    slope: arb
    shift: arb
    order: int

    def __call__(self, s: acb) -> acb:
        """Return a ball around the values on a ball; on the cut, those above it."""
        inside = self.slope * s + self.shift
        if self.order == 2:  # noqa: PLR2004 (a square root)
            return inside.sqrt()
        return (inside.log() / self.order).exp() if inside != 0 else inside

    def value_and_slope(self, s: acb) -> tuple[acb, acb]:
        """Return balls around the value and its derivative."""
        r = self(s)
        return r, self.slope * r / (self.order * (self.slope * s + self.shift))


@dataclass(frozen=True)
class EnclosedTransferFunction:
    """Ball coefficients of a bound transfer function at one precision."""

    bits: int  # the precision everything is computed at
    unit: acb  # the factor in front
    factors: tuple[tuple[acb_poly, int], ...]  # polynomials in s with their exponents
    root: BoundRoot | None = None  # what they are polynomials in instead of s

    def __call__(self, s: acb) -> acb:
        """Return a ball that contains the values on the ball ``s`` [rad/s]."""
        with precision(self.bits):
            s = s if self.root is None else self.root(s)
            return prod((f(s) ** exponent for f, exponent in self.factors), start=self.unit)

    def logarithmic_derivative(self, s: acb) -> acb:
        """Return a ball around ``G'(s)/G(s)``."""
        with precision(self.bits):
            slope = acb(1)
            if self.root is not None:
                s, slope = self.root.value_and_slope(s)
            sums = (exponent * f.derivative()(s) / f(s) for f, exponent in self.factors)
            return sum(sums, acb(0)) * slope

    def value_and_slope(self, s: acb) -> tuple[acb, acb]:
        """Return balls around ``G(s)`` and ``G'(s)/G(s)``."""
        return self(s), self.logarithmic_derivative(s)


@dataclass(frozen=True)
class EnclosedDistributed:
    """A bound transfer function with kernels, evaluated in balls at one precision."""

    bits: int  # the precision everything is computed at
    ratio: Factored  # over the ring of kernels; or any other function over it
    kernels: KernelValues  # the values of its generators
    root: BoundRoot | None = None  # what the kernels are functions of instead of s

    def __call__(self, s: acb) -> acb:
        """Return a ball that contains the value at ``s``; not finite where a wavenumber is zero."""
        spend()
        with precision(self.bits):
            s = s if self.root is None else self.root(s)
            value = self.kernels.value(self.ratio, self.kernels.at(s))
            return value if isinstance(value, acb) else value[0]

    def logarithmic_derivative(self, s: acb) -> acb:
        """Return a ball around ``G'(s)/G(s)``."""
        return self.value_and_slope(s)[1]

    def value_and_slope(self, s: acb) -> tuple[acb, acb]:
        """Return balls around ``G(s)`` and ``G'(s)/G(s)``, for which kernels are evaluated once."""
        with precision(self.bits):
            turn = acb(1)
            if self.root is not None:
                s, turn = self.root.value_and_slope(s)
            values = self.kernels.at(expansion(s))
            value, slope = acb(ball(self.ratio.unit)), acb(0)
            for factor, exponent in self.ratio.factors:
                series = self.kernels.polynomial(factor, values)
                if isinstance(series, acb_series):
                    slope = slope + exponent * series[1] / series[0]
                value = value * at_centre(series) ** exponent
            return value, slope * turn


Enclosed = EnclosedTransferFunction | EnclosedDistributed


@dataclass(frozen=True)
class BoundTransferFunction:
    """A transfer function with numbers."""

    is_reduced: ClassVar[Literal[True]] = True  # numerator and denominator have nothing in common
    source: TransferFunction  # the symbolic function
    values: tuple[tuple[str, ExactValue], ...]  # every parameter's value, in declared order
    ratio: Factored  # over a ring with generators s, pi and the functions of constants
    hidden: tuple[HiddenFactor, ...]  # factors cancelled symbolically or by these values, over the same ring
    kernels: KernelTable = NO_KERNELS  # of distributed parts, after the constants in the ring
    parts: tuple[Factored, Factored] | None = None  # of a distributed system, :attr:`num` and :attr:`den`
    is_of_model: bool = True  # its poles are those of the source's model; not so of a loop gain
    # What the ring's s is: the model's, in whose place a root of s may stand; that root itself, or s itself.
    variable: Literal["model", "root", "s"] = "model"
    fixed: tuple[tuple[str, Callable[[], arb]], ...] = ()  # constants that waves without inertia came down to
    symbolic: TransferFunction | None = None  # with all parameters, where numbers stood for some

    def __getstate__(self) -> dict[str, object]:
        """Leave out what is kept of earlier computations."""
        return {f.name: getattr(self, f.name) for f in fields(self)}

    def __repr__(self) -> str:
        return f"<BoundTransferFunction {self.name}>"

    @property
    def all_values(self) -> tuple[tuple[str, ExactValue], ...]:
        """The values of all parameters that have one: those that cancelled keep the declared ones."""
        declared = {p.name: p.value for p in self.source.model.parameters if p.value is not None}
        return tuple((declared | dict(self.values)).items())

    @property
    def is_rational(self) -> bool:
        """True when the function contains no kernels: a quotient of polynomials in s, or in a root of s."""
        return not self.kernels

    @property
    def is_zero(self) -> bool:
        """True when the output does not depend on the input."""
        return self.ratio.is_zero

    @property
    def num(self) -> Factored:
        """The numerator, entire in s, as :attr:`TransferFunction.num` with these values."""
        return self.ratio.numerator() if self.parts is None else self.parts[0]

    @property
    def den(self) -> Factored:
        """The denominator, entire in s."""
        return self.ratio.denominator() if self.parts is None else self.parts[1]

    @property
    def name(self) -> str:
        """``OUT/IN``."""
        return self.source.name

    @cached_property
    def constants(self) -> tuple[tuple[str, Callable[[], arb]], ...]:
        """Per generator after s, how to enclose it at the current precision."""
        values: dict[str, Callable[[], arb]] = {name: enclosure(value) for name, value in self.values}
        values |= dict(self.fixed)
        known: dict[str, Callable[[], arb]] = {**values, "pi": arb.pi}
        for constant in self.source.constants:
            if constant.generator not in self.along:
                known[constant.generator] = later(constant.expression, values)
        return tuple((name, known[name]) for name in self.ratio.ring.names[1:] if name in known)

    @cached_property
    def radicals(self) -> Radicals:
        """The relations of the roots among the generators."""
        return radicals_at(self.source, self.ratio.ring, dict(self.values))

    @cached_property
    def along(self) -> Mapping[str, Call]:
        """The functions of the coordinate along x among the generators."""
        if not is_tapered(self.source.model):  # then x, if anything, is a parameter
            return {}
        names = self.ratio.ring.index
        used = ((c.generator, c.expression) for c in self.source.constants if c.generator in names)
        return {name: call for name, call in used if varies_along_x(call)}

    @cached_property
    def _matrices(self) -> VaryingMatrices | None:
        """The fundamental matrices of laws that vary along x, expanded once for all precisions."""
        if not any(law.matrix for law in self.kernels.dispersions):
            return None
        from symflex.along.matrices import VaryingMatrices
        from symflex.along.minors import MinorSums  # few beams are tapered

        values = {name: enclosure(value) for name, value in self.values}
        minors = MinorSums(self.ratio.ring, self.kernels)
        return VaryingMatrices(minors, dict(self.constants), self.along, values)

    def expect(self, modes: int, size: float = 0.0) -> None:
        """Tell that values are wanted for abs(s) up to a size [rad/s], so that tapers are expanded once."""
        if self._matrices is not None:
            self._matrices.expect(modes, size)

    def check_along(self) -> None:
        """Raise ModelError: SF250 where what varies along x is not analytic on its whole member."""
        for law in () if self._matrices is None else self._matrices.laws:
            law.check()

    def enclosed(self, bits: int) -> Enclosed:
        """Return the function with ball coefficients of the given precision."""
        if self.kernels:
            return self.enclosed_part(self.ratio, bits)
        with precision(bits):
            values = [evaluate() for _, evaluate in self.constants]

            def coefficients(factor: fmpz_mpoly) -> list[arb]:
                terms = coefficients_in_s(factor, self.constant_ring)
                return [value_at(c, values.__getitem__, arb) for c in terms]

            factors = tuple((acb_poly(coefficients(f)), e) for f, e in self.ratio.factors)
            return EnclosedTransferFunction(bits, acb(ball(self.ratio.unit)), factors, self.root)

    def enclosed_part(self, part: Factored, bits: int) -> EnclosedDistributed:
        """Return a function over the ring of kernels, such as :attr:`num`, evaluated in balls."""
        with precision(bits):
            return EnclosedDistributed(bits, part, self.kernel_values(), self.root)

    @property
    def sheets(self) -> int:
        """Q where a root ``(s + c)^(1/q)`` stands in place of s; 1 where s does."""
        root = self.source.model.root
        return root.order if root is not None and self.variable == "model" else 1

    def in_root(self, size: float) -> float:
        """Return the largest ``abs(r)`` of a root of s up to an ``abs(s)`` [rad/s]; that without one."""
        root = self.root
        if root is None:
            return size
        return float((size * root.slope + root.shift).root(root.order).upper())

    def frequency(self, size: arb) -> arb:
        """Return the frequency [rad/s] at a place of the axis, where that is the root of one."""
        return size if self.root is None else (size**self.root.order - self.root.shift) / self.root.slope

    def from_root(self, size: float) -> float:
        """Return an ``abs(s)`` [rad/s] up to which no ``abs(r)`` exceeds a size."""
        return max(float(self.frequency(arb(size)).lower()), 0.0)

    @property
    def root(self) -> BoundRoot | None:
        """The root of s that stands in place of s, at the current precision."""
        return self.branch if self.variable == "model" else None

    @property
    def branch(self) -> BoundRoot | None:
        """The root of s that the model's equations have in place of s, at the current precision."""
        root = self.source.model.root
        if root is None:
            return None
        values = {name: enclosure(value) for name, value in self.all_values}
        return BoundRoot(later(root.slope, values)(), later(root.shift, values)(), root.order)

    def kernel_values(self, *, is_along: bool = True) -> KernelValues:
        """Return the evaluator of kernels at the current precision, given entries if ``is_along``."""
        from symflex.transfer.enclose_kernels import KernelValues  # only with beams

        constants = {name: evaluate() for name, evaluate in self.constants}
        return KernelValues(
            self.ratio.ring.names,
            self.kernels,
            constants,
            self._modal_sums,
            self._plans,
            self._matrices if is_along else None,
        )

    @cached_property
    def _plans(self) -> PolynomialMemo[EvaluationPlan]:
        return PolynomialMemo(plan)

    @cached_property
    def _modal_sums(self) -> ModalSums:
        from symflex.algebra.modal_sum import ModalSums  # only with beams

        return ModalSums(self.ratio.ring, self.kernels)

    @cached_property
    def constant_ring(self) -> Ring:
        """The ring of the coefficients of powers of s."""
        return Ring(self.ratio.ring.names[1:])

    @cached_property
    def _known(self) -> Callable[[int], Enclosed]:
        return cache(self.enclosed)

    def __call__(self, s: complex) -> complex:
        """Return the value at one complex frequency [rad/s] to double precision.

        The precision is raised until the ball's radius is below the last bit, so that cancellation between
        large terms costs no digits. At a pole the value is ``inf + nan*1j``.
        """
        if self.ratio.is_zero:
            return 0j
        return double_value(self._known, s, 0 if self.kernels else None)

    def each(self, points: Sequence[complex]) -> list[complex]:
        """Return the values at many complex frequencies [rad/s]; see :meth:`__call__`."""
        return [self(s) for s in points]


def coefficients_in_s(polynomial: fmpz_mpoly, constants: Ring) -> tuple[fmpz_mpoly, ...]:
    """Return the ascending coefficients of s (the first generator) over the ring of the other generators."""
    parts: list[dict[tuple[int, ...], int]] = [{} for _ in range(degree_in(polynomial, 0) + 1)]
    for monomial, coefficient in polynomial.terms():
        parts[int(monomial[0])][tuple(int(e) for e in monomial[1:])] = int(coefficient)
    return tuple(constants.context.from_dict(part) for part in parts)


def radicals_at(tf: TransferFunction, ring: Ring, values: Mapping[str, ExactValue]) -> Radicals:
    """Return the relations that roots among the generators have with these values."""

    def value(name: str) -> Factored:
        if values[name].is_imaginary:
            return Factored.generator(ring, name)
        return Factored.generator(ring, "pi") ** values[name].pi_power * values[name].rational

    return radicals_of(ring, tf.constants, tf.model.parameters, value)
