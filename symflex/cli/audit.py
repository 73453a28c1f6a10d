"""``symflex audit``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from symflex.cli.budgeting import budgeted
from symflex.cli.reporting import emit_json, load, note, outside, reporting, say, setting, terminal_width

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.audit import Audit


@click.command("audit")
@click.argument("spec", type=click.Path())
@outside
@click.option("--tf", "tfs", multiple=True, metavar="OUT/IN", help="Only this formula; repeatable.")
@click.option("--strict", is_flag=True, help="Exit with code 4 unless every formula is proved equal.")
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
@budgeted
@reporting
@setting
def command(
    spec: str,
    *,
    allow_outside: tuple[str, ...],
    settings: dict[str, str],
    tfs: tuple[str, ...],
    strict: bool,
    as_json: bool,
) -> int:
    """Compare what SPEC says was printed with what is derived.

    Every formula of [published] is proved equal, or what is different is shown, with the structural laws it
    violates. A difference is a result: the exit code is 0, and 4 with --strict.
    """
    from symflex import pipeline
    from symflex.audit.json_format import audit_document
    from symflex.audit.text import audit_text

    model = load(spec, allow_outside, settings)
    audits = pipeline.audit(model, tfs)
    if not model.published:
        note('nothing is published in this specification: [published."OUT/IN"] holds a printed formula')
    if as_json:
        emit_json(audit_document(audits))
    elif audits:
        width = terminal_width()
        say("\n\n".join(audit_text(audit, width) for audit in audits))
    return _code(audits) if strict else 0


def _code(audits: Sequence[Audit]) -> int:
    return 0 if audits and all(audit.verdict == "equal" for audit in audits) else 4
