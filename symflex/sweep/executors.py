"""Where chunks are solved: in this process, in others on this computer, or on a cluster."""

from __future__ import annotations

import os
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from importlib import import_module
from multiprocessing import get_context, parent_process
from multiprocessing.connection import wait
from threading import Thread
from typing import TYPE_CHECKING, Any

from symflex.errors import BudgetError, Diagnostic, UsageError
from symflex.sweep.sweep import missing_library

if TYPE_CHECKING:
    from collections.abc import Iterator
    from concurrent.futures import Executor

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
    wait([sentinel])
    # Not sys.exit: it would end this thread alone, and handlers at exit may wait for the parent.
    os._exit(1)


@contextmanager
def _cluster(address: str) -> Iterator[tuple[Executor, int]]:
    try:
        distributed: Any = import_module("distributed")  # an extra; it has no types
    except ImportError:
        raise missing_library("distributed", "a cluster") from None
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
