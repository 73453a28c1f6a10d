"""``symflex fit``."""

from __future__ import annotations

from pathlib import Path

import click

from symflex.cli.budgeting import budgeted
from symflex.cli.reporting import check_place, emit_json, load, note, outside, reporting, say, terminal_width
from symflex.errors import Diagnostic, FitError, SymflexError, UsageError

SUFFIXES = (".pdf", ".png", ".svg")


@click.command("fit")
@click.argument("data", type=click.Path(), nargs=-1, required=True)
@click.option("--base", type=click.Path(), help="Specification whose function the resonances multiply.")
@outside
@click.option(
    "--tf", "tfs", multiple=True, metavar="OUT/IN", help="That function; repeat it, one per response."
)
@click.option(
    "--modes", type=click.IntRange(1, 50), help="How many resonances; chosen by --criterion if absent."
)
@click.option(
    "--start",
    type=click.Choice(["auto", "peaks", "vector", "aaa"]),
    default="auto",
    show_default=True,
    help="Where the fit begins; auto tries all and keeps the best.",
)
@click.option(
    "--criterion",
    type=click.Choice(["bic", "aicc"]),
    default="bic",
    show_default=True,
    help="Chooses the number of resonances.",
)
@click.option(
    "--band", nargs=2, type=float, metavar="LO HI", help="Only the lines between these frequencies [Hz]."
)
@click.option("--gain", "is_gain_free", is_flag=True, help="Fit a gain besides the base too.")
@click.option("--lag", "is_lag_free", is_flag=True, help="Fit a lag of the sensor, 1/(1 + T s).")
@click.option("--signed-lag", "is_lag_signed", is_flag=True, help="The same, and it may be negative, a lead.")
@click.option("--delay", "is_delay_free", is_flag=True, help="Fit a dead time, exp(-T s), T not negative.")
@click.option("--slope", type=click.IntRange(-6, 6), help="Without --base: the power of s; chosen if absent.")
@click.option(
    "--averages", type=click.FloatRange(1), help="Independent averages, where the file does not say."
)
@click.option(
    "--window",
    type=click.Choice(["hann", "none"]),
    help="Time window of the estimate, if the file does not say.",
)
@click.option(
    "--driving",
    metavar="OUT/IN",
    help="The response at the driven point: it is fitted, and all give mass-normalised mode shapes.",
)
@click.option("-o", "--output", type=click.Path(), help="Specification to write.")
@click.option("--plot", "figure", type=click.Path(), help="Figure to write: .pdf, .svg or .png.")
@click.option("--strict", is_flag=True, help="A fit that is poor is exit code 4, and nothing is written.")
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
@budgeted
@reporting
def command(
    data: tuple[str, ...],
    *,
    base: str | None,
    allow_outside: tuple[str, ...],
    tfs: tuple[str, ...],
    modes: int | None,
    start: str,
    criterion: str,
    band: tuple[float, float] | None,
    is_gain_free: bool,
    is_lag_free: bool,
    is_lag_signed: bool,
    is_delay_free: bool,
    slope: int | None,
    averages: float | None,
    window: str | None,
    driving: str | None,
    output: str | None,
    figure: str | None,
    strict: bool,
    as_json: bool,
) -> int:
    """Fit resonances to the frequency responses in DATA: .csv, .uff, .mat or .npz.

    On top of the transfer function --base SPEC --tf OUT/IN, or of a gain and a power of s, each resonance
    adds a pair of poles and a pair of zeros. Several responses are fitted together and share their poles.
    -o writes a specification with resonance blocks, which derive, roots, plot and export take like any other.

    The report has standard errors, and says where the measured phase parts from that of a minimum-phase
    fit to the magnitude alone. A fit that does not describe the data within their noise, or does not
    determine a resonance, says at its head that it is poor. Exit code 3 says that the data are invalid, 4
    that no fit came of them, or with --strict a poor one.
    """
    from symflex import pipeline
    from symflex.data.fitting import mode_shapes
    from symflex.data.fitting.text import fit_json, fit_text
    from symflex.data.measurement import prepared, read_measurement
    from symflex.files.write import write_atomically

    if tfs and base is None:
        raise UsageError(Diagnostic("SF902", "--tf names a transfer function of --base"))
    if base is not None and slope is not None:
        raise UsageError(Diagnostic("SF902", "--slope is for fits without --base"))
    for name, endings in ((output, (".toml",)), (figure, SUFFIXES)):
        if name:
            check_place(name, endings)
    if base is not None:
        load(base, allow_outside)
    every = prepared([one for path in data for one in read_measurement(path)], band, averages, window)
    measured = every
    if driving:
        measured = tuple(response for response in every if response.name == driving)
        if len(measured) != 1:
            hint = "responses: " + ", ".join(response.name for response in every)
            raise UsageError(
                Diagnostic("SF902", f"no single response is called '{driving[:64]}'", None, hint)
            )
        if base is not None:
            raise UsageError(Diagnostic("SF902", "--driving is for fits without --base"))
    found = pipeline.fit(
        measured,
        base,
        tfs,
        modes=modes,
        start=start,
        criterion=criterion,
        is_gain_free=is_gain_free,
        is_lag_free=is_lag_free or is_lag_signed,
        is_lag_signed=is_lag_signed,
        is_delay_free=is_delay_free,
        slope=slope,
        allow_outside=allow_outside,
    )
    shapes = mode_shapes(found, every) if driving else None
    if strict and found.poor:
        hint = "without --strict it is printed all the same"
        raise FitError(Diagnostic("SF618", f"the fit is poor: {found.poor[0]}", None, hint))
    if output:
        text = pipeline.fit_specification(found, Path(output).parent)
        write_atomically(Path(output), text.encode())
        note(f"wrote {output}")
        try:
            pipeline.loads(text, output)
        except SymflexError:
            folders = " ".join(f"--allow-outside {folder}" for folder in allow_outside)
            note(f"its base reads other folders: give {folders} where it is read")
    if as_json:
        emit_json(fit_json(found, shapes))
    else:
        say(fit_text(found, terminal_width(), shapes))
    if figure:
        from symflex.figures import draw_fit, save

        for r in range(len(measured)):
            place = Path(figure)
            one = place if r == 0 else place.with_stem(f"{place.stem}_{r + 1}")
            save(draw_fit(found, r), one)
            note(f"wrote {one}")
    return 0
