"""What a column means, by its name and unit or as ``--columns`` says.

Input: names of columns, and units in the row below them. Output: what each is, and in which unit.

    "Trace 1: Gain: Magnitude (dB)"   ->  magnitude in dB, of "Trace 1"
    "-Im(Z)/Ohm"                      ->  imaginary part times -1
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symflex.data.measurement.column_names import (
    BRACKETS,
    FACTORS,
    FREQUENCY_UNITS,
    JOINTS,
    KINDS,
    LETTERS,
    MEANINGS,
    PARTS,
    REFERENCE,
    SCALES,
    SPELLINGS,
    UNIT_ENDS,
    UNITS,
    UNITS_IN_WORDS,
    WORDS,
)
from symflex.data.measurement.measured_response import in_si
from symflex.data.measurement.text_table import bare
from symflex.errors import Span, refused

Real = npt.NDArray[np.float64]

LISTED = 12  # names of columns in a message; of more there are dots
_BRACKET = re.compile(r"[\[({<]\s*([^\[\](){}<>]*(?:\([^()]*\)[^\[\](){}<>]*)?)\s*[\])}>]")
_OVER = re.compile(r"\s*/\s*([A-Za-z]{1,4})\s*$")
_RATIO_END = re.compile(r"[\s_]([A-Za-zµ]{2,3}(?:/s\^?2?)?(?:/|_per_)[A-Za-z]{1,4})\s*$")  # mag_um/V
LONGEST_NAME: Final = 200


@dataclass(frozen=True, slots=True)
class ColumnMeaning:
    """What a column is."""

    kind: str = ""  # of WORDS without omega, or complex; empty where it is none of these
    factor: float | None = 1.0  # to Hz or radians; None if no unit is said
    scale: str = "linear"  # or decibel, logarithm (of a frequency, to base 10), unknown
    label: str = ""  # of which response
    unit: str = ""  # as written
    word: str = ""  # the one by which it is known


@dataclass(frozen=True, slots=True, eq=False)
class DataColumn:
    """One column of a table."""

    name: str
    meaning: ColumnMeaning
    numbers: npt.NDArray[Any]  # nan where there is none
    wrong: tuple[int, ...] = ()  # rows without a number
    span: Span | None = None  # of its name
    place: Callable[[int], Span | None] = lambda _: None


@lru_cache(1000)
def meaning_of(name: str, unit_below: str = "") -> ColumnMeaning:
    """Return what a name, and the unit in a row below it, say a column is.

    >>> meaning_of("Trace 2: Gain: Phase (°)").factor, meaning_of("Freq(kHz)").factor
    (0.017453292519943295, 1000.0)
    >>> meaning_of("S11(REAL)").kind, meaning_of("S11(REAL)").label, meaning_of("Time").kind
    ('real', 'S11', '')
    """
    if len(name) > LONGEST_NAME:
        return ColumnMeaning()
    text, marks = _spelled(name)
    text, unit = _without_unit(text, unit_below)
    words = re.findall(PARTS, re.sub(r"(?<=\w)\s*/\s*f(?![^\W\d_])", " ", text.lower()))  # F in X/F: a force
    kind = next((k for k in WORDS if any(KINDS.get(w) == k for w in words)), "")
    scale, said = "linear", {*words, *marks}
    for row in MEANINGS:
        kind = row.means if row.holds(text, said, _small(unit), kind) else kind
    for row in UNITS_IN_WORDS:
        unit = row.means if row.holds(text, said, _small(unit), kind) else unit
    for row in SCALES:
        scale = row.means if row.holds(text, said, _small(unit), kind) else scale
    word = next((w for w in words if KINDS.get(w) == kind), "")
    factor = _factor(kind, unit, word)
    if factor and "times.-1" in marks and kind not in ("frequency", "omega", "magnitude", "power"):
        factor = -factor
    kind = "frequency" if kind == "omega" else kind
    unit = over[1].strip() if (over := REFERENCE.search(name)) and over[1].strip() else unit
    return ColumnMeaning(kind, factor, scale, _label(text, word), unit, word)


def _factor(kind: str, unit: str, word: str) -> float | None:
    """Return a unit in Hz or radians, ``None`` where it is none of these, and 1 for other kinds."""
    if kind not in FACTORS:
        return 1.0
    small = _small(unit) or (word if word in FREQUENCY_UNITS else "")
    return FACTORS[kind].get(unit, FACTORS[kind].get(small))


def _small(unit: str) -> str:
    return unit.lower().rstrip(".")


def _spelled(name: str) -> tuple[str, list[str]]:
    """Return a name in the usual words, and its marks."""
    text = re.sub(r"(?<=z)\"(?=\W)", "''", bare(name).strip(" #*%!;:"), flags=re.I).replace("µ", "u")
    marks = []
    for row in SPELLINGS:
        text, count = re.subn(row.pattern, row.means, text, flags=re.I)
        marks += [row.mark] * bool(count and row.mark)
    return text, marks


def _without_unit(text: str, unit_below: str) -> tuple[str, str]:
    """Return a name without its unit, and the unit, or that in a row below."""
    unit = unit_below.strip("[]<> ").replace("µ", "u")
    unit = unit[1:-1] if re.fullmatch(r"\([^()]*\)", unit) else unit
    for bracket in _BRACKET.finditer(text):
        inside = bracket[1].strip()
        shown, parts = f"{text[: bracket.start()][-1:]}[{inside}]", re.findall(PARTS, inside.lower())
        if next((row.means for row in BRACKETS if row.holds(shown, parts, _small(unit))), "") == "unit":
            over = _OVER.match(text, bracket.end())  # (m/s^2)/N
            whole = text[bracket.start() : over.end() if over else bracket.end()]
            unit = f"({inside})/{over[1]}" if over else inside
            text = text.replace(whole, " " * len(whole))
    ratio = None if unit else _RATIO_END.search(text)
    if ratio and (known := in_si(over_unit := ratio[1].replace("_per_", "/"))) and known[0] != 1:
        return text[: ratio.start()], over_unit
    ends = (re.search(row.pattern, text, re.I) for row in UNIT_ENDS)
    end = None if unit else next(filter(None, ends), None)
    return (text[: end.start()] + text[end.end() :], end[1]) if end else (text, unit)


def _label(text: str, word: str) -> str:
    """Return what is left of a name without the words that say its kind."""

    def kept(match: re.Match[str]) -> str:
        part = match[0].lower()
        return "" if part == word or (len(part) > 1 and part in KINDS) else match[0]

    label = " ".join(re.sub(PARTS, kept, text).split())
    label = re.sub(r"[(\[]\W*[)\]]", "", label).strip(" :;,.-_'|")
    return label[1:-1] if re.fullmatch(r"\([^()]*\)", label) else label


def meanings_of(names: Sequence[str], units_below: Sequence[str] = ()) -> list[ColumnMeaning]:
    """Return what columns are; letters such as X and Y, or R and theta, mean something beside each other.

    >>> [m.kind for m in meanings_of(["Freq", "X (V)", "Y (V)"])]
    ['frequency', 'real', 'imaginary']
    """
    below = list(units_below) or [""] * len(names)
    read = []
    for name, unit in zip(names, below, strict=True):
        apart = name
        for row in JOINTS:
            apart = re.sub(row.pattern, row.means, apart)
        as_it_is, other = meaning_of(name, unit), meaning_of(apart, unit)
        read.append(other if other.kind and not as_it_is.kind else as_it_is)
    read = _beside_phase(read)
    kinds = {m.kind for m in read}
    if "frequency" not in kinds or {"real", "imaginary"} <= kinds or {"magnitude", "phase"} <= kinds:
        return read
    letters: dict[str, int] = {}
    for i, meaning in enumerate(read):
        if not meaning.kind and (first := re.match(r"[a-z]{1,2}\b", meaning.label, re.I)):
            letters.setdefault(first[0].lower(), i)
    beside, alone = (
        [row for row in LETTERS if {*row.pattern.split()} <= {*letters} and row.of in of]
        for of in (kinds, (".*",))
    )
    for row in beside or (alone if len(alone) == 1 and not any(m.word == "z" for m in read) else ()):
        for letter, kind in zip(row.pattern.split(), row.means.split(), strict=True):
            i = letters[letter]
            read[i] = replace(meaning_of(kind, read[i].unit), word=letter)
    return read


def _beside_phase(read: list[ColumnMeaning]) -> list[ColumnMeaning]:
    """Return what columns are where "H1 (g/N)" beside "H1 Phase (deg)" is a magnitude."""
    kinds = {m.kind for m in read}
    if "phase" not in kinds or "magnitude" in kinds:
        return read
    turned = {m.label for m in read if m.kind == "phase"}
    ratios = {m.label for m in read if not m.kind and "/" in m.unit + m.label}
    turned = ratios if turned == {""} and len(ratios) == 1 else turned - {""}  # "Receptance (m/N)"
    are_sizes = [not m.kind and m.label in turned and "/" in m.unit + m.label for m in read]
    sized = [meaning_of(f"magnitude {m.label}", m.unit) for m in read]
    return [size if is_size else m for size, is_size, m in zip(sized, are_sizes, read, strict=True)]


def in_unit_of(asked: ColumnMeaning, header: ColumnMeaning) -> ColumnMeaning:
    """Return what ``--columns`` says of a column, in the unit of its header if it gives none itself.

    >>> in_unit_of(ColumnMeaning("frequency", word="f"), meaning_of("speed [rpm]")).factor * 60
    1.0
    """
    if header.kind == asked.kind == "frequency" and asked.word == "f" and not asked.unit:
        return header
    if asked.unit or asked.kind in ("", "phase", "coherence") or KINDS.get(asked.word) == "omega":
        return asked
    if asked.kind == "frequency":
        factor = _factor("frequency", header.unit, asked.word)
        return replace(asked, unit=header.unit if factor else "", factor=factor or asked.factor)
    return replace(asked, unit="" if _small(header.unit) in UNITS else header.unit)


def counts(numbers: npt.NDArray[Any]) -> bool:
    """Return whether a column numbers its rows, from 0 or from 1."""
    return numbers.size > 1 and numbers[0].real in (0, 1) and bool(np.all(np.diff(numbers.real) == 1))


def columns_asked(asked: str, width: int, names: Sequence[str] = ()) -> list[ColumnMeaning]:
    """Return what ``--columns`` says of columns, in order; SF902 for an unknown word or too many of them.

    >>> [m.kind for m in columns_asked("f,-,mag_db,phase", 4)]
    ['frequency', '', 'magnitude', 'phase']
    """
    words = [word.strip() for word in asked.split(",")]
    hint = "such as f,re,im or f_khz,-,mag_db,phase_deg: f, omega, re, im, mag, mag_db, phase, coh, h, psd, -"
    if len(words) > width:
        called = [name[:30] for name in names if name]
        listed = f": {', '.join(called[:LISTED])}{', ...' if len(called) > LISTED else ''}" if called else ""
        raise refused(f"--columns has {len(words)} words, and there are {width} columns{listed}", hint)
    columns = []
    for word in words:
        meaning = ColumnMeaning("complex") if word in ("h", "H", "complex") else meaning_of(word)
        if not meaning.kind and word not in ("", "-"):
            raise refused(f"--columns: unknown column '{word[:40]}'", hint)
        if meaning.kind == "frequency" and meaning.factor is None and not meaning.unit:
            meaning = replace(meaning, factor=1.0)
        if meaning.kind == "magnitude" and meaning.scale == "unknown":
            meaning = replace(meaning, scale="linear")
        columns.append(meaning)
    return columns + [ColumnMeaning()] * (width - len(words))


def size_of(column: DataColumn, scale: str) -> Real:
    """Return a magnitude from numbers on a scale: linear, decibel or logarithm; nan where it is negative."""
    numbers = column.numbers.real / (100 if column.meaning.unit == "%" else 1)
    if scale in ("decibel", "logarithm"):
        return np.asarray(10 ** (numbers / (20 if scale == "decibel" else 1)))
    numbers = np.where(numbers < 0, np.nan, numbers)
    return np.asarray(np.sqrt(numbers) if column.meaning.kind == "power" else numbers)
