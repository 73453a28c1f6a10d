"""Poles and zeros as mpmath numbers, and what a user may call a mode by."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import mpmath

from symflex import roots as roots_room
from symflex.roots import HiddenRoot, precision
from symflex.roots import Root as CertifiedRoot
from symflex.roots.multiprecision import to_complex_mpmath, to_mpmath

if TYPE_CHECKING:
    from flint import acb

SHOWN_DIGITS = 12
RADIUS_BITS = 64


def radius_of(ball: acb) -> mpmath.mpf:
    """Return an upper bound on the distance from the midpoint to any point of a ball, in the ball's unit.

    Examples
    --------
    >>> from flint import acb, arb
    >>> round(float(radius_of(acb(arb(1, 3), arb(0, 4)))), 6)
    5.0
    """
    with precision(RADIUS_BITS):
        return to_mpmath((ball.real.rad() ** 2 + ball.imag.rad() ** 2).sqrt().upper())


@dataclass(frozen=True)
class Root:
    """A root s [rad/s].

    Parameters
    ----------
    certified_root : symflex.roots.Root
        The enclosure and what was proved about it.
    """

    certified_root: roots_room.Root

    @property
    def re(self) -> mpmath.mpf:
        """Real part [rad/s], midpoint of its enclosure; exactly zero on the imaginary axis."""
        return to_mpmath(self.certified_root.re)

    @property
    def im(self) -> mpmath.mpf:
        """Imaginary part [rad/s]; exactly zero for a real root."""
        return to_mpmath(self.certified_root.im)

    @property
    def value(self) -> mpmath.mpc:
        """The midpoint of the enclosure [rad/s], with all its digits whatever the working precision.

        Arithmetic with it rounds to ``mpmath.mp.dps`` digits, as mpmath does; see ``mpmath.workdps``.
        """
        return to_complex_mpmath(self.certified_root.enclosure())

    @property
    def radius(self) -> mpmath.mpf:
        """A bound on the distance from :attr:`value` to the root [rad/s]."""
        return radius_of(self.certified_root.enclosure())

    @property
    def multiplicity(self) -> int:
        """How often the root counts."""
        return self.certified_root.multiplicity

    @property
    def certified(self) -> bool:
        """False when several roots could not be told apart inside the enclosure, or nothing is proved."""
        return self.certified_root.certified

    @property
    def on_imaginary_axis(self) -> bool:
        """True when the real part is proved to be zero."""
        return self.certified_root.on_imaginary_axis

    @property
    def is_real(self) -> bool:
        """True when the imaginary part is proved to be zero."""
        return self.certified_root.is_real

    @property
    def frequency_hz(self) -> float:
        """Natural frequency abs(s)/(2 pi) [Hz]."""
        return self.certified_root.frequency_hz()

    @property
    def damping_ratio(self) -> float | None:
        """``-re/abs(s)``, None at the origin."""
        return self.certified_root.damping_ratio()

    def __repr__(self) -> str:
        printed = self.certified_root.decimal(SHOWN_DIGITS)
        times = f", {self.multiplicity} times" if self.multiplicity > 1 else ""
        return f"<Root {printed.re}, {printed.im} j{times}, radius {printed.radius}>"

    def __complex__(self) -> complex:
        return complex(self.re, self.im)


Mode = int | Root | CertifiedRoot | HiddenRoot


def plain_mode(mode: Mode) -> int | CertifiedRoot:
    """Return a mode as :mod:`symflex.analysis.modes` takes it: its number, or its root.

    Examples
    --------
    >>> plain_mode(2)
    2
    """
    if isinstance(mode, Root):
        return mode.certified_root
    return mode.root if isinstance(mode, HiddenRoot) else mode


@dataclass(frozen=True, slots=True)
class PoleZeroMap(roots_room.PoleZeroMap):
    """Poles, zeros and hidden modes; in a notebook, a table. See :class:`symflex.roots.PoleZeroMap`."""

    @staticmethod
    def of(found: roots_room.PoleZeroMap) -> PoleZeroMap:
        """Return the face of a map."""
        return PoleZeroMap(*(getattr(found, field.name) for field in fields(found)))

    def _repr_html_(self) -> str:
        from symflex.print.html import roots_html  # only notebooks ask

        return roots_html(self)
