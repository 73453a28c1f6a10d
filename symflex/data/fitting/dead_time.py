"""Where the search for a dead time begins.

A wrong dead time winds the phase, and no function with few poles follows that: the one that leaves least of a
row of dead times is within a quarter of a turn at the highest line, and from there least squares find it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from symflex.data.fitting.peaks import find_modes
from symflex.data.fitting.rational_start import generous_fit

if TYPE_CHECKING:
    from symflex.data.fitting.problem import FitProblem

PER_TURN = 5
"""Dead times tried per turn of the phase at the highest line."""
MOST_TURNS = 40.0
LEAST_TURNS = 2.0
MOST_LINES = 300


def with_delays(problem: FitProblem, count: int | None) -> FitProblem:
    """Return the problem with the dead time of each response to begin with, where they are free."""
    if not problem.free.delay:
        return problem
    found = []
    for r in range(len(problem.lines)):
        single = replace(problem, lines=problem.lines[r : r + 1], delays=(0.0,)).without_window()
        found.append(_delay(single, count or max(len(find_modes(single)), 1)))
    return replace(problem, delays=tuple(found))


def _delay(single: FitProblem, count: int) -> float:
    line = single.lines[0]
    values, omega = line.ratio, line.omega
    turn = 2 * np.pi / float(omega[-1])
    # Resonances turn the phase near their peaks; on most lines the dead time alone does.
    steps = -np.angle(values[1:] / values[:-1]) / np.diff(omega)
    likely = max(float(np.median(steps)), 0.0)
    most = min(max(3 * likely / turn, LEAST_TURNS), MOST_TURNS) * turn
    thin = _thinned(single)
    tried = np.arange(0.0, most, turn / PER_TURN)
    costs = [_misfit(thin, float(delay), count) for delay in tried]
    best = float(tried[int(np.argmin(costs))])
    near = best + turn / PER_TURN * np.linspace(-1, 1, 7)
    near = near[near >= 0]
    return float(near[int(np.argmin([_misfit(thin, float(delay), count) for delay in near]))])


def _thinned(single: FitProblem) -> FitProblem:
    """Return the problem with so few lines that many dead times can be tried."""
    line = single.lines[0]
    every = slice(None, None, max(1, line.omega.size // MOST_LINES))
    measured = replace(
        line.measured,
        frequency_hz=line.measured.frequency_hz[every],
        values=line.measured.values[every],
        coherence=None,
    )
    observation = replace(line.observation, omega=line.omega[every])
    base = line.base_at_lines[every]
    thin = replace(
        line,
        measured=measured,
        observation=observation,
        base=base,
        base_at_lines=base,
        deviation=None if line.deviation is None else line.deviation[every],
    )
    return replace(single, lines=(thin,))


def _misfit(single: FitProblem, delay: float, count: int) -> float:
    problem = replace(single, delays=(delay,))
    ((values,), _) = generous_fit(problem, count)
    line = problem.lines[0]
    scale = 1.0 if line.deviation is None else line.deviation
    return float(np.mean(np.abs((values / line.measured.values - 1) / scale) ** 2))
