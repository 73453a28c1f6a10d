"""State equations of a function given by poles, zeros and gain: sections of second order in series.

Input: poles and zeros, both members of conjugate pairs, and the gain. Output: :class:`Arrays`.

The poles of a triangular matrix are those of its diagonal blocks, so each stands on its own two entries, and
none is lost among coefficients of high degree.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mpmath
import numpy as np

from symflex.errors import Diagnostic, ModelError
from symflex.state_space.numeric import Arrays

BITS = 256


@dataclass(frozen=True, slots=True)
class _Section:
    """``factor*(s - z).../(s^2 + d_1 s + d_0)``, or the same of first order; ascending coefficients.

    The factor makes it of the order of 1 near its natural frequency.
    """

    num: tuple[mpmath.mpf, ...]
    den: tuple[mpmath.mpf, ...]
    factor: mpmath.mpf

    @property
    def order(self) -> int:
        return len(self.den)

    @property
    def direct(self) -> mpmath.mpf:
        return self.num[self.order]

    @property
    def scale(self) -> mpmath.mpf:
        """The natural frequency [rad/s], 1 at 0: states of a section have one unit then."""
        return _size(self.den) or mpmath.mpf(1)

    def matrix(self) -> list[list[mpmath.mpf]]:
        if self.order == 1:
            return [[-self.den[0]]]
        return [[mpmath.mpf(0), self.scale], [-self.den[0] / self.scale, -self.den[1]]]

    def output(self) -> list[mpmath.mpf]:
        left = [self.num[i] - self.direct * self.den[i] for i in range(self.order)]
        return left if self.order == 1 else [left[0] / self.scale, left[1]]


def cascade(zeros: Sequence[mpmath.mpc], poles: Sequence[mpmath.mpc], gain: mpmath.mpf, name: str) -> Arrays:
    """Return the state equations of ``gain*prod(s - z)/prod(s - p)``; messages call it ``name``."""
    if len(zeros) > len(poles):
        message = f"{name} has more zeros than poles: no state equations have its output"
        raise ModelError(Diagnostic("SF236", message, None, "take an output with fewer derivatives"))
    with mpmath.workprec(BITS):
        sections = _sections(zeros, poles)
        n = sum(section.order for section in sections)
        a, b, c = mpmath.zeros(n), mpmath.zeros(n, 1), mpmath.zeros(1, n)
        # What reaches the section at hand: a combination of earlier states, and of the input.
        carried, direct, start = [mpmath.mpf(0)] * n, mpmath.mpf(1), 0
        for section in sections:
            last = start + section.order - 1
            for j, value in enumerate(carried):
                a[last, j] = value
            for i, row in enumerate(section.matrix()):
                for j, value in enumerate(row):
                    a[start + i, start + j] = value
            b[last, 0] = direct
            carried = [value * section.direct for value in carried]
            for j, value in enumerate(section.output()):
                carried[start + j] = value
            direct = direct * section.direct
            start += section.order
        gain = gain / mpmath.fprod(section.factor for section in sections)
        for j, value in enumerate(carried):
            c[0, j] = gain * value
        matrices = ((a, (n, n)), (b, (n, 1)), (c, (1, n)), (mpmath.matrix([[gain * direct]]), (1, 1)))
        return Arrays(*(_doubles(matrix, shape, name) for matrix, shape in matrices))


def _doubles(matrix: mpmath.matrix, shape: tuple[int, int], name: str) -> np.ndarray:
    array = np.array([[float(matrix[i, j]) for j in range(shape[1])] for i in range(shape[0])], dtype=float)
    if not np.isfinite(array).all():
        message = f"the state equations of {name} do not fit in double precision"
        hint = "choose units in which values are closer to 1, or take fewer modes"
        raise ModelError(Diagnostic("SF233", message, None, hint))
    return array.reshape(shape)


def _sections(zeros: Sequence[mpmath.mpc], poles: Sequence[mpmath.mpc]) -> list[_Section]:
    """Return a section per pair of poles, with zeros of like frequency, by frequency."""
    below, single_pole = _pairs(poles)
    above, single_zero = _pairs(zeros)
    free = list(range(len(below)))
    numerators: list[tuple[mpmath.mpf, ...]] = [()] * len(below)
    for pair in above:
        nearest = min(free, key=lambda i: abs(_size(below[i]) - _size(pair)))
        free.remove(nearest)
        numerators[nearest] = pair
    if single_zero and not single_pole:
        numerators[free[0]] = single_zero
        single_zero = ()
    sections = [_section(num, den) for num, den in zip(numerators, below, strict=True)]
    return [*sections, _section(single_zero, single_pole)] if single_pole else sections


def _section(num: tuple[mpmath.mpf, ...], den: tuple[mpmath.mpf, ...]) -> _Section:
    """Return a section of monic polynomials given without their leading coefficient."""
    factor = (_size(den) or mpmath.mpf(1)) ** (len(den) - len(num))
    whole = [factor * value for value in (*num, mpmath.mpf(1))]
    whole += [mpmath.mpf(0)] * (len(den) + 1 - len(whole))
    return _Section(tuple(whole), den, factor)


def _pairs(roots: Sequence[mpmath.mpc]) -> tuple[list[tuple[mpmath.mpf, ...]], tuple[mpmath.mpf, ...]]:
    """Return monic quadratics with the given roots by frequency, and what is left; ascending coefficients."""
    upper = [r for r in roots if r.imag > 0]
    real = sorted((r.real for r in roots if r.imag == 0), key=abs)
    pairs = [(r.real**2 + r.imag**2, -2 * r.real) for r in upper]
    pairs += [(p * q, -(p + q)) for p, q in zip(real[0::2], real[1::2], strict=False)]
    single = (-real[-1],) if len(real) % 2 else ()
    return sorted(pairs, key=_size), single


def _size(polynomial: tuple[mpmath.mpf, ...]) -> mpmath.mpf:
    """Return the natural frequency of a monic polynomial [rad/s]."""
    return abs(polynomial[0]) if len(polynomial) == 1 else mpmath.sqrt(abs(polynomial[0]))
