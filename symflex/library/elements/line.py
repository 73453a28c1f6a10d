"""Distributed two-ports: the state at the second end follows from the state at the first."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from symflex.library.elements.element import Element, ElementUse, EquationRow, Injection, LinearForm, Stamp

if TYPE_CHECKING:
    from collections.abc import Mapping

    from symflex.algebra import Factored
    from symflex.library.elements.element import PortTerminal, Variable


class LineElement(Element):
    """A uniform one-dimensional element between two nodes, governed by a field theory.

    Its state along x holds the across quantities first, in the order of ``ends``, then as many through
    quantities, in the order of ``through``: what the part beyond x exerts on the part before it. So the
    element delivers the through state at x = 0 into its first node and minus the through state at x = l
    into its second. ``f`` [N] and ``tau`` [N m] are what it delivers at its second end.

    Attributes
    ----------
    length : str
        Name of the parameter that is the length.
    ends : tuple of str
        The across components of a terminal: ``("y", "theta")`` of a planar one, else ``("across",)``.
    """

    length: ClassVar[str] = "l"
    ends: ClassVar[tuple[str, ...]]

    @property
    def along(self) -> tuple[tuple[str, ...], ...]:
        """What its state is called at a point, ``arm.y(l/2)``: each quantity by all its names, in order.

        ``f`` and ``tau`` at a point are what the part beyond it exerts on the part before it.
        """
        domain = self.ports[0].domain
        across = {"planar": (("y",), ("theta",)), "rotation": (("theta",),)}.get(domain, (("u", "y"),))
        return (*across, *((quantity,) for quantity in self.through))

    def theory(self, choices: Mapping[str, str]) -> str:
        """Return the name of the field theory, a key of the registry of theories: the element's own."""
        del choices
        return self.type_name.replace("_", "-")

    def stamp(self, use: ElementUse) -> Stamp:
        """Contribute what is delivered at both ends and one row per state, ``z(l) = T*z(0)``, T entire in s.

        Of a beam: the unknowns ``f_a``, ``tau_a`` (delivered at the first end), ``f`` and ``tau`` (delivered
        at the second), and four rows.
        """
        one = use.one
        a, b = use.terminals["between"]
        first = self._delivered_first(use)
        second = [use.unknown(quantity) for quantity in self.through]
        state_a = self.initial_state(use)
        state_b = self.final_state(use)
        unknowns = (*first, *second)
        rows = [
            EquationRow(about, LinearForm.of(end, *((v, -c) for v, c in zip(state_a, line, strict=True))))
            for about, end, line in zip(unknowns, state_b, use.transmission, strict=True)
        ]
        delivered = [*zip(self._across(a), first, strict=True), *zip(self._across(b), second, strict=True)]
        return Stamp(
            unknowns=unknowns,
            rows=tuple(rows),
            injections=tuple(Injection(node, LinearForm.of((v, one))) for node, v in delivered),
            through=tuple((v.component, LinearForm.of((v, one))) for v in second),
        )

    def initial_state(self, use: ElementUse) -> tuple[Variable | None, ...]:
        """Return the unknowns that are the state at x = 0, None where it is held to zero."""
        return (*self._across(use.terminals["between"][0]), *self._delivered_first(use))

    def final_state(self, use: ElementUse) -> list[tuple[Variable | None, Factored]]:
        """Return the unknowns that are the state at x = l, each with its sign."""
        across = self._across(use.terminals["between"][1])
        return [*((v, use.one) for v in across), *((use.unknown(q), -use.one) for q in self.through)]

    def _delivered_first(self, use: ElementUse) -> list[Variable]:
        return [use.unknown(f"{quantity}_a") for quantity in self.through]

    def _across(self, terminal: PortTerminal) -> tuple[Variable | None, ...]:
        return tuple(getattr(terminal, end) for end in self.ends)
