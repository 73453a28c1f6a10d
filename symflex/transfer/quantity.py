"""What a transfer function is called, from the dimensions of its ends."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.quantities import DIMENSIONLESS, unit_of

if TYPE_CHECKING:
    from symflex.model import Input, Output
    from symflex.quantities import Dimension

_MOTION = {
    "translation": {"m": "receptance", "m/s": "mobility", "m/s^2": "accelerance"},
    "rotation": {"rad": "receptance", "rad/s": "mobility", "rad/s^2": "accelerance"},
}
_RATIOS = {
    ("V", "V"): "voltage gain",
    ("A", "A"): "current gain",
    ("A", "V"): "admittance",
    ("V", "A"): "impedance",
    ("N", "N"): "force ratio",
    ("N*m", "N*m"): "torque ratio",
}


def name_quantity(output: Output, source: Input) -> str:
    """Return the field's name for output over input, ``transfer function`` when there is none.

    Receptance, mobility and accelerance are displacement, velocity and acceleration per force or torque
    (Ewins 2000, table 1.1).
    """
    if output.dimension is None or source.dimension is None:
        return "transfer function"
    if source.kind in ("force", "torque"):
        motions = _MOTION["translation"] | _MOTION["rotation"]
        for unit, name in motions.items():
            if output.dimension == unit_of(unit).dimension:
                return name
    for (above, below), name in _RATIOS.items():
        if output.dimension == unit_of(above).dimension and source.dimension == unit_of(below).dimension:
            return name
    return "transfer function"


def unit_of_quotient(output: Output, source: Input) -> str:
    """Return the SI unit of output over input, empty when one of them is unknown."""
    if output.dimension is None or source.dimension is None:
        return ""
    return format_dimension(output.dimension / source.dimension)


def format_dimension(dimension: Dimension) -> str:
    """Return the unit, ``1`` for a pure number."""
    return "1" if dimension == DIMENSIONLESS else str(dimension)
