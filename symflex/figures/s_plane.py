"""Which part of the s plane a pole-zero plot shows, and where notes on the rest cover no root.

Input: poles and zeros. Output: a :class:`View` that holds the resonances that belong together. A
:class:`Panel` takes rectangles, in points from its lower left corner, and says which covers fewest.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, isclose, pi
from typing import TYPE_CHECKING, Final, Literal

from symflex.figures.axes import point_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

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
    text = f"{value:.0f}" if 1e3 <= abs(value) < PLAIN_LIMIT else f"{value:.4g}"  # noqa: PLR2004
    if "e" not in text:
        return text if abs(value) < 1e4 else rf"{text[:-3]}\,{text[-3:]}"  # noqa: PLR2004
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
    >>> from symflex.figures.s_plane import View
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
