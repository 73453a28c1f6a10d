"""A mode shape: what moves at a pole, how far, and with what bound."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from math import ceil, log2, pi
from typing import TYPE_CHECKING

from flint import acb, acb_mat, arb, arb_mat

from symflex.errors import Diagnostic, UsageError
from symflex.errors.diagnostic import nearest
from symflex.roots import precision

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from symflex.library.elements import Variable
    from symflex.roots import Root

SQUARINGS = 7
SAMPLES_PER_HALF_WAVE = 16
FEWEST_SAMPLES, MOST_SAMPLES = 32, 4096


@dataclass(frozen=True, slots=True)
class Motion:
    """What one unknown does in a mode.

    Parameters
    ----------
    name : str
        As an expression names it: ``x_tip``, ``p.theta``, ``motor.i``; ``w''(0)`` of a field at its start.
    variable : Variable
        The unknown.
    value : acb
        Its complex amplitude, enclosed.
    unit : str
        SI unit; empty for signals and fields.
    """

    name: str
    variable: Variable
    value: acb
    unit: str


@dataclass(frozen=True, slots=True)
class DistributedShape:
    """What a distributed element or field does along x.

    Parameters
    ----------
    name, kind : str
        The element's name and type; of a field, ``field``.
    states : tuple of str
        What is known along x. Of an element, displacements first, then what the part beyond x exerts on the
        part before it: ``y theta f tau`` of a beam, ``u f`` of a rod, ``theta tau`` of a shaft, ``w f`` of a
        string. Of a field, its unknowns and their derivatives: ``w w' w''``.
    matrix, load, initial : tuples of acb
        ``dz/dx = matrix z + load``, from ``initial`` on.
    start, length : arb
        Where x begins, and how far it reaches [m].
    bits : int
        The precision everything is computed at.
    """

    name: str
    kind: str
    states: tuple[str, ...]
    matrix: tuple[tuple[acb, ...], ...]
    load: tuple[acb, ...]
    initial: tuple[acb, ...]
    start: arb
    length: arb
    bits: int

    def position(self, quantity: str | None = None) -> int:
        """Return the place of a quantity among the states, of the first for None.

        Raises
        ------
        UsageError
            SF902 when there is no such quantity.
        """
        if quantity is None:
            return 0
        if quantity not in self.states:
            hint = nearest(quantity, self.states) or "available: " + ", ".join(self.states)
            message = f"there is no '{quantity[:64]}' along '{self.name}'"
            raise UsageError(Diagnostic("SF902", message, None, hint))
        return self.states.index(quantity)

    def at(self, x: Fraction) -> tuple[acb, ...]:
        """Return the state at a place x [m], enclosed."""
        with precision(self.bits):
            distance = arb(x.numerator) / x.denominator - self.start
            return self._carried(self._step(distance), self.initial)

    def state_at_share(self, share: Fraction) -> tuple[acb, ...]:
        """Return the state at a share of the length from the start, enclosed."""
        with precision(self.bits):
            return self._carried(self._step(self.length * share.numerator / share.denominator), self.initial)

    def sampled(self, intervals: int) -> Iterator[tuple[Fraction, tuple[acb, ...]]]:
        """Yield the share of the length, from 0 to 1, and the state there, at equal steps."""
        with precision(self.bits):
            step = self._step(self.length / intervals)
        state = self.initial
        for i in range(intervals + 1):
            yield Fraction(i, intervals), state
            with precision(self.bits):
                state = self._carried(step, state)

    def intervals(self) -> int:
        """Return in how many steps no wave is missed: some per half wavelength."""
        rate = self._spectral_radius() * float(self.length.mid())
        wanted = ceil(SAMPLES_PER_HALF_WAVE * rate / pi)
        return min(max(FEWEST_SAMPLES, wanted + wanted % 2), MOST_SAMPLES)

    def scaled(self, factor: acb) -> DistributedShape:
        """Return the shape with all amplitudes times a number."""
        load, initial = (tuple(x * factor for x in part) for part in (self.load, self.initial))
        return replace(self, load=load, initial=initial)

    def _step(self, distance: arb) -> list[list[acb]]:
        """Return what takes the state, and a one for the load, over a distance."""
        rows = [
            [*(x * distance for x in row), b * distance]
            for row, b in zip(self.matrix, self.load, strict=True)
        ]
        rows.append([acb(0)] * len(rows[0]))
        if all(x.imag == 0 for row in rows for x in row):
            real = arb_mat([[x.real for x in row] for row in rows]).exp().tolist()
            return [[acb(x) for x in row] for row in real]
        found: list[list[acb]] = acb_mat(rows).exp().tolist()
        return found

    @staticmethod
    def _carried(step: Sequence[Sequence[acb]], state: tuple[acb, ...]) -> tuple[acb, ...]:
        whole = (*state, acb(1))
        rows = step[: len(state)]
        return tuple(sum((a * z for a, z in zip(row, whole, strict=True)), acb(0)) for row in rows)

    def _spectral_radius(self) -> float:
        """Return about the largest spatial exponent [1/m], from a high power of the matrix."""
        with precision(self.bits):
            power, exponent = acb_mat([[x.mid() for x in row] for row in self.matrix]), 0
            for _ in range(SQUARINGS):
                power = (power * power).mid()
                size = max(float(_log2(x)) for x in power.entries())
                if size == float("-inf"):
                    return 0.0
                shift = round(size)
                power = power * acb(2) ** -shift
                exponent = 2 * exponent + shift
        return float(2.0 ** (exponent / 2**SQUARINGS))


def _log2(value: acb) -> float:
    size = value.abs_upper()
    if size == 0:
        return float("-inf")
    mantissa, exponent = size.man_exp()
    return log2(int(mantissa)) + int(exponent)


@dataclass(frozen=True, slots=True)
class ModeShape:
    """The motion of everything at one pole, up to a complex factor.

    Parameters
    ----------
    pole : Root
        Where.
    motions : tuple of Motion
        Of every unknown of the equations: nodes, forces and currents, signals, and the constants of fields.
    distributed : tuple of DistributedShape
        Of every beam, rod, shaft, string and field.
    reference : str
        What is 1: a node, or ``element(x)`` with the place along it.
    certified : bool
        The pole is proved, and the shape is the only one it has: then every ball holds the true amplitude.
    """

    pole: Root
    motions: tuple[Motion, ...]
    distributed: tuple[DistributedShape, ...]
    reference: str
    certified: bool

    @property
    def is_real(self) -> bool:
        """True when all that moves does so in phase: the pole is undamped and no motion is proved complex."""
        moving = [m.value for m in self.motions if m.unit in ("m", "rad")]
        for part in self.distributed:
            moving += [*part.initial, *part.load, *(x for row in part.matrix for x in row)]
        moving = moving or [m.value for m in self.motions]
        return self.pole.on_imaginary_axis and all(value.imag.contains(0) for value in moving)

    def motion(self, name: str) -> Motion:
        """Return what a node, element quantity or signal does.

        Raises
        ------
        UsageError
            SF902 when there is none of that name.
        """
        known = {m.name: m for m in reversed(self.motions)}
        if name not in known and f"{name}.y" in known:
            name = f"{name}.y"
        if name not in known:
            hint = nearest(name, known) or "available: " + ", ".join(list(reversed(known))[:8])
            raise UsageError(Diagnostic("SF902", f"nothing is called '{name[:64]}' in the mode", None, hint))
        return known[name]

    def along(self, name: str) -> DistributedShape:
        """Return the shape of a distributed element or field.

        Raises
        ------
        UsageError
            SF902 when there is none of that name.
        """
        known = {part.name: part for part in self.distributed}
        if name not in known:
            hint = nearest(name, known) or ("available: " + ", ".join(known) if known else None)
            message = f"'{name[:64]}' is no distributed element or field"
            raise UsageError(Diagnostic("SF902", message, None, hint))
        return known[name]
