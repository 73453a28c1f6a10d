"""Responses to one sample, beside those of differential equations."""

import numpy as np
import pytest

from symflex import pipeline
from symflex.data.fitting.identifiable import Coefficients
from symflex.data.fitting.pulse_response import of_coefficients, of_function


@pytest.mark.parametrize("is_joined", [False, True])
def test_the_pulse_response_of_a_lag_is_that_of_its_differential_equation(is_joined):
    # T y' + y = K u, solved by hand between samples: h_1 and its ratio a, slopes by differences
    model = pipeline.loads(
        "symflex = 1\nparameters.K = 4\nparameters.T = 2\ninputs.u = {}\noutputs.y = 'K*u/(T*s + 1)'"
    )
    (tf,), _ = pipeline.derive_as(model, [("y", "u")])
    coefficients = Coefficients.of(tf, ["K", "T"])
    h, a = 0.3, np.exp(-0.3 / 2)
    made = of_coefficients(coefficients, np.array([4.0, 2.0]), h, 5, is_joined=is_joined)
    ramp = 1 - (1 - a) * 2 / h  # response to u = t/h, over K, after one step
    first = [4 * ramp, 4 * (a * ramp + (1 - a) - ramp)] if is_joined else [0, 4 * (1 - a)]
    expected = np.r_[first, first[1] * a ** np.arange(1, 4)]
    assert made.values == pytest.approx(expected, rel=1e-12)
    other = of_function(
        lambda s: (4 / (2 * s + 1), np.stack((1 / (2 * s + 1), -4 * s / (2 * s + 1) ** 2), axis=1)),
        h,
        5,
        64,
        is_joined=is_joined,
    )
    assert other.values == pytest.approx(expected, abs=2e-3)
    assert made.slopes == pytest.approx(other.slopes, abs=2e-3)
    assert made.slopes[:, 0] == pytest.approx(expected / 4, rel=1e-12)
