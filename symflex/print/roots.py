r"""Poles, zeros and modes as rows of tables: what a column shows is written here once, for every page.

    one pair, s = -0.5 +- 3.1 j     terminal    -0.500  +-3.10  4e-16  0.4997  0.159
                                    web page    -0.500 | +-3.10 | 4e-16 | 0.4997 | 0.159 | 1
                                    paper       -0.500 & \pm 3.10 & 0.4997 & 0.159

A column that is added to one of the four lists below is in every table of its kind; in JSON it is a key of
:mod:`symflex.roots.pole_zero_map`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from flint import arb

from symflex.errors.diagnostic import counted
from symflex.print.text import INDENT, WIDTH, aligned, broken

if TYPE_CHECKING:
    from symflex.roots import PoleZeroMap, Region, Root
    from symflex.roots.root import RootDecimals

KINDS: Final = {"poles": "Poles", "zeros": "Zeros", "hidden": "Hidden roots"}
"""What a :class:`~symflex.roots.PoleZeroMap` holds, and the titles of tables of it."""
SHORT_DIGITS: Final = 6  # digits of roots, frequencies and damping ratios in a terminal by default
_FREQUENCY_BITS: Final = 256


@dataclass(frozen=True, slots=True)
class PrintedRoot:
    """A root to print, alone or for its conjugate pair."""

    root: Root
    is_pair: bool

    def cells(self, columns: Sequence[RootColumn], digits: int, both: str = "") -> list[str]:
        """Return what columns show, in so many certified digits, a pair's after ``both``, plus and minus."""
        printed = self.root.decimal(digits)
        return [
            both * (self.is_pair and column.is_mirrored) + column.text(self.root, printed, digits)
            for column in columns
        ]


@dataclass(frozen=True, slots=True)
class RootColumn:
    """A column of tables of roots."""

    name: str  # its head on a web page or in a terminal, the unit aside
    paper: tuple[str, ...]  # its head in LaTeX, line by line
    unit: str  # empty where there is none
    text: Callable[[Root, RootDecimals, int], str]  # a decimal, empty where there is none
    is_exact: Callable[[Root], bool] = lambda _: True  # whether a zero there is one
    is_mirrored: bool = False  # of a conjugate pair it stands for both signs

    @property
    def head(self) -> str:
        """Its head on a web page or in a terminal."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


def roots_of(located: PoleZeroMap, kind: str) -> tuple[Root, ...]:
    """Return the roots that a table of one kind lists: poles in the right half-plane wherever they lie."""
    if kind == "hidden":
        return tuple(h.root for h in located.hidden)
    return located.all_poles if kind == "poles" else located.zeros


def one_of_each_pair(roots: Sequence[Root]) -> list[PrintedRoot]:
    """Return every root once, a conjugate pair as the member above the real axis."""
    from symflex.balls import opposite  # imports numpy

    lower = [r for r in roots if r.im < 0]
    pairs: set[int] = set()  # where upper members of pairs stand
    for i, root in enumerate(roots):
        image = opposite(root.im)
        near = (r for r in lower if root.im > 0 and r.im.overlaps(image) and r.re.overlaps(root.re))
        if (partner := next(near, None)) is not None:
            lower.remove(partner)
            pairs.add(i)
    alone = set(map(id, lower))
    return [PrintedRoot(r, i in pairs) for i, r in enumerate(roots) if not r.im < 0 or id(r) in alone]


def _alone(value: arb, digits: int, *, trimmed: bool = False) -> str:
    """Return a number that follows from a root, all of its digits right."""
    from symflex.roots.root import NEARLY_ZERO, figure  # imports numpy

    if value.contains(0) and not value.is_zero():
        return NEARLY_ZERO
    return figure(value, digits, trimmed=trimmed)


def _frequency(root: Root, digits: int, *, trimmed: bool = False) -> str:
    """Return the natural frequency abs(s)/(2 pi) [Hz]."""
    from symflex.balls import precision  # imports numpy

    with precision(max(_FREQUENCY_BITS, root.working_bits())):
        frequency = root.natural_frequency() / (2 * arb.pi())
    return _alone(frequency, digits, trimmed=trimmed)


def _damping(root: Root, digits: int, *, trimmed: bool = False) -> str:
    """Return ``-re/abs(s)``, empty at 0 and where s may be 0."""
    from symflex.balls import precision  # imports numpy

    frequency = root.natural_frequency()
    if root.is_zero or not frequency > 0:
        return ""
    if root.on_imaginary_axis:
        return "0"
    if root.is_real:
        return "1" if root.re < 0 else "-1"
    with precision(max(_FREQUENCY_BITS, root.working_bits())):
        ratio = -root.re / frequency
    return _alone(ratio, digits, trimmed=trimmed)


_REAL: Final = RootColumn(
    "Re s",
    ("Re $s$",),
    "rad/s",
    lambda root, printed, digits: _alone(root.re, digits),
    lambda root: root.on_imaginary_axis,
)
_IMAGINARY: Final = RootColumn(
    "Im s",
    ("Im $s$",),
    "rad/s",
    lambda root, printed, digits: _alone(root.im, digits),
    lambda root: root.is_real,
    is_mirrored=True,
)
_RADIUS: Final = RootColumn("radius", ("Radius",), "rad/s", lambda root, printed, digits: printed.radius)
_HERTZ: Final = RootColumn(
    "frequency",
    ("Frequency",),
    "Hz",
    lambda root, printed, digits: _frequency(root, digits),
    lambda root: root.is_zero,
)
_ANGULAR: Final = replace(
    _HERTZ, unit="rad/s", text=lambda root, printed, digits: _alone(root.natural_frequency(), digits)
)
_RATIO: Final = RootColumn(
    "damping ratio",
    ("Damping", "ratio"),
    "",
    lambda root, printed, digits: _damping(root, digits),
    lambda root: root.on_imaginary_axis,
)
_TIMES: Final = RootColumn(
    "multiplicity", ("Multi-", "plicity"), "", lambda root, printed, digits: str(root.multiplicity)
)

_TOLD_REAL: Final = replace(_REAL, text=lambda root, printed, digits: printed.readable.re)  # beside a radius
_TOLD_IMAGINARY: Final = replace(_IMAGINARY, text=lambda root, printed, digits: printed.readable.im)
PAGE_COLUMNS: Final = (_TOLD_REAL, _TOLD_IMAGINARY, _RADIUS, _HERTZ, _RATIO, _TIMES)
"""Columns of tables on web pages."""
PAPER_COLUMNS: Final = (_REAL, _IMAGINARY, _HERTZ, _RATIO)  # in LaTeX; with the multiplicity if one is not 1
MODE_COLUMNS: Final = (_HERTZ, _ANGULAR, _RATIO)  # columns of LaTeX tables of modes
TERMINAL_COLUMNS: Final = (
    RootColumn("Re", (), "rad/s", _TOLD_REAL.text),
    RootColumn("Im", (), "rad/s", _TOLD_IMAGINARY.text, is_mirrored=True),
    RootColumn("radius", (), "", _RADIUS.text),
    RootColumn("f", (), "Hz", lambda root, printed, digits: _frequency(root, SHORT_DIGITS, trimmed=True)),
    RootColumn("zeta", (), "", lambda root, printed, digits: _damping(root, SHORT_DIGITS, trimmed=True)),
)  # columns of tables in a terminal; in short lines the first two, the parts of s, are below each other


def _loss_factor(root: Root, printed: RootDecimals, digits: int) -> str:
    factor = root.loss_factor()
    return "" if factor is None else _alone(factor, min(digits, SHORT_DIGITS), trimmed=True)


LOSS_FACTORS: Final = {  # what takes the place of a damping ratio where the model has loss factors
    "damping ratio": RootColumn("loss factor", ("Loss", "factor"), "", _loss_factor),
    "zeta": RootColumn("eta", (), "", _loss_factor),
}


def columns_for(columns: Sequence[RootColumn], roots: Sequence[Root]) -> list[RootColumn]:
    """Return the columns of a table of roots, with loss factors in place of damping ratios."""
    is_lossy = any(root.loss_factor() is not None for root in roots)
    return [LOSS_FACTORS.get(c.name, c) if is_lossy else c for c in columns]


CAUSES: Final = {
    "cancelled": "cancelled between numerator and denominator",
    "coincident": "poles and zeros that agree in all digits",
}


def roots_text(located: PoleZeroMap, digits: int, width: int = WIDTH) -> str:
    """Return poles and zeros as tables, with the certificate, in lines of at most ``width`` columns."""
    from symflex.roots import Mode  # imports numpy

    certificate = located.certificate
    status = "certified" if certificate.certified else f"NOT CERTIFIED: {certificate.reason}"
    word = located.verdict.brief
    lines = [f"{located.tf}   {status}: {certificate.found} of {certificate.counted} roots enclosed; {word}"]
    if located.verdict.sentence != word:
        lines += broken(INDENT + located.verdict.sentence, width)
    if located.verdict.hidden:
        lines += broken(INDENT + located.verdict.hidden_motion, width)
    lines += broken(INDENT + phase, width) if (phase := _phase_text(located)) else []
    if shown := region_text(located.region):
        if located.verdict.word == "unstable" and not located.unstable:
            shown += "; all known poles in the right half-plane"
        default = "; by default, as there are infinitely many" * located.is_default_region
        lines += broken(f"{INDENT}shown: {shown}{default}", width)
    for part in located.excluded:
        where = f"{part.re:g}" + (f" +- {part.im:g} j" if part.im else "")
        lines.append(f"{INDENT}left out: {part.radius:.3g} rad/s about {where}, where roots accumulate")
    tables = [("poles", located.poles, ""), ("zeros", located.zeros, "")]
    more = [("poles", located.unstable, ", in the right half-plane, outside the requested region")]
    for cause, meaning in CAUSES.items():
        more.append(("hidden", tuple(h.root for h in located.hidden if h.cause == cause), f", {meaning}"))
    if located.hides_more:
        lines.append(f"{INDENT}hidden modes are infinite in number, and not all are listed")
    region = located.region
    fewer = ""
    if isinstance(region, Mode) and not located.hidden:
        fewer = f", there are fewer than {region.number}"
    none = f"none{fewer}" if certificate.certified else "none found"
    for title, roots, meaning in [*tables, *(table for table in more if table[1])]:
        count = sum(root.multiplicity for root in roots) or none
        lines += ["", f"{INDENT}{title}: {count}{meaning}", *_root_table(roots, digits, width)]
    everything = [*located.poles, *located.zeros, *located.unstable, *(h.root for h in located.hidden)]
    if everything:
        lines += ["", "  radius bounds the distance from the printed value to the root [rad/s]"]
    if any(root.on_boundary for root in everything):
        lines.append("  | marks a root on the boundary of the requested region")
    if not all(root.certified for root in everything):
        lines.append("  ? marks roots that could not be separated, enclosed as one")
    return "\n".join(lines)


def _phase_text(located: PoleZeroMap) -> str:
    """Say whether zeros lie in the right half-plane; of endlessly many zeros those shown are known."""
    if count := sum(zero.multiplicity for zero in located.zeros if zero.re > 0):
        return f"not minimum phase: {counted(count, 'zero')} in the right half-plane"
    is_sure = located.certificate.certified and all(z.re < 0 or z.on_imaginary_axis for z in located.zeros)
    if located.is_infinite or region_text(located.region):
        return "no zero shown is in the right half-plane" if is_sure and located.zeros else ""
    return "minimum phase: no zero is in the right half-plane" * is_sure


def region_text(region: Region) -> str:
    """Say what was asked for, nothing when it was everything."""
    from symflex.roots import Band, Mode, Modes, Rectangle  # imports numpy

    match region:
        case Modes(count):
            modes = "mode" if count == 1 else f"{count} modes"
            return f"the {modes} of lowest natural frequency, and roots at 0"
        case Mode(number):
            return f"mode number {number}, by natural frequency"
        case Band(low, high):
            return f"natural frequencies from {float(low):g} to {float(high):g} Hz"
        case Rectangle(re_low, re_high, im_low, im_high):
            re = f"Re from {float(re_low):g} to {float(re_high):g}"
            return f"{re}, Im from {float(im_low):g} to {float(im_high):g} rad/s"
        case _:
            return ""


def _root_table(roots: Sequence[Root], digits: int, width: int) -> list[str]:
    """Return a line per real root or conjugate pair, or two where one is too long."""
    if not roots:
        return []
    columns, rows = columns_for(TERMINAL_COLUMNS, roots), []
    for entry in one_of_each_pair(roots):
        times = f"x{entry.root.multiplicity}" if entry.root.multiplicity > 1 else ""
        flags = times + ("" if entry.root.certified else "?") + ("|" if entry.root.on_boundary else "")
        rows.append((flags, *entry.cells(columns, digits, "+-")))
    heads = [column.head for column in columns]
    lines = aligned([("", *heads), *rows])
    if max(map(len, lines)) <= width:
        return lines
    stacked: list[tuple[str, ...]] = [("", "Re, Im [rad/s]", *heads[2:])]
    for flags, re, im, *rest in rows:
        stacked.append((flags, f"{re}  ", *rest))
        if im != "0":
            stacked.append(("", f"{im} j", *("" for _ in rest)))
    lines = aligned(stacked)
    if max(map(len, lines)) <= width:
        return lines
    return [line for row in rows for line in _root_paragraph(row)][:-1]


def _root_paragraph(row: tuple[str, ...]) -> list[str]:
    """Return a root whose digits fill lines of their own, unbroken, so that they can be copied."""
    flags, re, im, *rest = row
    shown = zip(TERMINAL_COLUMNS[2:], rest, strict=True)
    about = [f"{column.name} {cell} {column.unit}".rstrip() for column, cell in shown if cell]
    lines = (f"Re {re}", f"Im {im}", ", ".join(filter(None, (*about, flags))))
    return [*(2 * INDENT + line for line in lines), ""]
