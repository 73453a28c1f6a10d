"""Ideal sources; the value may be an expression of signals, inputs and nodes."""

from __future__ import annotations

from symflex.elements.element import (
    Element,
    ElementUse,
    Injection,
    LinearForm,
    ParameterPort,
    Port,
    Row,
    Stamp,
)


def _through_source(use: ElementUse, quantity: str) -> Stamp:
    form = use.forms[quantity]
    return Stamp(injections=(Injection(use.across("at")[0], form),), through=((quantity, form),))


class ForceSource(Element):
    """A force f [N] applied to a node; ``f`` is the force delivered."""

    type_name = "force_source"
    summary = "Force applied to a node"
    ports = (Port("at", 1, "translation", "node the force acts on"),)
    parameters = (ParameterPort("f", "N", "a force", signal=True),)
    through = ("f",)

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute one injection."""
        return _through_source(use, "f")


class TorqueSource(Element):
    """A torque tau [N m] applied to a node; ``tau`` is the torque delivered."""

    type_name = "torque_source"
    summary = "Torque applied to a node"
    ports = (Port("at", 1, "rotation", "node the torque acts on"),)
    parameters = (ParameterPort("tau", "N*m", "a torque", signal=True),)
    through = ("tau",)

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute one injection."""
        return _through_source(use, "tau")


class CurrentSource(Element):
    """A current i [A] delivered into a node from ground."""

    type_name = "current_source"
    summary = "Current delivered into a node"
    ports = (Port("at", 1, "electrical", "node the current enters"),)
    parameters = (ParameterPort("i", "A", "a current", signal=True),)
    through = ("i",)

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute one injection."""
        return _through_source(use, "i")


class VoltageSource(Element):
    """A voltage v [V] from ground to a node; ``i`` [A] is the current it delivers into the node."""

    type_name = "voltage_source"
    summary = "Voltage imposed on a node"
    ports = (Port("at", 1, "electrical", "node held at the voltage"),)
    parameters = (ParameterPort("v", "V", "a voltage", signal=True),)
    through = ("i",)

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the delivered current and the row ``v_node = v``."""
        (node,) = use.across("at")
        current = use.unknown("i")
        flow = LinearForm.of((current, use.one))
        law = LinearForm.of((node, use.one)) + use.forms["v"] * (-use.one)
        return Stamp(
            unknowns=(current,),
            rows=(Row(current, law, "constraint"),),
            injections=(Injection(node, flow),),
            through=(("i", flow),),
        )
