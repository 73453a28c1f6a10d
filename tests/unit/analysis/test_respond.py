import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest

from symflex.analysis.response import SampledResponse, respond
from symflex.errors import UsageError
from symflex.transfer import bind
from tests.unit.analysis.systems import derived, rational


def degrees(expression, *omega):
    return np.degrees(respond(rational(expression), omega).phase)


def test_cancellation_between_large_terms_costs_no_digits():
    # prod(z + k^2), k = 1..12, written out, so that double precision loses most digits near z = -121.
    coefficients = [1]
    for k in range(1, 13):
        shifted = [*coefficients, 0]
        coefficients = [a + k * k * b for a, b in zip(shifted, [0, *coefficients], strict=True)]
    text = " + ".join(f"{c}*s^{2 * (12 - i)}" for i, c in enumerate(coefficients))
    omega = 11.000000001
    with mpmath.workdps(50):
        exact = mpmath.mpf(1)
        for k in range(1, 13):
            exact /= k * k - mpmath.mpf(omega) ** 2
        expected = float(exact)
    assert respond(rational(f"1/({text})"), [omega]).values[0] == pytest.approx(expected, rel=1e-15)


def test_on_the_axis_a_pole_is_infinite_without_a_phase_and_a_zero_is_zero():
    pole, zero = (respond(rational(text), [2.0]) for text in ("1/(s^2 + 4)", "(s^2 + 4)/(s + 1)"))
    assert pole.values[0].real == math.inf
    assert math.isnan(pole.phase[0])
    assert zero.values[0] == 0
    assert zero.magnitude_db[0] == -math.inf


def test_a_function_that_is_zero_responds_with_zeros():
    assert respond(rational("s - s"), [1.0, 2.0]).values.tolist() == [0, 0]


def test_quantity_and_unit_come_from_the_model():
    (tf,) = derived(
        'elements.a = { type = "mass", at = "x", m = "1 kg" }\ninputs.F = { force = "x" }\noutputs.V = "s*x"'
    )
    response = respond(bind(tf), [1.0])
    assert (response.tf, response.quantity, response.unit) == ("V/F", "mobility", "m/(N*s)")


PHASES = {
    "1/(s + 1)^3": ((0.1, 10, 1000), [-3 * math.degrees(math.atan(w)) for w in (0.1, 10, 1000)], 1e-9),
    # Five resonances, without points between them.
    "1/(" + "*".join(f"(s^2 + 0.001*s + {k * k})" for k in range(1, 6)) + ")": (
        (0.001, 1000),
        [0, -900],
        1e-3,
    ),
    # Roots on the axis: a pole, a zero, two poles.
    "1/(s^2 + 4)": ((1.999999999, 2.000000001), [0, -180], 0),
    "s^2 + 4": ((1.999999999, 2.000000001), [0, 180], 0),
    "1/(s^2 + 4)^2": ((1, 3), [0, -360], 0),
    # Roots on the right: a zero lags, poles lead, a zero mirrored by another does neither.
    "(1 - s)/(1 + s)": ((5.0,), [-2 * math.degrees(math.atan(5))], 1e-10),
    "1/(s^2 - 0.01*s + 1)": ((1e-4, 1e4), [0, 180], 1e-3),
    "4 - s^2": ((1, 100), [0, 0], 0),
    # Roots at 0, and gains below 0.
    "1/(s^2*(s + 1))": ((1e-6,), [-180], 1e-3),
    "s/(s + 1)": ((1e-6,), [90], 1e-3),
    "-1/(s + 1)": ((1e-6,), [-180], 1e-3),
    "-1/(s^2*(s + 1))": ((1e-6,), [0], 1e-3),
}


def test_phases_are_those_of_the_factors():
    for expression, (omega, expected, off) in PHASES.items():
        assert degrees(expression, *omega) == pytest.approx(expected, abs=off), expression


def test_the_side_of_an_irrational_undamped_pole_is_told_within_one_unit_in_the_last_place():
    below = math.sqrt(2)
    while Fraction(below) ** 2 > 2:
        below = math.nextafter(below, 0)
    assert degrees("1/(s^2 + 2)", below, math.nextafter(below, 2)).tolist() == [0, -180]


def test_phase_is_that_of_unwrapping_on_a_dense_grid():
    omega = np.geomspace(0.01, 100, 20_001)
    s = 1j * omega
    dense = (s**2 + 0.1 * s + 9) * (2 - s) / ((s**2 + 0.02 * s + 1) * (s + 4) ** 3 * s)
    expected = np.unwrap(np.angle(dense))[::1000]
    response = respond(rational("(s^2 + 0.1*s + 9)*(2 - s)/((s^2 + 0.02*s + 1)*(s + 4)^3*s)"), omega[::1000])
    np.testing.assert_allclose(response.phase, expected, atol=1e-9)


def test_frequencies_must_be_a_row_of_finite_numbers():
    for omega in [[[1.0]], [math.nan], [1.0, math.inf]]:
        with pytest.raises(UsageError, match="one-dimensional array of finite numbers"):
            respond(rational("1/(s + 1)"), omega)
    for omega in [2j, [1.0, 2j], "fast", [10**400], [[1.0], [1.0, 2.0]]]:
        with pytest.raises(UsageError, match=r"SF902.*omega must be real numbers"):
            respond(rational("1/(s + 1)"), omega)


def test_the_arrays_are_read_only_and_copies():
    omega = np.array([1.0])
    response = respond(rational("1/(s + 1)"), omega)
    assert not (response.values.flags.writeable or response.omega.flags.writeable)
    omega[0] = 2
    assert response.omega[0] == 1


def test_frequency_is_in_hertz():
    assert respond(rational("1/(s + 1)"), [2 * math.pi]).frequency_hz[0] == pytest.approx(1, rel=1e-15)


def test_measured_values_are_unwrapped_from_point_to_point():
    lag = np.linspace(0, 4 * np.pi, 50)
    response = SampledResponse("y/u", np.arange(50.0), np.exp(-1j * lag), "", "")
    np.testing.assert_allclose(response.phase, -lag, atol=1e-12)


def test_arrays_of_different_lengths_are_refused():
    with pytest.raises(ValueError, match="of one length"):
        SampledResponse("y/u", np.ones(2), np.ones(3), "", "")
