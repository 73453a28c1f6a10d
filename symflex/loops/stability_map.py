"""For which gains a loop is stable, and where poles cross the axis: the result, as JSON and as text."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from math import pi
from typing import TYPE_CHECKING, Literal

from flint import arb

from symflex.balls import ball, bits_for_digits, precision
from symflex.loops.apart import PolesApart
from symflex.print.notebook import Printed
from symflex.print.text import INDENT, Passage
from symflex.roots import decimals, figure
from symflex.roots.pole_zero_map import WITHOUT_END, StabilityVerdict
from symflex.roots.root import degrees, hertz, real_json, short_hertz

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from symflex.loops.peak import LoopPeaks

SCHEMA = "symflex.stability/1"
BITS = 128  # precision of gains and their limits
NOTHING_APART = PolesApart()
NO_NOMINAL = "the gain has no value"
MOST_BOUNDARIES = 10  # printed: as many as are seen at once; --all prints all
BOXES = "boxes"  # the method for parameters that need not be gains
BESIDE = "the value lies at a boundary, or outside of what was examined"


@dataclass(frozen=True, slots=True)
class Boundary:
    """A gain at which the number of poles in the right half-plane, or on the axis, changes."""

    gain: arb  # enclosure
    crossings: tuple[Crossing, ...]  # what happens there

    @property
    def frequencies(self) -> tuple[arb, ...]:
        """At which poles are on the axis [rad/s], ascending."""
        frequencies = [omega for crossing in self.crossings for omega in crossing.frequencies]
        return tuple(sorted(frequencies, key=lambda omega: float(omega.mid())))

    def to_json_dict(self, digits: int, change: int) -> dict[str, object]:
        """Return it as JSON data, with the change of poles in the right half-plane as the gain grows."""
        return {
            "gain": real_json(self.gain, digits),
            "omega": [real_json(w, digits) for w in self.frequencies],
            "frequency_hz": [float(hertz(w).mid()) for w in self.frequencies],
            "through_infinity": any(c.is_infinite for c in self.crossings),
            "mirrored_poles_meet": any(c.is_symmetric for c in self.crossings),
            "no_solution": any(c.is_singular for c in self.crossings),
            "poles_entering_right_half_plane": change,
        }


@dataclass(frozen=True, slots=True)
class GainInterval:
    """An open interval of gains on which the number of unstable poles does not change."""

    low: arb | None  # low and high: its ends; ``None`` where it has none
    high: arb | None
    poles: PoleCount  # closed-loop poles that are not in the left half-plane

    def holds(self, gain: Fraction) -> bool:
        """Tell whether a gain is proved to lie inside."""
        with precision(BITS):
            value = ball(gain)
            above = self.low is None or bool(value > self.low)
            return above and (self.high is None or bool(value < self.high))

    def to_json_dict(self, digits: int) -> dict[str, object]:
        """Return it as JSON data."""
        return {
            "low": real_json(self.low, digits),
            "high": real_json(self.high, digits),
            "right_half_plane_poles": self.poles.right,
            "imaginary_axis_poles": self.poles.axis,
            "stable": self.poles.is_stable,
            "verdict": self.poles.word,
        }


@dataclass(frozen=True, slots=True)
class GainMargin:
    """By which factor the gain may change until a boundary."""

    factor: arb  # above 1: upwards; below: downwards
    boundary: Boundary  # which one


@dataclass(frozen=True, slots=True)
class PhaseMargin:
    """How much the phase may change at a frequency where the loop gain is one."""

    angle: arb  # [rad]; positive: lag until poles reach the axis; negative: lead
    frequency: arb  # crossover frequency [rad/s]


@dataclass(frozen=True, slots=True)
class AllowedCrossover:
    """The frequency at which the loop gain falls below one, with a gain margin of 6 dB."""

    gain: Fraction | None  # the largest gain with that margin; ``None`` when every gain is stable
    frequency: arb | None  # where the loop gain first falls below one [rad/s]; None if nowhere
    phase_margin: arb | None  # the smallest one there in absolute value [rad], positive for lag
    is_limited: bool  # by a boundary: twice the gain is one. Otherwise the gains examined end there.

    def to_json_dict(self, digits: int) -> dict[str, object]:
        """Return it as JSON data."""
        omega, angle = self.frequency, self.phase_margin
        return {
            "gain": None if self.gain is None else float(self.gain),
            "omega": real_json(omega, digits),
            "frequency_hz": None if omega is None else float(hertz(omega).mid()),
            "phase_margin_degrees": None if angle is None else float(degrees(angle).mid()),
            "limited": self.is_limited,
        }


@dataclass(frozen=True, slots=True)
class Margins:
    """What a loop that is stable with its nominal gain still takes, and what stable gains allow."""

    gains: tuple[GainMargin, ...] = ()
    phases: tuple[PhaseMargin, ...] = ()  # at every crossover, ascending in frequency
    crossover: AllowedCrossover | None = None  # which stable gains next to 0 allow, of one loop
    least_beyond: float | None = None  # phase margins beyond the radius are no smaller [rad], if known
    peaks: LoopPeaks | None = None  # if they were asked for

    @property
    def smallest_phase(self) -> PhaseMargin | None:
        """The smallest phase margin in absolute value."""
        return min(self.phases, key=lambda m: abs(float(m.angle.mid())), default=None)

    @property
    def least_degrees_beyond(self) -> float:
        """``least_beyond`` in degrees, 0 without one."""
        return (self.least_beyond or 0.0) * 180 / pi

    def to_json_dict(self, digits: int, radius: float | None) -> dict[str, object]:
        """Return them as JSON data; ``radius`` is that beyond which margins have a bound [rad/s]."""
        worst, has_bound = self.smallest_phase, self.least_beyond is not None and radius is not None
        return {
            "gain_margins": [
                {
                    "factor": real_json(m.factor, digits),
                    "decibels": float(decibels(m.factor).mid()),
                    "frequencies_hz": [float(hertz(w).mid()) for w in m.boundary.frequencies],
                }
                for m in self.gains
            ],
            "phase_margins": [
                {
                    "degrees": real_json(degrees(m.angle), digits),
                    "omega": real_json(m.frequency, digits),
                    "frequency_hz": float(hertz(m.frequency).mid()),
                    "smallest": m is worst,
                }
                for m in self.phases
            ],
            "peaks": self.peaks and self.peaks.to_json_dict(),
            "margin_beyond": {
                "omega": radius,
                "frequency_hz": (radius or 0.0) / (2 * pi),
                "degrees": self.least_degrees_beyond,
            }
            if has_bound
            else None,
            "bandwidth": self.crossover and self.crossover.to_json_dict(digits),
        }


@dataclass(frozen=True, slots=True)
class DataEnd:
    """Up to where a loop about a fitted function is judged, and what that function does beyond."""

    omega: float  # where the data of the fit end [rad/s]
    gain: float | None  # with which the loop gain is one there; None without a loop gain
    beyond: tuple[float, ...]  # abs(s) of right-half-plane poles beyond, without kernels [rad/s]

    def to_json_dict(self) -> dict[str, object]:
        """Return it as JSON data."""
        return {
            "frequency_hz": self.omega / (2 * pi),
            "gain_with_loop_gain_one": self.gain,
            "right_half_plane_poles_beyond_hz": [omega / (2 * pi) for omega in self.beyond],
        }


NO_MARGINS = Margins()


@dataclass(frozen=True)
class StabilityMap(Printed):
    """The gains for which all closed-loop poles are in the open left half-plane."""

    gain: str  # its name
    unit: str  # its SI unit; empty when it is not known
    limits: tuple[Fraction | None, Fraction | None]  # the range examined, without its ends
    boundaries: tuple[Boundary, ...] = ()  # ascending
    intervals: tuple[GainInterval, ...] = ()  # between them, ascending
    nominal: Fraction | None = None  # the gain's declared value
    margins: Margins = NO_MARGINS
    radius: float | None = None  # poles were counted up to this abs(s) [rad/s]; ``None``: all of them
    is_complete: bool = True  # it is proved that no pole lies in the right half-plane beyond the radius
    reasons: tuple[str, ...] = ()  # what is open, and why
    digits: int = 15  # asked for
    method: str = ""  # polynomials, argument principle, roots, passive loop; boxes if no gain
    apart: PolesApart = NOTHING_APART  # poles that no gain moves: hidden ones are not in ``intervals``
    at_nominal: StabilityVerdict | None = None  # what holds there alone, if ``intervals`` leave it open
    tf: str = ""  # ``"OUT/IN"``, which sees the poles that are not hidden; empty where nothing is
    is_passive: bool = False  # it is proved that no gain of the range brings a pole into the right half-plane
    is_narrowed: bool = False  # the range ends where a delayed term may outweigh the others
    data: DataEnd | None = None  # of a fit; where they end is the ``radius`` then
    counted_in: tuple[str, Fraction] | None = None  # the unit in which it prints, and what one of it is
    is_gain: bool = True  # the parameter is asked for as the gain of a loop

    @property
    def of_parameter(self) -> StabilityMap:
        """The same of a parameter that is asked for as no gain of a loop."""
        return replace(self, is_gain=False)

    def __repr__(self) -> str:
        count = len(self.boundaries)
        status = "certified" if self.certified else "not certified"
        return f"<StabilityMap of {self.gain}: {count} boundar{'y' if count == 1 else 'ies'}, {status}>"

    def passages(self, most: int | None = MOST_BOUNDARIES) -> Iterator[Passage]:
        """Return stable ranges, boundaries, counts and margins, in 80 columns for up to 20 digits.

        With ``most``, only that many boundaries and ranges from the lowest on; their number is said.
        """
        return _passages(self.shown, most)

    @property
    def shown(self) -> StabilityMap:
        """The map with gains in the unit in which it prints, such as rpm."""
        unit, size = self.counted_in or (self.unit, Fraction(1))
        if size == 1:
            return replace(self, unit=unit)
        return self.in_terms_of(self.gain, unit, lambda gain: gain * ball(1 / size), lambda gain: gain / size)

    def in_terms_of(
        self, name: str, unit: str, enclosed: Callable[[arb], arb], exact: Callable[[Fraction], Fraction]
    ) -> StabilityMap:
        """Return the map over an increasing function of the gain, which takes a ball and an exact number."""

        def ball_of(gain: arb | None) -> arb | None:
            with precision(max(BITS, bits_for_digits(self.digits) + BITS)):
                return None if gain is None else enclosed(gain)

        def value_of(gain: Fraction | None) -> Fraction | None:
            return None if gain is None else exact(gain)

        moved = self.with_boundaries([replace(b, gain=ball_of(b.gain) or b.gain) for b in self.boundaries])
        crossover = self.crossover and replace(self.crossover, gain=value_of(self.crossover.gain))
        at_end = None if self.data is None or self.data.gain is None else Fraction(self.data.gain)
        return replace(
            moved,
            gain=name,
            unit=unit,
            counted_in=None,
            limits=(value_of(self.limits[0]), value_of(self.limits[1])),
            intervals=tuple(replace(i, low=ball_of(i.low), high=ball_of(i.high)) for i in self.intervals),
            nominal=value_of(self.nominal),
            margins=replace(moved.margins, crossover=crossover),
            data=self.data and replace(self.data, gain=None if at_end is None else float(exact(at_end))),
        )

    def with_boundaries(self, boundaries: Sequence[Boundary]) -> StabilityMap:
        """Return the map with other boundaries in their place, of which margins tell."""
        moved = dict(zip(map(id, self.boundaries), boundaries, strict=True))
        gains = (replace(m, boundary=moved.get(id(m.boundary), m.boundary)) for m in self.gain_margins)
        margins = replace(self.margins, gains=tuple(gains))
        return replace(self, boundaries=tuple(boundaries), margins=margins)

    def __post_init__(self) -> None:
        if not self.is_complete and not self.reasons:
            message = "what is not counted needs a reason"
            raise ValueError(message)

    @property
    def certified(self) -> bool:
        """All of it is proved, for all poles."""
        return self.is_complete and not self.reasons

    @property
    def counted_up_to(self) -> float | None:
        """Up to which abs(s) poles in the right half-plane are counted [rad/s]; ``None``: all of them are."""
        return None if self.is_complete and self.data is None else self.radius

    @property
    def where_data_end(self) -> str:
        """Up to where the loop is judged, in words; empty where no data end."""
        return "" if self.data is None else f"up to {_hertz(self.data.omega)}, where the data end"

    @property
    def gain_margins(self) -> tuple[GainMargin, ...]:
        """Factors by which the nominal gain may change until a boundary; none unless the loop is stable."""
        return self.margins.gains

    @property
    def phase_margins(self) -> tuple[PhaseMargin, ...]:
        """The phase margins at every crossover, ascending in frequency."""
        return self.margins.phases

    @property
    def crossover(self) -> AllowedCrossover | None:
        """The crossover that stable gains next to 0 allow, of one loop."""
        return self.margins.crossover

    @property
    def peaks(self) -> LoopPeaks | None:
        """The peaks with the nominal gain, if the loop is stable and they were asked for."""
        return self.margins.peaks

    @property
    def data_end(self) -> float | None:
        """Where the data of a fit end [rad/s]."""
        return None if self.data is None else self.data.omega

    @property
    def stable(self) -> tuple[GainInterval, ...]:
        """The intervals with all poles in the open left half-plane, as far as they are counted."""
        return tuple(interval for interval in self.intervals if interval.poles.is_stable)

    @property
    def nominal_interval(self) -> GainInterval | None:
        """The interval that contains the nominal gain."""
        if self.nominal is None:
            return None
        return next((i for i in self.intervals if i.holds(self.nominal)), None)

    @property
    def verdict(self) -> StabilityVerdict:
        """Whether the loop is stable with its nominal gain, in the words of all commands."""
        interval, beyond = self.nominal_interval, "" if self.is_complete else self.reasons[0]
        beyond = beyond or self.where_data_end
        if interval is None or (self.is_gain and self.reasons and self.at_nominal):
            reason = NO_NOMINAL if self.nominal is None else BESIDE
            word = self.at_nominal or StabilityVerdict("unknown", None, False, reason)
        else:
            right, axis = interval.poles.right, interval.poles.axis
            where = f"{_poles(axis)} on the imaginary axis" if axis else ""
            if right:
                word = StabilityVerdict("unstable", None if beyond else right, True, beyond, right)
            elif not self.is_complete and not (self.is_passive and axis):
                reason = f"{where}; {beyond}" if where else beyond
                least = 0 if self.is_passive else None
                word = self.at_nominal or StabilityVerdict("unknown", least, False, reason)
            else:
                word = StabilityVerdict("marginal" if axis else "stable", 0, True, where or beyond)
        known = self.apart.verdict if self.method != BOXES or self.at_nominal is None else self.at_nominal
        return replace(word, hidden=known.hidden, moving=known.moving)

    @property
    def is_stable(self) -> bool | None:
        """Whether the loop is stable with its nominal gain; ``None`` where that is not proved."""
        word = self.verdict.word
        return None if word == "unknown" else word == "stable"

    @property
    def phase_margin(self) -> PhaseMargin | None:
        """The smallest phase margin in absolute value."""
        return self.margins.smallest_phase

    def to_json_dict(self) -> dict[str, object]:
        """Return the map in the schema ``symflex.stability/1``, ready for :func:`json.dumps`."""
        return {
            "schema": SCHEMA,
            "gain": self.gain,
            "parameter": self.gain,
            "tf": self.tf,
            "unit": self.unit,
            "range": [None if x is None else str(x) for x in self.limits],
            "certified": self.certified,
            "counted_up_to_rad_per_s": self.counted_up_to,
            "data_end": self.data and self.data.to_json_dict(),
            "reasons": list(self.reasons),
            "boundaries": [
                b.to_json_dict(self.digits, self.change(i)) for i, b in enumerate(self.boundaries)
            ],
            "intervals": [interval.to_json_dict(self.digits) for interval in self.intervals],
            "nominal": None if self.nominal is None else str(self.nominal),
            "stable": self.is_stable,
            "verdict": self.verdict.to_json_dict(),
            **self.margins.to_json_dict(self.digits, self.radius),
        }

    def change(self, index: int) -> int:
        """Return the change in the number of right half-plane poles at a boundary, as the gain grows."""
        return self.intervals[index + 1].poles.right - self.intervals[index].poles.right


def decibels(factor: arb) -> arb:
    """Return ``20 log10`` of a positive factor."""
    with precision(BITS):
        return 20 * factor.log() / arb(10).log()


@dataclass(frozen=True, slots=True)
class Crossing:
    """A gain at which poles may pass from one side of the imaginary axis to the other."""

    gain: arb  # enclosure of the gain
    frequencies: tuple[arb, ...]  # of poles on the axis [rad/s], exactly 0 where they pass through it
    is_infinite: bool = False  # a pole passes through infinity: the highest power of s vanishes
    is_symmetric: bool = False  # poles that mirror each other for every gain meet on the axis
    is_singular: bool = False  # the equations have no unique solution there
    is_open: bool = False  # it is not decided whether poles are on the axis there
    change: int | None = 0  # of right-half-plane poles with kernels, as it grows; None if unknown


@dataclass(frozen=True, slots=True)
class PoleCount:
    """Closed-loop poles that are not in the open left half-plane, with multiplicity.

    Hidden ones that no gain moves count where they lie in the right half-plane only.

    >>> PoleCount(2, 0) + PoleCount(0, 1)
    PoleCount(right=2, axis=1)
    """

    right: int  # in the open right half-plane
    axis: int  # on the imaginary axis

    def __add__(self, other: PoleCount) -> PoleCount:
        return PoleCount(self.right + other.right, self.axis + other.axis)

    @property
    def is_stable(self) -> bool:
        """All poles lie in the open left half-plane."""
        return not self.right and not self.axis

    @property
    def word(self) -> Literal["stable", "marginal", "unstable"]:
        """What this says of stability, if none is missing."""
        return "unstable" if self.right else "marginal" if self.axis else "stable"


SHORT_DIGITS = 6
SHOWN = 3  # frequencies of one boundary in print; the others are in the JSON


def _passages(stability: StabilityMap, most: int | None) -> Iterator[Passage]:
    unit = f" [{stability.unit}]" if stability.unit else ""
    lines = [f"{stability.gain}{unit}   {_status(stability)}", f"{INDENT}examined: {_examined(stability)}"]
    lines += [f"{INDENT}{'' if WITHOUT_END in x else 'not proved: '}{x}" for x in stability.reasons]
    if stability.nominal is not None:
        lines.append(f"{INDENT}{stability.gain} = {_number(stability.nominal)}: {stability.verdict.sentence}")
    if stability.verdict.hidden:
        lines.append(f"{INDENT}{stability.tf}: {stability.verdict.hidden_motion}")
    yield Passage(lines)
    if not stability.intervals:
        return
    scope = "" if stability.is_complete else ", as far as poles were counted"
    scope = f", {stability.where_data_end}" if stability.where_data_end else scope
    stable = _first([2 * INDENT + _between(interval, stability) for interval in stability.stable], most)
    word = "gain" if stability.is_gain else "value"
    yield Passage([f"{INDENT}stable for{scope}" + (":" if stable else f": no {word}"), *stable])
    marginal = [
        2 * INDENT + _between(i, stability) for i in stability.intervals if i.poles.word == "marginal"
    ]
    if marginal:
        shown = _first(marginal, most)
        yield Passage([f"{INDENT}marginal for{scope}, with poles on the imaginary axis:", *shown])
    count = len(stability.boundaries)
    rows = [_boundary_row(stability, i) for i in range(count)[:most]]
    head = (stability.gain, "radius", "omega [rad/s]", "f [Hz]", "unstable poles")
    said = f"{count}, the first {len(rows)} shown; --all shows all" if len(rows) < count else count or "none"
    yield Passage([f"{INDENT}boundaries: {said}"], [head, *rows] if rows else ())
    counted: list[tuple[str, ...]] = [("from", "to", "right half-plane", "on the axis")]
    for i in stability.intervals[:most]:
        ends = _end(i.low, "-inf", SHORT_DIGITS, i), _end(i.high, "inf", SHORT_DIGITS, i)
        counted.append((*ends, str(i.poles.right), str(i.poles.axis)))
    yield Passage([f"{INDENT}poles that are not in the left half-plane"], counted)
    if stability.gain_margins or stability.phase_margins:
        yield _margins(stability)
    if stability.peaks is not None:
        lines = [f"{INDENT}peaks of {stability.gain} = {_number(stability.nominal)}"]
        yield Passage(lines, tuple(stability.peaks.rows), has_head=False)
    if stability.data is not None:
        beyond = f"{INDENT}beyond {_hertz(stability.data.omega)} nothing was measured"
        yield Passage([beyond, *_beyond(stability, stability.data)])
    if stability.crossover is not None:
        said = 2 * INDENT + crossover_text(stability.gain, stability.crossover)
        yield Passage([f"{INDENT}gain crossover with a gain margin of 6 dB", said])
    if stability.boundaries:
        value = "gain" if stability.is_gain else "value"
        yield Passage([f"{INDENT}radius bounds the distance from the printed {value} to the boundary"])


def _first(lines: Sequence[str], most: int | None) -> list[str]:
    """Return the first lines, and how many follow."""
    left = 0 if most is None else len(lines) - most
    return [*lines[:most], f"{2 * INDENT}and {left} more"] if left > 0 else [*lines]


def _beyond(stability: StabilityMap, data: DataEnd) -> Iterator[str]:
    """Tell what matters beyond the end of the data: poles of the function, and the loop gain there."""
    if count := len(data.beyond):
        places = ", ".join(_hertz(omega) for omega in data.beyond)
        shown = f"{stability.gain} = {_number(stability.nominal)}"
        yield f"{2 * INDENT}{_poles(count)} of the model in the right half-plane for {shown}: {places}"
    if data.gain is not None:
        yield f"{2 * INDENT}the loop gain there is taken to stay below one: for {stability.gain} up to"
        yield f"{2 * INDENT}{data.gain:.{SHORT_DIGITS}g} it does so where the data end"


def _poles(count: int) -> str:
    return f"{count} pole{'s' * (count != 1)}"


def _hertz(omega: float) -> str:
    return f"{omega / (2 * pi):.{SHORT_DIGITS}g} Hz"


def _status(stability: StabilityMap) -> str:
    if stability.certified:
        if stability.where_data_end:
            return f"certified {stability.where_data_end}"
        if stability.margins.least_beyond is not None:
            return f"certified: the loop is passive, {stability.gain} acts as a spring and a damper"
        return "certified: all poles in the right half-plane counted"
    if not stability.is_complete and stability.radius is not None:
        return f"NOT CERTIFIED beyond {stability.radius / (2 * pi):.4g} Hz: poles are counted up to there"
    return "NOT CERTIFIED"


def _examined(stability: StabilityMap) -> str:
    low, high = stability.limits
    name = stability.gain
    if not stability.intervals:
        return "no range" if stability.nominal is None else f"{name} = {_number(stability.nominal)} alone"
    if low is None and high is None:
        return f"every {name}"
    if high is None:
        return f"{name} > {_number(low)}"
    if low is None:
        return f"{name} < {_number(high)}"
    where = ", where no delayed term outweighs the others" if stability.is_narrowed else ""
    return f"{_number(low)} < {name} < {_number(high)}{where}"


def _between(interval: GainInterval, stability: StabilityMap) -> str:
    low, high = (_end(x, "", stability.digits, interval) for x in (interval.low, interval.high))
    return f"{low and f'{low} < '}{stability.gain}{high and f' < {high}'}"


def _end(value: arb | None, infinite: str, digits: int, interval: GainInterval) -> str:
    """Return an end of an interval, 0 where it is that to the digits of the other end."""
    if value is None:
        return infinite
    other = interval.high if value is interval.low else interval.low
    if value.contains(0) and (other is None or value.abs_upper() < abs(other).lower() / 10**digits):
        return "0"
    if value.is_exact() and value == value.floor() and abs(value) < 10**digits:
        return str(int(value.unique_fmpz() or 0))
    return figure(value, digits)


def _boundary_row(stability: StabilityMap, index: int) -> tuple[str, ...]:
    boundary, digits, change = stability.boundaries[index], stability.digits, stability.change(index)
    printed = decimals(boundary.gain, arb(0), digits).readable
    kinds, places = boundary.crossings, boundary.frequencies
    omegas = ", ".join(figure(w, digits) for w in places[:SHOWN])
    if places[SHOWN:]:
        omegas += f", {len(places)} in all"
    elif not places:
        is_far = any(c.is_infinite for c in kinds)
        omegas = (
            "no solution" if any(c.is_singular for c in kinds) else "infinite" if is_far else "on the axis"
        )
    cycles = ", ".join(short_hertz(w) for w in places[:SHOWN])
    passing = f"{change:+d}" if change else "touch the axis" if places else "0"
    if stability.method == BOXES and any(c.is_open for c in kinds):
        omegas = passing = "not decided"
    return printed.re, printed.radius, omegas, cycles, passing


def _margins(stability: StabilityMap) -> Passage:
    lines = [f"{INDENT}margins of {stability.gain} = {_number(stability.nominal)}"]
    rows: list[tuple[str, ...]] = []
    for margin in stability.gain_margins:
        places = ", ".join(f"{short_hertz(w)} Hz" for w in margin.boundary.frequencies)
        factor, size = figure(margin.factor, SHORT_DIGITS), figure(decibels(margin.factor), SHORT_DIGITS)
        if stability.is_gain:
            rows.append(("gain", f"x {factor}", f"{size} dB", places))
        else:
            end = figure(margin.boundary.gain, SHORT_DIGITS)
            rows.append(("up to" if margin.factor > 1 else "down to", end, f"x {factor}", places))
    worst = stability.phase_margin
    for each in stability.phase_margins:
        angle = degrees(each.angle)
        direction = "lag" if angle > 0 else "lead"
        where = f"{short_hertz(each.frequency)} Hz"
        flag = ", the smallest" if each is worst and len(stability.phase_margins) > 1 else ""
        shown = figure(abs(angle), SHORT_DIGITS)
        rows.append(("phase", f"{shown} deg", direction, where + flag))
    if stability.margins.least_beyond is not None and stability.radius is not None:
        where = f"all above {stability.radius / (2 * pi):.{SHORT_DIGITS}g} Hz"
        rows.append(("phase", f"{stability.margins.least_degrees_beyond:.4g} deg", "least", where))
    return Passage(lines, rows, has_head=False)


def crossover_text(gain: str, crossover: AllowedCrossover) -> str:
    """Return the gain crossover that a gain margin of 6 dB allows, in one line."""
    if crossover.gain is None:
        return f"without limit: every {gain} > 0 is stable"
    at = f"{gain} = {_number(crossover.gain)}"
    if crossover.frequency is None or crossover.phase_margin is None:
        return f"none: at {at} the loop gain is below one at the lowest frequencies"
    where = f"{short_hertz(crossover.frequency)} Hz at {at}"
    angle = degrees(crossover.phase_margin)
    size = figure(abs(angle), 3, trimmed=True)
    shown = f"{where}, phase margin {size} deg {'lag' if angle > 0 else 'lead'}"
    shown += ": not usable" if abs(angle) < 30 else ""  # noqa: PLR2004 (with less it rings too long)
    return shown if crossover.is_limited else f"at least {shown}"


def _number(value: Fraction | None) -> str:
    return "" if value is None else f"{float(value):.{SHORT_DIGITS}g}"
