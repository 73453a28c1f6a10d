"""Quantities such as "35 kN/m" and units such as "N*m/A", read into exact SI values."""

from __future__ import annotations

import functools
import re
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Final

from symflex.errors import Diagnostic, SpecError, Text
from symflex.quantities.grammar import NUMBER, PI, SIGNED_NUMBER, SPACES, UNIT_START, RejectedError, evaluate

if TYPE_CHECKING:
    from symflex.quantities.dimension import Dimension
    from symflex.quantities.grammar import Constant, PlacedUnit
    from symflex.quantities.units import Unit

_CONSTANT_TOKEN: Final = re.compile(rf"(?P<operand>{NUMBER}|{PI})|(?P<open>\()|(?P<close>\))|\*\*|[-+*/^]")
_SPACE: Final = re.compile(rf"[{SPACES}]*")


@dataclass(frozen=True, slots=True)
class Quantity:
    """An exact value with its dimension, in SI: ``magnitude * pi**pi_power``, in SI units and cycles."""

    magnitude: Fraction  # the value in SI units, cycles and radians, without its power of pi
    pi_power: int  # power of pi in the value; 0 when the magnitude is 0
    cycles: int  # exponent of the cycle in the unit: 1 for Hz and rpm, -1 for mm/rev
    dimension: Dimension  # exponents of the SI base units
    radians: int  # exponent of the radian (or degree) in the unit: -1 for N*m/rad
    unit: str  # the unit as it was written; empty for a bare number

    def angular(self) -> tuple[Fraction, int]:
        """Return (rational, power of pi) with a cycle counted as 2 pi radians."""
        if not self.magnitude:
            return self.cyclic()
        return self.magnitude * Fraction(2) ** self.cycles, self.pi_power + self.cycles

    def cyclic(self) -> tuple[Fraction, int]:
        """Return (rational, power of pi) with a cycle counted as 1."""
        return self.magnitude, self.pi_power


def parse_quantity(text: Text) -> Quantity:
    """Read a quantity, or a bare number, exactly.

    Between constant and unit stands a space; a plain number may touch a unit's first letter (``3kg``). The
    text is untrusted, of at most 200 characters. Cycles (Hz, rev, rpm) are counted, not multiplied by 2 pi.
    """
    constant, placed = _parsed(text, "quantity")
    magnitude, unit = constant.magnitude * placed.unit.scale, placed.unit
    return Quantity(
        magnitude=magnitude,
        pi_power=constant.pi_power + unit.pi_power if magnitude else 0,
        cycles=unit.cycles,
        dimension=unit.dimension,
        radians=unit.radians,
        unit=text.value[placed.start : placed.end],
    )


def parse_unit(text: Text) -> Unit:
    """Read a unit alone, from an untrusted text; ``1`` is the unit of a pure number."""
    _, placed = _parsed(text, "unit")
    return placed.unit


@functools.cache
def unit_of(text: str) -> Unit:
    """Return a unit written in a program's own text; :func:`parse_unit` reads a user's."""
    return parse_unit(Text.alone("<unit>", text))


def looks_like_quantity(text: str) -> bool:
    """Tell a quantity such as ``2 m`` from an expression such as ``2*m``.

    Only the shape counts, so that a misspelt unit is still reported as one. True for

    - a number alone, with or without a sign: ``0.05``, ``-3``;
    - a number touching a unit symbol: ``3kg``, ``10%``, ``2m_1``;
    - a constant (numbers, ``pi``, ``+ - * / ^``, parentheses), a space, and then a symbol, a number or
      an opening parenthesis: ``2 m``, ``22*pi rad/s``, ``5 1/s``, ``2 (N*m)``.

    What follows is not looked at. A constant other than a plain number, standing alone, is an expression:
    ``1/3``, ``2*pi``. Every text that :func:`parse_quantity` reads with a unit is one of the above.
    """
    text = text.strip(SPACES)
    if SIGNED_NUMBER.fullmatch(text):
        return True
    position, depth, after_value = 0, 0, False
    while True:
        space = _SPACE.match(text, position)
        place = space.end() if space else position
        token = _CONSTANT_TOKEN.match(text, place)
        complete = after_value and depth == 0
        if token is None or (complete and token.lastgroup in ("operand", "open")):
            break
        depth += {"open": 1, "close": -1}.get(token.lastgroup or "", 0)
        if depth < 0:
            return False
        after_value = token.lastgroup in ("operand", "close")
        position = token.end()
    if not complete:
        return False
    starts_unit = token is not None or UNIT_START.match(text, place) is not None
    if place == position:
        return token is None and starts_unit and SIGNED_NUMBER.fullmatch(text, 0, position) is not None
    return starts_unit


def _parsed(text: Text, kind: str) -> tuple[Constant, PlacedUnit]:
    try:
        return evaluate(text.value, kind)
    except RejectedError as rejected:
        span = text.at(rejected.start, rejected.end)
        raise SpecError(Diagnostic(rejected.code, rejected.message, span, rejected.hint)) from None
