"""Rectangles in which poles and zeros lie for every combination of values of parameters.

Input: a model, one of its transfer functions, and the box in which its parameters lie. Output: a
:class:`RootCloud` for each root that moves, or for roots whose rectangles overlap.

Example: ``s^2 + b s + k``, b = 2, k = 100, off by up to 10 %: two poles, -1.1 to -0.9 + (9.4 to 10.5) j.

The size is taken from slopes at the middle of the box. No root lies on a rectangle's edges for any
combination, as in :mod:`symflex.loops.spread` on the axis; so as many lie inside as at the middle.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import pi
from typing import TYPE_CHECKING, Literal

from symflex.balls import Branching, Open, branch
from symflex.errors import BudgetError
from symflex.loops.boxes import CharacteristicFunction, OpenBox
from symflex.loops.over import with_values
from symflex.loops.spread import middle_of, reach, spread_function
from symflex.model.loss_factors import check_causal
from symflex.print.text import INDENT, WIDTH, Passage, passages_text
from symflex.roots.locate import locate
from symflex.roots.region import Rectangle
from symflex.roots.root import count_roots
from symflex.transfer import bind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.loops.boxes import Box
    from symflex.model import Model
    from symflex.options import Stated
    from symflex.roots import PoleZeroMap, Root
    from symflex.transfer import AnyBoundFunction

    Sides = tuple[float, float, float, float]

LARGER = (1.05, 1.2, 1.5, 2.0, 3.0)  # sizes of rectangles that are tried, times that to first order
MOST_PARTS = 60  # boxes of parameters on one edge after which a rectangle is not proved
PIECE = (Fraction(1), Fraction(2))


@dataclass(frozen=True, slots=True)
class RootCloud:
    """A rectangle of the s plane that roots do not leave."""

    kind: Literal["pole", "zero"]
    sides: Sides  # least and largest real and imaginary part [rad/s]; its mirror image holds the conjugates
    count: int | None  # how many lie in it for every combination; None where that is not proved

    def to_json_dict(self) -> dict[str, object]:
        """Return it as JSON data, with the ranges of natural frequency and damping ratio."""
        frequency, damping = self.ranges
        return {
            "kind": self.kind,
            "re": list(self.sides[:2]),
            "im": list(self.sides[2:]),
            "count": self.count,
            "omega": frequency,
            "zeta": damping,
        }

    @property
    def ranges(self) -> tuple[list[float], list[float]]:
        """Least and largest natural frequency [rad/s] and damping ratio in it, rounded outwards."""
        left, right, low, high = self.sides
        corners = [complex(x, y) for x in (left, right) for y in (max(low, 0.0), high)]
        nearest = complex(max(left, min(right, 0.0)), max(low, 0.0))
        ratios = [-z.real / abs(z) for z in corners] if abs(nearest) else [-1.0, 1.0]
        wide = 1e-6
        return [abs(nearest) * (1 - wide), max(map(abs, corners)) * (1 + wide)], [
            max(min(ratios) - wide, -1.0),
            min(max(ratios) + wide, 1.0),
        ]


def root_clouds(
    bound: AnyBoundFunction, located: PoleZeroMap, share: Stated, model: Model | None = None
) -> tuple[RootCloud, ...]:
    """Return where a map's poles and zeros may lie but at 0, of a function of numbers by its ``model``."""
    tf = bound.source
    valued = with_values(model or tf.model, dict(bound.values))
    check_causal(valued, "a region for every combination")
    function, box, _ = spread_function(valued, share, (tf.output.name, tf.input.name))
    clouds: list[RootCloud] = []
    both: dict[Literal["pole", "zero"], Sequence[Root]] = {"pole": located.poles, "zero": located.zeros}
    for kind, roots in both.items():
        asked = function.of_roots(kind)
        upper = [complex(r) for r in roots if not r.im < 0 and not r.is_zero]
        if asked.factors:
            clouds += _clouds(asked, box, upper, kind)
    return tuple(clouds)


def _clouds(
    function: CharacteristicFunction, box: Box, roots: Sequence[complex], kind: Literal["pole", "zero"]
) -> list[RootCloud]:
    sizes = [reach(function, s, box)[0] for s in roots]
    left = list(zip(roots, sizes, strict=True))
    clouds: list[RootCloud] = []
    for larger in LARGER:
        merged: list[tuple[Sides, list[tuple[complex, complex]]]] = []
        for s, size in left:
            sides, own = _sides(s, size, larger), [(s, size)]
            while touching := [each for each in merged if _overlap(each[0], sides)]:
                merged = [each for each in merged if each not in touching]
                sides = _hull([sides, *(each for each, _ in touching)])
                own += [x for _, each in touching for x in each]
            merged.append((sides, own))
        left = []
        for sides, own in merged:
            try:
                count = _count(function, box, sides, kind)
            except BudgetError:
                count = None
            if count is None and larger < LARGER[-1]:
                left += own
            else:
                clouds.append(RootCloud(kind, sides, count))
    return sorted(clouds, key=lambda each: each.ranges[0])


def _sides(s: complex, size: complex, larger: float) -> Sides:
    least = 1e-6 * abs(s)
    wide, high = (max(larger * x, least) for x in (size.real, size.imag))
    low = s.imag - high if s.imag else -max(high, wide)
    top = s.imag + high if s.imag else -low
    if low <= 0:
        low = -top
    left, right, low, high = (float(f"{x:.6g}") for x in (s.real - wide, s.real + wide, low, top))
    return left, right, low, high


def _overlap(a: Sides, b: Sides) -> bool:
    return a[0] <= b[1] and b[0] <= a[1] and a[2] <= b[3] and b[2] <= a[3]


def _hull(every: Sequence[Sides]) -> Sides:
    left, right, low, high = zip(*every, strict=True)
    return min(left), max(right), -max(high) if min(low) <= 0 else min(low), max(high)


def _count(function: CharacteristicFunction, box: Box, sides: Sides, kind: str) -> int | None:
    """Return how many roots lie in a rectangle for every combination; None where that is not proved."""
    left, right, low, high = sides
    base = max(low, 0.0)
    corners = [complex(right, base), complex(right, high), complex(left, high), complex(left, base)]
    edges = list(pairwise([*corners, corners[0]]))[: 4 if base else 3]
    if not all(_is_free(function, box, a, b - a) for a, b in edges):
        return None
    middle = dict(zip(function.names, middle_of(box), strict=True))
    bound = bind(function.tf, middle, varied=function.names)
    located = locate(bound, Rectangle(*map(Fraction, sides)), 10)
    hidden = [sum(h.multiplicity for h in each.hidden) for each in (bound, function.tf)]
    if not located.certificate.certified or hidden[0] > hidden[1]:
        return None
    return count_roots(located.poles if kind == "pole" else located.zeros)


def _is_free(function: CharacteristicFunction, box: Box, start: complex, way: complex) -> bool:
    """Tell whether no root lies on an edge for any combination."""
    path = start - way, way

    def decide(each: OpenBox) -> Open[OpenBox] | None:
        narrowed = function.narrowed(each, path=path)
        return Open(narrowed) if any(narrowed.pieces) else None

    everywhere = OpenBox(box, 0.0, tuple((PIECE,) for _ in function.factors))
    search: Branching[OpenBox, None] = branch([everywhere], decide, function.halves, most=MOST_PARTS)
    return not search.undecided


def clouds_text(clouds: Sequence[RootCloud]) -> str:
    """Return the rectangles as tables in 80 columns."""
    rows: list[tuple[str, ...]] = [
        ("", "Re s from", "to", "Im s from", "to", "f [Hz] from", "to", "zeta from", "to")
    ]
    for each in clouds:
        (low, high), damping = each.ranges
        shown = (*each.sides, low / (2 * pi), high / (2 * pi), *damping)
        several = {None: "not proved", 1: each.kind}.get(each.count, f"{each.count} {each.kind}s")
        rows.append((several, *(f"{x:.6g}" for x in shown[:4]), *(f"{x:.4g}" for x in shown[4:])))
    heading = f"{INDENT}rectangles for every combination [rad/s]"
    return passages_text([Passage([heading], rows)], WIDTH)
