"""What the targets of data files share."""

import numpy as np

from symflex.data.measurement import MeasuredResponse
from symflex.errors import SymflexError

FREQUENCY = np.arange(1.0, 7.0)
RESPONSE = MeasuredResponse(
    "X/F", FREQUENCY, 1 / (9 - FREQUENCY**2 + 0.3j * FREQUENCY), np.linspace(0.5, 1, 6), 20.0, "hann", "m/N"
)


def answered(read, data, name="a"):
    """Read a data file; what is read has at least one response, with as many values as lines."""
    try:
        found = read(name, data, "a")
    except SymflexError as error:
        str(error)
        return
    if not found or any(one.values.shape != one.frequency_hz.shape for one in found):
        message = f"read as {found!r}"
        raise AssertionError(message)
