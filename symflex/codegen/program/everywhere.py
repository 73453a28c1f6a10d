"""Programs for languages of arrays in which every piece is evaluated for every element.

Which piece serves is then chosen element by element, without branches on values. So that no piece spoils a
value, or a derivative, of an element it does not serve, it is evaluated there at a place where it is regular.

Input: a program.
Output: its pieces, the results of tests under which each serves, and each one's place.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from symflex.codegen.program.evaluate import numbers_of_pieces, value_of_piece
from symflex.codegen.program.nodes import ONE, CodePiece, Piecewise

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

Cases = tuple[tuple[tuple[int, bool], ...], ...]
"""Alternatives; each is a number of tests with the results they must have."""

SIZES = np.logspace(-12, 60, 145)
"""Frequencies [rad/s] among which places are sought."""

DIRECTIONS = np.exp(1j * np.array([0.9, -0.9, 2.2, -2.2]))
"""One in every quadrant, on no axis."""

INWARDS = 1.5
"""Decades between a place and the lower end of the range that a piece serves, or its only end."""

BESIDE = np.array([1.0, 0.999, 1.001])


def in_pieces(program: Piecewise) -> Piecewise:
    """Return a program whose pieces are quotients that can be computed without the others.

    The denominator of a lumped one is the number one.
    """
    if not program.is_lumped:
        return program
    needs = (piece.code.needed(piece.code.values) for piece in program.code)
    code = tuple(CodePiece(replace(own, values=(*own.values, ONE))) for own in needs)
    return replace(program, code=code)


def cases_of(program: Piecewise) -> tuple[Cases, ...]:
    """Return for every piece the results of tests under which it serves.

    Examples
    --------
    >>> from symflex.codegen.program.nodes import Condition, Laplace, Straight
    >>> piece = CodePiece(Straight((), (), (ONE, ONE)))
    >>> test = Condition(Laplace(), 1.0, ONE)
    >>> cases_of(Piecewise((), Straight((), (), ()), (test, test), (0, 0, 0, 1), (piece, piece)))
    ((((0, False),), ((0, True), (1, False))), (((0, True), (1, True)),))
    """
    found: list[list[tuple[tuple[int, bool], ...]]] = [[] for _ in program.code]

    def split(table: tuple[int, ...], test: int, results: tuple[tuple[int, bool], ...]) -> None:
        if len(set(table)) == 1:
            found[table[0]].append(results)
            return
        failed, held = table[::2], table[1::2]
        if failed == held:
            split(failed, test + 1, results)
            return
        split(failed, test + 1, (*results, (test, False)))
        split(held, test + 1, (*results, (test, True)))

    split(program.pieces, 0, ())
    return tuple(tuple(cases) for cases in found)


def places_of(program: Piecewise, values: Mapping[str, float]) -> tuple[complex, ...]:
    """Return for every piece an argument at which it is regular, some way from where others take over.

    Parameters without a value count as 1: places need not be exact, since between a piece's overflow and its
    loss of all digits lie many orders of magnitude.
    """
    given = {name: values.get(name, 1.0) for name in program.parameters}
    directions = np.array([1.0]) if program.is_real else DIRECTIONS
    points = SIZES[:, None] * directions
    with np.errstate(all="ignore"):
        numbers = np.broadcast_to(numbers_of_pieces(program, points, given), points.shape)
        served = np.array(program.pieces)[numbers]
        changes = np.flatnonzero((served[1:] != served[:-1]).any(axis=1))
        last = float(np.log10(SIZES[changes[-1]])) if len(changes) else 0.0
        return tuple(_place(piece, points, served == k, last, given) for k, piece in enumerate(program.code))


def _place(
    piece: CodePiece,
    points: NDArray[np.complex128],
    serves: NDArray[np.bool_],
    last: float,
    given: Mapping[str, float],
) -> complex:
    """Return a place, near the logarithm aimed at and in a direction in which the piece serves.

    Series bear arguments that are too large better than exponentials bear small ones, which cancel: a piece
    that serves nowhere for these parameters is put beyond the last change from one piece to another.
    """
    rows = np.flatnonzero(serves.any(axis=1))
    logarithms = np.log10(SIZES)
    aim = last + INWARDS
    if len(rows) and rows[0] > 0:
        aim = logarithms[rows[0]] + INWARDS
    elif len(rows):
        aim = min(logarithms[rows[-1]], last) - INWARDS
    distance = np.abs(logarithms - aim)[:, None] + np.where(serves.any(axis=0), 0.0, 1e3)
    for position in np.argsort(distance, axis=None, kind="stable"):
        point = points.flat[position] * BESIDE
        if np.all(np.isfinite(value_of_piece(piece, 1j * point if piece.is_complex else point, given))):
            return complex(points.flat[position])
    return complex(points.flat[0])
