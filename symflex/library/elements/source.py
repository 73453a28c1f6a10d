"""Ideal sources; the value may be an expression of signals, inputs and nodes."""

from __future__ import annotations

from symflex.library.elements.element import (
    Element,
    ElementUse,
    EquationRow,
    Injection,
    LinearForm,
    Port,
    Stamp,
)
from symflex.library.parameter import ParameterPort


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
