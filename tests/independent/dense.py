"""Dense linear systems solved directly, at one complex s, in extended precision where the machine has it."""

from __future__ import annotations

import numpy as np


def solve(matrix: np.ndarray, right_side: np.ndarray) -> np.ndarray:
    """Solve ``matrix @ x = right_side`` by elimination with row scaling and partial pivoting.

    numpy's own solver stops at double precision; here the working precision is ``clongdouble``, so that
    the reference is better than the double-precision code it judges.

    Parameters
    ----------
    matrix : ndarray, shape (n, n)
    right_side : ndarray, shape (n,)

    Returns
    -------
    ndarray, shape (n,), clongdouble

    Raises
    ------
    numpy.linalg.LinAlgError
        When a pivot vanishes to working precision.

    Examples
    --------
    >>> solve(np.array([[0.0, 2.0], [1.0, 1.0]]), np.array([2.0, 3.0])).real.astype(float)
    array([2., 1.])
    """
    a = np.array(matrix, dtype=np.clongdouble)
    b = np.array(right_side, dtype=np.clongdouble)
    n = len(b)
    if n == 0:
        return b
    scale = np.abs(a).max(axis=1)
    if not scale.all():
        message = "a row is zero"
        raise np.linalg.LinAlgError(message)
    a, b = a / scale[:, None], b / scale
    for i in range(n):
        pivot = i + int(np.argmax(np.abs(a[i:, i])))
        if abs(a[pivot, i]) < 1e-14:
            message = f"pivot {i} of {n} vanishes"
            raise np.linalg.LinAlgError(message)
        if pivot != i:
            a[[i, pivot]], b[[i, pivot]] = a[[pivot, i]], b[[pivot, i]]
        factors = a[i + 1 :, i] / a[i, i]
        a[i + 1 :, i:] -= factors[:, None] * a[i, i:]
        b[i + 1 :] -= factors * b[i]
    x = np.zeros(n, dtype=np.clongdouble)
    for i in range(n - 1, -1, -1):
        x[i] = (b[i] - a[i, i + 1 :] @ x[i + 1 :]) / a[i, i]
    return x
