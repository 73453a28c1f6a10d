"""Translational viscous damper."""

from __future__ import annotations

from symflex.elements.element import Element, ElementUse, ParameterPort, Port, Stamp, two_terminal


class Damper(Element):
    """A damper b [N s/m]; the force ``f`` [N] it carries from the first node to the second."""

    type_name = "damper"
    summary = "Translational viscous damper"
    ports = (Port("between", 2, "translation", "the two ends"),)
    parameters = (ParameterPort("b", "N*s/m", "a damping coefficient"),)
    through = ("f",)

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute one branch, ``f = b*s*(x_a - x_b)``."""
        return two_terminal(use, "between", "f", use.values["b"] * use.s)
