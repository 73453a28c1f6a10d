"""What the magnitude of a quotient of delayed terms comes to as the frequency grows, and from which side.

Input: sums of terms ``a_k(s) exp(-s T_k)``, of one or several delays. Output: the limit superior of the
magnitude, and the frequency from which on the magnitude is less. Example: ``s/(s + 1)*(1 + exp(-s T)/2)``
comes to 3/2 again and again; as ``abs(s/(s + 1)) < 1`` on the axis, no frequency has it.

With the coefficients alpha_k and beta_k of the highest power of s, the limit superior is at most ``sum
abs(alpha_k)/(abs(beta_0) - sum abs(beta_k))``. It is just that if all phases this takes are 0, to which an
almost periodic function returns again and again (Bohr 1925), or half a turn of one delay. The magnitude is
less where ``sum abs(a_k) + size sum abs(b_k) < size abs(b_0)``. As ``sqrt(1 + x) <= 1 + x/2``, this follows
from the sign of a polynomial in omega^2, whose roots are within Fujiwara's bound (1916).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, arb_poly

from symflex.algebra.exponential_sum import Exponent
from symflex.roots.distributed.far_out import RealTerms


@dataclass(frozen=True, slots=True)
class DelayedLimit:
    """The limit superior of a magnitude, and where the magnitude is less."""

    size: arb
    below_from: float | None  # frequency [rad/s] from which on it is less; None if that is not proved


def delayed_limit(above: RealTerms, below: RealTerms) -> DelayedLimit | None:
    """Return the limit superior; None where it is 0 or infinite, or the phases it takes are not proved."""
    order = max(power for powers in below.values() for power in powers)
    if max(power for powers in above.values() for power in powers) != order:
        return None
    alpha, beta = (
        {e: powers[order] for e, powers in terms.items() if order in powers} for terms in (above, below)
    )
    first = max(beta, key=lambda exponent: float(abs(beta[exponent]).mid()))
    others = {exponent: value for exponent, value in beta.items() if exponent != first}
    least = abs(beta[first]) - sum(map(abs, others.values()), arb(0))
    delays = {i for exponent in (*alpha, *beta) for i, _, _ in exponent}
    turns = (1,) if len(delays) > 1 else (1, -1)  # what all exponentials, or those of one delay, come to
    signs = (alpha, {first: -beta[first], **others})
    if not (least > 0 and any(all(_have_one_sign(s, turn) for s in signs) for turn in turns)):
        return None
    size = sum(map(abs, alpha.values()), arb(0)) / least
    weights = [(above[e], abs(value)) for e, value in alpha.items()]
    weights += [(below[e], size * abs(value)) for e, value in others.items()]
    is_whole = len(alpha) == len(above) and len(beta) == len(below)
    return DelayedLimit(size, _below_from(weights, below[first], int(order)) if is_whole else None)


def delayed_bound(above: RealTerms, below: RealTerms, radius: float) -> arb | None:
    """Return what the magnitude is at most from a frequency [rad/s] on; None where that is not known."""
    order = max(power for powers in below.values() for power in powers)
    if max(power for powers in above.values() for power in powers) > order:
        return None
    largest = max(
        (abs(powers[order]) for powers in below.values() if order in powers), key=lambda c: float(c.mid())
    )
    most, others = (
        sum(
            (abs(c) * arb(radius) ** int(p - order) for powers in x.values() for p, c in powers.items()),
            arb(0),
        )
        for x in (above, below)
    )
    least = 2 * largest - others
    return (most / least).upper() if least > 0 else None


def _have_one_sign(terms: Mapping[Exponent, arb], turn: int) -> bool:
    """Tell whether terms have one sign where each delay's exponential is 1 or -1."""
    values = [value * turn ** sum(times for _, times, _ in exponent) for exponent, value in terms.items()]
    return all(value > 0 for value in values) or all(value < 0 for value in values)


def _below_from(
    weights: Sequence[tuple[Mapping[Fraction, arb], arb]], first: Mapping[Fraction, arb], order: int
) -> float | None:
    """Return the frequency from which on ``sum w_k (abs(a_k/alpha_k)^2 - abs(b_0/beta_0)^2)`` is negative."""
    main, total = _square(first, order), arb_poly([])
    for powers, weight in weights:
        total += (_square(powers, order) - main) * weight
    # The coefficients of the highest power are all one, and cancel, which balls do not show.
    coefficients = total.coeffs()[:order]
    while coefficients and coefficients[-1] == 0:
        coefficients.pop()
    if not coefficients or not coefficients[-1] < 0:
        return None
    highest = len(coefficients) - 1
    ratios = (abs(c / coefficients[-1]).upper().root(highest - i) for i, c in enumerate(coefficients[:-1]))
    return float((2 * max(ratios, key=float, default=arb(0))).sqrt().upper())


def _square(amplitude: Mapping[Fraction, arb], order: int) -> arb_poly:
    """Return the square of ``abs(a(j omega)/alpha)`` as a polynomial in omega^2."""
    lead = amplitude[Fraction(order)]
    even, odd = arb_poly([]), arb_poly([])
    for power, value in amplitude.items():
        half, is_odd = divmod(int(power), 2)
        term = arb_poly([arb(0)] * half + [(-1) ** half * value / lead])
        even, odd = (even, odd + term) if is_odd else (even + term, odd)
    return even * even + arb_poly([0, 1]) * odd * odd
