"""Finely discretised models, stepped through time, come to the responses with the order of their elements."""

import numpy as np
import pytest

from symflex import loads
from symflex.analysis.time_response import SampleTimes, time_response

LAST, ETA, GAIN, LATE = 1.5, 0.02, 2.0, 0.3
ARM = (
    'elements.arm = { type = "beam", between = ["ground", "x"], E = "1 Pa", A = "1 m^2", I = "1 m^4", '
    'rho = "1 kg/m^3", l = "1 m", eta = "0.02 s" }\noutputs.X = "x"\n'
)
OPEN = f'symflex = 1\n{ARM}inputs.F = {{ force = "x" }}\n'
LOOP = f"""symflex = 1
{ARM}
parameters = {{ k = "2 N/m", T = "0.3 s" }}
inputs.r = {{ unit = "m" }}
elements.f = {{ type = "force_source", at = "x", f = "k*(r - D*x)" }}
blocks.D = {{ type = "delay", T = "T" }}
"""


def stepped(elements, is_late):
    """Return the tip of a cantilever of cubic elements at five times, by the trapezoidal rule.

    Steps fall with the square of the elements' length, so that both errors fall with its fourth power.
    """
    h, n, steps = 1 / elements, 2 * elements, 10 * elements**2
    stiff = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]]) / h**3
    heavy = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) * h / 420
    scale = np.diag([1, h, 1, h])  # of deflections, and of slopes
    K, M = np.zeros((2, n + 2, n + 2))
    for e in range(elements):
        part = slice(2 * e, 2 * e + 4)
        K[part, part] += scale @ stiff @ scale
        M[part, part] += scale @ heavy @ scale
    pull = np.linalg.solve(M[2:, 2:], K[2:, 2:])
    push = np.linalg.solve(M[2:, 2:], np.eye(n)[n - 2])
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-pull, -ETA * pull]])
    dt = LAST / steps
    ahead = np.linalg.inv(np.eye(2 * n) - dt / 2 * A)
    move, given = ahead @ (np.eye(2 * n) + dt / 2 * A), dt * ahead @ np.concatenate([np.zeros(n), push])
    back = round(LATE / dt)
    state, tips = np.zeros(2 * n), [0.0]
    for i in range(steps):
        seen = (tips[i - back] + tips[i - back + 1]) / 2 if i >= back else 0.0
        state = move @ state + given * (GAIN * (1 - seen) if is_late else 1.0)
        tips.append(state[n - 2])
    return np.array(tips)[steps // 5 :: steps // 5]


@pytest.mark.parametrize("is_late", [False, True])
@pytest.mark.slow
def test_twice_as_many_elements_come_sixteen_times_closer_alone_and_in_a_loop_with_a_delay(is_late):
    bound = loads(LOOP if is_late else OPEN).transfer_function("X", "r" if is_late else "F").bind().bound
    found = time_response(bound, "step", SampleTimes.of(np.linspace(0, LAST, 6)[1:]), 7)
    errors = [np.max(np.abs(stepped(n, is_late) - found.values)) for n in (2, 4, 8)]
    assert found.certified or is_late
    assert 3.9 < np.log2(errors[0] / errors[1]) < 4.1
    assert 3.9 < np.log2(errors[1] / errors[2]) < 4.1
    assert errors[2] < 1e-4 * np.max(found.values)
