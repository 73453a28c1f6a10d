"""Measured responses of a model: made of it, or fitted on top of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from symflex.analysis.response import evaluate, respond
from symflex.data.fitting import Base, ResonanceFit, fit_resonances
from symflex.data.measurement import MeasuredResponse, MeasurementPlan, synthesise
from symflex.errors import refused
from symflex.model import Model, load_with
from symflex.model.loss_factors import check_causal
from symflex.model.spec import read
from symflex.options import FitOptions, MeasureOptions
from symflex.roots import Band
from symflex.roots.locate import locate
from symflex.transfer import BoundTransferFunction
from symflex.transfer.of_model import derive_bound, pick_pairs


def fit(measured: Sequence[MeasuredResponse], given: FitOptions) -> ResonanceFit:
    """Fit resonances to measured responses, which share their poles; see :func:`.fitting.fit_resonances`.

    Raises
    ------
    UsageError
        SF902 for a name the base does not have, or more or fewer of them than responses; without a base, for
        a name that no response has.
    """
    if given.base is None:
        names = [response.name for response in measured]
        for tf in given.tfs:
            if names.count(tf) != 1:
                message = f"no response, or more than one, is called '{tf[:64]}'"
                raise refused(message, f"responses: {', '.join(names)}")
        measured = [response for response in measured if not given.tfs or response.name in given.tfs]
        return fit_resonances(measured, None, given)
    return fit_resonances(measured, _bases(len(measured), given.base, given), replace(given, slope=None))


def _bases(count: int, path: str | Path, given: FitOptions) -> list[Base]:
    """Return what the resonances of each response are multiplied by."""
    model = load_with(read(Path(path)), {}, allow_outside=given.allow_outside)
    taken, folders = tuple(p.name for p in model.parameters), (Path(path).parent, *given.allow_outside)
    pairs = pick_pairs(model, given.tfs)[: None if given.tfs else 1]
    if len(pairs) == 1:
        pairs = pairs * count
    if len(pairs) != count:
        message = f"{count} responses and {len(pairs)} transfer functions of the base"
        raise refused(message, "name one with --tf for each response")
    bounds = dict(zip(pairs, derive_bound(model, pairs), strict=True))

    def base_of(bound: BoundTransferFunction) -> Base:
        def function(omega: npt.NDArray[Any]) -> npt.NDArray[np.complex128]:
            return evaluate(bound, omega) if omega.dtype.kind == "c" else respond(bound, omega).values

        return Base(function, bound.name, str(path), bound.source.unit, taken=taken, folders=folders)

    return [base_of(bounds[pair]) for pair in pairs]


def measure(model: Model, given: MeasureOptions) -> MeasuredResponse:
    """Return a synthetic measurement of one function; SF902 for undamped poles, or an impossible plan."""
    check_causal(model, "a synthetic measurement")
    plan = MeasurementPlan.of(given, model.analysis.band)
    (bound,) = derive_bound(model, pick_pairs(model, [given.tf] if given.tf else [])[:1])
    band = Band(Fraction(plan.low_hz) / 2, Fraction(plan.high_hz) * 2)
    for pole in locate(bound, None if bound.is_rational else band).poles:
        if pole.on_imaginary_axis and not pole.is_zero:
            message = f"{bound.name} has an undamped pole at {pole.frequency_hz():.4g} Hz"
            raise refused(message, "only damped systems have a stationary response")
    return synthesise(bound.name, lambda omega: respond(bound, omega).values, plan, bound.source.unit)
