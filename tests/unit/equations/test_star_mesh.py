"""Straight-line programs of networks: their values, their size, and what singular systems say."""

from dataclasses import replace
from fractions import Fraction
from random import Random

import pytest
from flint import fmpq, fmpq_mat

from benchmarks.networks import NETWORKS, chain, network, tree
from symflex import pipeline
from symflex.algebra.straight_line import ONE, Step
from symflex.equations import assemble
from symflex.equations.elimination import expanded_terms, is_singular
from symflex.equations.elimination.star_mesh import eliminate
from symflex.errors import ModelError
from tests.contract.exact import value_in_ring


def value(program, step, given):
    """Return a step in exact rational arithmetic, by recurrence over all steps before it."""
    values = []
    for kind, args in zip(program.kinds, program.operands, strict=True):
        inner = [values[x] for x in args] if kind not in (0, 1, 6) else []
        match Step(kind):
            case Step.GENERATOR:
                found = given[program.names[args[0]]]
            case Step.NUMBER:
                found = Fraction(*args)
            case Step.ADD:
                found = sum(inner)
            case Step.MULTIPLY:
                found = Fraction(1)
                for x in inner:
                    found *= x
            case Step.DIVIDE:
                found = inner[0] / inner[1]
            case Step.NEGATE:
                found = -inner[0]
            case Step.POWER:
                found = values[args[0]] ** args[1]
        values.append(found)
    return values[step]


def numbers(names):
    """Return a different positive rational per name."""
    return {name: Fraction(3 + (7 * i) % 23, 2 + (5 * i) % 11) for i, name in enumerate(names)}


def dense_response(branches, given):
    """Return all displacements per force on the first mass, from the dense matrix in exact arithmetic."""
    size = max(map(max, branches))
    s = given["s"]
    a = [[Fraction(0)] * size for _ in range(size)]
    for i in range(size):
        a[i][i] += given[f"m_{i + 1}"] * s**2
    for number, (p, q) in enumerate(branches, 1):
        w = given[f"k_{number}"] + given[f"b_{number}"] * s
        for i, j, sign in ((p, p, 1), (q, q, 1), (p, q, -1), (q, p, -1)):
            a[i - 1][j - 1] += sign * w
    matrix = fmpq_mat(size, size, [fmpq(x.numerator, x.denominator) for row in a for x in row])
    right = fmpq_mat(size, 1, [1] + [0] * (size - 1))
    found = matrix.solve(right)
    return [Fraction(int(found[i, 0].p), int(found[i, 0].q)) for i in range(size)]


PAIRS = [("X_first", "F"), ("X_last", "F")]


def test_a_network_responds_as_its_dense_matrix_does():
    for kind in NETWORKS:
        for is_sparse in [True, False]:
            branches = NETWORKS[kind](16)
            equations = assemble(network(branches), is_sparse=is_sparse)
            found = eliminate(equations, PAIRS)
            given = numbers(equations.ring.names)
            expected = dense_response(branches, given)
            for (num, den), wanted in zip(found.quotients, (expected[0], expected[-1]), strict=True):
                assert value(found.program, num, given) / value(found.program, den, given) == wanted, (
                    kind,
                    is_sparse,
                )


def test_a_chain_is_the_recurrence_of_holzer():
    """Z_N = m_N s^2; towards the force, Z_i = m_i s^2 + w_i Z/(w_i + Z); X_1/F = 1/Z_1."""
    equations = assemble(network(chain(9)), is_sparse=True)
    found = eliminate(equations, PAIRS)
    given = numbers(equations.ring.names)
    s, impedance, transfer = given["s"], Fraction(0), Fraction(1)
    for i in range(9, 0, -1):
        if i < 9:
            w = given[f"k_{i}"] + given[f"b_{i}"] * s
            transfer *= w / (w + impedance)
            impedance = w * impedance / (w + impedance)
        impedance += given[f"m_{i}"] * s**2
    (above, below), (above_last, below_last) = found.quotients
    assert above == ONE
    assert value(found.program, below, given) == impedance
    assert value(found.program, above_last, given) == transfer
    assert below_last == below


def test_nothing_is_subtracted_in_a_network_of_positive_elements():
    for kind, make in NETWORKS.items():
        found = eliminate(assemble(network(make(25)), is_sparse=True), PAIRS)
        used = found.program.steps_of(*(x for pair in found.quotients for x in pair))
        assert not any(found.program.kinds[i] == Step.NEGATE for i in used), kind


def size_of(branches):
    found = eliminate(assemble(network(branches), is_sparse=True), PAIRS[:1])
    return found.program.size(*found.quotients[0])


def star(n):
    """Return the branches of a mass with all others around it."""
    return [(1, i) for i in range(2, n + 1)]


def test_a_network_without_rings_needs_seven_operations_a_mass():
    # b s + k, m s^2, Z + w, w/(Z + w), that times Z, and the sum: 7 with s^2 shared.
    for make in (chain, tree, star):
        assert size_of(make(40)) == 7 * 40 - 5, make


def test_the_terms_of_a_chain_are_counted_by_fibonacci():
    """The spanning forests of a chain: its determinant in w and m has F(2n) terms."""
    for is_sparse in [True, False]:
        for n, terms in [(2, 3), (3, 8), (6, 144), (12, 46368)]:
            equations = assemble(network(chain(n)), is_sparse=is_sparse)
            assert expanded_terms(equations, eliminate(equations, PAIRS[:1])) == pytest.approx(
                terms, rel=1e-9
            ), (is_sparse, n)


FLOATING = """
symflex = 1
parameters = { m = {}, k = {} }
elements.body = { type = "mass", at = "x", m = "m" }
elements.spring = { type = "spring", between = ["y", "z"], k = "k" }
inputs.F = { force = "x" }
outputs.X = "x"
"""

ALGEBRAIC = """
symflex = 1
inputs.u = {}
signals.a = "b + u"
signals.b = "a"
outputs.y = "a"
"""


ITSELF = ALGEBRAIC.replace("b + u", "a + u")


def test_a_singular_system_is_explained():
    for text, code in [(FLOATING, "SF301"), (ALGEBRAIC, "SF303"), (ITSELF, "SF303")]:
        model = pipeline.loads(text)
        with pytest.raises(ModelError) as caught:
            pipeline.derive_nested(model)
        assert caught.value.diagnostics[0].code == code, text


def test_a_large_singular_system_names_what_floats(monkeypatch):
    monkeypatch.setattr("symflex.equations.elimination.star_mesh.EXPLAINED", 2)
    with pytest.raises(ModelError) as caught:
        pipeline.derive_nested(pipeline.loads(FLOATING))
    assert caught.value.diagnostics[0].code == "SF304"
    assert "'z'" in caught.value.diagnostics[0].message or "'y'" in caught.value.diagnostics[0].message


# ------------------------------------------------------------- against the equations solved as they stand


def solved(equations, given):
    """Return every output per input, and the determinant, from the dense matrix in exact arithmetic."""
    for name, value_of_it in equations.definitions:
        given[name] = value_in_ring(value_of_it, given)
    columns = {v: i for i, v in enumerate((*equations.unknowns, *equations.inputs))}
    size = len(equations.unknowns)
    table = [[Fraction(0)] * len(columns) for _ in range(size + len(equations.outputs))]
    for row, form in zip(table, [r.form for r in (*equations.rows, *equations.outputs)], strict=True):
        for variable, coefficient in form.terms:
            row[columns[variable]] += value_in_ring(coefficient, given)
    a = fmpq_mat(size, size, [fmpq(x.numerator, x.denominator) for row in table[:size] for x in row[:size]])
    found = {}
    for source in equations.inputs:
        at = columns[source]
        x = a.solve(
            fmpq_mat(size, 1, [fmpq(-row[at].numerator, row[at].denominator) for row in table[:size]])
        )
        states = [Fraction(int(x[i, 0].p), int(x[i, 0].q)) for i in range(size)]
        for out, row in zip(equations.outputs, table[size:], strict=True):
            total = sum((c * y for c, y in zip(row, states, strict=False)), row[at])
            found[out.name, source.owner] = total / value_in_ring(out.divisor, given)
    det = a.det()
    return found, Fraction(int(det.p), int(det.q))


def assert_solves(text, pairs=None):
    """Let an elimination for all pairs, and one for each input alone, agree with the dense solution."""
    equations = pipeline.assemble_sparse(pipeline.loads(text))
    given = numbers(equations.ring.names)
    expected, determinant = solved(equations, given)
    for chosen in [
        pairs or list(expected),
        *([p for p in expected if p[1] == i.owner] for i in equations.inputs),
    ]:
        found = eliminate(equations, chosen)
        for pair, (num, den) in zip(chosen, found.quotients, strict=True):
            assert value(found.program, num, given) / value(found.program, den, given) == expected[pair], pair
        product = Fraction(1)
        for pivot in found.pivots:
            product *= value(found.program, pivot, given)
        assert abs(product) == abs(determinant)


HEAD = "symflex = 1\n"
# A motor, a screw and what it moves; links that turn and shift together; a loop; filtered outputs.
MACHINE = """symflex = 1
parameters = { L = {}, R = {}, k_t = {}, k_e = {}, J = {}, r = {}, m = {}, b = {}, k = {}, k_p = {}, T = {} }
[elements]
amplifier = { type = "voltage_source", at = "v", v = "k_p*e" }
rotor = { type = "inertia", at = "shaft", J = "J" }
coupling = { type = "torsion_spring", between = ["shaft", "screw"], k = "k" }
drive = { type = "transformer", from = "screw", to = "x", ratio = "r" }
table = { type = "mass", at = "x", m = "m" }
friction = { type = "damper", between = ["x", "base"], b = "b" }
base = { type = "mass", at = "base", m = "3*m" }
foot = { type = "spring", between = ["base", "ground"], k = "2*k" }
arm = { type = "massless_beam", between = ["p", "q"], EI = "k", l = "r" }
body = { type = "rigid_body", at = "q", m = "m", J = "J", cg = "r" }
overhang = { type = "rigid_link", between = ["q", "t"], length = "r" }
guide = { type = "slider", at = "p" }
link = { type = "spring", between = ["x", "p.y"], k = "k" }
[elements.motor]
type = "dc_motor"
terminals = ["v", "ground"]
shaft = "shaft"
L = "L"
R = "R"
k_t = "k_t"
k_e = "k_e"
[signals]
e = "u - w - x/(T*s + 1)"
w = "k_p*motor.i + T*s*t.y"
[inputs]
u = {}
F = { force = "x" }
G = { force = ["t.y", "base"] }
V = { voltage = "n" }
[outputs]
X = "x"
gap = "x - base"
tilt = "t.theta + q.theta"
filtered = "(u - x)/(T*s + 1)"
error = "e + 2*u"
drawn = "motor.i"
n = "n"
"""
# Two voltages of one circuit, held by sources whose values depend on what flows elsewhere.
CIRCUIT = """symflex = 1
parameters = { R_1 = {}, R_2 = {}, L = {}, C = {}, g = {} }
[elements]
a = { type = "resistor", between = ["v_1", "v_2"], R = "R_1" }
b = { type = "inductor", between = ["v_2", "v_3"], L = "L" }
c = { type = "capacitor", between = ["v_3", "ground"], C = "C" }
d = { type = "resistor", between = ["v_3", "v_1"], R = "R_2" }
held = { type = "voltage_source", at = "v_4", v = "g*b.i" }
moved = { type = "voltage_source", between = ["v_2", "v_4"], v = "U/2 - g*a.i" }
pushed = { type = "current_source", at = "v_1", i = "g*v_3 + I" }
[inputs]
U = {}
I = {}
J = { current = "v_3" }
[outputs]
V_1 = "v_1"
V_3 = "v_3 - R_2*I"
i = "a.i + held.i"
"""


@pytest.mark.slow
def test_a_system_of_many_kinds_of_rows_responds_as_its_equations_say():
    assert_solves(MACHINE)
    assert_solves(CIRCUIT)


def graph(seed):
    """Return signals that depend on each other at random, a unit gain now and then."""
    random = Random(seed)
    size = random.randrange(3, 7)
    lines = []
    for i in range(size):
        others = random.sample([j for j in range(size) if j != i], random.randrange(1, 3))
        terms = [f"{random.choice(['', '-', 'a*', 'T*s*', '-3*', 'b*'])}e{j}" for j in others]
        terms += [f"{random.choice(['', '2*', 'c*'])}{u}" for u in ("u", "w") if random.random() < 0.4]
        if i == 0:
            terms.append("u/(T*s + 1)")
        lines.append(f'e{i} = "{" + ".join(terms)}"')
    outputs = "\n".join(f'y{i} = "a*e{i} - e{(i + 1) % size} + w"' for i in range(size))
    body = "\n".join(lines)
    return (
        f"{HEAD}parameters = {{ a = {{}}, b = {{}}, c = {{}}, T = {{}} }}\n[signals]\n{body}\n"
        f"[inputs]\nu = {{}}\nw = {{}}\n[outputs]\n{outputs}\n"
    )


@pytest.mark.slow
def test_signals_depend_on_each_other_as_their_equations_say():
    for text in map(graph, range(12)):
        if is_singular(pipeline.assemble(pipeline.loads(text))):
            with pytest.raises(ModelError):
                pipeline.derive_nested(pipeline.loads(text))
        else:
            assert_solves(text)


def forced(seed):
    """Return nodes whose balances are not those of branches alone: forces by what other nodes do."""
    random = Random(seed)
    size = random.randrange(3, 7)
    lines = [
        f'm{i} = {{ type = "mass", at = "x{i}", m = "m" }}' for i in range(size) if random.random() < 0.7
    ]
    for i in range(size):
        other = random.choice(["ground", f"x{(i + 1) % size}"])
        lines.append(f'k{i} = {{ type = "spring", between = ["x{i}", "{other}"], k = "{i + 1}*k" }}')
    for i in range(2):
        at, of = random.randrange(size), random.randrange(size)
        lines.append(f'f{i} = {{ type = "force_source", at = "x{at}", f = "b*s*x{of} + F{i}" }}')
    lines.append(f'g = {{ type = "damper", between = ["x0", "x{size - 1}"], b = "b" }}')
    outputs = "\n".join(f'y{i} = "s*x{i} + k*F1"' for i in range(size))
    body = "\n".join(lines)
    return (
        f"{HEAD}parameters = {{ m = {{}}, k = {{}}, b = {{}} }}\n[elements]\n{body}\n"
        f'[inputs]\nF0 = {{}}\nF1 = {{}}\nG = {{ force = "x1" }}\n[outputs]\n{outputs}\n'
    )


@pytest.mark.slow
def test_forces_that_other_nodes_decide_act_as_the_equations_say():
    for seed in range(12):
        assert_solves(forced(seed))


def moved(seed):
    """Return a network with levers, a node that is moved, and springs that are equal or negative."""
    random = Random(seed)
    nodes = [f"x{i}" for i in range(random.randrange(3, 7))]
    lines = [f'm_{x} = {{ type = "mass", at = "{x}", m = "m" }}' for x in nodes if random.random() < 0.4]
    for i, x in enumerate(nodes):
        for other in ["ground", *nodes[:i]]:
            k = random.choice(["k", "k", "k", "-k", "-c"])
            if random.random() < 0.5:
                lines.append(f'k_{other}{x} = {{ type = "spring", between = ["{other}", "{x}"], k = "{k}" }}')
    ends = random.sample(nodes, len(nodes))
    for n in range(random.randrange(min(3, len(nodes) // 2 + 1))):
        r = random.choice(["r", "1", "-1", "-r", "2"])
        a, b = ends[2 * n : 2 * n + 2]
        lines.append(f'r_{n} = {{ type = "transformer", from = "{a}", to = "{b}", ratio = "{r}" }}')
    random.shuffle(lines)
    a, b = random.sample(nodes, 2)
    where = random.choice([f'"{a}"', f'["{a}", "{b}"]'])
    outputs = "\n".join(f'Y_{x} = "{x}"' for x in nodes)
    body = "\n".join(lines)
    return (
        f"{HEAD}parameters = {{ m = {{}}, k = {{}}, c = {{}}, r = {{}} }}\n[elements]\n{body}\n[inputs]\n"
        f'F = {{ force = "{b}" }}\nG = {{ displacement = {where} }}\n[outputs]\n{outputs}\n'
    )


@pytest.mark.slow
def test_nodes_that_levers_and_inputs_move_respond_as_their_equations_say():
    for seed in range(15, 35):
        assert_solves(moved(seed))


LEVER = """symflex = 1
parameters = { r = {}, m = {}, n = {} }
elements.near = { type = "mass", at = "p", m = "m" }
elements.far = { type = "mass", at = "q", m = "n" }
elements.lever = { type = "transformer", from = "p", to = "q", ratio = "r" }
inputs.F = { force = "p" }
outputs.P = "p"
"""


def test_the_mass_behind_a_lever_is_found_without_a_division():
    """Laws go first, by what stands as a number in them: P/F is 1/((m + n r^2) s^2)."""
    equations = pipeline.assemble_sparse(pipeline.loads(LEVER))
    found = eliminate(equations, [("P", "F")])
    used = found.program.steps_of(*found.quotients[0])
    assert not any(found.program.kinds[i] == Step.DIVIDE for i in used)


APART = """symflex = 1
parameters = { m = {}, n = {} }
elements.here = { type = "mass", at = "x", m = "m" }
elements.there = { type = "mass", at = "y", m = "n" }
inputs.F = { force = ["x", "y"] }
outputs.X = "x"
outputs.Y = "y"
outputs.both = "x + y"
"""


def test_nothing_is_subtracted_where_gears_drive_what_springs_join():
    # Reflected to the driven side of a gear 1:N, an inertia on the driving side is N^2 times as large.
    text = """
    symflex = 1
    parameters = { N = {}, J = {}, J_m = {}, b = {}, k = {} }
    inputs.T = { torque = "phi" }
    outputs.X = "w"
    elements.gear = { type = "transformer", from = "phi", to = "theta", ratio = "1/N" }
    elements.rotor = { type = "inertia", at = "phi", J = "J_m" }
    elements.bearing = { type = "rotary_damper", between = ["phi", "ground"], b = "b" }
    elements.drum = { type = "inertia", at = "theta", J = "J" }
    elements.rope = { type = "torsion_spring", between = ["theta", "w"], k = "k" }
    elements.load = { type = "inertia", at = "w", J = "J" }
    """
    equations = assemble(pipeline.loads(text))
    found = eliminate(equations, [("X", "T")])
    ((num, den),) = found.quotients
    program = found.program
    assert Step.NEGATE not in {program.kinds[i] for i in program.steps_of(num, den)}
    given = numbers(program.names)
    n, j, j_m, b, k, s = (given[x] for x in ("N", "J", "J_m", "b", "k", "s"))
    driven = n**2 * (j_m * s**2 + b * s) + j * s**2
    expected = n * k / (driven * (j * s**2 + k) + j * s**2 * k)
    assert value(program, num, given) / value(program, den, given) == expected


def test_a_division_that_is_all_of_a_response_is_its_quotient():
    equations = pipeline.assemble_sparse(pipeline.loads(APART))
    found = eliminate(equations, [("X", "F"), ("Y", "F"), ("both", "F")])
    given = numbers(equations.ring.names)
    s, m, n = (given[name] for name in "smn")
    read = [tuple(value(found.program, step, given) for step in pair) for pair in found.quotients]
    assert read == [(1, m * s**2), (-1, n * s**2), (1 / (m * s**2) - 1 / (n * s**2), 1)]


def test_fewer_equations_than_unknowns_are_refused_with_what_they_leave_open():
    equations = pipeline.assemble_sparse(pipeline.loads(APART))
    with pytest.raises(ModelError, match="nothing determines node 'y': it floats"):
        eliminate(replace(equations, rows=equations.rows[:1]), [("X", "F")])


# Two beams and a spring side by side, whose stiffness is defined.
BESIDE = """symflex = 1
parameters = { EI = {}, l = {}, m = {}, k = {}, J = {} }
definitions.c = "12*EI/l^3 + k"
definitions.d = "c + k/3"
[elements]
upper = { type = "massless_beam", between = ["p", "q"], EI = "EI", l = "l" }
lower = { type = "massless_beam", between = ["p", "q"], EI = "3*EI", l = "l" }
middle = { type = "spring", between = ["p.y", "q.y"], k = "d" }
near = { type = "rigid_body", at = "p", m = "m", J = "J", cg = "0 m" }
far = { type = "rigid_body", at = "q", m = "2*m", J = "J", cg = "l/2" }
ground = { type = "spring", between = ["p.y", "ground"], k = "c" }
[inputs]
F = { force = "p.y" }
T = { torque = "q.theta" }
[outputs]
Y = "q.y"
tilt = "p.theta"
"""


def test_what_joins_two_nodes_side_by_side_adds_up():
    assert_solves(BESIDE)
