"""Factored rational functions agree with SymPy in every operation and stay canonical."""

from fractions import Fraction
from math import gcd

import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

from symflex.algebra import Factored, Ring, irreducible_factors, square_free_factors
from symflex.errors import BudgetError

NAMES = ("s", "a", "b", "c")
RING = Ring(NAMES)
SYMBOLS = sympy.symbols(NAMES)
QUIET = settings(max_examples=30)


def generator(name):
    return Factored.generator(RING, name)


def polynomial_to_sympy(polynomial, symbols=SYMBOLS):
    return sum(
        (
            int(c) * sympy.prod(x ** int(e) for x, e in zip(symbols, m, strict=True))
            for m, c in polynomial.terms()
        ),
        sympy.S.Zero,
    )


def to_sympy(value):
    result = sympy.Rational(value.unit.numerator, value.unit.denominator)
    for factor, exponent in value.factors:
        result *= polynomial_to_sympy(factor) ** exponent
    return result


def leaves():
    numbers = st.fractions(min_value=-4, max_value=4, max_denominator=6)
    rational = numbers.map(lambda q: (Factored.number(RING, q), sympy.Rational(q.numerator, q.denominator)))
    symbol = st.sampled_from(NAMES).map(lambda n: (generator(n), sympy.Symbol(n)))
    return st.one_of(rational, symbol)


def grown(inner):
    pair = st.tuples(inner, inner)
    add = pair.map(lambda p: (p[0][0] + p[1][0], p[0][1] + p[1][1]))
    subtract = pair.map(lambda p: (p[0][0] - p[1][0], p[0][1] - p[1][1]))
    multiply = pair.map(lambda p: (p[0][0] * p[1][0], p[0][1] * p[1][1]))
    divide = pair.filter(lambda p: not p[1][0].is_zero).map(lambda p: (p[0][0] / p[1][0], p[0][1] / p[1][1]))
    power = st.tuples(inner, st.integers(-2, 3)).filter(lambda p: p[1] >= 0 or not p[0][0].is_zero)
    raised = power.map(lambda p: (p[0][0] ** p[1], p[0][1] ** p[1]))
    negative = inner.map(lambda p: (-p[0], -p[1]))
    return st.one_of(add, subtract, multiply, divide, raised, negative)


EXPRESSIONS = st.recursive(leaves(), grown, max_leaves=6)


def assert_canonical(value):
    seen = [factor for factor, _ in value.factors]
    assert all(seen.count(f) == 1 for f in seen)
    assert value.unit or not value.factors
    for factor, exponent in value.factors:
        coefficients = [int(c) for _, c in factor.terms()]
        monomials = [tuple(int(e) for e in m) for m, _ in factor.terms()]
        assert exponent != 0
        assert gcd(*coefficients) == 1
        assert int(factor.leading_coefficient()) > 0
        if len(coefficients) == 1:
            assert sum(monomials[0]) == 1
        else:
            assert all(min(column) == 0 for column in zip(*monomials, strict=True))


@given(pair=EXPRESSIONS)
@QUIET
def test_every_operation_is_that_of_sympy_and_every_result_canonical(pair):
    value, expected = pair
    exact = to_sympy(value)
    assert sympy.cancel(exact - expected) == 0
    assert_canonical(value)
    above, below = value.numerator(), value.denominator()
    assert sympy.cancel(to_sympy(above) / to_sympy(below) - exact) == 0
    assert below.unit > 0
    assert all(e > 0 for _, e in (*above.factors, *below.factors))
    assert sympy.expand(to_sympy(above) - polynomial_to_sympy(above.expand())) == 0


@given(one=EXPRESSIONS, other=EXPRESSIONS)
@QUIET
def test_a_value_minus_itself_written_differently_is_zero(one, other):
    a, b = one[0], other[0]
    assert ((a + b) * (a - b) - (a * a - b * b)).is_zero


def test_values_print_as_they_are_kept():
    a, b, c, s = (generator(n) for n in "abcs")
    impedance = b * s + c
    for value, text in [
        # A sum keeps a common factor in front, and a product of equal sums is a power.
        (impedance * a + impedance * s, "(s*b + c)*(s + a)"),
        (impedance * impedance, "(s*b + c)^2"),
        # Equal sums of opposite sign are one factor.
        ((a - b) * (b - a), "-1*(a - b)^2"),
        # A sum of fractions has the common denominator, and a high power stays closed.
        (1 / a + 1 / b, "a^-1*b^-1*(a + b)"),
        ((s + 1) ** 30_000, "(s + 1)^30000"),
        (((a + 1) * s * 5).filter(lambda f: len(f) == 1), "s"),
    ]:
        assert str(value) == text
    # The numeric content is the unit.
    value = a * Fraction(4, 3) + b * 2
    assert (value.unit, str(value.factors[0][0])) == (Fraction(2, 3), "2*a + 3*b")


def test_zero_has_no_factors_and_its_power_zero_is_one():
    a = generator("a")
    assert (a - a).factors == (a * 0).factors == ()
    assert (a - a).is_zero
    assert ((a * 0) ** 0).is_one
    with pytest.raises(ZeroDivisionError):
        a / (a - a)


def test_a_reflected_difference_and_quotient_have_the_right_order():
    a = generator("a")
    assert sympy.cancel(to_sympy(3 - a) - (3 - sympy.Symbol("a"))) == 0
    assert sympy.cancel(to_sympy(3 / a) - 3 / sympy.Symbol("a")) == 0


def test_a_value_depends_on_the_generators_of_its_factors_only():
    value = (generator("a") + generator("s")) / generator("b")
    assert [value.depends_on(n) for n in NAMES] == [True, True, True, False]


def test_only_an_integer_polynomial_can_be_expanded():
    for value in [1 / generator("a"), generator("a") * Fraction(1, 2)]:
        with pytest.raises(ValueError, match="polynomial"):
            value.expand()


def test_an_expansion_of_too_many_terms_or_too_high_a_degree_is_refused_before_it_is_done():
    ring = Ring(("s", *(f"p{i}" for i in range(60))))
    long = Factored.polynomial(ring, sum((ring.generator(f"p{i}") for i in range(60)), ring.constant(0)))
    for value in (long**30, (generator("s") + 1) ** 30_000):
        with pytest.raises(BudgetError) as caught:
            value.expand()
        assert caught.value.diagnostics[0].code == "SF501"


def test_a_map_of_factors_is_a_homomorphism():
    target = Ring(("s", "z"))
    s, z = Factored.generator(target, "s"), Factored.generator(target, "z")
    images = {"s": s, "a": z + 1, "b": 1 / z, "c": z}

    def image(factor):
        total = Factored.number(target, 0)
        for monomial, coefficient in factor.terms():
            term = Factored.number(target, int(coefficient))
            for name, e in zip(NAMES, monomial, strict=True):
                term = term * images[name] ** int(e)
            total = total + term
        return total

    value = (generator("a") * generator("b") + generator("s")) ** 2 / generator("c")
    x, y = sympy.symbols("s z")
    mapped = value.map_factors(target, image)
    found = sympy.Rational(mapped.unit.numerator, mapped.unit.denominator)
    for factor, exponent in mapped.factors:
        found *= polynomial_to_sympy(factor, (x, y)) ** exponent
    assert sympy.cancel(found - ((y + 1) / y + x) ** 2 / y) == 0


# ----------------------------------------------------------------------------- polynomials taken apart


S, K = Ring(("s", "k")).context.gens()
LARGE = 2**400

coefficients = st.integers(min_value=-LARGE, max_value=LARGE).filter(bool)


@st.composite
def lines(draw):
    """A polynomial linear in s, with content 1 and positive leading coefficient: no polynomial divides it."""
    a, b = draw(st.integers(1, LARGE)), draw(coefficients)
    common = gcd(a, b)
    return S * (a // common) + K ** draw(st.integers(0, 2)) * (b // common)


@st.composite
def products(draw):
    """A number, and different irreducible polynomials with exponents."""
    found = draw(
        st.lists(st.tuples(lines(), st.integers(1, 3)), min_size=1, max_size=4, unique_by=lambda p: str(p[0]))
    )
    return draw(coefficients), {str(factor): exponent for factor, exponent in found}, found


def multiplied(number, factors):
    result = S**0 * number
    for factor, exponent in factors:
        result = result * factor**exponent
    return result


@settings(max_examples=60)
@given(products())
def test_factors_of_any_size_are_taken_apart_in_order_and_square_free_parts_multiply_to_what_they_are_of(
    product,
):
    number, expected, factors = product
    whole = multiplied(number, factors)
    found_number, found = irreducible_factors(whole)
    assert (found_number, {str(f): e for f, e in found}) == (number, expected)
    keys = [(exponent, [(m, int(c)) for m, c in factor.terms()]) for factor, exponent in found]
    assert keys == sorted(keys)
    parts = square_free_factors(whole)
    assert multiplied(*parts) == whole
    assert all(part.gcd(part.derivative("s")).is_constant() for part, _ in parts[1] if part.degrees()[0])


def test_a_sum_linear_in_every_letter_is_one_factor_unless_its_slope_shares_one_with_the_rest():
    assert irreducible_factors(S * K + 2) == (1, [(S * K + 2, 1)])
    assert irreducible_factors(S * K + S + K + 1) == (1, [(K + 1, 1), (S + 1, 1)])
    assert irreducible_factors(2 * S * K + 4) == (2, [(S * K + 2, 1)])
    assert irreducible_factors(-S * K - 2) == (-1, [(S * K + 2, 1)])
    assert irreducible_factors(S * K + S) == (1, [(K + 1, 1), (S, 1)])
