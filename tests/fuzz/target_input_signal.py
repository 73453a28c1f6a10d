"""Inputs over time as text in columns."""

import tempfile
from itertools import pairwise
from pathlib import Path

from symflex.data.measurement.input_signal import read_signal
from symflex.errors import SymflexError

ROOMS = ("symflex.data.measurement",)
PLACE = Path(tempfile.gettempdir()) / "input_signal.csv"


def seeds():
    """Return files of several shapes."""
    return [
        b"time_s,u\n0,1\n0.5,2\n1,0\n",
        b"Time;Kraft\nms;N\n0,5;1\n1;2\n2,5;3\n",
        b"0\t1\n1\t2\n",
        b"t,u\n0,0\n1,0\n1,2\n2,2\n",
        "x-axis,1\nsecond,Volt\n-1e-3,2\n0,3\n1E-3,4\n".encode("utf-16"),
        b"a\n***End_of_Header***\nX_Value\tVoltage\tComment\n0\t1\n1\t2\n",
        b"# t [us] u\n1.000000000000000021e-02 1\n2.0000000000000000416e-02 3\n",
    ]


def run(data):
    """Read a file; its times never fall, none stands three times, and there are as many values."""
    PLACE.write_bytes(data)
    try:
        signal = read_signal(PLACE)
    except SymflexError as error:
        str(error)
        return
    times = signal.times
    falls = any(a > b for a, b in pairwise(times))
    if (
        falls
        or len(times) != len(signal.values)
        or any(a == b for a, b in zip(times, times[2:], strict=False))
    ):
        message = f"read as {signal!r}"
        raise AssertionError(message)
