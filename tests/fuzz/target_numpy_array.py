"""Measured responses as one numpy array."""

import io

import numpy as np

from symflex.data.measurement.arrays import read_arrays
from tests.fuzz.measured import RESPONSE, answered

ROOMS = ("symflex.data.measurement",)


def seeds():
    """Return matrices of complex and of real columns, in both orders."""
    found = []
    pair = np.column_stack([RESPONSE.frequency_hz, RESPONSE.values])
    for array in (pair, np.asfortranarray(pair), pair.T, pair.real, pair.astype("c8")):
        buffer = io.BytesIO()
        np.save(buffer, array)
        found.append(buffer.getvalue())
    return found


def run(data):
    """Read a file, and read it as it is asked for."""
    answered(read_arrays, data, "a.npy")
    answered(lambda *given: read_arrays(*given, "f,h"), data, "a.npy")
