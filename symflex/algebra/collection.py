"""Pausing the collector of reference cycles while millions of objects are made and none is garbage."""

from __future__ import annotations

import gc
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def uncollected() -> Iterator[None]:
    """Pause it: every full pass looks at all objects there are, which makes linear work quadratic.

    Examples
    --------
    >>> import gc
    >>> with uncollected():
    ...     gc.isenabled()
    False
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            if not gc.get_freeze_count():
                # Now they all count as old, and the next young generation is looked at without them.
                gc.freeze()
                gc.unfreeze()
            gc.enable()
