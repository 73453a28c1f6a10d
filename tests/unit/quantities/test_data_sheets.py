"""Letters that data sheets mean differently from the SI, and suffixes of circuit simulators."""

import pytest

import symflex
from symflex.errors import SpecError, Text
from symflex.quantities import parse_unit, unit_doubt
from symflex.quantities.units import unit_slip


def loaded(declaration, expression="S*s^2*x"):
    return symflex.loads(f"""symflex = 1
    parameters = {{ m = "1 kg", k = "1 kN/m", S = {declaration} }}
    inputs = {{ F = {{ force = "x" }} }}
    outputs = {{ U = "{expression}" }}
    [elements]
    body = {{ type = "mass", at = "x", m = "m" }}
    wall = {{ type = "spring", between = ["x", "ground"], k = "k" }}
    """)


def test_an_accelerometer_per_gram_is_warned_of_and_one_per_gravity_is_right():
    for declaration in ('"100 mV/g"', '{ value = 100, unit = "mV/g" }'):
        (warning,) = loaded(declaration).warnings
        assert warning.code == "SF656"
        assert "g_n" in warning.hint
    model = loaded('"100 mV/g_n"')
    assert model.warnings == ()
    # S s^2/(m s^2 + k) tends to S/m, 0.1 V per 9.80665 m/s^2.
    assert abs(model.transfer_function("U", "F").bind()(1e7j)) == pytest.approx(0.0101972, rel=1e-5)


MEANT = """mV/g mV/g_n, V/(g) V/(g_n), pC/g pC/g_n, mA/g mA/g_n, deg/s/g deg/s/g_n, mV/kg mV/kgf,
mV/V/lb mV/V/lbf, oz*in/A ozf*in/A, kg*cm/A kgf*cm/A, lb*ft/rad lbf*ft/rad, lb*in/deg lbf*in/deg, 1/min
rpm, mV/min^-1 mV/rpm, PS W, Gs mT"""
RIGHT = """mV/g_n V*s^2/m mAh/g Ah/kg J/g J/(kg*K) L/min mol/min cm^3/min g*mm kg*m^2 kg*m kg*m^2/rad
kg/m g/m lb/ft oz g kg mg t min h rpm rev/min V/rpm V/krpm N*m/A ozf*in/A mS kS S GS pF Gohm mT T K K/W
J/K deg/s rad/s/V m/s^2 V/N mV/kgf N/kg m^3/kg kg/A g/mol 1/s Hz kgf kgf*cm psi mil s C C/mol A/m V/m
A/kHz mA/gf"""
# A unit, the one its place wants, and what the message suggests.
SLIPS = """lb/in N/m lbf/in, oz*in N*m ozf*in, kg*cm N*m kgf*cm, g m/s^2 g_n, V/g V*s^2/m V/g_n, g/mm
N/m gf/mm, lbf kg lb, S s s, 1/S 1/s 1/s, nm N*m N*m, T kg t, C K K, K Ohm kOhm, m H mH, m s -, kg s -,
N/m kg -"""
SUFFIXES = """1k kOhm, 100n nF, 4k7 kOhm, 2.2u uF, 1Meg MOhm, 3M MOhm, 10p pF, 5G 0.1_mT, 3Gauss gauss,
2Oe A/m, 9r/min rev, 5dps deg/s, 20PSI psi, 5Kgf kgf, 2RPM rpm, 3mho 'S', 20degC 'K', 2_deg_C/W 'K',
4_J/deg_F 'K', 1_\u00b0\u00b7C 'K', 7_W/(m*deg_K) 'K'"""


def test_a_speed_per_minute_is_warned_of_and_a_slow_rate_is_not():
    codes = [[w.code for w in loaded(value, "S*x").warnings] for value in ('"3000 1/min"', '"0.2 1/min"')]
    assert codes == [["SF656"], []]


def rows(table):
    return [row.split() for row in table.split(",")]


def test_a_unit_that_is_hardly_meant_is_warned_of_with_what_is():
    for unit, meant in rows(MEANT):
        assert unit_doubt(unit)[1].endswith(f"write '{meant}'"), unit
        parse_unit(Text.alone("a.toml", meant))


def test_units_that_are_plainly_right_are_not_warned_of():
    assert [unit for unit in RIGHT.split() if unit_doubt(unit)] == []


def test_a_unit_that_misses_its_place_by_a_letter_is_told():
    for unit, wanted, meant in rows(SLIPS):
        slip = unit_slip(unit, *(parse_unit(Text.alone("a.toml", u)).dimension for u in (unit, wanted)))
        assert slip is None if meant == "-" else slip.endswith(f"write '{meant}'"), unit


def test_a_suffix_or_an_unknown_letter_is_told_how_it_is_written():
    for written, hint in rows(SUFFIXES):
        with pytest.raises(SpecError) as caught:
            loaded(f'"{written.replace("_", " ")}"')
        assert hint.replace("_", " ") in caught.value.diagnostics[0].hint, written
