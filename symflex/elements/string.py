"""Stretched string."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.elements.element import ParameterPort, Port
from symflex.elements.line import LineElement

if TYPE_CHECKING:
    from collections.abc import Mapping


class String(LineElement):
    """A string of length l [m], cross-section A [m^2] and tension N [N], deflected across its length.

    ``f`` [N] is the transverse force the string delivers at its second end. ``c_f`` and ``k_f`` are a
    viscous and an elastic foundation per length.
    Source: Timoshenko, Young & Weaver 1974, Vibration Problems in Engineering, chapter 5.
    """

    type_name = "string"
    summary = "Stretched string, deflected across its length"
    ports = (Port("between", 2, "translation", "the two ends, the second one l further along x"),)
    parameters = (
        ParameterPort("N", "N", "a tension", sign="positive"),
        ParameterPort("rho", "kg/m^3", "a density", sign="nonnegative"),
        ParameterPort("A", "m^2", "a cross-section", sign="nonnegative"),
        ParameterPort("l", "m", "a length"),
        ParameterPort("c_f", "N*s/m^2", "a viscous foundation", "0"),
        ParameterPort("k_f", "N/m^2", "an elastic foundation", "0"),
    )
    through = ("f",)
    ends = ("across",)

    def theory(self, choices: Mapping[str, str]) -> str:
        """Return the field theory."""
        del choices
        return "string"
