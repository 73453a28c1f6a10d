"""Units are inferred from use; cycles are read as the place asks for."""

import math
from fractions import Fraction

import pytest

from symflex import pipeline
from symflex.errors import SpecError
from symflex.model import ExactValue

HEADER = "symflex = 1\n[parameters]\n"
SIGNAL = '[inputs]\nU = {{}}\n[outputs]\nY = "{}"\n'


def resolve(text):
    return pipeline.loads(text)


def codes(text):
    with pytest.raises(SpecError) as caught:
        resolve(text)
    return [d.code for d in caught.value.diagnostics]


def value_of(text, name):
    return next(p.value for p in resolve(text).parameters if p.name == name)


def undamped_at(text, omega):
    """Tell whether a resonance with zeta = 0.1 and omega_z = 2 omega_p stands at an angular frequency."""
    (tf,) = pipeline.derive_all(resolve(text))
    value = pipeline.bind(tf)(1j * omega)
    # There the poles' part is 0.2j omega^2, and that of zeros (-1 + 0.4j + 4) omega^2, times (1/2)^2.
    return value == pytest.approx((3 + 0.4j) / 4 / 0.2j, rel=1e-12)


def with_output(declaration, expression):
    return f"{HEADER}f = {declaration}\n" + SIGNAL.format(expression)


# ------------------------------------------------------------------------------------------- cycles


def test_hertz_added_to_s_is_an_angular_frequency():
    (tf,) = pipeline.derive_all(resolve(with_output('"11 Hz"', "U/(s + f)")))
    assert pipeline.bind(tf)(0j).real == pytest.approx(1 / (22 * math.pi), rel=1e-15)


RESONANCE = 'R = { type = "resonance", omega_p = "f", zeta_p = 0.1, omega_z = "2*f", zeta_z = 0.1 }\n'


def test_a_frequency_or_a_speed_at_a_resonance_is_angular():
    for declared, omega in [("11 Hz", 22 * math.pi), ("60 rpm", 2 * math.pi)]:
        text = f'{HEADER}f = "{declared}"\n[blocks]\n{RESONANCE}' + SIGNAL.format("R*U")
        assert undamped_at(text, omega), declared


def test_hertz_times_two_pi_stays_in_cycles():
    assert value_of(with_output('"11 Hz"', "U/(s + 2*pi*f)"), "f") == ExactValue(Fraction(11), 0)


def test_hertz_inverted_to_a_time_stays_in_cycles():
    text = (
        f'{HEADER}f = "50 Hz"\n[blocks]\nL = {{ type = "lead_lag", T_1 = "1/f", T_2 = "2 s" }}\n'
        + SIGNAL.format("L*U")
    )
    assert value_of(text, "f") == ExactValue(Fraction(50), 0)


SCREW = (
    HEADER
    + """r = "5 mm/rev"
[elements]
screw = { type = "transformer", from = "shaft", to = "x", ratio = "r" }
rotor = { type = "inertia", at = "shaft", J = "1 kg*m^2" }
table = { type = "mass", at = "x", m = "1 kg" }
[inputs]
M = { torque = "shaft" }
[outputs]
X = "x"
"""
)


def test_a_pitch_per_revolution_is_metres_per_radian():
    # 5 mm per 2 pi rad = 1/(400 pi) m/rad.
    assert value_of(SCREW, "r") == ExactValue(Fraction(1, 400), -1)


def test_a_pitch_written_at_the_port_itself_is_metres_per_radian_too():
    (tf,) = pipeline.derive_all(resolve(SCREW.replace('ratio = "r"', 'ratio = "5 mm/rev"')))
    (by_name,) = pipeline.derive_all(resolve(SCREW))
    assert pipeline.bind(tf)(1 + 1j) == pipeline.bind(by_name)(1 + 1j)


MOTOR = f"""{HEADER}k = "50 V/krpm"
[elements]
motor = {{ type = "dc_motor", terminals = ["v", "ground"], shaft = "z", R = 1, CONSTANTS }}
rotor = {{ type = "inertia", at = "z", J = "1 kg*m^2" }}
[inputs]
V = {{ voltage = "v" }}
[outputs]
W = "s*z"
"""


def test_a_motor_s_constant_in_volts_per_thousand_revolutions_is_volt_seconds_per_radian():
    # 50 V per 1000/60 rev/s = 50*60/(1000*2*pi) = 3/(2 pi) V s/rad.
    for constants in ('k_t = 1, k_e = "k"', 'k_t = "k"'):
        text = MOTOR.replace("CONSTANTS", constants)
        assert value_of(text, "k") == ExactValue(Fraction(3, 2), -1), constants
    assert resolve(text).warnings == ()
    (tf,) = pipeline.derive_all(resolve(text))
    # k/(s + k^2) with k = 3/(2 pi) is 2 pi/3 at 0.
    assert pipeline.bind(tf)(0) == pytest.approx(2 * math.pi / 3)


def test_an_angular_frequency_in_radians_per_second_is_taken_as_it_is():
    assert value_of(with_output('"7 rad/s"', "U/(s + f)"), "f") == ExactValue(Fraction(7), 0)


def test_a_symbolic_angular_frequency_bound_in_hertz_is_angular():
    text = with_output('{ unit = "rad/s" }', "U/(s + f)")
    (tf,) = pipeline.derive_all(resolve(text))
    assert dict(pipeline.bind(tf, {"f": "11 Hz"}).values)["f"] == ExactValue(Fraction(22), 1)


# ------------------------------------------------------------------------------------ dimensions


def test_a_signal_s_unit_follows_from_what_it_is_made_of():
    text = f"""{HEADER}k = "2 V/m"
[elements]
M = {{ type = "mass", at = "x", m = "1 kg" }}
[signals]
e = "k*s*x"
[inputs]
F = {{ force = "x" }}
[outputs]
E = "e"
"""
    (output,) = resolve(text).outputs
    assert str(output.dimension) == "V/s"


DRIVEN = f"""{HEADER}g = "2 N/V"
[elements]
M = {{ type = "mass", at = "x", m = "1 kg" }}
D = {{ type = "force_source", at = "x", f = "g*FIRST" }}
E = {{ type = "force_source", at = "x", f = "SECOND" }}
[signals]
v = "w"
[inputs]
u = {{}}
w = {{}}
[outputs]
X = "x"
"""


def test_a_free_input_s_unit_follows_from_where_it_enters_and_is_one():
    model = resolve(DRIVEN.replace("FIRST", "(u - v)").replace("SECOND", "3*g*u"))
    assert [i.unit for i in model.inputs] == ["V", "V"]
    assert codes(DRIVEN.replace("FIRST", "u").replace("SECOND", "u")) == ["SF203"]


def test_terms_of_a_sum_must_agree():
    assert codes(f'{HEADER}m = "1 kg"\nk = "2 N/m"\n' + SIGNAL.format("(m + k)*U")) == ["SF205"]


@pytest.mark.parametrize(
    ("gain", "block", "fits"),
    [
        # The torque that a position in rad gives at a gain in N m.
        ("2 N*m", '"lag", T = "1 ms"', True),
        ("2 V", '"lag", T = "1 ms"', False),
        ("2 V", '"lag", k = 5, T = "1 ms"', True),
        ("2 V", '"lag", k = "3 N*m/V", T = "1 ms"', True),
        ("2 V", '"lead_lag", T_1 = "9 ms", T_2 = "1 ms"', False),
        ("2 V", '"low_pass", omega = "9 Hz", zeta = 1', False),
        ("2 V", '"notch", omega = "9 Hz", zeta_p = 1', False),
        ("2 N*m/s", '"integrator"', True),
        ("2 N*m", '"integrator", k = "3 1/s"', True),
        ("2 V", '"integrator", k = "3 1/s"', False),
        ("2 V", '"pid", k_p = "3 N*m/V", k_i = "2 N*m/(V*s)", k_d = "4 N*m*s/V"', True),
        ("2 N*m", '"pid", k_p = 3, k_i = "2 1/s"', True),
        ("2 N*m", '"pid", k_p = 3, k_i = "2 V/s"', False),
    ],
)
def test_a_block_has_the_unit_of_its_gain_and_a_bare_number_there_fits_any(gain, block, fits):
    text = f"""{HEADER}K = "{gain}"
        [elements]
        rotor = {{ type = "inertia", at = "phi", J = "1 kg*m^2" }}
        drive = {{ type = "torque_source", at = "phi", tau = "K*G*(r - phi)" }}
        [blocks]
        G = {{ type = {block} }}
        [inputs]
        r = {{ unit = "rad" }}
        [outputs]
        Phi = "phi"
        """
    if fits:
        resolve(text)
    else:
        assert codes(text) == ["SF203"]


def test_the_gains_of_a_controller_differ_by_seconds():
    block = 'K = "3 V/m"\n[blocks]\nG = { type = "pid", k_p = "K", k_i = "K" }\n'
    assert codes(HEADER + block + SIGNAL.format("G*U")) == ["SF205"]


def test_a_parameter_of_the_wrong_unit_is_refused_where_it_is_used():
    text = f'{HEADER}m = "1 N"\n[elements]\nM = {{ type = "mass", at = "x", m = "m" }}\n'
    text += '[inputs]\nF = { force = "x" }\n[outputs]\nX = "x"\n'
    with pytest.raises(SpecError) as caught:
        resolve(text)
    (problem,) = caught.value.diagnostics
    assert (problem.code, problem.span.line) == ("SF203", 5)


def test_a_bare_number_takes_the_unit_of_its_port():
    text = f'{HEADER}m = 3\n[elements]\nM = {{ type = "mass", at = "x", m = "m" }}\n'
    text += '[inputs]\nF = { force = "x" }\n[outputs]\nX = "x"\n'
    assert resolve(text).parameters[0].unit == "kg"


def test_a_unit_key_scales_the_value_beside_it():
    assert value_of(with_output('{ value = 3, unit = "mm" }', "f*U"), "f") == ExactValue(Fraction(3, 1000))


def test_a_unit_twice_is_refused():
    assert codes(with_output('{ value = "3 m", unit = "mm" }', "f*U")) == ["SF202"]


def test_a_quantity_may_stand_at_a_port():
    text = 'symflex = 1\n[elements]\nM = { type = "mass", at = "x", m = "150 g" }\n'
    text += '[inputs]\nF = { force = "x" }\n[outputs]\nX = "x"\n'
    (tf,) = pipeline.derive_all(resolve(text))
    assert pipeline.bind(tf)(1j).real == pytest.approx(-1 / 0.15, rel=1e-15)


def test_a_quantity_of_the_wrong_unit_at_a_port_is_refused():
    text = 'symflex = 1\n[elements]\nM = { type = "mass", at = "x", m = "150 N" }\n'
    assert "SF203" in codes(text + '[inputs]\nF = { force = "x" }\n[outputs]\nX = "x"\n')


def test_the_argument_of_a_sine_must_be_a_pure_number():
    for argument in ["f", "f^2"]:
        assert codes(with_output('"3 m"', f"sin({argument})*U")) == ["SF203"], argument


def test_the_root_of_a_quotient_has_half_the_exponents():
    text = f'{HEADER}m = "2 kg"\nk = "8 N/m"\n' + SIGNAL.format("U*sqrt(k/m)/(s + sqrt(k/m))")
    (tf,) = pipeline.derive_all(resolve(text))
    assert pipeline.bind(tf)(2 + 0j) == 0.5


def test_a_frequency_that_counts_cycles_is_in_hertz_wherever_its_2_pi_comes_from():
    for where in ["2*pi*f", "f"]:
        for declared in ['"30 Hz"', '"1800 rpm"', '{ unit = "Hz" }']:
            (parameter,) = resolve(with_output(declared, f"U/(s + {where})")).parameters
            assert parameter.unit == "Hz", (where, declared)


def test_where_nothing_has_a_unit_state_equations_of_numbers_may_mix_derivatives():
    text = """symflex = 1
[signals]
x_1 = "(-0.4*x_1 - x_2 + 2*u)/s"
x_2 = "x_1/s"
[inputs]
u = {}
[outputs]
y = "x_1 + 1.5*x_2"
"""
    bound = pipeline.derive_bound(resolve(text), [("y", "u")])[0]
    s = 0.3 + 1.7j
    assert bound(s) == pytest.approx((2 * s + 3) / (s**2 + 0.4 * s + 1), rel=1e-14)  # C (s I - A)^-1 B
    assert codes(text.replace("u = {}", 'u = { unit = "V" }'))[0] in ("SF203", "SF205")


def test_a_formula_among_the_parameters_is_a_definition():
    text = """symflex = 1
[parameters]
b = "2 cm"
h = { value = "1 cm" }
I = { value = "b*h^3/12", doc = "second moment of area", latex = "I_y" }
EI = "E*I"
E = "70 GPa"
[elements]
arm = { type = "massless_beam", between = ["root", "tip"], EI = "EI", l = "b" }
clamp = { type = "fixed", at = "root" }
[inputs]
F = { force = "tip" }
[outputs]
Y = "tip"
"""
    model = pipeline.loads(text)
    assert [p.name for p in model.parameters] == ["b", "h", "E"]
    assert [(d.name, d.latex) for d in model.definitions] == [("I", "I_y"), ("EI", "")]
    (bound,) = pipeline.derive_bound(model, [("Y", "F")])
    assert bound(1j) == pytest.approx(0.02**3 / (3 * 70e9 * 0.02 * 0.01**3 / 12), rel=1e-14)
    with pytest.raises(SpecError, match="SF202"):
        pipeline.loads(text.replace('b = "2 cm"', 'm = 1\nb = "2*m"'))  # two metres, or twice the mass
