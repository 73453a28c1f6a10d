"""What equations leave free at one s: null spaces of ball matrices, and how distributed parts move in them.

Input: a matrix that is singular somewhere in its balls, and what it may be scaled after.
Output: enclosures of a basis of its null space.
Example: ``[1 -2; -2 4]`` takes (2, 1) to zero. Theorem: see :func:`null_space`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from random import Random

from flint import acb, acb_mat, arb, arb_mat

from symflex.algebra import LAPLACE
from symflex.analysis.modes.shape import DistributedShape, Motion, VaryingCarrier
from symflex.balls import balancing, binary_exponent, current_bits
from symflex.equations import Continuum, assemble
from symflex.library.elements import Variable
from symflex.library.elements.element import ACROSS_UNIT, COMPONENT_DOMAIN, COMPONENT_UNIT
from symflex.model import with_numbers
from symflex.model.along import is_tapered
from symflex.model.loss_factors import check_causal
from symflex.transfer import AnyBoundFunction, nested_transfer
from symflex.transfer.bind import read_values
from symflex.transfer.equations_at import EquationsAt, NamedValues

SEED = 7
PASSES = 2  # passes of scaling rows and columns: units make entries differ by many powers of ten

BESIDE = acb(1.0625, 0.03125)  # times a root it is a point where nothing vanishes because of the root

Column = tuple[acb, ...]


@dataclass(frozen=True, slots=True)
class NullSpace:
    """A basis of the null space."""

    basis: tuple[Column, ...]  # encloses one of any matrix in the balls that has as many dimensions
    is_refuted: bool  # true when no matrix in the balls has a null space of that dimension


def null_space(matrix: acb_mat, dimension: int = 1, typical: acb_mat | None = None) -> NullSpace | None:
    """Return the null space of a square matrix, bordered so that it becomes regular.

    With ``[A B; C 0] [X; T] = [0; 1]``, B and C of full rank and generic, the bordered matrix is regular as
    soon as the null space of A has at most ``dimension`` dimensions; it has exactly as many where T = 0, and
    X is a basis then (Govaerts 2000, Numerical Methods for Bifurcations of Dynamical Equilibria, chapter 3).
    None when the balls are too wide to tell.

    ``typical`` is a matrix whose entries are as large as those of this one are in general. Rows and columns
    are scaled after it; where entries vanish by the singularity itself, they tell nothing of the scale.
    """
    n = int(matrix.nrows())
    if not n:
        return NullSpace((), True)
    bordered, right = _bordered(matrix, dimension, typical)
    solved = solution(bordered, _corner(n, dimension))
    if solved is None:
        return None
    basis = tuple(tuple(solved[j][k] * right[j] for j in range(n)) for k in range(dimension))
    is_refuted = not all(x.contains(0) for row in solved[n:] for x in row)
    return NullSpace(basis, is_refuted)


@dataclass(frozen=True, slots=True)
class SingularPair:
    """Vectors X and Y on both sides of a matrix A that is bordered by B and C, and the corner T.

    ``[A B; C 0] [X; T] = [0; 1]``, ``[Y T] [A B; C 0] = [0 1]``: A is singular just where T is 0, and
    ``dT = -Y dA X`` for any change of A (Govaerts 2000, chapter 3).
    """

    right: Column
    left: Column
    corner: acb

    def change(self, entries: Mapping[tuple[int, int], acb]) -> acb:
        """Return how T changes with entries of A."""
        return -sum((self.left[i] * x * self.right[j] for (i, j), x in entries.items()), acb(0))


def singular_pair(matrix: acb_mat, typical: acb_mat) -> SingularPair | None:
    """Return the vectors of a matrix whose null space has at most one dimension; None on balls too wide.

    >>> pair = singular_pair(acb_mat([[1, -2], [-2, 4]]), acb_mat([[1, 1], [1, 1]]))
    >>> pair.corner.contains(0), (pair.right[0] / pair.right[1]).contains(2)
    (True, True)
    """
    n = int(matrix.nrows())
    bordered, right = _bordered(matrix, 1, typical)
    solved = solution(bordered, _corner(n, 1))
    transposed = [list(column) for column in zip(*bordered, strict=True)]
    mirrored = None if solved is None else solution(transposed, _corner(n, 1))
    if solved is None or mirrored is None:
        return None
    left, _ = _scales(typical.tolist())
    return SingularPair(
        tuple(solved[j][0] * right[j] for j in range(n)),
        tuple(mirrored[i][0] * left[i] for i in range(n)),
        solved[n][0],
    )


def _bordered(matrix: acb_mat, dimension: int, typical: acb_mat | None) -> tuple[list[list[acb]], list[arb]]:
    """Return a scaled matrix with its borders, and the scales of its columns."""
    n, rows = int(matrix.nrows()), matrix.tolist()
    left, right = _scales(rows if typical is None else typical.tolist())
    random = Random(SEED)
    bordered = [
        [*(x * left[i] * right[j] for j, x in enumerate(row)), *_border(random, dimension)]
        for i, row in enumerate(rows)
    ]
    below = list(zip(*(_border(random, dimension) for _ in range(n)), strict=True))
    return bordered + [[*row, *([acb(0)] * dimension)] for row in below], right


def _corner(size: int, dimension: int) -> list[list[acb]]:
    """Return the right sides of bordered equations, whose last rows alone are not at rest."""
    return [[acb(int(i == size + k)) for k in range(dimension)] for i in range(size + dimension)]


def _border(random: Random, dimension: int) -> list[acb]:
    return [acb(random.choice((-1, 1)) * random.uniform(0.5, 1)) for _ in range(dimension)]


def solution(matrix: list[list[acb]], wanted: list[list[acb]]) -> list[list[acb]] | None:
    """Return ``matrix^-1 wanted``, in real arithmetic where all is real; None where it may be singular."""
    try:
        if all(x.imag == 0 for row in matrix for x in row):
            real = arb_mat([[x.real for x in row] for row in matrix])
            solution = real.solve(arb_mat([[x.real for x in row] for row in wanted]))
            return [[acb(x) for x in row] for row in solution.tolist()]
        solved: list[list[acb]] = acb_mat(matrix).solve(acb_mat(wanted)).tolist()
    except ZeroDivisionError:
        return None
    return solved


def _scales(rows: Sequence[Sequence[acb]]) -> tuple[list[arb], list[arb]]:
    """Return powers of two for rows and columns that bring their largest entries near one."""
    exponents = ({j: binary_exponent(x) for j, x in enumerate(row)} for row in rows)
    sizes = [{j: e for j, e in row.items() if e is not None} for row in exponents]
    left, right = balancing(sizes, len(rows), PASSES)
    two = arb(2)
    return [two**e for e in left], [two**e for e in right]


class BoundEquations:
    """The equations behind a bound function, with numbers, and what everything does that solves them."""

    def __init__(self, bound: AnyBoundFunction, what: str) -> None:
        model = bound.source.model
        check_causal(model, what)
        of_nested = None if bound.is_reduced else bound.source.equations
        given = dict(bound.values)
        if of_nested is None and is_tapered(model):
            # Bounds on a coefficient in names are wide: a member is taken in ten times as many steps.
            model = with_numbers(model, (), given, in_kernels=True)
        equations = of_nested or assemble(model, nested_transfer, is_nameless=True)
        missing = tuple(p for p in model.parameters if p.name not in given)
        self.at = EquationsAt(equations, (*bound.values, *read_values(missing, {})))
        domains = {n.name: n.domain for n in model.nodes}
        self.unknowns = equations.unknowns
        self.units = {v: _unit(v, domains.get(v.owner, "")) for v in equations.unknowns}

    def motion(
        self, number: NamedValues, values: Sequence[acb], source: Variable | None = None
    ) -> tuple[tuple[Motion, ...], tuple[DistributedShape, ...]]:
        """Return what moves with these values of the unknowns; a ``source`` is 1, other inputs are 0."""
        moved = dict(zip(self.unknowns, values, strict=True))
        every = moved if source is None else {**moved, source: acb(1)}
        distributed = tuple(moving_continuum(part, number, every) for part in self.at.equations.continua)
        starts = {part.name: float(part.start.mid()) for part in distributed}
        motions = tuple(
            Motion(_name(variable, starts), variable, value, self.units.get(variable, ""))
            for variable, value in every.items()
            if variable.kind != "value"
        )
        return motions, distributed


def moving_continuum(
    continuum: Continuum, number: NamedValues, motion: Mapping[Variable, acb]
) -> DistributedShape:
    """Return how a distributed part moves when these have these values, and all else is at rest."""
    system, axes = continuum.system, continuum.system.axes
    matrix: tuple[tuple[acb, ...], ...] = ()
    initial = tuple(acb(0) if v is None else motion[v] for v in continuum.initial)
    load = tuple(motion.get(variable, acb(0)) for variable in continuum.loads)
    varying: VaryingCarrier | None = None
    if continuum.parts:
        parts = tuple((states, number.equations.laws[law]) for states, law in continuum.parts)
        varying = VaryingCarrier(parts, number[LAPLACE], len(system.states))
        initial = varying.started(initial)
    else:
        matrix = tuple(tuple(number(x) for x in row) for row in system.matrix)
        columns = [
            [number(x) * size for x in column] for column, size in zip(system.loads, load, strict=True)
        ]
        load = tuple(sum(xs, acb(0)) for xs in zip(*columns, strict=True)) or (acb(0),) * len(system.states)
    reach = number(continuum.start).real, number(continuum.length).real, current_bits()
    direction = () if axes is None else tuple(number(x).real for x in (axes.cos, axes.sin))
    moved = continuum.name, continuum.kind, system.states, matrix, load, initial
    return DistributedShape(*moved, *reach, direction, varying)


def _name(variable: Variable, starts: Mapping[str, float]) -> str:
    if variable.kind == "field":
        return f"{variable.component}({starts[variable.owner]:.6g})"
    return str(variable)


def _unit(variable: Variable, domain: str) -> str:
    if variable.kind == "node":
        return ACROSS_UNIT.get(COMPONENT_DOMAIN.get(variable.component, domain), "")
    if variable.kind == "through":
        return COMPONENT_UNIT.get(variable.component.removesuffix("_a"), "")
    return ""
