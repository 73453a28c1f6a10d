"""``symflex roots --sensitivity``."""

from tests.unit.cli.commands import TWO_MASS, WORKED

DAMPED = """
symflex = 1
[parameters]
m = "2 kg"
k = "18 N/m"
b = { value = "0 N*s/m", assume = "nonnegative" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
[elements]
body = { type = "mass", at = "x", m = "m" }
wall = { type = "spring", between = ["x", "ground"], k = "k" }
loss = { type = "damper", between = ["x", "ground"], b = "b" }
"""


def rows(text):
    return [line.split() for line in text.splitlines()]


def test_all_parameters_by_default_or_those_named_and_nothing_without_the_option(shell):
    assert "sensitivity" not in shell("roots", "x.toml").out
    assert "sensitivity" not in shell("roots", "x.toml", "--json").json
    done = shell("roots", "x.toml", "--tf", "X/F", "--sensitivity")
    assert done.code == 0
    # omega = sqrt(k/m)
    assert ["0", "+-3.00000", "m", "-0.500000", "0"] in rows(done.out)
    assert ["k", "0.500000", "0"] in rows(done.out)
    assert "every digit is certified" in done.out
    of_k = shell("roots", "x.toml", "--tf", "X/F", "--sensitivity", "k").out
    assert "0.500000" in of_k
    assert "-0.500000" not in of_k


def test_an_unknown_parameter_is_a_usage_error(shell):
    done = shell("roots", "x.toml", "--tf", "X/F", "--sensitivity=mm")
    assert (done.code, done.out) == (2, "")
    assert "error[SF902]: there is no parameter 'mm'" in done.err


def test_a_parameter_that_is_zero_is_told_per_unit(shell):
    (shell.folder / "damped.toml").write_text(DAMPED)
    out = shell("roots", "damped.toml", "--sensitivity", "b").out
    # dzeta/db = 1/(2 sqrt(k m)) = 1/12 where b = 0
    assert ["0", "+-3.00000", "b*", "0", "0.0833333"] in rows(out)
    assert "* the parameter is 0: (1/f) df/dp and dzeta/dp, per unit: b [N*s/m]" in out


def test_roots_at_zero_that_stay_say_so(shell):
    out = shell("roots", TWO_MASS, "--tf", "X_act/F", "--sensitivity").out
    assert ["0", "0", "stays", "at", "0"] in rows(out)


def test_a_root_that_leaves_zero(shell):
    text = DAMPED.replace('"18 N/m"', '{ value = "0 N/m", assume = "nonnegative" }')
    text = text.replace('{ value = "0 N*s/m", assume = "nonnegative" }', '"4 N*s/m"')
    (shell.folder / "free.toml").write_text(text)
    # m s^2 + b s + k = 0: ds/dk = -1/b at s = 0.
    assert "k: ds/dp = -0.250000" in shell("roots", "free.toml", "--sensitivity").out


def test_multiple_roots_that_part_have_no_numbers(shell):
    text = DAMPED.replace('{ value = "0 N*s/m", assume = "nonnegative" }', '"12 N*s/m"')
    (shell.folder / "critical.toml").write_text(text)
    out = shell("roots", "critical.toml", "--sensitivity").out
    assert "-3.00000           0  no derivative: multiple roots part" in out
    (entry, *_) = shell("roots", "critical.toml", "--sensitivity", "--json").json["sensitivity"]
    assert entry["status"] == "multiple"
    assert [entry[k] for k in ("derivative", "normalised", "frequency_hz", "damping_ratio")] == [None] * 4


def test_what_is_not_decided_ends_with_code_4(shell):
    text = DAMPED.replace('k = "k"', 'k = "k + sqrt(b*k*1e-3)"').replace('unit = ""', "")
    text = text.replace("sqrt(b*k*1e-3)", "k*sqrt(c)").replace(
        "[inputs]", 'c = { value = "0", assume = "nonnegative" }\n[inputs]'
    )
    (shell.folder / "edge.toml").write_text(text)
    done = shell("roots", "edge.toml", "--sensitivity")
    assert done.code == 4
    assert "c: not decided" in done.out


def test_a_model_without_parameters(shell):
    text = DAMPED.replace('m = "m"', "m = 2").replace('k = "k"', "k = 18").replace('b = "b"', "b = 1")
    (shell.folder / "bare.toml").write_text(text)
    done = shell("roots", "bare.toml", "--sensitivity")
    assert (done.code, done.out.splitlines()[-1]) == (0, "  no root depends on a parameter")


def test_lines_fit_80_columns(shell):
    for name in ("eppinger1988/base_flexure", "classics/rod_tip_mass"):
        out = shell("roots", WORKED / f"{name}.toml", "--modes", "2", "--sensitivity").out
        lines = out.split("sensitivity of", 1)[1].splitlines()
        assert [line for line in lines if len(line) > 80] == [], name


def test_lines_fit_80_columns_but_for_a_name_as_long_as_a_name_may_be(shell):
    name = "a_parameter_with_a_name_as_long_as_a_name_may_be_sixty_four_char"
    text = DAMPED.replace('k = "18', f'{name} = "18').replace('k = "k"', f'k = "{name}"')
    (shell.folder / "long.toml").write_text(text)
    out = shell("roots", "long.toml", "--modes", "2", "--sensitivity").out
    long = [line for line in out.split("sensitivity of", 1)[1].splitlines() if len(line) > 80]
    assert [line for line in long if name not in line] == []
    assert ["-0.500000", "0"] in [row[-2:] for row in rows(shell("roots", "long.toml", "--sensitivity").out)]


def test_json(shell):
    document = shell("roots", "x.toml", "--tf", "X/F", "--digits", "5", "--sensitivity", "--json").json
    entries = document["sensitivity"]
    assert [(e["of"], e["index"], e["parameter"]) for e in entries] == [
        ("pole", 0, "m"), ("pole", 0, "k"), ("pole", 1, "m"), ("pole", 1, "k"),
    ]  # fmt: skip
    first = entries[1]
    assert set(first) == {
        "of", "index", "re", "im", "parameter", "unit", "status", "derivative", "normalised", "frequency_hz",
        "damping_ratio",
    }  # fmt: skip
    assert (first["im"], first["unit"], first["status"]) == (document["poles"][0]["im"], "N/m", "certified")
    # s = 3j: ds/dk = s/(2 k) = j/12, df/dk = 1/(24 pi).
    assert (first["derivative"]["re"], first["derivative"]["im"]) == ("0", "0.083333")
    assert first["normalised"]["re"] == "0.50000"
    assert first["frequency_hz"]["value"] == "0.013263"
    assert float(first["damping_ratio"]["value"]) == 0
    assert float(first["derivative"]["radius"]) < 1e-6
