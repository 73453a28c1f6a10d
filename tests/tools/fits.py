"""Run the studies of fits whose figures stand in ``docs/fit.md``.

    python -m tests.tools.fits lines 500
    python -m tests.tools.fits lines 500 1 wild
    python -m tests.tools.fits kinds 200 exact
    python -m tests.tools.fits records 40 hum
    python -m tests.tools.fits machines 40 motor

The first fits so many simulated frequency responses (tests/unit/data/laboratory.py), the second those with
modes outside the band, wild lines and real poles, the third data of every kind, or of the kinds named
(tests/unit/data/kinds.py), the fourth records in time (tests/unit/data/records.py), the last parameters of
machines (tests/unit/data/machines.py).
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from tests.unit.data import kinds, machines, records
from tests.unit.data.laboratory import limit_for, simulated, study, summary, wild


def lines(arguments):
    """Print the statistics of fits to simulated frequency responses."""
    count, seed = int(arguments[0]), int(arguments[1]) if len(arguments) > 1 else 1

    def show(number, case, off, poor, words):
        if off.max() > limit_for(off.size) or poor:
            kind = "logarithmic" if case.is_logarithmic else "linear"
            worst = " ".join(f"{x:.1f}" for x in off)
            noise = f"{case.noise_percent} % {'of the mean' if case.is_additive else 'of each line'}"
            shape = case.shape + (", mode outside" if case.has_mode_outside else "")
            shape += ", real pole" if case.real_pole else ""
            shape += f", wild line {case.wild}" if case.wild is not None else ""
            print(f"{number:4d} {shape}, {case.values.size} {kind} lines, {noise}: {worst}", end=" ")
            print(f"poor: {words}" if poor else "", flush=True)

    is_wild = arguments[2:] == ["wild"]
    for given in (False,) if is_wild else (True, False):
        print("number of resonances", "given" if given else "chosen")
        draw = wild if is_wild else simulated
        for name, value in summary(study(count, seed, modes_given=given, show=show, draw=draw)).items():
            print(f"  {name}: {value}")


def every_kind(arguments, of=kinds):
    """Print the statistics of fits to data of every kind."""
    count = int(arguments[0])
    for kind in arguments[1:] or of.KINDS:
        begun = time.process_time()
        off, wrong, silent = of.study(kind, count, show=print)
        rms, seconds = np.sqrt(np.mean(off**2)), (time.process_time() - begun) / count
        print(f"{kind}: rms {rms:.2f}, wrong {wrong}, unsaid {silent}, {seconds:.1f} s each", flush=True)


def every_machine(arguments):
    """Print how often intervals of fitted parameters hold the true values."""
    count = int(arguments[0])
    kinds_of_data = [(name, n) for name in machines.MACHINES for n in (None, 50)]
    for name, averages in [*kinds_of_data, *((name, None) for name in machines.RECORDS)]:
        if arguments[1:] and name not in arguments[1:]:
            continue
        begun = time.process_time()
        with tempfile.TemporaryDirectory() as folder:
            off, inside, poor = machines.study(name, count, Path(folder), averages)
        rms, seconds = np.sqrt(np.mean(off**2)), (time.process_time() - begun) / count
        said = f"{name}{', coherence' if averages else ''}: {np.mean(inside):.3f} of {inside.size} inside"
        print(f"{said}, rms {rms:.2f}, poor {poor}, {seconds:.1f} s each", flush=True)


if __name__ == "__main__":
    studies = {
        "lines": lines,
        "kinds": every_kind,
        "records": lambda given: every_kind(given, records),
        "machines": every_machine,
    }
    studies[sys.argv[1]](sys.argv[2:])
