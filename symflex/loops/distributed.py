"""Stability boundaries of characteristic functions with kernels: beams, rods, delays.

Crossings of the imaginary axis are isolated in one dimension: along the axis ``A + K B`` vanishes for a real
K only where ``Im(A conj(B))`` does. Next to s = 0, where both may vanish, power series say what poles do.
Between them poles in the right half-plane are counted by the argument
principle about a half disc, beyond which, where this can be proved, there are none.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property, partial, reduce
from math import exp, log, prod

from flint import acb, arb, arb_series

from symflex.algebra import Factored
from symflex.balls import UndecidedError, ball, covered, precision
from symflex.errors import Diagnostic, UncertifiedError
from symflex.loops.axis import ORIGIN_BITS, joined
from symflex.loops.axis_search import NEXT_TO_ZERO, NOT_PROVED_AT_ZERO, SHRINKINGS, AxisSearch
from symflex.loops.boxes import COUNT_DIGITS
from symflex.loops.gain_functions import GainFunctions
from symflex.loops.loop import GainPolynomial, Loop, independent
from symflex.loops.loop_function import LoopFunction
from symflex.loops.stability_map import BITS, Crossing, PoleCount
from symflex.loops.two_unknowns import GainTree, PartsAlong, find_axis_points, left
from symflex.roots.counting.winding import RootOnAxisError, RootOnPathError
from symflex.roots.degenerate import DegeneratePoints, degenerate_points
from symflex.roots.distributed.far_out import ADVANCED, DELAY_LEADS, NEUTRAL, right_tail
from symflex.roots.distributed.right_half_plane import search_right
from symflex.roots.distributed.side import Side
from symflex.roots.functions.kernel_function import KernelFunction
from symflex.roots.functions.simplified import without_squares
from symflex.roots.passivity import EnergyProof, energy_proof
from symflex.roots.pole_zero_map import count_right, is_right
from symflex.roots.root import Root, count_roots, exact_fraction
from symflex.roots.sheets import growing, on_sheet
from symflex.transfer import BoundTransferFunction
from symflex.transfer.enclose import first_order

GainValue = Callable[[arb], arb_series]

OUTWEIGHED = (ADVANCED, NEUTRAL, DELAY_LEADS)  # what is said where delayed terms leave poles without a bound
HALVINGS = 12  # halvings of a range: its end is then known to a few hundredths of the nominal gain
SLIVER = 40  # halvings of a range: what is left may be missing at an end of it
WITHOUT_WAVES = 1e-6  # a frequency [rad/s] from which a radius is sought for polynomials in a root of s
WAVES = 30.0  # largest argument of a kernel up to which poles are counted where no end is known
ARCS, SHORTEST = 64, 1e-5  # parts of a quarter of a circle, at first and at least, shown free of poles
NUDGES = (0.0, 0.0137, 0.0291, 0.0531)  # shifts of the outer circle when it meets a pole [in ln]


@dataclass
class DistributedFactors(AxisSearch):
    """The factors with kernels of a characteristic function; ``reasons`` say what is not certified."""

    bound: BoundTransferFunction  # carries ring and kernels
    gain: str  # its name
    factors: tuple[GainPolynomial, ...]  # with kernels or wavenumbers, or negative exponents
    limits: tuple[Fraction, Fraction]  # range of the gain
    up_to: float | None  # a frequency up to which to search where no end can be proved [rad/s]
    reasons: list[str] = field(default_factory=list)
    method: str = "argument principle"
    is_narrowed: bool = False  # the range ends where a delayed term may outweigh the others
    loop: Loop | None = None  # whose factors they are
    is_cut: bool = False  # poles beyond ``up_to`` are not asked for

    @property
    def where_no_delay_leads(self) -> DistributedFactors:
        """The same on the largest part of the range, by halving, where poles have a bound despite delays."""
        if not any(tail in OUTWEIGHED for tail in self._tails):
            return self
        largest, good, bad = self, Fraction(0), Fraction(1)
        for _ in range(HALVINGS):
            share = (good + bad) / 2
            low, high = self.limits
            part = replace(self, limits=(share * low, share * high), is_narrowed=True, reasons=[])
            if part.is_endless:
                bad = share
            else:
                largest, good = part, share
        return largest

    @cached_property
    def with_gain(self) -> tuple[LoopFunction, ...]:
        """A and B of every factor that depends on the gain, or all parts of another."""
        return tuple(self._parts(factor) for factor in self.factors if factor.degree)

    def _parts(self, factor: GainPolynomial) -> LoopFunction:
        if factor.degree > 1:
            return LoopFunction.of(self.bound, *(c for _, c in factor.terms))
        zero = Factored.number(self.bound.ratio.ring, 0)
        return LoopFunction.of(self.bound, *[*factor.coefficients, zero][:2])

    @cached_property
    def _tails(self) -> list[float | str]:
        tails = []
        for factor in self.factors:
            if factor.multiplicity > 0:
                with precision(BITS):
                    weights = zip(*(piece.values[0] for piece in self._tree(factor).pieces), strict=True)
                    most = [acb(reduce(arb.union, each)) for each in weights]
                tails.append(right_tail(self.bound, self._parts(factor).parts, most, self.scale))
        return tails

    def _tree(self, factor: GainPolynomial) -> GainTree:
        """Return the range of the gain with what the parts of a factor are multiplied by."""
        functions = self.loop.functions if self.loop is not None and factor.exponents else None
        functions = functions or GainFunctions(self.gain, {}, {}, None)
        keys = [key for key, _ in factor.terms] if factor.degree > 1 else [(0,), (1,)]

        def weights(gain: arb) -> list[arb_series]:
            values, one = functions.at(gain), first_order(arb(1))
            return [prod((values[i] ** e for i, e in enumerate(key) if e), start=one) for key in keys]

        # Next to an end functions may have no bound, as logarithms have none at zero.
        ends = [ball(x) for x in self.limits]
        sliver = (ends[1] - ends[0]) / 2**SLIVER
        for i, step in enumerate((sliver, -sliver)):
            if not all(w[0].is_finite() for w in weights(ends[i].union(ends[i] + step))):
                ends[i] = ends[i] + step
        return GainTree(weights, (ends[0].lower(), ends[1].upper()))

    @cached_property
    def radius(self) -> tuple[float, bool]:
        """How far poles are searched [rad/s], and if none lies beyond on the right; see ``reasons``."""
        if self.is_cut:
            self.reasons.append("the data end there")
            return self._without_end, False
        if not self.is_endless:
            return max(tail for tail in self._tails if not isinstance(tail, str)), True
        if self.energy.rests:
            self.method = "passive loop"
            return self._without_end, True
        reason = next(tail for tail in self._tails if isinstance(tail, str))
        passive = "; the loop is passive: none lies in the right half-plane"
        self.reasons.append(reason + passive if self.energy.is_passive else reason)
        return self._without_end, False

    @property
    def is_endless(self) -> bool:
        """Whether poles next to the axis have no end along it, or none that is known."""
        return any(isinstance(tail, str) for tail in self._tails)

    @cached_property
    def energy(self) -> EnergyProof:
        """What energy says of the poles for every gain in the range."""
        source = self.bound.source
        is_straight = all(factor.degree <= 1 for factor in self.factors)
        if self.limits[0] < 0 or self.bound.sheets > 1 or not is_straight or not self.gain:
            return EnergyProof()
        return energy_proof(source.model, self.bound.all_values, source.output, (self.gain,))

    @property
    def axis_end(self) -> float:
        """How far crossings are searched [rad/s], to the largest circle of counts; 0 of a passive loop."""
        end, is_proved = self.radius
        if is_proved and self.is_endless:
            return 0.0
        return end if is_proved else end * exp(NUDGES[-1])

    @cached_property
    def scale(self) -> float:
        """A frequency at which the largest argument of a kernel is about one [rad/s]."""
        return self._function(self.limits[1]).frequency_of(1.0) if self.bound.kernels else WITHOUT_WAVES

    def frequency(self, omega: arb) -> arb:
        """Return the frequency [rad/s] at a place of the axis."""
        return self.bound.frequency(omega)

    def from_root(self, size: float) -> float:
        """Return an ``abs(s)`` [rad/s] up to which no root of it exceeds a size."""
        return self.bound.from_root(size)

    @cached_property
    def _without_end(self) -> float:
        return self._function(self.limits[1]).frequency_of(WAVES) if self.up_to is None else self.up_to

    def _product(self, gain: Fraction, *, hidden: bool = True) -> tuple[BoundTransferFunction, Factored]:
        loop = self.loop if any(factor.exponents for factor in self.factors) else None
        bound = self.bound if loop is None else loop.bound_at(gain)
        total = Factored.number(bound.ratio.ring, 1)
        for factor in self.factors:
            if hidden or not factor.is_hidden:
                total = total * factor.value_in(bound, gain, loop) ** factor.multiplicity
        return bound, total

    def _function(self, gain: Fraction) -> KernelFunction:
        bound, product = self._product(gain)
        s = product.ring.context.gen(0)
        return KernelFunction(*without_squares(bound, product.filter(lambda f: f != s)))

    @property
    def is_mirrored(self) -> bool:
        """Whether A and B of a factor are even or odd alike: roots mirror each other for every gain."""
        # What mirrors a pole lies on another sheet if there are some.
        return self.bound.sheets == 1 and any(map(self._mirrors, self.with_gain))

    def _mirrors(self, function: LoopFunction) -> bool:
        ring = self.bound.ratio.ring
        parts = [KernelFunction(self.bound, Factored.polynomial(ring, f)) for f in function.parts]
        if not all(part.is_even for part in parts):
            return False
        powers = [{int(m[0]) % 2 for m in f.monoms()} for f in function.parts]
        return all(each == powers[0] for each in powers)

    def last_crossover(self, gain: arb) -> float:
        """Return the frequency [rad/s] beyond which the loop gain is not one, as far as it is searched."""
        (function,) = self.with_gain
        last, is_proved = self.radius
        if not is_proved:
            return last
        most = abs(gain).upper()
        disc = acb(arb(0, most), arb(0, most))
        tail = right_tail(function.bound, (function.a, function.b), (acb(1), disc), last)
        if not isinstance(tail, str):
            return tail
        if not self.is_endless:
            self.reasons.append("it could not be decided whether the loop gain is one at high frequencies")
        return last

    def count(
        self, gain: Fraction, below: PoleCount | None = None, crossed: Sequence[Crossing] = ()
    ) -> PoleCount:
        """Return how many poles are right and on the axis, counted, or by those ``below`` and crossings."""
        end = self.from_root(self._circle)
        changes = [
            c.change for c in crossed if c.change != 0 and not (c.frequencies and c.frequencies[0] > end)
        ]
        moved = [change for change in changes if change is not None]
        is_proved = self._circle > 0 and not self.reasons[not self.radius[1] :]
        if below is not None and is_proved and len(moved) == len(changes):
            return PoleCount(below.right + sum(moved), below.axis)
        side = Side(*self._product(gain), COUNT_DIGITS)
        # Where wavenumbers vanish, what cancelled may have a root at 0 that is no pole.
        origin = side
        if any(factor.is_hidden for factor in self.factors):
            origin = Side(*self._product(gain, hidden=False), COUNT_DIGITS)
        # On the axis of a root of s only 0 is on that of s.
        at_axis = (root for root in origin.roots if self.bound.sheets == 1 or root.is_zero)
        seen = [root for root in at_axis if root.on_imaginary_axis or not origin.is_finite]
        zeros = count_roots(seen)
        if not all(root.certified for root in seen):
            self.reasons.append("poles next to s = 0 are counted as poles at 0")
        if side.is_finite:
            roots, _ = on_sheet(side.roots, self.bound)
            if self.bound.sheets > 1 and any(r.re.contains(0) and not r.is_zero for r in roots):
                message = "it could not be decided on which side of the imaginary axis a pole lies"
                raise UncertifiedError(Diagnostic("SF802", message))
            return PoleCount(count_right(roots), zeros)
        if self.energy.rests:
            return PoleCount(0, zeros)
        for circle in [self._circle] if self._circle else self._circles:
            try:
                if self.loop and self._meeting:
                    points = DegeneratePoints(self.loop.bound_at(gain), self._meeting)
                    return PoleCount(_right_but(points, side, circle), zeros)
                return PoleCount(side.count_right(log(circle)), zeros)
            except RootOnAxisError:
                break
            except RootOnPathError:
                continue
        message = f"poles in the right half-plane cannot be counted for a gain of {float(gain):.6g}"
        hint = "one may lie on the imaginary axis whatever the gain is"
        raise UncertifiedError(Diagnostic("SF802", message, None, hint))

    @cached_property
    def _meeting(self) -> list[Root]:
        """Where wavenumbers meet on the right: the formula is 0/0 there, whatever the gain is."""
        return [point for point in degenerate_points(self.bound) if is_right(point)]

    @property
    def _circles(self) -> list[float]:
        return [self.radius[0] * 1.01 * exp(nudge) for nudge in NUDGES]

    @cached_property
    def _circle(self) -> float:
        """The first circle that no pole passes in the right half-plane for any gain; 0 without one."""

        def is_free(circle: float, function: LoopFunction, low: float, high: float) -> bool | None:
            with precision(BITS):
                quarter = arb.pi() / (2 * self.bound.sheets)
                turned = (acb(0, 1) * arb(low).union(arb(high)) * quarter).exp()
                value = function.around(circle * turned, BITS)[0]
                return value.crossing()[0] != 0 or self._is_far(value) or None

        if self.radius[1]:
            return self._circles[0]
        if any(factor.degree > 1 for factor in self.factors):
            return 0.0
        for circle in self._circles:
            with suppress(UndecidedError):
                for function in self.with_gain:
                    covered(partial(is_free, circle, function), ARCS, SHORTEST)
                return circle
        return 0.0

    def crossings(self, digits: int) -> list[Crossing]:
        """Return where poles cross the axis for gains in the range; the search's gaps go to ``reasons``."""
        crossings: list[Crossing] = []
        for factor in self.factors:
            if factor.degree == 1:
                is_simple = all(each.multiplicity == 1 for each in self.factors if each.degree)
                crossings += self.crossings_of(self._parts(factor), digits, is_simple=is_simple)
            elif factor.degree:
                ends = zip(map(ball, self.limits), self._tree(factor).ends, strict=True)
                crossings += [Crossing(x.union(e), (), change=None) for x, e in ends if not x.overlaps(e)]
                one = self.in_one_function(factor)
                crossings += self._inverted(*one, digits) if one else self._in_two_unknowns(factor, digits)
        return crossings

    def in_one_function(
        self, factor: GainPolynomial, *, is_monic: bool = False
    ) -> tuple[GainValue, list[tuple[arb, arb]], DistributedFactors] | None:
        """Return f, its values on pieces, and ``A + f B``, if f moves all poles; A is all else if monic."""
        function, tree = self._parts(factor), self._tree(factor)
        basis, shares = independent(function.parts)
        if len(basis) != 2 or (is_monic and any(shares[0][1:])):  # noqa: PLR2004 (A and B)
            return None

        def value(gain: arb) -> arb_series:
            weights, start = tree.weights(gain), first_order(arb(0))
            sums = (sum((w * arb(x) for w, x in zip(weights, row, strict=True)), start) for row in shares)
            one, other = sums
            return first_order(arb("nan"), arb("nan")) if one[0].contains(0) else other / one

        with precision(BITS):
            values = [(piece.gain, value(piece.gain)[0]) for piece in tree.pieces]
        hull = reduce(arb.union, (around for _, around in values))
        if not hull.is_finite():
            return None
        ring = self.bound.ratio.ring
        parts = tuple(Factored.polynomial(ring, function.parts[i]) for i in basis)
        limits = exact_fraction(hull.lower()), exact_fraction(hull.upper())
        polynomial = GainPolynomial(parts, factor.multiplicity)
        straight = replace(self, gain="", factors=(polynomial,), limits=limits, loop=None, reasons=[])
        return value, values, straight

    def _inverted(
        self, value: GainValue, values: Sequence[tuple[arb, arb]], loop: DistributedFactors, digits: int
    ) -> list[Crossing]:
        """Return the crossings of a loop ``A + f B`` at the gains for which f has their values."""
        crossings: list[Crossing] = []
        for crossing in loop.crossings(2 * digits):

            def less(gain: arb, at: arb = crossing.gain) -> arb_series:
                return value(gain) - at

            for part in joined([gain for gain, around in values if around.overlaps(crossing.gain)]):
                ends = exact_fraction(part.lower()), exact_fraction(part.upper())
                limits = max(ends[0], self.limits[0]), min(ends[1], self.limits[1])
                for is_open, gains in enumerate(self._alone.zeros(less, limits, digits)):
                    for gain in gains:
                        slope, change = value(gain)[1], crossing.change
                        turned = -1 if slope < 0 else 1 if slope > 0 else None
                        change = None if change is None or turned is None else turned * change
                        moved = replace(crossing, gain=gain, change=change)
                        crossings.append(replace(moved, is_open=crossing.is_open or bool(is_open)))
        self.reasons += loop.reasons
        return crossings

    @property
    def _alone(self) -> GainFunctions:
        return GainFunctions(self.gain, {}, {}, None)

    def _in_two_unknowns(self, factor: GainPolynomial, digits: int) -> list[Crossing]:
        """Return the same of a factor that depends on several functions of the gain."""
        function, tree, crossings = self._parts(factor), self._tree(factor), list[Crossing]()
        origin, first = function.at_origin(), 0.0
        if origin is not None:
            with precision(ORIGIN_BITS):
                radius = origin.series[0].reach / 4
                for _ in range(SHRINKINGS):
                    if not left([tree], PartsAlong(origin.beside(arb(0).union(radius)))):
                        first = float(radius.lower())
                        break
                    radius = radius / 2
            start = origin.beside(arb(0))

            def at_zero(gain: arb) -> arb_series:
                terms = (w * c.real for c, w in zip(start, tree.weights(gain), strict=True))
                return sum(terms, first_order(arb(0)))

            for is_open, gains in enumerate(self._alone.zeros(at_zero, self.limits, digits)):
                crossings += [Crossing(g, (arb(0),), is_open=bool(is_open), change=None) for g in gains]
        if not first:
            self.reasons.append(NOT_PROVED_AT_ZERO)
            first = self.scale * NEXT_TO_ZERO
        points = find_axis_points(function, tree, (first, self.axis_end * 1.01), digits)
        if points is None:
            # Counts at a few gains say nothing of those between.
            message = (
                "the search for crossings of the imaginary axis takes too long in this range of the gain"
            )
            raise UncertifiedError(Diagnostic("SF802", message, None, "give a narrower --range"))
        for omega, gain in points.undecided:
            if not any(gain.overlaps(ball(end)) for end in self.limits):
                self.leave_open(omega)
        crossings += [Crossing(gain, (omega,), is_open=True, change=None) for omega, gain in points.undecided]
        return crossings + [Crossing(gain, (omega,), change=None) for omega, gain in points.proved]


def _right_but(points: DegeneratePoints, side: Side, circle: float) -> int:
    """Return the poles on the right up to a circle, without roots of the formula where wavenumbers meet."""
    if side.bound.sheets > 1:
        poles, reason = growing(side, points, (), is_hidden=False)
    else:
        found = search_right(side, (), 0.0, circle)
        poles = [root for root in found.roots if not points.is_spurious(root, is_hidden=False)]
        reason = found.unproved or points.unproved
    if reason:
        raise UncertifiedError(Diagnostic("SF802", reason))
    return count_right(poles)
