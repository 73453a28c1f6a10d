"""The residue at a pole as mpmath numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import mpmath

from symflex.api.root import SHOWN_DIGITS, Root, radius_of
from symflex.roots.multiprecision import to_complex_mpmath

if TYPE_CHECKING:
    from symflex.analysis import rational as rational_room


@dataclass(frozen=True)
class Residue:
    """How much of a mode a transfer function holds: its principal part at a pole p.

    Parameters
    ----------
    principal : symflex.analysis.rational.PrincipalPart
        The enclosures.
    """

    principal: rational_room.PrincipalPart

    @property
    def pole(self) -> Root:
        """The pole p."""
        return Root(self.principal.root)

    @property
    def value(self) -> mpmath.mpc:
        """The coefficient of ``1/(s - p)``, midpoint of its enclosure; in the function's unit times rad/s."""
        return to_complex_mpmath(self.principal.value)

    @property
    def radius(self) -> mpmath.mpf:
        """A bound on the distance from :attr:`value` to the residue; if unproved, an estimate."""
        return radius_of(self.principal.value)

    @property
    def coefficients(self) -> tuple[mpmath.mpc, ...]:
        """The coefficients of ``1/(s - p)``, ``1/(s - p)^2``, ... up to the pole's multiplicity."""
        return tuple(map(to_complex_mpmath, self.principal.coefficients))

    @property
    def certified(self) -> bool:
        """Whether the pole, and with it the residue, is proved."""
        return not self.principal.is_estimate

    def __repr__(self) -> str:
        re, im = (mpmath.nstr(part, SHOWN_DIGITS) for part in (self.value.real, self.value.imag))
        return f"<Residue {re}, {im} j at {complex(self.pole):.6g}, radius {mpmath.nstr(self.radius, 2)}>"

    def __complex__(self) -> complex:
        return complex(self.value)
