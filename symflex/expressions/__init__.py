"""Expressions as text and as trees: read, printed, built and searched."""

from symflex.expressions.format import format_expression
from symflex.expressions.limits import PROGRAM_LIMITS, USER_LIMITS, Limits
from symflex.expressions.nodes import (
    Attribute,
    Call,
    Derivative,
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
    is_number,
    negative,
    number,
    power,
    product_of,
    quotient,
    sum_of,
)
from symflex.expressions.parse import parse, parse_equation
from symflex.expressions.slips import FUNCTIONS
from symflex.expressions.walk import measured, names, nodes, replace_values, substitute

__all__ = [
    "FUNCTIONS",
    "PROGRAM_LIMITS",
    "USER_LIMITS",
    "Attribute",
    "Call",
    "Derivative",
    "Equation",
    "Expression",
    "Limits",
    "Measured",
    "Name",
    "Negative",
    "Number",
    "Power",
    "Product",
    "Quotient",
    "Sum",
    "format_expression",
    "is_number",
    "measured",
    "names",
    "negative",
    "nodes",
    "number",
    "parse",
    "parse_equation",
    "power",
    "product_of",
    "quotient",
    "replace_values",
    "substitute",
    "sum_of",
]
