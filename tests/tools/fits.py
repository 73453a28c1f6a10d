"""Run the studies of fits whose figures stand in ``docs/fit.md``.

    python -m tests.tools.fits lines 500
    python -m tests.tools.fits lines 500 1 wild
    python -m tests.tools.fits kinds 200 exact
    python -m tests.tools.fits records 40 hum

The first fits so many simulated frequency responses (tests/unit/data/laboratory.py), the second those with
modes outside the band, wild lines and real poles, the third data of every kind, or of the kinds named
(tests/unit/data/kinds.py), the last records in time (tests/unit/data/records.py).
"""

from __future__ import annotations

import sys
import time

import numpy as np

from tests.unit.data import kinds, records
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


if __name__ == "__main__":
    studies = {"lines": lines, "kinds": every_kind, "records": lambda given: every_kind(given, records)}
    studies[sys.argv[1]](sys.argv[2:])
