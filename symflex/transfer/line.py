"""Proving numerator and denominator coprime on a line, before either is expanded.

Every generator x_i of the ring without sums and definitions is set to ``a_i + b_i*t`` with random integers. A
common factor of two polynomials becomes a common factor of their images; it could become a number only if its
highest homogeneous part vanished at b. That is excluded where both images have the degree that their
polynomials have at most, for then no factor of either lost degree. So coprime images of full degree prove the
polynomials coprime. The images of determinants come from the images of their entries: nothing is expanded.
"""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE
from symflex.equations.elimination.minors import DegreeBounds, Minors
from symflex.transfer.coprimality import LINE

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from flint import fmpz_mpoly

    from symflex.algebra import Factored, Ring
    from symflex.equations.elimination import Determinants

Image = tuple["fmpz_mpoly", int]
"""A polynomial in the parameter of the line, and the degree it can have at most."""


class DeterminantsOnLine:
    """The determinants of one system on a line.

    Parameters
    ----------
    determinants : Determinants
        Over the closed ring.
    plain : Ring
        Generators without sums and definitions.
    definitions : mapping of str to Factored
        Each over ``plain``.
    along : str, optional
        The only generator that varies; all do by default.
    """

    def __init__(
        self,
        determinants: Determinants,
        plain: Ring,
        definitions: Mapping[str, Factored],
        along: str | None = None,
    ) -> None:
        self._determinants = determinants
        random = Random(1)
        t = LINE.generator(LAPLACE)
        moving = [along in (None, name) for name in plain.names]
        plain_images = [t * random.randrange(1, 2**10) * m + random.randrange(1, 2**10) for m in moving]
        known: dict[str, Image] = {
            name: (p, int(m)) for name, p, m in zip(plain.names, plain_images, moving, strict=True)
        }
        self._plain_images = [known[name] for name in plain.names]
        known |= {n: i for n, v in definitions.items() if (i := self._definition(v)) is not None}
        closure = determinants.system.closure
        base = [known.get(name) for name in closure.base.names]
        for name, polynomial in closure.sums:
            if (found := _composed(polynomial, base)) is not None:
                known[name] = found
        self._images = [known.get(name) for name in closure.ring.names]
        reduced, rows = determinants.reduced, determinants.minors.rows
        entries = [self._row(row) for row in (*rows, *reduced.outputs)]
        whole = [row or {} for row in entries]
        values = [{c: image for c, (image, _) in row.items()} for row in whole]
        degrees = [{c: degree for c, (_, degree) in row.items()} for row in whole]
        self._values = Minors(tuple(values[: len(rows)]), ring=LINE)
        self._degrees = DegreeBounds(tuple(degrees[: len(rows)]))
        self._outputs = list(zip(values[len(rows) :], degrees[len(rows) :], strict=True))
        self._den = None
        if all(row is not None for row in entries):
            columns = sum(1 << c for c in reduced.columns)
            self._den = _kept(self._values.determinant(columns), self._degrees.determinant(columns))

    def prove_coprime(self, output: str, source: str) -> bool:
        """Tell whether a bordered determinant is proved coprime to the determinant; False decides nothing."""
        num = self._num(output, source)
        return num is not None and self._den is not None and bool(num.gcd(self._den).is_constant())

    def order(self, output: str, source: str) -> tuple[int, int] | None:
        """Return the degrees of both in what varies, None where they are not proved."""
        num = self._num(output, source)
        if num is None or self._den is None:
            return None
        return int(num.total_degree()), int(self._den.total_degree())

    def _num(self, output: str, source: str) -> fmpz_mpoly | None:
        if self._den is None:
            return None
        values, degrees = self._outputs[self._determinants.position(output)]
        columns = self._determinants.border(source)
        return _kept(self._values.bordered(values, columns), self._degrees.bordered(degrees, columns))

    def _definition(self, value: Factored) -> Image | None:
        if value.unit.denominator != 1 or any(e < 0 for _, e in value.factors):
            return None
        image, degree = LINE.constant(int(value.unit)), 0
        for factor, exponent in value.factors:
            found = _composed(factor, self._plain_images)
            if found is None:
                return None
            image, degree = image * found[0] ** exponent, degree + found[1] * exponent
        return image, degree

    def _row(self, row: Mapping[int, fmpz_mpoly]) -> dict[int, Image] | None:
        found = {column: _composed(entry, self._images) for column, entry in row.items()}
        kept = {column: image for column, image in found.items() if image is not None}
        return kept if len(kept) == len(found) else None


def _composed(polynomial: fmpz_mpoly, images: Sequence[Image | None]) -> Image | None:
    """Return the image of a polynomial, None when a generator in it has none."""
    used = [int(d) > 0 for d in polynomial.degrees()]
    if any(u and image is None for u, image in zip(used, images, strict=True)):
        return None
    values = [LINE.constant(0) if image is None else image[0] for image in images]
    degrees = [0 if image is None else image[1] for image in images]
    highest = max(
        (sum(int(e) * d for e, d in zip(m, degrees, strict=True) if e) for m in polynomial.monoms()),
        default=-1,
    )
    return polynomial.compose(*values, ctx=LINE.context), highest


def _kept(image: fmpz_mpoly, most: int) -> fmpz_mpoly | None:
    """Return an image that has full degree."""
    return image if not image.is_zero() and int(image.total_degree()) == most else None
