"""``python -m benchmarks [NAME...]``: print ratios, of all benchmarks where none is named.

With ``--check`` it fails when a ratio misses its bound. With ``--quick`` it measures only ratios that have a
bound, at sizes that take seconds.
"""

from __future__ import annotations

import argparse
import json
import platform
import sys
from dataclasses import asdict
from importlib.metadata import version
from math import isfinite, isnan
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Final

from benchmarks import (
    chains,
    distributed,
    errors,
    exports,
    frames,
    in_time,
    lumped,
    members,
    nested,
    numeric_chain,
    peers,
    printing,
    roots,
    startup,
    sweep,
    tapers,
)
from benchmarks.measure import Extent, Measured, Measurement
from symflex import __version__

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

BENCHMARKS: Final[Mapping[str, Callable[[Extent], Measured]]] = {
    "startup": startup.measure,
    "chains": chains.measure,
    "numeric_chain": numeric_chain.measure,
    "nested": nested.measure,
    "distributed": distributed.measure,
    "members": members.measure,
    "frames": frames.measure,
    "exports": exports.measure,
    "in_time": in_time.measure,
    "lumped": lumped.measure,
    "printing": printing.measure,
    "roots": roots.measure,
    "tapers": tapers.measure,
    "sweep": sweep.measure,
    "errors": errors.measure,
    "peers": peers.measure,
}
LIMIT: Final = 60.0
"""Seconds each way may take."""
RUNS: Final = 3
"""At most, of a benchmark that misses a bound: what else a machine does can spoil one run, not three."""


def main(arguments: list[str] | None = None) -> int:
    """Run the benchmarks that are named, or all, and return the exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks", description="Measure speed, as ratios against something else."
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"{', '.join(BENCHMARKS)} (default: all)")
    parser.add_argument("--check", action="store_true", help="fail when a ratio misses its bound")
    parser.add_argument("--quick", action="store_true", help="only ratios with a bound, at small sizes")
    parser.add_argument(
        "--limit", type=float, default=LIMIT, help=f"seconds each way may take (default: {LIMIT:g})"
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all numbers to a file as well")
    asked = parser.parse_args(arguments)
    unknown = [name for name in asked.names if name not in BENCHMARKS]
    if unknown:
        parser.error(f"no benchmark is called {unknown[0]!r}; there are {', '.join(BENCHMARKS)}")

    extent = Extent(asked.limit, is_quick=asked.quick)
    results = [
        _measured(name, extent, RUNS if asked.check else 1)
        for name in dict.fromkeys(asked.names or BENCHMARKS)
    ]
    whole = Measured(
        [m for result in results for m in result.measurements],
        [claim for result in results for claim in result.claims],
        tuple(table for result in results for table in result.tables),
    )
    print(_markdown(whole))
    if asked.json:
        asked.json.write_text(_json(whole), encoding="utf-8")
    return 1 if asked.check and whole.missed else 0


def _measured(name: str, extent: Extent, most: int) -> Measured:
    """Return the best of so many runs, the first that misses no bound."""
    begin, runs = monotonic(), [BENCHMARKS[name](extent)]
    while runs[-1].missed and len(runs) < most:
        runs.append(BENCHMARKS[name](extent))
    print(f"{name}: {monotonic() - begin:.0f} s, runs: {len(runs)}", file=sys.stderr)
    best = min(runs, key=lambda run: run.missed)
    if extent.is_quick:
        best = best._replace(claims=[claim for claim in best.claims if claim.is_ratio])
    return best


def _markdown(results: Measured) -> str:
    others = "".join(f", {name} {version(name)}" for name in ("python-flint", "sympy", "click"))
    system = f"Python {platform.python_version()}, {platform.system()} {platform.machine()}"
    lines = [f"symflex {__version__}{others}, {system}"]
    for task in dict.fromkeys(m.task for m in results.measurements):
        rows = [m for m in results.measurements if m.task == task]
        lines += ["", f"## {task}", "", "| way | time [ms] | ratio to the first | peak [MB] |"]
        lines += ["|---|---:|---:|---:|"]
        for row in rows:
            more = "> " if row.seconds is None else ""
            ratio = row.at_least / rows[0].at_least
            peak = "" if row.peak_mb is None else f"{row.peak_mb:.0f}"
            lines.append(f"| {row.way} | {more}{1e3 * row.at_least:.2f} | {more}{ratio:.3g} | {peak} |")
    for table in results.tables:
        lines += ["", table]
    lines += ["", "## bounds", "", "| measured | bound | this run | |", "|---|---:|---:|---|"]
    for claim in results.claims:
        verdict = "holds" if claim.holds else "MISSED"
        bound = f"{'at least' if claim.larger_is_better else 'at most'} {claim.bound:g}"
        measured = "stopped" if isnan(claim.measured) else f"{claim.measured:.3g}"
        lines.append(f"| {claim.text} | {bound} | {measured} | {verdict} |")
    return "\n".join(lines)


def _json(results: Measured) -> str:
    content = {
        "schema": "symflex.benchmarks/1",
        "python": platform.python_version(),
        "machine": platform.machine(),
        "measurements": [_row(m) for m in results.measurements],
        "claims": [
            {**asdict(c), "measured": c.measured if isfinite(c.measured) else None, "holds": c.holds}
            for c in results.claims
        ],
    }
    return json.dumps(content, indent=2) + "\n"


def _row(m: Measurement) -> dict[str, object]:
    return {
        "task": m.task,
        "way": m.way,
        "seconds": m.seconds,
        "reached_limit": m.seconds is None,
        "peak_mb": m.peak_mb,
    }


if __name__ == "__main__":
    sys.exit(main())
