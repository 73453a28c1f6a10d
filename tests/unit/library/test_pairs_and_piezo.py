"""Sources between two nodes, the first-order lag, and the piezoelectric transducer."""

import pytest

import symflex
from symflex import pipeline
from symflex.errors import SpecError
from symflex.roots.passivity import energy_proof

S = 0.3 + 4j
TWO = """symflex = 1
[elements]
a = { type = "MASS", at = "x", VALUE = 2 }
b = { type = "MASS", at = "y", VALUE = 3 }
drive = { SOURCE }
[inputs]
u = {}
[outputs]
X = "x"
Y = "y"
Through = "drive.NAME"
"""
CIRCUIT = """symflex = 1
[elements]
a = { type = "resistor", between = ["x", "ground"], R = 2 }
b = { type = "resistor", between = ["y", "ground"], R = 3 }
drive = { SOURCE }
[inputs]
u = {}
[outputs]
X = "x"
Y = "y"
Through = "drive.i"
"""


def value(text, name):
    return complex(symflex.loads(text).transfer_function(*name.split("/")).bind()(S))


def two(source, kind="mass", value_name="m", through="f"):
    text = TWO.replace("SOURCE", source).replace("MASS", kind).replace("VALUE", value_name)
    return text.replace("NAME", through)


def test_a_source_between_two_nodes_reacts_on_the_second():
    for source, kind, value_name, through in [
        ('type = "force_source", between = ["x", "y"], f = "u"', "mass", "m", "f"),
        ('type = "torque_source", between = ["x", "y"], tau = "u"', "inertia", "J", "tau"),
    ]:
        text = two(source, kind, value_name, through)
        assert value(text, "X/u") == pytest.approx(1 / (2 * S**2)), source
        assert value(text, "Y/u") == pytest.approx(-1 / (3 * S**2)), source
        assert value(text, "Through/u") == pytest.approx(1), source


def test_a_current_between_two_nodes_leaves_the_second_and_a_voltage_is_the_first_over_the_second():
    # One current round both resistors: of a voltage 1/(2 + 3).
    for source, x, y, through in [("current_source", 2, -3, 1), ("voltage_source", 0.4, -0.6, 0.2)]:
        value_name = "i" if source.startswith("current") else "v"
        text = CIRCUIT.replace("SOURCE", f'type = "{source}", between = ["x", "y"], {value_name} = "u"')
        found = [value(text, f"{output}/u") for output in ("X", "Y", "Through")]
        assert found == pytest.approx([x, y, through]), source


def test_a_source_has_one_node_or_two():
    for source, message in [
        ('type = "force_source", at = "x", between = ["x", "y"], f = "u"', "takes at or between, not both"),
        ('type = "force_source", between = ["x"], f = "u"', "takes 2 nodes, found 1"),
        ('type = "force_source", between = ["x", "y", "z"], f = "u"', "takes 2 nodes, found 3"),
        ('type = "force_source", at = ["x", "y"], f = "u"', "takes 1 node, found 2"),
        ('type = "force_source", f = "u"', "lacks its port 'at'"),
    ]:
        with pytest.raises(SpecError, match=message) as caught:
            symflex.loads(two(source))
        assert "SF217" in {d.code for d in caught.value.diagnostics}, source


def test_a_source_between_a_node_and_itself_is_refused():
    with pytest.raises(SpecError) as caught:
        symflex.loads(two('type = "force_source", between = ["x", "x"], f = "u"'))
    assert caught.value.diagnostics[0].code == "SF218"


def test_a_lag_divides_by_one_plus_its_time():
    text = (
        'symflex = 1\n[parameters]\nT = "0.2 s"\n[blocks]\nP = { type = "lag", T = "T", k = 3 }\n'
        'Q = { type = "lag", T = "5 ms" }\n[inputs]\nu = {}\n[outputs]\ny = "P*Q*u"\n'
    )
    assert value(text, "y/u") == pytest.approx(3 / (1 + 0.2 * S) / (1 + 0.005 * S))


PIEZO = """symflex = 1
parameters = { alpha = "12 N/V", C = "3 F", k = "40 N/m", m = "2 kg", h = "4 V/m" }
outputs = { X = "x", V = "v", F = "stack.f", I = "stack.i", Sensed = "h*x" }
[elements]
load = { type = "mass", at = "x", m = "m" }
stack = { type = "piezo", terminals = ["v", "ground"], between = ["ground", "x"], alpha = "alpha", REST }
[inputs]
DRIVE
"""


def piezo(drive, rest='C = "C", k = "k"'):
    return PIEZO.replace("DRIVE", drive).replace("REST", rest)


VOLTAGE, CURRENT, FORCE = 'u = { voltage = "v" }', 'u = { current = "v" }', 'u = { force = "x" }'
MOBILE = 2 * S**2 + 40
"""m s^2 + k, the mechanical stiffness with the terminals short-circuited."""


def test_a_voltage_stretches_a_transducer_whose_admittance_is_that_of_the_textbook():
    # Preumont 2006, section 4.4: I = s [C + alpha^2/(m s^2 + k)] V.
    assert value(piezo(VOLTAGE), "X/u") == pytest.approx(12 / MOBILE)
    assert value(piezo(VOLTAGE), "I/u") == pytest.approx(S * (3 + 144 / MOBILE))
    assert symflex.loads(piezo(VOLTAGE)).transfer_function("Sensed", "u").unit == "1"


def test_a_transducer_with_open_terminals_is_stiffer_by_alpha_squared_over_c():
    G = symflex.loads(piezo(CURRENT))
    # Poles of x over a current: m s^2 + k + alpha^2/C.
    poles = [complex(p) for p in G.transfer_function("X", "u").bind().poles() if complex(p).imag > 0]
    assert poles[0].imag == pytest.approx(((40 + 144 / 3) / 2) ** 0.5)


def test_a_force_makes_the_open_circuit_voltage_alpha_over_c_per_extension():
    text = piezo(FORCE)
    assert value(text, "V/u") / value(text, "X/u") == pytest.approx(-12 / 3)


def test_a_transducer_turns_no_energy_into_heat():
    # Maxwell's relation of the enthalpy H(x, v): charge per force, shorted, is extension per voltage.
    shorted = piezo(FORCE).replace("[inputs]", 'wire = { type = "fixed", at = "v" }\n[inputs]')
    assert value(shorted, "I/u") / S == pytest.approx(value(piezo(VOLTAGE), "X/u"))


def test_a_transducer_supplies_no_energy_unless_its_stiffness_is_negative():
    # What alpha adds to the power v i + f s (x_a - x_b) cancels: C v^2/2 + k (x_a - x_b)^2/2 is stored.
    for alpha in ("alpha", "-alpha"):
        text = piezo(VOLTAGE).replace('alpha = "alpha"', f'alpha = "{alpha}"')
        assert energy_proof(pipeline.loads(text)).is_passive, alpha
    assert not energy_proof(pipeline.loads(piezo(VOLTAGE, 'C = "C", k = "k - 2*k"'))).is_passive


def test_a_transducer_needs_neither_capacitance_nor_stiffness():
    text = piezo(VOLTAGE, "k = 0")
    assert value(text, "X/u") == pytest.approx(12 / (2 * S**2))
    assert value(text, "I/u") == pytest.approx(S * 144 / (2 * S**2))


def test_the_coefficient_is_a_force_per_voltage():
    for alpha, code in [("12 V/N", "SF203"), ("12 A*s/m", None), ("12 C/m", None)]:
        text = piezo(VOLTAGE).replace("12 N/V", alpha)
        if code is None:
            assert value(text, "X/u") == pytest.approx(12 / MOBILE), alpha
            continue
        with pytest.raises(SpecError) as caught:
            symflex.loads(text)
        assert caught.value.diagnostics[0].code == code, alpha
