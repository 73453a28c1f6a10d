"""Capacitor."""

from __future__ import annotations

from symflex.elements.element import Element, ElementUse, ParameterPort, Port, Stamp, two_terminal


class Capacitor(Element):
    """A capacitor C [F]; the current ``i`` [A] flows from the first node to the second."""

    type_name = "capacitor"
    summary = "Capacitor"
    ports = (Port("between", 2, "electrical", "the two terminals"),)
    parameters = (ParameterPort("C", "F", "a capacitance"),)
    through = ("i",)

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute one branch, ``i = C*s*(v_a - v_b)``."""
        return two_terminal(use, "between", "i", use.values["C"] * use.s)
