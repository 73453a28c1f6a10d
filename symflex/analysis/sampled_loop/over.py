"""For which values of parameters of its controller a sampled loop is stable."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

from symflex.analysis.sampled_loop.closed import described, sampled_loop
from symflex.analysis.sampled_loop.poles import in_z
from symflex.loops.apart import PolesApart
from symflex.loops.chart import StabilityChart, find_chart
from symflex.loops.find import gain_margins
from symflex.loops.loop import pick_gain
from symflex.loops.over import checked_names, find_intervals, limits_of, with_values
from symflex.loops.stability_map import MOST_BOUNDARIES, Margins, PoleCount, StabilityMap
from symflex.model import Model
from symflex.options import StabilityOptions, share_of
from symflex.print.text import INDENT, Passage
from symflex.transfer import Given

DIGITS, MOST_DIGITS = 15, 1000  # of boundaries; at most, as the option says
DIGITS_BESIDE_BEAMS = 8  # of boundaries: coefficients of a machine with beams are known to some twelve


def sampled_stability(
    model: Model, given: StabilityOptions, values: Mapping[str, Given] | None = None
) -> StabilityMap | StabilityChart:
    """Return for which values of one parameter or two the sampled loop of a model is stable."""
    names = checked_names(replace(given, over=given.over or (given.gain,)))
    model = with_values(model, values)
    parameters = [pick_gain(model.parameters, name) for name in names]
    limits = tuple(limits_of(model, p, given) for p in parameters)
    nominal = [None if p.value is None else p.value.nearly for p in parameters]
    loop = sampled_loop(model, dict(zip(names, limits, strict=True)))
    function = loop.characteristic(names)
    if len(names) > 1:
        chart = find_chart(function, limits, nominal, parameters, float(share_of(given.resolve, "--resolve")))
        return SampledChart(**_parts_of(chart), sampled=described(loop))
    most = MOST_DIGITS if loop.least is None else DIGITS_BESIDE_BEAMS
    digits = min(given.digits or model.analysis.digits or DIGITS, most)
    found = find_intervals(function, limits[0], digits, parameters[0], nominal[0])
    apart = loop.apart
    unseen = PoleCount(apart.right or 0, 0)
    intervals = tuple(replace(i, poles=i.poles + unseen) for i in found.intervals)
    reasons = found.reasons if apart.certified else (*found.reasons, apart.reason)
    unmoved = PolesApart(apart, apart.right or 0)
    placed = replace(found, intervals=intervals, reasons=reasons, apart=unmoved)
    placed = replace(placed, margins=Margins(gain_margins(placed)))
    return SampledStability(**_parts_of(placed), sampled=described(loop))


@dataclass(frozen=True)
class SampledStability(StabilityMap):
    """For which values of a parameter all poles in z lie inside the unit circle."""

    sampled: str = ""  # which blocks take samples, how often

    def passages(self, most: int | None = MOST_BOUNDARIES) -> Iterator[Passage]:
        """Return the map in the words of z."""
        yield from said_in_z(super().passages(most), self.sampled)

    def to_json_dict(self) -> dict[str, object]:
        """Return the map; its right half-plane is the outside of the unit circle."""
        return {**super().to_json_dict(), "sampled": self.sampled}


@dataclass(frozen=True)
class SampledChart(StabilityChart):
    """For which values of two parameters all poles in z lie inside the unit circle."""

    sampled: str = ""

    def passages(self) -> list[Passage]:
        """Return the chart in the words of z."""
        return [*said_in_z(super().passages(), self.sampled)]

    def to_json_dict(self) -> dict[str, object]:
        """Return the chart; its right half-plane is the outside of the unit circle."""
        return {**super().to_json_dict(), "sampled": self.sampled}


def said_in_z(passages: Iterable[Passage], sampled: str) -> Iterator[Passage]:
    """Yield passages about w in the words of z, with what is sampled below the first line."""
    for i, passage in enumerate(passages):
        lines = [in_z(line) for line in passage.lines]
        lines[1:1] = [] if i else [INDENT + sampled]
        rows = tuple(tuple(map(in_z, row)) for row in passage.rows)
        yield Passage(lines, rows, passage.has_head)


def _parts_of(found: StabilityMap | StabilityChart) -> dict[str, Any]:
    return {f.name: getattr(found, f.name) for f in fields(found)}
