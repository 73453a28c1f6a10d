"""Ideal lossless couplings between two ports of any domain."""

from __future__ import annotations

from typing import TYPE_CHECKING

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
from symflex.library.parameter import ParameterPort

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
