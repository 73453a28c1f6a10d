"""From text to :class:`Spec`: all syntax errors of a text at once, and what is right of it.

Input: a source. Output: the spec. tomllib says what is TOML and what it means; at an error the
statement it stands in is replaced by a stand-in and tomllib goes on.
"""

from __future__ import annotations

import re
import tomllib
from bisect import bisect_right
from dataclasses import dataclass, field
from typing import Any

from symflex.errors import Diagnostic, Source, Span, SpecError
from symflex.model.spec.positions import Document, Literal, Spec, decode_key, locate
from symflex.model.spec.read import MAX_ERRORS
from symflex.model.spec.scan import KEY, KEY_PART, Scan, Statement, scan

_PLACE = r"(.*) \(at (?:line (\d+), column (\d+)|end of document)\)"
_HEADER_PATH = rf"\[{{0,2}}[ \t]*+({KEY})"


def parse(source: Source) -> Spec:
    """Parse a specification: TOML 1.0; SF101, SF102 for at most 20 errors, or SF103 beyond a limit."""
    spec, diagnostics = parse_with_recovery(source)
    if diagnostics:
        raise SpecError(*diagnostics)
    return spec


def parse_with_recovery(source: Source) -> tuple[Spec, tuple[Diagnostic, ...]]:
    """Parse what is right of a specification, and report what is not, in the order of the text."""
    # A key whose value is wrong keeps an ``OtherValue("invalid", ...)``, so that its name is still known;
    # under a header that is wrong or repeated, entries go to the table it seems to name. Raises SpecError:
    # SF103 when the text passes a limit; nothing is then kept of it.
    scanned = scan(source)
    repair = _Repair(source, scanned)
    for statement in scanned.statements:
        if statement.unclosed is not None:
            from symflex.model.spec.diagnose import diagnose_unclosed  # most texts are TOML

            repair.report(statement, diagnose_unclosed(source, scanned.text, statement))
    decoded = repair.decode()
    document = repair.document()
    diagnostics = sorted(repair.diagnostics, key=lambda d: d.span.start if d.span else 0)
    return Spec(source, locate(document, decoded)), tuple(diagnostics[:MAX_ERRORS])


@dataclass(slots=True)
class _Repair:
    """The stand-ins of a text, each with the statement whose part it replaces."""

    source: Source
    scan: Scan
    diagnostics: list[Diagnostic] = field(default_factory=list)
    edits: dict[int, tuple[int, str]] = field(default_factory=dict)
    edited: set[int] = field(default_factory=set)
    invalid: dict[int, Span] = field(default_factory=dict)
    adopted: dict[str, tuple[str, ...]] = field(default_factory=dict)

    def report(self, statement: Statement, diagnostic: Diagnostic, offset: int | None = None) -> None:
        """Keep a diagnostic and put a stand-in where the error is; at a second error, blank the statement."""
        self.diagnostics.append(diagnostic)
        again = statement.start in self.edited
        self.edited.add(statement.start)
        self.edits.pop(statement.start, None)
        if statement.equals is not None:
            self.edits.pop(statement.equals + 1, None)
        offset = statement.unclosed if offset is None else offset
        if statement.header and not again:
            name = f"stand-in-{len(self.adopted)}"
            while name in self.scan.text:
                name += "-"
            self.adopted[name] = self._path(statement)
            self.edits[statement.start] = (statement.end, f"[{name}]")
        elif (
            again
            or statement.equals is None
            or (offset or 0) <= statement.equals
            or diagnostic.code == "SF102"
        ):
            self.edits[statement.start] = (statement.end, "")
        else:
            value = self.scan.text[statement.equals + 1 : statement.end]
            start = statement.equals + 1 + len(value) - len(value.lstrip())
            self.invalid[statement.equals + 1] = Span(self.source, start, start + len(value.strip()))
            self.edits[statement.equals + 1] = (statement.end, "0")

    def _path(self, statement: Statement) -> tuple[str, ...]:
        match = re.compile(_HEADER_PATH).match(self.scan.text, statement.start, statement.end)
        if match is None or self.scan.text.startswith("[[", statement.start):
            return ()
        try:
            return tuple(decode_key(part) for part in re.findall(KEY_PART, match[1]))
        except tomllib.TOMLDecodeError:
            return ()

    def decode(self) -> dict[str, Any]:
        """Return what tomllib makes of the text after as many stand-ins as it takes."""
        while True:
            document = self.document()
            try:
                return tomllib.loads(document.text, parse_float=Literal)
            except tomllib.TOMLDecodeError as error:
                message, offset = _place(error, document)
            statement = self._at(offset)
            from symflex.model.spec.diagnose import diagnose_toml  # most texts are TOML

            self.report(statement, diagnose_toml(self.source, self.scan, statement, message, offset), offset)
            # tomllib goes forward: no error before this one is still to be found.
            if sum(d.span.start <= offset for d in self.diagnostics if d.span) >= MAX_ERRORS:
                self._cut(statement.start)

    def _at(self, offset: int) -> Statement:
        """Return the statement an error stands in, or a stand-in for the rest of the comment it stands in."""
        statements = self.scan.statements
        following = bisect_right(statements, offset, key=lambda statement: statement.start)
        if following and (offset <= statements[following - 1].end or offset >= len(self.scan.text)):
            return statements[following - 1]
        line = self.scan.text.find("\n", offset)
        ends = [len(self.scan.text) if line < 0 else line]
        ends += [statement.start for statement in statements[following : following + 1]]
        return Statement(offset, min(ends), header=False, equals=None, unclosed=None)

    def _cut(self, start: int) -> None:
        self.edits = {at: edit for at, edit in self.edits.items() if at < start}
        self.edits[start] = (len(self.scan.text), "")

    def document(self) -> Document:
        """Return the text with its stand-ins."""
        text, masked, here, there = [], [], [0], [0]
        done = length = 0
        for start, (end, stand_in) in sorted(self.edits.items()):
            text += [self.scan.text[done:start], stand_in]
            masked += [self.scan.masked[done:start], stand_in]
            length += start - done
            here += [length, length + len(stand_in)]
            there += [start, end]
            length += len(stand_in)
            done = end
        text.append(self.scan.text[done:])
        masked.append(self.scan.masked[done:])

        def origin(offset: int) -> int:
            piece = bisect_right(here, offset) - 1
            # Odd pieces are stand-ins: all of one stands where what it replaces begins.
            return there[piece] + (0 if piece % 2 else offset - here[piece])

        return Document(self.source, "".join(text), "".join(masked), origin, self.invalid, self.adopted)


def _place(error: tomllib.TOMLDecodeError, document: Document) -> tuple[str, int]:
    match = re.fullmatch(_PLACE, str(error), re.DOTALL)
    if match is None:
        return str(error), document.origin(len(document.text))
    offset = len(document.text)
    if match[2]:
        offset = 0
        for _ in range(int(match[2]) - 1):
            offset = document.text.index("\n", offset) + 1
        offset += int(match[3]) - 1
    return match[1], document.origin(offset)
