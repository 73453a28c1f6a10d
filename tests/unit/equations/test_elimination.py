"""Elimination against independent dense solutions."""

import inspect
import sys
from fractions import Fraction
from random import Random

import pytest
import sympy

import symflex
from symflex import pipeline
from symflex.algebra import Ring
from symflex.equations.elimination import Minors, eliminate_unit_pivots
from tests.contract.exact import Point, solve, value_in_ring

HEADER = "symflex = 1\n[parameters]\n"


# ---------------------------------------------------------------------- networks with a matrix by hand


def random_network(seed):
    """Return (text, branches): masses at nodes 0..n-1 and springs and dampers between them and ground."""
    random = Random(seed)
    size = random.randrange(2, 6)
    branches = [("m", i, None, f"m_{i}") for i in range(size)]
    for i in range(size):
        other = random.choice([None, *range(i)]) if i else None
        branches.append((random.choice("kb"), i, other, f"p_{len(branches)}"))
    for _ in range(random.randrange(0, 4)):
        i = random.randrange(size)
        other = random.choice([None, *(j for j in range(size) if j != i)])
        branches.append((random.choice("kb"), i, other, f"p_{len(branches)}"))
    kinds = {"m": ("mass", "m"), "k": ("spring", "k"), "b": ("damper", "b")}
    lines = []
    for n, (kind, i, other, value) in enumerate(branches):
        name, key = kinds[kind]
        there = "ground" if other is None else f"x{other}"
        place = f'at = "x{i}"' if kind == "m" else f'between = ["x{i}", "{there}"]'
        lines.append(f'e{n} = {{ type = "{name}", {place}, {key} = "{value}" }}')
    parameters = "\n".join(f"{value} = {{}}" for *_, value in branches)
    outputs = "\n".join(f'X{i} = "x{i}"' for i in range(size))
    text = f"{HEADER}{parameters}\n[elements]\n" + "\n".join(lines)
    return f'{text}\n[inputs]\nF = {{ force = "x0" }}\n[outputs]\n{outputs}\n', branches, size


def stiffness(branches, size, value, at):
    """Return the dynamic stiffness matrix from the branches alone."""
    matrix = [[0 * at for _ in range(size)] for _ in range(size)]
    for kind, i, other, name in branches:
        admittance = value(name) * {"m": at * at, "k": at / at, "b": at}[kind]
        matrix[i][i] += admittance
        if other is not None:
            matrix[other][other] += admittance
            matrix[i][other] -= admittance
            matrix[other][i] -= admittance
    return matrix


@pytest.mark.slow
def test_the_quotient_of_a_random_network_is_that_of_exact_dense_elimination():
    at = Fraction(7, 3)
    for seed in range(15):
        text, branches, size = random_network(seed)
        point = Point(seed, s=at)
        matrix = stiffness(branches, size, point.__getitem__, at)
        expected = solve(matrix, [Fraction(int(i == 0)) for i in range(size)])
        found = [value_in_ring(tf.ratio, point) for tf in pipeline.derive_all(pipeline.loads(text))]
        assert found == expected, seed


def test_the_quotient_of_a_small_network_is_sympys():
    text, branches, size = random_network(104)
    assert size <= 3
    s = sympy.Symbol("s")
    matrix = sympy.Matrix(stiffness(branches, size, sympy.Symbol, s))
    minor = matrix.copy()
    minor.col_del(0)
    minor.row_del(0)
    G = symflex.loads(text).transfer_function("X0", "F")
    ratio = (G.num / G.den).xreplace({x: sympy.Symbol(x.name) for x in (G.num / G.den).free_symbols})
    expected = minor.det(method="berkowitz") / matrix.det(method="berkowitz")
    assert sympy.cancel(ratio - expected) == 0


# --------------------------------------------------------------------------------- the parts, one by one


def random_sparse(seed, size, ring, *, units):
    random = Random(seed)
    entries = [ring.generator(n) for n in ring.names]
    rows = []
    for i in range(size):
        row = {(i + 1) % size: entries[random.randrange(len(entries))]}
        for _ in range(random.randrange(1, 4)):
            value = entries[random.randrange(len(entries))] * random.randrange(1, 4) + random.randrange(-2, 3)
            if units and random.random() < 0.5:
                value = ring.constant(random.choice((1, -1)))
            if not value.is_zero():
                row[random.randrange(size)] = value
        row[size] = entries[random.randrange(len(entries))]
        rows.append(row)
    return tuple(rows)


RING = Ring(("s", "a", "b"))


def test_unit_pivots_leave_the_quotient_as_it_is():
    size, compared = 5, 0
    goal = ({0: RING.generator("a"), 3: RING.constant(1), size: RING.generator("b")},)
    whole = (1 << size) - 1
    for seed in range(20):
        rows = random_sparse(seed, size, RING, units=True)
        before = Minors(rows, ring=RING)
        den = before.determinant(whole)
        if den.is_zero():
            continue
        compared += 1
        num = before.bordered(goal[0], whole | 1 << size)
        reduced = eliminate_unit_pivots(rows, goal, size)
        after = Minors(reduced.rows, ring=RING)
        columns = sum(1 << c for c in reduced.columns)
        den_after = after.determinant(columns)
        num_after = after.bordered(reduced.outputs[0], columns | 1 << size)
        sign = -1 if (size - len(reduced.columns)) % 2 else 1
        assert num * den_after == sign * num_after * den, seed
    assert compared > 10


@pytest.mark.slow
def test_a_chain_may_be_longer_than_calls_may_be_deep():
    # The determinant of tridiagonal (-1, 2, -1) with n rows is n + 1.
    n, limit = 150, sys.getrecursionlimit()
    rows = tuple(
        {j: RING.constant(2 if j == i else -1) for j in range(max(i - 1, 0), min(i + 2, n))} for i in range(n)
    )
    minors = Minors(rows, ring=RING)
    sys.setrecursionlimit(len(inspect.stack()) + 60)
    try:
        found = minors.determinant((1 << n) - 1)
    finally:
        sys.setrecursionlimit(limit)
    assert found == RING.constant(n + 1)


def test_parameters_named_like_internal_generators_do_not_collide():
    """sum0 and x13 are names a program might use inside; sqrt(k*q) is generator 13 here."""
    text = f"""{HEADER}T = 1
k = 3
q = 5
sum0 = 7
sum1 = 11
x6 = 100
x7 = 101
x8 = 105
x9 = 103
x10 = 104
x13 = 102
[elements]
a = {{ type = "spring", between = ["x", "z"], k = "T^2*s^2 + x13" }}
b = {{ type = "spring", between = ["z", "y"], k = "T^2*s^2 + sqrt(k*q)" }}
c = {{ type = "spring", between = ["z", "ground"], k = "sum0 + x10" }}
d = {{ type = "spring", between = ["y", "ground"], k = "sum1 + x8" }}
e = {{ type = "spring", between = ["y", "ground"], k = "x9 + x10 + x7 + x6" }}
[inputs]
F = {{ force = "x" }}
[outputs]
X = "x"
"""
    (tf,) = pipeline.derive_all(pipeline.loads(text))
    series = [4 + 15**0.5, 11 + 105 + 100 + 101 + 103 + 104]  # at s = 2
    middle = 111 + series[0] * series[1] / sum(series)
    assert pipeline.bind(tf)(2 + 0j).real == pytest.approx(1 / 106 + 1 / middle, rel=1e-14)
