"""Whether a model is stable for every combination of values of its parameters at once.

Input: a model, and the box in which its parameters lie. Output: a :class:`SpreadStability`.

Example: ``m s^2 + b s + k`` with every value off by up to 10 % is stable: next to the resonance the damping
keeps the imaginary part above 0.9 b omega.

Poles are counted at the middle of the box. If no root meets the axis for any combination, and none comes in
from infinity, as many lie in the right half-plane for all of them (boundary crossing theorem; Bhattacharyya,
Chapellat and Keel 1995, theorem 1.4). Boxes that leave it open are halved along the parameter that
contributes most. Combinations that may be unstable are those to which the slopes of roots next to the axis
point; what holds there is proved as for any one point.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import count
from typing import Final, Literal

from flint import acb

from symflex.balls import Branching, Open, branch, precision
from symflex.errors import BudgetError, Diagnostic, ModelError, SymflexError, UsageError
from symflex.loops.boxes import BITS, Box, CharacteristicFunction, FirstOrder, OpenBox
from symflex.loops.chart import Word, count_at
from symflex.loops.over import characteristic, with_values
from symflex.loops.stability_map import SCHEMA
from symflex.model import Model, ModelParameter, spread_box
from symflex.options import StabilityOptions, Stated, share_of
from symflex.print.notebook import Printed
from symflex.print.text import Passage
from symflex.roots.passivity import EnergyProof, energy_proof
from symflex.roots.pole_zero_map import StabilityVerdict
from symflex.transfer import Given

Point = tuple[Fraction, ...]  # a value of every parameter, in SI units
STAYS: Final = "stable or marginal"  # as energy keeps all poles out of the right half-plane
MOST_BOXES = 10_000  # boxes after which it stays undecided: about a minute for lumped loops
MOST_AT_REST = 200  # boxes on which the model is looked at at rest
FOLLOWED = 4  # modes of a distributed model whose poles are pushed towards the axis
TRIES = frozenset(4**i for i in range(8))  # numbers of boxes after which a combination is sought again


@dataclass(frozen=True)
class SpreadStability(Printed):
    """What is proved of stability for all values that parameters may have at once."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    counted_in: tuple[tuple[str, Fraction], ...]  # units in which it prints, and what one of them is
    box: Box
    word: Word | Literal["stable or marginal"]
    boxes: int = 0  # how many were needed
    unstable: int = 0  # poles in the right half-plane for the combination
    combination: Point | None = None  # for which it is proved not to be stable
    open_box: Box | None = None  # a part in which it is undecided
    reason: str = ""

    def __repr__(self) -> str:
        return f"<SpreadStability of {len(self.names)} parameters: {self.word}>"

    def passages(self) -> list[Passage]:
        """Return the verdict, and the box beside the combination or the part that it is about."""
        count = f" by {self.unstable}" if self.unstable else ""
        every = " for every combination"
        word = self.word + {"stable": every, STAYS: every, "unstable": count}.get(self.word, "")
        word += f": {self.reason}" if self.reason else ""
        other: Sequence[Point] = self.open_box or tuple((x,) for x in self.combination or [])
        other = other or [()] * len(self.box)
        rows: list[tuple[str, ...]] = [("", "from", "to", self.word, "to")[: 3 + len(other[0])]]
        for name, (unit, size), *ends in zip(self.names, self.counted_in, self.box, other, strict=True):
            cells = (f"{float(x / size):.6g}" for values in ends for x in values)
            rows.append((f"{name} [{unit}]" if unit else name, *cells))
        status = "certified" if self.certified else "NOT CERTIFIED"
        return [Passage([f"{status}: {word}"]), Passage([], rows)]

    @property
    def certified(self) -> bool:
        """Whether it is decided, either way."""
        return self.word != "undecided"

    def to_json_dict(self) -> dict[str, object]:
        """Return it in the schema ``symflex.stability/1``, in SI units."""

        def named(values: Iterable[object] | None) -> dict[str, object] | None:
            return None if values is None else dict(zip(self.names, values, strict=True))

        spread, part = (
            box and [[float(x) for x in ends] for ends in box] for box in (self.box, self.open_box)
        )
        return {
            "schema": SCHEMA,
            "spread": named(spread),
            "units": named(self.units),
            "verdict": self.word,
            "certified": self.certified,
            "combination": named(self.combination and map(float, self.combination)),
            "unstable": self.unstable,
            "box": named(part),
            "boxes": self.boxes,
            "reasons": [self.reason] if self.reason else [],
        }


def stability_spread(
    model: Model, given: StabilityOptions, values: Mapping[str, Given] | None = None
) -> SpreadStability:
    """Return whether a model is stable for all values at once, each off by a share or by its own ``spread``.

    Raises UsageError: SF902 beside a gain; SF804 if no parameter has a spread; ModelError: SF801 if no pole
    depends on one, or poles cannot be followed; SF501, SF502 if the characteristic function is too large.
    """
    if given.gain or given.over or given.ranges or given.limits:
        raise UsageError(Diagnostic("SF902", "--spread takes no --gain, --over or --range"))
    share = "" if given.spread is None else given.spread
    return find_spread(*spread_function(with_values(model, values), share))


def spread_function(
    model: Model, share: Stated, pair: tuple[str, str] | None = None
) -> tuple[CharacteristicFunction, Box, list[ModelParameter]]:
    """Return a characteristic function in what is spread and moves poles, with the box, and these."""
    ends = spread_box(model.parameters, None if share == "" else share_of(share, "--spread"))
    function = characteristic(model, tuple(ends), tuple(ends.values()), pair)
    moving = [p for p in model.parameters if p.name in ends and (pair or function.depends_on(p.name))]
    if not moving:
        raise ModelError(Diagnostic("SF801", "no pole of the model depends on a parameter with a spread"))
    names = tuple(p.name for p in moving)
    still = tuple((p.name, p.value) for p in model.parameters if p.value and p not in moving)
    function = replace(function, names=names, values=still)
    return function, tuple(ends[n] for n in names), moving


def find_spread(
    function: CharacteristicFunction, box: Box, parameters: Sequence[ModelParameter]
) -> SpreadStability:
    """Return what holds for all parameters of a characteristic function in a box."""
    units, counted_in = (p.unit for p in parameters), (p.counted_in for p in parameters)
    result = SpreadStability(function.names, tuple(units), tuple(counted_in), box, "undecided")
    energy = _energy(function, box)
    stays = replace(result, word=STAYS, reason="nothing supplies energy; poles may lie on the axis")
    try:
        located = function.located(middle_of(box), FOLLOWED)
        if located.verdict.word != "stable":
            is_open = energy is not None and located.verdict.word == "unknown"
            return stays if is_open else _at(result, located.verdict, middle_of(box))
        if energy and energy.rests and (boxes := _boxes_at_rest(function, box)) is not None:
            return replace(result, word="stable", boxes=boxes)
        poles = [complex(root) for root in located.all_poles if not root.im < 0]
        tried: set[Point] = set()
        for s in sorted(poles, key=lambda s: (reach(function, s, box)[0] + s).real)[-FOLLOWED:]:
            if (unstable := _pushed(function, s, box, result, tried)) is not None:
                return unstable
        is_long = function.at_rest[0].is_rational or energy is None  # with waves a box takes longer
        search = _searched(function, box, result, tried, MOST_BOXES if is_long else MOST_AT_REST)
    except BudgetError as error:
        if energy:
            return stays
        return replace(result, reason=error.diagnostics[0].message, open_box=box)
    except SymflexError as error:
        return replace(result, reason=error.diagnostics[0].message)
    if search.decided:
        return search.decided[0]
    if not search.undecided:
        return replace(result, word="stable", boxes=search.spent)
    undecided, boxes = len(search.undecided), search.spent - (search.over is not None)
    if energy:
        return replace(stays, boxes=boxes)
    ends = (str(each.radius) for each in search.undecided if not each.is_bounded)
    reason = next(ends, f"poles may meet the axis in {undecided} of {boxes + undecided} boxes")
    reason = search.over.message if search.over else reason
    return replace(result, boxes=boxes, open_box=search.undecided[0].box, reason=reason)


def _energy(function: CharacteristicFunction, box: Box) -> EnergyProof | None:
    """Return the proof that no combination has a pole on the right, None if energy does not show it."""
    tf = function.at_rest[0]
    if not all(low > 0 for low, _ in box):
        return None
    energy = energy_proof(tf.model, (), tf.output, function.names)
    return energy if energy.is_passive else None


def _boxes_at_rest(function: CharacteristicFunction, box: Box) -> int | None:
    """Return on how many boxes no pole is at 0, None if some stay open."""
    tf, factors = function.at_rest

    def decide(part: OpenBox) -> Open[OpenBox] | None:
        with precision(BITS):
            values = FirstOrder(function, tf, factors, part.box).around(acb(0), range(len(factors)))
        return Open(part) if any(value.contains(0) for value, _ in values) else None

    search: Branching[OpenBox, None] = branch([OpenBox(box, 0.0)], decide, function.halves, most=MOST_AT_REST)
    return None if search.undecided else search.spent


def _searched(
    function: CharacteristicFunction, box: Box, result: SpreadStability, tried: set[Point], most: int
) -> Branching[OpenBox, SpreadStability]:
    """Return boxes on which poles may meet the axis, or a point that is proved unstable."""
    numbers = count(1)

    def decide(each: OpenBox) -> SpreadStability | Open[OpenBox] | None:
        number = next(numbers)
        if not each.is_bounded:
            return Open(each)
        each = function.narrowed(each)
        if not any(each.pieces):
            return None
        if number in TRIES:
            low, high = next(pieces[-1] for pieces in each.pieces if pieces)
            s = complex(0, float(low + high) / 2)
            if (unstable := _pushed(function, s, each.box, result, tried)) is not None:
                return unstable
        return Open(each)

    return branch(
        [function.whole(box)],
        decide,
        function.halves,
        order="breadth",
        most=most,
        until=lambda found, _: bool(found.decided),
        keeps=True,
    )


def _pushed(
    function: CharacteristicFunction, s: complex, part: Box, result: SpreadStability, tried: set[Point]
) -> SpreadStability | None:
    """Return what is proved for the corner to which a root near s moves to the right, if it is unstable."""
    rates = reach(function, s, part)[1]
    corner = tuple(ends[rate.real > 0] for rate, ends in zip(rates, result.box, strict=True))
    if corner in tried:
        return None
    tried.add(corner)
    verdict, _ = count_at(function, corner)
    return _at(result, verdict, corner) if verdict.word == "unstable" else None


def _at(result: SpreadStability, verdict: StabilityVerdict, point: Point) -> SpreadStability:
    if verdict.word == "unknown":
        return replace(result, reason=verdict.reason)
    return replace(result, word=verdict.word, unstable=verdict.right or 0, combination=point)


def middle_of(box: Box) -> Point:
    """Return the middle of a box."""
    return tuple((low + high) / 2 for low, high in box)


def reach(function: CharacteristicFunction, s: complex, box: Box) -> tuple[complex, list[complex]]:
    """Return sizes of the step of a root near s within a box to first order, and each parameter's part."""
    with precision(BITS):
        about, every = function.expanded(tuple((x, x) for x in middle_of(box))), range(len(function.factors))
        slopes = [complex(slope.mid()) or 1e-300 for _, slope in about.around(acb(s), every)]
        values = about.at(acb(s), every)
        i = min(every, key=lambda i: abs(complex(values[i][0].mid()) / slopes[i]))
        pairs = zip(values[i][1], box, strict=True)
        parts = [-complex(x.mid()) / slopes[i] * float(high - low) / 2 for x, (low, high) in pairs]
    return complex(sum(abs(x.real) for x in parts), sum(abs(x.imag) for x in parts)), parts
