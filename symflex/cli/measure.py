"""``symflex measure``."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from symflex.cli.command import Specification, command_of, first_pair
from symflex.cli.reporting import check_place, note
from symflex.options import MeasureOptions


@command_of("measure", MeasureOptions)
def command(spec: Specification, given: MeasureOptions) -> int:
    """Write what an analyser would measure of a transfer function of SPEC: synthetic data, and labelled so.

    Band-limited noise drives the model; a sensor with noise of its own sees the response; overlapping
    records with a Hann window are averaged to an H1 estimate and its coherence. The same seed gives
    the same file.
    """
    from symflex import pipeline
    from symflex.data.measurement import WRITERS, measurement_bytes
    from symflex.files.write import write_atomically

    check_place(given.output, WRITERS)
    model = spec.load()
    tf = "/".join(first_pair(model, given.tf, "measuring"))
    measured = pipeline.measure(model, replace(given, tf=tf, rolloff=given.rolloff or None))
    write_atomically(Path(given.output), measurement_bytes(measured, given.output))
    note(f"wrote {given.output}: {measured.values.size} lines of SYNTHETIC data")
    return 0
