"""Why a system has no unique solution: what floats, what is redundant, which loop is algebraic."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flint import nmod_mat

from symflex.errors import Diagnostic, ModelError
from symflex.kernels import PRIME, random_point, residue

if TYPE_CHECKING:
    from symflex.equations import Equations
    from symflex.errors import Span

SHOWN = 6


def explain_singular(equations: Equations) -> ModelError:
    """Return the error that names the unknowns left open and the rows that repeat others.

    The null spaces are taken at a random point of a prime field, where a nonzero entry proves that the
    unknown (or row) takes part in the dependence.
    """
    matrix = _at_random_point(equations)
    size = len(equations.unknowns)
    free = _support(matrix, size)
    dependent = _support(matrix.transpose(), len(equations.rows))
    open_unknowns = [equations.unknowns[i] for i in free]
    rows = [equations.rows[i] for i in dependent]
    constraints = [r for r in rows if r.role == "constraint"]
    loops = [r for r in rows if r.role == "signal"]
    problems: list[Diagnostic] = []
    nodes = [v for v in open_unknowns if v.kind == "node"]
    if constraints:
        owners = list(dict.fromkeys(r.about.owner for r in constraints))
        names = _listed([f"'{o}'" for o in owners])
        message = (
            f"the constraints of {names} repeat or contradict each other"
            if len(owners) > 1
            else f"the constraint of {names} repeats what is already imposed"
        )
        problems.append(Diagnostic("SF302", message, _place(equations, owners[-1]), "remove one of them"))
    elif nodes:
        names = _listed([f"'{v}'" for v in nodes])
        alone = len(nodes) == 1
        what, verb, hold = ("node", "it floats", "it") if alone else ("nodes", "they float", "them")
        problems.append(
            Diagnostic(
                "SF301",
                f"nothing determines {what} {names}: {verb}",
                _place(equations, nodes[0].owner),
                f"connect {hold} to ground or give {hold} a mass",
            )
        )
    elif loops:
        names = _listed([f"'{r.about}'" for r in loops])
        problems.append(
            Diagnostic(
                "SF303",
                f"the loop through {names} is algebraic and has no unique solution: its gain is exactly one",
                _place(equations, loops[0].about.owner),
                "put a dynamic element or another gain into the loop",
            )
        )
    if not problems:
        names = _listed([f"'{v}'" for v in open_unknowns])
        place = _place(equations, open_unknowns[0].owner) if open_unknowns else None
        problems.append(Diagnostic("SF304", f"nothing determines {names}", place))
    return ModelError(*problems)


def _listed(names: list[str]) -> str:
    if len(names) > SHOWN:
        names = [*names[:SHOWN], f"{len(names) - SHOWN} more"]
    return (
        names[0]
        if len(names) == 1
        else ", ".join(names[:-1]) + " and " + names[-1]
        if names
        else "the system"
    )


def _at_random_point(equations: Equations) -> nmod_mat:
    point = random_point(equations.ring.names)
    for name, value in equations.definitions:
        point[name] = residue(value, point)
    columns = {v: i for i, v in enumerate(equations.unknowns)}
    entries = [0] * (len(equations.rows) * len(columns))
    for i, row in enumerate(equations.rows):
        for variable, coefficient in row.form.terms:
            if variable in columns:
                position = i * len(columns) + columns[variable]
                entries[position] = (entries[position] + residue(coefficient, point)) % PRIME
    return nmod_mat(len(equations.rows), len(columns), entries, PRIME)


def _support(matrix: nmod_mat, size: int) -> list[int]:
    """Return the positions that take part in the (right) null space."""
    basis, dimension = matrix.nullspace()
    return [i for i in range(size) if any(int(basis[i, j]) for j in range(dimension))]


def _place(equations: Equations, owner: str) -> Span | None:
    model = equations.model
    for group in (model.elements, model.signals, model.nodes, model.inputs, model.outputs):
        for item in group:
            if item.name == owner and item.span is not None:
                return item.span
    return None


def is_singular(equations: Equations) -> bool:
    """Tell whether the determinant vanishes at a random point of a prime field."""
    if len(equations.rows) != len(equations.unknowns):
        return True
    return bool(equations.unknowns) and int(_at_random_point(equations).rank()) < len(equations.unknowns)
