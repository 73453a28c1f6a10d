"""``stability``, ``peak``, ``colocation`` and figures of loops on the command line."""

import json

import pytest

LOOP = """
symflex = 1
[parameters]
K = 1
T = { value = "0.5 s" }
[blocks]
D = { type = "delay", T = "T" }
[signals]
y = "K*D/s*(r - y)"
[inputs]
r = {}
[outputs]
Y = "y"
E = "r - y"
[figures.paths]
kind = "locus"
gain = "K"
"""
BEAM = """
symflex = 1
[parameters]
K = "10 N/m"
EI = "1 N*m^2"
[elements]
drive = { type = "force_source", at = "x", f = "F" }
mass = { type = "mass", at = "x", m = "1 kg" }
rod = { type = "rod", between = ["x", "y"], E = "1 Pa", A = "1 m^2", rho = "1 kg/m^3", l = "1 m" }
[signals]
F = "K*(r - x)"
[inputs]
r = {}
[outputs]
X = "x"
"""


@pytest.fixture
def files(shell):
    (shell.folder / "loop.toml").write_text(LOOP, encoding="utf-8")
    (shell.folder / "lossless.toml").write_text(BEAM.replace('EI = "1 N*m^2"\n', ""), encoding="utf-8")
    return shell


def test_a_stable_range_is_printed_and_is_in_the_json(files):
    command = ("stability", "loop.toml", "--gain", "K", "--range", "0", "20")
    done = files(*command)
    assert (done.code, done.err) == (0, "")
    assert "0 < K < 3.14159265358979" in done.out
    assert max(map(len, done.out.splitlines())) <= 80
    document = files(*command, "--digits", "30", "--json").json
    assert document["schema"] == "symflex.stability/1"
    assert document["boundaries"][0]["gain"]["value"] == "3.14159265358979323846264338328"


def test_what_is_not_certified_has_exit_code_4(files):
    done = files("stability", "lossless.toml", "--gain", "K", "--up-to", "1 Hz")
    assert done.code == 4
    assert "NOT CERTIFIED" in done.out


def test_a_peak_is_printed_and_is_in_the_json(files):
    done = files("peak", "loop.toml", "--tf", "E/r")
    assert (done.code, done.err) == (0, "")
    assert done.out.splitlines()[0] == "E/r [1]   certified"
    document = files("peak", "loop.toml", "--tf", "E/r", "--json").json
    assert document["schema"] == "symflex.peak/1" and document["certified"]
    assert done.out.splitlines()[1].startswith(f"  largest magnitude {document['magnitude']}, radius")
    assert files("peak", "loop.toml", "--band", "2", "1").code == 2
    assert files("hinf", "loop.toml").err.strip().endswith("Write: symflex peak SPEC")


def test_a_gain_that_follows_from_parameters_is_said_to_be_a_definition(files, tmp_path):
    loop = 'parameters = { k = 2, K = "k/3" }\nsignals.y = "K*(r - y)/s"\ninputs.r = {}\noutputs.Y = "y"\n'
    (tmp_path / "defined.toml").write_text(f"symflex = 1\n{loop}")
    said = "'K' is a definition, and follows from parameters: there is no parameter 'K'"
    assert said in files("stability", str(tmp_path / "defined.toml"), "--gain", "K").err


def test_without_a_gain_the_parameters_are_listed(files):
    assert files("stability", "loop.toml").err.endswith("hint: parameters: K, T\n")


def test_errors(files):
    for arguments, code, exit_code in (
        (("stability", "loop.toml", "--gain", "Q"), "SF902", 2),
        (("stability", "loop.toml"), "SF902", 2),
        (("stability", "loop.toml", "--gain", "T"), "SF801", 3),
        (("stability", "loop.toml", "--gain", "K", "--range", "3", "1"), "SF804", 2),
        (("stability", "loop.toml", "--gain", "K", "--range", "0", "inf"), "SF804", 2),
        (("stability", "loop.toml", "--gain", "K", "--range", "0", "x"), "SF902", 2),
        (("stability", "loop.toml", "--gain", "K", "--range", "0", "1 s"), "SF203", 2),
        (("stability", "loop.toml", "--gain", "K", "--up-to", "-1"), "SF902", 2),
        (("stability", "loop.toml", "--gain", "K", "--budget", "1e-9"), "SF506", 5),
        (("colocation", "loop.toml", "--tf", "Y/r", "--with", "E/r"), "SF804", 2),
        (("colocation", "loop.toml", "--tf", "Y/r", "--with", "Z/r"), "SF902", 2),
        (("colocation", "loop.toml", "--tf", "Y/r", "--with", "E/r", "--phase", "no"), "SF902", 2),
        (("plot", "loop.toml", "locus"), "SF902", 2),
        (("plot", "loop.toml", "bode", "--gain", "K"), "SF902", 2),
        (("plot", "loop.toml", "locus", "--gain", "Q"), "SF902", 2),
    ):
        done = files(*arguments)
        assert done.code == exit_code, (arguments, code, exit_code)
        assert f"error[{code}]" in done.err, (arguments, code, exit_code)


def test_outputs_that_are_not_together_are_told(files):
    done = files("colocation", "loop.toml", "--tf", "Y/r", "--with", "E/r", "--band", "0.01", "1", "--json")
    document = json.loads(done.out)
    assert document["schema"] == "symflex.colocation/1"
    assert document["colocated_at_start"] is False


@pytest.mark.slow
def test_figures_of_loops_are_drawn(files):
    # A rational loop is quicker than one with a delay.
    text = LOOP.replace("K*D/s", "K/(s*(s + 1))").replace('[blocks]\nD = { type = "delay", T = "T" }\n', "")
    text = text.replace('T = { value = "0.5 s" }\n', "")
    (files.folder / "short.toml").write_text(text, encoding="utf-8")
    for arguments in (("paths",), ("nyquist", "--gain", "K"), ("nyquist", "--tf", "E/r")):
        done = files("plot", "short.toml", *arguments, "-o", "a.svg")
        assert (done.code, done.err) == (0, "wrote a.svg\n"), arguments


def test_a_gain_that_is_none_is_an_error_of_the_specification(files):
    for table, code in (
        ('kind = "bode"\ngain = "K"', "SF207"),
        ('kind = "locus"\ngain = "Q"', "SF210"),
        ("gain = 1", "SF2"),
    ):
        text = LOOP.replace('kind = "locus"\ngain = "K"', table)
        (files.folder / "wrong.toml").write_text(text, encoding="utf-8")
        done = files("check", "wrong.toml")
        assert done.code == 3, (table, code)
        assert f"error[{code}" in done.err, (table, code)


def test_the_first_boundaries_are_printed_or_all_of_them(shell):
    (shell.folder / "loop.toml").write_text(LOOP, encoding="utf-8")
    asked = ("stability", "loop.toml", "--gain", "K", "--range", "0", "200", "--digits", "6")
    # Poles cross the axis at K = (1 + 4 k) pi, sixteen times up to 200.
    first, every = shell(*asked).out, shell(*asked, "--all").out
    assert "boundaries: 16, the first 10 shown; --all shows all" in first
    assert "boundaries: 16\n" in every
    for k in range(16):
        assert (f"{(1 + 4 * k) * 3.141592653589793:.6g}"[:5] in first, k) == (k < 10, k)
        assert f"{(1 + 4 * k) * 3.141592653589793:.6g}"[:5] in every
