"""Measured responses in universal files."""

from symflex.data.measurement.files import universal_bytes
from symflex.data.measurement.universal_file import read_universal_file
from tests.fuzz.measured import RESPONSE, answered

ROOMS = ("symflex.data.measurement", "pyuff")


def seeds():
    """Return a file of text, and one of numbers in binary."""
    text = universal_bytes(RESPONSE)
    return [text, text.replace(b"    58 ", b"    58b", 1)]


def run(data):
    """Read a file."""
    answered(read_universal_file, data)
