"""``symflex rational``."""

from __future__ import annotations

import click

from symflex.cli.budgeting import budgeted
from symflex.cli.reporting import emit_json, load, note, outside, reporting, say, setting


@click.command("rational")
@click.argument("spec", type=click.Path())
@outside
@click.option("--tf", metavar="OUT/IN", help="The transfer function; the first one by default.")
@click.option(
    "--modes", type=click.IntRange(0), help="How many modes are kept.  [default: those of [analysis], or 5]"
)
@click.option(
    "--form",
    type=click.Choice(["product", "modal"]),
    default="product",
    show_default=True,
    help="Poles and zeros, or residues.",
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
    tf: str | None,
    modes: int | None,
    form: str,
    as_json: bool,
) -> None:
    """Print a rational approximation of one transfer function of SPEC.

    Of a beam, rod or delay, a number of modes is kept: in product form their poles and zeros, in modal form
    their residues and a static correction. The frequencies up to which the approximation is within 1 % and
    5 % of the exact function are found by sampling. A lumped system with all its modes is its own
    approximation.
    """
    from symflex import pipeline
    from symflex.analysis.rational.text import rational_json, rational_text

    model = load(spec, allow_outside, settings)
    pairs = pipeline.pick_pairs(model, [tf] if tf else [])
    if tf is None and len(pairs) > 1:
        others = ", ".join("/".join(pair) for pair in pairs[1:])
        note(f"showing {'/'.join(pairs[0])}; choose with --tf: {others}")
    (bound,) = pipeline.derive_bound(model, pairs[:1])
    found = pipeline.rational(bound, modes, form)
    if as_json:
        emit_json(rational_json(found))
    else:
        say(rational_text(found))
