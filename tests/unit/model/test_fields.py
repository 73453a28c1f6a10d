"""Boundary-value problems as a specification writes them: what is read, and what is refused."""

from fractions import Fraction

import pytest

from symflex.errors import Source, SpecError
from symflex.expressions import Call, Derivative, Name, Number, format_expression, names
from symflex.library.elements import Variable
from symflex.model import load_model, scope_of, with_numbers
from symflex.quantities import unit_of

PARAMETERS = """symflex = 1
[parameters]
E = "70 GPa"
I = "1e-8 m^4"
rho = "2700 kg/m^3"
A = "1e-3 m^2"
l = "1.2 m"
a = {}
b = { assume = "real" }
"""
BENDING = "E*I*w'''' + rho*A*s^2*w = 0"
FREE = ["w'(0) = 0", "E*I*w'''(0) = F", "w''(l) = 0", "w'''(l) = 0"]
REST = '[inputs]\nF = { unit = "N" }\n[outputs]\nX = "w(l)"\n'


def quoted(texts):
    return "[" + ", ".join(f'"{t}"' for t in texts) + "]"


def field(conditions=FREE, equations=(BENDING,), domain=("0", "l"), name="w", unknowns=None):
    keys = {"domain": quoted(domain), "equations": quoted(equations), "conditions": quoted(conditions)}
    if unknowns:
        keys["unknowns"] = quoted(unknowns)
    return f"[fields.{name}]\n" + "".join(f"{k} = {v}\n" for k, v in keys.items())


def load(*parts, rest=REST, parameters=PARAMETERS):
    text = parameters + "".join(parts) + rest
    return load_model(Source("spec.toml", text))


def problems(*parts, **others):
    with pytest.raises(SpecError) as caught:
        load(*parts, **others)
    return [(d.code, d.message) for d in caught.value.diagnostics]


def codes(*parts, **others):
    return [code for code, _ in problems(*parts, **others)]


def test_a_field_is_read_with_its_unknown_bare_in_equations_and_at_points_elsewhere():
    model = load(field())
    (w,) = model.fields
    assert (w.name, w.unknowns, w.start, w.end) == ("w", ("w",), Number(Fraction(0)), Name("l"))
    kept = [n for n in names(w.equations[0]) if isinstance(n, Derivative) or n == Name("w")]
    assert kept == [Derivative("w", 4), Name("w")]
    assert w.conditions[3].left == Call("w", Name("l"), 3)
    assert model.outputs[0].expression == Call("w", Name("l"), 0)
    assert scope_of(model).unknowns == {"w": "w"}


def test_a_model_with_a_field_is_distributed_and_keeps_its_symbols():
    model = load(field())
    assert model.is_distributed
    assert with_numbers(model) is model


def test_one_equation_may_be_given_as_a_string():
    text = field().replace("equations = [", "equation = ").replace('= 0"]\ncond', '= 0"\ncond')
    assert load(text).fields == load(field()).fields


def test_a_length_may_be_a_quantity():
    (w,) = load(
        field(["w(0) = 0", "w'(0) = F"], ["a*w'' = s^2*w"], ("0", "150 mm")),
        rest=REST.replace("w(l)", "w(0.15)"),
    ).fields
    assert w.end == Number(Fraction(3, 20))


def test_label_and_remark_are_kept():
    (w,) = load(field() + "latex = 'w_b'\ndoc = \"bending\"\n").fields
    assert (w.latex, w.doc) == ("w_b", "bending")


def test_an_unknown_may_bear_the_name_of_a_node():
    elements = '[elements]\nM = { type = "mass", at = "w", m = "3 kg" }\n'
    rest = '[inputs]\nF = { force = "w" }\n[outputs]\nX = "w"\nY = "w(l)"\n'
    model = load(field(), elements, rest=rest)
    assert [format_expression(o.expression) for o in model.outputs] == ["w", "w(l)"]


NODE = '[elements]\nM = { type = "mass", at = "p", m = "3 kg" }\n'
SPRING = 'K = { type = "spring", between = ["p", "ground"], k = "5 N/m" }\n'
ACCEPTED = {
    "a signal with the name of an unknown, fed back": (
        field([*FREE[:1], "E*I*w'''(0) = F - w", *FREE[2:]]),
        '[signals]\nw = "3*w(l)"\n',
    ),
    "inputs and signals as loads along x": (
        field(equations=["E*I*w'''' + rho*A*s^2*w = q/l + F/l"]),
        '[signals]\nq = "2*F"\n',
    ),
    "nodes and quantities of elements in a condition": (
        field(["w(0) = 0", "w'(0) = 0", "w''(l) = 0", "E*I*w'''(l) = M.f + K.f + 5*a*p - F"]),
        NODE + SPRING,
    ),
    "parameters without units": (field(equations=["a*w'''' + rho*A*s^2*w = 0"]),),
    "conditions of equal left sides and other nodes": (
        field(["w(0) = 0", "w'(0) = 0", "w(l) = 0", "w(l) = p"]),
        NODE,
    ),
    "conditions that only look alike": (
        field(["w(0) = 0", "w'(0) = 0", "w(l) + a*w'(l) = 0", "w(l) + l*w'(l) = F/E/l"]),
    ),
}


def test_what_a_field_may_hold_is_accepted():
    for what, parts in ACCEPTED.items():
        assert load(*parts).fields, what


def test_a_field_s_unknown_is_measured_by_its_conditions():
    # E I w''' is a force when w is a length: N = Pa m^4 m^-3 [w].
    units = dict(load(field()).signal_units)
    assert units[Variable("field", "w")] == unit_of("m").dimension


def test_the_mobility_of_a_beam_is_metres_per_newton_second_whatever_w_is():
    rest = '[inputs]\nF = {}\n[outputs]\nV = "s*w(0)"\n'
    quotients = dict(load(field(), rest=rest).quotients)
    assert quotients["V", "F"] == unit_of("m/(N*s)").dimension


def test_an_equation_of_terms_in_different_units_is_refused():
    wrong = field(["w'(0) = 0", "w(l) = 0"], ["E*I*w'' + rho*A*s^2*w = 0"])
    assert problems(wrong) == [("SF205", "terms of a sum disagree: E*I*w'' in 'N' and rho*A*s^2*w in 'Pa'")]


def test_as_many_conditions_as_the_order_are_needed():
    for order in (1, 2, 4, 12):
        conditions = ["w(0) = F/a", *(f"w{chr(39) * k}(0) = 0" for k in range(1, order))]
        equations = [f"a*w{chr(39) * order} = s*w"]
        assert load(field(conditions, equations)).fields, order
        ((code, message),) = problems(field(conditions[:-1], equations))
        assert (code, f"for order {order} in x: one is missing" in message) == ("SF243", True), order


def test_the_orders_of_a_system_add_up():
    equations = ["a*(w'' - phi') = s^2*w", "a*phi'' + b*(w' - phi) = s^2*phi"]
    conditions = ["w(0) = F", "phi(0) = 0", "phi'(l) = 0", "w'(l) - phi(l) = 0"]
    assert load(field(conditions, equations, name="beam", unknowns=["w", "phi"])).fields
    ((code, message),) = problems(field(conditions[:3], equations, name="beam", unknowns=["w", "phi"]))
    assert (code, message) == (
        "SF243",
        "field 'beam' has 3 conditions for order 4 in x: one is missing, likely at l",
    )


def test_a_first_order_system_is_read():
    equations = ["u' = f/(E*A)", "f' = rho*A*s^2*u"]
    text = field(["u(0) = 0", "f(l) = F"], equations, name="rod", unknowns=["u", "f"])
    assert load(text, rest=REST.replace("w(l)", "u(l)")).fields[0].unknowns == ("u", "f")


def test_an_unknown_without_a_derivative_adds_no_order():
    equations = ["E*A*v = E*A*w'", "E*A*v' = rho*A*s^2*w"]
    text = field(["w(0) = 0", "E*A*v(l) = F"], equations, name="rod", unknowns=["w", "v"])
    assert load(text).fields


SEGMENT = "E*I*{0}'''' + rho*A*s^2*{0} = 0"
JOINT = ["w1(a) = w2(a)", "w1'(a) = w2'(a)", "w1''(a) = w2''(a)", "E*I*(w1'''(a) - w2'''(a)) = F"]


def system(*equations):
    conditions = [f"{u}(0) = F" for u in ("u", "v", "y")[: len(equations)]]
    return field(conditions, equations, unknowns=("u", "v", "y")[: len(equations)])


def test_equations_that_repeat_one_another_are_refused():
    for equations in [
        ("u' = s*v", "2*u' = 2*s*v"),
        ("u' = s*v", "s*u' - s^2*v = 0"),
        ("a*u' + v' = s*v", "a*v' + a^2*u' = a*s*v"),
        ("u' + v' = s*y", "v' - y' = s*u", "u' + y' = s*(y - u)"),
    ]:
        # The last of the three is the first minus the second.
        unit_free = PARAMETERS.replace('l = "1.2 m"', "l = 1.2")
        assert codes(system(*equations), rest=REST.replace("w(l)", "u(l)"), parameters=unit_free) == [
            "SF242"
        ], equations


def test_equations_that_differ_in_their_load_contradict_one_another():
    ((code, message),) = problems(
        system("a*u' = s*v + s*F", "2*a*u' = 2*s*v"), rest=REST.replace("w(l)", "u(l)")
    )
    assert (code, message) == ("SF242", "this equation contradicts 'a*u' = s*v + s*F' (line 12)")


def test_equations_that_only_look_alike_are_kept():
    rest = '[inputs]\nF = {}\n[outputs]\nX = "u(l)"\n'
    parameters = "symflex = 1\n[parameters]\na = {}\nb = {}\nl = {}\n"
    assert load(system("u' = a*v", "2*u' = b*v + v'"), rest=rest, parameters=parameters).fields


def segments(first, second):
    rest = REST.replace("w(l)", "w2(l)")
    one = field(first, [SEGMENT.format("w1")], ("0", "a"), "w1")
    other = field(second, [SEGMENT.format("w2")], ("a", "l"), "w2")
    return (one, other), {"rest": rest}


def test_fields_joined_by_conditions_are_counted_together():
    parts, others = segments(["w1(0) = 0", "w1'(0) = 0"], [*JOINT, "w2''(l) = 0", "w2'''(l) = 0"])
    assert len(load(*parts, **others).fields) == 2


def test_a_condition_missing_at_a_joint_is_missed_there():
    parts, others = segments(["w1(0) = 0", "w1'(0) = 0"], [*JOINT[:3], "w2''(l) = 0", "w2'''(l) = 0"])
    ((_, message),) = problems(*parts, **others)
    assert (
        message
        == "fields 'w1', 'w2' together have 7 conditions for order 8 in x: one is missing, likely at a"
    )


def test_all_conditions_may_stand_in_one_of_the_joined_fields():
    parts, others = segments([], ["w1(0) = 0", "w1'(0) = 0", *JOINT, "w2''(l) = 0", "w2'''(l) = 0"])
    assert len(load(*parts, **others).fields) == 2


def test_a_condition_in_other_words_is_a_repetition():
    conditions = ["w(0) = 0", "w'(0) = 0", "a*w''(l) = F", "2*a^2*w''(l)/a = 2*F"]
    ((code, message),) = problems(field(conditions))
    assert (code, message.partition(" (")[0]) == ("SF244", "this condition repeats 'a*w''(l) = F'")


def test_a_definition_does_not_hide_a_repetition():
    definitions = '[definitions]\nh = "l/2"\n'
    conditions = ["w(0) = 0", "w'(0) = 0", "w(h) = 0", "w(l/2) = 0"]
    assert codes(field(conditions), definitions) == ["SF244"]


def test_conditions_of_equal_left_sides_and_other_inputs_contradict():
    conditions = ["w(0) = 0", "w'(0) = 0", "w''(l) = 0", "w''(l) = F/E/A/l"]
    ((code, message),) = problems(field(conditions))
    assert (code, message.partition(" (")[0]) == ("SF244", "this condition contradicts 'w''(l) = 0'")


def test_a_point_that_may_lie_in_the_domain_is_accepted():
    for point in ["l", "l/2", "0", "a", "l - a", "b", "pi*l/4", "0.5*l + 0.1*l", "sqrt(a)"]:
        assert load(field(), rest=REST.replace("w(l)", f"w({point})")).outputs, point


def test_a_point_outside_the_domain_is_refused():
    for point in ["2*l", "-l/2", "-a", "l + a", "1.3", "pi*l/3", "l*l/l + a", "-0.001", "D"]:
        definitions = '[definitions]\nD = "1.01*l"\n'
        assert codes(field(), definitions, rest=REST.replace("w(l)", f"w({point})")) == ["SF240"], point


AT_POINT = REST.replace("w(l)", "POINT")
REFUSED = {
    "an order beyond twelve": ("SF103", [field(equations=["a*w" + "'" * 13 + " = s*w"])], REST),
    "a point in a signal outside the domain": ("SF240", [field(), '[signals]\ne = "w(2*l)"\n'], REST),
    "a derivative at a point beyond order 24": (
        "SF103",
        [field()],
        AT_POINT.replace("POINT", "w" + "'" * 25 + "(l)"),
    ),
    "a point that varies in time": ("SF212", [field()], AT_POINT.replace("POINT", "w(F)")),
    "more than two hundred conditions": ("SF103", [field(["w(0) = 0"] * 201)], REST),
    "a field with a mistake, once, not where it is used": ("SF206", [field(domain=("0",))], REST),
}


def test_what_a_field_may_not_hold_is_refused():
    for what, (code, parts, rest) in REFUSED.items():
        assert codes(*parts, rest=rest) == [code], what


def test_more_than_a_hundred_fields_or_twelve_unknowns_are_refused():
    many = "".join(field([f"v{i}(0) = 0"], [f"v{i}' = s*v{i}"], name=f"v{i}") for i in range(101))
    assert "SF103" in codes(many, rest=AT_POINT.replace("POINT", "v0(l)"))
    unknowns = [f"u{i}" for i in range(13)]
    system = field([], [f"{u}' = s*{u}" for u in unknowns], name="f", unknowns=unknowns)
    assert set(codes(system, rest=AT_POINT.replace("POINT", "u0(l)"))) == {"SF103"}


def test_a_point_outside_a_symbolic_domain_is_refused():
    parameters = PARAMETERS.replace('"1.2 m"', "{}")
    for point in ["3*l/2", "-l"]:
        assert codes(field(), rest=AT_POINT.replace("POINT", f"w({point})"), parameters=parameters) == [
            "SF240"
        ], point


def test_a_derivative_at_a_point_may_be_of_order_24():
    assert load(field(), rest=AT_POINT.replace("POINT", "w" + "'" * 24 + "(l)")).outputs


def test_a_long_chain_of_definitions_in_a_point_is_answered():
    chain = "".join(f'd{i + 1} = "d{i}*d{i}"\n' for i in range(300))
    definitions = f'[definitions]\nd0 = "1e200*l"\n{chain}'
    assert load(
        field(),
        definitions,
        rest=REST.replace("w(l)", "w(d300)"),
        parameters=PARAMETERS.replace('"1.2 m"', "{}"),
    )


def test_every_problem_of_a_field_is_reported_at_once():
    wrong = field(["w(0) = 1", "w'(2*l) = 0"], ["E*I*w'''' + c*w = 0"])
    assert codes(wrong) == ["SF210", "SF221", "SF240"]


BEAM = """[elements]
arm = {{ type = "beam", between = ["hub", "tip"], E = "E", I = "I", rho = "rho", A = "A", l = "l"{0} }}
hold = {{ type = "fixed", at = "hub" }}
"""
AT_TIP = '[inputs]\nF = { force = "tip" }\n[outputs]\nX = "tip"\n'


def test_a_beam_has_the_theory_it_is_given_or_euler_and_bernoulli_s_without_shear():
    model = load(BEAM.format(""), rest=AT_TIP)
    assert model.is_distributed
    assert {n.name: n.domain for n in model.nodes} == {"hub": "planar", "tip": "planar"}
    arm = model.elements[0]
    assert arm.choices == (("theory", "euler-bernoulli"),)
    assert not {"kappa", "G"} & dict(arm.values).keys()
    arm = load(BEAM.format(', theory = "timoshenko", kappa = 0.85, G = "26 GPa"'), rest=AT_TIP).elements[0]
    assert dict(arm.choices)["theory"] == "timoshenko"
    assert {"kappa", "G", "N"} <= dict(arm.values).keys()


DELAY = '[blocks]\nD = { type = "delay", T = "a" }\n'
DELAYED = '[inputs]\nU = { unit = "V" }\n[outputs]\nX = "D*U"\n'


def test_a_delay_is_distributed_a_pure_number_and_takes_seconds():
    model = load(DELAY, rest=DELAYED)
    assert model.is_distributed
    assert model.outputs[0].dimension == unit_of("V").dimension
    assert {p.name: p.unit for p in model.parameters}["a"] == "s"


def test_a_published_formula_keeps_functions_of_s_and_abbreviations():
    published = """[published."X/F"]
expr = "exp(-sqrt(T*p))*S/(C + s)"
where = { S = "exp(-q)*sin(q)", C = "exp(-q)*cos(q)", q = "sqrt(T*p)", p = "s/a", T = "l^2/2" }
scale = "1/(rho*A*a)"
source = "section 1"
"""
    (found,) = load(field(), rest=REST + published).published
    assert [name for name, _ in found.where] == ["S", "C", "q", "p", "T"]
    assert found.expression.span.text == "exp(-sqrt(T*p))*S/(C + s)"


def test_an_abbreviation_cannot_be_called_as_the_laplace_variable():
    published = '[published."X/F"]\nexpr = "1/s"\nwhere = { s = "2" }\n'
    assert codes(field(), rest=REST + published) == ["SF213"]


HOSTILE = {
    "a call into Python": "__import__('os').system('true')", "an empty text": "", "only an equals sign": "=",
    "an equation of nothing": "0 = 0", "primes alone": "'''' = ''", "a derivative of a number": "3''(0) = 0",
    "a derivative of a derivative": "w'(0)'(0) = 0", "a field at a field": "w(w(0)) = 0",
    "a field at two points": "w(0, l) = 0", "division by a field": "1/w(0) = F",
    "division by zero": "w(0)/0 = F", "a point at infinity": "w(1/0) = 0",
    "a point that is a huge power": "w(l^64^64) = 0",
    "a hundred thousand parentheses": "(" * 100_000 + "w(0)" + ")" * 100_000 + " = 0",
    "ten thousand primes": "w" + "'" * 10_000 + "(0) = 0", "a right-to-left override": "w\u202e(0) = 0",
    "a NUL": "w\\u0000(0) = 0",
}  # fmt: skip


def test_a_hostile_condition_or_equation_is_refused():
    for case, text in HOSTILE.items():
        assert codes(field([*FREE[:3], text])), case
        assert codes(field(equations=[text])), case


def test_a_hostile_end_of_a_domain_is_refused():
    for text in ["", "F", "w(0)", "s", "1/0", "0 = l", "(" * 200, "l'", "1e999999999"]:
        assert codes(field(domain=("0", text))), text


def test_a_value_of_the_wrong_kind_is_refused():
    for value in ["1", "true", "{}", "[[]]", "[1]", "nan", "1979-05-27", "[{}]"]:
        for key in ["domain", "equation", "unknowns", "conditions", "latex", "doc"]:
            lines = [
                x for x in field().replace("equations", "equation").replace('= ["E*', '= "E*').splitlines()
            ]
            text = "\n".join(x for x in lines if not x.startswith(f"{key} ")).replace(
                '= 0"]\ncond', '= 0"\ncond'
            )
            assert codes(f"{text}\n{key} = {value}\n"), (value, key)
