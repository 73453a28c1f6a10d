"""Responses of functions with a root of s: Laplace's inverse integral along hyperbolas about the branch cut.

Input: a function of ``r = (a s + b)^(1/q)`` and exponentials in r. Output: values with rigorous bounds. Let
z = s + b/a. Far out, where one term outweighs all others in every factor, the function has no poles, and
abs(F) <= C abs(z)^p. All hyperbolas

    z = mu (1 - sin(a - j u)),    0 < a < STEEPEST - pi/2,

lie there if mu is large. The trapezoidal rule in u is off by no more than integrals along the outermost ones
say (Trefethen and Weideman 2014, SIAM Review 56, theorem 5.1), which are Bessel functions K.

    F = sqrt(a/s)/k, the surface of a semi-infinite body: a step in heat warms it by 2 sqrt(a t/pi)/k
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import acosh, ceil, inf, log, pi, sin

from flint import acb, acb_mat, arb

from symflex.algebra import degree_in
from symflex.analysis.time_response.sampled import Asked, Sampled, is_precise
from symflex.balls import ball, bits_for_digits, precision
from symflex.errors import Diagnostic, ModelError
from symflex.roots.distributed.far_out import SECTORS, FunctionFarOut
from symflex.transfer import BoundTransferFunction

MIDDLE, ASIDE, STEEPEST = 0.08 * pi, 0.07 * pi, 0.66 * pi  # of the path, of turned hyperbolas, beyond arg z
TURNS = (12.0, 2000.0)  # mu times the last time on a path: the first takes fewest points, the second seconds
SMALLEST = 1e-300  # radius of a value beside which nobody sees any: exponentials have smaller ones
BAND, SPARE = 6.0, 10.0  # ratio of last time to first on a path, and ln of bounds over values


def along_hyperbolas(asked: Asked) -> Sampled:
    """Return a response; SF910 where the function is not known far out, or infinite at t = 0."""
    bound, digits = asked.bound, asked.digits
    far = FunctionFarOut.of(bound, ceil(STEEPEST / bound.sheets / (pi / 2) * SECTORS))
    orders = [sum(degree_in(f, 0) * e for f, e in law.shift.factors) for law in bound.kernels.dispersions]
    if far is None or any(order >= bound.sheets for order in orders):
        raise _unavailable(bound, "not all waves decay as the root of s does")
    for factor in (1, 2, 4):
        values: list[arb] = []
        while len(values) < len(asked.times):
            values = [*_last_before(asked, len(asked.times) - len(values), factor * digits, far), *values]
        with precision(bits_for_digits(factor * digits)):
            begun = next((i for i, t in enumerate(asked.times.enclosed()) if t > 0), len(values))
        if is_precise(values[begun:], digits):
            break
        asked = asked if asked.times.is_exact else replace(asked, times=asked.times.one_by_one())
    return Sampled(tuple(values), method="hyperbolas")


def _unavailable(bound: BoundTransferFunction, reason: str, hint: str | None = None) -> ModelError:
    message = f"the response of {bound.name} in time is not available: {reason}"
    return ModelError(Diagnostic("SF910", message, None, hint))


def _last_before(asked: Asked, end: int, digits: int, far: FunctionFarOut) -> list[arb]:
    """Return the values at the last times before number ``end`` that one path serves."""
    bound, times, root = asked.bound, asked.times, asked.bound.root
    assert root is not None
    with precision(bits_for_digits(digits)):
        every = times.enclosed()
        seconds = [float(t.upper()) for t in every[:end]]
        is_start = not every[end - 1] > 0  # of what comes after a delay, maybe a ball about 0
    last, nearest = seconds[-1], (1 - sin(MIDDLE + ASIDE)) * (1 - 1e-9)
    start = end - 1 if is_start else next(i for i in range(end) if every[i] > 0 and seconds[i] * BAND >= last)
    # The path from the branch point, in z.
    fewest = 1.0 if is_start else TURNS[0]
    distance = max(fewest / (last or 1.0) * nearest, 2 * float(root.shift / root.slope))
    least = far.least(float((root.slope * distance) ** (arb(1) / root.order)))
    size = None if least is None else far.size(least)
    if least is None or size is None:
        raise _unavailable(bound, "not all waves decay as the root of s does")
    mu = float(arb(least) ** root.order / root.slope) / nearest
    turn, power = mu * last, size.power / root.order - asked.integrations
    if turn > TURNS[1]:
        raise _unavailable(bound, "the last time is too many time constants away")
    turned = root.slope ** ball(size.power / root.order)
    if is_start and power > -1 and (size.lead != 0 or last):
        raise _unavailable(bound, "it is infinite at t = 0", "in Python, ask for times after 0")
    if not last:
        return [(size.lead * turned).real if power >= -1 else arb(0)]
    with precision(64):
        most, shift = ball(max(power + 1, Fraction(1))), root.shift / root.slope
        scale = size.most * turned * arb(mu) ** ball(power + 1) / arb.pi()
        scale *= (1 - shift / (mu * arb(nearest))) ** -asked.integrations
        scale *= arb(nearest) ** ball(min(power, Fraction(0)))
        if is_start:  # the bound of the integral along a path in 1/t grows with t
            size_up_to = scale * arb(turn).exp() * (turn * arb(MIDDLE).sin()).bessel_k(most)
            return [arb(0, max(float(size_up_to.upper()) if size_up_to.is_finite() else inf, SMALLEST))]
    small = digits * log(10) + SPARE
    step = 2 * pi * ASIDE / (turn + small)
    count = ceil(acosh((1 + small / (mu * seconds[start])) / sin(MIDDLE)) / step)
    bits = bits_for_digits(digits) + ceil((turn + SPARE) / log(2))
    values = _trapezoidal(asked, range(start, end), bits, mu, step, count)
    errors: list[arb] = []
    with precision(64):
        edge = arb(step) * count
        for t in times.enclosed(start)[: end - start]:
            steep = mu * t * arb(MIDDLE).sin()
            between = 2 * (mu * t * arb(MIDDLE - ASIDE).sin()).bessel_k(most)
            between /= (2 * arb.pi() * arb(ASIDE) / step).expm1()
            slope = steep * edge.sinh() - most
            beyond = (most * edge - steep * edge.cosh()).exp() / slope
            reach = (scale * ((mu - shift) * t).exp() * (between + beyond)).upper()
            errors.append(arb(0, reach if slope > 0 and reach.is_finite() else arb("inf")))
    with precision(bits):
        return [value + error for value, error in zip(values, errors, strict=True)]


def _trapezoidal(asked: Asked, numbers: range, bits: int, mu: float, step: float, count: int) -> list[arb]:
    """Return sums over a path at some times."""
    with precision(bits):
        root, function = asked.bound.root, asked.bound.enclosed(bits)
        assert root is not None
        shift = root.shift / root.slope
        # Times are sums a + b, and so exponentials are products, as many as one of matrices holds.
        spread = asked.times.spread(numbers.start)
        rows = -(-len(numbers) // len(spread.inner))
        starts, waits = list[list[acb]](), list[list[acb]]()
        for k in range(count + 1):
            w = acb(arb(MIDDLE), -arb(step) * k)
            s = arb(mu) * (1 - w.sin()) - shift
            weight = (1 + bool(k)) * function(s) * w.cos() / s**asked.integrations
            outer, inner = spread.exponentials(s)
            starts.append([weight * grown for grown in outer[:rows]])
            waits.append(inner)
        sums = (acb_mat(starts).transpose() * acb_mat(waits)).entries()[: len(numbers)]
        return [arb(step) * arb(mu) / (2 * arb.pi()) * total.real for total in sums]
