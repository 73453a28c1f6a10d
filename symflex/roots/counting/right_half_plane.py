"""Poles in the right half plane, wherever they lie: how many there are, and whether a model is stable.

Input: poles that were found, or a function with kernels whose roots are to be counted. Output: a
:class:`StabilityVerdict`, and the roots right of the imaginary axis.

The roots of polynomials are all known. Of a function with kernels the closed right half plane is searched up
to a radius beyond which one of its terms outweighs all others, see :mod:`~symflex.roots.counting.tail`; a
certified count about the half disc says how many roots it holds, and only where there are some they are
searched. A passive model has none, by its energy.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import log, pi
from typing import TYPE_CHECKING, Literal

from flint import acb

from symflex.errors import BudgetError
from symflex.roots.counting.tail import right_tail
from symflex.roots.counting.winding import RootOnPathError
from symflex.roots.distributed.side import Side
from symflex.roots.region import Rectangle

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.algebra import Factored
    from symflex.budget import Budget
    from symflex.roots.root import Root
    from symflex.transfer import BoundTransferFunction

PASSIVE = "passive, energy is nowhere supplied"
ACCUMULATING = "poles accumulate in the right half plane"
DEGENERATE = "a root where wavenumbers meet may be no pole"
NOT_COUNTED = "the poles right of the imaginary axis could not be counted"
ON_AXIS = "a pole lies on the imaginary axis or too close to it to be told"
WAVES = 10.0
"""Largest argument of a kernel up to which poles are counted where no end of them is known."""
MARGIN = 1.01
"""How far beyond the radius of a tail the path runs, so that its corners meet no root."""


@dataclass(frozen=True, slots=True)
class StabilityVerdict:
    """Whether all poles of a model, hidden modes among them, lie in the open left half plane.

    Parameters
    ----------
    word : str
        ``stable``; ``unstable``, with poles in the right half plane; ``marginal``, with none there, which is
        proved, and some on the imaginary axis; ``unknown``.
    right : int or None
        Poles in the open right half plane, with multiplicity; ``None`` where they are not all counted.
    certified : bool
        The word is proved.
    reason : str
        What it follows from, or what is not proved. Never empty where something is not.
    found : int
        Poles in the right half plane that are known, at least.

    Examples
    --------
    >>> StabilityVerdict("unstable", 2, True, "", 2).sentence
    'unstable: 2 poles in the right half plane'
    >>> StabilityVerdict("unknown", None, False, "poles have no end").headline
    'stability not known'
    """

    word: Literal["stable", "marginal", "unstable", "unknown"]
    right: int | None
    certified: bool
    reason: str = ""
    found: int = 0

    def __post_init__(self) -> None:
        if not self.reason and (not self.certified or self.right is None):
            message = "what is not proved needs a reason"
            raise ValueError(message)

    @property
    def sentence(self) -> str:
        """What stands at the head of a list of poles."""
        if self.word == "unknown":
            return f"stability not known: {self.reason}"
        if self.word == "unstable":
            least = "" if self.right is not None else "at least "
            poles = "1 pole" if self.found == 1 else f"{self.found} poles"
            said = f"unstable: {least}{poles} in the right half plane"
            return f"{said}; {self.reason}" if self.reason else said
        said = "marginal, not asymptotically stable" if self.word == "marginal" else self.word
        return f"{said}: {self.reason}" if self.reason else said

    @property
    def headline(self) -> str:
        """The verdict and the number of poles, without what it follows from."""
        return self.sentence.removesuffix(self.reason).rstrip(":; ") if self.found else self.brief

    @property
    def brief(self) -> str:
        """The verdict in a word or two."""
        return "stability not known" if self.word == "unknown" else self.word

    def to_json_dict(self) -> dict[str, object]:
        """Return the verdict as JSON data."""
        return {
            "verdict": self.word,
            "right_half_plane": self.right,
            "certified": self.certified,
            "reason": self.reason,
            "right_half_plane_found": self.found,
        }


NOT_EXAMINED = StabilityVerdict("unknown", None, certified=False, reason="not examined")


def is_right(root: Root) -> bool:
    """Tell whether a root is proved to lie in the open right half plane."""
    return bool(root.re > 0)


def judge(roots: Sequence[Root], unproved: str = "", proof: str = "") -> StabilityVerdict:
    """Return the verdict that known poles allow.

    Parameters
    ----------
    roots : sequence of Root
        Poles and hidden modes; all that are not in the open left half plane, unless ``unproved`` says why
        not.
    unproved : str
        Why there may be others right of the imaginary axis or on it.
    proof : str
        What proves that there are none in the open right half plane, but maybe on the axis.

    Examples
    --------
    >>> from flint import arb
    >>> from symflex.roots.root import Root
    >>> pole = Root(arb(-1), arb(0), 1, on_imaginary_axis=False, is_real=True)
    >>> judge([pole]).sentence
    'stable'
    """
    count = _count(roots)
    unclear = any(root.re.contains(0) and not root.on_imaginary_axis for root in roots)
    if count:
        if unclear:
            unproved = unproved or ON_AXIS
        return StabilityVerdict("unstable", None if unproved else count, True, unproved, count)
    on_axis = [root for root in roots if root.on_imaginary_axis]
    if on_axis:
        where = "poles on the imaginary axis"
        if all(root.is_zero for root in on_axis):
            times = sum(root.multiplicity for root in on_axis)
            where = "a pole at 0" if times == 1 else f"{times} poles at 0"
        if unproved and not proof:  # a pole that grows may lie beyond what was counted
            return StabilityVerdict("unknown", None, False, f"{where}; {unproved}")
        return StabilityVerdict("marginal", 0, True, f"{where}; {proof}" if proof else where)
    if proof:
        return StabilityVerdict("stable", 0, True, f"{proof}; {unproved}" if unproved else proof)
    if unproved or unclear:
        return StabilityVerdict("unknown", None, False, unproved or ON_AXIS)
    return StabilityVerdict("stable", 0, True)


@dataclass(frozen=True, slots=True)
class RightHalfPlane:
    """The roots of one function in the right half plane.

    Parameters
    ----------
    roots : tuple of Root
        Those found, on the imaginary axis too.
    unproved : str
        Why there may be others; empty where there are none.
    """

    roots: tuple[Root, ...]
    unproved: str = ""


def search_right(
    bound: BoundTransferFunction,
    part: Factored,
    side: Side,
    known: Sequence[Root],
    reached: float,
    digits: int,
    budget: Budget,
) -> RightHalfPlane:
    """Count the roots of a function with kernels right of the imaginary axis, and find them.

    Parameters
    ----------
    bound, part : BoundTransferFunction, Factored
        The function.
    side : Side
        The same, perhaps searched elsewhere.
    known : sequence of Root
        Those found already, anywhere, proved.
    reached : float
        Up to which abs(s) all roots are known [rad/s]; 0 where that is not so.
    digits : int
        Significant digits of every root.
    budget : Budget
        Of the search.
    """
    if side.is_finite:
        return RightHalfPlane(tuple(known))
    if any(hole.right < pi / 2 for hole in side.holes):
        return RightHalfPlane(tuple(known), ACCUMULATING)
    radius, unproved = _end(side, reached)
    # Roots mirror each other in the axis, and a path along it would meet them.
    is_mirrored = bool(unproved) and side.function.is_even
    if is_mirrored and radius <= reached:
        return RightHalfPlane(tuple(known), _up_to(unproved, reached))
    count: int | None = None
    try:
        count = None if is_mirrored else side.count_right(log(radius * MARGIN))
    except RootOnPathError:
        pass
    except BudgetError as error:
        # Where no end is known, more was looked at than what was asked for.
        said = _up_to(unproved, reached) if unproved else error.diagnostics[0].message
        return RightHalfPlane(tuple(known), said)
    seen = [root for root in known if root.re.contains(0) or is_right(root)]
    if count is None or count != _count(seen):
        limit = Fraction(radius)
        region = Rectangle(Fraction(0), limit, -limit, limit)
        again = Side(bound, part, digits, budget)
        try:
            again.search(region)
            # Roots of lossless systems lie on the border, and beyond what was asked for it is not followed.
            proof = None if is_mirrored else again.prove(region)
        except BudgetError as error:
            more = f"{count} are counted, and not all found: " if count else ""
            said = _up_to(unproved, reached) if is_mirrored else more + error.diagnostics[0].message
            return RightHalfPlane(tuple(known), said)
        seen = [root for root in again.roots if root.re.contains(0) or is_right(root)]
        if proof is None:
            return RightHalfPlane(tuple(seen), _up_to(unproved, reached))
        if not proof.is_complete if count is None else _count(seen) != count:
            said = _up_to(unproved, reached) if unproved else proof.reason or NOT_COUNTED
            return RightHalfPlane(tuple(seen), said)
    return RightHalfPlane(tuple(seen), unproved and _up_to(unproved, radius))


def _end(side: Side, reached: float) -> tuple[float, str]:
    """Return how far roots are to be counted [rad/s], and why there may be others beyond."""
    start, radius = side.function.frequency_of(1.0), 0.0
    for factor, exponent in side.function.part.factors:
        if exponent > 0:
            tail = right_tail(side.function.bound, (factor,), (acb(1),), start)
            if tail.radius is None:
                return max(reached, side.function.frequency_of(WAVES)), tail.reason
            radius = max(radius, tail.radius)
    return radius, ""


def _count(roots: Sequence[Root]) -> int:
    return sum(root.multiplicity for root in roots if is_right(root))


def _up_to(reason: str, radius: float) -> str:
    """Say how far poles are known."""
    return f"known up to {radius / (2 * pi):.4g} Hz only: {reason}" if radius > 0 else reason
