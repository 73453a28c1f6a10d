"""The sensitivities of a model's poles and zeros, derived with the parameters asked for as symbols."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.analysis.sensitivity.differentiate import differentiate
from symflex.loops import pick_gain
from symflex.model import with_numbers
from symflex.transfer.of_model import derive_all

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.analysis.sensitivity.sensitivity import RootDerivative
    from symflex.model import Model
    from symflex.roots import PoleZeroMap
    from symflex.transfer import BoundTransferFunction


def sensitivities(
    model: Model,
    bound: BoundTransferFunction,
    found: PoleZeroMap,
    names: Sequence[str] = (),
    digits: int = 15,
) -> tuple[RootDerivative, ...]:
    """Return how poles and zeros move with the parameters named, or with all; see :func:`.differentiate`.

    SF902 for a parameter the model does not have.
    """
    for name in names:
        pick_gain(model.parameters, name)
    given = dict(bound.values)
    values = {p.name: given.get(p.name, p.value) for p in model.parameters}
    known = {name: value for name, value in values.items() if value is not None}
    chosen = [p for p in model.parameters if p.name in known and (not names or p.name in names)]
    if model.is_distributed:
        return differentiate(bound.source, known, found, chosen, digits)
    # One symbol at a time, among numbers, is far less than all at once.
    pair = (bound.source.output.name, bound.source.input.name)
    moved: list[RootDerivative] = []
    for parameter in chosen:
        (tf,) = derive_all(with_numbers(model, (parameter.name,), known), [pair])
        moved += differentiate(tf, known, found, [parameter], digits)
    return tuple(sorted(moved, key=lambda m: (m.kind, m.index)))
