"""What a model says in symbols: ``check``, ``derive``, ``export``, ``audit``."""

from __future__ import annotations

import os
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import click

from symflex.cli.command import Command, Specification, command_of, names_in, refuse_ends
from symflex.cli.reporting import diagnostic_json, emit_json, listed, note, say, show, terminal_width, write
from symflex.errors import SymflexError, refused
from symflex.errors.diagnostic import counted, nearest, printable
from symflex.expressions import Equation
from symflex.options import AuditOptions, CheckOptions, DeriveOptions, ExportOptions, highest_frequency

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.audit import Audit
    from symflex.audit.tables import TableAudit
    from symflex.codegen.export import Exporter
    from symflex.model import Model, ModelParameter

TARGETS_MEANT = {  # export targets by other names
    "python": "numpy",
    "octave": "matlab",
    "simulink": "matlab",
    "tex": "latex",
    "c++": "c",
    "ss": "state-space",
}


@command_of("check", CheckOptions, watches=True)
def check(spec: Specification, given: CheckOptions) -> int:
    """Check SPEC and report every problem at once.

    This checks names, units, ports, linearity and solvability, and that everything that varies along x is
    analytic.

    Warnings point to possible typing errors: a node that only one element touches, a name that nothing uses,
    an input that reaches nothing, an element without effect. All other commands end with the number of
    warnings. What was declared in cycles and is used in radians is listed.
    """
    from symflex import pipeline
    from symflex.model.unused import free_ends
    from symflex.print.motion import motion_json, motion_text, solved_json, solved_text

    model = None
    try:
        model = pipeline.load(spec.path, spec.allow_outside, spec.settings)
        equations = pipeline.checked(model)
    except SymflexError as error:
        if not given.as_json:
            if model is not None:
                found = pipeline.warnings(model)
                click.get_current_context().call_on_close(lambda: show(found))
            raise
        problems = [diagnostic_json(d) for d in error.diagnostics]
        emit_json({"schema": "symflex.check/1", "ok": False, "problems": problems, "warnings": []})
        return error.exit_code
    warnings = pipeline.warnings(model, equations)
    code = 3 if given.strict and warnings else 0
    names = ["/".join(pair) for pair in model.transfer_functions]
    ends = free_ends(model)
    if given.as_json:
        document = {
            "problems": [],
            "warnings": [diagnostic_json(w) for w in warnings],
            "transfer_functions": names,
            "conversions": [_conversion_json(p) for p in model.conversions],
            "free_ends": [{"element": use.name, "node": node} for use, node in ends],
        }
        document |= solved_json(model)
        if given.equations:
            document |= motion_json(model)
        emit_json({"schema": "symflex.check/1", "ok": True, **document})
        return code
    show(warnings)
    symbolic = [p.name for p in model.settable if p.value is None]
    counts = ", ".join(
        f"{len(group)} {word}{'' if len(group) == 1 else 's'}"
        for group, word in (
            (model.settable, "parameter"),
            (model.nodes, "node"),
            (model.elements, "element"),
            ([x for x in model.signals if not isinstance(x.expression, Equation)], "signal"),
            ([x for x in model.signals if isinstance(x.expression, Equation)], "equation"),
            (model.blocks, "block"),
            (model.fields, "field"),
        )
        if group
    )
    said = f", {len(warnings)} warning{'' if len(warnings) == 1 else 's'}" if warnings else ""
    say(f"{printable(spec.path)}: ok{said}")
    if model.title:
        say(listed("", printable(model.title).split(), " "))
    say(listed("", counts.split(), " "))
    say(listed("transfer functions: ", names))
    if ends:
        say(listed(f"{counted(len(ends), 'free end')}: ", [f"{node} of {use.name}" for use, node in ends]))
    if symbolic:
        say(listed("symbolic (no value): ", symbolic))
    for parameter in model.conversions:
        say(f"  {_conversion(parameter)}")
    for line in solved_text(model):
        say(line)
    if given.equations:
        say(motion_text(model))
    return code


def _conversion(parameter: ModelParameter) -> str:
    """Return what a parameter in cycles is used as: ``Omega = 3000 rpm, used as 314.159 rad/s``."""
    value, unit = parameter.as_written()
    if value is None or parameter.value is None:
        return f"{parameter.name} in {unit}, used in {parameter.unit}"
    written, used = (f"{float(x.nearly):.6g}" for x in (value, parameter.value))
    return f"{parameter.name} = {written} {unit}, used as {used} {parameter.unit}"


def _conversion_json(parameter: ModelParameter) -> dict[str, object]:
    value, unit = parameter.as_written()
    return {
        "name": parameter.name,
        "declared": None if value is None else float(value.nearly),
        "declared_unit": unit,
        "value": None if parameter.value is None else float(parameter.value.nearly),
        "unit": parameter.unit,
    }


LONG = 5_000  # terms beyond which a print is announced: it takes seconds, or minutes


def chosen_representation(representation: str, form: str | None) -> str:
    """Return the representation that a form belongs to; SF902 when the two options contradict each other."""
    if form is None:
        return representation
    wanted = "nested" if form == "nested" else "expanded"
    if representation not in ("auto", wanted):
        message = f"--form {form[:64]} belongs to the {wanted} representation, not the {representation} one"
        raise refused(message)
    return wanted


@command_of("derive", DeriveOptions, watches=True)
def derive(spec: Specification, given: DeriveOptions) -> int:
    """Print the transfer functions of SPEC in closed form.

    Without --tf, all are printed. A long denominator that several functions share is printed once, as D, and
    so are definitions that mean the same in all of them. Strings in JSON follow the expression grammar of
    specifications, with every denominator in full.

    --matrix prints all of them as one matrix of numerators over their least common denominator.

    --short and --order print formulas that are not exact, and below them what is proved: how much
    coefficients, poles and zeros change, and in which band the magnitude keeps within 1 dB.
    """
    from symflex import pipeline
    from symflex.print.forms import print_forms, terms_to_print, with_shared_denominators

    if given.is_matrix:
        return _matrix(spec, given)
    refuse_rows(given)
    if given.limits or given.dimensionless:
        return _read_off(spec, given)
    column = _column(given)
    model = spec.load()
    derived, reason = pipeline.derive_as(
        model,
        pipeline.pick_pairs(model, given.tfs),
        chosen_representation(given.representation, given.form),
        is_read=not given.as_json and given.format != "json",
    )
    if reason:
        note(reason)
    for tf in derived:
        if (terms := terms_to_print(tf, given.form)) > LONG:
            note(f"printing {tf.name}: about {terms} terms; --representation nested is shorter")
    is_json = given.as_json or given.format == "json"
    if given.short is given.order is given.spread is None:
        forms, sentences = print_forms(derived, given.form, given.digits, is_read=not is_json)
        for sentence in sentences:
            note(sentence)
    else:
        from symflex.symbolic.short import approximation

        derived, forms = zip(*(approximation(tf, given) for tf in derived), strict=True)
    printed_forms = forms if is_json else with_shared_denominators(derived, forms)
    entries = list(zip(derived, printed_forms, strict=True))
    # Each format is imported where it is printed, so that a terminal does not wait for LaTeX.
    if is_json:
        from symflex.print.json_format import derive_document

        emit_json(derive_document(entries) | _solved_json(model))
    elif given.format == "latex":
        from symflex.print.latex import transfer_function_latex

        verdicts = ("".join(f"% {line}\n" for line in printed.remarks) for printed in forms)
        equations = (transfer_function_latex(tf, printed, width_mm=column) for tf, printed in entries)
        say("\n\n".join(map(str.__add__, verdicts, equations)))
    elif given.format in ("typst", "omml"):
        from symflex.print import documents

        spell = documents.typst if given.format == "typst" else documents.omml
        say("\n\n".join(spell(tf, printed) for tf, printed in entries))
    else:
        from symflex.print.text import derive_text

        say(derive_text(entries, terminal_width(), is_named=given.form is not None))
        if model.operating_point is not None:
            from symflex.print.motion import solved_text

            for line in solved_text(model, given.digits, above=""):
                say(line)
    return 0


def _column(given: DeriveOptions) -> float | None:
    """Return the width of the column [mm] that LaTeX is broken to."""
    if given.width is None:
        return None
    if given.as_json or given.format != "latex":
        raise refused("--width is for --format latex")
    from symflex.print.latex import column_width

    return column_width(given.width)


def refuse_rows(given: DeriveOptions | ExportOptions) -> None:
    """Refuse options of a matrix without one."""
    refuse_ends(given)
    if isinstance(given, DeriveOptions) and given.is_rga:
        raise refused("--rga is for a matrix", "add --matrix")


def names_of_ends(given: DeriveOptions | ExportOptions) -> tuple[list[str], list[str]]:
    """Return the outputs and inputs named."""
    if given.tfs:
        raise refused("--tf names single functions", "choose rows and columns with --out and --in")
    return names_in(given.outputs), names_in(given.inputs)


def _matrix(spec: Specification, given: DeriveOptions) -> int:
    """Print all functions as one matrix."""
    from symflex.matrices import notations
    from symflex.matrices.printed import print_matrix
    from symflex.matrices.transfer_matrix import derive_matrix

    others = given.limits or given.dimensionless or given.short is not None or given.order is not None
    if others or given.spread is not None:
        raise refused("--limits, --dimensionless, --short, --spread and --order are for single functions")
    outputs, inputs = names_of_ends(given)
    column = _column(given)
    representation = chosen_representation(given.representation, given.form)
    is_json = given.as_json or given.format == "json"
    matrix = derive_matrix(spec.load(), outputs, inputs, representation, is_read=not is_json)
    if given.is_rga:
        from symflex.matrices.interaction import interaction, interaction_json, interaction_text

        if given.form or given.width or given.format not in ("text", "json"):
            raise refused("--rga prints text or --json, in no form")
        found = interaction(matrix)
        if is_json:
            emit_json(interaction_json(found))
        else:
            say(interaction_text(found, terminal_width()))
        return 0
    if matrix.reason:
        note(matrix.reason)
    form = print_matrix(matrix, given.form, given.digits)
    if is_json:
        emit_json(notations.matrix_json(matrix, form))
    elif given.format == "latex":
        say(notations.matrix_display(matrix, form, column))
    elif given.format in ("typst", "omml"):
        from symflex.print import documents

        spell = documents.typst_rows if given.format == "typst" else documents.omml_rows
        say(spell(notations.matrix_mathml(matrix, form)))
    else:
        say(notations.matrix_text(matrix, form, terminal_width()))
    return 0


def _solved_json(model: Model) -> dict[str, object]:
    """Return the values at equilibrium that were solved for, which few models have."""
    if model.operating_point is None:
        return {}
    from symflex.print.motion import solved_json

    return solved_json(model)


def _read_off(spec: Specification, given: DeriveOptions) -> int:
    """Print what can be read off formulas in place of them."""
    from symflex import pipeline
    from symflex.symbolic.groups import dimensionless_of
    from symflex.symbolic.limits import limits_of

    if given.form or given.width or given.representation != "auto" or (given.limits and given.dimensionless):
        raise refused("--limits and --dimensionless exclude each other, --form, --width and --representation")
    model = spec.load()
    derived, _ = pipeline.derive_as(model, pipeline.pick_pairs(model, given.tfs))
    found = [(limits_of if given.limits else dimensionless_of)(tf) for tf in derived]
    if given.as_json or given.format == "json":
        schema = "symflex.limits/1" if given.limits else "symflex.dimensionless/1"
        emit_json({"schema": schema, "transfer_functions": [reading.to_json_dict() for reading in found]})
    elif given.format == "latex":
        say("\n\n".join(reading.latex() for reading in found))
    else:
        say("\n".join(reading.text(terminal_width()) for reading in found).rstrip("\n"))
    return 0


class ExportCommand(Command):
    """A command whose help lists the targets."""

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the targets and what they are."""
        from symflex.codegen.exporters import SAMPLED, SUMMARIES

        with formatter.section("Targets"):
            formatter.write_dl(list(SUMMARIES.items()))
        with formatter.section("Targets of --sample"):
            formatter.write_text(", ".join(("state-space", *SAMPLED)))


@command_of("export", ExportOptions, cls=ExportCommand)
def export(spec: Specification, given: ExportOptions) -> int:
    """Write the transfer functions of SPEC for another program.

    Numeric code is verified against ball arithmetic before it is written; its documentation states the worst
    error. A target with several files, such as c with its header, writes them all beside the file of -o, and
    as one text to standard output.

    --matrix adds a function of all at once. It returns an array of shape (outputs, inputs), followed by that
    of s; code for numpy computes what entries have in common once.

    --to latex -o FOLDER/ writes every transfer function, table and figure to a file of its own, which a paper
    can input, and document.tex, which inputs them all.

    --to state-space writes one realisation of all functions; its states are displacements, velocities,
    currents and so on of the model. Exit code 3: there is no such realisation, because beams, rods and delays
    have infinitely many states, or a function has more zeros than poles.

    --sample writes difference equations: code for a controller or filter that takes one step for each
    sample, or with --to state-space its matrices. Rounding errors are bounded. A delay may be any
    fraction of a sample.

    --form band writes a product over the poles and zeros in a band, times a short polynomial's exponential:
    accurate up to the band's end, for the given parameter values only. C, MATLAB, Julia, JavaScript, jax and
    array-api use this form for functions without a short formula, such as networks and tapered members;
    a note says so, with the end of the band.
    """
    from symflex import pipeline
    from symflex.codegen.exporters import SUMMARIES
    from symflex.codegen.latex import LatexExporter
    from symflex.codegen.module_text import identifiers
    from symflex.files.write import check_folder, check_writable, write_tree

    if given.target not in SUMMARIES:
        meant = TARGETS_MEANT.get(given.target.lower(), given.target)
        hint = nearest(meant, SUMMARIES) or "targets: " + ", ".join(SUMMARIES)
        wrong = f"there is no export target '{given.target[:64]}'"
        missing = "what to export to is missing: --to TARGET"
        raise refused(wrong if given.target else missing, hint)
    exporter = _chosen(given)
    is_folder = bool(given.output and (given.output.endswith(("/", os.sep)) or Path(given.output).is_dir()))
    if given.output:
        is_many = is_folder and isinstance(exporter, LatexExporter)
        (check_folder if is_many else check_writable)(Path(given.output))
    model = spec.load()
    form = given.form if given.target == "latex" else None
    representation = chosen_representation(given.representation, form)
    if given.is_matrix:
        exporter, pairs = _for_matrix(exporter, model, given)
    else:
        refuse_rows(given)
        pairs = pipeline.pick_pairs(model, given.tfs)
    derived, reason = pipeline.derive_as(
        model, pairs, representation, solves=exporter.solves, is_read=given.target in ("latex", "typst")
    )
    if reason:
        note(reason)
    if isinstance(exporter, LatexExporter) and given.output and is_folder:
        texts, warnings = exporter.export_files(model, derived)
        for warning in warnings:
            note(f"warning: {warning}")
        write_tree(Path(given.output), {name: text.encode() for name, text in texts.items()})
        note(f"wrote {len(texts)} files to {given.output}")
        return 4 if given.strict and warnings else 0
    stem = Path(given.output).stem if given.output else identifiers({"": Path(spec.path).stem}, ())[""]
    made = exporter.export(model, derived, stem, is_alone=not given.output)
    for said in (*made.notes, *(f"warning: {warning}" for warning in made.warnings)):
        note(said)
    if given.output:
        path = Path(given.output)
        files: dict[Path, str | bytes] = {path: made.archive or made.text}
        files |= {path.with_suffix(s): text for s, text in made.companions.items()}
        if len(files) <= len(made.companions):
            message = f"'{given.output}' would overwrite a file that the export writes next to it"
            raise refused(message, f"end its name with {exporter.suffix}")
        for file, text in files.items():
            write(file, text)
    elif made.archive:
        raise refused("this export is an archive", f"-o NAME{exporter.suffix}")
    else:
        say(made.text, nl=False)
    return 4 if given.strict and made.warnings else 0


def _for_matrix(
    exporter: Exporter, model: Model, given: ExportOptions
) -> tuple[Exporter, Sequence[tuple[str, str]]]:
    """Return the exporter with a function of the matrix, and the pairs of that."""
    from symflex.codegen.export import Language
    from symflex.codegen.state_space import StateSpaceExporter
    from symflex.matrices.transfer_matrix import picked

    outputs, inputs = names_of_ends(given)
    rows = picked("output", outputs, [o.name for o in model.outputs])
    columns = picked("input", inputs, [i.name for i in model.inputs])
    pairs = [(y, u) for y in rows for u in columns]
    if isinstance(exporter, StateSpaceExporter):
        return exporter, pairs
    if not isinstance(exporter, Language):
        hint = "derive --matrix prints formulas; without --matrix, all functions are written"
        raise refused(f"--matrix is not for --to {given.target}", hint)
    return replace(exporter, rows=tuple(tuple(f"{y}/{u}" for u in columns) for y in rows)), pairs


def _chosen(given: ExportOptions) -> Exporter:
    """Return the exporter of a target, with the options that are its own."""
    from symflex.codegen.export import BAND, Language
    from symflex.codegen.exporters import EXPORTERS, SAMPLED
    from symflex.codegen.latex import LatexExporter
    from symflex.codegen.state_space import StateSpaceExporter
    from symflex.print.latex import column_width

    exporter = EXPORTERS.get(given.target)
    if isinstance(exporter, LatexExporter):
        column = column_width(given.width or "a4")
        exporter = replace(exporter, form=given.form, width_mm=column, has_figures=not given.no_figures)
    elif given.width is not None or given.no_figures:
        raise refused("--width and --no-figures are for --to latex")
    elif isinstance(exporter, Language):
        if given.form not in (None, BAND):
            message = f"the only --form for code is {BAND}, not '{given.form[:64]}'"
            raise refused(message, "use other forms with --to latex")
        end = None if given.up_to is None else Fraction(highest_frequency(given.up_to))
        exporter = replace(exporter, form=given.form, up_to=end)
    elif given.form is not None:
        raise refused("--form is for --to latex and for code")
    if given.up_to is not None and not isinstance(exporter, Language):
        raise refused("--up-to is for code")
    if given.sample is None and (given.method or given.prewarp or given.is_direct):
        raise refused("--method, --prewarp and --direct need --sample")
    sampling = None
    if given.sample is not None:
        from symflex.state_space.sampled import sampling_of

        sampling = sampling_of(given.sample, given.method, given.prewarp)
    if isinstance(exporter, StateSpaceExporter):
        if given.is_direct:
            raise refused(f"--direct is for --to {', '.join(SAMPLED)}")
        return replace(exporter, is_minimal=given.is_minimal, sampling=sampling)
    if given.is_minimal:
        raise refused("--minimal is for --to state-space")
    if sampling is not None:
        from symflex.codegen.sampled import DifferenceExporter

        if given.target not in SAMPLED:
            raise refused(f"--sample is for --to state-space, {', '.join(SAMPLED)}")
        if given.form or given.up_to is not None:
            raise refused("--form and --up-to are for code without --sample")
        return DifferenceExporter(SAMPLED[given.target], sampling, is_direct=given.is_direct)
    if exporter is None:
        raise refused(f"--to {given.target} needs a sampling time", "for instance --sample 1ms")
    return exporter


@command_of("audit", AuditOptions)
def audit(spec: Specification, given: AuditOptions) -> int:
    """Compare the formulas and tables printed in SPEC with the derived ones.

    Each formula of [published] is proved equal, or its differences are shown with the structural laws that it
    violates. Each entry of [tables] is right to the last digit, badly rounded or wrong, proved; one slip that
    makes all entries right is named as a conjecture. A difference is a result, so the exit code is 0; with
    --strict it is 4.
    """
    from symflex import audit as audit_layer
    from symflex.audit.text import audit_document, audit_text, table_text

    model = spec.load()
    if given.latex is None and given.equation is not None:
        raise refused("--equation needs --latex")
    if given.latex is not None:
        audits = _audits_of_paper(model, given)
    else:
        audits = audit_layer.audit(model, given.tfs)
    is_all = not given.tfs and given.latex is None
    tables: tuple[TableAudit, ...] = ()
    if is_all and model.tables:
        from symflex.audit.slips import audit_tables  # imports numpy

        tables = audit_tables(model, spec.source(), spec.load_changed)
    if not (model.published or model.tables or given.latex):
        note('nothing is published in this specification: put a formula into [published."OUT/IN"]')
    if given.as_json:
        emit_json(audit_document(audits, tables))
    elif audits or tables:
        width = terminal_width()
        texts = (*(audit_text(each, width) for each in audits), *(table_text(each, width) for each in tables))
        say("\n\n".join(texts))
    is_equal = bool(audits or tables) and all(each.verdict in ("equal", "rounded") for each in audits)
    is_right = all(each.is_right for each in tables)
    return 4 if given.strict and not (is_equal and is_right) else 0


def _audits_of_paper(model: Model, given: AuditOptions) -> tuple[Audit, ...]:
    """Return the audits of the formulas of a paper that are about a model; say which are not."""
    from symflex.papers.source import read_paper
    from symflex.report.referee import referee  # imports the packages of reports

    assert given.latex is not None
    judged = referee(read_paper(Path(given.latex)), [model], given.equation)
    for formula in judged:
        if formula.audit is None:
            note(f"{formula.where}: {formula.said}; {formula.reason}")
    audits = tuple(formula.audit for formula in judged if formula.audit is not None)
    return tuple(a for a in audits if not given.tfs or a.tf.name in given.tfs)
