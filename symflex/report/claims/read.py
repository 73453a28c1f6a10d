"""Reading what a publication claims of its models: ``claims.toml`` beside its specifications.

Input: a file. Output: a :class:`Publication`, whose checks are predicates of a registry; nothing is run.

    symflex-claims = 1
    publication    = "Eppinger & Seering 1988"
    title          = "Modeling Robot Flexibility for Endpoint Force Control"
    models         = ["rigid_body", "two_mass"]

    [[claims]]
    key    = "second-order"
    place  = "Rigid-Body Dynamics"
    quote  = "We have a second-order transfer function"
    checks = [{ is = "counts", of = "rigid_body: V_tip/V_cmd", zeros = 0, poles = 2 }]
"""

from __future__ import annotations

import re
from functools import partial
from inspect import Parameter, signature
from pathlib import Path
from typing import Any, Final

from symflex.errors import Span, SpecError, SymflexError, nearest
from symflex.model.reading import Reader
from symflex.model.spec import ArrayValue, BooleanValue, KeyValue, NumberValue, TableValue, parse, read
from symflex.report.claims.claim import Check, Claim, Publication
from symflex.report.claims.predicates import PREDICATES

CLAIMS: Final = "claims.toml"
VERSION: Final = "symflex-claims"
KEYS: Final = (VERSION, "publication", "title", "models", "claims")
KEYS_OF_CLAIMS: Final = ("key", "place", "quote", "statement", "checks")
KEYS_OF_CHECKS: Final = ("is", "note", "condition")
KEY: Final = re.compile(r"[a-z]+(-[a-z]+)*\Z")


def is_claims(path: Path) -> bool:
    """Tell whether a file contains claims: by its name, and by what it declares."""
    if path.name != CLAIMS or not path.is_file():
        return False
    try:
        text = read(path).text
    except SymflexError:
        return False  # for whoever reads it to say
    return re.search(rf"^{VERSION}\s*=", text, re.MULTILINE) is not None


def read_claims(path: Path) -> Publication:
    """Return what a file claims; SF901 when it cannot be read, SpecError with every problem's place."""
    root = parse(read(path)).root
    reader = Reader()
    reader.keys(root, KEYS, "a file of claims")
    version = root.get(VERSION)
    if version is None or not (isinstance(version.value, NumberValue) and version.value.value == 1):
        span = version.value.span if version else root.span
        reader.note("SF200", f"a file of claims begins with {VERSION} = 1", span)
    texts = {key: _text(reader, root, key, "the publication") for key in ("publication", "title")}
    models, listed = root.get("models"), root.get("claims")
    names = reader.strings(models, "models") if models else None
    claims = tuple(_claim(reader, table) for table in _tables(reader, listed, "claims"))
    keys = [claim.key for claim in claims]
    for table, key in zip(_tables(reader, listed, "claims"), keys, strict=True):
        if keys.count(key) > 1:
            reader.note("SF208", f"several claims are called '{key}'", table.span)
    if reader.problems:
        raise SpecError(*reader.problems)
    chosen = tuple(text.value for text in names or ())
    return Publication(texts["publication"], texts["title"], chosen, claims)


def _claim(reader: Reader, table: TableValue) -> Claim:
    reader.keys(table, KEYS_OF_CLAIMS, "a claim")
    key = _text(reader, table, "key", "a claim")
    if key and not KEY.match(key):
        entry = table.get("key")
        hint = "keys are small letters, with hyphens between words"
        reader.note("SF213", f"'{key[:80]}' is not a key", entry.value.span if entry else table.span, hint)
    is_quotation = table.get("statement") is None
    quote = _text(reader, table, "quote" if is_quotation else "statement", "a claim")
    found = [_check(reader, one) for one in _tables(reader, table.get("checks"), "checks", table.span)]
    checks = tuple(check for check in found if check is not None)
    return Claim(key, _text(reader, table, "place", "a claim"), quote, checks, is_quotation)


def _check(reader: Reader, table: TableValue) -> Check | None:
    name = _text(reader, table, "is", "a check")
    predicate = PREDICATES.get(name)
    if predicate is None:
        entry = table.get("is")
        if entry is not None and name:
            hint = nearest(name, PREDICATES) or f"there are {', '.join(PREDICATES)}"
            reader.note("SF208", f"there is no check '{name[:80]}'", entry.value.span, hint)
        return None
    keys = [p for p in signature(predicate).parameters.values() if p.name != "models"]
    reader.keys(table, (*KEYS_OF_CHECKS, *(key.name for key in keys)), f"a check '{name}'")
    values: dict[str, Any] = {}
    for key in keys:
        entry = table.get(key.name)
        if entry is not None:
            values[key.name] = _value(reader, entry, key.annotation)
        elif key.default is Parameter.empty:
            reader.note("SF214", f"a check '{name}' needs '{key.name}'", table.span)
    if reader.problems:
        return None
    of = values.pop("of")
    texts = (_optional(reader, table, key) for key in ("note", "condition"))
    return Check(partial(predicate, **values), of, *texts)


def _value(reader: Reader, entry: KeyValue, kind: str) -> object:
    """Return the value of a key, of the type that the predicate takes."""
    value = entry.value
    if kind == "tuple[str, ...]":
        return tuple(text.value for text in reader.strings(entry, entry.key) or ())
    if kind == "str":
        text = reader.string(entry, entry.key)
        return text.value if text else ""
    if kind == "bool":
        if isinstance(value, BooleanValue):
            return value.value
        reader.misfit(f"{entry.key} must be true or false", value)
        return False
    items = value.items if kind == "tuple[float, ...]" and isinstance(value, ArrayValue) else (value,)
    numbers = [item.value for item in items if isinstance(item, NumberValue)]
    if len(numbers) < len(items) or (kind == "int" and numbers[0].denominator != 1):
        what = {"int": "a whole number", "float": "a number"}.get(kind, "an array of numbers")
        reader.misfit(f"{entry.key} must be {what}", value)
        return 0
    if kind == "int":
        return int(numbers[0])
    return float(numbers[0]) if kind == "float" else tuple(float(x) for x in numbers)


def _tables(reader: Reader, entry: KeyValue | None, what: str, at: Span | None = None) -> list[TableValue]:
    if entry is None:
        if at is not None:
            reader.note("SF214", f"'{what}' is missing", at)
        return []
    value = entry.value
    if isinstance(value, ArrayValue):
        tables = [item for item in value.items if isinstance(item, TableValue)]
        if tables and len(tables) == len(value.items):
            return tables
    reader.misfit(f"{what} must be an array of tables, not an empty one", value)
    return []


def _text(reader: Reader, table: TableValue, key: str, what: str) -> str:
    if table.get(key) is None:
        reader.note("SF214", f"{what} needs '{key}'", table.span)
        return ""
    return _optional(reader, table, key)


def _optional(reader: Reader, table: TableValue, key: str) -> str:
    entry = table.get(key)
    text = reader.string(entry, key) if entry else None
    return text.value if text else ""
