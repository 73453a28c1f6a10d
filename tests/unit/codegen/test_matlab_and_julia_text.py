"""The text of exported function files and modules, whatever machine reads it."""

from __future__ import annotations

import re
from functools import cache

import pytest

import symflex
from symflex.codegen.infix import in_lines
from symflex.codegen.julia import JULIA, module_name
from symflex.codegen.matlab import MATLAB, NAMES, main_name
from symflex.codegen.module_text import identifiers
from tests.house.repository import slow_ones
from tests.unit.codegen.exportable import DERIVATIONS, derived

TARGETS = {"matlab": (MATLAB, 88), "julia": (JULIA, 92)}
SHORT = ["two_mass", "rod_tip_mass", "delayed", "chain"]
CALLING = slow_ones(
    [*SHORT, "timoshenko_cantilever", "two_beams", "pipe_with_flow", "massless_beam"],
    lambda name: name in ("two_beams", "pipe_with_flow"),
)


@cache
def made(target, name):
    model, tfs = derived(name)
    return TARGETS[target][0].export(model, tfs, name, samples=5)


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("name", SHORT)
def test_lines_are_no_longer_than_the_language_likes(target, name):
    lines = made(target, name).text.split("\n")
    assert max(map(len, lines)) <= TARGETS[target][1]
    assert not any(line != line.rstrip() for line in lines)


@pytest.mark.parametrize("target", TARGETS)
def test_a_transfer_function_given_twice_is_written_once(target):
    model, tfs = derived("two_mass")
    once, twice = (TARGETS[target][0].export(model, t, "x", samples=5).text for t in (tfs, [*tfs, *tfs]))
    assert once == twice


@pytest.mark.parametrize("target", TARGETS)
def test_functions_come_first_and_then_responses_in_what_was_measured(target):
    verified = made(target, "rod_tip_mass").verified
    assert [v.name for v in verified] == ["X_tip/F", "F_wall/F"] * 2
    assert [v.form for v in verified] == ["pieces", "pieces", "real", "real"]


@pytest.mark.parametrize("target", TARGETS)
def test_what_was_measured_stands_in_the_text(target):
    export = made(target, "rod_tip_mass")
    said = " ".join(export.text.replace("%", " ").split())
    assert all(said.count(v.text()) for v in export.verified)


@pytest.mark.parametrize("name", CALLING)
def test_every_function_that_matlab_calls_is_in_the_file(name):
    text = made("matlab", name).text
    code = "\n".join(line for line in text.split("\n") if not line.startswith("%"))
    defined = re.findall(r"^function (?:\S+|\[.*?\]) = (\w+)\(", code, re.MULTILINE)
    called = set(re.findall(r"@(\w+)", code)) | {n for n in NAMES if re.search(rf"\b{n}\(", code)}
    assert len(defined) == len(set(defined))
    assert called - {"x"} <= {*defined, "isreal"}
    assert all(code.count(n) > 1 for n in defined[1:])
    assert code.count("\nfunction ") + 1 == len(re.findall(r"^end$", code, re.MULTILINE))


@pytest.mark.parametrize("name", CALLING)
def test_every_private_function_that_julia_calls_is_in_the_module(name):
    text = made("julia", name).text
    defined = set(re.findall(r"^function (\w+)\(", text, re.MULTILINE))
    assert set(re.findall(r"(?<![\w.])(_[A-Za-z]\w*)\(", text)) <= defined
    assert ("import LinearAlgebra" in text) == ("_characteristic_roots(" in text)


@pytest.mark.slow
def test_matlab_needs_no_complex_one_to_take_roots_of_negative_numbers():
    text = made("matlab", "two_beams").text
    assert "sqrt(" in text
    assert "(1.0 + 0" not in text
    assert "complex(1" not in text


def test_the_first_line_of_the_help_says_what_it_is():
    lines = made("matlab", "two_mass").text.split("\n")
    assert lines[:3] == [
        "function G = two_mass()",
        "%TWO_MASS  Transfer functions of: Two masses joined by a flexible transmission",
        "%",
    ]


@pytest.mark.parametrize(
    ("wanted", "name"),
    [
        ("beam", "beam"),
        ("Beam_2", "Beam_2"),
        ("end", "end_"),
        ("my-beam", "my_beam"),
        ("_x", "p_x"),
        ("x" * 64, "x" * 30),
        ("x" * 63, "x" * 63),
        ("numbers", "numbers_"),
        ("\N{GREEK SMALL LETTER MU}", "p_"),
    ],
)
def test_the_name_of_a_main_function_is_one_that_matlab_takes(wanted, name):
    assert main_name(wanted)[:63] == main_name(wanted)
    assert main_name(wanted).startswith(name[:30])
    assert main_name(wanted) == name or len(wanted) > 63


@pytest.mark.parametrize(
    ("wanted", "name"),
    [
        ("beam", "Beam"),
        ("my-beam 2", "MyBeam2"),
        ("2x", "P2x"),
        ("base", "Base_"),
        ("///", "TransferFunctions"),
    ],
)
def test_the_name_of_a_module_begins_its_words_with_capitals(wanted, name):
    assert module_name(wanted) == name


def test_cut_identifiers_stay_apart():
    wanted = {str(i): "stiffness_of_the_bearing" for i in range(120)}
    found = list(identifiers(wanted, {"stiffness_"}, longest=10).values())
    assert len(set(found)) == 120
    assert max(map(len, found)) == 10


def test_lines_of_code_end_after_operators():
    text = " + ".join(f"a_{i} .* (b_{i} - c_{i})" for i in range(40))
    lines = in_lines(text, 40)
    assert " ".join(lines) == text
    assert max(map(len, lines)) <= 40
    assert not any(line.startswith(("+", "-", "*", ".*")) for line in lines)


@pytest.mark.slow
def test_a_model_of_the_python_interface_exports_both():
    text = DERIVATIONS["rod_tip_mass"].read_text()
    model = symflex.loads(text)
    assert model.export_matlab("rod").startswith("function G = rod()\n")
    assert "\nmodule Rod\n" in model.export_julia("rod")
    assert '#include "' not in model.export_c()  # it needs no header beside it
    assert "double complex" in model.export_c()
    assert "import jax" in model.export_jax()
    assert "import jax" not in model.export_array_api()
    assert model.export_matlab().startswith("function G = Axial_rod_held_at_one_end")
