"""What a model says with numbers: ``roots``, ``rational``, ``stability``, ``colocation``, ``sweep``."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import click

from symflex.budget import entered_budget
from symflex.cli.command import (
    Command,
    Specification,
    bound_rows,
    command_of,
    first_pair,
    names_in,
    refuse_ends,
)
from symflex.cli.reporting import answer, emit_json, note, say_coloured, show_error, terminal_width, write
from symflex.errors import BudgetError, ModelError, refused
from symflex.options import (
    ColocationOptions,
    ContactOptions,
    RationalOptions,
    RootsOptions,
    StabilityOptions,
    SweepOptions,
    band_ends,
)

if TYPE_CHECKING:
    from symflex.analysis.sensitivity import RootDerivative
    from symflex.loops.chart import StabilityChart
    from symflex.loops.clouds import RootCloud
    from symflex.loops.spread import SpreadStability
    from symflex.loops.stability_map import StabilityMap
    from symflex.model import Model
    from symflex.roots import Region


_NAME = re.compile(r"(?!inf|nan)[A-Za-z_]\w*")
DERIVING = 0.5  # seconds that deriving may take in any case, by which a command may exceed its time


@command_of("roots", RootsOptions)
def roots(spec: Specification, given: RootsOptions) -> int:
    """Print poles, zeros and hidden modes of one transfer function of SPEC.

    Every root is proved to lie within its radius, with its multiplicity, and the list is proved complete. A
    distributed system has infinitely many roots; by default, the lowest are shown.

    --explain identifies the constrained system whose poles are the zeros. --symbolic adds natural frequencies
    and damping ratios as formulas, the conditions for real and imaginary roots, and frequency equations.
    --sensitivity adds the relative change of each natural frequency, and the change of each damping ratio,
    per relative change of a parameter. Put it after SPEC: it takes the next word as the name of a parameter.
    --spread adds rectangles that contain the poles and zeros for all combinations of values within a share.

    --matrix takes all outputs and inputs together: poles as of McMillan, transmission zeros, decoupling and
    invariant zeros, the normal rank, and the directions of the zeros. With it, --symbolic adds the
    Smith-McMillan form.

    Exit code 4: some roots could not be separated, or their number could not be proved. Exit code 5: the
    budget was exceeded; the roots certified so far are shown.
    """
    from symflex import pipeline
    from symflex.cli.progress import ProgressBar
    from symflex.print.motion import solved_json, solved_text
    from symflex.print.roots import SHORT_DIGITS, roots_text
    from symflex.roots.region import region_of

    _check_roots(given)
    chosen = region_of(given, "--")
    if given.is_matrix:
        return _matrix_roots(spec, given, chosen)
    # However short the time is, what is sought is told, and how many roots there are.
    with entered_budget().at_least(DERIVING).entered():
        model = spec.load()
        if model.sampled is not None:
            return _sampled_roots(model, given)
        pair = first_pair(model, given.tf, "showing")
        shown = (asked := given.digits or model.analysis.digits) or 15
        (bound,) = pipeline.derive_for_roots(model, [pair], is_named=bool(given.sensitivity) or given.explain)
    with ProgressBar() as bar, entered_budget().reporting_to(bar).entered():
        located = pipeline.roots(bound, chosen, shown)
    moved, clouds = tuple["RootDerivative"](), tuple["RootCloud"]()
    # By key of JSON, the data and the text.
    more: dict[str, tuple[object, str]] = {
        key: (entries, "\n".join(solved_text(model, asked or SHORT_DIGITS, above="")))
        for key, entries in solved_json(model, shown).items()
        if given.format == "text"
    }
    width, is_over = terminal_width(), located.certificate.is_exceeded
    try:
        if given.symbolic:
            from symflex.symbolic.frequency_equation import symbolic_roots
            from symflex.symbolic.roots import symbolic_latex, symbolic_text

            found = symbolic_roots(pipeline.derive_as(model, [pair])[0][0], bound, located)
            said = symbolic_latex(found, model) if given.format == "latex" else symbolic_text(found, width)
            more["letters"] = [each.to_json_dict(shown) for each in found], said
        if given.sensitivity:
            from symflex.analysis.sensitivity.sensitivity import sensitivities
            from symflex.analysis.sensitivity.text import sensitivity_text

            names = () if "" in given.sensitivity else given.sensitivity
            moved = sensitivities(model, bound, located, names, shown)
            more["sensitivity"] = [m.to_json_dict(shown) for m in moved], sensitivity_text(moved, width)
        if given.spread is not None:
            from symflex.loops.clouds import clouds_text, root_clouds

            clouds = root_clouds(bound, located, given.spread, model)
            more["spread"] = [each.to_json_dict() for each in clouds], "\n" + clouds_text(clouds)
        if given.explain:
            from symflex.analysis.explanation import explain_zeros, explanation_text

            explained = explain_zeros(model, bound, located)
            more["explanation"] = explained.to_json_dict(), "\n" + explanation_text(explained, width)
    except BudgetError as error:
        show_error(error)
        is_over = True
    if given.as_json:
        emit_json({**located.to_json_dict(), **{key: data for key, (data, _) in more.items()}})
    else:
        every = [roots_text(located, asked or SHORT_DIGITS, width), *(told for _, told in more.values())]
        say_coloured("\n".join(every[given.format == "latex" :]))
    is_decided = (
        all(m.status != "undecided" for m in moved)
        and all(c.count is not None for c in clouds)
        and located.certificate.certified
        and not (given.strict and located.excluded)
    )
    return 5 if is_over else 0 if is_decided else 4


def _sampled_roots(model: Model, given: RootsOptions) -> int:
    """Print the poles of a sampled loop."""
    from symflex.analysis.sampled_loop import sampled_poles
    from symflex.model.sampled import refused as refused_sampled

    if vars(given) != vars(RootsOptions(digits=given.digits, as_json=given.as_json)):
        raise refused_sampled(model)
    found = sampled_poles(model, given.digits)
    answer(given.as_json, found.to_json_dict, lambda: str(found))
    return 0 if found.certified else 4


def _check_roots(given: RootsOptions) -> None:
    """Refuse options of ``roots`` that do not go together."""
    if given.format != "text" and not given.symbolic:
        raise refused("--format is for --symbolic")
    if (given.inputs or given.outputs) and not given.is_matrix:
        raise refused("--in and --out are for --matrix")
    of_pairs = given.tf or given.explain or given.sensitivity or given.spread is not None
    if given.is_matrix and (of_pairs or given.format != "text"):
        raise refused("--tf, --explain, --format, --sensitivity and --spread are for single pairs")


def _matrix_roots(spec: Specification, given: RootsOptions, chosen: Region | None) -> int:
    """Print poles and zeros of the matrix of several inputs and outputs."""
    from symflex.cli.progress import ProgressBar
    from symflex.expressions import format_expression
    from symflex.matrices.matrix_roots import matrix_roots_text
    from symflex.matrices.transfer_matrix import derive_matrix
    from symflex.matrices.zeros import locate_matrix
    from symflex.print.roots import SHORT_DIGITS
    from symflex.roots.pole_zero_map import SCHEMA

    model = spec.load()
    outputs, inputs = names_in(given.outputs), names_in(given.inputs)
    asked = given.digits or model.analysis.digits
    form: dict[str, object] = {}
    said = ""
    if given.symbolic:
        from symflex.matrices.smith_mcmillan import in_expressions, smith_mcmillan

        matrix = derive_matrix(model, outputs, inputs, "expanded")
        entries = [format_expression(e) for e in in_expressions(matrix, smith_mcmillan(matrix))]
        form = {"smith_mcmillan": entries}
        said = "\n    ".join(["  Smith-McMillan form, up to factors without s", *entries])
    try:
        with ProgressBar() as bar, entered_budget().reporting_to(bar).entered():
            found = locate_matrix(model, outputs, inputs, chosen, asked or 15)
    except ModelError as error:
        if error.diagnostics[0].code != "SF229" or not form:
            raise
        note(f"the form alone: {error.diagnostics[0].message}")
        answer(given.as_json, lambda: {"schema": SCHEMA, **form}, lambda: said)
        return 0

    def text() -> str:
        shown = matrix_roots_text(found, asked or SHORT_DIGITS, terminal_width())
        return f"{shown}\n\n{said}" if said else shown

    answer(given.as_json, lambda: {**found.to_json_dict(), **form}, text)
    certificate = found.located.certificate
    is_certified = certificate.certified and not (given.strict and found.located.excluded)
    return 5 if certificate.is_exceeded else 0 if is_certified else 4


@command_of("rational", RationalOptions)
def rational(spec: Specification, given: RationalOptions) -> int:
    """Print a rational approximation of one transfer function of SPEC.

    A distributed system keeps as many modes as --modes gives: in product form their poles and zeros, in modal
    form their residues and a static correction. By sampling, symflex finds up to which frequencies the
    approximation is within 1 % and 5 % of the exact function. A lumped system with all its modes is its own
    approximation.

    --form state-space makes state equations of the modes, and proves their largest error at all frequencies
    (H-infinity). --error finds the fewest modes for an error, --matrix takes all pairs at once, and -o writes
    a specification that every export takes. Exit code 4: the error is not proved.
    """
    from symflex import pipeline
    from symflex.analysis.rational import approximate
    from symflex.analysis.rational.approximation import rational_json

    model = spec.load()
    more = given.error is not None or given.is_matrix or given.output or given.band
    if given.form == "state-space" or more:
        return _reduced(model, given)
    refuse_ends(given)
    (bound,) = pipeline.derive_for_roots(model, [first_pair(model, given.tf, "showing")], is_explained=True)
    approximation = approximate(bound, given.modes, given.form)
    answer(given.as_json, lambda: rational_json(approximation), lambda: approximation.text(None))
    return 0


def _reduced(model: Model, given: RationalOptions) -> int:
    """Print state equations with a proved error."""
    from symflex.analysis.norms.reduced import reduced_model

    if given.form == "modal":
        raise refused("--form modal has no proved error", "use --form state-space")
    if given.error is not None and given.modes is not None:
        raise refused("--modes and --error each say how many modes are kept", "give one of them")
    low, high = (0.0, 0.0) if given.band is None else map(float, band_ends(given.band))
    band = None if given.band is None else (low, high)
    reduced = reduced_model(bound_rows(model, given), given.modes, given.error, band)
    if given.output:
        write(given.output, reduced.specification(model.title or given.output))
    answer(given.as_json, reduced.to_json_dict, lambda: reduced.text(terminal_width()))
    return 0 if reduced.certified else 4


class Ranged(Command):
    """A command whose ``--range LO HI`` may begin with the name of a parameter."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Read the arguments, those of a range with a name as of a range of its own."""
        named = [a == "--range" and _NAME.fullmatch(b) is not None for a, b in pairwise([*args, ""])]
        for i in (i for i, is_named in enumerate(named) if is_named):
            if len(ends := args[i + 2 : i + 4]) < 2 or any(end.startswith("--") for end in ends):  # noqa: PLR2004 (both)
                message = f"'--range {args[i + 1]}' needs both ends: --range {args[i + 1]} LO HI"
                raise click.BadOptionUsage("--range", message, ctx)
        plain = ["--range-of" if is_named else a for a, is_named in zip(args, named, strict=True)]
        return super().parse_args(ctx, plain)


@command_of("stability", StabilityOptions, Ranged)
def stability(spec: Specification, given: StabilityOptions) -> int:
    """Print the values of a gain, or of any parameter, for which all poles of SPEC are stable.

    Close the loop in [signals]; K is one of [parameters]. Boundaries are enclosed, with the frequency at
    which poles cross the imaginary axis. Poles in the right half-plane, hidden ones included, are counted
    between boundaries. Gain and phase margins are those of the value that K has in SPEC.

    --over takes any parameter: a delay, a length, a mass. Two of them make a chart of boxes in which the
    number of poles in the right half-plane is certified; boxes about a boundary stay undecided.

    --spread checks whether SPEC is stable for every combination of its values, each off by up to a share; or
    prints a combination for which it is proved not to be. Put it after SPEC, with or without a share.

    --symbolic prints inequalities in the parameters that hold exactly where all poles, or with --of zeros all
    zeros of a transfer function, lie in the left half-plane; with --over twice, the boundary as a curve.

    --matrix closes several loops at once, from outputs to inputs in order, each with minus. It prints whether
    they are stable together, how often det(I + L) encircles 0, and the largest singular values of S and T
    with the disk margin.

    Exit code 4: something is not certified, as the output lists. Undamped structures have poles all
    along the axis; these are counted up to a frequency, which is printed.
    """
    from symflex import pipeline
    from symflex.cli.progress import ProgressBar
    from symflex.loops.spread import stability_spread

    model = spec.load()
    if given.is_matrix:
        return _closed_loops(model, given)
    refuse_ends(given)
    if given.gain and (given.over or given.symbolic):
        other = "--symbolic" if given.symbolic else "--over"
        raise refused(f"give only one of --gain and {other}")
    if given.symbolic:
        from symflex.symbolic.boundary import boundary
        from symflex.symbolic.routh import conditions

        tf = "/".join(first_pair(model, given.tf, "showing zeros of")) if given.of == "zeros" else None
        with entered_budget().entered():
            shown = boundary(model, given.over) if given.over else conditions(model, given.of, tf)
        answer(given.as_json, shown.to_json_dict, shown.latex if given.format == "latex" else shown.__str__)
        return 0
    if given.of != "poles" or given.tf or given.format != "text":
        raise refused("--of, --tf and --format are for --symbolic")
    stable: StabilityMap | StabilityChart | SpreadStability
    with ProgressBar() as bar, entered_budget().reporting_to(bar).entered():
        if given.spread is not None:
            stable = stability_spread(model, given)
        else:
            stable = pipeline.stability(model, given)
    answer(given.as_json, stable.to_json_dict, lambda: stability_text(stable, is_whole=given.is_all))
    return 0 if stable.certified else 4


def _closed_loops(model: Model, given: StabilityOptions) -> int:
    """Print what is known of several loops that are closed at once."""
    from symflex import pipeline

    others = replace(given, is_matrix=False, inputs="", outputs="", as_json=False)
    if vars(others) != vars(StabilityOptions()):
        raise refused("--matrix closes all loops as they are: it goes with --in, --out and --json alone")
    found = pipeline.closed_loops(model, names_in(given.outputs), names_in(given.inputs))
    answer(given.as_json, found.to_json_dict, lambda: str(found))
    return 0 if found.certified else 4


def stability_text(found: StabilityMap | StabilityChart | SpreadStability, *, is_whole: bool) -> str:
    """Return a map of one parameter with its first boundaries or all of them, and what else is asked for."""
    from symflex.loops import StabilityMap
    from symflex.print.text import passages_text

    if is_whole and isinstance(found, StabilityMap):
        return passages_text(found.passages(None))
    return str(found)


@command_of("contact", ContactOptions, Ranged)
def contact(spec: Specification, given: ContactOptions) -> int:
    """Print whether SPEC is stable with an environment at a port.

    The environment is a force over a displacement, such as "k_e + b_e*s + m_e*s^2"; in circuits it is a
    voltage over a current. Names that SPEC does not have become parameters: give them values with --set, or
    ask for them with --over. Without either, all positive values of one are examined, or all combinations of
    two.

    The classes spring, damper, mass and spring-damper are the laws k_e, b_e*s, m_e*s^2 and k_e + b_e*s. With
    wall, nothing moves at the port; any is every passive environment, as 'symflex passivity' proves it.

    Exit code 4: something is not certified, as the output lists.
    """
    from symflex.cli.progress import ProgressBar
    from symflex.contact.coupled import coupled_stability

    with ProgressBar() as bar, entered_budget().reporting_to(bar).entered():
        found = coupled_stability(spec.source(), given, spec.settings, spec.allow_outside)
    answer(given.as_json, found.to_json_dict, lambda: str(found))
    return 0 if found.certified else 4


@command_of("colocation", ColocationOptions)
def colocation(spec: Specification, given: ColocationOptions) -> int:
    """Print the frequency up to which an output of SPEC moves with a colocated one.

    Up to this frequency the two outputs are dynamically colocated, although flexible parts lie between them.
    The band ends where their ratio first leaves the tolerances; symflex proves that it stays within them
    below that frequency. Exit code 4: the end could not be determined.
    """
    from symflex.loops import of_model

    band = of_model.colocation(spec.load(), given)
    answer(given.as_json, band.to_json_dict, lambda: str(band))
    return 0 if band.is_decided else 4


BUDGET_CODE = "SF5"


@command_of("sweep", SweepOptions)
def sweep(spec: Specification, given: SweepOptions) -> int:
    """Solve SPEC at many values of its parameters.

    It computes poles, zeros, a response or stability margins. Several --over make a grid; with --monte-carlo,
    ranges without a count are sampled as a Latin hypercube. Every root is certified at every point, as by
    'symflex roots', and written as the nearest double with a radius; modes keep their names along the sweep.
    The result does not depend on the number of workers.

    With -o, finished chunks are kept in FILE.part until FILE is written: after an interruption, the same
    command continues. 'symflex plot sweep FILE' draws a .nc or .npz file.

    Exit code 4: something is not certified. Exit code 5: a budget was exceeded.
    """
    from symflex.cli.progress import ProgressBar
    from symflex.sweep import run
    from symflex.sweep.files import check_writable
    from symflex.sweep.labelled import sweep_json

    if given.workers and given.scheduler:
        raise refused("give only one of --workers and --scheduler")
    if given.fresh and not given.output:
        raise refused("--fresh needs a file: give -o FILE")
    if given.output:
        check_writable(Path(given.output))
    model = spec.load()
    _check(given)
    task, design = run.plan_sweep(model, given)
    if doubled := [name for name in design.names if name in spec.settings]:
        raise refused(f"'{doubled[0]}' is both swept and set")
    if given.of != "margins":
        first_pair(model, given.tf, "sweeping")
    with ProgressBar() as bar, run.open_executor(given.workers, given.scheduler) as (executor, size):
        swept = run.sweep(task, design, given, executor, workers=size, progress=bar)
    if given.output:
        note(f"wrote {Path(given.output)}")
    answer(given.as_json, lambda: sweep_json(swept), lambda: swept.text(terminal_width()))
    if swept.is_certified:
        return 0
    return 5 if any(code.startswith(BUDGET_CODE) for code in swept["code"].reshape(-1).tolist()) else 4


def _check(given: SweepOptions) -> None:
    """Refuse options that say nothing for what is computed, or contradict each other."""
    if given.of != "response" and given.count is not None:
        raise refused("--count is for --of response")
    if given.of not in ("poles", "zeros") and given.modes is not None:
        raise refused("--modes is for --of poles and --of zeros")
    if given.modes is not None and given.band is not None:
        raise refused("give only one of --modes and --band")
    if given.of == "margins" and not given.gain:
        raise refused("margins need a loop", "name its gain: --gain K")
    if given.of != "margins" and given.gain:
        raise refused("--gain is for --of margins")
