"""What may be written at a place of a specification: keys, types, names and units.

Input: a document and an offset. Output: completions, the keys and types with what the schema says of them.
The place is read from the text before it, since a line that is being typed is not yet TOML.

    In [elements], after ``arm = { type = "bea``: beam and its relatives; after ``between = ["``: the nodes.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Literal

from symflex.editor.document import NODE_KEYS, OpenDocument
from symflex.expressions import FUNCTIONS
from symflex.model.schema import Schema, json_schema
from symflex.model.spec.scan import KEY, KEY_PART
from symflex.quantities.units import UNITS

_HEADER = re.compile(rf"^[ \t]*\[\[?[ \t]*({KEY})[ \t]*\]", re.MULTILINE)
_ASSIGNED = re.compile(rf"^[ \t]*({KEY})[ \t]*=[ \t]*", re.MULTILINE)
_INNER = re.compile(rf"[{{,][ \t\n]*({KEY_PART})[ \t]*=[ \t]*(?:\[[^\]]*|\"[^\"\n]*|'[^'\n]*|[^,{{}}\n]*)$")
_TYPE = re.compile(r"""type[ \t]*=[ \t]*["'](\w+)["']""")
_WORD = re.compile(r"[A-Za-z_][\w]*$")
_QUANTITY = re.compile(r"""["'][-+]?[0-9][0-9.eE_+-]*[ ](?:[^"'\n]*[*/])?([A-Za-z%°]*)$""")


@dataclass(frozen=True, slots=True)
class Completion:
    """A text that may stand at a place."""

    text: str
    kind: Literal["key", "type", "name", "unit", "function", "value"]
    says: str = ""  # one line


def completions(document: OpenDocument, offset: int) -> tuple[Completion, ...]:
    """Return what may be written at a place and begins as what is there does."""
    before = document.source.text[:offset]
    prefix = match[0] if (match := _WORD.search(before)) else ""
    found = {c.text: c for c in _completions(document, before, offset) if c.text.startswith(prefix)}
    return tuple(found.values())


def _completions(document: OpenDocument, before: str, offset: int) -> Iterator[Completion]:
    path, key, used = _place(document.source.text, before, offset)
    if path is None:
        yield from (Completion(k, "key", _says(v)) for k, v in _schema()["properties"].items())
        return
    schema = _schema_at(path, _type_of(document.source.text, before, offset))
    if key is None:
        for name, inner in _properties(schema).items():
            if name not in used:
                yield Completion(name, "key", _says(inner))
        return
    if key == "type":
        for branch in _schema_at(path, None).get("oneOf", ()):
            if const := branch.get("properties", {}).get("type", {}).get("const"):
                yield Completion(const, "type", _says(branch["properties"]["type"]))
        return
    inner = _properties(schema).get(key, {})
    if values := inner.get("enum"):
        yield from (Completion(str(v), "value") for v in values)
    elif _QUANTITY.search(before) and key not in NODE_KEYS:
        yield from (Completion(symbol, "unit") for symbol in UNITS)
    else:
        is_node = key in NODE_KEYS
        defined = [n for n in document.names if n.is_definition]
        yield from (Completion(n.name, "name") for n in defined if n.is_node == is_node)
        if is_node:
            yield Completion("ground", "name", "what does not move")
        else:
            yield from (Completion(name, "function") for name in FUNCTIONS)
            yield from (
                Completion("s", "name", "the Laplace variable"),
                Completion("pi", "name", "3.14159..."),
            )
            yield from (Completion(n.name, "name") for n in defined if n.is_node)


def _place(text: str, before: str, offset: int) -> tuple[tuple[str, ...] | None, str | None, set[str]]:
    """Return the table that a place is in, the key whose value it is in, and the keys that are there already.

    The table is None in a header.
    """
    line = before[before.rfind("\n") + 1 :]
    if re.match(r"[ \t]*\[[^=\"']*$", line):
        return None, None, set()
    header = _last(_HEADER, before, 0)
    path = tuple(part.strip("\"' ") for part in re.findall(KEY_PART, header[1])) if header else ()
    start = header.end() if header else 0
    assigned = _last(_ASSIGNED, before, start)
    if assigned is None or (_closed(before[assigned.end() :]) and "\n" in before[assigned.end() :]):
        follows = _HEADER.search(text, offset)
        there = _ASSIGNED.findall(text, start, follows.start() if follows else len(text))
        return path, None, {each.split(".")[0].strip("\"' ") for each in there}
    path_of_key = tuple(part.strip("\"' ") for part in re.findall(KEY_PART, assigned[1]))
    value = before[assigned.end() :]
    if not value.lstrip().startswith("{"):
        return (*path, *path_of_key[:-1]), path_of_key[-1], set()
    if inner := _INNER.search(value):
        return (*path, *path_of_key), inner[1].strip("\"'"), set()
    used = {each.strip("\"'") for each in re.findall(rf"[{{,][ \t]*({KEY_PART})[ \t]*=", value)}
    return (*path, *path_of_key), None, used


def _last(pattern: re.Pattern[str], text: str, start: int) -> re.Match[str] | None:
    return max(pattern.finditer(text, start), key=re.Match.start, default=None)


def _closed(value: str) -> bool:
    """Tell whether brackets and quotes that a value opens are closed."""
    bare = re.sub(r"\"[^\"\n]*\"|'[^'\n]*'|#[^\n]*", "", value)
    return all(bare.count(a) <= bare.count(b) for a, b in ("[]", "{}"))


def _type_of(text: str, before: str, offset: int) -> str | None:
    """Return the type of the table that a place is in: of its line, or of the lines below its header."""
    start = before.rfind("\n") + 1
    end = text.find("\n", offset)
    line = text[start : len(text) if end < 0 else end]
    if "{" not in line:
        headers = [m.end() for m in _HEADER.finditer(before)]
        follows = _HEADER.search(text, offset)
        line = text[headers[-1] if headers else 0 : follows.start() if follows else len(text)]
    return match[1] if (match := _TYPE.search(line)) else None


@cache
def _schema() -> Schema:
    return json_schema()


def _schema_at(path: tuple[str, ...], type_name: str | None) -> Schema:
    """Return the schema of a table; of several branches the one of this type."""
    schema = _schema()
    for part in path:
        branches = schema.get("anyOf") or schema.get("oneOf") or [schema]
        inner = next((b["properties"][part] for b in branches if part in b.get("properties", {})), None)
        schema = inner if inner is not None else schema.get("additionalProperties") or {}
        if not isinstance(schema, dict):
            return {}
    for branch in schema.get("oneOf", ()):
        if branch.get("properties", {}).get("type", {}).get("const", "") == type_name:
            return dict(branch)
    return schema


def _properties(schema: Schema) -> dict[str, Schema]:
    """Return the properties of a table, of all its branches where several are left."""
    branches = schema.get("anyOf") or schema.get("oneOf") or [schema]
    return {k: v for branch in branches for k, v in branch.get("properties", {}).items()}


def _says(schema: Schema) -> str:
    return str(schema.get("description", ""))
