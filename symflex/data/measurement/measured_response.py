"""A measured frequency response: values, what is known of their accuracy, and where they come from."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

SMALLEST_NOISE = 1e-6
"""The least share of incoherent power assumed: a coherence rounded to 1 does not make a line exact."""
SHARE_OF_MEDIAN = 0.02
"""No line counts more than fifty times as much as the median one, however its coherence was rounded."""


@dataclass(frozen=True, eq=False)
class MeasuredResponse:
    """A frequency response as an analyser estimates it, on increasing frequencies.

    Parameters
    ----------
    name : str
        What it is called in reports: ``OUT/IN`` where the file says so, else the file's stem.
    frequency_hz : array of float, shape (n,)
        Positive and increasing [Hz].
    values : array of complex, shape (n,)
        Output over input, finite and not zero.
    coherence : array of float, shape (n,), optional
        Ordinary coherence, 0 < gamma^2 <= 1.
    averages : float, optional
        The number of independent averages behind each value.
    window : str
        The time window of the estimate, ``hann``; empty when it is unknown or there was none.
    unit : str
        Of the values; empty when unknown.
    is_synthetic : bool
        True for computed data.
    notes : tuple of str
        What the file says about itself.

    Notes
    -----
    The arrays are copied and read-only. Convention: values are those of exp(+j omega t).

    Examples
    --------
    >>> response = MeasuredResponse("A/F", [1.0, 2.0], [1.0, 2j], coherence=[0.5, 0.9], averages=8)
    >>> response.relative_deviation().round(3).tolist()
    [0.25, 0.083]
    """

    name: str
    frequency_hz: npt.NDArray[np.float64]
    values: npt.NDArray[np.complex128]
    coherence: npt.NDArray[np.float64] | None = None
    averages: float | None = None
    window: str = ""
    unit: str = ""
    is_synthetic: bool = False
    notes: tuple[str, ...] = field(default=(), repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "frequency_hz", _frozen(np.array(self.frequency_hz, np.float64)))
        object.__setattr__(self, "values", _frozen(np.array(self.values, np.complex128)))
        if self.coherence is not None:
            object.__setattr__(self, "coherence", _frozen(np.array(self.coherence, np.float64)))
        shapes = {a.shape for a in (self.frequency_hz, self.values, self.coherence) if a is not None}
        if self.frequency_hz.ndim != 1 or len(shapes) != 1:
            message = f"a measured response needs one-dimensional arrays of one length, not {sorted(shapes)}"
            raise ValueError(message)

    @property
    def omega(self) -> npt.NDArray[np.float64]:
        """``2 pi`` times the frequency [rad/s]."""
        return 2 * np.pi * self.frequency_hz

    @property
    def spacing_hz(self) -> float | None:
        """The distance between neighbouring lines [Hz] where it is the same throughout, else None."""
        steps = np.diff(self.frequency_hz)
        if not steps.size or np.ptp(steps) > 1e-3 * float(steps.mean()):
            return None
        return float(steps.mean())

    def relative_deviation(self) -> npt.NDArray[np.float64] | None:
        """Return the standard deviation of the real and of the imaginary part, over the magnitude.

        sqrt((1 - gamma^2)/(2 gamma^2 n)) for an H1 estimate with n independent averages (Bendat & Piersol,
        Random Data, 4th ed. 2010, section 9.1, equation 9.90). Without a number of averages n = 1 stands,
        which is right up to one factor for all lines; None without coherence.
        """
        if self.coherence is None:
            return None
        share = np.maximum(1 - self.coherence, SMALLEST_NOISE) / np.maximum(self.coherence, SMALLEST_NOISE)
        share = np.maximum(share, SHARE_OF_MEDIAN * float(np.median(share)))
        return np.sqrt(share / (2 * (self.averages or 1.0)))

    def misfit_db(self, model: npt.NDArray[np.complex128]) -> float:
        """Return the root mean square of the model over the data on the lines [dB], magnitude alone."""
        with np.errstate(divide="ignore"):
            level = 20 * np.log10(np.abs(model / self.values))
        return float(np.sqrt(np.mean(level**2)))

    def misfit_degrees(self, model: npt.NDArray[np.complex128]) -> float:
        """Return the root mean square of the model's phase less that of the data on the lines [deg]."""
        return float(np.degrees(np.sqrt(np.mean(np.angle(model / self.values) ** 2))))

    def between(self, low_hz: float, high_hz: float) -> MeasuredResponse:
        """Return the lines within a band [Hz], its ends included."""
        kept = (self.frequency_hz >= low_hz) & (self.frequency_hz <= high_hz)
        coherence = None if self.coherence is None else self.coherence[kept]
        return replace(
            self, frequency_hz=self.frequency_hz[kept], values=self.values[kept], coherence=coherence
        )


def _frozen(array: npt.NDArray[np.generic]) -> npt.NDArray[np.generic]:
    array.setflags(write=False)
    return array
