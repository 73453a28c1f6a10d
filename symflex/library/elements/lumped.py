"""Lumped elements of two terminals: what moves, what turns, what conducts, and ideal sources."""

from __future__ import annotations

from typing import ClassVar

from symflex.library import ParameterPort
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


class Branch(Element):
    """Base of what is one branch, ``through = value * s^order * (a - b)`` of its one port and parameter."""

    passive = Passivity()
    order: ClassVar[int] = 0

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute one branch: of a spring ``f = k*(x_a - x_b)``, of a mass ``f = m*s^2*x``."""
        (port,), (quantity,) = self.ports, self.through
        return two_terminal(use, port.name, quantity, use.values[self.parameters[0].name] * use.s**self.order)


class Mass(Branch):
    """A mass m [kg] at a translational node; its inertial force [N] is ``f``."""

    type_name = "mass"
    summary = "Point mass"
    ports = (Port("at", 1, "translation", "node that moves with the mass"),)
    parameters = (ParameterPort("m", "kg", "a mass"),)
    through = ("f",)
    is_inertia = True
    order = 2


class Spring(Branch):
    """A spring k [N/m]; the force ``f`` [N] it carries from the first node to the second."""

    type_name = "spring"
    summary = "Translational spring"
    ports = (Port("between", 2, "translation", "the two ends"),)
    parameters = (ParameterPort("k", "N/m", "a stiffness"),)
    through = ("f",)
    compliance = "stretching"
    stiffness = "k"


class Damper(Branch):
    """A damper b [N s/m]; the force ``f`` [N] it carries from the first node to the second."""

    type_name = "damper"
    summary = "Translational viscous damper"
    ports = (Port("between", 2, "translation", "the two ends"),)
    parameters = (ParameterPort("b", "N*s/m", "a damping coefficient"),)
    through = ("f",)
    damping = "b"
    order = 1


class Inertia(Branch):
    """A moment of inertia J [kg m^2] at a rotational node; its inertial torque [N m] is ``tau``."""

    type_name = "inertia"
    summary = "Rotational inertia"
    ports = (Port("at", 1, "rotation", "node that turns with the inertia"),)
    parameters = (ParameterPort("J", "kg*m^2", "a moment of inertia"),)
    through = ("tau",)
    is_inertia = True
    order = 2


class TorsionSpring(Branch):
    """A torsion spring k [N m/rad]; the torque ``tau`` [N m] it carries from the first node to the second."""

    type_name = "torsion_spring"
    summary = "Torsion spring"
    ports = (Port("between", 2, "rotation", "the two ends"),)
    parameters = (ParameterPort("k", "N*m/rad", "a torsional stiffness"),)
    through = ("tau",)
    compliance = "stretching"
    stiffness = "k"


class RotaryDamper(Branch):
    """A rotary damper b [N m s/rad]; it carries ``tau`` [N m] from the first node to the second."""

    type_name = "rotary_damper"
    summary = "Rotary viscous damper"
    ports = (Port("between", 2, "rotation", "the two ends"),)
    parameters = (ParameterPort("b", "N*m*s/rad", "a rotary damping coefficient"),)
    through = ("tau",)
    damping = "b"
    order = 1


class Impedance(Element):
    """Base of what is one impedance, ``value * s^order * i = v_a - v_b``; i [A] flows from a to b."""

    passive = Passivity()
    order: ClassVar[int] = 0

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the current, an unknown so that nothing is divided by an impedance, and its row."""
        a, b = use.across("between")
        current = use.unknown("i")
        impedance = use.values[self.parameters[0].name] * use.s**self.order
        denominator = impedance.denominator()
        law = LinearForm.of((current, impedance * denominator), (a, -denominator), (b, denominator))
        flow = LinearForm.of((current, use.one))
        return Stamp(
            unknowns=(current,),
            rows=(EquationRow(current, law),),
            injections=(Injection(a, flow * (-use.one)), Injection(b, flow)),
            through=(("i", flow),),
        )


class Resistor(Impedance):
    """A resistor R [Ohm]; the current ``i`` [A] flows from the first node to the second."""

    type_name = "resistor"
    summary = "Resistor"
    ports = (Port("between", 2, "electrical", "the two terminals"),)
    parameters = (ParameterPort("R", "Ohm", "a resistance"),)
    through = ("i",)


class Inductor(Impedance):
    """An inductor L [H]; the current ``i`` [A] flows from the first node to the second."""

    type_name = "inductor"
    summary = "Inductor"
    ports = (Port("between", 2, "electrical", "the two terminals"),)
    parameters = (ParameterPort("L", "H", "an inductance"),)
    through = ("i",)
    order = 1


class Capacitor(Branch):
    """A capacitor C [F]; the current ``i`` [A] flows from the first node to the second."""

    type_name = "capacitor"
    summary = "Capacitor"
    ports = (Port("between", 2, "electrical", "the two terminals"),)
    parameters = (ParameterPort("C", "F", "a capacitance"),)
    through = ("i",)
    order = 1


def _delivered(use: ElementUse, form: LinearForm) -> tuple[Injection, ...]:
    """Return what is delivered into the node, with the reaction where there is a second one."""
    signs = (use.one, -use.one)
    return tuple(Injection(n, form * sign) for n, sign in zip(use.across("at"), signs, strict=False))


class ThroughSource(Element):
    """Base of the sources whose value is what they deliver."""

    is_source = True

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute one injection, and its reaction where there is a second node."""
        (quantity,) = self.through
        form = use.forms[quantity]
        return Stamp(injections=_delivered(use, form), through=((quantity, form),))


class ForceSource(ThroughSource):
    """A force f [N] applied to a node, or between two, on the first; ``f`` is the force delivered."""

    type_name = "force_source"
    summary = "Force applied to a node"
    ports = (Port("at", 1, "translation", "node the force acts on", pair="between"),)
    parameters = (ParameterPort("f", "N", "a force", signal=True),)
    through = ("f",)


class TorqueSource(ThroughSource):
    """A torque tau [N m] applied to a node, or between two, on the first; ``tau`` is the torque delivered."""

    type_name = "torque_source"
    summary = "Torque applied to a node"
    ports = (Port("at", 1, "rotation", "node the torque acts on", pair="between"),)
    parameters = (ParameterPort("tau", "N*m", "a torque", signal=True),)
    through = ("tau",)


class CurrentSource(ThroughSource):
    """A current i [A] delivered into a node from ground, or into the first of two from the second."""

    type_name = "current_source"
    summary = "Current delivered into a node"
    ports = (Port("at", 1, "electrical", "node the current enters", pair="between"),)
    parameters = (ParameterPort("i", "A", "a current", signal=True),)
    through = ("i",)


class VoltageSource(Element):
    """A voltage v [V] of a node over ground, or over a second node; ``i`` [A] is delivered into the first."""

    type_name = "voltage_source"
    summary = "Voltage imposed on a node"
    ports = (Port("at", 1, "electrical", "node held at the voltage", pair="between"),)
    parameters = (ParameterPort("v", "V", "a voltage", signal=True),)
    through = ("i",)
    is_source = True

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the delivered current and the row ``v_node = v``."""
        current = use.unknown("i")
        flow = LinearForm.of((current, use.one))
        ends = zip(use.across("at"), (use.one, -use.one), strict=False)
        law = LinearForm.of(*ends) + use.forms["v"] * (-use.one)
        return Stamp(
            unknowns=(current,),
            rows=(EquationRow(current, law, "constraint"),),
            injections=_delivered(use, flow),
            through=(("i", flow),),
        )
