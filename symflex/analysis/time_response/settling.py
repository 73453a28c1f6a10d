"""How responses of loops with delays die away, and the pieces they are made of.

Input: a :class:`DelayedQuotient`, ``H = (N_0 + N_1 e^(-s n_1) + ...)/(D_0 + D_1 e^(-s d_1) + ...)``.
Output: its response to a step or another input as residues of few poles and a proved bound on the rest,
which fades, and the pieces it is made of at first, as exponentials.

    1/(s + 1 + e^(-s)/2)    y = 2/3 + residues + (1/2 pi j) integral of H e^(s t)/s along Re s = -c

with the residues at poles right of that line. The integral is at most ``e^(-c t)`` times that of abs(H/s)
over pi. The poles right of the line are counted by how often ``F = 1 + D_1/D_0 e^(-s d_1) + ...`` turns about
zero on it (Nyquist): far out F is about 1, if the delayed terms fall off against D_0. What passes straight
through, such as e^(-s) in s e^(-s)/(s + 1), is no part of the integral: it has come and is over.

Late values are those of the residues, early ones echoes (:mod:`~symflex.analysis.time_response.echoes`), so
that a loop may be run through any number of times.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

from flint import acb, acb_poly, acb_series, arb, arb_poly

from symflex.analysis.rational.laurent import series_length
from symflex.analysis.time_response.delayed_terms import NO_DELAY, later
from symflex.analysis.time_response.echoes import TooManyEchoesError, earliest, echoed, echoes, terms_of_echo
from symflex.analysis.time_response.effort import EFFORT
from symflex.analysis.time_response.partial_fractions import ExponentialTerm, values_of
from symflex.analysis.time_response.sampled import ImpulseAt, JumpAt
from symflex.budget import spend
from symflex.roots import Modes
from symflex.roots.locate import locate
from symflex.roots.polynomial_roots import find_polynomial_roots
from symflex.roots.precision import bits_for_digits, precision
from symflex.roots.problem import RootProblem

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.analysis.time_response.delayed_terms import DelayedQuotient
    from symflex.analysis.time_response.sample_times import SampleTimes
    from symflex.analysis.time_response.sampled import Sampled
    from symflex.roots import Root
    from symflex.transfer import BoundTransferFunction


@dataclass(frozen=True, slots=True)
class LateResponse:
    """A response within ``size * e^(-rate t)`` of some terms, at every time t [s] after all ``through``."""

    terms: tuple[ExponentialTerm, ...]
    size: arb
    rate: arb
    through: tuple[JumpAt, ...]  # by which the input passes straight through, as a step would show it


@dataclass(frozen=True)
class LatePolynomial:
    """A polynomial that comes a time [s] later."""

    polynomial: arb_poly
    seconds: arb


class _Loop:
    """A quotient over its leading polynomial D_0, at the current precision."""

    def __init__(self, quotient: DelayedQuotient, digits: int) -> None:
        durations, self.first = quotient.durations, earliest(quotient.below, quotient.durations)
        self.leading = durations.polynomial(quotient.below[self.first])
        self.above = [
            LatePolynomial(durations.polynomial(p), durations.seconds(later(d, self.first)))
            for d, p in quotient.above.items()
        ]
        self.below = [
            LatePolynomial(durations.polynomial(p), durations.seconds(later(d, self.first)))
            for d, p in quotient.below.items()
            if later(d, self.first) != NO_DELAY
        ]
        exact = durations.exact(quotient.below[self.first])
        self.poles = find_polynomial_roots(RootProblem(((exact, 1),)), digits) if exact.degree else ()

    def taken_apart(self) -> tuple[list[LatePolynomial], list[JumpAt]] | None:
        """Return the numerator without what passes straight through, and that.

        With ``N_i = q D_0 + R`` it is q e^(-s n_i), and leaves R e^(-s n_i) less q times all later D_k. None
        where the numerator is of a higher degree than D_0.
        """
        n = self.leading.degree()
        falling, through = [], []
        for part in self.above:
            if part.polynomial.degree() < n:
                falling.append(part)
                continue
            if part.polynomial.degree() > n:
                return None
            q, remainder = divmod(part.polynomial, self.leading)
            falling.append(LatePolynomial(remainder, part.seconds))
            falling += [LatePolynomial(-q * p.polynomial, part.seconds + p.seconds) for p in self.below]
            through.append(JumpAt(part.seconds, q[0]))
        return falling, through

    def turned(self, s: acb) -> acb:
        """Return F."""
        return 1 + _at(self.below, s) / acb_poly(self.leading)(s)

    def over_all(self, above: Sequence[LatePolynomial], s: acb) -> acb:
        """Return a numerator over the whole denominator."""
        return _at(above, s) / (acb_poly(self.leading)(s) + _at(self.below, s))

    def term(self, pole: acb, multiplicity: int, integrations: int) -> ExponentialTerm:
        """Return what a pole of H leaves of the response to 1/s^integrations, together with its conjugate."""
        order = multiplicity + (integrations if pole.is_zero() else 0)
        with series_length(order + multiplicity):
            above = _about(self.above, pole)
            below = _about([LatePolynomial(self.leading, arb(0)), *self.below], pole)
            # At its pole the denominator is zero so often, whatever the balls say.
            below = acb_series([below[k] for k in range(multiplicity, order + multiplicity)])
            for _ in range(0 if pole.is_zero() else integrations):
                below = below * acb_series([pole, 1])
            series = above / below
            both = 1 if pole.imag == 0 else 2
            return ExponentialTerm(pole, tuple(both * series[order - 1 - j] for j in range(order)))

    def far(self, parts: Sequence[LatePolynomial], rate: arb, radius: arb, falls: int = 1) -> arb:
        """Return what ``abs(s)^falls`` times the size of a sum over D_0 is at most, far out."""
        n = self.leading.degree()
        size = [abs(c) for c in self.leading.coeffs()]
        least = size[n] - sum((c * radius ** (i - n) for i, c in enumerate(size[:n])), arb(0))
        if not least > 0:
            return arb("inf")
        total = arb(0)
        for part in parts:
            own = sum(
                (abs(c) * radius ** (i - n + falls) for i, c in enumerate(part.polynomial.coeffs())), arb(0)
            )
            total += own * (rate * part.seconds).exp()
        return total / least


def _about(parts: Sequence[LatePolynomial], place: acb) -> acb_series:
    """Return a sum of polynomials that come later as a series about a place."""
    total = acb_series([0])
    for p in parts:
        own = acb_poly(p.polynomial)(acb_poly([place, 1]))
        total += acb_series(own.coeffs()) * acb_series([-place * p.seconds, -p.seconds]).exp()
    return total


def _at(parts: Sequence[LatePolynomial], s: acb) -> acb:
    return sum((acb_poly(p.polynomial)(s) * (-s * p.seconds).exp() for p in parts), acb(0))


def late_response(
    bound: BoundTransferFunction, quotient: DelayedQuotient, integrations: int, digits: int
) -> LateResponse | None:
    """Return what a response settles into, at the current precision, from poles of so many digits.

    None where that is not proved: delayed terms do not fall off against D_0, or H grows with s, or, for an
    impulse, does not fall off faster than 1/s.
    """
    loop = _Loop(quotient, digits)
    n = loop.leading.degree()
    apart = loop.taken_apart()
    if apart is None or any(p.polynomial.degree() >= n for p in loop.below):
        return None
    falling, through = apart
    falls = 1 if integrations else 2
    if any(p.polynomial.degree() > n - falls for p in falling) or any(not p.seconds >= 0 for p in loop.above):
        return None
    # Lines lie in units of the inverse of the loop's delay, or where it has none of the largest pole.
    longest = max((p.seconds.upper() for p in loop.below), key=float, default=arb(0))
    fastest = max((abs(pole.enclosure()).upper() for pole in loop.poles), key=float, default=arb(0))
    unit = 1 / longest if longest > 0 else fastest
    for share in EFFORT.lines:
        spend()
        rate = (unit * share).mid()
        on_line = _on_line(loop, falling, falls, integrations, rate) if rate > 0 else None
        if on_line is None:
            continue
        size, count = on_line
        poles = _right_of(bound, rate, count, digits)
        if sum(p.multiplicity for p in poles) != count or not all(p.certified for p in poles):
            continue
        places = [(p.enclosure(), p.multiplicity) for p in poles if not p.im < 0]
        if integrations and not any(place.is_zero() for place, _ in places):
            places.append((acb(0), 0))
        terms = tuple(loop.term(place, order, integrations) for place, order in places)
        return LateResponse(terms, size, rate, tuple(through))
    return None


def settling_echoes(
    bound: BoundTransferFunction,
    quotient: DelayedQuotient,
    integrations: int,
    times: SampleTimes,
    digits: int,
) -> Sampled | None:
    """Return echoes at first, then the few terms that a response settles into; poles have so many digits.

    None where more digits may help. TooManyEchoesError where it does not settle, or only after too many.
    """
    with precision(bits_for_digits(2 * digits)):
        late = late_response(bound, quotient, integrations, digits)
        settled = None if late is None else _settled(late, times, digits)
    if late is None or settled is None:
        raise TooManyEchoesError
    start, values = settled
    early = echoed(quotient, integrations, times.until(start), digits)
    if early is None:
        return None
    through = sorted(late.through, key=lambda each: float(each.time))
    return replace(
        early,
        values=(*early.values, *values),
        impulses=tuple(ImpulseAt(each.time, 0, each.height) for each in through if not integrations),
        jumps=tuple(each for each in through if integrations == 1 and each.time > 0),
        method="settling echoes",
    )


def _settled(late: LateResponse, times: SampleTimes, digits: int) -> tuple[int, list[arb]] | None:
    """Return from which number on a response has settled, and its values then, at the current precision.

    None where it does not by the last time.
    """
    values = values_of(late.terms, times)
    allowed = max((abs(y.mid()) for y in values), default=arb(0)) * arb(10) ** -digits
    for start, t in enumerate(times.enclosed()):
        left = late.size * (-late.rate * t).exp()
        if left < allowed and all(t > each.time for each in late.through):
            return start, [y + arb(0, left.upper()) for y in values[start:]]
    return None


def _right_of(bound: BoundTransferFunction, rate: arb, count: int, digits: int) -> list[Root]:
    """Return the poles right of a line, of which there are so many; fewer where these are not the lowest."""
    poles: list[Root] = []
    for more in (0, EFFORT.line_modes) if count else ():
        found = locate(bound, Modes(count + more), digits)
        poles = [p for p in found.all_poles if p.enclosure().real + rate > 0]
        if sum(p.multiplicity for p in poles) == count:
            break
    return poles


def _on_line(
    loop: _Loop, falling: Sequence[LatePolynomial], falls: int, integrations: int, rate: arb
) -> tuple[arb, int] | None:
    """Return the integral of abs(H/s^integrations) along a line over pi, and how many poles are right of it.

    Far out H falls at least as ``1/s^falls``. None where a pole is too close to the line.
    """
    radius = (1 + rate).mid()
    while not loop.far(loop.below, rate, radius) < radius / 2:
        radius = radius * 2
        if not radius < arb(10) ** 30:
            return None
    right = 0
    for pole in loop.poles:
        place = pole.enclosure().real + rate
        if place.contains(0):
            return None
        right += pole.multiplicity if place > 0 else 0
    # Beyond the radius F is at least 1/2, and H/s^integrations falls as one over s squared, or faster.
    power = integrations + falls - 1
    total = 2 * loop.far(falling, rate, radius, falls) / (power * radius**power)
    turned = arb(0)
    ends = [radius * k / EFFORT.line_begun for k in range(EFFORT.line_begun + 1)]
    pending = [(a.mid(), b.mid()) for a, b in pairwise(ends)][::-1]
    for _ in range(EFFORT.line_parts):
        if not pending:
            break
        low, high = pending.pop()
        middle = ((low + high) / 2).mid()
        part = acb(-rate, middle + arb(0, ((high - low) / 2).abs_upper()))
        turns, value = loop.turned(part), loop.over_all(falling, part) / part**integrations
        if turns.contains(0) or not value.is_finite():
            pending += [(middle, high), (low, middle)]
            continue
        turned += (loop.turned(acb(-rate, high)) / loop.turned(acb(-rate, low))).arg()
        total += value.abs_upper() * (high - low)
    else:
        return None
    # The rest of the way around is an arc on which F stays within 1/2 of 1.
    count = right + (loop.turned(acb(-rate, radius)).arg() - turned) / arb.pi()
    whole = count.unique_fmpz()
    return None if whole is None else ((total / arb.pi()).upper(), int(whole))


def pieces_of(
    quotient: DelayedQuotient, until: arb, digits: int
) -> list[tuple[arb, tuple[ExponentialTerm, ...]]] | None:
    """Return a step response as pieces up to a time [s]: when each begins, and its terms from then on.

    None where poles are not told apart. Raises TooManyEchoesError.
    """
    loop = _Loop(quotient, digits)
    below = acb_poly(loop.leading)
    found: list[tuple[arb, tuple[ExponentialTerm, ...]]] = []
    known: dict[tuple[tuple[int, ...], ...], ExponentialTerm] = {}
    before = arb(0)
    for echo in echoes(quotient, until):
        spend()
        start = quotient.durations.seconds(echo.delay)
        terms = terms_of_echo(echo, below, loop.poles, 1)
        if terms is None:
            return None
        if not found and start > 0:
            found.append((arb(0), ()))
        known = {key: term.later(start - before) for key, term in known.items()}
        for term in terms:
            key = tuple(tuple(map(int, x.mid().man_exp())) for x in (term.rate.real, term.rate.imag))
            known[key] = known[key] + term if key in known else term
        found.append((start, tuple(known.values())))
        before = start
    return found
