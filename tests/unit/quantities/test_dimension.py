from dataclasses import FrozenInstanceError
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symflex.quantities import DIMENSIONLESS, Dimension, unit_of
from symflex.quantities.dimension import _UNITS, PREFERRED_UNITS

MASS, LENGTH, TIME = Dimension(kg=Fraction(1)), Dimension(m=Fraction(1)), Dimension(s=Fraction(1))
CURRENT = Dimension(A=Fraction(1))
FORCE = MASS * LENGTH / TIME**2
VOLTAGE = FORCE * LENGTH / TIME / CURRENT

exponents = st.fractions(min_value=-12, max_value=12, max_denominator=4)
dimensions = st.builds(Dimension, *[exponents.filter(lambda e: abs(e.numerator) <= 12)] * 7)


def test_a_product_adds_exponents():
    assert MASS * LENGTH == Dimension(kg=Fraction(1), m=Fraction(1))


def test_a_quotient_subtracts_exponents():
    assert LENGTH / TIME == Dimension(m=Fraction(1), s=Fraction(-1))


def test_a_dimension_over_itself_is_dimensionless():
    assert VOLTAGE / VOLTAGE == DIMENSIONLESS


def test_a_power_may_be_rational():
    assert (LENGTH**2) ** Fraction(1, 2) == LENGTH


def test_a_dimension_cannot_be_changed():
    with pytest.raises(FrozenInstanceError):
        MASS.kg = Fraction(2)


def test_dimensions_have_an_order():
    assert sorted([MASS, LENGTH, DIMENSIONLESS]) == [DIMENSIONLESS, LENGTH, MASS]


def test_a_common_dimension_prints_as_engineers_write_it():
    for dimension, printed in [
        (DIMENSIONLESS, "1"), (MASS, "kg"), (LENGTH, "m"), (LENGTH / TIME, "m/s"),
        (LENGTH / TIME**2, "m/s^2"), (FORCE, "N"), (FORCE / LENGTH, "N/m"), (MASS / TIME, "N*s/m"),
        (FORCE * LENGTH, "N*m"), (FORCE * LENGTH * TIME, "N*m*s"), (FORCE * LENGTH**2, "N*m^2"),
        (FORCE / LENGTH**2, "Pa"), (FORCE * LENGTH / TIME, "W"), (VOLTAGE, "V"), (CURRENT, "A"),
        (VOLTAGE / CURRENT, "Ohm"), (VOLTAGE * TIME / CURRENT, "H"), (CURRENT * TIME / VOLTAGE, "F"),
        (DIMENSIONLESS / TIME, "1/s"), (MASS * LENGTH**2, "kg*m^2"), (VOLTAGE * TIME, "V*s"),
        (FORCE * LENGTH / CURRENT, "V*s"), (FORCE / CURRENT, "N/A"), (LENGTH / FORCE, "m/N"),
        (LENGTH / FORCE / TIME, "m/(N*s)"), (LENGTH / FORCE / TIME**2, "m/(N*s^2)"),
        (MASS / LENGTH**3, "kg/m^3"), (LENGTH**2, "m^2"), (LENGTH**4, "m^4"),
    ]:  # fmt: skip
        assert str(dimension) == printed, dimension


def test_any_other_dimension_prints_as_a_product_of_base_units():
    for dimension, printed in [
        (VOLTAGE**2, "kg^2*m^4/(A^2*s^6)"),
        (VOLTAGE / TIME**2, "kg*m^2/(A*s^5)"),
        (MASS**2, "kg^2"),
        (DIMENSIONLESS / MASS**2, "1/kg^2"),
        (DIMENSIONLESS / TIME / LENGTH, "1/(m*s)"),
        (MASS / TIME**4, "kg/s^4"),
        (LENGTH ** Fraction(1, 2), "m^(1/2)"),
        (LENGTH / TIME ** Fraction(3, 2), "m/s^(3/2)"),
    ]:
        assert str(dimension) == printed, dimension


def test_a_preferred_unit_reads_back_as_its_dimension():
    for dimension in PREFERRED_UNITS:
        assert unit_of(PREFERRED_UNITS[dimension]).dimension == dimension, dimension


def test_a_preferred_unit_is_coherent():
    for unit in PREFERRED_UNITS.values():
        assert unit_of(unit).scale == 1, unit


@settings(max_examples=20)
@given(dimensions)
@pytest.mark.slow
def test_any_printed_dimension_reads_back_as_itself(dimension):
    assert unit_of(str(dimension)).dimension == dimension


def test_no_dimension_is_listed_twice():
    assert len(_UNITS) == len(PREFERRED_UNITS)
