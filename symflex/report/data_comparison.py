"""A measured response beside a transfer function of the same name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from symflex.response import respond

if TYPE_CHECKING:
    import numpy.typing as npt

    from symflex.measurement import MeasuredResponse
    from symflex.transfer import BoundTransferFunction


@dataclass(frozen=True, eq=False)
class DataComparison:
    """What a model says on the lines of a measurement.

    Parameters
    ----------
    measured : MeasuredResponse
        With n lines.
    model : array of complex, shape (n,)
        The transfer function there.
    unit : str
        Its unit.
    decibels, degrees : float
        Root mean squares of the differences of magnitude and phase over the lines, all alike.
    """

    measured: MeasuredResponse
    model: npt.NDArray[np.complex128]
    unit: str
    decibels: float
    degrees: float


def compared(measured: MeasuredResponse, bound: BoundTransferFunction) -> DataComparison:
    """Return a comparison with the values of the data as they stand, windows and sensors included."""
    model = np.asarray(respond(bound, measured.omega).values, np.complex128)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = model / measured.values
        level = 20 * np.log10(np.abs(ratio))
    return DataComparison(
        measured,
        model,
        bound.source.unit,
        float(np.sqrt(np.mean(level**2))),
        float(np.degrees(np.sqrt(np.mean(np.angle(ratio) ** 2)))),
    )
