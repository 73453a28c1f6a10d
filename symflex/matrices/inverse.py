"""What inputs follow from outputs that are imposed: the inverse of a transfer matrix, and its determinant.

Input: a transfer matrix. Output: its normal rank with the pairs that prove it, its determinant, its inverse.

Outputs are imposed one after the other, each with an input that follows from it. With k pairs imposed, what
is left of the matrix is its Schur complement; the determinant of G is the product of the functions met

    det G = (y_1/u_1) (y_2/u_2 with y_1 = 0 imposed by u_1) ...

and the normal rank is the number of pairs after which all that is left is zero. Each function is derived
from the equations, exactly and in lowest terms, so nothing of a higher degree ever occurs. With all outputs
imposed the equations have the inverse (Schur 1917; Silverman 1969 inverts systems so, in state space).

    G = [1/(m s^2), 1/k; 0, 1/(b s)]      det G = 1/(m s^2) * 1/(b s)      G^-1 = [m s^2, -m b s^3/k; 0, b s]
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from symflex.algebra import Factored
from symflex.errors import BudgetError, Diagnostic, ModelError, refused
from symflex.expressions import Name, sum_of
from symflex.matrices.transfer_matrix import TransferMatrix, derive_matrix, joined_ring, one_table
from symflex.model import Model
from symflex.transfer import AnyTransferFunction, TransferFunction
from symflex.transfer.lowest_terms import cancel
from symflex.transfer.of_model import derive_as

Places = Sequence[tuple[str, str]]  # pairs of an output and an input


@dataclass(frozen=True)
class Imposed:
    """Pairs of outputs and inputs, as many as the normal rank, with the functions met in turn."""

    pairs: tuple[tuple[str, str], ...]
    pivots: tuple[AnyTransferFunction, ...]  # of each pair, with all pairs before it imposed; none is zero

    @property
    def rank(self) -> int:
        """The normal rank: that at almost every s."""
        return len(self.pairs)


def impose_all(matrix: TransferMatrix) -> Imposed:
    """Impose outputs until what is left of a matrix is zero, which proves its normal rank."""
    pairs: list[tuple[str, str]] = []
    pivots: list[AnyTransferFunction] = []
    rows, columns = [o.name for o in matrix.outputs], [i.name for i in matrix.inputs]
    while rows and columns:
        model = replace(matrix.model, imposed=tuple(pairs))
        found = _first(model, [(rows[0], columns[0])]) or _first(
            model, [(y, u) for y in rows for u in columns][1:]
        )
        if found is None:
            break
        pair = found.output.name, found.input.name
        pairs.append(pair)
        pivots.append(found)
        rows.remove(pair[0])
        columns.remove(pair[1])
    return Imposed(tuple(pairs), tuple(pivots))


def _first(model: Model, pairs: Places) -> AnyTransferFunction | None:
    """Return the first function of a model that is not zero."""
    derived, _ = derive_as(model, pairs) if pairs else ((), "")
    return next((tf for tf in derived if not tf.is_zero), None)


def inverse(matrix: TransferMatrix) -> TransferMatrix:
    """Return the inputs that follow from imposed outputs.

    Raises SF902 where the matrix is not square, SF237, with its normal rank, where it is singular.
    """
    rows, columns = matrix.shape
    if rows != columns:
        message = f"a matrix of {rows} outputs and {columns} inputs has no inverse"
        raise refused(message, "choose as many outputs as inputs")
    found = impose_all(matrix)
    if found.rank < rows:
        raise singular(matrix, found)
    model = replace(matrix.model, imposed=found.pairs)
    return derive_matrix(model, [i.name for i in matrix.inputs], [o.name for o in matrix.outputs])


def singular(matrix: TransferMatrix, found: Imposed) -> ModelError:
    """Return the error that a square matrix is singular at every s."""
    inside = ", ".join(f"{y}/{u}" for y, u in found.pairs) or "none"
    size = len(matrix.pairs)
    message = f"the transfer matrix is singular at every s: its normal rank is {found.rank}, not {size}"
    return ModelError(Diagnostic("SF237", message, None, f"pairs that are independent: {inside}"))


def return_difference(matrix: TransferMatrix) -> TransferMatrix:
    """Return I + L of loops that are opened at the inputs of a square matrix L, each fed back with minus.

    Its determinant is zero at the poles of the closed loops; its inverse is their sensitivity. It is derived
    from the equations, with the input added to each output. Raises SF902 where the matrix is not square.
    """
    rows, columns = matrix.shape
    if rows != columns or matrix.model.imposed:
        raise refused("loops are closed from as many outputs to as many inputs of a model")
    added = {o.name: i.name for o, i in zip(matrix.outputs, matrix.inputs, strict=True)}
    outputs = tuple(
        replace(o, expression=sum_of([o.expression, Name(added[o.name])])) if o.name in added else o
        for o in matrix.model.outputs
    )
    model = replace(matrix.model, outputs=outputs)
    return derive_matrix(model, [o.name for o in matrix.outputs], [i.name for i in matrix.inputs])


def determinant(matrix: TransferMatrix) -> TransferFunction:
    """Return the determinant of a square matrix in lowest terms, as a function without ends of its own.

    Raises SF902 where it is not square, SF502 where a function on the way has no expanded form.
    """
    rows, columns = matrix.shape
    if rows != columns:
        message = f"a matrix of {rows} outputs and {columns} inputs has no determinant"
        raise refused(message, "choose as many outputs as inputs")
    found = impose_all(matrix)
    pivots = [tf for tf in found.pivots if isinstance(tf, TransferFunction)]
    if len(pivots) < len(found.pivots):
        hint = "numpy.linalg.det of its values has numbers"
        raise BudgetError(Diagnostic("SF502", "a nested matrix has no symbolic determinant", None, hint))
    like = pivots[0] if pivots else next(tf for tf in matrix.each if isinstance(tf, TransferFunction))
    kernels = one_table([tf.kernels for tf in pivots])
    if kernels is None:
        hint = "values of the matrix have one"
        raise BudgetError(Diagnostic("SF502", "the determinant has kernels of several lengths", None, hint))
    ring = joined_ring([tf.ring for tf in pivots], kernels) if kernels else like.ring
    ratio = Factored.number(ring, _sign(matrix, found) if found.rank == rows else 0)
    for tf in pivots:
        ratio = ratio * tf.ratio.over(ring)
    radicals = None if kernels else like.radicals
    ratio, _ = cancel(ratio.numerator(), ratio.denominator(), radicals=radicals)
    parts = (ratio.numerator(), ratio.denominator()) if kernels else None
    made = replace(like, reduced=ratio, closed=None, hidden=(), kernels=kernels, parts=parts)
    return replace(made, quantity="determinant", unit="", solve=None, with_waves=None)


def _sign(matrix: TransferMatrix, found: Imposed) -> int:
    """Return the sign of the order in which pairs were imposed."""
    rows = {o.name: k for k, o in enumerate(matrix.outputs)}
    columns = {i.name: k for k, i in enumerate(matrix.inputs)}
    order = [columns[u] for y, u in sorted(found.pairs, key=lambda pair: rows[pair[0]])]
    swaps = sum(a > b for k, a in enumerate(order) for b in order[k + 1 :])
    return -1 if swaps % 2 else 1
