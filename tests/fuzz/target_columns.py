"""Measured responses as text in columns."""

from __future__ import annotations

from symflex.data.measurement.comma_separated import read_columns
from symflex.data.measurement.files import csv_bytes
from tests.fuzz.measured import RESPONSE, answered

ROOMS = ("symflex.data.measurement",)


def seeds():
    """Return files of several shapes."""
    return [
        csv_bytes(RESPONSE),
        b"f [kHz];mag_db;phase_deg\n1;2;3\n2;3;4\n3;4;5\n",
        b"omega\tmagnitude\tphase_rad\n1\t2\t3\n2\t3\t4\n3\t4\t5\n",
        b"% unit: m/(V*s^2)\nfreq re im coh\n1 2 3 .5\n2 3 4 .5\n3 4 5 1\n",
    ]


def run(data):
    """Read a file."""
    answered(read_columns, data)
