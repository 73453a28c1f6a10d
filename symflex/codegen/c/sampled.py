"""Difference equations as a C99 source and its header."""

from __future__ import annotations

from symflex.codegen.c.body import KEYWORDS, RESERVED
from symflex.codegen.c.module import COMMENT, prefix_of, source_and_header
from symflex.codegen.export import Export
from symflex.codegen.module_text import WIDTH
from symflex.codegen.sampled import SampledLanguage, StepFile, StepFunction

ROOM = WIDTH - 3  # columns of a comment


def c_steps(file: StepFile) -> Export:
    """Return source and header, or one file, with a structure and a function for each transfer function."""
    prefix = prefix_of(file.stem)
    example = f"{prefix}_{file.functions[0].name}"
    usage = (
        f"Begin with a {example}_state that is all zero; {example}_step takes the input of this "
        "sample, returns the output and advances the state. It allocates no memory and has no other "
        "state. Fused operations (-ffp-contract) change the last digits."
    )
    declared, defined = [], []
    for function in file.functions:
        name = f"{prefix}_{function.name}"
        step = f"double {name}_step({name}_state *state, double u)"
        members = [f"    double w[{max(function.equation.order, 1)}];"]
        members += [f"    double past[{function.late}];", "    int next;"] if function.late else []
        declared += [*COMMENT.lines(function.described(ROOM)), "typedef struct {", *members]
        declared += [f"}} {name}_state;", "", f"{step};", ""]
        defined += [step, "{", *(f"    {line}" for line in _body(function)), "    return x;", "}", ""]
    source = "\n".join(defined)
    return source_and_header(file.stem, file.introduction(usage, ROOM), (), declared, source)


def _body(function: StepFunction) -> list[str]:
    late, order = function.late, function.equation.order
    body = ["double *const w = state->w;"] if order else []
    body += ["double x = u, y;"]
    if late:
        body += ["x = state->past[state->next];", "state->past[state->next] = u;"]
        body += [f"state->next = (state->next + 1) % {late};"]
    elif not order:
        body += ["(void)state;"]
    return [*body, *(f"{target} = {value};" for target, value in function.equation.assignments())]


SAMPLED_C = SampledLanguage(
    ".c",
    "C99 source and header, a structure and a function for each transfer function",
    c_steps,
    COMMENT,
    sorted({*KEYWORDS, *RESERVED}),
)
