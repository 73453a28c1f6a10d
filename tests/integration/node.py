"""Running exported ES modules in Node: one process for all of them."""

from __future__ import annotations

import json
import subprocess

import numpy as np


class Node:
    """A folder with modules and a script that calls them."""

    def __init__(self, folder):
        self.folder = folder
        self.lines = ['import { writeFileSync } from "node:fs";', "const kept = [];"]
        self.count = 0
        self.values = []

    def write(self, name, text):
        """Write a module; return the identifier of what it exports."""
        (self.folder / f"{name}.mjs").write_text(text, encoding="utf-8")
        self.lines.insert(0, f'import * as {name} from "./{name}.mjs";')
        return name

    def keep(self, expression):
        """Ask for a value that JSON can say; return its number."""
        self.lines.append(f"kept.push({expression});")
        self.count += 1
        return self.count - 1

    def at(self, function, points, values="{}"):
        """Ask for the values of a function at points, as arrays of doubles; return their number."""
        s = np.asarray(points, dtype=complex)
        parts = ", ".join(f"Float64Array.from({json.dumps(part.tolist())})" for part in (s.real, s.imag))
        return self.keep(f"{function}([{parts}], {values}).map((x) => Array.from(x, String))")

    def run(self):
        """Run the script; return what it printed."""
        end = 'writeFileSync("kept.json", JSON.stringify(kept));'
        (self.folder / "all.mjs").write_text("\n".join([*self.lines, end, ""]), encoding="utf-8")
        run = ["node", "all.mjs"]
        done = subprocess.run(run, cwd=self.folder, capture_output=True, text=True, check=False, timeout=300)
        assert done.returncode == 0, done.stderr
        self.values = json.loads((self.folder / "kept.json").read_text())
        return done.stdout

    def numbers(self, key):
        """Return complex values that :meth:`at` asked for."""
        re, im = (np.array([float(x.replace("Infinity", "inf")) for x in part]) for part in self.values[key])
        return re + 1j * im
