"""``symflex sweep``."""

from __future__ import annotations

from pathlib import Path

from symflex.cli.command import Specification, command_of, first_pair
from symflex.cli.reporting import emit_json, note, say, terminal_width
from symflex.errors import Diagnostic, UsageError
from symflex.options import SweepOptions

BUDGET_CODE = "SF5"


@command_of("sweep", SweepOptions)
def command(spec: Specification, given: SweepOptions) -> int:
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
    from symflex.sweep.files import check_writable
    from symflex.sweep.run import open_executor
    from symflex.sweep.text import sweep_json, sweep_text

    if given.workers and given.scheduler:
        raise UsageError(Diagnostic("SF902", "give only one of --workers and --scheduler"))
    if given.fresh and not given.output:
        raise UsageError(Diagnostic("SF902", "--fresh is for a file: give -o FILE"))
    if given.output:
        check_writable(Path(given.output))
    model = spec.load()
    _check(given)
    task, design = pipeline.plan_sweep(model, given)
    if doubled := [name for name in design.names if name in spec.settings]:
        raise UsageError(Diagnostic("SF902", f"'{doubled[0]}' is swept and set"))
    if given.of != "margins":
        first_pair(model, given.tf, "sweeping")
    with ProgressBar() as bar, open_executor(given.workers, given.scheduler) as (executor, size):
        found = pipeline.sweep(task, design, given, executor, workers=size, progress=bar)
    if given.output:
        note(f"wrote {Path(given.output)}")
    if given.as_json:
        emit_json(sweep_json(found))
    else:
        say(sweep_text(found, terminal_width()))
    if found.is_certified:
        return 0
    return 5 if any(code.startswith(BUDGET_CODE) for code in found["code"].reshape(-1).tolist()) else 4


def _check(given: SweepOptions) -> None:
    """Refuse options that say nothing for what is computed, or contradict each other."""
    if given.of != "response" and given.count is not None:
        raise UsageError(Diagnostic("SF902", "--count is for --of response"))
    if given.of not in ("poles", "zeros") and given.modes is not None:
        raise UsageError(Diagnostic("SF902", "--modes is for --of poles and --of zeros"))
    if given.modes is not None and given.band is not None:
        raise UsageError(Diagnostic("SF902", "give only one of --modes and --band"))
    if given.of == "margins" and not given.gain:
        raise UsageError(Diagnostic("SF902", "margins are those of a loop", None, "name its gain: --gain K"))
    if given.of != "margins" and given.gain:
        raise UsageError(Diagnostic("SF902", "--gain is for --of margins"))
