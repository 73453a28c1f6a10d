"""Expressions as text and as trees: read, printed, built and searched."""

from symflex.expressions.format import format_expression, text_length
from symflex.expressions.limits import PROGRAM_LIMITS, USER_LIMITS
from symflex.expressions.nodes import (
    Attribute,
    Bessel,
    Call,
    Derivative,
    Differentiated,
    Equation,
    Expression,
    Measured,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    fold,
    is_longer,
    is_number,
    measured,
    names,
    names_among,
    names_in,
    negative,
    nodes,
    number,
    once,
    power,
    product_of,
    quotient,
    replace_node,
    replace_values,
    substitute,
    sum_of,
    sums_in,
    with_children,
)
from symflex.expressions.parse import parse, parse_equation
from symflex.expressions.slips import FUNCTIONS, RECIPROCALS
