"""The statements of a netlist: lines joined and counted, included files, and subcircuits set apart.

Input: the text of a netlist, and how files beside it are read. Output: its title, its comments and its
statements, each with its place; subcircuits by name, each with the subcircuits that it can use.

    R1 in out          one statement, words ("R1", "in", "out", "10k")
    + 10k   ; film     its remark "film"

Everything that a circuit consists of after its expansion is counted, so that a short text that stands for a
large one is refused before it is expanded.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from symflex.errors import Diagnostic, Source, Span, SpecError

BRACKETS: Final = r"\((?:[^()]|\([^()]*\))*\)"
BRACES: Final = r"\{(?:[^{}]|\{[^{}]*\})*\}"
TOKEN: Final = re.compile(rf"{BRACES}|'[^']*'|\"[^\"]*\"|[\w/]+-?\s*{BRACKETS}|[^\s,=(){{}}'\"]+|=")
"""Words; brackets belong to one, as in V(out) and in KiCad's Net-(R1-Pad1)."""
ASSIGNED: Final = re.compile(r"([A-Za-z_]\w*)\s*=(?!=)")
QUOTED: Final = re.compile(rf"{BRACES}|'[^']*'|\"[^\"]*\"")
COMMENT: Final = re.compile(r"(;|(?:^|\s)\$(?!g_)|//)", re.I)  # $G_ begins a name of LTspice for a node
TITLE_LIKE: Final = re.compile(
    r"[RLC]\w*\s+\S+\s+\S+\s+[-+.\d{]\S*$|[VI]\w*\s+\S+\s+\S+\s+.*\bac\b|"
    r"\.(param|params|include|inc|lib|subckt|global|func|model|options?|temp|ac|print)\b",
    re.I,
)
"""First lines that would be missed if they were taken for the title, as every first line is."""
CHANGES: Final = re.compile(r"(alter\w*|option\s+temp|set\s+temp)\b", re.I)
MOST_DEPTH: Final = 20
MOST_LINES: Final = 20_000
INCLUDING: Final = (".include", ".inc", ".lib")
DEFINING: Final = frozenset((".model", ".param", ".params", ".func", *INCLUDING))


@dataclass(frozen=True)
class Card:
    """One statement, with its place."""

    words: tuple[str, ...]
    text: str
    span: Span
    comment: str

    def refuse(self, message: str, hint: str | None = None, code: str = "SF105") -> SpecError:
        """Return the error that says what is wrong with it."""
        return SpecError(Diagnostic(code, message, self.span, hint))

    def whole(self) -> Card:
        """Return it; SF105 where a bracket, a brace or a quote stands outside of every word."""
        is_free = self.keyword[0] in ".bx"  # what is assigned has a grammar of its own
        text = self.text.partition("=")[0] if is_free else self.text
        if odd := re.sub(r"[\s,]", "", TOKEN.sub("", text)):
            raise self.refuse(f"'{odd[0]}' is not read here", "close what it opens, or remove it")
        return self

    @property
    def keyword(self) -> str:
        """Its first word, in small letters."""
        return self.words[0].lower()

    def assigned(self) -> tuple[list[str], list[tuple[str, str]]]:
        """Return the words before the first ``A=1 B = 2*A``, and names with what is assigned to them.

        A value reaches up to the next name that something is assigned to.
        """
        hidden = QUOTED.sub(lambda quoted: "{" + "_" * (len(quoted[0]) - 2) + "}", self.text)
        marks = list(ASSIGNED.finditer(hidden))
        ends = [m.start() for m in marks[1:]] + [len(self.text)]
        values = [self.text[m.end() : end].strip(" \t,") for m, end in zip(marks, ends, strict=False)]
        if len(values) > 1 and (odd := next((v for v in values if re.search(r"\s", QUOTED.sub("", v))), "")):
            hint = "write it in braces, or in a line of its own"
            message = f"'{odd[:60]}' is not read: beside others, ngspice takes what stands before the blank"
            raise self.refuse(message, hint)
        before = TOKEN.findall(self.text[: marks[0].start()] if marks else self.text)
        words = [w for w in before if w.lower() not in ("params:", "param:")]
        return words, [(m[1], v) for m, v in zip(marks, values, strict=True)]

    def instance_of(self) -> str:
        """Return the subcircuit that a line X names, in small letters."""
        words, _ = self.assigned()
        return words[-1].lower() if words else ""

    def options(self, first: int) -> tuple[list[str], dict[str, list[str]]]:
        """Return the words from one on, and apart from them what is assigned, by names in small letters.

        Every name has one value, ``tc1=0.01``; ``tc`` may have two.
        """
        if self.words[-1] == "=":
            raise self.refuse(f"'{self.words[-2][:40]}' has no value")
        words = [*self.words[first:], ""]
        plain: list[str] = []
        given: dict[str, list[str]] = {}
        while words[0]:
            if words[1] == "=" and len(words) > 3:  # noqa: PLR2004 (a name, the sign, a value, the end)
                key, values, words = words[0].lower(), words[2:3], words[3:]
                if key == "tc" and words[0] and words[1] != "=" and not words[0][0].isalpha():
                    values, words = [*values, words[0]], words[1:]
                given[key] = values
            else:
                plain += [words[0]] * (words[0] != "=")
                words = words[1:]
        return plain, given


@dataclass(frozen=True)
class Subcircuit:
    """What stands between .subckt and .ends, and the subcircuits known there."""

    head: Card
    body: Sequence[Card]
    known: Mapping[str, Subcircuit]


@dataclass
class Deck:
    """Reads the statements of a netlist and of the files that it includes, and counts them."""

    source: Source
    read: Callable[[str], Source]
    lines: int = 0
    comments: list[str] = field(default_factory=list)

    def count(self, number: int, card: Card | None = None) -> None:
        """Count lines; SF103 when a netlist becomes longer than any is meant to be."""
        self.lines += number
        if self.lines > MOST_LINES:
            hint = "leave out what is not needed, or split the circuit"
            expanded = " with all that it includes and repeats" if card else ""
            message = f"a netlist has at most {MOST_LINES} lines{expanded}"
            raise SpecError(Diagnostic("SF103", message, card.span if card else None, hint))

    def title_and_cards(self) -> tuple[str, list[Card]]:
        """Return the first line, which is the title, and the statements."""
        source = self.source
        first = (source.text.splitlines(keepends=True) or [""])[0]
        title = first.strip()
        if TITLE_LIKE.match(title):
            hint = "SPICE takes the first line for the title: begin with one, or with a line '*'"
            message = "the first line looks like a statement and would be left out"
            raise SpecError(Diagnostic("SF105", message, Span(source, 0, len(title)), hint))
        return title.lstrip("*").strip(), self._cards(source, len(first))

    def _cards(self, source: Source, offset: int = 0) -> list[Card]:
        """Return the statements from this place on, with continuations joined."""
        statements: list[tuple[str, int, int, str]] = []
        is_control, is_over = False, False
        lines = source.text[offset:].splitlines(keepends=True)
        self.count(len(lines))
        for line in lines:
            start, offset = offset, offset + len(line)
            text = line.strip()
            first = start + len(line) - len(line.lstrip())
            location = Span(source, first, first + len(text))
            if text.startswith("*") or not text:
                if text.strip("* "):
                    self.comments.append(text.strip("* "))
                continue
            if is_control or re.match(r"\.control\b", text, re.I):
                is_control = not re.match(r"\.endc\b", text, re.I)
                if CHANGES.match(text):
                    hint = "write the value where the circuit is described, or remove the line"
                    message = f"'{text[:60]}' changes the circuit, and commands are left out"
                    raise SpecError(Diagnostic("SF105", message, location, hint))
                continue
            code, _, comment = (*COMMENT.split(text, maxsplit=1), "", "")[:3]
            if not code.strip():
                continue
            if is_over:
                hint = "remove it, or .end"
                message = "this stands after .end: ngspice reads it, other simulators do not"
                raise SpecError(Diagnostic("SF105", message, location, hint))
            if re.match(r"\.end\b", code, re.I):
                is_over = True
            elif code.startswith("+") and statements:
                before, begin, _, remark = statements[-1]
                statements[-1] = (f"{before} {code[1:]}", begin, location.end, remark or comment.strip())
            else:
                statements.append((code.strip(), first, first + len(code.strip()), comment.strip()))
        cards = []
        for code, begin, end, comment in statements:
            plain = code
            if code[:1].upper() in "RLCKTEFGH":  # nodes and values may be in brackets
                plain = re.sub(r"(?<=\s)\(([^(){}'=]*)\)", r" \1 ", code)
            if words := TOKEN.findall(plain):
                cards.append(Card(tuple(words), plain, Span(source, begin, end), comment))
        return cards

    def expanded(self, subcircuit: Subcircuit, known: dict[int, int], depth: int = 0) -> int:
        """Return how many lines an instance stands for, before any is expanded.

        ``known`` has those found, by their heads. Files that it includes are counted when they are read.
        """
        head = subcircuit.head
        if depth >= MOST_DEPTH:
            raise head.refuse("subcircuits contain each other")
        if id(head) not in known:
            direct = [c for c in subcircuit.body if c.keyword not in INCLUDING]
            body, inner = self.split(direct, subcircuit.known)
            placed = (inner.get(c.instance_of()) for c in body if c.keyword[0] == "x")
            known[id(head)] = len(direct) + sum(
                self.expanded(s, known, depth + 1) for s in placed if s is not None
            )
        return known[id(head)]

    def split(
        self, cards: Sequence[Card], known: Mapping[str, Subcircuit], depth: int = 0
    ) -> tuple[list[Card], dict[str, Subcircuit]]:
        """Return the statements outside of subcircuits, included files among them, and all subcircuits."""
        subcircuits: dict[str, Subcircuit] = dict(known)
        return list(self._outside(cards, subcircuits, set(), depth)), subcircuits

    def _outside(
        self, cards: Sequence[Card], subcircuits: dict[str, Subcircuit], defined: set[str], depth: int
    ) -> Iterator[Card]:
        inner: list[Card] = []
        head: Card | None = None
        level = 0
        for card in cards:
            word = card.keyword
            if word in (".subckt", ".macro"):
                level += 1
                if level == 1:
                    head, inner = card, []
                    continue
            if word in (".ends", ".eom") and level:
                level -= 1
                if level == 0 and head is not None and len(head.words) > 1:
                    self._define(Subcircuit(head, inner, subcircuits), subcircuits, defined)
                    continue
            if level:
                inner.append(card)
            elif word in INCLUDING:
                yield from self._outside(self._included(card, depth), subcircuits, defined, depth + 1)
            else:
                yield card
        if level and head is not None:
            raise head.refuse("this subcircuit has no .ends", "close it with a line .ends")

    def _define(self, new: Subcircuit, subcircuits: dict[str, Subcircuit], defined: set[str]) -> None:
        """Add a subcircuit; the same text twice, as in a file that is included twice, is one."""
        name = new.head.words[1].lower()
        if name in defined and [c.words for c in subcircuits[name].body] != [c.words for c in new.body]:
            raise new.head.refuse(f"there are two subcircuits '{name[:60]}'", "rename or remove one of them")
        if name not in defined:
            subcircuits[name] = new
            defined.add(name)

    def _included(self, card: Card, depth: int) -> list[Card]:
        """Return the statements of a file; .lib without a section only defines, and may be missing."""
        is_library = card.keyword == ".lib"
        if depth >= MOST_DEPTH or len(card.words) < 2:  # noqa: PLR2004
            raise card.refuse("files include each other" if depth else "a file's name is missing")
        name = card.words[1].strip("\"'")
        section = card.words[2].lower() if is_library and len(card.words) > 2 else ""  # noqa: PLR2004
        try:
            source = self._beside(card, name)
        except SpecError as error:
            if is_library and not section:
                return []
            raise card.refuse(f"'{name[:80]}' is not included: {error.diagnostics[0].message}") from None
        before, self.comments = self.comments, []
        cards = self._cards(source)
        self.comments = before  # those of a library do not speak of the circuit
        if section:
            return _section(card, cards, section)
        return _defining(cards) if is_library else cards

    def _beside(self, card: Card, name: str) -> Source:
        """Read a file by its name seen from the netlist, or else from the file that includes it."""
        including = card.span.source
        folder = "" if including is self.source else posixpath.dirname(including.name)
        try:
            return self.read(name)
        except SpecError:
            if not folder:
                raise
            return self.read(posixpath.join(folder, name))


def _section(card: Card, cards: Sequence[Card], name: str) -> list[Card]:
    """Return what stands between ``.lib name`` and ``.endl``."""
    found: list[Card] = []
    inside = ""
    is_there = False
    for each in cards:
        if not inside and each.keyword == ".lib" and len(each.words) == 2:  # noqa: PLR2004
            inside = each.words[1].lower()
            is_there |= inside == name
        elif each.keyword == ".endl":
            inside = ""
        elif inside == name:
            found.append(each)
    if not is_there:
        raise card.refuse(f"the library has no section '{name[:60]}'")
    return found


def _defining(cards: Sequence[Card]) -> list[Card]:
    """Return what only defines: subcircuits, models, parameters, functions."""
    kept: list[Card] = []
    level = 0
    for card in cards:
        level += card.keyword in (".subckt", ".macro")
        if level or card.keyword in DEFINING:
            kept.append(card)
        level -= card.keyword in (".ends", ".eom") and level > 0
    return kept
