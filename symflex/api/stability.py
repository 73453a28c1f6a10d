"""For which gains a loop is stable, as mpmath numbers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import mpmath
from flint import arb

from symflex.balls import to_mpmath
from symflex.print.notebook import Printed
from symflex.print.text import Passage
from symflex.roots.pole_zero_map import StabilityVerdict
from symflex.roots.root import degrees, hertz

if TYPE_CHECKING:
    from symflex import loops as stability_layer


@dataclass(frozen=True)
class StabilityBoundary:
    """A gain at which poles cross the imaginary axis.

    Parameters
    ----------
    gain : mpmath.mpf
        Middle of its enclosure, in SI units.
    radius : mpmath.mpf
        A bound on the distance from ``gain`` to the boundary.
    frequencies_hz : tuple of float
        At which poles are on the axis; empty where one passes through infinity.
    entering : int
        The change of the number of poles in the right half-plane, as the gain grows.
    """

    gain: mpmath.mpf
    radius: mpmath.mpf
    frequencies_hz: tuple[float, ...]
    entering: int

    def __repr__(self) -> str:
        where = ", ".join(f"{f:.6g} Hz" for f in self.frequencies_hz) or "infinity"
        return f"<StabilityBoundary {mpmath.nstr(self.gain, 8)}: {self.entering:+d} unstable, at {where}>"


@dataclass(frozen=True)
class Stability(Printed):
    """The gains for which all controllable and observable closed-loop poles lie in the open left half-plane.

    Parameters
    ----------
    proved : symflex.loops.StabilityMap
        The enclosures and counts.
    """

    proved: stability_layer.StabilityMap

    @property
    def certified(self) -> bool:
        """Whether everything is proved, for all poles; see :attr:`reasons` and :attr:`counted_up_to_hz`."""
        return self.proved.certified

    @property
    def reasons(self) -> tuple[str, ...]:
        """What is not proved."""
        return self.proved.reasons

    @property
    def counted_up_to_hz(self) -> float:
        """Frequency up to which poles in the right half-plane are counted [Hz]; infinite if all are."""
        end = self.proved.counted_up_to
        return float("inf") if end is None else end / (2 * float(mpmath.pi))

    @property
    def stable(self) -> tuple[tuple[mpmath.mpf, mpmath.mpf], ...]:
        """The open intervals of stable gains, in SI units; infinite ends are ``mpmath.inf``."""
        return tuple(
            (_end(interval.low, -mpmath.inf), _end(interval.high, mpmath.inf))
            for interval in self.proved.stable
        )

    @property
    def boundaries(self) -> tuple[StabilityBoundary, ...]:
        """The gains at which the number of unstable poles changes, ascending."""
        return tuple(
            StabilityBoundary(
                to_mpmath(boundary.gain),
                to_mpmath(boundary.gain.rad()),
                tuple(float(hertz(omega).mid()) for omega in boundary.frequencies),
                self.proved.change(i),
            )
            for i, boundary in enumerate(self.proved.boundaries)
        )

    @property
    def is_stable(self) -> bool | None:
        """Whether the loop is stable with the gain's declared value; ``None`` if not proved."""
        return self.proved.is_stable

    @property
    def verdict(self) -> StabilityVerdict:
        """The verdict for the gain's declared value: its ``word``, ``sentence`` and ``hidden_motion``."""
        return self.proved.verdict

    @property
    def gain_margins(self) -> tuple[mpmath.mpf, ...]:
        """Factors by which the declared gain may change until a boundary; none when it is unstable."""
        return tuple(to_mpmath(margin.factor) for margin in self.proved.gain_margins)

    @property
    def phase_margins(self) -> tuple[tuple[float, float], ...]:
        """Pairs of degrees, positive for lag, and crossover frequency [Hz]."""
        return tuple(
            (float(degrees(m.angle).mid()), float(hertz(m.frequency).mid()))
            for m in self.proved.phase_margins
        )

    @property
    def bandwidth_hz(self) -> float:
        """The gain crossover with a gain margin of 6 dB: where the loop gain first falls below one.

        It is infinite if every gain is stable. It is ``nan`` if no gain next to 0 is stable, if the loop
        gain is below one at the lowest frequencies or never, or if the loop is closed in several places. If
        the stable gains end with the range examined, it is the crossover at half of the largest one.
        """
        crossover = self.proved.crossover
        if crossover is not None and crossover.gain is None:
            return float("inf")
        if crossover is None or crossover.frequency is None:
            return float("nan")
        return float(hertz(crossover.frequency).mid())

    def to_json_dict(self) -> dict[str, object]:
        """Return the result in the schema ``symflex.stability/1``."""
        return self.proved.to_json_dict()

    def passages(self) -> Iterator[Passage]:
        """Return stable ranges, boundaries, counts and margins."""
        return self.proved.passages()

    def __repr__(self) -> str:
        pieces = (f"{mpmath.nstr(a, 8)} < {self.proved.gain} < {mpmath.nstr(b, 8)}" for a, b in self.stable)
        status = "certified" if self.certified else "not certified"
        return f"<Stability: {' or '.join(pieces) or 'no gain'}, {status}>"


def _end(value: arb | None, infinite: mpmath.mpf) -> mpmath.mpf:
    if value is None:
        return infinite
    # Where poles of the open loop lie on the axis, 0 is the end, up to the radius of its enclosure.
    return mpmath.mpf(0) if value.contains(0) else to_mpmath(value)
