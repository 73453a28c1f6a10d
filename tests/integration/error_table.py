"""Errors of what is exported, of every model and target, as the table of ``docs/numeric-export.md`` has them.

``PYTHONPATH=. python -m tests.integration.error_table`` measures and prints it.
"""

from __future__ import annotations

import importlib.util
import math
import sys
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
from flint import acb, acb_mat, ctx

from symflex.codegen.exporters import EXPORTERS
from symflex.codegen.program.verify import doubles
from symflex.errors import ModelError
from symflex.transfer import bind
from tests.integration.julia_in_python import functions_of
from tests.integration.octave import Octave
from tests.unit.codegen.against_balls import BITS, axis_points, balls_at, worst_beside
from tests.unit.codegen.exportable import DERIVATIONS, derived, public_name
from tests.unit.codegen.test_c_files import compiled, response, value_at


@cache
def model_of(name):
    """Return a model, its transfer functions, and points on the axis for each [rad/s]."""
    model, tfs = derived(name)
    return model, tfs, {tf.name: axis_points(tf) for tf in tfs}


@cache
def balls_of(name):
    """Return what all targets are compared with, by the names of transfer functions."""
    return {tf.name: balls_at(tf, 1j * w) for tf, w in _points(name)}


def exported(name, target):
    model, tfs, _ = model_of(name)
    return EXPORTERS[target].export(model, tfs, name, is_alone=False)


def imported(text, folder, stem):
    path = folder / f"{stem}.py"
    path.write_text(text, encoding="utf-8")
    spec = importlib.util.spec_from_file_location(stem, path)
    module = sys.modules[stem] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def from_module(name, target, folder, array):
    """Yield values of all functions of a Python module; ``array`` makes its library's arrays."""
    module = imported(exported(name, target).text, folder, f"{name}_{target.replace('-', '_')}")
    on_axis = getattr(module, "FREQUENCY_RESPONSES", {})
    for tf, w in _points(name):
        yield tf, w, module.TRANSFER_FUNCTIONS[tf.name](array(1j * w))
        if tf.name in on_axis:
            yield tf, w, on_axis[tf.name](array(w))


def from_jax(name, folder):
    import jax

    jax.config.update("jax_enable_x64", True)
    return from_module(name, "jax", folder, jax.numpy.asarray)


def from_array_api(name, folder):
    import array_api_strict

    return from_module(name, "array-api", folder, array_api_strict.asarray)


def from_c(name, folder):
    made = exported(name, "c")
    library, functions = compiled(folder, made, name)
    for number, (tf, w) in enumerate(_points(name)):
        assert functions[number].endswith(public_name(tf))
        yield tf, w, value_at(library, number, 1j * w)
        yield tf, w, response(library, number, w)


def from_octave(name, folder):
    octave = Octave(folder)
    text = exported(name, "matlab").text
    octave.write(name, text)
    octave.do(f"G = {name}();")
    asked = []
    for tf, w in _points(name):
        asked.append((tf, w, octave.keep(f"G.{public_name(tf)}({octave.points(1j * w)})")))
        if f"G.{public_name(tf)}_at" in text:
            asked.append((tf, w, octave.keep(f"G.{public_name(tf)}_at(real({octave.points(w)}))")))
    octave.run()
    return [(tf, w, octave.value(key)) for tf, w, key in asked]


def from_julia(name, _folder):
    functions = functions_of(exported(name, "julia").text)
    for tf, w in _points(name):
        values = doubles(bind(tf))
        given = [values[p.name] for p in tf.parameters]
        for suffix, points in (("", 1j * w), ("_at", w)):
            function = functions.get(f"_value_of_{public_name(tf)}{suffix}")
            if function:
                yield tf, w, [function(p, *given) for p in points.tolist()]


def from_state_space(name, folder):
    """Yield values of what the matrices of doubles say, themselves computed without error."""
    module = imported(exported(name, "state-space").text, folder, f"{name}_state_space")
    a, b, c, d = (
        acb_mat(x.shape[0], x.shape[1], list(map(acb, x.flatten().tolist()))) for x in module.state_space()
    )
    outputs, inputs = ([row["name"] for row in rows] for rows in (module.OUTPUTS, module.INPUTS))
    for tf, w in _points(name):
        values = []
        with ctx.workprec(BITS):
            unit = acb_mat(
                a.nrows(), a.nrows(), [int(i == j) for i in range(a.nrows()) for j in range(a.nrows())]
            )
            for omega in w.tolist():
                found = c * (unit * acb(0, omega) - a).solve(b) + d
                values.append(complex(found[outputs.index(tf.output.name), inputs.index(tf.input.name)]))
        yield tf, w, values


WAYS = {
    "numpy": lambda name, folder: from_module(name, "numpy", folder, np.asarray),
    "array-api": from_array_api,
    "jax": from_jax,
    "c": from_c,
    "matlab": from_octave,
    "julia": from_julia,
    "state-space": from_state_space,
}


def _points(name):
    _, tfs, points = model_of(name)
    return [(tf, points[tf.name]) for tf in tfs]


def worst(name, target):
    """Return the worst error of a model's functions, and how many lists of values it is of.

    ``None`` where a target is none for the model, as state equations are not for a beam.
    """
    with tempfile.TemporaryDirectory() as folder:
        try:
            found = list(WAYS[target](name, Path(folder)))
        except ModelError:
            return None
    balls = balls_of(name)
    return max(worst_beside(balls[tf.name], values)[0] for tf, _, values in found), len(found)


def printed(error):
    """Return an error to two digits, rounded up."""
    if not error:
        return "0"
    exponent = math.floor(math.log10(error))
    return f"{math.ceil(error / 10.0 ** (exponent - 1)) / 10:.1f}e{exponent}"


def table():
    """Return the table in Markdown."""
    lines = ["| | " + " | ".join(f"`{t}`" for t in WAYS) + " |", "|---|" + "---:|" * len(WAYS)]
    for name in DERIVATIONS:
        cells = (worst(name, target) for target in WAYS)
        row = "| " + " | ".join([f"`{name}`", *(printed(c[0]) if c else "–" for c in cells)]) + " |"
        print(row, file=sys.stderr)
        lines.append(row)
    return "\n".join(lines)


if __name__ == "__main__":
    print(table())
