"""Every unit and prefix against pint, which keeps its own tables."""

from fractions import Fraction

import pint
import pytest

from symflex.quantities import Unit, unit_of
from symflex.quantities.units import (
    _INSTEAD,
    PLAIN_UNITS,
    PREFIXABLE_UNITS,
    PREFIXES,
    UNITS,
    unit_hint,
    unit_named,
)

PINT_PREFIXES = {
    "Q": "quetta", "R": "ronna", "Y": "yotta", "Z": "zetta", "E": "exa", "P": "peta", "T": "tera",
    "G": "giga", "M": "mega", "k": "kilo", "h": "hecto", "da": "deca", "d": "deci", "c": "centi",
    "m": "milli", "u": "micro", "\u00b5": "micro", "\u03bc": "micro", "n": "nano", "p": "pico",
    "f": "femto", "a": "atto", "z": "zepto", "y": "yocto", "r": "ronto", "q": "quecto",
}  # fmt: skip

PINT_UNITS = {
    "m": "meter", "g": "gram", "s": "second", "A": "ampere", "K": "kelvin", "mol": "mole",
    "cd": "candela", "rad": "radian", "sr": "steradian", "Hz": "hertz", "N": "newton", "Pa": "pascal",
    "J": "joule", "W": "watt", "C": "coulomb", "V": "volt", "F": "farad", "Ohm": "ohm", "ohm": "ohm",
    "\u03a9": "ohm", "\u2126": "ohm", "S": "siemens", "Wb": "weber", "T": "tesla", "H": "henry",
    "lm": "lumen", "lx": "lux", "L": "liter", "l": "liter", "bar": "bar", "Wh": "watt_hour",
    "Ah": "ampere_hour", "gf": "gram_force", "deg": "degree", "rpm": "revolutions_per_minute",
    "t": "metric_ton", "min": "minute", "h": "hour", "\u00b0": "degree", "arcmin": "arcminute",
    "arcsec": "arcsecond", "rev": "turn", "cycle": "turn", "%": "percent", "ppm": "ppm",
    "g_n": "standard_gravity", "dyn": "dyne", "atm": "standard_atmosphere", "in": "inch", "inch": "inch",
    "mil": "thou", "ft": "foot", "yd": "yard", "mi": "mile", "lb": "pound", "lbm": "pound", "oz": "ounce",
    "slug": "slug", "lbf": "force_pound", "ozf": "force_ounce", "kip": "kip", "psi": "psi", "ksi": "ksi",
    "hp": "horsepower", "Torr": "torr", "P": "poise", "St": "stokes", "cal": "calorie", "thou": "thou",
    "Mpsi": "megapsi", "mmHg": "millimeter_Hg", "inHg": "inch_Hg",
    "mmH2O": "centimeter_H2O*millimeter/centimeter", "cmH2O": "centimeter_H2O",
    "inH2O": "inch_H2O", "gal": "gallon", "gpm": "gallon/minute",
    "lpm": "liter/minute", "cfm": "foot^3/minute", "cc": "cubic_centimeter", "mph": "mile/hour",
    "rps": "turn/second", "day": "day", "knot": "knot",
    "tf": "metric_ton*standard_gravity", "gauss": "millitesla*decitesla/tesla", "Btu": "Btu_it",
}  # fmt: skip

BASE_OF_PINT = {
    "[mass]": "kg", "[length]": "m", "[time]": "s", "[current]": "A", "[temperature]": "K",
    "[substance]": "mol", "[luminosity]": "cd",
}  # fmt: skip


@pytest.fixture(scope="module")
def registry():
    return pint.UnitRegistry(non_int_type=Fraction)


def factor_in_pint(registry, name):
    quantity = registry.Quantity(Fraction(1), name).to_root_units()
    # The kilogram is no root unit of pint.
    return Fraction(quantity.magnitude) / Fraction(1000) ** quantity.dimensionality.get("[mass]", 0)


def factor_here(registry, unit, name):
    pi = Fraction(registry.Quantity(Fraction(1), "pi").to_root_units().magnitude)
    # Pint's turn is 2 pi radians, and so is its rpm; its hertz is 1/s.
    cycles = 0 if name == "Hz" else unit.cycles
    return unit.scale * pi**unit.pi_power * (2 * pi) ** cycles


def exponents(dimensionality):
    return {BASE_OF_PINT[name]: Fraction(exponent) for name, exponent in dimensionality.items()}


def nonzero(dimension):
    names = ("kg", "m", "s", "A", "K", "mol", "cd")
    return {name: e for name, e in zip(names, dimension.exponents, strict=True) if e}


def test_pint_knows_every_unit_of_the_table():
    assert set(PINT_UNITS) == set(UNITS)


def test_pint_knows_every_prefix():
    assert set(PINT_PREFIXES) == set(PREFIXES)


@pytest.mark.slow
def test_the_factor_of_a_unit_is_exactly_that_of_pint(registry):
    for name in UNITS:
        assert factor_here(registry, unit_of(name), name) == factor_in_pint(registry, PINT_UNITS[name]), name


def test_the_dimension_of_a_unit_is_that_of_pint(registry):
    for name in UNITS:
        assert nonzero(unit_of(name).dimension) == exponents(
            registry.Unit(PINT_UNITS[name]).dimensionality
        ), name


def test_a_prefix_scales_a_unit_exactly_as_in_pint(registry):
    for prefix in PREFIXES:
        prefixed = registry.Quantity(Fraction(1), PINT_PREFIXES[prefix] + "meter")
        assert unit_of(prefix + "m").scale == Fraction(prefixed.to_root_units().magnitude), prefix


def test_a_prefix_scales_all_units_alike():
    for prefix in PREFIXES:
        factor = unit_of(prefix + "m").scale
        expected = {name: unit.scaled(factor) for name, unit in PREFIXABLE_UNITS.items()}
        assert {name: unit_of(prefix + name) for name in PREFIXABLE_UNITS} == expected, prefix


def test_no_prefixed_symbol_has_two_readings():
    symbols = [*UNITS, *(prefix + name for prefix in PREFIXES for name in PREFIXABLE_UNITS)]
    assert len(symbols) == len(set(symbols))


def test_a_unit_that_takes_no_prefix_is_unknown_with_one():
    for name in PLAIN_UNITS:
        assert unit_named("k" + name) is None, name


def test_the_exponent_of_the_cycle_is_kept():
    for name, cycles in [
        ("Hz", 1),
        ("rev", 1),
        ("cycle", 1),
        ("rpm", 1),
        ("V/krpm", -1),
        ("mm/rev", -1),
        ("rad", 0),
    ]:
        assert unit_of(name).cycles == cycles, name


def test_the_exponent_of_the_radian_is_kept():
    for name, radians in [
        ("rad", 1),
        ("deg", 1),
        ("N*m/rad", -1),
        ("N*m/deg", -1),
        ("sr", 2),
        ("rev", 0),
        ("m", 0),
    ]:
        assert unit_of(name).radians == radians, name


def test_every_factor_is_a_fraction():
    assert {type(unit.scale) for unit in UNITS.values()} == {Fraction}


def test_a_rpm_is_a_sixtieth_of_a_cycle_per_second():
    assert unit_of("rpm") == unit_of("cycle/s").scaled(Fraction(1, 60))


def test_a_pound_force_is_the_standard_weight_of_a_pound():
    # 0.45359237 kg (1959 agreement) times 9.80665 m/s^2 (3rd CGPM, 1901).
    assert unit_of("lbf").scale == Fraction("4.4482216152605")


def test_a_unit_has_an_exact_root_when_its_factor_has():
    assert unit_of("cm^2").root(2) == unit_of("cm")


def test_a_unit_without_an_exact_root_has_none():
    for name in ["km", "Hz", "deg", "rad"]:
        assert unit_of(name).root(2) is None, name


def test_a_quotient_of_units_undoes_their_product():
    assert unit_of("krpm") * unit_of("deg") / unit_of("deg") == unit_of("krpm")


def test_units_compare_by_value():
    assert unit_of("kg*m/s^2") == Unit(Fraction(1), dimension=unit_of("N").dimension)


def test_the_usual_products_may_run_together():
    for written, meant in [
        ("mNm", "mN*m"), ("Nms/rad", "N*m*s/rad"), ("Nmm/rad", "N*mm/rad"), ("kgm^2", "kg*m^2"),
        ("kgm\u00b2", "kg*m^2"), ("gcm2", "g*cm^2"), ("(kgm)^2", "kg^2*m^2"), ("kVA", "kW"),
        ("1/Nm", "1/(N*m)"), ("kg/m3", "kg/m^3"), ("m/s2", "m/s^2"), ("mm4", "mm^4"),
    ]:  # fmt: skip
        assert unit_of(written) == unit_of(meant), written


def test_an_unknown_unit_brings_a_hint():
    for written, meant in [
        ("KN", "kN"), ("Kg", "kg"), ("KG", "kg"), ("MPA", "MPa"), ("mpa", "mPa"), ("khz", "kHz"),
        ("HZ", "Hz"), ("RPM", "rpm"), ("sec", "s"), ("ohms", "Ohm"), ("kohms", "kohm"), ("Nkg", "N*kg"),
        ("m5", "m^5"), ("kgg", "kg"), ("rads", "rad"), ("Pas", "Pa*s"), ("inches", "in"), ("degrees", "deg"),
        ("micron", "um"), ("Kgm2", "kgm2"), ("KNm", "kNm"), ("Volt", "V"), ("psig", "psi"),
        ("GPM", "gpm"), ("mmhg", "mmHg"), ("torr", "Torr"),
    ]:  # fmt: skip
        assert unit_hint(written) == f"did you mean '{meant}'?", written


def test_a_unit_that_has_no_single_replacement_brings_advice():
    for written, word in [
        ("lbs", "'lbf' (force)"),
        ("dB", "10^(x/20)"),
        ("degC", "'K'"),
        ("\u00b0C", "'K'"),
        ("m_1", "'*'"),
    ]:
        assert word in unit_hint(written), written


def test_a_unit_like_no_other_brings_no_hint():
    assert unit_hint("qwertyuiop") is None


def test_every_hint_of_a_single_unit_can_be_read():
    meant = {hint.split("'")[1] for hint in _INSTEAD.values() if hint.startswith("did you mean")}
    assert all(isinstance(unit_of(unit), Unit) for unit in meant)
