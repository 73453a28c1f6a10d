"""The response of a transfer function to an input of unit size: which way to find it, and how precisely.

Input: a bound transfer function, the name of an input, times. Output: an :class:`EnclosedResponse`.

Ways are asked in the order of :data:`WAYS`, and the first that answers is taken. What others refused for is
told of a response that is only estimated:

    a servo about an undamped beam       lossless modes: something loses energy, or waves have two wavenumbers
                                         lossy modes: some waves have no material damping
                                         passive modes: something in the model may supply energy
                                         estimated modes answer
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING

from flint import acb, arb

from symflex.algebra import Factored, KernelTable, degree_in
from symflex.algebra.ring import coefficients_of
from symflex.analysis.time_response.delayed_terms import polynomial_in_s
from symflex.analysis.time_response.echoes import TooManyEchoesError, echoed, too_early
from symflex.analysis.time_response.effort import EFFORT
from symflex.analysis.time_response.enclosed_response import INTEGRATIONS, EnclosedResponse
from symflex.analysis.time_response.estimated_modes import estimated
from symflex.analysis.time_response.hyperbola import along_hyperbolas
from symflex.analysis.time_response.modal import BOUNDS, summed
from symflex.analysis.time_response.partial_fractions import (
    EnclosedQuotient,
    at_infinity,
    partial_fractions,
    values_of,
)
from symflex.analysis.time_response.sample_times import SampleTimes, default_until
from symflex.analysis.time_response.sampled import (
    Asked,
    Gathered,
    ImpulseAt,
    JumpAt,
    Refused,
    Sampled,
    is_precise,
)
from symflex.analysis.time_response.settling import falls_off, settled
from symflex.analysis.time_response.wave_echoes import wave_quotient
from symflex.balls import at_centre, bits_for_digits, precision
from symflex.budget import spend
from symflex.errors import Diagnostic, ModelError, UncertifiedError, no_such, refused
from symflex.expressions.format import decimal_exponent
from symflex.model.loss_factors import check_causal
from symflex.roots.functions.simplified import without_lengths_of_zero
from symflex.roots.locate import as_quotient, equations_of
from symflex.roots.polynomial_roots import find_polynomial_roots
from symflex.roots.problem import problem_of
from symflex.roots.root import exact_fraction
from symflex.transfer import BoundNested
from symflex.transfer.transfer_function import unit_of_response

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from symflex.algebra import Kernel
    from symflex.analysis.input_shaping import InputShaper
    from symflex.analysis.time_response.function_size import ModesBound
    from symflex.transfer import AnyBoundFunction, BoundTransferFunction

    Plan = Callable[[], "Sampled | Refused"]
    Delays = list[tuple[Kernel, int]]  # kernels, and how often each is taken


@dataclass(frozen=True, slots=True)
class Way:
    """One way of finding a response."""

    name: str
    applies: Callable[[Asked], Plan | Refused]  # what finds it, or why nothing is tried


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
        SF813 for large networks with delays.
    UncertifiedError
        SF810 when poles cannot be separated, or modes do not say what the response is.

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
        raise no_such("input", kind, INTEGRATIONS)
    if shaper is not None:
        return _shaped(bound, kind, times, digits, shaper)
    integrations = INTEGRATIONS[kind]
    if bound.is_zero or not len(times):
        sampled = Sampled((arb(0),) * len(times))
    elif not (bound.is_reduced or bound.is_rational):
        sampled = _of_network(bound, integrations, times)
    else:
        sampled = _answer(Asked(without_lengths_of_zero(as_quotient(bound)), integrations, times, digits))
    unit, reason = unit_of_response(bound.source.output, bound.source.input), sampled.reason
    parts = sampled.values, sampled.impulses, sampled.jumps, reason is None, reason
    response = EnclosedResponse(bound.name, kind, unit, times.seconds, *parts, digits)
    return replace(response, modes=sampled.modes, method=sampled.method, refused=sampled.refused)


def responses_by_default(
    bounds: Sequence[AnyBoundFunction],
    kind: str,
    points: int,
    digits: int = 12,
    shaper: InputShaper | None = None,
) -> list[EnclosedResponse]:
    """Return responses until the slowest motion has died away, where nobody says up to when."""
    for bound in bounds:
        check_causal(bound.source.model, "a response in time")
    times = SampleTimes.evenly(Fraction(max(map(default_until, bounds))), points)
    return [time_response(bound, kind, times, digits, shaper) for bound in bounds]


def _shaped(
    bound: AnyBoundFunction, kind: str, times: SampleTimes, digits: int, shaper: InputShaper
) -> EnclosedResponse:
    """Return the sum of the responses to the impulses of a shaper, each from its own moment on."""
    inner = digits + EFFORT.shaped_digits
    accuracy = min(int(t.rel_accuracy_bits()) for t, _ in shaper.impulses[1:])
    if accuracy < bits_for_digits(inner):
        message = f"the shaper has {shaper.digits} digits, too few for a response with {digits}"
        raise refused(message, "make a shaper with more digits")
    unshaped = time_response(bound, kind, times, inner)
    (_, first), *others = shaper.impulses  # the first stands at 0
    with precision(shaper.bits):
        total = [y * first for y in unshaped.enclosures]
        impulses = [ImpulseAt(i.time, i.order, first * i.weight) for i in unshaped.impulses]
        jumps = [JumpAt(j.time, first * j.height) for j in unshaped.jumps]
        seconds = times.enclosed()
        last = seconds[-1] if seconds else arb(0)
    begun = time_response(bound, kind, SampleTimes.of([0.0, float(last.mid()) or 1.0]), inner).enclosures[0]
    for moment, amplitude in others:
        with precision(shaper.bits):
            start, later = times.since(moment)
        part = time_response(bound, kind, later, inner)
        with precision(shaper.bits):
            for i, value in zip(range(start, len(seconds)), part.enclosures, strict=False):
                # At its own moment nobody knows on which side of it the time lies.
                here = value if seconds[i] > moment else value.union(arb(0))
                total[i] = total[i] + amplitude * here
            if not begun.contains(0):
                jumps.append(JumpAt(moment, amplitude * begun))
            impulses += [ImpulseAt(moment + i.time, i.order, amplitude * i.weight) for i in unshaped.impulses]
            jumps += [JumpAt(moment + j.time, amplitude * j.height) for j in unshaped.jumps]
    return replace(
        unshaped,
        enclosures=tuple(total),
        impulses=tuple(sorted((i for i in impulses if not i.time > last), key=lambda i: i.time.mid())),
        jumps=tuple(sorted((j for j in jumps if not j.time > last), key=lambda j: j.time.mid())),
        digits=digits,
        shaper=shaper.kind,
    )


def _of_network(bound: BoundNested, integrations: int, times: SampleTimes) -> Sampled:
    """Return the response of a network with waves that nobody writes out."""
    propagation = equations_of(bound).propagation
    laws = () if propagation is None else propagation.table.dispersions
    if any(law.kind == "exponential" for law in laws):
        message = (
            f"{bound.name} belongs to a large network with delays, whose response in time is not available"
        )
        raise ModelError(Diagnostic("SF813", message, None, "approximate it with 'symflex rational' first"))
    return estimated(bound, integrations, times)


def _answer(asked: Asked) -> Sampled:
    """Return what the first way finds that answers, and why those before it do not."""
    refused: dict[str, list[str]] = {}
    for way in WAYS:
        plan = way.applies(asked)
        try:
            answer = plan if isinstance(plan, Refused) else plan()
        except TooManyEchoesError:
            answer = Refused("too many echoes arrive by then")
        if isinstance(answer, Sampled):
            reasons = tuple(f"{', '.join(names)}: {reason}" for reason, names in refused.items())
            return replace(answer, refused=answer.refused or reasons) if answer.reason else answer
        if answer.reason:
            refused.setdefault(answer.reason, []).append(way.name)
        spend()
    message = f"poles of {asked.bound.name} cannot be separated: its response is not known"
    raise UncertifiedError(Diagnostic("SF810", message, None, "ask for a shorter time, or fewer digits"))


def _by_echoes(asked: Asked) -> Plan | Refused:
    if asked.quotient is None:
        return Refused(asked.why_no_quotient)
    return partial(_closely, asked, partial(echoed, asked.quotient, asked.integrations))


def _by_settling(asked: Asked) -> Plan | Refused:
    if asked.quotient is None or not asked.has_delays:
        return Refused()
    if not asked.integrations:
        return Refused("the bound on all other poles is one on steps and ramps")
    if not falls_off(asked.quotient):
        return Refused("delayed terms do not fall off at high frequencies")
    goal = asked.digits + EFFORT.guard_digits
    find = partial(settled, asked.bound, asked.quotient, asked.integrations, goal)
    return partial(_closely, asked, find, "the poles right of a line are not separated")


def _by_wave_echoes(asked: Asked) -> Plan | Refused:
    if asked.bound.is_rational or asked.quotient is not None:
        return Refused()
    waves = wave_quotient(asked.bound)
    if isinstance(waves, str):
        return Refused(waves)
    return partial(_closely, asked, partial(waves.echoed, asked.integrations))


def _by_hyperbolas(asked: Asked) -> Plan | Refused:
    if asked.bound.sheets == 1:
        return Refused()
    later = _by_delays(asked)
    return partial(along_hyperbolas, asked) if isinstance(later, Refused) else later


def _by_delays(asked: Asked) -> Plan | Refused:
    if not asked.has_delays or asked.quotient is not None:
        return Refused()
    kernels = [k for k in asked.bound.kernels.kernels if k.dispersion.kind == "exponential"]
    delays = [k for k in kernels if _is_delay(k, asked.bound.sheets)]
    if asked.bound.sheets == 1 and len(delays) < len(kernels):
        return Refused("what is delayed changes its form")
    parts = _taken_apart(asked.bound, delays)
    return partial(_later, asked, parts) if any(delay for delay, _ in parts) else Refused()


def _is_delay(kernel: Kernel, sheets: int) -> bool:
    """Tell whether a kernel is ``exp(-s T - a)``, with s as a power of its root."""
    powers = polynomial_in_s(kernel.dispersion.shift, sheets)
    return powers is not None and all(p.is_zero for p in powers[1:-1])


def _by_modes(
    find: Callable[[BoundTransferFunction, int], tuple[ModesBound, int] | Refused], asked: Asked
) -> Plan | Refused:
    if asked.has_delays or asked.bound.is_rational:
        return Refused("there is a delay in a loop")
    bound = find(asked.bound, asked.integrations)
    return bound if isinstance(bound, Refused) else partial(_summed, asked, *bound)


def _by_estimate(asked: Asked) -> Plan | Refused:
    if asked.bound.is_rational:
        return Refused()
    return partial(estimated, asked.bound, asked.integrations, asked.times)


WAYS = (
    Way("hyperbolas", _by_hyperbolas),
    Way("partial fractions", lambda a: partial(_of_lumped, a) if a.bound.is_rational else Refused()),
    Way("echoes", _by_echoes),
    Way("settled echoes", _by_settling),
    Way("wave echoes", _by_wave_echoes),
    Way("delayed parts", _by_delays),
    *(Way(name, partial(_by_modes, find)) for name, find in BOUNDS.items()),
    Way("estimated modes", _by_estimate),
)  # in the order in which they are asked: exact ones first, then those that take the least time


def _summed(asked: Asked, bounding: ModesBound, integrations: int) -> Sampled | Refused:
    modal_sum = summed(bounding, integrations, asked.times, asked.digits)
    if modal_sum is None:
        return Refused("the contributions of the modes do not decay fast enough")
    return modal_sum.sampled


def _closely(
    asked: Asked,
    find: Callable[[SampleTimes, int], Sampled | None],
    reason: str = "the poles between the delays lie too close together",
) -> Sampled | Refused:
    """Return a response from ever more digits and sharper times, until it is precise."""
    times, wanted = asked.times, asked.digits + EFFORT.guard_digits
    for _ in range(EFFORT.attempts):
        sampled = find(times, wanted)
        if sampled is not None:
            apart = [y for i, y in enumerate(sampled.values) if i not in sampled.at_jumps]
            if is_precise(apart, asked.digits) and (times.is_exact or not sampled.at_jumps):
                return sampled
            times = times if times.is_exact else times.one_by_one()
        wanted *= 2
    return Refused(reason)


def _taken_apart(
    bound: BoundTransferFunction, late: Sequence[Kernel]
) -> list[tuple[Delays, BoundTransferFunction]]:
    """Return a function as parts after delays, as of late sensors: ``(1 + exp(-s T)) w(l)/F``."""
    ring, table = bound.ratio.ring, bound.kernels
    delays = {ring.index[k.generator]: k for k in late}
    if any(bound.den.exponent_of(ring.generator(k.generator)) > 0 for k in delays.values()):
        raise too_early()
    plain, mixed = Factored(ring, bound.num.unit), ring.constant(1)
    for factor, exponent in bound.num.factors:
        if exponent > 0 and any(degree_in(factor, index) for index in delays):
            mixed = mixed * factor**exponent
        else:
            plain = plain * Factored.polynomial(ring, factor) ** exponent
    parts, delayed = coefficients_of(ring, mixed, tuple(delays)), []
    for exponents, coefficient in parts.items():
        num = plain * Factored.polynomial(ring, coefficient)
        ratio = num / bound.den
        out = [k for k in delays.values() if not ratio.depends_on(k.generator)]
        kernels = tuple(k for k in table.kernels if k not in out)
        laws = tuple(law for law in table.dispersions if any(k.dispersion is law for k in kernels))
        part = replace(
            bound,
            ratio=ratio,
            parts=(num, bound.den),
            kernels=KernelTable(laws, kernels),
            hidden=(),
            is_of_model=bound.is_of_model and len(parts) == 1,
        )
        delayed.append(([(k, e) for k, e in zip(delays.values(), exponents, strict=True) if e], part))
    return delayed


def _later(asked: Asked, parts: list[tuple[Delays, BoundTransferFunction]]) -> Sampled:
    """Return the sum of responses that come after delays."""
    bits, evaluator = bits_for_digits(2 * asked.digits), asked.bound.kernel_values()
    sampled = Sampled(())
    with precision(bits):
        total = Gathered(asked.times.enclosed())
        constants = {name: acb(c) for name, c in evaluator.constants.items()}
        waits, gains, root = [], [], asked.bound.root
        slope, begin = (arb(1), arb(0)) if root is None else (root.slope, root.shift)
        for delays, _ in parts:
            wait, gain = arb(0), arb(1)
            for kernel, exponent in delays:
                shift = kernel.dispersion.shift * kernel.length
                low, high = (at_centre(evaluator.value(shift, {"s": acb(x), **constants})) for x in (0, 1))
                rate = high - low  # of s, or of the power of its root that s stands in
                wait += exponent * (rate * slope).real
                gain *= (-exponent * (low + rate * begin)).exp().real
            waits.append(wait)
            gains.append(gain)
    reason: str | None = None
    refused: tuple[str, ...] = ()
    for wait, gain, (_, part) in zip(waits, gains, parts, strict=True):
        with precision(bits):
            start, later = asked.times.since(wait)
        if len(later):
            sampled = _answer(replace(asked, bound=part, times=later))
            reason, refused = reason or sampled.reason, refused or sampled.refused
            with precision(bits):
                delayed = [gain * y for y in sampled.values[: len(asked.times) - start]]
                total.add(wait, (), arb(0), delayed, is_late=bool(wait > 0))
    return replace(total.sampled(sampled.method), reason=reason, refused=refused)


def _of_lumped(asked: Asked) -> Sampled | Refused:
    bound, integrations, times, digits = asked.bound, asked.integrations, asked.times, asked.digits
    problem = problem_of(bound, [(f, -e) for f, e in bound.ratio.factors if e < 0])
    wanted = digits + EFFORT.guard_digits
    for _ in range(EFFORT.attempts):
        spend()
        poles = find_polynomial_roots(problem, wanted)
        bits = max((root.working_bits() for root in poles), default=0) + bits_for_digits(wanted)
        with precision(bits):
            last = arb(float(times.seconds[-1]))
            turned = max((root.natural_frequency() * last for root in poles), default=arb(0), key=arb.mid)
            quotient = EnclosedQuotient.of(bound, bits)
            terms = partial_fractions(quotient, poles, integrations)
            if terms is not None:
                weights, _ = at_infinity(quotient, integrations)
                impulses = tuple(ImpulseAt(arb(0), k, w) for k, w in enumerate(weights) if w != 0)
                # Residues may need all bits that poles have; sums of exponentials need those of their result.
                with precision(bits_for_digits(wanted + decimal_exponent(exact_fraction(turned + 1)) + 1)):
                    sampled = Sampled(tuple(values_of(terms, times)), impulses, method="partial fractions")
                if is_precise(sampled.values, digits):
                    return sampled
                if not times.is_exact:
                    times = times.one_by_one()
        wanted = max(
            2 * wanted, digits + EFFORT.guard_digits + decimal_exponent(exact_fraction(turned + 1)) + 1
        )
        if wanted > EFFORT.most_digits:
            break
    return Refused("poles cannot be separated")
