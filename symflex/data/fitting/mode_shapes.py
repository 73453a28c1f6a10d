"""Mass-normalised mode shapes from responses to one force, one of them measured where it acts.

Of a structure with real modes, receptances are ``sum_r phi_jr phi_kr/(s^2 + 2 zeta_r omega_r s + omega_r^2)``
with modes that make the modal masses one, and two terms for modes below and above the band (Ewins 2000,
sections 2.4 and 4.3). With given poles every response is linear in its residues, which weighted least squares
find; what is left is made least by moving the poles, all responses together (variable projection, Golub and
Pereyra 1973), from those of a fit to the driven point, where poles show best. A residue times
``p - conj(p)`` is the modal constant ``phi_jr phi_kr``; at the driven point it is ``phi_kr^2``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from symflex.data.fitting.fit import ResonanceFit
from symflex.data.fitting.lines import isolated, wild_lines
from symflex.data.fitting.observation import Observation, observe
from symflex.data.fitting.resonances import Complex, Real, Values
from symflex.data.measurement import MeasuredResponse
from symflex.errors import DataError, Diagnostic, FitError, Text, refused
from symflex.quantities import parse_unit

STEP = 1e-6  # of the logarithms by which derivatives are taken

KINDS = {(Fraction(-1), Fraction(0)): "kg^(-1/2)", (Fraction(-1), Fraction(-2)): "kg^(-1/2)*m^(-1)"}
"""Units of mode shapes by the exponents of kg and m in a motion over a force, and over a torque."""

MOST_MOVED, MOST_DAMPED = 0.1, 2.0  # how far responses may move the logarithm of frequency and damping
WEAK = 0.5  # standard error of a damping ratio over its value from which a resonance has no mode shape
RIGHT_ANGLE = 90.0
MOST_STEPS = 200
SINGULAR = 1e13  # condition of the normal equations from which a covariance means nothing

MOST_TURNED = 45.0  # no driven point's modal constant is so many degrees off the positive real axis


@dataclass(frozen=True, eq=False)
class FittedModeShapes:
    """Mass-normalised mode shapes where responses were measured."""

    names: tuple[str, ...]  # the responses
    driving: int  # which of them is at the driven point
    shapes: Real  # shape (m, n): Of m responses in n modes; at the driven point positive
    errors: Real  # shape (m, n): Standard errors
    turned: Real  # shape (m, n): How far modal constants are off the real axis [deg]: 0 for real modes
    unit: str  # ``kg^(-1/2)``, or with an inertia
    # frequency_hz and damping_ratio: shape (n,): Of the poles that suit all responses best.
    frequency_hz: Real
    damping_ratio: Real


def mode_shapes(fit: ResonanceFit, measured: Sequence[MeasuredResponse]) -> FittedModeShapes:
    """Return mass-normalised mode shapes of all responses, from a fit of the one at the driven point."""
    if len(fit.measured) > 1 or fit.bases[0].path:
        raise refused("mode shapes come from a fit of the driven point alone, without a base")
    names = tuple(response.name for response in measured)
    at = next((i for i, response in enumerate(measured) if response is fit.measured[0]), None)
    if at is None:
        message = f"the fitted response {fit.measured[0].name} is not among those of the mode shapes"
        raise refused(message, "give the response itself that was fitted")
    motions = [_motion_over_force(response.name, response.unit) for response in measured]
    units = sorted({motion.unit for motion in motions})
    if len(units) > 1:
        message = f"responses of different kinds: {', '.join(units)}"
        raise DataError(
            Diagnostic("SF602", message, None, "divide all of them by one force, or all by one torque")
        )
    systems = [_system(response, motion) for response, motion in zip(measured, motions, strict=True)]
    logarithms, covariance = _refined(systems, fit)
    count = logarithms.size // 2
    solved = [_solved(system, logarithms, fit.refined.correlation) for system in systems]
    constants = np.array([one.constants for one in solved])
    turned = np.degrees(np.angle(constants))
    for i in np.flatnonzero(np.abs(turned[at]) > MOST_TURNED):
        hertz = float(np.exp(logarithms[i])) / (2 * np.pi)
        where = f"the modal constant of {names[at]} at {hertz:.4g} Hz"
        message = f"{where} is {turned[at, i]:.0f} degrees off the positive real axis"
        raise FitError(Diagnostic("SF616", message, None, "a response at the driven point has positive ones"))
    turned = np.where(np.abs(turned) > RIGHT_ANGLE, turned - np.copysign(2 * RIGHT_ANGLE, turned), turned)
    driven = np.sqrt(constants[at].real)
    shapes = np.asarray(constants.real / driven, np.float64)
    errors = [_errors(one, solved[at], covariance, is_driven=k == at) for k, one in enumerate(solved)]
    frequency, damping = np.exp(logarithms[:count]) / (2 * np.pi), np.exp(logarithms[count:])
    return FittedModeShapes(names, at, shapes, np.array(errors), turned, units[0], frequency, damping)


@dataclass(frozen=True, eq=False)
class _ResponseSystem:
    """One response as a linear problem: its lines, over their standard deviations."""

    motion: _Motion
    observation: Observation
    deviation: Real
    values: Real

    def matrix(self, logarithms: Real) -> Real:
        """Return the real system for poles given by ln omega_p and ln zeta_p."""
        basis = _basis(self.observation.omega, _poles(logarithms), self.motion.derivative)
        seen = self.observation(basis) / self.deviation[:, None]
        return np.concatenate([seen.real, seen.imag])

    def rest(self, logarithms: Real) -> Real:
        """Return what the best residues leave."""
        matrix = self.matrix(logarithms)
        matrix = matrix / np.linalg.norm(matrix, axis=0)
        solution, *_ = np.linalg.lstsq(matrix, self.values, rcond=None)
        return np.asarray(self.values - matrix @ solution, np.float64)


@dataclass(frozen=True, eq=False)
class _SolvedShapes:
    """Modal constants of a response, shape (n,), and how they vary.

    ``noise`` is the covariance, shape (n, n), of their real parts with poles that are known; ``slopes``,
    shape (n, 2 n), their derivatives by ln omega_p and ln zeta_p.
    """

    constants: Complex
    noise: Real
    slopes: Real


def _system(response: MeasuredResponse, motion: _Motion) -> _ResponseSystem:
    wild = wild_lines(response.omega, response.values)
    kept = np.delete(np.arange(response.omega.size), isolated(wild, response.omega.size))
    observation = observe(response).at(kept)
    relative = response.relative_deviation()
    deviation = (np.abs(response.values) * (1.0 if relative is None else relative))[kept]
    values = response.values[kept] / deviation
    return _ResponseSystem(motion, observation, deviation, np.concatenate([values.real, values.imag]))


def _refined(systems: Sequence[_ResponseSystem], fit: ResonanceFit) -> tuple[Real, Real]:
    """Return ln omega_p and ln zeta_p that leave least of all responses, and their covariance."""
    modes, errors = fit.resonances, fit.standard_errors()
    # Resonances in the band that the data determine; of a poor fit, where there are none, all in the band.
    shown = fit.modes & (errors.zeta_p <= WEAK * modes.zeta_p)
    if not shown.any():
        shown = fit.modes
    if not shown.any():
        message = "the response at the driven point shows no resonance"
        raise FitError(Diagnostic("SF616", message, None, "check --driving and --band"))
    omega, zeta = modes.omega_p[shown], modes.zeta_p[shown]
    start = np.log(np.concatenate([omega, zeta]))

    def rest(logarithms: Real) -> Real:
        return np.concatenate([system.rest(logarithms) for system in systems])

    # Poles stay near those of the driven point: far from them residues have no meaning.
    reach = np.repeat([MOST_MOVED, MOST_DAMPED], start.size // 2)
    from scipy.optimize import least_squares  # takes a third of a second, and other fits need none of it

    result = least_squares(
        rest, start, bounds=(start - reach, start + reach), x_scale="jac", max_nfev=MOST_STEPS
    )
    if not result.success:
        raise FitError(Diagnostic("SF612", "the search for poles of all responses did not converge"))
    free = result.fun.size - 2 * start.size * len(systems)
    spread = float(result.fun @ result.fun) / max(free, 1) * fit.refined.correlation
    normal = result.jac.T @ result.jac
    if np.linalg.cond(normal) > SINGULAR:
        raise FitError(Diagnostic("SF613", "the responses do not determine all poles"))
    return result.x, np.linalg.inv(normal) * spread


def _solved(system: _ResponseSystem, logarithms: Real, correlation: float) -> _SolvedShapes:
    n = logarithms.size // 2

    def constants(logarithms: Real) -> tuple[Complex, Real]:
        poles, matrix = _poles(logarithms), system.matrix(logarithms)
        size = np.linalg.norm(matrix, axis=0)
        inverse = np.linalg.pinv(matrix / size)
        solution = inverse @ system.values / size
        turn = system.motion.scale * (poles - poles.conj()) / poles**system.motion.derivative
        # The real parts of the constants, as combinations of the solution.
        mix = np.concatenate([np.diag(turn.real), -np.diag(turn.imag), np.zeros((2, n))]) / size[:, None]
        residuals = system.values - matrix @ solution
        spread = float(residuals @ residuals) / max(residuals.size - solution.size, 1) * correlation
        noise = np.asarray(mix.T @ (inverse @ inverse.T) @ mix * spread, np.float64)
        return (solution[:n] + 1j * solution[n : 2 * n]) * turn, noise

    modal_constants, noise = constants(logarithms)
    slopes = np.empty((n, 2 * n))
    for i in range(2 * n):
        step = STEP * np.eye(2 * n)[i]
        slopes[:, i] = (constants(logarithms + step)[0] - constants(logarithms - step)[0]).real / (2 * STEP)
    return _SolvedShapes(modal_constants, noise, slopes)


def _errors(one: _SolvedShapes, driven: _SolvedShapes, poles: Real, *, is_driven: bool) -> Real:
    """Return the standard errors of ``c_j/sqrt(c_k)``, shape (n,): errors of the poles reach both."""
    c, k = one.constants.real, driven.constants.real
    of_one, of_driven = 1 / np.sqrt(k), -c / (2 * k**1.5)
    if is_driven:
        of_one, of_driven = of_one / 2, np.zeros(c.size)
    slopes = of_one[:, None] * one.slopes + of_driven[:, None] * driven.slopes
    variance = of_one**2 * np.diag(one.noise) + of_driven**2 * np.diag(driven.noise)
    return np.asarray(np.sqrt(variance + np.einsum("ni,ij,nj->n", slopes, poles, slopes)), np.float64)


def _poles(logarithms: Real) -> Complex:
    n = logarithms.size // 2
    omega, zeta = np.exp(logarithms[:n]), np.exp(logarithms[n:])
    return np.asarray(omega * (-zeta + 1j * np.sqrt(np.maximum(1 - zeta**2, 0.0))), np.complex128)


def _basis(omega: Values, poles: Complex, derivative: int) -> Complex:
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
    """Return what a response is, from its unit; SF602 when that is missing or another one."""
    if not unit:
        message = f"{name} has no unit: is it a receptance, a mobility or an accelerance?"
        raise DataError(Diagnostic("SF602", message, None, "for example '# unit: m/N' in its first lines"))
    read = parse_unit(Text.alone(name, unit))
    dimension = read.dimension
    kind = KINDS.get((dimension.kg, dimension.m))
    others = (dimension.A, dimension.K, dimension.mol, dimension.cd)
    if kind is None or dimension.s not in (0, 1, 2) or any(others):
        message = f"{name} in {unit} is not a motion per force"
        raise DataError(Diagnostic("SF602", message, None, "such as m/N, m/(N*s), m/(N*s^2) or rad/(N*m)"))
    return _Motion(2 - int(dimension.s), float(read.scale) * np.pi**read.pi_power, kind)
