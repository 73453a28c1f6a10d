"""How large a specification may be; beyond, it is refused before anything is built from it."""

from __future__ import annotations

import re
from typing import Final

MAX_BYTES: Final = 1_000_000
MAX_NESTING: Final = 32
MAX_LEVELS: Final = 64
MAX_ENTRIES: Final = 20_000
MAX_KEY_PARTS: Final = 16
MAX_LITERAL: Final = 400
MAX_EXPONENT: Final = 400
MAX_ERRORS: Final = 20

_SHOWN_DIGITS = 20

_NUMBER = re.compile(r"[+-]?\.?[0-9][0-9A-Za-z_.+\-]*+")
_EXPONENT = re.compile(r"[+-]?[0-9][0-9_]*+(?:\.[0-9_]*+)?[eE]([+-]?[0-9_]++)")


def number_problem(literal: str) -> str | None:
    """Say why a number is refused, or ``None`` when it is not (or is no number).

    Parameters
    ----------
    literal : str
        A number as it is written.

    Examples
    --------
    >>> number_problem("1e999999999")
    'exponent 999999999; exponents go from -400 to 400'
    >>> number_problem("1e400") is None
    True
    """
    if len(literal) > MAX_LITERAL:
        if _NUMBER.fullmatch(literal):
            return f"number of {len(literal)} characters; at most {MAX_LITERAL} are allowed"
        return None
    match = _EXPONENT.fullmatch(literal)
    if match is None:
        return None
    digits = match[1].replace("_", "")
    if not digits.lstrip("+-") or abs(int(digits)) <= MAX_EXPONENT:
        return None
    shown = digits if len(digits) <= _SHOWN_DIGITS else f"{digits[:_SHOWN_DIGITS]}..."
    return f"exponent {shown}; exponents go from -{MAX_EXPONENT} to {MAX_EXPONENT}"
