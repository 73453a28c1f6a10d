"""The frequencies of a response."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.model import ExactValue
from symflex.sweep.design import Range, between

if TYPE_CHECKING:
    from fractions import Fraction


def logarithmic(low: Fraction, high: Fraction, count: int) -> list[float]:
    """Return frequencies between two, equally spaced in their logarithm, the same on every computer.

    Examples
    --------
    >>> from fractions import Fraction
    >>> logarithmic(Fraction(1), Fraction(100), 3)
    [1.0, 10.0, 100.0]
    """
    limits = Range("frequency", ExactValue(low), ExactValue(high), "log")
    return [float(value.rational) for value in between(limits, count)]
