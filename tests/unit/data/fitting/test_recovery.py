"""A fit finds the system that was measured, and knows how well it does."""

from __future__ import annotations

import numpy as np
import pytest

from symflex.data.fitting import Base, fit_resonances
from symflex.options import FitOptions
from tests.unit.data.analyser import measured, random_system, rigid

BASE = [Base(rigid)]


def recover(count, seed, **settings):
    """Return errors and standard errors: relative ones of f_p, zeta_p and f_z, and those of zeta_z."""
    errors, deviations = [], []
    for k in range(count):
        random = np.random.default_rng([seed, k])
        system = random_system(random)
        data = measured(lambda f, system=system: system(f) * rigid(2 * np.pi * f), random, **settings)
        fit = fit_resonances([data], BASE, FitOptions(modes=5))
        found, spread = fit.resonances, fit.standard_errors()
        true = (2 * np.pi * system.f_p, system.zeta_p, 2 * np.pi * system.f_z, system.zeta_z)
        got = (found.omega_p, found.zeta_p, found.omega_z[0], found.zeta_z[0])
        se = (spread.omega_p, spread.zeta_p, spread.omega_z[0], spread.zeta_z[0])
        scale = (true[0], true[1], true[2], np.ones(5))
        errors.append([(g - t) / s for g, t, s in zip(got, true, scale, strict=True)])
        deviations.append([e / s for e, s in zip(se, scale, strict=True)])
    return np.abs(np.array(errors)), np.array(deviations)


@pytest.mark.slow
def test_many_systems_are_recovered_and_intervals_are_honest():
    errors, deviations = recover(20, seed=2)
    assert errors[:, 0].max() < 0.002
    assert errors[:, 1].max() < 0.10
    inside = np.mean(errors < deviations, axis=(0, 2))
    assert np.all((inside > 0.60) & (inside < 0.76)), inside


@pytest.mark.slow
def test_intervals_are_honest_where_leakage_rules():
    """Records so short that the narrowest peaks are little more than a line wide."""
    errors, deviations = recover(60, seed=2, record=8.0)
    inside = np.mean(errors < deviations, axis=(0, 2))
    assert np.all((inside > 0.60) & (inside < 0.76)), inside


def test_without_the_window_damping_comes_out_too_large():
    random = np.random.default_rng(5)
    system = random_system(random, 1)
    narrow = type(system)(np.array([20.0]), np.array([0.01]), np.array([26.0]), np.array([0.01]))
    data = measured(narrow, random, record=2.0, records=400, noise=0.01)
    with_window = fit_resonances([data], [Base(np.ones_like)], FitOptions(modes=1)).resonances.zeta_p[0]
    plain = type(data)(data.name, data.frequency_hz, data.values, data.coherence, data.averages)
    without = fit_resonances([plain], [Base(np.ones_like)], FitOptions(modes=1))
    assert with_window == pytest.approx(0.01, rel=0.03)
    assert without.resonances.zeta_p[0] > 1.1 * with_window
    assert any("Hann" in warning for warning in without.warnings)
