"""Measured responses as text in columns."""

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
        "AxisUnit;Hz\n\n';A (Real);A (Imag.)\n';m/N;m/N\n1,5;2,5;3\n2;3;4\n3;4;5\n".encode("utf-16"),
        "Freq.\tV(o)\n1\t(-1.5dB,3.5°)\n2\t(-2.5dB,4°)\n3\t(-3dB,5°)\n".encode("cp1252"),
        b'"f","psd_x","psd_y"\n' + b"".join(b"%d,%d,1\n" % (i, 3 * i % 7 + 1) for i in range(1, 12)),
        b"Magnitude\nf,dB\n1,2\n2,3\n3,4\n\nPhase (deg)\nf,value\n1,2\n2,3\n3,4\n",
        b"* x\n* Data: Impedance (ohms), Phase (degrees)\n1 2 3\n2 3 4\n3 4 5D+0\n",
        b"f,1,2,3,4,5,6,7\nre,1,2,3,4,5,6,7\nim,3,2,3,2,1,2,3\n",
        b"C   RUN\nC   F(HZ)  RE  IM\n1  2  3\n2  3  4\n3  4  5D0\n",
        b"f;-Im(Z)/Ohm;Re(Z)/Ohm\n3;1-2i;2\n2;3;4\n1;4;(1,2)\n",
    ]


def run(data):
    """Read a file, as its first byte asks for."""
    asked = {b"1": "f,re,im", b"2": "f_khz,-,mag_db,phase", b"3": "omega,mag"}.get(data[:1], "")
    answered(lambda *given: read_columns(*given, asked), data[1:] if asked else data)
