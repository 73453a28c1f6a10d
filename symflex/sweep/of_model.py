"""A sweep of a model as it is asked for: its task and its design, and the file it goes to.

Input: a model and ``--over k=1:5:lin:9 --modes 3``.
Output: ``Task(model, ("X", "F"), "poles", ("k",), derive_all, Modes(3))`` and a design of 9 points, solved.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from symflex.errors import Diagnostic, UsageError
from symflex.files.lock import held
from symflex.files.write import write_atomically
from symflex.loops import pick_gain
from symflex.options import FREQUENCIES, RootsOptions, SweepOptions, band_ends
from symflex.roots.region import region_of
from symflex.sweep.design import Design, Task, check_design, design_of, read_design
from symflex.sweep.files import check_writable, open_journal, sweep_bytes
from symflex.sweep.points import logarithmic
from symflex.sweep.run import run_sweep, sweep_key
from symflex.transfer.of_model import derive_all, pick_pairs

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from symflex.model import Model
    from symflex.roots import Progress, Region
    from symflex.sweep.sweep import Sweep


def plan_sweep(model: Model, given: SweepOptions, frequencies: Sequence[float] = ()) -> tuple[Task, Design]:
    """Return what is asked for at every point, and the points.

    Frequencies of a response [Hz] are by default equally spaced in their logarithm. SF902 what cannot be
    swept, read or meant; SF507 too many points.
    """
    pair = pick_pairs(model, [given.tf] if given.tf else [])[0]
    if isinstance(given.over, Mapping):
        design = design_of(model.parameters, given.over, given.draws or 0, given.seed)
    else:
        design = read_design(model.parameters, given.over, given.draws or 0, given.seed)
    region = None
    if given.of in ("poles", "zeros"):
        region = region_of(RootsOptions(modes=given.modes, band=None if given.modes else given.band))
    elif given.of == "response" and not len(frequencies):
        frequencies = _logarithmic(model, given)
    return sweep_task(model, pair, design, given.of, region, frequencies, given.gain or ""), design


def _logarithmic(model: Model, given: SweepOptions) -> list[float]:
    """Return frequencies [Hz] that are equally spaced in their logarithm."""
    band = model.analysis.band if given.band is None else band_ends(given.band, above_zero=True)
    if band is None:
        hint = "give one with --band LO HI"
        raise UsageError(Diagnostic("SF902", "the specification has no [analysis] band", None, hint))
    return logarithmic(*band, given.count or FREQUENCIES)


def sweep_task(
    model: Model,
    pair: tuple[str, str],
    design: Design,
    of: str = "poles",
    region: Region | None = None,
    frequencies: Sequence[float] = (),
    gain: str = "",
) -> Task:
    """Return what is wanted at every point of a design; see :class:`symflex.sweep.Task`.

    SF902 when margins are wanted and there is no such gain; SF209 a value with which a length, stiffness or
    delay has a sign it cannot have.
    """
    if of == "margins":
        pick_gain(model.parameters, gain)
    check_design(model, design)
    return Task(model, pair, of, design.names, derive_all, region, tuple(map(float, frequencies)), gain)


def sweep(
    task: Task,
    design: Design,
    given: SweepOptions,
    executor: Executor | None = None,
    *,
    workers: int = 1,
    progress: Progress | None = None,
) -> Sweep:
    """Solve all points of a design; with an output, write it, and go on where a killed sweep stopped.

    The ``output`` of the options is a .nc, .npz, .csv or .parquet; chunks are kept in ``FILE.part`` until it
    is written. With ``fresh``, what an earlier run kept is discarded. The rest is as in
    :func:`symflex.sweep.run_sweep`.
    """
    # The package imports api, which stands above: its version is read without importing it.
    version = str(vars(sys.modules["symflex"])["__version__"])
    key = sweep_key(task, design, version)
    said = {"title": task.model.title, "key": key, "version": version}
    if given.output is None:
        return run_sweep(task, design, executor, workers=workers, progress=progress, attributes=said)
    path = Path(given.output)
    check_writable(path)
    with held(path):
        journal = open_journal(path, key, is_fresh=given.fresh)
        found = run_sweep(
            task, design, executor, workers=workers, journal=journal, progress=progress, attributes=said
        )
        write_atomically(path, sweep_bytes(found, path.suffix))
        journal.remove()
    return found
