"""What turns electricity into motion: permanent-magnet motors and piezoelectric transducers."""

from __future__ import annotations

from symflex.library.elements.element import (
    Element,
    ElementUse,
    EquationRow,
    Injection,
    LinearForm,
    Passivity,
    Port,
    Stamp,
)
from symflex.library.parameter import ParameterPort


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
    passive = Passivity(of_any_sign=("k_t", "k_e"), equal=("k_t", "k_e"))
    moves_as_one = True

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
            rows=(EquationRow(current, law),),
            injections=(
                Injection(a, flow * (-use.one)),
                Injection(b, flow),
                Injection(shaft, torque),
            ),
            through=(("i", flow), ("tau", torque)),
        )


class Piezo(Element):
    """A piezoelectric stack, linear: a voltage pushes its ends apart, and their motion drives a charge.

    With v the voltage of the first terminal over the second and x_a, x_b the displacements of the ends,
    ``f = alpha*v + k*(x_a - x_b)`` [N] pushes the second end, with its reaction on the first, and
    ``i = C*s*v - alpha*s*(x_a - x_b)`` [A] flows from the first terminal to the second. alpha [N/V] equals
    C/m, or A*s/m; C [F] is the capacitance with the ends held, k [N/m] the stiffness with the terminals
    short-circuited. Charge sensitivity d [m/V] is alpha/k, and the open-circuit voltage per extension alpha/C
    [V/m]. Source: Preumont 2006, Mechatronics, chapter 4.
    """

    type_name = "piezo"
    summary = "Piezoelectric transducer between electrical terminals and two ends"
    ports = (
        Port("terminals", 2, "electrical", "the two electrical terminals"),
        Port("between", 2, "translation", "the two ends, the second one further along x"),
    )
    parameters = (
        ParameterPort("alpha", "N/V", "a transduction coefficient"),
        ParameterPort("C", "F", "a capacitance", "0"),
        ParameterPort("k", "N/m", "a stiffness", "0"),
    )
    through = ("f", "i")

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the force and the current, and their rows."""
        (p, q), (a, b) = use.across("terminals"), use.across("between")
        alpha, one = use.values["alpha"], use.one
        force, current = use.unknown("f"), use.unknown("i")
        laws = (
            (force, alpha, use.values["k"]),
            (current, use.values["C"] * use.s, alpha * use.s * -1),
        )
        rows = tuple(
            EquationRow(
                out,
                LinearForm.of((out, one), (p, -per_volt), (q, per_volt), (a, -per_metre), (b, per_metre)),
            )
            for out, per_volt, per_metre in laws
        )
        delivered = ((a, force, -one), (b, force, one), (p, current, -one), (q, current, one))
        return Stamp(
            unknowns=(force, current),
            rows=rows,
            injections=tuple(Injection(node, LinearForm.of((v, sign))) for node, v, sign in delivered),
            through=tuple((v.component, LinearForm.of((v, one))) for v in (force, current)),
        )
