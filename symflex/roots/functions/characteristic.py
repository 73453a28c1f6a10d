"""Polynomials in s and kernels on a ball of s, to first order: what searches ask of such a function.

Input: values of kernels, whose parameters are numbers or lie anywhere in ranges, and polynomials in them.
Output: balls around values and slopes in s, divided alike by an exponential, so that neither overflows.

Example: of ``s + 2`` and ``exp(-s)`` at s = 3 j +- 0.1 the values are 2 + 3 j and exp(-3 j), the slopes 1 and
-exp(-3 j). Within the ball a function differs from its value in the middle by at most the ball of its slopes
times the distance (mean value theorem; Moore 1966).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from flint import acb, acb_series, fmpz_mpoly

from symflex.algebra.exponential_sum import Exponent
from symflex.balls import Value, at_centre
from symflex.roots.functions.exponential_values import ExponentialValues, Place, Summed
from symflex.roots.functions.kernel_function import KernelFactors
from symflex.transfer.enclose_kernels import KernelValues

SERIES = 9  # more terms than any power series at a place has


@dataclass(frozen=True, eq=False)
class CharacteristicValues:
    """Polynomials over a ring with kernels, at one precision."""

    values: ExponentialValues | KernelFactors

    @classmethod
    def of(
        cls, kernels: KernelValues, polynomials: Sequence[fmpz_mpoly], sums: Summed | None
    ) -> CharacteristicValues:
        """Return them as sums of exponentials, or as they stand where wavenumbers have no formula."""
        return cls(KernelFactors(kernels, polynomials) if sums is None else ExponentialValues(kernels, *sums))

    def at(self, s: Value, near: Place | None = None) -> Place:
        """Return all generators at s, on the branch of others, with slopes in s if s is ``expansion(s)``.

        At ``acb_series([s, 0], 2)`` slopes are in the parameter that kernel values expand.
        """
        return self.values.at(s, near)

    def largest(self, numbers: Iterable[int], place: Place) -> Exponent:
        """Return the exponential that is largest in some polynomials at a place."""
        return self.values.largest(numbers, place)

    def first_order(self, number: int, place: Place, less: Exponent) -> tuple[acb, acb]:
        """Return value and slope of a polynomial at a place, divided by an exponential."""
        value = self.values.value(number, place, less)
        return at_centre(value), value[1] if isinstance(value, acb_series) else acb(0)

    def series(self, numbers: Sequence[int], place: Place, less: Exponent) -> list[acb_series]:
        """Return polynomials at a place of a power series in s, divided by an exponential."""
        return [acb_series([0], SERIES) + self.values.value(number, place, less) for number in numbers]
