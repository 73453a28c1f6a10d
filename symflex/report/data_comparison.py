"""A measured response beside a transfer function of the same name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from symflex.analysis.response import respond

if TYPE_CHECKING:
    import numpy.typing as npt

    from symflex.data.measurement import MeasuredResponse
    from symflex.transfer import BoundTransferFunction


@dataclass(frozen=True, eq=False)
class DataComparison:
    """What a model says on the lines of a measurement."""

    measured: MeasuredResponse  # with n lines
    model: npt.NDArray[np.complex128]  # shape (n,): The transfer function there
    unit: str  # its unit
    # decibels and degrees: root mean squares of the differences of magnitude and phase over the lines, all
    # alike.
    decibels: float
    degrees: float


def compared(measured: MeasuredResponse, bound: BoundTransferFunction) -> DataComparison:
    """Return a comparison with the values of the data as they stand, windows and sensors included."""
    model = np.asarray(respond(bound, measured.omega).values, np.complex128)
    unit = bound.source.unit
    return DataComparison(measured, model, unit, measured.misfit_db(model), measured.misfit_degrees(model))
