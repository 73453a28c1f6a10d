"""The part of the s plane that a figure shows, and notes at its border on the roots outside.

Input: poles and zeros in double precision. Output: a :class:`View` that contains the resonances which belong
together. A :class:`Panel` shows one, and takes rectangles for notes on the rest, in points from its lower
left corner:

    poles at +-70j and -5000      the view holds +-70j; an arrow at its left border says "-5000"
"""

from __future__ import annotations

from cmath import phase
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isclose, pi
from typing import TYPE_CHECKING, Final, Literal

from matplotlib.axes import Axes
from matplotlib.font_manager import FontProperties

from symflex.figures.axes import point_of, root_figure
from symflex.figures.style import NOTE_POINTS, size_of_text

if TYPE_CHECKING:
    from symflex.roots import PoleZeroMap, Root


GAP_RATIO: Final = 5.0  # neighbouring natural frequencies further apart than this do not belong together
DECADES: Final = 100.0  # resonances are shown up to so many times the lowest
CROWDED: Final = 0.15  # roots nearer to 0 than this share of those shown are one blot: an inset shows them
REAL_REACH: Final = 2.5  # real roots are shown up to so many times the highest resonance shown
UNSTABLE_REACH: Final = 10.0  # unstable poles are shown up to so many times all else, others at the border
MARGIN: Final = 0.2  # room around the roots shown, over their size
MARGIN_FOR_NOTES: Final = 0.5  # the same at a side where notes name the roots outside
RIM: Final = (0.95, 1.03)  # a root so near the frame, relative to its distance from 0, would be cut by it
WIDER: Final = 1.085
WIDENINGS: Final = 8  # times the view may be widened so that no root is cut by its frame
PLAIN_LIMIT: Final = 1e5
ROUNDING: Final = 1e-12  # share of a root's size that four operations in doubles may lose, with room


Kind = Literal["pole", "zero", "nominal", "last"]


@dataclass(frozen=True, slots=True)
class RootMark:
    """A pole or zero."""

    # A pole, or in a locus one at the first gain; a zero; a pole at the nominal gain and at the last.
    kind: Kind
    s: complex  # where [rad/s]
    multiplicity: int = 1

    @property
    def value(self) -> str:
        """The root in four digits, with its conjugate, in matplotlib's mathematics."""
        # A part that is nothing but rounding is not printed.
        is_imaginary = self.s.imag and abs(self.s.real) < ROUNDING * abs(self.s)
        re = "" if is_imaginary else _number(self.s.real)
        im = rf"\pm {_number(abs(self.s.imag))}\,\mathrm{{j}}" if self.s.imag else ""
        times = f" ({self.multiplicity})" if self.multiplicity > 1 else ""
        return f"${re}{im}${times}"


@dataclass(frozen=True, slots=True)
class View:
    """A rectangle of the s plane [rad/s] that contains the origin, and what it shows."""

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
        parts = ((self.re, s.real), (self.im, s.imag))
        return s * min(ends[part > 0] / part for ends, part in parts if part)


def marks_of(located: PoleZeroMap) -> tuple[RootMark, ...]:
    """Return the poles and zeros of a transfer function in double precision."""
    roots: list[tuple[Kind, Root]] = [("pole", root) for root in located.all_poles]
    roots += [("zero", root) for root in located.zeros]
    return tuple(RootMark(kind, point_of(root), root.multiplicity) for kind, root in roots)


def choose_view(
    marks: Sequence[RootMark],
    high_hz: float | None,
    ratios: tuple[float, float],
    chosen: set[complex] | None = None,
) -> View:
    """Choose the part of the s plane to show.

    It shows the roots up to the natural frequency ``high_hz`` [Hz]; without it, those ``chosen``, or the
    resonances up to a hundred times the lowest, and the real roots of their size. ``ratios`` are the smallest
    and the largest width over height.
    """
    points = {mark.s for mark in marks}
    shown = _belonging_together(points) if chosen is None else set(chosen)
    if high_hz is not None:
        shown = {s for s in points if abs(s) <= 2 * pi * high_hz}
    size = max((abs(s) for s in shown), default=0.0) or 1.0
    unstable = {m.s for m in marks if m.kind != "zero" and m.s.real > 0 and abs(m.s) <= UNSTABLE_REACH * size}
    shown |= unstable
    size = max(size, *map(abs, unstable)) if unstable else size
    tallest = max((abs(s.imag) for s in shown), default=0.0)
    outside = points - shown
    has_notes_above = any(abs(s.imag) > abs(s.real) for s in outside)
    half = (1 + (MARGIN_FOR_NOTES if has_notes_above else MARGIN)) * tallest or size / 2
    sideways = {s.real > 0 for s in outside if s.real and abs(s.real) >= abs(s.imag)}
    beyond = [size * (MARGIN_FOR_NOTES if is_right in sideways else MARGIN) for is_right in (False, True)]
    left = min([0.0, *(s.real for s in shown)]) - beyond[0]
    right = max([0.0, *(s.real for s in shown)]) + beyond[1]
    missing = ratios[0] * 2 * half - (right - left)
    if missing > 0:
        share = 0.5 if any(s.real > 0 for s in points) else 0.65  # more to the left, where stable poles lie
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
    """Return the roots outside the view in groups within six degrees, the nearest first."""
    groups: list[list[RootMark]] = []
    for mark in sorted((m for m in marks if not view.shows(m)), key=lambda m: abs(m.s)):
        angle = phase(mark.s)
        alike = (g for g in groups if isclose(angle, phase(g[0].s), abs_tol=pi / 30))
        if not (group := next(alike, [])):
            groups.append(group)
        group.append(mark)
    return groups


def _belonging_together(points: set[complex]) -> set[complex]:
    resonant = [s for s in points if s.imag]
    sizes = [abs(s) for s in resonant or points if s]
    radius = max((size for size in sizes if size < DECADES * min(sizes)), default=0.0)
    reach = REAL_REACH * radius if resonant else radius
    return {s for s in points if abs(s) <= (radius if s.imag else reach)}


def crowded(view: View) -> set[complex]:
    """Return the roots before the first gap, two or more, where a view shows them as one blot."""
    radius = first_run(abs(s) for s in view.shown if s)
    near = {s for s in view.shown if abs(s) <= radius}
    return near if len(near) > 1 and radius < CROWDED * max(map(abs, view.shown)) else set()


def first_run(sizes: Iterable[float]) -> float:
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
MARK_POINTS: Final = 3.2  # half the size of a cross or circle, with its line
PAD_POINTS: Final = 1.5  # space between a note and the frame
LISTED: Final = 5  # roots that one arrow names; the others are counted
NOTE_LINE_POINTS: Final = 8.5
LEAST_NOTE_POINTS: Final = 6.0
ARROW: Final = 0.13  # length of an arrow over the smaller side of its panel
TEXT_COST, SHIFT_COST = 30.0, 0.1  # of covering a text, or a step away from a mark, in covered roots
GRID: Final = 3  # distance of places that are tried for a note [points]
GLYPHS: Final[dict[Kind, str]] = {"pole": r"$\times$", "zero": r"$\circ$", "nominal": r"$\star$"}
"""Signs of roots that are named at an arrow; the curves of a locus lead to poles at the last gain."""
Box = tuple[float, float, float, float]  # left, bottom, right, top [points]


@dataclass(frozen=True, slots=True)
class Panel:
    """A panel of a given size that shows a view, and the roots drawn in it."""

    view: View  # what it shows
    width: float  # [inches]
    height: float  # [inches]
    roots: tuple[complex, ...]  # drawn in it [rad/s]

    @staticmethod
    def of(view: View, width: float, height: float, marks: Iterable[RootMark]) -> Panel:
        """Return a panel with those of the roots that a view shows."""
        return Panel(view, width, height, tuple(mark.s for mark in marks if view.shows(mark)))

    @property
    def size(self) -> tuple[float, float]:
        """Width and height [points]."""
        return POINTS_PER_INCH * self.width, POINTS_PER_INCH * self.height

    def at(self, s: complex) -> tuple[float, float]:
        """Return where a root stands [points]."""
        wide, high = self.size
        x, y = (s.real - self.view.re[0]) / self.view.width, (s.imag - self.view.im[0]) / self.view.height
        return x * wide, y * high

    def s_at(self, point: complex) -> complex:
        """Return which s stands at a place, x + j y [points]."""
        wide, high = self.size
        re = self.view.re[0] + self.view.width * point.real / wide
        return complex(re, self.view.im[0] + self.view.height * point.imag / high)

    def clearest(
        self, boxes: Sequence[Box], texts: Sequence[Box] = (), arrows: Sequence[Box] = (), price: float = 0.0
    ) -> int:
        """Return which rectangle covers fewest texts, roots and arrows; the first ones are preferred."""
        costs = [self.cost(box, texts, arrows) + price * i for i, box in enumerate(boxes)]
        return costs.index(min(costs))

    def cost(self, box: Box, texts: Sequence[Box], arrows: Sequence[Box]) -> float:
        """Return what a rectangle covers, as a number of roots; what leaves the panel counts as a text."""
        left, bottom, right, top = box
        is_beyond = box != self.held(left, bottom, right - left, top - bottom)
        covered = sum(_overlap(box, other) for other in texts) + is_beyond
        near = (left - MARK_POINTS, bottom - MARK_POINTS, right + MARK_POINTS, top + MARK_POINTS)
        roots = sum(_overlap(near, (x, y, x, y)) for x, y in map(self.at, self.roots))
        return roots + sum(_overlap(box, other) for other in arrows) + TEXT_COST * covered

    def held(self, x_wanted: float, bottom: float, wide: float, high: float) -> Box:
        """Return a rectangle of a size, moved into the panel."""
        across, upwards = self.size
        x = max(PAD_POINTS, min(x_wanted, across - wide - PAD_POINTS))
        y = max(PAD_POINTS, min(bottom, upwards - high - PAD_POINTS))
        return x, y, x + wide, y + high

    def free_length(self, tip: complex, longest: float) -> float:
        """Return how long an arrow to ``tip`` along the ray from 0 may be before it meets a root [points]."""
        end = complex(*self.at(tip))
        direction = end - complex(*self.at(0j))
        direction /= abs(direction)
        room = longest
        for root in self.roots:
            apart = (end - complex(*self.at(root))) * direction.conjugate()
            if 0 < apart.real < room + MARK_POINTS and abs(apart.imag) < MARK_POINTS:
                room = apart.real - 1.5 * MARK_POINTS
        return max(room, 0.25 * longest)


def _overlap(a: Box, b: Box) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def inches_of(axes: Axes) -> tuple[float, float]:
    """Return width and height of axes where they stand."""
    box = axes.get_window_extent()
    dots = root_figure(axes).dpi
    return box.width / dots, box.height / dots


def text_width(text: str, size: float) -> float:
    """Return how wide a line with mathematics is [points]."""
    return size_of_text(text, FontProperties(size=size))[0]


def write_notes(
    axes: Axes,
    marks: Sequence[RootMark],
    panel: Panel,
    colours: Mapping[Kind, str],
    numbered: Sequence[RootMark] = (),
    taken: Sequence[Box] = (),
    said: Mapping[complex, str] | None = None,
) -> None:
    """Draw arrows to roots of ``marks`` outside the view, and number those of ``numbered`` in it.

    No text covers another one, or what is ``taken``, as long as there is room.
    """
    groups = leaving((mark for mark in marks if mark.kind in GLYPHS), panel.view)
    shafts = [_draw_arrow(axes, group[0].s, panel) for group in groups]
    notes = _Notes(axes, panel, colours, [_around(*shaft) for shaft in shafts], list(taken))
    for mark in numbered:
        if mark.multiplicity > 1 and panel.view.shows(mark):
            notes.number(mark.s, str(mark.multiplicity), colours[mark.kind])
    for s, text in (said or {}).items():
        notes.number(s, text, "black")
    for group, shaft in zip(groups, shafts, strict=True):
        if not group[0].s.imag < 0:
            notes.name(group, shaft)


def _around(tail: complex, tip: complex) -> Box:
    """Return the rectangle around an arrow with its head."""
    (left, right), (low, top) = sorted((tail.real, tip.real)), sorted((tail.imag, tip.imag))
    return left - 2, low - 2, right + 2, top + 2


def _draw_arrow(axes: Axes, s: complex, panel: Panel) -> tuple[complex, complex]:
    """Return tail and tip of an arrow to a root outside [points]."""
    tip = panel.view.border(s)
    end = complex(*panel.at(tip))
    ray = end - complex(*panel.at(0j))
    start = end - panel.free_length(tip, ARROW * min(panel.size)) * ray / abs(ray)
    tail = panel.s_at(start)
    look = {"arrowstyle": "-|>", "mutation_scale": 6, "linewidth": 0.7, "color": "black"}
    look |= {"shrinkA": 0, "shrinkB": 0}
    drawn = axes.annotate("", (tip.real, tip.imag), (tail.real, tail.imag), arrowprops=look)
    drawn.set_in_layout(False)
    return start, end


@dataclass
class _Notes:
    """Notes on a panel, each where it covers as little as it can."""

    axes: Axes
    panel: Panel
    colours: Mapping[Kind, str]
    arrows: Sequence[Box]
    taken: list[Box] = field(default_factory=list)  # by notes

    def number(self, at: complex, text: str, colour: str) -> None:
        """Write a multiplicity or a gain beside its mark, where it covers nothing if there is a place."""
        x, y = self.panel.at(at)
        wide, high = text_width(text, NOTE_POINTS), NOTE_LINE_POINTS
        others = replace(self.panel, roots=tuple(s for s in self.panel.roots if s != at))
        boxes = [
            (x + dx, y + dy, x + dx + wide, y + dy + high)
            for away in (0.0, high / 2, high, 2 * high)
            for dy in (1.5 + away, -1.5 - high - away, -high / 2)
            for dx in (3.6 + away, -3.6 - wide - away)
        ]
        chosen = boxes[others.clearest(boxes, self.taken, self.arrows, SHIFT_COST)]
        self._write(text, chosen, NOTE_POINTS, colour)
        self.taken.append(chosen)

    def _write(self, text: str, box: Box, size: float, colour: str) -> None:
        """Write a line below the top of a rectangle; in the right half, from its right side leftwards."""
        is_right = box[0] + box[2] > inches_of(self.axes)[0] * POINTS_PER_INCH
        anchor, side = (box[2 if is_right else 0], box[3]), "right" if is_right else "left"
        written = self.axes.annotate(text, anchor, xycoords="axes points", ha=side, va="top", fontsize=size)
        written.set_color(colour)
        written.set_in_layout(False)

    def name(self, group: Sequence[RootMark], shaft: tuple[complex, complex]) -> None:
        """Write which roots lie where an arrow points, in the nearest place where that covers least."""
        panel = self.panel
        notes = [(f"{GLYPHS[m.kind]} {m.value}", self.colours[m.kind]) for m in group[:LISTED]]
        if len(group) > LISTED:
            notes.append((f"and {len(group) - LISTED} more", "black"))
        wide = max(text_width(text, NOTE_POINTS) for text, _ in notes)
        size = max(LEAST_NOTE_POINTS, NOTE_POINTS * min(1.0, (panel.size[0] - 2 * PAD_POINTS) / wide))
        step = NOTE_LINE_POINTS * size / NOTE_POINTS
        across, high = wide * size / NOTE_POINTS, step * len(notes)
        columns, rows = (range(0, max(2, int(panel.size[i] - n)), GRID) for i, n in enumerate((across, high)))
        boxes = [panel.held(x, y, across, high) for x in columns for y in rows]
        boxes.sort(key=lambda b: (abs(complex(b[0] + b[2], b[1] + b[3]) / 2 - shaft[1]), b))
        chosen = boxes[panel.clearest(boxes, self.taken, self.arrows)]
        for i, (text, colour) in enumerate(notes):
            self._write(text, (*chosen[:3], chosen[3] - step * i), size, colour)
        self.taken.append(chosen)
