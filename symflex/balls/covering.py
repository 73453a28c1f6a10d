"""A path in pieces short enough that something is decided on every one of them.

Input: what decides on a piece of t from 0 to 1, ``None`` if the piece is too long.
Output: the pieces, each with what was decided on it.

Example: cos(x) on [0, 3] has no sign on the whole; every piece but those about pi/2 decides.

A function that is analytic on a path is enclosed ever more sharply on halves of it, so that only what is not
true, or true by too little, is left undecided (Moore 1966).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from symflex.balls.branching import Open, branch
from symflex.balls.precision import UndecidedError

Decided = TypeVar("Decided")
Span = tuple[float, float]


def covered(
    decide: Callable[[float, float], Decided | None], parts: int, shortest: float
) -> list[tuple[float, float, Decided]]:
    """Return pieces of [0, 1] with what is decided on them, at first so many, halved until it is.

    UndecidedError where a piece would be shorter than ``shortest``.

    >>> covered(lambda a, b: "short" if b - a < 0.3 else None, 2, 0.1)
    [(0.0, 0.25, 'short'), (0.25, 0.5, 'short'), (0.5, 0.75, 'short'), (0.75, 1.0, 'short')]
    """

    def decided_on(span: Span) -> tuple[float, float, Decided] | Open[Span]:
        decided = decide(*span)
        return Open(span) if decided is None else (*span, decided)

    def halves(span: Span) -> list[Span]:
        low, high = span
        middle = (low + high) / 2
        return [] if high - low < 2 * shortest else [(low, middle), (middle, high)]

    whole = [(k / parts, (k + 1) / parts) for k in range(parts)]
    search = branch(whole, decided_on, halves, until=lambda found, _: bool(found.undecided))
    if search.undecided:
        raise UndecidedError
    return search.decided
