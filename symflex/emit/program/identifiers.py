"""Names of a model as identifiers of a programming language, one to one."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

_OUTSIDE = re.compile(r"[^A-Za-z0-9_]")
_PLAIN = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


def identifiers(wanted: Mapping[str, str], reserved: Collection[str]) -> Mapping[str, str]:
    """Return an identifier for every key: the text wanted for it where that can be one.

    Parameters
    ----------
    wanted : mapping of str to str
        Any texts at all; the same text may be wanted twice.
    reserved : collection of str
        Identifiers that mean something else: keywords, and what the generated code uses.

    Returns
    -------
    mapping of str to str
        Different keys have different identifiers: letters, digits and underscores of ASCII, a letter first.

    Examples
    --------
    >>> dict(identifiers({"a": "lambda", "b": "lambda_", "c": "k", "d": "2x)", "e": "k"}, {"lambda"}))
    {'a': 'lambda_2', 'b': 'lambda_', 'c': 'k', 'd': 'p_2x_', 'e': 'k_'}
    """
    found: dict[str, str] = {}
    taken = set(reserved)
    for key, text in wanted.items():
        if _PLAIN.fullmatch(text) and text not in taken:
            found[key] = text
            taken.add(text)
    for key, text in wanted.items():
        if key not in found:
            found[key] = _free(_mangled(text), taken)
            taken.add(found[key])
    return {key: found[key] for key in wanted}


def _mangled(text: str) -> str:
    plain = _OUTSIDE.sub("_", text)
    return plain if plain[:1].isalpha() else f"p_{plain.lstrip('_')}"


def _free(text: str, taken: Collection[str]) -> str:
    if text not in taken:
        return text
    if f"{text}_" not in taken:
        return f"{text}_"
    number = 2
    while f"{text}_{number}" in taken:
        number += 1
    return f"{text}_{number}"
