"""What a transfer function is called, from the dimensions of its ends."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.quantities import unit_of

if TYPE_CHECKING:
    from symflex.model import Input, Output
    from symflex.quantities import Dimension

_MOTION = {
    "translation": {"m": "receptance", "m/s": "mobility", "m/s^2": "accelerance"},
    "rotation": {"rad": "receptance", "rad/s": "mobility", "rad/s^2": "accelerance"},
}
_EFFORTS = tuple(unit_of(unit).dimension for unit in ("N", "N*m"))
"""What a free signal may be that loads a field: a force or a torque."""
_FLEXIBILITIES = (("m/N", "receptance"), ("m/(N*s)", "mobility"), ("m/(N*s^2)", "accelerance"))
NAMELESS = "transfer function"
_RATIOS = {
    ("V", "V"): "voltage gain",
    ("A", "A"): "current gain",
    ("A", "V"): "admittance",
    ("V", "A"): "impedance",
    ("N", "N"): "force ratio",
    ("N*m", "N*m"): "torque ratio",
}


def name_quantity(output: Output, source: Input, known: Dimension | None = None) -> str:
    """Return the field's name for output over input, ``transfer function`` when there is none.

    Receptance, mobility and accelerance are displacement, velocity and acceleration per force or torque
    (Ewins 2000, table 1.1). ``known`` is the quotient's dimension: a field's equations are homogeneous, and
    tell no more.
    """
    if output.dimension is None or source.dimension is None:
        return next((name for unit, name in _FLEXIBILITIES if known == unit_of(unit).dimension), NAMELESS)
    if source.kind in ("force", "torque") or source.dimension in _EFFORTS:
        motions = _MOTION["translation"] | _MOTION["rotation"]
        for unit, name in motions.items():
            if output.dimension == unit_of(unit).dimension:
                return name
    for (above, below), name in _RATIOS.items():
        if output.dimension == unit_of(above).dimension and source.dimension == unit_of(below).dimension:
            return name
    return NAMELESS


def unit_of_quotient(output: Output, source: Input, known: Dimension | None) -> str:
    """Return the SI unit of output over input, empty when it is unknown.

    ``known`` is the quotient's dimension, which may be known where one of the ends is not.
    """
    if output.dimension is None or source.dimension is None:
        return "" if known is None else str(known)
    return quotient_of_units(str(output.dimension), str(source.dimension))


def quotient_of_units(above: str, below: str) -> str:
    """Return one unit over another in the words of both, so that m/s over A is not called V/N.

    Examples
    --------
    >>> quotient_of_units("m/s^2", "N"), quotient_of_units("V", "V"), quotient_of_units("A", "V/m")
    ('m/(N*s^2)', '1', 'A*m/V')
    """
    above_up, above_down = _parts(above)
    below_up, below_down = _parts(below)
    up, down = [*above_up, *below_down], [*below_up, *above_down]
    for symbol in list(up):
        if symbol in down:
            up.remove(symbol)
            down.remove(symbol)
    numerator = "*".join(up) or "1"
    if not down:
        return numerator
    return f"{numerator}/{down[0]}" if len(down) == 1 else f"{numerator}/({'*'.join(down)})"


def _parts(unit: str) -> tuple[list[str], list[str]]:
    """Return the symbols above and below the slash of a preferred unit."""
    above, _, below = unit.partition("/")
    up = [symbol for symbol in above.split("*") if symbol != "1"]
    return up, [symbol for symbol in below.strip("()").split("*") if symbol]
