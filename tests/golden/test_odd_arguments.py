"""Commands with arguments that cannot be meant: the documented exit code, and no file is touched."""

from importlib.resources import files

import pytest

from symflex.cli import run

USAGE, INVALID = 2, 3


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Return a folder with a good specification, one without values, a link and a folder."""
    good = (files("symflex") / "templates" / "two_mass.toml").read_text(encoding="utf-8")
    (tmp_path / "good.toml").write_text(good)
    (tmp_path / "symbolic.toml").write_text(
        'symflex = 1\nparameters.m = {}\nelements.body = { type = "mass", at = "x", m = "m" }\n'
        'inputs.F = { force = "x" }\noutputs.X = "x"\n'
    )
    (tmp_path / "target.txt").write_text("kept\n")
    (tmp_path / "link.pdf").symlink_to("target.txt")
    (tmp_path / "folder.pdf").mkdir()
    monkeypatch.chdir(tmp_path)
    return tmp_path


MISTAKES = [
    "", "bogus", "--bogus", "check", "check missing.toml", "check folder.pdf", "check good.toml more",
    "check --bogus good.toml", "derive missing.toml", "derive good.toml --tf bogus",
    "derive good.toml --tf X_act/G", "derive good.toml --tf /", "derive good.toml --form bogus",
    "derive good.toml --format bogus", "derive good.toml --digits 0", "derive good.toml --digits ten",
    "derive good.toml --digits 1000000", "roots good.toml --tf bogus", "roots good.toml --modes 0",
    "roots good.toml --modes -1", "roots good.toml --modes many", "roots good.toml --digits 0",
    "roots good.toml --digits 10001", "roots good.toml --band 1", "roots good.toml --band 5 1",
    "roots good.toml --band 1 1", "roots good.toml --band -5 1", "roots good.toml --band low high",
    "roots good.toml --band 1 inf", "roots good.toml --band 1 nan", "roots good.toml --band 1 1e999999999",
    "roots good.toml --band 1kg 2kg", "roots good.toml --region 0 1 0", "roots good.toml --region 1 0 0 1",
    "roots good.toml --region 0 1 1 0", "roots good.toml --region a b c d",
    "roots good.toml --region 0 1m 0 1", "roots good.toml --modes 1 --band 1 2",
    "roots good.toml --band 1 2 --region 0 1 0 1", "plot good.toml", "plot good.toml bogus",
    "plot good.toml bode -o figure.jpg", "plot good.toml bode -o nowhere/figure.pdf",
    "plot good.toml bode -o link.pdf", "plot good.toml bode -o folder.pdf", "plot good.toml bode --tf bogus",
    "export good.toml", "export good.toml --to fortran", "export good.toml --to numpy --tf bogus",
    "export good.toml --to numpy -o nowhere/module.py", "export good.toml --to numpy -o link.pdf",
    "export good.toml --to numpy -o folder.pdf", "new bogus", "new two_mass -o good.toml",
    "new two_mass -o link.pdf", "new two_mass -o nowhere/spec.toml", "elements bogus",
]  # fmt: skip


def test_an_argument_that_cannot_be_meant_is_a_usage_error_and_changes_no_file(folder, capsys):
    for arguments in MISTAKES:
        before = {path: path.is_file() and path.read_bytes() for path in sorted(folder.rglob("*"))}
        assert run(arguments.split()) == USAGE, arguments
        printed = capsys.readouterr()
        assert printed.out == "", arguments
        assert printed.err, arguments
        assert {path: path.is_file() and path.read_bytes() for path in sorted(folder.rglob("*"))} == before, (
            arguments
        )


def test_a_parameter_without_value_is_invalid_where_numbers_are_needed(folder, capsys):
    for arguments in ["roots symbolic.toml", "derive symbolic.toml --form zpk", "plot symbolic.toml bode"]:
        assert run(arguments.split()) == INVALID, arguments
        assert "SF229" in capsys.readouterr().err, arguments


def test_the_nearest_command_target_or_element_is_named(folder, capsys):
    for mistake, meant in [
        ("chekc good.toml", "check"),
        ("export good.toml --to nunpy", "numpy"),
        ("elements sprnig", "spring"),
    ]:
        assert run(mistake.split()) == USAGE, mistake
        assert f"id you mean '{meant}'?" in capsys.readouterr().err, mistake


def test_a_band_in_radians_per_second_is_the_same_band_in_hertz(folder, capsys):
    # 62.83185307 rad/s is 10 Hz, 628.3185307 rad/s is 100 Hz: the resonance at 12.7 Hz lies between.
    shown = []
    for low, high in (("10", "100"), ("62.83185307 rad/s", "628.3185307 rad/s")):
        assert run(["roots", "good.toml", "--band", low, high]) == 0
        shown.append([line for line in capsys.readouterr().out.splitlines() if "shown" not in line])
    assert shown[0] == shown[1]
