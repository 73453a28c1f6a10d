"""Point mass."""

from __future__ import annotations

from symflex.elements.element import Element, ElementUse, ParameterPort, Port, Stamp, two_terminal


class Mass(Element):
    """A mass m [kg] at a translational node; its inertial force [N] is ``f``."""

    type_name = "mass"
    summary = "Point mass"
    ports = (Port("at", 1, "translation", "node that moves with the mass"),)
    parameters = (ParameterPort("m", "kg", "a mass"),)
    through = ("f",)

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute one branch, ``f = m*s^2*x``."""
        return two_terminal(use, "at", "f", use.values["m"] * use.s**2)
