r"""Tables of parameters and of poles and zeros, with booktabs and siunitx; long ones break across pages."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Final

from symflex.emit.latex.equation import model_labels
from symflex.emit.latex.text import escape_text, text_width
from symflex.emit.latex.units import quantity_latex, unit_latex

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.model import ExactValue, Model, Parameter
    from symflex.roots import PoleZeroMap, Root

VALUE_DIGITS: Final = 7
"""Significant digits of a value that is not a shorter decimal."""

LINES_PER_PAGE: Final = 40
"""A table with more lines becomes a longtable."""

LONGEST_MEANING: Final = 400
"""Characters of a description that a table prints; a row must fit a page."""

_SETUP: Final = r"\sisetup{per-mode=symbol,group-digits=integer}"
_PI: Final = Fraction("3.14159265358979323846264338327950288419716939937510582097494459230781640628620899")
_LARGEST_PLAIN: Final = 5
_SMALLEST_PLAIN: Final = -4
_ONE_LINE: Final = 22.0
_WRAPPED: Final = r"l>{\raggedright\arraybackslash}p{0.5\linewidth}l"


def parameter_table(model: Model) -> str:
    r"""Return the table of a model's parameters: symbol, meaning, value in SI units.

    Values that are not short decimals are rounded to :data:`VALUE_DIGITS` significant digits; a parameter
    without a value is called symbolic. Needs booktabs, siunitx, longtable and array.
    """
    labels = model_labels(model)
    has_meanings = any(p.doc for p in model.parameters)
    rows = []
    for parameter in model.parameters:
        meaning = (escape_text(_cut(parameter.doc)),) if has_meanings else ()
        rows.append((f"${labels[parameter.name]}$", *meaning, _value(parameter)))
    if has_meanings:
        widest = max(text_width(p.doc) for p in model.parameters)
        columns = "lll" if widest <= _ONE_LINE else _WRAPPED
        lines = sum(1 + int(text_width(_cut(p.doc)) / _ONE_LINE) for p in model.parameters)
        return _table(columns, ("Symbol", "Meaning", "Value"), (rows,), lines)
    return _table("ll", ("Symbol", "Value"), (rows,), len(rows))


def pole_zero_table(found: PoleZeroMap, digits: int = 6) -> str:
    r"""Return the table of poles, zeros and hidden modes: real and imaginary part, frequency, damping ratio.

    A conjugate pair is one row with a plus-minus sign. Needs booktabs, siunitx and longtable.

    Parameters
    ----------
    found : PoleZeroMap
        Certified roots.
    digits : int, optional
        Significant digits.
    """
    groups = (
        ("pole", found.poles),
        ("zero", found.zeros),
        ("hidden", tuple(h.root for h in found.hidden)),
    )
    rows = [[_root_cells(word, root, digits) for root in _one_of_each_pair(roots)] for word, roots in groups]
    flat = [row for group in rows for row in group]
    columns = "l" + "".join(_number_column([row[i] for row in flat]) for i in range(1, 5))
    head = (
        "",
        r"{Re $s$ (\unit{\radian\per\second})}",
        r"{Im $s$ (\unit{\radian\per\second})}",
        r"{Frequency (\unit{\hertz})}",
        "{Damping ratio}",
    )
    return _table(columns, head, [group for group in rows if group], len(flat))


def decimal_text(value: Fraction, digits: int = VALUE_DIGITS, *, is_rounded: bool = False) -> str:
    """Return a rational number as a decimal, without trailing zeros unless it is known to be rounded.

    Examples
    --------
    >>> [decimal_text(Fraction(v)) for v in ("0.11", "2/3", "210000000000", "-4.7e-12", "955377")]
    ['0.11', '0.6666667', '2.1e11', '-4.7e-12', '955377']
    """
    if value == 0:
        return "0"
    sign, size = ("-" if value < 0 else ""), abs(value)
    leading = _decimal_exponent(size)
    count = round(size / Fraction(10) ** (leading - digits + 1))
    if count == 10**digits:
        leading, count = leading + 1, count // 10
    text = str(count)
    if Fraction(count) * Fraction(10) ** (leading - digits + 1) == size and not is_rounded:
        text = text.rstrip("0")
    if _SMALLEST_PLAIN <= leading < 0:
        return f"{sign}0.{'0' * (-leading - 1)}{text}"
    if 0 <= leading <= _LARGEST_PLAIN:
        whole = text[: leading + 1].ljust(leading + 1, "0")
        return f"{sign}{whole}{'.' if len(text) > leading + 1 else ''}{text[leading + 1 :]}"
    return f"{sign}{text[0]}{'.' if len(text) > 1 else ''}{text[1:]}e{leading}"


def _decimal_exponent(value: Fraction) -> int:
    estimate = math.floor((value.numerator.bit_length() - value.denominator.bit_length()) * math.log10(2))
    while value >= Fraction(10) ** (estimate + 1):
        estimate += 1
    while value < Fraction(10) ** estimate:
        estimate -= 1
    return estimate


def _cut(text: str) -> str:
    return text if len(text) <= LONGEST_MEANING else f"{text[:LONGEST_MEANING]}\u2026"


def _value(parameter: Parameter) -> str:
    if parameter.value is None:
        unit = parameter.unit
        return f"symbolic, in {unit_latex(unit)}" if unit and unit != "1" else "symbolic"
    return quantity_latex(decimal_text(_rational(parameter.value)), parameter.unit)


def _rational(value: ExactValue) -> Fraction:
    """Return the value with pi to eighty digits."""
    return value.rational * _PI**value.pi_power


@dataclass(frozen=True, slots=True)
class _Entry:
    """A root to print, alone or for its pair."""

    root: Root
    is_pair: bool


def _one_of_each_pair(roots: Sequence[Root]) -> list[_Entry]:
    """Return every root once, a conjugate pair as the member above the real axis."""
    lower = [r for r in roots if r.im < 0]
    entries = []
    for root in roots:
        if root.im > 0:
            partner = next((r for r in lower if r.im.overlaps(-root.im) and r.re.overlaps(root.re)), None)
            if partner is not None:
                lower.remove(partner)
            entries.append(_Entry(root, partner is not None))
        elif not root.im < 0:
            entries.append(_Entry(root, is_pair=False))
    return entries + [_Entry(root, is_pair=False) for root in lower]


def _root_cells(word: str, entry: _Entry, digits: int) -> tuple[str, ...]:
    root = entry.root
    decimals = root.decimal(digits)
    times = rf" ($\times {root.multiplicity}$)" if root.multiplicity > 1 else ""
    damping = root.damping_ratio()
    imaginary = rf"\pm {decimals.im}" if entry.is_pair else decimals.im
    ratio = "{--}"
    if damping is not None:
        ratio = decimal_text(Fraction(damping), digits, is_rounded=not root.is_real)
    frequency = decimal_text(Fraction(root.frequency_hz()), digits, is_rounded=True)
    return word + times, decimals.re, imaginary, frequency, ratio


def _number_column(cells: Sequence[str]) -> str:
    """Return an S column wide enough for its numbers."""
    numbers = [cell for cell in cells if not cell.startswith("{")]
    signed = any(cell.startswith(("-", r"\pm")) for cell in numbers)
    whole = places = exponent = 0
    negative_exponent = False
    for cell in numbers:
        mantissa, _, power = cell.removeprefix(r"\pm ").removeprefix("-").partition("e")
        before, _, after = mantissa.partition(".")
        whole, places = max(whole, len(before)), max(places, len(after))
        exponent = max(exponent, len(power.removeprefix("-")))
        negative_exponent = negative_exponent or power.startswith("-")
    power = f"e{'-' if negative_exponent else ''}{exponent}" if exponent else ""
    return f"S[table-format={'+' if signed else ''}{max(whole, 1)}.{places}{power}]"


def _table(columns: str, head: Sequence[str], groups: Sequence[Sequence[Sequence[str]]], lines: int) -> str:
    """Return a table of groups of rows with a rule between them."""
    title = " & ".join(head) + r" \\"
    body = "\n    \\midrule\n".join(
        "\n".join(f"    {' & '.join(row)} \\\\" for row in group) for group in groups if group
    )
    if lines > LINES_PER_PAGE:
        return (
            f"\\begingroup{_SETUP}\n\\begin{{longtable}}{{{columns}}}\n    \\toprule\n    {title}\n"
            "    \\midrule\n    \\endhead\n    \\bottomrule\n    \\endfoot\n"
            f"{body}\n\\end{{longtable}}\n\\endgroup"
        )
    return (
        f"{{\\centering{_SETUP}\n  \\begin{{tabular}}{{{columns}}}\n    \\toprule\n    {title}\n"
        f"    \\midrule\n{body}\n    \\bottomrule\n  \\end{{tabular}}\\par}}"
    )
