"""Transfer functions of a model, from the equations that suit it: expanded or nested, symbols or numbers.

Input: a model, and pairs of an output and an input.
Output: for each pair a :class:`TransferFunction`, or a :class:`NestedTransferFunction` where the expanded one
would explode.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

from symflex import equations as equations_room
from symflex.algebra import uncollected
from symflex.budget import spend
from symflex.equations.elimination import expanded_terms, explain_singular, is_singular
from symflex.errors import BudgetError, Diagnostic, UsageError
from symflex.errors.diagnostic import nearest
from symflex.model import with_numbers
from symflex.transfer import nested_form
from symflex.transfer.bind import bind
from symflex.transfer.derive import derive_all as derive_from
from symflex.transfer.derive import nested_transfer

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.equations import Equations
    from symflex.model import Model
    from symflex.transfer.bind import BoundTransferFunction
    from symflex.transfer.nested_form import AnyTransferFunction, NestedTransferFunction
    from symflex.transfer.transfer_function import TransferFunction

EXPANDED_TERMS = 5_000
"""Terms of a closed determinant beyond which nobody reads it: more than fifty pages."""
NEVER_LARGE = 20
"""Elements up to which it is not estimated either."""


def pick_pairs(model: Model, names: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """Return the (output, input) pairs named "OUT/IN", all of them when no name is given.

    Raises UsageError: SF902 for a name the model does not have.
    """
    known = {"/".join(pair): pair for pair in model.transfer_functions}
    for name in names:
        if name not in known:
            hint = nearest(name, known) or "available: " + ", ".join(list(known)[:8])
            raise UsageError(Diagnostic("SF902", f"there is no transfer function '{name[:100]}'", None, hint))
    return tuple(known[name] for name in names) if names else model.transfer_functions


def assemble(model: Model) -> Equations:
    """Return the model's equations ``A(s) x + B u = 0``; nested models are derived first."""
    return equations_room.assemble(model, nested_transfer)


def check_solvable(equations: Equations) -> None:
    """Raise the explanation when the equations have no unique solution."""
    if is_singular(equations):
        raise explain_singular(equations)


def derive_all(model: Model, pairs: Sequence[tuple[str, str]] | None = None) -> tuple[TransferFunction, ...]:
    """Return the transfer functions of the given pairs, all by default, from one elimination.

    Those in which some wavenumbers have a formula and others have none take a second one, without names.
    """
    wanted = model.transfer_functions if pairs is None else tuple(pairs)
    try:
        found = derive_from(assemble(model), wanted)
    except BudgetError as error:
        if error.diagnostics[0].code not in ("SF501", "SF502") or not model.is_distributed:
            raise
        # A chain of elements of one law is far smaller as one, though its print has other lengths.
        joined = equations_room.assemble(model, nested_transfer, is_joined=True)
        if not joined.is_joined:
            raise
        found = derive_from(joined, wanted)
    mixed = [i for i, tf in enumerate(found) if tf.is_mixed]
    if not mixed:
        return found
    nameless = equations_room.assemble(model, nested_transfer, is_nameless=True)
    again = dict(zip(mixed, derive_from(nameless, [wanted[i] for i in mixed]), strict=True))
    return tuple(again.get(i, tf) for i, tf in enumerate(found))


def assemble_sparse(model: Model) -> Equations:
    """Return the equations over a ring of any number of names, for the nested form.

    A model inside a block is expanded first, and needs the ordinary ring.
    """
    is_sparse = not any(block.submodel is not None for block in model.blocks)
    with uncollected():
        return equations_room.assemble(
            model, nested_transfer, is_sparse=is_sparse and not model.is_distributed
        )


def derive_nested(
    model: Model, pairs: Sequence[tuple[str, str]] | None = None
) -> tuple[NestedTransferFunction, ...]:
    """Return the transfer functions of the given pairs, all by default, as straight-line programs.

    See :func:`symflex.transfer.derive_nested`.
    """
    wanted = model.transfer_functions if pairs is None else tuple(pairs)
    return nested_form.derive_nested(assemble_sparse(model), wanted)


def derive_as(
    model: Model, pairs: Sequence[tuple[str, str]], representation: str = "auto"
) -> tuple[tuple[AnyTransferFunction, ...], str]:
    """Return transfer functions in one of the two exact representations, and why in that one.

    ``expanded``: quotients of polynomials; ``nested``: straight-line programs; ``auto``: expanded, unless
    that would explode, and then a sentence says why it is not. Raises BudgetError: SF501, SF502 when they are
    too large expanded, and there is no nested form.
    """
    if representation == "nested":
        return derive_nested(model, pairs), ""
    if representation == "expanded":
        return derive_all(model, pairs), ""
    if len(model.elements) > NEVER_LARGE and not model.is_distributed:
        from symflex.equations.elimination.star_mesh import eliminate  # few models are so large

        equations = assemble_sparse(model)
        terms = expanded_terms(equations, eliminate(equations, pairs[:1]))
        if terms > EXPANDED_TERMS:
            count = f"some {terms:.0e}".replace("e+", "e") if terms < inf else "more than 1e300"
            reason = f"in nested form: the expanded determinant would have {count} terms"
            return nested_form.derive_nested(equations, pairs), reason
    try:
        return derive_all(model, pairs), ""
    except BudgetError as error:
        spend()
        if model.is_distributed:
            raise
        return derive_nested(model, pairs), f"in nested form: {error.diagnostics[0].message}"


def derive_bound(model: Model, pairs: Sequence[tuple[str, str]]) -> tuple[BoundTransferFunction, ...]:
    """Return transfer functions with the declared values, derived with numbers from the start.

    What needs no symbols, such as poles and zeros, reaches far larger models this way. Raises ModelError:
    SF229 when a parameter that occurs has no value.
    """
    return tuple(bind(tf) for tf in derive_all(with_numbers(model), pairs))
