from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symflex.expressions import (
    Call,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    format_expression,
    negative,
    number,
    parse,
    power,
    product_of,
    quotient,
    sum_of,
)
from tests.unit.expressions.trees import SHAPE_LIMITS
from tests.unit.quantities.texts import text_of

a, b, c = (Name(name) for name in "abc")


def n(value):
    return Number(Fraction(value))


def test_a_built_tree_is_simplified_in_the_obvious_ways_and_no_others():
    for built, expected in [
        (number(3), n(3)), (number(Fraction(-1, 3)), Negative(n("1/3"))), (number(0), n(0)),
        (sum_of([]), n(0)), (sum_of([a]), a), (sum_of([a, number(0), b]), Sum((a, b))),
        (sum_of([a, Sum((b, c))]), Sum((a, b, c))),
        (sum_of([a, Negative(Sum((b, c)))]), Sum((a, Negative(Sum((b, c)))))),
        (sum_of([a, Negative(Negative(b))]), Sum((a, b))), (sum_of([a, Negative(number(0))]), a),
        (sum_of([number(1), number(2)]), Sum((n(1), n(2)))), (sum_of([a, a]), Sum((a, a))),
        (sum_of([a, Number(Fraction(-2))]), Sum((a, Negative(n(2))))), (product_of([]), n(1)),
        (product_of([a]), a), (product_of([a, number(1)]), a), (product_of([a, number(0)]), n(0)),
        (product_of([a, Product((b, c))]), Product((a, b, c))),
        (product_of([a, Negative(b)]), Negative(Product((a, b)))),
        (product_of([Negative(a), Negative(Product((n(3), b)))]), Product((n(3), a, b))),
        (product_of([a, n(2), b, n(3)]), Product((n(6), a, b))), (product_of([n(2), n("1/2"), a]), a),
        (product_of([number(-2), number(3)]), Negative(n(6))),
        (product_of([Number(Fraction(-2)), a]), Negative(Product((n(2), a)))),
        (product_of([a, a]), Product((a, a))), (quotient(a, b), Quotient(a, b)), (quotient(a, number(1)), a),
        (quotient(a, number(-1)), Negative(a)), (quotient(number(0), a), n(0)),
        (quotient(Negative(a), b), Negative(Quotient(a, b))),
        (quotient(Negative(a), Negative(b)), Quotient(a, b)), (quotient(n(4), n(2)), Quotient(n(4), n(2))),
        (power(a, 2), Power(a, n(2))), (power(a, 1), a), (power(a, 0), n(1)),
        (power(a, -1), Power(a, Negative(n(1)))), (power(a, b), Power(a, b)), (power(number(1), b), n(1)),
        (power(number(0), 2), n(0)), (power(number(0), b), Power(n(0), b)),
        (power(Negative(a), 2), Power(a, n(2))), (power(Negative(a), 3), Negative(Power(a, n(3)))),
        (power(Negative(a), -3), Negative(Power(a, Negative(n(3))))), (power(Negative(a), 1), Negative(a)),
        (power(number(-1), 3), Negative(n(1))), (power(Negative(a), n("1/2")), Power(Negative(a), n("1/2"))),
        (power(Negative(a), b), Power(Negative(a), b)), (power(number(2), 3), Power(n(2), n(3))),
        (negative(a), Negative(a)), (negative(Negative(a)), a), (negative(number(0)), n(0)),
        (negative(Number(Fraction(-2))), n(2)),
    ]:  # fmt: skip
        assert built == expected, built


def test_a_quotient_by_zero_is_refused():
    with pytest.raises(ZeroDivisionError):
        quotient(a, Negative(number(0)))


def test_a_negative_power_of_zero_is_refused():
    with pytest.raises(ZeroDivisionError):
        power(number(0), -1)


def test_a_nested_sum_of_any_depth_is_flat():
    tree = a
    for _ in range(3_000):
        tree = Negative(Negative(Sum((tree, b))))
    assert sum_of([tree]).terms == (a, *[b] * 3_000)


def _grown(children):
    several = st.lists(children, max_size=4)
    nonzero = children.filter(lambda e: e != number(0))
    return st.one_of(
        several.map(sum_of),
        several.map(product_of),
        st.builds(quotient, children, nonzero),
        st.builds(power, nonzero, st.integers(-3, 3)),
        st.builds(negative, children),
        st.builds(Call, st.just("sqrt"), children),
    )


# Numbers with a short decimal, so that they are read back as numbers.
built = st.recursive(
    st.one_of(st.integers(-20, 20).map(lambda k: number(Fraction(k, 4))), st.sampled_from([a, b, c])),
    _grown,
    max_leaves=15,
)


def _is_tidy(node):
    match node:
        case Negative(operand=operand):
            return not isinstance(operand, Negative)
        case Sum(terms=terms):
            return len(terms) > 1 and not any(isinstance(t, Sum) or t == number(0) for t in terms)
        case Product(factors=factors):
            return len(factors) > 1 and not any(
                isinstance(f, Negative | Product) or (isinstance(f, Number) and (i or f.value in (0, 1)))
                for i, f in enumerate(factors)
            )
        case Quotient(numerator=numerator, denominator=denominator):
            return not isinstance(numerator, Negative) and not isinstance(denominator, Negative)
    return True


@settings(max_examples=50)
@given(built)
@pytest.mark.slow
def test_a_built_tree_is_tidy_and_is_read_back_as_itself(tree):
    assert parse(text_of(format_expression(tree)), limits=SHAPE_LIMITS) == tree
    pending = [tree]
    while pending:
        node = pending.pop()
        assert _is_tidy(node)
        pending.extend(node.children)
