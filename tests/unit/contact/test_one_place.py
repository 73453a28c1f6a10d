"""What a controller does at one place decides for the whole machine."""

import pytest

from symflex import pipeline
from symflex.contact.one_place import at_one_place
from symflex.contact.passivity import find_passivity
from tests.unit.contact.machines import ARM, machine

ROD = """symflex = 1
parameters = { g = "290 N*s/m", T = "0.3 ms" }
[elements]
bar = { type = "rod", between = ["left", "right"], EA = "10 MN", rhoA = "0.4 kg/m", l = "2 m" }
pad = { type = "damper", between = ["left", "ground"], b = "300 N*s/m" }
drive = { type = "force_source", at = "left", f = "-g*exp(-s*T)*s*left" }
[inputs]
F = { force = "right" }
[outputs]
x = "right"
"""
"""Without loss in the rod the poles and the real part at the far end have no last frequency."""
BEARING = 'bearing = { type = "rotary_damper", between = ["h.theta", "ground"], b = "0.81 N*m*s/rad" }'
LAGGED_HUB = (
    ARM.replace("(K + D*s)*exp(-s*T)*h.theta", "K/(1 + s*T)*h.theta")
    .replace('"EI*(1 + eta*s)"', '"EI", eta = "eta"')
    .replace("[definitions]", f"{BEARING}\n[definitions]")
)


def verdict(text, port=None, **values):
    model = pipeline.loads(text, settings={name: str(value) for name, value in values.items()})
    return find_passivity(model, port, is_explained=False)


def test_a_delayed_damper_at_the_far_end_of_a_rod_needs_a_larger_damper_beside_it():
    # Re(300 + g exp(-j omega T)) >= 300 - g at all frequencies.
    assert verdict(ROD, "right").passive is True


def test_a_lag_at_the_hub_is_made_up_for_by_a_bearing_of_its_stiffness_times_its_time():
    # Re(b + K/(s (1 + s T))) = b - K T/(1 + (omega T)^2), least at 0, with K T = 4 * 0.2 = 0.8.
    found = verdict(LAGGED_HUB)
    assert (found.passive, found.proof) == (
        True,
        "passive, as all that acts at h.theta is, and nothing else supplies energy",
    )
    part, place, _ = at_one_place(machine(LAGGED_HUB.replace("0.81", "0.79")))
    assert find_passivity(part, place).passive is False


def test_a_spring_of_a_negative_stiffness_is_judged_with_the_spring_beside_it():
    spring = '[elements]\nmore = {{ type = "spring", between = ["left", "ground"], k = "{}" }}'
    parameters = 'parameters = { k_n = { value = "-2 kN/m", assume = "real" },'
    both = spring.format("k_n") + spring.format("2.1 kN/m").replace("[elements]\nmore", "\nsoft")
    text = ROD.replace("[elements]", both).replace("parameters = {", parameters)
    assert verdict(text, "right").passive is True


@pytest.mark.parametrize("law", ["-g*s*right", "-g*s*(left - right)", "-bar.f/(1 + s*T)"])
def test_what_is_measured_elsewhere_is_not_at_one_place(law):
    assert at_one_place(pipeline.loads(ROD.replace("-g*exp(-s*T)*s*left", law))) is None


def test_a_part_of_a_planar_node_is_a_place():
    part, place, rest = at_one_place(pipeline.loads(ARM))
    assert place.name == "h.theta"
    assert [e.name for e in rest.elements][:2] == ["pin", "arm"]
    assert {e.name for e in part.elements} >= {"hub", "servo"}
