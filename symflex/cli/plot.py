"""``symflex plot``."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import click

from symflex.cli.reporting import note, reporting
from symflex.errors import Diagnostic, UsageError
from symflex.errors.diagnostic import nearest

SUFFIXES = (".pdf", ".png", ".svg")


@click.command("plot")
@click.argument("spec", type=click.Path())
@click.argument("kind")
@click.option("--tf", "tfs", multiple=True, metavar="OUT/IN", help="Draw this transfer function; repeatable.")
@click.option("--modes", type=click.IntRange(1), help="How many modes are shown, the lowest ones.")
@click.option("-o", "--output", type=click.Path(), help="File to write: .pdf, .svg or .png.")
@reporting
def command(spec: str, kind: str, *, tfs: tuple[str, ...], modes: int | None, output: str | None) -> int:
    """Draw KIND (bode, modes, poles_zeros) or a figure that SPEC defines in [figures].

    modes draws the shapes of the lowest modes of the model, --modes or [analysis] modes of them, else five.
    Without -o the figure is written to the current folder as SPEC_KIND.pdf.
    """
    from symflex import pipeline
    from symflex.emit.figures import FIGURES, draw, save
    from symflex.model.analysis import FIGURE_KINDS

    model = pipeline.load(spec)
    if modes is not None:
        model = replace(model, analysis=replace(model.analysis, modes=modes))
    figure = next((f for f in model.figures if f.name == kind), None)
    if figure is None and kind not in (*FIGURES, *FIGURE_KINDS):
        names = [*FIGURES, *(f.name for f in model.figures)]
        hint = nearest(kind, names) or "choose from: " + ", ".join(names)
        raise UsageError(Diagnostic("SF902", f"there is no figure '{kind[:64]}'", None, hint))
    drawn = figure.kind if figure else kind
    if drawn not in FIGURES:
        raise UsageError(Diagnostic("SF911", f"figures of kind '{drawn}' are not available yet"))
    path = Path(output) if output else Path(f"{Path(spec).stem}_{kind}.pdf")
    if path.suffix not in SUFFIXES:
        raise UsageError(Diagnostic("SF902", f"'{path.name}' must end in .pdf, .svg or .png"))
    pairs = figure.of if figure and figure.of and not tfs else pipeline.pick_pairs(model, tfs)
    if drawn == "modes":
        pairs = pairs[:1]  # all functions of a model have the same modes, seen or hidden
    bounds = pipeline.derive_bound(model, pairs)
    if not tfs and not figure:
        for bound in bounds:
            if bound.ratio.is_zero:
                note(f"{bound.name} is identically zero and is left out")
        bounds = tuple(bound for bound in bounds if not bound.ratio.is_zero) or bounds
    title = figure.title if figure else ""
    save(draw(drawn, [bound.source for bound in bounds], bounds, title=title or None), path)
    note(f"wrote {path}")
    return 0
