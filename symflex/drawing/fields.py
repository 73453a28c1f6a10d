"""Fields as members along x, with what their conditions say of the ends, and the conditions themselves below.

Input: a model and the outputs that are still to be shown. Output: one :class:`FieldRow` for fields that
follow each other along x.

    w'(0) = 0, EI w'''(0) = F, w''(l) = 0, w'''(l) = 0      a guide and an arrow F at the left, a free end at
    the right
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from symflex.drawing.cells import coordinate
from symflex.drawing.columns import upright_mark, upright_width
from symflex.drawing.geometry import THIN, Extent, Placed, Stroke, union
from symflex.drawing.lettering import SMALL, Labels, downwards, text
from symflex.drawing.scheme import UNKNOWN, Depths, Mark, Style, evaluate, sections, values_of, without_s
from symflex.drawing.symbols import (
    HALF,
    Strokes,
    arrow,
    floor,
    guide,
    half_depth,
    line,
    outline,
    rectangle,
    slender,
    wall,
)
from symflex.expressions import (
    Attribute,
    Call,
    Derivative,
    Equation,
    Expression,
    Name,
    Number,
    names,
    negative,
    number,
    replace_values,
    sum_of,
)
from symflex.library.fields import BEAM_ORDER
from symflex.model import FieldProblem, Model
from symflex.model.along import COORDINATE, is_tapered
from symflex.quantities import unit_of

LENGTH: Final = 150.0  # length of a row of fields [points]
SHORTEST: Final = 0.22  # share of the row that each takes at least
LEADING: Final = 3.0
APART: Final = 14.0  # least distance of two columns of conditions [points]
OF_BEAMS: Final[dict[int, Style]] = {1: "twist", 2: "torque"}
"""What is driven at an end of a beam, by the order in x of what it rules there: a slope, a moment."""
STRING: Final = (0.0,)  # depths of a string, a line without any
STIFF_SECTIONS: Final = {unit_of(unit).dimension for unit in ("Pa", "N*m^2")}
"""Dimensions of a modulus, and of what resists bending or torsion."""


@dataclass(frozen=True, slots=True)
class FieldRow:
    """Fields laid out, with the inputs and outputs that are marked on them."""

    items: tuple[Placed, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


def field_rows(model: Model, labels: Labels, outputs: Sequence[str]) -> list[FieldRow]:
    """Return the fields of a model in rows."""
    rows: list[FieldRow] = []
    remaining = list(outputs)
    inputs = [i.name for i in model.inputs if i.kind == "signal"]
    groups: list[list[FieldProblem]] = []  # of which each begins where the one before it ends
    for one in model.fields:
        before = next((g for g in groups if g[-1].end == one.start), [])
        if not before:
            groups.append(before)
        before.append(one)
    for group in groups:
        row = _Row(model, labels, group, remaining, inputs).laid_out()
        remaining = [o for o in remaining if o not in row.outputs]
        inputs = [i for i in inputs if i not in row.inputs]
        rows.append(row)
    return rows


@dataclass
class _Row:
    model: Model
    labels: Labels
    fields: Sequence[FieldProblem]
    wanted: Sequence[str]
    free: Sequence[str]
    items: list[Placed] = field(default_factory=list)
    marks: dict[tuple[Style, float], list[tuple[str, str, str]]] = field(default_factory=dict)

    def laid_out(self) -> FieldRow:
        """Return the row, its axis at y = 0."""
        self.known = values_of(self.model)
        self.starts = self._starts()
        self.unknowns = {u: f for f in self.fields for u in f.unknowns}
        self.depths = {f.name: STRING if self._is_string(f) else self._depths(f) for f in self.fields}
        inputs = self._collect_inputs()
        outputs = self._collect_outputs()
        for one in self.fields:
            self._draw_member(one)
        above = self._draw_marks()
        for one in self.fields:
            self._draw_loads(one, above)
        self._draw_coordinate()
        self._draw_conditions()
        return FieldRow(tuple(self.items), tuple(inputs), tuple(outputs))

    def _starts(self) -> dict[str, tuple[float, float]]:
        """Return where each field begins and ends in the row."""
        spans = [(evaluate(f.start, self.known), evaluate(f.end, self.known)) for f in self.fields]
        sizes = [abs(b - a) if a is not None and b is not None else 0.0 for a, b in spans]
        total = sum(sizes)
        shares = [max(SHORTEST, s / total) if all(sizes) else 1.0 for s in sizes]
        starts, x = {}, 0.0
        for one, share in zip(self.fields, shares, strict=True):
            wide = LENGTH * share / sum(shares)
            starts[one.name] = (x, x + wide)
            x += wide
        return starts

    def _x(self, one: FieldProblem, point: Expression) -> float:
        """Return where a point of a field is drawn."""
        low, high = self.starts[one.name]
        if point in (one.start, one.end):
            return low if point == one.start else high
        a, b, at = (evaluate(e, self.known) for e in (one.start, one.end, point))
        if a is None or b is None or at is None or a == b:
            return (low + high) / 2
        return low + (high - low) * min(1.0, max(0.0, (at - a) / (b - a)))

    def _depths(self, one: FieldProblem) -> Depths:
        """Return the depths of a member that tapers, by how stiff and how heavy its equations say it is."""
        if not is_tapered(self.model) or COORDINATE in one.unknowns:
            return ()
        a, b = (evaluate(e, self.known) for e in (one.start, one.end))
        ends = (0.0 if a is None else a, UNKNOWN if b is None else b)
        for equation in one.equations:
            if not (derivatives := _derivatives(equation)):
                continue  # an unknown that follows another
            highest = derivatives[0]
            stiff, others = _stiffness(equation, one.unknowns)
            moved = {**others, Name(highest.name): number(1)}
            inert, still = (_coefficient(equation, {**moved, Name("s"): number(n)}) for n in (1, 0))
            heavy = sum_of([inert, negative(still)])
            if shape := sections(stiff, heavy, ends, self.known, None if self._is_beam(one) else 2):
                return shape
        return ()

    def _half(self, x: float) -> float:
        """Return half the depth of what is drawn at x."""
        here = [(name, a, b) for name, (a, b) in self.starts.items() if a <= x <= b]
        return max(half_depth(self.depths[name], (x - a) / (b - a)) for name, a, b in here)

    def _values(self, equation: Equation) -> list[Call]:
        return [n for n in names(equation) if isinstance(n, Call) and n.name in self.unknowns]

    def _collect_inputs(self) -> list[str]:
        inputs: list[str] = []
        for one in self.fields:
            is_beam = self._is_beam(one)
            for condition in one.conditions:
                calls = self._values(condition)
                driving = [n.name for n in names(condition) if isinstance(n, Name)] if calls else []
                for name in (n for n in driving if n in self.free and n not in inputs):
                    at = max(calls, key=lambda c: c.order)
                    style: Style = "push" if at.order else "raise"
                    style = OF_BEAMS.get(at.order, style) if is_beam else style
                    x = self._x(self.unknowns[at.name], at.argument)
                    self.marks.setdefault((style, x), []).append(("input", name, self._label(name)))
                    inputs.append(name)
            inputs += [name for name in self._loads(one) if name not in inputs]
        return inputs

    def _label(self, name: str) -> str:
        latex = next((i.latex for i in self.model.inputs if i.name == name), "")
        return self.labels.end(name, latex)

    def _loads(self, one: FieldProblem) -> list[str]:
        """Return the inputs that act all along a field."""
        held = {n.name for e in one.equations for n in names(e) if isinstance(n, Name)}
        return [n for n in self.free if n in held]

    def _collect_outputs(self) -> list[str]:
        outputs = []
        for out in self.model.outputs:
            call = self._single(out.expression) if out.name in self.wanted else None
            if call:
                x = self._x(self.unknowns[call.name], call.argument)
                is_beam = self._is_beam(self.unknowns[call.name])
                style: Style = "turn" if call.order == 1 and is_beam else "probe"
                style = style if call.order else "lift"
                label = self.labels.end(out.name, out.latex)
                self.marks.setdefault((style, x), []).append(("output", out.name, label))
                outputs.append(out.name)
        return outputs

    @staticmethod
    def _is_beam(one: FieldProblem) -> bool:
        return any(n.order >= BEAM_ORDER for e in one.equations for n in _derivatives(e))

    def _is_string(self, one: FieldProblem) -> bool:
        """Whether a tension alone holds a field: neither a modulus nor what resists bending or torsion."""
        if self._is_beam(one) or len(one.unknowns) > 1 or not _derivatives(one.equations[0]):
            return False
        held = {n.name for n in names(_stiffness(one.equations[0], one.unknowns)[0]) if isinstance(n, Name)}
        dimensions = {unit_of(p.unit).dimension for p in self.model.parameters if p.name in held and p.unit}
        return bool(dimensions) and not dimensions & STIFF_SECTIONS

    def _single(self, expression: Expression) -> Call | None:
        """Return the one value of a field that an expression is, but for constants."""
        calls = [n for n in names(expression) if isinstance(n, Call) and n.name in self.unknowns]
        constants = {p.name for p in self.model.parameters} | {d.name for d in self.model.definitions}
        inside = {n for c in calls for n in names(c.argument)}
        others = [n for n in names(expression) if n not in calls and n not in inside]
        is_alone = all(isinstance(n, Name) and n.name in {*constants, "s", "pi"} for n in others)
        is_one = len(calls) == 1 and is_alone and not isinstance(without_s(expression), Attribute)
        return calls[0] if is_one else None

    # ------------------------------------------------------------------------------------------- drawing

    def _draw_member(self, one: FieldProblem) -> None:
        low, high = self.starts[one.name]
        depths = self.depths[one.name]
        drawn = line((low, 0), (high, 0)) if depths == STRING else slender(low, high, depths)
        self.items.append(Placed("field", one.name, (drawn,)))
        for x, point, side in ((low, one.start, -1), (high, one.end, 1)):
            support = tuple(_support(self._held(one, point), x, side, self._half(x)))
            if support:
                self.items.append(Placed("ground", one.name, support))

    def _held(self, one: FieldProblem, point: Expression) -> tuple[bool, bool]:
        """Tell whether the displacement and the slope (or a second unknown) are zero at an end."""
        zero = set()
        for condition in one.conditions:
            calls, (left, right) = self._values(condition), condition.children
            is_zero = isinstance(right, Number) and right.value == 0 and isinstance(left, Call)
            if is_zero and len(calls) == 1 and calls[0].argument == point and calls[0].name in one.unknowns:
                zero.add((one.unknowns.index(calls[0].name), calls[0].order))
        slope = (0, 1) if self._is_beam(one) else (len(one.unknowns) > 1, 0)
        return (0, 0) in zero, slope in zero

    def _draw_marks(self) -> float:
        """Draw arrows above the member, side by side or above each other; return how high they reach."""
        occupied = [i.box for i in self.items if i.kind == "ground" and i.box.y1 > HALF]
        places: dict[float, list[Mark]] = {}
        inputs = ("push", "torque", "raise", "twist")  # which stand before outputs
        found = sorted(self.marks.items(), key=lambda m: (-m[0][1], m[0][0] not in inputs))
        for (style, x), labels in found:
            places.setdefault(x, []).append(Mark(style, "", tuple(labels)))
        for x, marks in places.items():
            start = x - 5.0
            room = Extent(start, 0.0, start + sum(map(upright_width, marks)), 17.0)
            surface = self._half(x)
            y = surface + 0.5
            while any(b.overlaps(room.moved(0, y)) for b in occupied):
                y += 1.0
            occupied.append(room.moved(0, y))
            if y > surface + 1:
                name = marks[0].labels[0][1]
                self.items.append(Placed("wire", name, (line((x, surface), (x, y + 2), width=THIN),)))
            for mark in marks:
                self.items += upright_mark(mark, start, y)
                start += upright_width(mark)
        return max(b.y1 for b in (*occupied, *(i.box for i in self.items if i.kind == "field")))

    def _draw_loads(self, one: FieldProblem, above: float) -> None:
        low, high = self.starts[one.name]
        for name in self._loads(one):
            count = max(3, int((high - low) / 12))
            foot = above + 2 if above > HALF else HALF
            xs = [low + (high - low) * i / count for i in range(count + 1)]
            arrows: Strokes = (line((low, foot + 10), (high, foot + 10), width=THIN),)
            arrows += tuple(s for x in xs for s in arrow((x, foot), (x, foot + 10), THIN))
            self.items.append(Placed("input", name, arrows))
            if shown := text(self._label(name)):
                label = shown.moved((low + high - shown.width) / 2, foot + 13 + shown.depth)
                self.items.append(Placed("label", name, (), (label,)))
            above = foot + 24

    def _draw_coordinate(self) -> None:
        """Draw an arrow from where x is nought, below the member."""
        start = self._x(self.fields[0], self.fields[0].start)
        y = min(i.box.y0 for i in self.items if i.kind in ("field", "ground")) - 5
        self.items += [i.moved(start, y) for i in coordinate()]

    def _draw_conditions(self) -> None:
        """Write conditions below the points that they hold at, and the equations below all."""
        bottom = min(i.box.y0 for i in self.items) - 3
        columns: dict[float, list[str]] = {}
        for one in self.fields:
            sources = one.written[len(one.equations) :] or one.conditions
            for condition, given in zip(one.conditions, sources, strict=True):
                calls = self._values(condition)
                xs = [self._x(self.unknowns[c.name], c.argument) for c in calls]
                columns.setdefault(sum(xs) / len(xs) if xs else 0.0, []).append(self._sides(given))
        right, lowest = -1e9, bottom
        for i, (x, given_there) in enumerate(sorted(columns.items())):
            written = [t for one in given_there if (t := text(one, SMALL))]
            wide = max([0.0, *(t.width for t in written)])
            at = x if i == 0 else x - wide if i == len(columns) - 1 else x - wide / 2
            at = max(at, right + APART)
            right = at + wide
            lines, y = downwards(written, bottom, LEADING)
            self.items += [Placed("condition", "", (), (t.moved(at, 0.0),)) for t in lines]
            lowest = min(lowest, y)
        middle = union(i.box for i in self.items).centre[0]
        equations = (e for f in self.fields for e in f.written[: len(f.equations)] or f.equations)
        shown = [t for e in equations if (t := text(self._sides(e), SMALL))]
        lines, _ = downwards(shown, lowest - 1, LEADING)
        self.items += [Placed("condition", "", (), (t.moved(middle - t.width / 2, 0.0),)) for t in lines]

    def _sides(self, equation: Equation) -> str:
        left, right = equation.children
        return f"{self.labels.expression(left)} = {self.labels.expression(right)}"


def _derivatives(equation: Equation) -> list[Derivative]:
    """Return the derivatives in an equation, the highest first."""
    derivatives = [n for n in names(equation) if isinstance(n, Derivative)]
    return sorted(derivatives, key=lambda d: -d.order)


def _stiffness(
    equation: Equation, unknowns: Sequence[str]
) -> tuple[Expression, dict[Expression, Expression]]:
    """Return the coefficient of the highest derivative, and noughts for all unknowns and derivatives."""
    derivatives = _derivatives(equation)
    others: dict[Expression, Expression] = {n: number(0) for n in (*derivatives, *map(Name, unknowns))}
    return _coefficient(equation, {**others, derivatives[0]: number(1)}), others


def _coefficient(equation: Equation, values: Mapping[Expression, Expression]) -> Expression:
    """Return the left side less the right one, with values in place of what it holds."""
    left, right = (replace_values(side, values) for side in equation.children)
    return sum_of([left, negative(right)])


def _support(held: tuple[bool, bool], x: float, side: int, half: float) -> Iterator[Stroke]:
    """Yield a clamp, a hinge or a guide, by whether displacement and slope are held, or nothing."""
    is_still, is_level = held
    if is_still and is_level:
        yield from wall(-9, 9, side, x)
    elif is_still:
        y = -half
        yield from (outline((x, y), (x - 4.2, y - 7), (x + 4.2, y - 7)), *floor(x - 6.4, x + 6.4, y - 7))
    elif is_level:
        yield rectangle(min(x, x + side * 4.0), -8, max(x, x + side * 4.0), 8)
        yield from guide(-8, 8, side, x + side * 4.0)
