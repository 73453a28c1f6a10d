"""Measure how many small changes of modules their tests notice.

    python -m tests.tools.mutation symflex/loops/lumped.py tests/unit/loops/test_lumped.py
    python -m tests.tools.mutation --sample 40 symflex/roots/distributed/side.py symflex/roots/locate.py

changes the modules in a copy of the checkout, one place at a time (mutmut does), runs the tests named, and
prints the share of changes that they notice and the diff of every other. Without tests the unit tests of the
modules' packages are taken; ``--sample`` draws so many changes of each module, the same ones each time. Those
of functions with a decorator (properties, cached results) are not made. docs/mutation.md has the figures of
the core.

    python -m tests.tools.mutation --sample 40 --record before.json symflex/loops/lumped.py tests/unit/loops
    python -m tests.tools.mutation --again before.json symflex/loops/lumped.py tests/unit/loops

The first writes down which changes the tests noticed; the second makes just these again, after tests were cut
or joined, and prints every one that nobody notices any more.
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from random import Random

ROOT = Path(__file__).resolve().parents[2]
COPIED = [
    "docs", "derivations", "benchmarks", "README.md", "CHANGELOG.md", "CONTRIBUTING.md", "mkdocs.yml", ".ci",
]  # fmt: skip
SETTINGS = """
[tool.mutmut]
source_paths = ["symflex"]
only_mutate = {modules!r}
also_copy = {copied!r}
pytest_add_cli_args = ["-n0", "-q", "-p", "no:cacheprovider", "-p", "no:warnings"]
pytest_add_cli_args_test_selection = {tests!r}
"""
MUTMUT = (sys.executable, "-m", "mutmut")
NOTICED = {"killed", "timeout"}
SEED = 15


def measure(
    modules: list[str],
    tests: list[str],
    *,
    sample: int | None = None,
    again: Path | None = None,
    record: Path | None = None,
    children: int = 2,
) -> None:
    """Print which changes of modules survive the tests, and the shares of those noticed."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder)

        def run(*command: str) -> str:
            return subprocess.run(command, cwd=copy, capture_output=True, text=True, check=False).stdout

        def verdicts() -> dict[str, str]:
            listed = run(*MUTMUT, "results", "--all", "true")
            return dict(re.findall(r"^ *(\S+): ([a-z ]+)$", listed, re.MULTILINE))

        listed = subprocess.run(
            ("git", "ls-files", "-co", "--exclude-standard"), cwd=ROOT, capture_output=True, check=True
        )
        for name in listed.stdout.decode().splitlines():
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, copy / name)
        with (copy / "pyproject.toml").open("a") as file:
            file.write(SETTINGS.format(modules=modules, copied=COPIED, tests=tests))
        chosen: list[str] = []
        if again is not None:
            before = json.loads(again.read_text(encoding="utf-8"))
            chosen = [name for module in modules for name in before[module]["noticed"]]
        elif sample is not None:
            # A run for a change that does not exist lists all changes, and which tests reach them.
            run(*MUTMUT, "run", "none")
            found = list(verdicts())
            for module in modules:
                own = [name for name in found if _module_of(name) == module]
                chosen += Random(SEED).sample(own, min(sample, len(own)))
        said = run(*MUTMUT, "run", "--max-children", str(children), *chosen)
        every = {name: v for name, v in verdicts().items() if not chosen or name in chosen}
        if not every or "not checked" in every.values():
            sys.exit(f"the tests fail, or cannot be run, without a change:\n{said[-4000:]}")
        survived = [name for name, verdict in every.items() if verdict not in NOTICED]
        for name in survived:
            diff = [
                line for line in run(*MUTMUT, "show", name).splitlines() if re.match(r"[-+](?![-+])", line)
            ]
            print(f"{name.rpartition('.')[2]} ({every[name]})", *diff, sep="\n")
    found: dict[str, dict[str, list[str]]] = {}
    for module in modules:
        tried = [name for name in every if _module_of(name) == module]
        noticed = [name for name in tried if name not in survived]
        found[module] = {"noticed": noticed, "survived": [name for name in tried if name in survived]}
        share = len(noticed) / max(1, len(tried))
        print(f"{module}: {len(noticed)} of {len(tried)} changes noticed, {share:.0%}")
    if record is not None:
        record.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


def _module_of(change: str) -> str:
    return change.rpartition(".")[0].replace(".", "/") + ".py"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description="Measure how many small changes of modules their tests notice."
    )
    parser.add_argument("paths", nargs="+", metavar="PATH", help="modules, symflex/..., and tests")
    parser.add_argument("--sample", type=int, metavar="N", help="draw N changes of each module")
    parser.add_argument("--again", type=Path, metavar="FILE", help="make what a record says was noticed")
    parser.add_argument("--record", type=Path, metavar="FILE", help="write which changes were noticed")
    parser.add_argument("--children", type=int, default=2, metavar="N", help="processes (2)")
    given = parser.parse_args()
    changed = [path for path in given.paths if path.startswith("symflex/")]
    packages = sorted({f"tests/unit/{Path(path).parts[1]}" for path in changed})
    named = [path for path in given.paths if path not in changed]
    measure(
        changed,
        named or packages,
        sample=given.sample,
        again=given.again,
        record=given.record,
        children=given.children,
    )
