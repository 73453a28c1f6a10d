"""``symflex measure``."""

from __future__ import annotations

from pathlib import Path

import click

from symflex.cli.budgeting import budgeted
from symflex.cli.reporting import check_place, load, note, outside, reporting, setting
from symflex.errors import Diagnostic, UsageError


@click.command("measure")
@click.argument("spec", type=click.Path())
@outside
@click.option("--tf", metavar="OUT/IN", help="The transfer function; the first one by default.")
@click.option("-o", "--output", type=click.Path(), required=True, help="File to write: .csv, .npz or .uff.")
@click.option(
    "--band", nargs=2, type=float, metavar="LO HI", help="Lines shown [Hz].  [default: [analysis] band]"
)
@click.option("--spacing", type=float, help="Distance of lines [Hz].  [default: HI/800]")
@click.option("--averages", type=click.IntRange(1), default=40, show_default=True, help="Records averaged.")
@click.option(
    "--noise",
    type=click.FloatRange(0),
    default=0.03,
    show_default=True,
    help="Sensor noise over its signal, rms.",
)
@click.option(
    "--rolloff",
    type=click.FloatRange(0),
    default=5000.0,
    show_default=True,
    help="Corner of the accelerometer [Hz]; 0 for none.",
)
@click.option("--seed", type=click.IntRange(0), default=1, show_default=True, help="Of the random numbers.")
@budgeted
@reporting
@setting
def command(
    spec: str,
    *,
    allow_outside: tuple[str, ...],
    settings: dict[str, str],
    tf: str | None,
    output: str,
    band: tuple[float, float] | None,
    spacing: float | None,
    averages: int,
    noise: float,
    rolloff: float,
    seed: int,
) -> int:
    """Write what an analyser would measure of a transfer function of SPEC: synthetic data, and labelled so.

    Band-limited noise drives the model; a sensor with noise of its own sees the response; overlapping
    records with a Hann window are averaged to an H1 estimate and its coherence. The same seed gives
    the same file.
    """
    from symflex import pipeline
    from symflex.data.measurement import WRITERS, MeasurementPlan, measurement_bytes
    from symflex.files.write import write_atomically

    check_place(output, WRITERS)
    model = load(spec, allow_outside, settings)
    pairs = pipeline.pick_pairs(model, [tf] if tf else [])
    if tf is None and len(pairs) > 1:
        others = ", ".join("/".join(pair) for pair in pairs[1:])
        note(f"measuring {'/'.join(pairs[0])}; choose with --tf: {others}")
    if band is None:
        if model.analysis.band is None:
            message = "the specification has no [analysis] band"
            raise UsageError(Diagnostic("SF902", message, None, "give one with --band LO HI"))
        band = (float(model.analysis.band[0]), float(model.analysis.band[1]))
    plan = MeasurementPlan(
        band[0],
        band[1],
        band[1] / 800 if spacing is None else spacing,
        averages,
        noise,
        rolloff or None,
        seed,
    )
    plan.check()
    measured = pipeline.measure(model, pairs[0], plan)
    write_atomically(Path(output), measurement_bytes(measured, output))
    note(f"wrote {output}: {measured.values.size} lines of SYNTHETIC data")
    return 0
