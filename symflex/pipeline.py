"""The pipeline, one function per arrow: text, model, equations, transfer functions, and what is made of them.

text --parse--> Spec --resolve--> Model --assemble--> Equations --derive--> TransferFunction
                                                                                   | bind(values)
          --roots--> PoleZeroMap                                         BoundTransferFunction
          --response--> SampledResponse                                            |
          --time_response--> EnclosedResponse                                      |
          --rational--> RationalApproximation                <---------------------+

any of them --print, codegen--> text, JSON, LaTeX, numpy, figure

The arrows to transfer functions and warnings are imported from their rooms; those after them, in ``LATER``,
when they are first used, as most commands need few of them, and many of their rooms import numpy.
"""

from __future__ import annotations

from functools import wraps
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Final

from symflex.errors import Source
from symflex.model import load_with
from symflex.model import spec as spec_room
from symflex.model.loss_factors import check_causal
from symflex.print.warnings import warnings
from symflex.transfer import bind, derive, nested_transfer
from symflex.transfer.of_model import (
    assemble,
    assemble_for_checks,
    assemble_sparse,
    check_along,
    check_solvable,
    derive_all,
    derive_as,
    derive_bound,
    derive_for_roots,
    derive_nested,
    pick_pairs,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from symflex.analysis.explanation import ZeroExplanation
    from symflex.analysis.measured import fit, measure
    from symflex.analysis.rational import find_residues as residues
    from symflex.analysis.rational.approximate import approximate as rational
    from symflex.analysis.sensitivity.sensitivity import sensitivities
    from symflex.analysis.time_response import forced_response, time_response
    from symflex.audit import audit, check_published
    from symflex.data.fitting.specification import fit_specification
    from symflex.loops.of_model import characteristic_loop, colocation, stability
    from symflex.model import Model, Setting
    from symflex.model.spec import Spec
    from symflex.roots import Budget, PoleZeroMap, Region
    from symflex.state_space import StateSpace
    from symflex.sweep.run import plan_sweep, sweep
    from symflex.transfer import AnyBoundFunction, BoundTransferFunction

__all__ = [
    "assemble",
    "assemble_for_checks",
    "assemble_sparse",
    "audit",
    "bind",
    "characteristic_loop",
    "check_along",
    "check_published",
    "check_solvable",
    "colocation",
    "derive",
    "derive_all",
    "derive_as",
    "derive_bound",
    "derive_for_roots",
    "derive_nested",
    "explain_zeros",
    "fit",
    "fit_specification",
    "forced_response",
    "load",
    "loads",
    "measure",
    "parse",
    "pick_pairs",
    "plan_sweep",
    "rational",
    "residues",
    "roots",
    "sensitivities",
    "stability",
    "state_space",
    "sweep",
    "time_response",
    "warnings",
]


LATER: Final = {
    "audit": ("audit", "audit"),
    "check_published": ("audit", "check_published"),
    "rational": ("analysis.rational.approximate", "approximate"),
    "residues": ("analysis.rational", "find_residues"),
    "sensitivities": ("analysis.sensitivity.sensitivity", "sensitivities"),
    "forced_response": ("analysis.time_response", "forced_response"),
    "time_response": ("analysis.time_response", "time_response"),
    "stability": ("loops.of_model", "stability"),
    "characteristic_loop": ("loops.of_model", "characteristic_loop"),
    "colocation": ("loops.of_model", "colocation"),
    "measure": ("analysis.measured", "measure"),
    "fit": ("analysis.measured", "fit"),
    "fit_specification": ("data.fitting.specification", "fit_specification"),
    "plan_sweep": ("sweep.run", "plan_sweep"),
    "sweep": ("sweep.run", "sweep"),
}
"""Where the function behind an arrow is, and its name there."""


OTHER_S: Final = {
    "rational": "a rational approximation",
    "residues": "a residue",
    "sensitivities": "a sensitivity",
    "forced_response": "a response in time",
    "time_response": "a response in time",
    "stability": "stability of a loop",
    "characteristic_loop": "a root locus or a loop gain",
    "colocation": "a bound on colocation",
    "measure": "a synthetic measurement",
}
"""Arrows that need more of a model than its values at s = j omega, and what they make."""


def _causal(function: Callable[..., object], what: str) -> Callable[..., object]:
    """Return a function of a model, or of a function of one, that refuses those with loss factors."""

    @wraps(function)
    def checked(subject: Model | AnyBoundFunction, *given: object, **options: object) -> object:
        check_causal(getattr(getattr(subject, "source", None), "model", subject), what)
        return function(subject, *given, **options)

    return checked


def __getattr__(name: str) -> object:
    if name not in LATER:
        message = f"module 'symflex.pipeline' has no attribute '{name}'"
        raise AttributeError(message)
    room, function = LATER[name]
    found = getattr(import_module(f"symflex.{room}"), function)
    return _causal(found, OTHER_S[name]) if name in OTHER_S else found


def parse(text: str, name: str = "<string>") -> Spec:
    """Return the specification a text holds, with the position of everything."""
    return spec_room.parse(Source(name, text))


def load(
    path: str | Path, allow_outside: Iterable[str | Path] = (), settings: Mapping[str, Setting] | None = None
) -> Model:
    """Read a specification file and resolve it, with the given values in place of declared ones.

    Its ``model`` blocks read files at and below its folder, and at and below those of ``allow_outside``.

    Raises
    ------
    SpecError
        With every problem of the file, each at its place.
    UsageError
        What is wrong with a given value, as :func:`symflex.model.load_with` says.
    """
    return load_with(spec_room.read(Path(path)), settings or {}, allow_outside=allow_outside)


def loads(
    text: str,
    name: str = "<string>",
    allow_outside: Iterable[str | Path] = (),
    settings: Mapping[str, Setting] | None = None,
) -> Model:
    """Resolve a specification given as text; its ``model`` blocks read files as if it stood at ``name``."""
    return load_with(Source(name, text), settings or {}, allow_outside=allow_outside)


def roots(
    bound: AnyBoundFunction, region: Region | None = None, digits: int = 15, budget: Budget | None = None
) -> PoleZeroMap:
    """Return poles, zeros and hidden modes, proved; see :func:`symflex.roots.locate.locate`."""
    from symflex.roots.locate import locate  # imports numpy

    return locate(bound, region, digits, budget)


def state_space(
    model: Model, pairs: Sequence[tuple[str, str]] | None = None, *, is_minimal: bool = False
) -> StateSpace:
    """Return one realisation with the outputs and inputs of the given pairs, all by default.

    See :func:`symflex.state_space.realise` and, for ``is_minimal``, :func:`symflex.state_space.minimal`.
    """
    from symflex import state_space as state_space_room

    check_causal(model, "a state-space model")
    found = state_space_room.realise(model, model.transfer_functions if pairs is None else pairs)
    return state_space_room.minimal(found) if is_minimal else found


def explain_zeros(model: Model, bound: BoundTransferFunction, found: PoleZeroMap) -> ZeroExplanation:
    """Return what the zeros are the poles of; see :func:`symflex.analysis.explanation.explain_zeros`."""
    from symflex.analysis import explanation as explanation_room  # imports numpy

    check_causal(model, "an explanation of zeros")
    return explanation_room.explain_zeros(model, bound, found, nested_transfer)
