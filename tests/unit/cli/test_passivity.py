"""``symflex passivity``: what it prints, draws and returns."""

import json

import pytest

from symflex.cli import run
from tests.unit.contact.machines import LAGGED


@pytest.fixture
def wall(tmp_path, monkeypatch):
    (tmp_path / "wall.toml").write_text(LAGGED, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_it_prints_the_verdict_with_an_example(wall, capsys):
    assert run(["passivity", "wall.toml", "--port", "tip"]) == 0
    printed = capsys.readouterr().out
    assert "ACTIVE, proved" in printed
    assert "mass m = 1.1 kg" in printed


def test_json_and_the_figure_are_written(wall, capsys):
    assert run(["passivity", "wall.toml", "--json", "-o", "wall.svg"]) == 0
    assert json.loads(capsys.readouterr().out)["passive"] is False
    assert (wall / "wall.svg").exists()


def test_the_figure_is_drawn_by_plot(wall):
    assert run(["plot", "wall.toml", "passivity", "--port", "x", "-o", "plot.svg"]) == 0
    assert (wall / "plot.svg").exists()


def test_an_unknown_port_is_refused_with_the_nearest(wall, capsys):
    assert run(["passivity", "wall.toml", "--port", "tp"]) == 2
    assert "did you mean 'tip'?" in capsys.readouterr().err


def test_ports_are_listed_where_none_is_near(wall, capsys):
    assert run(["passivity", "wall.toml", "--port", "gripper"]) == 2
    assert "ports: tip; nodes: x" in capsys.readouterr().err


@pytest.mark.parametrize("ends", [["0", "10"], ["K", "0", "10"]])
def test_a_range_of_what_is_not_asked_for_is_refused(wall, capsys, ends):
    assert run(["passivity", "wall.toml", "--range", *ends]) == 2
    assert "--over" in capsys.readouterr().err


@pytest.mark.parametrize("other", [["--over", "K"], ["--port", "tip", "--port", "x"]])
def test_letters_go_with_one_port_and_no_over(wall, capsys, other):
    assert run(["passivity", "wall.toml", "--symbolic", *other]) == 2
    assert "SF902" in capsys.readouterr().err
