r"""The symbols of elements, written down or a function each, in :data:`SYMBOLS` by the element's type.

A symbol is drawn from its first end at the origin to its second at ``(length, 0)``; what stands at one node
or holds one is drawn about that node's point. What a type has no entry for is drawn as a box with its name.

    spring    0,0 --/\/\/\-- length,0
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import cos, pi, sin
from typing import Final, Literal

from symflex.drawing.geometry import BLACK, BOLD, FILLED, LINE, MEMBER, PAPER, THIN, Point, Stroke

Strokes = tuple[Stroke, ...]
Role = Literal["branch", "body", "support", "source", "coupling", "member"]


def line(*points: Point, width: float = LINE) -> Stroke:
    """Return a line through points."""
    return Stroke(points, width)


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


DOT: Final = 1.4  # radius of the dot of a joint


def head(tip: Point, direction: Point, size: float = 4.2) -> Stroke:
    """Return the head of an arrow with its tip at a point, so long [points]."""
    (x, y), (dx, dy) = tip, direction
    back, side = (x - size * dx, y - size * dy), 0.34 * size
    wings = ((back[0] - side * dy, back[1] + side * dx), (back[0] + side * dy, back[1] - side * dx))
    return outline(tip, *wings, fill=BLACK, width=0.3)


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
    tip = (x + r * cos(pi * 1.12), y + r * sin(pi * 1.12))
    return (arc(x, y, r, -40, 190, BOLD * 0.7), head(tip, (0.25, -0.97)))


HATCH: Final = 3.2  # depth of the hatching behind a surface that does not move


def wall(y0: float, y1: float, side: int = -1, x: float = 0.0) -> Strokes:
    """Return a surface along y with hatching behind it, to the left where ``side`` is -1."""
    count = max(2, round((y1 - y0) / HATCH))
    step = (y1 - y0) / count
    low = [y0 + i * step for i in range(count)]
    lines = (line((x, y + step), (x + side * HATCH, y), width=THIN) for y in low)
    return (line((x, y0), (x, y1), width=1.0), *lines)


def floor(x0: float, x1: float, y: float = 0.0) -> Strokes:
    """Return a surface along x with hatching below it."""
    return tuple(line(*((b, a) for a, b in s.points), width=s.width) for s in wall(x0, x1, -1, y))


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

    >>> [stroke.points for stroke in drawn("line 0,0 .5-4,0; thin .5-4,3 .5-4,-3")(24.0)]
    [((0.0, 0.0), (8.0, 0.0)), ((8.0, 3.0), (8.0, -3.0))]
    """
    written = [stroke.split() for stroke in strokes.split(";")]
    return lambda length: tuple(s for kind, *arguments in written for s in _stroke(kind, arguments, length))


def _stroke(kind: str, written: Sequence[str], length: float) -> Strokes:
    groups = (m.groups() for m in map(_POINT.fullmatch, written) if m)
    points = [(float(share) * length + float(more or 0), float(y)) for share, more, y in groups]
    numbers = [float(one) for one in written[len(points) :]]
    match kind:
        case "box" | "body":
            return (rectangle(*points[0], *points[1], FILLED if kind == "body" else PAPER),)
        case "shape" | "solid":
            return (outline(*points, fill=FILLED if kind == "solid" else PAPER),)
        case "disc":
            return (circle(*points[0], numbers[0]),)
        case "dot":
            return (circle(*points[0], numbers[0], fill=BLACK, width=0.3),)
        case "turn":
            return (arc(*points[0], numbers[0], numbers[1], numbers[2], THIN),)
        case "head":
            return (head(points[0], (numbers[0], numbers[1]), numbers[2]),)
        case "arrow" | "push" | "span":
            return arrow(points[0], points[1], BOLD if kind == "push" else LINE, is_double=kind == "span")
    return (line(*points, width=_STROKE.get(kind) or float(kind)),)


def torsion_spring(length: float) -> Strokes:
    """Return a coil on a shaft."""
    lead, turns = 0.2 * length, 4
    pitch = (length - 2 * lead) / turns
    angles = [2 * pi * i / 16 for i in range(16 * turns + 1)]
    coil = [(lead + pitch * a / (2 * pi) + 1.44 * sin(a), 4.0 * sin(a)) for a in angles]
    ends = (line((0, 0), (lead, 0), width=BOLD), line((length - lead, 0), (length, 0), width=BOLD))
    return (ends[0], line(*coil), ends[1])


def inductor(length: float) -> Strokes:
    """Return four half turns."""
    a = 0.18 * length
    r = (length - 2 * a) / 8
    bumps = [p for i in range(4) for p in arc(a + (2 * i + 1) * r, 0, r, 180, 0).points]
    return (line((0, 0), *bumps, (length, 0)), line((a, -1.2), (a, 0), width=THIN))


HALF: Final = 2.2  # half the width of a slender member [points]
DEEPEST: Final = 4.2  # the same of one that tapers, where it is deepest


def half_depth(depths: Sequence[float], share: float) -> float:
    """Return half the width of a member at a share of its length."""
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
    return (slender(0, length), Stroke(((0, 0), (length, 0)), THIN, is_dashed=True))


def shaft(length: float) -> Strokes:
    """Return a slender member between collars."""
    return (*rod(length), *(line((x, -3.4), (x, 3.4)) for x in (0, length)))


def windings(length: float) -> Strokes:
    """Return two windings on a core, each with both of its ends."""
    m, half = length / 2, 4.5
    sides = []
    for side in (-1, 1):
        levels = (half * (2 - 2 * i) / 3 for i in range(3))
        turns = [p for y in levels for p in arc(m + 3 * side, y, half / 3, 90, 90 + 180 * side).points]
        a = m + side * 0.3 * length
        sides.append(line((a, half), *turns, (a, -half)))
    return (*sides, *(line((m + x, -half - 1), (m + x, half + 1), width=THIN) for x in (-0.7, 0.7)))


def screw(length: float) -> Strokes:
    """Return a screw with its nut: teeth on a shaft, and what they move."""
    count = int(0.6 * length / 3)
    threads = "; ".join(f"thin .2+{3 * i},-2.4 .2+{3 * i + 2},2.4" for i in range(count))
    nut = "body .5-4,2.4 .5+4,5.8; body .5-4,-5.8 .5+4,-2.4; line .5+4,4.1 1,4.1 1,0"
    return drawn(f"bold 0,0 .2,0; box .2,-2.4 .8,2.4; {threads}; {nut}")(length)


def coils(length: float) -> Strokes:
    """Return two windings on a core."""
    m = length / 2
    sides = []
    for side, last in ((-1, -90), (1, 270)):
        turns = [p for i in range(3) for p in arc(m + 3 * side, 5.4 - 3.6 * i, 1.8, 90, last).points]
        end, foot = (0.5 + 0.5 * side) * length, (0.5 + 0.35 * side) * length
        sides.append(line((end, 0), (foot, 0), (foot, 7.2), (m + 3 * side, 7.2), *turns))
    return (*sides, *(line((m + x, -5), (m + x, 8), width=THIN) for x in (-0.7, 0.7)))


def pin_support() -> Strokes:
    """Return a hinge on the ground, below a point."""
    return (outline((0, -1.5), (-4.2, -8), (4.2, -8)), circle(0, -1.5, 1.5), *floor(-6.4, 6.4, -8))


def fixed_support() -> Strokes:
    """Return the ground, below a point."""
    return (line((0, 0), (0, -3)), *floor(-5.4, 5.4, -3))


def slider_support() -> Strokes:
    """Return a shoe between guides that run up and down, below a point."""
    guides = (*wall(-13, -1, -1, -2.6 - 1.2), *wall(-13, -1, 1, 2.6 + 1.2))
    return (line((0, 0), (0, -3)), rectangle(-2.6, -11, 2.6, -3), *guides)


# For what has no symbol of its own.
box = drawn("line 0,0 .15,0; box .15,-5 .85,5; line .85,0 1,0")
# Two wheels that mesh, seen from the side.
gears = drawn(
    "bold 0,0 .5-4,0; bold .5+4,0 1,0; disc .5-5,0 5; disc .5+4,0 4; disc .5-5,0 .8; disc .5+4,0 .8"
)
# A lever about a pivot.
lever = drawn(
    "line 0,0 .5-5,0; 1.4 .5-5,-6 .5+5,6; line .5+5,0 1,0; line .5-5,0 .5-5,-6; line .5+5,0 .5+5,6; "
    "disc .5,0 1.3"
)


# A pinion on a rack.
rack = drawn(
    "bold 0,0 .5-4,0; disc .5,.6 3.6; disc .5,.6 .8; line .5-9,-4.5 .5-7.5,-2.9 .5-6,-4.5 .5-4.5,-2.9 "
    ".5-3,-4.5 .5-1.5,-2.9 .5,-4.5 .5+1.5,-2.9 .5+3,-4.5 .5+4.5,-2.9 .5+6,-4.5 .5+7.5,-2.9 .5+9,-4.5; "
    "body .5-9,-6.9 .5+9,-4.5; line .5+9,-5.7 1,-5.7 1,0"
)
TRANSFORMERS: Final[dict[tuple[str, str], Callable[[float], Strokes]]] = {
    ("rotation", "rotation"): gears,
    ("rotation", "translation"): rack,
    ("translation", "rotation"): rack,
    ("translation", "translation"): lever,
    ("electrical", "electrical"): coils,
}  # a transformer by the domains of its two sides; of other domains it is a box


def mirrored(strokes: Strokes, length: float) -> Strokes:
    """Return a symbol from its second end to its first."""
    return tuple(replace(s, points=tuple((length - x, y) for x, y in s.points)) for s in strokes)


@dataclass(frozen=True, slots=True)
class ElementSymbol:
    """How a type of element is drawn."""

    role: Role
    draw: Callable[[float], Strokes] = box  # of a branch, by its length
    length: float = 24.0  # the least of it [points]
    hold: Callable[[], Strokes] = fixed_support  # of a support, about its node


def branch(length: float, strokes: str) -> ElementSymbol:
    """Return the symbol of what joins two nodes, written down."""
    return ElementSymbol("branch", drawn(strokes), length)


def coupling(length: float, strokes: str) -> ElementSymbol:
    """Return the symbol of what joins two sides, written down."""
    return ElementSymbol("coupling", drawn(strokes), length)


# Plus at the first end.
_EFFORT: Final = drawn("line 0,0 1,0; disc .5,0 5.5; thin .5-10,4 .5-7,4; thin .5-8.5,2.5 .5-8.5,5.5")
# An arrow to the first end.
_FLOW: Final = drawn("line 0,0 1,0; disc .5,0 5.5; arrow .5+4,0 .5-4,0")
_RESISTOR: Final = branch(24.0, "line 0,0 .18,0; box .18,-2.8 .82,2.8; line .82,0 1,0")
# Two plates.
_CAPACITOR: Final = branch(
    20.0, "line 0,0 .5-1.5,0; 1.2 .5-1.5,-4.5 .5-1.5,4.5; 1.2 .5+1.5,-4.5 .5+1.5,4.5; line .5+1.5,0 1,0"
)
SYMBOLS: Final[dict[str, ElementSymbol]] = {  # symbols by the type of an element; a new element is a line
    **dict.fromkeys(("mass", "inertia", "rigid_body"), ElementSymbol("body")),
    # A zigzag.
    "spring": branch(
        26.0,
        "line 0,0 .16,0 .2025,3.6 .2875,-3.6 .3725,3.6 .4575,-3.6 .5425,3.6 .6275,-3.6 .7125,3.6 .7975,-3.6 "
        ".84,0 1,0",
    ),
    # A dashpot: a cup, a piston in it.
    "damper": branch(
        24.0, "line 0,0 .32,0; line .72,3.6 .32,3.6 .32,-3.6 .72,-3.6; line .52,0 1,0; 1.2 .52,2.5 .52,-2.5"
    ),
    "torsion_spring": ElementSymbol("branch", torsion_spring, 28.0),
    # Two discs with oil between them.
    "rotary_damper": branch(
        24.0,
        "bold 0,0 .5-3,0; 1.6 .5-3,-5.5 .5-3,5.5; 1.6 .5+3,-5.5 .5+3,5.5; bold .5+3,0 1,0; "
        "thin .5-1.6,-4 .5+1.6,-4; thin .5-1.6,-2 .5+1.6,-2; thin .5-1.6,0 .5+1.6,0; "
        "thin .5-1.6,2 .5+1.6,2; thin .5-1.6,4 .5+1.6,4",
    ),
    **dict.fromkeys(("resistor", "acoustic_resistance", "thermal_resistance"), _RESISTOR),
    **dict.fromkeys(("inductor", "acoustic_mass"), ElementSymbol("branch", inductor, 26.0)),
    **dict.fromkeys(("capacitor", "acoustic_compliance", "thermal_capacity"), _CAPACITOR),
    **dict.fromkeys(("force_source", "torque_source"), ElementSymbol("source")),
    **dict.fromkeys(
        ("voltage_source", "pressure_source", "temperature_source"), ElementSymbol("source", _EFFORT)
    ),
    **dict.fromkeys(("current_source", "flow_source", "heat_source"), ElementSymbol("source", _FLOW)),
    "rigid_link": ElementSymbol("member", drawn("member 0,0 1,0"), 34.0),
    # A thin blade.
    "massless_beam": ElementSymbol("member", drawn("box 0,-1 1,1"), 60.0),
    **dict.fromkeys(("beam", "frame"), ElementSymbol("member", beam, 70.0)),
    "rod": ElementSymbol("member", rod, 60.0),
    "shaft": ElementSymbol("member", shaft, 60.0),
    # A thin line between two eyes.
    "string": ElementSymbol("member", drawn(".6 0,0 1,0; disc 0+1.2,0 1.2; disc 1-1.2,0 1.2"), 60.0),
    "fixed": ElementSymbol("support", drawn("member 0,0 1,0; member .5,-4 .5,4"), 14.0, fixed_support),
    # A sleeve that keeps the angle.
    "slider": ElementSymbol(
        "support",
        drawn("line 0,0 .5-1.5,0; 1.2 .5-1.5,-5 .5-1.5,5; 1.2 .5+1.5,-5 .5+1.5,5; line .5+1.5,0 1,0"),
        18.0,
        slider_support,
    ),
    "pin": ElementSymbol("support", drawn("line 0,0 1,0; disc .5,0 2.2"), 16.0, pin_support),
    # A machine with its brushes; the layout writes the letter.
    "dc_motor": coupling(30.0, "box .5-2.5,7.4 .5+2.5,9.8; box .5-2.5,-9.8 .5+2.5,-7.4; disc .5,0 8"),
    # A stack of plates.
    "piezo": coupling(
        36.0,
        "body .2,-6.5 .8,6.5; thin .32,-6.5 .32,6.5; thin .44,-6.5 .44,6.5; thin .56,-6.5 .56,6.5; "
        "thin .68,-6.5 .68,6.5",
    ),
    "transformer": ElementSymbol("coupling", gears, 34.0),
    # A box in which two arrows cross.
    "gyrator": coupling(
        32.0,
        "line 0,0 .18,0; line .82,0 1,0; box .18,-6.5 .82,6.5; thin .18+2.5,-3.5 .82-2.5,3.5; "
        "thin .18+2.5,3.5 .82-2.5,-3.5",
    ),
    # A winding in the gap of a magnet.
    "voice_coil": coupling(
        34.0,
        "solid .2,-7.5 .8-3,-7.5 .8-3,-5.2 .2+2.4,-5.2 .2+2.4,5.2 .8-3,5.2 .8-3,7.5 .2,7.5; "
        "thin .2+4,-4.2 .2+4,4.2; thin .2+6.6,-4.2 .2+6.6,4.2; thin .2+9.2,-4.2 .2+9.2,4.2; "
        "thin .2+11.8,-4.2 .2+11.8,4.2; box .2+4,-1.2 .8,1.2; line .8,0 1,0",
    ),
    # A ring with its sun and three planets, seen from the front.
    "planetary_gear": coupling(
        34.0,
        "disc .5,0 10; disc .5,6.2 2.6; disc .5-5.3693575,-3.1 2.6; disc .5+5.3693575,-3.1 2.6; "
        "disc .5,0 3.2; bold 0,0 .5-10,0",
    ),
    "coupled_inductors": ElementSymbol("coupling", windings, 34.0),
    # A triangle that points at its output; the layout knows the signs of its inputs.
    "op_amp": coupling(34.0, "shape .2,-9 .85,0 .2,9; line .85,0 1,0"),
    # A box with the diamond of a source that something controls.
    **dict.fromkeys(
        ("vcvs", "vccs", "ccvs", "cccs"), coupling(34.0, "box .2,-8 .8,8; shape .5-6,0 .5,6 .5+6,0 .5,-6")
    ),
    # A piston in a cylinder.
    "piston": coupling(
        34.0,
        "line 0,0 .45,0; line .15,6 .9,6; line .15,-6 .9,-6; line .9,-6 .9,6; body .45,-5.4 .45+3,5.4; "
        "line .9,0 1,0",
    ),
}

# Inputs and sources between two nodes are drawn as a distance that is given; as two arrows, out of the gap
# where the first end is on the right; and as a motor without a circuit, which turns its ends apart.
MOTION_BETWEEN: Final = branch(26.0, "span 0,0 1,0")
FORCE_BETWEEN: Final = branch(30.0, "push .42,0 0,0; push .58,0 1,0")
FORCE_TOGETHER: Final = drawn("push 0,0 .42,0; push 1,0 .58,0")
"""What acts on the first end where that is on the left, and the reaction; positive forces point right."""
TORQUE_BETWEEN: Final = branch(
    30.0, "bold 0,0 .5-5,0; bold .5+5,0 1,0; disc .5,0 5; turn .5,0 2.8 -30 200; head .5-2.8,-.6 .2 -.97 2.8"
)
DOTS: Final = branch(26.0, "line 0,0 .5-8,0; line .5+8,0 1,0; dot .5-4,0 .9; dot .5,0 .9; dot .5+4,0 .9")
"""Three dots for what is left out."""
TRANSFORMER_SYMBOLS: Final[dict[str, Callable[[float], Strokes]]] = {
    "gears": gears,
    # Two pulleys with a belt, seen from the side.
    "belt": drawn(
        "bold 0,0 .26,0; bold .74,0 1,0; line .26,5 .74,4; line .26,-5 .74,-4; disc .26,0 5; disc .74,0 4; "
        "disc .26,0 .8; disc .74,0 .8"
    ),
    "screw": screw,
    "rack": rack,
    "lever": lever,
    "coils": coils,
    "box": box,
}  # what a specification may call the symbol of a transformer
