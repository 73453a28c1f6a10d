"""Uniform rod in tension."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.elements.element import ParameterPort, Port
from symflex.elements.line import LineElement

if TYPE_CHECKING:
    from collections.abc import Mapping


class Rod(LineElement):
    """A uniform rod of length l [m] and cross-section A [m^2] in tension and compression.

    ``f`` [N] is the force the rod delivers at its second end. ``eta`` [s] is Kelvin-Voigt damping,
    ``c_f`` and ``k_f`` a viscous and an elastic foundation per length.
    Source: Timoshenko, Young & Weaver 1974, Vibration Problems in Engineering, chapter 5.
    """

    type_name = "rod"
    summary = "Uniform rod in tension and compression"
    ports = (Port("between", 2, "translation", "the two ends, the second one l further along x"),)
    parameters = (
        ParameterPort("E", "Pa", "a modulus of elasticity", sign="positive"),
        ParameterPort("A", "m^2", "a cross-section", sign="positive"),
        ParameterPort("rho", "kg/m^3", "a density", sign="nonnegative"),
        ParameterPort("l", "m", "a length"),
        ParameterPort("eta", "s", "a Kelvin-Voigt loss time", "0", sign="nonnegative"),
        ParameterPort("c_f", "N*s/m^2", "a viscous foundation", "0"),
        ParameterPort("k_f", "N/m^2", "an elastic foundation", "0"),
    )
    through = ("f",)
    ends = ("across",)

    def theory(self, choices: Mapping[str, str]) -> str:
        """Return the field theory."""
        del choices
        return "rod"
