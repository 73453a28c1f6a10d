"""Nested transfer functions: values, binding, and what they are made of."""

import cmath
import math

import numpy as np
import pytest
from flint import acb, ctx
from hypothesis import given

from symflex import pipeline
from symflex.errors import ModelError, Source, Span, Text, UsageError
from symflex.expressions import (
    Call,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    format_expression,
    parse,
)
from symflex.print.forms.nested import nested_form
from symflex.print.json_format import derive_json
from symflex.roots.locate import as_quotient
from symflex.transfer import bind, bind_nested
from tests.property.networks import networks, to_toml
from tests.property.test_random_networks import POINTS, assert_close, pairs, quiet, reference

CHAIN = """
symflex = 1
parameters = { m_1 = "1 kg", m_2 = "2 kg", m_3 = "3 kg", k = "400 N/m", b = "5 N*s/m" }
inputs = { F = { force = "x_1" }, G = { force = "x_3" } }
outputs = { X_1 = "x_1", V_3 = "s*x_3", X_3 = "x_3" }
[elements]
first = { type = "mass", at = "x_1", m = "m_1" }
second = { type = "mass", at = "x_2", m = "m_2" }
third = { type = "mass", at = "x_3", m = "m_3" }
spring_1 = { type = "spring", between = ["x_1", "x_2"], k = "k" }
loss_1 = { type = "damper", between = ["x_1", "x_2"], b = "b" }
spring_2 = { type = "spring", between = ["x_2", "x_3"], k = "2*k" }
"""

DEFINITIONS = """
symflex = 1
parameters = { w_1 = "2 kg", Z_1 = "3 N*s/m", k = "50 N/m" }
definitions = { Y = "w_1*s + Z_1", root = "sqrt(k*w_1)" }
inputs = { F = { force = "x" } }
outputs = { X = "x", R = "root*x" }
[elements]
body = { type = "mass", at = "x", m = "w_1" }
loss = { type = "damper", between = ["x", "ground"], b = "Z_1" }
spring = { type = "spring", between = ["x", "y"], k = "k" }
other = { type = "mass", at = "y", m = "Y/s" }
"""


def nested(text):
    return {tf.name: tf for tf in pipeline.derive_nested(pipeline.loads(text))}


def dense(s, source):
    """Return the displacements of the chain from its matrix."""
    w, v = 400 + 5 * s, 800
    a = np.array([[s**2 + w, -w, 0], [-w, 2 * s**2 + w + v, -v], [0, -v, 3 * s**2 + v]])
    return np.linalg.solve(a, np.eye(3)[{"F": 0, "G": 2}[source]])


def test_the_values_are_those_of_the_matrix():
    functions = nested(CHAIN)
    points = np.array([0.3j, 12j, 40j, 2 - 3j, 1.5, 500j])
    for name in ["X_1/F", "V_3/F", "X_3/F", "X_1/G", "X_3/G"]:
        H = bind_nested(functions[name])
        at = [dense(s, name[-1])[int(name[2]) - 1] * (s if name[0] == "V" else 1) for s in points]
        assert np.allclose([H(complex(s)) for s in points], at, rtol=1e-9), name
        assert np.allclose(H.at(points), at, rtol=1e-9), name
        assert H.at(points.reshape(2, 3)).shape == (2, 3), name


def test_a_pole_at_the_origin_is_not_finite():
    H = bind_nested(nested(CHAIN)["X_1/F"])
    assert not np.isfinite(H(0j))
    assert not np.isfinite(H.at(0j))
    assert np.isnan(H(complex("inf")))


def test_the_value_at_the_origin_is_the_limit():
    text = """
symflex = 1
parameters = { m = "2 kg", b = "4 N*s/m", c = "8 N*s/m" }
inputs = { F = { force = "y" } }
outputs = { V = "s*y", A = "s^2*y" }
[elements]
body = { type = "mass", at = "x", m = "m" }
loss = { type = "damper", between = ["x", "y"], b = "b" }
slip = { type = "damper", between = ["x", "ground"], b = "c" }
"""
    # Two dampers in series carry a constant force: v = F (1/b + 1/c).
    assert bind_nested(nested(text)["V/F"])(0j) == pytest.approx(3 / 8, rel=1e-15)
    assert bind_nested(nested(text)["A/F"])(0j) == 0


def test_values_stay_finite_at_extreme_frequencies():
    H = bind_nested(nested(CHAIN)["X_1/F"])
    omega = np.logspace(-9, 12, 22)
    found = H.at(1j * omega)
    # Far below the resonances all masses move as one, far above the first moves alone.
    assert found[0] == pytest.approx(-1 / (6 * omega[0] ** 2), rel=1e-9)
    assert found[-1] == pytest.approx(-1 / omega[-1] ** 2, rel=1e-9)


def test_values_are_given_with_units_and_checked():
    tf = nested(CHAIN)["X_1/F"]
    assert bind_nested(tf, {"m_1": "1000 g"})(3j) == bind_nested(tf)(3j)
    assert bind_nested(tf, {"m_1": 2})(3j) != bind_nested(tf)(3j)
    with pytest.raises(UsageError):
        bind_nested(tf, {"m_9": 2})
    with pytest.raises(ModelError) as caught:
        bind_nested(nested(CHAIN.replace('"2 kg"', "{}"))["X_1/F"])
    assert [d.code for d in caught.value.diagnostics] == ["SF229"]


def test_an_output_that_does_not_depend_on_an_input_is_zero():
    text = CHAIN.replace('X_1 = "x_1"', 'X_1 = "x_1 - x_1"')
    tf = nested(text)["X_1/F"]
    assert tf.is_zero
    assert bind_nested(tf)(2j) == 0
    assert not bind_nested(tf).at(np.array([2j])).any()


def test_definitions_and_functions_of_constants_are_taken_along():
    found = nested(DEFINITIONS)
    s = 0.7 + 2j
    top, impedance = 50.0, 2 * s**2 + 3 * s
    expected = 1 / (impedance + top * impedance / (top + impedance))
    assert bind_nested(found["X/F"])(s) == pytest.approx(expected, rel=1e-12)
    assert bind_nested(found["R/F"])(s) == pytest.approx(10 * expected, rel=1e-12)


def evaluated(expression, known):
    """Return the value of a parsed expression."""
    match expression:
        case Number(value):
            return complex(value)
        case Name(name):
            return known[name]
        case Negative(operand):
            return -evaluated(operand, known)
        case Sum(terms):
            return sum(evaluated(t, known) for t in terms)
        case Product(factors):
            return np.prod([evaluated(f, known) for f in factors])
        case Quotient(above, below):
            return evaluated(above, known) / evaluated(below, known)
        case Power(base, exponent):
            return evaluated(base, known) ** int(evaluated(exponent, known).real)
        case Call("sqrt", argument):
            return np.sqrt(evaluated(argument, known))
    raise TypeError(expression)


def expression(text):
    return parse(Text(text, Span(Source("<json>", text), 0, len(text))))


def read_back(tf, s):
    """Return the value that the JSON document's strings lead to, line by line."""
    document = derive_json(tf, nested_form(tf))
    known = {"s": s, "pi": np.pi} | {
        p.name: complex(p.value.rational) * np.pi**p.value.pi_power for p in tf.parameters
    }
    for name, text in document["where"]:
        assert name not in known, "a line hides a parameter"
        known[name] = evaluated(expression(text), known)
    num, den = (evaluated(expression(document[part]), known) for part in ("num", "den"))
    return num / den, document


def test_the_strings_of_the_document_lead_to_the_function():
    for tf in (*nested(CHAIN).values(), *nested(DEFINITIONS).values()):
        found, document = read_back(tf, 0.4 + 3j)
        assert found == pytest.approx(bind_nested(tf)(0.4 + 3j), rel=1e-11)
        assert document["form"] == "nested"
        assert document["hidden"] is None


@given(network=networks())
@quiet(12)
@pytest.mark.slow
def test_random_networks_agree_with_the_dense_tableau_and_with_their_strings(network):
    found = {tf.name: tf for tf in pipeline.derive_nested(pipeline.loads(to_toml(network)))}
    for output, source in pairs(network):
        tf = found[f"{output}/{source}"]
        value = bind_nested(tf)(POINTS[0])
        assert_close(value, reference(network, output, source, POINTS[0]))
        assert abs(read_back(tf, POINTS[0])[0] - value) <= 1e-6 * max(abs(value), 1e-4)


DELAYED = """
symflex = 1
parameters = { T = "1 s" }
inputs.u = {}
blocks.D = { type = "delay", T = "T" }
outputs.y = "D*u"
"""


def test_a_delay_alone_is_its_own_exponential():
    (tf,) = pipeline.derive_nested(pipeline.loads(DELAYED))
    assert bind_nested(tf)(0.3 + 2j) == pytest.approx(cmath.exp(-0.3 - 2j), rel=1e-15)
    assert format_expression(nested_form(tf).num) == "exp(-T*s)"


@pytest.mark.parametrize("name", ["kelvin_voigt_cantilever", "rod_tip_mass", "timoshenko_cantilever"])
def test_nested_and_expanded_forms_of_distributed_models_have_equal_values(name):
    model = pipeline.load(f"derivations/classics/{name}.toml")
    for one, other in zip(pipeline.derive_all(model), pipeline.derive_nested(model), strict=True):
        for s in (3 + 100j, -20 + 4000j):
            assert bind_nested(other)(s) == pytest.approx(bind(one)(s), rel=1e-13)


def test_both_representations_answer_the_same_questions():
    beam = pipeline.load("derivations/classics/rod_tip_mass.toml")
    body = 'elements.m = { type = "mass", at = "x", m = 2 }'
    mass = pipeline.loads(f'symflex = 1\n{body}\ninputs.F = {{ force = "x" }}\noutputs.X = "x"')
    for model, is_rational in ((beam, False), (mass, True)):
        pairs = model.transfer_functions[:1]
        (expanded,), (nested,) = pipeline.derive_all(model, pairs), pipeline.derive_nested(model, pairs)
        assert expanded.is_rational == nested.is_rational == is_rational
        assert (expanded.is_reduced, nested.is_reduced) == (True, False)
        # A formula has its values by itself; of a network of waves they are solved for.
        assert (expanded.solves_network, nested.solves_network) == (False, not is_rational)
        points = [1j, 2 + 3j]
        values = bind(expanded).each(points)
        assert bind_nested(nested).each(points) == pytest.approx(values, rel=1e-13)
        assert values == [bind(expanded)(s) for s in points]
        quotient = as_quotient(bind_nested(nested))
        assert (quotient.is_reduced, quotient(1j)) == (True, pytest.approx(values[0], rel=1e-13))
    assert values == [-0.5, pytest.approx(1 / (2 * (2 + 3j) ** 2))]  # 1/(m s^2)
    assert bind_nested(nested).each([]) == []


def test_the_slope_of_a_nested_beam_is_the_limit_of_differences():
    model = pipeline.load("derivations/classics/kelvin_voigt_cantilever.toml")
    enclosed = bind_nested(pipeline.derive_nested(model)[0]).enclosed(400)
    s, step = acb(-3, 50), acb(2) ** -100
    value, slope = enclosed.value_and_slope(s)
    with ctx.workprec(400):
        difference = (enclosed(s + step) - enclosed(s - step)) / (2 * step * value)
        # Central differences err by a third derivative times the step squared, below 2^-190 here.
        assert abs(complex((slope - difference).mid())) < 2.0**-180
        assert value.overlaps(enclosed(s))


def test_a_value_where_a_member_vibrates_between_fixed_ends_is_a_limit():
    # A rod from ground to a node and on to ground: f_a of the first is divided by sin(s l/c), zero at pi c/l.
    text = """
    symflex = 1
    inputs = { F = { force = "x" } }
    outputs = { X = "x" }
    [elements]
    left = { type = "rod", between = ["ground", "x"], E = "1 Pa", A = "1 m^2", rho = "1 kg/m^3", l = "2 m" }
    right = { type = "rod", between = ["x", "ground"], E = "1 Pa", A = "1 m^2", rho = "1 kg/m^3", l = "1 m" }
    """
    bound = bind_nested(pipeline.derive_nested(pipeline.loads(text))[0])
    # sin(2 w) sin(w)/(w sin(3 w)) of the driven point of a rod 3 m long, held at both ends.
    for w in (1.0, 1.5, math.pi / 2):
        expected = math.sin(2 * w) * math.sin(w) / (w * math.sin(3 * w))
        assert bound(1j * w) == pytest.approx(expected, rel=1e-12, abs=1e-15)


def test_the_representation_is_chosen_by_the_number_of_terms():
    from benchmarks.networks import chain, network

    small, large = network(chain(8)), network(chain(40))
    (tf,), reason = pipeline.derive_as(small, [("X_first", "F")])
    assert (type(tf).__name__, reason) == ("TransferFunction", "")
    (tf,), reason = pipeline.derive_as(large, [("X_first", "F")])
    assert type(tf).__name__ == "NestedTransferFunction"
    # The determinant of a chain in w and m has as many terms as Fibonacci counts: F(80) for 40 masses.
    assert "about 2e16 terms" in reason
    (tf,), reason = pipeline.derive_as(small, [("X_first", "F")], "nested")
    assert (type(tf).__name__, reason) == ("NestedTransferFunction", "")


def test_code_of_many_equal_spans_is_solved_though_their_formula_is_short():
    spans = "".join(
        f'p{i} = {{ type = "pin", at = "n{i}" }}\n'
        f'b{i} = {{ type = "beam", between = ["n{i}", "n{i + 1}"], E = "E", I = "I", '
        'rho = "rho", A = "A", l = "l" }\n'
        for i in range(5)
    )
    model = pipeline.loads(
        "symflex = 1\nparameters = { E = {}, I = {}, rho = {}, A = {}, l = {} }\n"
        f'[elements]\n{spans}[inputs]\nF = {{ force = "n5" }}\n[outputs]\nY = "n5"\n'
    )
    ((formula,), _), ((code,), why) = (
        pipeline.derive_as(model, [("Y", "F")], solves=solves) for solves in (False, True)
    )
    assert (type(formula).__name__, type(code).__name__) == ("TransferFunction", "NestedTransferFunction")
    assert "--representation expanded" in why


def test_a_long_definition_is_compared_with_the_equations_in_nested_form():
    # A cantilever of square section, 60 mm in six parts: l^3/(3 E I).
    parts = [f"a_{i}" for i in range(6)]
    text = f"""symflex = 1
    inputs = {{ F = {{ force = "tip" }} }}
    outputs = {{ Y = "tip" }}
    definitions = {{ I = "({" + ".join(parts)})^4/12" }}
    parameters = {{ {", ".join(f'{name} = "10 mm"' for name in parts)} }}
    [elements.arm]
    type = "beam"
    between = ["ground", "tip"]
    E = "70 GPa"
    rho = "2700 kg/m^3"
    A = "36 cm^2"
    I = "I"
    l = "1 m"
    """.replace("\n    ", "\n")
    (tf,) = pipeline.derive_nested(pipeline.loads(text))
    assert bind_nested(tf)(0j) == pytest.approx(1 / (3 * 70e9 * 0.06**4 / 12), rel=1e-12)


DRIVE = """symflex = 1
parameters = { J_M = {}, J_L = {}, c = {}, d = {}, i = {} }
inputs.M = { torque = "p_1" }
outputs.W = "s*p_1"
[elements]
motor = { type = "inertia", at = "p_1", J = "J_M" }
gear = { type = "transformer", from = "p_1", to = "q", ratio = "1/i" }
shaft = { type = "torsion_spring", between = ["q", "p_2"], k = "c" }
loss = { type = "rotary_damper", between = ["q", "p_2"], b = "d" }
load = { type = "inertia", at = "p_2", J = "J_L" }
"""


def test_a_bar_within_a_side_is_cleared():
    # By hand: behind a gear the load is seen as Z_2/i^2, so W = s*M/(J_M*s^2 + Z_2/i^2).
    form = nested_form(pipeline.derive_nested(pipeline.loads(DRIVE))[0])
    assert (format_expression(form.num), format_expression(form.den)) == ("i^2*s", "Z_2 + J_M*i^2*s^2")
    assert format_expression(dict(form.where)["Z_2"]) == "w_1*Z_1/(Z_1 + w_1)"


def test_what_cancels_and_damping_ratios_are_in_order():
    text = """symflex = 1
parameters = { K = {}, omega_n = {}, zeta = {}, m = {} }
blocks.P = { type = "low_pass", omega = "omega_n", zeta = "zeta" }
blocks.Q = { type = "tf", num = "1", den = "m*s + 1" }
signals.y = "K*P*Q*(r - y)"
inputs.r = {}
outputs.L = "K*P*r"
"""
    form = nested_form(pipeline.derive_nested(pipeline.loads(text))[0])
    # K*omega_n^2/(s^2 + 2*zeta*omega_n*s + omega_n^2), as textbooks write it
    assert (format_expression(form.num), format_expression(form.den)) == (
        "K*omega_n^2",
        "s^2 + 2*zeta*omega_n*s + omega_n^2",
    )
    assert form.where == ()


def test_a_massless_link_leaves_no_reciprocals_of_reciprocals():
    # By hand: [[m*s^2 + k_1 + k_2, a], [a, (J + m*c^2)*s^2 + k_2*l^2]] with a = m*c*s^2 + k_2*l.
    text = """symflex = 1
parameters = { m = {}, J = {}, c = {}, k_1 = {}, k_2 = {}, l = {} }
inputs.F = { force = "p.y" }
outputs.Y = "p.y"
[elements]
body = { type = "rigid_body", at = "p", m = "m", J = "J", cg = "c" }
link = { type = "rigid_link", between = ["p", "q"], length = "l" }
here = { type = "spring", between = ["p.y", "ground"], k = "k_1" }
there = { type = "spring", between = ["q.y", "ground"], k = "k_2" }
"""
    form = nested_form(pipeline.derive_nested(pipeline.loads(text))[0])
    den = "m*s^2 + k_1 + k_2 - (m*c*s^2 + k_2*l)^2/(J*s^2 + m*c^2*s^2 + k_2*l^2)"
    assert (format_expression(form.num), format_expression(form.den), form.where) == ("1", den, ())
