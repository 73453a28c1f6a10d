"""Random trees of the shape the parser gives: no sum directly in a sum, no product directly in a product."""

from dataclasses import replace
from fractions import Fraction

from hypothesis import strategies as st

from symflex.expressions import (
    PROGRAM_LIMITS,
    Attribute,
    Call,
    Derivative,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
)

# Random exponents may nest further than a text's; here only the shape is at stake.
SHAPE_LIMITS = replace(PROGRAM_LIMITS, exponent=10**40, bits=10**40)

identifiers = st.from_regex(r"[A-Za-z][A-Za-z0-9_]{0,4}", fullmatch=True)
integers = st.integers(0, 10**30).map(lambda n: Number(Fraction(n)))
decimals = st.builds(lambda n, k: Number(Fraction(n, 10**k)), st.integers(0, 10**20), st.integers(0, 60))
leaves = st.one_of(
    integers,
    decimals,
    identifiers.map(Name),
    st.builds(Attribute, identifiers, identifiers),
    st.builds(Derivative, identifiers, st.integers(1, 4)),
)


def _flat(kind, children):
    operands = tuple(
        c for child in children for c in (child.children if isinstance(child, kind) else (child,))
    )
    return kind(operands)


def _exponents(children):
    small = st.integers(0, 4).map(lambda n: Number(Fraction(n)))
    with_name = st.one_of(
        identifiers.map(Name),
        st.builds(lambda name, child: _flat(Sum, (Name(name), child)), identifiers, children),
        st.builds(lambda name, child: _flat(Product, (Name(name), child)), identifiers, children),
        st.builds(lambda name, child: Quotient(Name(name), child), identifiers, children),
    )
    power = st.builds(lambda name, n: Power(Name(name), n), identifiers, small)
    plain = st.one_of(small, with_name, power, st.just(Quotient(Number(Fraction(1)), Number(Fraction(2)))))
    return st.one_of(plain, plain.map(Negative))


def _grown(children):
    several = st.lists(children, min_size=2, max_size=4)
    return st.one_of(
        several.map(lambda c: _flat(Sum, c)),
        several.map(lambda c: _flat(Product, c)),
        st.builds(Quotient, children, children),
        st.builds(Power, children, _exponents(children)),
        st.builds(Negative, children),
        st.builds(Call, identifiers, children, st.integers(0, 3)),
    )


trees = st.recursive(leaves, _grown, max_leaves=25)
