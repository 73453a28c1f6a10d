"""Whether a model is stable, as far as its poles say.

Input: poles that were found, and what is not proved of them. Output: a :class:`StabilityVerdict`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.roots.root import Root

ON_AXIS = "a pole lies on the imaginary axis or too close to it to be told"


@dataclass(frozen=True, slots=True)
class StabilityVerdict:
    """Whether all poles of a model, hidden modes among them, lie in the open left half plane.

    Examples
    --------
    >>> StabilityVerdict("unstable", 2, True, "", 2).sentence
    'unstable: 2 poles in the right half plane'
    >>> StabilityVerdict("unknown", None, False, "poles have no end").headline
    'stability not known'
    """

    # ``stable``; ``unstable``, with poles in the right half plane; ``marginal``, with none there, which is
    # proved, and some on the imaginary axis; ``unknown``.
    word: Literal["stable", "marginal", "unstable", "unknown"]
    # Poles in the open right half plane, with multiplicity; ``None`` where they are not all counted.
    right: int | None
    certified: bool  # the word is proved
    reason: str = ""  # what it follows from, or what is not proved. Never empty where something is not.
    found: int = 0  # poles in the right half plane that are known, at least

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

    ``roots`` are poles and hidden modes: all that are not in the open left half plane, unless ``unproved``
    says why there may be others right of the imaginary axis or on it. ``proof`` says what proves that there
    are none in the open right half plane, but maybe on the axis.

    Examples
    --------
    >>> from flint import arb
    >>> from symflex.roots.root import Root
    >>> pole = Root(arb(-1), arb(0), 1, on_imaginary_axis=False, is_real=True)
    >>> judge([pole]).sentence
    'stable'
    """
    count = count_right(roots)
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


def count_right(roots: Sequence[Root]) -> int:
    """Return how many roots are proved to lie there, with multiplicity."""
    return sum(root.multiplicity for root in roots if is_right(root))
