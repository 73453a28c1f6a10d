"""One input shaper for several modes at once: fewer impulses, and sooner over, than their shapers in a row.

Input: proved poles p of m modes. Output: impulses a at times t, enclosed. With g(p) = sum a exp(-p t),

    sum a = 1  and  zv    g(p) = 0              for every p
                    zvd   g(p) = 0, g'(p) = 0

with m + 1 impulses, 2 m + 1 for zvd: as many unknowns as equations, as the first impulse stands at 0. Where
these are no shorter, with more of them: some unknowns are kept then. Two modes at 1 and 2.3 Hz take 3
impulses in 0.61 s where their own zv shapers in a row take 4 in 0.72 s.

Where the impulses stand is guessed on a fine grid: the shortest one that holds positive amplitudes with these
sums, a linear program. An impulse takes two points of the grid, which are merged. Newton's method then finds
the solution beside it, and Krawczyk's operator proves that there is one; that none is shorter is not proved.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import inf
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from flint import acb, acb_series, arb, arb_mat

from symflex.budget import spend

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

T = TypeVar("T")

FINENESS = 24
"""Points of the grid in half a period of the quickest mode."""
FEWEST, MOST = 300, 6000
"""Points of the grid."""
NEXT = 2.5
"""Points of the grid between which an impulse may lie: two, or three where it is a little too long."""
SMALL = 1e-9
"""Amplitude that a linear program means as zero: its tolerances are 1e-7 of rows that are of order 1."""
JOINT_ORDERS = {"zv": 1, "zvd": 2}
"""Derivatives that vanish at every pole, by the kinds that are made for all modes together."""
STEPS = 12
"""Of Newton's method: the guess is off by a point of the grid, and digits double in the end."""


def joint_impulses(
    poles: Sequence[acb], kind: str, longest: float, bits: int
) -> list[tuple[arb, arb]] | None:
    """Return times [s] and amplitudes that are proved; None where none was found that is short enough.

    ``longest`` [s] is a duration in which it is known to be possible, and ``bits`` the precision at hand.

    Examples
    --------
    >>> found = joint_impulses([acb(0, 3)], "zv", 2.0, 53)
    >>> [(round(float(t), 6), round(float(a), 6)) for t, a in found]
    [(0.0, 0.5), (1.047198, 0.5)]
    """
    # In its own unit of time what is found does not depend on how quick the modes are.
    scaled = tuple(p * longest for p in poles)
    orders = JOINT_ORDERS[kind]
    guess, step = _guess(np.array([complex(p.mid()) for p in scaled]), orders)
    if not guess:
        return None
    merged = (_merged(guess, orders * len(scaled) + 1, gap * step) for gap in (inf, NEXT))
    for impulses in dict.fromkeys(merged):
        conditions = _Conditions(scaled, orders, len(impulses))
        begun = [arb(x) for x in (*(a for _, a in impulses), *(t for t, _ in impulses[1:]))]
        solved = _solved(conditions, begun, bits)
        found = None if solved is None else _proved(conditions, solved, bits)
        if found is not None and found[-1][0] < 1:
            return [(t * longest, a) for t, a in found]
    return None


@dataclass(frozen=True)
class _Conditions:
    """What a shaper has to fulfil, in as many unknowns: amplitudes, and times but the first."""

    poles: tuple[acb, ...]
    orders: int  # derivatives that vanish at each
    count: int  # of impulses

    def impulses(self, unknowns: Sequence[T], first: T) -> tuple[Sequence[T], Sequence[T]]:
        """Return times, the first of which is given, and amplitudes."""
        return [first, *unknowns[self.count : 2 * self.count - 1]], unknowns[: self.count]

    def lacks(self, unknowns: Sequence[acb_series]) -> list[acb_series]:
        """Return what has to vanish: a real one, and then both parts of complex ones."""
        times, sizes = self.impulses(unknowns, acb_series([acb(0)]))

        def swing(pole: acb, order: int) -> acb_series:
            # exp(w) is the motion that an impulse leaves at the time of the last one.
            exponents = [pole.real * times[-1] - t * pole for t in times]
            parts = (a * w.exp() * w**order for a, w in zip(sizes, exponents, strict=True))
            return sum(parts, acb_series([acb(0)]))

        swings = [swing(pole, order) for pole in self.poles for order in range(self.orders)]
        return [sum(sizes, acb_series([acb(-1)])), *swings]

    def evaluated(self, unknowns: Sequence[arb]) -> tuple[list[arb], list[list[arb]]]:
        """Return what has to vanish, and its derivatives."""
        columns = []
        for k in range(len(unknowns)):
            duals = [acb_series([acb(x), acb(int(i == k))], prec=2) for i, x in enumerate(unknowns)]
            whole, *rest = self.lacks(duals)
            parts = [[whole[i].real, *(p for c in rest for p in (c[i].real, c[i].imag))] for i in (0, 1)]
            columns.append(parts[1])
        return parts[0], [list(row) for row in zip(*columns, strict=True)]


def _guess(poles: npt.NDArray[np.complex128], orders: int) -> tuple[list[tuple[float, float]], float]:
    """Return times and amplitudes of about the shortest shaper on a grid, and its step; empty without one."""
    from scipy.optimize import linprog  # takes 0.2 s, and few shapers are joint

    quickest = float(np.max(poles.imag))
    count = int(np.clip(FINENESS * quickest / np.pi, FEWEST, MOST))
    times = np.linspace(0, 1 + 1 / FINENESS, count)

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
        return [], 0.0
    while high - low > 1:
        middle = (low + high) // 2
        found = amplitudes(middle) if middle > 1 else None
        if found is None:
            low = middle
        else:
            high, best = middle, found
    held = [(float(times[i]), float(best[i])) for i in np.flatnonzero(best > SMALL).tolist()]
    return held, float(times[1])


def _merged(guess: Sequence[tuple[float, float]], fewest: int, gap: float) -> tuple[tuple[float, float], ...]:
    """Return impulses of which those that are closer than a gap are one, as long as they are not too few."""
    held = list(guess)
    while len(held) > fewest:
        # A grid that is a little too long has room to part an impulse in two.
        i = min(range(len(held) - 1), key=lambda i: held[i + 1][0] - held[i][0])
        (t, a), (u, b) = held[i], held[i + 1]
        if u - t > gap:
            break
        held[i : i + 2] = [((a * t + b * u) / (a + b), a + b)]
    return tuple(held)


def _solved(conditions: _Conditions, unknowns: Sequence[arb], bits: int) -> list[arb] | None:
    """Return the middle of a solution, by Newton's method; None where it does not end at one."""
    for _ in range(STEPS):
        spend()
        step = _newton_step(conditions, unknowns)
        if step is None:
            return None
        unknowns = [(x - d).mid() for x, d in zip(unknowns, step, strict=True)]
        # Digits double, so this step was the last.
        if all(abs(d) <= abs(x) * arb(2) ** -(bits // 2) for x, d in zip(unknowns, step, strict=True)):
            return unknowns
    return None


def _newton_step(conditions: _Conditions, unknowns: Sequence[arb]) -> list[arb] | None:
    """Return the shortest step that leads to a solution of the linear equations."""
    values, slopes = conditions.evaluated(unknowns)
    middle = arb_mat([[x.mid() for x in row] for row in slopes])
    across = middle.transpose()
    try:
        step = across * (middle * across).solve(arb_mat([[x.mid()] for x in values]))
    except ZeroDivisionError:
        return None
    found = [step[i, 0].mid() for i in range(len(unknowns))]
    return found if all(x.is_finite() for x in found) else None


def _proved(conditions: _Conditions, middle: Sequence[arb], bits: int) -> list[tuple[arb, arb]] | None:
    """Return the solution near a point with what Krawczyk's operator proves of it.

    Where there are more unknowns than equations, those by which least is moved stay where they are.
    """
    from scipy.linalg import qr  # takes 0.1 s, and few shapers are joint

    values, slopes = conditions.evaluated(middle)
    size = len(values)
    _, order = qr(np.array([[float(x) for x in row] for row in slopes]), mode="r", pivoting=True)
    moving = order[:size].tolist()
    try:
        inverse = arb_mat([[row[j].mid() for j in moving] for row in slopes]).inv()
    except ZeroDivisionError:
        return None
    inverse = arb_mat([[inverse[i, j].mid() for j in range(size)] for i in range(size)])
    moved = inverse * arb_mat([[x] for x in values])
    off, box, found = [], list(middle), list(middle)
    for i, j in enumerate(moving):
        off.append(arb(0, (2 * moved[i, 0].abs_upper() + abs(middle[j]) * arb(2) ** -(bits // 2)).upper()))
        box[j] = middle[j] + off[i]
    _, spread = conditions.evaluated(box)
    product = inverse * arb_mat([[row[j] for j in moving] for row in spread])
    for i, j in enumerate(moving):
        rest = sum(((arb(int(i == k)) - product[i, k]) * off[k] for k in range(size)), arb(0))
        found[j] = middle[j] - moved[i, 0] + rest
        if not box[j].contains_interior(found[j]):
            return None
    times, sizes = conditions.impulses(found, arb(0))
    is_shaper = all(t < u for t, u in pairwise(times)) and all(a > 0 for a in sizes)
    return list(zip(times, sizes, strict=True)) if is_shaper else None
