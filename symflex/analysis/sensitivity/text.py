"""Sensitivities of poles and zeros: tables for a terminal, and the derivative as a formula."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import TYPE_CHECKING

import sympy
from flint import arb

from symflex.balls import precision
from symflex.print.roots import SHORT_DIGITS
from symflex.print.text import WIDTH
from symflex.roots import Root
from symflex.roots.root import NEARLY_ZERO, decimals, figure

if TYPE_CHECKING:
    from symflex.analysis.sensitivity import RootDerivative


INDENT = "    "
HEAD = ("Re [rad/s]", "Im [rad/s]", "p", "(p/f) df/dp")
TITLES = {"pole": "  sensitivity of poles", "zero": "  sensitivity of zeros"}
OBSTACLES = {"multiple": "no derivative: multiple roots part", "undecided": "not decided"}


def sensitivity_text(moved: Sequence[RootDerivative], width: int = WIDTH) -> str:
    """Return how frequencies and damping ratios change, a line per pair and parameter, within a width."""
    lines: list[str] = []
    for kind, group in groupby(moved, key=lambda m: m.kind):
        lines += ["", TITLES[kind], *_table(list(group), width)]
    if not lines:
        return "\n  no root depends on a parameter"
    is_lossy = any(m.root.loss_factor() is not None for m in moved)
    meaning = "s^2 = -(2 pi f)^2 (1 + j eta)" if is_lossy else "f = abs(s)/(2 pi), zeta = -Re(s)/abs(s)"
    lines += ["", f"  {meaning}; changes are per relative change of p"]
    damping = "deta/dp" if is_lossy else "dzeta/dp"
    about = [m.parameter for m in moved if _is_zero(m)]
    zeros = sorted({p.name + (f" [{p.unit}]" if p.unit else "") for p in about})
    if zeros:
        lines.append(f"  * the parameter is 0: (1/f) df/dp and {damping}, per unit: {', '.join(zeros)}")
    if any(m.derivative is not None for m in moved):
        lines.append("  every digit is certified, except for the rounding of the last one")
    return "\n".join(lines)


def _table(moved: Sequence[RootDerivative], width: int) -> list[str]:
    damping = "p dzeta/dp" if all(m.root.loss_factor() is None for m in moved) else "p deta/dp"
    rows: list[tuple[str, ...]] = [(*HEAD, damping)]
    roots = {m.index: m.root for m in moved}
    printed = {i: decimals(r.re, r.im, SHORT_DIGITS).readable for i, r in roots.items()}
    places = {(p.re, p.im) for p in printed.values()}
    for index, group in groupby(moved, key=lambda m: m.index):
        re, im = printed[index].re, printed[index].im
        mirrored = im != "0" and (re, im[1:] if im[0] == "-" else f"-{im}") in places
        if mirrored and im.startswith("-"):
            continue
        location = (re, f"+-{im}" if mirrored else im)
        for n, cells in enumerate(_rows(roots[index], list(group))):
            rows.append((*(location if n == 0 else ("", "")), *cells))
    numbers = [row for row in rows if len(row) == len(rows[0])]
    columns = [max(len(row[i]) for row in numbers) for i in range(len(rows[0]))]
    places_width = [max(len(row[i]) for row in rows) for i in (0, 1)]
    columns[:2] = places_width
    spare = width - len(INDENT) - 2 * len(HEAD) - sum(columns[:2]) - sum(columns[3:])
    columns[2] = max(1, min(columns[2], spare))
    return [line for row in rows for line in _laid_out(row, columns)]


def _laid_out(row: Sequence[str], columns: Sequence[int]) -> list[str]:
    re, im, name, *cells = row
    start = f"{INDENT}{re.rjust(columns[0])}  {im.rjust(columns[1])}  "
    end = "  ".join(text.rjust(w) for text, w in zip(cells, columns[3:], strict=False))
    if not cells:
        return [start + name]
    if len(name) <= columns[2]:
        return [f"{start}{name.ljust(columns[2])}  {end}".rstrip()]
    return [start + name, f"{' ' * (len(start) + columns[2])}  {end}".rstrip()]


def _rows(root: Root, moved: Sequence[RootDerivative]) -> list[tuple[str, ...]]:
    """Return what stands to the right of one root."""
    if all(m.status in OBSTACLES for m in moved):
        return [(OBSTACLES[status],) for status in sorted({m.status for m in moved})]
    if root.is_zero and all(m.derivative is not None and m.derivative.is_zero() for m in moved):
        return [("stays at 0",)]
    return [_row(m) for m in moved]


def _row(derivative: RootDerivative) -> tuple[str, ...]:
    name = derivative.parameter.name
    if derivative.derivative is None:
        return (f"{name}: {OBSTACLES[derivative.status]}",)
    rate, damping = derivative.rate, derivative.damping_ratio
    damping = derivative.loss_factor if damping is None else damping
    if rate is None:
        slope = decimals(derivative.derivative.real, derivative.derivative.imag, SHORT_DIGITS).readable
        shown = slope.re if slope.im == "0" else f"{slope.re} + ({slope.im}) j"
        return (f"{name}: ds/dp = {shown}",)
    if _is_zero(derivative):
        return (f"{name}*", _number(rate), "" if damping is None else _number(damping))
    with precision(max(rate.bits(), 1) + 64):
        value = derivative.exact_value()
        change = rate * value
        turned = None if damping is None else damping * value
    return (name, _number(change), "" if turned is None else _number(turned))


def _number(value: arb) -> str:
    return NEARLY_ZERO if value.contains(0) and not value.is_zero() else figure(value, SHORT_DIGITS)


def _is_zero(derivative: RootDerivative) -> bool:
    return derivative.value.rational == 0


def sensitivity_formula(
    den: sympy.Expr,
    where: Sequence[tuple[sympy.Symbol, sympy.Expr]],
    s: sympy.Symbol,
    parameter: sympy.Symbol,
) -> tuple[sympy.Expr, sympy.Expr]:
    """Return numerator and denominator of ``ds/dp = -(d den/dp)/(d den/ds)`` at simple roots of ``den``.

    Factors that do not hold the parameter, whose roots stay where they are, and factors that are zero at s =
    0 only are left out; of a power, its base is taken. Where nothing is left, no root moves: 0 and 1.
    ``where`` has names that stand for expressions, to be put in.

    >>> s, m, k = sympy.symbols("s m k")
    >>> sensitivity_formula(s * (m * s**2 + k) ** 2, (), s, k)
    (-1, 2*m*s)
    """
    kept = sympy.Integer(1)
    for factor in sympy.Mul.make_args(den):
        opened = factor
        while any(opened.has(name) for name, _ in where):  # in any order, and in no circle
            opened = opened.subs(where)
        base, exponent = opened.as_base_exp()
        if exponent.is_Integer and exponent > 0:
            opened = base
        if opened.has(parameter) and opened.has(sympy.Add):
            kept *= opened
    slope = sympy.diff(kept, s)
    return (sympy.Integer(0), sympy.Integer(1)) if slope == 0 else (-sympy.diff(kept, parameter), slope)
