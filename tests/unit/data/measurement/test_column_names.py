"""The tables of what names of columns mean, row by row."""

from __future__ import annotations

import re

import numpy as np
import pytest

from symflex.data.measurement import column_meaning
from symflex.data.measurement.column_names import FREQUENCY_UNITS, KINDS, PHASE_UNITS, NameRow

TABLES = {
    name: rows
    for name, rows in vars(column_meaning).items()
    if isinstance(rows, tuple) and rows and isinstance(rows[0], NameRow)
}


def said(meaning):
    """Return a meaning in words, as ``NameRow.read`` has it."""
    factor = "" if meaning.factor == 1 else "?" if meaning.factor is None else f"{meaning.factor:.4g}"
    scale = "" if meaning.scale == "linear" else meaning.scale
    parts = {" of ": meaning.label, " in ": meaning.unit, " times ": factor, ", ": scale}
    return (meaning.kind or "nothing") + "".join(lead + part for lead, part in parts.items() if part)


def read(example):
    """Return what an example means: names with commas between them, or one and the unit below."""
    names, _, unit = example.partition(" below ")
    meanings = column_meaning.meanings_of(names.split(","), [unit] * (names.count(",") + 1))
    return ";".join(map(said, meanings))


def test_every_row_reads_its_example():
    assert len(TABLES) == 8
    for name, rows in TABLES.items():
        for row in rows:
            assert read(row.example) == row.read, (name, row)
            assert row.files, (name, row)


def test_no_row_is_idle(monkeypatch):
    monkeypatch.setattr(column_meaning, "meaning_of", column_meaning.meaning_of.__wrapped__)
    for name, rows in TABLES.items():
        for i, row in enumerate(rows):
            with monkeypatch.context() as patched:
                patched.setattr(column_meaning, name, rows[:i] + rows[i + 1 :])
                assert read(row.example) != row.read, (name, row)


def test_every_word_and_unit_is_read(monkeypatch):
    for word, kind in KINDS.items():
        expected = "frequency" if kind == "omega" else kind
        assert column_meaning.meaning_of(word).kind == expected, word
        with monkeypatch.context() as patched:
            patched.setattr(column_meaning, "KINDS", {w: k for w, k in KINDS.items() if w != word})
            assert column_meaning.meaning_of.__wrapped__(word).kind != expected, word
    for title, units in (("frequency", FREQUENCY_UNITS), ("phase", PHASE_UNITS)):
        for unit, factor in units.items():
            assert column_meaning.meaning_of(f"{title} [{unit}]").factor == factor, (title, unit)


def test_every_word_of_a_row_is_read_alike():
    for table, what in (("MEANINGS", "kind"), ("UNITS_IN_WORDS", "unit"), ("SCALES", "scale")):
        for row in TABLES[table]:
            words = row.words.split()
            used = [word for word in words if re.search(rf"\b{word}\b", row.example, re.I)]
            for word in words if used else ():
                name = re.sub(rf"\b{used[0]}\b", word, row.example, flags=re.I)
                assert getattr(column_meaning.meaning_of(name), what) == row.means, (name, row)


NAMES = {
    "CH1 in-phase (V)": "real of CH1 in V",
    "Vin_phase (rad)": "phase of Vin in rad",
    "Frequency response (dB)": "magnitude of response in dB, decibel",
    "Frequency hertz": "frequency in hertz",
    "ln f (Hz)": "nothing of ln f in Hz",
    "[Ohm]": "magnitude in Ohm",
    "Level dBV": "magnitude, decibel",
    "Mag dBm below V": "magnitude of dBm in V",
    "-Phase (rad)": "phase in rad times -1",
    "Trace 1: Gain: Magnitude (dB)": "magnitude of Trace 1 in dB, decibel",
    "X/F": "nothing of X/F",
    "Phase below Hz": "phase in Hz times ?",
    "Frequency real": "real",
    "Magnitude response (V)": "magnitude of response in V",
    "Transfer function (Hz)": "nothing of Transfer function in Hz",
    "Response omega": "nothing of Response",
    "Z'' (Ohm)": "imaginary in Ohm",
    "S21 (Ohm)": "nothing of S21 in Ohm",
    "x (rad)": "nothing of x in rad",
    "[V]": "nothing in V",
    "Real (deg)": "real in deg",
    "Real (Np)": "real in Np",
    "Output (deg)": "phase of Output in deg times 0.01745",
    "signal in (V)": "magnitude of signal in in V",
    "Output (V)": "magnitude of Output in V",
    "|H1|^2 (dB)": "magnitude of H1^2 in dB, decibel",
    "|H1|²": "nothing of H1²",
    "ln Amplitude": "nothing of ln",
    "PSD": "power, unknown",
    "log(Pxx)": "power, logarithm",
    "lg S": "nothing of S",
    "lg f": "frequency times ?, logarithm",
    "Coherence log": "coherence of log",
    "20log10(Coherence)": "coherence",
    "-Mag (dB)": "magnitude in dB, decibel",
    "neg Real": "real times -1",
    "minus Real": "real times -1",
    "P(V(out))": "phase of (V(out)) times ?",
    "Level dB below V": "magnitude in V, decibel",
    "abs (dB)": "magnitude in dB, decibel",
    "abs (V)": "magnitude in V",
    "logomega": "frequency times 0.1592, logarithm",
    "logfreq": "frequency times ?, logarithm",
    "logw": "frequency times 0.1592, logarithm",
    "omega log (rad/s)": "frequency of log in rad/s times 0.1592, logarithm",
    "PSD log": "power of log, logarithm",
    "abs PSD": "power in lin",
    "Lin Coherence": "coherence of Lin",
    "deg Real": "real of deg",
    "deg phase (rad)": "phase of deg in rad",
    "omega w/w0": "nothing of w/w0",
    "Mag f/f0": "magnitude of f/f0, unknown",
    "ln w": "nothing of ln w",
    "Phase ln f": "phase of ln f times ?",
    "[rads]": "frequency in rads times 0.1592",
    "|Y| (S)": "magnitude of Y in S",
    "Mag^2 (V)": "nothing of ^2 in V",
    "|H1| [nepers]": "nothing of H1 in nepers",
    "u_in (V)": "magnitude of u_in in V",
    "I(in) (A)": "magnitude of I(in) in A",
    "Voltage out (V)": "magnitude of Voltage out in V",
    "CH1 out (V)": "magnitude of CH1 out in V",
    "magdB": "magnitude in dB, decibel",
    "Himag": "imaginary of H",
    "Yim": "imaginary of Y",
    "f (mHz)": "frequency in mHz times 0.001",
    "f (MHz)": "frequency in MHz times 1e+06",
    "omega (1/s)": f"frequency in 1/s times {1 / (2 * np.pi):.4g}",
}


@pytest.mark.parametrize("name", NAMES)
def test_rows_work_together(name):
    assert read(name) == NAMES[name]
