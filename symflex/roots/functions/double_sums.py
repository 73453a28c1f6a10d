"""Sums of exponentials in doubles, at many points at once: what guesses are made of."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from flint import acb

from symflex.algebra.exponential_sum import amplitude_of
from symflex.transfer.balls import ball

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from symflex.algebra import Dispersion, Factored
    from symflex.roots.functions.exponential_values import ExponentialValues, Valued

Numbers = npt.NDArray[np.complex128]
Doubles = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class SampledSum:
    """One sum at many points."""

    # size and phase: the real and imaginary parts of its logarithm; the latter up to whole turns [rad].
    size: Doubles
    phase: Doubles
    share: Doubles  # size of the sum over the sizes of what is summed: how much cancels


class DoubleSums:
    """Evaluates the same sums of exponentials as :class:`ExponentialValues`, in doubles."""

    def __init__(self, values: ExponentialValues) -> None:
        evaluator = values.evaluator
        self._laws: list[tuple[Dispersion, list[_SampledProduct]]] = [
            (law, [_SampledProduct(values, c) for c in law.characteristic])
            for law in evaluator.table.dispersions
            if law.wavenumbers
        ]
        self._arguments = [
            (a.wavenumber, None if a.wavenumber else _SampledProduct(values, a.rate), complex(length))
            for a, length in zip(values.arguments, values.lengths, strict=True)
        ]
        self._sums = [
            _SampledTerms(values.coefficients[i], terms.combinations, len(self._arguments))
            for i, (terms, _) in enumerate(values.sums)
        ]

    def fastest(self, z: complex) -> float:
        """Return the largest exponent at ``s = exp(z)``, in absolute value."""
        _, arguments = self._place(np.array([z]))
        sizes = [np.abs(terms.combinations @ arguments).max(initial=0.0) for terms in self._sums]
        return float(max(sizes, default=0.0))

    def sampled(self, places: Doubles, angle: float, numbers: Sequence[int]) -> list[SampledSum]:
        """Return some of the sums on a ray, given ln(abs(s)) and arg(s)."""
        with np.errstate(all="ignore"):
            values, arguments = self._place(places + 1j * np.full_like(places, angle))
            return [self._sums[i].sampled(values, arguments) for i in numbers]

    def _place(self, z: Numbers) -> tuple[dict[str, Numbers], Numbers]:
        """Return the values of s and of wavenumbers, and the arguments of exponentials."""
        values = {"s": np.exp(z)}
        for law, coefficients in self._laws:
            values.update(_wavenumbers(law, [c.value(values) for c in coefficients]))
        arguments = np.empty((len(self._arguments), len(z)), dtype=np.complex128)
        for i, (wavenumber, rate, length) in enumerate(self._arguments):
            arguments[i] = (values[wavenumber] if rate is None else -rate.value(values)) * length
        return values, arguments


class _SampledProduct:
    """A product of powers of polynomials in s."""

    def __init__(self, values: ExponentialValues, product: Factored) -> None:
        self._unit = complex(acb(ball(product.unit)))
        self._factors = [(_Amplitudes((values.valued(amplitude_of(f)),)), e) for f, e in product.factors]

    def value(self, values: Mapping[str, Numbers]) -> Numbers:
        total = np.full_like(values["s"], self._unit)
        for factor, exponent in self._factors:
            total = total * factor.value(values)[0] ** exponent
        return total


class _Amplitudes:
    """Polynomials in s and wavenumbers."""

    def __init__(self, polynomials: Sequence[Valued]) -> None:
        self._powers = list(dict.fromkeys(key for terms in polynomials for _, key in terms))
        place = {key: i for i, key in enumerate(self._powers)}
        self._numbers = np.zeros((len(polynomials), len(place)), dtype=np.complex128)
        for row, terms in enumerate(polynomials):
            for number, key in terms:
                self._numbers[row, place[key]] += complex(number)

    def value(self, values: Mapping[str, Numbers]) -> Numbers:
        monomials = np.ones((len(self._powers), len(values["s"])), dtype=np.complex128)
        for row, powers in enumerate(self._powers):
            for name, e in powers:
                monomials[row] *= values[name] if e == 1 else values[name] ** e
        found: Numbers = self._numbers @ monomials
        return found


class _SampledTerms:
    """One sum."""

    def __init__(
        self, amplitudes: Sequence[Valued], combinations: Sequence[Mapping[int, complex]], arguments: int
    ) -> None:
        self._amplitudes = _Amplitudes(amplitudes)
        self.combinations = np.zeros((len(combinations), arguments), dtype=np.complex128)
        for row, factors in enumerate(combinations):
            for i, factor in factors.items():
                self.combinations[row, i] = factor

    @cached_property
    def _has_exponentials(self) -> bool:
        return bool(self.combinations.any())

    def sampled(self, values: Mapping[str, Numbers], arguments: Numbers) -> SampledSum:
        terms = self._amplitudes.value(values)
        scale = np.zeros(terms.shape[1])
        if self._has_exponentials:
            exponents = self.combinations @ arguments
            scale = exponents.real.max(axis=0)
            terms = terms * np.exp(exponents - scale)
        total = terms.sum(axis=0)
        size = np.abs(total)
        return SampledSum(scale + np.log(size), np.angle(total), size / np.abs(terms).sum(axis=0))


def _wavenumbers(law: Dispersion, c: Sequence[Numbers]) -> dict[str, Numbers]:
    """Return the roots by their names; every branch serves, because functions are symmetric in them."""
    match law.kind:
        case "wave":
            found = [np.sqrt(-c[0])]
        case "bending":
            found = [np.sqrt(np.sqrt(c[0] / 4))]
        case _:
            middle = -c[2] / 2
            root = np.sqrt(middle * middle - c[0])
            found = [np.sqrt(middle + root), np.sqrt(middle - root)]
    return dict(zip(law.wavenumbers, found, strict=True))
