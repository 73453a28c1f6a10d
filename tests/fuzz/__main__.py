"""Run targets one after the other: ``python -m tests.fuzz --seconds N [--folder FOLDER] [TARGET...]``."""

import argparse
import os
import re
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

from tests.fuzz import TARGETS
from tests.fuzz.engine import UNGUIDED

COUNT = re.compile(r"stat::number_of_executed_units:\s*(\d+)")
STARTING_SECONDS = 240
"""What a target may take beyond its time: for its seeds, which are made before."""


def fuzz(name, seconds, folder, *, is_guided=True):
    """Fuzz one target; return how many inputs it took and the files of those that failed."""
    place = folder / name
    place.mkdir(parents=True, exist_ok=True)
    before = set(place.iterdir())
    words = [*([] if is_guided else [UNGUIDED]), name, str(place), f"-max_total_time={seconds}"]
    command = [sys.executable, "-m", "tests.fuzz.engine", *words]
    try:
        done = subprocess.run(
            command,
            stderr=subprocess.PIPE,
            text=True,
            errors="replace",
            check=False,
            timeout=seconds + STARTING_SECONDS,
            env=os.environ | {"TMPDIR": str(folder)},
        )
        said, code = done.stderr, done.returncode
    except subprocess.TimeoutExpired as error:
        said, code = str(error.stderr), 1
    found = sorted(set(place.iterdir()) - before - {place / "corpus"})
    count = COUNT.search(said)
    if code or found or count is None:
        print(said[-8000:], file=sys.stderr)
    return int(count[1]) if count else 0, found, code or count is None


def main():
    """Run the targets asked for and say how many inputs each took; exit with 1 when one failed."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("--seconds", type=int, default=200, help="altogether; 200 by default")
    parser.add_argument("--folder", type=Path, help="where inputs are kept, for the next run to go on from")
    parser.add_argument(UNGUIDED, dest="guided", action="store_false", help="faster, from the inputs kept")
    parser.add_argument("targets", nargs="*", help=", ".join(TARGETS))
    given = parser.parse_args()
    unknown = set(given.targets) - set(TARGETS)
    if unknown:
        parser.error(f"no such target: {', '.join(sorted(unknown))}")
    if find_spec("atheris") is None:
        is_required = os.environ.get("SYMFLEX_REQUIRE_TOOLS") == "1"
        print("SKIPPED: nothing was fuzzed, atheris is missing: pip install '.[fuzz]'", file=sys.stderr)
        return 1 if is_required else 0
    names = given.targets or TARGETS
    failed = False
    with tempfile.TemporaryDirectory() as scratch:
        for name in names:
            count, found, is_broken = fuzz(
                name,
                max(given.seconds // len(names), 1),
                given.folder or Path(scratch),
                is_guided=given.guided,
            )
            print(f"{name:16} {count:9d} inputs, {len(found)} failed", flush=True)
            failed |= bool(found) or bool(is_broken)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
