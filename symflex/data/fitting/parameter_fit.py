"""Fitted parameters of a machine, and what is said of them: errors, correlations, doubts.

Output of :func:`symflex.data.fitting.parameters.fit_parameters`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.special import stdtrit

from symflex.data.fitting.fit import LARGE, SMOOTH, ResonanceFit, said_of_units
from symflex.data.fitting.machine import Derived, Machine
from symflex.data.fitting.order import UNLIKELY
from symflex.data.fitting.resonances import Real
from symflex.errors import counted

INTERVAL: Final = 0.95  # share of cases in which an interval holds the value
LOST = 1e3  # ratio of standard error to value above which no value is printed
STRONG = 0.95  # correlation that is named
WEAK = 0.5  # relative standard error from which a parameter is hardly determined by the data
CONTRADICTED = 3.3  # standard deviations off what a spread says that noise exceeds once in a thousand cases
UNMOVED = 1e-6  # share of a definition's slope along an undetermined direction below which it does not move


@dataclass(frozen=True, eq=False)
class ParameterFit:
    """Fitted parameters of a machine, and everything that is reported of them."""

    machine: Machine
    residual: ResonanceFit  # no resonances, on bases that are the fitted functions
    theta: Real  # the parameters
    covariance: Real  # of them, without what no data determine
    # The directions that no data determine, in parameters over their scales, a row each; a row of these.
    directions: Real
    freedom: int  # numbers measured less numbers determined
    twins: tuple[Real, ...]  # other values with the same function, or ones that fit as well
    are_exact_twins: bool  # whether these have the same function
    starts: tuple[int, int]  # how many led to this minimum, and how many were tried
    warnings: tuple[str, ...] = ()
    poor: tuple[str, ...] = ()
    in_time: tuple[
        str, ...
    ] = ()  # how each response was fitted to its records, in words; empty if it was not

    def __repr__(self) -> str:
        return f"<ParameterFit: {', '.join(self.machine.names)} of {self.machine.path}>"

    @property
    def values(self) -> dict[str, float]:
        """The values by name, in the unit of SI."""
        return dict(zip(self.machine.names, self.theta.tolist(), strict=True))

    @property
    def errors(self) -> Real:
        """Standard errors; infinite for parameters that no data of this kind, or not these, determine."""
        mixed = self.machine.identifiability.mixed
        found = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        # A variance that is not positive is rounding: nothing was measured of the parameter.
        is_lost = ~(np.isfinite(found) & (found > 0)) | (found > LOST * np.abs(self.theta))
        is_lost &= self.theta != 0
        return np.where([name in mixed for name in self.machine.names] | is_lost, np.inf, found)

    @property
    def correlations(self) -> Real:
        """Correlations of the errors, shape (p, p); 0 for what is not determined."""
        size = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        inverse = np.where((size > 0) & np.isfinite(size), 1 / np.where(size > 0, size, 1.0), 0.0)
        shares = np.nan_to_num(self.covariance * np.outer(inverse, inverse))
        return np.asarray(np.clip(shares, -1.0, 1.0), np.float64)

    def interval(self, value: float, error: float, *, is_positive: bool) -> tuple[float, float]:
        """Return the interval of a value that holds the true one in 95 % of cases."""
        reach = float(stdtrit(max(self.freedom, 1), (1 + INTERVAL) / 2))
        if is_positive and value:
            factor = np.exp(min(reach * error / abs(value), 700.0))
            low, high = sorted((value / factor, value * factor))
            return float(low), float(high)
        return value - reach * error, value + reach * error

    def intervals(self) -> list[tuple[float, float]]:
        """Return the interval of each parameter."""
        rows = zip(self.theta.tolist(), self.errors.tolist(), self.machine.is_logarithmic, strict=True)
        found = [self.interval(value, error, is_positive=bool(log)) for value, error, log in rows]
        is_bounded = [p.assume != "real" for p in self.machine.parameters]
        return [
            (max(low, 0.0), high) if b else (low, high)
            for b, (low, high) in zip(is_bounded, found, strict=True)
        ]

    def combinations(self) -> Iterator[tuple[str, float, float]]:
        """Yield what is determined of parameters that are not: expression, value and standard error."""
        known = self.machine.identifiability
        relative = np.asarray(self.covariance / np.outer(self.theta, self.theta), np.float64)
        for exponents in known.combinations:
            powers = np.array(exponents, float)
            value = float(np.prod(self.theta**powers))
            variance = max(float(np.dot(powers @ relative, powers)), 0.0)
            yield known.text(exponents), value, abs(value) * float(np.sqrt(variance))
        for one in known.expressions:
            coefficients = self.machine.functions[one.function].coefficients
            assert coefficients is not None  # of which the expression is a quotient
            values, slopes = coefficients.at(self.theta)
            value = float(values[one.above] / values[one.below])
            row = value * (slopes[one.above] / values[one.above] - slopes[one.below] / values[one.below])
            yield one.text, value, float(np.sqrt(max(float(row @ self.covariance @ row), 0.0)))

    def definitions(self) -> Iterator[tuple[Derived, float, float]]:
        """Yield definitions that depend on free parameters: value and standard error."""
        given: dict[str, complex] = {**self.machine.values, **self.values}
        for one in self.machine.definitions:
            value, slopes = one.gradient(given)
            scaled = slopes * self.directions[-1]
            lost = np.abs(self.directions[:-1] @ scaled)
            is_lost = np.max(lost, initial=0.0) > UNMOVED * np.linalg.norm(scaled)
            error = np.inf if is_lost else float(np.sqrt(max(float(slopes @ self.covariance @ slopes), 0.0)))
            yield one, value, error

    def strong_correlations(self) -> list[tuple[str, str, float]]:
        """Return pairs of determined parameters whose errors hang together, the closest first."""
        names, table, errors = self.machine.names, self.correlations, self.errors
        alone = [n for n, e in zip(names, errors, strict=True) if np.isfinite(e)]
        alone = [n for n in alone if n in self.machine.identifiability.alone]
        pairs = [
            (names[i], names[j], float(table[i, j]))
            for i in range(len(names))
            for j in range(i)
            if abs(table[i, j]) > STRONG and names[i] in alone and names[j] in alone
        ]
        return sorted(pairs, key=lambda pair: -abs(pair[2]))


def poor_for(fit: ParameterFit, likelihood: float) -> tuple[str, ...]:
    """Return why the specification does not describe the data."""
    shown, reasons = fit.residual, []
    problem, refined = shown.problem, shown.refined
    if problem.is_noise_known and refined.reduced > LARGE:
        reasons.append(f"the residual is {np.sqrt(refined.reduced):.2g} times what the coherence predicts")
    elif likelihood < UNLIKELY and not shown.leaves_rounding:
        reasons.append("a function with more poles describes the data far better than noise explains")
    if refined.correlation > SMOOTH and not shown.leaves_rounding:
        reasons.append("neighbouring lines deviate together: the specification lacks something")
    return (*reasons, *contradicted(fit))


def contradicted(fit: ParameterFit) -> list[str]:
    """Return which spreads the data contradict."""
    reasons = []
    for p, value, prior in zip(fit.machine.parameters, fit.theta, fit.machine.priors, strict=True):
        off = abs(value - fit.machine.values[p.name]) / prior
        if off > CONTRADICTED:
            reasons.append(f"{p.name} is {off:.2g} standard deviations from what its spread says")
    return reasons


def warnings_of(fit: ParameterFit) -> tuple[str, ...]:
    """Return what to be careful about."""
    low, high = (end / (2 * np.pi) for end in fit.residual.problem.band)
    said = said_of_units(fit.residual, "specification")
    for r in range(len(fit.residual.measured)):
        excluded = fit.residual.left_out(r)
        if excluded.size and not fit.in_time:
            places = ", ".join(f"{f:.6g}" for f in fit.residual.measured[r].frequency_hz[excluded][:6])
            said.append(
                f"{counted(excluded.size, 'outlier')}{fit.residual.of_response(r)} left out, at {places} Hz"
            )
    for p, value, error in zip(fit.machine.parameters, fit.theta, fit.errors, strict=True):
        if value and np.isfinite(error) and error > WEAK * abs(value):
            reach = f"{error / abs(value):.2g} times its value"
            said.append(
                f"{p.name} is not determined: its standard error is {reach}; from {low:.4g} to {high:.4g} Hz "
                "the response hardly depends on it"
            )
        if not np.isfinite(error) and p.name in fit.machine.identifiability.alone:
            where = f"from {low:.4g} to {high:.4g} Hz"
            said.append(f"{p.name} is not determined: with these values nothing depends on it {where}")
        if p.assume == "nonnegative" and value == 0:
            said.append(f"{p.name} is zero, its bound: its error says how large it may be")
    for a, b, share in fit.strong_correlations():
        digits = max(3, 1 - int(np.floor(np.log10(max(1 - abs(share), 1e-9)))))
        said.append(f"the errors of {a} and {b} hang together: their correlation is {share:.{digits}f}")
    return tuple(said)
