"""What exported code of other languages is compared with: balls over a band and beside resonances."""

from __future__ import annotations

import numpy as np
from flint import acb, ctx

from symflex.codegen.program.verify import DEFAULT_BAND, sample_frequencies
from symflex.transfer import bind

BITS = 400
FREQUENCIES = 400


def axis_points(tf, samples=FREQUENCIES):
    """Return angular frequencies [rad/s]: evenly on a logarithmic scale, and beside poles and zeros."""
    band = tf.model.analysis.band or DEFAULT_BAND
    return 2 * np.pi * sample_frequencies(bind(tf), band, samples)


def worst_errors(tf, points, *computed, given=None):
    """Return bounds of |dG| / (|G| (1 + |s G'/G|)), one for each list of values, not at poles and zeros."""
    enclosed = bind(tf, given or {}).enclosed(BITS)
    worst, count = [0.0] * len(computed), 0
    with ctx.workprec(BITS):
        for s, *values in zip(map(complex, points), *computed, strict=True):
            point = acb(s.real, s.imag)
            exact = enclosed(point)
            size = abs(exact) * (1 + abs(point * enclosed.logarithmic_derivative(point)))
            if not (size.is_finite() and size > 0):
                continue
            count += 1
            for i, value in enumerate(map(complex, values)):
                error = float("inf")
                if np.isfinite(value):
                    error = float((abs(acb(value.real, value.imag) - exact) / size).upper())
                worst[i] = max(worst[i], error)
    assert count > len(points) / 2
    return worst
