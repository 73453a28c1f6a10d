"""The spectrum of a record in time, against a simulation by matrix exponentials that shares no code."""

import numpy as np
import pytest
from scipy.linalg import expm

from symflex.data.fitting.sampled_record import SampledRecord, autoregression
from symflex.data.measurement.measured_response import Samples

STEP, SIZE, LEAD = 0.01, 61, 6


def simulated(p, u, delay, fraction, is_joined, state):
    """Return the state of x' = p x + u(t - delay) at each sample, u beginning LEAD samples before."""

    def over(x, a, b, time):
        matrix = np.array([[p, 1, 0], [0, 0, 1], [0, 0, 0]], complex)  # u = a + (b - a) t/time
        return (expm(matrix * time) @ np.array([x, a, (b - a) / time]))[0]

    states = [state]
    for i in range(LEAD - delay, LEAD - delay + SIZE - 1):
        x, share = states[-1], 1 - fraction
        if is_joined:
            middle = u[i]
            start, end = share * u[i] + fraction * u[i - 1], share * u[i + 1] + fraction * u[i]
        else:
            start = middle = u[i - 1]
        x = over(x, start, middle, fraction * STEP) if fraction else x
        states.append(over(x, middle, end, share * STEP) if is_joined else over(x, u[i], u[i], share * STEP))
    return np.array(states)


def lines_of(x):
    return np.fft.fft(x)[1 : (SIZE - 1) // 2 + 1] / np.sqrt(SIZE)


@pytest.mark.parametrize("is_joined", [False, True])
@pytest.mark.parametrize("p", [-1 + 40j, -3 + 0j, 0j])
@pytest.mark.parametrize(("delay", "fraction"), [(0, 0.0), (0, 0.3), (3, 0.7)])
def test_a_pole_adds_to_the_spectrum_what_it_adds_to_the_samples(is_joined, p, delay, fraction):
    u = np.random.default_rng(1).standard_normal(SIZE + LEAD)
    x = simulated(p, u, delay, fraction, is_joined, 0.3)
    spectrum = lines_of(x)
    record = SampledRecord(STEP, np.zeros(SIZE), u, LEAD, is_joined)
    pole = record.pole(p, (delay + fraction) * STEP)
    free = np.column_stack((pole.free, record.at_first_sample()))
    rest = spectrum - pole.driven
    assert np.allclose(free @ np.linalg.lstsq(free, rest, rcond=None)[0], rest, atol=1e-12)


@pytest.mark.parametrize("is_joined", [False, True])
@pytest.mark.parametrize("p", [-1 + 40j, 0j])
def test_a_record_from_rest_needs_no_free_state(is_joined, p):
    u = np.concatenate((np.zeros(LEAD + 1), np.random.default_rng(2).standard_normal(SIZE - 1)))
    x = simulated(p, u, 3, 0.7, is_joined, 0.0)
    record = SampledRecord.of(Samples(STEP, x.real, u[LEAD:]), is_joined=is_joined, is_at_rest=True, lead=4)
    assert np.allclose(record.pole(p, 3.7 * STEP).driven, lines_of(x), atol=1e-12)


def test_the_colour_of_noise_is_that_of_the_recursion_that_made_it():
    random = np.random.default_rng(3)
    values = np.zeros(20_000)
    for k, e in enumerate(random.standard_normal(20_000)):
        values[k] = 1.5 * values[k - 1] - 0.8 * values[k - 2] + e
    coefficients, variance = autoregression(values)
    assert np.allclose(coefficients, [1, -1.5, 0.8], atol=0.02)  # standard errors are 0.004
    assert abs(variance - 1) < 0.04


def test_the_rounding_of_an_input_is_parted_from_other_noise():
    # Errors of variance q^2/12 pass through a gain that has a peak; beside them the output has white noise.
    random, n, sigma = np.random.default_rng(3), 4000, 0.2
    u = np.round(random.standard_normal(n) / 0.05) * 0.05
    record = SampledRecord.of(Samples(STEP, np.zeros(n), u), is_joined=False)
    assert record.rounding == pytest.approx(0.05 / np.sqrt(12), rel=1e-9)
    gain = np.abs(1e5 / (100**2 - record.omega**2 + 4j * record.omega))
    errors = 0.05 * (random.random(n) - 0.5)
    residual = gain * record.spectrum(errors) + record.spectrum(sigma * random.standard_normal(n))
    noise = record.with_noise(residual, gain).noise
    expected = np.hypot(sigma, gain * 0.05 / np.sqrt(12))
    assert expected.max() > 10 * sigma and np.max(np.abs(noise / expected - 1)) < 0.1
