"""What control engineers ask of a step response: where it ends, how far it overshoots, how long it takes.

Input: the exponentials that a step response is made of. Output: :class:`StepInfo`, every number enclosed.

Over a whole interval of times the response lies in a ball, its value in the middle and its slope's ball times
half the width; from some time on a sum of decaying exponentials bounds it. So an interval whose ball lies
below the highest value found holds no peak, one whose ball leaves out a level no crossing of it, and what is
found first, or last, is proved to be the first, or the last.

With delays the response is made of pieces, each a sum of exponentials, until what residues of few poles leave
out has faded (see :mod:`symflex.analysis.time_response.delayed_decay`). With waves it is made of pieces too:
the later one begins, the fewer modes are still alive, and the smoother it is.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from flint import acb, arb

from symflex.analysis.time_response.delayed_decay import late_response, pieces_of
from symflex.analysis.time_response.delayed_terms import delayed_quotient
from symflex.analysis.time_response.echoes import TooManyEchoesError
from symflex.analysis.time_response.exponentials import ExponentialTerm
from symflex.analysis.time_response.horizon import default_until
from symflex.analysis.time_response.modal import proved_modes
from symflex.analysis.time_response.partial_fractions import EnclosedQuotient, partial_fractions
from symflex.analysis.time_response.sample_times import SampleTimes
from symflex.budget import spend
from symflex.model.loss_factors import check_causal
from symflex.print.text import Passage
from symflex.roots.functions.simplified import without_lengths_of_zero
from symflex.roots.polynomial_roots import find_polynomial_roots
from symflex.roots.precision import bits_for_digits, precision
from symflex.roots.problem import problem_of
from symflex.roots.root import decimals
from symflex.transfer import BoundNested

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.analysis.time_response.modal import PartialSum
    from symflex.transfer import AnyBoundFunction, BoundTransferFunction

RISE = (0.1, 0.9)
"""Of the final value, between which the rise time is counted."""
SETTLED = 0.02
"""Of the final value, within which a response has settled."""
TEXT_DIGITS, SHORT_DIGITS = 10, 4
CLOSE = 1e-6
"""Of the final value: a peak that is no higher above it is none."""
MOST_INTERVALS = 20_000
"""Looked at for one number; a response that rings a thousand times takes some of them each."""
HALVINGS = 50
MORE_DIGITS = 10
"""Of poles: differences of their terms lose some."""
MODES_DIGITS = 8
"""Of responses of waves, of which few high modes are needed then."""
MODES_BITS = 128
DELAYS_DIGITS = 60
"""Of poles of loops with delays: high powers of their differences lose some."""
FADED = 1e-11
"""Of the final value: what is left of a response with delays when residues take the place of its pieces."""
SMOOTH_MODES = (400, 40, 20, 10, 5, 3)
"""Terms of which a piece of a response of waves is made, tried in turn: few are smooth, many are sharp."""
DEAD = 1e-14
"""Of the final value: what a mode is worth when it is left out."""
MOST_PIECES = 60
ZERO: Final = arb(0)


@dataclass(frozen=True, slots=True)
class StepInfo:
    """Properties of a step response that comes to rest, each a ball; None where it is not found.

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
        wanted = (
            self.overshoot,
            self.rise_time,
            self.settling_time,
            *(() if has_none else (self.peak_time,)),
        )
        return sum(each is None for each in wanted)

    def __repr__(self) -> str:
        shown = (f"{name.partition(',')[0]} {value}" for name, value in self._shown(SHORT_DIGITS))
        return f"<StepInfo: {', '.join(shown)}>"

    def _repr_html_(self) -> str:
        from symflex.print.html import passages_html  # only notebooks ask

        rows = self._shown(TEXT_DIGITS)
        return passages_html([Passage(["step response"], rows, has_head=False)])

    def lines(self, unit: str) -> list[str]:
        """Return what is found as text, with ten digits at most."""
        return [f"{name:24} {value}" for name, value in self._shown(TEXT_DIGITS, unit)]

    def _shown(self, digits: int, unit: str = "") -> list[tuple[str, str]]:
        shown = [
            ("final value", self.final, unit),
            ("peak", self.peak, unit),
            ("peak time", self.peak_time, "s"),
            ("overshoot", None if self.overshoot is None else 100 * self.overshoot, "%"),
            ("rise time, 10 % to 90 %", self.rise_time, "s"),
            ("settling time, to 2 %", self.settling_time, "s"),
        ]
        found = []
        for name, ball, of in shown:
            if ball is None:
                continue
            if ball.contains(0) and not ball.is_zero():
                said = f"none above {float(ball.abs_upper()):.1g}"
            else:
                said = decimals(ball, arb(0), digits).re
            found.append((name, said if of in ("", "1") else f"{said} {of}"))
        return found

    def to_json_dict(self, digits: int) -> dict[str, object]:
        """Return every number as ``value`` and ``radius``, null where it is not found."""
        found: dict[str, object] = {}
        for name in ("final", "peak", "peak_time", "overshoot", "rise_time", "settling_time"):
            ball = getattr(self, name)
            told = None if ball is None else decimals(ball, arb(0), digits)
            found[name] = None if told is None else {"value": told.re, "radius": told.radius}
        return found


def find_step_info(
    bound: AnyBoundFunction, digits: int = 12, modes: PartialSum | None = None
) -> StepInfo | None:
    """Return the properties of a step response, from poles of about so many digits, or from a known sum.

    None where it does not come to rest, or at 0, where poles cannot be told apart, with waves in a loop with
    a delay, and with those whose modes are not bounded, as of large networks. With waves, numbers are as
    sharp as the modes left out allow.
    """
    check_causal(bound.source.model, "a step response")
    if isinstance(bound, BoundNested):
        return None
    bound = without_lengths_of_zero(bound)
    if bound.is_zero:
        return None
    if bound.is_distributed:
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
    found = known
    if found is None:
        found = proved_modes(bound, 1, SampleTimes.of([0.0, default_until(bound)]), MODES_DIGITS)
    if found is None:
        return None
    with precision(MODES_BITS):
        final = _resting(found.terms)
        if final is None:
            return None
        moving = [_scaled(t, final) for t in found.terms if not t.rate.is_zero()]
        rest = (found.rest / abs(final)).upper()
        best: StepInfo | None = None
        for count in SMOOTH_MODES:
            info = _told(final, NormalisedResponse(_pieces(moving, count, rest, found.fade)))
            best = info if best is None or info.missing < best.missing else best
            if not best.missing:
                break
        return best


def _resting(terms: Sequence[ExponentialTerm]) -> arb | None:
    """Return where a response comes to rest; None where it does not, or at 0."""
    resting = [t for t in terms if t.rate.is_zero()]
    final = sum((t.coefficients[0].real for t in resting if t.coefficients), arb(0))
    if any(c != 0 for t in resting for c in t.coefficients[1:]) or final.contains(0):
        return None
    return final if all(t.rate.real < 0 for t in terms if not t.rate.is_zero()) else None


def _pieces(terms: Sequence[ExponentialTerm], count: int, rest: arb, fade: arb) -> list[Piece]:
    """Return a response with so many terms at a time, those that are the largest then.

    Each piece begins at twice the time of the one before; ``rest`` falls like ``exp(-fade t)``.
    """
    lasting = sorted((-1 / t.rate.real for t in terms), key=arb.mid)  # time constants
    starts = [each.mid() for each in lasting[-1:]]
    while starts and starts[-1] > lasting[0] and len(starts) < MOST_PIECES:
        starts.append(starts[-1] / 2)
    found = []
    for begins in (arb(0), *reversed(starts)):
        sizes = sorted(((_size(t, begins), t) for t in terms), key=lambda own: float(own[0]), reverse=True)
        kept = [t for size, t in sizes[:count] if not size < DEAD]
        left = sum((size for size, _ in sizes[len(kept) :]), rest * (-fade * begins).exp())
        found.append(Piece(tuple(kept), begins, constant=1, rest=left.upper()))
    return found


def _of_delays(bound: BoundTransferFunction) -> StepInfo | None:
    """Return the properties of a loop whose delays are behind rational functions."""
    quotient = delayed_quotient(bound)
    if quotient is None:
        return None
    with precision(bits_for_digits(2 * DELAYS_DIGITS)):
        late = late_response(bound, quotient, 1, DELAYS_DIGITS)
        final = None if late is None or late.through else _resting(late.terms)
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
        early = [Piece(tuple(_scaled(t, final) for t in own), start, start) for start, own in pieces]
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
    """Return the properties of a step response; None where it does not come to rest, or at 0.

    Examples
    --------
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


class Piece:
    """A sum of exponentials of the time from its origin on, besides a constant, and at most ``rest``."""

    def __init__(
        self,
        terms: tuple[ExponentialTerm, ...],
        begins: arb,
        origin: arb = ZERO,
        constant: int = 0,
        rest: arb = ZERO,
    ) -> None:
        self._orders = [terms]
        self.begins = begins
        self.rest = rest
        self._origin = origin
        self._constant = constant

    @property
    def terms(self) -> tuple[ExponentialTerm, ...]:
        """What is summed."""
        return self._orders[0]

    def at(self, t: arb, order: int = 0) -> arb:
        """Return the value of the sum, or of a derivative, on a ball of times."""
        while len(self._orders) <= order:
            self._orders.append(tuple(_derivative(term) for term in self._orders[-1]))
        total, t = arb(0 if order else self._constant), t - self._origin
        for term in self._orders[order]:
            power, own = arb(1), acb(0)
            for j, c in enumerate(term.coefficients):
                power = power * t / j if j else power
                own = own + c * power
            total += ((term.rate * t).exp() * own).real
        return total

    def over(self, low: arb, high: arb) -> arb:
        """Return a ball around the values between two times."""
        middle, half = (low + high) / 2, (high - low) / 2
        between = middle + arb(0, half.abs_upper())
        return self.at(middle) + self.at(between, 1) * arb(0, half.abs_upper())

    def passed(self, level: arb, low: arb, high: arb, order: int) -> arb:
        """Return where the value, or a derivative, passes a level between two times; it is monotonic there.

        Newton's steps in balls, and halves where these do not yet make it shorter.
        """
        rises = self.at(high, order) > level
        for _ in range(HALVINGS):
            middle = ((low + high) / 2).mid()
            box = middle + arb(0, (high - middle).abs_upper())
            off = self.at(middle, order) - level
            step = middle - off / self.at(box, order + 1)
            if step.is_finite() and step.rad() < box.rad() / 4:
                low, high = step.lower().max(low), step.upper().min(high)
            elif off < 0 or off > 0:
                low, high = (middle, high) if (off < 0) == rises else (low, middle)
            else:
                break
        return (low + high) / 2 + arb(0, ((high - low) / 2).abs_upper())


class NormalisedResponse:
    """A response over its final value: 1 plus exponentials that decay, after pieces of other ones."""

    def __init__(self, pieces: Sequence[Piece]) -> None:
        self.pieces = pieces
        self.is_lost = False  # something could not be told

    def parts(self, until: arb) -> list[tuple[Piece, arb, arb]]:
        """Return the pieces up to a time, each with when it begins and ends."""
        starts = [piece.begins for piece in self.pieces[1:] if piece.begins < until]
        ends = zip((arb(0), *starts), (*starts, until), strict=True)
        return [(piece, *each) for piece, each in zip(self.pieces, ends, strict=False)]

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
        """Return when the response is the highest and how high; no time where it exceeds 1 nowhere.

        None where it cannot be told.
        """
        close = CLOSE + 4 * float(self.pieces[-1].rest)
        until = self.quiet(close)
        if until is None:
            return None
        best = 1 + arb(close)
        parts = self.parts(until)
        found: list[tuple[arb | None, arb]] = []
        # Where a piece begins the slope may change its sign at once.
        for (before, *_), (piece, low, _) in zip((parts[0], *parts), parts, strict=False):
            rest = piece.rest + (2 * before.rest if low > 0 else 0)
            begun = piece.at(low) + arb(0, rest.upper())
            if begun.upper() > best:
                found.append((low if rest == 0 or low == 0 else None, begun))
            best = best.max(begun.lower())

        def most(piece: Piece, low: arb, high: arb) -> float:
            return float((piece.over(low, high) + piece.rest).upper())

        queue = [(-most(*part), -k, *part) for k, part in enumerate(parts)]
        heapq.heapify(queue)
        for count in range(1, MOST_INTERVALS):
            spend()
            if not queue or -queue[0][0] < float(best.lower()):
                break
            _, _, piece, low, high = heapq.heappop(queue)
            middle = ((low + high) / 2).mid()
            box = middle + arb(0, (high - middle).abs_upper())
            if not piece.at(box, 1).contains(0):
                continue  # the largest value is where a piece begins, or next to where the slope vanishes
            if piece.at(box, 2) < 0:
                # The slope falls all the time: there is one maximum at most.
                ends = piece.at(low, 1), piece.at(high, 1)
                if ends[0] > 0 > ends[1]:
                    when = piece.passed(arb(0), low, high, 1)
                    height = piece.at(when) + arb(0, piece.rest)
                    found.append((self._about_peak(piece, when), height))
                    best = best.max(height.lower())
                elif not (ends[0] < 0 or ends[1] > 0):
                    return None
                continue
            if not high - low > until * arb(2) ** -HALVINGS:
                return None
            for k, (a, b) in enumerate(((low, middle), (middle, high))):
                heapq.heappush(queue, (-most(piece, a, b), 2 * count + k, piece, a, b))
        else:
            return None
        highest = [each for each in found if not each[1] < best]
        if not highest:
            return None, arb(1).union(best)
        return highest[0] if len(highest) == 1 else None

    def _about_peak(self, piece: Piece, when: arb) -> arb | None:
        """Return when the response with its rest is highest, given when it is without."""
        if piece.rest == 0:
            return when
        reach = when.rad()
        for _ in range(HALVINGS):
            # Within a box the response falls off from its peak as bent as it is the least.
            reach = 2 * reach.max(piece.rest)
            bent = -piece.at(when.mid() + arb(0, reach), 2).upper()
            needed = (4 * piece.rest / bent).sqrt() + 2 * when.rad() if bent > 0 else reach
            if bent > 0 and needed < reach:
                return arb(when.mid(), needed.upper())
        return None

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
        """Return after which time the response stays within a band about 1; None where that is not told."""
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
        """Return the first or last time at which the most, or least, that it may be passes a level.

        None where it does not; None, and ``is_lost``, too, where that cannot be told.
        """
        pending = self.parts(until)[:: 1 if is_last else -1]
        before: bool | None = None  # whether it is above the level next to what is looked at now
        for _ in range(MOST_INTERVALS):
            spend()
            if not pending:
                return None
            piece, low, high = pending.pop()
            target = level - sign * piece.rest
            next_to = high if is_last else low
            span = piece.over(low, high) - target
            if not span.contains(0):
                # Where a piece begins, less may be left out than before.
                if before is not None and before != (span > 0):
                    return next_to
                before = bool(span > 0)
                continue
            ends = piece.at(low) - target, piece.at(high) - target
            middle = ((low + high) / 2).mid()
            slope = piece.at(middle + arb(0, (high - middle).abs_upper()), 1)
            if ends[0] * ends[1] < 0 and not slope.contains(0):
                if before is not None and before != (ends[1 if is_last else 0] > 0):
                    return next_to
                return piece.passed(target, low, high, 0)
            if not high - low > until * arb(2) ** -HALVINGS:
                break
            halves = [(piece, low, middle), (piece, middle, high)]
            pending += halves if is_last else halves[::-1]
        self.is_lost = True
        return None


def _derivative(term: ExponentialTerm) -> ExponentialTerm:
    following = (*term.coefficients[1:], acb(0))
    pairs = zip(term.coefficients, following, strict=True)
    return ExponentialTerm(term.rate, tuple(term.rate * c + d for c, d in pairs))
