"""Roots carried from point to point of a sweep: each proved where it is, their number on the way there.

Input: a transfer function with kernels, points of its parameters in a row, and the roots at the first.
Output: the roots at the points after it, as far as they could be carried.

Example: five modes of a beam with a damper at its tip, whose coefficient goes from 1 to 3. Newton's method
finds the roots at the next point from those at the last, and a box about each is proved to hold one. About
the five modes lies a circle on which the characteristic function differs from 0 for every coefficient between
1 and 3. So it holds as many roots at 3 as at 1: the five and their mirror images, and none is missing.

On a path in the parameters along which a function has no root on a contour, and is analytic within, the
contour holds the same number of roots from one end to the other (Hurwitz 1889). The contour may move with the
parameters, so that it keeps between two modes whose frequencies change. Where steps are too long for that,
the roots in the contour are counted at every point; where they are others than those carried, they are
searched anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import count
from math import inf, log, pi, prod
from typing import Literal

from flint import acb, acb_series, arb

from symflex.algebra import LAPLACE, Factored, KernelTable
from symflex.algebra.vanishing import OriginSeries
from symflex.balls import UndecidedError, Value, at_centre, ball, covered, expansion, precision
from symflex.loops.boxes import BITS, Box, CharacteristicFunction, share_taken
from symflex.model import ExactValue
from symflex.roots import Band, Everything, Modes, Region, Root
from symflex.roots.counting.argument_principle import CertifiedWinding
from symflex.roots.counting.winding import WIDENED, RootOnPathError
from symflex.roots.functions.characteristic import CharacteristicValues
from symflex.roots.functions.exponential_values import Place
from symflex.roots.functions.kernel_function import SERIES_TERMS, KernelFunction
from symflex.roots.locate import default_region
from symflex.roots.passivity import EnergyProof, energy_proof
from symflex.roots.plane.local_roots import prove_simple
from symflex.roots.pole_zero_map import StabilityVerdict, chosen, hidden_poles, is_right, right_beyond
from symflex.roots.polynomial_roots import in_order
from symflex.roots.root import are_apart, mirror_images, root_at_zero
from symflex.sweep.design import Point
from symflex.transfer import AnyTransferFunction, BoundTransferFunction, TransferFunction
from symflex.transfer.enclose import enclosure

RootKind = Literal["poles", "zeros"]
DIGITS = 25  # of roots, with which their nearest doubles are known nearly always
BEYOND = (1.2, 1.08, 1.03)  # radius of a contour over the size of the outermost root, the first that serves
SEARCHED = 8.0  # how far a search of both sides may come, over the size of the outermost root
NARROWEST = 1e-4  # part of a contour on which the function is not looked at any closer
POINTS = 4  # from which those at the next are foretold
STEPS = 4  # between points that one proof is tried for at first
LOOKS = 30  # parts of a contour that one step is worth; to count the roots at a point takes as long
PARTS = 4  # into which a contour is cut at first, and as many for every root


@dataclass(frozen=True, slots=True)
class Carried:
    """The roots of a function within a contour, at one point."""

    numbers: tuple[Fraction, ...]  # values of the parameters
    roots: tuple[Root, ...]  # in the closed upper half-plane, simple and none of them 0
    # What has them and what may share none, both without powers of s.
    sides: tuple[KernelFunction, KernelFunction]
    order: int  # to which what has them vanishes at s = 0
    at_zero: int  # multiplicity of the root there, powers of s among it
    # ln of the radius [rad/s] of a circle about these roots and no others but mirror images and 0.
    height: float = inf

    @property
    def is_told_from_axis(self) -> bool:
        """Whether every root is known to be on the imaginary axis, or on which side of it."""
        return not any(root.re.contains(0) and not root.on_imaginary_axis for root in self.roots)


@dataclass(frozen=True, eq=False)
class Continuation:
    """Carries the poles, or the zeros, of a transfer function with kernels from point to point."""

    tf: TransferFunction
    names: tuple[str, ...]  # of the parameters that are swept
    region: Modes | Band
    kind: RootKind

    @classmethod
    def of(
        cls, tf: AnyTransferFunction, names: Sequence[str], kind: RootKind, region: Region | None
    ) -> Continuation | None:
        """Return what carries the roots of a function in a region; None where it does not serve."""
        if not tf.is_reduced or tf.is_rational or tf.is_zero or tf.with_waves is not None:
            return None
        model, s = tf.model, tf.ratio.ring.context.gen(0)
        if any(hidden.polynomial != s for hidden in tf.hidden):
            return None
        if model.root is not None or model.imaginary or any(law.matrix for law in tf.kernels.dispersions):
            return None
        where = default_region(model) if region is None or isinstance(region, Everything) else region
        return cls(tf, tuple(names), where, kind) if isinstance(where, Modes | Band) else None

    def serves(self, verdict: StabilityVerdict) -> bool:
        """Tell whether a verdict can be carried on, if the roots are as they should be."""
        if self.kind == "zeros":
            return True
        if verdict.hidden != hidden_poles(sum(hidden.multiplicity for hidden in self.tf.hidden), 0, 0):
            return False
        if self._energy.is_passive:
            is_marginal = verdict.word == "marginal"
            return (is_marginal or verdict.word == "stable") and (
                self._energy.rests or (is_marginal and self._meets_nowhere)
            )
        return verdict.certified and verdict.right is not None and verdict.word != "marginal"

    def begin(self, point: Point, guesses: Sequence[complex], at_zero: int) -> Carried | None:
        """Return the roots at a point where all of the region are known, and a contour about them.

        None where they cannot be carried on: one is multiple, two are too close, or others are too near.
        """
        numbers = _numbers(point)
        if numbers is None:
            return None
        bound = self._bound(numbers)
        own, other = (KernelFunction(bound, _moving(side, self.tf.kernels)) for side in self._sides)
        roots = self._roots((own, other), [acb(s.real, s.imag) for s in guesses])
        order = own.order()
        if roots is None or order is None or order != own.power * (at_zero - self._powers_of_s):
            return None
        if not self._reach(roots) or self._hides_at_zero(at_zero, numbers):
            return None
        return self._surrounded(Carried(numbers, roots, (own, other), order, at_zero))

    def carry(self, start: Carried, points: Sequence[Point], verdict: StabilityVerdict) -> list[Carried]:
        """Return the roots at points after one, as far as they can be carried with the same verdict."""
        way = [start] if self._keeps(verdict, start) else []
        for point in points if way else ():
            following = self._following(way, point)
            if following is None or not self._keeps(verdict, following):
                break
            way.append(following)
        return self._complete(way)

    def _following(self, way: Sequence[Carried], point: Point) -> Carried | None:
        """Return the roots at the next point of a way, as many; None if some are not simple there."""
        numbers, last = _numbers(point), way[-1]
        if numbers is None:
            return None
        bound = self._bound(numbers)
        own, other = (KernelFunction(bound, side.part, side) for side in last.sides)
        roots = self._roots((own, other), _continued(way, numbers))
        # Where a pair meets the real axis there is one less.
        if roots is None or _count(roots) != _count(last.roots) or self._hides_at_zero(last.at_zero, numbers):
            return None
        height = last.height + log(self._reach(roots) / self._reach(last.roots))
        return replace(last, numbers=numbers, roots=roots, sides=(own, other), height=height)

    def _complete(self, way: list[Carried]) -> list[Carried]:
        """Return the points of a way behind its first, as far as it is proved that no root is missing."""
        i, steps = 0, STEPS
        while i < len(way) - 1:
            end = _end_of_straight(way, i, steps)
            while end > i + 1 and not self._is_clear_between(way[i], way[end], LOOKS * (end - i)):
                steps = (end - i) // 2
                end = i + steps
            if end > i + 1:
                steps *= 2
            else:  # steps so long are proved no better than points
                end = i + 1
                counted = self._surrounded(way[end])
                if counted is None or not self._keeps_side(way[i], way[end]):
                    break
                way[end] = counted
            i = end
        return way[1 : i + 1]

    def _surrounded(self, at: Carried) -> Carried | None:
        """Return the roots with a contour in which there are no others, counted; None if none is found."""
        own, _ = at.sides
        turns = at.order + own.power * _count(at.roots)
        heights = (log(self._reach(at.roots) * beyond) for beyond in BEYOND)
        height = next((z for z in heights if _turns(own, z) == turns), None)
        return None if height is None else replace(at, height=height)

    def chosen(self, at: Carried) -> tuple[Root, ...]:
        """Return the roots of the region, mirror images with them, as a search there does."""
        every = [*root_at_zero(at.at_zero), *mirror_images(at.roots, even=False)]
        found = chosen(every, self.region)
        return (*found, *(right_beyond(in_order(every), found) if self.kind == "poles" else ()))

    def _hides_at_zero(self, at_zero: int, numbers: Sequence[Fraction]) -> bool:
        """Tell whether the other side may vanish at s = 0, where there are roots, for these values."""
        if not at_zero:
            return False
        values = ((name, value.rational) for name, value in self._values if not value.pi_power)
        known = dict(values) | dict(zip(self.names, numbers, strict=True))
        known = {name: x for name, x in known.items() if name in self.tf.ratio.ring.index}
        series = OriginSeries(self.tf.ratio.ring, self.tf.kernels, terms=SERIES_TERMS[0], known=known)
        return series.order(self._sides[1]) != 0

    @property
    def _sides(self) -> tuple[Factored, Factored]:
        """What has the roots, and what takes one away where it vanishes there, too."""
        return (self.tf.den, self.tf.num) if self.kind == "poles" else (self.tf.num, self.tf.den)

    @property
    def _powers_of_s(self) -> int:
        own, _ = self._sides
        return own.exponent_of(own.ring.context.gen(0))

    @cached_property
    def _values(self) -> tuple[tuple[str, ExactValue], ...]:
        """The values of the parameters that are not swept."""
        return tuple(
            (p.name, p.value)
            for p in self.tf.model.parameters
            if p.value is not None and p.name not in self.names
        )

    def _bound(self, numbers: Sequence[Fraction]) -> BoundTransferFunction:
        """Return the function over its own ring, with numbers for its parameters."""
        tf = self.tf
        fixed = tuple((n, enclosure(ExactValue(x))) for n, x in zip(self.names, numbers, strict=True))
        return BoundTransferFunction(tf, self._values, tf.ratio, tf.hidden, tf.kernels, fixed=fixed)

    def _roots(
        self, sides: tuple[KernelFunction, KernelFunction], guesses: Sequence[acb]
    ) -> tuple[Root, ...] | None:
        """Return the roots next to some places; None if one is not simple, or is shared, or two may be one.

        None too where roots accumulate so near that a search might meet them.
        """
        own, other = sides
        roots = []
        for guess in guesses:
            root = prove_simple(own, guess, DIGITS)
            if root is None or not root.certified or root.multiplicity != 1:
                return None
            if not (root.is_real or root.im > 0) or root.enclosure().contains(0):
                return None
            values = other.enclosed(root.enclosure(), BITS)
            if any(value.contains(0) or not value.is_finite() for value, _, _ in values):
                return None
            roots.append(root)
        with precision(BITS):
            disc = acb(*[arb(0, self._reach(roots) * SEARCHED)] * 2)
        has_holes = not all(side.is_analytic_on(disc, BITS) for side in sides)
        return None if has_holes or not are_apart(roots) else tuple(roots)

    def _reach(self, roots: Sequence[Root]) -> float:
        """Return the size of the outermost root [rad/s], at least the end of the band."""
        end = 2 * pi * float(self.region.high) if isinstance(self.region, Band) else 0.0
        return max([end, *(float(root.size().mid()) for root in roots)])

    @cached_property
    def _energy(self) -> EnergyProof:
        """What energy says of the poles for any positive values of the parameters."""
        return energy_proof(self.tf.model, (), self.tf.output, self.names)

    @cached_property
    def _meets_nowhere(self) -> bool:
        """Wavenumbers neither meet nor vanish but at s = 0, so that nothing hides there."""
        laws = self.tf.kernels.dispersions
        coefficients = [c for law in laws for c in law.characteristic]
        is_single = all(len(law.wavenumbers) == 1 for law in laws)
        return is_single and all(len(f) == 1 for c in coefficients for f, e in c.factors if e > 0)

    def _keeps(self, verdict: StabilityVerdict, at: Carried) -> bool:
        """Tell whether a verdict that serves is that on a point, if no pole crosses the axis on the way."""
        if self.kind == "zeros":
            return True
        on_axis = at.at_zero > 0 or any(root.on_imaginary_axis for root in at.roots)
        if not at.is_told_from_axis or on_axis is not (verdict.word == "marginal"):
            return False
        return self._energy.is_passive or verdict.right == _count([r for r in at.roots if is_right(r)])

    @cached_property
    def _characteristic(self) -> CharacteristicFunction:
        """The characteristic function whose poles must not cross the imaginary axis."""
        return CharacteristicFunction.of(self.tf.model, self.tf, self.names, are_positive=True)

    def _keeps_side(self, start: Carried, end: Carried) -> bool:
        """Tell whether no pole crosses the imaginary axis on the straight way between two points."""
        if self.kind == "zeros" or self._energy.is_passive:
            return True
        box = tuple((min(ends), max(ends)) for ends in zip(start.numbers, end.numbers, strict=True))
        axis = self._characteristic.whole(box)
        return axis.is_bounded and not any(self._characteristic.narrowed(axis).pieces)

    def _is_clear_between(self, start: Carried, end: Carried, most: int) -> bool:
        """Tell whether no root crosses the contour, nor the axis, on the straight way between two points.

        So many parts of the contour are looked at, at most.
        """
        if not self._keeps_side(start, end):
            return False
        ends = [
            (name, a, b) for name, a, b in zip(self.names, start.numbers, end.numbers, strict=True) if a != b
        ]
        if not ends:
            return True
        moving = tuple(name for name, _, _ in ends)
        still = (pair for pair in zip(self.names, start.numbers, strict=True) if pair[0] not in moving)
        values = (*self._values, *((name, ExactValue(x)) for name, x in still))
        own, heights = start.sides[0], (start.height, end.height)
        factors = tuple(f for f, _ in own.part.factors)
        function = CharacteristicFunction(self.tf, moving, values, chosen=factors, are_positive=True)
        box = tuple((min(a, b), max(a, b)) for _, a, b in ends)
        with precision(BITS):
            disc = acb(*[arb(0, arb(max(heights)).exp().upper())] * 2)
            if not KernelFunction(function.bound_in(self.tf, box), own.part, own).is_analytic_on(disc, BITS):
                return False
            circle = _Circle.of(function, box, [a < b for _, a, b in ends], heights, _left(own))
            looks = count()

            def is_clear(first: float, last: float) -> Literal[True] | None:
                if next(looks) >= most:
                    raise UndecidedError
                return circle.is_clear(first, last)

            try:
                covered(is_clear, PARTS + PARTS * len(start.roots), NARROWEST)
            except UndecidedError:
                return False
        return True


@dataclass(frozen=True, eq=False)
class _Circle:
    """A circle whose radius changes as parameters go from one end of a box to the other, in ``w = ln(s)``.

    There the way is straight. Exponents differ from those in the middle of a part by their slopes times the
    distances, for slopes on the whole part, and so do the factors (mean value theorem; Moore 1966). As a
    length and a frequency change together, an exponent may hardly do, which their two ranges do not show.
    """

    numbers: range  # of the factors
    wide: CharacteristicValues  # for all parameters of the box
    middle: CharacteristicValues  # in its middle
    slopes: tuple[tuple[CharacteristicValues, arb], ...]  # to first order in one, and how far that one goes
    heights: tuple[float, float]  # ln of the radius at first and at last
    left: float  # angle up to which it is followed

    @classmethod
    def of(
        cls,
        function: CharacteristicFunction,
        box: Box,
        rises: Sequence[bool],
        heights: tuple[float, float],
        left: float,
    ) -> _Circle:
        """Return the circle for parameters each of which rises or falls."""
        tf, factors = function.tf, function.factors
        sums = function.sums(tf, factors)
        middle = tuple(((a + b) / 2,) * 2 for a, b in box)

        def values(part: Box, along: str = "") -> CharacteristicValues:
            return CharacteristicValues.of(function.kernels(tf, part, along), factors, sums)

        ways = [ball((b - a) / 2) * (1 if up else -1) for (a, b), up in zip(box, rises, strict=True)]
        slopes = tuple((values(box, name), way) for name, way in zip(function.names, ways, strict=True))
        return cls(range(len(factors)), values(box), values(middle), slopes, heights, left)

    def is_clear(self, first: float, last: float) -> Literal[True] | None:
        """Tell whether no factor has a root on a part of the circle; None if that is not known."""
        unit = arb(0, 1)
        low, high = (arb(z) for z in self.heights)
        height, way = (low + high) / 2, (high - low) / 2
        angle, turn = (first + last) / 2 * self.left, arb((last - first) / 2 * self.left * WIDENED)
        around = acb(height + way * unit, angle + turn * unit).exp()
        near = self.wide.at(expansion(around))
        centre = self.middle.at(acb(height, angle).exp(), near)
        still = acb_series([around, 0], 2)
        others = [(values, values.at(still, near), reach) for values, reach in self.slopes]

        def swings(in_s: acb, slopes: Sequence[acb]) -> tuple[acb, acb]:
            """Return how far a value goes with the parameters, and along the circle."""
            steps = (slope * reach for slope, (_, _, reach) in zip(slopes, others, strict=True))
            return sum(steps, in_s * around * way), in_s * around * acb(0, 1) * turn

        arguments = []
        for k, argument in enumerate(near.arguments):
            along, across = swings(_slope(argument), [_slope(place.arguments[k]) for _, place, _ in others])
            sharp = at_centre(centre.arguments[k]) + along * unit + across * unit
            arguments.append(min(at_centre(argument), sharp, key=lambda x: float(x.rad())))

        def sharpened(place: Place) -> Place:
            pairs = zip(arguments, place.arguments, strict=True)
            own = [acb_series([x, _slope(argument)], 2) for x, argument in pairs]
            return Place(place.values, own, place.products, place.amplitudes)

        near_sharp, others_sharp = sharpened(near), [(v, sharpened(place)) for v, place, _ in others]
        for i in self.numbers:
            less = self.wide.largest([i], near)
            value, in_s = self.wide.first_order(i, near_sharp, less)
            if not value.contains(0):
                continue
            slopes = [values.first_order(i, place, less)[1] for values, place in others_sharp]
            middle, _ = self.middle.first_order(i, centre, less)
            if not share_taken(middle, swings(in_s, slopes))[0] < 1:
                return None
        return True


def _slope(value: Value) -> acb:
    return value[1] if isinstance(value, acb_series) else acb(0)


def _moving(side: Factored, kernels: KernelTable) -> Factored:
    """Return the factors that may vanish: no powers of s alone, nor of parameters, none of which is 0."""
    s, moving = side.ring.context.gen(0), {LAPLACE, *kernels.generators}
    return side.filter(lambda f: f != s and not (len(f) == 1 and moving.isdisjoint(side.ring.used_in([f]))))


def _count(roots: Sequence[Root]) -> int:
    """Return how many simple roots there are with their conjugates."""
    return sum(1 if root.is_real else 2 for root in roots)


def _numbers(point: Point) -> tuple[Fraction, ...] | None:
    """Return the values of a point if they are positive rational numbers."""
    values = tuple(value.rational for value in point if not value.pi_power and value.rational > 0)
    return values if len(values) == len(point) else None


def _left(function: KernelFunction) -> float:
    """Return the angle up to which a circle is followed; the rest are mirror images."""
    return pi / 2 if function.is_even else pi


def _turns(function: KernelFunction, height: float) -> int | None:
    """Return how many roots lie in a circle, by ln of its radius; None if one is too near to it."""
    try:
        return CertifiedWinding(function).count_within(height, _left(function))
    except RootOnPathError:
        return None


def _continued(way: Sequence[Carried], numbers: Sequence[Fraction]) -> list[acb]:
    """Return where roots are next, by a polynomial through the last points on a line; or where they were."""
    last, before = way[-1], way[max(len(way) - 2, 0)]
    goal = _share(before.numbers, last.numbers, numbers)
    known: dict[Fraction, Carried] = {}
    for at in reversed(way[-POINTS:] if goal is not None else ()):
        share = _share(before.numbers, last.numbers, at.numbers)
        if share is None or share in known:
            break
        known[share] = at
    if goal is None or not known:
        return [acb(root.re.mid(), root.im.mid()) for root in last.roots]
    with precision(BITS):
        # Lagrange's weights.
        factors = [[(goal - x) / (own - x) for x in known if x != own] for own in known]
        weights = [ball(prod(each, start=Fraction(1))) for each in factors]
        rows = zip(*(at.roots for at in known.values()), strict=True)
        return [
            sum((w * r.enclosure().mid() for w, r in zip(weights, row, strict=True)), acb(0)).mid()
            for row in rows
        ]


def _share(start: Sequence[Fraction], end: Sequence[Fraction], at: Sequence[Fraction]) -> Fraction | None:
    """Return how far a point is on the line through two others, from 0 to 1 between them; None beside it.

    >>> _share([Fraction(1), Fraction(5)], [Fraction(3), Fraction(5)], [Fraction(4), Fraction(5)])
    Fraction(3, 2)
    """
    ways = list(zip(start, end, at, strict=True))
    shares = {(c - a) / (b - a) for a, b, c in ways if a != b}
    return shares.pop() if len(shares) == 1 and not any(a == b != c for a, b, c in ways) else None


def _end_of_straight(way: Sequence[Carried], first: int, steps: int) -> int:
    """Return the last of so many points on a straight line, whose contours go on straight, too."""
    end = first + 1
    for candidate in range(first + 2, min(first + steps + 1, len(way))):
        if not all(_is_passed(way[first], way[candidate], way[i]) for i in range(first + 1, candidate)):
            break
        end = candidate
    return end


def _is_passed(start: Carried, end: Carried, between: Carried) -> bool:
    """Tell whether a straight way leads past a point, whose roots are within the contour there."""
    share = _share(start.numbers, end.numbers, between.numbers)
    if share is None or not 0 <= share <= 1:
        return False
    with precision(BITS):
        radius = (start.height + (end.height - start.height) * ball(share)).exp()
        return all(bool(root.size() < radius) for root in between.roots)
