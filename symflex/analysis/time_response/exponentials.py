"""Sums of polynomials times exponentials in t, and their values.

    2 t e^(-t) + 3 cos(5 t)    is    ExponentialTerm(-1, (0, 2)), ExponentialTerm(5j, (3,))

of which the real part is meant. Values at all times are one product of matrices in balls; see
:mod:`~symflex.analysis.time_response.sample_times`.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial
from typing import TYPE_CHECKING

from flint import acb, acb_poly, arb, arb_mat

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.analysis.time_response.sample_times import SampleTimes


@dataclass(frozen=True, slots=True)
class ExponentialTerm:
    """The real part of ``exp(rate*t) * sum(coefficients[j] * t^j/j!)``."""

    rate: acb  # [rad/s]
    coefficients: tuple[acb, ...]


def values_of(
    terms: Sequence[ExponentialTerm], times: SampleTimes, start: int = 0, delay: arb | None = None
) -> list[arb]:
    """Return the sum of the terms at all times, in balls of the current precision.

    With ``start`` and ``delay`` [s] at the times from number ``start`` on, each less the delay.

    Examples
    --------
    >>> from symflex.analysis.time_response.sample_times import SampleTimes
    >>> decay = ExponentialTerm(acb(-1), (acb(0), acb(2)))
    >>> [round(float(y), 6) for y in values_of([decay], SampleTimes.of([0.0, 1.0]))]
    [0.0, 0.735759]
    """
    count = len(times) - start
    outer, inner = times.spread(start, delay)
    left: list[list[arb]] = [[] for _ in outer]
    right: list[list[arb]] = []
    for term in terms:
        # What P(a + b) exp(rate (a + b)) is, sorted by powers of b: products of a's factor and b's.
        polynomial = acb_poly([c / factorial(j) for j, c in enumerate(term.coefficients)])
        powers = len(term.coefficients) if len(inner) > 1 else 1
        for row, a in zip(left, outer, strict=True):
            grown = (term.rate * a).exp()
            if powers == 1:
                factors = [(polynomial(a) if len(term.coefficients) > 1 else term.coefficients[0]) * grown]
            else:
                moved = polynomial(acb_poly([a, acb(1)]))
                factors = [moved[i] * grown for i in range(powers)]
            row += [part for w in factors for part in (w.real, -w.imag)]
        column = [(term.rate * b).exp() for b in inner]
        for i in range(powers):
            if i:
                column = [b * w for b, w in zip(inner, column, strict=True)]
            right += [[w.real for w in column], [w.imag for w in column]]
    if not right or not count:
        return [arb(0)] * count
    found: list[arb] = (arb_mat(left) * arb_mat(right)).entries()
    return found[:count]
