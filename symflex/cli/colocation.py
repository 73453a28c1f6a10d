"""``symflex colocation``."""

from __future__ import annotations

import click

from symflex.cli.budgeting import budgeted
from symflex.cli.reporting import emit_json, load, outside, reporting, say, setting
from symflex.errors import Diagnostic, UsageError


@click.command("colocation")
@click.argument("spec", type=click.Path())
@outside
@click.option("--tf", required=True, metavar="OUT/IN", help="The output that is away from the actuator.")
@click.option("--with", "reference", required=True, metavar="OUT2/IN", help="The colocated output.")
@click.option("--phase", default="10 deg", show_default=True, help="Largest difference of phase.")
@click.option("--magnitude", default="1 dB", show_default=True, help="Largest difference of magnitude.")
@click.option(
    "--band", nargs=2, metavar="LO HI", help="Frequencies examined; by default those of [analysis]."
)
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
@budgeted
@reporting
@setting
def command(
    spec: str,
    *,
    allow_outside: tuple[str, ...],
    settings: dict[str, str],
    tf: str,
    reference: str,
    phase: str,
    magnitude: str,
    band: tuple[str, str] | None,
    as_json: bool,
) -> int:
    """Print up to which frequency an output of SPEC moves with a colocated one.

    Within this band they are dynamically colocated, although flexible parts lie between them. It ends where
    the ratio of the two first leaves the tolerances; that it does not before is proved. Exit code 4 says that
    the end could not be told.
    """
    from symflex import pipeline
    from symflex.cli.roots import band_limits

    limits = None
    if band is not None:
        low, high = band_limits(band, above_zero=True)
        limits = (float(low), float(high))
    found = pipeline.colocation(
        load(spec, allow_outside, settings),
        tf,
        reference,
        _tolerance(phase, "--phase", ("deg", "°"), "10 deg"),
        _tolerance(magnitude, "--magnitude", ("dB",), "1 dB"),
        limits,
    )
    if as_json:
        emit_json(found.to_json_dict())
    else:
        say(str(found))
    return 0 if found.is_decided else 4


def _tolerance(text: str, option: str, units: tuple[str, ...], example: str) -> float:
    from symflex.cli.roots import plain_number

    value = plain_number(text, units)
    if not 0 < value < float("inf"):
        message = f"{option} takes a positive number such as '{example}', found '{text[:40]}'"
        raise UsageError(Diagnostic("SF902", message))
    return value
