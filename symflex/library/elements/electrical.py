"""Electrical branches: resistors, inductors and capacitors."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.library.elements.element import (
    Element,
    ElementUse,
    EquationRow,
    Injection,
    LinearForm,
    Passivity,
    Port,
    Stamp,
    two_terminal,
)
from symflex.library.parameter import ParameterPort

if TYPE_CHECKING:
    from symflex.algebra import Factored


def _impedance(use: ElementUse, impedance: Factored) -> Stamp:
    """Return the stamp of ``impedance * i = v_a - v_b``; i [A] flows from a to b.

    The current is an unknown, so that nothing is divided by an impedance.
    """
    a, b = use.across("between")
    current = use.unknown("i")
    denominator = impedance.denominator()
    law = LinearForm.of((current, impedance * denominator), (a, -denominator), (b, denominator))
    flow = LinearForm.of((current, use.one))
    return Stamp(
        unknowns=(current,),
        rows=(EquationRow(current, law),),
        injections=(Injection(a, flow * (-use.one)), Injection(b, flow)),
        through=(("i", flow),),
    )


class Resistor(Element):
    """A resistor R [Ohm]; the current ``i`` [A] flows from the first node to the second."""

    type_name = "resistor"
    summary = "Resistor"
    ports = (Port("between", 2, "electrical", "the two terminals"),)
    parameters = (ParameterPort("R", "Ohm", "a resistance"),)
    through = ("i",)
    passive = Passivity()

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the current and its row ``R*i = v_a - v_b``."""
        return _impedance(use, use.values["R"])


class Inductor(Element):
    """An inductor L [H]; the current ``i`` [A] flows from the first node to the second."""

    type_name = "inductor"
    summary = "Inductor"
    ports = (Port("between", 2, "electrical", "the two terminals"),)
    parameters = (ParameterPort("L", "H", "an inductance"),)
    through = ("i",)
    passive = Passivity()

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the current and its row ``L*s*i = v_a - v_b``."""
        return _impedance(use, use.values["L"] * use.s)


class Capacitor(Element):
    """A capacitor C [F]; the current ``i`` [A] flows from the first node to the second."""

    type_name = "capacitor"
    summary = "Capacitor"
    ports = (Port("between", 2, "electrical", "the two terminals"),)
    parameters = (ParameterPort("C", "F", "a capacitance"),)
    through = ("i",)
    passive = Passivity()

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute one branch, ``i = C*s*(v_a - v_b)``."""
        return two_terminal(use, "between", "i", use.values["C"] * use.s)
