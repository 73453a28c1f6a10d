"""The models of Eppinger & Seering 1988, derived by hand: from energies, from Newton's laws, by shooting.

Every function returns transfer functions in the symbols of the file of the same name in
``derivations/eppinger1988``.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeVar

import numpy as np
import sympy

from tests.independent.lagrange import LagrangianSystem, rate, s

if TYPE_CHECKING:
    from collections.abc import Sequence

Scalar = TypeVar("Scalar")

MODES_HZ = (11, 38, 44, 67, 77)
"""The dominant structural modes, section 'Experimental Robot Dynamics'."""


def printed_rigid_body() -> sympy.Expr:
    """Return V_tip/V_cmd letter by letter as the paper prints it."""
    m_eff, b_eff, r, L, R, k_amp, k_preamp, k_tau, k_current, k_tach, k_bemf = sympy.symbols(
        "m_eff b_eff r L R k_amp k_preamp k_tau k_current k_tach k_bemf"
    )
    numerator = k_amp * k_preamp * r * k_tau
    mechanical = (m_eff * s + b_eff) * r**2 * (L * s + R + k_amp * k_current)
    electrical = k_tau * (k_amp * k_preamp * k_tach + k_bemf)
    return numerator / (mechanical + electrical)


def rigid_body() -> sympy.Expr:
    """Return V_tip/V_cmd, solved from the laws written one below the other."""
    m_eff, b_eff, r, L, R, k_amp, k_preamp, k_tau, k_current, k_tach, k_bemf = sympy.symbols(
        "m_eff b_eff r L R k_amp k_preamp k_tau k_current k_tach k_bemf"
    )
    v_cmd, v_pre, v_amp, current, speed, torque, force, v = sympy.symbols("v_cmd v_pre v_amp i w tau f v")
    laws = [
        sympy.Eq(v_pre, k_preamp * (v_cmd - k_tach * speed)),
        sympy.Eq(v_amp, k_amp * (v_pre - k_current * current)),
        sympy.Eq(v_amp, L * s * current + R * current + k_bemf * speed),
        sympy.Eq(torque, k_tau * current),
        sympy.Eq(v, r * speed),
        sympy.Eq(force * r, torque),  # the screw loses no power: force*v = torque*speed
        sympy.Eq(force, m_eff * s * v + b_eff * v),
    ]
    solution = sympy.solve(laws, [v_pre, v_amp, current, speed, torque, force, v], dict=True)
    return sympy.cancel(solution[0][v] / v_cmd)


def simple_resonance(omega_p: float, zeta_p: float, omega_z: float, zeta_z: float, at: complex) -> complex:
    """Return R_i(s) of section 'Polynomial Resonance Model'.

    Examples
    --------
    >>> simple_resonance(2.0, 0.05, 3.0, 0.05, 0j)
    (1+0j)
    """
    zeros = at**2 + 2 * zeta_z * omega_z * at + omega_z**2
    poles = at**2 + 2 * zeta_p * omega_p * at + omega_p**2
    return omega_p**2 / omega_z**2 * zeros / poles


def two_mass(output: str) -> sympy.Expr:
    """Return ``x_act/F`` or ``x_tip/F`` of figure 8a."""
    m_1, m_2, k, b, x_act, x_tip = sympy.symbols("m_1 m_2 k b x_act x_tip")
    system = LagrangianSystem(
        (x_act, x_tip),
        kinetic=(m_1 * rate(x_act) ** 2 + m_2 * rate(x_tip) ** 2) / 2,
        potential=k * (x_act - x_tip) ** 2 / 2,
        dissipation=b * (rate(x_act) - rate(x_tip)) ** 2 / 2,
    )
    return system.receptance({"x_act": x_act, "x_tip": x_tip}[output], {x_act: 1})


def chain(
    masses: Sequence[Scalar], stiffnesses: Sequence[Scalar], dampings: Sequence[Scalar], at: Scalar
) -> tuple[Scalar, Scalar]:
    """Return (x_first/F, x_last/F) of masses in series at one point s, by shooting from the free end.

    Only field operations are used, so exact numbers give exact results.

    Examples
    --------
    >>> from fractions import Fraction
    >>> chain([Fraction(2)], [], [], Fraction(3))
    (Fraction(1, 18), Fraction(1, 18))
    """
    x = at / at
    force = masses[-1] * at * at * x
    for m, k, b in zip(masses[-2::-1], stiffnesses[::-1], dampings[::-1], strict=True):
        x = x + force / (k + b * at)  # the force stretches the link by force/(k + b s)
        force = force + m * at * at * x
    return x / force, at / at / force


def chain_poles(
    masses: Sequence[float], stiffnesses: Sequence[float], dampings: Sequence[float]
) -> np.ndarray:
    """Return all poles of masses in series, as eigenvalues of the state matrix."""
    n = len(masses)
    difference = np.diff(np.eye(n), axis=0)
    inverse_mass = np.diag(1 / np.asarray(masses, dtype=float))
    stiffness = inverse_mass @ difference.T @ np.diag(stiffnesses) @ difference
    damping = inverse_mass @ difference.T @ np.diag(dampings) @ difference
    return np.linalg.eigvals(np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness, -damping]]))


def base_flexure(output: str, friction_on: str = "base", force_on: str = "base") -> sympy.Expr:
    """Return a receptance of figure 8c in one of its readings.

    Parameters
    ----------
    output : {"tip", "motor", "base"}
        Carriage in space, carriage relative to the base, base.
    friction_on : {"base", "ground", "nothing"}
        What the carriage rubs on.
    force_on : {"base", "ground"}
        What takes the reaction of the actuator's force.
    """
    m, m_base, k_base, b_base, b, tip, base = sympy.symbols("m m_base k_base b_base b x_tip x_base")
    slip = {"base": rate(tip) - rate(base), "ground": rate(tip), "nothing": sympy.S.Zero}[friction_on]
    system = LagrangianSystem(
        (tip, base),
        kinetic=(m * rate(tip) ** 2 + m_base * rate(base) ** 2) / 2,
        potential=k_base * base**2 / 2,
        dissipation=(b_base * rate(base) ** 2 + b * slip**2) / 2,
    )
    work = {"base": {tip: 1, base: -1}, "ground": {tip: 1}}[force_on]
    return system.receptance({"tip": tip, "motor": tip - base, "base": base}[output], work)


def lumped_bending_beam(output: str) -> sympy.Expr:
    """Return ``x_act/F``, ``x_tip/F`` or ``theta/F``, the angle of the tip, of figure 12.

    The beam's energy is the integral of E I w''^2/2 over the cubic w that its end values fix.
    """
    m_1, m_2, J, c, h, EI, length = sympy.symbols("m_1 m_2 J c h EI l")
    x_act, y, theta, x = sympy.symbols("x_act y theta x")
    a_2, a_3 = sympy.symbols("a_2 a_3")
    w = x_act + a_2 * x**2 + a_3 * x**3  # the slider keeps w'(0) = 0
    ends = sympy.solve(
        [w.subs(x, length) - y, sympy.diff(w, x).subs(x, length) - theta], [a_2, a_3], dict=True
    )[0]
    curvature = sympy.diff(w.subs(ends), x, 2)
    mass_centre = rate(y) + c * rate(theta)
    system = LagrangianSystem(
        (x_act, y, theta),
        kinetic=(m_1 * rate(x_act) ** 2 + m_2 * mass_centre**2 + J * rate(theta) ** 2) / 2,
        potential=sympy.expand(sympy.integrate(sympy.expand(EI * curvature**2 / 2), (x, 0, length))),
    )
    return system.receptance({"x_act": x_act, "x_tip": y + h * theta, "theta": theta}[output], {x_act: 1})


def tip_bracket() -> sympy.Expr:
    """Return B, whose sign decides whether the tip of the lumped bending beam is minimum phase.

    At a zero the tip stands still, so the joint moves by y = -h theta. Newton's and Euler's laws of the
    body then give the shear V and the moment M at the joint, and these alone turn the beam's end, for
    the slider does not turn: theta = -(V l^2/2 + M l)/EI, wherever the actuator is. That is one equation
    in theta, 2 EI/l + B s^2 = 0.
    """
    m_2, J, c, h, EI, length = sympy.symbols("m_2 J c h EI l")
    shear, moment, theta = sympy.symbols("V M theta")  # what the beam's end exerts on the body
    y_cg = (c - h) * theta  # y + c theta, with y = -h theta
    newton = sympy.Eq(m_2 * s**2 * y_cg, shear)
    euler = sympy.Eq(J * s**2 * theta, moment - c * shear)
    # The end of a cantilever under V and M turns by (V l^2/2 + M l)/EI; the beam carries -V and -M.
    beam = sympy.Eq(theta, -(shear * length**2 / 2 + moment * length) / EI)
    found = sympy.solve([newton, euler], [shear, moment], dict=True)[0]
    balance = sympy.expand((beam.lhs - beam.rhs).subs(found) * 2 * EI / length / theta)
    return sympy.expand(balance).coeff(s, 2)


def bracket(m_2: float, J: float, c: float, h: float, length: float) -> float:
    """Return B in numbers.

    Examples
    --------
    >>> bracket(m_2=2.0, J=0.00375, c=0.075, h=0.15, length=0.5) < 0
    True
    """
    return 2 * J + 2 * c**2 * m_2 + c * length * m_2 - 2 * c * h * m_2 - h * length * m_2


def radians_per_second(hertz: float) -> float:
    """Return an angular frequency."""
    return 2 * math.pi * hertz
