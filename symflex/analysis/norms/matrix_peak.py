"""The largest singular value of a transfer matrix over all real frequencies, and where it is.

Input: bound transfer functions, a row per output. Output: a :class:`~symflex.loops.peak.Peak`.

Example: ``[[1/(s + 1), 1/(s + 1)], [1/(s + 1), 1/(s + 1)]]`` has 2, at 0 Hz.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf, pi

from flint import arb

from symflex.analysis.norms.axis import MatrixOnAxis
from symflex.analysis.norms.energy import MODES, matrix_name
from symflex.analysis.norms.expanded import BITS, Expanded, expanded, turning_delays
from symflex.analysis.norms.largest import largest_gain
from symflex.balls import ball, precision
from symflex.loops.peak import Peak
from symflex.options import Ends, band_ends
from symflex.roots import Band, PoleZeroMap, Position, figure
from symflex.roots.pole_zero_map import EXAMINED
from symflex.roots.root import short_hertz
from symflex.transfer import AnyBoundFunction

WIDTH = 1e-6  # relative distance of the bounds
DIGITS = 8
SINGULAR, MET = "largest singular value", "largest singular value found"

Rows = Sequence[Sequence[AnyBoundFunction]]


def matrix_on_axis(
    rows: Rows, modes: int = MODES, judged: PoleZeroMap | None = EXAMINED, *, keeps_delays: bool = False
) -> MatrixOnAxis:
    """Return the functions of a matrix in discs that reach beyond so many modes.

    Delays of inputs and outputs change no singular value, and are left out if not kept. Poles far out in the
    right half-plane are not looked for, which ``None`` in place of what is judged changes.
    """
    every: list[Expanded] = []
    for bound in (bound for row in rows for bound in row):
        every.append(expanded(bound, modes, alike=every, judged=judged, keeps_delay=keeps_delays))
    width = len(rows[0])
    functions = tuple(tuple(every[i : i + width]) for i in range(0, len(every), width))
    return MatrixOnAxis(functions, delays=turning_delays(functions))


def find_matrix_peak(rows: Rows, band: Ends | None = None) -> Peak:
    """Return the largest singular value over all frequencies, or in a band [Hz], enclosed.

    SF802 where no principal parts are known, SF405 where residues are not known, SF236 for functions that
    grow with frequency.
    """
    name, unit = matrix_name(rows)
    ends = None if band is None else Band(*band_ends(band))
    return peak_on_axis(matrix_on_axis(rows), Peak(name, unit, DIGITS, ends, arb("inf"), (), what=SINGULAR))


def peak_on_axis(matrix: MatrixOnAxis, asked: Peak) -> Peak:
    """Return the largest singular value of a matrix in the band of what is asked."""
    ends, asked = asked.band, replace(asked, reasons=matrix.reasons)
    poles = [part.root for function in matrix.every for part in function.parts]
    inside = (
        pole
        for pole in poles
        if pole.on_imaginary_axis
        and not pole.im < 0
        and (ends is None or ends.classify([pole])[0] is not Position.OUTSIDE)
    )
    infinite = next(inside, None)
    if infinite is not None:
        return replace(asked, places=(infinite.im,))
    with precision(BITS):
        limits = (0.0, inf) if ends is None else tuple(float(2 * pi * ball(x)) for x in (ends.low, ends.high))
    found = largest_gain(matrix, None if ends is None else (limits[0], limits[1]), WIDTH)
    beyond = arb("inf") if found.omega == inf else None
    reasons, magnitude, places = found.reasons, found.enclosure, found.places
    if not found.most.is_finite():
        lowest = min((place.lower() for place in found.places), key=float, default=arb(found.omega))
        reasons += (f"values at {short_hertz(lowest)} Hz and beyond are not bounded",)
    with precision(BITS):
        is_wide = not found.most <= found.least * (1 + 2 * arb(WIDTH))
    if is_wide and magnitude.is_finite():
        reasons += (f"values up to {figure(found.most, DIGITS)} are not excluded",)
    if reasons:
        # What is met is a fact; whether it is the largest is not.
        magnitude = found.least
        places = (arb(found.omega),) if found.omega < inf else ()
        asked = replace(asked, what=MET)
    return replace(asked, magnitude=magnitude, places=places, beyond=beyond, reasons=reasons)
