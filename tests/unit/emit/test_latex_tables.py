"""Units, values and tables."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import arb

from symflex.emit.latex import parameter_table, pole_zero_table
from symflex.emit.latex.table import decimal_text
from symflex.emit.latex.units import quantity_latex, siunitx_unit
from symflex.model.model import ExactValue, Model, Parameter
from symflex.roots import Certificate, Everything, HiddenRoot, PoleZeroMap, Root

# By hand, from siunitx's names of units.
UNITS = {
    "N*s/m": r"\newton\second\per\metre",
    "V*s/rad": r"\volt\second\per\radian",
    "kg*m^2": r"\kilogram\metre\squared",
    "1/s": r"\per\second",
    "m/(N*s)": r"\metre\per\newton\per\second",
    "1/(N*m*s^2)": r"\per\newton\per\metre\per\second\squared",
    "m^(1/2)": r"\metre\tothe{1/2}",
    "m^4": r"\metre\tothe{4}",
    "kN/m": r"\kilo\newton\per\metre",
    "rad*s^-1": r"\radian\per\second",
    "Ohm": r"\ohm",
    "1": "",
}


@pytest.mark.parametrize("unit", UNITS)
def test_a_unit_is_spelt_for_siunitx(unit):
    assert siunitx_unit(unit) == UNITS[unit]


@pytest.mark.parametrize("unit", ["furlong", r"\input{x}", "m)", "m^x", "5*m", "m^(1/0"])
def test_an_unknown_unit_is_no_siunitx_unit(unit):
    assert siunitx_unit(unit) is None


def test_an_unknown_unit_is_escaped_text():
    assert quantity_latex("2", "a_b") == r"\num{2}~a\_b"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (Fraction(0), "0"),
        (Fraction(80), "80"),
        (Fraction("0.00375"), "0.00375"),
        (Fraction(2, 3), "0.6666667"),
        (Fraction("9999999.96"), "1.000000e7"),
        (Fraction(-21, 10**13), "-2.1e-12"),
        (Fraction(1326380), "1.32638e6"),
        (Fraction(10**200), "1e200"),
    ],
)
def test_a_value_is_a_short_decimal(value, text):
    assert decimal_text(value) == text


def test_rounded_values_keep_their_zeros():
    assert decimal_text(Fraction(11), 6, is_rounded=True) == "11.0000"


MODEL = Model(
    parameters=(
        Parameter("m_1", ExactValue(Fraction(60)), "kg", doc="actuator & 100 %"),
        Parameter("omega_p1", ExactValue(Fraction(22), 1), "rad/s"),
        Parameter("k", None, "N/m"),
    )
)


def test_the_table_of_parameters_has_symbol_meaning_and_value():
    assert r"$m_{1}$ & actuator \& 100 \% & \qty{60}{\kilogram} \\" in parameter_table(MODEL)


def test_a_value_with_pi_is_given_in_decimals():
    # 22 pi = 69.11503838 rad/s: the angular frequency of 11 Hz.
    assert r"\qty{69.11504}{\radian\per\second}" in parameter_table(MODEL)


def test_a_parameter_without_a_value_is_called_symbolic():
    assert r"symbolic, in \unit{\newton\per\metre}" in parameter_table(MODEL)


def test_a_long_table_breaks_across_pages():
    many = tuple(Parameter(f"k_{i}", ExactValue(Fraction(i)), "N/m") for i in range(100))
    assert r"\begin{longtable}" in parameter_table(Model(parameters=many))


def root(re, im, multiplicity=1):
    return Root(arb(re), arb(im), multiplicity, on_imaginary_axis=re == 0, is_real=im == 0)


MAP = PoleZeroMap(
    "V/F",
    Everything(),
    (root(-3, 4), root(-3, -4), root(-2, 0)),
    (root(0, 0, 2),),
    (HiddenRoot(root(0, 5)),),
    Certificate("polynomial", True, 6, 6),
)


def test_a_conjugate_pair_is_one_row():
    # A 3-4-5 triangle: 5 rad/s = 0.795775 Hz, damping ratio 3/5.
    assert r"pole & -3.00000 & \pm 4.00000 & 0.795775 & 0.600000 \\" in pole_zero_table(MAP)


def test_a_real_root_has_no_imaginary_part():
    assert r"pole & -2.00000 & 0 & 0.318310 & 1 \\" in pole_zero_table(MAP)


def test_a_multiple_root_says_so_and_has_no_damping_ratio_at_zero():
    assert r"zero ($\times 2$) & 0 & 0 & 0 & {--} \\" in pole_zero_table(MAP)


def test_a_root_without_its_partner_is_not_called_a_pair():
    assert r"hidden & 0 & 5.00000 &" in pole_zero_table(MAP)
