"""``symflex units`` and the shell's completion."""

import json

import pytest

from symflex.cli import group, run


def printed(capsys, *arguments):
    assert run(["units", *arguments]) == 0
    return capsys.readouterr().out


# NIST Special Publication 811 (2008), appendix B
def test_a_unit_is_said_in_si(capsys):
    for unit, said in (
        ("in", "in = 0.0254 m"),
        ("lbf", "lbf = 4.4482216152605 N"),
        ("psi", "about 6894.76"),
        ("deg", "deg = pi/180 rad"),
        ("rpm", "rpm = 1/60 cycle/s"),
        ("mm/rev", "mm/rev = 0.001 m/cycle"),
        ("ppm", "ppm = 0.000001"),
        ("kN/mm", "kN/mm = 1000000 N/m"),
    ):
        assert said in printed(capsys, unit), (unit, said)


def test_all_units_and_prefixes_are_listed_in_80_columns(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    lines = printed(capsys).splitlines()
    assert {"with a prefix", "without", "prefixes"} <= set(lines)
    assert max(map(len, lines)) <= 80


def test_units_are_data_too(capsys):
    data = json.loads(printed(capsys, "--json"))
    entry = next(each for each in data["units"] if each["unit"] == "rpm")
    assert (entry["factor"], entry["cycles"], entry["takes_prefix"]) == ("1/60", 1, True)
    assert data["prefixes"]["k"] == "1000"


def test_an_unknown_unit_is_a_wrong_use(capsys):
    assert run(["units", "furlong"]) == 2
    assert "unknown unit 'furlong'" in capsys.readouterr().err


def test_a_shell_completes_commands_and_options(monkeypatch, capsys):
    monkeypatch.setenv("_SYMFLEX_COMPLETE", "bash_complete")
    monkeypatch.setenv("COMP_WORDS", "symflex uni")
    monkeypatch.setenv("COMP_CWORD", "1")
    with pytest.raises(SystemExit):
        group.main(prog_name="symflex")
    assert capsys.readouterr().out == "plain,units\n"
