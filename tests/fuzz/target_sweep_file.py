"""Results of sweeps in netCDF and numpy archives."""

import tempfile
from contextlib import suppress
from functools import cache
from pathlib import Path

from symflex import pipeline
from symflex import sweep as sweep_package
from symflex.errors import SymflexError
from symflex.options import SweepOptions
from symflex.sweep import read_design, sweep_task
from symflex.sweep.files import netcdf_bytes, npz_bytes, read_sweep
from symflex.sweep.labelled import sweep_json
from tests.fuzz.target_numpy_archive import packed, unpacked

ROOMS = ("symflex.data.measurement", "symflex.sweep.files", "symflex.sweep")
MODEL = """
symflex = 1
parameters = { m = "1 kg", c = "1 N*s/m", k = "4 N/m", K = "1 N/m" }
elements.b = { type = "mass", at = "x", m = "m" }
elements.d = { type = "damper", between = ["x", "ground"], b = "c" }
elements.k = { type = "spring", between = ["x", "ground"], k = "k" }
elements.a = { type = "force_source", at = "x", f = "K*(F - x)" }
inputs.F = {}
outputs.X = "x"
"""


def seeds():
    """Return small sweeps of every kind in both formats."""
    model = pipeline.loads(MODEL)
    design = read_design(model.parameters, ["k=1,2"])
    found = []
    for of, frequencies in (("poles", ()), ("zeros", ()), ("response", (0.1, 1.0)), ("margins", ())):
        task = sweep_task(model, ("X", "F"), design, of, None, frequencies, "K" if of == "margins" else "")
        sweep = sweep_package.sweep(task, design, SweepOptions())
        found += [netcdf_bytes(sweep), unpacked(npz_bytes(sweep))]
    return found


@cache
def place():
    """Return a file to write to."""
    return Path(tempfile.mkdtemp()) / "a.nc"


def run(data):
    """Read a file; what is read can be told in words and as JSON."""
    place().write_bytes(data if data[:3] == b"CDF" else packed(data))
    with suppress(SymflexError):
        sweep = read_sweep(place())
        sweep.text(80)
        sweep_json(sweep)
