"""``symflex draw`` and ``symflex plot``."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from symflex.cli.analyses import Ranged
from symflex.cli.command import Specification, command_of
from symflex.cli.reporting import PICTURES, check_place, note, write
from symflex.cli.respond import show_response
from symflex.errors import no_such, refused
from symflex.options import (
    ContactOptions,
    DrawOptions,
    PassivityOptions,
    PlotOptions,
    RespondOptions,
    duration,
    gain_ends,
)

if TYPE_CHECKING:
    from symflex.model import Model
    from symflex.model.model import Figure
    from symflex.transfer import AnyBoundFunction

SWEEP = "sweep"
STABILITY = "stability"
Z_WIDTH = "z-width"
IN_TIME = ("step", "impulse")
FRAME = ("xlim", "ylim", "width", "font")


@command_of("draw", DrawOptions)
def draw(spec: Specification, given: DrawOptions) -> int:
    """Draw the model as a textbook would: masses, springs, beams, circuits, loops.

    symflex finds all positions from the specification. The drawing is as wide as a journal column, the text
    of a page, or what the model needs; --width sets it. --values labels symbols with numbers.

    Without -o, the drawing is written to the current folder as SPEC_drawing.svg. Use .pgf for papers set with
    LaTeX, as for plot.
    """
    from symflex.drawing import drawing_of, render_drawing
    from symflex.figures import checked_font
    from symflex.print.latex import width_of

    path = check_place(given.output or f"{Path(spec.path).stem}_drawing.svg", PICTURES)
    font = checked_font(given.font, path)
    width_mm = width_of(given.width)
    drawing = drawing_of(spec.load(), values=given.values, width_mm=width_mm, font=font)
    write(path, render_drawing(drawing, path.suffix.removeprefix(".").lower(), font=font))
    return 0


@command_of("plot", PlotOptions, Ranged)
def plot(spec: Specification, given: PlotOptions) -> int:
    """Draw KIND, or a figure that SPEC defines in [figures].

    Kinds are bode, deflection, impulse, locus, modes, nichols, nyquist, poles_zeros, rga, sensitivity, sigma,
    stability and step.

    modes draws the lowest mode shapes: as many as --modes gives, else [analysis] modes, else five. locus
    --gain K draws the paths of the closed-loop poles as K grows, from certified poles to certified zeros; for
    a distributed system, those of the lowest modes. nyquist and nichols draw transfer functions, or with
    --gain K the loop gain. sensitivity --gain K draws |S| and |T| with their certified peaks.

    sigma draws the singular values of the matrix that all transfer functions, or those of --tf, make, and rga
    its relative gains. With --matrix, poles_zeros draws the poles and transmission zeros of that matrix, and
    nyquist its characteristic loci.

    stability --over T draws the number of unstable poles over a parameter; with two, as --over K --over T, a
    chart with regions, boundaries and the values of SPEC. Ranges are as for 'symflex stability'.

    'symflex plot sweep FILE' draws a .nc or .npz file of 'symflex sweep -o': modes over one parameter and
    their loci, or medians and the range of 90 % of the points.

    passivity --port PORT draws the real part of the driving-point function of a port or node, active bands
    shaded, as 'symflex passivity' proves them.

    z-width --port PORT --over K --over B draws for which values of two parameters the model is passive, as
    'symflex passivity' proves it, or with --environment LAW stable with that, as 'symflex contact' does.

    poles_zeros --spread shades where roots lie for all combinations of values, as 'symflex roots' proves it.

    --band sets the frequencies of curves, and which modes are drawn. Figures in the s plane
    show everything up to the end of the band. --xlim, --ylim and --phase set the ends of axes. Frequencies
    and values in the s plane may have a unit, '1 kHz'. step and impulse run to --until or the end of --xlim
    [s], by default until the slowest motion has died away. step --record FILE drives the model with the
    input of a time record instead, and draws the measured output over the model's, as 'symflex respond'.

    Without -o, the figure is written to the current folder as SPEC_KIND.pdf.

    deflection --at 30Hz draws how everything moves at that frequency under the inputs, or those of --tf,
    divided by the largest displacement, whose size and phase are printed.

    modes and deflection -o FILE.gif write an animation that repeats one period of every shape.

    Use .pgf for papers set with LaTeX: load the package pgf and input the file. Its text appears in the
    paper's font, and --font (latex by default) only sets how much space it gets. You need no LaTeX to write
    it.
    """
    from symflex import pipeline
    from symflex.figures import FIGURES, LOOP_FIGURES, checked_font, draw, part_shown, save
    from symflex.print.latex import width_of

    if (is_over := bool(given.over) or given.kind in (STABILITY, Z_WIDTH)) or (
        given.record or SWEEP in (spec.path, given.kind)
    ):
        return (_plot_over if is_over else _plot_record if given.record else _plot_sweep)(spec, given)
    if given.kind.endswith(".toml") and not Path(spec.path).exists():
        hint = f"the file comes first: symflex plot {given.kind} {spec.path}"
        raise refused(f"there is no file '{spec.path}'", hint)
    path = check_place(given.output, (".gif", *PICTURES)) if given.output else None
    model = spec.load()
    if given.modes is not None:
        model = replace(model, analysis=replace(model.analysis, modes=given.modes))
    figure, drawn = _named(model, given.kind)
    if figure is not None and figure.over:
        return _plot_over(spec, replace(given, kind=STABILITY, over=figure.over), given.kind)
    path = path or check_place(f"{Path(spec.path).stem}_{given.kind}.pdf", PICTURES)
    width_mm = width_of(given.width)
    font = checked_font(given.font, path)
    gain = given.gain or (figure.gain if figure else "")
    if (given.gain or given.limits) and drawn not in LOOP_FIGURES:
        raise refused(f"--gain and --range are for {', '.join(LOOP_FIGURES)}, not for '{drawn}'")
    band, frame = part_shown(drawn, given)
    shown = band or (figure.band if figure else None)
    if figure and figure.until and frame.x is None:
        frame = replace(frame, x=(0.0, float(figure.until)))
    if given.until is not None:
        if drawn not in IN_TIME or given.xlim:
            raise refused(f"--until is for {' and '.join(IN_TIME)}, in place of --xlim")
        frame = replace(frame, x=(0.0, float(duration(given.until, "--until"))))
    if drawn not in FIGURES and not gain:
        hint = "name its gain: --gain K, or gain in [figures]"
        raise refused(f"a figure of kind '{drawn}' needs the gain of a loop", hint)
    title = figure.title or None if figure else None
    frame = replace(frame, at=frame.at or (figure.at if figure else ()))
    look = partial(draw, drawn, band_hz=shown, frame=frame, title=title, width_mm=width_mm, font=font)
    if gain:
        from symflex.loops import pick_gain
        from symflex.loops.of_model import characteristic_loop

        limits = gain_ends(given.limits, pick_gain(model.parameters, gain))
        limits = limits or (figure.limits if figure else None)
        drawing = look(characteristic_loop(model, gain), limits=limits, modes=given.modes)
    else:
        pairs = figure.of if figure and figure.of and not given.tfs else pipeline.pick_pairs(model, given.tfs)
        if drawn == "modes":
            pairs = pairs[:1]  # all functions of a model have the same modes, seen or hidden
        bounds = _at_port(model, given) if drawn == "passivity" else pipeline.derive_for_roots(model, pairs)
        if not given.tfs and not figure:
            bounds = _without_zeros(bounds)
        drawing = look(bounds, spread=given.spread, model=model, is_matrix=given.is_matrix)
    save(drawing, path, font=font)
    note(f"wrote {path}")
    return 0


def _at_port(model: Model, given: PlotOptions) -> tuple[AnyBoundFunction, ...]:
    """Return the function that a figure of passivity draws."""
    from symflex.contact.passivity import driving_function

    return (driving_function(model, given.port),)


def _without_zeros(bounds: tuple[AnyBoundFunction, ...]) -> tuple[AnyBoundFunction, ...]:
    """Return the functions that are not identically zero, all if none is left, and say which are left out."""
    for bound in (bound for bound in bounds if bound.is_zero):
        note(f"{bound.name} is identically zero and is left out")
    return tuple(bound for bound in bounds if not bound.is_zero) or bounds


def _plot_over(spec: Specification, given: PlotOptions, name: str = STABILITY) -> int:
    """Draw for which values of one parameter, or of two, SPEC is stable."""
    others = ("tfs", "gain", "band", "xlim", "ylim", "phase", "modes", "until", "record")
    is_other = given.spread is not None or any(getattr(given, n) for n in others)
    if given.kind not in (STABILITY, Z_WIDTH) or not given.over or is_other:
        hint = "as in: symflex plot FILE stability --over K --over T --box"
        raise refused(
            "--over is for stability and z-width, which take no --tf, --band, --spread or ends of axes", hint
        )
    from symflex import pipeline
    from symflex.figures import checked_font, draw_over, save

    if given.kind == Z_WIDTH:
        return _plot_z_width(spec, given)
    path = check_place(given.output or f"{Path(spec.path).stem}_{name}.pdf", PICTURES)
    given = replace(given, font=(font := checked_font(given.font, path)))
    save(draw_over(pipeline.stability(spec.load(), given.stability), given), path, font=font)
    note(f"wrote {path}")
    return 0


def _plot_z_width(spec: Specification, given: PlotOptions) -> int:
    """Draw for which values of two parameters SPEC is stable with an environment, or passive, at a port."""
    from symflex.contact.coupled import coupled_stability
    from symflex.contact.law import ANY
    from symflex.contact.over import PassiveChart, passive_over
    from symflex.figures import checked_font, draw_over, save
    from symflex.loops.chart import StabilityChart

    if len(given.over) != 2:  # noqa: PLR2004 (two axes)
        raise refused(f"{Z_WIDTH} is drawn over two parameters: --over K --over B")
    path = check_place(given.output or f"{Path(spec.path).stem}_{Z_WIDTH}.pdf", PICTURES)
    given = replace(given, font=(font := checked_font(given.font, path)))
    found: object
    if given.environment is None or given.environment == ANY:
        ports = () if given.port is None else (given.port,)
        found = passive_over(spec.load(), PassivityOptions(ports, given.over, None, given.ranges))
    else:
        law, ranges = given.environment, given.ranges
        asked = ContactOptions(given.port, law, given.over, None, ranges, None, None, given.resolve)
        found = coupled_stability(spec.source(), asked, spec.settings, spec.allow_outside).answer
    if isinstance(found, StabilityChart | PassiveChart):  # of two parameters both are
        save(draw_over(found, given), path, font=font)
    note(f"wrote {path}")
    return 0


def _plot_record(spec: Specification, given: PlotOptions) -> int:
    """Draw the measured output of a record over the model's."""
    if given.kind != "step" or len(given.tfs) > 1 or given.spread is not None:
        raise refused("--record is for step, and one --tf")
    path = check_place(given.output or f"{Path(spec.path).stem}_step.pdf", PICTURES)
    shared = {name: getattr(given, name) for name in ("record", "columns", "until", *FRAME)}
    tf = next(iter(given.tfs), None)
    return show_response(spec, RespondOptions(tf=tf, output=str(path), **shared))


def _plot_sweep(spec: Specification, given: PlotOptions) -> int:
    """Draw what 'symflex sweep -o' wrote."""
    others = (given.tfs, given.gain, given.limits, given.band, given.xlim, given.ylim, given.phase)
    if spec.settings or any(others) or given.spread is not None:
        message = "--set, --tf, --gain, --range, --band, --spread and ends of axes do not apply to a sweep"
        raise refused(message)
    from symflex.figures import checked_font, draw_sweep, save
    from symflex.print.latex import width_of
    from symflex.sweep.files import read_sweep

    file = spec.path if given.kind == SWEEP else given.kind
    path = check_place(given.output or f"{Path(file).stem}_{SWEEP}.pdf", PICTURES)
    font = checked_font(given.font, path)
    width_mm = width_of(given.width)
    save(draw_sweep(read_sweep(file), modes=given.modes, width_mm=width_mm, font=font), path, font=font)
    note(f"wrote {path}")
    return 0


def _named(model: Model, kind: str) -> tuple[Figure | None, str]:
    """Return the figure of the specification that is named, if any, and the kind to draw; SF902 without."""
    from symflex.figures import FIGURES, LOOP_FIGURES

    figure = next((f for f in model.figures if f.name == kind), None)
    if figure is None and kind not in (*FIGURES, *LOOP_FIGURES):
        names = [*FIGURES, "locus", "sensitivity", STABILITY, *(f.name for f in model.figures)]
        raise no_such("figure", kind, names, "choose from")
    return figure, figure.kind if figure else kind
