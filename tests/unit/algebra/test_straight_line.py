"""Steps of straight-line programs against fractions, and against themselves modulo a prime."""

from fractions import Fraction
from itertools import product
from random import Random

import pytest

from symflex.algebra import PRIME, Factored, Ring
from symflex.algebra.straight_line import ONE, ZERO, Workbench
from tests.unit.equations.test_minors import at
from tests.unit.equations.test_star_mesh import value

NAMES = ("s", "k", "b")
GIVEN = {"s": Fraction(3, 2), "k": Fraction(-7, 5), "b": Fraction(11, 3)}


def assert_consistent(bench):
    """Every step's residue is what its operation makes of those before, and no two steps are the same."""
    program = bench.finished()
    modular = dict(zip(NAMES, (Fraction(x) for x in bench.point), strict=True))
    seen = set()
    for step, (kind, operands) in enumerate(zip(program.kinds, program.operands, strict=True)):
        exact = value(program, step, modular)
        assert exact.numerator * pow(exact.denominator, -1, PRIME) % PRIME == bench.residue(step)
        key = (kind, tuple(sorted(operands)) if kind in (2, 3) else operands)
        assert key not in seen
        seen.add(key)


def made(bench, kind, given, n):
    """Return a step made of others, and its value by fractions, ``None`` where there is none."""
    (x, a), (y, b), (z, c) = given
    match kind:
        case "add":
            return bench.add([x, y, z]), a + b + c
        case "pair":
            return bench.add([x, y]), a + b
        case "less":
            return bench.add([x, bench.negate(y)]), a - b
        case "times":
            return bench.multiply(x, y), a * b
        case "minus":
            return bench.negate(x), -a
        case "over" if b:
            return bench.divide(x, y), a / b
        case "power" if n:
            return bench.power(x, n), a**n
    return None


@pytest.mark.slow
def test_whatever_is_done_steps_have_the_values_of_fractions():
    for seed in range(15):
        random, bench = Random(seed), Workbench(NAMES)
        steps = [(bench.generator(i), GIVEN[name]) for i, name in enumerate(NAMES)]
        steps += [(bench.number(x), Fraction(x)) for x in (0, 1, -1, 3, Fraction(-2, 7))]
        for _ in range(40):
            kind = random.choice(("add", "pair", "less", "times", "over", "minus", "power"))
            given, n = [random.choice(steps) for _ in range(3)], random.randrange(4)
            found = made(bench, kind, given, n)
            if found is None or found[1].denominator.bit_length() > 3000:
                continue
            count = len(bench.kinds)
            assert made(bench, kind, given, n) == found, seed
            assert len(bench.kinds) == count, seed
            step, exact = found
            assert value(bench.finished(), step, GIVEN) == exact, seed
            assert (step == ZERO) is (exact == 0), seed
            steps.append(found)
        assert_consistent(bench)


def test_the_order_of_terms_and_factors_does_not_matter():
    bench = Workbench(NAMES)
    s, k, b = (bench.generator(i) for i in range(3))
    assert bench.add([s, k]) == bench.add([k, s])
    assert bench.add([s, k, b]) == bench.add([b, s, k])
    assert bench.multiply(s, k) == bench.multiply(k, s) == bench.product([s, k]) == bench.product([k, ONE, s])
    assert bench.product([s, k, b]) == bench.product([b, k, s])
    assert bench.product([s]) == s
    assert bench.product([]) == bench.product([ONE, ONE]) == ONE
    assert len({bench.add([s, k]), bench.multiply(s, k), bench.divide(s, k), bench.divide(k, s)}) == 4
    assert_consistent(bench)


def test_signs_stand_outside_of_products_and_of_sums_that_have_no_other():
    bench = Workbench(NAMES)
    s, k, b = (bench.generator(i) for i in range(3))
    minus = bench.negate
    assert bench.multiply(minus(s), k) == bench.multiply(s, minus(k)) == minus(bench.multiply(s, k))
    assert bench.multiply(minus(s), minus(k)) == bench.multiply(s, k)
    assert bench.divide(minus(s), k) == bench.divide(s, minus(k)) == minus(bench.divide(s, k))
    assert bench.add([minus(s), minus(k)]) == minus(bench.add([s, k]))
    assert bench.add([s, k, minus(s)]) == k
    assert bench.add([s, minus(s)]) == minus(ZERO) == ZERO
    assert bench.power(minus(s), 2) == bench.power(s, 2)
    assert bench.power(minus(s), 3) == minus(bench.power(s, 3))
    assert minus(minus(b)) == b
    assert_consistent(bench)


def test_a_quotient_times_its_divisor_is_what_was_divided():
    bench = Workbench(NAMES)
    s, k, b = (bench.generator(i) for i in range(3))
    total = bench.add([k, b])
    assert bench.multiply(bench.divide(s, total), total) == s
    assert bench.multiply(total, bench.divide(ONE, total)) == ONE
    assert bench.multiply(bench.negate(total), bench.divide(s, total)) == bench.negate(s)


def test_numbers_are_one_step_each():
    bench = Workbench(NAMES)
    s = bench.generator(0)
    assert (bench.number(0), bench.number(1)) == (ZERO, ONE)
    assert bench.number(-3) == bench.negate(bench.number(3))
    assert bench.fraction(bench.number(Fraction(6, 4))) == Fraction(3, 2)
    assert bench.multiply(bench.number(4), bench.number(Fraction(1, 2))) == bench.number(2)
    assert bench.divide(s, bench.number(4)) == bench.multiply(bench.number(Fraction(1, 4)), s)
    assert bench.power(bench.number(3), 4) == bench.number(81)
    assert (bench.power(s, 0), bench.power(s, 1), bench.power(ONE, 7)) == (ONE, s, ONE)
    assert bench.divide(s, s) == ONE
    assert bench.divide(ZERO, s) == ZERO
    with pytest.raises(ZeroDivisionError, match="division by zero"):
        bench.divide(s, ZERO)


RING = Ring(NAMES)
S, K, B = (RING.generator(name) for name in NAMES)


def test_polynomials_and_factored_functions_are_made_of_steps_with_their_value():
    for polynomial in [S + K, 3 * S**2 * K - B, S**3 * B**2 - 2 * K + 7, K, -S * K, 0 * S - 5, S - S + B * 4]:
        bench = Workbench(NAMES)
        step = bench.polynomial(polynomial)
        assert bench.polynomial(polynomial) == step
        assert value(bench.finished(), step, GIVEN) == at(polynomial, tuple(GIVEN.values()))
        assert (bench.roles.get(step) == "w") is (len(polynomial) > 1)
        assert_consistent(bench)
    for sign, unit, exponents in product(
        [1, -1],
        [Fraction(1), Fraction(-1), Fraction(5, 3), Fraction(-2, 7)],
        [(1,), (-1,), (2, -3), (1, 1, -1), ()],
    ):
        bench = Workbench(NAMES)
        factored, exact = Factored.number(RING, unit), unit * sign
        for polynomial, exponent in zip((B * S + K, K - 3 * S, S), exponents, strict=False):
            factored = factored * Factored.polynomial(RING, polynomial) ** exponent
            exact *= at(polynomial, tuple(GIVEN.values())) ** exponent
        assert value(bench.finished(), bench.factored(factored, sign), GIVEN) == exact, (unit, exponents)
        assert_consistent(bench)


def test_a_definition_stands_for_its_value_under_its_name():
    bench = Workbench(NAMES)
    s, k = bench.generator(0), bench.generator(1)
    bench.define(2, bench.add([s, k]))
    assert bench.generator(2) == bench.add([s, k])
    assert bench.finished().roles == {bench.add([s, k]): "=b"}
    bench.define(1, bench.number(4))
    assert bench.generator(1) == bench.number(4)
    assert bench.number(4) not in bench.roles


def test_size_counts_operations_and_shared_ones_once():
    bench = Workbench(NAMES)
    s, k, b = (bench.generator(i) for i in range(3))
    shared = bench.add([s, k, b])
    square, over = bench.power(shared, 2), bench.divide(shared, s)
    program = bench.finished()
    # Two additions; one power; one division; a sign.
    assert program.size(shared) == 2
    assert program.size(square, over) == 2 + 1 + 1
    assert program.size(bench.negate(square)) == 2 + 1 + 1
    assert program.steps_of(over) == sorted([s, k, b, shared, over])
    assert program.steps_of(square) == sorted([s, k, b, shared, square])
    assert (program.inner(s), program.inner(ONE), program.inner(square)) == ((), (), (shared,))
