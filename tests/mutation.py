"""Measure how many small changes of a module its tests notice.

    python -m tests.mutation symflex/roots/krawczyk.py tests/unit/roots/test_krawczyk.py

changes the module in a copy of the checkout, one place at a time (mutmut does), runs the tests named, and
prints the share of changes that they notice and the diff of every other. Without tests the unit tests of the
module's room are taken. Functions with a decorator (properties, cached results) are not changed. The figures
of the core stand in docs/mutation.md.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
COPIED = [
    "docs",
    "derivations",
    "benchmarks",
    "README.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "mkdocs.yml",
    ".ci",
]
SETTINGS = """
[tool.mutmut]
source_paths = ["symflex"]
only_mutate = [{module!r}]
also_copy = {copied!r}
pytest_add_cli_args = ["-n0", "-q", "-p", "no:cacheprovider", "-p", "no:warnings"]
pytest_add_cli_args_test_selection = {tests!r}
"""
MUTMUT = (sys.executable, "-m", "mutmut")
NOTICED = {"killed", "timeout"}


def measure(module: str, tests: list[str], children: int = 2) -> None:
    """Print which changes of a module survive the tests, and the share of those noticed."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder)

        def run(*command: str) -> str:
            return subprocess.run(command, cwd=copy, capture_output=True, text=True, check=False).stdout

        listed = subprocess.run(
            ("git", "ls-files", "-co", "--exclude-standard"), cwd=ROOT, capture_output=True, check=True
        )
        for name in listed.stdout.decode().splitlines():
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, copy / name)
        with (copy / "pyproject.toml").open("a") as file:
            file.write(SETTINGS.format(module=module, copied=COPIED, tests=tests))
        said = run(*MUTMUT, "run", "--max-children", str(children))
        verdicts = dict(
            re.findall(r"^ *(\S+): ([a-z ]+)$", run(*MUTMUT, "results", "--all", "true"), re.MULTILINE)
        )
        if not verdicts or "not checked" in verdicts.values():
            sys.exit(f"the tests fail, or cannot be run, without a change:\n{said[-4000:]}")
        survived = [name for name, verdict in verdicts.items() if verdict not in NOTICED]
        for name in survived:
            diff = [
                line for line in run(*MUTMUT, "show", name).splitlines() if re.match(r"[-+](?![-+])", line)
            ]
            print(f"{name.rpartition('.')[2]} ({verdicts[name]})", *diff, sep="\n")
    noticed = len(verdicts) - len(survived)
    print(f"{module}: {noticed} of {len(verdicts)} changes noticed, {noticed / len(verdicts):.0%}")


if __name__ == "__main__":
    chosen, *named = sys.argv[1:]
    measure(chosen, named or [f"tests/unit/{Path(chosen).parts[1]}"])
