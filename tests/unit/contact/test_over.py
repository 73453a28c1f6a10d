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
