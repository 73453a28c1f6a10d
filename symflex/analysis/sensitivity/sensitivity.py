"""How one root moves with one parameter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from flint import acb, arb

from symflex.roots.precision import bits_for_digits, precision
from symflex.roots.root import GUARD_BITS, decimals
from symflex.transfer.balls import ball

if TYPE_CHECKING:
    from symflex.model import ExactValue, ModelParameter
    from symflex.roots import Root

Kind = Literal["pole", "zero"]
Status = Literal["certified", "multiple", "undecided"]

LEAST_DIGITS = 15


@dataclass(frozen=True, slots=True, eq=False)
class RootDerivative:
    """The derivative of a root with respect to a parameter."""

    kind: Kind  # ``pole`` or ``zero``
    index: int  # position of the root among the map's poles or zeros
    root: Root  # the root
    parameter: ModelParameter  # what varies
    value: ExactValue  # the parameter's value [its unit]
    # ``certified``: the derivative is proved to lie in its ball. ``multiple``: roots coincide and part when
    # the parameter changes, so that there is no derivative. ``undecided``: it could not be enclosed.
    status: Status
    place: acb  # the root, perhaps closer than in ``root`` [rad/s]
    derivative: acb | None = None  # ds/dp [rad/s per unit of the parameter]

    @property
    def relative(self) -> acb | None:
        """``(1/s) ds/dp`` [1 per unit of the parameter], ``None`` at s = 0."""
        if self.derivative is None or self.place.contains(0):
            return None
        with precision(self._bits):
            return self.derivative / self.place

    @property
    def normalised(self) -> acb | None:
        """``(p/s) ds/dp``, the relative change of the root per relative change of the parameter.

        Its real part is that of the natural frequency; ``None`` at s = 0.
        """
        relative = self.relative
        if relative is None:
            return None
        with precision(self._bits):
            return relative * self.exact_value()

    @property
    def frequency(self) -> arb | None:
        """df/dp of the natural frequency ``f = abs(s)/(2 pi)`` [Hz per unit of the parameter]."""
        relative = self.relative
        if relative is None:
            return None
        with precision(self._bits):
            return abs(self.place) * relative.real / (2 * arb.pi())

    @property
    def damping_ratio(self) -> arb | None:
        """dzeta/dp of ``zeta = -re/abs(s)`` [1 per unit of the parameter]; ``None`` for real roots.

        With s in polar coordinates zeta is minus the cosine of its angle, which turns by
        the imaginary part of (1/s) ds/dp.
        """
        relative = self.relative
        if relative is None or self.root.is_real:
            return None
        with precision(self._bits):
            return relative.imag * self.place.imag / abs(self.place)

    def exact_value(self) -> arb:
        """Return the parameter's value at the current precision."""
        return ball(self.value.rational) * arb.pi() ** self.value.pi_power

    @property
    def _bits(self) -> int:
        derivative = acb(0) if self.derivative is None else self.derivative
        return max(bits_for_digits(LEAST_DIGITS), self.place.bits(), derivative.bits()) + GUARD_BITS

    def to_json_dict(self, digits: int) -> dict[str, object]:
        """Return the sensitivity as JSON data, with at most so many digits in each number."""
        place = decimals(self.root.re, self.root.im, digits)
        return {
            "of": self.kind,
            "index": self.index,
            "re": place.re,
            "im": place.im,
            "parameter": self.parameter.name,
            "unit": self.parameter.unit,
            "status": self.status,
            "derivative": _complex_json(self.derivative, digits),
            "normalised": _complex_json(self.normalised, digits),
            "frequency_hz": _real_json(self.frequency, digits),
            "damping_ratio": _real_json(self.damping_ratio, digits),
        }


def _complex_json(value: acb | None, digits: int) -> dict[str, str] | None:
    if value is None:
        return None
    printed = decimals(value.real, value.imag, digits)
    return {"re": printed.re, "im": printed.im, "radius": printed.radius}


def _real_json(value: arb | None, digits: int) -> dict[str, str] | None:
    if value is None:
        return None
    printed = decimals(value, arb(0), digits)
    return {"value": printed.re, "radius": printed.radius}
