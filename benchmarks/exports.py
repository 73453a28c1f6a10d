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
import subprocess
import sys
import tempfile
from pathlib import Path
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
from symflex.codegen.javascript import JAVASCRIPT

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

TASK = "exported C: sliding-free beam at a million frequencies"

FASTER_THAN_NUMPY = 2.5
SLOWER_THAN_BY_HAND = 1.3
SLOWER_THAN_C = 2.0

IN_C = """
#include <complex.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include "beam.h"

int main(int count, char **given)
{
    const size_t n = (size_t)atol(given[1]);
    double *omega = malloc(n * sizeof *omega), *out = malloc(2 * n * sizeof *out);
    if (count < 3 || fread(omega, sizeof *omega, n, fopen("omega", "rb")) != n) return 1;
    for (int round = 0; round < atoi(given[2]); round++) {
        const clock_t begin = clock();
        for (size_t i = 0; i < n; i++) {
            const double complex z = beam_V_act_over_F(omega[i] * I, &beam_defaults);
            out[2 * i] = creal(z);
            out[2 * i + 1] = cimag(z);
        }
        printf("%.9f\\n", (double)(clock() - begin) / CLOCKS_PER_SEC);
    }
    return out[n] == 0.25;
}
"""

IN_NODE = """
import { readFileSync } from "node:fs";
import { V_act_over_F } from "./beam.mjs";
const [n, rounds] = process.argv.slice(2).map(Number);
const omega = new Float64Array(readFileSync("omega").buffer.slice(0, 8 * n));
for (let round = 0; round < rounds; round++) {
    const begin = process.cpuUsage();
    V_act_over_F([new Float64Array(n), omega]);
    const { user, system } = process.cpuUsage(begin);
    console.log((user + system) / 1e6);
}
"""

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
    if shutil.which("node") is None:
        print("skipped, node is not installed: exported JavaScript", file=sys.stderr)
        return Measured(found, claims)
    (node, compiled), at_s = _at_complex_s(omega, rounds), f"{TASK}, as functions of s"
    found += [Measurement(at_s, "`--to js` in Node", node, extent.limit)]
    found += [Measurement(at_s, "`--to c`, -O2", compiled, extent.limit)]
    claim = "exported JavaScript in Node: times as long as exported C (`-O2`), as functions of s"
    claims.append(Claim(claim, SLOWER_THAN_C, node / compiled, larger_is_better=False))
    return Measured(found, claims)


def _at_complex_s(omega: NDArray[Any], rounds: int) -> tuple[float, float]:
    """Return the processor time that a million values at complex s take in Node and in C, at best."""
    model = pipeline.load(SPECIFICATION)
    tfs = pipeline.derive_all(model)
    c, js = C99.export(model, tfs, "beam", is_alone=False), JAVASCRIPT.export(model, tfs, "beam")
    sources = {"beam.h": c.companions[".h"], "beam.c": c.text, "main.c": IN_C}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        omega.tofile(folder / "omega")
        for file, text in {**sources, "beam.mjs": js.text, "main.mjs": IN_NODE}.items():
            (folder / file).write_text(text, encoding="utf-8")
        compiler = ["cc", "-std=c11", "-O2", "beam.c", "main.c", "-o", "beam", "-lm"]
        subprocess.run(compiler, cwd=folder, check=True)
        times = []
        for command in (["node", "main.mjs"], ["./beam"]):
            given = [*command, str(omega.size), str(rounds)]
            done = subprocess.run(given, cwd=folder, capture_output=True, text=True, check=True)
            times.append(min(map(float, done.stdout.split())))
    return times[0], times[1]


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
