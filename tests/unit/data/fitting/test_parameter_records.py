"""Parameters of specifications come back from records in time that were simulated beside them."""

import numpy as np
from scipy.linalg import expm

from symflex.data.measurement.measured_response import Samples
from tests.unit.data.fitting.test_parameters import MOTOR, motor


def test_a_record_in_time_gives_the_parameters_of_a_motor_that_starts(fitted):
    # a step at rest: the state equations of winding and rotor, a held input, the matrix exponential
    h, n = 2e-4, 600
    system = np.zeros((3, 3))
    system[:2] = [[-1.2 / 1e-3, -0.05 / 1e-3, 1 / 1e-3], [0.05 / 3e-5, -2e-4 / 3e-5, 0]]
    ahead = expm(system * h)
    u = np.r_[np.zeros(20), np.full(n - 20, 12.0)]
    x, y = np.zeros(2), np.zeros(n)
    for k in range(n):
        y[k] = x[1]
        x = ahead[:2, :2] @ x + ahead[:2, 2] * u[k]
    y += 0.01 * y.std() * np.random.default_rng(10).standard_normal(n)
    f = np.geomspace(0.5, 2000, 80)
    found = fitted("R,k,J", motor(f), MOTOR, "w/u", f, samples=(Samples(h, y, u),))
    assert np.max(np.abs(found.theta - [1.2, 0.05, 3e-5]) / found.errors) < 3
    assert np.max(found.errors / found.theta) < 0.05
    assert "begins at rest" in found.in_time[0]
    assert not found.poor


def of_motor(source, n=600, h=2e-4):
    """A voltage that switches, and the speed of the motor that it drives, with 1 % of noise."""
    system = np.zeros((3, 3))
    system[:2] = [[-1.2 / 1e-3, -0.05 / 1e-3, 1 / 1e-3], [0.05 / 3e-5, -2e-4 / 3e-5, 0]]
    ahead = expm(system * h)
    u, x, y = np.repeat(source.choice([0.0, 12.0], n // 20), 20), np.zeros(2), np.zeros(n)
    for k in range(n):
        y[k] = x[1]
        x = ahead[:2, :2] @ x + ahead[:2, 2] * u[k]
    return h, u, y + 0.01 * y.std() * source.standard_normal(n)


def test_a_drift_is_fitted_and_said(fitted):
    h, u, y = of_motor(np.random.default_rng(12))
    f = np.geomspace(20, 2000, 80)
    drift = 40.0 * y.std() * h * np.arange(y.size)  # per second, 40 deviations of the output
    found = fitted("R,k,J", motor(f), MOTOR, "w/u", f, samples=(Samples(h, y + drift, u),))
    assert np.max(np.abs(found.theta - [1.2, 0.05, 3e-5]) / found.errors) < 3.5
    assert np.max(found.errors / found.theta) < 0.02
    assert f"it drifts by {40 * y.std():.2g}"[:16] in found.in_time[0]
    still = fitted("R,k,J", motor(f), MOTOR, "w/u", f, samples=(Samples(h, y, u),))
    assert "drifts" not in still.in_time[0]


def test_a_record_of_the_other_sign_is_said(fitted):
    h, u, y = of_motor(np.random.default_rng(13))
    f = np.geomspace(20, 2000, 80)
    # The response alone has the right sign: the samples are those that are wrong.
    found = fitted("R,k,J", motor(f), MOTOR, "w/u", f, samples=(Samples(h, -y, u),))
    assert found.poor[0] == "with the other sign the data agree far better with the specification"


def test_a_record_may_begin_in_motion_with_an_offset(fitted):
    # an offset of the sensor, and a lag that was moving before: T y' + y = K u, solved between samples
    text = "symflex = 1\nparameters.K = 1\nparameters.T = 3\ninputs.u = {{}}\noutputs.y = 'K*u/(T*s + 1)'"
    source = np.random.default_rng(11)
    u, a = np.repeat(source.integers(0, 2, 40) * 2.0, 10), np.exp(-0.1 / 2)
    y = np.empty(u.size)
    state = 5.0
    for k in range(u.size):
        y[k] = 0.7 + state
        state = a * state + (1 - a) * 4 * u[k]
    y += 0.02 * source.standard_normal(u.size)
    f = np.geomspace(0.01, 4, 40)
    response = 4 / (1 + 2j * np.pi * f * 2)
    found = fitted("K,T", response, text, "y/u", f, samples=(Samples(0.1, y, u),))
    assert np.max(np.abs(found.theta - [4, 2]) / found.errors) < 3
    assert "state that it begins with is fitted" in found.in_time[0]
