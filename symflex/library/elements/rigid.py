"""Planar parts: a body with inertia, a rigid link and a beam without mass, supports (fixed, slider, pin).

Reactions of supports are unknowns that the elimination removes first.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from symflex.library import ParameterPort
from symflex.library.elements.element import (
    COMPONENTS,
    LOSS_FACTOR,
    THROUGH_NAME,
    Element,
    ElementUse,
    EquationRow,
    Injection,
    LinearForm,
    Passivity,
    Port,
    PortTerminal,
    Stamp,
)

if TYPE_CHECKING:
    from symflex.algebra import Factored
    from symflex.library.elements.element import Placing, Variable


class RigidBody(Element):
    """A planar body of mass m [kg] and moment of inertia J [kg m^2] about its mass centre.

    The mass centre lies cg [m] beyond the node along x, ``y_cg = y + cg*theta``. ``f`` and ``tau`` are the
    inertial force [N] and moment about the node [N m]. If the node moves along x, the mass moves with it,
    and ``f_x`` is the inertial force along x.
    """

    type_name = "rigid_body"
    summary = "Planar rigid body with offset mass centre"
    ports = (Port("at", 1, "planar", "node the body is attached at"),)
    parameters = (
        ParameterPort("m", "kg", "a mass"),
        ParameterPort("J", "kg*m^2", "a moment of inertia", "0"),
        ParameterPort("cg", "m", "a distance", "0"),
    )
    through = ("f", "tau")
    passive = Passivity(of_any_sign=("cg",))
    is_inertia = True

    def quantities(self, domains: Mapping[str, Placing]) -> tuple[str, ...]:
        """Return the inertial forces, by what the node is."""
        return _with_x(self.through, domains["at"])

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the inertial force and moment of the body."""
        (terminal,) = use.terminals["at"]
        m, inertia, cg, s = use.values["m"], use.values["J"], use.values["cg"], use.s
        force = LinearForm.of((terminal.y, m * s**2), (terminal.theta, m * cg * s**2))
        # J + m*cg^2 stays two terms: closed as one symbol it would hide that m^2*cg^2 cancels.
        moment = LinearForm.of(
            (terminal.y, m * cg * s**2), (terminal.theta, inertia * s**2), (terminal.theta, m * cg**2 * s**2)
        )
        # To first order the mass centre moves along x as the node does.
        force_x = LinearForm.of((terminal.x, m * s**2))
        forces = {"f": (terminal.y, force), "tau": (terminal.theta, moment), "f_x": (terminal.x, force_x)}
        offered = [(name, *forces[name]) for name in self.quantities(use.domains)]
        return Stamp(
            injections=tuple(Injection(node, form * (-use.one)) for _, node, form in offered),
            through=tuple((name, form) for name, _, form in offered),
        )


def _with_x(quantities: tuple[str, ...], domain: Placing) -> tuple[str, ...]:
    """Return what a planar part offers, with the force along x where its nodes move along x."""
    return (*quantities, "f_x") if domain == "plane" else quantities


class RigidLink(Element):
    """A massless rigid link of the given length [m], at an angle [rad] from the x axis.

    ``y_b = y_a + length*cos(angle)*theta_a`` and ``theta_b = theta_a``; if its nodes move along x, also
    ``x_b = x_a - length*sin(angle)*theta_a``. ``f`` [N] and ``tau`` [N m] are the force and moment
    delivered at the second node, ``f_x`` [N] the force along x.
    """

    type_name = "rigid_link"
    summary = "Massless rigid link between two planar nodes"
    ports = (Port("between", 2, "planar", "the two ends, the second one 'length' further in its direction"),)
    parameters = (
        ParameterPort("length", "m", "a length"),
        ParameterPort("angle", "rad", "an angle from the x axis", "0", is_direction=True),
    )
    through = ("f", "tau")
    passive = Passivity(of_any_sign=("length", "angle"))
    moves_as_one = True
    carries_x = True

    def quantities(self, domains: Mapping[str, Placing]) -> tuple[str, ...]:
        """Return what is delivered at the second node, by what the nodes are."""
        return _with_x(self.through, domains["between"])

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the force and moment carried and the kinematic rows."""
        a, b = use.terminals["between"]
        force, moment, along = use.unknown("f"), use.unknown("tau"), use.unknown("f_x")
        one = use.one
        reach, rise = (use.values["length"] * use.values[name] for name in ("cos", "sin"))
        slope = LinearForm.of((b.theta, one), (a.theta, -one))
        rows = (
            EquationRow(force, _offset(a.y, b.y, a.theta, reach), "constraint"),
            EquationRow(moment, slope, "constraint"),
        )
        carried = _carried(use, reach, rows)
        if use.domains["between"] != "plane":
            return carried
        flow = LinearForm.of((along, one))
        return Stamp(
            unknowns=(*carried.unknowns, along),
            rows=(*carried.rows, EquationRow(along, _offset(a.x, b.x, a.theta, -rise), "constraint")),
            injections=(
                *carried.injections,
                Injection(b.x, flow),
                Injection(a.x, flow * (-one)),
                Injection(a.theta, flow * rise),
            ),
            through=(*carried.through, ("f_x", flow)),
        )


def _offset(a: Variable | None, b: Variable | None, theta: Variable | None, lever: Factored) -> LinearForm:
    """Return ``b - a - lever*theta`` without a denominator."""
    scale = lever.denominator()
    return LinearForm.of((b, scale), (a, -scale), (theta, -lever * scale))


class MasslessBeam(Element):
    """A massless beam of bending stiffness EI [N m^2] and length l [m].

    ``f`` [N] and ``tau`` [N m] are the force and moment the beam delivers at its second end. A force P and a
    moment M at the second end deflect it by ``(P*l^3/3 + M*l^2/2)/EI`` and turn it by ``(P*l^2/2 + M*l)/EI``,
    relative to the rigid motion of the first end. Source: Timoshenko & Gere 1972, table of beam deflections.
    """

    type_name = "massless_beam"
    summary = "Massless Euler-Bernoulli beam between two planar nodes"
    ports = (Port("between", 2, "planar", "the two ends, the second one l further along x"),)
    parameters = (
        ParameterPort("EI", "N*m^2", "a bending stiffness"),
        ParameterPort("l", "m", "a length"),
        LOSS_FACTOR,
    )
    through = ("f", "tau")
    passive = Passivity()
    compliance = "bending"
    stiffness = "EI"

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the end force and moment and the two flexibility rows."""
        a, b = use.terminals["between"]
        force, moment = use.unknown("f"), use.unknown("tau")
        stiffness, length = use.values["EI"], use.values["l"]
        # Force and moment on the beam's end are minus what the beam delivers there.
        deflection = LinearForm.of(
            (b.y, stiffness * 6),
            (a.y, stiffness * -6),
            (a.theta, stiffness * length * -6),
            (force, length**3 * 2),
            (moment, length**2 * 3),
        )
        slope = LinearForm.of(
            (b.theta, stiffness * 2), (a.theta, stiffness * -2), (force, length**2), (moment, length * 2)
        )
        return _carried(use, length, (EquationRow(force, deflection), EquationRow(moment, slope)))


def _carried(use: ElementUse, length: Factored, rows: tuple[EquationRow, ...]) -> Stamp:
    """Return the stamp of a part without mass that carries a force and a moment over its length."""
    a, b = use.terminals["between"]
    force, moment, one = use.unknown("f"), use.unknown("tau"), use.one
    return Stamp(
        unknowns=(force, moment),
        rows=rows,
        injections=(
            Injection(b.y, LinearForm.of((force, one))),
            Injection(b.theta, LinearForm.of((moment, one))),
            Injection(a.y, LinearForm.of((force, -one))),
            Injection(a.theta, LinearForm.of((moment, -one), (force, -length))),
        ),
        through=(("f", LinearForm.of((force, one))), ("tau", LinearForm.of((moment, one)))),
    )


REACTIONS = {"x": "f_x", "y": "f", "theta": "tau"}  # what holds a component of a planar node


def _hold(use: ElementUse, held: Mapping[str, str]) -> Stamp:
    """Return the stamp that keeps components of a node at zero, or at those of a second node."""
    # ``held`` gives the reaction, delivered into the (first) node, by component.
    first, *others = use.terminals["at"]
    second = others[0] if others else PortTerminal()
    kept = [(use.unknown(q), q, getattr(first, c), getattr(second, c)) for c, q in held.items()]
    one = use.one
    return Stamp(
        unknowns=tuple(reaction for reaction, *_ in kept),
        rows=tuple(
            EquationRow(reaction, LinearForm.of((a, one), (b, -one)), "constraint")
            for reaction, _, a, b in kept
        ),
        injections=tuple(
            Injection(node, LinearForm.of((reaction, sign)))
            for reaction, _, a, b in kept
            for node, sign in ((a, one), (b, -one))
        ),
        through=tuple((quantity, LinearForm.of((reaction, one))) for reaction, quantity, *_ in kept),
    )


class Fixed(Element):
    """Everything at the node is zero; ``f``, ``f_x``, ``tau`` or ``i`` is the reaction delivered to the node.

    At a component of a planar node, such as ``p.x``, only that component is held. Between two nodes it is a
    rigid joint: both move together, and the reaction is delivered to the first.
    """

    type_name = "fixed"
    summary = "Support: the node neither moves nor turns"
    ports = (Port("at", 1, "whole", "node that is held, or a component of it", pair="between"),)
    through = ("f", "tau", "f_x", "i")
    passive = Passivity()
    carries_x = True

    def quantities(self, domains: Mapping[str, Placing]) -> tuple[str, ...]:
        """Return the reactions, by what the node is."""
        return tuple(self._held(domains["at"]).values())

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute a reaction and a row per degree of freedom."""
        return _hold(use, self._held(use.domains["at"]))

    @staticmethod
    def _held(domain: Placing) -> Mapping[str, str]:
        if domain not in COMPONENTS:
            return {"across": THROUGH_NAME[domain]}
        return {c: REACTIONS[c] for c in COMPONENTS[domain]}


class Slider(Element):
    """The slope theta is zero, deflections are free; ``tau`` [N m] is the reaction.

    Between two nodes, it makes their slopes equal.
    """

    type_name = "slider"
    summary = "Support: the node moves but does not turn"
    ports = (Port("at", 1, "planar", "node whose slope is held", pair="between"),)
    through = ("tau",)
    passive = Passivity()

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the reaction torque and the row ``theta = 0``."""
        return _hold(use, {"theta": "tau"})


class Pin(Element):
    """The deflection y is zero (in the plane, x too), and the slope is free.

    ``f`` [N] is the reaction along y, ``f_x`` [N] that along x. Between two nodes it is a hinge: their
    deflections are equal, and their slopes are free.
    """

    type_name = "pin"
    summary = "Support: the node turns but does not move"
    ports = (Port("at", 1, "planar", "node whose deflection is held", pair="between"),)
    through = ("f",)
    passive = Passivity()
    carries_x = True

    def quantities(self, domains: Mapping[str, Placing]) -> tuple[str, ...]:
        """Return the reactions, by what the node is."""
        return _with_x(self.through, domains["at"])

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the reaction forces and the rows of no deflection."""
        return _hold(use, {c: REACTIONS[c] for c in COMPONENTS[use.domains["at"]] if c != "theta"})
