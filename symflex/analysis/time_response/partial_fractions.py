"""A rational function as a sum over its poles, which is a sum of exponentials in time.

Input: a bound transfer function without kernels, and how often its input is integrated.
Output: :class:`ExponentialTerm`, one a conjugate pair, and values of their sums at many times, by one product
of matrices in balls; see :mod:`~symflex.analysis.time_response.sample_times`.

    1/(s (s + 2)^2)  =  (1/4)/s - (1/4)/(s + 2) - (1/2)/(s + 2)^2
    in time             1/4     - (1/4) e^(-2t) - (1/2) t e^(-2t)

The multiplicity of a certified pole is exact, so at the pole the first coefficients of the denominator's
Taylor series are zero, whatever their balls contain, and a quotient of series is left. Poles near each other
have large coefficients of opposite sign; the digits that these lose are made up for by more digits of the
poles.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import zip_longest
from math import factorial, prod

from flint import acb, acb_poly, acb_series, arb, arb_mat

from symflex.analysis.rational.laurent import principal_part
from symflex.analysis.time_response.sample_times import SampleTimes
from symflex.balls import raised, series_quotient, series_terms
from symflex.roots import Root
from symflex.transfer import BoundTransferFunction, EnclosedTransferFunction


@dataclass(frozen=True, slots=True)
class ExponentialTerm:
    """The real part of ``exp(rate*t) * sum(coefficients[j] * t^j/j!)``."""

    rate: acb  # [rad/s]
    coefficients: tuple[acb, ...]

    def later(self, by: arb) -> ExponentialTerm:
        """Return it as one of the time from a later start [s] on."""
        powers = acb_poly([c / factorial(j) for j, c in enumerate(self.coefficients)])
        shifted = powers(acb_poly([by, 1])) * (self.rate * by).exp()
        return ExponentialTerm(self.rate, tuple(c * factorial(j) for j, c in enumerate(shifted.coeffs())))

    def __add__(self, other: ExponentialTerm) -> ExponentialTerm:
        """Return the sum of two terms of one rate."""
        pairs = zip_longest(self.coefficients, other.coefficients, fillvalue=acb(0))
        return ExponentialTerm(self.rate, tuple(a + b for a, b in pairs))


def values_of(
    terms: Sequence[ExponentialTerm], times: SampleTimes, start: int = 0, delay: arb | None = None
) -> list[arb]:
    """Return the sum of the terms at all times, in balls of the current precision.

    With ``start`` and ``delay`` [s] at the times from number ``start`` on, each less the delay.

    >>> from symflex.analysis.time_response.sample_times import SampleTimes
    >>> decay = ExponentialTerm(acb(-1), (acb(0), acb(2)))
    >>> [round(float(y), 6) for y in values_of([decay], SampleTimes.of([0.0, 1.0]))]
    [0.0, 0.735759]
    """
    count = len(times) - start
    if not count:
        return []
    spread = times.spread(start, delay)
    left: list[list[arb]] = []
    right: list[list[arb]] = []
    for term in terms:
        # What P(a + b) exp(rate (a + b)) is, sorted by powers of b: products of a's factor and b's.
        outer, inner = spread.exponentials(term.rate)
        polynomial = acb_poly([c / factorial(j) for j, c in enumerate(term.coefficients)])
        moved = [polynomial(acb_poly([a, acb(1)])) for a in spread.outer] if polynomial.degree() > 0 else None
        for i in range(len(term.coefficients) if len(inner) > 1 else 1):
            factors = [p[i] for p in moved] if moved else [polynomial[i]] * len(outer)
            column = [c * w for c, w in zip(factors, outer, strict=True)]
            left += [[w.real for w in column], [-w.imag for w in column]]
            if i:
                inner = [b * w for b, w in zip(spread.inner, inner, strict=True)]
            right += [[w.real for w in inner], [w.imag for w in inner]]
    if not right:
        return [arb(0)] * count
    values: list[arb] = (arb_mat(left).transpose() * arb_mat(right)).entries()
    return values[:count]


@dataclass(frozen=True)
class EnclosedQuotient:
    """Numerator and denominator in balls, as products of polynomials in s."""

    above: tuple[tuple[acb_poly, int], ...]  # with their exponents
    below: tuple[tuple[acb_poly, int], ...]
    unit: acb  # the number in front

    @classmethod
    def of(cls, bound: BoundTransferFunction, bits: int) -> EnclosedQuotient:
        """Return a function without kernels, with balls of so many bits."""
        enclosed = bound.enclosed(bits)
        if not isinstance(enclosed, EnclosedTransferFunction):
            raise TypeError(f"{bound.name} is not rational")
        above = tuple((f, e) for f, e in enclosed.factors if e > 0)
        return cls(above, tuple((f, -e) for f, e in enclosed.factors if e < 0), enclosed.unit)

    def multiplied_out(self) -> tuple[acb_poly, acb_poly]:
        """Return numerator and denominator."""
        num = prod((f**e for f, e in self.above), start=acb_poly([self.unit]))
        return num, prod((f**e for f, e in self.below), start=acb_poly([1]))


def partial_fractions(
    quotient: EnclosedQuotient, poles: Sequence[Root], integrations: int
) -> list[ExponentialTerm] | None:
    """Return the inverse Laplace transform of a quotient for t > 0, given its poles; None if close."""
    if not all(root.certified for root in poles):
        return None
    divided = replace(quotient, below=(*quotient.below, (acb_poly([0, 1]), integrations)))
    at_zero = sum(root.multiplicity for root in poles if root.is_zero) + integrations
    places = [(acb(0), at_zero, 1)] if at_zero else []
    places += [
        (root.enclosure(), root.multiplicity, 1 if root.is_real else 2)
        for root in poles
        if not (root.im < 0 or root.is_zero)
    ]
    terms = []
    for pole, order, share in places:
        above, below = (partial(_taylor, side) for side in (divided.above, divided.below))
        coefficients = principal_part(above, below, pole, order)
        if coefficients is None:
            return None
        terms.append(ExponentialTerm(pole, tuple(c * divided.unit * share for c in coefficients[::-1])))
    return terms


def _taylor(factors: Sequence[tuple[acb_poly, int]], centre: acb, count: int) -> list[acb]:
    """Return so many Taylor coefficients of a product of powers at a point."""
    with series_terms(count):
        total = acb_series([1], count)
        for factor, exponent in factors:
            moved = factor(acb_poly([centre, acb(1)]))
            total = total * raised(acb_series(moved.coeffs()[:count] or [0], count), exponent)
        return [total[i] for i in range(count)]


def at_infinity(quotient: EnclosedQuotient, integrations: int) -> tuple[tuple[arb, ...], arb]:
    """Return the weights of impulses, a quotient's polynomial part, and the coefficient of 1/s after it."""
    num, den = quotient.multiplied_out()
    surplus = int(num.degree()) - int(den.degree()) - integrations
    if surplus < -1:
        return (), arb(0)
    *impulses, last = (c.real for c in series_quotient(num.coeffs()[::-1], den.coeffs()[::-1], surplus + 2))
    return tuple(impulses[::-1]), last
