"""Elementary functions enclose their values; the random point tells zero from nonzero."""

import math
from itertools import product

import mpmath
import pytest
from flint import arb, ctx

from symflex.algebra import FUNCTIONS, PRIME, Factored, Ring, random_point, residue
from symflex.expressions import FUNCTIONS as READABLE


def test_a_function_encloses_what_mpmath_computes_and_differentiates():
    for name in FUNCTIONS:
        with mpmath.workdps(60), ctx.workprec(200):
            ball = FUNCTIONS[name].derivative(arb("0.75"))
            expected = arb(mpmath.nstr(mpmath.diff(getattr(mpmath, name), mpmath.mpf("0.75")), 40))
            assert abs(ball - expected) < arb("1e-25"), name
    for name, x in product(FUNCTIONS, ["0.3", "1", "2.75"]):
        with mpmath.workdps(60), ctx.workprec(200):
            ball = FUNCTIONS[name].evaluate(arb(x))
            expected = arb(mpmath.nstr(getattr(mpmath, name)(mpmath.mpf(x)), 58))
            assert abs(ball - expected) < arb("1e-55"), (name, x)


def test_the_functions_that_can_be_read_are_those_that_can_be_evaluated():
    assert set(READABLE) == set(FUNCTIONS)
    assert not FUNCTIONS["log"].evaluate(arb(-1)).is_finite()


def test_the_residue_is_the_value_modulo_the_prime():
    ring = Ring(("s", "a", "b"))
    s, a, b = (Factored.generator(ring, n) for n in ring.names)
    value = (a * s + b) ** 3 / (a - b) * 7 / 3
    point = {"s": 11, "a": 5, "b": 2}
    expected = (57**3 * 7) * pow(3 * 3, -1, PRIME) % PRIME
    assert residue(value, point) == expected
    for make, wanted in [
        (lambda s, a, b: a * s - b * 4 + 3, 50),
        (lambda s, a, b: b - a * s, -53),
        (lambda s, a, b: 1 / (a + b), pow(7, -1, PRIME)),
        (lambda s, a, b: a * 0 - 3, -3),
        (lambda s, a, b: (a - b) ** -2 * b**3 / 5, 8 * pow(45, -1, PRIME)),
    ]:
        ring = Ring(("s", "a", "b"))
        value = make(*(Factored.generator(ring, n) for n in ring.names))
        assert residue(value, {"s": 11, "a": 5, "b": 2}) == wanted % PRIME, make
    for make in [lambda a: 1 / (a - 2), lambda a: (a - 2) ** -3 * a, lambda a: a / PRIME]:
        ring = Ring(("s", "a"))
        with pytest.raises(ZeroDivisionError, match="division by zero"):
            residue(make(Factored.generator(ring, "a")), {"s": 1, "a": 2})


def test_a_random_point_is_the_same_in_every_run_with_another_value_for_every_name_and_no_zero():
    names = [f"x{i}" for i in range(200)]
    point = random_point(names)
    assert list(point) == names
    assert len(set(point.values())) == len(names)
    assert all(0 < x < PRIME for x in point.values())
    assert random_point(("s", "a")) == random_point(("s", "a"))
    assert math.log2(PRIME + 1) == 61
    assert pow(3, PRIME - 1, PRIME) == 1
