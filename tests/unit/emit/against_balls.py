"""What exported code of other languages is compared with: ball arithmetic over a band and beside resonances."""

from __future__ import annotations

import numpy as np
from flint import acb, ctx

from symflex.emit.program.verify import DEFAULT_BAND, sample_frequencies
from symflex.transfer import bind

BITS = 400
FREQUENCIES = 400


def band_of(model):
    return model.analysis.band or DEFAULT_BAND


def axis_points(tf, samples=FREQUENCIES):
    """Return angular frequencies [rad/s]: evenly on a logarithmic scale, and beside poles and zeros."""
    return 2 * np.pi * sample_frequencies(bind(tf), band_of(tf.model), samples)


def errors(tf, points, values, given=None):
    """Return upper bounds of |dG| / (|G| (1 + |s G'/G|)) at every point that is no pole or zero."""
    enclosed = bind(tf, given or {}).enclosed(BITS)
    found = []
    with ctx.workprec(BITS):
        for s, value in zip(points, values, strict=True):
            s, value = acb(complex(s).real, complex(s).imag), complex(value)
            exact = enclosed(s)
            size = abs(exact) * (1 + abs(s * enclosed.logarithmic_derivative(s)))
            if not (size.is_finite() and size > 0):
                continue
            if not np.isfinite(value):
                found.append(float("inf"))
                continue
            found.append(float((abs(acb(value.real, value.imag) - exact) / size).upper()))
    return found
