"""Mass-normalised mode shapes from responses to one force, one of them measured where it acts.

Of a structure with real modes, receptances are ``sum_r phi_jr phi_kr/(s^2 + 2 zeta_r omega_r s + omega_r^2)``
with modes that make the modal masses one, and two terms for modes below and above the band (Ewins 2000,
sections 2.4 and 4.3). The poles are those of a fit to the driven point, where they show best. With them every
response is linear in its residues, which are found by weighted least squares. A residue times
``p - conj(p)`` is the modal constant ``phi_jr phi_kr``; at the driven point it is ``phi_kr^2``.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from symflex.errors import DataError, Diagnostic, FitError, Source, Span, Text, UsageError
from symflex.fitting.observation import observe
from symflex.quantities import parse_unit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.fitting.fit import Fit
    from symflex.measurement import MeasuredResponse

Real = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]

STEP = 1e-6
"""Of the logarithms by which derivatives are taken."""

KINDS = {
    (Fraction(-1), Fraction(0)): "kg^(-1/2)",
    (Fraction(-1), Fraction(-2)): "kg^(-1/2)*m^(-1)",
}
"""Units of mode shapes by the exponents of kg and m in a motion over a force, and over a torque."""

RIGHT_ANGLE = 90.0

MOST_TURNED = 45.0
"""Degrees off the real axis from which a modal constant at the driven point is none."""


@dataclass(frozen=True, eq=False)
class FittedModeShapes:
    """Mass-normalised mode shapes where responses were measured.

    Parameters
    ----------
    names : tuple of str
        The responses.
    driving : int
        Which of them is at the driven point.
    shapes : array of float, shape (m, n)
        Of m responses in n modes; at the driven point positive.
    errors : array of float, shape (m, n)
        Standard errors.
    turned : array of float, shape (m, n)
        How far modal constants are off the real axis [deg]: 0 for real modes.
    unit : str
        ``kg^(-1/2)``, or with an inertia.
    """

    names: tuple[str, ...]
    driving: int
    shapes: Real
    errors: Real
    turned: Real
    unit: str


def mode_shapes(fit: Fit, measured: Sequence[MeasuredResponse]) -> FittedModeShapes:
    """Return mass-normalised mode shapes where responses were measured.

    Parameters
    ----------
    fit : Fit
        Of the response at the driven point alone, without a base.
    measured : sequence of MeasuredResponse
        Displacements, velocities or accelerations over the same force, as their units say; the fitted
        response is among them.

    Raises
    ------
    UsageError
        SF902 when the fit is of several responses or has a base.
    DataError
        SF602 when a unit is missing, or is not that of a motion over a force.
    FitError
        SF616 when a modal constant at the driven point is not positive.
    """
    if len(fit.measured) > 1 or fit.bases[0].path:
        message = "mode shapes come from a fit of the driven point alone, without a base"
        raise UsageError(Diagnostic("SF902", message))
    names = tuple(response.name for response in measured)
    at = next(i for i, response in enumerate(measured) if response is fit.measured[0])
    motions = [_motion_over_force(response.name, response.unit) for response in measured]
    units = sorted({motion.unit for motion in motions})
    if len(units) > 1:
        message = f"responses of different kinds: {', '.join(units)}"
        raise DataError(Diagnostic("SF602", message, None, "all are over one force, or all over one torque"))
    solved = [_residues(response, motion, fit) for response, motion in zip(measured, motions, strict=True)]
    found = np.array([one.constants for one in solved])
    turned = np.degrees(np.angle(found))
    for i in np.flatnonzero(np.abs(turned[at]) > MOST_TURNED):
        hertz = float(fit.resonances.omega_p[i]) / (2 * np.pi)
        where = f"the modal constant of {names[at]} at {hertz:.4g} Hz"
        message = f"{where} is {turned[at, i]:.0f} degrees off the positive real axis"
        raise FitError(Diagnostic("SF616", message, None, "a response at the driven point has positive ones"))
    turned = np.where(np.abs(turned) > RIGHT_ANGLE, turned - np.copysign(2 * RIGHT_ANGLE, turned), turned)
    driven = np.sqrt(found[at].real)
    return FittedModeShapes(
        names,
        at,
        np.asarray(found.real / driven, np.float64),
        np.array([_errors(one, solved[at], is_driven=k == at) for k, one in enumerate(solved)]),
        turned,
        units[0],
    )


@dataclass(frozen=True, eq=False)
class _Solved:
    """Modal constants of a response, shape (n,), and how they vary.

    ``noise`` is the covariance, shape (n, n), of their real parts with poles that are known; ``slopes``,
    shape (n, 2 n), their derivatives by ln omega_p and ln zeta_p, and ``poles`` the covariance of these.
    """

    constants: Complex
    noise: Real
    slopes: Real
    poles: Real


def _residues(response: MeasuredResponse, motion: _Motion, fit: Fit) -> _Solved:
    """Return the modal constants of one response by weighted least squares."""
    n = fit.resonances.count
    observation = observe(response.frequency_hz, response.spacing_hz, response.window)
    relative = response.relative_deviation()
    deviation = np.abs(response.values) * (1.0 if relative is None else relative)
    values = response.values / deviation

    def solved(logarithms: Real) -> tuple[Complex, Real]:
        poles = _poles(np.exp(logarithms[:n]), np.exp(logarithms[n:]))
        basis = observation(_basis(observation.omega, poles, motion.derivative)) / deviation[:, None]
        matrix = np.concatenate([basis.real, basis.imag])
        right = np.concatenate([values.real, values.imag])
        size = np.linalg.norm(matrix, axis=0)
        solution, *_ = np.linalg.lstsq(matrix / size, right, rcond=None)
        rest = right - matrix @ (solution / size)
        solution = solution / size
        residues = solution[:n] + 1j * solution[n : 2 * n]
        turn = motion.scale * (poles - poles.conj()) / poles**motion.derivative
        # The real parts of the constants, as combinations of the solution.
        mix = np.concatenate([np.diag(turn.real), -np.diag(turn.imag), np.zeros((2, n))]) / size[:, None]
        inverse = np.linalg.pinv(matrix / size)
        spread = float(rest @ rest) / max(right.size - solution.size, 1)
        noise = mix.T @ (inverse @ inverse.T) @ mix * spread * fit.refined.correlation
        return residues * turn, np.asarray(noise, np.float64)

    found = fit.resonances
    logarithms = np.log(np.concatenate([found.omega_p, found.zeta_p]))
    constants, noise = solved(logarithms)
    slopes = np.empty((n, 2 * n))
    for i in range(2 * n):
        step = STEP * np.eye(2 * n)[i]
        slopes[:, i] = (solved(logarithms + step)[0] - solved(logarithms - step)[0]).real / (2 * STEP)
    covariance = fit.refined.covariance
    poles = np.full((2 * n, 2 * n), np.nan) if covariance is None else covariance[: 2 * n, : 2 * n]
    return _Solved(constants, noise, slopes, poles)


def _errors(one: _Solved, driven: _Solved, *, is_driven: bool) -> Real:
    """Return the standard errors of ``c_j/sqrt(c_k)``, shape (n,): errors of the poles reach both."""
    c, k = one.constants.real, driven.constants.real
    of_one, of_driven = 1 / np.sqrt(k), -c / (2 * k**1.5)
    if is_driven:
        of_one, of_driven = of_one / 2, np.zeros(c.size)
    slopes = of_one[:, None] * one.slopes + of_driven[:, None] * driven.slopes
    variance = of_one**2 * np.diag(one.noise) + of_driven**2 * np.diag(driven.noise)
    return np.asarray(np.sqrt(variance + np.einsum("ni,ij,nj->n", slopes, one.poles, slopes)), np.float64)


def _poles(omega: Real, zeta: Real) -> Complex:
    return np.asarray(omega * (-zeta + 1j * np.sqrt(np.maximum(1 - zeta**2, 0.0))), np.complex128)


def _basis(omega: Real, poles: Complex, derivative: int) -> Complex:
    """Return what responses are made of: residues' real and imaginary parts, modes below and above."""
    s = 1j * omega[:, None]
    one, other = 1 / (s - poles), 1 / (s - poles.conj())
    return np.concatenate([one + other, 1j * (one - other), s ** (derivative - 2), s**derivative], axis=1)


@dataclass(frozen=True, slots=True)
class _Motion:
    """Which derivative of a displacement it is, over a force; its factor to SI; the unit of its shapes."""

    derivative: int
    scale: float
    unit: str


def _motion_over_force(name: str, unit: str) -> _Motion:
    """Return what a response is, from its unit.

    Raises
    ------
    DataError
        SF602 when the unit is missing or another one.
    """
    if not unit:
        message = f"{name} has no unit: is it a receptance, a mobility or an accelerance?"
        raise DataError(Diagnostic("SF602", message, None, "for example '# unit: m/N' in its first lines"))
    read = parse_unit(Text(unit, Span(Source(name, unit), 0, len(unit))))
    dimension = read.dimension
    kind = KINDS.get((dimension.kg, dimension.m))
    others = (dimension.A, dimension.K, dimension.mol, dimension.cd)
    if kind is None or dimension.s not in (0, 1, 2) or any(others):
        message = f"{name} in {unit} is no motion over a force"
        raise DataError(Diagnostic("SF602", message, None, "such as m/N, m/(N*s), m/(N*s^2) or rad/(N*m)"))
    return _Motion(2 - int(dimension.s), float(read.scale) * np.pi**read.pi_power, kind)
