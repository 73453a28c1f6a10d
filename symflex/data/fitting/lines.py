"""Which lines of a measurement a fit uses: not those that are wild, and few where few tell as much.

One line of a response 1/s^2 at 4, 8, 12, ... Hz has another value than its neighbours have it:

    line [Hz]                       4      8     12     16     20
    magnitude                     172   1.46   0.66   0.39   0.26
    off the power law of others   3.4    ...    0.01   0.01   0.01   (natural logarithm)

A resonance narrower than the distance of lines is no such line: its neighbours deviate too.
"""

from __future__ import annotations

from heapq import heapify, heappop, heappush
from itertools import pairwise

import numpy as np

from symflex.data.fitting.resonances import Complex, Real, Resonances, Whole

FEWEST = 12  # lines from which wild ones are looked for
REACH = 4  # lines on either side that one is compared with
WILD = 8.0  # how many times as far as the worst of those a wild line deviates
MOST_WILD = 0.02  # share of the lines that may be wild: if more are, the model lacks something
LEAST_OFF = 0.1  # deviation of the logarithm below which a line cannot hide a resonance: the fit judges it
NARROW = 0.1  # bandwidth, over twice the distance of lines, below which one line alone shows a peak
MOST_DIGITS = 7  # numbers with so many digits, or fewer, count as rounded
EXACT, SMALLEST = 1e-9, 1e-13  # relative and absolute deviation that conversion leaves from a rounded number
STEP_REACH, STEP = 8, 6.5  # lines on either side of a step of the gain, and its least size in deviations
FIRST_SHARE = 4  # part of the lines of a thinner grid, its inverse, that is spread evenly
CAP = 0.05  # added to the deviation in the logarithmic residual: no line alone pulls a poor start astray


def wild_lines(omega: Real, values: Complex) -> Whole:
    """Return the lines that deviate from a power law of their neighbours as these do not.

    >>> omega = np.arange(4.0, 200.0, 4.0)
    >>> values = 1 / omega**2 + 0j
    >>> values[7] *= 30
    >>> wild_lines(omega, values).tolist()
    [7]
    """
    n = omega.size
    if n < FEWEST:
        return np.zeros(0, np.int64)
    x = np.log(omega)
    at: Whole = np.arange(n)

    def off(i: Whole, below: Whole, above: Whole) -> Real:
        """Return how far lines are off the power law of two others, over what noise makes of that."""
        share = (x[i] - x[below]) / (x[above] - x[below])
        away = np.log(values[i] / values[below]) - share * np.log(values[above] / values[below])
        turned = np.angle(np.exp(1j * away.imag))
        return np.asarray(np.hypot(away.real, turned) / np.sqrt(1 + share**2 + (1 - share) ** 2))

    below, above = at - 1, at + 1
    # At an end it is the two lines beside it, and both on the same side.
    below[0], above[0], below[-1], above[-1] = 1, 2, n - 3, n - 2
    alone = off(at, below, above)
    others = np.zeros(n)
    for step in range(2, REACH + 1):
        others[step:] = np.maximum(others[step:], alone[:-step])
        others[:-step] = np.maximum(others[:-step], alone[step:])
    # The neighbours are judged without the line itself.
    inner = at[2:-2]
    for beside, low, high in ((-1, -2, 1), (1, -1, 2)):
        without = off(inner + beside, inner + low, inner + high)
        others[2:-2] = np.maximum(others[2:-2], without)
    for places in ((0, 1, 2, 3), (1, 0, 2, 3), (n - 1, n - 2, n - 3, n - 4), (n - 2, n - 1, n - 3, n - 4)):
        line, *near = (np.array([index]) for index in places)
        others[line] = np.maximum(others[line], off(near[0], near[1], near[2]))
    return np.flatnonzero((alone > WILD * others) & (alone > LEAST_OFF))


def step_line(omega: Real, values: Complex) -> int | None:
    """Return the line after which all others are larger or smaller by a factor; None if there is none."""
    ratios = np.log(values[1:] / values[:-1]) / np.diff(omega)
    if ratios.size < 2 * STEP_REACH + 1:
        return None
    near = np.lib.stride_tricks.sliding_window_view(ratios, 2 * STEP_REACH + 1)
    others, middle = np.delete(near, STEP_REACH, axis=1), near[:, STEP_REACH]
    least = np.finfo(float).eps
    size = np.abs(middle.real - others.real.mean(axis=1)) / (others.real.std(axis=1) + least)
    turn = np.abs(middle.imag - others.imag.mean(axis=1)) / (others.imag.std(axis=1) + least)
    size[np.median(np.abs(others.real), axis=1) == 0] = 0.0  # rounded numbers, which have steps of their own
    index = int(np.argmax(size))
    return index + STEP_REACH if size[index] > STEP and turn[index] < STEP / 2 else None


def telling_lines(omega: Real, values: Complex, deviation: Real, most: int) -> Whole:
    """Return at most so many lines between which a response is nearly straight: many at peaks, few elsewhere.

    An interval is halved where the sum of squares of what lies off its chord, over the deviation, is largest.

    >>> omega = np.linspace(1, 50, 5000)
    >>> sharp = 1 / (100 - omega**2 + 0.02j * omega)
    >>> chosen = telling_lines(omega, sharp, np.full(5000, 0.01), 200)
    >>> chosen.size, bool(np.abs(omega[chosen] - 10).min() < 0.005)
    (200, True)
    """
    if omega.size <= most:
        return np.arange(omega.size)
    weight = 1 / (np.abs(values) * np.hypot(deviation, CAP))

    def interval(low: int, high: int) -> tuple[float, int, int]:
        inside = slice(low + 1, high)
        share = (omega[inside] - omega[low]) / (omega[high] - omega[low])
        chord = values[low] + share * (values[high] - values[low])
        return -float(np.sum((np.abs(values[inside] - chord) * weight[inside]) ** 2)), low, high

    ends = np.unique(np.linspace(0, omega.size - 1, max(most // FIRST_SHARE, 2)).astype(int)).tolist()
    intervals = [interval(low, high) for low, high in pairwise(ends)]
    heapify(intervals)
    chosen = set(ends)
    while len(chosen) < most:
        _, low, high = heappop(intervals)
        middle = (low + high) // 2
        if middle == low:
            break
        chosen.add(middle)
        heappush(intervals, interval(low, middle))
        heappush(intervals, interval(middle, high))
    return np.array(sorted(chosen), np.int64)


def written_step(numbers: Real) -> Real:
    """Return how far apart numbers are that a file's few digits can tell, at each; 0 where it has many.

    >>> written_step(np.array([9.985, 10.23, 104.6])).tolist(), written_step(np.array([np.pi, 2.0])).tolist()
    ([0.001, 0.01, 0.1], [0.0, 0.0])
    """
    size = np.abs(numbers)
    step_found: Real = np.zeros(size.size)
    least = SMALLEST * max(float(np.max(size, initial=0.0)), np.finfo(float).tiny)
    decade = np.floor(np.log10(np.maximum(size, least)) + EXACT) + 1
    for decimals in (decade, np.full(size.size, float(MOST_DIGITS))):  # significant digits, and decimals
        for digits in range(1, 2 * MOST_DIGITS if decimals is not decade else MOST_DIGITS + 1):
            step = 10 ** (decimals - digits)
            if np.all(np.abs(size - step * np.round(size / step)) <= EXACT * size + least):
                step_found = np.maximum(step_found, step)
                break
    return step_found


def single_lines(omega: Real, resonances: Resonances) -> Whole:
    """Return the lines beside resonances whose bandwidth is far less than the distance of lines."""
    outliers = []
    for centre, zeta in zip(resonances.omega_p, resonances.zeta_p, strict=True):
        i = int(np.argmin(np.abs(omega - centre)))
        distance = omega[min(i + 1, omega.size - 1)] - omega[max(i - 1, 0)]
        if omega[0] <= centre <= omega[-1] and 2 * zeta * centre < NARROW * distance:
            outliers.append(i)
    return np.unique(np.array(outliers, np.int64))


def isolated(places: Whole, size: int) -> Whole:
    """Return places that lie two at most beside each other; none if they are more than a share of all."""
    if places.size > max(MOST_WILD * size, 1.0):
        return places[:0]
    runs = np.split(places, np.flatnonzero(np.diff(places) > 1) + 1)
    return np.concatenate([run for run in runs if run.size <= 2] or [places[:0]])  # noqa: PLR2004
