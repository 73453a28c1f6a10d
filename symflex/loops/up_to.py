"""For which values of a parameter a model is stable, as far as its poles up to a frequency go.

Input: a characteristic function, the range of a parameter inside wavenumbers, and a frequency. Output: parts
of the range with the poles in the right half-plane counted in each, and gaps between them.

Example: a cantilever whose tip carries a force P that turns with it has all poles on the axis up to
P = 20.0509... EI/l^2, where the two lowest pairs meet and leave it (Beck 1952).

It is proved that no pole enters or leaves the right half of a disc for all values in a part: its arc is free
of poles, and so is the axis (boundary crossing theorem; Bhattacharyya, Chapellat and Keel 1995, theorem 1.4).
Without damping, F is even in s and poles may stay on the axis, where F is real but for a factor j. They leave
it only where two of them meet, which none do where F or its slope differs from 0. Poles are counted at one
value of each part, by the argument principle, and by changes of sign along the axis.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, partial
from itertools import chain, islice, pairwise
from math import ceil, floor, inf, log2, pi
from typing import Literal

from flint import acb, acb_series, arb, fmpz_mpoly

from symflex.algebra import LAPLACE, Factored
from symflex.balls import (
    Branching,
    Open,
    UndecidedError,
    Value,
    at_centre,
    ball,
    branch,
    covered,
    halved,
    narrowed,
    precision,
)
from symflex.budget import spend
from symflex.expressions import names_among
from symflex.loops.boxes import (
    BITS,
    COUNT_DIGITS,
    Box,
    CharacteristicFunction,
    Ends,
    FirstOrder,
    OpenBox,
    Piece,
    factors_of,
)
from symflex.loops.patches import FINER_BITS, ROOM, ULP, Bound, Patch, patch
from symflex.loops.stability_map import PoleCount
from symflex.roots.distributed.right_half_plane import WAVES
from symflex.roots.distributed.side import polynomial_roots
from symflex.roots.functions.kernel_function import ANYWHERE, KernelFunction, split_off_kernels
from symflex.roots.pole_zero_map import StabilityVerdict
from symflex.roots.root import exact_fraction

FEW_WAVES = 2  # radians up to which exponentials of matrices are sharper than sums of exponentials
FEW = 4.0  # radians of waves for which a path has as many cells as for less
WIDER = tuple(1 + Fraction(k, 32) for k in range(9))  # of the circle, for parts whose poles meet it
ONE = (Fraction(1),)  # circle, that of the frequency itself
SHORTEST = 1e-9  # share of a path that is not halved where poles are counted
MOST_OPEN = 48  # pieces left open after which others stay as they are: halves of the part leave fewer
SPARE = 20  # bits by which pieces of the axis that are not halved are wider than the precision
SHARES = (Fraction(0), Fraction(3, 8), Fraction(1, 2), Fraction(1))  # of a range, at which waves are compared
ARC: Piece = (Fraction(0), Fraction(1))  # stands for an arc that poles may meet
MIDDLE = Fraction(1, 2)  # share of a range
SHORT = 64  # times as long as a part is the range, if a highest derivative vanishes in it
SHORTER, BESIDE = 3, 4  # times as many waves as elsewhere; part of the range beside which they are looked for
DEEPEST = 7  # halvings of the range until a patch has to serve
WIDENED = 64  # widths by which places on the axis are widened to prove that one pair meets there
STEPS, SHARE = 40, 0.9  # of Newton's method, each of which leaves less than this share


@dataclass(frozen=True, slots=True)
class OpenPart:
    """A part of the range with the pieces of the axis on which poles may leave it, factor by factor."""

    ends: Ends
    pieces: tuple[tuple[Piece, ...], ...]
    circle: Fraction | None = None  # radius of an arc that no pole meets [rad/s], if one is known

    @property
    def halves(self) -> list[OpenPart]:
        """Both halves of the part."""
        return [replace(self, ends=ends) for ends in halved(self.ends)]


@dataclass(frozen=True, slots=True)
class Path:
    """The imaginary axis up to a frequency, or a quarter of a circle from the real axis up to it.

    Shares of the axis grow with the root of the frequency, as waves of beams do. Negative shares are those
    of the lower half-plane, which mirrors the upper one if coefficients are real.
    """

    kind: Literal["axis", "arc"]
    end: Fraction  # frequency, or radius [rad/s]
    cells: int  # equal parts, each of which lies in a disc that is not large for the waves
    signs: tuple[int, ...] = (1,)  # of the half-planes that are looked at

    def frequency(self, share: Fraction) -> Fraction:
        """Return that at a share of the axis [rad/s]."""
        return self.end * share * abs(share)

    def at(self, share: Fraction) -> acb:
        """Return the point at a share of the path."""
        if self.kind == "axis":
            return acb(0, ball(self.frequency(share)))
        return ball(self.end) * (acb(0, ball(share)) * arb.pi() / 2).exp()

    def box(self, piece: Piece) -> acb:
        """Return a box about a piece."""
        if self.kind == "axis":
            return self.at(piece[0]).union(self.at(piece[1]))
        share = acb(0, ball(piece[0]).union(ball(piece[1])))
        return ball(self.end) * (share * arb.pi() / 2).exp()

    def middle(self, piece: Piece) -> acb:
        """Return a point in the middle of a piece."""
        low, high = piece
        if self.kind == "axis":
            return acb(0, ball((self.frequency(low) + self.frequency(high)) / 2)).mid()
        return self.at((low + high) / 2).mid()

    def reach(self, piece: Piece) -> float:
        """Return how far a piece lies from its middle at most."""
        low, high = piece
        if self.kind == "axis":
            return float((self.frequency(high) - self.frequency(low)) / 2) * (1 + ULP)
        return float(self.end * (high - low)) * pi / 4 * (1 + ULP)


@dataclass(frozen=True, slots=True)
class BoxesUpTo:
    """What a chart asks about boxes of parameters, of poles up to a frequency."""

    poles: PolesUpTo  # with one circle

    def whole(self, box: Box) -> OpenBox:
        """Return a box about which nothing is known yet."""
        return OpenBox(box, float(self.poles.radius), (*self.poles.pieces, (ARC,)))

    def halves(self, box: OpenBox) -> list[OpenBox]:
        """Return both halves of a box, parted along the longest of its sides, in shares of the ranges."""
        sides = zip(box.box, self.poles.ranges, strict=True)
        shares = tuple(float((b - a) / (high - low)) for (a, b), (low, high) in sides)
        return self.poles.function.halves(replace(box, weights=shares))

    def narrowed(self, box: OpenBox) -> OpenBox:
        """Return the box with the pieces of the axis that stay open and, last, the arc if it does."""
        return self.poles.narrowed_box(box)

    def verdict_at(self, point: Sequence[Fraction]) -> StabilityVerdict:
        """Return what holds at a point, as far as poles are counted."""
        count = self.poles.count(point, self.poles.axis.end)
        if count is None:
            return StabilityVerdict("unknown", None, False, "poles could not be counted in a region")
        word: Literal["stable", "marginal", "unstable"] = "marginal" if count.axis else "stable"
        reason = f"poles are counted up to {float(self.poles.axis.end) / (2 * pi):.4g} Hz"
        return StabilityVerdict("unstable" if count.right else word, count.right, False, reason)


@dataclass(frozen=True, slots=True)
class PartValues:
    """The factors for all values of the parameters in a box."""

    box: Box
    near: FirstOrder  # sharp next to s = 0
    far: FirstOrder

    @property
    def is_point(self) -> bool:
        """Whether each parameter has one value."""
        return all(low == high for low, high in self.box)


@dataclass(frozen=True, eq=False)
class PolesUpTo:
    """The poles of a model up to a frequency, for values of some parameters."""

    function: CharacteristicFunction
    radius: Fraction  # the frequency [rad/s]
    ranges: Box
    bits: int  # precision of values on narrow parts
    circles: tuple[Fraction, ...]  # times the frequency: of arcs that are tried

    @classmethod
    def of(
        cls,
        function: CharacteristicFunction,
        ranges: Box,
        radius: float | None,
        bits: int = BITS,
        circles: tuple[Fraction, ...] = WIDER,
    ) -> PolesUpTo:
        """Return those up to a frequency [rad/s], without one up to a few waves of the longest element."""
        function = replace(function, is_alone=True)
        if radius is None:
            last, middle = share_of_ranges(ranges, Fraction(1)), share_of_ranges(ranges, MIDDLE)
            at = last if _keeps_order(function, last) else middle
            moving = _kernel_functions(function, function.at_rest[1], at)
            radius = min(part.frequency_of(WAVES) for part in moving)
        return cls(function, Fraction(radius), ranges, bits, circles)

    @staticmethod
    def serves(function: CharacteristicFunction) -> bool:
        """Tell whether the model has waves, and functions of these that are entire at s = 0."""
        tf, _ = function.at_rest
        return any(kernel.function == "fundamental" for kernel in tf.kernels.kernels)

    @property
    def whole(self) -> OpenPart:
        """The range, and the axis up to the widest circle for each factor that the parameter moves."""
        return OpenPart(self._limits, self.pieces)

    @property
    def _limits(self) -> Ends:
        """The range of the one parameter."""
        (limits,) = self.ranges
        return limits

    @property
    def pieces(self) -> tuple[tuple[Piece, ...], ...]:
        """Those of the axis up to the widest circle, for each factor that the parameters move."""
        first = -self._cells if self.function.is_complex else 0
        marks = [Fraction(k, self._cells) for k in range(first, self._cells + 1)]
        return tuple(tuple(pairwise(marks)) for _ in self._moving)

    @cached_property
    def axis(self) -> Path:
        """The axis up to the widest circle."""
        return self._path("axis", self.radius * self.circles[-1])

    def _path(self, kind: Literal["axis", "arc"], end: Fraction) -> Path:
        signs = (-1, 1) if self.function.is_complex else (1,)
        return Path(kind, end, self._cells // (2 if kind == "arc" else 1), signs)

    @cached_property
    def _cells(self) -> int:
        """A power of 2, about as many as radians in the waves along the longest element for most values."""
        return 1 << ceil(log2(max(self._waves[len(self._waves) // 2], FEW)))

    @cached_property
    def _waves(self) -> list[float]:
        """How many radians the waves have at some values of the range, ascending."""
        return sorted(self._reach(parts) for parts in self._parts)

    def _reach(self, parts: Sequence[KernelFunction]) -> float:
        return max(part.reach(float(self.radius)) for part in parts)

    @cached_property
    def _factors(self) -> tuple[tuple[fmpz_mpoly, int], ...]:
        """All factors, entire at s = 0, with their exponents."""
        tf, _ = self.function.at_rest
        every = [(f, e) for f, e in tf.den.factors if e > 0]
        every += [(h.polynomial, h.multiplicity) for h in tf.hidden]
        return tuple((f, e) for f, e in every if factors_of(tf, [f], with_images=False))

    @cached_property
    def _moving(self) -> list[int]:
        """Those whose roots depend on the parameters."""
        moving = self.function.at_rest[1]
        return [i for i, (factor, _) in enumerate(self._factors) if factor in moving]

    @cached_property
    def _parts(self) -> list[list[KernelFunction]]:
        """The factors for some values of the ranges, the last ones at their ends if possible."""
        points = (share_of_ranges(self.ranges, share) for share in SHARES)
        return [self._at(point) for point in points if _keeps_order(self.function, point)]

    def _at(self, point: Box) -> list[KernelFunction]:
        """Return the factors at a point."""
        return _kernel_functions(self.function, [f for f, _ in self._factors], point)

    @cached_property
    def _are_real_on_axis(self) -> list[bool]:
        """Whether roots of each are proved to mirror each other in the axis, whatever the value."""
        return [function.is_real_on_axis for function in self._parts[-1]]

    def is_bare(self, ends: Ends) -> bool:
        """Tell whether a part is too near to where a wave equation loses its highest derivative.

        Waves are ever shorter there, and poles ever more.
        """
        if not self._may_lose_order:
            return False
        if not _keeps_order(self.function, (ends,)):
            return (ends[1] - ends[0]) * SHORT < self._width
        return self._reach(self._at(share_of_ranges((ends,), MIDDLE))) > SHORTER * self._waves[0]

    @cached_property
    def _may_lose_order(self) -> bool:
        """Whether a wave equation loses its highest derivative in the range, or beside it."""
        (low, high), beside = self._limits, self._width / BESIDE
        return not _keeps_order(self.function, ((low - min(beside, abs(low) / BESIDE), high + beside),))

    def narrowed(self, part: OpenPart) -> OpenPart | Open[OpenPart]:
        """Return the part with a circle if poles stay where they are, else what the axis still has open."""
        if not _keeps_order(self.function, (part.ends,)) or self.is_bare(part.ends):
            return Open(part)
        values = self._on((part.ends,))
        pieces = zip(self._moving, part.pieces, strict=True)
        narrowed = replace(part, pieces=tuple(self._left(values, factor, each) for factor, each in pieces))
        circle = None if any(narrowed.pieces) else self._circle_for(part.ends)
        return Open(narrowed) if circle is None else replace(narrowed, circle=circle)

    def _circle_for(self, ends: Ends) -> Fraction | None:
        """Return the radius of an arc that no pole meets for any value in a part, None if none is known."""
        for around in self._about(ends):
            if around not in self._free:
                values, circles = self._on((around,)), (self.radius * times for times in self.circles)
                arcs = (self._path("arc", circle) for circle in circles)
                self._free[around] = next((a.end for a in arcs if self._is_free(values, a)), None)
            if self._free[around] is not None:
                return self._free[around]
        return None

    @cached_property
    def _free(self) -> dict[Ends, Fraction | None]:
        return {}

    def _about(self, ends: Ends) -> Iterator[Ends]:
        """Yield the range, its half about a part, and so on down to the part."""
        around: Ends | None = self._limits
        while around is not None:
            yield around
            halves = halved(around) if around != ends else []
            around = next((h for h in halves if h[0] <= ends[0] and ends[1] <= h[1]), None)

    def narrowed_box(self, box: OpenBox) -> OpenBox:
        """Return a box of parameters with the pieces of the axis that stay open, and the arc if it does."""
        if not _keeps_order(self.function, box.box):
            return box
        values, (*every, arc) = self._on(box.box), box.pieces
        axis = tuple(self._left(values, i, each) for i, each in zip(self._moving, every, strict=True))
        is_clear = not any(axis) and self._is_free(values, self._path("arc", self.axis.end))
        return replace(box, pieces=(*axis, () if is_clear else arc))

    def _on(self, box: Box) -> PartValues:
        tf, _ = self.function.at_rest
        factors = tuple(f for f, _ in self._factors)
        kinds = (replace(self.function, is_modal=False), self.function)
        return PartValues(box, *(FirstOrder(function, tf, factors, box) for function in kinds))

    def _left(self, values: PartValues, factor: int, pieces: Sequence[Piece]) -> tuple[Piece, ...]:
        """Return pieces of the axis, as shares of it, on which poles may leave it, ascending."""
        sharp = set[Piece]()

        def decide(piece: Piece) -> Open[Piece] | None:
            found = self._bound(values, factor, self.axis, piece)
            if not self._is_open(factor, found):
                return None
            if found.is_as_sharp_as_the_part:
                sharp.add(piece)
            return Open(piece)

        def halve(piece: Piece) -> list[Piece]:
            is_short = (piece[1] - piece[0]) * 2 ** (self.bits - SPARE) < 1
            return [] if piece in sharp or is_short else halved(piece)

        search: Branching[Piece, None] = branch(
            pieces, decide, halve, until=lambda found, _: len(found.undecided) >= MOST_OPEN
        )
        return tuple(sorted(search.undecided))

    def _is_open(self, factor: int, found: Bound) -> bool:
        """Tell whether poles may leave the axis: without damping where two meet, and the slope is 0."""
        return found.may_vanish and (found.may_turn or not self._are_real_on_axis[factor])

    def _is_free(self, values: PartValues, arc: Path) -> bool:
        """Tell whether no pole meets an arc in the right half-plane for any value in a part."""
        try:
            for factor in self._moving:
                self._pieces(values, factor, arc)
        except UndecidedError:
            return False
        return True

    def _bound(self, values: PartValues, factor: int, path: Path, piece: Piece) -> Bound:
        """Return what is known of a factor on a piece of a path, for all values in a part."""
        low, high = piece
        if len(values.box) == 1 and (path.kind == "arc" or path == self.axis):
            (ends,) = values.box
            known = self._patch(factor, path, floor((low + high) / 2 * path.cells), ends)
            if known is not None:
                at = complex(path.middle(piece))
                off = float(ends[1] - ends[0]) / 2
                found, is_rough = known.on(at, path.reach(piece), float(_middle(ends)), off)
                if is_rough or not self._is_open(factor, found):
                    return found
            elif (ends[1] - ends[0]) * 2**DEEPEST > self._width:
                return Bound(True, True, 1.0, 0.0)
        with precision(self.bits):
            # Next to s = 0 roots of dispersions meet; far out exponentials of matrices lose digits.
            waves = path.cells * max(-low, high) if path.kind == "axis" else 2 * path.cells
            sharper = (values.near, values.far) if waves <= FEW_WAVES else (values.far, values.near)
            found = _directly(sharper[0], factor, path.box(piece), path.middle(piece))
            if len(values.box) > 1 and self._is_open(factor, found):
                found = found.both(_directly(sharper[1], factor, path.box(piece), path.middle(piece)))
            return found

    @property
    def _width(self) -> Fraction:
        return self._limits[1] - self._limits[0]

    def _patch(self, factor: int, path: Path, number: int, ends: Ends) -> Patch | None:
        """Return what stands for a factor about a piece of a path, on the largest part about another."""
        for around in islice(self._about(ends), DEEPEST):
            key = factor, path, number, around
            if key not in self._patches:
                self._patches[key] = self._patch_on(factor, path, number, around)
            if self._patches[key] is not None:
                return self._patches[key]
        return None

    @cached_property
    def _patches(self) -> dict[tuple[int, Path, int, Ends], Patch | None]:
        return {}

    def _patch_on(self, factor: int, path: Path, number: int, ends: Ends) -> Patch | None:
        function, (tf, _) = self.function, self.function.at_rest
        (name,) = function.names
        if any(names_among(c.expression, {name}) for c in tf.constants):
            return None
        middle = _middle(ends)
        with precision(FINER_BITS[-1]):
            kernels = replace(function.kernels(tf, ((middle, middle),)), expands_modes=True)
        polynomial, _ = self._factors[factor]

        def value(s: Value, parameter: acb) -> Value:
            spend()
            moved = replace(kernels, constants={**kernels.constants, name: parameter})
            return moved.polynomial(polynomial, moved.at(s))

        cell = Fraction(number, path.cells), Fraction(number + 1, path.cells)
        half = float(ends[1] - ends[0]) / 2
        return patch(value, complex(path.middle(cell)), ROOM * path.reach(cell), float(middle), ROOM * half)

    def count(self, point: Sequence[Fraction], circle: Fraction) -> PoleCount | None:
        """Return how many poles lie on the right and on the axis at a point; None if it is not proved."""
        tf, _ = self.function.at_rest
        at_rest = tf.den.exponent_of(tf.ratio.ring.generator(LAPLACE))  # powers of s beside the factors
        total, values = PoleCount(0, at_rest), self._on(tuple((x, x) for x in point))
        cancelled = self._cancelled_on_axis(tuple((x, x) for x in point), circle)
        if cancelled is None:
            return None
        with suppress(UndecidedError):
            for factor, (_, exponent) in enumerate(self._factors):
                factor_poles = self._count(values, factor, circle)
                if factor_poles is None:
                    return None
                total += PoleCount(exponent * factor_poles.right, exponent * factor_poles.axis)
            axis = total.axis - cancelled
            # That they cancel is not proved: nothing is called stable for it.
            if axis < 0 or (cancelled and not axis and not total.right):
                return None
            return PoleCount(total.right, axis)
        return None

    def _cancelled_on_axis(self, point: Box, circle: Fraction) -> int | None:
        """Return how many roots of s alone on the axis may be of how a load is written; None if others may.

        A load along a member is divided by c_0 of its waves. The numerator vanishes where c_0 does, but
        contains no such factor. A root at which the numerator differs from 0 is a pole.
        """
        tf, _ = self.function.at_rest
        plain, _ = split_off_kernels(tf.den, tf.kernels)
        roots = polynomial_roots(self.function.bound_in(tf, point), plain, COUNT_DIGITS)
        above = [f for f, _ in tf.num.factors]
        count = 0
        with precision(self.bits):
            values = FirstOrder(replace(self.function, is_modal=False), tf, tuple(above), point)
            for root in roots:
                at = values.at(root.enclosure(), range(len(above)))
                size = root.natural_frequency()
                if root.re < 0 or size > ball(circle) or not any(value.contains(0) for value, _ in at):
                    continue
                if not (root.on_imaginary_axis and size < ball(circle)):
                    return None
                count += root.multiplicity
        return count

    def _count(self, values: PartValues, factor: int, circle: Fraction) -> PoleCount | None:
        """Return the same of one factor, all over the disc if one half-plane mirrors the other."""
        arc, axis = self._path("arc", circle), self._path("axis", circle)
        turn, mirrors = self._turn(values, factor, arc), 2 // len(axis.signs)
        if self._are_real_on_axis[factor]:
            pieces = self._pieces(values, factor, axis, most=1)
            crossed = sum(bool(self._ratio(values, factor, axis, each).real < 0) for each in pieces)
            crossed *= mirrors
            turns = (mirrors * turn / arb.pi()).unique_fmpz()
            right = -1 if turns is None else int(turns) - crossed  # twice as many
            return None if right < 0 or right % 2 else PoleCount(right // 2, crossed)
        turn -= self._turn(values, factor, axis)
        inside = (mirrors * turn / (2 * arb.pi())).unique_fmpz()
        return None if inside is None or inside < 0 else PoleCount(int(inside), 0)

    def _turn(self, values: PartValues, factor: int, path: Path) -> arb:
        """Return how far a factor turns on a path, on each piece of which it has no root."""
        pieces = self._pieces(values, factor, path)
        with precision(self.bits):
            return sum((self._ratio(values, factor, path, each).arg() for each in pieces), arb(0))

    def _ratio(self, values: PartValues, factor: int, path: Path, piece: Piece) -> acb:
        """Return what a factor is at the end of a piece over what it is at its start."""
        with precision(self.bits):
            first, last = (values.far.at(path.at(x), [factor])[0][0] for x in piece)
            ratio = last / first
        if not ratio.is_finite() or ratio.contains(0):
            raise UndecidedError
        return ratio

    def _pieces(self, values: PartValues, factor: int, path: Path, most: Literal[0, 1] = 0) -> list[Piece]:
        """Return pieces of a path on which a factor is proved to have no root; UndecidedError if it may.

        On the axis, where it is real, each may have at ``most`` one, which is simple.
        """

        def piece_of(sign: int, low: float, high: float) -> Piece:
            # Poles meet an arc next to the axis, where it ends: looked at first, they end the search.
            shares = (Fraction(share) for share in (low, high))
            ends = sorted(sign * (share if path.kind == "axis" else 1 - share) for share in shares)
            return ends[0], ends[1]

        def decide(sign: int, low: float, high: float) -> bool | None:
            found = self._bound(values, factor, path, piece_of(sign, low, high))
            has_more = found.may_vanish and (found.may_turn or not most)
            if has_more and found.is_as_sharp_as_the_part and not values.is_point:
                raise UndecidedError  # no shorter piece serves
            return not has_more or None

        return sorted(
            piece_of(sign, low, high)
            for sign in path.signs
            for low, high, _ in covered(partial(decide, sign), path.cells, SHORTEST)
        )

    def frequencies(self, part: OpenPart) -> tuple[tuple[Piece, ...], ...]:
        """Return the pieces of the axis in rad/s, as narrow as places where two poles meet are known."""
        at, found = self.axis.frequency, list[tuple[Piece, ...]]()
        for factor, pieces in zip(self._moving, part.pieces, strict=True):
            every = [(at(low), at(high)) for low, high in pieces]
            sides = [[p for p in every if p[0] < 0], [p for p in every if p[0] >= 0]]
            for i, places in enumerate(sides):
                if places and places[0][0] and places[-1][1] and self._are_real_on_axis[factor]:
                    meeting = self._meeting(part.ends, factor, (places[0][0], places[-1][1]))
                    sides[i] = places if meeting is None else [meeting]
            found.append(tuple(chain(*sides)))
        return tuple(found)

    def _meeting(self, ends: Ends, factor: int, piece: Piece) -> Piece | None:
        """Return a smaller piece that holds where two poles on the axis meet: F' is 0 there alone."""
        tf, _ = self.function.at_rest
        polynomial, _ = self._factors[factor]
        with precision(self.bits):
            evaluator = self.function.kernels(tf, (ends,))

            def slopes(omega: arb) -> tuple[acb, acb]:
                at = evaluator.at(acb_series([acb(0, omega), 1], 3))
                series = evaluator.polynomial(polynomial, at)
                return (series[1], 2 * series[2]) if isinstance(series, acb_series) else (acb(0), acb(0))

            def newton(omega: arb) -> arb:
                # A step in s = j omega: F' over F'' is imaginary.
                return omega.mid() - (slopes(omega.mid())[0] / slopes(omega)[1]).imag

            room = WIDENED * (piece[1] - piece[0])
            around = ball(piece[0] - room).union(ball(piece[1] + room))
            if around.contains(0):
                return None  # poles that meet at 0 are real on one side
            first = newton(around)
            if not (first.is_finite() and around.contains(first)):
                return None
            root = narrowed(first, newton, STEPS, SHARE)
            return exact_fraction(root.lower()), exact_fraction(root.upper())


def _directly(values: FirstOrder, factor: int, s: acb, middle: acb) -> Bound:
    """Return what is known of a factor on a box about a point, by balls and by the mean value theorem."""
    near = values.generators(s)
    ((value, slope),) = values.around(s, [factor], near)
    ((centre, terms),) = values.swings(middle, [factor], near)
    by_path = slope * (s - middle)
    mean = sum((term * arb(0, 1) for term in terms), centre) + by_path
    sharper = mean if mean.is_finite() and not mean.rad() > value.rad() else value
    by_part = sum((term.abs_upper() for term in terms), arb(0))
    return Bound(
        bool(sharper.contains(0)),
        bool(slope.contains(0)),
        float(by_part) if by_part.is_finite() else inf,
        float(by_path.abs_upper()) if by_path.is_finite() else inf,
    )


def _keeps_order(function: CharacteristicFunction, box: Box) -> bool:
    tf, _ = function.at_rest
    with precision(BITS):
        kernels = function.kernels(tf, box)
        at, laws = kernels.generators_at(acb(*ANYWHERE)), tf.kernels.dispersions
        return all(at_centre(kernels.value(c, at)).is_finite() for law in laws for c in law.characteristic)


def _kernel_functions(
    function: CharacteristicFunction, factors: Sequence[fmpz_mpoly], point: Box
) -> list[KernelFunction]:
    """Return factors that are entire at s = 0 at a point."""
    tf, _ = function.at_rest
    bound = function.bound_in(tf, point)
    return [KernelFunction(bound, Factored.polynomial(tf.ratio.ring, factor)) for factor in factors]


def _middle(ends: Ends) -> Fraction:
    return (ends[0] + ends[1]) / 2


def share_of_ranges(box: Box, share: Fraction) -> Box:
    """Return the point at a share of each range."""
    return tuple((low + share * (high - low),) * 2 for low, high in box)
