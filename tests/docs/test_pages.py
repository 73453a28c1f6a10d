"""What the pages show is what the program does."""

from __future__ import annotations

import doctest
import re
import shlex
import shutil

import pytest

import symflex
from symflex.cli import run
from tests.docs.reference import FORMULA, PLACE, with_tables
from tests.house.repository import ROOT, all_blocks, blocks, pages, slow_ones

SPECIFICATIONS = [block for block in all_blocks("toml") if block.text.startswith("symflex = 1")]
SESSIONS = [block for block in all_blocks("console") if block.text.startswith("$ symflex")]
PYTHON = [block for block in all_blocks("python") if ">>>" in block.text]
WITH_TABLES = [p for p in pages() if any(found.search(p.read_text("utf-8")) for found in (PLACE, FORMULA))]
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


def takes_long(block):
    """Tell whether a session fits every order, sweeps models or proves what beams do in loops or in time."""
    chooses_an_order = block.text.startswith("$ symflex fit") and "BIC" in block.text
    proves = block.text.startswith(("$ symflex stability derivations", "$ symflex respond"))
    return chooses_an_order or proves or block.text.startswith("$ symflex sweep")


@pytest.fixture
def reader(tmp_path, monkeypatch):
    """The folder of a reader who copied every titled file of a page."""

    def copy(page):
        for block in blocks(page):
            if block.title:
                (tmp_path / block.title).write_text(block.text, encoding="utf-8")
        shutil.copytree(ROOT / "derivations", tmp_path / "derivations")
        monkeypatch.chdir(tmp_path)
        return tmp_path

    return copy


@pytest.fixture
def symflex_output(capsys):
    """Return a function that runs a command in the reader's folder and returns its stdout and its stderr."""

    def output(arguments):
        capsys.readouterr()
        run(arguments)
        return capsys.readouterr()

    return output


def test_there_is_something_to_check():
    assert SPECIFICATIONS
    assert SESSIONS
    assert PYTHON


@pytest.mark.parametrize(
    "page", [p for p in pages() if PLACE.search(p.read_text("utf-8"))], ids=lambda p: p.name
)
def test_tables_and_formulas_of_a_page_are_those_of_the_program(page, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    text = page.read_text("utf-8")
    assert with_tables(text) == text, "write them anew: python -m tests.docs.update"


@pytest.mark.parametrize("block", [b for b in SPECIFICATIONS if b.title != "wrong.toml"], ids=str)
def test_every_specification_on_a_page_loads(block):
    assert symflex.loads(block.text)


@pytest.mark.parametrize("block", [b for b in SPECIFICATIONS if b.title == "wrong.toml"], ids=str)
def test_a_specification_shown_as_wrong_is_refused(block):
    with pytest.raises(symflex.SymflexError):
        symflex.loads(block.text)


@pytest.mark.parametrize("block", slow_ones(SESSIONS, takes_long), ids=str)
def test_every_session_on_a_page_shows_what_the_program_prints(block, reader, symflex_output):
    reader(block.page)
    for session in re.split(r"^\$ ", block.text, flags=re.MULTILINE)[1:]:
        command, _, expected = session.partition("\n")
        done = symflex_output(shlex.split(command)[1:])
        printed = done.err + done.out  # notes come before results
        if not doctest.OutputChecker().check_output(expected, printed, doctest.ELLIPSIS):
            pytest.fail(f"{block}: `{command}` prints\n{printed}", pytrace=False)


@pytest.mark.parametrize(
    "page",
    slow_ones(
        (page for page in pages() if any(b.page == page for b in PYTHON)),
        lambda page: page.name.startswith("tutorial"),
    ),
    ids=lambda p: p.name,
)
def test_the_python_examples_of_a_page_run_in_order(page, reader):
    reader(page)
    globs = {}
    runner = doctest.DocTestRunner(optionflags=FLAGS)
    for block in PYTHON:
        if block.page == page:
            test = doctest.DocTestParser().get_doctest(block.text, globs, str(block), str(page), block.line)
            report = []
            runner.run(test, out=report.append, clear_globs=False)
            globs = test.globs
            assert not runner.failures, "".join(report)


def test_the_readme_shows_what_its_examples_print(reader, symflex_output):
    readme = ROOT / "README.md"
    found = [b for b in blocks(readme) if b.title or b.language == "text"]
    options = ([], ["--tf", "V_tip/F", "--form", "vaughan"])
    reader(readme)
    for specification, shown, chosen in zip(found[::2], found[1::2], options, strict=True):
        printed = symflex_output(["derive", specification.title, *chosen]).out
        assert printed.strip() == shown.text.strip()
