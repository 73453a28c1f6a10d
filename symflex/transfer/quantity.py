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
_PER_MOTION = {
    "displacement": ("N", "dynamic stiffness"),
    "velocity": ("N", "mechanical impedance"),
    "acceleration": ("N", "apparent mass"),
    "angle": ("N*m", "dynamic stiffness"),
    "angular_velocity": ("N*m", "mechanical impedance"),
    "angular_acceleration": ("N*m", "apparent inertia"),
}
"""What an effort per imposed motion is called; the same motion elsewhere is a transmissibility (ISO 2041)."""
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
    (Ewins 2000, table 1.1), and their inverses are of an
    effort per imposed motion. ``known`` is the quotient's dimension: a field's equations are homogeneous, and
    tell no more.
    """
    if output.dimension is None or source.dimension is None:
        return next((name for unit, name in _FLEXIBILITIES if known == unit_of(unit).dimension), NAMELESS)
    if source.kind in ("force", "torque") or source.dimension in _EFFORTS:
        motions = _MOTION["translation"] | _MOTION["rotation"]
        for unit, name in motions.items():
            if output.dimension == unit_of(unit).dimension:
                return name
    if source.kind in _PER_MOTION:
        effort, name = _PER_MOTION[source.kind]
        if output.dimension == source.dimension:
            return "transmissibility"
        if output.dimension == unit_of(effort).dimension:
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
    >>> quotient_of_units("m/s^2", "m/s"), quotient_of_units("m", "m/s^2")
    ('1/s', 's^2')
    """
    exponents: dict[str, int] = {}
    sides = [(_parts(above), 1), (_parts(below), -1)]
    # In this order the symbols above the line come first as they are written, then those that get there.
    for side in (0, 1):
        for parts, sign in sides if side == 0 else reversed(sides):
            for symbol, power in parts[side]:
                exponents[symbol] = exponents.get(symbol, 0) + (power if side == 0 else -power) * sign
    up = [_raised(symbol, e) for symbol, e in exponents.items() if e > 0]
    down = [_raised(symbol, -e) for symbol, e in exponents.items() if e < 0]
    numerator = "*".join(up) or "1"
    if not down:
        return numerator
    return f"{numerator}/{down[0]}" if len(down) == 1 else f"{numerator}/({'*'.join(down)})"


def _raised(symbol: str, exponent: int) -> str:
    return symbol if exponent == 1 else f"{symbol}^{exponent}"


def _parts(unit: str) -> tuple[list[tuple[str, int]], list[tuple[str, int]]]:
    """Return the symbols above and below the slash of a preferred unit, with their powers."""
    above, _, below = unit.partition("/")
    sides = []
    for part in (above, below.strip("()")):
        pairs = [(f, *f.partition("^")) for f in part.split("*") if f not in ("", "1")]
        # A root's exponent is a fraction in brackets, and stays as it is written.
        sides.append([(s, int(p or 1)) if (p or "1").isdigit() else (f, 1) for f, s, _, p in pairs])
    return sides[0], sides[1]
