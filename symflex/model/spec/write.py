"""From nested Python values to the text of a specification, so that both kinds of model are one."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Any, Final

from symflex.errors import Diagnostic, SpecError
from symflex.model.spec.positions import Literal
from symflex.model.spec.read import MAX_LITERAL, MAX_NESTING, number_problem

INLINE_SECTIONS: Final = frozenset({"parameters", "elements", "inputs", "outputs", "blocks", "ports"})

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_NOT_LITERAL = re.compile(r"[\x00-\x08\x0a-\x1f\x7f']")
_ESCAPED = re.compile(r'[\x00-\x1f\x7f"\\]')
SHORTER = "give fewer digits, or a unit in which the number is closer to 1"
FLATTER = "no key of a specification needs as many"
_SURROGATE = re.compile(r"[\ud800-\udfff]")
_SHORT_ESCAPES = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r", "\b": "\\b", "\f": "\\f"}
_BITS_PER_DIGIT = 3.3219280948873626  # log2(10)


def write(mapping: Mapping[str, object]) -> str:
    """Render nested values as the text that :func:`symflex.model.spec.parse` reads as the mapping."""
    # The two outer levels become ``[a]`` and ``[a.b]`` headers; what is deeper, and what stands in
    # `parameters`, `elements`, `inputs`, `outputs`, `blocks` and `ports`, becomes inline tables. Values are
    # str, int, Fraction, Decimal, float, literals, bool, list, tuple, arrays of numpy, expressions of SymPy,
    # and mappings of these; a fraction that is not a finite decimal becomes the string ``"p/q"``.
    return "\n".join(
        block.header + "".join(f"{entry.key} = {entry.value}\n" for entry in block.entries)
        for block in blocks(mapping)
    )


@dataclass(frozen=True, slots=True)
class WrittenEntry:
    """One line of a specification, with the keys that lead to it."""

    path: tuple[str, ...]
    key: str
    value: str


@dataclass(frozen=True, slots=True)
class WrittenBlock:
    """A header with its line end, empty for what stands before the first one, and the lines below it."""

    header: str
    entries: tuple[WrittenEntry, ...]


def blocks(mapping: Mapping[str, object]) -> Iterator[WrittenBlock]:
    """Yield what :func:`write` writes, for those who lay it out themselves."""
    if scalars := [(key, value) for key, value in _items(mapping, ()) if not isinstance(value, Mapping)]:
        yield _block("", scalars, ())
    for name, section in _items(mapping, ()):
        if isinstance(section, Mapping):
            yield from _section(name, section)


def _section(name: str, section: Mapping[Any, object]) -> Iterator[WrittenBlock]:
    items = _items(section, (name,))
    apart = [] if name in INLINE_SECTIONS else [key for key, value in items if isinstance(value, Mapping)]
    direct = [(key, value) for key, value in items if key not in apart]
    if direct or not apart:
        yield _block(f"[{_key(name)}]\n", direct, (name,))
    for key, value in items:
        if key in apart and isinstance(value, Mapping):
            yield _block(f"[{_key(name)}.{_key(key)}]\n", _items(value, (name, key)), (name, key))


def _block(header: str, items: list[tuple[str, object]], path: tuple[str, ...]) -> WrittenBlock:
    entries = (WrittenEntry((*path, key), _key(key), _value(value, (*path, key))) for key, value in items)
    return WrittenBlock(header, tuple(entries))


def _items(mapping: Mapping[Any, object], path: tuple[str, ...]) -> list[tuple[str, object]]:
    items = []
    for key, value in mapping.items():
        if not isinstance(key, str) or _SURROGATE.search(key):
            raise _refused("SF104", path, f"the key {key!r} is not text", "keys are strings")
        items.append((key, value))
    return items


def _key(key: str) -> str:
    return key if _BARE_KEY.fullmatch(key) else _string(key)


def _value(value: object, path: tuple[str, ...], depth: int = 0) -> str:
    match value:
        case bool():
            return "true" if value else "false"
        case str():
            if _SURROGATE.search(value):
                raise _refused("SF104", path, "the text contains half a surrogate pair", "leave it out")
            return _string(value)
        case int() | Fraction():
            return _rational(Fraction(value), path)
        case float():
            return float.__repr__(value)
        case Decimal():
            if value.is_nan():
                return "nan"
            if value.is_infinite():
                return "-inf" if value < 0 else "inf"
            return _checked(str(value), path)
        case Literal(text):
            return _checked(text, path)
    if hasattr(value, "free_symbols") and not hasattr(value, "tolist"):
        return _string(str(value))  # SymPy prints what the grammar of expressions reads
    if hasattr(value, "tolist"):  # an array or number of numpy, a matrix of SymPy
        return _value(value.tolist(), path, depth)
    if not isinstance(value, Mapping | list | tuple):
        message = f"a value of type '{type(value).__name__}' cannot be written into a specification"
        raise _refused("SF104", path, message, "use text, numbers, booleans, lists and mappings")
    if depth >= MAX_NESTING:
        raise _refused("SF103", path[:3], f"brackets nested deeper than {MAX_NESTING}", FLATTER)
    if isinstance(value, Mapping):
        pairs = [f"{_key(key)} = {_value(v, (*path, key), depth + 1)}" for key, v in _items(value, path)]
        return f"{{ {', '.join(pairs)} }}" if pairs else "{}"
    return f"[{', '.join(_value(item, (*path, str(i)), depth + 1) for i, item in enumerate(value))}]"


def _string(text: str) -> str:
    # Single quotes keep a backslash as it is, so LaTeX reads as LaTeX and places in it stay exact.
    if ("\\" in text or '"' in text) and not _NOT_LITERAL.search(text):
        return f"'{text}'"
    return '"' + _ESCAPED.sub(lambda m: _SHORT_ESCAPES.get(m[0], f"\\u{ord(m[0]):04x}"), text) + '"'


def _rational(value: Fraction, path: tuple[str, ...]) -> str:
    numerator, denominator = value.numerator, value.denominator
    # Python refuses to print very long integers; measure before printing.
    if max(numerator.bit_length(), denominator.bit_length()) > MAX_LITERAL * _BITS_PER_DIGIT + 1:
        raise _refused("SF103", path, f"number of more than {MAX_LITERAL} characters", SHORTER)
    if denominator == 1:
        literal = str(numerator)
    else:
        places = _decimal_places(denominator)
        if places is None:
            return f'"{numerator}/{denominator}"'
        digits = str(abs(numerator) * 10**places // denominator).rjust(places + 1, "0")
        literal = f"{'-' * (numerator < 0)}{digits[:-places]}.{digits[-places:]}"
    return _checked(literal, path)


def _decimal_places(denominator: int) -> int | None:
    """Return how many decimals 1/denominator has, or ``None`` when they never end."""
    places = {2: 0, 5: 0}
    for prime in places:
        while denominator % prime == 0:
            denominator //= prime
            places[prime] += 1
    return max(places.values()) if denominator == 1 else None


def _checked(literal: str, path: tuple[str, ...]) -> str:
    if problem := number_problem(literal):
        raise _refused("SF103", path, problem, SHORTER)
    return literal


def _refused(code: str, path: tuple[str, ...], message: str, hint: str) -> SpecError:
    where = ".".join(_key(part) if not _SURROGATE.search(part) else ascii(part) for part in path)
    return SpecError(Diagnostic(code, f"{where}: {message}" if where else message, None, hint))
