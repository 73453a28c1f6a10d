"""``symflex report``."""

from __future__ import annotations

import os
import re
from datetime import UTC, date, datetime
from pathlib import Path

import click

from symflex.cli.budgeting import budgeted
from symflex.cli.reporting import note, outside, reporting, say
from symflex.errors import Diagnostic, UsageError

EPOCH_VARIABLE = "SOURCE_DATE_EPOCH"


@click.command("report")
@click.argument("specs", nargs=-1, required=True, type=click.Path(), metavar="SPEC...")
@outside
@click.option("-o", "--output", default="report", show_default=True, type=click.Path(), metavar="DIR",
              help="Folder to write; what is in it stays, but for files of the same name.")  # fmt: skip
@click.option(
    "--pdf/--no-pdf", "pdf", default=None, help="With report.pdf; by default where pdflatex is there."
)
@click.option(
    "--date", "day", metavar="YYYY-MM-DD", help="Date printed; today, or SOURCE_DATE_EPOCH. 'none' for none."
)
@click.option(
    "-j",
    "--jobs",
    type=click.IntRange(1, 64),
    help="Models computed at once; as many as there are processors.",
)
@budgeted
@reporting
def command(
    specs: tuple[str, ...],
    *,
    allow_outside: tuple[str, ...],
    output: str,
    pdf: bool | None,
    day: str | None,
    jobs: int | None,
) -> int:
    """Write a report on models: equations, poles and zeros, figures, comparison, code.

    A SPEC that is a folder stands for all specifications in it and below; measured responses (.csv, .uff,
    .mat, .npz) that stand there are drawn with the transfer functions of their names. DIR/index.html is one
    page that opens without a network and holds everything; beside it are report.tex and report.pdf, and the
    folders figures, code and data. What a specification publishes is audited, models are compared, and the
    claims of a publication that is known are judged.

    All specifications are checked before anything is computed: where one is invalid the exit code is 3, and
    nothing is written. A model that cannot be computed afterwards costs its own chapter only, which says why.

    Equal specifications give equal files when the date is fixed. Exit code 4 says that something could not be
    certified, or a figure of [figures] not be drawn, 5 that a budget of time or memory was exceeded: the
    report is written then, and says where.
    """
    from symflex.cli.progress import ProgressBar
    from symflex.report import (
        check_folder,
        compose,
        find_claims,
        find_measurements,
        find_specifications,
        name_specifications,
        publish,
        write_chapters,
    )

    shown = _date(day)
    folder = Path(output)
    check_folder(folder)
    paths = [Path(spec) for spec in specs]
    folders = (*map(Path, allow_outside), *(path for path in paths if path.is_dir()))
    named = name_specifications(find_specifications(paths, folder, folders))
    publications = find_claims(named.values(), folders)
    measured, left_out = find_measurements(paths, folder, folders)
    data = f", {len(measured)} measured response{'s' if len(measured) > 1 else ''}" if measured else ""
    note(f"{len(named)} model{'s' if len(named) > 1 else ''}{data}")
    with ProgressBar() as bar:
        chapters = write_chapters(named, jobs or os.cpu_count() or 1, bar, measured, folders)
        report = compose(chapters, shown, publications)
        published = publish(report, folder, bar, pdf=pdf)
    if published.problem:
        note(published.problem)
    for warning in (*left_out, *report.warnings):
        note(f"warning: {warning}")
    say(f"open {published.page}")
    return max(published.code, report.code)


def _date(given: str | None) -> str:
    """Return the date to print, empty for none."""
    if given == "none":
        return ""
    if given is not None:
        try:
            return (
                date.fromisoformat(given).isoformat()
                if re.fullmatch(r"\d{4}-\d\d-\d\d", given)
                else _refuse(given)
            )
        except ValueError:
            return _refuse(given)
    epoch = os.environ.get(EPOCH_VARIABLE, "")
    if epoch:
        try:
            return datetime.fromtimestamp(int(epoch), UTC).date().isoformat()
        except (ValueError, OverflowError, OSError):
            message = f"{EPOCH_VARIABLE} is '{epoch[:40]}', not a number of seconds since 1970"
            raise UsageError(Diagnostic("SF902", message)) from None
    return datetime.now(UTC).date().isoformat()


def _refuse(given: str) -> str:
    raise UsageError(
        Diagnostic("SF902", f"--date takes a day such as 1988-12-31, or none, found '{given[:40]}'")
    )
