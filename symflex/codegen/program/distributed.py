"""From the transfer function of a distributed system to a program in pieces.

Input: a :class:`symflex.transfer.TransferFunction` with kernels.
Output: a :class:`Piecewise` program. Where arguments of kernels are large, numerator and denominator are
sums of exponentials divided by the largest. Where they are small, each is a combination of the solutions of
one linear differential equation in the length, with coefficients from its exact Taylor series, so that
kernels that cancel each other do so before anything is rounded.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cache, partial
from math import gcd, prod
from operator import mul
from typing import TypeVar

from flint import fmpz_mpoly

from symflex.algebra import LAPLACE, Dispersion, Factored, Ring, degree_in
from symflex.algebra.normal_form import NormalForm
from symflex.balls import value_at
from symflex.budget import spend
from symflex.codegen.program.build import TERM_LIMIT, forge_of
from symflex.codegen.program.exponents import (
    KernelSum,
    Key,
    RealAxis,
    derivative_at_zero,
    expand,
    families_of,
    in_lengths,
    in_other_lengths,
)
from symflex.codegen.program.forge import Forge, straight
from symflex.codegen.program.nodes import CodePiece, Condition, Piecewise, Straight
from symflex.codegen.program.series import (
    SERIES_ERROR,
    LocalBasis,
    bending_basis,
    pair_basis,
    taylor_term,
    wave_basis,
)
from symflex.codegen.program.site import Scales, Site
from symflex.codegen.program.varying import build_varying
from symflex.errors import BudgetError, Diagnostic
from symflex.transfer import TransferFunction
from symflex.transfer.lowest_terms import cancel

REACHES = (3.0, 2.0, 4.5)  # sizes of the largest exponent below which series are used; the best is measured
CHOOSING, TOGETHER = 3, 2
"""Base lengths up to which every one may have series by itself, eight pieces for three of them, and those up
to which that is not more than a module should hold; of more it is measured whether it serves."""

CUTS = 12  # how often one base length is cut by another; two spans and a sensor need one or two
LOCAL_TERMS = 30_000  # terms looked at while series for small arguments lose wavenumbers: some ten seconds
REAL_TERMS = 1000  # terms above and below the bar up to which a program in real arithmetic is made besides
LOWEST, HIGHEST, STEPS = 1e-9, 1e12, 4000  # frequencies [rad/s] that show which arguments are small together
CONFLUENT, CIRCLE = 2.0, 24
"""Twice the squared distance of a pair's arguments below which means over a circle are taken, and points."""
LONE = 0.25  # part of the series' reach up to which the smaller of a pair's arguments has a series by itself

BASES: dict[str, Callable[[Iterable[Sequence[tuple[int, int]]]], LocalBasis]] = {
    "wave": wave_basis,
    "bending": bending_basis,
    "pair": pair_basis,
}


@dataclass(frozen=True, slots=True)
class SeriesUse:
    """Where a program uses power series."""

    reach: float  # size of the largest exponent below which it does
    # Base lengths up to which every one has series or exponentials by itself; more have series together only.
    apart: int = CHOOSING


def series_uses(tf: TransferFunction, *, is_measured: bool = True) -> tuple[SeriesUse, ...]:
    """Return what is worth trying, the usual one first; before it, what tells short lengths apart."""
    lengths = {(k.dispersion, k.length) for k in tf.kernels.kernels if k.wavenumber}
    shortest = (
        [SeriesUse(REACHES[0], TOGETHER)] if is_measured and TOGETHER < len(lengths) <= CHOOSING else []
    )
    return (*shortest, *map(SeriesUse, REACHES))


@dataclass(frozen=True, eq=False)
class Pieces:
    """The programs of one function with kernels; what they share is made once."""

    tf: TransferFunction
    # Of all parameters, where they have values. Of several laws, or many lengths, what is not small together
    # for these values gets no piece: with others it is computed from exponentials, and less accurately.
    values: Mapping[str, float] | None = None
    _makers: dict[SeriesUse, _PieceMaker] = field(default_factory=dict)
    _programs: dict[SeriesUse, Piecewise] = field(default_factory=dict)

    def of_s(self, use: SeriesUse) -> Piecewise:
        """Return the program for complex s; SF503 when it would be too large."""
        if self.tf.length > TERM_LIMIT:
            message = f"a program for {self.tf.name} would have more than {TERM_LIMIT} terms"
            raise BudgetError(Diagnostic("SF503", message, None, "keep repeated sums in [definitions]"))
        if use not in self._programs:
            is_followed = any(law.matrix for law in self.tf.kernels.dispersions)
            self._programs[use] = build_varying(self.tf) if is_followed else self._maker(use).program()
        return self._programs[use]

    def of_frequency(self, use: SeriesUse) -> Piecewise | None:
        """Return the program of the response in real arithmetic, None with damping or if very long."""
        if (
            self.tf.model.root
            or self.tf.length > REAL_TERMS
            or any(law.matrix for law in self.tf.kernels.dispersions)
        ):
            return None
        positive = tuple(p.name for p in self.tf.parameters if p.assume == "positive")
        axis = RealAxis(self.tf.ratio.ring, self.tf.kernels, positive)
        return self._maker(use).real_program(axis) if axis.is_real else None

    def side(self, number: int, factor: Factored) -> Straight:
        """Return the numerator (0) or denominator (1) times a factor, all over an exponential.

        After the value come the exponent of that, and what has no zero where the function is analytic.
        """
        return self._maker(SeriesUse(REACHES[0])).side(number, factor)

    def _maker(self, use: SeriesUse) -> _PieceMaker:
        if use not in self._makers:
            self._makers[use] = _PieceMaker(self.tf, use, self.values)
        return self._makers[use]


_Test = tuple[int, float, int]  # expression, limit and scale of a condition


_Choice = tuple[tuple[bool, ...], tuple[bool, ...], bool, tuple["Dispersion", ...]]
"""What makes a piece: groups near zero, delays that grow, meeting pairs, lone dispersions."""


Choice = TypeVar("Choice")
_LocalParts = dict[tuple[int, ...], dict["Key", Factored]]
"""Per order of the derivatives in the small lengths, the coefficients of what remains."""


@dataclass(frozen=True, slots=True, eq=False)
class _Group:
    """The families of one dispersion at one length, whose arguments are small together."""

    dispersion: Dispersion
    length: Factored
    position: int
    families: tuple[int, ...]
    basis: LocalBasis
    spread: int = 0


class _Lone(_Group):
    """The smaller wavenumber of a pair at one length, whose argument is small while the other's is not."""


@dataclass(frozen=True, eq=False)
class _Half:
    """A numerator or denominator: powers of wavenumbers times a sum of exponentials."""

    terms: KernelSum
    waves: Factored
    far: KernelSum  # the form that :meth:`Site.exponential_sum` wants
    unit: Fraction  # the common number that ``far`` is without


class _PieceMaker:
    def __init__(self, tf: TransferFunction, use: SeriesUse, values: Mapping[str, float] | None) -> None:
        self.tf = tf
        self.values = values
        self.reach = use.reach
        self.apart = use.apart
        self.ring: Ring = tf.ratio.ring
        self.table = tf.kernels
        self.normal = NormalForm(self.ring, self.table)
        self.work = 0
        self._parts: dict[tuple[_Half, tuple[_Group, ...]], _LocalParts] = {}
        self.families = families_of(self.ring, self.table)
        self.waves = {self.ring.index[w] for w in self.table.wavenumbers}
        self.kernels = {self.ring.index[k.generator] for k in self.table.kernels}
        self.plains, self.halves = self._halves()
        self.plain = self.plains[0] / self.plains[1]
        self.groups = tuple(self._groups())
        self.delays = tuple(i for i, f in enumerate(self.families) if not f.wavenumber)

    # -------------------------------------------------------------------------------- what is computed

    def _holds(self, polynomial: fmpz_mpoly, positions: Iterable[int]) -> bool:
        return any(degree_in(polynomial, i) for i in positions)

    def _halves(self) -> tuple[tuple[Factored, Factored], tuple[_Half, _Half]]:
        """Return the factors without wavenumbers and kernels above and below, and the rest of both."""
        sides = (self.tf.num, self.tf.den)
        above, below = (v.filter(lambda f: self._holds(f, self.kernels)) for v in sides)
        kernels = (above.numerator() * below.denominator(), above.denominator() * below.numerator())
        coefficients = [v.filter(lambda f: not self._holds(f, self.kernels)) for v in sides]
        waves = [v.filter(lambda f: self._holds(f, self.waves)) for v in coefficients]
        plains = [
            v.filter(lambda f: not self._holds(f, self.waves)) * side.unit
            for v, side in zip(coefficients, sides, strict=True)
        ]
        expanded = [expand(self.ring, k.expand(), self.families) for k in kernels]
        sums = self._in_segments([terms for terms, _ in expanded])
        halves = []
        for side, (wave, terms, (_, common)) in enumerate(zip(waves, sums, expanded, strict=True)):
            # A common factor without wavenumbers leaves the half; wavenumbers stay, to balance its own.
            free = common.filter(lambda f: not self._holds(f, self.waves | self.kernels)) * common.unit
            plains[side] = plains[side] * free
            halves.append(self._half(terms, wave * (common / free)))
        return (plains[0], plains[1]), (halves[0], halves[1])

    def _in_segments(self, sums: list[KernelSum]) -> list[KernelSum]:
        """Return the sums in base lengths in each of which the denominator's largest term is largest."""

        def has_corner(i: int) -> bool:
            """Tell whether one term of the denominator has a family's largest exponents at every length."""
            pairs = [key[i][0] for s in sums for key in s]
            most = tuple(max(abs(p[j][0]) + abs(p[j][1]) for p in pairs) for j in range(len(pairs[0])))
            return any(tuple(a for a, _ in key[i][0]) == most for key in sums[1])

        changes = []
        families = list(self.families)
        for i, family in enumerate(families):
            count = len(family.lengths)
            identity = [[int(j == k) for k in range(count)] for j in range(count)]
            same = [k for k, f in enumerate(self.families) if f.dispersion is family.dispersion]
            waves = [k for k in same if self.families[k].wavenumber]
            if count == 1 or not family.wavenumber or all(has_corner(k) for k in waves):
                changes.append(identity)
                continue
            values = [declared_length(self.tf, x) for x in family.lengths]
            order = sorted(range(count), key=lambda j, v=values: v[j])  # type: ignore[misc]
            matrix = [[0] * count for _ in range(count)]
            for rank, j in enumerate(order):
                for k in range(rank + 1):
                    matrix[j][k] = 1
            sorted_lengths = [family.lengths[j] for j in order]
            new = [x if not k else x - sorted_lengths[k - 1] for k, x in enumerate(sorted_lengths)]
            lengths = [declared_length(self.tf, x) for x in new]
            for _ in range(CUTS):
                pair = _longer_and_shorter(sums, same, matrix, lengths)
                if pair is None:
                    break
                # exp(a x + b y) = exp(a (x - y)) exp((a + b) y): the shorter one bears both.
                longer, shorter = pair
                for row in matrix:
                    row[shorter] += row[longer]
                new[longer] = new[longer] - new[shorter]
                lengths[longer] = lengths[longer] - lengths[shorter]
            changes.append(matrix)
            families[i] = replace(family, lengths=tuple(new))
        self.families = tuple(families)
        return [in_lengths(s, changes) for s in sums]

    def _half(self, terms: KernelSum, waves: Factored) -> _Half:
        doubled = {key: p * 2 ** self._still(key) for key, p in terms.items()}
        common = gcd(*(int(c) for p in doubled.values() for c in p.coeffs()))
        far = {key: p / self.ring.constant(common) for key, p in doubled.items()}
        return _Half(terms, waves, far, Fraction(common))

    def _still(self, key: Key) -> int:
        """Return how many circular families do not oscillate in a product."""
        return sum(
            f.is_circular and not any(b for _, b in pairs)
            for f, (pairs, _) in zip(self.families, key, strict=True)
        )

    def _groups(self) -> Iterator[_Group]:
        by_dispersion: dict[Dispersion, list[int]] = {}
        for i, family in enumerate(self.families):
            if family.wavenumber:
                by_dispersion.setdefault(family.dispersion, []).append(i)
        for ids in by_dispersion.values():
            family = self.families[ids[0]]
            for position, length in enumerate(family.lengths):
                exponents = sorted(
                    {tuple(k[i][0][position] for i in ids) for h in self.halves for k in h.terms}
                )
                spread = max(sum(abs(a) + abs(b) for a, b in pairs) for pairs in exponents)
                if spread:
                    basis = BASES[family.dispersion.kind](exponents)
                    yield _Group(family.dispersion, length, position, tuple(ids), basis, spread)

    def _lone(self, group: _Group) -> _Lone | None:
        """Return the smaller wavenumber of a pair at a length, ``None`` if no kernel has it there."""
        smaller = group.dispersion.wavenumbers[1]
        for i in group.families:
            if self.families[i].wavenumber == smaller:
                exponents = sorted({k[i][0][group.position][0] for h in self.halves for k in h.terms})
                basis = wave_basis([((a, 0),) for a in exponents])
                return _Lone(group.dispersion, group.length, group.position, (i,), basis)
        return None

    # -------------------------------------------------------------------------------- complex arithmetic

    def _sizes(self, site: Site) -> tuple[list[_Test], list[int]]:
        """Return the tests for small arguments, and how many each group has."""
        tests: list[_Test] = []
        counts = []
        for group in self.groups:
            limit = self.reach / group.spread
            own_tests = [(x, limit**power, c) for x, c, power in site.sizes(group.dispersion, group.length)]
            tests += own_tests
            counts.append(len(own_tests))
        return tests, counts

    def _near(self, bits: Sequence[bool], counts: Sequence[int]) -> tuple[bool, ...]:
        """Return which groups are taken to be small."""
        near, at = [], 0
        for count in counts:
            near.append(all(bits[at : at + count]))
            at += count
        return tuple(near) if len(near) <= self.apart or all(near) else (False,) * len(near)

    def _together(
        self, forge: Forge, tests: Sequence[_Test], counts: Sequence[int], turn: int | None
    ) -> Callable[[tuple[bool, ...]], bool]:
        """Return what tells whether just some groups are small at any frequency."""
        if self.values is None or (len(self.groups) <= TOGETHER and len(self.table.dispersions) == 1):
            return lambda _: True
        import numpy as np  # formulas are printed without it

        from symflex.codegen.program.evaluate import numbers_of_pieces

        omega = np.geomspace(LOWEST, HIGHEST, STEPS)
        nothing = CodePiece(straight(forge, [forge.constant(0), forge.constant(1)]))
        program = self._assembled(forge, tests[: sum(counts)], [], [nothing], turn)
        with np.errstate(all="ignore"):
            piece_numbers = numbers_of_pieces(program, omega if program.is_real else 1j * omega, self.values)
        bits = [[bool(number >> i & 1) for i in range(sum(counts))] for number in set(piece_numbers.tolist())]
        return {self._near(near, counts) for near in bits}.__contains__

    def program(self) -> Piecewise:
        """Return the program for complex s."""
        forge = forge_of(self.tf.model)
        site = Site(forge, self.tf, self.families)
        tests, counts = self._sizes(site)
        first, one = len(tests), forge.constant(1)
        tests += [(site.exponent(self.families[i], 0), 0.0, one) for i in self.delays]
        second = len(tests)
        pairs = [i for i, g in enumerate(self.groups) if g.dispersion.kind == "pair"]
        tests += [
            (site.distance(self.groups[i].dispersion, self.groups[i].length), CONFLUENT, one) for i in pairs
        ]
        fourth = len(tests)
        laws = [d for d in self.table.dispersions if any(self.groups[i].dispersion is d for i in pairs)]
        for law in laws:  # is the smaller of a pair's arguments small at every length?
            of_law = [g for g in self.groups if g.dispersion is law]
            reaches = [forge.multiply([forge.constant(g.spread), site.value(g.length)]) for g in of_law]
            scale = forge.multiply([forge.constant(2), forge.power(forge.add(reaches), 2)])
            # At least half the square of the smaller wavenumber in size.
            quotient = forge.divide(site.coefficient(law), site.coefficient(law, 2))
            tests.append((quotient, (LONE * self.reach) ** 2, scale))
        fifth = len(tests)
        occurs = self._together(forge, tests, counts, None)

        def choice(near: tuple[bool, ...], bits: Sequence[bool]) -> _Choice:
            grows = tuple(bits[first:second])
            far = {self.groups[i].dispersion for i in pairs if not near[i]}
            lone = tuple(
                d for d, b in zip(laws, bits[fourth:fifth], strict=True) if b and d in far and not all(near)
            )
            meets = any(
                bits[second + j] and not near[i] and self.groups[i].dispersion not in lone
                for j, i in enumerate(pairs)
            )
            return near, grows, meets, lone

        choices = self._choices(len(tests), counts, occurs, choice)
        kept = list(dict.fromkeys(choices))
        code = [self._piece(*each) for each in kept]
        return self._assembled(forge, tests, [kept.index(each) for each in choices], code, None)

    def _choices(
        self,
        count: int,
        counts: Sequence[int],
        occurs: Callable[[tuple[bool, ...]], bool],
        choice: Callable[[tuple[bool, ...], Sequence[bool]], Choice],
    ) -> list[Choice]:
        """Return what is chosen by the results of tests, for every number that these make."""
        choices = []
        for number in range(2**count):
            bits = [bool(number >> i & 1) for i in range(count)]
            near = self._near(bits, counts)
            choices.append(choice(near if occurs(near) else (False,) * len(near), bits))
        return choices

    def _assembled(
        self,
        forge: Forge,
        tests: Sequence[_Test],
        numbers: list[int],
        code: list[CodePiece],
        turn: int | None,
    ) -> Piecewise:
        head = straight(forge, [*(x for x, _, _ in tests), *(c for _, _, c in tests)] or [forge.constant(1)])
        nodes = zip(head.values, tests, head.values[len(tests) :], strict=False)
        conditions = tuple(Condition(n, limit, scale) for n, (_, limit, _), scale in nodes)
        parameters = tuple(p.name for p in self.tf.parameters)
        return Piecewise(parameters, head, conditions, tuple(numbers), tuple(code), turn)

    def _piece(
        self,
        near: tuple[bool, ...],
        grows: tuple[bool, ...] = (),
        meets: bool = False,
        lone: tuple[Dispersion, ...] = (),
        *,
        is_complex: bool = False,
    ) -> CodePiece:
        forge = forge_of(self.tf.model)
        delays = dict(zip(self.delays, grows, strict=True))
        site = Site(forge, self.tf, self.families, delays, self._exponents())
        groups: list[_Group] = [g for g, n in zip(self.groups, near, strict=True) if n]
        for group, is_near in zip(self.groups, near, strict=True):
            if not is_near and group.dispersion in lone and (lone_group := self._lone(group)) is not None:
                groups.append(lone_group)
        scales = self._scales(groups, site.grows)
        values, gain = [], self.plain
        for half, sign in zip(self.halves, (1, -1), strict=True):
            value, taken = self._value(half, groups, site, scales)
            if meets:
                # On a circle each half has to be analytic by itself, its powers of wavenumbers included.
                value, taken = forge.multiply([site.value(taken), value]), taken**0
            values.append(value)
            gain = gain * taken**sign
        num = forge.multiply([site.value(gain.numerator()), values[0]])
        den = forge.multiply([site.value(gain.denominator()), values[1]])
        if not meets:
            return CodePiece(straight(forge, [num, den]), 0, is_complex)
        growth = forge.add([forge.multiply([forge.constant(d), site.angle(*at)]) for at, d in scales.items()])
        size = forge.add([forge.constant(2), *(site.angle(*at) for at in scales)])
        radius = forge.divide(forge.apply("abs", forge.s), size)
        return CodePiece(straight(forge, [num, den, growth, radius]), CIRCLE)

    def _exponents(self) -> dict[tuple[int, int], list[tuple[int, int]]]:
        keys = [key for h in self.halves for key in h.terms]
        return {
            (i, j): sorted({key[i][0][j] for key in keys})
            for i, family in enumerate(self.families)
            for j in range(len(family.lengths))
        }

    def _scales(self, near: Sequence[_Group], grows: Mapping[int, bool]) -> Scales:
        """Return per family, and length that is not small, the largest exponent that occurs."""
        small = {(i, g.position) for g in near for i in g.families}
        keys = [key for h in self.halves for key in h.terms]
        return {
            (i, j): max((-1 if grows.get(i) else 1) * key[i][0][j][0] + abs(key[i][0][j][1]) for key in keys)
            for i, family in enumerate(self.families)
            for j in range(len(family.lengths))
            if (i, j) not in small
        }

    def _value(self, half: _Half, near: Sequence[_Group], site: Site, scales: Scales) -> tuple[int, Factored]:
        """Return the expression of a half, and the factor that was taken out of it."""
        forge = site.forge
        if not near:
            leaves = {key: site.polynomial(p) for key, p in half.far.items()}
            return site.exponential_sum(leaves, scales), half.waves * half.unit
        parts = self._local_parts(half, near)
        taken = Factored.number(self.ring, 1)
        if len(near) == len(self.groups) or any(isinstance(g, _Lone) for g in near):
            taken = self._power_of_s(v for by_key in parts.values() for v in by_key.values())
        summands = []
        solution = cache(partial(self._solution, site))
        for orders, by_key in parts.items():
            leaves = {key: site.value(v / taken) for key, v in by_key.items()}
            inner = site.exponential_sum(leaves, scales)
            summands.append(forge.multiply([inner, *map(solution, near, orders)]))
        return forge.add(summands), taken

    def _solution(self, site: Site, group: _Group, k: int) -> int:
        reach = LONE * self.reach if isinstance(group, _Lone) else self.reach
        return site.local(group.basis, group.dispersion, group.length, k, reach)

    def _power_of_s(self, values: Iterable[Factored]) -> Factored:
        """Return the power of s that all values share."""
        s = self.ring.context.gen(0)
        power = min(v.exponent_of(s) for v in values)
        return Factored.generator(self.ring, LAPLACE) ** power

    def _local_parts(self, half: _Half, near: Sequence[_Group]) -> _LocalParts:
        """Return what remains of a half where some lengths are small."""
        key = (half, tuple(near))
        if key not in self._parts:
            self._parts[key] = self._new_parts(half, near)
        return self._parts[key]

    def _new_parts(self, half: _Half, near: Sequence[_Group]) -> _LocalParts:
        parts: _LocalParts = {}
        lone = [g.dispersion for g in near if isinstance(g, _Lone)]
        for orders, terms in self._derivatives(half.terms, near):
            spend()
            if len(near) == 1 and parts and orders[0] > self.reach:
                (lowest,), (order,) = next(iter(parts)), orders
                largest = max(taylor_term(self.reach, m) for m in range(lowest, order))
                if taylor_term(self.reach, order) < SERIES_ERROR + largest:
                    break  # this derivative in a small length, and all that follow, add nothing
            values = {
                k: self._reduced(Factored.polynomial(self.ring, p * 2 ** self._still(k)) * half.waves, lone)
                for k, p in terms.items()
            }
            if values := {k: v for k, v in values.items() if not v.is_zero}:
                parts[orders] = values
        return parts

    def _derivatives(
        self, terms: KernelSum, near: Sequence[_Group]
    ) -> Iterator[tuple[tuple[int, ...], KernelSum]]:
        """Yield the derivatives with respect to lengths at zero that do not vanish, by their orders."""
        if not near:
            yield (), terms
            return
        first, *others = near
        for order in range(first.basis.order):
            if derived := self._derivative(terms, first, order):
                yield from (
                    ((order, *orders), derivative)
                    for orders, derivative in self._derivatives(derived, others)
                )

    def _derivative(self, terms: KernelSum, group: _Group, order: int) -> KernelSum:
        """Return the derivative of a sum with respect to a length at zero."""
        gens = [self.ring.generator(self.families[i].wavenumber) for i in group.families]
        derivative: KernelSum = {}
        for key, polynomial in terms.items():
            if len(gens) == 1:
                (i,) = group.families
                images = derivative_at_zero(key[i], group.position, order)
                moved = [((*key[:i], t, *key[i + 1 :]), gens[0] ** order * n) for t, n in images]
            else:
                pairs = [key[i][0] for i in group.families]
                (a, _), (b, _) = (p[group.position] for p in pairs)
                other_key = list(key)
                for i, p in zip(group.families, pairs, strict=True):
                    other_key[i] = ((*p[: group.position], (0, 0), *p[group.position + 1 :]), 0)
                moved = [(tuple(other_key), (gens[0] * a + gens[1] * b) ** order)]
            for k, factor in moved:
                derivative[k] = derivative.get(k, self.ring.constant(0)) + polynomial * factor
        return {k: p for k, p in derivative.items() if len(p)}

    def _reduced(self, value: Factored, lone: Sequence[Dispersion]) -> Factored:
        """Return a value in normal form, free of wavenumbers, or of negative powers of the ``lone`` ones."""
        for dispersion in self.table.dispersions:
            if dispersion.kind == "pair" and not value.is_zero:
                is_lone = any(d is dispersion for d in lone)
                reduce = self._without_smaller if is_lone else self._without_pair
                value = reduce(value, dispersion)
        # Powers of a lone wavenumber are small; the relations would make differences of large terms of them.
        return value if lone else self.normal.reduce_factored(value)

    def _normal_form(self, polynomial: fmpz_mpoly) -> Factored:
        self.work += len(polynomial)
        if self.work > LOCAL_TERMS:
            message = f"the series of {self.tf.name} for small arguments would take too long to find"
            hint = "give some parameters numbers, or leave out damping, loads or lengths"
            raise BudgetError(Diagnostic("SF503", message, None, hint))
        return self.normal.reduce(polynomial)

    def _without_smaller(self, value: Factored, dispersion: Dispersion) -> Factored:
        """Return a value finite where the smaller wavenumber is zero, without negative powers of it."""
        large, small = (Factored.generator(self.ring, w) for w in dispersion.wavenumbers)
        (first, _), (second, _) = large.factors[0], small.factors[0]
        power = value.exponent_of(second)
        if power >= 0:
            return value
        even = -power + power % 2
        outside = value.exponent_of(first)
        # Powers of the larger one stay outside, where they are harmless; even ones are all there is of it.
        scaled = value / large**outside * (large * small) ** even
        numerator = self._normal_form(scaled.numerator().expand()) / scaled.denominator()
        if numerator.is_zero:
            return numerator
        reduced, _ = cancel(numerator, dispersion.characteristic[0] ** (even // 2))
        return reduced * large**outside

    def _without_pair(self, value: Factored, dispersion: Dispersion) -> Factored:
        """Return a value that is symmetric in two wavenumbers without them."""
        one, other = (Factored.generator(self.ring, w) for w in dispersion.wavenumbers)
        split = one**2 - other**2
        singles = [f for w in (one, other) for f, _ in w.factors]
        ((difference, _),) = split.factors
        lowest = min([0, *(e for f, e in value.factors if f in singles)])
        meeting = min([0, *(e for f, e in value.factors if f == difference)])
        even, twice = -lowest + lowest % 2, -meeting + meeting % 2
        c0, c2 = dispersion.characteristic[0], dispersion.characteristic[2]
        scaled = value * (one * other) ** even * split**twice
        numerator = self._normal_form(scaled.numerator().expand()) / scaled.denominator()
        if numerator.is_zero:
            return numerator
        reduced, _ = cancel(numerator, c0 ** (even // 2) * (c2**2 - c0 * 4) ** (twice // 2))
        return reduced

    def side(self, number: int, factor: Factored) -> Straight:
        """Return a numerator or denominator; see :meth:`Pieces.side`."""
        forge, half = forge_of(self.tf.model), self.halves[number]
        site = Site(forge, self.tf, self.families, {}, self._exponents())
        scales = self._scales((), {})
        value, taken = self._value(half, (), site, scales)
        growth = [forge.multiply([forge.constant(d), site.angle(*at)]) for at, d in scales.items()]
        outside, s = self.plains[number] * taken * factor, self.ring.context.gen(0)
        expanded = (self.tf.num, self.tf.den)[number] * factor
        names = [(k.dispersion, k.generator) for k in self.table.kernels]
        names += [(law, wave) for law in self.table.dispersions for wave in law.wavenumbers]
        used = {law for law, name in names if expanded.depends_on(name)}
        laws = [c for law in self.table.dispersions if law in used for c in (*law.characteristic, law.shift)]
        # Powers of s stand against those of wavenumbers: what they make is a zero at s = 0, if anything.
        plain = outside.filter(lambda f: f != s and not self._holds(f, self.waves))
        below = [v.denominator() for v in (plain, *laws)]
        divisors = [site.value(v) for v in below if v.depends_on(LAPLACE)]
        product = forge.multiply([site.value(outside), value])
        return straight(forge, [product, forge.add(growth), *divisors])

    # ----------------------------------------------------------------------------------- real arithmetic

    def real_program(self, axis: RealAxis) -> Piecewise | None:
        """Return the program for positive frequencies, ``None`` unless it is real up to a power of j."""
        forge = Forge()
        site = Site(forge, self.tf, self.families, axis=axis)
        tests, counts = self._sizes(site)
        first = len(tests)
        signed = [d for d in self.table.dispersions if axis.sign(d) is None]
        tests += [(site.coefficient(d), 0.0, forge.constant(1)) for d in signed]
        occurs = self._together(forge, tests, counts, 0)

        def choice(near: tuple[bool, ...], bits: Sequence[bool]) -> tuple[tuple[bool, ...], tuple[bool, ...]]:
            return near, tuple(b and not all(near) for b in bits[first:])

        choices = self._choices(len(tests), counts, occurs, choice)
        kept = list(dict.fromkeys(choices))
        code: list[CodePiece] = []
        turn: int | None = None
        for near, negative in kept:
            if any(near) and not all(near):
                code.append(self._piece(near, is_complex=True))
                continue
            signs = dict(zip(signed, negative, strict=True))
            made = self._real_piece(replace(axis, signs=signs), turn, is_near=all(near))
            if made is None:
                return None
            piece, turn = made
            code.append(piece)
        return self._assembled(forge, tests, [kept.index(each) for each in choices], code, turn)

    def _real_piece(
        self, axis: RealAxis, wanted: int | None, *, is_near: bool
    ) -> tuple[CodePiece, int] | None:
        """Return a piece and the power of j it leaves out, 0 or 1 and the wanted one if there is one."""
        forge = Forge()
        site = Site(forge, self.tf, self.families, axis=axis)
        gain, values, turn = self.plain, [], 0
        waves = Factored.number(self.ring, 1)
        if is_near:
            for half, sign in zip(self.halves, (1, -1), strict=True):
                near = self._real_near(site, axis, half)
                if near is None:
                    return None
                value, turn_here, taken = near
                values.append(value)
                gain = gain * taken**sign
                turn += sign * turn_here
        else:
            sums = [axis.real_sum(h.terms, h.waves, self.families) for h in self.halves]
            above, below = sums
            if above is None or below is None:
                return None
            values = list(site.real_sums([above, below]))
            turn = above.turn - below.turn
            waves = above.waves / below.waves
        real_gain = axis.real(gain)
        if real_gain is None:
            return None
        real, turn_here = real_gain[0] * waves, real_gain[1]
        is_negative, turn = divmod((turn + turn_here) % 4, 2)
        if wanted is not None and turn != wanted:
            return None
        real = -real if is_negative else real
        num = forge.multiply([site.value(real.numerator()), values[0]])
        den = forge.multiply([site.value(real.denominator()), values[1]])
        return CodePiece(straight(forge, [num, den])), turn

    def _real_near(self, site: Site, axis: RealAxis, half: _Half) -> tuple[int, int, Factored] | None:
        """Return a half where all arguments are small, its power of j, and the factor taken out."""
        forge = site.forge
        parts = self._local_parts(half, self.groups)
        values = {orders: next(iter(by_key.values())) for orders, by_key in parts.items()}
        taken = self._power_of_s(values.values())
        first: int | None = None
        summands = []
        solution = cache(partial(self._solution, site))
        for orders, value in values.items():
            real_value = axis.real(value / taken)
            if real_value is None:
                return None
            real, turn = real_value
            first = turn if first is None else first
            if (turn - first) % 2:
                return None
            summand = forge.multiply([site.value(real), *map(solution, self.groups, orders)])
            summands.append(forge.negate(summand) if (turn - first) % 4 else summand)
        return forge.add(summands), first or 0, taken


def declared_length(tf: TransferFunction, length: Factored) -> float:
    """Return the declared value of a length; without values, of a model with every parameter 1."""
    declared = {p.name: float(p.value.nearly) for p in tf.parameters if p.value is not None}
    point = [declared.get(name, 1.0) for name in length.ring.names]
    factors = (value_at(f, point.__getitem__, float) ** e for f, e in length.factors)
    return prod(factors, start=float(length.unit))


def _longer_and_shorter(
    sums: Sequence[KernelSum],
    families: Sequence[int],
    matrix: Sequence[Sequence[int]],
    values: Sequence[float],
) -> tuple[int, int] | None:
    """Return which length is to be cut by which, None if the denominator's largest term is largest."""
    count = range(len(values))
    for i in families:
        terms = [[in_other_lengths(key[i][0], matrix) for key in s] for s in sums]
        highest = [max(a[k] + abs(b[k]) for side in terms for a, b in side) for k in count]
        largest = max(
            ([x + sign * y for x, y in zip(a, b, strict=True)] for a, b in terms[1] for sign in (1, -1)),
            key=lambda growth: sum(map(mul, growth, values)),
        )
        for short in (k for k in count if largest[k] < highest[k]):
            others = sorted((k for k in count if k != short and largest[k]), key=lambda k: -largest[k])
            longer = [k for k in others if values[k] > values[short]]
            if others:
                return (longer[0], short) if longer else (short, others[0])
    return None
