"""``symflex roots``."""

from __future__ import annotations

from fractions import Fraction
from math import nan
from typing import TYPE_CHECKING

import click

from symflex.budget import entered_budget
from symflex.cli.budgeting import budgeted
from symflex.cli.reporting import (
    emit_json,
    load,
    note,
    outside,
    reporting,
    say,
    setting,
    show_error,
    terminal_width,
)
from symflex.errors import BudgetError, Diagnostic, UsageError

if TYPE_CHECKING:
    from symflex.analysis.explanation import ZeroExplanation
    from symflex.analysis.sensitivity import Sensitivity
    from symflex.roots import Region

DIGITS_LIMIT = 10_000
DERIVING = 0.5
"""Seconds that deriving may take in any case, by which a command may exceed its time."""


@click.command("roots")
@click.argument("spec", type=click.Path())
@outside
@click.option("--tf", metavar="OUT/IN", help="The transfer function; the first one by default.")
@click.option("--modes", type=click.IntRange(1), help="Only the N lowest modes, with roots at the origin.")
@click.option("--mode", type=click.IntRange(1), help="Only mode number N, by natural frequency.")
@click.option(
    "--band", nargs=2, metavar="LO HI", help='Only natural frequencies in a band: 0.1 1000, "1 kHz".'
)
@click.option("--region", nargs=4, metavar="RE0 RE1 IM0 IM1", help="Only a rectangle of the s plane [rad/s].")
@click.option(
    "--digits", type=click.IntRange(1, DIGITS_LIMIT), help="Correct significant digits.  [default: 15]"
)
@click.option("--explain", is_flag=True, help="Say which constrained system's poles the zeros are.")
@click.option(
    "--sensitivity",
    "wanted",
    metavar="[PARAM]",
    multiple=True,
    is_flag=False,
    flag_value="",
    help="How roots move with a parameter, all of them when none is named; may be repeated.",
)
@click.option("--strict", is_flag=True, help="Exit with code 4 also when a part of the region is left out.")
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
@budgeted
@reporting
@setting
def command(
    spec: str,
    *,
    allow_outside: tuple[str, ...],
    settings: dict[str, str],
    tf: str | None,
    modes: int | None,
    mode: int | None,
    band: tuple[str, str] | None,
    region: tuple[str, str, str, str] | None,
    digits: int | None,
    wanted: tuple[str, ...],
    strict: bool,
    explain: bool,
    as_json: bool,
) -> int:
    """Print poles, zeros and hidden modes of one transfer function of SPEC.

    Every root is proved to lie within its radius, with its multiplicity, and none is missing. Distributed
    systems have infinitely many, of which the lowest are shown by default. Exit code 4 says that roots could
    not be told apart, or that their number could not be proved; exit code 5, that the budget was exceeded:
    what was proved until then is shown.

    --sensitivity adds the relative change of each natural frequency, and the change of each damping ratio,
    per relative change of a parameter. It takes the next word as a name: put it after SPEC.
    """
    from symflex import pipeline
    from symflex.cli.progress import ProgressBar
    from symflex.print.text import roots_text

    chosen = region_of(modes, mode, band, region)
    # However short the time is, what is sought is told, and how many roots there are.
    with entered_budget().at_least(DERIVING).entered():
        model = load(spec, allow_outside, settings)
        pairs = pipeline.pick_pairs(model, [tf] if tf else [])
        if tf is None and len(pairs) > 1:
            others = ", ".join("/".join(pair) for pair in pairs[1:])
            note(f"showing {'/'.join(pairs[0])}; choose with --tf: {others}")
        shown = digits or model.analysis.digits or 15
        (bound,) = pipeline.derive_bound(model, pairs[:1])
    with ProgressBar() as bar:
        found = pipeline.roots(bound, chosen, shown, entered_budget().told(bar))
    moved: tuple[Sensitivity, ...] = ()
    explained: ZeroExplanation | None = None
    is_over = found.certificate.is_exceeded
    try:
        if wanted:
            names = [] if "" in wanted else wanted
            moved = pipeline.sensitivities(model, bound, found, names, shown)
        explained = pipeline.explain_zeros(model, bound, found) if explain else None
    except BudgetError as error:
        show_error(error)
        wanted, is_over = (), True
    if as_json:
        more: dict[str, object] = {}
        if wanted:
            more["sensitivity"] = [m.to_json_dict(shown) for m in moved]
        if explained is not None:
            from symflex.analysis.explanation import explanation_json  # most calls need none of it

            more["explanation"] = explanation_json(explained)
        emit_json({**found.to_json_dict(), **more})
    else:
        say(roots_text(found, shown, terminal_width()))
        if wanted:
            from symflex.analysis.sensitivity.text import sensitivity_text  # most calls need none of it

            say(sensitivity_text(moved, terminal_width()))
        if explained is not None:
            from symflex.analysis.explanation import explanation_text

            say("\n" + explanation_text(explained, terminal_width()))
    if is_over:
        return 5
    if any(m.status == "undecided" for m in moved):
        return 4
    return 0 if found.certificate.certified and not (strict and found.excluded) else 4


def region_of(
    modes: int | None,
    mode: int | None,
    band: tuple[str, str] | None,
    region: tuple[str, str, str, str] | None,
) -> Region | None:
    """Return the region that options say, ``None`` when they say nothing.

    Raises
    ------
    UsageError
        SF902 for more than one of them, or limits that are none.
    """
    from symflex.roots import Band, Mode, Modes, Rectangle

    if sum(choice is not None for choice in (modes, mode, band, region)) > 1:
        raise UsageError(Diagnostic("SF902", "give only one of --modes, --mode, --band and --region"))
    if modes is not None:
        return Modes(modes)
    if mode is not None:
        return Mode(mode)
    if band is not None:
        return Band(*band_limits(band))
    if region is not None:
        re_low, re_high, im_low, im_high = (
            frequency_limit(text, "--region", "-10 or '3 rad/s'", hertz=False) for text in region
        )
        if re_low > re_high or im_low > im_high:
            raise UsageError(Diagnostic("SF902", "--region takes RE0 <= RE1 and IM0 <= IM1"))
        return Rectangle(re_low, re_high, im_low, im_high)
    return None


def band_limits(band: tuple[str, str], *, above_zero: bool = False) -> tuple[Fraction, Fraction]:
    """Return the ends of a band [Hz].

    Raises
    ------
    UsageError
        SF902 for what is no frequency, where the first is not the lower one, and for 0 where frequencies are
        equally spaced in their logarithm.
    """
    low, high = (frequency_limit(text, "--band", "0.1 or '1 kHz'", hertz=True) for text in band)
    if not 0 <= low < high or (above_zero and not low):
        above = " above 0" if above_zero else ""
        message = f"--band takes two frequencies in Hz{above}, the lower one first"
        raise UsageError(Diagnostic("SF902", message))
    return low, high


def plain_number(text: str, units: tuple[str, ...]) -> float:
    """Return the number a text says, with or without one of some units; not a number where it says none."""
    for unit in units:
        text = text.strip().removesuffix(unit)
    try:
        return float(text)
    except ValueError:
        return nan


def frequency_limit(text: str, option: str, example: str, *, hertz: bool) -> Fraction:
    """Return a limit in Hz, or in rad/s, from a number or a quantity that counts per second."""
    from symflex.errors import Source, Span, SpecError, Text
    from symflex.model.analysis import PER_SECOND, PI_NEARLY, in_limits
    from symflex.quantities import parse_quantity

    wrong = UsageError(Diagnostic("SF902", f"{option} takes numbers such as {example}, found '{text[:60]}'"))
    try:
        quantity = parse_quantity(Text(text, Span(Source(option, text), 0, len(text))))
    except SpecError:
        raise wrong from None
    if quantity.unit and quantity.dimension != PER_SECOND:
        raise wrong
    number = in_limits(quantity)
    if not quantity.unit or bool(quantity.cycles) == hertz:
        return number
    return number / (2 * PI_NEARLY) if hertz else number * 2 * PI_NEARLY
