import pytest

from tests.unit.roots.distributed_models import SLIDING_FREE

ROOT_KEYS = {
    "re", "im", "radius", "multiplicity", "frequency_hz", "damping_ratio", "on_imaginary_axis", "is_real",
    "certified", "boundary",
}  # fmt: skip


def test_the_first_transfer_function_is_shown_and_the_others_named_on_stderr(shell):
    done = shell("roots", "x.toml")
    assert done.out.startswith("X/F   certified: 2 of 2 roots enclosed; marginal\n")
    assert done.err == "showing X/F; choose with --tf: V/F\n"


def test_text_shows_a_conjugate_pair_on_one_line(shell):
    lines = shell("roots", "x.toml", "--tf", "X/F", "--digits", "4").out.splitlines()
    assert "  zeros: none" in lines
    assert "  poles: none, there are fewer than 9\n" in shell("roots", "x.toml", "--mode", "9").out
    # sqrt(18/2) = 3 rad/s, and 3/(2 pi) = 0.477465 Hz
    assert [line.split() for line in lines if "+-" in line] == [["0", "+-3.000", "0", "0.477465", "0"]]


def test_json_has_the_documented_keys(shell):
    done = shell("roots", "x.toml", "--tf", "V/F", "--json")
    assert (done.code, done.err) == (0, "")
    document = done.json
    assert set(document) == {
        "schema", "tf", "region", "certified", "stability", "poles", "zeros", "right_half_plane", "hidden",
        "hides_more", "excluded", "certificate",
    }  # fmt: skip
    assert document["schema"] == "symflex.roots/1"
    assert set(document["certificate"]) == {"engine", "counted", "found", "reason", "budget_exceeded"}
    assert all(set(root) == ROOT_KEYS for root in document["poles"] + document["zeros"])


def test_the_digits_of_the_specification_are_the_default(shell):
    text = (shell.folder / "x.toml").read_text() + "[analysis]\ndigits = 7\n"
    (shell.folder / "seven.toml").write_text(text)
    assert shell("roots", "seven.toml", "--json").json["poles"][0]["im"] == "3.000000"


def test_a_band_is_in_hertz_or_carries_a_unit(shell):
    for low, high, count in (("0.1", "1", 2), ("1", "2", 0), ("100 mHz", "1 kHz", 2)):
        assert len(shell("roots", "x.toml", "--band", low, high, "--json").json["poles"]) == count, (
            low,
            high,
            count,
        )


def test_a_rectangle_may_have_negative_sides_and_hold_one_of_a_pair_printed_with_its_sign(shell):
    arguments = ("roots", "x.toml", "--region", "-1", "1", "-5", "-1", "--digits", "3")
    assert [p["im"] for p in shell(*arguments, "--json").json["poles"]] == ["-3.00"]
    lines = shell(*arguments).out.splitlines()
    assert [line.split()[1] for line in lines if "-3" in line] == ["-3.00"]


def test_a_root_on_the_boundary_is_marked_and_the_mark_explained(shell):
    out = shell("roots", "x.toml", "--region", "0", "1", "-5", "5").out
    assert "| marks a root on the boundary" in out


def test_options_that_make_no_sense_are_usage_errors(shell):
    for options in (
        ("--modes", "1", "--band", "1", "2"),
        ("--band", "2", "1"),
        ("--band", "1 m", "2 m"),
        ("--region", "1", "0", "0", "1"),
        ("--modes", "0"),
        ("--digits", "0"),
        ("--tf", "X"),
        ("--mods", "1"),
    ):
        done = shell("roots", "x.toml", *options)
        assert (done.code, done.out) == (2, ""), options
    assert "--modes" in shell("roots", "x.toml", "--mods", "1").err


def test_what_is_not_certified_ends_with_code_4(shell, monkeypatch):
    from dataclasses import replace

    from symflex import pipeline

    find = pipeline.roots

    def doubtful(*arguments):
        found = find(*arguments)
        return replace(found, certificate=replace(found.certificate, reason="for this test"))

    monkeypatch.setattr(pipeline, "roots", doubtful)
    done = shell("roots", "x.toml")
    assert done.code == 4
    assert "NOT CERTIFIED: for this test" in done.out


def test_a_transfer_function_that_is_zero_has_only_hidden_modes(shell):
    (shell.folder / "zero.toml").write_text((shell.folder / "x.toml").read_text().replace('"s*x"', '"0*x"'))
    document = shell("roots", "zero.toml", "--tf", "V/F", "--json").json
    assert (document["poles"], document["zeros"]) == ([], [])
    assert [root["im"][:2] for root in document["hidden"]] == ["3.", "-3"]


def test_what_is_proved_is_enough_for_the_strict(shell):
    assert shell("roots", "x.toml", "--strict").code == 0


def test_the_default_region_of_a_distributed_system_is_explained(beam):
    shown = " ".join(beam("roots", "beam.toml").out.split())
    assert "; by default, as there are infinitely many" in shown


@pytest.mark.parametrize(
    ("transfer", "said"),
    [
        ("(s - 1)*(s^2 - 2*s + 5)/(s + 2)^4", "not minimum phase: 3 zeros in the right half-plane"),
        ("(s^2 + 1)/(s + 2)^4", "minimum phase: no zero is in the right half-plane"),
        ("D*(s + 1)/(s + 2)^2", ""),  # a delay: no zero, and more phase than is least
    ],
)
def test_zeros_in_the_right_half_plane_are_counted(shell, transfer, said):
    delay = 'blocks.D = { type = "delay", T = 1 }' * ("D*" in transfer)
    spec = f'symflex = 1\ninputs.u = {{}}\noutputs.y = "{transfer}*u"\n{delay}'
    (shell.folder / "zeros.toml").write_text(spec)
    lines = [line.strip() for line in shell("roots", "zeros.toml").out.splitlines()]
    assert [line for line in lines if "minimum phase" in line] == [said] * bool(said)


def test_a_table_has_six_digits_and_json_fifteen(shell):
    spec = 'symflex = 1\ninputs.u = {}\noutputs.y = "u/(s + sqrt(2))"\n'
    (shell.folder / "root.toml").write_text(spec)
    (shell.folder / "asked.toml").write_text(spec + "analysis.digits = 9\n")
    for name, options, digits in (
        ("root", (), "-1.41421"),
        ("asked", (), "-1.41421356"),
        ("root", ("--digits", "8"), "-1.4142136"),
    ):
        assert f" {digits} " in shell("roots", f"{name}.toml", *options).out
    assert shell("roots", "root.toml", "--json").json["poles"][0]["re"] == "-1.41421356237310"


def test_a_budget_is_for_lumped_systems_too(shell):
    document = shell("roots", "x.toml", "--budget", "1e-9", "--json")
    certificate = document.json["certificate"]
    assert (document.code, certificate["budget_exceeded"], certificate["found"]) == (5, True, 0)
    assert certificate["counted"] > 0


@pytest.fixture
def beam(shell):
    (shell.folder / "beam.toml").write_text(SLIDING_FREE)
    return shell


def test_parameters_without_a_value_are_named_in_one_message(shell):
    text = (shell.folder / "symbolic.toml").read_text().replace('"18 N/m"', "{}")
    (shell.folder / "both.toml").write_text(text)
    done = shell("roots", "both.toml")
    assert done.code == 3
    assert done.err.count("error[SF229]") == 1
    assert "2 parameters have no value: m, k" in done.err or "2 parameters have no value: k, m" in done.err


def test_ten_thousand_digits_are_printed(shell):
    # s^2 + 2: sqrt(2) = 1.41421356...; Python alone converts integers of at most 4300 digits.
    (shell.folder / "two.toml").write_text(
        'symflex = 1\nparameters = { m = "1 kg", k = "2 N/m" }\ninputs.F = { force = "x" }\noutputs.X = "x"\n'
        'elements.m = { type = "mass", at = "x", m = "m" }\n'
        'elements.k = { type = "spring", between = ["x", "ground"], k = "k" }\n'
    )
    done = shell("roots", "two.toml", "--digits", "10000", "--json")
    found = done.json["poles"][0]["im"].lstrip("-").replace(".", "")
    assert (done.code, len(found)) == (0, 10_000)
    # Read in parts, for the same reason.
    assert found[:9] == "141421356"
    number = sum(int(found[i : i + 1000]) * 10 ** (9000 - i) for i in range(0, 10_000, 1000))
    assert abs(number**2 - 2 * 10**19998) < 4 * 10**9999


def test_a_matrix_has_poles_and_zeros_of_its_own(shell):
    # By hand: det = (1 - s)/((s + 1)^2 (s + 3)); no entry has a zero.
    (shell.folder / "two.toml").write_text(
        "symflex = 1\ninputs = { a = {}, b = {} }\n"
        'outputs = { y = "a/(s + 1) + 2*b/(s + 3)", z = "a/(s + 1) + b/(s + 1)" }\n'
    )
    done = shell("roots", "two.toml", "--matrix", "--json")
    assert [float(zero["re"]) for zero in done.json["zeros"]] == [1]
    assert done.json["matrix"]["normal_rank"] == 2
    assert "y,z/a,b   certified: 4 of 4" in shell("roots", "two.toml", "--matrix").out
    assert shell("roots", "two.toml", "--matrix", "--in", "b", "--out", "y").code == 0
    assert "no input 'c'" in shell("roots", "two.toml", "--matrix", "--in", "c").err
    assert "for --matrix" in shell("roots", "two.toml", "--in", "a").err
    assert "single pairs" in shell("roots", "two.toml", "--matrix", "--explain").err
    assert "output 'y' is named twice" in shell("roots", "two.toml", "--matrix", "--out", "y,z,y").err


def test_a_matrix_without_values_has_its_smith_mcmillan_form(shell):
    # By hand: of k/(s + a) and 1/(s + a) side by side, 1/(s + a) is the one invariant factor.
    (shell.folder / "named.toml").write_text(
        "symflex = 1\nparameters = { a = {}, k = {} }\ninputs = { u = {}, v = {} }\n"
        'outputs = { y = "(k*u + v)/(s + a)" }\n'
    )
    done = shell("roots", "named.toml", "--matrix", "--letters", "--json")
    assert done.code == 0 and done.json["smith_mcmillan"] == ["1/(s + a)"]
    assert "no value: a, k" in done.err
    assert "SF229" in shell("roots", "named.toml", "--matrix").err
