"""What a report does about models that cannot be computed."""

import os
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool

import pytest

from symflex.budget import Silent
from symflex.errors import BudgetError, Diagnostic, SpecError
from symflex.report import report as report_module
from symflex.report.article import report_article
from symflex.report.chapter import chapter_of
from symflex.report.page import report_page
from symflex.report.report import compose, name_specifications, write_chapters
from symflex.report.study import Study, attempt
from tests.unit.report.models import SMALL, SYMBOLIC

WRONG_UNIT = SMALL.replace('"24 N/m"', '"24 N"')
WRONG_NAME = SMALL.replace('m = "m_2"', 'm = "m_3"')
WRONG_PRINT = SMALL + '[published."X/F"]\nexpr = "1/(m_1*s^2 + kk)"\n'


def named(folder, **texts):
    for name, text in texts.items():
        (folder / f"{name}.toml").write_text(text, encoding="utf-8")
    return name_specifications([folder / f"{name}.toml" for name in texts])


@pytest.fixture
def models(tmp_path):
    return named(tmp_path, small=SMALL, symbolic=SYMBOLIC)


@pytest.fixture
def too_large(monkeypatch):
    """The model ``small`` exceeds a budget as soon as it is opened."""
    read = Study.of

    def fail(path, stem, measured=(), allow_outside=()):
        if stem == "small":
            raise BudgetError(Diagnostic("SF501", "far too large"))
        return read(path, stem, measured, allow_outside)

    monkeypatch.setattr(Study, "of", fail)


def test_problems_of_all_files_are_told_before_anything_is_computed(tmp_path, monkeypatch):
    monkeypatch.setattr(report_module, "chapter_of", None)
    files = named(tmp_path, small=SMALL, unit=WRONG_UNIT, name=WRONG_NAME, printed=WRONG_PRINT)
    with pytest.raises(SpecError) as caught:
        write_chapters(files, 0, Silent())
    assert [d.span.source.name.rpartition("/")[2] for d in caught.value.diagnostics] == [
        "unit.toml", "name.toml", "printed.toml"
    ]  # fmt: skip


@pytest.mark.slow
def test_a_model_that_exceeds_a_budget_costs_its_own_chapter_only_and_the_report_says_why(models, too_large):
    small, symbolic = write_chapters(models, 0, Silent())
    assert (small.failure, small.code) == ("far too large", 5)
    assert (symbolic.failure, symbolic.code) == ("", 0)
    report = compose([small, symbolic], "")
    assert "Not computed: far too large." in report_page(report)
    assert "Not computed: far too large." in report_article(report)
    assert report.warnings[0] == "small is not computed: far too large"
    assert report.code == 5
    assert small.section.title == "Two masses"


def ended(error):
    future = Future()
    future.set_exception(error)
    return future


def test_a_fault_of_the_program_costs_one_chapter_and_is_named(models):
    chapter = report_module._outcome(ended(OverflowError("too\x1b large")), models["small"], "small")
    assert "OverflowError: too\\x1b large" in chapter.failure
    assert chapter.code == 4


def test_what_ended_a_chapter_decides_what_becomes_of_it(models):
    assert report_module._outcome(ended(MemoryError()), models["small"], "small").code == 5
    # A process that ended gives no chapter yet.
    assert report_module._outcome(ended(BrokenProcessPool()), models["small"], "small") is None
    with pytest.raises(KeyboardInterrupt):
        report_module._outcome(ended(KeyboardInterrupt()), models["small"], "small")


def chapter_or_end(path, stem, measured, *limits):
    """End the process that computes the model ``fatal``, as a lack of memory would."""
    if stem == "fatal":
        os._exit(9)
    return chapter_of(path, stem, measured)


@pytest.mark.slow
def test_a_model_that_ends_its_process_costs_its_own_chapter_only(tmp_path, monkeypatch):
    monkeypatch.setattr(report_module, "_chapter_in", chapter_or_end)
    files = named(tmp_path, fatal=SMALL, symbolic=SYMBOLIC)
    fatal, symbolic = write_chapters(files, 2, Silent())
    assert "its process ended" in fatal.failure
    assert fatal.code == 5
    assert symbolic.failure == ""


class Log:
    """Keeps what is told."""

    def __init__(self):
        self.lines = []

    def report(self, done, text):
        self.lines.append(text)


def test_models_left_by_a_process_that_ended_are_tried_again_alone(models, monkeypatch):
    tried = []

    def some(files, processes, progress, measured, allow_outside):
        tried.append(tuple(files))
        return {s: chapter_of(p, s) for s, p in files.items() if s == "symbolic" and len(files) == 1}

    monkeypatch.setattr(report_module, "_in_processes", some)
    chapters = write_chapters(models, 2, Silent())
    assert tried == [("small", "symbolic"), ("small",), ("symbolic",)]
    assert [bool(c.failure) for c in chapters] == [True, False]


def test_sections_of_a_single_model_are_told_as_they_begin(tmp_path):
    log = Log()
    write_chapters(named(tmp_path, symbolic=SYMBOLIC), 0, log)
    assert "symbolic: roots" in log.lines


@pytest.mark.slow
def test_a_figure_that_is_asked_for_and_fails_is_told_by_the_exit_code(tmp_path):
    figure = '[figures.nothing]\nkind = "bode"\nof = ["Y/u"]\n'
    text = SMALL.replace("F = {", "u = {}, F = {") + figure
    report = compose(write_chapters(named(tmp_path, small=text), 0, Silent()), "")
    assert "small, figure nothing: all its functions are zero: there is nothing to draw" in report.warnings
    assert report.code == 4


def test_exhausted_memory_is_a_budget():
    def exhaust():
        raise MemoryError

    assert attempt(exhaust).exit_code == 5
