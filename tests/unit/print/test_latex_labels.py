"""Labels: made from names, read when declared, refused when they would break a formula."""

import pytest

from symflex.print.label import labels_of, read_label, symbol
from symflex.print.latex import label_of

# By hand, after the habits of journals: variables italic, words in subscripts upright, Greek as letters.
MADE = {
    "m": "m", "omega": r"\omega", "omega_p1": r"\omega_{p1}", "zeta_z5": r"\zeta_{z5}",
    "k_amp": r"k_{\mathrm{amp}}", "m_1": "m_{1}", "m1": "m_{1}", "x_s": "x_{s}", "k_tau": r"k_{\tau}",
    "EI": r"\mathit{EI}", "gain": r"\mathit{gain}", "V_tip_max": r"V_{\mathrm{tip},\mathrm{max}}",
    "Omega_0": r"\Omega_{0}", "Alpha": r"\mathit{Alpha}",
}  # fmt: skip


# fmt: off
SOUND = (
    r"\omega_{p1}", "k_t", r"\hat{x}", r"\dot x", r"k_{\text{back-emf}}", "x''", r"\mathcal{N}^{*}_{0}",
    r"\operatorname{ab}", r"w(l)", r"F_{+}",
)
BREAKING = (
    r"\hat", r"\mathrm", r"\mathrm{}", r"\text{a_b}", r"\text{a^b}", "x^2'", "x'^2", "x_1_2", "x_", "_1",
    "'", "x_{}", "{", "}", "a}{b", "", " ", "{{{{{{{{{{a}}}}}}}}}}", r"\input{x}", r"\def\x{y}", r"\catcode",
    "x$y", "x%y", "x#1", "x&y", "x\\\\y", "x~y", "ä",
)
# fmt: on


def test_a_name_makes_the_label_an_author_would_write():
    assert {name: label_of(name) for name in MADE} == MADE


def test_a_name_that_is_no_stem_with_subscripts_prints_as_it_is():
    assert [label_of(name) for name in ("a__b", "a_", "x1y2")] == [
        r"\mathtt{a\_\_b}",
        r"\mathtt{a\_}",
        r"\mathtt{x1y2}",
    ]


def test_the_longest_name_still_fits_a_column():
    for name in ("W" * 64, "a_" + "very_" * 11 + "long"):
        assert symbol(name, {}).width <= 12.0, name


def test_a_sound_label_is_used_as_declared():
    assert tuple(symbol("q", {"q": latex}).latex for latex in SOUND) == SOUND


def test_a_label_that_would_break_a_formula_is_not_read():
    assert [latex for latex in BREAKING if read_label(latex) is not None] == []


def test_a_label_that_would_break_a_formula_gives_way_to_the_name():
    assert symbol("k_amp", {"k_amp": r"\hat"}).latex == r"k_{\mathrm{amp}}"


def test_a_label_wider_than_a_column_gives_way_to_the_name():
    assert symbol("k", {"k": "W" * 120}).latex == "k"


def test_two_names_never_share_a_label():
    labels = labels_of([("m_1", ""), ("m1", ""), ("k", "q"), ("q", "")], {"s": "s"})
    assert len(set(labels.values())) == len(labels)


def test_a_parameter_cannot_take_the_label_of_the_laplace_variable():
    assert labels_of([("x", "s")], {"s": "s"})["x"] == r"\mathtt{x}"


def test_a_declared_label_goes_before_a_made_one():
    assert labels_of([("m_1", ""), ("mass", "m_{1}")], {})["mass"] == "m_{1}"


def test_the_width_of_a_label_is_that_of_its_letters():
    # The widths of k in cmmi10 and t in cmmi7 with their italic corrections, and half a point after a script.
    assert read_label("k_t").width == pytest.approx(0.5521 + 0.7 * 0.4324 + 0.05, abs=0.002)
