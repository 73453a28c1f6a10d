"""Running a sweep: chunks of points go to this process, to others or to a cluster, in any order."""

from __future__ import annotations

import os
import pickle
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
from hashlib import sha256
from multiprocessing import connection, get_context, parent_process
from threading import Thread
from time import monotonic
from typing import TYPE_CHECKING, Protocol

import numpy as np

from symflex.budget import Silent
from symflex.errors import BudgetError, Diagnostic, UsageError
from symflex.sweep.design import Array, Design, Point, Rows, Task, fingerprint, points_between, written
from symflex.sweep.points import PointStatus, solve_chunk
from symflex.sweep.sweep import Sweep, assembled, extra

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from symflex.roots import Progress
    from symflex.sweep.follow import Between, Complexes


CONNECT_SECONDS = 10


@contextmanager
def open_executor(
    workers: int | None = None, scheduler: str | None = None
) -> Iterator[tuple[Executor | None, int]]:
    """Open an executor, and close it in the end; with it goes how many chunks are solved at a time.

    ``None`` is this process. ``workers`` are processes on this computer, by default as many as it has
    processors; one needs no process of its own. ``scheduler`` is the address of a ``dask.distributed`` one,
    such as ``tcp://10.0.0.1:8786``; symflex must be installed where its workers are. SF914 dask.distributed
    is not installed; SF917 no scheduler answers; SF508 workers of a cluster died.
    """
    if scheduler is not None:
        with _cluster(scheduler) as opened:
            yield opened
        return
    count = workers or os.cpu_count() or 1
    if count == 1:
        yield None, 1
        return
    pool = ProcessPoolExecutor(count, mp_context=get_context("spawn"), initializer=end_with_parent)
    try:
        yield pool, count
    finally:
        pool.shutdown(cancel_futures=True)


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
    distributed = extra("distributed", "a cluster")
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
        message = f"a worker ended before its work: {error}"
        raise BudgetError(
            Diagnostic("SF508", message, None, "take fewer workers, or more memory each")
        ) from None


CHUNKS = 200
"""Into about how many a sweep is cut."""
LARGEST_CHUNK = 1000
AHEAD = 4
"""Chunks per worker that are handed out before any is back."""
MOST_BETWEEN = (40, 400)
"""Points solved between others, where names are in doubt: a tenth of all, at least and at most these."""
MINUTE = 60.0
HOUR = 3600.0


class Journal(Protocol):
    """Keeps the chunks that are done."""

    def read(self, chunk: int) -> Rows | None:
        """Return a chunk that was kept, ``None`` where it was not."""
        ...

    def write(self, chunk: int, rows: Rows) -> None:
        """Keep a chunk."""
        ...


def chunk_size(count: int) -> int:
    """Return how many points a worker solves at a time, and the most that a kill loses per worker.

    Examples
    --------
    >>> [chunk_size(count) for count in (7, 10_000, 1_000_000)]
    [1, 50, 1000]
    """
    return min(max(count // CHUNKS, 1), LARGEST_CHUNK)


def sweep_key(task: Task, design: Design, version: str) -> str:
    """Return what tells a sweep from every other: a hash of the model, the design and the version."""
    digest = sha256(f"{version}\n{CHUNKS}\n{fingerprint(task)}\n{design.shape}\n".encode())
    for point in design.points:
        digest.update(";".join(map(written, point)).encode())
    return digest.hexdigest()


def run_sweep(
    task: Task,
    design: Design,
    executor: Executor | None = None,
    *,
    workers: int = 1,
    journal: Journal | None = None,
    progress: Progress | None = None,
    attributes: Mapping[str, str] | None = None,
    clock: Callable[[], float] = monotonic,
) -> Sweep:
    """Solve all points of a design: the same bytes, whatever the executor, the workers and the journal.

    Chunks are solved by ``workers`` at a time in processes or on a cluster, in this process without an
    executor. What the journal holds already is not solved again. ``progress`` is told how many points are
    done and how long the rest will take, by the ``clock`` [s]; ``attributes`` are kept with the result. SF508
    when workers end before their work.
    """
    size = chunk_size(design.count)
    chunks = range(-(-design.count // size))
    done: dict[int, Rows] = {}
    missing = []
    for chunk in chunks:
        rows = None if journal is None else journal.read(chunk)
        if rows is None:
            missing.append(chunk)
        else:
            done[chunk] = rows
    shown = _Shown(
        progress or Silent(), design.count, sum(len(rows["point_status"]) for rows in done.values()), clock
    )
    pickled = pickle.dumps(task)
    solved = _solved(pickled, design, missing, executor, AHEAD * max(workers, 1))
    try:
        for chunk, rows in solved:
            done[chunk] = rows
            if journal is not None:
                journal.write(chunk, rows)
            shown.add(len(rows["point_status"]))
    except BrokenExecutor as error:
        hint = "there may be too little memory; with -o, the same command goes on where this one stopped"
        message = f"a worker ended before its work: {error}"
        raise BudgetError(Diagnostic("SF508", message, None, hint)) from None
    rows = _joined([done[i] for i in chunks])
    return assembled(task, design, rows, attributes or {}, _between(pickled, design))


def _solved(
    pickled: bytes, design: Design, missing: Sequence[int], executor: Executor | None, ahead: int
) -> Iterator[tuple[int, Rows]]:
    """Yield chunks as they are solved."""
    size = chunk_size(design.count)

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


def _joined(chunks: Sequence[Rows]) -> Rows:
    """Return the rows of all chunks; those with fewer roots are filled up."""
    return {name: _stacked([chunk[name] for chunk in chunks]) for name in chunks[0]}


def _stacked(arrays: Sequence[Array]) -> Array:
    if arrays[0].ndim == 1:
        return np.concatenate(arrays)
    width = max(array.shape[1] for array in arrays)
    empty = np.nan if arrays[0].dtype.kind == "f" else 0
    return np.concatenate(
        [np.pad(a, ((0, 0), (0, width - a.shape[1])), constant_values=empty) for a in arrays]
    )


class _Shown:
    """Says how many points are done and how long the others will take."""

    def __init__(self, progress: Progress, count: int, before: int, clock: Callable[[], float]) -> None:
        self._progress, self._count, self._before = progress, count, before
        self._done, self._clock, self._start = before, clock, clock()

    def add(self, points: int) -> None:
        """Count points that are done."""
        self._done += points
        rate = (self._clock() - self._start) / (self._done - self._before)
        left = time_left(rate * (self._count - self._done))
        self._progress.report(self._done / self._count, f"{self._done} of {self._count} points, {left} left")


def time_left(seconds: float) -> str:
    """Return a time in words.

    Examples
    --------
    >>> time_left(7.2), time_left(190.0), time_left(7300.0)
    ('8 s', '3 min 10 s', '2 h 2 min')
    """
    whole = int(-(-seconds // 1))
    if whole < MINUTE:
        return f"{whole} s"
    if whole < HOUR:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {-(-(whole % 3600) // 60)} min"
