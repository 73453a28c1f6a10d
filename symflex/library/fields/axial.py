"""Second-order theories: the axial rod, the shaft in torsion and the taut string."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.library.fields.euler_bernoulli import foundation
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
