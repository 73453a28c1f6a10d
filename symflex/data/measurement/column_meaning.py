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

from symflex.data.measurement.text_table import bare
from symflex.errors import Span, refused

Real = npt.NDArray[np.float64]

WORDS: Final = {
    "coherence": "coherence coh gamma2 gamma^2 coherency kohärenz cohérence coherencia coerenza",
    "phase": "phase phas phs pha phse angle ang arg argument phi φ θ θz theta zphz ph cph winkel fase fas "
    "phasenwinkel phasengang déphasage faza фаза 相位 位相",
    "imaginary": "im imag imaginary imaginär imaginärteil imaginaire imaginaria immaginaria zim zimag zimg "
    "z'' zs'' quadrature 虚部",
    "real": "re real realteil réel réelle reale zre zreal z' zs' inphase 実部 实部",
    "power": "psd power pxx autopower",
    "magnitude": "magnitude mag magn magnitud magnitudine gain amplitude ampl amp amplitud ampiezza abs "
    "ganho ganancia guadagno modulus module modulo módulo level spl |h| |z| z zmod impedance imp betrag "
    "transmissibility verstärkung pegel logmag linmag db dbspl dbv dbr амплитуда 幅值 幅度 振幅 ゲイン 利得",
    "omega": "omega w ω angular",
    "frequency": "frequency freq frequencies freqs frq acfrequency f hz fhz khz mhz ghz stimulus hertz "
    "frequenz fréquence frequenza frecuencia frequência frekvens frequentie частота 频率 周波数",
}  # fmt: skip
"""Words by which a column is known, the first kind that has one of them."""
KINDS: Final = {word: kind for kind, words in WORDS.items() for word in words.split()}
_SPREAD: Final = frozenset("std stdev sd sigma err unc uncertainty var variance snr thd margin".split())
"""Words of columns that say how accurate others are, or how far from a limit."""
_PARTS: Final = r"gamma\^?2|[^\W\d_]+'*|\|\w\|"
OHMS: Final = ("ohm", "ohms", "\u03c9", "\u2126")
FREQUENCY_UNITS: Final = {
    **dict.fromkeys(("hz", "hertz", "гц"), 1.0), "khz": 1e3, "mhz": 1e6, "ghz": 1e9,
    **dict.fromkeys(("rad/s", "rad_s", "rads", "rad/sec", "rad/second"), 1 / (2 * np.pi)),
}  # fmt: skip
_DEGREES: Final = (
    "deg", "degree", "degrees", "grad", "grados", "degrés", "gradi", "graden", "grader", "graus", "град",
    "度", "degs", "°", "º", "ø", "*", "\ufffd",
)  # fmt: skip
PHASE_UNITS: Final = dict.fromkeys(_DEGREES, np.pi / 180) | dict.fromkeys(
    ("rad", "radian", "radians", "rads"), 1.0
)
_LEVELS: Final = ("db", "дб", "decibel")
UNITS: Final = frozenset((*FREQUENCY_UNITS, *PHASE_UNITS, *_LEVELS, *OHMS))
_SPICE = re.compile(r"\bv(db|p|m|r|i)(?=\()|\bi(db|p)(?=\()|\b(p)(?=\([vi]\()|^(r|i)(?= \S+\.[vi]$)", re.I)
_SPICE_KINDS: Final = {"db": "db", "p": "phase", "m": "mag", "r": "re", "i": "im"}
"""Functions by which circuit simulators name columns: VDB(out), P(V(out)), r out.v."""
LISTED = 12  # names of columns in a message; of more there are dots
_NEGATIVE = re.compile(r"(?:-|neg(?:ative)?\b\.?|minus\b)\s*(?=\D)", re.I)
_JOINED = re.compile(
    r"(?<=[a-z]{3})(?=[A-Z][a-z]|dB\b)|(?<=^[GHYZ])(?=(?:re|im)(?:al|ag)?\b)|(?<=^Re|^Im)(?=[A-Z]\d*$)"
)
"""Where words are joined: FrequencyHz, magdB, Hreal, ImH."""
IN_OR_OUT = re.compile(r"(?:v|u|i|signal|voltage|ch\w?)?[ _.(]*(in|out)(?:put)?\)?", re.I)
"""Labels of what goes in and what comes out: Vin, V(out), u_in, Output."""
OTHER_SIZE = re.compile(r"squared|(?:\||mag\w*)\s*(?:\^2|²)|^ln\b|[([]\s*(?:np|nepers?)\s*[])]", re.I)
"""Names of squares and natural logarithms of magnitudes, which are no magnitudes."""
_LEVEL = re.compile(r"\b[12]0\s*\*?\s*log(?:_?10)?\s*(?:db\b)?", re.I)
"""What a level in dB is: of a power ten times its logarithm."""
_LOGARITHM = re.compile(r"^l(?:og|g)(?:_?10)?(?![\s_]*mag)[\s_]*(?=[\W_f]|omega|freq|[wz]\b)", re.I)
_LETTERS: Final = {
    ("x", "y"): ("real", "imaginary"),  # of lock-in amplifiers
    ("i", "q"): ("real", "imaginary"),
    ("r", "x"): ("real", "imaginary"),  # of impedances
    ("rs", "xs"): ("real", "imaginary"),
    ("g", "b"): ("real", "imaginary"),  # of admittances
}
"""Letters that mean something as a pair alone."""
_BRACKET = re.compile(r"[\[({<]\s*([^\[\](){}<>]*(?:\([^()]*\)[^\[\](){}<>]*)?)\s*[\])}>]")
_SUFFIX = re.compile(
    r"(?:[\s_/,:.]|\bin |(?<=\w\d)(?=d))\s*(hz|khz|mhz|ghz|rad/s|rad_s|db|deg|degrees?|rad|radians?|ohms?|"
    r"°|º|гц|дб|grad|град)\s*$"
    r"|(?<=\S)\s+/\s+(\S+)\s*$",
    re.I,
)
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
    written = re.sub(r"(?<=z)\"(?=\W)", "''", bare(name).strip(" #*%!;:"), flags=re.I).replace("µ", "u")
    unit = unit_below.strip("[]<> ").replace("µ", "u")
    unit = unit[1:-1] if re.fullmatch(r"\([^()]*\)", unit) else unit
    text, sign, is_log = _spelled(written)
    if text.strip().lower() in PHASE_UNITS:
        unit = text.strip()
    for bracket in _BRACKET.finditer(text):
        inside = bracket[1].strip()
        parts = re.findall(_PARTS, inside.lower())
        is_unit = inside.lower() in UNITS or inside == "F"  # farad
        is_named = "_" in inside and not is_unit  # Re(A_1/F); units have no underscore
        is_argument = re.search(r"\w$", text[: bracket.start()]) and (
            is_named or re.fullmatch(r"/?[\w .]*(?:\([\w .,]*\))?[\w .]*", inside)
        )
        if (
            is_unit
            or ("/" in inside[1:] and not is_named)
            or not (is_argument or unit.lower() in UNITS or any(p in KINDS for p in parts))
        ):
            unit, text = inside, text.replace(bracket[0], " " * len(bracket[0]))
    if not unit and (match := _SUFFIX.search(text)):
        unit, text = match[1] or match[2], text[: match.start()]
    if not unit and (match := re.match(r"deg(?=[:(])", text, re.I)):
        unit, text = match[0], text[match.end() :]
    low = re.sub(r"in[-_]phase", "inphase", text.lower())
    words = re.findall(_PARTS, re.sub(r"(?<=\w)\s*/\s*f(?![^\W\d_])", " ", low))  # F in X/F is a force
    kind = next((k for k in WORDS if any(KINDS.get(w) == k for w in words)), "")
    if not kind and unit:
        is_size = unit.lower() in _LEVELS or (unit.lower() in OHMS and low.startswith("z"))
        is_phase = unit.lower() in (*_DEGREES[:-2], low)
        is_frequency = unit.lower() in FREQUENCY_UNITS
        kind = "magnitude" if is_size else "frequency" if is_frequency else "phase" if is_phase else ""
    kind, unit = ("magnitude", text.strip()) if not kind and text.strip().lower() in OHMS else (kind, unit)
    if unit.lower() in FREQUENCY_UNITS and {"frequency", "freq"} & set(words):
        kind = "frequency"  # "Frequency - Phase (Hz)", beside the phase
    if kind == "phase" and unit.lower() not in PHASE_UNITS and set(_DEGREES) & set(words):
        unit = "deg"
    is_of_other = kind in ("frequency", "omega") and (
        {"response", "function", "ln"} & set(words) or re.search(r"\b[fwω]\s*/\s*[fwω]", low)
    )
    is_other_size = kind == "magnitude" and unit.lower() not in _LEVELS and OTHER_SIZE.search(written)
    kind = "" if is_of_other or is_other_size or _SPREAD & set(words) else kind
    word = next((w for w in words if KINDS.get(w) == kind), "")

    def kept(match: re.Match[str]) -> str:
        part = match[0].lower()
        return "" if part == word or (len(part) > 1 and part in KINDS) else match[0]

    label = " ".join(re.sub(_PARTS, kept, text).split())
    label = re.sub(r"[(\[]\W*[)\]]", "", label).strip(" :;,.-_'|")
    label = label[1:-1] if re.fullmatch(r"\([^()]*\)", label) else label
    if not kind and IN_OR_OUT.fullmatch(label):
        kind = "magnitude"
    if kind in ("magnitude", "power") and not unit:
        unit = "dB" if "db" in words else "lin" if {"abs", "lin", "linear"} & set(words) else ""
    meaning = ColumnMeaning(kind, label=label, unit=unit, word=word)
    return _with_unit(meaning, unit, sign, is_log or (kind != "magnitude" and "log" in words))


def _spelled(written: str) -> tuple[str, float, bool]:
    """Return a name in the usual words, without the sign before it and whether it is a logarithm."""
    text = re.sub(
        r"\bdb\s+re\b[^)\]]*", "dB", written.replace("\u2220", "phase ").replace("Â°", "°"), flags=re.I
    )
    text = re.sub(r"\|([^|hz]|[^|]{2,})\|", r"mag \1", text, flags=re.I)
    text = _SPICE.sub(lambda m: _SPICE_KINDS[(m[1] or m[2] or m[3] or m[4]).lower()], text)
    text = re.sub(
        r"^(l\w+)\s*\(\s*([^()/]+)/([^()/]+)\)",
        r"\1 \2 [\3]",
        _LEVEL.sub(lambda m: "power " * (m[0][0] == "1") + "dB", text),
        flags=re.I,
    )
    is_log = bool(_LOGARITHM.match(text))
    text = _LOGARITHM.sub("", text)
    sign = -1.0 if _NEGATIVE.match(text) else 1.0
    text = _NEGATIVE.sub("", text, count=1) if sign < 0 else text
    return text, sign, is_log


def _with_unit(column: ColumnMeaning, unit: str, sign: float, is_log: bool) -> ColumnMeaning:
    small = unit.lower().rstrip(".")
    if column.kind in ("frequency", "omega"):
        own = "rad/s" if column.kind == "omega" else column.word if column.word in FREQUENCY_UNITS else ""
        is_angular = small == "rad" or (column.kind == "omega" and small in ("1/s", "s^-1"))
        factor = 1e-3 if unit == "mHz" else FREQUENCY_UNITS.get("rad/s" if is_angular else small or own)
        return replace(column, kind="frequency", factor=factor, scale="logarithm" if is_log else "linear")
    if column.kind == "phase":
        factor = PHASE_UNITS.get(small)
        return replace(column, factor=None if factor is None else sign * factor)
    if column.kind in ("magnitude", "power"):
        is_level = small.startswith(_LEVELS) or column.word.startswith(("db", "logmag", "spl"))
        plain = "logarithm" if is_log else "unknown" if small in ("", "-") else "linear"
        return replace(column, scale="decibel" if is_level else plain)
    return replace(column, factor=sign)


def meanings_of(names: Sequence[str], units_below: Sequence[str] = ()) -> list[ColumnMeaning]:
    """Return what columns are; letters such as X and Y, or R and theta, mean something beside each other.

    >>> [m.kind for m in meanings_of(["Freq", "X (V)", "Y (V)"])]
    ['frequency', 'real', 'imaginary']
    """
    below = list(units_below) or [""] * len(names)
    read = [meaning_of(name, unit) for name, unit in zip(names, below, strict=True)]
    apart = [meaning_of(_JOINED.sub(" ", name), unit) for name, unit in zip(names, below, strict=True)]
    read = [other if other.kind and not one.kind else one for one, other in zip(read, apart, strict=True)]
    kinds = {m.kind for m in read}
    if "phase" in kinds and "magnitude" not in kinds:  # "H1 (g/N)" beside "H1 Phase (deg)"
        turned = {m.label for m in read if m.kind == "phase"}
        ratios = {m.label for m in read if not m.kind and "/" in m.unit + m.label}
        turned = ratios if turned == {""} and len(ratios) == 1 else turned - {""}  # "Receptance (m/N)"
        for i, m in enumerate(read):
            if not m.kind and m.label in turned and "/" in m.unit + m.label:
                read[i] = meaning_of(f"magnitude {m.label}", m.unit)
        kinds = {m.kind for m in read}
    if "frequency" not in kinds or {"real", "imaginary"} <= kinds or {"magnitude", "phase"} <= kinds:
        return read
    letters: dict[str, int] = {}
    for i, meaning in enumerate(read):
        if not meaning.kind and (first := re.match(r"[a-z]{1,2}\b", meaning.label, re.I)):
            letters.setdefault(first[0].lower(), i)
    pairs = [pair for pair in _LETTERS if set(pair) <= set(letters)]
    if "phase" in kinds and "r" in letters:
        read[letters["r"]] = replace(meaning_of("magnitude", read[letters["r"]].unit), word="r")
    elif len(pairs) == 1 and not any(m.word == "z" for m in read):
        for letter, kind in zip(pairs[0], _LETTERS[pairs[0]], strict=True):
            i = letters[letter]
            read[i] = ColumnMeaning(kind, 1.0, unit=read[i].unit, word=letter)
    return read


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
