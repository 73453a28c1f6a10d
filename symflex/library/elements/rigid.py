"""Planar rigid parts: a body with inertia, and a massless link."""

from __future__ import annotations

from symflex.library.elements.element import (
    Element,
    ElementUse,
    Injection,
    LinearForm,
    ParameterPort,
    Port,
    Row,
    Stamp,
)


class RigidBody(Element):
    """A planar body of mass m [kg] and moment of inertia J [kg m^2] about its mass centre.

    The mass centre lies cg [m] beyond the node along x, ``y_cg = y + cg*theta``. ``f`` and ``tau``
    are the inertial force [N] and moment about the node [N m].
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

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the inertial force and moment of the body."""
        (terminal,) = use.terminals["at"]
        m, inertia, cg, s = use.values["m"], use.values["J"], use.values["cg"], use.s
        force = LinearForm.of((terminal.y, m * s**2), (terminal.theta, m * cg * s**2))
        # J + m*cg^2 stays two terms: closed as one symbol it would hide that m^2*cg^2 cancels.
        moment = LinearForm.of(
            (terminal.y, m * cg * s**2), (terminal.theta, inertia * s**2), (terminal.theta, m * cg**2 * s**2)
        )
        return Stamp(
            injections=(
                Injection(terminal.y, force * (-use.one)),
                Injection(terminal.theta, moment * (-use.one)),
            ),
            through=(("f", force), ("tau", moment)),
        )


class RigidLink(Element):
    """A massless rigid link of the given length [m]: ``y_b = y_a + length*theta_a``, ``theta_b = theta_a``.

    ``f`` [N] and ``tau`` [N m] are the force and moment delivered at the second node.
    """

    type_name = "rigid_link"
    summary = "Massless rigid link between two planar nodes"
    ports = (Port("between", 2, "planar", "the two ends, the second one 'length' further along x"),)
    parameters = (ParameterPort("length", "m", "a length"),)
    through = ("f", "tau")

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the force and moment carried and the two kinematic rows."""
        a, b = use.terminals["between"]
        force, moment = use.unknown("f"), use.unknown("tau")
        one, length = use.one, use.values["length"]
        scale = length.denominator()
        return Stamp(
            unknowns=(force, moment),
            rows=(
                Row(
                    force,
                    LinearForm.of((b.y, scale), (a.y, -scale), (a.theta, -length * scale)),
                    "constraint",
                ),
                Row(moment, LinearForm.of((b.theta, one), (a.theta, -one)), "constraint"),
            ),
            injections=(
                Injection(b.y, LinearForm.of((force, one))),
                Injection(b.theta, LinearForm.of((moment, one))),
                Injection(a.y, LinearForm.of((force, -one))),
                Injection(a.theta, LinearForm.of((moment, -one), (force, -length))),
            ),
            through=(("f", LinearForm.of((force, one))), ("tau", LinearForm.of((moment, one)))),
        )
