"""``symflex check``."""

from __future__ import annotations

from symflex.cli.command import Specification, command_of
from symflex.cli.reporting import diagnostic_json, emit_json, listed, say, show
from symflex.errors import SymflexError
from symflex.errors.diagnostic import printable
from symflex.options import CheckOptions


@command_of("check", CheckOptions)
def command(spec: Specification, given: CheckOptions) -> int:
    """Parse and resolve SPEC; report every problem at once.

    Names, units, ports, linearity and solvability are checked; nothing is derived.

    Warnings tell what a typing error may have left behind: a node that one element touches, a name that
    nothing uses, an input that reaches nothing, an element without effect. They also say how a frequency was
    read, in cycles or in radians, where an expression could mean either. All other commands print them too.
    """
    from symflex import pipeline

    try:
        model = pipeline.load(spec.path, spec.allow_outside, spec.settings)
        equations = pipeline.assemble(model)
        pipeline.check_solvable(equations)
    except SymflexError as error:
        if not given.as_json:
            raise
        problems = [diagnostic_json(d) for d in error.diagnostics]
        emit_json({"schema": "symflex.check/1", "ok": False, "problems": problems, "warnings": []})
        return error.exit_code
    warnings = pipeline.warnings(model, equations)
    code = 3 if given.strict and warnings else 0
    names = ["/".join(pair) for pair in model.transfer_functions]
    if given.as_json:
        document = {
            "problems": [],
            "warnings": [diagnostic_json(w) for w in warnings],
            "transfer_functions": names,
        }
        emit_json({"schema": "symflex.check/1", "ok": True, **document})
        return code
    show(warnings)
    symbolic = [p.name for p in model.parameters if p.value is None]
    counts = ", ".join(
        f"{len(group)} {word}{'' if len(group) == 1 else 's'}"
        for group, word in (
            (model.parameters, "parameter"),
            (model.nodes, "node"),
            (model.elements, "element"),
            (model.signals, "signal"),
            (model.blocks, "block"),
            (model.fields, "field"),
        )
        if group
    )
    said = f", {len(warnings)} warning{'' if len(warnings) == 1 else 's'}" if warnings else ""
    say(f"{printable(spec.path)}: ok{said}")
    if model.title:
        say(listed("", printable(model.title).split(), " "))
    say(listed("", counts.split(), " "))
    say(listed("transfer functions: ", names))
    if symbolic:
        say(listed("symbolic (no value): ", symbolic))
    return code
