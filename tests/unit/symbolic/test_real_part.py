"""Symbolic conditions for a positive real part, against those derived by hand."""

from symflex import pipeline
from symflex.contact import at_port
from symflex.model.ports import port_named
from symflex.symbolic.real_part import real_part_conditions

WALL = """symflex = 1
parameters = { m = {}, b = {}, K = {}, tau = {}, B = {}, k = {} }
[elements]
body = { type = "mass", at = "x", m = "m" }
friction = { type = "damper", between = ["x", "ground"], b = "b" }
motor = { type = "force_source", at = "x", f = "FORCE" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
"""


def conditions(force):
    model = pipeline.loads(WALL.replace("FORCE", force))
    driven, pair = at_port(model, port_named(model, "x"))
    (tf,) = pipeline.derive_all(driven, [pair])
    found = real_part_conditions(tf)
    return found.sentence, [str(c) for c in found.conditions]


def test_friction_makes_up_for_a_lag():
    # Re Z = b - K tau/(1 + (omega tau)^2).
    assert conditions("-K/(tau*s + 1)*x") == (
        "the real part is positive at all frequencies exactly when",
        ["b > K*tau"],
    )


def test_a_filtered_lead_needs_less_friction():
    # Re Z = b + (B - K tau)/(1 + (omega tau)^2).
    assert conditions("-(K + B*s)/(tau*s + 1)*x")[1] == ["b + B > K*tau"]


def test_a_spring_and_a_damper_are_positive_for_all_values():
    assert conditions("-(K + B*s)*x") == ("the real part is positive at all frequencies", [])


def test_a_force_along_the_motion_needs_more_friction():
    assert conditions("B*s*x")[1] == ["b > B"]


def test_an_integral_of_position_is_never_positive_at_low_frequencies():
    # Re Z = b - K/omega^2.
    assert conditions("-K/s*x") == ("the real part is never positive at all frequencies", [])


def test_a_condition_on_a_middle_power_is_enough_and_not_needed():
    # (1 + omega^2 tau^2)^2 Re Z = b + B - 2 K tau + (2 b - B) omega^2 tau^2 + b omega^4 tau^4.
    assert conditions("-(K + B*s)/(tau*s + 1)^2*x") == (
        "the real part is positive at all frequencies if",
        ["2*b > B", "b + B > 2*K*tau"],
    )


def test_a_factor_that_comes_with_its_mirror_image_is_positive_with_it():
    # (1 + omega^2 tau^2) Re Z = b (k^2 + omega^2 tau^2), the size of k + j omega tau.
    assert conditions("-b*(k^2 - 1)/(tau*s + 1)*s*x") == ("the real part is positive at all frequencies", [])
