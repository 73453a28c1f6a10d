"""Poles on the imaginary axis for a gain that is no straight line in a loop with kernels.

``sum(m(K) c(j omega))`` has two real parts in two unknowns, omega and K. Boxes of both are dropped where the
sum excludes zero; others are kept where Newton's method in both proves one root in them, and cut else
(Krawczyk 1969; Moore 1966). Example: of ``(s + K exp(-s T))^2 + w^2`` two gains, pi/(2 T) -+ w, bring poles
on the axis at one frequency, where a resultant has a double root; as boxes they are apart.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

from flint import acb, arb, arb_series

from symflex.balls import bits_for_digits, precision
from symflex.budget import spend
from symflex.loops.axis import BITS, FIRST_RATIO, NARROWEST, NEWTON_STEPS, joined, pieces
from symflex.loops.loop_function import LoopFunction

Weights = Callable[[arb], Sequence[arb_series]]

DEEPEST = 50  # halvings of the range of gains
SHORT = 6  # halvings of the range of gains until its pieces tell how large functions are
MOST_BOXES = 128  # boxes of gains at one interval of frequencies
MOST_INTERVALS = 8_000  # intervals of frequencies in one search
INFLATED = 1.3  # so that a root on an edge lies inside


@dataclass(frozen=True, slots=True)
class PartsAlong:
    """The parts in the middle of an interval of frequencies, and slopes on it with their factor."""

    middle: Sequence[acb]
    slopes: Sequence[acb] = ()
    off: acb | int = 0


@dataclass(frozen=True, eq=False)
class GainTree:
    """The range of gains in halves, each with the weights of all parts, which are kept."""

    weights: Weights
    ends: tuple[arb, arb]  # exact, as a ball of wide ranges reaches beyond them
    depth: int = 0

    @cached_property
    def gain(self) -> arb:
        """A ball around the piece."""
        with precision(BITS):
            return self.ends[0].union(self.ends[1])

    @cached_property
    def values(self) -> tuple[list[arb], list[arb], list[arb]]:
        """The weights on this piece, in its middle, and their slopes on the piece."""
        with precision(BITS):
            around, centre = (self.weights(x) for x in (self.gain, self.gain.mid()))
        return [w[0] for w in around], [w[0] for w in centre], [w[1] for w in around]

    def sums(self, place: PartsAlong) -> tuple[acb, acb]:
        """Return a sum on this piece and what the gain adds to it, slopes being added up first."""
        around, centre, slope = self.values
        across = _sum(slope, place.middle) * (self.gain - self.gain.mid())
        total = _sum(centre, place.middle) + across
        return total + _sum(around, place.slopes) * place.off if place.slopes else total, across

    @cached_property
    def halves(self) -> list[GainTree]:
        """Both halves of the piece."""
        with precision(BITS):
            low, high = self.ends
            middle = ((low + high) / 2).mid()
            return [GainTree(self.weights, ends, self.depth + 1) for ends in ((low, middle), (middle, high))]

    @cached_property
    def pieces(self) -> list[GainTree]:
        """Short pieces, ascending: shorter ones where weights have no bound."""
        is_bounded = all(w.is_finite() for w in self.values[0])
        if self.depth >= (SHORT if is_bounded else DEEPEST):
            return [self]
        return [piece for half in self.halves for piece in half.pieces]


def left(pieces: Sequence[GainTree], place: PartsAlong) -> list[GainTree]:
    """Return in which pieces of pieces a sum may vanish, ascending, cut as far as that is worth it."""
    kept = list(pieces)
    while True:
        sums = [(piece, *piece.sums(place)) for piece in kept]
        alive = [each for each in sums if not each[1].is_finite() or each[1].contains(0)]
        wide = [p for p, total, across in alive if p.depth < DEEPEST and not 2 * across.rad() < total.rad()]
        if not wide or len(alive) + len(wide) > MOST_BOXES:
            return [piece for piece, *_ in alive]
        kept = [half for piece, *_ in alive for half in (piece.halves if piece in wide else [piece])]


def _sum(weights: Sequence[arb], parts: Sequence[acb]) -> acb:
    return sum((part * weight for weight, part in zip(weights, parts, strict=True)), acb(0))


@dataclass(frozen=True, slots=True)
class AxisPoints:
    """Frequencies [rad/s] and gains at which poles are on the axis."""

    proved: list[tuple[arb, arb]]  # enclosures of one point each
    undecided: list[tuple[arb, arb]]


def find_axis_points(
    function: LoopFunction, tree: GainTree, limits: tuple[float, float], digits: int
) -> AxisPoints | None:
    """Return all between two frequencies, for the gains of a tree; None where they are too many intervals."""
    pending = [(start, end, [tree]) for start, end in pieces(*limits, FIRST_RATIO)]
    found = AxisPoints([], [])
    for _ in range(MOST_INTERVALS):
        if not pending:
            return found
        spend()
        start, end, known = pending.pop()
        with precision(BITS):
            omega = (arb(start) + arb(end)) / 2 + arb(0, ((arb(end) - arb(start)) / 2).upper())
            around, centre = function.parts_around(acb(0, omega), BITS)
            off = acb(0, omega - omega.mid())
            known = left(known, PartsAlong([c for c, _ in centre], [slope for _, slope in around], off))
            gains = joined([piece.gain for piece in known])
            points = [_point(function, tree.weights, omega, gain, digits) for gain in gains]
        if None not in points:
            for point in points:
                # One that was found from the interval before is not another.
                is_met = (
                    all(x.overlaps(y) for x, y in zip(point, p, strict=True)) for p in found.proved if point
                )
                if point and not any(is_met):
                    found.proved.append(point)
        elif end - start < NARROWEST * end:
            found.undecided.extend((omega, gain) for gain in gains)
        else:
            cut = start + 0.4873 * (end - start)
            pending += [(cut, end, known), (start, cut, known)]
    return None


def _point(
    function: LoopFunction, weights: Weights, omega: arb, gain: arb, digits: int
) -> tuple[arb, arb] | tuple[()] | None:
    """Return the one point about a box, nothing where there is none, None where that is not decided."""
    box = tuple(x.mid() + arb(0, x.rad() * INFLATED) for x in (omega, gain))
    step = _step(function, weights, box, BITS)
    if step is None:
        return None
    moved = tuple(x.mid() - y for x, y in zip(box, step, strict=True))
    if not all(x.overlaps(y) for x, y in zip(box, moved, strict=True)):
        return ()
    if not all(bool(abs(y) < x.rad()) for x, y in zip(box, step, strict=True)):
        return None
    wanted = bits_for_digits(digits) + 16
    for _ in range(NEWTON_STEPS):
        known = min(x.rel_accuracy_bits() for x in moved)
        if known > wanted:
            break
        bits = min(max(BITS, 2 * known + 64), 2 * wanted + BITS)
        step = _step(function, weights, moved, bits)
        if step is None:
            break
        with precision(bits):
            new = tuple(x.intersection(x.mid() - y) for x, y in zip(moved, step, strict=True))
        if all(y.rad() > x.rad() * 0.99 for x, y in zip(moved, new, strict=True)):
            break
        moved = new
    return moved[0], moved[1]


def _step(
    function: LoopFunction, weights: Weights, box: tuple[arb, ...], bits: int
) -> tuple[arb, arb] | None:
    """Return Newton's step from the middle of a box, for all slopes on it; None where these are singular."""
    omega, gain = box
    around, centre = function.parts_around(acb(0, omega), bits)
    with precision(bits):
        wide, middle = weights(gain), weights(gain.mid())
        value = _sum([w[0] for w in middle], [c for c, _ in centre])
        by_omega = acb(0, 1) * _sum([w[0] for w in wide], [slope for _, slope in around])
        by_gain = _sum([w[1] for w in wide], [c for c, _ in around])
        determinant = by_omega.real * by_gain.imag - by_omega.imag * by_gain.real
        if not determinant.is_finite() or determinant.contains(0):
            return None
        first = value.real * by_gain.imag - value.imag * by_gain.real
        second = by_omega.real * value.imag - by_omega.imag * value.real
        return first / determinant, second / determinant
