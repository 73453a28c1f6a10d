"""Minors of fundamental matrices in doubles: of laws whose coefficients vary along x.

Input: the parts of the coefficients A of ``z' = A z``: functions of x times powers of functions of s, the
bases. Output: minors of Z, where Z is 1 at the start, over a scale that all of one size share.

    a beam    y' = theta, theta' = tau/(E I(x)), tau' = -f, f' = rho A(x) u y, with one base, u = s^2

The length is cut into pieces on which waves grow little. On each, Z is a polynomial in the bases, whose
coefficients are found once for all s by Picard's iteration, where functions of x stand for their values at
Chebyshev points. Minors of two rows are taken from piece to piece as such: differences of products of entries
would lose as many digits as waves grow.

Where a stiffness vanishes at the start, the first piece is that of a *tip*: ``h v' = B v`` with h the way
from there and ``z_i = h^powers_i v_i``. A solution that is finite there has v of 1 in one free state; then

    h v_i' = b_i v_i + g_i, b_i <= 0      v_i(h) = 1 or 0 + integral over t in [0, 1] of g_i(t h) t^(-b_i - 1)

where g_i(0) is zero for b_i = 0, or what made a logarithm.

Generated code gets copies of these functions: they use numpy and each other, and nothing else.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

Values = Any  # a number, an array of numbers, or lists of these


def fundamental_minors(
    along: Callable[[Values], Sequence[Values]],
    start: Values,
    length: Values,
    bases: Sequence[Values],
    places: Sequence[Sequence[int]],
    wanted: Sequence[Values],
    tip: Sequence[Values] = (),
) -> list[Values]:
    """Return minors of Z(start + length) over the scale of their size, then the logarithms of all scales.

    Part k of A is along(x)[k] times powers of the bases: places[k] holds its row, its
    column and these powers. A minor is told by its rows and its columns; scales come in
    order of the number of these. Bases are arrays of one axis; parameters may be arrays of that shape.
    Parts of B follow those of A where there is a tip: of each its row, column, the power of the way and
    powers of the bases; then the powers of all states, their exponents b, and which are free.
    """
    return minors_by_octaves(
        lambda limits, where: polynomials_along(along, start, length, places, limits, where, tip),
        np.broadcast_arrays(*bases),
        1 + max(max(place[:2]) for place in places),
        wanted,
    )


def minors_by_octaves(
    polynomials: Callable[[Values, Values], Values],
    bases: Sequence[Values],
    size: int,
    wanted: Sequence[Values],
) -> list[Values]:
    """Return what fundamental_minors does, of a matrix of a size, given polynomials_along.

    What an element is does not depend on what others there are.
    """
    minors = np.full((len(wanted) + size, len(bases[0])), np.nan, dtype=complex)
    with np.errstate(all="ignore"):
        # Frequencies within a factor of four share their pieces.
        octaves = [np.where(b == 0.0, -250.0, np.ceil(np.log2(np.abs(b)) / 4.0)) for b in bases]
    is_complex = np.any([np.imag(b) != 0.0 for b in bases], axis=0)
    code = np.where(is_complex, 0.5, 0.0)
    for octave in octaves:
        code = 1000.0 * code + octave
    block = 512
    for chosen in np.unique(code[np.isfinite(code)]):
        where = np.flatnonzero(code == chosen)
        limits = np.array([16.0 ** octave[where[0]] for octave in octaves])
        pieces = polynomials(limits, where)
        if pieces is None:
            continue
        for first in range(0, len(where), block):
            part = slice(first, first + block)
            own = [b[where[part]] / limit for b, limit in zip(bases, limits, strict=True)]
            own = own if is_complex[where[0]] else [np.real(b) for b in own]
            minors[:, where[part]] = minors_through(pieces, own, part, wanted)
    return list(minors)


def polynomials_along(
    along: Callable[[Values], Sequence[Values]],
    start: Values,
    length: Values,
    places: Sequence[Sequence[int]],
    limits: Values,
    where: Values,
    tip: Sequence[Values] = (),
) -> Values:
    """Return powers of the bases over their limits, and what Z has of each on every piece.

    The result is None if waves are too many to be followed.
    """
    cut = edges_along(along, start, length, places, limits, where, tip)
    if cut is None:
        return None
    edges, growth, values, at_tip = cut
    n = 1 + max(max(place[:2]) for place in places)
    points, _, integral = chebyshev_points(20)
    widths = np.diff(edges)[1 if tip else 0 :]
    # Rows of Z by the powers of the bases they are times; each step of the iteration is one more factor A.
    shape = len(widths), len(points), n, max(c.shape[-1] for c in values)
    start_row = np.zeros(shape)
    rows: Any = {(i, (0,) * len(limits)): start_row + np.eye(n)[i][:, None] for i in range(n)}
    total = {key: row[:, -1] for key, row in rows.items()}
    size, steps, last = 1.0, 0, 1e-18
    while size > last or steps < 2 * n:
        steps += 1
        size *= growth / steps
        following: Any = {}
        for place, c in zip(places, values, strict=True):
            for (i, before), row in rows.items():
                if i == place[1]:
                    key = place[0], tuple(p + q for p, q in zip(before, place[2:], strict=True))
                    following[key] = following.get(key, 0.0) + c[:, :, None] * row
        rows = {}
        for key, slope in following.items():
            grown = integral @ slope.reshape(*shape[:2], n * shape[3])
            rows[key] = grown.reshape(shape) * widths[:, None, None, None]
            total[key] = total.get(key, 0.0) + rows[key][:, -1]
    begun = begun_along(at_tip, length * edges[1], tip, n, len(limits), where) if tip else {}
    powers = sorted({powers for _, powers in [*total, *begun]})
    elements = max([shape[-1], *(row.shape[-1] for row in begun.values())])
    coefficients = np.zeros((len(edges) - 1, len(powers), n, n, elements))
    for (i, own), row in total.items():
        coefficients[len(edges) - 1 - len(widths) :, powers.index(own), i] = row
    for (i, own), row in begun.items():
        coefficients[0, powers.index(own), i] = row
    return powers, coefficients


def begun_along(
    values: Sequence[Values], way: Values, tip: Sequence[Values], n: int, bases: int, where: Values
) -> Values:
    """Return what states have of each power of the bases at the end of the piece that begins at a tip.

    The values are parts of B at Chebyshev's points, and the way is that to the end.
    """
    places, powers, exponents, free = tip
    points, to_terms, _ = chebyshev_points(20)
    nodes, weights = np.polynomial.legendre.leggauss(48)
    nodes, weights = (1.0 + nodes) / 2.0, weights / 2.0
    angles = np.arccos(2.0 * np.outer(nodes, points) - 1.0)
    # What makes values at shares of the way to each point, less that at the start where it has to vanish.
    inside = np.cos(angles[:, :, None] * np.arange(len(points))) @ to_terms
    start = np.eye(len(points))[0]
    integrals = [
        np.einsum("q,qij->ij", weights * nodes ** (-b - 1.0), inside - (start if b == 0 else 0.0))
        for b in exponents
    ]
    way = np.atleast_1d(way)[where] if np.size(way) > 1 else np.reshape(way, 1)
    shape = len(points), n, max([len(way), *(c.shape[-1] for c in values)])
    factors = [c[0] * (points[:, None] * way) ** place[2] for place, c in zip(places, values, strict=True)]
    rows: Any = {(i, (0,) * bases): np.zeros(shape) + np.eye(n)[i][:, None] for i in free}
    total = {key: row[-1] for key, row in rows.items()}
    largest, quiet = np.zeros((n, *shape[1:])), 0
    for _ in range(200):
        if quiet == n:
            break
        following: Any = {}
        for place, c in zip(places, factors, strict=True):
            for (i, before), row in rows.items():
                if i == place[1]:
                    key = place[0], tuple(p + q for p, q in zip(before, place[3:], strict=True))
                    following[key] = following.get(key, 0.0) + c[:, None] * row
        rows, sizes = {}, np.zeros(largest.shape)
        for key, slope in following.items():
            grown = integrals[key[0]] @ slope.reshape(len(points), -1)
            rows[key] = grown.reshape(shape)
            total[key] = total.get(key, 0.0) + rows[key][-1]
            sizes[key[0]] = np.maximum(sizes[key[0]], np.max(np.abs(rows[key]), axis=0))
        largest = np.maximum(largest, sizes)
        quiet = quiet + 1 if np.all(sizes <= 1e-18 * largest) else 0
    return {(i, own): row * way ** powers[i] for (i, own), row in total.items()}


def edges_along(
    along: Callable[[Values], Sequence[Values]],
    start: Values,
    length: Values,
    places: Sequence[Sequence[int]],
    limits: Values,
    where: Values,
    tip: Sequence[Values] = (),
) -> Values:
    """Return shares of the length at which it is cut, and by which power of e waves grow between two.

    After these come the parts of A at Chebyshev's points of every piece, and those of B on a tip's.
    The result is None if waves are too many to be followed.
    """
    n = 1 + max(max(place[:2]) for place in places)
    scales = [np.prod(limits ** np.array(place[2:])) for place in places]

    def slopes(x: Values) -> list[Values]:
        return [c * length for c in along(x)[: len(places)]]

    def beginning(x: Values) -> Sequence[Values]:
        return along(x)[len(places) :]

    at_tip = [np.prod(limits ** np.array(place[3:])) for place in tip[0]] if tip else []
    first = 1 if tip else 0

    def cut_at(edges: Values) -> tuple[list[Values], list[Values]]:
        widths = np.diff(edges)[:, None]
        shares = edges[:-1, None] + widths * points
        with np.errstate(all="ignore"):
            return (
                parts_at(slopes, start, length, scales, where, shares[first:]),
                parts_at(beginning, start, length, at_tip, where, shares[:first]),
            )

    # Of a matrix without negative entries the largest eigenvalue is the norm, if states are scaled well.
    count, most, rounding = 64, 4000, 1e-13
    # Where a stiffness vanishes waves grow ever faster, in measure of the length, but not of its root.
    degree = 4 if tip else 1
    roots = (np.arange(count) + 0.5) / count
    sizes = np.zeros((count, n, n))
    for place, c in zip(places, parts_at(slopes, start, length, scales, where, roots**degree), strict=True):
        sizes[:, place[0], place[1]] += np.max(np.abs(c), axis=1)
    if not np.all(np.isfinite(sizes)):
        return None
    growth = np.max(np.abs(np.linalg.eigvals(sizes)), axis=1) * degree * roots ** (degree - 1)
    growth = np.cumsum(growth / count)
    # Where waves grow by e^3, sums of terms of both signs lose a digit.
    number = int(growth[-1] / 3.0) + 1
    if number > most:
        return None
    shares = np.concatenate([[0.0], growth + 1e-9 * np.arange(1, count + 1)])
    edges = np.interp(shares[-1] * np.arange(number + 1) / number, shares, np.arange(count + 1) / count)
    edges = edges**degree
    points, to_terms, _ = chebyshev_points(20)
    values = cut_at(edges)
    # Pieces are halved until functions of x are polynomials there to the last digits.
    for _ in range(12):
        rough = np.zeros(len(edges) - 1, dtype=bool)
        for own, parts in zip((slice(first, None), slice(first)), values, strict=True):
            for c in parts:
                spectrum = np.abs(to_terms @ c)
                rough[own] |= np.any(
                    np.max(spectrum[:, -3:], axis=1) > rounding * np.max(spectrum, axis=1), axis=1
                )
        if not np.any(rough):
            break
        edges = np.sort(np.concatenate([edges, (edges[:-1] + np.diff(edges) / 2.0)[rough]]))
        values = cut_at(edges)
    return edges, growth[-1] / number, *values


def parts_at(
    along: Callable[[Values], Sequence[Values]],
    start: Values,
    length: Values,
    scales: Sequence[float],
    where: Values,
    shares: Values,
) -> list[Values]:
    """Return parts for bases at their limits, at shares of the length; elements come last."""
    x = start + length * shares.reshape(-1, 1)
    parts = [np.broadcast_to(c, np.broadcast(c, x).shape) for c in along(x)]
    parts = [c[:, where] if c.shape[1] > 1 else c for c in parts]
    return [scale * c.reshape(*shares.shape, c.shape[1]) for scale, c in zip(scales, parts, strict=True)]


def minors_through(pieces: Values, bases: Sequence[Values], part: slice, wanted: Sequence[Values]) -> Values:
    """Return minors of the product of all pieces over their scales, and the logarithms of these.

    The bases are those of one part of the elements, over their limits.
    """
    powers, coefficients = pieces
    n, count = coefficients.shape[2], len(bases[0])
    monomials = np.array([np.prod([b**e for b, e in zip(bases, p, strict=True)], axis=0) for p in powers])
    minors: Any = np.zeros((len(wanted) + n, count), dtype=complex)
    for order in sorted({len(rows) for rows, _ in wanted}):
        lines = lines_of(n, order)
        own = [k for k, (rows, _) in enumerate(wanted) if len(rows) == order]
        starts = sorted({tuple(wanted[k][1]) for k in own})
        # What minors of all rows there are, for every choice of columns that is wanted.
        state = np.zeros((len(starts), len(lines), count), dtype=monomials.dtype)
        for k, columns in enumerate(starts):
            state[k, lines.index(columns)] = 1.0
        scale = np.zeros(count)
        for piece in coefficients:
            if piece.shape[-1] == 1:
                z = (piece.reshape(len(powers), -1).T @ monomials).reshape(n, n, count)
            else:
                z = np.sum(piece[..., part] * monomials[:, None, None], axis=0)
            state = np.einsum("ijs,kjs->kis", compound(z, order), state)
            largest = np.max(np.abs(state), axis=(0, 1))
            state = state / largest
            scale = scale + np.log(largest)
        minors[len(wanted) + order - 1] = scale
        for k in own:
            rows, columns = wanted[k]
            minors[k] = state[starts.index(tuple(columns)), lines.index(tuple(rows))]
    return minors


def lines_of(n: int, order: int) -> list[tuple[int, ...]]:
    """Return all choices of so many of n lines."""
    lines: list[tuple[int, ...]] = [(i,) for i in range(n)]
    for _ in range(order - 1):
        lines = [(*chosen, i) for chosen in lines for i in range(chosen[-1] + 1, n)]
    return lines


def compound(z: Values, order: int) -> Values:
    """Return all minors of one size of a matrix, expanded along their first rows."""
    if order == 1:
        return z
    n = len(z)
    lines, inner = lines_of(n, order), lines_of(n, order - 1)
    smaller = compound(z, order - 1)[[inner.index(rows[1:]) for rows in lines]]
    first = z[[rows[0] for rows in lines]]
    total = 0.0
    for k in range(order):
        left = [inner.index(columns[:k] + columns[k + 1 :]) for columns in lines]
        total = total + (-1) ** k * first[:, [columns[k] for columns in lines]] * smaller[:, left]
    return total


def chebyshev_points(order: int) -> Values:
    """Return points from 0 to 1, what makes Chebyshev's terms of values there, and their integrals from 0."""
    angles = np.pi * np.arange(order, -1, -1) / order
    terms = np.cos(np.outer(angles, np.arange(order + 2)))
    to_terms = np.linalg.inv(terms[:, :-1])
    m = np.arange(2, order + 1)
    primitives = np.empty((order + 1, order + 1))
    primitives[:, 0], primitives[:, 1] = terms[:, 1], terms[:, 2] / 4.0
    primitives[:, 2:] = terms[:, 3:] / (2.0 * (m + 1)) - terms[:, 1:-2] / (2.0 * (m - 1))
    integral = (primitives - primitives[:1]) @ to_terms / 2.0
    return (1.0 + np.cos(angles)) / 2.0, to_terms, integral
