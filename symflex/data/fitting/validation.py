"""Whether the second half of records in time is as a fit to their first half predicts it.

The order, the poles and the residues are those of the first half, found as if there were no other. The second
half gives its input, the state that it begins with, an offset and amplitudes of sines; nothing else of it is
fitted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from symflex.data.fitting.output_error import left_by_prediction
from symflex.data.fitting.record_search import Records, RecordSearch, Settings
from symflex.data.fitting.resonances import NO_PEAK, Mask, Real
from symflex.data.fitting.sampled_record import SampledRecord
from symflex.data.measurement.measured_response import Samples
from symflex.errors import refused

FEWEST: Final = 32  # samples of a half
FILLINGS: Final = 3  # rounds in which a prediction takes the place of samples that were lost
CHANGED: Final = 1.5  # error over what the first half leaves from which something has changed
LITTLE: Final = 2.0  # the output's deviation over the error up to which its half shows little


@dataclass(frozen=True, eq=False)
class Validation:
    """The second halves of records over their prediction: a value, or an array, for each output."""

    modes: int  # resonances of the fit to the first half
    # times_s, measured and predicted are those of the first record of each output.
    times_s: tuple[Real, ...]
    measured: tuple[Real, ...]
    predicted: tuple[Real, ...]
    error: tuple[float, ...]  # root mean square, over all records
    share: tuple[float, ...]  # over the deviation of the output
    noise: tuple[float, ...]  # root mean square of what the fit leaves of the first half

    @property
    def warnings(self) -> tuple[str, ...]:
        """What to be careful about."""
        said = []
        if any(one > CHANGED * left for one, left in zip(self.error, self.noise, strict=True)):
            how = "the model lacks something, or the machine has changed"
            said.append(f"the second half is not as the first one predicts it: {how}")
        if any(LITTLE * one > 1 for one in self.share):
            said.append("the second half shows little but noise: it validates little")
        return tuple(said)


def validated(records: Records, settings: Settings) -> Validation:
    """Fit first halves of records, and predict the second ones from their input; SF902 if there is no fit."""
    if min(one.output.size for same in records for one in same) < 2 * FEWEST:
        raise refused(f"--validate needs records of {2 * FEWEST} samples or more")
    search = RecordSearch([[_half(one, 0) for one in same] for same in records], settings)
    problem, dynamics = search.found()
    if not dynamics.order:
        raise refused("the first half of the record shows no pole, so that it predicts nothing")
    lead = problem.outputs[0][0].lead
    ahead = RecordSearch([[_half(one, 1, lead) for one in same] for same in records], settings)
    times: list[Real] = []
    measured, made, errors, shares, noise = [], [], [], [], []
    halves = zip(ahead.with_noise_of(problem).outputs, problem.outputs, problem.solve(dynamics), strict=True)
    for second, first, fit in halves:
        rests = []
        for record in second:
            rest = left_by_prediction(record, dynamics, fit.coefficients)
            for _ in range(FILLINGS if record.measured is not None else 0):
                filled = record.filled(rest)
                rest = left_by_prediction(filled, dynamics, fit.coefficients)
            rests.append(record.samples(rest))
        one = second[0]
        start = records[0][0].output.size // 2
        times.append(np.asarray(one.step_s * (start + np.arange(one.size)), np.float64))
        measured.append(one.output)
        made.append(one.output - rests[0])
        errors.append(_size([r[_kept(record)] for r, record in zip(rests, second, strict=True)]))
        shares.append(errors[-1] / max(_size([r.output - np.mean(r.output) for r in second]), 1e-300))
        noise.append(_size([r.samples(e) for r, e in zip(first, fit.errors, strict=True)]))
    modes = int(np.sum(dynamics.zeta < NO_PEAK))
    return Validation(
        modes, tuple(times), tuple(measured), tuple(made), tuple(errors), tuple(shares), tuple(noise)
    )


def _half(one: Samples, which: int, lead: int = 0) -> Samples:
    """Return the first or the second half; the second one with so many samples more, from before it."""
    middle = one.output.size // 2
    part = slice(middle - lead, None) if which else slice(None, middle)
    u = None if one.input is None else one.input[part]
    lost = None if one.is_missing is None else one.is_missing[part]
    return replace(one, output=one.output[part], input=u, is_missing=lost)


def _kept(record: SampledRecord) -> slice | Mask:
    return slice(None) if record.measured is None else record.measured


def _size(values: Sequence[Real]) -> float:
    return float(np.sqrt(np.mean(np.concatenate(values) ** 2)))
