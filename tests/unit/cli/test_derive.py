from __future__ import annotations

import random
from fractions import Fraction

import pytest

from symflex import pipeline
from symflex.emit.forms import FORMS
from tests.contract.exact import Point, read, value_of
from tests.unit.cli.commands import DERIVATIONS, TWO_MASS

ENTRY_KEYS = {"tf", "quantity", "unit", "form", "num", "den", "where", "latex", "hidden"}


def test_text_shows_a_fraction_under_its_name_and_unit(shell):
    done = shell("derive", "x.toml", "--tf", "X/F")
    assert (done.code, done.err) == (0, "")
    assert [line.strip() for line in done.out.splitlines()] == [
        "X/F   receptance [m/N], definitions form",
        "",
        "1",
        "---------",
        "m*s^2 + k",
    ]


def test_all_transfer_functions_are_derived_by_default(shell):
    assert [e["tf"] for e in shell("derive", "x.toml", "--json").json["transfer_functions"]] == ["X/F", "V/F"]


def test_tf_may_be_repeated_and_sets_the_order(shell):
    done = shell("derive", "x.toml", "--json", "--tf", "V/F", "--tf", "X/F")
    assert [e["tf"] for e in done.json["transfer_functions"]] == ["V/F", "X/F"]


def test_json_has_the_documented_keys(shell):
    document = shell("derive", "x.toml", "--format", "json").json
    assert document["schema"] == "symflex.derive/1"
    assert all(set(entry) == ENTRY_KEYS for entry in document["transfer_functions"])


def test_json_and_format_json_are_the_same(shell):
    assert shell("derive", "x.toml", "--json").out == shell("derive", "x.toml", "--format", "json").out


@pytest.mark.parametrize("form", FORMS)
def test_every_form_can_be_asked_for(shell, form):
    (entry,) = shell("derive", "x.toml", "--tf", "X/F", "--form", form, "--json").json["transfer_functions"]
    assert entry["form"] == form


def test_zpk_of_the_oscillator_has_the_asked_digits(shell):
    (entry,) = shell("derive", "x.toml", "--tf", "V/F", "--form", "zpk", "--digits", "3", "--json").json[
        "transfer_functions"
    ]
    assert (entry["num"], entry["den"]) == ("0.5*s", "s^2 + 9")


def test_zpk_without_a_value_says_which(shell):
    done = shell("derive", "symbolic.toml", "--form", "zpk")
    assert (done.code, done.out) == (3, "")
    assert "error[SF229]: parameter 'm' has no value" in done.err


def test_latex_is_one_equation_per_transfer_function(shell):
    assert shell("derive", "x.toml", "--format", "latex").out.count(r"\begin{equation}") == 2


def test_an_unknown_form_is_a_usage_error_with_a_hint(shell):
    done = shell("derive", "x.toml", "--form", "polinomial")
    assert done.code == 2
    assert "did you mean 'polynomial'?" in done.err


def test_an_unknown_transfer_function_is_a_usage_error_with_a_hint(shell):
    done = shell("derive", "x.toml", "--tf", "X/G")
    assert done.code == 2
    assert "did you mean 'X/F'?" in done.err


def test_what_cancelled_is_named(shell):
    assert "hidden: s cancelled" in shell("derive", TWO_MASS, "--tf", "V_act/F").out


@pytest.mark.parametrize("form", [form for form in FORMS if form != "zpk"])
@pytest.mark.parametrize("path", DERIVATIONS, ids=lambda p: p.stem)
def test_json_reads_back_to_the_same_function_exactly(shell, path, form):
    entries = shell("derive", path, "--json", "--form", form).json["transfer_functions"]
    model = pipeline.load(path)
    derived = pipeline.derive_all(model)
    assert [e["tf"] for e in entries] == [tf.name for tf in derived]
    for entry, tf in zip(entries, derived, strict=True):
        point = Point(7)
        for name, expression in entry["where"]:
            point.values[name] = value_of(read(expression), point)
        printed = value_of(read(entry["num"]), point) / value_of(read(entry["den"]), point)
        assert printed == _exact_value(tf, point)


def _exact_value(tf, point):
    """The derived function at the same point, from its polynomials term by term."""
    total = Fraction(tf.ratio.unit)
    for factor, exponent in tf.ratio.factors:
        value = Fraction(0)
        for monomial, coefficient in factor.terms():
            term = Fraction(int(coefficient))
            for name, power in zip(tf.ratio.ring.names, monomial, strict=True):
                if power:
                    term *= point[name] ** int(power)
            value += term
        total *= value**exponent
    return total


def test_two_points_differ_so_that_the_comparison_above_means_something():
    names = random.Random(1).sample("abcdefgh", 3)
    assert [Point(7)[n] for n in names] != [Point(8)[n] for n in names]
