r"""A whole article about a model, in one file or in files to ``\input``, and the fragment for a paper.

Documents compile with pdflatex and lualatex and only amsmath, array, booktabs, geometry and siunitx
(version 3); lmodern and microtype are used where they are installed. All of it is ASCII.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from symflex.algebra import LAPLACE
from symflex.errors import refused
from symflex.expressions import Expression
from symflex.files.write import free_name
from symflex.model import Model
from symflex.print.forms import PrintedForm, counts_of, with_hidden
from symflex.print.latex.equation import equation_label, form_labels, ratio_latex, transfer_function_latex
from symflex.print.latex.expression import Writer
from symflex.print.latex.page import COLUMNS_MM, preamble
from symflex.print.latex.table import VALUE_DIGITS, mode_table, parameter_table, root_table
from symflex.print.latex.text import escape_text
from symflex.print.latex.units import unit_latex
from symflex.print.roots import KINDS, region_text, roots_of
from symflex.print.width import EM_MM
from symflex.transfer import AnyTransferFunction, HiddenFactor, TransferFunction

if TYPE_CHECKING:
    from symflex.roots import PoleZeroMap

TEXT_WIDTH_MM: Final = COLUMNS_MM["a4"]  # width of the document's text, and of fragments by default
DOCUMENT: Final = "document.tex"  # name of the file of a document that is compiled
_LONGEST_HIDDEN: Final = 0.5
_COUNTS: Final = "no one two three four five six seven eight nine ten eleven twelve".split()
_FOR_EQUATIONS: Final = "amsmath"
_FOR_TABLES: Final = "amsmath,array,booktabs,siunitx"
_FOR_FIGURES: Final = ("pgf",)


@dataclass(frozen=True, slots=True)
class _Block:
    """A part of a document: running text, or what a file of its own may hold."""

    text: str
    file: str = ""
    packages: str = ""
    title: str = ""


@dataclass(frozen=True, slots=True)
class Picture:
    r"""A figure that a document inputs."""

    name: str  # of its file, without suffix
    latex: str  # a ``pgfpicture`` as wide as the column
    title: str  # plain text; what it shows
    of: tuple[AnyTransferFunction, ...] = ()  # whose it shows that of; empty where that goes without saying


def latex_fragment(tf: AnyTransferFunction, form: PrintedForm, *, width_mm: float = TEXT_WIDTH_MM) -> str:
    r"""Return one transfer function for ``\input`` in a paper, with its definitions; it needs amsmath."""
    return _file(_equation(tf, form, width_mm, ""), width_mm)


def latex_document(
    model: Model,
    tfs: Sequence[AnyTransferFunction],
    forms: Sequence[PrintedForm],
    *,
    pole_zero_maps: Sequence[PoleZeroMap] = (),
    width_mm: float = TEXT_WIDTH_MM,
) -> str:
    """Return an article with the model's parameters, transfer functions, poles, zeros and modes.

    Each pole-zero map is printed after the function of its name; SF902 when it belongs to none.
    """
    blocks = _blocks(model, tfs, forms, pole_zero_maps, width_mm)
    return "".join((*_opening(model, width_mm), *(block.text for block in blocks), "\\end{document}\n"))


def latex_files(
    model: Model,
    tfs: Sequence[AnyTransferFunction],
    forms: Sequence[PrintedForm],
    *,
    pole_zero_maps: Sequence[PoleZeroMap] = (),
    pictures: Sequence[Picture] = (),
    width_mm: float = TEXT_WIDTH_MM,
) -> dict[str, str]:
    r"""Return the article as files to ``\input`` into a paper; :data:`DOCUMENT` inputs them all.

    A file contains a transfer function, a table of roots, of parameters or of modes, or a figure, and names
    the packages that it needs.
    """
    files: dict[str, str] = {}
    parts = list(_opening(model, width_mm, _FOR_FIGURES if pictures else ()))
    for block in _blocks(model, tfs, forms, pole_zero_maps, width_mm):
        if not block.file:
            parts.append(block.text)
            continue
        name = free_name(block.file, (DOCUMENT, *files), ".tex")
        files[name] = _file(block, width_mm)
        after = block.text[len(block.text.rstrip("\n")) :]
        parts.append(f"\\input{{{name.removesuffix('.tex')}}}{after}")
    if pictures:
        parts.append("\\section{Figures}\n\n")
    for picture in pictures:
        name = free_name(_plain_stem(picture.name), (DOCUMENT, *files), ".pgf")
        files[name] = picture.latex
        ratios = ", ".join(f"${ratio_latex(tf)}$" for tf in picture.of)
        # What a figure shows stands on the page that shows it.
        parts.append(
            f"\\noindent\\begin{{minipage}}{{\\linewidth}}\\raggedright\n\\input{{{name}}}\n\n\\smallskip"
            f"\\noindent {escape_text(picture.title)}{f' of {ratios}' if ratios else ''}.\n"
            "\\end{minipage}\n\\bigskip\n\n"
        )
    files[DOCUMENT] = "".join((*parts, "\\end{document}\n"))
    return files


def _file(block: _Block, width_mm: float) -> str:
    head = f"% {block.title}\n% Needs \\usepackage{{{block.packages}}}; for a column of {width_mm:g} mm.\n"
    return f"{head}{block.text.rstrip()}\n"


def _opening(model: Model, width_mm: float, packages: Sequence[str] = ()) -> Iterator[str]:
    yield f"% To be compiled twice, with pdflatex or lualatex.\n{preamble(width_mm, packages)}\n\n"
    title = escape_text(model.title) or "Transfer functions"
    lines = [r"\begin{center}", rf"{{\LARGE {title}\par}}"]
    if source := escape_text(model.source):
        lines += [r"\medskip", source]
    yield "\\begin{document}\n\n" + "\n".join((*lines, r"\end{center}")) + "\n\n"


def _blocks(
    model: Model,
    tfs: Sequence[AnyTransferFunction],
    forms: Sequence[PrintedForm],
    maps: Sequence[PoleZeroMap],
    width_mm: float,
) -> Iterator[_Block]:
    names = [tf.name for tf in tfs]
    for located in maps:
        if located.tf not in names:
            message = f"poles and zeros of '{located.tf[:64]}', which is not among the transfer functions"
            raise refused(message)
    if model.settable:
        values = f"Values are rounded to {VALUE_DIGITS} significant digits."
        if all(p.value is None for p in model.settable):
            values = "All parameters are symbolic."
        yield _Block(f"\\section{{Parameters}}\n\n{values}{_BEFORE_TABLE}")
        yield _table(parameter_table(model, width_mm=width_mm), "parameters", "Parameters")
    if tfs:
        yield _Block("\\section{Transfer functions}\n\n")
    for tf, form in zip(tfs, forms, strict=True):
        yield _Block(_introduction(tf))
        named, factors = with_hidden(tf, form)
        # Without a blank line: a display belongs to the paragraph before it.
        yield _equation(tf, named, width_mm, "\n\n")
        hidden = []
        if tf.is_reduced:
            writer = Writer(form_labels(tf, named))
            pairs = zip(tf.whole.hidden, factors, strict=True)
            hidden = [_hidden_mode(h, e, tf.whole, writer, width_mm) for h, (e, _) in pairs]
        of_tf = [located for located in maps if located.tf == tf.name]
        if hidden and not of_tf:
            yield _Block("\n".join((r"\noindent", *hidden)) + "\n\n")
        for located in of_tf:
            yield _Block("\n".join((r"\noindent", *hidden, *_about_roots(tf, located))) + "\n\n")
            for kind, title in KINDS.items():
                if roots_of(located, kind):
                    yield _Block(f"\\medskip\\noindent {title}:{_BEFORE_TABLE}")
                    table = root_table(located, kind, width_mm=width_mm)
                    yield _table(table, f"{_stem(tf)}_{kind}", f"{title} of {_comment(tf.name)}")
    if any(located.all_poles for located in maps):
        shown = (
            "" if all(each.certificate.certified for each in maps) else " The lists are not all certified."
        )
        whose = "the transfer function" if len(maps) == 1 else "at least one of the transfer functions"
        about = f"The modes that are poles of {whose}; number 0 is motion as a rigid body.{shown}"
        yield _Block(f"\\section{{Modes}}\n\n{about}{_BEFORE_TABLE}")
        yield _table(mode_table(maps, width_mm=width_mm), "modes", "Modes")


_BEFORE_TABLE: Final = "\n\n\\nopagebreak\\medskip\n"


def _table(table: str, file: str, title: str) -> _Block:
    return _Block(f"{table}\n\\medskip\n\n", file, _FOR_TABLES, title)


def _equation(tf: AnyTransferFunction, form: PrintedForm, width_mm: float, after: str) -> _Block:
    display = transfer_function_latex(tf, form, width_mm=width_mm)
    title = f"{_comment(tf.name)}, {_comment(tf.quantity)}: \\eqref{{{equation_label(tf.name)}}}"
    return _Block(f"{display}{after}", _stem(tf), _FOR_EQUATIONS, title)


def _stem(tf: AnyTransferFunction) -> str:
    """Return a file's name without its suffix, of letters that every file system has."""
    return _plain_stem(tf.name.replace("/", "_over_"))


def _plain_stem(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9_]", "_", name)


def _introduction(tf: AnyTransferFunction) -> str:
    unit = f", in {unit_latex(tf.unit)}" if tf.unit and tf.unit != "1" else ""
    if not tf.is_reduced:
        about = "in nested form; hidden modes were not looked for"
    else:
        zeros, poles = counts_of(tf)
        about = f"with {_counted(zeros, 'zero')} and {_counted(poles, 'pole')}"
        if zeros is None and poles is None:
            about = "with infinitely many zeros and poles"
    return f"\\subsection{{${ratio_latex(tf)}$}}\n\nThe {escape_text(tf.quantity)}{unit}, {about}:\n"


def _counted(count: int | None, noun: str) -> str:
    if count is None:
        return f"infinitely many {noun}s"
    number = _COUNTS[count] if count < len(_COUNTS) else str(count)
    return f"{number} {noun}{'' if count == 1 else 's'}"


def _hidden_mode(
    factor: HiddenFactor, printed: Expression, tf: TransferFunction, writer: Writer, width_mm: float
) -> str:
    """Return a sentence on a factor in s that cancelled."""
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
        if piece.width <= _LONGEST_HIDDEN * width_mm / EM_MM:
            what = f"The factor ${piece.markup}$"
        else:
            what = "A transcendental factor" if is_transcendental else f"A factor of degree {count} in $s$"
        where = f"the {noun} at its {'root' if count == 1 and not is_transcendental else 'roots'}"
    times = "" if factor.multiplicity == 1 else f" {_counted(factor.multiplicity, 'time')}"
    return (
        f"{what} cancels between numerator and denominator{times}: {where} {verb} hidden, that is, "
        "uncontrollable from this input or unobservable in this output."
    )


def _about_roots(tf: AnyTransferFunction, located: PoleZeroMap) -> list[str]:
    if not (located.all_poles or located.zeros or located.hidden):
        return [f"${ratio_latex(tf)}$ has neither poles nor zeros in the region searched."]
    sentences = []
    if shown := region_text(located.region):
        sentences.append(f"Listed are {escape_text(shown)}.")
    for said in filter(None, (located.verdict.sentence, located.verdict.hidden_motion)):
        sentences.append(f"{escape_text(said[:1].upper() + said[1:])}.")
    proved = "Every pole and zero listed is enclosed to the digits printed, and their count is proved."
    reason = escape_text(located.certificate.reason or "no reason given")
    return [*sentences, proved if located.certificate.certified else f"The list is not certified: {reason}."]


def _comment(text: str) -> str:
    """Return text for one comment line."""
    return "".join(c if c.isascii() and c.isprintable() else "?" for c in text)
