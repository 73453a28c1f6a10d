"""What is fitted: measured lines, their accuracy, and the known function the resonances are multiplied by."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from symflex.fitting.observation import Observation, observe

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from symflex.fitting.resonances import Free, Resonances
    from symflex.measurement import MeasuredResponse

Real = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]


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
    """

    lines: tuple[FittedLines, ...]
    free: Free
    has_base: bool = True
    count: int = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "count", sum(line.measured.values.size for line in self.lines))

    @property
    def has_deviations(self) -> bool:
        """Whether the accuracy of every line is known from coherence."""
        return all(line.deviation is not None for line in self.lines)

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
    """
    lines = []
    for response, base in zip(measured, bases, strict=True):
        observation = observe(response.frequency_hz, response.spacing_hz, response.window)
        at_lines = base(response.omega)
        everywhere = at_lines if observation.matrix is None else base(observation.omega)
        lines.append(FittedLines(response, observation, everywhere, at_lines, response.relative_deviation()))
    return FitProblem(tuple(lines), free, has_base)
