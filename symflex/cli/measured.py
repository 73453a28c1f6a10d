"""Measured responses: ``fit`` and ``measure``."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from symflex.budget import entered_budget
from symflex.cli.command import Specification, bare_command, command_of, first_pair
from symflex.cli.progress import ProgressBar
from symflex.cli.reporting import answer, check_place, keep, note, terminal_width, write
from symflex.errors import Diagnostic, FitError, SymflexError, refused
from symflex.options import FitOptions, MeasureOptions

if TYPE_CHECKING:
    from symflex.data.fitting import ResonanceFit
    from symflex.data.measurement import Estimate, MeasuredResponse

SUFFIXES = (".pdf", ".png", ".svg")


@bare_command("fit", FitOptions)
def fit(given: FitOptions) -> int:
    """Fit resonances to measured frequency responses.

    DATA are files of columns in text, .frd, .zma, .s1p, .s2p, .raw, .uff, .mat, .npz, .json, .xlsx, .h5 or
    .tdms, as instruments and programs save them. symflex guesses what a file does not state and prints each
    guess; --columns overrides it. If something could mean two things, the error gives the option that decides
    it.

    Each resonance adds a pair of poles and a pair of zeros to the transfer function --base SPEC --tf OUT/IN,
    or to a gain and a power of s. Several responses are fitted together and share their poles. -o writes a
    specification with resonance blocks, which derive, roots, plot and export can use; with --loop K it
    contains a loop, and 'symflex stability --gain K' finds its stable gains.

    --model SPEC --free k,b,J_2 --tf OUT/IN fits parameters of a specification in place of resonances. If the
    data cannot tell them apart, the report begins with what they determine, and with what you could fix.

    The report gives standard errors, and the frequencies where the measured phase deviates from that of a
    minimum-phase fit to the magnitude alone. A poor fit is one that does not describe the data within their
    noise or does not determine a resonance; the report begins by saying so.

    Exit code 3: the data are invalid. Exit code 4: no fit was found, with --strict a poor one, or --free has
    parameters that no data of this kind determine.
    """
    from symflex import pipeline
    from symflex.analysis.measured import fit as fitted
    from symflex.data.fitting import mode_shapes
    from symflex.data.fitting.specification import fit_specification
    from symflex.data.fitting.text import fit_json, fit_passages
    from symflex.data.measurement import prepared
    from symflex.print.text import passages_text

    if given.fits_parameters:
        return _fit_parameters(given)
    if given.base is not None and given.slope is not None:
        raise refused("--slope is for fits without --base")
    if given.loop and not given.output:
        raise refused("--loop is for the specification that -o writes")
    keep(given.base, given.output)
    for name, endings in (
        (given.output, (".toml",)),
        (given.figure, SUFFIXES),
        (given.order_figure, SUFFIXES),
    ):
        if name:
            check_place(name, endings)
    if given.base is not None:
        Specification(str(given.base), tuple(map(str, given.allow_outside)), {}).load()
    read = _read(given)
    every = prepared(read, given.band, given.averages, given.window)
    if given.driving:
        if given.base is not None:
            raise refused("--driving is for fits without --base")
        given = replace(given, tfs=(given.driving,))
    budget = entered_budget()
    with ProgressBar() as bar, budget.reporting_to(bar).entered():
        resonances = fitted(every, given)
    shapes = mode_shapes(resonances, every) if given.driving else None
    together = resonances
    if given.driving and len(every) > 1 and (given.output or given.figure):
        driven_first = sorted(every, key=lambda response: response.name != given.driving)
        with ProgressBar() as bar, budget.reporting_to(bar).entered():
            together = fitted(driven_first, replace(given, tfs=(), modes=int(resonances.modes.sum()) or None))
        why = "".join(f" (poor: {reason})" for reason in together.poor)
        note(f"files and figures have all responses, fitted with the same poles{why}")
    if given.strict and (poor := resonances.poor + together.poor):
        hint = "leave out --strict to print it anyway"
        raise FitError(Diagnostic("SF618", f"the fit is poor: {poor[0]}", None, hint))
    if given.output:
        text = fit_specification(together, Path(given.output).parent, given.loop)
        write(given.output, text)
        try:
            pipeline.loads(text, given.output)
        except SymflexError:
            folders = " ".join(f"--allow-outside {folder}" for folder in given.allow_outside)
            note(f"its base reads other folders: give {folders} to the commands that read it")
    answer(
        given.as_json,
        lambda: fit_json(resonances, shapes),
        lambda: passages_text(fit_passages(resonances, shapes), terminal_width()),
    )
    _draw(together, given)
    return 0


def _fit_parameters(given: FitOptions) -> int:
    """Fit parameters of a specification, and write what is asked for."""
    from symflex import pipeline
    from symflex.data.fitting.specification import machine_specification
    from symflex.data.fitting.text import parameter_passages, parameters_json
    from symflex.data.measurement import prepared
    from symflex.figures import draw_fit, save  # imports matplotlib
    from symflex.print.text import passages_text

    keep(given.model, given.output)
    for place, endings in ((given.output, (".toml",)), (given.figure, SUFFIXES)):
        if place:
            check_place(place, endings)
    every = prepared(_read(given), given.band, given.averages, given.window)
    budget = entered_budget()
    with ProgressBar() as bar, budget.reporting_to(bar).entered():
        found = pipeline.fit_parameters(every, given)
    if given.strict and found.poor:
        hint = "leave out --strict to print it anyway"
        raise FitError(Diagnostic("SF618", f"the fit is poor: {found.poor[0]}", None, hint))
    is_complete = found.machine.identifiability.is_complete
    if given.output and not is_complete:
        note(f"{given.output} is not written: the data do not determine all parameters")
    elif given.output:
        today = datetime.now(UTC).date().isoformat()
        write(given.output, machine_specification(found, Path(given.output).parent, today))
    answer(
        given.as_json,
        lambda: parameters_json(found),
        lambda: passages_text(parameter_passages(found), terminal_width()),
    )
    if given.figure:
        save(draw_fit(found.residual), Path(given.figure))
        note(f"wrote {given.figure}")
    return 0 if is_complete else FitError.exit_code


def _draw(resonances: ResonanceFit, given: FitOptions) -> None:
    """Draw what figures are asked for."""
    if not (given.figure or given.order_figure):
        return
    from symflex.data.fitting import stabilisation
    from symflex.figures import draw_fit, draw_orders, save  # imports matplotlib

    if given.figure:
        save(draw_fit(resonances), Path(given.figure))
        note(f"wrote {given.figure}")
    if given.order_figure:
        save(draw_orders(stabilisation(resonances), resonances), Path(given.order_figure))
        note(f"wrote {given.order_figure}")


def _estimate(given: FitOptions | MeasureOptions) -> Estimate:
    """Return how responses of time records are estimated."""
    from symflex.data.measurement import Estimate

    is_chosen = bool(given.segments or given.window or given.estimator != Estimate.estimator)
    return Estimate(given.estimator, given.segments, given.window or "hann", is_chosen)


def _read(given: FitOptions) -> list[MeasuredResponse]:
    """Return the responses of all files, and print what was guessed of each.

    How the frequency response of a record was estimated is no matter to a fit in time.
    """
    from symflex.data.fitting import are_in_time
    from symflex.data.measurement import read_measurement, read_records

    read: list[MeasuredResponse] = []
    if given.first_hz and not given.step_hz:
        raise refused("--from gives the first frequency and needs --step")
    axis = (given.first_hz, given.step_hz) if given.step_hz else None
    if bool(given.records) == bool(given.data):
        raise refused("give DATA, or --records u=FILE,y=FILE", "as in: symflex fit data.csv")
    for path in [given.records] if given.records else given.data:
        if given.records:
            responses = read_records(given.records, given.columns, _estimate(given))
        else:
            responses = read_measurement(str(path), given.columns, _estimate(given), axis)
        is_in_time = given.base is None and are_in_time(responses, given)
        said = {note for one in responses for note in one.notes} if is_in_time else set[str]()
        for guess in dict.fromkeys(guess for one in responses for guess in one.guesses):
            if guess not in said:
                note(f"{path}: {guess}")
        read += responses
    return read


@command_of("measure", MeasureOptions)
def measure(spec: Specification, given: MeasureOptions) -> int:
    """Write the frequency response of a time record, or a synthetic measurement of a model.

    A time record has a column of time and one for each channel, as for 'symflex fit'. How its response is
    estimated depends on the input: from a step, an impact, whole periods, or by Welch's method. --tf OUT/IN
    chooses one of several.

    If SPEC is a specification, band-limited noise drives the model, and a sensor adds noise to the response.
    Overlapping records with a Hann window are averaged to an H1 estimate and its coherence. The file is
    marked as synthetic. The same seed gives the same file.
    """
    from symflex.analysis.measured import measure as measured_of
    from symflex.data.measurement import WRITERS, measurement_bytes

    check_place(given.output, WRITERS)
    if not spec.path.endswith(".toml") and (record := _record(spec.path, given)) is not None:
        said = f": {record.values.size} lines of {record.name}"
        write(given.output, measurement_bytes(record, given.output), said)
        return 0
    model = spec.load()
    tf = "/".join(first_pair(model, given.tf, "measuring"))
    measured = measured_of(model, replace(given, tf=tf, rolloff=given.rolloff or None))
    said = f": {measured.values.size} lines of SYNTHETIC data"
    write(given.output, measurement_bytes(measured, given.output), said)
    return 0


def _record(path: str, given: MeasureOptions) -> MeasuredResponse | None:
    """Return the response of a time record that ``--tf`` names, ``None`` if the file is none."""
    from symflex.data.measurement import prepared, responses_in_time

    every = responses_in_time(path, given.columns, _estimate(given))
    if every is None:
        return None
    for guess in dict.fromkeys(guess for one in every for guess in one.guesses):
        note(f"{path}: {guess}")
    chosen = [one for one in every if given.tf in (None, one.name)]
    if len(chosen) != 1:
        names = ", ".join(one.name for one in every)
        raise refused(f"choose a response with --tf: {names}")
    (response,) = prepared(chosen, given.band)
    return response
