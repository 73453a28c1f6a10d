"""``symflex report``."""

from __future__ import annotations

import os
import re
from contextlib import suppress
from dataclasses import replace
from datetime import UTC, date, datetime
from pathlib import Path

from symflex.cli.command import bare_command
from symflex.cli.reporting import note, say
from symflex.errors import Diagnostic, UsageError
from symflex.options import ReportOptions

EPOCH_VARIABLE = "SOURCE_DATE_EPOCH"


@bare_command("report", ReportOptions)
def report(given: ReportOptions) -> int:
    """Write a report on models: equations, poles and zeros, figures, comparison, code.

    A SPEC that is a folder stands for all specifications in it and below; measured responses (.csv, .uff,
    .mat, .npz) that stand there are drawn with the transfer functions of their names. DIR/index.html is one
    page that opens without a network and holds everything; beside it are report.tex and report.pdf, and the
    folders figures, code and data. What a specification publishes is audited, models are compared, and the
    claims of a publication that is known are judged. Where no file has the name, the example of that name is
    taken: 'symflex report eppinger1988' needs no file, and 'symflex examples' lists the names.

    All specifications are checked before anything is computed: where one is invalid the exit code is 3, and
    nothing is written. A model that cannot be computed afterwards costs its own chapter only, which says why.

    Equal specifications give equal files when the date is fixed. Exit code 4 says that something could not be
    certified, or a figure of [figures] not be drawn, 5 that a budget of time or memory was exceeded: the
    report is written then, and says where.
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


def _date(given: str | None) -> str:
    """Return the date to print, empty for none."""
    if given == "none":
        return ""
    if given is not None:
        with suppress(ValueError):
            if re.fullmatch(r"\d{4}-\d\d-\d\d", given):
                return date.fromisoformat(given).isoformat()
        message = f"--date takes a day such as 1988-12-31, or none, found '{given[:40]}'"
        raise UsageError(Diagnostic("SF902", message))
    epoch = os.environ.get(EPOCH_VARIABLE, "")
    if epoch:
        try:
            return datetime.fromtimestamp(int(epoch), UTC).date().isoformat()
        except (ValueError, OverflowError, OSError):
            message = f"{EPOCH_VARIABLE} is '{epoch[:40]}', not a number of seconds since 1970"
            raise UsageError(Diagnostic("SF902", message)) from None
    return datetime.now(UTC).date().isoformat()
