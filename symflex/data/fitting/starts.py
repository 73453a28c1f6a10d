"""Where fits begin: from the magnitude alone, from rational approximation, and with which delay.

The paper's procedure takes the magnitude alone. For each resonance, starting with the lowest: compare the
model so far with the data; the peak is omega_p, the trough omega_z; zeta_p matches the height of the peak,
zeta_z the depth of the trough (Eppinger & Seering 1988, section "Polynomial Resonance Model").

Vector fitting and AAA fit the quotient of measurement and base by a rational function with as many poles as
zeros, and both are exact on data without noise. Sources: Gustavsen & Semlyen, Rational approximation of
frequency domain responses by vector fitting, IEEE Trans. Power Delivery 14(3), 1999; Gustavsen, Improving the
pole relocating properties of vector fitting, IEEE Trans. Power Delivery 21(3), 2006 (relaxed); Nakatsukasa,
Sete & Trefethen, The AAA algorithm for rational approximation, SIAM J. Sci. Comput. 40(3), 2018.

A wrong delay winds the phase, and no function with few poles follows that: the one that leaves least of a
row of delays is within a quarter of a turn at the highest line, and from there least squares find it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import eig

from symflex.budget import spend
from symflex.data.fitting.least_squares import triangle
from symflex.data.fitting.resonances import Complex, Real, Resonances, Values, Whole

if TYPE_CHECKING:
    from symflex.data.fitting.problem import FitProblem

LEAST_PROMINENCE = 0.02  # of the logarithm of the magnitude: 0.2 dB, below the shoulders of close pairs
NOISE_MULTIPLE = 5.0  # a peak stands out by so many times the scatter from line to line
TYPICAL_RATIO, TYPICAL_DAMPING = 1.1, 0.05  # omega_z/omega_p and damping ratio that the paper calls typical
LOWEST_DAMPING, HIGHEST_DAMPING = 1e-4, 0.5  # damping ratios of a start are kept between these
MATCHING_STEPS = 30  # of the iteration that matches height and depth in turn
SMOOTHED = 5  # lines through which a parabola is laid (Savitzky and Golay 1964)
APART = 3  # lines between a peak that shows up later and those that are known

# Of vector fitting and AAA.
ITERATIONS = 25  # of vector fitting, which mostly settles in fewer
FIRST_DAMPING = 0.01  # of the poles that vector fitting begins with, as its authors recommend
UNMOVED = 1e-4  # relative change of poles at which vector fitting has settled: least squares go on from there
SETTLED = 1e-6  # the least of its free constant
SPARE = 2  # poles, or pairs of them, more than are looked for, which noise or a delay may take up
GENEROUS = 10  # steps of a vector fit from which only a level of noise, or a first choice of poles, is taken
REPHASED = 6  # rounds in which magnitudes without a phase take that of the function fitted to them
LARGEST_START = 0.3  # damping ratio beyond which a pole counts less and less as a resonance
FREE_POWERS = (-2, -1, 0, 1, 2)  # beside the fractions, where the power is unknown: receptance to accelerance

REAL = 1e-9  # share of a pole's magnitude from which its imaginary part makes it one of a pair

FEW_POWERS = (0, 1)  # the same to find poles outside the band: what they add looks like powers of s

PER_TURN = 5  # delays tried per turn of the phase at the highest line
MOST_TURNS = 40.0
LEAST_TURNS = 2.0  # of the phase at the highest line: how far the delays tried reach, at most and at least
MOST_LINES = 300  # lines on which delays are compared


def find_modes(problem: FitProblem) -> list[int]:
    """Return the lines of the first response's peaks over its base, the most prominent first."""
    level = np.log(np.abs(problem.lines[0].ratio))
    noise = _noise(level)
    smooth = _smoothed(level)
    return _peaks(smooth, max(LEAST_PROMINENCE, NOISE_MULTIPLE * noise))


def start_from_peaks(problem: FitProblem, count: int) -> Resonances | None:
    """Return a start with so many resonances, None when the first response has fewer peaks."""
    chosen = find_modes(problem)[:count]
    while len(chosen) < count:
        # A shoulder becomes a peak when the modes found so far are divided out.
        more = _hidden_peak(problem, sorted(chosen))
        if more is None:
            return None
        chosen.append(more)
    fitted = [_one_response(problem, r, sorted(chosen)) for r in range(len(problem.lines))]
    table = np.array([modes for modes, _ in fitted], np.float64)
    gains = np.array([gain for _, gain in fitted])
    omega_p, zeta_p = table[0, :, 0], table[0, :, 1]
    return Resonances(omega_p, zeta_p, table[:, :, 2], table[:, :, 3], gains).ordered()


def _hidden_peak(problem: FitProblem, peaks: list[int]) -> int | None:
    """Return the most prominent peak of what is left of the first response, away from those known."""
    if not peaks:
        return None
    modes, gain = _one_response(problem, 0, peaks)
    line = problem.lines[0]
    level = np.log(np.abs(line.ratio / Resonances.of(modes, gain).factor(0, line.omega)))
    noise = NOISE_MULTIPLE * _noise(level)
    far = (k for k in _peaks(_smoothed(level), max(LEAST_PROMINENCE, noise)))
    return next((k for k in far if min(abs(k - peak) for peak in peaks) > APART), None)


def _one_response(
    problem: FitProblem, response: int, peaks: list[int]
) -> tuple[list[tuple[float, float, float, float]], float]:
    line = problem.lines[response]
    omega, ratio = line.omega, line.ratio
    gain = 1.0
    if problem.free.gain:
        # The sign is that of the lowest lines, where no resonance has turned the phase yet.
        first = ratio[: max(3, peaks[0] // 3)]
        sign = 1 if np.median(first.real) >= 0 else -1
        gain = sign * float(np.exp(np.median(np.log(np.abs(first)))))
    level = np.log(np.abs(ratio / gain))
    modes: list[tuple[float, float, float, float]] = []
    for i, peak in enumerate(peaks):
        before = peaks[i - 1] if i else 0
        after = peaks[i + 1] if i + 1 < len(peaks) else omega.size - 1
        smooth = _smoothed(level)
        low, high = (before + peak) // 2, (peak + after) // 2 + 1
        top = low + int(np.argmax(smooth[low:high])) if i else peak
        if not low < top < high - 1:
            top = peak
        trough = _trough(smooth, top, before, after)
        modes.append(_matched(omega, smooth, top, trough))
        level = level - np.log(np.abs(Resonances.of([modes[-1]]).factor(0, omega)))
    return modes, gain


def _trough(smooth: Real, top: int, before: int, after: int) -> int | None:
    """Return the line of the trough that belongs to a peak: above it, unless one below is far deeper."""
    above = top + 1 + int(np.argmin(smooth[top + 1 : after + 1])) if after > top + 1 else None
    if above is not None and 0 < above < smooth.size - 1:
        return above
    below = before + int(np.argmin(smooth[before:top])) if top > before + 1 else None
    return below if below is not None and below > 0 else None


def _matched(omega: Real, smooth: Real, top: int, trough: int | None) -> tuple[float, float, float, float]:
    """Return the resonance with this peak and trough, their height and depth matched."""
    omega_p = float(omega[top])
    if trough is None or trough == top:
        return omega_p, TYPICAL_DAMPING, TYPICAL_RATIO * omega_p, TYPICAL_DAMPING
    omega_z = float(omega[trough])
    height, depth = np.exp(smooth[top]), np.exp(smooth[trough])
    zeta_p = zeta_z = TYPICAL_DAMPING
    apart = 1 - (omega_p / omega_z) ** 2
    for _ in range(MATCHING_STEPS):
        zeta_p = float(np.hypot(apart, 2 * zeta_z * omega_p / omega_z) / (2 * height))
        zeta_p = min(max(zeta_p, LOWEST_DAMPING), HIGHEST_DAMPING)
        back = 1 - (omega_z / omega_p) ** 2
        zeta_z = float(depth * np.hypot(back, 2 * zeta_p * omega_z / omega_p) / 2)
        zeta_z = min(max(zeta_z, LOWEST_DAMPING), HIGHEST_DAMPING)
    return omega_p, zeta_p, omega_z, zeta_z


def _noise(level: Real) -> float:
    if level.size < SMOOTHED:
        return 0.0
    # The median size of normal noise is 0.6745 of its deviation; its second differences are sqrt(6) times as
    # large; a parabola through five lines leaves 17/35 of its variance.
    second = np.diff(level, 2)
    return float(np.median(np.abs(second)) / 0.6745 / np.sqrt(6) * np.sqrt(0.49))


def _smoothed(level: Real) -> Real:
    """Return parabolas through a few lines around each; those at the ends share the last one."""
    if level.size <= SMOOTHED:
        return level
    powers = np.vander(np.arange(SMOOTHED) - SMOOTHED // 2, 3)
    through, half = powers @ np.linalg.pinv(powers), SMOOTHED // 2
    inner = np.convolve(level, through[half], "valid")
    first, last = through[:half] @ level[:SMOOTHED], through[-half:] @ level[-SMOOTHED:]
    return np.asarray(np.concatenate((first, inner, last)), np.float64)


def _peaks(level: Real, least: float) -> list[int]:
    """Return the lines of peaks of at least this prominence, the most prominent first.

    >>> _peaks(np.array([0.0, 3.0, 1.0, 2.0, 1.5, 5.0, 0.0]), 0.4)
    [5, 1, 3]
    """
    # What a peak stands above on either side is the least level until one as high.
    values = level.tolist()
    bases = [_least_before(values), _least_before(values[::-1])[::-1]]
    changes = np.flatnonzero(np.diff(level))
    rises = np.diff(level)[changes] > 0
    turns = np.flatnonzero(rises[:-1] & ~rises[1:])
    tops = ((changes[turns] + 1 + changes[turns + 1]) // 2).tolist()
    found = [(values[k] - max(bases[0][k], bases[1][k]), k) for k in tops]
    return [k for height, k in sorted(found, key=lambda one: -one[0]) if height >= least]


def _least_before(values: list[float]) -> list[float]:
    """Return the least of the values before each one, back to one that is higher."""
    result, higher = [], list[tuple[float, float]]()  # values, and the least between each and the one before
    for value in values:
        least = value
        while higher and higher[-1][0] <= value:
            least = min(least, higher.pop()[1])
        result.append(least)
        higher.append((value, least))
    return result


def poles_from_vector_fitting(problem: FitProblem, order: int) -> list[Complex]:
    """Return so many poles by relaxed vector fitting, begun in three ways."""
    # One begins with poles spread over the band; one with the most conspicuous of two pairs more, which a
    # close pair or a delay may take up; one drops the powers of s, which hide modes outside the band.
    low, high = problem.band
    if not order:
        return [np.zeros(0, np.complex128)]
    relocations = [relocated(problem, spread(low, high, order))]
    generous = relocated(problem, spread(low, high, order + 2 * SPARE), GENEROUS)
    relocations.append(relocated(problem, _conspicuous(problem, generous, order)))
    if len(problem.slopes) > 1:
        relocations.append(relocated(problem, spread(low, high, order), powers=FEW_POWERS))
    return relocations


def poles_from_aaa(problem: FitProblem, count: int) -> list[Complex]:
    """Return the poles of an AAA approximant of the first response."""
    # Noise gives spurious poles: those in the band with the largest residue over real part are taken. Where
    # noise has drowned some, approximants of a higher degree are tried.
    line = problem.lines[0]
    low, high = problem.band
    for degree in (2 * count, 2 * count + SPARE, 3 * count + SPARE):
        poles = _aaa_poles(line.omega_seen, problem.quotient(0), degree)
        inside = [(size, pole) for size, pole in poles if low <= abs(pole) <= high]
        wanted = [(size, pole) for size, pole in inside if abs(pole.real) < 0.5 * abs(pole)]
        chosen = sorted(wanted, key=lambda item: -item[0])[:count]
        if len(chosen) == count:
            upper = np.array([complex(-max(abs(p.real), LOWEST_DAMPING * abs(p)), p.imag) for _, p in chosen])
            upper = upper[np.argsort(upper.imag)]
            return [upper, relocated(problem, upper)]
    return []


def generous_fit(
    problem: FitProblem, pairs: int, poles: Complex | None = None
) -> tuple[list[Complex], int, Complex]:
    """Return what a function without structure makes of the lines, its number of parameters, its poles."""
    is_given = poles is not None
    poles = spread(*problem.band, 2 * pairs) if poles is None else poles
    for _ in range(REPHASED if any(line.parts == 1 for line in problem.lines) else 1):
        poles = poles if is_given else relocated(problem, poles, GENEROUS)
        values = []
        for r, line in enumerate(problem.lines):
            basis, weight = _local(problem, line.omega_seen, poles), _weights(problem, r)
            solved = solved_real(weight[:, None] * basis, weight * problem.quotient(r))
            values.append(basis @ solved * (line.measured.values / problem.quotient(r)))
        problem = problem.rephased(values)
    return values, 2 * pairs + len(values) * (2 * pairs + len(_powers(problem))), poles


def _conspicuous(problem: FitProblem, poles: Complex, order: int) -> Complex:
    """Return the poles whose peaks stand out most against the response, so many in all."""
    size = np.zeros(poles.size)
    ends = np.cumsum(_widths(poles))
    for r, line in enumerate(problem.lines):
        weight = _weights(problem, r)
        basis = _local(problem, line.omega_seen, poles)
        solved = solved_real(weight[:, None] * basis, weight * problem.quotient(r))
        for i, (end, width) in enumerate(zip(ends, _widths(poles), strict=True)):
            share = np.abs(basis[:, end - width : end] @ solved[end - width : end]) * weight
            size[i] += float(np.sum(share**2))
    # A smooth rise is not a resonance, however large it is.
    size = size * np.minimum(1.0, LARGEST_START / (-poles.real / np.abs(poles)))
    chosen: list[int] = []
    remaining = order
    for i in np.argsort(-size, kind="stable").tolist():
        if _widths(poles)[i] <= remaining:
            chosen.append(i)
            remaining -= int(_widths(poles)[i])
    missing = [-np.exp(np.mean(np.log(problem.band)))] * remaining
    return np.append(poles[np.sort(chosen)], np.array(missing, np.complex128))


def _widths(poles: Complex) -> Whole:
    """Return how many columns each pole has: two for a pair, one for a real pole."""
    return np.where(poles.imag == 0, 1, 2)


def _powers(problem: FitProblem) -> tuple[int, ...]:
    """Return the powers of s beside the partial fractions."""
    return (0,) if len(problem.slopes) == 1 else FREE_POWERS


def _local(
    problem: FitProblem, omega: Values, poles: Complex, powers: tuple[int, ...] | None = None
) -> Complex:
    middle = np.exp(np.mean(np.log(problem.band)))
    x = 1j * omega[:, None] / middle
    return np.concatenate(
        (_basis(omega, poles), *(x ** float(p) for p in powers or _powers(problem))), axis=1
    )


def solved_real(matrix: Complex, target: Complex) -> Real:
    """Return the real solution of a complex system in the sense of least squares."""
    stacked, right = np.concatenate((matrix.real, matrix.imag)), np.concatenate((target.real, target.imag))
    norms = np.maximum(np.linalg.norm(stacked, axis=0), np.finfo(float).tiny)
    return np.asarray(np.linalg.lstsq(stacked / norms, right, rcond=None)[0] / norms, np.float64)


def spread(low: float, high: float, order: int) -> Complex:
    """Return so many poles spread over a band, as vector fitting wants to begin; one of them real if odd."""
    count = order // 2
    middle = (np.arange(count) + 0.5) / max(count, 1)
    omega = low * (high / low) ** middle if high > 30 * low else low + (high - low) * middle
    pairs = -FIRST_DAMPING * omega + 1j * omega
    return np.append(pairs, np.full(order % 2, -np.sqrt(low * high), np.complex128))


def _weights(problem: FitProblem, response: int) -> Real:
    line = problem.lines[response]
    size = np.abs(problem.quotient(response))
    return np.asarray(1 / (size if line.deviation is None else size * np.hypot(line.deviation, 0.01)))


def _basis(omega: Values, poles: Complex) -> Complex:
    """Return 1/(s - p) of real poles and of the pairs in real combinations, shape (k, order)."""
    s = 1j * omega[:, None]
    ends = np.cumsum(_widths(poles))
    basis = np.empty((omega.size, int(np.sum(_widths(poles)))), dtype=np.complex128)
    first, second = 1 / (s - poles), 1 / (s - np.conj(poles))
    is_pair = poles.imag != 0
    basis[:, ends[~is_pair] - 1] = first[:, ~is_pair]
    basis[:, ends[is_pair] - 2] = (first + second)[:, is_pair]
    basis[:, ends[is_pair] - 1] = (1j * (first - second))[:, is_pair]
    return basis


def _state_matrix(poles: Complex) -> tuple[Real, Real]:
    ends = np.cumsum(_widths(poles))
    size = int(np.sum(_widths(poles)))
    a, b = np.zeros((size, size)), np.zeros(size)
    for pole, end in zip(poles, ends, strict=True):
        if pole.imag == 0:
            a[end - 1, end - 1], b[end - 1] = pole.real, 1
        else:
            k = end - 2
            a[k : k + 2, k : k + 2] = [[pole.real, pole.imag], [-pole.imag, pole.real]]
            b[k] = 2
    return a, b


def relocated(
    problem: FitProblem, poles: Complex, iterations: int = ITERATIONS, powers: tuple[int, ...] | None = None
) -> Complex:
    """Return the poles after relaxed vector fitting: as many, and stable."""
    if not poles.size:
        return poles
    quotients = [problem.quotient(r) for r in range(len(problem.lines))]
    weights = [_weights(problem, r) for r in range(len(problem.lines))]
    total = sum(float(np.linalg.norm(w * np.abs(q))) ** 2 for w, q in zip(weights, quotients, strict=True))
    size = sum(line.omega.size for line in problem.lines)
    for _ in range(iterations):
        spend()
        rows, right, sums = [], [], []
        for line, weight, quotient in zip(problem.lines, weights, quotients, strict=True):
            local = _local(problem, line.omega_seen, poles, powers)
            basis = local[:, : int(np.sum(_widths(poles)))]
            shared = np.concatenate((basis, np.ones((line.omega.size, 1))), axis=1)
            sums.append(shared.real.sum(axis=0))
            block = weight[:, None] * np.concatenate((local, -quotient[:, None] * shared), axis=1)
            # Only what the shared part needs is kept of each response (Deschrijver et al. 2008).
            upper = triangle(np.concatenate((block.real, block.imag)))
            rows.append(upper[local.shape[1] :, local.shape[1] :])
            right.append(np.zeros(rows[-1].shape[0]))
        mean = np.sqrt(total) / size
        rows.append(mean * np.sum(sums, axis=0)[None, :])
        right.append(np.array([mean * size]))
        matrix, target = np.concatenate(rows), np.concatenate(right)
        norms = np.maximum(np.linalg.norm(matrix, axis=0), np.finfo(float).tiny)
        solution = np.linalg.lstsq(matrix / norms, target, rcond=None)[0] / norms
        a, b = _state_matrix(poles)
        direct = solution[-1] if abs(solution[-1]) > SETTLED else SETTLED
        eigenvalues = np.linalg.eigvals(a - np.outer(b, solution[:-1]) / direct)
        moved = _upper(np.asarray(eigenvalues, np.complex128), problem.band[0])
        if not np.isfinite(moved).all():
            break
        is_settled = moved.size == poles.size and np.max(np.abs(moved - poles) / np.abs(poles)) < UNMOVED
        poles = moved
        if is_settled:
            break
    return poles


def _upper(roots: Complex, least: float) -> Complex:
    """Return the stable poles on the real axis and above it that eigenvalues of a real matrix stand for."""
    # An integrator's pole next to 0 stays a number that one can divide by.
    scale = max(float(np.abs(roots).max()), least)
    is_real = np.abs(roots.imag) <= REAL * np.abs(roots)
    pairs = roots[~is_real & (roots.imag > 0)]
    damped = np.maximum(np.abs(pairs.real), LOWEST_DAMPING * np.abs(pairs))
    real = np.maximum(np.abs(roots[is_real].real), REAL * scale)
    poles = np.concatenate((-damped + 1j * pairs.imag, -real.astype(np.complex128)))
    return poles[np.argsort(np.abs(poles), kind="stable")]


def _aaa_poles(omega: Values, values: Complex, degree: int) -> list[tuple[float, complex]]:
    """Return poles of an AAA approximant of data at s = j omega and its mirror, each with its weight."""
    points = np.concatenate((1j * omega, np.conj(1j * omega)))
    data = np.concatenate((values, np.conj(values)))
    free = np.ones(points.size, dtype=bool)
    chosen: list[int] = []
    approximant = np.full(points.size, data.mean())
    weights = np.ones(1, dtype=np.complex128)
    while len(chosen) < degree + 1 and free.sum() > 2 * degree:
        # Points enter with their mirror images, so that poles come in pairs.
        worst = int(np.argmax(np.where(free, np.abs(data - approximant) / np.abs(data), -1)))
        for index in (worst, (worst + omega.size) % points.size):
            free[index] = False
            chosen.append(index)
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
    poles = []
    for pole in eig(left, right, right=False):
        if not np.isfinite(pole) or pole.imag <= 0:
            continue
        away = pole - support
        with np.errstate(all="ignore"):  # data that an approximant meets exactly leave poles on its points
            residue = np.sum(weights * at / away) / np.sum(-weights / away**2)
        if np.isfinite(residue):
            poles.append((float(abs(residue) / max(abs(pole.real), 1e-9 * abs(pole))), complex(pole)))
    return poles


def with_delays(problem: FitProblem, count: int | None) -> FitProblem:
    """Return the problem with the delay of each response to begin with, where they are free."""
    if not problem.free.delay:
        return problem
    delays = []
    for r in range(len(problem.lines)):
        single = replace(problem, lines=problem.lines[r : r + 1], delays=(0.0,)).without_window()
        delays.append(_delay(single, count or max(len(find_modes(single)), 1)))
    return replace(problem, delays=tuple(delays))


def _delay(single: FitProblem, count: int) -> float:
    line = single.lines[0]
    values, omega = line.ratio, line.omega
    turn = 2 * np.pi / float(omega[-1])
    # Resonances turn the phase near their peaks; on most lines the delay alone does.
    steps = -np.angle(values[1:] / values[:-1]) / np.diff(omega)
    likely = max(float(np.median(steps)), 0.0)
    most = min(max(3 * likely / turn, LEAST_TURNS), MOST_TURNS) * turn
    thin = single.thinned(MOST_LINES)
    tried = np.arange(0.0, most, turn / PER_TURN)
    costs = [_misfit(thin, float(delay), count) for delay in tried]
    best = float(tried[int(np.argmin(costs))])
    near = best + turn / PER_TURN * np.linspace(-1, 1, 7)
    near = near[near >= 0]
    return float(near[int(np.argmin([_misfit(thin, float(delay), count) for delay in near]))])


def _misfit(single: FitProblem, delay: float, count: int) -> float:
    problem = replace(single, delays=(delay,))
    (values,), *_ = generous_fit(problem, count)
    line = problem.lines[0]
    scale = 1.0 if line.deviation is None else line.deviation
    return float(np.mean(np.abs((values / line.measured.values - 1) / scale) ** 2))
