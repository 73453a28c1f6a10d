"""The nested representation on the command line."""

import json

import pytest

NAMES = """
symflex = 1
parameters = { w_1 = "2 kg", "Z_1" = "3 kg", T_1 = "4 N/m", P_1 = "5 N*s/m" }
inputs = { F = { force = "x" } }
outputs = { X = "x", Y = "y" }
[elements]
first = { type = "mass", at = "x", m = "w_1" }
second = { type = "mass", at = "y", m = "Z_1" }
spring = { type = "spring", between = ["x", "y"], k = "T_1" }
loss = { type = "damper", between = ["x", "y"], b = "P_1" }
"""

BEAM = """
symflex = 1
parameters = { EI = {}, m = {}, l = {} }
inputs = { F = { force = "a.y" } }
outputs = { Y = "a.y" }
elements.bar = { type = "beam", between = ["a", "ground"], E = "EI", I = "1", rho = "m", A = "1", l = "l" }
"""


@pytest.fixture
def spec(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "names.toml").write_text(NAMES, "utf-8")
    (tmp_path / "beam.toml").write_text(BEAM, "utf-8")
    return "names.toml"


def test_the_nested_form_names_sub_impedances_apart_from_parameters(shell, spec):
    for option in (("--form", "nested"), ("--representation", "nested")):
        done = shell("derive", spec, "--tf", "X/F", *option)
        assert done.code == 0, option
        assert "w_2 = P_1*s + T_1" in done.out, option
        assert "Z_2 = Z_1*s^2" in done.out, option
        assert "w_1*s^2 + w_2*Z_2/(Z_2 + w_2)" in done.out, option
        assert "hidden modes: not examined" in done.out, option


def test_json_has_the_schema_of_other_forms(shell, spec):
    (entry,) = json.loads(shell("derive", spec, "--tf", "Y/F", "--form", "nested", "--json").out)[
        "transfer_functions"
    ]
    assert (entry["form"], entry["hidden"], entry["quantity"]) == ("nested", None, "receptance")
    assert [name for name, _ in entry["where"]] == ["w_2", "Z_2", "T_2"]
    assert (entry["num"], entry["den"]) == ("T_2", "w_1*s^2 + Z_2*T_2")


def test_latex_prints_a_sequence_of_named_sub_impedances(shell, spec):
    done = shell("derive", spec, "--tf", "X/F", "--form", "nested", "--format", "latex", "--width", "ieee")
    assert r"\text{where}\quad w_{2} &= P_{1} s + T_{1}" in done.out
    assert r"Z_{2} &= Z_{1} s^{2}" in done.out


def test_form_and_representation_must_agree(shell, spec):
    for arguments, code in (
        (("--form", "nested", "--representation", "expanded"), 2),
        (("--form", "polynomial", "--representation", "nested"), 2),
        (("--representation", "dense"), 2),
        (("--form", "polynomial"), 0),
        (("--representation", "auto"), 0),
    ):
        assert shell("derive", spec, *arguments).code == code, (arguments, code)


def test_a_nested_beam_says_what_its_functions_are(shell, spec):
    done = shell("derive", "beam.toml", "--form", "nested")
    assert (done.code, done.err) == (0, "")
    assert "h(0) = h'(0) = " in done.out


def test_equal_factors_are_a_power_and_opposite_terms_are_gone(shell, spec):
    from pathlib import Path

    Path("motor.toml").write_text(
        """
symflex = 1
parameters = { R = {}, k_t = {}, G = {}, d = {}, l = {}, J = {} }
definitions = { k = "pi*G*d^4/(32*l)" }
inputs = { u = { voltage = "v" } }
outputs = { X = "phi" }
[elements]
motor = { type = "dc_motor", terminals = ["v", "ground"], shaft = "phi", R = "R", k_t = "k_t" }
rotor = { type = "inertia", at = "phi", J = "J" }
shaft = { type = "torsion_spring", between = ["phi", "ground"], k = "k" }
""",
        "utf-8",
    )
    done = shell("derive", "motor.toml", "--form", "nested")
    # By hand: J s^2 X + k X = k_t (u - k_t s X)/R, with k of a round bar in torsion.
    assert "k_t^2*s" in done.out and "k = pi*G*d^4/(32*l)" in done.out and "k_t*k_t" not in done.out


def test_terms_that_cancel_in_a_sum_are_left_out(shell, spec):
    from symflex.expressions import Name, Negative
    from symflex.print.forms.nested import _Printer

    a, b = Name("a"), Name("b")
    printer = _Printer(None, {})
    assert printer._sum([a, b, Negative(a)]) == b
