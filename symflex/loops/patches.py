"""An analytic function of s and one parameter on discs of both, as a polynomial with a bound on its error.

Input: a function of s and a parameter p, complex numbers or balls. Output: a :class:`Patch`, which tells what
the function does on smaller discs. Example: ``exp(s p)`` on abs(s) <= 1 and abs(p) <= 1 is
``sum((s p)^k/k!)`` with k < 20, to 4e-19.

Power series in s, at samples of p on a circle, give the coefficients. If abs(f) <= M on discs that are 1/q
times as large, those left out, and those that samples do not tell from others, are at most M q^k (Cauchy
1831). Balls of wide discs say little of f, but enough of M.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from math import ceil, comb, inf, log

import numpy as np
import numpy.typing as npt
from flint import acb, acb_series, arb

from symflex.balls import Value, at_centre, precision, series_terms

BITS = 64  # of bounds
FINER_BITS = (64, 256)  # of power series, which lose digits where wavenumbers nearly meet
RATIOS = (4, 8, 16, 32, 64, 128)  # by which discs are larger on which the function is bounded
ACCURACY = 1e-5  # relative to the function's size: narrow parts are examined without patches
MOST_COEFFICIENTS = 500  # beyond which smaller discs take less
ROOM = 1.01  # by which discs are larger than what lies in them
RESOLVED = 20  # times the error of a patch that a bound is, if a smaller disc is worth it
ULP = 2.0**-50  # far more than a double is off, relative to it
ROUNDING = 1e-13  # far more than transforms and shifts lose, relative to what they add up

Function = Callable[[Value, acb], Value]  # its value at s, or series about one, for one parameter
Coefficients = npt.NDArray[np.complex128]


@dataclass(frozen=True, slots=True)
class Bound:
    """What is known of a function on small discs of s and the parameter."""

    may_vanish: bool
    may_turn: bool  # its slope in s may vanish
    by_part: float  # how far the parameter moves values in the middle of s
    by_path: float  # how far s moves them

    @property
    def is_as_sharp_as_the_part(self) -> bool:
        """Whether a shorter path would not be told from this one."""
        return not self.by_part < inf or self.by_path < self.by_part

    def both(self, other: Bound) -> Bound:
        """Return what is known if this and another are."""
        return Bound(
            self.may_vanish and other.may_vanish,
            self.may_turn and other.may_turn,
            min(self.by_part, other.by_part),
            min(self.by_path, other.by_path),
        )


@dataclass(frozen=True, eq=False)
class Patch:
    """A polynomial in ``(s - centre)/radius`` and ``(p - middle)/half``, next to a function."""

    centre: complex
    radius: float
    middle: float
    half: float
    coefficients: Coefficients  # by powers of s, and of p
    error: float  # where neither is larger than 1
    slope_error: float  # of the derivative in the first

    def on(self, s: complex, reach: float, p: float, off: float) -> tuple[Bound, bool]:
        """Return what is known on discs about s and p, and whether smaller ones would tell more."""
        off, reach = off + ULP * abs(p), reach + ULP * abs(s)  # as neither is exact
        at_p = _shifted(self.coefficients.T, (p - self.middle) / self.half).T
        sizes = np.abs(_shifted(at_p, (s - self.centre) / self.radius))
        share, powers = reach / self.radius, np.arange(len(sizes))
        sizes = sizes * (off / self.half) ** np.arange(sizes.shape[1])
        by_s = sizes.sum(axis=1)
        by_part, by_path = float(by_s[0] - sizes[0, 0]), float((by_s[1:] * share ** powers[1:]).sum())
        by_slope = float((powers[1:] * by_s[1:] * share ** (powers[1:] - 1)).sum() - sizes[1, 0])
        may_vanish = float(sizes[0, 0]) <= by_part + by_path + self.error
        may_turn = float(sizes[1, 0]) <= by_slope + self.slope_error
        is_rough = by_part + by_path > RESOLVED * self.error and by_slope > RESOLVED * self.slope_error
        return Bound(may_vanish, may_turn, by_part, by_path), is_rough


def patch(function: Function, centre: complex, radius: float, middle: float, half: float) -> Patch | None:
    """Return a polynomial for a function that is analytic where it is finite; None where discs are too large.

    >>> exponential = lambda s, p: (s * p).exp()
    >>> one = patch(exponential, 1j, 0.1, 2.0, 0.1)
    >>> one is not None and one.error < 1e-5 and not one.on(1j, 0.02, 2.0, 0.02)[0].may_vanish
    True
    """
    with precision(BITS):
        around = (at_centre(function(s, acb(middle))) for s in _circle(centre, radius, 4))
        size = max(float(abs(x).upper()) for x in around)
        best = MOST_COEFFICIENTS + 1, 0, 0, inf
        bounds = _bounds(function, centre, radius, middle, half) if 0 < size < inf else ()
        for by_s, by_p, bound in bounds:
            room = max(log(bound) - log(size) - log(ACCURACY), 1.0)
            rows, columns = ceil(room / log(by_s / 2)) + 1, ceil(room / log(by_p)) + 1
            # Twice as large a disc of s bounds slopes.
            tail = (2 / by_s) ** rows + (1 / by_p) ** columns
            error = 2 * bound * tail / ((1 - 2 / by_s) * (1 - 1 / by_p))
            best = min(best, (rows * columns, rows, columns, error))
        count, rows, columns, error = best
        if count > MOST_COEFFICIENTS:
            return None
    for bits in FINER_BITS:
        with precision(bits):
            table = _expanded(function, centre, radius, rows, _circle(middle, half, columns))
            if table is None:
                return None
            blur = max(float((x.real.rad() + x.imag.rad()).upper()) for row in table for x in row)
        if count * blur < error:
            break
    else:
        return None
    values = np.array([[complex(x.mid()) for x in row] for row in table]).T
    if not np.isfinite(values).all():
        return None
    coefficients = np.fft.fft(values, axis=1) / columns
    # A shift by up to 1 adds up binomials of coefficients.
    spread = np.abs(coefficients) * 2.0 ** np.add.outer(np.arange(rows), np.arange(columns))
    noise = count * (blur + ROUNDING * float(np.abs(values).max())) + ROUNDING * float(spread.sum())
    return Patch(centre, radius, middle, half, coefficients, error + noise, error + rows * noise)


def _bounds(
    function: Function, centre: complex, radius: float, middle: float, half: float
) -> Iterator[tuple[int, int, float]]:
    """Yield by how much discs of s and p are larger, and a bound on them."""
    finite = len(RATIOS)
    for by_s in RATIOS:
        for i, by_p in enumerate(RATIOS[:finite]):
            most = function(_disc(centre, by_s * radius), _disc(middle, by_p * half))
            bound = float(at_centre(most).abs_upper())
            if not bound < inf:
                finite = i  # nor is there one on larger discs
                break
            yield by_s, by_p, bound


def _expanded(
    function: Function, centre: complex, radius: float, terms: int, parameters: Sequence[acb]
) -> list[list[acb]] | None:
    """Return the terms of power series in ``(s - centre)/radius``, one for each parameter."""
    with series_terms(terms):
        s = acb_series([acb(centre.real, centre.imag), radius], terms)
        table = [function(s, p) for p in parameters]
    series = [each for each in table if isinstance(each, acb_series)]
    return [[each[k] for k in range(terms)] for each in series] if len(series) == len(table) else None


def _circle(centre: complex, radius: float, points: int) -> list[acb]:
    """Return points on a circle, counterclockwise."""
    turns = ((2 * arb.pi() * acb(0, k) / points).exp() for k in range(points))
    return [acb(centre.real, centre.imag) + radius * turn for turn in turns]


def _disc(centre: complex, radius: float) -> acb:
    off = arb(0, radius)
    return acb(centre.real, centre.imag) + acb(off, off)


def _shifted(coefficients: Coefficients, by: complex) -> Coefficients:
    """Return polynomials, one a column, about another point."""
    chosen, powers = _binomials(len(coefficients))
    shifted: Coefficients = (chosen * (complex(by) ** np.arange(len(coefficients)))[powers]) @ coefficients
    return shifted


@cache
def _binomials(count: int) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]:
    """Return ``comb(j, i)`` in row i and column j, and ``j - i`` where that is not negative."""
    each = range(count)
    chosen = np.array([[float(comb(j, i)) for j in each] for i in each])
    steps = np.arange(count)
    return chosen, np.maximum(steps[None, :] - steps[:, None], 0)
