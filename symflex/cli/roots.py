"""``symflex roots``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.budget import entered_budget
from symflex.cli.command import Specification, command_of, first_pair
from symflex.cli.reporting import emit_json, say, show_error, terminal_width
from symflex.errors import BudgetError
from symflex.options import RootsOptions

if TYPE_CHECKING:
    from symflex.analysis.explanation import ZeroExplanation
    from symflex.analysis.sensitivity import RootDerivative

DERIVING = 0.5
"""Seconds that deriving may take in any case, by which a command may exceed its time."""


@command_of("roots", RootsOptions)
def command(spec: Specification, given: RootsOptions) -> int:
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
    from symflex.roots.region import region_of

    chosen = region_of(given, "--")
    # However short the time is, what is sought is told, and how many roots there are.
    with entered_budget().at_least(DERIVING).entered():
        model = spec.load()
        pair = first_pair(model, given.tf, "showing")
        shown = given.digits or model.analysis.digits or 15
        (bound,) = pipeline.derive_bound(model, [pair])
    with ProgressBar() as bar:
        found = pipeline.roots(bound, chosen, shown, entered_budget().told(bar))
    moved: tuple[RootDerivative, ...] = ()
    explained: ZeroExplanation | None = None
    wanted, is_over = bool(given.sensitivity), found.certificate.is_exceeded
    try:
        if wanted:
            names = [] if "" in given.sensitivity else given.sensitivity
            moved = pipeline.sensitivities(model, bound, found, names, shown)
        explained = pipeline.explain_zeros(model, bound, found) if given.explain else None
    except BudgetError as error:
        show_error(error)
        wanted, is_over = False, True
    if given.as_json:
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
    return 0 if found.certificate.certified and not (given.strict and found.excluded) else 4
