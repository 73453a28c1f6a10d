"""Poles on the imaginary axis for a gain that is no straight line in a loop with kernels.

``sum(m(K) c(j omega))`` has two real parts in two unknowns, omega and K. Boxes of both are dropped where the
sum excludes zero; others are kept where Newton's method in both proves one root in them, and cut else
(Krawczyk 1969; Moore 1966). Example: of ``(s + K exp(-s T))^2 + w^2`` two gains, pi/(2 T) -+ w, bring poles
on the axis at one frequency, where a resultant has a double root; as boxes they are apart.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from flint import acb, arb, arb_series

from symflex.balls import (
    Branching,
    Open,
    Pair,
    Part,
    bits_for_digits,
    branch,
    newton_box,
    precision,
    two_steps,
)
from symflex.loops.axis import BITS, FIRST_RATIO, ball_of, halves, joined, pieces
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

    def decide(piece: GainTree) -> GainTree | Open[GainTree] | None:
        total, across = piece.sums(place)
        if total.is_finite() and not total.contains(0):
            return None
        is_worth_it = piece.depth < DEEPEST and not 2 * across.rad() < total.rad()
        return Open(piece) if is_worth_it else piece

    search = branch(
        pieces,
        decide,
        lambda piece: piece.halves,
        order="breadth",
        until=lambda found, waiting: len(found.decided) + waiting > MOST_BOXES,
    )
    return sorted((*search.decided, *search.undecided), key=lambda piece: float(piece.ends[0].mid()))


def _sum(weights: Sequence[arb], parts: Sequence[acb]) -> acb:
    return sum((part * weight for weight, part in zip(weights, parts, strict=True)), acb(0))


@dataclass(frozen=True, slots=True)
class AxisPoints:
    """Frequencies [rad/s] and gains at which poles are on the axis."""

    proved: list[Pair]  # enclosures of one point each
    undecided: list[Pair]


@dataclass(frozen=True, slots=True)
class OpenGains:
    """An interval of frequencies, and the gains at which a pole may be there."""

    ends: Part
    gains: Sequence[GainTree]

    @property
    def boxes(self) -> list[Pair]:
        """Boxes of frequency and gain, gains that touch in one."""
        return [(ball_of(self.ends), gain) for gain in joined(piece.gain for piece in self.gains)]

    def halves(self) -> list[OpenGains]:
        """Return both parts, none of a narrow one."""
        return [replace(self, ends=ends) for ends in halves(self.ends)]


def find_axis_points(function: LoopFunction, tree: GainTree, limits: Part, digits: int) -> AxisPoints | None:
    """Return all between two frequencies, for the gains of a tree; None where they are too many intervals."""
    proved: list[Pair] = []

    def steps(box: Pair, bits: int) -> Pair | None:
        return _steps(function, tree.weights, box, bits)

    def decide(each: OpenGains) -> Open[OpenGains] | None:
        omega = ball_of(each.ends)
        with precision(BITS):
            around, centre = function.parts_around(acb(0, omega), BITS)
            off = acb(0, omega - omega.mid())
            place = PartsAlong([c for c, _ in centre], [slope for _, slope in around], off)
            each = replace(each, gains=left(each.gains, place))
        wanted = bits_for_digits(digits) + 16
        points = [newton_box(steps, _inflated(box), BITS, wanted) for box in each.boxes]
        if any(status == "undecided" for status, _ in points):
            return Open(each)
        for status, point in points:
            # One that was found from the interval before is not another.
            is_met = (all(x.overlaps(y) for x, y in zip(point, p, strict=True)) for p in proved)
            if status == "one" and not any(is_met):
                proved.append(point)
        return None

    ranges = [OpenGains(ends, (tree,)) for ends in pieces(*limits, FIRST_RATIO)]
    search: Branching[OpenGains, None] = branch(ranges, decide, OpenGains.halves, most=MOST_INTERVALS)
    if search.unseen:
        return None
    return AxisPoints(proved, [box for each in search.undecided for box in each.boxes])


def _inflated(box: Pair) -> Pair:
    omega, gain = (x.mid() + arb(0, x.rad() * INFLATED) for x in box)
    return omega, gain


def _steps(function: LoopFunction, weights: Weights, box: Pair, bits: int) -> Pair | None:
    """Return Newton's steps from the middle of a box, for all slopes on it; None where these are parallel."""
    omega, gain = box
    around, centre = function.parts_around(acb(0, omega), bits)
    wide, middle = weights(gain), weights(gain.mid())
    value = _sum([w[0] for w in middle], [c for c, _ in centre])
    by_omega = acb(0, 1) * _sum([w[0] for w in wide], [slope for _, slope in around])
    return two_steps(value, by_omega, _sum([w[1] for w in wide], [c for c, _ in around]))
