"""The nested form: chains, rings, trees, ladders and square grids, every m, k and b symbolic.

Timed is the elimination, from assembled equations to the straight-line programs of the driving-point
receptance X_first/F and of X_last/F, each size in a process of its own; the ways are sizes of one shape of
network. Then a damped chain of 200 masses at 1000 frequencies, evaluated by its nested form and by
``numpy.linalg.solve`` on the dense matrices of the same equations. Times are processor times.
"""

from __future__ import annotations

import subprocess
import sys
from dataclasses import dataclass
from math import nan
from typing import TYPE_CHECKING, Final

import numpy as np

from benchmarks.measure import OWN, PEAK, Claim, Extent, Measured, Measurement, fastest
from benchmarks.networks import chain, network
from symflex import pipeline
from symflex.transfer import bind_nested

if TYPE_CHECKING:
    from collections.abc import Mapping

SIZES: Final[Mapping[str, tuple[int, ...]]] = {
    "chain": (100, 1_000, 10_000, 50_000),
    "ring": (100, 1_000, 10_000, 50_000),
    "tree": (127, 1_023, 8_191, 32_767),
    "ladder": (100, 1_000, 10_000, 50_000),
    "grid": (100, 900, 3_600),
}
QUICK_SIZES: Final[Mapping[str, tuple[int, ...]]] = {"chain": (500, 1_000), "ladder": (500, 1_000)}
CEILINGS = {1_000: 0.1, 50_000: 2.0}
"""Per length of a chain, seconds the elimination may take."""
EVEN = 1.02
"""How far the operations per mass may differ between 1000 masses and the largest number."""
PER_SECOND = 1_000
"""Masses of the largest networks, per second of the limit: to assemble 50,000 takes half a minute."""
MASSES, POINTS = 200, 1_000
ROUNDS, QUICK_ROUNDS = 5, 1
TIMES_FASTER = 30.0
AGREEMENT = 1e-11

SNIPPET = """
import time
from benchmarks.networks import NETWORKS, network
from symflex import pipeline
from symflex.equations.elimination.star_mesh import eliminate

model = network(NETWORKS[{kind!r}]({n}))
begin = time.process_time()
equations = pipeline.assemble_sparse(model)
middle = time.process_time()
found = eliminate(equations, [("X_first", "F"), ("X_last", "F")])
end = time.process_time()
sizes = [found.program.size(*quotient) for quotient in found.quotients]
print(end - middle, middle - begin, *sizes)
"""


@dataclass(frozen=True, slots=True)
class Growth:
    """What one size of one shape of network takes.

    Parameters
    ----------
    kind : str
        Shape of the network.
    masses : int
        Their number.
    seconds, assembly : float
        Of the elimination, and of assembling the equations before it.
    first, last : int
        Operations of X_first/F and of X_last/F.
    memory : float
        Most memory the process had, model and equations included [MB]; nan where it is not known.
    """

    kind: str
    masses: int
    seconds: float
    assembly: float
    first: int
    last: int
    memory: float


def grow(kind: str, n: int, limit: float) -> Growth | None:
    """Measure one size in a process of its own, ``None`` when it takes longer than ``limit``."""
    code = SNIPPET.format(kind=kind, n=n) + PEAK
    try:
        done = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, timeout=limit, check=True
        )
    except subprocess.TimeoutExpired:
        return None
    seconds, assembly, first, last, *memory = done.stdout.split()
    masses = round(n**0.5) ** 2 if kind == "grid" else n
    peak = float(memory[0]) / 1e3 if memory else nan
    return Growth(kind, masses, float(seconds), float(assembly), int(first), int(last), peak)


def growth_table(curve: list[Growth]) -> str:
    """Return the growth curve as a table."""
    lines = [
        "## growth of the nested form",
        "",
        "| network | masses | elimination [s] | per mass [us] | operations X_first, X_last "
        "| per mass | assembly [s] | memory [MB] |",
        "|---|---:|---:|---:|---:|---:|---:|---:|",
    ]
    for g in curve:
        lines.append(
            f"| {g.kind} | {g.masses} | {g.seconds:.3f} | {1e6 * g.seconds / g.masses:.0f} "
            f"| {g.first}, {g.last} | {g.first / g.masses:.2f}, {g.last / g.masses:.2f} "
            f"| {g.assembly:.2f} | {g.memory:.0f} |"
        )
    return "\n".join(lines)


def measure(extent: Extent) -> Measured:
    """Measure growth and evaluation."""
    limit = extent.limit
    found: list[Measurement] = []
    claims: list[Claim] = []
    curve: list[Growth] = []
    for kind, sizes in extent.of(SIZES, QUICK_SIZES).items():
        for n in (n for n in sizes if n <= PER_SECOND * limit):
            grown = grow(kind, n, max(limit, OWN))
            seconds = None if grown is None else grown.seconds
            peak = None if grown is None else grown.memory
            task = f"nested form: elimination of a {kind}"
            found.append(Measurement(task, f"{n} masses", seconds, limit, peak))
            if grown is not None:
                curve.append(grown)
            if kind == "chain" and n in CEILINGS:
                taken = nan if grown is None else grown.seconds
                text = f"nested form, chain of {n}: seconds of elimination"
                claims.append(Claim(text, CEILINGS[n], taken, larger_is_better=False, is_ratio=False))
        ours = [g for g in curve if g.kind == kind and g.masses >= MASSES]
        if kind != "grid" and len(ours) > 1:
            per_mass = [g.first / g.masses for g in ours]
            text = f"nested form, {kind}: largest over smallest number of operations per mass"
            claims.append(Claim(text, EVEN, max(per_mass) / min(per_mass), larger_is_better=False))
    measured, claim = _evaluation(limit, extent.of(ROUNDS, QUICK_ROUNDS))
    return Measured([*found, *measured], [*claims, claim], (growth_table(curve),))


def _evaluation(limit: float, rounds: int) -> tuple[list[Measurement], Claim]:
    """Compare the evaluation of a damped chain with dense solves.

    Raises
    ------
    RuntimeError
        When the nested form is not as accurate as it should be, against balls.
    """
    model = network(chain(MASSES))
    values = {p.name: _value(p.name) for p in model.parameters}
    (tf,) = pipeline.derive_nested(model, [("X_last", "F")])
    bound = bind_nested(tf, values)
    s = 1j * np.logspace(-1, 2.5, POINTS)
    some = s[:: POINTS // 20]
    exact = np.array([bound(complex(x)) for x in some])
    worst = float(np.abs(bound.at(some) / exact - 1).max())
    if worst > AGREEMENT:
        message = f"the nested form is accurate to {worst:.1e} only"
        raise RuntimeError(message)
    ways = {"nested form": lambda: bound.at(s), "`numpy.linalg.solve`": lambda: _dense(s, values)}
    best = fastest(ways, limit, rounds=rounds, agreement=1e-6)
    task = f"damped chain of {MASSES} masses at {POINTS} frequencies"
    ratio = best["`numpy.linalg.solve`"] / best["nested form"]
    text = f"{task}: times as fast as dense solves, accurate to {worst:.0e}"
    return [Measurement(task, way, seconds, limit) for way, seconds in best.items()], Claim(
        text, TIMES_FASTER, ratio
    )


def _value(name: str) -> float:
    kind, number = name.split("_")
    scale = {"m": 1.0, "k": 10_000.0, "b": 3.0}[kind]
    return scale * (1 + 0.01 * (7 * int(number) % 13))


def _dense(s: np.ndarray, values: dict[str, float]) -> np.ndarray:
    """Return X_last/F from the matrices A(s), one solve per frequency."""
    a = np.zeros((len(s), MASSES, MASSES), dtype=complex)
    for i in range(MASSES):
        a[:, i, i] += values[f"m_{i + 1}"] * s**2
    for number, (p, q) in enumerate(chain(MASSES), 1):
        w = values[f"k_{number}"] + values[f"b_{number}"] * s
        for i, j, sign in ((p, p, 1), (q, q, 1), (p, q, -1), (q, p, -1)):
            a[:, i - 1, j - 1] += sign * w
    force = np.zeros((len(s), MASSES, 1), dtype=complex)
    force[:, 0] = 1
    return np.linalg.solve(a, force)[:, -1, 0]
