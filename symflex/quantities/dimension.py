"""Physical dimensions: exponents of the seven SI base units, and the unit an engineer prints for them."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Final

_ZERO: Final = Fraction(0)


@dataclass(frozen=True, order=True, slots=True)
class Dimension:
    """Exponents of the SI base units; angles and cycles have dimension one."""

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


def _row(unit: str, *exponents: int) -> tuple[Dimension, str]:
    return Dimension(*(Fraction(exponent) for exponent in exponents)), unit


# Exponents in the order kg, m, s, A, K, mol, cd; trailing zeros left out. Where a dimension has several
# readings (N*m: torque, energy, torsional stiffness) the field's own is chosen.
_UNITS: Final = (
    _row("1"),  # pure number
    # base
    _row("kg", 1),  # mass
    _row("m", 0, 1),  # length
    _row("s", 0, 0, 1),  # time
    _row("A", 0, 0, 0, 1),  # current
    _row("K", 0, 0, 0, 0, 1),  # temperature
    _row("mol", 0, 0, 0, 0, 0, 1),  # amount of substance
    _row("cd", 0, 0, 0, 0, 0, 0, 1),  # luminous intensity
    # geometry and motion
    _row("m^2", 0, 2),  # area
    _row("m^3", 0, 3),  # volume
    _row("m^4", 0, 4),  # second moment of area
    _row("1/m", 0, -1),  # wavenumber
    _row("1/m^2", 0, -2),  # squared wavenumber
    _row("1/s", 0, 0, -1),  # frequency
    _row("1/s^2", 0, 0, -2),  # angular acceleration
    _row("s^2", 0, 0, 2),  # squared time
    _row("m/s", 0, 1, -1),  # velocity
    _row("m/s^2", 0, 1, -2),  # acceleration
    _row("m/s^3", 0, 1, -3),  # jerk
    _row("m^2/s", 0, 2, -1),  # diffusivity
    _row("s/m", 0, -1, 1),  # slowness
    # mechanics
    _row("kg/m", 1, -1),  # mass per length
    _row("kg/m^2", 1, -2),  # mass per area
    _row("kg/m^3", 1, -3),  # density
    _row("kg*m", 1, 1),  # first moment of mass
    _row("kg*m^2", 1, 2),  # moment of inertia
    _row("N", 1, 1, -2),  # force
    _row("N/m", 1, 0, -2),  # stiffness
    _row("N*s/m", 1, 0, -1),  # damping
    _row("N*s", 1, 1, -1),  # momentum
    _row("N*m", 1, 2, -2),  # torque
    _row("N*m*s", 1, 2, -1),  # rotary damping
    _row("N*m^2", 1, 3, -2),  # bending stiffness
    _row("Pa", 1, -1, -2),  # pressure
    _row("Pa*s", 1, -1, -1),  # viscosity
    _row("N/m^3", 1, -2, -2),  # pressure gradient
    _row("W", 1, 2, -3),  # power
    _row("m/N", -1, 0, 2),  # receptance
    _row("m/(N*s)", -1, 0, 1),  # mobility
    _row("m/(N*s^2)", -1),  # accelerance
    _row("m^2/N", -1, 1, 2),  # receptance per load along a line
    _row("m^2/(N*s)", -1, 1, 1),  # mobility per load along a line
    _row("m^2/(N*s^2)", -1, 1),  # accelerance per load along a line
    _row("1/N", -1, -1, 2),  # angular receptance per force
    _row("1/(N*s)", -1, -1, 1),  # angular mobility per force
    _row("1/(N*s^2)", -1, -1),  # angular accelerance per force
    _row("1/(N*m)", -1, -2, 2),  # angular receptance
    _row("1/(N*m*s)", -1, -2, 1),  # angular mobility
    _row("1/(N*m*s^2)", -1, -2),  # angular accelerance
    # sound and liquids
    _row("Pa*s/m", 1, -2, -1),  # specific acoustic impedance
    _row("Pa*s/m^3", 1, -4, -1),  # acoustic impedance
    _row("m^3/Pa", -1, 4, 2),  # acoustic compliance
    _row("m^3/(Pa*s)", -1, 4, 1),  # acoustic admittance
    # heat
    _row("W/K", 1, 2, -3, 0, -1),  # thermal conductance
    _row("W/(m*K)", 1, 1, -3, 0, -1),  # thermal conductivity
    _row("W/(m^2*K)", 1, 0, -3, 0, -1),  # heat transfer coefficient
    _row("K/W", -1, -2, 3, 0, 1),  # thermal resistance
    _row("K*m^2/W", -1, 0, 3, 0, 1),  # thermal resistance of an area
    _row("J/K", 1, 2, -2, 0, -1),  # heat capacity
    _row("J/(kg*K)", 0, 2, -2, 0, -1),  # specific heat
    # electricity
    _row("C", 0, 0, 1, 1),  # charge
    _row("V", 1, 2, -3, -1),  # voltage
    _row("Ohm", 1, 2, -3, -2),  # resistance
    _row("A/V", -1, -2, 3, 2),  # conductance
    _row("H", 1, 2, -2, -2),  # inductance
    _row("F", -1, -2, 4, 2),  # capacitance
    _row("T", 1, 0, -2, -1),  # magnetic flux density
    _row("Ohm/m", 1, 1, -3, -2),  # resistance of a line
    _row("H/m", 1, 1, -2, -2),  # inductance of a line
    _row("F/m", -1, -3, 4, 2),  # capacitance of a line
    _row("V/m", 1, 1, -3, -1),  # electric field
    _row("A/m", 0, -1, 0, 1),  # magnetic field
    _row("A/s", 0, 0, -1, 1),  # current slope
    _row("V/s", 1, 2, -4, -1),  # voltage slope
    _row("V/(A*s)", 1, 2, -4, -2),  # resistance per time
    # transduction
    _row("V*s", 1, 2, -2, -1),  # motor constant
    _row("N/A", 1, 1, -2, -1),  # force constant
    _row("N/V", 0, -1, 1, 1),  # force per voltage
    _row("V/N", 0, 1, -1, -1),  # voltage per force
    _row("V*s^2", 1, 2, -1, -1),  # voltage per angular acceleration
    _row("V*s^2/m", 1, 1, -1, -1),  # voltage per acceleration
    _row("m/A", 0, 1, 0, -1),  # displacement per current
    _row("m/V", -1, -1, 3, 1),  # displacement per voltage
    _row("m/(V*s)", -1, -1, 2, 1),  # velocity per voltage
    _row("m/(V*s^2)", -1, -1, 1, 1),  # acceleration per voltage
    _row("1/V", -1, -2, 3, 1),  # angle per voltage
    _row("1/(V*s)", -1, -2, 2, 1),  # angular velocity per voltage
    _row("1/(V*s^2)", -1, -2, 1, 1),  # angular acceleration per voltage
    _row("1/A", 0, 0, 0, -1),  # angle per current
)

PREFERRED_UNITS: Final[dict[Dimension, str]] = dict(_UNITS)
