"""All roots of a real function of frequency between two limits, each enclosed and none missing.

An interval of frequencies is dropped where the function, or what the caller asks for, excludes it; it is kept
where the function is monotonous and changes its sign; else it is halved.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from flint import arb

from symflex.errors import BudgetError, Diagnostic
from symflex.roots import Budget, precision
from symflex.roots.precision import bits_for_digits

if TYPE_CHECKING:
    from collections.abc import Callable

    from symflex.loops.loop import LoopFunction, LoopValue

BITS = 96
"""Of intervals, whose ends are doubles."""
FIRST_RATIO = 1.25
"""Of the ends of the first intervals."""
NARROWEST = 1e-11
"""Relative width of an interval that is not halved any more."""
MOST_INTERVALS = 40_000
"""Of one search, before it is given up."""
NEWTON_STEPS = 60
"""Each nearly doubles the digits, so that few are ever taken."""


@dataclass(frozen=True, slots=True)
class AxisRoots:
    """What was found between two frequencies."""

    roots: tuple[arb, ...]  # enclosures [rad/s], ascending; one simple root each
    undecided: tuple[arb, ...]  # narrow intervals about which nothing is proved [rad/s]


def find_on_axis(
    function: LoopFunction,
    equation: Callable[[LoopValue], tuple[arb, arb]],
    is_excluded: Callable[[LoopValue], bool],
    limits: tuple[float, float],
    digits: int,
    budget: Budget,
    order: int = 1,
) -> AxisRoots:
    """Return the roots of a real function of A and B at ``s = j omega``, 0 < omega [rad/s] within limits.

    ``equation`` returns its value and its derivative in omega, from ``order`` derivatives of A and B;
    ``is_excluded`` tells that roots among these values are not asked for. The budget is spent by every
    interval: SF505, SF506 when there are too many, or the time is over.
    """
    low, high = limits
    pending: list[tuple[float, float]] = []
    end = low
    while end < high:
        start, end = end, min(end * FIRST_RATIO, high)
        pending.append((start, end))
    pending.reverse()
    roots: list[arb] = []
    undecided: list[arb] = []
    for _ in range(MOST_INTERVALS):
        if not pending:
            return AxisRoots(tuple(roots), _joined(undecided))
        budget.spend()
        start, end = pending.pop()
        ball = _between(start, end)
        around, centre = function.on(ball, BITS, order)
        with precision(BITS):
            if is_excluded(around):
                continue
            value, slope = equation(around)
            middle, _ = equation(centre)
            mean = middle + slope * (ball - ball.mid())
            if value != 0 or mean != 0:
                continue
            if slope != 0:
                ends = [equation(function.on(arb(x), BITS, order)[1])[0] for x in (start, end)]
                if all(x != 0 for x in ends):
                    if bool(ends[0] > 0) != bool(ends[1] > 0):
                        roots.append(_refined(function, equation, ball, digits, order))
                    continue
        if end - start < NARROWEST * end:
            undecided.append(ball)
            continue
        # Off the middle, so that a root there does not stay on an end for ever.
        cut = start + 0.4873 * (end - start)
        pending += [(cut, end), (start, cut)]
    message = "the search for crossings of the imaginary axis takes too long"
    raise BudgetError(Diagnostic("SF505", message, None, "narrow the range of the gain, or lower --up-to"))


def _between(start: float, end: float) -> arb:
    with precision(BITS):
        return (arb(start) + arb(end)) / 2 + arb(0, ((arb(end) - arb(start)) / 2).upper())


def _refined(
    function: LoopFunction,
    equation: Callable[[LoopValue], tuple[arb, arb]],
    ball: arb,
    digits: int,
    order: int,
) -> arb:
    """Return a narrower enclosure of the only root in an interval on which the function is monotonous.

    Steps as in :mod:`symflex.algebra.interval_newton`, at a precision that rises with what is known.
    """
    wanted = bits_for_digits(digits) + 16
    for step in range(NEWTON_STEPS):
        bits = min(max(BITS, 2 * ball.rel_accuracy_bits() + 64), 2 * wanted + BITS)
        around, centre = function.on(ball, bits, order)
        with precision(bits):
            _, slope = equation(around)
            value, _ = equation(centre)
            if slope.contains(0):
                return ball
            candidate = ball.mid() - value / slope
            if not candidate.overlaps(ball):
                return ball
            narrower = ball.intersection(candidate)
            stalled = narrower.rad() > ball.rad() * 0.9
            ball = narrower
        if ball.rel_accuracy_bits() >= wanted or (stalled and step):
            return ball
    return ball


def _joined(intervals: list[arb]) -> tuple[arb, ...]:
    """Return intervals, neighbours as one."""
    found: list[arb] = []
    for interval in intervals:
        if found and found[-1].overlaps(interval):
            found[-1] = found[-1].union(interval)
        else:
            found.append(interval)
    return tuple(found)
