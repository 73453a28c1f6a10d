"""The pipeline, one function per arrow: text, model, equations, transfer functions, and what is made of them.

text --parse--> Spec --resolve--> Model --assemble--> Equations --derive--> TransferFunction
                                                                               | bind(values)
   PoleZeroMap <--roots--  FrequencyResponse <--response--  RationalApproximation <--rational--
                                                                               |
                                                 print, codegen: text, JSON, LaTeX, numpy, figure
"""

from __future__ import annotations

import re
import sys
import tomllib
from decimal import Decimal
from fractions import Fraction
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING

from symflex import equations as equations_room
from symflex import transfer as transfer_room
from symflex.algebra import uncollected
from symflex.budget import spend
from symflex.equations.elimination import eliminate, expanded_terms, explain_singular, is_singular, unreached
from symflex.errors import BudgetError, Diagnostic, FitError, Source, SpecError, SymflexError, UsageError
from symflex.errors.diagnostic import nearest
from symflex.expressions import Sum
from symflex.model import Model, load_with, with_numbers
from symflex.model import spec as spec_room
from symflex.model.unused import unnamed_definitions, unused_name

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from concurrent.futures import Executor

    import numpy as np
    import numpy.typing as npt

    from symflex.analysis.explanation import ZeroExplanation
    from symflex.analysis.rational import RationalApproximation, Residue
    from symflex.analysis.sensitivity import Sensitivity
    from symflex.audit import Audit
    from symflex.data.fitting import Fit
    from symflex.data.measurement import MeasuredResponse, MeasurementPlan
    from symflex.equations import Equations
    from symflex.loops import DynamicColocation, Loop, StabilityMap
    from symflex.model import Setting
    from symflex.model.model import Published
    from symflex.model.spec import Spec
    from symflex.roots import Budget, PoleZeroMap, Progress, Region
    from symflex.state_space import StateSpace
    from symflex.sweep import Design, Sweep, Task
    from symflex.transfer import (
        AnyTransferFunction,
        BoundTransferFunction,
        NestedTransferFunction,
        TransferFunction,
    )

    Array = npt.NDArray[np.float64]
    ComplexArray = npt.NDArray[np.complex128]


EXPANDED_TERMS = 5_000
"""Terms of a closed determinant beyond which nobody reads it: more than fifty pages."""
MOST_WARNINGS = 100
"""As many as problems, of which a reader stops at as many too."""
NEVER_LARGE = 20
"""Elements up to which it is not estimated either."""


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


def assemble(model: Model) -> Equations:
    """Return the model's equations ``A(s) x + B u = 0``; nested models are derived first."""
    return equations_room.assemble(model, transfer_room.nested_transfer)


def check_solvable(equations: Equations) -> None:
    """Raise the explanation when the equations have no unique solution."""
    if is_singular(equations):
        raise explain_singular(equations)


def warnings(model: Model, equations: Equations | None = None) -> tuple[Diagnostic, ...]:
    """Return what a specification says that may not be meant.

    Parameters
    ----------
    model : Model
        Resolved.
    equations : Equations, optional
        Of the model, where they are there already.

    Returns
    -------
    tuple of Diagnostic
        What nothing uses, how frequencies were read, and, where the equations have a unique solution, inputs,
        outputs and elements without effect. Those of the model's own text come first.
    """
    try:
        equations = equations or assemble(model)
        is_solvable = not is_singular(equations)
        found = (*unreached(equations), *_unused_definitions(model)) if is_solvable else ()
    except SymflexError:
        found = ()  # what is wrong with the equations is said by what derives
    own = model.outputs[0].span.source if model.outputs[0].span else None

    def place(warning: Diagnostic) -> tuple[bool, str, int]:
        span = warning.span
        return (True, "", 0) if span is None else (span.source is not own, span.source.name, span.start)

    ordered = sorted((*model.warnings, *found), key=place)
    if len(ordered) > MOST_WARNINGS:
        more = f"{len(ordered) - MOST_WARNINGS} more warnings"
        ordered[MOST_WARNINGS:] = [Diagnostic(ordered[MOST_WARNINGS].code, more, severity="warning")]
    return tuple(ordered)


def _unused_definitions(model: Model) -> Iterator[Diagnostic]:
    """Yield the definitions that no expression names and no print shows."""
    unnamed = unnamed_definitions(model)
    sums = [d for d in unnamed if isinstance(d.expression, Sum)]
    shown = {d.name for d in sums}
    if sums and not model.is_distributed and len(model.elements) <= NEVER_LARGE:
        from symflex.print.forms import print_forms  # hardly ever needed

        printed, _ = print_forms(derive_all(model), "definitions")
        shown = {name for form in printed for name, _ in form.where}
    yield from (unused_name("definition", d.name, d.span) for d in unnamed if d.name not in shown)


def derive(equations: Equations, output: str, source: str) -> TransferFunction:
    """Return one transfer function; see :func:`symflex.transfer.derive`."""
    return transfer_room.derive(equations, output, source)


def derive_all(model: Model, pairs: Sequence[tuple[str, str]] | None = None) -> tuple[TransferFunction, ...]:
    """Return the transfer functions of the given pairs, all by default, from one elimination.

    Those in which some wavenumbers have a formula and others have none take a second one, without names.
    """
    wanted = model.transfer_functions if pairs is None else tuple(pairs)
    try:
        found = transfer_room.derive_all(assemble(model), wanted)
    except BudgetError as error:
        if error.diagnostics[0].code not in ("SF501", "SF502") or not model.is_distributed:
            raise
        # A chain of elements of one law is far smaller as one, though its print has other lengths.
        joined = equations_room.assemble(model, transfer_room.nested_transfer, is_joined=True)
        if not joined.is_joined:
            raise
        found = transfer_room.derive_all(joined, wanted)
    mixed = [i for i, tf in enumerate(found) if tf.is_mixed]
    if not mixed:
        return found
    nameless = equations_room.assemble(model, transfer_room.nested_transfer, is_nameless=True)
    again = dict(zip(mixed, transfer_room.derive_all(nameless, [wanted[i] for i in mixed]), strict=True))
    return tuple(again.get(i, tf) for i, tf in enumerate(found))


def assemble_sparse(model: Model) -> Equations:
    """Return the equations over a ring of any number of names, for the nested form.

    A model inside a block is expanded first, and needs the ordinary ring.
    """
    is_sparse = not any(block.submodel is not None for block in model.blocks)
    with uncollected():
        return equations_room.assemble(
            model, transfer_room.nested_transfer, is_sparse=is_sparse and not model.is_distributed
        )


def derive_nested(
    model: Model, pairs: Sequence[tuple[str, str]] | None = None
) -> tuple[NestedTransferFunction, ...]:
    """Return the transfer functions of the given pairs, all by default, as straight-line programs.

    See :func:`symflex.transfer.derive_nested`.
    """
    wanted = model.transfer_functions if pairs is None else tuple(pairs)
    return transfer_room.derive_nested(assemble_sparse(model), wanted)


def derive_as(
    model: Model, pairs: Sequence[tuple[str, str]], representation: str = "auto"
) -> tuple[tuple[AnyTransferFunction, ...], str]:
    """Return transfer functions in one of the two exact representations, and why in that one.

    Parameters
    ----------
    model : Model
        Resolved.
    pairs : sequence of (str, str)
        Output and input.
    representation : str
        ``expanded``: quotients of polynomials; ``nested``: straight-line programs; ``auto``: expanded, unless
        that would explode.

    Returns
    -------
    tuple
        The functions, all in the same representation, and a sentence when ``auto`` took the nested one.

    Raises
    ------
    BudgetError
        SF501, SF502 when they are too large expanded, and there is no nested form.
    """
    if representation == "nested":
        return derive_nested(model, pairs), ""
    if representation == "expanded":
        return derive_all(model, pairs), ""
    if len(model.elements) > NEVER_LARGE and not model.is_distributed:
        equations = assemble_sparse(model)
        terms = expanded_terms(equations, eliminate(equations, pairs[:1]))
        if terms > EXPANDED_TERMS:
            count = f"some {terms:.0e}".replace("e+", "e") if terms < inf else "more than 1e300"
            reason = f"in nested form: the expanded determinant would have {count} terms"
            return transfer_room.derive_nested(equations, pairs), reason
    try:
        return derive_all(model, pairs), ""
    except BudgetError as error:
        spend()
        if model.is_distributed:
            raise
        return derive_nested(model, pairs), f"in nested form: {error.diagnostics[0].message}"


def derive_bound(model: Model, pairs: Sequence[tuple[str, str]]) -> tuple[BoundTransferFunction, ...]:
    """Return transfer functions with the declared values, derived with numbers from the start.

    What needs no symbols, such as poles and zeros, reaches far larger models this way.

    Raises
    ------
    ModelError
        SF229 when a parameter that occurs has no value.
    """
    return tuple(bind(tf) for tf in derive_all(with_numbers(model), pairs))


def pick_pairs(model: Model, names: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """Return the (output, input) pairs named "OUT/IN", all of them when no name is given.

    Raises
    ------
    UsageError
        SF902 for a name the model does not have.
    """
    known = {"/".join(pair): pair for pair in model.transfer_functions}
    for name in names:
        if name not in known:
            hint = nearest(name, known) or "available: " + ", ".join(list(known)[:8])
            raise UsageError(Diagnostic("SF902", f"there is no transfer function '{name[:100]}'", None, hint))
    return tuple(known[name] for name in names) if names else model.transfer_functions


def bind(
    tf: TransferFunction, values: Mapping[str, int | float | Fraction | Decimal | str] | None = None
) -> BoundTransferFunction:
    """Return the transfer function with numbers; see :func:`symflex.transfer.bind`."""
    return transfer_room.bind(tf, values)


def roots(
    bound: BoundTransferFunction,
    region: Region | None = None,
    digits: int = 15,
    budget: Budget | None = None,
) -> PoleZeroMap:
    """Return poles, zeros and hidden modes, proved; see :func:`symflex.roots.locate.locate`."""
    from symflex.roots.locate import locate  # imports numpy

    return locate(bound, region, digits, budget)


def residues(
    bound: BoundTransferFunction,
    region: Region | None = None,
    digits: int = 15,
    budget: Budget | None = None,
) -> tuple[Residue, ...]:
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
    from symflex import state_space as state_space_room  # most commands need none of it

    found = state_space_room.realise(model, model.transfer_functions if pairs is None else pairs)
    return state_space_room.minimal(found) if is_minimal else found


def sensitivities(
    model: Model,
    bound: BoundTransferFunction,
    found: PoleZeroMap,
    names: Sequence[str] = (),
    digits: int = 15,
) -> tuple[Sensitivity, ...]:
    """Return how poles and zeros move with parameters; see :func:`.sensitivity.differentiate`.

    Parameters
    ----------
    model : Model
        Where ``bound`` comes from.
    bound, found : BoundTransferFunction, PoleZeroMap
        A transfer function with numbers, and its roots.
    names : sequence of str
        Parameters; all on which the function depends when none is given.
    digits : int
        Significant digits of every derivative.

    Raises
    ------
    UsageError
        SF902 for a parameter the model does not have.
    """
    from symflex.analysis.sensitivity import differentiate  # imports numpy

    declared = {p.name: p for p in model.parameters}
    for name in names:
        if name not in declared:
            hint = nearest(name, declared) or "parameters: " + ", ".join(list(declared)[:8])
            raise UsageError(Diagnostic("SF902", f"there is no parameter '{name[:64]}'", None, hint))
    given = dict(bound.values)
    values = {p.name: given.get(p.name, p.value) for p in model.parameters}
    known = {name: value for name, value in values.items() if value is not None}
    chosen = [p for p in model.parameters if p.name in known and (not names or p.name in names)]
    if model.is_distributed:
        return differentiate(bound.source, known, found, chosen, digits)
    # One symbol at a time, among numbers, is far less than all at once.
    pair = (bound.source.output.name, bound.source.input.name)
    moved: list[Sensitivity] = []
    for parameter in chosen:
        (tf,) = derive_all(with_numbers(model, (parameter.name,), known), [pair])
        moved += differentiate(tf, known, found, [parameter], digits)
    return tuple(sorted(moved, key=lambda m: (m.kind, m.index)))


def stability(
    model: Model,
    gain: str,
    values: Mapping[str, int | float | Fraction | Decimal | str] | None = None,
    limits: tuple[Fraction | None, Fraction | None] | None = None,
    digits: int = 15,
    budget: Budget | None = None,
    up_to: float | None = None,
) -> StabilityMap:
    """Return for which values of a gain the model is stable; see :func:`symflex.loops.find_stable_gains`.

    Parameters
    ----------
    model : Model
        With a loop closed in its signals.
    gain : str
        A parameter.
    values : mapping of str to number or quantity, optional
        In place of declared values.
    limits, digits, budget, up_to
        See :func:`symflex.loops.find_stable_gains`.

    Raises
    ------
    UsageError
        SF902 when there is no such parameter.
    ModelError
        SF801 when no pole depends on it.
    """
    from symflex import loops as stability_room  # most commands need none of it

    return stability_room.find_stable_gains(
        characteristic_loop(model, gain, values), limits, digits, budget, up_to
    )


def characteristic_loop(
    model: Model,
    gain: str,
    values: Mapping[str, int | float | Fraction | Decimal | str] | None = None,
) -> Loop:
    """Return the characteristic function of a model as a polynomial in a gain.

    See :func:`symflex.loops.characteristic_loop`.
    """
    from symflex import loops as stability_room  # most commands need none of it

    parameter = stability_room.pick_gain(model.parameters, gain)
    given = dict(values or {})
    unknown = [name for name in given if name not in {p.name for p in model.parameters}]
    if unknown:
        stability_room.pick_gain(model.parameters, unknown[0])
    # Parameters that are given another value stay symbols until that is put in.
    prepared = with_numbers(model, (gain, *given))
    equations = assemble(prepared)
    plain = {row.name for row in equations.outputs if row.divisor.is_one}
    pair = next((p for p in model.transfer_functions if p[0] in plain), model.transfer_functions[0])
    (tf,) = derive_all(prepared, [pair])
    return stability_room.characteristic_loop(tf, parameter, given)


def colocation(
    model: Model,
    name: str,
    reference: str,
    phase: float = 10.0,
    magnitude: float = 1.0,
    limits: tuple[float, float] | None = None,
    budget: Budget | None = None,
) -> DynamicColocation:
    """Return up to which frequency one output moves with another; both are named "OUT/IN".

    See :func:`symflex.loops.dynamic_colocation`.
    """
    from symflex import loops as stability_room  # most commands need none of it

    pairs = pick_pairs(model, [name, reference])
    tip, joint = derive_bound(model, pairs)
    return stability_room.dynamic_colocation(tip, joint, phase, magnitude, limits, budget)


def explain_zeros(model: Model, bound: BoundTransferFunction, found: PoleZeroMap) -> ZeroExplanation:
    """Return what the zeros are the poles of; see :func:`symflex.analysis.explanation.explain_zeros`."""
    from symflex.analysis import explanation as explanation_room  # imports numpy

    return explanation_room.explain_zeros(model, bound, found, transfer_room.nested_transfer)


def audit(model: Model, names: Sequence[str] = ()) -> tuple[Audit, ...]:
    """Return what is found about the model's printed formulas, those named "OUT/IN" or all.

    Raises
    ------
    UsageError
        SF902 for a name without a printed formula.
    SpecError
        With every problem of all formulas, each at its place.
    """
    from symflex import audit as audit_room  # most commands need none of it

    printed = {"/".join(p.tf): p for p in model.published}
    for name in names:
        if name not in printed:
            hint = nearest(name, printed) or "published: " + ", ".join(list(printed)[:8])
            raise UsageError(Diagnostic("SF902", f"nothing is published for '{name[:100]}'", None, hint))
    chosen = tuple(printed[name] for name in names) if names else model.published
    check_published(model, chosen)
    derived = derive_all(model, tuple(p.tf for p in chosen)) if chosen else ()
    return tuple(audit_room.judge(tf, p) for tf, p in zip(derived, chosen, strict=True))


def check_published(model: Model, formulas: Sequence[Published]) -> None:
    """Raise what is wrong with printed formulas of a model, each problem at its place."""
    from symflex.audit import formula_of  # most commands need none of it

    problems: list[Diagnostic] = []
    for published in formulas:
        try:
            formula_of(published, model)
        except SpecError as error:
            problems += error.diagnostics
    if problems:
        raise SpecError(*problems)


def fit(
    measured: Sequence[MeasuredResponse],
    base: str | Path | None = None,
    names: Sequence[str] = (),
    *,
    modes: int | None = None,
    start: str = "auto",
    criterion: str = "bic",
    is_gain_free: bool = False,
    is_lag_free: bool = False,
    is_lag_signed: bool = False,
    is_delay_free: bool = False,
    slope: int | None = None,
    allow_outside: Sequence[str | Path] = (),
) -> Fit:
    """Fit resonances to measured responses; see :func:`symflex.data.fitting.fit_resonances`.

    Parameters
    ----------
    measured : sequence of MeasuredResponse
        Responses that share their poles.
    base : str or Path, optional
        The specification whose transfer functions the resonances are multiplied by.
    names : sequence of str
        Its transfer functions, one per response or one for all.
    modes, start, criterion, is_gain_free, is_lag_free, is_lag_signed, is_delay_free, slope
        As there; a gain is fitted in any case without a base.
    allow_outside : sequence of str or Path
        See :func:`load`, of the base.

    Raises
    ------
    UsageError
        SF902 for a name the base does not have, or more or fewer of them than responses.
    """
    from symflex.analysis.response import respond
    from symflex.data import fitting  # imports numpy and scipy

    if base is None:
        return fitting.fit_resonances(
            measured,
            None,
            modes=modes,
            start=start,
            criterion=criterion,
            is_lag_free=is_lag_free,
            is_lag_signed=is_lag_signed,
            is_delay_free=is_delay_free,
            slope=slope,
        )
    model = load(base, allow_outside)
    taken, folders = tuple(p.name for p in model.parameters), (Path(base).parent, *allow_outside)
    pairs = pick_pairs(model, names)[: None if names else 1]
    if len(pairs) == 1:
        pairs = pairs * len(measured)
    if len(pairs) != len(measured):
        message = f"{len(measured)} responses and {len(pairs)} transfer functions of the base"
        raise UsageError(Diagnostic("SF902", message, None, "name one with --tf for each response"))
    bounds = dict(zip(pairs, derive_bound(model, pairs), strict=True))
    bases = []
    for pair in pairs:
        bound = bounds[pair]

        def function(omega: Array, bound: BoundTransferFunction = bound) -> ComplexArray:
            return respond(bound, omega).values

        unit = bound.source.unit
        bases.append(fitting.Base(function, "/".join(pair), str(base), unit, taken=taken, folders=folders))
    return fitting.fit_resonances(
        measured,
        bases,
        modes=modes,
        start=start,
        criterion=criterion,
        is_gain_free=is_gain_free,
        is_lag_free=is_lag_free,
        is_lag_signed=is_lag_signed,
        is_delay_free=is_delay_free,
    )


def fit_specification(found: Fit, folder: str | Path) -> str:
    """Return the specification of a fit that will stand in a folder.

    It has been read, resolved and assembled as ``symflex check`` does. A base that a ``model`` block can
    stand for is referred to; any other, and one that does not stand at or below the folder, is copied. See
    :func:`symflex.data.fitting.specification.fit_specification`.

    Raises
    ------
    FitError
        SF617 where neither way gives a specification that is accepted.
    """
    from symflex.data.fitting.specification import fit_specification as written

    bases = tuple(dict.fromkeys(Path(base.path) for base in found.bases if base.path))
    allowed = tuple(place for base in found.bases for place in base.folders)
    taken = {name for base in found.bases for name in base.taken}
    ways: list[Mapping[str, object] | None] = [None]
    if len(bases) == 1:
        source = spec_room.read(bases[0])
        whole = tomllib.loads(source.text, parse_float=Decimal)
        own = found.bases[0].tf.split("/")[1]
        # Other inputs of the base are left out, unless something there needs them.
        ways += [whole | {"inputs": {own: whole["inputs"][own]}}, whole]
        words = taken | set(re.findall(r"\w+", source.text))
    # A file that needs --allow-outside is the last resort: where the base itself needs it.
    for outside in ((), allowed):
        for copied in ways:
            text = written(found, folder, taken if copied is None else words, copied)
            try:
                check_solvable(assemble(loads(text, str(Path(folder) / "fitted.toml"), outside)))
            except SymflexError as error:
                refused = error.diagnostics[0]
            else:
                return text
    message = f"the fit cannot be written as a specification: {refused.message}"
    raise FitError(Diagnostic("SF617", message, None, refused.hint))


def measure(model: Model, pair: tuple[str, str], plan: MeasurementPlan) -> MeasuredResponse:
    """Return a synthetic measurement of one transfer function; see :func:`.measurement.synthesise`.

    Raises
    ------
    UsageError
        SF902 when a pole is undamped, which has no stationary response, or the plan cannot be meant.
    """
    from symflex.analysis.response import respond
    from symflex.data.measurement import synthesise  # imports numpy
    from symflex.roots import Band
    from symflex.roots.locate import locate

    plan.check()
    (bound,) = derive_bound(model, [pair])
    band = Band(Fraction(plan.low_hz) / 2, Fraction(plan.high_hz) * 2)
    for pole in locate(bound, band if bound.is_distributed else None).poles:
        if pole.on_imaginary_axis and not pole.is_zero:
            message = f"{'/'.join(pair)} has an undamped pole at {pole.frequency_hz():.4g} Hz"
            raise UsageError(
                Diagnostic("SF902", message, None, "only damped systems have a stationary response")
            )
    return synthesise("/".join(pair), lambda omega: respond(bound, omega).values, plan, bound.source.unit)


def sweep_task(
    model: Model,
    pair: tuple[str, str],
    design: Design,
    of: str = "poles",
    region: Region | None = None,
    frequencies: Sequence[float] = (),
    gain: str = "",
) -> Task:
    """Return what is wanted at every point of a design; see :class:`symflex.sweep.Task`.

    Raises
    ------
    UsageError
        SF902 when margins are wanted and there is no such gain; SF209 a value with which a length, stiffness
        or delay has a sign it cannot have.
    """
    from symflex import sweep as sweep_room  # most commands need none of it
    from symflex.loops import pick_gain

    if of == "margins":
        pick_gain(model.parameters, gain)
    sweep_room.check_design(model, design)
    return sweep_room.Task(
        model, pair, of, design.names, derive_all, region, tuple(map(float, frequencies)), gain
    )


def sweep(
    task: Task,
    design: Design,
    output: str | Path | None = None,
    executor: Executor | None = None,
    *,
    workers: int = 1,
    is_fresh: bool = False,
    progress: Progress | None = None,
) -> Sweep:
    """Solve all points of a design; with an output, write it, and go on where a killed sweep stopped.

    Parameters
    ----------
    task, design : Task, Design
        What is wanted, and where.
    output : str or Path, optional
        The file to write: .nc, .npz, .csv or .parquet; chunks are kept in ``FILE.part`` until it is written.
    executor, workers, progress
        See :func:`symflex.sweep.run_sweep`.
    is_fresh : bool
        Discard what an earlier run kept.
    """
    from symflex import sweep as sweep_room  # most commands need none of it
    from symflex.files.lock import held
    from symflex.files.write import write_atomically
    from symflex.sweep import files as sweep_files
    from symflex.sweep import journal as sweep_journal

    # The package imports api, which stands above: its version is read without importing it.
    version = str(vars(sys.modules["symflex"])["__version__"])
    key = sweep_room.sweep_key(task, design, version)
    said = {"title": task.model.title, "key": key, "version": version}
    if output is None:
        return sweep_room.run_sweep(
            task, design, executor, workers=workers, progress=progress, attributes=said
        )
    path = Path(output)
    sweep_files.check_writable(path)
    with held(path):
        journal = sweep_journal.open_journal(path, key, is_fresh=is_fresh)
        found = sweep_room.run_sweep(
            task, design, executor, workers=workers, journal=journal, progress=progress, attributes=said
        )
        write_atomically(path, sweep_files.sweep_bytes(found, path.suffix))
        journal.remove()
    return found
