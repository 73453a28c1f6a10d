"""The ten lowest poles of 10,000 sliding-free beams, against scipy's ``brentq`` and ``mpmath.findroot``.

Wall time, since processes of their own do the work; loading, drawing, solving on two processes, naming modes
and writing the file are all in it. The rivals get perfect brackets and guesses for the equation
tan x + tanh x = 0 of each beam and prove nothing.

Beams with a dashpot, which are not similar, and quarter cars are swept in one process, in processor time,
against a search of its own at every point; quarter cars also against ``numpy.roots``, which proves nothing.
"""

from __future__ import annotations

import math
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.measure import OWN, Claim, Extent, Measured, Measurement, run_snippet, times_as_fast
from symflex import pipeline
from symflex.model import Model
from symflex.options import SweepOptions
from symflex.roots import Modes
from symflex.sweep import Sweep, plan_sweep, read_design, run_sweep, sweep
from symflex.sweep.run import open_executor

POINTS, QUICK_POINTS = (2500, 5000, 10_000), (10_000,)
MODES = 10
WORKERS = 2
MPMATH_POINTS = 20
FASTER_THAN_FINDROOT = 3.0
FASTER_THAN_SEARCHES = 10.0
LINEAR_WITHIN = 1.2
CEILING = 20.0
"""Seconds for all 10,000 on two processors that do nothing else."""
SEARCHED = 50
MEBIBYTE = 1024
LARGEST_MEMORY = 1024.0
"""[MiB]."""
BEAM = Path(__file__).parents[1] / "derivations" / "eppinger1988" / "sliding_free_beam.toml"
CLASSICS = BEAM.parents[1] / "classics"
DAMPED = CLASSICS / "kelvin_voigt_cantilever.toml", "b=2:8:lin:{}", 5
CAR = CLASSICS / "quarter_car.toml", "c_s=500:3000:lin:{}", None
DAMPED_POINTS, DAMPED_SEARCHED = 100, 5
CAR_POINTS, CAR_SEARCHED = 1000, 100
FASTER_THAN_ALONE = {"damped beams": 6.0, "quarter cars": 2.0}
OVER = ("E=+-5%", "I=+-10%", "rho=7700:8000", "A=+-10%", "l=+-2%")
I_NOMINAL, A_NOMINAL = 4000e-12, 480e-6


def time_sweep(points: int) -> float:
    """Return the seconds for a sweep of so many points on two processes, file and all."""
    begin = time.perf_counter()
    model = pipeline.load(BEAM)
    given = SweepOptions(OVER, points, modes=MODES)
    task, design = plan_sweep(model, given)
    with tempfile.TemporaryDirectory() as folder, open_executor(WORKERS) as (executor, size):
        asked = replace(given, output=Path(folder) / "a.nc")
        found = sweep(task, design, asked, executor, workers=size)
    taken = time.perf_counter() - begin
    _check(found, points)
    return taken


def _check(found: Sweep, points: int) -> None:
    """Compare with the asymptotic wavenumbers, exact to 1e-3 from the first on and far better beyond."""
    if not found.is_certified or found["im"].shape != (points, MODES):
        message = "the sweep is not certified"
        raise RuntimeError(message)
    unit = np.sqrt(found["E"] * found["I"] / (found["rho"] * found["A"])) / found["l"] ** 2
    expected = np.array([x**2 for x in wavenumbers()])
    if not np.allclose(found["im"] / unit[:, None], expected, rtol=1e-12):
        message = "the poles do not agree with those of the characteristic equation"
        raise RuntimeError(message)


def wavenumbers() -> list[float]:
    """Return the roots of tan x + tanh x = 0."""
    from scipy.optimize import brentq  # slow to import

    return [
        float(brentq(_equation, (n - 0.5) * math.pi, n * math.pi, xtol=1e-15, rtol=1e-15))
        for n in range(1, MODES + 1)
    ]


def _equation(x: float) -> float:
    return math.sin(x) + math.cos(x) * math.tanh(x)


def _draws(points: int) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    return np.random.default_rng(1).uniform(0.9, 1.1, (points, 5))


def time_brentq(points: int) -> float:
    """Return the seconds of scipy for the same in one process, from brackets that hold one root each."""
    from scipy.optimize import brentq  # slow to import

    draws = _draws(points)
    begin = time.perf_counter()
    for e, i, rho, a, length in draws:
        share = math.sqrt(7850 * rho * A_NOMINAL * a / (200e9 * e * I_NOMINAL * i)) * (1.086 * length) ** 2

        def equation(omega: float, share: float = share) -> float:
            return _equation(math.sqrt(omega * share))

        for n in range(1, MODES + 1):
            ends = [((n - part) * math.pi) ** 2 / share for part in (0.5, 0.0)]
            brentq(equation, *ends, xtol=1e-12, rtol=1e-15)
    return time.perf_counter() - begin


def time_findroot(points: int) -> float:
    """Return the seconds of mpmath for the same at 20 digits, from guesses right to double precision."""
    import mpmath  # slow to import
    from mpmath import mp, mpf

    guesses, draws = wavenumbers(), _draws(MPMATH_POINTS)
    begin = time.perf_counter()
    with mp.workdps(20):
        for e, i, rho, a, length in draws:
            share = mpmath.sqrt(7850 * mpf(rho) * A_NOMINAL * a / (200e9 * mpf(e) * I_NOMINAL * i))
            share *= (mpf("1.086") * length) ** 2

            def equation(omega: mpf, share: mpf = share) -> mpf:
                x = mpmath.sqrt(omega * share)
                return mpmath.sin(x) + mpmath.cos(x) * mpmath.tanh(x)

            for x in guesses:
                mpmath.findroot(equation, mpf(x) ** 2 / share)
    return (time.perf_counter() - begin) * points / MPMATH_POINTS


def time_searches(points: int) -> float:
    """Return the seconds of a certified search at every point, in one process, extrapolated."""
    model = pipeline.load(BEAM)
    design = read_design(model.parameters, OVER, SEARCHED)
    (tf,) = pipeline.derive_all(model, model.transfer_functions[:1])
    begin = time.perf_counter()
    for point in design.points:
        bound = pipeline.bind(
            tf,
            {
                n: str(v.rational.numerator / v.rational.denominator)
                for n, v in zip(design.names, point, strict=True)
            },
        )
        pipeline.roots(bound, Modes(MODES))
    return (time.perf_counter() - begin) * points / SEARCHED


def time_along(name: str) -> float:
    """Return the processor time [s] of a sweep in one process, from the derivation to the names of modes."""
    path, over, modes = {"damped beams": DAMPED, "quarter cars": CAR}[name]
    points = DAMPED_POINTS if modes else CAR_POINTS
    model = pipeline.load(path)
    task, design = plan_sweep(model, SweepOptions((over.format(points),), modes=modes, tf=_first(model)))
    begin = time.process_time()
    found = run_sweep(task, design)
    taken = time.process_time() - begin
    if not found.is_certified:
        message = "the sweep is not certified"
        raise RuntimeError(message)
    return taken


def time_alone(name: str) -> float:
    """Return the processor time [s] of binding and a certified search at every point, extrapolated."""
    path, over, modes = {"damped beams": DAMPED, "quarter cars": CAR}[name]
    points, searched = (DAMPED_POINTS, DAMPED_SEARCHED) if modes else (CAR_POINTS, CAR_SEARCHED)
    model = pipeline.load(path)
    design = read_design(model.parameters, (over.format(searched),))
    (tf,) = pipeline.derive_all(model, model.transfer_functions[:1])
    begin = time.process_time()
    for point in design.points:
        bound = pipeline.bind(tf, dict(zip(design.names, point, strict=True)))
        pipeline.roots(bound, Modes(modes) if modes else None)
    return (time.process_time() - begin) * points / searched


def time_car_by_numpy() -> float:
    """Return the processor time [s] of ``numpy.roots`` for as many quarter cars, coefficients included."""
    m_s, m_u, k_s, k_t = 300.0, 40.0, 20e3, 180e3
    begin = time.process_time()
    for c_s in np.linspace(500, 3000, CAR_POINTS):
        np.roots([m_s * m_u, (m_s + m_u) * c_s, m_s * k_t + (m_s + m_u) * k_s, c_s * k_t, k_s * k_t])
    return time.process_time() - begin


def _first(model: Model) -> str:
    return "/".join(model.transfer_functions[0])


def peak_memory(points: int) -> float:
    """Return the largest memory [MiB] of this process during a sweep, or of one of its workers."""
    time_sweep(points)
    who = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    return max(resource.getrusage(each).ru_maxrss for each in who) / MEBIBYTE


def measure(extent: Extent) -> Measured:
    """Measure the sweeps, each way within the limit; a quick run has the largest alone."""
    limit = extent.limit
    measurements: list[Measurement] = []

    def run(task: str, way: str, call: str, limit: float = limit) -> Measurement:
        result = _run(task, way, call, limit)
        measurements.append(result)
        return result

    task = f"sweep of sliding-free beams, {MODES} poles each, {WORKERS} processes"
    points = extent.of(POINTS, QUICK_POINTS)
    wholes = {n: run(task, f"{n} points", f"time_sweep({n})", max(limit, OWN)) for n in points}
    most = points[-1]
    whole = wholes[most]
    task = f"{MODES} poles of {most} sliding-free beams"
    measurements.append(
        Measurement(task, f"symflex sweep, certified, {WORKERS} processes", whole.seconds, whole.limit)
    )
    way = f"`mpmath.findroot` at 20 digits, guesses given (from {MPMATH_POINTS})"
    findroot = run(task, way, f"time_findroot({most})")
    way = f"a certified search at every point, one process (from {SEARCHED})"
    searches = run(task, way, f"time_searches({most})")
    name = f"sweep of {most} beams"
    claims = [
        Claim(f"{name}: times as fast as `findroot`", FASTER_THAN_FINDROOT, times_as_fast(whole, findroot)),
        Claim(f"{name}: times as fast as searches", FASTER_THAN_SEARCHES, times_as_fast(whole, searches)),
    ]
    for name, count in (("damped beams", DAMPED_POINTS), ("quarter cars", CAR_POINTS)):
        own_task = f"poles of {count} {name}, one process"
        ours = run(own_task, "symflex sweep, certified", f"time_along({name!r})", max(limit, OWN))
        alone = run(own_task, "a certified search at every point, extrapolated", f"time_alone({name!r})")
        text = f"sweep of {count} {name}: times as fast as searches"
        claims.append(Claim(text, FASTER_THAN_ALONE[name], times_as_fast(ours, alone)))
    if extent.is_quick:
        return Measured(measurements, claims)
    run(own_task, "`numpy.roots`, nothing certified", "time_car_by_numpy()")
    run(task, "scipy `brentq`, brackets given, one process", f"time_brentq({most})")
    # Differences would tell more, but small ones are mostly noise.
    growth = whole.taken / (2 * wholes[most // 2].taken)
    text = f"{name}: time per point over that of half as many"
    claims.append(Claim(text, LINEAR_WITHIN, growth, larger_is_better=False))
    claims.append(Claim(f"{name} [s]", CEILING, whole.taken, larger_is_better=False, is_ratio=False))
    try:
        memory = _run(task, "memory", f"peak_memory({most})", max(limit, OWN)).taken
    except subprocess.CalledProcessError as failure:
        print(f"not done: memory of a sweep: {failure.stderr[-200:]}", file=sys.stderr)
        memory = math.nan
    text = f"{name}: largest memory of a process [MiB]"
    claims.append(Claim(text, LARGEST_MEMORY, memory, larger_is_better=False, is_ratio=False))
    return Measured(measurements, claims)


def _run(task: str, way: str, call: str, limit: float) -> Measurement:
    """Measure a call of this module; processes that it starts import it again."""
    code = f"from benchmarks import sweep\nif __name__ == '__main__':\n    print(sweep.{call})"
    return run_snippet(task, way, code, limit)
