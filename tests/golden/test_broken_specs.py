"""Specifications with mistakes, and what an engineer is told about them.

Each ``broken/NAME.toml`` holds one kind of mistake, or several; ``broken/NAME.txt`` holds the exit code and
the whole output of ``symflex check NAME.toml``, judged message by message: does it name what is wrong with
the value found, and say what to do?
"""

import json
import re
from pathlib import Path

import pytest

from symflex.cli import run

BROKEN = Path(__file__).parent / "broken"
NAMES = sorted(path.stem for path in BROKEN.glob("*.toml"))
HEADLINE = re.compile(r"^(?P<place>[\w/]+\.toml:\d+:\d+): error\[SF\d{3}\]: .+$")
PLACE = re.compile(r":(\d+):(\d+)$")


def expected(name):
    return (BROKEN / f"{name}.txt").read_text(encoding="utf-8")


def headlines(name):
    return [line for line in expected(name).splitlines() if "error[SF" in line]


@pytest.mark.parametrize("part", range(3))
def test_a_broken_specification_is_refused_in_the_expected_words(part, monkeypatch, capsys):
    monkeypatch.chdir(BROKEN)
    others = {}
    for name in NAMES[part::3]:
        code = run(["check", f"{name}.toml"])
        printed = capsys.readouterr()
        found = f"exit {code}\n{printed.out}{printed.err}"
        if found != expected(name):
            others[name] = found
    assert others == {name: expected(name) for name in others}


def test_every_message_points_at_a_place_in_a_file():
    assert [line for name in NAMES for line in headlines(name) if not HEADLINE.match(line)] == []


def test_the_problems_of_a_file_are_in_the_order_of_its_text():
    for name in NAMES:
        own = [HEADLINE.match(line)["place"] for line in headlines(name) if line.startswith(f"{name}.toml:")]
        places = [tuple(map(int, PLACE.search(place).groups())) for place in own]
        assert places == sorted(places), name


def test_no_broken_specification_is_accepted():
    assert {name for name in NAMES if expected(name).partition("\n")[0] != "exit 3"} == set()


def test_every_expectation_has_its_specification():
    assert sorted(path.stem for path in BROKEN.glob("*.txt")) == NAMES


def test_syntax_errors_and_meaning_errors_are_reported_together():
    codes = {re.search(r"SF\d", line)[0] for line in headlines("syntax_and_meaning_together")}
    assert codes == {"SF1", "SF2"}


def test_the_same_mistake_is_reported_as_json_with_its_place(monkeypatch, capsys):
    monkeypatch.chdir(BROKEN)
    code = run(["check", "--json", "unknown_unit.toml"])
    (problem,) = json.loads(capsys.readouterr().out)["problems"]
    # m = "2 kgg" stands in line 4; its unit begins in column 8.
    found = (code, problem["code"], problem["file"], problem["line"], problem["column"], problem["hint"])
    assert found == (3, "SF201", "unknown_unit.toml", 4, 8, "did you mean 'kg'?")
