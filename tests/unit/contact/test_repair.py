"""The smallest dampers that make a machine passive."""

from types import SimpleNamespace

import pytest
from flint import arb

from symflex.contact.passivity import find_passivity
from symflex.contact.repair import STORES, UNSTABLE, _of_domain, _value
from symflex.model import ContactPort, NodeReference
from tests.unit.contact.machines import DELAYED, LAGGED, machine


def test_a_damper_in_parallel_makes_up_for_the_lag():
    # Re Z is least at 0: b - K tau = 1 - 1.025.
    limit, put = find_passivity(machine(), "tip").repair.parallel
    assert float(limit.mid()) == pytest.approx(0.025, abs=1e-14)
    assert float(put.value) == pytest.approx(0.02501, abs=1e-9) or put.value >= limit.mid()


def test_a_damper_in_series_hides_the_least_real_part():
    # Y = (tau s^2 + s)/((s^2 + s)(tau s + 1) + K): its least real part on a fine grid.
    import numpy as np

    s = 1j * np.linspace(2.5, 2.7, 200001)
    least = ((0.05 * s**2 + s) / ((s**2 + s) * (0.05 * s + 1) + 20.5)).real.min()
    limit, put = find_passivity(machine(), "tip").repair.series
    assert float(limit.mid()) == pytest.approx(-1 / least, rel=1e-8)
    assert put.value <= float(limit.mid())


def test_a_damper_repairs_a_delayed_wall_by_what_the_delay_takes():
    # Re Z = b - K sin(omega tau)/omega is least at 0: 1 - 40*0.05.
    limit, put = find_passivity(machine(DELAYED, K="40 N/m"), "tip").repair.parallel
    assert float(limit.mid()) == pytest.approx(1, abs=1e-12)
    assert float(put.value) == pytest.approx(1, abs=2e-3)


def test_a_spring_makes_up_for_a_negative_one():
    # Z = m s + b + (k - K)/s with K = 20.5 N/m: passive for k >= K.
    text = LAGGED.replace("-K/(tau*s + 1)*x", "K*x")
    ((less, enough),) = find_passivity(machine(text), "tip").repair.storage
    assert (enough.type_name, less.value < 20.5 <= enough.value) == ("spring", True)
    assert float(enough.value) == pytest.approx(20.5, rel=1e-3)


def test_springs_and_masses_are_said_not_to_repair():
    assert "a spring or a mass alone leaves the sign of the real part as it is" in (
        find_passivity(machine(), "tip").repair.reasons
    )


def test_what_conducts_is_told_by_what_it_resists_where_its_value_is_that():
    damper, resistor = (SimpleNamespace(parameter=p, unit=u) for p, u in (("b", "N*s/m"), ("R", "Ohm")))
    assert _value(damper, arb(4), "at least", 6) == "b at least 4.00000 N*s/m"
    assert _value(resistor, arb(4), "at least", 6) == "R at most 0.250000 Ohm"
    assert _value(resistor, arb(4), "at most", 6) == "R at least 0.250000 Ohm"


def test_reasons_name_elements_of_the_domain():
    port = ContactPort("p", (NodeReference("p"),), "acoustic")
    words = _of_domain(STORES, port)
    assert words.startswith("an acoustic mass or an acoustic compliance alone")
    assert _of_domain(UNSTABLE, port).startswith("no acoustic resistance in series")
