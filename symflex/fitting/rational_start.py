"""Starts from rational approximation: vector fitting and AAA.

Both fit the quotient of measurement and base by a rational function with as many poles as zeros, and both
are exact on data without noise. Sources: Gustavsen & Semlyen, Rational approximation of frequency domain
responses by vector fitting, IEEE Trans. Power Delivery 14(3), 1999; Gustavsen, Improving the pole
relocating properties of vector fitting, IEEE Trans. Power Delivery 21(3), 2006 (relaxed); Nakatsukasa, Sete
& Trefethen, The AAA algorithm for rational approximation, SIAM J. Sci. Comput. 40(3), 2018.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from scipy.linalg import eig

from symflex.fitting.resonances import Resonances

if TYPE_CHECKING:
    from symflex.fitting.problem import FitProblem

Real = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]

ITERATIONS = 25
FIRST_DAMPING = 0.01
SETTLED = 1e-8
LOWEST_DAMPING = 1e-4
WIDER = 3.0


def start_from_vector_fitting(problem: FitProblem, count: int) -> Resonances | None:
    """Return a start by relaxed vector fitting, None when it finds no such resonances."""
    low, high = problem.band
    return _from_poles(problem, _relocated(problem, _spread(low, high, count)), count)


def start_from_aaa(problem: FitProblem, count: int) -> Resonances | None:
    """Return a start from the poles of an AAA approximant of the first response.

    Noise gives AAA spurious poles; of those in the band the ones with the largest residue over real part are
    taken, and zeros and residues follow from linear least squares.
    """
    line = problem.lines[0]
    poles = _aaa_poles(line.omega, line.ratio, 2 * count)
    low, high = problem.band
    wanted = [
        (size, pole)
        for size, pole in poles
        if low <= abs(pole) <= high and abs(pole.real) < 0.5 * abs(pole) and pole.imag > 0
    ]
    chosen = sorted(wanted, key=lambda item: -item[0])[:count]
    if len(chosen) < count:
        return None
    upper = np.array([complex(-max(abs(p.real), LOWEST_DAMPING * abs(p)), p.imag) for _, p in chosen])
    return _from_poles(problem, upper[np.argsort(upper.imag)], count)


def _spread(low: float, high: float, count: int) -> Complex:
    """Return poles spread over a band, as vector fitting wants to begin."""
    middle = (np.arange(count) + 0.5) / count
    omega = low * (high / low) ** middle if high > 30 * low else low + (high - low) * middle
    return -FIRST_DAMPING * omega + 1j * omega


def _weights(problem: FitProblem, response: int) -> Real:
    """Return weights of the quotient's lines: over its standard deviation, or else over its magnitude."""
    line = problem.lines[response]
    size = np.abs(line.ratio)
    return 1 / (size if line.deviation is None else size * np.hypot(line.deviation, 0.01))


def _basis(omega: Real, poles: Complex) -> Complex:
    """Return 1/(s - p) of the pairs in real combinations, shape (k, 2 n)."""
    s = 1j * omega[:, None]
    first, second = 1 / (s - poles), 1 / (s - np.conj(poles))
    basis = np.empty((omega.size, 2 * poles.size), dtype=np.complex128)
    basis[:, 0::2], basis[:, 1::2] = first + second, 1j * (first - second)
    return basis


def _state_matrix(poles: Complex) -> tuple[Real, Real]:
    """Return A and b of the basis in real form."""
    size = 2 * poles.size
    a, b = np.zeros((size, size)), np.zeros(size)
    for i, pole in enumerate(poles):
        k = 2 * i
        a[k : k + 2, k : k + 2] = [[pole.real, pole.imag], [-pole.imag, pole.real]]
        b[k] = 2
    return a, b


def _eigenvalues(matrix: Real) -> Complex:
    return np.asarray(np.linalg.eigvals(matrix), np.complex128)


def _relocated(problem: FitProblem, poles: Complex) -> Complex:
    """Return the poles after relaxed vector fitting; pairs stay pairs, and stay stable."""
    for _ in range(ITERATIONS):
        columns = 2 * poles.size
        rows, right = [], []
        total = 0.0
        for r, line in enumerate(problem.lines):
            basis, weight = _basis(line.omega, poles), _weights(problem, r)
            ones = np.ones((line.omega.size, 1))
            local = np.concatenate((basis, ones), axis=1)
            scaled = -line.ratio[:, None] * np.concatenate((basis, ones), axis=1)
            block = weight[:, None] * np.concatenate((local, scaled), axis=1)
            block = np.concatenate((block.real, block.imag))
            # Only what the shared part needs is kept of each response (Deschrijver et al. 2008).
            _, upper = np.linalg.qr(block)
            rows.append(upper[columns + 1 :, columns + 1 :])
            right.append(np.zeros(rows[-1].shape[0]))
            total += float(np.linalg.norm(weight * np.abs(line.ratio))) ** 2
        size = sum(line.omega.size for line in problem.lines)
        mean = np.sqrt(total) / size
        summed = np.sum(
            [
                np.concatenate((_basis(line.omega, poles).real.sum(axis=0), [line.omega.size]))
                for line in problem.lines
            ],
            axis=0,
        )
        rows.append(mean * summed[None, :])
        right.append(np.array([mean * size]))
        matrix, target = np.concatenate(rows), np.concatenate(right)
        norms = np.maximum(np.linalg.norm(matrix, axis=0), np.finfo(float).tiny)
        solution = np.linalg.lstsq(matrix / norms, target, rcond=None)[0] / norms
        a, b = _state_matrix(poles)
        direct = solution[-1] if abs(solution[-1]) > SETTLED else SETTLED
        moved = _upper(_eigenvalues(a - np.outer(b, solution[:-1]) / direct), poles.size)
        change = np.max(np.abs(moved - poles) / np.abs(poles))
        poles = moved
        if change < SETTLED:
            break
    return poles


def _upper(roots: Complex, count: int) -> Complex:
    """Return so many stable poles in the upper half plane; two real ones become a damped pair."""
    scale = np.abs(roots).max()
    upper = [complex(-abs(p.real), p.imag) for p in roots if p.imag > 1e-9 * scale]
    real = sorted(abs(p) for p in roots if abs(p.imag) <= 1e-9 * scale)
    for first, second in zip(real[0::2], real[1::2], strict=False):
        centre = np.sqrt(max(first * second, 1e-12 * scale**2))
        upper.append(centre * complex(-0.5, np.sqrt(0.75)))
    found = np.array(sorted(upper, key=lambda p: p.imag)[:count], dtype=np.complex128)
    least = LOWEST_DAMPING * np.abs(found)
    return np.where(-found.real < least, -least + 1j * found.imag, found)


def _from_poles(problem: FitProblem, poles: Complex, count: int) -> Resonances | None:
    """Return resonances with the given poles; zeros and gains by linear least squares."""
    if poles.size != count:
        return None
    low, high = problem.band
    omega_z, zeta_z, gains = [], [], []
    for r, line in enumerate(problem.lines):
        basis = np.concatenate((_basis(line.omega, poles), np.ones((line.omega.size, 1))), axis=1)
        weight = _weights(problem, r)
        matrix = weight[:, None] * basis
        stacked = np.concatenate((matrix.real, matrix.imag))
        target = weight * line.ratio
        norms = np.maximum(np.linalg.norm(stacked, axis=0), np.finfo(float).tiny)
        solved = np.linalg.lstsq(stacked / norms, np.concatenate((target.real, target.imag)), rcond=None)[0]
        solved = solved / norms
        a, b = _state_matrix(poles)
        direct = solved[-1] if abs(solved[-1]) > SETTLED * np.abs(line.ratio).max() else SETTLED
        zeros = _eigenvalues(a - np.outer(b, solved[:-1]) / direct)
        pairs = _zero_pairs(zeros, low / WIDER, high * WIDER)
        if len(pairs) != count:
            return None
        omega_z.append([p[0] for p in pairs])
        zeta_z.append([p[1] for p in pairs])
        sign = np.sign(solved[-1]) or 1.0
        gains.append(_gain(problem, r, poles, pairs, float(sign)))
    found = Resonances(
        np.abs(poles), -poles.real / np.abs(poles), np.array(omega_z), np.array(zeta_z), np.array(gains)
    )
    return found.ordered()


def _gain(
    problem: FitProblem, response: int, poles: Complex, pairs: list[tuple[float, float]], sign: float
) -> float:
    if not problem.free.gain:
        return 1.0
    line = problem.lines[response]
    table = np.array(pairs)
    one = Resonances(
        np.abs(poles), -poles.real / np.abs(poles), table[None, :, 0], table[None, :, 1], np.ones(1)
    )
    return sign * float(np.exp(np.median(np.log(np.abs(line.ratio / one.factor(0, line.omega))))))


def _zero_pairs(zeros: Complex, low: float, high: float) -> list[tuple[float, float]]:
    """Return natural frequency, within limits, and damping ratio of pairs of zeros."""
    scale = np.abs(zeros).max()
    pairs = [(abs(z), -z.real / abs(z)) for z in zeros if z.imag > 1e-9 * scale]
    real = sorted(z.real for z in zeros if abs(z.imag) <= 1e-9 * scale)
    for first, second in zip(real[0::2], real[1::2], strict=False):
        centre = np.sqrt(max(abs(first * second), 1e-12 * scale**2))
        pairs.append((centre, float(np.clip(-(first + second) / (2 * centre), -1, 1))))
    return sorted((float(np.clip(w, low, high)), float(z)) for w, z in pairs)


def _aaa_poles(omega: Real, values: Complex, degree: int) -> list[tuple[float, complex]]:
    """Return poles of an AAA approximant of data at s = j omega and its mirror, each with its weight."""
    points = np.concatenate((1j * omega, -1j * omega))
    data = np.concatenate((values, np.conj(values)))
    free = np.ones(points.size, dtype=bool)
    chosen: list[int] = []
    approximant = np.full(points.size, data.mean())
    weights = np.ones(1, dtype=np.complex128)
    while len(chosen) < degree + 1 and free.sum() > 2 * degree:
        # Points enter with their mirror images, so that poles come in pairs.
        worst = int(np.argmax(np.where(free, np.abs(data - approximant) / np.abs(data), -1)))
        for place in (worst, (worst + omega.size) % points.size):
            free[place] = False
            chosen.append(place)
        support, at = points[chosen], data[chosen]
        cauchy = 1 / (points[free, None] - support)
        loewner = (data[free, None] - at) * cauchy / np.abs(data[free, None])
        weights = np.conj(np.linalg.svd(loewner, full_matrices=False)[2][-1])
        approximant = data.copy()
        approximant[free] = (cauchy @ (weights * at)) / (cauchy @ weights)
    support, at = points[chosen], data[chosen]
    size = len(chosen)
    right = np.eye(size + 1)
    right[0, 0] = 0
    left = np.zeros((size + 1, size + 1), dtype=np.complex128)
    left[0, 1:], left[1:, 0] = weights, 1
    left[1:, 1:] = np.diag(support)
    found = []
    for pole in eig(left, right, right=False):
        if not np.isfinite(pole) or pole.imag <= 0:
            continue
        away = pole - support
        with np.errstate(all="ignore"):  # data that an approximant meets exactly leave poles on its points
            residue = np.sum(weights * at / away) / np.sum(-weights / away**2)
        if not np.isfinite(residue):
            continue
        found.append((float(abs(residue) / max(abs(pole.real), 1e-9 * abs(pole))), complex(pole)))
    return found
