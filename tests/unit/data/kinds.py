"""Statistics of fits to data of every kind: complex, magnitude alone, time records, exact, with coherence.

Sums over one to three modes, made without symflex, are written as instruments and simulators write them,
read, and fitted with the number of resonances chosen. ``python -m tests.tools.fits kinds 200``
prints the figures of ``docs/fit.md``.
"""

import tempfile
from pathlib import Path

import numpy as np
from scipy import signal

from tests.unit.data.laboratory import modal_sum, modes_apart


def complex_noise(random, size):
    return (random.standard_normal(size) + 1j * random.standard_normal(size)) / np.sqrt(2)


def table(head, *columns, digits=9):
    return "\n".join([head, *(",".join(f"{x:.{digits}g}" for x in row) for row in np.stack(columns).T)])


def of_lines(random, number, kind):
    """Return a text of values, levels, power spectra, or H1 estimates with their coherence, and the poles."""
    count = 1 + number % 3
    f_p, zeta_p = modes_apart(random, count, 1.2), random.uniform(0.005, 0.03, count)
    function, *_ = modal_sum(random, f_p, zeta_p, 0.0, np.ones(count), number // 3 % 3)
    low, high = f_p[0] * random.uniform(0.3, 0.6), f_p[-1] * random.uniform(1.4, 1.8)
    size = int(np.clip((high - low) / np.min(2 * f_p * zeta_p) * random.uniform(2, 6), 60, 600))
    f = np.round((np.linspace if number % 2 else np.geomspace)(low, high, size), 4)
    h, poles = function(2j * np.pi * f), np.column_stack((2 * np.pi * f_p, zeta_p))
    mean, is_additive = np.exp(np.mean(np.log(abs(h)))), number % 4 > 1
    if kind == "complex":
        h = h + random.uniform(0.01, 0.05) * (mean if is_additive else abs(h)) * complex_noise(random, size)
    if kind in ("complex", "exact"):
        digits = 9 if kind == "complex" else (6, 10, 15)[number // 9 % 3]
        return table("frequency_hz,re,im", f, h.real, h.imag, digits=digits), poles
    if kind == "magnitude" and is_additive:
        averages = int(random.integers(100, 1000))
        return table("freq,psd_x", f, abs(h) ** 2 * random.gamma(averages, 1 / averages, size)), poles
    if kind == "magnitude":
        level = 20 * np.log10(abs(h)) + random.uniform(0.1, 0.4) * random.standard_normal(size)
        return table("frequency_hz,magnitude_db", f, level), poles
    averages = int(random.integers(20, 100))
    u = complex_noise(random, (averages, size))
    y = h * u + random.uniform(0.05, 0.3) * mean * complex_noise(random, u.shape)
    cross, of_u, of_y = (np.conj(u) * y).sum(0), (abs(u) ** 2).sum(0), (abs(y) ** 2).sum(0)
    h, coherence = cross / of_u, abs(cross) ** 2 / of_u / of_y
    head = f"# averages: {averages}\nfrequency_hz,re,im,coherence"
    return table(head, f, h.real, h.imag, coherence), poles


def of_records(random, number, kind):
    """Return a text of a time record, and the poles; white noise is added.

    A step comes to rest, a hammer's decay does in every second record, noise drives all of its record, and a
    chirp all but the last fifth; noise is 0.1 to 1 % of the output, 1 to 5 % where noise drives.
    """
    count, over = 1 + number % 3, 4 if kind in ("step", "noise") else 16
    f_p, zeta_p = modes_apart(random, count, 1.3), random.uniform(0.01, 0.04, count)
    poles, sizes = np.column_stack((2 * np.pi * f_p, zeta_p)), random.uniform(0.5, 1.0, count)
    slowest = np.min(poles[:, 0] * zeta_p)
    step = 1 / f_p[-1] / (8 if kind == "noise" else random.uniform(16, 30))
    times = {"step": 6, "noise": 400, "hammer": 6 if number % 2 else 2.5, "chirp": 30}[kind]
    n = int(np.clip(times / slowest / step, 500, 40_000)) + 20
    t = (np.arange(n * over) - 20 * over) * step / over
    if kind == "step":
        u = (t >= 0).astype(float)
    elif kind == "hammer":
        u = np.where((t > 0) & (t < 6 * step), np.sin(np.pi * t / (6 * step)) ** 2, 0)
    elif kind == "chirp":
        u = signal.chirp(t, 0.3 * f_p[0], 0.8 * t[-1], 1.6 * f_p[-1])
        u *= np.interp(t / t[-1], [0, 0.02, 0.78, 0.8], [0, 1, 1, 0])
    else:
        u = signal.lfilter(*signal.butter(6, 0.8 / over), random.standard_normal((n + 4000) * over))
    y = np.zeros(u.size)
    for (w, z), size in zip(poles, sizes, strict=True):
        # Exact for an input that is constant, or straight, between finer samples.
        how = "zoh" if kind == "step" else "foh"
        top, bottom, _ = signal.cont2discrete(([size * w * w], [1, 2 * z * w, w * w]), step / over, how)
        y += signal.lfilter(top.ravel(), bottom, u)
    u, y = u[-n * over :: over], y[-n * over :: over]
    noise = random.uniform(*((0.01, 0.05) if kind == "noise" else (0.001, 0.01)))
    return table("time,u,y", np.arange(n) * step, u, y + noise * np.std(y) * random.standard_normal(n)), poles


KINDS = dict.fromkeys(("complex", "magnitude", "exact", "coherence"), of_lines)
KINDS |= dict.fromkeys(("step", "noise", "chirp", "hammer"), of_records)


def study(kind, count, seed=1, show=None):
    """Fit ``count`` sets; return errors over standard errors, sets of wrong order, and of phantoms.

    An order is wrong if the number of resonances is, or that of all poles of exact data. Phantoms are further
    resonances of a fit that is not called poor.
    """
    import symflex  # the data need none of it

    off, wrong, phantoms = [], [], []
    for number in range(count):
        text, poles = KINDS[kind](np.random.default_rng([seed, number, len(kind)]), number, kind)
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "data.csv").write_text(text, encoding="utf-8")
            fit = symflex.fit(
                Path(folder) / "data.csv", columns="f,mag_db" if "magnitude_db" in text else None
            )
        found, errors, at = fit.resonances, fit.standard_errors, np.flatnonzero(fit.found.modes)
        is_wrong = at.size != len(poles) or (kind == "exact" and found.order != 2 * len(poles))
        off += [] if is_wrong else [(found.omega_p[at] - poles[:, 0]) / errors.omega_p[at]]
        off += [] if is_wrong else [(found.zeta_p[at] - poles[:, 1]) / errors.zeta_p[at]]
        wrong += [number] * is_wrong
        phantoms += [number] * (at.size > len(poles) and not fit.poor)
        if show and (is_wrong or fit.poor or np.max(np.abs(off[-2:])) > 4):
            show(number, "wrong order" if is_wrong else np.round(off[-2:], 1).tolist(), fit.poor)
    return np.concatenate(off), wrong, phantoms
