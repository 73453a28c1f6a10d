"""Widths of type, in em, rounded up: enough to know that a line fits before it is typeset.

Letters are those of Computer Modern at ten points (cmmi10 with italic correction, cmr10), from its metric
files. Smaller sizes of the family are wider in proportion, at most 0.84 (7 pt) and 0.79 (5 pt) of the size
at 10 pt, hence :data:`SCRIPT`.
"""

from __future__ import annotations

from string import digits, punctuation
from typing import Final

SCRIPT: Final = 0.9
"""Width of a subscript, a superscript or a fraction in a fraction, in proportion to the full size."""

EM_MM: Final = 10 * 25.4 / 72.27
"""One em of a ten point font [mm]."""

DIGIT: Final = 0.5
THIN: Final = 0.17
OPERATOR: Final = 1.23
"""A plus or minus between its operands."""

RELATION: Final = 1.34
"""An equals sign between its sides."""

TIMES: Final = 1.23
CDOT: Final = 0.73
MINUS: Final = 0.78
QUAD: Final = 1.0
SLASH: Final = 0.5
WIDEST: Final = 1.2
"""No character is wider; for those without an entry."""

_LETTERS: Final = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"


def _table(hundredths: str) -> dict[str, float]:
    return {c: int(w) / 100 for c, w in zip(_LETTERS, hundredths.split(), strict=True)}


ITALIC: Final = _table(
    "76 81 79 86 80 79 79 92 52 66 93 69 108 92 80 79 80 77 68 73 80 81 109 91 81 76 "
    "53 43 44 53 47 60 52 58 35 47 56 32 88 61 49 51 49 48 47 37 58 53 75 58 53 51"
)
"""Math italic, with italic correction."""

TEXT_ITALIC: Final = _table(
    "75 81 87 85 80 79 87 91 55 67 92 63 107 91 87 79 87 77 69 85 91 93 119 91 94 76 "
    "59 53 52 62 54 52 55 59 41 46 57 36 90 64 58 58 55 53 50 43 62 57 78 59 58 54"
)

_SIGNS: Final = {c: 0.78 for c in punctuation} | {c: 0.39 for c in "()[].,:;'!`-"} | {" ": 0.34}

ROMAN: Final = (
    _table(
        "76 71 73 77 69 66 79 76 37 52 78 63 92 76 78 69 78 74 56 73 76 77 105 76 78 62 "
        "51 56 45 56 45 39 52 56 28 31 53 28 84 56 51 56 53 40 40 39 56 55 74 53 55 45"
    )
    | dict.fromkeys(digits, DIGIT)
    | _SIGNS
)
"""Upright text and its signs."""

BOLD_AND_OTHERS: Final = 1.2
"""Other alphabets, in proportion to the upright one."""

TYPEWRITER: Final = 0.53

_WIDE_GREEK: Final = frozenset(
    "omega psi varpi Delta Gamma Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega alpha phi varphi chi".split()
)


def greek_width(command: str) -> float:
    """Return the width of a Greek letter.

    Examples
    --------
    >>> greek_width("zeta"), greek_width("Omega")
    (0.62, 0.87)
    """
    return 0.87 if command in _WIDE_GREEK else 0.62
