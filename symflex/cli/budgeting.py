"""The budget on the command line: ``--budget`` and ``--memory``, and a process that sees that they are kept.

Loops ask their budget and stop in order, with what was certified until then. A single operation of a library
cannot be asked, and the library ends the process where memory is refused. So on Linux a command works in a
process of its own, and the one that was started watches it: it passes signals on, ends the other one where
that is over its limits and does not stop, and says so.
"""

from __future__ import annotations

import os
import re
import signal
import sys
from collections.abc import Callable
from contextlib import nullcontext
from functools import wraps
from math import inf
from time import monotonic
from typing import IO, Final

import click

from symflex.budget import GB, TIME_OVER, Budget, memory_held, memory_used_up
from symflex.cli import BUDGET_EXCEEDED, WATCHED
from symflex.cli.progress import Waiting
from symflex.cli.reporting import show_error
from symflex.errors import BudgetError, Diagnostic

MEMORY: Final = "2 GB"
MEMORY_VARIABLE: Final = "SYMFLEX_MEMORY"
SMALLEST_MEMORY: Final = GB // 4  # Python and the libraries of a fit take 150 MB
IN_ORDER: Final = 0.85
"""Part of the memory from which loops stop in order: the rest is for single operations and for printing."""
GRACE: Final = 0.85  # seconds after its time in which a command may stop in order
INTERVAL: Final = 0.05  # seconds between two looks; a process can take 100 MB in between
FINISHED: Final = getattr(signal, "SIGUSR1", signal.SIGTERM)
"""Sent by the process that works when it has written everything; not every system has it."""
STDERR: Final = 2
LONGEST_WORDS: Final = 200  # letters of a library's last words that are passed on
UNITS: Final = {"MB": 10**6, "GB": GB, "TB": 10**12, "MIB": 2**20, "GIB": 2**30, "TIB": 2**40}
SIZE: Final = re.compile(r"\s*(\d{1,9}(?:\.\d{1,9})?)\s*([MGT]i?B)\s*", re.ASCII | re.IGNORECASE)


class Seconds(click.ParamType):  # type: ignore[type-arg]  # generic from click 8.4 on
    """A positive, finite time; a not-a-number compares with nothing, and would be no limit."""

    name = "seconds"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Return the time [s]."""
        try:
            seconds = float(str(value))
        except ValueError:
            seconds = 0.0
        if not 0 < seconds < inf:
            self.fail(f"'{str(value)[:40]}' is not a positive number of seconds", param, ctx)
        return seconds


class Memory(click.ParamType):  # type: ignore[type-arg]
    """An amount of memory such as 500 MB or 4GB."""

    name = "memory"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> int:
        """Return bytes."""
        match = SIZE.fullmatch(str(value))
        size = min(int(float(match[1]) * UNITS[match[2].upper()]), sys.maxsize) if match else 0
        if size < SMALLEST_MEMORY:
            message = f"'{str(value)[:40]}' is not an amount of memory such as '4 GB', of 250 MB or more"
            self.fail(message, param, ctx)
        return size


def budgeted(command: Callable[..., int]) -> Callable[..., int]:
    """Give a command the options ``--budget`` and ``--memory``, and see that they are kept."""

    @wraps(command)
    def run(*args: object, budget: float | None, memory: int, **kwargs: object) -> int:
        is_program = click.get_current_context().find_root().obj is WATCHED
        # Called from Python, a command does not answer for what its caller holds.
        held = 0 if is_program else memory_held()
        entered = Budget(budget, memory=held + int(IN_ORDER * memory))
        is_watched = is_program and sys.platform == "linux"
        if is_watched:
            code = _watched(budget, memory)
            if code is not None:
                return code
        waiting = Waiting(str(click.get_current_context().info_name)) if is_program else nullcontext()
        with waiting, entered.entered():
            code = command(*args, **kwargs)
        if is_watched:
            os.kill(os.getppid(), FINISHED)
        return code

    memory = click.option(
        "--memory",
        type=Memory(),
        default=MEMORY,
        envvar=MEMORY_VARIABLE,
        show_default=True,
        metavar="SIZE",
        help="Stop when the computation needs more memory than this.",
    )
    time = click.option(
        "--budget",
        type=Seconds(),
        metavar="SECONDS",
        help="Stop with an error after this time; roots, sweep -o, fit and charts keep what they found.",
    )
    return time(memory(run))


def _watched(seconds: float | None, memory: int) -> int | None:
    """Fork; return ``None`` in the process that is to work, and in the one that watches its exit code."""
    end = None if seconds is None else monotonic() + seconds + GRACE
    sys.stdout.flush()
    sys.stderr.flush()
    passed_on = {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}
    heard = {signal.SIGCHLD, FINISHED, *passed_on}
    before = signal.pthread_sigmask(signal.SIG_BLOCK, heard)
    alive, kept_open = os.pipe()
    watching = os.getpid()
    said = open(os.memfd_create("said"), "w+b")
    worker = os.fork()
    if worker == 0:
        os.close(kept_open)
        _end_with(alive)
        if os.getppid() != watching:
            os._exit(BUDGET_EXCEEDED)  # it ended before this could be told
        _limit_memory(memory)
        _keep(said)
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        return None
    os.close(alive)
    while True:
        what = signal.sigtimedwait(heard, INTERVAL)
        # The terminal sends to both; what is sent to this process alone is passed on.
        if what is not None and what.si_signo in passed_on and what.si_pid:
            os.kill(worker, what.si_signo)
        if what is not None and what.si_signo == FINISHED:
            end = None  # all is written, and only taken apart
        done, status = os.waitpid(worker, os.WNOHANG)
        if done:
            return _code_of(status, memory, said)
        over = TIME_OVER if end is not None and monotonic() > end else None
        if memory_held(worker) > memory:
            over = memory_used_up(memory)
        if over is not None:
            os.kill(worker, signal.SIGKILL)
            os.waitpid(worker, 0)
            show_error(BudgetError(over))
            return BUDGET_EXCEEDED


def _keep(said: IO[bytes]) -> None:
    """Take up in a file what libraries in C write to stderr of their own accord; Python's stays."""
    try:
        is_plain = sys.stderr.fileno() == STDERR
    except (OSError, ValueError):
        is_plain = False
    if is_plain:
        sys.stderr = open(os.dup(STDERR), "w", 1, sys.stderr.encoding, sys.stderr.errors)
        os.dup2(said.fileno(), STDERR)


def _code_of(status: int, memory: int, said: IO[bytes]) -> int:
    """Return the exit code of the process that worked, and say what ended it if it did not end by itself."""
    code = os.waitstatus_to_exitcode(status)
    if code >= 0:
        return code
    name = signal.Signals(-code)
    said.seek(0)
    last = " ".join(said.read().decode(errors="replace").split())[-LONGEST_WORDS:]
    if name is signal.SIGKILL or (name is signal.SIGABRT and (not last or "alloc" in last)):
        # Libraries abort where memory is refused; a system that has none left kills.
        show_error(BudgetError(memory_used_up(memory)))
        return BUDGET_EXCEEDED
    if name in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        return 128 - code
    message = f"a library crashed: {last or signal.strsignal(-code)}"
    show_error(BudgetError(Diagnostic("SF508", message, None, "please report this with the model")))
    return BUDGET_EXCEEDED


def _end_with(alive: int) -> None:
    """Let this process be ended when the other end of a pipe is closed, by whatever ended who held it."""
    import fcntl  # not on every system

    fcntl.fcntl(alive, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(alive, fcntl.F_SETFL, fcntl.fcntl(alive, fcntl.F_GETFL) | os.O_ASYNC)


def _limit_memory(memory: int) -> None:
    """Have the system refuse more memory to this process and those it starts, and write no image of them."""
    import resource  # not on every system

    def lowered(which: int, limit: int) -> None:
        soft, hard = resource.getrlimit(which)
        allowed = limit if soft == resource.RLIM_INFINITY else min(limit, soft)
        resource.setrlimit(which, (allowed, hard))

    lowered(resource.RLIMIT_DATA, memory)
    lowered(resource.RLIMIT_CORE, 0)
