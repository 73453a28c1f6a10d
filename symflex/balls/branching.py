"""Regions that are decided, or halved until they are: the one loop behind every search.

Input: regions, what decides on one, and how one is halved. Output: a :class:`Branching`, what was decided and
what could not be.

Example: to find where ``x^2 - 2`` may vanish on [0, 3], an interval is excluded where its ball excludes 0,
and open else; halved until it is shorter than 0.01 it is left about 1.414 alone.

A function enclosed in balls is enclosed ever more sharply on the halves of a region, so that what is true,
and not by too little, is decided after so many halvings (Moore 1966). No region is lost: each is excluded or
decided, with all its points, or it is among the undecided.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import count
from typing import Generic, Literal, TypeVar

from symflex.balls.precision import UndecidedError
from symflex.budget import spend
from symflex.errors import BudgetError, Diagnostic

Region = TypeVar("Region")
Decided = TypeVar("Decided")
Number = TypeVar("Number", float, Fraction)
Order = Literal["depth", "breadth"]
Part = tuple[float, float]  # of a path, or of frequencies


@dataclass(frozen=True, slots=True)
class Open(Generic[Region]):
    """The decision that a region, or what was left of it, is to be halved."""

    region: Region


@dataclass(slots=True)
class Branching(Generic[Region, Decided]):
    """What a search decided, and where it came to no decision."""

    decided: list[Decided] = field(default_factory=list)  # in the order in which it was decided
    undecided: list[Region] = field(default_factory=list)  # too small to be halved, or left when it ended
    unseen: int = 0  # of the undecided ones, those that nobody looked at
    spent: int = 0  # regions looked at
    over: Diagnostic | None = None  # the budget that ended it


def branch(
    regions: Iterable[Region],
    decide: Callable[[Region], Decided | Open[Region] | None],
    halve: Callable[[Region], Sequence[Region]],
    *,
    order: Order | Callable[[Region], float] = "depth",
    most: int | None = None,
    until: Callable[[Branching[Region, Decided], int], bool] | None = None,
    keeps: bool = False,
) -> Branching[Region, Decided]:
    """Return what is decided on regions, and on halves of those on which nothing is.

    Parameters
    ----------
    regions : iterable
        Where the search begins, in the order in which they are looked at.
    decide : callable
        Returns what is decided on a region, ``None`` if it is excluded, ``Open(region)`` if it is to be
        halved: itself, or a smaller one that contains all that is not excluded.
    halve : callable
        Returns the parts of an open region, in the order in which they are looked at; none if it is too
        small, so that it stays undecided.
    order : {"depth", "breadth"} or callable
        Which region is next: a part of the last one, the one that waits longest, or the one of the largest
        value that the callable gives it.
    most : int, optional
        How many regions are looked at; those that still wait are undecided.
    until : callable, optional
        Told what was decided so far and how many regions wait, returns whether that is enough; those that
        wait are undecided.
    keeps : bool
        Whether a budget that is used up ends the search with what it decided, instead of an error.

    Examples
    --------
    >>> from flint import arb
    >>> def decide(ends):
    ...     x = arb(ends[0]).union(ends[1])
    ...     return Open(ends) if (x**2 - 2).contains(0) else None
    >>> def halve(ends):
    ...     low, high = ends
    ...     middle = (low + high) / 2
    ...     return [(low, middle), (middle, high)] if high - low > 0.01 else []
    >>> branch([(0.0, 3.0)], decide, halve).undecided
    [(1.412109375, 1.41796875)]
    """
    found: Branching[Region, Decided] = Branching()
    waiting: list[tuple[float, int, Region]] = []  # a heap: the rank of each, and its number among all
    numbers = count()

    def wait(parts: Sequence[Region]) -> None:
        for part in parts[::-1] if order == "depth" else parts:
            number = next(numbers)
            rank = -order(part) if callable(order) else 0.0
            heapq.heappush(waiting, (rank, -number if order == "depth" else number, part))

    wait([*regions])
    while waiting and (most is None or found.spent < most) and not (until and until(found, len(waiting))):
        region = heapq.heappop(waiting)[2]
        found.spent += 1
        try:
            spend()
            decision = decide(region)
            if not isinstance(decision, Open):
                found.decided += [] if decision is None else [decision]
                continue
            region = decision.region
            parts = halve(region)
        except BudgetError as error:
            if not keeps:
                raise
            found.undecided.append(region)
            found.over = error.diagnostics[0]
            break
        wait(parts)
        found.undecided += [] if parts else [region]
    found.unseen = len(waiting)
    found.undecided += [region for *_, region in sorted(waiting)]
    return found


def halved(ends: tuple[Number, Number]) -> list[tuple[Number, Number]]:
    """Return both halves of an interval, the lower one first.

    >>> halved((0.0, 3.0))
    [(0.0, 1.5), (1.5, 3.0)]
    """
    low, high = ends
    middle = (low + high) / 2
    return [(low, middle), (middle, high)]


def covered(
    decide: Callable[[float, float], Decided | None], parts: int, shortest: float
) -> list[tuple[float, float, Decided]]:
    """Return pieces of the path [0, 1] with what is decided on them, at first so many, halved until it is.

    UndecidedError where a piece would be shorter than ``shortest``.

    >>> covered(lambda a, b: "short" if b - a < 0.3 else None, 2, 0.1)
    [(0.0, 0.25, 'short'), (0.25, 0.5, 'short'), (0.5, 0.75, 'short'), (0.75, 1.0, 'short')]
    """

    def decided_on(span: Part) -> tuple[float, float, Decided] | Open[Part]:
        decided = decide(*span)
        return Open(span) if decided is None else (*span, decided)

    def halves(span: Part) -> list[Part]:
        return [] if span[1] - span[0] < 2 * shortest else halved(span)

    spans = [(k / parts, (k + 1) / parts) for k in range(parts)]
    search = branch(spans, decided_on, halves, until=lambda found, _: bool(found.undecided))
    if search.undecided:
        raise UndecidedError
    return search.decided
