"""What a user knows of measured responses besides what their files say."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from symflex.data.measurement.checks import MOST_AVERAGES
from symflex.errors import DataError, Diagnostic, UsageError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.data.measurement.measured_response import MeasuredResponse


def prepared(
    responses: Sequence[MeasuredResponse],
    band: tuple[float, float] | None = None,
    averages: float | None = None,
    window: str | None = None,
) -> tuple[MeasuredResponse, ...]:
    """Return responses with what is known of them, and the lines in a band alone.

    Parameters
    ----------
    responses : sequence of MeasuredResponse
        As read.
    band : (float, float), optional
        The lowest and the highest frequency kept [Hz].
    averages : float, optional
        Independent averages.
    window : str, optional
        ``hann`` or ``none``.

    Raises
    ------
    UsageError
        SF902 a band whose ends are not in order, an unknown window, or no number of averages.
    DataError
        SF605 when a response has no lines in the band.

    Examples
    --------
    >>> from symflex.data.measurement import MeasuredResponse
    >>> (one,) = prepared([MeasuredResponse("A/F", [1.0, 2.0, 3.0], [1, 2, 3])], (1.5, 9.0), averages=8)
    >>> one.frequency_hz.tolist(), one.averages
    ([2.0, 3.0], 8)
    """
    if window not in (None, "hann", "none"):
        raise UsageError(Diagnostic("SF902", f"the window '{window[:40]}' is neither hann nor none"))
    if averages is not None and not 1 <= averages <= MOST_AVERAGES:
        message = f"the number of averages is {averages:g}; it lies between 1 and {MOST_AVERAGES:g}"
        raise UsageError(Diagnostic("SF902", message))
    if band is not None and not 0 <= band[0] < band[1]:
        raise UsageError(Diagnostic("SF902", "a band is two frequencies in Hz, the lower one first"))
    found = []
    for response in responses:
        known = response
        if averages is not None:
            known = replace(known, averages=averages)
        if window is not None:
            known = replace(known, window=window.replace("none", ""))
        if band is not None:
            known = known.between(*band)
            if not known.values.size:
                message = f"'{response.name}' has no lines between {band[0]:g} and {band[1]:g} Hz"
                raise DataError(Diagnostic("SF605", message))
        found.append(known)
    return tuple(found)
