"""A fit as a specification: resonance blocks in cascade, on a model block for the base or on a copy of it.

A ``model`` block takes over rational functions only. A base with delays, beams or fields is therefore copied:
its sections stand in the new file, and the resonances multiply its outputs there.

With a loop, the input is a signal: a gain times what the first output lacks of a reference.
"""

from __future__ import annotations

import os
import re
import tomllib
import unicodedata
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy as np

from symflex.data.fitting.fit import ResonanceFit
from symflex.data.fitting.machine import OF_SPREAD
from symflex.data.fitting.parameter_fit import ParameterFit
from symflex.data.fitting.resonances import Resonances
from symflex.data.fitting.text import ends_of_band
from symflex.errors import Diagnostic, FitError, Source, SymflexError, refused
from symflex.model import load_with
from symflex.model.scope import RESERVED
from symflex.model.spec import read
from symflex.model.spec.write import write
from symflex.transfer.of_model import assemble, check_solvable

DIGITS = 9
FREE_NAMES = ("U", "Y")
LONGEST = 32  # characters of a name that is made of a text
COPIED = ("parameters", "definitions", "elements", "signals", "blocks", "fields")
"""Sections of a base that are copied; its outputs are multiplied, and its figures show another model."""


def fit_specification(fit: ResonanceFit, folder: str | Path, loop: str | None = None) -> str:
    """Return the specification of a fit that will stand in a folder, with a loop whose gain has this name."""
    bases = tuple(dict.fromkeys(Path(base.path) for base in fit.bases if base.path))
    allowed = tuple(folder_allowed for base in fit.bases for folder_allowed in base.folders)
    taken = {name for base in fit.bases for name in base.taken}
    ways: list[Mapping[str, object] | None] = [None]
    if loop is not None and (not _is_name(loop) or loop in {*RESERVED, *taken}):
        raise refused(f"'{loop[:64]}' is not a valid name for the gain of a loop", "say K")
    if len(bases) == 1 and loop is None:  # a copied base has inputs of its own, which no signal drives
        source = read(bases[0])
        base_spec = tomllib.loads(source.text, parse_float=Decimal)
        driven = fit.bases[0].tf.split("/")[1]
        # Other inputs of the base are left out, unless something there needs them.
        ways += [base_spec | {"inputs": {driven: base_spec["inputs"][driven]}}, base_spec]
        words = taken | set(re.findall(r"\w+", source.text))
    # A file that needs --allow-outside is the last resort: where the base itself needs it.
    for outside in ((), allowed):
        for copied in ways:
            text = _written(fit, folder, taken if copied is None else words, copied, loop)
            try:
                model = load_with(Source(str(Path(folder) / "fitted.toml"), text), {}, allow_outside=outside)
                check_solvable(assemble(model))
            except SymflexError as error:
                why = error.diagnostics[0]
            else:
                return text
    message = f"the fit cannot be written as a specification: {why.message}"
    raise FitError(Diagnostic("SF617", message, None, why.hint))


def machine_specification(fit: ParameterFit, folder: str | Path, date: str) -> str:
    """Return the specification of fitted parameters with their values and errors, for a folder.

    A spread is the half of the interval that holds 95 % of a normal distribution, so that the next fit takes
    this one for what it is.
    """
    machine, path = fit.machine, Path(fit.machine.path)
    source = tomllib.loads(read(path).text, parse_float=Decimal)
    names = ", ".join(dict.fromkeys(one.name for one in fit.residual.measured))
    kind = "SYNTHETIC data, " if any(one.is_synthetic for one in fit.residual.measured) else ""
    sections = _with_copy({}, source, path.parent, folder)
    parameters = dict(source["parameters"])
    for p, value, error in zip(machine.parameters, fit.theta.tolist(), fit.errors.tolist(), strict=True):
        if not np.isfinite(error):
            continue
        given = parameters[p.name]
        entry = dict(given) if isinstance(given, dict) else {}
        unit = "" if "unit" in entry else p.written_unit
        scale = float(p.scale.nearly) if p.written_unit else 1.0
        written, off = value / scale, error / scale
        entry["value"] = f"{written:.{DIGITS}g} {unit}" if unit else _exact(written)
        before = str(entry.get("doc", "")).partition("; fitted to ")[0]
        accuracy = _said_error(off, p.written_unit)
        entry["doc"] = f"{before}; fitted to {kind}{names}, {accuracy}, {date}".removeprefix("; ")
        half = OF_SPREAD * off
        if 0 < half < abs(written) or p.assume == "real":
            entry["spread"] = f"{half:.2g} {p.written_unit or p.unit}".rstrip()
        else:
            entry.pop("spread", None)
        parameters[p.name] = entry
    every = {name: sections.get(name, value) for name, value in source.items()}
    text = write(every | {"parameters": parameters})
    try:
        load_with(Source(str(Path(folder) / "fitted.toml"), text), {}, allow_outside=(path.parent,))
    except SymflexError as error:
        why = error.diagnostics[0]
        message = f"the fit cannot be written as a specification: {why.message}"
        raise FitError(Diagnostic("SF617", message, None, why.hint)) from None
    return text


def _written(
    fit: ResonanceFit,
    folder: str | Path,
    taken: Collection[str],
    copied: Mapping[str, object] | None,
    loop: str | None,
) -> str:
    """Return the text; names of the base, ``copied`` as nested values or a ``model`` block, are ``taken``."""
    modes, errors = fit.resonances, fit.standard_errors()
    prefix = _prefix(taken)
    outputs = _output_names(fit)
    source_name = fit.bases[0].tf.partition("/")[2] or _ends(fit.measured[0].name)[1]
    parameters: dict[str, object] = {}
    blocks: dict[str, object] = {}
    expressions: dict[str, object] = {}
    several = modes.responses > 1
    used = {source_name, *outputs, *taken}
    for i in range(modes.count):
        name = f"{prefix}omega_p{i + 1}"
        what = f"pole pair {i + 1}" + ("" if fit.modes[i] else ", a residual term")
        parameters[name] = _frequency(modes.omega_p[i], errors.omega_p[i], what)
        parameters[f"{prefix}zeta_p{i + 1}"] = _ratio(modes.zeta_p[i], errors.zeta_p[i])
    for r, output in enumerate(outputs):
        base = fit.bases[r]
        names = _Names(prefix, f"_{output}" if several else "", used)
        parts: list[str] = []
        if base.path and copied is None:
            block = names.block("G_base")
            blocks[block] = {"type": "model", "spec": _relative(base.path, folder), "tf": base.tf}
            parts.append(block)
        if fit.problem.free.gain:
            parts.append(names.parameter("c_fit"))
            doc = f"gain, {_said_error(errors.gain[r])}"
            value: object = _exact(modes.gain[r])
            if not base.path and (unit := fit.measured[r].unit) not in ("", "1"):
                value = f"{modes.gain[r]:.{DIGITS}g} ({unit})" + (f"*s^({base.slope})" if base.slope else "")
            parameters[parts[-1]] = {"value": value, "assume": "real", "doc": doc}
        for declared, more, factors in (_pairs(fit, r, errors, names), _beside(fit, r, errors, names)):
            parameters |= declared
            blocks |= more
            parts += factors
        if not base.path and base.slope:
            power = "s" if abs(base.slope) == 1 else f"s^{abs(base.slope)}"
            parts.append(power if base.slope > 0 else f"(1/{power})")
        driven = source_name if copied is None else f"({_output_of(copied, base.tf)})"
        expressions[output] = "*".join([*parts, driven])
    sections: dict[str, object] = {"parameters": parameters, "blocks": blocks}
    if loop is None:
        sections |= {"inputs": {source_name: {}}, "outputs": expressions}
    else:
        sections |= _loop(loop, source_name, expressions, {*used, *parameters, *blocks})
        unit = fit.bases[0].unit if fit.bases[0].path else fit.measured[0].unit
        doc = f"gain of the loop from {outputs[0]}: symflex stability --gain {loop} finds its stable values"
        parameters[loop] = {"value": f"1 1/({unit})" if unit not in ("", "1") else 1, "doc": doc}
    if copied is not None:
        sections = _with_copy(sections, copied, Path(fit.bases[0].path).parent, folder)
    files = ", ".join(dict.fromkeys(m.name for m in fit.measured))
    kind = "SYNTHETIC data" if any(m.is_synthetic for m in fit.measured) else "measured data"
    low, high = (value / (2 * np.pi) for value in fit.problem.band)
    ends, count = ends_of_band(low, high), int(fit.modes.sum())
    return write(
        {
            "symflex": 1,
            "title": f"{count or 'no'} simple {'resonance' if count == 1 else 'resonances'} fitted to {kind}",
            "source": f"symflex fit of {files}, {ends[0]} to {ends[1]} Hz; form of the resonances: "
            "Eppinger & Seering 1988, section 'Polynomial Resonance Model'",
            **({"doc": f"on a copy of {Path(fit.bases[0].path).name}, {fit.bases[0].tf}"} if copied else {}),
            **sections,
            "analysis": {"band": [f"{_plain(x)} Hz" for x in (low, high)], "data_end": f"{_plain(high)} Hz"},
        }
    )


@dataclass(frozen=True, slots=True)
class _Names:
    """Names of the parameters and blocks of one response, apart from those that are used."""

    prefix: str
    tail: str
    used: set[str]

    def parameter(self, stem: str) -> str:
        return f"{self.prefix}{stem}{self.tail}"

    def block(self, stem: str) -> str:
        return _free(stem + self.tail, self.used)

    def pair(self, number: int) -> dict[str, str]:
        poles = {name: f"{self.prefix}{name}{number}" for name in ("omega_p", "zeta_p")}
        return poles | {name: self.parameter(f"{name}{number}") for name in ("omega_z", "zeta_z")}


_Parts = tuple[dict[str, object], dict[str, object], list[str]]  # parameters, blocks, factors


def _pairs(fit: ResonanceFit, response: int, errors: Resonances, names: _Names) -> _Parts:
    """Return parameters of the pairs of zeros, blocks of the resonances, and both as factors."""
    modes = fit.resonances
    parameters: dict[str, object] = {}
    blocks: dict[str, object] = {}
    factors: list[str] = []
    for i in range(modes.count):
        omega_z, block, pair = modes.omega_z[response, i], names.block(f"R_{i + 1}"), names.pair(i + 1)
        if np.isfinite(omega_z):
            where = f"zero pair {i + 1}" + (f" of {names.tail[1:]}" if names.tail else "")
            where = where if omega_z > 0 else f"real zeros of opposite sign, {where}"
            parameters[pair["omega_z"]] = _frequency(abs(omega_z), errors.omega_z[response, i], where)
            parameters[pair["zeta_z"]] = _ratio(modes.zeta_z[response, i], errors.zeta_z[response, i])
        if omega_z < 0:  # two real zeros of opposite sign, whose frequency is in Hz
            omega, zeta = f"(2*pi*{pair['omega_z']})", pair["zeta_z"]
            factors.append(f"(1 + 2*{zeta}*s/{omega} - s^2/{omega}^2)")
        low_pass = {"type": "low_pass", "omega": pair["omega_p"], "zeta": pair["zeta_p"]}
        blocks[block] = {"type": "resonance", **pair} if 0 < omega_z < np.inf else low_pass
        factors.append(block)
    return parameters, blocks, factors


def _beside(fit: ResonanceFit, response: int, errors: Resonances, names: _Names) -> _Parts:
    """Return parts of what stands beside the pairs: a real pole and a real zero, lag and delay."""
    modes = fit.resonances
    parameters: dict[str, object] = {}
    blocks: dict[str, object] = {}
    factors: list[str] = []
    corner = modes.real_z[response]
    if np.isfinite(corner):
        name = names.parameter("omega_s")
        parameters[name] = _frequency(abs(corner), errors.real_z[response], "real zero")
        factors.append(f"(1 {'+' if corner > 0 else '-'} s/(2*pi*{name}))")
    for pole, error in zip(modes.real_p, errors.real_p, strict=True):
        name = f"{names.prefix}omega_r"
        parameters[name] = _frequency(pole, error, "real pole")
        factors.append(f"(1/(1 + s/(2*pi*{name})))")
    if fit.problem.free.lag:
        name, value = names.parameter("T_sensor"), modes.lag[response]
        parameters[name] = _time(value, errors.lag[response], "lag of the sensor")
        ends = ("0", name) if value >= 0 else (name, "0")
        blocks[names.block("L_sensor")] = {"type": "lead_lag", "T_1": ends[0], "T_2": ends[1]}
    if fit.problem.free.delay:
        name = names.parameter("T_dead")
        parameters[name] = _time(modes.delay[response], errors.delay[response], "delay")
        blocks[names.block("D_dead")] = {"type": "delay", "T": name}
    return parameters, blocks, [*factors, *blocks]


def _prefix(taken: Collection[str]) -> str:
    """Return what the names of fitted parameters begin with, so that none of a base is among them."""
    stems, prefix = ("omega_", "zeta_", "c_fit", "T_sensor", "T_dead"), ""
    while any(name.startswith(f"{prefix}{stem}") for name in taken for stem in stems):
        prefix += "fit_"
    return prefix


def _loop(
    gain: str, driven: str, expressions: Mapping[str, object], used: Collection[str]
) -> dict[str, object]:
    """Return the sections of a loop from the first output to what has been the input."""
    first = next(iter(expressions))
    reference, error, fed_back = (_free(name, used) for name in ("r", "e", "y"))
    signals = {error: f"{reference} - {fed_back}", driven: f"{gain}*{error}", fed_back: expressions[first]}
    return {"inputs": {reference: {}}, "signals": signals, "outputs": {**expressions, first: fed_back}}


def _output_of(copied: Mapping[str, object], tf: str) -> str:
    outputs = copied["outputs"]
    entry = outputs[tf.split("/", maxsplit=1)[0]] if isinstance(outputs, dict) else ""
    return str(entry["expr"] if isinstance(entry, dict) else entry)


def _with_copy(
    sections: dict[str, object], copied: Mapping[str, object], origin: Path, folder: str | Path
) -> dict[str, object]:
    """Return the sections of a fit with those of its base, whose files are named from a new folder."""
    merged = dict(sections)
    for name in COPIED:
        section = copied.get(name)
        if not isinstance(section, dict):
            continue
        entries = dict(section)
        for key, entry in section.items():
            if name == "blocks" and isinstance(entry, dict) and entry.get("type") == "model":
                entries[key] = entry | {"spec": _relative(origin / str(entry["spec"]), folder)}
        declared = merged.get(name)
        merged[name] = (declared if isinstance(declared, dict) else {}) | entries
    return merged | {"inputs": copied["inputs"]}


def _relative(path: str | Path, folder: str | Path) -> str:
    return os.path.relpath(os.path.abspath(path), os.path.abspath(folder)).replace(os.sep, "/")


def _time(value: float, error: float, what: str) -> dict[str, object]:
    doc = f"{what}, {_said_error(error, 's')}"
    return {"value": f"{_plain(abs(value))} s", "assume": "nonnegative", "doc": doc}


def _frequency(omega: float, error: float, where: str) -> dict[str, object]:
    hertz = omega / (2 * np.pi)
    doc = f"{where}, {_said_error(error / (2 * np.pi), 'Hz')}"
    return {"value": f"{_plain(hertz)} Hz", "doc": doc}


def _ratio(value: float, error: float) -> dict[str, object]:
    entry: dict[str, object] = {"value": _exact(value)}
    if value <= 0:
        entry["assume"] = "real"
    return entry | {"doc": _said_error(error)}


def _said_error(error: float, unit: str = "") -> str:
    accuracy = f"standard error {error:.2g} {unit}".rstrip()
    return accuracy if np.isfinite(error) else "not determined by the data"


def _plain(value: float) -> str:
    return np.format_float_positional(float(f"{value:.{DIGITS}g}"), trim="-")


def _exact(value: float) -> Fraction:
    return Fraction(f"{value:.{DIGITS}g}")


def _is_name(text: str) -> bool:
    return text.isascii() and text.isidentifier() and not text.startswith("_") and len(text) < 40  # noqa: PLR2004


def _named(text: str) -> str:
    """Return a name made of the letters and digits of a text; empty if it has none.

    >>> _named("Signal 2"), _named("2024-05 Höhe.csv"), _named("s")
    ('Signal_2', 'Y_2024_05_Hohe_csv', 's_')
    """
    plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()
    name = re.sub(r"[^A-Za-z0-9]+", "_", plain).strip("_")[:LONGEST].rstrip("_")
    name = f"{FREE_NAMES[1]}_{name}" if name[:1].isdigit() else name
    return f"{name}_" if name in RESERVED else name


def _ends(name: str) -> tuple[str, str]:
    """Return names of the output and the input that a response is called by: a quotient of two, or one."""
    above, _, below = name.rpartition("/") if name.count("/") == 1 else (name, "", "")
    return _named(above) or FREE_NAMES[1], _named(below) or FREE_NAMES[0]


def _output_names(fit: ResonanceFit) -> list[str]:
    names: list[str] = []
    for base, measured in zip(fit.bases, fit.measured, strict=True):
        names.append(_free(_ends(base.tf or measured.name)[0], names))
    return names


def _free(name: str, taken: Collection[str]) -> str:
    number, free = 1, name
    while free in taken:
        number += 1
        free = f"{name}_{number}"
    return free
