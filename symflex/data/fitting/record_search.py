"""How many poles records in time show, and where: starts, and steps that add and remove one term at a time.

A subspace method says where poles of every number may be (PO-MOESP: Verhaegen, Automatica 30, 1994). The
likeliest of its proposals is refined; then terms are added where the spectrum of what is left has peaks, and
removed, as long as the criterion falls:

    a pair of poles     costs two nonlinear and four linear parameters, and that it may lie anywhere
    a real pole         one and two
    a steady sine       one and two: hum of the mains, a motor's speed; no input drives it

In the same way it is decided whether the input is held or joined by lines, whether the record begins at rest,
whether the input is delayed and whether it acts at once. Then the noise is coloured as what is left (an
autoregression, which whitens it), and all is decided again.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np
from scipy.linalg import hankel, lstsq, qr

from symflex.budget import entered_budget, spend
from symflex.data.fitting.order import CLEAR
from symflex.data.fitting.output_error import DEPENDENT, MOST_DAMPING, OutputError, PoleSet, Solved
from symflex.data.fitting.resonances import NO_PEAK, Complex, Mask, Real
from symflex.data.fitting.sampled_record import SampledRecord, autoregression, few_levels, is_held
from symflex.data.measurement.measured_response import Samples

Records = Sequence[Sequence[Samples]]
"""The records of each output."""

MOST_ORDER, MOST_ROWS, LONGEST = 10, 40, 6000  # poles, block rows and samples of the subspace method
MOST_LINES = 3000  # of a record on which numbers of poles are compared
MOST_REFINED = 4  # proposals that are refined
MOST_BESIDE = 3  # the same where a number of modes is asked for
MOST_ADDED = 12  # terms that a search adds at most
TRIED = 2  # the likeliest of them, and the likeliest sine
ROUGH, FIRST = (12, 1e-5), (25, 1e-6)  # steps and tolerance of a comparison, and of a start
GAIN: Final = 2.0  # by how much the criterion has to fall
AT_FIRST: Final = 30.0  # the same while noise of any colour counts as white
PEAKS: Final = 8  # of what is left, at which terms are tried
REGRESSORS: Final = 20  # of the regression that shows a delay
DELAYS: Final = (0, 2, 5, 10, 18)  # samples, tried where it shows none
BROAD: Final = (0.15, NO_PEAK)  # damping ratios from which pairs of poles may stand for a delay
AROUND, MOST_DELAY = (-2.5, 0.0, 2.5), 60.0  # samples by which such a delay may be off; the longest
NARROW: Final = 0.01  # share of an input's power on half of the lines, below which it has few frequencies
LATE: Final = 5.0  # standard errors of its first coefficient that counts
FILLED, MOST_LOST = 6, 400  # rounds in which lost samples are filled; more of them stay as they are guessed
COLOURED: Final = 2  # rounds in which the noise is coloured anew
SLOW: Final = 6.0  # angle over the whole record below which a pole may lie at zero
SHARP: Final = 1e-3  # damping ratio below which a pair may be a steady sine
MAINS: Final = (50.0, 60.0)  # Hz
OFF_MAINS, MOST_HARMONICS = 1e-3, 20  # share by which their frequency may be off, harmonics that are named
FEWEST_RISES, OF_A_PERIOD = 4, 0.02  # of a square wave, and share of its frequency by which harmonics are off
NEAR_END: Final = 0.8  # share of half the sampling rate from which a mode may be an image of another
MOST_LAGS, PORTMANTEAU, FOLLOWS = (
    40,
    5.0,
    5.0,
)  # lags of correlations, and their deviations that are not chance
LEAST_EXCITED: Final = 1e-4  # share of an input's largest power from which a line counts as excited
QUIET: Final = 1e-4  # share of the output's power above a frequency from which samples are left out


@dataclass(frozen=True, eq=False)
class Tried:
    """The best poles of one number, with the sums of squares that they leave."""

    score: float
    dynamics: PoleSet
    problem: OutputError
    costs: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class _State:
    score: float
    problem: OutputError
    dynamics: PoleSet
    costs: tuple[float, ...] = ()

    @staticmethod
    def of(problem: OutputError, dynamics: PoleSet) -> _State:
        costs = tuple(one.cost for one in problem.solve(dynamics))
        return _State(problem.score(dynamics, costs), problem, dynamics, costs)

    @property
    def least(self) -> float:
        """The score, if what explains the outputs cost nothing."""
        return replace(self.problem, modes=None).score(PoleSet.nothing(), self.costs)

    def refined(self, steps: int, tolerance: float) -> _State:
        spend()
        return _State.of(self.problem, self.problem.refined(self.dynamics, steps, tolerance))


@dataclass(frozen=True)
class Settings:
    """What is known of the records, and what is asked for."""

    hold: str = "auto"  # held, joined, smooth
    criterion: str = "bic"
    modes: int | None = None
    slope: int | None = None
    is_delay_free: bool = False
    band: tuple[float, float] | None = None  # [Hz]


@dataclass(frozen=True)
class _RecordKind:
    """How records begin, and hold their input."""

    hold: str
    is_at_rest: bool = False
    is_from_zero: bool = False
    lead: int = 0  # samples of the input before the first of the output


class RecordSearch:
    """The search for the dynamics of some records; :attr:`tried` has the best of each number of poles."""

    def __init__(self, records: Records, settings: Settings) -> None:
        self.records: Records = records
        self.settings = settings
        self.tried: dict[int, Tried] = {}
        first = records[0][0]
        missing = [one.is_missing for same in records for one in same if one.is_missing is not None]
        self.lost = bool(missing) and max(int(one.sum()) for one in missing) <= MOST_LOST
        self.is_driven = first.input is not None
        self.integrators = max(-(settings.slope or 0), 0)
        self.holds = [settings.hold]
        if settings.hold == "auto":
            held = not self.is_driven or all(
                is_held(one.input) for same in records for one in same if one.input is not None
            )
            self.holds = ["held"] if held else ["held", "joined", "smooth"]
        acts = _delay(first) if self.is_driven else 0
        self.delays = {0, *(DELAYS if acts is None else (acts,))} if self.is_driven else {0}

    def found(self) -> tuple[OutputError, PoleSet]:
        """Return the records with their noise, and the dynamics that describe them best."""
        state = self._filled(self._started())
        for rebuilt in list(self._with_hold(state)):
            other = self._filled(rebuilt.refined(*FIRST))
            state = other if other.score < state.score else state
        state = self._varied(self._climbed(state, AT_FIRST))
        for _ in range(COLOURED):
            state = self._refilled(state)
            problem = self._coloured(state)
            state = self._climbed(_State.of(problem, state.dynamics).refined(*FIRST))
            state = self._varied(state)
        state = self._refilled(self._with_evidence(state))
        full = self._whole(state)
        dynamics = full.refined(state.dynamics)
        full = self._freed(full.with_noise(dynamics), dynamics)
        return full, full.refined(dynamics)

    def _with_evidence(self, state: _State) -> _State:
        """Return the fewest poles that were tried against which there is no strong evidence."""
        for order in sorted(self.tried):
            one = self.tried[order]
            if order < state.dynamics.order and one.score < state.score + CLEAR:
                return _State.of(one.problem, one.dynamics).refined(*FIRST)
        return state

    def _freed(self, problem: OutputError, dynamics: PoleSet) -> OutputError:
        return problem.with_lost_inputs(dynamics) if self.lost else problem

    def _filled(self, state: _State) -> _State:
        """Return the state with lost samples filled until that changes nothing."""
        for _ in range(FILLED if self.lost else 0):
            again = self._refilled(state)
            if again.score > state.score - GAIN:
                break
            state = again
        return state

    def _refilled(self, state: _State) -> _State:
        """Return the state with input and output as a model has them where samples were lost."""
        if not self.lost:
            return state
        whole = self._freed(self._whole(state), state.dynamics)
        errors = whole.lost_inputs(state.dynamics)
        records = []
        for same, guesses, made in zip(self.records, errors, whole.outputs, strict=True):
            filled = []
            for one, guess, record in zip(same, guesses, made, strict=True):
                if one.is_missing is None or one.input is None or not guess.size:
                    filled.append(one)
                    continue
                u, y = one.input.copy(), one.output.copy()
                u[np.flatnonzero(one.is_missing)[-guess.size :]] += guess
                y[-record.size :] = record.output
                filled.append(replace(one, input=u, output=y))
            records.append(tuple(filled))
        self.records = records
        return self._rebuilt(state, _kind(state.problem)).refined(*FIRST)

    def best(self) -> tuple[OutputError, PoleSet]:
        """Return the best so far, when time is over."""
        problem = self.problem(_RecordKind(self.holds[-1]))
        dynamics = (
            min(self.tried.values(), key=lambda one: one.score).dynamics if self.tried else PoleSet.nothing()
        )
        return problem.with_noise(dynamics), dynamics

    def problem(self, kind: _RecordKind) -> OutputError:
        """Return the problem of all lines, each output with the noise of its deviation."""
        outputs = []
        for same in self.records:
            made = []
            for one in same:
                record = SampledRecord.of(
                    one,
                    is_joined=kind.hold == "joined",
                    is_at_rest=kind.is_at_rest,
                    is_from_zero=kind.is_from_zero,
                    lead=kind.lead,
                    is_smooth=kind.hold == "smooth",
                )
                if self.settings.band is not None:
                    hertz = record.omega / (2 * np.pi)
                    record = record.at((hertz >= self.settings.band[0]) & (hertz <= self.settings.band[1]))
                made.append(
                    replace(record, noise=np.full(record.omega.size, max(np.std(one.output), 1e-300)))
                )
            outputs.append(tuple(made))
        return OutputError(tuple(outputs), self.settings.criterion, self.settings.modes)

    def with_noise_of(self, problem: OutputError) -> OutputError:
        """Return the problem of all lines, with the noise and the hold of another, from any state."""
        return _noisy_as(self.problem(replace(_kind(problem), is_at_rest=False, is_from_zero=False)), problem)

    def _started(self) -> _State:
        """Return the best of what the subspace method proposes."""
        states = []
        for delay in sorted(self.delays):
            base = replace(PoleSet.nothing(), has_drift=True, integrators=self.integrators)
            lead = delay + 2 if delay else 0
            problem = _thinned(self.problem(_RecordKind(self.holds[0], lead=lead)))
            if delay:
                base = replace(base, delay_s=delay * problem.step_s, is_delay_free=True)
            states.append(_State.of(problem, base))
            states += [_State.of(problem, base.with_terms(one)) for one in _subspace(self.records[0], delay)]
        best = sorted(states, key=lambda one: one.score)[:MOST_REFINED]
        more = [
            other for one in best for change in (self._with_rest, self._with_hold) for other in change(one)
        ]
        best = sorted([*best, *more], key=lambda one: one.score)[:MOST_REFINED]
        return min((one.refined(*FIRST) for one in best), key=lambda one: one.score)

    def _note(self, state: _State) -> None:
        order = state.dynamics.order
        if order not in self.tried or state.score < self.tried[order].score:
            self.tried[order] = Tried(state.score, state.dynamics, state.problem, state.costs)

    def _climbed(self, state: _State, gain: float = CLEAR) -> _State:
        """Return the state with terms added, and removed, as long as the criterion falls."""
        self.tried = {}
        self._note(state)
        most = MOST_ADDED if self.settings.modes is None else MOST_BESIDE
        for step in range(most):
            entered_budget().progress.report(step / most, f"{state.dynamics.order} poles")
            best = state
            for more in self._proposed(state):
                grown = _State(0.0, state.problem, state.dynamics.with_terms(more)).refined(*ROUGH)
                self._note(grown)
                best = grown if grown.score < min(best.score, state.score - gain) else best
            if best is state:
                break
            state = self._refilled(best)
        state = state.refined(*FIRST)
        self._note(state)
        return self._shrunk(state)

    def _shrunk(self, state: _State) -> _State:
        """Return the state with terms removed, as long as the criterion falls."""
        while True:
            fewer = [one.refined(*ROUGH) for one in _reduced(state)]
            for one in fewer:
                self._note(one)
            best = min(fewer, key=lambda one: one.score, default=state)
            if best.score >= state.score:
                return state
            state = best

    def _proposed(self, state: _State) -> list[PoleSet]:
        """Return the likeliest terms to add: at peaks of what is left, beside poles, and broad ones."""
        problem, dynamics = state.problem, state.dynamics
        solved = problem.solve(dynamics)
        nothing = PoleSet.nothing()

        def pair(omega: float, zeta: float) -> PoleSet:
            return replace(nothing, omega=np.array([omega]), zeta=np.array([zeta]))

        terms: list[PoleSet] = []
        for records, one in zip(problem.outputs, solved, strict=True):
            for record, error in zip(records, one.errors, strict=True):
                noise = 1.0 if record.noise is None else record.noise
                peaks = _peaks(np.abs(error / noise))[:PEAKS]
                terms += [pair(record.omega[k], z) for k in peaks for z in (0.002, 0.02, 0.1)]
                terms += [replace(nothing, lines=record.omega[[k]]) for k in peaks[:4]]
        low, high = 2 * np.pi / problem.length_s, np.pi / problem.step_s
        terms += [pair(w, 0.4) for w in np.geomspace(1.3 * low, 0.9 * high, 6)]
        terms += [replace(nothing, real=np.array([w])) for w in np.geomspace(0.3 * low, 0.3 * high, 5)]
        for w, z in zip(dynamics.omega, dynamics.zeta, strict=True):
            width = max(z, low / w)
            terms += [
                pair(w * (1 + k * width), z) for k in (-3, -1.5, 1.5, 3) if 0 < w * (1 + k * width) < high
            ]
        scores = np.array([problem.score_with(dynamics, one, solved) for one in terms])
        order = np.argsort(scores)
        likely = [terms[i] for i in order[:TRIED]]
        return likely + [terms[i] for i in order if terms[i].lines.size][:1]

    def _varied(self, state: _State) -> _State:
        """Return the state with another hold, rest, delay or feedthrough, where the criterion asks for it."""
        for change in (
            self._with_rest,
            self._with_hold,
            self._with_delay,
            self._with_direct,
            self._with_zeros,
        ):
            for changed in change(state):
                other = changed.refined(*ROUGH)
                # Poles may make up for a wrong one, and fewer of them never leave less of the output.
                if change in (self._with_hold, self._with_delay) and other.least < state.score:
                    other = self._shrunk(other)
                if other.score < state.score - GAIN:
                    state = other
        return state

    def _rebuilt(self, state: _State, kind: _RecordKind) -> _State:
        """Return the state with records that begin, or hold their input, in another way."""
        if kind.hold == "smooth":  # it never begins at rest
            kind = replace(kind, is_at_rest=False)
        if kind.hold != "held":
            kind = replace(kind, is_from_zero=False)
        problem = _thinned(_noisy_as(self.problem(kind), state.problem))
        if any(one.measured is not None for same in problem.outputs for one in same):
            problem = self._freed(problem.filled(state.dynamics), state.dynamics)
        return _State.of(problem, state.dynamics)

    def _with_rest(self, state: _State) -> Iterator[_State]:
        kind = _kind(state.problem)
        if not self.is_driven or kind.hold == "smooth":
            return
        begins_at_once = any(one.input is not None and one.input[0] for same in self.records for one in same)
        now = kind.is_at_rest, kind.is_from_zero
        for is_at_rest, is_from_zero in ((False, False), (True, False), (True, True)):
            is_other = (is_at_rest, is_from_zero) != now
            if is_other and (not is_from_zero or (kind.hold == "held" and begins_at_once)):
                yield self._rebuilt(state, replace(kind, is_at_rest=is_at_rest, is_from_zero=is_from_zero))

    def _with_hold(self, state: _State) -> Iterator[_State]:
        kind = _kind(state.problem)
        for hold in self.holds:
            if hold != kind.hold:
                yield self._rebuilt(state, replace(kind, hold=hold))

    def _with_delay(self, state: _State) -> Iterator[_State]:
        if not self.is_driven:
            return
        dynamics, kind, step = state.dynamics, _kind(state.problem), state.problem.step_s
        moved: list[PoleSet] = []
        if not dynamics.is_delay_free:
            delays = sorted({0.3, 1.0, *(float(one) for one in self.delays if one)})
            moved = [replace(dynamics, delay_s=delay * step, is_delay_free=True) for delay in delays]
        elif not self.settings.is_delay_free:
            plain = replace(dynamics, delay_s=0.0, is_delay_free=False)
            yield replace(self._rebuilt(state, replace(kind, lead=0)), dynamics=plain)
        for several in (moved, list(_as_delays(dynamics, step))):
            late = []
            for one in several:
                rebuilt = self._rebuilt(state, replace(kind, lead=int(one.delay_s / step) + 2))
                late.append(_State.of(rebuilt.problem, one))
            likely = sorted(late, key=lambda one: one.score)[:TRIED]
            yield from likely
            for late_one in likely if several is not moved else ():
                yield from self._with_hold(late_one)  # half a sample later, it is joined

    def _with_direct(self, state: _State) -> Iterator[_State]:
        if self.is_driven:
            other = replace(state.dynamics, has_direct=not state.dynamics.has_direct)
            yield replace(state, dynamics=other)
        yield replace(state, dynamics=replace(state.dynamics, has_drift=not state.dynamics.has_drift))

    def _with_zeros(self, state: _State) -> Iterator[_State]:
        """Yield the state with slow poles at zero, as those of what moves freely."""
        if not self.is_driven or self.settings.slope is not None:
            return
        dynamics, slow = state.dynamics, SLOW / state.problem.length_s
        is_slow = dynamics.real < slow
        if is_slow.any() and dynamics.integrators < 2:  # noqa: PLR2004 (what moves freely has two)
            slowest = int(np.argmin(dynamics.real))
            fewer = replace(
                dynamics, real=np.delete(dynamics.real, slowest), integrators=dynamics.integrators + 1
            )
            yield replace(state, dynamics=fewer)
        is_slow = dynamics.omega < slow
        if is_slow.any() and not dynamics.integrators:
            slowest = int(np.argmin(dynamics.omega))
            yield replace(state, dynamics=replace(_without_pair(dynamics, slowest), integrators=2))

    def _whole(self, state: _State) -> OutputError:
        """Return the problem of all lines that a state belongs to."""
        whole = self.problem(_kind(state.problem))
        return _noisy_as(whole, state.problem).filled(state.dynamics)

    def _coloured(self, state: _State) -> OutputError:
        """Return the thinned problem with the noise that all lines show."""
        return self._freed(_thinned(self._whole(state).with_noise(state.dynamics)), state.dynamics)


def _kind(problem: OutputError) -> _RecordKind:
    one = problem.outputs[0][0]
    return _RecordKind(hold_of(one), one.is_at_rest, one.is_from_zero, one.lead)


def hold_of(record: SampledRecord) -> str:
    """Return what an input does between samples."""
    return "smooth" if record.is_smooth else "joined" if record.is_joined else "held"


def _noisy_as(problem: OutputError, other: OutputError) -> OutputError:
    """Return a problem whose noise is that of another."""
    outputs = []
    for records, others in zip(problem.outputs, other.outputs, strict=True):
        pairs = zip(records, others, strict=True)
        outputs.append(
            tuple(
                r if o.noise is None else replace(r, noise=np.interp(r.omega, o.omega, o.noise))
                for r, o in pairs
            )
        )
    return replace(problem, outputs=tuple(outputs))


def _thinned(problem: OutputError) -> OutputError:
    """Return a problem with at most so many lines of each record, densely where its output is large."""
    return replace(
        problem, outputs=tuple(tuple(one.at(_telling(one)) for one in same) for same in problem.outputs)
    )


def _telling(record: SampledRecord) -> Mask:
    kept = np.ones(record.omega.size, bool)
    if kept.size <= MOST_LINES:
        return kept
    width = max(kept.size // MOST_LINES, 9) | 1
    power = np.convolve(np.abs(record.output_lines) ** 2, np.ones(width) / width, "same")
    density = np.sqrt(power / np.max(power)) + 0.1 * np.mean(np.sqrt(power / np.max(power)))
    total = np.cumsum(density) / np.sum(density)
    chosen = np.searchsorted(total, (np.arange(MOST_LINES) + 0.5) / MOST_LINES)
    kept[:] = False
    kept[np.minimum(chosen, kept.size - 1)] = True
    return kept


def _without_pair(dynamics: PoleSet, i: int) -> PoleSet:
    return replace(dynamics, omega=np.delete(dynamics.omega, i), zeta=np.delete(dynamics.zeta, i))


def _as_delays(dynamics: PoleSet, step_s: float) -> Iterator[PoleSet]:
    """Yield dynamics with a delay in place of broad poles, which may be those of a Pade approximant of one.

    A pair whose zeros mirror it delays what is slow by ``4 zeta/omega``, and a real pole by ``2/omega``.
    """
    for least in BROAD:
        is_broad = dynamics.zeta > least
        if not (is_broad.any() or dynamics.real.size):
            continue
        longer = float(np.sum(4 * dynamics.zeta[is_broad] / dynamics.omega[is_broad]))
        longer += float(np.sum(2 / dynamics.real))
        kept = replace(
            dynamics, omega=dynamics.omega[~is_broad], zeta=dynamics.zeta[~is_broad], real=np.zeros(0)
        )
        for off in AROUND:
            delay = dynamics.delay_s + longer + off * step_s
            if 0 < delay < MOST_DELAY * step_s:
                yield replace(kept, delay_s=delay, is_delay_free=True)


def _reduced(state: _State) -> Iterator[_State]:
    """Yield states with a term less, or with a simpler one in its place."""
    dynamics = state.dynamics
    for i, (w, z) in enumerate(zip(dynamics.omega, dynamics.zeta, strict=True)):
        fewer = _without_pair(dynamics, i)
        yield replace(state, dynamics=fewer)
        if z < SHARP:
            yield replace(state, dynamics=replace(fewer, lines=np.append(fewer.lines, w)))
        if z > NO_PEAK:
            yield replace(state, dynamics=replace(fewer, real=np.append(fewer.real, w)))
            apart = w * (z + np.array([-1.0, 1.0]) * np.sqrt(max(z * z - 1, 0.01)))
            yield replace(
                state, dynamics=replace(fewer, real=np.append(fewer.real, np.maximum(apart, 0.05 * w)))
            )
    for i in range(dynamics.real.size):
        yield replace(state, dynamics=replace(dynamics, real=np.delete(dynamics.real, i)))
    # Nothing else makes up for a sine: the likeliest to go is known before anything moves.
    fewer_lines = [replace(dynamics, lines=np.delete(dynamics.lines, i)) for i in range(dynamics.lines.size)]
    without = [_State.of(state.problem, one) for one in fewer_lines]
    yield from sorted(without, key=lambda one: one.score)[:1]
    if dynamics.real.size > 1:
        order = np.argsort(dynamics.real)
        for a, b in pairwise(order):
            left = replace(dynamics, real=np.delete(dynamics.real, [a, b]))
            middle, mean = np.sqrt(dynamics.real[a] * dynamics.real[b]), dynamics.real[[a, b]].mean()
            zeta = min(mean / middle, MOST_DAMPING - 0.01)
            yield replace(
                state,
                dynamics=replace(left, omega=np.append(left.omega, middle), zeta=np.append(left.zeta, zeta)),
            )


def _peaks(size: Real) -> list[int]:
    """Return the lines at which a spectrum has peaks, the largest first."""
    smooth = np.convolve(size, [0.25, 0.5, 0.25], "same")
    inner = np.flatnonzero((smooth[1:-1] >= smooth[:-2]) & (smooth[1:-1] >= smooth[2:])) + 1
    return [int(k) for k in inner[np.argsort(-smooth[inner])]]


def _detrended(values: Real) -> Real:
    time = np.linspace(-1, 1, values.size)
    return np.asarray(values - np.mean(values) - time * (time @ values) / (time @ time), np.float64)


def _delay(samples: Samples) -> int | None:
    """Return the samples after which an input acts, by a regression of the output on both (ARX)."""
    # None where it does not tell, as where the input has few frequencies.
    assert samples.input is not None
    power = np.sort(np.abs(np.fft.rfft(samples.input[:LONGEST])[1:]) ** 2)
    if power[: power.size // 2].sum() < NARROW * power.sum():
        return None
    y, u = _detrended(samples.output)[:LONGEST], samples.input[:LONGEST]
    n = min(REGRESSORS, y.size // 6)
    columns = [np.append(np.zeros(k), y[: y.size - k]) for k in range(1, n + 1)]
    columns += [np.append(np.zeros(k), u[: u.size - k]) for k in range(n + 1)]
    matrix = np.column_stack((*columns, np.ones(y.size)))[n:]
    scale = np.linalg.norm(matrix, axis=0) + 1e-300
    values, vectors = np.linalg.eigh((matrix / scale).T @ (matrix / scale))
    if values[0] < DEPENDENT * values[-1]:
        return None
    inverse = (vectors / values) @ vectors.T
    coefficients = inverse @ ((matrix / scale).T @ y[n:])
    residual = y[n:] - (matrix / scale) @ coefficients
    errors = np.sqrt(np.diag(inverse) * (residual @ residual) / max(residual.size - coefficients.size, 1))
    acts = np.abs(coefficients / errors)[n : 2 * n + 1] > LATE
    return max(int(np.argmax(acts)) - 1, 0) if acts.any() else None


def _subspace(records: Sequence[Samples] | tuple[Samples, ...], delay: int) -> Iterator[PoleSet]:
    """Yield poles of every number up to a most, of the first record of an output."""
    one = records[0]
    y, u, step = _detrended(one.output), one.input, one.step_s
    if u is not None:
        u = np.append(np.full(delay, u[0]), u[: u.size - delay]) - np.mean(u)
    if y.size > LONGEST:
        y, u, step = _slower(y, u, step)
    rows = int(min(MOST_ROWS, max(6, y.size // 8)))
    future, past = _block(y, rows)
    if u is None:
        spans = np.linalg.svd(qr(np.vstack((past, future)).T, mode="r")[0][: 2 * rows].T[rows:, :rows])[0]
    else:
        u_future, u_past = _block(u, rows)
        triangle = qr(np.vstack((u_future, u_past, past, future)).T, mode="r")[0][: 4 * rows].T
        spans = np.linalg.svd(triangle[3 * rows :, rows : 3 * rows])[0]
    for order in range(1, min(MOST_ORDER + 1, rows - 1)):
        z = np.linalg.eigvals(lstsq(spans[:-1, :order], spans[1:, :order])[0]).astype(complex)
        yield _of_poles(np.log(z[z.imag >= 0]) / step, step, y.size * step)


def _block(values: Real, rows: int) -> tuple[Real, Real]:
    """Return the matrices of future and past samples."""
    both = hankel(values[: 2 * rows], values[2 * rows - 1 :])
    return both[rows:], both[:rows]


def _of_poles(poles: Complex, step: float, length: float) -> PoleSet:
    is_pair = (poles.imag > 1e-3 * np.abs(poles)) & (poles.imag < 0.98 * np.pi / step)
    pairs, real = poles[is_pair], poles[poles.imag <= 1e-3 * np.abs(poles)].real
    size = np.abs(pairs)
    return replace(
        PoleSet.nothing(),
        omega=size,
        zeta=np.clip(-pairs.real / size, 1e-4, 0.95),
        real=np.maximum(np.abs(real), 0.1 / length),
    )


def _slower(y: Real, u: Real | None, step: float) -> tuple[Real, Real | None, float]:
    """Return a long record at a lower rate, of frequencies at which the output is, or its first part."""
    spectrum = np.fft.rfft(y)
    power = np.cumsum(np.abs(spectrum) ** 2)
    above = int(np.argmax(power > (1 - QUIET) * power[-1]))
    size = 2 * max(min(2 * above, spectrum.size - 1), LONGEST // 4)
    share = size / y.size
    if share < 1:
        step /= share
        u = None if u is None else np.fft.irfft(np.fft.rfft(u)[: size // 2 + 1], size) * share
        y = np.fft.irfft(spectrum[: size // 2 + 1], size) * share
    return y[:LONGEST], None if u is None else u[:LONGEST], step


@dataclass(frozen=True, eq=False)
class Sine:
    """A steady sine that disturbs an output."""

    frequency_hz: float
    error_hz: float
    amplitudes: tuple[float, ...]  # of each output
    name: str  # the mains, or one of its harmonics or of a square wave's, or empty


@dataclass(frozen=True, eq=False)
class RecordTerms:
    """What a fit in time finds besides poles and zeros; a value for each output."""

    hold: str
    is_at_rest: bool
    is_driven: bool
    samples: tuple[int, ...]
    step_s: float
    offsets: tuple[float | None, ...]  # of the output, at the middle of the record
    drifts: tuple[float, ...] | None  # per second
    sines: tuple[Sine, ...]
    is_coloured: tuple[bool, ...]  # whether what disturbs an output is not white
    residual: tuple[float, ...]  # root mean square
    residual_share: tuple[float, ...]  # over that of the output
    warnings: tuple[str, ...]
    poor: tuple[str, ...]


def described(
    problem: OutputError,
    dynamics: PoleSet,
    solved: Sequence[Solved],
    errors: Real,
    samples: Sequence[Samples],
) -> RecordTerms:
    """Return what a fit in time found besides poles and zeros, and how far it may be trusted."""
    # The errors are those of the parameters of a search.
    first = [records[0] for records in problem.outputs]
    one = first[0]
    offsets, drifts, amplitudes, residuals, shares, is_coloured = [], [], [], [], [], []
    for r, (record, fit, raw) in enumerate(zip(first, solved, samples, strict=True)):
        rest = record.samples(fit.errors[0])
        residuals.append(float(np.std(rest)))
        shares.append(residuals[-1] / max(float(np.std(raw.output)), 1e-300))
        is_coloured.append(record.noise is not None and bool(np.ptp(record.noise) > 0))
        own = fit.coefficients[-(2 * dynamics.lines.size) :] if dynamics.lines.size else np.zeros(0)
        turns = 1 - np.exp(1j * dynamics.lines * record.size * record.step_s)
        with np.errstate(all="ignore"):
            amplitudes.append(2 * np.abs(own.reshape(-1, 2) @ [1, 1j] / turns))
        offsets.append(problem.offset(dynamics, r, fit, 0.0 if raw.input is None else float(raw.input[0])))
        if dynamics.has_drift and not (dynamics.integrators and not record.is_at_rest):
            drifts.append(float(-fit.coefficients[-1 - own.size] / (record.size * record.step_s)))
    at = 2 * dynamics.omega.size + dynamics.real.size
    sines = []
    for k, w in enumerate(dynamics.lines):
        hertz = float(w / (2 * np.pi))
        error = float(errors[at + k] / (2 * np.pi * problem.length_s))
        heights = tuple(float(each[k]) for each in amplitudes)
        of_input = _of_square_wave(hertz, samples[0])
        sines.append(Sine(hertz, error, heights, of_input or _mains(hertz, error, problem.length_s)))
    sines.sort(key=lambda each: each.frequency_hz)
    warnings, poor = _doubts(problem, dynamics, solved)
    if samples[0].input is not None and (levels := few_levels(samples[0].input)[0]):
        said = f"the input has {levels} levels only: what its rounding adds to the output counts as noise"
        warnings.append(said)
    return RecordTerms(
        hold_of(one), one.is_at_rest, one.input is not None, tuple(r.size for r in first), one.step_s,
        tuple(offsets), tuple(drifts) or None,
        tuple(sines), tuple(is_coloured), tuple(residuals), tuple(shares), tuple(warnings), tuple(poor),
    )  # fmt: skip


def _of_square_wave(hertz: float, samples: Samples) -> str:
    """Return which harmonic of an input of two levels a sine is, if it is one: no linear machine adds it."""
    u = samples.input
    if u is None or np.unique(u).size != 2:  # noqa: PLR2004
        return ""
    rises = np.flatnonzero(np.diff(u) > 0)
    if rises.size < FEWEST_RISES or np.ptp(np.diff(rises)) > 2:  # noqa: PLR2004 (one sample on either side)
        return ""
    rate = (rises.size - 1) / ((rises[-1] - rises[0]) * samples.step_s)
    harmonic = round(hertz / rate)
    is_one = harmonic and abs(hertz / rate - harmonic) < OF_A_PERIOD
    return f"harmonic {harmonic} of the input's {rate:.4g} Hz, of what is not linear" if is_one else ""


def _mains(hertz: float, error: float, length_s: float) -> str:
    """Return which harmonic of the mains a sine is, if it is one."""
    for mains in MAINS:
        harmonic = round(hertz / mains)
        near = max(3 * error, 0.1 / length_s, OFF_MAINS * hertz)
        if 1 <= harmonic <= MOST_HARMONICS and abs(hertz - harmonic * mains) <= near:
            return f"mains of {mains:g} Hz" + (f", harmonic {harmonic}" if harmonic > 1 else "")
    return ""


def _doubts(problem: OutputError, dynamics: PoleSet, solved: Sequence[Solved]) -> tuple[list[str], list[str]]:
    """Return what to be careful about, and why the fit is poor."""
    warnings, poor = [], []
    nyquist = np.pi / problem.step_s
    for w, z in zip(dynamics.omega, dynamics.zeta, strict=True):
        if w > NEAR_END * nyquist and z < NO_PEAK:
            hertz, other = w / (2 * np.pi), (2 * nyquist - w) / (2 * np.pi)
            end = f"half the sampling rate, {nyquist / (2 * np.pi):.4g} Hz"
            said = f"near {end}: it may be the image of one at {other:.4g} Hz"
            if w > nyquist:
                said = f"above {end}: the record shows only its effect"
            warnings.append(f"the pole pair at {hertz:.4g} Hz is {said}")
    for records, one in zip(problem.outputs, solved, strict=True):
        for record, errors in zip(records, one.errors, strict=True):
            if record.lines is not None or record.noise is None:
                continue
            white = record.samples(errors / record.noise)
            lags = min(MOST_LAGS, white.size // 4)
            power = np.fft.irfft(np.abs(np.fft.rfft(white, 2 * white.size)) ** 2)[: lags + 1]
            total = white.size * float(np.sum((power[1:] / power[0]) ** 2))
            if total > lags + PORTMANTEAU * np.sqrt(2 * lags):
                poor.append("what is left of the output is not white: the model lacks something")
            elif record.input is not None and (lag := _feedback(record, white)):
                warnings.append(
                    f"the input follows the disturbance after {lag} samples: the record is of a closed loop, "
                    "and the fit is right as far as its model of the disturbance is"
                )
    u = problem.outputs[0][0]
    if u.input is not None and dynamics.order:
        power = np.abs(u.input_lines(0)) ** 2
        excited = int(np.sum(power > LEAST_EXCITED * power.max()))
        parameters = 2 * dynamics.order + dynamics.has_direct
        if 2 * excited < parameters and u.is_at_rest:
            poor.append(f"the input has {excited} frequencies, and the fit {parameters} parameters")
    return warnings, list(dict.fromkeys(poor))


def _feedback(record: SampledRecord, white: Real) -> int:
    """Return after how many samples the input follows what disturbs the output; 0 if it does not."""
    u = record.samples(record.input_lines(0))
    coefficients, _ = autoregression(u)
    u = np.convolve(u, coefficients)[: u.size]
    n = u.size
    cross = np.fft.irfft(np.conj(np.fft.rfft(white, 2 * n)) * np.fft.rfft(u, 2 * n))[1 : MOST_LAGS + 1]
    share = np.abs(cross) / max(np.sqrt(float(white @ white) * float(u @ u)), 1e-300)
    top = int(np.argmax(share))
    return top + 1 if share[top] > FOLLOWS / np.sqrt(n) else 0
