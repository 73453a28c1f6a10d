"""Poles and zeros of functions with loss factors: the natural frequency and loss factor of every mode.

Input: a bound transfer function whose coefficients hold j.
Output: a :class:`~symflex.roots.PoleZeroMap` of the roots with im s >= 0, as j belongs to omega > 0.

    m s^2 + k (1 + j eta):  s^2 = -omega_r^2 (1 + j eta_r),  omega_r = sqrt(k/m),  eta_r = eta

A polynomial f = g + j h with real g and h has the roots of ``g^2 + h^2 = f(s) conj(f)(s)`` at which f
vanishes; g and h being coprime, conj(f) does not. Of a function with kernels Newton steps begin at
the roots without losses, and each root is proved by an interval Newton step; that there are no others is not.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from itertools import combinations
from typing import TYPE_CHECKING, Final

from flint import acb, acb_series, arb

from symflex.algebra import Factored, by_powers, degree_in
from symflex.algebra.interval_newton import stays_inside
from symflex.budget import spend
from symflex.errors import Diagnostic, UncertifiedError
from symflex.model import with_numbers
from symflex.model.model import IMAGINARY, ExactValue
from symflex.roots.engines import POLYNOMIAL
from symflex.roots.pole_zero_map import Certificate, HiddenRoot, PoleZeroMap, StabilityVerdict
from symflex.roots.polynomial_roots import find_polynomial_roots
from symflex.roots.precision import precision
from symflex.roots.problem import problem_of
from symflex.roots.region import Position
from symflex.roots.root import Root
from symflex.transfer import bind
from symflex.transfer.balls import expansion
from symflex.transfer.of_model import derive_all

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from flint import fmpz_mpoly

    from symflex.roots.region import Region
    from symflex.transfer import BoundTransferFunction

NO_STABILITY: Final = StabilityVerdict(
    "unknown",
    None,
    certified=False,
    reason="loss factors hold on s = j*omega only, and say nothing of stability",
)
FOLLOWED: Final = "Newton steps from roots without losses"
NOT_COUNTED: Final = "each root is proved; that no other lies between them is not"
NEWTON: Final = 60
DOUBLINGS: Final = 5
"""Of digits, until a root is told from its mirror image."""
GUARD_BITS: Final = 40


@dataclass(frozen=True, slots=True)
class LossyRoot(Root):
    """A root of a function with loss factors: ``s^2 = -omega_r^2 (1 + j eta_r)``."""

    def natural_frequency(self) -> arb:
        """Return omega_r [rad/s], abs(s) where s^2 has no negative real part."""
        with precision(self.working_bits()):
            square = self.im**2 - self.re**2
            return square.sqrt() if square > 0 else abs(self.enclosure())

    def loss_factor(self) -> arb | None:
        """Return eta_r; None where s^2 has no negative real part."""
        with precision(self.working_bits()):
            square = self.im**2 - self.re**2
            return -2 * self.re * self.im / square if square > 0 else None


def locate_lossy(
    bound: BoundTransferFunction,
    region: Region,
    digits: int,
    locate: Callable[[BoundTransferFunction, Region, int], PoleZeroMap],
) -> PoleZeroMap:
    """Find poles and zeros of a function that holds j; see the module.

    ``locate`` finds those of functions that do not.

    Raises UncertifiedError: SF402 a root cannot be told from the mirror image of another.
    """
    sides = (bound.ratio.denominator(), bound.ratio.numerator())
    hidden = reduce(
        lambda a, h: a * Factored.polynomial(bound.ratio.ring, h.polynomial) ** h.multiplicity,
        bound.hidden,
        Factored.number(bound.ratio.ring, 1),
    )
    reason: str | None = None
    engine = POLYNOMIAL
    if bound.is_distributed:
        found, reason, engine = _followed(bound, region, digits, locate), NOT_COUNTED, FOLLOWED
    else:
        found = [_of_polynomials(bound, side.factors, digits) for side in (*sides, hidden)]
    poles, zeros, concealed = (_inside(region, roots) for roots in found)
    total = sum(root.multiplicity for roots in found for root in roots)
    return PoleZeroMap(
        bound.name,
        region,
        poles,
        zeros,
        tuple(HiddenRoot(root) for root in concealed),
        Certificate(engine, reason is None, total, total, reason),
        digits,
        is_infinite=bound.is_distributed,
        verdict=NO_STABILITY,
    )


def _inside(region: Region, roots: Sequence[Root]) -> tuple[Root, ...]:
    """Return the roots in a region, by natural frequency."""
    ordered = sorted(roots, key=lambda root: 0.0 if root.is_zero else float(root.natural_frequency().mid()))
    places = zip(ordered, region.classify(ordered), strict=True)
    return tuple(root for root, place in places if place is not Position.OUTSIDE)


def _of_polynomials(
    bound: BoundTransferFunction, factors: Iterable[tuple[fmpz_mpoly, int]], digits: int
) -> list[Root]:
    ring, roots = bound.ratio.ring, list[Root]()
    place = ring.index[IMAGINARY] if IMAGINARY in ring.index else None
    for factor, exponent in factors:
        if not degree_in(factor, 0):
            continue
        parts = by_powers(ring, factor, place) if place is not None else {0: factor}
        g, h = (parts.get(n, ring.constant(0)) for n in (0, 1))
        common = g.gcd(h)
        real = [(common, abs(exponent))] if degree_in(common, 0) else []
        roots += [_lossy(r) for r in find_polynomial_roots(problem_of(bound, real), digits) if not r.im < 0]
        g, h = g // common, h // common
        if not h.is_zero() and (degree_in(g, 0) or degree_in(h, 0)):
            roots += _upper(bound, g, h, abs(exponent), digits)
    return roots


def _upper(
    bound: BoundTransferFunction, g: fmpz_mpoly, h: fmpz_mpoly, exponent: int, digits: int
) -> list[Root]:
    """Return the roots of g + j h above the real axis."""
    problem = problem_of(bound, [(g * g + h * h, exponent)])
    for doubling in range(DOUBLINGS):
        roots = [r for r in find_polynomial_roots(problem, digits << doubling) if r.im > 0 and not r.is_real]
        sides = [_vanishes(bound, g, h, root) for root in roots]
        if None not in sides:
            return [_lossy(r) for r, side in zip(roots, sides, strict=True) if side]
    message = f"a root of {bound.name} is not told from the mirror image of another"
    raise UncertifiedError(
        Diagnostic("SF404", message, None, "loss factors as small as this may be left out")
    )


def _vanishes(bound: BoundTransferFunction, g: fmpz_mpoly, h: fmpz_mpoly, root: Root) -> bool | None:
    """Tell whether g + j h vanishes at a root of it or of its mirror image, ``None`` if not decided."""
    ring = bound.ratio.ring
    with precision(root.working_bits()):
        values = {name: acb(evaluate()) for name, evaluate in bound.constants} | {"s": root.enclosure()}

        def value(polynomial: fmpz_mpoly) -> acb:
            total = acb(0)
            for monomial, coefficient in polynomial.terms():
                term = acb(int(coefficient))
                for name, exponent in zip(ring.names, monomial, strict=True):
                    if exponent:
                        term = term * values[name] ** int(exponent)
                total = total + term
            return total

        real, imaginary = value(g), acb(0, 1) * value(h)
        ours, theirs = (bool((real + sign * imaginary).contains(0)) for sign in (1, -1))
        return None if ours == theirs else ours


def _lossy(root: Root) -> Root:
    return LossyRoot(
        root.re,
        root.im,
        root.multiplicity,
        on_imaginary_axis=root.on_imaginary_axis,
        is_real=root.is_real,
        certified=root.certified,
    )


def _followed(
    bound: BoundTransferFunction,
    region: Region,
    digits: int,
    locate: Callable[[BoundTransferFunction, Region, int], PoleZeroMap],
) -> list[list[Root]]:
    """Return poles and zeros of a function with kernels, begun at those without losses, and nothing hidden.

    Raises UncertifiedError: SF402 two of them become one.
    """
    model, source = bound.source.model, bound.source
    others = [p.name for p in model.settable]
    without = with_numbers(model, others, {IMAGINARY: ExactValue(Fraction(0))}, in_kernels=True)
    (plain,) = derive_all(without, [(source.output.name, source.input.name)])
    known = locate(bind(plain, {n: v for n, v in bound.values if n != IMAGINARY}), region, digits)
    bits = int(digits * 3.33) + GUARD_BITS
    found: list[list[Root]] = []
    for roots, part in ((known.poles, bound.den), (known.zeros, bound.num)):
        function = _series(bound, part, bits)
        moved = [
            _lossy(r) if r.is_zero else _moved(bound.name, function, r, bits) for r in roots if not r.im < 0
        ]
        if any(a.enclosure().overlaps(b.enclosure()) for a, b in combinations(moved, 2)):
            raise _not_followed(bound.name, moved[-1])
        found.append(moved)
    return [*found, []]


def _moved(name: str, function: Callable[[acb], tuple[acb, acb]], root: Root, bits: int) -> Root:
    """Return the root that one without losses becomes, proved.

    Raises UncertifiedError: SF402 it is not found near, or is not simple.
    """
    at = root.enclosure().mid()
    with precision(bits):
        for _ in range(NEWTON):
            spend()
            value, slope = function(at)
            change = (value / slope).mid()
            at = (at - change).mid()
            if not abs(change) > abs(at) * arb(2) ** (GUARD_BITS // 2 - bits):
                break
        reach = (abs(at) * arb(2) ** (GUARD_BITS - 8 - bits)).mid()
        box = acb(arb(at.real, reach), arb(at.imag, reach))
        is_near = abs(at - root.enclosure()) < abs(at) / 2 and at.imag > 0
        if not (is_near and stays_inside(function(at)[0] / function(box)[1], reach)):
            raise _not_followed(name, root)
    return LossyRoot(box.real, box.imag, 1, on_imaginary_axis=False, is_real=False)


def _not_followed(name: str, root: Root) -> UncertifiedError:
    message = f"a mode of {name} near {root.frequency_hz():.6g} Hz cannot be followed from no losses"
    return UncertifiedError(Diagnostic("SF404", message, None, "look at its frequency response"))


def _series(bound: BoundTransferFunction, part: Factored, bits: int) -> Callable[[acb], tuple[acb, acb]]:
    """Return a function that encloses a part's value and derivative."""
    with precision(bits):
        kernels = bound.kernel_values()

    def at(s: acb) -> tuple[acb, acb]:
        values = kernels.at(expansion(s))
        total = acb_series([1, 0], 2)
        for factor, exponent in part.factors:
            total = total * kernels.polynomial(factor, values) ** exponent
        return total[0], total[1]

    return at
