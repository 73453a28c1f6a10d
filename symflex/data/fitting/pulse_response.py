"""What one sample of an input makes of an output in time, with derivatives in the parameters of a machine.

Input: a transfer function with its derivatives, the time between samples, and how the input runs between
them: held, or joined by lines.
Output: a :class:`PulseResponse` ``h``; from rest, samples of the output are ``y_k = sum_j h_j u_(k-j)``.

A rational function is a system of state equations in companion form, which ``exp(A h)`` takes from one sample
to the next (Kalman & Bertram 1958); its derivatives are those of the exponential (Van Loan, IEEE Trans.
Automatic Control 23, 1978). Both are exact.

    1/(T s + 1), held    h = 0, (1 - a), (1 - a) a, (1 - a) a^2, ...    with a = exp(-h/T)

Any other function, with beams or delays, is summed along ``s = sigma + j omega`` by a Fourier transform
(Dubner & Abate, J. ACM 15, 1968). How far it is off is seen from a sum of half as many terms.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.linalg import expm, expm_frechet

from symflex.data.fitting.identifiable import Coefficients
from symflex.data.fitting.resonances import Complex, Real

DECAY: Final = 12.0  # sigma times the length: what repeats is exp(-24) of the response, and rounding 1e-11
MOST_POINTS, MOST_FINER, LEAST_FINER = 100_000, 64, 4  # frequencies, and terms over those below half the rate
SMALL_ERROR: Final = 1e-4  # share of its largest value that a response may be off: noise of records is larger
FLAT: Final = (
    0.5  # share of a function's size an octave and a half below the end from which it falls too little
)


@dataclass(frozen=True, eq=False)
class PulseResponse:
    """The response to one sample of the input; n samples, p parameters."""

    values: Real  # shape (n,)
    slopes: Real  # shape (n, p)
    free: Real  # shape (n, order): what states to begin with make of the output; (n, 0) if unknown
    error: float = 0.0  # of the values, over their largest


def of_coefficients(
    coefficients: Coefficients, theta: Real, step_s: float, count: int, *, is_joined: bool
) -> PulseResponse | None:
    """Return the response of a rational function; None if it grows with frequency."""
    numbers, slopes = coefficients.at(theta)
    order = max(power for is_below, power in coefficients.powers if is_below)
    if max(power for _, power in coefficients.powers) > order:
        return None
    size = theta.size
    # All in units of the step: s h takes the place of s.
    sides = np.zeros((2, order + 1, 1 + size))
    for i, (is_below, power) in enumerate(coefficients.powers):
        sides[int(is_below), power] = np.append(numbers[i], slopes[i]) * step_s**-power
    leading = sides[1, order]
    sides[:, :, 1:] = (sides[:, :, 1:] - sides[:, :, :1] * leading[1:] / leading[0]) / leading[0]
    sides[:, :, 0] /= leading[0]
    above, below = sides
    through = above[order].copy()
    output = above[:order] - below[:order] * through[0]
    output[:, 1:] -= below[:order, :1] * through[1:]
    # States, and one or two that hold the input, or its slope.
    width = order + 1 + is_joined
    system = np.zeros((width, width))
    system[: order - 1, 1:order] = np.eye(order - 1) if order > 1 else 0
    if order:
        system[order - 1, :order] = -below[:order, 0]
        system[order - 1, order] = 1.0
    if is_joined:
        system[order, order + 1] = 1.0
    ahead = expm(system)
    moved = []
    for i in range(size):
        change = np.zeros_like(system)
        if order:
            change[order - 1, :order] = -below[:order, 1 + i]
        moved.append(expm_frechet(system, change, compute_expm=False))
    every = np.zeros((order * (1 + size), order * (1 + size)))
    entry = np.zeros((order * (1 + size), 2))
    for i, one in enumerate([ahead, *moved]):
        rows = slice(i * order, (i + 1) * order)
        every[rows, rows] = ahead[:order, :order]
        if i:
            every[rows, :order] = one[:order, :order]
        entry[rows, 0] = one[:order, order]
        entry[rows, 1] = one[:order, order + 1] if is_joined else 0.0
    late = entry[:, 0] - entry[:, 1] + every @ entry[:, 1]
    read = np.zeros((1 + size, order * (1 + size)))
    for i in range(1 + size):
        read[i, :order] += output[:, i]
        if i:
            read[i, i * order : (i + 1) * order] += output[:, 0]
    pulses = np.zeros((1 + size, count))
    pulses[:, 0] = through + read @ entry[:, 1]
    if order and count > 1:
        pulses[:, 1:] = read @ _powers(every, late, count - 1)
    free = _powers(ahead[:order, :order].T, output[:, 0], count) if order else np.zeros((0, count))
    return PulseResponse(pulses[0], pulses[1:].T, free.T)


def _powers(matrix: Real, vector: Real, count: int) -> Real:
    """Return ``v, M v, M^2 v, ...`` in columns."""
    columns, power = vector[:, np.newaxis], matrix
    while columns.shape[1] < count:
        columns = np.concatenate((columns, power @ columns), axis=1)
        power = power @ power
    return np.asarray(columns[:, :count], np.float64)


def terms_for(response: Callable[[int], PulseResponse | None], count: int) -> int:
    """Return up to how many times half the sampling rate a response of so many samples is to be summed."""
    finer = LEAST_FINER
    while 2 * finer <= MOST_FINER and 2 * finer * count <= MOST_POINTS:
        made = response(finer)
        if made is None or made.error < SMALL_ERROR:
            break
        finer *= 2
    return finer


def of_function(
    function: Callable[[Complex], tuple[Complex, Complex]],
    step_s: float,
    count: int,
    finer: int = LEAST_FINER,
    *,
    is_joined: bool,
) -> PulseResponse | None:
    """Return the response of any function; None if it does not fall towards high frequencies.

    The sum goes to ``finer`` times half the sampling rate.
    """
    size = finer * count  # of 2 * size + 1 frequencies; the response repeats after twice its length
    sigma = DECAY / (count * step_s)
    s = sigma + 1j * np.pi / (count * step_s) * np.arange(size + 1)
    values, slopes = function(np.asarray(s, np.complex128))
    top = np.abs(values[-count // 2 :]).max()
    if not np.isfinite(top) or top > FLAT * np.abs(values[size // 3 : size // 3 + count // 2]).max():
        return None
    hold = -np.expm1(-s * step_s) / s
    if is_joined:
        hold = hold**2 * np.exp(s * step_s) / step_s
    both = np.column_stack((values, slopes)) * hold[:, np.newaxis]
    t = step_s * np.arange(count)
    grow = np.exp(sigma * t)[:, np.newaxis]

    def summed(terms: Complex) -> Real:
        many = 2 * (terms.shape[0] - 1)
        fine = step_s * 2 * count / many
        return np.asarray(np.fft.irfft(terms, many, axis=0)[: many // 2 : many // (2 * count)] / fine * grow)

    made, half = summed(both), summed(both[: size // 2 + 1, :1])
    error = float(np.max(np.abs(made[:, 0] - half[:, 0])) / (np.max(np.abs(made[:, 0])) or 1.0))
    return PulseResponse(made[:, 0], made[:, 1:], np.zeros((count, 0)), error)
