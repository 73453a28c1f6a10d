"""``symflex cache``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from symflex.cache.folder import OFF_VARIABLE, cache_folder
from symflex.cli.reporting import emit_json, reporting, say
from symflex.errors.diagnostic import printable

if TYPE_CHECKING:
    from symflex.cache.store import Usage


@click.command("cache")
@click.option("--clear", is_flag=True, help="Remove all entries.")
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
@reporting
def command(*, clear: bool, as_json: bool) -> None:
    """Show where derivations are kept, how many and how large they are, or remove them.

    Commands that derive keep what took long and find it again while the equations do not change; with
    --no-cache they neither read nor write it. SYMFLEX_CACHE_DIR names another folder, SYMFLEX_NO_CACHE=1
    switches the cache off.
    """
    from symflex.cache.store import MAXIMUM_BYTES, Store, Usage

    folder = cache_folder()
    store = None if folder is None else Store(folder)
    removed = store.clear() if store is not None and clear else Usage(0, 0)
    kept = store.usage() if store is not None else Usage(0, 0)
    is_writable = store is not None and store.is_writable()
    if as_json:
        emit_json(
            {
                "schema": "symflex.cache/1",
                "folder": None if folder is None else str(folder),
                "writable": is_writable,
                "entries": kept.entries,
                "bytes": kept.size,
                "maximum_bytes": MAXIMUM_BYTES,
                "removed": removed.entries,
            }
        )
    elif folder is None:
        say(f"no cache: {OFF_VARIABLE} is set, or there is no home folder")
    else:
        say(f"folder: {printable(str(folder))}")
        if not is_writable:
            say("nothing can be kept there: the folder cannot be written")
        if clear:
            say(f"removed: {_amount(removed)}")
        say(f"entries: {_amount(kept)}, of at most {MAXIMUM_BYTES / 2**20:.0f} MiB")


def _amount(usage: Usage) -> str:
    return f"{usage.entries}, {usage.size / 2**20:.1f} MiB"
