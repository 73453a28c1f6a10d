"""--set NAME=VALUE: the same as another value in the file, on every command that binds values."""

import json
from math import pi, sqrt

import pytest

import symflex
from tests.unit.refusals import refusal

SPEC = """symflex = 1
[parameters]
m = "2 kg"
k = "8 N/m"
b = { value = "0.4 N*s/m", assume = "nonnegative" }
K = { value = 1, doc = "of the loop" }
f_c = "2 Hz"
[elements]
body = { type = "mass", at = "x", m = "m" }
spring = { type = "spring", between = ["x", "ground"], k = "k" }
loss = { type = "damper", between = ["x", "ground"], b = "b" }
drive = { type = "force_source", at = "x", f = "K*(r - x)" }
[inputs]
r = {}
F = { force = "x" }
[outputs]
X = "x"
V = "s*x"
Y = "x/2"
Filtered = "x/(s + f_c)"
[published."X/F"]
expr = "1/(m*s^2 + b*s + k + K)"
[analysis]
band = ["0.1 Hz", "10 Hz"]
"""
DISC = """symflex = 1
parameters.J = { unit = "kg*m^2" }
inputs.T = { torque = "phi" }
outputs.Phi = "phi"
[elements]
disc = { type = "inertia", at = "phi", J = "J" }
twist = { type = "torsion_spring", between = ["phi", "ground"], k = 9 }
"""
ROD = """symflex = 1
parameters.l = "1 m"
inputs.F = { force = "x" }
outputs.X = "x"
[elements]
bar = { type = "rod", between = ["ground", "x"], E = "210 GPa", A = "1 mm^2", rho = "7800 kg/m^3", l = "l" }
"""


@pytest.fixture
def spec(shell):
    (shell.folder / "spec.toml").write_text(SPEC)
    (shell.folder / "rod.toml").write_text(ROD)
    (shell.folder / "disc.toml").write_text(DISC)
    return shell


def poles(shell, *options):
    done = shell("roots", "spec.toml", "--tf", "X/F", "--json", *options)
    assert done.code == 0, done.err
    return [complex(float(p["re"]), float(p["im"])) for p in json.loads(done.out)["poles"]]


def test_roots_are_those_of_the_value_that_is_set(spec):
    found = poles(spec, "--set", "k=0.05 kN/m", "--set", "b=0", "--set", "K=0.5")
    assert max(p.imag for p in found) == pytest.approx(sqrt(50.5 / 2), rel=1e-14)


def test_a_value_is_written_in_many_ways(spec):
    for text in ("k=50", "k = 50 N/m", "k=50N/m", 'k="50 N/m"', "k='0.05 kN/m'", "k=5e1 N/m"):
        assert max(p.imag for p in poles(spec, "--set", text, "--set", "b=0")) == pytest.approx(
            sqrt(51 / 2)
        ), text


def test_a_frequency_that_is_set_is_read_as_the_one_declared(spec):
    done = spec("roots", "spec.toml", "--tf", "Filtered/F", "--json", "--set", "f_c=3 Hz")
    real = [float(p["re"]) for p in json.loads(done.out)["poles"] if float(p["im"]) == 0]
    assert real == [pytest.approx(-6 * pi, rel=1e-14)]


@pytest.mark.slow
def test_a_value_that_the_file_could_not_have_is_a_usage_error(spec):
    for given, code, said in (
        (["k"], "SF902", "found 'k'"), (["k="], "SF902", "found 'k='"), (["=3"], "SF902", "found '=3'"),
        ([""], "SF902", "found ''"), (["kk=3"], "SF902", "did you mean 'k'?"),
        (["k=3", "k=3"], "SF902", "'k' is set twice"), (["body=3"], "SF902", "'body' is an element"),
        (["s=3"], "SF902", "no parameter 's'"), (["k=nan"], "SF202", "k=nan"), (["k=inf"], "SF202", "k=inf"),
        (["k=2*m"], "SF202", "k=2*m"), (["k=1e999 N/m"], "SF103", "exponent"),
        (["k=3 kg"], "SF203", "'k' is declared in 'N/m', the value given is in 'kg'"),
        (["k=3 foo"], "SF201", "foo"), (["k=-3"], "SF209", "'k' is negative"), (["k=0"], "SF209", "'k' is 0"),
        (["b=-1"], "SF209", "'b' is negative"),
        (["f_c=60"], "SF203", "'f_c' is declared in 'Hz', the value given has no unit"),
        (["k=1", "m=-1", "b=3 s"], "SF209", "'m' is negative"),
    ):  # fmt: skip
        done = spec("roots", "spec.toml", *(part for text in given for part in ("--set", text)))
        assert (done.code, done.out) == (2, ""), (given, code, said)
        assert code in done.err, (given, code, said)
        assert said in done.err, (given, code, said)


def test_what_is_wrong_with_values_is_said_where_they_are_used_and_all_at_once(spec):
    unit = spec("roots", "disc.toml", "--set", "J=3 kg")
    assert (unit.code, "SF203" in unit.err) == (2, True)  # the unit of a parameter without value is kept
    length = spec("roots", "rod.toml", "--set", "l=-1 m")
    assert (length.code, "SF209" in length.err) == (2, True)
    both = spec("check", "spec.toml", "--set", "m=-1", "--set", "k=3 kg")
    assert (both.code, both.err.count("error[")) == (2, 2)


@pytest.mark.slow
def test_every_command_that_binds_values_takes_them_and_refuses_wrong_ones(spec):
    for command in (
        ["check", "spec.toml"],
        ["derive", "spec.toml", "--tf", "X/F", "--form", "zpk"],
        ["rational", "spec.toml", "--tf", "X/F"],
        ["stability", "spec.toml", "--gain", "K"],
        ["colocation", "spec.toml", "--tf", "Y/F", "--with", "X/F"],
        ["export", "spec.toml", "--tf", "X/F", "--to", "numpy"],
        ["plot", "spec.toml", "poles_zeros", "--tf", "X/F", "-o", "a.svg"],
        ["measure", "spec.toml", "--tf", "X/F", "-o", "a.csv"],
        ["audit", "spec.toml"],
        ["sweep", "spec.toml", "--over", "m=1:2:lin:2", "--tf", "X/F", "--workers", "1"],
    ):
        assert spec(*command, "--set", "k=9 N/m").code == 0, command
        assert spec(*command, "--set", "k=9 kg").code == 2, command


def test_what_is_swept_is_not_set(spec):
    done = spec("sweep", "spec.toml", "--over", "k=1:2:lin:2", "--set", "k=3")
    assert (done.code, "'k' is both swept and set" in done.err) == (2, True)


def test_a_sweep_that_is_stored_is_not_drawn_with_other_values(spec):
    assert spec("sweep", "spec.toml", "--over", "m=1:2:lin:2", "--workers", "1", "-o", "a.npz").code == 0
    done = spec("plot", "sweep", "a.npz", "--set", "k=3", "-o", "a.svg")
    assert (done.code, "--set" in done.err) == (2, True)
    assert not (spec.folder / "a.svg").exists()


def test_a_nested_models_parameter_is_set_too(spec):
    (spec.folder / "outer.toml").write_text(
        'symflex = 1\n[blocks]\nG = { type = "model", spec = "spec.toml", tf = "X/F" }\n'
        '[inputs]\nu = {}\n[outputs]\ny = "G*u"\n'
    )
    done = spec("roots", "outer.toml", "--set", "k=49", "--set", "b=0", "--json")
    assert float(json.loads(done.out)["poles"][0]["im"]) == pytest.approx(5)


def test_python_sets_values_as_the_command_does(tmp_path):
    path = tmp_path / "spec.toml"
    path.write_text(SPEC)
    G = symflex.load(path, {"k": "0.049 kN/m", "b": 0, "K": 1.0}).transfer_function("X", "F").bind()
    assert max(complex(p).imag for p in G.poles()) == pytest.approx(5)


def test_python_refuses_what_the_command_refuses():
    values = (float("nan"), float("inf"), -1, "3 kg", "two")
    assert [v for v in values if "UsageError" not in refusal(symflex.loads, SPEC, values={"k": v})] == []
