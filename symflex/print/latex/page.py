"""The page that LaTeX sets: widths of papers' columns, and the preamble of a document of its own."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from symflex.errors import refused

COLUMNS_MM: Final = {"ieee": 88.5, "a4": 170.0}  # [mm]; IEEE journals: 252 points, A4: margins of 20 mm
NARROWEST_MM: Final = 80.0  # narrowest column in which formulas of ten points need only one column
WIDEST_MM: Final = 1000.0
_MILLIMETRES: Final = re.compile(r"([0-9]{1,6}(?:\.[0-9]{1,6})?) ?(?:mm)?")


def column_width(said: float | str) -> float:
    """Return the width of a column [mm] from its name or from millimetres, a number or a text.

    Raises UsageError: SF902 when it is neither, or not between 80 and 1000 mm.
    """
    if not isinstance(said, str):
        return checked_width(said)
    if said in COLUMNS_MM:
        return COLUMNS_MM[said]
    match = _MILLIMETRES.fullmatch(said)
    if match is None:
        hint = f"{', '.join(COLUMNS_MM)} or millimetres such as 120mm"
        raise refused(f"'{said[:32]}' is not a width of a column", hint)
    return checked_width(float(match[1]))


def width_of(said: float | str | None) -> float | None:
    """Return the width of a column [mm] as :func:`column_width` does, None if nothing is said."""
    return None if said is None else column_width(said)


def checked_width(width_mm: float) -> float:
    """Return the width of a column [mm]; UsageError: SF902 when it is not between 80 and 1000 mm."""
    if not NARROWEST_MM <= width_mm <= WIDEST_MM:
        raise refused(f"a column is from {NARROWEST_MM:g} to {WIDEST_MM:g} mm wide, found {width_mm:g} mm")
    return width_mm


_JUSTIFIED_MM: Final = 120.0
_MARGIN_MM: Final = 20.0
_A4_MM: Final = 210.0

# Without lmodern the fonts may be bitmaps, which pdfTeX cannot expand.
_PREAMBLE: Final = r"""\documentclass[10pt,a4paper]{article}
\usepackage[T1]{fontenc}
\IfFileExists{lmodern.sty}{\usepackage{lmodern}}{\PassOptionsToPackage{expansion=false}{microtype}}
\IfFileExists{microtype.sty}{\usepackage{microtype}}{}
\usepackage[%stextwidth=%gmm,textheight=245mm]{geometry}
\usepackage{amsmath}
\usepackage{array}
\usepackage{booktabs}
\usepackage{siunitx}
\sisetup{per-mode=symbol}
%s\raggedbottom%s"""


def preamble(width_mm: float = COLUMNS_MM["a4"], packages: Sequence[str] = ()) -> str:
    """Return everything before the document begins, for a text of a width on A4 where it has margins then."""
    needed = width_mm + 2 * _MARGIN_MM
    paper = "" if needed <= _A4_MM else f"paperwidth={needed:g}mm,paperheight=297mm,"
    # Justified lines of a narrow column would need hyphenation of every word in them.
    ragged = "" if width_mm >= _JUSTIFIED_MM else "\n\\AtBeginDocument{\\raggedright}"
    more = "".join(f"\\usepackage{{{package}}}\n" for package in packages)
    return _PREAMBLE % (paper, width_mm, more, ragged)
