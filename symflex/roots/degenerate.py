"""Points at which wavenumbers vanish or meet, and which poles and hidden modes a model has there.

Input: a bound transfer function with kernels and the points where its laws of waves degenerate.
Output: how often denominator and numerator of the equations vanish there. A formula in wavenumbers is 0/0 at
such a point, so its factors do not say.

    a free beam on a foundation, k_f + rho A s^2 = 0: all wavenumbers vanish, and it turns without strain

Both determinants are entire; values on a small circle give their Taylor coefficients ``c_k r^k``. If one of
these is larger than all others together, the circle contains k roots (Rouche 1862).

    f = (s - 2)^2 (s - 5) about s = 2, r = 1e-38:  -3 r^2 is larger than r^3, and the disc contains two roots
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import ceil, isfinite, log
from typing import TYPE_CHECKING

from flint import acb, arb

from symflex.balls import UndecidedError, precision
from symflex.model import with_numbers
from symflex.model.along import is_tapered
from symflex.roots.distributed.side import polynomial_roots
from symflex.roots.functions.kernel_function import split_off_kernels
from symflex.roots.pole_zero_map import HiddenRoot
from symflex.roots.problem import cancelled
from symflex.roots.root import Root, count_roots, overlap
from symflex.transfer import BoundTransferFunction
from symflex.transfer.of_model import assemble_sparse

if TYPE_CHECKING:
    from symflex.roots.networks.cramer import CramerEquations

NOT_COUNTED = "it is not known which modes are hidden where wavenumbers vanish or meet"
POINT_DIGITS = 50  # digits of degenerate points: more than those that tell roots of the equations from them
NARROW = 128  # binary digits of abs(s) within which roots count as lying at a point: 38 decimal ones
WIDER = 100  # doublings of the radius of the disc in which the determinants are bounded
SPARE = 8  # values on the circle beyond those of the bound: higher orders are not counted
MOST_POINTS = 64  # values beyond which roots are not counted: where waves grow thousandfold bounds are crude
BITS = 1024, 4096  # precision of the coefficients; each order takes NARROW bits


def degenerate_points(bound: BoundTransferFunction) -> list[Root]:
    """Return where wavenumbers vanish or meet: what numerator and denominator share there is no mode."""
    roots: list[Root] = []
    for law in bound.kernels.dispersions:
        pair = (law.characteristic[2], law.discriminant) if law.kind == "pair" else ()
        for value in (*law.characteristic[:1], *law.meets, *pair):
            roots += [] if value.is_zero else polynomial_roots(bound, value, POINT_DIGITS)
    return roots


@dataclass(eq=False)
class DegeneratePoints:
    """The degenerate points of a function, with what its equations say of them."""

    bound: BoundTransferFunction
    roots: Sequence[Root]
    _counts: dict[complex, tuple[int, int] | None] = field(default_factory=dict)  # by point; None unknown

    @cached_property
    def distinct(self) -> list[Root]:
        """The points but 0, each once, as often as hidden factors of s alone vanish there."""
        points: list[Root] = []
        for point in self.roots:
            if not (point.is_zero or any(overlap(point, other) for other in points)):
                points.append(point)
        plain, _ = split_off_kernels(cancelled(self.bound), self.bound.kernels)
        modes = polynomial_roots(self.bound, plain, POINT_DIGITS) if points else []
        return [replace(p, multiplicity=count_roots(m for m in modes if overlap(p, m))) for p in points]

    @property
    def unproved(self) -> str:
        """Why hidden modes may be missing at the points that were looked at; empty where none is."""
        return NOT_COUNTED if None in self._counts.values() else ""

    def hidden(self, points: Iterable[Root]) -> list[HiddenRoot]:
        """Return what is hidden at some of the distinct points, in the equations where that is known."""
        modes: list[HiddenRoot] = []
        for point in points:
            counts = self._counted(point)
            exact = point.multiplicity if counts is None else min(point.multiplicity, counts[1])
            modes += [HiddenRoot(replace(point, multiplicity=exact))] if exact else []
            if counts is not None and (times := counts[1] - exact):
                modes.append(HiddenRoot(_about(point, times), "coincident"))
        return modes

    def coincident_elsewhere(self, modes: Iterable[HiddenRoot]) -> list[HiddenRoot]:
        """Return the modes that are hidden because a pole and a zero agree, but for those at points."""
        shared = (h for h in modes if h.cause == "coincident")
        return [h for h in shared if not any(overlap(h.root, p) for p in self.distinct)]

    def is_spurious(self, root: Root, *, is_hidden: bool) -> bool:
        """Tell whether a root of a formula belongs, for all that is known, to how the formula is written."""
        for point in self.distinct:
            if overlap(root, point):
                counts = self._counted(point)
                return not (counts[is_hidden] if counts else is_hidden and point.multiplicity)
        return False

    def _counted(self, point: Root) -> tuple[int, int] | None:
        """Return how many poles and hidden modes the equations have at a point, ``None`` if not known."""
        place = complex(float(point.re.mid()), abs(float(point.im.mid())))
        if place not in self._counts and self.bound.is_of_model:
            den, num = (None, None)
            if self._cramer is not None:
                with precision(point.working_bits()):
                    branch, s = self.bound.branch, point.enclosure()
                    s = branch(s) if branch is not None and self.bound.variable == "s" else s
                den, num = roots_about(self._cramer, s)
            num = den if self.bound.ratio.is_zero else num if den else 0
            counts = None if den is None or num is None else (max(den - num, 0), min(den, num))
            self._counts[place] = counts
        return self._counts.get(place)

    @cached_property
    def _cramer(self) -> CramerEquations | None:
        """The equations of the function; ``None`` of members that taper."""
        from symflex.roots.networks.cramer import CramerEquations  # few models have such points

        bound, source = self.bound, self.bound.source
        if is_tapered(source.model):
            return None
        model = with_numbers(source.model, (), dict(bound.values), in_kernels=True)
        equations = assemble_sparse(model, are_for_values=True)
        return CramerEquations.of(equations, source.output.name, source.input.name)


def _about(point: Root, times: int) -> Root:
    """Return roots of the equations that are proved to lie about a point; conjugates of one are equal."""
    with precision(point.working_bits()):
        reach = arb(0, (point.size() * arb(2) ** -NARROW).upper())
        is_real = point.is_real and times == 1
        re, im = point.re + reach, point.im if is_real else point.im + reach
    return Root(re, im, times, on_imaginary_axis=False, is_real=is_real, certified=times == 1)


def roots_about(cramer: CramerEquations, s: acb) -> tuple[int | None, int | None]:
    """Return how many roots both sides have next to a point: proved; None for one not counted."""
    found: tuple[int | None, int | None] = (None, None)
    for bits in BITS:
        with precision(bits), suppress(UndecidedError):
            reach = (abs(s.mid()) * arb(2) ** -NARROW).mid()
            wide = arb(0, (reach * arb(2) ** WIDER).upper())
            bounds = cramer.bounds_on(acb(s.real.mid() + wide, s.imag.mid() + wide))
            first = cramer.at((s.mid() + reach).mid(), bits)
            sizes = [
                (b, v.abs_upper()) for b, v in zip(bounds, (first.den, first.num), strict=True) if v != 0
            ]
            beyond = max((b - float(size.log().mid()) for b, size in sizes), default=0.0)
            # Next to a pole of what a member is made of there is no bound.
            count = SPARE + ceil(beyond / (WIDER * log(2))) if isfinite(beyond) else MOST_POINTS + 1
            if count > MOST_POINTS:
                break
            turns = (acb(0, 2 * arb.pi() * k / count).exp() for k in range(1, count))
            values = [first, *(cramer.at((s.mid() + reach * turn).mid(), bits) for turn in turns)]
            sides = [v.den for v in values], [v.num for v in values]
            found = _largest(sides[0], bounds[0]), _largest(sides[1], bounds[1])
        if None not in found:
            break
    return found


def _largest(values: Sequence[acb], log_bound: float) -> int | None:
    """Return which Taylor coefficient exceeds all others together; ``None`` where none is proved to."""
    n = len(values)
    others = arb(log_bound).exp() * arb(2) ** (1 - WIDER * n)
    aliased = acb(arb(0, others.upper()), arb(0, others.upper()))
    sizes = [abs(c / n + aliased) for c in acb.dft(list(values))]
    return next((k for k in range(n) if sizes[k] > sum((*sizes[:k], *sizes[k + 1 :]), others)), None)
