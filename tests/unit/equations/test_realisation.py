from math import prod

import numpy as np
import pytest

from symflex import pipeline
from symflex.roots import Modes
from symflex.roots.locate import locate

BLOCKS = """
C = { type = "tf", num = "s - 1", den = "s + 1" }
P = { type = "tf", num = 1, den = "s - 1" }
A = { type = "tf", num = "s + 1", den = "s + 2" }
B = { type = "tf", num = "s + 2", den = "s + 3" }
"""


def hidden(output="y", signals="", expression="y", blocks="", definitions=None):
    own = f"[definitions]\n{definitions}" if definitions else f"[blocks]{BLOCKS}"
    text = f"""symflex = 1
{own}{blocks}
[signals]
{signals}
[inputs]
r = {{}}
[outputs]
{output} = "{expression}"
"""
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    return tf, sorted((str(h.polynomial), h.multiplicity) for h in tf.hidden)


# The unstable pole at s = 1 cancels against the controller's zero: an internally unstable loop (any text on
# internal stability, for instance Zhou & Doyle 1998, section 5.3).
def test_an_unstable_pole_cancelled_in_a_loop_is_hidden_however_the_loop_is_written():
    for signals in [
        'y = "C*P*(r - y)"',
        'y = "P*C*(r - y)"',
        'y = "(r - y)*C*P"',
        'u = "C*(r - y)"\ny = "P*u"',
    ]:
        tf, found = hidden(signals=signals)
        assert tf.order == (0, 1), signals
        assert ("s - 1", 1) in found, signals


def test_poles_of_definitions_cancel_no_less_than_those_of_blocks():
    for definitions, signals, expression in [
        ('C = "(s - 1)/(s + 1)"\nP = "1/(s - 1)"', 'y = "C*P*(r - y)"', "y"),
        ('C = "(s - 1)/(s + 1)"\nP = "1/(s - 1)"', 'u = "C*(r - y)"\ny = "P*u"', "y"),
        ('C = "(s - 1)/(s + 1)"\nP = "1/(s - 1)"\nL = "C*P"', 'y = "L*(r - y)"', "y"),
        ('D = "s - 1"\nP = "1/D"\nC = "D/(s + 1)"', 'y = "(r - y)*P*C"', "y"),
        ('D = "s - 1"', 'y = "D/(s + 1)*(r - y)/D"', "y"),
        ('C = "(s - 1)/(s + 1)"\nP = "1/(s - 1)"', 'y = "r/(s + 2)"', "P*C*y"),
    ]:
        tf, found = hidden(signals=signals, expression=expression, definitions=definitions)
        assert ("s - 1", 1) in found, (definitions, signals)
    tf, found = hidden(
        signals='y = "Q*r"',
        definitions='P = "1/(s - 1)"',
        blocks='\n[blocks]\nQ = { type = "tf", num = "(s - 1)*P", den = "s + 1" }',
    )
    assert (tf.order, found) == ((0, 1), [("s - 1", 1)])
    tf, found = hidden(signals='y = "Y*r"', definitions='Z = "s + 4"\nY = "1/Z"')
    assert (tf.order, found) == ((0, 1), [])


def test_of_a_double_pole_that_cancels_once_one_is_hidden_and_one_is_moved():
    # y = 5/((s - 1)*(s + 9))*(r - y): s^2 + 8*s - 4; the states have s = 1 beside.
    for signals, definitions in [
        ('y = "C*P*(r - y)"', 'C = "(s - 1)/(s + 9)"\nP = "5/(s - 1)^2"'),
        ('u = "C*(r - y)"\ny = "P*u"', 'C = "(s - 1)/(s + 9)"\nP = "5/(s - 1)^2"'),
        ('y = "5*(s - 1)/(s - 1)/(s - 1)/(s + 9)*(r - y)"', None),
        ('y = "D/(s + 9)*(r - y)"', 'D = "5*(s - 1)/(s - 1)^2"'),
    ]:
        tf, found = hidden(signals=signals, definitions=definitions)
        assert tf.order == (0, 2), signals
        assert ("s - 1", 1) in found, signals


def test_what_cancels_beside_a_value_along_a_beam_leaves_its_other_modes():
    # A free beam has four poles at 0: two for each transfer function, and two that it does not show.
    for rest in ("", "/(s + 3)"):
        text = f"""symflex = 1
signals.y = "(s + 2)/(s + 2){rest}*beam.y(0.7)"
elements.beam = {{ type = "beam", between = ["a", "b"], E = 3, I = 2, A = 1, rho = 5, l = 2 }}
inputs.F = {{ force = "a" }}
outputs.Y = "y"
"""
        model = pipeline.loads(text)
        (bound,) = pipeline.derive_bound(model, model.transfer_functions)
        found = [h.root for h in locate(bound, Modes(2)).hidden]
        assert sorted((float(r.re.mid()), r.multiplicity) for r in found) == [(-2, 1), (0, 2)], rest
        assert all(r.im == 0 for r in found), rest


def test_a_pole_cancelled_within_a_definition_is_hidden():
    block = '\n[blocks]\nQ = { type = "tf", num = 1, den = "s - 1" }'
    for definitions, blocks, order in [
        ('C = "(s - 1)/(s - 1)"', "", (0, 0)),
        ('C = "(s - 1)*(1/(s - 1))"', "", (0, 0)),
        ('C = "(s - 1)*Q"', block, (0, 0)),
        ('D = "Q"\nC = "D*(s - 1)"', block, (0, 0)),
        ('L = "(s - 1)/(s + 1)*Q"\nC = "1/(1 + L)"', block, (1, 1)),
        ('D = "(s - 1)*Q"\nC = "R"', block + '\nR = { type = "integrator", k = "D" }', (0, 1)),
        ('D = "(s - 1)*Q"\nC = "R"', block + '\nR = { type = "tf", num = "D", den = "s + 3" }', (0, 1)),
    ]:
        for signals, expression in [('y = "C*r"', "y"), ('y = "r"', "C*y")]:
            tf, found = hidden(signals=signals, expression=expression, blocks=blocks, definitions=definitions)
            assert (tf.order, found) == (order, [("s - 1", 1)]), (definitions, blocks)


def test_a_pole_cancelled_between_two_blocks_of_one_product_is_hidden():
    tf, found = hidden(signals='y = "A*B*r"')
    assert tf.order == (1, 1)
    assert found == [("s + 2", 1)]


def test_a_pole_cancelled_within_a_block_is_hidden():
    # x_1' = x_2, x_2' = x_1 + u and y = x_2 - x_1 = u/(s + 1): the state's motion exp(t) is unobservable.
    for block in (
        '{ type = "tf", num = "s - 1", den = "(s - 1)*(s + 1)" }',
        '{ type = "tf", num = "s - 1", den = "s^2 - 1" }',
        '{ type = "tf", num = "(s - 1)*P", den = "s + 1" }',
        '{ type = "ss", A = [[0, 1], [1, 0]], B = [0, 1], C = [-1, 1] }',
        '{ type = "ss", A = [[-1, 0], [5, 1]], B = [1, 0], C = [1, 0] }',
    ):
        tf, found = hidden(signals='y = "Q*r"', blocks=f"Q = {block}")
        assert (tf.order, found) == ((0, 1), [("s - 1", 1)]), block
    for block, poles in (
        ('{ type = "lead_lag", T_1 = -1, T_2 = -1 }', "s - 1"),
        ('{ type = "notch", omega = 1, zeta_p = -1, zeta_z = -1 }', "s^2 - 2*s + 1"),
        ('{ type = "resonance", omega_p = 2, omega_z = 2, zeta_p = -1, zeta_z = -1 }', "s^2 - 4*s + 4"),
    ):
        tf, found = hidden(signals='y = "Q*r"', blocks=f"Q = {block}")
        assert (tf.order, found) == ((0, 0), [(poles, 1)]), block


def test_a_pole_cancelled_in_an_output_is_hidden_there():
    tf, found = hidden(signals='x = "r"', expression="(s - 1)*P*x")
    assert tf.order == (0, 0)
    assert found == [("s - 1", 1)]


@pytest.mark.parametrize(
    ("expression", "visible", "unseen"),
    [
        ("(1 - exp(-s*T))/(1 - exp(-s*T))*r", 0, 1),  # the loop's own pole at 0
        ("s*r/(1 - exp(-s*T))", 0, 1),
        ("r/(1 - exp(-s*T))", 1, 0),
        ("(1 - exp(-s*T))*r/(s*T)", 0, 1),  # the integrator's
        ("(1 - exp(-s*T))*r/(s*T)^2", 1, 1),
        ("(1 - exp(-s*T))*r", 0, 0),
    ],
)
def test_a_pole_at_0_that_only_a_delay_cancels_is_hidden_in_outputs_too(expression, visible, unseen):
    # 1 - exp(-s T) = s T - ..., which vanishes once at 0
    start = "symflex = 1\nparameters.T = 0.2\ninputs.r = {}\n"
    for rest in (f'outputs.y = "{expression}"', f'outputs.y = "x"\nsignals.x = "{expression}"'):
        found = locate(pipeline.bind(pipeline.derive_all(pipeline.loads(start + rest))[0]), Modes(1))
        at_rest = [root.multiplicity for root in found.poles if root.is_zero]
        gone = [h.root.multiplicity for h in found.hidden if h.root.is_zero]
        assert (sum(at_rest), sum(gone)) == (visible, unseen), rest


def test_a_matched_duct_hides_nothing_at_0():
    # p = 2 p_i - Z u at x = 0 and u = p/Z at l: p(l) = p_i exp(-s l/c), of waves that leave
    text = """symflex = 1
parameters = { Z = "2 Pa*s/m^3", c = "3 m/s", l = "1 m" }
inputs = { p_i = { unit = "Pa" } }
outputs = { T = "p(l)" }
[fields.duct]
unknowns = ["p", "u"]
domain = ["0", "l"]
equations = ["p' = -Z/c*s*u", "u' = -s/(Z*c)*p"]
conditions = ["p(0) = 2*p_i - Z*u(0)", "u(l) = p(l)/Z"]
"""
    found = locate(pipeline.bind(pipeline.derive_all(pipeline.loads(text))[0]), Modes(1))
    assert (found.poles, found.hidden) == ((), ())


def test_terms_of_a_sum_share_their_poles():
    tf, found = hidden(signals='y = "P*r + P*A*r"')
    assert tf.order == (1, 2)
    assert found == []


def test_what_does_not_cancel_hides_nothing():
    tf, found = hidden(signals='y = "A*r/(s + 5)^2"')
    assert tf.order == (1, 3)
    assert found == []


def test_what_an_expression_divides_by_is_kept_where_it_cancels():
    for expression, order, poles in [
        ("(s - 1)^2*P^2*x", (0, 0), [1, 1]),
        ("(s - 1)^3*P*P^2*x", (0, 0), [1, 1, 1]),
        ("(s + 5)^-2*(s + 5)*x", (0, 1), [-5]),
        ("(s + 5)^-2*(s + 5)^2*x", (0, 0), [-5, -5]),
        ("C^-1*C*x", (0, 0), [-1, 1]),
        ("(s + 5)*x/((s + 5)*(s + 6))", (0, 1), [-5]),
        ("-(s + 2)*(A*x + A*B*x)", (2, 1), [-2]),
        ("A*x - A*x + x", (0, 0), [-2]),
        ("(s - 1)*(P*x/(s + 6))", (0, 1), [1]),
        ("A^0*x", (0, 0), []),
        ("3*x/4", (0, 0), []),
    ]:
        tf, _ = hidden(signals='x = "r"', expression=expression)
        found = [h.polynomial for h in tf.hidden for _ in range(h.multiplicity)]
        wanted = [tf.ratio.ring.generator("s") - pole for pole in poles]
        assert tf.order == order, expression
        assert prod(found) == prod(wanted), expression


# ---------------------------------------------------------------------- values of elements, fields and blocks

PLANT = """symflex = 1
parameters = {{ k = "3 N/m", c = "5 N*s/m", m = "1 kg" }}
{subsystems}
inputs = {{ F = {{ force = "x" }} }}
outputs = {{ X = "x" }}
[elements]
body = {{ type = "mass", at = "x", m = "{m}" }}
damper = {{ type = "damper", between = ["x", "ground"], b = "{c}" }}
spring = {{ type = "spring", between = ["x", "ground"], k = "{k}" }}
"""


def poles_of(text):
    """Return the visible poles and the hidden ones, with multiplicity."""
    model = pipeline.loads(text)
    (bound,) = pipeline.derive_bound(model, model.transfer_functions[:1])
    found = locate(bound)
    visible, unseen = found.poles, [h.root for h in found.hidden]
    return [
        sorted(round(float(r.re.mid()), 9) for r in roots for _ in range(r.multiplicity))
        for roots in (visible, unseen)
    ]


def test_a_pole_that_cancels_in_the_value_of_an_element_is_hidden():
    """The subsystem z' = z + e with output (s - 1)/(s + 2) of it has det = (s - 1)*(s + 2) by itself."""
    for subsystems in (
        'blocks = { P = "1/(s - 1)", C = "(s - 1)/(s + 2)" }',
        'definitions = { P = "1/(s - 1)", C = "(s - 1)/(s + 2)" }',
        'definitions = { Z = "s - 1", P = "1/Z", C = "Z/(s + 2)" }',
        'definitions = { Z = "s - 1", C = "Z/(s + 2)" }\nblocks = { P = "1/Z" }',
    ):
        for place, value in (
            ("k", "k*(1 + P*C)"), ("k", "k + C*k*P"), ("k", "k*(1 + C/(1/P))"), ("c", "c*(1 + P*C)"),
            ("m", "m*(1 + P*C)"),
        ):  # fmt: skip
            text = PLANT.format(**{"m": "m", "c": "c", "k": "k", "subsystems": subsystems, place: value})
            visible, unseen = poles_of(text)
            assert unseen == [1], (subsystems, value)
            # m s^2 + c s + k, of which one has the factor 1 + 1/(s + 2) = (s + 3)/(s + 2)
            m, c, k = (
                np.polymul({"m": [1, 0, 0], "c": [5, 0], "k": [3]}[n], [1, 3 if n == place else 2])
                for n in "mck"
            )
            expected = np.roots(np.polyadd(np.polyadd(m, c), k))
            assert visible == pytest.approx(sorted(expected.real), abs=1e-8), (subsystems, value)


def test_two_filters_that_act_on_one_shaft_have_a_state_each():
    """Only their sum turns the shaft: J s^2 (1 + T s) + 2 k_t k_e s/R, and the difference decays with T."""
    text = """symflex = 1
parameters = { R = "1 Ohm", k_t = "2 N*m/A", T = "0.5 s", J = "1 kg*m^2" }
inputs = { u = { voltage = "a" }, v = { voltage = "b" } }
outputs = { X = "x" }
[elements]
rotor = { type = "inertia", at = "x", J = "J" }
"""
    for n in "ab":
        text += (
            f'm_{n} = {{ type = "dc_motor", terminals = ["{n}", "ground"], shaft = "x", R = "R", '
            'k_t = "k_t/(1 + T*s)", k_e = "k_t" }\n'
        )
    assert poles_of(text) == [[-1, -1, 0], [-2]]  # s^2 + 2 s + 16 has the roots -1 +- 3.87j


ROD = """symflex = 1
parameters = {{ EA = "1 N", rhoA = "1 kg/m", l = "1 m", eta = "0.5 s" }}
blocks = {{ P = "1/(s - 1)", C = "(s - 1)/(s + 2)", Q = "s/(s - 1)", R = "3/((s - 1)*(s + 2))" }}
inputs = {{ F = {{ unit = "N" }}, d = {{}} }}
outputs = {{ W = "w(l)" }}
[fields.w]
domain = ["0", "l"]
equation = "{equation}"
conditions = ["w(0) = 0", "{condition}"]
"""


def test_what_cancels_or_filters_in_fields_and_conditions_is_a_mode_of_the_model():
    damped, end = "EA*(1 + eta*s)*w'' = rhoA*s^2*w", "EA*(1 + eta*s)*w'(l) = F"
    for equation, condition in (
        (damped, end + " + P*d"),
        (damped, end + "*(1 + 0*P*C)"),
        (damped, "EA*(1 + eta*s)*w'(l)*P*C = F*P*C"),
        (damped + " - P*d", end),
        (damped.replace("eta", "eta*(1 + P*C - P*C)"), end),
        (damped.replace("eta", "eta*(Q - R)"), end),  # (s - 1)*(s + 3)/((s - 1)*(s + 2))
    ):
        tf = pipeline.derive_all(pipeline.loads(ROD.format(equation=equation, condition=condition)))[0]
        found = [(str(h.polynomial), h.multiplicity) for h in tf.hidden if "- 1" in str(h.polynomial)]
        assert found == ([] if "0*P" in condition else [("s - 1", 1)]), (equation, condition)


def test_poles_of_entries_and_parameters_of_blocks_are_their_own_states():
    for block, visible in (
        ('{ type = "ss", A = [[-1]], B = ["P*C"], C = [1] }', [-2, -1]),
        ('{ type = "ss", A = [[-1]], B = [1], C = ["P*C"] }', [-2, -1]),
        ('{ type = "ss", A = [["-1 + P*C"]], B = [1], C = [1] }', sorted(np.roots([1, 3, 1]))),
        ('{ type = "ss", A = [[-1]], B = [1], C = [1], D = "P*C" }', [-2, -1]),
        ('{ type = "pid", k_p = "P*C" }', [-2]),
        ('{ type = "pid", k_p = 1, k_i = "P*C" }', [-2, 0]),
        ('{ type = "integrator", k = "P*C" }', [-2, 0]),
        ('{ type = "lag", T = 4, k = "P*C" }', [-2, -0.25]),
        ('{ type = "low_pass", omega = 2, zeta = 1, k = "P*C" }', [-2, -2, -2]),
    ):
        text = f"""symflex = 1
signals = {{ y = "G*r" }}
inputs = {{ r = {{}} }}
outputs = {{ Y = "y" }}
[blocks]
P = "1/(s - 1)"
C = "(s - 1)/(s + 2)"
G = {block}
"""
        found, unseen = poles_of(text)
        assert unseen == [1], block
        assert found == pytest.approx(visible, abs=1e-8), block


def test_squares_of_roots_and_of_j_in_state_equations_hide_nothing():
    # det(s - A) = s (s + 1) - sqrt(a)^2 with a = 2: the loop s^2 + s - 2 + 5 sqrt(2) is stable.
    loop = 'A = [[0, "sqrt(a)"], ["sqrt(a)", -1]], B = [0, 5], C = [1, 0]'
    # (s + 2 - 3j)(s + 2 + 3j), and with the unit feedback of r - y: s^2 + 6 s + 17
    pair = 'A = [["-2 + 3*j", 0], [0, "-2 - 3*j"]], B = [1, 1], C = [1, 1]'
    for block, poles in [(loop, np.roots([1, 1, 5 * 2**0.5 - 2])), (pair, np.roots([1, 6, 17]))]:
        text = f"""symflex = 1
parameters.a = 2
inputs.r = {{}}
outputs.Y = "y"
signals.y = "R*(r - y)"
blocks.R = {{ type = "ss", {block} }}
"""
        model = pipeline.loads(text)
        (bound,) = pipeline.derive_bound(model, model.transfer_functions)
        found = locate(bound, None, 15)
        assert not found.hidden, block
        right = sorted(poles, key=lambda z: z.imag)
        assert sorted(map(complex, found.poles), key=lambda z: z.imag) == pytest.approx(right)
        assert found.verdict.word == "stable"


def test_nothing_is_connected_through_a_gain_of_zero():
    tf, found = hidden(signals='y = "r/(s + 2) + 0*P*C*r"')
    assert (tf.order, found) == ((0, 1), [])
    tf, found = hidden(signals='y = "K*r"', blocks='K = { type = "pid", k_p = 3, k_i = 0 }')
    assert (tf.order, found) == ((0, 0), [])
