"""Rotary viscous damper."""

from __future__ import annotations

from symflex.elements.element import Element, ElementUse, ParameterPort, Port, Stamp, two_terminal


class RotaryDamper(Element):
    """A rotary damper b [N m s/rad]; it carries ``tau`` [N m] from the first node to the second."""

    type_name = "rotary_damper"
    summary = "Rotary viscous damper"
    ports = (Port("between", 2, "rotation", "the two ends"),)
    parameters = (ParameterPort("b", "N*m*s/rad", "a rotary damping coefficient"),)
    through = ("tau",)

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute one branch, ``tau = b*s*(theta_a - theta_b)``."""
        return two_terminal(use, "between", "tau", use.values["b"] * use.s)
