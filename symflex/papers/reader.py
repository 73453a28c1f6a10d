r"""Read LaTeX by recursive descent: sums, products, fractions, functions, matrices, derivatives.

Input: tokens, names, and which reading to take where print leaves two. Output: a tree or a matrix, and the
places with further readings.

    \frac{2ml^2s^2}{\cosh^2\lambda l}      2*m*l^2*s^2/cosh(lambda*l)^2

What is not understood is refused at its place.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Final, NoReturn

from symflex.errors import Span, Text
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
    is_longer,
    names,
    nodes,
)
from symflex.papers.matrices import (
    LARGEST_MATRIX,
    MOST_PARTS,
    Matrix,
    Value,
    determinant_of,
    flat_product,
    inverse_of,
    negated,
    power_of_value,
    product_of_values,
    quotient_of_values,
    sum_of_values,
    unsigned,
)
from symflex.papers.source import (
    BRACED,
    CLOSERS,
    DELIMITERS,
    FONTS,
    MATRICES,
    TIMES,
    LatexToken,
    environment,
    group_end,
    skip_arguments,
    text_of,
    tokens_of,
    with_depth,
)
from symflex.papers.symbols import (
    ACCENTED,
    DOTS,
    IMAGINARY,
    LAPLACE,
    LETTERS,
    LONGEST_RUN,
    PRIMES,
    PaperNotation,
    PrintedSymbol,
    SymbolReader,
)
from symflex.quantities import unit_named

MOST_TERMS: Final = 64  # of products and sums that are written out
MOST_ROWS: Final = 12
FRACTIONS: Final = frozenset(rf"\{name}" for name in "frac dfrac tfrac cfrac nicefrac sfrac".split())
CALLS: Final = {
    **{rf"\{f}": f for f in (*FUNCTIONS, *RECIPROCALS) if f not in ("sqrt", "log", "atan")},
    **{r"\ln": "log", r"\arctan": "atan", r"\tg": "tan", r"\ctg": "cot", r"\sh": "sinh", r"\ch": "cosh"},
}
UNREAD: Final = {  # what begins no formula that could be judged, and what to do
    r"\infty": ("infinity is no number here", None),
    **dict.fromkeys((r"\lim", r"\int", r"\oint"), ("a limit or an integral is not read", None)),
    r"\lg": (r"\lg may be the decimal or the binary logarithm", r"write \log_{10} or \log_2"),
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
        r"\Omega",
        r"j\Omega",
        r"i\Omega",
    )
)
PARTS: Final = frozenset("Re Im arg sgn sign min max det diag rank tr span".split())
SPOKEN: Final = {f.lstrip("\\"): g for f, g in CALLS.items()}  # functions by their names, as \mathrm{sinh}
ELLIPSES: Final = frozenset(rf"\{s}" for s in "ldots cdots dots dotsb dotsc dotsm dotsi vdots ddots".split())
ANGLES: Final = frozenset("theta vartheta phi varphi psi alpha gamma delta".split())  # what is an angle alone
ALONE: Final = frozenset(("", "+", "=", "&", "{", r"\\", r"\over", ",", *DELIMITERS))
"""After these a group stands by itself."""
LONGEST_BRACE: Final = max(map(len, BRACED)) + 2


class LatexReader(SymbolReader):
    """Reads one list of tokens once. ``choices`` says where to take another reading than the first."""

    def __init__(
        self,
        tokens: Sequence[LatexToken],
        notation: PaperNotation,
        choices: Mapping[int, int] | None = None,
        bound: Mapping[str, int] | None = None,
    ) -> None:
        super().__init__(tokens, notation, bound)
        self.choices = choices or {}
        self.written = 0
        self.open: dict[int, int] = {}  # where there are how many readings
        self.built: dict[int, Expression] = {}  # what was made of them
        self.logarithm: int | None = None  # where the first one stands that does not say its base
        self.arguments: dict[int, str] = {}  # where (s) follows a constant, and which
        self.bare: set[str] = set()  # constants that it does not follow

    def choose(self, at: int, count: int) -> int:
        """Return which reading to take at a token that has so many."""
        self.open[at] = max(count, self.open.get(at, 0))
        return self.choices.get(at, 0)

    def everything(self) -> Value:
        """Return the value that all tokens are."""
        value = self.sum()
        if self.at < len(self.tokens):
            self.unexpected()
        # All of G(s)H(s)/(1 + G(s)H(s)) are functions; alone, b(s) in ms^2 + b(s) + k may be a product.
        if len(self.arguments) > 1 and self.bare.isdisjoint(self.arguments.values()):
            for at in self.arguments:
                self.open.pop(at, None)
        return value

    def unexpected(self) -> NoReturn:
        """Refuse what stands here."""
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
        if text and ord(text[0]) < 32:  # noqa: PLR2004 (a control character)
            self.refuse("a control character is not read")
        self.refuse(f"'{text[:40]}' is not read here")

    def read_inner(self, tokens: Sequence[LatexToken]) -> Value:
        """Return what a part of the formula is that is read by itself."""
        reader = LatexReader(tokens, self.notation, bound=self.bound)
        reader.depth = self.depth + 1
        return reader.everything()

    def sum(self) -> Value:
        """Return a sum, up to what is no term."""
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
            terms.append(negated(term) if sign == "-" else term)
            if self.text in (r"\over", r"\atop"):
                break
        value = sum_of_values(terms, self.span(start), self.refuse)
        if self.text == r"\over":
            self.take()
            value = quotient_of_values(value, self.sum(), self.span(start), self.refuse)
        self.depth -= 1
        return value

    def product(self) -> Value:
        """Return a product or quotient, up to what is no factor."""
        start = self.at
        opened = set(self.open)
        value = self.operand()
        slash: int | None = None  # where the last divisor began that a factor might belong to
        while True:
            text = self.text
            if text in TIMES:
                self.take()
                slash = None
                value = product_of_values(value, self.signed_operand(), self.span(start), self.refuse)
            elif text in ("/", r"\div", r"\slash"):
                sign_at = self.at
                self.take()
                divisor = self.operand()
                if slash is not None and self.choose(sign_at, 2):
                    self.refuse("a/b/c is read from the left")
                if self.starts() and self.choose(self.at, 2):
                    while self.starts():
                        divisor = product_of_values(divisor, self.operand(), self.span(start), self.refuse)
                if self.text in ("/", r"\div") and self.choose(self.at, 2):  # a/(b/c)
                    self.take()
                    divisor = quotient_of_values(divisor, self.operand(), self.span(start), self.refuse)
                value = quotient_of_values(value, divisor, self.span(start), self.refuse)
                slash = None
            elif self.starts():
                is_unit = self.tokens[self.at - 1].text in IMAGINARY and text.isdigit()  # j2\beta l
                if not is_unit and (text.isdigit() or (text == "." and self.ahead().isdigit())):
                    before = self.tokens[self.at - 1].text
                    message = f"the number after '{before}' could be a factor, an index or a power"
                    self.refuse(message, "write it in front, as x_2 or as x^2")
                if text in FONTS:
                    is_bare = isinstance(value, Expression) and not names(value)
                    is_apart = self.tokens[self.at].is_spaced or text in (r"\text", r"\textrm", r"\mbox")
                    if (is_bare or is_apart) and self.is_unit(any_name=is_bare):
                        self.refuse("what follows this may be a unit or a factor")
                value = product_of_values(value, self.operand(), self.span(start), self.refuse)
            else:
                break
        if isinstance(value, Expression):
            self.built.update(dict.fromkeys(set(self.open) - opened, value))
        return value

    def is_unit(self, *, any_name: bool) -> bool:
        """Tell whether upright letters are a unit: any behind a number or at the end, else only seconds."""
        end = group_end(self.tokens, self.at + 1)
        word = text_of(t for t in self.tokens[self.at + 1 : end] if t.text not in "{}")
        is_last = self.tokens[self.at].is_spaced and end == len(self.tokens)
        is_last &= PrintedSymbol(word) not in self.notation.names
        is_one = word == LAPLACE or ((any_name or is_last) and is_unit_name(word))
        return word not in IMAGINARY and is_one and not self.upright_base()

    def signed_operand(self) -> Value:
        """Return a factor that may have a sign."""
        if self.text == "-":
            self.take()
            return negated(self.operand())
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
        """Return a value with the power that follows it."""
        raised = False
        while self.text in ("^", "_", "**") or self.text in PRIMES:
            if self.notation.fields and not raised and (order := self.slopes()):
                value = Differentiated(self.expression_of(value), order, span=self.span(start))
                continue
            if self.text == "_":
                self.refuse("a subscript of a bracket is not read")
            if self.text in PRIMES:
                self.refuse("a derivative of a bracket is not read")
            if raised:
                self.refuse("a second power follows", "write braces: {x^2}^3")
            self.take()
            if isinstance(value, Matrix) and text_of(self.tokens[self.at : self.at + 3]) in ("{-1",):
                self.group()
                value = inverse_of(value, self.refuse)
                continue
            if isinstance(value, Matrix):
                self.refuse("a power of a matrix other than its inverse is not read")
            exponent = self.group_expression()
            value = power_of_value(value, exponent, self.span(start), self.refuse)
            raised = True
        return value

    def slopes(self) -> int:
        """Take primes, or a subscript of x, behind a bracket; return how many."""
        count = 0
        while self.text in PRIMES:
            count += PRIMES[self.take().text]
        if self.text == "_" and not count:
            end = group_end(self.tokens, self.at + 1)
            index = text_of(t for t in self.tokens[self.at + 1 : end] if t.text not in "{},")
            if set(index) == {"x"}:
                count, self.at = len(index), end
        return count

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
        """Return an argument that is no matrix."""
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

    def bracket(self) -> Value:
        """Return what stands in brackets."""
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
        """Return a fraction, or the derivative that one stands for."""
        start = self.at
        self.take()
        if (derivative := self.derivative(start)) is not None:
            return derivative
        above = self.group()
        below = self.group()
        return quotient_of_values(above, below, self.span(start), self.refuse)

    def root(self) -> Expression:
        """Return a root."""
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
        if index == 2:  # noqa: PLR2004 (a square root)
            return Call("sqrt", radicand, span=span)
        exponent = Quotient(Number(Fraction(1)), Number(Fraction(index)), span=span)
        return Power(radicand, exponent, span=span)

    def function(self) -> Expression | None:
        """Return a function with its argument, ``None`` if there is no function here."""
        start = self.at
        name, end = self.function_name()
        if name is None:
            return None
        self.at = end
        base = self.base_of_logarithm(start) if self.tokens[start].text == r"\log" else None
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
        if base is not None:
            value = Quotient(value, Call("log", base, span=span), span=span)
        if exponent is not None:
            value = Power(value, exponent, span=span)
        elif self.text == "^":
            value = self.expression_of(self.powers(value, start))
        return value if whole == name else Quotient(Number(Fraction(1)), value, span=span)

    def base_of_logarithm(self, start: int) -> Expression | None:
        """Return the base of a logarithm, ``None`` for a natural one; without an index it may be 10 or e."""
        if self.text == "_":
            self.take()
            typed = self.group()
            if isinstance(typed, Number) or (isinstance(typed, Name) and typed.name == "e"):
                return typed if isinstance(typed, Number) else None
            self.refuse("the base of a logarithm is a number or e", at=start)
        # All of a formula have the same base, so a ratio of two is one formula.
        self.logarithm = start if self.logarithm is None else self.logarithm
        return Number(Fraction(10)) if self.choose(self.logarithm, 2) else None

    def function_name(self) -> tuple[str | None, int]:
        """Return the function that begins here, ``None`` for none, and where its name ends."""
        text = self.text
        if text in CALLS:
            return CALLS[text], self.at + 1
        if text == r"\log":
            return "log", self.at + 1
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
            is_plain = isinstance(value, Sum) and any(isinstance(unsigned(t), Number) for t in value.terms)
            is_apart = self.at < len(self.tokens) and self.tokens[self.at].is_spaced
            if self.continues() and is_plain and not is_apart and name != "exp" and self.choose(at, 2):
                return self.expression_of(
                    product_of_values(value, self.operand(), self.span(at), self.refuse)
                )
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
        """Return where the bracket that begins at a token ends, -1 if it does not."""
        depth = 0
        for i in range(at, len(self.tokens)):
            depth += (self.tokens[i].text in DELIMITERS) - (self.tokens[i].text in CLOSERS)
            if not depth:
                return i + 1
        return -1

    def expression_of(self, value: Value) -> Expression:
        """Return a value that is no matrix."""
        if isinstance(value, Matrix):
            self.refuse("a matrix cannot stand here")
        return value

    def continues(self) -> bool:
        """Tell whether a symbol, fraction or root follows that an argument might go on with."""
        text = self.text
        if ACCENTED.get(text) in DOTS:
            return False
        if text in FONTS and (self.function_name()[0] is not None or self.is_unit(any_name=False)):
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
                flat_product(parts, self.span(at)), self.expression_of(self.operand()), span=self.span(at)
            )
        return flat_product(parts[:whole], self.span(at))

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
        if isinstance(result, Power) and self.argument_typed() in ARGUMENTS:  # B^2(s) is B(s)^2
            self.applied(value)
        return result

    def argument_typed(self) -> str:
        """Return what stands in the brackets that follow, empty without them."""
        end = self.end_of_bracket(self.at) if self.text in ("(", "[") else -1
        return (
            text_of(t for t in self.tokens[self.at + 1 : end - 1] if t.text not in FONTS) if end > 0 else ""
        )

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
        """Return a power of e, whose base has so many tokens."""
        self.at = start + skip + 1
        argument = self.group_expression()
        return Call("exp", argument, span=self.span(start))

    def moving(self, value: Expression, dots: int, primes: int) -> Expression:
        """Return a symbol of an equation of motion with its derivatives, and where along x it is taken."""
        if not isinstance(value, Name):
            return value
        if self.notation.motion == "time":
            self.applied(value)
            return Derivative(value.name, dots + primes, span=value.span) if dots + primes else value
        placed = self.placed(Derivative(value.name, primes, span=value.span) if primes else value)
        return flat_product([_differentiation(dots, value.span), placed], value.span) if dots else placed

    def placed(self, value: Expression) -> Expression:
        """Return a field, or its derivative along x, at the point that follows it, if one does."""
        if value == Name("delta") and self.text == "(":
            self.refuse("a load at a point is not read", "divide the field there, and load the end of a part")
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
        end = self.end_of_bracket(self.at)
        if self.argument_typed() not in ARGUMENTS or not names(value):
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
            self.bare.add(name)
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
            if typed == LAPLACE:
                after = self.tokens[end].text if end < len(self.tokens) else ""
                self.bare |= {name} if after == "^" else set()
                self.arguments[self.at] = name
            if not (is_product and self.choose(self.at, 2)):
                self.at = end
        elif typed.startswith(("t+", "t-")) and PrintedSymbol("t") not in names_known:
            self.refuse(f"a function of time, {name}({typed[:40]}), is not read")
        elif re.search(r"(?<![_\d])\d,\d", typed) and is_constant:
            self.refuse("a comma separates what should be one formula", "a decimal comma is {,}")
        elif any(t.text == "," and not depth for t, depth in with_depth(inside)):
            self.refuse(f"a function of several variables, {name}({typed[:40]}), is not read")
        elif is_constant:
            return
        elif re.fullmatch(r"-?(?:[\d./^s]|\\omega|j|i|p)+", typed) and not typed.isdigit():
            self.refuse(f"'{name}({typed[:40]})' may be a product or a value of a function")
        elif re.fullmatch(r"[a-zA-Z]|\\[A-Za-z]+|\d+(\.\d+)?|[a-zA-Z]_\w", typed) and self.choose(self.at, 2):
            self.at = end

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
        """Return the determinant of a matrix."""
        if not isinstance(value, Matrix) or len(value.rows) != len(value.rows[0]):
            self.refuse("a determinant needs a square matrix", at=start)
        if len(value.rows) > LARGEST_MATRIX:
            self.refuse(f"a determinant of more than {LARGEST_MATRIX} rows is not expanded", at=start)
        if is_longer([e for row in value.rows for e in row], MOST_PARTS // 24):
            self.refuse("this determinant is too long to be written out", at=start)
        return replace(determinant_of(value.rows), span=self.span(start))

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
            return sum_of_values(values, self.span(start), self.refuse)
        value = values[0]
        for other in values[1:]:
            value = product_of_values(value, other, self.span(start), self.refuse)
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
            return product_of_values(_differentiation(order, span), operand, span, self.refuse)
        value = self.expression_of(operand)
        if not isinstance(value, Name):
            return Differentiated(value, order, span=span)
        derived = Derivative(value.name, order, span=span)
        if motion == "time":
            self.applied(value)
            return derived
        return self.placed(derived)


def is_unit_name(word: str) -> bool:
    """Tell whether a word is a unit, of a logarithm too."""
    return word in ("dB", "Np", "rpm") or unit_named(word) is not None


def _differentiation(order: int, span: Span | None) -> Expression:
    """Return a power of s."""
    laplace = Name(LAPLACE, span=span)
    return Power(laplace, Number(Fraction(order), span=span), span=span) if order > 1 else laplace


def _bare(node: Expression) -> Expression:
    return node.base if isinstance(node, Power) else node
