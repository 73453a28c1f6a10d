"""Running a sweep: chunks of points go to this process, to others or to a cluster, in any order.

Input: a model and ``--over k=1:5:lin:9 --modes 3``.
Output: ``Task(model, ("X", "F"), "poles", ("k",), Modes(3))`` and a design of 9 points,
solved; and the file it goes to.
"""

from __future__ import annotations

import os
import pickle
import signal
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
from hashlib import sha256
from multiprocessing import active_children, connection, get_context, parent_process
from pathlib import Path
from threading import Thread
from time import monotonic

import numpy as np

from symflex.budget import Silent
from symflex.errors import BudgetError, Diagnostic, UsageError, refused
from symflex.errors.optional import installed
from symflex.files.lock import held
from symflex.files.write import write_atomically
from symflex.loops import pick_gain
from symflex.model import Model, with_numbers
from symflex.model.loss_factors import check_causal
from symflex.options import FREQUENCIES, RootsOptions, SweepOptions, band_ends
from symflex.roots import Progress, Region
from symflex.roots.region import region_of
from symflex.sweep.design import (
    Array,
    Design,
    Point,
    Rows,
    Task,
    check_design,
    design_of,
    fingerprint,
    points_between,
    read_design,
    written,
)
from symflex.sweep.files import FolderJournal, check_writable, open_journal, sweep_bytes
from symflex.sweep.follow import Between, Complexes
from symflex.sweep.labelled import Sweep, assembled
from symflex.sweep.points import PointStatus, logarithmic, solve_chunk
from symflex.transfer.of_model import is_large_network, pick_pairs

CONNECT_SECONDS = 10


@contextmanager
def open_executor(
    workers: int | None = None, scheduler: str | None = None
) -> Iterator[tuple[Executor | None, int]]:
    """Open an executor, and close it in the end; with it goes how many chunks are solved at a time.

    ``None`` is this process. ``workers`` are processes on this computer, by default as many as it has
    processors; one needs no process of its own. ``scheduler`` is the address of a ``dask.distributed`` one,
    such as ``tcp://10.0.0.1:8786``; symflex must be installed where its workers are.
    """
    if scheduler is not None:
        with _cluster(scheduler) as opened:
            yield opened
        return
    count = workers or os.cpu_count() or 1
    if count == 1:
        yield None, 1
        return
    with open_pool(count) as pool:
        yield pool, count


@contextmanager
def open_pool(count: int) -> Iterator[ProcessPoolExecutor]:
    """Open processes on this computer, and end them with the block: at once where an exception leaves it."""
    others = set(active_children())
    # A new interpreter in each process: what this one has open or threaded is not copied.
    pool = ProcessPoolExecutor(count, mp_context=get_context("spawn"), initializer=_begin_work)
    try:
        with _uninterrupted():
            for _ in range(count):
                pool.submit(int)  # which starts a process
        yield pool
    except BaseException:
        for worker in set(active_children()) - others:
            worker.kill()
        pool.shutdown(wait=False, cancel_futures=True)
        raise
    pool.shutdown(cancel_futures=True)


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Put off Ctrl-C; processes that are started meanwhile put it off until they ignore it."""
    if not hasattr(signal, "pthread_sigmask"):  # as on Windows
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin_work() -> None:
    """Leave Ctrl-C, which a terminal sends to all processes, to the one that started this."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    end_with_parent()


def end_with_parent() -> None:
    """Let this worker end when the process that started it does, however that ended.

    A process that is killed closes no pool, and its workers would wait for work for ever.
    """
    parent = parent_process()
    if parent is not None:
        Thread(target=_exit_after, args=(parent.sentinel,), name="parent", daemon=True).start()


def _exit_after(sentinel: int) -> None:
    connection.wait([sentinel])
    # Not sys.exit: it would end this thread alone, and handlers at exit may wait for the parent.
    os._exit(1)


@contextmanager
def _cluster(address: str) -> Iterator[tuple[Executor, int]]:
    distributed = installed("distributed")
    # 'with' closes the client; its finalizer would wait in vain for one that a bad address left half made.
    client_class = type("Client", (distributed.Client,), {"__del__": lambda _: None})
    try:
        client = client_class(address, timeout=CONNECT_SECONDS, set_as_default=False)
    except (OSError, ValueError, TypeError, ImportError) as error:
        hint = "start one with: dask scheduler; and workers with: dask worker tcp://HOST:8786"
        said = "".join(c for c in str(error) if c.isprintable())[:100]
        message = f"no scheduler answers at '{address[:100]}': {said}"
        raise UsageError(Diagnostic("SF917", message, None, hint)) from None
    try:
        with client:
            executor = client.get_executor()
            try:
                yield executor, max(sum(client.nthreads().values()), 1)
            finally:
                executor.shutdown(wait=False)
    except distributed.KilledWorker as error:
        message = f"a worker stopped before it was done: {error}"
        hint = "use fewer workers, or more memory for each"
        raise BudgetError(Diagnostic("SF508", message, None, hint)) from None


CHUNKS = 200  # into about how many a sweep is cut
LARGEST_CHUNK = 1000
IN_A_ROW = 50  # points of which the first takes no more than all others, as a rule
AHEAD = 4  # chunks per worker that are handed out before any is back
MOST_BETWEEN = (40, 400)  # points solved between others, where names are in doubt: a tenth, within these
MINUTE = 60.0
HOUR = 3600.0


def chunk_size(count: int, together: int = 1) -> int:
    """Return how many points a worker solves at a time, and the most that a kill loses per worker.

    So many points stay ``together``, if there are as many.

    >>> [chunk_size(count) for count in (7, 10_000, 1_000_000)], chunk_size(70, 25)
    ([1, 50, 1000], 25)
    """
    return min(max(count // CHUNKS, min(count, together)), LARGEST_CHUNK)


def points_together(task: Task) -> int:
    """Return how many points a worker solves in a row at least: roots of waves go from one to the next."""
    has_waves = task.of in ("poles", "zeros") and task.model.is_distributed
    return IN_A_ROW if has_waves and not is_large_network(task.model) else 1


def sweep_key(task: Task, design: Design, version: str) -> str:
    """Return what tells a sweep from every other: a hash of the model, the design and the version."""
    digest = sha256(f"{version}\n{CHUNKS} {IN_A_ROW}\n{fingerprint(task)}\n{design.shape}\n".encode())
    for point in design.points:
        digest.update(";".join(map(written, point)).encode())
    return digest.hexdigest()


def run_sweep(
    task: Task,
    design: Design,
    executor: Executor | None = None,
    *,
    workers: int = 1,
    journal: FolderJournal | None = None,
    progress: Progress | None = None,
    attributes: Mapping[str, str] | None = None,
    clock: Callable[[], float] = monotonic,
) -> Sweep:
    """Solve all points of a design: the same bytes, whatever the executor, the workers and the journal.

    Chunks are solved by ``workers`` at a time in processes or on a cluster, in this process without an
    executor. What the journal holds already is not solved again. ``progress`` is told how many points are
    done and how long the rest will take, by the ``clock`` [s]; ``attributes`` are kept with the result.
    """
    size = chunk_size(design.count, points_together(task))
    chunks = range(-(-design.count // size))
    kept = {} if journal is None else {chunk: journal.read(chunk) for chunk in chunks}
    done: dict[int, Rows] = {chunk: rows for chunk, rows in kept.items() if rows is not None}
    missing = [chunk for chunk in chunks if chunk not in done]
    before = sum(len(rows["point_status"]) for rows in done.values())
    ended, start, heard = before, clock(), progress or Silent()
    pickled = pickle.dumps(task)
    solved = _solved(pickled, design, size, missing, executor, AHEAD * max(workers, 1))
    try:
        for chunk, rows in solved:
            done[chunk] = rows
            if journal is not None:
                journal.write(chunk, rows)
            ended += len(rows["point_status"])
            left = time_left((clock() - start) / (ended - before) * (design.count - ended))
            heard.report(ended / design.count, f"{ended} of {design.count} points, {left} left")
    except BrokenExecutor as error:
        hint = "there may be too little memory; with -o, the same command continues where this one stopped"
        message = f"a worker stopped before it was done: {error}"
        raise BudgetError(Diagnostic("SF508", message, None, hint)) from None
    rows = {name: _stacked([done[i][name] for i in chunks]) for name in done[0]}
    return assembled(task, design, rows, attributes or {}, _between(pickled, design))


def _solved(
    pickled: bytes,
    design: Design,
    size: int,
    missing: Sequence[int],
    executor: Executor | None,
    ahead: int,
) -> Iterator[tuple[int, Rows]]:
    """Yield chunks of a size as they are solved."""

    def points(chunk: int) -> Sequence[Point]:
        return design.points[chunk * size : (chunk + 1) * size]

    if executor is None:
        for chunk in missing:
            yield chunk, solve_chunk(pickled, points(chunk))
        return
    queue = iter(missing)
    running: dict[Future[Rows], int] = {}
    while True:
        for chunk in queue:
            running[executor.submit(solve_chunk, pickled, points(chunk))] = chunk
            if len(running) >= ahead:
                break
        if not running:
            return
        finished, _ = wait(running, return_when=FIRST_COMPLETED)
        for future in finished:
            yield running.pop(future), future.result()


def _between(pickled: bytes, design: Design) -> Between:
    """Return what solves points between two of a design, in this process, until there were many."""
    left = max(MOST_BETWEEN[0], min(design.count // 10, MOST_BETWEEN[1]))

    def solve(start: int, end: int, pieces: int) -> list[Complexes] | None:
        nonlocal left
        places = points_between(design.points[start], design.points[end], pieces)
        if places is None or left < len(places):
            return None
        left -= len(places)
        rows = solve_chunk(pickled, places)
        if np.any(rows["point_status"] > PointStatus.EXCEPT_ACCUMULATION):
            return None
        every = rows["re"] + 1j * rows["im"]
        return [s[rows["status"][i] > 0] for i, s in enumerate(every)]

    return solve


def _stacked(arrays: Sequence[Array]) -> Array:
    """Return the arrays of all chunks as one; those with fewer roots are filled up."""
    if arrays[0].ndim == 1:
        return np.concatenate(arrays)
    width = max(array.shape[1] for array in arrays)
    empty = np.nan if arrays[0].dtype.kind == "f" else 0
    whole = np.full((sum(map(len, arrays)), width), empty, arrays[0].dtype)
    row = 0
    for array in arrays:
        whole[row : row + len(array), : array.shape[1]] = array
        row += len(array)
    return whole


def time_left(seconds: float) -> str:
    """Return a time in words.

    >>> time_left(7.2), time_left(190.0), time_left(7300.0)
    ('8 s', '3 min 10 s', '2 h 2 min')
    """
    whole = int(-(-seconds // 1))
    if whole < MINUTE:
        return f"{whole} s"
    if whole < HOUR:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {-(-(whole % 3600) // 60)} min"


def plan_sweep(model: Model, given: SweepOptions, frequencies: Sequence[float] = ()) -> tuple[Task, Design]:
    """Return what is asked for at every point, and the points."""
    pair = pick_pairs(model, [given.tf] if given.tf else [])[0]
    drawn = (given.draws or 0, given.seed)
    if isinstance(given.over, Mapping):
        design = design_of(model.parameters, given.over, *drawn)
    else:
        design = read_design(model.parameters, given.over, *drawn)
    if given.of != "response":
        check_causal(with_numbers(model, design.names), f"a sweep of {given.of}")
    region = None
    if given.of in ("poles", "zeros"):
        region = region_of(RootsOptions(modes=given.modes, band=None if given.modes else given.band))
    elif given.of == "response" and not len(frequencies):
        band = model.analysis.band if given.band is None else band_ends(given.band, above_zero=True)
        if band is None:
            raise refused("the specification has no [analysis] band", "give one with --band LO HI")
        frequencies = logarithmic(*band, given.count or FREQUENCIES)
    return sweep_task(model, pair, design, given.of, region, frequencies, given.gain or ""), design


def sweep_task(
    model: Model,
    pair: tuple[str, str],
    design: Design,
    of: str = "poles",
    region: Region | None = None,
    frequencies: Sequence[float] = (),
    gain: str = "",
) -> Task:
    """Return what is wanted at every point of a design; SF209 for a value with an impossible sign."""
    if of == "margins":
        pick_gain(model.parameters, gain)
    check_design(model, design)
    return Task(model, pair, of, design.names, region, tuple(map(float, frequencies)), gain)


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

    Chunks are kept in ``FILE.part`` until it is written. The rest is as in :func:`run_sweep`.
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
        swept = run_sweep(
            task, design, executor, workers=workers, journal=journal, progress=progress, attributes=said
        )
        write_atomically(path, sweep_bytes(swept, path.suffix))
        journal.remove()
    return swept
