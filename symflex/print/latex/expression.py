"""Expressions as LaTeX mathematics: the notation of :mod:`symflex.print.writer` for paper, in lines that fit.

Factors follow each other without a sign except where two numbers would meet. A line ends before a plus or
minus; a term too long for a whole line is broken between its factors, inside their parentheses, at the slash
of a quotient, and at last inside a number. What continues inside parentheses is indented, and so are the
factors of a term that stands in a sum.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Final, NamedTuple

from symflex.algebra.ring import FUNCTIONS
from symflex.expressions import Call, Expression, Negative, Number, Power, Product, Quotient, Sum
from symflex.expressions.format import number_text
from symflex.print.label import symbol
from symflex.print.width import (
    BIG_FENCES,
    BIGGER_FENCES,
    CDOT,
    CDOT_SIZES,
    DIGIT,
    MINUS,
    NOTHING,
    OPERATOR,
    QUAD,
    SCRIPT_SPACE,
    SLASH,
    THIN_SIZES,
    TIMES,
    Width,
)
from symflex.print.writer import (
    FENCES,
    MOST_PRIMES,
    ExpressionWriter,
    Shape,
    Spelling,
    Style,
    Written,
    is_half,
    operator_size,
    parts_of,
)


def latex_expression(expression: Expression, labels: Mapping[str, str], style: Style = Style.DISPLAY) -> str:
    """Return an expression as LaTeX for math mode; names without a label get one made of their letters."""
    return Writer(labels).piece(expression, style).markup


class Writer(ExpressionWriter):
    """Writes expressions as LaTeX with one set of labels."""

    def __init__(self, labels: Mapping[str, str]) -> None:
        super().__init__(labels, LATEX)


def _fenced(content: str, nesting: int, is_tall: bool) -> str:
    left, right = FENCES[nesting % len(FENCES)]
    return rf"\left{left} {content} \right{right}" if is_tall else f"{left}{content}{right}"


def _sum(terms: Sequence[tuple[str, bool]]) -> str:
    parts = [f"- {term[1:]}" if is_negative else f"+ {term}" for term, is_negative in terms]
    return " ".join((terms[0][0], *parts[1:]))


def _between(left: Written, right: Written) -> tuple[str, Width]:
    is_number = right.markup[:1].isdigit()
    if is_number or (right.markup.startswith(r"\frac") and left.markup[-1:].isdigit()):
        return r" \cdot ", CDOT_SIZES
    if left.shape is Shape.CALL or right.shape is Shape.CALL:
        return r" \, ", THIN_SIZES
    if (left.is_wordy or right.is_wordy) and not (left.nesting or right.nesting):
        return r" \, ", THIN_SIZES
    return " ", NOTHING


LATEX: Final = Spelling(
    fraction=r"\frac{{{}}}{{{}}}",
    slash="{}/{}",
    power=lambda base, exponent: f"{base}^{{{exponent}}}",
    applied="{}{}",
    digits="{}",
    negative="-{}",
    root=r"\sqrt{{{}}}",
    exponential=r"\mathrm{{e}}^{{{}}}",
    name=lambda name, labels: symbol(name, labels).latex,
    function=lambda name: FUNCTIONS[name].latex,
    primed=lambda name, order: name + ("'" * order if order <= MOST_PRIMES else rf"^{{({order})}}"),
    scientific=lambda mantissa, exponent: r" \cdot ".join(
        [mantissa] * bool(mantissa) + [f"10^{{{exponent}}}"]
    ),
    fenced=_fenced,
    sum=_sum,
    product="".join,
    between=_between,
    function_power=lambda head, call, exponent: f"{head}^{{{exponent}}}{call.removeprefix(head)}",
)


DEEPEST_INDENT: Final = 3
# In proportion to a line: the width from which a factor is broken rather than moved, and those of what may
# stand before and after its parentheses.
_LONG: Final = 0.5
_LONGEST_LEAD: Final = 0.25
_LONGEST_TAIL: Final = 0.15
_SQUARE_ROOT: Final = 1.26  # the exponent 1/2


class Glue(NamedTuple):
    """What joins an item to the one before: on its line, or at the start of the next, so far indented."""

    latex: str = ""
    width: float = 0.0
    start: str = ""
    start_width: float = 0.0
    depth: int = 0


class Edge(NamedTuple):
    """What stands at an item's edge and may not be parted from it, such as a parenthesis."""

    latex: str = ""
    width: float = 0.0


_GLUES: Final = {
    "+": Glue(" + ", OPERATOR, "{}+ ", OPERATOR),
    "-": Glue(" - ", OPERATOR, "{}- ", OPERATOR),
    "/": Glue("/", SLASH, "{}/ ", SLASH),
}
_TIMES: Final = r"{}\times "
_DOT: Final = r"{}\cdot "


def break_lines(expression: Expression, writer: Writer, first: float, others: float) -> list[str]:
    """Return an expression as lines for display, the first with room ``first``, others with ``others`` [em].

    Each line begins with its indentation, and all but the first with their operator.
    """
    # What has no room in the first line may then stand in no other, and so need not leave it empty.
    filler = _Filler(writer, first, min(first, others))
    filler.place(Glue(), Edge(), expression, lambda piece: piece, Edge(), 0)
    return [*filler.lines, "".join(filler.parts)]


class _Filler:
    """Fills lines from left to right."""

    def __init__(self, writer: Writer, first: float, others: float) -> None:
        self._writer = writer
        self._others = others
        self.lines: list[str] = []
        self.parts: list[str] = []  # of the line that is being filled
        self._room = first

    def place(
        self,
        glue: Glue,
        left: Edge,
        node: Expression,
        fence: Callable[[Written], Written],
        right: Edge,
        depth: int,
        hang: int = 0,
    ) -> None:
        """Set one item whole, on this line or the next, or in parts; those of a term hang below its sign."""
        bare = self._writer.piece(node)
        piece = fence(bare)
        width = left.width + piece.width + right.width
        if self._append(glue, f"{left.latex}{piece.markup}{right.latex}", width):
            return
        # A slash binds less tightly than the fraction bar it replaces.
        is_looser = bare.shape is Shape.FRACTION and fence in (self._writer.as_factor, self._as_denominator)
        if piece is not bare or is_looser:
            # Fences round what is broken have one size, chosen by what they hold.
            size = r"\Big" if bare.is_tall else r"\big"
            kind = bare.nesting % len(FENCES)
            opening, closing = FENCES[kind]
            width = (BIGGER_FENCES if bare.is_tall else BIG_FENCES)[kind]
            left = Edge(f"{left.latex}{size}l{opening} ", left.width + width)
            right = Edge(f" {size}r{closing}{right.latex}", right.width + width)
            depth += 1
        self._split(glue, left, node, bare, right, depth, 0 if piece is not bare else hang)

    def _append(self, glue: Glue, latex: str, width: float) -> bool:
        """Set something unbroken if this line or the next has room for it."""
        if self.parts and glue.width + width <= self._room:
            latex, width = f"{glue.latex}{latex}", glue.width + width
        elif self.parts or self.lines or width > self._room:
            if glue.start_width + width > self._rest(glue.depth):
                return False
            self._start(glue)
        self.parts.append(latex)
        self._room -= width
        return True

    def _force(self, glue: Glue, latex: str, width: float) -> None:
        """Set something that cannot be broken, on a line of its own and less far in if it must be."""
        while glue.depth and glue.start_width + width > self._rest(glue.depth):
            glue = glue._replace(depth=glue.depth - 1)
        if not self._append(glue, latex, width):
            self._start(glue)
            self.parts.append(latex)
            self._room -= width

    def _rest(self, depth: int) -> float:
        return self._others - QUAD * min(depth, DEEPEST_INDENT)

    def _start(self, glue: Glue) -> None:
        if self.parts:
            self.lines.append("".join(self.parts))
        self.parts = [r"\quad " * min(glue.depth, DEEPEST_INDENT) + glue.start]
        self._room = self._rest(glue.depth) - glue.start_width

    def _split(
        self, glue: Glue, left: Edge, node: Expression, bare: Written, right: Edge, depth: int, hang: int
    ) -> None:
        match node:
            case Sum() | Negative() | Quotient():
                self._split_signed(glue, left, node, right, depth, hang)
            case Product():
                self._split_product(glue, left, [p.node for p in parts_of(node)], right, depth, hang)
            case Power(base=base, exponent=exponent):
                piece = self._writer.exponent(exponent)
                raised = Edge(f"^{{{piece.markup}}}", piece.size.script + SCRIPT_SPACE.text)
                raised = Edge("^{1/2}", _SQUARE_ROOT) if is_half(exponent) else raised
                after = Edge(f"{raised.latex}{right.latex}", raised.width + right.width)
                self.place(glue, left, base, self._writer.as_base, after, depth)
            case Call(name="sqrt", argument=argument):
                after = Edge(f"^{{1/2}}{right.latex}", _SQUARE_ROOT + right.width)
                self.place(glue, left, argument, self._writer.fenced, after, depth)
            case Call(name=name, argument=argument):
                head = Edge(f"{left.latex}{FUNCTIONS[name].latex}", left.width + operator_size(name).text)
                self.place(glue, head, argument, self._writer.fenced, right, depth)
            case Number(value):
                above, _, below = number_text(value).partition("/")
                self._split_digits(glue, left, above, Edge() if below else right, depth)
                if below:
                    self._split_digits(_GLUES["/"]._replace(depth=depth), Edge(), below, right, depth)
            case _:
                width = left.width + bare.width + right.width
                self._force(glue, f"{left.latex}{bare.markup}{right.latex}", width)

    def _split_signed(
        self, glue: Glue, left: Edge, node: Expression, right: Edge, depth: int, hang: int
    ) -> None:
        """Set the terms of a sum, or what stands before and after a slash."""
        parts = parts_of(node)
        for i, (sign, part) in enumerate(parts):
            before, after = left if i == 0 else Edge(), right if i == len(parts) - 1 else Edge()
            fence, inner, hanging = self._writer.as_term, depth, 1 if isinstance(node, Sum) else hang
            if isinstance(node, Quotient):
                fence = self._as_denominator if sign else self._writer.as_numerator
                inner, hanging = depth + hang * i, 0
            elif i and self._writer.piece(node.children[i]).width > self._rest(depth):
                # A term of several lines begins its own.
                self._room = 0.0
            if i == 0 and sign:
                before = Edge(f"{left.latex}-", left.width + MINUS)
            joint = _GLUES[sign]._replace(depth=inner) if i else glue
            self.place(joint, before, part, fence, after, inner, hanging)

    def _split_product(
        self, glue: Glue, left: Edge, factors: list[Expression], right: Edge, depth: int, hang: int
    ) -> None:
        pieces = [self._writer.as_factor(self._writer.piece(factor)) for factor in factors]
        long = [i for i, piece in enumerate(pieces) if piece.width > _LONG * self._others]
        if len(long) == 1 and factors[long[0]].children:
            # Short factors stay with the parentheses of the one that is broken.
            (k,) = long
            before, after = self._beside(pieces[: k + 1]), self._beside(pieces[k:], leading=True)
            if before.width <= _LONGEST_LEAD * self._others and after.width <= _LONGEST_TAIL * self._others:
                left = Edge(f"{left.latex}{before.latex}", left.width + before.width)
                right = Edge(f"{after.latex}{right.latex}", after.width + right.width)
                self.place(glue, left, factors[k], self._writer.as_factor, right, depth)
                return
        for index, (factor, piece) in enumerate(zip(factors, pieces, strict=True)):
            sign, edge = glue, left
            if index:
                between, gap = self._writer.between(pieces[index - 1], piece)
                start, start_width = (_DOT, CDOT) if gap == CDOT_SIZES else (_TIMES, TIMES)
                sign, edge = Glue(between, gap.text, start, start_width, depth + hang), Edge()
            after = right if index == len(factors) - 1 else Edge()
            self.place(sign, edge, factor, self._writer.as_factor, after, depth + hang * bool(index))

    def _split_digits(self, glue: Glue, left: Edge, text: str, right: Edge, depth: int) -> None:
        """Set a number too long for a line: its digits go on in the next."""
        depth = max(depth, glue.depth)
        edges = left.width + right.width + glue.start_width
        piece = self._writer.number(text)
        mantissa, _, exponent = text.partition("e")
        if text[1:2] == "e" or piece.width + edges <= self._rest(0 if exponent else depth):
            width = left.width + piece.width + right.width
            self._force(glue, f"{left.latex}{piece.markup}{right.latex}", width)
            return
        if exponent:
            tenth = self._writer.number(f"1e{exponent}")
            right = Edge(rf" \cdot {tenth.markup}{right.latex}", CDOT + tenth.width + right.width)
            return self._split_digits(glue, left, mantissa, right, depth)
        count = max(1, int((self._rest(depth) - edges) / DIGIT))
        for start in range(0, len(text), count):
            chunk = text[start : start + count]
            before = left if start == 0 else Edge()
            after = right if start + count >= len(text) else Edge()
            self._start(glue if start == 0 else Glue(depth=depth))
            self.parts.append(f"{before.latex}{chunk}{after.latex}")
            self._room -= before.width + DIGIT * len(chunk) + after.width

    def _beside(self, pieces: Sequence[Written], *, leading: bool = False) -> Edge:
        """Return all pieces but the last, or the first, side by side as they stand next to it."""
        if len(pieces) == 1:
            return Edge()
        alone = pieces[0] if leading else pieces[-1]
        parts, extra = self._writer.joined(pieces)
        rest = "".join(parts[1:] if leading else parts[:-1])
        return Edge(rest, sum(piece.width for piece in pieces) - alone.width + extra.text)

    def _as_denominator(self, piece: Written) -> Written:
        return piece if piece.shape >= Shape.FRACTION else self._writer.fenced(piece)
