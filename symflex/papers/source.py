r"""From LaTeX as it stands to the sides of its equations: tokens with places, macros, files, displays.

Input: a text or a file. Output: tokens without what does not show, cut into statements at relations, rows,
commas and words such as "where".

    G &= \frac{a}{b}, \quad \text{where } a = 2c \\      G, \frac{a}{b}      a, 2c

A file is not typeset. It is searched for definitions of macros, for files that it reads, and for mathematics;
only what stands in mathematics is cut into tokens, and macros are replaced there. A token that a macro made
has the place where the macro is used. Text is hostile: nesting, length and the work of macros are bounded,
and no file outside the folder of the first one is read.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, NamedTuple

from symflex.errors import Diagnostic, Source, Span, SpecError, Text
from symflex.papers.tabular import ARRAYS, LONGEST_TABLE

CODE: Final = "SF115"  # LaTeX that is not read, or can be read in two ways
LONGEST: Final = 20_000  # characters of a formula, and tokens that macros make of it
LONGEST_FILE: Final = 2_000_000  # characters of a paper, with the files that it reads
MOST_FILES: Final = 50
MOST_DISPLAYS: Final = 1_000
MOST_EXPANSIONS: Final = 5_000  # macros that are replaced in one formula
DEEPEST: Final = 80  # levels of groups, brackets, functions and environments


def commands(names: str) -> frozenset[str]:
    r"""Return names as commands: ``\frac`` for ``frac``."""
    return frozenset(rf"\{name}" for name in names.split())


FONTS: Final = commands(
    "mathrm mathit mathbf mathsf mathtt mathnormal mathcal mathscr mathbb mathfrak text textrm textit textbf "
    "textsf textnormal mbox hbox bm boldsymbol pmb operatorname mathop mathup rm it bf mit"
)
WORDY: Final = commands("text textrm textit textnormal mbox hbox mathrm intertext shortintertext")
SWITCHES: Final = commands("rm it bf mit")  # fonts that last to the end of a group
SKIPPED: Final = commands(
    "left right middle big Big bigg Bigg bigl bigr Bigl Bigr biggl biggr Biggl Biggr bigm displaystyle "
    "textstyle scriptstyle scriptscriptstyle limits nolimits nonumber notag mathstrut strut allowbreak relax "
    "null centering hfill hfil noindent hline mathord mathbin mathrel mathopen mathclose mathinner protect "
    "nobreak par boxed ensuremath mathclap fbox smash small large therefore because "
    "IEEEyesnumber IEEEnonumber IEEEeqnarraynumspace"
) | {"\\/", "\\-", r"\(", r"\)", r"\[", r"\]", "$"}
SPACES: Final = commands(", ; : ! > thinspace medspace enspace space negthinspace") | {"\\ ", "~"}
WIDE: Final = commands("quad qquad")
WITHOUT_ARGUMENT: Final = commands(  # what is left out with its argument
    "label tag hspace vspace phantom hphantom vphantom color ref eqref cite footnote mspace hskip setlength"
)
WITHOUT_FIRST: Final = commands("underset overset stackrel textcolor")  # the second argument is meant
BRACED: Final = {r"\underbrace": "_", r"\underbracket": "_", r"\overbrace": "^", r"\overbracket": "^"}
DELIMITERS: Final = {r"\{": "{}", r"\lbrace": "{}", r"\lbrack": "[]", r"\lparen": "()", "(": "()", "[": "[]"}
CLOSERS: Final = {")": "()", "]": "[]", r"\}": "{}", r"\rbrace": "{}", r"\rbrack": "[]", r"\rparen": "()"}
MATRICES: Final = frozenset("matrix pmatrix bmatrix Bmatrix vmatrix Vmatrix smallmatrix array".split())
RELATIONS: Final = commands("equiv triangleq coloneqq coloneq doteq defeq eqdef") | {"="}
NEARLY: Final = commands("approx simeq cong sim propto approxeq")
ORDERED: Final = commands("le leq ge geq ll gg neq ne in leqslant geqslant to rightarrow") | {"<", ">"}
COMPARED: Final = RELATIONS | NEARLY | ORDERED
ARROWS: Final = commands("Rightarrow implies Longrightarrow Leftrightarrow iff Leftarrow longrightarrow")
TIMES: Final = commands("cdot times ast cdotp") | {"*"}
OPERATORS: Final = TIMES | commands("pm mp div") | {"+", "-", "/"}
ROWS: Final = frozenset(  # environments whose rows are equations
    "equation align gather multline split aligned alignedat gathered eqnarray flalign alignat subequations "
    "dmath IEEEeqnarray math displaymath cases dcases rcases array dgroup multlined empheq".split()
)
ONE_FORMULA: Final = frozenset(("multline", "split", "multlined"))  # whose rows are one formula
WITH_COLUMNS: Final = frozenset("array alignedat alignat IEEEeqnarray empheq".split())
CONDITIONS: Final = frozenset("for if when at whenever provided otherwise as unless".split())
CONNECTIVES: Final = CONDITIONS | frozenset(
    "where and with or in which here let so that thus hence therefore then we have is are denotes the given "
    "by using defining defined giving to be of a an from ie eg it follows also".split()
)
UNICODE: Final = {
    **{chr(0x3B1 + i): rf"\{name}" for i, name in enumerate(
        "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi omicron pi rho varsigma "
        "sigma tau upsilon phi chi psi omega".split()
    )},
    **{letter: rf"\{name}" for letter, name in zip(
        "ΓΔΘΛΞΠΣΥΦΨΩ", "Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega".split(), strict=True
    )},
    "−": "-", "–": "-", "·": r"\cdot", "×": r"\times", "∂": r"\partial", "ℓ": r"\ell", "…": r"\ldots",
    "\N{NO-BREAK SPACE}": "~", "\N{THIN SPACE}": r"\,", "≈": r"\approx",
    "≤": r"\le", "≥": r"\ge", "∞": r"\infty",
}  # fmt: skip
_LEXEME: Final = re.compile(r"\\[A-Za-z@]+\*?|\\.|%[^\n]*\n?|\s+|.", re.DOTALL)


class LatexToken(NamedTuple):
    """A command with its backslash, or one character."""

    text: str
    span: Span
    is_spaced: bool = False  # after a space that shows, as \, makes one


def refusal(span: Span | None, message: str, hint: str | None = None) -> SpecError:
    """Return the error for LaTeX that is not read."""
    return SpecError(Diagnostic(CODE, message, span, hint))


def too_large(span: Span | None, message: str, hint: str | None = None) -> SpecError:
    """Return the error for LaTeX beyond a limit."""
    return SpecError(Diagnostic("SF103", message, span, hint))


def tokens_of(text: Text, longest: int = LONGEST) -> list[LatexToken]:
    r"""Return the tokens of LaTeX, comments and blanks left out; SF103 when it is too long."""
    value = text.value
    if len(value) > longest:
        message = f"this LaTeX has {len(value)} characters; at most {longest} are allowed"
        raise too_large(text.at(longest, longest + 1), message, "read its parts alone")
    found: list[LatexToken] = []
    for match in _LEXEME.finditer(value):
        word = match[0]
        if word.isspace() or word.startswith("%"):
            continue
        word = UNICODE.get(word, word)
        found.append(
            LatexToken(word[:-1] if len(word) > 1 and word[-1] == "*" else word, text.at(*match.span()))
        )
    return found


def text_of(tokens: Iterable[LatexToken]) -> str:
    """Return tokens as one text, as the name of an environment is."""
    return "".join(t.text for t in tokens)


def group_end(tokens: Sequence[LatexToken], at: int) -> int:
    """Return where the group, or the one token, that begins at a place ends."""
    if at >= len(tokens) or tokens[at].text != "{":
        return min(at + 1, len(tokens))
    depth = 0
    for i in range(at, len(tokens)):
        depth += {"{": 1, "}": -1}.get(tokens[i].text, 0)
        if not depth:
            return i + 1
    raise refusal(tokens[at].span, "this '{' is never closed", "add '}'")


def skip_arguments(tokens: Sequence[LatexToken], at: int, count: int = 1) -> int:
    """Return where the tokens after so many arguments begin; one in square brackets before them is too."""
    if at < len(tokens) and tokens[at].text == "[":
        at = next((i for i in range(at, len(tokens)) if tokens[i].text == "]"), len(tokens) - 1) + 1
    for _ in range(count):
        at = group_end(tokens, at)
    return at


def environment(tokens: Sequence[LatexToken], at: int) -> tuple[str, int]:
    r"""Return the name after ``\begin`` or ``\end``, without a star, and where its argument ends."""
    end = group_end(tokens, at + 1)
    return text_of(tokens[at + 2 : end - 1]).removesuffix("*"), end


def with_depth(tokens: Iterable[LatexToken]) -> Iterator[tuple[LatexToken, int]]:
    """Yield each token with the number of brackets and environments around it."""
    depth = 0
    for token in tokens:
        depth = max(0, depth - (token.text in CLOSERS or token.text in ("}", r"\end")))
        yield token, depth
        depth += token.text in DELIMITERS or token.text in ("{", r"\begin")


def has_relation(tokens: Iterable[LatexToken]) -> bool:
    """Tell whether a relation stands outside all brackets."""
    return any(not depth and t.text in COMPARED for t, depth in with_depth(tokens))


# --- from tokens to the sides of equations ---


class PrintedEquation(NamedTuple):
    """One equation or formula of a display."""

    sides: tuple[tuple[LatexToken, ...], ...]  # without the relations between them
    is_condition: bool = False  # says where something holds: after "for", or an inequality
    nearly: Span | None = None  # where it first says that two sides are nearly equal

    @property
    def span(self) -> Span:
        """Where it begins."""
        return self.sides[0][0].span

    @property
    def tokens(self) -> tuple[LatexToken, ...]:
        """All its tokens."""
        return tuple(t for side in self.sides for t in side)


def statements(tokens: Sequence[LatexToken]) -> tuple[PrintedEquation, ...]:
    """Return the equations and formulas of a display, or of a list after "where"."""
    found: list[PrintedEquation] = []
    for piece, is_condition in _Cutter(_opened(prepared(tokens))).pieces():
        sides: list[list[LatexToken]] = [[]]
        nearly, is_ordered = None, False
        trimmed = _trimmed(piece)
        for i, (token, depth) in enumerate(with_depth(trimmed)):
            if not depth and token.text in COMPARED:
                nearly = nearly or (token.span if token.text in NEARLY else None)
                is_ordered |= token.text in ORDERED
                sides.append([])
            elif token.text != ":" or text_of(trimmed[i + 1 : i + 2]) != "=":
                sides[-1].append(token)
        kept = tuple(tuple(side) for side in sides if side)
        if any(t.text not in CLOSERS for side in kept for t in side):  # as of \right\} behind rows
            found.append(PrintedEquation(kept, is_condition or is_ordered, nearly))
    return tuple(found)


def prepared(tokens: Sequence[LatexToken], depth: int = 0) -> list[LatexToken]:
    r"""Return tokens without what does not show or only shows: sizes of brackets, labels, spaces."""
    if depth > DEEPEST:
        raise too_large(tokens[0].span, f"commands are nested more than {DEEPEST} times")
    out: list[LatexToken] = []
    i, is_spaced = 0, False
    while i < len(tokens):
        token = tokens[i]
        text = token.text
        i += 1
        if text in (r"\eqno", r"\leqno"):
            break  # the number of the equation follows
        if text in SPACES:
            is_spaced = text not in (r"\!", r"\negthinspace")
        elif text in SKIPPED:
            # \left. and \right. are brackets that do not show.
            i += text in (r"\left", r"\right") and i < len(tokens) and tokens[i].text == "."
            if text in (r"\boxed", r"\ensuremath", r"\mathclap", r"\fbox", r"\smash"):
                out += _unwrapped(tokens, i, depth)
                i = group_end(tokens, i)
        elif text in WITHOUT_ARGUMENT | WITHOUT_FIRST:
            i = skip_arguments(tokens, i)
        elif text in BRACED:
            out += _unwrapped(tokens, i, depth)
            i = group_end(tokens, i)
            if i < len(tokens) and tokens[i].text == BRACED[text]:
                i = group_end(tokens, i + 1)
        elif (
            text in FONTS and text not in SWITCHES and has_relation(tokens[i + 1 : group_end(tokens, i) - 1])
        ):
            out += _unwrapped(tokens, i, depth)
            i = group_end(tokens, i)
        else:
            out.append(token._replace(is_spaced=is_spaced))
            is_spaced = False
    return out


def _unwrapped(tokens: Sequence[LatexToken], at: int, depth: int) -> list[LatexToken]:
    """Return what an argument holds; a formula keeps its braces, an equation does not."""
    end = group_end(tokens, at)
    if tokens[at : at + 1] and tokens[at].text != "{":
        return prepared(tokens[at:end], depth + 1)
    whole = prepared(tokens[at + 1 : end - 1], depth + 1)
    return whole if has_relation(whole) or not whole else [tokens[at], *whole, tokens[end - 1]]


def _opened(tokens: Sequence[LatexToken]) -> list[LatexToken]:
    r"""Return tokens with environments whose rows are equations opened; a row ends with ``\\``.

    In formulas that go over several rows it is ``\cr``.
    """
    out: list[LatexToken] = []
    columns = _separating(tokens)
    opened: list[str] = []  # names of environments that are opened, empty for one that stays
    i = 0
    while i < len(tokens):
        token = tokens[i]
        inside = any(not name for name in opened)
        row = r"\cr" if any(name in ONE_FORMULA for name in opened) else r"\\"
        i += 1
        if token.text == r"\begin":
            name, end = environment(tokens, i - 1)
            is_opened, brace = _is_opened(tokens, i - 1, name, out, is_inside=inside)
            opened.append(name if is_opened else "")
            if len(opened) > DEEPEST:
                raise too_large(token.span, f"environments are nested more than {DEEPEST} times")
            if not is_opened:
                out.append(token)
                continue
            if brace:
                out.pop()
            i = skip_arguments(tokens, end) if name in WITH_COLUMNS else end
            if text_of(tokens[i : i + 3]) in ("[t]", "[b]", "[c]"):
                i += 3
            out.append(LatexToken(r"\cr" if name in ONE_FORMULA else r"\\", token.span))
        elif token.text == r"\end":
            name, end = environment(tokens, i - 1)
            if not opened:
                raise refusal(token.span, rf"\end{{{name[:40]}}} without \begin", "the display is cut off")
            if opened.pop():
                out.append(LatexToken(row, token.span))
                i = end
            else:
                out.append(token)
        elif inside:
            out.append(token)
        elif token.text in (r"\\", r"\cr", r"\newline"):
            out.append(LatexToken(row, token.span))
            length = re.match(r"\[-?[\d.]+(pt|mm|cm|ex|em|in|\\\w+)?\]", text_of(tokens[i : i + 12]))
            i += sum(1 for _ in range(i, i + len(length[0]))) if length and "\\" not in length[0] else 0
        elif i - 1 in columns and row == r"\\":
            out.append(LatexToken(row, token.span))
        elif token.text not in ("&", r"\&"):
            out.append(token)
    if opened:
        raise refusal(tokens[-1].span, r"a \begin has no \end", "the display is cut off")
    return out


def _separating(tokens: Sequence[LatexToken]) -> set[int]:
    r"""Return which ``&`` of ``a &= b & c &= d`` part two equations: those with one on both sides."""
    at = list(with_depth(tokens))
    follows: dict[int, tuple[bool, str]] = {}  # whether a relation follows in the row, and what is next
    ahead: dict[int, bool] = {}
    near = ""
    for i in reversed(range(len(at))):
        token, depth = at[i]
        if token.text == "&":
            follows[i] = ahead.get(depth, False), near
        elif token.text in (r"\\", r"\cr"):
            ahead[depth] = False
        elif token.text in (r"\end", "}"):
            ahead[depth + 1] = False
        elif token.text in COMPARED:
            ahead[depth] = True
        near = near if token.text == "&" or token.text in WIDE else token.text
    found: set[int] = set()
    seen: dict[int, bool] = {}
    near = ""
    for i, (token, depth) in enumerate(at):
        if token.text == "&":
            has_relation_behind, behind = follows[i]
            is_joined = behind in COMPARED or near in COMPARED
            if seen.get(depth) and has_relation_behind and not is_joined:
                found.add(i)
                seen[depth] = False
        elif token.text in (r"\\", r"\cr"):
            seen[depth] = False
        elif token.text in (r"\begin", "{"):
            seen[depth + 1] = False
        elif token.text in COMPARED:
            seen[depth] = True
        near = near if token.text == "&" or token.text in WIDE else token.text
    return found


def _is_opened(
    tokens: Sequence[LatexToken], begin: int, name: str, before: Sequence[LatexToken], *, is_inside: bool
) -> tuple[bool, bool]:
    """Tell whether the rows of an environment are equations, and whether a lone brace before it goes."""
    stop = _environment_end(tokens, begin)
    brace = bool(before) and before[-1].text in (r"\{", r"\lbrace")
    brace = brace and not (stop < len(tokens) and tokens[stop].text in (r"\}", r"\rbrace"))
    if is_inside or (name not in ROWS and not (brace and name in MATRICES)):
        return False, False
    rows = _rows(tokens[environment(tokens, begin)[1] : stop])
    if name.endswith("cases") or brace:
        if not all(map(_is_equation, rows)):
            message = "a distinction of cases has no single formula"
            raise refusal(tokens[begin].span, message, "give the case that the model is")
        return True, brace
    is_matrix = name == "array" and not any(has_relation([t for t in row if t.text != "&"]) for row in rows)
    return not is_matrix, False


def _is_equation(row: Sequence[LatexToken]) -> bool:
    """Tell whether a row is an equation, and no formula with the case it holds in."""
    texts = ["" if depth else t.text for t, depth in with_depth(row)]
    relation = next((i for i, text in enumerate(texts) if text in RELATIONS | NEARLY), len(texts))
    before = texts[:relation]
    return relation < len(texts) and "," not in before and "&" not in before[:-1]


def _environment_end(tokens: Sequence[LatexToken], begin: int) -> int:
    r"""Return where the tokens after an environment begin."""
    depth = 0
    for i in range(begin, len(tokens)):
        depth += {r"\begin": 1, r"\end": -1}.get(tokens[i].text, 0)
        if not depth:
            return environment(tokens, i)[1]
    raise refusal(tokens[begin].span, r"this \begin has no \end", "the display is cut off")


def _rows(tokens: Sequence[LatexToken]) -> list[list[LatexToken]]:
    r"""Return the rows of an environment, up to its ``\end``, that hold anything."""
    rows: list[list[LatexToken]] = [[]]
    for token, depth in with_depth(tokens):
        if token.text == r"\end" and not depth:
            break
        if token.text in (r"\\", r"\cr") and not depth:
            rows.append([])
        else:
            rows[-1].append(token)
    return [row for row in rows if any(t.text != "&" for t in row)]


class _Cutter:
    """Cuts tokens into formulas at words, rows, commas and wide spaces."""

    def __init__(self, tokens: list[LatexToken]) -> None:
        self.tokens = tokens
        self.found: list[tuple[list[LatexToken], bool]] = [([], False)]

    def begin(self, *, is_condition: bool = False) -> None:
        self.found.append(([], is_condition))

    def pieces(self) -> list[tuple[list[LatexToken], bool]]:
        """Return the formulas, and whether each is a condition."""
        tokens, depth, i = self.tokens, 0, 0
        while i < len(tokens):
            token, (current, is_condition) = tokens[i], self.found[-1]
            text = token.text
            i += 1
            if text in (r"\\", r"\cr") and depth and any(t.text == r"\begin" for t in current):
                current.append(token)
            elif text in (r"\\", r"\cr"):
                if not depth and self.begins_anew(i, is_one=text == r"\cr"):
                    self.begin()
            elif not depth and (joined := self.words(i - 1)):
                words, i = joined
                goes_on = is_condition and words[0] in ("and", "or")
                self.begin(is_condition=words[0] in CONDITIONS or goes_on)
            elif text in WIDE and not depth:
                i = self.after_wide_space(i)
            elif text in WIDE:
                continue
            elif text in (",", ";") and not depth and current:
                self.begin(is_condition=is_condition)
            elif text in ARROWS and not depth:
                self.begin()
            else:
                depth += text in DELIMITERS or text in ("{", r"\begin")
                depth = max(0, depth - (text in CLOSERS or text in ("}", r"\end")))
                current.append(token)
        return self.found

    def words(self, at: int) -> tuple[list[str], int] | None:
        r"""Return words that join formulas, or remark on one, and where they end; ``None`` for a name.

        ``\text{and}`` joins what is before it and behind it. At the end of a row, words after a space are a
        remark, such as a unit. Everything else in letters is a name, so that nothing of a formula is lost.
        """
        tokens, current = self.tokens, self.found[-1][0]
        begin = at + (tokens[at].text == "{" and text_of(tokens[at + 1 : at + 2]) in SWITCHES)
        if tokens[begin].text not in WORDY | SWITCHES or (current and current[-1].text in ("_", "^")):
            return None
        end = group_end(tokens, at) if begin > at else group_end(tokens, begin + 1)
        inner = [t for t in tokens[begin + 1 : end] if t.text not in "{}"]
        written_as = written(inner)
        words = re.sub(r"[^a-z ]", " ", (written_as or text_of(inner)).lower()).split()
        if not inner:
            return ["and"], end
        follows = bool(self.rest(end))
        if (
            words
            and len(words[0]) > 1
            and words[0] in CONNECTIVES
            and (follows or len(words) > 1 or not current)
        ):
            return words, end
        source, start = inner[0].span.source.text, inner[0].span.start
        is_apart = tokens[begin].is_spaced or source[start - 1 : start].isspace() or inner[0].text == "("
        return (words, end) if len(words) > 1 and not follows and is_apart else None

    def rest(self, at: int) -> list[LatexToken]:
        """Return tokens up to the next row, comma, word or wide space."""
        taken: list[LatexToken] = []
        for token, depth in with_depth(self.tokens[at:]):
            if not depth and (token.text in WIDE or token.text in (r"\\", r"\cr", ",", ";", r"\text")):
                break
            taken.append(token)
        return taken

    def after_wide_space(self, at: int) -> int:
        """Begin anew after a space as wide as between formulas, unless a formula goes on; return where."""
        current, following = self.found[-1][0], self.rest(at)
        first = following[0].text if following else ""
        goes_on = not following or not current or first in OPERATORS | COMPARED
        if goes_on or current[-1].text in OPERATORS | COMPARED:
            return at
        after = at + len(following)
        is_last = after >= len(self.tokens) or self.tokens[after].text in (r"\\", r"\cr", ",")
        closing = "])".find(following[-1].text)
        if is_last and closing >= 0 and "[("[closing] == first and not has_relation(following):
            return after  # the number of the equation, or its unit in brackets
        self.begin(is_condition=not has_relation(following))
        return at

    def begins_anew(self, at: int, *, is_one: bool) -> bool:
        """Tell whether a new formula begins in the row that begins here, or the last one goes on."""
        current = self.found[-1][0]
        while at < len(self.tokens) and self.tokens[at].text in WIDE:
            at += 1
        following = self.rest(at)
        if not current or not following:
            return not is_one or not current
        ends_open = current[-1].text in OPERATORS | COMPARED
        goes_on = ends_open or following[0].text in OPERATORS | COMPARED
        return not is_one and not goes_on


def _trimmed(piece: Sequence[LatexToken]) -> list[LatexToken]:
    """Return a piece without punctuation at its ends."""
    kept = list(piece)
    while kept and kept[-1].text in (".", ",", ";", ":"):
        kept.pop()
    while kept and (kept[0].text in (",", ";") or (kept[0].text == "." and not text_of(kept[1:2]).isdigit())):
        kept.pop(0)
    return kept


# --- from a file to its displays ---


class Display(NamedTuple):
    """Mathematics of a file, its macros replaced."""

    tokens: tuple[LatexToken, ...]
    span: Span  # where it begins
    is_inline: bool  # stands in a sentence
    problem: Diagnostic | None = None  # why its macros could not be replaced

    @property
    def labels(self) -> tuple[tuple[int, str], ...]:
        """Where its labels and tags stand, and what they are."""
        found = []
        for i, token in enumerate(self.tokens):
            if token.text in (r"\label", r"\tag"):
                inner = self.tokens[i + 2 : group_end(self.tokens, i + 1) - 1]
                name = written(inner)
                found.append((token.span.start, f"({name})" if token.text == r"\tag" else name))
        return tuple(found)


def written(tokens: Sequence[LatexToken]) -> str:
    """Return tokens as they are written in their file."""
    if not tokens:
        return ""
    first, last = tokens[0].span, tokens[-1].span
    if first.source is not last.source or last.end < first.start:
        return text_of(tokens)
    return first.source.text[first.start : last.end]


@dataclass(frozen=True)
class Macro:
    """A command that a file defines."""

    body: tuple[LatexToken, ...]
    arguments: int = 0
    default: tuple[LatexToken, ...] | None = None  # of its first argument, where that may be left out


DISPLAYED: Final = frozenset(
    "equation align gather multline eqnarray flalign alignat displaymath dmath IEEEeqnarray".split()
)
VERBATIM: Final = frozenset("verbatim lstlisting comment minted Verbatim filecontents alltt".split())
DEFINING: Final = commands(
    "newcommand renewcommand providecommand DeclareMathOperator def gdef let newenvironment"
)
_MARK: Final = re.compile(r"\\verb\*?([^A-Za-z\s]).{0,500}?\1|%[^\n]*|\\[A-Za-z@]+\*?|\\.|\$\$?", re.DOTALL)


@dataclass
class Paper:
    """What a file and those that it reads hold, in their order."""

    displays: list[Display] = field(default_factory=list)
    arrays: list[Text] = field(default_factory=list)  # what is in its tabulars
    macros: dict[str, Macro] = field(default_factory=dict)
    environments: dict[str, str] = field(default_factory=dict)  # those that stand for another one
    notes: list[Diagnostic] = field(default_factory=list)  # files that are not there
    characters: int = 0
    files: int = 0


def read_paper(path: Path) -> Paper:
    """Return the mathematics of a file; SF115 or SF103 at what is refused, SF901 without the file."""
    paper = Paper()
    _read_file(path, path.resolve().parent, paper, None, ())
    return paper


def read_text(text: Text) -> Paper:
    """Return the mathematics of a text that reads no files."""
    paper = Paper()
    _PaperScanner(text, paper, None, ()).scan()
    return paper


def _read_file(path: Path, folder: Path, paper: Paper, asked: Span | None, opened: tuple[Path, ...]) -> None:
    resolved = path.resolve()
    if resolved in opened:
        raise refusal(asked, f"'{path.name}' reads itself")
    paper.files += 1
    if paper.files > MOST_FILES:
        raise too_large(asked, f"this paper has more than {MOST_FILES} files")
    try:
        with resolved.open("rb") as stream:
            data = stream.read(LONGEST_FILE + 1)
    except OSError as error:
        if asked is None:
            reason = error.strerror or "it cannot be read"
            raise SpecError(Diagnostic("SF901", f"cannot read '{path}': {reason}")) from None
        paper.notes.append(Diagnostic(CODE, f"'{path.name[:80]}' is not read: there is no such file", asked))
        return
    paper.characters += len(data)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    source = Source(str(path), text)
    if paper.characters > LONGEST_FILE:
        message = f"this paper has more than {LONGEST_FILE} characters"
        raise too_large(asked or Span(source, 0, 0), message, "give the chapter that has the formulas")
    _PaperScanner(Text(text, Span(source, 0, len(text))), paper, folder, (*opened, resolved)).scan()


class _PaperScanner:
    """Goes through a text once."""

    def __init__(self, text: Text, paper: Paper, folder: Path | None, opened: tuple[Path, ...]) -> None:
        self.text, self.paper, self.folder, self.opened = text, paper, folder, opened
        self.value = text.value
        self.searched: dict[str, int] = {}  # up to where there is none of what would close mathematics

    def scan(self) -> None:
        at = 0
        while match := _MARK.search(self.value, at):
            at = self.after(match[0].rstrip("*"), match.start(), match.end())

    def after(self, word: str, start: int, end: int) -> int:
        """Take what a word begins, and return where to go on."""
        if word in ("$", "$$", r"\(", r"\["):
            closing = {r"\(": r"\)", r"\[": r"\]"}.get(word, word)
            stop = self.find(closing, end)
            if stop >= 0:
                self.add(end, stop, is_inline=word in ("$", r"\("))
                return stop + len(closing)
            self.lost(word, start, end, is_inline=word in ("$", r"\("))
        elif word in (r"\begin", r"\end"):
            return self.environment(word, start, end)
        elif word in DEFINING:
            return self.define(word, start, end)
        elif word in (r"\input", r"\include", r"\subfile"):
            return self.input(start, end)
        elif word in self.paper.macros and (name := self.begins(self.paper.macros[word])):
            return self.display(name, start, end, word)
        elif word == r"\endinput":
            return len(self.value)
        return end

    def begins(self, macro: Macro) -> str:
        r"""Return the environment that a macro such as ``\be`` begins."""
        body = macro.body
        if not macro.arguments and len(body) > 1 and body[0].text == r"\begin":
            name, end = environment(body, 0)
            return name if end == len(body) and name in DISPLAYED else ""
        return "displaymath" if text_of(body) in (r"\[", "$$") else ""

    def find(self, closing: str, at: int) -> int:
        """Return where something closes, comments and escaped dollars passed over; -1 if nowhere."""
        stop, until = at + LONGEST, at
        for match in _MARK.finditer(self.value, max(at, self.searched.get(closing, 0))):
            until = match.start()
            if match[0] == closing or (closing.startswith("$") and match[0].startswith("$")):
                return until
            if until > stop:
                break
        self.searched[closing] = until
        return -1

    def environment(self, word: str, start: int, end: int) -> int:
        match = re.compile(r"\s*\{([A-Za-z]{1,40}\*?)\}").match(self.value, end)
        if match is None or word == r"\end":
            return match.end() if match else end
        name = match[1].removesuffix("*")
        if name in VERBATIM:
            stop = self.value.find(rf"\end{{{match[1]}}}", match.end())
            return stop if stop >= 0 else len(self.value)
        name = self.paper.environments.get(name, name)
        if name in ARRAYS:
            return self.array(match.end(), match[1])
        return self.display(name, start, match.end(), match[1]) if name in DISPLAYED else match.end()

    def array(self, begin: int, name: str) -> int:
        """Take a tabular; its formulas are read as those of a sentence."""
        end = self.value.find(rf"\end{{{name}}}", begin)
        if 0 <= end <= begin + LONGEST_TABLE:
            if len(self.paper.arrays) >= MOST_DISPLAYS:
                raise too_large(self.text.at(begin, end), f"this paper has more than {MOST_DISPLAYS} tables")
            self.paper.arrays.append(Text(self.value[begin:end], self.text.at(begin, end)))
        return begin

    def display(self, name: str, start: int, end: int, typed: str) -> int:
        """Take a displayed environment; ``typed`` is its name, or the macro that begins it."""
        closers = {rf"\end{{{typed}}}", rf"\end{{{name}}}", rf"\end{{{name}*}}"}
        closers |= {r"\]", "$$"} if name == "displaymath" else set()
        closers |= {
            word for word, macro in self.paper.macros.items() if text_of(macro.body) == rf"\end{{{name}}}"
        }
        depth = 0
        for match in _MARK.finditer(self.value, end):
            word = match[0]
            if match.start() - start > LONGEST:
                break
            if word == r"\end":
                word = (
                    re.compile(r"\s*")
                    .sub("", self.value[match.start() : match.start() + 50])
                    .partition("}")[0]
                    + "}"
                )
            if word in closers and not depth:
                stop = match.start() + (len(word) if word != match[0] else 0)
                self.add(end, match.start(), name=name)
                return max(stop, match.end())
        self.lost(typed, start, end)
        return end

    def lost(self, typed: str, start: int, end: int, *, is_inline: bool = False) -> None:
        """Note mathematics that has no end."""
        problem = Diagnostic(CODE, f"this '{typed[:40]}' has no end", self.text.at(start, end))
        self.keep(Display((), self.text.at(start, end), is_inline, problem))

    def keep(self, display: Display) -> None:
        if len(self.paper.displays) >= MOST_DISPLAYS:
            raise too_large(display.span, f"this paper has more than {MOST_DISPLAYS} formulas")
        self.paper.displays.append(display)

    def add(self, start: int, end: int, *, is_inline: bool = False, name: str = "") -> None:
        """Take mathematics."""
        if name in WITH_COLUMNS and (columns := re.compile(r"\s*\{[^{}]*\}").match(self.value, start, end)):
            start = columns.end()
        inner = self.value[start:end]
        if is_inline and "=" not in inner and r"\equiv" not in inner:
            return
        span = self.text.at(start + len(inner) - len(inner.lstrip()), end)
        tokens: tuple[LatexToken, ...] = ()
        problem = None
        try:
            taken = tokens_of(Text(self.value[start:end], self.text.at(start, end)))
            if name in ONE_FORMULA:
                taken = [t._replace(text=r"\cr") if t.text == r"\\" else t for t in taken]
            tokens = tuple(expanded(taken, self.paper.macros))
        except SpecError as error:
            problem = error.diagnostics[0]
        self.keep(Display(tokens, span, is_inline, problem))

    def define(self, word: str, start: int, end: int) -> int:
        """Take a definition; one that is not understood is passed over, and its macro stays as it is."""
        rest = Text(self.value[end : end + 5_000], self.text.at(end, min(end + 5_000, len(self.value))))
        try:
            tokens = tokens_of(rest)
            name, macro, stop = _definition(word, tokens)
        except (SpecError, IndexError, ValueError):
            return end
        if isinstance(macro, str):
            self.paper.environments[name] = macro
        elif word != r"\providecommand" or name not in self.paper.macros:
            self.paper.macros[name] = macro
        return tokens[stop - 1].span.end - self.text.span.start if stop else end

    def input(self, start: int, end: int) -> int:
        match = re.compile(r"\s*\{([^{}\n]{1,200})\}|[ \t]+([^\s{}\\]{1,200})").match(self.value, end)
        if match is None:
            return end
        span, name = self.text.at(start, match.end()), (match[1] or match[2]).strip()
        if self.folder is None:
            raise refusal(span, r"a formula reads no files", r"give the file to 'symflex referee'")
        path = self.folder / name
        path = path if path.suffix == ".tex" else path.with_name(f"{path.name}.tex")
        if "\0" in name or not path.resolve().is_relative_to(self.folder):
            message = f"'{name[:80]}' lies outside the folder of the paper and is not read"
            raise refusal(span, message, "copy it beside the paper")
        _read_file(path, self.folder, self.paper, span, self.opened)
        return match.end()


def _definition(word: str, tokens: Sequence[LatexToken]) -> tuple[str, Macro | str, int]:
    """Return the name, the macro (or what an environment stands for), and how many tokens define it."""
    if word in (r"\def", r"\gdef"):
        name, i, count = tokens[0].text, 1, 0
        while tokens[i].text == "#" and tokens[i + 1].text == str(count + 1):
            i, count = i + 2, count + 1
        if tokens[i].text != "{":
            raise refusal(tokens[i].span, "a macro with delimited arguments is not read")
        end = group_end(tokens, i)
        return name, Macro(tuple(tokens[i + 1 : end - 1]), count), end
    if word == r"\let":
        i = 1 + (tokens[1].text == "=")
        return tokens[0].text, Macro((tokens[i],)), i + 1
    end = group_end(tokens, 0)
    name = text_of(t for t in tokens[:end] if t.text not in "{}")
    count, default = 0, None
    if word == r"\DeclareMathOperator":
        stop = group_end(tokens, end)
        inner = tokens[end + 1 : stop - 1]
        lead = tokens[end]
        return (
            name,
            Macro(
                (
                    lead._replace(text=r"\operatorname"),
                    lead._replace(text="{"),
                    *inner,
                    lead._replace(text="}"),
                )
            ),
            stop,
        )
    if tokens[end].text == "[":
        count, end = int(tokens[end + 1].text), end + 3
        if tokens[end].text == "[":
            stop = next(i for i in range(end, len(tokens)) if tokens[i].text == "]")
            default, end = tuple(tokens[end + 1 : stop]), stop + 1
    stop = group_end(tokens, end)
    body = tuple(tokens[end + 1 : stop - 1]) if tokens[end].text == "{" else tuple(tokens[end:stop])
    if word == r"\newenvironment":
        begins = [environment(body, i)[0] for i, t in enumerate(body) if t.text == r"\begin"]
        shown = next((b for b in begins if b in DISPLAYED), "")
        return name, shown, group_end(tokens, stop)
    return name, Macro(body, count, default), stop


def expanded(tokens: Sequence[LatexToken], macros: Mapping[str, Macro]) -> list[LatexToken]:
    """Return tokens with macros replaced; what a macro made has the place where it is used."""
    out: list[LatexToken] = []
    pending = list(reversed(tokens))
    expansions = 0
    while pending:
        token = pending.pop()
        macro = macros.get(token.text)
        if macro is None:
            out.append(token)
        else:
            expansions += 1
            arguments = [
                _argument(pending, token, macro.default if k == 0 else None) for k in range(macro.arguments)
            ]
            made = list(_filled(macro.body, arguments, token))
            pending += reversed(made)
        if expansions > MOST_EXPANSIONS or len(out) + len(pending) > LONGEST:
            raise too_large(
                token.span, f"'{token.text[:40]}' expands without end", "look for a macro that holds itself"
            )
    return out


def _argument(
    pending: list[LatexToken], macro: LatexToken, default: tuple[LatexToken, ...] | None
) -> list[LatexToken]:
    """Take the next argument of a macro off what is still to be read."""
    if default is not None:
        if not pending or pending[-1].text != "[":
            return list(default)
        pending.pop()
        taken: list[LatexToken] = []
        while pending and pending[-1].text != "]":
            taken.append(pending.pop())
        if pending:
            pending.pop()
        return taken
    if not pending:
        raise refusal(macro.span, f"'{macro.text[:40]}' lacks an argument")
    first = pending.pop()
    if first.text != "{":
        return [first]
    depth, taken = 1, []
    while pending:
        token = pending.pop()
        depth += {"{": 1, "}": -1}.get(token.text, 0)
        if not depth:
            return taken
        taken.append(token)
    raise refusal(first.span, "this '{' is never closed", "add '}'")


def _filled(
    body: Sequence[LatexToken], arguments: Sequence[Sequence[LatexToken]], used: LatexToken
) -> Iterator[LatexToken]:
    """Yield the body of a macro with its arguments put in."""
    i = 0
    while i < len(body):
        token = body[i]
        number = body[i + 1].text if token.text == "#" and i + 1 < len(body) else ""
        i += 1
        if number.isdigit() and 0 < int(number) <= len(arguments):
            yield from arguments[int(number) - 1]
            i += 1
        else:
            yield token._replace(span=used.span)
