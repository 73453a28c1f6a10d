"""A fit as a specification: resonance blocks in cascade, on a model block for the base."""

from __future__ import annotations

import os
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from symflex.spec import write

if TYPE_CHECKING:
    from collections.abc import Collection

    from symflex.fitting.fit import Fit

DIGITS = 9
FREE_NAMES = ("U", "Y")


def fit_specification(fit: Fit, folder: str | Path) -> str:
    """Return the text of a specification with the fitted functions.

    Parameters
    ----------
    fit : Fit
        The result.
    folder : str or Path
        Where the file will stand: the base is referred to from there.

    Notes
    -----
    Frequencies are written in Hz and damping ratios as they are, with nine digits and their standard errors.
    Zeros in the right half plane have a negative damping ratio.
    """
    found, errors = fit.resonances, fit.standard_errors()
    prefix = ""
    taken = {name for base in fit.bases for name in base.taken}  # which mean something else
    while any(
        name.startswith(f"{prefix}{stem}")
        for name in taken
        for stem in ("omega_", "zeta_", "c_fit", "T_sensor")
    ):
        prefix += "fit_"
    outputs = _output_names(fit)
    source_name = fit.bases[0].tf.split("/")[1] if fit.bases[0].tf else _input_name(fit)
    parameters: dict[str, object] = {}
    blocks: dict[str, object] = {}
    factors: list[list[str]] = []
    several = found.responses > 1
    for i in range(found.count):
        name = f"{prefix}omega_p{i + 1}"
        parameters[name] = _frequency(found.omega_p[i], errors.omega_p[i], f"pole pair {i + 1}")
        parameters[f"{prefix}zeta_p{i + 1}"] = _ratio(found.zeta_p[i], errors.zeta_p[i])
    for r, output in enumerate(outputs):
        tail = f"_{output}" if several else ""
        base = fit.bases[r]
        parts: list[str] = []
        if base.path:
            block = _free("G_base" + tail, {source_name, *outputs, *taken})
            relative = os.path.relpath(os.path.abspath(base.path), os.path.abspath(folder))
            blocks[block] = {"type": "model", "spec": relative.replace(os.sep, "/"), "tf": base.tf}
            parts.append(block)
        if fit.problem.free.gain:
            gain = f"{prefix}c_fit{tail}"
            error = errors.gain[r]
            parameters[gain] = {
                "value": _exact(found.gain[r]),
                "assume": "real",
                "doc": f"gain, standard error {error:.2g}",
            }
            parts.append(gain)
        for i in range(found.count):
            omega, zeta = f"{prefix}omega_z{i + 1}{tail}", f"{prefix}zeta_z{i + 1}{tail}"
            where = f"zero pair {i + 1}" + (f" of {output}" if several else "")
            parameters[omega] = _frequency(found.omega_z[r, i], errors.omega_z[r, i], where)
            parameters[zeta] = _ratio(found.zeta_z[r, i], errors.zeta_z[r, i])
            block = f"R_{i + 1}{tail}"
            blocks[block] = {
                "type": "resonance",
                "omega_p": f"{prefix}omega_p{i + 1}",
                "zeta_p": f"{prefix}zeta_p{i + 1}",
                "omega_z": omega,
                "zeta_z": zeta,
            }
            parts.append(block)
        if fit.problem.free.lag:
            lag, block = f"{prefix}T_sensor{tail}", f"L_sensor{tail}"
            value = float(found.lag[r])
            parameters[lag] = {
                "value": f"{_plain(abs(value))} s",
                "assume": "nonnegative",
                "doc": f"lag of the sensor, standard error {errors.lag[r]:.2g} s",
            }
            ends = ("0", lag) if value >= 0 else (lag, "0")
            blocks[block] = {"type": "lead_lag", "T_1": ends[0], "T_2": ends[1]}
            parts.append(block)
        if not base.path and base.slope:
            parts.append(
                "s" if base.slope == 1 else f"s^{base.slope}" if base.slope > 0 else f"(1/s^{-base.slope})"
            )
        factors.append(parts)
    files = ", ".join(dict.fromkeys(m.name for m in fit.measured))
    kind = "SYNTHETIC data" if any(m.is_synthetic for m in fit.measured) else "measured data"
    low, high = (value / (2 * np.pi) for value in fit.problem.band)
    return write(
        {
            "symflex": 1,
            "title": f"{found.count} simple resonances fitted to {kind}",
            "source": f"symflex fit of {files}, {low:.4g} to {high:.4g} Hz; form of the resonances: "
            "Eppinger & Seering 1988, section 'Polynomial Resonance Model'",
            "parameters": parameters,
            "blocks": blocks,
            "inputs": {source_name: {}},
            "outputs": {
                output: "*".join([*parts, source_name])
                for output, parts in zip(outputs, factors, strict=True)
            },
            "analysis": {"band": [f"{low:.6g} Hz", f"{high:.6g} Hz"]},
        }
    )


def _frequency(omega: float, error: float, where: str) -> dict[str, object]:
    hertz = omega / (2 * np.pi)
    doc = f"{where}, standard error {error / (2 * np.pi):.2g} Hz"
    return {"value": f"{_plain(hertz)} Hz", "doc": doc}


def _ratio(value: float, error: float) -> dict[str, object]:
    entry: dict[str, object] = {"value": _exact(value)}
    if value <= 0:
        entry["assume"] = "real"
    return entry | {"doc": f"standard error {error:.2g}"}


def _plain(value: float) -> str:
    return np.format_float_positional(float(f"{value:.{DIGITS}g}"), trim="-")


def _exact(value: float) -> Fraction:
    return Fraction(f"{value:.{DIGITS}g}")


def _is_name(text: str) -> bool:
    return text.isascii() and text.isidentifier() and not text.startswith("_") and len(text) < 40  # noqa: PLR2004


def _input_name(fit: Fit) -> str:
    ends = fit.measured[0].name.split("/")
    return ends[1] if len(ends) == 2 and all(map(_is_name, ends)) else FREE_NAMES[0]  # noqa: PLR2004


def _output_names(fit: Fit) -> list[str]:
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
