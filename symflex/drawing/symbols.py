r"""The symbols of elements, written down or a function each, in :data:`SYMBOLS` by the element's type.

A symbol is drawn from its first end at the origin to its second at ``(length, 0)``; what stands at one node
or holds one is drawn about that node's point. What a type has no entry for is drawn as a box with its name.

    spring    0,0 --/\/\/\-- length,0
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import cos, pi, sin
from typing import TYPE_CHECKING, Final, Literal

from symflex.drawing.geometry import BOLD, FILLED, LINE, MEMBER, PAPER, PLAIN, THIN, Point, Stroke

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

Strokes = tuple[Stroke, ...]
Role = Literal["branch", "body", "support", "source", "coupling", "member"]


def line(*points: Point, width: float = LINE, is_dashed: bool = False) -> Stroke:
    """Return a line through points."""
    return Stroke(points, width, PLAIN, is_dashed)


def outline(*points: Point, fill: str = PAPER, width: float = LINE) -> Stroke:
    """Return a closed and filled outline."""
    return Stroke((*points, points[0]), width, fill)


def rectangle(x0: float, y0: float, x1: float, y1: float, fill: str = PAPER, width: float = LINE) -> Stroke:
    """Return a rectangle."""
    return outline((x0, y0), (x1, y0), (x1, y1), (x0, y1), fill=fill, width=width)


def arc(x: float, y: float, r: float, first: float, last: float, width: float = LINE) -> Stroke:
    """Return a part of a circle between two angles [degrees]."""
    count = max(6, int(abs(last - first) / 12))
    angles = [pi / 180 * (first + (last - first) * i / count) for i in range(count + 1)]
    return Stroke(tuple((x + r * cos(a), y + r * sin(a)) for a in angles), width)


def circle(x: float, y: float, r: float, fill: str = PAPER, width: float = LINE) -> Stroke:
    """Return a circle."""
    return Stroke(arc(x, y, r, 0, 360).points, width, fill)


HEAD: Final = 4.2
"""Length of an arrow's head [points]."""
DOT: Final = 1.4
"""Radius of the dot of a joint."""


def head(tip: Point, direction: Point, size: float = HEAD, colour: str = "#000000") -> Stroke:
    """Return the head of an arrow with its tip at a point."""
    (x, y), (dx, dy) = tip, direction
    back, side = (x - size * dx, y - size * dy), 0.34 * size
    wings = ((back[0] - side * dy, back[1] + side * dx), (back[0] + side * dy, back[1] - side * dx))
    return outline(tip, *wings, fill=colour, width=0.3)


def arrow(start: Point, end: Point, width: float = LINE, *, is_double: bool = False) -> Strokes:
    """Return a straight arrow along x or y."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    size = (dx * dx + dy * dy) ** 0.5
    d = (dx / size, dy / size)
    tip, tail = (end[0] - 3 * d[0], end[1] - 3 * d[1]), (start[0] + 3 * d[0], start[1] + 3 * d[1])
    strokes = (line(tail if is_double else start, tip, width=width), head(end, d))
    return (*strokes, head(start, (-d[0], -d[1]))) if is_double else strokes


def turning(x: float, y: float, r: float) -> Strokes:
    """Return an arrow that turns counterclockwise about a point."""
    return (
        arc(x, y, r, -40, 190, BOLD * 0.7),
        head((x + r * cos(pi * 1.12), y + r * sin(pi * 1.12)), (0.25, -0.97)),
    )


HATCH: Final = 3.2
"""Depth of the hatching behind a surface that does not move."""


def wall(y0: float, y1: float, side: int = -1, x: float = 0.0) -> Strokes:
    """Return a surface along y with hatching behind it, to the left where ``side`` is -1."""
    count = max(2, round((y1 - y0) / HATCH))
    step = (y1 - y0) / count
    lines = [
        line((x, y0 + (i + 1) * step), (x + side * HATCH, y0 + i * step), width=THIN) for i in range(count)
    ]
    return (line((x, y0), (x, y1), width=1.0), *lines)


def floor(x0: float, x1: float, y: float = 0.0) -> Strokes:
    """Return a surface along x with hatching below it."""
    count = max(2, round((x1 - x0) / HATCH))
    step = (x1 - x0) / count
    lines = [line((x0 + (i + 1) * step, y), (x0 + i * step, y - HATCH), width=THIN) for i in range(count)]
    return (line((x0, y), (x1, y), width=1.0), *lines)


def guide(y0: float, y1: float, side: int, x: float) -> Strokes:
    """Return a wall on one side of a surface along y, with rollers between."""
    rollers = (circle(x + side * 2.0, y, 2.0) for y in (y0 + 4.0, y1 - 4.0))
    return (*rollers, *wall(y0, y1, side, x + side * 4.0))


def earth(x: float = 0.0, y: float = 0.0) -> Strokes:
    """Return the sign of an electrical reference, hanging from a point."""
    bars = tuple(line((x - w, y - 3 - 2 * i), (x + w, y - 3 - 2 * i)) for i, w in enumerate((4.5, 2.8, 1.2)))
    return (line((x, y), (x, y - 3)), *bars)


_STROKE: Final = {"line": LINE, "thin": THIN, "bold": BOLD, "member": MEMBER}
"""Widths of lines by what they are called in a symbol that is written down; others are numbers."""
_POINT: Final = re.compile(r"([\d.]+)([+-][\d.]+)?,(-?[\d.]+)")


def drawn(strokes: str) -> Callable[[float], Strokes]:
    """Return what draws a symbol that is written down, stroke by stroke.

    The x of a point is a share of the symbol's length, with points after it, its y is in points: ``.5-4,3``
    is 4 points before the middle and 3 above the axis.

    Examples
    --------
    >>> [stroke.points for stroke in drawn("line 0,0 .5-4,0; thin .5-4,3 .5-4,-3")(24.0)]
    [((0.0, 0.0), (8.0, 0.0)), ((8.0, 3.0), (8.0, -3.0))]
    """
    written = [stroke.split() for stroke in strokes.split(";")]
    return lambda length: tuple(s for kind, *rest in written for s in _stroke(kind, rest, length))


def _stroke(kind: str, written: Sequence[str], length: float) -> Strokes:
    found = (m.groups() for m in map(_POINT.fullmatch, written) if m)
    points = [(float(share) * length + float(more or 0), float(y)) for share, more, y in found]
    match kind:
        case "box" | "body" | "shape":
            fill = FILLED if kind == "body" else PAPER
            if len(points) > 2:  # noqa: PLR2004
                return (outline(*points, fill=fill),)
            return (rectangle(*points[0], *points[1], fill=fill),)
        case "disc":
            return (circle(*points[0], float(written[-1])),)
        case "dot":
            return (circle(*points[0], float(written[-1]), fill="#000000", width=0.3),)
        case "arrow" | "push" | "span":
            return arrow(points[0], points[1], BOLD if kind == "push" else LINE, is_double=kind == "span")
    return (line(*points, width=_STROKE.get(kind) or float(kind)),)


# A zigzag.
spring = drawn(
    "line 0,0 .16,0 .2025,3.6 .2875,-3.6 .3725,3.6 .4575,-3.6 .5425,3.6 .6275,-3.6 .7125,3.6 .7975,-3.6 "
    ".84,0 1,0"
)
# A dashpot: a cup, a piston in it.
damper = drawn("line 0,0 .32,0; line .72,3.6 .32,3.6 .32,-3.6 .72,-3.6; line .52,0 1,0; 1.2 .52,2.5 .52,-2.5")
# A disc in a housing.
rotary_damper = drawn("bold 0,0 .3,0; line .7,4.6 .3,4.6 .3,-4.6 .7,-4.6; bold .55,0 1,0; 2.0 .55,3 .55,-3")
resistor = drawn("line 0,0 .18,0; box .18,-2.8 .82,2.8; line .82,0 1,0")
# Two plates.
capacitor = drawn(
    "line 0,0 .5-1.5,0; 1.2 .5-1.5,-4.5 .5-1.5,4.5; 1.2 .5+1.5,-4.5 .5+1.5,4.5; line .5+1.5,0 1,0"
)
# Plus at the first end.
voltage_source = drawn("line 0,0 1,0; disc .5,0 5.5; thin .5-10,4 .5-7,4; thin .5-8.5,2.5 .5-8.5,5.5")
# An arrow to the first end.
current_source = drawn("line 0,0 1,0; disc .5,0 5.5; arrow .5+4,0 .5-4,0")
# Two arrows, to the right into the second end and to the left into the first.
effort_between = drawn("push .42,0 0,0; push .58,0 1,0")
# A distance that is given.
motion_between = drawn("span 0,0 1,0")
rigid_link = drawn("member 0,0 1,0")
# A thin blade.
massless_beam = drawn("box 0,-1 1,1")
# A thin line between two eyes.
string = drawn(".6 0,0 1,0; disc 0+1.2,0 1.2; disc 1-1.2,0 1.2")
# For what is left out.
dots = drawn("line 0,0 .5-8,0; line .5+8,0 1,0; dot .5-4,0 .9; dot .5,0 .9; dot .5+4,0 .9")
# A hinge.
pin_joint = drawn("line 0,0 1,0; disc .5,0 2.2")
fixed_joint = drawn("member 0,0 1,0; member .5,-4 .5,4")
# A sleeve that keeps the angle.
slider_joint = drawn("line 0,0 .5-1.5,0; 1.2 .5-1.5,-5 .5-1.5,5; 1.2 .5+1.5,-5 .5+1.5,5; line .5+1.5,0 1,0")
# A machine with its brushes; the layout writes the letter.
dc_motor = drawn("box .5-2.5,7.4 .5+2.5,9.8; box .5-2.5,-9.8 .5+2.5,-7.4; disc .5,0 8")
# A winding in the gap of a magnet.
voice_coil = drawn(
    "body .2,-7.5 .8-3,-7.5 .8-3,-5.2 .2+2.4,-5.2 .2+2.4,5.2 .8-3,5.2 .8-3,7.5 .2,7.5; "
    "thin .2+4,-4.2 .2+4,4.2; thin .2+6.6,-4.2 .2+6.6,4.2; thin .2+9.2,-4.2 .2+9.2,4.2; "
    "thin .2+11.8,-4.2 .2+11.8,4.2; box .2+4,-1.2 .8,1.2; line .8,0 1,0"
)
# A triangle that points at its output; the layout knows the signs of its inputs.
op_amp = drawn("shape .2,-9 .85,0 .2,9; line .85,0 1,0")
# A box with the diamond of a source that something controls.
controlled_source = drawn("box .2,-8 .8,8; shape .5-6,0 .5,6 .5+6,0 .5,-6")
# A piston in a cylinder.
piston = drawn(
    "line 0,0 .45,0; line .15,6 .9,6; line .15,-6 .9,-6; line .9,-6 .9,6; body .45,-5.4 .45+3,5.4; "
    "line .9,0 1,0"
)
# Two wheels that mesh, seen from the side.
gears = drawn(
    "bold 0,0 .5-4,0; bold .5+4,0 1,0; disc .5-5,0 5; disc .5+4,0 4; disc .5-5,0 .8; disc .5+4,0 .8"
)
# Two pulleys with a belt, seen from the side.
belt = drawn(
    "bold 0,0 .26,0; bold .74,0 1,0; line .26,5 .74,4; line .26,-5 .74,-4; disc .26,0 5; disc .74,0 4; "
    "disc .26,0 .8; disc .74,0 .8"
)
# A lever about a pivot.
lever = drawn(
    "line 0,0 .5-5,0; 1.4 .5-5,-6 .5+5,6; line .5+5,0 1,0; line .5-5,0 .5-5,-6; line .5+5,0 .5+5,6; "
    "disc .5,0 1.3"
)
# A box in which two arrows cross.
crossing = drawn(
    "line 0,0 .18,0; line .82,0 1,0; box .18,-6.5 .82,6.5; thin .18+2.5,-3.5 .82-2.5,3.5; "
    "thin .18+2.5,3.5 .82-2.5,-3.5"
)
# A stack of plates.
piezo = drawn(
    "body .2,-6.5 .8,6.5; thin .32,-6.5 .32,6.5; thin .44,-6.5 .44,6.5; thin .56,-6.5 .56,6.5; "
    "thin .68,-6.5 .68,6.5"
)
# For what has no symbol of its own.
box = drawn("line 0,0 .15,0; box .15,-5 .85,5; line .85,0 1,0")


def torsion_spring(length: float) -> Strokes:
    """Return a coil on a shaft."""
    lead, turns, size = 0.2 * length, 4, 4.0
    pitch = (length - 2 * lead) / turns
    points = []
    for i in range(16 * turns + 1):
        angle = 2 * pi * i / 16
        points.append((lead + pitch * i / 16 + 1.6 * sin(angle) * 0.9, size * sin(angle)))
    return (
        line((0, 0), (lead, 0), width=BOLD),
        line(*points),
        line((length - lead, 0), (length, 0), width=BOLD),
    )


def inductor(length: float) -> Strokes:
    """Return four half turns."""
    a = 0.18 * length
    r = (length - 2 * a) / 8
    bumps = [arc(a + (2 * i + 1) * r, 0, r, 180, 0).points for i in range(4)]
    return (
        line((0, 0), *(p for bump in bumps for p in bump), (length, 0)),
        line((a, -1.2), (a, 0), width=THIN),
    )


def torque_between(length: float) -> Strokes:
    """Return a motor without a circuit: two arrows that turn the ends against each other."""
    m = length / 2
    return (
        line((0, 0), (m - 5, 0), width=BOLD),
        line((m + 5, 0), (length, 0), width=BOLD),
        circle(m, 0, 5.0),
        arc(m, 0, 2.8, -30, 200, THIN),
        head((m - 2.8, -0.6), (0.2, -0.97), 2.8),
    )


HALF: Final = 2.2
"""Half the width of a slender member [points]."""
DEEPEST: Final = 4.2
"""The same of one that tapers, where it is deepest."""


def half_depth(depths: Sequence[float], share: float) -> float:
    """Return half the width of a member at a share of its length.

    Examples
    --------
    >>> half_depth((), 0.3), half_depth((1.0, 0.5), 0.0)
    (2.2, 4.2)
    """
    if not depths:
        return HALF
    return DEEPEST * depths[round(share * (len(depths) - 1))]


def slender(start: float, end: float, depths: Sequence[float] = ()) -> Stroke:
    """Return the outline of a member along x, with its depths at even stations where they differ."""
    count = max(1, len(depths) - 1)
    upper = [(start + (end - start) * i / count, half_depth(depths, i / count)) for i in range(count + 1)]
    return outline(*upper, *((x, -y) for x, y in reversed(upper)), fill=FILLED)


def tapered(draw: Callable[[float], Strokes], depths: Sequence[float], length: float) -> Strokes:
    """Return a member whose section varies: the first stroke of a uniform one is its outline."""
    return (slender(0, length, depths), *draw(length)[1:])


def beam(length: float) -> Strokes:
    """Return a slender member."""
    return (slender(0, length),)


def rod(length: float) -> Strokes:
    """Return a slender member with its axis."""
    return (slender(0, length), Stroke(((0, 0), (length, 0)), THIN, PLAIN, True))


def shaft(length: float) -> Strokes:
    """Return a slender member between collars."""
    ends = (line((0, -3.4), (0, 3.4)), line((length, -3.4), (length, 3.4)))
    return (*rod(length), *ends)


def planetary(length: float) -> Strokes:
    """Return a ring with its sun and three planets, seen from the front."""
    m, between = length / 2, 6.2
    planets = [
        circle(m + between * cos(turn), between * sin(turn), 2.6)
        for turn in (pi / 2, pi / 2 + 2 * pi / 3, pi / 2 - 2 * pi / 3)
    ]
    return (circle(m, 0, 10.0), *planets, circle(m, 0, 3.2), line((0, 0), (m - 10, 0), width=BOLD))


def windings(length: float) -> Strokes:
    """Return two windings on a core, each with both of its ends."""
    m, half = length / 2, 4.5
    sides = []
    for side in (-1, 1):
        turns = [
            p
            for i in range(3)
            for p in arc(m + 3 * side, half * (2 - 2 * i) / 3, half / 3, 90, 90 + 180 * side).points
        ]
        a = m + side * 0.3 * length
        sides.append(line((a, half), *turns, (a, -half)))
    cores = [line((m + x, -half - 1), (m + x, half + 1), width=THIN) for x in (-0.7, 0.7)]
    return (*sides, *cores)


def rack(length: float) -> Strokes:
    """Return a pinion on a rack."""
    m, low = length / 2, -4.5
    teeth = [(m - 9 + 1.5 * i, low + 1.6 * (i % 2)) for i in range(12)]
    return (
        line((0, 0), (m - 4, 0), width=BOLD),
        circle(m, 0.6, 3.6),
        circle(m, 0.6, 0.8),
        line(*teeth, (m + 9, low)),
        rectangle(m - 9, low - 2.4, m + 9, low, FILLED),
        line((m + 9, low - 1.2), (length, low - 1.2), (length, 0)),
    )


def screw(length: float) -> Strokes:
    """Return a screw with its nut: teeth on a shaft, and what they move."""
    a, b = 0.2 * length, 0.8 * length
    threads = [line((a + i * 3.0, -2.4), (a + i * 3.0 + 2, 2.4), width=THIN) for i in range(int((b - a) / 3))]
    nut = (
        rectangle(length / 2 - 4, 2.4, length / 2 + 4, 5.8, FILLED),
        rectangle(length / 2 - 4, -5.8, length / 2 + 4, -2.4, FILLED),
    )
    return (
        line((0, 0), (a, 0), width=BOLD),
        rectangle(a, -2.4, b, 2.4),
        *threads,
        *nut,
        line((length / 2 + 4, 4.1), (length, 4.1), (length, 0)),
    )


def coils(length: float) -> Strokes:
    """Return two windings on a core."""
    m = length / 2
    left = [p for i in range(3) for p in arc(m - 3, 5.4 - 3.6 * i, 1.8, 90, -90).points]
    right = [p for i in range(3) for p in arc(m + 3, 5.4 - 3.6 * i, 1.8, 90, 270).points]
    return (
        line((0, 0), (0.15 * length, 0), (0.15 * length, 7.2), (m - 3, 7.2), *left),
        line((length, 0), (0.85 * length, 0), (0.85 * length, 7.2), (m + 3, 7.2), *right),
        line((m - 0.7, -5), (m - 0.7, 8), width=THIN),
        line((m + 0.7, -5), (m + 0.7, 8), width=THIN),
    )


def pin_support() -> Strokes:
    """Return a hinge on the ground, below a point."""
    return (outline((0, -1.5), (-4.2, -8), (4.2, -8)), circle(0, -1.5, 1.5), *floor(-6.4, 6.4, -8))


def fixed_support() -> Strokes:
    """Return the ground, below a point."""
    return (line((0, 0), (0, -3)), *floor(-5.4, 5.4, -3))


def slider_support() -> Strokes:
    """Return a shoe between guides that run up and down, below a point."""
    return (
        line((0, 0), (0, -3)),
        rectangle(-2.6, -11, 2.6, -3),
        *wall(-13, -1, -1, -2.6 - 1.2),
        *wall(-13, -1, 1, 2.6 + 1.2),
    )


@dataclass(frozen=True, slots=True)
class ElementSymbol:
    """How a type of element is drawn."""

    role: Role
    draw: Callable[[float], Strokes] = box  # of a branch, by its length
    length: float = 24.0  # the least of it [points]
    hold: Callable[[], Strokes] = fixed_support  # of a support, about its node


SYMBOLS: Final[dict[str, ElementSymbol]] = {
    **dict.fromkeys(("mass", "inertia", "rigid_body"), ElementSymbol("body")),
    "spring": ElementSymbol("branch", spring, 26.0),
    "damper": ElementSymbol("branch", damper, 24.0),
    "torsion_spring": ElementSymbol("branch", torsion_spring, 28.0),
    "rotary_damper": ElementSymbol("branch", rotary_damper, 24.0),
    **dict.fromkeys(("resistor", "acoustic_resistance"), ElementSymbol("branch", resistor, 24.0)),
    **dict.fromkeys(("inductor", "acoustic_mass"), ElementSymbol("branch", inductor, 26.0)),
    **dict.fromkeys(("capacitor", "acoustic_compliance"), ElementSymbol("branch", capacitor, 20.0)),
    **dict.fromkeys(("force_source", "torque_source"), ElementSymbol("source")),
    **dict.fromkeys(("voltage_source", "pressure_source"), ElementSymbol("source", voltage_source)),
    **dict.fromkeys(("current_source", "flow_source"), ElementSymbol("source", current_source)),
    "rigid_link": ElementSymbol("member", rigid_link, 34.0),
    "massless_beam": ElementSymbol("member", massless_beam, 60.0),
    **dict.fromkeys(("beam", "frame"), ElementSymbol("member", beam, 70.0)),
    "rod": ElementSymbol("member", rod, 60.0),
    "shaft": ElementSymbol("member", shaft, 60.0),
    "string": ElementSymbol("member", string, 60.0),
    "fixed": ElementSymbol("support", fixed_joint, 14.0, fixed_support),
    "slider": ElementSymbol("support", slider_joint, 18.0, slider_support),
    "pin": ElementSymbol("support", pin_joint, 16.0, pin_support),
    "dc_motor": ElementSymbol("coupling", dc_motor, 30.0),
    "piezo": ElementSymbol("coupling", piezo, 36.0),
    "transformer": ElementSymbol("coupling", gears, 34.0),
    "gyrator": ElementSymbol("coupling", crossing, 32.0),
    "voice_coil": ElementSymbol("coupling", voice_coil, 34.0),
    "planetary_gear": ElementSymbol("coupling", planetary, 34.0),
    "coupled_inductors": ElementSymbol("coupling", windings, 34.0),
    "op_amp": ElementSymbol("coupling", op_amp, 34.0),
    **dict.fromkeys(("vcvs", "vccs", "ccvs", "cccs"), ElementSymbol("coupling", controlled_source, 34.0)),
    "piston": ElementSymbol("coupling", piston, 34.0),
}
"""By the type of an element; a new element is a line."""

TRANSFORMERS: Final[dict[tuple[str, str], Callable[[float], Strokes]]] = {
    ("rotation", "rotation"): gears,
    ("rotation", "translation"): screw,
    ("translation", "rotation"): screw,
    ("translation", "translation"): lever,
    ("electrical", "electrical"): coils,
}
"""A transformer by the domains of its two sides; of other domains it is a box."""
TRANSFORMER_SYMBOLS: Final[dict[str, Callable[[float], Strokes]]] = {
    "gears": gears,
    "belt": belt,
    "screw": screw,
    "rack": rack,
    "lever": lever,
    "coils": coils,
    "box": box,
}
"""What a specification may call the symbol of a transformer."""


def symbol_of(type_name: str) -> ElementSymbol:
    """Return the symbol of a type of element, a plain box for one that has none."""
    return SYMBOLS.get(type_name, ElementSymbol("coupling"))
