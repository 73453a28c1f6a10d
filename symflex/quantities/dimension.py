"""Physical dimensions: exponents of the seven SI base units, and the unit an engineer prints for them."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Final

_ZERO: Final = Fraction(0)


@dataclass(frozen=True, order=True, slots=True)
class Dimension:
    """Exponents of the SI base units; angles and cycles have dimension one.

    Examples
    --------
    >>> length, time = Dimension(m=Fraction(1)), Dimension(s=Fraction(1))
    >>> str(length / time**2)
    'm/s^2'
    >>> str(length ** Fraction(1, 2))
    'm^(1/2)'
    """

    # kg, m, s, A, K, mol and cd: exponent of each base unit; half exponents appear under square roots.
    kg: Fraction = _ZERO
    m: Fraction = _ZERO
    s: Fraction = _ZERO
    A: Fraction = _ZERO
    K: Fraction = _ZERO
    mol: Fraction = _ZERO
    cd: Fraction = _ZERO

    @property
    def exponents(self) -> tuple[Fraction, ...]:
        """The seven exponents in the order kg, m, s, A, K, mol, cd."""
        return (self.kg, self.m, self.s, self.A, self.K, self.mol, self.cd)

    def __mul__(self, other: Dimension) -> Dimension:
        """Return the dimension of a product."""
        if other is DIMENSIONLESS:
            return self
        if self is DIMENSIONLESS:
            return other
        return Dimension(*(a + b for a, b in zip(self.exponents, other.exponents, strict=True)))

    def __truediv__(self, other: Dimension) -> Dimension:
        """Return the dimension of a quotient."""
        if other is DIMENSIONLESS:
            return self
        return Dimension(*(a - b for a, b in zip(self.exponents, other.exponents, strict=True)))

    def __pow__(self, exponent: Fraction | int) -> Dimension:
        """Return the dimension of a power; the exponent is rational."""
        if self is DIMENSIONLESS:
            return self
        return Dimension(*(a * Fraction(exponent) for a in self.exponents))

    def __str__(self) -> str:
        """Return the preferred SI unit; :func:`symflex.quantities.unit_of` reads it back."""
        return PREFERRED_UNITS.get(self) or _product_of_base_units(self)


DIMENSIONLESS: Final = Dimension()

# s stands last, as in kg*m^2/(A*s^3).
_PRINTED_ORDER: Final = ("kg", "m", "A", "K", "mol", "cd", "s")


def _product_of_base_units(dimension: Dimension) -> str:
    powers = [(unit, Fraction(getattr(dimension, unit))) for unit in _PRINTED_ORDER]
    above = [_power(unit, exponent) for unit, exponent in powers if exponent > 0]
    below = [_power(unit, -exponent) for unit, exponent in powers if exponent < 0]
    numerator = "*".join(above) or "1"
    if not below:
        return numerator
    denominator = "*".join(below)
    return f"{numerator}/({denominator})" if len(below) > 1 else f"{numerator}/{denominator}"


def _power(unit: str, exponent: Fraction) -> str:
    if exponent == 1:
        return unit
    return f"{unit}^{exponent}" if exponent.denominator == 1 else f"{unit}^({exponent})"


def _row(unit: str, name: str, *exponents: int) -> tuple[Dimension, str, str]:
    return Dimension(*(Fraction(exponent) for exponent in exponents)), unit, name


# Exponents in the order kg, m, s, A, K, mol, cd; trailing zeros left out. Where a dimension has several
# readings (N*m: torque, energy, torsional stiffness) the field's own is chosen.
_NAMED: Final = (
    _row("1", "pure number"),
    # base
    _row("kg", "mass", 1),
    _row("m", "length", 0, 1),
    _row("s", "time", 0, 0, 1),
    _row("A", "current", 0, 0, 0, 1),
    _row("K", "temperature", 0, 0, 0, 0, 1),
    _row("mol", "amount of substance", 0, 0, 0, 0, 0, 1),
    _row("cd", "luminous intensity", 0, 0, 0, 0, 0, 0, 1),
    # geometry and motion
    _row("m^2", "area", 0, 2),
    _row("m^3", "volume", 0, 3),
    _row("m^4", "second moment of area", 0, 4),
    _row("1/m", "wavenumber", 0, -1),
    _row("1/m^2", "squared wavenumber", 0, -2),
    _row("1/s", "frequency", 0, 0, -1),
    _row("1/s^2", "angular acceleration", 0, 0, -2),
    _row("s^2", "squared time", 0, 0, 2),
    _row("m/s", "velocity", 0, 1, -1),
    _row("m/s^2", "acceleration", 0, 1, -2),
    _row("m/s^3", "jerk", 0, 1, -3),
    _row("m^2/s", "diffusivity", 0, 2, -1),
    _row("s/m", "slowness", 0, -1, 1),
    # mechanics
    _row("kg/m", "mass per length", 1, -1),
    _row("kg/m^2", "mass per area", 1, -2),
    _row("kg/m^3", "density", 1, -3),
    _row("kg*m", "first moment of mass", 1, 1),
    _row("kg*m^2", "moment of inertia", 1, 2),
    _row("N", "force", 1, 1, -2),
    _row("N/m", "stiffness", 1, 0, -2),
    _row("N*s/m", "damping", 1, 0, -1),
    _row("N*s", "momentum", 1, 1, -1),
    _row("N*m", "torque", 1, 2, -2),
    _row("N*m*s", "rotary damping", 1, 2, -1),
    _row("N*m^2", "bending stiffness", 1, 3, -2),
    _row("Pa", "pressure", 1, -1, -2),
    _row("Pa*s", "viscosity", 1, -1, -1),
    _row("N/m^3", "pressure gradient", 1, -2, -2),
    _row("W", "power", 1, 2, -3),
    _row("m/N", "receptance", -1, 0, 2),
    _row("m/(N*s)", "mobility", -1, 0, 1),
    _row("m/(N*s^2)", "accelerance", -1),
    _row("m^2/N", "receptance per load along a line", -1, 1, 2),
    _row("m^2/(N*s)", "mobility per load along a line", -1, 1, 1),
    _row("m^2/(N*s^2)", "accelerance per load along a line", -1, 1),
    _row("1/N", "angular receptance per force", -1, -1, 2),
    _row("1/(N*s)", "angular mobility per force", -1, -1, 1),
    _row("1/(N*s^2)", "angular accelerance per force", -1, -1),
    _row("1/(N*m)", "angular receptance", -1, -2, 2),
    _row("1/(N*m*s)", "angular mobility", -1, -2, 1),
    _row("1/(N*m*s^2)", "angular accelerance", -1, -2),
    _row("K*m^2/W", "thermal resistance of an area", -1, 0, 3, 0, 1),
    # electricity
    _row("C", "charge", 0, 0, 1, 1),
    _row("V", "voltage", 1, 2, -3, -1),
    _row("Ohm", "resistance", 1, 2, -3, -2),
    _row("A/V", "conductance", -1, -2, 3, 2),
    _row("H", "inductance", 1, 2, -2, -2),
    _row("F", "capacitance", -1, -2, 4, 2),
    _row("T", "magnetic flux density", 1, 0, -2, -1),
    _row("V/m", "electric field", 1, 1, -3, -1),
    _row("A/m", "magnetic field", 0, -1, 0, 1),
    _row("A/s", "current slope", 0, 0, -1, 1),
    _row("V/s", "voltage slope", 1, 2, -4, -1),
    _row("V/(A*s)", "resistance per time", 1, 2, -4, -2),
    # transduction
    _row("V*s", "motor constant", 1, 2, -2, -1),
    _row("N/A", "force constant", 1, 1, -2, -1),
    _row("N/V", "force per voltage", 0, -1, 1, 1),
    _row("V/N", "voltage per force", 0, 1, -1, -1),
    _row("V*s^2", "voltage per angular acceleration", 1, 2, -1, -1),
    _row("V*s^2/m", "voltage per acceleration", 1, 1, -1, -1),
    _row("m/A", "displacement per current", 0, 1, 0, -1),
    _row("m/V", "displacement per voltage", -1, -1, 3, 1),
    _row("m/(V*s)", "velocity per voltage", -1, -1, 2, 1),
    _row("m/(V*s^2)", "acceleration per voltage", -1, -1, 1, 1),
    _row("1/V", "angle per voltage", -1, -2, 3, 1),
    _row("1/(V*s)", "angular velocity per voltage", -1, -2, 2, 1),
    _row("1/(V*s^2)", "angular acceleration per voltage", -1, -2, 1, 1),
    _row("1/A", "angle per current", 0, 0, 0, -1),
)

PREFERRED_UNITS: Final[dict[Dimension, str]] = {dimension: unit for dimension, unit, _ in _NAMED}
_NAMES: Final[dict[Dimension, str]] = {dimension: name for dimension, _, name in _NAMED}


def dimension_name(dimension: Dimension) -> str | None:
    """Return the field's word for a dimension, or ``None`` when it has none.

    A dimension with several readings gets one: ``N*m`` is "torque", also where an energy is meant.

    Examples
    --------
    >>> dimension_name(Dimension(kg=Fraction(1), s=Fraction(-2)))
    'stiffness'
    """
    return _NAMES.get(dimension)
