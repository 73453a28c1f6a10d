"""Uniform shaft in torsion."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.elements.element import ParameterPort, Port
from symflex.elements.line import LineElement

if TYPE_CHECKING:
    from collections.abc import Mapping


class Shaft(LineElement):
    """A uniform shaft of length l [m] and polar second moment of area J [m^4] in torsion.

    ``tau`` [N m] is the torque the shaft delivers at its second end. ``eta`` [s] is Kelvin-Voigt damping,
    ``c_f`` and ``k_f`` a viscous and an elastic foundation per length. For a section that is not circular, G
    stands for G times the torsion constant over J.
    Source: Timoshenko, Young & Weaver 1974, Vibration Problems in Engineering, chapter 5.
    """

    type_name = "shaft"
    summary = "Uniform shaft in torsion"
    ports = (Port("between", 2, "rotation", "the two ends, the second one l further along x"),)
    parameters = (
        ParameterPort("G", "Pa", "a shear modulus", sign="positive"),
        ParameterPort("J", "m^4", "a polar second moment of area", sign="positive"),
        ParameterPort("rho", "kg/m^3", "a density", sign="nonnegative"),
        ParameterPort("l", "m", "a length"),
        ParameterPort("eta", "s", "a Kelvin-Voigt loss time", "0", sign="nonnegative"),
        ParameterPort("c_f", "N*m*s/m", "a viscous foundation", "0"),
        ParameterPort("k_f", "N*m/m", "an elastic foundation", "0"),
    )
    through = ("tau",)
    ends = ("across",)

    def theory(self, choices: Mapping[str, str]) -> str:
        """Return the field theory."""
        del choices
        return "shaft"
