"""Rotational inertia."""

from __future__ import annotations

from symflex.elements.element import Element, ElementUse, ParameterPort, Port, Stamp, two_terminal


class Inertia(Element):
    """A moment of inertia J [kg m^2] at a rotational node; its inertial torque [N m] is ``tau``."""

    type_name = "inertia"
    summary = "Rotational inertia"
    ports = (Port("at", 1, "rotation", "node that turns with the inertia"),)
    parameters = (ParameterPort("J", "kg*m^2", "a moment of inertia"),)
    through = ("tau",)

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute one branch, ``tau = J*s^2*theta``."""
        return two_terminal(use, "at", "tau", use.values["J"] * use.s**2)
