"""Another number in a specification with which a printed table is right: a conjecture still to be tried.

Input: the text of a model, and an entry of a table. Output: for a number of the text, what it would have to
be, as factors and as decimals that a person may have typed.

The root that belongs to the entry is a function of the number. The secant method solves for the number on
logarithmic scales, where powers are straight lines: twice a diameter takes as long to find as a digit.

Example: two rotors turn at 53.1 rad/s and are printed with 86.7, which they have if "0.27 kg*m^2" is "0.72
kg*m^2", with two digits exchanged.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise
from math import exp, inf, log, pi, sqrt
from typing import Final

from symflex.audit.tables import last_place, significant, verdict_on
from symflex.balls import ball
from symflex.model import PrintedTable
from symflex.model.spec import ArrayValue, NumberValue, StringValue, TableValue, Value

FACTORS: Final[Mapping[str, tuple[Fraction, int, bool]]] = {
    "2 pi times": (Fraction(2), 1, False),
    "1/(2 pi) times": (Fraction(1, 2), -1, False),
    "twice": (Fraction(2), 0, False),
    "half": (Fraction(1, 2), 0, False),
    "pi times": (Fraction(1), 1, False),
    "1/pi times": (Fraction(1), -1, False),
    "4 times": (Fraction(4), 0, False),
    "1/4 of": (Fraction(1, 4), 0, False),
    "10 times": (Fraction(10), 0, False),
    "1/10 of": (Fraction(1, 10), 0, False),
    "1000 times": (Fraction(1000), 0, False),
    "1/1000 of": (Fraction(1, 1000), 0, False),
    "minus": (Fraction(-1), 0, False),
    "8 times": (Fraction(8), 0, False),
    "1/8 of": (Fraction(1, 8), 0, False),
    "16 times": (Fraction(16), 0, False),
    "1/16 of": (Fraction(1, 16), 0, False),
    "60 times": (Fraction(60), 0, False),
    "60/(2 pi) times": (Fraction(30), -1, False),
    "180/pi times": (Fraction(180), -1, False),
    "sqrt(2) times": (Fraction(2), 0, True),
    "1/sqrt(2) times": (Fraction(1, 2), 0, True),
    "sqrt(3) times": (Fraction(3), 0, True),
}
"""What a unit, a diameter for a radius or a decimal point makes of a value: rational, power of pi, and
whether its square root is meant."""
SECTIONS: Final = (
    "definitions",
    "elements",
    "signals",
    "equations",
    "fields",
    "energy",
    "blocks",
    "parameters",
)
"""Sections whose expressions and numbers are changed."""
WORDS: Final = ("type", "at", "between", "doc", "latex", "unit", "assume", "from", "to", "range", "spread")
"""Keys that contain no value."""
NUMBER: Final = re.compile(
    r"(?<![\w.^])(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
)  # no exponent, no part of a name
LATE: Final = 20  # units of the last digit by which an entry is off that was computed with too few
DIGITS: Final = "0123456789"
FINER: Final = 2  # digits that another number may have more than the written one
LISTED: Final = 2  # digits that it takes to say which factor, digit or exchange a slip is
SHORT: Final = 24  # characters of a text that is shown whole
PROBE: Final = 1e-2  # first step of the solve, as a logarithm
STRIDE: Final = 2.5  # longest step
STEPS: Final = 12
FLAT: Final = 1e-6  # exponent below which a number does not bear upon a root
SHARE: Final = 0.1  # of a unit of the last digit, to which the solve goes


@dataclass(frozen=True, slots=True)
class WrittenNumber:
    """A number as it is written in a specification."""

    path: str  # whose it is, such as "k of spring"
    whole: str  # the string it is written in, such as "17.4 kN/m"
    text: str
    start: int  # in ``whole``
    place: int  # of ``whole`` in the source
    row: int | None = None  # of the table that sets it, from 1

    @property
    def is_alone(self) -> bool:
        """Whether the string is one number, with its unit."""
        return self.start == 0 and len(NUMBER.findall(self.whole)) == 1

    def with_number(self, text: str) -> str:
        """Return the string with another number."""
        after = self.whole[self.start + len(self.text) :]
        return (
            self.whole[: self.start - 1] + after
            if self.is_divisor and text == "1"
            else self.whole[: self.start] + text + after
        )

    @property
    def is_divisor(self) -> bool:
        """Whether a slash stands in front of it."""
        return self.whole[: self.start].endswith("/")


@dataclass(frozen=True, slots=True)
class Refit:
    """What a number may have been."""

    said: str
    text: str  # the number
    digits: int  # how many digits of evidence it takes to choose it


def named(path: str) -> str:
    """Return what a path is called in a sentence: ``a condition of w`` for ``conditions of w``."""
    word, _, rest = path.partition(" ")
    one = {"conditions": "a condition", "equations": "an equation", "equation": "the equation"}.get(
        word, word
    )
    return f"{one} {rest}".rstrip()


def other_text(path: str, new: str, old: str) -> str:
    """Return in words that a text would be another one; of a long text only what differs.

    >>> other_text("k of spring", "14.7 kN/m", "17.4 kN/m")
    'k of spring is 14.7 kN/m, not 17.4 kN/m'
    >>> other_text("equations", "3*s^2*x + 540*x + b*s*x = F", "3*s^2*x + 450*x + b*s*x = F")
    'an equation has 540*x in place of 450*x: 3*s^2*x + 450*x + b*s*x = F'
    """
    if max(len(new), len(old)) <= SHORT:
        return f"{named(path)} is {new}, not {old}"
    terms = [re.findall(r"(?:\([^()]*\)|[^\s()])+|\S", text) for text in (new, old)]
    begin = next((i for i, (a, b) in enumerate(zip(*terms, strict=False)) if a != b), min(map(len, terms)))
    end = next(
        (i for i, (a, b) in enumerate(zip(*map(reversed, terms), strict=False)) if a != b),
        min(map(len, terms)),
    )
    end = min(end, *(len(each) - begin for each in terms))
    said, had = (" ".join(each[begin : len(each) - end]) for each in terms)
    if not said:
        return f"{named(path)} lacks {had}: {old}"
    return (
        f"{named(path)} has {said} in place of {had}: {old}" if had else f"{named(path)} is {new}, not {old}"
    )


def written(path: str, value: Value | None) -> Iterator[tuple[str, StringValue | NumberValue]]:
    """Yield the strings and numbers below a section, with what they belong to."""
    match value:
        case StringValue() if value.text.verbatim:
            yield path, value
        case NumberValue():
            yield path, value
        case TableValue():
            for entry in value.entries:
                if entry.key == "value":
                    yield from written(path, entry.value)
                elif entry.key not in WORDS:
                    inner = entry.key if path in SECTIONS else f"{entry.key} of {path}"
                    yield from written(inner, entry.value)
        case ArrayValue():
            for item in value.items:
                yield from written(path, item)


def literals_of(sections: Mapping[str, TableValue], table: PrintedTable) -> Iterator[WrittenNumber]:
    """Yield the numbers of a specification, those of parameters and of the table's own rows first."""
    yield from _numbers("parameters", sections.get("parameters"))
    tables = sections.get("tables")
    own = tables.get(table.name) if tables else None
    rows = own.value.get("rows") if own and isinstance(own.value, TableValue) else None
    items = rows.value.items if rows and isinstance(rows.value, ArrayValue) else ()
    for number, item in enumerate(items, 1):
        given = item.get("set") if isinstance(item, TableValue) else None
        for entry in given.value.entries if given and isinstance(given.value, TableValue) else ():
            yield from _numbers(f"{entry.key} in row {number}", entry.value, number)
    for section in SECTIONS:
        if section != "parameters":
            yield from _numbers(section, sections.get(section))


def _numbers(path: str, value: Value | None, row: int | None = None) -> Iterator[WrittenNumber]:
    for owner, each in written(path, value):
        whole = each.literal if isinstance(each, NumberValue) else each.text.value
        place = each.span.start if isinstance(each, NumberValue) else each.text.span.start
        for found in NUMBER.finditer(whole):
            if float(found[0]):
                yield WrittenNumber(owner, whole, found[0], found.start(), place, row)


def refits(
    literal: WrittenNumber, printed: str, at: Callable[[float], float | None], now: float | None
) -> Iterator[Refit]:
    """Yield what a number may have been if an entry is what is printed.

    ``at`` returns what the entry is with another number, and ``now`` is what it is.
    """
    target, number = float(printed), float(literal.text)
    solved = _solved(lambda times: _gap(at(number * times), target), _gap(now, target), printed)
    if solved is None:
        return
    times, slope = solved
    width = float(last_place(printed)) / abs(target) / abs(slope)
    if literal.is_alone:
        for said, (rational, pi_power, is_root) in FACTORS.items():
            factor = float(rational) * pi**pi_power
            factor = sqrt(factor) if is_root and factor > 0 else factor
            if abs(factor / times - 1) <= width:
                text = f"{Decimal(repr(number * factor)):f}"
                yield Refit(f"{named(literal.path)} is {said} the declared value", text, LISTED)
    right = Fraction(number * times)
    if one := respelled(literal.text, right):
        yield _typed(literal, one[1], LISTED)
    for digits in range(1, significant(literal.text) + FINER + 1):
        text = f"{Decimal(f'{number * times:.{digits - 1}e}'):f}"
        if abs(float(text) / (number * times) - 1) <= width:
            yield _typed(literal, text, digits)
            return


def _typed(literal: WrittenNumber, text: str, digits: int) -> Refit:
    return Refit(other_text(literal.path, literal.with_number(text), literal.whole), text, digits)


def _gap(value: float | None, target: float) -> float:
    return log(value / target) if value and value * target > 0 else inf


def _solved(gap: Callable[[float], float], now: float, printed: str) -> tuple[float, float] | None:
    """Return the factor that closes a gap, and the slope there; both on logarithmic scales."""
    close = SHARE * float(last_place(printed)) / abs(float(printed) or 1.0)
    known, far, step = (0.0, now), PROBE, 0.0
    for _ in range(STEPS):
        value = gap(exp(far))
        if abs(value) == inf or abs(known[1]) == inf:
            return None
        slope = (value - known[1]) / (far - known[0])
        if abs(slope) < FLAT:
            return None
        if abs(value) < close:
            return exp(far), slope
        step = max(-STRIDE, min(STRIDE, -value / slope))
        known, far = (far, value), far + step
    return None


def respelled(printed: str, value: Fraction) -> tuple[str, str] | None:
    """Return what happened to a decimal on its way to the page, and what it was; None if nothing simple did.

    >>> respelled("3.15601", Fraction("3.5160152685")), respelled("1111", Fraction("1011.2"))
    (('two digits exchanged', '3.51601'), ('a mistyped digit', '1011'))
    """
    places = [i for i, c in enumerate(printed) if c.isdigit()]
    offered: list[tuple[str, str]] = []
    for i, j in pairwise(places):
        swapped = [*printed]
        swapped[i], swapped[j] = printed[j], printed[i]
        offered.append(("two digits exchanged", "".join(swapped)))
    early = places[: -1 if abs(Fraction(Decimal(printed)) - value) > LATE * last_place(printed) else -2]
    offered += [("one digit too many", printed[:i] + printed[i + 1 :]) for i in early]
    offered += [("a mistyped digit", printed[:i] + d + printed[i + 1 :]) for i in early for d in DIGITS]
    offered += [("a digit left out", printed[:i] + d + printed[i:]) for i in places[1:-1] for d in DIGITS]
    plain = "" if "e" in printed.lower() else printed.replace(".", "")
    moved = [f"{plain[:i]}.{plain[i:]}" for i in range(1, len(plain))]
    offered += [("a decimal point at another place", text) for text in moved]
    for what, text in offered:
        if text != printed and text.strip("-+.") and verdict_on(text, ball(value)) in ("right", "rounded"):
            return what, text
    return None
