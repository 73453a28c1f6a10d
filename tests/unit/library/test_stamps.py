"""Every element against the law it stands for, written by hand as a small matrix equation."""

import sympy

import symflex
from symflex import pipeline

s = sympy.Symbol("s")


def derive(text, output, source):
    """Return the derived function as a SymPy quotient in plain symbols."""
    G = symflex.loads("symflex = 1\n" + text).transfer_function(output, source)
    num, den = (e.xreplace({x: sympy.Symbol(x.name) for x in e.free_symbols}) for e in (G.num, G.den))
    return num / den


def assert_law(text, output, source, expected):
    assert sympy.cancel(derive(text, output, source) - expected) == 0


def assert_laws(text, source, **expected):
    """Assert the functions of several outputs over one input."""
    for output, law in expected.items():
        assert_law(text, output, source, law)


def symbols(names):
    return sympy.symbols(names)


BRANCHES = {
    # type: (port domain's input, name of the value, its unit, admittance, through quantity)
    "spring": ("force", "k", "N/m", lambda k: k, "f"),
    "damper": ("force", "b", "N*s/m", lambda b: b * s, "f"),
    "torsion_spring": ("torque", "k", "N*m/rad", lambda k: k, "tau"),
    "rotary_damper": ("torque", "b", "N*m*s/rad", lambda b: b * s, "tau"),
    "resistor": ("current", "R", "Ohm", lambda R: 1 / R, "i"),
    "inductor": ("current", "L", "H", lambda L: 1 / (L * s), "i"),
    "capacitor": ("current", "C", "F", lambda C: C * s, "i"),
}
HOLD = {
    "force": ("spring", "k", "N/m"),
    "torque": ("torsion_spring", "k", "N*m/rad"),
    "current": ("resistor", "R", "Ohm"),
}


def branch_model(kind):
    source, value, unit, _, through = BRANCHES[kind]
    holder, held, held_unit = HOLD[source]
    return f"""
parameters = {{ p = {{ unit = "{unit}" }}, g = {{ unit = "{held_unit}" }} }}
inputs.U = {{ {source} = "a" }}
outputs = {{ A = "a", C = "c", Q = "part.{through}" }}
[elements]
part = {{ type = "{kind}", between = ["a", "c"], {value} = "p" }}
rest = {{ type = "{holder}", between = ["c", "ground"], {held} = "g" }}
"""


def test_a_branch_carries_admittance_times_difference_from_its_first_node_to_its_second():
    p, g = symbols("p g")
    for kind, (source, _, _, admittance, _) in BRANCHES.items():
        held = 1 / g if source == "current" else g
        assert_laws(branch_model(kind), "U", A=1 / admittance(p) + 1 / held, C=1 / held, Q=1)


def test_an_inertia_takes_the_whole_force_that_accelerates_it():
    for kind, source, value, unit, through in [
        ("mass", "force", "m", "kg", "f"),
        ("inertia", "torque", "J", "kg*m^2", "tau"),
    ]:
        text = (
            f'parameters.m = {{ unit = "{unit}" }}\ninputs.U = {{ {source} = "x" }}\n'
            f'elements.body = {{ type = "{kind}", at = "x", {value} = "m" }}\n'
            f'outputs.X = "x"\noutputs.Q = "body.{through}"\n'
        )
        assert_laws(text, "U", X=1 / (sympy.Symbol("m") * s**2), Q=1)


# ------------------------------------------------------------------------------------------- planar parts

BEAM = """
parameters = { EI = { unit = "N*m^2" }, l = { unit = "m" } }
[elements]
beam = { type = "massless_beam", between = ["a", "c"], EI = "EI", l = "l" }
hold = { type = "fixed", at = "%s" }
[inputs]
F = { force = "%s.y" }
M = { torque = "%s.theta" }
[outputs]
Y = "%s.y"
T = "%s.theta"
f = "beam.f"
tau = "beam.tau"
R = "hold.f"
Q = "hold.tau"
"""


def test_the_massless_beam_has_the_euler_bernoulli_stiffness():
    # For (y_a, theta_a, y_b, theta_b), from the energy of Hermite cubics: Przemieniecki 1968, chapter 5.
    EI, l = symbols("EI l")  # noqa: E741
    stiffness = sympy.Matrix(
        [
            [12, 6 * l, -12, 6 * l],
            [6 * l, 4 * l**2, -6 * l, 2 * l**2],
            [-12, -6 * l, 12, -6 * l],
            [6 * l, 2 * l**2, -6 * l, 4 * l**2],
        ]
    )
    for held, free, keep in [("a", "c", (2, 3)), ("c", "a", (0, 1))]:
        flexibility = (stiffness * EI / l**3).extract(keep, keep).inv()
        for column, source in enumerate("FM"):
            y, theta = flexibility[:, column]
            assert_laws(BEAM % (held, free, free, free, free), source, Y=y, T=theta)


def test_a_clamped_beam_delivers_minus_what_is_applied_at_its_tip_and_its_wall_balances_both():
    text = BEAM % ("a", "c", "c", "c", "c")
    assert_laws(text, "F", R=-1, Q=-sympy.Symbol("l"), f=-1, tau=0)
    assert_laws(text, "M", R=0, Q=-1, f=0, tau=-1)


def test_two_beams_in_series_are_one_beam_of_the_whole_length():
    text = """
parameters = { EI = { unit = "N*m^2" }, l = { unit = "m" }, d = { unit = "m" } }
inputs.F = { force = "e.y" }
outputs = { Y = "e.y", T = "e.theta" }
[elements]
one = { type = "massless_beam", between = ["a", "c"], EI = "EI", l = "l" }
two = { type = "massless_beam", between = ["c", "e"], EI = "EI", l = "d" }
hold = { type = "fixed", at = "a" }
"""
    EI, length = sympy.Symbol("EI"), sympy.Symbol("l") + sympy.Symbol("d")
    assert_laws(text, "F", Y=length**3 / (3 * EI), T=length**2 / (2 * EI))


BODY = """
parameters = { m = { unit = "kg" }, J = { unit = "kg*m^2" }, c = { unit = "m" }, h = { unit = "m" } }
[elements]
body = { type = "rigid_body", at = "p", m = "m", J = "J", cg = "c" }
[inputs]
F = { force = "p.y" }
M = { torque = "p.theta" }
[outputs]
Y = "p.y"
T = "p.theta"
f = "body.f"
tau = "body.tau"
"""


def test_a_free_body_about_an_offset_node_has_its_kinetic_energy_and_takes_what_is_applied():
    m, J, c, y, theta = symbols("m J c y theta")
    kinetic = m * (y + c * theta) ** 2 / 2 + J * theta**2 / 2  # that of the mass centre
    receptance = (sympy.hessian(kinetic, (y, theta)) * s**2).inv()
    assert_laws(BODY, "F", Y=receptance[0, 0], T=receptance[1, 0], f=1, tau=0)
    assert_laws(BODY, "M", Y=receptance[0, 1], T=receptance[1, 1], f=0, tau=1)


def test_a_rigid_body_defaults_to_a_point_mass_at_its_node():
    text = """
parameters = { m = { unit = "kg" }, k = { unit = "N*m/rad" } }
inputs.F = { force = "p" }
outputs = { Y = "p", T = "p.theta" }
[elements]
body = { type = "rigid_body", at = "p", m = "m" }
hold = { type = "torsion_spring", between = ["p", "ground"], k = "k" }
"""
    assert_laws(text, "F", Y=1 / (sympy.Symbol("m") * s**2), T=0)


def test_a_rigid_link_moves_the_node_of_a_body():
    m, J, h = symbols("m J h")
    text = """
parameters = { m = { unit = "kg" }, J = { unit = "kg*m^2" }, h = { unit = "m" } }
inputs.F = { force = "tip.y" }
outputs = { Y = "tip.y", T = "tip.theta", P = "p.y", f = "arm.f", tau = "arm.tau" }
[elements]
body = { type = "rigid_body", at = "p", m = "m", J = "J" }
arm = { type = "rigid_link", between = ["p", "tip"], length = "h" }
"""
    # Force at the tip: m*s^2*y = F, J*s^2*theta = F*h, y_tip = y + h*theta.
    y = 1 / (m * s**2)
    assert_laws(text, "F", Y=y + h**2 / (J * s**2), T=h / (J * s**2), P=y, f=-1, tau=0)


def test_a_link_of_rational_length_equals_its_value():
    text = """
parameters = { J = { unit = "kg*m^2" }, h = { unit = "m" }, n = {} }
inputs.F = { force = "tip.y" }
outputs.Y = "tip.y"
[elements]
body = { type = "rigid_body", at = "p", m = "0", J = "J" }
pin = { type = "pin", at = "p" }
arm = { type = "rigid_link", between = ["p", "tip"], length = "h/(n + 1)" }
"""
    J, h, n = symbols("J h n")
    assert_law(text, "Y", "F", (h / (n + 1)) ** 2 / (J * s**2))


# --------------------------------------------------------------------------------------------- supports


def test_a_pinned_body_turns_about_the_pin():
    m, J, c = symbols("m J c")
    text = BODY.replace("[inputs]", 'pin = { type = "pin", at = "p" }\n[inputs]') + 'R = "pin.f"\n'
    # The mass centre accelerates by c*theta'' = c*M/(J + m*c^2); the pin delivers that force.
    inertia = J + m * c**2
    assert_laws(text, "M", T=1 / (inertia * s**2), Y=0, R=m * c / inertia)
    assert_laws(text, "F", R=-1)


def test_a_body_on_a_slider_does_not_turn_and_the_slider_takes_the_moment():
    m, c = symbols("m c")
    text = BODY.replace("[inputs]", 'guide = { type = "slider", at = "p" }\n[inputs]') + 'R = "guide.tau"\n'
    assert_laws(text, "F", Y=1 / (m * s**2), T=0, R=c)
    assert_laws(text, "M", R=-1)


def test_the_reaction_of_a_fixed_node_is_delivered_to_it():
    for source, (kind, value, _), quantity in zip(HOLD, HOLD.values(), ("f", "tau", "i"), strict=True):
        text = (
            f'inputs.U = {{ {source} = "x" }}\noutputs.R = "wall.{quantity}"\n[elements]\n'
            f'link = {{ type = "{kind}", between = ["x", "y"], {value} = 3 }}\n'
            'wall = { type = "fixed", at = "y" }\n'
        )
        assert_laws(text, "U", R=-1)


# ---------------------------------------------------------------------------------------------- sources

SOURCE = """
parameters = {{ k = {{ unit = "{unit}" }}, g = {{}} }}
elements = {{ drive = {{ type = "{kind}", at = "x", {value} = "g*u" }}, load = {{ {load} }} }}
inputs.u = {{}}
outputs = {{ X = "x", Q = "drive.{through}" }}
"""
THROUGH_SOURCES = [
    ("force_source", "f", "N/m", 'type = "spring", between = ["x", "ground"], k = "k"', False),
    ("torque_source", "tau", "N*m/rad", 'type = "torsion_spring", between = ["x", "ground"], k = "k"', False),
    ("current_source", "i", "Ohm", 'type = "resistor", between = ["x", "ground"], R = "k"', True),
]


def test_a_through_source_delivers_its_value_into_the_node():
    for kind, through, unit, load, impedance in THROUGH_SOURCES:
        k, g = symbols("k g")
        text = SOURCE.format(kind=kind, value=through, unit=unit, load=load, through=through)
        assert_laws(text, "u", X=g * k if impedance else g / k, Q=g)


def test_a_voltage_source_holds_the_node_and_delivers_the_current_drawn():
    k, g = symbols("k g")
    text = SOURCE.format(
        kind="voltage_source",
        value="v",
        unit="Ohm",
        load='type = "resistor", between = ["x", "ground"], R = "k"',
        through="i",
    )
    assert_laws(text, "u", X=g, Q=g / k)


def test_a_source_may_depend_on_what_it_drives():
    k, g = symbols("k g")
    text = SOURCE.format(
        kind="force_source",
        value="f",
        unit="N/m",
        load='type = "spring", between = ["x", "ground"], k = "k"',
        through="f",
    ).replace('"g*u"', '"u - g*x"')
    assert_laws(text, "u", X=1 / (k + g), Q=k / (k + g))


def test_a_voltage_input_between_two_nodes_is_the_difference():
    R, C = symbols("R C")
    text = """
parameters = { R = { unit = "Ohm" }, C = { unit = "F" } }
inputs.V = { voltage = ["a", "c"] }
outputs = { A = "a", K = "c" }
[elements]
r = { type = "resistor", between = ["a", "ground"], R = "R" }
c = { type = "capacitor", between = ["c", "ground"], C = "C" }
"""
    assert_laws(text, "V", A=R * C * s / (1 + R * C * s), K=-1 / (1 + R * C * s))


def test_a_force_input_on_two_nodes_reacts_on_the_second():
    m, n = symbols("m n")
    text = """
parameters = { m = { unit = "kg" }, n = { unit = "kg" } }
elements = { a = { type = "mass", at = "a", m = "m" }, c = { type = "mass", at = "c", m = "n" } }
inputs.F = { force = ["a", "c"] }
outputs = { A = "a", C = "c" }
"""
    assert_laws(text, "F", A=1 / (m * s**2), C=-1 / (n * s**2))


def test_an_element_may_bear_the_name_of_a_voltage_input():
    text = """
parameters = { R = { unit = "Ohm" } }
elements.V = { type = "resistor", between = ["a", "ground"], R = "R" }
inputs.V = { voltage = "a" }
outputs.I = "V.i"
"""
    assert_law(text, "I", "V", 1 / sympy.Symbol("R"))


# --------------------------------------------------------------------------------------------- couplings

# domain: (impedance at a node as an element line, its admittance per across variable, effort and flow)
LOADS = {
    "translation": ('type = "spring", between = ["{n}", "ground"], k = "{v}"', "force", lambda k: k),
    "rotation": ('type = "torsion_spring", between = ["{n}", "ground"], k = "{v}"', "torque", lambda k: k),
    "electrical": ('type = "resistor", between = ["{n}", "ground"], R = "{v}"', "current", lambda R: 1 / R),
}
THROUGH = {"translation": "f", "rotation": "tau", "electrical": "i"}
# Each domain on each side; efforts and flows of motion are crossed with those of electricity both ways.
PAIRS = (("translation", "rotation"), ("rotation", "electrical"), ("electrical", "translation"))
PAIRS += (("electrical", "electrical"),)


def coupling_model(kind, source, target, ratio="n"):
    load_from, drive, _ = LOADS[source]
    load_to, _, _ = LOADS[target]
    return f"""
parameters = {{ n = {{}}, a = {{}}, T = "1 s", k_1 = {{}}, k_2 = {{}} }}
inputs.U = {{ {drive} = "x" }}
outputs = {{ X = "x", Y = "y", Q = "both.{THROUGH[target]}" }}
[elements]
near = {{ {load_from.format(n="x", v="k_1")} }}
far = {{ {load_to.format(n="y", v="k_2")} }}
both = {{ type = "{kind}", from = "x", to = "y", ratio = "{ratio}" }}
"""


def transformer_by_hand(source, target, n):
    """Return (x, y, delivered) per unit through variable at ``from``: y = n*x and U = Y_1 x + n*(Y_2 y)."""
    near, far = LOADS[source][2](sympy.Symbol("k_1")), LOADS[target][2](sympy.Symbol("k_2"))
    x = 1 / (near + n**2 * far)
    return x, n * x, far * n * x


def assert_coupled(kind, by_hand, source, target, ratio="n"):
    n, a, T = symbols("n a T")
    x, y, q = by_hand(source, target, n if ratio == "n" else n * (1 + a * s * T) / (2 + s * T))
    assert_laws(coupling_model(kind, source, target, ratio), "U", X=x, Y=y, Q=q)


RATIONAL = "n*(1 + a*s*T)/(2 + s*T)"


def test_a_transformer_scales_and_loses_no_power_in_any_pair_of_domains():
    for pair in PAIRS:
        assert_coupled("transformer", transformer_by_hand, *pair)


def test_a_transformer_s_ratio_may_be_a_rational_function_of_s():
    assert_coupled("transformer", transformer_by_hand, "translation", "rotation", RATIONAL)


def gyrator_by_hand(source, target, n):
    """Return (x, y, delivered) by solving effort_from = n*flow_to, effort_to = n*flow_from and both balances.

    Effort is force, torque or voltage, flow velocity or current; ``drawn`` and ``given`` are the force,
    torque or current taken at one side and delivered at the other.
    """
    x, y, drawn, given = symbols("x y drawn given")
    near, far = LOADS[source][2](sympy.Symbol("k_1")), LOADS[target][2](sympy.Symbol("k_2"))
    effort = {"electrical": lambda across, through: across}
    flow = {"electrical": lambda across, through: through}

    def effort_of(domain, across, through):
        return effort.get(domain, lambda a, t: t)(across, through)

    def flow_of(domain, across, through):
        return flow.get(domain, lambda a, t: s * a)(across, through)

    laws = [
        effort_of(source, x, drawn) - n * flow_of(target, y, given),
        effort_of(target, y, given) - n * flow_of(source, x, drawn),
        1 - drawn - near * x,
        given - far * y,
    ]
    found = sympy.solve(laws, [x, y, drawn, given], dict=True)[0]
    return found[x], found[y], found[given]


def test_a_gyrator_crosses_effort_and_flow_in_any_pair_of_domains():
    for pair in PAIRS:
        assert_coupled("gyrator", gyrator_by_hand, *pair)


def test_a_gyrator_s_ratio_may_be_a_rational_function_of_s():
    assert_coupled("gyrator", gyrator_by_hand, "electrical", "rotation", RATIONAL)


MOTOR = """
inputs = { V = { voltage = "v" }, M = { torque = "z" } }
outputs = { W = "s*z", I = "motor.i", T = "motor.tau" }
[parameters]
L = { unit = "H" }
R = { unit = "Ohm" }
K = { unit = "N*m/A" }
E = { unit = "V*s/rad" }
J = { unit = "kg*m^2" }
b = { unit = "N*m*s/rad" }
[elements]
motor = { type = "dc_motor", terminals = ["v", "ground"], shaft="z", L = "L", R = "R", k_t = "K", k_e = "E" }
rotor = { type = "inertia", at = "z", J = "J" }
loss = { type = "rotary_damper", between = ["z", "ground"], b = "b" }
"""


def test_a_dc_motor_obeys_its_two_laws():
    L, R, K, E, J, b = symbols("L R K E J b")
    # (L s + R) i + E w = V and (J s + b) w = K i + M, solved by Cramer's rule.
    den = (L * s + R) * (J * s + b) + K * E
    assert_laws(MOTOR, "V", W=K / den, I=(J * s + b) / den, T=K * (J * s + b) / den)
    assert_laws(MOTOR, "M", W=(L * s + R) / den, I=-E / den)


def test_a_dc_motor_s_back_emf_constant_defaults_to_its_torque_constant():
    L, R, K, J, b = symbols("L R K J b")
    text = MOTOR.replace(', k_e = "E"', "").replace('E = { unit = "V*s/rad" }\n', "")
    assert_law(text, "W", "V", K / ((L * s + R) * (J * s + b) + K**2))


def test_an_ideal_motor_without_winding_is_a_gyrator():
    text = MOTOR.replace('L = "L", R = "R", ', "").replace(', k_e = "E"', "")
    assert_law(text, "W", "V", 1 / sympy.Symbol("K"))


# --------------------------------------------------------------------------------- values rational in s

RELAXING = """
inputs.F = { force = "x" }
outputs = { X = "x", S = "soft.f" }
[parameters]
m = { unit = "kg" }
k = { unit = "N/m" }
a = { unit = "s" }
d = { unit = "s" }
k_2 = { unit = "N/m" }
[elements]
body = { type = "mass", at = "x", m = "m" }
foot = { type = "mass", at = "y", m = "2*m" }
soft = { type = "spring", between = ["x", "y"], k = "k*(1 + a*s)/(1 + d*s)" }
EXTRA
"""


def derived(text, output="X", source="F"):
    return pipeline.derive(pipeline.assemble(pipeline.loads("symflex = 1\n" + text)), output, source)


def test_a_relaxing_spring_adds_one_pole_and_nothing_hidden():
    tf = derived(RELAXING.replace("EXTRA", ""))
    assert (tf.order, tf.hidden) == ((3, 5), ())


def test_a_relaxing_spring_is_its_rational_stiffness():
    m, k, a, d = symbols("m k a d")
    stiffness = k * (1 + a * s) / (1 + d * s)
    matrix = sympy.Matrix([[m * s**2 + stiffness, -stiffness], [-stiffness, 2 * m * s**2 + stiffness]])
    x = matrix.inv()[:, 0]
    assert_laws(RELAXING.replace("EXTRA", ""), "F", X=x[0], S=stiffness * (x[0] - x[1]))


def test_a_relaxing_spring_beside_a_plain_one_is_still_one_state():
    extra = 'hard = { type = "spring", between = ["x", "y"], k = "k_2" }'
    tf = derived(RELAXING.replace("EXTRA", extra))
    assert (tf.order, tf.hidden) == ((3, 5), ())


def test_two_equal_relaxing_springs_side_by_side_hide_the_state_that_only_circulates():
    extra = 'twin = { type = "spring", between = ["x", "y"], k = "k*(1 + a*s)/(1 + d*s)" }'
    tf = derived(RELAXING.replace("EXTRA", extra))
    assert tf.order == (3, 5)
    assert [(str(h.polynomial), h.multiplicity) for h in tf.hidden] == [("s*d + 1", 1)]


def test_the_free_slope_of_a_relaxing_beam_creeps_back_unseen():
    """Without moment at the tip the slope obeys (1 + a s) theta = 0 at rest, which moves neither y nor f."""
    text = """
inputs.F = { force = "q.y" }
outputs.X = "q.y"
[parameters]
m = { unit = "kg" }
EI = { unit = "N*m^2" }
a = { unit = "s" }
d = { unit = "s" }
l = { unit = "m" }
[elements]
beam = { type = "massless_beam", between = ["p", "q"], EI = "EI*(1 + a*s)/(1 + d*s)", l = "l" }
wall = { type = "fixed", at = "p" }
tip = { type = "rigid_body", at = "q", m = "m" }
"""
    m, EI, a, d, length = symbols("m EI a d l")
    stiffness = 3 * EI * (1 + a * s) / (1 + d * s) / length**3
    tf = derived(text)
    assert tf.order == (1, 3)
    assert [(str(h.polynomial), h.multiplicity) for h in tf.hidden] == [("s*a + 1", 1)]
    assert_law(text, "X", "F", 1 / (m * s**2 + stiffness))
