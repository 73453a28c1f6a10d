"""What is fitted: measured lines, and the known function the resonances are multiplied by."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from symflex.data.fitting.lines import telling_lines
from symflex.data.fitting.observation import FittedLines, Observation, observe
from symflex.data.fitting.resonances import Complex, Free, Resonances, Values, Whole
from symflex.data.measurement import MeasuredResponse

FEWEST_FOR_SLOPE = 5  # lines from which a power of s is guessed
EXACT = 3e-6  # relative deviation of six digits: no instrument has it


@dataclass(frozen=True, eq=False)
class FitProblem:
    """All responses of one fit."""

    lines: tuple[FittedLines, ...]  # one per response; they share their poles
    free: Free  # what is found of each response besides its resonances
    # Whether the known factor is a model rather than a power of s; messages speak of it then.
    has_base: bool = True
    slopes: tuple[int, ...] = (0,)  # the powers of s that each response may have
    delays: tuple[float, ...] = ()  # delay of each response that a start begins with [s]
    # Whether the accuracy of lines was estimated, and not known from coherence.
    is_noise_estimated: bool = False
    # The band that records in time show [rad/s], where these were fitted, and the lines are to look at.
    reach: tuple[float, float] | None = None
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
        if self.reach is not None:
            return self.reach
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
        plain = [(line, Observation(line.omega_seen), line.base_at_lines) for line in self.lines]
        return replace(self, lines=tuple(replace(x, observation=o, base=base) for x, o, base in plain))

    def quotient(self, response: int) -> Complex:
        """Return measured values over the base, the delay to begin with, and s to a known power."""
        line = self.lines[response]
        slope = self.slopes[0] if len(self.slopes) == 1 else 0
        s = 1j * line.omega_seen
        return np.asarray(line.ratio * np.exp(s * self.delays[response]) / s ** float(slope), np.complex128)

    def guessed_slope(self) -> int:
        """Return the power of s that the lowest tenth of the lines of the first response suggests."""
        measured = self.lines[0].measured
        size = max(FEWEST_FOR_SLOPE, measured.values.size // 10)
        x, y = np.log(measured.frequency_hz[:size]), np.log(np.abs(self.lines[0].ratio[:size]))
        return round(float(np.polyfit(x, y, 1)[0]))

    def with_slope(self, slope: int) -> FitProblem:
        """Return the problem on a base that has this power of s already, and the delays to begin with."""
        lines = []
        for line, delay in zip(self.lines, self.delays, strict=True):
            inside, at_lines = 1j * line.observation.omega, 1j * line.omega_seen
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
    bases: Sequence[Callable[[Values], Complex]],
    free: Free,
    *,
    has_base: bool = True,
    slopes: tuple[int, ...] = (0,),
) -> FitProblem:
    """Return the problem of fitting resonances to responses, given the known factor of each [rad/s]."""
    lines = []
    for response, base in zip(measured, bases, strict=True):
        observation = observe(response)
        at_lines = base(response.omega_seen)
        everywhere = at_lines if observation.matrix is None else base(observation.omega)
        lines.append(FittedLines(response, observation, everywhere, at_lines, response.relative_deviation()))
    return FitProblem(tuple(lines), free, has_base, slopes)


@dataclass(frozen=True, slots=True)
class StructurelessFit:
    """How well a function without structure describes the lines: its sum of squares and its parameters."""

    cost: float
    parameters: int
