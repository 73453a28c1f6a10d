"""A report as files in a folder, and nowhere else: page, article, its PDF, figures, code and data."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from datetime import UTC, date, datetime
from functools import partial
from pathlib import Path
from typing import Final

from symflex import pipeline
from symflex.budget import Silent
from symflex.errors import Diagnostic, SymflexError, counted
from symflex.files.examples import file_or_example
from symflex.files.write import check_folder, write_tree
from symflex.live.page import live_page
from symflex.options import ReportOptions
from symflex.report.article import report_article
from symflex.report.document import PageLink, Section, text
from symflex.report.page import report_page
from symflex.report.report import (
    Report,
    compose,
    find_claims,
    find_measurements,
    find_specifications,
    name_specifications,
    write_chapters,
)
from symflex.report.study import attempt
from symflex.report.study import said as error_text
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
    """Write the report that options ask for; ``said`` receives the number of models and responses.

    Raises SpecError, ModelError with every problem of all files before anything is computed; UsageError.
    """
    folder, paths = Path(given.output), [file_or_example(spec) for spec in given.specs]
    check_folder(folder)
    outside = tuple(map(Path, given.allow_outside))
    named = name_specifications(find_specifications(paths, folder, outside))
    publications = find_claims(named.values(), outside)
    measured, left_out = find_measurements(paths, folder, outside)
    data = f", {counted(len(measured), 'measured response')}" if measured else ""
    said(f"{counted(len(named), 'model')}{data}")
    chapters = write_chapters(named, given.jobs or 0, progress, measured, outside)
    report = compose(chapters, given.day or "", publications)
    if given.live:
        report = with_live_pages(report, named, outside)
    published = publish(report, folder, progress, pdf=given.pdf)
    return published, replace(report, warnings=(*left_out, *report.warnings))


def with_live_pages(report: Report, named: Mapping[str, Path], allow_outside: tuple[Path, ...]) -> Report:
    """Return a report with a page with sliders for each model, and links to them at its beginning."""
    pages: dict[str, bytes] = {}
    missing: list[str] = []
    for stem, path in named.items():
        model = pipeline.load(path, allow_outside)
        made = attempt(partial(live_page, [(model, model.transfer_functions)], Silent()))
        if isinstance(made, SymflexError):
            missing.append(f"{stem} has no page with sliders: {error_text(made)}")
        else:
            pages[f"live/{stem}.html"] = made.encode()
    links = tuple(text(PageLink(name, name)) for name in pages)
    section = Section("Pages with sliders", links, "live-pages")
    return replace(
        report,
        sections=(report.sections[0], section, *report.sections[1:]),
        files={**report.files, **pages},
        warnings=(*report.warnings, *missing),
    )


def publish(report: Report, folder: Path, progress: Progress, *, pdf: bool | None = None) -> PublishedReport:
    """Write a report into a folder; ``pdf`` says if one is wanted, by default where pdflatex is there."""
    progress.report(0.9, "writing")
    tex = report_article(report)
    page = folder / "index.html"
    write_tree(folder, {**report.files, "report.tex": tex.encode(), page.name: report_page(report).encode()})
    if pdf is False:
        return PublishedReport(page, None, "", 0)
    if not has_compiler():
        problem = "no report.pdf: there is no pdflatex on this computer; report.tex is written"
        return PublishedReport(page, None, f"{problem}\n  hint: {HOW_TO}", 2 if pdf else 0)
    progress.report(0.92, "pdflatex")
    figures = {name: data for name, data in report.files.items() if name.startswith("figures/")}
    try:
        # The day printed is that of the file's own metadata.
        day = date.fromisoformat(report.date or "1970-01-02")
        midnight = datetime(day.year, day.month, day.day, tzinfo=UTC)
        made = compile_pdf(tex, figures, int(midnight.timestamp()))
    except SymflexError as error:
        return PublishedReport(page, None, str(error), error.exit_code)
    write_tree(folder, {"report.pdf": made})
    return PublishedReport(page, folder / "report.pdf", "", 0)


COMPILER: Final = "pdflatex"
RUNS: Final = 3
SECONDS: Final = 300
HOW_TO: Final = (
    "pdflatex comes with TeX Live and MiKTeX (Debian: apt install texlive-latex-extra texlive-science; "
    "macOS: brew install --cask mactex); then: pdflatex report.tex, three times"
)
_LAST_LINES: Final = 12
BY_HAND: Final = "report.tex is written: compile it by hand, or ask for --no-pdf"


def has_compiler() -> bool:
    """Tell whether the computer has pdflatex."""
    return shutil.which(COMPILER) is not None


def compile_pdf(tex: str, figures: Mapping[str, bytes], epoch: int | None) -> bytes:
    """Return a LaTeX document as PDF, its ``figures`` beside it; SF912 when it does not compile.

    Commands that would run programs are refused, and files outside its folder are neither read nor written.
    """
    environment = {**os.environ, "openout_any": "p", "openin_any": "p", "TEXMFOUTPUT": ""}
    if epoch is not None:
        environment |= {"SOURCE_DATE_EPOCH": str(epoch), "FORCE_SOURCE_DATE": "1"}
    with tempfile.TemporaryDirectory(prefix="symflex-report-") as name:
        folder = Path(name)
        (folder / "report.tex").write_text(tex, encoding="ascii")
        for path, content in figures.items():
            target = folder / path
            target.parent.mkdir(exist_ok=True)
            target.write_bytes(content)
        command = [COMPILER, "-no-shell-escape", "-interaction=nonstopmode", "-halt-on-error", "report.tex"]
        for _ in range(RUNS):
            try:
                done = subprocess.run(
                    command, cwd=folder, env=environment, capture_output=True, check=False, timeout=SECONDS
                )
            except (OSError, subprocess.TimeoutExpired) as error:
                message = f"pdflatex did not finish: {error}"
                raise SymflexError(Diagnostic("SF912", message, None, BY_HAND)) from None
            if done.returncode:
                log = done.stdout.decode(errors="replace").splitlines()[-_LAST_LINES:]
                message = "pdflatex failed: " + " / ".join(log)
                raise SymflexError(Diagnostic("SF912", message, None, BY_HAND))
        return (folder / "report.pdf").read_bytes()
