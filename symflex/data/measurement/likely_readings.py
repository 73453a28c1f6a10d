"""What columns without a clear name may be: the hint that asks, with the likeliest option first.

Input: columns, of which some are known. Output: the option ``--columns`` that reads them, by their numbers.

    f; 12 to -40; -3 to -178          ->  say what the columns are: --columns f,mag_db,phase_deg
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from itertools import permutations, product
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from symflex.data.measurement.column_meaning import ColumnMeaning, DataColumn, counts, meaning_of, size_of
from symflex.data.measurement.column_names import OTHER_SIZE
from symflex.data.measurement.minimum_phase import FEWEST_TO_DECIDE, misfit

Real = npt.NDArray[np.float64]

_NO_WORD = re.compile(
    rf"{OTHER_SIZE.pattern}|\b(?:time|zeit|temps|tiempo)\b|^t\b|^f\s*/\s*f|\b(?:shift|detuning)\b", re.I
)
"""Names of what no word of ``--columns`` means."""
HINT: Final = (
    "columns: frequency_hz; re, im or magnitude_db, phase_deg or magnitude, phase_rad; coherence if known"
)
WITHOUT_TIME: Final = "of a time record, say the sampling time: --columns {}"
WITHOUT_AXIS: Final = "if the file has no frequencies, --from HZ --step HZ give them"
UNDECIDED: Final = 1.5  # natural logarithm of how much less causal the other reading has to be
LEAST_LEVELS: Final = 1.0  # range [dB] below which positive numbers are rather ratios
SAME_SIZE: Final = 0.02  # relative deviation up to which a value is that of another column, of few digits
MOST_ALIKE: Final = 0.9  # share of lines from which a column is another one, or a counter
MOST_LISTED: Final = 6  # columns that are not used and are listed by name
EVENLY, HELD = 0.02, 0.1  # median deviation of a time's steps; share of equal neighbours in signals
SINCE_1970: Final = 1e11  # numbers above which an unnamed axis is a time in milliseconds, no frequency
MOST_COMPARED: Final = 1000  # lines by which readings are compared
UNLIKE_RESPONSES: Final = 1.0  # natural logarithm from which columns are no response: energies e apart
_Reading = tuple[tuple[str, str], tuple[int, int]]  # words, and their columns
_READINGS: Final = (("re", "im"), *product(("mag_db", "mag"), ("phase_deg", "phase_rad")))
"""Words of ``--columns`` that make a response in pairs."""


@np.errstate(all="ignore")  # numbers that are not finite are reported elsewhere
def ask(columns: Sequence[DataColumn], unit: str = "f", pair: tuple[DataColumn, ...] = ()) -> str:
    """Return the hint with the option that says what columns are, or a pair, the likeliest reading first."""
    is_indexed = len(columns) > 2 and counts(columns[0].numbers)  # noqa: PLR2004 (index, axis, value)
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
    """Return the option that reads columns as a time record, nothing where the first is no time."""
    times = columns[0].real
    if counts(times):
        return f"--columns {'-,' * (before + 1)}{signals(columns[1:], ',dt=SECONDS of a time record')}"
    steps, usual = np.diff(times), np.median(np.diff(times))
    if usual <= 0 or (times[0] and not np.median(np.abs(steps - usual)) <= EVENLY * usual):
        return ""
    return f"--columns {'-,' * before}t,{signals(columns[1:], ' of a time record')}"


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


def is_time(columns: Sequence[Real]) -> bool:
    """Return whether the first of three columns or more goes up evenly from zero, beside no response."""
    times, steps = columns[0], np.diff(columns[0])
    if times[0] > 0 or not np.allclose(steps, steps.mean(), EVENLY, 0) or counts(times) or not columns[2:]:
        return False
    made = [DataColumn("", ColumnMeaning(), x) for x in columns]
    is_at_rest = all(abs(x[0]) <= SAME_SIZE * np.std(x) for x in columns[1:])  # as a record may begin
    limit = UNLIKE_RESPONSES / 2 if is_at_rest else UNLIKE_RESPONSES
    return min(_costs(made, 0, range(1, len(columns))).values(), default=np.inf) > limit


def _likely(
    columns: Sequence[DataColumn], axis: int, open_ones: Sequence[int], margin: float
) -> list[_Reading]:
    """Return the readings of two columns as one response, words and places, the likeliest first."""
    costs = _costs(columns, axis, open_ones)
    best = min(costs.values(), default=0.0)
    near = [reading for reading in costs if costs[reading] <= best + margin]
    return sorted(near, key=costs.__getitem__)[:3]


def _costs(columns: Sequence[DataColumn], axis: int, open_ones: Sequence[int]) -> dict[_Reading, float]:
    """Return how far each reading of two columns is off a causal function."""
    columns = [replace(c, numbers=c.numbers[:: c.numbers.size // MOST_COMPARED + 1]) for c in columns]
    lines, costs = np.asarray(columns[axis].numbers.real, np.float64), dict[_Reading, float]()
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
            size = size_of(one, "decibel" if words[0] == "mag_db" else "linear")
            turn = two.numbers.real * (np.pi / 180 if words[1] == "phase_deg" else 1.0)
        costs[words, pair] = misfit(lines, size, turn)
    return costs
