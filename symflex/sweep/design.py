"""What is wanted at every point of a sweep; and the points, in order, each with exact values.

Designs are read from text such as ``k=1e4:1e6:log:200``, ``m_2=1,2,5``, ``l=+-5%``.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext
from fractions import Fraction
from functools import cached_property
from itertools import product
from math import pi, prod
from random import Random
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from symflex.errors import BudgetError, Diagnostic, Source, Span, SpecError, Text, UsageError, refused
from symflex.loops import pick_gain
from symflex.model import ExactValue, Model, ModelParameter, check_value, with_numbers
from symflex.quantities import parse_quantity
from symflex.roots import Region
from symflex.transfer import AnyTransferFunction, Given
from symflex.transfer.bind import read_values
from symflex.transfer.of_model import derive_all, derive_as

Scale = Literal["lin", "log"]
Point = tuple[ExactValue, ...]

POINTS_LIMIT = 1_000_000  # points of one sweep
DIGITS = 15  # significant digits of values between limits, all that a double distinguishes, so files have all
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
    """The points of a sweep: the product of the axes, and for each all draws; SF507 for a million."""

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
        columns = ([r.at(Fraction(x)) for x in own] for r, own in zip(self.ranges, self.shares, strict=True))
        drawn = tuple(zip(*columns, strict=True))
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


def too_many_points(count: int | str) -> BudgetError:
    """Return the error that says how many points a sweep may have; a count of many digits comes as text."""
    message = f"a sweep has at most {POINTS_LIMIT} points, not {count}"
    return BudgetError(Diagnostic("SF507", message, None, "sweep fewer parameters, or fewer values of each"))


def between(limits: Range, count: int) -> tuple[ExactValue, ...]:
    """Return values from one limit to the other, equally spaced in the range's scale.

    >>> limits = Range("k", ExactValue(Fraction(0)), ExactValue(Fraction(1)))
    >>> [str(value.rational) for value in between(limits, 3)]
    ['0', '1/2', '1']
    """
    if count == 1:
        return (limits.low,)
    return tuple(limits.at(Fraction(i, count - 1)) for i in range(count))


def points_between(start: Point, end: Point, pieces: int) -> list[Point] | None:
    """Return the points that divide a way into equal pieces; None if values differ by a power of pi."""
    if any(a.pi_power != b.pi_power for a, b in zip(start, end, strict=True)):
        return None
    ways = [(a.rational, b.rational - a.rational, a.pi_power) for a, b in zip(start, end, strict=True)]
    shares = [Fraction(i, pieces) for i in range(1, pieces)]
    return [tuple(ExactValue(first + way * x, power) for first, way, power in ways) for x in shares]


def number(value: ExactValue) -> float:
    """Return the nearest double in SI units, to the last bit where no power of pi stands in it."""
    return float(value.rational) * pi**value.pi_power


def written(value: ExactValue) -> str:
    """Return a value exactly, as text."""
    return str(value.rational) + (f"*pi^{value.pi_power}" if value.pi_power else "")


def _decimal(value: Fraction) -> Decimal:
    return Decimal(value.numerator) / Decimal(value.denominator)


Array = npt.NDArray[Any]
Rows = dict[str, Array]  # arrays by name; their first axis counts points

CODE_LENGTH = 5


@dataclass(frozen=True)
class Task:
    """What is wanted at every point."""

    model: Model  # resolved; sent to workers as it is
    pair: tuple[str, str]  # output and input
    of: str  # a key of :data:`QUANTITIES`
    names: tuple[str, ...]  # the swept parameters, in the order of a point's values
    region: Region | None = None  # where roots are sought
    frequencies: tuple[float, ...] = ()  # of a response [Hz]
    gain: str = ""  # of margins


Solver = Callable[[Sequence[Point]], Rows]  # computes rows of results: arrays whose first axis counts points


def fingerprint(task: Task) -> str:
    """Return a text that differs wherever a task does, the same in every process and on every run."""
    plain = (task.model, task.pair, task.of, task.names, task.region, task.frequencies, task.gain)
    # Elements are one object each; where it lies in memory says nothing.
    return re.sub(r" at 0x[0-9a-fA-F]+", "", repr(plain))


def derived(task: Task, *symbols: str) -> AnyTransferFunction:
    """Return the task's function with swept parameters and others as symbols; nested if large."""
    model, pairs = with_numbers(task.model, (*task.names, *symbols)), [task.pair]
    return derive_as(model, pairs)[0][0] if model.is_distributed else derive_all(model, pairs)[0]


def codes_of(codes: Sequence[str]) -> Array:
    """Return error codes as an array, empty where nothing failed."""
    return np.array(codes, f"<U{CODE_LENGTH}")


FORMS = "NAME=LO:HI:lin|log:COUNT or NAME=V1,V2,..., or NAME=LO:HI[:log] or NAME=+-5% with draws"
LIMITS = 2
COUNT = re.compile(r"([0-9]+)(?:[eE]\+?([0-9]+))?")
COUNT_DIGITS = 9
COUNT_SHOWN = 20


def read_design(
    parameters: Sequence[ModelParameter], texts: Sequence[str], draws: int = 0, seed: int = 1
) -> Design:
    """Return the design that texts say.

    ``NAME=LO:HI:lin|log:COUNT`` and ``NAME=V1,V2,...`` are axes of a grid; ``NAME=LO:HI``, ``NAME=LO:HI:log``
    and ``NAME=+-5%`` (about the declared value) are ranges from which ``draws`` points are drawn. Numbers are
    in SI units or carry a unit.
    """
    if not texts:
        raise refused("no parameter to sweep", f"add --over: {FORMS}")
    return _design([_read(parameters, text) for text in texts], draws, seed)


def design_of(
    parameters: Sequence[ModelParameter],
    over: Mapping[str, str | Sequence[Given]],
    draws: int = 0,
    seed: int = 1,
) -> Design:
    """Return the design that a mapping says: per parameter a text as for :func:`read_design`, or values."""
    read: list[Axis | Range] = []
    for name, said in over.items():
        if isinstance(said, str):
            read.append(_read(parameters, f"{name}={said}"))
            continue
        parameter = pick_gain(parameters, name)
        exact = tuple(_assumed(parameter, value) for value in said)
        if not exact:
            raise refused(f"'{name}' has no values")
        read.append(Axis(name, exact))
    if not read:
        raise refused("no parameter to sweep")
    return _design(read, draws, seed)


def check_design(model: Model, design: Design) -> None:
    """Refuse values that would give a beam a length of zero, a delay a negative time, and the like: SF209."""
    ends = [(axis.name, axis.values) for axis in design.axes]
    ends += [(each.name, (each.low, each.high)) for each in design.ranges]
    for name, values in ends:
        for value in {min(values, key=number), max(values, key=number)}:
            check_value(model, name, value, design.names)


def _design(sides: Sequence[Axis | Range], draws: int, seed: int) -> Design:
    names = [each.name for each in sides]
    for i, name in enumerate(names):
        if name in names[:i]:
            raise refused(f"'{name}' is swept twice")
    axes = tuple(each for each in sides if isinstance(each, Axis))
    ranges = tuple(each for each in sides if isinstance(each, Range))
    if ranges and not draws:
        hint = "give a count, as in k=1:10:lin:50, or draw with --monte-carlo N"
        raise refused(f"how many values of '{ranges[0].name}'?", hint)
    if draws and not ranges:
        hint = "leave out the count of a range, as in k=1:10 or k=1:10:log"
        raise refused("there is no range to draw from", hint)
    return Design(axes, ranges, draws, seed)


def _read(parameters: Sequence[ModelParameter], text: str) -> Axis | Range:
    name, sign, said = text.partition("=")
    name, said = name.strip(), said.strip()
    if not sign or not name or not said:
        raise _unreadable(text)
    parameter = pick_gain(parameters, name)
    if said[:2] in ("+-", "±") or said[:1] == "±":
        return _about(parameter, said.removeprefix("+-").removeprefix("±"), text)
    parts = [part.strip() for part in said.split(":")]
    if len(parts) == 1:
        items = said.split(",")
        if len(items) > POINTS_LIMIT:
            raise too_many_points(len(items))
        return Axis(name, tuple(_value(parameter, item.strip(), text) for item in items))
    low, high = (_value(parameter, part, text) for part in parts[:LIMITS])
    scale, count = _scale_and_count(parts[LIMITS:], text)
    limits = _range(parameter, low, high, scale, text)
    if count is None:
        return limits
    Design((), (limits,), count)  # refuses too many before they are made
    return Axis(name, between(limits, count))


def _scale_and_count(parts: list[str], text: str) -> tuple[Scale, int | None]:
    scale: Scale = "lin"
    count: int | None = None
    for i, part in enumerate(parts):
        if i == 0 and part in ("lin", "log"):
            scale = "log" if part == "log" else "lin"
        elif i == len(parts) - 1 and (digits := COUNT.fullmatch(part)):
            count = _count(*digits.groups())
        else:
            raise _unreadable(text)
    if count == 0:
        raise _unreadable(text)
    return scale, count


def _count(whole: str, exponent: str | None) -> int:
    """Return the count that digits and a power of ten say, which nobody has to write out to refuse."""
    whole, zeros = whole.lstrip("0"), (exponent or "").lstrip("0")
    if not whole:
        return 0
    if len(zeros) > COUNT_DIGITS or len(whole) + int(zeros or 0) > COUNT_DIGITS:
        said = f"{whole}e{zeros}" if zeros else whole
        raise too_many_points(said if len(said) <= COUNT_SHOWN else f"{said[:COUNT_SHOWN]}...")
    return int(whole + int(zeros or 0) * "0")


def _about(parameter: ModelParameter, said: str, text: str) -> Range:
    """Return a range about the declared value: ``5%`` of it, or an amount in its unit."""
    if parameter.value is None:
        raise refused(f"'{parameter.name}' has no declared value to vary about", "give both limits")
    value = parameter.value
    if said.endswith("%"):
        source = Text(said[:-1].strip(), Span(Source("--over", said), 0, len(said)))
        try:
            share = parse_quantity(source)
        except SpecError:
            raise _unreadable(text) from None
        amount = Fraction(0) if share.unit else abs(value.rational) * share.angular()[0] / 100
    else:
        by = _value(parameter, said, text)
        amount = by.rational if by.pi_power == value.pi_power else Fraction(0)
    if amount <= 0:
        raise _unreadable(text)
    low, high = (
        _assumed(parameter, ExactValue(value.rational + side * amount, value.pi_power)) for side in (-1, 1)
    )
    return _range(parameter, low, high, "lin", text)


def _range(parameter: ModelParameter, low: ExactValue, high: ExactValue, scale: Scale, text: str) -> Range:
    if low.pi_power != high.pi_power and low.rational and high.rational:
        message = f"the limits of '{parameter.name}' differ by a power of pi"
        raise refused(message, "write both in the same unit")
    power = high.pi_power if high.rational else low.pi_power
    low, high = ExactValue(low.rational, power), ExactValue(high.rational, power)
    if low.rational == high.rational:
        raise refused(f"the limits of '{parameter.name}' are equal: '{text[:60]}'")
    if scale == "log" and not Fraction(0) < low.rational * high.rational:
        raise refused(f"a logarithmic range of '{parameter.name}' needs limits of one sign, other than 0")
    return Range(parameter.name, low, high, scale)


def _value(parameter: ModelParameter, item: str, text: str) -> ExactValue:
    if not item:
        raise _unreadable(text)
    try:
        return _assumed(parameter, item)
    except SpecError as error:
        told = error.diagnostics[0]
        raise refused(f"--over '{text[:60]}': {told.message}", told.hint or f"write {FORMS}") from None


def _assumed(parameter: ModelParameter, given: Given) -> ExactValue:
    """Return a value that a specification could declare too.

    To leave an effect out, binding takes a zero anywhere; a point of a sweep is a model of its own.
    """
    value = read_values((parameter,), {parameter.name: given})[0][1]
    if not value.rational and parameter.assume == "positive":
        message = f"parameter '{parameter.name}' is 0, but is assumed positive"
        raise UsageError(Diagnostic("SF209", message, None, 'say assume = "nonnegative" in the model'))
    return value


def _unreadable(text: str) -> UsageError:
    return refused(f"cannot read '{text[:60]}'", f"write {FORMS}")
