"""Field theories as first-order systems in x, their characteristic polynomials and matrix exponentials.

    EI w'''' + rho A s^2 w = 0   ->   z' = M z,  z = (w, w', w'', w''')

A theory is one function and one line in :data:`FIELDS`: rod, shaft, string, bending after
Euler-Bernoulli, Rayleigh and Timoshenko, and each of these with stretching, at an angle. Equations of any
order, given by the coefficient of every derivative of every unknown and of every load, become a
:class:`FieldSystem` whose states are the unknowns and their derivatives below the highest.

With ``chi(lambda) = det(lambda I - A)`` and ``adj(lambda I - A) = sum_k lambda^k B_k``, the inverse Laplace
transform in x of ``adj/chi`` is ``exp(A x) = sum_k h^(k)(x) B_k``, where ``chi(d/dx) h = 0`` and
``h(0) = ... = h^(n-2)(0) = 0``, ``h^(n-1)(0) = 1``. Nothing is divided but by what A itself
divides by, so the transfer matrix is entire in s wherever A is.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import comb, prod

from symflex.algebra import Factored
from symflex.algebra.dispersion import DispersionKind
from symflex.errors import BudgetError, Diagnostic
from symflex.library.partial_fractions import Matrix, Share, factors, shares, solve, squared

FieldTheory = Callable[[Factored, Mapping[str, Factored]], "FieldSystem"]
"""The first-order system of a uniform element, from s and the element's values."""


@dataclass(frozen=True, slots=True, eq=False)
class FieldSystem:
    """``dz/dx = matrix(s) z + load(s) u``, Laplace-transformed in time."""

    # Names of z. A theory lists its across quantities first and its through quantities after them.
    states: tuple[str, ...]
    matrix: Matrix  # constant in x, rational in s and the parameters
    loads: Matrix = ()  # one column per input that acts all along the field, uniform in x
    axes: Axes | None = None  # of a member at an angle, whose states are along the axes of the plane


@dataclass(frozen=True, slots=True, eq=False)
class Axes:
    """The axes u and v of a member, with products: the root in the cosine of 45 deg is none in its square."""

    own: FieldSystem  # the equations in the member's axes, loads none
    cos: Factored
    sin: Factored
    cos_cos: Factored
    cos_sin: Factored

    def turned(self, matrix: Matrix) -> Matrix:
        """Return ``R^T matrix R``; R takes pairs in :data:`VECTORS` from the plane's axes to the member's."""
        size = len(matrix)
        rows = [list(row) for row in matrix]
        partner = {i: j for pair in VECTORS for i, j in (pair, pair[::-1])}
        for u, v in VECTORS:
            for p in range(size):
                if p not in partner:
                    rows[u][p], rows[v][p] = self._components(matrix[u][p], matrix[v][p])
                    rows[p][u], rows[p][v] = self._components(matrix[p][u], matrix[p][v])
            for p, q in VECTORS:
                block = (matrix[u][p], matrix[u][q], matrix[v][p], matrix[v][q])
                rows[u][p], rows[u][q], rows[v][p], rows[v][q] = self._block(*block)
        return tuple(map(tuple, rows))

    def _components(self, u: Factored, v: Factored) -> tuple[Factored, Factored]:
        return self.cos * u - self.sin * v, self.sin * u + self.cos * v

    def _block(
        self, uu: Factored, uv: Factored, vu: Factored, vv: Factored
    ) -> tuple[Factored, Factored, Factored, Factored]:
        square, mixed = self.cos_cos, self.cos_sin
        across, skew = (uu - vv) * square, (uv + vu) * mixed
        even, odd = (uu - vv) * mixed, (uv + vu) * square
        return vv + across - skew, even + odd - vu, even + odd - uv, uu - across + skew

    def readings(self) -> Mapping[str, tuple[Factored, ...]]:
        """Return what the member's own states are in those along the plane's axes, by their names."""
        zero = self.cos * 0
        readings: dict[str, tuple[Factored, ...]] = {}
        for u, v in VECTORS:
            along, across = [zero] * len(self.own.states), [zero] * len(self.own.states)
            along[u], along[v] = self.cos, self.sin
            across[u], across[v] = -self.sin, self.cos
            readings[self.own.states[u]], readings[self.own.states[v]] = tuple(along), tuple(across)
        return readings


def system_of(
    states: tuple[str, ...], entries: Mapping[tuple[str, str], Factored], zero: Factored
) -> FieldSystem:
    """Return a system from its entries that are not zero, named by (derivative, state)."""
    matrix = tuple(tuple(entries.get((row, column), zero) for column in states) for row in states)
    return FieldSystem(states, matrix)


@dataclass(frozen=True, slots=True, eq=False)
class FieldEquation:
    """``sum(terms[u, k] * d^k u/dx^k) + sum(loads[i] * input_i) = 0``."""

    terms: Mapping[tuple[str, int], Factored]
    loads: Mapping[Hashable, Factored]


def first_order(
    unknowns: Sequence[str], inputs: Sequence[Hashable], equations: Sequence[FieldEquation], zero: Factored
) -> FieldSystem | None:
    """Return the equations as a first-order system, ``None`` if the highest derivatives stay open."""
    # The state called ``(u, k)`` is named ``u`` followed by k primes.
    orders = {u: max((k for e in equations for v, k in e.terms if v == u), default=0) for u in unknowns}
    highest = [[e.terms.get((u, orders[u]), zero) for u in unknowns] for e in equations]
    states = [(u, k) for u in unknowns for k in range(orders[u])]
    right = [
        [-e.terms.get(state, zero) for state in states] + [-e.loads.get(i, zero) for i in inputs]
        for e in equations
    ]
    solved = solve(highest, right)
    if solved is None:
        return None
    highest_of = dict(zip(unknowns, solved, strict=True))
    every, one = (*states, *inputs), zero + 1
    rows = [
        [one if other == (u, k + 1) else zero for other in every] if k + 1 < orders[u] else highest_of[u]
        for u, k in states
    ]
    matrix = tuple(tuple(row[: len(states)]) for row in rows)
    loads = tuple(tuple(row[len(states) + j] for row in rows) for j in range(len(inputs)))
    return FieldSystem(tuple(u + "'" * k for u, k in states), matrix, loads)


def product(values: Mapping[str, Factored], *names: str) -> Factored:
    """Return a product of values, such as E*I, which may be given by itself as EI."""
    given = values.get("".join(names))
    return prod((values[name] for name in names[1:]), start=values[names[0]]) if given is None else given


def rod(s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
    """Return ``E A (1 + eta s) u'' = (rho A s^2 + c_f s + k_f) u`` (Graff 1975, section 2.1)."""
    stiffness = product(values, "E", "A") * (values["eta"] * s + 1)
    return _second_order(("u", "f"), s, stiffness, foundation(s, values))


def inextensible(s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
    """Return ``u' = 0`` and ``f' = (rho A s^2 + c_f s + k_f) u``: a rod that moves as one."""
    zero = s * 0
    return system_of(("u", "f"), {("f", "u"): foundation(s, values)}, zero)


def shaft(s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
    """Return ``G J (1 + eta s) theta'' = (rho J s^2 + c_f s + k_f) theta`` (Graff 1975, section 2.6).

    J is the polar second moment of area [m^4] of a circular section.
    """
    stiffness = product(values, "G", "J") * (values["eta"] * s + 1)
    inertia = product(values, "rho", "J") * s**2 + values["c_f"] * s + values["k_f"]
    return _second_order(("theta", "tau"), s, stiffness, inertia)


def string(s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
    """Return ``N w'' = (rho A s^2 + c_f s + k_f) w`` with tension N (Graff 1975, section 1.1)."""
    return _second_order(("w", "f"), s, values["N"], foundation(s, values))


def _second_order(
    states: tuple[str, str], s: Factored, stiffness: Factored, inertia: Factored
) -> FieldSystem:
    across, through = states
    one = s**0
    return system_of(states, {(across, through): one / stiffness, (through, across): inertia}, one * 0)


BENDING_STATES = ("y", "theta", "f", "tau")


def foundation(s: Factored, values: Mapping[str, Factored]) -> Factored:
    """Return ``rho*A*s^2 + c_f*s + k_f``, inertia and foundation per length [N/m^2]."""
    return product(values, "rho", "A") * s**2 + values["c_f"] * s + values["k_f"]


def euler_bernoulli(s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
    """Return ``EI(1 + eta s) w'''' - N w'' + (rho A s^2 + c_f s + k_f) w = 0`` as a first-order system.

    ``f`` and ``tau`` are the transverse force and the bending moment that the part beyond x exerts on the
    part before it: ``tau = EI w''`` and ``f = -EI w''' + N w'``. The axial force N is positive in tension.
    Valid for wavelengths long against the depth (Graff 1975, section 3.1).
    """
    return _slender(s, values, values["N"])


def rayleigh(s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
    """Return Euler-Bernoulli's equations with rotary inertia ``rho I`` (Rayleigh 1877)."""
    return _slender(s, values, values["N"] + product(values, "rho", "I") * s**2)


def _slender(s: Factored, values: Mapping[str, Factored], slope_moment: Factored) -> FieldSystem:
    one = s**0
    stiffness = product(values, "E", "I") * (values["eta"] * s + 1)
    entries = {
        ("y", "theta"): one,
        ("theta", "tau"): one / stiffness,
        ("tau", "f"): -one,
        ("tau", "theta"): slope_moment,
        ("f", "y"): foundation(s, values),
    }
    return system_of(BENDING_STATES, entries, one * 0)


def timoshenko(s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
    """Return Timoshenko's equations of deflection w and rotation theta of the cross-section.

    ``kappa G A (w'' - theta') = (rho A s^2 + c_f s + k_f) w`` and
    ``EI theta'' + kappa G A (w' - theta) = rho I s^2 theta``; Kelvin-Voigt damping multiplies E and G alike
    (Timoshenko 1921; Graff 1975, section 3.4).
    """
    one = s**0
    loss = values["eta"] * s + 1
    entries = {
        ("y", "theta"): one,
        ("y", "f"): one / (product(values, "kappa", "G", "A") * loss),
        ("theta", "tau"): one / (product(values, "E", "I") * loss),
        ("tau", "f"): -one,
        ("tau", "theta"): product(values, "rho", "I") * s**2,
        ("f", "y"): foundation(s, values),
    }
    return system_of(BENDING_STATES, entries, one * 0)


BENDING = ("euler-bernoulli", "rayleigh", "timoshenko")
BEAM_ORDER = 4  # in x, of the equation of a beam that bends
FRAME_STATES = ("u", "v", "theta", "f_u", "f_v", "tau")
VECTORS = ((0, 1), (3, 4))  # the pairs of states of a member of a frame that turn with the axes


def _in_the_plane(bending: FieldTheory, along: FieldTheory) -> FieldTheory:
    """Return the theory of a member that bends and stretches after the given ones, along the plane's axes."""

    def frame(s: Factored, values: Mapping[str, Factored]) -> FieldSystem:
        across, stretching = bending(s, values), along(s, values)
        zero = s * 0
        names = [dict(zip(BENDING_STATES, ("v", "theta", "f_v", "tau"), strict=True)), {"u": "u", "f": "f_u"}]
        entries = {
            (called[row], called[column]): x
            for system, called in zip((across, stretching), names, strict=True)
            for row, line in zip(system.states, system.matrix, strict=True)
            for column, x in zip(system.states, line, strict=True)
        }
        straight = system_of(FRAME_STATES, entries, zero)
        axes = Axes(straight, *(values[name] for name in ("cos", "sin", "cos_cos", "cos_sin")))
        return FieldSystem(("x", "y", "theta", "f_x", "f_y", "tau"), axes.turned(straight.matrix), axes=axes)

    return frame


FIELDS: dict[str, FieldTheory] = {
    "euler-bernoulli": euler_bernoulli,
    "rayleigh": rayleigh,
    "timoshenko": timoshenko,
    "rod": rod,
    "shaft": shaft,
    "string": string,
}
FIELDS |= {f"frame-{name}": _in_the_plane(FIELDS[name], rod) for name in BENDING}
FIELDS |= {f"inextensible-frame-{name}": _in_the_plane(FIELDS[name], inextensible) for name in BENDING}


TERM_LIMIT = 5_000  # terms of the adjugate up to which field equations are solved in closed form


@dataclass(frozen=True, slots=True, eq=False)
class Characteristic:
    """A characteristic polynomial sorted by what its roots look like."""

    # As of :class:`symflex.algebra.Dispersion`, or ``polynomial`` when every root is zero.
    kind: DispersionKind | str
    coefficients: tuple[Factored, ...]  # ``c_0, ..., c_(n-1)`` in the shifted exponent
    shift: Factored  # the exponents are the roots minus this

    @property
    def key(self) -> tuple[str, ...]:
        """Equal for equal polynomials, so that elements of one material share their wavenumbers."""
        return tuple(text(c) for c in (*self.coefficients, self.shift))


def text(value: Factored) -> str:
    """Return what is equal for equal values of few factors, which need not stand in the same order."""
    return f"{value.unit}*" + "*".join(sorted(f"({f})^{e}" for f, e in value.factors))


@dataclass(frozen=True, slots=True, eq=False)
class Component:
    """A part of a field's states, in a member's axes, coupled to no other, or the share of one law in it."""

    states: tuple[int, ...]  # the positions, among the system's states, of those it moves
    characteristic: Characteristic  # of this part alone, without its multiplicity
    # ``c_0, ..., c_(n-1)`` of the same polynomial to the power of the multiplicity, not shifted
    coefficients: tuple[Factored, ...]
    adjugate: tuple[Matrix, ...]  # ``B_0, ..., B_(n-1)``
    # Of a part whose coefficients vary along x, which has no such polynomial: the coefficients of its states
    # and then of the loads, which are states that stay what they are.
    matrix: Matrix = ()
    multiplicity: int = 1  # of every exponent
    is_share: bool = False  # whether it is what a factor of a characteristic polynomial adds
    meets: tuple[Factored, ...] = ()  # of a share, see :class:`symflex.algebra.Dispersion`
    scale: Factored | None = None  # its exponents over those of the law whose functions are taken, if not 1

    def scaled(self, length: Factored) -> Factored:
        """Return the length at which functions of that law are taken."""
        return length if self.scale is None else length * self.scale


def varies(system: FieldSystem, along: Collection[str]) -> bool:
    """Tell whether coefficients of a system hold one of the generators that vary along x."""
    every = [x for row in (*system.matrix, *system.loads) for x in row]
    return any(x.depends_on(name) for name in along for x in every)


def varying_components(system: FieldSystem) -> tuple[Component, ...]:
    """Return the uncoupled parts of equations whose coefficients vary along x."""
    n, zero = len(system.states), system.matrix[0][0] * 0
    places = {(i, j) for i in range(n) for j in range(n) if not system.matrix[i][j].is_zero}
    components_found = []
    for states in coupled_states(n, places):
        rows = [(*(system.matrix[i][j] for j in states), *(load[i] for load in system.loads)) for i in states]
        rows += [(zero,) * len(rows[0]) for _ in system.loads]
        components_found.append(Component(states, Characteristic("varying", (), zero), (), (), tuple(rows)))
    return tuple(components_found)


def components(
    system: FieldSystem, settled: Callable[[Factored], Factored] | None = None
) -> tuple[Component, ...]:
    """Return the uncoupled parts of a field's equations, each with its characteristic polynomial."""
    # With ``settled``, which returns a value with all that is known of its generators put in, polynomials
    # that factor into such whose roots have a formula, and squares of these, give one part per factor.
    parts = []
    axes = system.axes
    full = system.matrix if axes is None else axes.own.matrix
    size = len(full)
    places = {(i, j) for i in range(size) for j in range(size) if not full[i][j].is_zero}
    for indices in coupled_states(size, places):
        matrix = tuple(tuple(full[i][j] for j in indices) for i in indices)
        coefficients, adjugate = faddeev_leverrier(matrix)
        plain = Share(coefficients, 1, coefficients, adjugate)
        for share in (plain,) if settled is None else _split(plain, matrix, settled):
            states, adjugate = indices, share.adjugate
            if axes is not None:
                adjugate = tuple(
                    axes.turned(_spread(b, indices, full[0][0] * 0, len(full))) for b in adjugate
                )
                states = tuple(range(len(full)))
            law, m = classify(share.factor), share.multiplicity
            parts.append(
                Component(states, law, share.coefficients, adjugate, (), m, share is not plain, share.meets)
            )
    return tuple(parts)


def _split(plain: Share, matrix: Matrix, settled: Callable[[Factored], Factored]) -> Sequence[Share]:
    """Return the shares of the factors of a characteristic polynomial, all of whose roots have formulas."""
    c, kind = plain.factor, classify(plain.factor).kind
    if kind == "pair" and settled(c[2] ** 2 - c[0] * 4).is_zero:
        factored = [(squared(c), 2)]
    elif kind in ("pair", "general"):
        factored = factors([settled(x) for x in c])
    else:
        return (plain,)
    if len(factored) == 1 and factored[0][1] == 1:
        return (plain,)
    kinds = [classify(p).kind for p, _ in factored]
    if "general" in kinds or any(k == "pair" and m > 1 for k, (_, m) in zip(kinds, factored, strict=True)):
        return (plain,)
    inverted = [f for row in matrix for x in row for f, e in x.factors if e < 0]
    return shares(factored, plain.adjugate, inverted) or (plain,)


def _spread(matrix: Matrix, states: Sequence[int], zero: Factored, size: int) -> Matrix:
    """Return the matrix of a part as one of all states."""
    index_of = {state: i for i, state in enumerate(states)}
    return tuple(
        tuple(
            matrix[index_of[i]][index_of[j]] if i in index_of and j in index_of else zero for j in range(size)
        )
        for i in range(size)
    )


def coupled_states(count: int, places: Collection[tuple[int, int]]) -> list[tuple[int, ...]]:
    """Return the connected parts of the states of a matrix that has entries at some places, in order."""
    remaining, groups = list(range(count)), []
    while remaining:
        part, pending = set(), [remaining[0]]
        while pending:
            i = pending.pop()
            if i in part:
                continue
            part.add(i)
            pending += [j for j in remaining if (i, j) in places or (j, i) in places]
        groups.append(tuple(i for i in remaining if i in part))
        remaining = [i for i in remaining if i not in part]
    return groups


def faddeev_leverrier(matrix: Matrix) -> tuple[tuple[Factored, ...], tuple[Matrix, ...]]:
    """Return ``c_0, ..., c_(n-1)``, ``B_0, ..., B_(n-1)`` (Faddeev & Faddeeva 1963, section 47)."""
    # Raises BudgetError: SF501 when densely coupled equations grow beyond what a closed form can hold.
    n = len(matrix)
    zero = matrix[0][0] * 0
    identity = tuple(tuple(zero + int(i == j) for j in range(n)) for i in range(n))
    b = identity
    descending: list[Factored] = []
    adjugate = [b]
    for k in range(1, n + 1):
        product = _product(matrix, b)
        trace = sum((product[i][i] for i in range(n)), zero)
        c = trace * Fraction(-1, k)
        descending.append(c)
        if k < n:
            b = tuple(
                tuple(product[i][j] + c if i == j else product[i][j] for j in range(n)) for i in range(n)
            )
            adjugate.append(b)
            if sum(len(f) for row in b for value in row for f, _ in value.factors) > TERM_LIMIT:
                what = "the characteristic polynomial of the field equations"
                hint = "put numbers in place of symbols, or uncouple them"
                raise BudgetError(
                    Diagnostic("SF501", f"{what} needs more than {TERM_LIMIT} terms", None, hint)
                )
    return tuple(reversed(descending)), tuple(reversed(adjugate))


def _product(left: Matrix, right: Matrix) -> Matrix:
    columns, zero = tuple(zip(*right, strict=True)), left[0][0] * 0

    def entry(row: Sequence[Factored], column: Sequence[Factored]) -> Factored:
        pairs = zip(row, column, strict=True)
        return sum((a * b for a, b in pairs if not (a.is_zero or b.is_zero)), zero)

    return tuple(tuple(entry(row, column) for column in columns) for row in left)


def classify(coefficients: Sequence[Factored]) -> Characteristic:
    """Return a characteristic polynomial with its exponents shifted to zero mean where that makes it even."""
    n = len(coefficients)
    zero = coefficients[0] * 0
    if all(c.is_zero for c in coefficients):
        return Characteristic("polynomial", tuple(coefficients), zero)
    if n == 1:
        return Characteristic("exponential", (), coefficients[0])
    shift = coefficients[-1] / n
    shifted = tuple(coefficients) if shift.is_zero else _shifted(coefficients, shift)
    kind = _even_kind(shifted)
    # Shifted pairs hold the shift's square, for which no parameter can be solved: what is common, and where
    # the parts are entire, is then not seen in names for the roots.
    if kind == "general" or (kind == "pair" and not shift.is_zero):
        return Characteristic("general", tuple(coefficients), zero)
    return Characteristic(kind, shifted, shift)


def _even_kind(c: Sequence[Factored]) -> DispersionKind:
    match [x.is_zero for x in c]:
        case [False, _]:
            return "wave"
        case [False, True, True, _]:
            return "bending"
        case [False, True, False, _]:
            return "pair"
    return "general"


def _shifted(coefficients: Sequence[Factored], shift: Factored) -> tuple[Factored, ...]:
    """Return the coefficients of ``chi(lambda - shift)``."""
    n = len(coefficients)
    one = shift**0
    full = (*coefficients, one)
    return tuple(
        sum((full[k] * (-shift) ** (k - j) * comb(k, j) for k in range(j, n + 1)), one * 0) for j in range(n)
    )
