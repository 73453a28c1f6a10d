"""For which values of parameters a model is stable: boxes with a proved number of poles right of the axis.

Input: a model, names of parameters and their ranges. Output: a :class:`StabilityChart`.

Example: a mass on a spring whose force is fed back with gain K after a dead time T. Of 0 < K < 3 and
0 < T < 50 ms 99 % are decided by 2,000 boxes: stable below a curve with cusps, two or four poles above.

A box on which no pole meets the axis holds as many poles right of it everywhere, and so do boxes that touch.
Poles are counted at one point of each connected region, as ``symflex roots`` counts them. Boxes about a
boundary are halved until they take up less than a share of the area.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import product
from math import prod
from typing import TYPE_CHECKING, Literal

import numpy as np

from symflex.budget import entered_budget, spend
from symflex.errors import BudgetError, SymflexError
from symflex.loops.boxes import Box, CharacteristicFunction, OpenBox
from symflex.print.text import INDENT, WIDTH, Passage, passages_text
from symflex.roots.locate import locate
from symflex.roots.pole_zero_map import PoleZeroMap, StabilityVerdict
from symflex.roots.region import Modes
from symflex.roots.root import count_roots
from symflex.transfer import bind

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

SCHEMA = "symflex.stability_chart/1"
SHOWN = 12
"""Regions in print; the others are in the JSON."""
SEARCH = 0.7
"""Share of the time for boxes; the rest is for counts of poles."""
MOST_HALVINGS = 12
"""Halvings of each range: 4,096 parts of it."""
COUNT_DIGITS = 10
"""Digits of poles of which only the number is asked for."""
Word = Literal["stable", "marginal", "unstable", "undecided"]


@dataclass(frozen=True, slots=True)
class ChartBox:
    """A box of parameters in which the number of poles right of the axis does not change."""

    box: Box
    level: int  # how often each range was halved
    place: tuple[int, ...]  # which part of each range it is, from 0 on
    region: int = -1  # which connected region it belongs to


@dataclass(frozen=True, slots=True)
class ChartRegion:
    """Boxes that touch, and what holds in all of them."""

    verdict: StabilityVerdict
    point: tuple[Fraction, ...]  # where poles were counted
    share: float  # of the area


@dataclass(frozen=True)
class StabilityChart:
    """What is proved of stability for all values of some parameters in their ranges."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    ranges: Box
    nominal: tuple[Fraction | None, ...]  # declared values
    boxes: tuple[ChartBox, ...]
    regions: tuple[ChartRegion, ...]  # the largest one first
    undecided: tuple[OpenBox, ...]  # boxes in which a pole may meet the axis
    reasons: tuple[str, ...] = ()  # what is not proved

    def __repr__(self) -> str:
        return f"<StabilityChart over {', '.join(self.names)}: {100 * self.decided:.1f} % decided>"

    def __str__(self) -> str:
        return chart_text(self)

    @property
    def certified(self) -> bool:
        """All counts are proved, for all poles; what is undecided is said beside it."""
        return not self.reasons

    @cached_property
    def decided(self) -> float:
        """Share of the ranges that is decided."""
        return 1.0 - sum(_share(b.box, self.ranges) for b in self.undecided)

    def region_at(self, *values: Fraction | float | str) -> ChartRegion | None:
        """Return the region in which a point lies; None if it is undecided, or lies outside of the ranges."""
        point = tuple(Fraction(x) for x in values)
        for each in self.boxes:
            if all(low <= x <= high for x, (low, high) in zip(point, each.box, strict=True)):
                return self.regions[each.region]
        return None

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
            "reasons": list(self.reasons),
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
                {
                    "low": [float(low) for low, _ in each.box],
                    "high": [float(high) for _, high in each.box],
                    "unstable": self.regions[each.region].verdict.right,
                    "region": each.region,
                }
                for each in self.boxes
            ],
            "undecided_boxes": [
                {"low": [float(low) for low, _ in each.box], "high": [float(high) for _, high in each.box]}
                for each in self.undecided
            ],
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
        others = [each.box for each in self.boxes if self.regions[each.region] is not region]
        others += [each.box for each in self.undecided]
        shapes = [(x, high - low) for x, (low, high) in zip(point, self.ranges, strict=True)]
        share = min((_reach(box, shapes) for box in others), default=Fraction(1))
        ends = ((x - share * size, x + share * size) for x, size in shapes)
        return tuple(
            (max(low, a), min(high, b)) for (a, b), (low, high) in zip(ends, self.ranges, strict=True)
        )

    @property
    def at_nominal(self) -> str:
        """What holds at the declared values, ``"undecided"`` also where one is missing."""
        point = [x for x in self.nominal if x is not None]
        return self.at(*point) if len(point) == len(self.names) else "undecided"


def chart_text(chart: StabilityChart) -> str:
    """Return what is decided, region by region, in 80 columns."""
    status = "certified" if chart.certified else "NOT CERTIFIED"
    heads = [
        f"{name} [{unit}]" if unit else name for name, unit in zip(chart.names, chart.units, strict=True)
    ]
    lines = [f"{', '.join(heads)}   {status}: {100 * chart.decided:.1f} % of the area decided"]
    for name, (low, high) in zip(chart.names, chart.ranges, strict=True):
        lines.append(f"{INDENT}examined: {float(low):.6g} < {name} < {float(high):.6g}")
    lines += [f"{INDENT}not proved: {reason}" for reason in chart.reasons]
    if None not in chart.nominal:
        point = zip(chart.names, chart.nominal, strict=True)
        place = ", ".join(f"{name} = {float(x or 0):.6g}" for name, x in point)
        lines.append(f"{INDENT}{place}: {chart.at_nominal}")
    rows = [("share", "verdict", *chart.names)]
    for region in chart.regions[:SHOWN]:
        point_of = (f"{float(x):.4g}" for x in region.point)
        rows.append((f"{100 * region.share:.1f} %", word_of(region.verdict), *point_of))
    more = len(chart.regions) - SHOWN
    more_said = f", the {SHOWN} largest of {len(chart.regions)}" if more > 0 else ""
    regions = Passage([f"{INDENT}regions, each with a point in it{more_said}"], rows)
    return passages_text([Passage(lines), regions], WIDTH)


def word_of(verdict: StabilityVerdict) -> str:
    """Return a verdict in a word, with the number of poles right of the axis."""
    if verdict.word == "unknown":
        return "undecided"
    return f"unstable by {verdict.right}" if verdict.right else verdict.word


def _reach(box: Box, shapes: Sequence[tuple[Fraction, Fraction]]) -> Fraction:
    """Return up to which share of its size to either side a shape about a point does not reach into a box."""
    ends = zip(shapes, box, strict=True)
    return max(max(low - x, x - high, Fraction(0)) / size for (x, size), (low, high) in ends)


def _share(box: Box, ranges: Box) -> float:
    return prod(float((b - a) / (high - low)) for (a, b), (low, high) in zip(box, ranges, strict=True))


def find_chart(
    function: CharacteristicFunction,
    ranges: Box,
    nominal: Sequence[Fraction | None],
    units: Sequence[str],
    resolve: float = 0.01,
) -> StabilityChart:
    """Return for which values of parameters a model is stable.

    ``resolve`` is the share of the area that may stay undecided. Where the time ends, the chart is returned
    as far as it is proved. The parameters' ``ranges`` are finite.
    """
    reasons: list[str] = []
    decided: list[ChartBox] = []
    pending = [(function.whole(ranges), 0, (0,) * len(ranges))]
    try:
        with entered_budget().share(SEARCH).entered():
            for level in range(1, MOST_HALVINGS + 1):
                pending = [child for each in pending for child in _parts(*each, function)]
                left = []
                for place_of in pending:
                    box, _, place = place_of
                    if box.is_bounded:
                        box = function.narrowed(box)
                        if not any(box.pieces):
                            decided.append(ChartBox(box.box, level, place))
                            continue
                    left.append((box, level, place))
                pending = left
                if sum(_share(box.box, ranges) for box, _, _ in pending) <= resolve:
                    break
    except BudgetError as error:
        reasons.append(error.diagnostics[0].message)
        done = {(each.level, each.place) for each in decided}
        pending = [each for each in pending if each[1:] not in done]
    boxes, regions = _regions(function, decided, ranges, reasons)
    ends = {each.radius for each in (box for box, _, _ in pending) if isinstance(each.radius, str)}
    return StabilityChart(
        function.names, tuple(units), ranges, tuple(nominal), boxes, regions,
        tuple(box for box, _, _ in pending), tuple(dict.fromkeys((*reasons, *ends))),
    )  # fmt: skip


def _parts(
    box: OpenBox, level: int, place: tuple[int, ...], function: CharacteristicFunction
) -> list[tuple[OpenBox, int, tuple[int, ...]]]:
    """Return the parts of a box, with what each is in the tree of halvings."""
    corners = product((0, 1), repeat=len(place))
    return [
        (part, level + 1, tuple(2 * i + side for i, side in zip(place, corner, strict=True)))
        for part, corner in zip(halved(box, function), corners, strict=True)
    ]


def halved(box: OpenBox, function: CharacteristicFunction) -> list[OpenBox]:
    """Return the parts of a box, each range halved, the last range first."""
    spend()
    halves = [((low, (low + high) / 2), ((low + high) / 2, high)) for low, high in box.box]
    # An end of the poles that is unknown for a box may be known for its parts.
    is_known = box.is_bounded
    return [replace(box, box=ends) if is_known else function.whole(ends) for ends in product(*halves)]


def _regions(
    function: CharacteristicFunction, boxes: Sequence[ChartBox], ranges: Box, reasons: list[str]
) -> tuple[tuple[ChartBox, ...], tuple[ChartRegion, ...]]:
    """Return the boxes with their regions, and these with the poles that are counted in each."""
    labels = connected(boxes)
    shares: dict[int, float] = {}
    largest: dict[int, ChartBox] = {}
    for box, label in zip(boxes, labels, strict=True):
        shares[label] = shares.get(label, 0.0) + _share(box.box, ranges)
        if label not in largest or box.level < largest[label].level:
            largest[label] = box
    order = sorted(shares, key=lambda label: -shares[label])
    regions = []
    for label in order:
        point = tuple((low + high) / 2 for low, high in largest[label].box)
        verdict, _ = count_at(function, point)
        if verdict.word == "unknown" and verdict.reason not in reasons:
            reasons.append(verdict.reason)
        regions.append(ChartRegion(verdict, point, shares[label]))
    place = {label: i for i, label in enumerate(order)}
    return tuple(replace(b, region=place[k]) for b, k in zip(boxes, labels, strict=True)), tuple(regions)


def connected(boxes: Sequence[ChartBox]) -> list[int]:
    """Return a number for each box, equal for those that share a face or are joined by others that do.

    Boxes are those of a tree of halvings: each is a cube of the finest parts.
    """
    from scipy import ndimage  # only charts ask

    if not boxes:
        return []
    finest, axes = max(b.level for b in boxes), len(boxes[0].place)
    taken: npt.NDArray[np.bool_] = np.zeros((1 << finest,) * axes, dtype=bool)
    corners = []
    for box in boxes:
        size = 1 << (finest - box.level)
        corners.append(tuple(i * size for i in box.place))
        taken[tuple(slice(i, i + size) for i in corners[-1])] = True
    labels, _ = ndimage.label(taken)
    return [int(labels[corner]) for corner in corners]


def located_at(function: CharacteristicFunction, point: Sequence[Fraction], modes: int = 1) -> PoleZeroMap:
    """Return the poles at one point, of a distributed model so many modes."""
    bound = bind(function.tf, dict(zip(function.names, point, strict=True)))
    return locate(bound, None if bound.is_rational else Modes(modes), COUNT_DIGITS, with_zeros=False)


def count_at(function: CharacteristicFunction, point: Sequence[Fraction]) -> tuple[StabilityVerdict, int]:
    """Return what holds at one point, as ``symflex roots`` says it, and how many poles lie on the axis."""
    try:
        located = located_at(function, point)
    except SymflexError as error:
        return StabilityVerdict("unknown", None, False, error.diagnostics[0].message), 0
    axis = count_roots([root for root in located.all_poles if root.on_imaginary_axis])
    return located.verdict, axis
