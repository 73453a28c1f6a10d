import re

import pytest

from symflex import pipeline
from symflex.print.forms.printed import RATIONAL, forms_of
from tests.contract.exact import Point, read, value_of
from tests.unit.cli.commands import TWO_MASS, WORKED
from tests.unit.print.residues import point_for

ENTRY_KEYS = {"tf", "quantity", "unit", "form", "num", "den", "where", "laws", "latex", "hidden", "stability"}


def test_text_shows_a_fraction_under_its_name_and_unit(shell):
    done = shell("derive", "x.toml", "--tf", "X/F")
    assert (done.code, done.err) == (0, "")
    assert [line.strip() for line in done.out.splitlines()] == [
        "X/F   receptance [m/N]",
        "",
        "1",
        "---------",
        "m*s^2 + k",
    ]


def test_all_functions_are_derived_by_default_and_tf_may_be_repeated_and_sets_the_order(shell):
    for arguments, names in (((), ["X/F", "V/F"]), (("--tf", "V/F", "--tf", "X/F"), ["V/F", "X/F"])):
        done = shell("derive", "x.toml", "--json", *arguments)
        assert [e["tf"] for e in done.json["transfer_functions"]] == names


def test_json_has_the_documented_keys(shell):
    done = shell("derive", "x.toml", "--format", "json")
    assert done.json["schema"] == "symflex.derive/1"
    assert all(set(entry) == ENTRY_KEYS for entry in done.json["transfer_functions"])
    assert shell("derive", "x.toml", "--json").out == done.out


def test_every_form_can_be_asked_for(shell):
    for form in RATIONAL:
        (entry,) = shell("derive", "x.toml", "--tf", "X/F", "--form", form, "--json").json[
            "transfer_functions"
        ]
        assert entry["form"] == form, form


def test_zpk_of_the_oscillator_has_the_asked_digits(shell):
    (entry,) = shell("derive", "x.toml", "--tf", "V/F", "--form", "zpk", "--digits", "3", "--json").json[
        "transfer_functions"
    ]
    assert (entry["num"], entry["den"]) == ("0.5*s", "s^2 + 9")


def test_zpk_without_a_value_says_which(shell):
    done = shell("derive", "symbolic.toml", "--form", "zpk")
    assert (done.code, done.out) == (3, "")
    assert "error[SF229]: parameter 'm' has no value" in done.err


def test_an_unknown_form_or_transfer_function_is_a_usage_error_with_a_hint(shell):
    for option, value, meant in (("--form", "polinomial", "polynomial"), ("--tf", "X/G", "X/F")):
        done = shell("derive", "x.toml", option, value)
        assert (done.code, f"did you mean '{meant}'?" in done.err) == (2, True), value


@pytest.mark.parametrize("name", ["eppinger1988/base_flexure", "classics/rod_tip_mass"])
@pytest.mark.slow
def test_json_reads_back_to_the_same_function_exactly(shell, name):
    path = WORKED / f"{name}.toml"
    model = pipeline.load(path)
    derived = pipeline.derive_all(model)
    for form in (f for f in forms_of(derived[0]) if f != "zpk"):
        entries = shell("derive", path, "--json", "--form", form).json["transfer_functions"]
        assert [e["tf"] for e in entries] == [tf.name for tf in derived]
        for entry, tf in zip(entries, derived, strict=True):
            where = [(name, read(expression)) for name, expression in entry["where"]]
            point = point_for(tf)
            assert point.form(read(entry["num"]), read(entry["den"]), where) == point.truth


def test_two_points_differ_so_that_the_comparison_above_means_something():
    (tf, *_) = pipeline.derive_all(pipeline.load(TWO_MASS))
    assert point_for(tf, 1).truth != point_for(tf, 2).truth


MIXED = """symflex = 1
parameters = { E = "70 GPa", A = "1 cm^2", rho = "2700 kg/m^3", l = "1 m", m = "2 kg" }
inputs     = { F = { force = "q" }, G = { force = "x" } }
outputs    = { Q = "q", X = "x" }
[elements]
rod = { type = "rod", between = ["ground", "q"], E = "E", A = "A", rho = "rho", l = "l" }
car = { type = "mass", at = "x", m = "m" }
"""


def test_functions_that_lack_a_form_are_printed_in_their_own_with_a_note_unless_all_do(shell):
    (shell.folder / "mixed.toml").write_text(MIXED, encoding="utf-8")
    done = shell("derive", "mixed.toml", "--form", "krylov", "--tf", "Q/F", "--tf", "X/G")
    assert done.code == 0
    assert "krylov form" in done.out
    assert done.err.strip() == "X/G has no krylov form: printed in its definitions form"
    alone = shell("derive", "mixed.toml", "--form", "krylov", "--tf", "X/G")
    assert (alone.code, "SF902" in alone.err) == (2, True)


LOOP = """symflex = 1
parameters = { mass = {}, T = {}, damping = {}, stiffness = {}, integral_gain = {} }
inputs.u = {}
signals.p = "u/(mass*s^2*(T*s + 1) + damping*s*(T*s + 1) + stiffness + integral_gain/s)"
outputs.P = "p"
outputs.V = "s*p"
"""
BY_HAND = "(mass*s^3 + damping*s^2)*(T*s + 1) + stiffness*s + integral_gain"


def test_a_long_denominator_of_several_functions_is_printed_once(shell):
    values = {"mass": 2, "T": 3, "damping": 5, "stiffness": 7, "integral_gain": 11, "s": 13, "D": 3}
    by_hand = value_of(read(BY_HAND), Point(1, **values))
    other = LOOP + f'outputs.Y = "u/(1 + s*({BY_HAND}))"\n'
    # A parameter may be called D already, and columns of LaTeX call every other long denominator D(s).
    for text, name in ((LOOP, "D"), (LOOP.replace("T", "D"), "D_1"), (other, "D_1")):
        (shell.folder / "loop.toml").write_text(text)
        done = shell("derive", "loop.toml")
        ((found, den),) = re.findall(r"where (\S+) = (.*)", done.out)
        assert (found, value_of(read(den), Point(1, **values))) == (name, by_hand)
        assert re.findall(r"^ +(\S+)$", done.out, re.MULTILINE).count(name) == 2
        latex = shell("derive", "loop.toml", "--format", "latex", "--width", "ieee").out
        label = name.replace("_1", "_{1}")
        assert (latex.count(f"}}{{{label}}}"), latex.count(rf"{label} &=")) == (2, 1)
    entries = shell("derive", "loop.toml", "--json").json["transfer_functions"]
    assert [value_of(read(e["den"]), Point(1, **values)) for e in entries[:2]] == [by_hand, by_hand]


def chain(count):
    """A chain from ground to x1, ..., xN, all symbols."""
    names = range(1, count + 1)
    lines = [
        "symflex = 1",
        "[parameters]",
        *(f"m{i} = {{}}\nk{i} = {{}}\nb{i} = {{}}" for i in names),
        "[elements]",
    ]
    for i in names:
        ends = f'between = ["{f"x{i - 1}" if i > 1 else "ground"}", "x{i}"]'
        lines.append(f'M{i} = {{ type = "mass", at = "x{i}", m = "m{i}" }}')
        lines.append(f'K{i} = {{ type = "spring", {ends}, k = "k{i}" }}')
        lines.append(f'B{i} = {{ type = "damper", {ends}, b = "b{i}" }}')
    return "\n".join([*lines, "[inputs]", 'F = { force = "x1" }', "[outputs]", f'X = "x{count}"'])


@pytest.mark.slow
def test_a_long_print_is_announced_and_a_short_one_is_not(shell):
    (shell.folder / "long.toml").write_text(chain(10))
    done = shell("derive", "long.toml", "--representation", "expanded")
    # The terms of a chain's determinant are the matchings of a path of 20 nodes, a Fibonacci number: 6765.
    # The numerator is one product.
    assert done.err == "printing X/F: about 6766 terms; --representation nested is shorter\n"
    assert "printing" not in done.out
    (shell.folder / "short.toml").write_text(chain(3))
    assert shell("derive", "short.toml", "--representation", "expanded").err == ""
    assert shell("derive", "long.toml").err.startswith("in nested form")


FINE = '''
symflex = 1
inputs  = { r = {} }
outputs = { y = "P*r" }
[blocks.P]
type = "tf"
num = "1"
den = """(s^2 + 0.0123456789012345*s + 4567.89012345678)
       * (s^2 + 0.0223456789012345*s + 8567.89012345678)"""
'''
"""Two factors that differ in coefficients beyond a machine word only."""


def test_factors_whose_coefficients_exceed_a_machine_word_are_printed_exactly(shell):
    (shell.folder / "fine.toml").write_text(FINE, encoding="utf-8")
    (entry,) = shell("derive", "fine.toml", "--form", "factored", "--json").json["transfer_functions"]
    # The decimals of the file.
    lossy = ("0.0123456789012345", "4567.89012345678"), ("0.0223456789012345", "8567.89012345678")
    assert entry["den"] == "*".join(f"(s^2 + {b}*s + {c})" for b, c in lossy)


@pytest.mark.slow
def test_factors_whose_coefficients_exceed_a_machine_word_have_every_form_and_are_exported(shell):
    (shell.folder / "fine.toml").write_text(FINE, encoding="utf-8")
    for form in (None, *RATIONAL):
        assert shell("derive", "fine.toml", *(("--form", form) if form else ())).code == 0, form
    for target in ("numpy", "c", "matlab", "julia", "state-space", "latex"):
        options = ("--no-figures", "-o", "fine.tex") if target == "latex" else ()
        assert shell("export", "fine.toml", "--to", target, *options).code == 0, target


def test_a_matrix_has_rows_of_outputs_and_columns_of_inputs_as_named(shell):
    whole = shell("derive", "x.toml", "--matrix", "--json").json
    assert (whole["schema"], whole["outputs"], whole["inputs"]) == ("symflex.matrix/1", ["X", "V"], ["F"])
    assert (whole["num"], whole["den"]) == ([["1"], ["s"]], "m*s^2 + k")
    text = shell("derive", "x.toml", "--matrix", "--out", "V", "--in", "F").out
    assert text.splitlines()[0] == "V / F"


def test_what_only_a_matrix_has_is_refused_without_one_and_the_reverse(shell):
    for arguments, words in (
        (("--in", "F"), "add --matrix"),
        (("--rga",), "add --matrix"),
        (("--matrix", "--tf", "X/F"), "choose rows and columns with --out and --in"),
        (("--matrix", "--short", "1%"), "are for single functions"),
        (("--matrix", "--out", "Y"), "there is no output 'Y'"),
        (("--matrix", "--rga"), "2 outputs and 1 inputs has no inverse"),
    ):
        done = shell("derive", "x.toml", *arguments)
        assert (done.code, words in done.err) == (2, True), (arguments, done.err)
