"""Measured one- and two-ports in Touchstone files."""

from symflex.data.measurement.touchstone import read_touchstone
from tests.fuzz.measured import answered

ROOMS = ("symflex.data.measurement",)


def seeds():
    """Return files of one port and of two, of several forms."""
    two = b"1 0 0 .5 .1 .5 .1 0 0\n2 0 0 .4 .1 .4 .1 0 0\n3 0 0 .3 .1 .3 .1 0 0\n"
    return [
        b"1! one port\n# MHz S RI R 50\n1 .3 .1\n2 .2 .2\n3 .1 .1\n",
        b"1# Hz Z DB R 75\n1 3 10\n2 4 20\n3 5 30 ! end\n",
        b"1[Version] 2.0\n# Hz Y MA R 50\n[Reference] 50\n[Network Data]\n1 3 1\n2 4 2\n3 5 3\n[End]\n",
        b"2# GHz S MA R 50\n" + two + b"1 2 3 4 5\n",
        b"2[Two-Port Data Order] 12_21\n# GHz S RI R 50\n" + two,
    ]


def run(data):
    """Read a file of as many ports as its first byte says."""
    ending = ".s2p" if data[:1] == b"2" else ".s1p"

    def read(name, content, stem):
        return read_touchstone(name + ending, content, stem, "y11" if data[1:2] == b"#" else "")

    answered(read, data[1:])
