"""Guesses by the Durand-Kerner iteration of FLINT: the engine for low degrees.

Input: a real polynomial in balls. Output: one guess per root in the closed upper half plane, good to the
working precision. Its time grows with the third power of the degree.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flint import acb_poly

from symflex.roots.polynomials.discs import real_symmetric_roots

if TYPE_CHECKING:
    from flint import acb


def propose_by_durand_kerner(polynomial: acb_poly) -> tuple[acb, ...] | None:
    """Guess the roots of a real polynomial of positive degree, at the current precision.

    They are exact points with imaginary part positive or exactly zero; None when the roots do not separate.

    Examples
    --------
    >>> [int(g.imag.unique_fmpz()) for g in propose_by_durand_kerner(acb_poly([4, 0, 1]))]
    [2]
    """
    return real_symmetric_roots(acb_poly([polynomial[i].mid() for i in range(len(polynomial))]))
