"""What is asked of a way of finding a response, and what it hands back."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

from flint import arb

from symflex.analysis.time_response.delayed_terms import DelayedQuotient, read_delays
from symflex.analysis.time_response.partial_fractions import ExponentialTerm
from symflex.analysis.time_response.sample_times import SampleTimes
from symflex.transfer import BoundTransferFunction

ZERO: Final = arb(0)


@dataclass(frozen=True, slots=True)
class ImpulseAt:
    """An impulse in a response, or a derivative of one: it has a weight, and no value."""

    time: arb  # [s]
    order: int  # 0 for an impulse, 1 for its derivative, and so on
    weight: arb  # enclosure, in the output's unit times seconds to the power of order + 1


@dataclass(frozen=True, slots=True)
class JumpAt:
    """A time at which a response jumps, a front that arrives; what rises is the value."""

    time: arb  # [s]
    height: arb  # of the value after it over that before


@dataclass(frozen=True, slots=True)
class PartialSum:
    """The sum over some modes, at all times, and how much all others add at most."""

    terms: tuple[ExponentialTerm, ...]
    values: tuple[arb, ...]  # of the terms, at all times
    rest: arb  # at any time
    at_times: tuple[arb, ...] = ()  # at each of the times, where that is less
    fade: arb = ZERO  # at t exp(-fade t) times the rest is left, at most [1/s]
    method: str = ""  # what bounds the rest, such as ``passive modes``

    @property
    def left(self) -> arb:
        """The most that is left at any of the times."""
        return max(self.at_times, default=self.rest, key=arb.mid).upper()

    @property
    def largest(self) -> arb:
        """The largest absolute value."""
        return max((abs(y.mid()) for y in self.values), default=arb(0))

    @property
    def sampled(self) -> Sampled:
        """The response, with what is left out as part of its balls."""
        rests = self.at_times or (self.rest,) * len(self.values)
        values = tuple(y + arb(0, tail.upper()) for y, tail in zip(self.values, rests, strict=True))
        return Sampled(values, modes=self, method=self.method)


@dataclass(frozen=True)
class Sampled:
    """Values at given times, and what is between and besides them."""

    values: tuple[arb, ...]
    impulses: tuple[ImpulseAt, ...] = ()
    jumps: tuple[JumpAt, ...] = ()
    at_jumps: frozenset[int] = frozenset()  # positions of values that contain both sides of a jump
    modes: PartialSum | None = None  # of which it is a sum, at any time
    method: str = ""  # what found it, such as ``echoes``; empty where there is nothing to find
    reason: str | None = None  # what is not proved
    refused: tuple[str, ...] = ()  # why ways that would prove it do not answer


@dataclass(frozen=True, slots=True)
class Refused:
    """Why a way does not lead to a response; no reason where it is none for such a function."""

    reason: str = ""


@dataclass(frozen=True)
class Asked:
    """A response from rest to a unit impulse that was integrated so often, at some times."""

    bound: BoundTransferFunction
    integrations: int
    times: SampleTimes
    digits: int  # of the largest value

    @cached_property
    def has_delays(self) -> bool:
        """Whether the function contains pure delays."""
        return any(law.kind == "exponential" for law in self.bound.kernels.dispersions)

    @cached_property
    def quotient(self) -> DelayedQuotient | None:
        """The function as a quotient of delays; None if it contains anything else."""
        return self._delays if isinstance(self._delays, DelayedQuotient) else None

    @property
    def why_no_quotient(self) -> str:
        """Why there is no such quotient; empty where there is, and for a function without waves."""
        return self._delays if isinstance(self._delays, str) else ""

    @cached_property
    def _delays(self) -> DelayedQuotient | str:
        return "" if self.bound.is_rational else read_delays(self.bound)


class Gathered:
    """The sum of what has come by each time [s]."""

    def __init__(self, seconds: Sequence[arb]) -> None:
        self._seconds = seconds
        self._values = [arb(0)] * len(seconds)
        self._impulses: list[ImpulseAt] = []
        self._jumps: list[JumpAt] = []
        self._at_jumps: set[int] = set()

    def start(self, delay: arb) -> int:
        """Return the number of the first time that may lie after a delay."""
        return next((i for i, t in enumerate(self._seconds) if not t < delay), len(self._seconds))

    def add(
        self, delay: arb, weights: Sequence[arb], height: arb, values: Iterable[arb], *, is_late: bool
    ) -> None:
        """Add what comes after a delay: weights of impulses, a jump, and values from then on."""
        self._impulses += [ImpulseAt(delay, k, w) for k, w in enumerate(weights) if not w.contains(0)]
        if is_late and not height.contains(0):
            self._jumps.append(JumpAt(delay, height))
        for i, value in enumerate(values, self.start(delay)):
            if is_late and not self._seconds[i] > delay:
                self._values[i] = self._values[i] + value.union(arb(0))
                self._at_jumps |= set() if height == 0 else {i}
            else:
                self._values[i] = self._values[i] + value

    def sampled(self, method: str) -> Sampled:
        """Return all of it."""
        values, jumps = tuple(self._values), tuple(self._jumps)
        return Sampled(values, tuple(self._impulses), jumps, frozenset(self._at_jumps), method=method)


def is_precise(values: Sequence[arb], digits: int) -> bool:
    """Tell whether all balls are narrow beside the largest value.

    >>> is_precise([arb(0, 1e-13), arb(1)], 12), is_precise([arb(0, 1e-3), arb(1)], 12)
    (True, False)
    """
    if not all(map(arb.is_finite, values)):
        return False
    largest = max(map(abs, map(arb.mid, values)), default=arb(0))
    return bool(max(map(arb.rad, values), default=arb(0)) <= largest * arb(10) ** -digits)
