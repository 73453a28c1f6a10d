"""Supports: fixed, slider and pin. Their reactions are unknowns that the elimination removes first."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.library.elements.element import (
    THROUGH_NAME,
    Element,
    ElementUse,
    Injection,
    LinearForm,
    Port,
    Row,
    Stamp,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from symflex.library.elements.element import Placing, Variable


def _hold(use: ElementUse, held: tuple[tuple[str, Variable | None], ...]) -> Stamp:
    """Return the stamp that keeps each variable at zero; the quantity is the reaction on the node."""
    kept = [(use.unknown(quantity), quantity, variable) for quantity, variable in held]
    return Stamp(
        unknowns=tuple(reaction for reaction, _, _ in kept),
        rows=tuple(Row(reaction, LinearForm.of((v, use.one)), "constraint") for reaction, _, v in kept),
        injections=tuple(Injection(v, LinearForm.of((reaction, use.one))) for reaction, _, v in kept),
        through=tuple((quantity, LinearForm.of((reaction, use.one))) for reaction, quantity, _ in kept),
    )


class Fixed(Element):
    """Everything at the node is zero; ``f``, ``tau`` or ``i`` is the reaction delivered to the node."""

    type_name = "fixed"
    summary = "Support: the node does not move (planar: y = 0 and theta = 0)"
    ports = (Port("at", 1, "whole", "node that is held"),)
    through = ("f", "tau", "i")

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

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute the reaction force and the row ``y = 0``."""
        (terminal,) = use.terminals["at"]
        return _hold(use, (("f", terminal.y),))
