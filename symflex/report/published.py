"""A report as files in a folder: page, article, its PDF where that can be made, figures, code and data."""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import UTC, date, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from symflex.errors import SymflexError
from symflex.files.write import check_folder
from symflex.report.article import report_article
from symflex.report.folder import write_tree
from symflex.report.page import report_page
from symflex.report.pdf import HOW_TO, compile_pdf, has_compiler
from symflex.report.report import (
    compose,
    find_claims,
    find_measurements,
    find_specifications,
    name_specifications,
    write_chapters,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from symflex.options import ReportOptions
    from symflex.report.report import Report
    from symflex.roots import Progress


@dataclass(frozen=True, slots=True)
class PublishedReport:
    """What was written."""

    page: Path  # the page to open
    pdf: Path | None  # none where none was asked for or made
    problem: str  # why there is no PDF though one was wanted; empty else
    code: int  # exit code of writing alone


def written(
    given: ReportOptions, progress: Progress, said: Callable[[str], None]
) -> tuple[PublishedReport, Report]:
    """Write the report that options ask for.

    With ``jobs`` of 0 all models are computed in this process. ``said`` is told how many models and measured
    responses there are. The warnings of the report name what was left out, too. Raises SpecError, ModelError:
    With every problem of all files that are not solvable models, before anything is computed; UsageError:
    SF902 no specification; SF903 a file cannot be written.
    """
    folder, paths = Path(given.output), [Path(spec) for spec in given.specs]
    check_folder(folder)
    outside = tuple(map(Path, given.allow_outside))
    named = name_specifications(find_specifications(paths, folder, outside))
    publications = find_claims(named.values(), outside)
    measured, left_out = find_measurements(paths, folder, outside)
    data = f", {len(measured)} measured response{'s' if len(measured) > 1 else ''}" if measured else ""
    said(f"{len(named)} model{'s' if len(named) > 1 else ''}{data}")
    chapters = write_chapters(named, given.jobs or 0, progress, measured, outside)
    report = compose(chapters, given.day or "", publications)
    published = publish(report, folder, progress, pdf=given.pdf)
    return published, replace(report, warnings=(*left_out, *report.warnings))


def publish(report: Report, folder: Path, progress: Progress, *, pdf: bool | None = None) -> PublishedReport:
    """Write a report into a folder; what stands there stays, but for files of the same names.

    ``pdf`` says whether one is wanted, by default where pdflatex is there. The article is written in any
    case. Raises UsageError: SF903 when a file cannot be written.
    """
    progress.report(0.9, "writing")
    tex = report_article(report)
    page = folder / "index.html"
    write_tree(folder, {**report.files, "report.tex": tex.encode(), page.name: report_page(report).encode()})
    if pdf is False:
        return PublishedReport(page, None, "", 0)
    if not has_compiler():
        problem = (
            f"no report.pdf: there is no pdflatex on this computer; report.tex is written\n  hint: {HOW_TO}"
        )
        return PublishedReport(page, None, problem, 2 if pdf else 0)
    progress.report(0.92, "pdflatex")
    figures = {name: data for name, data in report.files.items() if name.startswith("figures/")}
    try:
        made = compile_pdf(tex, figures, _epoch(report.date))
    except SymflexError as error:
        return PublishedReport(page, None, str(error), error.exit_code)
    write_tree(folder, {"report.pdf": made})
    return PublishedReport(page, folder / "report.pdf", "", 0)


def _epoch(shown: str) -> int:
    """Return the seconds since 1970 of the day printed, for the file's own metadata."""
    day = date.fromisoformat(shown) if shown else date(1970, 1, 2)
    return int(datetime(day.year, day.month, day.day, tzinfo=UTC).timestamp())
