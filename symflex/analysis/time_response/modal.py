"""Responses of distributed systems as sums over modes: how many, and what the rest may add.

Input: a bound transfer function with waves. Output: enclosed values, and whether their radius is proved.

    y(t)  =  principal part at s = 0  +  sum over poles  +  the modes left out

The first two are balls. What is left out is bounded for beams that lose nothing, see
:mod:`~symflex.analysis.time_response.lossless_modes`, for all that a force moves where nothing else
supplies energy, see :mod:`~symflex.analysis.time_response.passive_modes`, and for all that loses energy in
the material of its beams and rods, loops about them too, see
:mod:`~symflex.analysis.time_response.lossy_modes`. For others it is estimated from the last residues, and the
response is not certified.
"""

from __future__ import annotations

from cmath import sqrt as csqrt
from dataclasses import dataclass, replace
from math import log, pi
from typing import TYPE_CHECKING

from flint import acb, arb

from symflex.algebra import Factored
from symflex.analysis.rational.laurent import LaurentSeries, expand_at_zero, residues_at
from symflex.analysis.time_response.echoes import Sampled
from symflex.analysis.time_response.exponentials import ExponentialTerm, values_of
from symflex.analysis.time_response.function_size import ZERO, SizeOfExponentials
from symflex.analysis.time_response.lossless_modes import LosslessModes, lossless_modes
from symflex.analysis.time_response.lossy_modes import LossyBound, lossy_bound
from symflex.analysis.time_response.passive_modes import PassiveBound, passive_bound
from symflex.budget import entered_budget, spend
from symflex.errors import BudgetError, Diagnostic, UncertifiedError
from symflex.roots.counting.argument_principle import CertifiedWinding
from symflex.roots.counting.winding import RootOnPathError
from symflex.roots.distributed.proof import holes_about
from symflex.roots.distributed.side import Side, accumulation_points
from symflex.roots.engines import LOSSLESS
from symflex.roots.locate import locate
from symflex.roots.plane.local_roots import prove_simple
from symflex.roots.polynomial_roots import in_order
from symflex.roots.precision import bits_for_digits, precision
from symflex.roots.region import Modes
from symflex.transfer import BoundNested

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.analysis.time_response.function_size import Annulus, Ring
    from symflex.analysis.time_response.sample_times import SampleTimes
    from symflex.roots import Root
    from symflex.roots.counting.winding import Cell
    from symflex.transfer import AnyBoundFunction, BoundTransferFunction

MOST_DIGITS = 9
"""Of the largest value, where modes have no end: 10^-9 takes some 500 of a beam's displacement."""
DIGITS = 24
"""Of poles: those of a double, and what the phase loses after some million turns."""
FIRST_MODES = (16, 32)
"""From whose bounds it is told how many modes it takes."""
MOST_MODES = 2000
"""Velocities fall off so slowly that no number of modes is enough; so many are searched at most."""
MOST_SEARCHED = 100
"""The same where each is searched in the plane, and does not follow from others: that takes some seconds."""
SEARCHED_TOO_LONG = "SF505"
"""The code of a search that ends by itself, next to roots that accumulate; the user's own budgets end all."""
MOST_CONTINUED = 5000
"""The same where each is told by those before: a millisecond or two."""
LONG = 100
"""Exponentials of a function of which no more are searched than at first: a portal frame has 274."""
SLOW_MODES = 1000
"""Where even these would not do."""
ROUNDS = 3
"""Of telling how many it takes."""
ENOUGH = 0.8
"""Of the radius allowed: the rest is for what values are known to."""
AIMED_AT = 0.7
"""Of what is enough: bounds fall off more slowly than those of the first modes do."""
CONTINUATION = (-1, 4, -6, 4)
"""By what the last four of a smooth sequence are multiplied to give the next."""
NEXT_TO = 0.05
"""How far from there it may be, over the last step."""
ESTIMATED_MODES = 25
"""Where the rest is estimated."""
FEW_ESTIMATED = 12
"""Modes of a network tried first: 25 modes of two links with loss in the material take a minute."""
LITTLE = 1e-3
"""Estimated rest over the largest value below which these few are enough."""
HOPELESS = 10
"""Estimated rest over the largest value above which more modes do not help."""
LAST_MODES = 5
"""From whose residues the rest is estimated."""
SLOWEST = 0.9
"""Half of a sum over that of the quarter before: it falls off so slowly that nothing is said beyond."""
FAR = 100
"""Of the highest pole, where the transfer function shows how a response begins; 1 where members taper."""
MOST_BITS = 16_384
"""Highest precision with which that value is computed."""
CLOSELY = 1e-12
"""Radius of that value over the largest term, at which it is known well enough."""
SURER = 2
"""By what the lack at t = 0 is multiplied: terms that differ in sign may add up to more later."""
TOO_MUCH = 0.3
"""Estimated rest over the largest value from which on the modes say nothing at a time."""


def proved_modes(
    bound: BoundTransferFunction, integrations: int, times: SampleTimes, digits: int
) -> PartialSum | None:
    """Return a sum over modes with a proved bound of those left out; None where there is none.

    A step of a velocity is an impulse of a displacement, and so a function over s is tried as well.
    """
    found = _of_proved_modes(bound, integrations, times, digits)
    if found is None and integrations:
        s = Factored.generator(bound.ratio.ring, "s")
        over_s = replace(bound, ratio=bound.ratio / s, parts=(bound.num, bound.den * s))
        found = _of_proved_modes(over_s, integrations - 1, times, digits)
    for modes in (lossy_modes, _of_passive_modes):
        found = modes(bound, integrations, times, digits) if found is None else found
    return found


def lossy_modes(
    bound: BoundTransferFunction, integrations: int, times: SampleTimes, digits: int
) -> PartialSum | None:
    """Return the same where all waves lose energy in the material, of functions of any model."""
    bounding = lossy_bound(bound)
    return None if bounding is None else _of_bounded(bounding, integrations, times, digits)


def _of_proved_modes(
    bound: BoundTransferFunction, integrations: int, times: SampleTimes, digits: int
) -> PartialSum | None:
    modes = lossless_modes(bound, DIGITS)
    if modes is None:
        return None
    few, many = FIRST_MODES
    first, second = modes.lowest(few), modes.lowest(many)
    if first is None or second is None:
        return None
    bounds = [modes.rest(reached, integrations) for _, reached in (first, second)]
    found = _summed(bound, modes, many, integrations, times)
    if bounds[0] is None or bounds[1] is None or found is None:
        return None
    largest = max((abs(y.mid()) for y in found.values), default=arb(0))
    goal = ENOUGH * float(largest) * 10.0 ** -min(digits, MOST_DIGITS)
    count = _needed((few, float(bounds[0])), (many, float(bounds[1])), AIMED_AT * goal)
    for _ in range(ROUNDS):
        if count <= many:
            break
        turned = float(second[0][-1].im.mid()) * (count / many) ** 2 * float(times.seconds[-1])
        lost = max(0, int(log(turned + 1, 10)) - (DIGITS - 16))
        finer = lossless_modes(bound, DIGITS + lost) if lost else modes
        found = None if finer is None else _summed(bound, finer, count, integrations, times)
        if found is None or count == MOST_MODES or not goal > 0 or found.left <= goal:
            break
        # It fell off more slowly than it had begun to, so at least with the first power.
        count = round(min(MOST_MODES, count * float(found.left) / goal + 1))
    return found


def _of_passive_modes(
    bound: BoundTransferFunction, integrations: int, times: SampleTimes, digits: int
) -> PartialSum | None:
    """Return the same for a passive model, from its energy."""
    bounding = passive_bound(bound)
    return None if bounding is None else _of_bounded(bounding, integrations, times, digits)


def _of_bounded(
    bounding: PassiveBound | LossyBound, integrations: int, times: SampleTimes, digits: int
) -> PartialSum | None:
    """Return the sum over so many modes that what is left is within the digits, or as little as can be."""
    modes = BoundedModes(bounding, integrations, times)
    few, many = FIRST_MODES
    first = modes.summed(few)
    if first is None:
        return None
    largest = max((abs(y.mid()) for y in first.values), default=arb(0))
    goal = float(largest) * 10.0 ** -min(digits, MOST_DIGITS)
    found = first if first.left <= goal else modes.summed(many)
    if found is None:
        return first if modes.is_exhausted else None
    counts = few, many
    most = MOST_CONTINUED if bounding.function.length <= LONG else many
    for _ in range(ROUNDS if found is not first else 0):
        wanted = _needed((counts[0], float(first.left)), (counts[1], float(found.left)), goal, most)
        wanted = min(SLOW_MODES, most) if wanted == most else wanted
        falls = bool(found.left < first.left)
        more = modes.summed(wanted) if falls and wanted > counts[1] else None
        if more is None:
            break
        counts, first, found = (counts[1], wanted), found, more
    return found


@dataclass(frozen=True, slots=True)
class PartialSum:
    """The sum over some modes, at all times, and how much all others add at most."""

    terms: tuple[ExponentialTerm, ...]
    values: tuple[arb, ...]  # of the terms, at all times
    rest: arb  # at any time
    at_times: tuple[arb, ...] = ()  # at each of the times, where that is less
    fade: arb = ZERO  # at a time t [s] exp(-fade t) times the rest is left, at most [1/s]
    method: str = "estimated modes"  # what bounds the rest, such as ``passive modes``
    count: int = ESTIMATED_MODES  # of modes, where it is estimated

    @property
    def left(self) -> arb:
        """The most that is left at any of the times."""
        return max(self.at_times, default=self.rest, key=arb.mid).upper()

    @property
    def sampled(self) -> Sampled:
        """The response, with what is left out as part of its balls."""
        rests = self.at_times or (self.rest,) * len(self.values)
        pairs = zip(self.values, rests, strict=True)
        values = tuple(y + arb(0, rest.upper()) for y, rest in pairs)
        return Sampled(values, modes=self, method=self.method)


class BoundedModes:
    """The lowest modes of a system, found as many as asked for."""

    def __init__(self, bounding: PassiveBound | LossyBound, integrations: int, times: SampleTimes) -> None:
        self._bounding, self._integrations, self._times = bounding, integrations, times
        self._bound = bounding.function.bound
        self._side = Side(self._bound, self._bound.den, DIGITS, entered_budget())
        self._rings: dict[Cell, Ring] = {}
        self._known: dict[float, PartialSum] = {}
        self.is_exhausted = False  # whether a search for more modes ended by itself

    def summed(self, count: int) -> PartialSum | None:
        """Return the sum over so many modes, None where it is not proved.

        Where they are hard to find, fewer are taken; where the bound holds farther out only, more.
        """
        side, least = self._side, self._bounding.least
        if side.is_finite:
            return None
        continued = self._continued(count) if count > max(FIRST_MODES) and side.engine != LOSSLESS else None
        if continued is not None:
            reached, roots = continued
        else:
            wanted = Modes(min(count, MOST_MODES if side.engine == LOSSLESS else MOST_SEARCHED))
            try:
                side.extend(wanted.count, least)
                is_complete = side.prove(wanted).is_complete
            except BudgetError as error:
                if any(d.code != SEARCHED_TOO_LONG for d in error.diagnostics):
                    raise
                self.is_exhausted = True
                return None
            if not is_complete:
                return None
            reached, roots = side.reached, side.roots
        if reached in self._known:
            return self._known[reached]
        origin = _proved_at_origin(self._bound, self._integrations)
        rest = self._bounding.rest(reached, self._integrations, self._times) if reached >= least else None
        if origin is None or rest is None:
            return None
        with precision(bits_for_digits(2 * DIGITS)):
            radius = arb(reached).exp()
            poles = [root for root in roots if self._may_be_pole(root, radius)]
            around = self._about_accumulations(reached, [p.enclosure() for p in poles])
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
                term = _term_at(self._bound, root, self._integrations)
                if term is None:
                    return None
                terms.append(term)
            values = values_of(terms, self._times)
            left = [own + missing for own in rest.at_times]
            if rest.start is not None and self._times.seconds[0] == 0:
                values[0], left[0] = rest.start, arb(0)
            total = PartialSum(
                tuple(terms),
                tuple(values),
                (rest.always + missing).upper(),
                tuple(own.upper() for own in left),
                min((rest.fade, *(ring.fade for ring in rings)), key=arb.mid).lower(),
                "passive modes" if isinstance(self._bounding, PassiveBound) else "lossy modes",
            )
            return self._known.setdefault(reached, total)

    def _about_accumulations(
        self, reached: float, poles: list[acb]
    ) -> tuple[list[Annulus], list[ExponentialTerm], arb] | None:
        """Return rings about what poles accumulate at within a radius, what they add, and what that lacks."""
        rings, terms, missing = [], [], arb(0)
        for hole in self._side.holes:
            if hole.low > reached:
                continue
            found = self._rings.get(hole)
            if found is None:
                found = self._bounding.function.around(hole, poles, self._integrations)
            if found is None or not found[0].reach < arb(reached).exp():
                return None
            self._rings[hole] = found
            rings.append(found[0])
            terms += found[1]
            missing += found[2]
        return rings, terms, missing

    def _continued(self, count: int) -> tuple[float, list[Root]] | None:
        """Return ln of a radius and all roots within, those found so far continued; None where that fails.

        Square roots of high poles of bending, of waves damped in the material too, are evenly spaced, nearly,
        so each is next to where the last four point to. That none is missing a count of the ring says.
        """
        side = self._side
        if any(hole.high > side.reached for hole in side.holes) or side.function.power != 1:
            return None
        begun = in_order([root for root in side.roots if root.natural_frequency().log() < side.reached])
        chain = [root for root in begun if not root.im < 0 and not root.re > 0 and not root.is_zero]
        if len(chain) < len(CONTINUATION):
            return None
        winding = CertifiedWinding(side.function, entered_budget())
        try:
            within = winding.count_within(side.reached, pi)
            places = [_root_of(root) for root in chain[-len(CONTINUATION) :]]
            added: list[Root] = []
            while len(chain) + len(added) <= count:
                place = sum(c * z for c, z in zip(CONTINUATION, places, strict=True))
                found = prove_simple(side.function, acb(place**2), DIGITS)
                if found is None or not found.certified:
                    return None
                places = [*places[1:], _root_of(found)]
                if not abs(places[-1] - place) < NEXT_TO * abs(places[-1] - places[-2]):
                    return None
                added.append(found)
            ends = [float(root.natural_frequency().log().mid()) for root in added[-2:]]
            reached = sum(ends) / len(ends)
            between = sum(1 if root.is_real else 2 for root in added[:-1])
            if winding.count_within(reached, pi) != within + between:
                return None
        except RootOnPathError:
            return None
        return reached, [*begun, *added[:-1]]

    def _may_be_pole(self, root: Root, radius: arb) -> bool:
        """Tell whether a root of the denominator, in the upper half plane, may be a pole within a radius.

        Where nothing supplies energy none is right of the axis; without losses none is left of it either.
        """
        if root.is_zero or root.im < 0:
            return False
        function = self._bounding.function
        if self._bounding.is_passive and (root.re > 0 or (root.re < 0 and function.is_even)):
            return False
        return not root.natural_frequency() > radius


def _root_of(pole: Root) -> complex:
    """Return the square root of a pole in the second quadrant."""
    return csqrt(complex(float(pole.re.mid()), abs(float(pole.im.mid()))))


def _term_at(bound: BoundTransferFunction, root: Root, integrations: int) -> ExponentialTerm | None:
    """Return what a pole and its conjugate add; None where it is not told from other points."""
    try:
        (part,) = residues_at(bound, [root], DIGITS)
    except UncertifiedError:
        return None
    if part.is_estimate:
        return None
    share = 1 if root.is_real else 2
    found = _over_powers(part.pole, part.coefficients, integrations)
    return ExponentialTerm(part.pole, tuple(share * c for c in found))


def _summed(
    bound: BoundTransferFunction, modes: LosslessModes, count: int, integrations: int, times: SampleTimes
) -> PartialSum | None:
    lowest = modes.lowest(count)
    origin = _proved_at_origin(bound, integrations)
    if lowest is None or origin is None:
        return None
    roots, reached = lowest
    rest = modes.rest(reached, integrations)
    with precision(modes.bits):
        terms = [modes.term(root, integrations) for root in roots]
        known = [term for term in terms if term is not None]
        if rest is None or len(known) < len(terms):
            return None
        # Poles are known to half of the bits, and their sum is no better than these.
        with precision(modes.bits // 2):
            values = values_of([*origin, *known], times)
        return PartialSum((*origin, *known), tuple(values), rest, method="lossless modes")


def _needed(few: tuple[int, float], many: tuple[int, float], goal: float, most: int = MOST_MODES) -> int:
    """Return about how many modes bring a bound below a goal, from two counts and their bounds.

    Examples
    --------
    >>> _needed((10, 8.0), (20, 1.0), 1 / 8)  # it falls with the third power
    48
    """
    if many[1] <= goal:
        return many[0]
    power = log(few[1] / many[1]) / log(many[0] / few[0])
    if not (goal > 0 and power > 0):
        return most
    # Logarithms, as a power of a small number may overflow.
    growth = log(many[1] / goal) / power
    return min(most, round(1.2 * many[0] * 2 ** min(growth / log(2), 20)))


def _proved_at_origin(bound: AnyBoundFunction, integrations: int) -> list[ExponentialTerm] | None:
    series = expand_at_zero(bound, integrations - 1, DIGITS)
    return None if series.is_estimate else _at_origin(series, integrations)


def _at_origin(series: LaurentSeries, integrations: int) -> list[ExponentialTerm]:
    """Return what the pole at s = 0 adds, a polynomial in t."""
    count = integrations - series.order
    if count <= 0:
        return []
    coefficients = tuple(series.coefficient(integrations - 1 - j) for j in range(count))
    return [ExponentialTerm(acb(0), coefficients)]


def estimated(bound: AnyBoundFunction, integrations: int, times: SampleTimes) -> tuple[Sampled, str]:
    """Return the sum over the lowest modes, and what is not proved of it.

    Raises UncertifiedError: SF810 where modes do not say what the response is.
    """
    found = estimated_modes(bound, integrations, times)
    sampled = found.sampled
    largest = max((abs(y.mid()) for y in sampled.values), default=arb(0))
    told = sum(bool(y.rad() < TOO_MUCH * largest) for y in sampled.values)
    if 2 * told < len(sampled.values):
        raise _said_nothing(bound, integrations)
    return sampled, f"what the modes beyond the lowest {found.count} add is estimated"


def _said_nothing(bound: AnyBoundFunction, integrations: int) -> UncertifiedError:
    message = f"the modes of {bound.name} fall off too slowly to say what it does in time"
    # The smoother the input is, the less high modes add.
    smoother = ("a step in place of an impulse", "a ramp in place of a step")[integrations : integrations + 1]
    hint = " or ".join([*(f"ask for {each}," for each in smoother), "filter the output"])
    return UncertifiedError(Diagnostic("SF810", message, None, hint))


def estimated_modes(bound: AnyBoundFunction, integrations: int, times: SampleTimes) -> PartialSum:
    """Return the sum over the lowest modes, whose rest is estimated: how much it is, and how it fades.

    Higher modes are taken to fade no more slowly than the slowest of the upper half of those found.
    """
    if isinstance(bound, BoundNested):
        few = _estimated_sum(bound, integrations, times, FEW_ESTIMATED)
        largest = max((abs(y.mid()) for y in few.values), default=arb(0))
        left = sorted(few.at_times or (few.rest,), key=arb.mid)
        typical = left[len(left) // 2]
        if typical < LITTLE * largest or not typical < HOPELESS * largest:
            return few
    return _estimated_sum(bound, integrations, times, ESTIMATED_MODES)


def _estimated_sum(bound: AnyBoundFunction, integrations: int, times: SampleTimes, count: int) -> PartialSum:
    """Return the sum over so many modes."""
    # Zeros matter in residues alone; to find them takes as long as to find the poles.
    located = locate(bound, Modes(count), DIGITS, with_zeros=False).complete()
    poles = [root for root in located.all_poles if not root.im < 0 and not root.is_zero]
    rings = _rings(bound, poles, integrations)
    apart = [root for root in poles if not any(ring.holds(root.enclosure()) for ring, _, _ in rings)]
    parts = residues_at(bound, apart, DIGITS)
    with precision(bits_for_digits(2 * DIGITS)):
        origin = _at_origin(expand_at_zero(bound, integrations - 1, DIGITS), integrations)
        terms = []
        for part in parts:
            share = 1 if part.root.is_real else 2
            found = _over_powers(part.pole, part.coefficients, integrations)
            terms.append(ExponentialTerm(part.pole, tuple(share * c for c in found)))
        sizes = [float(abs(term.coefficients[0]).upper()) for term in terms]
        upper = [term.rate.real for term in terms[len(terms) // 2 :]]
        terms += [term for _, around, _ in rings for term in around]
        upper += [term.rate.real for _, around, _ in rings for term in around]
        values = values_of([*origin, *terms], times)
        rest = arb(_estimated_rest(sizes)) + sum((missing for _, _, missing in rings), arb(0))
        at_times: tuple[arb, ...] = ()
        if terms:
            # At t = 0 it is known what all modes add up to. A taper so far beyond its modes takes gigabytes.
            tapers = not isinstance(bound, BoundNested) and any(
                kernel.function == "entry" for kernel in bound.kernels.kernels
            )
            far = (1 if tapers else FAR) * max(abs(term.rate).upper() for term in terms)
            small = CLOSELY * max(sizes, default=0.0)
            begun, sooner = (_begun(bound, integrations, s.mid(), small) for s in (far, far / 2))
            at_once = sum((term.coefficients[0] for term in (*origin, *terms)), acb(0)).real
            rest += SURER * abs(at_once - begun)
            slowest = max(upper, key=arb.mid).min(0)
            at_times = tuple(rest * (slowest * t).exp() for t in times.enclosed())
            if times.seconds[0] == 0 and slowest < 0 and abs(begun) <= abs(sooner):
                # What fades begins smoothly: only at t = 0 itself do the modes not say more.
                values[0] = begun + arb(0, SURER * abs(begun - sooner).upper())
                at_times = (arb(0), *at_times[1:])
        return PartialSum((*origin, *terms), tuple(values), rest, at_times, count=count)


def _begun(bound: AnyBoundFunction, integrations: int, far: arb, small: float) -> arb:
    """Return what a response begins with, as far as the transfer function at a large s shows it.

    It is known to something ``small``, or to as many digits.
    """
    bits = bits_for_digits(2 * DIGITS)
    # Between many members exponentials take each other out, and so far out these are large.
    while True:
        spend()
        found = (bound.enclosed(bits)(acb(far)) / far ** (integrations - 1)).real
        if found.rad() <= max(small, CLOSELY * float(abs(found).mid())) or bits >= MOST_BITS:
            return found
        bits *= 2


def _rings(bound: AnyBoundFunction, poles: Sequence[Root], integrations: int) -> list[Ring]:
    """Return what poles add that accumulate, as about -1/eta, as far as all others on a ring are known."""
    function = None if isinstance(bound, BoundNested) else SizeOfExponentials.of(bound)
    if function is None:
        return []
    reached = max((root.natural_frequency() for root in poles), default=arb(0), key=arb.mid)
    enclosures = [root.enclosure() for root in poles]
    holes = holes_about(accumulation_points(function.bound))
    found = [function.around(hole, enclosures, integrations) for hole in holes]
    rings = [ring for ring in found if ring is not None and ring[0].reach < reached]
    return [ring for ring in rings if None not in map(ring[0].holds, enclosures)]


def _estimated_rest(sizes: Sequence[float]) -> float:
    """Return what terms beyond may add at most, if they go on to fall off as those between did.

    They may all have one sign. Where their sizes fall with a power of their number, sums over one half, the
    quarter before and all beyond are a geometric sequence. Of several families, such as two beams', some
    hardly move what is seen; in order of their sizes these come last.

    Examples
    --------
    >>> round(_estimated_rest([1 / n**2 for n in range(1, 65)]), 3)  # all beyond are 0.0155
    0.018
    """
    count = len(sizes)
    falling = sorted(sizes, reverse=True)
    half, quarter = sum(falling[count // 2 :]), sum(falling[count // 4 : count // 2])
    ratio = half / quarter if quarter else 0.0
    beyond = half * ratio / (1 - ratio) if ratio < SLOWEST else half * SLOWEST / (1 - SLOWEST)
    return max(beyond, count * max(sizes[-LAST_MODES:], default=0.0))


def _over_powers(pole: acb, coefficients: tuple[acb, ...], integrations: int) -> list[acb]:
    """Return a principal part divided by ``s^integrations``.

    Examples
    --------
    >>> [complex(c) for c in _over_powers(acb(2), (acb(1), acb(4)), 1)]  # 1/x + 4/x^2, over 2 + x
    [(-0.5+0j), (2+0j)]
    """
    found = list(coefficients)
    for _ in range(integrations):
        # With s = p + x: the part of 1/x^k over p + x begins with c_k/p, and takes from those before it.
        for k in range(len(found) - 1, -1, -1):
            above = found[k + 1] if k + 1 < len(found) else acb(0)
            found[k] = (found[k] - above) / pole
    return found
