"""Fits of simulated responses without coherence and without a base are right, or say that they are poor."""

from __future__ import annotations

import numpy as np
import pytest

from symflex.budget import Budget
from symflex.data.fitting import fit_resonances
from symflex.data.fitting.lines import step_line
from symflex.data.measurement import MeasuredResponse
from symflex.options import FitOptions
from tests.unit.data.laboratory import (
    SHAPES,
    deviations,
    judged,
    limit_for,
    pair,
    simulated,
    study,
    summary,
    wild,
)

OMEGA = 2 * np.pi


def two_modes(seed, gain=2.5, noise=0.03):
    """Return two resonances exactly in the model class, with noise in percent of each line."""
    random = np.random.default_rng(seed)
    frequency = np.arange(5.0, 60.0, 0.2)
    s = OMEGA * 1j * frequency
    values = gain * pair(s, OMEGA * 18, 0.02) / pair(s, OMEGA * 14, 0.02)
    values = values * pair(s, OMEGA * 39, 0.02) / pair(s, OMEGA * 32, 0.012)
    error = random.standard_normal(s.size) + 1j * random.standard_normal(s.size)
    return MeasuredResponse("y/u", frequency, values * (1 + noise * error / np.sqrt(2)))


@pytest.mark.parametrize("start", ["peaks", "auto"])
def test_two_modes_with_three_percent_noise_are_found_from_every_start(start):
    fit = fit_resonances([two_modes(1)], None, FitOptions(modes=2, start=start))
    found, errors = fit.resonances, fit.standard_errors()
    assert fit.poor == ()
    assert found.omega_p / OMEGA == pytest.approx([14, 32], rel=0.001)
    assert found.zeta_p == pytest.approx([0.02, 0.012], abs=4 * errors.zeta_p.max())
    assert found.gain[0] == pytest.approx(2.5, abs=4 * errors.gain[0])


def test_the_sign_of_a_gain_is_found():
    fit = fit_resonances([two_modes(2, gain=-2.5)], None, FitOptions(modes=2))
    assert fit.resonances.gain[0] == pytest.approx(-2.5, rel=0.02)


@pytest.mark.slow
def test_too_few_resonances_are_called_poor():
    assert fit_resonances([two_modes(3)], None, FitOptions(modes=1)).poor != ()


@pytest.mark.slow
def test_responses_measured_as_different_quantities_have_powers_of_s_of_their_own():
    one, other = two_modes(4), two_modes(5)
    other = MeasuredResponse("z/u", other.frequency_hz, other.values * (OMEGA * 1j * other.frequency_hz) ** 2)
    fit = fit_resonances([one, other], None, FitOptions(modes=2))
    assert [base.slope for base in fit.bases] == [0, 2]
    assert fit.resonances.gain == pytest.approx([2.5, 2.5], rel=0.01)


@pytest.mark.slow
def test_a_case_of_every_shape_is_right():
    results = study(len(SHAPES), seed=11)
    assert [shape for shape, *_ in results] == list(SHAPES)
    assert summary(results)["wrong and not called poor"] == 0


def test_a_result_without_a_resonance_is_never_counted_as_right():
    class Truth:
        poles, zeros, slope, gain, delay = np.array([[10.0, 0.1]]), np.zeros((0, 2)), 0, 1.0, None

    assert np.isinf(deviations(Truth, [], [], 0, (1.0, 0.1), (0.0, 1.0))).all()


@pytest.mark.slow
@pytest.mark.parametrize(("count", "modes_given"), [(20, True), (4, False)])
def test_of_many_data_sets_nearly_all_are_right_or_poor(count, modes_given):
    figures = summary(study(count, seed=12, modes_given=modes_given))
    # With a share of 97 % fewer than 19 of 20 are right once in eight times, and not with this seed;
    # ``python -m tests.tools.fits lines 500`` repeats the whole study.
    assert figures["data sets right, jointly"] >= 0.92
    assert figures["parameters within three standard errors"] >= 0.985
    assert figures["wrong and not called poor"] <= count // 20
    assert count < 20 or 0.63 < figures["parameters within one"] < 0.75


@pytest.mark.slow
@pytest.mark.parametrize(("number", "slope"), [(101, 2), (445, 1)])
def test_real_poles_and_zeros_far_below_the_band_are_powers_of_s(number, slope):
    # Set 101 of the study: with s^3 and a pole at 1e-7 rad/s the function is the same, its gain is not. Set
    # 445: without s, and a pair of zeros at 0.01 and at 4000 Hz.
    case = wild(1, number)
    fit = fit_resonances([MeasuredResponse("y/u", case.frequency_hz, case.values)])
    off, _ = judged(case, fit)
    assert fit.bases[0].slope == case.slope == slope
    assert off.max() < 3


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "number"), [(1, 198), (2, 0)])
def test_errors_of_zeros_that_stand_for_a_mode_outside_the_band_count_what_is_not_known_of_it(seed, number):
    # The mode of set 198 is at 65 Hz and the band ends at 40. Without one more pair of poles, zeros at 37 Hz
    # follow what it bends, and the data do not tell the difference. In the other set a mode at 58 Hz and
    # zeros at 32 move the damping of zeros at 19.5 Hz by a quarter, the band ends at 24.5.
    case = wild(seed, number)
    off, _ = judged(case, fit_resonances([MeasuredResponse("y/u", case.frequency_hz, case.values)]))
    assert off.max() < limit_for(off.size)


@pytest.mark.slow
@pytest.mark.parametrize("factor", [1.05, 1.12, 0.9])
def test_a_step_of_the_gain_is_named_with_its_lines(factor):
    data = two_modes(7, noise=0.005)
    values = np.where(data.frequency_hz > 45.1, factor, 1.0) * data.values
    fit = fit_resonances([MeasuredResponse("y/u", data.frequency_hz, values)], None, FitOptions(modes=2))
    assert any("the magnitude steps between 45 and 45.2 Hz" in reason for reason in fit.poor)


def test_noise_resonances_and_rounded_numbers_are_no_step_of_the_gain():
    x = np.arange(1.0, 300)
    flat = 10 ** (np.round(20 * np.log10(abs(1 / pair(1j * x, 800, 0.3))), 1) / 20) + 0j
    cases = [draw(3, number) for draw in (wild, simulated) for number in range(60)]
    found = [step_line(case.frequency_hz, case.values) for case in cases]
    assert [step_line(x, flat), *found] == [None] * 121
    gap = np.delete(x, 100)
    assert step_line(gap, 1 / pair(1j * gap, 80, 0.3)) is None
    assert step_line(x, np.where(x > 150, 1.03, 1) / pair(1j * x, 80, 0.3)) == 149


def written(number, digits):
    return float(f"{number:.{digits}}")


@pytest.mark.slow
@pytest.mark.parametrize("is_cartesian", [True, False])
def test_rounded_numbers_of_a_ladder_filter_are_no_reason_to_call_a_fit_poor(is_cartesian):
    # Four digits of real and imaginary part, or five of the level and tenths of a degree, over four decades.
    frequency = np.geomspace(10, 1e5, 401).round(6)
    s = OMEGA * 1j * frequency
    exact = 1 / (pair(s, OMEGA * 1e3, 0.3) * pair(s, OMEGA * 2.5e3, 0.05) * pair(s, OMEGA * 6e3, 0.02))
    if is_cartesian:
        values = [complex(written(h.real, "4g"), written(h.imag, "4g")) for h in exact]
    else:
        level = [written(x, "5g") for x in 20 * np.log10(abs(exact))]
        turn = [written(x, "1f") for x in np.degrees(np.angle(exact))]
        values = 10 ** (np.array(level) / 20) * np.exp(1j * np.radians(turn))
    fit = fit_resonances([MeasuredResponse("y/u", frequency, values)])
    assert fit.poor == ()
    assert fit.resonances.omega_p / OMEGA == pytest.approx([1e3, 2.5e3, 6e3], rel=1e-3)


@pytest.mark.slow
def test_a_delay_that_is_not_asked_for_and_spoils_the_gain_is_a_reason():
    frequency = np.array([written(f, "4g") for f in np.geomspace(1, 1000, 601)])
    s = OMEGA * 1j * frequency
    exact = 200 / s**2 * np.exp(-1e-4 * s)
    for zero, pole, zeta_z, zeta_p in ((40, 55, 0.02, 0.02), (130, 140, 0.01, 0.01)):
        exact = exact * pair(s, OMEGA * zero, zeta_z) / pair(s, OMEGA * pole, zeta_p)
    level = [written(x, "4g") for x in 20 * np.log10(abs(exact))]
    turn = [written(x, "4g") for x in np.degrees(np.angle(exact))]
    values = 10 ** (np.array(level) / 20) * np.exp(1j * np.radians(turn))
    fit = fit_resonances([MeasuredResponse("y/u", frequency, values)])
    is_right = fit.resonances.gain[0] == pytest.approx(200, rel=0.01)
    assert is_right or any("try --delay" in reason for reason in fit.poor)


@pytest.mark.slow
@pytest.mark.parametrize("seconds", [0.0, 0.3, 1.0])
def test_whatever_the_time_the_best_fit_so_far_is_returned(seconds):
    with Budget(seconds=seconds).entered():
        fit = fit_resonances([two_modes(6)])
    assert fit.resonances.order == 4 or "the time budget ended before the fit was complete" in fit.poor
