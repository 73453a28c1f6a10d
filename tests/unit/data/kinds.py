"""Statistics of fits to data of every kind: complex, magnitude alone, records in time, exact, with coherence.

Sums over one to three modes, made without symflex, are written to files as instruments and simulators write
them, read and fitted with the number of resonances chosen. ``python -m tests.unit.data.kinds 200`` prints
the figures of ``docs/fit.md``: root mean squares of errors over standard errors, wrong numbers of resonances,
and resonances that are none in fits not called poor.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from scipy import signal

from tests.unit.data.laboratory import modal_sum, modes_apart

DIGITS = (6, 10, 15)


def drawn(random, number):
    """Return a driving point: its function, poles as rows of omega, zeta, the band [Hz] and the modes."""
    count = 1 + number % 3
    f_p, zeta_p = modes_apart(random, count, 1.2), random.uniform(0.005, 0.03, count)
    derivative = number // 3 % 3
    function, *_ = modal_sum(random, f_p, zeta_p, 0.0, np.ones(count), derivative)
    band = (f_p[0] * random.uniform(0.3, 0.6), f_p[-1] * random.uniform(1.4, 1.8))
    return function, np.column_stack((2 * np.pi * f_p, zeta_p)), band


def lines_of(random, number, poles, band):
    """Return frequencies [Hz], linear or logarithmic, a few of them in each peak."""
    narrowest = float(np.min(poles[:, 0] * poles[:, 1])) / np.pi
    count = int(np.clip((band[1] - band[0]) / narrowest * random.uniform(2, 6), 60, 600))
    return (np.linspace if number % 2 else np.geomspace)(*band, count)


def complex_noise(random, size):
    return (random.standard_normal(size) + 1j * random.standard_normal(size)) / np.sqrt(2)


def table(head, *columns, digits=9):
    rows = (",".join(f"{x:.{digits}g}" for x in row) for row in zip(*columns, strict=True))
    return "\n".join([head, *rows]) + "\n"


def of_complex(random, number):
    """Return a text of complex values with 1 to 5 % of noise, and the poles."""
    function, poles, band = drawn(random, number)
    f = lines_of(random, number, poles, band)
    h = function(2j * np.pi * f)
    size = np.abs(h) if number % 4 < 2 else np.exp(np.mean(np.log(np.abs(h))))
    h = h + random.uniform(0.01, 0.05) * size * complex_noise(random, f.size)
    return table("frequency_hz,re,im", f, h.real, h.imag), poles


def of_magnitude(random, number):
    """Return a text of levels with 0.1 to 0.4 dB of scatter, or of an averaged power spectrum."""
    function, poles, band = drawn(random, number)
    f = lines_of(random, number, poles, band)
    size = np.abs(function(2j * np.pi * f))
    if number % 4 < 2:
        level = 20 * np.log10(size) + random.uniform(0.1, 0.4) * random.standard_normal(f.size)
        return table("frequency_hz,magnitude_db", f, level), poles
    averages = int(random.integers(100, 1000))
    return table("freq,psd_x", f, size**2 * random.gamma(averages, 1 / averages, f.size)), poles


def of_coherence(random, number):
    """Return a text of an H1 estimate with its coherence, of averages that the file tells."""
    function, poles, band = drawn(random, number)
    f = lines_of(random, number, poles, band)
    h = function(2j * np.pi * f)
    averages = int(random.integers(20, 100))
    noise = random.uniform(0.05, 0.3) * np.exp(np.mean(np.log(np.abs(h))))
    u = complex_noise(random, (averages, f.size))
    y = h * u + noise * complex_noise(random, u.shape)
    cross, of_u, of_y = (np.conj(u) * y).sum(0), (abs(u) ** 2).sum(0), (abs(y) ** 2).sum(0)
    h, coherence = cross / of_u, abs(cross) ** 2 / of_u / of_y
    said = f"# averages: {averages}\n"
    return said + table("frequency_hz,re,im,coherence", f, h.real, h.imag, coherence), poles


def of_exact(random, number):
    """Return a text of values without noise, of 6, 10 or 15 digits."""
    function, poles, band = drawn(random, number)
    f = np.round(lines_of(random, number, poles, band), 4)
    h = function(2j * np.pi * f)
    return table("frequency_hz,re,im", f, h.real, h.imag, digits=DIGITS[number // 9 % 3]), poles


def modes_of(random, number):
    """Return poles, and residues of a sum of modes that are all seen."""
    count = 1 + number % 3
    f_p, zeta_p = modes_apart(random, count, 1.3), random.uniform(0.01, 0.04, count)
    return np.column_stack((2 * np.pi * f_p, zeta_p)), random.uniform(0.5, 1.0, count)


def of_step(random, number):
    """Return a record of a step response that comes to rest, with 0.1 to 1 % of white noise."""
    poles, sizes = modes_of(random, number)
    step = 2 * np.pi / poles[-1, 0] / random.uniform(16, 30)
    n = int(min(6 / np.min(poles[:, 0] * poles[:, 1]) / step, 8000))
    t = np.arange(-20, n) * step
    y = np.zeros(t.size)
    for (w, z), size in zip(poles, sizes, strict=True):
        p = w * (-z + 1j * np.sqrt(1 - z * z))
        y += size * (t >= 0) * (1 - np.real(np.exp(p * np.maximum(t, 0)) * np.conj(p) / (1j * p.imag)))
    y += random.uniform(0.001, 0.01) * np.std(y) * random.standard_normal(t.size)
    return table("time,u,y", t - t[0], (t >= 0).astype(float), y), poles


def of_noise(random, number):
    """Return a record of a system that band-limited noise drives, with 1 to 5 % of white noise."""
    poles, sizes = modes_of(random, number)
    over, step = 4, 2 * np.pi / poles[-1, 0] / 8
    n = int(np.clip(400 / np.min(poles[:, 0] * poles[:, 1]) / step, 4096, 40_000))
    u = signal.lfilter(*signal.butter(6, 0.8 / over), random.standard_normal((n + 4000) * over))
    y = np.zeros(u.size)
    for (w, z), size in zip(poles, sizes, strict=True):
        # Exact for an input that is straight between samples.
        system = signal.cont2discrete(([size * w * w], [1, 2 * z * w, w * w]), step / over, "foh")
        y += signal.lfilter(system[0].ravel(), system[1], u)
    u, y = u[4000 * over :: over], y[4000 * over :: over]
    y = y + random.uniform(0.01, 0.05) * np.std(y) * random.standard_normal(n)
    return table("time,u,y", np.arange(n) * step, u, y), poles


KINDS = {
    "complex": of_complex,
    "magnitude": of_magnitude,
    "step": of_step,
    "noise": of_noise,
    "exact": of_exact,
    "coherence": of_coherence,
}


def study(kind, count, seed=1, show=None):
    """Fit ``count`` sets; return errors over standard errors, wrong counts of resonances and phantoms."""
    import symflex  # the study's own code needs none of it

    off, wrong, phantoms = [], [], []
    for number in range(count):
        random = np.random.default_rng([seed, number, len(kind)])
        text, poles = KINDS[kind](random, number)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "data.csv"
            path.write_text(text, encoding="utf-8")
            begun = time.process_time()
            fit = symflex.fit(path, columns="f,mag_db" if "magnitude_db" in text else None)
        found, errors = fit.resonances, fit.standard_errors
        at = np.flatnonzero(fit.found.modes)
        own = np.zeros(0)
        is_wrong = at.size != len(poles) or (kind == "exact" and found.order != 2 * len(poles))
        if at.size >= len(poles):
            near = [at[np.argmin(np.abs(np.log(found.omega_p[at] / w)))] for w, _ in poles]
            own = np.concatenate(
                [
                    (found.omega_p[near] - poles[:, 0]) / errors.omega_p[near],
                    (found.zeta_p[near] - poles[:, 1]) / errors.zeta_p[near],
                ]
            )
        if not is_wrong:
            off.append(own)
        wrong += [number] * is_wrong
        phantoms += [number] * (at.size > len(poles) and not fit.poor)
        if show is not None:
            show(number, time.process_time() - begun, own, is_wrong, fit)
    return np.concatenate(off), wrong, phantoms


def main(arguments):
    """Print the figures of the kinds asked for."""
    count = int(arguments[0])

    def show(number, seconds, own, is_wrong, fit):
        if is_wrong or np.max(np.abs(own), initial=0) > 4 or fit.poor or seconds > 10:
            poles = f"{fit.found.modes.sum()} of {fit.resonances.order}"
            print(f"  {number:4d} {seconds:5.1f} s, {poles}: {np.round(own, 1)} {fit.poor}", flush=True)

    for kind in arguments[1:] or KINDS:
        begun = time.process_time()
        off, wrong, phantoms = study(kind, count, show=show)
        print(
            f"{kind}: rms {np.sqrt(np.mean(off**2)):.2f}, median {np.median(abs(off)) / 0.6745:.2f}, "
            f"wrong {len(wrong)} {wrong}, phantoms {len(phantoms)} {phantoms}, of {count}; "
            f"{(time.process_time() - begun) / count:.1f} s each",
            flush=True,
        )


if __name__ == "__main__":
    main(sys.argv[1:])
