"""What turns about an axis: inertias, torsion springs and rotary dampers."""

from __future__ import annotations

from symflex.library.elements.element import Element, ElementUse, Passivity, Port, Stamp, two_terminal
from symflex.library.parameter import ParameterPort


class Inertia(Element):
    """A moment of inertia J [kg m^2] at a rotational node; its inertial torque [N m] is ``tau``."""

    type_name = "inertia"
    summary = "Rotational inertia"
    ports = (Port("at", 1, "rotation", "node that turns with the inertia"),)
    parameters = (ParameterPort("J", "kg*m^2", "a moment of inertia"),)
    through = ("tau",)
    passive = Passivity()
    is_inertia = True

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute one branch, ``tau = J*s^2*theta``."""
        return two_terminal(use, "at", "tau", use.values["J"] * use.s**2)


class TorsionSpring(Element):
    """A torsion spring k [N m/rad]; the torque ``tau`` [N m] it carries from the first node to the second."""

    type_name = "torsion_spring"
    summary = "Torsion spring"
    ports = (Port("between", 2, "rotation", "the two ends"),)
    parameters = (ParameterPort("k", "N*m/rad", "a torsional stiffness"),)
    through = ("tau",)
    passive = Passivity()
    compliance = "stretching"
    stiffness = "k"

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute one branch, ``tau = k*(theta_a - theta_b)``."""
        return two_terminal(use, "between", "tau", use.values["k"])


class RotaryDamper(Element):
    """A rotary damper b [N m s/rad]; it carries ``tau`` [N m] from the first node to the second."""

    type_name = "rotary_damper"
    summary = "Rotary viscous damper"
    ports = (Port("between", 2, "rotation", "the two ends"),)
    parameters = (ParameterPort("b", "N*m*s/rad", "a rotary damping coefficient"),)
    through = ("tau",)
    passive = Passivity()
    damping = "b"

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute one branch, ``tau = b*s*(theta_a - theta_b)``."""
        return two_terminal(use, "between", "tau", use.values["b"] * use.s)
