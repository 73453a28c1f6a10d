"""Polynomials in entries of fundamental matrices at many points, in doubles: guesses, which balls prove."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from flint import acb

from symflex.algebra import Factored, by_powers
from symflex.algebra.varying_minors import minors_by_octaves, polynomials_along
from symflex.roots.functions.exponential_values import SampledSum
from symflex.transfer.balls import at_centre

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from flint import fmpz_mpoly

    from symflex.algebra.minors import Minor, Product
    from symflex.algebra.varying_minors import Values
    from symflex.roots.functions.exponential_values import Doubles, Numbers
    from symflex.transfer.enclose_kernels import KernelValues
    from symflex.transfer.enclose_varying import VaryingMatrices
    from symflex.transfer.varying_law import BoundLaw


class DoubleMinors:
    """Evaluates factors that are sums of minors; coefficients of these are polynomials in s.

    ``reach`` tells about by which power of e waves grow at an abs(s).
    """

    def __init__(
        self,
        evaluator: KernelValues,
        matrices: VaryingMatrices,
        factors: Sequence[fmpz_mpoly],
        reach: Callable[[float], float],
    ) -> None:
        self._reach = reach
        self._sums = [_terms(evaluator, matrices, factor) for factor in factors]
        minors = sorted({m for terms in self._sums for _, product in terms for m in product})
        self._members = [
            _Member(law, [m for m in minors if m.matrix == number])
            for number, law in enumerate(matrices.laws)
        ]

    def fastest(self, z: complex) -> float:
        """Return the largest exponent at ``s = exp(z)``, in absolute value."""
        return self._reach(abs(np.exp(z)))

    def sampled(self, places: Doubles, angle: float, numbers: Sequence[int]) -> list[SampledSum]:
        """Return some of the sums on a ray, given ln(abs(s)) and arg(s)."""
        s = np.exp(places + 1j * angle)
        known: dict[Minor, tuple[Numbers, Doubles]] = {}
        for member in self._members:
            known |= member.at(s)
        with np.errstate(all="ignore"):
            return [_sampled(self._sums[i], s, known) for i in numbers]


_Terms = list[tuple[dict[int, complex], "Product"]]
"""Coefficients, by powers of s, and the minors they are multiplied by."""


def _terms(evaluator: KernelValues, matrices: VaryingMatrices, factor: fmpz_mpoly) -> _Terms:
    constants = {name: acb(value) for name, value in evaluator.constants.items()}
    return [
        (
            {
                power: complex(at_centre(evaluator.polynomial(part, constants)))
                for power, part in by_powers(matrices.minors.ring, coefficient).items()
            },
            product,
        )
        for coefficient, product in matrices.minors.of(factor)
    ]


def _sampled(terms: _Terms, s: Numbers, known: dict[Minor, tuple[Numbers, Doubles]]) -> SampledSum:
    values, scales = [], []
    for coefficient, product in terms:
        value, scale = (
            sum((c * s**power for power, c in coefficient.items()), np.zeros_like(s)),
            np.zeros(len(s)),
        )
        for minor in product:
            own, more = known[minor]
            value, scale = value * own, scale + more
        values.append(value)
        scales.append(scale)
    top = np.max(scales, axis=0)
    parts = [value * np.exp(scale - top) for value, scale in zip(values, scales, strict=True)]
    total = np.sum(parts, axis=0)
    size = np.abs(total)
    return SampledSum(top + np.log(size), np.angle(total), size / np.sum(np.abs(parts), axis=0))


class _Member:
    """The minors of one matrix."""

    def __init__(self, law: BoundLaw, minors: Sequence[Minor]) -> None:
        self._law = law
        self._minors = minors
        self._wanted = [(m.rows, m.columns) for m in minors]
        self._pieces: dict[bytes, Values] = {}
        first, last = law.ends()
        self._start, self._length = float(first.mid()), float((last - first).mid())
        self._divisors = [[(self._polynomial(d, f), e) for f, e in d.factors] for d in law.divisors]

    def _polynomial(self, divisor: Factored, factor: fmpz_mpoly) -> dict[int, complex]:
        """Return the coefficients of a factor of a divisor, by powers of s."""
        ring = divisor.ring
        parts = by_powers(ring, factor).items()
        return {power: complex(self._law.value(Factored.polynomial(ring, c), {})) for power, c in parts}

    def at(self, s: Numbers) -> dict[Minor, tuple[Numbers, Doubles]]:
        """Return the minors over their scales, and the logarithms of these."""
        if not self._minors:
            return {}
        bases = [s**self._law.step]
        for factors in self._divisors:
            total = np.ones_like(s)
            for powers, exponent in factors:
                total = total * sum(c * s**p for p, c in powers.items()) ** -exponent
            bases.append(total)
        found = minors_by_octaves(self._polynomials, bases, self._law.law.order, self._wanted)
        scales = found[len(self._wanted) :]
        return {m: (v, scales[len(m.rows) - 1].real) for m, v in zip(self._minors, found, strict=False)}

    def _polynomials(self, limits: Values, where: Values) -> Values:
        key = limits.tobytes()
        if key not in self._pieces:
            self._pieces[key] = polynomials_along(
                self._law.doubles_along, self._start, self._length, self._law.places, limits, where
            )
        return self._pieces[key]
