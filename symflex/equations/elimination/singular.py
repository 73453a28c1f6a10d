"""Why a system has no unique solution, and what of one that has could as well be left out.

The first says what floats, what is redundant, which loop is algebraic. The second warns of inputs that move
nothing and outputs that see nothing, from one solution at a random point of a prime field, where only what is
zero vanishes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from random import Random
from typing import TYPE_CHECKING

from flint import nmod_mat, nmod_poly

from symflex.algebra import LAPLACE, PRIME, Factored, random_point, residue
from symflex.errors import Diagnostic, ModelError, Span
from symflex.errors.diagnostic import nearest
from symflex.expressions import Attribute, format_expression, names
from symflex.library.elements import CIRCUITS, COMPONENTS, EquationRow, LinearForm, LineElement, Variable
from symflex.model import Model, PlacedElement
from symflex.model.network import domain_of, variable_of

if TYPE_CHECKING:
    from symflex.algebra.propagators import Propagation
    from symflex.algebra.vanishing import TaylorField
    from symflex.equations import Equations


SHOWN = 6


def explain_singular(equations: Equations) -> ModelError:
    """Return the error that names unknowns left open and rows that repeat others, by a random point."""
    matrix = _at_random_point(equations)
    size = len(equations.unknowns)
    free = _support(matrix, size)
    dependent = _support(matrix.transpose(), len(equations.rows))
    open_unknowns = [equations.unknowns[i] for i in free]
    rows = [equations.rows[i] for i in dependent]
    constraints = [r for r in rows if r.role == "constraint"]
    # What follows from a node that floats is open, too: that node itself occurs in rows that repeat others.
    involved = {r.about for r in rows} | {v for r in rows for v, _ in r.form.terms}
    nodes = [v for v in open_unknowns if v.kind == "node" and (v in involved or not rows)]
    if loop := _loop(equations, matrix, rows):
        problem = loop
    elif constraints:
        owners = list(dict.fromkeys(r.about.owner for r in constraints))
        names = listed([f"'{o}'" for o in owners])
        message = (
            f"the constraints of {names} repeat or contradict each other"
            if len(owners) > 1
            else f"the constraint of {names} repeats what is already imposed"
        )
        last = next(r.about for r in constraints if r.about.owner == owners[-1])
        held = any(
            use.name in owners and use.element.type_name == "fixed" for use in equations.model.elements
        )
        is_moved = held and any(x.name in owners for x in equations.model.inputs)
        hint = 'hold only what no input moves, as in at = "base.theta"'
        hint = hint if is_moved else "remove one of them"
        problem = Diagnostic("SF302", message, _place(equations, last), hint)
    elif conditions := [r for r in rows if r.role == "condition"]:
        problem = _dependent_conditions(equations, conditions)
    elif written := [r for r in rows if r.role == "equation"]:
        signals = {x.name: x.expression for x in equations.model.signals}
        texts = [f"'{format_expression(signals[r.about.owner])}'" for r in written]
        message = (
            f"the equations {listed(texts)} repeat or contradict each other"
            if len(texts) > 1
            else f"the equation {texts[0]} determines none of the unknowns"
        )
        missing = listed([f"'{v}'" for v in open_unknowns])
        hint = f"nothing determines {missing}; replace one of them"
        problem = Diagnostic("SF302", message, signals[written[-1].about.owner].span, hint)
    elif nodes:
        names = listed([f"'{v}'" for v in nodes])
        alone = len(nodes) == 1
        what, verb, hold = ("node", "it floats", "it") if alone else ("nodes", "they float", "them")
        message, hint = f"nothing determines {what} {names}: {verb}", _held(equations.model, nodes, hold)
        hint = _meant(equations.model, nodes, hint)
        problem = Diagnostic("SF301", message, _place(equations, nodes[0]), hint)
    else:
        names = listed([f"'{v}'" for v in open_unknowns])
        location = _place(equations, open_unknowns[0]) if open_unknowns else None
        problem = Diagnostic("SF304", f"nothing determines {names}", location)
    return ModelError(problem)


def _loop(equations: Equations, matrix: nmod_mat, rows: Sequence[EquationRow]) -> Diagnostic | None:
    """Return what is wrong with a loop of gain one, if there is one solution once its signals are given."""
    signals = [r for r in rows if r.role == "signal"]
    kept = [i for i, r in enumerate(equations.rows) if r not in signals]
    given = {r.about for r in signals}
    columns = [i for i, v in enumerate(equations.unknowns) if v not in given]
    entries = [int(matrix[i, j]) for i in kept for j in columns]
    opened = nmod_mat(len(kept), len(columns), entries, matrix.modulus())
    if not signals or opened.rank() < len(columns):
        return None
    through: dict[str, list[str]] = {}
    elements = {use.name: use.element.type_name for use in equations.model.elements}
    for row in (*signals, *(r for r in rows if r.about.kind == "node")):
        about = row.about
        is_source = row.role == "signal" and bool(about.component)
        noun, name = (elements[about.owner], about.owner) if is_source else (about.kind, str(about))
        through.setdefault("signal" if noun == "value" else noun, []).append(f"'{name}'")
    said = [f"{noun}{'s' if len(of) > 1 else ''} {listed(of)}" for noun, of in through.items()]
    is_dynamic = any(c.depends_on(LAPLACE) for r in rows for c in r.form.coefficients)
    what = "has" if is_dynamic else "is algebraic and has"
    message = f"the loop through {listed(said)} {what} no unique solution: its gain is exactly one"
    other = "another gain" if is_dynamic else "a dynamic element or another gain"
    return Diagnostic("SF303", message, _place(equations, signals[0].about), f"put {other} into the loop")


def _held(model: Model, nodes: Sequence[Variable], hold: str) -> str:
    """Return how nodes are held, in the words of their domain."""
    domain = next((n.domain for n in model.nodes if n.name == nodes[0].owner), "")
    if domain in CIRCUITS:
        return f"connect {hold} to ground, directly or through an element"
    return f"connect {hold} to ground or give {hold} {'an inertia' if domain == 'rotation' else 'a mass'}"


def _meant(model: Model, nodes: Sequence[Variable], otherwise: str) -> str:
    """Return a hint with the nearest name to that of a lone node which one element touches at most."""
    owners = {node.owner for node in nodes}
    touched = [{r.node for _, references in use.nodes for r in references} for use in model.elements]
    (owner,) = owners if len(owners) == 1 else ("",)
    touching = sum(owner in t for t in touched)
    if not owner or touching > 1:
        return otherwise
    close = nearest(owner, sorted({"ground"}.union(*touched) - {owner}))
    # A name that no element touches is not a node; the lone node of one may be meant as it is.
    return otherwise if close is None else close if not touching else f"{close} else {otherwise}"


def _dependent_conditions(equations: Equations, rows: list[EquationRow]) -> Diagnostic:
    """Say which conditions of fields follow from one another."""
    fields = {f.name: f for f in equations.model.fields}
    numbered = [(r.about.owner, int(r.about.component.split()[-1])) for r in rows]
    conditions = [fields[name].conditions[number - 1] for name, number in numbered]
    texts = [f"'{format_expression(c)}'" for c in conditions]
    owners = [f"'{n}'" for n in dict.fromkeys(name for name, _ in numbered)]
    of = f"{'field' if len(owners) == 1 else 'fields'} {listed(owners)}"
    message = (
        f"the conditions {listed(texts)} of {of} repeat or contradict each other: the state is not determined"
        if len(texts) > 1
        else f"the condition {texts[0]} of {of} always holds: one is missing in its place"
    )
    hint = "replace one of them by an independent condition"
    return Diagnostic("SF302", message, conditions[-1].span, hint)


def listed(names: list[str]) -> str:
    """Return names as a sentence lists them, the first few of many."""
    if len(names) > SHOWN:
        names = [*names[:SHOWN], f"{len(names) - SHOWN} more"]
    *others, last = names or ["the system"]
    return f"{', '.join(others)} and {last}" if others else last


def free_at_rest(equations: Equations, output: str) -> tuple[str, ...]:
    """Return nodes and signals that are arbitrary at rest without input, unobservable ones first."""
    point = {**random_point(equations.ring.names), LAPLACE: 0}
    for name, value in equations.definitions:
        point[name] = _number(value, point, PRIME)
    for row in equations.rows:
        if row.role == "signal" and all(_number(c, point, PRIME) == 0 for _, c in row.form.terms):
            return ()  # what is arbitrary at rest is within a block, where s cancels
    seen = [row.form for row in equations.outputs if row.name == output]
    for forms in ([*(row.form for row in equations.rows), *seen], [row.form for row in equations.rows]):
        matrix = matrix_of(forms, equations.unknowns, PRIME, lambda c: _number(c, point, PRIME))
        free = [equations.unknowns[i] for i in _support(matrix, len(equations.unknowns))]
        if names := [str(v) for v in free if v.kind in ("node", "signal")]:
            return tuple(dict.fromkeys(names))
    return ()


def numbers_at_random(equations: Equations) -> tuple[int, Callable[[Factored], int]]:
    """Return a prime, and what evaluates coefficients at a random point that fulfils the kernels' laws."""
    if equations.propagation is not None:
        field, values = _point_of_kernels(equations, equations.propagation)
        numbers = {name: int(series[0]) for name, series in values.items()}
        return field.prime, lambda c: _number(c, numbers, field.prime)
    point = random_point(equations.ring.names)
    for name, value in equations.definitions:
        point[name] = residue(value, point)
    return PRIME, lambda coefficient: residue(coefficient, point)


def _at_random_point(equations: Equations) -> nmod_mat:
    """Return A(s) at a random point."""
    prime, value = numbers_at_random(equations)
    return matrix_of([row.form for row in equations.rows], equations.unknowns, prime, value)


def matrix_of(
    forms: Sequence[LinearForm], variables: Sequence[Variable], prime: int, value: Callable[[Factored], int]
) -> nmod_mat:
    """Return the coefficients of variables in forms, one row for each form."""
    columns = {v: i for i, v in enumerate(variables)}
    entries = [0] * (len(forms) * len(columns))
    for i, form in enumerate(forms):
        for variable, coefficient in form.terms:
            if variable in columns:
                position = i * len(columns) + columns[variable]
                entries[position] = (entries[position] + value(coefficient)) % prime
    return nmod_mat(len(forms), len(columns), entries, prime)


def _number(value: Factored, point: Mapping[str, int], prime: int) -> int:
    try:
        return residue(value, point, prime)
    except ZeroDivisionError:
        return 0


def _point_of_kernels(
    equations: Equations, propagation: Propagation
) -> tuple[TaylorField, dict[str, nmod_poly]]:
    from symflex.algebra.vanishing import (
        TaylorField,
        find_point,  # only with beams
        random_values,
    )

    ring = propagation.kernel_ring

    def define(values: dict[str, nmod_poly], field: TaylorField) -> bool:
        for name, value in equations.definitions:
            image = field.rational(value, equations.ring.names, values)
            if image is None:
                return False
            values[name] = image
        return True

    def prepare(values: dict[str, nmod_poly], field: TaylorField) -> bool:
        values.update({p.generator: field.constant(0) for p in propagation.propagators})
        return define(values, field)

    image = find_point(ring, propagation.table, 1, prepare)
    if image is None:
        field = TaylorField(1)
        values = random_values(equations.ring.names, Random(3), field)
        define(values, field)
        return field, values
    field, values = image
    for p in propagation.propagators:
        values[p.generator] = field.polynomial(p.image, ring.names, values)
    return field, values


def _support(matrix: nmod_mat, size: int) -> list[int]:
    """Return the positions that take part in the (right) null space."""
    basis, dimension = matrix.nullspace()
    return [i for i in range(size) if any(int(basis[i, j]) for j in range(dimension))]


def _place(equations: Equations, variable: Variable) -> Span | None:
    """Return where what a variable belongs to is declared: an element may bear the name of a signal."""
    model = equations.model
    elements = {x.name: x.span for x in model.elements}
    outside = {x.name: x.span for x in model.outputs} | {x.name: x.span for x in model.inputs}
    named = {"signal": {x.name: x.span for x in model.signals}, "node": {x.name: x.span for x in model.nodes}}
    return named.get(variable.kind, outside | elements).get(variable.owner)


def is_singular(equations: Equations) -> bool:
    """Tell whether the determinant vanishes at a random point of a prime field."""
    if len(equations.rows) != len(equations.unknowns):
        return True
    return bool(equations.unknowns) and int(_at_random_point(equations).rank()) < len(equations.unknowns)


def unreached(equations: Equations) -> tuple[Diagnostic, ...]:
    """Return warnings: inputs that reach nothing (SF652), outputs (SF653) and elements (SF654) unreached."""
    model = equations.model
    prime, value = numbers_at_random(equations)
    forms = [row.form for row in equations.rows]
    matrix = matrix_of(forms, equations.unknowns, prime, value)
    seen = matrix_of([o.form for o in equations.outputs], equations.unknowns, prime, value)
    through = matrix_of([o.form for o in equations.outputs], equations.inputs, prime, value)
    if equations.unknowns:
        driven = matrix.solve(matrix_of(forms, equations.inputs, prime, value))
        through = through - seen * driven
    diagnostics = list(_zero_ends(equations, through))
    if equations.unknowns and any(int(x) for x in through.entries()):
        felt = matrix.transpose().solve(seen.transpose())
        diagnostics += _idle_elements(equations, driven, felt)
    warned = {d.span for d in model.warnings}
    return tuple(d for d in diagnostics if d.span not in warned)


def _zero_ends(equations: Equations, through: nmod_mat) -> Iterator[Diagnostic]:
    model = equations.model
    rows, columns = range(len(model.outputs)), range(len(model.inputs))
    idle = [j for j in columns if all(not int(through[i, j]) for i in rows)]
    for j in idle:
        source = model.inputs[j]
        message = f"input '{source.name}' reaches no output: all its transfer functions are 0"
        hint = "check the spelling of the names on its way, or add an output"
        yield Diagnostic("SF652", message, source.span, hint, "warning")
    for i in rows if len(idle) < len(model.inputs) else ():
        if all(not int(through[i, j]) for j in columns):
            output = model.outputs[i]
            message = f"no input reaches output '{output.name}': all its transfer functions are 0"
            hint = "check the spelling of the names in its expression and on the way to it"
            yield Diagnostic("SF653", message, output.span, hint, "warning")


def _idle_elements(equations: Equations, driven: nmod_mat, felt: nmod_mat) -> Iterator[Diagnostic]:
    """Yield the branches, masses and line elements that no input strains, and those no output would feel.

    A branch changes the transfer functions by a product: what the inputs put across it times the response of
    the outputs to a force through it (Sherman and Morrison 1950). If one of them is zero, the branch is idle.
    A line element does so by its stiffness at the ends, which is regular but for single frequencies (Woodbury
    1950): it is idle if none of its ends moves, or none is felt. An expression that reads an element's own
    force depends on it however little that force moves.
    """
    model = equations.model
    read = {n.owner for _, e in model.expressions() for n in names(e) if isinstance(n, Attribute)}
    index_of = {v: i for i, v in enumerate(equations.unknowns)}
    warned = {d.span for d in model.warnings}
    loose = {n.name for n in model.nodes if n.span in warned}
    balance = {r.about: i for i, r in enumerate(equations.rows) if r.role == "balance"}
    idle: dict[str, list[PlacedElement]] = {}
    for use in model.elements:
        ends = _ends(use, model)
        if not ends or any(v.owner in loose for v in ends):
            continue
        columns = range(len(model.inputs))
        moved = [[int(driven[index_of[v], j]) for j in columns] for v in ends]
        is_branch = len(ends) > 1 and not isinstance(use.element, LineElement)
        if moved[0] == moved[1] if is_branch else not any(map(any, moved)):
            idle.setdefault("no input strains" if is_branch else "no input moves", []).append(use)
        elif use.name not in read and not any(
            int(felt[balance[v], i]) for v in ends for i in range(len(model.outputs))
        ):
            idle.setdefault("no output depends on", []).append(use)
    for why, uses in idle.items():
        who = [f"{use.element.type_name} '{use.name}'" for use in uses]
        change, them = ("changes", "it") if len(uses) == 1 else ("change", "them")
        message = f"{listed(who)} {change} no transfer function: {why} {them}"
        hint = "is a node's name misspelt, or does an end hang free?"
        yield Diagnostic("SF654", message, uses[0].span, hint, "warning")


def _ends(use: PlacedElement, model: Model) -> tuple[Variable, ...]:
    """Return what a mass, branch or line element stands on, without ground; nothing for other elements."""
    parameters = use.element.parameters
    if len(use.nodes) != 1 or not parameters or any(p.signal for p in parameters):
        return ()
    nodes = {n.name: n for n in model.nodes}
    ((_, references),), domain = use.nodes, use.domains[0][1]
    live = [(r, nodes[r.node]) for r in references if not r.is_ground]
    if domain in COMPONENTS:
        components = use.element.ends if isinstance(use.element, LineElement) else ()
        return tuple(Variable("node", n.name, component) for _, n in live for component in components)
    if any(domain_of(r, n) != domain for r, n in live):
        return ()
    return tuple(variable_of(r, n, domain) for r, n in live)
