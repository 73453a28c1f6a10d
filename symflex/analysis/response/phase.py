"""The phase of a rational function on the imaginary axis, known from its poles and zeros.

Input: certified roots and the principal values of the phase. Output: the whole turns that are missing.

G(j omega) = K (j omega)^n prod(1 - j omega/z) / prod(1 - j omega/p). Along omega each factor runs on a ray
from 1 that never meets the negative real axis, so the principal value of its argument is its continuous
phase. The exception, a root j b on the axis, is taken as the limit from the left half plane: beyond b a zero
gives +pi, a pole -pi.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from symflex.roots.root import exact_fraction

if TYPE_CHECKING:
    from collections.abc import Iterable

    import numpy.typing as npt

    from symflex.roots import PoleZeroMap, Root


def count_turns(
    omega: npt.NDArray[np.float64], values: npt.NDArray[np.complex128], roots: PoleZeroMap
) -> npt.NDArray[np.int64]:
    """Return how many whole turns to add to ``np.angle(values)``.

    Parameters
    ----------
    omega : array of float, shape (n,)
        [rad/s].
    values : array of complex, shape (n,)
        The transfer function at ``1j*omega``; entries that are 0 or not finite do not matter.
    roots : PoleZeroMap
        All of its poles and zeros.

    Returns
    -------
    array of int, shape (n,)

    Examples
    --------
    >>> from symflex.roots import RootProblem, find_pole_zero_map
    >>> triple = RootProblem.from_rationals([1, 3, 3, 1])  # (s + 1)^3
    >>> found = find_pole_zero_map("y/u", triple, RootProblem.from_rationals([1]))
    >>> omega = np.array([0.1, 10.0])
    >>> count_turns(omega, (1j * omega + 1) ** -3, found)
    array([ 0, -1])
    """
    integrators = sum(root.multiplicity for root in roots.poles if root.is_zero)
    differentiators = sum(root.multiplicity for root in roots.zeros if root.is_zero)
    order = differentiators - integrators
    phase = order * np.pi / 2 * np.sign(omega) + _phase_of(roots.zeros, omega) - _phase_of(roots.poles, omega)
    usable = np.isfinite(values) & (values != 0)
    principal = np.angle(np.where(usable, values, 1))
    # With K > 0 the two agree up to whole turns, with K < 0 they are half a turn apart.
    if np.sum(np.cos(phase - principal)[usable]) < 0:
        phase = phase + (np.pi if order < 0 else -np.pi) * np.where(omega < 0, -1, 1)
    return np.rint((phase - principal) / (2 * np.pi)).astype(np.int64)


def _phase_of(roots: Iterable[Root], omega: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the sum of arg(1 - j omega/root) over the roots other than 0, in the limit convention above."""
    total = np.zeros_like(omega)
    for root in roots:
        if root.is_zero:
            continue
        re = -0.0 if root.on_imaginary_axis else float(root.re.mid())
        exact = exact_fraction(root.im)
        im = float(exact)
        rest = float(exact - Fraction(im))
        # Close to the root im - omega is exact in double precision, and rest holds the digits im lost.
        total += root.multiplicity * np.arctan2(-omega * re, re * re + im * ((im - omega) + rest))
    return total
