"""Poles and zeros of functions with loss factors: the natural frequency and loss factor of every mode.

Input: a bound transfer function whose coefficients hold j.
Output: a :class:`~symflex.roots.PoleZeroMap` of the roots with im s >= 0, as j belongs to omega > 0.

    m s^2 + k (1 + j eta):  s^2 = -omega_r^2 (1 + j eta_r),  omega_r = sqrt(k/m),  eta_r = eta

A polynomial f = g + j h with real g and h has the roots of ``g^2 + h^2 = f(s) conj(f)(s)`` at which f
vanishes; g and h being coprime, conj(f) does not. The same test tells a function with kernels and complex
coefficients from its image. One with loss factors is searched in the upper half-plane like any other, but
for its mirror images: with j among its coefficients it has none.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final

from flint import acb, fmpz_mpoly

from symflex.algebra import Factored, degree_in, real_parts, summed, terms_of
from symflex.balls import at_centre, precision
from symflex.errors import Diagnostic, UncertifiedError
from symflex.model.loss_factors import has_loss_factors
from symflex.model.model import IMAGINARY
from symflex.roots.engines import POLYNOMIAL
from symflex.roots.pole_zero_map import Certificate, HiddenRoot, PoleZeroMap, StabilityVerdict, chosen, judge
from symflex.roots.polynomial_roots import find_polynomial_roots
from symflex.roots.problem import cancelled, problem_of
from symflex.roots.region import Everything, Region
from symflex.roots.root import LossyRoot, Root
from symflex.transfer import BoundTransferFunction
from symflex.transfer.mirrored import mirrored

NO_STABILITY: Final = StabilityVerdict(
    "unknown",
    None,
    certified=False,
    reason="loss factors hold only on s = j*omega and do not decide stability",
)
COMPLEX: Final = "coefficients are complex, and poles need no conjugates"
DOUBLINGS: Final = 5  # how often digits are doubled until a root differs from its mirror image
UNJUDGED: Final = PoleZeroMap("", Everything(), (), (), (), Certificate("", 0, 0))
"""With which stability is not asked for where it means nothing."""


def locate_lossy(
    bound: BoundTransferFunction, region: Region, digits: int, locate: Callable[..., PoleZeroMap]
) -> PoleZeroMap:
    """Find poles and zeros of a function with j, by ``locate`` if it has kernels; else SF402."""
    is_lossy = has_loss_factors(bound.source.model)
    if not bound.is_rational and not is_lossy:
        return _locate_both(bound, region, digits, locate)
    if not bound.is_rational:
        located = locate(replace(bound, is_of_model=False), region, digits, judged=UNJUDGED)
        shown = _upper(located.poles), _upper(located.zeros)
        hidden = [replace(h, root=LossyRoot.of(h.root)) for h in located.hidden if not h.root.im < 0]
        certificate = located.certificate
        return PoleZeroMap.of(
            bound.name,
            region,
            digits,
            certificate.engine,
            (*shown, hidden),
            NO_STABILITY,
            missing=certificate.counted - certificate.found,
            reasons=[certificate.reason],
            code=certificate.code,
            excluded=located.excluded,
        )
    every = (bound.ratio.denominator(), bound.ratio.numerator(), cancelled(bound))
    sides = [complex_roots(bound, part.factors, digits) for part in every]
    verdict = NO_STABILITY
    if is_lossy:
        sides = [_upper(roots) for roots in sides]
    else:
        verdict = judge(sides[0], hidden=sides[2])
        verdict = replace(verdict, reason=_with_reason(verdict.reason))
    poles, zeros, cancels = (chosen(roots, region) for roots in sides)
    all_shown = (poles, zeros, [HiddenRoot(root) for root in cancels])
    return PoleZeroMap.of(bound.name, region, digits, POLYNOMIAL, all_shown, verdict, is_infinite=False)


def _locate_both(
    bound: BoundTransferFunction, region: Region, digits: int, locate: Callable[..., PoleZeroMap]
) -> PoleZeroMap:
    """Find poles and zeros of a function with complex coefficients among those of it and its mirror image."""
    product = mirrored(bound)
    if product is None:
        message = f"poles and zeros of {bound.name} are not searched: its waves have complex coefficients"
        hint = "write real equations, of both planes or axes; or plot its frequency response (plot bode)"
        raise UncertifiedError(Diagnostic("SF404", message, None, hint))
    located = locate(product, region, digits, own=OwnRoots(bound))
    verdict = located.verdict
    return replace(located, verdict=replace(verdict, reason=_with_reason(verdict.reason)))


def _with_reason(reason: str) -> str:
    return "; ".join(filter(None, (reason, COMPLEX)))


@dataclass(frozen=True, slots=True)
class OwnRoots:
    """Tells the roots of a function with complex coefficients from those of its mirror image."""

    bound: BoundTransferFunction

    def __call__(self, roots: Iterable[Root], part: Factored) -> list[Root]:
        """Return those of one part among roots of it times its image; SF404 where that is not decided."""
        own: list[Root] = []
        for root in roots:
            count, rest = root.multiplicity, 0
            # Off the real axis a root belongs to one of both, or to a factor that is real, twice then.
            here, there = (True, True) if root.is_real else self._vanishes(part, root)
            if here and there:
                count, rest = divmod(count, 2)
            if rest or not (here or there):
                raise _not_told(self.bound)
            own += [replace(root, multiplicity=count)] if here else []
        return own

    def _vanishes(self, part: Factored, root: Root) -> tuple[bool, bool]:
        """Tell whether a part may vanish at a root, and at its mirror image."""
        with precision(root.working_bits()):
            s, kernels = root.enclosure(), self.bound.kernel_values()
            values = [at_centre(kernels.value(part, kernels.at(x))) for x in (s, s.conjugate())]
            return bool(values[0].contains(0)), bool(values[1].contains(0))


def complex_roots(
    bound: BoundTransferFunction, factors: Iterable[tuple[fmpz_mpoly, int]], digits: int
) -> list[Root]:
    """Return the roots of polynomials in s and j."""
    ring, roots = bound.ratio.ring, list[Root]()
    for factor, exponent in factors:
        if not degree_in(factor, 0):
            continue
        g, h = real_parts(ring, factor, IMAGINARY)
        common = g.gcd(h)
        real = [(common, abs(exponent))] if degree_in(common, 0) else []
        roots += find_polynomial_roots(problem_of(bound, real), digits)
        g, h = g // common, h // common
        if not h.is_zero() and (degree_in(g, 0) or degree_in(h, 0)):
            roots += _apart(bound, g, h, abs(exponent), digits)
    return roots


def _apart(
    bound: BoundTransferFunction, g: fmpz_mpoly, h: fmpz_mpoly, exponent: int, digits: int
) -> list[Root]:
    """Return the roots of g + j h, of which g and h share none."""
    problem = problem_of(bound, [(g * g + h * h, exponent)])
    for doubling in range(DOUBLINGS):
        roots = [r for r in find_polynomial_roots(problem, digits << doubling) if r.im > 0 and not r.is_real]
        sides = [_vanishes(bound, g, h, root) for root in roots]
        if None not in sides:
            return [r if side else replace(r, im=-r.im) for r, side in zip(roots, sides, strict=True)]
    raise _not_told(bound)


def _not_told(bound: BoundTransferFunction) -> UncertifiedError:
    message = f"a root of {bound.name} cannot be told from the mirror image of another"
    return UncertifiedError(
        Diagnostic("SF404", message, None, "imaginary parts of coefficients as small as this may be left out")
    )


def _vanishes(bound: BoundTransferFunction, g: fmpz_mpoly, h: fmpz_mpoly, root: Root) -> bool | None:
    """Tell whether g + j h vanishes at a root of it or of its mirror image, ``None`` if not decided."""
    ring = bound.ratio.ring
    with precision(root.working_bits()):
        values = {name: acb(evaluate()) for name, evaluate in bound.constants} | {"s": root.enclosure()}
        real, imaginary = (summed(terms_of(f), ring.names, values.__getitem__, acb(1)) for f in (g, h))
        ours, theirs = (bool((real + acb(0, sign) * imaginary).contains(0)) for sign in (1, -1))
        return None if ours == theirs else ours


def _upper(roots: Sequence[Root]) -> list[Root]:
    return [LossyRoot.of(root) for root in roots if not root.im < 0]
