"""From text to exact values with positions, and back: the specification as it was written."""

from symflex.model.spec.parse import parse, parse_with_recovery
from symflex.model.spec.positions import (
    ArrayValue,
    BooleanValue,
    KeyValue,
    NumberValue,
    OtherValue,
    Spec,
    StringValue,
    TableValue,
    Value,
)
from symflex.model.spec.read import read
