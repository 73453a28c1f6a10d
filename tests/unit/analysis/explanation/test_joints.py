"""Driving points where fields meet each other, or a node."""

import pytest

from symflex import pipeline
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
    found = pipeline.explain_zeros(model, bound, pipeline.roots(bound))
    return found.kind, found.status


@pytest.mark.parametrize("condition", CONTINUITY)
def test_a_jump_of_the_shear_is_colocated_with_both_fields_deflections_there(condition):
    text = SPANS.replace("DEFLECTION", condition)
    assert told(text, "Y_1/F") == told(text, "Y_2/F") == ("colocated", "proved")


@pytest.mark.parametrize("tf", ["V/F", "T_1/M", "T_2/M"])
def test_velocities_and_the_slope_under_a_moment_are_colocated_too(tf):
    assert told(SPANS.replace("DEFLECTION", CONTINUITY[0]), tf) == ("colocated", "proved")


@pytest.mark.parametrize("tf", ["Tip/F", "T_1/F", "Y_1/M"])
def test_what_the_force_does_no_work_on_is_not(tf):
    assert told(SPANS.replace("DEFLECTION", CONTINUITY[0]), tf)[0] == "noncolocated"


@pytest.mark.parametrize("tf", ["Y/F", "V/F"])
def test_a_field_that_ends_at_a_node_is_colocated_with_a_force_there(tf):
    assert told(NODE, tf) == ("colocated", "proved")


@pytest.mark.parametrize(
    ("text", "name", "expected"), [(SPANS, "Y_1", True), (SPANS, "Tip", False), (NODE, "Y", True)]
)
def test_the_table_of_models_says_the_same(text, name, expected):
    model = pipeline.loads(text.replace("DEFLECTION", CONTINUITY[0]))
    output = next(o for o in model.outputs if o.name == name)
    assert is_colocated(model, output, model.inputs[0]) is expected


@pytest.mark.parametrize("shown", ["w_1(0.5*l)", "w_2(0.5 m)", "s^2*(w_1(l/2) + w_2(l/2))/2"])
def test_one_point_is_the_same_however_it_is_written(shown):
    text = SPANS.replace("DEFLECTION", CONTINUITY[0]).replace('Y_1 = "w_1(l/2)"', f'Y_1 = "{shown}"')
    assert told(text, "Y_1/F") == ("colocated", "proved")


SHAFT = """
symflex = 1
parameters.l = "1 m"
elements.axle  = { type = "shaft", between = ["p", "q"], G = 2, J = 3, rho = 1, l = "l" }
elements.wheel = { type = "inertia", at = "q", J = 1 }
inputs.T = { torque = TORQUE }
outputs.Y = "SHOWN"
"""


@pytest.mark.parametrize(
    ("torque", "shown", "kind"),
    [
        ('"p"', "axle.theta(0)", "colocated"),
        ('"q"', "s*axle.theta(2*l - 1 m)", "colocated"),
        ('"p"', "axle.theta(l)", "noncolocated"),
        ('"q"', "axle.theta(l/2)", "noncolocated"),
        ('["p", "q"]', "axle.theta(l) - axle.theta(0)", "colocated"),
        ('["p", "q"]', "axle.theta(0)", "noncolocated"),
    ],
)
def test_the_end_of_an_element_is_its_node(torque, shown, kind):
    assert told(SHAFT.replace("TORQUE", torque).replace("SHOWN", shown), "Y/T") == (kind, "proved")


@pytest.mark.parametrize(
    ("load", "shown", "kind"),
    [
        ('force = "c"', "a.y(l)", "colocated"),
        ('force = "c"', "b.y(0)", "colocated"),
        ('torque = "c.theta"', "a.theta(l)", "colocated"),
        ('force = "c"', "a.theta(l)", "noncolocated"),
        ('torque = "c.theta"', "a.y(l)", "noncolocated"),
        ('force = "c"', "b.y(l)", "noncolocated"),
    ],
)
def test_a_deflection_is_colocated_with_a_force_and_a_slope_with_a_torque(load, shown, kind):
    beam = 'type = "beam", E = 1, I = 1, rho = 1, A = 1, l = "l"'
    text = f"""
symflex = 1
parameters.l = "1 m"
elements.a = {{ {beam}, between = ["ground", "c"] }}
elements.b = {{ {beam}, between = ["c", "e"] }}
inputs.F = {{ {load} }}
outputs.Y = "{shown}"
"""
    assert told(text, "Y/F") == (kind, "proved")
