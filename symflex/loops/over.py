"""For which values of one parameter, or of two, a model is stable.

Input: a model, and one parameter or two that may stand anywhere: gains, delays, lengths, masses, dampings.
Output: a :class:`StabilityMap` over one, whose ends are enclosed to all digits, or a :class:`StabilityChart`.

Example: ``m s^2 + b s + k + K k exp(-s T)`` with m = 8, b = 60, k = 20000 and K = 0.1 is stable up to
T = 8.55... ms, where a pole meets the axis at 7.96 Hz, and again later.

What a parameter does to the equations chooses the way. If it enters rationally, they are polynomials in it,
and :func:`symflex.loops.find_stable_gains` finds the ends exactly, also where poles stay on the axis. Else
the values are halved until no pole meets the axis for any in a part, or the part is as narrow as the
requested digits; see :mod:`symflex.loops.boxes`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import groupby, pairwise
from math import pi

from flint import acb, arb

from symflex.balls import Branching, Open, ball, bits_for_digits, branch, precision, status_of, two_steps
from symflex.errors import Diagnostic, ModelError, UsageError
from symflex.expressions import names_among
from symflex.loops.boxes import BITS, Box, CharacteristicFunction, Ends, OpenBox
from symflex.loops.chart import StabilityChart, count_at, find_chart
from symflex.loops.find import gain_margins
from symflex.loops.image import real_product, without_image
from symflex.loops.loop import pick_gain
from symflex.loops.of_model import of_rational
from symflex.loops.stability_map import (
    BOXES,
    Boundary,
    Crossing,
    GainInterval,
    Margins,
    PoleCount,
    StabilityMap,
)
from symflex.loops.up_to import ONE, BoxesUpTo, OpenPart, PolesUpTo, share_of_ranges
from symflex.model import Model, ModelParameter, with_numbers
from symflex.model.along import is_tapered
from symflex.model.loss_factors import check_causal
from symflex.options import StabilityOptions, gain_ends, highest_frequency, share_of
from symflex.roots.distributed.far_out import VANISHES
from symflex.roots.passivity import observed
from symflex.transfer import Given
from symflex.transfer.bind import read_values
from symflex.transfer.of_model import assemble, derive_all

Interval = tuple[Ends, PoleCount]
Row = list[OpenBox]  # boxes that touch
WIDER, WIDER_PART = 10, 2  # times of its value that a parameter, of signals or of parts, may have by default
INSIDE = (Fraction(1, 2), Fraction(3, 8))  # shares of a range at which an end of the poles is sought
SLIVER = 64  # parts as narrow as the digits, up to which what lies between two boundaries is theirs
LEAST = 10**6  # part of the range to which values about zero are enclosed
ABOUT = 4  # widths by which a gap is widened to each side to prove that one pair crosses in it
MOST_PARTS = 64  # open parts side by side beyond which poles stay on the axis where two of them meet
MOST_GAPS = 1000  # open parts side by side beyond which a pole touches the axis, or stays on it


def _check_dependence(function: CharacteristicFunction, parameters: Iterable[ModelParameter]) -> None:
    for parameter in parameters:
        if not function.depends_on(parameter.name):
            message = f"no pole of the model depends on '{parameter.name}'"
            hint = f"for every value of it the poles are the same: ask without --over {parameter.name}"
            raise ModelError(Diagnostic("SF801", message, parameter.span, hint))


def stability_over(
    model: Model, given: StabilityOptions, values: Mapping[str, Given] | None = None
) -> StabilityMap | StabilityChart:
    """Return for which values of one parameter or two a model is stable; ``values`` replace declared ones.

    Raises UsageError: SF902 for a parameter that the model does not have, or too many of them; SF804 for a
    range that is needed or empty; ModelError: SF801 if no pole depends on a parameter, or it cannot be
    followed; SF501, SF502 if the characteristic function is too large.
    """
    names = checked_names(given)
    up_to = None if given.up_to is None else 2 * pi * highest_frequency(given.up_to)
    model = with_values(model, values)
    parameters = [pick_gain(model.parameters, name) for name in names]
    limits = tuple(limits_of(model, p, given) for p in parameters)
    nominal = [None if p.value is None else p.value.nearly for p in parameters]
    digits = given.digits or model.analysis.digits or 15
    exact = (
        of_rational(model, names[0], limits[0], digits, up_to, has_pairs=False) if len(names) == 1 else None
    )
    if exact is not None and exact.nominal is None:  # of an angle in degrees
        exact = replace(exact, nominal=nominal[0])
        exact = replace(exact, margins=Margins(gain_margins(exact)))
    if exact is not None and (exact.certified or model.root is not None):  # boxes serve no roots of s
        return exact.of_parameter
    function = characteristic(model, names, limits, has_complex_waves=True)
    _check_dependence(function, parameters)
    end = _end_inside(function, limits)
    is_endless = isinstance(end, str) and end != VANISHES and PolesUpTo.serves(function)
    if len(names) > 1:
        boxes = BoxesUpTo(PolesUpTo.of(function, limits, up_to, circles=ONE)) if is_endless else None
        if up_to is not None and boxes is None:
            reason = str(end) if isinstance(end, str) else "all poles are counted"
            message = f"--up-to does not apply to this chart: {reason}"
            raise UsageError(Diagnostic("SF902", message, None, "leave it out"))
        undecided = float(share_of(given.resolve, "--resolve"))
        return find_chart(function, limits, nominal, parameters, undecided, boxes, str(end))
    search = partial(find_intervals_up_to, function, limits[0], digits, parameters[0], nominal[0], up_to)
    if is_endless:
        return exact.of_parameter if exact is not None and exact.intervals else search(str(end))
    halved = find_intervals(function, limits[0], digits, parameters[0], nominal[0])
    has_image = function.is_complex and not function.is_alone
    halved = without_image(halved, function) if has_image else halved
    # Parts that boxes decide are proved for all poles; along the axis they may be counted up to a frequency.
    if halved.certified or (halved.intervals and halved.verdict.word != "unknown"):
        return halved
    exact = exact or of_rational(model, names[0], limits[0], digits, up_to, has_pairs=True)
    return exact.of_parameter if exact is not None and exact.intervals else halved


def checked_names(given: StabilityOptions) -> tuple[str, ...]:
    """Return the parameters that are asked for; SF902 for too many, or options that apply to none."""
    names = tuple(given.over)
    if len(names) > 2 or len(set(names)) < len(names):  # noqa: PLR2004 (a chart has two axes)
        raise UsageError(Diagnostic("SF902", "give one or two parameters, each once: --over K --over T"))
    if spare := [name for name, *_ in given.ranges if name not in names]:
        message = f"a range of '{spare[0][:64]}', which is not asked for with --over"
        raise UsageError(Diagnostic("SF902", message))
    return names


def _end_inside(function: CharacteristicFunction, ranges: Box) -> float | str:
    """Return the end of the poles at values in ranges: over all of these they may have no known one."""
    middle, beside = (share_of_ranges(ranges, share) for share in INSIDE)
    try:
        return function.whole(middle).radius
    except ModelError:  # a wave equation may lose its highest derivative in the middle
        return function.whole(beside).radius


def seen_pair(model: Model) -> tuple[str, str]:
    """Return output and input of the function whose poles are asked for: one without a filter after it."""
    plain = {row.name for row in assemble(model).outputs if row.divisor.is_one}
    return next((p for p in model.transfer_functions if p[0] in plain), model.transfer_functions[0])


def with_values(model: Model, values: Mapping[str, Given] | None) -> Model:
    """Return a model with other values in place of declared ones."""
    stated = {name: pick_gain(model.parameters, name) for name in values or {}}
    exact = dict(read_values(tuple(stated.values()), values or {}))
    parameters = tuple(replace(p, value=exact[p.name]) if p.name in exact else p for p in model.parameters)
    return replace(model, parameters=parameters)


def characteristic(
    model: Model,
    names: Sequence[str],
    ranges: Box,
    pair: tuple[str, str] | None = None,
    *,
    has_complex_waves: bool = False,
) -> CharacteristicFunction:
    """Return a model's characteristic function in some parameters; SF801 where it cannot be followed."""
    prepared = with_numbers(model, names, in_kernels=not is_tapered(model))
    check_causal(prepared, "stability over a parameter")
    if is_tapered(model) or model.root is not None:
        what = "members that taper" if is_tapered(model) else "roots of s"
        message = f"stability over a parameter is not available with {what}"
        span = pick_gain(model.parameters, names[0]).span
        raise ModelError(Diagnostic("SF801", message, span, _sweep(names[0])))
    seen = pair or seen_pair(prepared)
    if pair is None:
        prepared = observed(prepared, seen[0])
    (tf,) = derive_all(prepared, [seen])
    are_positive = all(low >= 0 for low, _ in ranges)
    function = CharacteristicFunction.of(prepared, tf.whole, names, are_positive=are_positive)
    if function.is_alone and not (has_complex_waves and PolesUpTo.serves(function)):
        real_product(tf.whole, "stability over a parameter")  # refused: there is none
    return function


def _sweep(name: str) -> str:
    return f"follow its poles by value: symflex sweep FILE --over {name}=FROM:TO:lin:20"


def limits_of(model: Model, parameter: ModelParameter, given: StabilityOptions) -> Ends:
    """Return a parameter's range, asked for, declared, or about its value; from 0 if no part has it."""
    name = parameter.name
    of_all = given.limits if len(given.over) == 1 else None
    stated = {n: (low, high) for n, low, high in given.ranges}.get(name, of_all)
    if stated is not None:
        low, high = gain_ends(stated, parameter) or (None, None)
    elif parameter.limits is not None:
        low, high = (x.nearly for x in parameter.limits)
    elif parameter.value is None or not parameter.value.rational:
        low = high = None
    else:
        values = [e for use in model.elements if not use.element.is_source for _, e in use.values]
        values += [d.expression for d in model.definitions]
        is_signal = not model.fields and not any(names_among(e, {name}) for e in values)
        value = parameter.value.nearly
        low, high = sorted(
            (value * 0, value * WIDER) if is_signal else (value / WIDER_PART, value * WIDER_PART)
        )
    if low is None or high is None or not low < high:
        message = f"'{name}' needs a finite range from a smaller to a larger value"
        raise UsageError(Diagnostic("SF804", message, None, f"give one: --range {name} LO HI"))
    if low < 0 and parameter.assume != "real":
        message = f"'{name}' is assumed not to be negative, and its range is"
        raise UsageError(Diagnostic("SF804", message, None, 'begin at 0, or declare assume = "real"'))
    return low, high


def find_intervals(
    function: CharacteristicFunction,
    limits: Ends,
    digits: int,
    parameter: ModelParameter,
    nominal: Fraction | None,
) -> StabilityMap:
    """Return for which values of one parameter a model is stable, the ends enclosed to so many digits."""
    bits = bits_for_digits(digits) + BITS
    parts, gaps, wide, reasons = _free_parts(function, limits, digits, bits)
    counted, unknown = _counted(function, parts, (*gaps, *wide), limits, bits)
    reasons += unknown
    boundaries, intervals = _boundaries(function, counted, gaps, wide, limits, digits, reasons)
    stability = replace(
        _map_of(function, limits, digits, parameter, nominal),
        boundaries=boundaries,
        intervals=intervals,
        is_complete=bool(intervals) or not reasons,
        reasons=tuple(dict.fromkeys(reasons)),
    )
    if nominal is not None and (stability.verdict.word == "unknown" or function.tf.hidden):
        stability = replace(stability, at_nominal=count_at(function, (parameter.value or nominal,))[0])
    return replace(stability, margins=Margins(gain_margins(stability)))


def _free_parts(
    function: CharacteristicFunction, limits: Ends, digits: int, bits: int
) -> tuple[list[Ends], list[OpenBox], list[OpenBox], list[str]]:
    """Return parts in which no pole meets the axis, gaps as narrow as the digits, wider ones, and why."""
    decided: list[Ends] = []
    gaps: list[OpenBox] = []

    def decide(row: Row) -> Row | Open[Row] | None:
        if len(row) > MOST_GAPS:
            return row
        remaining = []
        for box in row:
            narrowed = function.narrowed(box, bits) if box.is_bounded else box
            if narrowed.is_bounded and not any(narrowed.pieces):
                decided.append(box.box[0])
            elif _is_narrow(box.box[0], limits, digits):
                gaps.append(narrowed)
            else:
                remaining.append(narrowed)
        return Open(remaining) if remaining else None

    def halves(row: Row) -> list[Row]:
        parts = [half for box in row for half in function.halves(box)]
        touching = _joined([box.box[0] for box in parts])
        return [[box for box in parts if low <= box.box[0][0] < high] for low, high in touching]

    search = branch([[function.whole((limits,))]], decide, halves, order="breadth", keeps=True)
    reasons = []
    for row in search.decided:
        ends = f"{float(row[0].box[0][0]):.6g} and {float(row[-1].box[0][1]):.6g}"
        reasons.append(f"it could not be decided whether poles meet the axis between {ends}")
    reasons += [search.over.message] if search.over else []
    # Boxes in which more than one boundary may lie.
    wide = [box for row in (*search.decided, *search.undecided) for box in row]
    # The ends do not belong to the range: there the order may be lower, or a pole meet the axis.
    rims = {*limits}
    inside = [gap for gap in (*gaps, *wide) if not rims & {*gap.box[0]}]
    unknown = [box.radius for box in inside if isinstance(box.radius, str)]
    reasons += dict.fromkeys(reason for reason in unknown if reason != VANISHES)
    # Slivers between open parts are left to these.
    slim = Fraction(1, SLIVER)
    parts = [(a, b) for a, b in _joined(decided) if not _is_narrow((a, a + (b - a) * slim), limits, digits)]
    return parts, gaps, wide, reasons


def _counted(
    function: CharacteristicFunction,
    parts: Sequence[Ends],
    gaps: Sequence[OpenBox],
    limits: Ends,
    bits: int,
) -> tuple[list[Interval], list[str]]:
    """Return parts with the poles in each, as far as they are proved, and why they are not."""
    counted, reasons = list[Interval](), list[str]()
    count: PoleCount | None = None
    for before, part in pairwise([limits, *parts]):
        between = [gap for gap in gaps if before[1] <= gap.box[0][0] < part[0]]
        change = 0 if count is None else pair_that_crosses(function, between, (before[0], part[1]), bits)
        if count and change:
            count = PoleCount(count.right + change, count.axis)
        else:
            verdict, axis = count_at(function, ((part[0] + part[1]) / 2,))
            count = None if verdict.right is None else PoleCount(verdict.right, axis)
            count = count or _counted_to_the_end(function, limits, part, bits)
            reasons += [verdict.reason] if count is None else []
        counted += [(part, count)] if count else []
    return counted, reasons


def _counted_to_the_end(
    function: CharacteristicFunction, limits: Ends, part: Ends, bits: int
) -> PoleCount | None:
    """Return the poles in the middle of a part, by their bound and the argument principle, if proved."""
    end = function.whole((limits,)).radius
    if isinstance(end, str) or not PolesUpTo.serves(function):
        return None
    return PolesUpTo.of(function, (limits,), end, bits).count([(part[0] + part[1]) / 2], Fraction(end))


def find_intervals_up_to(
    function: CharacteristicFunction,
    limits: Ends,
    digits: int,
    parameter: ModelParameter,
    nominal: Fraction | None,
    up_to: float | None,
    reason: str,
) -> StabilityMap:
    """Return the same of poles up to a frequency [rad/s], where others have no end for the reason given."""
    poles = PolesUpTo.of(function, (limits,), up_to, bits_for_digits(digits) + BITS)

    def halves(part: OpenPart) -> list[OpenPart]:
        return [] if _is_narrow(part.ends, limits, digits) or poles.is_bare(part.ends) else part.halves

    search = branch(
        [poles.whole],
        poles.narrowed,
        halves,
        order="breadth",
        until=lambda _, waiting: waiting > MOST_PARTS,
        keeps=True,
    )
    gaps, wide, reasons = _open_parts(poles, search)
    reasons.insert(0, reason)
    counted, uncounted = _counted_up_to(poles, sorted(search.decided, key=lambda part: part.ends))
    reasons += [f"poles could not be counted near {float(ends[0]):.6g}" for ends in uncounted]
    radius = float(poles.radius)
    boxes = [OpenBox((part.ends,), radius, poles.frequencies(part)) for part in gaps]
    undecided = [OpenBox((ends,), radius) for ends in (*(part.ends for part in wide), *uncounted)]
    boundaries, intervals = _boundaries(function, counted, boxes, undecided, limits, digits, reasons)
    return replace(
        _map_of(function, limits, digits, parameter, nominal),
        boundaries=boundaries,
        intervals=intervals,
        radius=radius,
        is_complete=False,
        reasons=tuple(dict.fromkeys(reasons)),
    )


def _open_parts(
    poles: PolesUpTo, search: Branching[OpenPart, OpenPart]
) -> tuple[list[OpenPart], list[OpenPart], list[str]]:
    """Return parts as narrow as the digits, wider ones in which poles may leave the axis, and why."""
    narrow = len(search.undecided) - search.unseen - (search.over is not None)
    wide, reasons = search.undecided[narrow:], list[str]()
    bare = [part for part in search.undecided[:narrow] if poles.is_bare(part.ends)]
    gaps = [part for part in search.undecided[:narrow] if part not in bare]
    for low, high in _joined([part.ends for part in bare]):
        near = f"between {float(low):.6g} and {float(high):.6g} a wave equation nearly loses its"
        reasons.append(f"{near} highest derivative: its waves are ever shorter there, and poles ever more")
    if search.over is not None:
        reasons.append(search.over.message)
    elif wide:
        ends = sorted(part.ends for part in wide)
        between = f"{float(ends[0][0]):.6g} and {float(ends[-1][1]):.6g}"
        what = f"it could not be decided whether poles leave the axis between {between}"
        reasons.append(f"{what}: a narrower range may decide it")
    return gaps, [*bare, *wide], reasons


def _map_of(
    function: CharacteristicFunction,
    limits: Ends,
    digits: int,
    parameter: ModelParameter,
    nominal: Fraction | None,
) -> StabilityMap:
    """Return the map of a parameter of which nothing is known yet."""
    return StabilityMap(
        parameter.name,
        parameter.unit,
        limits,
        nominal=nominal,
        digits=digits,
        method=BOXES,
        is_gain=False,
        tf=function.tf.name,
        counted_in=parameter.counted_in,
    )


def _counted_up_to(poles: PolesUpTo, parts: Sequence[OpenPart]) -> tuple[list[Interval], list[Ends]]:
    """Return parts that touch as one with the poles in it, and those in which they could not be counted.

    Circles may differ, and a pole on the axis may pass one: as many are counted there as any part has. With
    as few as any has, a part with poles on the axis would be stable.
    """
    counted, uncounted = list[Interval](), list[Ends]()
    for circle, row in groupby(parts, key=lambda part: part.circle):
        for ends in _joined([part.ends for part in row]):
            count = None if circle is None else poles.count([(ends[0] + ends[1]) / 2], circle)
            if count is None:
                uncounted.append(ends)
                continue
            before = counted[-1] if counted and counted[-1][0][1] == ends[0] else None
            if before is None:
                counted.append((ends, count))
            elif before[1].right == count.right:
                both = PoleCount(count.right, max(count.axis, before[1].axis))
                counted[-1] = ((before[0][0], ends[1]), both)
            else:  # poles passed the circle
                uncounted.append((ends[0], ends[0]))
                counted.append((ends, count))
    return counted, uncounted


def pair_that_crosses(
    function: CharacteristicFunction, gaps: Sequence[OpenBox], around: Ends, bits: int
) -> int:
    """Return by how many a pair of poles that crosses the axis in a gap changes their number to the right.

    No pole meets the axis around the gap. About it interval Newton proves one value, and one frequency, with
    a root of one factor (Moore 1966); there it moves to one side. 0 where that is not proved.
    """
    pieces = [
        (i, piece) for gap in gaps for i, factor_pieces in enumerate(gap.pieces) for piece in factor_pieces
    ]
    which = {i for i, _ in pieces}
    if len(which) != 1 or (function.factors[min(which)], 1) not in function.tf.den.factors:
        return 0
    first, last = min(gap.box[0][0] for gap in gaps), max(gap.box[0][1] for gap in gaps)
    low, high = min(a for _, (a, _) in pieces), max(b for _, (_, b) in pieces)
    wide = (first - ABOUT * (last - first), last + ABOUT * (last - first))
    is_inside = around[0] < wide[0] and wide[1] < around[1] and all(gap.is_bounded for gap in gaps)
    if not is_inside or function.is_mirrored_at((wide,), (low, high + ABOUT * (high - low))):
        return 0
    with precision(bits):
        omega, rise = acb(0, ball((low + high) / 2)), ball(ABOUT * (high - low))
        s, values = omega + acb(0, arb(0, rise)), function.expanded((wide,))
        near = values.generators(s)
        ((_, slope),), ((_, (rate,)),) = values.around(s, [*which], near), values.at(s, [*which], near)
        ((value, _),) = values.at(omega, [*which], near)
        turn = slope * acb(0, 1)
        status = status_of(two_steps(value, turn, rate), (rise, values.halves[0]))
        moves_right = bool((rate / turn).imag > 0)
    poles = 1 if function.is_complex else 2
    return (poles if moves_right else -poles) if status == "one" else 0


def _is_narrow(ends: Ends, limits: Ends, digits: int) -> bool:
    """Tell whether a part is as narrow as the digits."""
    size = max(abs(ends[0]), abs(ends[1]), (limits[1] - limits[0]) / LEAST)
    return bool((ends[1] - ends[0]) * 10 ** (digits + 3) < size)


def _joined(parts: Iterable[Ends], apart: Fraction = Fraction(0)) -> list[Ends]:
    """Return parts that touch as one, ascending, also those that a share of their upper end keeps apart."""
    joined: list[Ends] = []
    for low, high in sorted(parts):
        if joined and low - joined[-1][1] <= apart * abs(high):
            joined[-1] = (joined[-1][0], max(high, joined[-1][1]))
        else:
            joined.append((low, high))
    return joined


def _boundaries(
    function: CharacteristicFunction,
    counted: Sequence[Interval],
    gaps: Sequence[OpenBox],
    wide: Sequence[OpenBox],
    limits: Ends,
    digits: int,
    reasons: list[str],
) -> tuple[tuple[Boundary, ...], tuple[GainInterval, ...]]:
    """Return the ends between parts in which poles are counted, and the parts between these.

    Where it is not decided what happens between two parts, they end where they are proved.
    """
    boundaries: list[Boundary] = []
    first, last = (counted[0][0][0], counted[-1][0][1]) if counted else limits
    is_open = any(gap.box[0][1] <= first for gap in wide)
    starts, ends = [ball(first) if is_open else ball(limits[0]).union(ball(first))], list[arb]()
    poles = [count for _, count in counted]
    for (before, count), (after, other) in pairwise(counted):
        between = [gap for gap in gaps if before[1] <= gap.box[0][0] < after[0]]
        boundary = ball(before[1]).union(ball(after[0]))
        # Others come in pairs.
        is_real = (count.right - other.right) % 2 == 1 and not function.is_complex
        unbounded = {gap.radius for gap in between if not gap.is_bounded}
        is_open = any(before[1] <= gap.box[0][0] < after[0] for gap in wide) or bool(unbounded - {VANISHES})
        if count == other and not is_open:
            is_open = True
            reasons.append(
                f"it could not be decided whether poles touch the axis near {float(before[1]):.6g}"
            )
        elif unbounded and not is_open:  # a real pole that does not pass the axis at 0 passes it at infinity
            slopes, every = function.expanded(((before[1], after[0]),)), range(len(function.factors))
            with precision(BITS):
                values = slopes.around(acb(0), every)
            is_open = not is_real or any(value.contains(0) for value, _ in values)
        reasons += [VANISHES] * (is_open and VANISHES in unbounded)
        is_far = bool(unbounded)
        omegas = () if is_far else _frequencies(between, digits, is_real=is_real)
        boundaries.append(
            Boundary(
                boundary, (Crossing(boundary, omegas, is_infinite=is_far and not is_open, is_open=is_open),)
            )
        )
        starts.append(ball(after[0]) if is_open else boundary)
        ends.append(ball(before[1]) if is_open else boundary)
    is_open = any(last <= gap.box[0][0] for gap in wide)
    ends.append(ball(last) if is_open else ball(limits[1]).union(ball(last)))
    intervals = tuple(map(GainInterval, starts, ends, poles)) if poles else ()
    return tuple(boundaries), intervals


def _frequencies(gaps: Sequence[OpenBox], digits: int, *, is_real: bool) -> tuple[arb, ...]:
    """Return where on the axis poles may be [rad/s], apart in the digits; of a real pole that is 0."""
    pieces = (piece for gap in gaps for factor_pieces in gap.pieces for piece in factor_pieces)
    places = _joined(pieces, Fraction(1, 10**digits))
    return tuple(arb(0) if is_real and not low else ball(low).union(ball(high)) for low, high in places)
