"""How step responses of loops with delays die away, and the pieces they are made of.

Input: a :class:`DelayedQuotient`, ``H = (N_0 + N_1 e^(-s n_1) + ...)/(D_0 + D_1 e^(-s d_1) + ...)``. Output:
its step response as residues of few poles and a rigorous bound on the rest, which fades, and the pieces it is
made of at first, as exponentials.

    1/(s + 1 + e^(-s)/2)    y = 2/3 + residues + (1/2 pi j) integral of H e^(s t)/s along Re s = -c

with the residues at poles right of that line. The integral is at most ``e^(-c t)`` times that of abs(H/s)
over pi. The poles right of the line are counted by how often ``F = 1 + D_1/D_0 e^(-s d_1) + ...`` turns about
zero on it (Nyquist): far out F is about 1, if the delayed terms fall off against D_0. What passes straight
through, such as 1 in ``s/(s + e^(-s))``, is left out of the integral: after that only its residue remains.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from flint import acb, acb_poly, arb, arb_poly

from symflex.analysis.time_response.delayed_terms import NO_DELAY, Amplitude, Delay, DelayedQuotient, later
from symflex.analysis.time_response.echoes import earliest, echoed, echoes, terms_of_echo
from symflex.analysis.time_response.effort import EFFORT
from symflex.analysis.time_response.modal import proved_at_origin, term_at
from symflex.analysis.time_response.partial_fractions import ExponentialTerm, values_of
from symflex.analysis.time_response.sample_times import SampleTimes
from symflex.analysis.time_response.sampled import Sampled
from symflex.balls import UndecidedError, bits_for_digits, covered, precision
from symflex.budget import spend
from symflex.roots import Modes, Root, RootProblem, find_polynomial_roots
from symflex.roots.functions.kernel_function import KernelFunction
from symflex.roots.locate import locate
from symflex.transfer import BoundTransferFunction


@dataclass(frozen=True, slots=True)
class LateResponse:
    """A step response within ``size * e^(-rate t)`` of some terms, after what passes straight through."""

    terms: tuple[ExponentialTerm, ...]
    size: arb
    rate: arb
    passed: tuple[arb, ...]  # when that arrives [s]


@dataclass(frozen=True)
class LatePolynomial:
    """A polynomial that comes a time [s] later."""

    polynomial: arb_poly
    seconds: arb


class _Loop:
    """A quotient over its leading polynomial D_0, at the current precision."""

    def __init__(self, quotient: DelayedQuotient, digits: int) -> None:
        durations, self.first = quotient.durations, earliest(quotient.below, quotient.durations)

        def late(delay: Delay, amplitude: Amplitude) -> LatePolynomial:
            return LatePolynomial(
                durations.polynomial(amplitude), durations.seconds(later(delay, self.first))
            )

        self.leading = durations.polynomial(quotient.below[self.first])
        self.below = [late(d, p) for d, p in quotient.below.items() if later(d, self.first) != NO_DELAY]
        self.above: list[LatePolynomial] = []
        self.passed: list[arb] = []
        n = self.leading.degree()
        for part in (late(d, p) for d, p in quotient.above.items()):
            if part.polynomial.degree() != n:
                self.above.append(part)
                continue
            # c e^(-s T) passes straight through: H - c e^(-s T) is left, whose numerator is of lower degree.
            c = part.polynomial[n] / self.leading[n]
            proper = (part.polynomial - c * self.leading).coeffs()[:n]
            self.above.append(LatePolynomial(arb_poly(proper), part.seconds))
            self.above += [LatePolynomial(-c * p.polynomial, part.seconds + p.seconds) for p in self.below]
            self.passed.append(part.seconds)
        self._exact, self._digits = durations.exact(quotient.below[self.first]), digits

    @cached_property
    def poles(self) -> tuple[Root, ...]:
        """The roots of D_0."""
        problem = RootProblem(((self._exact, 1),))
        return find_polynomial_roots(problem, self._digits) if self._exact.degree else ()

    @property
    def falls_off(self) -> bool:
        """Whether delayed terms, and H without what passes straight through, fall off far out."""
        n = self.leading.degree()
        parts = (*self.above, *self.below)
        return all(p.polynomial.degree() < n for p in parts) and all(p.seconds >= 0 for p in self.above)

    def turned(self, s: acb) -> acb:
        """Return F."""
        return 1 + _at(self.below, s) / acb_poly(self.leading)(s)

    def value(self, s: acb) -> acb:
        """Return H without what passes straight through."""
        return _at(self.above, s) / (acb_poly(self.leading)(s) + _at(self.below, s))

    def far(self, parts: Sequence[LatePolynomial], rate: arb, radius: arb) -> arb:
        """Return what ``abs(s)`` times the size of a sum over D_0 is at most, far out."""
        n = self.leading.degree()
        size = [abs(c) for c in self.leading.coeffs()]
        least = size[n] - sum((c * radius ** (i - n) for i, c in enumerate(size[:n])), arb(0))
        total = arb(0)
        for part in parts:
            powers = (abs(c) * radius ** (i - n + 1) for i, c in enumerate(part.polynomial.coeffs()))
            total += sum(powers, arb(0)) * (rate * part.seconds).exp()
        return total / least if least > 0 else arb("inf")


def _at(parts: Sequence[LatePolynomial], s: acb) -> acb:
    return sum((acb_poly(p.polynomial)(s) * (-s * p.seconds).exp() for p in parts), acb(0))


def falls_off(quotient: DelayedQuotient) -> bool:
    """Tell whether delayed terms, and H without what passes straight through, fall off far out."""
    with precision(EFFORT.bits):
        return _Loop(quotient, EFFORT.pole_digits).falls_off


def late_response(
    bound: BoundTransferFunction, quotient: DelayedQuotient, digits: int, integrations: int = 1
) -> LateResponse | None:
    """Return what a step response settles into, or a ramp's with more integrations; None if not proved."""
    loop = _Loop(quotient, digits)
    if not loop.falls_off:
        return None
    # Lines lie in units of the inverse of the loop's delay, or where it has none of the largest pole.
    longest = max((p.seconds.upper() for p in loop.below), key=float, default=arb(0))
    fastest = max((abs(pole.enclosure()).upper() for pole in loop.poles), key=float, default=arb(0))
    unit = 1 / longest if longest > 0 else fastest
    below = KernelFunction(bound, bound.ratio.denominator())
    at_zero = (below.order() or 0) if below.power == 1 else 0  # a zero there may take a pole out
    # Without a delayed term in the denominator, the poles right of every line are known: one tells all.
    for share in EFFORT.lines if loop.below else EFFORT.lines[:1]:
        spend()
        rate = (unit * share).mid()
        on_line = _on_line(loop, rate) if rate > 0 else None
        if on_line is None:
            continue
        size, count = on_line
        poles, cancelled = _right_of(bound, rate, count - at_zero, digits)
        found = (*poles, *cancelled)
        if sum(p.multiplicity for p in found) != count - at_zero or not all(p.certified for p in found):
            continue
        terms = [term_at(bound, root, integrations) for root in poles if not root.im < 0]
        origin = proved_at_origin(bound, integrations)
        if origin is not None and None not in terms:
            return LateResponse(
                (*origin, *filter(None, terms)), size / rate ** (integrations - 1), rate, tuple(loop.passed)
            )
    return None


def settled(
    bound: BoundTransferFunction,
    quotient: DelayedQuotient,
    integrations: int,
    goal: int,
    times: SampleTimes,
    digits: int,
) -> Sampled | None:
    """Return a response to a step or ramp: echoes, then residues once bounded by the ``goal``; or None."""
    with precision(bits_for_digits(2 * digits)):
        late = late_response(bound, quotient, digits, integrations)
        if late is None:
            return None
        seconds, summed = times.enclosed(), values_of(late.terms, times)
        largest = max((abs(y.mid()) for y in summed), default=arb(0))
        rests = [(late.size * (-late.rate * t).exp()).upper() for t in seconds]
        negligible = largest * arb(10) ** -goal
        begins = next(
            (
                i
                for i, (t, tail) in enumerate(zip(seconds, rests, strict=True))
                if tail < negligible and all(t > passed for passed in late.passed)
            ),
            len(rests),
        )
        values = [y + arb(0, tail) for y, tail in zip(summed[begins:], rests[begins:], strict=True)]
    early = echoed(quotient, integrations, replace(times, seconds=times.seconds[:begins]), digits)
    if early is None:
        return None
    return replace(early, values=(*early.values, *values), method="settled echoes")


def _right_of(
    bound: BoundTransferFunction, rate: arb, count: int, digits: int
) -> tuple[list[Root], list[Root]]:
    """Return so many poles right of a line but at 0, without those a zero is proved to take out."""
    poles: list[Root] = []
    cancelled: list[Root] = []
    for more in (0, EFFORT.line_modes) if count else ():
        located = locate(bound, Modes(count + more), digits)
        shared = [h for h in located.hidden if h.cause == "coincident"]
        roots = (*located.all_poles, *(h.root for h in shared if not h.is_exact))
        parts = (roots, [h.root for h in shared if h.is_exact])
        poles, cancelled = (
            [p for p in part if p.enclosure().real + rate > 0 and not p.is_zero] for part in parts
        )
        if sum(p.multiplicity for p in (*poles, *cancelled)) == count:
            break
    return poles, cancelled


def _on_line(loop: _Loop, rate: arb) -> tuple[arb, int] | None:
    """Return the integral of abs(H/s) along a line over pi, and the poles right of it, None if too close."""
    radius = (1 + rate).mid()
    while not loop.far(loop.below, rate, radius) < radius / 2:
        radius = radius * 2
        if not radius < arb(10) ** 30:
            return None
    right = 0
    for pole in loop.poles:
        distance = pole.enclosure().real + rate
        if distance.contains(0):
            return None
        right += pole.multiplicity if distance > 0 else 0
    # Beyond the radius F is at least 1/2, and H/s falls as one over s squared.
    total = 2 * loop.far(loop.above, rate, radius) / radius
    left = iter(range(EFFORT.line_parts))

    def on_part(low: float, high: float) -> tuple[arb, arb] | None:
        if next(left, None) is None:
            raise UndecidedError
        start, end = (acb(-rate, radius * t) for t in (low, high))
        part = start.union(end)
        value = loop.value(part) / part
        if loop.turned(part).contains(0) or not value.is_finite():
            return None
        return (loop.turned(end) / loop.turned(start)).arg(), value.abs_upper() * (radius * (high - low))

    turned = loop.turned(acb(-rate, radius)).arg()
    try:
        for _, _, (turn, size) in covered(on_part, EFFORT.line_begun, 0.0):
            turned, total = turned - turn, total + size
    except UndecidedError:
        return None
    # The rest of the way around is an arc on which F stays within 1/2 of 1.
    count = right + turned / arb.pi()
    turns = count.unique_fmpz()
    return None if turns is None else ((total / arb.pi()).upper(), int(turns))


def pieces_of(
    quotient: DelayedQuotient, until: arb, digits: int
) -> list[tuple[arb, tuple[ExponentialTerm, ...]]] | None:
    """Return a step response's pieces, start and terms, up to a time [s]; None if poles stay close."""
    loop = _Loop(quotient, digits)
    below = acb_poly(loop.leading)
    pieces: list[tuple[arb, tuple[ExponentialTerm, ...]]] = []
    by_exponents: dict[tuple[tuple[int, ...], ...], ExponentialTerm] = {}
    before = arb(0)
    for echo in echoes(quotient, until):
        spend()
        start = quotient.durations.seconds(echo.delay)
        terms = terms_of_echo(echo, below, loop.poles, 1)
        if terms is None:
            return None
        if not pieces and start > 0:
            pieces.append((arb(0), ()))
        by_exponents = {key: term.later(start - before) for key, term in by_exponents.items()}
        for term in terms:
            key = tuple(tuple(map(int, x.mid().man_exp())) for x in (term.rate.real, term.rate.imag))
            by_exponents[key] = by_exponents[key] + term if key in by_exponents else term
        pieces.append((start, tuple(by_exponents.values())))
        before = start
    return pieces
