"""Lumped elements of two terminals: what moves, turns, conducts, carries sound or heat, and sources."""

from __future__ import annotations

from typing import ClassVar

from symflex.library import ParameterPort
from symflex.library.elements.element import (
    LOSS_FACTOR,
    THROUGH_NAME,
    Element,
    ElementUse,
    LinearForm,
    Passivity,
    Port,
    Stamp,
    delivered,
    determined,
    difference,
    two_terminal,
)


class Lumped(Element):
    """Base of what carries one quantity, that of the domain of its one port."""

    def __init_subclass__(cls) -> None:
        """Name the quantity."""
        cls.through = tuple(THROUGH_NAME[p.domain] for p in getattr(cls, "ports", ()))


class Branch(Lumped):
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
    is_inertia = True
    order = 2


class Spring(Branch):
    """A spring k [N/m]; the force ``f`` [N] it carries from the first node to the second."""

    type_name = "spring"
    summary = "Translational spring"
    ports = (Port("between", 2, "translation", "the two ends"),)
    parameters = (ParameterPort("k", "N/m", "a stiffness"), LOSS_FACTOR)
    compliance = "stretching"
    stiffness = "k"


class Damper(Branch):
    """A damper b [N s/m]; the force ``f`` [N] it carries from the first node to the second."""

    type_name = "damper"
    summary = "Translational viscous damper"
    ports = (Port("between", 2, "translation", "the two ends"),)
    parameters = (ParameterPort("b", "N*s/m", "a damping coefficient"),)
    damping = "b"
    order = 1


class Inertia(Branch):
    """A moment of inertia J [kg m^2] at a rotational node; its inertial torque [N m] is ``tau``."""

    type_name = "inertia"
    summary = "Rotational inertia"
    ports = (Port("at", 1, "rotation", "node that turns with the inertia"),)
    parameters = (ParameterPort("J", "kg*m^2", "a moment of inertia"),)
    is_inertia = True
    order = 2


class TorsionSpring(Branch):
    """A torsion spring k [N m/rad]; the torque ``tau`` [N m] it carries from the first node to the second."""

    type_name = "torsion_spring"
    summary = "Torsion spring"
    ports = (Port("between", 2, "rotation", "the two ends"),)
    parameters = (ParameterPort("k", "N*m/rad", "a torsional stiffness"), LOSS_FACTOR)
    compliance = "stretching"
    stiffness = "k"


class RotaryDamper(Branch):
    """A rotary damper b [N m s/rad]; it carries ``tau`` [N m] from the first node to the second."""

    type_name = "rotary_damper"
    summary = "Rotary viscous damper"
    ports = (Port("between", 2, "rotation", "the two ends"),)
    parameters = (ParameterPort("b", "N*m*s/rad", "a rotary damping coefficient"),)
    damping = "b"
    order = 1


class Impedance(Lumped):
    """Base of what is one impedance, ``value * s^order * flow = v_a - v_b``; the flow is from a to b."""

    passive = Passivity()
    order: ClassVar[int] = 0

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the current, an unknown so that nothing is divided by an impedance, and its row."""
        (quantity,) = self.through
        current = use.unknown(quantity)
        impedance = use.values[self.parameters[0].name] * use.s**self.order
        denominator = impedance.denominator()
        law = LinearForm.of((current, impedance * denominator)) + difference(use, "between", -denominator)
        return determined(use, "between", quantity, law, -use.one)


class Resistor(Impedance):
    """A resistor R [Ohm]; the current ``i`` [A] flows from the first node to the second."""

    type_name = "resistor"
    summary = "Resistor"
    ports = (Port("between", 2, "electrical", "the two terminals"),)
    parameters = (ParameterPort("R", "Ohm", "a resistance"),)


class Inductor(Impedance):
    """An inductor L [H]; the current ``i`` [A] flows from the first node to the second."""

    type_name = "inductor"
    summary = "Inductor"
    ports = (Port("between", 2, "electrical", "the two terminals"),)
    parameters = (ParameterPort("L", "H", "an inductance"),)
    order = 1


class Capacitor(Branch):
    """A capacitor C [F]; the current ``i`` [A] flows from the first node to the second."""

    type_name = "capacitor"
    summary = "Capacitor"
    ports = (Port("between", 2, "electrical", "the two terminals"),)
    parameters = (ParameterPort("C", "F", "a capacitance"),)
    order = 1


class ThroughSource(Lumped):
    """Base of the sources whose value is what they deliver."""

    is_source = True

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute one injection, and its reaction where there is a second node."""
        (quantity,) = self.through
        form = use.forms[quantity]
        return Stamp(injections=delivered(use, "at", form), through=((quantity, form),))


class ForceSource(ThroughSource):
    """A force ``f`` [N] on a node, or on the first of two nodes, with its reaction on the second."""

    type_name = "force_source"
    summary = "Force applied to a node"
    ports = (Port("at", 1, "translation", "node the force acts on", pair="between"),)
    parameters = (ParameterPort("f", "N", "a force", signal=True),)


class TorqueSource(ThroughSource):
    """A torque ``tau`` [N m] on a node, or on the first of two nodes, with its reaction on the second."""

    type_name = "torque_source"
    summary = "Torque applied to a node"
    ports = (Port("at", 1, "rotation", "node the torque acts on", pair="between"),)
    parameters = (ParameterPort("tau", "N*m", "a torque", signal=True),)


class CurrentSource(ThroughSource):
    """A current i [A] delivered into a node from ground, or into the first of two from the second."""

    type_name = "current_source"
    summary = "Current delivered into a node"
    ports = (Port("at", 1, "electrical", "node the current enters", pair="between"),)
    parameters = (ParameterPort("i", "A", "a current", signal=True),)


class AcrossSource(Lumped):
    """Base of the sources whose value is what they impose."""

    is_source = True

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute what flows, and the row ``v_node = v``."""
        (quantity,), (imposed,) = self.through, self.parameters
        law = difference(use, "at", use.one) + use.forms[imposed.name] * (-use.one)
        return determined(use, "at", quantity, law, use.one, "constraint")


class VoltageSource(AcrossSource):
    """A voltage v [V] between a node and ground or a second node; ``i`` [A] is delivered into the first."""

    type_name = "voltage_source"
    summary = "Voltage imposed on a node"
    ports = (Port("at", 1, "electrical", "node held at the voltage", pair="between"),)
    parameters = (ParameterPort("v", "V", "a voltage", signal=True),)


class AcousticMass(Impedance):
    """The mass of air in a port or tube, ``p_a - p_b = M*s*q``; ``q`` [m^3/s] flows from a to b.

    ``M = rho*l/A`` [kg/m^4] for a tube of length l and section A; for a liquid, it is called an inertance.
    Source: Beranek 1954, Acoustics, chapter 5.
    """

    type_name = "acoustic_mass"
    summary = "Air in a port or tube; inertance of a liquid"
    ports = (Port("between", 2, "acoustic", "the two ends"),)
    parameters = (ParameterPort("M", "kg/m^4", "an acoustic mass"),)
    order = 1


class AcousticResistance(Impedance):
    """A mesh, slit or orifice, ``p_a - p_b = R*q``; the flow ``q`` [m^3/s] goes from a to b.

    Source: Beranek 1954, Acoustics, chapter 5.
    """

    type_name = "acoustic_resistance"
    summary = "Mesh, slit or orifice in a flow"
    ports = (Port("between", 2, "acoustic", "the two ends"),)
    parameters = (ParameterPort("R", "Pa*s/m^3", "an acoustic resistance"),)


class AcousticCompliance(Branch):
    """The air in a box, or an accumulator, ``q = C*s*p``; the flow ``q`` [m^3/s] goes into it.

    ``C = V/(rho*c^2)`` [m^3/Pa] for a volume V of a gas or liquid in which sound travels at c. Source:
    Beranek 1954, Acoustics, chapter 5.
    """

    type_name = "acoustic_compliance"
    summary = "Air in a box; accumulator or compressed liquid"
    ports = (Port("at", 1, "acoustic", "node of its pressure"),)
    parameters = (ParameterPort("C", "m^3/Pa", "an acoustic compliance"),)
    order = 1


class FlowSource(ThroughSource):
    """A volume flow q [m^3/s] delivered into a node, or into the first of two from the second."""

    type_name = "flow_source"
    summary = "Volume flow delivered into a node"
    ports = (Port("at", 1, "acoustic", "node the flow enters", pair="between"),)
    parameters = (ParameterPort("q", "m^3/s", "a volume flow", signal=True),)


class PressureSource(AcrossSource):
    """A pressure p [Pa] at a node, or between two nodes; ``q`` [m^3/s] is delivered into the first."""

    type_name = "pressure_source"
    summary = "Pressure imposed on a node"
    ports = (Port("at", 1, "acoustic", "node held at the pressure", pair="between"),)
    parameters = (ParameterPort("p", "Pa", "a pressure", signal=True),)


class ThermalResistance(Impedance):
    """A wall or contact that conducts heat, ``T_a - T_b = R*phi``; ``phi`` [W] flows from a to b."""

    type_name = "thermal_resistance"
    summary = "Wall, contact or convection that heat flows through"
    ports = (Port("between", 2, "thermal", "the two sides"),)
    parameters = (ParameterPort("R", "K/W", "a thermal resistance"),)


class ThermalCapacity(Branch):
    """The heat capacity C [J/K] of a body, ``phi = C*s*T``; the heat flow ``phi`` [W] goes into it."""

    type_name = "thermal_capacity"
    summary = "Body that stores heat"
    ports = (Port("at", 1, "thermal", "node of its temperature", pair="between"),)
    parameters = (ParameterPort("C", "J/K", "a heat capacity"),)
    order = 1


class HeatSource(ThroughSource):
    """A heat flow phi [W] delivered into a node, or into the first of two from the second."""

    type_name = "heat_source"
    summary = "Heat flow delivered into a node"
    ports = (Port("at", 1, "thermal", "node that is heated", pair="between"),)
    parameters = (ParameterPort("phi", "W", "a heat flow", signal=True),)


class TemperatureSource(AcrossSource):
    """A temperature T [K] at a node, or between two; ``phi`` [W] is delivered into the first."""

    type_name = "temperature_source"
    summary = "Temperature imposed on a node"
    ports = (Port("at", 1, "thermal", "node held at the temperature", pair="between"),)
    parameters = (ParameterPort("T", "K", "a temperature", signal=True),)
