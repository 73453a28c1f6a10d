"""What can be computed at the points of a sweep, and the function a worker runs on a chunk of them."""

from __future__ import annotations

import pickle
from functools import lru_cache
from typing import TYPE_CHECKING

from symflex.sweep.point_margins import solve_margins
from symflex.sweep.point_response import solve_response
from symflex.sweep.point_roots import solve_poles, solve_zeros

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from symflex.sweep.design import Point
    from symflex.sweep.task import Rows, Solver, Task

QUANTITIES: dict[str, Callable[[Task], Solver]] = {
    "poles": solve_poles,
    "zeros": solve_zeros,
    "response": solve_response,
    "margins": solve_margins,
}


def solve_chunk(pickled: bytes, points: Sequence[Point]) -> Rows:
    """Return the results at some points; the model is derived once in each process.

    Parameters
    ----------
    pickled : bytes
        A :class:`~symflex.sweep.task.Task`, as the process that started the sweep wrote it.
    points : sequence of Point
        Any.
    """
    return _solver(pickled)(points)


@lru_cache(maxsize=4)
def _solver(pickled: bytes) -> Solver:
    task: Task = pickle.loads(pickled)
    return QUANTITIES[task.of](task)
