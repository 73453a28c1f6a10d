"""The part of the s plane that a figure shows, and notes at its border on the roots outside.

Input: poles and zeros in double precision. Output: a :class:`View` that holds the resonances which belong
together. A :class:`Panel` shows one, and takes rectangles for notes on the rest, in points from its lower
left corner:

    poles at +-70j and -5000      the view holds +-70j; an arrow at its left border says "-5000"
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, isclose, pi
from typing import TYPE_CHECKING, Final, Literal

from matplotlib.font_manager import FontProperties

from symflex.figures.axes import point_of, root_figure
from symflex.figures.style import NOTE_POINTS, size_of_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from matplotlib.axes import Axes

    from symflex.roots import PoleZeroMap


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
ROUNDING: Final = 1e-12
"""Of a root's size: what four operations in doubles may leave, with room."""


Kind = Literal["pole", "zero", "nominal", "last"]


@dataclass(frozen=True, slots=True)
class RootMark:
    """A pole or zero."""

    # A pole, or in a locus one at the first gain; a zero; a pole at the gain's own value and at the last.
    kind: Kind
    s: complex  # where [rad/s]
    multiplicity: int = 1

    @property
    def value(self) -> str:
        r"""The root in four digits, with its conjugate, in matplotlib's mathematics.

        Examples
        --------
        >>> RootMark("zero", complex(-1989.6, 0)).value, RootMark("pole", complex(0, 1516.54), 2).value
        ('$-1990$', '$\\pm 1517\\,\\mathrm{j}$ (2)')
        """
        # A part that is nothing but rounding is not printed.
        is_imaginary = self.s.imag and abs(self.s.real) < ROUNDING * abs(self.s)
        re = "" if is_imaginary else _number(self.s.real)
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


def choose_view(
    marks: Sequence[RootMark],
    high_hz: float | None,
    ratios: tuple[float, float],
    chosen: set[complex] | None = None,
) -> View:
    """Choose the part of the s plane to show.

    It shows the roots up to the natural frequency ``high_hz`` [Hz]; without it, those ``chosen``, or the
    resonances from the lowest on, as far as no gap separates them, and the real roots of their size.
    ``ratios`` are the smallest and the largest width over height.

    Examples
    --------
    >>> marks = [RootMark("pole", s) for s in (-2 + 70j, -2 - 70j, -5000 + 0j)]
    >>> view = choose_view(marks, None, (0.6, 1.8))
    >>> view.shows(marks[0]), view.shows(marks[2]), view.re[0] > -150
    (True, False, True)
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
    radius = first_run([abs(s) for s in resonant or points if s])
    reach = REAL_REACH * radius if resonant else radius
    return {s for s in points if abs(s) <= (radius if s.imag else reach)}


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
MARK_POINTS: Final = 3.2
"""Half the size of a cross or circle, with its line."""
PAD_POINTS: Final = 1.5
"""Between a note and the frame."""
LISTED: Final = 5
"""Roots that are named at one arrow; of the others their number is told."""
NOTE_LINE_POINTS: Final = 7.5
LEAST_NOTE_POINTS: Final = 4.5
ARROW: Final = 0.13
"""Length of an arrow over the smaller side of its panel."""
SHIFTS: Final = 8
"""How many heights of a note it may be moved from its arrow to where nothing stands."""
NOTE_COST, SHAFT_COST, SHIFT_COST = 8.0, 2.0, 0.3
"""What covers another note, or an arrow, weighs as much as so many roots; so does a shift."""
GLYPHS: Final[dict[Kind, str]] = {"pole": r"$\times$", "zero": r"$\circ$", "nominal": r"$\star$"}
"""Of roots that are named at an arrow; to poles at the last gain of a locus its curves lead."""

Box = tuple[float, float, float, float]
"""Left, bottom, right, top [points]."""


@dataclass(frozen=True, slots=True)
class Panel:
    """A panel of a given size that shows a view, and the roots drawn in it.

    Examples
    --------
    >>> from symflex.figures.s_plane import View
    >>> panel = Panel(View((-10.0, 10.0), (-10.0, 10.0), frozenset()), 1.0, 1.0, (5 + 0j,))
    >>> panel.at(5 + 0j)
    (54.0, 36.0)
    >>> panel.clearest([(50.0, 30.0, 60.0, 40.0), (0.0, 30.0, 10.0, 40.0)])
    1
    """

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

    def s_at(self, place: complex) -> complex:
        """Return which s stands at a place, x + j y [points]."""
        wide, high = self.size
        re = self.view.re[0] + self.view.width * place.real / wide
        return complex(re, self.view.im[0] + self.view.height * place.imag / high)

    def clearest(self, boxes: Sequence[Box], taken: Sequence[Box] = (), shaft: Box | None = None) -> int:
        """Return which of several rectangles covers fewest roots, notes and the arrow; the first of equals.

        A later one in the list is further from where it belongs.
        """

        def cost(i: int) -> float:
            notes = sum(_overlap(boxes[i], other) for other in taken)
            arrow = shaft is not None and _overlap(boxes[i], shaft)
            return self._covered(boxes[i]) + NOTE_COST * notes + SHAFT_COST * arrow + SHIFT_COST * (i // 3)

        return min(range(len(boxes)), key=cost)

    def _covered(self, box: Box) -> int:
        left, bottom, right, top = box
        places = map(self.at, self.roots)
        return sum(
            left - MARK_POINTS < x < right + MARK_POINTS and bottom - MARK_POINTS < y < top + MARK_POINTS
            for x, y in places
        )

    def held(self, left: float, bottom: float, wide: float, high: float) -> Box:
        """Return a rectangle of a size, moved into the panel."""
        across, upwards = self.size
        x = max(PAD_POINTS, min(left, across - wide - PAD_POINTS))
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


def point_outside(axes: Axes, marks: Sequence[RootMark], panel: Panel, colours: Mapping[Kind, str]) -> None:
    """Draw arrows to where roots outside the view lie, and name those of the upper half plane beside them."""
    taken: list[Box] = []
    for group in leaving((mark for mark in marks if mark.kind in GLYPHS), panel.view):
        shaft = _draw_arrow(axes, group[0].s, panel)
        if not group[0].s.imag < 0:
            taken.append(_write_notes(axes, group, shaft, panel, taken, colours))


def _draw_arrow(axes: Axes, s: complex, panel: Panel) -> tuple[complex, complex]:
    """Return tail and tip of an arrow to a root outside [points]."""
    tip = panel.view.border(s)
    end = complex(*panel.at(tip))
    ray = end - complex(*panel.at(0j))
    start = end - panel.free_length(tip, ARROW * min(panel.size)) * ray / abs(ray)
    tail = panel.s_at(start)
    look = {"arrowstyle": "-|>", "mutation_scale": 6, "linewidth": 0.7, "color": "black"}
    axes.annotate(
        "",
        (tip.real, tip.imag),
        (tail.real, tail.imag),
        arrowprops={**look, "shrinkA": 0, "shrinkB": 0},
    ).set_in_layout(False)
    return start, end


def _write_notes(
    axes: Axes,
    group: Sequence[RootMark],
    shaft: tuple[complex, complex],
    panel: Panel,
    taken: Sequence[Box],
    colours: Mapping[Kind, str],
) -> Box:
    """Write which roots lie where an arrow points, beside it and within the panel."""
    notes = [(f"{GLYPHS[m.kind]} {m.value}", colours[m.kind]) for m in group[:LISTED]]
    if len(group) > LISTED:
        notes.append((f"and {len(group) - LISTED} more", "black"))
    wide = max(text_width(text, NOTE_POINTS) for text, _ in notes)
    size = max(LEAST_NOTE_POINTS, NOTE_POINTS * min(1.0, (panel.size[0] - 2 * PAD_POINTS) / wide))
    wide, line = wide * size / NOTE_POINTS, NOTE_LINE_POINTS * size / NOTE_POINTS
    high = line * len(notes)
    tail, tip = shaft
    is_sideways = abs((tip - tail).real) > abs((tip - tail).imag)
    low, top = sorted((tail.imag, tip.imag))
    left, right = sorted((tail.real, tip.real))
    inward = tip.real - wide if tip.real > panel.size[0] / 2 else tip.real
    if is_sideways:
        behind = tail.real - wide - 4 if tip.real > tail.real else tail.real + 4
        places = [(inward, top + 4.0), (inward, low - 6.0 - high), (behind, tail.imag - high / 2)]
    else:
        places = [
            (right + 5.0, tip.imag - high),
            (left - 5.0 - wide, tip.imag - high),
            (inward, low - high - 2),
        ]
    boxes = [
        panel.held(x, y + sign * shift * high, wide, high)
        for shift in range(SHIFTS)
        for sign in ((1, -1) if shift else (1,))
        for x, y in places
    ]
    chosen = boxes[panel.clearest(boxes, taken, (left - 2, low - 2, right + 2, top + 2))]
    for i, (text, colour) in enumerate(notes):
        axes.annotate(
            text,
            (chosen[0], chosen[3] - line * i),
            xycoords="axes points",
            ha="left",
            va="top",
            fontsize=size,
            color=colour,
        ).set_in_layout(False)
    return chosen
