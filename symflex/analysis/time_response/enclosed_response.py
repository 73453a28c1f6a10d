"""A response in time: enclosed values of an output at given times."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from operator import sub
from typing import TYPE_CHECKING

import numpy as np
from flint import arb

from symflex.errors import Diagnostic, UsageError
from symflex.roots.root import RootDecimals, decimals

if TYPE_CHECKING:
    import numpy.typing as npt

    from symflex.analysis.time_response.modal import PartialSum

SCHEMA = "symflex.respond/1"
INTEGRATIONS = {"impulse": 0, "step": 1, "ramp": 2}
"""Of the unit impulse, until it is the input."""
UP = 1 + 2.0**-40
"""Makes up for rounding when the radius of a ball becomes a double."""
LARGEST_POWER = 100_000
LARGEST = arb(10) ** LARGEST_POWER
"""Values beyond it are refused: their decimals take minutes, and nobody reads them."""
SHORTER = "ask for a shorter time"


@dataclass(frozen=True, slots=True)
class ImpulseAt:
    """An impulse in a response, or a derivative of one: it has a weight, and no value."""

    time: arb  # [s]
    order: int  # 0 for an impulse, 1 for its derivative, and so on
    weight: arb  # enclosure, in the output's unit times seconds to the power of order + 1


@dataclass(frozen=True, slots=True)
class JumpAt:
    """A time at which a response jumps, a front that arrives; what rises is the value."""

    time: arb  # [s]
    height: arb  # of the value after it over that before


@dataclass(frozen=True, eq=False)
class EnclosedResponse:
    """What an output does after t = 0, the system being at rest before, when an input of unit size begins.

    Where it jumps it has two values: that at t = 0 is the limit from above, and the ball of one at a later
    jump holds both sides.

    Parameters
    ----------
    tf : str
        ``"OUT/IN"``.
    input : str
        ``impulse``, ``step`` or ``ramp``; ``forced``, or a file's name, of an input given by samples.
    unit : str
        Of the output, for an input of one of its units (for an impulse times a second, for a ramp per
        second); empty when unknown.
    times : array of float, shape (n,)
        [s].
    enclosures : tuple of flint.arb, n of them
        The value at each time lies in its ball, where ``certified``.
    impulses : tuple of ImpulseAt
        Impulses that the response holds besides values, up to the last time; with them it is a distribution.
    jumps : tuple of JumpAt
        Where the values jump, after t = 0 and up to the last time.
    certified : bool
        Whether every value is proved to lie in its ball.
    reason : str or None
        What is not proved.
    digits : int
        Digits asked for, of the largest value.
    shaper : str or None
        The kind of shaper that the input went through.
    modes : PartialSum or None
        The proved sum over modes that it is, at any time, where it was found so.
    method : str
        What found it, such as ``partial fractions`` or ``passive modes``; empty where nothing is to be found.
    """

    tf: str
    input: str
    unit: str
    times: npt.NDArray[np.float64]
    enclosures: tuple[arb, ...]
    impulses: tuple[ImpulseAt, ...] = ()
    jumps: tuple[JumpAt, ...] = ()
    certified: bool = True
    reason: str | None = None
    digits: int = 12
    shaper: str | None = None
    modes: PartialSum | None = field(default=None, repr=False)
    method: str = ""

    def __post_init__(self) -> None:
        huge = next(
            (t for t, y in zip(self.times, self.enclosures, strict=False) if y.abs_lower() > LARGEST), None
        )
        if huge is not None:
            message = f"the response of {self.tf} is beyond 10^{LARGEST_POWER} from {huge:g} s on"
            raise UsageError(Diagnostic("SF812", message, None, SHORTER))

    @cached_property
    def _doubles(self) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        values = np.array(list(map(float, self.enclosures)), dtype=np.float64)  # of midpoints
        if (huge := np.flatnonzero(~np.isfinite(values))).size:
            message = (
                f"the response of {self.tf} is beyond the range of doubles from {self.times[huge[0]]:g} s on"
            )
            raise UsageError(Diagnostic("SF812", message, None, SHORTER))
        off = map(arb.abs_upper, map(sub, self.enclosures, values.tolist()))
        radius = np.array(list(map(float, off)), dtype=np.float64) * UP
        for array in (values, radius):
            array.setflags(write=False)
        return values, radius

    @property
    def title(self) -> str:
        """What it is, such as ``step response``."""
        shaped = f", shaped by {self.shaper.upper()}" if self.shaper else ""
        plain = f"{self.input} response" if self.input in INTEGRATIONS else f"response to {self.input}"
        return plain + shaped

    @property
    def values(self) -> npt.NDArray[np.float64]:
        """The values, in ``unit``; UsageError SF812 where one is too large for a double."""
        return self._doubles[0]

    @property
    def radius(self) -> npt.NDArray[np.float64]:
        """How far each value may be off, what rounding to doubles takes away among it."""
        return self._doubles[1]

    def told(self, ball: arb) -> RootDecimals:
        """Return a number in decimals, as ``re`` with its ``radius``."""
        return decimals(ball, arb(0), self.digits)

    def to_json_dict(self) -> dict[str, object]:
        """Return the response as ``symflex respond --json`` prints it."""
        told = [self.told(y) for y in self.enclosures]
        document: dict[str, object] = {
            "schema": SCHEMA,
            "tf": self.tf,
            "input": self.input,
            "unit": self.unit,
            "certified": self.certified,
            "time": self.times.tolist(),
            "value": [t.re for t in told],
            "radius": [t.radius for t in told],
            "impulses": [
                {"time": self.told(i.time).re, "order": i.order, "weight": self.told(i.weight).re}
                for i in self.impulses
            ],
            "jumps": [{"time": self.told(j.time).re, "height": self.told(j.height).re} for j in self.jumps],
        }
        document |= {"shaper": self.shaper} if self.shaper else {}
        return document if self.reason is None else {**document, "reason": self.reason}

    def to_csv(self) -> str:
        """Return a table of times, values and radii, with a header."""
        heads = [f"# tf: {self.tf}", f"# input: {self.input}", f"# unit: {self.unit or 'unknown'}"]
        heads += [f"# shaper: {self.shaper}"] if self.shaper else []
        if not self.certified:
            heads.append(f"# not certified: {self.reason}")
        told = [self.told(y) for y in self.enclosures]
        rows = [f"{t!r},{d.re},{d.radius}" for t, d in zip(self.times.tolist(), told, strict=True)]
        return "\n".join([*heads, "time_s,value,radius", *rows]) + "\n"
