"""A response in time: enclosed values of an output at given times."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from operator import sub

import numpy as np
import numpy.typing as npt
from flint import arb

from symflex.analysis.time_response.sampled import ImpulseAt, JumpAt, PartialSum
from symflex.errors import Diagnostic, UsageError
from symflex.print.roots import SHORT_DIGITS
from symflex.print.text import aligned, broken
from symflex.roots.root import RootDecimals, decimals, figure

SCHEMA = "symflex.respond/1"
INTEGRATIONS = {"impulse": 0, "step": 1, "ramp": 2}  # how often the unit impulse is integrated
FREE = "free"  # the name of no input
OF_UNIT_SIZE = (*INTEGRATIONS, FREE)
UP = 1 + 2.0**-40  # makes up for rounding when the radius of a ball becomes a double
LARGEST_POWER = 100_000
LARGEST = arb(10) ** LARGEST_POWER  # what is beyond is refused: its decimals take minutes
SHORTER = "ask for a shorter time"
ROWS = 21  # rows of the table; all points are in the JSON and in files
NARROWEST = 99  # digits to which a radius in the table goes, or those asked for: 1e-2913 is below 1e-99
IMPULSES = ("an impulse", "the derivative of an impulse")


@dataclass(frozen=True, eq=False)
class EnclosedResponse:
    """What an output does after t = 0 when an input of unit size begins, from rest or from ``initial``.

    Where it jumps it has two values: that at t = 0 is the limit from the right, and the ball of one at a
    later jump contains both sides.

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
        Impulses in the response besides the values, up to the last time; with them it is a distribution.
    jumps : tuple of JumpAt
        Where the values jump, after t = 0 and up to the last time.
    certified : bool
        Whether every value is proved to lie in its ball.
    reason : str or None
        What is not proved.
    digits : int
        Requested digits of the largest value.
    shaper : str or None
        The kind of shaper that the input went through.
    modes : PartialSum or None
        The proved sum over modes, at any time, if the response was found as one.
    method : str
        The method that found it, such as ``partial fractions`` or ``passive modes``; empty if there was none.
    initial : str
        Initial values of states, such as ``x = 1 mm``.
    refused : tuple of str
        If it is not certified: the methods that would prove it, and why each refused.
    measured : (str, array of float) or None
        Name and values, at the same times, of an output that was measured with this input.
    offset : float
        What was subtracted from them: the mean of their difference from the response.
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
    initial: str = ""
    refused: tuple[str, ...] = ()
    measured: tuple[str, npt.NDArray[np.float64]] | None = None
    offset: float = 0.0

    def __post_init__(self) -> None:
        huge = next(
            (t for t, y in zip(self.times, self.enclosures, strict=False) if y.abs_lower() > LARGEST), None
        )
        if huge is not None:
            message = f"the response of {self.tf} exceeds 10^{LARGEST_POWER} from {huge:g} s on"
            raise UsageError(Diagnostic("SF812", message, None, SHORTER))

    @cached_property
    def _doubles(self) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        values = np.array(list(map(float, self.enclosures)), dtype=np.float64)  # of midpoints
        if (huge := np.flatnonzero(~np.isfinite(values))).size:
            message = (
                f"the response of {self.tf} exceeds the range of doubles from {self.times[huge[0]]:g} s on"
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
        plain = f"{self.input} response" if self.input in OF_UNIT_SIZE else f"response to {self.input}"
        return plain + shaped + (f" from {self.initial}" if self.initial else "")

    @property
    def values(self) -> npt.NDArray[np.float64]:
        """The values, in ``unit``; UsageError SF812 where one is too large for a double."""
        return self._doubles[0]

    def compared(self, name: str, measured: npt.NDArray[np.float64]) -> EnclosedResponse:
        """Return the response with a measured output, less the offset that brings it closest."""
        offset = float(np.mean(measured - self.values))
        return replace(self, measured=(name, measured - offset), offset=offset)

    @property
    def rms_difference(self) -> float:
        """The rms of the measured output less the values, zero if nothing was measured."""
        off = self.measured[1] - self.values if self.measured else 0.0
        return float(np.sqrt(np.mean(np.square(off))))

    @property
    def comparison(self) -> str:
        """The rms difference between measured output and values, in words; empty if nothing was measured."""
        if self.measured is None:
            return ""
        name, record = self.measured
        off, size = self.rms_difference, float(np.sqrt(np.mean(np.square(record))))
        unit = f" {self.unit}" if self.unit else ""
        words = f"measured {name} less the model: rms {off:.4g}{unit}, where {name} has {size:.4g}"
        return f"{words}; an offset of {self.offset:.4g} is subtracted"

    @property
    def radius(self) -> npt.NDArray[np.float64]:
        """How far each value may be off, rounding to doubles included."""
        return self._doubles[1]

    def in_decimals(self, ball: arb) -> RootDecimals:
        """Return a number in decimals, as ``re`` with its ``radius``."""
        return decimals(ball, arb(0), self.digits)

    def _json(self, name: str, ball: arb) -> dict[str, object]:
        shown = self.in_decimals(ball)
        return {name: shown.re, f"{name}_radius": shown.radius}

    def to_json_dict(self) -> dict[str, object]:
        """Return the response as ``symflex respond --json`` prints it."""
        shown = [self.in_decimals(y) for y in self.enclosures]
        document: dict[str, object] = {
            "schema": SCHEMA,
            "tf": self.tf,
            "input": self.input,
            "unit": self.unit,
            "certified": self.certified,
            "time": self.times.tolist(),
            "value": [t.re for t in shown],
            "radius": [t.radius for t in shown],
            "impulses": [
                {**self._json("time", i.time), "order": i.order, **self._json("weight", i.weight)}
                for i in self.impulses
            ],
            "jumps": [self._json("time", j.time) | self._json("height", j.height) for j in self.jumps],
        }
        document |= {"shaper": self.shaper} if self.shaper else {}
        document |= {"initial": self.initial} if self.initial else {}
        if self.measured is not None:
            record = {"output": self.measured[0], "value": self.measured[1].tolist()}
            document["measured"] = {**record, "rms_difference": self.rms_difference, "offset": self.offset}
        return document if self.reason is None else {**document, "reason": self.reason}

    def to_csv(self) -> str:
        """Return a table of times, values and radii, with a header."""
        heads = [f"# tf: {self.tf}", f"# input: {self.input}", f"# unit: {self.unit or 'unknown'}"]
        heads += [f"# shaper: {self.shaper}"] if self.shaper else []
        heads += [f"# initial: {self.initial}"] if self.initial else []
        if not self.certified:
            heads.append(f"# not certified: {self.reason}")
        shown = [self.in_decimals(y) for y in self.enclosures]
        rows = [f"{t!r},{d.re},{d.radius}" for t, d in zip(self.times.tolist(), shown, strict=True)]
        names = "time_s,value,radius"
        if self.measured is not None:
            heads.append(f"# measured: {self.measured[0]}, less an offset of {self.offset:.9g}")
            names += ",measured"
            pairs = zip(rows, self.measured[1].tolist(), strict=True)
            rows = [f"{row},{value:.9g}" for row, value in pairs]
        return "\n".join([*heads, names, *rows]) + "\n"


def response_text(response: EnclosedResponse, notes: Sequence[str] = ()) -> str:
    """Return a response as the command line prints it, with notes between its head and its table."""
    unit = f" [{response.unit}]" if response.unit else ""
    trust = "certified" if response.certified else f"NOT CERTIFIED: {response.reason}"
    head = [
        f"{response.tf}   {response.title}{unit}, {trust}",
        *(f"  not by {why}" for why in response.refused),
    ]
    lines = [*(piece for line in head for piece in broken(line)), ""]
    if response.impulses:
        lines += [f"  {_impulse(response, impulse)}" for impulse in response.impulses[:ROWS]]
        lines += _more(response.impulses)
    if response.jumps:
        lines += [f"  jumps by {_short(j.height)} at {_short(j.time)} s" for j in response.jumps[:ROWS]]
        lines += _more(response.jumps)
    lines += [piece for note in notes for piece in broken(f"  {note}")]
    lines += [""] if response.impulses or response.jumps or notes else []
    count = len(response.enclosures)
    step = max(1, -(-(count - 1) // (ROWS - 1)))
    rows = [("t [s]", "value", "radius" if response.certified else "est. error")]
    for i in range(0, count, step):
        rows.append((f"{response.times[i]:.12g}", *_columns(response.enclosures[i], response.digits)))
    lines += aligned(rows, "  ")
    if step > 1:
        lines += ["", f"  every {step} of {count} points; --json and -o FILE.csv have them all"]
    return "\n".join(lines)


def _columns(ball: arb, digits: int) -> tuple[str, str]:
    shown = decimals(ball, arb(0), digits).readable
    exponent, narrowest = int(shown.radius.partition("e-")[2] or 0), max(NARROWEST, digits)
    return shown.re, shown.radius if exponent <= narrowest else f"1.0e-{narrowest}"


def _short(ball: arb) -> str:
    return figure(ball, SHORT_DIGITS)


def _impulse(response: EnclosedResponse, impulse: ImpulseAt) -> str:
    order = impulse.order
    what = IMPULSES[order] if order < len(IMPULSES) else f"derivative {order} of an impulse"
    return f"also, at {_short(impulse.time)} s, {what} of weight {_short(impulse.weight)}"


def _more(shown: Sequence[object]) -> list[str]:
    return [f"  and {len(shown) - ROWS} more"] if len(shown) > ROWS else []
