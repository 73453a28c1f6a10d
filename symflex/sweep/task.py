"""What is wanted at every point of a sweep."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
import numpy.typing as npt

from symflex.model import Model, with_numbers

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.roots import Region
    from symflex.sweep.design import Point
    from symflex.transfer import TransferFunction

Array = npt.NDArray[Any]
Rows = dict[str, Array]
"""Arrays by name; their first axis counts points."""

CODE_LENGTH = 5


class Derive(Protocol):
    """A function that derives transfer functions; one a worker can import by its name."""

    def __call__(
        self, model: Model, pairs: Sequence[tuple[str, str]] | None = None
    ) -> tuple[TransferFunction, ...]:
        """Return the transfer functions of the given pairs."""
        ...


@dataclass(frozen=True)
class Task:
    """What is wanted at every point."""

    model: Model  # resolved; sent to workers as it is
    pair: tuple[str, str]  # output and input
    of: str  # a key of :data:`QUANTITIES`
    names: tuple[str, ...]  # the swept parameters, in the order of a point's values
    derive: Derive  # from a model to transfer functions
    region: Region | None = None  # where roots are sought
    frequencies: tuple[float, ...] = ()  # of a response [Hz]
    gain: str = ""  # of margins


class Solver(Protocol):
    """Computes rows of results for points."""

    def __call__(self, points: Sequence[Point]) -> Rows:
        """Return arrays whose first axis counts the points."""
        ...


def fingerprint(task: Task) -> str:
    """Return a text that differs wherever a task does, the same in every process and on every run."""
    plain = (task.model, task.pair, task.of, task.names, task.region, task.frequencies, task.gain)
    # Elements are one object each; where it lies in memory says nothing.
    return re.sub(r" at 0x[0-9a-fA-F]+", "", repr(plain))


def derived(task: Task, *symbols: str) -> TransferFunction:
    """Return the task's transfer function, with the swept parameters and others as symbols."""
    return task.derive(with_numbers(task.model, (*task.names, *symbols)), [task.pair])[0]


def codes_of(codes: Sequence[str]) -> Array:
    """Return error codes as an array, empty where nothing failed."""
    return np.array(codes, f"<U{CODE_LENGTH}")
