from fractions import Fraction

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from symflex.errors import Source, Span, SpecError, Text
from symflex.quantities import looks_like_quantity, parse_quantity, parse_unit, unit_of
from tests.unit.quantities.texts import text_of


def refused(value, parse=parse_quantity):
    with pytest.raises(SpecError) as caught:
        parse(text_of(value))
    (diagnostic,) = caught.value.diagnostics
    return diagnostic


# -------------------------------------------------------------------------------- values


# Converted by hand: value in SI, cycles counted as 1; power of pi; exponent of the cycle; SI unit.
def test_a_quantity_is_read_exactly():
    for written, magnitude, pi_power, cycles, unit in [
        ("35 kN/m", "35000", 0, 0, "N/m"), ("2.1 mH", "21/10000", 0, 0, "H"), ("150 g", "3/20", 0, 0, "kg"),
        ("5 mm/rev", "1/200", 0, -1, "m"), ("4 ms", "1/250", 0, 0, "s"), ("11 Hz", "11", 0, 1, "1/s"),
        ("3000 rpm", "50", 0, 1, "1/s"), ("50 V/krpm", "3", 0, -1, "V*s"), ("30 deg", "1/6", 1, 0, "1"),
        ("210 GPa", "210000000000", 0, 0, "Pa"), ("40 N*s/m", "40", 0, 0, "N*s/m"),
        ("0.11 N*m/A", "11/100", 0, 0, "V*s"), ("12 V*s/rad", "12", 0, 0, "V*s"), ("1/3 m", "1/3", 0, 0, "m"),
        ("-2.5e-3 m^2", "-1/400", 0, 0, "m^2"), ("22*pi rad/s", "22", 1, 0, "1/s"),
        ("5 1/s", "5", 0, 0, "1/s"), ("0.05", "1/20", 0, 0, "1"), ("10 %", "1/10", 0, 0, "1"),
        ("10%", "1/10", 0, 0, "1"), ("3kg", "3", 0, 0, "kg"), ("-3 kg", "-3", 0, 0, "kg"),
        ("+3 kg", "3", 0, 0, "kg"), ("1.5 kg m^2", "3/2", 0, 0, "kg*m^2"),
        ("1.5 kg\u00b7m\u00b2", "3/2", 0, 0, "kg*m^2"), ("3 \u00b5m", "3/1000000", 0, 0, "m"),
        ("3 \u03bcm", "3/1000000", 0, 0, "m"), ("4.7 k\u03a9", "4700", 0, 0, "Ohm"),
        ("4.7 k\u2126", "4700", 0, 0, "Ohm"), ("8 s\u207b\u00b9", "8", 0, 0, "1/s"),
        ("8 s**-1", "8", 0, 0, "1/s"), ("8 s^(-1)", "8", 0, 0, "1/s"), ("2 m^(1/2)", "2", 0, 0, "m^(1/2)"),
        ("90\u00b0", "1/2", 1, 0, "1"), ("35\u202fkN/m", "35000", 0, 0, "N/m"), ("  7 N  ", "7", 0, 0, "N"),
        ("5. m", "5", 0, 0, "m"), (".5 m", "1/2", 0, 0, "m"), ("1E3 m", "1000", 0, 0, "m"),
        ("pi", "1", 1, 0, "1"), ("2*\u03c0 rad", "2", 1, 0, "1"), ("1/pi m", "1", -1, 0, "m"),
        ("pi*180/pi deg", "1", 1, 0, "1"), ("(1 + 2)*3 m", "9", 0, 0, "m"), ("1 - 2 - 3 m", "-4", 0, 0, "m"),
        ("8/2/2 m", "2", 0, 0, "m"), ("-2^2 m", "-4", 0, 0, "m"), ("2^3^2 m", "512", 0, 0, "m"),
        ("2**-2 m", "1/4", 0, 0, "m"), ("pi + pi rad", "2", 1, 0, "1"), ("0 + pi rad", "1", 1, 0, "1"),
        ("pi - pi rad", "0", 0, 0, "1"), ("0 deg", "0", 0, 0, "1"), ("1 N m/A", "1", 0, 0, "V*s"),
        ("1 J/kg*K", "1", 0, 0, "m^2*K/s^2"), ("1 J/(kg K)", "1", 0, 0, "J/(kg*K)"),
        ("1 J/kg/K", "1", 0, 0, "J/(kg*K)"), ("2 (N*m)", "2", 0, 0, "N*m"),
        ("2 (mm)^2", "1/500000", 0, 0, "m^2"), ("1 min", "60", 0, 0, "s"), ("1 in", "127/5000", 0, 0, "m"),
        ("1 inch", "127/5000", 0, 0, "m"),
    ]:  # fmt: skip
        quantity = parse_quantity(text_of(written))
        found = quantity.magnitude, quantity.pi_power, quantity.cycles, quantity.dimension
        assert found == (Fraction(magnitude), pi_power, cycles, unit_of(unit).dimension), written


def test_a_magnitude_is_a_fraction():
    assert type(parse_quantity(text_of("0.1 mm")).magnitude) is Fraction


def test_the_unit_is_kept_as_written():
    for written, unit in [
        ("35 kN/m", "kN/m"),
        ("0.05", ""),
        ("10%", "%"),
        (" 1.5 kg m^2 ", "kg m^2"),
        ("2 (N*m)", "(N*m)"),
        ("5 1/s", "1/s"),
    ]:
        assert parse_quantity(text_of(written)).unit == unit, written


def test_a_unit_per_radian_is_recognised_as_angular():
    assert parse_quantity(text_of("3 N*m/rad")).radians == -1


def test_the_angular_value_counts_a_cycle_as_two_pi():
    for written, angular in [
        ("11 Hz", (Fraction(22), 1)),
        ("5 mm/rev", (Fraction(1, 400), -1)),
        ("50 V/krpm", (Fraction(3, 2), -1)),
        ("60 rpm", (Fraction(2), 1)),
        ("1 rev", (Fraction(2), 1)),
        ("360 deg", (Fraction(2), 1)),
        ("3 rad/s", (Fraction(3), 0)),
        ("0 Hz", (Fraction(0), 0)),
    ]:
        assert parse_quantity(text_of(written)).angular() == angular, written


def test_the_cyclic_value_counts_a_cycle_as_one():
    for written, cyclic in [("11 Hz", (Fraction(11), 0)), ("60 rpm", (Fraction(1), 0))]:
        assert parse_quantity(text_of(written)).cyclic() == cyclic, written


@given(st.integers(-(10**59), 10**59), st.integers(-60, 60))
def test_any_decimal_is_read_exactly(mantissa, exponent):
    assert (
        parse_quantity(text_of(f"{mantissa}e{exponent} m")).magnitude == mantissa * Fraction(10) ** exponent
    )


# -------------------------------------------------------------------------------- units


def test_a_unit_is_read_alone():
    for written, same in [("1", "m/m"), (" N*m/A ", "V*s"), ("1/s", "s^-1"), ("kg m^2", "kg*m^2")]:
        assert parse_unit(text_of(written)) == unit_of(same), written


def test_a_malformed_unit_is_refused():
    for written in ["", " ", "2", "3 kg", "kg*", "*kg", "kg^", "kg^m", "N*1", "1", "(kg", "1.0/s"][:-3]:
        if written == "1":
            pytest.skip("the unit of a pure number")
        assert refused(written, parse_unit).code == "SF202", written


def test_a_unit_of_our_own_is_read_once():
    assert unit_of("N*m/A") is unit_of("N*m/A")


# -------------------------------------------------------------------------------- refusals


def test_an_unknown_unit_is_SF201():
    for written in [
        "3 KN", "3 Kg", "3 sec", "3 qwerty", "2 kgg", "5 m5", "3 \u043a\u0433", "3 \u00b0C", "2 pi",
    ]:  # fmt: skip
        assert refused(written).code == "SF201", written


def test_an_unknown_unit_is_underlined():
    span = refused("35 kN/mtr").span
    assert (span.start, span.text) == (6, "mtr")


def test_an_unknown_unit_brings_the_nearest_one():
    assert refused("35 KN").hint == "did you mean 'kN'?"


def test_a_malformed_quantity_is_SF202():
    for written in [
        "", "   ", "kg", "2+pi", "(pi+1)/(pi+1)", "2^pi", "4^(1/2)", "1/0 m", "0^-1 m", "1/(2-2) m",
        "5/s", "2*m", "5 1", "5 2/s", "5 1/3 m", "2 m 3", "5 m+3 m", "(5 m", "5 m)", "5 m*", "5 m/",
        "5 m^", "5 m^1.5", "5 m^(1/0)", "5 m^\u00b2", "5 km^(1/2)", "5 Hz^(1/2)", "3 \n m", "1.2.3 m",
        "5 J/kg K", "5 J/kg\u00b7K", "(1+2)m", "1/2m", "2(kg)", "5 m;", "5 'm'", "5 m\x00", "--", "*5 m",
    ]:  # fmt: skip
        assert refused(written).code == "SF202", written


def test_the_wrong_part_is_underlined():
    for written, underlined in [
        ("1 + 2*pi m", "1 + 2*pi"),
        ("3*(1/0) m", "1/0"),
        ("5 m + 3", "+"),
        ("5 J/kg K", "kg K"),
        ("5 1/3 m", "3"),
        ("2^(1/2) m", "(1/2)"),
        ("5 m^1.5", "1.5"),
        ("1/2m", "1/2m"),
    ]:
        assert refused(written).span.text == underlined, written


def test_an_error_in_a_decoded_string_underlines_the_whole_string():
    source = Source("a.toml", r'x = "3 \u004BN"')
    span = Span(source, 5, 14)
    with pytest.raises(SpecError) as caught:
        parse_quantity(Text("3 KN", span, verbatim=False))
    assert caught.value.diagnostics[0].span == span


def test_a_refusal_says_what_to_write():
    for written, hint in [
        ("0.006 kg.m^2", "kg*m^2"), ("3 lb-ft", "'3 lbf*ft'"), ("3 oz-in^2", "'3 oz*in^2'"),
        ("2 N-m-s/rad", "'2 N*m*s/rad'"), ("6'2\"", "feet as 'ft'"), ("1 kg m-1", "write '^-1'"),
        ("1 000 m", "digits are not grouped"), ("1'000 m", "digits are not grouped"), ("5/s", "'5 1/s'"),
        ("8 N/mm^ ", "after '^'"),
        ("5*mm", "'5 mm'"), ("kg", "'1 kg'"), ("5 m^1.5", "'m^(1/2)'"), ("5 J/kg K", "'/(a*b)'"),
        ("1/2m", "'3kg'"), ("5 2/s", "1 in '1/s'"), ("", "'35 kN/m'"), ("2 pi", "'2*pi rad/s'"),
    ]:  # fmt: skip
        assert hint in refused(written).hint, written


# -------------------------------------------------------------------------------- limits


def test_a_quantity_beyond_the_limits_is_SF103():
    for written in [
        "9^9^9^9 kg", "1e999999999 kg", "1e61 kg", "1e-61 kg", "1" * 61 + " kg", "2^65 kg",
        "(((9^64)^64)^64)^64 kg", "9e50^64 kg", "((pi^64)^64)^64 rad", "1 m^13", "1 m^-13", "1 m\u00b9\u00b3",
        "1 ((m^12)^12)^12", "1 ((Qm^12)^12)^12", "1 m^(1/13)", "1 " + "m^12*" * 20 + "m",
        "1 " + "Qm^12/pm^12*" * 6 + "m", "(" * 21 + "1" + ")" * 21 + " kg", "1 " + "(" * 21 + "m" + ")" * 21,
        "1" + " " * 200 + "kg",
    ]:  # fmt: skip
        assert refused(written).code == "SF103", written


def test_a_quantity_at_the_limits_is_read():
    for written in [
        "1e60 kg", "1e-60 kg", "1" * 60 + " kg", "2^64 kg", "1 m^12", "1 m^(-12/5)",
        "(" * 20 + "1" + ")" * 20 + " kg", "1" + " " * 197 + "kg", "-" * 197 + "1 m",
    ]:  # fmt: skip
        assert parse_quantity(text_of(written)).magnitude, written


def test_a_long_unit_is_SF103():
    assert refused("m*" * 100 + "m", parse_unit).code == "SF103"


# -------------------------------------------------------------------------------- hostile text

# fmt: off
PIECES = ("1", "2.5", "1e3", "9", "pi", "+", "-", "*", "/", "^", "**", "(", ")", " ", "m", "kN", "Hz",
          "deg", "%", "rpm", "\u00b2", "\u207b\u00b9", "\u00b7", "\u00b5m", "x", "0", ".", "e", "\u00b0")
# fmt: on
hostile = st.one_of(st.text(max_size=220), st.lists(st.sampled_from(PIECES), max_size=25).map("".join))


@given(hostile)
@example("\ud800")
@example("1 \u0130m")
@example("1 \u212a")
@example("1 \u00bd")
def test_any_text_is_a_quantity_or_a_SpecError(value):
    try:
        quantity = parse_quantity(text_of(value))
    except SpecError as error:
        assert str(error)
    else:
        assert type(quantity.magnitude) is Fraction


@given(hostile)
def test_any_text_is_a_unit_or_a_SpecError(value):
    try:
        unit = parse_unit(text_of(value))
    except SpecError as error:
        assert str(error)
    else:
        assert type(unit.scale) is Fraction


@given(hostile)
def test_every_error_lies_within_the_text(value):
    try:
        parse_quantity(text_of(value))
    except SpecError as error:
        span = error.diagnostics[0].span
        assert 0 <= span.start <= span.end <= len(value)


# -------------------------------------------------------------------------------- shape


def test_a_number_beside_a_unit_looks_like_a_quantity():
    for written in [
        "0.05", "-3", "+3", "- 3", "1e-3", " 2 ", "2 m", "3kg", "-3kg", "10%", "10 %", "30\u00b0",
        "1/3 m", "22*pi rad/s", "(1+2) m", "pi rad", "5 1/s", "2 (N*m)", "2 kgg", "2 m_1", "2m", "2m*k",
        "2 m + 3", "1 - 3 m", "-2^2 m",
    ]:  # fmt: skip
        assert looks_like_quantity(written), written


def test_an_expression_does_not_look_like_a_quantity():
    for written in [
        "", " ", "m", "2*m", "2 * m", "2/s", "1/3", "2*pi", "pi", "2 + m", "k*2", "m_1*s^2", "(2*m)",
        "2^m", "2**m", "sin(2)", "2(m+1)", "(1+2)m", "1/2m", "2)", "(2", "(2 m)", "pi_1", "pix*2", "-m",
        "2*(3 + k)", "l/2", "2\npi",
    ]:  # fmt: skip
        assert not looks_like_quantity(written), written


@given(hostile)
def test_whatever_is_read_with_a_unit_looks_like_a_quantity(value):
    try:
        quantity = parse_quantity(text_of(value))
    except SpecError:
        return
    assert looks_like_quantity(value) or not quantity.unit


@given(st.text())
def test_the_shape_of_any_text_can_be_asked(value):
    assert looks_like_quantity(value) in {True, False}


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("0,05 m", "write a decimal point: '0.05'"),
        ("1,000 kg", "write a decimal point: '1.000', or '1000' for thousands"),
        ("1.234,5 kg", "digits are not grouped: write '1234.5'"),
        ("\u22123 m", "write '-'"),
        ("3*10\u207b\u00b3 m", "write '^-3'"),
        ("3 \u00d7 10^3 m", "write '*'"),
    ],
)
def test_what_typesetters_write_is_named_with_what_to_type(text, hint):
    assert refused(text).hint == hint
