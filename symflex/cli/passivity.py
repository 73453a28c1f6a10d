"""What a machine does where it is touched: ``passivity``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.cli.analyses import Ranged
from symflex.cli.command import Specification, command_of
from symflex.cli.reporting import PICTURES, answer, check_place, note
from symflex.errors import refused
from symflex.options import PassivityOptions

if TYPE_CHECKING:
    from symflex.model import Model


@command_of("passivity", PassivityOptions, Ranged)
def passivity(spec: Specification, given: PassivityOptions) -> int:
    """Print whether SPEC is passive at a port, proved for all frequencies.

    A passive machine is stable with every passive thing it touches. Of another one the active bands are
    printed, in which the real part of its driving-point function is negative, with the least real part, the
    smallest dampers that make it passive, and a spring, a mass or both with which it is unstable.

    With --port twice, both ports are judged together: whether SPEC is passive, and whether it is absolutely
    stable (Llewellyn), which is with every pair of passive things that are not connected to each other. If
    [analysis] has a band, the impedance that the first port shows is printed, the second free and held.

    --over K prints for which values of a parameter it is passive, from exact polynomials of lumped models;
    twice, at many values of the second. With waves or delays values are tried and halved, which proves what
    lies between them if the impedance or admittance is a straight line in the parameter.

    --symbolic prints when the real part is positive at all frequencies, and when the poles lie in the left
    half-plane, in symbols. Passive is then what is at a bound, too.

    --port names a port of [ports], or a node. -o draws the real part over frequency, active bands shaded.

    Exit code 4: it could not be decided.
    """
    from symflex.contact.passivity import driving_function, find_passivity

    if given.symbolic and (given.over or len(given.ports) > 1):
        other = "--over" if given.over else "two ports"
        raise refused(f"--symbolic is not available with {other}", "ask for each alone")
    if (given.limits or given.ranges) and not given.over:
        raise refused("--range is of a parameter that --over names", "for instance --over K --range 0 10")
    if len(given.ports) > 1 and not given.over:
        return _two_ports(spec, given)
    port = next(iter(given.ports), None)
    place = check_place(given.output, PICTURES) if given.output else None
    model = spec.load()
    if given.symbolic:
        return _in_letters(model, port, given)
    if given.over:
        from symflex.contact.over import passive_over

        values = passive_over(model, given)
        answer(given.as_json, values.to_json_dict, lambda: str(values))
        return 0 if values.certified else 4
    if model.sampled is not None and not place:
        from symflex.contact.hybrid import find_hybrid  # few models have a sampled controller

        hybrid = find_hybrid(model, port)
        answer(given.as_json, hybrid.to_json_dict, lambda: str(hybrid))
        return 4 if hybrid.passive is None else 0
    found = find_passivity(model, port, given.digits)
    answer(given.as_json, found.to_json_dict, lambda: str(found))
    if place:
        from symflex.figures import draw, save

        save(draw("passivity", [driving_function(model, port)]), place)
        note(f"wrote {place}")
    return 4 if found.passive is None else 0


def _in_letters(model: Model, name: str | None, given: PassivityOptions) -> int:
    """Print when the real part at a port is positive, and when the poles lie on the left, in symbols."""
    from symflex import pipeline
    from symflex.contact.port import at_port
    from symflex.model.ports import port_named
    from symflex.symbolic.real_part import real_part_conditions
    from symflex.symbolic.routh import conditions

    driven, pair = at_port(model, port_named(model, name))
    found = [real_part_conditions(pipeline.derive_all(driven, [pair])[0]), conditions(driven)]
    answer(
        given.as_json,
        lambda: {"schema": "symflex.passivity/1", "letters": [each.to_json_dict() for each in found]},
        lambda: "\n\n".join(map(str, found)),
    )
    return 0


def _two_ports(spec: Specification, given: PassivityOptions) -> int:
    """Print what is proved of two ports together."""
    from symflex.contact.two_ports import find_two_ports

    if len(given.ports) > 2 or given.output:  # noqa: PLR2004 (a pair)
        raise refused("--port is given once or twice; -o is for one port")
    found = find_two_ports(spec.load(), given.ports, given.digits)
    answer(given.as_json, found.to_json_dict, lambda: str(found))
    return 0 if found.certified else 4
