"""A characteristic function whose parameters lie anywhere in a box: where no root meets the imaginary axis.

Input: a model and the names of parameters. Output: a :class:`CharacteristicFunction`; for a box of these,
pieces of the axis on which it may vanish, and a radius beyond which no root lies right of the axis.

Example: ``m s^2 + b s + k + K k exp(-s T)`` with K in [0, 0.2] and T in [0, 5 ms]. Where it differs from 0 on
the whole axis for all of them, and beyond a radius in the right half plane, no root passes the axis: the
number of roots right of it is the same in the whole box (boundary crossing theorem; Bhattacharyya, Chapellat
and Keel 1995, theorem 1.4). Boxes on which this is not proved are halved; pieces of the axis without a root
for a box have none for its halves.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

from flint import acb, acb_series, arb

from symflex.algebra import LAPLACE
from symflex.balls import Value, at_centre, ball, current_bits, precision
from symflex.budget import spend
from symflex.expressions import names_among
from symflex.roots.distributed.far_out import right_tail
from symflex.transfer import BoundTransferFunction
from symflex.transfer.of_model import derive_nameless

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from flint import fmpz_mpoly

    from symflex.model import ExactValue, Model
    from symflex.transfer import TransferFunction
    from symflex.transfer.enclose_kernels import KernelValues

BITS = 64
"""Precision of values on boxes, which are far wider."""
LOWEST = 1e-6
"""Radius from which one is sought beyond which no root lies right of the axis [rad/s]."""
OCTAVES = 24
"""Pieces of the axis at first, each half as high as the next; the lowest begins at 0."""

NEARLY = 16
"""Times that what a box leaves open exceeds what a piece does, from which on it is not halved."""

Ends = tuple[Fraction, Fraction]
Box = tuple[Ends, ...]
"""The ends of every parameter, in SI units."""
Piece = tuple[Fraction, Fraction]
"""A part of the imaginary axis, from a frequency to another [rad/s]."""


@dataclass(frozen=True, slots=True)
class OpenBox:
    """A box with the pieces of the axis on which a factor may vanish."""

    box: Box
    radius: float | str  # beyond which no root lies right of the axis [rad/s], or why none is known
    pieces: tuple[tuple[Piece, ...], ...] = ()  # factor by factor

    @property
    def is_bounded(self) -> bool:
        """Whether it is known up to where roots are to be sought."""
        return not isinstance(self.radius, str)


@dataclass(frozen=True, eq=False)
class CharacteristicFunction:
    """The factors of the equations' determinant, with some parameters as symbols."""

    tf: TransferFunction  # whose denominator and hidden factors these are
    names: tuple[str, ...]  # of the parameters that lie in boxes
    values: tuple[tuple[str, ExactValue], ...]  # of the others
    # The same with fundamental functions in place of kernels, entire at s = 0 too; None without waves.
    nameless: TransferFunction | None = None

    @classmethod
    def of(cls, model: Model, tf: TransferFunction, names: Sequence[str]) -> CharacteristicFunction:
        """Return that of a model whose other parameters are numbers, from one of its transfer functions."""
        values = tuple((p.name, p.value) for p in model.parameters if p.value and p.name not in names)
        nameless = None
        if any(law.wavenumbers for law in tf.kernels.dispersions):
            (nameless,) = derive_nameless(model, [(tf.output.name, tf.input.name)])
        return cls(tf, tuple(names), values, nameless)

    @cached_property
    def factors(self) -> tuple[fmpz_mpoly, ...]:
        """Those that may vanish elsewhere than at s = 0."""
        return _factors(self.tf)

    @cached_property
    def _entire(self) -> tuple[fmpz_mpoly, ...]:
        return () if self.nameless is None else _factors(self.nameless)

    def depends_on(self, name: str) -> bool:
        """Tell whether a root depends on a parameter."""
        tf = self.tf
        moving = {name, *(c.generator for c in tf.constants if names_among(c.expression, {name}))}
        ring = tf.ratio.ring
        if any(value.depends_on(n) for value in tf.kernels.values for n in moving if n in ring.index):
            return True
        return any(f.degrees()[ring.index[n]] for f in self.factors for n in moving if n in ring.index)

    def whole(self, box: Box) -> OpenBox:
        """Return a box about which nothing is known yet."""
        radius = self._end(box)
        if isinstance(radius, str):
            return OpenBox(box, radius)
        last = Fraction(radius)
        marks = [last * 0, *(last / 2 ** (OCTAVES - k) for k in range(1, OCTAVES + 1))]
        pieces = tuple(pairwise(marks))
        return OpenBox(box, radius, tuple(pieces for _ in self.factors))

    def _end(self, box: Box) -> float | str:
        bound = self._bound(self.tf, box)
        ends = [right_tail(bound, (f,), (acb(1),), LOWEST) for f in self.factors]
        unknown = [end for end in ends if isinstance(end, str)]
        return unknown[0] if unknown else max(map(float, ends), default=0.0)

    def narrowed(self, box: OpenBox, bits: int = BITS) -> OpenBox:
        """Return the box with what is left of the pieces of the axis."""
        with precision(bits):
            kernels = self._bound(self.tf, box.box).kernel_values()
            nameless = self.nameless
            entire = None if nameless is None else self._bound(nameless, box.box).kernel_values()
            left = [self._left(kernels, entire, i, pieces) for i, pieces in enumerate(box.pieces)]
        return replace(box, pieces=tuple(map(tuple, left)))

    def _left(
        self, kernels: KernelValues, entire: KernelValues | None, factor: int, pieces: Sequence[Piece]
    ) -> list[Piece]:
        """Return the pieces, and parts of these, on which a factor may vanish, ascending."""
        left, pending = [], list(pieces[::-1])
        while pending:
            spend()
            low, high = pending.pop()
            middle = (low + high) / 2
            point = ball(middle if low else low)
            # Next to 0 kernels of waves say nothing; all factors are tried there at once.
            at_rest = entire is not None and not low
            values, polynomials = (entire, self._entire) if at_rest and entire else (kernels, self.factors)
            ones = polynomials if at_rest else polynomials[factor : factor + 1]
            omega = ball(low).union(ball(high))
            at = values.at(_near(omega))
            around = [values.polynomial(f, at) for f in ones]
            if not any(at_centre(each).contains(0) for each in around):
                continue
            at = values.at(acb(0, point))
            centre = [at_centre(values.polynomial(f, at)) for f in ones]
            spreads = [_slope(each) * acb(0, omega - point) for each in around]
            if not any((c + spread).contains(0) for c, spread in zip(centre, spreads, strict=True)):
                continue
            # Where the box alone leaves it open, or nearly so, shorter pieces do not help.
            is_open = any(c.contains(0) for c in centre)
            is_spent = all(NEARLY * y.abs_upper() < c.rad() for c, y in zip(centre, spreads, strict=True))
            if is_open or is_spent or (high - low) * 2 ** current_bits() < high:
                left.append((low, high))
            else:
                pending += [(middle, high), (low, middle)]
        return left

    def _bound(self, tf: TransferFunction, box: Box) -> BoundTransferFunction:
        fixed = tuple((name, _enclosed(ends)) for name, ends in zip(self.names, box, strict=True))
        return BoundTransferFunction(tf, self.values, tf.ratio, tf.hidden, tf.kernels, fixed=fixed)


def _near(omega: arb) -> acb_series:
    return acb_series([acb(0, omega), 1], 2)


def _slope(value: Value) -> acb:
    return value[1] if isinstance(value, acb_series) else acb(0)


def _factors(tf: TransferFunction) -> tuple[fmpz_mpoly, ...]:
    ring = tf.ratio.ring
    alone = {
        ring.index[LAPLACE],
        *(ring.index[k.generator] for k in tf.kernels.kernels if k.function == "exp"),
    }
    every = [*(f for f, e in tf.den.factors if e > 0), *(h.polynomial for h in tf.hidden)]
    return tuple(f for f in every if len(f) > 1 or not any(f.degrees()[i] for i in alone))


def _enclosed(ends: Ends) -> Callable[[], arb]:
    """Return a ball about the values between two ends, none of which is negative unless an end is."""
    low, high = ends

    def ball_of() -> arb:
        if low != 0:
            return ball(low).union(ball(high))
        # Radii are rounded up; a middle that is rounded alike keeps the lower end at 0.
        half = float(high / 2) * (1 + 2.0**-40)
        return arb(float(arb(0, half).rad()), half)

    return ball_of
