"""Closed sums and the way back, and Cramer's rule, on two masses whose equations are written by hand."""

from fractions import Fraction

import pytest

from symflex import pipeline
from symflex.equations.elimination import close, closing
from symflex.equations.elimination.determinants import Determinants
from symflex.errors import BudgetError, ModelError
from tests.unit.equations.test_minors import at

TEXT = """symflex = 1
[parameters]
m = {}
M = {}
k = {}
b = {}
sum0 = {}
[elements]
first = { type = "mass", at = "x", m = "m" }
second = { type = "mass", at = "y", m = "M" }
link = { type = "spring", between = ["x", "y"], k = "k" }
loss = { type = "damper", between = ["x", "y"], b = "b" }
wall = { type = "spring", between = ["x", "ground"], k = "sum0 + 2*k" }
[inputs]
F = { force = "x" }
G = { force = "y" }
H = { force = "y" }
[outputs]
X = "x"
Y = "y"
W = "s*(s + 2)*x + pi*s^2*y"
"""
EQUATIONS = pipeline.assemble(pipeline.loads(TEXT))
NAMES = EQUATIONS.ring.names
GIVEN = {name: Fraction(7 + 3 * i, 5 - 2 * i) for i, name in enumerate(NAMES)}
POINT = tuple(GIVEN[name] for name in NAMES)


def value(factored):
    """Return what a factored function is where every name has its fraction, pi one like any other."""
    product = Fraction(factored.unit)
    for polynomial, exponent in factored.factors:
        product *= at(polynomial, POINT) ** exponent
    return product


def responses():
    """Return the displacements per force on x and on y from the two equations of motion."""
    s, m, M, k, b, more = (GIVEN[name] for name in ("s", "m", "M", "k", "b", "sum0"))
    w = b * s + k
    (p, q), r = (m * s**2 + w + 2 * k + more, -w), M * s**2 + w
    determinant = p * r - q * q
    x, y = {"F": r, "G": -q, "H": -q}, {"F": -q, "G": p, "H": p}
    return {
        (output, source): number / determinant
        for source in "FGH"
        for output, number in (
            ("X", x[source]),
            ("Y", y[source]),
            ("W", s * (s + 2) * x[source] + GIVEN["pi"] * s**2 * y[source]),
        )
    }


def test_a_bordered_determinant_over_the_determinant_is_the_response():
    for pair, expected in responses().items():
        found = Determinants.of(EQUATIONS)
        num, den = found.opened(found.num(*pair)), found.opened(found.den)
        assert value(num) / value(den) == expected, pair


def test_opening_keeps_to_its_limits(monkeypatch):
    for limit in ["TERM_LIMIT", "MEMORY_LIMIT"]:
        closure = close(EQUATIONS).closure
        first, second = closure.ring.generator("sum0!"), closure.ring.generator("sum1")
        polynomial = (first + second) * (first - 2 * second)
        assert closure.opened_length(polynomial) >= 12, limit
        assert not closure.open(polynomial).is_zero, limit
        with monkeypatch.context() as patch, pytest.raises(BudgetError):
            patch.setattr(closing, limit, 3)
            closure.open(polynomial)


def test_a_loop_without_a_solution_is_told_from_the_equations():
    text = 'symflex = 1\n[signals]\ne = "U + e"\n[inputs]\nU = {}\n[outputs]\nX = "e"\n'
    with pytest.raises(ModelError) as caught:
        Determinants.of(pipeline.assemble(pipeline.loads(text)))
    assert caught.value.diagnostics[0].code.startswith("SF30")
    assert "e" in caught.value.diagnostics[0].message
