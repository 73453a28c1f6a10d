"""What moves along a line: point masses, springs and viscous dampers."""

from __future__ import annotations

from symflex.library.elements.element import Element, ElementUse, Passivity, Port, Stamp, two_terminal
from symflex.library.parameter import ParameterPort


class Mass(Element):
    """A mass m [kg] at a translational node; its inertial force [N] is ``f``."""

    type_name = "mass"
    summary = "Point mass"
    ports = (Port("at", 1, "translation", "node that moves with the mass"),)
    parameters = (ParameterPort("m", "kg", "a mass"),)
    through = ("f",)
    passive = Passivity()
    is_inertia = True

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute one branch, ``f = m*s^2*x``."""
        return two_terminal(use, "at", "f", use.values["m"] * use.s**2)


class Spring(Element):
    """A spring k [N/m]; the force ``f`` [N] it carries from the first node to the second."""

    type_name = "spring"
    summary = "Translational spring"
    ports = (Port("between", 2, "translation", "the two ends"),)
    parameters = (ParameterPort("k", "N/m", "a stiffness"),)
    through = ("f",)
    passive = Passivity()
    compliance = "stretching"
    stiffness = "k"

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute one branch, ``f = k*(x_a - x_b)``."""
        return two_terminal(use, "between", "f", use.values["k"])


class Damper(Element):
    """A damper b [N s/m]; the force ``f`` [N] it carries from the first node to the second."""

    type_name = "damper"
    summary = "Translational viscous damper"
    ports = (Port("between", 2, "translation", "the two ends"),)
    parameters = (ParameterPort("b", "N*s/m", "a damping coefficient"),)
    through = ("f",)
    passive = Passivity()
    damping = "b"

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute one branch, ``f = b*s*(x_a - x_b)``."""
        return two_terminal(use, "between", "f", use.values["b"] * use.s)
