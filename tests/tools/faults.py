"""Faults injected into commands that write: ``python -m tests.tools.faults --count N [--seed S]``.

A command is killed at an instant or before one of its file operations, one of its operations fails, files
may not grow, its folder cannot be written, or it runs twice at once. Afterwards every file is as it was or as
it should be, nothing was a traceback, and the same command without a fault ends with the same bytes as if
nothing had happened.
"""

from __future__ import annotations

import argparse
import contextlib
import errno
import fcntl
import io
import os
import random
import resource
import shutil
import signal
import sys
import tempfile
import time
import traceback
from dataclasses import dataclass
from pathlib import Path

from symflex.cli import run

SPEC = """
symflex = 1
title = "Two masses"
parameters = { m = "1 kg", c = "0.4 N*s/m", k = "40 N/m" }
elements.b = { type = "mass", at = "x", m = "m" }
elements.a = { type = "mass", at = "y", m = "m" }
elements.d = { type = "damper", between = ["x", "ground"], b = "c" }
elements.k = { type = "spring", between = ["x", "ground"], k = "k" }
elements.e = { type = "spring", between = ["x", "y"], k = "k" }
elements.f = { type = "damper", between = ["x", "y"], b = "c" }
inputs.F = { force = "x" }
outputs.X = "x"
analysis.band = ["0.1 Hz", "3 Hz"]
"""
COMMANDS = {
    "sweep": ("sweep a.toml --over k=1:100:log:60 --workers 1 -o a.nc", ("a.nc",)),
    "sweep to a table": ("sweep a.toml --over k=1:100:log:25 --workers 1 -o a.csv", ("a.csv",)),
    "export": ("export a.toml --to c -o a.c", ("a.c", "a.h")),
    "export of fragments": ("export a.toml --to latex --no-figures -o paper/", ()),
    "report": ("report a.toml -o report --no-pdf -j 1 --date none", ()),
    "fit": ("fit data.csv --modes 1 -o fitted.toml", ("fitted.toml",)),
    "measure": (
        "measure a.toml --tf X/F --band 0.2 2 --spacing 0.1 --averages 4 -o measured.csv",
        ("measured.csv",),
    ),
    "plot": ("plot a.toml bode -o a.svg", ("a.svg",)),
}
OLD = b"as it was\n"
UNPRIVILEGED = 65534
TRANSIENT = (".tmp", ".lock")
WATCHED = {"open", "os.rename", "os.remove", "os.mkdir", "os.rmdir", "os.scandir", "os.utime"}
FAULTS = ("kill at an instant", "kill at an operation", "failing", "full", "read-only", "two at once")


@dataclass
class Fault:
    """What goes wrong: its kind, and when, as a part of the run or of its operations."""

    kind: str
    when: float


def prepare(folder, *, has_old):
    """Fill a folder with what the commands read, and perhaps with older outputs."""
    folder.mkdir(parents=True)
    (folder / "a.toml").write_text(SPEC)
    lines = [(f, 1 / (100 - f * f + 0.4j * f + 0.1)) for f in range(1, 30)]
    table = "".join(f"{f},{h.real!r},{h.imag!r}\n" for f, h in lines)
    (folder / "data.csv").write_text("frequency_hz,re,im\n" + table)
    for _, outputs in COMMANDS.values() if has_old else ():
        for name in outputs:
            (folder / name).write_bytes(OLD)


def files_of(folder):
    """Return the content of all files, without what is there only for a while, and journals."""
    found = {}
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        is_own = not name.endswith(TRANSIENT) and ".part/" not in name and not name.startswith("said")
        if path.is_file() and is_own:
            found[name] = path.read_bytes()
    return found


@dataclass
class Child:
    """A process, and the end of a pipe where what it prints comes out."""

    number: int
    said: int

    def finish(self):
        """Return how it ended, an exit code or the negative number of a signal, and what it printed."""
        code = os.waitstatus_to_exitcode(os.waitpid(self.number, 0)[1])
        with open(self.said, encoding="utf-8", errors="replace") as file:
            return code, file.read()


def start(folder, words, fault=None, operations=0):
    """Start a command in a process of its own, with a fault perhaps."""
    said, writing = os.pipe()
    fcntl.fcntl(writing, fcntl.F_SETPIPE_SZ, 2**20)  # so that nobody has to read meanwhile
    child = os.fork()
    if child:
        os.close(writing)
        return Child(child, said)
    code = 70  # of what is not ours
    try:
        os.chdir(folder)
        os.dup2(writing, 1)
        os.dup2(writing, 2)
        # Whoever captures the parent's output keeps these in files of his own.
        sys.stdout, sys.stderr = (open(number, "w", closefd=False) for number in (1, 2))
        if fault is not None:
            inject(fault, operations)
        code = run(words.split())
        sys.stdout.flush()
    except BaseException:  # noqa: BLE001 - whatever ends the process is told
        traceback.print_exc()
        sys.stderr.flush()
    finally:
        os._exit(code)


def inject(fault, operations):
    """Arrange for a fault in this process."""
    chosen = int(fault.when * operations)
    count = 0
    if fault.kind == "full":
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        size = int(10 ** (5 * fault.when))
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
    elif fault.kind == "read-only" and os.geteuid() == 0:
        os.setgroups([])
        os.setgid(UNPRIVILEGED)
        os.setuid(UNPRIVILEGED)
    elif fault.kind in ("kill at an operation", "failing"):

        def watch(event, arguments):
            nonlocal count
            if event not in WATCHED or not concerns(event, arguments):
                return
            count += 1
            if count == chosen + 1:
                if fault.kind == "kill at an operation":
                    os.kill(os.getpid(), signal.SIGKILL)
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

        sys.addaudithook(watch)


def concerns(event, arguments):
    """Tell whether an operation writes, or has to do with what is written."""
    path = str(arguments[0])
    if event == "open":
        return any(part in path for part in (".symflex-", ".part", ".lock")) and ".py" not in path
    return "site-packages" not in path and "__pycache__" not in path and "/lib/python" not in path


def warm(folder, words):
    """Run a command here, so that no child has to import anything, which one without privileges may not."""
    place = Path.cwd()
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        os.chdir(folder)
        run(words.split())
        os.chdir(place)


def one(name, fault, reference, scratch):
    """Inject a fault into a command; return whether it felt it, and what is wrong afterwards."""
    words, _ = COMMANDS[name]
    folder = Path(tempfile.mkdtemp(dir=scratch)) / "work"
    prepare(folder, has_old=fault.when > 0.5)
    before = files_of(folder)
    wrong = []
    if fault.kind == "read-only":
        folder.parent.chmod(0o755)
        folder.chmod(0o777)
        for path in folder.iterdir():
            path.chmod(0o644)
        folder.chmod(0o555)
    children = [start(folder, words, fault, reference.operations[name])]
    if fault.kind == "two at once":
        time.sleep(fault.when * reference.seconds[name] / 4)
        children.append(start(folder, words))
    if fault.kind == "kill at an instant":
        time.sleep(fault.when * reference.seconds[name])
        os.kill(children[0].number, signal.SIGKILL)
    codes, texts = zip(*(child.finish() for child in children), strict=True)
    folder.chmod(0o755)
    said = "\n".join(texts)
    expected = reference.files[name]
    if "Traceback" in said or any(code not in (0, 2, -signal.SIGKILL) for code in codes):
        wrong.append(f"exit codes {codes}: {said[-1500:]}")
    wrong += [
        f"{path} is torn: {len(content)} bytes"
        for path, content in files_of(folder).items()
        if content not in (before.get(path), expected.get(path))
    ]
    if 2 in codes and not any(code in said for code in ("SF903", "SF919", "SF901")):
        wrong.append(f"no reason: {said[-500:]}")
    again, said = start(folder, words).finish()
    if again != 0:
        wrong.append(f"afterwards, exit code {again}: {said[-1500:]}")
    elif files_of(folder) != before | expected:
        differ = [p for p, c in (before | expected).items() if files_of(folder).get(p) != c]
        wrong.append(f"afterwards, other bytes: {differ}")
    elif list(folder.glob("*.part")) or list(folder.glob("*.lock")):
        wrong.append("afterwards, something is left")
    shutil.rmtree(folder.parent)
    return any(codes), wrong


class Reference:
    """What the commands write without a fault, how long they take, and how many operations."""

    def __init__(self, names, scratch):
        self.files, self.seconds, self.operations = {}, {}, {}
        for name in names:
            folder = Path(scratch) / f"reference-{len(self.files)}"
            prepare(folder, has_old=False)
            before = files_of(folder)
            warm(folder, COMMANDS[name][0])
            shutil.rmtree(folder)
            prepare(folder, has_old=False)
            begin = time.monotonic()
            code, said = start(folder, COMMANDS[name][0]).finish()
            if code:
                raise AssertionError(name, code, said)
            self.seconds[name] = time.monotonic() - begin
            found = files_of(folder)
            self.files[name] = {path: found[path] for path in found if path not in before}
            journal = 3 * (60 if name == "sweep" else 25) if name.startswith("sweep") else 0
            self.operations[name] = 6 * len(self.files[name]) + journal + 6


def main(count, seed):
    """Inject faults; return by kind how many there were and how many were felt, and what was wrong."""
    random_numbers = random.Random(seed)
    names = list(COMMANDS)
    done, wrong = {kind: [0, 0] for kind in FAULTS}, []
    with tempfile.TemporaryDirectory() as scratch:
        os.chmod(scratch, 0o755)
        reference = Reference(names, scratch)
        for i in range(count):
            turn, place = divmod(i, len(names))
            name = names[place]
            kind = FAULTS[(place + turn) % len(FAULTS)]  # every kind in every turn
            fault = Fault(kind, random_numbers.random())
            is_felt, found = one(name, fault, reference, scratch)
            done[fault.kind] = [done[fault.kind][0] + 1, done[fault.kind][1] + is_felt]
            wrong += [f"{name}, {fault.kind} at {fault.when:.4f}: {text}" for text in found]
    return done, wrong


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m tests.tools.faults", description=__doc__)
    parser.add_argument("--count", type=int, default=216)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    counts, problems = main(given.count, given.seed)
    rows = (
        f"{kind:20} {number:5d}, of which {felt} ended the command" for kind, (number, felt) in counts.items()
    )
    print(*rows, *problems, sep="\n")
    sys.exit(1 if problems else 0)
