"""Root loci between certified poles and zeros as a gain grows, and Nyquist plots about the point -1."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import cycle, pairwise
from math import ceil, floor, hypot, log10, pi
from typing import Final

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.patches import Circle

from symflex.analysis.response import adaptive_grid, default_band, grid_about, respond, roots_if_found
from symflex.figures.axes import (
    FREE,
    RIGHT_HALF_PLANE,
    Canvas,
    draw_points,
    draw_zero_lines,
    drawable,
    label_s_plane,
    point_of,
    root_figure,
    set_round_ticks,
    write_title,
)
from symflex.figures.s_plane import (
    GAP_RATIO,
    POINTS_PER_INCH,
    Kind,
    Panel,
    RootMark,
    View,
    choose_view,
    first_run,
    inches_of,
    write_notes,
)
from symflex.figures.style import (
    COLOURS,
    COLUMN_INCHES,
    LINE_INCHES,
    QUIET,
    TITLE_POINTS,
    TITLE_SPACING,
    label_of_name,
    label_of_tf,
    number_label,
    size_of_text,
    title_lines,
)
from symflex.loops import (
    AnyLoop,
    Loop,
    NetworkLoop,
    RootLocus,
    closed_loop,
    closed_loop_roots,
    find_stable_gains,
    loop_gain,
    nominal_gain,
    poles_apart,
    require_arrival,
    trace_locus,
)
from symflex.roots import Band, PoleZeroMap
from symflex.roots.pole_zero_map import StabilityVerdict
from symflex.roots.root import hertz
from symflex.transfer import AnyBoundFunction

HEIGHT_INCHES: Final = 3.3
ROOM: Final = 1.12
ZERO: Final = "zero"
LOOKS: Final[dict[Kind, tuple[str, str, float]]] = {  # shape, colour and size of marks
    "pole": ("x", COLOURS[1], 5),
    "nominal": ("*", "black", 6),
    "last": ("s", COLOURS[0], 3.4),
    "zero": ("o", COLOURS[2], 6.5),
}
COLOUR_OF: Final = {kind: colour for kind, (_, colour, _) in LOOKS.items()}
CLOSE: Final = 0.3  # narrowest width shown, over the height
FAR_OUT, ZEROS_OUT, AGREE = 2.0, 1.3, 1.001
"""Over the curves shown: poles that hardly move are left out, zeros shown, certified poles theirs."""
POINTED: Final = 0.06  # length of a curve over the height shown from which on it has an arrow


def draw_locus(loop: AnyLoop, canvas: Canvas) -> Figure:
    """Draw a root locus: crosses at the first gain, squares at the last, stars at the nominal one.

    Marks are certified; lines between are traced numerically, dashed from where no pole is marked, and arrows
    point to growing gains. Crossings of the imaginary axis are noted, as is what lies outside.
    """
    locus = trace_locus(loop, canvas.gains, canvas.modes, band_hz=canvas.band_hz)
    require_arrival(locus)
    boundaries = find_stable_gains(loop, locus.limits).boundaries if isinstance(loop, Loop) else ()
    width = canvas.width or COLUMN_INCHES
    lines = title_lines(canvas.title, width)
    size = loop.gain.counted_in[1]
    stages = _stages(locus, size)
    name = label_of_name(locus.gain)
    # What each gain makes of stability, then what no gain moves and nothing sees.
    verdicts = [located.verdict for *_, located, _ in stages]
    heads = [replace(verdict, hidden="").headline for verdict in verdicts]
    said = [f"${name} = {gain}$, {head}" for (_, gain, *_), head in zip(stages, heads, strict=True)]
    said += dict.fromkeys(verdict.hidden for verdict in verdicts if verdict.hidden)
    said = said if canvas.frame.has_verdict else []
    axes = canvas.one_panel(HEIGHT_INCHES + LINE_INCHES * (len(lines) + len(said) + 1))
    marks = [
        *(RootMark(kind, s) for kind, _, _, points in stages for s in points),
        *(RootMark("zero", point_of(root)) for root in locus.start.zeros),
    ]
    crossings = {
        complex(0, float(omega.mid())): f"${name} = {number_label(float(boundary.gain.mid()) / float(size))}$"
        + (f", {number_label(float(hertz(omega).mid()))} Hz" if omega > 0 else "")
        for boundary in boundaries
        for omega in boundary.frequencies
    }
    view = _view(locus, marks, canvas, max(map(abs, crossings), default=0.0))
    axes.set_xlim(*view.re)
    axes.set_ylim(*view.im)
    seen = float(np.max(np.abs([view.re, view.im])))
    axes.axvspan(0, max(view.re[1], 0.0), color=RIGHT_HALF_PLANE, zorder=0, linewidth=0)
    draw_zero_lines(axes)
    labels: dict[Kind, str] = {kind: f"poles, ${name} = {gain}$" for kind, gain, *_ in stages}
    for kind, label in {**labels, ZERO: "zeros"}.items():
        points = [mark.s for mark in marks if mark.kind == kind]
        inside = [s for s in points if _is_seen(axes, s)]
        # Infinitely many zeros have no number that those listed could tell.
        outside = 0 if kind == ZERO and locus.start.is_infinite else len(points) - len(inside)
        if inside or (points and kind != ZERO):
            legend_entry = f"{label} ({outside if inside else 'all'} outside)" if outside else label
            draw_points(axes, inside, LOOKS[kind], legend_entry)
    for branches, line, said_of in (
        (locus.branches, "-", ""),
        (locus.entering, "--", "from poles not marked"),
    ):
        shown = [b for b in branches if any(_is_seen(axes, s) for s in b)]
        for i, branch in enumerate(shown):
            s = drawable(np.array(branch), seen)
            entry = said_of if said_of and not i else None
            axes.plot(s.real, s.imag, line, color=COLOURS[0], linewidth=1.0, zorder=2, label=entry)
            point_along(axes, s, COLOURS[0], POINTED * (view.im[1] - view.im[0]))
    for crossing in crossings:
        axes.plot([0, 0], [crossing.imag, -crossing.imag], "o", color="black", markersize=2.6, zorder=4)
    _draw_holes(axes, locus)
    label_s_plane(axes)
    letters = sum(len(str(label).replace("$", "")) for label in axes.get_legend_handles_labels()[1])
    legend = canvas.legend(
        axes,
        title="\n".join(said),
        frameon=False,
        handletextpad=0.2,
        columnspacing=1.0,
        ncols=3 if letters <= 18 * width else 2,  # letters of three labels in a line, per inch
    )
    legend.get_title().set_multialignment("center")
    figure = root_figure(axes)
    if not canvas.axes:
        write_title(figure, lines)
        figure.draw_without_rendering()  # what is above takes its room
    if canvas.frame == FREE:
        named = [mark for mark in marks if mark.kind != ZERO or not locus.start.is_infinite]
        seen_there = {s: text for s, text in crossings.items() if _is_seen(axes, s)}
        write_notes(axes, named, Panel.of(view, *inches_of(axes), marks), COLOUR_OF, said=seen_there)
    return figure


Stage = tuple[Kind, str, "PoleZeroMap", list[complex]]  # a value of the gain, in mathematics, and its poles


def _stages(locus: RootLocus, size: Fraction) -> list[Stage]:
    """Return the gains whose poles are marked, ascending, printed in a unit of some size."""
    low, high = locus.limits
    proved: list[tuple[Kind, Fraction, PoleZeroMap]] = [("pole", low, locus.start)]
    proved += [("nominal", *locus.nominal)] if locus.nominal else []
    stages = [(*one, [point_of(root) for root in one[2].all_poles]) for one in proved]
    stages.append(("last", high, locus.end, list(locus.ends)))
    labels = [number_label(float(gain / size)) for _, gain, _, _ in stages]
    pairs = zip(labels, stages, strict=True)
    return [(kind, label, located, points) for label, (kind, _, located, points) in pairs]


def _view(locus: RootLocus, marks: Sequence[RootMark], canvas: Canvas, crossing: float) -> View:
    """Return what is shown: the roots that belong together, and the curves between them."""
    high_hz = None if canvas.band_hz is None else canvas.band_hz[1]
    view = choose_view(marks, high_hz, (CLOSE, 1 / CLOSE), _chosen(locus, marks, crossing))
    size = max(map(abs, view.shown), default=0.0)
    curves = [ROOM * s for branch in locus.branches for s in branch if abs(s) <= 1.6 * size]
    reach = 0.0 if high_hz is None else ROOM * 2 * pi * high_hz
    across, upwards = [s.real for s in curves], [s.imag for s in curves]
    re = min([view.re[0], *across]), max([view.re[1], *across])
    im = min([view.im[0], -reach, *upwards]), max([view.im[1], reach, *upwards])
    shown = view.shown if canvas.frame == FREE else frozenset[complex]()
    return View(canvas.frame.x or re, canvas.frame.y or im, shown)


def _chosen(locus: RootLocus, marks: Sequence[RootMark], crossing: float) -> set[complex]:
    """Return the roots near the curves to be shown, from the innermost past the last crossing [rad/s]."""
    traced = [(max(map(abs, b)), sum(abs(t - s) for s, t in pairwise(b))) for b in locus.branches]
    traced += [(abs(branch[-1]), abs(branch[-1])) for branch in locus.entering]
    traced = sorted(one for one in traced if one[0])
    radius = longest = 0.0
    for i, (size, length) in enumerate(traced):
        is_apart = size > GAP_RATIO * radius or (size > FAR_OUT * radius and length < longest / 2)
        if radius and is_apart and (0 < crossing <= radius or 2 * i >= len(traced)):
            break
        radius, longest = size, max(longest, length)
    radius = radius or first_run(abs(m.s) for m in marks if m.s)
    return {m.s for m in marks if abs(m.s) <= radius * (ZEROS_OUT if m.kind == ZERO else AGREE)}


def _is_seen(axes: Axes, s: complex) -> bool:
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    return left <= s.real <= right and low <= s.imag <= high


def _draw_holes(axes: Axes, locus: RootLocus) -> None:
    """Draw what was not searched, as poles accumulate there."""
    holes = {(hole.re, side * hole.im, hole.radius) for hole in locus.end.excluded for side in (1, -1)}
    shown = [hole for hole in sorted(holes) if _is_seen(axes, complex(*hole[:2]))]
    for i, (re, im, radius) in enumerate(shown):
        ring = Circle((re, im), radius, fill=False, edgecolor=QUIET, linewidth=0.8, zorder=1.5)
        ring.set_label("" if i else "poles accumulate")
        axes.add_patch(ring)


@dataclass(frozen=True)
class AxisCurve:
    """What is drawn along the imaginary axis."""

    frequency_hz: npt.NDArray[np.float64]  # increasing
    values: npt.NDArray[np.complex128]
    verdict: StabilityVerdict  # what is known of its poles

    @classmethod
    def of(
        cls,
        frequency_hz: npt.NDArray[np.float64],
        values: npt.NDArray[np.complex128],
        verdict: StabilityVerdict,
    ) -> AxisCurve:
        """Return a curve without the places where it is infinite."""
        is_finite = np.isfinite(values)
        return cls(frequency_hz[is_finite], values[is_finite], verdict)


"""Values along the imaginary axis, and what is known of the poles."""
WIDENED: Final = 10.0  # how far beyond the band of poles and zeros the curve is drawn, to both sides
REACHES: Final = (1.5, 2.5)  # half the side of the square shown of a loop gain, about -1
AT_REST: Final = 1e-3  # share of its lowest frequency at which a curve is as good as at 0
PEAKED: Final = 3.0  # a curve is shown up to so many times the value that a tenth of it exceeds
OBLONG: Final = 4.0  # limits asked for whose ratio exceeds this have a scale each
LEGEND_POINTS: Final = 8.0
LINE_POINTS: Final = 34.0  # length of a legend's line with its gaps: 2 of handle, 0.8 and 1.4, in letters
WITHIN: Final = 0.9  # an arrow stands in so much of what is shown
SHORT_BRANCH, LONG_BRANCH = 0.4, 2.5
"""Lengths of a branch over the reach of the axes from which on it has an arrow, and several."""
MIRRORED_POINT: Final = 8  # size of the arrows of negative frequencies
MOST_MARKS, MARKS_APART = 6, 0.13
"""Frequencies written beside a curve, and how far they are apart, in widths of the axes."""


def draw_nyquist(bounds: Sequence[AnyBoundFunction], canvas: Canvas) -> Figure:
    """Draw the values of transfer functions for positive frequencies and, dashed, for negative ones.

    Without a band, the curve of a rational function ends beside its limit. The legend counts P unstable
    poles.
    """
    return draw_curves(bounds, canvas, _draw_about_one)


def draw_loop_gain(loop: AnyLoop, canvas: Canvas) -> Figure:
    """Draw a loop gain about -1 as :func:`draw_nyquist` does; a verdict asked for is of the closed loop."""
    return draw_curves(loop, canvas, _draw_about_one)


def draw_curves(
    drawn: Sequence[AnyBoundFunction] | AnyLoop,
    canvas: Canvas,
    drawing: Callable[[Axes, list[AxisCurve], list[str], Canvas, bool], None],
) -> Figure:
    """Draw functions or a loop gain along the imaginary axis, each with its label."""
    width, said = canvas.width or COLUMN_INCHES, list[str]()
    if is_loop := isinstance(drawn, Loop | NetworkLoop):
        gain = nominal_gain(drawn)
        shown = number_label(float(gain / drawn.gain.counted_in[1]))
        labels = [f"loop gain, ${label_of_name(drawn.gain.name)} = {shown}$"]
        if isinstance(drawn, NetworkLoop):
            followed = [_network_curve(drawn, gain, canvas)]
        else:
            followed = [_curve(loop_gain(drawn), canvas, closed_loop(drawn))]
        if canvas.frame.has_verdict:
            said.append(f"closed loop {verdict_of_closed(drawn, gain).headline}")
    else:
        followed = [_curve(bound, canvas) for bound in drawn]
        labels = [label_of_tf(bound.source) for bound in drawn]
    labels = [label + _open_poles(curve.verdict) for label, curve in zip(labels, followed, strict=True)]
    columns = _columns(labels, width)
    lines = [line for text in (canvas.title, *said) for line in title_lines(text, width)]
    axes = canvas.one_panel(HEIGHT_INCHES + LINE_INCHES * (len(lines) - (-len(labels) // columns)))
    drawing(axes, followed, labels, canvas, is_loop)
    axes.tick_params(pad=4.5)  # ends of a square may have ticks next to their corner
    # A title of the figure would stand over a legend outside of the axes.
    legend = canvas.legend(axes, ncols=columns, frameon=False, title="\n".join(lines))
    legend.get_title().set(
        fontsize=TITLE_POINTS, linespacing=TITLE_SPACING, parse_math=False, multialignment="center"
    )
    return root_figure(axes)


def verdict_of_closed(loop: AnyLoop, gain: Fraction) -> StabilityVerdict:
    """Return what is known of the stability of a closed loop at a gain."""
    if isinstance(loop, NetworkLoop):
        return closed_loop_roots(loop, gain).verdict
    closed, apart = roots_if_found(closed_loop(loop, gain)), poles_apart(loop.bound, loop.factors)
    return closed.verdict.beside(apart.verdict)


def _draw_about_one(
    axes: Axes, curves: list[AxisCurve], labels: list[str], canvas: Canvas, is_loop: bool
) -> None:
    """Draw curves in the plane of their values, with the point -1, the unit circle and some frequencies."""
    draw_zero_lines(axes)
    circle = np.exp(1j * np.linspace(0, 2 * np.pi, 361))
    axes.plot(circle.real, circle.imag, ":", color=QUIET, linewidth=0.7, zorder=1)
    reach = _reach(np.concatenate([curve.values for curve in curves]), is_loop=is_loop)
    across, upwards = canvas.frame.x or (-reach, reach), canvas.frame.y or (-reach, reach)
    axes.set_xlim(*across)
    axes.set_ylim(*upwards)
    reach = max(map(abs, (*across, *upwards)))
    for curve, label, colour in zip(curves, labels, cycle(COLOURS), strict=False):
        values = drawable(curve.values, reach)
        axes.plot(values.real, values.imag, "-", color=colour, linewidth=1.0, zorder=2, label=label)
        axes.plot(values.real, -values.imag, "--", color=colour, linewidth=0.6, zorder=2)
    if reach > 1:
        axes.plot([-1], [0], "+", color="black", markersize=8, markeredgewidth=1.1, zorder=4)
    if 1 / OBLONG < (across[1] - across[0]) / (upwards[1] - upwards[0]) < OBLONG:
        axes.set_aspect("equal", adjustable="box")
    marked = list[complex]()
    for curve, colour in zip(curves, cycle(COLOURS), strict=False):
        for branch in _branches(axes, curve.values, LONG_BRANCH * reach):
            point_along(axes, branch, colour, SHORT_BRANCH * reach)
            point_along(axes, branch.conj()[::-1], colour, SHORT_BRANCH * reach, size=MIRRORED_POINT)
        marked = _mark_frequencies(axes, curve, colour, marked)
    set_round_ticks(axes, 5, 5)
    axes.set_xlabel("Real part")
    axes.set_ylabel("Imaginary part")


def _branches(
    axes: Axes, values: npt.NDArray[np.complex128], longest: float
) -> Iterator[npt.NDArray[np.complex128]]:
    """Yield the pieces of a curve that axes show, one after the other, long ones cut into equal lengths."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    is_shown = (values.real > left) & (values.real < right) & (values.imag > low) & (values.imag < high)
    for piece in np.split(np.arange(values.size), np.flatnonzero(np.diff(is_shown)) + 1):
        if is_shown[piece[0]]:
            lengths = np.cumsum(np.abs(np.diff(values[piece])))
            count = 1 + int(lengths[-1] // longest) if lengths.size else 1
            yield from (
                np.split(values[piece], np.searchsorted(lengths, lengths[-1] * np.arange(1, count) / count))
                if count > 1
                else [values[piece]]
            )


def _mark_frequencies(axes: Axes, curve: AxisCurve, colour: str, marked: list[complex]) -> list[complex]:
    """Write some round frequencies beside a curve, none beside another; return where all of them are."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    # Both ends say little: there the frequency is next to 0, or far beyond what moves.
    size, marked = (
        complex(right - left, high - low),
        [*marked, -1 + 0j, 0j, curve.values[0], curve.values[-1]],
    )
    decades = range(floor(log10(curve.frequency_hz[0])), ceil(log10(curve.frequency_hz[-1])) + 1)
    count = 0
    rounded = sorted((m not in (1, 2, 5), m * 10.0**d) for d in decades for m in range(1, 10))
    for _, at in rounded:
        if not curve.frequency_hz[0] < at < curve.frequency_hz[-1] or count == MOST_MARKS:
            continue
        s = complex(
            *(np.interp(at, curve.frequency_hz, part) for part in (curve.values.real, curve.values.imag))
        )
        inside = left < s.real < right and low < s.imag < high
        apart = min(hypot((s - z).real / size.real, (s - z).imag / size.imag) for z in marked)
        if inside and apart > MARKS_APART:
            axes.plot([s.real], [s.imag], ".", color=colour, markersize=4, zorder=3)
            is_left = s.real < left + 0.75 * size.real
            note = axes.annotate(
                f"{at:g} Hz",
                (s.real, s.imag),
                (3 if is_left else -3, 2),
                textcoords="offset points",
                fontsize=6,
            )
            note.set(color=colour, ha="left" if is_left else "right", zorder=3)
            note.set(bbox={"fc": "white", "ec": "none", "pad": 0.2, "alpha": 0.7})
            marked.append(s)
            count += 1
    return marked


def _open_poles(verdict: StabilityVerdict) -> str:
    """Return P of Nyquist's criterion: how many poles of what is drawn lie in the right half-plane."""
    if verdict.right is not None:
        return f", $P = {verdict.right}$" if verdict.right else ""
    return rf", $P \geq {verdict.found}$" if verdict.found else ", $P$ not known"


def _columns(labels: Sequence[str], width: float) -> int:
    """Return how many columns of a legend have room in a width [inches]."""
    points = max(size_of_text(label, FontProperties(size=LEGEND_POINTS))[0] for label in labels)
    fitting = int((POINTS_PER_INCH * width - LEGEND_POINTS) / (points + LINE_POINTS))
    return max(1, min(len(labels), 3, fitting))


def _curve(bound: AnyBoundFunction, canvas: Canvas, *others: AnyBoundFunction) -> AxisCurve:
    """Return values along the axis, to where others have roots too, and what is known of its poles."""
    band, judged = canvas.band_of(bound.source.model), None
    if band is None:
        judged = roots_if_found(bound)
        low, high = default_band(judged, *map(roots_if_found, others))
        band = low / WIDENED, high * WIDENED
    low, high = band
    located = roots_if_found(bound, Band(Fraction(low), Fraction(high)), judged)
    if canvas.band_hz is None and not any(root.is_zero for root in located.poles):
        low *= AT_REST
    high /= AT_REST if canvas.band_hz is None and bound.is_rational else 1.0
    response = respond(bound, adaptive_grid(bound, low, high, roots=located), located)
    return AxisCurve.of(
        response.frequency_hz, np.array(response.values, dtype=np.complex128), located.verdict
    )


def _network_curve(loop: NetworkLoop, gain: Fraction, canvas: Canvas) -> AxisCurve:
    """Return the loop gain of a network along the axis, and what is known of the open loop's poles."""
    still = Fraction(0)
    low, high = canvas.band_of(loop.model) or default_band(closed_loop_roots(loop, still))
    located = closed_loop_roots(loop, still, Band(Fraction(low), Fraction(high)))

    def values(omega: npt.NDArray[np.float64]) -> npt.NDArray[np.complex128]:
        return np.array(loop.gains(gain, omega.tolist()), dtype=np.complex128)

    omega = grid_about(located, values, low, high)
    return AxisCurve.of(omega / (2 * np.pi), values(omega), located.verdict)


def _reach(values: npt.NDArray[np.complex128], *, is_loop: bool) -> float:
    """Return half the side of a square that shows -1, or a curve but for what most of it is far below."""
    largest = float(np.max(np.abs(values))) if values.size else 1.0
    if is_loop:
        return min(max(1.1 * largest, REACHES[0]), REACHES[1])
    return 1.1 * min(largest, PEAKED * float(np.quantile(np.abs(values), 0.9))) or 1.0


def point_along(
    axes: Axes, values: npt.NDArray[np.complex128], colour: str, least: float = 0.0, size: float = 12
) -> None:
    """Draw an arrow halfway along the part of a curve that is shown, if that is long enough."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    half_width, half_height = (right - left) / 2, (high - low) / 2
    across = np.abs(values.real - (left + right) / 2) / half_width
    upwards = np.abs(values.imag - (low + high) / 2) / half_height
    shown = np.flatnonzero(np.maximum(across, upwards) < WITHIN)
    steps = np.abs(np.diff(values[shown])) if shown.size > 2 else np.array([])  # noqa: PLR2004 (two steps at least)
    if not steps.size or not float(steps.sum()) > least:
        return
    middle = int(np.searchsorted(np.cumsum(steps), 0.4 * float(steps.sum())))
    i = int(shown[min(middle, shown.size - 2)])
    a, step = values[i], values[min(i + 1, values.size - 1)] - values[i]
    # Its head alone: the next value may be far outside.
    b = a + 0.01 * min(half_width, half_height) * step / abs(step)
    look = {"arrowstyle": "-|>", "mutation_scale": size, "linewidth": 0, "color": colour}
    axes.annotate("", (b.real, b.imag), (a.real, a.imag), arrowprops=look)
