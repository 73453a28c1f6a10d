"""Poles on the imaginary axis for a gain that is no straight line in a loop with kernels.

``sum(m(K) c(j omega))`` has two real parts in two unknowns, omega and K. Boxes of both are dropped where the
sum excludes zero; others are kept where Newton's method in both proves one root in them, and cut else
(Krawczyk 1969; Moore 1966). Example: of ``(s + K exp(-s T))^2 + w^2`` two gains, pi/(2 T) -+ w, bring poles
on the axis at one frequency, where a resultant has a double root; as boxes they are apart.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from flint import acb, arb

from symflex.balls import bits_for_digits, precision
from symflex.budget import spend
from symflex.loops.axis import BITS, FIRST_RATIO, NARROWEST, NEWTON_STEPS, pieces

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from flint import arb_series

    from symflex.loops.loop import LoopFunction

    Weights = Callable[[arb], Sequence[arb_series]]

DEEPEST = 50
"""Halvings of the range of gains."""
MOST_BOXES = 128
"""Boxes of gains at one interval of frequencies."""
MOST_INTERVALS = 8_000
"""Intervals of frequencies in one search."""
INFLATED = 1.3
"""So that a root on an edge lies inside."""


@dataclass(eq=False)
class GainTree:
    """The range of gains in halves, each with the weights of all parts, which are kept."""

    weights: Weights
    gain: arb
    depth: int = 0
    _halves: list[GainTree] = field(default_factory=list)
    _values: tuple[list[arb], list[arb], list[arb]] | None = None

    @property
    def values(self) -> tuple[list[arb], list[arb], list[arb]]:
        """The weights on this piece, in its middle, and their slopes on the piece."""
        if self._values is None:
            with precision(BITS):
                around, centre = (self.weights(x) for x in (self.gain, self.gain.mid()))
            self._values = [w[0] for w in around], [w[0] for w in centre], [w[1] for w in around]
        return self._values

    def sums(self, parts: Sequence[acb]) -> tuple[acb, acb]:
        """Return a sum on this piece, by the mean value theorem where that is narrower, and in its middle."""
        around, centre, slope = (_sum(weights, parts) for weights in self.values)
        mean = centre + slope * (self.gain - self.gain.mid())
        return (mean if mean.is_finite() and mean.rad() < around.rad() else around), centre

    @property
    def halves(self) -> list[GainTree]:
        """Both halves of the piece."""
        if not self._halves:
            with precision(BITS):
                middle, radius = self.gain.mid(), self.gain.rad() / 2
                self._halves = [
                    GainTree(self.weights, middle + sign * radius + arb(0, radius), self.depth + 1)
                    for sign in (-1, 1)
                ]
        return self._halves


def left(pieces: Sequence[GainTree], parts: Sequence[acb]) -> list[GainTree]:
    """Return in which pieces of pieces a sum may vanish, ascending, cut as far as that is worth it."""
    kept = list(pieces)
    while True:
        places = [(piece, *piece.sums(parts)) for piece in kept]
        alive = [place for place in places if not place[1].is_finite() or place[1].contains(0)]
        wide = [p for p, around, centre in alive if p.depth < DEEPEST and not around.rad() < 2 * centre.rad()]
        if not wide or len(alive) + len(wide) > MOST_BOXES:
            return [piece for piece, *_ in alive]
        kept = [half for piece, *_ in alive for half in (piece.halves if piece in wide else [piece])]


def _joined(pieces: Sequence[GainTree]) -> list[arb]:
    """Return pieces of gains, those next to each other as one."""
    joined: list[arb] = []
    for gain in (piece.gain for piece in pieces):
        if joined and joined[-1].overlaps(gain):
            joined[-1] = joined[-1].union(gain)
        else:
            joined.append(gain)
    return joined


def _sum(weights: Sequence[arb], parts: Sequence[acb]) -> acb:
    return sum((part * weight for weight, part in zip(weights, parts, strict=True)), acb(0))


@dataclass(frozen=True, slots=True)
class AxisPoints:
    """Frequencies [rad/s] and gains at which poles are on the axis."""

    proved: list[tuple[arb, arb]]  # enclosures of one point each
    undecided: list[tuple[arb, arb]]

    def add(self, point: tuple[arb, arb] | None) -> None:
        """Add a point; one that was found from the interval before is not another."""
        if point is None:
            return
        for i, other in enumerate(self.proved):
            if all(x.overlaps(y) for x, y in zip(point, other, strict=True)):
                self.proved[i] = point[0].union(other[0]), point[1].union(other[1])
                return
        self.proved.append(point)


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
            around, _ = function.parts_around(acb(0, omega), BITS)
            known = left(known, [value for value, _ in around])
            gains = _joined(known)
            points = [_point(function, tree.weights, omega, gain, digits) for gain in gains]
        if None not in points:
            for point in points:
                found.add(point or None)
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
