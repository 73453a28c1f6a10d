"""What is fitted: measured lines, their accuracy, and the known function the resonances are multiplied by."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from symflex.data.fitting.observation import Observation, observe

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from symflex.data.fitting.noise import Reference
    from symflex.data.fitting.resonances import Free, Resonances
    from symflex.data.measurement import MeasuredResponse

Real = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]

FEWEST_FOR_SLOPE = 5


@dataclass(frozen=True, eq=False)
class FittedLines:
    """One measured response as the fit sees it.

    Parameters
    ----------
    measured : MeasuredResponse
        The lines.
    observation : Observation
        How the lines follow from the response.
    base, base_at_lines : array of complex
        The known factor where the observation needs it, and on the lines.
    deviation : array of float, shape (n,), or None
        Standard deviation of each part over the magnitude; None when there is no coherence.
    """

    measured: MeasuredResponse
    observation: Observation
    base: Complex
    base_at_lines: Complex
    deviation: Real | None

    @property
    def omega(self) -> Real:
        """Angular frequencies of the lines [rad/s]."""
        return self.measured.omega

    @property
    def ratio(self) -> Complex:
        """Measured values over the base: what the resonances have to be."""
        return self.measured.values / self.base_at_lines


@dataclass(frozen=True, eq=False)
class FitProblem:
    """All responses of one fit.

    Parameters
    ----------
    lines : tuple of FittedLines
        One per response; they share their poles.
    free : Free
        What is found of each response besides its resonances.
    has_base : bool
        Whether the known factor is a model rather than a power of s; messages speak of it then.
    slopes : tuple of int
        The powers of s that each response may have.
    delays : tuple of float
        Dead time of each response that a start begins with [s].
    is_noise_estimated : bool
        Whether the accuracy of lines was estimated, and not known from coherence.
    reference : Reference, optional
        Of the estimate: how well a function without structure describes the lines.
    """

    lines: tuple[FittedLines, ...]
    free: Free
    has_base: bool = True
    slopes: tuple[int, ...] = (0,)
    delays: tuple[float, ...] = ()
    is_noise_estimated: bool = False
    reference: Reference | None = None
    count: int = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "count", sum(line.measured.values.size for line in self.lines))
        if not self.delays:
            object.__setattr__(self, "delays", (0.0,) * len(self.lines))

    @property
    def has_deviations(self) -> bool:
        """Whether the accuracy of every line is known from coherence, or estimated."""
        return all(line.deviation is not None for line in self.lines)

    @property
    def is_noise_known(self) -> bool:
        """Whether coherence and averages say how large the noise is."""
        return all(line.measured.coherence is not None and line.measured.averages for line in self.lines)

    @property
    def band(self) -> tuple[float, float]:
        """The lowest and the highest frequency measured [rad/s]."""
        return min(float(x.omega[0]) for x in self.lines), max(float(x.omega[-1]) for x in self.lines)

    def without_window(self) -> FitProblem:
        """Return the same problem with lines taken as the values themselves."""
        lines = tuple(
            replace(line, observation=Observation(line.omega), base=line.base_at_lines) for line in self.lines
        )
        return replace(self, lines=lines)

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
            lines.append(
                replace(
                    line,
                    base=line.base * inside ** float(slope) * np.exp(-inside * delay),
                    base_at_lines=line.base_at_lines * at_lines ** float(slope) * np.exp(-at_lines * delay),
                )
            )
        return replace(self, lines=tuple(lines), slopes=(0,), delays=())

    def values(self, resonances: Resonances, response: int) -> Complex:
        """Return what the model says on the lines of one response."""
        line = self.lines[response]
        return line.observation(line.base * resonances.factor(response, line.observation.omega))

    def linearised(self, resonances: Resonances, response: int) -> tuple[Complex, Complex]:
        """Return the model on the lines and its derivatives by the packed parameters."""
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

    Parameters
    ----------
    measured : sequence of MeasuredResponse
        At least one.
    bases : sequence of functions
        Of angular frequencies [rad/s], one per response.
    free : Free
        What is found of each response besides its resonances.
    has_base : bool
        Whether the known factor is a model rather than a power of s.
    slopes : tuple of int
        The powers of s that each response may have.
    """
    lines = []
    for response, base in zip(measured, bases, strict=True):
        observation = observe(response.frequency_hz, response.spacing_hz, response.window)
        at_lines = base(response.omega)
        everywhere = at_lines if observation.matrix is None else base(observation.omega)
        lines.append(FittedLines(response, observation, everywhere, at_lines, response.relative_deviation()))
    return FitProblem(tuple(lines), free, has_base, slopes)
