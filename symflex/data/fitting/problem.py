"""What is fitted: measured lines, their accuracy, and the known function the resonances are multiplied by.

Without coherence the noise is estimated from what a function without structure leaves of the lines. A
rational function with more poles than are looked for, and powers of s of its own, follows whatever a
laboratory measures; what it leaves is noise. Its variance is described by nonnegative shares of the
response's own power, as multiplicative errors and leakage have it, and of powers of the frequency, as sensors
that are integrated or differentiated have them. The shares are those of greatest likelihood for complex
Gaussian errors, found by multiplicative steps that never lower it (Fevotte & Idier, Neural Computation 23(9),
2011: the Itakura-Saito divergence).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from symflex.data.fitting.lines import telling_lines, written_step
from symflex.data.fitting.observation import Observation, observe
from symflex.data.fitting.resonances import Complex, Free, Real, Resonances, Values, Whole
from symflex.data.fitting.starts import generous_fit
from symflex.data.measurement import MeasuredResponse

FEWEST_FOR_SLOPE = 5
"""Lines from which a power of s is guessed."""
STEPS = 60
"""Multiplicative steps for the shares of the variance; none of them makes it worse."""
POWERS = (0, 2, 4, -2, -4)
"""Of the frequency, by which the variance of the noise is described."""
LEAST = 1e-9
"""Relative deviation below which no line is taken to be known: a thousandth of it is rounding on the way."""
EXACT = 3e-6
"""Relative deviation of six digits: no instrument has it."""
MOST_PAIRS = 14
"""Of poles of the function without structure, where the number of resonances is open."""
LINES_PER_PARAMETER = 2.0
"""Real values that each parameter of that function takes at least."""
PATIENCE = 2
"""Numbers of pairs tried after the best one."""
FEWEST = 5
"""Lines from which the noise is guessed at all."""
DECIBEL, DEGREE = np.log(10) / 20, np.pi / 180
LARGEST = 20.0
"""Power of an error, over what is expected of it, beyond which it counts as no more than this."""


@dataclass(frozen=True, eq=False)
class FittedLines:
    """One measured response as the fit sees it."""

    measured: MeasuredResponse  # the lines
    observation: Observation  # how the lines follow from the response
    # base and base_at_lines: the known factor where the observation needs it, and on the lines.
    base: Complex
    base_at_lines: Complex
    # shape (n,): Standard deviation of each part over the magnitude; None when there is no coherence.
    deviation: Real | None
    is_coherence_used: bool = True
    # All lines of the measurement, where this is a part of them.
    whole: FittedLines | None = None

    @property
    def omega(self) -> Real:
        """Angular frequencies of the lines [rad/s]."""
        return self.measured.omega

    @property
    def ratio(self) -> Complex:
        """Measured values over the base: what the resonances have to be."""
        return self.measured.values / self.base_at_lines

    @property
    def coherence(self) -> Real | None:
        """The coherence, if there is one that the scatter of lines does not contradict."""
        return self.measured.coherence if self.is_coherence_used else None

    @property
    def parts(self) -> int:
        """How many real numbers each line is: two, or a magnitude alone."""
        return 1 if self.measured.is_magnitude else 2

    def rest(self, model: Complex) -> Values:
        """Return how far values of a model are off, real where magnitudes alone were measured."""
        if self.measured.is_magnitude:
            return np.asarray(np.abs(model) - np.abs(self.measured.values), np.float64)
        return np.asarray(model - self.measured.values, np.complex128)

    @property
    def every(self) -> FittedLines:
        """All lines of the measurement."""
        return self.whole or self

    def deviation_of_every(self) -> Real:
        """Return the standard deviation of each part on all lines: what is left out has its neighbours'."""
        size = np.abs(self.measured.values)
        deviation = size if self.deviation is None else self.deviation * size
        return np.interp(self.every.omega, self.omega, deviation)

    def at(self, places: Whole) -> FittedLines:
        """Return some of the lines."""
        observation = self.observation.at(places)
        return replace(
            self,
            measured=self.measured.taken(places),
            observation=observation,
            base=self.base if observation.matrix is not None else self.base[places],
            base_at_lines=self.base_at_lines[places],
            deviation=None if self.deviation is None else self.deviation[places],
            whole=self.every,
        )


@dataclass(frozen=True, eq=False)
class FitProblem:
    """All responses of one fit."""

    lines: tuple[FittedLines, ...]  # one per response; they share their poles
    free: Free  # what is found of each response besides its resonances
    # Whether the known factor is a model rather than a power of s; messages speak of it then.
    has_base: bool = True
    slopes: tuple[int, ...] = (0,)  # the powers of s that each response may have
    delays: tuple[float, ...] = ()  # dead time of each response that a start begins with [s]
    # Whether the accuracy of lines was estimated, and not known from coherence.
    is_noise_estimated: bool = False
    # Of the estimate: how well a function without structure describes the lines.
    reference: StructurelessFit | None = None
    count: int = field(init=False)  # lines
    size: int = field(init=False)  # real numbers that they are

    def __post_init__(self) -> None:
        object.__setattr__(self, "count", sum(line.omega.size for line in self.lines))
        object.__setattr__(self, "size", sum(line.parts * line.omega.size for line in self.lines))
        if not self.delays:
            object.__setattr__(self, "delays", (0.0,) * len(self.lines))

    @property
    def has_deviations(self) -> bool:
        """Whether the accuracy of every line is known from coherence, or estimated."""
        return all(line.deviation is not None for line in self.lines)

    @property
    def is_noise_known(self) -> bool:
        """Whether coherence and averages say how large the noise is."""
        return all(line.coherence is not None and line.measured.averages for line in self.lines)

    @property
    def has_scale(self) -> bool:
        """Whether the noise is known or estimated, and not only how it differs from line to line."""
        return self.is_noise_known or self.is_noise_estimated

    @property
    def is_exact(self) -> bool:
        """Whether the lines were computed: their errors are those of numbers of six digits or more."""
        deviations = [line.deviation for line in self.lines if line.deviation is not None]
        return self.is_noise_estimated and bool(np.median(np.concatenate(deviations)) < EXACT)

    @property
    def band(self) -> tuple[float, float]:
        """The lowest and the highest frequency measured [rad/s]."""
        return min(float(x.omega[0]) for x in self.lines), max(float(x.omega[-1]) for x in self.lines)

    def rephased(self, values: Sequence[Complex]) -> FitProblem:
        """Return the problem whose magnitudes without a phase have that of these values."""
        lines = list(self.lines)
        for r, line in enumerate(lines):
            if line.parts == 1:
                turned = np.abs(line.measured.values) * np.exp(1j * np.angle(values[r]))
                lines[r] = replace(line, measured=replace(line.measured, values=turned), whole=line.every)
        return replace(self, lines=tuple(lines))

    def at(self, places: Sequence[Whole]) -> FitProblem:
        """Return the problem with some of the lines of each response."""
        lines = tuple(line.at(chosen) for line, chosen in zip(self.lines, places, strict=True))
        return replace(self, lines=lines)

    def readmitted(self, places: Sequence[Whole]) -> FitProblem:
        """Return the problem with these lines of all that were measured; itself if they are the same."""
        lines = []
        for line, chosen in zip(self.lines, places, strict=True):
            every = line.every
            if every.deviation is None and line.deviation is not None:
                relative = line.deviation_of_every() / np.abs(every.measured.values)
                every = replace(every, deviation=relative, whole=every)
            lines.append(line if np.array_equal(every.omega[chosen], line.omega) else every.at(chosen))
        if all(a is b for a, b in zip(lines, self.lines, strict=True)):
            return self
        return replace(self, lines=tuple(lines))

    def thinned(self, most: int) -> FitProblem:
        """Return the problem without window, with at most so many telling lines of each response."""
        if all(line.omega.size <= most for line in self.lines):
            return self.without_window()
        places = []
        for line in self.lines:
            deviation = np.zeros(line.omega.size) if line.deviation is None else line.deviation
            places.append(telling_lines(line.omega, line.ratio, deviation, most))
        return self.without_window().at(places)

    def without_window(self) -> FitProblem:
        """Return the same problem with lines taken as the values themselves."""
        plain = [(line, Observation(line.omega), line.base_at_lines) for line in self.lines]
        return replace(self, lines=tuple(replace(x, observation=o, base=base) for x, o, base in plain))

    def quotient(self, response: int) -> Complex:
        """Return measured values over the base, the dead time to begin with, and s to a known power."""
        line = self.lines[response]
        slope = self.slopes[0] if len(self.slopes) == 1 else 0
        s = 1j * line.omega
        return np.asarray(line.ratio * np.exp(s * self.delays[response]) / s ** float(slope), np.complex128)

    def guessed_slope(self) -> int:
        """Return the power of s that the lowest tenth of the lines of the first response suggests."""
        measured = self.lines[0].measured
        size = max(FEWEST_FOR_SLOPE, measured.values.size // 10)
        x, y = np.log(measured.frequency_hz[:size]), np.log(np.abs(self.lines[0].ratio[:size]))
        return round(float(np.polyfit(x, y, 1)[0]))

    def with_slope(self, slope: int) -> FitProblem:
        """Return the problem on a base that has this power of s already, and the dead times to begin with."""
        lines = []
        for line, delay in zip(self.lines, self.delays, strict=True):
            inside, at_lines = 1j * line.observation.omega, 1j * line.omega
            base = line.base * inside ** float(slope) * np.exp(-inside * delay)
            at_lines = line.base_at_lines * at_lines ** float(slope) * np.exp(-at_lines * delay)
            lines.append(replace(line, base=base, base_at_lines=at_lines))
        return replace(self, lines=tuple(lines), slopes=(0,), delays=())

    def values(self, resonances: Resonances, response: int) -> Complex:
        """Return what the model says on the lines of one response."""
        line = self.lines[response]
        return line.observation(line.base * resonances.factor(response, line.observation.omega))

    def linearised(self, resonances: Resonances, response: int) -> tuple[Complex, Complex]:
        """Return the model on the lines and its derivatives by the parameters it depends on."""
        line = self.lines[response]
        omega = line.observation.omega
        inside = line.base * resonances.factor(response, omega)
        slopes = resonances.log_derivatives(response, omega, self.free)
        return line.observation(inside), line.observation(inside[:, None] * slopes)


def fit_problem(
    measured: Sequence[MeasuredResponse],
    bases: Sequence[Callable[[Real], Complex]],
    free: Free,
    *,
    has_base: bool = True,
    slopes: tuple[int, ...] = (0,),
) -> FitProblem:
    """Return the problem of fitting resonances to responses, given the known factor of each.

    Known factors are functions of angular frequencies [rad/s], a model's or powers of s; ``slopes`` are the
    powers of s that each response may have.
    """
    lines = []
    for response, base in zip(measured, bases, strict=True):
        observation = observe(response.frequency_hz, response.spacing_hz, response.window)
        at_lines = base(response.omega)
        everywhere = at_lines if observation.matrix is None else base(observation.omega)
        lines.append(FittedLines(response, observation, everywhere, at_lines, response.relative_deviation()))
    return FitProblem(tuple(lines), free, has_base, slopes)


@dataclass(frozen=True, slots=True)
class StructurelessFit:
    """How well a function without structure describes the lines: its sum of squares and its parameters."""

    cost: float
    parameters: int


def with_rough_noise(problem: FitProblem) -> FitProblem:
    """Return the problem with deviations guessed from how lines differ from their neighbours' line.

    Curvature of peaks is taken for noise too, so that these only weigh less than they might; lines that noise
    drowns no longer weigh as if they were exact.
    """
    lines = []
    for line in problem.lines:
        if line.deviation is not None or line.omega.size < FEWEST:
            lines.append(line)
            continue
        x, y = line.omega, line.measured.values
        share = (x[1:-1] - x[:-2]) / (x[2:] - x[:-2])
        between = y[1:-1] - (1 - share) * y[:-2] - share * y[2:]
        power = np.abs(between) ** 2 / (2 * (1 + share**2 + (1 - share) ** 2))
        size = np.abs(y)
        variance = _variance(np.pad(power, 1, mode="edge"), x, size)
        lines.append(replace(line, deviation=np.maximum(np.sqrt(variance) / size, LEAST)))
    return replace(problem, lines=tuple(lines))


def with_noise(problem: FitProblem, count: int | None, most_lines: int) -> FitProblem:
    """Return the problem with deviations estimated for the lines that have no coherence.

    So far they are rough. ``count`` resonances are looked for, None when that is open. The poles of the
    function without structure are found on ``most_lines`` lines of each response, and its values on all.
    """
    if all(line.coherence is not None and line.parts > 1 for line in problem.lines):
        return problem
    thin = problem.thinned(most_lines)
    size = thin.size
    best: tuple[float, int, Complex] | None = None
    worse = 0
    for pairs in range(1 if count is None else count, MOST_PAIRS if count is None else count + 4):
        values, parameters, poles = generous_fit(thin, pairs)
        if parameters * LINES_PER_PARAMETER > size and best is not None:
            break
        rest = 0.0
        for v, line in zip(values, thin.lines, strict=True):
            scale = 1.0 if line.deviation is None else line.deviation
            rest += float(np.sum(np.abs(line.rest(v) / np.abs(line.measured.values) / scale) ** 2))
        score = size * np.log(max(rest, LEAST**2 * size)) + parameters * np.log(size)
        if best is None or score < best[0]:
            best, worse = (float(score), pairs, poles), 0
        else:
            worse += 1
        if worse > PATIENCE:
            break
    if best is None:
        return problem
    values, parameters, _ = generous_fit(problem, best[1], best[2])
    return estimated(problem.rephased(values), values, parameters)


def estimated(problem: FitProblem, values: list[Complex], parameters: int) -> FitProblem:
    """Return the problem with deviations of what these values leave, and how well they describe the lines."""
    freedom = max(1 - parameters / problem.size, 0.2)
    lines, cost = [], 0.0
    for model, line in zip(values, problem.lines, strict=True):
        deviation = line.deviation
        if deviation is None or line.coherence is None:
            power = np.abs(line.rest(model)) ** 2 / line.parts
            variance = _variance(power, line.omega, np.abs(model), rounding(line, model)) / freedom
            size = np.abs(line.measured.values)
            deviation = np.maximum(np.sqrt(variance) / size, LEAST)
        lines.append(replace(line, deviation=deviation))
        rest = np.abs(line.rest(model)) / (deviation * np.abs(line.measured.values))
        cost += float(np.sum(rest**2))
    return replace(
        problem, lines=tuple(lines), is_noise_estimated=True, reference=StructurelessFit(cost, parameters)
    )


def rounding(line: FittedLines, model: Complex) -> Real:
    """Return the variance of each part that rounded frequencies, and rounded values, have at most.

    Frequencies may be rounded in Hz or in rad/s, values in any of the ways in which files write them.
    """
    omega, values = line.omega, line.measured.values
    size, turn = np.abs(values), np.angle(values)
    written = (
        (1.0, values.real), (1.0, values.imag), (1.0, size), (size * DECIBEL, np.log(size) / DECIBEL),
        (size, turn), (size * DEGREE, turn / DEGREE),
    )  # fmt: skip
    rows = [np.sum([(scale * written_step(numbers)) ** 2 for scale, numbers in written], axis=0)]
    if line.every.measured.spacing_hz is None:
        steps = np.hypot(written_step(omega), 2 * np.pi * written_step(omega / (2 * np.pi)))
        rows.append(np.abs(np.gradient(model, omega) * steps) ** 2)
    return np.stack([row for row in rows if row.any()] or [np.zeros(0)]) / 24  # of two parts, a twelfth


def _variance(power: Real, omega: Real, size: Real, known: Real | None = None) -> Real:
    """Return the smooth expectation of the power of each part on every line.

    Each row of ``known`` is a part of it, of which at most the whole is there.
    """
    x = omega / np.exp(np.mean(np.log(omega)))
    unit = float(np.mean(size**2))  # whose square may be no number
    power = power / unit
    shapes = np.stack([size**2 / unit, *(x ** float(p) for p in POWERS)])
    shapes = shapes / np.mean(shapes, axis=1, keepdims=True)
    most = np.full(shapes.shape[0], np.inf)
    if known is not None and known.size:
        shapes, most = np.concatenate((shapes, known / unit)), np.append(most, np.ones(known.shape[0]))
    # The square of a variance has to be a number, of exact data too.
    floor = max(float(np.mean(power)) * 1e-12, np.finfo(float).tiny ** 0.4)
    power = np.maximum(power, floor)
    shares = np.full(shapes.shape[0], float(np.mean(power)) / shapes.shape[0])
    for _ in range(STEPS):
        expected = shares @ shapes
        # Gaussian errors reach this once in a billion lines; what is larger is no noise.
        bounded = np.minimum(power, LARGEST * expected)
        shares = shares * np.sqrt((shapes @ (bounded / expected**2)) / (shapes @ (1 / expected)))
        shares = np.minimum(shares, most)
    return np.asarray(unit * (shares @ shapes), np.float64)
