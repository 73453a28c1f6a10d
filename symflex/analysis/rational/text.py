"""Rational approximations as text for a terminal and as JSON data."""

from __future__ import annotations

from math import isfinite, pi
from typing import TYPE_CHECKING

import mpmath

from symflex.analysis.rational.toolboxes import PERCENTS
from symflex.balls import to_complex_mpmath
from symflex.print.text import Passage, passages_text

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from symflex.analysis.rational import RationalApproximation
    from symflex.roots import Root

SCHEMA = "symflex.rational/1"
INDENT = "  "
ESTIMATE = "some poles or zeros could not be told apart, or are not proved"
DIGITS = 10
JSON_DIGITS = 17
"""So many give a double back exactly."""

Row = tuple[str, ...]


def rational_text(approximation: RationalApproximation) -> str:
    r"""Return an approximation as tables, with the frequencies up to which it is valid, in 80 columns.

    Examples
    --------
    >>> from symflex import pipeline
    >>> from symflex.analysis.rational import approximate
    >>> model = pipeline.loads('symflex = 1\ninputs.u = {}\noutputs.y = "3*u/(s + 2)"')
    >>> print(rational_text(approximate(pipeline.derive_bound(model, [("y", "u")])[0])))
    y/u   transfer function [s], product form, 1 mode; stable
    <BLANKLINE>
      exact: nothing is left out of this rational function
      gain: 3
      static gain: 1.5
    <BLANKLINE>
      poles: 1
        Re [rad/s]  Im [rad/s]   f [Hz]  zeta
                -2           0  0.31831     1
    <BLANKLINE>
      zeros: none
    """
    return passages_text(_passages(approximation))


def rational_html(approximation: RationalApproximation) -> str:
    """Return the same for a notebook: paragraphs and tables."""
    from symflex.print.html import passages_html  # only notebooks ask

    return passages_html(_passages(approximation))


def _passages(approximation: RationalApproximation) -> Iterator[Passage]:
    head, *said = _said(approximation)
    yield Passage([head])
    yield Passage([INDENT + line for line in said])
    if approximation.residues:
        yield Passage([_counted("poles and residues", approximation.poles)], _residue_rows(approximation))
    else:
        yield Passage([_counted("poles", approximation.poles)], _root_rows(approximation.poles))
    yield Passage([_counted("zeros", approximation.zeros)], _root_rows(approximation.zeros))
    if approximation.is_estimate:
        yield Passage([f"{INDENT}{ESTIMATE}"])


def _said(approximation: RationalApproximation) -> list[str]:
    """Return a heading, how good the approximation is, and its behaviour at low frequency."""
    source = approximation.bound.source
    quantity = source.quantity + (f" [{source.unit}]" if source.unit else "")
    modes = "1 mode" if approximation.modes == 1 else f"{approximation.modes} modes"
    headline = approximation.stability.headline
    lines = [f"{approximation.tf}   {quantity}, {approximation.form} form, {modes}; {headline}"]
    lines += [*_validity(approximation), f"gain: {_decimal(approximation.gain)}"]
    leading = f"{approximation.leading_coefficient:.{DIGITS}g}"
    order = approximation.order_at_zero
    lines.append(f"near s = 0: {leading}*s^{order}" if order else f"static gain: {leading}")
    for i, constant in enumerate(approximation.correction):
        name = "static correction" if i == 0 else f"and of s^{i}"
        lines.append(f"{name}: {_decimal(constant)}")
    return lines


def _validity(approximation: RationalApproximation) -> list[str]:
    if approximation.is_exact:
        return ["exact: nothing is left out of this rational function"]
    lines = []
    for percent in PERCENTS:
        limit = approximation.valid_to(percent / 100)
        if not limit:
            lines.append(f"already off by more than {percent} % at {approximation.scan.low_hz:.4g} Hz")
        else:
            least = "at least " if limit == approximation.scan.high_hz else ""
            lines.append(f"within {percent} % of the exact function up to {least}{limit:.6g} Hz")
    error, scan = approximation.error, approximation.scan
    band = f"{error.low_hz:.4g} to {error.high_hz:.4g} Hz"
    lines.append(f"worst error from {band}: {100 * error.worst:.3g} %, at {error.worst_at_hz:.6g} Hz")
    sampled = f"{len(scan.error)} samples from {scan.low_hz:.4g} to {scan.high_hz:.6g} Hz"
    lines.append(f"sampled, not proved: {sampled}")
    if approximation.omitted_hz is not None:
        lines.append(f"the first pole left out is at {approximation.omitted_hz:.6g} Hz")
    return lines


def _decimal(number: mpmath.mpf, digits: int = DIGITS) -> str:
    if number == 0:
        return "0"
    text = str(mpmath.nstr(number, digits, min_fixed=-4, max_fixed=digits))
    return text.removesuffix(".0")


def _counted(title: str, roots: Sequence[mpmath.mpc]) -> str:
    return f"{INDENT}{title}: {len(roots) or 'none'}"


def _unique(roots: Sequence[mpmath.mpc]) -> list[tuple[mpmath.mpc, int, bool]]:
    """Return the roots of the upper half plane, how often each occurs, and whether it is one of a pair."""
    counts: dict[mpmath.mpc, int] = {}
    for root in roots:
        counts[root] = counts.get(root, 0) + 1
    return [(root, n, root.imag != 0) for root, n in counts.items() if root.imag >= 0]


def _root_rows(roots: Sequence[mpmath.mpc]) -> list[Row]:
    if not roots:
        return []
    head = ("", "Re [rad/s]", "Im [rad/s]", "f [Hz]", "zeta")
    return [head, *(_root_cells(*root) for root in _unique(roots))]


def _root_cells(root: mpmath.mpc, count: int, paired: bool) -> tuple[str, str, str, str, str]:
    size = abs(complex(root))
    times = f"x{count}" if count > 1 else ""
    im = ("+-" if paired else "") + _decimal(root.imag)
    zeta = f"{-float(root.real) / size + 0:.6g}" if size else ""
    return times, _decimal(root.real), im, f"{size / (2 * pi):.6g}", zeta


def _residue_rows(approximation: RationalApproximation) -> list[Row]:
    highest = max(len(residue.coefficients) for residue in approximation.residues)
    rows: list[Row] = [
        ("Re [rad/s]", "Im [rad/s]", "power" if highest > 1 else "", "Re residue", "Im residue")
    ]
    for residue in approximation.residues:
        if residue.root.im < 0:
            continue
        pole = _middle(residue.root)
        for power, coefficient in enumerate(residue.coefficients, 1):
            value = to_complex_mpmath(coefficient)
            re = "0" if coefficient.real.contains(0) else _decimal(value.real)
            im = "0" if coefficient.imag.contains(0) else _decimal(value.imag)
            pair = ("+-", "-+" if im.startswith("-") else "+-") if pole.imag != 0 else ("", "")
            imaginary = im if im == "0" else pair[1] + im.removeprefix("-") if pair[1] else im
            place = (_decimal(pole.real), pair[0] + _decimal(pole.imag)) if power == 1 else ("", "")
            rows.append((*place, f"{-power}" if highest > 1 else "", re, imaginary))
    return rows


def _middle(root: Root) -> mpmath.mpc:
    return to_complex_mpmath(root.enclosure())


def rational_json(approximation: RationalApproximation) -> dict[str, object]:
    """Return an approximation in the schema ``symflex.rational/1``, ready for :func:`json.dumps`."""
    error, scan = approximation.error, approximation.scan
    return {
        "schema": SCHEMA,
        "tf": approximation.tf,
        "quantity": approximation.bound.source.quantity,
        "unit": approximation.bound.source.unit,
        "form": approximation.form,
        "modes": approximation.modes,
        "stability": approximation.stability.to_json_dict(),
        "exact": approximation.is_exact,
        "certified": not approximation.is_estimate,
        "gain": _exact(approximation.gain),
        "num": [_exact(c) for c in approximation.num],
        "den": [_exact(c) for c in approximation.den],
        "poles": [_complex(root) for root in approximation.poles],
        "zeros": [_complex(root) for root in approximation.zeros],
        "residues": [
            {
                "pole": _complex(_middle(residue.root)),
                "coefficients": [
                    {**_complex(to_complex_mpmath(c)), "radius": f"{float(c.rad()):.2g}"}
                    for c in residue.coefficients
                ],
            }
            for residue in approximation.residues
        ],
        "correction": [_exact(c) for c in approximation.correction],
        "order_at_zero": approximation.order_at_zero,
        "leading_coefficient": approximation.leading_coefficient,
        "valid_to_hz": {
            f"{percent} %": _finite(approximation.valid_to(percent / 100)) for percent in PERCENTS
        },
        "error": {
            "band_hz": [error.low_hz, error.high_hz],
            "worst": _finite(error.worst),
            "worst_at_hz": error.worst_at_hz,
            "rigorous": error.is_rigorous,
        },
        "sampled": {"low_hz": scan.low_hz, "high_hz": scan.high_hz, "samples": len(scan.error)},
        "omitted_hz": approximation.omitted_hz,
    }


def _exact(number: mpmath.mpf) -> str:
    return str(mpmath.nstr(number, JSON_DIGITS))


def _complex(number: mpmath.mpc) -> dict[str, str]:
    return {"re": _exact(number.real), "im": _exact(number.imag)}


def _finite(number: float) -> float | None:
    return number if isfinite(number) else None
