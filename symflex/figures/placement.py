"""Where notes and arrows of a pole-zero panel go so that they cover no root.

Input: marks, and rectangles tried one after another, in points from the panel's lower left corner.
Output: the first that is free of marks, or the one that covers fewest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.figures.s_plane import View

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
