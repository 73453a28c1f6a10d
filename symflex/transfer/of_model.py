"""Transfer functions of a model, from the equations that suit it: expanded or nested, symbols or numbers.

Input: a model, and pairs of an output and an input.
Output: for each pair a :class:`TransferFunction`, or a :class:`NestedTransferFunction` where the expanded one
would explode.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

from symflex import equations as equations_layer
from symflex.algebra import KernelTable, terms_of
from symflex.budget import spend, uncollected
from symflex.equations import Equations
from symflex.equations.elimination import expanded_terms, explain_singular, is_singular
from symflex.errors import BudgetError, Diagnostic, ModelError, nearest, refused
from symflex.library.elements import LineElement
from symflex.model import Model, with_numbers
from symflex.model.along import is_tapered
from symflex.transfer import nested_form
from symflex.transfer.bind import LOSSY_TAPER, bind, is_degenerate
from symflex.transfer.bound import BoundTransferFunction
from symflex.transfer.derive import Terms, nested_transfer
from symflex.transfer.derive import derive_all as derive_from
from symflex.transfer.nested_form import (
    AnyBoundFunction,
    AnyTransferFunction,
    NestedTransferFunction,
    bind_nested,
)
from symflex.transfer.transfer_function import TransferFunction

EXPANDED_TERMS = 5_000  # of a closed determinant beyond which nobody reads it: over fifty pages
EXPANDED_PRODUCTS = 500  # with kernels: four beams on springs have 900, or 1,500 lines, three 120
READABLE_TERMS = 100  # of a formula of members beyond which its steps say more: two columns of a page
CODE_PRODUCTS = 8  # of numeric code of members: two beams at an angle have 12, and 90 kB of code
QUICK_PRODUCTS = 15  # of members beyond which equations are quicker: a portal frame has 16, a bent arm 12
VERDICT_PRODUCTS = 50  # of a formula that is asked for a verdict where the equations tell none
CODE_MEMBERS = 4  # members up to which code of a formula keeps its digits; ten equal spans lose all
MOST_PRODUCTS = 10_000  # beyond which nothing fits into memory: five beams have 8,000, six 70,000
UNASKED = Terms(EXPANDED_TERMS, MOST_PRODUCTS)  # of a form not asked for, counted as it is made
SOLVED = "solved as a network: code of the formula would be long (--representation expanded)"
SPLIT = "solved as a network: where wavenumbers meet, code of the formula would lose digits"
NEVER_LARGE = 20  # elements of a lumped model up to which its terms are not estimated


def pick_pairs(model: Model, names: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """Return the (output, input) pairs named "OUT/IN", all of them by default; SF902 for an unknown name."""
    known = {"/".join(pair): pair for pair in model.transfer_functions}
    for name in names:
        if name not in known:
            hint = nearest(name, known) or "available: " + ", ".join(list(known)[:8])
            raise refused(f"there is no transfer function '{name[:100]}'", hint)
    return tuple(known[name] for name in names) if names else model.transfer_functions


def assemble(model: Model) -> Equations:
    """Return the model's equations ``A(s) x + B u = 0``; nested models are derived first."""
    return equations_layer.assemble(model, nested_transfer)


def assemble_for_checks(model: Model) -> Equations:
    """Return the equations for what needs no closed form, sparse where members are many."""
    if model.sampled is not None:
        from symflex.model.sampled import continuous_part  # few models have one

        model = continuous_part(model)
    return assemble_sparse(model) if model.is_distributed and _may_be_large(model) else assemble(model)


def check_solvable(equations: Equations) -> None:
    """Raise the explanation when the equations have no unique solution."""
    if equations.ring.is_sparse:
        from symflex.equations.elimination.star_mesh import eliminate  # few models are so large

        eliminate(equations, equations.model.transfer_functions[:1])
    elif is_singular(equations):
        raise explain_singular(equations)


def check_along(model: Model) -> None:
    """Check that coefficients along x are analytic at the declared values, if all are known: else SF250."""
    if is_tapered(model) and all(p.value is not None for p in model.parameters):
        for bound in derive_bound(model, model.transfer_functions[:1]):
            bound.check_along()


def derive_all(model: Model, pairs: Sequence[tuple[str, str]] | None = None) -> tuple[TransferFunction, ...]:
    """Return the transfer functions of the given pairs, all by default, from one elimination.

    Those in which some wavenumbers have a formula and others have none, or that would be 0/0 for the declared
    values, take a second one, without names.
    Raises BudgetError: SF501, SF502 when they are too large expanded.
    """
    wanted = model.transfer_functions if pairs is None else tuple(pairs)
    if model.is_distributed and _may_be_large(model):
        terms = _expanded_terms(assemble_sparse(model), wanted[0])
        if terms > MOST_PRODUCTS:
            message = f"the closed form is too large: its determinant would have {_some(terms)} terms"
            hint = "split the model; roots, plots, sweeps, stability and exports do not need it"
            raise BudgetError(Diagnostic("SF502", message, None, hint))
    return _derive_expanded(model, wanted)


def _derive_expanded(
    model: Model, wanted: Sequence[tuple[str, str]], most: Terms | None = None
) -> tuple[TransferFunction, ...]:
    """Return what :func:`derive_all` does, of a model known not to be too large."""
    derived = derive_from(assemble(model), wanted, most)
    if model.imaginary:
        derived[0].kernels.without_tapers(*LOSSY_TAPER)
    mixed = [i for i, tf in enumerate(derived) if tf.is_mixed or is_degenerate(tf)]
    if not mixed:
        return derived
    again = dict(zip(mixed, derive_nameless(model, [wanted[i] for i in mixed], most), strict=True))
    return tuple(again.get(i, tf) for i, tf in enumerate(derived))


def derive_nameless(
    model: Model, pairs: Sequence[tuple[str, str]], most: Terms | None = None
) -> tuple[TransferFunction, ...]:
    """Return transfer functions with fundamental functions in place of kernels, which are entire at s = 0."""
    return derive_from(equations_layer.assemble(model, nested_transfer, is_nameless=True), pairs, most)


def derive_alike(model: Model, pairs: Sequence[tuple[str, str]]) -> tuple[TransferFunction, ...]:
    """Return transfer functions over one ring with the same kernels, so that they can be added."""
    derived = derive_from(assemble(model), pairs, alike=True)
    if any(tf.is_mixed or is_degenerate(tf) for tf in derived):
        nameless = equations_layer.assemble(model, nested_transfer, is_nameless=True)
        derived = derive_from(nameless, pairs, alike=True)
    return derived


def followed_along_x(tf: TransferFunction) -> TransferFunction:
    """Return a function of a model with members that taper, its uniform ones followed along x too."""
    equations = equations_layer.assemble(tf.model, nested_transfer, is_followed=True)
    (derived,) = derive_from(equations, [(tf.output.name, tf.input.name)])
    return derived


def assemble_sparse(model: Model, *, are_for_values: bool = False) -> Equations:
    """Return sparse equations for the nested form; SF910 with coefficients along x, or roots of s.

    If they ``are_for_values``, a root may stand in place of s.
    """
    if _is_expanded(model) and not (are_for_values and not is_tapered(model)):
        reason = "with roots of s" if model.root else "where coefficients vary along x"
        message = f"the nested form of networks is not available yet {reason}"
        raise ModelError(Diagnostic("SF910", message, None, "ask for the expanded representation"))
    is_sparse = not any(block.submodel is not None for block in model.blocks)
    with uncollected():
        return equations_layer.assemble(
            model, nested_transfer, is_sparse=is_sparse, is_nameless=model.is_distributed
        )


def derive_nested(
    model: Model, pairs: Sequence[tuple[str, str]] | None = None
) -> tuple[NestedTransferFunction, ...]:
    """Return the transfer functions of the given pairs, all by default, as straight-line programs."""
    wanted = model.transfer_functions if pairs is None else tuple(pairs)
    return nested_form.derive_nested(assemble_sparse(model), wanted)


def derive_as(
    model: Model,
    pairs: Sequence[tuple[str, str]],
    representation: str = "auto",
    *,
    solves: bool = False,
    is_read: bool = False,
) -> tuple[tuple[AnyTransferFunction, ...], str]:
    """Return transfer functions in one of the two exact representations, and why in that one.

    ``auto`` is ``expanded`` unless that explodes, or code that ``solves``, or people, are served better else.
    """
    if representation == "nested":
        return derive_nested(model, pairs), ""
    if representation == "expanded":
        return derive_all(model, pairs), ""
    solves = solves and model.is_distributed
    has_nested = model.is_distributed and not _is_expanded(model)
    if _may_be_large(model):
        equations = assemble_sparse(model)
        most = EXPANDED_PRODUCTS if model.is_distributed else EXPANDED_TERMS
        terms = _expanded_terms(equations, pairs[0])
        if solves and terms <= most and (terms > CODE_PRODUCTS or _members(model) > CODE_MEMBERS):
            return nested_form.derive_nested(equations, pairs), SOLVED
        if terms > most:
            reason = f"in nested form: the expanded determinant would have {_some(terms)} terms"
            return nested_form.derive_nested(equations, pairs), reason
    try:
        if solves and has_nested and assemble(with_numbers(model, in_kernels=True)).is_split:
            return derive_nested(model, pairs), SPLIT
        derived = _derive_expanded(model, pairs, UNASKED if has_nested else None)
        # Where one beam's motion is another's, the estimate may be far too small.
        if solves and _may_be_large(model) and max(map(_kernel_products, derived)) > CODE_PRODUCTS:
            return derive_nested(model, pairs), SOLVED
        terms = max((len(f) for tf in derived for f, _ in (*tf.num.factors, *tf.den.factors)), default=0)
        if is_read and terms > READABLE_TERMS and _may_be_large(model):
            reason = f"in nested form: its formula would have {terms} terms (--representation expanded)"
            return derive_nested(model, pairs), reason
        return derived, ""
    except BudgetError as error:
        spend()
        return derive_nested(model, pairs), f"in nested form: {error.diagnostics[0].message}"


def _kernel_products(tf: TransferFunction) -> int:
    """Return how many products of kernels the longest factor of a transfer function has."""
    ring = tf.ratio.ring
    kernels = {ring.index[name] for name in tf.kernels.generators}
    factors = [f for f, _ in (*tf.num.factors, *tf.den.factors)]
    return max(
        (len({tuple(x for x in m if x[0] in kernels) for m, _ in terms_of(f)}) for f in factors), default=0
    )


def is_large_network(model: Model, most: int = EXPANDED_PRODUCTS) -> bool:
    """Tell whether a distributed model's expanded form has more terms; by default, is too large."""
    if not model.is_distributed or not _may_be_large(model):
        return False
    return _expanded_terms(assemble_sparse(model), model.transfer_functions[0]) > most


def _some(terms: float) -> str:
    return f"about {terms:.0e}".replace("e+", "e") if terms < inf else "more than 1e300"


def _is_expanded(model: Model) -> bool:
    """Tell whether there is no nested form of a model yet."""
    return is_tapered(model) or model.root is not None


def _may_be_large(model: Model) -> bool:
    """Tell whether the expanded form is worth an estimate; of tapered members there is no other yet."""
    if _is_expanded(model):
        return False
    return _members(model) > 1 if model.is_distributed else len(model.elements) > NEVER_LARGE


def _members(model: Model) -> int:
    return sum(isinstance(use.element, LineElement) for use in model.elements) + len(model.fields)


def _expanded_terms(equations: Equations, pair: tuple[str, str]) -> float:
    """Return about how many terms the expanded determinant has."""
    from symflex.equations.elimination.star_mesh import eliminate  # few models are so large

    return expanded_terms(equations, eliminate(equations, (pair,)))


def derive_bound(model: Model, pairs: Sequence[tuple[str, str]]) -> tuple[BoundTransferFunction, ...]:
    """Return transfer functions with the declared values, derived with numbers from the start; else SF229."""
    return tuple(bind(tf) for tf in derive_all(with_numbers(model), pairs))


def derive_for_roots(
    model: Model, pairs: Sequence[tuple[str, str]], *, is_explained: bool = False, is_named: bool = False
) -> tuple[AnyBoundFunction, ...]:
    """Return functions with declared values for roots, nested where that is faster, unless it explains."""
    if not model.is_distributed or _is_expanded(model):
        return derive_bound(model, pairs)
    if not is_named:
        model = with_numbers(model)  # 0 alone: what vanishes is gone before anything is divided by it
    is_small = not _may_be_large(model)
    if is_small and (expanded := _expanded_unless_large(model, pairs, None)) is not None:
        return expanded if is_named else _with_wavenumbers(model, pairs, expanded)
    equations = assemble_sparse(with_numbers(model, in_kernels=True))
    most = EXPANDED_PRODUCTS if is_explained else QUICK_PRODUCTS
    if not is_small and _expanded_terms(equations, pairs[0]) <= most:
        expanded = _expanded_unless_large(model, pairs, UNASKED)
        if expanded is not None:
            return expanded
    return tuple(bind_nested(tf) for tf in nested_form.derive_nested(equations, pairs))


def derive_if_small(
    model: Model, pair: tuple[str, str], *, is_quick: bool = False
) -> BoundTransferFunction | None:
    """Return a distributed function in expanded form; None where it is too large or not so quick."""
    if _may_be_large(model) and _expanded_terms(assemble_sparse(model), pair) > MOST_PRODUCTS:
        return None
    (expanded,) = _expanded_unless_large(model, [pair], UNASKED) or (None,)
    is_slow = expanded is not None and _kernel_products(expanded.source) > VERDICT_PRODUCTS
    return None if is_quick and is_slow else expanded


def _with_wavenumbers(
    model: Model, pairs: Sequence[tuple[str, str]], expanded: tuple[BoundTransferFunction, ...]
) -> tuple[BoundTransferFunction, ...]:
    """Return functions as they are, or with numbers where only so all wavenumbers have formulas."""
    if all(_is_named(bound.kernels) for bound in expanded):
        return expanded
    numbers = with_numbers(model, in_kernels=True)
    propagation = assemble(numbers).propagation
    if propagation is None or not _is_named(propagation.table):
        return expanded
    return _expanded_unless_large(numbers, pairs, None) or expanded


def _is_named(table: KernelTable) -> bool:
    """Tell whether all wavenumbers have formulas."""
    return all(law.kind != "general" for law in table.dispersions)


def _expanded_unless_large(
    model: Model, pairs: Sequence[tuple[str, str]], most: Terms | None
) -> tuple[BoundTransferFunction, ...] | None:
    """Return expanded transfer functions with the declared values, None where they are too large."""
    try:
        return tuple(bind(tf) for tf in _derive_expanded(model, pairs, most))
    except BudgetError as error:
        if error.diagnostics[0].code not in ("SF501", "SF502"):
            raise
        return None
