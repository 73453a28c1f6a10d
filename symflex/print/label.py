r"""How names print: a declared label when it is sound LaTeX, else one made from the name.

A declared label is read completely before it is used, so that it cannot break the formula it stands in:
every command has its argument, no atom bears two superscripts, and text holds only text. While it is read its
width is added up, and its atoms and scripts become elements of MathML:

    \hat{x}_1    <msub><mover accent="true"><mi>x</mi><mo>^</mo></mover><mn>1</mn></msub>
"""

from __future__ import annotations

import functools
import html
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from itertools import starmap
from string import ascii_lowercase
from typing import Final, NamedTuple

from symflex.papers.labels import ACCENTS, GREEK, SYMBOLS
from symflex.print.width import (
    COMMA_SIZES,
    FENCE_SIZES,
    ITALIC,
    NOTHING,
    OPERATOR_SIZES,
    OTHER_ALPHABETS,
    PRIME_SIZES,
    RELATION_SIZES,
    ROMAN,
    SCRIPT_SPACE,
    SLASH_SIZES,
    STAR_SIZES,
    TEXT_ITALIC,
    THIN_SIZES,
    TYPEWRITER,
    UPRIGHT,
    Alphabet,
    Width,
    always,
    greek_width,
)

WIDEST_LABEL: Final = 12.0  # width in em beyond which a label gives way to the name in small type
_GREEK: Final = dict(zip(GREEK, "αβγδϵεζηθϑικλμνξπϖρϱσςτυϕφχψωΓΔΘΛΞΠΣΥΦΨΩ", strict=True))
_ACCENTS: Final = dict(zip(ACCENTS, "˙¨¯^~→ˇ˘´`‾_", strict=True))
_SYMBOLS: Final = dict(zip(SYMBOLS, "ℓℏ′∞⋆∗∘∥⊥∗†⋅×±∓…", strict=True))
LABEL_SIGNS: Final = "".join((*_GREEK.values(), *_ACCENTS.values(), *_SYMBOLS.values()))  # signs beyond ASCII
_NAMES: Final = ("ell", "hbar", "infty")  # symbols that are names in MathML, not operators
_TEXT_FONTS: Final = {"text": "", "textrm": "", "textit": "it"}
_DEEPEST: Final = 8
_TOKEN: Final = re.compile(r"\\([A-Za-z]+) *|\\([,;:! ])|([A-Za-z0-9_^{}'+\-=/.,()| *])")
_NUMBER: Final = re.compile(r"[0-9]+(?:\.[0-9]+)?")
_TEXT: Final = re.compile(r"[A-Za-z0-9'+\-=/.,()| *]*")
_NAME: Final = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_INDICES: Final = re.compile(r"\d*i?j")  # of a row and a column, which are no word
_STEM: Final = re.compile(r"([A-Za-z]+)([0-9]*)")


@dataclass(frozen=True, slots=True)
class Label:
    r"""A label and what the formula around it must know."""

    latex: str  # sound in math mode
    size: Width  # rounded up
    is_wordy: bool = False  # holds a word, so that a neighbour needs a thin space
    has_superscript: bool = False  # bears a superscript or prime, so that a power needs parentheses
    # is_sum and is_product: prints an operation, so that it may need parentheses.
    is_sum: bool = False
    is_product: bool = False
    subscript: Width = NOTHING  # of the subscript at its end, above which a power has room
    mathml: str = ""  # one element; empty where the name itself is printed, in typewriter

    @property
    def width(self) -> float:
        """Width at full size [em]."""
        return self.size.text


def label_of(name: str) -> str:
    """Return the label of a name that has none declared: Greek letters, and subscripts after underscores."""
    return _made(name).latex


def labels_of(named: Iterable[tuple[str, str]], reserved: Mapping[str, str]) -> dict[str, str]:
    """Return a label for every name, no two alike.

    ``named`` are names with their declared labels, which may be empty; labels in ``reserved`` are taken.
    """
    labels = dict(reserved)
    taken = set(map(_plain, labels.values()))
    # Declared labels choose first.
    for name, latex in sorted(named, key=lambda pair: not pair[1]):
        label = _symbol(name, latex)
        if _plain(label.latex) in taken:
            label = _verbatim(name)
        taken.add(_plain(label.latex))
        labels[name] = label.latex
    return labels


def symbol(name: str, labels: Mapping[str, str]) -> Label:
    """Return the label of a name, declared or made."""
    return _symbol(name, labels.get(name, ""))


@functools.lru_cache(maxsize=4096)
def _symbol(name: str, latex: str) -> Label:
    label = read_label(latex) if latex else None
    return _made(name) if label is None or label.width > WIDEST_LABEL else label


def _plain(latex: str) -> str:
    """Return a label without what does not show, to tell labels apart."""
    return re.sub(r"[{} ]|\\[,;:! ]", "", latex)


def _made(name: str) -> Label:
    stem, *parts = name.split("_")
    match = _STEM.fullmatch(stem)
    if match is None or not _NAME.fullmatch(name) or not all(parts):
        return _verbatim(name)
    subscripts = ",".join(map(_subscript, [*filter(None, (match[2],)), *parts]))
    label = read_label(_stem(match[1]) + (f"_{{{subscripts}}}" if subscripts else ""))
    if label is not None and match[1].islower():  # a word, and no product of letters
        label = replace(label, mathml=label.mathml.replace(' class="it"', ""))
    return label if label is not None and label.width <= WIDEST_LABEL else _verbatim(name)


def _stem(letters: str) -> str:
    if letters in (*_GREEK, "ell"):
        return f"\\{letters}"
    capitals = letters.lstrip(ascii_lowercase)
    if 0 < len(capitals) <= 2 and letters.removesuffix(capitals) in _GREEK:  # noqa: PLR2004
        return rf"\mathit{{\{letters.removesuffix(capitals)} {capitals}}}"  # a mass per length, rhoA
    return letters if len(letters) == 1 else rf"\mathit{{{letters}}}"


def _subscript(part: str) -> str:
    letters = part.rstrip("0123456789")
    number = part[len(letters) :]
    if letters in _GREEK:
        return f"\\{letters} {number}".rstrip()
    return part if len(letters) <= 1 or _INDICES.fullmatch(part) else rf"\mathrm{{{part}}}"


def _verbatim(name: str) -> Label:
    """Return a name in typewriter, stacked and small when it is long: this label always works."""
    text = name.replace("_", r"\_")
    if _NAME.fullmatch(name) and _typewriter_width(text) <= WIDEST_LABEL:
        return Label(rf"\mathtt{{{text}}}", always(_typewriter_width(text)), is_wordy=True)
    plain = re.sub(r"[^A-Za-z0-9_]", ".", name)
    pieces = [plain[i : i + _STACKED].replace("_", r"\_") for i in range(0, len(plain), _STACKED)]
    stacked = r"\\".join(rf"\scriptscriptstyle\mathtt{{{piece}}}" for piece in pieces)
    return Label(rf"\substack{{{stacked}}}", always(_stacked_width(stacked)), is_wordy=True)


def _stacked_width(latex: str) -> float:
    # An underscore is a rule that hardly shrinks.
    lines: list[str] = re.findall(r"\\mathtt\{([^}]*)\}", latex) or [""]
    return max(
        _TINY_SIZE * TYPEWRITER * len(line.replace(r"\_", "")) + _UNDERSCORE * line.count(r"\_")
        for line in lines
    )


def _typewriter_width(text: str) -> float:
    # An underscore in mathematics is a rule, half as wide again as a letter.
    return (len(text) - 0.5 * text.count(r"\_")) * TYPEWRITER


@functools.lru_cache(maxsize=4096)
def read_label(latex: str) -> Label | None:
    """Read a declared label; ``None`` when it would break a formula."""
    if _TYPEWRITER.fullmatch(latex):
        text = latex.removeprefix(r"\mathtt{").removesuffix("}")
        return Label(latex, always(_typewriter_width(text)), is_wordy=True)
    if _SMALL.fullmatch(latex):
        return Label(latex, always(_stacked_width(latex)), is_wordy=True)
    try:
        whole, _ = _read_list(latex, 0, _Font(ITALIC, ""), 0)
    except _UnsoundError:
        return None
    if not whole.atoms:
        return None
    marks = whole.has_superscript, whole.is_sum, whole.is_product or whole.atoms > 1
    return Label(latex, whole.size, whole.is_wordy, *marks, whole.subscript, whole.mathml())


_STACKED: Final = 22  # characters in a line of a stacked name
_TINY_SIZE: Final = 0.55
_UNDERSCORE: Final = 0.5

# What `_verbatim` writes of a proper name, sound by construction.
_TYPEWRITER: Final = re.compile(r"\\mathtt\{(?:[A-Za-z0-9]|\\_)+\}")
_SMALL: Final = re.compile(
    r"\\substack\{\\scriptscriptstyle\\mathtt\{(?:[A-Za-z0-9.]|\\_)+\}"
    r"(?:\\\\\\scriptscriptstyle\\mathtt\{(?:[A-Za-z0-9.]|\\_)+\})*\}"
)


class _UnsoundError(Exception):
    """The label would break a formula."""


class _Font(NamedTuple):
    """Letters of a font, and what MathML calls them."""

    letters: Alphabet
    style: str  # ``rm`` or a class; empty for italic letters, each a name of its own


@dataclass(slots=True)
class _Found:
    """What a list of atoms amounts to."""

    size: Width = NOTHING
    atoms: int = 0
    letters: int = 0
    is_wordy: bool = False
    has_superscript: bool = False
    is_sum: bool = False
    is_product: bool = False
    subscript: Width = NOTHING
    last: str = ""
    # MathML of atoms, each with what stands below and above it; primes are not in an element yet.
    parts: list[list[str]] = field(default_factory=list)
    word: str = ""  # letters of a font in a row, which are one name

    def add(self, size: Width) -> None:
        """Add the width of an atom."""
        self.size += size
        self.atoms += 1
        self.subscript = NOTHING
        self.last = ""

    def add_sign(self, sign: str, letters: Alphabet) -> None:
        """Add the width of a letter, digit or other sign."""
        if sign.isalnum():
            self.letters += sign.isalpha()
            self.add(letters.after(self.last, sign))
            self.last = sign
        else:
            self.is_sum |= sign in "+-=,|"
            self.is_product |= sign in "/*"
            self.add(_SIGN_SIZES[sign])

    def merge(self, inner: _Found) -> None:
        """Add a group as one atom of the list around it."""
        self.add(inner.size)
        self.letters += inner.letters
        self.is_wordy |= inner.is_wordy
        self.has_superscript |= inner.has_superscript
        self.is_sum |= inner.is_sum
        self.is_product |= inner.is_product
        self.mark(inner.mathml())

    def mark(self, element: str) -> None:
        """Add the element of an atom."""
        self.parts.append([element, "", ""])

    def end_word(self, style: str) -> None:
        """Make one name of the letters of a font before something else."""
        if self.word:
            self.mark(identifier(self.word, style))
            self.word = ""

    def mathml(self) -> str:
        """Return all atoms with their scripts as one element."""
        if not self.parts:
            return words("")
        parts = ((base, below, operator(x) if x.startswith("′") else x) for base, below, x in self.parts)
        return row(*starmap(with_scripts, parts))


DEEP: Final = frozenset("fgjpqyQβγζημξρϱςϕφχψ")
TALL: Final = frozenset("bdfhijklABCDEFGHIJKLMNOPQRSTUVWXYZβδζθϑλξϕψΓΔΘΛΞΠΣΥΦΨΩ")
"""Letters whose depth or height in the font of pages moves their scripts by more than 0.015 em."""
CLOSED: Final = tuple(f'stretchy="false">{sign}</mo></mrow>' for sign in ")]}")


def with_scripts(base: str, below: str, above: str) -> str:
    """Return an element with scripts, those of names and brackets at the same depth and height, as in TeX."""
    letter = base.partition(">")[2].removesuffix("</mi>") if base.startswith("<mi") else ""
    is_tall = (letter.isalpha() and not TALL.isdisjoint(letter)) or base.endswith(CLOSED)
    gone = ' depth="0"' * bool(below and letter in DEEP) + ' height="0"' * bool(above and is_tall)
    base = f"<mpadded{gone}>{base}</mpadded>" if gone else base
    if above and 'class="it"' in base:  # slanted letters lean into what stands above their end
        base = row(base, '<mspace width="0.12em"></mspace>')
    if below and above:
        return f"<msubsup>{base}{below}{above}</msubsup>"
    return f"<msub>{base}{below}</msub>" if below else f"<msup>{base}{above}</msup>" if above else base


def _mark_of(sign: str, style: str) -> str:
    """Return the element of a letter, digit or other sign that stands alone."""
    return identifier(sign, style) if sign.isalpha() else numeral(sign) if sign.isdigit() else operator(sign)


def _read_list(latex: str, start: int, font: _Font, depth: int) -> tuple[_Found, int]:
    """Read atoms up to the closing brace, or to the end at depth 0; return them and where reading goes on."""
    if depth > _DEEPEST:
        raise _UnsoundError
    parsed, position = _Found(), start
    # The scripts that the last atom bears; without an atom there is nothing to bear one.
    scripts: set[str] | None = None
    while position < len(latex):
        match = _TOKEN.match(latex, position)
        if match is None:
            raise _UnsoundError
        command, space, sign = match.groups()
        if sign and sign.isalpha() and font.style:
            parsed.word += sign
            parsed.add_sign(sign, font.letters)
            scripts, position = set(), match.end()
            continue
        parsed.end_word(font.style)
        if number := _NUMBER.match(latex, position):
            for digit in number[0]:
                parsed.add_sign(digit, font.letters)
            parsed.mark(numeral(number[0]))
            scripts, position = set(), number.end()
            continue
        position = match.end()
        if space:
            parsed.size += THIN_SIZES * 2
            parsed.subscript, parsed.last = NOTHING, ""
            parsed.mark('<mspace width="0.2em"></mspace>')
            scripts = None
        elif command or sign == "{":
            if command:
                inner, position = _read_command(latex, command, position, font, depth)
            else:
                inner, position = _read_list(latex, position, font, depth + 1)
            parsed.merge(inner)
            scripts = set()
        elif sign == "}":
            if not depth:
                raise _UnsoundError
            return parsed, position
        elif sign in "_^'":
            position = _read_script(latex, sign, position, parsed, scripts, font, depth)
        elif sign != " ":
            parsed.add_sign(sign, font.letters)
            parsed.mark(_mark_of(sign, font.style))
            scripts = set()
    if depth:
        raise _UnsoundError
    parsed.end_word(font.style)
    return parsed, position


def _read_script(
    latex: str, sign: str, position: int, parsed: _Found, scripts: set[str] | None, font: _Font, depth: int
) -> int:
    """Read what a script sign raises or lowers; a prime is a superscript and may be repeated."""
    if scripts is None or (sign in scripts and sign != "'") or {sign, *scripts} >= {"^", "'"}:
        raise _UnsoundError
    scripts.add(sign)
    parsed.has_superscript |= sign != "_"
    if sign == "'":
        # More primes stand beside the first, wherever a subscript ends.
        parsed.size += PRIME_SIZES + SCRIPT_SPACE
        parsed.subscript = NOTHING
        parsed.parts[-1][2] += "′"
        return position
    inner, position = _read_argument(latex, position, font, depth)
    size = inner.size.raised + SCRIPT_SPACE
    # Above or below the script that the atom bears already.
    parsed.size += size.beyond(parsed.subscript)
    parsed.subscript = size if sign == "_" else NOTHING
    parsed.is_wordy |= inner.is_wordy or inner.letters > 1
    parsed.parts[-1][1 if sign == "_" else 2] = inner.mathml()
    return position


def _read_argument(latex: str, start: int, font: _Font, depth: int) -> tuple[_Found, int]:
    """Read the one atom or group that a script or accent applies to."""
    match = _TOKEN.match(latex, start)
    if match is None:
        raise _UnsoundError
    command, _, sign = match.groups()
    parsed, position = _Found(), match.end()
    if sign == "{":
        parsed, position = _read_list(latex, position, font, depth + 1)
    elif command in _GREEK or command in _SYMBOLS:
        parsed, position = _read_command(latex, command, position, font, depth)
    elif sign and (sign.isalnum() or sign in "*+-"):
        parsed.add_sign(sign, font.letters)
        parsed.mark(_mark_of(sign, font.style))
    if not parsed.atoms:
        raise _UnsoundError
    return parsed, position


def _read_command(latex: str, command: str, position: int, font: _Font, depth: int) -> tuple[_Found, int]:
    parsed = _Found()
    if command in _GREEK:
        parsed.add(greek_width(command))
        parsed.mark(identifier(_GREEK[command], "rm" if _GREEK[command].isupper() else ""))
        return parsed, position
    if command in _SYMBOLS:
        parsed.add(OPERATOR_SIZES)
        parsed.is_sum = command in ("pm", "mp")
        parsed.is_product = command in ("cdot", "times")
        parsed.mark((identifier if command in _NAMES else operator)(_SYMBOLS[command]))
        return parsed, position
    if command in _ACCENTS:
        inner, position = _read_argument(latex, position, font, depth)
        parsed.add(inner.size + THIN_SIZES)
        parsed.is_wordy = inner.is_wordy
        over, accent = ("under" if command == "underline" else "over"), operator(_ACCENTS[command])
        attribute = 'accentunder="true"' if over == "under" else 'accent="true"'
        parsed.mark(f"<m{over} {attribute}>{inner.mathml()}{accent}</m{over}>")
        return parsed, position
    if command not in (*_FONTS, *_TEXT_FONTS) or latex[position : position + 1] != "{":
        raise _UnsoundError
    if command in _TEXT_FONTS:
        match = _TEXT.match(latex, position + 1)
        if match is None or latex[match.end() : match.end() + 1] != "}" or not match[0].strip():
            raise _UnsoundError
        # The wider of two fonts; text shrinks in scripts as letters do, at least.
        italic = TEXT_ITALIC.widths
        em = sum(max(ROMAN[c], italic[c].text if c in italic else 0.0) for c in match[0])
        em += TEXT_ITALIC.kern.text
        parsed.add(Width(em, _SCRIPT_TEXT * em, _TINY_TEXT * em))
        parsed.is_wordy = True
        parsed.mark(words(match[0], _TEXT_FONTS[command]))
        return parsed, match.end() + 1
    inner, position = _read_list(latex, position + 1, _FONTS[command], depth + 1)
    if not inner.atoms:
        raise _UnsoundError
    parsed.add(inner.size)
    parsed.letters = inner.letters
    parsed.is_wordy = inner.letters > 1
    parsed.mark(inner.mathml())
    return parsed, position


_FONTS: Final[dict[str, _Font]] = {
    "mathrm": _Font(UPRIGHT, "rm"),
    "operatorname": _Font(OTHER_ALPHABETS, "rm"),
    "mathit": _Font(TEXT_ITALIC, "it"),
    "mathbf": _Font(OTHER_ALPHABETS, "bf"),
    "boldsymbol": _Font(OTHER_ALPHABETS, "bf"),
    "mathsf": _Font(OTHER_ALPHABETS, "sf"),
    "mathcal": _Font(OTHER_ALPHABETS, "cal"),
}
_SIGN_SIZES: Final = (
    dict.fromkeys("+-", OPERATOR_SIZES)
    | {"=": RELATION_SIZES, ",": COMMA_SIZES, "*": STAR_SIZES, "/": SLASH_SIZES, ".": FENCE_SIZES[1]}
    | dict.fromkeys("()", FENCE_SIZES[0])
    | {"|": FENCE_SIZES[1]}
)
_SCRIPT_TEXT, _TINY_TEXT = 0.85, 0.7


def identifier(text: str, style: str = "") -> str:
    """Return a name: one letter italic by itself, several upright, unless a class says otherwise."""
    if style == "rm":
        attribute = ' mathvariant="normal"' if len(text) == 1 else ""
    else:
        attribute = f' class="{style}"' if style else ""
    return f"<mi{attribute}>{html.escape(text)}</mi>"


def numeral(text: str) -> str:
    """Return a number."""
    return f"<mn>{html.escape(text)}</mn>"


def operator(text: str, form: str = "") -> str:
    """Return an operator; a minus sign is one, not a hyphen."""
    attribute = f' form="{form}"' if form else ""
    return f"<mo{attribute}>{html.escape(text.replace('-', chr(0x2212)))}</mo>"


def words(text: str, style: str = "") -> str:
    """Return text inside mathematics."""
    attribute = f' class="{style}"' if style else ""
    return f"<mtext{attribute}>{html.escape(text)}</mtext>"


def row(*parts: str) -> str:
    """Return parts as one; a single element stays as it is."""
    return parts[0] if len(parts) == 1 else f"<mrow>{''.join(parts)}</mrow>"
