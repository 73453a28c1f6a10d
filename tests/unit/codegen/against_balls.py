"""What exported code of other languages is compared with: balls over a band and beside resonances."""

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
    return worst_beside(balls_at(tf, points, given), *computed)


def balls_at(tf, points, given=None):
    """Return the values at points, and what errors are measured by: |G| (1 + |s G'/G|)."""
    enclosed = bind(tf, given or {}).enclosed(BITS)
    with ctx.workprec(BITS):
        places = [acb(s.real, s.imag) for s in map(complex, points)]
        values = [(s, enclosed(s)) for s in places]
        return [(v, abs(v) * (1 + abs(s * enclosed.logarithmic_derivative(s)))) for s, v in values]


def worst_beside(balls, *computed):
    """Return what :func:`worst_errors` does, given the values."""
    worst, count = [0.0] * len(computed), 0
    with ctx.workprec(BITS):
        for (exact, size), *values in zip(balls, *computed, strict=True):
            if not (size.is_finite() and size > 0):
                continue
            count += 1
            for i, value in enumerate(map(complex, values)):
                error = float("inf")
                if np.isfinite(value):
                    error = float((abs(acb(value.real, value.imag) - exact) / size).upper())
                worst[i] = max(worst[i], error)
    assert count > len(balls) / 2
    return worst
