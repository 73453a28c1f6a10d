"""Labels: how outputs, inputs, units and frequencies are written in a figure."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from matplotlib.mathtext import MathTextParser

from symflex.model.labels import GREEK
from symflex.print.label import read_label

if TYPE_CHECKING:
    from symflex.model import Input, Output
    from symflex.transfer import TransferFunction

_PARSER: Final = MathTextParser("path")
_TRAILING_DIGITS: Final = re.compile(r"(?P<stem>[A-Za-z]+)(?P<digits>\d+)")
_UNIT_TOKEN: Final = re.compile(
    r"\^\((?P<fraction>[^)]*)\)|\^(?P<power>-?\d+)|(?P<name>[A-Za-z]+)|(?P<other>.)"
)
PLAIN_LOW, PLAIN_HIGH = 1e-3, 1e5


def label_of_tf(tf: TransferFunction) -> str:
    """Return ``output/input`` in matplotlib's mathematics."""
    return f"${label_of(tf.output)}/{label_of(tf.input)}$"


def label_of(end: Output | Input) -> str:
    """Return the label of an output or input, without dollar signs.

    The model's own label is taken when it is sound LaTeX that matplotlib can typeset, else one made from the
    name.
    """
    label = end.latex.strip()
    if label and read_label(label) is not None and _is_typeset(label):
        return f"{{{label}}}"
    return label_of_name(end.name)


def label_of_name(name: str) -> str:
    r"""Return a name in mathematics: words upright, Greek letters as such, what follows ``_`` as subscript.

    Examples
    --------
    >>> print(label_of_name("X_tip"), label_of_name("omega_p1"), label_of_name("x2"), label_of_name("y_s"))
    X_{\mathrm{tip}} \omega_{\mathrm{p1}} x_{2} y_{s}
    """
    head, *subscripts = [part for part in name.split("_") if part]
    digits = _TRAILING_DIGITS.fullmatch(head)
    if digits and not subscripts:
        head, subscripts = digits["stem"], [digits["digits"]]
    if not subscripts:
        return _word(head)
    return f"{_word(head)}_{{{','.join(_word(part) for part in subscripts)}}}"


def _word(word: str) -> str:
    if word in GREEK:
        return f"\\{word}"
    return word if len(word) == 1 or word.isdigit() else rf"\mathrm{{{word}}}"


def _is_typeset(label: str) -> bool:
    try:
        _PARSER.parse(f"${{{label}}}$")
    except ValueError:
        return False
    return True


def label_of_unit(unit: str) -> str:
    r"""Return a unit in upright mathematics, empty for a pure or unknown one.

    Examples
    --------
    >>> print(label_of_unit("m/(N*s^2)"))
    $\mathrm{m/(N\,s^{2})}$
    """
    if unit in ("", "1"):
        return ""
    parts = []
    for token in _UNIT_TOKEN.finditer(unit):
        power = token["fraction"] or token["power"]
        if power:
            parts.append(f"^{{{power}}}")
        elif token["name"]:
            parts.append(r"\Omega" if token["name"] == "Ohm" else token["name"])
        else:
            parts.append(r"\," if token["other"] == "*" else token["other"])
    return rf"$\mathrm{{{''.join(parts)}}}$"


def label_of_frequency(value: float) -> str:
    """Return a number on a logarithmic axis, written out where that is short.

    Examples
    --------
    >>> [label_of_frequency(f) for f in (0.1, 20, 1e6)]
    ['0.1', '20', '$10^{6}$']
    """
    if PLAIN_LOW <= value < PLAIN_HIGH:
        return f"{value:g}"
    mantissa, exponent = f"{value:.0e}".split("e")
    power = f"10^{{{int(exponent)}}}"
    return f"${power}$" if mantissa == "1" else rf"${mantissa}\!\cdot\!{power}$"
