"""Lowest terms: exact cancellation of common factors, and proofs on a line that there are none.

    (k*s + k*c) / (s^2 + c*s)   ->   k/s, and the common factor s + c

Every generator x_i of the ring without sums and definitions is set to ``a_i + b_i*t`` with random integers. A
common factor of two polynomials becomes a common factor of their images; it could become a number only if its
highest homogeneous part vanished at b. That is excluded where both images have the degree that their
polynomials have at most, for then no factor of either lost degree. So coprime images of full degree prove the
polynomials coprime. The images of determinants come from the images of their entries: nothing is expanded.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from random import Random

from flint import fmpz_mpoly, nmod_poly

from symflex.algebra import (
    LAPLACE,
    Factored,
    PolynomialMemo,
    Radicals,
    Ring,
    degree_in,
    in_lowest_terms,
)
from symflex.algebra.radicals import Point
from symflex.equations.elimination import Determinants
from symflex.equations.elimination.determinants import DegreeBounds, Minors


def cancel(
    numerator: Factored,
    denominator: Factored,
    images: LineImages | None = None,
    radicals: Radicals | None = None,
) -> tuple[Factored, Factored]:
    """Return a quotient in lowest terms, and the common factor; calls may share ``images`` on a line."""
    if radicals:
        quotient, shared = cancel(numerator, denominator, images)
        reduced, more = radicals.in_lowest_terms(quotient)
        if more.is_one:
            return reduced, shared
        return cancel(reduced.numerator(), reduced.denominator(), images)[0], shared * more
    return in_lowest_terms(numerator, denominator, (images or LineImages(numerator.ring)).prove_coprime)


LARGE = 40  # number of terms of the larger polynomial from which the proof is tried first
LINE = Ring((LAPLACE,))


@dataclass
class LineImages:
    """The images of polynomials with every generator but s set to an integer, each made once."""

    ring: Ring  # where the polynomials live; s is its first generator

    def prove_coprime(self, f: fmpz_mpoly, g: fmpz_mpoly) -> bool:
        """Tell whether two factors are proved coprime; False decides nothing.

        A generator and a polynomial without monomial factor are coprime. Otherwise: a common factor that
        contains s would survive setting all other generators to integers, as long as neither degree in s
        drops; a common factor without s divides every coefficient of both, also their leading ones. Neither
        exists when the images are coprime and so are the leading coefficients.
        """
        if len(f) == 1 or len(g) == 1:
            return f != g
        if max(len(f), len(g)) < LARGE or not degree_in(f, 0) or not degree_in(g, 0):
            return False
        leading_f, image_f = self._image(f)
        leading_g, image_g = self._image(g)
        if image_f is None or image_g is None or not leading_f.gcd(leading_g).is_constant():
            return False
        return bool(image_f.gcd(image_g).is_constant())

    @cached_property
    def _point(self) -> tuple[fmpz_mpoly, ...]:
        random = Random(1)
        numbers = [LINE.constant(random.randrange(2**20, 2**21)) for _ in self.ring.names[1:]]
        return (LINE.generator(LAPLACE), *numbers)

    @cached_property
    def _image(self) -> PolynomialMemo[tuple[fmpz_mpoly, fmpz_mpoly | None]]:
        return PolynomialMemo(self._made)

    def _made(self, f: fmpz_mpoly) -> tuple[fmpz_mpoly, fmpz_mpoly | None]:
        """Return the leading coefficient in s, and the image unless its degree drops."""
        image = f.compose(*self._point, ctx=LINE.context)
        kept = degree_in(image, 0) == degree_in(f, 0)
        return _leading_coefficient(self.ring, f), image if kept else None


def _leading_coefficient(ring: Ring, f: fmpz_mpoly) -> fmpz_mpoly:
    """Return the coefficient of the highest power of s, a polynomial in the other generators."""
    highest = degree_in(f, 0)
    terms = {}
    # Terms stand in lexicographic order, s first: the wanted ones lead.
    for i in range(len(f)):
        monomial = f.monomial(i)
        if monomial[0] != highest:
            break
        terms[(0, *monomial[1:])] = f.coefficient(i)
    return ring.context.from_dict(terms)


Image = tuple["fmpz_mpoly", int]  # a polynomial in the line's parameter, and its highest possible degree


class DeterminantsOnLine:
    """One system's determinants where ``along`` alone varies, or all; the rest is random, or ``point``."""

    def __init__(
        self,
        determinants: Determinants,
        plain: Ring,
        definitions: Mapping[str, Factored],
        along: str | None = None,
        point: Point | None = None,
    ) -> None:
        self._determinants = determinants
        self._prime = 0 if point is None else point[0]
        random = Random(1)
        t = LINE.generator(LAPLACE)
        moving = [along in (None, name) for name in plain.names]
        plain_images = [t * random.randrange(1, 2**10) * m + random.randrange(1, 2**10) for m in moving]
        if point is not None:
            held = zip(plain.names, plain_images, moving, strict=True)
            plain_images = [p if m else LINE.constant(point[1][name]) for name, p, m in held]
        known: dict[str, Image] = {
            name: (p, int(m)) for name, p, m in zip(plain.names, plain_images, moving, strict=True)
        }
        self._plain_images = [known[name] for name in plain.names]
        known |= {n: i for n, v in definitions.items() if (i := self._definition(v)) is not None}
        closure = determinants.system.closure
        base = [known.get(name) for name in closure.base.names]
        for name, polynomial in closure.sums:
            if (composed := _composed(polynomial, base)) is not None:
                known[name] = composed
        self._images = [known.get(name) for name in closure.ring.names]
        reduced, rows = determinants.reduced, determinants.minors.rows
        entries = [self._row(row) for row in (*rows, *reduced.outputs)]
        sparse_rows = [row or {} for row in entries]
        values = [{c: image for c, (image, _) in row.items()} for row in sparse_rows]
        degrees = [{c: degree for c, (_, degree) in row.items()} for row in sparse_rows]
        self._values = Minors(tuple(values[: len(rows)]), ring=LINE)
        self._degrees = DegreeBounds(tuple(degrees[: len(rows)]))
        self._outputs = list(zip(values[len(rows) :], degrees[len(rows) :], strict=True))
        self._den = None
        if all(row is not None for row in entries):
            columns = sum(1 << c for c in reduced.columns)
            self._den = self._kept(self._values.determinant(columns), self._degrees.determinant(columns))

    def prove_coprime(self, output: str, source: str) -> bool:
        """Tell whether a bordered determinant is proved coprime to the determinant; False decides nothing."""
        num = self._num(output, source)
        if num is None or self._den is None:
            return False
        if self._prime:
            ours, theirs = (self._modulo(p) for p in (num, self._den))
            return int(ours.gcd(theirs).degree()) == 0
        return bool(num.gcd(self._den).is_constant())

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
        return self._kept(self._values.bordered(values, columns), self._degrees.bordered(degrees, columns))

    def _kept(self, image: fmpz_mpoly, most: int) -> fmpz_mpoly | None:
        """Return an image that has full degree."""
        if self._prime:
            return image if int(self._modulo(image).degree()) == most else None
        return image if not image.is_zero() and int(image.total_degree()) == most else None

    def _modulo(self, image: fmpz_mpoly) -> nmod_poly:
        return nmod_poly([int(c.leading_coefficient()) for c in LINE.coefficients(image)], self._prime)

    def _definition(self, value: Factored) -> Image | None:
        if value.unit.denominator != 1 or any(e < 0 for _, e in value.factors):
            return None
        image, degree = LINE.constant(int(value.unit)), 0
        for factor, exponent in value.factors:
            composed = _composed(factor, self._plain_images)
            if composed is None:
                return None
            image, degree = image * composed[0] ** exponent, degree + composed[1] * exponent
        return image, degree

    def _row(self, row: Mapping[int, fmpz_mpoly]) -> dict[int, Image] | None:
        images = {column: _composed(entry, self._images) for column, entry in row.items()}
        kept = {column: image for column, image in images.items() if image is not None}
        return kept if len(kept) == len(images) else None


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
