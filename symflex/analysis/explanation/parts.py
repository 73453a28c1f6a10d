"""What a constrained system falls apart into, and how its determinant divides a numerator.

Input: its equations. Output: a :class:`Separation`: coordinates that are at rest, and parts that share no
unknown, so that the system's poles are those of the parts together.

Input: the determinants of a system, and of the same with a constraint.
Output: a :class:`Relation`, ``num = factor * transmission / apart * constrained determinant``, proved in the
ring of the equations.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from flint import fmpz_mpoly

from symflex.algebra import LAPLACE, Factored, degree_in
from symflex.algebra.propagators import EXPONENTIAL
from symflex.analysis.explanation.coordinates import collected
from symflex.equations import Equations
from symflex.equations.elimination import Determinants
from symflex.library.elements import COMPONENTS, EquationRow, LinearForm, Variable
from symflex.library.elements.rigid import Fixed, Pin, Slider
from symflex.model import Model, PlacedElement
from symflex.model.network import variable_of
from symflex.transfer.expansion import compose_rational
from symflex.transfer.lowest_terms import cancel

SUPPORTS = (Fixed, Pin, Slider)


@dataclass(frozen=True, slots=True)
class ConstrainedPart:
    """A part of a constrained system that moves by itself."""

    elements: tuple[str, ...]  # elements, fields, signals: names of what it is made of but supports
    fields: tuple[str, ...]
    signals: tuple[str, ...]
    order: int | None  # number of its poles; ``None`` when they are infinitely many
    has_input: bool  # whether the input drives it
    determinant: Factored = field(compare=False, repr=False)  # its factors in s; 1 if not multiplied out
    system: Equations = field(compare=False, repr=False)

    @property
    def names(self) -> tuple[str, ...]:
        """All it is made of."""
        return (*self.fields, *self.elements, *self.signals)


@dataclass(frozen=True, slots=True)
class Separation:
    """The parts, and the variables that are at rest."""

    parts: tuple[ConstrainedPart, ...]
    resting: frozenset[Variable]


@dataclass
class _Matrix:
    """Rows by variable, and what is left of them while trivial ones are taken out."""

    equations: Equations
    rows: dict[int, dict[Variable, Factored]]
    driven: set[int]
    resting: set[Variable]

    @staticmethod
    def of(equations: Equations, source: str) -> _Matrix:
        """Return the rows, with those that an input enters."""
        unknowns = set(equations.unknowns)
        rows, driven = {}, set()
        for i, row in enumerate(equations.rows):
            if any(v.kind == "input" and v.owner == source for v, _ in row.form.terms):
                driven.add(i)
            rows[i] = {v: c for v, c in collected(row.form).items() if v in unknowns}
        return _Matrix(equations, rows, driven, set())

    def settle(self) -> None:
        """Take out unknowns that a row of their own keeps at zero, and rows that only fix a reaction."""
        while self._settle_row() or self._settle_column():
            pass

    def _settle_row(self) -> bool:
        for i, row in self.rows.items():
            if len(row) == 1 and self._is_static(next(iter(row.values()))):
                (variable,) = row
                self._take_out(i, variable)
                self.resting.add(variable)
                return True
        return False

    def _settle_column(self) -> bool:
        users: dict[Variable, list[int]] = {}
        for i, row in self.rows.items():
            for variable in row:
                users.setdefault(variable, []).append(i)
        for variable, users_of in users.items():
            if len(users_of) == 1 and len(self.rows[users_of[0]]) > 1:
                (i,) = users_of
                if self._is_static(self.rows[i][variable]):
                    del self.rows[i]
                    return True
        return False

    def _take_out(self, row: int, variable: Variable) -> None:
        is_driven = row in self.driven
        del self.rows[row]
        for i, other in self.rows.items():
            if other.pop(variable, None) is not None and is_driven:
                self.driven.add(i)

    def _is_static(self, coefficient: Factored) -> bool:
        return varying(self.equations, opened(self.equations, coefficient)).is_constant

    def components(self) -> Iterator[tuple[list[int], set[Variable]]]:
        """Yield rows and unknowns that hang together."""
        remaining = dict(self.rows)
        while remaining:
            first = next(iter(remaining))
            rows, variables = [first], set(remaining.pop(first))
            grown = True
            while grown:
                joined = [i for i, row in remaining.items() if not variables.isdisjoint(row)]
                grown = bool(joined)
                for i in joined:
                    rows.append(i)
                    variables |= set(remaining.pop(i))
            yield sorted(rows), variables


def separate(
    equations: Equations,
    source: str,
    model: Model | None = None,
    varies: Callable[[Equations], bool] | None = None,
) -> Separation:
    """Return a constrained system's parts with poles, those with the input marked; ``varies`` tells of s."""
    named = equations.model if model is None else model
    matrix = _Matrix.of(equations, source)
    matrix.settle()
    parts = []
    for rows, variables in matrix.components():
        system = _part(equations, matrix, rows, variables)
        waves = [] if varies is None else waves_of(equations)
        if varies is not None and any(
            c.depends_on(w) for row in system.rows for c in row.form.coefficients for w in waves
        ):
            determinant, order = Factored.number(equations.ring, 1), None
            is_constant = not varies(system)
        else:
            determinants = Determinants.of(system)
            determinant = varying(equations, opened(equations, determinants.opened(determinants.den)))
            order, is_constant = _order(equations, determinant), determinant.is_constant
        if is_constant:
            continue
        owners = {v.owner for v in variables if v.kind == "field"}
        fields = tuple(f.name for f in equations.model.fields if f.name in owners)
        elements = tuple(u.name for u in named.elements if _is_in(named, u, variables))
        signals = tuple(x.name for x in equations.model.signals if Variable("signal", x.name) in variables)
        has_input = any(i in matrix.driven for i in rows)
        parts.append(ConstrainedPart(elements, fields, signals, order, has_input, determinant, system))
    return Separation(tuple(parts), frozenset(matrix.resting))


def _part(equations: Equations, matrix: _Matrix, rows: list[int], variables: set[Variable]) -> Equations:
    """Return the equations of a part."""
    forms: list[EquationRow] = [
        replace(equations.rows[i], form=LinearForm(tuple(matrix.rows[i].items()))) for i in rows
    ]
    unknowns = tuple(v for v in equations.unknowns if v in variables)
    return replace(equations, unknowns=unknowns, inputs=(), rows=tuple(forms), outputs=())


def _order(equations: Equations, determinant: Factored) -> int | None:
    """Return the degree in s, ``None`` of what holds waves."""
    if any(determinant.depends_on(name) for name in waves_of(equations)):
        return None
    s = equations.ring.index[LAPLACE]
    return sum(degree_in(f, s) * e for f, e in determinant.factors)


def waves_of(equations: Equations) -> list[str]:
    """Return the names of wavenumbers, and of what they are arguments of."""
    waves = equations.propagation
    return [] if waves is None else [*waves.table.wavenumbers, *(p.generator for p in waves.propagators)]


def _is_in(model: Model, use: PlacedElement, variables: set[Variable]) -> bool:
    """Tell whether an element takes part in the motion of some variables; supports do not move."""
    if isinstance(use.element, SUPPORTS):
        return False
    through = any(v.kind in ("through", "value") and v.owner == use.name for v in variables)
    return through or any(v in variables for v in coordinates_of(model, use))


def coordinates_of(model: Model, use: PlacedElement) -> tuple[Variable, ...]:
    """Return the coordinates of nodes that an element acts on."""
    nodes = {n.name: n for n in model.nodes}
    domains: Mapping[str, str] = dict(use.domains)
    coordinates: list[Variable] = []
    for port, references in use.nodes:
        for reference in references:
            if reference.is_ground:
                continue
            node = nodes[reference.node]
            if domains[port] in COMPONENTS:
                coordinates += [Variable("node", node.name, c) for c in node.components]
            else:
                coordinates.append(variable_of(reference, node, domains[port]))  # type: ignore[arg-type]
    return tuple(coordinates)


@dataclass(frozen=True, slots=True, eq=False)
class Relation:
    """``num = constant*factor*transmission/apart * det``, with ``det`` that of the constrained system."""

    order: int  # the power of s in ``factor``, from what the output does to the coordinate it shows
    filtered: Factored  # the rest of ``factor`` that depends on s
    transmission: Factored | None  # what else is above: zeros that are no poles; None if not known
    apart: Factored  # what only the constrained system has: poles of it that are not zeros
    has_zeros: bool  # whether the numerator depends on s but for ``factor``
    is_delayed: bool  # the constant also contains exponentials of s, which have neither zeros nor poles

    @property
    def is_equality(self) -> bool:
        """Whether the zeros are the poles of the constrained system, one for one."""
        return self.transmission is not None and self.transmission.is_constant and self.apart.is_constant


def relate(
    system: Determinants, pair: tuple[str, str], factor: Factored, constrained: Determinants
) -> Relation | None:
    """Return how a pair's numerator and a constrained determinant are related, ``None`` if they are not."""
    equations = system.equations
    if not same_generators(constrained.equations, equations):
        return None
    num = opened(equations, system.opened(system.num(*pair)))
    if num.is_zero:
        return None
    opened_factor = opened(equations, factor)
    det = opened(equations, constrained.opened(constrained.den))
    ratio, _ = cancel(num / opened_factor, det)
    above, below = (varying(equations, part) for part in (ratio.numerator(), ratio.denominator()))
    order = opened_factor.exponent_of(equations.ring.generator(LAPLACE))
    filtered = varying(equations, opened_factor / Factored.generator(equations.ring, LAPLACE) ** order)
    bare, _ = cancel(num, opened_factor.numerator())
    has_zeros = not varying(equations, bare.numerator()).is_constant
    decays = exponentials(equations)
    is_delayed = any(f in decays for f, _ in ratio.factors)
    return Relation(order, filtered, above, below, has_zeros, is_delayed)


def same_generators(one: Equations, other: Equations) -> bool:
    """Tell whether generators of equal names mean the same in two systems."""
    lengths = [
        () if waves is None else tuple(tuple(map(str, lengths)) for lengths in waves.lengths)
        for waves in (one.propagation, other.propagation)
    ]
    return one.ring.names == other.ring.names and lengths[0] == lengths[1]


def opened(equations: Equations, value: Factored) -> Factored:
    """Return a value over the equations' ring with every definition replaced by what it stands for."""
    ring = equations.ring
    images = [Factored.generator(ring, name) for name in ring.names]
    names: list[str] = []
    for name, definition in equations.definitions:
        embedded = definition if equations.propagation is None else equations.propagation.embed(definition)
        images[ring.index[name]] = _composed(images, embedded, names)
        names.append(name)
    return _composed(images, value, names)


def _composed(images: Sequence[Factored], value: Factored, names: Sequence[str]) -> Factored:
    ring = value.ring

    def image(factor: fmpz_mpoly) -> Factored:
        if ring.used_in([factor]).isdisjoint(names):
            return Factored.polynomial(ring, factor)
        return compose_rational(ring, factor, images)

    return value.map_factors(ring, image)


def varying(equations: Equations, value: Factored) -> Factored:
    """Return the factors that depend on s; exponentials are left out, for they have no zeros."""
    moving, decays = {LAPLACE, *waves_of(equations)}, exponentials(equations)
    return value.filter(lambda f: f not in decays and bool(value.ring.used_in([f]) & moving))


def exponentials(equations: Equations) -> list[fmpz_mpoly]:
    """Return the generators that are exponentials of s times a constant, such as delays."""
    waves = equations.propagation
    propagators = () if waves is None else waves.propagators
    return [equations.ring.generator(p.generator) for p in propagators if p.order == EXPONENTIAL]
