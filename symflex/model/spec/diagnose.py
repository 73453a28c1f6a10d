"""Say what is wrong with a statement in the words of someone who writes models.

tomllib says *that* a statement is wrong and about where; here its text is looked at for the mistakes
people make, so that the message shows what was found and the hint what to write.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Callable

from symflex.errors import Diagnostic, Source, Span
from symflex.model.spec.scan import KEY, Scan, Statement
from symflex.quantities import name_hint

_TWICE = ("Cannot declare", "Cannot mutate", "Cannot overwrite", "Duplicate")
_ASSIGNMENT = re.compile(rf"[ \t]*+({KEY})[ \t]*+(=|:|(?=[^\s]))")
_HEADER = re.compile(rf"(\[\[?)[ \t]*+({KEY})[ \t]*+(\]\]?)")
_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f]")
_ESCAPES = {
    "Escaped character": r"\\[uU][0-9A-Fa-f]*",
    "Unescaped": r"\\(?![btnfr\"\\uU])",
    "Invalid hex": r"\\[uU]",
}
"""The escapes that messages of tomllib are about, by how these begin."""
_STRING_OR_COMMENT = re.compile(r"""("(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')|\#[^\n]*+""")
_INLINE_COMMENT = re.compile(r"[ \t]*+\#[^\n]*+$")
FOREIGN_COMMENTS = ("%", "//", ";", "--", "/*")  # how comments begin in MATLAB, C, Lua and files of settings
_SHOWN = 40


def diagnose_unclosed(source: Source, text: str, statement: Statement) -> Diagnostic:
    """Return the diagnostic of a statement with a quote or bracket that is never closed."""
    start = statement.start if statement.unclosed is None else statement.unclosed
    mark = text[start]
    if mark not in "\"'":
        close = "]" if mark == "[" else "}"
        message = f"the bracket '{mark}' opened here is never closed"
        return Diagnostic("SF101", message, Span(source, start, start + 1), f"add the closing '{close}'")
    quote = mark * 3 if text.startswith(mark * 3, start) else mark
    line = text[start : statement.end].partition("\n")[0].rstrip()
    message = f"the string opened here is never closed: {_shown(line)}"
    hint = f"add the closing quote: {quote}"
    if mark in text[statement.start : start].rpartition("\n")[2]:
        hint = f"a closing {quote} is missing, here or before it in this line"
    return Diagnostic("SF101", message, Span(source, start, start + len(line)), hint)


def diagnose_toml(source: Source, scan: Scan, statement: Statement, message: str, offset: int) -> Diagnostic:
    """Return the diagnostic of a statement tomllib refuses: SF102 when it is there twice, else SF101."""
    text = scan.text
    if message.startswith(_TWICE):
        return _twice(source, scan, statement, message)
    location = Span(source, offset, min(offset + 1, len(text)))
    if control := _CONTROL.match(text, offset):
        return Diagnostic("SF101", f"control character U+{ord(control[0]):04X}", location, "remove it")
    if statement.header:
        return _bad_header(source, text, statement)
    if statement.equals is None or offset <= statement.equals:
        return _bad_key(source, text, statement)
    return _bad_value(source, text, statement, message, offset)


def _twice(source: Source, scan: Scan, statement: Statement, message: str) -> Diagnostic:
    text = scan.text
    name, start = _name(text, statement)
    span = Span(source, start, start + len(name))
    if message.startswith("Duplicate"):
        key = message.rpartition("key ")[2]
        message = f"the key {key} appears twice in an inline table"
        return Diagnostic("SF102", message, _value_span(source, text, statement))
    first = _first(scan, statement, name)
    if first is None:
        what = "table" if statement.header else "key"
        hint = "it is in an inline table, or already has a value; write it there"
        message = f"{what} '{_cut(name)}' cannot be added to what is defined above"
        return Diagnostic("SF102", message, span, hint)
    hint = f"it is first defined in line {Span(source, first.start, first.end).line}"
    shown = f"table [{_cut(name)}]" if statement.header else f"key '{_cut(name)}'"
    return Diagnostic("SF102", f"{shown} is defined twice", span, hint)


def _first(scan: Scan, statement: Statement, name: str) -> Statement | None:
    """Return the first statement of the same name; for a key, under the same header."""
    first = None
    for earlier in reversed(
        scan.statements[: bisect_left(scan.statements, statement.start, key=lambda each: each.start)]
    ):
        if earlier.header == statement.header and _name(scan.text, earlier)[0] == name:
            first = earlier
        if earlier.header and not statement.header:
            break
    return first


def _value_span(source: Source, text: str, statement: Statement) -> Span:
    """Return the place of the value, without white space and comment."""
    after = (statement.start if statement.equals is None else statement.equals) + 1
    written = _STRING_OR_COMMENT.sub(lambda match: match[1] or "", text[after : statement.end])
    start = after + len(written) - len(written.lstrip())
    return Span(source, start, start + len(written.strip()))


def _name(text: str, statement: Statement) -> tuple[str, int]:
    """Return the key of a statement as it is written, and its offset."""
    match = (_HEADER if statement.header else _ASSIGNMENT).match(text, statement.start, statement.end)
    if match is None:
        return text[statement.start : statement.end], statement.start
    group = 2 if statement.header else 1
    return match[group], match.start(group)


def _bad_header(source: Source, text: str, statement: Statement) -> Diagnostic:
    header = _INLINE_COMMENT.sub("", text[statement.start : statement.end]).rstrip()
    span = Span(source, statement.start, statement.start + len(header))
    hint = (
        "a header is [name] or [name.name]; quote a name with other characters than letters, digits, _ and -"
    )
    match = _HEADER.match(header)
    if not header.startswith("["):
        hint = "begin it with '['"
    elif match and match.end() < len(header):
        hint = f"begin a new line after {match[0]}"
    return Diagnostic("SF101", f"{_shown(header)} is not a table header", span, hint)


def _bad_key(source: Source, text: str, statement: Statement) -> Diagnostic:
    end = statement.end if statement.equals is None else statement.equals
    key = text[statement.start : end].rstrip()
    match = _ASSIGNMENT.match(key)
    if statement.equals is not None:
        if not key:
            message, hint = "no key before '='", "write key = value"
        else:
            quoted = key.replace("\\", "\\\\").replace('"', '\\"')
            message = f"{_shown(key)} is not a key"
            hint = name_hint(key) or f'put it in quotes: "{_cut(quoted)}"'
    elif match and match[2] == ":":
        message = f"expected '=' after the key {_shown(match[1])}, found ':'"
        colon = statement.start + match.start(2)
        return Diagnostic("SF101", message, Span(source, colon, colon + 1), "write '=' instead of ':'")
    else:
        key = _INLINE_COMMENT.sub("", key.partition("\n")[0]).rstrip()
        message = f"{_shown(key)} is neither key = value nor a [table]"
        is_comment = key.startswith(FOREIGN_COMMENTS)
        hint = "a comment begins with '#'" if is_comment else "write '=' between key and value"
    width = max(1, len(key.partition("\n")[0]))
    return Diagnostic("SF101", message, Span(source, statement.start, statement.start + width), hint)


def _bad_value(source: Source, text: str, statement: Statement, message: str, offset: int) -> Diagnostic:
    value_span = _value_span(source, text, statement)
    value = text[value_span.start : value_span.end]
    equals = value_span.start if statement.equals is None else statement.equals
    if not value:
        hint = 'write a number, or text in quotes: "..."'
        return Diagnostic("SF101", "no value after '='", Span(source, equals, equals + 1), hint)
    location = Span(source, offset, min(offset + 1, len(text)))
    if value.startswith("="):
        return Diagnostic(
            "SF101", "found '=='", Span(source, equals, value_span.start + 1), "write a single '='"
        )
    if escape := _escape(text, statement, message, offset):
        hint = "write the text between single quotes '...', where a backslash is itself, or double it: \\\\"
        shown = text[escape[0] : escape[1]]
        return Diagnostic("SF101", f"{_shown(shown)} is not an escape sequence", Span(source, *escape), hint)
    if value[0] in "\"'":
        message = f"unexpected text after the value: {_shown(text[offset : value_span.end])}"
        location = Span(source, offset, max(offset + 1, value_span.end))
        return Diagnostic("SF101", message, location, "one key a line")
    if value[0] not in "[{":
        said, hint = _bad_scalar(value)
        return Diagnostic("SF101", said, value_span, hint)
    return _bad_collection(source, text, value_span, message, location)


def _escape(text: str, statement: Statement, message: str, offset: int) -> tuple[int, int] | None:
    """Return where the escape stands that a message of tomllib is about, None if it is about another."""
    escape = next((escape for begins, escape in _ESCAPES.items() if message.startswith(begins)), None)
    if escape is None:
        return None
    # tomllib points behind the backslash, by a distance that depends on the escape.
    places = re.compile(escape).finditer(text, max(statement.start, offset - 12), offset + 1)
    starts = [match.start() for match in places]
    return (starts[-1], min(starts[-1] + 2, statement.end)) if starts else None


def _bad_scalar(written: str) -> tuple[str, str]:
    for applies, hint in _SCALAR_HINTS:
        if applies(written):
            return f"{_shown(written)} is not a value", hint(written)
    return f"{_shown(written)} is neither a number nor quoted text", f"put it in quotes: {_quoted(written)}"


def _quoted(written: str) -> str:
    shown = _cut(written)
    return f"'{shown}'" if '"' in shown or "\\" in shown else f'"{shown}"'


def _matches(pattern: str) -> Callable[[str], bool]:
    compiled = re.compile(pattern)
    return lambda written: compiled.fullmatch(written) is not None


_DIGITS = r"[+-]?[0-9]++"
_EXPONENT = r"(?:[eE][+-]?[0-9]++)?"
_SCALAR_HINTS: tuple[tuple[Callable[[str], bool], Callable[[str], str]], ...] = (
    (lambda f: f.lower() in {"true", "yes", "on"}, lambda f: "write true"),
    (lambda f: f.lower() in {"false", "no", "off"}, lambda f: "write false"),
    (lambda f: f.lower() in {"none", "null", "nil"}, lambda f: "leave the key out"),
    (_matches(r"[\u201c\u201d\u201e\u2018\u2019\u00ab].*"), lambda f: 'write straight quotes: "'),
    (_matches(rf"{_DIGITS},[0-9]++"), lambda f: f"write a decimal point: {_cut(f.replace(',', '.'))}"),
    (
        _matches(r"[\u2010-\u2015\u2212][0-9.]++.*"),
        lambda f: f"write '-' for U+{ord(f[0]):04X}: {_cut('-' + f[1:])}",
    ),
    (_matches(rf"[+-]?\.[0-9]++{_EXPONENT}"), lambda f: f"begin with a digit: {_cut(f.replace('.', '0.'))}"),
    (
        _matches(rf"{_DIGITS}\.{_EXPONENT}"),
        lambda f: f"put a digit after the point: {_cut(f.replace('.', '.0'))}",
    ),
    (_matches(r"[+-]?0[0-9]++(?:\.[0-9]++)?"), lambda f: "write it without leading zeros"),
)


def _bad_collection(source: Source, text: str, collection: Span, message: str, location: Span) -> Diagnostic:
    if text[collection.start] == "{":
        if location.text in {"\n", "\r", ""} and location.start < collection.end:
            hint = "write it on one line, or as a table with its own [header]"
            return Diagnostic(
                "SF101", "an inline table must end on the line where it begins", collection, hint
            )
        if location.text == "}":
            message = "an inline table has no comma before its '}'"
            return Diagnostic("SF101", message, location, "remove the comma")
    if location.start >= collection.end or not location.text.strip():
        return Diagnostic("SF101", message[:1].lower() + message[1:], collection)
    word = re.compile(r"[^\s,\[\]{}=#]*+").match(text, location.start)
    written = word[0] if word and word[0] else location.text
    span = Span(source, location.start, location.start + len(written))
    if message.startswith("Invalid value"):
        said, hint = _bad_scalar(written)
        return Diagnostic("SF101", said, span, hint)
    if message.startswith("Unclosed"):
        closing = "]" if message.endswith("array") else "}"
        number = re.search(r"=\s*([-+.\d]+)\s*$", text[: location.start])
        cure = f'put a quantity in quotes: "{number[1]} {_cut(written)}"' if number else None
        return Diagnostic("SF101", f"expected ',' or '{closing}', found {_shown(written)}", span, cure)
    return Diagnostic("SF101", f"unexpected {_shown(written)}: {message[:1].lower()}{message[1:]}", span)


def _cut(text: str) -> str:
    return text if len(text) <= _SHOWN else text[:_SHOWN] + "..."


def _shown(text: str) -> str:
    """Return user text for a message: on one line, cut, quoted unless it brings its quotes."""
    text = _cut(text.partition("\n")[0].rstrip())
    return text if text[:1] in {'"', "'"} else f"'{text}'"
