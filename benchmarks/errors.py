"""Errors of exported code, of every model in ``derivations/`` and every target, against ball arithmetic.

Input: the text of each export, run by its language: imported, compiled, in Octave; Julia's arithmetic is read
as Python.
Output: the table of ``benchmarks/errors.md``, the worst ``|dG| / (|G| (1 + |s G'/G|))`` over the band and
beside resonances and antiresonances, and how many times the documented errors these are.

No time is measured here: errors depend on a machine only as its mathematical library does.
"""

from __future__ import annotations

import ctypes
import json
import math
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from flint import acb, acb_mat, ctx

from benchmarks.generated import imported, loaded, pointer, responding
from benchmarks.measure import Claim, Extent, Measured
from symflex import pipeline
from symflex.codegen.exporters import EXPORTERS
from symflex.codegen.program.verify import DEFAULT_BAND, References, doubles
from symflex.errors import ModelError
from symflex.transfer import bind_any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from symflex.codegen.export import Export
    from symflex.model import Model
    from symflex.transfer import AnyTransferFunction, TransferFunction

    Values = Iterator[tuple[AnyTransferFunction, Sequence[complex]]]

ROOT: Final = Path(__file__).parents[1]
MODELS: Final = {
    path.stem: path for path in sorted((ROOT / "derivations").glob("**/*.toml")) if path.name != "claims.toml"
}
PAGE: Final = ROOT / "benchmarks" / "errors.md"
ROW: Final = re.compile(r"^\| `(\w+)` \|((?: [-0-9.e–]+ \|)+)$", re.MULTILINE)
REFUSED: Final = "–"
"""In the table, of what a target has no code for: a beam has no finite state equations."""

LIBRARIES_DIFFER: Final = 2.0
"""How many times the documented error another mathematical library may have."""
LARGEST: Final = 1e-13
BITS: Final = 400
"""Precision of the transfer functions that rounded state equations have."""


@dataclass(frozen=True)
class Case:
    """A model, its transfer functions, and what their values are compared with."""

    name: str
    model: Model
    tfs: tuple[AnyTransferFunction, ...]
    references: Mapping[str, References]  # by the names of transfer functions

    def exported(self, target: str) -> Export:
        """Return the text in some language."""
        return _exported(self.name, target)

    def end(self, target: str, name: str) -> float:
        """Return the angular frequency [rad/s] at which the band form of a function ends, if it has one."""
        verified = next((v for v in self.exported(target).verified if v.name == name), None)
        return math.tau * float(verified.band[1]) if verified and verified.form == "band" else math.inf

    def points(self) -> Iterator[tuple[AnyTransferFunction, str, NDArray[np.float64]]]:
        """Yield transfer functions, what exports call them, and angular frequencies [rad/s]."""
        for tf in self.tfs:
            yield tf, f"{tf.output.name}_over_{tf.input.name}", self.references[tf.name].s.imag.copy()


@cache
def case_of(name: str) -> Case:
    """Derive a model, and enclose its transfer functions at all points."""
    model = pipeline.load(MODELS[name])
    tfs = tuple(map(_as_exported, pipeline.derive_all(model)))
    band = model.analysis.band or DEFAULT_BAND
    return Case(name, model, tfs, {tf.name: References.over(bind_any(tf), band) for tf in tfs})


def _as_exported(tf: TransferFunction) -> AnyTransferFunction:
    """Return the nested form of a function whose exponents have no formula, as exporters take it."""
    if tf.is_nameless and not any(law.matrix for law in tf.kernels.dispersions):
        (nested,) = pipeline.derive_nested(tf.model, [(tf.output.name, tf.input.name)])
        return nested
    return tf


@cache
def _exported(name: str, target: str) -> Export:
    case = case_of(name)
    return EXPORTERS[target].export(case.model, case.tfs, name, is_alone=False)


# --------------------------------------------------------------------------- values, language by language


def in_python(case: Case, target: str, array: Callable[[Any], Any]) -> Values:
    """Yield values of a Python module; ``array`` makes its library's arrays."""
    module = imported(case.exported(target).text, f"{case.name}_{target.replace('-', '_')}")
    on_axis = getattr(module, "FREQUENCY_RESPONSES", {})
    for tf, _, w in case.points():
        yield tf, module.TRANSFER_FUNCTIONS[tf.name](array(1j * w))
        if tf.name in on_axis:
            yield tf, on_axis[tf.name](array(w))


def in_numpy(case: Case) -> Values:
    """Yield values of numpy modules."""
    return in_python(case, "numpy", np.asarray)


def in_array_api(case: Case) -> Values:
    """Yield values with the strictest library of the array API."""
    return in_python(case, "array-api", import_module("array_api_strict").asarray)


def in_jax(case: Case) -> Values:
    """Yield values with jax in double precision."""
    jax = import_module("jax")
    jax.config.update("jax_enable_x64", True)
    return in_python(case, "jax", jax.numpy.asarray)


def in_c(case: Case) -> Values:
    """Yield values of compiled C, and of its frequency responses."""
    made, stem = case.exported("c"), case.name
    arrays = "".join(ARRAYS.format(stem=stem, pair=pair) for _, pair, _ in case.points())
    files = {f"{stem}.c": made.text, f"{stem}.h": made.companions[".h"]}
    library = loaded({**files, "arrays.c": f'#include "{stem}.h"\n#include <string.h>\n{arrays}'}, C_FLAGS)
    for tf, pair, w in case.points():
        s, values = 1j * w, np.empty(w.size, dtype=complex)
        compute = getattr(library, f"values_of_{pair}")
        compute(pointer(s.view(float)), pointer(values.view(float)), ctypes.c_size_t(w.size))
        yield tf, list(values)
        real, imag = (responding(library, stem, pair, w, part)() for part in (0, 1))
        yield tf, list(real + 1j * imag)


C_FLAGS: Final = ("-std=c99", "-O1")
ARRAYS: Final = """
void values_of_{pair}(const double *s, double *values, size_t n)
{{
    for (size_t k = 0; k < n; k++) {{
        double complex z;
        memcpy(&z, s + 2 * k, sizeof z);
        z = {stem}_{pair}(z, &{stem}_defaults);
        memcpy(values + 2 * k, &z, sizeof z);
    }}
}}
"""


def in_octave(case: Case) -> Values:
    """Yield values of a function file, all by one process of Octave."""
    text, name = case.exported("matlab").text, case.name
    lines, asked = [f"G = {name}();"], []
    for tf, pair, w in case.points():
        lines.append(f"w = [{' '.join(map(repr, w.tolist()))}].';")
        for call in (f"G.{pair}(1i*w)", f"G.{pair}_at(w)"):
            if call.partition("(")[0] in text:
                lines += [f"z = {call};", r"printf('%.17g %.17g\n', [real(z(:)).'; imag(z(:)).']);"]
                asked.append((tf, w.size))
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / f"{name}.m").write_text(text, encoding="utf-8")
        (Path(folder) / "values.m").write_text("\n".join(["1;", *lines]) + "\n", encoding="utf-8")
        command = ["octave", "--no-gui", "--norc", "--quiet", "--no-history", "values.m"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    rows = iter(done.stdout.splitlines())
    for tf, size in asked:
        yield tf, [complex(*map(float, next(rows).split())) for _ in range(size)]


def in_julia(case: Case) -> Values:
    """Yield values of the functions of a module, read as Python by the tests."""
    functions = import_module("tests.integration.julia_in_python").functions_of(case.exported("julia").text)
    for tf, pair, w in case.points():
        values = doubles(bind_any(tf))
        for name, points in ((f"_value_of_{pair}", 1j * w), (f"_value_of_{pair}_at", w)):
            if name in functions:
                # A band form takes s alone.
                takes = functions[name].__code__.co_argcount - 1
                given = [values[p.name] for p in tf.parameters][:takes]
                yield tf, [_unless_infinite(functions[name], p, *given) for p in points.tolist()]


def _unless_infinite(function: Callable[..., complex], *given: complex) -> complex:
    """Return a value, infinite at a pole: there Python raises, and Julia does not."""
    try:
        return function(*given)
    except ZeroDivisionError:
        return complex(math.inf)


def in_node(case: Case) -> Values:
    """Yield values of an ES module, all by one process of Node."""
    lines, asked = [f'import * as G from "./{case.name}.mjs";'], []
    for tf, pair, w in case.points():
        lines.append(
            f"[G.{pair}([new Float64Array({w.size}), Float64Array.from({json.dumps(w.tolist())})])].forEach("
        )
        lines.append("  ([x, y]) => x.forEach((re, i) => console.log(`${re} ${y[i]}`)));")
        asked.append((tf, w.size))
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / f"{case.name}.mjs").write_text(case.exported("js").text, encoding="utf-8")
        (Path(folder) / "values.mjs").write_text("\n".join(lines) + "\n", encoding="utf-8")
        done = subprocess.run(["node", "values.mjs"], cwd=folder, capture_output=True, text=True, check=True)
    rows = iter(done.stdout.replace("Infinity", "inf").splitlines())
    for tf, size in asked:
        yield tf, [complex(*map(float, next(rows).split())) for _ in range(size)]


def in_state_space(case: Case) -> Values:
    """Yield what the matrices of doubles say, computed without further errors."""
    module = imported(case.exported("state-space").text, f"{case.name}_state_space")
    a, b, c, d = (
        acb_mat(x.shape[0], x.shape[1], [acb(v) for v in x.flatten().tolist()]) for x in module.state_space()
    )
    outputs, inputs = ([row["name"] for row in rows] for rows in (module.OUTPUTS, module.INPUTS))
    size = a.nrows()
    for tf, _, w in case.points():
        row, column = outputs.index(tf.output.name), inputs.index(tf.input.name)
        values = []
        with ctx.workprec(BITS):
            unit = acb_mat(size, size, [int(i == j) for i in range(size) for j in range(size)])
            for omega in w.tolist():
                response = c * (unit * acb(0, omega) - a).solve(b) + d
                values.append(complex(response[row, column]))
        yield tf, values


TARGETS: Final[Mapping[str, Callable[[Case], Values]]] = {
    "numpy": in_numpy,
    "array-api": in_array_api,
    "jax": in_jax,
    "c": in_c,
    "matlab": in_octave,
    "julia": in_julia,
    "js": in_node,
    "state-space": in_state_space,
}
NEEDS: Final[Mapping[str, tuple[str, Callable[[str], object]]]] = {
    "array-api": ("array_api_strict", find_spec),
    "jax": ("jax", find_spec),
    "c": ("cc", shutil.which),
    "matlab": ("octave", shutil.which),
    "js": ("node", shutil.which),
}
"""What has to be installed, and what finds it."""
QUICK: Final[Mapping[str, Sequence[str]]] = {
    "two_mass": ("numpy", "array-api", "c", "matlab", "julia", "js", "state-space"),
    "sliding_free_beam": ("numpy", "c", "matlab", "julia", "js"),
    "conical_horn": ("numpy", "c"),
}
"""A lumped model, one with a formula of exponentials, and one that is followed along x."""


# -------------------------------------------------------------------------------------------- the table


@cache
def worst(name: str, target: str) -> float | None:
    """Return the worst error of a model's functions, ``None`` where the target refuses the model.

    Raises
    ------
    RuntimeError
        When an export has no functions.
    """
    case = case_of(name)
    try:
        found = [case.references[tf.name].worst_of(values) for tf, values in TARGETS[target](case)]
    except ModelError:
        return None
    if not found:
        message = f"{name} exported to {target} has no functions"
        raise RuntimeError(message)
    return max(found)


def documented() -> dict[str, dict[str, str]]:
    """Return the cells of the table in the documentation, by model and target."""
    return {
        name: dict(zip(TARGETS, (cell.strip() for cell in cells.split("|")), strict=False))
        for name, cells in ROW.findall(PAGE.read_text(encoding="utf-8"))
    }


def times_documented(error: float | None, cell: str) -> float:
    """Return how many times the documented error one is; infinite where only one of them is a refusal.

    Examples
    --------
    >>> times_documented(6e-16, "3.0e-16"), times_documented(None, "–"), times_documented(None, "3.0e-16")
    (2.0, 0.0, inf)
    """
    if error is None or cell == REFUSED:
        return 0.0 if error is None and cell == REFUSED else math.inf
    return error / float(cell)


def written(error: float | None) -> str:
    """Return a cell of the table: an error to two digits, rounded up.

    Examples
    --------
    >>> written(3.01e-16), written(9.99e-16), written(0.0), written(None)
    ('3.1e-16', '1.0e-15', '0', '–')
    """
    if error is None:
        return REFUSED
    if not (error and math.isfinite(error)):
        return f"{error:g}"
    exponent = math.floor(math.log10(error))
    return f"{math.ceil(error / 10.0 ** (exponent - 1)) * 10.0 ** (exponent - 1):.1e}".replace("e-0", "e-")


def measure(extent: Extent) -> Measured:
    """Measure all models in all languages that can be run here; of a quick run, one model of a kind."""
    targets = [target for target in TARGETS if _is_installed(target)]
    bounds = documented()
    lines = [
        "| | " + " | ".join(f"`{target}`" for target in TARGETS) + " |",
        "|---|" + "---:|" * len(TARGETS),
    ]
    times: dict[str, tuple[float, str]] = dict.fromkeys(targets, (0.0, ""))
    largest = 0.0
    for name, wanted in extent.of(dict.fromkeys(MODELS, tuple(TARGETS)), QUICK).items():
        cells = dict.fromkeys(TARGETS, "")
        for target in (target for target in targets if target in wanted):
            error = worst(name, target)
            cells[target] = written(error)
            largest = max(largest, error or 0.0)
            ratio = times_documented(error, bounds.get(name, {}).get(target, REFUSED))
            times[target] = max(times[target], (ratio, name))
        lines.append(f"| `{name}` | " + " | ".join(cells.values()) + " |")
        print(lines[-1], file=sys.stderr)
    claims = [
        Claim(
            f"errors of exports to `{target}`: times the documented one, at worst (`{name}`)",
            LIBRARIES_DIFFER,
            ratio,
            larger_is_better=False,
        )
        for target, (ratio, name) in times.items()
        if name
    ]
    claims.append(Claim("errors of exports: the largest", LARGEST, largest, larger_is_better=False))
    return Measured([], claims, ("\n".join(["## errors of exports", "", *lines]),))


def _is_installed(target: str) -> bool:
    """Return whether what runs the code of a target is there, and say so where it is not."""
    needed, finds = NEEDS.get(target, ("", str))
    if not needed or finds(needed) is not None:
        return True
    print(f"skipped, {needed} is not installed: errors of exports to {target}", file=sys.stderr)
    return False
