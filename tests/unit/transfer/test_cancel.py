"""Cancellation of common factors, against SymPy's greatest common divisors."""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest
import sympy

from symflex.algebra import Factored, Ring
from symflex.transfer.lowest_terms import LARGE, LineImages, cancel

RING = Ring(("s", "k", "b"))
SYMBOLS = sympy.symbols("s k b")
S, K, B = (RING.generator(name) for name in "skb")
IRREDUCIBLE = (S + K, S - K, B * S + K, S**2 + B, 3 * S**2 + B * S + K, K + 2 * B, S * B * K + 7, S, B)


def sides(factored):
    """Return numerator and denominator as SymPy's polynomials."""
    above, below = (sympy.Poly(n, *SYMBOLS, domain="QQ") for n in factored.unit.as_integer_ratio())
    for polynomial, exponent in factored.factors:
        terms = {powers: int(c) for powers, c in polynomial.to_dict().items()}
        power = sympy.Poly(terms, *SYMBOLS, domain="QQ") ** abs(exponent)
        above, below = (above * power, below) if exponent > 0 else (above, below * power)
    return above, below


def to_sympy(factored):
    above, below = sides(factored)
    return above.as_expr() / below.as_expr()


def product(factors):
    """Return factors to powers as they are given, those that share something among them too."""
    value = Factored.number(RING, 1)
    for polynomial, exponent in factors:
        value = value * Factored.polynomial(RING, polynomial) ** exponent
    return value


def assert_cancelled(numerator, denominator):
    result, shared = cancel(numerator, denominator)
    assert (result.ring, shared.ring) == (RING, RING)
    (a, b), (c, d) = sides(numerator), sides(denominator)
    top, bottom = a * d, b * c
    above, below = sides(result)
    assert above * bottom == below * top
    assert above.gcd(below).is_ground
    common, nothing = sides(shared)
    assert nothing.is_ground
    assert common.monic() == top.gcd(bottom).monic()
    return result, shared


def some_factors(random):
    """Return one to three factors of one to three irreducible polynomials."""
    factors = []
    for _ in range(random.randint(1, 3)):
        polynomial = random.choice(IRREDUCIBLE)
        for _ in range(random.randint(0, 2)):
            polynomial = polynomial * random.choice(IRREDUCIBLE)
        factors.append((polynomial, random.randint(1, 2)))
    return product(factors)


@pytest.mark.slow
def test_quotients_of_products_come_in_lowest_terms_with_what_was_divided_out():
    for seed in range(20):
        random = Random(seed)
        assert_cancelled(some_factors(random), some_factors(random))


def test_a_square_inside_a_factor_cancels_against_every_factor_below():
    f, g, h = S + K, B * S + K, S**2 + B
    _, shared = assert_cancelled(product([(f * f * g, 2)]), product([(f * g, 1), (f * h, 1), (g * h, 3)]))
    assert to_sympy(shared).subs({SYMBOLS[0]: 1, SYMBOLS[1]: 1, SYMBOLS[2]: 0}) == 2**2 * 1**2
    assert sympy.expand(to_sympy(shared)) == sympy.expand(to_sympy(product([(f, 2), (g, 2)])))


def test_what_is_left_of_a_factor_above_is_compared_with_the_rest_below():
    f, g, h = S + K, B * S + K, S**2 + B
    assert_cancelled(product([(f * g * h, 1)]), product([(f, 1), (g * K, 1), (h * (S - K), 1)]))
    assert_cancelled(product([(f, 3), (g, 1)]), product([(f * g, 2), (f * h, 1)]))


def test_what_a_quotient_had_below_stays_below():
    half = product([(S + K, 1)]) / product([(S**2 + B, 1)])
    result, shared = cancel(half, product([(S + K, 2)]))
    assert sympy.simplify(to_sympy(result) * (SYMBOLS[0] + SYMBOLS[1]) * (SYMBOLS[0] ** 2 + SYMBOLS[2])) == 1
    assert sympy.expand(to_sympy(shared) - SYMBOLS[0] - SYMBOLS[1]) == 0


def test_a_common_denominator_is_no_common_factor():
    below = product([(S**2 + B, 1)])
    result, shared = cancel(product([(S + K, 1)]) / below, product([(S - K, 1)]) / below)
    assert (to_sympy(shared), sympy.cancel(to_sympy(result) * (SYMBOLS[0] - SYMBOLS[1]))) == (
        1,
        sum(SYMBOLS[:2]),
    )


def test_zero_over_anything_is_zero_and_shares_nothing():
    result, shared = cancel(Factored.number(RING, 0), product([(S + K, 1)]))
    assert (result.is_zero, shared.unit, shared.factors, shared.ring) == (True, Fraction(1), (), RING)


def test_what_a_denominator_is_divided_by_is_no_common_factor():
    f, g = product([(S + K, 1)]), product([(S - K, 1)])
    for numerator, denominator in ((f * f, g / f), (g / f, f * f)):
        _, shared = cancel(numerator, denominator)
        assert shared.factors == ()


def test_numbers_in_front_are_kept():
    result, _ = cancel(
        Factored.number(RING, Fraction(3, 7)) * product([((S + K) * B, 1)]), product([((S + K) * K, 1)])
    )
    assert to_sympy(result) == sympy.Rational(3, 7) * SYMBOLS[2] / SYMBOLS[1]


def test_coprime_quotients_keep_their_factors_as_they_were_grouped():
    numerator, denominator = product([((S + K) * (S - K), 1)]), product([((B * S + K) * (S**2 + B), 2)])
    result, shared = cancel(numerator, denominator)
    assert [e for _, e in result.factors] == [1, -2]
    assert shared.factors == ()


def test_large_factors_are_proved_coprime_on_a_line_unless_they_share_something():
    # (s + k + 1)^8 has 45 terms; it is irreducible up to its power, and so are s + b and k + b.
    large = (S + K + 1) ** 8
    assert len(large) > LARGE
    images = LineImages(RING)
    for other, coprime in [
        (S + B, True),
        (S**2 + B + 1, True),
        (S + K + 1, False),
        ((S + 1) * (S + K + 1), False),
    ]:
        assert images.prove_coprime(large, other) == coprime, other
    # What two polynomials share may have no s: then it divides the leading coefficients.
    assert not images.prove_coprime(large * (K + B), (S + B) * (K + B))
