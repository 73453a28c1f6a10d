"""Responses of distributed systems as sums over modes: how many, and what the rest may add.

Input: a bound transfer function with waves, and a bound of its modes beyond a radius.
Output: enclosed values, whose radius is proved.

    y(t)  =  principal part at s = 0  +  sum over poles  +  the modes left out

The first two are balls. What is left out is bounded for beams that lose nothing, see
:mod:`~symflex.analysis.time_response.lossless_modes`, for all that loses energy in the material of its beams
and rods, loops about them too, see :mod:`~symflex.analysis.time_response.lossy_modes`, and for all that a
force moves where nothing else supplies energy, see :mod:`~symflex.analysis.time_response.passive_modes`.
"""

from __future__ import annotations

from cmath import sqrt as csqrt
from collections.abc import Callable, Mapping, Sequence
from math import log, pi

from flint import acb, arb

from symflex.analysis.rational.laurent import LaurentSeries, PrincipalPart, expand_at_zero, residues_at
from symflex.analysis.time_response.effort import EFFORT
from symflex.analysis.time_response.function_size import Annulus, ModesBound, Ring
from symflex.analysis.time_response.lossless_modes import lossless_modes
from symflex.analysis.time_response.lossy_modes import lossy_bound
from symflex.analysis.time_response.partial_fractions import ExponentialTerm, values_of
from symflex.analysis.time_response.passive_modes import passive_bound
from symflex.analysis.time_response.sample_times import SampleTimes
from symflex.analysis.time_response.sampled import PartialSum, Refused
from symflex.balls import bits_for_digits, precision
from symflex.errors import BudgetError, UncertifiedError
from symflex.roots import Modes, Root
from symflex.roots.counting.winding import Cell, RootOnPathError
from symflex.roots.degenerate import degenerate_points
from symflex.roots.distributed.side import Side
from symflex.roots.engines import LOSSLESS
from symflex.roots.plane.local_roots import prove_simple
from symflex.roots.polynomial_roots import in_order
from symflex.roots.root import overlap
from symflex.transfer import AnyBoundFunction, BoundTransferFunction

SEARCHED_TOO_LONG = "SF505"  # of a search that ends by itself; the user's own budgets end all
BITS = bits_for_digits(2 * EFFORT.pole_digits)  # precision of terms
SUM_BITS = EFFORT.bits  # of their sums, which need the digits of poles and none of those that residues lose
CONTINUATION = (-1, 4, -6, 4)  # factors on the last four of a smooth sequence that give the next

BOUNDS: Mapping[str, Callable[[BoundTransferFunction, int], tuple[ModesBound, int] | Refused]] = {
    "lossless modes": lossless_modes,
    "lossy modes": lossy_bound,
    "passive modes": passive_bound,
}  # on modes beyond a radius, for impulses integrated so often, in turn


def proved_modes(
    bound: BoundTransferFunction, integrations: int, times: SampleTimes, digits: int, most: int | None = None
) -> PartialSum | None:
    """Return a sum over at most so many modes with a bound of those left out; None if there is none."""
    for find in BOUNDS.values():
        bounding = find(bound, integrations)
        if not isinstance(bounding, Refused):
            total = summed(*bounding, times, digits, most)
            if total is not None:
                return total
    return None


def summed(
    bounding: ModesBound, integrations: int, times: SampleTimes, digits: int, limit: int | None = None
) -> PartialSum | None:
    """Return the sum over so many modes that what is left is within the digits, or as little as can be."""
    modes = BoundedModes(bounding, integrations, times)
    few, many = EFFORT.first_modes
    first = modes.summed(few)
    if first is None:
        return None
    goal = EFFORT.enough * float(first.largest) * 10.0 ** -min(digits, EFFORT.mode_digits)
    partial = first if first.left <= goal else modes.summed(many)
    if partial is None:
        return first if modes.is_exhausted else None
    counts = few, many
    for _ in range(EFFORT.rounds if partial is not first else 0):
        wanted = _needed(
            (counts[0], float(first.left)), (counts[1], float(partial.left)), goal, bounding.most
        )
        wanted = min(bounding.slow, wanted) if wanted == bounding.most else wanted
        wanted = min(wanted, limit or wanted)
        falls = bool(partial.left < first.left)
        more = modes.summed(wanted) if falls and wanted > counts[1] else None
        if more is None:
            break
        counts, first, partial = (counts[1], wanted), partial, more
    return partial


class BoundedModes:
    """The lowest modes of a system, found as many as asked for."""

    def __init__(self, bounding: ModesBound, integrations: int, times: SampleTimes) -> None:
        self._bounding, self._integrations, self._times = bounding, integrations, times
        self._bound = bounding.bound
        self._side = Side(self._bound, self._bound.den, EFFORT.pole_digits)
        self._degenerate = degenerate_points(self._bound)
        self._zeros = Side(self._bound, self._bound.num, EFFORT.pole_digits)
        self._rings: dict[Cell, Ring] = {}
        self._known: dict[float, PartialSum] = {}
        # What one count of modes found serves the next: roots from one reach on, and terms of roots.
        self._begun = 0.0
        self._added: list[Root] = []
        self._terms: dict[int, tuple[Root, ExponentialTerm]] = {}
        self.is_exhausted = False  # whether a search for more modes ended by itself

    def summed(self, count: int) -> PartialSum | None:
        """Return the sum over so many modes, fewer if hard to find, more if bounds start late; else None."""
        try:
            return self._summed(count)
        except BudgetError as error:
            if any(d.code != SEARCHED_TOO_LONG for d in error.diagnostics):
                raise
            self.is_exhausted = True
            return None

    def _summed(self, count: int) -> PartialSum | None:
        least = self._bounding.least
        located = None if self._side.is_finite else self._located(count)
        if located is None:
            return None
        reached, roots = located
        if reached in self._known:
            return self._known[reached]
        origin = proved_at_origin(self._bound, self._integrations)
        tail = self._bounding.rest(reached, self._integrations, self._times) if reached >= least else None
        if origin is None or tail is None:
            return None
        with precision(BITS):
            radius = arb(reached).exp()
            poles = self._poles(roots, radius)
            around = self._about_accumulations(reached, poles)
            if around is None:
                return None
            rings, terms, missing = around
            terms = [*origin, *terms]
            for root in poles:
                within = [ring.holds(root.enclosure()) for ring in rings]
                if None in within or not (root.certified and root.natural_frequency() < radius):
                    return None
                if any(within):
                    continue
                term = self._term(root)
                if term is None:
                    return None
                terms.append(term)
            with precision(SUM_BITS):
                values = values_of(terms, self._times)
            bounds = [bound + missing for bound in tail.at_times]
            if tail.start is not None and self._times.seconds[0] == 0:
                values[0], bounds[0] = tail.start, arb(0)
            total = PartialSum(
                tuple(terms),
                tuple(values),
                (tail.always + missing).upper(),
                tuple(bound.upper() for bound in bounds),
                min((tail.fade, *(ring.fade for ring in rings)), key=arb.mid).lower(),
                self._bounding.name,
            )
            return self._known.setdefault(reached, total)

    def _term(self, root: Root) -> ExponentialTerm | None:
        """Return what a pole and its conjugate add."""
        if id(root) in self._terms:
            return self._terms[id(root)][1]
        term = self._bounding.term(root, self._integrations) or term_at(self._bound, root, self._integrations)
        if term is not None:
            self._terms[id(root)] = root, term
        return term

    def _located(self, count: int) -> tuple[float, list[Root]] | None:
        """Return ln of a radius and all roots within, at most so many as are searched; None if unsure."""
        side, is_lossless = self._side, self._side.engine == LOSSLESS
        if count > max(EFFORT.first_modes) and not is_lossless:
            continued = self._continued(count)
            if continued is not None:
                return continued
        wanted = Modes(min(count, EFFORT.axis_modes if is_lossless else EFFORT.plane_modes))
        side.extend(wanted.count, self._bounding.least)
        with precision(BITS):
            poles = self._poles(side.roots, arb(side.reached).exp())
            # To prove that none is missing takes long, and is in vain where a ring does not fit.
            if self._about_accumulations(side.reached, poles) is None:
                return None
        return (side.reached, side.roots) if side.prove(wanted).is_complete else None

    def _about_accumulations(
        self, reached: float, poles: Sequence[Root]
    ) -> tuple[list[Annulus], list[ExponentialTerm], arb] | None:
        """Return rings about what poles accumulate at within a radius, what they add, and what that lacks."""
        rings, terms, missing = [], [], arb(0)
        within = arb(reached).exp()
        for hole in self._side.holes:
            if hole.low > reached:
                continue
            ring = self._rings.get(hole)
            if ring is None:
                ring = self._bounding.ring(hole, [p.enclosure() for p in poles], within, self._integrations)
            if ring is None or not ring[0].reach < within:
                return None
            self._rings[hole] = ring
            rings.append(ring[0])
            terms += ring[1]
            missing += ring[2]
        return rings, terms, missing

    def _continued(self, count: int) -> tuple[float, list[Root]] | None:
        """Return ln of a radius and all roots within, those found so far continued; None if that fails.

        Square roots of high poles of bending, of waves damped in the material too, are evenly spaced, nearly,
        so each is next to where the last four point to. That none is missing a count of the ring says.
        """
        side = self._side
        if any(hole.high > side.reached for hole in side.holes) or side.function.power != 1:
            return None
        begun = in_order([root for root in side.roots if root.natural_frequency().log() < side.reached])
        chain = [root for root in begun if not root.im < 0 and not root.re > 0 and not root.is_zero]
        if not len(CONTINUATION) <= len(chain) <= count:
            return None
        try:
            within = side.winding.count_within(side.reached, pi)
            if self._begun != side.reached:
                self._begun, self._added = side.reached, []
            added = self._added
            places = [_root_of(root) for root in [*chain, *added][-len(CONTINUATION) :]]
            while len(chain) + len(added) <= count:
                guess = sum(c * z for c, z in zip(CONTINUATION, places, strict=True))
                proved = prove_simple(side.function, acb(guess**2), EFFORT.pole_digits)
                if proved is None or not proved.certified:
                    return None
                places = [*places[1:], _root_of(proved)]
                if not abs(places[-1] - guess) < EFFORT.next_to * abs(places[-1] - places[-2]):
                    return None
                added.append(proved)
            ends = [float(root.natural_frequency().log().mid()) for root in added[-2:]]
            reached = sum(ends) / len(ends)
            between = sum(1 if root.is_real else 2 for root in added[:-1])
            if side.winding.count_within(reached, pi) != within + between:
                return None
        except RootOnPathError:
            return None
        return reached, [*begun, *added[:-1]]

    def _poles(self, roots: Sequence[Root], radius: arb) -> list[Root]:
        """Return the roots of the denominator, in the upper half-plane, that may be poles within a radius."""
        within = (r for r in roots if not (r.is_zero or r.im < 0 or r.natural_frequency() > radius))
        return [r for r in within if self._bounding.may_be_pole(r) and not self._is_removable(r)]

    def _is_removable(self, root: Root) -> bool:
        """Tell whether numerator and denominator share a root where wavenumbers vanish or meet."""
        if not any(overlap(root, point) for point in self._degenerate):
            return False
        self._zeros.extend(0, float(root.natural_frequency().log().mid()) + EFFORT.beside)
        return any(
            overlap(zero, root) and zero.multiplicity >= root.multiplicity for zero in self._zeros.roots
        )


def _root_of(pole: Root) -> complex:
    """Return the square root of a pole in the second quadrant."""
    return csqrt(complex(float(pole.re.mid()), abs(float(pole.im.mid()))))


def term_at(bound: BoundTransferFunction, root: Root, integrations: int) -> ExponentialTerm | None:
    """Return what a pole and its conjugate add; None if it is not distinguished from other points."""
    try:
        (part,) = residues_at(bound, [root], EFFORT.pole_digits)
    except UncertifiedError:
        return None
    return None if part.is_estimate else term_of(part, integrations)


def term_of(part: PrincipalPart, integrations: int) -> ExponentialTerm:
    """Return what a principal part and that of the conjugate pole add."""
    share = 1 if part.root.is_real else 2
    coefficients = over_powers(part.pole, part.coefficients, integrations)
    return ExponentialTerm(part.pole, tuple(share * c for c in coefficients))


def _needed(few: tuple[int, float], many: tuple[int, float], goal: float, most: int = 2000) -> int:
    """Return about how many modes bring a bound below a goal, from two counts and their bounds.

    >>> _needed((10, 8.0), (20, 1.0), 1 / 8)  # it falls with the third power
    46
    """
    if many[1] <= goal:
        return many[0]
    # Far out bounds fall less than between few modes.
    power = 0.95 * log(few[1] / many[1]) / log(many[0] / few[0])
    if not (goal > 0 and power > 0):
        return most
    # Logarithms, as a power of a small number may overflow.
    growth = log(many[1] / goal) / power
    return min(most, round(1.1 * many[0] * 2 ** min(growth / log(2), 20)))


def proved_at_origin(bound: AnyBoundFunction, integrations: int) -> list[ExponentialTerm] | None:
    """Return what the pole at s = 0 adds; None if that is not proved."""
    series = expand_at_zero(bound, integrations - 1, EFFORT.pole_digits)
    return None if series.is_estimate else at_origin(series, integrations)


def at_origin(series: LaurentSeries, integrations: int) -> list[ExponentialTerm]:
    """Return what the pole at s = 0 adds, a polynomial in t."""
    count = integrations - series.order
    if count <= 0:
        return []
    coefficients = tuple(series.coefficient(integrations - 1 - j) for j in range(count))
    return [ExponentialTerm(acb(0), coefficients)]


def over_powers(pole: acb, coefficients: tuple[acb, ...], integrations: int) -> list[acb]:
    """Return a principal part divided by ``s^integrations``.

    >>> [complex(c) for c in over_powers(acb(2), (acb(1), acb(4)), 1)]  # 1/x + 4/x^2, over 2 + x
    [(-0.5+0j), (2+0j)]
    """
    divided = list(coefficients)
    for _ in range(integrations):
        # With s = p + x: the part of 1/x^k over p + x begins with c_k/p, and takes from those before it.
        for k in range(len(divided) - 1, -1, -1):
            above = divided[k + 1] if k + 1 < len(divided) else acb(0)
            divided[k] = (divided[k] - above) / pole
    return divided
