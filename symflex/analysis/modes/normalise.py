"""Scaling a mode shape so that its largest displacement is 1.

Input: amplitudes up to a factor. Output: the same divided by the largest, with the place where that is.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from flint import acb

from symflex.analysis.modes.shape import ModeShape
from symflex.roots import precision

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from symflex.analysis.modes.shape import DistributedShape

TURNING = ("shaft",)
TIE = 1 + 1e-9
"""A displacement must be larger by this factor to replace an earlier one as the reference."""
SECTIONS = 40
GOLDEN = 0.6180339887498949


@dataclass(frozen=True, slots=True)
class _Place:
    """An amplitude and where it is met."""

    name: str
    value: acb
    part: DistributedShape | None = None
    share: Fraction = Fraction(0)
    width: Fraction = Fraction(0)

    @property
    def size(self) -> float:
        """The midpoint's absolute value."""
        return float(abs(self.value.mid()))


def normalised(shape: ModeShape, digits: int) -> ModeShape | None:
    """Return a shape whose largest displacement is 1, None when its balls do not tell which that is.

    Displacements are those of nodes in translation, along beams, rods and strings, and of each field's first
    unknown. Where all of these are at rest, the largest angle is 1; where no angle moves either, the largest
    voltage; else the largest of what is left.

    Parameters
    ----------
    shape : ModeShape
        Of any scale.
    digits : int
        What is smaller than ``10^-digits`` of another motion, in SI units, is at rest.
    """
    groups = [list(places) for places in _groups(shape)]
    largest = max((p.size for group in groups for p in group), default=0.0)
    for group in groups:
        reference = _largest(group)
        if reference is None or reference.size + _radius(reference) < largest * 10.0**-digits:
            continue
        if reference.value.contains(0):
            return None
        return _scaled(shape, _refined(reference))
    return None


def _groups(shape: ModeShape) -> Iterator[Iterator[_Place]]:
    """Yield what competes for being the largest, the kind that matters most first."""

    def group(unit: str, chosen: Callable[[DistributedShape], bool]) -> Iterator[_Place]:
        for motion in shape.motions:
            if motion.unit == unit and motion.variable.kind == "node":
                yield _Place(motion.name, motion.value)
        for part in shape.distributed:
            if chosen(part):
                yield from _along(part)

    yield group("m", lambda part: part.kind not in TURNING)
    yield group("rad", lambda part: part.kind in TURNING)
    yield group("V", lambda part: False)
    yield (_Place(m.name, m.value) for m in shape.motions if m.variable.kind != "node")


def _along(part: DistributedShape) -> Iterator[_Place]:
    intervals = part.intervals()
    for share, state in part.sampled(intervals):
        yield _Place(part.name, state[0], part, share, Fraction(1, intervals))


def _largest(places: list[_Place]) -> _Place | None:
    found: _Place | None = None
    for place in places:
        if found is None or place.size > found.size * TIE:
            found = place
    return found


def _refined(place: _Place) -> _Place:
    """Return the place of the largest amplitude next to a sample, by golden section."""
    part = place.part
    if part is None or place.share in (0, 1):
        return place

    def size(share: float) -> float:
        return float(abs(part.state_at_share(Fraction(share))[0].mid()))

    low, high = float(place.share - place.width), float(place.share + place.width)
    left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    at_left, at_right = size(left), size(right)
    for _ in range(SECTIONS):
        if at_left < at_right:
            low, left, at_left = left, right, at_right
            right = low + GOLDEN * (high - low)
            at_right = size(right)
        else:
            high, right, at_right = right, left, at_left
            left = high - GOLDEN * (high - low)
            at_left = size(left)
    share = Fraction((low + high) / 2)
    return replace(place, share=share, value=part.state_at_share(share)[0])


def _scaled(shape: ModeShape, reference: _Place) -> ModeShape:
    part, name = reference.part, reference.name
    if part is not None:
        with precision(part.bits):
            x = part.start + part.length * reference.share.numerator / reference.share.denominator
        name = f"{part.name}({float(x.mid()):.6g})"
    with precision(_bits(reference)):
        factor = 1 / reference.value
        motions = tuple(
            replace(m, value=acb(1) if m.name == name and m.variable.kind == "node" else m.value * factor)
            for m in shape.motions
        )
        distributed = tuple(p.scaled(factor) for p in shape.distributed)
    return replace(shape, motions=motions, distributed=distributed, reference=name)


def _bits(reference: _Place) -> int:
    return max(64, reference.value.bits()) + 32


def _radius(place: _Place) -> float:
    return float(place.value.rad())
