"""Figures that are asked for, measured responses with the model over them, code, and the data of a page."""

from __future__ import annotations

import csv
import io
import re
from functools import partial
from typing import Final

import numpy as np

from symflex import pipeline
from symflex.analysis.response import SampledResponse
from symflex.codegen.exporters import EXPORTERS
from symflex.codegen.latex import LOOP_TITLES
from symflex.drawing import draw_model
from symflex.errors import Diagnostic, SymflexError, UncertifiedError
from symflex.figures import FIGURES, LOOP_FIGURES, AxisLimits, draw, draw_measured, draw_over
from symflex.files.write import free_name
from symflex.model import Figure
from symflex.options import PlotOptions
from symflex.report.document import (
    Block,
    Cell,
    ChapterPart,
    Code,
    Notice,
    PageFigure,
    PageLink,
    Table,
    code_of,
    columns,
    picture,
    text,
)
from symflex.report.study import Study, attempt, said
from symflex.transfer import AnyBoundFunction

MOST_CURVES: Final = 4
WORDS: Final = {
    "bode": "Bode plot",
    "poles_zeros": "Poles and zeros",
    "modes": "Mode shapes",
    "deflection": "Deflection shapes",
    "step": "Step response",
    "impulse": "Impulse response",
}


def drawing_section(study: Study) -> ChapterPart:
    """Return the model as a picture of itself."""
    files: dict[str, bytes] = {}
    drawn = picture(f"{study.stem}_drawing", draw_model(study.model), "The model.", files)
    return ChapterPart("", (drawn,), files)


def figure_section(study: Study) -> ChapterPart | None:
    """Return every figure, as SVG for the page and as PDF and SVG for papers."""
    by_pair = {(b.source.output.name, b.source.input.name): b for b in study.bounds}
    drawable = {pair: b for pair, b in by_pair.items() if not b.is_zero}
    blocks: list[Block] = []
    warnings: list[str] = []
    files: dict[str, bytes] = {}
    code = 0
    asked, pairs = study.model.figures, tuple(drawable)[:MOST_CURVES]
    usual = (Figure("bode", "bode", pairs), Figure("poles_zeros", "poles_zeros", pairs)) if pairs else ()
    for figure in (*(asked or usual), *_steps(study, drawable)):
        chosen = [drawable[pair] for pair in figure.of or tuple(drawable) if pair in drawable]
        drawn: PageFigure | SymflexError
        is_loop = (bool(figure.gain) and figure.kind in LOOP_FIGURES) or bool(figure.over)
        if not is_loop and figure.kind not in FIGURES:
            drawn = SymflexError(Diagnostic("SF902", f"a figure of kind '{figure.kind}' names a gain"))
        elif is_loop or chosen:
            drawn = attempt(lambda f=figure, c=chosen: _picture(study, f, c, files))  # type: ignore[misc]
        else:
            drawn = SymflexError(Diagnostic("SF402", "all its functions are zero: there is nothing to draw"))
        if isinstance(drawn, SymflexError):
            why = f"{figure.name}: {drawn.diagnostics[0].message}"
            blocks.append(Notice(why))
            warnings.append(f"{study.stem}, figure {why}")
            # What the specification asks for is missing. Nobody asked for the figures by default.
            if figure in asked:
                code = max(code, code_of(drawn), UncertifiedError.exit_code)
            elif figure.kind != "step":
                code = max(code, code_of(drawn))
        else:
            blocks.append(drawn)
    return ChapterPart("Figures", tuple(blocks), files, tuple(warnings), code) if blocks else None


def _steps(study: Study, drawable: dict[tuple[str, str], AnyBoundFunction]) -> tuple[Figure, ...]:
    """Return the step of a closed loop that is proved stable, of a reference, unless one is asked for."""
    model = study.model
    if not model.is_closed_loop or any(figure.kind in ("step", "impulse") for figure in model.figures):
        return ()
    references = {x.name for x in model.inputs if x.kind == "signal"}
    stable = {located.tf for located in study.maps if located.verdict.word == "stable"}
    pairs = [pair for pair in drawable if pair[1] in references and "/".join(pair) in stable]
    # Curves of one input and one quantity share an axis.
    ends = {pair: (drawable[pair].source.input.name, drawable[pair].source.output.unit) for pair in pairs}
    first = [pair for pair in pairs if ends[pair] == ends[pairs[0]]]
    return (Figure("step", "step", tuple(first[:MOST_CURVES])),) if first else ()


def _picture(
    study: Study, figure: Figure, chosen: list[AnyBoundFunction], files: dict[str, bytes]
) -> PageFigure:
    """Draw functions, measured data with one of them, or the loop of a gain."""
    if figure.kind == "modes":
        chosen = chosen[:1]  # all functions of a model have the same modes
    data = study.comparisons if figure.has_data and chosen else ()
    beside = next((c for c in data if c.measured.name == chosen[0].name), None)
    if figure.gain and figure.kind in LOOP_FIGURES:
        drawn = draw(figure.kind, study.loop(figure.gain), limits=figure.limits, band_hz=figure.band)
        caption = f"{LOOP_TITLES[figure.kind]}, gain {figure.gain}."
    elif figure.over:
        asked = PlotOptions(figure.kind, over=figure.over)
        drawn = draw_over(pipeline.stability(study.model, asked.stability), asked)
        caption = f"Stability over {' and '.join(figure.over)}."
    elif beside is not None:
        drawn = draw_measured(beside.measured, beside.model, beside.unit)
        kind = (
            "SYNTHETIC data, computed and not measured" if beside.measured.is_synthetic else "measured data"
        )
        caption = f"{beside.measured.name} over {kind}, {beside.measured.values.size} lines."
    else:
        frame = AxisLimits(x=(0.0, float(figure.until)) if figure.until else None, at=figure.at)
        drawn = draw(figure.kind, chosen, band_hz=figure.band, frame=frame)
        caption = f"{WORDS.get(figure.kind, figure.kind)} of {', '.join(b.name for b in chosen)}."
    title = f"{figure.title}. " if figure.title else ""
    return picture(f"{study.stem}_{figure.name}", drawn, title + caption, files)


def data_section(study: Study) -> ChapterPart | None:
    """Return every measured response that a transfer function of the model is named like."""
    blocks: list[Block] = []
    files: dict[str, bytes] = {}
    shown = {"/".join(pair) for figure in study.model.figures if figure.has_data for pair in figure.of}
    for i, comparison in enumerate(study.comparisons):
        measured = comparison.measured
        if measured.name not in shown:
            drawn = draw_measured(measured, comparison.model, comparison.unit)
            kind = "SYNTHETIC data, computed and not measured," if measured.is_synthetic else "measured data"
            caption = f"{measured.name}: the model over {kind} of {measured.values.size} lines."
            blocks.append(picture(f"{study.stem}_data_{i + 1}", drawn, caption, files))
        band = f"{measured.frequency_hz[0]:.4g} to {measured.frequency_hz[-1]:.4g} Hz"
        whose = "the synthetic" if measured.is_synthetic else "the measured"
        misfit = f"{comparison.decibels:.3g} dB and {comparison.degrees:.3g} degrees rms"
        ending = f" differs from {whose} data by {misfit}, with equal weight for every line."
        blocks.append(text("From ", band, ", ", Code(measured.name), ending))
    return ChapterPart("Data", tuple(blocks), files) if blocks else None


TARGETS: Final = ("numpy", "c")  # keys of EXPORTERS that a report writes
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
        tfs = study.exported if exporter.solves else study.tfs
        made = attempt(partial(exporter.export, study.model, tfs, study.stem, is_alone=False))
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
        blocks += [Notice(said) for said in (*made.notes, *made.warnings)]
    responses = attempt(lambda: study.responses)
    if isinstance(responses, SymflexError):
        blocks.append(Notice(f"No frequency responses: {said(responses)}"))
        code = max(code, code_of(responses))
    else:
        for response, name in zip(responses, _names(study, responses), strict=True):
            files[name] = _csv(response)
            what = f"frequency response of {response.tf}, {len(response.omega)} lines"
            rows.append(((PageLink(name, name),), (what,)))
    for key, what in (
        ("derive", "closed forms, as symflex derive --json prints them"),
        ("roots", "poles and zeros with all certified digits"),
        ("facts", "facts that the comparison uses"),
    ):
        name = f"data/{study.stem}_{key}.json"
        rows.append(((PageLink(name, name),), (what,)))
    head = text(
        "The code is verified against ball arithmetic; its documentation states the worst error. ",
        Code("symflex export --help"),
        " lists the other targets.",
    )
    table = Table(columns(("File", "plain"), "Content"), tuple(rows))
    return ChapterPart("Code and data", (head, *blocks, table), files, tuple(warnings), code)


def _names(study: Study, responses: tuple[SampledResponse, ...]) -> list[str]:
    """Return a file's name for each, different also where capitals count as small letters."""
    names: list[str] = []
    for response in responses:
        plain = re.sub(r"[^A-Za-z0-9_]", "_", response.tf.replace("/", "_over_"))
        names.append(free_name(f"data/{study.stem}_{plain}", names, ".csv"))
    return names


def _csv(response: SampledResponse) -> bytes:
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(HEAD)
    values, degrees = response.values, np.degrees(response.phase)
    lines = zip(response.frequency_hz, values.real, values.imag, response.magnitude_db, degrees, strict=True)
    writer.writerows([f"{v:.12g}" for v in line] for line in lines)
    return buffer.getvalue().encode()
