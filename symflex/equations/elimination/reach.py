"""What an input moves and an output sees: inputs, outputs and elements that could as well be left out.

Input: equations with a unique solution.
Output: warnings, from one solution at a random point of a prime field, where only what is zero vanishes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.equations.elimination.singular import listed, matrix_of, numbers_at_random
from symflex.errors import Diagnostic
from symflex.library.elements import LineElement, Variable
from symflex.model.nodes import domain_of, variable_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from flint import nmod_mat

    from symflex.equations import Equations
    from symflex.model import Model, PlacedElement


def unreached(equations: Equations) -> tuple[Diagnostic, ...]:
    """Return a warning for every input that reaches nothing, output that stays zero, and idle element.

    Parameters
    ----------
    equations : Equations
        Not singular.

    Returns
    -------
    tuple of Diagnostic
        SF652 an input whose transfer functions are all zero, SF653 an output that no input reaches, SF654 an
        element without which every transfer function is the same.
    """
    model = equations.model
    prime, value = numbers_at_random(equations)
    forms = [row.form for row in equations.rows]
    whole = matrix_of(forms, equations.unknowns, prime, value)
    seen = matrix_of([o.form for o in equations.outputs], equations.unknowns, prime, value)
    through = matrix_of([o.form for o in equations.outputs], equations.inputs, prime, value)
    if equations.unknowns:
        driven = whole.solve(matrix_of(forms, equations.inputs, prime, value))
        through = through - seen * driven
    found = list(_zero_ends(equations, through))
    if equations.unknowns and any(int(x) for x in through.entries()):
        felt = whole.transpose().solve(seen.transpose())
        found += _idle_elements(equations, driven, felt)
    told = {d.span for d in model.warnings}
    return tuple(d for d in found if d.span not in told)


def _zero_ends(equations: Equations, through: nmod_mat) -> Iterator[Diagnostic]:
    model = equations.model
    rows, columns = range(len(model.outputs)), range(len(model.inputs))
    idle = [j for j in columns if all(not int(through[i, j]) for i in rows)]
    for j in idle:
        source = model.inputs[j]
        message = f"input '{source.name}' reaches no output: all its transfer functions are 0"
        hint = "is a name on its way misspelt, or does an output lack?"
        yield Diagnostic("SF652", message, source.span, hint, "warning")
    for i in rows if len(idle) < len(model.inputs) else ():
        if all(not int(through[i, j]) for j in columns):
            output = model.outputs[i]
            message = f"no input reaches output '{output.name}': all its transfer functions are 0"
            hint = "is a name in its expression, or on the way to it, misspelt?"
            yield Diagnostic("SF653", message, output.span, hint, "warning")


def _idle_elements(equations: Equations, driven: nmod_mat, felt: nmod_mat) -> Iterator[Diagnostic]:
    """Yield the branches and masses that no input strains, and those no output would feel.

    A branch changes the transfer functions by a product: what the inputs put across it times what the outputs
    see of a force through it (Sherman and Morrison 1950). Where one of the two is zero, the branch is idle.
    """
    model = equations.model
    place = {v: i for i, v in enumerate(equations.unknowns)}
    told = {d.span for d in model.warnings}
    loose = {n.name for n in model.nodes if n.span in told}
    balance = {r.about: i for i, r in enumerate(equations.rows) if r.role == "balance"}
    idle: dict[str, list[PlacedElement]] = {}
    for use in model.elements:
        ends = _ends(use, model)
        if not ends or any(v.owner in loose for v in ends):
            continue
        columns = range(len(model.inputs))
        first, *others = ([int(driven[place[v], j]) for j in columns] for v in ends)
        if not (any(first) if not others else first != others[0]):
            idle.setdefault("no input strains" if others else "no input moves", []).append(use)
        elif not any(int(felt[balance[v], i]) for v in ends for i in range(len(model.outputs))):
            idle.setdefault("no output sees", []).append(use)
    for why, uses in idle.items():
        who = [f"{use.element.type_name} '{use.name}'" for use in uses]
        change, them = ("changes", "it") if len(uses) == 1 else ("change", "them")
        message = f"{listed(who)} {change} no transfer function: {why} {them}"
        hint = "is a node's name misspelt, or does an end hang free?"
        yield Diagnostic("SF654", message, uses[0].span, hint, "warning")


def _ends(use: PlacedElement, model: Model) -> tuple[Variable, ...]:
    """Return what a mass or a branch stands on, without ground; nothing for all other elements."""
    parameters = use.element.parameters
    if len(use.nodes) != 1 or isinstance(use.element, LineElement):
        return ()
    if not parameters or any(p.signal for p in parameters) or use.domains[0][1] == "planar":
        return ()
    nodes = {n.name: n for n in model.nodes}
    ((_, references),), domain = use.nodes, use.domains[0][1]
    live = [(r, nodes[r.node]) for r in references if not r.is_ground]
    if any(domain_of(r, n) != domain for r, n in live):
        return ()
    return tuple(variable_of(r, n, domain) for r, n in live)
