"""Translational spring."""

from __future__ import annotations

from symflex.elements.element import Element, ElementUse, ParameterPort, Port, Stamp, two_terminal


class Spring(Element):
    """A spring k [N/m]; the force ``f`` [N] it carries from the first node to the second."""

    type_name = "spring"
    summary = "Translational spring"
    ports = (Port("between", 2, "translation", "the two ends"),)
    parameters = (ParameterPort("k", "N/m", "a stiffness"),)
    through = ("f",)

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute one branch, ``f = k*(x_a - x_b)``."""
        return two_terminal(use, "between", "f", use.values["k"])
