"""Transfer functions in lowest terms, what cancelled, and their exact values with numbers."""

import math
from decimal import Decimal
from fractions import Fraction

import mpmath
import numpy as np
import pytest

from symflex import pipeline
from symflex.errors import ModelError

HEADER = "symflex = 1\n[parameters]\n"
SYMMETRIC = (
    HEADER
    + """m = "2 kg"
k = "3 N/m"
c = "5 N/m"
[elements]
M_1 = { type = "mass", at = "x", m = "m" }
M_2 = { type = "mass", at = "y", m = "m" }
K_1 = { type = "spring", between = ["x", "ground"], k = "k" }
K_2 = { type = "spring", between = ["y", "ground"], k = "k" }
C = { type = "spring", between = ["x", "y"], k = "c" }
[inputs]
F = { force = "x" }
[signals]
both = "F_0"
[elements.P_1]
type = "force_source"
at = "x"
f = "both"
[elements.P_2]
type = "force_source"
at = "y"
f = "both"
[inputs.F_0]
[outputs]
X = "x"
SUM = "x + y"
DIFF = "x - y"
"""
)


def derive(text, output, source):
    return pipeline.derive(pipeline.assemble(pipeline.loads(text)), output, source)


def hidden(tf):
    return sorted((str(h.polynomial), h.multiplicity) for h in tf.hidden)


def as_text(ratio):
    return f"({ratio.numerator().expand()})/({ratio.denominator().expand()})"


# ------------------------------------------------------------------------------------ what is cancelled


def test_a_symmetric_structure_pushed_symmetrically_hides_the_antisymmetric_mode():
    # m s^2 x = F - k x in unison; out of phase m s^2 + k + 2 c.
    tf = derive(SYMMETRIC, "X", "F_0")
    assert as_text(tf.ratio) == "(1)/(s^2*m + k)"
    assert hidden(tf) == [("s^2*m + k + 2*c", 1)]


def test_the_sum_of_both_motions_does_not_observe_the_antisymmetric_mode():
    tf = derive(SYMMETRIC, "SUM", "F")
    assert as_text(tf.ratio) == "(1)/(s^2*m + k)"
    assert hidden(tf) == [("s^2*m + k + 2*c", 1)]


def test_the_difference_under_symmetric_push_is_zero():
    assert derive(SYMMETRIC, "DIFF", "F_0").ratio.is_zero


def test_one_mass_driven_alone_hides_nothing():
    tf = derive(SYMMETRIC, "X", "F")
    assert (tf.order, hidden(tf)) == ((2, 4), [])


def test_a_disconnected_subsystem_is_hidden_as_a_whole():
    text = SYMMETRIC.replace('C = { type = "spring", between = ["x", "y"], k = "c" }\n', "")
    tf = derive(text, "X", "F")
    assert (as_text(tf.ratio), hidden(tf)) == ("(1)/(s^2*m + k)", [("s^2*m + k", 1)])


def test_what_cancelled_in_a_block_of_another_model_is_a_mode_of_the_outer_one(tmp_path):
    text = 'symflex = 1\nblocks.P = {{ {} }}\nsignals.y = "P*u"\ninputs.u = {{}}\noutputs.Y = "y"\n'
    (tmp_path / "inner.toml").write_text(text.format('type = "tf", num = "s - 1", den = "(s - 1)*(s + 2)"'))
    (tmp_path / "outer.toml").write_text(text.format('type = "model", spec = "inner.toml", tf = "Y/u"'))
    (tf,) = pipeline.derive_all(pipeline.load(tmp_path / "outer.toml"))
    assert (as_text(tf.ratio), hidden(tf)) == ("(1)/(s + 2)", [("s - 1", 1)])


def test_the_values_of_hidden_parameters_are_needed_to_bind_too():
    text = SYMMETRIC.replace('C = { type = "spring", between = ["x", "y"], k = "c" }\n', "")
    text = text.replace('K_2 = { type = "spring", between = ["y", "ground"], k = "k" }', "").replace(
        'M_2 = { type = "mass", at = "y", m = "m" }',
        'M_2 = { type = "mass", at = "y", m = "3*sqrt(c*m)*m/c" }\n'
        'K_2 = { type = "spring", between = ["y", "ground"], k = "sqrt(c)*c" }',
    )
    tf = derive(text.replace('m = "2 kg"', "m = 2").replace("5 N/m", "5").replace("3 N/m", "3"), "X", "F")
    bound = pipeline.bind(tf)
    assert [p.name for p in tf.hidden_parameters] == ["m", "c"]
    assert len(bound.hidden) == 1
    assert bound(0j) == pytest.approx(1 / 3)


CONTROLLER = (
    HEADER
    + """J = "2 kg*m^2"
b = "6 N*m*s/rad"
k = "1 N*m*s/rad"
[elements]
rotor = { type = "inertia", at = "z", J = "J" }
loss = { type = "rotary_damper", between = ["z", "ground"], b = "b" }
drive = { type = "torque_source", at = "z", tau = "CONTROL" }
[inputs]
r = { unit = "rad/s" }
[outputs]
W = "s*z"
"""
)


def test_a_controller_s_zero_that_cancels_a_plant_s_pole_is_hidden():
    tf = derive(CONTROLLER.replace("CONTROL", "k*(J*s + b)/s*r/b").replace("rad/s", "rad/s^2"), "W", "r")
    assert tf.order == (0, 1)
    # W = s*z of a rotor whose angle is an integral: that s cancels too.
    assert ("s*J + b", 1) in hidden(tf)


def test_a_controller_s_zero_near_a_plant_s_pole_hides_nothing_of_it():
    tf = derive(CONTROLLER.replace("CONTROL", "k*(J*s + 2*b)/s*r/b").replace("rad/s", "rad/s^2"), "W", "r")
    assert not any("J" in text for text, _ in hidden(tf))


def test_a_cancellation_by_value_is_reported_when_the_values_are_bound():
    # With J = 2, b = 6 and k = 1 the pole -b/J is -3, and so is the controller's zero -6 k/J.
    tf = derive(CONTROLLER.replace("CONTROL", "k*(s + 3*k/J*2)/s*r"), "W", "r")
    assert [str(h.polynomial) for h in pipeline.bind(tf).hidden if str(h.polynomial) != "s"] == ["s + 3"]
    assert not any(str(h.polynomial) != "s" for h in pipeline.bind(tf, {"k": 2}).hidden)


def test_a_value_of_zero_that_cancels_a_power_of_s_reports_it():
    # s*x of a free mass: s/(m s^2), where one s cancels only when k is zero.
    assert [str(h.polynomial) for h in bound("V", k=0).hidden] == ["s"]


FILTERED = (
    HEADER
    + """m = "1 kg"
k = "2 N/m"
b = "3 N*s/m"
T = "1 s"
[elements]
M = { type = "mass", at = "x", m = "m" }
K = { type = "spring", between = ["x", "ground"], k = "k" }
B = { type = "damper", between = ["x", "ground"], b = "b" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
Y = "x/(1 + T*s)"
Z = "(k + b*s + m*s^2)*x/(1 + T*s)"
S = "x/(k + b/T)"
"""
)


def test_the_filter_of_one_output_is_no_mode_of_another():
    assert hidden(derive(FILTERED, "X", "F")) == []


def test_a_filtered_output_has_the_filter_s_pole():
    tf = derive(FILTERED, "Y", "F")
    m, b, k, T, s = (tf.ratio.ring.generator(name) for name in ("m", "b", "k", "T", "s"))
    assert as_text(tf.ratio) == f"(1)/({(m * s**2 + b * s + k) * (T * s + 1)})"
    assert hidden(tf) == []


def test_an_output_that_inverts_the_plant_hides_the_plant_s_modes():
    tf = derive(FILTERED, "Z", "F")
    assert (tf.order, hidden(tf)) == ((0, 1), [("s^2*m + s*b + k", 1)])


def test_an_output_may_be_divided_by_a_sum_of_parameters():
    assert pipeline.bind(derive(FILTERED, "S", "F"))(0j) == pytest.approx(1 / 2 / 5, rel=1e-15)


# -------------------------------------------------------------------------------------------- binding

OSCILLATOR = (
    HEADER
    + """m = "2 kg"
k = "8 N/m"
b = { value = "0 N*s/m", assume = "nonnegative" }
q = "4 1/m"
[elements]
M = { type = "mass", at = "x", m = "m" }
K = { type = "spring", between = ["x", "ground"], k = "k" }
B = { type = "damper", between = ["x", "ground"], b = "b" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
V = "s*x"
I = "x/s"
R = "sqrt(q)*x"
"""
)


def bound(output="X", **values):
    return pipeline.bind(derive(OSCILLATOR, output, "F"), values)


def test_a_value_given_is_taken_exactly():
    for given, exact in [
        (3, Fraction(3)), (0.1, Fraction(1, 10)), (np.float64(0.1), Fraction(1, 10)),
        (np.float32(0.5), Fraction(1, 2)), (np.int64(7), Fraction(7)), (np.array([0.25]), Fraction(1, 4)),
        (1e-30, Fraction(1, 10**30)), (Fraction(1, 3), Fraction(1, 3)), (Decimal("0.7"), Fraction(7, 10)),
        ("0.7 N/mm", Fraction(700)), ("12", Fraction(12)),
    ]:  # fmt: skip
        assert dict(bound(k=given).values)["k"].rational == exact, given


def test_a_parameter_that_does_not_occur_needs_no_value():
    text = OSCILLATOR.replace('q = "4 1/m"', "q = {}")
    assert pipeline.bind(derive(text, "X", "F"))(0j) == 0.125


def test_a_function_of_a_parameter_that_does_not_occur_is_not_evaluated():
    text = OSCILLATOR.replace('q = "4 1/m"', 'q = { value = "-4 1/m", assume = "real" }')
    assert pipeline.bind(derive(text, "X", "F"))(0j) == 0.125
    with pytest.raises(ModelError) as caught:
        pipeline.bind(derive(text, "R", "F"))(0j)
    assert caught.value.diagnostics[0].code == "SF228"


def test_a_value_of_zero_lowers_the_order():
    assert bound(m=0, b=1).ratio.denominator().expand().degrees()[0] == 1


# ----------------------------------------------------------------------------------------- evaluation


def test_a_value_is_right_to_the_last_bits_also_close_to_a_pole():
    close = [2j * (1 + 1e-15), 2j + 1e-17, -3e-8 + 2j]
    for s in [0j, 1.7j, *close, 1e-200 + 1e-180j, 1e150 + 1e150j, 5e-324j, 1.3e154j]:
        with mpmath.workdps(400):
            at = mpmath.mpc(s.real, s.imag)
            expected = complex(1 / (2 * at * at + 8))
        found = bound()(s)
        assert abs(found - expected) <= 4e-16 * abs(expected), s


def test_a_value_at_a_pole_is_infinite_at_a_zero_zero_far_out_tiny_and_at_no_number_none():
    function = bound()
    assert math.isinf(function(2j).real)
    assert bound("V")(0j) == 0
    for s in [1e308 + 1.7e308j, 1.7e308 + 0j, -1e308j]:
        assert abs(function(s)) == 0, s
    for s in [complex(math.inf, 0), complex(0, math.nan)]:
        assert math.isnan(function(s).real), s


def test_pi_and_square_roots_are_enclosed_not_rounded():
    text = f"""{HEADER}a = 2
[inputs]
U = {{}}
[outputs]
Y = "(pi - sqrt(a)*2221441469079183/1000000000000000)*U"
"""
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    with mpmath.workdps(60):
        expected = mpmath.pi - mpmath.sqrt(2) * mpmath.mpf(2221441469079183) / 10**15
    assert pipeline.bind(tf)(0j).real == pytest.approx(float(expected), rel=1e-15)


def test_the_parameters_of_a_function_stand_in_declared_order_and_only_when_they_occur():
    assert [p.name for p in derive(OSCILLATOR, "R", "F").parameters] == ["m", "k", "b", "q"]
    assert [p.name for p in derive(OSCILLATOR, "X", "F").parameters] == ["m", "k", "b"]


def test_values_that_are_equal_mean_what_a_model_with_these_numbers_means():
    # A gain that is zero connects nothing, and a subsystem that two terms share is one.
    text = """symflex = 1
parameters = {{ a = {a}, b = {b} }}
inputs.u = {{}}
outputs.y = "{output}"
"""
    for output, hidden, is_zero in (
        ("(a - b)/(s^2 + 2*s + 4)*u", [], True),
        ("(a - b)/(s - 1)*u + u/(s + 2)", [], False),
        ("(s - a)/(s - b)*u/(s + 3)", [2], False),
        ("u/(s - a) - u/(s - b)", [2], True),
        ("(s - a)/((s + 4)*(s - b))*u + (s - b)/((s + 5)*(s - a))*u", [2], False),
    ):
        (tf,) = pipeline.derive_all(pipeline.loads(text.format(a=3, b=5, output=output)))
        bound = pipeline.bind(tf, {"a": 2, "b": 2})
        (fresh,) = pipeline.derive_all(pipeline.loads(text.format(a=2, b=2, output=output)))
        for function in (bound, pipeline.bind(fresh)):
            found = pipeline.roots(function)
            assert [h.root.re for h in found.hidden] == hidden, output
            assert found.verdict.word == ("unstable" if hidden else "stable"), output
            assert function.is_zero == is_zero, output


def test_a_function_that_vanishes_only_when_it_is_opened_hides_its_modes():
    # c = (1 + rho) a and b = rho a, so that c - b - a = 0; the damped wheel turns all the same.
    (tf,) = pipeline.derive_all(
        pipeline.loads("""symflex = 1
[parameters]
rho = 1.7
[elements]
wheel = { type = "inertia", at = "a", J = 2 }
oil = { type = "rotary_damper", between = ["a", "ground"], b = 3 }
up = { type = "transformer", from = "a", to = "c", ratio = "1 + rho" }
down = { type = "transformer", from = "a", to = "b", ratio = "rho" }
[inputs]
T = { torque = "a" }
[outputs]
Z = "c - b - a"
""")
    )
    assert tf.ratio.is_zero
    for each in (tf, pipeline.bind(tf)):
        assert sorted((str(h.polynomial), h.multiplicity) for h in each.hidden) == [("2*s + 3", 1), ("s", 1)]


@pytest.mark.parametrize(
    ("output", "per_torque", "per_force"),
    [
        ("phi", ("angular compliance", "rad/(N*m)"), ("angle per force", "rad/N")),
        ("s*(lead - phi)", ("angular mobility", "rad/(N*m*s)"), ("angular velocity per force", "rad/(N*s)")),
        ("phi*l", ("receptance", "1/N"), ("receptance", "m/N")),
        # A share of a length is no angle, alone or beside one.
        ("x/l", ("transfer function", "1/(N*m)"), ("transfer function", "1/N")),
        ("phi + x/l", ("transfer function", "1/(N*m)"), ("transfer function", "1/N")),
    ],
)
def test_an_angle_per_force_is_in_rad_and_no_receptance(output, per_torque, per_force):
    model = pipeline.loads(f"""symflex = 1
parameters = {{ J = "2 kg*m^2", k = "8 N*m/rad", l = "3 m", n = "5" }}
inputs = {{ tau = {{ torque = "phi" }}, F = {{ force = "x" }} }}
outputs.Y = "{output}"
signals.lead = "n*phi"
[elements]
disc = {{ type = "inertia", at = "phi", J = "J" }}
shaft = {{ type = "torsion_spring", between = ["phi", "ground"], k = "k" }}
wheel = {{ type = "transformer", from = "x", to = "phi", ratio = "1/l" }}
""")
    assert [(tf.quantity, tf.unit) for tf in pipeline.derive_all(model)] == [per_torque, per_force]
