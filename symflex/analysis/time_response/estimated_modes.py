"""Responses of distributed systems of which too little is known: the lowest modes, and a guess of the rest.

Input: a bound transfer function, and times. Output: the sum over its lowest modes, and what those beyond may
add, from how their residues fall off, from how the response begins, and from how those found have faded by
then. Nothing of that is proved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from flint import acb, arb

from symflex.analysis.rational.laurent import PrincipalPart, expand_at_zero, residues_at
from symflex.analysis.time_response.effort import EFFORT
from symflex.analysis.time_response.function_size import Annulus, ring_about
from symflex.analysis.time_response.modal import BITS, at_origin, term_of
from symflex.analysis.time_response.partial_fractions import ExponentialTerm, values_of
from symflex.analysis.time_response.sample_times import SampleTimes
from symflex.analysis.time_response.sampled import PartialSum, Sampled
from symflex.balls import precision, precisions
from symflex.budget import spend
from symflex.errors import Diagnostic, UncertifiedError
from symflex.roots import Modes, Root
from symflex.roots.distributed.proof import holes_about
from symflex.roots.distributed.side import accumulation_points
from symflex.roots.locate import locate
from symflex.transfer import AnyBoundFunction


def estimated(bound: AnyBoundFunction, integrations: int, times: SampleTimes) -> Sampled:
    """Return the sum over the lowest modes, which higher ones are taken to fade as; SF810 if they do not."""
    few, many = EFFORT.few_estimated, EFFORT.estimated_modes
    count = many if bound.is_reduced else few
    modal_sum = _summed(bound, integrations, times, count)
    errors = sorted(modal_sum.at_times or (modal_sum.rest,), key=arb.mid)
    typical = errors[len(errors) // 2]
    if count == few and EFFORT.little * modal_sum.largest <= typical < EFFORT.hopeless * modal_sum.largest:
        modal_sum, count = _summed(bound, integrations, times, many), many
    told = sum(bool(y.rad() < EFFORT.too_much * modal_sum.largest) for y in modal_sum.sampled.values)
    if 2 * told < len(modal_sum.values):
        message = f"the modes of {bound.name} decay too slowly to determine its response in time"
        # The smoother the input is, the less high modes add.
        smoother = ("a step in place of an impulse", "a ramp in place of a step")[
            integrations : integrations + 1
        ]
        hint = " or ".join([*(f"ask for {each}," for each in smoother), "filter the output"])
        raise UncertifiedError(Diagnostic("SF810", message, None, hint))
    reason = f"the contribution of modes beyond the lowest {count} is estimated"
    return replace(modal_sum.sampled, modes=None, reason=reason)


def _summed(bound: AnyBoundFunction, integrations: int, times: SampleTimes, count: int) -> PartialSum:
    """Return the sum over so many modes."""
    rings, parts = _parts(bound, integrations, count)
    with precision(BITS):
        origin = at_origin(expand_at_zero(bound, integrations - 1, EFFORT.pole_digits), integrations)
        terms = [term_of(part, integrations) for part in parts]
        sizes = [float(abs(term.coefficients[0]).upper()) for term in terms]
        upper = [term.rate.real for term in terms[len(terms) // 2 :]]
        terms += [term for _, around in rings for term in around]
        upper += [term.rate.real for _, around in rings for term in around]
        values = values_of([*origin, *terms], times)
        tail = arb(_estimated_rest(sizes))
        at_times: tuple[arb, ...] = ()
        if terms:
            # At t = 0 it is known what all modes add up to. A taper so far beyond its modes takes gigabytes.
            tapers = any(kernel.function == "entry" for kernel in bound.kernels.kernels)
            far = (1 if tapers else EFFORT.far) * max(abs(term.rate).upper() for term in terms)
            small = EFFORT.begun_closely * max(sizes, default=0.0)
            begun, sooner = (_begun(bound, integrations, s.mid(), small) for s in (far, far / 2))
            at_once = sum((term.coefficients[0] for term in (*origin, *terms)), acb(0)).real
            tail += EFFORT.surer * abs(at_once - begun)
            slowest = max(upper, key=arb.mid).min(0)
            at_times = tuple(tail * (slowest * t).exp() for t in times.enclosed())
            if times.seconds[0] == 0 and slowest < 0 and abs(begun) <= abs(sooner):
                # What fades begins smoothly: only at t = 0 itself do the modes not say more.
                values[0] = begun + arb(0, EFFORT.surer * abs(begun - sooner).upper())
                at_times = (arb(0), *at_times[1:])
        return PartialSum((*origin, *terms), tuple(values), tail, at_times, method="estimated modes")


def _parts(
    bound: AnyBoundFunction, integrations: int, count: int
) -> tuple[list[tuple[Annulus, list[ExponentialTerm]]], tuple[PrincipalPart, ...]]:
    """Return rings around poles close to one another, with their sums, and residues at the others."""
    located = locate(bound, Modes(count), EFFORT.pole_digits, with_zeros=False).complete()
    poles = [root for root in located.all_poles if not root.im < 0 and not root.is_zero]
    rings = _rings(bound, poles, integrations)
    apart = [root for root in poles if not any(ring.holds(root.enclosure()) for ring, _ in rings)]
    return rings, residues_at(bound, apart, EFFORT.pole_digits)


def _begun(bound: AnyBoundFunction, integrations: int, far: arb, small: float) -> arb:
    """Return what a response begins with, from values at a large s, to something ``small`` or the digits."""
    # Between many members exponentials take each other out, and so far out these are large.
    for bits in precisions(BITS, EFFORT.begun_bits):
        spend()
        initial = (bound.enclosed(bits)(acb(far)) / far ** (integrations - 1)).real
        if initial.rad() <= max(small, EFFORT.begun_closely * float(abs(initial).mid())):
            break
    return initial


def _rings(
    bound: AnyBoundFunction, poles: Sequence[Root], integrations: int
) -> list[tuple[Annulus, list[ExponentialTerm]]]:
    """Return what poles add that accumulate, as about -1/eta, as far as all others on a ring are known."""
    if not bound.is_reduced:
        return []
    reached = max((root.natural_frequency() for root in poles), default=arb(0), key=arb.mid)
    places = [root.enclosure() for root in poles]
    with precision(2 * EFFORT.bits):
        annuli = [ring_about(hole, places) for hole in holes_about(accumulation_points(bound))]
        rings = [ring for ring in annuli if ring is not None and ring.reach < reached]
        return [
            (ring, ring.terms(bound, integrations)) for ring in rings if None not in map(ring.holds, places)
        ]


def _estimated_rest(sizes: Sequence[float]) -> float:
    """Return what terms beyond may add at most, if they go on to fall off as those between did.

    They may all have one sign. Where their sizes fall with a power of their number, sums over one half, the
    quarter before and all beyond are a geometric sequence. Of several families, such as two beams', some
    hardly move what is seen; in order of their sizes these come last.

    >>> round(_estimated_rest([1 / n**2 for n in range(1, 65)]), 3)  # all beyond are 0.0155
    0.018
    """
    count = len(sizes)
    falling = sorted(sizes, reverse=True)
    half, quarter = sum(falling[count // 2 :]), sum(falling[count // 4 : count // 2])
    ratio = half / quarter if quarter else 0.0
    beyond = (
        half * ratio / (1 - ratio) if ratio < EFFORT.slowest else half * EFFORT.slowest / (1 - EFFORT.slowest)
    )
    return max(beyond, count * max(sizes[-EFFORT.last_modes :], default=0.0))
