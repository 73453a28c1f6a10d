"""Frequency grids that miss no resonance, and the band shown when none is asked for.

Input: certified poles and zeros. Output: angular frequencies [rad/s].
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import log, pi
from typing import TYPE_CHECKING

import numpy as np

from symflex.analysis.response.frequency_response import evaluate
from symflex.errors import Diagnostic, SymflexError, UsageError
from symflex.roots import Band, Certificate, Everything, PoleZeroMap
from symflex.roots.locate import locate

if TYPE_CHECKING:
    import numpy.typing as npt

    from symflex.transfer import BoundTransferFunction

REFINED_DAMPING = 0.3
AXIS_GAP = 1e-7
PHASE_STEPS = 24
WIDEST_ANGLE = 0.94 * pi / 2
POINTS_PER_DECADE = 6
COARSE_STEPS = 3
DEFAULT_BAND_HZ = (0.1, 10.0)
WITHOUT_ROOTS = ("SF404", "SF505")
"""Codes of searches that end without roots; where the time is over, that is said instead."""
FOLLOWING_ERROR = 0.02
"""Of the square of a value between two others, over their product: a tenth of a decibel, half a degree."""
FOLLOWING_ROUNDS = 12
MOST_POINTS = 20_000
BEYOND_LAST_POLE = 1.3
"""A distributed system has further poles just above the last one found."""


def default_band(*maps: PoleZeroMap) -> tuple[float, float]:
    """Return a band [Hz] that shows all poles and zeros of functions that are to be shown together.

    It goes from a decade below the lowest to a decade above the highest nonzero natural frequency, of a
    distributed system a little above the highest pole found; 0.1 Hz to 10 Hz when there is none.

    Examples
    --------
    >>> from symflex.roots import RootProblem, find_pole_zero_map
    >>> one = RootProblem.from_rationals([1])
    >>> low, high = default_band(find_pole_zero_map("x/F", RootProblem.from_rationals([9, 0, 1]), one))
    >>> print(f"{low * 2 * pi:.3f} {high * 2 * pi:.3f}")
    0.300 30.000
    """
    lows, highs = [], []
    for found in maps:
        poles = [root.frequency_hz() for root in found.poles if not root.is_zero]
        zeros = [root.frequency_hz() for root in found.zeros if not root.is_zero]
        lows += poles + zeros
        if found.is_infinite and poles:
            highs.append(max(poles) * BEYOND_LAST_POLE)
        else:
            highs += [frequency * 10 for frequency in poles + zeros]
    return (min(lows) / 10, max(highs)) if lows else DEFAULT_BAND_HZ


def roots_if_found(bound: BoundTransferFunction, band: Band | None = None) -> PoleZeroMap:
    """Return the poles and zeros, or as many as can be had: a response needs none.

    The certificate says why where roots may be missing. Without a band all are sought, of a distributed
    system those of :func:`symflex.roots.default_region`.
    """
    region = band if bound.is_distributed else None
    try:
        return locate(bound, region)
    except SymflexError as error:
        problem = error.diagnostics[0]
        if problem.code not in WITHOUT_ROOTS:
            raise
        certificate = Certificate("", False, 0, 0, problem.message, is_exceeded=True, code=problem.code)
        return PoleZeroMap(bound.name, region or Everything(), (), (), (), certificate, is_infinite=True)


def adaptive_grid(
    bound: BoundTransferFunction,
    low_hz: float,
    high_hz: float,
    points: int = 600,
    roots: PoleZeroMap | None = None,
) -> npt.NDArray[np.float64]:
    """Return angular frequencies [rad/s] on which no peak or trough of a transfer function is missed.

    ``points`` are spaced logarithmically. Around a root -a + j b more advance in equal steps of the phase it
    causes, b itself among them; around a root on the axis they close in up to 1e-7 b and leave it out. Where
    roots may be missing, points are added until the values turn little from one to the next: a peak narrower
    than the first steps may be missed then. ``roots`` are all poles and zeros, of a distributed system those
    in the band, when they are known already.

    SF227 when the band is empty or not positive, ValueError for fewer than 2 points.
    """
    if not 0 < low_hz < high_hz < float("inf"):
        message = f"a band runs from a positive to a higher frequency, not from {low_hz:g} to {high_hz:g} Hz"
        raise UsageError(Diagnostic("SF227", message))
    if points < 2:  # noqa: PLR2004
        message = f"a grid has at least 2 points, not {points}"
        raise ValueError(message)
    if roots is None:
        roots = locate(bound, Band(Fraction(low_hz), Fraction(high_hz)) if bound.is_distributed else None)
    found = roots
    low, high = 2 * pi * low_hz, 2 * pi * high_hz
    step = log(high / low) / (points - 1)
    parts = [np.geomspace(low, high, points)]
    on_axis: list[float] = []
    for root in (*found.poles, *found.zeros):
        damping = root.damping_ratio()
        if root.is_real or root.im < 0 or damping is None or abs(damping) > REFINED_DAMPING:
            continue
        width, centre = abs(float(root.re.mid())), float(root.im.mid())
        if root.on_imaginary_axis:
            on_axis.append(centre)
        offsets = _offsets(width, centre, COARSE_STEPS * step * centre)
        parts += [centre - offsets, centre + offsets]
    grid = np.unique(np.concatenate(parts))
    grid = grid[(grid >= low) & (grid <= high)]
    for centre in on_axis:
        # A hair less than the gap, so that the points placed at the gap itself survive rounding.
        grid = grid[np.abs(grid - centre) > 0.99 * AXIS_GAP * centre]
    return _followed(bound, grid) if found.certificate.is_exceeded else grid


def _followed(bound: BoundTransferFunction, grid: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return a grid with points added where a straight line misses the logarithm of the values between."""
    known = dict(zip(grid.tolist(), evaluate(bound, grid).tolist(), strict=True))
    pending = list(pairwise(grid.tolist()))
    for _ in range(FOLLOWING_ROUNDS):
        middles = np.array([(a * b) ** 0.5 for a, b in pending])
        values = evaluate(bound, middles).tolist()
        known.update(zip(middles.tolist(), values, strict=True))
        split = []
        for (a, b), middle, value in zip(pending, middles.tolist(), values, strict=True):
            product = known[a] * known[b]
            if not abs(value * value - product) < FOLLOWING_ERROR * abs(product):
                split += [(a, middle), (middle, b)]
        pending = split
        if not pending or len(known) > MOST_POINTS:
            break
    return np.array(sorted(known))


def _offsets(width: float, centre: float, reach: float) -> npt.NDArray[np.float64]:
    """Return distances from the centre of a resonance, out to where the coarse grid takes over."""
    if width == 0:
        near, inner = np.empty(0), AXIS_GAP * centre
    else:
        near = width * np.tan(np.linspace(0, WIDEST_ANGLE, PHASE_STEPS))
        inner = float(near[-1])
    if reach <= inner:
        return near
    count = int(POINTS_PER_DECADE * log(reach / inner, 10)) + 2
    return np.concatenate((near, np.geomspace(inner, reach, count)))
