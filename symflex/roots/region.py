"""Regions of the s plane, and the classification of enclosed roots against them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction

from flint import arb

from symflex.balls import ball, precision
from symflex.errors import refused
from symflex.options import RootsOptions, band_ends, frequency
from symflex.roots.root import Root


class Position(Enum):
    """Where a root lies with respect to a closed region."""

    INSIDE = "inside"
    BOUNDARY = "boundary"
    OUTSIDE = "outside"
    UNDECIDED = "undecided"


@dataclass(frozen=True, slots=True)
class Everything:
    """The whole s plane."""

    def classify(self, roots: Sequence[Root]) -> tuple[Position, ...]:
        """Return the position of every root."""
        return tuple(Position.INSIDE for _ in roots)

    def to_json_dict(self) -> dict[str, object]:
        """Return the region as JSON data."""
        return {"kind": "everything"}


@dataclass(frozen=True, slots=True)
class Band:
    """The roots with natural frequency abs(s)/(2 pi) from ``low`` (0: no limit) to ``high`` [Hz].

    >>> from fractions import Fraction
    >>> Band(Fraction(1, 10), Fraction(1000)).to_json_dict()
    {'kind': 'band', 'low_hz': 0.1, 'high_hz': 1000.0}
    """

    low: Fraction
    high: Fraction

    def __post_init__(self) -> None:
        if not 0 <= self.low <= self.high:
            message = f"a band runs from a lower to a higher frequency, not from {self.low} to {self.high}"
            raise ValueError(message)

    def classify(self, roots: Sequence[Root]) -> tuple[Position, ...]:
        """Return the position of every root."""
        return tuple(self._position(root) for root in roots)

    def _position(self, root: Root) -> Position:
        frequency = root.size()
        with precision(root.working_bits()):
            turn = 2 * arb.pi()
            signs = [_sign(ball(self.high) * turn - frequency)]
            if self.low:
                signs.append(_sign(frequency - ball(self.low) * turn))
        return _position(signs)

    def to_json_dict(self) -> dict[str, object]:
        """Return the region as JSON data."""
        return {"kind": "band", "low_hz": float(self.low), "high_hz": float(self.high)}


@dataclass(frozen=True, slots=True)
class Rectangle:
    """The closed rectangle re_low <= re s <= re_high, im_low <= im s <= im_high [rad/s]."""

    re_low: Fraction
    re_high: Fraction
    im_low: Fraction
    im_high: Fraction

    def __post_init__(self) -> None:
        if self.re_low > self.re_high or self.im_low > self.im_high:
            raise ValueError("a rectangle needs RE0 <= RE1, IM0 <= IM1")

    def classify(self, roots: Sequence[Root]) -> tuple[Position, ...]:
        """Return the position of every root."""
        return tuple(self._position(root) for root in roots)

    def _position(self, root: Root) -> Position:
        with precision(root.working_bits()):
            return _position(
                [
                    _sign(root.re - ball(self.re_low)),
                    _sign(ball(self.re_high) - root.re),
                    _sign(root.im - ball(self.im_low)),
                    _sign(ball(self.im_high) - root.im),
                ]
            )

    def to_json_dict(self) -> dict[str, object]:
        """Return the region as JSON data."""
        return {
            "kind": "rectangle",
            "re": [float(self.re_low), float(self.re_high)],
            "im": [float(self.im_low), float(self.im_high)],
        }


@dataclass(frozen=True, slots=True)
class Modes:
    """The ``count`` modes of lowest nonzero natural frequency, and the roots at 0.

    A conjugate pair or a real root is one mode; a root of multiplicity m counts as m modes and is kept whole.
    Roots of equal frequency that straddle the limit, as a pair +a and -a may, are all on the boundary.
    """

    count: int

    def __post_init__(self) -> None:
        if self.count < 0:
            raise ValueError(f"the number of modes cannot be {self.count}")

    def classify(self, roots: Sequence[Root]) -> tuple[Position, ...]:
        """Return the position of every root; the roots are in order of natural frequency."""
        return _numbered(roots, 0, self.count, at_zero=Position.INSIDE)

    def to_json_dict(self) -> dict[str, object]:
        """Return the region as JSON data."""
        return {"kind": "modes", "count": self.count}


@dataclass(frozen=True, slots=True)
class Mode:
    """The mode of one number, from 1, in order of natural frequency; :class:`Modes` says what is one mode."""

    number: int

    def __post_init__(self) -> None:
        if self.number < 1:
            raise ValueError(f"modes are numbered from 1, not {self.number}")

    def classify(self, roots: Sequence[Root]) -> tuple[Position, ...]:
        """Return the position of every root; the roots are in order of natural frequency."""
        return _numbered(roots, self.number, self.number, at_zero=Position.OUTSIDE)

    def to_json_dict(self) -> dict[str, object]:
        """Return the region as JSON data."""
        return {"kind": "mode", "number": self.number}


Region = Everything | Band | Rectangle | Modes | Mode


def region_of(given: RootsOptions, mark: str = "") -> Region | None:
    """Return the region that options say, None when they say nothing.

    Of ``modes``, ``mode``, ``band`` and ``region`` at most one is given (else SF902, as for limits that are
    none, or a number of a mode below 1); ``mark`` stands before their names in messages.

    >>> from symflex.options import RootsOptions
    >>> region_of(RootsOptions(band=(0.1, 20)))
    Band(low=Fraction(1, 10), high=Fraction(20, 1))
    """
    if sum(choice is not None for choice in (given.modes, given.mode, given.band, given.region)) > 1:
        names = f"{mark}modes, {mark}mode, {mark}band and {mark}region"
        raise refused(f"give only one of {names}")
    try:
        if given.modes is not None:
            return Modes(given.modes)
        if given.mode is not None:
            return Mode(given.mode)
        if given.band is not None:
            return Band(*band_ends(given.band))
        if given.region is None:
            return None
        return Rectangle(*(frequency(side, "--region", "-10 or '3 rad/s'") for side in given.region))
    except ValueError as impossible:
        raise refused(str(impossible)) from None


def _numbered(roots: Sequence[Root], first: int, last: int, *, at_zero: Position) -> tuple[Position, ...]:
    """Return where roots stand of which the modes ``first`` to ``last`` are asked for, all up to it for 0."""
    positions = [at_zero] * len(roots)
    before = 0
    for indices in _by_frequency(roots):
        leaders = [roots[i] for i in indices if not roots[i].im < 0]
        after = before + sum(root.multiplicity for root in leaders)
        if before >= last or after < first:
            position = Position.OUTSIDE
        elif after <= last or len(leaders) == 1:
            position = Position.INSIDE
        elif all(_mirrored(leaders[0], root) for root in leaders):
            position = Position.BOUNDARY
        else:
            position = Position.UNDECIDED
        for i in indices:
            positions[i] = position
        before = after
    return tuple(positions)


def _by_frequency(roots: Sequence[Root]) -> list[list[int]]:
    """Return the indices of the roots other than 0, grouped where their frequencies overlap."""
    grouped: list[list[int]] = []
    reached: arb | None = None
    for i, root in enumerate(roots):
        if root.is_zero:
            continue
        frequency = root.size()
        if reached is not None and reached.overlaps(frequency):
            grouped[-1].append(i)
        else:
            grouped.append([i])
        reached = frequency
    return grouped


def _mirrored(a: Root, b: Root) -> bool:
    """Return whether two enclosures are equal up to signs, so that the roots lie equally far from 0."""
    with precision(max(a.working_bits(), b.working_bits())):
        return all(
            bool(abs(x.mid()) == abs(y.mid())) and bool(x.rad() == y.rad())
            for x, y in ((a.re, b.re), (a.im, b.im))
        )


def _sign(difference: arb) -> int | None:
    """Return the sign of a real ball, None when it is not determined."""
    if difference == 0:
        return 0
    return 1 if difference > 0 else -1 if difference < 0 else None


def _position(signs: Iterable[int | None]) -> Position:
    """Return where a point lies whose signed distances to all sides have these signs."""
    known = list(signs)
    if -1 in known:
        return Position.OUTSIDE
    if None in known:
        return Position.UNDECIDED
    return Position.BOUNDARY if 0 in known else Position.INSIDE
