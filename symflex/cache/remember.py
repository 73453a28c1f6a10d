"""Deriving with a memory."""

from __future__ import annotations

from time import perf_counter
from typing import TYPE_CHECKING

from symflex.cache.entry import BYTES_PER_SECOND, entry_content, read_entry
from symflex.cache.key import derivation_key
from symflex.transfer import derive_all

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.cache.store import Store
    from symflex.equations import Equations
    from symflex.transfer import TransferFunction


def derive_or_recall(
    equations: Equations, pairs: Sequence[tuple[str, str]], store: Store
) -> tuple[TransferFunction, ...]:
    """Return what :func:`symflex.transfer.derive_all` returns, from the store where that has it.

    A derivation is kept when it took longer than the store asks for and than reading it back is going to.

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
    if seconds >= store.seconds:
        content = entry_content(derived)
        if not store.seconds or len(content) < seconds * BYTES_PER_SECOND / 2:
            store.write(key, content)
    return derived
