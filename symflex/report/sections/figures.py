"""The figures a specification asks for, or a Bode plot and a pole-zero array where it asks for none."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from symflex import pipeline
from symflex.emit.figures import FIGURES, LOOP_FIGURES, draw, draw_loop, render
from symflex.errors import SymflexError
from symflex.model import Figure
from symflex.report.document import Notice, Picture
from symflex.report.part import Part
from symflex.report.study import attempt

if TYPE_CHECKING:
    from symflex.report.document import Block
    from symflex.report.study import Study
    from symflex.transfer import BoundTransferFunction

MOST_CURVES: Final = 4
WORDS: Final = {"bode": "Bode plot", "poles_zeros": "Poles and zeros", "modes": "Mode shapes"}


LOOP_WORDS: Final = {
    "locus": "Root locus for the gain",
    "nyquist": "Nyquist plot of the loop with the gain",
}


def figure_section(study: Study) -> Part | None:
    """Return every figure, as SVG for the page and as PDF and SVG for papers."""
    known = {(b.source.output.name, b.source.input.name): b for b in study.bounds}
    drawable = {pair: b for pair, b in known.items() if not b.ratio.is_zero}
    blocks: list[Block] = []
    files: dict[str, bytes] = {}
    for figure in study.model.figures or _defaults(study, drawable):
        chosen = [drawable[pair] for pair in figure.of or tuple(drawable) if pair in drawable]
        picture: Picture | SymflexError
        if figure.gain and figure.kind in LOOP_FIGURES:
            picture = attempt(lambda f=figure: _loop_picture(study, f, files))  # type: ignore[misc]
            blocks.append(_block(figure, picture))
        elif figure.kind not in FIGURES:
            blocks.append(Notice(f"{figure.name}: figures of kind '{figure.kind}' are not available yet"))
        elif chosen:
            picture = attempt(lambda f=figure, c=chosen: _picture(study, f, c, files))  # type: ignore[misc]
            blocks.append(_block(figure, picture))
    return Part("Figures", tuple(blocks), files) if blocks else None


def _block(figure: Figure, picture: Picture | SymflexError) -> Block:
    """Return a picture, or why there is none."""
    if isinstance(picture, SymflexError):
        return Notice(f"{figure.name}: {picture.diagnostics[0].message}")
    return picture


def _defaults(study: Study, drawable: dict[tuple[str, str], BoundTransferFunction]) -> tuple[Figure, ...]:
    pairs = tuple(drawable)[:MOST_CURVES]
    return (Figure("bode", "bode", pairs), Figure("poles_zeros", "poles_zeros", pairs)) if pairs else ()


def _loop_picture(study: Study, figure: Figure, files: dict[str, bytes]) -> Picture:
    """Draw a root locus, or a Nyquist plot of the loop gain."""
    loop = pipeline.characteristic_loop(study.model, figure.gain)
    drawn = draw_loop(figure.kind, loop)
    stem = f"{study.stem}_{figure.name}"
    svg = render(drawn, "svg")
    files[f"figures/{stem}.svg"] = svg
    files[f"figures/{stem}.pdf"] = render(drawn, "pdf")
    caption = f"{figure.title}. " if figure.title else ""
    return Picture(stem, svg.decode(), f"{caption}{LOOP_WORDS[figure.kind]} {figure.gain}.")


def _picture(
    study: Study, figure: Figure, chosen: list[BoundTransferFunction], files: dict[str, bytes]
) -> Picture:
    if figure.kind == "modes":
        chosen = chosen[:1]  # all functions of a model have the same modes
    drawn = draw(figure.kind, [b.source for b in chosen], chosen)
    stem = f"{study.stem}_{figure.name}"
    svg = render(drawn, "svg")
    files[f"figures/{stem}.svg"] = svg
    files[f"figures/{stem}.pdf"] = render(drawn, "pdf")
    named = ", ".join(b.name for b in chosen)
    what = WORDS.get(figure.kind, figure.kind)
    caption = f"{figure.title}." if figure.title else f"{what} of {named}."
    if figure.title:
        caption += f" {what} of {named}."
    return Picture(stem, svg.decode(), caption)
