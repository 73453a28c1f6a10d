"""Dynamic colocation: up to which frequency one output moves together with another.

Input: two bound transfer functions from the same input. Output: the first frequency at which their ratio
leaves a sector of phases and magnitudes, enclosed, with proof that it does not leave before.

A tip sensor may be away from the joint actuator, and yet respond as the joint does for a finite bandwidth:
"physically noncolocated, but dynamically colocated" (Eppinger and Seering 1988).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from math import inf

from flint import acb, arb

from symflex.balls import Open, Part, branch, halved, precision
from symflex.errors import Diagnostic, ModelError, UsageError
from symflex.loops.axis import pieces
from symflex.roots import figure
from symflex.roots.root import hertz, real_json
from symflex.transfer import BoundTransferFunction

SCHEMA = "symflex.colocation/1"
BITS = 192
START_RATIO = 1.02
NARROWEST = 1e-13
MOST_INTERVALS = 200_000


@dataclass(frozen=True)
class DynamicColocation:
    """The band in which an output stays with a colocated one."""

    tf: str  # the output over the input
    reference: str  # the colocated output over it
    phase: float  # largest difference of phase [degrees]
    magnitude: float  # largest difference of magnitude [dB]
    limits: tuple[float, float]  # frequencies examined [Hz]
    edge: arb | None  # where the band ends [rad/s]; ``None`` when it does not end within the limits
    is_decided: bool  # false when the end could not be enclosed narrowly
    cause: (
        str  # ``phase`` or ``magnitude``, what is left first; empty when that is not decided, or nothing is
    )
    begins: bool  # the outputs are together at the lower limit

    def __repr__(self) -> str:
        edge = "no end found" if self.edge is None else f"up to {figure(hertz(self.edge), 6)} Hz"
        return f"<DynamicColocation {self.tf} with {self.reference}: {edge if self.begins else 'nowhere'}>"

    def to_json_dict(self) -> dict[str, object]:
        """Return the band in the schema ``symflex.colocation/1``."""
        edge = None if self.edge is None else real_json(hertz(self.edge), 15)
        return {
            "schema": SCHEMA,
            "tf": self.tf,
            "with": self.reference,
            "phase_degrees": self.phase,
            "magnitude_db": self.magnitude,
            "examined_hz": list(self.limits),
            "colocated_at_start": self.begins,
            "bandwidth_hz": edge,
            "left_by": self.cause or None,
            "certified": self.is_decided,
        }

    def __str__(self) -> str:
        """Return one line with the number and its unit."""
        within = f"within {self.phase:g} deg and {self.magnitude:g} dB"
        head = f"{self.tf} {within} of {self.reference}"
        low, high = self.limits
        status = "" if self.is_decided else ", NOT CERTIFIED"
        if not self.begins:
            return f"{head}: not at {low:.6g} Hz, where the search begins{status}"
        if self.edge is None:
            return f"{head}: from {low:.6g} Hz to {high:.6g} Hz, all that was examined"
        return f"{head}: up to {figure(hertz(self.edge), 12)} Hz, where {self.parting}{status}"

    @property
    def parting(self) -> str:
        """What happens at the end of the band, in words."""
        if self.cause:
            return f"the {self.cause} differs by more"
        return "the phase or the magnitude may differ by more"


def dynamic_colocation(
    tip: BoundTransferFunction,
    joint: BoundTransferFunction,
    phase: float = 10.0,
    magnitude: float = 1.0,
    limits: tuple[float, float] | tuple[Fraction, Fraction] | None = None,
) -> DynamicColocation:
    """Return up to which frequency an output moves with a colocated one, from the same input.

    ``phase`` is the largest difference of phase [degrees], below 90, ``magnitude`` that of magnitude [dB].
    One decibel is 12 %: a gain margin one plans with anyway; phases of undamped structures do not differ at
    all until a zero, so that magnitude is what tells them apart. ``limits`` [Hz] are by default the model's
    band.

    SF805 different inputs, outputs of different units, or tolerances out of range; SF804 no band; SF402 one
    of the functions is identically zero.
    """
    _check_comparable(tip, joint)
    if not 0 < phase < 90 or not magnitude > 0:  # noqa: PLR2004 (degrees)
        message = "the phase tolerance must be between 0 and 90 degrees, the magnitude tolerance above 0 dB"
        raise UsageError(Diagnostic("SF805", message))
    band = limits or tip.source.model.analysis.band
    if band is None:
        message = "no band of frequencies is given"
        raise UsageError(Diagnostic("SF804", message, None, "give --band LO HI, or band in [analysis]"))
    low, high = map(float, band)
    if not 0 < low < high < inf:
        message = f"a band runs from a positive to a higher frequency, not from {low:g} to {high:g} Hz"
        raise UsageError(Diagnostic("SF804", message))
    within = partial(_state, _ratio(tip, joint), phase, magnitude)
    first = _first_exit(within, low, high)
    return DynamicColocation(
        tip.name,
        joint.name,
        phase,
        magnitude,
        (low, high),
        first.edge,
        first.is_decided,
        first.cause,
        first.begins,
    )


def _check_comparable(tip: BoundTransferFunction, joint: BoundTransferFunction) -> None:
    """Refuse functions of different inputs or units, and those that are zero."""
    if tip.source.input.name != joint.source.input.name:
        message = f"{tip.name} and {joint.name} have different inputs"
        raise UsageError(Diagnostic("SF805", message, None, "compare two outputs of one input"))
    units = [bound.source.unit for bound in (tip, joint)]
    if units[0] != units[1]:
        message = f"{tip.name} is in [{units[0]}] and {joint.name} in [{units[1]}]"
        hint = 'compare outputs of one unit; an angle times its lever is a displacement: "h*phi"'
        raise UsageError(Diagnostic("SF805", message, None, hint))
    for bound in (tip, joint):
        if bound.ratio.is_zero:
            raise ModelError(Diagnostic("SF402", f"{bound.name} is identically zero"))


def _ratio(tip: BoundTransferFunction, joint: BoundTransferFunction) -> Callable[[acb], acb]:
    """Return the ratio with poles that both have cancelled, as far as their factors show."""
    if tip.ratio.ring != joint.ratio.ring:
        one, other = tip.enclosed(BITS), joint.enclosed(BITS)
        return lambda s: one(s) / other(s)
    # Numerator over numerator where the denominators are the same: no 0/0 at a resonance.
    ratio = tip.ratio / joint.ratio
    return tip.enclosed_part(ratio, BITS) if tip.kernels else replace(tip, ratio=ratio).enclosed(BITS)


@dataclass(frozen=True, slots=True)
class _Exit:
    """Where outputs part first."""

    edge: arb | None  # frequency [rad/s]; None if they do not part, or never were together
    is_decided: bool
    begins: bool  # they are together at the start
    cause: str


def _first_exit(state_on: Callable[[arb], tuple[int, str]], low: float, high: float) -> _Exit:
    """Return where outputs part first between two frequencies [Hz]."""
    with precision(BITS):
        start, end = (float((2 * arb.pi() * arb(x)).mid()) for x in (low, high))
        state, cause = state_on(arb(start))
        if state != 1:
            return _Exit(None, state == -1, begins=False, cause=cause)

        def exit_on(ends: Part) -> _Exit | Open[Part] | None:
            low, high = ends
            span = arb(low).union(arb(high))
            state, cause = state_on(span)
            if state == 1:
                return None
            if high - low < NARROWEST * high:
                # It is left within this narrow interval where the other end is outside.
                after, why = state_on(arb(high * (1 + 4 * NARROWEST)))
                return _Exit(span, after == -1, begins=True, cause=why or cause)
            return Open(ends)

        first = branch(
            pieces(start, end, START_RATIO),
            exit_on,
            halved,
            most=MOST_INTERVALS,
            until=lambda found, _: bool(found.decided),
        )
        if first.decided:
            return first.decided[0]
        if not first.undecided:
            return _Exit(None, is_decided=True, begins=True, cause="")
        span = arb(first.undecided[0][0]).union(arb(first.undecided[0][1]))
        return _Exit(span, is_decided=False, begins=True, cause=state_on(span)[1])


def _state(ratio: Callable[[acb], acb], phase: float, magnitude: float, omega: arb) -> tuple[int, str]:
    """Return 1 when a ratio is within tolerances on all of a ball, -1 when outside on all of it, else 0."""
    value = ratio(acb(0, omega))
    if not value.is_finite():
        return 0, ""
    size, most = abs(value), arb(10) ** (arb(magnitude) / 20)
    # Within the sector: abs(Im) <= tan(phase) Re.
    limit = (arb.pi() * arb(phase) / 180).tan()
    slacks = {"magnitude": (most - size).min(size - 1 / most), "phase": limit * value.real - abs(value.imag)}
    if all(slack > 0 for slack in slacks.values()):
        return 1, ""
    outside = next((name for name, slack in slacks.items() if slack < 0), "")
    return (-1 if outside else 0), outside
