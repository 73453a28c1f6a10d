"""What every data file has to fulfil, whatever its format."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from symflex.data.measurement.measured_response import MeasuredResponse
from symflex.errors import DataError, Diagnostic, Source, Span, SpecError, Text
from symflex.quantities import parse_unit

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    import numpy.typing as npt

MAX_BYTES: Final = 50_000_000
MAX_LINES: Final = 1_000_000
MAX_RESPONSES: Final = 100
"""Larger files are refused before they fill the memory."""
MAX_ERRORS: Final = 20
"""Problems of one file that are listed."""
FEWEST_LINES = 3
MOST_AVERAGES = 1e9
"""Of a number of averages, beyond which it is a mistake."""
SHOWN_NAMES = 8
SMALLEST, LARGEST = 1e-100, 1e100
"""Of a magnitude: its square, and the square of that over another, have to be numbers too."""


def checked_response(
    response: MeasuredResponse, file: str, span_of: Callable[[int, str], Span | None]
) -> MeasuredResponse:
    """Return a response whose lines are in order, without the one at 0 Hz.

    ``span_of`` says where a line's ``frequency``, ``value`` or ``coherence`` stands. SF603 values that are
    not numbers, or out of range; SF604 frequencies that repeat or do not increase; SF605 too few lines; SF607
    too many.
    """
    frequency, values, coherence = response.frequency_hz, response.values, response.coherence
    if frequency.size > MAX_LINES:
        raise DataError(Diagnostic("SF607", f"'{file}' has more than {MAX_LINES} lines"))
    problems: list[Diagnostic] = []

    def note(
        code: str, wrong: npt.NDArray[np.bool_], column: str, say: Callable[[int], str], hint: str
    ) -> None:
        for i in np.flatnonzero(wrong)[: MAX_ERRORS - len(problems)].tolist():
            span = span_of(i, column)
            place = "" if span else f"'{file}', line {i + 1} of {response.name}: "
            problems.append(Diagnostic(code, place + say(i), span, hint))

    note(
        "SF603",
        ~np.isfinite(frequency) | (frequency < 0),
        "frequency",
        lambda i: f"frequency {frequency[i]:g} Hz",
        "frequencies are positive numbers [Hz]",
    )
    note(
        "SF603",
        ~np.isfinite(values),
        "value",
        lambda i: "the value is not a finite number",
        "leave the line out",
    )
    note(
        "SF603",
        np.isfinite(values) & (values == 0),
        "value",
        lambda i: "the value is zero, which no measurement is",
        "leave the line out",
    )
    with np.errstate(over="ignore"):
        size = np.abs(values)
    note(
        "SF603",
        np.isfinite(values) & (values != 0) & ~((size >= SMALLEST) & (size <= LARGEST)),
        "value",
        lambda i: f"the value {values[i]:.3g} has a magnitude beyond {SMALLEST:g} to {LARGEST:g}",
        "check the unit of the values",
    )
    if coherence is not None:
        note(
            "SF603",
            ~((coherence >= 0) & (coherence <= 1)),
            "coherence",
            lambda i: f"coherence {coherence[i]:g}",
            "coherence lies between 0 and 1",
        )
    if not problems and frequency.size:
        steps = np.diff(frequency, prepend=-1.0)
        note(
            "SF604",
            steps == 0,
            "frequency",
            lambda i: f"frequency {frequency[i]:.9g} Hz repeats",
            "one line per frequency",
        )
        backwards = steps < 0
        others = int(backwards.sum()) - 1
        # The first one tells: in a file sorted downwards every line would be named.
        note(
            "SF604",
            backwards & (np.cumsum(backwards) == 1),
            "frequency",
            lambda i: (
                f"frequency {frequency[i]:.9g} Hz follows {frequency[i - 1]:.9g} Hz"
                + (f", and {others} more lines are out of order" if others else "")
            ),
            "sort the lines by frequency",
        )
    if problems:
        raise DataError(*problems)
    kept = response.between(np.nextafter(0.0, 1.0), np.inf)
    if kept.values.size < FEWEST_LINES:
        message = f"'{file}' has {kept.values.size} lines of data; at least {FEWEST_LINES} are needed"
        raise DataError(Diagnostic("SF605", message))
    return kept


def nowhere(index: int, column: str) -> Span | None:
    """Return no place: arrays have none."""
    del index, column
    return None


def averages_of(text: str, file: str, span: Span | None = None) -> float:
    """Return a number of averages; SF603 when it is none."""
    try:
        number = float(text)
    except ValueError:
        number = float("nan")
    if not 1 <= number <= MOST_AVERAGES:
        place = "" if span else f"'{file}': "
        message = f"{place}the number of averages is '{text[:40]}'"
        raise DataError(Diagnostic("SF603", message, span, "a number from 1 on"))
    return number


def unit_of(text: str, file: str, span: Span | None = None) -> str:
    """Return the unit of the values, checked; empty when there is none, SF602 when it is not a unit.

    Examples
    --------
    >>> unit_of(" m/N", "a.csv")
    'm/N'
    """
    unit = text.strip()
    if not unit:
        return ""
    try:
        parse_unit(Text(unit, Span(Source(file, unit), 0, len(unit))))
    except SpecError as error:
        (reason, *_) = error.diagnostics
        place = "" if span else f"'{file}': "
        message = f"{place}the unit of the values: {reason.message}"
        hint = (
            reason.hint or "such as m/N, m/(N*s^2), rad/V; 1 for a pure number; without a unit leave it out"
        )
        raise DataError(Diagnostic("SF602", message, span, hint)) from None
    return unit


def window_of(text: str) -> str:
    """Return ``hann`` for the names analysers give that window, else nothing.

    Examples
    --------
    >>> window_of(" Hanning"), window_of("flat top")
    ('hann', '')
    """
    return "hann" if text.strip().lower() in ("hann", "hanning", "von hann") else ""


def listed_names(names: Sequence[str]) -> str:
    """Return some names for a message."""
    shown = ", ".join(name[:30] for name in names[:SHOWN_NAMES])
    return shown + (", ..." if len(names) > SHOWN_NAMES else "")
