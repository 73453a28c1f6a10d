"""What generated code says about a model, whatever its language: formulas, origins, descriptions.

What a user wrote becomes names that are identifiers, one to one, and text that is inert.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, count
from textwrap import TextWrapper

from symflex.codegen.program.evaluate import nearest_double
from symflex.expressions import Quotient, format_expression, is_number
from symflex.library.elements import LineElement
from symflex.model import Model, ModelParameter
from symflex.print.forms import PrintedForm, print_form
from symflex.print.latex.table import decimal_text
from symflex.transfer import AnyTransferFunction

FORMULA_LENGTH = 1_600  # characters of a formula in a docstring: twenty lines of a terminal's 24
FORMULA_TERMS, KERNEL_TERMS, NESTED_SIZE = 1000, FORMULA_LENGTH // 16, 300
"""Terms up to which a formula is formatted, without kernels and with them (a product of two takes some
twenty characters), and operations up to which a nested form is."""

NAMED = 12  # members of a network that a docstring names: three lines

FOLLOWED = (  # what is said of functions of members that vary along x
    "Waves are followed piece by piece along members whose coefficients vary. The faster they oscillate, the "
    "more pieces there are; beyond a few thousand waves, values are NaN."
)

WIDTH = 88  # columns of generated C, MATLAB and Python


def formula_of(tf: AnyTransferFunction) -> tuple[str, ...]:
    """Return the formula in paragraphs of inert text, or a sentence on it where nobody would read it."""
    if tf.solves_network:
        elements = [e for e in tf.model.elements if isinstance(e.element, LineElement)]
        parts = [f"{e.element.type_name} {e.name}" for e in elements]
        parts += [f"field {f.name}" for f in tf.model.fields]
        more = [f"{len(parts) - NAMED} more"] if len(parts) > NAMED else []
        return (
            inert(f"No formula: the network is solved at every s, {', '.join([*parts[:NAMED], *more])}."),
        )
    form: PrintedForm | None = None  # the shortest, if it is not long
    if not tf.is_reduced:
        form = print_form(tf) if tf.size <= NESTED_SIZE else None
    elif tf.length <= (FORMULA_TERMS if tf.is_rational else KERNEL_TERMS):
        form = print_form(tf)
    elif tf.closed is not None and len(tf.closed.num) + len(tf.closed.den) <= FORMULA_TERMS:
        form = print_form(tf, "definitions")
    if form is not None:
        formula = format_expression(form.num if is_number(form.den, 1) else Quotient(form.num, form.den))
        lines = [inert(f"{tf.name} = {formula}")]
        for i, (symbol, expression) in enumerate(form.where):
            word = "where" if i == 0 else "     "
            lines.append(f"{word} {inert(f'{symbol} = {format_expression(expression)}')}")
        if sum(map(len, lines)) <= FORMULA_LENGTH:
            return tuple(lines)
    return (f"A quotient of {tf.extent} in s, which symflex derive --tf {inert(tf.name)} prints.",)


def origin_lines(model: Model, width: int) -> list[str]:
    """Return title and source of a model in lines of inert text, and an empty one if there are any."""
    lines: list[str] = []
    for word, text in (("Model", model.title), ("Source", model.source)):
        if text.strip():
            lines += wrapped(f"{word}: {inert(text)}", width)
    return [*lines, ""] if lines else []


def described(parameter: ModelParameter, name: str) -> str:
    """Return what a parameter called ``name`` in the code is, with its unit: inert text with a full stop."""
    parts = [inert(parameter.doc).rstrip(".")] if parameter.doc.strip() else []
    parts += [f"'{inert(parameter.name)}' in the model"] if name != parameter.name else []
    text = f"{', '.join(parts) or 'parameter of the model'}"
    text = f"{text} [{inert(parameter.unit)}]." if parameter.unit else f"{text}."
    written = value_as_written(parameter)
    return f"{text} {inert(written)} in the model." if written else text


def value_as_written(parameter: ModelParameter) -> str:
    """Return a value in the unit it was written in, empty where that is the SI unit of the code."""
    value, unit = parameter.as_written()
    if value is None or unit in (parameter.unit, ""):
        return ""
    return f"{decimal_text(value)} {unit}"


def default_value(parameter: ModelParameter) -> str:
    """Return the double nearest to a parameter's value as text, empty without a value; SF233 if none fits."""
    value = parameter.value
    if parameter.is_imaginary:
        return "1j"
    return "" if value is None else repr(nearest_double(value.rational, value.pi_power))


_OUTSIDE = re.compile(r"[^A-Za-z0-9_]")
_PLAIN = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


def identifiers(
    wanted: Mapping[str, str], reserved: Collection[str], longest: int | None = None
) -> Mapping[str, str]:
    """Return an identifier for every key: the text wanted for it where that can be one.

    Any texts may be wanted, the same one twice. ``reserved`` are keywords, and what the generated code uses;
    texts of more than the ``longest`` number of characters are cut. Different keys have different
    identifiers: letters, digits and underscores of ASCII, a letter first.
    """
    chosen: dict[str, str] = {}
    taken = set(reserved)
    for key, text in wanted.items():
        if _PLAIN.fullmatch(text) and text not in taken and text == text[:longest]:
            chosen[key] = text
            taken.add(text)
    for key, text in wanted.items():
        if key not in chosen:
            plain = _OUTSIDE.sub("_", text)
            plain = plain if plain[:1].isalpha() else f"p_{plain.lstrip('_')}"
            for suffix in chain(("", "_"), (f"_{number}" for number in count(2))):
                chosen[key] = (plain if longest is None else plain[: longest - len(suffix)]) + suffix
                if chosen[key] not in taken:
                    break
            taken.add(chosen[key])
    return {key: chosen[key] for key in wanted}


_DIRECTIVE = re.compile(r"(?<!\S)\.\.(?!\S)")
_OPERATOR = re.compile(r"[^*/]+[*/]*|[*/]+")


def inert(text: str) -> str:
    """Return text on one line that can neither end a docstring nor start a doctest or directive in it.

    Line ends become spaces, double quotes single ones, characters that do not print their code points,
    and the marks at which doctest and reStructuredText begin to obey are pulled apart.
    """
    line = " ".join(text.split())
    shown = "".join(c if c.isprintable() else f"<U+{ord(c):04X}>" for c in line).replace('"', "'")
    return _DIRECTIVE.sub(". .", shown.replace(">>>", "> > >"))


@dataclass(frozen=True, slots=True)
class BlockComment:
    r"""How a language spells a comment, and what must not stand in one.

    >>> BlockComment("/*", "*/", " * ", ("??",)).lines(["a */ b ??/", "c\\"])
    ['/* a * / b ? ?/', ' * c\\.', ' */']
    """

    opening: str
    closing: str
    further: str  # begins every line but the first
    marks: tuple[str, ...]  # of two characters each, as its ends may be; they are pulled apart

    def lines(self, texts: Sequence[str]) -> list[str]:
        """Return a comment that nothing in its texts can end; a single text stands on one line."""
        first, *others = map(self.harmless, texts)
        if not others:
            return [f"{self.opening} {first} {self.closing}"]
        further = (f"{self.further}{text}".rstrip() for text in others)
        return [f"{self.opening} {first}", *further, f" {self.closing}"]

    def harmless(self, text: str) -> str:
        """Return a text without what would end the comment, or begin another one."""
        text = text.rstrip()
        for mark in (self.closing, self.opening, *self.marks):
            while mark in text:
                text = text.replace(mark, f"{mark[0]} {mark[1]}")
        # A backslash at the end would join this line with the next one.
        return f"{text}." if text.endswith("\\") else text


def statement_lines(text: str, width: int, indent: str, more: str = "    ") -> list[str]:
    """Return code in lines broken at blanks between operators; all but the first are indented ``more``."""
    wrapper = TextWrapper(width, indent, indent + more, break_long_words=False, break_on_hyphens=False)
    return wrapper.wrap(text)


def wrapped(text: str, width: int, indent: str = "", more: str | None = None) -> list[str]:
    """Return a text as lines of at most ``width`` columns, long products broken after their operators."""
    more = indent if more is None else more
    room = width - max(len(indent), len(more))
    words = " ".join(_broken(word, room) if len(word) > room else word for word in text.split(" "))
    return TextWrapper(
        width=width, initial_indent=indent, subsequent_indent=more, break_on_hyphens=False
    ).wrap(words) or [indent.rstrip()]


def _broken(word: str, room: int) -> str:
    lines = [""]
    for piece in _OPERATOR.findall(word):
        if lines[-1] and len(lines[-1]) + len(piece) > room:
            lines.append("")
        lines[-1] += piece
    return " ".join(lines)
