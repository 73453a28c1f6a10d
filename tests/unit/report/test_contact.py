"""The section of a report about ports: verdict, bands, repair and example, with the real part as a figure."""

import json

import pytest

from symflex.report.chapter import chapter_of
from symflex.report.document import PageFigure, Section, Table
from symflex.report.sections.contact import contact_section
from symflex.report.study import Study
from tests.unit.contact.machines import LAGGED

SLAVE = """
slave = { type = "mass", at = "y", m = "2 kg" }
link = { type = "spring", between = ["x", "y"], k = "30 N/m" }
[inputs]"""


WALL = """symflex = 1
parameters = { m = "1 kg", K = "100 N/m", T = "31.6227766 ms" }
blocks.wall = "K*z^0"
sampled.period = "T"
elements.handle = { type = "mass", at = "x", m = "m" }
elements.motor = { type = "force_source", at = "x", f = "-wall*x" }
inputs.F = { force = "x" }
outputs.X = "x"
"""


def section_of(folder, text):
    path = folder / "machine.toml"
    path.write_text(text, encoding="utf-8")
    return contact_section(Study.of(path, "machine"))


def words(block):
    runs = [] if isinstance(block, PageFigure | Table) else getattr(block, "runs", ())
    return "".join(run if isinstance(run, str) else run.text for run in runs)


def test_an_active_port_has_its_band_its_repair_and_its_example(tmp_path):
    # Re Z = b - K tau/(1 + (omega tau)^2), -0.025 N s/m at 0.
    part = section_of(tmp_path, LAGGED)
    said = " ".join(words(block) for block in part.blocks)
    assert said.startswith("active")
    assert "Real part negative from 0 Hz to 0.503292 Hz." in said
    assert "A damper in parallel: b at least 0.0250000000000 N*s/m" in said
    assert "Mass m = 1.1 kg." in said
    assert part.files["figures/machine_port_tip.pdf"].startswith(b"%PDF")
    (found,) = json.loads(part.files["data/machine_ports.json"])["ports"]
    assert (found["schema"], found["passive"]) == ("symflex.passivity/1", False)
    assert part.code == 0


@pytest.mark.slow
def test_two_ports_are_judged_together_too(tmp_path):
    text = LAGGED.replace("\n[inputs]", SLAVE, 1) + 'load = { at = "y" }\n'
    part = section_of(tmp_path, text)
    assert [block.title for block in part.blocks] == ["Port tip", "Port load", "Ports tip and load"]
    found = json.loads(part.files["data/machine_ports.json"])["ports"]
    assert [each["schema"].split("/")[0] for each in found][2] == "symflex.two_ports"


def test_a_model_without_ports_has_no_such_section(tmp_path):
    assert section_of(tmp_path, LAGGED.split("[ports]")[0]) is None


def test_a_parameter_without_a_value_is_told_in_place_of_the_verdict(tmp_path):
    part = section_of(tmp_path, LAGGED.replace('K = "20.5 N/m"', 'K = { unit = "N/m" }'))
    assert "'K'" in part.blocks[0].text


def test_a_sampled_controller_has_its_poles_in_z_and_nothing_of_a_continuous_one(tmp_path):
    # m s v = -K x, held: z^2 - 2 z + 1 + K T^2/(2 m) (z + 1), with K T^2/(2 m) = 0.05 outside the circle.
    path = tmp_path / "wall.toml"
    path.write_text(WALL, encoding="utf-8")
    chapter = chapter_of(path, "wall")
    assert (chapter.warnings, chapter.code) == ((), 0)
    titles = [block.title for block in chapter.section.blocks if isinstance(block, Section)]
    assert "The sampled loop" in titles
    assert not {"Transfer functions", "Poles and zeros", "Figures"} & {*titles}
    found = json.loads(chapter.files["data/wall_poles.json"])
    assert (found["outside"], found["count"]) == (2, 2)
    (pole,) = found["poles"]
    assert pole["abs"] == pytest.approx(1.05**0.5)
