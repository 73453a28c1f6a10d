"""Simulated frequency responses of every shape a laboratory produces, with what is true of them.

Nothing here comes from symflex: responses are sums over modes or products of second-order factors, zeros are
roots of their numerators, and the statistics compare plain numbers. There is no coherence and no base.

``python -m tests.tools.fits lines 500`` runs the study whose figures stand in ``docs/fit.md``; with ``500
1 wild`` that with modes outside the band, wild lines and real poles.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from math import erf, sqrt

import numpy as np

SHAPES = (
    "product",
    "driving point",
    "transfer",
    "without zeros",
    "free driving point",
    "integrator",
    "double integrator",
    "delay",
    "close modes",
    "few lines",
)
NOISE_PERCENT = (1, 2, 3, 4, 5)
THREE_SIGMA = erf(3 / sqrt(2))


@dataclass(frozen=True)
class Case:
    """A data set: lines, values with noise, and the truth behind them; frequencies in rad/s."""

    shape: str
    frequency_hz: np.ndarray
    values: np.ndarray
    poles: np.ndarray  # rows of omega, zeta
    zeros: np.ndarray  # complex pairs within the band, rows of omega, zeta
    slope: int
    gain: float
    delay: float | None
    noise_percent: int
    is_logarithmic: bool
    is_additive: bool
    real_pole: float | None = None  # rad/s
    wild: int | None = None  # the line that is
    has_mode_outside: bool = False


def pair(s, omega, zeta):
    """Return a second-order factor with unit value at s = 0."""
    return 1 + 2 * zeta * s / omega + (s / omega) ** 2


def modes_apart(random, count, least):
    """Return natural frequencies [Hz] with a ratio between neighbours of at least ``least``."""
    return random.uniform(8, 16) * np.cumprod(np.append(1, least + random.uniform(0.05, 0.7, count - 1)))


def modal_sum(random, f_p, zeta_p, rigid, signs, derivative):
    """Return function, zeros, slope and gain of s^derivative (rigid/s^2 + sum phi/(s^2 + ...))."""
    omega = 2 * np.pi * f_p
    phi = signs * random.uniform(0.3, 1.0, f_p.size)
    factors = [np.array([1, 2 * z * w, w * w]) for w, z in zip(omega, zeta_p, strict=True)]
    if rigid:
        factors, phi = [np.array([1.0, 0, 0]), *factors], np.append(rigid, phi)
    numerator = np.zeros(1)
    for i, one in enumerate(phi):
        rest = np.ones(1)
        for k, factor in enumerate(factors):
            rest = np.polymul(rest, factor) if k != i else rest
        numerator = np.polyadd(numerator, one * rest)
    roots = np.roots(numerator)

    def function(s):
        total = 0
        for one, factor in zip(phi, factors, strict=True):
            total = total + one / np.polyval(factor, s)
        return s**derivative * total

    if rigid:
        gain = rigid
    else:
        gain = float(np.sum(phi / omega**2))
    return function, roots, derivative - (2 if rigid else 0), gain


def product(random, f_p, zeta_p, slope, between):
    """Return function, zeros, slope and gain of g s^slope times resonances."""
    count = f_p.size
    edges = np.append(f_p, f_p[-1] * 1.35)
    f_z = edges[:-1] + random.uniform(0.25, 0.75, count) * np.diff(edges)
    kept = random.permutation(count)[: count if between else 0]
    omega_z, zeta_z = 2 * np.pi * f_z[kept], random.uniform(0.005, 0.04, kept.size)
    gain = float(random.choice([-1, 1]) * 10 ** random.uniform(-3, 3))

    def function(s):
        value = gain * s ** float(slope)
        for w, z in zip(omega_z, zeta_z, strict=True):
            value = value * pair(s, w, z)
        for f, z in zip(f_p, zeta_p, strict=True):
            value = value / pair(s, 2 * np.pi * f, z)
        return value

    roots = omega_z * (-zeta_z + 1j * np.sqrt(1 - zeta_z**2))
    return function, np.concatenate((roots, np.conj(roots))), slope, gain


def simulated(seed, number):
    """Return one data set; shapes, noise and spacing take turns, the rest is drawn."""
    random = np.random.default_rng([seed, number])
    shape = SHAPES[number % len(SHAPES)]
    while True:
        case = _drawn(random, shape, number)
        if case is not None:
            return case


def _drawn(random, shape, number):
    count = int(random.integers(1, 5)) if shape != "close modes" else int(random.integers(2, 4))
    f_p = modes_apart(random, count, 1.15)
    zeta_p = random.uniform(0.004, 0.03, count)
    derivative = int(random.integers(0, 3))
    delay = None
    if shape == "close modes":
        # Peaks that overlap: one to three half-power bandwidths apart.
        f_p[1] = f_p[0] * (1 + 2 * zeta_p[:2].mean() * random.uniform(1.0, 3.0))
        f_p = np.sort(f_p)
    if shape in ("product", "delay"):
        found = product(random, f_p, zeta_p, int(random.integers(-2, 3)), between=True)
    elif shape == "without zeros":
        found = product(random, f_p, zeta_p, derivative, between=False)
    elif shape in ("integrator", "double integrator"):
        found = product(random, f_p, zeta_p, -1 if shape == "integrator" else -2, between=True)
    elif shape == "free driving point":
        found = modal_sum(random, f_p, zeta_p, random.uniform(0.3, 1.0), np.ones(count), derivative)
    elif shape == "transfer":
        signs = random.choice([-1.0, 1.0], count)
        found = modal_sum(random, f_p, zeta_p, 0.0, signs, derivative)
    else:
        found = modal_sum(random, f_p, zeta_p, 0.0, np.ones(count), derivative)
    function, roots, slope, gain = found
    low, high = f_p[0] * random.uniform(0.2, 0.5), f_p[-1] * random.uniform(1.4, 2.0)
    narrowest = float(np.min(2 * zeta_p * f_p))
    is_logarithmic = number // len(SHAPES) % 2 == 1
    per_peak = random.uniform(1.0, 2.5) if shape == "few lines" else random.uniform(4.0, 10.0)
    lines = int(np.clip((high - low) / narrowest * per_peak, 40, 1500))
    if is_logarithmic:
        frequency = np.geomspace(low, high, int(np.clip(lines * 0.7, 40, 1000)))
    else:
        frequency = np.linspace(low, high, lines)
    in_hz = np.abs(roots) / (2 * np.pi)
    if np.any(in_hz < 1.2 * low):
        return None  # a zero below the band hides the gain
    if shape == "delay":
        delay = float(random.uniform(0.05, 1.5) / high)
    s = 2j * np.pi * frequency
    exact = function(s) * np.exp(-s * (delay or 0.0))
    percent = NOISE_PERCENT[number // (2 * len(SHAPES)) % len(NOISE_PERCENT)]
    is_additive = bool(number // 3 % 3 == 0)
    size = np.exp(np.mean(np.log(np.abs(exact)))) if is_additive else np.abs(exact)
    # Percent of the magnitude, real and imaginary part together.
    error = random.standard_normal(frequency.size) + 1j * random.standard_normal(frequency.size)
    values = exact + percent / 100 * size * error / sqrt(2)
    upper = roots[(roots.imag > 0.2 * np.abs(roots)) & (in_hz < high)]
    order = np.argsort(np.abs(upper))
    zeros = np.column_stack((np.abs(upper), -upper.real / np.abs(upper)))[order]
    poles = np.column_stack((2 * np.pi * f_p, zeta_p))
    return Case(
        shape, frequency, values, poles, zeros, slope, gain, delay, percent, is_logarithmic, is_additive
    )


def wild(seed, number):
    """Return a data set of one to four modes with what surrounds them in a laboratory.

    A half has a mode outside the band, a third a wild line, a quarter a real pole.
    """
    random = np.random.default_rng([seed, number, 7])
    while True:
        count = int(random.integers(1, 5))
        f_p = modes_apart(random, count, 1.15)
        zeta_p = random.uniform(0.004, 0.03, count)
        low, high = f_p[0] * random.uniform(0.3, 0.6), f_p[-1] * random.uniform(1.3, 1.8)
        is_outside = number % 2 == 0
        every, every_zeta = f_p, zeta_p
        if is_outside:
            beyond = (
                high * random.uniform(1.1, 2.5) if random.random() < 0.7 else low * random.uniform(0.4, 0.9)
            )
            every, every_zeta = np.append(f_p, beyond), np.append(zeta_p, random.uniform(0.004, 0.03))
        signs = np.ones(every.size) if random.random() < 0.5 else random.choice([-1.0, 1.0], every.size)
        function, roots, slope, gain = modal_sum(
            random, every, every_zeta, 0.0, signs, int(random.integers(0, 3))
        )
        in_hz = np.abs(roots) / (2 * np.pi)
        if not np.any((in_hz > 0) & (in_hz < 1.2 * low)):
            break
    corner = 2 * np.pi * float(random.uniform(1.3 * low, high / 1.3)) if number % 4 == 1 else None
    narrowest = float(np.min(2 * zeta_p * f_p))
    lines = int(np.clip((high - low) / narrowest * random.uniform(3.0, 8.0), 60, 1500))
    is_logarithmic = number // 3 % 2 == 1
    frequency = (np.geomspace if is_logarithmic else np.linspace)(low, high, lines)
    s = 2j * np.pi * frequency
    exact = function(s) / (1 if corner is None else 1 + s / corner)
    percent = NOISE_PERCENT[number % len(NOISE_PERCENT)]
    is_additive = number // 5 % 3 == 0
    size = np.exp(np.mean(np.log(np.abs(exact)))) if is_additive else np.abs(exact)
    error = random.standard_normal(lines) + 1j * random.standard_normal(lines)
    values = exact + percent / 100 * size * error / sqrt(2)
    line = None
    if number % 3 == 0:
        line = int(random.choice([0, lines - 1, random.integers(0, lines)]))
        values[line] *= 10 ** random.uniform(0.7, 2) * np.exp(2j * np.pi * random.random())
    upper = roots[(roots.imag > 0.2 * np.abs(roots)) & (in_hz > low) & (in_hz < high)]
    upper = upper[np.argsort(np.abs(upper))]
    return Case(
        "wild",
        frequency,
        values,
        np.column_stack((2 * np.pi * f_p, zeta_p)),
        np.column_stack((np.abs(upper), -upper.real / np.abs(upper))),
        slope,
        gain,
        None,
        percent,
        is_logarithmic,
        is_additive,
        corner,
        line,
        is_outside,
    )


def deviations(case, poles, zeros, slope, gain, delay):
    """Return by how many standard errors each parameter is off; infinity for what is missing or wrong.

    ``poles`` and ``zeros`` are rows of omega, its error, zeta, its error; ``gain``, ``delay`` value, error.
    """
    found = []
    if len(poles) != len(case.poles):
        return np.full(2 * len(case.poles) + 1, np.inf)
    for true, got in zip(case.poles, poles, strict=True):
        found += [(got[0] - true[0]) / got[1], (got[2] - true[1]) / got[3]]
    for omega, zeta in case.zeros:
        # The nearest in the plane: two pairs may lie at the same frequency on either side of the axis.
        near = min(zeros, key=lambda z, w=omega, d=zeta: np.hypot(z[0] / w - 1, z[2] - d), default=None)
        if near is None or not near[1] < near[0]:
            found += [np.inf]
            continue
        found += [(near[0] - omega) / near[1], (near[2] - zeta) / near[3]]
    if not case.has_mode_outside:
        found.append((gain[0] - case.gain) / gain[1] if slope == case.slope else np.inf)
    if case.delay is not None:
        found.append((delay[0] - case.delay) / delay[1])
    return np.abs(np.array(found))


def limit_for(count):
    """Return the limit that all of ``count`` parameters keep as likely as one keeps three standard errors."""
    low, high = 3.0, 6.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if erf(middle / sqrt(2)) ** count < THREE_SIGMA else (low, middle)
    return high


def judged(case, fit):
    """Return the deviations of a fit, and whether it says that it is poor."""
    found, errors = fit.resonances, fit.standard_errors()
    poles = np.column_stack((found.omega_p, errors.omega_p, found.zeta_p, errors.zeta_p))[fit.modes]
    kept = np.isfinite(found.omega_z[0]) & (found.omega_z[0] > 0)
    zeros = np.column_stack((found.omega_z[0], errors.omega_z[0], found.zeta_z[0], errors.zeta_z[0]))[kept]
    gain = (found.gain[0], errors.gain[0])
    delay = (found.delay[0], errors.delay[0])
    off = deviations(case, poles, zeros, fit.bases[0].slope, gain, delay)
    if case.real_pole is not None:
        near = min(fit.real_poles(), key=lambda p: abs(np.log(p[0] / case.real_pole)), default=(0.0, 1e-99))
        off = np.append(off, abs(near[0] - case.real_pole) / near[1])
    return off, bool(fit.poor)


def study(count, seed=1, *, modes_given=True, show=None, first=0, draw=simulated):
    """Fit ``count`` data sets; return per data set its shape, deviations and verdict."""
    from symflex.data.fitting import fit_resonances
    from symflex.data.measurement import MeasuredResponse
    from symflex.errors import SymflexError
    from symflex.options import FitOptions

    results = []
    for number in range(first, first + count):
        case = draw(seed, number)
        data = MeasuredResponse("y/u", case.frequency_hz, case.values)
        more = {"is_delay_free": True} if case.delay is not None else {}
        try:
            fit = fit_resonances(
                [data], None, FitOptions(modes=len(case.poles) if modes_given else None, **more)
            )
            off, poor = judged(case, fit)
            words = "; ".join(fit.poor)
        except SymflexError as error:
            off, poor, words = np.array([np.inf]), True, error.diagnostics[0].code
        results.append((case.shape, off, poor))
        if show is not None:
            show(number, case, off, poor, words)
    return results


def summary(results):
    """Return the shares that matter, as a dictionary."""
    every = np.concatenate([off for _, off, _ in results])
    said = [poor for _, _, poor in results]
    joint = [bool(off.max() <= limit_for(off.size)) for _, off, _ in results]
    plain = [bool(off.max() <= 3) for _, off, _ in results]
    expected = [THREE_SIGMA**off.size for _, off, _ in results]
    return {
        "data sets": len(results),
        "parameters": int(every.size),
        "parameters within three standard errors": float(np.mean(every <= 3)),
        "parameters within one": float(np.mean(every <= 1)),
        "data sets with every parameter within three": float(np.mean(plain)),
        "the same, had errors been exact": float(np.mean(expected)),
        "data sets right, jointly": float(np.mean(joint)),
        "right and called poor": int(sum(j and p for j, p in zip(joint, said, strict=True))),
        "wrong and called poor": int(sum(not j and p for j, p in zip(joint, said, strict=True))),
        "wrong and not called poor": int(sum(not j and not p for j, p in zip(joint, said, strict=True))),
        "wrong, by shape": dict(
            Counter(shape for (shape, _, _), j in zip(results, joint, strict=True) if not j)
        ),
    }
