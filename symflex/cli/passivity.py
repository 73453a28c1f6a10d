"""What a machine does where it is touched: ``passivity``."""

from __future__ import annotations

from symflex.cli.command import Specification, command_of
from symflex.cli.reporting import PICTURES, answer, check_place, note
from symflex.options import PassivityOptions


@command_of("passivity", PassivityOptions)
def passivity(spec: Specification, given: PassivityOptions) -> int:
    """Print whether SPEC is passive at a port, proved for all frequencies.

    A passive machine is stable with every passive thing it touches. Of another one the active bands are
    printed, in which the real part of its driving-point function is negative, with the least real part, the
    smallest dampers that make it passive, and a spring, a mass or both with which it is unstable.

    --port names a port of [ports], or a node. -o draws the real part over frequency, active bands shaded.

    Exit code 4: it could not be decided.
    """
    from symflex.contact.passivity import driving_function, find_passivity

    place = check_place(given.output, PICTURES) if given.output else None
    model = spec.load()
    found = find_passivity(model, given.port, given.digits)
    answer(given.as_json, found.to_json_dict, lambda: str(found))
    if place:
        from symflex.figures import draw, save

        save(draw("passivity", [driving_function(model, given.port)]), place)
        note(f"wrote {place}")
    return 4 if found.passive is None else 0
