"""Bending of a slender beam: Euler-Bernoulli's theory, and Rayleigh's, which adds rotary inertia."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.library.fields.system import FieldSystem, system_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from symflex.algebra import Factored

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
