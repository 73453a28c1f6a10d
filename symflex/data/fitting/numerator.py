"""What stands over given poles: the power of s, the zeros, the gain and its sign, by linear least squares.

With poles known, ``H(s) prod(poles) = s^k (c_0 + c_1 s + ... + c_m s^m)`` is linear in the coefficients
for each power of s and each number of zeros, which may be one more than there are poles: an inductor, and the
voice coil of a loudspeaker, have that. All of them are solved, which costs no more than one
factorisation of the widest, and compared by the BIC. The sign of the gain is that of ``c_0``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from symflex.data.fitting.least_squares import triangle
from symflex.data.fitting.output_error import LEAST_DAMPING, OutputError, PoleSet
from symflex.data.fitting.problem import FitProblem
from symflex.data.fitting.resonances import Complex, Free, Real, Resonances
from symflex.data.fitting.starts import REAL, solved_real

TURNS, PER_TURN = 2.5, 8  # delays tried on either side of that of the poles, in turns at the highest line
MOST_LINES = 400
MOST_POLISHED = 12
POLISHED = 4
STRANGE, MOST_DAMPED = 10.0, 2.0  # BIC to gain by a pair of zeros that is hardly one; its least damping ratio
FAR_OUTSIDE = 30.0  # frequency over the end of the band beyond which a pole bends nothing that a gain cannot


MOST_ZETA = 1 - 1e-9  # damping ratio of a pair that is no two real poles
LOST = 10.0  # standard error, over its value, of a parameter that a record does not determine
STEP = 0.01  # of standard errors, by which parameters move for derivatives


@dataclass(frozen=True, eq=False)
class Numerator:
    """What stands over the poles in one response; zeros as in Resonances, padded with infinity."""

    bic: float
    slope: int
    omega_z: Real
    zeta_z: Real
    real_z: float
    gain: float
    delay: float


def strange(omega_z: Real, zeta_z: Real, real_z: Real, low: float, high: float) -> int:
    """Return how many zeros, or pairs of them, are hardly those of a structure seen in this band."""
    # They lie outside it, or are two real ones of the same sign: such zeros make up for noise and for a wrong
    # power of s. A real one far outside counts twice: it is a power of s, or a gain, and rounded numbers.
    frequency = np.abs(omega_z)
    outside = np.isfinite(frequency) & ((frequency < low) | (frequency > high))
    pairs = outside | (np.isfinite(frequency) & (np.abs(zeta_z) > MOST_DAMPED))
    corner = np.abs(real_z[np.isfinite(real_z)])
    ends = ((low, high), (low / FAR_OUTSIDE, high * FAR_OUTSIDE))
    return int(pairs.sum() + sum(np.sum((corner < a) | (corner > b)) for a, b in ends))


def over_poles(problem: FitProblem, poles: Complex, most: int) -> list[tuple[float, Resonances]]:
    """Return at most so many functions with these poles that describe the lines best, with their BIC."""
    choices = [_numerators(problem, r, poles, most) for r in range(len(problem.lines))]
    if not all(choices):
        return []
    best = [one[0] for one in choices]
    combined = [_together(poles, best)]
    # One response at a time gets its next best.
    for r, one in enumerate(choices):
        combined += [_together(poles, [*best[:r], other, *best[r + 1 :]]) for other in one[1:]]
    return combined


def _together(poles: Complex, chosen: list[Numerator]) -> tuple[float, Resonances]:
    pairs = poles[poles.imag != 0]
    omega, zeta = np.abs(pairs), -pairs.real / np.abs(pairs)
    corners = np.sort(-poles[poles.imag == 0].real)
    # Two real poles are a pair; one that is left stays alone.
    first, second = corners[: corners.size // 2 * 2 : 2], corners[1::2]
    centre = np.sqrt(first * second)
    omega_p, zeta_p = np.append(omega, centre), np.append(zeta, (first + second) / (2 * centre))
    per_response = ("omega_z", "zeta_z", "gain", "delay", "slope", "real_z")
    arrays = {name: np.array([getattr(one, name) for one in chosen]) for name in per_response}
    modes = Resonances(omega_p, zeta_p, real_p=corners[corners.size // 2 * 2 :], **arrays)
    return sum(one.bic for one in chosen), modes.ordered()


def _numerators(problem: FitProblem, response: int, poles: Complex, most: int) -> list[Numerator]:
    full = _System(problem, response, poles)
    order = int(np.sum(np.where(poles.imag == 0, 1, 2)))
    shapes = [(slope, zeros) for slope in problem.slopes for zeros in range(full.most_zeros + 1)]
    begun = problem.delays[response]
    if not problem.free.delay:
        solved = full.solved(shapes, begun)
        likely = np.argsort(full.bic(np.array([misfit for misfit, _ in solved]), shapes))[:MOST_POLISHED]
        polished = [(solved[i][0], begun, shapes[i], solved[i][1]) for i in likely]
    else:
        # Poles hardly depend on the delay they were found with; what stands over them does.
        thin = _System(problem, response, poles, max(1, full.size // MOST_LINES))
        turn = 2 * np.pi / float(np.max(full.s.imag))
        tried = begun + turn * np.arange(-TURNS, TURNS, 1 / PER_TURN)
        tried = np.unique(np.maximum(tried, 0.0))
        table = np.array([[misfit for misfit, _ in thin.solved(shapes, float(one))] for one in tried])
        least = table.min(axis=0)
        likely = np.argsort(thin.bic(least, shapes))[:MOST_POLISHED]
        polished = [full.polished(shapes[i], float(tried[np.argmin(table[:, i])])) for i in likely]
    every = []
    for misfit, delay, shape, coefficients in polished:
        zeros = _pairs(coefficients, full.middle, order // 2)
        if zeros is not None:
            gain = float(coefficients[0]) / full.middle ** shape[0]
            bic = float(full.bic(np.array([misfit]), [shape])[0])
            bic += STRANGE * strange(zeros[0], zeros[1], np.array(zeros[2]), *problem.band)
            bic += STRANGE * (not problem.has_base and sum(shape) > order)  # it grows beyond the band
            every.append(Numerator(bic, shape[0], *zeros, gain, delay))
    return sorted(every, key=lambda one: one.bic)[:most]


class _System:
    """The linear equations of the coefficients, on every line or on some of them."""

    def __init__(self, problem: FitProblem, response: int, poles: Complex, every: int = 1) -> None:
        line = problem.lines[response]
        omega, self.values, self.parts = line.omega_seen[::every], line.ratio[::every], line.parts
        weight = 1 / np.abs(self.values)
        if line.deviation is not None:
            weight = weight / line.deviation[::every]
        self.weight, self.s, self.size = weight, 1j * omega, omega.size
        self.middle = float(np.exp(np.mean(np.log(line.omega))))
        self.has_gain = problem.free.gain
        below = np.ones(omega.size, np.complex128)
        for pole in poles:
            below = below * (1 - self.s / pole)
            if pole.imag:
                below = below * (1 - self.s / np.conj(pole))
        self.first = min(problem.slopes)
        order = int(np.sum(np.where(poles.imag == 0, 1, 2)))
        # As many pairs of zeros as of poles at most, and one more zero.
        self.most_zeros = order // 2 * 2 + 1
        powers = np.arange(self.first, max(problem.slopes) + self.most_zeros + 1)
        self.columns = (weight / below)[:, None] * (self.s / self.middle)[:, None] ** powers.astype(float)

    def _at(self, shape: tuple[int, int]) -> npt.NDArray[np.intp]:
        return np.arange(shape[0] - self.first, shape[0] - self.first + shape[1] + 1)

    def bic(self, misfit: Real, shapes: list[tuple[int, int]]) -> Real:
        """Return the BIC of sums of squares, one for each power of s and number of zeros."""
        size = self.parts * self.size
        parameters = np.array([zeros + 1 for _, zeros in shapes])
        return np.asarray(size * np.log(misfit / size + 1e-9) + parameters * np.log(size), np.float64)

    def solved(self, shapes: list[tuple[int, int]], delay: float) -> list[tuple[float, Real]]:
        """Return for each shape the sum of squares and the coefficients, with one factorisation for all."""
        target = self.weight * self.values * np.exp(self.s * delay)
        extended = np.concatenate((self.columns, target[:, None]), axis=1)
        stacked = np.concatenate((extended.real, extended.imag))
        norms = np.maximum(np.linalg.norm(stacked, axis=0), np.finfo(float).tiny)
        upper = triangle(stacked / norms)
        return [self._coefficients(upper, norms, shape) for shape in shapes]

    def _coefficients(self, upper: Real, norms: Real, shape: tuple[int, int]) -> tuple[float, Real]:
        at, right = self._at(shape), upper[:, -1]
        given = np.zeros(0)
        if not self.has_gain:
            # What is given stands on the right: the first coefficient.
            given = np.array([self.middle ** shape[0]])
            right = right - upper[:, at[0]] * norms[at[0]] * given[0] / norms[-1]
            at = at[1:]
        solution = np.linalg.lstsq(upper[:, at], right, rcond=None)[0]
        misfit = float(np.sum((right - upper[:, at] @ solution) ** 2)) * float(norms[-1]) ** 2
        return misfit, np.concatenate((given, solution * norms[-1] / norms[at]))

    def polished(self, shape: tuple[int, int], delay: float) -> tuple[float, float, tuple[int, int], Real]:
        """Return sum of squares, delay, shape and coefficients after a few steps of the delay."""
        at = self._at(shape)[0 if self.has_gain else 1 :]
        for _ in range(POLISHED):
            target = self.weight * self.values * np.exp(self.s * delay)
            if not self.has_gain:
                first = self._at(shape)[0]
                target = target - self.columns[:, first] * self.middle ** shape[0]
            turned = -self.weight * self.values * np.exp(self.s * delay) * self.s
            matrix = np.concatenate((self.columns[:, at], turned[:, None]), axis=1)
            delay = max(delay + float(solved_real(matrix, target)[-1]), 0.0)
        ((misfit, coefficients),) = self.solved([shape], delay)
        return misfit, delay, shape, coefficients


def _pairs(coefficients: Real, middle: float, count: int) -> tuple[Real, Real, float] | None:
    """Return the zeros of a polynomial in s/middle as pairs and one real corner, ``None`` if too many."""
    if coefficients[0] == 0 or coefficients[-1] == 0 or not np.isfinite(coefficients).all():
        return None
    roots = np.roots(coefficients[::-1]) * middle
    pairs = [(abs(z), -z.real / abs(z)) for z in roots if z.imag > REAL * abs(z)]
    real = [float(z.real) for z in roots if abs(z.imag) <= REAL * abs(z)]
    left, right = sorted(-z for z in real if z < 0), sorted(z for z in real if z > 0)
    for side, sign in ((left, 1.0), (right, -1.0)):
        while len(side) > 1:
            a, b = side.pop(0), side.pop(0)
            pairs.append((np.sqrt(a * b), sign * (a + b) / (2 * np.sqrt(a * b))))
    single = np.inf
    if left and right:
        a, b = left[0], right[0]
        pairs.append((-np.sqrt(a * b), np.sqrt(a * b) / 2 * (1 / a - 1 / b)))
    elif left or right:
        single = left[0] if left else -right[0]
    missing = count - len(pairs)
    if len(pairs) != (coefficients.size - 1) // 2 or missing < 0:
        return None
    omega = np.array([*(p[0] for p in pairs), *[np.inf] * missing], np.float64)
    return omega, np.array([*(p[1] for p in pairs), *[0.0] * missing], np.float64), single


class Residues:
    """Residues over poles, fitted to records in time, as numerators; coefficients that may be zero are."""

    # A numerator has every power of s below the order. Those at its ends that the data do not tell from zero
    # are set to zero one by one, and all other parameters move as their covariance says (Wald, Trans. Am.
    # Math. Soc. 54, 1943): to first order the result is the fit with fewer zeros, or another power of s.

    def __init__(self, problem: OutputError, dynamics: PoleSet, slope: int | None) -> None:
        covariance, self.solved, self.reduced = problem.covariance(dynamics)
        packed = dynamics.pack(problem.step_s, problem.length_s)
        self.dynamics, self.step_s = dynamics, problem.step_s
        first = problem.outputs[0][0]
        # A free decay is the response to an impulse at its first sample.
        self.decay_s = first.size * first.step_s if first.input is None else None
        poles = 2 * dynamics.omega.size + dynamics.real.size
        self.poles = poles
        plant = dynamics.order + dynamics.has_direct
        places = [*range(poles), *([packed.size - 1] if dynamics.is_delay_free else [])]
        values = [packed[places]]
        at = packed.size
        for one in self.solved:
            places += range(at, at + plant)
            values.append(one.coefficients[:plant])
            at += one.coefficients.size
        self.values = np.concatenate(values)
        self.covariance = covariance[np.ix_(places, places)]
        lost = np.flatnonzero(~np.isfinite(np.diag(self.covariance)))
        self.is_determined = not lost.size
        self.covariance[lost, lost] = (LOST * (np.abs(self.values[lost]) + 1)) ** 2
        self.all_errors = np.sqrt(np.diag(covariance))
        self.middle = float(
            np.exp(np.mean(np.log([*dynamics.omega, *dynamics.real, 2 * np.pi / problem.length_s])))
        )
        if dynamics.omega.size + dynamics.real.size:
            self.middle = float(np.exp(np.mean(np.log([*dynamics.omega, *dynamics.real]))))
        self.is_contradicted = False  # whether the data contradict the power of s that is asked for
        prices = np.log(problem.sizes)
        self.shapes = [self._shape(r, slope, price) for r, price in enumerate(prices)]
        if dynamics.is_delay_free and self.values[poles] ** 2 <= prices[0] * self.covariance[poles, poles]:
            self._moved(self.values[poles], np.arange(self.values.size) == poles)
            self.values[poles] = 0.0

    def numerator(self, values: Real, response: int) -> Real:
        """Return the coefficients of powers of s over :attr:`middle`, from 0 on."""
        n, m, zeros = self.dynamics.omega.size, self.dynamics.real.size, self.dynamics.integrators
        omega, zeta = np.exp(values[:n]) / self.middle, np.clip(values[n : 2 * n], -MOST_ZETA, MOST_ZETA)
        corners = np.exp(values[2 * n : 2 * n + m]) / self.middle
        below = [np.array([w * w, 2 * z * w, 1.0]) for w, z in zip(omega, zeta, strict=True)]
        below += [np.array([c, 1.0]) for c in corners] + [np.array([0.0, 1.0])] * zeros
        plant = 2 * n + m + zeros + self.dynamics.has_direct
        first = self.poles + self.dynamics.is_delay_free + response * plant
        residues = values[first : first + plant] / self.middle
        if self.decay_s is not None:
            residues = residues.copy()
            upper = self.middle * omega * (-zeta + 1j * np.sqrt(1 - zeta**2))
            of_pairs = (residues[: 2 * n].reshape(n, 2) @ [1, 1j]) / (1 - np.exp(upper * self.decay_s))
            residues[: 2 * n] = np.stack((of_pairs.real, of_pairs.imag), axis=1).ravel()
            residues[2 * n : 2 * n + m] /= 1 - np.exp(-corners * self.middle * self.decay_s)
        above = [
            np.array([2 * (a * z * w - b * w * np.sqrt(1 - z * z)), 2 * a])
            for (a, b), w, z in zip(residues[: 2 * n].reshape(n, 2), omega, zeta, strict=True)
        ]
        above += [np.array([c]) for c in residues[2 * n : 2 * n + m]]
        above += [np.array([residues[2 * n + m + k] / self.middle**k]) for k in range(zeros)]
        total = np.zeros(2 * n + m + zeros + 1)
        for i, own in enumerate(above):
            # The second pole at zero is over s^2, all others over their own factor.
            others = [one for k, one in enumerate(below) if k != i]
            if i == n + m + 1:
                others = below[: n + m]
            elif i == n + m and zeros > 1:
                others = [*below[: n + m], np.array([0.0, 1.0])]
            product = own
            for one in others:
                product = np.convolve(product, one)
            total[: product.size] += product
        if self.dynamics.has_direct:
            product = np.array([residues[-1] * self.middle])
            for one in below:
                product = np.convolve(product, one)
            total += product
        return total

    def _shape(self, response: int, slope: int | None, price: float) -> tuple[int, int]:
        """Return the lowest and the highest power of s, and move the parameters to where others are zero."""
        zeros = self.dynamics.integrators
        low, high = 0, self.dynamics.order - (not self.dynamics.has_direct)
        most = 2 * (self.dynamics.omega.size + self.dynamics.real.size // 2) + 1
        while slope is not None and low < min(slope + zeros, high):
            if self._is_nothing(response, low, price):
                self._conditioned(response, low)
            else:  # what the data contradict moves no pole
                self.is_contradicted = True
            low += 1
        while high > low and (high - low > most or self._is_nothing(response, high, price)):
            self._conditioned(response, high)
            high -= 1
        while slope is None and low < high and self._is_nothing(response, low, price):
            self._conditioned(response, low)
            low += 1
        return low, high

    def _slope(self, response: int, power: int) -> tuple[float, Real]:
        value = self.numerator(self.values, response)[power]
        errors = np.sqrt(np.maximum(np.diag(self.covariance), 0))
        steps = STEP * np.where(errors > 0, np.minimum(errors, np.abs(self.values) + 1), 1e-9)
        slopes = np.zeros(self.values.size)
        for i, step in enumerate(steps):
            moved = [self.values.copy() for _ in range(2)]
            moved[0][i] += step
            moved[1][i] -= step
            up, down = (self.numerator(one, response)[power] for one in moved)
            slopes[i] = (up - down) / (2 * step)
        return float(value), slopes

    def _is_nothing(self, response: int, power: int, price: float) -> bool:
        value, slopes = self._slope(response, power)
        variance = float(slopes @ self.covariance @ slopes)
        return bool(value**2 <= price * variance) or not np.isfinite(variance)

    def _conditioned(self, response: int, power: int) -> None:
        self._moved(*self._slope(response, power))

    def _moved(self, value: float, slopes: Real) -> None:
        """Move the parameters to where a value with these derivatives is zero."""
        turned = self.covariance @ slopes
        variance = float(slopes @ turned)
        if not (np.isfinite(variance) and variance > 0):
            return
        moved = self.values - turned * value / variance
        n = self.dynamics.omega.size
        if np.all((moved[n : 2 * n] > 0) & (moved[n : 2 * n] < 1)):
            self.values = moved
            self.covariance = self.covariance - np.outer(turned, turned) / variance

    def resonances(self, values: Real | None = None) -> Resonances | None:
        """Return poles, zeros and gains; None where zeros are more than poles have room for."""
        values = self.values if values is None else values
        n, m, zeros = self.dynamics.omega.size, self.dynamics.real.size, self.dynamics.integrators
        omega, zeta = np.exp(values[:n]), np.maximum(values[n : 2 * n], LEAST_DAMPING)
        corners = np.sort(np.exp(values[2 * n : 2 * n + m]))
        first, second = corners[: m // 2 * 2 : 2], corners[1::2]
        centre = np.sqrt(first * second)
        made = []
        for r, (low, high) in enumerate(self.shapes):
            above = self.numerator(values, r)[low : high + 1]
            found = _pairs(above, self.middle, n + m // 2)
            if found is None:
                return None
            constant = np.prod((omega / self.middle) ** 2) * np.prod(corners / self.middle)
            slope = low - zeros
            made.append((*found, above[0] / constant / self.middle**slope, slope))
        omega_z, zeta_z, real_z, gain, slopes = (np.array(one) for one in zip(*made, strict=True))
        delay = values[self.poles] * self.step_s if self.dynamics.is_delay_free else 0.0
        return Resonances(
            np.append(omega, centre),
            np.append(zeta, (first + second) / (2 * centre)),
            omega_z,
            zeta_z,
            gain.astype(np.float64),
            delay=np.full(len(made), delay),
            slope=slopes.astype(np.int64),
            real_p=corners[m // 2 * 2 :],
            real_z=real_z.astype(np.float64),
        ).ordered()

    def packed(self, free: Free) -> tuple[Resonances, Real]:
        """Return the result and the covariance of its packed parameters, to first order."""
        best = self.resonances()
        assert best is not None
        values, vectors = np.linalg.eigh(self.covariance)
        packed = best.pack(free)
        columns = []
        for value, vector in zip(values, vectors.T, strict=True):
            way = np.sqrt(max(value, 0.0)) * vector
            step = STEP / max(1.0, float(np.max(np.abs(way[: self.poles]), initial=0.0)))
            ends = [self.resonances(self.values + sign * step * way) for sign in (1, -1)]
            up, down = (packed if one is None else one.pack(free) for one in ends)
            if up.size == down.size == packed.size:
                columns.append((up - down) / (2 * step))
            else:
                columns.append(np.where(np.arange(packed.size) < best.shared(), 0.0, np.inf))
        slopes = np.array(columns).T.reshape(packed.size, -1)
        is_lost = ~np.isfinite(slopes).all(axis=1)
        slopes[is_lost] = 0
        covariance = slopes @ slopes.T
        covariance[is_lost, is_lost] = np.inf
        if not self.is_determined:
            covariance[np.diag_indices(packed.size)] += np.where(
                np.arange(packed.size) >= best.shared(), np.inf, 0
            )
        return best, covariance
