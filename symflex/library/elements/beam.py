"""Uniform beams in bending: with distributed mass, in any theory, and without mass."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.library.elements.element import (
    Choice,
    Element,
    ElementUse,
    EquationRow,
    Injection,
    LinearForm,
    Passivity,
    Port,
    Stamp,
)
from symflex.library.elements.line import LineElement
from symflex.library.parameter import ParameterPort

if TYPE_CHECKING:
    from collections.abc import Mapping


THEORIES = ("euler-bernoulli", "rayleigh", "timoshenko")


class Beam(LineElement):
    """A uniform beam of length l [m], cross-section A [m^2] and second moment of area I [m^4] in bending.

    Between planar nodes, the second one l further along x. ``f`` [N] and ``tau`` [N m] are the force and
    moment the beam delivers at its second end. ``eta`` [s] is Kelvin-Voigt damping (E, and G in the
    Timoshenko theory, times 1 + eta*s), ``c_f`` and ``k_f`` a viscous and an elastic foundation per
    length, ``N`` [N] an axial force, positive in tension. A slender beam (l/depth > 10) needs no more than
    the Euler-Bernoulli theory; Rayleigh adds rotary inertia, Timoshenko also shear.
    Source: Timoshenko, Young & Weaver 1974, Vibration Problems in Engineering, chapter 5.
    """

    type_name = "beam"
    summary = "Uniform beam in bending between two planar nodes"
    ports = (Port("between", 2, "planar", "the two ends, the second one l further along x"),)
    parameters = (
        ParameterPort("E", "Pa", "a modulus of elasticity", sign="positive"),
        ParameterPort("I", "m^4", "a second moment of area", sign="positive"),
        ParameterPort("rho", "kg/m^3", "a density", sign="nonnegative"),
        ParameterPort("A", "m^2", "a cross-section", sign="nonnegative"),
        ParameterPort("l", "m", "a length"),
        ParameterPort("eta", "s", "a Kelvin-Voigt loss time", "0", sign="nonnegative"),
        ParameterPort("c_f", "N*s/m^2", "a viscous foundation", "0"),
        ParameterPort("k_f", "N/m^2", "an elastic foundation", "0"),
        ParameterPort("N", "N", "an axial force", "0", only=("euler-bernoulli", "rayleigh")),
        ParameterPort("kappa", "1", "a shear coefficient", only=("timoshenko",), sign="positive"),
        ParameterPort("G", "Pa", "a shear modulus", only=("timoshenko",), sign="positive"),
    )
    choices = (Choice("theory", THEORIES, THEORIES[0], "a beam theory"),)
    through = ("f", "tau")
    ends = ("y", "theta")
    passive = Passivity()
    compliance = "bending"

    def theory(self, choices: Mapping[str, str]) -> str:
        """Return the field theory chosen."""
        return choices["theory"]


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
        one, stiffness, length = use.one, use.values["EI"], use.values["l"]
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
        return Stamp(
            unknowns=(force, moment),
            rows=(EquationRow(force, deflection), EquationRow(moment, slope)),
            injections=(
                Injection(b.y, LinearForm.of((force, one))),
                Injection(b.theta, LinearForm.of((moment, one))),
                Injection(a.y, LinearForm.of((force, -one))),
                Injection(a.theta, LinearForm.of((moment, -one), (force, -length))),
            ),
            through=(("f", LinearForm.of((force, one))), ("tau", LinearForm.of((moment, one)))),
        )
