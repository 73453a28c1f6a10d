"""By how much a loop with delays enlarges what is not known of its parts.

Input: the parts of ``(A_0 + ...)/(1 + L_1 e^(-s d_1) + ...)`` as sums over poles, and how far each may be
off.
Output: how far the response may be off.

Let y_m be the response with the sums, y the true one, and e = y - y_m. Write L for the sum of all
``L_k e^(-s d_k)``, rho for what the sums lack, and Q = L_m/(1 + L_m), the transform of q. Then

    e  =  w - q * w,      w  =  rho_A u - rho_L * y_m - rho_L * e

A step response of rho_L is at most eps, so abs(rho_L * y_m) is at most eps times the integral of
abs(y_m'). The impulse response of rho_L is at most ``speed``, so abs(rho_L * e) is at most t speed max
abs(e).
Both integrals, of abs(y_m') and of abs(q), follow from the Laplace transform on a line Re(s) = a (Parseval,
Cauchy and Schwarz):

    (integral up to t of abs(q))^2  <=  (e^(2at) - 1)/(2a)  (1/pi) integral over w > 0 of abs(Q(a + jw))^2 dw

if 1 + L_m has no zero right of that line: it does not turn about 0 on it. Up to a frequency the line is
covered with cells, beyond it abs(L_m) <= 1/10, and Minkowski's inequality adds up the norms of single poles.

Everything here is a sum of positive doubles, but for values in the middle of cells, to which their
rounding is added; so the results are right up to a share that is taken into account.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import exp, pi, sqrt
from typing import TYPE_CHECKING

import numpy as np

from symflex.budget import spend

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt
    from flint import acb

ROUNDING = 1e-9
"""More than a sum of some thousand positive doubles, each a few operations, may be off, as a share."""
EPSILON = 2.0**-50
"""What a double and a few operations with it are off by, as a share."""
SHARP = 0.25
"""Of abs(1 + L), how much it varies on a cell at most."""
CALM = 0.1
"""abs(L) beyond the cells."""
LEFT = 0.25
"""Of e, in the inequality for it: what it adds to itself is less than the rest."""
MOST_CELLS = 200_000
FIRST_CELLS = 64
HIGHEST = 1e100
"""Frequency [rad/s] up to which the loop is to become calm; it falls off at least like 1/s."""
LINES = (1.0, 2.0, 4.0, 8.0, 16.0)
"""Values of a times the last time that are tried: the more a loop grows, the farther right its zeros."""


@dataclass(frozen=True, eq=False)
class PoleSum:
    """A sum over poles in doubles, those in the lower half plane among them, times a delay."""

    poles: npt.NDArray[np.complex128]  # shape (n,)
    coefficients: npt.NDArray[np.complex128]  # shape (n,), of 1/(s - p)^order
    orders: npt.NDArray[np.float64]  # shape (n,)
    delay: float  # [s]

    @classmethod
    def of(cls, poles: Sequence[acb], parts: Sequence[tuple[int, tuple[acb, ...]]], delay: float) -> PoleSum:
        """Return a sum of coefficients of 1/(s - p), 1/(s - p)^2, ... by numbers of poles."""
        rows: list[tuple[complex, complex, float]] = []
        for number, coefficients in parts:
            p = complex(poles[number])
            for k, c in enumerate(coefficients, 1):
                rows.append((p, complex(c), float(k)))
                if p.imag:
                    rows.append((p.conjugate(), complex(c).conjugate(), float(k)))
        columns = list(zip(*rows, strict=True)) or [(), (), ()]
        return cls(np.array(columns[0]), np.array(columns[1]), np.array(columns[2], dtype=float), delay)

    @cached_property
    def slack(self) -> npt.NDArray[np.float64]:
        """How far poles are off in doubles [rad/s], at most."""
        return np.asarray(EPSILON * np.abs(self.poles))

    def on(self, a: float, middle: float, half: float) -> tuple[complex, float, float]:
        """Return the value in the middle of ``a + j(middle +- half)``, its error, and how it varies."""
        s = complex(a, middle)
        off = np.maximum(np.abs(middle - self.poles.imag) - half - self.slack, 0.0)
        near = np.hypot(a - self.poles.real, off)
        sizes = np.abs(self.coefficients) / near**self.orders
        size = float(np.sum(sizes))
        value = complex(np.sum(self.coefficients / (s - self.poles) ** self.orders))
        fading = exp(-a * self.delay)
        varies = half * (float(np.sum(self.orders * sizes / near)) + self.delay * size) * (1 + ROUNDING)
        moved = float(np.sum(self.orders * sizes * (self.slack + EPSILON * abs(s)) / near))
        error = moved + ROUNDING * size * (1 + abs(s) * self.delay)
        return complex(value * np.exp(-s * self.delay)), fading * error, fading * varies

    def most_beyond(self, a: float, frequency: float) -> float:
        """Return the most that the absolute value is on the line, from a frequency on."""
        at = np.sort(self.poles.imag[self.poles.imag > frequency])
        edges = [frequency, *((at[1:] + at[:-1]) / 2).tolist(), np.inf]
        largest = 0.0
        for low, high in pairwise(edges):
            off = np.maximum(np.maximum(low - self.poles.imag, self.poles.imag - high) - self.slack, 0.0)
            near = np.hypot(a - self.poles.real, off)
            largest = max(largest, float(np.sum(np.abs(self.coefficients) / near**self.orders)))
        return largest * exp(-a * self.delay) * (1 + ROUNDING)

    def norm_beyond(self, a: float, frequency: float) -> float:
        """Return a bound of the square root of the integral of its square, from a frequency on."""
        right = a - self.poles.real
        # The integral of 1/(r^2 + x^2) over all x is pi/r, and from x on no more than 1/x.
        off = frequency - self.poles.imag - self.slack
        single = np.sqrt(np.where(off > 0, np.minimum(pi / right, 1 / np.maximum(off, 1e-300)), pi / right))
        near = np.hypot(right, np.maximum(off, 0.0))
        total = float(np.sum(np.abs(self.coefficients) * single / near ** (self.orders - 1)))
        return total * exp(-a * self.delay) * (1 + ROUNDING)


@dataclass(frozen=True, slots=True)
class LoopBound:
    """Bounds up to a time t of a loop made of sums over poles."""

    turned: float  # integral of abs(q)
    travelled: float  # integral of abs(y_m')

    def enlarged(self, of_input: float, eps: float, speed: float, last: float) -> float | None:
        """Return how far y is from y_m at most; None where nothing is proved.

        ``of_input`` is the most that ``rho_A u`` is, ``eps`` and ``speed`` the most that a step and an
        impulse response of all rho_L together are, ``last`` the time [s].
        """
        gain = 1 + self.turned
        left = 1 - gain * speed * last
        if not left > LEFT:
            return None
        return gain * (of_input + eps * self.travelled) / left * (1 + ROUNDING)


def loop_bound(
    above: Sequence[PoleSum], below: Sequence[PoleSum], integrations: int, last: float
) -> LoopBound | None:
    """Return the bounds, for an input that is a unit impulse integrated so often, at least once."""
    for line in LINES:
        found = _on_line(above, below, integrations, last, line / last)
        if found is not None:
            return found
    return None


def _on_line(
    above: Sequence[PoleSum],
    below: Sequence[PoleSum],
    integrations: int,
    last: float,
    a: float,
) -> LoopBound | None:
    if any(np.any(part.poles.real >= a) for part in (*above, *below)):
        return None
    frequency = 8 * a
    while sum(part.most_beyond(a, frequency) for part in below) > CALM:
        spend()
        if frequency > HIGHEST:
            return None
        frequency *= 1.5
    turned, travelled, angle = 0.0, 0.0, 0.0
    count, before = 0, None
    step = frequency / FIRST_CELLS
    pending = [(i * step, (i + 1) * step) for i in reversed(range(FIRST_CELLS))]
    while pending:
        low, high = pending.pop()
        middle, half = (low + high) / 2, (high - low) / 2
        parts = [part.on(a, middle, half) for part in below]
        loop = 1 + sum((value for value, _, _ in parts), 0j)
        off = sum(error + varies for _, error, varies in parts)
        count += 1
        if count > MOST_CELLS:
            return None
        if off > SHARP * abs(loop):
            if half < a * ROUNDING:
                return None
            pending += [(middle, high), (low, middle)]
            continue
        inner = abs(loop) - off
        turned += 2 * half * ((abs(loop - 1) + off) / inner) ** 2
        begun = [part.on(a, middle, half) for part in above]
        size = abs(sum(value for value, _, _ in begun)) + sum(error + varies for _, error, varies in begun)
        travelled += 2 * half * (size / inner / np.hypot(a, low) ** (integrations - 1)) ** 2
        # On a cell it stays within a quarter of its size about the middle: no half turn is missed.
        angle += float(np.angle(loop / (before or complex(np.sign(loop.real), 0.0))))
        before = loop
    if before is None or abs(angle - float(np.angle(before))) > SHARP:
        return None
    # Beyond, abs(1 + L) >= 1 - CALM.
    far = sum(part.norm_beyond(a, frequency) for part in below) / (1 - CALM)
    late = (
        sum(part.norm_beyond(a, frequency) for part in above) / (1 - CALM) / frequency ** (integrations - 1)
    )
    weight = sqrt((exp(2 * a * last) - 1) / (2 * a) / pi) * (1 + ROUNDING)
    return LoopBound(weight * sqrt(turned + far**2), weight * sqrt(travelled + late**2))
