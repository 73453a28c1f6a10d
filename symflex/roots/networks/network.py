"""An undamped network as symmetric equations, real in ``lambda = -s^2``, beside its distributed members.

    balance at tip:  k y - f_1 = 0         k + K_11   ...   y      delivered forces follow from
    balance at hub:  m s^2 z - f_2 = 0     ...   -lambda m + ...   the members' dynamic stiffness K

Rows of constraints and laws are scaled until the matrix is symmetric, ``d_i M_ij = d_j M_ji``. Its part in
lambda, inertia, is not negative: then all lambdas where the equations have a solution are real, and the
number of negative pivots of the whole never falls as lambda rises.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import NoReturn

from flint import acb_poly, arb

from symflex.algebra import LAPLACE, Factored
from symflex.balls import Arithmetic, precision
from symflex.equations import Equations
from symflex.library.elements import LinearForm, Terms, Variable, put_in
from symflex.transfer.equations_at import EquationsAt, NamedValues

ONE_WAY = "forces and motions are coupled in one direction only, as in a loop"
LOSES = "something in it loses or supplies energy"
MASS_BITS = 256  # precision of the proof that inertia is not negative, if numbers are not rational


class OtherNetworkError(Exception):
    """The equations are not those of an undamped network; the message gives the reason."""


@dataclass(frozen=True, eq=False)
class NetworkMember:
    """A distributed member: ``dz/dx = system z``, its ends joined to unknowns of the network."""

    name: str
    system: tuple[tuple[Factored, ...], ...]  # rows of the matrix, even in s
    length: Factored
    ends: tuple[int | None, ...]  # unknowns that move the start, and the end; None where it is held
    direction: tuple[Factored, ...] = ()  # cosine and sine of a member at an angle; else nothing

    @property
    def key(self) -> str:
        """Equal for members of equal law and length."""
        return " ".join(map(str, (*(x for row in self.system for x in row), self.length)))


@dataclass(frozen=True, eq=False)
class Network:
    """``(M(lambda) + members) x + b u = 0``, ``y = c x``, with numbers in place."""

    numeric: EquationsAt
    size: int  # unknowns
    entries: Mapping[tuple[int, int], Factored]  # of M, symmetric, i <= j; even in s
    members: tuple[NetworkMember, ...]
    driven: Mapping[int, Factored]  # by unknown, with what is read; empty for other quantities
    read: Mapping[int, Factored]
    below: int  # powers of s in front of determinant, and of that bordered by input and output
    above: int

    @property
    def is_colocated(self) -> bool:
        """Whether the output reads what the input drives, but for a factor."""
        if not self.driven or set(self.driven) != set(self.read):
            return False
        return len({str(self.read[i] / self.driven[i]) for i in self.driven}) == 1


class PolynomialValues(NamedValues):
    """Values that are polynomials in s; OtherNetworkError for those that are none."""

    def __init__(self, equations: EquationsAt) -> None:
        super().__init__(equations, acb_poly([0, 1]))

    def __missing__(self, name: str) -> Arithmetic:
        if name in self.equations.waves_of:
            _refuse(f"{name} is not a polynomial in s")
        return super().__missing__(name)

    def __call__(self, value: Factored) -> acb_poly:
        """Return the value of a rational function."""
        _, powers, sums = self.equations.plan(value)
        if any(e < 0 for _, e in powers) or any(e < 0 for *_, e in sums):
            _refuse("a law is not a polynomial in s")
        return acb_poly(super().__call__(value))

    def constant(self, value: Factored) -> arb:
        """Return a value's constant term."""
        return self(value)[0].real

    def even(self, value: Factored) -> tuple[arb, arb]:
        """Return a and b of a value ``a + b*lambda``; OtherNetworkError if it is none."""
        polynomial = self(value)
        if polynomial.degree() > 2 or not polynomial[1].is_zero():  # noqa: PLR2004
            raise OtherNetworkError(LOSES)
        return polynomial[0].real, -polynomial[2].real


def network_of(equations: Equations, output: str, source: str, *, is_passive: bool = False) -> Network:
    """Return the network of two ends, from equations with numbers; OtherNetworkError if it is none."""
    return _NetworkReading(equations).network(output, source, is_passive=is_passive)


class _NetworkReading:
    """Takes equations apart into a symmetric matrix and members."""

    def __init__(self, equations: Equations) -> None:
        self.equations = equations
        self.numeric = EquationsAt(equations)
        self.delivered: dict[Variable, Variable | None] = {}  # motions by forces and torques of members
        for continuum in equations.continua:
            if not continuum.final:
                _refuse(f"'{continuum.name}' is not an element between two nodes")
            half = len(continuum.initial) // 2
            for state in (continuum.initial, [v for v, _ in continuum.final]):
                for motion, force in zip(state[:half], state[half:], strict=True):
                    if force is None:
                        _refuse(f"an end of '{continuum.name}' is not joined")
                    self.delivered[force] = motion

    def network(self, output: str, source: str, *, is_passive: bool) -> Network:
        equations = self.equations
        rows: dict[Variable, Terms] = {
            each.about: dict(LinearForm.total([each.form]).terms)
            for each in equations.rows
            if each.about not in self.delivered
        }
        if equations.model.has_equations:
            _refuse("the model also has [equations]")
        if equations.model.imposed:
            _refuse("outputs are imposed")
        replaced = self._signals({v: row for v, row in rows.items() if v.kind in ("signal", "value")})
        rows = {v: put_in(row, replaced) for v, row in rows.items() if v not in replaced}
        read = next(o for o in equations.outputs if o.name == output)
        form = put_in(dict(LinearForm.total([read.form]).terms), replaced)
        self._take_members(rows)
        inputs = set(equations.inputs)
        below, given = 0, next(v for v in equations.inputs if v.owner == source)
        driven: Terms = {}
        for variable, row in rows.items():
            power = min((self._power(c) for v, c in row.items() if v not in inputs), default=0)
            scaled = row
            if power and variable.kind == "through":
                below += power
                s = Factored.generator(equations.ring, LAPLACE)
                scaled = {v: c * s**-power for v, c in row.items()}
            if given in scaled:
                driven[variable] = scaled[given]
            rows[variable] = {v: c for v, c in scaled.items() if v not in inputs}
        order = list(rows)
        position = {v: i for i, v in enumerate(order)}
        members = self._members(position)
        scale = self._scale(rows, members, position)
        entries = {
            (i, position[v]): c * scale[i]
            for i, row in enumerate(rows.values())
            for v, c in row.items()
            if i <= position[v]
        }
        self._check(entries, members, is_passive=is_passive)
        network = Network(self.numeric, len(order), entries, members, {}, {}, below, below)
        try:
            if any(v in inputs or v in self.delivered for v in form):
                _refuse("the output reads something that is not the motion of a node")
            for member in members:
                if not all(any(not x.is_zero for x in row) for row in member.system):
                    _refuse(f"member '{member.name}' is rigid in one direction")
            driven_power, driven_row = self._without_s(driven)
            read_power, read_row = self._without_s(form)
            divisor = self._power(read.divisor)
            if PolynomialValues(self.numeric)(read.divisor).degree() > divisor:
                _refuse("the output is filtered")
        except OtherNetworkError:
            return network
        return replace(
            network,
            driven={position[v]: c * scale[position[v]] for v, c in driven_row.items()},
            read={position[v]: c for v, c in read_row.items()},
            below=below + divisor,
            above=below + driven_power + read_power,
        )

    def _signals(self, rows: Mapping[Variable, Terms]) -> dict[Variable, Terms]:
        """Return signals as forms of the other variables; those that feed back are not separated."""
        signals: dict[Variable, Terms] = {}
        pending = deque(rows)
        waited = 0
        while pending:
            variable = pending.popleft()
            row = rows[variable]
            others = {v: c for v, c in row.items() if v != variable}
            if any(v in rows and v not in signals for v in others):
                pending.append(variable)
                waited += 1
                if waited > len(pending):
                    _refuse(f"signal '{variable}' depends on itself")
                continue
            waited = 0
            own = row[variable]
            signals[variable] = put_in({v: c / -own for v, c in others.items()}, signals)
        return signals

    def _take_members(self, rows: Mapping[Variable, Terms]) -> None:
        """Check that members deliver into the balances of their ends and nowhere else, and take them out."""
        for about, row in rows.items():
            for variable in [v for v in row if v in self.delivered]:
                flow = row.pop(variable)
                if self.delivered[variable] != about or not (flow + 1).is_zero:
                    _refuse(f"the force '{variable}' of a member is fed back")

    def _members(self, position: Mapping[Variable, int]) -> tuple[NetworkMember, ...]:
        members = []
        for continuum in self.equations.continua:
            half = len(continuum.initial) // 2
            ends = (*continuum.initial[:half], *(v for v, _ in continuum.final[:half]))
            places = tuple(None if v is None else position[v] for v in ends)
            signs = [sign for _, sign in continuum.final]
            if signs != [1] * half + [-1] * half:
                _refuse(f"the ends of '{continuum.name}' are turned")
            axes = continuum.system.axes
            system = continuum.system.matrix if axes is None else axes.own.matrix
            direction = () if axes is None else (axes.cos, axes.sin)
            members.append(NetworkMember(continuum.name, system, continuum.length, places, direction))
        return tuple(members)

    def _power(self, value: Factored) -> int:
        return value.exponent_of(value.ring.generator(LAPLACE))

    def _without_s(self, terms: Terms) -> tuple[int, Terms]:
        """Return a form as a power of s times one without s; OtherNetworkError if it is none."""
        powers = {self._power(c) for c in terms.values()}
        if len(powers) > 1:
            _refuse("the output mixes motions and their rates")
        power = powers.pop() if powers else 0
        shift = Factored.generator(self.equations.ring, LAPLACE) ** -power
        rest = {v: c * shift if power else c for v, c in terms.items()}
        number = PolynomialValues(self.numeric)
        if any(number(c).degree() > 0 for c in rest.values()):
            _refuse("the output mixes motions and their rates")
        return power, rest

    def _scale(
        self,
        rows: Mapping[Variable, Terms],
        members: Sequence[NetworkMember],
        position: Mapping[Variable, int],
    ) -> list[Factored]:
        """Return what each row is multiplied by so that the matrix is symmetric."""
        one = Factored.number(self.equations.ring, 1)
        order = list(rows)
        beside: list[list[int]] = [[] for _ in order]
        for member in members:
            places = [i for i in member.ends if i is not None]
            for i in places[1:]:
                beside[places[0]].append(i)
                beside[i].append(places[0])
        scale: dict[int, Factored] = {}
        for seed in sorted(range(len(order)), key=lambda i: order[i].kind != "node"):
            pending = [] if seed in scale else [seed]
            scale.setdefault(seed, one)
            while pending:
                i = pending.pop()
                steps = [(j, scale[i]) for j in beside[i]]
                for v, c in rows[order[i]].items():
                    back = rows[v].get(order[i])
                    if back is None:
                        _refuse(ONE_WAY)
                    steps.append((position[v], scale[i] * c / back))
                for j, factor in steps:
                    if j not in scale:
                        if factor.depends_on(LAPLACE):
                            _refuse(LOSES)
                        scale[j] = factor
                        pending.append(j)
                    elif not (scale[j] - factor).is_zero:
                        _refuse(ONE_WAY)
        return [scale[i] for i in range(len(order))]

    def _check(
        self,
        entries: Mapping[tuple[int, int], Factored],
        members: Sequence[NetworkMember],
        *,
        is_passive: bool,
    ) -> None:
        """Prove that the equations are real in lambda, and their inertia not negative."""
        with precision(MASS_BITS):
            number = PolynomialValues(self.numeric)
            mass: dict[int, dict[int, arb]] = {}
            for (i, j), value in entries.items():
                _, slope = number.even(value)
                if not slope.is_zero():
                    mass.setdefault(i, {})[j] = -slope
                    mass.setdefault(j, {})[i] = -slope
            if not is_passive and not _is_positive(mass):
                _refuse("an inertia is negative")
            for member in {m.key: m for m in members}.values():
                self._check_member(member, number)

    def _check_member(self, member: NetworkMember, number: PolynomialValues) -> None:
        system = member.system
        half = len(system) // 2
        pairs = list(product(range(half), repeat=2))
        values = [[number.even(x) for x in row] for row in system]
        if not all(
            (system[i][j] + system[half + j][half + i]).is_zero
            and (i == j or (system[i][half + j].is_zero and system[half + i][j].is_zero))
            and values[i][j][1].is_zero()
            for i, j in pairs
        ):
            _refuse(f"member '{member.name}' is not written in forces and motions")
        for i in range(half):
            compliance, slope = values[i][half + i]
            if not (compliance >= 0 and slope.is_zero()):
                _refuse(f"a compliance of member '{member.name}' is negative")
            if not values[half + i][i][1] <= 0:
                _refuse(f"an inertia of member '{member.name}' is negative")
        if not number.constant(member.length) > 0:
            _refuse(f"the length of member '{member.name}' is not positive")


def _refuse(message: str) -> NoReturn:
    raise OtherNetworkError(message)


def _is_positive(mass: Mapping[int, Mapping[int, arb]]) -> bool:
    """Tell whether it is proved that a symmetric matrix has no negative eigenvalue, by its pivots."""
    rows = {i: dict(row) for i, row in mass.items()}
    for i in sorted(rows, key=lambda i: len(rows[i])):
        row = rows.pop(i)
        pivot = row.pop(i, arb(0))
        for j in row:
            rows[j].pop(i)
        if not row and pivot == 0:
            continue
        if not pivot > 0:
            return False
        for j, x in row.items():
            for k, y in row.items():
                rows[j][k] = rows[j].get(k, arb(0)) - x * y / pivot
    return True
