"""Uniform Euler-Bernoulli beam without mass."""

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
            rows=(Row(force, deflection), Row(moment, slope)),
            injections=(
                Injection(b.y, LinearForm.of((force, one))),
                Injection(b.theta, LinearForm.of((moment, one))),
                Injection(a.y, LinearForm.of((force, -one))),
                Injection(a.theta, LinearForm.of((moment, -one), (force, -length))),
            ),
            through=(("f", LinearForm.of((force, one))), ("tau", LinearForm.of((moment, one)))),
        )
