from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from symflex.budget import Budget
from symflex.data.fitting import STARTS, Base, fit_resonances
from symflex.data.measurement import MeasuredResponse
from symflex.errors import DataError, FitError, UsageError
from symflex.options import FitOptions
from tests.unit.data.analyser import System, measured, rigid

# The modes of the paper with its typical ratio and damping; the zero of 38 Hz lies between it and 44 Hz.
PAPER_HZ = np.array([11.0, 38.0, 44.0, 67.0, 77.0])
PAPER = System(PAPER_HZ, np.full(5, 0.05), 1.1 * PAPER_HZ, np.full(5, 0.05))
ONE = System(np.array([20.0]), np.array([0.02]), np.array([25.0]), np.array([0.03]))
FREQUENCY = np.arange(2.0, 100.0, 0.25)
UNIT = [Base(np.ones_like)]


def exact(system, name="y/u"):
    return MeasuredResponse(name, FREQUENCY, system(FREQUENCY))


def noisy(system, seed=1, **more):
    return measured(system, np.random.default_rng(seed), record=8.0, **more)


def test_every_start_leads_to_the_paper_s_modes():
    for start in STARTS:
        fit = fit_resonances([exact(PAPER)], UNIT, FitOptions(modes=5, start=start))
        assert fit.resonances.omega_p / (2 * np.pi) == pytest.approx(PAPER.f_p, rel=1e-6), start
        assert fit.resonances.zeta_p == pytest.approx(PAPER.zeta_p, rel=1e-5), start
        assert fit.resonances.omega_z[0] / (2 * np.pi) == pytest.approx(PAPER.f_z, rel=1e-6), start


@pytest.mark.slow
def test_the_close_pair_is_not_swapped_and_five_modes_are_chosen():
    fit = fit_resonances([noisy(PAPER)], UNIT)
    assert fit.resonances.count == 5
    assert fit.resonances.omega_p / (2 * np.pi) == pytest.approx(PAPER.f_p, rel=0.005)
    assert fit.resonances.omega_z[0] / (2 * np.pi) == pytest.approx(PAPER.f_z, rel=0.005)
    assert min(fit.scores, key=lambda s: s.bic).count == 5


def test_without_coherence_all_lines_weigh_alike():
    data = replace(noisy(PAPER), coherence=None)
    fit = fit_resonances([data], UNIT, FitOptions(modes=5))
    assert fit.resonances.omega_p / (2 * np.pi) == pytest.approx(PAPER.f_p, rel=0.01)


def test_without_a_base_gain_and_power_of_s_are_found():
    omega = 2 * np.pi * FREQUENCY
    data = MeasuredResponse("y/u", FREQUENCY, -0.3 * (1j * omega) ** 2 * ONE(FREQUENCY))
    fit = fit_resonances([data], None, FitOptions(modes=1))
    assert fit.bases[0].slope == 2
    assert fit.resonances.gain[0] == pytest.approx(-0.3)
    assert fit.resonances.zeta_z[0, 0] == pytest.approx(0.03)


@pytest.mark.parametrize("unit", [1e-90, 1e98])
def test_the_unit_of_the_values_changes_the_gain_alone(unit):
    frequency = np.arange(5.0, 45.0, 0.5)
    s, error = 2j * np.pi * frequency, np.random.default_rng(1).standard_normal((2, frequency.size))
    values = (1 + 0.01 * (error[0] + 1j * error[1])) / (s**2 + 5 * s + 126.0**2)
    one, other = (
        fit_resonances([MeasuredResponse("y/u", frequency, k * values)], None, FitOptions(modes=1, slope=0))
        for k in (1.0, unit)
    )
    assert other.resonances.omega_p == pytest.approx(one.resonances.omega_p, rel=1e-9)
    assert other.resonances.gain / unit == pytest.approx(one.resonances.gain, rel=1e-9)
    assert other.standard_errors().zeta_p == pytest.approx(one.standard_errors().zeta_p, rel=1e-6)


def rounded(lines, data):
    """Return data written as level and phase, all numbers with four digits."""

    def written(numbers):
        return np.array([float(f"{x:.4g}") for x in numbers])

    level, turn = written(20 * np.log10(np.abs(data))), written(np.degrees(np.angle(data)))
    return MeasuredResponse("y/u", written(lines), 10 ** (level / 20) * np.exp(1j * np.radians(turn)))


def test_rounded_frequencies_and_levels_are_not_taken_for_poles():
    lines = np.geomspace(10.0, 1e3, 161)
    data = 10 * System(np.array([100.0]), np.array([0.02]), np.array([250.0]), np.array([0.01]))(lines)
    fit = fit_resonances([rounded(lines, data)])
    errors = fit.standard_errors()
    assert not fit.poor and max(score.order for score in fit.scores) < 6
    assert abs(fit.resonances.omega_p[0] / (2 * np.pi) - 100) < 3 * errors.omega_p[0] / (2 * np.pi) < 0.01
    assert abs(fit.resonances.zeta_p[0] - 0.02) < 3 * errors.zeta_p[0] < 1e-4


def test_a_resonance_that_steps_of_rounded_levels_look_like_is_called_poor():
    # One resonance at 25 Hz, written with 0.1 dB and whole degrees; another at 8.7 Hz fits the steps.
    frequency = np.linspace(5, 50, 130)
    s, w = 2j * np.pi * frequency, 50 * np.pi
    exact = w**2 / (s**2 + 0.022 * w * s + w**2)
    level, angle = np.round(20 * np.log10(np.abs(exact)), 1), np.round(np.degrees(np.angle(exact)))
    data = MeasuredResponse("y/u", frequency, 10 ** (level / 20) * np.exp(1j * np.radians(angle)))
    fit = fit_resonances([data])
    assert fit.modes.sum() == 1 or any("the data have few digits" in reason for reason in fit.poor)


def test_rounded_phases_of_a_double_integrator_show_no_zero_far_below_the_band():
    lines = np.geomspace(1.0, 100.0, 401)
    axis = System(np.array([55.0]), np.array([0.02]), np.array([40.0]), np.array([0.02]))
    fit = fit_resonances(
        [rounded(lines, -200 / (2 * np.pi * lines) ** 2 * axis(lines))], None, FitOptions(modes=1)
    )
    assert fit.resonances.slope[0] == -2 and not fit.poor
    assert abs(fit.resonances.gain[0] - 200) < 3 * fit.standard_errors().gain[0] < 0.1


def test_a_lag_of_the_sensor_is_found():
    data = MeasuredResponse("y/u", FREQUENCY, ONE(FREQUENCY) / (1 + 2j * np.pi * FREQUENCY * 2e-4))
    fit = fit_resonances([data], UNIT, FitOptions(modes=1, is_lag_free=True))
    assert fit.resonances.lag[0] == pytest.approx(2e-4)


@pytest.mark.slow
def test_responses_share_their_poles():
    other = replace(PAPER, f_z=1.05 * PAPER.f_p, zeta_z=np.full(5, 0.03))
    fit = fit_resonances([exact(PAPER, "a/u"), exact(other, "b/u")], UNIT * 2, FitOptions(modes=5))
    assert fit.resonances.omega_p / (2 * np.pi) == pytest.approx(PAPER.f_p, rel=1e-6)
    assert fit.resonances.omega_z[1] / (2 * np.pi) == pytest.approx(other.f_z, rel=1e-6)
    assert fit.resonances.zeta_z[1] == pytest.approx(other.zeta_z, rel=1e-5)


def test_a_minimum_phase_function_passes_the_phase_test():
    assert fit_resonances([noisy(PAPER)], UNIT, FitOptions(modes=5)).phase_tests[0].is_minimum_phase


@pytest.mark.slow
def test_zeros_in_the_right_half_plane_are_found_and_fail_the_phase_test():
    mirrored = replace(PAPER, zeta_z=np.array([0.05, 0.05, 0.05, -0.05, 0.05]))
    fit = fit_resonances([noisy(mirrored)], UNIT, FitOptions(modes=5))
    assert fit.resonances.zeta_z[0] == pytest.approx(mirrored.zeta_z, abs=0.005)
    (worst, *_) = sorted(fit.phase_tests[0].bands, key=lambda band: -abs(band.worst_degrees))
    # At its own frequency a mirrored pair of zeros stands 180 degrees beside the other.
    assert worst.low_hz < 73.7 < worst.high_hz
    assert abs(worst.worst_degrees) == pytest.approx(180, abs=5)


def driving_point(frequency, lag_hz=5000.0):
    """A passive driving point: masses 3, 1, 0.6 kg in a chain to ground, an accelerometer at the first."""
    s = 2j * np.pi * np.asarray(frequency)
    end = 0.6 * s**2 + 9 * s + 50e3
    middle = 1.0 * s**2 + 21 * s + 110e3 - (9 * s + 50e3) ** 2 / end
    first = 3.0 * s**2 + 32 * s + 100e3 - (12 * s + 60e3) ** 2 / middle
    return (
        s**2 / first / (1 + 1.4j * (np.asarray(frequency) / lag_hz) - (np.asarray(frequency) / lag_hz) ** 2)
    )


def driven(seed, noise, **more):
    return measured(driving_point, np.random.default_rng(seed), record=4.0, noise=noise, **more)


def test_a_passive_driving_point_is_minimum_phase():
    # Every driving point of a passive structure is positive real, and has no zeros in the right half-plane.
    (test,) = fit_resonances([driven(2, 0.003)], None, FitOptions(slope=2, modes=3)).phase_tests
    assert test.verdict == "minimum"


@pytest.mark.parametrize("damping", [-0.01, -0.5])
def test_damped_zeros_in_the_right_half_plane_are_not_explained_away(damping):
    data = noisy(replace(ONE, zeta_z=np.array([damping])))
    assert fit_resonances([data], UNIT, FitOptions(modes=1)).phase_tests[0].verdict == "nonminimum"


@pytest.mark.slow
def test_a_delay_that_could_be_poles_above_the_band_is_not_called_nonminimum_phase_and_a_long_one_is():
    def verdict(delay):
        data = noisy(lambda f: ONE(f) * np.exp(-2j * np.pi * f * delay))
        return fit_resonances([data], UNIT, FitOptions(modes=1)).phase_tests[0].verdict

    assert verdict(5e-4) != "nonminimum"
    assert verdict(0.02) == "nonminimum"


@pytest.mark.slow
def test_the_tip_of_a_bending_beam_is_not_minimum_phase():
    # Poles and zeros of derivations/eppinger1988/lumped_bending_beam.toml, X_tip/F, with 1 % of damping:
    # a zero at 28 Hz in either half-plane, none others.
    f = np.arange(2.0, 600.0, 0.5)
    modes = [1 + 0.02j * f / centre - (f / centre) ** 2 for centre in (12.876, 241.365)]
    data = MeasuredResponse("X_tip/F", f, (1 + (f / 28.072) ** 2) / (modes[0] * modes[1] * -(f**2)))
    rough = 0.003 * np.random.default_rng(1).standard_normal((2, f.size))
    data = replace(data, values=data.values * (1 + rough[0] + 1j * rough[1]))
    (test,) = fit_resonances([data], None, FitOptions(modes=2, slope=-2)).phase_tests
    assert test.verdict == "nonminimum"


def test_zeros_that_stand_for_a_power_of_s_are_said_and_turn_no_verdict():
    # Two poles, one pair of zeros and s^2, fitted as s and a real zero near 0, with either sign of the gain.
    two = System(np.array([20.0, 60.0]), np.full(2, 0.02), np.array([25.0, 1e5]), np.array([0.03, 0.0]))
    data = noisy(lambda f: -(f**2) * two(f), noise=0.003)
    fit = fit_resonances([data], None, FitOptions(modes=2, slope=1, start="vector"))
    assert abs(fit.resonances.real_z[0]) < 2 * np.pi * 0.1
    assert any("real zero lies outside the band" in warning for warning in fit.warnings)
    assert fit.phase_tests[0].verdict != "nonminimum"


@pytest.mark.slow
def test_a_gain_is_not_called_minimum_phase_by_data_that_turn_the_other_way():
    data = MeasuredResponse("y/u", FREQUENCY, 1 / (1 - 1j * FREQUENCY / 5))
    fit = fit_resonances([data], None, FitOptions(slope=0))
    assert fit.poor
    assert fit.phase_tests[0].verdict != "minimum"


@pytest.mark.slow
def test_where_no_resonances_describe_the_magnitude_its_phase_says_nothing():
    # A magnitude with ripples that no resonance has: 5 dB are left.
    data = noisy(lambda f: ONE(f) * (1 + 0.7 * np.cos(f / 2)))
    (test,) = fit_resonances([data], UNIT, FitOptions(modes=1)).phase_tests
    assert test.verdict == "undetermined"
    assert test.magnitude_db > 2


def code_of(caught):
    return [d.code for d in caught.value.diagnostics]


def test_data_without_a_resonance_are_fitted_without_one():
    fit = fit_resonances([noisy(lambda f: rigid(2 * np.pi * f))], [Base(rigid)])
    assert not fit.modes.any()
    assert not fit.poor


@pytest.mark.slow
def test_more_resonances_than_there_are_give_a_poor_fit():
    rough = noisy(ONE, noise=0.01)
    fit = fit_resonances([rough], UNIT, FitOptions(modes=3))
    assert fit.poor


@pytest.mark.slow
def test_a_mode_above_the_band_is_a_residual_term():
    above = System(np.array([30.0, 130.0]), np.full(2, 0.02), np.array([70.0, 1e6]), np.full(2, 0.02))
    fit = fit_resonances([replace(noisy(above, noise=0.001), coherence=None)])
    assert fit.resonances.omega_p[fit.modes] / (2 * np.pi) == pytest.approx([30], rel=1e-3)
    assert fit.resonances.omega_p[~fit.modes] / (2 * np.pi) == pytest.approx([130], rel=1e-2)
    assert not fit.poor


@pytest.mark.parametrize("first", [0, 60, -1])
def test_one_wild_line_is_left_out_and_named(first):
    # A double integrator with a resonance, whose first line is 30 times too large and has the wrong sign.
    f = np.arange(4.0, 400.0, 4.0)
    values = -90 / (f**2 * (1 + 0.024j * f / 55 - (f / 55) ** 2))
    rough = 1e-4 * np.random.default_rng(1).standard_normal((2, f.size))
    values = values * (1 + rough[0] + 1j * rough[1])
    values[first] *= -30
    fit = fit_resonances([MeasuredResponse("y/u", f, values)])
    assert fit.left_out(0).tolist() == [first % f.size]
    assert f"at {f[first]:g} Hz" in fit.warnings[0]
    assert fit.resonances.omega_p / (2 * np.pi) == pytest.approx([55], rel=1e-4)
    assert not fit.poor


def test_a_resonance_narrower_than_the_distance_of_lines_is_no_wild_line():
    f = np.arange(5.0, 60.0, 0.5)
    values = 1 / (1 + 2e-4j * f / 20 - (f / 20.01) ** 2) + 0.5 / (1 + 0.02j * f / 40 - (f / 40) ** 2)
    fit = fit_resonances([MeasuredResponse("y/u", f, values)])
    assert fit.resonances.omega_p[0] / (2 * np.pi) == pytest.approx(20.01, rel=1e-6)
    assert not fit.left_out(0).size


def test_a_resonance_that_is_no_larger_than_an_instrument_errs_is_said():
    # A divider of 0.68 with 0.05 dB more at 50 Hz, on lines that are wider apart than that peak.
    f = np.geomspace(10, 1000, 60)
    peak = 0.006 * 1j * f / 50 * 0.04 / (1 + 0.04j * f / 50 - (f / 50) ** 2)
    rough = 1e-5 * np.random.default_rng(1).standard_normal((2, f.size))
    fit = fit_resonances([MeasuredResponse("y/u", f, 0.68 * (1 + peak + rough[0] + 1j * rough[1]))])
    assert fit.resonances.omega_p[fit.modes] / (2 * np.pi) == pytest.approx([50], rel=0.01)
    assert any("dB at most, as an instrument's error may" in warning for warning in fit.warnings)
    assert any("is narrower than the distance of lines" in warning for warning in fit.warnings)


def test_exact_data_are_not_poor():
    fit = fit_resonances([exact(PAPER)])
    assert fit.resonances.omega_p / (2 * np.pi) == pytest.approx(PAPER.f_p, rel=1e-9)
    assert not fit.poor


@pytest.mark.parametrize(
    ("values", "poles", "zero"),
    [
        (lambda s: 20 / (1 + 0.05 * s), [20.0], np.inf),  # a motor's first-order lag
        (lambda s: 20 / ((1 + 0.05 * s) * (1 + 0.001 * s)), [20.0, 1000.0], np.inf),
        (lambda s: 4 / (s * (1 + 0.02 * s)), [50.0], np.inf),
        (lambda s: 3.3 + 0.02 * s, [], 165.0),  # an inductor
    ],
)
def test_plants_without_resonances_are_fitted_with_real_poles(values, poles, zero):
    f = np.geomspace(0.1, 1000, 120)
    rough = 0.01 * np.random.default_rng(2).standard_normal((2, f.size))
    data = MeasuredResponse("y/u", f, values(2j * np.pi * f) * (1 + rough[0] + 1j * rough[1]))
    fit = fit_resonances([data])
    assert not fit.poor
    assert not fit.modes.any()
    found = fit.real_poles()
    assert len(found) == len(poles)
    for (pole, error), true in zip(found, poles, strict=True):
        assert abs(pole - true) < 4 * error
    assert fit.resonances.real_z[0] == pytest.approx(zero, rel=0.02)


def test_a_fit_whose_time_is_over_returns_the_best_so_far():
    ticks = iter(range(10**9))
    with Budget(seconds=600, clock=lambda: float(next(ticks))).entered():
        fit = fit_resonances([replace(noisy(PAPER), coherence=None)])
    assert "time" in fit.poor[0]


def test_a_base_with_a_zero_in_the_band_is_an_error():
    with pytest.raises(FitError) as caught:
        fit_resonances([exact(ONE)], [Base(lambda omega: omega - omega[3] + 0j)], FitOptions(modes=1))
    assert code_of(caught) == ["SF615"]


def test_too_few_lines_are_an_error():
    with pytest.raises(DataError) as caught:
        fit_resonances([exact(ONE).between(10, 13)], UNIT, FitOptions(modes=3))
    assert code_of(caught) == ["SF605"]


def test_an_unknown_start_is_a_usage_error():
    with pytest.raises(UsageError, match="vector"):
        fit_resonances([exact(ONE)], UNIT, FitOptions(start="vectro"))


def test_data_without_the_unit_of_their_base_or_in_another_one_are_warned_of():
    base, exact_ones = Base(np.ones_like, "X/F", "base.toml", "m/N"), exact(ONE)
    for unit, said in (
        ("", "have no unit, and are taken in"),
        ("m/(N*s)", "are in m/(N*s), and the base in"),
    ):
        fit = fit_resonances([replace(exact_ones, unit=unit)], [base], FitOptions(modes=1, is_gain_free=True))
        assert any(said in warning for warning in fit.warnings), unit
    fit = fit_resonances([replace(exact_ones, unit="m/N")], [base], FitOptions(modes=1, is_gain_free=True))
    assert not any("unit" in warning or "the base in" in warning for warning in fit.warnings)
    assert fit.gain_unit(0) == "1"
