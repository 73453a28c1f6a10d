"""One measurement, made in a process of its own so that it can be stopped."""

from __future__ import annotations

import math
import os
import resource
import statistics
import subprocess
import sys
import time
from dataclasses import dataclass
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

T = TypeVar("T")

OTHER_PYTHON = "SYMFLEX_BENCH_PYTHON"
"""Environment variable: an interpreter that has the programs symflex is compared with."""
OWN = 60.0
"""Seconds symflex may take where less is the limit: beside a run that was stopped no ratio means anything."""


@dataclass(frozen=True, slots=True)
class Extent:
    """How much of every benchmark is measured.

    Parameters
    ----------
    limit : float
        Seconds each way may take.
    is_quick : bool
        Whether to measure only what enforced ratios need, at sizes that take seconds.
    """

    limit: float
    is_quick: bool = False

    def of(self, full: T, quick: T) -> T:
        """Return what a quick run takes in place of the full one's sizes, rounds or ways.

        Examples
        --------
        >>> Extent(10.0, is_quick=True).of((100, 1_000, 10_000), (100, 1_000))
        (100, 1000)
        """
        return quick if self.is_quick else full


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
    peak_mb : float, optional
        The most memory its process held, interpreter and libraries included [MB]; ``None`` when it was not
        measured.
    """

    task: str
    way: str
    seconds: float | None
    limit: float
    peak_mb: float | None = None

    @property
    def at_least(self) -> float:
        """The time in seconds, or the limit when it was reached: a lower bound either way."""
        return self.limit if self.seconds is None else self.seconds

    @property
    def taken(self) -> float:
        """The time in seconds, nan when the limit was reached: no bound on it can be kept then."""
        return math.nan if self.seconds is None else self.seconds


def fastest(
    ways: Mapping[str, Callable[[], NDArray[Any]]], limit: float, *, rounds: int, agreement: float
) -> dict[str, float]:
    """Return the fastest of some runs of every way, in seconds; see :func:`taking_turns`."""
    runs = taking_turns(ways, limit, rounds=rounds, agreement=agreement)
    return {name: min(times) for name, times in runs.items()}


def taking_turns(
    ways: Mapping[str, Callable[[], NDArray[Any]]], limit: float, *, rounds: int, agreement: float
) -> dict[str, list[float]]:
    """Return the times of some runs of every way, in seconds of processor time; the ways take turns.

    Raises
    ------
    RuntimeError
        When half of the values of one way differ relatively from the first one's by more than ``agreement``.
    """
    runs: dict[str, list[float]] = {name: [] for name in ways}
    begin = time.process_time()
    with np.errstate(all="ignore"):
        first, *others = (way() for way in ways.values())
        for name, other in zip(list(ways)[1:], others, strict=True):
            if np.median(np.abs(other - first) / np.abs(first)) > agreement:
                message = f"{name} does not agree"
                raise RuntimeError(message)
        for _ in range(rounds):
            for name, way in ways.items():
                started = time.process_time()
                way()
                runs[name].append(time.process_time() - started)
            if time.process_time() - begin > limit:
                break
    return runs


def typical_ratio(longer: Sequence[float], shorter: Sequence[float]) -> float:
    """Return the median ratio of runs that took turns: what slows the machine slows both of a pair."""
    return statistics.median(a / b for a, b in zip(longer, shorter, strict=True))


@dataclass(frozen=True, slots=True)
class Claim:
    """What this run measured, and the bound it must keep.

    Parameters
    ----------
    text : str
        What is measured, in words.
    bound : float
        The floor, or the ceiling when smaller is better.
    measured : float
        In this run; nan, which keeps no bound, where symflex itself was stopped at its limit.
    larger_is_better : bool
        False when the bound is a ceiling.
    is_ratio : bool
        False for a time in itself, which depends on the machine: it is printed and not enforced.
    """

    text: str
    bound: float
    measured: float
    larger_is_better: bool = True
    is_ratio: bool = True

    @property
    def holds(self) -> bool:
        """Whether this run keeps the bound."""
        return self.measured >= self.bound if self.larger_is_better else self.measured <= self.bound


class Measured(NamedTuple):
    """What a benchmark returns: times, bounds, and tables of its own in Markdown."""

    measurements: list[Measurement]
    claims: list[Claim]
    tables: tuple[str, ...] = ()

    @property
    def missed(self) -> int:
        """The number of ratios that miss their bounds."""
        return sum(claim.is_ratio and not claim.holds for claim in self.claims)


def times_as_fast(ours: Measurement, *theirs: Measurement) -> float:
    """Return how many times as long the fastest other way took, or more; nan where ours was stopped."""
    return min(other.at_least for other in theirs) / ours.taken


def milliseconds(text: str, seconds: float, ours: Measurement) -> Claim:
    """Return the claim that a time is no longer, in milliseconds."""
    return Claim(text, 1e3 * seconds, 1e3 * ours.taken, larger_is_better=False, is_ratio=False)


def run_snippet(
    task: str, way: str, code: str, limit: float, interpreter: str = sys.executable
) -> Measurement:
    """Run Python code that prints the seconds it took, and stop it at the limit."""
    try:
        done = subprocess.run(
            [interpreter, "-c", code + PEAK], capture_output=True, text=True, timeout=limit, check=True
        )
    except subprocess.TimeoutExpired:
        return Measurement(task, way, None, limit)
    seconds, *peak = done.stdout.split()
    return Measurement(task, way, float(seconds), limit, float(peak[0]) / 1e3 if peak else None)


PEAK = """
from pathlib import Path
status = Path("/proc/self/status")
if status.exists():
    print(*(line.split()[1] for line in status.read_text().splitlines() if line.startswith("VmHWM")))
"""
"""Linux: the high-water mark of this process alone; getrusage passes on that of its parent."""


def interpreter_with(module: str) -> str | None:
    """Return an interpreter that has a module: this one, or that of ``SYMFLEX_BENCH_PYTHON``, or None."""
    if find_spec(module) is not None:
        return sys.executable
    other = os.environ.get(OTHER_PYTHON)
    if not other:
        return None
    tried = subprocess.run([other, "-c", f"import {module}"], capture_output=True, check=False)
    return other if tried.returncode == 0 else None


def time_commands(
    task: str, commands: Mapping[str, Sequence[str]], repeats: int, environment: Mapping[str, str]
) -> list[Measurement]:
    """Return the median processor time of each command, start to end; the commands take turns."""
    times: dict[str, list[float]] = {way: [] for way in commands}
    for _ in range(repeats + 1):
        for way, command in commands.items():
            begin = _spent()
            subprocess.run(command, capture_output=True, check=True, env=environment)
            times[way].append(_spent() - begin)
    return [
        Measurement(task, way, statistics.median(taken[1:]), float("inf"), _peak(commands[way], environment))
        for way, taken in times.items()
    ]


def _peak(command: Sequence[str], environment: Mapping[str, str]) -> float | None:
    """Return the most memory a command of Python held [MB], run once more as it would print that."""
    interpreter, switch, *rest = command
    if switch == "-c":
        code = rest[0] + PEAK
    else:
        code = f"import runpy, sys\nsys.argv = {['symflex', *rest[1:]]!r}\n" + COMMAND + PEAK
    done = subprocess.run(
        [interpreter, "-c", code], capture_output=True, text=True, check=True, env=environment
    )
    last = done.stdout.split()[-1:]
    return float(last[0]) / 1e3 if last and last[0].isdigit() else None


COMMAND = """
try:
    runpy.run_module("symflex", run_name="__main__")
except SystemExit:
    pass
"""


def _spent() -> float:
    """Return the processor time of all processes that were waited for, in seconds."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime
