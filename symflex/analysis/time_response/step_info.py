"""What control engineers ask of a step response: where it ends, how far it overshoots, how long it takes.

Input: the exponentials that a step response is made of. Output: :class:`StepInfo`, every number enclosed.

Over a whole interval of times the response lies in a ball, its value in the middle and its slope's ball times
half the width; from some time on a sum of decaying exponentials bounds it. So an interval whose ball lies
below the highest value found contains no peak, one whose ball leaves out a level no crossing of it; what is
found first, or last, is proved to be the first, or the last.

With delays the response is made of pieces, each a sum of exponentials, until what residues of few poles leave
out has faded (see :mod:`symflex.analysis.time_response.settling`). With waves it is made of pieces too:
the later one begins, the fewer modes are still alive, and the smoother it is.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

from flint import acb, arb

from symflex.analysis.time_response.delayed_terms import delayed_quotient
from symflex.analysis.time_response.echoes import TooManyEchoesError
from symflex.analysis.time_response.modal import proved_modes
from symflex.analysis.time_response.partial_fractions import (
    EnclosedQuotient,
    ExponentialTerm,
    partial_fractions,
)
from symflex.analysis.time_response.sample_times import SampleTimes, default_until
from symflex.analysis.time_response.sampled import PartialSum
from symflex.analysis.time_response.settling import late_response, pieces_of
from symflex.balls import Open, bits_for_digits, branch, precision
from symflex.model.loss_factors import check_causal
from symflex.print.text import Passage
from symflex.roots.functions.simplified import without_lengths_of_zero
from symflex.roots.polynomial_roots import find_polynomial_roots
from symflex.roots.problem import problem_of
from symflex.roots.root import figure, real_json
from symflex.transfer import AnyBoundFunction, BoundTransferFunction

RISE = (0.1, 0.9)  # shares of the final value between which the rise time is counted
SETTLED = 0.02  # share of the final value within which a response has settled
TEXT_DIGITS, SHORT_DIGITS, PERCENT_DIGITS = 10, 4, 4
CLOSE = 1e-6  # share of the final value: a maximum that is no higher above it is no peak
MOST_WORK = 200_000  # terms summed for one number, a second: a mode that rings a thousand times takes some
ECHO_DERIVATIVES = 8  # terms of a piece's Taylor polynomial: six of a pole near 0 may cancel to 1e-13
HALVINGS = 50
MORE_DIGITS = 10  # digits of poles beyond those printed: differences of their terms lose some
MODES_DIGITS, MOST_MODES = 8, 100  # digits of responses of waves, and modes for these: more cost digits
MODES_BITS = 128
DELAYS_DIGITS = 60  # digits of poles of loops with delays: high powers of their differences lose some
FADED = 1e-11  # share of the final value that a response with delays may have when residues take over
SMOOTH_MODES = (400, 40, 20, 10, 5, 3)  # terms of a piece of waves, in turn: few are smooth, many sharp
DEAD = 1e-14  # share of the final value below which a mode is left out
TOUCHED = arb("nan")  # in place of a time: a response touches the level there, or passes it twice
MOST_PIECES = 60
ZERO: Final = arb(0)


@dataclass(frozen=True, slots=True)
class StepInfo:
    """Properties of a step response that comes to rest, each a ball; None if it is not found.

    Times are in seconds, values in the output's unit.
    """

    final: arb  # the value it tends to
    peak: arb | None  # the largest value in the direction of the final one; None if it exceeds that nowhere
    peak_time: arb | None
    overshoot: arb | None  # of the final value, as a fraction; [0, 1e-6] where there is no peak
    rise_time: arb | None  # from the first 10 % to the first 90 % of the final value
    settling_time: arb | None  # after which it stays within 2 % of the final value

    @property
    def missing(self) -> int:
        """How many of the properties are not found."""
        has_none = self.overshoot is not None and self.overshoot.contains(0)
        wanted = (self.overshoot, self.rise_time, self.settling_time)
        return sum(x is None for x in wanted) + (self.peak_time is None and not has_none)

    def __repr__(self) -> str:
        shown = (f"{name.partition(',')[0]} {value}" for name, value in self._shown(SHORT_DIGITS))
        return f"<StepInfo: {', '.join(shown)}>"

    def _repr_html_(self) -> str:
        from symflex.print.html import passages_html  # only notebooks ask

        return passages_html([Passage(["step response"], self._shown(TEXT_DIGITS), has_head=False)])

    def lines(self, unit: str) -> list[str]:
        """Return what is found as text, with ten digits at most."""
        return [f"{name:24} {value}" for name, value in self._shown(TEXT_DIGITS, unit)]

    def _shown(self, digits: int, unit: str = "") -> list[tuple[str, str]]:
        shown = [
            ("final value", self.final, unit, ""),
            ("peak", self.peak, unit, ""),
            ("peak time", self.peak_time, "s", ""),
            ("overshoot", None if self.overshoot is None else 100 * self.overshoot, "%", "not found"),
            ("rise time, 10 % to 90 %", self.rise_time, "s", "not found"),
            ("settling time, to 2 %", self.settling_time, "s", "not found"),
        ]
        rows = []
        for name, ball, of, without in shown:
            if ball is None:
                rows += [(name, without)] if without else []
                continue
            if ball.contains(0) and not ball.is_zero():
                said = f"none above {float(ball.abs_upper()):.1g}"
            else:
                said = figure(ball, min(digits, PERCENT_DIGITS) if of == "%" else digits)
            rows.append((name, said if of in ("", "1") else f"{said} {of}"))
        return rows

    def to_json_dict(self, digits: int) -> dict[str, object]:
        """Return every number as ``value`` and ``radius``, null where it is not found."""
        names = ("final", "peak", "peak_time", "overshoot", "rise_time", "settling_time")
        return {name: real_json(getattr(self, name), digits) for name in names}


def find_step_info(
    bound: AnyBoundFunction, digits: int = 12, modes: PartialSum | None = None
) -> StepInfo | None:
    """Return the properties of a step response, from poles to so many digits, or from a known sum.

    The result is None where it does not come to rest, or at 0, and where poles or modes are not bounded.
    """
    check_causal(bound.source.model, "a step response")
    if not bound.is_reduced:
        return None
    bound = without_lengths_of_zero(bound)
    if bound.is_zero or bound.sheets > 1:
        return None
    if not bound.is_rational:
        return _of_modes(bound, modes)
    wanted = 2 * digits + MORE_DIGITS
    poles = find_polynomial_roots(
        problem_of(bound, [(f, -e) for f, e in bound.ratio.factors if e < 0]), wanted
    )
    bits = max((root.working_bits() for root in poles), default=0) + bits_for_digits(wanted)
    with precision(bits):
        terms = partial_fractions(EnclosedQuotient.of(bound, bits), poles, 1)
        return None if terms is None else step_info(terms)


def _of_modes(bound: BoundTransferFunction, known: PartialSum | None) -> StepInfo | None:
    """Return the properties of a sum over modes; high ones, which make it rough, are a part of its rest."""
    if any(law.kind == "exponential" for law in bound.kernels.dispersions):
        return _of_delays(bound)
    modal_sum = known
    if modal_sum is None:
        modal_sum = proved_modes(
            bound, 1, SampleTimes.of([0.0, default_until(bound)]), MODES_DIGITS, MOST_MODES
        )
    if modal_sum is None:
        return None
    with precision(MODES_BITS):
        final = _resting(modal_sum.terms)
        if final is None:
            return None
        moving = [_scaled(t, final) for t in modal_sum.terms if not t.rate.is_zero()]
        tail = (modal_sum.rest / abs(final)).upper()
        best: StepInfo | None = None
        for count in SMOOTH_MODES:
            info = _told(final, NormalisedResponse(_pieces(moving, count, tail, modal_sum.fade)))
            best = info if best is None or info.missing < best.missing else best
            if not best.missing:
                break
        return best


def _resting(terms: Sequence[ExponentialTerm]) -> arb | None:
    """Return where a response comes to rest; None if it does not, or at 0."""
    resting = [t for t in terms if t.rate.is_zero()]
    final = sum((t.coefficients[0].real for t in resting if t.coefficients), arb(0))
    if any(c != 0 for t in resting for c in t.coefficients[1:]) or final.contains(0):
        return None
    return final if all(t.rate.real < 0 for t in terms if not t.rate.is_zero()) else None


def _pieces(terms: Sequence[ExponentialTerm], count: int, tail: arb, fade: arb) -> list[Piece]:
    """Return a response by its largest terms, in pieces of doubled times, beside ``exp(-fade t)``."""
    lasting = sorted((-1 / t.rate.real for t in terms), key=arb.mid)  # time constants
    starts = [each.mid() for each in lasting[-1:]]
    while starts and starts[-1] > lasting[0] and len(starts) < MOST_PIECES:
        starts.append(starts[-1] / 2)
    pieces = []
    for begins in (arb(0), *reversed(starts)):
        sizes = sorted(
            ((_size(t, begins), t) for t in terms), key=lambda sized: float(sized[0]), reverse=True
        )
        kept = [t for size, t in sizes[:count] if not size < DEAD]
        dropped = sum((size for size, _ in sizes[len(kept) :]), tail * (-fade * begins).exp())
        pieces.append(Piece(tuple(kept), begins, constant=1, rest=dropped.upper()))
    return pieces


def _of_delays(bound: BoundTransferFunction) -> StepInfo | None:
    """Return the properties of a loop whose delays are behind rational functions."""
    quotient = delayed_quotient(bound)
    if quotient is None:
        return None
    with precision(bits_for_digits(2 * DELAYS_DIGITS)):
        late = late_response(bound, quotient, DELAYS_DIGITS)
        final = None if late is None or late.passed else _resting(late.terms)
        if late is None or final is None:
            return None
        terms = tuple(_scaled(t, final) for t in late.terms if not t.rate.is_zero())
        until = ((late.size / abs(final) / FADED).log() / late.rate).max(arb(0)).upper()
        try:
            pieces = pieces_of(quotient, until, DELAYS_DIGITS)
        except TooManyEchoesError:
            pieces = None
        if pieces is None:
            return StepInfo(final, None, None, None, None, None)
        early = [
            Piece(tuple(_scaled(t, final) for t in until_then), start, start) for start, until_then in pieces
        ]
        last = Piece(terms, until, constant=1, rest=arb(FADED))
        return _told(final, NormalisedResponse([*early, last]))


def _scaled(term: ExponentialTerm, final: arb) -> ExponentialTerm:
    return ExponentialTerm(term.rate, tuple(c / final for c in term.coefficients))


def _size(term: ExponentialTerm, t: arb) -> arb:
    """Return the most that a term which decays is from a time on."""
    total = arb(0)
    for j, c in enumerate(term.coefficients):
        # t^j exp(-d t) falls from j/d on.
        latest = t.max(-arb(j) / term.rate.real)
        size = abs(c) * (term.rate.real * latest).exp()
        total += size * latest**j / arb(j + 1).gamma() if j else size
    return total.upper()


def step_info(terms: Sequence[ExponentialTerm]) -> StepInfo | None:
    """Return the properties of a step response; None if it does not come to rest, or at 0.

    >>> lag = [ExponentialTerm(acb(0), (acb(2),)), ExponentialTerm(acb(-1), (acb(-2),))]  # 2 - 2 e^-t
    >>> found = step_info(lag)
    >>> float(found.final), round(float(found.rise_time), 9), round(float(found.settling_time), 9)
    (2.0, 2.197224577, 3.912023005)
    """
    final = _resting(terms)
    if final is None:
        return None
    moving = tuple(_scaled(t, final) for t in terms if not t.rate.is_zero())
    return _told(final, NormalisedResponse([Piece(moving, arb(0), constant=1)]))


def _told(final: arb, motion: NormalisedResponse) -> StepInfo:
    until = motion.quiet(SETTLED)
    if until is None:
        return StepInfo(final, None, None, None, None, None)
    peak = motion.peak()
    rises = [motion.first(level, until) for level in RISE]
    rise = None if rises[0] is None or rises[1] is None else rises[1] - rises[0]
    settling = motion.settling(SETTLED, until)
    if peak is None:
        return StepInfo(final, None, None, None, rise, settling)
    when, height = peak
    return StepInfo(final, height * final if height > 1 else None, when, height - 1, rise, settling)


@dataclass(frozen=True)
class Piece:
    """A sum of exponentials of the time from its origin on, besides a constant, and at most ``rest``."""

    terms: tuple[ExponentialTerm, ...]
    begins: arb
    origin: arb = ZERO
    constant: int = 0
    rest: arb = ZERO

    @cached_property
    def _derivatives(self) -> tuple[tuple[ExponentialTerm, ...], ...]:
        """The first derivatives: terms of echoes nearly cancel, and balls of their slope alone are wide."""
        has_echoes = any(len(term.coefficients) > 1 for term in self.terms)
        derivatives = [tuple(map(_derivative, self.terms))]
        for _ in range(ECHO_DERIVATIVES - 1 if has_echoes else 0):
            derivatives.append(tuple(map(_derivative, derivatives[-1])))
        return tuple(derivatives)

    def at(self, t: arb) -> arb:
        """Return the value of the sum on a ball of times."""
        return self.constant + _sum_of(self.terms, t - self.origin)

    def over(self, low: arb, high: arb) -> arb:
        """Return a ball around the values between two times: Taylor's polynomial at the middle one."""
        middle, half = (low + high) / 2, ((high - low) / 2).abs_upper()
        *inner, last = self._derivatives
        total, reach = self.at(middle), arb(0, half)
        for order, derivative in enumerate(inner, 2):
            total += _sum_of(derivative, middle - self.origin) * reach
            reach = reach * half / order
        return total + _sum_of(last, low.union(high) - self.origin) * reach

    def slope(self, low: arb, high: arb) -> arb:
        """Return a ball around the slopes between two times."""
        return _sum_of(self._derivatives[0], low.union(high) - self.origin)


def _sum_of(terms: Sequence[ExponentialTerm], t: arb) -> arb:
    total = arb(0)
    for term in terms:
        power, polynomial = arb(1), acb(0)
        for j, c in enumerate(term.coefficients):
            power = power * t / j if j else power
            polynomial = polynomial + c * power
        total += ((term.rate * t).exp() * polynomial).real
    return total


@dataclass(frozen=True, slots=True)
class TimeSpan:
    """Times between two, on which a response is one piece."""

    piece: Piece
    low: arb
    high: arb

    @property
    def halves(self) -> tuple[TimeSpan, TimeSpan]:
        """Both halves, the earlier one first."""
        middle = ((self.low + self.high) / 2).mid()
        return TimeSpan(self.piece, self.low, middle), TimeSpan(self.piece, middle, self.high)


@dataclass(frozen=True, slots=True)
class SpanValues:
    """A ball around the values of a piece between two times."""

    span: TimeSpan
    around: arb  # but for the rest

    @property
    def response(self) -> arb:
        """A ball around the values, with the rest."""
        return self.around + arb(0, self.span.piece.rest.upper())

    @property
    def most(self) -> arb:
        """The most that a value may be."""
        return (self.around + self.span.piece.rest).upper()


class NormalisedResponse:
    """A response over its final value: 1 plus exponentials that decay, after pieces of other ones."""

    def __init__(self, pieces: Sequence[Piece]) -> None:
        self.pieces = pieces
        self.is_lost = False  # something could not be decided

    def parts(self, until: arb) -> list[TimeSpan]:
        """Return the pieces up to a time, each with when it begins and ends."""
        starts = [piece.begins for piece in self.pieces[1:] if piece.begins < until]
        ends = zip((arb(0), *starts), (*starts, until), strict=True)
        return [TimeSpan(piece, *each) for piece, each in zip(self.pieces, ends, strict=False)]

    def quiet(self, level: float) -> arb | None:
        """Return a time from which on the response is closer to its end than a level; None without one."""
        last = self.pieces[-1]
        if not last.rest < level / 2:
            return None
        t = min((-1 / term.rate.real for term in last.terms), key=arb.mid, default=arb(1)).mid()
        t = t.max(last.begins).mid()
        while not sum((_size(term, t) for term in last.terms), last.rest) < level:
            t = (2 * t).mid()
        return t

    def peak(self) -> tuple[arb | None, arb] | None:
        """Return when the response is highest and how high, no time if never above 1; None if undecided."""
        close = CLOSE + 4 * float(self.pieces[-1].rest)
        until = self.quiet(close)
        if until is None:
            return None
        shortest = until * arb(2) ** -HALVINGS
        best, work = 1 + arb(close), 0

        def values_on(span: TimeSpan) -> SpanValues:
            nonlocal best
            around = span.piece.over(span.low, span.high)
            best = best.max((around - span.piece.rest).lower())
            return SpanValues(span, around)

        def decide(values: SpanValues) -> SpanValues | Open[SpanValues] | None:
            nonlocal work
            if values.most < best:
                return None
            span = values.span
            work += 2 * len(span.piece.terms)
            is_long = span.high - span.low > shortest and not values.around.rad() < span.piece.rest / 4
            return Open(values) if is_long else values

        search = branch(
            map(values_on, self.parts(until)),
            decide,
            lambda values: [values_on(half) for half in values.span.halves],
            order=lambda values: float(values.most),
            until=lambda *_: work > MOST_WORK,
        )
        if search.unseen:
            return None
        candidates = sorted((v for v in search.decided if not v.most < best), key=lambda v: v.span.low.mid())
        if not candidates:
            return None, arb(1).union(best)
        spans = [values.span for values in candidates]
        if any(a.high < b.low for a, b in itertools.pairwise(spans)):
            return None  # two peaks, maybe
        begun, piece = spans[0].low, spans[0].piece
        if piece.rest == 0 and all(s.piece is piece and piece.slope(s.low, s.high) < 0 for s in spans):
            return begun, piece.at(begun)  # it begins at its peak
        highest = candidates[0].response
        for values in candidates[1:]:
            highest = highest.union(values.response)
        return begun.union(spans[-1].high), highest

    def first(self, level: float, until: arb) -> arb | None:
        """Return when the response first reaches a level below 1; at once, if it begins above."""
        begun = self.pieces[0].at(arb(0)) + arb(0, self.pieces[0].rest)
        if begun > level:
            return arb(0)
        # It has not reached the level before the most that it may be does, and has when the least does.
        most = self.crossing(level, 1, until, is_last=False) if begun < level else arb(0)
        least = self.crossing(level, -1, until, is_last=False)
        return None if most is None or least is None else most.union(least)

    def settling(self, band: float, until: arb) -> arb | None:
        """Return after which time the response stays within a band about 1; None if that is not known."""
        self.is_lost = False
        earliest, latest = arb(0), arb(0)
        for sign in (1, -1):
            outer, inner = (
                self.crossing(1 + sign * band, side * sign, until, is_last=True) for side in (-1, 1)
            )
            earliest = earliest if outer is None else earliest.max(outer)
            latest = latest if inner is None else latest.max(inner)
        return None if self.is_lost else earliest.union(latest)

    def crossing(self, level: float, sign: int, until: arb, *, is_last: bool) -> arb | None:
        """Return when its least or most passes a level first or last; None if never, or ``is_lost``."""
        shortest = until * arb(2) ** -HALVINGS
        before: bool | None = None  # whether it is above the level next to what is looked at now
        unclear: arb | None = None  # where it may be either, between
        work = 0

        def decide(span: TimeSpan) -> arb | Open[TimeSpan] | None:
            nonlocal before, unclear, work
            work += len(span.piece.terms)
            above = span.piece.over(span.low, span.high) - (level - sign * span.piece.rest)
            if above.contains(0):
                if span.high - span.low > shortest:
                    return Open(span)
                between = span.low.union(span.high)
                unclear = between if unclear is None else unclear.union(between)
                return None
            if before is not None and before != (above > 0):
                return (span.high if is_last else span.low) if unclear is None else unclear
            if before is not None and unclear is not None:
                return TOUCHED
            before, unclear = bool(above > 0), None
            return None

        order = -1 if is_last else 1
        search = branch(
            self.parts(until)[::order],
            decide,
            lambda span: span.halves[::order],
            until=lambda found, _: bool(found.decided) or work >= MOST_WORK,
        )
        if search.decided and search.decided[0].is_finite():
            return search.decided[0]
        self.is_lost = self.is_lost or bool(search.decided) or search.unseen > 0 or unclear is not None
        return None


def _derivative(term: ExponentialTerm) -> ExponentialTerm:
    following = (*term.coefficients[1:], acb(0))
    pairs = zip(term.coefficients, following, strict=True)
    return ExponentialTerm(term.rate, tuple(term.rate * c + d for c, d in pairs))
