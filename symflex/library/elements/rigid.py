"""Planar parts: a body with inertia, a rigid link and a beam without mass, supports (fixed, slider, pin).

Reactions of supports are unknowns that the elimination removes first.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.library import ParameterPort
from symflex.library.elements.element import (
    THROUGH_NAME,
    Element,
    ElementUse,
    EquationRow,
    Injection,
    LinearForm,
    Passivity,
    Port,
    Stamp,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from symflex.algebra import Factored
    from symflex.library.elements.element import Placing, Variable


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
    passive = Passivity(of_any_sign=("cg",))
    is_inertia = True

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
    passive = Passivity(of_any_sign=("length",))
    moves_as_one = True

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the force and moment carried and the two kinematic rows."""
        a, b = use.terminals["between"]
        force, moment = use.unknown("f"), use.unknown("tau")
        one, length = use.one, use.values["length"]
        scale = length.denominator()
        deflection = LinearForm.of((b.y, scale), (a.y, -scale), (a.theta, -length * scale))
        slope = LinearForm.of((b.theta, one), (a.theta, -one))
        rows = (EquationRow(force, deflection, "constraint"), EquationRow(moment, slope, "constraint"))
        return _carried(use, length, rows)


class MasslessBeam(Element):
    """A massless beam of bending stiffness EI [N m^2] and length l [m].

    ``f`` [N] and ``tau`` [N m] are the force and moment the beam delivers at its second end.
    Written as the flexibility of a cantilever (Timoshenko & Gere 1972, table of beam deflections),
    which keeps the rows polynomial: relative to the rigid motion of the first end, the second end
    deflects by ``(P*l^3/3 + M*l^2/2)/EI`` and turns by ``(P*l^2/2 + M*l)/EI`` under P and M applied to it.
    """

    type_name = "massless_beam"
    summary = "Massless Euler-Bernoulli beam between two planar nodes"
    ports = (Port("between", 2, "planar", "the two ends, the second one l further along x"),)
    parameters = (
        ParameterPort("EI", "N*m^2", "a bending stiffness"),
        ParameterPort("l", "m", "a length"),
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
            (b.theta, stiffness * 2),
            (a.theta, stiffness * -2),
            (force, length**2),
            (moment, length * 2),
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


def _hold(use: ElementUse, held: tuple[tuple[str, Variable | None], ...]) -> Stamp:
    """Return the stamp that keeps each variable at zero; the quantity is the reaction on the node."""
    kept = [(use.unknown(quantity), quantity, variable) for quantity, variable in held]
    return Stamp(
        unknowns=tuple(reaction for reaction, _, _ in kept),
        rows=tuple(
            EquationRow(reaction, LinearForm.of((v, use.one)), "constraint") for reaction, _, v in kept
        ),
        injections=tuple(Injection(v, LinearForm.of((reaction, use.one))) for reaction, _, v in kept),
        through=tuple((quantity, LinearForm.of((reaction, use.one))) for reaction, quantity, _ in kept),
    )


class Fixed(Element):
    """Everything at the node is zero; ``f``, ``tau`` or ``i`` is the reaction delivered to the node."""

    type_name = "fixed"
    summary = "Support: the node does not move (planar: y = 0 and theta = 0)"
    ports = (Port("at", 1, "whole", "node that is held"),)
    through = ("f", "tau", "i")
    passive = Passivity()

    def quantities(self, domains: Mapping[str, Placing]) -> tuple[str, ...]:
        """Return the reactions, by what the node is."""
        domain = domains["at"]
        return ("f", "tau") if domain == "planar" else (THROUGH_NAME[domain],)

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute a reaction and a zero row per degree of freedom."""
        (terminal,) = use.terminals["at"]
        if terminal.theta is not None:
            return _hold(use, (("f", terminal.y), ("tau", terminal.theta)))
        return _hold(use, ((THROUGH_NAME[use.domains["at"]], terminal.across),))


class Slider(Element):
    """The slope theta is zero, the deflection is free; ``tau`` [N m] is the reaction."""

    type_name = "slider"
    summary = "Support: theta = 0, y free"
    ports = (Port("at", 1, "planar", "node whose slope is held"),)
    through = ("tau",)
    passive = Passivity()

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the reaction torque and the row ``theta = 0``."""
        (terminal,) = use.terminals["at"]
        return _hold(use, (("tau", terminal.theta),))


class Pin(Element):
    """The deflection y is zero, the slope is free; ``f`` [N] is the reaction."""

    type_name = "pin"
    summary = "Support: y = 0, theta free"
    ports = (Port("at", 1, "planar", "node whose deflection is held"),)
    through = ("f",)
    passive = Passivity()

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the reaction force and the row ``y = 0``."""
        (terminal,) = use.terminals["at"]
        return _hold(use, (("f", terminal.y),))
