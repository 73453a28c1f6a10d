r"""Symbols and numbers as a paper types them in LaTeX, and what they are called in a model.

Input: tokens, and the names that a model has. Output: symbols, what tells them from others, and their names.

    K_{\mathrm{t}}      base K, script t      k_t, if that is its label

A product of symbols is cut by the names that are known: ``mgls^2`` is ``m*g*l*s^2``, and ``EIs`` is ``EI*s``
where ``EI`` is a name and ``E`` is none.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Final, Literal, NamedTuple, NoReturn

from symflex.errors import Span, SpecError, Text
from symflex.expressions import Expression, Name, Number, number
from symflex.papers.labels import ACCENTS, GREEK
from symflex.papers.source import (
    DEEPEST,
    FONTS,
    SPACES,
    SWITCHES,
    TIMES,
    LatexToken,
    group_end,
    prepared,
    refusal,
    tokens_of,
)

LAPLACE: Final = "s"
IMAGINARY: Final = "ij"
LONGEST_RUN: Final = 8  # letters of a name that are typed side by side
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
PRIMES: Final = {"'": 1, "’": 1, "′": 1, "″": 2, r"\prime": 1}


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
    # What varies along x: their primes, and subscripts such as w_{xxt}, are derivatives.
    fields: frozenset[str] = frozenset()

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
        reader = SymbolReader(prepared(tokens_of(text)), PaperNotation())
        symbol = reader.whole_symbol()
    except SpecError:
        return None
    rest = [t.text for t in reader.tokens[reader.at :] if t.text not in "{}"]
    if rest[:1] == ["^"] and rest[1:] and all(x.isalpha() and x.isascii() for x in rest[1:]):
        return symbol._replace(script=f"{symbol.script}^{''.join(rest[1:])}")  # theta_L^d, a label
    return None if rest else symbol


class SymbolReader:
    """Reads the symbols and numbers of one list of tokens."""

    def __init__(
        self, tokens: Sequence[LatexToken], notation: PaperNotation, bound: Mapping[str, int] | None = None
    ) -> None:
        self.tokens, self.notation = list(tokens), notation
        self.bound = dict(bound or {})  # the index of a product that is written out
        self.at = self.depth = 0
        self.typed: dict[str, str] = {}  # how each name is typed

    @property
    def text(self) -> str:
        """The token that is next, empty at the end."""
        return self.tokens[self.at].text if self.at < len(self.tokens) else ""

    def ahead(self, count: int = 1) -> str:
        """Return the token so many behind the next one, empty at the end."""
        return self.tokens[self.at + count].text if self.at + count < len(self.tokens) else ""

    def take(self) -> LatexToken:
        """Return the next token, and go on behind it."""
        if self.at >= len(self.tokens):
            last = self.tokens[-1].span if self.tokens else None
            raise refusal(last, "the formula ends here, where a number or a symbol should follow")
        self.at += 1
        return self.tokens[self.at - 1]

    def refuse(self, message: str, hint: str | None = None, at: int | None = None) -> NoReturn:
        """Refuse what stands at a token, the next one if none is named."""
        index = min(self.at if at is None else at, len(self.tokens) - 1)
        raise refusal(self.tokens[index].span if self.tokens else None, message, hint)

    def span(self, start: int) -> Span:
        """Return the place from a token to the last one that was taken."""
        first, last = self.tokens[start].span, self.tokens[max(start, self.at - 1)].span
        is_one = first.source is last.source and first.start <= last.end
        return Span(first.source, first.start, last.end) if is_one else first

    def enter(self) -> None:
        """Count a level of nesting; what ends normally leaves it."""
        self.depth += 1
        if self.depth > DEEPEST:
            self.refuse("this is nested too deeply", "name parts of it")

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

    def number(self) -> Expression:
        """Return a number: digits, a point or ``{,}``, and thin spaces between thousands."""
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
            if len(digits) > 200:  # noqa: PLR2004 (digits)
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
        """Tell whether ``{,}`` with a digit behind it is next."""
        return self.ahead() in (",", ".") and self.ahead(2) == "}" and self.ahead(3).isdigit()

    def is_thousands(self, digits: str) -> bool:
        r"""Tell whether three digits after a space continue a number: ``10\,000``."""
        run = 0
        while self.ahead(run).isdigit() and (not run or not self.tokens[self.at + run].is_spaced):
            run += 1
        return run == 3 and len(digits.split(".", maxsplit=1)[0]) <= 9  # noqa: PLR2004 (groups of thousands)

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
        if len(singles) < 2:  # noqa: PLR2004 (a pair)
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
        """Tell whether a symbol has a meaning."""
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
        if base in self.notation.fields and index and set(index) <= {"x", "t"}:  # w_{xt}
            dots, primes, index = dots + index.count("t"), primes + index.count("x"), ""
        if primes and not (is_moving and (self.notation.motion == "time" or base in self.notation.fields)):
            words.append("p" * primes)
            primes = 0
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
        """Return the same as :meth:`base`, without counting a level."""
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
        return len(letters) <= 2 or letters[-1] == letter or letters[0] == letter  # noqa: PLR2004 (a pair)

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
        if len(name) > 64:  # noqa: PLR2004 (letters shown)
            self.refuse("this symbol has more than 64 letters", at=start)
        return Name(name, span=span)

    def remember(self, name: str, start: int) -> None:
        """Refuse a second symbol that is typed otherwise and would have the same name."""
        kept = [t.text for t in self.tokens[start : self.at] if t.text not in "{}_^"]
        if self.notation.motion:  # derivatives are no other symbols
            kept = [text for text in kept if ACCENTED.get(text) not in DOTS and text not in PRIMES]
            kept = kept[:1] if name in self.notation.fields or "(" in kept else kept
        kept = [text for i, text in enumerate(kept) if text not in FONTS or not i]
        typed = " ".join(sorted(kept))
        if not self.bound and self.typed.setdefault(name, typed) != typed:
            message = f"two symbols would both be '{name}' here: {self.typed[name]} and {typed}"
            self.refuse(message, "name one of them in [notation]", start)
