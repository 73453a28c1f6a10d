"""A fit as a specification: resonance blocks in cascade, on a model block for the base or on a copy of it.

A ``model`` block takes over rational functions only. A base with delays, beams or fields is therefore copied:
its sections stand in the new file, and the resonances multiply its outputs there.
"""

from __future__ import annotations

import os
import re
import tomllib
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from symflex.errors import Diagnostic, FitError, Source, SymflexError
from symflex.model import load_with
from symflex.model.spec import read, write
from symflex.transfer.of_model import assemble, check_solvable

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from symflex.data.fitting.fit import ResonanceFit
    from symflex.data.fitting.resonances import Resonances

DIGITS = 9
FREE_NAMES = ("U", "Y")
COPIED = ("parameters", "definitions", "elements", "signals", "blocks", "fields")
"""Sections of a base that are copied; its outputs are multiplied, and its figures show another model."""


def fit_specification(found: ResonanceFit, folder: str | Path) -> str:
    """Return the specification of a fit that will stand in a folder.

    It has been read, resolved and assembled as ``symflex check`` does. A base that a ``model`` block can
    stand for is referred to; any other, and one that does not stand at or below the folder, is copied. SF617
    where neither way gives a specification that is accepted.
    """
    bases = tuple(dict.fromkeys(Path(base.path) for base in found.bases if base.path))
    allowed = tuple(place for base in found.bases for place in base.folders)
    taken = {name for base in found.bases for name in base.taken}
    ways: list[Mapping[str, object] | None] = [None]
    if len(bases) == 1:
        source = read(bases[0])
        whole = tomllib.loads(source.text, parse_float=Decimal)
        own = found.bases[0].tf.split("/")[1]
        # Other inputs of the base are left out, unless something there needs them.
        ways += [whole | {"inputs": {own: whole["inputs"][own]}}, whole]
        words = taken | set(re.findall(r"\w+", source.text))
    # A file that needs --allow-outside is the last resort: where the base itself needs it.
    for outside in ((), allowed):
        for copied in ways:
            text = _written(found, folder, taken if copied is None else words, copied)
            try:
                model = load_with(Source(str(Path(folder) / "fitted.toml"), text), {}, allow_outside=outside)
                check_solvable(assemble(model))
            except SymflexError as error:
                refused = error.diagnostics[0]
            else:
                return text
    message = f"the fit cannot be written as a specification: {refused.message}"
    raise FitError(Diagnostic("SF617", message, None, refused.hint))


def _written(
    fit: ResonanceFit,
    folder: str | Path,
    taken: Collection[str] = (),
    copied: Mapping[str, object] | None = None,
) -> str:
    """Return the text of a specification with the fitted functions.

    Frequencies are written in Hz and damping ratios as they are, with nine digits and their standard errors.
    Zeros in the right half plane have a negative damping ratio. Names of the base's parameters are ``taken``:
    they mean something else. The base is ``copied`` as nested values, or referred to by a ``model`` block
    from the folder.
    """
    found, errors = fit.resonances, fit.standard_errors()
    prefix = _prefix(taken)
    outputs = _output_names(fit)
    source_name = fit.bases[0].tf.split("/")[1] if fit.bases[0].tf else _input_name(fit)
    parameters: dict[str, object] = {}
    blocks: dict[str, object] = {}
    expressions: dict[str, object] = {}
    several = found.responses > 1
    used = {source_name, *outputs, *taken}
    for i in range(found.count):
        name = f"{prefix}omega_p{i + 1}"
        parameters[name] = _frequency(
            found.omega_p[i],
            errors.omega_p[i],
            f"pole pair {i + 1}" + ("" if fit.modes[i] else ", a residual term"),
        )
        parameters[f"{prefix}zeta_p{i + 1}"] = _ratio(found.zeta_p[i], errors.zeta_p[i])
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
            parameters[parts[-1]] = {"value": _exact(found.gain[r]), "assume": "real", "doc": doc}
        for i in range(found.count):
            omega_z, block = found.omega_z[r, i], names.block(f"R_{i + 1}")
            pair = names.pair(i + 1)
            if np.isfinite(omega_z):
                where = f"zero pair {i + 1}" + (f" of {output}" if several else "")
                where = where if omega_z > 0 else f"real zeros of opposite sign, {where}"
                parameters[pair["omega_z"]] = _frequency(abs(omega_z), errors.omega_z[r, i], where)
                parameters[pair["zeta_z"]] = _ratio(found.zeta_z[r, i], errors.zeta_z[r, i])
            blocks[block] = _resonance(pair, omega_z)
            parts.append(block)
        own, more, factors = _beside(fit, r, errors, names)
        parameters |= own
        blocks |= more
        parts += factors
        if not base.path and base.slope:
            power = "s" if abs(base.slope) == 1 else f"s^{abs(base.slope)}"
            parts.append(power if base.slope > 0 else f"(1/{power})")
        driven = source_name if copied is None else f"({_output_of(copied, base.tf)})"
        expressions[output] = "*".join([*parts, driven])
    sections: dict[str, object] = {"parameters": parameters, "blocks": blocks, "inputs": {source_name: {}}}
    if copied is not None:
        sections = _with_copy(sections, copied, Path(fit.bases[0].path).parent, folder)
    files = ", ".join(dict.fromkeys(m.name for m in fit.measured))
    kind = "SYNTHETIC data" if any(m.is_synthetic for m in fit.measured) else "measured data"
    low, high = (value / (2 * np.pi) for value in fit.problem.band)
    return write(
        {
            "symflex": 1,
            "title": f"{int(fit.modes.sum())} simple resonances fitted to {kind}",
            "source": f"symflex fit of {files}, {low:.4g} to {high:.4g} Hz; form of the resonances: "
            "Eppinger & Seering 1988, section 'Polynomial Resonance Model'",
            **({"doc": f"on a copy of {Path(fit.bases[0].path).name}, {fit.bases[0].tf}"} if copied else {}),
            **sections,
            "outputs": expressions,
            "analysis": {"band": [f"{low:.6g} Hz", f"{high:.6g} Hz"]},
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


def _single(
    fit: ResonanceFit, response: int, errors: Resonances, names: _Names
) -> tuple[dict[str, object], list[str]]:
    """Return parameters and factors of the single real pole and the single real zero."""
    found = fit.resonances
    parameters: dict[str, object] = {}
    factors: list[str] = []
    corner = found.real_z[response]
    if np.isfinite(corner):
        name = names.parameter("omega_s")
        parameters[name] = _frequency(abs(corner), errors.real_z[response], "real zero")
        factors.append(f"(1 {'+' if corner > 0 else '-'} s/{name})")
    for pole, error in zip(found.real_p, errors.real_p, strict=True):
        name = f"{names.prefix}omega_r"
        parameters[name] = _frequency(pole, error, "real pole")
        factors.append(f"(1/(1 + s/{name}))")
    return parameters, factors


def _beside(
    fit: ResonanceFit, response: int, errors: Resonances, names: _Names
) -> tuple[dict[str, object], dict[str, object], list[str]]:
    """Return parameters, blocks and factors of what stands beside the pairs, lag and dead time among it."""
    parameters, factors = _single(fit, response, errors, names)
    blocks: dict[str, object] = {}
    found = fit.resonances
    if fit.problem.free.lag:
        name, value = names.parameter("T_sensor"), found.lag[response]
        parameters[name] = _time(value, errors.lag[response], "lag of the sensor")
        ends = ("0", name) if value >= 0 else (name, "0")
        blocks[names.block("L_sensor")] = {"type": "lead_lag", "T_1": ends[0], "T_2": ends[1]}
    if fit.problem.free.delay:
        name = names.parameter("T_dead")
        parameters[name] = _time(found.delay[response], errors.delay[response], "dead time")
        blocks[names.block("D_dead")] = {"type": "delay", "T": name}
    return parameters, blocks, [*factors, *blocks]


def _prefix(taken: Collection[str]) -> str:
    """Return what the names of fitted parameters begin with, so that none of a base is among them."""
    stems, prefix = ("omega_", "zeta_", "c_fit", "T_sensor", "T_dead"), ""
    while any(name.startswith(f"{prefix}{stem}") for name in taken for stem in stems):
        prefix += "fit_"
    return prefix


def _resonance(names: Mapping[str, str], omega_z: float) -> dict[str, object]:
    """Return the block of one resonance, whose zeros may be absent or two real ones of opposite sign."""
    if 0 < omega_z < np.inf:
        return {"type": "resonance", **names}
    omega, zeta = names["omega_p"], names["zeta_p"]
    above = "1"
    if omega_z < 0:
        above = f"1 + 2*{names['zeta_z']}*s/{names['omega_z']} - s^2/{names['omega_z']}^2"
    return {"type": "tf", "num": above, "den": f"1 + 2*{zeta}*s/{omega} + s^2/{omega}^2"}


def _output_of(copied: Mapping[str, object], tf: str) -> str:
    """Return the expression of the output of a base."""
    outputs = copied["outputs"]
    entry = outputs[tf.split("/", maxsplit=1)[0]] if isinstance(outputs, dict) else ""
    return str(entry["expr"] if isinstance(entry, dict) else entry)


def _with_copy(
    sections: dict[str, object], copied: Mapping[str, object], origin: Path, folder: str | Path
) -> dict[str, object]:
    """Return the sections of a fit with those of its base, whose files are named from a new folder."""
    found = dict(sections)
    for name in COPIED:
        section = copied.get(name)
        if not isinstance(section, dict):
            continue
        entries = {}
        for key, entry in section.items():
            entries[key] = entry
            if name == "blocks" and isinstance(entry, dict) and entry.get("type") == "model":
                entries[key] = entry | {"spec": _relative(origin / str(entry["spec"]), folder)}
        own = found.get(name)
        found[name] = (own if isinstance(own, dict) else {}) | entries
    return found | {"inputs": copied["inputs"]}


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
    return (
        f"standard error {error:.2g} {unit}".rstrip() if np.isfinite(error) else "not determined by the data"
    )


def _plain(value: float) -> str:
    return np.format_float_positional(float(f"{value:.{DIGITS}g}"), trim="-")


def _exact(value: float) -> Fraction:
    return Fraction(f"{value:.{DIGITS}g}")


def _is_name(text: str) -> bool:
    return text.isascii() and text.isidentifier() and not text.startswith("_") and len(text) < 40  # noqa: PLR2004


def _input_name(fit: ResonanceFit) -> str:
    ends = fit.measured[0].name.split("/")
    return ends[1] if len(ends) == 2 and all(map(_is_name, ends)) else FREE_NAMES[0]  # noqa: PLR2004


def _output_names(fit: ResonanceFit) -> list[str]:
    names: list[str] = []
    for base, measured in zip(fit.bases, fit.measured, strict=True):
        ends = (base.tf or measured.name).split("/")
        name = ends[0] if len(ends) == 2 and all(map(_is_name, ends)) else FREE_NAMES[1]  # noqa: PLR2004
        names.append(_free(name, names))
    return names


def _free(name: str, taken: Collection[str]) -> str:
    number, found = 1, name
    while found in taken:
        number += 1
        found = f"{name}_{number}"
    return found
