"""Names of modes along a sweep: which root at one point is which at the next.

    point    roots [rad/s]       names     how
      1      1.00 j   1.30 j     1   2     START
      2      1.12 j   1.18 j     1   2     DOUBTFUL: the paths come closer than what was foretold is right
      3      1.06 j   1.24 j     2   1     DOUBTFUL: each went on along its line, and they crossed

Every point but one has a predecessor next to it in the design, whose names it takes over. Where the
functions at both are similar, roots correspond one to one, exactly. Elsewhere it is foretold where each root
goes: along the line through the last two points, by one factor with all others, or nowhere. Distances are
measured in ln(s), so that all frequencies count alike; the assignment whose distances add up to the least
gives the names. Where the paths of two roots cross, or come closer to each other than what was foretold is
right, the step is divided, and where doubt remains the result says so. Roots are points of the closed upper
half-plane: a pair that meets on the real axis becomes two real roots, of which one keeps the name.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from math import log

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment
from scipy.spatial import cKDTree

from symflex.sweep.design import Axis, Design, number

Doubles = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]
Between = Callable[[int, int, int], Sequence[Complexes] | None]
"""A function from two points and a number of pieces to the roots where pieces meet, or ``None``."""
Integers = npt.NDArray[np.int64]

CLEAR = 2.0  # distinct paths stay further apart than so many times the errors of what was foretold
LINE, FACTOR = 0.25, 0.5  # foretold along a line, or by a factor: trusted up to these shares of a move
FAR = 1.5  # a root further in ln(s) from where any was foretold has a name of its own
MEETING = 1e-9  # closer than this in ln(s), paths meet
NEIGHBOURS = 32  # nearest draws that are looked through for one closer to the middle, before all are
AT_ONCE = 1 << 18  # pairs of roots that are compared in one array
PIECES = (4, 16)  # into how many a step is divided on which names are in doubt


class NameOrigin(IntEnum):
    """How a root got its name.

    ``START``: here names begin, in order of natural frequency. ``SIMILAR``: from the predecessor, whose roots
    are the same but for one factor. ``CLEAR``: distinguished from all others. ``DOUBTFUL``: its path
    comes close to another's or crosses it, or the step is too long. ``REAL_AXIS``: a pair became two real
    roots or the reverse. ``APPEARS``: no root of the predecessor is left for it.
    """

    ABSENT = 0
    START = 1
    SIMILAR = 2
    CLEAR = 3
    DOUBTFUL = 4
    REAL_AXIS = 5
    APPEARS = 6


@dataclass(frozen=True)
class Names:
    """The names of roots."""

    mode: Integers  # shape (points, roots): Which mode, from 0; -1 where there is no root
    link: npt.NDArray[np.int8]  # shape (points, roots): A :class:`NameOrigin` each
    modes: int  # how many names there are


@dataclass(frozen=True)
class Predecessors:
    """In which order points get names, and from whom."""

    order: tuple[int, ...]  # all points; predecessors come first
    before: tuple[int, ...]  # of every point its predecessor; -1 for the first
    # Of every point the one before its predecessor on the same axis; -1 where there is none.
    earlier: tuple[int, ...]
    ratio: tuple[float, ...]  # the step to every point over the step before it


def predecessors(design: Design) -> Predecessors:
    """Return the predecessors in a design.

    In a grid that is the neighbour towards the first value of the last axis that is not there yet. Draws are
    reached from the one in the middle outwards, each from the nearest that is closer to the middle.
    """
    draws = max(design.draws, 1)
    order, nearest = _outwards(design) if design.draws else ((0,), (-1,))
    middle = order[0]
    sizes = [len(axis.values) for axis in design.axes]
    before, ordered = [0] * design.count, []
    earlier, ratio = [-1] * design.count, [1.0] * design.count
    scales = [_scale(axis) for axis in design.axes]
    for cell in range(design.count // draws):
        neighbour = _neighbour(cell, sizes)
        for draw in order:
            i = cell * draws + draw
            ordered.append(i)
            if draw != middle:
                before[i] = cell * draws + nearest[draw]
            else:
                before[i] = -1 if neighbour is None else neighbour[0] * draws + draw
                if neighbour is not None and neighbour[1] >= 0:
                    earlier[i] = neighbour[1] * draws + draw
                    places = scales[neighbour[2]][neighbour[3] - 2 : neighbour[3] + 1]
                    ratio[i] = (places[2] - places[1]) / (places[1] - places[0] or 1.0)
    return Predecessors(tuple(ordered), tuple(before), tuple(earlier), tuple(ratio))


def _neighbour(cell: int, sizes: list[int]) -> tuple[int, int, int, int] | None:
    """Return the two grid points before one, along the last axis on which it is not the first.

    Behind them that axis, and the place there; -1 where there is no second.
    """
    stride, rest = 1, cell
    for axis in reversed(range(len(sizes))):
        rest, place = divmod(rest, sizes[axis])
        if place:
            return cell - stride, cell - 2 * stride if place > 1 else -1, axis, place
        stride *= sizes[axis]
    return None


def _scale(axis: Axis) -> list[float]:
    """Return where the values of an axis stand: by their logarithms where they are positive."""
    values = [number(value) for value in axis.values]
    return [log(value) for value in values] if min(values) > 0 else values


def _outwards(design: Design) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return the draws from the middle outwards, and of each the nearest of those before it."""
    places = np.array(design.shares).T
    distance = np.sum((places - 0.5) ** 2, axis=1)
    order = np.argsort(distance, kind="stable")
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    count = min(NEIGHBOURS, len(order))
    _, near = cKDTree(places).query(places, k=list(range(1, count + 1)))
    nearest = np.full(len(order), -1)
    for i in range(len(order)):
        closer = near[i][rank[near[i]] < rank[i]]
        if closer.size:
            nearest[i] = closer[0]
        elif rank[i]:
            earlier = order[: rank[i]]
            nearest[i] = earlier[np.argmin(np.sum((places[earlier] - places[i]) ** 2, axis=1))]
    return tuple(order.tolist()), tuple(nearest.tolist())


def follow(s: Complexes, family: Integers, steps: Predecessors, between: Between | None = None) -> Names:
    """Name the roots of all points.

    ``s`` (points, roots) lie in the closed upper half-plane and not at 0, by natural frequency; NaN stands
    behind the last of a point. ``family`` is equal and not 0 for points whose roots are the same but for one
    factor, in the same order. ``steps`` is the way through the design; ``between`` is asked where names are
    in doubt.
    """
    count = np.sum(~np.isnan(s.real), axis=1)
    mode = np.full(s.shape, -1, np.int64)
    link = np.zeros(s.shape, np.int8)
    logarithms = np.log(s)
    # Where every name was seen last on the way to a point; NaN for one not met on it.
    seen: dict[int, Complexes] = {}
    needed = Counter((*steps.before, *steps.earlier))
    keeps_order = _in_order(logarithms, count, steps)
    modes = 0
    for i in steps.order:
        n, parent = int(count[i]), steps.before[i]
        own = logarithms[i, :n]
        if parent < 0:
            names, links = np.arange(n), np.full(n, NameOrigin.START, np.int8)
            last = np.full(n, complex(np.nan, np.nan))
        else:
            last = seen[parent]
            old = mode[parent, : count[parent]]
            if family[i] and family[i] == family[parent] and n == count[parent]:
                names, links = old.copy(), np.full(n, NameOrigin.SIMILAR, np.int8)
            elif keeps_order[i] and (steps.earlier[i] < 0 or np.array_equal(old, mode[steps.earlier[i], :n])):
                names, links = old.copy(), np.full(n, NameOrigin.CLEAR, np.int8)
            else:
                step = _steps_before(seen, steps, i, old)
                here = logarithms[parent, : len(old)]
                names, links = _continued(here, old, last, own, step, modes)
                if between is not None and NameOrigin.DOUBTFUL in links:
                    names, links = _divided(between, (parent, i), here, old, own) or (names, links)
        modes = max(modes, int(names.max(initial=-1)) + 1)
        mode[i, :n], link[i, :n] = names, links
        places = np.full(modes, complex(np.nan, np.nan))
        places[: len(last)] = last
        places[names] = own
        seen[i] = places
        for one in (steps.before[i], steps.earlier[i]):
            needed[one] -= 1
            if not needed[one]:
                seen.pop(one, None)
    return Names(mode, link, modes)


def _in_order(logarithms: Complexes, count: Integers, steps: Predecessors) -> npt.NDArray[np.bool_]:
    """Return at which points every root continues the one in its place, if it did so at the predecessor.

    This is what :func:`_continued` says wherever nothing is in doubt, for all points at once.
    """
    order, before, earlier = (np.array(each) for each in (steps.order, steps.before, steps.earlier))
    alike = (before >= 0) & (count > 0) & (count == count[before])
    alike &= (earlier < 0) | (count == count[earlier])
    keeps = np.zeros(len(order), np.bool_)
    for n in np.unique(count[alike]):
        places = np.nonzero(alike & (count == n))[0]
        for some in np.array_split(places, -(-len(places) * n**2 // AT_ONCE)):
            now, here = logarithms[some, :n], logarithms[before[some], :n]
            step = (here - logarithms[earlier[some], :n]) * np.array(steps.ratio)[some, None]
            step[earlier[some] < 0] = 0.0
            factor = np.median((now - here).real, axis=1)[:, None]
            close = _closest(here, now) - MEETING
            close[:, range(n), range(n)] = np.inf
            is_clear = np.zeros(len(some), np.bool_)
            is_straight = np.all(_is_real(here) == _is_real(now), axis=1)
            for foretold, least in ((here + step, LINE), (here, 0.0), (here + factor, FACTOR)):
                cost = np.abs(foretold[:, :, None] - now[:, None, :])
                own = cost[:, range(n), range(n)]
                cost[:, range(n), range(n)] = np.inf
                error = np.maximum(own, least * np.abs(now - here))
                doubtful = close <= CLEAR * (error[:, :, None] + error[:, None, :])
                is_clear |= ~np.any(doubtful, axis=(1, 2))
                is_straight &= np.all(own < np.min(cost, axis=2), axis=1)
            keeps[some] = is_clear & is_straight
    return keeps


def _steps_before(seen: dict[int, Complexes], steps: Predecessors, i: int, old: Integers) -> Complexes | None:
    """Return how far each root of the predecessor would move on; 0 for one that is new there."""
    if steps.earlier[i] < 0:
        return None
    here, there = seen[steps.before[i]], seen[steps.earlier[i]]
    change = np.zeros(len(here), np.complex128)
    change[: len(there)] = here[: len(there)] - there
    return np.asarray(np.nan_to_num(change[old], nan=0.0) * steps.ratio[i], np.complex128)


def _divided(
    between: Between, ends: tuple[int, int], before: Complexes, old: Integers, own: Complexes
) -> tuple[Integers, npt.NDArray[np.int8]] | None:
    """Return names and links by way of points in between, ``None`` if roots come or go on the way."""
    result = None
    for pieces in PIECES:
        halfway = between(*ends, pieces)
        if halfway is None:
            return result
        here, names = before, old
        doubtful: set[int] = set()
        step: Complexes | None = None
        for there in (*(np.log(s) for s in halfway), own):
            if len(there) != len(here):
                break
            # All roots go on: none is missing, and none is new.
            now, links = _continued(here, names, here[:0], there, step, 0)
            if not np.isin(links, (NameOrigin.CLEAR, NameOrigin.DOUBTFUL)).all():
                break
            doubtful.update(now[links == NameOrigin.DOUBTFUL].tolist())
            places = {int(name): j for j, name in enumerate(names)}
            step = there - here[[places[int(name)] for name in now]]
            here, names = there, now
        else:
            sure = [NameOrigin.DOUBTFUL if name in doubtful else NameOrigin.CLEAR for name in names.tolist()]
            result = names, np.array(sure, np.int8)
            if not doubtful:
                break
    return result


def _continued(
    before: Complexes, old: Integers, last: Complexes, now: Complexes, step: Complexes | None, modes: int
) -> tuple[Integers, npt.NDArray[np.int8]]:
    """Return names and links of roots, from those of the predecessor."""
    names = np.full(len(now), -1, np.int64)
    links = np.full(len(now), NameOrigin.APPEARS, np.int8)
    foretold = [(before, 0.0)] if step is None else [(before + step, LINE), (before, 0.0)]
    if len(before) == len(now) and len(now):
        # All frequencies may have moved by one factor.
        foretold.append((before + np.median((now - before).real), FACTOR))
    best = min((_assigned(before, *place, now) for place in foretold), key=lambda assignment: assignment[:2])
    were_real, are_real = _is_real(before), _is_real(now)
    for (row, column), is_clear in zip(best[2], best[3], strict=True):
        met = were_real[row] != are_real[column]
        if abs(now[column] - before[row]) > FAR and (met or not is_clear):
            continue
        names[column] = old[row]
        links[column] = NameOrigin.REAL_AXIS if met else NameOrigin.CLEAR if is_clear else NameOrigin.DOUBTFUL
    left = np.nonzero(names < 0)[0]
    sleeping = np.array([k for k in range(len(last)) if k not in set(old.tolist()) and not np.isnan(last[k])])
    if left.size and sleeping.size:
        apart = _distances(last[sleeping], now[left])
        rows, columns = linear_sum_assignment(apart)
        near = apart[rows, columns] <= FAR
        names[left[columns[near]]] = sleeping[rows[near]]
        left = np.nonzero(names < 0)[0]
    names[left] = modes + np.arange(len(left))
    return names, links


def _assigned(
    before: Complexes, foretold: Complexes, least: float, now: Complexes
) -> tuple[int, float, list[tuple[int, int]], list[bool]]:
    """Return how many are in doubt, the sum of distances, the pairs, and which of them are clear."""
    if not len(before) or not len(now):
        return 0, 0.0, [], []
    cost = _distances(foretold, now)
    rows, columns = linear_sum_assignment(cost)
    error = np.maximum(cost[rows, columns], least * np.abs(now[columns] - before[rows]))
    apart = _closest(before[rows], now[columns])
    np.fill_diagonal(apart, np.inf)
    doubtful = np.any(apart <= CLEAR * (error[:, None] + error[None, :]) + MEETING, axis=1)
    pairs = [(int(r), int(c)) for r, c in zip(rows, columns, strict=True)]
    return int(np.sum(doubtful)), float(cost[rows, columns].sum()), pairs, (~doubtful).tolist()


def _closest(start: Complexes, end: Complexes) -> Doubles:
    """Return how close every two paths come that run straight from one point to another, at one time.

    The last axis counts paths; those before it, if any, are points of the sweep.
    """
    first = start[..., :, None] - start[..., None, :]
    change = end[..., :, None] - end[..., None, :] - first
    size = np.abs(change) ** 2
    time = np.divide(-(first * change.conj()).real, size, out=np.zeros(size.shape), where=size > 0)
    return np.asarray(np.abs(first + np.clip(time, 0, 1) * change), np.float64)


def _distances(a: Complexes, b: Complexes) -> Doubles:
    return np.abs(a[:, None] - b[None, :])


def _is_real(logarithms: Complexes) -> npt.NDArray[np.bool_]:
    return np.isin(np.abs(logarithms.imag), (0.0, np.pi))
