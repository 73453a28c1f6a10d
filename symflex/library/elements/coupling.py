"""What couples ports: gears, levers and gyrators of any domains, motors and piezoelectric transducers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.library import ParameterPort
from symflex.library.elements.element import (
    ACROSS_UNIT,
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

    from symflex.library.elements.element import Placing, Variable


class TwoPort(Element):
    """Base of what joins two nodes of any domains, and is named after what it delivers at ``to``."""

    ports = (
        Port("from", 1, "any", "node of the driving side"),
        Port("to", 1, "any", "node of the driven side"),
    )
    through = ("f", "tau", "i")

    def quantities(self, domains: Mapping[str, Placing]) -> tuple[str, ...]:
        """Return the quantity delivered at ``to``."""
        return (THROUGH_NAME[domains["to"]],)


class Transformer(TwoPort):
    """A gear, rack, screw, lever or electrical transformer: ``to = ratio * from``.

    The across variables (displacement [m], angle [rad], voltage [V]) are in the given ratio;
    the force, torque or current delivered at ``to`` is drawn ``ratio`` times at ``from``, so no
    power is lost. ``f``, ``tau`` or ``i`` (by the domain of ``to``) is what is delivered at ``to``.
    """

    type_name = "transformer"
    summary = "Gear, rack, screw, lever or electrical transformer: to = ratio * from"
    parameters = (ParameterPort("ratio", "", "a transformer ratio"),)
    passive = Passivity(of_any_sign=("ratio",))
    moves_as_one = True

    def unit_of(self, quantity: str, domains: Mapping[str, Placing]) -> str:
        """Return the ratio's unit, that of ``to`` over that of ``from``."""
        if quantity == "ratio":
            target, source = ACROSS_UNIT[domains["to"]], ACROSS_UNIT[domains["from"]]
            return "1" if target == source else f"{target}/{source}"
        return super().unit_of(quantity, domains)

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the through variable at ``to`` and the row ``to - ratio*from = 0``."""
        (source,), (target,) = use.across("from"), use.across("to")
        quantity = THROUGH_NAME[use.domains["to"]]
        through = use.unknown(quantity)
        ratio = use.values["ratio"]
        denominator, numerator = ratio.denominator(), ratio * ratio.denominator()
        # The unknown is the through variable over the ratio's denominator: both sides stay polynomial.
        law = LinearForm.of((target, denominator), (source, -numerator))
        delivered = LinearForm.of((through, denominator))
        return Stamp(
            unknowns=(through,),
            rows=(EquationRow(through, law, "constraint"),),
            injections=(
                Injection(target, delivered),
                Injection(source, LinearForm.of((through, -numerator))),
            ),
            through=((quantity, delivered),),
        )


class Gyrator(TwoPort):
    """A lossless crossing: ``effort_from = ratio*flow_to``, ``effort_to = ratio*flow_from``.

    Effort is force [N], torque [N m] or voltage [V]; flow is velocity [m/s, rad/s] or current [A].
    Power drawn at ``from`` is delivered at ``to``. The quantity named by the domain of ``to``
    (``f``, ``tau``, ``i``) is what is delivered there.
    """

    type_name = "gyrator"
    summary = "Gyrator: effort at one port proportional to flow at the other"
    parameters = (ParameterPort("ratio", "", "a gyrator ratio"),)
    passive = Passivity(of_any_sign=("ratio",))
    moves_as_one = True

    def unit_of(self, quantity: str, domains: Mapping[str, Placing]) -> str:
        """Return the ratio's unit, effort at ``from`` over flow at ``to``."""
        if quantity == "ratio":
            effort = {"translation": "N", "rotation": "N*m", "electrical": "V"}[domains["from"]]
            per_flow = {"translation": "*s/m", "rotation": "*s/rad", "electrical": "/A"}[domains["to"]]
            return effort + per_flow
        return super().unit_of(quantity, domains)

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the through variables of both ports and the two crossing rows."""
        (source,), (target,) = use.across("from"), use.across("to")
        ratio = use.values["ratio"]
        denominator, numerator = ratio.denominator(), ratio * ratio.denominator()
        quantity = THROUGH_NAME[use.domains["to"]]
        drawn, delivered = use.unknown("drawn"), use.unknown(quantity)
        effort_from = source if use.domains["from"] == "electrical" else drawn
        effort_to = target if use.domains["to"] == "electrical" else delivered
        flow_from = self._flow(use, "from", source, drawn)
        flow_to = self._flow(use, "to", target, delivered)
        rows = (
            EquationRow(
                drawn, LinearForm.of((effort_from, denominator)) + flow_to * (-numerator), "constraint"
            ),
            EquationRow(
                delivered, LinearForm.of((effort_to, denominator)) + flow_from * (-numerator), "constraint"
            ),
        )
        return Stamp(
            unknowns=(drawn, delivered),
            rows=rows,
            injections=(
                Injection(source, LinearForm.of((drawn, -use.one))),
                Injection(target, LinearForm.of((delivered, use.one))),
            ),
            through=((quantity, LinearForm.of((delivered, use.one))),),
        )

    @staticmethod
    def _flow(use: ElementUse, port: str, across: Variable | None, through: Variable) -> LinearForm:
        if use.domains[port] == "electrical":
            return LinearForm.of((through, use.one))
        return LinearForm.of((across, use.s))


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
