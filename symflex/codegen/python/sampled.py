"""Difference equations as one Python module that imports nothing."""

from __future__ import annotations

from symflex.codegen.export import Export
from symflex.codegen.module_text import WIDTH, BlockComment
from symflex.codegen.python.dialects import NUMPY_DIALECT
from symflex.codegen.python.module import docstring
from symflex.codegen.sampled import SampledLanguage, StepFile, StepFunction


def python_steps(file: StepFile) -> Export:
    """Return a module with two functions for each transfer function: of the first states, and of a step."""
    example = file.functions[0].name
    usage = (
        f"w = {example}_start() are the initial states, all zero, and y = {example}_step(w, u) takes the "
        "input of this sample, returns the output and advances the states. u may be an array of inputs."
    )
    head = docstring([*file.introduction(usage, WIDTH)], "")
    imports = "from __future__ import annotations\n\nfrom typing import Any\n"
    sample_time = f"SAMPLE_TIME = {float(file.sampling.sample)!r}  # [s]\n"
    functions = [text for function in file.functions for text in _functions(function)]
    return Export("\n".join([head, imports, "\n\n".join([sample_time, *functions])]))


def _functions(function: StepFunction) -> tuple[str, str]:
    late, order = function.late, function.equation.order
    body = ["x = u"]
    if late:
        body = [f"x = w[{order}]", f"w[{order}:-1] = w[{order + 1}:]", "w[-1] = u"]
    body += [f"{target} = {value}" for target, value in function.equation.assignments()]
    first, *others = function.described(WIDTH - 4)
    start = (
        f"def {function.name}_start() -> list[Any]:\n"
        f'    """Return the initial states: those of sections, then past inputs."""\n'
        f"    return [0.0] * {order + late}\n"
    )
    lines = [f"def {function.name}_step(w: list[Any], u: Any) -> Any:"]
    lines += [docstring([first, *(f"    {x}" for x in others)], "    ").rstrip("\n")]
    return start, "\n".join([*lines, *(f"    {line}" for line in body), "    return x", ""])


SAMPLED_PYTHON = SampledLanguage(
    ".py",
    "Python module, two functions for each transfer function",
    python_steps,
    BlockComment('"""', '"""', "", ()),
    sorted(NUMPY_DIALECT.reserved | {"x", "y", "w", "u", "np"}),
)
