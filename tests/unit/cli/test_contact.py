"""``symflex contact``, ``passivity`` of two ports and ``plot z-width`` on the command line."""

import json

import pytest

from symflex.cli import run
from tests.unit.contact.machines import LAGGED
from tests.unit.contact.test_coupled import FORCE_LOOP

TWO = """
symflex = 1
parameters = { m = 1, k = 2, b = 3 }
inputs = { F = { force = "x" } }
outputs = { Y = "y" }
[elements]
left   = { type = "mass", at = "x", m = "m" }
right  = { type = "mass", at = "y", m = "m" }
spring = { type = "spring", between = ["x", "y"], k = "k" }
damper = { type = "damper", between = ["y", "ground"], b = "b" }
[analysis]
band = [0.1, 1]
"""


@pytest.fixture
def loop(tmp_path, monkeypatch):
    (tmp_path / "loop.toml").write_text(FORCE_LOOP, encoding="utf-8")
    (tmp_path / "two.toml").write_text(TWO, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_only_port_is_touched(loop, capsys):
    assert run(["contact", "loop.toml", "--environment", "spring", "--up-to", "10 kN/m"]) == 0
    assert "stable for all values" in capsys.readouterr().out


def test_values_of_letters_are_set(loop, capsys):
    arguments = ["contact", "loop.toml", "--environment", "k_e", "--set", "k_e=30 kN/m", "--json"]
    assert run(arguments) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["schema"] == "symflex.contact/1"
    assert document["stable"] is False
    assert document["verdict"]["right_half_plane"] == 2


def test_everything_passive_is_a_question_of_passivity(loop, capsys):
    assert run(["contact", "loop.toml", "--environment", "any", "--set", "K=1.2"]) == 0
    assert "PASSIVE, proved" in capsys.readouterr().out
    assert run(["contact", "loop.toml", "--environment", "any", "--over", "K"]) == 2
    assert "it has no letters" in capsys.readouterr().err


def test_two_ports_are_judged_together(loop, capsys):
    assert run(["passivity", "two.toml", "--port", "x", "--port", "y"]) == 0
    printed = capsys.readouterr().out
    assert "absolutely stable (Llewellyn): yes, proved" in printed
    assert "size of the impedance shown at x" in printed
    assert run(["passivity", "two.toml", "--port", "x", "--port", "x"]) == 2


@pytest.mark.slow
def test_a_z_width_is_drawn_with_an_environment_and_of_passive_values(loop, capsys):
    assert run(["plot", "loop.toml", "z-width", "--over", "K"]) == 2
    assert "over two parameters" in capsys.readouterr().err
    (loop / "wall.toml").write_text(LAGGED, encoding="utf-8")
    over = ["--over", "K", "--over", "tau", "--range", "K", "0", "99", "--range", "tau", "0.01", "0.2"]
    assert run(["plot", "wall.toml", "z-width", *over, "-o", "passive.svg"]) == 0
    assert (loop / "passive.svg").exists()
    over = ["--over", "K", "--over", "k_e", "--range", "K", "0", "12", "--range", "k_e", "0", "1e5"]
    drawn = ["--environment", "spring", "--resolve", "20 %", "-o", "z.svg"]
    assert run(["plot", "loop.toml", "z-width", *over, *drawn]) == 0
    assert (loop / "z.svg").exists()


@pytest.mark.parametrize(
    "arguments",
    [
        ["--environment", "spring", "--range", "m_e", "0", "1"],
        ["--environment", "5", "--range", "0", "1"],
        ["--environment", "5", "--up-to", "1"],
    ],
)
def test_ranges_of_what_has_a_value_or_is_not_there_are_refused(loop, capsys, arguments):
    assert run(["contact", "loop.toml", *arguments]) == 2
    assert "SF902" in capsys.readouterr().err


def test_a_parameter_that_the_wall_leaves_without_effect_is_said(loop, capsys):
    # Nothing moves where x is held, so no pole depends on K.
    (loop / "wall.toml").write_text(LAGGED, encoding="utf-8")
    assert run(["contact", "wall.toml", "--environment", "wall", "--over", "K"]) == 3
    assert "ask without --over K" in capsys.readouterr().err
