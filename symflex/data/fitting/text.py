"""A fit as the text a terminal shows and as JSON data."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from fractions import Fraction
from math import ceil, comb, floor, isfinite, log10, pi, sqrt
from typing import Final

import numpy as np

from symflex.data.fitting import FittedModeShapes, ParameterFit, PhaseTest, ResonanceFit
from symflex.data.fitting.identifiable import Identifiability
from symflex.data.fitting.record_search import RecordTerms
from symflex.errors import counted
from symflex.model import ModelParameter
from symflex.print.text import INDENT, Passage

HOLDS: Final = {"held": "held", "joined": "joined by lines", "smooth": "smooth"}
SCHEMA: Final = "symflex.fit/1"
PARAMETERS_SCHEMA: Final = "symflex.fit_parameters/1"
ERROR_DIGITS: Final = 2
MOST_FIXES: Final = 8  # sets of parameters to fix that are listed
STARTS: Final = {
    "peaks": "peaks and troughs of the magnitude, the paper's procedure",
    "vector": "vector fitting",
    "aaa": "AAA approximation",
    "subspace": "a subspace method, in time",
    "none": "nothing but a gain",
}


def fit_passages(fit: ResonanceFit, shapes: FittedModeShapes | None) -> Iterator[Passage]:
    """Return the report of a fit, and of mode shapes."""
    modes, errors = fit.resonances, fit.standard_errors()
    lines = [f"POOR FIT: {reason}" for reason in fit.poor]
    for r, measured in enumerate(fit.measured):
        lines.append(f"{measured.name}   {_what(fit, r)}")
        if measured.is_synthetic:
            lines.append(f"{INDENT}the data are SYNTHETIC: computed from a model, not measured")
        lines.append(INDENT + _data_line(fit, r))
    yield Passage([*lines, f"{INDENT}start: {STARTS[fit.candidate.start_kind]}"])
    poles = list(zip(modes.omega_p, errors.omega_p, modes.zeta_p, errors.zeta_p, strict=True))
    rows = [_row(str(k), *poles[i]) for k, i in enumerate(np.flatnonzero(fit.modes), 1)]
    none = "" if rows else ": no resonance in the band"
    yield Passage([f"{INDENT}poles{none}"], [HEAD, *rows] if rows else ())
    rows = _residual_terms(fit)
    if rows:
        yield Passage([f"{INDENT}residual terms: poles that are not resonances in the band"], [HEAD, *rows])
    for r in range(modes.responses):
        yield _zeros(fit, r)
    if shapes is not None:
        yield _shapes(shapes)
    if fit.record is not None:
        yield Passage([INDENT + line for line in [*_record_lines(fit, fit.record), *_validation_lines(fit)]])
    misfits = (
        [] if fit.record else [(fit.misfit_db(r), fit.misfit_degrees(r)) for r in range(modes.responses)]
    )
    residuals = [
        f"{INDENT}residual{fit.of_response(r)}: {level:.2g} dB"
        f"{'' if fit.measured[r].is_magnitude else f' and {turn:.2g} degrees'} rms"
        for r, (level, turn) in enumerate(misfits)
    ]
    if not fit.record:
        yield Passage([*residuals, INDENT + _accuracy(fit)])
    if fit.scores:
        yield _orders(fit)
    words = enumerate(_phase_words(test, fit, r) for r, test in enumerate(fit.phase_tests))
    tests = [f"phase test{fit.of_response(r)}: {said}" for r, said in words]
    yield Passage([INDENT + line for line in [*tests, *(f"warning: {said}" for said in fit.warnings)]])


def parameter_passages(fit: ParameterFit) -> Iterator[Passage]:
    """Return the report of a fit of parameters."""
    machine, shown = fit.machine, fit.residual
    lines = [f"POOR FIT: {reason}" for reason in fit.poor]
    many = counted(len(machine.names), "parameter")
    for r, measured in enumerate(shown.measured):
        lines.append(f"{measured.name}   {many} of {machine.functions[r].name} in {machine.path}")
        if measured.is_synthetic:
            lines.append(f"{INDENT}the data are SYNTHETIC: computed from a model, not measured")
        lines.append(INDENT + _data_line(shown, r))
    yield Passage([*lines, *(INDENT + said for said in fit.in_time)])
    yield from _identifiability(fit)
    rows = [("", "value", "std. error", "95 % interval", "", "")]
    table = zip(machine.parameters, fit.theta, fit.errors, fit.intervals(), strict=True)
    for p, value, error, ends in table:
        scale, unit = _written_scale(p)
        prior = f"spread {_spread_text(p)}" if p.spread is not None else ""
        if not isfinite(error):
            rows.append((p.name, "undetermined", "", "", unit, prior))
            continue
        numbers = (significant(value / scale, error / scale), f"{error / scale:#.2g}")
        interval = " to ".join(significant(end / scale, error / scale) for end in ends)
        rows.append((p.name, *numbers, interval, unit, prior))
    yield Passage([f"{INDENT}parameters"], rows)
    derived = [
        (
            one.name,
            significant(value, error),
            f"{error:#.2g}" if isfinite(error) else "undetermined",
            one.unit,
        )
        for one, value, error in fit.definitions()
    ]
    if derived:
        yield Passage([f"{INDENT}definitions"], [("", "value", "std. error", ""), *derived])
    misfits = [(shown.misfit_db(r), shown.misfit_degrees(r)) for r in range(len(shown.measured))]
    residuals = [
        f"{INDENT}residual{shown.of_response(r)}: {level:.2g} dB"
        f"{'' if shown.measured[r].is_magnitude else f' and {turn:.2g} degrees'} rms"
        for r, (level, turn) in enumerate(misfits)
    ]
    same, tried = fit.starts
    begun = f"{same} of {counted(tried, 'start')} led to these values"
    errors = "standard errors are those of the fit in time" if fit.in_time else _accuracy(shown)
    yield Passage([*residuals, INDENT + errors, INDENT + begun])
    said = [f"{INDENT}warning: {one}" for one in fit.warnings]
    if said:
        yield Passage(said)


def _identifiability(fit: ParameterFit) -> Iterator[Passage]:
    """Return which parameters cannot be distinguished, and other values with the same response."""
    machine, known = fit.machine, fit.machine.identifiability
    if not known.is_complete:
        determined = list(known.alone)
        determined += [known.text(powers) for powers in known.combinations]
        determined += [one.text for one in known.expressions]
        what = "response" if len(machine.functions) == 1 else "responses"
        count = f"{counted(known.rank, 'number')} of {counted(len(known.names), 'parameter')}"
        lines = [f"{INDENT}NOT IDENTIFIABLE: the {what} can tell only {count}: {', '.join(determined)}"]
        if known.fixes:
            lines.append(f"{INDENT}fix, or give a spread to, {_fixes(known)}")
        rows = [("", "value", "std. error")]
        rows += [
            (name, significant(value, error), f"{error:#.2g}") for name, value, error in fit.combinations()
        ]
        yield Passage(lines, rows if len(rows) > 1 else ())
    names = machine.names
    lost = [n for n, e in zip(names, fit.errors, strict=True) if not isfinite(e) and n in known.alone]
    for twin in () if lost else fit.twins:
        changed = [
            f"{name} = {value / _written_scale(p)[0]:.5g} {_written_scale(p)[1]}".rstrip()
            for name, p, value, own in zip(names, machine.parameters, twin, fit.theta, strict=True)
            if abs(value - own) > 1e-6 * abs(own)
        ]
        how = "have the same response" if fit.are_exact_twins else "fit as well"
        yield Passage([f"{INDENT}OTHER VALUES {how}: {', '.join(changed)}"])


def _fixes(known: Identifiability) -> str:
    """Return which parameters one could fix."""
    count = len(known.names) - known.rank
    if len(known.fixes) == comb(len(known.mixed), count):
        if count == len(known.mixed):
            return " and ".join(known.mixed)
        return f"{'one' if count == 1 else f'any {count}'} of {', '.join(known.mixed)}"
    sets = [" and ".join(names) for names in known.fixes]
    more = f"; or {len(sets) - MOST_FIXES} other sets" if len(sets) > MOST_FIXES else ""
    return f"{'; or '.join(sets[:MOST_FIXES])}{more}"


def _written_scale(parameter: ModelParameter) -> tuple[float, str]:
    """Return what one of the unit in which a parameter was written is in the unit of its value."""
    if parameter.written_unit:
        return float(parameter.scale.nearly), parameter.written_unit
    return 1.0, parameter.unit if parameter.unit != "1" else ""


def _spread_text(parameter: ModelParameter) -> str:
    spread = parameter.spread
    if isinstance(spread, Fraction):
        return f"{100 * float(spread):.3g} %"
    assert spread is not None  # asked for where there is one
    scale, unit = _written_scale(parameter)
    return f"{float(spread.nearly) / scale:.3g} {unit}".rstrip()


def parameters_json(fit: ParameterFit) -> dict[str, object]:
    """Return the document ``symflex fit --model --json`` prints."""
    machine, known, shown = fit.machine, fit.machine.identifiability, fit.residual
    table = zip(machine.parameters, fit.theta.tolist(), fit.errors.tolist(), fit.intervals(), strict=True)
    return {
        "schema": PARAMETERS_SCHEMA,
        "model": machine.path,
        "poor": bool(fit.poor),
        "poor_because": list(fit.poor),
        "parameters": [
            {
                "name": p.name,
                "value": value if isfinite(error) else None,
                "standard_error": _finite(error),
                "interval": [_finite(ends[0]), _finite(ends[1])] if isfinite(error) else None,
                "unit": p.unit,
                "declared": machine.values[p.name],
                "identifiable": p.name in known.alone,
            }
            for p, value, error, ends in table
        ],
        "correlations": fit.correlations.tolist() if known.is_complete else None,
        "definitions": [
            {"name": one.name, "value": _finite(value), "standard_error": _finite(error), "unit": one.unit}
            for one, value, error in fit.definitions()
        ],
        "identifiable": {
            "complete": known.is_complete,
            "rank": known.rank,
            "exact": known.is_exact,
            "combinations": [
                {"expression": name, "value": value, "standard_error": error}
                for name, value, error in fit.combinations()
            ],
            "fix": [list(names) for names in known.fixes],
        },
        "other_values": [dict(zip(machine.names, twin.tolist(), strict=True)) for twin in fit.twins],
        "other_values_exact": fit.are_exact_twins,
        "responses": [
            {
                "name": measured.name,
                "tf": machine.functions[r].name,
                "synthetic": measured.is_synthetic,
                "lines": measured.values.size,
                "left_out_hz": measured.frequency_hz[shown.left_out(r)].tolist(),
                "band_hz": [float(measured.frequency_hz[0]), float(measured.frequency_hz[-1])],
                "unit": measured.unit,
                "residual_db": shown.misfit_db(r),
                "residual_degrees": None if measured.is_magnitude else shown.misfit_degrees(r),
            }
            for r, measured in enumerate(shown.measured)
        ],
        "residual": {
            "reduced": shown.refined.reduced,
            "in_units_of_coherence_noise": _is_scaled(shown),
            "line_correlation": shown.refined.correlation,
        },
        "in_time": list(fit.in_time),
        "warnings": list(fit.warnings),
    }


def _record_lines(fit: ResonanceFit, record: RecordTerms) -> Iterator[str]:
    """Yield what a fit in time found besides poles and zeros, and what it leaves."""
    for r, (offset, rest, share) in enumerate(
        zip(record.offsets, record.residual, record.residual_share, strict=True)
    ):
        whose = fit.of_response(r)
        drift = f", drift {record.drifts[r]:.3g} per second" if record.drifts else ""
        if offset is not None:
            yield f"offset{whose} {offset:.4g}{drift}"
        yield from (
            f"steady sine{whose}: {_shown(one.frequency_hz, one.error_hz)} Hz, standard error "
            f"{_error(one.error_hz)} Hz, amplitude {one.amplitudes[r]:.3g}"
            + f" ({one.name})"
            * bool(one.name)
            for one in record.sines
        )
        colour = ", coloured" if record.is_coloured[r] else ""
        yield f"residual{whose}: {rest:.3g} rms, {100 * share:.2g} % of the output{colour}"
    yield "standard errors are scaled to the residual"


def _validation_lines(fit: ResonanceFit) -> Iterator[str]:
    """Yield how far the second half of a record is from what a fit to the first half predicts."""
    if (one := fit.validation) is None:
        return
    by = f"a fit to the first half, of {counted(one.modes, 'resonance')}"
    for r, (error, share, noise) in enumerate(zip(one.error, one.share, one.noise, strict=True)):
        off = f"{error:.3g} rms, {100 * share:.2g} % of the output"
        left = f"it leaves {noise:.3g} of its own"
        yield f"validation{fit.of_response(r)}: {by}, predicts the second half within {off}; {left}"


def _validation_json(fit: ResonanceFit) -> dict[str, object] | None:
    if (one := fit.validation) is None:
        return None
    return {
        "modes": one.modes,
        "error_rms": list(one.error),
        "error_share": list(one.share),
        "first_half_rms": list(one.noise),
    }


def _record_json(record: RecordTerms) -> dict[str, object]:
    return {
        "hold": record.hold if record.is_driven else None,
        "from_rest": record.is_at_rest,
        "samples": list(record.samples),
        "step_s": record.step_s,
        "offset": list(record.offsets),
        "drift_per_s": None if record.drifts is None else list(record.drifts),
        "sines": [
            {
                "frequency_hz": one.frequency_hz,
                "standard_error_hz": _finite(one.error_hz),
                "amplitude": [_finite(x) for x in one.amplitudes],
                "mains": one.name or None,
            }
            for one in record.sines
        ],
        "residual_rms": list(record.residual),
        "residual_share": list(record.residual_share),
    }


def _zeros(fit: ResonanceFit, r: int) -> Passage:
    """Return the zeros of a response, and what else of it is fitted."""
    modes, errors, free = fit.resonances, fit.standard_errors(), fit.problem.free
    lines = [f"{INDENT}zeros{fit.of_response(r)}"]
    if free.gain:
        unit = "" if fit.gain_unit(r) == "1" else fit.gain_unit(r)
        gain = f"{INDENT}gain {significant(modes.gain[r], errors.gain[r])} {unit}".rstrip()
        lines.append(f"{gain}, standard error {errors.gain[r]:.2g}")
    if free.lag:
        lag = significant(modes.lag[r], errors.lag[r])
        lines.append(f"{INDENT}lag of the sensor {lag} s, standard error {errors.lag[r]:.2g} s")
    if free.delay:
        delay = significant(modes.delay[r], errors.delay[r])
        lines.append(f"{INDENT}delay {delay} s, standard error {errors.delay[r]:.2g} s")
    if modes.is_improper[r] and not fit.problem.has_base:
        end = fit.problem.band[1] / (2 * pi)
        lines.append(f"{INDENT}more zeros than poles, as the data ask for: it grows beyond {end:.4g} Hz")
    rows = [
        _row(str(i + 1), modes.omega_z[r, i], errors.omega_z[r, i], modes.zeta_z[r, i], errors.zeta_z[r, i])
        for i in np.flatnonzero(modes.has_zeros[r]).tolist()
    ]
    if np.isfinite(modes.real_z[r]):
        corner, error = modes.real_z[r] / (2 * pi), errors.real_z[r] / (2 * pi)
        side = "real" if corner > 0 else "real, right half"
        rows.append(("", _shown(abs(corner), error), _error(error), "", "", side))
    if not rows:
        lines[0] += ": none"
    return Passage([*lines[1:], lines[0]], [HEAD, *rows] if rows else ())


def _residual_terms(fit: ResonanceFit) -> list[tuple[str, ...]]:
    modes, errors = fit.resonances, fit.standard_errors()
    low, high = fit.problem.band
    rows = []
    for i in np.flatnonzero(~fit.modes & (modes.zeta_p < 1)).tolist():
        row = _row("", modes.omega_p[i], errors.omega_p[i], modes.zeta_p[i], errors.zeta_p[i])
        side = "below the band" if modes.omega_p[i] < low else "above the band"
        rows.append((*row[:-1], "no peak" if low <= modes.omega_p[i] <= high else side))
    for corner, error in fit.real_poles():
        hertz, hertz_error = corner / (2 * pi), error / (2 * pi)
        rows.append(("", _shown(hertz, hertz_error), _error(hertz_error), "", "", "real"))
    return rows


def _orders(fit: ResonanceFit) -> Passage:
    rows = [("poles", "modes", "parameters", "BIC", "AICc", "residual", "")]
    for s in fit.scores:
        mark = "<" if s.order == fit.resonances.order else s.status.replace("usable", "")
        numbers = (f"{s.bic:.1f}", f"{s.aicc:.1f}", f"{sqrt(s.reduced):.4g}")
        rows.append((str(s.order), str(s.count), str(s.parameters), *numbers, mark))
    condition = "did not fail"
    if any(s.status == "weak" for s in fit.scores):
        condition += " and are not weak (a resonance lost in noise)"
    return Passage([f"{INDENT}chosen by {fit.criterion.upper()}, the lowest of those that {condition}"], rows)


def _shapes(shapes: FittedModeShapes) -> Passage:
    head = f"mass-normalised mode shapes [{shapes.unit}], driven at {shapes.names[shapes.driving]}"
    rows = [("mode", "response", "value", "std. error", "off real [deg]")]
    for i in range(shapes.shapes.shape[1]):
        for r, name in enumerate(shapes.names):
            value, error, turned = shapes.shapes[r, i], shapes.errors[r, i], shapes.turned[r, i]
            rows.append(("" if r else str(i + 1), name, f"{value:.5g}", f"{error:.2g}", f"{turned:.1f}"))
    return Passage([INDENT + head, f"{INDENT}from poles that suit all responses best"], rows)


def _shapes_json(shapes: FittedModeShapes) -> dict[str, object]:
    return {
        "driving": shapes.names[shapes.driving],
        "unit": shapes.unit,
        "responses": list(shapes.names),
        "frequency_hz": shapes.frequency_hz.tolist(),
        "damping_ratio": shapes.damping_ratio.tolist(),
        "shapes": shapes.shapes.T.tolist(),
        "standard_errors": shapes.errors.T.tolist(),
        "degrees_off_real": shapes.turned.T.tolist(),
    }


def fit_json(fit: ResonanceFit, shapes: FittedModeShapes | None = None) -> dict[str, object]:
    """Return the document ``symflex fit --json`` prints."""
    modes = fit.resonances
    return {
        "schema": SCHEMA,
        "modes": int(fit.modes.sum()),
        "start": fit.candidate.start_kind,
        "gain_fitted": fit.problem.free.gain,
        "lag_fitted": fit.problem.free.lag,
        "delay_fitted": fit.problem.free.delay,
        "poor": bool(fit.poor),
        "poor_because": list(fit.poor),
        "poles": _poles(fit, fit.modes),
        "residual_poles": _poles(fit, ~fit.modes & (modes.zeta_p < 1)),
        "real_poles": [_real(corner, error) for corner, error in fit.real_poles()],
        "responses": [_response_json(fit, r) for r in range(modes.responses)],
        "residual": {
            "reduced": fit.refined.reduced,
            "in_units_of_coherence_noise": _is_scaled(fit),
            "line_correlation": fit.refined.correlation,
        },
        "criterion": fit.criterion,
        "orders": [
            {"poles": s.order, "modes": s.count, "parameters": s.parameters}
            | {name: _finite(getattr(s, name)) for name in ("bic", "aicc", "reduced")}
            | {"status": s.status}
            for s in fit.scores
        ],
        "record": None if fit.record is None else _record_json(fit.record),
        "validation": _validation_json(fit),
        "mode_shapes": None if shapes is None else _shapes_json(shapes),
        "warnings": list(fit.warnings),
    }


def _response_json(fit: ResonanceFit, r: int) -> dict[str, object]:
    measured, base, test = fit.measured[r], fit.bases[r], fit.phase_tests[r]
    modes, errors, start = fit.resonances, fit.standard_errors(), fit.candidate.start
    shown = modes.has_zeros[r]
    omega = modes.omega_z[r, shown]
    parts = (start.omega_p, start.zeta_p, start.omega_z[r], start.zeta_z[r])
    begun = zip(*(part.tolist() for part in parts), strict=True)
    zeros = _pairs(np.abs(omega), modes.zeta_z[r, shown], errors.omega_z[r, shown], errors.zeta_z[r, shown])
    return {
        "name": measured.name,
        "synthetic": measured.is_synthetic,
        "lines": measured.values.size,
        "left_out_hz": measured.frequency_hz[fit.left_out(r)].tolist(),
        "band_hz": [float(measured.frequency_hz[0]), float(measured.frequency_hz[-1])],
        "averages": measured.averages,
        "window": measured.window or None,
        "unit": measured.unit,
        "base": {"spec": base.path, "tf": base.tf} if base.path else None,
        "slope": None if base.path else base.slope,
        "gain": {
            "value": float(modes.gain[r]),
            "standard_error": _finite(float(errors.gain[r])),
            "unit": fit.gain_unit(r),
        },
        "lag": {"value": float(modes.lag[r]), "standard_error": _finite(float(errors.lag[r]))},
        "delay": {"value": float(modes.delay[r]), "standard_error": _finite(float(errors.delay[r]))},
        "zeros": [p | {"real_of_opposite_sign": bool(w < 0)} for p, w in zip(zeros, omega, strict=True)],
        "real_zeros": [_real(modes.real_z[r], errors.real_z[r])] if np.isfinite(modes.real_z[r]) else [],
        "start": [{"omega_p": p, "zeta_p": x, "omega_z": _finite(z), "zeta_z": y} for p, x, z, y in begun],
        "residual_db": fit.misfit_db(r),
        "residual_degrees": None if measured.is_magnitude else fit.misfit_degrees(r),
        "phase_test": {
            "minimum_phase": None if test.verdict in ("undetermined", "assumed") else test.is_minimum_phase,
            "verdict": test.verdict,
            "lag_s": test.lag_s,
            "magnitude_residual_db": test.magnitude_db,
            "parted": [asdict(band) for band in test.bands],
        },
    }


def _poles(fit: ResonanceFit, which: np.ndarray) -> list[dict[str, object]]:
    modes, errors = fit.resonances, fit.standard_errors()
    return _pairs(*(one[which] for one in (modes.omega_p, modes.zeta_p, errors.omega_p, errors.zeta_p)))


def _real(corner: float, error: float) -> dict[str, object]:
    """Return a real pole, or zero, by its corner frequency; in the right half-plane it is negative."""
    return {
        "omega": float(corner),
        "omega_standard_error": _finite(float(error)),
        "frequency_hz": float(corner) / (2 * pi),
        "time_constant_s": 1 / float(corner),
    }


def _pairs(
    omega: np.ndarray, zeta: np.ndarray, omega_error: np.ndarray, zeta_error: np.ndarray
) -> list[dict[str, object]]:
    return [
        {
            "omega": float(omega[i]),
            "omega_standard_error": _finite(float(omega_error[i])),
            "frequency_hz": float(omega[i]) / (2 * pi),
            "frequency_standard_error_hz": _finite(float(omega_error[i]) / (2 * pi)),
            "damping_ratio": float(zeta[i]),
            "damping_standard_error": _finite(float(zeta_error[i])),
            "quality_factor": 1 / (2 * float(zeta[i])) if zeta[i] > 0 else None,
        }
        for i in range(omega.size)
    ]


def _finite(value: float) -> float | None:
    return value if isfinite(value) else None


def _is_scaled(fit: ResonanceFit) -> bool:
    return fit.problem.has_deviations and fit.problem.is_noise_known


def _what(fit: ResonanceFit, r: int) -> str:
    count, base = int(fit.modes.sum()), fit.bases[r]
    word = "resonance" if count == 1 else "resonances"
    if base.path:
        return f"{count} {word} on {base.tf} of {base.path}"
    return f"{count} {word} on a gain" + (f" times s^{base.slope}" if base.slope else "")


def _data_line(fit: ResonanceFit, r: int) -> str:
    measured = fit.measured[r]
    if (record := fit.record) is not None:
        several = f"{len(measured.samples)} records of " if len(measured.samples) > 1 else ""
        parts = [f"data: {several}{record.samples[r]} samples of {record.step_s:.6g} s, fitted in time"]
        if record.is_driven:
            parts.append(f"the input is {HOLDS[record.hold]} between samples")
            parts += ["from rest"] * record.is_at_rest
        return ", ".join(parts)
    low, high = ends_of_band(measured.frequency_hz[0], measured.frequency_hz[-1])
    parts = [f"data: {measured.values.size} lines from {low} to {high} Hz"]
    if measured.coherence is None:
        parts.append("no coherence: the noise is estimated")
    else:
        shares = measured.coherence
        parts.append(f"coherence {shares.min():.3f} or more, median {np.median(shares):.3f}")
        if measured.averages:
            parts.append(f"{measured.averages:g} averages")
    if rate := measured.decay_rate:
        parts.append(f"exponential window: {rate:.4g} 1/s that it adds are subtracted from every decay rate")
    elif measured.window:
        parts.append("Hann window")
    return ", ".join(parts)


LARGEST: Final = 1e13  # what is larger, or smaller than SMALLEST, is printed with a power of ten
SMALLEST: Final = 1e-7
HEAD: Final = ("", "frequency [Hz]", "std. error", "damping ratio", "std. error", "")


def _row(name: str, omega: float, omega_error: float, zeta: float, zeta_error: float) -> tuple[str, ...]:
    hertz, hertz_error = abs(omega) / (2 * pi), omega_error / (2 * pi)
    numbers = (_shown(hertz, hertz_error), _error(hertz_error), _shown(zeta, zeta_error), _error(zeta_error))
    return (name, *numbers, "" if omega > 0 else "real, both signs")


def _places(error: float) -> int:
    if not isfinite(error) or error <= 0:
        return 6
    return max(0, min(10, ERROR_DIGITS - 1 - floor(log10(error))))


def _shown(value: float, error: float) -> str:
    """Return a value with two digits of its error."""
    size = abs(value)
    if size and (not isfinite(value) or size >= LARGEST or size < SMALLEST):
        return significant(value, error)
    places = _places(error)
    return f"{value:.{places}f}" if isfinite(error) or size < LARGEST / 1e6 else f"{value:.0f}"


def significant(value: float, error: float) -> str:
    """Return a value with as many digits as its error allows, from 2 to 12; 6 if there is none.

    >>> significant(1.99099e11, 1.1e8), significant(0.25, 0.3), significant(10293933.7, 0.4)
    ('1.9910e+11', '0.25', '10293933.70')
    """
    digits = 6
    if isfinite(error) and error > 0 and value and isfinite(value):
        digits = floor(log10(abs(value))) - floor(log10(error)) + ERROR_DIGITS
        digits = max(ERROR_DIGITS, min(12, digits))
    text = f"{value:#.{digits}g}"
    return text.rstrip(".")


def ends_of_band(low: float, high: float) -> tuple[str, str]:
    """Return the ends of a band [Hz] in four digits, or as many as tell its width.

    >>> ends_of_band(0.12345, 50.0), ends_of_band(10270325.0, 10299976.0)
    (('0.1235', '50'), ('10270320', '10299980'))
    """
    digits = 4 + max(0, ceil(-log10((high - low) / high) - 0.5)) if high > low else 4
    rounded = [float(f"{x:.{digits}g}") for x in (low, high)]
    return f"{rounded[0]:.10g}", f"{rounded[1]:.10g}"


def _error(error: float) -> str:
    if not isfinite(error) or error >= LARGEST:
        return "undetermined" if not isfinite(error) else f"{error:.2g}"
    return f"{error:.{_places(error)}f}" if error >= 1e-10 else "0"  # noqa: PLR2004


def _accuracy(fit: ResonanceFit) -> str:
    errors = "standard errors are scaled to the residual"
    if (correlation := fit.refined.correlation) > 1:
        variance = f"a mean has {correlation:.2f} times the variance"
        errors += f" and count neighbouring lines as correlated ({variance})"
    if not _is_scaled(fit):
        return errors
    return f"that is {sqrt(fit.refined.reduced):#.3g} times what the coherence predicts; {errors}"


def _phase_words(test: PhaseTest, fit: ResonanceFit, r: int) -> str:
    low, high = ends_of_band(*fit.measured[r].frequency_hz[[0, -1]])
    base = " (the base with its own phase)" if fit.bases[r].path else ""
    if test.verdict == "assumed":
        return "magnitude only: minimum phase is assumed"
    if fit.record is not None:
        return {
            "minimum": "minimum phase: no zero of the fit lies in the right half-plane",
            "nonminimum": "not minimum phase: a zero of the fit lies in the right half-plane",
        }.get(test.verdict, "undetermined: a zero lies on either side within its error")
    if not test.bands and not test.is_minimum_phase:
        return "undetermined: noise hides the phase" if test.magnitude_db else "there was no time for it"
    if not test.bands:
        return (
            f"minimum phase: the measured phase is that of a minimum-phase fit to the magnitude alone{base}, "
            f"within 10 degrees or the noise, from {low} to {high} Hz"
        )
    worst = max(test.bands, key=lambda band: abs(band.worst_degrees))
    others = len(test.bands) - 1
    more = f" (and in {others} more {'interval' if others == 1 else 'intervals'})" if others else ""
    where = f"between {worst.low_hz:.4g} and {worst.high_hz:.4g} Hz{more}"
    off = f"{worst.worst_degrees:+.0f} degrees at {worst.worst_hz:.4g} Hz"
    parts = f"the measured phase is off by {off}, {where}"
    if test.verdict == "nonminimum":
        return f"not minimum phase: {parts}, from a minimum-phase fit to the magnitude alone{base}"
    if test.is_minimum_phase:
        return f"minimum phase: such a function fits magnitude and phase; from the magnitude alone, {parts}"
    if test.with_phase is not None:
        return (
            f"undetermined: {parts}, unless a sensor, a delay, or poles or zeros above the band add a lag of "
            f"{1e3 * test.lag_s:.3g} ms"
        )
    misfit = f"{test.magnitude_db:.2g} dB rms of the magnitude"
    return f"undetermined: {parts}, and the minimum-phase fit leaves {misfit}"
