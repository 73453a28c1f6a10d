"""The response to an input that is given by samples, with straight lines or steps between them.

Input: a bound transfer function, samples of its input, times. Output: an enclosed response.

    u = 0, 2, 3 at t = 0, 1, 2    is    2 r(t) - r(t - 1) - r(t - 2)

with the ramp r: one ramp more at every bend, and after the last sample the input stays where it is. So is the
response, with the ramp's response in place of r. Where the input jumps, as it does at every sample that is
held and where two samples have one time, a step's response begins. Nothing is approximated between samples.
All times are whole multiples of one duration, so the sum is a product of polynomials, in balls.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise, zip_longest
from math import gcd, lcm
from typing import TYPE_CHECKING

import numpy as np
from flint import arb, arb_poly

from symflex.analysis.response import real_numbers
from symflex.analysis.time_response.find import time_response
from symflex.analysis.time_response.sample_times import MOST_TIMES, SampleTimes
from symflex.analysis.time_response.sampled import ImpulseAt, JumpAt
from symflex.balls import ball, precision
from symflex.errors import Diagnostic, UncertifiedError, UsageError
from symflex.model.loss_factors import check_causal
from symflex.options import exact
from symflex.transfer import AnyBoundFunction, BoundTransferFunction

if TYPE_CHECKING:
    import numpy.typing as npt

    from symflex.analysis.input_shaping import InputShaper
    from symflex.analysis.time_response.enclosed_response import EnclosedResponse

MORE_DIGITS = 10  # digits of the ramp's response beyond those printed: after many bends terms cancel
BITS = 256  # precision of the sums: rounding adds nothing to the balls of what is summed
FORCED = "forced"  # name of an input that is given by samples


def forced_response(
    bound: BoundTransferFunction,
    sampled: Sequence[Fraction],
    values: Sequence[Fraction],
    times: Sequence[Fraction],
    digits: int = 12,
    shaper: InputShaper | None = None,
    *,
    is_held: bool = False,
    free: AnyBoundFunction | None = None,
) -> EnclosedResponse:
    """Return the response, from rest, at ``times`` to an input with ``values`` at the times ``sampled`` [s].

    Before the first sample the input is 0, between two a straight line, after the last one it keeps its
    value; with ``is_held`` it keeps every value until the next. Two samples at one time are a jump; there the
    value of the response is that after it. A ``shaper`` convolves the input with its impulses. A
    :func:`~symflex.analysis.time_response.free_motion` from the first sample on is added.

    Raises
    ------
    UsageError
        SF811 for times that decrease, or have no common measure coarse enough.
    UncertifiedError
        SF810 where the transfer function differentiates its input: the response would have impulses.

    Examples
    --------
    >>> from symflex import loads
    >>> integrator = loads('symflex = 1' + chr(10) + 'inputs.u = {}' + chr(10) + 'outputs.y = "u/s"')
    >>> half, one = Fraction(1, 2), Fraction(1)
    >>> found = forced_response(
    ...     integrator.transfer_function("y", "u").bind().bound, (0, one), (0, one), (half, one, 2 * one)
    ... )
    >>> found.values.tolist()
    [0.125, 0.5, 1.5]
    """
    check_causal(bound.source.model, "a response in time")
    first, step, places = _grid(sampled, times)
    bends, moments = places[: len(sampled)], places[len(sampled) :]
    count = max(moments, default=0) + 1
    lags = SampleTimes.evenly(step * max(count - 1, 1), max(count, 2))
    turns, leaps = dict.fromkeys(bends, Fraction(0)), dict.fromkeys(bends, Fraction(0))
    leaps[bends[0]] = values[0]
    for (start, low), (end, high) in pairwise(zip(bends, values, strict=True)):
        if is_held or start == end:
            leaps[end] += high - low
        else:
            slope = (high - low) / ((end - start) * step)
            turns[start], turns[end] = turns[start] + slope, turns[end] - slope
    parts = {
        kind: {i: x for i, x in sizes.items() if x and i < count}
        for kind, sizes in (("ramp", turns), ("step", leaps))
    }
    if not any(parts.values()):
        parts["ramp"] = {0: Fraction(0)}  # whose response says what is proved
    unit = {
        k: time_response(bound, k, lags, digits + MORE_DIGITS, shaper) for k, sizes in parts.items() if sizes
    }
    if free is not None:
        parts["free"] = {0: Fraction(1)}
        unit["free"] = time_response(free, "impulse", lags, digits + MORE_DIGITS)
    if "ramp" in unit and (unit["ramp"].impulses or unit["ramp"].jumps):
        message = f"{bound.name} differentiates its input: an input with kinks makes its output jump"
        raise UncertifiedError(Diagnostic("SF810", message, None, "filter the output, or the input"))
    total = [arb(0)] * count
    impulses: list[ImpulseAt] = []
    jumps: list[JumpAt] = []
    with precision(BITS):
        for kind, unit_response in unit.items():
            sizes = [ball(parts[kind].get(i, Fraction(0))) for i in range(max(parts[kind]) + 1)]
            summed = (arb_poly(sizes) * arb_poly(list(unit_response.enclosures))).coeffs()
            total = [a + b for a, b in zip_longest(total, summed[:count], fillvalue=arb(0))]
            for index, size in parts[kind].items():
                at, factor = ball(first + index * step), ball(size)
                impulses += [
                    ImpulseAt(i.time + at, i.order, i.weight * factor) for i in unit_response.impulses
                ]
                at_once = [JumpAt(arb(0), unit_response.enclosures[0])] if index and kind == "step" else []
                fronts = [j for j in (*at_once, *unit_response.jumps) if not j.height.contains(0)]
                jumps += [JumpAt(j.time + at, j.height * factor) for j in fronts]
        response = tuple(total[i] if i >= 0 else arb(0) for i in moments)
    reason = next(
        (unit_response.reason for unit_response in unit.values() if unit_response.reason is not None), None
    )
    seconds, jumps = np.array([float(t) for t in times]), sorted(jumps, key=lambda j: j.time.mid())
    forced = replace(next(iter(unit.values())), input=FORCED, times=seconds, enclosures=response, modes=None)
    forced = replace(forced, impulses=tuple(impulses), jumps=tuple(jumps), digits=digits)
    return replace(forced, certified=reason is None, reason=reason)


def exact_values(values: npt.ArrayLike, count: int) -> list[Fraction]:
    """Return samples of an input as what they mean.

    Raises UsageError: SF811 when they are not finite, fewer than two, or not as many as their times.

    >>> exact_values([0, 0.1], 2)
    [Fraction(0, 1), Fraction(1, 10)]
    """
    given = real_numbers(values, "values of an input", "SF811")
    if given.shape != (count,) or count < 2 or not np.isfinite(given).all():  # noqa: PLR2004 (a line has two ends)
        message = (
            f"an input needs two or more finite values, one for each time: {given.size} values for {count} "
            "times"
        )
        raise UsageError(Diagnostic("SF811", message))
    return [exact(v) for v in given.tolist()]


def _grid(sampled: Sequence[Fraction], times: Sequence[Fraction]) -> tuple[Fraction, Fraction, list[int]]:
    """Return the first sample's time, a step all times are multiples of from there, and these multiples."""
    every = [*sampled, *times]
    falling = (p for p in pairwise(sampled) if p[1] < p[0])
    for a, b in (*falling, *(p for p in pairwise(times) if p[1] <= p[0])):
        message = f"times must increase: {float(b):g} s follows {float(a):g} s"
        raise UsageError(Diagnostic("SF811", message))
    off = [t - sampled[0] for t in every]
    scale = lcm(*(t.denominator for t in off))
    step = Fraction(gcd(*(int(t * scale) for t in off)), scale) or Fraction(1)
    places = [int(t / step) for t in off]
    if max(places) > MOST_TIMES:
        message = f"the times have no usable common step: the last is {max(places):.3g} times the longest one"
        raise UsageError(Diagnostic("SF811", message, None, "sample the input evenly"))
    return Fraction(sampled[0]), step, places
