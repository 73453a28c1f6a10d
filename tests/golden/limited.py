"""Runs of the command line with limits, each in a process of its own.

The processes are forked from one that has imported the program, so that what is limited and paid for is the
command, not the start of Python.
"""

import atexit
import json
import os
import subprocess
import sys
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[2]
MEGABYTE = 2**20
MEMORY = 512 * MEGABYTE
HANG = 300  # seconds after which a process that uses no processor time is taken to wait for ever

# A child leaves the loop and goes on as a fresh interpreter would: what it raises ends it.
SERVER = """
import json, os, resource, signal, sys
import symflex.pipeline, symflex.cli.formulas
for line in sys.stdin:
    folder, arguments, seconds, memory, hang, out, err = json.loads(line)
    child = os.fork()
    if not child:
        break
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
else:
    sys.exit()
os.chdir(folder)
for number, path in enumerate((os.devnull, out, err)):
    os.dup2(os.open(path, os.O_RDWR), number)
for kind, limit in ((resource.RLIMIT_AS, memory), (resource.RLIMIT_CPU, seconds), (resource.RLIMIT_CORE, 0)):
    resource.setrlimit(kind, (limit, limit))
signal.alarm(hang)
symflex.cli.main(arguments)
"""


def environment():
    """Return the variables all runs have."""
    return {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONDONTWRITEBYTECODE": "1", "NO_COLOR": "1"}


@cache
def _server():
    folder = TemporaryDirectory()
    server = subprocess.Popen(
        [sys.executable, "-c", SERVER],
        env=environment(),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )

    def end():
        server.stdin.close()
        server.wait()
        server.stdout.close()
        folder.cleanup()

    atexit.register(end)
    return server, Path(folder.name)


def run(folder, *arguments, seconds):
    """Run a command in a folder.

    Returns
    -------
    tuple of int and bytes
        The exit code, negative for the signal that ended the process, and what was written to stdout and
        then to stderr.
    """
    server, own = _server()
    written = [own / "out", own / "err"]
    for path in written:
        path.write_bytes(b"")
    request = [str(folder), arguments, seconds, MEMORY, HANG, *map(str, written)]
    server.stdin.write(json.dumps(request) + "\n")
    server.stdin.flush()
    code = int(server.stdout.readline())
    return code, b"".join(path.read_bytes() for path in written)
