"""The pipeline, one function per arrow: text, model, equations, transfer functions, and what is made of them.

text --parse--> Spec --resolve--> Model --assemble--> Equations --derive--> TransferFunction
                                                                                   | bind(values)
          --roots--> PoleZeroMap                                         BoundTransferFunction
          --response--> SampledResponse                                            |
          --rational--> RationalApproximation                <---------------------+

any of them --print, codegen--> text, JSON, LaTeX, numpy, figure

The arrows to transfer functions and warnings are imported from their rooms; those after them import a room
when they are called, as most commands need few of them.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from symflex import transfer as transfer_room
from symflex.errors import Source
from symflex.model import load_with
from symflex.model import spec as spec_room
from symflex.print.warnings import warnings
from symflex.transfer.of_model import (
    assemble,
    assemble_sparse,
    check_solvable,
    derive_all,
    derive_as,
    derive_bound,
    derive_nested,
    pick_pairs,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from concurrent.futures import Executor

    from symflex.analysis.explanation import ZeroExplanation
    from symflex.analysis.rational import PrincipalPart, RationalApproximation
    from symflex.analysis.sensitivity import RootDerivative
    from symflex.audit import Audit
    from symflex.data.fitting import ResonanceFit
    from symflex.data.measurement import MeasuredResponse
    from symflex.equations import Equations
    from symflex.loops import DynamicColocation, Loop, StabilityMap
    from symflex.model import Model, Setting
    from symflex.model.model import Published
    from symflex.model.spec import Spec
    from symflex.options import (
        ColocationOptions,
        FitOptions,
        MeasureOptions,
        StabilityOptions,
        SweepOptions,
    )
    from symflex.roots import Budget, PoleZeroMap, Progress, Region
    from symflex.state_space import StateSpace
    from symflex.sweep import Design, Sweep, Task
    from symflex.transfer import BoundTransferFunction, Given, TransferFunction

__all__ = [
    "assemble",
    "assemble_sparse",
    "audit",
    "bind",
    "characteristic_loop",
    "check_published",
    "check_solvable",
    "colocation",
    "derive",
    "derive_all",
    "derive_as",
    "derive_bound",
    "derive_nested",
    "explain_zeros",
    "fit",
    "fit_specification",
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
    "warnings",
]


def parse(text: str, name: str = "<string>") -> Spec:
    """Return the specification a text holds, with the position of everything."""
    return spec_room.parse(Source(name, text))


def load(
    path: str | Path,
    allow_outside: Iterable[str | Path] = (),
    settings: Mapping[str, Setting] | None = None,
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


def derive(equations: Equations, output: str, source: str) -> TransferFunction:
    """Return one transfer function; see :func:`symflex.transfer.derive`."""
    return transfer_room.derive(equations, output, source)


def bind(tf: TransferFunction, values: Mapping[str, Given] | None = None) -> BoundTransferFunction:
    """Return the transfer function with numbers; see :func:`symflex.transfer.bind`."""
    return transfer_room.bind(tf, values)


def roots(
    bound: BoundTransferFunction, region: Region | None = None, digits: int = 15, budget: Budget | None = None
) -> PoleZeroMap:
    """Return poles, zeros and hidden modes, proved; see :func:`symflex.roots.locate.locate`."""
    from symflex.roots.locate import locate  # imports numpy

    return locate(bound, region, digits, budget)


def residues(
    bound: BoundTransferFunction, region: Region | None = None, digits: int = 15, budget: Budget | None = None
) -> tuple[PrincipalPart, ...]:
    """Return the principal parts at the poles; see :func:`symflex.analysis.rational.find_residues`."""
    from symflex.analysis import rational as rational_room  # imports numpy

    return rational_room.find_residues(bound, region, digits, budget)


def rational(
    bound: BoundTransferFunction,
    modes: int | None = None,
    form: str = "product",
    band: tuple[float, float] | None = None,
) -> RationalApproximation:
    """Return a rational approximation with its error; see :func:`symflex.analysis.rational.approximation`."""
    from symflex.analysis import rational as rational_room  # imports numpy

    return rational_room.approximate(bound, modes, form, band)


def state_space(
    model: Model, pairs: Sequence[tuple[str, str]] | None = None, *, is_minimal: bool = False
) -> StateSpace:
    """Return one realisation with the outputs and inputs of the given pairs, all by default.

    See :func:`symflex.state_space.realise` and, for ``is_minimal``, :func:`symflex.state_space.minimal`.
    """
    from symflex import state_space as state_space_room

    found = state_space_room.realise(model, model.transfer_functions if pairs is None else pairs)
    return state_space_room.minimal(found) if is_minimal else found


def sensitivities(
    model: Model,
    bound: BoundTransferFunction,
    found: PoleZeroMap,
    names: Sequence[str] = (),
    digits: int = 15,
) -> tuple[RootDerivative, ...]:
    """Return how poles and zeros move with parameters; see :mod:`symflex.analysis.sensitivity`."""
    from symflex.analysis.sensitivity import sensitivity  # imports numpy

    return sensitivity.sensitivities(model, bound, found, names, digits)


def stability(
    model: Model,
    given: StabilityOptions,
    values: Mapping[str, Given] | None = None,
    budget: Budget | None = None,
) -> StabilityMap:
    """Return for which values of a gain the model is stable; see :mod:`symflex.loops.of_model`."""
    from symflex.loops import of_model

    return of_model.stability(model, given, values, budget)


def characteristic_loop(model: Model, gain: str, values: Mapping[str, Given] | None = None) -> Loop:
    """Return the characteristic function of a model in a gain; see :mod:`symflex.loops.of_model`."""
    from symflex.loops import of_model

    return of_model.characteristic_loop(model, gain, values)


def colocation(model: Model, given: ColocationOptions, budget: Budget | None = None) -> DynamicColocation:
    """Return up to which frequency one output moves with another; see :mod:`symflex.loops.of_model`."""
    from symflex.loops import of_model

    return of_model.colocation(model, given, budget)


def explain_zeros(model: Model, bound: BoundTransferFunction, found: PoleZeroMap) -> ZeroExplanation:
    """Return what the zeros are the poles of; see :func:`symflex.analysis.explanation.explain_zeros`."""
    from symflex.analysis import explanation as explanation_room  # imports numpy

    return explanation_room.explain_zeros(model, bound, found, transfer_room.nested_transfer)


def audit(model: Model, names: Sequence[str] = ()) -> tuple[Audit, ...]:
    """Return what is found about the model's printed formulas; see :func:`symflex.audit.audit`."""
    from symflex import audit as audit_room

    return audit_room.audit(model, names)


def check_published(model: Model, formulas: Sequence[Published]) -> None:
    """Raise what is wrong with printed formulas of a model, each problem at its place."""
    from symflex import audit as audit_room

    audit_room.check_published(model, formulas)


def fit(measured: Sequence[MeasuredResponse], given: FitOptions) -> ResonanceFit:
    """Fit resonances to measured responses, which share their poles; see :mod:`symflex.analysis.measured`."""
    from symflex.analysis import measured as measured_room  # imports numpy and scipy

    return measured_room.fit(measured, given)


def fit_specification(found: ResonanceFit, folder: str | Path) -> str:
    """Return the specification of a fit that will stand in a folder; see :mod:`.fitting.specification`."""
    from symflex.data.fitting import specification  # imports numpy

    return specification.fit_specification(found, folder)


def measure(model: Model, given: MeasureOptions) -> MeasuredResponse:
    """Return a synthetic measurement of a transfer function; see :mod:`symflex.analysis.measured`."""
    from symflex.analysis import measured as measured_room  # imports numpy and scipy

    return measured_room.measure(model, given)


def plan_sweep(model: Model, given: SweepOptions, frequencies: Sequence[float] = ()) -> tuple[Task, Design]:
    """Return what is wanted at every point of a sweep, and the points; see :func:`.sweep.plan_sweep`."""
    from symflex import sweep as sweep_room  # imports numpy and scipy

    return sweep_room.plan_sweep(model, given, frequencies)


def sweep(
    task: Task,
    design: Design,
    given: SweepOptions,
    executor: Executor | None = None,
    *,
    workers: int = 1,
    progress: Progress | None = None,
) -> Sweep:
    """Solve all points of a design, and write them; see :func:`symflex.sweep.sweep`."""
    from symflex import sweep as sweep_room  # imports numpy and scipy

    return sweep_room.sweep(task, design, given, executor, workers=workers, progress=progress)
