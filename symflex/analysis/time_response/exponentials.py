"""Sums of polynomials times exponentials in t, and their values.

    2 t e^(-t) + 3 cos(5 t)    is    ExponentialTerm(-1, (0, 2)), ExponentialTerm(5j, (3,))

of which the real part is meant. Values at all times are one product of matrices in balls; see
:mod:`~symflex.analysis.time_response.sample_times`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from flint import acb, arb, arb_mat

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
    found = [arb(0)] * count
    highest = max((len(term.coefficients) for term in terms), default=0)
    outer, inner = times.spread(start, delay)
    grown = [([(t.rate * a).exp() for a in outer], [(t.rate * b).exp() for b in inner]) for t in terms]
    power, instants = [arb(1)] * count, times.enclosed(start, delay) if highest > 1 else []
    for j in range(highest):
        if j:
            power = [p * t / j for p, t in zip(power, instants, strict=True)]
        pairs = [
            (t.coefficients[j], *g) for t, g in zip(terms, grown, strict=True) if len(t.coefficients) > j
        ]
        sums = _real_part(pairs, count)
        found = [y + p * v for y, p, v in zip(found, power, sums, strict=True)] if j else sums
    return found


def _real_part(pairs: Sequence[tuple[acb, list[acb], list[acb]]], count: int) -> list[arb]:
    """Return the real part of ``sum(c*a*b)`` for all a of the first lists and b of the second, in order."""
    if not pairs or not count:
        return [arb(0)] * count
    rows, columns = len(pairs[0][1]), len(pairs[0][2])
    weighted = [[c * a for a in outer] for c, outer, _ in pairs]
    left = arb_mat(
        [[part for w in weighted for part in (w[i].real, -w[i].imag)] for i in range(rows)],
    )
    right = arb_mat(
        [part for _, _, inner in pairs for part in ([b.real for b in inner], [b.imag for b in inner])]
    )
    product = left * right
    return [product[i, j] for i in range(rows) for j in range(columns)][:count]
