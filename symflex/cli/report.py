"""Documents about models: ``report`` and ``referee``."""

from __future__ import annotations

import os
import re
from contextlib import suppress
from dataclasses import replace
from datetime import UTC, date, datetime
from pathlib import Path

from symflex.cli.command import bare_command
from symflex.cli.reporting import answer, note, say, write
from symflex.errors import refused
from symflex.options import RefereeOptions, ReportOptions

EPOCH_VARIABLE = "SOURCE_DATE_EPOCH"


@bare_command("report", ReportOptions)
def report(given: ReportOptions) -> int:
    """Write a report on models: equations, poles, zeros, figures, comparison, code.

    A SPEC that is a folder stands for all models in it and its subfolders. Measured responses there (.csv,
    .uff, .mat, .npz) are drawn with the transfer functions of the same name. DIR/index.html is one page with
    everything, which opens without a network. Next to it are report.tex, report.pdf and the folders figures,
    code and data. The report audits published formulas, compares the models, and judges the claims of a
    publication that it knows. If there is no such file, symflex takes the example of that name: 'symflex
    report eppinger1988' needs no file, and 'symflex examples' lists the names.

    All specifications are checked first: if one is invalid, the exit code is 3 and nothing is written. If a
    model cannot be computed later, only its own chapter is missing, and the report gives the reason.

    With a fixed date, identical specifications give identical files. Exit code 4: something could not be
    certified, or a figure of [figures] could not be drawn. Exit code 5: a budget of time or memory was
    exceeded. In both cases the report is written and shows where.
    """
    from symflex.cli.progress import ProgressBar
    from symflex.report.published import written

    # What stands in a folder that is reported on may be read by the models there.
    folders = (*given.allow_outside, *(spec for spec in given.specs if Path(spec).is_dir()))
    asked = replace(
        given, allow_outside=folders, day=_date(given.day), jobs=given.jobs or os.cpu_count() or 1
    )
    with ProgressBar() as bar:
        published, report = written(asked, bar, note)
    if published.problem:
        note(published.problem)
    for warning in report.warnings:
        note(f"warning: {warning}")
    say(f"open {published.page}")
    return max(published.code, report.code)


@bare_command("referee", RefereeOptions)
def referee(given: RefereeOptions) -> int:
    """Judge the displayed formulas and the tables of a paper by models.

    PAPER.tex is read as it stands, with the macros it defines and the files beside it that it reads. Each
    displayed formula is proved right, right but for a factor, or different, with the term that is wrong;
    others are listed with the reason why they were not judged. Numbers in a tabular that are near the poles
    of a model are judged one by one. [notation] of a SPEC says what the symbols of
    the paper are called there. A difference is a result, so the exit code is 0; with --strict it is 4.
    """
    from symflex import pipeline
    from symflex.papers.source import read_paper
    from symflex.report import referee as court
    from symflex.report.page import report_page

    models = [pipeline.load(path, tuple(map(Path, given.allow_outside))) for path in given.models]
    paper = read_paper(Path(given.paper))
    for problem in paper.notes:
        note(problem.render())
    judged, tables = court.referee(paper, models), court.referee_tables(paper, models)
    answer(
        given.as_json,
        lambda: court.referee_document(given.paper, judged, tables),
        lambda: court.referee_text(judged, tables),
    )
    if given.output is not None:
        write(given.output, report_page(court.referee_page(Path(given.paper).name, judged, tables)))
    if given.errata is not None:
        write(given.errata, court.errata_latex(judged))
    is_right = bool(judged or tables) and all(j.verdict == "equal" for j in judged)
    is_right = is_right and all(t.audit is None or t.audit.is_right for t in tables)
    return 4 if given.strict and not is_right else 0


def _date(given: str | None) -> str:
    """Return the date to print, empty for none."""
    if given == "none":
        return ""
    if given is not None:
        with suppress(ValueError):
            if re.fullmatch(r"\d{4}-\d\d-\d\d", given):
                return date.fromisoformat(given).isoformat()
        raise refused(f"--date takes a day such as 1988-12-31, or none, found '{given[:40]}'")
    epoch = os.environ.get(EPOCH_VARIABLE, "")
    if epoch:
        try:
            return datetime.fromtimestamp(int(epoch), UTC).date().isoformat()
        except (ValueError, OverflowError, OSError):
            raise refused(f"{EPOCH_VARIABLE} is '{epoch[:40]}', not a number of seconds since 1970") from None
    return datetime.now(UTC).date().isoformat()
