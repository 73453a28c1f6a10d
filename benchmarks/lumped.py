"""Exported code of a lumped chain against python-control and scipy, in time and in digits.

The function is V_tip/F of six masses (derivations/eppinger1988), of degree eleven. python-control's
``TransferFunction`` and ``scipy.signal.freqs`` evaluate the polynomials' coefficients, ``freqs_zpk`` poles
and zeros as symflex proved them. By hand, in numpy and in C, it is Holzer's recurrence along the chain
(1921). All ways run in one process and take turns; each counts with its fastest run, in processor time. The
error of each is measured as that of an export: the worst ``|dG| / (|G| (1 + |s G'/G|))`` over the band and
beside resonances, against balls.
"""

from __future__ import annotations

import ctypes
import math
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.signal

import symflex
from benchmarks.generated import FLAGS, imported, loaded, pointer
from benchmarks.measure import Claim, Extent, Measured, Measurement, fastest
from symflex import pipeline
from symflex.codegen.c.module import C99
from symflex.codegen.program.verify import measure_values
from symflex.codegen.python.module import NUMPY

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Way = Callable[[NDArray[Any]], NDArray[Any]]

SPECIFICATION = Path(__file__).parents[1] / "derivations" / "eppinger1988" / "six_mass.toml"
POINTS = 1_000_000
BAND_HZ = (1.0, 200.0)
"""The band of the model's ``[analysis]``, sampled as a Bode diagram is."""
ROUNDS, QUICK_ROUNDS = 7, 3
TASK = "six masses at a million frequencies"
AGREEMENT = 1e-12
"""Median of the relative differences between the ways, or they would not do the same."""

OURS, CONTROL, FREQS = "`--to numpy`", "`control.TransferFunction`", "`scipy.signal.freqs`"

FASTER_THAN_TOOLBOXES = 1.0
C_FASTER_THAN_TOOLBOXES = {"-O2": 1.5, "-O2 -march=native": 2.5}
DIGITS_MORE = 1.0
SLOWER_THAN_BY_HAND = 1.3

BY_HAND = r"""
#include <complex.h>
#include <stddef.h>

void by_hand(const double *omega, double *real, double *imag, size_t n,
             const double *m, const double *k, const double *b)
{
    for (size_t i = 0; i < n; i++) {
        const double complex s = omega[i] * I;
        double complex x = 1.0, f = m[5] * s * s;
        for (int j = 4; j >= 0; j--) {
            x += f / (k[j] + b[j] * s);
            f += m[j] * s * s * x;
        }
        const double complex g = s / f;
        real[i] = creal(g);
        imag[i] = cimag(g);
    }
}
"""


def measure(extent: Extent) -> Measured:
    """Measure all ways, as many rounds as fit in the limit, and compare.

    Raises
    ------
    RuntimeError
        When the ways do not compute the same function.
    """
    s = 2j * math.pi * np.geomspace(*BAND_HZ, POINTS)
    (tf,) = (tf for tf in pipeline.derive_all(pipeline.load(SPECIFICATION)) if tf.name == "V_tip/F")
    ways = _ways()
    errors = {name: measure_values(tf, _listed(way), name).error or math.inf for name, way in ways.items()}
    runs = {name: _run(way, s) for name, way in ways.items()}
    best = fastest(runs, extent.limit, rounds=extent.of(ROUNDS, QUICK_ROUNDS), agreement=AGREEMENT)
    found = [
        Measurement(TASK, f"{name}, error {errors[name]:.1e}", taken, extent.limit)
        for name, taken in best.items()
    ]
    claims = []
    for name in (CONTROL, FREQS):
        claims += [
            Claim(
                f"six masses, `--to numpy`: times as fast as {name}",
                FASTER_THAN_TOOLBOXES,
                best[name] / best[OURS],
            ),
            Claim(
                f"six masses: decimal digits that {name} loses",
                DIGITS_MORE,
                math.log10(errors[name] / errors[OURS]),
            ),
        ]
    for flags in FLAGS:
        if (exported := f"`--to c`, {flags}") not in best:
            continue
        claims += [
            Claim(
                f"six masses, C (`{flags}`): times as fast as {CONTROL}",
                C_FASTER_THAN_TOOLBOXES[flags],
                best[CONTROL] / best[exported],
            ),
            Claim(
                f"six masses, C (`{flags}`): times as long as C by hand",
                SLOWER_THAN_BY_HAND,
                best[exported] / best[f"C by hand, {flags}"],
                larger_is_better=False,
            ),
        ]
    return Measured(found, claims)


def _listed(way: Way) -> Callable[[NDArray[Any]], list[complex]]:
    return lambda s: [complex(value) for value in way(s)]


def _run(way: Way, s: NDArray[Any]) -> Callable[[], NDArray[Any]]:
    return lambda: way(s)


def _ways() -> dict[str, Way]:
    """Return the ways to compute values, each of an array of s on the axis."""
    model = pipeline.load(SPECIFICATION)
    tfs = pipeline.derive_all(model)
    bound = symflex.load(SPECIFICATION).transfer_function("V_tip", "F").bind()
    module = imported(NUMPY.export(model, tfs).text, "exported_chain")
    system: Any = bound.to_control()
    num, den = system.num[0][0], system.den[0][0]
    roots: Any = bound.to_scipy()
    values = {name: float(row["value"]) for name, row in module.PARAMETERS.items()}
    m, k, b = ([values[f"{letter}_{i + 1}"] for i in range(6 - (letter != "m"))] for letter in "mkb")
    ways: dict[str, Way] = {
        OURS: module.V_tip_over_F,
        "numpy by hand": lambda s: by_hand(s, m, k, b),
        CONTROL: system,
        FREQS: lambda s: scipy.signal.freqs(num, den, s.imag)[1],
        "`scipy.signal.freqs_zpk`": lambda s: scipy.signal.freqs_zpk(
            roots.zeros, roots.poles, roots.gain, s.imag
        )[1],
    }
    if shutil.which("cc") is None:
        print("skipped, there is no C compiler `cc`: exported C of six masses", file=sys.stderr)
        return ways
    made = C99.export(model, tfs, stem="six", is_alone=False)
    files = {"six.c": made.text, "six.h": made.companions[".h"], "by_hand.c": BY_HAND}
    chain = [(ctypes.c_double * len(row))(*row) for row in (m, k, b)]
    for name, flags in FLAGS.items():
        library = loaded(files, flags)
        defaults = ctypes.byref(ctypes.c_double.in_dll(library, "six_defaults"))
        ways[f"`--to c`, {name}"] = _compiled(library.six_V_tip_over_F_freq, defaults)
        ways[f"C by hand, {name}"] = _compiled(library.by_hand, *chain)
    return ways


def by_hand(s: NDArray[Any], m: list[float], k: list[float], b: list[float]) -> NDArray[Any]:
    """Return V_tip/F of the chain as a careful person would write it."""
    square = s * s
    x: Any = 1.0
    f = m[5] * square
    for j in range(4, -1, -1):
        x = x + f / (k[j] + b[j] * s)
        f = f + m[j] * square * x
    quotient: NDArray[Any] = s / f
    return quotient


def _compiled(function: Any, *more: Any) -> Way:  # noqa: ANN401
    """Return a way that fills arrays of real and imaginary parts."""

    def run(s: NDArray[Any]) -> NDArray[Any]:
        omega, real, imag = np.ascontiguousarray(s.imag), np.empty(s.shape), np.empty(s.shape)
        function(*map(pointer, (omega, real, imag)), ctypes.c_size_t(s.size), *more)
        return real + 1j * imag

    return run
