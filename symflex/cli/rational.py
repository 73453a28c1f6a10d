"""``symflex rational``."""

from __future__ import annotations

from symflex.cli.command import Specification, command_of, first_pair
from symflex.cli.reporting import emit_json, say
from symflex.options import RationalOptions


@command_of("rational", RationalOptions)
def command(spec: Specification, given: RationalOptions) -> None:
    """Print a rational approximation of one transfer function of SPEC.

    Of a beam, rod or delay, a number of modes is kept: in product form their poles and zeros, in modal form
    their residues and a static correction. The frequencies up to which the approximation is within 1 % and
    5 % of the exact function are found by sampling. A lumped system with all its modes is its own
    approximation.
    """
    from symflex import pipeline
    from symflex.analysis.rational.text import rational_json, rational_text

    model = spec.load()
    (bound,) = pipeline.derive_bound(model, [first_pair(model, given.tf, "showing")])
    found = pipeline.rational(bound, given.modes, given.form)
    if given.as_json:
        emit_json(rational_json(found))
    else:
        say(rational_text(found))
