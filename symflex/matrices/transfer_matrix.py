"""The transfer matrix of a model: the numerators of all pairs over one common denominator.

Input: a model, and the names of outputs and inputs, all by default.
Output: a :class:`TransferMatrix` ``y = N(s)/d(s) u``, and the same with numbers.

One elimination serves all pairs, each of which is reduced once. Their least common denominator is d(s): none
of its factors divides all of N(s), so that nothing cancels from the matrix as a whole. A pair is the matrix
of one row and one column. Where the expanded form is too large all pairs are nested, and there is no d(s).

Example: two masses on springs, each pushed by a force and read at its node.

    before    X_1/F_1 = (m_2 s^2 + k_2)/d      X_1/F_2 = k_2/d
              X_2/F_1 = k_2/d                  X_2/F_2 = (m_1 s^2 + k_1 + k_2)/d
    after     N = [m_2 s^2 + k_2, k_2; k_2, m_1 s^2 + k_1 + k_2]
              d = (m_1 s^2 + k_1 + k_2)(m_2 s^2 + k_2) - k_2^2
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import lcm
from typing import TYPE_CHECKING, Generic, TypeVar

from symflex.algebra import NO_KERNELS, Factored, KernelTable, Ring
from symflex.algebra.dispersion import Dispersion, Kernel
from symflex.errors import BudgetError, Diagnostic, no_such, refused
from symflex.model import Input, Model, Output
from symflex.model.loss_factors import check_causal
from symflex.transfer import (
    AnyBoundFunction,
    AnyTransferFunction,
    BoundTransferFunction,
    TransferFunction,
    bind_any,
    points_of,
)
from symflex.transfer.bind import Given
from symflex.transfer.bound import radicals_at
from symflex.transfer.lowest_terms import LineImages, cancel
from symflex.transfer.of_model import derive_alike, derive_as

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from symflex.algebra import Radicals

Pair = TypeVar("Pair", bound=AnyTransferFunction | AnyBoundFunction)
Value = TypeVar("Value")


@dataclass(frozen=True)
class OverDenominator:
    """The functions of a matrix, polynomials or entire functions of s, over one denominator."""

    numerators: tuple[tuple[Factored, ...], ...]  # N(s), a row per output
    den: Factored  # d(s), the least common multiple of the denominators of all
    kernels: KernelTable  # of the ring of both


@dataclass(frozen=True)
class _PairTable(Generic[Pair]):
    """Pairs of outputs and inputs, a row per output."""

    pairs: tuple[tuple[Pair, ...], ...]

    @property
    def each(self) -> tuple[Pair, ...]:
        """All pairs, those of the first output first."""
        return tuple(pair for row in self.pairs for pair in row)

    @property
    def shape(self) -> tuple[int, int]:
        """How many outputs and how many inputs there are."""
        return len(self.pairs), len(self.pairs[0])

    @property
    def is_reduced(self) -> bool:
        """True when all pairs are in lowest terms; else they are nested, and there is no d(s)."""
        return all(pair.is_reduced for pair in self.each)

    @property
    def is_rational(self) -> bool:
        """True when all pairs are quotients of polynomials in s, or in a root of s."""
        return all(pair.is_rational for pair in self.each)

    def rows(self, values: Sequence[Value]) -> tuple[tuple[Value, ...], ...]:
        """Return values of all pairs, in order, as rows."""
        width = self.shape[1]
        return tuple(tuple(values[i : i + width]) for i in range(0, len(values), width))

    def nested_error(self) -> BudgetError:
        """Return the error that nested pairs have no common denominator."""
        hint = "values and exports need none"
        return BudgetError(Diagnostic("SF502", "a nested matrix has no common denominator", None, hint))


@dataclass(frozen=True)
class TransferMatrix(_PairTable[AnyTransferFunction]):
    """``y = N(s)/d(s) u``, exact: quantity and unit of an entry are those of its pair."""

    reason: str = ""  # why pairs are nested, where nobody asked for that

    @property
    def model(self) -> Model:
        """Where it comes from."""
        return self.pairs[0][0].model

    @property
    def outputs(self) -> tuple[Output, ...]:
        """What is measured, a row each."""
        return tuple(row[0].output for row in self.pairs)

    @property
    def inputs(self) -> tuple[Input, ...]:
        """What drives, a column each."""
        return tuple(pair.input for pair in self.pairs[0])

    @cached_property
    def over(self) -> OverDenominator:
        """N(s) and d(s); SF501 where sums would have to be opened, SF502 where pairs are nested."""
        each = [tf for tf in self.each if isinstance(tf, TransferFunction)]
        if len(each) < len(self.each):
            raise self.nested_error()
        kernels = one_table([tf.kernels for tf in each])
        if kernels is None or len({tf.ring.names for tf in each if tf.kernels}) > 1:
            each = [tf for tf in self.alike.each if isinstance(tf, TransferFunction)]
            kernels = one_table([tf.kernels for tf in each]) or NO_KERNELS
        if kernels:
            ring = max((tf.ring for tf in each), key=lambda ring: len(ring.names))
            quotients = [(tf.num.over(ring), tf.den.over(ring)) for tf in each]
            numerators, den = over_common_denominator(quotients)
        else:
            numerators, den = over_common_denominator([(tf.num, tf.den) for tf in each], each[0].radicals)
        return OverDenominator(self.rows(numerators), den, kernels)

    @cached_property
    def alike(self) -> TransferMatrix:
        """The same matrix in kernels that all entries share."""
        named = [(tf.output.name, tf.input.name) for tf in self.each]
        return TransferMatrix(self.rows(derive_alike(self.model, named)), self.reason)

    def bind(self, values: Mapping[str, Given] | None = None) -> BoundMatrix:
        """Return the matrix with the declared values, or the given ones, as single functions do."""
        return BoundMatrix(tuple(tuple(bind_any(tf, values) for tf in row) for row in self.pairs), self)


@dataclass(frozen=True)
class BoundMatrix(_PairTable[AnyBoundFunction]):
    """A transfer matrix with numbers."""

    source: TransferMatrix

    @cached_property
    def over(self) -> OverDenominator:
        """N(s) and d(s) with these numbers, over s, pi, functions of constants, and kernels; else SF502."""
        each = tuple(bound for bound in self.each if isinstance(bound, BoundTransferFunction))
        if len(each) < len(self.each):
            raise self.nested_error()
        kernels = one_table([bound.kernels for bound in each])
        if kernels is None:
            values = {name: value for bound in each for name, value in bound.values}
            return self.source.alike.bind(values).over
        ring = joined_ring([bound.ratio.ring for bound in each], kernels)
        radicals = None if kernels else radicals_at(each[0].source, ring, dict(each[0].all_values))
        quotients = [(bound.num.over(ring), bound.den.over(ring)) for bound in each]
        numerators, den = over_common_denominator(quotients, radicals)
        return OverDenominator(self.rows(numerators), den, kernels)

    def at(self, s: npt.ArrayLike) -> npt.NDArray[np.complex128]:
        """Return the values at complex frequencies [rad/s], of the matrix's shape followed by that of s.

        Each is right to the last bits of its absolute value, ``inf + nan*1j`` at a pole.
        """
        import numpy as np  # binding needs none of it

        points = points_of(s)
        if not ((points.real == 0) & (points.imag > 0)).all():
            check_causal(self.source.model, "a value at another s")
        values = [pair.each(points.ravel().tolist()) for pair in self.each]
        return np.array(values, dtype=complex).reshape(*self.shape, *points.shape)

    def relative_gains(self, s: npt.ArrayLike) -> npt.NDArray[np.complex128]:
        """Return the product, entry by entry, of values and the transposed inverse (Bristol 1966).

        Not a number where the matrix has a pole or is singular. Raises SF902 where it is not square.
        """
        return relative_gains(self.at(s))

    def characteristic_loci(self, s: npt.ArrayLike) -> npt.NDArray[np.complex128]:
        """Return the eigenvalues of a square matrix at points in a row, each followed to its nearest one.

        They are of shape (n, points), not numbers at poles. det(I + L) is the product of one plus each.
        """
        import numpy as np

        return followed(np.moveaxis(self.at(points_of(s).ravel()), -1, 0))


def relative_gains(values: npt.NDArray[np.complex128]) -> npt.NDArray[np.complex128]:
    """Return the relative gains of values whose first two axes are rows and columns."""
    import numpy as np

    rows, columns = values.shape[:2]
    if rows != columns:
        raise refused(f"relative gains are of square matrices; this one is {rows} x {columns}")
    stacked = np.moveaxis(values, (0, 1), (-2, -1))
    found = np.full(stacked.shape, np.nan, dtype=complex)
    for place in np.ndindex(stacked.shape[:-2]):
        if np.isfinite(stacked[place]).all() and np.linalg.matrix_rank(stacked[place]) == rows:
            found[place] = stacked[place] * np.linalg.inv(stacked[place]).T
    return np.moveaxis(found, (-2, -1), (0, 1))


def followed(values: npt.NDArray[np.complex128]) -> npt.NDArray[np.complex128]:
    """Return the eigenvalues of square matrices in a row (points, n, n), each followed: (n, points)."""
    import numpy as np

    points, rows, columns = values.shape
    if rows != columns:
        raise refused(f"characteristic loci are of square matrices; this one is {rows} x {columns}")
    is_known = np.isfinite(values).all(axis=(1, 2))
    known = np.linalg.eigvals(values[is_known]).astype(complex)
    for before, here in pairwise(known):
        left = list(here)
        here[:] = [left.pop(int(np.argmin(np.abs(np.array(left) - x)))) for x in before]
    loci = np.full((points, rows), np.nan, dtype=complex)
    loci[is_known] = known
    return loci.T


def derive_matrix(
    model: Model,
    outputs: Sequence[str] = (),
    inputs: Sequence[str] = (),
    representation: str = "auto",
    *,
    is_read: bool = False,
    solves: bool = False,
) -> TransferMatrix:
    """Return the matrix of the outputs and inputs named, all by default; SF902 for an unknown name.

    Its pairs are in the representation that :func:`symflex.transfer.of_model.derive_as` picks.
    """
    rows = picked("output", outputs, [o.name for o in model.answers])
    columns = picked("input", inputs, [i.name for i in model.causes])
    pairs = [(output, source) for output in rows for source in columns]
    tfs, reason = derive_as(model, pairs, representation, solves=solves, is_read=is_read)
    width = len(columns)
    return TransferMatrix(tuple(tfs[i : i + width] for i in range(0, len(tfs), width)), reason)


def picked(what: str, names: Sequence[str], known: Sequence[str]) -> tuple[str, ...]:
    """Return the names asked for, or all that are known; SF902 for one that is not, or named twice."""
    for place, name in enumerate(names):
        if name not in known:
            raise no_such(what, name, known)
        if name in names[:place]:
            raise refused(f"{what} '{name}' is named twice", "a matrix has each row and column once")
    return tuple(names) or tuple(known)


def over_common_denominator(
    quotients: Sequence[tuple[Factored, Factored]], radicals: Radicals | None = None
) -> tuple[tuple[Factored, ...], Factored]:
    """Return the numerators of quotients in lowest terms over their least common denominator, and that.

    Powers of waves may be negative in either; all else in a denominator is a polynomial.

    >>> s = Factored.generator(Ring(("s",)), "s")
    >>> one = Factored.number(s.ring, 1)
    >>> above, below = over_common_denominator([(one, (s + 1) * (s + 2)), (s, (s + 1) * 2)])
    >>> [str(n) for n in above], str(below)
    (['2', 's*(s + 2)'], '2*(s + 1)*(s + 2)')
    """
    ring = quotients[0][0].ring
    images = LineImages(ring)
    number = lcm(*(den.unit.numerator for _, den in quotients))
    number = number if quotients[0][1].unit > 0 else -number
    den = quotients[0][1] / quotients[0][1].unit
    for _, other in quotients[1:]:
        missing = other / other.unit / den
        den = den * cancel(missing.numerator(), missing.denominator(), images, radicals)[0].numerator()
    den = den * number
    return tuple(_cleared(num * (den / other), images, radicals) for num, other in quotients), den


def _cleared(value: Factored, images: LineImages, radicals: Radicals | None) -> Factored:
    """Return a numerator without what divides it: parts of denominators that were not factored alike."""
    if all(e > 0 for _, e in value.factors):
        return value
    return cancel(value.numerator(), value.denominator(), images, radicals)[0]


def joined_ring(rings: Sequence[Ring], kernels: KernelTable) -> Ring:
    """Return the ring of all names of several, those of kernels last."""
    waves = set(kernels.generators)
    names = dict.fromkeys(name for ring in rings for name in ring.names if name not in waves)
    return Ring((*names, *kernels.generators))


def one_table(tables: Sequence[KernelTable]) -> KernelTable | None:
    """Return one table of the laws and kernels of several; None where a name means two lengths."""
    laws: dict[tuple[str, ...], tuple[Dispersion, tuple[Kernel, ...]]] = {}
    for table in tables:
        for law in table.dispersions:
            own = table.kernels_of(law)
            names = (*law.wavenumbers, *(k.generator for k in own))
            _, known = laws.setdefault(names, (law, own))
            if any(str(a.length) != str(b.length) for a, b in zip(known, own, strict=True)):
                return None
    kernels = tuple(kernel for _, own in laws.values() for kernel in own)
    return KernelTable(tuple(law for law, _ in laws.values()), kernels)
