"""``symflex plot``."""

from __future__ import annotations

from dataclasses import replace
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

import click

from symflex.cli.budgeting import budgeted
from symflex.cli.reporting import load, note, outside, reporting, setting
from symflex.errors import Diagnostic, UsageError
from symflex.errors.diagnostic import nearest

if TYPE_CHECKING:
    from fractions import Fraction

    from symflex.figures import AxisLimits
    from symflex.model import Model
    from symflex.model.model import Figure

Ends = tuple[str, str]
SUFFIXES = (".pdf", ".pgf", ".png", ".svg")
SWEEP = "sweep"
CURVES = ("bode", "nyquist")
"""Kinds over the logarithm of the frequency, which has no 0."""
S_PLANES = ("locus", "poles_zeros")


@click.command("plot")
@click.argument("spec", type=click.Path())
@outside
@click.argument("kind")
@click.option("--tf", "tfs", multiple=True, metavar="OUT/IN", help="Draw this transfer function; repeatable.")
@click.option("--gain", metavar="K", help="Draw a locus, or a Nyquist plot, of the loop with this gain.")
@click.option("--band", nargs=2, metavar="LO HI", help='Frequencies shown: 0.1 1000, "1 kHz".')
@click.option("--xlim", nargs=2, metavar="LO HI", help="Ends of the axis across; rad/s in an s plane.")
@click.option("--ylim", nargs=2, metavar="LO HI", help="Ends of the axis upwards; dB of a Bode plot.")
@click.option("--phase", nargs=2, metavar="LO HI", help="Ends of the phases of a Bode plot [deg].")
@click.option("--range", "limits", nargs=2, metavar="LO HI", help="First and last gain of a locus.")
@click.option("--modes", type=click.IntRange(1), help="How many modes are shown, the lowest ones.")
@click.option("-o", "--output", type=click.Path(), help="File to write: .pdf, .pgf, .svg or .png.")
@click.option("--width", metavar="ieee|a4|MM", help="Width of the figure: 88.5, 170 or so many mm.")
@click.option("--font", metavar="FONT", help="times (the default), latex or sans.")
@budgeted
@reporting
@setting
def command(
    spec: str,
    kind: str,
    *,
    allow_outside: tuple[str, ...],
    settings: dict[str, str],
    tfs: tuple[str, ...],
    gain: str | None,
    band: Ends | None,
    xlim: Ends | None,
    ylim: Ends | None,
    phase: Ends | None,
    limits: tuple[str, str] | None,
    modes: int | None,
    output: str | None,
    width: str | None,
    font: str | None,
) -> int:
    """Draw KIND (bode, locus, modes, nyquist, poles_zeros) or a figure that SPEC defines in [figures].

    modes draws the shapes of the lowest modes of the model, --modes or [analysis] modes of them, else five.
    locus --gain K draws where the closed-loop poles go as K grows, from proved poles to proved zeros; of a
    distributed system those of the lowest modes. nyquist draws a transfer function, or with --gain K the loop
    gain.

    'symflex plot sweep FILE' draws a .nc or .npz that 'symflex sweep -o' wrote: modes over one parameter and
    their loci, or medians and what holds 90 % of the points.

    --band shows a band of frequencies: of bode and nyquist the curves, of modes those in it, and of what is
    drawn in the s plane all up to its end. --xlim, --ylim and --phase set the ends of axes; those of a
    frequency or in the s plane may have a unit, '1 kHz'.

    Without -o the figure is written to the current folder as SPEC_KIND.pdf.

    A .pgf is for papers set with LaTeX: load the package pgf and input the file. Its texts take the paper's
    font; --font, there latex by default, only says how much room to leave for them. No LaTeX installation is
    needed to write one.
    """
    from symflex import pipeline
    from symflex.cli.stability import gain_limit
    from symflex.figures import DEFAULT_FONT, LOOP_FIGURES, draw, draw_loop, save
    from symflex.loops import pick_gain
    from symflex.print.latex import column_width

    if SWEEP in (spec, kind):
        options = bool(settings or tfs or gain or limits or band or xlim or ylim or phase)
        return _plot_sweep(spec if kind == SWEEP else kind, modes, output, width, font, is_more=options)
    given = _checked_path(output) if output else None
    model = load(spec, allow_outside, settings)
    model = model if modes is None else replace(model, analysis=replace(model.analysis, modes=modes))
    figure, drawn = _named(model, kind)
    path = given or _checked_path(f"{Path(spec).stem}_{kind}.pdf")
    width_mm = None if width is None else column_width(width)
    font = _checked_font(font or ("latex" if path.suffix == ".pgf" else DEFAULT_FONT))
    named = gain or (figure.gain if figure else "")
    if (gain or limits) and drawn not in LOOP_FIGURES:
        message = f"--gain and --range are for {' and '.join(LOOP_FIGURES)}, not for '{drawn}'"
        raise UsageError(Diagnostic("SF902", message))
    shown, frame = _part_shown(drawn, band, xlim, ylim, phase)
    shown = shown or (figure.band if figure else None)
    if drawn == "locus" and not named:
        message = "a locus is drawn of a loop"
        raise UsageError(Diagnostic("SF902", message, None, "name its gain: --gain K, or gain in [figures]"))
    title = figure.title if figure else ""
    if named:
        parameter = pick_gain(model.parameters, named)
        chosen = (
            None if limits is None else (gain_limit(limits[0], parameter), gain_limit(limits[1], parameter))
        )
        loop = pipeline.characteristic_loop(model, named)
        drawing = draw_loop(
            drawn,
            loop,
            limits=chosen,
            modes=modes,
            band_hz=shown,
            frame=frame,
            title=title or None,
            width_mm=width_mm,
            font=font,
        )
        save(drawing, path, font=font)
        note(f"wrote {path}")
        return 0
    pairs = figure.of if figure and figure.of and not tfs else pipeline.pick_pairs(model, tfs)
    if drawn == "modes":
        pairs = pairs[:1]  # all functions of a model have the same modes, seen or hidden
    bounds = pipeline.derive_bound(model, pairs)
    if not tfs and not figure:
        for bound in bounds:
            if bound.ratio.is_zero:
                note(f"{bound.name} is identically zero and is left out")
        bounds = tuple(bound for bound in bounds if not bound.ratio.is_zero) or bounds
    sources = [bound.source for bound in bounds]
    drawing = draw(
        drawn,
        sources,
        bounds,
        band_hz=shown,
        frame=frame,
        title=title or None,
        width_mm=width_mm,
        font=font,
    )
    save(drawing, path, font=font)
    note(f"wrote {path}")
    return 0


def _plot_sweep(
    file: str,
    modes: int | None,
    output: str | None,
    width: str | None,
    font: str | None,
    *,
    is_more: bool,
) -> int:
    """Draw what 'symflex sweep -o' wrote."""
    if is_more:
        message = "--set, --tf, --gain, --range, --band and ends of axes are not for a sweep"
        raise UsageError(Diagnostic("SF902", message))
    from symflex.figures import DEFAULT_FONT, draw_sweep, save
    from symflex.figures.pgf import MM_PER_INCH
    from symflex.print.latex import column_width
    from symflex.sweep.files import read_sweep

    path = _checked_path(output or f"{Path(file).stem}_{SWEEP}.pdf")
    chosen = _checked_font(font or ("latex" if path.suffix == ".pgf" else DEFAULT_FONT))
    inches = None if width is None else column_width(width) / MM_PER_INCH
    save(draw_sweep(read_sweep(file), modes=modes, width=inches, font=chosen), path, font=chosen)
    note(f"wrote {path}")
    return 0


def _named(model: Model, kind: str) -> tuple[Figure | None, str]:
    """Return the figure of the specification that is named, if any, and the kind to draw.

    Raises
    ------
    UsageError
        SF902 when there is none of that name; SF911 when its kind is not available yet.
    """
    from symflex.figures import FIGURES, LOOP_FIGURES, unavailable
    from symflex.model.analysis import FIGURE_KINDS

    figure = next((f for f in model.figures if f.name == kind), None)
    if figure is None and kind not in (*FIGURES, *FIGURE_KINDS):
        names = [*FIGURES, "locus", *(f.name for f in model.figures)]
        hint = nearest(kind, names) or "choose from: " + ", ".join(names)
        raise UsageError(Diagnostic("SF902", f"there is no figure '{kind[:64]}'", None, hint))
    drawn = figure.kind if figure else kind
    if drawn not in (*FIGURES, *LOOP_FIGURES):
        raise UsageError(unavailable(drawn))
    return figure, drawn


def _part_shown(
    kind: str, band: Ends | None, xlim: Ends | None, ylim: Ends | None, phase: Ends | None
) -> tuple[tuple[Fraction, Fraction] | None, AxisLimits]:
    """Return the band [Hz] and the limits of axes that options say.

    Raises
    ------
    UsageError
        SF902 for limits that are none, and for two of the frequencies of a Bode plot.
    """
    from symflex.cli.roots import band_limits
    from symflex.figures import AxisLimits

    if xlim and kind == "bode":
        if band:
            raise UsageError(Diagnostic("SF902", "give only one of --band and --xlim"))
        band, xlim = xlim, None
    is_plane = kind in S_PLANES
    frame = AxisLimits(
        _ends(xlim, "--xlim", is_frequency=is_plane),
        _ends(ylim, "--ylim", is_frequency=is_plane),
        _ends(phase, "--phase"),
    )
    return None if band is None else band_limits(band, above_zero=kind in CURVES), frame


def _ends(texts: Ends | None, option: str, *, is_frequency: bool = False) -> tuple[float, float] | None:
    """Return the ends of an axis: numbers, or frequencies [rad/s].

    Raises
    ------
    UsageError
        SF902 for what is no number, and where the first is not the lower one.
    """
    if texts is None:
        return None
    from symflex.cli.roots import frequency_limit, plain_number

    if is_frequency:
        low, high = (float(frequency_limit(text, option, "-10 or '3 rad/s'", hertz=False)) for text in texts)
    else:
        low, high = (plain_number(text, ("dB", "deg", "°")) for text in texts)
        for text, end in zip(texts, (low, high), strict=True):
            if not isfinite(end):
                message = f"{option} takes numbers such as -60, found '{text[:40]}'"
                raise UsageError(Diagnostic("SF902", message))
    if not low < high:
        raise UsageError(Diagnostic("SF902", f"{option} takes two numbers, the lower one first"))
    return low, high


def _checked_path(name: str) -> Path:
    """Return the path of a figure.

    Raises
    ------
    UsageError
        SF902 when it ends in nothing a figure is written as; SF903 when it could not be written.
    """
    from symflex.files.write import check_writable

    path = Path(name)
    if path.suffix not in SUFFIXES:
        raise UsageError(Diagnostic("SF902", f"'{path.name}' must end in .pdf, .pgf, .svg or .png"))
    check_writable(path)
    return path


def _checked_font(font: str) -> str:
    """Return the name of a font for figures.

    Raises
    ------
    UsageError
        SF902 when there is no such font.
    """
    from symflex.figures import FONTS

    if font not in FONTS:
        hint = nearest(font, FONTS) or "fonts: " + ", ".join(FONTS)
        raise UsageError(Diagnostic("SF902", f"there is no font '{font[:64]}' for figures", None, hint))
    return font
