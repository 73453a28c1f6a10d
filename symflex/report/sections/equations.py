"""The transfer functions of a model in closed form."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Final

from symflex.print.forms import counts_of, with_hidden
from symflex.print.json_format import derive_document
from symflex.print.latex import TEXT_WIDTH_MM, form_labels, ratio_latex, transfer_function_latex
from symflex.print.mathml import ratio_mathml, transfer_function_mathml
from symflex.report.document import (
    Code,
    DisplayedFormula,
    Mathematics,
    Notice,
    Section,
    counted,
    labelled,
    text,
    unit_text,
)
from symflex.report.part import ChapterPart
from symflex.report.study import MOST_FUNCTIONS

if TYPE_CHECKING:
    from symflex.print.forms import PrintedForm
    from symflex.report.document import Block, Run
    from symflex.report.study import Study
    from symflex.transfer import TransferFunction

LONGEST_LATEX: Final = 60_000


def equation_section(study: Study) -> ChapterPart:
    """Return every transfer function in its default form, with what cancelled from it."""
    blocks: list[Block] = []
    left_out = len(study.model.transfer_functions) - len(study.pairs)
    if left_out:
        blocks.append(
            Notice(
                f"{left_out} of {left_out + len(study.pairs)} transfer functions are left out: "
                f"a report shows the first {MOST_FUNCTIONS}."
            )
        )
    for i, (tf, form) in enumerate(zip(study.tfs, study.forms, strict=True)):
        title = Mathematics(ratio_line(tf), ratio_latex(tf))
        blocks.append(
            Section(tf.name, _of(tf, form, f"eq:{study.stem}:{i + 1}"), f"{study.stem}-tf-{i + 1}", title)
        )
    document = derive_document(list(zip(study.tfs, study.forms, strict=True)))
    data = json.dumps(document, indent=1, ensure_ascii=True).encode()
    return ChapterPart("Transfer functions", tuple(blocks), {f"data/{study.stem}_derive.json": data})


def ratio_line(tf: TransferFunction) -> str:
    """Return output over input in one line."""
    above, below = ratio_mathml(tf).removeprefix("<mfrac>").removesuffix("</mfrac>").split("</mrow><mrow>", 1)
    return f"{above}</mrow><mo>/</mo><mrow>{below}"


def _of(tf: TransferFunction, form: PrintedForm, label: str) -> tuple[Block, ...]:
    form, hidden = with_hidden(tf, form)
    rows = transfer_function_mathml(tf, form)
    latex = transfer_function_latex(tf, form, width_mm=TEXT_WIDTH_MM, label=label)
    blocks: list[Block] = [text(_introduction(tf), " Form: ", Code(form.name), ".")]
    if tf.ratio.is_zero:
        return (text("Identically zero: the input does not reach the output."),)
    if rows is None or len(latex) > LONGEST_LATEX:
        blocks.append(Notice("The closed form is too long for a page; the folder's data hold it."))
    else:
        blocks.append(DisplayedFormula(rows, latex, f"{tf.name} in closed form"))
    labels = form_labels(tf, form)
    for expression, multiplicity in hidden:
        times = "" if multiplicity == 1 else f" ({multiplicity} times)"
        runs: list[Run] = ["Hidden: the factor ", labelled(expression, labels)]
        runs.append(
            f" cancels{times}; its modes are uncontrollable from this input or unobservable at this output."
        )
        blocks.append(text(*runs))
    return tuple(blocks)


def _introduction(tf: TransferFunction) -> str:
    zeros, poles = counts_of(tf)
    counts = ", ".join(
        f"infinitely many {noun}s" if n is None else counted(n, noun)
        for n, noun in ((zeros, "zero"), (poles, "pole"))
    )
    unit = f" in {unit_text(tf.unit)}" if unit_text(tf.unit) else ""
    return f"{tf.quantity.capitalize()}{unit}; {counts}."
