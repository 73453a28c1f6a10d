"""Numbers and units as plain text for people: real minus signs, powers of ten, dots between units."""

from __future__ import annotations

import re
from typing import Final

_RAISED: Final = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
_POWER: Final = re.compile(r"\^(-?[0-9]+)")


def exponents(decimal: str) -> str:
    """Return a decimal such as ``-1.5e-3`` as it is written by hand.

    Examples
    --------
    >>> exponents("-1.5e-3"), exponents("0.25")
    ('−1.5·10⁻³', '0.25')
    """
    mantissa, _, exponent = decimal.partition("e")
    shown = mantissa.replace("-", "−")
    return f"{shown}·10{exponent.translate(_RAISED)}" if exponent else shown


def unit_text(unit: str) -> str:
    """Return a unit, nothing for a pure number.

    Examples
    --------
    >>> unit_text("kg*m^2"), unit_text("1")
    ('kg·m²', '')
    """
    if unit == "1":
        return ""
    return _POWER.sub(lambda m: m[1].translate(_RAISED), unit).replace("*", "·")


def counted(count: int, noun: str, plural: str = "") -> str:
    """Return a number of things.

    Examples
    --------
    >>> counted(1, "pole"), counted(0, "zero"), counted(3, "zero")
    ('1 pole', 'no zeros', '3 zeros')
    """
    many = plural or f"{noun}s"
    if not count:
        return f"no {many}"
    return f"{count} {noun if count == 1 else many}"
