"""Statistics of fits to records in time of every kind that a laboratory makes.

The simulator is exact: modes take held or joined samples of the input to the next sample by matrix
exponentials. It shares no code with symflex. ``python -m tests.tools.fits records 40`` prints the figures of
``docs/fit.md``.
"""

import tempfile
from pathlib import Path

import numpy as np
from scipy.linalg import expm
from scipy.signal import lfilter

OF_INPUT = {"step": "step", "chirp": "chirp", "multisine": "multisine", "double hit": "hits"}
KINDS = (
    "close", "delay", "0 dB", "short", "hum", "drift", "lost samples", "8 bits", "closed loop", "damped",
    "alias", *OF_INPUT,
)  # fmt: skip


def stepped(omega, zeta, step, is_joined, delay):
    """Return what takes x'' + 2 zeta omega x' + omega^2 x = v(t - delay) over a sample, and what v adds.

    The state is (x, x'); v is weighted one sample before, at the sample, and one behind it; delay < step.
    """
    matrix = np.zeros((4, 4))
    matrix[:2] = [[0, 1, 0, 0], [-omega * omega, -2 * zeta * omega, 1, 0]]
    matrix[2, 3] = 1

    def over(time):
        power = expm(matrix * time)
        return power[:2, :2], power[:2, 2], power[:2, 3]

    (first, level, ramp), (second, level_2, ramp_2) = over(delay), over(step - delay)
    if not is_joined:
        return second @ first, (second @ level, level_2, 0 * level)
    share = delay / step
    before = second @ (level * share - ramp / step)
    at = second @ (level * (1 - share) + ramp / step) + level_2 - ramp_2 / step
    return second @ first, (before, at, ramp_2 / step)


def response(modes, u, step, is_joined, delay=0.0, start=None):
    """Return the output of modes (omega, zeta, b0, b1), (b0 + b1 s)/(s^2 + ...), from rest or a start."""
    whole = int(delay / step + 1e-12)
    n = u.size
    padded = np.concatenate((np.full(whole + 1, u[0]), u, u[-1:]))
    y = np.zeros(n)
    for omega, zeta, b0, b1 in modes:
        matrix, weights = stepped(omega, zeta, step, is_joined, delay - whole * step)
        values, vectors = np.linalg.eig(matrix)
        driven = sum(np.outer(w, padded[k : k + n]) for k, w in enumerate(weights))
        state = np.array([u[0], 0.0] if start is None else start) / omega**2 * (1, omega)
        driven, state = np.linalg.solve(vectors, driven), np.linalg.solve(vectors, state)
        along = [
            lfilter([0, 1], [1, -z], f) + x * z ** np.arange(n)
            for z, f, x in zip(values, driven, state, strict=True)
        ]
        y += ((b0, b1) @ (vectors @ along)).real
    return y


def of_input(random, source, n, step, f):
    """Return an input by its kind."""
    t, end = np.arange(n) * step, 0.4 / step
    if source == "switched":
        return np.repeat(random.choice([-1.0, 1.0], n), int(random.integers(1, 4)))[:n]
    if source == "white":
        return random.standard_normal(n)
    if source == "chirp":
        return np.sin(2 * np.pi * (0.3 * f[0] * t + (min(1.5 * f[-1], end) - 0.3 * f[0]) * t * t / 2 / t[-1]))
    if source == "step":
        return (np.arange(n) >= random.choice([1, 20])) * random.uniform(0.5, 2)
    if source == "hits":
        u = np.zeros(n)
        for at in (20, 20 + int(random.integers(15, 120))):
            width = int(random.integers(3, 6))
            u[at : at + width + 1] += (
                random.uniform(0.5, 1.5) * np.sin(np.pi * np.arange(width + 1) / width) ** 2
            )
        return u
    period = n // 4
    first, last = max(1, 0.5 * f[0] * period * step), min(1.3 * f[-1] * period * step, 0.45 * period)
    lines = np.unique(np.linspace(first, last, int(random.integers(9, 60))).astype(int))
    turns = 2 * np.pi * np.outer(np.arange(n) / period, lines) + random.uniform(0, 2 * np.pi, lines.size)
    return np.cos(turns).sum(axis=1)


def closed_loop(random, modes, n, step, share=0.5):
    """Return input and output of a loop with this share of noise, whose gain keeps it stable."""
    gain = 0.8 / sum(abs(b0) / omega**2 / (2 * zeta) for omega, zeta, b0, _ in modes)  # stable: small gain
    plants = [stepped(omega, zeta, step, False, 0.0) for omega, zeta, *_ in modes]
    u, y, states = random.standard_normal(n), np.zeros(n), [np.zeros(2) for _ in modes]
    size = share * np.std(response(modes, u, step, False))
    noise = lfilter([1], [1, -random.uniform(0, 0.8)], size * random.standard_normal(n))
    for k in range(n):
        y[k] = noise[k] + sum(b0 * x[0] + b1 * x[1] for x, (_, _, b0, b1) in zip(states, modes, strict=True))
        u[k] -= gain * y[k - 1] if k else 0
        states = [matrix @ x + at * u[k] for x, (matrix, (_, at, _)) in zip(states, plants, strict=True)]
    return u, y


def record(kind, seed):
    """Return times, input, output, and the modes (frequency [Hz], damping ratio) of a random record."""
    random = np.random.default_rng([seed, KINDS.index(kind), 70])
    n, step = int(random.integers(1500, 5000)), 0.01 * 10 ** random.uniform(-1.5, 0.5)
    end, count = 0.5 / step, int(random.integers(1, 4))
    f = np.zeros(2)
    while f.size > 1 and np.min(f[1:] / np.maximum(f[:-1], 1e-9)) < 1.25:
        f = np.sort(end * np.exp(random.uniform(np.log(0.03), np.log(0.7), count)))
    zeta, noise, delay = random.uniform(0.005, 0.04, f.size), 10 ** random.uniform(-2.5, -1), 0.0
    source = OF_INPUT.get(kind) or random.choice(["switched", "white", "chirp"])
    if kind == "close":
        f, zeta, noise, n = (
            random.uniform(0.1, 0.5) * end * np.array([1, 1.01]),
            random.uniform(1e-3, 3e-3, 2),
            0.01,
            5000,
        )
    elif kind == "0 dB":
        noise, n = 1.0, 5000
    elif kind == "delay":
        delay = random.uniform(0.3, 15) * step
    elif kind == "short":
        n, source = 300, random.choice(["step", "white", "switched"])
        f = random.uniform(2, 5) / (n * step) * np.array([1, random.uniform(2, 4)])[: min(f.size, 2)]
        zeta = random.uniform(0.01, 0.05, f.size)
    elif kind == "damped":
        f, zeta = f[:1], random.uniform(0.3, 0.8, 1)
    elif kind == "hum":
        step = min(step, random.uniform(0.1, 0.4) / 60)
        f = f * end**-1 * 0.5 / step
    is_joined = source in ("chirp", "hits", "multisine") or (
        source == "white" and bool(random.random() < 0.5)
    )
    gains = random.uniform(0.5, 1.5, f.size) * random.choice([1, 1, 1, -1], f.size)
    modes = [
        (2 * np.pi * a, z, g * (2 * np.pi * a) ** 2, 0.0) for a, z, g in zip(f, zeta, gains, strict=True)
    ]
    if kind == "closed loop":
        u, y = closed_loop(random, modes, n, step)
    else:
        u = of_input(random, source, n, step, f)
        is_at_rest = source in ("step", "hits") or random.random() < 0.4
        omega = 2 * np.pi * end * random.uniform(1.1, 1.6)
        above = [(omega, 0.01, 0.5 * omega**2, 0.0)] if kind == "alias" else []
        start = None if is_at_rest else random.standard_normal(2) * np.std(u)
        y = response(modes + above, u, step, is_joined, delay, start)
    t, size = np.arange(n) * step, np.std(y)
    y = y + (0 if kind == "closed loop" else noise * size) * random.standard_normal(n)
    if kind == "hum":
        mains = random.choice([50, 60])
        for k in (1, 2, 3):
            height, angle = random.uniform(0.2, 2) / k, random.uniform(0, 6)
            y = y + (k * mains < 0.48 / step) * size * height * np.sin(2 * np.pi * k * mains * t + angle)
    elif kind == "drift":
        y = y + size * (random.uniform(1, 5) * t / t[-1] + random.uniform(-3, 3))
    elif kind == "8 bits":
        u, y = (
            x if np.unique(x).size < 10 else np.round(250 * x / np.ptp(x)) * np.ptp(x) / 250 for x in (u, y)
        )
    kept = np.arange(n)
    if kind == "lost samples":
        kept = np.flatnonzero((random.random(n) > random.uniform(0.005, 0.04)) | (kept < 2) | (kept == n - 1))
    return t[kept], u[kept], y[kept], sorted(zip(f, zeta, strict=True))


def written(path, t, u, y):
    """Write a record as a data logger does."""
    rows = (f"{a:.9g},{b:.9g},{c:.9g}" for a, b, c in zip(t, u, y, strict=True))
    path.write_text("\n".join(["time_s,u,y", *rows]), encoding="utf-8")


def study(kind, count, seed=1, show=None):
    """Fit ``count`` records; return errors over their standard errors, and which were wrong, or unsaid."""
    import symflex  # the data need none of it

    off, wrong, silent = [], [], []
    for number in range(seed, seed + count):
        t, u, y, modes = record(kind, number)
        with tempfile.TemporaryDirectory() as folder:
            written(Path(folder) / "record.csv", t, u, y)
            fit = symflex.fit(Path(folder) / "record.csv")
        errors, at = fit.standard_errors, np.flatnonzero(fit.found.resonances.zeta_p < 0.9)
        got = np.column_stack((fit.resonances.omega_p[at] / (2 * np.pi), fit.resonances.zeta_p[at]))
        said = np.column_stack((errors.omega_p[at] / (2 * np.pi), errors.zeta_p[at]))
        is_right = len(got) == len(modes)
        ratio = ((got - modes) / said).ravel() if is_right else np.full(1, np.inf)
        off += ratio.tolist() if is_right else []
        wrong += [number] * (not is_right)
        silent += [number] * bool(not fit.poor and np.max(np.abs(ratio)) > 5)
        if show and (not is_right or np.max(np.abs(ratio)) > 4 or fit.poor):
            show(
                kind,
                number,
                np.round(got, 4).tolist(),
                np.round(modes, 4).tolist(),
                np.round(ratio, 1),
                fit.poor,
            )
    return np.array(off), wrong, silent
