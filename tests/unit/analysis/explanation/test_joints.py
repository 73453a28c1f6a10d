"""Driving points where fields meet each other, or a node."""

import pytest

from symflex import pipeline
from symflex.analysis.explanation import explain_zeros
from symflex.report.structure import is_colocated

SPANS = """
symflex = 1
parameters = { EI = "10 N*m^2", rhoA = "0.5 kg/m", l = "1 m" }

[fields.w_1]
domain     = ["0", "l/2"]
equation   = "EI*w_1'''' + rhoA*s^2*w_1 = 0"
conditions = ["w_1(0) = 0", "w_1'(0) = 0"]

[fields.w_2]
domain     = ["l/2", "l"]
equation   = "EI*w_2'''' + rhoA*s^2*w_2 = 0"
conditions = [
  "DEFLECTION",
  "w_2'(l/2) = w_1'(l/2)",
  "EI*(w_2''(l/2) - w_1''(l/2)) = M",
  "EI*(w_2'''(l/2) - w_1'''(l/2)) = F",
  "w_2''(l) = 0",
  "w_2'''(l) = 0",
]

[inputs]
F = { unit = "N" }
M = { unit = "N*m" }

[outputs]
Y_1 = "w_1(l/2)"
Y_2 = "w_2(l/2)"
V   = "s*w_1(l/2)"
T_1 = "w_1'(l/2)"
T_2 = "w_2'(l/2)"
Tip = "w_2(l)"
"""
CONTINUITY = (
    "w_2(l/2) = w_1(l/2)",
    "w_1(l/2) = w_2(l/2)",
    "w_1(l/2) - w_2(l/2) = 0",
    "0 = w_2(l/2) - w_1(l/2)",
    "EI*w_2(l/2) - EI*w_1(l/2) = 0",
    "w_2(0.5*l) = w_1(l/2)",
)
NODE = """
symflex = 1
parameters = { EI = "10 N*m^2", rhoA = "0.5 kg/m", l = "1 m", m = "0.2 kg" }
elements.tip   = { type = "mass", at = "x", m = "m" }
elements.shear = { type = "force_source", at = "x", f = "EI*w'''(l)" }
inputs.F  = { force = "x" }
outputs.Y = "w(l)"
outputs.V = "s*w(l)"
[fields.w]
domain     = ["0", "l"]
equation   = "EI*w'''' + rhoA*s^2*w = 0"
conditions = ["w(0) = 0", "w'(0) = 0", "w''(l) = 0", "w(l) = x"]
"""


def told(text, tf):
    model = pipeline.loads(text)
    (bound,) = pipeline.derive_bound(model, pipeline.pick_pairs(model, [tf]))
    found = explain_zeros(model, bound, pipeline.roots(bound))
    return found.kind, found.status


SPANNED = SPANS.replace("DEFLECTION", CONTINUITY[0])


def is_driven(text, name):
    """Return whether the table of models calls an output colocated with the first input."""
    model = pipeline.loads(text)
    output = next(o for o in model.outputs if o.name == name)
    return is_colocated(model, output, model.inputs[0])


@pytest.mark.slow
def test_a_jump_of_the_shear_is_colocated_with_both_fields_deflections_there():
    for condition in CONTINUITY:
        text = SPANS.replace("DEFLECTION", condition)
        assert is_driven(text, "Y_1") and is_driven(text, "Y_2"), condition
    assert told(text, "Y_1/F") == told(text, "Y_2/F") == ("colocated", "proved")


def test_velocities_and_the_slope_under_a_moment_are_colocated_too():
    for tf in ("V/F", "T_2/M"):
        assert told(SPANNED, tf) == ("colocated", "proved"), tf


@pytest.mark.slow
def test_what_the_force_does_no_work_on_is_not():
    for tf in ("Tip/F", "T_1/F", "Y_1/M"):
        assert told(SPANNED, tf)[0] == "noncolocated", tf
    assert is_driven(SPANNED, "Tip") is False


def test_a_field_that_ends_at_a_node_is_colocated_with_a_force_there():
    for tf in ("Y/F", "V/F"):
        assert told(NODE, tf) == ("colocated", "proved"), tf
    assert is_driven(NODE, "Y")


def test_one_point_is_the_same_however_it_is_written():
    for shown in ("w_1(0.5*l)", "w_2(0.5 m)", "s^2*(w_1(l/2) + w_2(l/2))/2"):
        text = SPANNED.replace('Y_1 = "w_1(l/2)"', f'Y_1 = "{shown}"')
        assert is_driven(text, "Y_1"), shown
    assert told(text, "Y_1/F") == ("colocated", "proved")


SHAFT = """
symflex = 1
parameters.l = "1 m"
elements.axle  = { type = "shaft", between = ["p", "q"], G = 2, J = 3, rho = 1, l = "l" }
elements.wheel = { type = "inertia", at = "q", J = 1 }
inputs.T = { torque = TORQUE }
outputs.Y = "SHOWN"
"""


@pytest.mark.slow
def test_the_end_of_an_element_is_its_node():
    for torque, shown, kind in [
        ('"p"', "axle.theta(0)", "colocated"),
        ('"q"', "s*axle.theta(2*l - 1 m)", "colocated"),
        ('"p"', "axle.theta(l)", "noncolocated"),
        ('"q"', "axle.theta(l/2)", "noncolocated"),
        ('["p", "q"]', "axle.theta(l) - axle.theta(0)", "colocated"),
        ('["p", "q"]', "axle.theta(0)", "noncolocated"),
    ]:
        assert told(SHAFT.replace("TORQUE", torque).replace("SHOWN", shown), "Y/T") == (kind, "proved"), (
            torque,
            shown,
            kind,
        )


@pytest.mark.slow
def test_a_deflection_is_colocated_with_a_force_and_a_slope_with_a_torque():
    beam = 'type = "beam", E = 1, I = 1, rho = 1, A = 1, l = "l"'
    text = f"""
symflex = 1
parameters.l = "1 m"
elements.a = {{ {beam}, between = ["ground", "c"] }}
elements.b = {{ {beam}, between = ["c", "e"] }}
"""
    for load, shown, kind in (
        ('force = "c"', "a.y(l)", "colocated"),
        ('force = "c"', "b.y(0)", "colocated"),
        ('torque = "c.theta"', "a.theta(l)", "colocated"),
        ('force = "c"', "a.theta(l)", "noncolocated"),
        ('torque = "c.theta"', "a.y(l)", "noncolocated"),
        ('force = "c"', "b.y(l)", "noncolocated"),
    ):
        found = told(f'{text}inputs.F = {{ {load} }}\noutputs.Y = "{shown}"\n', "Y/F")
        assert found == (kind, "proved"), (load, shown)
