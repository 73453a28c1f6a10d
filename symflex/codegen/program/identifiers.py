"""Names of a model as identifiers of a programming language, one to one."""

from __future__ import annotations

import re
from itertools import chain, count
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

_OUTSIDE = re.compile(r"[^A-Za-z0-9_]")
_PLAIN = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


def identifiers(
    wanted: Mapping[str, str], reserved: Collection[str], longest: int | None = None
) -> Mapping[str, str]:
    """Return an identifier for every key: the text wanted for it where that can be one.

    Parameters
    ----------
    wanted : mapping of str to str
        Any texts at all; the same text may be wanted twice.
    reserved : collection of str
        Identifiers that mean something else: keywords, and what the generated code uses.
    longest : int, optional
        Number of characters an identifier may have; longer texts are cut.

    Returns
    -------
    mapping of str to str
        Different keys have different identifiers: letters, digits and underscores of ASCII, a letter first.

    Examples
    --------
    >>> dict(identifiers({"a": "lambda", "b": "lambda_", "c": "k", "d": "2x)", "e": "k"}, {"lambda"}))
    {'a': 'lambda_2', 'b': 'lambda_', 'c': 'k', 'd': 'p_2x_', 'e': 'k_'}
    >>> dict(identifiers({"a": "stiffness_1", "b": "stiffness_2"}, {}, longest=9))
    {'a': 'stiffness', 'b': 'stiffnes_'}
    """
    found: dict[str, str] = {}
    taken = set(reserved)
    for key, text in wanted.items():
        if _PLAIN.fullmatch(text) and text not in taken and text == text[:longest]:
            found[key] = text
            taken.add(text)
    for key, text in wanted.items():
        if key not in found:
            found[key] = _free(_mangled(text), taken, longest)
            taken.add(found[key])
    return {key: found[key] for key in wanted}


def _mangled(text: str) -> str:
    plain = _OUTSIDE.sub("_", text)
    return plain if plain[:1].isalpha() else f"p_{plain.lstrip('_')}"


def _free(text: str, taken: Collection[str], longest: int | None) -> str:
    for suffix in chain(("", "_"), (f"_{number}" for number in count(2))):
        kept = text if longest is None else text[: longest - len(suffix)]
        if f"{kept}{suffix}" not in taken:
            return f"{kept}{suffix}"
    raise AssertionError
