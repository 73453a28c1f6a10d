r"""Read a formula as a paper types it in LaTeX: exact tokens with their places, then recursive descent.

Input: tokens, and the names that a model has. Output: the tree that the text reader gives.

    \frac{2ml^2s^2}{\cosh^2\lambda l}      2*m*l^2*s^2/cosh(lambda*l)^2

A product of symbols is cut by the names that are known: ``mgls^2`` is ``m*g*l*s^2``, and ``EIs`` is ``EI*s``
where ``EI`` is a name and ``E`` is none. Print leaves some formulas open. ``1/2k``, ``a/b c`` and
``\sin \omega t s`` are read both ways and compared at a point that nothing suggests: equal readings are one
formula, others are refused with both. What is not understood is refused at its place.
"""

from __future__ import annotations

import cmath
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Final, Literal, NamedTuple, NoReturn
from zlib import crc32

from symflex.errors import Span, SpecError, Text
from symflex.expressions import (
    FUNCTIONS,
    RECIPROCALS,
    Call,
    Derivative,
    Differentiated,
    Expression,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    fold,
    format_expression,
    is_longer,
    is_number,
    names,
    negative,
    nodes,
    number,
    parse,
    power,
    product_of,
    substitute,
    sum_of,
    with_children,
)
from symflex.papers.labels import ACCENTS, GREEK
from symflex.papers.source import (
    BRACED,
    CLOSERS,
    DEEPEST,
    DELIMITERS,
    FONTS,
    MATRICES,
    SPACES,
    SWITCHES,
    TIMES,
    LatexToken,
    PrintedEquation,
    environment,
    group_end,
    prepared,
    refusal,
    skip_arguments,
    statements,
    text_of,
    tokens_of,
    with_depth,
)
from symflex.quantities import unit_named

LAPLACE: Final = "s"
IMAGINARY: Final = "ij"
MOST_TERMS: Final = 64  # of products and sums that are written out
MOST_OPEN: Final = 12  # places that can be read in two ways
LONGEST_RUN: Final = 8  # letters of a name that are typed side by side
LARGEST_MATRIX: Final = 4  # whose determinant is expanded
MOST_ROWS: Final = 12
MOST_PARTS: Final = 20_000  # of a product of matrices, or of a determinant
FRACTIONS: Final = frozenset(rf"\{name}" for name in "frac dfrac tfrac cfrac nicefrac sfrac".split())
CALLIGRAPHIC: Final = {r"\mathcal": "cal", r"\mathscr": "cal", r"\mathbb": "bb", r"\mathfrak": "frak"}
ACCENTED: Final = {
    **{rf"\{a}": a for a in (*ACCENTS, "mathring", "dddot", "ddddot")},
    **{r"\widehat": "hat", r"\widetilde": "tilde", r"\overline": "bar"},
}
DOTS: Final = {"dot": 1, "ddot": 2, "dddot": 3, "ddddot": 4}
LETTERS: Final = {
    **{rf"\{name}": name for name in (*GREEK, "ell", "hbar", "partial", "nabla")},
    **{r"\imath": "i", r"\jmath": "j", r"\varOmega": "Omega", r"\varDelta": "Delta"},
}
CALLS: Final = {
    **{rf"\{f}": f for f in (*FUNCTIONS, *RECIPROCALS) if f not in ("sqrt", "log", "atan")},
    **{r"\ln": "log", r"\arctan": "atan", r"\tg": "tan", r"\ctg": "cot", r"\sh": "sinh", r"\ch": "cosh"},
}
UNREAD: Final = {  # what begins no formula that could be judged, and what to do
    r"\infty": ("infinity is no number here", None),
    **dict.fromkeys((r"\lim", r"\int", r"\oint"), ("a limit or an integral is not read", None)),
    r"\log": (r"\log may be the natural or the decimal logarithm", r"write \ln for the natural one"),
    r"\lg": (r"\lg is a decimal logarithm", r"write \ln"),
    r"\th": (r"\th is not read", r"write \tanh"),
}
ARGUMENTS: Final = frozenset(  # what a function of time or frequency is written as a function of
    (
        "s",
        "p",
        "D",
        "z",
        "t",
        "x",
        "x,t",
        "x,s",
        "s,t",
        r"\omega",
        r"j\omega",
        r"i\omega",
        r"\imath\omega",
        r"\jmath\omega",
    )
)
PARTS: Final = frozenset("Re Im arg sgn sign min max det diag rank tr span".split())
SPOKEN: Final = {f.lstrip("\\"): g for f, g in CALLS.items()}  # functions by their names, as \mathrm{sinh}
ELLIPSES: Final = frozenset(rf"\{s}" for s in "ldots cdots dots dotsb dotsc dotsm dotsi vdots ddots".split())
PRIMES: Final = {"'": 1, "’": 1, "′": 1, "″": 2, r"\prime": 1}
ANGLES: Final = frozenset("theta vartheta phi varphi psi alpha gamma delta".split())  # what is an angle alone


class PrintedSymbol(NamedTuple):
    """What tells one printed symbol from others."""

    base: str  # letters, and Greek letters by their names
    marks: str = ""  # accents and primes, in words
    script: str = ""  # letters and digits of the subscript, then of a superscript that is no power

    @property
    def name(self) -> str:
        """A name for it in the grammar of expressions."""
        return "_".join(filter(None, (self.base, self.marks, *self.script.split("^"))))


def symbol_of_name(name: str) -> PrintedSymbol:
    """Return the symbol that a name of a model prints as.

    >>> symbol_of_name("omega_n1"), symbol_of_name("k2").script
    (PrintedSymbol(base='omega', marks='', script='n1'), '2')
    """
    stem, *parts = name.split("_")
    base = stem.rstrip("0123456789")
    return PrintedSymbol(base, "", stem[len(base) :] + "".join(parts)) if base else PrintedSymbol(name)


@dataclass(frozen=True)
class PaperNotation:
    """What the symbols of a paper are called in a model."""

    names: Mapping[PrintedSymbol, str] = field(default_factory=dict)
    signals: frozenset[str] = frozenset()  # those of them that vary: outputs, inputs, unknowns
    # What dots and primes mean: nothing, derivatives in time, or derivatives in time and along x.
    motion: Literal["", "time", "field"] = ""

    def with_names(self, more: Mapping[PrintedSymbol, str]) -> PaperNotation:
        """Return the notation with further symbols, which hide others."""
        return replace(self, names={**self.names, **more})


def notation_of(
    named: Iterable[tuple[str, str]],
    signals: Iterable[str] = (),
    tied: Iterable[tuple[str, str]] = (),
) -> PaperNotation:
    r"""Return the notation of names, each with its label, which may be empty; symbols in ``tied`` come first.

    >>> sorted(notation_of([("k_t", r"K_{\mathrm{t}}")]).names.values())
    ['k_t', 'k_t', 's']
    """
    made: dict[PrintedSymbol, set[str]] = {}
    pairs = list(named)
    for name, _ in pairs:
        made.setdefault(symbol_of_name(name), set()).add(name)
    labels: dict[PrintedSymbol, str] = {}
    for name, latex in pairs:
        if latex and (symbol := symbol_of_latex(Text.alone("<label>", latex))) is not None:
            labels[symbol] = name
    plain = {symbol: min(found) for symbol, found in made.items() if len(found) == 1}
    given = {
        symbol: name for latex, name in tied if (symbol := symbol_of_latex(Text.alone("<symbol>", latex)))
    }
    return PaperNotation({PrintedSymbol(LAPLACE): LAPLACE, **plain, **labels, **given}, frozenset(signals))


def symbol_of_latex(text: Text) -> PrintedSymbol | None:
    """Return the symbol that LaTeX stands for, ``None`` if it is none."""
    try:
        reader = _LatexReader(prepared(tokens_of(text)), PaperNotation(), {}, {})
        symbol = reader.whole_symbol()
    except SpecError:
        return None
    return symbol if reader.at == len(reader.tokens) else None


def read_formula(
    tokens: Sequence[LatexToken],
    notation: PaperNotation,
    bound: Mapping[str, int] | None = None,
    laplace: str = LAPLACE,
) -> Expression:
    """Return the tree of one side of an equation; ``laplace`` is what the paper calls s.

    Raises SpecError with SF115 at what is not read or can be read in two ways, SF103 beyond limits.
    """
    value = read_value(tokens, notation, bound)
    if isinstance(value, Matrix):
        raise refusal(tokens[0].span, "this is a matrix, not a formula", "give one of its entries")
    if laplace != LAPLACE:
        value = substitute(value, {laplace: Name(LAPLACE)})
    return value


Lines = tuple[tuple[str, Expression], ...]


def read_latex(text: Text, notation: PaperNotation) -> tuple[Expression, Lines]:
    r"""Return a formula, the last side of ``G = a = b``, and the definitions that follow it.

    >>> text = Text.alone("paper", r"\frac{c}{s+p}, \text{ where } p = 2c")
    >>> formula, lines = read_latex(text, notation_of([]))
    >>> format_expression(formula), [(name, format_expression(line)) for name, line in lines]
    ('c/(s + p)', [('p', '2*c')])
    """
    found = [s for s in statements(tokens_of(text)) if not s.is_condition]
    if not found:
        raise refusal(text.span, "this is no formula")
    first, *others = found
    if first.nearly is not None:
        raise refusal(first.nearly, "this formula only holds nearly", "write = if it is meant exactly")
    symbols = dict(filter(None, (defined_symbol(s) for s in others)))
    more = notation.with_names({symbol: symbol.name for symbol in symbols})
    lines = tuple((symbol.name, definition(statement, more)) for symbol, statement in symbols.items())
    for other in others:
        if defined_symbol(other) is None:
            raise refusal(other.span, "this is more than one formula", "give one formula")
    formula = read_formula(first.sides[-1], more, laplace=laplace_of(first, notation))
    (whole, *values), _ = in_laplace([formula, *(line for _, line in lines)], more)
    return whole, tuple((name, line) for (name, _), line in zip(lines, values, strict=True))


def in_laplace(expressions: Sequence[Expression], notation: PaperNotation) -> tuple[list[Expression], str]:
    """Return expressions in s, and what is s: p, D, or a frequency, if that is all that has no meaning."""
    used = {n.name for e in expressions for n in names(e) if isinstance(n, Name)}
    known = {*notation.names.values(), "pi"}
    if LAPLACE not in used and used & known and used - known in ({"p"}, {"D"}):
        (name,) = used - known
        return [substitute(e, {name: Name(LAPLACE)}) for e in expressions], name
    if LAPLACE not in used and used & known and used - known in ({"omega"}, {"Omega"}):
        (name,) = used - known
        turned = [_turned(e, "j", name) for e in expressions]  # -omega^2 is s^2
        if all(found is not None and not found[1] for found in turned):
            return [found[0] for found in turned if found is not None], name
    return list(expressions), LAPLACE


def defined_symbol(statement: PrintedEquation) -> tuple[PrintedSymbol, PrintedEquation] | None:
    """Return the symbol that an equation defines, or a power of which, ``None`` if it defines none."""
    if len(statement.sides) < 2 or statement.is_condition or statement.nearly:  # noqa: PLR2004
        return None
    reader = _LatexReader(statement.sides[0], PaperNotation(), {}, {})
    try:
        symbol = reader.whole_symbol()
        if reader.text == "^":
            typed = text_of(reader.tokens[reader.at + 1 : group_end(reader.tokens, reader.at + 1)]).strip(
                "{}"
            )
            reader.take()
            reader.group()
            if typed.isalpha():  # G^v is a name where nothing else has been said of G
                symbol = symbol._replace(script=f"{symbol.script}^{typed}")
        reader.applied(Name(symbol.name))
    except SpecError:
        return None
    return (symbol, statement) if reader.at == len(reader.tokens) and not reader.open else None


def definition(
    statement: PrintedEquation, notation: PaperNotation, bound: Mapping[str, int] | None = None
) -> Expression:
    """Return what an equation says its symbol is, of ``a^2 = b`` the root; ``bound`` are indices."""
    value = read_formula(statement.sides[-1], notation, bound, laplace_of(statement, notation))
    left_side = read_formula(statement.sides[0], notation, bound)
    if not isinstance(left_side, Power):
        return value
    if not isinstance(left_side.exponent, Number) or left_side.exponent.value < 1:
        raise refusal(statement.span, "this power defines no symbol")
    if left_side.exponent.value == 2:  # noqa: PLR2004
        return Call("sqrt", value, span=value.span)
    return Power(value, Quotient(Number(Fraction(1)), left_side.exponent), span=value.span)


def laplace_of(statement: PrintedEquation, notation: PaperNotation) -> str:
    """Return what an equation calls the Laplace variable: p or D where it says so and has no s."""
    texts = [t.text for t in statement.tokens]
    for name in ("p", "D"):
        if PrintedSymbol(name) in notation.names or LAPLACE in texts or name not in texts:
            continue
        if any(texts[i : i + 3] == ["(", name, ")"] for i in range(1, len(texts))):
            return name
    return LAPLACE


# --- from tokens to trees ---


@dataclass(frozen=True, slots=True)
class Matrix:
    """Rows of trees."""

    rows: tuple[tuple[Expression, ...], ...]
    span: Span


Value = Expression | Matrix


def read_value(
    tokens: Sequence[LatexToken], notation: PaperNotation, bound: Mapping[str, int] | None = None
) -> Value:
    """Return what one side of an equation is, a matrix too; see :func:`read_formula`."""
    if not tokens:
        raise refusal(None, "the formula is empty")
    first = _LatexReader(tokens, notation, {}, bound or {})
    value = first.everything()
    _check_limits(value, tokens)
    if len(first.open) > MOST_OPEN:
        message = f"more than {MOST_OPEN} places of this formula can be read in two ways"
        raise refusal(tokens[0].span, message, "write brackets")
    for at, count in first.open.items():
        for choice in range(1, count):
            other = _LatexReader(tokens, notation, {at: choice}, bound or {})
            try:
                second = other.everything()
            except SpecError:
                continue  # is no reading
            if not _agree(value, second, notation):
                shown = [_shown(first.built.get(at, value)), _shown(other.built.get(at, second))]
                if shown[0] == shown[1]:
                    shown = [_shown(value), _shown(second)]
                message = f"this can be read in two ways: {shown[0]} or {shown[1]}"
                raise refusal(tokens[at].span, message, "write brackets, as \\left( ... \\right)")
    return settled(value, notation, tokens[0].span)


def _check_limits(value: Value, tokens: Sequence[LatexToken]) -> None:
    """Refuse a tree that the text reader would refuse for its size."""
    for entry in (value,) if isinstance(value, Expression) else (e for row in value.rows for e in row):
        try:
            parse(Text.alone("formula", format_expression(entry)), brackets=True)
        except SpecError as error:
            placed = (replace(d, span=tokens[0].span) for d in error.diagnostics)
            raise SpecError(*placed) from None


def _shown(value: Value) -> str:
    text = format_expression(value) if isinstance(value, Expression) else "a matrix"
    return text if len(text) <= 90 else f"{text[:40]} ... {text[-40:]}"  # noqa: PLR2004


def _agree(a: Value, b: Value, notation: PaperNotation) -> bool:
    """Tell whether two readings are one formula, or the second has names that nobody knows."""
    if isinstance(a, Matrix) or isinstance(b, Matrix):
        if not (isinstance(a, Matrix) and isinstance(b, Matrix)) or len(a.rows) != len(b.rows):
            return False
        pairs = [(x, y) for r, q in zip(a.rows, b.rows, strict=True) for x, y in zip(r, q, strict=True)]
        return all(_agree(x, y, notation) for x, y in pairs)
    for seed in ("a", "b"):
        try:
            x, y = evaluated(_at_rest(a), seed), evaluated(_at_rest(b), seed)
        except (ArithmeticError, ValueError, TypeError):
            return False
        if abs(x - y) > 1e-9 * (abs(x) + abs(y)):
            return False
    return True


def _at_rest(node: Expression) -> Expression:
    """Return an expression with derivatives and values at points as names of their own."""
    if isinstance(node, Derivative) or (isinstance(node, Call) and node.name not in FUNCTIONS):
        return Name(format_expression(node))
    if isinstance(node, Differentiated):
        return Product((Name("derivative"), _at_rest(node.operand)))
    return with_children(node, [_at_rest(child) for child in node.children]) if node.children else node


def evaluated(expression: Expression, seed: str = "") -> complex:
    """Return the value of a tree at a point that its names' spelling decides."""

    def value(name: str) -> complex:
        if name == "pi":
            return complex(cmath.pi)
        drawn = crc32(f"{name} {seed}".encode())
        return complex(0.3 + (drawn & 0xFFFF) / 50_000, 0.1 + (drawn >> 16) / 90_000)

    def call(node: Call, argument: complex) -> complex:
        function = {"exp": cmath.exp, "log": cmath.log}.get(node.name) or getattr(cmath, node.name)
        result: complex = function(argument)
        return result

    return fold(
        expression,
        number=complex,
        name=value,
        power=lambda base, exponent: base ** evaluated(exponent, seed),
        call=call,
    )


ALONE: Final = frozenset(("", "+", "=", "&", "{", r"\\", r"\over", ",", *DELIMITERS))
"""After these a group stands by itself."""
LONGEST_BRACE: Final = max(map(len, BRACED)) + 2


class _LatexReader:
    """Reads one list of tokens once. ``choices`` says where to take another reading than the first."""

    def __init__(
        self,
        tokens: Sequence[LatexToken],
        notation: PaperNotation,
        choices: Mapping[int, int],
        bound: Mapping[str, int],
    ) -> None:
        self.tokens, self.notation, self.choices = list(tokens), notation, choices
        self.bound = dict(bound)  # the index of a product that is written out
        self.at = self.depth = self.written = 0
        self.open: dict[int, int] = {}  # where there are how many readings
        self.built: dict[int, Expression] = {}  # what was made of them
        self.typed: dict[str, str] = {}  # how each name is typed

    # -- words --

    @property
    def text(self) -> str:
        return self.tokens[self.at].text if self.at < len(self.tokens) else ""

    def ahead(self, count: int = 1) -> str:
        return self.tokens[self.at + count].text if self.at + count < len(self.tokens) else ""

    def take(self) -> LatexToken:
        if self.at >= len(self.tokens):
            last = self.tokens[-1].span if self.tokens else None
            raise refusal(last, "the formula ends here, where a number or a symbol should follow")
        self.at += 1
        return self.tokens[self.at - 1]

    def refuse(self, message: str, hint: str | None = None, at: int | None = None) -> NoReturn:
        index = min(self.at if at is None else at, len(self.tokens) - 1)
        raise refusal(self.tokens[index].span if self.tokens else None, message, hint)

    def span(self, start: int) -> Span:
        first, last = self.tokens[start].span, self.tokens[max(start, self.at - 1)].span
        is_one = first.source is last.source and first.start <= last.end
        return Span(first.source, first.start, last.end) if is_one else first

    def choose(self, at: int, count: int) -> int:
        """Return which reading to take at a token that has so many."""
        self.open[at] = max(count, self.open.get(at, 0))
        return self.choices.get(at, 0)

    def whole_symbol(self) -> PrintedSymbol:
        """Return the symbol that begins here, of all letters that stand side by side."""
        count = 1
        while True:
            word = self.ahead(count)
            if not (word in LETTERS or (word.isascii() and word.isalpha() and len(word) == 1)):
                break
            count += 1
        symbol, self.at, *_ = self.one_symbol(count)
        return symbol

    # -- sums and products --

    def everything(self) -> Value:
        value = self.sum()
        if self.at < len(self.tokens):
            self.unexpected()
        return value

    def unexpected(self) -> NoReturn:
        text = self.text
        if text in ELLIPSES:
            self.refuse("an ellipsis leaves out what the formula is", "write out every term")
        if text in ("|", r"\vert", r"\lvert", r"\rvert", r"\Vert"):
            self.refuse("a magnitude or a value at a point is not read")
        if text in (r"\pm", r"\mp"):
            self.refuse("a double sign makes two formulas of one", "give one of them")
        if text in CLOSERS or text == "}":
            self.refuse(f"there is nothing that this '{text}' closes")
        if text == ",":
            self.refuse("a comma separates what should be one formula", "a decimal comma is {,}")
        if text == "!":
            self.refuse("a factorial is not read")
        if text and ord(text[0]) < 32:  # noqa: PLR2004
            self.refuse("a control character is not read")
        self.refuse(f"'{text[:40]}' is not read here")

    def enter(self) -> None:
        """Count a level of nesting; what ends normally leaves it."""
        self.depth += 1
        if self.depth > DEEPEST:
            self.refuse("this is nested too deeply", "name parts of it")

    def read_inner(self, tokens: Sequence[LatexToken]) -> Value:
        """Return what a part of the formula is that is read by itself."""
        reader = _LatexReader(tokens, self.notation, {}, self.bound)
        reader.depth = self.depth + 1
        return reader.everything()

    def sum(self) -> Value:
        self.enter()
        start = self.at
        terms: list[Value] = []
        while True:
            sign = ""
            if self.text in ("+", "-"):
                sign = self.take().text
            elif terms:
                break
            term = self.product()
            terms.append(_negative(term) if sign == "-" else term)
            if self.text in (r"\over", r"\atop"):
                break
        value = _sum(terms, self.span(start), self)
        if self.text == r"\over":
            self.take()
            value = _quotient(value, self.sum(), self.span(start), self)
        self.depth -= 1
        return value

    def product(self) -> Value:
        start = self.at
        opened = set(self.open)
        value = self.operand()
        slash: int | None = None  # where the last divisor began that a factor might belong to
        while True:
            text = self.text
            if text in TIMES:
                self.take()
                slash = None
                value = _product(value, self.signed_operand(), self.span(start), self)
            elif text in ("/", r"\div", r"\slash"):
                sign_at = self.at
                self.take()
                divisor = self.operand()
                if slash is not None and self.choose(sign_at, 2):
                    self.refuse("a/b/c is read from the left")
                if self.starts() and self.choose(self.at, 2):
                    while self.starts():
                        divisor = _product(divisor, self.operand(), self.span(start), self)
                if self.text in ("/", r"\div") and self.choose(self.at, 2):  # a/(b/c)
                    self.take()
                    divisor = _quotient(divisor, self.operand(), self.span(start), self)
                value = _quotient(value, divisor, self.span(start), self)
                slash = None
            elif self.starts():
                is_unit = self.tokens[self.at - 1].text in IMAGINARY and text.isdigit()  # j2\beta l
                if not is_unit and (text.isdigit() or (text == "." and self.ahead().isdigit())):
                    before = self.tokens[self.at - 1].text
                    message = f"the number after '{before}' could be a factor, an index or a power"
                    self.refuse(message, "write it in front, as x_2 or as x^2")
                is_bare = isinstance(value, Expression) and not names(value)
                is_apart = self.tokens[self.at].is_spaced or text in (r"\text", r"\textrm", r"\mbox")
                if text in FONTS and (is_bare or is_apart) and self.is_unit(any_name=is_bare):
                    self.refuse("what follows this may be a unit or a factor")
                value = _product(value, self.operand(), self.span(start), self)
            else:
                break
        if isinstance(value, Expression):
            self.built.update(dict.fromkeys(set(self.open) - opened, value))
        return value

    def is_unit(self, *, any_name: bool) -> bool:
        """Tell whether upright letters are the symbol of a unit, or only of seconds, and no function."""
        end = group_end(self.tokens, self.at + 1)
        word = text_of(t for t in self.tokens[self.at + 1 : end] if t.text not in "{}")
        is_one = word == LAPLACE or (any_name and unit_named(word) is not None)
        return word not in IMAGINARY and is_one and not self.upright_base()

    def signed_operand(self) -> Value:
        if self.text == "-":
            self.take()
            return _negative(self.operand())
        return self.operand()

    def starts(self) -> bool:
        """Tell whether a factor begins here."""
        text = self.text
        return bool(text) and (
            (text.isascii() and text.isalnum())
            or (text == "." and self.ahead().isdigit())
            or text in DELIMITERS
            or text in FRACTIONS
            or text in FONTS
            or text in ACCENTED
            or text in LETTERS
            or text in CALLS
            or text
            in (
                "{",
                r"\sqrt",
                r"\begin",
                r"\prod",
                r"\sum",
                r"\det",
                r"\exp",
                r"\log",
                r"\th",
                r"\lg",
                "|",
                r"\infty",
            )
            or text
            in (
                r"\min",
                r"\max",
                r"\lim",
                r"\int",
                r"\arg",
                r"\Re",
                r"\Im",
                r"\vert",
                r"\lvert",
                r"\abs",
                r"\binom",
            )
        )

    # -- factors --

    def operand(self) -> Value:
        """Return an atom with its powers."""
        self.enter()
        start = self.at
        value, is_bare = self.atom()
        if is_bare and isinstance(value, Expression):
            self.ratio_applied(value)
        self.depth -= 1
        return self.powers(value, start) if is_bare else value

    def powers(self, value: Value, start: int) -> Value:
        raised = False
        while self.text in ("^", "_", "**") or self.text in PRIMES:
            if self.text == "_":
                self.refuse("a subscript of a bracket is not read")
            if self.text in PRIMES:
                self.refuse("a derivative of a bracket is not read")
            if raised:
                self.refuse("a second power follows", "write braces: {x^2}^3")
            self.take()
            if isinstance(value, Matrix) and text_of(self.tokens[self.at : self.at + 3]) in ("{-1",):
                self.group()
                value = _inverse(value, self)
                continue
            if isinstance(value, Matrix):
                self.refuse("a power of a matrix other than its inverse is not read")
            exponent = self.group_expression()
            value = _power(value, exponent, self.span(start), self)
            raised = True
        return value

    def group(self) -> Value:
        """Return what an argument is: a group, a digit, a letter, or a command with its arguments."""
        if self.text == "{":
            start = self.at
            self.take()
            if self.text == "}":
                self.refuse("this group is empty", at=start)
            value = self.sum()
            if self.text != "}":
                if not self.text:
                    self.refuse("this '{' is never closed", "add '}'", start)
                self.unexpected()
            self.take()
            return value
        if self.text.isdigit():
            token = self.take()
            return Number(Fraction(int(token.text)), span=token.span)
        if self.text in ("", "}", "^", "_", "&", r"\\"):
            self.refuse("an argument is missing here")
        return self.atom(alone=True)[0]

    def is_of_digits(self) -> bool:
        """Tell whether a fraction of two numbers stands here, as in one and a half."""
        end = group_end(self.tokens, self.at + 1)
        parts = self.tokens[self.at + 1 : group_end(self.tokens, end)]
        return all(x.text.isdigit() or x.text in "{}" for x in parts)

    def braced(self, *, alone: bool) -> Value:
        """Return a group between other factors; braces do not show, so a sum in them is not bracketed."""
        start = self.at
        value = self.group()
        first, last = self.tokens[start + 1].text, self.at - 1
        span = self.tokens[start].span
        typed = span.source.text[max(span.start - LONGEST_BRACE, 0) : span.start].rstrip()
        shows = first in DELIMITERS and self.end_of_bracket(start + 1) == last
        shows = shows or typed.endswith(tuple(BRACED))
        before = self.tokens[start - 1].text if start else ""
        is_joined = self.text == "^" or self.starts() or before not in ALONE
        is_open = isinstance(value, Sum) or (self.text == "^" and isinstance(value, Product))
        if not (alone or shows) and is_joined and is_open:
            self.refuse("braces do not show, so this may be a bracket or none", "write ( and )", start)
        return value

    def group_expression(self) -> Expression:
        start = self.at
        value = self.group()
        if isinstance(value, Matrix):
            self.refuse("a matrix cannot stand here", at=start)
        return value

    def atom(self, *, alone: bool = False) -> tuple[Value, bool]:
        """Return an atom, and whether powers after it are still to be read."""
        start, text = self.at, self.text
        if text.isdigit() or (text == "." and self.ahead().isdigit()):
            value = self.number()
            if self.text in FRACTIONS and self.is_of_digits():
                self.refuse("this may be a mixed number or a product", r"write \cdot, or one fraction", start)
            return value, True
        if upright := self.upright_base():
            return self.exponential(start, upright), False
        if text == "{":
            if self.ahead() == "}":  # {} holds scripts and does not show
                self.at += 2
                if self.starts():
                    return self.atom()
                self.refuse("an empty group is not read", at=start)
            after = self.tokens[min(group_end(self.tokens, start), len(self.tokens) - 1)].text
            if after == "_" or after in PRIMES:  # {\omega}_c
                return self.symbol(alone=alone), False
            return self.braced(alone=alone), True
        if text in DELIMITERS:
            return self.bracket(), True
        if text in FRACTIONS:
            return self.fraction(), True
        if text == r"\sqrt":
            return self.root(), True
        if text in (r"\begin", "|", r"\vert", r"\lvert", r"\det"):
            return self.matrix(), True
        if text in (r"\prod", r"\sum"):
            return self.written_out(), False
        if (call := self.function()) is not None:
            return call, False
        if text in LETTERS or text in ACCENTED or text in FONTS or (text.isascii() and text.isalpha()):
            return self.symbol(alone=alone), False
        if text in UNREAD:
            self.refuse(*UNREAD[text])
        self.unexpected()

    def number(self) -> Expression:
        start = self.at
        digits = ""
        while True:
            text = self.text
            if text.isdigit() and text.isascii():
                if digits and self.tokens[self.at].is_spaced and not self.is_thousands(digits):
                    self.refuse("two numbers stand side by side", "join them, or write \\cdot")
                digits += self.take().text
            elif text == "." and self.ahead().isdigit() and "." not in digits:
                digits += self.take().text
            elif text == "{" and "." not in digits and self.is_decimal_comma():
                self.at += 3
                digits += "."
            else:
                break
            if len(digits) > 200:  # noqa: PLR2004
                self.refuse("this number has more than 200 digits", at=start)
        if self.text == "," and self.ahead().isdigit():
            self.refuse("this comma may be a decimal comma or separate two numbers", "a decimal comma is {,}")
        if (
            self.text in ("e", "E")
            and (self.ahead().isdigit() or (self.ahead() in ("+", "-") and self.ahead(2).isdigit()))
            and not self.tokens[self.at].is_spaced
            and self.tokens[self.at].span.start == self.tokens[self.at - 1].span.end
        ):
            self.refuse(
                rf"'{digits}{self.text}{self.ahead()}' may be a power of ten or a product",
                r"write \cdot 10^{...}",
            )
        value = Fraction(digits if not digits.startswith(".") else f"0{digits}")
        return Number(value, span=self.span(start))

    def is_decimal_comma(self) -> bool:
        return self.ahead() in (",", ".") and self.ahead(2) == "}" and self.ahead(3).isdigit()

    def is_thousands(self, digits: str) -> bool:
        r"""Tell whether three digits after a space continue a number: ``10\,000``."""
        run = 0
        while self.ahead(run).isdigit() and (not run or not self.tokens[self.at + run].is_spaced):
            run += 1
        return run == 3 and len(digits.split(".", maxsplit=1)[0]) <= 9  # noqa: PLR2004

    def bracket(self) -> Value:
        start = self.at
        kind = DELIMITERS[self.take().text]
        if self.text in CLOSERS:
            self.refuse("these brackets are empty", at=start)
        value = self.sum()
        if CLOSERS.get(self.text) != kind:
            if not self.text or self.text == "}":
                self.refuse(f"this '{self.tokens[start].text}' is never closed", f"add '{kind[1]}'", start)
            self.unexpected()
        self.take()
        return value

    def fraction(self) -> Value:
        start = self.at
        self.take()
        if (derivative := self.derivative(start)) is not None:
            return derivative
        above = self.group()
        below = self.group()
        return _quotient(above, below, self.span(start), self)

    def root(self) -> Expression:
        start = self.at
        self.take()
        index = 2
        if self.text == "[":
            end = next((i for i in range(self.at, len(self.tokens)) if self.tokens[i].text == "]"), self.at)
            digits = text_of(self.tokens[self.at + 1 : end])
            if not re.fullmatch(r"[1-9]\d?", digits):
                self.refuse("the index of a root is a whole number")
            index, self.at = int(digits), end + 1
        radicand = self.group_expression()
        span = self.span(start)
        if index == 2:  # noqa: PLR2004
            return Call("sqrt", radicand, span=span)
        exponent = Quotient(Number(Fraction(1)), Number(Fraction(index)), span=span)
        return Power(radicand, exponent, span=span)

    # -- functions --

    def function(self) -> Expression | None:
        """Return a function with its argument, ``None`` if there is no function here."""
        start = self.at
        name, end = self.function_name()
        if name is None:
            return None
        self.at = end
        exponent: Expression | None = None
        if self.text == "^":
            self.take()
            exponent = self.group_expression()
            if isinstance(exponent, Negative):
                inverse = f"arc{name}" if name in ("sin", "cos", "tan") else f"the inverse of {name}"
                self.refuse(
                    f"this may be one over {name} or {inverse}", rf"write \frac{{1}}{{\{name} x}}", start
                )
        if self.text == "_":
            self.refuse("a function with an index is not read")
        argument = self.argument(name)
        span = self.span(start)
        whole = RECIPROCALS.get(name, name)
        value: Expression = Call(whole, argument, span=span)
        if exponent is not None:
            value = Power(value, exponent, span=span)
        elif self.text == "^":
            value = self.expression_of(self.powers(value, start))
        return value if whole == name else Quotient(Number(Fraction(1)), value, span=span)

    def function_name(self) -> tuple[str | None, int]:
        text = self.text
        if text in CALLS:
            return CALLS[text], self.at + 1
        if text in FONTS and self.ahead() == "{":
            end = group_end(self.tokens, self.at + 1)
            word = text_of(self.tokens[self.at + 2 : end - 1]).strip("\\")
            if word in PARTS:
                self.refuse(f"'{word}' of a function is not read")
            if word in SPOKEN and (len(word) > 2 or text == r"\operatorname"):  # noqa: PLR2004
                return SPOKEN[word], end
        if text.isascii() and text.isalpha() and len(text) == 1:
            for word in ("sinh", "cosh", "tanh", "coth", "sin", "cos", "tan", "exp"):
                letters = [self.ahead(k) for k in range(len(word))]
                if "".join(letters) == word and all(len(x) == 1 for x in letters):
                    after = self.ahead(len(word))
                    known = all(PrintedSymbol(x) in self.notation.names for x in word)
                    if not known and (after in (*DELIMITERS, "^", "{") or after in LETTERS):
                        return word, self.at + len(word)
                    if not known:
                        self.refuse(
                            f"'{word}' may be the function or a product of letters", rf"write \{word}"
                        )
        return None, self.at

    def argument(self, name: str) -> Expression:
        """Return the argument of a function: a bracket, or a product that print leaves without one."""
        at = self.at
        if self.text in DELIMITERS:
            value = self.bracket()
            if isinstance(value, Matrix):
                self.refuse("a function of a matrix is not read", at=at)
            if self.text == "^" and self.choose(at, 2):
                return self.expression_of(self.powers(value, at))
            is_plain = isinstance(value, Sum) and any(isinstance(_unsigned(t), Number) for t in value.terms)
            is_apart = self.at < len(self.tokens) and self.tokens[self.at].is_spaced
            if self.continues() and is_plain and not is_apart and name != "exp" and self.choose(at, 2):
                return self.expression_of(_product(value, self.operand(), self.span(at), self))
            return value
        if (
            self.text == "{"
            and self.ahead() in DELIMITERS
            and group_end(self.tokens, self.at) == self.end_of_bracket(self.at + 1) + 1
        ):
            return self.expression_of(self.group())
        if self.text in ("-", "+", ""):
            self.refuse(f"{name} has no argument", "write brackets")
        return self.bare_argument(name, at)

    def end_of_bracket(self, at: int) -> int:
        depth = 0
        for i in range(at, len(self.tokens)):
            depth += (self.tokens[i].text in DELIMITERS) - (self.tokens[i].text in CLOSERS)
            if not depth:
                return i + 1
        return -1

    def expression_of(self, value: Value) -> Expression:
        if isinstance(value, Matrix):
            self.refuse("a matrix cannot stand here")
        return value

    def continues(self) -> bool:
        """Tell whether a symbol, fraction or root follows that an argument might go on with."""
        text = self.text
        if ACCENTED.get(text) in DOTS:
            return False
        if text in FONTS and self.function_name()[0] is not None:
            return False
        if text == "e" and self.ahead() == "^":
            return False
        return (
            text in LETTERS
            or text in FRACTIONS
            or text in FONTS
            or text in ACCENTED
            or text == r"\sqrt"
            or (text.isascii() and text.isalpha() and len(text) == 1 and self.function_name()[0] is None)
            or text == "{"
        )

    def bare_argument(self, name: str, at: int) -> Expression:
        r"""Return an argument without brackets.

        It goes on over the symbols that follow, as in ``\sin \lambda l``. Two are one argument, unless
        the first is an angle by its letter, the second is s or a power, or a space, a fraction or a brace
        stands between them; then, and of more than two, any number of them may be.
        """
        parts: list[Expression] = []
        ends: list[int] = []
        doubtful = False
        braced = self.text == "{"
        while not parts or self.continues():
            if parts and (
                self.tokens[self.at].is_spaced or self.text in FRACTIONS or self.text == "{" or braced
            ):
                doubtful = True
            if (
                parts
                and not isinstance(_bare(parts[-1]), Name | Number)
                and not (isinstance(parts[-1], Call) and parts[-1].name == "sqrt")
            ):
                doubtful = True
            is_group = self.text == "{"
            part = self.expression_of(self.operand())
            if isinstance(part, Power) and not is_group and not parts and not self.continues():
                self.refuse(f"this may be {name} of a power or a power of {name}", "write brackets", at)
            parts.append(part)
            ends.append(self.at)
            if len(parts) > LONGEST_RUN:
                self.refuse(f"the argument of {name} has no end", "write brackets", at)
        named = [k for k, p in enumerate(parts) if names(p) and not (isinstance(p, Name) and p.name == "pi")]
        whole = len(parts)
        if len(named) > 1 or (named and doubtful and whole > 1):
            sizes = [m for m in range(whole - 1, named[0], -1) if m > named[0]]
            last = parts[-1]
            is_laplace = isinstance(_bare(last), Name) and _bare(last).name == LAPLACE  # type: ignore[attr-defined]
            first_name = _bare(parts[named[0]])
            is_angle = (
                isinstance(first_name, Name)
                and first_name.name.split("_")[0] in ANGLES
                and name in ("sin", "cos", "tan", "cot", "sec", "csc")
            )
            if doubtful or len(named) > 2 or is_laplace or is_angle or isinstance(last, Power):  # noqa: PLR2004
                readings = (whole, *sizes)
                whole = readings[self.choose(at, len(readings))]
        self.at = ends[whole - 1]
        if self.text in ("/", r"\div") and whole == len(parts) and self.choose(self.at, 2):
            self.take()
            return Quotient(
                _times(parts, self.span(at)), self.expression_of(self.operand()), span=self.span(at)
            )
        return _times(parts[:whole], self.span(at))

    # -- symbols --

    def symbol(self, *, alone: bool = False) -> Expression:
        """Return a symbol with its scripts: a name, a power of e, or a derivative in time."""
        start = self.at
        if self.text == "e" and self.ahead() == "^" and self.is_base():
            return self.exponential(start, 1)
        runs = [self.one_symbol(1)] if alone else self.cut()
        symbol, end, dots, primes = runs[self.choose(start, len(runs)) if len(runs) > 1 else 0]
        self.at = end
        value = self.named(symbol, self.span(start), start)
        if self.notation.motion:
            value = self.moving(value, dots, primes)
        else:
            self.applied(value)
        if alone:
            return value
        result = self.powers(value, start)
        assert isinstance(result, Expression)
        return result

    def upright_base(self) -> int:
        r"""Return of how many tokens the base of ``{\rm e}^{-sT}`` is made, 0 if it is no e."""
        typed = [t.text for t in self.tokens[self.at : self.at + 5]]
        if typed[:1] != ["{"] and typed[:1] and typed[0] not in FONTS:
            return 0
        end = typed.index("^") if "^" in typed else 0
        letters = [text for text in typed[:end] if text not in "{}" and text not in FONTS]
        return end if letters == ["e"] and end > 1 else 0

    def is_base(self) -> bool:
        """Tell whether the letter e is the base of exponentials here."""
        if PrintedSymbol("e") not in self.notation.names:
            return True
        end = group_end(self.tokens, self.at + 2)
        return any(
            t.text in LETTERS or (t.text.isalpha() and len(t.text) == 1)
            for t in self.tokens[self.at + 2 : end]
        )

    def exponential(self, start: int, skip: int) -> Expression:
        self.at = start + skip + 1
        argument = self.group_expression()
        return Call("exp", argument, span=self.span(start))

    def cut(self) -> list[tuple[PrintedSymbol, int, int, int]]:
        """Return the first symbol of letters side by side, in each way the names that are known allow."""
        start = self.at
        singles: list[tuple[str, int]] = []
        i = start
        while len(singles) < LONGEST_RUN and i < len(self.tokens):
            text = self.tokens[i].text
            letter = LETTERS.get(text, text if text.isascii() and text.isalpha() and len(text) == 1 else "")
            if not letter or (singles and self.tokens[i].is_spaced):
                break
            singles.append((letter, i))
            i += 1
        one = self.one_symbol(1)
        if len(singles) < 2:  # noqa: PLR2004
            return [one]
        known = self.notation.names
        options = {}
        for n in range(2, len(singles) + 1):
            found = self.one_symbol(n)
            if found[0] in known:
                options[n] = found
        if not options:
            return [one]
        ways = [
            n
            for n in (*sorted(options, reverse=True), *([1] if self.is_known(one[0]) else []))
            if self.can_go_on(n, singles)
        ]
        if not ways:
            ways = [max(options)]
        return [options.get(n, one) for n in ways]

    def is_known(self, symbol: PrintedSymbol) -> bool:
        return symbol in self.notation.names or symbol.base in ("pi", *IMAGINARY)

    def can_go_on(self, count: int, singles: Sequence[tuple[str, int]]) -> bool:
        """Tell whether letters after the first so many are names that are known."""
        ends = {count}
        for begin in range(count, len(singles)):
            if begin not in ends:
                continue
            at, self.at = self.at, singles[begin][1]
            for n in range(1, len(singles) - begin + 1):
                if self.is_known(self.one_symbol(n)[0]):
                    ends.add(begin + n)
            self.at = at
        return len(singles) in ends

    def one_symbol(self, count: int) -> tuple[PrintedSymbol, int, int, int]:
        """Return the symbol of the next letters with its scripts, its end, dots and primes; nothing is taken.

        Dots and primes belong to the symbol where they are no derivatives.
        """
        at, is_moving = self.at, bool(self.notation.motion)
        base, marks, end, inner = self.base(count)
        dots = sum(DOTS.get(m, 0) for m in marks) if is_moving else 0
        words = [m for m in marks if not (is_moving and m in DOTS)]
        self.at = end
        index, primes, label, position = self.scripts(PrintedSymbol(base, "_".join(words), inner))
        if primes and not is_moving:
            words.append("p" * primes)
        symbol = PrintedSymbol(base, "_".join(words), inner + index + (f"^{label}" if label else ""))
        self.at = at
        return symbol, position, dots, primes

    def base(self, count: int) -> tuple[str, list[str], int, str]:
        """Return letters, accents, where they end, and an index that stands under an accent."""
        self.enter()
        found = self.unnested_base(count)
        self.depth -= 1
        return found

    def unnested_base(self, count: int) -> tuple[str, list[str], int, str]:
        text = self.text
        if text in ACCENTED:
            self.take()
            start = self.at
            end = group_end(self.tokens, self.at)
            is_group = self.text == "{"
            self.at += is_group
            base, marks, at, inner = self.base(1)
            if not is_group:
                return base, [*marks, ACCENTED[text]], end, inner
            self.at = at
            index, primes, label, at = self.scripts(PrintedSymbol(base, "", inner))
            if at != end - 1:
                while at < end - 1:  # \overline{EI}: letters that are one name
                    self.at = at
                    more, _, at, _ = self.base(1)
                    base += more
                if at != end - 1:
                    self.refuse(f"{text} over more than a symbol is not read", at=start)
            extra = ["p" * primes] if primes else []
            return base, [*marks, ACCENTED[text], *extra], end, inner + index + label
        if text in FONTS:
            start = self.at
            self.take()
            style = CALLIGRAPHIC.get(text, "")
            if self.text != "{":
                if text in SWITCHES:
                    return self.base(1)
                base, marks, at, inner = self.base(1)
                return base + style, marks, at, inner
            end = group_end(self.tokens, self.at)
            content = self.tokens[self.at + 1 : end - 1]
            if content and all(t.text.isalnum() or t.text in LETTERS or t.text == "-" for t in content):
                word = "".join(LETTERS.get(t.text, t.text) for t in content if t.text != "-")
                return word + style, [], end, ""
            self.at += 1
            base, marks, at, inner = self.base(1)
            self.at = at
            index, primes, label, at = self.scripts(PrintedSymbol(base, "", inner))
            if at != end - 1:
                self.refuse(f"{text} with more than a symbol is not read", at=start)
            return base + style, [*marks, *(["p" * primes] if primes else [])], end, inner + index + label
        if text == "{":
            end = group_end(self.tokens, self.at)
            self.at += 1
            base, marks, at, inner = self.base(1)
            if at != end - 1:
                self.refuse("a group is no symbol here")
            return base, marks, end, inner
        letters = ""
        for k in range(count):
            word = self.ahead(k)
            letter = LETTERS.get(word, word if word.isascii() and word.isalpha() and len(word) == 1 else "")
            if not letter:
                self.refuse(f"'{word[:40]}' is no symbol" if word else "a symbol is missing")
            letters += letter
        return letters, [], self.at + count, ""

    def scripts(self, symbol: PrintedSymbol) -> tuple[str, int, str, int]:
        """Return index, primes and a superscript that is a label, and where they end; a power is left."""
        index, label, primes, at = "", "", 0, self.at
        seen: set[str] = set()
        while at < len(self.tokens):
            text = self.tokens[at].text
            if text in PRIMES:
                primes += PRIMES[text]
                at += 1
            elif text == "_":
                if "_" in seen:
                    self.refuse("a second subscript follows", at=at)
                seen.add("_")
                end = group_end(self.tokens, at + 1)
                if self.tokens[at + 1 : at + 2] and self.tokens[at + 1].text in FONTS | set(ACCENTED):
                    end = group_end(self.tokens, at + 2)
                index = self.words(self.tokens[at + 1 : end], at)
                at = end
            elif text == "^":
                end = group_end(self.tokens, at + 1)
                if self.tokens[at + 1 : at + 2] and self.tokens[at + 1].text in FONTS:
                    end = group_end(self.tokens, at + 2)
                inside = self.tokens[at + 1 : end]
                found = self.superscript(inside, symbol, index, primes)
                if found is None:
                    if "_" in [t.text for t in self.tokens[end : end + 1]]:  # a power before the index: x^2_1
                        stop = group_end(self.tokens, end + 1)
                        power, rest = self.tokens[at:end], self.tokens[end:stop]
                        self.tokens[at:stop] = [*rest, *power]
                        continue
                    if self.tokens[end : end + 1] and self.tokens[end].text in PRIMES:
                        self.refuse("primes follow a power", "write braces: {x'}^2", end)
                    break
                if "^" in seen:
                    self.refuse("a second superscript follows", at=at)
                seen.add("^")
                if isinstance(found, int):
                    primes += found
                else:
                    label += found
                at = end
            else:
                break
        return index, primes, label, at

    def superscript(
        self, inside: Sequence[LatexToken], symbol: PrintedSymbol, index: str, primes: int
    ) -> str | int | None:
        """Return a label, or a number of primes, ``None`` for a power."""
        content = [t for t in inside if t.text not in ("{", "}")]
        texts = [t.text for t in content]
        if texts and all(t in PRIMES for t in texts):
            return sum(PRIMES[t] for t in texts)
        if texts in (["*"], [r"\ast"], [r"\star"], [r"\dagger"], ["+"], ["-"], [r"\circ"], [r"\infty"]):
            return {"*": "star", r"\ast": "star", "+": "plus", "-": "minus"}.get(
                texts[0], texts[0].lstrip("\\")
            )
        if texts and texts[0] in FONTS and not any(t in (*TIMES, "+", "-", "/") for t in texts):
            word = self.words(inside, self.at)
            if not word.isdigit() and word != "e":
                return word
        if len(texts) > 2 and texts[0] == "(" and texts[-1] == ")":  # noqa: PLR2004
            word = "".join(texts[1:-1])
            if word.isdigit():
                return int(word) if self.notation.motion else f"d{word}"
            if word.isalnum():
                return word
        word = "".join(LETTERS.get(t, t) for t in texts)
        scripts = (symbol.script + index + word, f"{symbol.script}{index}^{word}")
        if word.isalpha() and any(symbol._replace(script=x) in self.notation.names for x in scripts):
            return word
        return None

    def words(self, group: Sequence[LatexToken], at: int) -> str:
        """Return the letters and digits of a subscript, an index of a product replaced by its number."""
        out = ""
        is_upright = any(t.text in FONTS for t in group)
        texts = [t.text for t in group if t.text not in ("{", "}")]
        joined = "".join(texts)
        if match := re.fullmatch(r"([a-zA-Z])([+-])(\d+)", joined):
            if match[1] in self.bound:
                return str(self.bound[match[1]] + int(match[2] + match[3]))
        for token in group:
            text = token.text
            if text in self.bound and not is_upright and self.is_index(texts, text):
                out += str(self.bound[text])
            elif text in LETTERS:
                out += LETTERS[text]
            elif text.isascii() and text.isalnum():
                out += text
            elif text in PRIMES:
                out += "p"
            elif text in ("*", r"\ast", r"\star"):
                out += "star"
            elif text == "+":
                out += "plus"
            elif text == r"\infty":
                out += "inf"
            elif text in ("-", r"\perp", r"\parallel", r"\circ", r"\max", r"\min"):
                out += "" if text == "-" else text.lstrip("\\")
            elif (
                text in FONTS
                or text in ACCENTED
                or text in "{}_^,.()/:;|~"
                or text in SPACES | {r"\cdot", r"\left", r"\right", r"\_"}
            ):
                out += ACCENTED.get(text, "")
            else:
                raise refusal(token.span, f"'{text[:40]}' in an index is not read")
        if not out:
            self.refuse("an index is empty", at=at)
        return out

    @staticmethod
    def is_index(texts: Sequence[str], letter: str) -> bool:
        """Tell whether a letter of a subscript is the index of a product: alone, or at its end."""
        letters = [t for t in texts if t != ","]
        return len(letters) <= 2 or letters[-1] == letter or letters[0] == letter  # noqa: PLR2004

    def named(self, symbol: PrintedSymbol, span: Span, start: int) -> Expression:
        """Return what a symbol is: a name of the model, a number of an index, or its own name."""
        known = self.notation.names.get(symbol)
        if known is None and "^" in symbol.script[1:]:  # G_{rb}^v is G_rb_v
            known = self.notation.names.get(symbol._replace(script=symbol.script.replace("^", "")))
        if known is None and symbol.base.startswith("var"):
            known = self.notation.names.get(symbol._replace(base=symbol.base.removeprefix("var")))
        if known is not None:
            self.remember(known, start)
            return Name(known, span=span)
        if not symbol.marks and not symbol.script and symbol.base in self.bound:
            return number(self.bound[symbol.base])
        if symbol == PrintedSymbol("partial") or symbol == PrintedSymbol("nabla"):
            self.refuse("a derivative is read in equations of motion only", at=start)
        name = symbol.name
        self.remember(name, start)
        if len(name) > 64:  # noqa: PLR2004
            self.refuse("this symbol has more than 64 letters", at=start)
        return Name(name, span=span)

    def remember(self, name: str, start: int) -> None:
        """Refuse a second symbol that is typed otherwise and would have the same name."""
        kept = [
            t.text
            for i, t in enumerate(self.tokens[start : self.at])
            if t.text not in "{}_^" and (t.text not in FONTS or not i)
        ]
        if self.notation.motion:  # derivatives are no other symbols
            kept = [text for text in kept if ACCENTED.get(text) not in DOTS and text not in PRIMES]
        typed = " ".join(sorted(kept))
        if not self.bound and self.typed.setdefault(name, typed) != typed:
            message = f"two symbols would both be '{name}' here: {self.typed[name]} and {typed}"
            self.refuse(message, "name one of them in [notation]", start)

    def moving(self, value: Expression, dots: int, primes: int) -> Expression:
        """Return a symbol of an equation of motion with its derivatives, and where along x it is taken."""
        if not isinstance(value, Name):
            return value
        if self.notation.motion == "time":
            self.applied(value)
            return Derivative(value.name, dots + primes, span=value.span) if dots + primes else value
        placed = self.placed(Derivative(value.name, primes, span=value.span) if primes else value)
        return _product(_differentiation(dots, value.span), placed, value.span, self) if dots else placed  # type: ignore[return-value, arg-type]

    def placed(self, value: Expression) -> Expression:
        """Return a field, or its derivative along x, at the point that follows it, if one does."""
        name, order = (value.name, value.order) if isinstance(value, Derivative) else (value.name, 0)  # type: ignore[attr-defined]
        inner: Sequence[LatexToken] = ()
        if self.text == "(" and (end := self.end_of_bracket(self.at)) > 0:
            items = "".join(t.text for t in self.tokens[self.at + 1 : end - 1]).split(",")
            kept = [item for item in items if item not in ("t", "s")]
            is_point = len(kept) < len(items) or order or re.fullmatch(r"0|[lLx]|\\ell", kept[0])
            if not is_point:
                return value
            count = len(self.tokens[self.at + 1 : end - 1]) - (2 if len(items) > 1 else 0)
            first = self.at + 1 if not items or items[0] in kept else self.at + 3
            inner = self.tokens[first : first + count] if kept else ()
            self.at = end
        elif self.text in ("|", r"\vert", r"\Big|") and self.ahead() == "_":
            end = group_end(self.tokens, self.at + 2)
            inner = [t for t in self.tokens[self.at + 2 : end] if t.text not in "{}"]
            if text_of(inner[:2]) != "x=":
                self.unexpected()
            inner, self.at = inner[2:], end
        if not inner or text_of(inner) == "x":
            return value
        point = self.read_inner(inner)
        return Call(name, self.expression_of(point), order, span=value.span)

    def ratio_applied(self, value: Expression) -> None:
        r"""Skip the argument of a quotient or bracket of functions, as in ``\frac{X}{F}(s)``."""
        end = self.end_of_bracket(self.at) if self.text == "(" else -1
        typed = (
            text_of(t for t in self.tokens[self.at + 1 : end - 1] if t.text not in FONTS) if end > 0 else ""
        )
        if typed not in ARGUMENTS or not names(value):
            return
        constants = set(self.notation.names.values()) - self.notation.signals
        is_sure = not any(
            isinstance(n, Sum) or (isinstance(n, Name) and n.name in constants) for n in nodes(value)
        )
        if is_sure or not self.choose(self.at, 2):
            self.at = end

    def applied(self, value: Expression) -> None:
        """Skip the argument of a function of s or t; refuse what could be a factor as well."""
        end = self.end_of_bracket(self.at) if self.text in ("(", "[") else -1
        name = value.name if isinstance(value, Name) else ""
        if end < 0 or name in ("", "pi", LAPLACE):
            return
        inside = self.tokens[self.at + 1 : end - 1]
        typed = "".join(t.text for t in inside if t.text not in FONTS and t.text not in "{}")
        names_known = self.notation.names
        is_constant = name in names_known.values() and name not in self.notation.signals
        if typed in ARGUMENTS:
            is_product = is_constant and not typed.endswith("t")
            is_product |= (
                typed in ("p", "z", "D", r"\omega")
                and PrintedSymbol(LETTERS.get(typed, typed)) in names_known
            )
            if not (is_product and self.choose(self.at, 2)):
                self.at = end
        elif typed.startswith(("t+", "t-")) and PrintedSymbol("t") not in names_known:
            self.refuse(f"a function of time, {name}({typed[:40]}), is not read")
        elif any(t.text == "," and not depth for t, depth in with_depth(inside)):
            self.refuse(f"a function of several variables, {name}({typed[:40]}), is not read")
        elif is_constant:
            return
        elif re.fullmatch(r"-?(?:[\d./^s]|\\omega|j|i|p)+", typed) and not typed.isdigit():
            self.refuse(f"'{name}({typed[:40]})' may be a product or a value of a function")
        elif re.fullmatch(r"[a-zA-Z]|\\[A-Za-z]+|\d+(\.\d+)?|[a-zA-Z]_\w", typed) and self.choose(self.at, 2):
            self.at = end

    # -- matrices, products, derivatives --

    def matrix(self) -> Value:
        """Return a matrix, or the determinant of one between bars or after ``det``."""
        start, before = self.at, self.text
        is_determinant = before != r"\begin"
        if is_determinant:
            self.take()
        if before == r"\det" and self.text in DELIMITERS:
            return self.determinant(self.bracket(), start)
        if self.text != r"\begin":
            self.at = start
            self.unexpected()
        name, end = environment(self.tokens, self.at)
        if name not in MATRICES:
            self.refuse(f"the environment '{name[:40]}' is not read inside a formula")
        self.at = skip_arguments(self.tokens, end) if name == "array" else end
        found = Matrix(self.cells(start), self.span(start))
        if is_determinant and before != r"\det":
            if self.text not in ("|", r"\vert", r"\rvert"):
                self.unexpected()
            self.take()
        return self.determinant(found, start) if is_determinant or name == "vmatrix" else found

    def cells(self, start: int) -> tuple[tuple[Expression, ...], ...]:
        """Return the entries of a matrix up to its end."""
        rows: list[list[Expression]] = [[]]
        while self.text != r"\end":
            if not self.text:
                self.refuse("this matrix has no end", at=start)
            if self.text in (r"\\", r"\cr"):
                self.take()
                rows.append([])
            elif self.text == "&":
                self.take()
            else:
                rows[-1].append(self.expression_of(self.sum()))
                if self.text not in ("&", r"\\", r"\cr", r"\end"):
                    self.unexpected()
            if max(len(rows), len(rows[-1])) > MOST_ROWS:
                self.refuse(f"this matrix is larger than {MOST_ROWS} by {MOST_ROWS}", at=start)
        _, self.at = environment(self.tokens, self.at)
        kept = tuple(tuple(row) for row in rows if row)
        if len({len(row) for row in kept}) != 1:
            self.refuse("the rows of this matrix differ in length", at=start)
        return kept

    def determinant(self, value: Value, start: int) -> Expression:
        if not isinstance(value, Matrix) or len(value.rows) != len(value.rows[0]):
            self.refuse("a determinant needs a square matrix", at=start)
        if len(value.rows) > LARGEST_MATRIX:
            self.refuse(f"a determinant of more than {LARGEST_MATRIX} rows is not expanded", at=start)
        if is_longer([e for row in value.rows for e in row], MOST_PARTS // 24):
            self.refuse("this determinant is too long to be written out", at=start)
        return replace(_determinant(value.rows), span=self.span(start))

    def written_out(self) -> Value:
        """Return a product or sum over an index whose ends are numbers, written out."""
        start = self.at
        is_sum = self.take().text == r"\sum"
        what = "sum" if is_sum else "product"
        scripts: dict[str, list[LatexToken]] = {}
        while self.text in ("_", "^"):
            kind = self.take().text
            end = group_end(self.tokens, self.at)
            scripts[kind] = [t for t in self.tokens[self.at : end] if t.text not in "{}"]
            self.at = end
        lower, upper = text_of(scripts.get("_", [])), text_of(scripts.get("^", []))
        match = re.fullmatch(r"([a-zA-Z])=(\d{1,3})", lower)
        if match is None or not re.fullmatch(r"\d{1,3}", upper):
            self.refuse(f"a {what} whose ends are not numbers is not read", "write out every term", start)
        first, last = int(match[2]), int(upper)
        if last < first:
            self.refuse(f"a {what} of no terms is not read", at=start)
        body, outer = self.at, self.bound.get(match[1])
        values: list[Value] = []
        for k in range(first, last + 1):
            self.written += 1
            if self.written > MOST_TERMS:
                self.refuse(f"products and sums of more than {MOST_TERMS} terms are not read", at=start)
            self.at = body
            self.bound[match[1]] = k
            values.append(self.product())
        if outer is None:
            del self.bound[match[1]]
        else:
            self.bound[match[1]] = outer
        if is_sum:
            return _sum(values, self.span(start), self)
        value = values[0]
        for other in values[1:]:
            value = _product(value, other, self.span(start), self)
        return value

    def derivative(self, start: int) -> Value | None:
        r"""Return ``\frac{d^2 x}{dt^2}`` as x'', ``None`` if a fraction is no derivative."""
        end = group_end(self.tokens, self.at)
        stop = group_end(self.tokens, end)
        shown = [t for t in self.tokens[self.at : end] if t.text not in FONTS]
        below = text_of(t for t in self.tokens[end:stop] if t.text not in FONTS and t.text not in "{}")
        match = re.fullmatch(r"(d|\\partial)([a-z])(?:\^(\d))?", below)
        above = shown[1:-1] if shown and shown[0].text == "{" else shown
        if [x.text for x in above[:3:2]] == ["{", "}"] and above[1].text in ("d", r"\partial"):
            above = [above[1], *above[3:]]  # the braces of an upright d
        head = re.match(r"(d|\\partial)(?:\^(\d|\{\d\}))?", text_of(above))
        if match is None or head is None or head[1] != match[1]:
            return None
        if (head[2] or "1").strip("{}") != (match[3] or "1") or (
            match[1] == "d" and PrintedSymbol("d") in self.notation.names
        ):
            return None
        motion, order = self.notation.motion, int(match[3] or 1)
        if not motion or match[2] not in ("t", "x") or (motion == "time" and match[2] == "x"):
            self.refuse("a derivative is not read here", "write it with s, or as x'", start)
        self.at = stop
        inner = above[len(tokens_of(Text.alone("", head[0]))) :]
        operand = self.read_inner(inner) if inner else self.operand()
        span = self.span(start)
        if match[2] == "t" and not (motion == "time" and isinstance(operand, Name)):
            return _product(_differentiation(order, span), operand, span, self)
        value = self.expression_of(operand)
        if not isinstance(value, Name):
            return Differentiated(value, order, span=span)
        derived = Derivative(value.name, order, span=span)
        if motion == "time":
            self.applied(value)
            return derived
        return self.placed(derived)


def _differentiation(order: int, span: Span | None) -> Expression:
    """Return a power of s."""
    laplace = Name(LAPLACE, span=span)
    return Power(laplace, Number(Fraction(order), span=span), span=span) if order > 1 else laplace


# --- trees in the shape the text reader gives them ---


def _bare(node: Expression) -> Expression:
    return node.base if isinstance(node, Power) else node


def _unsigned(node: Expression) -> Expression:
    return node.operand if isinstance(node, Negative) else node


def _times(parts: Sequence[Expression], span: Span | None = None) -> Expression:
    flat = [f for p in parts for f in (p.factors if isinstance(p, Product) else (p,))]
    return Product(tuple(flat), span=span) if len(flat) > 1 else flat[0]


def _map(value: Value, change: Callable[[Expression], Expression]) -> Value:
    if isinstance(value, Expression):
        return change(value)
    return replace(value, rows=tuple(tuple(map(change, row)) for row in value.rows))


def _negative(value: Value) -> Value:
    return _map(value, lambda x: Negative(x, span=x.span))


def _sum(terms: Sequence[Value], span: Span, reader: _LatexReader) -> Value:
    if len(terms) == 1:
        return terms[0]
    matrices = [t for t in terms if isinstance(t, Matrix)]
    if matrices:
        sizes = {(len(m.rows), len(m.rows[0])) for m in matrices}
        if len(matrices) != len(terms) or len(sizes) > 1:
            reader.refuse("matrices of different sizes cannot be added")
        cells = [
            [_sum([m.rows[i][k] for m in matrices], span, reader) for k in range(len(matrices[0].rows[0]))]
            for i in range(len(matrices[0].rows))
        ]
        return Matrix(tuple(tuple(row) for row in cells), span)  # type: ignore[arg-type]
    flat = [t for x in terms if isinstance(x, Expression) for t in (x.terms if isinstance(x, Sum) else (x,))]
    return Sum(tuple(flat), span=span)


def _product(a: Value, b: Value, span: Span, reader: _LatexReader) -> Value:
    if isinstance(a, Matrix) and isinstance(b, Matrix):
        if len(a.rows[0]) != len(b.rows):
            reader.refuse("matrices of these sizes cannot be multiplied")
        columns = list(zip(*b.rows, strict=True))
        rows = [
            tuple(sum_of(product_of(pair) for pair in zip(row, column, strict=True)) for column in columns)
            for row in a.rows
        ]
        if is_longer([e for row in rows for e in row], MOST_PARTS):
            reader.refuse("this product of matrices is too long to be written out")
        whole = Matrix(tuple(rows), span)
        return whole.rows[0][0] if len(rows) == 1 and len(rows[0]) == 1 else whole
    if isinstance(a, Matrix) or isinstance(b, Matrix):
        matrix, factor = (a, b) if isinstance(a, Matrix) else (b, a)
        assert isinstance(matrix, Matrix) and isinstance(factor, Expression)
        return _map(matrix, lambda x: _times([factor, x], span))
    return _times([a, b], span)


def _quotient(a: Value, b: Value, span: Span, reader: _LatexReader) -> Value:
    if isinstance(b, Matrix):
        reader.refuse("a quotient by a matrix is not read")
    if is_number(b, 0):
        reader.refuse("a formula divides by zero")
    return _map(a, lambda x: Quotient(x, b, span=span))


def _power(base: Value, exponent: Expression, span: Span, reader: _LatexReader) -> Expression:
    if isinstance(base, Matrix):
        reader.refuse("a power of a matrix is not read")
    return Power(base, exponent, span=span)


def _determinant(rows: Sequence[Sequence[Expression]]) -> Expression:
    if len(rows) == 1:
        return rows[0][0]
    terms: list[Expression] = []
    for k, entry in enumerate(rows[0]):
        if is_number(entry, 0):
            continue
        minor = _determinant([[*row[:k], *row[k + 1 :]] for row in rows[1:]])
        term = _times([entry, minor])
        terms.append(Negative(term) if k % 2 else term)
    return sum_of(terms)


def _inverse(value: Matrix, reader: _LatexReader) -> Matrix:
    rows, size = value.rows, len(value.rows)
    if size != len(rows[0]) or size > LARGEST_MATRIX:
        reader.refuse("the inverse of this matrix is not read")
    if is_longer([e for row in rows for e in row], MOST_PARTS // 24):
        reader.refuse("the inverse of this matrix is too long to be written out")
    whole = _determinant(rows)
    if is_number(whole, 0):
        reader.refuse("this matrix has no inverse")

    def entry(i: int, k: int) -> Expression:
        minor = [[*row[:i], *row[i + 1 :]] for j, row in enumerate(rows) if j != k]
        inner = _determinant(minor) if minor else Number(Fraction(1))
        return Quotient(Negative(inner) if (i + k) % 2 else inner, whole, span=value.span)

    return Matrix(tuple(tuple(entry(i, k) for k in range(size)) for i in range(size)), value.span)


# --- the Laplace variable ---


def settled(value: Value, notation: PaperNotation, span: Span) -> Value:
    r"""Return a tree in s, whatever the paper calls it: ``j\omega`` and powers of ``\omega`` become s."""
    if isinstance(value, Matrix):
        rows = (tuple(_in_s(x, notation, span) for x in row) for row in value.rows)
        return replace(value, rows=tuple(rows))
    return _in_s(value, notation, span)


def _in_s(expression: Expression, notation: PaperNotation, span: Span) -> Expression:
    known = set(notation.names.values())
    used = {n.name for n in names(expression) if isinstance(n, Name)}
    if notation.motion:
        return expression
    units = [u for u in IMAGINARY if u in used and u not in known]
    frequency = next((w for w in ("omega", "Omega") if w in used and w not in known), None)
    if not units:
        return expression
    if frequency is not None and LAPLACE in used:
        raise refusal(
            span, f"s and {units[0]}*{frequency} stand side by side", "name one of them in [notation]"
        )
    if len(units) > 1:
        raise refusal(span, "both i and j look like the imaginary unit", "name one of them in [notation]")
    if frequency is None:
        where = next(n.span for n in nodes(expression) if isinstance(n, Name) and n.name == units[0])
        raise refusal(
            where or span, f"'{units[0]}' looks like the imaginary unit, without a frequency beside it"
        )
    turned = _turned(expression, units[0], frequency)
    if turned is None:
        where = next(n.span for n in nodes(expression) if isinstance(n, Name) and n.name == units[0])
        raise refusal(
            where or span, f"'{units[0]}' does not vanish when {units[0]}*omega is s", "write it with s"
        )
    result, power = turned
    if power:
        raise refusal(span, f"the imaginary unit remains when {units[0]}*omega is s", "write it with s")
    return result


def _turned(node: Expression, unit: str, frequency: str) -> tuple[Expression, int] | None:
    """Return an expression with ``frequency = s/unit``, and the turns of the unit in front, 0 or 1."""

    def times(factor: Expression, turns: int) -> tuple[Expression, int]:
        turns %= 4
        return (negative(factor), turns - 2) if turns > 1 else (factor, turns)

    match node:
        case Name(name):
            if name == unit:
                return Number(Fraction(1), span=node.span), 1
            return times(Name(LAPLACE, span=node.span), 3) if name == frequency else (node, 0)
        case Negative(operand):
            inner = _turned(operand, unit, frequency)
            return None if inner is None else (negative(inner[0]), inner[1])
        case Sum(terms):
            parts = [_turned(t, unit, frequency) for t in terms]
            if None in parts or len({p[1] for p in parts if p is not None}) > 1:
                return None
            whole = [p for p in parts if p is not None]
            return Sum(tuple(p[0] for p in whole), span=node.span), whole[0][1]
        case Product(factors):
            parts = [_turned(f, unit, frequency) for f in factors]
            if None in parts:
                return None
            whole = [p for p in parts if p is not None]
            turns = sum(p[1] for p in whole)
            kept = [p[0] for p in whole if not is_number(p[0], 1)] or [Number(Fraction(1))]
            signs = sum(isinstance(k, Negative) for k in kept)
            product = _times([_unsigned(k) for k in kept], node.span)
            return times(negative(product) if signs % 2 else product, turns)
        case Quotient(above, below):
            pair = _turned(above, unit, frequency), _turned(below, unit, frequency)
            if pair[0] is None or pair[1] is None:
                return None
            return times(Quotient(pair[0][0], pair[1][0], span=node.span), pair[0][1] - pair[1][1])
        case Power(base, exponent):
            inner = _turned(base, unit, frequency)
            size = _rational(exponent)
            if inner is None or size is None:
                return inner if inner is not None and inner[0] == base and not inner[1] else None
            if size.denominator != 1 or is_number(inner[0], 0):
                return None if inner[1] else (Power(inner[0], exponent, span=node.span), 0)
            return times(power(inner[0], exponent), inner[1] * int(size))
        case Call(name, argument):
            inner = _turned(argument, unit, frequency)
            if inner is None or inner[1]:
                return None
            return Call(name, inner[0], span=node.span), 0
    return node, 0


def _rational(exponent: Expression) -> Fraction | None:
    """Return the value of an exponent such as -1/2, ``None`` if it has names or is no quotient."""
    match exponent:
        case Number(value):
            return value
        case Negative(operand):
            inner = _rational(operand)
            return None if inner is None else -inner
        case Quotient(Number(above), Number(below)):
            return above / below if below else None
    return None
