"""One input shaper for several modes at once: fewer impulses, and sooner over, than their shapers in a row.

Input: proved poles p of m modes. Output: impulses a at times t, enclosed, that leave none of them ringing,

    sum a = 1,    sum a exp(-p t) = 0    and for zvd    sum a t exp(-p t) = 0    for every p,

with m + 1 impulses, 2 m + 1 for zvd: as many unknowns as equations, as the first impulse stands at 0. Two
modes at 1 and 2.3 Hz take 3 impulses in 0.61 s where their own shapers in a row take 4 in 0.72 s.

Where the impulses stand is guessed on a fine grid: the shortest one that holds positive amplitudes with these
sums, a linear program. An impulse takes two points of the grid, which are merged. Newton's method then finds
the solution beside it, and Krawczyk's operator proves that there is one; that none is shorter is not proved.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from flint import acb, arb, arb_mat

from symflex.budget import spend

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

FINENESS = 24
"""Points of the grid in half a period of the quickest mode."""
FEWEST, MOST = 300, 6000
"""Points of the grid."""
SMALL = 1e-9
"""Amplitude that a linear program means as zero: its tolerances are 1e-7 of rows that are of order 1."""
STEPS = 60
"""Of Newton's method: the guess is off by a point of the grid, and digits double in the end."""


def joint_impulses(
    poles: Sequence[acb], orders: int, longest: float, bits: int
) -> list[tuple[arb, arb]] | None:
    """Return times [s] and amplitudes that are proved; None where none was found that is short enough.

    ``orders`` is 1 for zv and 2 for zvd, ``longest`` [s] a duration in which it is known to be possible, and
    ``bits`` the precision at hand.

    Examples
    --------
    >>> found = joint_impulses([acb(0, 3)], 1, 2.0, 53)
    >>> [(round(float(t), 6), round(float(a), 6)) for t, a in found]
    [(0.0, 0.5), (1.047198, 0.5)]
    """
    guess = _guess(np.array([complex(p.mid()) for p in poles]), orders, longest)
    if guess is None or len(guess) != orders * len(poles) + 1:
        return None
    unknowns = [arb(x) for x in (*(a for _, a in guess), *(t for t, _ in guess[1:]))]
    for _ in range(STEPS):
        spend()
        step = _newton_step(poles, orders, unknowns)
        if step is None:
            return None
        unknowns = [(x - d).mid() for x, d in zip(unknowns, step, strict=True)]
    return _proved(poles, orders, unknowns, bits)


def _guess(
    poles: npt.NDArray[np.complex128], orders: int, longest: float
) -> list[tuple[float, float]] | None:
    """Return times and amplitudes of about the shortest shaper on a grid."""
    from scipy.optimize import linprog  # takes 0.2 s, and few shapers are joint

    quickest = float(np.max(poles.imag))
    count = int(np.clip(FINENESS * longest * quickest / np.pi, FEWEST, MOST))
    times = np.linspace(0, longest * (1 + 1 / FINENESS), count)

    def amplitudes(points: int) -> npt.NDArray[np.float64] | None:
        spend()
        t = times[:points]
        rows = [np.ones(points)]
        for p in poles:
            turned = np.exp(-p * t + p.real * t[-1])
            for order in range(orders):
                rows += [(part * (t / t[-1]) ** order) for part in (turned.real, turned.imag)]
        given = np.zeros(len(rows))
        given[0] = 1
        found = linprog(np.zeros(points), A_eq=np.array(rows), b_eq=given, method="highs-ds")
        return np.asarray(found.x) if found.status == 0 else None

    low, high = 1, count
    best = amplitudes(high)
    if best is None:
        return None
    while high - low > 1:
        middle = (low + high) // 2
        found = amplitudes(middle) if middle > 1 else None
        if found is None:
            low = middle
        else:
            high, best = middle, found
    held = [(float(times[i]), float(best[i])) for i in np.flatnonzero(best > SMALL).tolist()]
    while len(held) > orders * len(poles) + 1:
        # A grid that is a little too long has room to part an impulse in two.
        i = min(range(len(held) - 1), key=lambda i: held[i + 1][0] - held[i][0])
        (t, a), (u, b) = held[i], held[i + 1]
        held[i : i + 2] = [((a * t + b * u) / (a + b), a + b)]
    return held


def _equations(
    poles: Sequence[acb], orders: int, unknowns: Sequence[arb]
) -> tuple[list[arb], list[list[arb]]]:
    """Return what has to vanish, and its derivatives, at amplitudes and then times but the first."""
    count = (len(unknowns) + 1) // 2
    sizes, times = unknowns[:count], [arb(0), *unknowns[count:]]
    values = [sum(sizes, arb(0)) - 1]
    slopes = [[arb(1)] * count + [arb(0)] * (count - 1)]
    for pole in poles:
        turned = [(-pole * t).exp() for t in times]
        for order in range(orders):
            powers = [e * t if order else e for e, t in zip(turned, times, strict=True)]
            value = sum((a * w for a, w in zip(sizes, powers, strict=True)), acb(0))
            later = [
                a * ((e if order else acb(0)) - pole * w)
                for a, e, w in zip(sizes, turned, powers, strict=True)
            ][1:]
            values += [value.real, value.imag]
            slopes += [[x.real for x in (*powers, *later)], [x.imag for x in (*powers, *later)]]
    return values, slopes


def _newton_step(poles: Sequence[acb], orders: int, unknowns: Sequence[arb]) -> list[arb] | None:
    values, slopes = _equations(poles, orders, unknowns)
    middle = arb_mat([[x.mid() for x in row] for row in slopes])
    try:
        step = middle.solve(arb_mat([[x.mid()] for x in values]))
    except ZeroDivisionError:
        return None
    found = [step[i, 0].mid() for i in range(len(values))]
    return found if all(x.is_finite() for x in found) else None


def _proved(
    poles: Sequence[acb], orders: int, middle: Sequence[arb], bits: int
) -> list[tuple[arb, arb]] | None:
    """Return the solution near a point with what Krawczyk's operator proves of it."""
    size = len(middle)
    values, slopes = _equations(poles, orders, middle)
    try:
        inverse = arb_mat([[x.mid() for x in row] for row in slopes]).inv()
    except ZeroDivisionError:
        return None
    inverse = arb_mat([[inverse[i, j].mid() for j in range(size)] for i in range(size)])
    moved = inverse * arb_mat([[x] for x in values])
    widths = [2 * moved[i, 0].abs_upper() + abs(x) * arb(2) ** -(bits // 2) for i, x in enumerate(middle)]
    box = [x + arb(0, w.upper()) for x, w in zip(middle, widths, strict=True)]
    _, spread = _equations(poles, orders, box)
    product = inverse * arb_mat(spread)
    found = []
    for i in range(size):
        rest = sum(((arb(int(i == j)) - product[i, j]) * (box[j] - middle[j]) for j in range(size)), arb(0))
        image = middle[i] - moved[i, 0] + rest
        if not box[i].contains_interior(image):
            return None
        found.append(image)
    count = (size + 1) // 2
    sizes, times = found[:count], [arb(0), *found[count:]]
    in_order = all(t < u for t, u in pairwise(times))
    return list(zip(times, sizes, strict=True)) if in_order and all(a > 0 for a in sizes) else None
