"""The text of exported function files and modules, whatever machine reads it."""

import re
from functools import cache

import pytest

import symflex
from symflex.codegen.infix import in_lines
from symflex.codegen.julia import JULIA, module_name
from symflex.codegen.matlab import MATLAB, NAMES, main_name
from tests.unit.codegen.exportable import DERIVATIONS, derived

TARGETS = {"matlab": (MATLAB, 88), "julia": (JULIA, 92)}
SHORT = ["two_mass", "rod_tip_mass", "delayed", "chain"]
CALLING = [*SHORT, "timoshenko_cantilever", "massless_beam"]


@cache
def made(target, name):
    model, tfs = derived(name)
    return TARGETS[target][0].export(model, tfs, name, samples=5)


@pytest.mark.slow
def test_lines_are_no_longer_than_the_language_likes():
    for target, (_, width) in TARGETS.items():
        for name in SHORT:
            lines = made(target, name).text.split("\n")
            assert max(map(len, lines)) <= width, (target, name)
            assert not any(line != line.rstrip() for line in lines), (target, name)


@pytest.mark.slow
def test_a_transfer_function_given_twice_is_written_once():
    model, tfs = derived("two_mass")
    for language, _ in TARGETS.values():
        once, twice = (language.export(model, t, "x", samples=5).text for t in (tfs, [*tfs, *tfs]))
        assert once == twice


def test_functions_come_first_and_then_responses_in_what_was_measured_and_is_said():
    for target in TARGETS:
        export = made(target, "rod_tip_mass")
        assert [v.name for v in export.verified] == ["X_tip/F", "F_wall/F"] * 2
        assert [v.form for v in export.verified] == ["pieces"] * 4
        said = " ".join(export.text.replace("%", " ").split())
        assert all(said.count(v.text()) for v in export.verified)


@pytest.mark.slow
def test_every_function_that_matlab_calls_is_in_the_file():
    for name in CALLING:
        text = made("matlab", name).text
        code = "\n".join(line for line in text.split("\n") if not line.startswith("%"))
        defined = re.findall(r"^function (?:\S+|\[.*?\]) = (\w+)\(", code, re.MULTILINE)
        called = set(re.findall(r"@(\w+)", code)) | {n for n in NAMES if re.search(rf"\b{n}\(", code)}
        assert len(defined) == len(set(defined)), name
        assert called - {"x"} <= {*defined, "isreal"}, name
        assert all(code.count(n) > 1 for n in defined[1:]), name
        assert code.count("\nfunction ") + 1 == len(re.findall(r"^end$", code, re.MULTILINE)), name
    # Square roots need no complex operand.
    text = made("matlab", "massless_beam").text
    assert "complex(1" not in text
    assert "(1.0 + 0" not in text


STRING = re.compile(r'"""(?:[^"\\]|\\.|"(?!""))*"""|"(?:[^"\\\n]|\\.)*"')


@pytest.mark.slow
def test_every_private_function_that_julia_calls_is_in_the_module_and_brackets_are_balanced():
    for name in CALLING:
        text = made("julia", name).text
        defined = set(re.findall(r"^function (\w+)\(", text, re.MULTILINE))
        assert set(re.findall(r"(?<![\w.])(_[A-Za-z]\w*)\(", text)) <= defined, name
        assert ("import LinearAlgebra" in text) == ("_characteristic_roots(" in text), name
        code = re.sub(r"#.*", "", STRING.sub('""', text))
        for pair in ("()", "[]", "{}"):
            depth = 0
            for c in code:
                depth += (c == pair[0]) - (c == pair[1])
                assert depth >= 0, (name, pair)
            assert depth == 0, (name, pair)
        opened = re.findall(r"^\s*(?:module|function|if|for)\b", code, re.MULTILINE)
        assert len(opened) == len(re.findall(r"^\s*end\b", code, re.MULTILINE)), name


def test_the_first_line_of_the_help_says_what_it_is():
    lines = made("matlab", "two_mass").text.split("\n")
    assert lines[:3] == [
        "function G = two_mass()",
        "%TWO_MASS  Transfer functions of: Two masses joined by a flexible transmission",
        "%",
    ]


def test_the_name_of_a_main_function_is_one_that_matlab_takes():
    names = {
        "beam": "beam",
        "Beam_2": "Beam_2",
        "end": "end_",
        "my-beam": "my_beam",
        "_x": "p_x",
        "x" * 63: "x" * 63,
        "numbers": "numbers_",
        "\N{GREEK SMALL LETTER MU}": "p_",
    }
    assert {wanted: main_name(wanted) for wanted in names} == names
    assert main_name("x" * 64)[:63] == main_name("x" * 64)
    assert main_name("x" * 64).startswith("x" * 30)


def test_the_name_of_a_module_begins_its_words_with_capitals():
    names = {"beam": "Beam", "my-beam 2": "MyBeam2", "2x": "P2x", "base": "Base_", "///": "TransferFunctions"}
    assert {wanted: module_name(wanted) for wanted in names} == names


def test_comments_call_an_argument_what_the_code_calls_it():
    spec = 'symflex = 1\nparameters.function = "2 kg"\ninputs.F = {}\noutputs.x = "F/(function*s^2)"'
    model = symflex.loads(spec)
    for text in (model.export_matlab(), model.export_julia(), model.export_js()):
        assert "function_ = 2.0: 'function' in the model [kg]." in text


def test_lines_of_code_end_after_operators():
    text = " + ".join(f"a_{i} .* (b_{i} - c_{i})" for i in range(40))
    lines = in_lines(text, 40)
    assert " ".join(lines) == text
    assert max(map(len, lines)) <= 40
    assert not any(line.startswith(("+", "-", "*", ".*")) for line in lines)


@pytest.mark.slow
def test_a_model_of_the_python_interface_exports_both():
    text = DERIVATIONS["two_mass"].read_text()
    model = symflex.loads(text)
    assert model.export_matlab("rod").startswith("function G = rod()\n")
    assert "\nmodule Rod\n" in model.export_julia("rod")
    assert '#include "' not in model.export_c()  # it needs no header beside it
    assert "double complex" in model.export_c()
    assert "import jax" in model.export_jax()
    assert "import jax" not in model.export_array_api()
    assert model.export_matlab().startswith("function G = Two_masses_joined")
