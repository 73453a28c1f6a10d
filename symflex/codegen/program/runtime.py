"""What generated code of distributed systems needs besides arithmetic; it is copied into modules.

The functions use numpy, each other and :func:`symflex.algebra.modal_sum.modal_amplitudes`, and nothing else.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from symflex.algebra.modal_sum import modal_amplitudes

if TYPE_CHECKING:
    from collections.abc import Callable

Values = Any
"""A number, an array of numbers, or a list of these: what numpy calculates with, one way for all."""


def complex_exp(z: Values) -> Values:
    """Return exp(z); one tangent costs less than the cosine and sine in np.exp."""
    t = np.tan(0.5 * z.imag)
    square = t * t
    scale = np.exp(z.real) / (1.0 + square)
    if not np.ndim(z):
        # A numpy number: dividing by a Python zero would raise.
        return np.complex128(complex(scale * (1.0 - square), scale * 2.0 * t))
    value = np.empty_like(z)
    value.real = scale * (1.0 - square)
    value.imag = scale * (2.0 * t)
    return value


def series_solutions(coefficients: list[Values], terms: int) -> list[Values]:
    """Return the solutions of a linear differential equation at 1, by Taylor series.

    The equation is y^(n) + c_(n-1) y^(n-1) + ... + c_0 y = 0; solution k starts from
    y^(k)(0) = 1 and zeros for the other derivatives below n.
    """
    n = len(coefficients)
    used = [i for i in range(n) if np.any(coefficients[i])]
    found = []
    first = 1
    for k in range(n):
        zero = 0.0 * coefficients[0]
        derivatives = [zero + 1.0 if i == k else zero for i in range(n)]
        total = derivatives[k] / first
        first *= k + 1
        factorial = 1
        for m in range(1, terms):
            factorial *= m
            if m >= n:
                following = zero
                for i in used:
                    following = following - coefficients[i] * derivatives[i]
                derivatives = [*derivatives[1:], following]
                total = total + following / factorial
        found.append(total)
    return found


def propagated(coefficients: list[Values]) -> list[Values]:
    """Return h, h', ..., h^(n-1) at 1 for coefficients of any size.

    h solves h^(n) + c_(n-1) h^(n-1) + ... + c_0 h = 0 and starts from h^(n-1)(0) = 1 and
    zeros. The exponential of the companion matrix, by scaling and squaring: some
    hundred times the cost of a complex exponential.
    """
    n = len(coefficients)
    shape = np.broadcast_shapes(*(np.shape(c) for c in coefficients))
    rows = [np.broadcast_to(np.asarray(c, dtype=complex), shape) for c in coefficients]
    sizes = [np.abs(c) ** (1.0 / (n - i)) for i, c in enumerate(rows)]
    size = np.maximum(np.max(sizes, axis=0), 1e-30)
    companion = np.zeros((*shape, n, n), dtype=complex)
    for i in range(n - 1):
        companion[..., i, i + 1] = size
    for i, c in enumerate(rows):
        companion[..., n - 1, i] = -c / size ** (n - 1 - i)
    # Each element has its own number of halvings: what others are must not matter.
    largest = np.where(np.isfinite(size), np.maximum(size, 1.0), 1.0)
    halvings = np.ceil(np.log2(largest)).astype(int) + 3
    small = companion / (2.0**halvings)[..., None, None]
    identity = np.eye(n, dtype=complex)
    grown = identity
    for m in range(18, 0, -1):
        grown = identity + small @ grown / m
    for k in range(int(np.max(halvings, initial=0))):
        grown = np.where((k < halvings)[..., None, None], grown @ grown, grown)
    return [(grown[..., k, n - 1] * size ** (k - n + 1.0))[()] for k in range(n)]


def characteristic_roots(coefficients: list[Values]) -> list[Values]:
    """Return the roots of x^n + c_(n-1) x^(n-1) + ... + c_0, and the least distance of two.

    Eigenvalues of the companion matrix, then steps of Aberth and Ehrlich, which give
    small roots besides large ones their digits.
    """
    n = len(coefficients)
    shape = np.broadcast_shapes(*(np.shape(c) for c in coefficients))
    rows = [np.broadcast_to(np.asarray(c, dtype=complex), shape) for c in coefficients]
    sizes = [np.abs(c) ** (1.0 / (n - i)) for i, c in enumerate(rows)]
    size = np.maximum(np.max(sizes, axis=0), 1e-30)
    is_finite = np.isfinite(size)
    scaled = [np.nan_to_num(c / size ** (n - i)) * is_finite for i, c in enumerate(rows)]
    companion = np.zeros((*shape, n, n), dtype=complex)
    for i in range(n - 1):
        companion[..., i, i + 1] = 1.0
    for i, c in enumerate(scaled):
        companion[..., n - 1, i] = -c
    x = np.linalg.eigvals(companion)
    differences = x[..., :, None] - x[..., None, :]
    for _ in range(8 if n > 1 else 0):
        value, slope = np.ones_like(x), np.zeros_like(x)
        for c in reversed(scaled):
            slope = slope * x + value
            value = value * x + c[..., None]
        away = np.sum(np.where(differences == 0.0, 0.0, 1.0 / differences), axis=-1)
        step = value / (slope - value * away)
        x = x - np.where(np.isfinite(step) & (np.abs(step) < 1.0), step, 0.0)
        differences = x[..., :, None] - x[..., None, :]
    apart = np.abs(differences) + np.where(np.eye(n, dtype=bool), np.inf, 0.0)
    found = np.where(is_finite, size, np.nan)
    least = np.min(apart, axis=(-2, -1)) * found
    return [*((x[..., i] * found)[()] for i in range(n)), least[()]]


def modal_value(modes: list[Values], coefficients: list[Values], frames: Values) -> list[Values]:
    """Return a sum of exponentials over the largest one, and the logarithm of that."""
    found = modal_amplitudes(modes, coefficients, frames)
    growth = np.real(found[0][1])
    for _, exponent in found[1:]:
        growth = np.maximum(growth, np.real(exponent))
    total = 0.0
    for amplitude, exponent in found:
        left = np.asarray(exponent - growth, dtype=complex)[()]
        total = total + amplitude * complex_exp(left)
    return [total, growth]


def mean_over_circle(parts: Callable[[Values], tuple[Values, ...]], s: Values, points: int) -> Values:
    """Return numerator over denominator, each the mean of its values on a circle.

    Both are analytic, so the mean is the value at the center s, where the formula
    itself cancels. parts returns numerator, denominator, the logarithm of what both
    were divided by, and the radius.
    """
    _, _, center, radius = parts(s)
    num, den = 0.0, 0.0
    for k in range(points):
        turn = np.exp(2j * np.pi * (k + 0.5) / points)
        above, below, growth, _ = parts(s + radius * turn)
        scale = np.exp(growth - center)
        num = num + above * scale
        den = den + below * scale
    return num / den
