"""Plain text for a terminal: the stable gains of a loop and its margins."""

from __future__ import annotations

from fractions import Fraction
from math import pi

from flint import arb

from symflex.loops import AllowedBandwidth, Boundary, GainInterval, StabilityMap, decibels, degrees, hertz
from symflex.print.text import INDENT, aligned
from symflex.roots import decimals

SHORT_DIGITS = 6


def stability_text(found: StabilityMap) -> str:
    """Return stable ranges, boundaries, counts and margins, in 80 columns for up to 20 digits."""
    unit = f" [{found.unit}]" if found.unit else ""
    lines = [f"{found.gain}{unit}   {_status(found)}", f"{INDENT}examined: {_examined(found)}"]
    lines += [f"{INDENT}not proved: {reason}" for reason in found.reasons]
    if found.nominal is not None:
        lines.append(f"{INDENT}{found.gain} = {_number(found.nominal)}: {nominal_text(found)}")
    scope = "" if found.is_complete else ", as far as poles were counted"
    stable = found.stable
    lines += ["", f"{INDENT}stable for{scope}" + (":" if stable else ": no gain")]
    lines += [2 * INDENT + _between(interval, found) for interval in stable]
    lines += ["", f"{INDENT}boundaries: {len(found.boundaries) or 'none'}"]
    if found.boundaries:
        lines += aligned(
            [
                (found.gain, "radius", "omega [rad/s]", "f [Hz]", "unstable poles"),
                *(_boundary_row(found, i) for i in range(len(found.boundaries))),
            ]
        )
    lines += ["", f"{INDENT}poles that are not in the left half plane"]
    rows = [("from", "to", "right of the axis", "on the axis")]
    rows += [
        (_end(i.low, "-inf"), _end(i.high, "inf"), str(i.poles.right), str(i.poles.axis))
        for i in found.intervals
    ]
    lines += aligned(rows)
    if found.gain_margins or found.phase_margins:
        lines += _margins(found)
    if found.bandwidth is not None:
        lines += ["", f"{INDENT}bandwidth, where the gain may still double (6 dB)"]
        lines.append(2 * INDENT + bandwidth_text(found.gain, found.bandwidth))
    if found.boundaries:
        lines += ["", f"{INDENT}radius bounds the distance from the printed gain to the boundary"]
    return "\n".join(lines)


def _status(found: StabilityMap) -> str:
    if found.certified:
        return "certified: all poles right of the imaginary axis counted"
    if not found.is_complete and found.radius is not None:
        return f"NOT CERTIFIED beyond {found.radius / (2 * pi):.4g} Hz: poles are counted up to there"
    return "NOT CERTIFIED"


def _examined(found: StabilityMap) -> str:
    low, high = found.limits
    name = found.gain
    if low is None and high is None:
        return f"every {name}"
    if high is None:
        return f"{name} > {_number(low)}"
    if low is None:
        return f"{name} < {_number(high)}"
    return f"{_number(low)} < {name} < {_number(high)}"


def nominal_text(found: StabilityMap) -> str:
    """Say whether the loop is stable with the gain's declared value."""
    interval = found.nominal_interval
    if interval is None:
        return "at a boundary, or outside of what was examined"
    if interval.poles.is_stable:
        return "stable" if found.is_complete else "stable as far as poles were counted"
    right, axis = interval.poles.right, interval.poles.axis
    if right:
        least = "" if found.is_complete else "at least "
        return f"unstable, {least}{_poles(right)} in the right half plane"
    return f"not asymptotically stable, {_poles(axis)} on the imaginary axis"


def _poles(count: int) -> str:
    return f"{count} pole" + ("s" if count != 1 else "")


def _between(interval: GainInterval, found: StabilityMap) -> str:
    low = "" if interval.low is None else f"{_exact(interval.low, found.digits)} < "
    high = "" if interval.high is None else f" < {_exact(interval.high, found.digits)}"
    return f"{low}{found.gain}{high}"


def _exact(value: arb, digits: int) -> str:
    if value.is_exact() and value == value.floor() and abs(value) < 10**digits:
        return str(int(value.unique_fmpz() or 0))
    return decimals(value, arb(0), digits).re


def _boundary_row(found: StabilityMap, index: int) -> tuple[str, ...]:
    boundary = found.boundaries[index]
    printed = decimals(boundary.gain, arb(0), found.digits)
    change = found.change(index)
    passing = f"{change:+d}" if change else "touch the axis"
    return (printed.re, printed.radius, *_places(boundary, found.digits), passing)


def _places(boundary: Boundary, digits: int) -> tuple[str, str]:
    if not boundary.frequencies:
        infinite = any(c.is_infinite for c in boundary.crossings)
        return ("infinite" if infinite else "on the axis", "")
    omegas = [decimals(w, arb(0), digits).re for w in boundary.frequencies]
    cycles = [f"{float(hertz(w).mid()):.{SHORT_DIGITS}g}" for w in boundary.frequencies]
    return ", ".join(omegas), ", ".join(cycles)


def _margins(found: StabilityMap) -> list[str]:
    lines = ["", f"{INDENT}margins of {found.gain} = {_number(found.nominal)}"]
    rows: list[tuple[str, ...]] = []
    for margin in found.gain_margins:
        places = ", ".join(
            f"{float(hertz(w).mid()):.{SHORT_DIGITS}g} Hz" for w in margin.boundary.frequencies
        )
        factor = decimals(margin.factor, arb(0), SHORT_DIGITS).re
        size = decimals(decibels(margin.factor), arb(0), SHORT_DIGITS).re
        rows.append(("gain", f"x {factor}", f"{size} dB", places))
    worst = found.phase_margin
    for each in found.phase_margins:
        angle = degrees(each.angle)
        direction = "lag" if angle > 0 else "lead"
        place = f"{float(hertz(each.frequency).mid()):.{SHORT_DIGITS}g} Hz"
        flag = ", the smallest" if each is worst and len(found.phase_margins) > 1 else ""
        shown = decimals(abs(angle), arb(0), SHORT_DIGITS).re
        rows.append(("phase", f"{shown} deg", direction, place + flag))
    return lines + aligned(rows)


def bandwidth_text(gain: str, found: AllowedBandwidth) -> str:
    """Return the bandwidth that a loop allows, in one line."""
    if found.gain is None:
        return f"without limit: every {gain} > 0 is stable"
    at = f"{gain} = {_number(found.gain)}"
    if found.frequency is None or found.phase_margin is None:
        return f"none: at {at} the loop gain is below one from the lowest frequencies on"
    place = f"{float(hertz(found.frequency).mid()):.{SHORT_DIGITS}g} Hz at {at}"
    angle = float(degrees(found.phase_margin).mid())
    shown = f"{place}, phase margin {abs(angle):.3g} deg {'lag' if angle > 0 else 'lead'}"
    return shown if found.is_limited else f"at least {shown}"


def _end(value: arb | None, infinite: str) -> str:
    return infinite if value is None else _exact(value, SHORT_DIGITS)


def _number(value: Fraction | None) -> str:
    return "" if value is None else f"{float(value):.{SHORT_DIGITS}g}"
