"""Names of a model as identifiers of a programming language, one to one."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

_OUTSIDE = re.compile(r"[^A-Za-z0-9_]")
_PLAIN = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


def identifiers(names: Sequence[str], reserved: Collection[str]) -> Mapping[str, str]:
    """Return an identifier for every name: the name itself where it can be one.

    Parameters
    ----------
    names : sequence of str
        Any text at all.
    reserved : collection of str
        Identifiers that mean something else: keywords, and what the generated code uses.

    Returns
    -------
    mapping of str to str
        Different names have different identifiers: letters, digits and underscores of ASCII, a letter first.

    Examples
    --------
    >>> dict(identifiers(["lambda", "lambda_", "k", "2x)"], {"lambda"}))
    {'lambda': 'lambda_2', 'lambda_': 'lambda_', 'k': 'k', '2x)': 'p_2x_'}
    """
    found = {n: n for n in names if _PLAIN.fullmatch(n) and n not in reserved}
    taken = {*reserved, *found.values()}
    for name in names:
        if name not in found:
            found[name] = _free(_mangled(name, reserved), taken)
            taken.add(found[name])
    return {name: found[name] for name in names}


def identifier_part(name: str) -> str:
    """Return a name with every character replaced that no identifier may have; not one to one.

    Examples
    --------
    >>> identifier_part("x-y")
    'x_y'
    """
    plain = _OUTSIDE.sub("_", name)
    return plain if plain[:1].isalpha() else f"p_{plain.lstrip('_')}"


def _mangled(name: str, reserved: Collection[str]) -> str:
    part = identifier_part(name)
    return f"{part}_" if part in reserved else part


def _free(wanted: str, taken: Collection[str]) -> str:
    if wanted not in taken:
        return wanted
    stem, number = wanted.rstrip("_"), 2
    while f"{stem}_{number}" in taken:
        number += 1
    return f"{stem}_{number}"
