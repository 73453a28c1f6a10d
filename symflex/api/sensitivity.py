"""The derivative of a root with respect to a parameter as mpmath numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import mpmath

from symflex.api.root import SHOWN_DIGITS, Root, radius_of
from symflex.roots import decimals
from symflex.roots.multiprecision import to_complex_mpmath, to_mpmath

if TYPE_CHECKING:
    from symflex.analysis import sensitivity as sensitivity_room


@dataclass(frozen=True)
class Sensitivity:
    """How a root s moves with a parameter p; numbers are midpoints of proved enclosures.

    Parameters
    ----------
    moved : symflex.analysis.sensitivity.RootDerivative
        The enclosures.
    """

    moved: sensitivity_room.RootDerivative

    @property
    def kind(self) -> str:
        """``pole`` or ``zero``."""
        return self.moved.kind

    @property
    def root(self) -> Root:
        """The root."""
        return Root(self.moved.root)

    @property
    def parameter(self) -> str:
        """The parameter's name."""
        return self.moved.parameter.name

    @property
    def status(self) -> str:
        """``certified``, ``multiple`` (there is no derivative) or ``undecided``."""
        return self.moved.status

    @property
    def derivative(self) -> mpmath.mpc | None:
        """ds/dp [rad/s per unit of the parameter]; ``None`` where there is none."""
        return None if self.moved.derivative is None else to_complex_mpmath(self.moved.derivative)

    @property
    def radius(self) -> mpmath.mpf | None:
        """A bound on the distance from :attr:`derivative` to the true one."""
        return None if self.moved.derivative is None else radius_of(self.moved.derivative)

    @property
    def normalised(self) -> mpmath.mpc | None:
        """``(p/s) ds/dp``; its real part is ``(p/f) df/dp``. ``None`` at s = 0."""
        normalised = self.moved.normalised
        return None if normalised is None else to_complex_mpmath(normalised)

    @property
    def frequency(self) -> mpmath.mpf | None:
        """df/dp [Hz per unit of the parameter] of the natural frequency ``f = abs(s)/(2 pi)``."""
        frequency = self.moved.frequency
        return None if frequency is None else to_mpmath(frequency)

    @property
    def damping_ratio(self) -> mpmath.mpf | None:
        """dzeta/dp [1 per unit of the parameter]; ``None`` for real roots."""
        damping_ratio = self.moved.damping_ratio
        return None if damping_ratio is None else to_mpmath(damping_ratio)

    def __repr__(self) -> str:
        if self.moved.derivative is None:
            return f"<Sensitivity of a {self.kind} to {self.parameter}: {self.status}>"
        derivative = self.moved.derivative
        printed = decimals(derivative.real, derivative.imag, SHOWN_DIGITS)
        return f"<Sensitivity of a {self.kind} to {self.parameter}: {printed.re}, {printed.im} j>"
