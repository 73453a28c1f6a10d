"""``python -m benchmarks``: print all ratios; with ``--check``, fail when one misses its bound."""

from __future__ import annotations

import argparse
import json
import platform
import sys
from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from importlib.metadata import version
from math import isnan
from pathlib import Path
from time import monotonic

from benchmarks import (
    chains,
    distributed,
    exports,
    frames,
    in_time,
    lumped,
    members,
    nested,
    numeric_chain,
    roots,
    startup,
    sweep,
    tapers,
)
from benchmarks.measure import Claim, Measurement
from symflex import __version__

Measured = tuple[list[Measurement], list[Claim]]

RUNS = 3
"""At most, of a benchmark that misses a bound: what else a machine does can spoil one run, not three."""


def main(arguments: list[str] | None = None) -> int:
    """Run all benchmarks and return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--check", action="store_true", help="fail when a ratio misses its bound")
    parser.add_argument("--limit", type=float, default=60.0, help="seconds each way may take (default: 60)")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all numbers to a file as well")
    asked = parser.parse_args(arguments)

    limited = (
        chains,
        numeric_chain,
        nested,
        distributed,
        members,
        frames,
        exports,
        in_time,
        lumped,
        roots,
        tapers,
        sweep,
    )
    measurements, claims = list[Measurement](), list[Claim]()
    benchmarks: dict[str, Callable[[], Measured]] = {startup.__name__: startup.measure}
    benchmarks |= {benchmark.__name__: partial(benchmark.measure, asked.limit) for benchmark in limited}
    for name, measure in benchmarks.items():
        begin, runs = monotonic(), [measure()]
        while asked.check and _missed(runs[-1]) and len(runs) < RUNS:
            runs.append(measure())
        print(f"{name}: {monotonic() - begin:.0f} s, runs: {len(runs)}", file=sys.stderr)
        measured, bounds = min(runs, key=_missed)
        measurements += measured
        claims += bounds

    print(_markdown(measurements, claims))
    if asked.json:
        asked.json.write_text(_json(measurements, claims), encoding="utf-8")
    return 1 if asked.check and _missed((measurements, claims)) else 0


def _missed(run: Measured) -> int:
    """Return how many ratios of a run miss their bounds."""
    return sum(claim.is_ratio and not claim.holds for claim in run[1])


def _markdown(measurements: list[Measurement], claims: list[Claim]) -> str:
    others = "".join(f", {name} {version(name)}" for name in ("python-flint", "sympy", "click"))
    system = f"Python {platform.python_version()}, {platform.system()} {platform.machine()}"
    lines = [f"symflex {__version__}{others}, {system}"]
    for task in dict.fromkeys(m.task for m in measurements):
        rows = [m for m in measurements if m.task == task]
        lines += ["", f"## {task}", "", "| way | time [ms] | ratio to the first | peak [MB] |"]
        lines += ["|---|---:|---:|---:|"]
        for row in rows:
            more = "> " if row.seconds is None else ""
            ratio = row.at_least / rows[0].at_least
            peak = "" if row.peak_mb is None else f"{row.peak_mb:.0f}"
            lines.append(f"| {row.way} | {more}{1e3 * row.at_least:.2f} | {more}{ratio:.3g} | {peak} |")
    lines += ["", "## bounds", "", "| measured | bound | this run | |", "|---|---:|---:|---|"]
    for claim in claims:
        verdict = "holds" if claim.holds else "MISSED"
        bound = f"{'at least' if claim.larger_is_better else 'at most'} {claim.bound:g}"
        measured = "stopped" if isnan(claim.measured) else f"{claim.measured:.3g}"
        lines.append(f"| {claim.text} | {bound} | {measured} | {verdict} |")
    return "\n".join(lines)


def _json(measurements: list[Measurement], claims: list[Claim]) -> str:
    content = {
        "schema": "symflex.benchmarks/1",
        "python": platform.python_version(),
        "machine": platform.machine(),
        "measurements": [
            {
                "task": m.task,
                "way": m.way,
                "seconds": m.seconds,
                "reached_limit": m.seconds is None,
                "peak_mb": m.peak_mb,
            }
            for m in measurements
        ],
        "claims": [
            {**asdict(c), "measured": None if isnan(c.measured) else c.measured, "holds": c.holds}
            for c in claims
        ],
    }
    return json.dumps(content, indent=2) + "\n"


if __name__ == "__main__":
    sys.exit(main())
