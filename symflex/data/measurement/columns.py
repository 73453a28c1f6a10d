"""What columns mean, by their names or as ``--columns`` says, and the responses they make.

    "Trace 1: Gain: Magnitude (dB)"   ->  magnitude in dB, of "Trace 1"
    "-Im(Z)/Ohm"                      ->  imaginary part times -1

A unit that is not said is found from the numbers. Logarithm of magnitude and phase of a causal function are
Hilbert transforms of each other, so their slopes have equal energy (Titchmarsh 1937, theorem 90), and so has
circular noise: a phase read in the wrong unit is 57 times too steep or too flat. Straight lines, which powers
of s and delays add, are taken out before. What stays open is asked for.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise, permutations, product
from typing import Any, Final, TypeVar

import numpy as np
import numpy.typing as npt

from symflex.data.measurement.measured_response import MAX_ERRORS, MAX_RESPONSES, are_few, unit_of
from symflex.data.measurement.text_table import bare
from symflex.errors import DataError, Diagnostic, Span, nearest, refused

Choice = TypeVar("Choice", str, float)
Real = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]

_WORDS: Final = {
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
KINDS: Final = {word: kind for kind, words in _WORDS.items() for word in words.split()}
_SPREAD: Final = frozenset("std stdev sd sigma err unc uncertainty var variance snr thd margin".split())
"""Words of columns that say how accurate others are, or how far from a limit."""
_PARTS: Final = r"gamma\^?2|[^\W\d_]+'*|\|\w\|"
_OHMS: Final = ("ohm", "ohms", "\u03c9", "\u2126")
_FREQUENCY_UNITS: Final = {
    **dict.fromkeys(("hz", "hertz", "гц"), 1.0), "khz": 1e3, "mhz": 1e6, "ghz": 1e9,
    **dict.fromkeys(("rad/s", "rad_s", "rads", "rad/sec", "rad/second"), 1 / (2 * np.pi)),
}  # fmt: skip
_DEGREES: Final = (
    "deg", "degree", "degrees", "grad", "grados", "degrés", "gradi", "graden", "grader", "graus", "град",
    "度", "degs", "°", "º", "ø", "*", "\ufffd",
)  # fmt: skip
_PHASE_UNITS: Final = dict.fromkeys(_DEGREES, np.pi / 180) | dict.fromkeys(
    ("rad", "radian", "radians", "rads"), 1.0
)
_LEVELS: Final = ("db", "дб", "decibel")
UNITS: Final = frozenset((*_FREQUENCY_UNITS, *_PHASE_UNITS, *_LEVELS, *_OHMS))
_SPICE = re.compile(r"\bv(db|p|m|r|i)(?=\()|\bi(db|p)(?=\()|\b(p)(?=\([vi]\()|^(r|i)(?= \S+\.[vi]$)", re.I)
_SPICE_KINDS: Final = {"db": "db", "p": "phase", "m": "mag", "r": "re", "i": "im"}
"""Functions by which circuit simulators name columns: VDB(out), P(V(out)), r out.v."""
LISTED = 12  # names of columns in a message; of more there are dots
_NEGATIVE = re.compile(r"(?:-|neg(?:ative)?\b\.?|minus\b)\s*(?=\D)", re.I)
_JOINED = re.compile(
    r"(?<=[a-z]{3})(?=[A-Z][a-z]|dB\b)|(?<=^[GHYZ])(?=(?:re|im)(?:al|ag)?\b)|(?<=^Re|^Im)(?=[A-Z]\d*$)"
)
"""Where words are joined: FrequencyHz, magdB, Hreal, ImH."""
_END = re.compile(r"(?:v|u|i|signal|voltage|ch\w?)?[ _.(]*(in|out)(?:put)?\)?", re.I)
"""Labels of what goes in and what comes out: Vin, V(out), u_in, Output."""
_OTHER_SIZE = re.compile(r"squared|(?:\||mag\w*)\s*(?:\^2|²)|^ln\b|[([]\s*(?:np|nepers?)\s*[])]", re.I)
"""Names of squares and natural logarithms of magnitudes, which are no magnitudes."""
_LEVEL = re.compile(r"\b[12]0\s*\*?\s*log(?:_?10)?\s*(?:db\b)?", re.I)
"""What a level in dB is: of a power ten times its logarithm."""
_LOGARITHM = re.compile(r"^l(?:og|g)(?:_?10)?(?![\s_]*mag)[\s_]*(?=[\W_f]|omega|freq|[wz]\b)", re.I)
_NO_WORD = re.compile(
    rf"{_OTHER_SIZE.pattern}|\b(?:time|zeit|temps|tiempo)\b|^t\b|^f\s*/\s*f|\b(?:shift|detuning)\b", re.I
)
"""Names of what no word of ``--columns`` means."""
_SIGNALS: Final = dict.fromkeys(("e", "v", "u", "voltage"), "out") | dict.fromkeys(("i", "current"), "in")
"""Labels of a voltage and a current, whose ratio is an impedance."""
_FORCE = re.compile(r"force|hammer|excitation|kraft", re.I)
CROSS = re.compile(r"[sgp]_?(?:xy|yx)|.*\b(?:csd|cross)\b.*", re.I)
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
HINT: Final = (
    "columns: frequency_hz; re, im or magnitude_db, phase_deg or magnitude, phase_rad; coherence if known"
)
WITHOUT_TIME: Final = "of a record in time, say the sampling time: --columns {}"
WITHOUT_AXIS: Final = "if the file has no frequencies, --from HZ --step HZ give them"
UNDECIDED: Final = 1.5  # natural logarithm of how much less causal the other reading has to be
WRAPPED: Final = 2 * np.pi * 1.001  # largest range of phases that may have been wrapped
FITS: Final = 1.0  # beyond it numbers are like no causal function: the ratio of energies is beyond a factor e
DECADE: Final = 10.0  # ratio of the largest and smallest of positive numbers up to which they may well be dB
LEAST_LEVELS: Final = 1.0  # range [dB] below which positive numbers are rather ratios
SAME_SIZE: Final = 0.02  # relative deviation up to which a value is that of another column, of few digits
MOST_ALIKE: Final = 0.9  # share of lines from which a column is another one, or a counter
MOST_LISTED: Final = 6  # columns that are not used and are listed by name
ROUNDED_COHERENCE: Final = 1.01  # up to which coherence was rounded upwards
EVENLY, HELD = 0.02, 0.1  # median deviation of a time's steps; share of equal neighbours in signals
FILLED: Final = 0.95
SAME_BAND: Final = 0.5  # share of each sweep's lines in the band common to all; with less, they are segments
SAME_FREQUENCY: Final = 1e-3  # relative distance up to which two columns hold the same frequency
SAME_PHASE: Final = 1e-2  # median difference [rad] of one phase in degrees and in radians
UNLIKE, CLEARLY = 0.1, 4.0  # mean of 1 - cos of phases that are alike; how much closer one has to be
FEWEST_TO_DECIDE: Final = 8
MOST_DECADES: Final = 18  # decimal logarithm of the highest frequency [Hz]: larger ones are no logarithms
ROUND: Final = 1e-7  # relative deviation from three digits below which a number was meant to be round
LONGEST_NAME: Final = 200
BEYOND: Final = 7.0  # how far a magnitude is continued beyond its ends: a factor e^7 in frequency


@dataclass(frozen=True, slots=True)
class ColumnMeaning:
    """What a column is."""

    kind: str = ""  # of _WORDS without omega, or complex; empty where it is none of these
    factor: float | None = 1.0  # to Hz or radians; None if no unit is said
    scale: str = "linear"  # or decibel, logarithm (of a frequency, to base 10), unknown
    label: str = ""  # of which response
    unit: str = ""  # as written
    word: str = ""  # the one by which it is known


_RATIO: Final = ColumnMeaning("magnitude", word="ratio")


@dataclass(frozen=True, slots=True, eq=False)
class DataColumn:
    """One column of a table."""

    name: str
    meaning: ColumnMeaning
    numbers: npt.NDArray[Any]  # nan where there is none
    wrong: tuple[int, ...] = ()  # rows without a number
    span: Span | None = None  # of its name
    place: Callable[[int], Span | None] = lambda _: None


@dataclass(frozen=True, slots=True, eq=False)
class Assembled:
    """A response that columns make."""

    label: str
    frequency_hz: Real
    values: Complex
    coherence: Real | None
    unit: str
    columns: tuple[DataColumn, ...]  # frequency, value, coherence
    is_magnitude: bool = False  # whether there is no phase


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
    if text.strip().lower() in _PHASE_UNITS:
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
    kind = next((k for k in _WORDS if any(KINDS.get(w) == k for w in words)), "")
    if not kind and unit:
        is_size = unit.lower() in _LEVELS or (unit.lower() in _OHMS and low.startswith("z"))
        is_phase = unit.lower() in (*_DEGREES[:-2], low)
        is_frequency = unit.lower() in _FREQUENCY_UNITS
        kind = "magnitude" if is_size else "frequency" if is_frequency else "phase" if is_phase else ""
    kind, unit = ("magnitude", text.strip()) if not kind and text.strip().lower() in _OHMS else (kind, unit)
    if unit.lower() in _FREQUENCY_UNITS and {"frequency", "freq"} & set(words):
        kind = "frequency"  # "Frequency - Phase (Hz)", beside the phase
    if kind == "phase" and unit.lower() not in _PHASE_UNITS and set(_DEGREES) & set(words):
        unit = "deg"
    is_of_other = kind in ("frequency", "omega") and (
        {"response", "function", "ln"} & set(words) or re.search(r"\b[fwω]\s*/\s*[fwω]", low)
    )
    is_other_size = kind == "magnitude" and unit.lower() not in _LEVELS and _OTHER_SIZE.search(written)
    kind = "" if is_of_other or is_other_size or _SPREAD & set(words) else kind
    word = next((w for w in words if KINDS.get(w) == kind), "")

    def kept(match: re.Match[str]) -> str:
        part = match[0].lower()
        return "" if part == word or (len(part) > 1 and part in KINDS) else match[0]

    label = " ".join(re.sub(_PARTS, kept, text).split())
    label = re.sub(r"[(\[]\W*[)\]]", "", label).strip(" :;,.-_'|")
    label = label[1:-1] if re.fullmatch(r"\([^()]*\)", label) else label
    if not kind and _END.fullmatch(label):
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
        own = "rad/s" if column.kind == "omega" else column.word if column.word in _FREQUENCY_UNITS else ""
        is_angular = small == "rad" or (column.kind == "omega" and small in ("1/s", "s^-1"))
        factor = 1e-3 if unit == "mHz" else _FREQUENCY_UNITS.get("rad/s" if is_angular else small or own)
        return replace(column, kind="frequency", factor=factor, scale="logarithm" if is_log else "linear")
    if column.kind == "phase":
        factor = _PHASE_UNITS.get(small)
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


def names_of(made: Sequence[Assembled], stem: str) -> list[str]:
    """Return what responses are called: the file's stem, their labels, or the stem with a number."""
    labels = [one.label for one in made]
    if len(made) == 1 or (all(labels) and len(set(labels)) == len(labels)):
        return [stem] if len(made) == 1 else labels
    return [f"{stem} {i + 1}" for i in range(len(made))]


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


def assembled(
    columns: Sequence[DataColumn], file: str, header: Span | None, *, is_asked: bool = False
) -> tuple[list[Assembled], list[str]]:
    """Return the responses that columns make, and what was guessed, as a phase that is not there."""
    guesses: list[str] = []
    columns = _with_frequency(list(columns), file, header, guesses, is_asked=is_asked)
    columns = _over_input(columns, guesses)
    crossed = next((c for c in columns if CROSS.fullmatch(c.meaning.label) and c.meaning.kind), None)
    if crossed is not None and not is_asked:
        message = f"column '{crossed.name[:40]}' is named like a cross spectrum, which is not a response"
        hint = "divide it by the spectrum of the input, or say with --columns what the columns are"
        raise DataError(Diagnostic("SF602", message, crossed.span, hint))
    made: list[Assembled] = []
    used: set[int] = set()
    for frequency, *rest in _sections(columns):
        lines = _hertz(frequency, guesses)
        for label, own in _groups(rest, is_asked=is_asked, guesses=guesses):
            group = _without_zeros(own, guesses)
            values = _values(group, lines, guesses, columns)
            coherence = group.get("coherence")
            unit = ratio_unit(next(iter(group.values())).meaning.unit, file)
            shares = None if coherence is None else _shares(coherence, guesses)
            kept = (frequency, *group.values())
            used |= {id(c) for c in kept} if np.any(values) else set()
            same = [m for m in made if m.label != label and m.values.shape == values.shape]
            with np.errstate(all="ignore"):
                inverse = next((m for m in same if np.allclose(values * m.values, 1, rtol=1e-3)), None)
            if inverse:  # poles of the one are zeros of the other
                guesses.append(f"'{label[:30]}' is the reciprocal of '{inverse.label[:30]}' and is left out")
            elif not any(np.array_equal(values, m.values, equal_nan=True) for m in same):
                is_magnitude = not group.keys() & {"complex", "real", "phase"}
                made.append(Assembled(label, lines, values, shares, unit, kept, is_magnitude))
    if not made:
        raise DataError(_missing(columns, file, header))
    settings = [c.numbers.real for c in columns if not c.meaning.kind]
    made = [sweep for m in made for sweep in _sweeps(m, settings, guesses)]
    made = [m for m in made if np.any(m.values)] or made  # memories of analysers that contain nothing
    if len(made) > MAX_RESPONSES:
        raise DataError(Diagnostic("SF607", f"'{file}' contains more than {MAX_RESPONSES} responses"))
    made = _made_over_input(made, guesses)
    gappy = [m for m in made if not are_few(~np.isfinite(m.values))]
    if problems := [d for m in gappy for c in m.columns for d in _wrong(c, m.frequency_hz)]:
        raise DataError(*problems[:MAX_ERRORS])
    names = dict.fromkeys(c.name for c in columns if id(c) not in used and not is_asked)
    unused = [f"'{name[:30]}'" for name in names if name]
    if any(not c.name and id(c) not in used for c in columns[1:] if header and not is_asked):
        unused.append("without a name")
    if unused:
        listed = ", ".join(unused[:MOST_LISTED])
        listed += ", ..." if len(unused) > MOST_LISTED else ""
        guesses.append(f"{'columns' if len(unused) > 1 else 'column'} {listed} not used")
    return made, list(dict.fromkeys(guesses))


@np.errstate(all="ignore")  # numbers that are not finite are reported elsewhere
def _sweeps(one: Assembled, settings: Sequence[Real], guesses: list[str]) -> list[Assembled]:
    """Return the sweeps of a response that goes through its band more than once."""
    # Those of one direction and the same frequencies are averaged, unless another column has a setting that
    # changed; others are kept apart, since a response may depend on the direction.
    lines, starts = one.frequency_hz, [0]
    ways = np.sign(np.diff(lines))
    for turn in (np.flatnonzero(np.diff(ways)) + 1).tolist():
        starts += [turn + 1] * (turn > starts[-1])
    if not 1 < len(starts) <= lines.size // FEWEST_TO_DECIDE:
        return [one]
    runs = [slice(*ends) for ends in pairwise([*starts, lines.size])]
    parts = [lines[run] for run in runs]
    low, high = max(map(np.min, parts)), min(map(np.max, parts))
    if min(float(np.mean((part >= low) & (part <= high))) for part in parts) < SAME_BAND:
        return [one]
    groups: dict[int, list[slice]] = {}
    held = [x for x in settings if x.shape == lines.shape and all(np.ptp(x[run]) == 0 for run in runs)]
    for i, part in enumerate(parts):
        alike = (k for k in groups if all(x[starts[k]] == x[starts[i]] for x in held))
        alike = (k for k in alike if parts[k].shape == part.shape)
        first = next((k for k in alike if np.allclose(parts[k], part, SAME_FREQUENCY, 0)), i)
        groups.setdefault(first, []).append(runs[i])
    is_both_ways = sorted(ways[runs[k].start] for k in groups) == [-1, 1]
    made = []
    for number, (k, same) in enumerate(groups.items(), 1):
        way = {1: " up", -1: " down"}[ways[runs[k].start]] if is_both_ways else f" sweep {number}"
        arrays = (x for x in (one.values, np.abs(one.values), one.coherence) if x is not None)
        values, size, *shares = (np.mean([x[run] for run in same], axis=0) for x in arrays)
        made.append(
            replace(
                one,
                label=(one.label + way * (len(groups) > 1)).strip(),
                frequency_hz=parts[k],
                values=size * np.exp(1j * minimum_phase(parts[k], size)) if one.is_magnitude else values,
                coherence=shares[0] if shares else None,
                columns=tuple(_below(c, runs[k]) for c in one.columns),
            )
        )
    apart = ", or kept apart: " + ", ".join(m.label for m in made) if len(made) > 1 else ""
    guesses.append(f"{len(runs)} sweeps: those with the same frequencies are averaged{apart}")
    return made


def _below(column: DataColumn, rows: slice) -> DataColumn:
    wrong = tuple(row - rows.start for row in column.wrong if rows.start <= row < rows.stop)
    place = column.place
    return replace(column, wrong=wrong, place=lambda row: place(row + rows.start))


def _with_frequency(
    columns: list[DataColumn], file: str, header: Span | None, guesses: list[str], *, is_asked: bool
) -> list[DataColumn]:
    problems = []
    for c in columns:
        is_unknown = c.meaning.kind in ("frequency", "phase") and c.meaning.factor is None
        if is_unknown and c.meaning.unit not in ("-", ""):
            units = _FREQUENCY_UNITS if c.meaning.kind == "frequency" else _PHASE_UNITS
            said = f"unknown unit '{c.meaning.unit[:20]}' of column '{c.name[:40]}'"
            problems.append(Diagnostic("SF602", said, c.span, f"units: {', '.join(list(units)[:5])}"))
    if problems:
        raise DataError(*problems[:MAX_ERRORS])
    lines = [c for c in columns if c.meaning.kind == "frequency"]
    shift, centre = (
        next((c for c in lines if re.search(word, c.name, re.I)), None)
        for word in (r"\bshift\b|detun", r"cent(?:er|re)")
    )
    if shift is not None and centre is not None and shift is not centre:
        guesses.append(f"the frequency is '{shift.name[:30]}' plus '{centre.name[:30]}'")
        numbers, meaning = _hertz(shift, []) + _hertz(centre, []), ColumnMeaning("frequency")
        total = replace(shift, numbers=numbers, meaning=meaning)
        return [total if c is shift else c for c in columns if c is not centre]
    if shift is not None and lines == [shift] and not is_asked:
        message = f"'{shift.name[:40]}' is a distance from a frequency, and no column has that frequency"
        hint = "add it to the column, and call the sum frequency_hz"
        raise DataError(Diagnostic("SF602", message, shift.span, hint))
    if lines:
        return columns
    first = columns[0]
    steps = np.diff(first.numbers.real)
    is_named = re.search(r"[^\W\d_]", first.name) and not re.match(r"x\b|x_", first.name, re.I)
    is_index = counts(first.numbers) and not first.meaning.unit
    is_monotonic = np.all(steps > 0) or np.all(steps < 0)
    if first.meaning.kind or is_named or is_index or not steps.size or not is_monotonic:
        place = "" if header else f"'{file}': "
        raise DataError(Diagnostic("SF602", f"{place}no column is the frequency", header, ask(columns)))
    factor = _FREQUENCY_UNITS.get(first.meaning.unit.lower())
    unit = first.meaning.unit if factor else unit_by_round_ends(first.numbers.real) or "Hz"
    why = ", in which its ends are round numbers" if unit == "rad/s" and not factor else ""
    guesses.append(f"column 1 has no name and is taken as the frequency in {unit}{why}")
    return [replace(first, meaning=ColumnMeaning("frequency", _FREQUENCY_UNITS[unit.lower()])), *columns[1:]]


def _over_input(columns: list[DataColumn], guesses: list[str]) -> list[DataColumn]:
    """Return columns with what comes out over what goes in, where both are sizes without phases."""
    sizes = [c for c in columns if c.meaning.kind in ("magnitude", "power")]
    ends = {c: match[1].lower() for c in sizes if (match := _END.fullmatch(c.meaning.label))}
    turned = [re.split(r"\s*[-/]\s*", c.meaning.label) for c in columns if c.meaning.kind == "phase"]
    if not ends and [len(labels) for labels in turned] == [2]:  # one phase, of CH2-CH1
        ends = {c: ("out", "in")[turned[0].index(x)] for c in sizes if (x := c.meaning.label) in turned[0]}
    labels = {c.meaning.label for c in ends}
    if any(c.meaning.label in labels for c in columns if c.meaning.kind and c not in ends):
        return columns
    if len(sizes) > len(ends):
        return [replace(c, meaning=ColumnMeaning()) if c in ends else c for c in columns]
    kinds = {c.meaning.kind for c in ends}
    if sorted(ends.values()) != ["in", "out"] or len(kinds) != 1:
        return columns
    over, result = sorted(ends, key=lambda c: ends[c])
    ratio = _plain_size(result) / np.where(_plain_size(over) == 0, np.nan, _plain_size(over))
    guesses.append(f"the magnitude is '{result.name[:30]}' over '{over.name[:30]}'")
    whole = replace(result, meaning=_RATIO, numbers=ratio, wrong=tuple({*result.wrong, *over.wrong}))
    return [whole if c is result else c for c in columns if c is not over]


def _plain_size(column: DataColumn) -> Real:
    is_level = column.meaning.scale == "unknown" and np.any(column.numbers.real < 0)
    with np.errstate(all="ignore"):
        return _size(column, "decibel" if is_level else column.meaning.scale)


def _made_over_input(made: list[Assembled], guesses: list[str]) -> list[Assembled]:
    """Return one response for two, of which one is what goes in and the other what comes out."""
    ends = [match[1].lower() if (match := _END.fullmatch(m.label)) else "" for m in made]
    signals = [_SIGNALS.get(m.label.lower(), "") for m in made]
    if any(signals) and any(m.label.lower() in ("z", "impedance") for m in made):
        listed = ", ".join(f"'{m.label}'" for m, signal in zip(made, signals, strict=True) if signal)
        guesses.append(f"{listed} beside the impedance: signals, not responses, and left out")
        return [m for m, signal in zip(made, signals, strict=True) if not signal]
    ends = signals if all(signals) else ends
    forces = [bool(_FORCE.fullmatch(m.label)) and "/" not in m.columns[1].meaning.unit for m in made]
    if sorted(forces) == [False, True]:
        ends = ["in" if is_force else "out" for is_force in forces]
    if sorted(ends) != ["in", "out"] or not np.array_equal(made[0].frequency_hz, made[1].frequency_hz):
        return made
    over, result = (made[ends.index(end)] for end in ("in", "out"))
    guesses.append(f"the response is '{result.label[:30]}' over '{over.label[:30]}'")
    with np.errstate(all="ignore"):
        return [replace(result, label="", values=result.values / over.values, unit="")]


def _sections(columns: Sequence[DataColumn]) -> list[list[DataColumn]]:
    """Return each frequency column with the columns that belong to it."""
    lines = [c for c in columns if c.meaning.kind == "frequency"]
    first, *others = sorted(lines, key=lambda c: (c.meaning.scale == "logarithm", c.meaning.factor is None))
    own = [first]
    for other in others:
        a, b = _hertz(first, []), _hertz(other, [])
        if a.shape != b.shape or not np.allclose(a, b, rtol=SAME_FREQUENCY, equal_nan=True):
            own.append(other)
    rest = [c for c in columns if c.meaning.kind != "frequency"]
    if len(own) == 1:
        return [[first, *rest]]
    order = list(columns)
    begins = sorted(map(order.index, own))
    cuts = pairwise([*begins, len(order)])
    sections = [[c for c in order[a:b] if c.meaning.kind != "frequency"] for a, b in cuts]
    if not any(sections[:-1]) and all(_is_rounded(first, other) for other in own[1:]):
        return [[first, *rest]]
    if not all(any(c.meaning.kind for c in one) for one in sections):
        message = "there are two frequency columns with different values"
        raise DataError(Diagnostic("SF602", message, own[1].span, ask(columns)))
    return [[order[a], *one] for a, one in zip(begins, sections, strict=True)]


def _is_rounded(first: DataColumn, other: DataColumn) -> bool:
    """Return whether a column has the frequencies of another, but for digits that the smallest lost."""
    a, b = _hertz(first, []), _hertz(other, [])
    with np.errstate(all="ignore"):
        return a.shape == b.shape and bool(np.nanmedian(np.abs(a / b - 1)) < SAME_FREQUENCY)


def _hertz(column: DataColumn, guesses: list[str]) -> Real:
    numbers = np.asarray(column.numbers.real, np.float64)
    factor = column.meaning.factor
    if column.meaning.scale == "logarithm" and np.nanmax(np.abs(numbers), initial=0) <= MOST_DECADES:
        guesses.append(f"'{column.name[:30]}' is read as the decimal logarithm of the frequency")
        numbers = 10.0**numbers
    if factor is None:
        is_angular = unit_by_round_ends(numbers) == "rad/s"
        factor = _FREQUENCY_UNITS["rad/s"] if is_angular else 1.0
        said = "rad/s, in which its ends are round numbers" if is_angular else "Hz"
        guesses.append(f"'{column.name[:30]}' has no unit and is read in {said}")
    if column.meaning.word in _WORDS["omega"] and column.meaning.word and not column.meaning.unit:
        guesses.append(f"'{column.name[:30]}' has no unit and is read in rad/s")
    return numbers * factor


def unit_by_round_ends(lines: Real) -> str | None:
    """Return the unit, Hz or rad/s, in which the ends of a band are round numbers; ``None`` if unclear.

    >>> unit_by_round_ends(2 * np.pi * np.array([1.0, 50])), unit_by_round_ends(np.array([1.0, 50]))
    ('rad/s', 'Hz')
    """
    ends = [x for x in (*lines[: 2 if lines[0] == 0 else 1], lines[-1]) if x > 0 and np.isfinite(x)]

    def is_round(x: float) -> bool:
        return abs(float(f"{x:.2e}") - x) <= ROUND * abs(x)

    in_hz, in_rad = all(map(is_round, ends)), all(is_round(x / (2 * np.pi)) for x in ends)
    return None if in_hz == in_rad or not ends else "Hz" if in_hz else "rad/s"


def _groups(
    rest: Sequence[DataColumn], *, is_asked: bool, guesses: list[str]
) -> list[tuple[str, dict[str, DataColumn]]]:
    labels = dict.fromkeys(c.meaning.label for c in rest if c.meaning.kind)
    alike = {label: [c for c in rest if c.meaning.label == label] for label in labels}
    groups = [(label, group) for label in labels for group in _pairs(alike[label])]
    groups = groups or [("", group) for group in _pairs(rest)]
    coherences = [c for c in rest if c.meaning.kind == "coherence"]
    if len(coherences) in (1, len(groups)):
        for i, (_, group) in enumerate(groups):
            group.setdefault("coherence", coherences[i % len(coherences)])
    powers = [c for c in rest if c.meaning.kind == "power"]
    if not groups and powers:
        own = [c for c in powers if c.meaning.label != "xyz"] or powers[:1]
        with np.errstate(all="ignore"):
            totals = [float(np.nan_to_num(np.nansum(np.abs(c.numbers)))) for c in own]
        best = own[totals.index(max(totals))]
        others = f", the strongest of {len(powers)}" if len(powers) > 1 else ""
        flat = "its square root is the magnitude, the excitation taken as flat"
        guesses.append(f"'{best.name[:30]}'{others}: {flat}")
        groups = [(best.meaning.label, {"power": best})]
    sizes = [c for c in rest if c.meaning.kind == "magnitude"]
    if not groups and len(sizes) == 1 and (is_asked or sizes[0].meaning is _RATIO):
        groups = [("", {"magnitude": sizes[0]})]
    return groups


def _pairs(columns: Sequence[DataColumn]) -> list[dict[str, DataColumn]]:
    by_kind: dict[str, list[DataColumn]] = {}
    for c in columns:
        kind = "complex" if c.numbers.dtype.kind == "c" and c.meaning.kind != "frequency" else c.meaning.kind
        by_kind.setdefault(kind, []).append(c)
    if by_kind.get("complex"):
        return [{"complex": c} for c in by_kind["complex"]]
    phases = _in_one_unit(by_kind.get("phase", []))
    sizes = by_kind.get("magnitude") or (by_kind.get("power", []) if phases else [])
    if len(phases) == 1:  # a magnitude once as it is and once in dB, or besides an amplitude
        own = [c for c in sizes if c.meaning.label and phases[0].meaning.label.startswith(c.meaning.label)]
        sizes = sorted(
            own or sizes,
            key=lambda c: (
                bool(re.search(r"\b(?:min|max)", c.meaning.label, re.I)),
                c.meaning.scale != "decibel",
                c.meaning.word.startswith("amp"),
            ),
        )[:1]
    one, two = by_kind.get("real", []), by_kind.get("imaginary", [])
    if one and len(one) == len(two):
        return [{"real": c, "imaginary": d} for c, d in zip(one, two, strict=True)]
    phases = phases[:1] if len(sizes) == 1 else phases
    if len(sizes) != len(phases):
        return []
    return [{"magnitude": c, "phase": d} for c, d in zip(sizes, phases, strict=True)]


def _shares(column: DataColumn, guesses: list[str]) -> Real:
    """Return coherence between 0 and 1: from per cent, and without what rounding put beyond 1."""
    shares = np.asarray(column.numbers.real, np.float64)
    most = float(np.nanmax(shares, initial=0))
    is_share = most <= 2 or most > 100 * ROUNDED_COHERENCE or np.nanmedian(shares) <= 2  # noqa: PLR2004
    if column.meaning.unit == "%" or not is_share:
        guesses.append(f"'{column.name[:30]}' is read in per cent")
        shares, most = shares / 100, most / 100
    if 1 < most <= ROUNDED_COHERENCE:
        guesses.append(f"'{column.name[:30]}' is a little above 1 in places, and is taken as 1 there")
        shares = np.where(shares > 1, 1.0, shares)
    return shares


def _in_one_unit(phases: list[DataColumn]) -> list[DataColumn]:
    """Return the phases without those that stand there in another unit as well."""
    kept: list[DataColumn] = []
    for c in phases:
        factor = c.meaning.factor
        others = [k for k in kept if factor and k.meaning.factor not in (None, factor)]
        turns = (c.numbers.real * factor - k.numbers.real * k.meaning.factor for k in others)
        if not any(np.nanmedian(np.abs(turn)) < SAME_PHASE for turn in turns):
            kept.append(c)
    return kept


def _values(
    group: dict[str, DataColumn], lines: Real, guesses: list[str], columns: Sequence[DataColumn]
) -> Complex:
    with np.errstate(all="ignore"):  # what overflows is reported as no finite number
        if "complex" in group or "real" in group:
            one = group.get("complex") or group["real"]
            values = np.asarray(one.numbers * (one.meaning.factor or 1), np.complex128)
            if two := group.get("imaginary"):
                if (two.meaning.factor or 1) < 0:
                    guesses.append(f"'{two.name[:30]}' is the imaginary part times -1")
                values = values.real + 1j * two.numbers.real * (two.meaning.factor or 1)
            return values
        if "phase" in group:
            size, phase = _decided(group["magnitude"], group["phase"], lines, guesses, columns)
        else:
            guesses.append("magnitude only: minimum phase is assumed")
            size = _plain_size(group.get("power") or group["magnitude"])
            phase = minimum_phase(lines, size)
        return np.asarray(size * np.exp(1j * phase), np.complex128)


def _without_zeros(group: dict[str, DataColumn], guesses: list[str]) -> dict[str, DataColumn]:
    """Return the columns of a response, the imaginary part left out if it is zero everywhere."""
    # No response has a phase of zero everywhere: an analyser saved a magnitude as a complex number.
    one = group.get("complex") or group.get("real")
    if one is None or not np.any(one.numbers) or np.any(one.numbers.real < 0):
        return group
    if np.any(one.numbers.imag) or ("imaginary" in group and np.any(group["imaginary"].numbers)):
        return group
    guesses.append(f"the imaginary part of {_called(one, 'the values')} is zero: it is a magnitude")
    size = replace(one, numbers=one.numbers.real, meaning=replace(_RATIO, unit=one.meaning.unit))
    return {"magnitude": size} | {k: c for k, c in group.items() if k == "coherence"}


def _size(column: DataColumn, scale: str) -> Real:
    numbers = column.numbers.real / (100 if column.meaning.unit == "%" else 1)
    if scale in ("decibel", "logarithm"):
        return np.asarray(10 ** (numbers / (20 if scale == "decibel" else 1)))
    numbers = np.where(numbers < 0, np.nan, numbers)
    return np.asarray(np.sqrt(numbers) if column.meaning.kind == "power" else numbers)


def _decided(
    magnitude: DataColumn, phase: DataColumn, lines: Real, guesses: list[str], columns: Sequence[DataColumn]
) -> tuple[Real, Real]:
    """Return magnitude and phase [rad], with the scale and unit that names or numbers say."""
    if magnitude.meaning.kind == "power":
        levels = magnitude.numbers * (2 if magnitude.meaning.scale == "decibel" else 1)
        itself = replace(magnitude, numbers=levels, meaning=replace(magnitude.meaning, kind="magnitude"))
        radians = phase.numbers.real * (phase.meaning.factor or np.pi / 180)
        root_fit, own_fit = (_misfit(lines, _plain_size(c), radians) for c in (magnitude, itself))
        magnitude = itself if own_fit < root_fit else magnitude
        which = "the response itself" if own_fit < root_fit else "the square of the magnitude"
        guesses.append(f"{_called(magnitude, 'the power')} is {which}, which fits the phase")
    scales = ["linear", "decibel"] if magnitude.meaning.scale == "unknown" else [magnitude.meaning.scale]
    if len(scales) > 1 and np.any(magnitude.numbers.real <= 0):
        scales = ["decibel"]
    turn = np.asarray(phase.numbers.real, np.float64)
    factors = _possible_units(turn) if phase.meaning.factor is None else [phase.meaning.factor]
    is_gain = magnitude.meaning.word in ("gain", "level")
    costs = {(s, f): _unlikeness(lines, _size(magnitude, s), f * turn) for s, f in product(scales, factors)}
    usual = [costs[scales[0], f] for f in factors]
    # A plain magnitude is the usual reading; both are open for a gain, where it does not fit, and where dB
    # within a decade fit nearly as well.
    sizes = np.abs(magnitude.numbers.real)
    other = min(costs[scales[-1], f] for f in factors) - UNDECIDED / 2
    limit = FITS if np.nanmax(sizes) > DECADE * np.nanmin(sizes) else min(FITS, other)
    readings = scales[:1] if not is_gain and min(usual) < limit and np.ptp(usual) > UNDECIDED else scales
    factor = _best({f: min(costs[s, f] for s in readings) for f in factors}, UNDECIDED)
    if factor is None:
        message = f"column '{phase.name[:40]}' has no unit, and its numbers fit degrees as well as radians"
        raise DataError(Diagnostic("SF602", message, phase.span, ask(columns, pair=(magnitude, phase))))
    scale = _best({s: costs[s, factor] for s in scales}, UNDECIDED * (0.5 if is_gain else 0.7))
    if scale is None and (is_gain or costs["linear", factor] - costs["decibel", factor] > UNDECIDED / 6):
        message = (
            f"column '{magnitude.name[:40]}' has no unit, and its numbers fit dB as well as a plain ratio"
        )
        raise DataError(Diagnostic("SF602", message, magnitude.span, ask(columns, pair=(magnitude, phase))))
    scale = scale or "linear"
    if phase.meaning.factor is None:
        unit = "radians" if factor == 1 else "degrees"
        guesses.append(f"'{phase.name[:30]}' has no unit and is read in {unit}, which fits the magnitude")
    elif phase.meaning.factor < 0:
        guesses.append(f"{_called(phase, 'a column')} is the phase times -1")
    if magnitude.meaning.unit == "%":
        guesses.append(f"'{magnitude.name[:30]}' is read in per cent")
    if magnitude.meaning.scale == "unknown":
        said = "in dB" if scale == "decibel" else "as a ratio, not in dB"
        guesses.append(f"'{magnitude.name[:30]}' has no unit and is read {said}")
    size, turned = _size(magnitude, scale), np.asarray(factor * phase.numbers.real, np.float64)
    if factor > 0 and _are_lags(lines, size, turned):
        if re.search(r"\blags?\b", phase.name, re.I):
            guesses.append(f"{_called(phase, 'a column')} is the phase times -1")
            return size, -turned
        said = f"{_called(phase, 'the phase')} rises where the magnitude falls: if lags are written as "
        guesses.append(f"{said}positive numbers, say -phase_deg or -phase_rad in --columns")
    return size, turned


def _called(column: DataColumn, otherwise: str) -> str:
    return f"'{column.name[:30]}'" if column.name else otherwise


def _are_lags(lines: Real, size: Real, phase: Real) -> bool:
    """Return whether phases are those of a minimum-phase function with this magnitude, times -1."""
    expected = minimum_phase(lines, size)
    used = (expected != 0) & np.isfinite(phase)
    if not np.any(used):
        return False
    as_written, mirrored = (np.mean(1 - np.cos(sign * phase[used] - expected[used])) for sign in (1, -1))
    return bool(mirrored < min(UNLIKE, as_written / CLEARLY))


def _possible_units(turn: Real) -> list[float]:
    """Return the units [rad] that phases may be in; wrapped ones that fill a turn say it themselves."""
    finite = turn[np.isfinite(turn)]
    span, jump = np.ptp(finite) if finite.size else 0.0, np.max(np.abs(np.diff(finite)), initial=0.0)
    units = [np.pi / 180, 1.0]
    said = [u for u in units if FILLED * WRAPPED < span * u <= WRAPPED and jump * u > np.pi]
    return said[:1] or units


def _best(costs: dict[Choice, float], margin: float) -> Choice | None:
    """Return what is least unlike; ``None`` if another one is close by a margin, or all are unlike."""
    (best, choice), *others = sorted((cost, choice) for choice, cost in costs.items())
    is_clear = not others or (best < FITS and others[0][0] - best > margin)
    return choice if is_clear else None


def _unlikeness(lines: Real, size: Real, phase: Real) -> float:
    """Return the logarithm of the ratio of the energies that the slopes of ln(size) and phase have."""
    kept = (lines > 0) & (size > 0) & np.isfinite(size) & np.isfinite(phase) & np.isfinite(lines)
    if kept.sum() < FEWEST_TO_DECIDE:
        return 0.0
    x, neper, turn = lines[kept], np.log(size[kept]), phase[kept]
    if np.ptp(turn) <= WRAPPED:
        turn = np.unwrap(turn)
    energies = [
        float(np.linalg.norm(np.diff(y - slope * (t - t.mean()))))
        for t, y in ((np.log(x), neper), (x, turn))
        for slope in [np.cov(t, y)[0, 1] / max(float(np.var(t, ddof=1)), 1e-300)]
    ]
    return abs(float(np.log((energies[1] + 1e-12) / (energies[0] + 1e-12))))


def _misfit(lines: Real, size: Real, phase: Real) -> float:
    """Return how unlike a causal function, and one of minimum phase and either sign, a response is."""
    alike = np.nan_to_num(np.abs(np.cos(phase - minimum_phase(lines, size))))
    return _unlikeness(lines, size, phase) + float(np.mean(1 - alike))


def minimum_phase(lines: Real, size: Real) -> Real:
    """Return the phase [rad] that the magnitude of a function without zeros on the right has."""
    # 2 w/pi times the integral of (ln|H(v)| - ln|H(w)|)/(v^2 - w^2) over v (Bode 1945, chapter 14); beyond
    # its ends the magnitude goes on with the power of frequency that it has there, rounded. Lines may go
    # down.
    kept = np.flatnonzero((lines > 0) & (size > 0) & np.isfinite(size) & np.isfinite(lines))
    kept = kept[np.argsort(lines[kept])]
    x, y = np.log(lines[kept]), np.log(size[kept])
    phase = np.zeros(lines.size)
    if x.size < FEWEST_TO_DECIDE or np.any(np.diff(x) <= 0):
        return phase
    end = max(x.size // 20, 3)
    low, high = (round(float(np.polyfit(x[s], y[s], 1)[0])) for s in (slice(end), slice(-end, None)))
    step = max((x[-1] - x[0] + 2 * BEYOND) / 2**19, float(np.quantile(np.diff(x), 0.05)))
    grid = np.arange(x[0] - BEYOND, x[-1] + BEYOND, step)
    slope = np.diff(np.interp(grid, x, y)) + step * np.where(grid[1:] < x[0], low, high * (grid[1:] > x[-1]))
    # By parts the kernel is ln(coth(|u|/2)), u = ln(v/w); over the step at u = 0 its mean is 1 + ln(4/step).
    u = step * np.abs(np.arange(-slope.size, slope.size))
    kernel = -np.log(np.tanh(np.where(u == 0, 1.0, u) / 2))
    kernel[slope.size] = 1 + np.log(4 / step)
    size_2 = 2 ** int(np.ceil(np.log2(3 * slope.size)))
    folded = np.fft.irfft(np.fft.rfft(slope, size_2) * np.fft.rfft(kernel, size_2), size_2)
    turn = folded[slope.size : 2 * slope.size] / np.pi
    phase[kept] = np.interp(x, grid[1:] - step / 2, turn)
    return phase


def ratio_unit(text: str, file: str) -> str:
    """Return a unit that a header gives, where it is one of a ratio; g may be the gram and is not taken."""
    small = "Ohm" if text.lower() in _OHMS else text
    if "/" not in small.replace("Ohm", "/") or re.search(r"\bg\b", small):
        return ""
    try:
        return unit_of(small, file)
    except DataError:
        return ""


def _wrong(column: DataColumn, lines: Real) -> list[Diagnostic]:
    """Return what is to be said of cells without a number; a line at 0 Hz is not looked at."""
    problems = []
    for row in [row for row in column.wrong if lines[row] != 0][:MAX_ERRORS]:
        span = column.place(row)
        is_line = span is None or span.start == span.source.text.rfind("\n", 0, span.start) + 1
        text = span.text if span and not (is_line and len(span.text.split()) > 1) else ""
        shown = f"'{text[:40]}' is not a number" if text else "a number is missing"
        problems.append(Diagnostic("SF603", shown, span, "leave the line out, or the column with --columns"))
    return problems


def _missing(columns: Sequence[DataColumn], file: str, header: Span | None) -> Diagnostic:
    """Return why columns make no response, and which option says what they are."""
    kinds = {c.meaning.kind for c in columns}
    place = "" if header else f"'{file}': "
    unknown = next((c for c in columns if not c.meaning.kind and c.name), None)
    pairs = [("real", "imaginary"), ("magnitude", "phase")]
    missing = next((b if a in kinds else a for a, b in pairs if (a in kinds) != (b in kinds)), None)
    message = f"{place}a column of {missing} is missing" if missing else f"{place}no columns have the values"
    if not (unknown and missing and header):
        return Diagnostic("SF602", message, header, ask(columns))
    hint = " ".join(filter(None, (nearest(unknown.name.lower(), KINDS), ask(columns))))
    return Diagnostic("SF602", f"{message}: unknown column '{unknown.name[:40]}'", unknown.span, hint)


SINCE_1970: Final = 1e11  # numbers above which an unnamed axis is a time in milliseconds, no frequency
MOST_COMPARED: Final = 1000  # lines by which readings are compared
_READINGS: Final = (("re", "im"), *product(("mag_db", "mag"), ("phase_deg", "phase_rad")))
"""Words of ``--columns`` that make a response in pairs."""


@np.errstate(all="ignore")  # numbers that are not finite are reported elsewhere
def ask(columns: Sequence[DataColumn], unit: str = "f", pair: tuple[DataColumn, ...] = ()) -> str:
    """Return the hint with the option that says what columns are, or a pair, the likeliest reading first."""
    is_indexed = len(columns) > 2 and counts(columns[0].numbers)  # noqa: PLR2004
    is_indexed = is_indexed and bool(np.all(np.diff(columns[1].numbers.real) > 0))
    axis = next((i for i, c in enumerate(columns) if c.meaning.kind == "frequency"), int(is_indexed))
    if re.search(r"\b(?:time|zeit|temps|tiempo|date|datum)\b|^t(?:\b|_)", columns[axis].name, re.I):
        timed = option_in_time([c.numbers for c in columns[axis:]], axis)
        return f"'{columns[axis].name[:30]}' is not a frequency: {timed or HINT}"
    if columns[axis].meaning.kind not in ("", "frequency"):
        return WITHOUT_AXIS
    if _NO_WORD.search(columns[axis].name):
        return f"'{columns[axis].name[:30]}' is not a frequency: write frequencies in Hz or rad/s instead"
    steps = np.sign(np.diff(columns[axis].numbers.real))
    most = max(np.sum(steps > 0), np.sum(steps < 0))
    is_counter = not steps.all() and np.mean(np.diff(columns[axis].numbers) == 1) > MOST_ALIKE
    if not columns[axis].meaning.kind and (is_counter or most < MOST_ALIKE * steps.size):
        return WITHOUT_TIME.format(signals([c.numbers for c in columns], ",dt=SECONDS"))
    is_open = not columns[axis].meaning.kind and steps.size >= FEWEST_TO_DECIDE
    timed = option_in_time([c.numbers for c in columns[axis:]], axis) if is_open else ""
    times = columns[axis].numbers.real  # they begin at zero or one step later, as few frequencies do
    begins = is_open and times[0] <= (1 + HELD) * np.median(np.diff(times)) and not counts(times)
    is_held = begins or times[0] > SINCE_1970
    is_held |= any(np.sum(np.diff(c.numbers) == 0) > HELD * c.numbers.size for c in columns[axis + 1 :])
    open_ones: list[int] = []
    for i, c in enumerate(columns):
        if (
            c.meaning.kind in ("coherence", "frequency")
            or _NO_WORD.search(c.name)
            or (pair and c not in pair)
            or (i < axis and counts(c.numbers))
        ):
            continue
        is_again = any(_is_same(c.numbers.real, columns[k].numbers.real) for k in open_ones)
        if not is_again and not np.array_equal(c.numbers, columns[axis].numbers):
            open_ones.append(i)
    open_ones = open_ones[is_indexed and axis == 0 :] if open_ones[2:] else open_ones

    def option(*words: tuple[str, int]) -> str:
        """Return the option that says which word each column has, besides the frequency's."""
        at = {i: word for word, i in words} | {axis: unit}
        return "--columns " + ",".join(at.get(i, "-") for i in range(max(at) + 1))

    readings = _likely(columns, axis, open_ones, UNDECIDED if pair else UNDECIDED / 3)
    if readings:
        these = ", or ".join(option(*zip(words, pair, strict=True)) for words, pair in readings)
        both = [timed, f"{these} if column {axis + 1} is a frequency"] if timed else [these]
        return f"say what the columns are: {', or '.join(both if is_held else both[::-1])}"
    sizes = [i for i in open_ones if columns[i].meaning.kind in ("magnitude", "power", "")]
    if not sizes:
        return "a phase alone is not a response: save the magnitude too" if open_ones else HINT
    i = next((i for i in sizes if columns[i].meaning.kind), sizes[0])
    options = [option((word, i)) for word in ("mag", "mag_db", "psd") if _may_be(columns[i], word)]
    alone = f"{' or '.join(options)} reads the magnitude alone, and minimum phase is assumed"
    return f"say what the columns are: {timed}, or {alone}" if timed else alone


def signals(columns: Sequence[npt.NDArray[Any]], end: str = "") -> str:
    """Return the words of ``--columns`` for an input and an output, and ``end``, from columns that change."""
    # Columns that count are no signals. If more than two columns change, the text says which these are.
    do_count = [np.sum(np.diff(x) == 1) > MOST_ALIKE * x.size for x in columns]
    changing = [i for i, x in enumerate(columns) if np.ptp(x.real) > 0 and not do_count[i]]
    places = dict(zip(changing, "uy" if len(changing) > 1 else "y", strict=False))
    words = ",".join(places.get(i, "-") for i in range(max(places, default=-1) + 1)) or "y"
    more = " (u and y are the first two columns that change: move them, with - for what is left out)"
    return words + end + more * (len(changing) > 2)  # noqa: PLR2004 (an input and an output)


@np.errstate(all="ignore")
def option_in_time(columns: Sequence[npt.NDArray[Any]], before: int = 0) -> str:
    """Return the option that reads columns as a record in time, nothing where the first is no time."""
    times = columns[0].real
    if counts(times):
        return f"--columns {'-,' * (before + 1)}{signals(columns[1:], ',dt=SECONDS of a record in time')}"
    steps, usual = np.diff(times), np.median(np.diff(times))
    if times[0] and not np.median(np.abs(steps - usual)) <= EVENLY * usual:
        return ""
    return f"--columns {'-,' * before}t,{signals(columns[1:], ' of a record in time')}"


def _is_same(values: Real, other: Real) -> bool:
    """Return whether a column has the numbers of another, perhaps as a ratio where that is in dB."""
    ways = (other, 10 ** (other / 20), 20 * np.log10(other))
    return any(np.mean(np.abs(values / way - 1) <= SAME_SIZE) > MOST_ALIKE for way in ways)


def _may_be(column: DataColumn, word: str) -> bool:
    """Return whether neither the name of a column nor its numbers contradict a word of ``--columns``."""
    meaning, asked, numbers = column.meaning, meaning_of(word), column.numbers.real
    if meaning.kind and (meaning.kind != asked.kind or {meaning.factor, asked.factor} == {1.0, np.pi / 180}):
        return False
    are_sizes = bool(np.all(numbers > 0))
    if word == "mag":
        return are_sizes and meaning.scale != "decibel"
    if word == "mag_db" and meaning.scale != "decibel":
        is_open = meaning.scale == "unknown" or not meaning.kind
        return is_open and not (are_sizes and np.ptp(numbers) < LEAST_LEVELS)
    return word != "psd" or bool(meaning.kind)


def _likely(
    columns: Sequence[DataColumn], axis: int, open_ones: Sequence[int], margin: float
) -> list[tuple[tuple[str, str], tuple[int, int]]]:
    """Return the readings of two columns as one response, words and places, the likeliest first."""
    columns = [replace(c, numbers=c.numbers[:: c.numbers.size // MOST_COMPARED + 1]) for c in columns]
    lines, costs = np.asarray(columns[axis].numbers.real, np.float64), {}
    are_known = any(columns[i].meaning.kind for i in open_ones)
    for pair, words in product(permutations(open_ones[:MOST_LISTED], 2), _READINGS):
        one, two = (columns[i] for i in pair)
        kinds = {one.meaning.kind, two.meaning.kind}
        is_other = kinds in ({""}, {"", "magnitude"}) if are_known else pair[0] > pair[1]
        if is_other or not (_may_be(one, words[0]) and _may_be(two, words[1])):
            continue
        if words[0] == "re":
            values = one.numbers.real + 1j * two.numbers.real
            size, turn = np.abs(values), np.unwrap(np.angle(values))
        else:
            size = _size(one, "decibel" if words[0] == "mag_db" else "linear")
            turn = two.numbers.real * (np.pi / 180 if words[1] == "phase_deg" else 1.0)
        costs[words, pair] = _misfit(lines, size, turn)
    best = min(costs.values(), default=0.0)
    near = [reading for reading in costs if costs[reading] <= best + margin]
    return sorted(near, key=costs.__getitem__)[:3]
