"""``symflex sweep``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from symflex.cli.budgeting import budgeted
from symflex.cli.reporting import emit_json, load, note, outside, reporting, say, setting, terminal_width
from symflex.cli.roots import region_of
from symflex.errors import Diagnostic, UsageError

if TYPE_CHECKING:
    from symflex.model import Model

KINDS = ("poles", "zeros", "response", "margins")
FREQUENCIES = 200
FREQUENCIES_LIMIT = 100_000
WORKERS_LIMIT = 1024
BUDGET_CODE = "SF5"


@click.command("sweep")
@click.argument("spec", type=click.Path())
@outside
@click.option(
    "--over",
    "over",
    multiple=True,
    metavar="NAME=VALUES",
    help="k=1e4:1e6:log:200, k=1:5:lin:9, m=1,2,5; to draw from: k=1e4:1e6[:log], k=+-5%. Repeatable.",
)
@click.option("--monte-carlo", "draws", type=click.IntRange(1), metavar="N", help="Draw N points.")
@click.option("--seed", type=click.IntRange(0), default=1, show_default=True, help="Of the random numbers.")
@click.option("--of", type=click.Choice(KINDS), default="poles", show_default=True, help="What is computed.")
@click.option("--tf", metavar="OUT/IN", help="The transfer function; the first one by default.")
@click.option("--modes", type=click.IntRange(1), help="Only the N lowest modes.")
@click.option(
    "--band",
    nargs=2,
    metavar="LO HI",
    help='Roots, or a response, in a band of frequencies: 0.1 1000, "1 kHz".',
)
@click.option(
    "--count",
    type=click.IntRange(2, FREQUENCIES_LIMIT),
    help=f"Frequencies of a response.  [default: {FREQUENCIES}]",
)
@click.option("--gain", metavar="K", help="The gain that closes the loop, for margins.")
@click.option("-o", "--output", type=click.Path(), help="File to write: .nc, .npz, .csv or .parquet.")
@click.option("--fresh", is_flag=True, help="Discard what an earlier run kept in FILE.part.")
@click.option(
    "--workers", type=click.IntRange(1, WORKERS_LIMIT), help="Processes.  [default: one per processor]"
)
@click.option("--scheduler", metavar="tcp://HOST:PORT", help="Work on a dask.distributed cluster.")
@click.option("--json", "as_json", is_flag=True, help="Print a summary as JSON.")
@budgeted
@reporting
@setting
def command(
    spec: str,
    *,
    allow_outside: tuple[str, ...],
    settings: dict[str, str],
    over: tuple[str, ...],
    draws: int | None,
    seed: int,
    of: str,
    tf: str | None,
    modes: int | None,
    band: tuple[str, str] | None,
    count: int | None,
    gain: str | None,
    output: str | None,
    fresh: bool,
    workers: int | None,
    scheduler: str | None,
    as_json: bool,
) -> int:
    """Solve SPEC at many values of its parameters: poles, zeros, a response or stability margins.

    Several --over make a grid; ranges without a count are drawn from, N times, as a Latin hypercube. Every
    root is proved at every point, as by 'symflex roots', and given as the nearest double with a radius; modes
    keep their names along the sweep. The result does not depend on the number of workers.

    With -o, chunks that are done are kept in FILE.part until FILE is written: the same command goes on after
    a kill. 'symflex plot sweep FILE' draws a .nc or .npz.

    Exit code 4 says that something is not certified, 5 that a budget was exceeded.
    """
    from symflex import pipeline
    from symflex.cli.progress import ProgressBar
    from symflex.sweep import read_design
    from symflex.sweep.executors import open_executor
    from symflex.sweep.files import check_writable
    from symflex.sweep.text import sweep_json, sweep_text

    if workers and scheduler:
        raise UsageError(Diagnostic("SF902", "give only one of --workers and --scheduler"))
    if fresh and not output:
        raise UsageError(Diagnostic("SF902", "--fresh is for a file: give -o FILE"))
    if output:
        check_writable(Path(output))
    model = load(spec, allow_outside, settings)
    pairs = pipeline.pick_pairs(model, [tf] if tf else [])
    _check_options(of, modes, band, count, gain)
    design = read_design(model.parameters, over, draws or 0, seed)
    if doubled := [name for name in design.names if name in settings]:
        raise UsageError(Diagnostic("SF902", f"'{doubled[0]}' is swept and set"))
    task = pipeline.sweep_task(
        model,
        pairs[0],
        design,
        of,
        region_of(modes, None, band, None) if of in ("poles", "zeros") else None,
        _frequencies(model, band, count) if of == "response" else (),
        gain or "",
    )
    if tf is None and len(pairs) > 1 and of != "margins":
        others = ", ".join("/".join(pair) for pair in pairs[1:])
        note(f"sweeping {'/'.join(pairs[0])}; choose with --tf: {others}")
    with ProgressBar() as bar, open_executor(workers, scheduler) as (executor, size):
        found = pipeline.sweep(task, design, output, executor, workers=size, is_fresh=fresh, progress=bar)
    if output:
        note(f"wrote {Path(output)}")
    if as_json:
        emit_json(sweep_json(found))
    else:
        say(sweep_text(found, terminal_width()))
    if found.is_certified:
        return 0
    return 5 if any(code.startswith(BUDGET_CODE) for code in found["code"].reshape(-1).tolist()) else 4


def _check_options(
    of: str, modes: int | None, band: tuple[str, str] | None, count: int | None, gain: str | None
) -> None:
    """Refuse options that say nothing for what is computed, or contradict each other."""
    if of != "response" and count is not None:
        raise UsageError(Diagnostic("SF902", "--count is for --of response"))
    if of not in ("poles", "zeros") and modes is not None:
        raise UsageError(Diagnostic("SF902", "--modes is for --of poles and --of zeros"))
    if modes is not None and band is not None:
        raise UsageError(Diagnostic("SF902", "give only one of --modes and --band"))
    if of == "margins" and not gain:
        raise UsageError(Diagnostic("SF902", "margins are those of a loop", None, "name its gain: --gain K"))
    if of != "margins" and gain:
        raise UsageError(Diagnostic("SF902", "--gain is for --of margins"))


def _frequencies(model: Model, band: tuple[str, str] | None, count: int | None) -> list[float]:
    """Return frequencies [Hz] that are equally spaced in their logarithm."""
    from symflex.cli.roots import band_limits
    from symflex.sweep.points import logarithmic

    if band is not None:
        low, high = band_limits(band, above_zero=True)
    elif model.analysis.band is not None:
        low, high = model.analysis.band
    else:
        hint = "give one with --band LO HI"
        raise UsageError(Diagnostic("SF902", "the specification has no [analysis] band", None, hint))
    return logarithmic(low, high, count or FREQUENCIES)
