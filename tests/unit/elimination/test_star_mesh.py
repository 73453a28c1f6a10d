"""Straight-line programs of networks: their values, their size, and what singular systems say."""

from fractions import Fraction
from itertools import pairwise

import pytest
from flint import fmpq, fmpq_mat

from benchmarks.networks import NETWORKS, chain, ladder, network, ring, tree
from symflex import pipeline
from symflex.elimination import Step, Workbench, eliminate, expanded_terms
from symflex.elimination.straight_line import ONE, ZERO
from symflex.equations import assemble
from symflex.errors import ModelError


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


@pytest.mark.parametrize("kind", NETWORKS)
@pytest.mark.parametrize("is_sparse", [True, False])
def test_a_network_responds_as_its_dense_matrix_does(kind, is_sparse):
    branches = NETWORKS[kind](16)
    equations = assemble(network(branches), is_sparse=is_sparse)
    found = eliminate(equations, PAIRS)
    given = numbers(equations.ring.names)
    expected = dense_response(branches, given)
    for (num, den), wanted in zip(found.quotients, (expected[0], expected[-1]), strict=True):
        assert value(found.program, num, given) / value(found.program, den, given) == wanted


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


@pytest.mark.parametrize(
    ("make", "steps"),
    [(chain, (40, 41, 42, 43)), (ring, (40, 41, 42, 43)), (ladder, (40, 42, 44, 46)), (tree, (64, 128, 192))],
)
def test_the_size_grows_by_the_same_for_every_mass(make, steps):
    sizes = []
    for n in steps:
        found = eliminate(assemble(network(make(n)), is_sparse=True), PAIRS[:1])
        sizes.append(found.program.size(*found.quotients[0]))
    growth = {b - a for a, b in pairwise(sizes)}
    assert len(growth) == 1


def test_a_chain_of_more_names_than_are_expanded_needs_seven_operations_a_mass():
    found = eliminate(assemble(network(chain(500)), is_sparse=True), PAIRS[:1])
    # b s + k, m s^2, Z + w, w/(Z + w), that times Z, and the sum: 7 with s^2 shared.
    assert found.program.size(*found.quotients[0]) == 7 * 500 - 5


def test_opposite_and_equal_terms_are_seen():
    bench = Workbench(("s", "k", "b"))
    s, k, b = (bench.generator(i) for i in range(3))
    assert bench.add([k, b, bench.negate(k)]) == b
    assert bench.add([k, k]) == bench.multiply(bench.number(2), k)
    left = bench.multiply(s, bench.add([k, b]))
    right = bench.add([bench.multiply(k, s), bench.multiply(b, s)])
    assert left != right
    assert bench.add([left, bench.negate(right)]) == ZERO
    with pytest.raises(ZeroDivisionError):
        bench.divide(k, ZERO)


@pytest.mark.parametrize("is_sparse", [True, False])
@pytest.mark.parametrize(("n", "terms"), [(2, 3), (3, 8), (6, 144), (12, 46368)])
def test_the_terms_of_a_chain_are_counted_by_fibonacci(n, terms, is_sparse):
    """The spanning forests of a chain: its determinant in w and m has F(2n) terms."""
    equations = assemble(network(chain(n)), is_sparse=is_sparse)
    assert expanded_terms(equations, eliminate(equations, PAIRS[:1])) == pytest.approx(terms, rel=1e-9)


def test_numbers_in_place_of_symbols_leave_few_terms():
    text = """
symflex = 1
inputs.F = { force = "x_1" }
outputs.X = "x_1"
[elements]
"""
    for i in range(1, 9):
        text += f'm{i} = {{ type = "mass", at = "x_{i}", m = "{i} kg" }}\n'
        text += f'k{i} = {{ type = "spring", between = ["x_{i}", "x_{i + 1}"], k = "{i}.5 N/m" }}\n'
    text += 'm9 = { type = "mass", at = "x_9", m = "3 kg" }\n'
    equations = pipeline.assemble_sparse(pipeline.loads(text))
    # Nothing but powers of s up to the eighteenth.
    assert expanded_terms(equations, eliminate(equations, [("X", "F")])) == pytest.approx(19)


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


@pytest.mark.parametrize(("text", "code"), [(FLOATING, "SF301"), (ALGEBRAIC, "SF303")])
def test_a_singular_system_is_explained(text, code):
    model = pipeline.loads(text)
    with pytest.raises(ModelError) as caught:
        pipeline.derive_nested(model)
    assert caught.value.diagnostics[0].code == code


def test_a_large_singular_system_names_what_floats(monkeypatch):
    monkeypatch.setattr("symflex.elimination.star_mesh.EXPLAINED", 2)
    with pytest.raises(ModelError) as caught:
        pipeline.derive_nested(pipeline.loads(FLOATING))
    assert caught.value.diagnostics[0].code == "SF304"
    assert "'z'" in caught.value.diagnostics[0].message or "'y'" in caught.value.diagnostics[0].message
