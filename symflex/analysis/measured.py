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
from symflex.roots import Band, PoleZeroMap
from symflex.roots.locate import locate
from symflex.transfer import BoundTransferFunction
from symflex.transfer.of_model import derive_bound, pick_pairs

CANCELS = 5e-3  # distance of a fitted root from one of the base, over its size, within which it undoes that


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
    model = load_with(read(Path(given.base)), {}, allow_outside=given.allow_outside)
    bounds = _bounds(len(measured), model, given)
    bases = _bases(bounds, model, given.base, given)
    found = fit_resonances(measured, bases, replace(given, slope=None))
    return replace(found, poor=(*_contradicted(found, bounds), *found.poor))


def _contradicted(found: ResonanceFit, bounds: Sequence[BoundTransferFunction]) -> list[str]:
    """Return where a fitted pole or zero undoes one of the base: the data show no such root there."""
    modes, (low, high) = found.resonances, (end / (2 * np.pi) for end in found.problem.band)
    poles = modes.omega_p * (-modes.zeta_p + 1j * np.sqrt(np.maximum(1 - modes.zeta_p**2, 0)))
    said = []
    located: dict[str, PoleZeroMap] = {}
    for r, bound in enumerate(bounds):
        if bound.name not in located:
            band = Band(Fraction(low), Fraction(high))
            located[bound.name] = locate(bound, None if bound.is_rational else band)
        base, usable = located[bound.name], modes.has_zeros[r] & (modes.omega_z[r] > 0)
        zeta = modes.zeta_z[r, usable]
        zeros = modes.omega_z[r, usable] * (-zeta + 1j * np.sqrt(np.maximum(1 - zeta**2, 0)))
        pairs = (("pole", poles, "zero", base.zeros), ("zero", zeros, "pole", base.poles))
        for own, fitted, other, roots in pairs:
            for root in roots:
                at = complex(root.re, root.im)
                if at.imag <= 0 or not fitted.size:
                    continue
                nearest = fitted[int(np.argmin(np.abs(fitted - at)))]
                if abs(nearest - at) < CANCELS * abs(at):
                    here, there = (f"{abs(x) / (2 * np.pi):.5g} Hz" for x in (nearest, at))
                    said.append(
                        f"the fitted {own} at {here} cancels a {other} of the base at {there}: the data "
                        "contradict the values of the base; fit them with --model and --free"
                    )
    return list(dict.fromkeys(said))


def _bounds(count: int, model: Model, given: FitOptions) -> list[BoundTransferFunction]:
    """Return the function that the resonances of each response are multiplied by."""
    pairs = pick_pairs(model, given.tfs)[: None if given.tfs else 1]
    if len(pairs) == 1:
        pairs = pairs * count
    if len(pairs) != count:
        message = f"{count} responses and {len(pairs)} transfer functions of the base"
        raise refused(message, "name one with --tf for each response")
    bounds = dict(zip(pairs, derive_bound(model, pairs), strict=True))
    return [bounds[pair] for pair in pairs]


def _bases(
    bounds: Sequence[BoundTransferFunction], model: Model, path: str | Path, given: FitOptions
) -> list[Base]:
    """Return what the resonances of each response are multiplied by."""
    taken, folders = tuple(p.name for p in model.parameters), (Path(path).parent, *given.allow_outside)

    def base_of(bound: BoundTransferFunction) -> Base:
        def function(omega: npt.NDArray[Any]) -> npt.NDArray[np.complex128]:
            return evaluate(bound, omega) if omega.dtype.kind == "c" else respond(bound, omega).values

        return Base(function, bound.name, str(path), bound.source.unit, taken=taken, folders=folders)

    return [base_of(bound) for bound in bounds]


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
