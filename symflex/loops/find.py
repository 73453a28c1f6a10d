"""The stable gains of a loop: crossings from all factors, counts between them, margins, and the crossover.

Definition of the gain crossover that a loop allows: the gain is raised from 0 up to half of the one at which
the loop first becomes unstable, so that a gain margin of 6 dB is left (Franklin, Powell & Emami-Naeini,
Feedback Control of Dynamic Systems, 2010, section 6.4). It is the frequency at which the loop gain then first
falls below one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import reduce
from itertools import pairwise
from math import inf, pi
from typing import Final

from flint import acb, arb

from symflex.balls import ball, precision
from symflex.budget import entered_budget, spend
from symflex.errors import Diagnostic, ModelError, UncertifiedError, UsageError
from symflex.loops.apart import PolesApart, poles_apart
from symflex.loops.axis_search import SHRINKINGS, OnAxis
from symflex.loops.distributed import DistributedFactors
from symflex.loops.gain_functions import NARROW_BITS, RANGE_OF_NOMINAL, Limits
from symflex.loops.locus import closed_loop_roots, is_straight
from symflex.loops.loop import GainPolynomial, Loop
from symflex.loops.loop_function import LoopFunction, LoopValue
from symflex.loops.lumped import LumpedFactor
from symflex.loops.networks import AnyLoop, NetworkFactors, NetworkLoop
from symflex.loops.stability_map import (
    BITS,
    AllowedCrossover,
    Boundary,
    Crossing,
    DataEnd,
    GainInterval,
    GainMargin,
    Margins,
    PhaseMargin,
    PoleCount,
    StabilityMap,
)
from symflex.roots import find_polynomial_roots
from symflex.roots.locate import locate
from symflex.roots.pole_zero_map import WITHOUT_END, StabilityVerdict
from symflex.roots.problem import problem_of
from symflex.roots.root import exact_fraction
from symflex.transfer import bind

MIRRORED = "points on the imaginary axis where mirrored poles meet are not searched"
BRANCH = "stable gains are searched where the branch point is s = 0, and not where it lies elsewhere"
GUARD_DIGITS = 6  # beyond those printed
SAMPLE_BITS = (6, 12, 24, 48, 96, 192, 384, 768)  # bits of gains between boundaries: the fewest that do
NEXT_TO_ZERO = 2**20  # by what the first boundary is divided where poles of a small gain are counted
AnyFactors = DistributedFactors | NetworkFactors


def find_stable_gains(
    loop: AnyLoop,
    limits: Limits | None = None,
    digits: int = 15,
    up_to: float | None = None,
    *,
    has_loop_gain: bool = True,
) -> StabilityMap:
    """Return for which gains a loop is stable, proved.

    ``limits`` are the range of the gain, its ends left out: by default all gains of the sign that is assumed
    of it; of a loop with kernels up to 100 times its value. ``digits`` are of boundaries and frequencies.
    Where it cannot be proved that no pole lies in the right half-plane beyond some frequency, poles are
    counted ``up_to`` [rad/s]; by default about ten waves of the longest element. Of a model that was fitted
    to data poles are counted up to where these end, and no others. Of a parameter that ``has_loop_gain`` is
    false for, margins in phase and crossovers are not asked for.

    SF803 a loop with kernels that is not a straight line in the gain, SF804 a range is needed, or is empty;
    SF505, SF506.
    """
    root = None if isinstance(loop, NetworkLoop) else loop.bound.root
    if root is not None and root.shift != 0:
        return _at_nominal(loop, limits or (None, None), digits, BRANCH)
    parts = _parts(loop, limits, up_to)
    if parts.why_not:
        return _at_nominal(loop, parts.limits, digits, parts.why_not)
    return _searched(loop, parts, digits, has_loop_gain=has_loop_gain and not root)


def _searched(loop: AnyLoop, parts: _GainSearch, digits: int, *, has_loop_gain: bool) -> StabilityMap:
    """Return for which gains a loop is stable, from where its poles cross the axis."""
    lumped, along = parts.lumped, parts.along
    try:
        if along is not None and along.is_mirrored:
            return _at_nominal(loop, parts.limits, digits, MIRRORED)
        crossings = [c for factor in lumped for c in factor.crossings(digits + GUARD_DIGITS)]
        if along is not None:
            crossings += along.crossings(digits + GUARD_DIGITS)
        boundaries, intervals, open_ends = _between(crossings, parts)
    except UncertifiedError as error:
        if loop.nominal is None:
            raise
        told = error.diagnostics[0]
        reason = "; ".join(filter(None, (told.message, told.hint)))
        return _at_nominal(loop, parts.limits, digits, reason)
    stability = _map_of(loop, parts, boundaries, intervals, digits)
    # What all gains leave open may be known of one: terms outweigh one another, or the loop is passive.
    # What is said of a range does not prove one gain of it where next to s = 0 poles are not followed.
    has_root = not isinstance(loop, NetworkLoop) and loop.bound.root
    is_open = stability.verdict.word == "unknown" or (has_root and along is not None and along.reasons)
    if loop.nominal is not None and parts.end is None and is_open:
        stability = replace(stability, at_nominal=_verdict_at(loop, loop.nominal))
    loop_gain = _loop_gain(loop, along, digits + GUARD_DIGITS) if has_loop_gain else None
    margins, unknown = Margins(gain_margins(stability)), list[str]()
    if loop_gain is not None:
        margins, unknown = _margins(stability, parts, loop_gain, margins)
    # The search for crossovers may have added to the reasons.
    reasons = (*open_ends, *parts.reasons, *unknown)
    return replace(stability, margins=margins, reasons=tuple(dict.fromkeys(reasons)))


@dataclass(frozen=True)
class _GainSearch:
    """What a loop is made of for a search of its gains."""

    lumped: list[LumpedFactor]
    along: AnyFactors | None  # factors with kernels
    limits: Limits
    apart: PolesApart  # poles that no gain moves, as far as they are roots of polynomials
    end: float | None = None  # where the data end [rad/s]
    gain_at_end: float | None = None
    name: str = ""  # of the gain

    @property
    def why_not(self) -> str:
        """Why the range is not searched; empty if it is."""
        if self.apart.verdict.right is None:
            return self.apart.verdict.reason
        along = self.along
        is_endless = along is not None and not along.radius[1] and WITHOUT_END in along.reasons[-1]
        return along.reasons[-1] if along is not None and is_endless else ""

    @property
    def is_complete(self) -> bool:
        """All poles in the right half-plane are counted, or all that the data show."""
        return self.along is None or self.along.radius[1] or self.end is not None

    @property
    def reasons(self) -> list[str]:
        """What is open, and why."""
        reasons = [] if self.along is None else [*self.along.reasons[self.end is not None :]]
        if self.end is not None and self.gain_at_end is None:
            reasons.append(
                f"'{self.name}' closes several loops: no loop gain says what matters beyond the data"
            )
        return reasons


def _map_of(
    loop: AnyLoop,
    parts: _GainSearch,
    boundaries: tuple[Boundary, ...],
    intervals: tuple[GainInterval, ...],
    digits: int,
) -> StabilityMap:
    """Return what was searched, without margins."""
    along, end, nominal, data = parts.along, parts.end, loop.nominal, None
    if end is not None:
        data = DataEnd(end, parts.gain_at_end, () if nominal is None else _beyond(parts.lumped, nominal, end))
    return StabilityMap(
        loop.gain.name,
        loop.gain.unit,
        parts.limits,
        boundaries,
        intervals,
        nominal,
        radius=end if along is None else along.from_root(along.radius[0]),
        is_complete=parts.is_complete,
        reasons=tuple(parts.reasons),
        digits=digits,
        method="polynomials" if along is None else along.method,
        apart=parts.apart,
        tf=loop.bound.name if isinstance(loop, Loop) else "",
        is_passive=along is not None and along.energy.is_passive,
        is_narrowed=along is not None and along.is_narrowed,
        data=data,
        counted_in=loop.gain.counted_in,
    )


def _margins(
    stability: StabilityMap, parts: _GainSearch, loop_gain: LoopGain, known: Margins
) -> tuple[Margins, list[str]]:
    """Return the margins of a loop that is closed once, and what is not known of them."""
    along, interval, unknown = parts.along, stability.nominal_interval, list[str]()
    phases: tuple[PhaseMargin, ...] = ()
    if stability.nominal and interval is not None and interval.poles.is_stable:
        phases = loop_gain.margins(stability.nominal)
    if parts.end is not None:
        phases = tuple(m for m in phases if not m.frequency > parts.end)
    crossover = beyond = None
    if loop_gain.value is None:
        crossover = allowed_crossover(stability.intervals, parts.limits[1], loop_gain)
    if parts.is_complete and along is not None and along.is_endless and along.energy.is_passive:
        beyond = along.energy.least_phase_margin(along.radius[0])
        if not _holds_smallest(phases, crossover, beyond):
            unknown.append(f"phase margins above {along.radius[0] / (2 * pi):.4g} Hz are not known")
    # An angle of 0 bounds nothing.
    return replace(known, phases=phases, crossover=crossover, least_beyond=beyond or None), unknown


def _parts(loop: AnyLoop, limits: Limits | None, up_to: float | None) -> _GainSearch:
    """Return what a loop is made of, with the range of its gain."""
    if isinstance(loop, NetworkLoop):
        bounded = _bounded(loop, _range(loop, limits, has_kernels=True))
        return _GainSearch([], NetworkFactors(loop, loop.gain.name, bounded, up_to), bounded, PolesApart())
    end = None if loop.model.data_end is None else 2 * pi * float(loop.model.data_end)
    at_end = None if end is None else _gain_at_end(loop, end)
    lumped, along, ends = _factors(loop, limits, up_to, end, at_end)
    apart = poles_apart(loop.bound, _split(loop)[0])
    return _GainSearch(lumped, along, ends, apart, end, at_end, loop.gain.name)


def _gain_at_end(loop: Loop, end: float) -> float | None:
    """Return the gain with which the loop gain is one at a frequency [rad/s]; None without a loop gain."""
    if not is_straight(loop):
        return None
    function = LoopFunction.of(loop.bound, *loop.with_gain[0].coefficients)
    size = float(abs(_ratio(function, arb(end), BITS)).upper())
    return 1 / size if 0 < size < inf else None


def _beyond(lumped: Sequence[LumpedFactor], gain: Fraction, end: float) -> tuple[float, ...]:
    """Return abs(s) of the poles in the right half-plane beyond the end of the data [rad/s], ascending."""
    roots = (root for factor in lumped for root in factor.roots(gain))
    sizes = (abs(r.enclosure()) for r in roots if r.re > 0)
    return tuple(sorted(float(size.mid()) for size in sizes if size > end))


def _at_nominal(loop: AnyLoop, limits: Limits, digits: int, reason: str) -> StabilityMap:
    """Return what is known if the range of the gain is not searched: whether its nominal value is stable."""
    verdict = None
    if loop.nominal is not None:
        verdict = _verdict_at(loop, loop.nominal)
        spend()  # a search that ends with its time returns what it proved, perhaps nothing
    return StabilityMap(
        loop.gain.name,
        loop.gain.unit,
        limits,
        nominal=loop.nominal,
        is_complete=False,
        reasons=(reason,),
        digits=digits,
        method="roots",
        at_nominal=verdict,
        tf=loop.bound.name if isinstance(loop, Loop) else "",
        counted_in=loop.gain.counted_in,
    )


def _verdict_at(loop: AnyLoop, gain: Fraction) -> StabilityVerdict:
    """Return what holds at one gain, also at one for which there is no solution."""
    try:
        if isinstance(loop, Loop) and not gain:  # the model without what the gain multiplies
            return locate(bind(loop.source, {**loop.given, loop.gain.name: gain})).verdict
        return closed_loop_roots(loop, gain).verdict
    except ModelError as error:
        return StabilityVerdict("unknown", None, False, error.diagnostics[0].message)


def _holds_smallest(
    phase_margins: Sequence[PhaseMargin], crossover: AllowedCrossover | None, beyond: float
) -> bool:
    """Tell whether the smallest phase margins were found, as others are not below an angle [rad]."""
    known = [[abs(margin.angle) for margin in phase_margins]] if phase_margins else []
    known += [] if crossover is None or crossover.phase_margin is None else [[abs(crossover.phase_margin)]]
    # A damper on an undamped structure has 90 degrees at every crossover.
    return all(any(float(angle.lower()) <= beyond for angle in angles) for angles in known)


def _factors(
    loop: Loop, given: Limits | None, up_to: float | None, end: float | None, at_end: float | None
) -> tuple[list[LumpedFactor], DistributedFactors | None, Limits]:
    """Return the factors of polynomials, those of all else, and the range of the gain."""
    plain, mixed = _split(loop)
    low, high = _range(loop, given, has_kernels=bool(mixed) and loop.functions is None)
    if loop.functions is not None:
        low, high = loop.functions.domain((low, high), is_endless=not mixed)
    if at_end is not None:
        # Counts begin at 0, and end where the loop gain is one at the end of the data.
        most = Fraction(at_end)
        low = -most if low is None else max(min(low, Fraction(0)), -most)
        high = most if high is None else min(max(high, Fraction(0)), most)
    lumped = [LumpedFactor.of(loop.bound, factor, loop, (low, high)) for factor in plain if factor.degree]
    if not mixed:
        return lumped, None, (low, high)
    low, high = _bounded(loop, (low, high))
    if loop.bound.sheets > 1 and any(factor.degree > 1 for factor in mixed):
        message = f"a loop with roots of s must be linear in '{loop.gain.name}'"
        hint = "use it as the gain of one loop, not squared, and give other loops parameters of their own"
        raise ModelError(Diagnostic("SF803", message, loop.gain.span, hint))
    along = DistributedFactors(
        loop.bound, loop.gain.name, mixed, (low, high), end or up_to, loop=loop, is_cut=end is not None
    )
    along = along.where_no_delay_leads if given is None and end is None else along
    return lumped, along, along.limits


def _range(loop: AnyLoop, given: Limits | None, *, has_kernels: bool) -> Limits:
    """Return the range of the gain: that given, else of its sign, with kernels up to 100 times its value."""
    low, high = given or (None if loop.gain.assume == "real" else Fraction(0), None)
    if low is not None and high is not None and not low < high:
        raise UsageError(Diagnostic("SF804", f"the range of '{loop.gain.name}' must end above its start"))
    if has_kernels and given is None and loop.nominal:
        reach = abs(loop.nominal) * RANGE_OF_NOMINAL
        low, high = -reach if low is None else low, reach
    return low, high


def _bounded(loop: AnyLoop, limits: Limits) -> tuple[Fraction, Fraction]:
    """Return a range with two ends; SF804 where one is missing."""
    low, high = limits
    if low is None or high is None:
        message = f"a loop with beams, rods or delays needs a bounded range of '{loop.gain.name}'"
        hint = "give the parameter a value, or say --range LO HI"
        raise UsageError(Diagnostic("SF804", message, None, hint))
    return low, high


def _split(loop: Loop) -> tuple[tuple[GainPolynomial, ...], tuple[GainPolynomial, ...]]:
    """Return the factors that are polynomials in s alone, or hidden for all gains, and those with kernels."""
    bound = loop.bound
    plain: list[GainPolynomial] = []
    mixed: list[GainPolynomial] = []
    for factor in loop.factors:
        polynomials = [f for value in factor.coefficients for f, _ in value.factors]
        has_kernels = not bound.ratio.ring.used_in(polynomials).isdisjoint(bound.kernels.generators)
        has_root = factor.degree > 0 and bound.sheets > 1
        has_kernels = has_kernels and not (factor.is_hidden and not factor.degree)
        (mixed if has_root or has_kernels or factor.multiplicity < 0 else plain).append(factor)
    return tuple(plain), tuple(mixed) if bound.kernels or bound.sheets > 1 else ()


def _between(
    crossings: Sequence[Crossing], parts: _GainSearch
) -> tuple[tuple[Boundary, ...], tuple[GainInterval, ...], list[str]]:
    """Return boundaries, intervals and what is not proved, but for crossings beyond the end of data."""
    lumped, along, end = parts.lumped, parts.along, parts.end
    apart = PoleCount(parts.apart.right, parts.apart.axis)
    reasons: list[str] = []
    groups, ends = _grouped(crossings, parts.limits, reasons)
    counts = []
    distributed: PoleCount | None = None  # of the factors with kernels
    for i, (below, above) in enumerate(pairwise(ends)):
        entered_budget().progress.report(i / len(ends), f"poles counted in {i} of {len(ends) - 1} intervals")
        sample = _sample(below, above)
        total = sum((factor.count(sample) for factor in lumped), apart)
        if along is not None:
            distributed = along.count(sample, distributed, groups[i - 1][1] if i else ())
        counts.append(total if distributed is None else total + distributed)
        spend()
    if end is not None:
        first = next(i for i, high in enumerate(ends[1:]) if high is None or high > 0)
        top = ends[first + 1]
        small = (Fraction(1) if top is None else exact_fraction(top)) / NEXT_TO_ZERO
        beside = apart if along is None else along.count(small) + apart
        least = sum((factor.count(small, end) for factor in lumped), beside)
        counts = _up_to_end(counts, [_is_within(group, end) for _, group in groups], first, least)
    boundaries, intervals, start = list[Boundary](), list[GainInterval](), ends[0]
    counted = inf  # up to which frequency
    if along is not None and not along.radius[1]:
        counted = along.from_root(along.radius[0] * 1.01)
    for i, (gain, group) in enumerate(groups):
        # A stable loop is not stable at one gain alone where poles touch the axis and turn back. Poles
        # that cross it above the highest frequency counted only seem to. Where the order is lower, or
        # nothing is a solution, what holds on both sides need not hold.
        turns = any(not omega > counted for c in group for omega in c.frequencies)
        is_lower = any(c.is_infinite or c.is_singular for c in group)
        is_same, where = counts[i] == counts[i + 1], f"near a gain of {float(gain.mid()):.6g}"
        if is_same and counts[i].is_stable and any(c.is_open for c in group):
            reasons.append(f"it could not be decided whether poles touch the axis {where}")
        stays = not is_lower and not (counts[i].is_stable and turns)
        if is_same and (stays or not _is_within(group, end)):
            continue
        intervals.append(GainInterval(start, gain, counts[i]))
        boundaries.append(Boundary(gain, tuple(group)))
        known = sum((4 if c.is_symmetric else 2) * len(c.frequencies) for c in group)
        if counted < inf and abs(counts[i + 1].right - counts[i].right) > max(known, 2):
            reasons.append(f"poles enter from above the highest frequency counted, {where}")
        start = gain
    intervals.append(GainInterval(start, ends[-1], counts[-1]))
    return tuple(boundaries), tuple(intervals), reasons


def _grouped(
    crossings: Sequence[Crossing], limits: Limits, reasons: list[str]
) -> tuple[list[tuple[arb, list[Crossing]]], list[arb | None]]:
    """Return crossings in a range that cannot be separated with their gain, ascending, and all ends."""
    low, high = (None if x is None else _ball(x) for x in limits)
    groups: list[list[Crossing]] = []
    with precision(BITS * 4):
        for crossing in sorted(crossings, key=lambda c: float(c.gain.lower())):
            gain = crossing.gain
            if crossing.is_open and gain.rel_accuracy_bits() < NARROW_BITS and not gain.contains(0):
                edges = f"{float(gain.lower()):.6g} and {float(gain.upper()):.6g}"
                reasons.append(f"it could not be decided whether poles cross the axis between {edges}")
            if (low is not None and not gain > low) or (high is not None and not gain < high):
                # At an end of the range, or beyond it; what straddles an end narrows the range.
                if low is not None and gain.overlaps(low):
                    low = low if low.upper() >= gain.upper() and low.is_exact() else low.union(gain)
                if high is not None and gain.overlaps(high):
                    high = high if high.lower() <= gain.lower() and high.is_exact() else high.union(gain)
                continue
            if groups and any(c.gain.overlaps(gain) for c in groups[-1]):
                groups[-1].append(crossing)
            else:
                groups.append([crossing])
    merged = []
    for group in groups:
        with precision(max(BITS, *(c.gain.bits() for c in group))):
            merged.append((reduce(arb.union, (c.gain for c in group)), group))
    return merged, [low, *(gain for gain, _ in merged), high]


def _is_within(group: Sequence[Crossing], end: float | None) -> bool:
    return end is None or any(c.is_singular or any(not w > end for w in c.frequencies) for c in group)


def _up_to_end(
    counts: Sequence[PoleCount], are_within: Sequence[bool], first: int, least: PoleCount
) -> list[PoleCount]:
    """Return the counts of poles that pass the axis where there are data, or are there for small gains.

    They are those of every plant with these data whose loop gain stays below one beyond (Nyquist 1932).
    """
    made = {first: least}
    for i in [*range(first, len(are_within)), *reversed(range(first))]:
        known, new, sign = (i, i + 1, 1) if i in made else (i + 1, i, -1)
        below, above = counts[i], counts[i + 1]
        moved = (above.right - below.right, above.axis - below.axis) if are_within[i] else (0, 0)
        made[new] = PoleCount(made[known].right + sign * moved[0], made[known].axis + sign * moved[1])
    return [made[i] for i in range(len(counts))]


def _ball(value: Fraction) -> arb:
    with precision(BITS):
        return ball(value)


def _sample(low: arb | None, high: arb | None) -> Fraction:
    """Return a short rational number between two balls; SF802 when they meet."""
    start = None if low is None else exact_fraction(low) + exact_fraction(low.rad())
    end = None if high is None else exact_fraction(high) - exact_fraction(high.rad())
    if start is None and end is None:
        return Fraction(1)
    if end is None and start is not None:
        value = 2 * start + 1 if start > 0 else start / 2 + 1
    elif start is None and end is not None:
        value = 2 * end - 1 if end < 0 else end / 2 - 1
    elif start is not None and end is not None:
        if not start < end:
            message = "two boundaries cannot be separated"
            raise UncertifiedError(Diagnostic("SF802", message, None, "ask for more --digits"))
        value = 2 * start if low is not None and low > 0 and end > 4 * start else (start + end) / 2
    for bits in SAMPLE_BITS:
        scale = Fraction(2) ** (bits - (value.numerator.bit_length() - value.denominator.bit_length()))
        rounded = Fraction(round(value * scale)) / scale
        if (start is None or start < rounded) and (end is None or rounded < end):
            return rounded
    return value


def gain_margins(stability: StabilityMap) -> tuple[GainMargin, ...]:
    """Return by which factors the nominal value may change until poles meet the axis."""
    interval, nominal = stability.nominal_interval, stability.nominal
    if interval is None or not nominal or not interval.poles.is_stable:
        return ()
    margins = []
    for end in (interval.low, interval.high):
        boundary = next((b for b in stability.boundaries if end is not None and b.gain is end), None)
        if boundary is None:
            continue
        with precision(max(BITS, boundary.gain.bits())):
            factor = boundary.gain * nominal.denominator / nominal.numerator
        if factor > 0:
            margins.append(GainMargin(factor, boundary))
    return tuple(margins)


def _loop_gain(loop: AnyLoop, along: AnyFactors | None, digits: int) -> LoopGain | None:
    """Return the loop gain of a loop that is closed once, by its gain or a function of it."""
    if isinstance(along, NetworkFactors):
        return None if along.radius[1] else LoopGain(along.function, along, digits)
    if isinstance(loop, NetworkLoop):
        return None
    if [factor.multiplicity for factor in loop.with_gain] != [1]:
        return None
    (factor,) = loop.with_gain
    if factor.degree > 1:
        if loop.nominal is None or loop.bound.sheets > 1:
            return None
        alone = DistributedFactors(
            loop.bound, loop.gain.name, (factor,), (loop.nominal,) * 2, None, loop=loop
        )
        one = alone.in_one_function(factor, is_monic=True)
        return one and LoopGain(one[2].with_gain[0], one[2], digits, one[0](ball(loop.nominal))[0])
    if isinstance(along, DistributedFactors) and factor in along.factors:
        return LoopGain(along.with_gain[0], along, digits)
    return LoopGain(LoopFunction.of(loop.bound, *factor.coefficients), None, digits)


@dataclass(frozen=True)
class LoopGain:
    """The loop gain ``K B/A`` of a loop closed once, on the imaginary axis."""

    function: OnAxis  # A and B
    along: AnyFactors | None  # whose factor this is; None of polynomials
    digits: int  # of frequencies
    value: arb | None = None  # of the function of the gain that stands for it, at its nominal value

    def margins(self, gain: Fraction) -> tuple[PhaseMargin, ...]:
        """Return the phase margins where it is one in magnitude, ascending in frequency."""
        times = _ball(gain) if self.value is None else self.value
        if self.along is not None:
            crossovers = distributed_crossovers(self.along, times, gain, self.digits)
            if self.value is not None and self.along.reasons:
                return ()  # which may not be all
        elif isinstance(self.function, LoopFunction):
            crossovers = lumped_crossovers(self.function, gain, self.digits)
        margins = []
        for omega, ratio in sorted(crossovers, key=lambda pair: float(pair[0].mid())):
            with precision(max(BITS, 2 * omega.bits())):
                # The loop gain is K B/A; its angle beyond that of -1.
                margins.append(PhaseMargin((-ratio * acb(times)).arg(), omega))
        return tuple(margins)


def lumped_crossovers(function: LoopFunction, nominal: Fraction, digits: int) -> list[tuple[arb, acb]]:
    """Return the frequencies [rad/s], roots of ``A(s) A(-s) - K^2 B(s) B(-s)``, and B/A there."""
    context = function.bound.ratio.ring.context
    mirrored = [-context.gen(0), *context.gens()[1:]]
    a, b = (f * f.compose(*mirrored, ctx=context) for f in (function.a, function.b))
    squared = a * nominal.denominator**2 - b * nominal.numerator**2
    if squared.is_zero():
        return []
    roots = find_polynomial_roots(problem_of(function.bound, [(squared, 1)]), digits)
    above = [root for root in roots if root.on_imaginary_axis and root.im > 0]
    return [(root.im, _ratio(function, root.im, 2 * root.working_bits())) for root in above]


def _ratio(function: OnAxis, omega: arb, bits: int) -> acb:
    """Return an enclosure of B/A at a frequency [rad/s]."""
    around, _ = function.on(omega, bits)
    with precision(bits):
        return around.b / around.a


def distributed_crossovers(
    along: AnyFactors, gain: arb, nominal: Fraction, digits: int
) -> list[tuple[arb, acb]]:
    """Return the same for a loop with kernels; where it is not proved is added to its reasons."""
    (function,) = along.with_gain

    def equation(value: LoopValue) -> tuple[arb, arb]:
        return value.excess(gain)

    first, origin = along.next_to_zero(function)
    if origin is not None:
        start = first
        for _ in range(SHRINKINGS):
            is_one_at_rest = bool(along.gain) and origin.leaves_one(nominal, arb(first))
            if is_one_at_rest or origin.side(abs(gain), arb(first)):
                break
            first /= 2
        else:
            # As where it is one at s = 0 itself: nothing is gained by going closer.
            along.reasons.append("it could not be decided whether the loop gain is one next to s = 0")
            first = start
    last = along.last_crossover(gain)
    result = along.on_axis(function, equation, lambda value: False, (first, last), digits)
    crossovers = [(omega, _ratio(function, omega, max(BITS, 2 * omega.bits()))) for omega in result.roots]
    return [(omega, ratio) for omega, ratio in crossovers if ratio.is_finite()]


MARGIN: Final = 2  # of the gain: 6 dB


def allowed_crossover(
    intervals: Sequence[GainInterval], limit: Fraction | None, loop_gain: LoopGain
) -> AllowedCrossover | None:
    """Return the crossover that stable gains next to 0 and up to ``limit`` allow; ``None`` without them."""
    about_zero = (i for i in intervals if (i.high is None or i.high > 0) and (i.low is None or not i.low > 0))
    begin = next(about_zero, None)
    if begin is None or not begin.poles.is_stable:
        return None
    if begin.high is None:
        return AllowedCrossover(None, None, None, is_limited=False)
    is_limited = begin is not intervals[-1]
    end = Fraction(float(begin.high.mid())) if is_limited or limit is None else limit
    gain = end / MARGIN
    margins = loop_gain.margins(gain)
    with precision(BITS):
        before = _ratio(loop_gain.function, margins[0].frequency.mid() / 2 if margins else arb(1), BITS)
        if not abs(before) * abs(ball(gain)) > 1:
            return AllowedCrossover(gain, None, None, is_limited)
    if not margins:
        return None  # it never falls below one
    worst = min(margins, key=lambda margin: abs(float(margin.angle.mid())))
    return AllowedCrossover(gain, margins[0].frequency, worst.angle, is_limited)
