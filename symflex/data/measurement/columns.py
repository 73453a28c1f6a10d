"""The responses that columns make.

Input: columns with their meanings. Output: responses, and what was guessed; what stays open is asked for.

    f [kHz]; gain [dB]; phase [deg]   ->  frequencies in Hz, complex values

A unit that is not said is found from the numbers, as magnitude and phase of a causal function determine each
other (:mod:`symflex.data.measurement.minimum_phase`).
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product
from typing import Final, TypeVar

import numpy as np
import numpy.typing as npt

from symflex.data.measurement.column_meaning import ColumnMeaning, DataColumn, counts, size_of
from symflex.data.measurement.column_names import (
    AT_ENDS,
    FREQUENCY_UNITS,
    IN_OR_OUT,
    KINDS,
    OHMS,
    PHASE_UNITS,
    UNITS,
)
from symflex.data.measurement.likely_readings import MOST_LISTED, UNDECIDED, ask
from symflex.data.measurement.measured_response import (
    MAX_ERRORS,
    MAX_RESPONSES,
    are_few,
    in_si,
    ratio_of_units,
    unit_of,
)
from symflex.data.measurement.minimum_phase import (
    FEWEST_TO_DECIDE,
    WRAPPED,
    minimum_phase,
    misfit,
    unlikeness,
)
from symflex.errors import DataError, Diagnostic, Span, nearest

Choice = TypeVar("Choice", str, float)
Real = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]

_SIGNALS: Final = dict.fromkeys(("e", "v", "u", "voltage"), "out") | dict.fromkeys(("i", "current"), "in")
"""Labels of a voltage and a current, whose ratio is an impedance."""
_ANY_OHM: Final = "|".join(sorted(OHMS, key=len, reverse=True))
RIPPLE: Final = 0.1  # share of the largest loss that a gain may rise above 0 dB in a passband
_ATTENUATION = re.compile(r"attenuation|d[aä]mpfung|\bloss\b", re.I)
_FORCE = re.compile(r"force|hammer|excitation|kraft", re.I)
CROSS = re.compile(r"[sgp]_?(?:xy|yx)|.*\b(?:csd|cross)\b.*", re.I)
FITS: Final = 1.0  # beyond it numbers are like no causal function: the ratio of energies is beyond a factor e
DECADE: Final = 10.0  # ratio of the largest and smallest of positive numbers up to which they may well be dB
ROUNDED_COHERENCE: Final = 1.01  # up to which coherence was rounded upwards
FILLED: Final = 0.95
SAME_BAND: Final = 0.5  # share of each sweep's lines in the band common to all; with less, they are segments
SWEEPS_APART: Final = 0.01  # relative deviation from which sweeps with other values are no repetitions
SAME_FREQUENCY: Final = 1e-3  # relative distance up to which two columns hold the same frequency
SAME_PHASE: Final = 1e-2  # median difference [rad] of one phase in degrees and in radians
UNLIKE, CLEARLY = 0.1, 4.0  # mean of 1 - cos of phases that are alike; how much closer one has to be
MOST_DECADES: Final = 18  # decimal logarithm of the highest frequency [Hz]: larger ones are no logarithms
ROUND: Final = 1e-7  # relative deviation from three digits below which a number was meant to be round
_RATIO: Final = ColumnMeaning("magnitude", word="ratio")


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


def names_of(made: Sequence[Assembled], stem: str) -> list[str]:
    """Return what responses are called: the file's stem, their labels, or the stem with a number."""
    labels = [one.label for one in made]
    if len(made) == 1 or (all(labels) and len(set(labels)) == len(labels)):
        return [stem] if len(made) == 1 else labels
    return [f"{stem} {i + 1}" for i in range(len(made))]


def assembled(
    columns: Sequence[DataColumn], file: str, header: Span | None, *, is_asked: bool = False
) -> tuple[list[Assembled], list[str]]:
    """Return the responses that columns make, and what was guessed, as a phase that is not there."""
    guesses: list[str] = []
    columns = _with_frequency(list(columns), file, header, guesses, is_asked=is_asked)
    columns = [_in_hertz(c, columns) for c in _over_input(columns, guesses)]
    crossed = next((c for c in columns if CROSS.fullmatch(c.meaning.label) and c.meaning.kind), None)
    if crossed is not None and not is_asked:
        message = f"column '{crossed.name[:40]}' is named like a cross spectrum, which is not a response"
        hint = "divide it by the spectrum of the input, or say with --columns what the columns are"
        raise DataError(Diagnostic("SF602", message, crossed.span, hint))
    made: list[Assembled] = []
    used: set[int] = set()
    for frequency, *others in _sections(columns):
        lines = _hertz(frequency, guesses)
        for label, of_label in _groups(others, is_asked=is_asked, guesses=guesses):
            group = _without_zeros(of_label, guesses)
            values = _values(group, lines, guesses, columns)
            coherence = group.get("coherence")
            unit = _unit_of_values(next(iter(group.values())), file, guesses)
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
    settings = [c.numbers.real for c in columns if id(c) not in used]
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
    # changed, or they differ by more than noise; others are kept apart, since a response may depend on the
    # direction.
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
    for k in [k for k, same in groups.items() if _differ(np.array([one.values[run] for run in same]))]:
        groups |= {runs.index(run): [run] for run in groups[k]}
    groups = dict(sorted(groups.items()))
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


def _differ(sweeps: Complex) -> bool:
    """Return whether neighbouring lines of sweeps are off their mean alike, as those of noise are not."""
    off = (sweeps - sweeps.mean(axis=0)) / np.abs(sweeps.mean(axis=0))
    power = float(np.nanmean(np.abs(off) ** 2))
    alike = float(np.nanmean((off[:, 1:] * off[:, :-1].conj()).real))
    return power > SWEEPS_APART**2 and alike > power / 2


def _below(column: DataColumn, rows: slice) -> DataColumn:
    wrong = tuple(row - rows.start for row in column.wrong if rows.start <= row < rows.stop)
    location = column.place
    return replace(column, wrong=wrong, place=lambda row: location(row + rows.start))


def _with_frequency(
    columns: list[DataColumn], file: str, header: Span | None, guesses: list[str], *, is_asked: bool
) -> list[DataColumn]:
    problems = []
    for c in columns:
        is_unknown = c.meaning.kind in ("frequency", "phase") and c.meaning.factor is None
        if is_unknown and c.meaning.unit not in ("-", ""):
            units = FREQUENCY_UNITS if c.meaning.kind == "frequency" else PHASE_UNITS
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
        location = "" if header else f"'{file}': "
        raise DataError(Diagnostic("SF602", f"{location}no column is the frequency", header, ask(columns)))
    factor = FREQUENCY_UNITS.get(first.meaning.unit.lower())
    unit = first.meaning.unit if factor else unit_by_round_ends(first.numbers.real) or "Hz"
    why = ", in which its ends are round numbers" if unit == "rad/s" and not factor else ""
    guesses.append(f"column 1 has no name and is taken as the frequency in {unit}{why}")
    return [replace(first, meaning=ColumnMeaning("frequency", FREQUENCY_UNITS[unit.lower()])), *columns[1:]]


def _as_gain(column: DataColumn, guesses: list[str]) -> DataColumn:
    """Return a column, an attenuation in dB as a gain, unless its numbers are negative as those of a gain."""
    meaning, numbers = column.meaning, column.numbers.real
    is_asked = meaning.word == "mag"  # as --columns says
    if is_asked or meaning.scale != "decibel" or not _ATTENUATION.search(column.name):
        return column
    if np.nanmax(numbers) <= RIPPLE * -np.nanmin(numbers):
        return column
    guesses.append(f"'{column.name[:30]}' is read as the gain times -1")
    return replace(column, numbers=-column.numbers)


def _over_input(columns: list[DataColumn], guesses: list[str]) -> list[DataColumn]:
    """Return columns with what comes out over what goes in, where both are sizes without phases."""
    columns = [_as_gain(c, guesses) for c in columns]
    sizes = [c for c in columns if c.meaning.kind in ("magnitude", "power")]
    ends = {c: match[1].lower() for c in sizes if (match := IN_OR_OUT.fullmatch(c.meaning.label))}
    both = {c: "in" if match[1] else "out" for c in sizes if (match := AT_ENDS.fullmatch(c.meaning.label))}
    ends = ends or both
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
    factor, unit = _quotient_of_units(result.meaning.unit, over.meaning.unit)
    ratio = factor * _plain_size(result) / np.where(_plain_size(over) == 0, np.nan, _plain_size(over))
    guesses.append(f"the magnitude is '{result.name[:30]}' over '{over.name[:30]}'")
    meaning = replace(_RATIO, unit=unit)
    quotient = replace(result, meaning=meaning, numbers=ratio, wrong=tuple({*result.wrong, *over.wrong}))
    return [quotient if c is result else c for c in columns if c is not over]


def _quotient_of_units(above: str, below: str) -> tuple[float, str]:
    """Return what the quotient of two columns is multiplied by, and its SI unit if both units are known."""
    known, other = in_si(above), in_si(below)
    if known is None or other is None:
        return 1.0, ""
    return known[0] / other[0], ratio_of_units(known[1], other[1])


def _plain_size(column: DataColumn) -> Real:
    is_level = column.meaning.scale == "unknown" and np.any(column.numbers.real < 0)
    with np.errstate(all="ignore"):
        return size_of(column, "decibel" if is_level else column.meaning.scale)


def _made_over_input(made: list[Assembled], guesses: list[str]) -> list[Assembled]:
    """Return one response for two, of which one is what goes in and the other what comes out."""
    ends = [match[1].lower() if (match := IN_OR_OUT.fullmatch(m.label)) else "" for m in made]
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
    factor, unit = _quotient_of_units(*(m.columns[1].meaning.unit for m in (result, over)))
    with np.errstate(all="ignore"):
        return [replace(result, label="", values=factor * result.values / over.values, unit=unit)]


def _sections(columns: Sequence[DataColumn]) -> list[list[DataColumn]]:
    """Return each frequency column with the columns that belong to it."""
    lines = [c for c in columns if c.meaning.kind == "frequency"]
    first, *others = sorted(
        lines,
        key=lambda c: (c.meaning.scale == "logarithm", c.meaning.factor is None, c.meaning.factor != 1),
    )
    section = [first]
    for other in others:
        a, b = _hertz(first, []), _hertz(other, [])
        if a.shape != b.shape or not np.allclose(a, b, rtol=SAME_FREQUENCY, equal_nan=True):
            section.append(other)
    remaining = [c for c in columns if c.meaning.kind != "frequency"]
    if len(section) == 1:
        return [[first, *remaining]]
    order = list(columns)
    begins = sorted(map(order.index, section))
    cuts = pairwise([*begins, len(order)])
    sections = [[c for c in order[a:b] if c.meaning.kind != "frequency"] for a, b in cuts]
    if not any(sections[:-1]) and all(_is_rounded(first, other) for other in section[1:]):
        return [[first, *remaining]]
    if not all(any(c.meaning.kind for c in one) for one in sections):
        message = "there are two frequency columns with different values"
        raise DataError(Diagnostic("SF602", message, section[1].span, ask(columns)))
    return [[order[a], *one] for a, one in zip(begins, sections, strict=True)]


def _in_hertz(column: DataColumn, others: Sequence[DataColumn]) -> DataColumn:
    """Return a column, a frequency without a unit in Hz if another has the same frequencies in rad/s."""
    if column.meaning.kind != "frequency" or column.meaning.factor is not None:
        return column
    in_hz = replace(column, meaning=replace(column.meaning, factor=1.0))
    known = (c for c in others if c.meaning.kind == "frequency" and c.meaning.factor not in (None, 1.0))
    return in_hz if any(_is_rounded(in_hz, c) for c in known) else column


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
        factor = FREQUENCY_UNITS["rad/s"] if is_angular else 1.0
        said = "rad/s, in which its ends are round numbers" if is_angular else "Hz"
        guesses.append(f"'{column.name[:30]}' has no unit and is read in {said}")
    if KINDS.get(column.meaning.word) == "omega" and not column.meaning.unit:
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
    columns: Sequence[DataColumn], *, is_asked: bool, guesses: list[str]
) -> list[tuple[str, dict[str, DataColumn]]]:
    labels = dict.fromkeys(c.meaning.label for c in columns if c.meaning.kind)
    alike = {label: [c for c in columns if c.meaning.label == label] for label in labels}
    groups = [(label, group) for label in labels for group in _pairs(alike[label])]
    groups = groups or [("", group) for group in _pairs(columns)]
    coherences = [c for c in columns if c.meaning.kind == "coherence"]
    if len(coherences) in (1, len(groups)):
        for i, (_, group) in enumerate(groups):
            group.setdefault("coherence", coherences[i % len(coherences)])
    powers = [c for c in columns if c.meaning.kind == "power"]
    if not groups and powers:
        single_axes = [c for c in powers if c.meaning.label != "xyz"] or powers[:1]
        with np.errstate(all="ignore"):
            totals = [float(np.nan_to_num(np.nansum(np.abs(c.numbers)))) for c in single_axes]
        best = single_axes[totals.index(max(totals))]
        others = f", the strongest of {len(powers)}" if len(powers) > 1 else ""
        flat = "its square root is the magnitude, the excitation taken as flat"
        guesses.append(f"'{best.name[:30]}'{others}: {flat}")
        groups = [(best.meaning.label, {"power": best})]
    sizes = [c for c in columns if c.meaning.kind == "magnitude"]
    if not groups and len(sizes) == 1 and (is_asked or sizes[0].meaning.word == _RATIO.word):
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
        alike = [c for c in sizes if c.meaning.label and phases[0].meaning.label.startswith(c.meaning.label)]
        sizes = sorted(
            alike or sizes,
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


def _decided(
    magnitude: DataColumn, phase: DataColumn, lines: Real, guesses: list[str], columns: Sequence[DataColumn]
) -> tuple[Real, Real]:
    """Return magnitude and phase [rad], with the scale and unit that names or numbers say."""
    if magnitude.meaning.kind == "power":
        levels = magnitude.numbers * (2 if magnitude.meaning.scale == "decibel" else 1)
        itself = replace(magnitude, numbers=levels, meaning=replace(magnitude.meaning, kind="magnitude"))
        radians = phase.numbers.real * (phase.meaning.factor or np.pi / 180)
        root_fit, own_fit = (misfit(lines, _plain_size(c), radians) for c in (magnitude, itself))
        magnitude = itself if own_fit < root_fit else magnitude
        which = "the response itself" if own_fit < root_fit else "the square of the magnitude"
        guesses.append(f"{_called(magnitude, 'the power')} is {which}, which fits the phase")
    scales = ["linear", "decibel"] if magnitude.meaning.scale == "unknown" else [magnitude.meaning.scale]
    if len(scales) > 1 and np.any(magnitude.numbers.real <= 0):
        scales = ["decibel"]
    turn = np.asarray(phase.numbers.real, np.float64)
    factors = _possible_units(turn) if phase.meaning.factor is None else [phase.meaning.factor]
    is_gain = magnitude.meaning.word in ("gain", "level")
    costs = {(s, f): unlikeness(lines, size_of(magnitude, s), f * turn) for s, f in product(scales, factors)}
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
    size, turned = size_of(magnitude, scale), np.asarray(factor * phase.numbers.real, np.float64)
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


def ratio_unit(text: str, file: str) -> str:
    """Return a unit that a header gives, where it is one of a ratio; g may be the gram and is not taken."""
    small = re.sub(_ANY_OHM, "Ohm", text, flags=re.I)
    if small == "1":
        return small
    if "/" not in small.replace("Ohm", "/") or re.search(r"\bg\b", small):
        return ""
    try:
        return unit_of(small, file)
    except DataError:
        return ""


def _unit_of_values(column: DataColumn, file: str, guesses: list[str]) -> str:
    """Return the unit of a response; another one that would change values is said."""
    unit = ratio_unit(column.meaning.unit, file)
    if not unit and not _is_plain(column.meaning):
        written = f"the unit '{column.meaning.unit[:20]}' of '{column.name[:30]}'"
        guesses.append(f"{written} is not taken: values are as written")
    return unit


def _is_plain(meaning: ColumnMeaning) -> bool:
    """Return whether a unit is none, or one that changes no values."""
    is_scale = meaning.unit.lower().strip("-") in ("", "%", "lin", "abs", *UNITS)
    return is_scale or meaning.scale == "decibel" or (in_si(meaning.unit) or (0.0, ""))[0] == 1


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
    location = "" if header else f"'{file}': "
    unknown = next((c for c in columns if not c.meaning.kind and c.name), None)
    pairs = [("real", "imaginary"), ("magnitude", "phase")]
    missing = next((b if a in kinds else a for a, b in pairs if (a in kinds) != (b in kinds)), None)
    message = (
        f"{location}a column of {missing} is missing" if missing else f"{location}no columns have the values"
    )
    if not (unknown and missing and header):
        return Diagnostic("SF602", message, header, ask(columns))
    hint = " ".join(filter(None, (nearest(unknown.name.lower(), KINDS), ask(columns))))
    return Diagnostic("SF602", f"{message}: unknown column '{unknown.name[:40]}'", unknown.span, hint)
