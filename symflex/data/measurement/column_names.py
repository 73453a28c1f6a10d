"""What names of columns have in them: tables of words, units and patterns, which ``column_meaning`` reads.

A row of a table has an example, a name that this row alone reads so, and the files that have such names.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

import numpy as np

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
PARTS: Final = r"gamma\^?2|[^\W\d_]+'*|\|\w\|"
OHMS: Final = ("ohm", "ohms", "\u03c9")
FREQUENCY_UNITS: Final = {
    **dict.fromkeys(("hz", "hertz", "гц"), 1.0), "khz": 1e3, "mhz": 1e6, "ghz": 1e9, "mHz": 1e-3,
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
_TIMES: Final = {
    Fraction(1): "s sec secs second seconds sekunde sekunden",
    Fraction(1, 10**3): "ms msec millis millisecond milliseconds",
    Fraction(1, 10**6): "us usec \u00b5s \u03bcs micros microsecond microseconds",
    Fraction(1, 10**9): "ns nanosecond nanoseconds",
    Fraction(60): "min mins minute minutes minuten",
    Fraction(3600): "h hr hrs hour hours stunde stunden",
}
SECONDS: Final = {word: factor for factor, words in _TIMES.items() for word in words.split()}
"""Words for units of time, and what they are in seconds."""
FACTORS: Final = {
    "frequency": FREQUENCY_UNITS
    | {"rad": FREQUENCY_UNITS["rad/s"]}
    | dict.fromkeys(("rpm", "1/min", "u/min", "min^-1"), 1 / 60),
    "omega": FREQUENCY_UNITS | dict.fromkeys(("rad", "1/s", "s^-1", ""), FREQUENCY_UNITS["rad/s"]),
    "phase": PHASE_UNITS | dict.fromkeys(("cycle", "cycles", "turns"), 2 * np.pi),
}
"""Units of each kind, and what they are in Hz or radians."""
IN_OR_OUT = re.compile(r"(?:v|u|i|signal|voltage|ch\w?)?[ _.(]*(in|out)(?:put)?\)?", re.I)
"""Labels of what goes in and what comes out: Vin, V(out), u_in, Output."""
AT_ENDS = re.compile(r"(?:[vu]|ch|channel|kanal)[ _]?(?:([1ei])|([2ao]))", re.I)
"""Amplitudes at both ends of a two-port: V1 and V2, Ue and Ua, Vi and Vo, CH1 and CH2."""
REFERENCE = re.compile(r"\bdb\s+(?:re|ref|rel)\b[.:]?\s*(?:1(?:\.0*)?(?!\d)\s*)?([^)\]]*)", re.I)
"""Decibels over a unit: dB re 1 m/N."""
OTHER_SIZE = re.compile(r"squared|(?:\||mag\w*)\s*(?:\^2|²)|^ln\b|[([]\s*(?:np|nepers?)\s*[])]", re.I)
"""Names of squares and natural logarithms of magnitudes, which are no magnitudes."""


@dataclass(frozen=True, slots=True)
class NameRow:
    """A row of what names mean: where all its conditions hold, a name means ``means``."""

    means: str
    pattern: str  # found in a name, in any case
    example: str  # a name, perhaps with a unit in the row below; in LETTERS the names of columns
    read: str  # what the example is
    files: str  # that have such names
    of: str = ".*"  # the kind so far
    words: str = ""  # one of these is in the name
    unit: str = ".*"  # the unit so far, in lower case
    mark: str = ""  # a word that the name then has, and that no name is written with

    def holds(self, text: str, words: Collection[str], unit: str, kind: str = "") -> bool:
        """Return whether the conditions hold for a name, its words, its unit and its kind."""
        return (
            (not self.words or not set(self.words.split()).isdisjoint(words))
            and bool(re.fullmatch(self.of, kind) and re.fullmatch(self.unit, unit))
            and bool(re.search(self.pattern, text, re.I))
        )


def _one_of(words: Iterable[str]) -> str:
    return f"(?:{'|'.join(re.escape(word) for word in sorted(words, key=len, reverse=True))})"


_UNIT, _DB, _RAD = _one_of(UNITS), _one_of(_LEVELS), _one_of(PHASE_UNITS)
_SUFFIX: Final = _one_of(UNITS - {"*", "\ufffd", "\u03c9"})  # a lone omega is a frequency
_LOG: Final = r"0\s*\*?\s*log(?:_?10)?\s*(?:db\b)?"
_EDGE: Final = r"[\s:;,.\-_'|()\[\]]*"
SPELLINGS: Final = (
    NameRow(r"\g<0>", OTHER_SIZE.pattern, "|H1|^2 (V)", "nothing of H1^2 in V", "scripts", mark="other.size"),
    NameRow("dB", REFERENCE.pattern, "H1 (dB re 1 V)", "magnitude of H1 in V, decibel", "acoustics"),
    NameRow("phase ", "\u2220", "\u2220H1 (rad)", "phase of H1 in rad", "reports"),
    NameRow("°", "Â°", "Phase (Â°)", "phase in ° times 0.01745", "UTF-8 that was read as Latin-1"),
    NameRow("inphase", r"(?<![^\W\d_])in[-_]phase(?![^\W\d_])", "In-Phase (V)", "real in V", "lock-ins"),
    NameRow("| ", r"\|(?=[\[(])", "|H1|[V]", "magnitude of H1 in V", "tables of a bench"),
    NameRow(r"mag \1", r"\|([^|hz]|[^|]{2,})\|", "|H1| (V)", "magnitude of H1 in V", "scripts"),
    NameRow("db", r"\b[vi]db(?=\()", "VDB(out)", "magnitude of out in dB, decibel", "SPICE"),
    NameRow("phase", r"\b(?:[vi]p(?=\()|p(?=\([vi]\())", "VP(out) [rad]", "phase of out in rad", "SPICE"),
    NameRow("mag", r"\bvm(?=\()", "VM(out)", "magnitude of out, unknown", "SPICE"),
    NameRow("re", r"\bvr(?=\()|^r(?= \S+\.[vi]$)", "r out.v", "real of out.v", "SPICE, Qucs"),
    NameRow("im", r"\bvi(?=\()|^i(?= \S+\.[vi]$)", "i out.v", "imaginary of out.v", "SPICE, Qucs"),
    NameRow("power dB", rf"\b1{_LOG}", "10log10(Gxx)", "power of Gxx in dB, decibel", "scripts"),
    NameRow("dB", rf"\b2{_LOG}", "20log10(H1)", "magnitude of H1 in dB, decibel", "scripts"),
    NameRow(r"\1 \2 [\3]", r"^(l\w+)\s*\(\s*([^()/]+)/([^()/]+)\)", "log(|Z|/Ohm)",
            "magnitude in Ohm, logarithm", "potentiostats"),
    NameRow("", r"^l(?:og|g)(?:_?10)?(?![\s_]*mag)[\s_]*(?=[\W_f]|omega|[wz]\b)", "log f",
            "frequency times ?, logarithm", "potentiostats", mark="log.10"),
    NameRow("", r"^(?:-|neg(?:ative)?\b\.?|minus\b)\s*(?=\D)", "-Im(Z)", "imaginary of Z times -1",
            "potentiostats", mark="times.-1"),
)  # fmt: skip
"""How names are put in the usual words, one row after the other."""
BRACKETS: Final = (
    NameRow("unit", rf"\[(?:{_UNIT}|cycles?|turns|(?-i:F))\]$", "S1(deg)", "phase of S1 in deg times 0.01745",
            "networks"),
    NameRow("unit", r"\[[^_]+/[^_]*\]$", "Real [V/W]", "real in V/W", "analysers"),
    NameRow("name", r"\w\[.*_.*\]$", "Re(A_1/u)", "real of A_1/u", "scripts"),
    NameRow("name", r"\w\[/?[\w .]*(?:\([\w .,]*\))?[\w .]*\]$", "Re(S21)", "real of S21", "networks"),
    NameRow("name", "", "Re <H1> below dB", "real of <H1> in dB", "analysers that average", unit=_UNIT),
    NameRow("name", "", "H1 [Real]", "real of H1", "analysers", words=" ".join(KINDS)),
    NameRow("unit", "", "Re [V]", "real in V", "analysers"),
)  # fmt: skip
"""Whether a bracket, seen as ``e[m/N]`` with the letter before it, is a unit: the first row that holds."""
UNIT_ENDS: Final = (
    NameRow("", rf"^\s*({_RAD}|ohms?)\s*$", "rad", "phase in rad", "tables of units"),
    NameRow("", rf"(?:[\s_/,:.]|\bin |(?<=\w\d)(?=d))\s*({_SUFFIX})\s*$", "phase_rad", "phase in rad",
            "scripts"),
    NameRow("", r"(?<=\S)\s+/\s+(\S+)\s*$", "Re / mV", "real in mV", "potentiostats"),
    NameRow("", r"(?:(?<=^[uv][12eaio])|(?<=^[uv]_[12eaio]))/(m?V)$", "V_1/V", "magnitude of V_1 in V",
            "tables of a bench"),
    NameRow("", r"^(deg)(?=[:(])", "deg:H1", "phase of H1 in deg times 0.01745", "networks"),
)  # fmt: skip
"""Where a unit without brackets is: the first row that is found."""
_LINES, _SIZES = "frequency|omega", "magnitude|power"
_HZ: Final = _one_of(FREQUENCY_UNITS)
MEANINGS: Final = (
    NameRow("frequency", "", "x (kHz)", "frequency of x in kHz times 1000", "scripts", of="", unit=_HZ),
    NameRow("frequency", "", "Frequency - Phase (Hz)", "frequency in Hz", "exported plots",
            words="frequency freq", unit=_HZ),
    NameRow("", "", "Frequency response", "nothing of response", "reports", of=_LINES,
            words="response function"),
    NameRow("magnitude", "", "H1 [dB]", "magnitude of H1 in dB, decibel", "analysers", of="", unit=_DB),
    NameRow("magnitude", r"^\W*(?:z|$)", "Zin [Ohm]", "magnitude of Zin in Ohm", "impedances", of="",
            unit=_one_of(OHMS)),
    NameRow("phase", "", "H1 [deg]", "phase of H1 in deg times 0.01745", "analysers", of="",
            unit=_one_of(_DEGREES[:-2])),
    NameRow("phase", r"^\W*$", "[rad]", "phase in rad", "tables of units", of="", unit=rf"(?!\*){_RAD}"),
    NameRow("", r"\b[fwω]\s*/\s*[fwω]", "f/f0", "nothing of f/f0", "books", of=_LINES),
    NameRow("", "", "ln f", "nothing of ln f", "books", of=_LINES, words="ln"),
    NameRow("", "", "|H1| [Np]", "nothing of H1 in Np", "books", of="magnitude", words="other.size",
            unit=rf"(?!{_DB}$).*"),
    NameRow("", "", "phase margin (rad)", "nothing of margin in rad", "reports",
            words="std stdev sd sigma err unc uncertainty var variance snr thd margin"),
    NameRow("magnitude", rf"^{_EDGE}(?:{IN_OR_OUT.pattern}){_EDGE}$", "Vin (V)", "magnitude of Vin in V",
            "oscilloscopes", of=""),
    NameRow("magnitude", rf"^{_EDGE}[vu]_?[12eaio]{_EDGE}$", "V1 (V)", "magnitude of V1 in V",
            "tables of a bench", of=""),
)  # fmt: skip
"""What a name of a kind is by its words and its unit, one row after the other."""
UNITS_IN_WORDS: Final = (
    NameRow("deg", "", "deg of phase", "phase of deg of in deg times 0.01745", "scripts", of="phase",
            words=" ".join(filter(str.isalpha, _DEGREES)), unit=rf"(?!{_RAD}$).*"),
    NameRow("dB", "", "db(H1)", "magnitude of H1 in dB, decibel", "analysers", of=_SIZES, words="db",
            unit=""),
    NameRow("lin", "", "Lin Mag", "magnitude of Lin in lin", "analysers", of=_SIZES, words="abs lin linear",
            unit=""),
)  # fmt: skip
"""The unit of a name without one, one row after the other."""
SCALES: Final = (
    NameRow("unknown", "", "mag(H1)", "magnitude of H1, unknown", "analysers", of=_SIZES, unit="-?"),
    NameRow("logarithm", "", "log Z", "magnitude, logarithm", "books", of=f"{_SIZES}|{_LINES}",
            words="log.10"),
    NameRow("logarithm", "", "Frequency Log(Hz)", "frequency of Log in Hz, logarithm", "potentiostats",
            of=f"power|{_LINES}", words="log"),
    NameRow("decibel", "", "Gain [dBm]", "magnitude in dBm, decibel", "networks", of=_SIZES,
            unit=f"{_DB}.*"),
    NameRow("decibel", "", "SPL", "magnitude, decibel", "acoustics", of="magnitude",
            words="db dbspl dbv dbr logmag spl"),
)  # fmt: skip
"""The scale of a column, linear where no row holds; the last row that holds."""
LETTERS: Final = (
    NameRow("magnitude", "r", "Freq,R,theta", "frequency times ?;magnitude, unknown;phase times ?",
            "lock-ins", of="phase"),
    NameRow("real imaginary", "x y", "Hz,X,Y", "frequency;real;imaginary", "lock-ins"),
    NameRow("real imaginary", "i q", "Hz,I,Q", "frequency;real;imaginary", "receivers"),
    NameRow("real imaginary", "r x", "Hz,R,X", "frequency;real;imaginary", "impedances"),
    NameRow("real imaginary", "rs xs", "Hz,Rs,Xs", "frequency;real;imaginary", "impedances"),
    NameRow("real imaginary", "g b", "Hz,G,B", "frequency;real;imaginary", "admittances"),
)  # fmt: skip
"""Letters that mean something beside a column of a kind, or as the only such pair."""
JOINTS: Final = (
    NameRow(" ", r"(?<=[a-z]{3})(?=[A-Z][a-z]|dB\b)", "FrequencyHz", "frequency in Hz", "scripts"),
    NameRow(" ", r"(?<=^[GHYZ])(?=(?:re|im)(?:al|ag)?\b)", "Hreal", "real of H", "scripts"),
    NameRow(" ", r"(?<=^Re|^Im)(?=[A-Z]\d*$)", "ImH", "imaginary of H", "scripts"),
)
"""Where words are joined, in names that mean nothing as they are; capitals count."""
