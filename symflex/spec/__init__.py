"""From text to exact values with positions, and back: the specification as it was written."""

from symflex.spec.parse import parse, parse_with_recovery
from symflex.spec.read import read
from symflex.spec.values import (
    ArrayValue,
    BooleanValue,
    Entry,
    NumberValue,
    OtherValue,
    Spec,
    StringValue,
    TableValue,
    Value,
)
from symflex.spec.write import write

__all__ = [
    "ArrayValue",
    "BooleanValue",
    "Entry",
    "NumberValue",
    "OtherValue",
    "Spec",
    "StringValue",
    "TableValue",
    "Value",
    "parse",
    "parse_with_recovery",
    "read",
    "write",
]
