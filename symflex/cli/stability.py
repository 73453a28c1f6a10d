"""``symflex stability``."""

from __future__ import annotations

from symflex.budget import entered_budget
from symflex.cli.command import Specification, command_of
from symflex.cli.reporting import emit_json, say
from symflex.options import StabilityOptions


@command_of("stability", StabilityOptions)
def command(spec: Specification, given: StabilityOptions) -> int:
    """Print for which values of K all poles of SPEC lie in the open left half plane.

    The loop is closed in [signals]; K is one of [parameters]. Boundaries are enclosed, with the frequency at
    which poles cross the imaginary axis, and poles right of it are counted between them; hidden modes count.
    For the value that K has in SPEC, gain and phase margins follow.

    Exit code 4 says that something is not proved, and what. Poles of structures without loss have no end
    along the axis: there, poles are counted up to a frequency, which is printed.
    """
    from symflex import pipeline
    from symflex.cli.progress import ProgressBar
    from symflex.loops.text import stability_text

    model = spec.load()
    with ProgressBar() as bar:
        found = pipeline.stability(model, given, budget=entered_budget().told(bar))
    if given.as_json:
        emit_json(found.to_json_dict())
    else:
        say(stability_text(found))
    return 0 if found.certified else 4
