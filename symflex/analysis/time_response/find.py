"""The response of a transfer function to an input of unit size: which way to find it, and how precisely.

Input: a bound transfer function, the name of an input, times. Output: a :class:`EnclosedResponse`.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING

from flint import acb, arb

from symflex.algebra import Factored, KernelTable
from symflex.analysis.time_response.delayed_decay import settling_echoes
from symflex.analysis.time_response.delayed_terms import DelayedQuotient, delayed_quotient
from symflex.analysis.time_response.echoes import FEW_POWERS, MOST_POWERS, Sampled, TooManyEchoesError, echoed
from symflex.analysis.time_response.enclosed_response import (
    INTEGRATIONS,
    EnclosedResponse,
    ImpulseAt,
    JumpAt,
)
from symflex.analysis.time_response.exponentials import values_of
from symflex.analysis.time_response.horizon import default_until, until_many_turns
from symflex.analysis.time_response.looped_modes import looped_modes
from symflex.analysis.time_response.modal import estimated, proved_modes
from symflex.analysis.time_response.partial_fractions import (
    EnclosedQuotient,
    at_infinity,
    partial_fractions,
    power_series_terms,
)
from symflex.analysis.time_response.sample_times import SampleTimes
from symflex.analysis.time_response.wave_echoes import wave_quotient
from symflex.budget import spend
from symflex.errors import Diagnostic, ModelError, UncertifiedError, UsageError
from symflex.errors.diagnostic import nearest
from symflex.expressions.format import decimal_exponent
from symflex.model.loss_factors import check_causal
from symflex.roots.functions.simplified import without_lengths_of_zero
from symflex.roots.locate import equations_of, lumped
from symflex.roots.polynomial_roots import find_polynomial_roots
from symflex.roots.precision import bits_for_digits, precision
from symflex.roots.problem import problem_of
from symflex.roots.root import exact_fraction
from symflex.transfer import BoundNested
from symflex.transfer.balls import at_centre

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from symflex.analysis.input_shaping import InputShaper
    from symflex.transfer import AnyBoundFunction, BoundTransferFunction

GUARD_DIGITS = 6
SHAPED_DIGITS = 2
"""Of responses that a shaper sums, beyond those of the sum, which may be smaller."""
ATTEMPTS = 7
"""Doublings of the digits: poles that lie together to 10^-1000 are as good as a double one."""
MOST_DIGITS = 20_000
ENOUGH_DIGITS = 8
"""Of modes, where many echoes would give more, but take longer."""


def time_response(
    bound: AnyBoundFunction,
    kind: str,
    times: SampleTimes,
    digits: int = 12,
    shaper: InputShaper | None = None,
) -> EnclosedResponse:
    r"""Return the response from rest to a unit ``impulse``, ``step`` or ``ramp`` that begins at t = 0.

    Every value is enclosed, by default to ``digits`` digits of the largest one. With a ``shaper`` the input
    is convolved by its impulses first: the response is a sum of late ones.

    Raises
    ------
    UsageError
        SF902 for an unknown input, or a shaper with fewer digits.
    ModelError
        SF813 for large networks with delays, and impulses of beams in loops with delays that could only be
        estimated.
    UncertifiedError
        SF810 when poles cannot be told apart and the time is too long for a power series.

    Examples
    --------
    >>> from fractions import Fraction
    >>> from symflex import loads
    >>> from symflex.analysis.time_response.sample_times import SampleTimes
    >>> lag = loads('symflex = 1\ninputs.u = {}\noutputs.y = "u/(s + 1)"').transfer_function("y", "u")
    >>> found = time_response(lag.bind().bound, "step", SampleTimes.evenly(Fraction(1), 2))
    >>> found.values.round(9).tolist(), found.certified
    ([0.0, 0.632120559], True)
    """
    check_causal(bound.source.model, "a response in time")
    if kind not in INTEGRATIONS:
        hint = nearest(kind, INTEGRATIONS) or "inputs: " + ", ".join(INTEGRATIONS)
        raise UsageError(Diagnostic("SF902", f"there is no input '{kind[:64]}'", None, hint))
    if shaper is not None:
        return _shaped(bound, kind, times, digits, shaper)
    if isinstance(bound, BoundNested):
        found, reason = _of_network(bound, INTEGRATIONS[kind], times, digits)
    else:
        bound = without_lengths_of_zero(bound)
        found, reason = _found(bound, INTEGRATIONS[kind], times, digits)
    unit, certified = bound.source.output.unit, reason is None
    return EnclosedResponse(
        bound.name,
        kind,
        unit,
        times.seconds,
        found.values,
        found.impulses,
        found.jumps,
        certified,
        reason,
        digits,
        modes=found.modes if certified else None,
        method=found.method,
    )


def responses_by_default(
    bounds: Sequence[AnyBoundFunction],
    kind: str,
    points: int,
    digits: int = 12,
    shaper: InputShaper | None = None,
) -> list[EnclosedResponse]:
    """Return responses at evenly spaced times, where nobody says up to which.

    That is until the slowest motion has died away; where echoes in a loop are too many by then, for fifty
    turns of it. Raises as :func:`time_response` does.
    """

    def over(until: float) -> list[EnclosedResponse]:
        times = SampleTimes.evenly(Fraction(until), points)
        return [time_response(bound, kind, times, digits, shaper) for bound in bounds]

    for bound in bounds:
        check_causal(bound.source.model, "a response in time")
    until = max(map(default_until, bounds))
    try:
        return over(until)
    except UncertifiedError as error:
        shorter = min(map(until_many_turns, bounds))
        if error.diagnostics[0].code != "SF810" or not shorter < until:
            raise
        spend()
        return over(shorter)


def _shaped(
    bound: AnyBoundFunction, kind: str, times: SampleTimes, digits: int, shaper: InputShaper
) -> EnclosedResponse:
    """Return the sum of the responses to the impulses of a shaper, each from its own moment on."""
    inner = digits + SHAPED_DIGITS
    accuracy = min(int(t.rel_accuracy_bits()) for t, _ in shaper.impulses[1:])
    if accuracy < bits_for_digits(inner):
        message = f"the shaper has {shaper.digits} digits, too few for a response with {digits}"
        raise UsageError(Diagnostic("SF902", message, None, "make a shaper with more digits"))
    whole = time_response(bound, kind, times, inner)
    (_, first), *others = shaper.impulses  # the first stands at 0
    with precision(shaper.bits):
        total = [y * first for y in whole.enclosures]
        impulses = [ImpulseAt(i.time, i.order, first * i.weight) for i in whole.impulses]
        jumps = [JumpAt(j.time, first * j.height) for j in whole.jumps]
        seconds = times.enclosed()
        last = seconds[-1] if seconds else arb(0)
    ends = SampleTimes.of([0.0, float(last.mid()) or 1.0])
    begun = time_response(bound, kind, ends, inner).enclosures[0]
    for moment, amplitude in others:
        with precision(shaper.bits):
            start, later = times.since(moment)
        part = time_response(bound, kind, later, inner)
        with precision(shaper.bits):
            for i, value in zip(range(start, len(seconds)), part.enclosures, strict=False):
                # At its own moment nobody knows on which side of it the time lies.
                known = value if seconds[i] > moment else value.union(arb(0))
                total[i] = total[i] + amplitude * known
            if not begun.contains(0):
                jumps.append(JumpAt(moment, amplitude * begun))
            impulses += [ImpulseAt(moment + i.time, i.order, amplitude * i.weight) for i in whole.impulses]
            jumps += [JumpAt(moment + j.time, amplitude * j.height) for j in whole.jumps]
    return replace(
        whole,
        enclosures=tuple(total),
        impulses=tuple(sorted((i for i in impulses if not i.time > last), key=lambda i: i.time.mid())),
        jumps=tuple(sorted((j for j in jumps if not j.time > last), key=lambda j: j.time.mid())),
        digits=digits,
        shaper=shaper.kind,
    )


def _of_network(
    bound: BoundNested, integrations: int, times: SampleTimes, digits: int
) -> tuple[Sampled, str | None]:
    """Return the response of a network that nobody writes out, and what is not proved of it."""
    if bound.is_zero or not len(times):
        return Sampled((arb(0),) * len(times)), None
    propagation = equations_of(bound).propagation
    laws = () if propagation is None else propagation.table.dispersions
    if any(law.kind == "exponential" for law in laws):
        message = f"{bound.name} is of a large network with delays: its response in time is not known"
        raise ModelError(Diagnostic("SF813", message, None, "take 'symflex rational' of it first"))
    if not bound.is_distributed:
        return _found(lumped(bound), integrations, times, digits)
    return estimated(bound, integrations, times)


def _found(
    bound: BoundTransferFunction, integrations: int, times: SampleTimes, digits: int
) -> tuple[Sampled, str | None]:
    """Return the response, and what is not proved of it."""
    if bound.is_zero or not len(times):
        return Sampled((arb(0),) * len(times)), None
    if not bound.is_distributed:
        return _of_lumped(bound, integrations, times, digits), None
    quotient = delayed_quotient(bound)
    if quotient is not None:
        known = _of_quotient(bound, quotient, integrations, times, digits)
        if known is not None:
            return known, None
    waves = None if quotient is not None else wave_quotient(bound)
    if waves is not None:
        try:
            return _of_delays(bound, waves.echoed, integrations, times, digits), None
        except (TooManyEchoesError, UncertifiedError):
            spend()
    if any(law.kind == "exponential" for law in bound.kernels.dispersions):
        late = _without_delay(bound) if quotient is None else None
        if late is not None:
            return _later(*late, integrations, times, digits)
        if quotient is not None or waves is not None:
            raise _too_many(bound)
        try:
            looped = looped_modes(bound, integrations, times, digits)
        except TooManyEchoesError:
            raise _too_many(bound) from None
        if looped is not None:
            return looped
        message = f"{bound.name} has waves that spread in a loop with a delay: this response is not known"
        raise ModelError(
            Diagnostic("SF813", message, None, "ask for a step, or take 'symflex rational' of the beam first")
        )
    proved = proved_modes(bound, integrations, times, digits)
    return (proved.sampled, None) if proved is not None else estimated(bound, integrations, times)


def _of_quotient(
    bound: BoundTransferFunction,
    quotient: DelayedQuotient,
    integrations: int,
    times: SampleTimes,
    digits: int,
) -> Sampled | None:
    """Return a response as echoes, or as few terms or modes; None where all of these are many."""
    has_delays = any(law.kind == "exponential" for law in bound.kernels.dispersions)
    few, many = (partial(echoed, quotient, most=most) for most in (FEW_POWERS, MOST_POWERS))
    late = partial(settling_echoes, bound, quotient)
    for expanded in (few, late, many) if has_delays else (few, many):
        try:
            return _of_delays(bound, expanded, integrations, times, digits)
        except TooManyEchoesError:
            spend()
        except UncertifiedError:
            if expanded is not late:
                raise
        if expanded is few and not has_delays:
            modes = proved_modes(bound, integrations, times, digits)
            if modes is not None and is_precise(modes.sampled.values, ENOUGH_DIGITS):
                return modes.sampled
    return None


def _too_many(bound: BoundTransferFunction) -> UncertifiedError:
    message = f"too many echoes of the delays of {bound.name} arrive by then"
    return UncertifiedError(Diagnostic("SF810", message, None, "ask for a shorter time"))


def _without_delay(bound: BoundTransferFunction) -> tuple[BoundTransferFunction, Callable[[], arb]] | None:
    """Return a function without the delay that it is multiplied by, and that [s]; None where delays are else.

    So it is with a sensor that is late: ``exp(-s T) w(l)/F``.
    """
    table, ratio, num = bound.kernels, bound.ratio, bound.num
    ring = ratio.ring
    delays = [k for k in table.kernels if k.dispersion.kind == "exponential"]
    shares = [(k, ratio.exponent_of(ring.generator(k.generator))) for k in delays]
    for kernel, exponent in shares:
        factor = Factored.generator(ring, kernel.generator) ** exponent
        ratio, num = ratio / factor, num / factor
        if exponent < 0 or any(part.depends_on(kernel.generator) for part in (ratio, num, bound.den)):
            return None

    def seconds() -> arb:
        evaluator = bound.kernel_values()
        values = {"s": acb(1), **{name: acb(c) for name, c in evaluator.constants.items()}}
        total = arb(0)
        for kernel, exponent in shares:
            rate, length = (evaluator.value(x, values) for x in (kernel.dispersion.shift, kernel.length))
            total += exponent * at_centre(rate * length).real
        return total

    laws = tuple(law for law in table.dispersions if law.kind != "exponential")
    kernels = tuple(k for k in table.kernels if k not in delays)
    undelayed = replace(bound, ratio=ratio, parts=(num, bound.den), kernels=KernelTable(laws, kernels))
    return undelayed, seconds


def _later(
    undelayed: BoundTransferFunction,
    delay: Callable[[], arb],
    integrations: int,
    times: SampleTimes,
    digits: int,
) -> tuple[Sampled, str | None]:
    """Return a response that comes a delay later."""
    with precision(bits_for_digits(2 * digits)):
        wait = delay()
        start, later = times.since(wait)
        instants = times.enclosed(start)
    found, reason = _found(undelayed, integrations, later, digits)
    values = [y if t > wait else y.union(arb(0)) for t, y in zip(instants, found.values, strict=False)]
    return Sampled((*[arb(0)] * start, *values), method=found.method), reason


def _of_lumped(bound: BoundTransferFunction, integrations: int, times: SampleTimes, digits: int) -> Sampled:
    problem = problem_of(bound, [(f, -e) for f, e in bound.ratio.factors if e < 0])
    wanted = digits + GUARD_DIGITS
    for attempt in range(ATTEMPTS):
        spend()
        poles = find_polynomial_roots(problem, wanted)
        bits = max((root.working_bits() for root in poles), default=0) + bits_for_digits(wanted)
        with precision(bits):
            last = arb(float(times.seconds[-1]))
            turned = max((root.natural_frequency() * last for root in poles), default=arb(0), key=arb.mid)
            quotient = EnclosedQuotient.of(bound, bits)
            terms, method = partial_fractions(quotient, poles, integrations), "partial fractions"
            if terms is None and attempt:
                method = "power series"
                terms = power_series_terms(quotient, integrations, last, bits_for_digits(wanted))
            if terms is not None:
                weights, _ = at_infinity(quotient, integrations)
                impulses = tuple(ImpulseAt(arb(0), k, w) for k, w in enumerate(weights) if w != 0)
                # Residues may need all bits that poles have; sums of exponentials need those of their result.
                with precision(bits_for_digits(wanted + decimal_exponent(exact_fraction(turned + 1)) + 1)):
                    found = Sampled(tuple(values_of(terms, times)), impulses, method=method)
                if is_precise(found.values, digits):
                    return found
                if not times.is_exact:
                    times = times.one_by_one()
        wanted = max(2 * wanted, digits + GUARD_DIGITS + decimal_exponent(exact_fraction(turned + 1)) + 1)
        if wanted > MOST_DIGITS:
            break
    raise _unknown(bound, digits)


def _of_delays(
    bound: BoundTransferFunction,
    echoes: Callable[[int, SampleTimes, int], Sampled | None],
    integrations: int,
    times: SampleTimes,
    digits: int,
) -> Sampled:
    wanted = digits + GUARD_DIGITS
    for _ in range(ATTEMPTS):
        found = echoes(integrations, times, wanted)
        if found is not None:
            apart = [y for i, y in enumerate(found.values) if i not in found.at_jumps]
            if is_precise(apart, digits) and (times.is_exact or not found.at_jumps):
                return found
            if not times.is_exact:
                times = times.one_by_one()
        wanted *= 2
    message = f"the poles between the delays of {bound.name} lie too close together"
    raise UncertifiedError(Diagnostic("SF810", message, None, "ask for a shorter time"))


def _unknown(bound: BoundTransferFunction, digits: int) -> UncertifiedError:
    message = f"poles of {bound.name} cannot be told apart: its response is not known to {digits} digits"
    return UncertifiedError(Diagnostic("SF810", message, None, "ask for a shorter time, or fewer digits"))


def is_precise(values: Sequence[arb], digits: int) -> bool:
    """Tell whether all balls are narrow beside the largest value.

    Examples
    --------
    >>> is_precise([arb(0, 1e-13), arb(1)], 12), is_precise([arb(0, 1e-3), arb(1)], 12)
    (True, False)
    """
    if not all(map(arb.is_finite, values)):
        return False
    largest = max(map(abs, map(arb.mid, values)), default=arb(0))
    return bool(max(map(arb.rad, values), default=arb(0)) <= largest * arb(10) ** -digits)
