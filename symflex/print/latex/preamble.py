r"""The preamble of a document of its own, for pdflatex and lualatex alike."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from symflex.print.latex.column import COLUMNS_MM

if TYPE_CHECKING:
    from collections.abc import Sequence

_JUSTIFIED_MM: Final = 120.0
_MARGIN_MM: Final = 20.0
_A4_MM: Final = 210.0

_PREAMBLE: Final = r"""\documentclass[10pt,a4paper]{article}
\usepackage[T1]{fontenc}
\IfFileExists{lmodern.sty}{\usepackage{lmodern}}{}
\IfFileExists{microtype.sty}{\usepackage{microtype}}{}
\usepackage[%stextwidth=%gmm,textheight=245mm]{geometry}
\usepackage{amsmath}
\usepackage{array}
\usepackage{booktabs}
\usepackage{siunitx}
\sisetup{per-mode=symbol}
%s\raggedbottom%s"""


def preamble(width_mm: float = COLUMNS_MM["a4"], packages: Sequence[str] = ()) -> str:
    """Return everything before the document begins.

    The text is ``width_mm`` wide, on a page of A4 where it has margins then.
    """
    needed = width_mm + 2 * _MARGIN_MM
    paper = "" if needed <= _A4_MM else f"paperwidth={needed:g}mm,paperheight=297mm,"
    # Justified lines of a narrow column would need hyphenation of every word in them.
    ragged = "" if width_mm >= _JUSTIFIED_MM else "\n\\AtBeginDocument{\\raggedright}"
    more = "".join(f"\\usepackage{{{package}}}\n" for package in packages)
    return _PREAMBLE % (paper, width_mm, more, ragged)
