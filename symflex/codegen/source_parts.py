"""The functions that generated code calls, from files of its own language in ``codegen/sources``.

Such a file is cut into parts by lines that say what each defines::

    #: _characteristic_roots _refined
    function _characteristic_roots(c)
    ...

Generated code gets the parts it calls and those that they call, in the order of the file.
"""

from __future__ import annotations

import re
from functools import cache
from importlib import resources
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

_MARK = re.compile(r"^(?:#|%|//): (.+)\n", re.MULTILINE)
_CALL = re.compile(r"(\w+)\(")


@cache
def parts_of(file: str, dialect: str = "") -> Mapping[tuple[str, ...], str]:
    """Return the parts of a file in ``codegen/sources`` by the names that each defines.

    Those of a ``dialect``, another file, take the place of those that define one of the same names.

    Examples
    --------
    >>> [names for names in parts_of("matlab.m") if "modal_value" in names]
    [('mode_values', 'modal_value')]
    """
    source = resources.files("symflex.codegen").joinpath("sources", file).read_text(encoding="utf-8")
    _, *cut = _MARK.split(source)
    parts = {
        tuple(names.split()): f"{text.strip()}\n" for names, text in zip(cut[::2], cut[1::2], strict=True)
    }
    if not dialect:
        return parts
    found: dict[tuple[str, ...], str] = {}
    others = parts_of(dialect)
    for names, text in parts.items():
        own = next((other for other in others if not set(other).isdisjoint(names)), names)
        found.setdefault(own, others.get(own, text))
    return found


def called_parts(code: str, parts: Mapping[tuple[str, ...], str], always: Iterable[str] = ()) -> list[str]:
    """Return the parts that some code needs, in order, and those that ``always`` are.

    Text of a model, which might look like a call, is no part of the code.

    Examples
    --------
    >>> called_parts("f(x)", {("a",): "def a(): pass", ("f", "g"): "def f(): a()", ("h",): ""})
    ['def a(): pass', 'def f(): a()']
    """
    home = {name: names for names in parts for name in names}
    needed: set[tuple[str, ...]] = set()
    pending = [*always, *_CALL.findall(code)]
    while pending:
        names = home.get(pending.pop())
        if names is not None and names not in needed:
            needed.add(names)
            pending += _CALL.findall(parts[names])
    return [text for names, text in parts.items() if names in needed]
