"""The pipeline, one function per arrow: text, model, equations, transfer functions, and what is made of them.

text --parse--> Spec --resolve--> Model --assemble--> Equations --derive--> TransferFunction
                                                                                   | bind(values)
          --roots--> PoleZeroMap                                         BoundTransferFunction
          --time_response--> EnclosedResponse                                      |
          --approximate--> RationalApproximation             <---------------------+

any of them --print, codegen--> text, JSON, LaTeX, numpy, figure

The arrows up to transfer functions with numbers and their roots are here. Each later one is a function of its
package, imported where it is used: most commands need few of them, and many of these import numpy.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE
from symflex.errors import Source, refused
from symflex.expressions import names as expression_names
from symflex.model import Model, Setting, load_with, with_numbers
from symflex.model.spec import read
from symflex.print.warnings import warnings
from symflex.transfer import AnyBoundFunction, bind, derive
from symflex.transfer.bind import read_values
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
    from symflex.analysis.norms.closed_loops import ClosedLoops
    from symflex.data.fitting.machine import Derived, Machine, MachineFunction
    from symflex.data.fitting.parameter_fit import ParameterFit
    from symflex.data.measurement import MeasuredResponse
    from symflex.equations import Equations
    from symflex.loops.chart import StabilityChart
    from symflex.loops.stability_map import StabilityMap
    from symflex.model import ModelParameter
    from symflex.options import FitOptions, StabilityOptions
    from symflex.roots import Budget, PoleZeroMap, Region
    from symflex.transfer import Given

FIT_SAMPLES = 40  # frequencies at which a program that is fitted with is compared with ball arithmetic


def load(
    path: str | Path, allow_outside: Iterable[str | Path] = (), settings: Mapping[str, Setting] | None = None
) -> Model:
    """Read a specification file and resolve it, with the given values in place of declared ones.

    Its ``model`` blocks read files in its folder, in those of ``allow_outside``, and in their subfolders.

    Raises
    ------
    SpecError
        With every problem of the file, each at its place.
    UsageError
        What is wrong with a given value, as :func:`symflex.model.load_with` says.
    """
    return load_with(read(Path(path)), settings or {}, allow_outside=allow_outside)


def loads(
    text: str,
    name: str = "<string>",
    allow_outside: Iterable[str | Path] = (),
    settings: Mapping[str, Setting] | None = None,
) -> Model:
    """Resolve a specification given as text; its ``model`` blocks read files as if it stood at ``name``."""
    return load_with(Source(name, text), settings or {}, allow_outside=allow_outside)


def checked(model: Model) -> Equations:
    """Return the equations of a model, which ``symflex check`` finds solvable and analytic along x."""
    equations = assemble_for_checks(model)
    check_solvable(equations)
    check_along(model)
    return equations


def roots(bound: AnyBoundFunction, region: Region | None = None, digits: int = 15) -> PoleZeroMap:
    """Return poles, zeros and hidden modes, proved; see :func:`symflex.roots.locate.locate`."""
    from symflex.roots.locate import locate  # imports numpy

    return locate(bound, region, digits)


def fit_parameters(measured: Sequence[MeasuredResponse], given: FitOptions) -> ParameterFit:
    """Fit parameters of a specification to measured responses, one for each of its functions.

    Raises
    ------
    UsageError
        SF902 for names that are no parameters of the functions, or functions that are not there.
    ModelError
        SF229 for parameters without a value.
    """
    from symflex.data.fitting import parameters  # imports scipy

    names = [name.strip() for name in given.free.split(",") if name.strip()]
    machine = machine_of(str(given.model), measured, names, given.tfs, given.allow_outside)
    return parameters.fit_parameters(measured, machine, given.hold)


def machine_of(
    path: str | Path,
    measured: Sequence[MeasuredResponse],
    names: Sequence[str],
    tfs: Sequence[str] = (),
    allow_outside: Iterable[str | Path] = (),
) -> Machine:
    """Return the functions of a specification that were measured, ready for fits of some parameters."""
    from symflex.analysis.norms.closed_loops import ClosedLoops
    from symflex.data.fitting.machine import refuse_free

    model = load(path, allow_outside)
    refuse_free(names, {p.name: p for p in model.settable}, [d.name for d in model.definitions])
    pairs = _pairs_of(model, measured, tfs)
    low, high = min(one.omega[0] for one in measured), max(one.omega[-1] for one in measured)
    return _machine(str(path), model, pairs, names, (float(low), float(high)))


def _pairs_of(
    model: Model, measured: Sequence[MeasuredResponse], tfs: Sequence[str]
) -> tuple[tuple[str, str], ...]:
    """Return the function of each response: those named, or what the responses are called."""
    if tfs:
        pairs = pick_pairs(model, tfs)
        if len(pairs) == 1:
            pairs = pairs * len(measured)
    else:
        known = {"/".join(pair): pair for pair in model.transfer_functions}
        every = model.transfer_functions
        pairs = tuple(
            known.get(one.name) or every[0] for one in measured if len(every) == 1 or one.name in known
        )
    if len(pairs) != len(measured):
        message = f"{len(measured)} responses and {len(pairs)} transfer functions for them"
        names = ", ".join("/".join(pair) for pair in model.transfer_functions[:8])
        raise refused(message, f"name one with --tf for each response: {names}")
    return pairs


def _machine(
    path: str,
    model: Model,
    pairs: Sequence[tuple[str, str]],
    names: Sequence[str],
    omega: tuple[float, float],
) -> Machine:
    """Return functions with derivatives in some parameters, and what of these they tell apart."""
    from symflex.analysis.norms.closed_loops import ClosedLoops
    from symflex.codegen.program.evaluate import Gradient
    from symflex.codegen.program.verify import choose_programs
    from symflex.data.fitting.identifiable import Coefficients, identify
    from symflex.data.fitting.machine import Machine, MachineFunction

    values = dict(read_values(model.parameters, {}))
    free = tuple(p for name in names for p in model.parameters if p.name == name)
    distinct = tuple(dict.fromkeys(pairs))
    derived, _ = derive_as(with_numbers(model, names, values), distinct, solves=True)
    functions: dict[tuple[str, str], MachineFunction] = {}
    for pair, tf in zip(distinct, derived, strict=True):
        (program, _), _ = choose_programs(tf, FIT_SAMPLES, has_real=False)
        gradient = Gradient(program, tuple(names))
        functions[pair] = MachineFunction(tf.name, tf.unit, gradient, Coefficients.of(tf, names))
    used = {p.name for tf in derived for p in tf.parameters}
    for name in names:
        if name not in used:
            raise refused(f"{derived[0].name} does not depend on '{name}'", "leave it out of --free")
    known = [p.name for p in free if p.spread is not None]
    coefficients = [functions[pair].coefficients for pair in distinct]
    told = identify(derived, coefficients, names, values, omega, known)
    numbers = {
        name: float(value.nearly) * (1j if value.is_imaginary else 1) for name, value in values.items()
    }
    every = tuple(functions[pair] for pair in pairs)
    return Machine(path, every, free, numbers, told, _derived_values(model, names))


def stability(
    model: Model, given: StabilityOptions, values: Mapping[str, Given] | None = None
) -> StabilityMap | StabilityChart:
    """Return for which values of a gain, or of any parameters, a model is stable, sampled or not."""
    if model.sampled is not None:
        from symflex.analysis.sampled_loop import sampled_stability

        return sampled_stability(model, given, values)
    from symflex.loops import of_model, over

    find = over.stability_over if given.over else of_model.stability
    return find(model, given, values)


def _derived_values(model: Model, names: Sequence[str]) -> tuple[Derived, ...]:
    """Return the definitions without s that depend on some parameters."""
    from symflex.analysis.norms.closed_loops import ClosedLoops
    from symflex.codegen.program.build import constant_of
    from symflex.codegen.program.derivative import differentiated
    from symflex.codegen.program.evaluate import values_of
    from symflex.codegen.program.forge import Forge, straight
    from symflex.data.fitting.machine import Derived

    free, varying, found = set(names), {LAPLACE}, []
    for definition in model.definitions:
        inside = {n.name for n in expression_names(definition.expression)}
        if inside & varying:
            varying.add(definition.name)
            continue
        if not inside & free:
            continue
        free.add(definition.name)
        forge = Forge()
        code = differentiated(straight(forge, [constant_of(forge, model, definition.expression)]), names)
        found.append(Derived(definition.name, "", partial(values_of, code)))
    return tuple(found)


def closed_loops(model: Model, outputs: Sequence[str] = (), inputs: Sequence[str] = ()) -> ClosedLoops:
    """Close loops from outputs to as many inputs, in order, each with minus; SF902 for other numbers of them.

    Stability, encirclements of det(I + L) and the largest singular values of S, T and S - T are proved.
    """
    from symflex.analysis.norms.closed_loops import closed_loops as found_of  # few ask for matrices
    from symflex.matrices.constrained import closed, closed_at_once, driven_at_once
    from symflex.matrices.transfer_matrix import picked
    from symflex.roots.locate import locate

    rows = picked("output", outputs, [o.name for o in model.outputs])
    columns = picked("input", inputs, [i.name for i in model.inputs])
    if len(rows) != len(columns):
        message = f"loops go from as many outputs to as many inputs, not from {len(rows)} to {len(columns)}"
        raise refused(message, "choose them with --out and --in, in order")
    pairs = list(zip(rows, columns, strict=True))
    verdicts = []
    for each in (driven_at_once(model, rows, columns), closed_at_once(model, pairs)):
        (bound,) = derive_for_roots(each, [(each.outputs[0].name, each.inputs[0].name)])
        verdicts.append(locate(bound, None, 15, with_zeros=False).verdict)
    whole, given, read = closed(model, pairs)
    count = len(pairs)
    functions = []
    if verdicts[1].word == "stable":
        bounds = derive_for_roots(whole, [(y, r) for y in read for r in given], is_explained=True)
        by_row = [bounds[i : i + count] for i in range(0, len(bounds), count)]
        functions = [by_row[i : i + count] for i in range(0, len(by_row), count)]
    return found_of((rows, columns), (verdicts[0], verdicts[1]), functions)
