"""Cancellation of common factors, against SymPy's greatest common divisors."""

import cmath
from fractions import Fraction
from random import Random

import pytest
import sympy

from symflex import pipeline
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


ROOTED = [
    # Orders of numerator and denominator in lowest terms, and how many roots cancel: by hand.
    ("(s^4 + w^4)/(s^2 + sqrt(2)*w*s + w^2)^2", (2, 2), 2),
    ("(s + 2*sqrt(2)*w)/(s^2 + 2*sqrt(8)*w*s + 8*w^2)*w", (0, 1), 1),
    ("(s + sqrt(6)*w)/(s^2 + (sqrt(2)*sqrt(3) + 1)*w*s + sqrt(6)*w^2)*w", (0, 1), 1),
    ("(s^2 + 2*s*sqrt(a*b) + a*b)/((s + sqrt(a)*sqrt(b))*(s + a))", (1, 1), 1),
    ("(s + b*sqrt(a/b))/(s + sqrt(a*b))", (0, 0), 1),
    ("(s^8 + w^8)/((s^2 + sqrt(2 - sqrt(2))*w*s + w^2)*(s^2 + sqrt(2 + sqrt(2))*w*s + w^2))^2", (4, 4), 4),
    ("(s + (1 + sqrt(2))*w)/(s + sqrt(3 + 2*sqrt(2))*w)", (0, 0), 1),
    ("(s - sqrt(a*b))/(s + sqrt(a*b))", (1, 1), 0),
    ("s*w/(s + sqrt(2)*w)/(s + sqrt(3)*w)", (1, 2), 0),
]


@pytest.mark.slow
def test_common_factors_over_roots_are_found():
    for expression, order, count in ROOTED:
        text = f"""symflex = 1
parameters = {{ w = "3 rad/s", a = "5 rad/s", b = "7 rad/s" }}
inputs = {{ u = {{}} }}
outputs = {{ y = "{expression}*u" }}
"""
        tf = pipeline.derive(pipeline.assemble(pipeline.loads(text)), "y", "u")
        assert tf.order == order, expression
        hidden = sum(int(h.polynomial.degrees()[0]) * h.multiplicity for h in tf.hidden)
        # What is cancelled at once where it is written is hidden as well.
        assert hidden == count, expression
        known = {"s": 0.3 + 1.1j, "w": 3, "a": 5, "b": 7, "sqrt": cmath.sqrt}
        expected = complex(sympy.sympify(expression.replace("^", "**"), locals=known))
        assert abs(pipeline.bind(tf)(known["s"]) - expected) < 1e-12 * abs(expected), expression


@pytest.mark.slow
def test_an_impedance_of_constant_resistance_is_its_root():
    # Zobel: R + L s beside R + 1/(C s) is R where R^2 = L/C, (1 + R C s)^2 = L C s^2 + 2 R C s + 1.
    for resistance in ("sqrt(L/C)", "sqrt(L)/sqrt(C)", "L/sqrt(L*C)", "sqrt(L*C)/C"):
        text = f"""symflex = 1
parameters = {{ L = "0.5 mH", C = "7.8 uF" }}
definitions = {{ R = "{resistance}" }}
[elements]
r1 = {{ type = "resistor", between = ["p", "a"], R = "R" }}
l1 = {{ type = "inductor", between = ["a", "ground"], L = "L" }}
r2 = {{ type = "resistor", between = ["p", "b"], R = "{resistance}" }}
c2 = {{ type = "capacitor", between = ["b", "ground"], C = "C" }}
[inputs]
I = {{ current = "p" }}
[outputs]
U = "p"
"""
        tf = pipeline.derive(pipeline.assemble(pipeline.loads(text)), "U", "I")
        assert tf.order == (0, 0), resistance
        assert abs(pipeline.bind(tf)(1j) - (0.5e-3 / 7.8e-6) ** 0.5) < 1e-14, resistance
        assert sum(int(h.polynomial.degrees()[0]) * h.multiplicity for h in tf.hidden) == 2, resistance
