"""The response to an input that is given by samples, and is a straight line between them.

Input: a bound transfer function, samples of its input, times. Output: an enclosed response.

    u = 0, 2, 3 at t = 0, 1, 2    is    2 r(t) - r(t - 1) - r(t - 2)

with the ramp r: one ramp more at every bend, and after the last sample the input stays where it is. So is the
response, with the ramp's response in place of r; one step comes first where the input begins with a jump.
Nothing is approximated between samples, and a step in time is never made. All times are whole multiples of
one duration, so the sum is a product of two polynomials, in balls.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
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

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from symflex.analysis.input_shaping import InputShaper
    from symflex.analysis.time_response.enclosed_response import EnclosedResponse
    from symflex.transfer import BoundTransferFunction

MORE_DIGITS = 10
"""Of the ramp's response: after many bends large terms cancel each other."""
BITS = 256
"""Of the sums: rounding adds nothing to the balls of what is summed."""
FORCED = "forced"
"""Name of an input that is given by samples."""


def forced_response(
    bound: BoundTransferFunction,
    sampled: Sequence[Fraction],
    values: Sequence[Fraction],
    times: Sequence[Fraction],
    digits: int = 12,
    shaper: InputShaper | None = None,
) -> EnclosedResponse:
    """Return the response, from rest, at ``times`` to an input with ``values`` at the times ``sampled`` [s].

    Before the first sample the input is 0, between two a straight line, after the last one it keeps its
    value; a ``shaper`` convolves it with its impulses.

    Raises
    ------
    UsageError
        SF811 for times that do not increase, or have no common measure coarse enough.
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
    ramp = time_response(bound, "ramp", lags, digits + MORE_DIGITS, shaper)
    if ramp.impulses or ramp.jumps:
        message = f"{bound.name} differentiates its input: an input with kinks makes its output jump"
        raise UncertifiedError(Diagnostic("SF810", message, None, "filter the output, or the input"))
    reasons = [ramp.reason]
    rises, runs = [b - a for a, b in pairwise(values)], [b - a for a, b in pairwise(bends)]
    slopes = [rise / (run * step) for rise, run in zip(rises, runs, strict=True)]
    impulses: tuple[ImpulseAt, ...] = ()
    jumps: tuple[JumpAt, ...] = ()
    with precision(BITS):
        turns = [arb(0)] * (bends[-1] + 1)
        for place, before, after in zip(bends, [Fraction(0), *slopes], [*slopes, Fraction(0)], strict=True):
            turns[place] = ball(after - before)
        total = (arb_poly(turns[:count]) * arb_poly(list(ramp.enclosures))).coeffs()
        total += [arb(0)] * (count - len(total))
        if values[0]:
            begun, origin = ball(values[0]), ball(first)
            sudden = time_response(bound, "step", lags, digits + MORE_DIGITS, shaper)
            reasons.append(sudden.reason)
            total = [y + begun * s for y, s in zip(total, sudden.enclosures, strict=False)]
            impulses = tuple(ImpulseAt(i.time + origin, i.order, i.weight * begun) for i in sudden.impulses)
            jumps = tuple(JumpAt(j.time + origin, j.height * begun) for j in sudden.jumps)
        response = tuple(total[i] if i >= 0 else arb(0) for i in moments)
    reason = next((r for r in reasons if r is not None), None)
    return replace(
        ramp,
        input=FORCED,
        times=np.array([float(t) for t in times]),
        enclosures=response,
        impulses=impulses,
        jumps=jumps,
        certified=reason is None,
        reason=reason,
        digits=digits,
        modes=None,
    )


def exact_values(values: npt.ArrayLike, count: int) -> list[Fraction]:
    """Return samples of an input as what they mean.

    Raises UsageError: SF811 when they are not finite, fewer than two, or not as many as their times.

    Examples
    --------
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
    for a, b in (*pairwise(sampled), *pairwise(times)):
        if not a < b:
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
