"""A rational function as a sum over its poles, which is a sum of exponentials in time.

Input: a bound transfer function without kernels, and how often its input is integrated.
Output: :class:`~symflex.analysis.time_response.exponentials.ExponentialTerm`, one a conjugate pair.

    1/(s (s + 2)^2)  =  (1/4)/s - (1/4)/(s + 2) - (1/2)/(s + 2)^2
    in time             1/4     - (1/4) e^(-2t) - (1/2) t e^(-2t)

The multiplicity of a proved pole is exact, so at the pole the first coefficients of the denominator's Taylor
series are zero, whatever their balls hold, and a quotient of series is left. Poles close to each other have
large coefficients of opposite sign; the digits that these lose are made up for by more digits of the poles.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from flint import acb, acb_poly, acb_series, arb

from symflex.analysis.rational.laurent import series_length
from symflex.analysis.time_response.exponentials import ExponentialTerm
from symflex.transfer.bind import EnclosedTransferFunction

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.roots import Root
    from symflex.transfer import BoundTransferFunction


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
            message = f"{bound.name} is not rational"
            raise TypeError(message)
        above = tuple((f, e) for f, e in enclosed.factors if e > 0)
        return cls(above, tuple((f, -e) for f, e in enclosed.factors if e < 0), enclosed.unit)

    def multiplied_out(self) -> tuple[acb_poly, acb_poly]:
        """Return numerator and denominator."""
        num, den = acb_poly([self.unit]), acb_poly([1])
        for f, e in self.above:
            num = num * f**e
        for f, e in self.below:
            den = den * f**e
        return num, den


def partial_fractions(
    quotient: EnclosedQuotient, poles: Sequence[Root], integrations: int
) -> list[ExponentialTerm] | None:
    """Return the inverse Laplace transform of a quotient over ``s^integrations`` for t > 0.

    ``poles`` are all poles of the quotient, proved, with both members of each conjugate pair. None where
    poles are not told apart, or balls are too wide.
    """
    if not all(root.certified for root in poles):
        return None
    found = []
    if integrations and not any(root.is_zero for root in poles):
        origin = _principal(quotient, acb(0), 0, integrations)
        if origin is None:
            return None
        found.append(ExponentialTerm(acb(0), origin))
    for root in poles:
        if root.im < 0:
            continue
        pole = root.enclosure()
        coefficients = _principal(quotient, pole, root.multiplicity, integrations, is_origin=root.is_zero)
        if coefficients is None:
            return None
        share = 1 if root.is_real else 2
        found.append(ExponentialTerm(pole, tuple(c * share for c in coefficients)))
    return found


def _principal(
    quotient: EnclosedQuotient, pole: acb, order: int, integrations: int, *, is_origin: bool | None = None
) -> tuple[acb, ...] | None:
    """Return the coefficients of ``1/(s - p)``, ... of a quotient over ``s^integrations``."""
    at_zero = order == 0 if is_origin is None else is_origin
    count = order + integrations if at_zero else order
    above = _taylor(quotient.above, pole, count)
    below = _taylor(quotient.below, pole, order + count)
    rest = below[order:]
    if rest[0].contains(0):
        return None
    with series_length(count):
        series = acb_series(above, count) / acb_series(rest, count) * quotient.unit
        if not at_zero:
            for _ in range(integrations):
                series = series / acb_series([pole, acb(1)], count)
    found = tuple(series[count - 1 - j] for j in range(count))
    return found if all(c.is_finite() for c in found) else None


def _taylor(factors: Sequence[tuple[acb_poly, int]], centre: acb, count: int) -> list[acb]:
    """Return so many Taylor coefficients of a product of powers at a point."""
    with series_length(count):
        total = acb_series([1], count)
        for factor, exponent in factors:
            moved = factor(acb_poly([centre, acb(1)]))
            series = acb_series(moved.coeffs()[:count] or [0], count)
            for _ in range(exponent):
                total = total * series
        return [total[i] for i in range(count)]


def at_infinity(quotient: EnclosedQuotient, integrations: int) -> tuple[tuple[arb, ...], arb]:
    """Return the polynomial part of a quotient over ``s^integrations``, and the coefficient of 1/s after it.

    In time these are the weights of an impulse and its derivatives, and the value just after t = 0. A leading
    coefficient whose ball holds zero counts as what it is, unless it is exactly zero.
    """
    num, den = quotient.multiplied_out()
    surplus = int(num.degree()) - int(den.degree()) - integrations
    if surplus < -1:
        return (), arb(0)
    with series_length(surplus + 2):
        series = acb_series(num.coeffs()[::-1], surplus + 2) / acb_series(den.coeffs()[::-1], surplus + 2)
        return tuple(series[surplus - k].real for k in range(surplus + 1)), series[surplus + 1].real


LONGEST = 4000
"""Terms of a power series in time, and the bits it loses; beyond, it takes too long."""


def power_series_terms(
    quotient: EnclosedQuotient, integrations: int, last: arb, bits: int
) -> list[ExponentialTerm] | None:
    """Return the same inverse as a power series in t, valid up to ``last``, without knowing any pole.

    The coefficients of F(s) = h_1/s + h_2/s^2 + ... are those of t^(k-1)/(k-1)!. With abs(F) <= M on the
    circle abs(s) = r around all poles Cauchy's estimate gives abs(h_k) <= M r^k, and what n terms leave is at
    most M r (r t)^n/n! / (1 - r t/(n + 1)). None where that takes too many terms.
    """
    num, den = quotient.multiplied_out()
    degree = int(den.degree())
    lead = den[degree].abs_lower()
    if not lead > 0:
        return None
    below = [den[i].abs_upper() for i in range(degree)]
    radius = arb(1)
    while not sum((c * radius**i for i, c in enumerate(below)), arb(0)) < lead * radius**degree / 2:
        radius = radius * 2
    reach = radius * last
    if not reach < LONGEST / 8:
        return None
    count = int(float((4 * reach + bits).upper())) + degree + 8
    bound = sum((num[i].abs_upper() * radius**i for i in range(int(num.degree()) + 1)), arb(0))
    bound = bound / (lead * radius**degree / 2) / radius**integrations
    missing = bound * radius * reach**count / arb(count).gamma() / count / (1 - reach / (count + 1))
    shift = degree + integrations - int(num.degree())
    length = count + max(-shift, 0) + 2
    with series_length(length):
        series = acb_series(num.coeffs()[::-1], length) / acb_series(den.coeffs()[::-1], length)
    coefficients = [acb(0)] * count
    for i in range(length):
        if 0 <= (k := i + shift - 1) < count:
            coefficients[k] = series[i]
    coefficients[0] = coefficients[0] + acb(arb(0, missing.upper()))
    return [ExponentialTerm(acb(0), tuple(coefficients))]
