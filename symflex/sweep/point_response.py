"""The frequency response at the points of a sweep."""

from __future__ import annotations

from math import nan, pi
from typing import TYPE_CHECKING

import numpy as np

from symflex.budget import spend
from symflex.errors import SymflexError
from symflex.sweep.point_roots import PointStatus
from symflex.sweep.task import codes_of, derived
from symflex.transfer import bind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.sweep.design import Point
    from symflex.sweep.task import Rows, Solver, Task


def solve_response(task: Task) -> Solver:
    """Return what evaluates the task's transfer function to double precision; ``inf + nan*1j`` at a pole."""
    tf = derived(task)
    omega = [2 * pi * frequency for frequency in task.frequencies]

    def solve(points: Sequence[Point]) -> Rows:
        values = np.full((len(points), len(omega)), complex(nan, nan))
        status, codes = np.zeros(len(points), np.int8), [""] * len(points)
        for i, point in enumerate(points):
            spend()
            try:
                bound = bind(tf, dict(zip(task.names, point, strict=True)))
                values[i] = [bound(complex(0, w)) for w in omega]
            except SymflexError as error:
                spend()  # that the time is over says nothing of a point
                status[i], codes[i] = PointStatus.FAILED, error.diagnostics[0].code
        return {
            "re": values.real.copy(),
            "im": values.imag.copy(),
            "point_status": status,
            "code": codes_of(codes),
        }

    return solve
