"""Measured responses in MATLAB files."""

import io

import numpy as np
import scipy.io

from symflex.data.measurement.arrays import read_arrays
from tests.fuzz.measured import RESPONSE, answered

ROOMS = ("symflex.data.measurement",)


def seeds():
    """Return files of both formats, compressed and not."""
    arrays = {"f": RESPONSE.frequency_hz, "H": RESPONSE.values, "coherence": RESPONSE.coherence, "tf": "X/F"}
    found = []
    for form, is_compressed in (("4", False), ("5", False), ("5", True)):
        buffer = io.BytesIO()
        nested = {"w": RESPONSE.frequency_hz, "P": {"mag": np.abs(RESPONSE.values), "phase": np.ones(6)}}
        more = {"tf": np.array(["X/F"], object), "s": nested} if form == "5" else {}
        scipy.io.savemat(buffer, arrays | more, format=form, do_compression=is_compressed)
        found.append(buffer.getvalue())
    return found


def run(data):
    """Read a file."""
    answered(read_arrays, data, "a.mat")
