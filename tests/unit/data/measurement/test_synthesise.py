"""Synthetic measurements have the statistics of real ones, and say that they are synthetic."""

from __future__ import annotations

import numpy as np
import pytest

from symflex.data.measurement import MeasurementPlan, measurement_bytes, synthesise
from tests.unit.refusals import refusal


def first_order(omega):
    return 2.0 / (1 + 0.001j * omega)


PLAN = MeasurementPlan(2.0, 100.0, 1.0, averages=30, noise=0.2, rolloff_hz=None)


def test_the_error_is_what_its_coherence_says():
    # A smooth response has no leakage: errors over their standard deviation have unit variance in each part.
    scaled = []
    for seed in range(20):
        seen = synthesise("y/u", first_order, MeasurementPlan(2.0, 100.0, 1.0, 30, 0.2, None, seed))
        error = (seen.values - first_order(seen.omega)) / np.abs(seen.values) / seen.relative_deviation()
        scaled.append(np.concatenate((error.real, error.imag)))
    assert np.var(scaled) == pytest.approx(1, abs=0.15)
    assert np.mean(scaled) == pytest.approx(0, abs=0.1)


def test_coherence_is_that_of_the_noise():
    # gamma^2 = 1/(1 + noise over signal power), and the noise fills the band up to half the sampling rate.
    plan = MeasurementPlan(2.0, 100.0, 1.0, 400, 0.5, None)
    seen = synthesise("y/u", np.ones_like, plan)
    share = 0.25 * (100 + 6 - 1) / (plan.rate_hz / 2)
    assert np.mean(seen.coherence) == pytest.approx(1 / (1 + share), abs=0.01)


def test_the_sensor_rolls_off():
    plan = MeasurementPlan(2.0, 100.0, 1.0, 200, 0.0, rolloff_hz=50.0)
    seen = synthesise("y/u", np.ones_like, plan)
    at_corner = seen.values[seen.frequency_hz.tolist().index(50.0)]
    # 1/(2j zeta) at the corner of a second-order low pass, zeta = 0.7
    assert at_corner == pytest.approx(1 / 1.4j, abs=0.02)


def test_the_same_seed_gives_the_same_file_and_another_seed_another_one():
    first, again = (measurement_bytes(synthesise("y/u", first_order, PLAN), "a.csv") for _ in range(2))
    other = MeasurementPlan(2.0, 100.0, 1.0, averages=30, noise=0.2, rolloff_hz=None, seed=2)
    assert first == again
    assert first != measurement_bytes(synthesise("y/u", first_order, other), "a.csv")


def test_files_say_that_they_are_synthetic():
    for suffix in (".csv", ".npz"):
        content = measurement_bytes(synthesise("y/u", first_order, PLAN), f"a{suffix}")
        assert b"synthetic" in content.lower(), suffix


def test_plans_that_cannot_be_meant_are_refused():
    for plan in (
        MeasurementPlan(0.0, 100.0, 1.0),
        MeasurementPlan(5.0, 2.0, 1.0),
        MeasurementPlan(1.0, 10.0, 20.0),
        MeasurementPlan(1.0, float("nan"), 1.0),
        MeasurementPlan(1.0, 1e300, 1e297),
        MeasurementPlan(1e-300, 1.0, 1e-3),
        MeasurementPlan(1.0, 1e6, 1e-3, 1000),
        MeasurementPlan(1.0, 10.0, 1.0, noise=-1.0),
        MeasurementPlan(1.0, 10.0, 1.0, averages=0),
        # A sensor whose values leave the doubles.
        MeasurementPlan(2.0, 100.0, 1.0, 4, 0.0, 1e-300),
        MeasurementPlan(2.0, 100.0, 1.0, 4, 1e300, None),
    ):
        assert refusal(synthesise, "y/u", first_order, plan) == "UsageError SF902", plan


def test_an_undamped_resonance_has_no_stationary_response():
    def undamped(omega):
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(omega > 100, np.inf, 1.0) + 0j

    assert refusal(synthesise, "y/u", undamped, PLAN).startswith("UsageError")
