from math import pi

import pytest

from symflex import pipeline
from symflex.audit import audit

OSCILLATOR = """
symflex = 1
[parameters]
m = "1 kg"
k = "100 N/m"
b = "2 N*s/m"
{extra}
[elements]
body   = {{ type = "mass", at = "x", m = "m" }}
spring = {{ type = "spring", between = ["x", "ground"], k = "k" }}
damper = {{ type = "damper", between = ["x", "ground"], b = "b" }}
[inputs]
F = {{ force = "x" }}
[outputs]
X = "x"
[published."X/F"]
expr = "{expr}"
[analysis]
band = ["0.1 Hz", "100 Hz"]
"""


def audited(expr, extra=""):
    (found,) = audit(pipeline.loads(OSCILLATOR.format(expr=expr, extra=extra)))
    return found


@pytest.mark.slow
def test_a_factor_of_ten_is_twenty_decibels_everywhere():
    deviation = audited("10/(m*s^2 + b*s + k)").deviation
    assert deviation.magnitude_db == pytest.approx(20, abs=1e-9)
    assert deviation.phase_deg == pytest.approx(0, abs=1e-9)


def test_a_wrong_damping_shows_most_at_the_undamped_frequency():
    # There both are 1/(j b w): half the damping is twice the response.
    deviation = audited("1/(m*s^2 + b*s/2 + k)").deviation
    assert deviation.magnitude_db == pytest.approx(6.0206, abs=1e-3)
    assert deviation.magnitude_hz == pytest.approx(10 / (2 * pi), rel=1e-4)


@pytest.mark.slow
def test_a_zero_the_system_does_not_have_is_a_deviation_without_bound():
    deviation = audited("(s^2 + 400)/(400*(m*s^2 + b*s + k))").deviation
    assert deviation.unbounded
    assert deviation.magnitude_hz == pytest.approx(20 / (2 * pi), rel=1e-6)


@pytest.mark.slow
def test_the_values_at_a_point_are_those_of_both_formulas():
    comparison = audited("2/(m*s^2 + b*s + k)").comparison
    s = complex(*map(float, comparison.point))
    assert comparison.derived == pytest.approx(1 / (s**2 + 2 * s + 100), rel=1e-12)
    assert comparison.printed == pytest.approx(2 / (s**2 + 2 * s + 100), rel=1e-12)


def test_a_symbolic_parameter_is_given_a_value_to_tell_functions_apart_and_not_to_measure():
    found = audited("1/(m*s^2 + b*s + 2*k*g)", "g = {}")
    assert found.verdict == "differs"
    assert found.deviation is None


def test_an_equality_that_is_not_read_is_checked_at_forty_points_and_not_proved():
    found = audited("1/(m*s^2 + b*s + k*log(exp(1)))")
    assert (found.verdict, found.is_certified, found.comparison.agreed) == ("agrees", False, 40)


def test_a_difference_in_the_fortieth_digit_is_proved():
    found = audited("1/(m*s^2 + b*s + k*log(exp(1)) + 1e-38*k)")
    assert found.verdict == "differs"
    assert found.comparison.gap < 1e-37


def test_a_formula_in_definitions_of_its_own_is_read():
    assert audited("1/(m*((s + b/(2*m))^2 + k/m - (b/(2*m))^2))").verdict == "equal"


def test_without_losses_a_wrong_factor_is_measured_too_and_a_wrong_sign_is_half_a_turn():
    lossless = OSCILLATOR.replace('damper = {{ type = "damper", between = ["x", "ground"], b = "b" }}\n', "")

    def deviation(expr):
        (found,) = audit(pipeline.loads(lossless.format(expr=expr, extra="")))
        return found.deviation

    assert deviation("2/(m*s^2 + k)").magnitude_db == pytest.approx(6.0206, abs=1e-3)
    assert deviation("2/(m*s^2 + k)").phase_deg == 0
    assert abs(deviation("-1/(m*s^2 + k)").phase_deg) == pytest.approx(180)
