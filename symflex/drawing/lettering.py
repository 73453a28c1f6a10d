"""Texts of a drawing: labels of names and expressions in mathematics, and how large they are."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Final

from matplotlib import rcParams
from matplotlib.font_manager import FontProperties
from matplotlib.mathtext import MathTextParser

from symflex.drawing.geometry import Lettering
from symflex.errors import Text
from symflex.expressions import (
    Attribute,
    Call,
    Differentiated,
    Expression,
    Name,
    negative,
    product_of,
    replace_values,
    substitute,
)
from symflex.expressions import nodes as parts_of
from symflex.figures.style import PRIMES, label_of_name, label_of_unit, power_of_ten
from symflex.model import ExactValue, Model, ModelParameter
from symflex.print.label import read_label
from symflex.print.latex.equation import model_labels
from symflex.print.latex.expression import latex_expression
from symflex.print.latex.table import decimal_text
from symflex.print.writer import Style
from symflex.quantities import looks_like_quantity, parse_quantity, unit_of

SIZE: Final = 8.0  # size of the type [points], as in other figures
SMALL: Final = 7.0
LEADING: Final = 2.5  # space between lines of a label
_FINE: Final = 20  # matplotlib rounds the size of a text up to whole dots: as many are measured to a point
_PARSER: Final = MathTextParser("path")
_PRIMES: Final = re.compile("'{1,3}")
LONGEST_NAME: Final = 14  # letters of a name that has no other label


@lru_cache(maxsize=4096)
def _measured(markup: str, size: float, family: str) -> tuple[float, float, float] | None:
    del family  # rules the metrics and is part of the key
    try:
        width, height, depth, *_ = _PARSER.parse(markup, 72 * _FINE, FontProperties(size=size))
    except ValueError:
        return None
    # What is called the height includes the depth.
    return float(width) / _FINE, float(height - depth) / _FINE, float(depth) / _FINE


def text(latex: str, size: float = SIZE) -> Lettering | None:
    """Return a text at the origin, None if matplotlib cannot typeset it."""
    # Matplotlib makes small raised marks of apostrophes; fonts have primes of their own.
    markup = f"${_PRIMES.sub(lambda m: PRIMES[m[0]], latex)}$"
    measured = _measured(markup, size, str(rcParams["mathtext.fontset"])) if latex else None
    return None if measured is None else Lettering(markup, 0.0, 0.0, *measured, size)


def column_of(lines: Sequence[Lettering]) -> tuple[Lettering, ...]:
    """Return lines one below the other, centred at x = 0, the last one on y = 0."""
    placed, y = [], 0.0
    for one in reversed(lines):
        y += one.depth
        placed.append(one.moved(-one.width / 2, y))
        y += one.height + LEADING
    return tuple(reversed(placed))


def downwards(lines: Iterable[Lettering], y: float, between: float) -> tuple[list[Lettering], float]:
    """Return lines one below the other from a height down, and where they end."""
    placed = []
    for one in lines:
        placed.append(one.moved(0.0, y - one.height))
        y -= one.height + one.depth + between
    return placed, y


def filled(parts: Sequence[str], width: float, size: float = SMALL) -> list[Lettering]:
    """Return texts side by side in as few lines as they take, none of them wider than it may be."""
    lines: list[str] = []
    for part in parts:
        longer = rf"{lines[-1]},\quad {part}" if lines else part
        shown = text(longer, size) if lines else None
        if shown is not None and shown.width <= width:
            lines[-1] = longer
        else:
            lines.append(part)
    return [t for one in lines if (t := text(one, size))]


def name_latex(name: str) -> str:
    """Return a name in mathematics, cut where it is long."""
    if len(name) <= LONGEST_NAME:
        return label_of_name(name)
    return rf"\mathrm{{{name[: LONGEST_NAME - 1].replace('_', ' ').strip().replace(' ', '~')}\ldots}}"


@dataclass(frozen=True)
class Labels:
    """What the names of a model are called in its drawing."""

    model: Model
    has_values: bool = False  # parameters are followed by their values

    @cached_property
    def _known(self) -> Mapping[str, str]:
        declared = {p.name for p in self.model.parameters if p.latex}
        declared |= {d.name for d in self.model.definitions if d.latex}
        made = model_labels(self.model)
        # A made label that is not a mere letter with subscripts is long, and cut here.
        return {n: made[n] if n in declared or len(n) <= LONGEST_NAME else name_latex(n) for n in made}

    @cached_property
    def written_delays(self) -> Mapping[str, Expression]:
        """What an expression writes as ``exp(-s*T)``, by the name of the block that was made of it."""
        made = [b for b in self.model.blocks if b.name.startswith("delay_") and b.span is not None]
        times = {b.name: dict(b.values)["T"] for b in made if b.span and b.span.text.startswith("exp(")}
        return {name: Call("exp", negative(product_of([Name("s"), time]))) for name, time in times.items()}

    def end(self, name: str, latex: str) -> str:
        """Return the label of an input or output."""
        label = read_label(latex.strip()) if latex.strip() else None
        return f"{{{label.latex}}}" if label and text(label.latex) else name_latex(name)

    def name(self, name: str) -> str:
        """Return a name in mathematics: a parameter, node, signal, or quantity of an element, ``motor.i``."""
        if name in self._known:
            return self._known[name]
        ends = {e.name: e.latex for e in self.model.outputs} | {e.name: e.latex for e in self.model.inputs}
        if ends.get(name):
            return self.end(name, ends[name])
        owner, dot, component = name.partition(".")
        if not dot:
            return name_latex(name)
        stem, _, index = component.partition("_")
        stem = rf"\{stem}" if stem in ("tau", "theta") else stem
        inside = label_of_name(owner) if len(owner) <= LONGEST_NAME else name_latex(owner)
        return rf"{stem}_{{{inside + ',' + index if index else inside}}}"

    def fraction(self, expression: Expression) -> str:
        """Return an expression in mathematics, quotients as fractions."""
        return self.expression(expression, Style.TEXT)

    def expression(self, expression: Expression, style: Style = Style.INLINE) -> str:
        """Return an expression in mathematics, by default quotients with a slash."""
        # A bracket with primes is a name to the writer, and put in afterwards.
        expression = substitute(expression, self.written_delays)
        brackets = [n for n in parts_of(expression) if isinstance(n, Differentiated)]
        stands_for = {rf"\mathcal{{B}}_{{{i}}}": self._bracket(n) for i, n in enumerate(brackets)}
        plain = replace_values(expression, dict(zip(brackets, map(Name, stands_for), strict=True)))
        places = [n for n in parts_of(plain) if isinstance(n, Call) and "." in n.name]
        plain = replace_values(plain, {c: Name(c.name) for c in places})
        offered = [f"{n.owner}.{n.name}" for n in parts_of(plain) if isinstance(n, Attribute)]
        plain = substitute(plain, {n: Name(n) for n in offered})
        names = {n.name for n in parts_of(plain) if isinstance(n, Name)} - {"s", "pi"}
        fields = {n.name for n in parts_of(plain) if isinstance(n, Call)}
        labels = {n: self.name(n) for n in names | fields if n not in ("sqrt", "exp", *stands_for)}
        written = latex_expression(plain, labels | {n: n for n in stands_for}, style)
        for name, bracket in stands_for.items():
            written = written.replace(name, bracket)
        return written

    def _bracket(self, one: Differentiated) -> str:
        """Return a bracket with primes in mathematics."""
        point = "" if one.point is None else f"({self.expression(one.point)})"
        return f"({self.expression(one.operand)})" + one.order * "'" + point

    def quantity(self, expression: Expression, unit: str) -> str:
        """Return the value of an element: as it is written, a number with its unit."""
        if expression.span and looks_like_quantity(shown := expression.span.text):
            parsed = parse_quantity(Text(shown, expression.span))
            if parsed.unit:
                one = unit_of(parsed.unit)
                value = ExactValue(parsed.magnitude / one.scale, parsed.pi_power - one.pi_power)
                return with_unit(power_of_ten(decimal_text(value), r"\cdot "), parsed.unit)
        written = self.expression(expression)
        written = written.removeprefix(r"1 \cdot ")  # of a power of ten
        is_named = any(isinstance(n, Name | Attribute | Call) for n in parts_of(expression))
        return written if is_named else with_unit(written, unit)

    def values(self, expressions: Sequence[Expression]) -> list[str]:
        """Return what the parameters in expressions are, where values are asked for."""
        if not self.has_values:
            return []
        named = {n.name for e in expressions for n in parts_of(e) if isinstance(n, Name)}
        shown = [p for p in self.model.settable if p.name in named and p.value is not None]
        if len(expressions) == 1 and isinstance(expressions[0], Name):
            return [value_latex(p) for p in shown]  # below its name, which needs no second one
        return [f"{self.name(p.name)} = {value_latex(p)}" for p in shown]


def with_unit(number: str, unit: str) -> str:
    """Return a number in mathematics with its unit."""
    measured = label_of_unit(unit).strip("$")
    return rf"{number}\,{measured}" if measured else number


def value_latex(parameter: ModelParameter) -> str:
    """Return a parameter's value in the unit it was written in; one without a value has none."""
    value, unit = parameter.as_written()
    return "" if value is None else with_unit(power_of_ten(decimal_text(value), r"\cdot "), unit)
