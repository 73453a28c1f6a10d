"""Parameters of a machine, fitted to its records in time.

Input: records, and what a fit to their frequency responses gave. Output: the fit to their samples.

An output is the input, held or joined by lines, through the response of the machine to one sample, and an
offset, and a drift and a state to begin with where the criterion asks for them. Noise is whitened by a
regression that its residual gives.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt
from scipy.special import chdtrc

from symflex.data.fitting.least_squares import Sums, sandwich
from symflex.data.fitting.machine import Machine
from symflex.data.fitting.order import UNLIKELY
from symflex.data.fitting.parameter_fit import ParameterFit, contradicted, warnings_of
from symflex.data.fitting.parameter_residual import (
    ROUGH,
    ROUGH_STEPS,
    ParameterResidual,
    real_parts,
    refined_at,
    shown_at,
    with_base,
)
from symflex.data.fitting.parameter_starts import RANDOM_STARTS, REACH, SAME, twins_of
from symflex.data.fitting.pulse_response import PulseResponse, of_coefficients, of_function, terms_for
from symflex.data.fitting.resonances import Real, Values
from symflex.data.fitting.sampled_record import autoregression, is_held
from symflex.data.measurement import MeasuredResponse
from symflex.data.measurement.measured_response import Samples
from symflex.errors import Diagnostic, FitError

OTHER_SIGN: Final = "with the other sign the data agree far better with the specification"
NAMED_TWINS = 4
COLOURED: Final = 2  # rounds in which the noise of records is coloured anew
SIGN: Final = 0.25  # share of squares below which data of the other sign agree far better
MOST_LAGS: Final = 40  # lags of the correlation between what is left of a record and its input


@dataclass(frozen=True, eq=False)
class _Record:
    """Samples of an output of a machine, and what is assumed of them."""

    response: int  # number of the function
    samples: Samples
    is_joined: bool  # whether lines join the samples of the input; else each is held to the next
    begins: str  # a key of BEGINNINGS
    whitening: Real  # coefficients of the regression that whitens the noise
    deviation: float  # of what that leaves
    drifts: bool = True  # whether the output drifts at a constant rate

    @property
    def kept(self) -> npt.NDArray[np.bool_]:
        """Which samples count."""
        kept = np.ones(self.samples.output.size, bool)
        kept[: self.whitening.size - 1] = False
        return kept if self.samples.is_missing is None else kept & ~self.samples.is_missing

    def whitened(self, values: Real) -> Real:
        """Return what samples leave after the regression, over its deviation; shape (n, ...) to (k, ...)."""
        from scipy.signal import lfilter  # takes a second, and fits to responses need none of it

        return np.asarray(
            lfilter(self.whitening, 1.0, values, axis=0)[self.kept] / self.deviation, np.float64
        )

    def disturbance(self, pulse: PulseResponse) -> Real:
        """Return the columns of an offset, a drift over the record, and a state to begin with, if open."""
        time = np.linspace(-0.5, 0.5, self.samples.output.size)
        offset = np.column_stack((np.ones_like(time), time)[: 1 + self.drifts])
        free = pulse.free if self.begins == "free" else pulse.free[:, :0]
        scale = np.maximum(np.abs(free).max(axis=0, initial=0.0), np.finfo(float).tiny)
        return np.concatenate((offset, free / scale), axis=1)


BEGINNINGS: Final = {
    "rest": "it begins at rest, with the input at zero before",
    "level": "it begins at rest, with the input as on the first sample",
    "free": "the state that it begins with is fitted",
}


class _RecordResidual(ParameterResidual):
    """Residuals of records in time, without what an offset and a state to begin with explain."""

    def __init__(self, machine: Machine, records: Sequence[_Record]) -> None:
        super().__init__(machine)
        self.records = records
        self._finer: dict[int, int] = {}

    def pulse(self, record: _Record, theta: Real) -> PulseResponse:
        """Return the response to one sample of an input; no numbers where the function has none."""
        machine, samples = self.machine, record.samples
        function, count = machine.functions[record.response], samples.output.size
        if function.coefficients is not None:
            made = of_coefficients(
                function.coefficients, theta, samples.step_s, count, is_joined=record.is_joined
            )
        else:

            def response(finer: int) -> PulseResponse | None:
                return of_function(
                    lambda s: machine.at(record.response, -1j * s, theta),
                    samples.step_s,
                    count,
                    finer,
                    is_joined=record.is_joined,
                )

            if record.response not in self._finer:
                self._finer[record.response] = terms_for(response, count)
            made = response(self._finer[record.response])
        if made is None:
            nothing = np.full(count, np.nan)
            made = PulseResponse(nothing, np.full((count, theta.size), np.nan), np.zeros((count, 0)))
        return made

    def model(self, record: _Record, theta: Real) -> tuple[Real, Real, Real]:
        """Return output and derivatives by parameters, and the columns of disturbances; not whitened."""
        from scipy.signal import fftconvolve  # as above

        pulse, u = self.pulse(record, theta), record.samples.input
        assert u is not None  # only driven records are fitted
        driven = u - u[0] if record.begins == "level" else u
        both = np.column_stack((pulse.values, pulse.slopes))
        output = fftconvolve(driven[:, np.newaxis], both, axes=0)[: driven.size]
        return output[:, 0], output[:, 1:], record.disturbance(pulse)

    def left(self, record: _Record, theta: Real) -> tuple[Real, float]:
        """Return what the model and the best disturbances leave, not whitened, and the drift."""
        output, _, columns = self.model(record, theta)
        rest = record.samples.output - output
        solved = np.linalg.lstsq(record.whitened(columns), record.whitened(rest), rcond=None)[0]
        return np.asarray(rest - columns @ solved, np.float64), float(solved[1]) if record.drifts else 0.0

    def score(self, x: Real) -> float:
        """Return the criterion (BIC) of a point."""
        theta = self.machine.theta(x)
        terms = sum(one.disturbance(self.pulse(one, theta)).shape[1] for one in self.records)
        count = sum(int(one.kept.sum()) for one in self.records)
        return float(count * np.log(max(self.cost(x), np.finfo(float).tiny) / count) + terms * np.log(count))

    def parts(self, theta: Real, scales: Real) -> Iterator[tuple[Values, Values]]:
        """Yield residuals and derivatives of each record."""
        for record in self.records:
            output, by_parameters, columns = self.model(record, theta)
            rest = record.whitened(output - record.samples.output)
            steps = record.whitened(by_parameters * scales)
            before = record.whitened(columns)
            if all(np.isfinite(one).all() for one in (rest, steps, before)):
                basis = np.linalg.qr(before)[0]
                rest, steps = (one - basis @ (basis.T @ one) for one in (rest, steps))
            else:  # an unstable response has grown beyond all numbers
                rest, steps = np.full_like(rest, np.nan), np.zeros_like(steps)
            yield rest, steps


def fit_records(measured: Sequence[MeasuredResponse], begun: ParameterFit, hold: str) -> ParameterFit:
    """Fit the free parameters to records in time, from what their frequency responses gave."""
    machine = begun.machine
    starts = [machine.point(begun.theta), np.zeros(len(machine.names))]
    chosen: tuple[float, Real, list[_Record]] | None = None
    for is_joined in _holds(measured, hold):
        for begins in BEGINNINGS:
            records = [
                _Record(r, same, is_joined, begins, np.ones(1), float(np.std(same.output)) or 1.0)
                for r, one in enumerate(measured)
                for same in one.samples
            ]
            rest = _RecordResidual(machine, records)
            low, high = machine.limits
            points = [rest.descend(np.clip(start, low, high), ROUGH_STEPS, ROUGH) for start in starts]
            x = min(points, key=rest.cost)
            if chosen is None or rest.score(x) < chosen[0]:
                chosen = rest.score(x), x, records
    assert chosen is not None  # there are beginnings
    score, x, records = chosen
    steady = [replace(record, drifts=False) for record in records]
    other = _RecordResidual(machine, steady).descend(x, ROUGH_STEPS, ROUGH)
    if _RecordResidual(machine, steady).score(other) < score:
        x, records = other, steady
    for record in records:
        if not np.isfinite(_RecordResidual(machine, records).pulse(record, machine.theta(x)).values).all():
            name = machine.functions[record.response].name
            message = f"{name} does not fall towards high frequencies: it has no response in time"
            raise FitError(Diagnostic("SF619", message, None, "fit its frequency response: --segments 8"))
    if all(function.coefficients is not None for function in machine.functions):
        x = _best_of_random(_RecordResidual(machine, records), x, starts)
    for _ in range(COLOURED):
        rest = _RecordResidual(machine, records)
        left = [rest.left(record, machine.theta(x))[0] for record in records]
        records = [_coloured(record, values) for record, values in zip(records, left, strict=True)]
        x = _RecordResidual(machine, records).descend(x)
    return _in_time(measured, begun, records, x)


def _best_of_random(rest: _RecordResidual, x: Real, starts: Sequence[Real]) -> Real:
    """Return the best of a point and of those that random starts lead to."""
    source, found = np.random.default_rng(3), [(rest.cost(x), x)]
    for i in range(RANDOM_STARTS):
        start = starts[i % len(starts)] + source.uniform(-REACH, REACH, x.size) * (1 + i // 2)
        low, high = rest.machine.limits
        other = rest.descend(np.clip(start, low, high), ROUGH_STEPS, ROUGH)
        found.append((rest.cost(other), other))
    return min(found, key=lambda one: one[0])[1]


def _holds(measured: Sequence[MeasuredResponse], hold: str) -> tuple[bool, ...]:
    """Return whether lines may join the samples of the inputs: not where these show that they are held."""
    if hold != "auto":
        return (hold != "held",)
    inputs = [same.input for one in measured for same in one.samples if same.input is not None]
    return (False,) if all(map(is_held, inputs)) else (False, True)


def _coloured(record: _Record, left: Real) -> _Record:
    """Return a record with the noise that its residual shows."""
    if record.samples.is_missing is not None:
        return replace(record, deviation=float(np.std(left[record.kept])) or 1.0)
    whitening, variance = autoregression(left)
    return replace(record, whitening=whitening, deviation=float(np.sqrt(variance)))


def _in_time(
    measured: Sequence[MeasuredResponse], begun: ParameterFit, records: Sequence[_Record], x: Real
) -> ParameterFit:
    """Return a fit to records at its minimum, with its errors and its report."""
    machine, rank = begun.machine, begun.machine.identifiability.rank
    problem = begun.residual.problem
    points, are_exact = twins_of(problem, machine, x) if begun.are_exact_twins else ([x], True)
    x, *others = sorted(points, key=lambda point: float(np.linalg.norm(point)))
    theta = machine.theta(x)
    rest = _RecordResidual(machine, records)
    residuals, slopes = rest.residual(x), rest.slopes(x)
    stacked = np.concatenate([real_parts(one) for one in residuals[:-1]])
    sums = Sums(len(machine.names), stacked.size, float(stacked @ stacked))
    for one in slopes[:-1]:
        sums.add(np.arange(len(machine.names)), one, None, 0)
    prior = np.asarray(slopes[-1], np.float64)
    covariance, directions = sandwich(sums, [], prior.T @ prior, rank)
    scales = machine.scales(theta)
    directions[-1] *= scales
    problem = with_base(problem, machine, theta)
    shown = shown_at(problem, machine, refined_at(problem, machine, x), theta)
    words, poor, warnings = [], [], []
    for record in records:
        (left, drift), output = rest.left(record, theta), record.samples.output
        share = float(np.std(left) / np.std(output)) if np.std(output) else 0.0
        held = "joined by lines" if record.is_joined else "held between samples"
        length = record.samples.step_s * (output.size - 1)
        drifting = f"it drifts by {drift / length:.3g} per second; " if record.drifts else ""
        noise = "white noise" if record.whitening.size == 1 else f"noise of order {record.whitening.size - 1}"
        words.append(
            f"in time: {output.size} samples, {record.samples.step_s:.6g} s apart; the input is {held}; "
            f"{BEGINNINGS[record.begins]}; {drifting}residual {100 * share:.3g} % rms, {noise}"
        )
        name = measured[record.response].name
        if _follows(record, record.whitened(left), rank):
            poor.append(f"what is left of {name} follows the input: the specification lacks something")
        if (error := rest.pulse(record, theta).error) > SAME:
            warnings.append(f"the response of {name} in time is computed to {100 * error:.1g} % only")
    found = replace(
        begun,
        residual=shown,
        theta=theta,
        covariance=covariance * np.outer(scales, scales),
        directions=directions,
        freedom=stacked.size - rank,
        twins=tuple(map(machine.theta, others[:NAMED_TWINS])),
        are_exact_twins=are_exact,
        in_time=tuple(words),
    )
    poor += contradicted(found)
    if poor and _is_negated(machine, records, x):
        poor = [OTHER_SIGN, *poor]
    return replace(found, poor=tuple(poor), warnings=(*warnings, *warnings_of(found)))


def _is_negated(machine: Machine, records: Sequence[_Record], x: Real) -> bool:
    """Return whether records of the other sign leave half the residual, or less, without whitening."""
    plain = [replace(one, whitening=np.ones(1), deviation=1.0) for one in records]
    negated = [replace(one, samples=replace(one.samples, output=-one.samples.output)) for one in plain]
    rest, other = _RecordResidual(machine, plain), _RecordResidual(machine, negated)
    starts = (x, np.zeros(x.size))
    least = min(other.cost(other.descend(start, ROUGH_STEPS, ROUGH)) for start in starts)
    return least < SIGN * rest.cost(rest.descend(x, ROUGH_STEPS, ROUGH))


def _follows(record: _Record, left: Real, rank: int) -> bool:
    """Return whether what a model leaves correlates with the input (Ljung 1999, section 16.6)."""
    from scipy.signal import lfilter  # as above

    u = record.samples.input
    assert u is not None  # only driven records are fitted
    source, variance = autoregression(u - u.mean())
    driving = lfilter(source, 1.0, u - u.mean())[record.kept] / np.sqrt(variance)
    lags = min(MOST_LAGS, left.size // 8)
    size = np.std(left) * np.std(driving) * np.sqrt(left.size)
    if not size > 0:
        return False
    shares = [float(left[lag:] @ driving[: left.size - lag]) / size for lag in range(lags)]
    return float(chdtrc(max(lags - rank, 1), float(np.sum(np.square(shares))))) < UNLIKELY
