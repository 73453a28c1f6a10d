"""For which gains a loop is stable, and where poles cross the axis: the result, as JSON and as text."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from math import pi
from typing import TYPE_CHECKING, Literal

from flint import arb

from symflex.balls import ball, precision
from symflex.loops.apart import PolesApart
from symflex.print.text import INDENT, WIDTH, Passage, passages_text
from symflex.roots import decimals, figure
from symflex.roots.pole_zero_map import WITHOUT_END, StabilityVerdict

if TYPE_CHECKING:
    from collections.abc import Iterator

SCHEMA = "symflex.stability/1"
BITS = 128
NOTHING_APART = PolesApart()
NO_NOMINAL = "the gain has no value"
BESIDE = "the gain lies at a boundary, or outside of what was examined"


@dataclass(frozen=True, slots=True)
class Boundary:
    """A gain at which the number of poles right of the imaginary axis, or on it, changes."""

    gain: arb  # enclosure
    crossings: tuple[Crossing, ...]  # what happens there

    @property
    def frequencies(self) -> tuple[arb, ...]:
        """At which poles are on the axis [rad/s], ascending."""
        frequencies = [omega for crossing in self.crossings for omega in crossing.frequencies]
        return tuple(sorted(frequencies, key=lambda omega: float(omega.mid())))


@dataclass(frozen=True, slots=True)
class GainInterval:
    """An open interval of gains on which the number of unstable poles does not change."""

    # low and high: its ends; ``None`` where it has none.
    low: arb | None
    high: arb | None
    poles: PoleCount  # closed-loop poles that are not in the left half plane

    def holds(self, gain: Fraction) -> bool:
        """Tell whether a gain is proved to lie inside."""
        with precision(BITS):
            value = ball(gain)
            above = self.low is None or bool(value > self.low)
            return above and (self.high is None or bool(value < self.high))


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
class AllowedBandwidth:
    """Up to which frequency a loop can follow, with a gain margin of 6 dB."""

    gain: Fraction | None  # the largest gain with that margin; ``None`` when every gain is stable
    # At which the loop gain first falls below one [rad/s]; ``None`` when there is no such gain, or when the
    # loop gain is below one at the lowest frequencies.
    frequency: arb | None
    phase_margin: arb | None  # the smallest one there in absolute value [rad], positive for lag
    is_limited: bool  # by a boundary: twice the gain is one. Otherwise the gains examined end there.


@dataclass(frozen=True)
class StabilityMap:
    """The gains for which all closed-loop poles are in the open left half plane.

    Parameters
    ----------
    gain, unit : str
        Name and SI unit of the gain; the unit is empty when it is not known.
    limits : (Fraction or None, Fraction or None)
        The range examined, without its ends.
    boundaries : tuple of Boundary
        Ascending.
    intervals : tuple of GainInterval
        Between them, ascending.
    nominal : Fraction or None
        The gain's declared value.
    gain_margins : tuple of GainMargin
        Of the nominal gain, when the loop is stable there.
    phase_margins : tuple of PhaseMargin
        At every crossover, ascending in frequency.
    radius : arb or None
        Poles were counted up to this abs(s) [rad/s]; ``None``: all of them.
    is_complete : bool
        It is proved that no pole lies right of the axis beyond the radius.
    reasons : tuple of str
        What is not proved.
    digits : int
        Asked for.
    bandwidth : AllowedBandwidth or None
        Which the stable gains next to 0 allow; ``None`` where there are none, or the loop is closed in
        several places.
    margin_beyond : float or None
        Which phase margins beyond the radius are not below [rad], where no more than that is known of them.
    method : str
        How poles were counted: ``polynomials``, ``argument principle``, ``roots`` (all found, and by which
        engines), ``network``; and ``passive loop`` where that proves that there are none.
    apart : PolesApart
        Poles that no gain moves, without kernels: hidden ones are not counted in ``intervals``.
    at_nominal : StabilityVerdict or None
        What holds at a nominal gain that was examined alone: it lies in none of the intervals, or delays
        leave open what holds beyond the radius.
    tf : str
        ``"OUT/IN"``, whose input and output see the poles that are not hidden; empty where nothing is.
    is_passive : bool
        It is proved that no gain of the range brings a pole into the right half plane.
    is_narrowed : bool
        The range ends where a delayed term may outweigh the others of the highest power of s.
    data_end : float or None
        Where the data end that the model was fitted to, which is ``radius`` then [rad/s].
    beyond : tuple of float
        Poles of the nominal gain right of the axis beyond that, without kernels: their abs(s) [rad/s].
    gain_at_end : float or None
        The gain with which the loop gain is one where the data end.
    """

    gain: str
    unit: str
    limits: tuple[Fraction | None, Fraction | None]
    boundaries: tuple[Boundary, ...] = ()
    intervals: tuple[GainInterval, ...] = ()
    nominal: Fraction | None = None
    gain_margins: tuple[GainMargin, ...] = ()
    phase_margins: tuple[PhaseMargin, ...] = ()
    radius: float | None = None
    is_complete: bool = True
    reasons: tuple[str, ...] = ()
    digits: int = 15
    bandwidth: AllowedBandwidth | None = None
    margin_beyond: float | None = None
    method: str = ""
    apart: PolesApart = NOTHING_APART
    at_nominal: StabilityVerdict | None = None
    tf: str = ""
    is_passive: bool = False
    is_narrowed: bool = False
    data_end: float | None = None
    beyond: tuple[float, ...] = ()
    gain_at_end: float | None = None

    def __repr__(self) -> str:
        count = len(self.boundaries)
        status = "certified" if self.certified else "not certified"
        return f"<StabilityMap of {self.gain}: {count} boundar{'y' if count == 1 else 'ies'}, {status}>"

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
        """Up to which abs(s) poles right of the axis are counted [rad/s]; ``None``: all of them are."""
        return None if self.is_complete and self.data_end is None else self.radius

    @property
    def where_data_end(self) -> str:
        """Up to where the loop is judged, in words; empty where no data end."""
        return "" if self.data_end is None else f"up to {_hertz(self.data_end)}, where the data end"

    @property
    def stable(self) -> tuple[GainInterval, ...]:
        """The intervals with all poles in the open left half plane, as far as they are counted."""
        return tuple(interval for interval in self.intervals if interval.poles.is_stable)

    @property
    def nominal_interval(self) -> GainInterval | None:
        """The interval that holds the nominal gain."""
        if self.nominal is None:
            return None
        return next((i for i in self.intervals if i.holds(self.nominal)), None)

    @property
    def verdict(self) -> StabilityVerdict:
        """Whether the loop is stable with its nominal gain, in the words of all commands."""
        return replace(self._word, hidden=self.apart.verdict.hidden, moving=self.apart.verdict.moving)

    @property
    def _word(self) -> StabilityVerdict:
        interval = self.nominal_interval
        if interval is None:
            return self.at_nominal or StabilityVerdict(
                "unknown", None, False, NO_NOMINAL if self.nominal is None else BESIDE
            )
        right, axis = interval.poles.right, interval.poles.axis
        beyond = "" if self.is_complete else self.reasons[0]
        beyond = beyond or self.where_data_end
        if right:
            return StabilityVerdict("unstable", None if beyond else right, True, beyond, right)
        where = f"{_poles(axis)} on the imaginary axis" if axis else ""
        if not self.is_complete and not (self.is_passive and axis):
            reason = f"{where}; {beyond}" if where else beyond
            right_of_it = 0 if self.is_passive else None
            return self.at_nominal or StabilityVerdict("unknown", right_of_it, False, reason)
        return StabilityVerdict("marginal" if axis else "stable", 0, True, where or beyond)

    @property
    def is_stable(self) -> bool | None:
        """Whether the loop is stable with its nominal gain; ``None`` where that is not proved."""
        word = self.verdict.word
        return None if word == "unknown" else word == "stable"

    @property
    def phase_margin(self) -> PhaseMargin | None:
        """The smallest phase margin in absolute value."""
        return min(self.phase_margins, key=lambda m: abs(float(m.angle.mid())), default=None)

    def to_json_dict(self) -> dict[str, object]:
        """Return the map in the schema ``symflex.stability/1``, ready for :func:`json.dumps`."""
        worst = self.phase_margin
        return {
            "schema": SCHEMA,
            "gain": self.gain,
            "tf": self.tf,
            "unit": self.unit,
            "range": [None if x is None else str(x) for x in self.limits],
            "certified": self.certified,
            "counted_up_to_rad_per_s": self.counted_up_to,
            "data_end": self._data_end(),
            "reasons": list(self.reasons),
            "boundaries": [self._boundary(i) for i in range(len(self.boundaries))],
            "intervals": [
                {
                    "low": real_json(i.low, self.digits),
                    "high": real_json(i.high, self.digits),
                    "right_half_plane_poles": i.poles.right,
                    "imaginary_axis_poles": i.poles.axis,
                    "stable": i.poles.is_stable,
                    "verdict": i.poles.word,
                }
                for i in self.intervals
            ],
            "nominal": None if self.nominal is None else str(self.nominal),
            "stable": self.is_stable,
            "verdict": self.verdict.to_json_dict(),
            "gain_margins": [
                {
                    "factor": real_json(m.factor, self.digits),
                    "decibels": float(decibels(m.factor).mid()),
                    "frequencies_hz": [float(hertz(w).mid()) for w in m.boundary.frequencies],
                }
                for m in self.gain_margins
            ],
            "phase_margins": [
                {
                    "degrees": real_json(degrees(m.angle), self.digits),
                    "omega": real_json(m.frequency, self.digits),
                    "frequency_hz": float(hertz(m.frequency).mid()),
                    "smallest": m is worst,
                }
                for m in self.phase_margins
            ],
            "margin_beyond": None
            if self.margin_beyond is None or self.radius is None
            else {
                "omega": self.radius,
                "frequency_hz": self.radius / (2 * pi),
                "degrees": self.least_degrees_beyond,
            },
            "bandwidth": self._bandwidth(),
        }

    @property
    def least_degrees_beyond(self) -> float:
        """:attr:`margin_beyond` in degrees, 0 without one."""
        return (self.margin_beyond or 0.0) * 180 / pi

    def _bandwidth(self) -> dict[str, object] | None:
        bandwidth = self.bandwidth
        if bandwidth is None:
            return None
        omega, angle = bandwidth.frequency, bandwidth.phase_margin
        return {
            "gain": None if bandwidth.gain is None else float(bandwidth.gain),
            "omega": real_json(omega, self.digits),
            "frequency_hz": None if omega is None else float(hertz(omega).mid()),
            "phase_margin_degrees": None if angle is None else float(degrees(angle).mid()),
            "limited": bandwidth.is_limited,
        }

    def _data_end(self) -> dict[str, object] | None:
        if self.data_end is None:
            return None
        beyond = [omega / (2 * pi) for omega in self.beyond]
        own = {"gain_with_loop_gain_one": self.gain_at_end, "right_half_plane_poles_beyond_hz": beyond}
        return {"frequency_hz": self.data_end / (2 * pi), **own}

    def change(self, index: int) -> int:
        """Return by how many poles the number right of the axis grows at a boundary, as the gain grows."""
        return self.intervals[index + 1].poles.right - self.intervals[index].poles.right

    def _boundary(self, index: int) -> dict[str, object]:
        boundary = self.boundaries[index]
        return {
            "gain": real_json(boundary.gain, self.digits),
            "omega": [real_json(w, self.digits) for w in boundary.frequencies],
            "frequency_hz": [float(hertz(w).mid()) for w in boundary.frequencies],
            "through_infinity": any(c.is_infinite for c in boundary.crossings),
            "mirrored_poles_meet": any(c.is_symmetric for c in boundary.crossings),
            "no_solution": any(c.is_singular for c in boundary.crossings),
            "poles_entering_right_half_plane": self.change(index),
        }


def real_json(value: arb | None, digits: int) -> dict[str, str] | None:
    """Return the certified decimals of a real number, and a bound of their error."""
    if value is None:
        return None
    printed = decimals(value, arb(0), digits)
    return {"value": printed.re, "radius": printed.radius}


def hertz(omega: arb) -> arb:
    """Return a frequency in Hz from one in rad/s."""
    with precision(max(BITS, omega.bits())):
        return omega / (2 * arb.pi())


def short_hertz(omega: arb) -> str:
    """Return a frequency in rad/s as text in Hz."""
    return figure(hertz(omega), SHORT_DIGITS, trimmed=True)


def degrees(angle: arb) -> arb:
    """Return an angle in degrees from one in rad."""
    with precision(max(BITS, angle.bits())):
        return angle * 180 / arb.pi()


def decibels(factor: arb) -> arb:
    """Return ``20 log10`` of a positive factor."""
    with precision(BITS):
        return 20 * factor.log() / arb(10).log()


@dataclass(frozen=True, slots=True)
class Crossing:
    """A gain at which poles may pass from one side of the imaginary axis to the other."""

    gain: arb  # enclosure of the gain
    # Enclosures of omega >= 0 [rad/s] at which poles are on the axis; exactly 0 where they pass through s =
    # 0.
    frequencies: tuple[arb, ...]
    is_infinite: bool = False  # a pole passes through infinity: the highest power of s vanishes
    # Poles that mirror each other in the axis for every gain meet on it, and leave it or enter it.
    is_symmetric: bool = False
    is_singular: bool = False  # the equations have no unique solution there
    is_open: bool = False  # it is not decided whether poles are on the axis there
    # By how many the poles of factors with kernels grow right of the axis with the gain, None where unknown.
    change: int | None = 0


@dataclass(frozen=True, slots=True)
class PoleCount:
    """Closed-loop poles that are not in the open left half plane, with multiplicity.

    Hidden ones that no gain moves count where they lie right of the axis only.

    Examples
    --------
    >>> PoleCount(2, 0) + PoleCount(0, 1)
    PoleCount(right=2, axis=1)
    """

    right: int  # in the open right half plane
    axis: int  # on the imaginary axis

    def __add__(self, other: PoleCount) -> PoleCount:
        return PoleCount(self.right + other.right, self.axis + other.axis)

    @property
    def is_stable(self) -> bool:
        """All poles lie in the open left half plane."""
        return not self.right and not self.axis

    @property
    def word(self) -> Literal["stable", "marginal", "unstable"]:
        """What this says of stability, if none is missing."""
        return "unstable" if self.right else "marginal" if self.axis else "stable"


SHORT_DIGITS = 6


def stability_text(stability: StabilityMap) -> str:
    """Return stable ranges, boundaries, counts and margins, in 80 columns for up to 20 digits."""
    return passages_text(_passages(stability), WIDTH)


def stability_html(stability: StabilityMap) -> str:
    """Return the same for a notebook: paragraphs and tables."""
    from symflex.print.html import passages_html  # only notebooks ask

    return passages_html(_passages(stability))


def _passages(stability: StabilityMap) -> Iterator[Passage]:
    unit = f" [{stability.unit}]" if stability.unit else ""
    lines = [f"{stability.gain}{unit}   {_status(stability)}", f"{INDENT}examined: {_examined(stability)}"]
    lines += [
        f"{INDENT}{'' if WITHOUT_END in reason else 'not proved: '}{reason}" for reason in stability.reasons
    ]
    if stability.nominal is not None:
        lines.append(f"{INDENT}{stability.gain} = {_number(stability.nominal)}: {stability.verdict.sentence}")
    if stability.verdict.hidden:
        lines.append(f"{INDENT}{stability.tf}: {stability.verdict.hidden_motion}")
    yield Passage(lines)
    if not stability.intervals:
        return
    scope = "" if stability.is_complete else ", as far as poles were counted"
    scope = f", {stability.where_data_end}" if stability.where_data_end else scope
    stable = [2 * INDENT + _between(interval, stability) for interval in stability.stable]
    yield Passage([f"{INDENT}stable for{scope}" + (":" if stable else ": no gain"), *stable])
    marginal = [
        2 * INDENT + _between(i, stability) for i in stability.intervals if i.poles.word == "marginal"
    ]
    if marginal:
        yield Passage([f"{INDENT}marginal for{scope}, with poles on the imaginary axis:", *marginal])
    head = (stability.gain, "radius", "omega [rad/s]", "f [Hz]", "unstable poles")
    rows = [head, *(_boundary_row(stability, i) for i in range(len(stability.boundaries)))]
    yield Passage(
        [f"{INDENT}boundaries: {len(stability.boundaries) or 'none'}"], rows if stability.boundaries else ()
    )
    counted = [
        (_end(i.low, "-inf"), _end(i.high, "inf"), str(i.poles.right), str(i.poles.axis))
        for i in stability.intervals
    ]
    title = f"{INDENT}poles that are not in the left half plane"
    yield Passage([title], [("from", "to", "right of the axis", "on the axis"), *counted])
    if stability.gain_margins or stability.phase_margins:
        yield _margins(stability)
    if stability.data_end is not None:
        yield Passage(
            [f"{INDENT}beyond {_hertz(stability.data_end)} nothing was measured", *_beyond(stability)]
        )
    if stability.bandwidth is not None:
        said = 2 * INDENT + bandwidth_text(stability.gain, stability.bandwidth)
        yield Passage([f"{INDENT}bandwidth with a gain margin of 6 dB", said])
    if stability.boundaries:
        yield Passage([f"{INDENT}radius bounds the distance from the printed gain to the boundary"])


def _beyond(stability: StabilityMap) -> Iterator[str]:
    """Tell what matters beyond the end of the data: poles of the function, and the loop gain there."""
    if stability.beyond:
        places = ", ".join(_hertz(omega) for omega in stability.beyond)
        shown = f"{stability.gain} = {_number(stability.nominal)}"
        count = _poles(len(stability.beyond))
        yield f"{2 * INDENT}{count} of the model right of the axis for {shown}: {places}"
    if stability.gain_at_end is not None:
        yield f"{2 * INDENT}the loop gain there is taken to stay below one: for {stability.gain} up to"
        yield f"{2 * INDENT}{stability.gain_at_end:.{SHORT_DIGITS}g} it is so where the data end"


def _status(stability: StabilityMap) -> str:
    if stability.certified:
        if stability.where_data_end:
            return f"certified {stability.where_data_end}"
        if stability.margin_beyond is not None:
            return f"certified: the loop is passive, {stability.gain} acts as a spring and a damper"
        return "certified: all poles right of the imaginary axis counted"
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


def _poles(count: int) -> str:
    return f"{count} pole" + ("s" if count != 1 else "")


def _between(interval: GainInterval, stability: StabilityMap) -> str:
    low = "" if interval.low is None else f"{_exact(interval.low, stability.digits)} < "
    high = "" if interval.high is None else f" < {_exact(interval.high, stability.digits)}"
    return f"{low}{stability.gain}{high}"


def _exact(value: arb, digits: int) -> str:
    if value.is_exact() and value == value.floor() and abs(value) < 10**digits:
        return str(int(value.unique_fmpz() or 0))
    return figure(value, digits)


def _boundary_row(stability: StabilityMap, index: int) -> tuple[str, ...]:
    boundary = stability.boundaries[index]
    printed = decimals(boundary.gain, arb(0), stability.digits).told
    change = stability.change(index)
    passing = f"{change:+d}" if change else "touch the axis" if boundary.frequencies else "0"
    return (printed.re, printed.radius, *_places(boundary, stability.digits), passing)


def _places(boundary: Boundary, digits: int) -> tuple[str, str]:
    if not boundary.frequencies:
        if any(c.is_singular for c in boundary.crossings):
            return ("no solution", "")
        infinite = any(c.is_infinite for c in boundary.crossings)
        return ("infinite" if infinite else "on the axis", "")
    omegas = [figure(w, digits) for w in boundary.frequencies]
    cycles = [short_hertz(w) for w in boundary.frequencies]
    return ", ".join(omegas), ", ".join(cycles)


def _margins(stability: StabilityMap) -> Passage:
    lines = [f"{INDENT}margins of {stability.gain} = {_number(stability.nominal)}"]
    rows: list[tuple[str, ...]] = []
    for margin in stability.gain_margins:
        places = ", ".join(f"{short_hertz(w)} Hz" for w in margin.boundary.frequencies)
        factor, size = figure(margin.factor, SHORT_DIGITS), figure(decibels(margin.factor), SHORT_DIGITS)
        rows.append(("gain", f"x {factor}", f"{size} dB", places))
    worst = stability.phase_margin
    for each in stability.phase_margins:
        angle = degrees(each.angle)
        direction = "lag" if angle > 0 else "lead"
        place = f"{short_hertz(each.frequency)} Hz"
        flag = ", the smallest" if each is worst and len(stability.phase_margins) > 1 else ""
        shown = figure(abs(angle), SHORT_DIGITS)
        rows.append(("phase", f"{shown} deg", direction, place + flag))
    if stability.margin_beyond is not None and stability.radius is not None:
        place = f"all above {stability.radius / (2 * pi):.{SHORT_DIGITS}g} Hz"
        rows.append(("phase", f"{stability.least_degrees_beyond:.4g} deg", "least", place))
    return Passage(lines, rows, has_head=False)


def bandwidth_text(gain: str, bandwidth: AllowedBandwidth) -> str:
    """Return the bandwidth that a loop allows, in one line."""
    if bandwidth.gain is None:
        return f"without limit: every {gain} > 0 is stable"
    at = f"{gain} = {_number(bandwidth.gain)}"
    if bandwidth.frequency is None or bandwidth.phase_margin is None:
        return f"none: at {at} the loop gain is below one at the lowest frequencies"
    place = f"{short_hertz(bandwidth.frequency)} Hz at {at}"
    angle = degrees(bandwidth.phase_margin)
    size = figure(abs(angle), 3, trimmed=True)
    shown = f"{place}, phase margin {size} deg {'lag' if angle > 0 else 'lead'}"
    return shown if bandwidth.is_limited else f"at least {shown}"


def _hertz(omega: float) -> str:
    return f"{omega / (2 * pi):.{SHORT_DIGITS}g} Hz"


def _end(value: arb | None, infinite: str) -> str:
    return infinite if value is None else _exact(value, SHORT_DIGITS)


def _number(value: Fraction | None) -> str:
    return "" if value is None else f"{float(value):.{SHORT_DIGITS}g}"
