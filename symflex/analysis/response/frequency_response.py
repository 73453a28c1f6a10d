"""A frequency response: values of a transfer function on the imaginary axis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """Values of a transfer function at s = j omega.

    Parameters
    ----------
    tf : str
        ``"OUT/IN"``.
    omega : array of float, shape (n,)
        Angular frequencies [rad/s].
    values : array of complex, shape (n,)
        In ``unit``; ``inf + nan*1j`` at a pole.
    quantity, unit : str
        ``receptance``, ``mobility``, ...; SI unit, empty when unknown.
    turns : array of int, shape (n,), optional
        Whole turns between the principal value of the phase and the phase, which
        :func:`~symflex.analysis.response.respond` knows from the poles and zeros. Without them, as for
        measured values, :attr:`phase` is unwrapped
        from point to point, which is right only on a grid fine enough.

    Notes
    -----
    The arrays are copied and read-only.

    Examples
    --------
    >>> response = FrequencyResponse("x/F", [1.0, 10.0], [1.0, -0.01], "receptance", "m/N")
    >>> response.magnitude_db.tolist()
    [0.0, -40.0]
    """

    tf: str
    omega: npt.NDArray[np.float64]
    values: npt.NDArray[np.complex128]
    quantity: str
    unit: str
    turns: npt.NDArray[np.int64] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "omega", _frozen(np.array(self.omega, dtype=np.float64)))
        object.__setattr__(self, "values", _frozen(np.array(self.values, dtype=np.complex128)))
        if self.turns is not None:
            object.__setattr__(self, "turns", _frozen(np.array(self.turns, dtype=np.int64)))
        shapes = {a.shape for a in (self.omega, self.values, self.turns) if a is not None}
        if self.omega.ndim != 1 or len(shapes) != 1:
            message = f"a frequency response needs one-dimensional arrays of one length, not {sorted(shapes)}"
            raise ValueError(message)

    @property
    def frequency_hz(self) -> npt.NDArray[np.float64]:
        """``omega / (2 pi)`` [Hz]."""
        return self.omega / (2 * np.pi)

    @property
    def magnitude(self) -> npt.NDArray[np.float64]:
        """Absolute values, in ``unit``."""
        return np.abs(self.values)

    @property
    def magnitude_db(self) -> npt.NDArray[np.float64]:
        """``20 log10`` of the magnitude, in dB relative to one ``unit``; ``-inf`` at a zero."""
        with np.errstate(divide="ignore"):
            return 20 * np.log10(self.magnitude)

    @property
    def phase(self) -> npt.NDArray[np.float64]:
        """The phase [rad], continuous in omega; NaN exactly at a pole or zero on the axis.

        A negative gain counts as a lag of pi, or a lead of pi when poles at s = 0 lag already.
        """
        defined = np.isfinite(self.values) & (self.values != 0)
        principal = np.angle(np.where(defined, self.values, 1))
        if self.turns is None:
            phase = np.full(principal.shape, np.nan)
            phase[defined] = np.unwrap(principal[defined])
            return phase
        return np.where(defined, principal + 2 * np.pi * self.turns, np.nan)


def _frozen(array: npt.NDArray[np.generic]) -> npt.NDArray[np.generic]:
    array.setflags(write=False)
    return array
