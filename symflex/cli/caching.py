"""The cache on the command line: on, unless ``--no-cache`` or SYMFLEX_NO_CACHE=1 is given."""

from __future__ import annotations

from functools import wraps
from typing import TYPE_CHECKING, ParamSpec

import click

from symflex.cache import derivation_cache

if TYPE_CHECKING:
    from collections.abc import Callable

P = ParamSpec("P")


def caching(command: Callable[P, int]) -> Callable[..., int]:
    """Give a command that derives the option ``--no-cache``, and the cache without it."""

    @wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> int:
        if kwargs.pop("no_cache", False):
            return command(*args, **kwargs)
        with derivation_cache():
            return command(*args, **kwargs)

    option = click.option("--no-cache", is_flag=True, help="Derive anew; neither read nor write the cache.")
    return option(run)
