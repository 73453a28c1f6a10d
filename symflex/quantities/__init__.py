"""Numbers with units, read exactly: dimensions, units, quantities."""

from symflex.quantities.dimension import DIMENSIONLESS, Dimension, dimension_name
from symflex.quantities.quantity import Quantity, looks_like_quantity, parse_quantity, parse_unit, unit_of
from symflex.quantities.units import Unit, pound_hint

__all__ = [
    "DIMENSIONLESS",
    "Dimension",
    "Quantity",
    "Unit",
    "dimension_name",
    "looks_like_quantity",
    "parse_quantity",
    "parse_unit",
    "pound_hint",
    "unit_of",
]
