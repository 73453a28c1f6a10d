"""What is a network without losses and what is not, and where its powers of s stand."""

from __future__ import annotations

import pytest

from symflex.roots.networks.network import OtherNetworkError
from tests.unit.roots.networks.network_models import BEAM, network, specification

TWO = f"""
one = {{ {BEAM}, between = ["ground", "a"], l = "0.4 m" }}
two = {{ {BEAM}, between = ["a", "b"], l = "0.3 m" }}
"""


@pytest.mark.parametrize(
    ("elements", "reason"),
    [
        ('d = { type = "damper", between = ["a.y", "ground"], b = "1 N*s/m" }', "loses"),
        ('m = { type = "mass", at = "b.y", m = "-1 kg" }', "inertia is negative"),
        (f'e = {{ {BEAM}, between = ["b", "c"], l = "1 m", eta = "1 us" }}', r"loses|polynomial"),
    ],
)
def test_what_loses_energy_or_has_negative_inertia_is_refused(elements, reason):
    with pytest.raises(OtherNetworkError, match=reason):
        network(specification(TWO + elements))


def test_a_loop_is_refused():
    force = 'f = { type = "force_source", at = "b.y", f = "-k*a.y" }\n[parameters]\nk = "3 N/m"'
    with pytest.raises(OtherNetworkError, match="loop"):
        network(specification(TWO + force))


def test_springs_of_any_sign_masses_levers_and_links_are_taken():
    parts = """
    k = { type = "spring", between = ["a.y", "ground"], k = "-10 N/m" }
    m = { type = "mass", at = "b.y", m = "1 kg" }
    body = { type = "rigid_body", at = "b", m = "1 kg", J = "1 kg*m^2", cg = "0.3 m" }
    link = { type = "rigid_link", between = ["b", "c"], length = "0.1 m" }
    lever = { type = "transformer", from = "c.y", to = "d", ratio = "-2" }
    soft = { type = "massless_beam", between = ["c", "ground"], EI = "3 N*m^2", l = "0.2 m" }
    """
    found = network(specification(TWO + parts))
    assert found.is_colocated
    assert not found.passive


def test_a_mass_about_a_point_outside_it_is_proved_to_be_no_negative_inertia():
    body = 'body = { type = "rigid_body", at = "b", m = "1 kg", J = "0 kg*m^2", cg = "0.3 m" }'
    assert network(specification(TWO + body)).passive


@pytest.mark.parametrize(("output", "above"), [("a.y", 0), ("s*a.y", 1), ("3*s^2*a.y", 2)])
def test_a_rate_is_read_as_a_power_of_s(output, above):
    found = network(specification(TWO, outputs=f'X = "{output}"'))
    assert (found.below, found.above) == (0, above)
    assert found.is_colocated


def test_a_velocity_that_is_told_puts_a_power_of_s_below():
    found = network(specification(TWO, 'v = { velocity = "b" }', 'X = "b.y"'), source="v")
    assert found.below == 1


def test_a_sensor_elsewhere_is_not_colocated():
    assert not network(specification(TWO, outputs='X = "b"')).is_colocated


def test_a_signal_that_nothing_hears_is_put_in_its_place():
    text = specification(TWO, 'F = { force = "a" }\n[signals]\nv = "2*a.y"', 'X = "v"')
    assert network(text).is_colocated
