"""Heat: resistances in K/W and capacities in J/K between nodes whose temperature is an effort."""

import pytest

import symflex
from symflex.errors import SpecError

HOUSE = """symflex = 1
parameters = { R_in = "0.001 K/W", R_out = "0.05415 K/W", C_air = "1598 kJ/K", C_wall = "3.46 MJ/K" }
[elements]
ri = { type = "thermal_resistance", between = ["air", "wall"], R = "R_in" }
ro = { type = "thermal_resistance", between = ["wall", "outside"], R = "R_out" }
ca = { type = "thermal_capacity", at = "air", C = "C_air" }
cw = { type = "thermal_capacity", between = ["wall", "ground"], C = "C_wall" }
[inputs]
P = { heat = "air" }
T_out = { temperature = "outside" }
[outputs]
T_air = "air"
loss = "ro.phi"
"""
S = 1e-4 + 3e-4j
R_IN, R_OUT, C_AIR, C_WALL = 0.001, 0.05415, 1598e3, 3.46e6


def test_a_house_of_two_resistances_and_two_capacities():
    # A ladder, from its outer end: outside the wall R_out to the imposed temperature, C_wall, R_in, C_air.
    wall = 1 / (C_WALL * S + 1 / R_OUT)
    air = 1 / (C_AIR * S + 1 / (R_IN + wall))
    share = wall / (wall + R_IN) * air / R_OUT  # of the heat P that leaves through the wall
    model = symflex.loads(HOUSE)
    values = [model.transfer_function(o, i).bind()(S) for o in ("T_air", "loss") for i in ("P", "T_out")]
    # By reciprocity, the temperature outside moves the air as much as the heat P leaves.
    assert values[:3] == pytest.approx([air, share, share], rel=1e-12)
    inside = 1 / (C_WALL * S + 1 / (R_IN + 1 / (C_AIR * S)))
    assert values[3] == pytest.approx((inside / (inside + R_OUT) - 1) / R_OUT, rel=1e-12)
    assert [model.transfer_function("T_air", i).unit for i in ("P", "T_out")] == ["K/W", "1"]


def test_sources_of_heat_and_temperature_drive_like_the_inputs():
    sources = """heater = { type = "heat_source", at = "air", phi = "P" }
    weather = { type = "temperature_source", at = "outside", T = "T_out" }
    """
    free = HOUSE.replace('heat = "air"', 'unit = "W"').replace('temperature = "outside"', 'unit = "K"')
    models = [symflex.loads(text) for text in (HOUSE, free.replace("[inputs]", sources + "[inputs]"))]
    for pair in (("T_air", "P"), ("loss", "T_out")):
        one, other = (m.transfer_function(*pair).bind()(S) for m in models)
        assert one == pytest.approx(other, rel=1e-12)


def test_poles_of_heat_are_real_and_proved():
    found = symflex.loads(HOUSE).transfer_function("T_air", "P").bind().poles()
    # Of C_air C_wall R_in R_out s^2 + (C_air (R_in + R_out) + C_wall R_out) s + 1.
    a, b = C_AIR * C_WALL * R_IN * R_OUT, C_AIR * (R_IN + R_OUT) + C_WALL * R_OUT
    root = (b * b - 4 * a) ** 0.5
    assert sorted(complex(p).real for p in found) == pytest.approx([-(b + root) / 2 / a, -(b - root) / 2 / a])


def hints(text):
    with pytest.raises(SpecError) as caught:
        symflex.loads(text)
    return " | ".join(d.hint or "" for d in caught.value.diagnostics)


def test_a_part_of_the_wrong_domain_is_told_what_it_is_called():
    circuit = HOUSE.replace("thermal_resistance", "resistor").replace("thermal_capacity", "capacitor")
    circuit = circuit.replace('at = "air"', 'between = ["air", "ground"]')
    electric = circuit.replace("heat =", "current =").replace("temperature =", "voltage =")
    told = hints(electric.replace("ro.phi", "ro.i"))
    assert 'type = "thermal_resistance"' in told
    assert 'type = "thermal_capacity"' in told
    for wrong, hint in (
        (HOUSE.replace("heat =", "current ="), "write heat in place of current"),
        (HOUSE.replace("temperature =", "voltage ="), "write temperature in place of voltage"),
        (
            HOUSE.replace('"thermal_capacity", at', '"acoustic_compliance", at'),
            "write thermal_capacity in place",
        ),
        (HOUSE.replace('"thermal_resistance"', '"thermal_resistor"'), "thermal_resistance"),
        (HOUSE.replace('"thermal_capacity"', '"thermal_mass"'), "thermal_capacity"),
    ):
        assert hint in hints(wrong), hint


TURNING = """symflex = 1
inputs = { T = { torque = "p" } }
outputs = { P = "p" }
[elements]
a = { type = "inertia", at = "p", J = "1e-3 kg*m^2" }
bar = { type = "torsion_spring", between = ["p", "ground"], k = "350 N*m/rad" }
"""


@pytest.mark.parametrize(
    ("old", "new", "hint"),
    [
        ('"torsion_spring"', '"spring"', "if 'p' is an angle, write torsion_spring in place of spring"),
        ("torque =", "force =", "write torque in place of force"),
        ("torque =", "displacement =", "write angle in place of displacement"),
        (
            "bar = {",
            'd = { type = "damper", between = ["p", "ground"], b = 1 }\nbar = {',
            "write rotary_damper",
        ),
        ("bar = {", 'm = { type = "mass", at = "p", m = 1 }\nbar = {', "write inertia in place of mass"),
        (
            "bar = {",
            'f = { type = "force_source", at = "p", f = "T" }\nbar = {',
            "write torque_source in place",
        ),
        ('"1e-3 kg*m^2"', '"1e-3 kg"', 'type = "mass" takes it'),
        ('"350 N*m/rad"', '"350 N*m*s/rad"', 'type = "rotary_damper" takes it'),
        ('"350 N*m/rad"', '"350 N/m"', 'type = "spring" takes it'),
    ],
)
def test_a_part_that_moves_where_a_node_turns_is_told_what_it_is_called(old, new, hint):
    symflex.loads(TURNING)
    assert hint in hints(TURNING.replace(old, new))
