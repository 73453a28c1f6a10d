"""What the pages show is what the program does."""

import doctest
import re

import pytest

import symflex
from symflex.cli import COMMANDS
from tests.docs.reference import FORMULA, PLACE, with_tables
from tests.docs.update import copy_files, printed
from tests.house.repository import ROOT, all_blocks, blocks, pages
from tests.unit.refusals import refusal

SPECIFICATIONS = [block for block in all_blocks("toml") if block.text.startswith("symflex = 1")]
SESSIONS = [block for block in all_blocks("console") if block.text.startswith("$ symflex")]
PYTHON = [block for block in all_blocks("python") if ">>>" in block.text]
WITH_TABLES = [p for p in pages() if any(found.search(p.read_text("utf-8")) for found in (PLACE, FORMULA))]
LONG = (
    "python-api",
    "plane-frame",
    "roots",
    "force-loop",
    "move-without-vibration",
    "measured-machine",
    "stability",
)
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


SAID = {}
"""What commands about the worked models print: some stand on two pages."""


def takes_long(block):
    """Tell whether a session fits every order, sweeps models or proves what beams do in loops or in time."""
    chooses_an_order = "$ symflex fit" in block.text and "BIC" in block.text
    proves = "$ symflex stability eppinger1988" in block.text or block.text.startswith("$ symflex respond")
    proves = proves or ("--over" in block.text and "--up-to" in block.text)
    proves = proves or "audit cantilever_table" in block.text  # which looks for a slip of the model
    is_long_page = block.page.name in ("roots.md", "published-formula.md", "force-loop.md", "flexible-arm.md")
    return chooses_an_order or proves or is_long_page or "$ symflex sweep" in block.text


def by_page(found):
    """Return blocks as one parameter a page."""
    pages_of = {block.page: [b for b in found if b.page == block.page] for block in found}
    return [pytest.param(page, inside, id=page.name) for page, inside in pages_of.items()]


@pytest.fixture
def reader(tmp_path, monkeypatch):
    """The folder of a reader who copied every titled file and example of a page."""

    def copy(page):
        monkeypatch.chdir(tmp_path)
        copy_files(page)
        return tmp_path

    return copy


def said(command):
    """Return what a command prints; one that writes no file and reads worked models prints the same again."""
    if "eppinger1988/" not in command or " -o " in command:
        return printed(command)
    if command not in SAID:
        SAID[command] = printed(command)
    return SAID[command]


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


def test_every_command_has_a_page_with_its_help():
    pages = {page.stem: page.read_text("utf-8") for page in (ROOT / "docs" / "commands").glob("*.md")}
    assert pages.keys() == COMMANDS.keys()
    assert all(f"<!-- reference: command {name} -->" in text for name, text in pages.items())


def test_every_specification_on_a_page_loads_and_one_shown_as_wrong_is_refused():
    for block in SPECIFICATIONS:
        assert (refusal(symflex.loads, block.text) != "") is (block.title == "wrong.toml"), block


def differing(sessions):
    """Return what commands print other than their pages show."""
    found = []
    for block in sessions:
        for session in re.split(r"^\$ ", block.text, flags=re.MULTILINE)[1:]:
            command, _, expected = session.partition("\n")
            now = said(command)
            if not doctest.OutputChecker().check_output(expected, now, doctest.ELLIPSIS):
                found.append(f"{block}: `{command}` prints\n{now}")
    return found


@pytest.mark.parametrize(("page", "sessions"), by_page([b for b in SESSIONS if not takes_long(b)]))
def test_sessions_on_a_page_show_what_the_program_prints(page, sessions, reader):
    reader(page)
    if wrong := differing(sessions):
        pytest.fail("\n".join(wrong), pytrace=False)


@pytest.mark.slow
@pytest.mark.parametrize(("page", "sessions"), by_page([b for b in SESSIONS if takes_long(b)]))
def test_long_sessions_on_a_page_show_what_the_program_prints(page, sessions, reader):
    reader(page)
    if wrong := differing(sessions):
        pytest.fail("\n".join(wrong), pytrace=False)


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(page, marks=[pytest.mark.slow] if page.name.startswith(LONG) else [])
        for page in pages()
        if any(b.page == page for b in PYTHON)
    ],
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


def test_the_readme_shows_what_its_examples_print(reader):
    readme = ROOT / "README.md"
    specification, shown = (b for b in blocks(readme) if b.title or b.language == "text")
    reader(readme)
    assert said(f"symflex derive {specification.title}").strip() == shown.text.strip()
