"""``symflex stability``."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

import click

from symflex.budget import entered_budget
from symflex.cli.budgeting import budgeted
from symflex.cli.reporting import emit_json, load, outside, reporting, say, setting
from symflex.errors import Diagnostic, UsageError

if TYPE_CHECKING:
    from fractions import Fraction

    from symflex.model import Parameter

DIGITS_LIMIT = 1000
UNBOUNDED = ("inf", "-inf", "+inf")


@click.command("stability")
@click.argument("spec", type=click.Path())
@outside
@click.option("--gain", required=True, metavar="K", help="The parameter that is the loop's gain.")
@click.option(
    "--range",
    "limits",
    nargs=2,
    metavar="LO HI",
    help='Only gains between two values: 0 1e4, "1 kN/m" inf.  [default: all of the sign assumed of it; with '
    "beams, rods or delays up to 100 times its value]",
)
@click.option(
    "--up-to",
    metavar="FREQUENCY",
    help="Where poles have no end: how far they are counted, in Hz or with a unit.",
)
@click.option(
    "--digits", type=click.IntRange(1, DIGITS_LIMIT), help="Correct significant digits.  [default: 15]"
)
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
@budgeted
@reporting
@setting
def command(
    spec: str,
    *,
    allow_outside: tuple[str, ...],
    settings: dict[str, str],
    gain: str,
    limits: tuple[str, str] | None,
    up_to: str | None,
    digits: int | None,
    as_json: bool,
) -> int:
    """Print for which values of K all poles of SPEC lie in the open left half plane.

    The loop is closed in [signals]; K is one of [parameters]. Boundaries are enclosed, with the frequency at
    which poles cross the imaginary axis, and poles right of it are counted between them; hidden modes count.
    For the value that K has in SPEC, gain and phase margins follow.

    Exit code 4 says that something is not proved, and what. Poles of structures without loss have no end
    along the axis: there, poles are counted up to a frequency, which is printed.
    """
    from symflex import pipeline
    from symflex.cli.progress import ProgressBar
    from symflex.loops import pick_gain
    from symflex.loops.text import stability_text

    model = load(spec, allow_outside, settings)
    parameter = pick_gain(model.parameters, gain)
    chosen = None if limits is None else (gain_limit(limits[0], parameter), gain_limit(limits[1], parameter))
    highest = None if up_to is None else _radians(up_to)
    with ProgressBar() as bar:
        found = pipeline.stability(
            model,
            gain,
            limits=chosen,
            digits=digits or model.analysis.digits or 15,
            budget=entered_budget().told(bar),
            up_to=highest,
        )
    if as_json:
        emit_json(found.to_json_dict())
    else:
        say(stability_text(found))
    return 0 if found.certified else 4


def gain_limit(text: str, parameter: Parameter) -> Fraction | None:
    """Return an end of the range in SI units, ``None`` for an infinite one."""
    from symflex.errors import Source, Span, SpecError, Text
    from symflex.quantities import parse_quantity, unit_of

    if text.strip().lower() in UNBOUNDED:
        return None
    wrong = f"--range takes values such as 0, 1e4 or inf, found '{text[:60]}'"
    try:
        quantity = parse_quantity(Text(text, Span(Source("--range", text), 0, len(text))))
    except SpecError:
        raise UsageError(Diagnostic("SF902", wrong)) from None
    known = unit_of(parameter.unit).dimension if parameter.unit else None
    if quantity.unit and quantity.dimension != known:
        own = f"is in '{parameter.unit}'" if parameter.unit else "is a number without a unit"
        message = f"'{parameter.name}' {own}, the range is in '{quantity.unit}'"
        raise UsageError(Diagnostic("SF203", message))
    number, pi_power = quantity.cyclic() if parameter.cycles else quantity.angular()
    if pi_power:
        raise UsageError(Diagnostic("SF902", wrong))
    return number


def _radians(text: str) -> float:
    """Return a frequency [rad/s] given in Hz or with a unit."""
    from symflex.cli.roots import frequency_limit

    value = float(frequency_limit(text, "--up-to", "100 or '1 kHz'", hertz=True))
    if not value > 0:
        raise UsageError(Diagnostic("SF902", "--up-to takes a positive frequency"))
    return 2 * pi * value
