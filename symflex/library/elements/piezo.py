"""Piezoelectric transducer."""

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
            Row(
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
