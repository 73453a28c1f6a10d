"""One measurement, made in a process of its own so that it can be stopped."""

from __future__ import annotations

import statistics
import subprocess
import sys
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence


@dataclass(frozen=True, slots=True)
class Measurement:
    """How long one way of doing one task took.

    Parameters
    ----------
    task : str
        What is done, the same for all ways that are compared.
    way : str
        What does it.
    seconds : float, optional
        ``None`` when the limit was reached.
    limit : float
        The limit in seconds.
    """

    task: str
    way: str
    seconds: float | None
    limit: float

    @property
    def at_least(self) -> float:
        """The time in seconds, or the limit when it was reached: a lower bound either way."""
        return self.limit if self.seconds is None else self.seconds


@dataclass(frozen=True, slots=True)
class Claim:
    """A ratio the documentation states, and the one measured now.

    Parameters
    ----------
    text : str
        The claim in words.
    stated : float
        The ratio stated.
    measured : float
        The ratio of this run.
    larger_is_better : bool
        False when the claim is an upper bound.
    """

    text: str
    stated: float
    measured: float
    larger_is_better: bool = True

    @property
    def holds(self) -> bool:
        """Whether this run is within a factor of two of the claim, or better than it."""
        if self.larger_is_better:
            return self.measured >= self.stated / 2
        return self.measured <= self.stated * 2


def run_snippet(task: str, way: str, code: str, limit: float) -> Measurement:
    """Run Python code that prints the seconds it took, and stop it at the limit."""
    try:
        done = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, timeout=limit, check=True
        )
    except subprocess.TimeoutExpired:
        return Measurement(task, way, None, limit)
    return Measurement(task, way, float(done.stdout), limit)


def time_command(task: str, way: str, command: Sequence[str], repeats: int) -> Measurement:
    """Return the median wall-clock time of a command, start to end."""
    times = []
    for _ in range(repeats + 1):
        begin = time.perf_counter()
        subprocess.run(command, capture_output=True, check=True)
        times.append(time.perf_counter() - begin)
    return Measurement(task, way, statistics.median(times[1:]), float("inf"))
