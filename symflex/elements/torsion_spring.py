"""Torsion spring."""

from __future__ import annotations

from symflex.elements.element import Element, ElementUse, ParameterPort, Port, Stamp, two_terminal


class TorsionSpring(Element):
    """A torsion spring k [N m/rad]; the torque ``tau`` [N m] it carries from the first node to the second."""

    type_name = "torsion_spring"
    summary = "Torsion spring"
    ports = (Port("between", 2, "rotation", "the two ends"),)
    parameters = (ParameterPort("k", "N*m/rad", "a torsional stiffness"),)
    through = ("tau",)

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute one branch, ``tau = k*(theta_a - theta_b)``."""
        return two_terminal(use, "between", "tau", use.values["k"])
