"""Permanent-magnet direct-current motor."""

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


class DcMotor(Element):
    """A dc motor: ``(L*s + R)*i + k_e*s*theta = v_a - v_b`` and torque ``k_t*i`` on the shaft.

    ``i`` [A] flows from the first terminal to the second; ``tau`` [N m] is the torque delivered
    to the shaft. k_e [V s/rad] defaults to k_t [N m/A], to which it is equal in SI units.
    """

    type_name = "dc_motor"
    summary = "Direct-current motor with winding resistance and inductance"
    ports = (
        Port("terminals", 2, "electrical", "the two electrical terminals"),
        Port("shaft", 1, "rotation", "node of the shaft's angle"),
    )
    parameters = (
        ParameterPort("L", "H", "an inductance", "0"),
        ParameterPort("R", "Ohm", "a resistance", "0"),
        ParameterPort("k_t", "N*m/A", "a torque constant"),
        ParameterPort("k_e", "V*s/rad", "a back-emf constant", "k_t"),
    )
    through = ("i", "tau")

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the winding current, its row, and the torque on the shaft."""
        a, b = use.across("terminals")
        (shaft,) = use.across("shaft")
        current = use.unknown("i")
        winding = use.values["L"] * use.s + use.values["R"]
        law = LinearForm.of(
            (current, winding), (shaft, use.values["k_e"] * use.s), (a, -use.one), (b, use.one)
        )
        flow = LinearForm.of((current, use.one))
        torque = LinearForm.of((current, use.values["k_t"]))
        return Stamp(
            unknowns=(current,),
            rows=(Row(current, law),),
            injections=(
                Injection(a, flow * (-use.one)),
                Injection(b, flow),
                Injection(shaft, torque),
            ),
            through=(("i", flow), ("tau", torque)),
        )
