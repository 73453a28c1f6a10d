"""Elementary functions enclose their values; the random point tells zero from nonzero."""

from __future__ import annotations

import math

import mpmath
import pytest
from flint import arb, ctx

from symflex.algebra import FUNCTIONS, PRIME, Factored, Ring, random_point, residue
from symflex.expressions import FUNCTIONS as READABLE


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_derivative_of_a_function_encloses_what_mpmath_differentiates(name):
    with mpmath.workdps(60), ctx.workprec(200):
        ball = FUNCTIONS[name].derivative(arb("0.75"))
        expected = arb(mpmath.nstr(mpmath.diff(getattr(mpmath, name), mpmath.mpf("0.75")), 40))
        assert abs(ball - expected) < arb("1e-25")


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("x", ["0.3", "1", "2.75"])
def test_a_function_encloses_what_mpmath_computes(name, x):
    with mpmath.workdps(60), ctx.workprec(200):
        ball = FUNCTIONS[name].evaluate(arb(x))
        expected = arb(mpmath.nstr(getattr(mpmath, name)(mpmath.mpf(x)), 58))
        assert abs(ball - expected) < arb("1e-55")


def test_the_functions_that_can_be_read_are_those_that_can_be_evaluated():
    assert set(READABLE) == set(FUNCTIONS)


def test_the_logarithm_of_a_negative_number_is_not_finite():
    assert not FUNCTIONS["log"].evaluate(arb(-1)).is_finite()


def test_the_residue_is_the_value_modulo_the_prime():
    ring = Ring(("s", "a", "b"))
    s, a, b = (Factored.generator(ring, n) for n in ring.names)
    value = (a * s + b) ** 3 / (a - b) * 7 / 3
    point = {"s": 11, "a": 5, "b": 2}
    expected = (57**3 * 7) * pow(3 * 3, -1, PRIME) % PRIME
    assert residue(value, point) == expected


@pytest.mark.parametrize(
    ("make", "wanted"),
    [
        (lambda s, a, b: a * s - b * 4 + 3, 50),
        (lambda s, a, b: b - a * s, -53),
        (lambda s, a, b: 1 / (a + b), pow(7, -1, PRIME)),
        (lambda s, a, b: a * 0 - 3, -3),
        (lambda s, a, b: (a - b) ** -2 * b**3 / 5, 8 * pow(45, -1, PRIME)),
    ],
)
def test_the_residue_of_a_sum_is_that_of_its_terms(make, wanted):
    ring = Ring(("s", "a", "b"))
    value = make(*(Factored.generator(ring, n) for n in ring.names))
    assert residue(value, {"s": 11, "a": 5, "b": 2}) == wanted % PRIME


def test_a_random_point_has_another_value_for_every_name_and_no_zero():
    names = [f"x{i}" for i in range(200)]
    point = random_point(names)
    assert list(point) == names
    assert len(set(point.values())) == len(names)
    assert all(0 < x < PRIME for x in point.values())


@pytest.mark.parametrize(
    "make",
    [lambda a: 1 / (a - 2), lambda a: (a - 2) ** -3 * a, lambda a: a / PRIME],
    ids=["1", "3", "number"],
)
def test_the_residue_at_a_pole_is_refused(make):
    ring = Ring(("s", "a"))
    with pytest.raises(ZeroDivisionError, match="division by zero"):
        residue(make(Factored.generator(ring, "a")), {"s": 1, "a": 2})


def test_the_random_point_is_the_same_in_every_run():
    assert random_point(("s", "a")) == random_point(("s", "a"))


def test_the_prime_is_a_mersenne_prime():
    assert math.log2(PRIME + 1) == 61
    assert pow(3, PRIME - 1, PRIME) == 1
