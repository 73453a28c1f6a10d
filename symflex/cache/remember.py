"""Deriving with a memory."""

from __future__ import annotations

from time import perf_counter
from typing import TYPE_CHECKING, Final

from symflex.cache.entry import entry_content, numbers_in, read_entry
from symflex.cache.key import derivation_key
from symflex.transfer import derive_all

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.cache.store import Store
    from symflex.equations import Equations
    from symflex.transfer import TransferFunction


NUMBERS_PER_SECOND: Final = 500_000
"""Less than the exponents and coefficients that are read in a second (some millions)."""


def derive_or_recall(
    equations: Equations, pairs: Sequence[tuple[str, str]], store: Store
) -> tuple[TransferFunction, ...]:
    """Return what :func:`symflex.transfer.derive_all` returns, from the store where that has it.

    A derivation is kept when it took longer than the store asks for and several times as long as reading it
    back: an expanded form of a million terms is derived again in less time than it is read.

    Raises
    ------
    ModelError, BudgetError
        As there; what raises is not kept.
    """
    key = derivation_key(equations, pairs)
    if not key:
        return derive_all(equations, pairs)
    content = store.read(key)
    found = None if content is None else read_entry(content, equations, pairs)
    if found is not None:
        return found
    begin = perf_counter()
    derived = derive_all(equations, pairs)
    seconds = perf_counter() - begin
    pays = seconds >= store.seconds and numbers_in(derived) < seconds * NUMBERS_PER_SECOND
    if pays or not store.seconds:
        store.write(key, entry_content(derived))
    return derived
