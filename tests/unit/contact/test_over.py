"""Passive values of parameters, against bounds derived by hand."""

from itertools import count

import pytest

from symflex.budget import Budget
from symflex.contact.over import passive_over
from symflex.errors import UsageError
from symflex.options import PassivityOptions
from tests.unit.contact.machines import DELAYED, LAGGED, machine


def ends(values):
    return [(float(i.low.mid()), float(i.high.mid())) for i in values.passive]


def test_a_lagged_wall_is_passive_up_to_the_friction_over_the_lag():
    # Re Z = b - K tau/(1 + (omega tau)^2) with b = 1 N s/m and tau = 50 ms: K < 20 N/m.
    values = passive_over(machine(), PassivityOptions(("tip",), ("K",)))
    assert values.certified
    assert ends(values) == [(0.0, pytest.approx(20, rel=1e-15))]


def test_a_lead_makes_up_for_a_lag():
    # f = -(K + B s)/(tau s + 1) x: Re Z = b + (B - K tau)/(1 + (omega tau)^2): passive for B > K tau - b, and
    # stable there: B > 0.025.
    text = LAGGED.replace("-K/(tau*s + 1)*x", "-(K + B*s)/(tau*s + 1)*x")
    text = text.replace("[parameters]", '[parameters]\nB = { value = "1 N*s/m", assume = "nonnegative" }')
    values = passive_over(machine(text), PassivityOptions(("tip",), ("B",)))
    assert ends(values) == [(pytest.approx(0.025, rel=1e-12), 10.0)]


@pytest.mark.slow
def test_a_delayed_wall_is_passive_up_to_the_friction_over_the_delay():
    # Re Z = b - K sin(omega T)/omega is least at 0: K < b/T, and Z is a straight line in K.
    values = passive_over(machine(DELAYED), PassivityOptions(("tip",), ("K",), (0, 40)))
    assert values.certified
    (interval,) = values.passive
    assert interval.high.contains(20) or abs(float(interval.high.mid()) - 20) < 40 * 1e-4


@pytest.mark.slow
def test_a_delay_is_no_straight_line_and_values_are_said_to_be_tried():
    values = passive_over(machine(DELAYED, K="10 N/m"), PassivityOptions(("tip",), ("tau",), (0.01, 0.3)))
    assert not values.certified
    # K < b/T: T < 0.1 s.
    assert ends(values)[0][1] == pytest.approx(0.1, abs=1e-4)


@pytest.mark.slow
def test_two_parameters_make_slices():
    chart = passive_over(
        machine(), PassivityOptions(("tip",), ("K", "tau"), None, (("K", 0, 100), ("tau", 0.05, 0.25)))
    )
    for tau, values in chart.slices:
        assert ends(values)[0][1] == pytest.approx(min(1 / float(tau), 100), rel=1e-9)


def test_a_parameter_twice_is_refused():
    with pytest.raises(UsageError, match="each once"):
        passive_over(machine(), PassivityOptions(("tip",), ("K", "K")))


def test_slices_that_are_known_when_the_time_ends_are_kept():
    asked = PassivityOptions(("tip",), ("K", "tau"), None, (("K", 0, 100), ("tau", 0.05, 0.25)))
    with Budget(seconds=500, clock=count().__next__).entered():
        chart = passive_over(machine(), asked)
    assert not chart.certified
    assert "of 21 values of 'tau'" in chart.missing[0]
    for tau, values in chart.slices:
        assert ends(values)[0][1] == pytest.approx(min(1 / float(tau), 100), rel=1e-9)


NATURAL = """
symflex = 1
parameters = { G = 1, k_s = 1e5, m_1 = 60, m_2 = 20, k = "95 kN/m" }
inputs = { F = { force = "x_1" } }
outputs = { X = "x_2" }
[elements]
drive  = { type = "force_source", at = "x_1", f = "G*k_s*(x_t - x_2)" }
sensor = { type = "spring", between = ["x_2", "x_t"], k = "k_s" }
motor  = { type = "mass", at = "x_1", m = "m_1" }
load   = { type = "mass", at = "x_2", m = "m_2" }
spring = { type = "spring", between = ["x_1", "x_2"], k = "k" }
"""
ELASTIC = """
symflex = 1
parameters = { K_s = 150, K_v = 40, P = 3, I = 0.4, m = 1 }
inputs = { F = { force = "y" } }
outputs = { Y = "y" }
[signals]
x = "(P + I/s)*(K_s - K_v)*y/(s + (P + I/s)*K_s)"
[elements]
link   = { type = "mass", at = "y", m = "m" }
spring = { type = "force_source", at = "y", f = "-K_s*(y - x)" }
"""
DAMPED_ELASTIC = (
    ELASTIC.replace("-K_s*(y - x)", "-(K_s + c*s)*(y - x)")
    .replace("(K_s - K_v)*y/(s + (P + I/s)*K_s)", "(K_s + c*s - K_v)*y/(s + (P + I/s)*(K_s + c*s))")
    .replace("m = 1 }", "m = 1, c = 5 }")
)


def test_force_feedback_hides_no_more_than_the_mass_of_the_motor():
    # 1 + G <= (m_1 + m_2)/m_2, so that the mass felt, (m_1 + m_2)/(1 + G), is not below m_2: the zero of
    # v_2/F = (m_1 s^2 + k (1 + G))/(s (m_1 m_2 s^2 + (m_1 + m_2) k)) lies below its pole (Foster 1924).
    # Colgate and Hogan (1989) conclude that of force feedback: G = m_1/m_2 = 3 at most.
    values = passive_over(machine(NATURAL), PassivityOptions(("x_t",), ("G",), (0, 8)))
    assert values.certified
    assert ends(values) == [(0.0, pytest.approx(3, rel=1e-12))]


def test_a_series_elastic_actuator_shows_no_more_than_its_spring():
    # Vallery et al. (2008): K_v <= K_s. By hand Im(f/y) = P omega^3 (K_s - K_v) over a square.
    values = passive_over(machine(ELASTIC), PassivityOptions(("y",), ("K_v",), (0, 400)))
    assert values.certified
    assert ends(values) == [(0.0, pytest.approx(150, rel=1e-12))]


def test_a_damper_beside_the_spring_leaves_less_of_it_to_an_integrator():
    # By hand Re(f/(s y)) has the sign of (P c + 1) c omega^2 + P K_s^2 - K_v (P K_s + I c).
    values = passive_over(machine(DAMPED_ELASTIC), PassivityOptions(("y",), ("K_v",), (0, 400)))
    assert values.certified
    assert ends(values) == [(0.0, pytest.approx(3 * 150**2 / (3 * 150 + 0.4 * 5), rel=1e-12))]


DAMPED_PAIR = """symflex = 1
parameters = { g = 1, b_1 = "1 N*s/m" }
[elements]
one = { type = "damper", between = ["x", "ground"], b = "4 N*s/m" }
other = { type = "damper", between = ["y", "ground"], b = "6 N*s/m" }
link = { type = "damper", between = ["x", "y"], b = "1 N*s/m" }
more = { type = "force_source", at = "x", f = "g*s*y*b_1" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
"""


def test_two_ports_are_judged_together_at_values_that_are_tried():
    # Z = [[5, -1 - g], [-1, 7]] N s/m: its Hermitian part is not negative up to (2 + g)^2 = 4 * 35.
    asked = PassivityOptions(("x", "y"), ("g",), (0, 40))
    values = passive_over(machine(DAMPED_PAIR), asked)
    assert not values.certified
    assert values.port.name == "x and y"
    assert ends(values) == [(0.0, pytest.approx(2 * 35**0.5 - 2, abs=0.01))]
