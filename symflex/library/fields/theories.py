"""Field theories: rod, shaft, string, and bending after Euler-Bernoulli, Rayleigh and Timoshenko."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.library.fields.system import FieldSystem, system_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from symflex.algebra import Factored


def rod(s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
    """Return ``E A (1 + eta s) u'' = (rho A s^2 + c_f s + k_f) u`` (Graff 1975, section 2.1)."""
    stiffness = values["E"] * values["A"] * (values["eta"] * s + 1)
    return _second_order(("u", "f"), s, stiffness, foundation(s, values))


def shaft(s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
    """Return ``G J (1 + eta s) theta'' = (rho J s^2 + c_f s + k_f) theta`` (Graff 1975, section 2.6).

    J is the polar second moment of area [m^4] of a circular section.
    """
    stiffness = values["G"] * values["J"] * (values["eta"] * s + 1)
    inertia = values["rho"] * values["J"] * s**2 + values["c_f"] * s + values["k_f"]
    return _second_order(("theta", "tau"), s, stiffness, inertia)


def string(s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
    """Return ``N w'' = (rho A s^2 + c_f s + k_f) w`` with tension N (Graff 1975, section 1.1)."""
    return _second_order(("w", "f"), s, values["N"], foundation(s, values))


def _second_order(
    states: tuple[str, str], s: Factored, stiffness: Factored, inertia: Factored
) -> FieldSystem:
    across, through = states
    one = s**0
    return system_of(states, {(across, through): one / stiffness, (through, across): inertia}, one * 0)


BENDING_STATES = ("y", "theta", "f", "tau")


def foundation(s: Factored, values: Mapping[str, Factored]) -> Factored:
    """Return ``rho*A*s^2 + c_f*s + k_f``, inertia and foundation per length [N/m^2]."""
    return values["rho"] * values["A"] * s**2 + values["c_f"] * s + values["k_f"]


def euler_bernoulli(s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
    """Return ``EI(1 + eta s) w'''' - N w'' + (rho A s^2 + c_f s + k_f) w = 0`` as a first-order system.

    ``f`` and ``tau`` are the transverse force and the bending moment that the part beyond x exerts on the
    part before it: ``tau = EI w''`` and ``f = -EI w''' + N w'``. The axial force N is positive in tension.
    Valid for wavelengths long against the depth (Graff 1975, section 3.1).
    """
    return _slender(s, values, values["N"])


def rayleigh(s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
    """Return Euler-Bernoulli's equations with rotary inertia ``rho I`` (Rayleigh 1877)."""
    return _slender(s, values, values["N"] + values["rho"] * values["I"] * s**2)


def _slender(s: Factored, values: Mapping[str, Factored], slope_moment: Factored) -> FieldSystem:
    one = s**0
    stiffness = values["E"] * values["I"] * (values["eta"] * s + 1)
    entries = {
        ("y", "theta"): one,
        ("theta", "tau"): one / stiffness,
        ("tau", "f"): -one,
        ("tau", "theta"): slope_moment,
        ("f", "y"): foundation(s, values),
    }
    return system_of(BENDING_STATES, entries, one * 0)


def timoshenko(s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
    """Return Timoshenko's equations of deflection w and rotation theta of the cross-section.

    ``kappa G A (w'' - theta') = (rho A s^2 + c_f s + k_f) w`` and
    ``EI theta'' + kappa G A (w' - theta) = rho I s^2 theta``; Kelvin-Voigt losses multiply E and G alike
    (Timoshenko 1921; Graff 1975, section 3.4).
    """
    one = s**0
    loss = values["eta"] * s + 1
    entries = {
        ("y", "theta"): one,
        ("y", "f"): one / (values["kappa"] * values["G"] * values["A"] * loss),
        ("theta", "tau"): one / (values["E"] * values["I"] * loss),
        ("tau", "f"): -one,
        ("tau", "theta"): values["rho"] * values["I"] * s**2,
        ("f", "y"): foundation(s, values),
    }
    return system_of(BENDING_STATES, entries, one * 0)
