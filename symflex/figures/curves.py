"""Curves in the complex plane of which a figure shows the middle."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

FARTHEST: Final = 50.0
"""Times what is shown; numbers beyond a page would overflow in what reads the figure."""


def drawable(values: npt.NDArray[np.complex128], reach: float) -> npt.NDArray[np.complex128]:
    """Return values with those far outside brought nearer, in their own directions.

    Parameters
    ----------
    values : array of complex
        A curve; infinite values become gaps.
    reach : float
        Half the width of what is shown.

    Examples
    --------
    >>> drawable(np.array([1 + 1j, 3e9j, -np.inf]), 2.0).tolist()
    [(1+1j), 100j, (nan+nanj)]
    """
    finite = np.where(np.isfinite(values), values, np.nan + 1j * np.nan)
    size = np.abs(finite)
    limit = FARTHEST * reach
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.where(size > limit, finite / size * limit, finite), np.complex128)
