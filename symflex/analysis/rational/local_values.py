"""Wavenumbers and kernels as power series about a frequency, to any number of terms.

Input: the evaluator of a ring at one precision, a centre p and a number of branches n. Output: one series in
e per generator, where ``s = p + e^n``; with n = 4 every wavenumber is such a series also where it vanishes.
"""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

import flint
from flint import acb, acb_mat, acb_series

from symflex.transfer.balls import Value, at_centre

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from symflex.algebra import Dispersion, Factored, Kernel
    from symflex.transfer.enclose_kernels import KernelValues

BRANCHES = 4
"""Of a wavenumber about a point where it vanishes."""


@contextmanager
def series_length(terms: int) -> Iterator[None]:
    """Keep that many terms of power series inside the block; restore the former number on every exit."""
    former = flint.ctx.cap
    flint.ctx.cap = terms
    try:
        yield
    finally:
        flint.ctx.cap = former


def local_values(
    evaluator: KernelValues, centre: acb, terms: int, branches: int = 1
) -> dict[str, Value] | None:
    """Return the series of all generators about p [rad/s]; None where a wavenumber is no such series.

    So many ``terms`` in e are computed with; roots of what vanishes lose some. ``branches`` is n: 1 where
    wavenumbers neither vanish nor meet, else :data:`BRANCHES`.
    """
    with series_length(terms):
        plain: dict[str, Value] = {name: acb(value) for name, value in evaluator.constants.items()}
        plain["s"] = acb_series([centre, acb(1)], terms)
        values = dict(plain)
        values["s"] = _inflated(plain["s"], branches, terms)
        laws: dict[Dispersion, tuple[tuple[Value, ...], Value]] = {}
        for law in evaluator.table.dispersions:
            found = tuple(evaluator.value(c, plain) for c in law.characteristic)
            laws[law] = (found, evaluator.value(law.shift, plain))
            try:
                roots: dict[str, acb_series] = law.roots(
                    [_inflated(c, branches, terms) for c in found], square_root
                )
            except ArithmeticError:
                return None
            values.update(roots)
        fundamental: dict[tuple[Dispersion, Factored], tuple[acb_series, ...]] = {}
        for kernel in evaluator.table.kernels:
            length = at_centre(evaluator.value(kernel.length, plain))
            coefficients, shift = laws[kernel.dispersion]
            if kernel.function == "exp":
                values[kernel.generator] = _inflated((-shift * length).exp(), branches, terms)
            elif kernel.function == "fundamental":
                key = (kernel.dispersion, kernel.length)
                if key not in fundamental:
                    short = 1 + (terms - 1) // branches
                    fundamental[key] = fundamental_series(coefficients, length, short)
                values[kernel.generator] = _inflated(fundamental[key][kernel.order], branches, terms)
            else:
                values[kernel.generator] = _kernel(kernel, values[kernel.wavenumber] * length)
        return values


def _inflated(value: Value, branches: int, terms: int) -> acb_series:
    """Return the series with ``e^branches`` in place of its variable."""
    if not isinstance(value, acb_series):
        return acb_series([value], terms)
    spread = [acb(0)] * terms
    for i, coefficient in enumerate(value.coeffs()):
        if i * branches < terms:
            spread[i * branches] = coefficient
    return acb_series(spread, min(terms, value.prec * branches))


def square_root(series: acb_series) -> acb_series:
    """Return a square root of a series that begins with an even power; ArithmeticError for any other.

    The branch is chosen by the leading coefficient's midpoint: a ball across a branch cut does no harm.

    Examples
    --------
    >>> root = square_root(acb_series([0, 0, -4, -8], 4))
    >>> [complex(c) for c in root.coeffs()]
    [0j, 2j, 2j]
    """
    coefficients = series.coeffs()
    first = next((i for i, c in enumerate(coefficients) if c != 0), None)
    lead = acb(0) if first is None else coefficients[first].mid()
    if first is None or first % 2 or lead == 0:
        message = "the series has no square root that is one"
        raise ArithmeticError(message)
    rest = acb_series([c / lead for c in coefficients[first:]], series.prec - first).sqrt() * lead.sqrt()
    half = first // 2
    return acb_series([*[acb(0)] * half, *rest.coeffs()], series.prec - half)


def _kernel(kernel: Kernel, argument: Value) -> Value:
    match kernel.function:
        case "cosh" | "sinh":
            grown, decayed = argument.exp(), (-argument).exp()
            return (grown + decayed) / 2 if kernel.function == "cosh" else (grown - decayed) / 2
    return argument.cos() if kernel.function == "cos" else argument.sin()


def fundamental_series(coefficients: Sequence[Value], length: acb, terms: int) -> tuple[acb_series, ...]:
    """Return ``h, h', ..., h^(n-1)`` at a length for ``lambda^n + ... + c_0``, with series as coefficients.

    The series of a matrix exponential stands in the first row of blocks of the exponential of a block
    Toeplitz matrix (Mathias 1996, A chain rule for matrix functions, theorem 4.1).
    """
    n = len(coefficients)
    block = acb_mat(n * terms, n * terms)
    for k in range(terms):
        for i in range(n - 1):
            block[n * k + i, n * k + i + 1] = acb(1)
        for j, c in enumerate(coefficients):
            parts = c.coeffs() if isinstance(c, acb_series) else [c]
            for later, part in enumerate(parts[: terms - k]):
                block[n * k + n - 1, n * (k + later) + j] = -part
    grown = (block * length).exp()
    return tuple(acb_series([grown[i, n * k + n - 1] for k in range(terms)], terms) for i in range(n))
