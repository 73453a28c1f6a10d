"""What is wanted at every point of a sweep; and the points, in order, each with exact values."""

from __future__ import annotations

import re
from dataclasses import dataclass
from decimal import Decimal, localcontext
from fractions import Fraction
from functools import cached_property
from itertools import product
from math import pi, prod
from random import Random
from typing import TYPE_CHECKING, Any, Literal, Protocol

import numpy as np
import numpy.typing as npt

from symflex.errors import BudgetError, Diagnostic
from symflex.model import ExactValue, Model, with_numbers

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.roots import Region
    from symflex.transfer import TransferFunction


Scale = Literal["lin", "log"]
Point = tuple[ExactValue, ...]

POINTS_LIMIT = 1_000_000
"""Points of one sweep."""
DIGITS = 15
"""Significant digits of values between limits: as many as a double tells apart, so that files hold all."""
WORKING_DIGITS = 40


@dataclass(frozen=True, slots=True)
class Axis:
    """The values of one parameter in a grid."""

    name: str  # of the parameter
    values: tuple[ExactValue, ...]  # in SI units, in the order given


@dataclass(frozen=True, slots=True)
class Range:
    """Between which limits values are drawn."""

    name: str  # of the parameter
    # low and high: in SI units; of the same power of pi.
    low: ExactValue
    high: ExactValue
    # ``lin`` for a uniform distribution, ``log`` for one that is uniform in the logarithm.
    scale: Scale = "lin"

    def at(self, share: Fraction) -> ExactValue:
        """Return the value at a share of the way from ``low`` to ``high``, in 15 significant digits."""
        if share in (0, 1):
            return self.high if share else self.low
        low, high = self.low.rational, self.high.rational
        with localcontext() as context:
            context.prec = WORKING_DIGITS
            if self.scale == "log":
                value = _decimal(low) * ((_decimal(high) / _decimal(low)).ln() * _decimal(share)).exp()
            else:
                value = _decimal(low + (high - low) * share)
            context.prec = DIGITS
            return ExactValue(Fraction(+value), self.low.pi_power)


@dataclass(frozen=True)
class Design:
    """The points of a sweep: the product of the axes, and for each of its points all draws.

    SF507 for more than a million points.

    Examples
    --------
    >>> grid = Design((Axis("m", (ExactValue(Fraction(1)), ExactValue(Fraction(2)))),))
    >>> grid.count, grid.names, [point[0].rational for point in grid.points]
    (2, ('m',), [Fraction(1, 1), Fraction(2, 1)])
    """

    axes: tuple[Axis, ...] = ()  # the last one varies fastest
    # Drawn from, as a Latin hypercube: each of the N equal parts of every range is met once.
    ranges: tuple[Range, ...] = ()
    draws: int = 0  # n; 0 for a grid alone
    seed: int = 1  # of the random numbers, which are those of Python's own generator and the same everywhere

    def __post_init__(self) -> None:
        if self.count > POINTS_LIMIT:
            raise too_many_points(self.count)

    @property
    def names(self) -> tuple[str, ...]:
        """The swept parameters, those on axes first."""
        return (*(axis.name for axis in self.axes), *(r.name for r in self.ranges))

    @property
    def shape(self) -> tuple[int, ...]:
        """Length of every axis, and the number of draws where there are any."""
        return (*(len(axis.values) for axis in self.axes), *((self.draws,) if self.draws else ()))

    @property
    def count(self) -> int:
        """Number of points."""
        return prod(self.shape)

    @cached_property
    def points(self) -> tuple[Point, ...]:
        """All points, the draws varying fastest, then the last axis."""
        grid = product(*(axis.values for axis in self.axes))
        if not self.draws:
            return tuple(grid)
        drawn = tuple(zip(*(self._column(r) for r in self.ranges), strict=True))
        return tuple((*place, *draw) for place in grid for draw in drawn)

    @cached_property
    def shares(self) -> tuple[tuple[float, ...], ...]:
        """Per range and draw, where it lies between the limits, from 0 to 1."""
        random = Random(self.seed)
        columns = []
        for _ in self.ranges:
            keys = [random.random() for _ in range(self.draws)]
            # Sorting keys shuffles alike on every version of Python; shuffle() does not promise that.
            places = sorted(range(self.draws), key=keys.__getitem__)
            columns.append(tuple((place + random.random()) / self.draws for place in places))
        return tuple(columns)

    def _column(self, limits: Range) -> tuple[ExactValue, ...]:
        shares = self.shares[self.ranges.index(limits)]
        return tuple(limits.at(Fraction(share)) for share in shares)


def too_many_points(count: int | str) -> BudgetError:
    """Return the error that says how many points a sweep may have; a count of many digits comes as text."""
    message = f"a sweep has at most {POINTS_LIMIT} points, not {count}"
    return BudgetError(Diagnostic("SF507", message, None, "sweep fewer parameters, or fewer values of each"))


def between(limits: Range, count: int) -> tuple[ExactValue, ...]:
    """Return values from one limit to the other, equally spaced in the range's scale.

    Examples
    --------
    >>> limits = Range("k", ExactValue(Fraction(0)), ExactValue(Fraction(1)))
    >>> [str(value.rational) for value in between(limits, 3)]
    ['0', '1/2', '1']
    """
    if count == 1:
        return (limits.low,)
    return tuple(limits.at(Fraction(i, count - 1)) for i in range(count))


def points_between(start: Point, end: Point, pieces: int) -> list[Point] | None:
    """Return the points that divide the way from one point to another into equal pieces.

    ``None`` where their values differ by a power of pi.
    """
    if any(a.pi_power != b.pi_power for a, b in zip(start, end, strict=True)):
        return None
    shares = (Fraction(i, pieces) for i in range(1, pieces))
    return [
        tuple(
            ExactValue(a.rational + (b.rational - a.rational) * share, a.pi_power)
            for a, b in zip(start, end, strict=True)
        )
        for share in shares
    ]


def number(value: ExactValue) -> float:
    """Return the nearest double in SI units, to the last bit where no power of pi stands in it."""
    return float(value.rational) * pi**value.pi_power


def written(value: ExactValue) -> str:
    """Return a value exactly, as text."""
    return str(value.rational) + (f"*pi^{value.pi_power}" if value.pi_power else "")


def _decimal(value: Fraction) -> Decimal:
    return Decimal(value.numerator) / Decimal(value.denominator)


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
