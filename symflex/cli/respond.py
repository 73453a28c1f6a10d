"""What a model answers: ``respond`` and ``shape`` in time, ``peak`` over all frequencies."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from symflex.cli.command import Specification, bound_rows, command_of, first_pair, refuse_ends
from symflex.cli.reporting import PICTURES, answer, check_place, emit_json, note, say, write
from symflex.errors import Diagnostic, UncertifiedError, refused
from symflex.model import read_settings
from symflex.options import POINTS, PeakOptions, RespondOptions, ShapeOptions, axis_ends, duration

if TYPE_CHECKING:
    from symflex.analysis.time_response import EnclosedResponse
    from symflex.data.measurement.input_signal import InputSignal
    from symflex.data.measurement.record import TimeRecord
    from symflex.model import Input, Model, Output
    from symflex.roots import PoleZeroMap
    from symflex.transfer import AnyBoundFunction

TABLE = ".csv"


@command_of("respond", RespondOptions)
def respond(spec: Specification, given: RespondOptions) -> int:
    """Print the response of an output of SPEC to a step, impulse, ramp or a file.

    The input is of unit size; the system is at rest before t = 0. Every value is proved to lie within its
    radius: the response is computed from certified poles, not from time steps.

    --to FILE.csv joins its samples by straight lines, or with --hold by steps; the input is 0 before the
    first sample and constant after the last. This is exact, too. Two samples at one time are a jump. Values
    are converted to SI if their heading gives a unit. --initial gives values of states at the start, or at
    the first sample of a file; --to free adds no input. --shaped passes the input through the shaper that
    'symflex shape' prints for the same transfer function.

    --record FILE drives the model with the input of a time record, which is read as by 'symflex fit'. The rms
    of the difference between measured output and model is printed, and -o draws both, too. An offset of the
    output is fitted, and subtracted. Values are in SI, as those of the model; units that the record does not
    give, or others than the model's, are reported.

    An impulse in the response is printed separately, not among the values. The value at t = 0 is the limit
    from the right (t -> 0+).

    If no method certifies the response, as for undamped beams with controllers, the lowest 25 modes are
    summed (12 in a large network whose higher modes are small) and the contribution of the others is
    estimated. The first line is then marked NOT CERTIFIED.

    Exit code 4: the response could not be found, or, with --strict, is not certified.
    """
    return show_response(spec, given)


def show_response(spec: Specification, given: RespondOptions) -> int:
    """Print, write or draw a response in time."""
    from symflex import pipeline
    from symflex.analysis.response import roots_if_found
    from symflex.analysis.time_response import (
        SampleTimes,
        default_until,
        find_step_info,
        forced_response,
        free_motion,
        response_from,
        response_text,
    )
    from symflex.roots.locate import as_quotient

    path = Path(given.record or given.to)
    is_file = given.record is not None or _is_signal(path)
    _check_options(given, is_file=is_file)
    initial = read_settings(given.initial, "--initial")
    until = None if given.until is None else duration(given.until, "--until")
    model = spec.load()
    pair = first_pair(model, given.tf, "showing")
    record = _record(path, given) if given.record else None
    signal = _signal(path) if is_file and not record else None
    (bound,) = pipeline.derive_for_roots(model, [pair], is_explained=True)
    if signal is not None:
        for said in (*signal.guesses, *_unit_said(signal.unit, "the input", bound.source.input)):
            note(f"{path}: {said}")
    free = free_motion(model, pair, initial) if initial else None
    shaper = None
    if given.shaped is not None:
        from symflex.analysis.input_shaping import input_shaper

        shaper = input_shaper(bound, given.modes, given.shaped, given.digits, joint=given.joint)
    roots = None
    if record is not None:
        response = _compared(record, bound, given, until)
    elif signal is not None:
        wanted = _times(signal, given, until)
        samples = signal.times, signal.values, wanted, given.digits, shaper
        response = forced_response(as_quotient(bound), *samples, is_held=given.hold, free=free)
        response = replace(response, input=path.name)
    else:
        # With waves, poles are found only where they are needed for the last time anyway.
        roots = roots_if_found(bound) if until is None or bound.is_rational else None
        last = until or Fraction(
            f"{max(default_until(bound, roots), default_until(free) if free else 0):.2g}"
        )
        times = SampleTimes.evenly(last, given.points or POINTS)
        response = response_from(free, bound, given.to, times, given.digits, shaper)
    response = replace(response, initial=", ".join(f"{name} = {x}" for name, x in initial.items()))
    if given.output:
        _write(response, given, Path(given.output))
    if not given.output or given.record:
        is_step = given.to == "step" and not (is_file or shaper or free) and response.certified
        # Where a pole that is known keeps the response from rest, the others are not needed.
        rests = is_step and not any(
            p.on_imaginary_axis or p.re > 0 for p in (roots.all_poles if roots else ()) if not p.is_zero
        )
        info = find_step_info(bound, given.digits, response.modes) if rests else None
        if given.as_json:
            emit_json(
                response.to_json_dict() | ({"step_info": info.to_json_dict(given.digits)} if info else {})
            )
        else:
            about = [response.comparison] if response.comparison else _growth(roots)
            say(response_text(response, [*(info.lines(response.unit) if info else ()), *about]))
    if given.strict and not response.certified:
        raise UncertifiedError(Diagnostic("SF810", f"not every value is certified: {response.reason}"))
    return 0


def _record(path: Path, given: RespondOptions) -> TimeRecord:
    from symflex.data.measurement import record_in_time

    if (record := record_in_time(path, given.columns)) is None:
        raise refused(f"'{path}' is not a time record", "a column called time, or --columns t,u,y")
    return record


def _times(signal: InputSignal, given: RespondOptions, until: Fraction | None) -> tuple[Fraction, ...]:
    from symflex.analysis.time_response import evenly

    if until is None and given.points is None:
        return tuple(dict.fromkeys(signal.times))
    return tuple(evenly(until or signal.times[-1], given.points or POINTS))


def _unit_said(unit: str, called: str, end: Input | Output) -> list[str]:
    """Return what is to be said of a unit that is not that of an input or output."""
    from symflex.quantities import unit_of

    if not (end.dimension and unit and unit_of(unit).dimension != end.dimension):
        return []
    wanted = end.unit or str(end.dimension)
    return [f"{called} is in {unit}, and {end.name} in {wanted}: values are not converted"]


def _compared(
    record: TimeRecord, bound: AnyBoundFunction, given: RespondOptions, until: Fraction | None
) -> EnclosedResponse:
    """Return the response to the input of a record, and the output that was measured; print guesses."""
    from symflex.analysis.time_response import forced_response
    from symflex.roots.locate import as_quotient

    signal, (name, measured) = record.driven(bound.source.output.name)
    source = record.input[0] if record.input else ""
    said = list(signal.guesses)
    for channel, end in ((source, bound.source.input), (name, bound.source.output)):
        if end.dimension and record.units.get(channel) is None:
            wanted = end.unit or str(end.dimension)
            said.append(f"'{channel}' has no unit in the record, and is taken in {wanted}, as {end.name}")
        said += _unit_said(record.units.get(channel, ""), f"'{channel}'", end)
    samples = signal.times, signal.values, _times(signal, given, until), given.digits
    responses = {}
    for is_held in (True,) if given.hold or record.is_held else (False, True):
        made = forced_response(as_quotient(bound), *samples, is_held=is_held)
        kept = np.interp(made.times, np.array(signal.times, np.float64), measured)
        responses[is_held] = replace(made, input=Path(given.record or "").name).compared(name, kept)
    is_held = min(responses, key=lambda held: responses[held].rms_difference)
    if not given.hold:
        way = "held from each sample to the next" if is_held else "straight between its samples"
        said.append(f"the input is taken as {way}" + ", which is closer" * (len(responses) > 1))
    for guess in said:
        note(f"{given.record}: {guess}")
    return responses[is_held]


def _growth(known: PoleZeroMap | None) -> list[str]:
    """Return a line that says so where a response grows, or hidden motion does; poles may be unknown."""
    if known is None or known.verdict.word != "unstable":
        return []
    if any(root.re > 0 for root in known.all_poles):
        return [f"the response grows without bound; the system is {known.verdict.sentence}"]
    motion = known.verdict.hidden_motion
    return [f"the system is {known.verdict.sentence}", *([motion] if motion else [])]


def _is_signal(path: Path) -> bool:
    """Tell whether this is a file, and no word such as step, for which nothing need be imported."""
    if not path.suffix:
        return False
    from symflex.data.measurement.input_signal import ENDINGS

    return path.suffix.lower() in ENDINGS


def _signal(path: Path) -> InputSignal:
    from symflex.data.measurement.input_signal import read_signal

    return read_signal(path)


def _check_options(given: RespondOptions, *, is_file: bool) -> None:
    """Refuse options that need others: a file, a figure, a shaper, initial values."""
    for is_wrong, message in (
        (
            given.shaped is None and (given.joint or given.modes != 1),
            "--modes and --joint need --shaped zv, zvd or ei",
        ),
        (given.hold and not is_file, "--hold needs a file of samples: --to FILE.csv"),
        (given.record and given.to != "step", "give only one of --record and --to"),
        (given.record and (given.shaped or given.initial), "--record starts at rest, and is not shaped"),
        (given.to == "free" and not given.initial, "--to free needs --initial, as in --initial x='1 mm'"),
    ):
        if is_wrong:
            raise refused(message)
    if given.output:
        check_place(given.output, (TABLE, *PICTURES))
        if given.as_json:
            raise refused("give only one of --json and -o")
    is_figure = Path(given.output or "").suffix in PICTURES
    if not is_figure and any((given.xlim, given.ylim, given.width, given.font)):
        message = "--xlim, --ylim, --width and --font apply only to a figure"
        raise refused(message, "name one, as in -o step.svg")


def _write(response: EnclosedResponse, given: RespondOptions, path: Path) -> None:
    """Write a table, or a figure as options ask for it."""
    if path.suffix.lower() == TABLE:
        write(path, response.to_csv())
        return
    from symflex.figures import checked_font, draw_in_time, save
    from symflex.figures.axes import AxisLimits
    from symflex.print.latex import width_of

    font = checked_font(given.font, path)
    frame = AxisLimits(axis_ends(given.xlim, "--xlim"), axis_ends(given.ylim, "--ylim"))
    save(draw_in_time(response, frame=frame, width_mm=width_of(given.width), font=font), path, font=font)
    note(f"wrote {path}")


@command_of("peak", PeakOptions)
def peak(spec: Specification, given: PeakOptions) -> int:
    """Print the largest magnitude of one transfer function of SPEC over all frequencies, and where it is.

    It is certified that no frequency has a larger one; a pole on the imaginary axis makes it infinite. With
    complex coefficients negative frequencies count, too. For stable lumped functions the H2 norm is printed,
    too. Exit code 4: no bound is known beyond some frequency.

    --matrix bounds the largest singular value of all pairs at once. --h2 encloses the H2 norm, also of
    distributed functions: the RMS of the output when white noise drives the input; --noise shapes it.
    """
    from symflex import pipeline
    from symflex.loops.peak import find_peak

    model = spec.load()
    if given.noise and not given.is_h2:
        raise refused("--noise shapes the noise of --h2", "add --h2")
    if given.is_h2:
        return _h2(model, given)
    if given.is_matrix:
        return _largest_of_matrix(model, given)
    refuse_ends(given)
    (bound,) = pipeline.derive_bound(model, [first_pair(model, given.tf, "showing")])
    found = find_peak(bound, given.digits, given.band)
    answer(given.as_json, found.to_json_dict, lambda: str(found))
    return 0 if found.certified else 4


def _h2(model: Model, given: PeakOptions) -> int:
    """Print the H2 norm."""
    from symflex.analysis.norms.energy import find_h2_norm, noise_filter

    if given.band is not None:
        raise refused("--h2 is of all frequencies", "leave --band out")
    norm = find_h2_norm(bound_rows(model, given), noise_filter(model, given.noise), given.noise)
    answer(given.as_json, norm.to_json_dict, lambda: str(norm))
    return 0 if norm.certified else 4


def _largest_of_matrix(model: Model, given: PeakOptions) -> int:
    """Print the largest singular value of a matrix."""
    from symflex.analysis.norms.matrix_peak import find_matrix_peak

    found = find_matrix_peak(bound_rows(model, given), given.band)
    answer(given.as_json, found.to_json_dict, lambda: str(found))
    return 0 if found.certified else 4


@command_of("shape", ShapeOptions)
def shape(spec: Specification, given: ShapeOptions) -> int:
    """Print an input shaper for the lowest oscillating modes of SPEC.

    A command convolved with the impulses of the shaper leaves these modes at rest when it ends: exactly with
    zv and zvd. ei leaves up to 5 % of the vibration of an unshaped impulse, and tolerates larger errors of
    the frequency. Times and amplitudes come from certified poles.

    Shapers of several modes are convolved. -o draws the residual vibration of a mode whose frequency differs
    from the model's.
    """
    from symflex import pipeline
    from symflex.analysis.input_shaping import input_shaper

    if given.output:
        check_place(given.output, PICTURES)
    model = spec.load()
    (bound,) = pipeline.derive_for_roots(model, [first_pair(model, given.tf, "shaping")], is_explained=True)
    shaper = input_shaper(bound, given.modes, given.kind, given.digits, joint=given.joint)
    answer(given.as_json, shaper.to_json_dict, lambda: str(shaper))
    if given.output:
        from symflex.figures import draw_residual, save

        save(draw_residual(shaper), Path(given.output))
        note(f"wrote {given.output}")
    return 0
