"""A bending beam at a million frequencies: exported code, numpy by hand, and ``sympy.lambdify``.

The function is V_act/F of the sliding-free beam (derivations/eppinger1988). All ways run in one process and
take turns; each counts with its fastest run, in processor time. Code by hand is what a careful person would
write: two complex exponentials that decay, the same for both half-planes, and a series near s = 0.
``sympy.lambdify`` gets the hyperbolic closed form that symflex prints, with its definitions put in; it
overflows above some 10 kHz, and the band stops before.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy

import symflex
from benchmarks.generated import imported
from benchmarks.measure import Claim, Extent, Measured, Measurement, taking_turns, typical_ratio
from symflex import pipeline
from symflex.codegen.python.module import NUMPY

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

SPECIFICATION = Path(__file__).parents[1] / "derivations" / "eppinger1988" / "sliding_free_beam.toml"
POINTS = 1_000_000
BAND_HZ = (0.1, 1000.0)
"""The band of the model's ``[analysis]``, sampled as a Bode diagram is."""
ROUNDS, QUICK_ROUNDS = 21, 5
TASK = "sliding-free beam at a million frequencies"

FOUND = np.show_config(mode="dicts")["SIMD Extensions"]["found"]
HAS_WIDE_VECTORS = "X86_V4" in FOUND or "AVX512_SKX" in FOUND
"""Whether numpy has vector code for tangents here: without it real arithmetic takes five times as long."""
FASTER_IN_REAL_ARITHMETIC = 2.0 if HAS_WIDE_VECTORS else 1.3
SLOWER_THAN_BY_HAND = 1.2
FASTER_THAN_LAMBDIFY_CSE = 1.8
FASTER_THAN_LAMBDIFY = 6.5 if HAS_WIDE_VECTORS else 5.0
AGREEMENT = 1e-13
"""Median of the relative differences between the ways, or they would not do the same."""


def measure(extent: Extent) -> Measured:
    """Measure all ways, as many rounds as fit in the limit, and compare.

    Raises
    ------
    RuntimeError
        When the ways do not compute the same function.
    """
    omega = 2.0 * math.pi * np.geomspace(*BAND_HZ, POINTS)
    ways = _ways(1j * omega, omega)
    rounds = extent.of(ROUNDS, QUICK_ROUNDS)
    runs = taking_turns(ways, extent.limit, rounds=rounds, agreement=AGREEMENT)
    found = [Measurement(TASK, name, min(times), extent.limit) for name, times in runs.items()]
    ours, real, by_hand, common, plain = runs.values()
    claims = [
        Claim(
            "beam in real arithmetic: times as fast as for complex s",
            FASTER_IN_REAL_ARITHMETIC,
            typical_ratio(ours, real),
        ),
        Claim(
            "beam: times as long as numpy by hand",
            SLOWER_THAN_BY_HAND,
            typical_ratio(ours, by_hand),
            larger_is_better=False,
        ),
        Claim(
            "beam: times as fast as `lambdify(..., cse=True)`",
            FASTER_THAN_LAMBDIFY_CSE,
            typical_ratio(common, ours),
        ),
        Claim("beam: times as fast as plain `lambdify`", FASTER_THAN_LAMBDIFY, typical_ratio(plain, ours)),
    ]
    return Measured(found, claims)


def _ways(s: NDArray[Any], omega: NDArray[Any]) -> dict[str, Callable[[], Any]]:
    """Return the ways to compute the values, without arguments."""
    module = exported_module()
    values = [module.PARAMETERS[name]["value"] for name in ("E", "I", "rho", "A", "l")]
    closed, symbols = _closed_form()
    common = sympy.lambdify(symbols, closed, cse=True)
    plain = sympy.lambdify(symbols, closed)
    return {
        "`symflex export --to numpy`, `V_act_over_F(s)`": lambda: module.V_act_over_F(s),
        "the same, `V_act_over_F_at(omega)` in real arithmetic": lambda: module.V_act_over_F_at(omega),
        "numpy by hand, two complex exponentials": lambda: by_hand(s, *values),
        "`sympy.lambdify(..., cse=True)`": lambda: common(s, *values),
        "`sympy.lambdify(...)`": lambda: plain(s, *values),
    }


def exported_module() -> Any:  # noqa: ANN401
    """Return the exported module, imported."""
    model = pipeline.load(SPECIFICATION)
    return imported(NUMPY.export(model, pipeline.derive_all(model)).text, "exported_beam")


def _closed_form() -> tuple[sympy.Expr, list[sympy.Symbol]]:
    """Return the printed closed form with its definitions put in, and its symbols, s first."""
    function = symflex.load(SPECIFICATION).transfer_function("V_act", "F")
    expression = function.form("hyperbolic").expr
    for name, value in function.form("hyperbolic").where:
        named = {x: value for x in expression.free_symbols if x.name == str(name)}
        expression = expression.subs(named)
    by_name = {x.name: x for x in expression.free_symbols}
    return expression, [by_name[name] for name in ("s", "E", "I", "rho", "A", "l")]


def by_hand(s: NDArray[Any], e: float, i: float, rho: float, a: float, length: float) -> NDArray[Any]:
    """Return V_act/F of the sliding-free beam as a careful person would write it."""
    q = length * np.sqrt(np.where(s.real < 0.0, -s, s) * (math.sqrt(rho * a / (e * i)) / 2.0))
    rising, falling = np.exp((-1.0 + 1.0j) * q), np.exp((-1.0 - 1.0j) * q)
    both, up, down = rising * falling, rising * rising, falling * falling
    square = both * both
    num = 1.0 + square + (up + down) + 4.0 * both
    den = 1.0 - square - 1j * (up - down)
    value: NDArray[Any] = q * num / (rho * a * length * s * den)
    near = np.abs(q) < 1.0
    if near.any():
        z = q[near] ** 4
        above = 1.0 + z * (1 / 3 + z * (1 / 315 + z * (2 / 467775)))
        below = 1.0 + z * (2 / 15 + z * (2 / 2835 + z * (4 / 6081075)))
        value[near] = above / (rho * a * length * s[near] * below)
    return value
