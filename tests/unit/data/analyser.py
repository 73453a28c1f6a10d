"""Measurements of known systems, made without any code of symflex but its record of a response.

Noise drives a product of second-order factors; records with a Hann window are averaged to an H1 estimate.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from symflex.data.measurement import MeasuredResponse

RATE, LOW, HIGH = 256.0, 2.0, 100.0


@dataclass(frozen=True)
class System:
    """Natural frequencies [Hz] and damping ratios of poles and zeros, each of shape (n,)."""

    f_p: np.ndarray
    zeta_p: np.ndarray
    f_z: np.ndarray
    zeta_z: np.ndarray

    def __call__(self, frequency):
        value = np.ones(frequency.shape, complex)
        for f_p, zeta_p, f_z, zeta_z in zip(self.f_p, self.zeta_p, self.f_z, self.zeta_z, strict=True):
            x, y = frequency / f_z, frequency / f_p
            value *= (1 - x**2 + 2j * zeta_z * x) / (1 - y**2 + 2j * zeta_p * y)
        return value


def random_system(random, count=5):
    """Return a system with modes at least 5 Hz apart and zeros between them."""
    while True:
        f_p = np.sort(random.uniform(8, 88, count))
        if count == 1 or np.min(np.diff(f_p)) >= 5:
            break
    gaps = np.append(np.diff(f_p), 0.2 * f_p[-1])
    f_z = np.minimum(f_p + random.uniform(0.25, 0.75, count) * gaps, 1.15 * f_p)
    f_z[-1] = min(f_z[-1], 0.97 * HIGH)
    return System(f_p, random.uniform(0.01, 0.05, count), f_z, random.uniform(0.01, 0.05, count))


def rigid(omega):
    """Return the known factor: acceleration of something that first speeds up and then slips."""
    return 1j * omega / (1 + 1j * omega / 60)


def measured(function, random, record=16.0, records=40, noise=0.03, **more):
    """Return the H1 estimate of a function of frequency [Hz]; noise over signal, both rms, at the output."""
    size = int(record * RATE)
    total = size * (records + 1) // 2
    x = random.standard_normal(total)
    everywhere = np.fft.rfftfreq(total, 1 / RATE)
    y = np.fft.irfft(np.fft.rfft(x) * function(everywhere), total)
    y += noise * y.std() * random.standard_normal(total)
    window = np.hanning(size + 1)[:size]
    xx = yy = xy = 0
    for start in range(0, total - size + 1, size // 2):
        a = np.fft.rfft(window * x[start : start + size])
        b = np.fft.rfft(window * y[start : start + size])
        xx, yy, xy = xx + abs(a) ** 2, yy + abs(b) ** 2, xy + np.conj(a) * b
    frequency = np.fft.rfftfreq(size, 1 / RATE)
    kept = (frequency >= LOW) & (frequency <= HIGH)
    coherence = abs(xy) ** 2 / (xx * yy)
    settings = {"averages": 0.947 * records, "window": "hann"} | more
    return MeasuredResponse("y/u", frequency[kept], (xy / xx)[kept], coherence[kept], **settings)
