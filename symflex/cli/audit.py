"""``symflex audit``."""

from __future__ import annotations

from symflex.cli.command import Specification, command_of
from symflex.cli.reporting import emit_json, note, say, terminal_width
from symflex.options import AuditOptions


@command_of("audit", AuditOptions)
def command(spec: Specification, given: AuditOptions) -> int:
    """Compare what SPEC says was printed with what is derived.

    Every formula of [published] is proved equal, or what is different is shown, with the structural laws it
    violates. A difference is a result: the exit code is 0, and 4 with --strict.
    """
    from symflex import pipeline
    from symflex.audit.text import audit_document, audit_text

    model = spec.load()
    audits = pipeline.audit(model, given.tfs)
    if not model.published:
        note('nothing is published in this specification: [published."OUT/IN"] holds a printed formula')
    if given.as_json:
        emit_json(audit_document(audits))
    elif audits:
        width = terminal_width()
        say("\n\n".join(audit_text(audit, width) for audit in audits))
    is_equal = bool(audits) and all(audit.verdict == "equal" for audit in audits)
    return 4 if given.strict and not is_equal else 0
