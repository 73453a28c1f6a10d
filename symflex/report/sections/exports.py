"""Code for other programs, and the data behind the page."""

from __future__ import annotations

import csv
import io
import re
from typing import TYPE_CHECKING, Final

import numpy as np

from symflex.codegen.exporters import EXPORTERS
from symflex.errors import SymflexError
from symflex.report.document import Code, Notice, PageLink, Table, columns, text
from symflex.report.part import ChapterPart, code_of
from symflex.report.study import attempt, said

if TYPE_CHECKING:
    from symflex.analysis.response import SampledResponse
    from symflex.report.document import Block, Cell
    from symflex.report.study import Study

TARGETS: Final = ("numpy", "c")
"""Keys of ``EXPORTERS`` that a report writes."""
HEAD: Final = ("frequency_hz", "re", "im", "magnitude_db", "phase_deg")


def export_section(study: Study) -> ChapterPart:
    """Return the files of a model: numeric code, frequency responses, and the results as JSON."""
    files: dict[str, bytes] = {}
    rows: list[tuple[Cell, ...]] = []
    blocks: list[Block] = []
    warnings: list[str] = []
    code = 0
    for target in TARGETS:
        exporter = EXPORTERS[target]
        made = attempt(lambda e=exporter: e.export(study.model, study.tfs, study.stem, is_alone=False))  # type: ignore[misc]
        if isinstance(made, SymflexError):
            blocks.append(Notice(f"No {target} code: {made.diagnostics[0].message}"))
            code = max(code, code_of(made))
            continue
        name = f"code/{study.stem}{exporter.suffix}"
        files[name] = made.text.encode()
        rows.append(((PageLink(name, name),), (exporter.summary,)))
        for suffix, content in made.companions.items():
            beside = f"code/{study.stem}{suffix}"
            files[beside] = content.encode()
            rows.append(((PageLink(beside, beside),), ("its header",)))
        warnings += [f"{study.stem}, {target}: {warning}" for warning in made.warnings]
        blocks += [Notice(warning) for warning in made.warnings]
    responses = attempt(lambda: study.responses)
    if isinstance(responses, SymflexError):
        blocks.append(Notice(f"No frequency responses: {said(responses)}"))
        code = max(code, code_of(responses))
    else:
        for response, name in zip(responses, _names(study, responses), strict=True):
            files[name] = _csv(response)
            rows.append(
                (
                    (PageLink(name, name),),
                    (f"frequency response of {response.tf}, {len(response.omega)} lines",),
                )
            )
    data = (
        ("derive", "closed forms, as symflex derive --json prints them"),
        ("roots", "poles and zeros with all certified digits"),
        ("facts", "what the comparison is made of"),
    )
    rows += [
        ((PageLink(f"data/{study.stem}_{k}.json", f"data/{study.stem}_{k}.json"),), (what,))
        for k, what in data
    ]
    head = text(
        "The code is verified against ball arithmetic; the worst error stands in its documentation. Reading ",
        Code("symflex export --help"),
        " shows the other targets.",
    )
    table = Table(columns(("File", "plain"), "Content"), tuple(rows))
    return ChapterPart("Code and data", (head, *blocks, table), files, tuple(warnings), code)


def _names(study: Study, responses: tuple[SampledResponse, ...]) -> list[str]:
    """Return a file's name for each, different also where capitals count as small letters."""
    found: list[str] = []
    taken: set[str] = set()
    for response in responses:
        plain = re.sub(r"[^A-Za-z0-9_]", "_", response.tf.replace("/", "_over_"))
        name, number = f"data/{study.stem}_{plain}.csv", 2
        while name.lower() in taken:
            name, number = f"data/{study.stem}_{plain}_{number}.csv", number + 1
        taken.add(name.lower())
        found.append(name)
    return found


def _csv(response: SampledResponse) -> bytes:
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(HEAD)
    columns_ = (
        response.frequency_hz,
        response.values.real,
        response.values.imag,
        response.magnitude_db,
        np.degrees(response.phase),
    )
    writer.writerows([f"{v:.12g}" for v in line] for line in zip(*columns_, strict=True))
    return buffer.getvalue().encode()
