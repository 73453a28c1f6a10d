r"""Poles, zeros and modes as rows of tables: what a column shows is written here once, for every page.

    one pair, s = -0.5 +- 3.1 j     terminal    -0.500  +-3.10  4e-16  0.4997  0.159
                                    web page    -0.500 | +-3.10 | 4e-16 | 0.4997 | 0.159 | 1
                                    paper       -0.500 & \pm 3.10 & 0.4997 & 0.159

A column that is added to one of the three lists below is in every table of its kind; in JSON it is a key of
:mod:`symflex.roots.pole_zero_map`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from flint import arb

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.roots import PoleZeroMap, Root
    from symflex.roots.root import RootDecimals

KINDS: Final = {"poles": "pole", "zeros": "zero", "hidden": "hidden root"}
"""What a :class:`~symflex.roots.PoleZeroMap` holds, and what one of it is called."""
_FREQUENCY_BITS: Final = 256


@dataclass(frozen=True, slots=True)
class PrintedRoot:
    """A root to print, alone or for its conjugate pair."""

    root: Root
    is_pair: bool

    def cells(self, columns: Sequence[RootColumn], digits: int) -> list[str]:
        """Return what columns show, in decimals with at most so many certified digits."""
        printed = self.root.decimal(digits)
        return [column.text(self.root, printed, digits) for column in columns]


@dataclass(frozen=True, slots=True)
class RootColumn:
    """A column of tables of roots."""

    name: str  # its head on a web page, the unit aside
    paper: tuple[str, ...]  # its head in LaTeX, line by line
    unit: str  # empty where there is none
    text: Callable[[Root, RootDecimals, int], str]  # a decimal, empty where there is none
    is_exact: Callable[[Root], bool] = lambda _: True  # whether a zero there is one
    is_mirrored: bool = False  # of a conjugate pair it stands for both signs

    @property
    def head(self) -> str:
        """Its head on a web page."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


def roots_of(found: PoleZeroMap, kind: str) -> tuple[Root, ...]:
    """Return the roots that a table of one kind lists: poles in the right half plane wherever they lie."""
    if kind == "hidden":
        return tuple(h.root for h in found.hidden)
    return found.all_poles if kind == "poles" else found.zeros


def one_of_each_pair(roots: Sequence[Root]) -> list[PrintedRoot]:
    """Return every root once, a conjugate pair as the member above the real axis."""
    lower = [r for r in roots if r.im < 0]
    entries = []
    for root in roots:
        if root.im > 0:
            partner = next((r for r in lower if r.im.overlaps(-root.im) and r.re.overlaps(root.re)), None)
            if partner is not None:
                lower.remove(partner)
            entries.append(PrintedRoot(root, partner is not None))
        elif not root.im < 0:
            entries.append(PrintedRoot(root, is_pair=False))
    return entries + [PrintedRoot(root, is_pair=False) for root in lower]


def _frequency(root: Root, printed: RootDecimals, digits: int) -> str:
    """Return the natural frequency abs(s)/(2 pi) [Hz]."""
    from symflex.roots import decimals, precision  # imports numpy

    with precision(max(_FREQUENCY_BITS, root.working_bits())):
        frequency = root.natural_frequency() / (2 * arb.pi())
    return decimals(frequency, arb(0), digits).re


def _angular_frequency(root: Root, printed: RootDecimals, digits: int) -> str:
    """Return abs(s) [rad/s]."""
    from symflex.roots import decimals  # imports numpy

    return decimals(root.natural_frequency(), arb(0), digits).re


def _damping(root: Root, printed: RootDecimals, digits: int) -> str:
    """Return ``-re/abs(s)``, empty at 0 and where s may be 0."""
    from symflex.roots import decimals, precision  # imports numpy

    frequency = root.natural_frequency()
    if root.is_zero or not frequency > 0:
        return ""
    if root.on_imaginary_axis:
        return "0"
    if root.is_real:
        return "1" if root.re < 0 else "-1"
    with precision(max(_FREQUENCY_BITS, root.working_bits())):
        ratio = -root.re / frequency
    return decimals(ratio, arb(0), digits).re


_REAL: Final = RootColumn(
    "Re s",
    ("Re $s$",),
    "rad/s",
    lambda root, printed, digits: printed.re,
    lambda root: root.on_imaginary_axis,
)
_IMAGINARY: Final = RootColumn(
    "Im s",
    ("Im $s$",),
    "rad/s",
    lambda root, printed, digits: printed.im,
    lambda root: root.is_real,
    is_mirrored=True,
)
_RADIUS: Final = RootColumn("radius", ("Radius",), "rad/s", lambda root, printed, digits: printed.radius)
_HERTZ: Final = RootColumn("frequency", ("Frequency",), "Hz", _frequency, lambda root: root.is_zero)
_ANGULAR: Final = RootColumn(
    "frequency", ("Frequency",), "rad/s", _angular_frequency, lambda root: root.is_zero
)
_RATIO: Final = RootColumn(
    "damping ratio", ("Damping", "ratio"), "", _damping, lambda root: root.on_imaginary_axis
)
_TIMES: Final = RootColumn(
    "multiplicity", ("Multi-", "plicity"), "", lambda root, printed, digits: str(root.multiplicity)
)

PAGE_COLUMNS: Final = (_REAL, _IMAGINARY, _RADIUS, _HERTZ, _RATIO, _TIMES)
"""Of tables on web pages."""
PAPER_COLUMNS: Final = (_REAL, _IMAGINARY, _HERTZ, _RATIO)
"""Of LaTeX tables; the multiplicity is a column there where one is not 1."""
MODE_COLUMNS: Final = (_HERTZ, _ANGULAR, _RATIO)
"""Of LaTeX tables of modes."""
