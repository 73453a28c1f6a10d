"""Values in place of declared ones on the command line: ``--set NAME=VALUE``."""

from __future__ import annotations

from functools import wraps
from typing import TYPE_CHECKING, ParamSpec

import click

if TYPE_CHECKING:
    from collections.abc import Callable

P = ParamSpec("P")


def setting(command: Callable[P, int | None]) -> Callable[..., int]:
    """Give a command the option ``--set``; it gets what that says as ``settings``, by name."""

    @wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> int:
        from symflex.model import read_settings  # a command's help needs none of it

        kwargs["settings"] = read_settings(kwargs["settings"])  # type: ignore[arg-type]
        return command(*args, **kwargs) or 0

    option = click.option(
        "--set",
        "settings",
        multiple=True,
        metavar="NAME=VALUE",
        help="Another value of a parameter: k='80 kN/m', or SI units; repeatable.",
    )
    return option(run)
