"""Poles and zeros of a whole transfer matrix, not of its pairs, with multiplicity, proved to be all.

Input: a model, and the names of outputs and inputs.
Output: :class:`MatrixRoots`: poles as of McMillan, transmission zeros, invariant zeros, decoupling zeros, the
normal rank, and the directions of the zeros.

Example: ``G = [1/(s+1), 2/(s+3); 1/(s+1), 1/(s+1)]``. No entry has a zero; the matrix has
one at s = 1, in the right half-plane, where both outputs move alike whatever the inputs are.

The poles and zeros of a lumped matrix are roots of exact irreducible factors of determinants; how often each
divides which follows modulo a prime (:mod:`.exact_roots`), but for odds of about 1 in 2^50. Those of a
distributed matrix are searched as poles of two models of one input and one output (:mod:`.searched_roots`).
"""

from __future__ import annotations

from collections.abc import Sequence

from symflex.errors import refused
from symflex.matrices.exact_roots import ExactMatrix
from symflex.matrices.matrix_roots import MatrixRoots
from symflex.matrices.searched_roots import SearchedMatrix
from symflex.matrices.transfer_matrix import picked
from symflex.model import Model, with_numbers
from symflex.roots import Region


def locate_matrix(
    model: Model,
    outputs: Sequence[str] = (),
    inputs: Sequence[str] = (),
    region: Region | None = None,
    digits: int = 30,
) -> MatrixRoots:
    """Find poles and zeros of the matrix of outputs and inputs, all by default, with the declared values.

    All roots of a lumped matrix are found, of a distributed one those in a region; see :func:`locate`. SF902
    for an unknown name.

    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... inputs  = { u_1 = {}, u_2 = {} }
    ... outputs = { y_1 = "u_1/(s + 1) + 2*u_2/(s + 3)", y_2 = "u_1/(s + 1) + u_2/(s + 1)" }
    ... ''')
    >>> roots = locate_matrix(model)
    >>> [str(zero.re) for zero in roots.located.zeros], roots.normal_rank
    (['1.00000000000000'], 2)
    """
    if model.imposed:
        hint = "ask the matrix itself, whose zeros are the poles of its inverse"
        raise refused("poles and zeros of an inverse are not searched", hint)
    rows = picked("output", outputs, [o.name for o in model.outputs])
    columns = picked("input", inputs, [i.name for i in model.inputs])
    exact = None
    if not (model.is_distributed or model.imaginary or model.root):
        exact = ExactMatrix.of(with_numbers(model), rows, columns)
    found = None if exact is None else exact.roots(region, digits)
    return found or SearchedMatrix(model, rows, columns, region, digits).roots()
