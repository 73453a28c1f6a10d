"""Derived transfer functions kept on disk, so that a model that has not changed is not derived again.

Nothing is kept unless :func:`derivation_cache` is entered; the command line enters it. This module holds no
more than what is needed to tell that it was not.
"""

from __future__ import annotations

from contextlib import contextmanager
from contextvars import ContextVar
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from symflex.cache.store import Store

_ENTERED: ContextVar[Store | None] = ContextVar("entered", default=None)


def entered_cache() -> Store | None:
    """Return the cache that is entered, ``None`` when derivations are not kept."""
    return _ENTERED.get()


@contextmanager
def derivation_cache(
    folder: str | Path | None = None, seconds: float | None = None
) -> Iterator[Store | None]:
    """Keep derived transfer functions in a folder while the context lasts, in this thread.

    A derivation is found again by the content of its equations, the pairs asked for, and the versions of the
    programs that derive; whatever cannot be read is derived as if it were not there. No error ever comes from
    the folder: where it cannot be written, nothing is kept.

    Parameters
    ----------
    folder : str or Path, optional
        By default what SYMFLEX_CACHE_DIR names, or ``symflex`` in the user's cache folder; nothing is kept
        there under SYMFLEX_NO_CACHE=1, or when the user has no such folder.
    seconds : float, optional
        What took less to derive is not kept, by default 0.05; 0 to keep everything.

    Yields
    ------
    Store or None
        What is kept there; ``None`` when nothing is.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder, derivation_cache(folder) as store:
    ...     store.usage()
    Usage(entries=0, size=0)
    """
    from symflex.cache.folder import cache_folder  # a process without a cache needs none of it
    from symflex.cache.store import SECONDS, Store

    place = cache_folder() if folder is None else folder
    store = None if place is None else Store(place, SECONDS if seconds is None else seconds)
    token = _ENTERED.set(store)
    try:
        yield store
    finally:
        _ENTERED.reset(token)


__all__ = ["derivation_cache", "entered_cache"]
