"""Input shapers leave the modes they are made for at rest."""

from math import acos, exp, pi, sqrt

import numpy as np
import pytest
from flint import acb
from scipy.integrate import solve_ivp

from symflex import loads
from symflex.analysis.input_shaping import SHAPERS, input_shaper
from symflex.errors import ModelError
from tests.unit.analysis.systems import rational, words


def step(t, zeta, omega):
    """Return the step response of a second-order system, in closed form, 0 before t = 0."""
    t = np.maximum(t, 0)
    damped = omega * sqrt(1 - zeta**2)
    decay = np.exp(-zeta * omega * t)
    return 1 - decay * (np.cos(damped * t) + zeta * omega / damped * np.sin(damped * t))


def test_after_the_last_impulse_a_shaped_step_stands_still():
    for zeta in (0.0, 0.1):
        for kind in ["zv", "zvd"]:
            shaper = input_shaper(rational(f"9/(s^2 + {6 * zeta}*s + 9)"), kind=kind)
            times = shaper.times[-1] + np.linspace(0, 20, 200)
            shaped = sum(
                a * step(times - t, zeta, 3.0) for t, a in zip(shaper.times, shaper.amplitudes, strict=True)
            )
            assert np.max(np.abs(shaped - 1)) < 1e-14, (zeta, kind)
            assert sum(shaper.amplitudes) == pytest.approx(1, abs=1e-15), (zeta, kind)


def test_zv_amplitudes_are_those_of_singer_and_seering():
    zeta = 0.1
    shaper = input_shaper(rational("9/(s^2 + 6*s/10 + 9)"))
    k = exp(-zeta * pi / sqrt(1 - zeta**2))
    assert shaper.amplitudes == pytest.approx((1 / (1 + k), k / (1 + k)), rel=1e-15)
    assert shaper.times == pytest.approx((0.0, pi / (3 * sqrt(1 - zeta**2))), rel=1e-15)


def left_of(shaper, omega, zeta=0.0):
    """Return the residual vibration that Singer and Seering define, at another frequency."""
    damped, last = omega * sqrt(1 - zeta**2), shaper.times[-1]
    parts = [
        (a * exp(zeta * omega * (t - last)), damped * t)
        for t, a in zip(shaper.times, shaper.amplitudes, strict=True)
    ]
    return sqrt(sum(a * np.cos(p) for a, p in parts) ** 2 + sum(a * np.sin(p) for a, p in parts) ** 2)


def test_ei_keeps_five_percent_over_its_range_and_no_further():
    shaper = input_shaper(rational("1/(s^2 + 4)"), kind="ei")
    reach = acos((1 - 3 * 0.05) / (1 + 0.05)) / pi  # about 0.2: the insensitivity is 0.4
    ratios = np.linspace(1 - reach, 1 + reach, 301)
    assert max(left_of(shaper, 2 * r) for r in ratios) <= 0.05 + 1e-12
    assert left_of(shaper, 2 * (1 + reach) * 1.01) > 0.05
    assert left_of(shaper, 2.0) == pytest.approx(0.05)


def test_ei_leaves_five_percent_of_a_damped_mode():
    for zeta in [0.01, 0.05, 0.15]:
        shaper = input_shaper(rational(f"9/(s^2 + {6 * zeta}*s + 9)"), kind="ei")
        assert left_of(shaper, 3.0, zeta) == pytest.approx(0.05, rel=1e-12), zeta


def test_the_residual_encloses_the_definition_at_other_frequencies():
    for kind in SHAPERS:
        shaper = input_shaper(rational("9/(s^2 + 6*s/10 + 9)"), kind=kind)
        for omega in (2.0, 2.9, 3.5):
            pole = acb(-0.1 * omega, omega * sqrt(0.99))
            assert float(shaper.residual(pole)) == pytest.approx(left_of(shaper, omega, 0.1), rel=1e-12), kind


def test_two_modes_take_the_convolution_of_their_shapers():
    bound = rational("1/((s^2 + s/10 + 4)*(s^2 + s/5 + 25))")
    shaper = input_shaper(bound, modes=2)
    assert len(shaper.times) == 4
    assert all(shaper.residual(pole.enclosure()) < 1e-20 for pole in shaper.poles)


def test_a_beam_has_shapers_too():
    text = 'symflex = 1\nelements.arm = { type = "beam", between = ["ground", "x"], E = "1 Pa", A = "1 m^2", '
    text += 'I = "1 m^4", rho = "1 kg/m^3", l = "1 m" }\ninputs.F = { force = "x" }\noutputs.X = "x"'
    shaper = loads(text).transfer_function("X", "F").bind().input_shaper(2, "zvd")
    assert shaper.times[1] == pytest.approx(pi / 4.694091132974175**2, rel=1e-12)  # OEIS A076418
    assert len(shaper.times) == 9


def test_what_there_is_not_is_refused():
    for modes, kind, said in (
        (1, "zvdd", "did you mean 'zvd'"),
        (2, "zv", "has only 1 oscillatory mode"),
        (0, "zv", "--modes 0"),
    ):
        found = words(input_shaper, rational("1/(s^2 + s/10 + 4)"), modes, kind)
        assert found.startswith("UsageError") and said in found, (modes, kind)


def test_a_mode_that_hardly_rings_has_no_ei_shaper():
    with pytest.raises(ModelError, match="SF814"):
        input_shaper(rational("1/(s^2 + 3*s + 4)"), kind="ei")


def rung(stiffness, shaper, *, damping):
    """Return the largest motion of a load on a spring after the last impulse, over that after a step.

    It is integrated with steps from the moments on at which the force changes.
    """

    def moved(moments, sizes):
        state, force = np.zeros(2), 0.0
        ends = [*moments[1:], moments[-1] + 4 * 2 * pi / sqrt(stiffness)]
        for begin, end, size in zip(moments, ends, sizes, strict=True):
            force += size
            found = solve_ivp(
                lambda _, w, f=force: [w[1], f - stiffness * w[0] - damping * w[1]],
                (begin, end),
                state,
                method="DOP853",
                rtol=1e-13,
                atol=1e-16,
                dense_output=True,
            )
            state = found.y[:, -1]
        return np.max(np.abs(found.sol(np.linspace(begin, end, 400))[0] - force / stiffness))

    return moved(shaper.times, shaper.amplitudes) / moved([0.0], [1.0])


def test_an_integrator_finds_nothing_left_at_the_poles_of_the_model():
    for kind, damping in [("zv", 0.0), ("zv", 0.4), ("zvd", 0.4)]:
        shaper = input_shaper(rational(f"1/(s^2 + {damping}*s + 9)"), kind=kind)
        assert rung(9.0, shaper, damping=damping) < 1e-9, (kind, damping)


def test_an_integrator_finds_the_bound_of_ei_kept_over_its_range():
    shaper = input_shaper(rational("1/(s^2 + 9)"), kind="ei")
    for ratio in (0.81, 1.19):
        assert rung(9.0 * ratio**2, shaper, damping=0.0) < 0.05 + 1e-9, ratio


def test_asked_for_a_joint_shaper_those_of_the_modes_stand_in_a_row():
    bound = rational("1/((s^2 + 1)*(s^2 + 2))")
    shaper = input_shaper(bound, 2, joint=True)
    assert shaper.times == input_shaper(bound, 2).times
    assert "one for each mode, in series" in str(shaper)
