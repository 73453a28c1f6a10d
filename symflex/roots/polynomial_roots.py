"""All roots of a product of polynomials: exact splitting, isolation, and back from z = s^2 to s."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cmp_to_key

from flint import acb, arb

from symflex.balls import bits_for_digits, precision
from symflex.errors import BudgetError
from symflex.roots.engines import proposers_for
from symflex.roots.polynomials.discs import Disc, Proposer, connected
from symflex.roots.polynomials.isolation import isolations
from symflex.roots.problem import RootProblem, Splitting, SquareFreePart, split
from symflex.roots.root import GUARD_BITS, Root, count_roots, root_at_zero

DISTINCTION_ROUNDS = 5  # doublings of the digits until roots of different factors are separated
ROUNDING = 1e-12  # relative difference of two doubles below which their order is asked of the balls


def find_polynomial_roots(
    problem: RootProblem, digits: int, proposers: tuple[Proposer, ...] = ()
) -> tuple[Root, ...]:
    """Enclose every root of a product of polynomials with exact coefficients, to so many digits.

    The order is by natural frequency, then real part, positive imaginary part first.
    SF401, SF404, SF506: ``found`` has the roots proved until then. ``proposers`` guess roots, in turn.
    """
    if digits < 1:
        raise ValueError(f"digits must be at least 1, not {digits}")
    for polynomial, _ in problem.factors:
        polynomial.require_leading_coefficient()
    return _PolynomialSearch(problem, digits, proposers).run()


class _PolynomialSearch:
    """Solves the parts of a product one after the other."""

    def __init__(self, problem: RootProblem, digits: int, proposers: tuple[Proposer, ...]) -> None:
        self.problem, self.digits, self.proposers = problem, digits, proposers
        self.splitting = Splitting(0, ())
        self.solved: dict[int, list[Root]] = {}

    def run(self) -> tuple[Root, ...]:
        """Return all roots."""
        wanted = self.digits
        try:
            self.splitting = split(self.problem)
            for _ in range(DISTINCTION_ROUNDS):
                for i in range(len(self.splitting.parts)):
                    self._solve(i, wanted)
                merged = self._merged()
                if len(merged) == len(self._all()):
                    break
                wanted *= 2
        except BudgetError as error:
            # Where constants satisfy a relation, parts that are not solved may have the same roots.
            is_exact = all(part.polynomial.is_exact for part in self.splitting.parts)
            finished = in_order(self._merged()) if is_exact else ()
            raise BudgetError(*error.diagnostics, found=finished) from None
        return in_order(merged)

    def _solve(self, i: int, digits: int) -> None:
        part = self.splitting.parts[i]
        proposers = self.proposers or proposers_for(part.polynomial.degree)
        for discs in isolations(part.polynomial, digits, in_square=part.in_square, proposers=proposers):
            self.solved[i] = _roots_of(part, discs, digits)

    def _all(self) -> list[Root]:
        roots = [root for part in self.solved.values() for root in part]
        return [*root_at_zero(self.splitting.zeros), *roots]

    def _merged(self) -> list[Root]:
        """Return the roots, those that may be the same as one."""
        roots = self._all()
        return [_merge([roots[i] for i in cluster]) for cluster in _touching(roots)]


def _roots_of(part: SquareFreePart, discs: Sequence[Disc], digits: int) -> list[Root]:
    convert = _square_roots if part.in_square else _conjugates
    roots: list[Root] = []
    for disc in discs:
        # An exact centre may have few bits, its square root needs them all.
        with precision(max(disc.centre.bits(), bits_for_digits(digits)) + GUARD_BITS):
            converted = convert(disc)
        roots.extend(replace(root, multiplicity=root.multiplicity * part.multiplicity) for root in converted)
    return roots


def _conjugates(disc: Disc) -> list[Root]:
    """Return the root in a disc and, off the real axis, its conjugate."""
    re, im = arb(disc.centre.real, disc.radius), arb(disc.centre.imag, disc.radius)
    simple = disc.count == 1
    if not disc.is_real:
        return [
            Root(re, each, disc.count, on_imaginary_axis=False, is_real=False, certified=simple)
            for each in (im, -im)
        ]
    im = arb(0) if simple else im
    return [Root(re, im, disc.count, on_imaginary_axis=False, is_real=simple, certified=simple)]


def _square_roots(disc: Disc) -> list[Root]:
    """Return the roots s with s^2 in a disc or in its mirror image."""
    if not disc.centre.abs_lower() > disc.radius:
        reach = (disc.centre.abs_upper() + disc.radius).sqrt().upper()
        count = (2 if disc.is_real else 4) * disc.count
        box = arb(0, reach)
        return [Root(box, box, count, on_imaginary_axis=False, is_real=False, certified=False)]
    simple = disc.count == 1
    z = arb(disc.centre.real, disc.radius)
    if disc.is_real and simple:
        size, zero = abs(z).sqrt(), arb(0)
        if z > 0:
            return [Root(s, zero, 1, on_imaginary_axis=False, is_real=True) for s in (-size, size)]
        return [Root(zero, s, 1, on_imaginary_axis=True, is_real=False) for s in (size, -size)]
    # A cluster about a negative z would meet the branch cut of the square root.
    square = acb(z, arb(disc.centre.imag, disc.radius))
    s = square.sqrt() if disc.centre.real > 0 else acb(0, 1) * (-square).sqrt()
    signs = [(1, 1), (-1, -1)] if disc.is_real else [(1, 1), (1, -1), (-1, 1), (-1, -1)]
    return [
        Root(x * s.real, y * s.imag, disc.count, on_imaginary_axis=False, is_real=False, certified=simple)
        for x, y in signs
    ]


def _touching(roots: Sequence[Root]) -> list[tuple[int, ...]]:
    """Return the indices of roots in groups whose enclosures are not proved disjoint."""
    bits = max((root.working_bits() for root in roots), default=GUARD_BITS)
    with precision(bits):
        discs = []
        for root in roots:
            box = root.enclosure()
            discs.append(Disc(box.mid(), (box - box.mid()).abs_upper()))
        return connected(discs)


def _merge(cluster: Sequence[Root]) -> Root:
    """Return one box for roots that could not be separated."""
    if len(cluster) == 1:
        return cluster[0]
    with precision(max(root.working_bits() for root in cluster)):
        re, im = _hull([root.re for root in cluster]), _hull([root.im for root in cluster])
    return Root(
        re,
        im,
        count_roots(cluster),
        on_imaginary_axis=all(root.on_imaginary_axis for root in cluster),
        is_real=all(root.is_real for root in cluster),
        certified=False,
    )


def _hull(balls: Sequence[arb]) -> arb:
    """Return a ball around real balls; arb.union loses half the digits."""
    low, high = min(ball.lower() for ball in balls), max(ball.upper() for ball in balls)
    middle = ((low + high) / 2).mid()
    return arb(middle, (high - middle).upper().max((middle - low).upper())) if high > low else low


def in_order(roots: Sequence[Root]) -> tuple[Root, ...]:
    """Sort by abs(s), real part, imaginary part downwards; overlapping balls count as equal."""
    keyed = [(root.size(), root) for root in roots]

    def compare(a: tuple[arb, Root], b: tuple[arb, Root]) -> int:
        x, y = float(a[0].mid()), float(b[0].mid())
        if abs(x - y) > ROUNDING * (x + y):
            return _sign(a[0].mid(), b[0].mid())
        return _sign(a[0], b[0]) or _sign(a[1].re, b[1].re) or _sign(b[1].im, a[1].im)

    return tuple(root for _, root in sorted(keyed, key=cmp_to_key(compare)))


def _sign(a: arb, b: arb) -> int:
    return int(a > b) - int(a < b)
