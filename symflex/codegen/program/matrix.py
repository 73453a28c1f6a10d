"""The program of a whole transfer matrix: all entries at once, with what they have in common computed once.

Input: the lumped transfer functions of a matrix, row by row.
Output: a program with a value for each, over one denominator, and how well the worst entry agrees.

    N_11/d, N_12/d, ...     d, and sums that several numerators share, are assignments of one function

Each value is measured as that of a single function is: against ball arithmetic, at the declared values.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING

from symflex.budget import spend
from symflex.codegen.program.build import FAR_FROM, HEADROOM, Generators, available_forms, forge_of
from symflex.codegen.program.evaluate import evaluate
from symflex.codegen.program.forge import Forge, schedule_all
from symflex.codegen.program.nodes import Piecewise
from symflex.codegen.program.polynomials import express, plan_recurrences
from symflex.codegen.program.verify import Verification, double_of, measure_values
from symflex.errors import BudgetError
from symflex.matrices.printed import closed_parts
from symflex.matrices.transfer_matrix import TransferMatrix
from symflex.transfer import AnyTransferFunction, ClosedForm, TransferFunction

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

FORMS = ("closed", "closed in s", "nested")


def matrix_program(rows: Sequence[Sequence[AnyTransferFunction]]) -> tuple[Piecewise, Verification] | None:
    """Return the fastest accurate program of a matrix; None where entries share no closed form, or values."""
    matrix = TransferMatrix(tuple(map(tuple, rows)))
    parts = closed_parts(matrix) if matrix.is_reduced else None
    if parts is None or any(p.value is None for tf in matrix.each for p in tf.parameters):
        return None
    made: list[tuple[float, Piecewise, Verification]] = []
    for form in FORMS:
        if not all(form in available_forms(part) for part in parts):
            continue
        try:
            program = _program(parts, form)
        except BudgetError:
            spend()
            continue
        verified = [_verified(program, k, tf, form) for k, tf in enumerate(matrix.each)]
        if any(v.error is None for v in verified):
            return None
        worst = max(verified, key=lambda v: v.error or 0.0)
        made.append((worst.error or 0.0, program, worst))
    if not made:
        return None
    best = min(error for error, _, _ in made)
    _, program, worst = min((m for m in made if m[0] <= 2 * best), key=lambda m: m[1].size)
    return program, worst


def entry_of(program: Piecewise, k: int) -> Piecewise:
    """Return the program of one entry alone."""
    code = tuple(replace(piece, code=piece.code.needed([piece.code.values[k]])) for piece in program.code)
    return replace(program, code=code)


def _verified(program: Piecewise, k: int, tf: AnyTransferFunction, form: str) -> Verification:
    values = {p.name: double_of(p.value) for p in tf.model.parameters if p.value is not None}
    entry = entry_of(program, k)

    def at(s: NDArray[np.complex128]) -> list[complex]:
        return [complex(x) for x in evaluate(entry, s, values)]

    return measure_values(tf, at, form)


def _program(parts: Sequence[TransferFunction], form: str) -> Piecewise:
    """Return the program of all numerators over the denominator of the first part."""
    closed = [part.closed for part in parts if part.closed is not None]
    parameters = {p.name for part in parts for p in part.parameters}
    names = tuple(p.name for p in parts[0].model.parameters if p.name in parameters)
    forge = forge_of(parts[0].model)
    near, degree = _values(Generators(forge, parts[0], is_far=False), closed, form, forge)
    limit = 10.0 ** (HEADROOM // degree) if degree else inf
    if limit >= FAR_FROM or parts[0].model.root is not None:
        return schedule_all(forge, names, near, None, inf)
    far, _ = _values(Generators(forge, parts[0], is_far=True), closed, form, forge)
    return schedule_all(forge, names, near, far, limit)


def _values(
    generators: Generators, closed: Sequence[ClosedForm], form: str, forge: Forge
) -> tuple[list[int], int]:
    """Return the values of all entries, and the highest power of s in them."""
    ring = closed[0].closure.ring
    polynomials = [closed[0].num, closed[0].den, *(each.num for each in closed[1:])]
    if form == "nested":
        made = [generators.polynomial(ring, p) for p in polynomials]
    else:
        plan = plan_recurrences(ring, polynomials, splits_s=form == "closed in s")
        made = express(forge, plan, generators.images(ring, polynomials))
    (shared, order), den, *nums = made
    # One division serves all entries; in the far branch it is one of what is left of powers of s.
    front = forge.divide(shared, den[0])
    values, most = [], den[1]
    for num, degree in nums:
        excess = order + degree - den[1]
        power = forge.constant(1)
        if generators.is_far and excess:
            power = forge.power(forge.s if excess > 0 else forge.inverse, abs(excess))
        values.append(forge.multiply([front, num, power]))
        most = max(most, order + degree)
    return values, most
