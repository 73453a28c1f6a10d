"""Bending of a thick beam: Timoshenko's theory, with shear flexibility and rotary inertia."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.library.fields.euler_bernoulli import BENDING_STATES, foundation
from symflex.library.fields.system import FieldSystem, system_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from symflex.algebra import Factored


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
