"""``symflex report`` at the command line."""

import pytest

from symflex.cli import report as report_command
from symflex.errors import Diagnostic, SymflexError


@pytest.fixture(autouse=True)
def _no_tex(monkeypatch):
    monkeypatch.setattr("symflex.report.published.shutil.which", lambda _: None)


def test_a_report_is_written_and_its_page_named_last(shell):
    done = shell("report", "symbolic.toml", "-o", "out", "-j", "1", "--date", "1988-12-31")
    assert done.code == 0
    assert done.out.splitlines()[-1] == "open out/index.html"
    assert "1988-12-31" in (shell.folder / "out" / "index.html").read_text(encoding="utf-8")
    assert {p.name for p in (shell.folder / "out").iterdir()} == {
        "index.html", "report.tex", "code", "data", "figures"
    }  # fmt: skip


def test_without_pdflatex_the_report_says_how_to_get_it(shell):
    done = shell("report", "symbolic.toml", "-j", "1", "--pdf")
    assert done.code == 2
    assert "texlive" in done.err
    assert (shell.folder / "report" / "report.tex").exists()


def test_a_pdf_that_does_not_compile_is_said_and_the_page_is_there(shell, monkeypatch):
    def fail(*_):
        raise SymflexError(Diagnostic("SF912", "pdflatex failed"))

    monkeypatch.setattr("symflex.report.published.has_compiler", lambda: True)
    monkeypatch.setattr("symflex.report.published.compile_pdf", fail)
    done = shell("report", "symbolic.toml", "-j", "1")
    assert done.code == 3
    assert "SF912" in done.err
    assert (shell.folder / "report" / "index.html").exists()


def test_exit_codes(shell):
    for arguments, code in (
        (["nothing.toml"], 2),
        (["wrong.toml"], 3),
        (["floating.toml"], 3),
        ([], 2),
        (["x.toml", "--date", "yesterday"], 2),
        (["x.toml", "--date", "1988-13-31"], 2),
        (["x.toml", "-o", "x.toml"], 2),
        (["x.toml", "-j", "0"], 2),
    ):
        assert shell("report", *arguments, "-j1" if "-j" not in arguments else "--no-pdf").code == code, (
            arguments,
            code,
        )


def test_the_date_may_come_from_the_environment(monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "599529600")  # 1988-12-31, by hand: 6939 days
    assert report_command._date(None) == "1988-12-31"


def test_a_wrong_epoch_is_an_error(shell, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "soon")
    assert shell("report", "x.toml").code == 2


def test_measured_data_given_as_a_specification_are_told_where_to_go(shell):
    for name in ("d1.csv", "D1.UFF"):
        (shell.folder / name).write_text("frequency,re,im\n1,2,3\n")
        done = shell("report", "x.toml", name, "-j", "1")
        assert done.code == 2, name
        assert "error[SF902]" in done.err and name in done.err, name
        assert "measured data" in done.err and "folder" in done.err and "TOML" not in done.err, name
