"""The covariance of neighbouring lines, against the spread of many measurements of one system."""

from __future__ import annotations

import numpy as np
import pytest

from symflex.data.fitting.observation import score_covariance
from symflex.data.fitting.problem import fit_problem
from symflex.data.fitting.resonances import Free, Resonances
from symflex.data.measurement import MeasuredResponse
from tests.unit.data.analyser import System, measured

NARROW = System(np.array([20.0]), np.array([0.01]), np.array([26.0]), np.array([0.02]))
MEASUREMENTS = 150


@pytest.mark.slow
def test_the_spread_of_scores_is_that_computed():
    """J'e of 150 measurements: its variance is known to 12 %, and lines are far from independent."""
    random = np.random.default_rng(11)
    data = [
        measured(NARROW, random, record=8.0, records=20, noise=0.01).between(15.0, 32.0)
        for _ in range(MEASUREMENTS)
    ]
    # Coherence as an analyser with many averages would show it; 20 records leave 19 degrees of freedom.
    share = np.mean([(1 - d.coherence) / d.coherence for d in data], axis=0) * 20 / 19
    values = np.mean([d.values for d in data], axis=0)
    typical = MeasuredResponse("y/u", data[0].frequency_hz, values, 1 / (1 + share), data[0].averages, "hann")
    problem = fit_problem([typical], [np.ones_like], Free())
    (line,) = problem.lines
    true = Resonances.of([(2 * np.pi * 20.0, 0.01, 2 * np.pi * 26.0, 0.02)])
    weights = 1 / (line.deviation * np.abs(values))
    slopes = problem.linearised(true, 0)[1] * weights[:, None]
    scores = [(slopes.conj().T @ ((d.values - values) * weights)).real for d in data]
    spread = np.var(scores, axis=0)
    computed = np.diag(score_covariance(line, true.factor(0, line.observation.omega), slopes))
    independent = np.sum(np.abs(slopes) ** 2, axis=0)
    assert spread == pytest.approx(computed, rel=0.4)
    # omega_p, zeta_z: a third of the variance that independent lines would have, and one and a half times it.
    assert spread[0] < 0.5 * independent[0]
    assert spread[3] > 1.2 * independent[3]


def test_without_a_window_nothing_is_known():
    data = MeasuredResponse("y/u", np.arange(10.0, 20.0), np.ones(10), np.full(10, 0.9), 20.0)
    (line,) = fit_problem([data], [np.ones_like], Free()).lines
    assert score_covariance(line, np.ones(10), np.ones((10, 1))) is None
