"""What is said of singular systems: what floats, what is redundant, which loop is algebraic."""

from dataclasses import replace

import pytest

from symflex import pipeline
from symflex.equations.elimination import is_singular
from symflex.equations.elimination.singular import explain_singular, listed
from symflex.errors import ModelError

HEADER = "symflex = 1\n[parameters]\n"
MASS = 'M = { type = "mass", at = "x", m = "m" }\n'
SINGULAR = {
    "a node between two massless links to nowhere": (
        'm = {}\nk = {}\n[elements]\nK = { type = "spring", between = ["a", "c"], k = "k" }\n',
        '[inputs]\nF = { force = "a" }\n[outputs]\nX = "a"\n',
        "SF301",
        ("'a'", "'c'"),
    ),
    "a node held twice": (
        'm = {}\n[elements]\nM = { type = "mass", at = "x", m = "m" }\n'
        'one = { type = "fixed", at = "x" }\ntwo = { type = "fixed", at = "x" }\n',
        '[inputs]\nF = { force = "x" }\n[outputs]\nX = "x"\n',
        "SF302",
        ("'one'", "'two'"),
    ),
    "a clamp that an input moves": (
        "EI = {}\nl = {}\n[elements]\n"
        'arm = { type = "beam", between = ["x", "tip"], EI = "EI", rhoA = 1, l = "l" }\n'
        'held = { type = "fixed", at = "x" }\n',
        '[inputs]\nz = { displacement = "x" }\n[outputs]\nX = "tip"\n',
        "SF302",
        ("'held'", "'z'"),
    ),
    "two voltage sources at one node": (
        'R = {}\n[elements]\nr = { type = "resistor", between = ["a", "ground"], R = "R" }\n'
        'one = { type = "voltage_source", at = "a", v = "U" }\n'
        'two = { type = "voltage_source", at = "a", v = "2*U" }\n',
        '[inputs]\nU = {}\n[outputs]\nX = "a"\n',
        "SF302",
        ("'one'", "'two'"),
    ),
    "an algebraic loop of gain one": (
        "k = {}\n",
        '[signals]\ne = "U + e"\n[inputs]\nU = {}\n[outputs]\nX = "e"\n',
        "SF303",
        ("'e'",),
    ),
    "an algebraic loop of gain one through two signals": (
        "k = {}\n",
        '[signals]\ne = "U + g/k"\ng = "k*e"\n[inputs]\nU = {}\n[outputs]\nX = "e"\n',
        "SF303",
        ("'e'", "'g'"),
    ),
    "a loop of gain one through a definition": (
        "k = {}\n",
        '[definitions]\nZ = "k/k"\n[signals]\ne = "U + Z*e"\n[inputs]\nU = {}\n[outputs]\nX = "e"\n',
        "SF303",
        ("'e'",),
    ),
}


def refused(text):
    model = pipeline.loads(text)
    with pytest.raises(ModelError) as caught:
        pipeline.derive_all(model)
    (problem,) = caught.value.diagnostics
    return problem


def test_a_singular_system_is_explained():
    for name, (head, tail, code, named) in SINGULAR.items():
        problem = refused(HEADER + head + tail)
        assert problem.code == code, name
        assert all(n in problem.message for n in named), name
        assert problem.span is not None, name
        assert is_singular(pipeline.assemble(pipeline.loads(HEADER + head + tail))), name


LOOP = "the loop through {} is algebraic and has no unique solution: its gain is exactly one"
SAID = {
    "a node between two massless links to nowhere": (
        "nothing determines nodes 'a' and 'c': they float",
        "connect them to ground or give them a mass",
        "a",
    ),
    "a node held twice": (
        "the constraints of 'one' and 'two' repeat or contradict each other",
        "remove one of them",
        "two",
    ),
    "a clamp that an input moves": (
        "the constraints of 'held' and 'z' repeat or contradict each other",
        'hold only what no input moves, as in at = "base.theta"',
        "z",
    ),
    "an algebraic loop of gain one": (
        LOOP.format("signal 'e'"),
        "put a dynamic element or another gain into the loop",
        "e",
    ),
    "an algebraic loop of gain one through two signals": (
        LOOP.format("signals 'e' and 'g'"),
        "put a dynamic element or another gain into the loop",
        "e",
    ),
}


def test_what_makes_a_system_singular_is_said_in_a_sentence_with_a_way_out():
    for name, (message, hint, place) in SAID.items():
        head, tail, code, _ = SINGULAR[name]
        problem = refused(HEADER + head + tail)
        assert (problem.code, problem.message, problem.hint) == (code, message, hint), name
        assert place in problem.span.text, name


def test_names_are_listed_as_in_a_sentence():
    for names, sentence in [
        ([], "the system"),
        (["a"], "a"),
        (["a", "b"], "a and b"),
        (["a", "b", "c"], "a, b and c"),
        (list("abcdef"), "a, b, c, d, e and f"),
        (list("abcdefg"), "a, b, c, d, e, f and 1 more"),
        (list("abcdefghi"), "a, b, c, d, e, f and 3 more"),
    ]:
        assert listed(names) == sentence, names


def test_a_loop_with_another_gain_is_solved():
    text = f'{HEADER}k = {{}}\n[signals]\ne = "U + k*e"\n[inputs]\nU = {{}}\n[outputs]\nX = "e"\n'
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    assert str(tf.ratio) in ("-1*(k - 1)^-1", "(k - 1)^-1*-1")


LOOSE = """symflex = 1
parameters = { m = "1 kg", k = "2 N/m" }
inputs = { r = {} }
outputs = { X = "x" }
[elements]
a = { type = "mass", at = "x", m = "m" }
b = { type = "mass", at = "x_tip", m = "m" }
c = { type = "spring", between = ["x", "x_tip"], k = "k" }
d = { type = "force_source", at = "NODE", f = "k*r" }
"""


def test_a_floating_node_that_one_element_touches_is_compared_with_the_others():
    for node, meant in [("X", "x"), ("x_tpi", "x_tip"), ("gruond", "ground")]:
        problem = refused(LOOSE.replace("NODE", node))
        assert problem.code == "SF301", node
        assert problem.hint.startswith(f"did you mean '{meant}'?"), node


# ------------------------------------------------------------------------- fields and what they stand in

STRINGS = HEADER + "T = {}\nmu = {}\nl = {}\nk = {}\n"
ENDS = '[inputs]\nF = {}\n[outputs]\nX = "w(l)"\n'
ALWAYS = "T*w''(l) = mu*s^2*w(l)"
TURNED = ("u(0) = w(l)", "u'(0) = -w'(l)", "w(0) = u(l) + F", "w'(0) = -u'(l)")
"""u(x) = w(l - x) at one end; that it is so at the other too follows by cosh^2 - sinh^2 = 1."""


def string(name, conditions):
    """Return the field of a string, T w'' = mu s^2 w."""
    listed_conditions = ", ".join(f'"{c}"' for c in conditions)
    equation = f"T*{name}'' - mu*s^2*{name} = 0"
    return (
        f'[fields.{name}]\ndomain = ["0", "l"]\nequation = "{equation}"\nconditions = [{listed_conditions}]\n'
    )


def what_is_wrong(text):
    """Return the explanation of a system that is singular."""
    equations = pipeline.assemble(pipeline.loads(text))
    assert is_singular(equations)
    (problem,) = explain_singular(equations).diagnostics
    return problem


def test_a_condition_that_the_field_fulfils_anyway_is_named():
    found = what_is_wrong(STRINGS + string("w", ["w(0) = F", ALWAYS]) + ENDS)
    assert (found.code, found.message, found.hint, found.span.text) == (
        "SF302",
        f"the condition '{ALWAYS}' of field 'w' always holds: one is missing in its place",
        "replace one of them by an independent condition",
        ALWAYS,
    )


def test_conditions_that_follow_from_each_other_are_named_with_their_fields():
    found = what_is_wrong(STRINGS + string("u", TURNED[:2]) + string("w", TURNED[2:]) + ENDS)
    first, second, third, last = (f"'{c}'" for c in TURNED)
    assert (found.code, found.message, found.hint, found.span.text) == (
        "SF302",
        f"the conditions {first}, {second}, {third} and {last} of fields 'u' and 'w' repeat or contradict "
        "each other: the state is not determined",
        "replace one of them by an independent condition",
        TURNED[3],
    )


def test_a_string_is_determined_by_a_condition_at_each_end():
    for conditions, fails in [
        (["w(0) = F", "w(l) = 0"], False),
        (["w(0) = F", ALWAYS], True),
        (["w'(0) = 0", "T*w'(l) = F"], False),
    ]:
        assert (
            is_singular(pipeline.assemble(pipeline.loads(STRINGS + string("w", conditions) + ENDS))) is fails
        ), conditions


def test_a_loop_next_to_a_field_has_the_gain_that_its_definitions_say():
    for offset, gain_is_one in [(1, True), (2, False)]:
        loop = f'[definitions]\nY = "k + {offset}"\nZ = "(Y - 1)/k"\n[signals]\ne = "F + Z*e"\n'
        text = STRINGS + loop + string("w", ["w(0) = 0", "w(l) = e"]) + ENDS
        if gain_is_one:
            found = what_is_wrong(text)
            assert (found.code, found.message) == ("SF303", LOOP.format("signal 'e'")), offset
        else:
            assert not is_singular(pipeline.assemble(pipeline.loads(text))), offset


@pytest.mark.slow
def test_a_node_that_floats_is_found_where_no_prime_field_holds_every_wavenumber():
    # Fourth roots of this many independent quantities are not in one of 400 fields together.
    beams = "".join(
        f'b{i} = {{ type = "beam", between = ["p{i}", "p{i + 1}"], E = "T", I = "{p}", A = "k", rho = "mu", '
        'l = "l" }\n'
        for i, p in enumerate(range(2, 8))
    )
    loose = 'K = { type = "spring", between = ["y", "z"], k = "k" }\n'
    rest = '[inputs]\nF = { force = "p0" }\n[outputs]\nX = "p6"\n'
    found = what_is_wrong(f"{STRINGS}[elements]\n{beams}{loose}{rest}")
    assert found.message == "nothing determines nodes 'y' and 'z': they float"
    assert not is_singular(pipeline.assemble(pipeline.loads(f"{STRINGS}[elements]\n{beams}{rest}")))


# ------------------------------------------------------------------------------------------- what is left


def test_one_node_that_floats_is_told_in_the_singular():
    found = what_is_wrong(
        f'{HEADER}m = {{}}\n[elements]\n{MASS}f = {{ type = "force_source", at = "v", f = "F" }}\n'
        '[inputs]\nF = {}\n[outputs]\nX = "x"\n'
    )
    assert found.message == "nothing determines node 'v': it floats"
    assert found.hint == "connect it to ground or give it a mass"


def test_a_name_that_one_element_touches_may_be_meant_as_it_is():
    found = what_is_wrong(
        f'{HEADER}m = {{}}\n[elements]\n{MASS}f = {{ type = "force_source", at = "X", f = "F" }}\n'
        '[inputs]\nF = {}\n[outputs]\nX_x = "x"\n'
    )
    assert found.hint == "did you mean 'x'? else connect it to ground or give it a mass"


def test_an_input_at_a_name_that_no_element_touches_is_told_the_nearest_alone():
    found = what_is_wrong(
        f'{HEADER}m = {{}}\n[elements]\n{MASS}[inputs]\nF = {{ force = "X" }}\n[outputs]\nY = "x"\n'
    )
    assert found.hint == "did you mean 'x'?"


def test_an_unknown_without_an_equation_is_named_where_it_is_defined():
    text = f'{HEADER}k = {{}}\n[signals]\ne = "U"\ng = "k*U"\n[inputs]\nU = {{}}\n[outputs]\nX = "e + g"\n'
    equations = pipeline.assemble(pipeline.loads(text))
    (problem,) = explain_singular(replace(equations, rows=equations.rows[:1])).diagnostics
    assert (problem.code, problem.message) == ("SF304", "nothing determines 'g'")
    assert problem.span.text == "g"


def test_as_many_equations_as_unknowns_are_needed():
    for kept in [0, 1]:
        text = (
            f'{HEADER}k = {{}}\n[signals]\ne = "U"\ng = "k*U"\n[inputs]\nU = {{}}\n[outputs]\nX = "e + g"\n'
        )
        equations = pipeline.assemble(pipeline.loads(text))
        assert not is_singular(equations), kept
        assert is_singular(replace(equations, rows=equations.rows[:kept])), kept


def test_an_algebraic_loop_is_pointed_at_where_an_element_bears_the_same_name():
    text = (
        'symflex = 1\nsignals = { a = "b", b = "a" }\ninputs.F = { force = "x" }\noutputs.X = "x"\n'
        '[elements]\na = { type = "mass", at = "x", m = "1 kg" }\n'
    )
    with pytest.raises(ModelError) as raised:
        pipeline.derive_all(pipeline.loads(text))
    (found,) = raised.value.diagnostics
    assert (found.code, found.span.line) == ("SF303", 2)


ACTUATED = (
    'symflex = 1\nparameters = { m = "1 kg", k = "100 N/m", c = "2 N*s/m", d = "1 m" }\n'
    'inputs.r = { force = "x" }\noutputs.X = "x"\n'
)
WITH_MASS = '[elements]\nbody = { type = "mass", at = "x", m = "m" }\n'
ON_SPRING = '[elements]\nwall = { type = "spring", between = ["x", "ground"], k = "k" }\n'
ON_BEAM = (
    '[elements]\narm = { type = "beam", between = ["base", "tip"], EI = "k*d^3", rhoA = "m/d", l = "d" }\n'
    'base = { type = "fixed", at = "base" }\nload = { type = "spring", between = ["tip.y", "x"], k = "k" }\n'
)
PUSH = 'push = {{ type = "force_source", at = "x", f = "{}" }}\n'


def test_a_loop_of_signals_is_named_though_nodes_follow_from_them():
    # One solution of each loop is free: its gain is one. Everything that u pushes is free with it, yet held.
    for parts, signals, through in [
        (WITH_MASS, 'u = "v"\nv = "u"', "signals 'u' and 'v'"),
        (ON_BEAM, 'u = "v"\nv = "u"', "signals 'u' and 'v'"),
        (WITH_MASS, 'u = "w"\nv = "u"\nw = "v"', "signals 'u', 'v' and 'w'"),
        (WITH_MASS, 'u = "2*v"\nv = "w/6"\nw = "3*u"', "signals 'u', 'v' and 'w'"),
        (WITH_MASS, 'u = "k*x + v"\nv = "u - k*x"', "signals 'u' and 'v'"),
        (WITH_MASS, 'u = "u"', "signal 'u'"),
        (ON_SPRING, 'u = "k*x"', "force_source 'push', signal 'u' and node 'x'"),
    ]:
        found = what_is_wrong(f"{ACTUATED}{parts}{PUSH.format('u')}[signals]\n{signals}\n")
        assert (found.code, found.message) == ("SF303", LOOP.format(through)), signals
        assert found.hint == "put a dynamic element or another gain into the loop", signals


def test_a_source_that_balances_its_node_is_a_loop_and_no_floating_node():
    found = what_is_wrong(ACTUATED + ON_SPRING + PUSH.format("k*x"))
    assert (found.code, found.message) == ("SF303", LOOP.format("force_source 'push' and node 'x'"))


def test_a_loop_of_gain_one_with_dynamics_is_not_called_algebraic():
    loop = '[signals]\nu = "(0.1*s + 1)*v"\nv = "u/(1 + 0.1*s)"\n'
    found = what_is_wrong(ACTUATED + WITH_MASS + PUSH.format("u") + loop)
    said = "the loop through signals 'u' and 'v' has no unique solution: its gain is exactly one"
    assert (found.code, found.message, found.hint) == ("SF303", said, "put another gain into the loop")


def test_of_a_node_that_floats_and_one_that_follows_from_it_the_first_is_named():
    loose = 'link = { type = "spring", between = ["p", "q"], k = "k" }\n'
    found = what_is_wrong(f'{ACTUATED}{WITH_MASS}{loose}{PUSH.format("u")}[signals]\nu = "k*p"\n')
    assert found.message == "nothing determines nodes 'p' and 'q': they float"


def test_a_loop_that_only_its_definitions_close_is_refused_though_the_output_does_not_see_it():
    loop = '[definitions]\na = "k/c"\n[signals]\nu = "a*v"\nv = "u*c/k"\n'
    for parts in (WITH_MASS, ON_BEAM):
        assert refused(ACTUATED + parts + PUSH.format("u") + loop).code == "SF303", parts
