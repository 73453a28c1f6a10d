"""Figures that the specification asks for, and measured responses with the model over them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from symflex.errors import Diagnostic, SymflexError, UncertifiedError
from symflex.figures import FIGURES, LOOP_FIGURES, draw, draw_loop, draw_measured, unavailable
from symflex.model import Figure
from symflex.report.document import Code, Notice, text
from symflex.report.part import ChapterPart, code_of, picture
from symflex.report.study import attempt

if TYPE_CHECKING:
    from symflex.report.document import Block, PageFigure
    from symflex.report.study import Study
    from symflex.transfer import BoundTransferFunction


MOST_CURVES: Final = 4
WORDS: Final = {"bode": "Bode plot", "poles_zeros": "Poles and zeros", "modes": "Mode shapes"}


LOOP_WORDS: Final = {"locus": "Root locus for the gain", "nyquist": "Nyquist plot of the loop with the gain"}


def figure_section(study: Study) -> ChapterPart | None:
    """Return every figure, as SVG for the page and as PDF and SVG for papers."""
    known = {(b.source.output.name, b.source.input.name): b for b in study.bounds}
    drawable = {pair: b for pair, b in known.items() if not b.ratio.is_zero}
    blocks: list[Block] = []
    warnings: list[str] = []
    files: dict[str, bytes] = {}
    code = 0
    for figure in study.model.figures or _defaults(study, drawable):
        chosen = [drawable[pair] for pair in figure.of or tuple(drawable) if pair in drawable]
        drawn: PageFigure | SymflexError
        if figure.gain and figure.kind in LOOP_FIGURES:
            drawn = attempt(lambda f=figure: _loop_picture(study, f, files))  # type: ignore[misc]
        elif figure.kind not in FIGURES:
            drawn = SymflexError(unavailable(figure.kind))
        elif chosen:
            drawn = attempt(lambda f=figure, c=chosen: _picture(study, f, c, files))  # type: ignore[misc]
        else:
            drawn = SymflexError(Diagnostic("SF402", "all its functions are zero: there is nothing to draw"))
        if isinstance(drawn, SymflexError):
            why = f"{figure.name}: {drawn.diagnostics[0].message}"
            blocks.append(Notice(why))
            warnings.append(f"{study.stem}, figure {why}")
            # What the specification asks for is missing. Nobody asked for the figures by default, and kinds
            # that are announced have not failed.
            is_asked = bool(study.model.figures) and figure.kind in (*FIGURES, *LOOP_FIGURES)
            code = max(code, code_of(drawn), UncertifiedError.exit_code if is_asked else 0)
        else:
            blocks.append(drawn)
    return ChapterPart("Figures", tuple(blocks), files, tuple(warnings), code) if blocks else None


def _defaults(study: Study, drawable: dict[tuple[str, str], BoundTransferFunction]) -> tuple[Figure, ...]:
    pairs = tuple(drawable)[:MOST_CURVES]
    return (Figure("bode", "bode", pairs), Figure("poles_zeros", "poles_zeros", pairs)) if pairs else ()


def _loop_picture(study: Study, figure: Figure, files: dict[str, bytes]) -> PageFigure:
    """Draw a root locus, or a Nyquist plot of the loop gain."""
    drawn = draw_loop(figure.kind, study.loop(figure.gain), band_hz=figure.band)
    caption = f"{figure.title}. " if figure.title else ""
    caption += f"{LOOP_WORDS[figure.kind]} {figure.gain}."
    return picture(f"{study.stem}_{figure.name}", drawn, caption, files)


def _picture(
    study: Study, figure: Figure, chosen: list[BoundTransferFunction], files: dict[str, bytes]
) -> PageFigure:
    if figure.kind == "modes":
        chosen = chosen[:1]  # all functions of a model have the same modes
    caption = f"{figure.title}. " if figure.title else ""
    told = next((c for c in study.comparisons if c.measured.name == chosen[0].name), None)
    if figure.has_data and told is not None:
        drawn = draw_measured(told.measured, told.model, told.unit)
        kind = "SYNTHETIC data, computed and not measured" if told.measured.is_synthetic else "measured data"
        caption += f"{told.measured.name} over {kind}, {told.measured.values.size} lines."
        return picture(f"{study.stem}_{figure.name}", drawn, caption, files)
    drawn = draw(figure.kind, [b.source for b in chosen], chosen, band_hz=figure.band)
    caption += f"{WORDS.get(figure.kind, figure.kind)} of {', '.join(b.name for b in chosen)}."
    return picture(f"{study.stem}_{figure.name}", drawn, caption, files)


def data_section(study: Study) -> ChapterPart | None:
    """Return every measured response that a transfer function of the model is named like."""
    blocks: list[Block] = []
    files: dict[str, bytes] = {}
    shown = {"/".join(pair) for figure in study.model.figures if figure.has_data for pair in figure.of}
    for i, found in enumerate(study.comparisons):
        measured = found.measured
        if measured.name not in shown:
            drawn = draw_measured(measured, found.model, found.unit)
            kind = "SYNTHETIC data, computed and not measured," if measured.is_synthetic else "measured data"
            caption = f"{measured.name}: the model over {kind} of {measured.values.size} lines."
            blocks.append(picture(f"{study.stem}_data_{i + 1}", drawn, caption, files))
        band = f"{measured.frequency_hz[0]:.4g} to {measured.frequency_hz[-1]:.4g} Hz"
        whose = "the synthetic" if measured.is_synthetic else "the measured"
        misfit = f"{found.decibels:.3g} dB and {found.degrees:.3g} degrees rms"
        blocks.append(
            text(
                "From ",
                band,
                ", ",
                Code(measured.name),
                f" is off {whose} data by {misfit}, all lines alike.",
            )
        )
    return ChapterPart("Data", tuple(blocks), files) if blocks else None
