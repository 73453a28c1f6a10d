"""Mass-normalised mode shapes, against the eigenvectors of mass and stiffness."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

from symflex.data.fitting import Base, fit_resonances, mode_shapes
from symflex.data.measurement import MeasuredResponse
from symflex.errors import FitError, UsageError
from symflex.options import FitOptions
from tests.unit.refusals import refusal

# Three masses between two walls.
MASS = np.diag([2.0, 3.0, 1.5])
STIFFNESS = 1e4 * np.array([[9.0, -4.0, 0.0], [-4.0, 10.0, -6.0], [0.0, -6.0, 8.0]])
SQUARES, SHAPES = eigh(STIFFNESS, MASS)  # columns with phi^T M phi = 1
OMEGA = np.sqrt(SQUARES)
ZETA = np.array([0.01, 0.02, 0.015])
FREQUENCY = np.arange(5.0, 70.0, 0.1)
DRIVEN = 1


def responses(power, unit, factor=1.0, noise=0.0):
    """Return s**power X_j/F for the force on the second mass, from modal superposition."""
    s = 2j * np.pi * FREQUENCY
    random = np.random.default_rng(3)
    found = []
    for j in range(3):
        value = sum(
            SHAPES[j, r] * SHAPES[DRIVEN, r] / (s**2 + 2 * ZETA[r] * OMEGA[r] * s + SQUARES[r])
            for r in range(3)
        )
        value = value * (1 + noise * (random.normal(size=s.size) + 1j * random.normal(size=s.size)))
        found.append(MeasuredResponse(f"y{j + 1}/F", FREQUENCY, factor * s**power * value, unit=unit))
    return found


def expected():
    return SHAPES * np.sign(SHAPES[DRIVEN])


def shapes_of(data, driving=DRIVEN, **asked):
    asked = {"modes": 3, **asked}
    return mode_shapes(fit_resonances([data[driving]], None, FitOptions(**asked)), data)


@pytest.mark.parametrize(
    ("power", "unit", "factor"), [(1, "m/(N*s)", 1.0), (0, "mm/N", 1000.0), (2, "1/kg", 1.0)]
)
def test_shapes_are_the_eigenvectors_normalised_by_mass(power, unit, factor):
    found = shapes_of(responses(power, unit, factor))
    assert found.unit == "kg^(-1/2)"
    assert found.shapes == pytest.approx(expected(), rel=1e-6)
    assert np.max(np.abs(found.turned)) < 1


def test_standard_errors_are_of_the_size_of_the_errors():
    found = shapes_of(responses(0, "m/N", noise=0.02))
    deviation = np.abs(found.shapes - expected()) / found.errors
    assert np.max(deviation) < 4
    assert np.sqrt(np.mean(deviation**2)) > 0.3
    assert np.max(found.errors / np.abs(expected())) < 0.05


def test_shapes_over_a_torque_have_an_inertia_in_their_unit():
    assert shapes_of(responses(0, "rad/(N*m)")).unit == "kg^(-1/2)*m^(-1)"


def test_a_response_elsewhere_is_not_taken_for_the_driven_point():
    data = [replace(r, values=-r.values) for r in responses(0, "m/N")]
    with pytest.raises(FitError) as raised:
        shapes_of(data)
    assert raised.value.diagnostics[0].code == "SF616"


@pytest.mark.slow
def test_a_response_without_the_unit_of_a_motion_over_a_force_is_refused():
    for unit in ("", "V/N", "m"):
        data = [replace(r, unit=unit) for r in responses(0, "m/N")]
        assert refusal(shapes_of, data) == "DataError SF602", unit


def test_mode_shapes_without_the_fitted_response_are_refused():
    data = responses(0, "m/N")
    fit = fit_resonances([data[DRIVEN]], None, FitOptions(modes=3))
    others = [replace(data[DRIVEN]), *(r for i, r in enumerate(data) if i != DRIVEN)]
    assert refusal(mode_shapes, fit, others) == "UsageError SF902"


def test_a_fit_of_several_responses_or_with_a_base_is_refused():
    data = responses(0, "m/N")
    fit = fit_resonances(
        [data[1]], [Base(np.ones_like, "y/F", "base.toml")], FitOptions(modes=3, is_gain_free=True)
    )
    with pytest.raises(UsageError, match="driven point alone"):
        mode_shapes(fit, data)
