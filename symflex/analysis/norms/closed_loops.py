"""Several loops that are closed at once, from as many outputs to as many inputs, each with minus.

Input: the verdicts on the model as it is and with all loops closed, and the functions of S, T and S - T,
a row per loop. Output: :class:`ClosedLoops`.

    S = (I + L)^-1,    T = L (I + L)^-1

det(I + L) is the characteristic function of the closed loops over that of the open ones. Along the
imaginary axis, and a half circle on the right, it encircles 0 clockwise as often as the first has more zeros
inside than the second (the generalised Nyquist criterion, MacFarlane and Postlethwaite 1977). Both are
counted with proof. Where the largest singular value of ``(S - T)/2`` is below ``1/alpha``, every loop may
have a factor of its own in the disk of alpha, all at once (Seiler, Packard and Gahinet 2020).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from flint import arb

from symflex.analysis.norms.matrix_peak import (
    DIGITS,
    SINGULAR,
    find_matrix_peak,
    matrix_on_axis,
    peak_on_axis,
)
from symflex.errors import ModelError, UncertifiedError
from symflex.loops.peak import LoopPeaks, Peak
from symflex.print.notebook import Printed
from symflex.print.text import INDENT, Passage
from symflex.roots.pole_zero_map import StabilityVerdict
from symflex.transfer import AnyBoundFunction

SCHEMA = "symflex.closed_loops/1"
NAMES = ("S", "T", "S - T")
SHARES, TIMES = (1, 0, 0.5), (1, 1, 2)  # of 1 that T is taken less, and of what that is
Rows = Sequence[Sequence[AnyBoundFunction]]


@dataclass(frozen=True)
class ClosedLoops(Printed):
    """Whether loops are stable together, and how far from being unstable."""

    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    open: StabilityVerdict  # of the model as it is
    closed: StabilityVerdict  # with all loops closed
    peaks: LoopPeaks | None  # of matrices; None where closed loops are not stable
    reason: str = ""  # why peaks are not known

    @property
    def encirclements(self) -> int | None:
        """How often det(I + L) encircles 0 clockwise; None where a count is not proved, or 0 is met."""
        if self.closed.right is None or self.open.right is None or self.closed.word == "marginal":
            return None
        return self.closed.right - self.open.right

    @property
    def certified(self) -> bool:
        """Whether the verdict, the number of encirclements and the peaks are certified."""
        is_known = self.closed.certified and self.open.right is not None and not self.reason
        return is_known and all(peak.certified for peak in self._peaks)

    @property
    def _peaks(self) -> tuple[Peak, ...]:
        found = self.peaks
        return () if found is None else (found.sensitivity, found.complementary_sensitivity, found.balanced)

    def passages(self) -> Iterator[Passage]:
        """Return the verdict, the encirclements, and the peaks with the margin that they leave."""
        status = "certified" if self.certified else "NOT CERTIFIED"
        loops = ", ".join(f"{u} = -{y}" for y, u in zip(self.outputs, self.inputs, strict=True))
        lines = [f"{loops}   {status}", f"{INDENT}closed loops: {self.closed.sentence}"]
        right = "not counted" if self.open.right is None else self.open.right
        lines.append(f"{INDENT}poles of open loops in the right half-plane: {right}")
        if (count := self.encirclements) is not None:
            side = "counterclockwise" if count < 0 else "clockwise"
            times = "does not encircle 0" if count == 0 else f"encircles 0 {abs(count)} times {side}"
            lines.append(f"{INDENT}det(I + L) {times}".replace(" 1 times ", " once "))
        if self.reason:
            lines.append(f"{INDENT}no margins: {self.reason}")
        yield Passage(lines)
        if self.peaks is not None:
            said = [
                f"{INDENT}largest singular values; the disk margin holds for factors of all loops at once"
            ]
            said += [f"{INDENT}not proved of {p.tf}: {reason}" for p in self._peaks for reason in p.reasons]
            yield Passage(said, [*self.peaks.rows])

    def to_json_dict(self) -> dict[str, object]:
        """Return the loops in the schema ``symflex.closed_loops/1``, ready for :func:`json.dumps`."""
        return {
            "schema": SCHEMA,
            "outputs": list(self.outputs),
            "inputs": list(self.inputs),
            "certified": self.certified,
            "stability": self.closed.word,
            "closed_right": self.closed.right,
            "open_right": self.open.right,
            "encirclements": self.encirclements,
            "peaks": self.peaks and self.peaks.to_json_dict(),
            "reason": self.reason or None,
        }


def closed_loops(
    ends: tuple[Sequence[str], Sequence[str]],
    verdicts: tuple[StabilityVerdict, StabilityVerdict],
    rows: Sequence[Rows],
) -> ClosedLoops:
    """Return what is known of loops from the verdicts, open and closed, and the functions S, T and S - T."""
    found = ClosedLoops(tuple(ends[0]), tuple(ends[1]), *verdicts, None)
    if found.closed.word != "stable":
        return found
    try:
        peaks = _peaks(rows)
    except (ModelError, UncertifiedError) as error:
        return replace(found, reason=error.diagnostics[0].message)
    return replace(found, peaks=LoopPeaks(peaks[0], peaks[1], peaks[2], None))


def _peaks(rows: Sequence[Rows]) -> list[Peak]:
    """Return the peaks of S, T and S - T: of T less a share of 1, whose entries fall off where loops do.

    ``S = -(T - 1)`` and ``S - T = -2 (T - 1/2)``. Where T does not fall off, S may.
    """
    _, complementary, _ = rows
    try:
        matrix = matrix_on_axis(complementary, keeps_delays=True)
    except (ModelError, UncertifiedError):
        return [
            replace(find_matrix_peak(own), tf=name, unit="") for own, name in zip(rows, NAMES, strict=True)
        ]
    places, peaks = range(len(complementary)), list[Peak]()
    for own, name, share, times in zip(rows, NAMES, SHARES, TIMES, strict=True):
        constant = tuple(tuple(arb(share * (i == j)) for j in places) for i in places)
        asked = Peak(name, "", DIGITS, None, arb("inf"), (), what=SINGULAR)
        found = peak_on_axis(replace(matrix, constant=constant), asked)
        peak = replace(found, magnitude=times * found.magnitude)
        other = peak if peak.certified else replace(find_matrix_peak(own), tf=name, unit="")
        peaks.append(other if other.certified else peak)
    return peaks
