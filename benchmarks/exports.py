"""Exported code against other ways: C on the frequency axis, against numpy and against C by hand.

The function is V_act/F of the sliding-free beam (derivations/eppinger1988). What is exported and what is
written by hand are compiled with the same flags, once for any processor and once for this one, whose vector
instructions numpy finds by itself when it runs. All ways run in one process and take turns; each counts with
its fastest run, in processor time. C by hand is what a careful person would write: one sine, cosine and
decaying exponential per frequency, and a series near zero.
"""

from __future__ import annotations

import ctypes
import math
import shutil
import sys
from typing import TYPE_CHECKING, Any

import numpy as np

from benchmarks.distributed import (
    AGREEMENT,
    BAND_HZ,
    POINTS,
    QUICK_ROUNDS,
    ROUNDS,
    SPECIFICATION,
    exported_module,
)
from benchmarks.generated import FLAGS, loaded, pointer, responding
from benchmarks.measure import Claim, Extent, Measured, Measurement, fastest
from symflex import pipeline
from symflex.codegen.c.module import C99

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

TASK = "exported C: sliding-free beam at a million frequencies"

FASTER_THAN_NUMPY = 2.5
SLOWER_THAN_BY_HAND = 1.3

BY_HAND = r"""
#include <math.h>
#include <stddef.h>

void by_hand(const double *omega, double *real, double *imag, size_t n,
             double E, double I, double rho, double A, double l)
{
    const double c = l * sqrt(sqrt(rho * A / (E * I))), m = rho * A * l;
    for (size_t i = 0; i < n; i++) {
        const double x = c * sqrt(omega[i]);
        real[i] = 0.0;
        if (x < 1.0) {
            const double z = x * x * x * x / 4.0;
            const double above = 1.0 - z * (1.0 / 3 - z * (1.0 / 315 - z * (2.0 / 467775)));
            const double below = 1.0 - z * (2.0 / 15 - z * (2.0 / 2835 - z * (4.0 / 6081075)));
            imag[i] = -above / (m * omega[i] * below);
        } else {
            const double e = exp(-x), sine = sin(x), cosine = cos(x), square = e * e;
            const double above = 2.0 * e + (1.0 + square) * cosine;
            const double below = (1.0 - square) * cosine + (1.0 + square) * sine;
            imag[i] = -x * above / (m * omega[i] * below);
        }
    }
}
"""
"""V_act/F = (x/(j omega m)) (1 + cosh x cos x)/(cosh x sin x + sinh x cos x), over cosh x."""


def measure(extent: Extent) -> Measured:
    """Measure all ways, as many rounds as fit in the limit, and compare; nothing without ``cc``.

    Raises
    ------
    RuntimeError
        When the ways do not compute the same function.
    """
    if shutil.which("cc") is None:
        print("skipped, there is no C compiler `cc`: exported C", file=sys.stderr)
        return Measured([], [])
    omega = 2.0 * math.pi * np.geomspace(*BAND_HZ, POINTS)
    rounds = extent.of(ROUNDS, QUICK_ROUNDS)
    best = fastest(_ways(omega), extent.limit, rounds=rounds, agreement=AGREEMENT)
    found = [Measurement(TASK, name, seconds, extent.limit) for name, seconds in best.items()]
    by_numpy, _, ours, by_hand, ours_native, by_hand_native = (m.at_least for m in found)
    claims = [
        # Code for any processor has vectors of two numbers only: too near the bound to enforce it.
        Claim(
            "exported C (`-O2`): times as fast as the numpy module",
            FASTER_THAN_NUMPY,
            by_numpy / ours,
            is_ratio=False,
        ),
        Claim(
            "exported C (`-O2 -march=native`): times as fast as the numpy module",
            FASTER_THAN_NUMPY,
            by_numpy / ours_native,
        ),
        Claim(
            "exported C (`-O2`): times as long as C by hand",
            SLOWER_THAN_BY_HAND,
            ours / by_hand,
            larger_is_better=False,
        ),
        Claim(
            "exported C (`-O2 -march=native`): times as long as C by hand",
            SLOWER_THAN_BY_HAND,
            ours_native / by_hand_native,
            larger_is_better=False,
        ),
    ]
    return Measured(found, claims)


def _ways(omega: NDArray[Any]) -> dict[str, Callable[[], NDArray[Any]]]:
    """Return the ways to compute the imaginary parts, without arguments."""
    model = pipeline.load(SPECIFICATION)
    made = C99.export(model, pipeline.derive_all(model), stem="exported_beam", is_alone=False)
    files = {"exported_beam.c": made.text, "exported_beam.h": made.companions[".h"], "by_hand.c": BY_HAND}
    module = exported_module()
    s = 1j * omega
    ways: dict[str, Callable[[], NDArray[Any]]] = {
        "`--to numpy`, `V_act_over_F(1j*omega)`": lambda: module.V_act_over_F(s).imag,
        "`--to numpy`, `V_act_over_F_at(omega)` in real arithmetic": lambda: (
            module.V_act_over_F_at(omega).imag
        ),
    }
    values = [module.PARAMETERS[name]["value"] for name in ("E", "I", "rho", "A", "l")]
    for name, flags in FLAGS.items():
        library = loaded(files, flags)
        ways[f"`--to c`, `V_act_over_F_freq`, {name}"] = responding(
            library, "exported_beam", "V_act_over_F", omega, 1
        )
        ways[f"C by hand, {name}"] = _by_hand(library, omega, values)
    return ways


def _by_hand(library: ctypes.CDLL, omega: NDArray[Any], values: list[float]) -> Callable[[], NDArray[Any]]:
    real, imag = np.empty_like(omega), np.empty_like(omega)
    arguments = (
        *map(pointer, (omega, real, imag)),
        ctypes.c_size_t(omega.size),
        *map(ctypes.c_double, values),
    )

    def run() -> NDArray[Any]:
        library.by_hand(*arguments)
        return imag

    return run
