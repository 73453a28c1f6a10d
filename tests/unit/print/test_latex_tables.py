"""Units, values and tables."""

from fractions import Fraction

import pytest
from flint import arb

from symflex.errors import UsageError
from symflex.model.model import ExactValue, Model, ModelParameter
from symflex.print.latex import COLUMNS_MM, column_width, mode_table, parameter_table, root_table
from symflex.print.latex.table import SETTINGS, TabularColumn, decimal_text, fitting, tabular
from symflex.print.latex.units import quantity_latex, siunitx_unit
from symflex.roots import Certificate, Everything, HiddenRoot, PoleZeroMap, Root

# By hand, from siunitx's names of units.
UNITS = {
    "N*s/m": r"\newton\second\per\metre", "V*s/rad": r"\volt\second\per\radian",
    "kg*m^2": r"\kilogram\metre\squared", "1/s": r"\per\second", "m/(N*s)": r"\metre\per\newton\per\second",
    "1/(N*m*s^2)": r"\per\newton\per\metre\per\second\squared", "m^(1/2)": r"\metre\tothe{1/2}",
    "m^4": r"\metre\tothe{4}", "kN/m": r"\kilo\newton\per\metre", "rad*s^-1": r"\radian\per\second",
    "Ohm": r"\ohm", "1": "",
}  # fmt: skip


def test_a_unit_is_spelt_for_siunitx():
    assert {unit: siunitx_unit(unit) for unit in UNITS} == UNITS


def test_an_unknown_unit_is_no_siunitx_unit():
    for unit in ("furlong", r"\input{x}", "m)", "m^x", "5*m", "m^(1/0"):
        assert siunitx_unit(unit) is None, unit


def test_an_unknown_unit_is_escaped_text():
    assert quantity_latex("2", "a_b") == r"\num{2}~a\_b"


SHORT = {
    Fraction(0): "0",
    Fraction(80): "80",
    Fraction("0.00375"): "0.00375",
    Fraction(2, 3): "0.6666667",
    Fraction("9999999.96"): "1.000000e7",
    Fraction(-21, 10**13): "-2.1e-12",
    Fraction(1326380): "1.32638e6",
    Fraction(10**200): "1e200",
}


def test_a_value_is_a_short_decimal():
    assert {value: decimal_text(ExactValue(value)) for value in SHORT} == SHORT


MODEL = Model(
    parameters=(
        ModelParameter("m_1", ExactValue(Fraction(60)), "kg", doc="actuator & 100 %"),
        ModelParameter("omega_p1", ExactValue(Fraction(22), 1), "rad/s"),
        ModelParameter("k", None, "N/m"),
    )
)


def test_the_table_of_parameters_has_symbol_meaning_and_value():
    assert r"$m_{1}$ & actuator \& 100 \% & \qty{60}{\kilogram} \\" in parameter_table(MODEL)


def test_a_value_with_pi_is_given_in_decimals():
    # 22 pi = 69.11503838 rad/s: the angular frequency of 11 Hz.
    assert r"\qty{69.11504}{\radian\per\second}" in parameter_table(MODEL)


def test_a_parameter_without_a_value_is_called_symbolic():
    assert r"symbolic, in \unit{\newton\per\metre}" in parameter_table(MODEL)


def test_a_long_table_is_set_in_parts_with_the_same_head():
    many = tuple(ModelParameter(f"k_{i}", ExactValue(Fraction(i)), "N/m") for i in range(100))
    table = parameter_table(Model(parameters=many))
    assert table.count(r"\begin{tabular}") == table.count("Symbol & Value") == 3
    assert "longtable" not in table  # which two columns refuse
    assert [f"$k_{{{i}}}$ &" in table for i in range(100)] == [True] * 100


def test_a_meaning_is_broken_into_lines_where_it_has_no_room():
    long = Model(parameters=(ModelParameter("k", ExactValue(Fraction(1)), "N/m", doc="stiffness " * 9),))
    assert r"\raggedright" not in parameter_table(long, width_mm=300)
    assert r"p{" in parameter_table(long, width_mm=170)


def test_a_value_stands_below_its_meaning_where_neither_has_room_beside_the_other():
    unit = "kg*m^2*rad/(s^3*V*A*K*mol)"
    wide = Model(parameters=(ModelParameter("x" * 20, ExactValue(Fraction(1, 3)), unit, doc="word " * 9),))
    assert r"\newline \qty{0.3333333}" in parameter_table(wide, width_mm=80)


def root(re, im, multiplicity=1):
    return Root(arb(re), arb(im), multiplicity, on_imaginary_axis=re == 0, is_real=im == 0)


MAP = PoleZeroMap(
    "V/F",
    Everything(),
    (root(-3, 4), root(-3, -4), root(-2, 0)),
    (root(0, 0, 2),),
    (HiddenRoot(root(0, 5)),),
    Certificate("polynomial", 6, 6),
)


def test_a_conjugate_pair_is_one_row():
    # A 3-4-5 triangle: 5 rad/s = 0.795775 Hz, damping ratio 3/5.
    assert r"    -3.00000 & \pm 4.00000 & 0.795775 & 0.600000 \\" in root_table(MAP, "poles")


def test_a_real_root_has_no_imaginary_part():
    assert r"    -2.00000 & 0 & 0.318310 & 1 \\" in root_table(MAP, "poles")


def test_a_multiple_root_says_so_and_has_no_damping_ratio_at_zero():
    assert r"    0 & 0 & 0 & {--} & 2 \\" in root_table(MAP, "zeros")
    assert "Multiplicity" in root_table(MAP, "zeros")
    assert "Multiplicity" not in root_table(MAP, "poles")


def test_a_root_without_its_partner_is_not_called_a_pair():
    assert r"    0 & 5.00000 &" in root_table(MAP, "hidden")


def enclosed(re, im, radius):
    return Root(arb(re, radius), arb(im, radius), 1, on_imaginary_axis=False, is_real=False)


def of_poles(*poles):
    return PoleZeroMap("V/F", Everything(), poles, (), (), Certificate("polynomial", 2, 2))


def test_a_table_has_the_digits_that_the_enclosure_certifies_and_no_more():
    # |s| = 5 within 1.5e-3, f = 0.79577 Hz within 2.3e-4, ratio 0.6 within some 1e-3.
    (row,) = (
        line for line in root_table(of_poles(enclosed(-3, 4, 1e-3)), "poles").splitlines() if "-3" in line
    )
    assert row.strip().startswith("-3.00 & 4.00 & 0.796 & 0.60")


def test_a_part_that_may_be_anything_near_zero_is_not_called_zero():
    assert r"{$\approx 0$} & 4.00 &" in root_table(of_poles(enclosed(1e-9, 4, 1e-3)), "poles")


def test_heads_are_stacked_where_they_are_wider_than_the_numbers_and_the_column():
    tables = [root_table(of_poles(root(-2, 0)), "poles", width_mm=width) for width in (120, 80)]
    assert [r"\shortstack{Damping\\ratio}" in table for table in tables] == [False, True]


def test_a_narrow_column_takes_smaller_type_and_then_fewer_digits():
    wide = of_poles(enclosed(-3.123456789e-7, 4.123456789e9, 1e-25), enclosed(-3e5, 1e-3, 1e-25))
    tables = [root_table(wide, "poles", digits=9, width_mm=width) for width in (300, 125, 88.5)]
    assert [r"\footnotesize" in table for table in tables] == [False, True, True]
    assert ["4.12345679e9" in table for table in tables] == [True, True, False]
    assert "4.123" in tables[2] or "4.12e9" in tables[2]


def test_modes_are_the_poles_of_all_functions_once_each():
    # Rigid-body motion is number 0; a double pole is two modes.
    first = of_poles(root(0, 0), root(-3, 4), root(-3, -4))
    second = of_poles(root(-3, 4), root(-3, -4), root(0, 10, 2), root(0, -10, 2), root(-20, 0))
    rows = [line.split("&")[0].strip() for line in mode_table([first, second]).splitlines() if r"\\" in line]
    assert rows[1:] == ["0", "1", "2", "4"]
    assert r"1 & 0.795775 & 5.00000 & 0.600000 & 1 \\" in mode_table([first, second])


def test_a_table_too_wide_for_every_setting_is_told_apart():
    column = TabularColumn("l", ("a",), (0.5,), ("b",), 30.0)
    assert fitting((column,), 20.0) is None
    assert fitting((column,), 26.0) is SETTINGS[3]
    assert r"\footnotesize" in tabular((column,), SETTINGS[3])


def test_a_column_is_named_or_given_in_millimetres():
    widths = {"ieee": 88.5, "a4": 170, "120": 120, "90.5mm": 90.5}
    assert {text: column_width(text) for text in widths} == widths


def test_no_other_width_is_taken():
    for text in ("", "ieeee", "12cm", "-90", "79", "1001", "1e2", "nan", "90 in", "9" * 99, "٩٠"):
        with pytest.raises(UsageError, match="SF902"):
            column_width(text)


def test_the_columns_of_the_named_papers_are_as_wide_as_theirs():
    # IEEEtran sets \columnwidth to 252 pt; 210 mm less two margins of 20 mm.
    assert COLUMNS_MM["ieee"] == pytest.approx(252 * 25.4 / 72.27, abs=0.1)
    assert COLUMNS_MM["a4"] == 210 - 2 * 20
