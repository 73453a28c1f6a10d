"""Parsing by the tables of a grammar, without the program that makes them.

Lark reads a grammar and makes an LALR(1) table of it, which takes as long as deriving a small model does. So
the tables are made beforehand and kept in ``grammar.json`` beside a grammar (``python -m tests.tools.tables``
after a change; a test compares them). A rule is reduced as Lark does it: by calling the method of its name.

Example: ``2 kg`` by the grammar of quantities.

    words       NUMBER "2"          SYMBOL "kg"
    reduced     number("2")         symbol("kg"), first_factor, group, quantity(...)
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Sequence, Set
from pathlib import Path
from typing import Any, Final

END: Final = "$END"


class Token(str):
    """A word of the text."""

    __slots__ = ("start", "type", "value")

    type: str  # its terminal
    start: int  # where it begins in the text
    value: object  # what a caller wants its callbacks to know

    def __new__(cls, kind: str, text: str, start: int) -> Token:
        """Make a word of a terminal."""
        made = super().__new__(cls, text)
        made.type, made.start, made.value = kind, start, text
        return made

    @property
    def end(self) -> int:
        """Where what follows it begins."""
        return self.start + len(self)


class UnexpectedError(Exception):
    """The text cannot go on as it does."""

    def __init__(self, start: int, token: Token | None, expected: frozenset[str]) -> None:
        super().__init__(start)
        self.start = start  # an offset in the text
        self.token = token  # what stands there; None if no word of the language begins
        self.expected = expected  # the terminals that could stand there


class Grammar:
    """The tables of one grammar, and the methods that build what its rules stand for.

    The builder has one method per rule, which takes what the parts of the rule stand for. In a contextual one
    a character is read as what can stand there, where several terminals begin with it.
    """

    def __init__(self, path: Path, builder: object, *, is_contextual: bool) -> None:
        table = json.loads(path.read_text(encoding="utf-8"))
        self.starts: dict[str, tuple[int, int]] = table["starts"]
        self.states: list[dict[str, int]] = table["states"]
        # Per rule: its name, how many parts it has, which of them are handed on and which of these are lists.
        # What makes the value of a rule without a name is None: its parts are one list.
        self.rules: list[tuple[str, int, Sequence[tuple[int, bool]], Callable[..., Any] | None]] = [
            (origin, size, parts, _callback(builder, name, is_single=is_single))
            for origin, size, parts, name, is_single in table["rules"]
        ]
        self._terminals = {name: re.compile(pattern) for name, pattern in table["terminals"].items()}
        self._ignored = frozenset(table["ignored"])
        self._is_contextual = is_contextual

    def word(self, text: str, start: int, state: int) -> Token | None:
        """Return the word that begins at an offset, or behind what is ignored there; none at the end."""
        kept = self.states[state].keys() | self._ignored if self._is_contextual else self._terminals.keys()
        while start < len(text):
            token = self._first(text, start, kept)
            if token is None:
                other = self._first(text, start, self._terminals.keys())
                raise UnexpectedError(start, other, self.expected(state))
            if token.type not in self._ignored:
                return token
            start = token.end
        return None

    def _first(self, text: str, start: int, kept: Set[str]) -> Token | None:
        """Return the first of some terminals that begins at an offset."""
        for name, pattern in self._terminals.items():
            if name in kept and (match := pattern.match(text, start)):
                return Token(name, match[0], start)
        return None

    def expected(self, state: int) -> frozenset[str]:
        """Return the terminals that can stand in a state."""
        return frozenset(name for name in self.states[state] if name.isupper())


def _callback(builder: object, name: str, *, is_single: bool) -> Callable[..., Any] | None:
    """Return what makes the value of a rule: one part is handed on as it is."""
    if not name:
        return None
    made = getattr(builder, name, lambda *parts: parts)
    return (lambda *parts: parts[0] if len(parts) == 1 else made(*parts)) if is_single else made


class Reading:
    """One text on its way through the tables of a grammar."""

    def __init__(self, grammar: Grammar, text: str, start: str) -> None:
        self._grammar, self._text = grammar, text
        first, self._last = grammar.starts[start]
        self._states = [first]
        self.values: list[Any] = []

    def words(self) -> Iterator[Token]:
        """Yield each word before it is read; UnexpectedError where the text is not of the language."""
        place = 0
        while token := self._grammar.word(self._text, place, self._states[-1]):
            yield token
            self._feed(token)
            place = token.end

    def end(self) -> Any:  # noqa: ANN401 - what the builder makes
        """Return what the text stands for, when all its words are read."""
        self._feed(Token(END, "", len(self._text)))
        return self.values[-1]

    def _feed(self, token: Token) -> None:
        states, values = self._states, self.values
        while True:
            action = self._grammar.states[states[-1]].get(token.type)
            if action is None:
                raise UnexpectedError(token.start, token, self._grammar.expected(states[-1]))
            if action >= 0:
                states.append(action)
                values.append(token)
                return
            origin, size, kept, made = self._grammar.rules[~action]
            parts = values[-size:]
            del states[-size:], values[-size:]
            handed: list[Any] = []
            for i, is_list in kept:
                if not is_list:
                    handed.append(parts[i])
                elif handed:
                    handed.extend(parts[i])
                else:
                    handed = parts[i]  # nobody else has it, and a long sum is not to be copied at every term
            values.append(handed if made is None else made(*handed))
            states.append(self._grammar.states[states[-1]][origin])
            if token.type == END and states[-1] == self._last:
                return
