"""Responses of functions with a root of s: Laplace's inverse integral along hyperbolas about the branch cut.

Input: a function of ``r = (a s + b)^(1/q)`` and of decays in r. Output: values with proved bounds. Let
z = s + b/a. Far out, where every factor is nearly its largest power of r, the function has no poles, and
abs(F) <= C abs(z)^p. All hyperbolas

    z = mu (1 - sin(a - j u)),    0 < a < STEEPEST - pi/2,

lie there if mu is large. The trapezoidal rule in u is off by no more than integrals along the outermost ones
say (Trefethen and Weideman 2014, SIAM Review 56, theorem 5.1), which are Bessel functions K.

    F = sqrt(a/s)/k, the surface of a half-infinite body: a step in heat warms it by 2 sqrt(a t/pi)/k
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import acosh, ceil, log, pi, prod, sin
from typing import TYPE_CHECKING

from flint import acb, acb_mat, arb

from symflex.algebra import degree_in
from symflex.analysis.time_response.sampled import Refused, Sampled, is_precise
from symflex.balls import at_centre, ball, bits_for_digits, precision
from symflex.errors import Diagnostic, ModelError

if TYPE_CHECKING:
    from symflex.analysis.time_response.sampled import Asked
    from symflex.transfer import BoundTransferFunction

MIDDLE, ASIDE = 0.08 * pi, 0.07 * pi
"""Angle a of the path, and how far the outermost hyperbolas are turned from it."""
STEEPEST = 0.66 * pi
"""More than arg z of all of them."""
TURNS = (12.0, 2000.0)
"""mu times the last time on a path: the first takes the fewest points, the second some seconds."""
BAND = 6.0
"""Ratio of the last time on a path to the first."""
SPARE = 10.0
"""ln of what bounds may be larger than values."""


def along_hyperbolas(asked: Asked) -> Sampled | Refused:
    """Return a response; refused where something does not decay in r, or after very many time constants.

    Raises ModelError: SF910 where it is infinite at t = 0, and asked for there.
    """
    values: list[arb] = []
    for times in (1, 2, 4):
        values = []
        while len(values) < len(asked.times):
            part = _last_before(asked, len(asked.times) - len(values), times * asked.digits)
            if isinstance(part, Refused):
                return part
            values = [*part, *values]
        if is_precise(values, asked.digits):
            break
        asked = asked if asked.times.is_exact else replace(asked, times=asked.times.one_by_one())
    return Sampled(tuple(values), method="hyperbolas")


def _last_before(asked: Asked, end: int, digits: int) -> list[arb] | Refused:
    """Return the values at the last times before number ``end`` that one path serves."""
    bound, seconds, (turn, most_turn) = asked.bound, asked.times.seconds, TURNS
    last = float(seconds[end - 1])
    start = next(i for i in range(end) if seconds[i] * BAND >= last)
    mu = turn / (last or 1.0)
    while (far := _far_out(bound, asked.integrations, mu * (1 - arb(MIDDLE + ASIDE).sin()))) is None:
        turn, mu = 1.25 * turn, 1.25 * mu
        if turn > most_turn:
            return Refused("the last time is too many time constants away")
    if isinstance(far, Refused):
        return far
    size, power, limit = far
    if not last and power > -1 and limit != 0:
        message = f"the response of {bound.name} is infinite at t = 0"
        raise ModelError(Diagnostic("SF910", message, None, "in Python, ask for times after 0"))
    if not last:
        return [limit if power >= -1 else arb(0)]
    small = digits * log(10) + SPARE
    step = 2 * pi * ASIDE / (turn + small)
    count = ceil(acosh((1 + small / (mu * float(seconds[start]))) / sin(MIDDLE)) / step)
    bits = bits_for_digits(digits) + ceil((turn + SPARE) / log(2))
    with precision(bits):
        root, function = bound.root, bound.enclosed(bits)
        assert root is not None
        shift = root.shift / root.slope
        # Times are sums a + b, and so exponentials are products, as many as one of matrices holds.
        outer, inner = asked.times.spread(start)
        starts, waits = list[list[acb]](), list[list[acb]]()
        for k in range(count + 1):
            w = acb(arb(MIDDLE), -arb(step) * k)
            s = arb(mu) * (1 - w.sin()) - shift
            weight = (1 + bool(k)) * function(s) * w.cos() / s**asked.integrations
            starts.append([weight * (s * t).exp() for t in outer[: -(-(end - start) // len(inner))]])
            waits.append([(s * t).exp() for t in inner])
        sums = (acb_mat(starts).transpose() * acb_mat(waits)).entries()[: end - start]
        values = [arb(step) * arb(mu) / (2 * arb.pi()) * total.real for total in sums]
        times = asked.times.enclosed(start)[: end - start]
    with precision(64):
        most, edge = ball(max(power + 1, Fraction(1))), arb(step) * count
        scale = size * arb(mu) ** ball(power + 1) / arb.pi()
        scale *= (1 - arb(MIDDLE + ASIDE).sin()) ** ball(min(power, Fraction(0)))
        for i, t in enumerate(times):
            steep = mu * t * arb(MIDDLE).sin()
            between = 2 * (mu * t * arb(MIDDLE - ASIDE).sin()).bessel_k(most)
            between /= (2 * arb.pi() * arb(ASIDE) / step).expm1()
            slope = steep * edge.sinh() - most
            beyond = (most * edge - steep * edge.cosh()).exp() / slope
            reach = (scale * ((mu - shift) * t).exp() * (between + beyond)).upper()
            values[i] += arb(0, reach if slope > 0 and reach.is_finite() else arb("inf"))
    return values


def _far_out(
    bound: BoundTransferFunction, integrations: int, radius: arb
) -> tuple[arb, Fraction, arb] | Refused | None:
    """Return C, p and the limit of F/z^p beyond abs(z), None where poles may be; F is integrated so often."""
    root, evaluator = bound.root, bound.kernel_values()
    assert root is not None
    r, shift = (root.slope * radius) ** (arb(1) / root.order), root.shift / root.slope
    constants = {name: acb(c) for name, c in evaluator.constants.items()}
    rates: dict[str, tuple[arb, int]] = {}
    for kernel in bound.kernels.kernels:
        law = kernel.dispersion.shift
        order = sum(e * degree_in(f, 0) for f, e in law.factors)
        rate = at_centre(evaluator.value(law * kernel.length, {"s": acb(1), **constants})).real
        is_power = all(len(f) == 1 or not degree_in(f, 0) for f, _ in law.factors) and rate > 0
        if kernel.function != "exp" or not is_power or not 0 < order * STEEPEST / root.order < pi / 2:
            return Refused("not all waves decay as the root of s does")
        rates[kernel.generator] = rate * (arb(order * STEEPEST) / root.order).cos() * r**order, order
    size, limit, degree = abs(ball(bound.ratio.unit)), ball(bound.ratio.unit), 0
    for factor, exponent in bound.ratio.factors:
        terms = []
        for monomial, c in factor.terms():
            i, *others = map(int, monomial)
            used = [(n, e) for n, e in zip(bound.ratio.ring.names[1:], others, strict=True) if e]
            number = prod((constants[n].real ** e for n, e in used if n in constants), start=arb(int(c)))
            fall = [(e * rates[n][0], rates[n][1]) for n, e in used if n in rates]
            terms.append(
                (i, number, sum((x for x, _ in fall), arb(0)), sum((x * k for x, k in fall), arb(0)))
            )
        own = max((i for i, _, fall, _ in terms if fall == 0), default=None)
        top = max(i for i, *_ in terms) if own is None else own
        lead = sum((c for i, c, fall, _ in terms if i == own and fall == 0), arb(0))
        rest = [term for term in terms if term[0] != own or term[2] != 0]
        # r^(i - top) exp(-fall) falls from here on.
        if any(i > top and not slope > i - top for i, _, _, slope in rest):
            return None
        left = sum((abs(c) * r ** (i - top) * (-fall).exp() for i, c, fall, _ in rest), arb(0))
        if exponent < 0 and own is None:
            return Refused("something grows as the root of s does")
        if exponent < 0 and not left < 0.9 * abs(lead):
            return None
        size *= (abs(lead) + (left if exponent > 0 else -left)) ** exponent
        limit, degree = limit * lead**exponent, degree + top * exponent
    turned, power = root.slope ** (arb(degree) / root.order), Fraction(degree, root.order) - integrations
    return (
        (size * turned * (1 - shift / radius) ** -integrations, power, limit * turned)
        if shift < radius
        else None
    )
