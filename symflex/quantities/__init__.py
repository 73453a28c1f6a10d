"""Numbers with units, read exactly: dimensions, units, quantities."""

from symflex.quantities.characters import (
    IMAGINARY_NAMES,
    IMAGINARY_UNIT,
    character_hint,
    code_point,
    name_hint,
)
from symflex.quantities.dimension import DIMENSIONLESS, Dimension
from symflex.quantities.quantity import Quantity, looks_like_quantity, parse_quantity, parse_unit, unit_of
from symflex.quantities.units import WRITTEN_OUT, Unit, unit_doubt, unit_named, unit_slip
