"""What every kind of figure offers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.errors import Diagnostic, UsageError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from symflex.transfer import BoundTransferFunction, TransferFunction


Limits = tuple[float, float]
"""The lower and the higher end of an axis."""
LARGEST = 1e30
"""Ends of an axis: far below what single precision holds, in which readers of pages compute."""
NARROWEST = 1e-6
"""Of the length of an axis over its ends: its ticks have six digits."""


@dataclass(frozen=True, slots=True)
class AxisLimits:
    """Ends of axes in place of those that a figure would choose.

    Examples
    --------
    >>> AxisLimits(x=(-10.0, 0.0)).y is None
    True
    """

    # x and y: of the axes across and upwards: real and imaginary part, in an s plane [rad/s]; magnitudes [dB]
    # of a Bode plot upwards, whose frequencies are its band.
    x: Limits | None = None
    y: Limits | None = None
    phase: Limits | None = None  # of a Bode plot [deg]

    def __post_init__(self) -> None:
        for ends in (self.x, self.y, self.phase):
            if ends is None:
                continue
            # Written so that what is not a number is refused too.
            if not -LARGEST <= ends[0] < ends[1] <= LARGEST:
                message = f"an axis runs from a lower to a higher number, not from {ends[0]:g} to {ends[1]:g}"
                raise UsageError(Diagnostic("SF902", message))
            if ends[1] - ends[0] < NARROWEST * max(map(abs, ends)):
                message = f"an axis from {ends[0]!r} to {ends[1]!r} is too short to be drawn"
                raise UsageError(Diagnostic("SF902", message))


FREE = AxisLimits()
"""Every axis is as the figure chooses it."""


@dataclass(frozen=True, slots=True)
class Canvas:
    """What is asked of a figure, whatever its kind."""

    band_hz: Limits | None = None  # frequencies shown [Hz]
    frame: AxisLimits = FREE  # of axes, in place of those that suit what is drawn
    title: str | None = None  # printed as it is
    width: float | None = None  # [inches]; by default what suits the figure

    def band_of(self, tf: TransferFunction) -> Limits | None:
        """Return the band asked for, else that of a model [Hz]."""
        band = tf.model.analysis.band
        return self.band_hz or (None if band is None else (float(band[0]), float(band[1])))


Drawing = Callable[["Sequence[TransferFunction]", "Sequence[BoundTransferFunction]", Canvas], "Figure"]
"""A function that draws transfer functions; :func:`symflex.figures.draw` sets the style."""
