"""Stability margins at the points of a sweep."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

import numpy as np

from symflex.budget import spend
from symflex.errors import SymflexError
from symflex.loops import characteristic_loop, find_stable_gains, pick_gain
from symflex.loops.stability_map import degrees, hertz
from symflex.sweep.point_roots import PointStatus
from symflex.sweep.rounding import rounded
from symflex.sweep.task import codes_of, derived

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.loops import StabilityMap
    from symflex.sweep.design import Point
    from symflex.sweep.task import Rows, Solver, Task

MARGINS = ("gain_margin_up", "gain_margin_down", "phase_margin", "crossover")
Pair = tuple[float, float]
"""Centre and radius."""


def solve_margins(task: Task) -> Solver:
    """Return what finds gain and phase margins of the loop closed with the task's gain."""
    parameter = pick_gain(task.model.parameters, task.gain)
    tf = derived(task, task.gain)

    def solve(points: Sequence[Point]) -> Rows:
        values = {name: np.full(len(points), np.nan) for name in MARGINS}
        radii = {name: np.full(len(points), np.nan) for name in MARGINS}
        stable = np.full(len(points), -1, np.int8)
        status, codes = np.zeros(len(points), np.int8), [""] * len(points)
        for i, point in enumerate(points):
            spend()
            try:
                loop = characteristic_loop(tf, parameter, dict(zip(task.names, point, strict=True)))
                found = find_stable_gains(loop)
            except SymflexError as error:
                spend()
                status[i], codes[i] = PointStatus.FAILED, error.diagnostics[0].code
                continue
            status[i] = PointStatus.CERTIFIED if found.certified else PointStatus.NOT_CERTIFIED
            stable[i] = -1 if found.is_stable is None else int(found.is_stable)
            for name, (centre, radius) in _margins_of(found).items():
                values[name][i], radii[name][i] = centre, radius
        return {
            **values,
            **{f"{name}_radius": radii[name] for name in MARGINS},
            "stable": stable,
            "point_status": status,
            "code": codes_of(codes),
        }

    return solve


def _margins_of(found: StabilityMap) -> dict[str, Pair]:
    """Return the margins of a stable loop; an infinite gain margin is inf, or 0 downwards."""
    if not found.is_stable:
        return {}
    result: dict[str, Pair] = {"gain_margin_up": (inf, 0.0), "gain_margin_down": (0.0, 0.0)}
    for margin in found.gain_margins:
        name = "gain_margin_up" if margin.factor > 1 else "gain_margin_down"
        result[name] = rounded(margin.factor)[:2]
    worst = found.phase_margin
    if worst is not None:
        result["phase_margin"] = rounded(degrees(worst.angle))[:2]
        result["crossover"] = rounded(hertz(worst.frequency))[:2]
    return result
