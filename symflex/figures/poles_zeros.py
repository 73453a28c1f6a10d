"""Pole-zero arrays: one panel per transfer function, equal scales on both axes and in all panels.

A :class:`View` is the part of the s plane that holds the resonances which belong together. A :class:`Panel`
takes rectangles for notes on the rest, in points from its lower left corner, and says which covers fewest
roots.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import atan2, ceil, isclose, pi
from typing import TYPE_CHECKING, Final, Literal

from symflex.figures.axes import FREE, draw_points, draw_zero_lines, point_of, set_round_ticks
from symflex.figures.style import (
    COLOURS,
    COLUMN_INCHES,
    LINE_INCHES,
    NOTE_POINTS,
    PAGE_INCHES,
    label_of_tf,
    new_figure,
    stability_lines,
    title_lines,
    write_titles,
)
from symflex.roots import Band
from symflex.roots.locate import locate

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from symflex.figures.axes import Canvas
    from symflex.roots import PoleZeroMap
    from symflex.transfer import BoundTransferFunction, TransferFunction


PANELS_IN_COLUMN: Final = 3
PANELS_ON_PAGE: Final = 4
LEFT, RIGHT, BOTTOM, TOP, GAP = 0.54, 0.15, 0.38, 0.20, 0.24
NARROWEST, WIDEST = 0.6, 1.25
TALLEST_INCHES: Final = 2.6
LISTED: Final = 5
"""Roots that are named at one arrow; of the others their number is told."""
NOTE_LINE_POINTS: Final = 7.5
GLYPHS: Final = {"pole": r"$\times$", "zero": r"$\circ$"}
COLOUR_OF: Final = {"pole": COLOURS[1], "zero": COLOURS[0]}


def draw_poles_zeros(
    tfs: Sequence[TransferFunction], bounds: Sequence[BoundTransferFunction], canvas: Canvas
) -> Figure:
    """Draw poles (crosses) and zeros (circles); see :func:`symflex.figures.draw`.

    All panels show the same part of the s plane. A root outside it is named at the border where the ray from
    the origin to it leaves the panel. A multiple root carries its multiplicity. Of distributed systems the
    default modes are shown, as far up as the highest pole, or those up to the end of a band, and all poles in
    the right half plane. Within limits asked for, scales may differ, and the title counts what is outside.
    What it says of stability holds for all poles, drawn or not.
    """
    band_hz, frame = canvas.band_hz, canvas.frame
    region = None if band_hz is None else Band(Fraction(0), Fraction(band_hz[1]))
    maps = [locate(bound, region if bound.is_distributed else None) for bound in bounds]
    panels = [marks_of(found) for found in maps]
    count = len(panels)
    width = canvas.width or (COLUMN_INCHES if count <= PANELS_IN_COLUMN else PAGE_INCHES)
    columns = min(count, PANELS_IN_COLUMN if width < (COLUMN_INCHES + PAGE_INCHES) / 2 else PANELS_ON_PAGE)
    rows = ceil(count / columns)
    room = (width - LEFT - RIGHT - GAP * (columns - 1)) / columns
    narrowest = min(NARROWEST, room / 1.3)
    view = choose_view(
        [mark for marks in panels for mark in marks],
        _highest_pole(maps) if band_hz is None else band_hz[1],
        (narrowest, WIDEST),
    )
    is_asked = frame != FREE
    if is_asked:
        view = View(frame.x or view.re, frame.y or view.im, frozenset())
    shape = min(max(view.ratio, narrowest), WIDEST) if is_asked else view.ratio
    panel_width = min(room, TALLEST_INCHES * shape)
    panel_height = panel_width / shape
    outside = [_said_of_rest(found, view) for found in maps] if is_asked else []
    titles = (
        title_lines(canvas.title, width),
        stability_lines(maps, width),
        [line for said in outside if said for line in title_lines(said, width)],
    )
    lines = [line for group in titles for line in group]
    above = LINE_INCHES * len(lines) + (0.04 if lines else 0)
    height = above + rows * (TOP + panel_height + BOTTOM)
    figure = new_figure(width, height)
    # Panels narrower than their room stand in the middle.
    start = LEFT + (width - LEFT - RIGHT - columns * panel_width - (columns - 1) * GAP) / 2
    for i, (tf, marks) in enumerate(zip(tfs, panels, strict=True)):
        row, column = divmod(i, columns)
        x = start + column * (panel_width + GAP)
        y = height - above - (row + 1) * (TOP + panel_height) - row * BOTTOM
        box = (x / width, y / height, panel_width / width, panel_height / height)
        axes = figure.add_axes(box)
        _draw_panel(axes, marks, view, panel_width, panel_height)
        if is_asked:
            axes.set_aspect("auto")
        else:
            panel = Panel(view, panel_width, tuple(mark.s for mark in marks if view.shows(mark)))
            for group in leaving(marks, view):
                _point_outside(axes, group, panel)
        axes.set_title(label_of_tf(tf), pad=4)
        axes.set_xlabel(r"$\mathrm{Re}(s)$ [rad/s]", labelpad=2)
        if column == 0:
            axes.set_ylabel(r"$\mathrm{Im}(s)$ [rad/s]", labelpad=1)
        else:
            axes.tick_params(labelleft=False)
    write_titles(figure, titles, 0.04, height)
    return figure


def _highest_pole(maps: Sequence[PoleZeroMap]) -> float | None:
    """Return up to which frequency [Hz] poles of distributed systems are known, ``None`` without any."""
    found = [root for each in maps if each.is_infinite for root in each.poles if not root.is_zero]
    # Poles in the right half plane are known wherever they lie; zeros and others only as far as the rest.
    found = [root for root in found if not root.re > 0] or found
    return max((root.frequency_hz() for root in found), default=None)


def _draw_panel(axes: Axes, marks: Sequence[RootMark], view: View, width: float, height: float) -> None:
    axes.set_xlim(*view.re)
    axes.set_ylim(*view.im)
    axes.set_aspect("equal", adjustable="box")
    draw_zero_lines(axes)
    set_round_ticks(axes, max(2, int(width / 0.36)), max(2, int(height / 0.32)))
    inside = [mark for mark in marks if view.shows(mark)]
    for kind, shape, size in (("zero", "o", 4.6), ("pole", "x", 4.8)):
        chosen = [mark.s for mark in inside if mark.kind == kind]
        draw_points(axes, chosen, (shape, COLOUR_OF[kind], size), is_cut=False)
    panel = Panel(view, width, tuple(mark.s for mark in inside))
    for mark in inside:
        if mark.multiplicity > 1:
            _write_number(axes, mark, panel)


def _said_of_rest(found: PoleZeroMap, view: View) -> str:
    """Return how many of the roots found lie outside the limits that were asked for."""
    counts = {
        kind: sum(m.multiplicity for m in marks_of(found) if m.kind == kind and not view.shows(m))
        for kind in GLYPHS
    }
    said = [f"{n} {kind}{'s' if n > 1 else ''}" for kind, n in counts.items() if n]
    return f"{found.tf}: {' and '.join(said)} outside" if said else ""


def _write_number(axes: Axes, mark: RootMark, panel: Panel) -> None:
    """Write a multiplicity in the corner beside its mark where no other root stands."""
    x, y = panel.at(mark.s)
    width = text_width(str(mark.multiplicity), NOTE_POINTS)
    corners = [(right, up) for up in (2.0, -2.0 - NOTE_POINTS) for right in (3.6, -3.6 - width)]
    others = Panel(panel.view, panel.width, tuple(s for s in panel.roots if s != mark.s))
    boxes = [(x + dx, y + dy, x + dx + width, y + dy + NOTE_POINTS) for dx, dy in corners]
    axes.annotate(
        str(mark.multiplicity),
        (mark.s.real, mark.s.imag),
        corners[others.clearest(boxes)],
        textcoords="offset points",
        va="bottom",
        color=COLOUR_OF[mark.kind],
        fontsize=NOTE_POINTS,
    )


def _point_outside(axes: Axes, group: Sequence[RootMark], panel: Panel) -> None:
    """Draw an arrow to where roots outside the view lie, and name those of the upper half plane beside it."""
    view = panel.view
    tip = view.border(group[0].s)
    tail = tip - panel.free_length(tip, 0.13 * min(view.width, view.height)) * group[0].s / abs(group[0].s)
    axes.annotate(
        "",
        (tip.real, tip.imag),
        (tail.real, tail.imag),
        arrowprops={
            "arrowstyle": "-|>",
            "mutation_scale": 6,
            "linewidth": 0.7,
            "color": "black",
            "shrinkA": 0,
            "shrinkB": 0,
        },
    )
    if group[0].s.imag < 0:
        return
    notes = [(f"{GLYPHS[m.kind]} {m.value}", COLOUR_OF[m.kind]) for m in group[:LISTED]]
    if len(group) > LISTED:
        notes.append((f"and {len(group) - LISTED} more", "black"))
    is_sideways = abs(group[0].s.imag) * view.width < abs(group[0].s.real) * view.height
    is_right = tip.real > 0 if is_sideways else False
    # At the sides the lines stand above or below the arrow, or behind it, else to its right or left.
    x, y = panel.at(tip)
    wide = max(text_width(text, NOTE_POINTS) for text, _ in notes)
    high = NOTE_LINE_POINTS * len(notes)
    if is_sideways:
        end_x, end_y = panel.at(tail)
        inward = -0.8 if is_right else 0.8
        starts = [
            (1.5 * inward, 4.0 + high),
            (1.5 * inward, -6.0),
            (end_x - x + inward, end_y - y + high / 2),
        ]
    else:
        starts = [(5.0, -2.0), (-5.0, -2.0)]
    sides = [is_right] * 3 if is_sideways else [False, True]
    boxes = [
        (x + dx - (wide if left else 0), y + dy - high, x + dx + (0 if left else wide), y + dy)
        for (dx, dy), left in zip(starts, sides, strict=True)
    ]
    chosen = panel.clearest(boxes)
    is_right = sides[chosen]
    for i, (text, colour) in enumerate(notes):
        offset = (starts[chosen][0], starts[chosen][1] - NOTE_LINE_POINTS * i)
        axes.annotate(
            text,
            (tip.real, tip.imag),
            offset,
            textcoords="offset points",
            ha="right" if is_right else "left",
            va="top",
            fontsize=NOTE_POINTS,
            color=colour,
        )


GAP_RATIO: Final = 5.0
"""Neighbouring natural frequencies further apart than this do not belong together."""
REAL_REACH: Final = 2.5
"""Real roots are shown up to so many times the highest resonance shown."""
UNSTABLE_REACH: Final = 10.0
"""Poles in the right half plane are shown up to so many times what else is; the others at the border."""
MARGIN: Final = 0.2
"""Room around the roots shown, over their size."""
MARGIN_FOR_NOTES: Final = 0.5
"""The same at a side where notes name the roots outside."""
LEFT_SHARE: Final = 0.65
"""Of room that is to be added, how much goes to the left, where stable poles lie."""
RIM: Final = (0.95, 1.03)
"""A root so near the frame, relative to its distance from the origin, would be cut by it."""
WIDER: Final = 1.085
WIDENINGS: Final = 8
"""Times the view may be widened so that no root is cut by its frame."""
SAME_DIRECTION: Final = pi / 30
"""Roots outside within six degrees share an arrow."""
PLAIN_LIMIT: Final = 1e5


@dataclass(frozen=True, slots=True)
class RootMark:
    """A pole or zero at ``s`` [rad/s]."""

    kind: Literal["pole", "zero"]
    s: complex
    multiplicity: int = 1

    @property
    def value(self) -> str:
        r"""The root in four digits, with its conjugate, in matplotlib's mathematics.

        Examples
        --------
        >>> RootMark("zero", complex(-1989.6, 0)).value, RootMark("pole", complex(0, 1516.54), 2).value
        ('$-1990$', '$\\pm 1517\\,\\mathrm{j}$ (2)')
        """
        re = _number(self.s.real) if self.s.real or not self.s.imag else ""
        im = rf"\pm {_number(abs(self.s.imag))}\,\mathrm{{j}}" if self.s.imag else ""
        times = f" ({self.multiplicity})" if self.multiplicity > 1 else ""
        return f"${re}{im}${times}"


@dataclass(frozen=True, slots=True)
class View:
    """A rectangle of the s plane [rad/s] that holds the origin, and what it shows."""

    # re and im: Limits.
    re: tuple[float, float]
    im: tuple[float, float]
    shown: frozenset[complex]  # the roots that were chosen to be seen

    @property
    def width(self) -> float:
        """Extent along the real axis [rad/s]."""
        return self.re[1] - self.re[0]

    @property
    def height(self) -> float:
        """Extent along the imaginary axis [rad/s]."""
        return self.im[1] - self.im[0]

    @property
    def ratio(self) -> float:
        """Width over height."""
        return self.width / self.height

    def shows(self, mark: RootMark) -> bool:
        """Whether a root is drawn where it is, not named at the border."""
        inside = self.re[0] <= mark.s.real <= self.re[1] and self.im[0] <= mark.s.imag <= self.im[1]
        return inside or mark.s in self.shown

    def border(self, s: complex) -> complex:
        """Return where the ray from the origin to a point outside leaves the view."""
        scales = []
        if s.real:
            scales.append(self.re[s.real > 0] / s.real)
        if s.imag:
            scales.append(self.im[s.imag > 0] / s.imag)
        return s * min(scales)


def marks_of(found: PoleZeroMap) -> tuple[RootMark, ...]:
    """Return the poles and zeros of a transfer function in double precision."""
    poles = tuple(RootMark("pole", point_of(root), root.multiplicity) for root in found.all_poles)
    return poles + tuple(RootMark("zero", point_of(root), root.multiplicity) for root in found.zeros)


def choose_view(marks: Sequence[RootMark], high_hz: float | None, ratios: tuple[float, float]) -> View:
    """Choose the part of the s plane to show.

    It shows the roots up to the natural frequency ``high_hz`` [Hz]; without it, the resonances from the
    lowest on, as far as no gap separates them, and the real roots of their size. ``ratios`` are the smallest
    and the largest width over height.

    Examples
    --------
    >>> marks = [RootMark("pole", s) for s in (-2 + 70j, -2 - 70j, -5000 + 0j)]
    >>> view = choose_view(marks, None, (0.6, 1.8))
    >>> view.shows(marks[0]), view.shows(marks[2]), view.re[0] > -150
    (True, False, True)
    """
    points = {mark.s for mark in marks}
    shown = _belonging_together(points)
    if high_hz is not None:
        shown = {s for s in points if abs(s) <= 2 * pi * high_hz}
    size = max((abs(s) for s in shown), default=0.0) or 1.0
    unstable = {m.s for m in marks if m.kind == "pole" and m.s.real > 0 and abs(m.s) <= UNSTABLE_REACH * size}
    shown |= unstable
    size = max(size, *map(abs, unstable)) if unstable else size
    tallest = max((abs(s.imag) for s in shown), default=0.0)
    outside = points - shown
    has_notes_above = any(abs(s.imag) > abs(s.real) for s in outside)
    half = (1 + (MARGIN_FOR_NOTES if has_notes_above else MARGIN)) * tallest or size / 2
    left = min((s.real for s in shown), default=0.0)
    right = max((s.real for s in shown), default=0.0)
    sideways = [s for s in outside if abs(s.real) >= abs(s.imag)]
    beyond_left, beyond_right = (
        MARGIN_FOR_NOTES if any(sign * s.real > 0 for s in sideways) else MARGIN for sign in (-1, 1)
    )
    left, right = min(left, 0.0) - beyond_left * size, max(right, 0.0) + beyond_right * size
    missing = ratios[0] * 2 * half - (right - left)
    if missing > 0:
        share = 0.5 if any(s.real > 0 for s in points) else LEFT_SHARE
        left, right = left - share * missing, right + (1 - share) * missing
    half = max(half, (right - left) / ratios[1] / 2)
    view = View((left, right), (-half, half), frozenset(shown))
    for _ in range(WIDENINGS):
        if not any(RIM[0] < abs(s) / abs(view.border(s)) < RIM[1] for s in points if s):
            break
        (left, right), (low, high) = view.re, view.im
        view = View((WIDER * left, WIDER * right), (WIDER * low, WIDER * high), view.shown)
    return view


def leaving(marks: Iterable[RootMark], view: View) -> list[list[RootMark]]:
    """Return the roots outside the view in groups of about one direction, the nearest first."""
    groups: list[list[RootMark]] = []
    for mark in sorted((m for m in marks if not view.shows(m)), key=lambda m: abs(m.s)):
        angle = atan2(mark.s.imag, mark.s.real)
        for group in groups:
            if isclose(angle, atan2(group[0].s.imag, group[0].s.real), abs_tol=SAME_DIRECTION):
                group.append(mark)
                break
        else:
            groups.append([mark])
    return groups


def _belonging_together(points: set[complex]) -> set[complex]:
    resonant = [s for s in points if s.imag]
    radius = _first_run([abs(s) for s in resonant or points if s])
    reach = REAL_REACH * radius if resonant else radius
    return {s for s in points if abs(s) <= (radius if s.imag else reach)}


def _first_run(sizes: Iterable[float]) -> float:
    """Return the last of the sizes, in ascending order, before the first large gap; 0 when there is none."""
    reached = 0.0
    for size in sorted(sizes):
        if reached and size > GAP_RATIO * reached:
            break
        reached = size
    return reached


def _number(value: float) -> str:
    text = f"{value:.0f}" if 1e3 <= abs(value) < PLAIN_LIMIT else f"{value:.4g}"  # noqa: PLR2004 (four digits)
    if "e" not in text:
        return text if abs(value) < 1e4 else rf"{text[:-3]}\,{text[-3:]}"  # noqa: PLR2004 (five digits)
    mantissa, exponent = text.split("e")
    return rf"{mantissa}\cdot 10^{{{int(exponent)}}}"


POINTS_PER_INCH: Final = 72.0
MARK_POINTS: Final = 3.2
"""Half the size of a cross or circle, with its line."""
LETTER: Final = 0.5
"""Mean width of a letter over the font's size."""

Box = tuple[float, float, float, float]
"""Left, bottom, right, top [points]."""


@dataclass(frozen=True, slots=True)
class Panel:
    """A panel of a given size that shows a view, and the roots drawn in it.

    Examples
    --------
    >>> from symflex.figures.poles_zeros import View
    >>> panel = Panel(View((-10.0, 10.0), (-10.0, 10.0), frozenset()), 1.0, (5 + 0j,))
    >>> panel.at(5 + 0j)
    (54.0, 36.0)
    >>> panel.clearest([(50.0, 30.0, 60.0, 40.0), (0.0, 30.0, 10.0, 40.0)])
    1
    """

    view: View  # what it shows
    width: float  # [inches]; both axes have the same scale
    roots: tuple[complex, ...]  # drawn in it [rad/s]

    @property
    def scale(self) -> float:
        """Points per rad/s."""
        return POINTS_PER_INCH * self.width / self.view.width

    def at(self, s: complex) -> tuple[float, float]:
        """Return where a root stands [points]."""
        return (s.real - self.view.re[0]) * self.scale, (s.imag - self.view.im[0]) * self.scale

    def clearest(self, boxes: Sequence[Box]) -> int:
        """Return which of several rectangles covers fewest roots, the first of equals."""
        return min(range(len(boxes)), key=lambda i: self._covered(boxes[i]))

    def _covered(self, box: Box) -> int:
        left, bottom, right, top = box
        places = map(self.at, self.roots)
        return sum(
            left - MARK_POINTS < x < right + MARK_POINTS and bottom - MARK_POINTS < y < top + MARK_POINTS
            for x, y in places
        )

    def free_length(self, tip: complex, longest: float) -> float:
        """Return how long an arrow to ``tip`` along the ray from 0 may be before it meets a root [rad/s]."""
        direction = tip / abs(tip)
        room = longest
        for root in self.roots:
            along = ((tip - root) * direction.conjugate()).real
            aside = abs(((tip - root) * direction.conjugate()).imag)
            if 0 < along < room + MARK_POINTS / self.scale and aside < MARK_POINTS / self.scale:
                room = along - 1.5 * MARK_POINTS / self.scale
        return max(room, 0.25 * longest)


def text_width(text: str, size: float) -> float:
    """Return about how wide a line of mathematics is [points]."""
    shown = text.replace("\\,", "").replace("\\mathrm{j}", "j").replace("$", "")
    for sign in (r"\pm", r"\times", r"\circ"):
        shown = shown.replace(sign, "+")
    return LETTER * size * len(shown)
