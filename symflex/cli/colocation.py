"""``symflex colocation``."""

from __future__ import annotations

from symflex.cli.command import Specification, command_of
from symflex.cli.reporting import emit_json, say
from symflex.options import ColocationOptions


@command_of("colocation", ColocationOptions)
def command(spec: Specification, given: ColocationOptions) -> int:
    """Print up to which frequency an output of SPEC moves with a colocated one.

    Within this band they are dynamically colocated, although flexible parts lie between them. It ends where
    the ratio of the two first leaves the tolerances; that it does not before is proved. Exit code 4 says that
    the end could not be told.
    """
    from symflex import pipeline

    found = pipeline.colocation(spec.load(), given)
    if given.as_json:
        emit_json(found.to_json_dict())
    else:
        say(str(found))
    return 0 if found.is_decided else 4
