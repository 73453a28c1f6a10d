"""``%%symflex``: a specification in a cell of a notebook, its formulas and roots below.

Input: the text of a cell. Output: what ``derive`` and ``roots`` say of it, set as a notebook sets it;
problems with their places, in place of a traceback. ``%load_ext symflex`` registers it.

    %%symflex model
    symflex = 1
    ...                   the model is then in the variable of that name
"""

from __future__ import annotations

import sys
from importlib import import_module
from typing import Any

from symflex.api.model import loads
from symflex.errors import Diagnostic, SymflexError, UsageError

CELL = "<cell>"


def register(shell: Any) -> None:  # noqa: ANN401 (IPython is not needed elsewhere)
    """Make ``%%symflex`` known to an IPython shell."""

    def cell_magic(line: str, cell: str) -> None:
        name = line.strip()
        if name and not name.isidentifier():
            hint = "%%symflex model puts the model into the variable 'model'"
            _say(UsageError(Diagnostic("SF902", f"'{name[:64]}' is no name of a variable", None, hint)))
            return
        shown: list[object] = []
        try:
            model = loads(cell, CELL)
            shown.append(model)
            has_values = all(p.value is not None for p in model.parameters)
            for function in model.transfer_functions():
                shown += [function, *([function.bind().pole_zero_map()] if has_values else [])]
        except SymflexError as error:
            _say(error)
            if not shown:
                return
        if name:
            shell.user_ns[name] = model
        display = import_module("IPython.display").display
        for one in shown:
            display(one)

    shell.register_magic_function(cell_magic, "cell", "symflex")


def _say(error: SymflexError) -> None:
    sys.stderr.write("\n".join(d.render() for d in error.diagnostics) + "\n")
