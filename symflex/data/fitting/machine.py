"""A machine of a specification as a fit of its parameters sees it: functions, parameters, priors.

Input: transfer functions with their derivatives in the free parameters, and what the specification says of
these: values to begin with, signs, spreads. Output: a :class:`Machine`.

Positive parameters are searched for by their logarithms, so that no bound is ever reached. A spread counts as
a measurement: 95 % of a normal distribution lie within it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from symflex.budget import spend
from symflex.data.fitting.identifiable import Coefficients, Identifiability
from symflex.data.fitting.resonances import Complex, Real, Values
from symflex.errors import no_such, refused
from symflex.model import ModelParameter
from symflex.model.settings import check_free

Gradient = Callable[[Complex, Mapping[str, complex]], tuple[Complex, Complex]]

OF_SPREAD: Final = 1.959964  # standard deviations of a normal distribution within which so many lie
EDGE = 25.0  # ln p, or parameters over their scale, stay within this of their start


@dataclass(frozen=True, eq=False)
class MachineFunction:
    """A transfer function of a specification, as a fit of its parameters needs it."""

    name: str  # ``OUT/IN``
    unit: str  # of its values, empty when unknown
    gradient: Gradient  # of complex s and the values of parameters: values, and derivatives in the free ones
    coefficients: Coefficients | None = None  # of a quotient of polynomials in s and the free parameters


@dataclass(frozen=True, eq=False)
class Derived:
    """A definition that depends on free parameters."""

    name: str
    unit: str
    # Maps the values of all parameters to its value and its derivatives in the free ones.
    gradient: Callable[[Mapping[str, complex]], tuple[float, Real]]


@dataclass(frozen=True, eq=False)
class Machine:
    """What is fitted: functions, one for each response, and their parameters."""

    path: str  # the specification
    functions: tuple[MachineFunction, ...]
    parameters: tuple[ModelParameter, ...]  # the free ones
    values: Mapping[str, complex]  # of all parameters, as declared; the imaginary unit among them
    identifiability: Identifiability
    definitions: tuple[Derived, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the free parameters."""
        return tuple(p.name for p in self.parameters)

    @property
    def is_logarithmic(self) -> npt.NDArray[np.bool_]:
        """Which parameters are searched for by their logarithms."""
        return np.array([p.assume == "positive" for p in self.parameters])

    @property
    def start(self) -> Real:
        """The declared values of the free parameters."""
        return np.array([float(self.values[name].real) for name in self.names])

    @property
    def priors(self) -> Real:
        """Standard deviation that the spread of each free parameter stands for; infinite without one."""
        return np.array([_prior(p) for p in self.parameters])

    @property
    def _scale(self) -> Real:
        return np.where(self.start == 0, 1.0, np.abs(self.start))

    def theta(self, x: Real) -> Real:
        """Return the parameters at a point of the search, which begins at zero."""
        with np.errstate(over="ignore"):
            moved = self._scale * np.exp(np.where(self.is_logarithmic, x, 0.0))
        return np.where(self.is_logarithmic, moved, self.start + self._scale * x)

    def point(self, theta: Real) -> Real:
        """Return the point of the search where parameters have some values."""
        with np.errstate(all="ignore"):
            logarithm = np.log(theta / self._scale)
        return np.where(self.is_logarithmic, logarithm, (theta - self.start) / self._scale)

    def scales(self, theta: Real) -> Real:
        """Return the derivatives of the parameters by the point of the search."""
        return np.where(self.is_logarithmic, theta, self._scale)

    @property
    def limits(self) -> tuple[Real, Real]:
        """The lowest and the highest point of the search."""
        low, high = np.full(len(self.names), -EDGE), np.full(len(self.names), EDGE)
        is_bounded = np.array([p.assume == "nonnegative" for p in self.parameters])
        low[is_bounded] = -self.start[is_bounded] / self._scale[is_bounded]
        return low, high

    def at(self, response: int, omega: Values, theta: Real) -> tuple[Complex, Complex]:
        """Return a function at angular frequencies, and its derivatives by the parameters, shape (n, p)."""
        spend()
        given = {**self.values, **dict(zip(self.names, theta.tolist(), strict=True))}
        return self.functions[response].gradient(np.asarray(1j * omega, np.complex128), given)


def _prior(parameter: ModelParameter) -> float:
    spread = parameter.spread
    if spread is None or parameter.value is None:
        return np.inf
    if hasattr(spread, "nearly"):
        return float(spread.nearly) / OF_SPREAD or np.inf
    return abs(float(parameter.value.nearly)) * float(spread) / OF_SPREAD or np.inf


def refuse_free(names: Sequence[str], known: Mapping[str, ModelParameter], defined: Sequence[str]) -> None:
    """Refuse names that are no parameters or come twice, SF902, and values used at rest, SF801."""
    if not names:
        raise refused("--model needs --free, the parameters to fit", f"parameters: {', '.join(known)}")
    for name in names:
        if name in defined:
            raise refused(
                f"'{name}' is a definition, not a parameter", "free the parameters that it depends on"
            )
        if name not in known:
            raise no_such("parameter", name, known)
        check_free(known[name])
        if names.count(name) > 1:
            raise refused(f"'{name}' is given twice in --free")
