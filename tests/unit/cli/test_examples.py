"""``symflex examples``, and reports on examples by name."""

import shutil
from pathlib import Path

import pytest

from symflex import pipeline
from symflex.files import examples as files
from symflex.files.examples import FOLDERS, examples
from tests.house.repository import specifications
from tests.unit.cli.commands import WORKED

MODELS = {name: path for name, path in examples().items() if name not in FOLDERS}


def copied(shell):
    return {p.relative_to(shell.folder).as_posix() for p in shell.folder.rglob("*") if p.is_file()}


def test_every_worked_model_is_an_example_with_a_name_of_its_own():
    assert sorted(MODELS.values()) == specifications(WORKED, "**/*.toml")
    assert len({path.stem for path in MODELS.values()} | {"eppinger1988", "loops"}) == len(MODELS) + 2


def test_the_list_has_every_example_with_its_whole_title_in_80_columns(shell):
    done = shell("examples")
    lines = done.out.splitlines()
    assert (done.code, max(map(len, lines)) <= 80) == (0, True)
    for tip in ("endpoint force loop", "joint position loop"):
        assert f"Two masses joined by a flexible transmission: {tip}" in " ".join(done.out.split())
    assert [line.split()[0] for line in lines if not line.startswith(16 * " ")] == [
        name if name in FOLDERS else name.rpartition("/")[2] for name in examples()
    ]
    assert "  quarter_car              Quarter car on an uneven road" in lines


def test_json_lists_what_can_be_loaded(shell):
    document = shell("examples", "--json").json
    assert document["schema"] == "symflex.examples/1"
    (car,) = (e for e in document["examples"] if e["name"] == "classics/quarter_car")
    assert (car["kind"], car["title"]) == ("model", "Quarter car on an uneven road")
    assert pipeline.load(car["path"]).title == car["title"]
    assert {e["name"] for e in document["examples"] if e["kind"] == "folder"} == set(FOLDERS)


def test_a_folder_is_copied_with_all_that_is_in_it(shell):
    before = copied(shell)
    done = shell("examples", "copy", "eppinger1988")
    assert (done.code, done.out) == (0, "")
    assert done.err == "wrote eppinger1988, 23 files; try: symflex report eppinger1988\n"
    original = WORKED / "eppinger1988"
    wanted = {p.relative_to(WORKED).as_posix(): p for p in original.rglob("*") if p.is_file()}
    assert copied(shell) - before == set(wanted)
    assert all((shell.folder / name).read_bytes() == p.read_bytes() for name, p in wanted.items())


@pytest.mark.slow
def test_every_model_is_copied_with_what_it_needs(shell):
    for name, path in MODELS.items():
        folder = Path("copies", path.stem)
        assert shell("examples", "copy", name, folder).code == 0, name
        assert pipeline.load(folder / path.name).title == pipeline.load(path).title, name
    nested = {p.name for p in (shell.folder / "copies" / "polynomial_resonance").rglob("*") if p.is_file()}
    assert nested == {"polynomial_resonance.toml", "rigid_body.toml", "synthetic_figure_3.csv"}


def test_two_examples_share_a_file_they_both_need(shell):
    for name in ("fitted_resonances", "polynomial_resonance"):
        done = shell("examples", "copy", name)
        assert (done.code, "rigid_body.toml" in done.err) == (0, True), name


def test_an_existing_file_is_not_overwritten_and_nothing_else_is_written(shell):
    (shell.folder / "rigid_body.toml").write_text("mine")
    before = copied(shell)
    done = shell("examples", "copy", "polynomial_resonance")
    assert (done.code, "SF903" in done.err, "FOLDER" in done.err) == (2, True, True)
    assert (copied(shell), (shell.folder / "rigid_body.toml").read_text()) == (before, "mine")


@pytest.mark.parametrize(
    "name",
    ["../derivations", "/etc/passwd", str(WORKED), ".", "", "a\0b", "eppinger1988/../frames", "x" * 999],
)
def test_a_name_that_leads_elsewhere_is_no_example(shell, name):
    before = copied(shell)
    done = shell("examples", "copy", name)
    assert (done.code, "SF902" in done.err, "hint: " in done.err) == (2, True, True)
    assert copied(shell) == before


def test_a_name_that_is_nearly_one_has_a_hint(shell):
    assert "did you mean 'two_mass'?" in shell("examples", "copy", "two_mas").err
    assert "symflex examples copy NAME" in shell("examples", "two_mass").err
    done = shell("report", "eppinger1989")
    assert (done.code, "SF901" in done.err, "did you mean 'eppinger1988'?" in done.err) == (2, True, True)


def test_a_file_in_place_of_the_folder_is_a_usage_error(shell):
    done = shell("examples", "copy", "two_mass", "x.toml")
    assert (done.code, "SF903" in done.err) == (2, True)


def test_an_example_that_somebody_broke_is_an_error_with_its_place(shell, monkeypatch):
    broken = shell.folder / "derivations" / "frames" / "broken.toml"
    broken.parent.mkdir(parents=True)
    broken.write_text("symflex = \n")
    monkeypatch.setattr(files, "_PACKAGE", shell.folder)
    done = shell("examples", "copy", "broken", "there")
    assert (done.code, f"{broken}:1:" in done.err) == (3, True)


@pytest.mark.slow
def test_a_report_takes_the_name_of_an_example_where_no_such_file_exists(shell):
    done = shell("report", "rod_tip_mass", "-o", "out", "-j", "1", "--no-pdf", "--date", "none")
    assert (done.code, done.out) == (0, "open out/index.html\n")
    assert "Axial rod held at one end" in (shell.folder / "out" / "index.html").read_text(encoding="utf-8")


def test_a_folder_of_ones_own_comes_before_the_example_of_its_name(shell):
    (shell.folder / "frames").mkdir()
    shutil.copy(shell.folder / "wrong.toml", shell.folder / "frames")
    done = shell("report", "frames", "-j", "1")
    assert (done.code, "frames/wrong.toml" in done.err) == (3, True)
