"""Poles in the right half-plane, counted by turns of a characteristic function about a half disc.

The functions are written down from free-body diagrams; the count is the phase on a contour that is refined
until no step turns by much. Nothing of the program is used.
"""

from __future__ import annotations

import cmath
import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import expm

if TYPE_CHECKING:
    from collections.abc import Callable

Characteristic = Callable[[complex], complex] if TYPE_CHECKING else object

LARGEST_TURN = 0.4
FIRST_POINTS = 400
DEEPEST = 45


def poles_right_of_axis(chi: Characteristic, radius: float, smallest: float = 0.0) -> int:
    """Return how many zeros an entire function has with Re(s) > 0 and abs(s) < radius.

    With ``smallest``, zeros at 0 are passed by a small arc to the right.
    """
    low = max(smallest, radius * 1e-9)
    frequencies = np.concatenate([np.geomspace(low, radius, FIRST_POINTS)])
    upwards = [1j * w for w in frequencies]
    arc = [radius * cmath.exp(1j * angle) for angle in np.linspace(math.pi / 2, -math.pi / 2, FIRST_POINTS)]
    small = [low * cmath.exp(1j * angle) for angle in np.linspace(-math.pi / 2, math.pi / 2, 60)]
    turns = 0.0
    # Clockwise: up the axis, back along the large arc, up the axis from below, round 0.
    for path in (upwards, arc, [-1j * w for w in frequencies[::-1]], small):
        values = [chi(s) for s in path]
        for i in range(len(path) - 1):
            turns += _turn(chi, path[i], path[i + 1], values[i], values[i + 1], 0)
    count = -turns / (2 * math.pi)
    assert abs(count - round(count)) < 1e-3, count
    return round(count)


def _turn(chi, a: complex, b: complex, at_a: complex, at_b: complex, depth: int) -> float:
    step = cmath.phase(at_b / at_a)
    middle = (
        (a + b) / 2
        if abs(abs(a) - abs(b)) > 1e-9 * abs(a)
        else abs(a) * cmath.exp(0.5j * (cmath.phase(a) + cmath.phase(b)))
    )
    at_middle = chi(middle)
    halves = cmath.phase(at_middle / at_a), cmath.phase(at_b / at_middle)
    if max(map(abs, (step, *halves))) < LARGEST_TURN and abs(sum(halves) - step) < 1e-6:
        return step
    assert depth < DEEPEST, "a zero lies on the contour"
    return _turn(chi, a, middle, at_a, at_middle, depth + 1) + _turn(
        chi, middle, b, at_middle, at_b, depth + 1
    )


def bending_transfer(s: complex, *, EI: complex, mass: float, length: float) -> np.ndarray:
    """Return the transfer matrix of a beam for w, w', M = EI w'', V = EI w'''."""
    a = np.zeros((4, 4), complex)
    a[0, 1] = a[2, 3] = 1
    a[1, 2] = 1 / EI
    a[3, 0] = -mass * s * s
    return expm(a * length)


def axial_transfer(s: complex, *, EA: complex, mass: float, length: float) -> np.ndarray:
    """Return the transfer matrix of a rod for u and N = EA u'."""
    return expm(np.array([[0, 1 / EA], [mass * s * s, 0]], complex) * length)
