"""How far a rational approximation is from its transfer function along the imaginary axis.

The error at omega is ``|R - G|/|G|``, with the dips of G filled: beside a zero of G on the imaginary axis any
function has an infinite relative error whose own zero is not exactly the same. So within a tenth of a zero's
distance from the origin, the factor ``|j omega - z|`` of ``|G|`` counts as ``|z|/10``; an antiresonance that
is off by 0.1 % makes an error of 1 %. At a pole that R and G share both are infinite; the error beside it
compares residues and stays finite, and is taken for the error at the pole.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from symflex.analysis.response import adaptive_grid

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy.typing as npt

    from symflex.roots import PoleZeroMap
    from symflex.transfer import BoundTransferFunction

DIP = 0.1
"""Distance from a zero, relative to its distance from 0, within which its dip is filled."""
AXIS_GAP = 1e-7
"""Distance kept from poles on the imaginary axis, relative to theirs from 0."""
POINTS = 400
BISECTIONS = 60
"""More than a double has bits."""


@dataclass(frozen=True, slots=True)
class BandError:
    """The largest error met in a band.

    Parameters
    ----------
    low_hz, high_hz : float
        The band [Hz].
    worst : float
        The largest relative error among the samples.
    worst_at_hz : float
        Where it was met [Hz].
    samples : int
        How many frequencies were looked at.
    is_rigorous : bool
        Whether ``worst`` bounds the error between the samples too.
    """

    low_hz: float
    high_hz: float
    worst: float
    worst_at_hz: float
    samples: int
    is_rigorous: bool = False


@dataclass(frozen=True, eq=False)
class ErrorScan:
    """Errors at frequencies.

    Notes
    -----
    The arrays are read-only.
    """

    # frequency_hz and error: shape (n,): Increasing frequencies [Hz], and the relative error at each.
    frequency_hz: npt.NDArray[np.float64]
    error: npt.NDArray[np.float64]
    at: Callable[[float], float]  # the error at a frequency [Hz]

    def __post_init__(self) -> None:
        self.frequency_hz.setflags(write=False)
        self.error.setflags(write=False)

    @property
    def is_rigorous(self) -> bool:
        """False: between the samples nothing is proved."""
        return False

    @property
    def low_hz(self) -> float:
        """The lowest frequency sampled [Hz]."""
        return float(self.frequency_hz[0])

    @property
    def high_hz(self) -> float:
        """The highest frequency sampled [Hz]."""
        return float(self.frequency_hz[-1])

    def within(self, low_hz: float, high_hz: float) -> BandError:
        """Return the largest error met in a band inside the frequencies sampled."""
        inside = (self.frequency_hz >= low_hz) & (self.frequency_hz <= high_hz)
        frequencies = np.concatenate(([low_hz], self.frequency_hz[inside], [high_hz]))
        errors = np.concatenate(([self.at(low_hz)], self.error[inside], [self.at(high_hz)]))
        i = int(np.argmax(errors))
        return BandError(low_hz, high_hz, float(errors[i]), float(frequencies[i]), len(errors))

    def valid_to(self, tolerance: float) -> float:
        """Return the frequency [Hz] up to which no sample exceeds the tolerance.

        It lies between the last good and the first bad sample, found by bisection; 0 when the first is bad,
        :attr:`high_hz` when none is.
        """
        bad = np.flatnonzero(~(self.error <= tolerance))
        if not bad.size:
            return self.high_hz
        if bad[0] == 0:
            return 0.0
        good, wrong = (float(self.frequency_hz[bad[0] - k]) for k in (1, 0))
        for _ in range(BISECTIONS):
            middle = (good + wrong) / 2
            if not good < middle < wrong:
                break
            good, wrong = (middle, wrong) if self.at(middle) <= tolerance else (good, middle)
        return good


def scan_error(
    bound: BoundTransferFunction,
    approximation: Callable[[complex], complex],
    roots: PoleZeroMap,
    low_hz: float,
    high_hz: float,
) -> ErrorScan:
    r"""Sample the error of an approximation in a band [Hz], densely about the poles and zeros there.

    Examples
    --------
    >>> from symflex import pipeline
    >>> model = pipeline.loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/(s + 1)"')
    >>> bound = pipeline.derive_bound(model, [("y", "u")])[0]
    >>> scan = scan_error(bound, lambda s: 1 + 0j, pipeline.roots(bound), 0.001, 1.0)
    >>> round(2 * np.pi * scan.valid_to(0.01), 6)  # |1 - 1/(1 + j omega)| (1 + omega^2)^(1/2) = omega
    0.01
    """
    zeros = np.array([complex(root.enclosure().mid()) for root in roots.zeros if not root.is_zero])
    on_axis = np.array(
        [float(root.im.mid()) for root in roots.poles if root.on_imaginary_axis and root.im > 0]
    )

    def error_at(frequency_hz: float) -> float:
        omega = 2 * np.pi * frequency_hz
        near = on_axis[np.abs(on_axis - omega) < AXIS_GAP * on_axis]
        s = 1j * (near[0] * (1 - AXIS_GAP) if near.size else omega)
        exact = bound(s)
        difference = abs(approximation(s) - exact)
        if difference == 0:
            return 0.0
        gaps = np.maximum(np.abs(s - zeros), np.finfo(float).tiny) / np.abs(zeros)
        filled = abs(exact) * float(np.prod(np.maximum(1.0, DIP / gaps)))
        return difference / filled if filled else float("inf")

    omega = adaptive_grid(bound, low_hz, high_hz, POINTS, roots)
    frequencies = omega / (2 * np.pi)
    errors = np.array([error_at(f) for f in frequencies.tolist()])
    return ErrorScan(frequencies, errors, error_at)
