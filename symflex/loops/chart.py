"""For which values of parameters a model is stable: boxes with a certified number of right-half-plane poles.

Input: a model, names of parameters and their ranges. Output: a :class:`StabilityChart`.

Example: a mass on a spring whose force is fed back with gain K after a delay T. Of 0 < K < 3 and
0 < T < 50 ms 99 % are decided by 2,000 boxes: stable below a curve with cusps, two or four poles above.

If no pole meets the axis, their number is the same in the whole box, and so it is in boxes that touch.
Poles are counted at one point of each connected region, as ``symflex roots`` counts them. A box about a
boundary is decided but for a strip about a straight line, and halved until strips are as narrow as its cells.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from math import pi
from typing import Literal

import numpy as np
import numpy.typing as npt

from symflex.balls import Branching, Open, branch
from symflex.budget import entered_budget
from symflex.errors import SymflexError
from symflex.loops.boundary_curves import Point, boundary_curves
from symflex.loops.boxes import Box, CharacteristicFunction, OpenBox
from symflex.loops.up_to import BoxesUpTo
from symflex.model import ExactValue, ModelParameter
from symflex.print.notebook import Printed
from symflex.print.text import INDENT, Passage
from symflex.roots.pole_zero_map import WITHOUT_END, StabilityVerdict
from symflex.roots.root import count_roots

SCHEMA = "symflex.stability_chart/1"
SHOWN = 12  # regions in print; the others are in the JSON
SEARCH = 0.7  # share of the time for boxes; the rest is for counts of poles
PARTS = 8  # parts of a box in either direction, its cells, that are decided by straight lines
MOST_HALVINGS = 9  # halvings of each range: 4,096 cells along it
SLENDER = 8  # how many times longer than wide a box may be, in parts of ranges, until its length is halved
SMALLEST = 5e-4  # share of the smallest region in which poles are counted; others stay undecided
ROUNDING = 1e-12  # far more than doubles round of a few numbers of the size of one
HOPELESS = 256  # boxes after which the search ends if poles have no bound in any
MIXED = -2  # mark of boxes whose cells differ
Word = Literal["stable", "marginal", "unstable", "undecided"]


@dataclass(frozen=True, slots=True)
class ChartBox:
    """A box of parameters that lies in one region, or is undecided: region -1."""

    box: Box
    region: int


@dataclass(frozen=True, slots=True)
class ChartRegion:
    """Cells that touch, and what holds in all of them."""

    verdict: StabilityVerdict
    point: tuple[Fraction, ...]  # where poles were counted
    share: float  # of the area


@dataclass(frozen=True)
class StabilityChart(Printed):
    """What is proved of stability for all values of some parameters in their ranges."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    counted_in: tuple[tuple[str, Fraction], ...]  # units in which it prints, and what one of them is
    ranges: Box
    nominal: tuple[Fraction | None, ...]  # declared values
    cells: npt.NDArray[np.int16] = field(repr=False)  # of equal parts of the ranges, -1 or the region of each
    regions: tuple[ChartRegion, ...]  # the largest one first
    reasons: tuple[str, ...]  # what is not proved
    open: tuple[OpenBox, ...] = field(repr=False)  # boxes about boundaries
    function: CharacteristicFunction = field(repr=False)
    radius: float | None = None  # poles were counted up to this abs(s) [rad/s]; ``None``: all of them

    def __repr__(self) -> str:
        return f"<StabilityChart over {', '.join(self.names)}: {100 * self.decided:.1f} % decided>"

    def passages(self) -> list[Passage]:
        """Return what is decided, region by region."""
        status = "certified" if self.certified else "NOT CERTIFIED"
        status += "" if self.radius is None else f" beyond {self.radius / (2 * pi):.4g} Hz"
        units, sizes = zip(*self.counted_in, strict=True)
        heads = [f"{name} [{unit}]" if unit else name for name, unit in zip(self.names, units, strict=True)]
        lines = [f"{', '.join(heads)}   {status}: {100 * self.decided:.1f} % of the area decided"]
        for name, (low, high), size in zip(self.names, self.ranges, sizes, strict=True):
            lines.append(f"{INDENT}examined: {float(low / size):.6g} < {name} < {float(high / size):.6g}")
        lines += [f"{INDENT}not proved: {reason}" for reason in self.reasons]
        if None not in self.nominal:
            point = zip(self.names, self.nominal, sizes, strict=True)
            place = ", ".join(f"{name} = {float((x or 0) / size):.6g}" for name, x, size in point)
            lines.append(f"{INDENT}{place}: {self.at_nominal}")
        rows = [("share", "verdict", *self.names)]
        for region in self.regions[:SHOWN]:
            point_of = (f"{float(x / size):.4g}" for x, size in zip(region.point, sizes, strict=True))
            rows.append((f"{100 * region.share:.1f} %", word_of(region.verdict), *point_of))
        more = len(self.regions) - SHOWN
        more_said = f", the {SHOWN} largest of {len(self.regions)}" if more > 0 else ""
        regions = Passage([f"{INDENT}regions, each with a point in it{more_said}"], rows)
        return [Passage(lines), regions]

    @property
    def certified(self) -> bool:
        """All counts are proved, for all poles; what is undecided is said beside it."""
        return not self.reasons

    @property
    def decided(self) -> float:
        """Share of the ranges that is decided."""
        return float((self.cells >= 0).mean())

    @cached_property
    def boundaries(self) -> list[list[Point]]:
        """Curves with a pole on the axis: certified points of both parameters and frequency [rad/s]."""
        return self._curves[0]

    @cached_property
    def _curves(self) -> tuple[list[list[Point]], str]:
        """The curves, and why some may be missing."""
        return boundary_curves(self.function, self.ranges, self.open)

    @cached_property
    def boxes(self) -> tuple[ChartBox, ...]:
        """The largest boxes of halved ranges whose cells are alike, the undecided ones too."""
        sizes = [self.cells]
        while len(sizes[-1]) > 1:
            half = len(sizes[-1]) // 2
            quarters = sizes[-1].reshape(half, 2, half, 2)
            first = quarters[:, 0, :, 0]
            is_alike = (quarters == first[:, None, :, None]).all(axis=(1, 3))
            sizes.append(np.where(is_alike, first, MIXED).astype(np.int16))
        found = []
        for each, above in pairwise([*sizes, np.full((1, 1), MIXED)]):
            taken = (each != MIXED) & (above.repeat(2, 0).repeat(2, 1)[: len(each), : len(each)] == MIXED)
            for place in np.argwhere(taken).tolist():
                ends = zip(
                    place, self.ranges, [(high - low) / len(each) for low, high in self.ranges], strict=True
                )
                box = tuple((low + size * i, low + size * (i + 1)) for i, (low, _), size in ends)
                found.append(ChartBox(box, int(each[tuple(place)])))
        return tuple(found[::-1])

    def region_at(self, *values: Fraction | float | str) -> ChartRegion | None:
        """Return the region in which a point lies; None if it is undecided, or lies outside of the ranges."""
        parts, cell = len(self.cells), []
        for value, (low, high) in zip(values, self.ranges, strict=True):
            x = Fraction(value)
            if not low <= x <= high:
                return None
            cell.append(min(int((x - low) / (high - low) * parts), parts - 1))
        region = int(self.cells[tuple(cell)])
        return None if region < 0 else self.regions[region]

    def at(self, *values: Fraction | float | str) -> str:
        """Return ``"stable"``, ``"marginal"``, ``"unstable by 2"`` or ``"undecided"``, always proved."""
        region = self.region_at(*values)
        return "undecided" if region is None else word_of(region.verdict)

    def to_json_dict(self) -> dict[str, object]:
        """Return the chart in the schema ``symflex.stability_chart/1``, in SI units."""
        return {
            "schema": SCHEMA,
            "over": list(self.names),
            "units": list(self.units),
            "range": [[float(x) for x in ends] for ends in self.ranges],
            "nominal": [None if x is None else float(x) for x in self.nominal],
            "at_nominal": self.at_nominal,
            "certified": self.certified,
            "reasons": list(dict.fromkeys(filter(None, (*self.reasons, self._curves[1])))),
            "counted_up_to_rad_per_s": self.radius,
            "undecided": 1 - self.decided,
            "regions": [
                {
                    "verdict": word_of(region.verdict),
                    "unstable": region.verdict.right,
                    "share": region.share,
                    "point": [float(x) for x in region.point],
                }
                for region in self.regions
            ],
            "boxes": [
                _ends(each.box) | {"unstable": self.regions[each.region].verdict.right, "region": each.region}
                for each in self.boxes
                if each.region >= 0
            ],
            "boundaries": [list(map(list, curve)) for curve in self.boundaries],
            "undecided_boxes": [_ends(each.box) for each in self.boxes if each.region < 0],
        }

    def largest_box(self) -> Box | None:
        """Return the largest box about the declared values, shaped like the ranges, in which all is as there.

        It is cut off where the ranges end, and tells the tolerance that the parameters may have together.
        None if it is not decided what holds at the declared values.
        """
        point = [x for x in self.nominal if x is not None]
        region = self.region_at(*point) if len(point) == len(self.names) else None
        if region is None:
            return None
        others = self.cells != self.regions.index(region)
        parts, share, away = len(self.cells), Fraction(1), []
        for x, (low, high) in zip(point, self.ranges, strict=True):
            at, ends = float((x - low) / (high - low)), np.arange(parts + 1) / parts
            away.append(np.maximum(ends[:-1] - at, at - ends[1:]).clip(min=0.0))
        if others.any():
            nearest = np.maximum(away[0][:, None], away[1][None, :])[others].min()
            share = Fraction(max(float(nearest) - ROUNDING, 0.0))
        half = ((x, share * (high - low)) for x, (low, high) in zip(point, self.ranges, strict=True))
        return tuple(
            (max(low, x - size), min(high, x + size))
            for (x, size), (low, high) in zip(half, self.ranges, strict=True)
        )

    @property
    def at_nominal(self) -> str:
        """What holds at the declared values, ``"undecided"`` also where one is missing."""
        point = [x for x in self.nominal if x is not None]
        return self.at(*point) if len(point) == len(self.names) else "undecided"


def word_of(verdict: StabilityVerdict) -> str:
    """Return a verdict in a word, with the number of poles in the right half-plane."""
    if verdict.word == "unknown":
        return "undecided"
    return f"unstable by {verdict.right}" if verdict.right else verdict.word


def _ends(box: Box) -> dict[str, object]:
    return {"low": [float(low) for low, _ in box], "high": [float(high) for _, high in box]}


def find_chart(
    function: CharacteristicFunction,
    ranges: Box,
    nominal: Sequence[Fraction | None],
    parameters: Sequence[ModelParameter],
    resolve: float = 0.01,
    boxes_up_to: BoxesUpTo | None = None,
    reason: str = "",
) -> StabilityChart:
    """Return where in finite ``ranges`` a model is stable, up to a share to ``resolve`` and the time.

    With ``boxes_up_to`` poles are counted up to a frequency, as others have no end for the reason given.
    """
    reasons = [] if boxes_up_to is None else [reason]
    search = _CellSearch(boxes_up_to or function, ranges)
    with entered_budget().share(SEARCH).entered():
        found: Branching[list[OpenBox], None] = branch(
            [[search.function.whole(ranges)]],
            search.decide,
            search.alone,
            order="breadth",
            until=lambda _, waiting: search.open_share <= resolve or search.is_hopeless(waiting),
            keeps=True,
        )
    reasons += [found.over.message] if found.over else []
    free, smallest = search.free, search.smallest + [box for boxes in found.undecided for box in boxes]
    # The ends do not belong to the ranges: there the order may be lower.
    rims = {(k, x) for k, ends in enumerate(ranges) for x in ends}
    inner = (box for box in smallest if not rims & {(k, x) for k, e in enumerate(box.box) for x in e})
    ends = {box.radius for box in inner if isinstance(box.radius, str)}
    regions_of, regions = _regions(search.verdict_at, free, ranges, reasons)
    radius = None if boxes_up_to is None else float(boxes_up_to.poles.radius)
    # Poles that may stay on the axis have no curve there.
    about = () if boxes_up_to else tuple(smallest)
    units, counted_in = (p.unit for p in parameters), (p.counted_in for p in parameters)
    return StabilityChart(
        function.names, tuple(units), tuple(counted_in), ranges, tuple(nominal), regions_of, regions,
        tuple(dict.fromkeys((*reasons, *ends))), about, function, radius
    )  # fmt: skip


class _CellSearch:
    """Marks the cells of two ranges in which no pole meets the axis, box by box."""

    def __init__(self, function: CharacteristicFunction | BoxesUpTo, ranges: Box) -> None:
        self.function, self.ranges = function, ranges
        self.free: npt.NDArray[np.bool_] = np.zeros((PARTS,) * 2, dtype=bool)  # finer as boxes are halved
        self.smallest: list[OpenBox] = []  # open boxes that are not worth halving
        self._found = 0  # how many are
        self._is_bounded = False  # in some box it is known up to where poles are to be sought

    def verdict_at(self, point: Sequence[Fraction]) -> StabilityVerdict:
        """Return what holds at one point."""
        if isinstance(self.function, BoxesUpTo):
            return self.function.verdict_at(point)
        return count_at(self.function, point)[0]

    @property
    def open_share(self) -> float:
        """Share of the area that is not marked."""
        return 1 - self._found / self.free.size

    def is_hopeless(self, waiting: int) -> bool:
        """Tell whether poles have no bound in any of so many boxes."""
        return waiting > HOPELESS and not self._is_bounded and not self._found

    def _parts_of(self, box: OpenBox) -> list[int]:
        """Return into how many parts such as a box each range is cut."""
        sides = zip(self.ranges, box.box, strict=True)
        return [int((high - low) / (b - a)) for (low, high), (a, b) in sides]

    def decide(self, boxes: list[OpenBox]) -> Open[list[OpenBox]] | None:
        """Mark the free cells in both halves of boxes; the halves in which some are not are open."""
        halves = [half for box in boxes for half in self.function.halves(box)]
        undecided = [narrowed for half in halves if (narrowed := self._marked(half)) is not None]
        return Open(undecided) if undecided else None

    def alone(self, boxes: list[OpenBox]) -> list[list[OpenBox]]:
        """Return boxes one by one, but those that were halved as often as is of use; none if all were."""
        small = [box for box in boxes if max(self._parts_of(box)) >> MOST_HALVINGS]
        larger = [[box] for box in boxes if box not in small]
        self.smallest += small if larger else []
        return larger

    def _marked(self, box: OpenBox) -> OpenBox | None:
        parts = self._parts_of(box)
        while len(self.free) < PARTS * max(parts):
            self.free, self._found = self.free.repeat(2, 0).repeat(2, 1), 4 * self._found
        steps = [len(self.free) // part for part in parts]
        sides = zip(self.ranges, box.box, strict=True)
        starts = [int((a - low) / (high - low) * len(self.free)) for (low, high), (a, _) in sides]
        cells = self.free[tuple(slice(i, i + step) for i, step in zip(starts, steps, strict=True))]
        before = int(cells.sum())
        if before == cells.size:
            return None
        narrowed = self.function.narrowed(box) if box.is_bounded else box
        self._is_bounded = self._is_bounded or box.is_bounded
        # Where a line bounds a box, or no end of the poles is known, the longer range is halved.
        if narrowed.lines or not box.is_bounded or max(parts) > SLENDER * min(parts):
            narrowed = replace(narrowed, weights=tuple(1 / part for part in parts))
        free = cells_without(narrowed)
        for axis, step in enumerate(steps):
            free = free.repeat(step // PARTS, axis)
        cells |= free
        self._found += int(cells.sum()) - before
        return None if cells.all() else narrowed


def cells_without(box: OpenBox) -> npt.NDArray[np.bool_]:
    """Return which cells of a box have no parameters with a root on the axis, or poles without end."""
    shape = (PARTS,) * len(box.box)
    if isinstance(box.radius, str):  # poles are on the right without end for all values, or none is known
        return np.full(shape, WITHOUT_END in box.radius)
    if any(box.pieces) and not box.lines:
        return np.zeros(shape, dtype=bool)
    free = np.ones(shape, dtype=bool)
    # Middles of cells, half a box away from its middle at most.
    across = (2 * np.arange(PARTS) + 1) / PARTS - 1
    for line in box.lines:
        value, *slopes = ((float(x.mid()), float(x.rad()) + ROUNDING * abs(float(x.mid()))) for x in line)
        middle, reach = np.full(shape, value[0]), value[1]
        for axis, (slope, spread) in enumerate(slopes):
            middle += slope * across.reshape([-1 if k == axis else 1 for k in range(len(shape))])
            reach += spread + abs(slope) * (1 / PARTS + ROUNDING)
        free &= abs(middle) > reach
    return free


def _regions(
    verdict_at: Callable[[Sequence[Fraction]], StabilityVerdict],
    free: npt.NDArray[np.bool_],
    ranges: Box,
    reasons: list[str],
) -> tuple[npt.NDArray[np.int16], tuple[ChartRegion, ...]]:
    """Return the region of each cell, -1 if it is undecided, and these with the poles counted in each."""
    from scipy import ndimage  # only charts ask

    labels, _ = ndimage.label(free)
    sizes = np.bincount(labels.ravel())
    order = [k for k in np.argsort(-sizes[1:], kind="stable") + 1 if sizes[k] >= SMALLEST * free.size]
    number = np.full(len(sizes), -1, dtype=np.int16)
    number[order] = np.arange(len(order))
    cells = number[labels]
    depth = ndimage.distance_transform_cdt(np.pad(free, 1))[1:-1, 1:-1]
    deepest = ndimage.maximum_position(depth, labels, order) if order else []
    regions = []
    for label, place in zip(order, deepest, strict=True):
        point = tuple(
            low + (high - low) * Fraction(2 * int(i) + 1, 2 * len(free))
            for i, (low, high) in zip(place, ranges, strict=True)
        )
        verdict = verdict_at(point)
        if verdict.word == "unknown" and verdict.reason not in reasons:
            reasons.append(verdict.reason)
        regions.append(ChartRegion(verdict, point, float(sizes[label] / free.size)))
    return cells, tuple(regions)


def count_at(
    function: CharacteristicFunction, point: Sequence[Fraction | ExactValue]
) -> tuple[StabilityVerdict, int]:
    """Return what holds at one point, as ``symflex roots`` says it, and how many poles lie on the axis."""
    try:
        located = function.located(point)
    except SymflexError as error:
        return StabilityVerdict("unknown", None, False, error.diagnostics[0].message), 0
    axis = count_roots([root for root in located.all_poles if root.on_imaginary_axis])
    return located.verdict, axis
