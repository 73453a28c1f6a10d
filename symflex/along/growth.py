"""How far solutions of equations whose coefficients vary along x grow, and the steps they are followed in.

Input: a :class:`~symflex.along.system.VaryingSystem`, and a disc of u.
Output: the :class:`Leg`s that x is cut into, and the :class:`Growth` of all solutions along them, as bounds.

    y'' = u y on [0, 1] and abs(u) <= 100      states y and y'/10: each slope is at most 10 times the other
    one step, on which nothing grows by more than e^10

States are scaled so that the norm of A is about a wavenumber. As Z is analytic in x and u together, Cauchy's
estimate bounds its Taylor coefficients by how it grows on discs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import factorial, inf, isfinite, log2, prod

from flint import acb, acb_poly, arb

from symflex.along.system import MinorsAlong, Place, SingularBeginning, VaryingSystem, sequence_of
from symflex.balls import precision

Weights = tuple[arb, ...]  # powers of two by which states are scaled

BALANCINGS = 60  # rounds of balancing the states: of four in a circle each leaves half of what is off
BALANCED = 0.1  # bits by which rows and columns may differ
SHARE = 4  # the radius on which coefficients are bounded, over the length of a step
FIRST_SHARE = 6  # the same from a start where they have poles; half of it has bounded solutions
SHORTEST = 1e-5  # share of the whole below which the radius of a step means that there is a singularity
ROUNDING = 2.0**-50  # rounding of a position in doubles: a singularity at an end is met then, too
MOST_STEPS = 1000  # ten times those of a thousand modes, and more than any coefficients need
HALVINGS = 40  # halvings of an interval in which a singularity lies: it is located to six digits
LAST = 1.2  # a step may be so much longer than others if it is the last
RADII = tuple(4.0 * 0.8**k for k in range(80))  # tried about a point, in lengths of the whole, to 1e-7
BOUNDED = 4  # parts of a step on each of which coefficients are bounded: on all a quarter larger
SAMPLES = 8  # points at which the growth along x is sampled where about what it is suffices
MOST_TERMS = 1500  # of the power series about a singular start: 3 times a hanging string's 10th mode
MOST_HALVINGS = 40  # halvings of the first step from a singular start
BOUND_BITS = 64  # precision of bounds, which are added up and rounded up
BITS_OF_E = 1.4426950408889634
DIRECTIONS = (-1, 1, 1j)  # of u in which solutions may grow least: as waves, decaying, and between
HIGHEST = 1000.0  # power of two near the end of doubles
APART = 300.0  # bits by which weights differ at most: states without a common action have no ratio


class SingularCoefficientError(ValueError):
    """A coefficient is not analytic about a point of the interval, or so steep that none could tell."""

    def __init__(self, place: float, *, is_steep: bool = False) -> None:
        super().__init__(place)
        self.place = place
        self.is_steep = is_steep  # analytic as far as is known


@dataclass(frozen=True, slots=True)
class Leg:
    """A part of the interval."""

    start: arb
    end: arb
    radius: arb  # about the start, in which coefficients are bounded
    is_first: bool = False  # from a start where they have poles

    @property
    def length(self) -> arb:
        """Its length, negative where x falls."""
        return self.end - self.start


@dataclass(frozen=True, slots=True)
class Growth:
    """How large solutions are that start with 1 over the weight of a state, for abs(u) up to a reach."""

    reach: arb
    size: arb  # over the weight of a state, at most
    weights: tuple[Weights, Weights]  # at the start, and where it is

    def bits_over(self, other: Growth) -> float:
        """Return by how many bits bounds are larger than others."""
        starts, ends = zip(self.weights, other.weights, strict=True)
        rows = max(x / y for x, y in zip(*ends, strict=True))
        columns = max(y / x for x, y in zip(*starts, strict=True))
        return bits_of(self.size / other.size * rows * columns)


def bits_of(size: arb) -> float:
    """Return the logarithm of a size to base 2."""
    return float(size.log().upper()) * BITS_OF_E


def growth_along(system: VaryingSystem, largest: arb) -> float:
    """Return about by which power of e solutions grow from end to end at most, for abs(u) <= ``largest``."""
    start, end = system.ends()
    share, total = (end - start) / SAMPLES, 0.0
    for k in range(SAMPLES):
        x = (start + share * (k + 0.5)).mid()
        norm = _norm(system, acb(x), largest, _weights(system, acb(x), largest))
        total += float((norm * abs(share)).mid())
    return total


def growth_on(system: VaryingSystem, leg: Leg, reach: arb) -> Growth:
    """Return how solutions grow from the start of a leg, all around it up to its radius, if bounded."""
    square = arb(0, leg.radius)
    bounds = system.bounds(acb(leg.start + square, square), reach)
    weights = _levelled(bounds, leg.radius, system.size, ())
    size = (_norm_of(bounds, weights) * leg.radius).exp()
    if not size.is_finite():
        raise SingularCoefficientError(float(leg.start.mid()))
    return Growth(reach, size.abs_upper(), (weights, weights))


def growth_of(system: MinorsAlong, legs: Sequence[Leg], reach: arb) -> Growth:
    """Return how minors grow along all legs. States are scaled anew on every part of a leg."""
    weights, size = list[Weights](), arb(1)
    for leg in legs:
        if leg.is_first and system.whole.beginning is not None:
            begun, reached = growth_begun(system.whole.beginning, leg, reach)
            size *= reached**system.order * factorial(system.order)
            states = begun.weights[1]
            weights.append(tuple(prod((states[i] for i in rows), start=arb(1)) for rows in system.lines))
            continue
        part = leg.length / BOUNDED
        for j in range(BOUNDED):
            middle = leg.start + part * (j + 0.5)
            bounds = system.bounds(acb(middle + arb(0, (part / 2).abs_upper())), reach)
            weights.append(_levelled(bounds, abs(part), len(system.lines), weights[-1] if weights else ()))
            size *= (_norm_of(bounds, weights[-1]) * abs(part)).exp()
    for before, after in pairwise(weights):
        size *= max(x / y for x, y in zip(before, after, strict=True))
    return Growth(reach, size.abs_upper(), (weights[0], weights[-1]))


def least_growth(system: VaryingSystem, order: int, largest: arb) -> float:
    """Return by about how many bits minors of so many rows grow at least, of all u of a size."""
    import numpy as np  # what is only checked and printed needs none of it

    start, end = system.ends()
    way, totals = float((end - start).mid()), [0.0] * len(DIRECTIONS)
    for k in range(SAMPLES):
        entries = system.series((start + (end - start) * ((k + 0.5) / SAMPLES)).mid(), 1)
        for n, direction in enumerate(DIRECTIONS):
            matrix = np.zeros((system.size, system.size), dtype=complex)
            for q, coefficients in enumerate(entries):
                for place, value in coefficients.items():
                    matrix[place] += complex(acb(value[0] * largest**q).mid()) * direction**q
            if not np.all(np.isfinite(matrix)):
                return inf
            rates = np.sort(np.real(np.linalg.eigvals(matrix * way)))
            totals[n] += float(np.sum(rates[len(rates) - order :])) / SAMPLES
    return min(totals) * BITS_OF_E


def _levelled(sizes: Mapping[Place, arb], way: arb, count: int, start: Sequence[arb]) -> Weights:
    """Return weights that level the sums of rows: the largest is then near an eigenvalue (Perron 1907)."""
    rows: dict[int, list[tuple[int, float]]] = {}
    for (i, j), x in sizes.items():
        if 0 < (size := float((x * way).upper())) < inf:
            rows.setdefault(i, []).append((j, log2(size)))
    levels = [log2(float(x)) for x in start] or [0.0] * count
    for _ in range(BALANCINGS if rows else 0):
        sums = {
            i: log2(sum(2.0 ** max(-HIGHEST, min(x + levels[j] - levels[i], HIGHEST)) for j, x in row))
            for i, row in rows.items()
        }
        levels = [x + sums.get(i, 0.0) / 2 for i, x in enumerate(levels)]
        highest = max(levels)
        levels = [max(x - highest, -APART) for x in levels]
        if max(sums.values()) - min(sums.values()) < BALANCED:
            break
    return tuple(arb(2.0**x) for x in levels)


def legs_along(system: VaryingSystem, largest: arb, reach: arb, bits: int) -> list[Leg]:
    """Return the parts of the interval on each of which solutions are expanded, for abs(u) <= ``largest``."""
    begin, end = system.ends()
    first = [] if system.beginning is None else [_first_step(system.beginning, begin, end, reach, bits)]
    return first + _steps(system, first[0].end if first else begin, end, largest, bits)


def _weights(system: VaryingSystem, middle: acb, reach: arb) -> Weights:
    """Return powers of two that make rows and columns of the coefficients alike."""
    sizes = {
        place: log2(size)
        for place, x in system.bounds(middle, reach).items()
        if place[0] != place[1] and 0 < (size := float(x.upper())) < inf
    }
    return tuple(arb(2.0**x) for x in balanced(sizes, system.size, BALANCINGS, BALANCED))


def balanced(sizes: Mapping[Place, float], count: int, rounds: int, enough: float = 0) -> list[float]:
    """Return w so that rows and columns of ``sizes[i, j] + w_j - w_i`` are alike (Osborne 1960)."""
    exponents = [0.0] * count
    for _ in range(rounds):
        before = list(exponents)
        for i in range(count):
            row = [x + exponents[k] for (j, k), x in sizes.items() if j == i]
            column = [x - exponents[j] for (j, k), x in sizes.items() if k == i]
            if row and column:
                exponents[i] = (max(row) - max(column)) / 2
        if max(abs(x - y) for x, y in zip(exponents, before, strict=True)) < enough:
            break
    return exponents


def _norm(system: VaryingSystem, x: acb, reach: arb, weights: Sequence[arb]) -> arb:
    """Return a bound on the norm of the scaled coefficients on a ball of x; not finite near a singularity."""
    return _norm_of(system.bounds(x, reach), weights)


def _norm_of(sizes: Mapping[Place, arb], weights: Sequence[arb]) -> arb:
    rows = [arb(0)] * len(weights)
    for (i, j), size in sizes.items():
        rows[i] += size * weights[j] / weights[i]
    return max((row.abs_upper() if row.is_finite() else arb("inf") for row in rows), key=float)


def _steps(system: VaryingSystem, start: arb, end: arb, largest: arb, bits: int) -> list[Leg]:
    """Return steps of which each costs few terms over its length."""
    whole, at, legs = end - start, start, list[Leg]()
    while at is not end:
        if len(legs) == MOST_STEPS:
            raise SingularCoefficientError(float(at.mid()), is_steep=True)
        best: tuple[float, arb] | None = None
        weights = _weights(system, acb(at), largest)
        for share in RADII:
            radius = (abs(whole) * share).upper()
            square = arb(0, radius)
            norm = _norm(system, acb(at + square, square), largest, weights)
            growth = float((norm * radius).upper()) * BITS_OF_E
            if not isfinite(growth):
                continue
            cost = (bits + growth) / min(float(radius), SHARE * float(abs(end - at).upper()))
            if best is not None and cost > best[0]:
                break
            best = (cost, radius)
        if best is None or best[1] < abs(whole) * SHORTEST:
            raise _no_step(system, at, end, largest, weights)
        _, radius = best
        length, left = (radius / SHARE).mid(), end - at
        following = end if abs(left) <= length * LAST else (at + (length if left > 0 else -length)).mid()
        legs.append(Leg(at, following, radius))
        at = following
    return legs


def _first_step(beginning: SingularBeginning, start: arb, end: arb, reach: arb, bits: int) -> Leg:
    """Return a first step of few terms: a sixth of the coefficients' radius, a third of solutions'."""
    whole = abs(end - start)
    for k in range(MOST_HALVINGS):
        radius = (whole * FIRST_SHARE / 2**k).upper()
        length = (radius / FIRST_SHARE).mid()
        following = end if k == 0 else (start + (length if end > start else -length)).mid()
        step = Leg(start, following, radius / 2, is_first=True)
        if _begun_along(beginning, step, reach, bits) is not None:
            return step
    raise SingularCoefficientError(float(start.mid()))


def growth_begun(beginning: SingularBeginning, leg: Leg, reach: arb) -> tuple[Growth, arb]:
    """Return how finite solutions at a singular start grow on the first step, and their size at its end."""
    begun = _begun_along(beginning, leg, reach, BOUND_BITS)
    if begun is None:
        raise SingularCoefficientError(float(leg.start.mid()))
    return begun


def _begun_along(beginning: SingularBeginning, leg: Leg, reach: arb, bits: int) -> tuple[Growth, arb] | None:
    square = arb(0, leg.radius * 2)
    hull = acb(leg.start + square, square)
    weights = _weights(beginning.matrix, hull, reach)
    norm, way = _norm(beginning.matrix, hull, reach, weights), abs(leg.length)
    bound = None
    if norm < MOST_TERMS:
        bound = _bounded(beginning, leg.start, reach, weights, (norm, leg.radius, way), bits)
    if bound is None:
        return None
    scaled = tuple((w * way**d).mid() for w, d in zip(weights, beginning.powers, strict=True))
    return Growth(reach, bound[0], (scaled, scaled)), bound[1]


def _bounded(
    beginning: SingularBeginning,
    start: arb,
    reach: arb,
    weights: Weights,
    sizes: tuple[arb, arb, arb],
    bits: int,
) -> tuple[arb, arb] | None:
    """Return how large solutions are on a radius, and up to the step's end; None if terms do not fall."""
    norm, radius, way = sizes
    with precision(BOUND_BITS):
        parts = [
            [(i, j, x * weights[j] / weights[i]) for i, j, x in rates]
            for rates in _by_powers(beginning.matrix, start, MOST_TERMS, reach)
        ]
        inside = [(i, j, x) for i, j, x in parts[0] if i != j]
        # Nowhere positive itself, so its size is what k is increased by.
        diagonal = {i: x for i, j, x in parts[0] if i == j}
        sequence = sequence_of({(i, j): acb_poly([1]) for i, j, _ in inside}, len(weights))
        across = sum((x for _, _, x in inside), arb(0))
        first = [arb(0)] * len(weights)
        for i, j, x in _by_powers(beginning.values, start, 1, reach)[0]:
            first[i] += x * weights[j] / weights[i]
        column, largest, total = [first], arb(0), arb(0)
        for k in range(MOST_TERMS):
            size = sum(column[k], arb(0)).abs_upper()
            if not size.is_finite():
                return None
            largest = max(largest, size * radius**k)
            total += size * way**k
            resolvent = sum(((across / (k + 1)) ** j for j in range(len(weights))), arb(0))
            left = largest * (way / radius) ** (k + 1)
            if norm * resolvent < k + 1 and left * arb(2) ** bits < 1:
                return largest.abs_upper(), (total + 2 * left).abs_upper()
            new = [arb(0)] * len(weights)
            for p in range(1, k + 2):
                for i, j, x in parts[p] if p < MOST_TERMS else ():
                    new[i] += x * column[k + 1 - p][j]
            for i in sequence:
                new[i] += sum((x * new[j] for row, j, x in inside if row == i), arb(0))
                new[i] = (new[i] / (k + 1 + diagonal.get(i, 0))).abs_upper()
            column.append(new)
    return None


def _by_powers(system: VaryingSystem, start: arb, count: int, reach: arb) -> list[list[tuple[int, int, arb]]]:
    """Return bounds on the coefficients of every power of the way from a start, for abs(u) up to a reach."""
    powers: list[dict[Place, arb]] = [{} for _ in range(count)]
    for order, coefficients in enumerate(system.series(start, count)):
        for place, polynomial in coefficients.items():
            for p, x in enumerate(acb_poly(polynomial).coeffs()):
                if (size := abs(x).upper()) > 0:
                    powers[p][place] = powers[p].get(place, arb(0)) + size * reach**order
    return [[(*place, x) for place, x in each.items()] for each in powers]


def _no_step(
    system: VaryingSystem, at: arb, end: arb, reach: arb, weights: Sequence[arb]
) -> SingularCoefficientError:
    """Return about where the first singularity behind a point is, which steps do not come closer to."""
    low, high = at.mid(), end.mid()
    for _ in range(HALVINGS):
        middle = ((low + high) / 2).mid()
        between = acb((low + middle) / 2 + arb(0, abs(middle - low) / 2))
        finite = _norm(system, between, reach, weights).is_finite()
        low, high = (middle, high) if finite else (low, middle)
    # Balls in which a steep function is far from its middle are not finite either, but small ones are.
    closest = abs(end - at).upper() / 2 ** (HALVINGS - 2) + abs(low).upper() * ROUNDING
    around = acb(low + arb(0, closest), arb(0, closest))
    is_steep = _norm(system, around, reach, weights).is_finite()
    return SingularCoefficientError(float(low), is_steep=bool(is_steep))
