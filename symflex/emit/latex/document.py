r"""A whole article about a model, and the fragment for a paper of one's own.

The document compiles with pdflatex and only amsmath, array, booktabs, geometry, longtable and siunitx;
lmodern and microtype are used where they are installed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from symflex.emit.forms import counts_of, hidden_expressions
from symflex.emit.latex.equation import equation_label, model_labels, ratio_latex, transfer_function_latex
from symflex.emit.latex.expression import Writer
from symflex.emit.latex.table import VALUE_DIGITS, parameter_table, pole_zero_table
from symflex.emit.latex.text import escape_text
from symflex.emit.latex.units import unit_latex
from symflex.emit.latex.width import EM_MM
from symflex.errors import Diagnostic, UsageError
from symflex.kernels import LAPLACE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.emit.forms import PrintedForm
    from symflex.expressions import Expression
    from symflex.model import Model
    from symflex.roots import PoleZeroMap
    from symflex.transfer import HiddenFactor, TransferFunction

TEXT_WIDTH_MM: Final = 170.0
"""Width of the text of the document, and of fragments unless asked otherwise."""

_LONGEST_HIDDEN: Final = 0.5
_COUNTS: Final = "no one two three four five six seven eight nine ten eleven twelve".split()

_PREAMBLE: Final = r"""\documentclass[10pt,a4paper]{article}
\usepackage[T1]{fontenc}
\usepackage[utf8]{inputenc}
\IfFileExists{lmodern.sty}{\usepackage{lmodern}}{}
\IfFileExists{microtype.sty}{\usepackage{microtype}}{}
\usepackage[textwidth=170mm,textheight=245mm]{geometry}
\usepackage{amsmath}
\usepackage{array}
\usepackage{booktabs}
\usepackage{longtable}
\usepackage{siunitx}
\sisetup{per-mode=symbol}
\raggedbottom"""


def latex_fragment(tf: TransferFunction, form: PrintedForm, *, width_mm: float = TEXT_WIDTH_MM) -> str:
    r"""Return one transfer function for ``\input`` in a paper, with its definitions; it needs amsmath.

    Parameters
    ----------
    tf, form : TransferFunction, PrintedForm
        What is printed, and how.
    width_mm : float, optional
        Width of the column, set in ten points.
    """
    display = transfer_function_latex(tf, form, width_mm=width_mm)
    head = f"% {_comment(tf.name)}, {_comment(tf.quantity)}: \\eqref{{{equation_label(tf.name)}}}"
    return f"{head}\n{display}\n"


def latex_document(
    model: Model,
    tfs: Sequence[TransferFunction],
    forms: Sequence[PrintedForm],
    *,
    pole_zero_maps: Sequence[PoleZeroMap] = (),
) -> str:
    r"""Return an article with the model's parameters, transfer functions, poles and zeros.

    Parameters
    ----------
    model : Model
        Gives title, source and parameters.
    tfs, forms : sequence of TransferFunction, sequence of PrintedForm
        In pairs, in the order of print.
    pole_zero_maps : sequence of PoleZeroMap, optional
        Each is printed after the transfer function of its name.

    Returns
    -------
    str
        Encoded in UTF-8 it compiles with two runs of pdflatex, without warnings.

    Raises
    ------
    UsageError
        SF902 when a map belongs to none of the transfer functions.
    """
    known = [tf.name for tf in tfs]
    for found in pole_zero_maps:
        if found.tf not in known:
            message = f"poles and zeros of '{found.tf[:64]}', which is not among the transfer functions"
            raise UsageError(Diagnostic("SF902", message))
    parts = [
        _PREAMBLE,
        r"\begin{document}",
        _heading(model),
    ]
    if model.parameters:
        parts += [r"\section{Parameters}", _with_table(_about_values(model), parameter_table(model))]
    if tfs:
        parts.append(r"\section{Transfer functions}")
    for tf, form in zip(tfs, forms, strict=True):
        display = transfer_function_latex(tf, form, width_mm=TEXT_WIDTH_MM)
        # Without a blank line: a display belongs to the paragraph before it.
        parts.append(f"{_introduction(tf)}\n{display}")
        hidden = _hidden_modes(tf)
        maps = [found for found in pole_zero_maps if found.tf == tf.name]
        if hidden and not maps:
            parts.append("\n".join((r"\noindent", *hidden)))
        for found in maps:
            parts.append("\n".join((r"\noindent", *hidden, *_roots(tf, found))))
    parts.append(r"\end{document}")
    return "\n\n".join(parts) + "\n"


def _heading(model: Model) -> str:
    title = escape_text(model.title) or "Transfer functions"
    source = escape_text(model.source)
    lines = [r"\begin{center}", rf"{{\LARGE {title}\par}}"]
    if source:
        lines += [r"\medskip", source]
    return "\n".join((*lines, r"\end{center}"))


def _about_values(model: Model) -> str:
    if all(p.value is None for p in model.parameters):
        return "All parameters are symbolic; units are SI units."
    return f"Values are in SI units, with {VALUE_DIGITS} significant digits where they are not shorter."


def _introduction(tf: TransferFunction) -> str:
    zeros, poles = counts_of(tf)
    unit = f", in {unit_latex(tf.unit)}" if tf.unit and tf.unit != "1" else ""
    counts = f"{_counted(zeros, 'zero')} and {_counted(poles, 'pole')}"
    if zeros is None and poles is None:
        counts = "infinitely many zeros and poles"
    return f"\\subsection{{${ratio_latex(tf)}$}}\n\nThe {escape_text(tf.quantity)}{unit}, with {counts}:"


def _counted(count: int | None, noun: str) -> str:
    if count is None:
        return f"infinitely many {noun}s"
    number = _COUNTS[count] if count < len(_COUNTS) else str(count)
    return f"{number} {noun}{'' if count == 1 else 's'}"


def _hidden_modes(tf: TransferFunction) -> list[str]:
    """Return a sentence for every factor in s that cancelled."""
    writer = Writer(model_labels(tf.model))
    printed = hidden_expressions(tf)
    return [_hidden_mode(h, e, tf, writer) for h, (e, _) in zip(tf.hidden, printed, strict=True)]


def _hidden_mode(factor: HiddenFactor, printed: Expression, tf: TransferFunction, writer: Writer) -> str:
    ring = tf.ratio.ring
    degrees = factor.polynomial.degrees()
    count = int(degrees[ring.index[LAPLACE]])
    is_transcendental = any(int(degrees[ring.index[k.generator]]) for k in tf.kernels.kernels)
    is_one = not is_transcendental and count * factor.multiplicity == 1
    noun, verb = ("mode", "is") if is_one else ("modes", "are")
    if factor.polynomial == ring.generator(LAPLACE):
        what, where = "The factor $s$", rf"the {noun} at $s = 0$"
    else:
        piece = writer.piece(printed)
        if piece.width <= _LONGEST_HIDDEN * TEXT_WIDTH_MM / EM_MM:
            what = f"The factor ${piece.latex}$"
        else:
            what = "A transcendental factor" if is_transcendental else f"A factor of degree {count} in $s$"
        where = f"the {noun} at its {'root' if count == 1 and not is_transcendental else 'roots'}"
    times = "" if factor.multiplicity == 1 else f" {_counted(factor.multiplicity, 'time')}"
    return (
        f"{what} cancels between numerator and denominator{times}: {where} {verb} hidden, that is, "
        "uncontrollable from this input or unobservable at this output."
    )


def _roots(tf: TransferFunction, found: PoleZeroMap) -> list[str]:
    if not (found.poles or found.zeros or found.hidden):
        return [f"${ratio_latex(tf)}$ has neither poles nor zeros in the region searched."]
    if found.certificate.certified:
        sentence = "Every pole and zero listed is enclosed to the digits printed, and their count is proved."
    else:
        sentence = f"The list is not certified: {escape_text(found.certificate.reason or 'no reason given')}."
    return [_with_table(sentence, pole_zero_table(found))]


def _with_table(sentence: str, table: str) -> str:
    """Return a table with the sentence above it on the same page."""
    return f"{sentence}\n\n\\nopagebreak\\medskip\n{table}\n\\medskip"


def _comment(text: str) -> str:
    """Return text for one comment line."""
    return "".join(c if c.isascii() and c.isprintable() else "?" for c in text)
