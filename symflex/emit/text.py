"""Plain text for a terminal: transfer functions, poles and zeros."""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.emit.forms import PrintedForm, hidden_expressions
from symflex.expressions import Expression, Number, Quotient, format_expression

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.roots import PoleZeroMap, Root
    from symflex.transfer import TransferFunction

WIDTH = 80
INDENT = "  "
SHORTEST = 3
"""A line is not broken before this part of its width."""


def form_text(tf: TransferFunction, form: PrintedForm) -> str:
    """Return ``OUT/IN = num/den`` on one line, and a line per definition used."""
    whole = form.num if _is_one(form.den) else Quotient(form.num, form.den)
    lines = [f"{tf.name} = {format_expression(whole)}"]
    lines += [f"  where {name} = {format_expression(e)}" for name, e in form.where]
    return "\n".join(lines)


def derive_text(tf: TransferFunction, form: PrintedForm, width: int = WIDTH) -> str:
    """Return a transfer function as a fraction, with its definitions and hidden modes.

    Parameters
    ----------
    tf : TransferFunction
        Derived.
    form : PrintedForm
        Its arrangement.
    width : int
        Columns available; longer sums are broken before plus and minus.
    """
    quantity = tf.quantity + (f" [{tf.unit}]" if tf.unit else "")
    lines = [f"{tf.name}   {quantity}, {form.name} form", ""]
    num, den = wrapped(form.num, width - 2), wrapped(form.den, width - 2)
    if _is_one(form.den):
        lines += [INDENT + line for line in num]
    else:
        bar = max(len(line) for line in (*num, *den))
        lines += [INDENT + _placed(line, bar, alone=len(num) == 1) for line in num]
        lines.append(INDENT + "-" * bar)
        lines += [INDENT + _placed(line, bar, alone=len(den) == 1) for line in den]
    lines.append("")
    for word, (name, expression) in zip(_where_words(), form.where, strict=False):
        first, *more = wrapped(expression, width - len(word) - len(name) - 5)
        lines.append(f"{INDENT}{word} {name} = {first}")
        lines += [" " * (len(word) + len(name) + 6) + line for line in more]
    if form.where:
        lines.append("")
    for factor, multiplicity in hidden_expressions(tf):
        times = f", {multiplicity} times" if multiplicity > 1 else ""
        first, *more = wrapped(factor, width - 30)
        lines.append(f"{INDENT}hidden: {first}{' ...' if more else ''} cancelled{times}")
    if tf.hidden:
        lines.append("")
    return "\n".join(lines)


def _where_words() -> Sequence[str]:
    return ["where", *["     "] * 10_000]


def _is_one(expression: Expression) -> bool:
    return isinstance(expression, Number) and expression.value == 1


def _placed(line: str, width: int, *, alone: bool) -> str:
    return line.center(width).rstrip() if alone else line


def wrapped(expression: Expression, width: int) -> list[str]:
    """Return an expression as lines of at most ``width`` columns where it can be broken.

    Lines break before a plus or minus, or after a times, at the outermost level that leaves a line of
    reasonable length.
    """
    text = format_expression(expression)
    places = _break_places(text)
    lines: list[str] = []
    start, indent = 0, ""
    while len(text) - start > width - len(indent):
        room = start + width - len(indent)
        reachable = [(p, cost) for p, cost in places if start + width // SHORTEST <= p <= room]
        if not reachable:
            reachable = [(p, cost) for p, cost in places if p > start][:1]
        if not reachable:
            break
        cut = min(reachable, key=lambda place: (place[1], -place[0]))[0]
        lines.append(indent + text[start:cut].rstrip())
        start, indent = cut, INDENT
    return [*lines, indent + text[start:]]


def _break_places(text: str) -> list[tuple[int, int]]:
    """Return where a line may break, and how deep in parentheses and products that is."""
    places: list[tuple[int, int]] = []
    depth = 0
    for i, character in enumerate(text):
        depth += {"(": 1, ")": -1}.get(character, 0)
        if character in "+-" and text[i - 1 : i] == " " and text[i + 1 : i + 2] == " ":
            places.append((i, 2 * depth))
        elif text[i - 1 : i] == "*":
            places.append((i, 2 * (depth - (character == "(")) + 1))
    return places


def roots_text(found: PoleZeroMap, digits: int) -> str:
    """Return poles and zeros as a table of 80 columns, with the certificate."""
    certificate = found.certificate
    status = "certified" if certificate.certified else f"NOT CERTIFIED: {certificate.reason}"
    lines = [f"{found.tf}   {status}: {certificate.found} of {certificate.counted} roots enclosed"]
    for title, roots in (("poles", found.poles), ("zeros", found.zeros)):
        lines += ["", f"  {title}" + ("" if roots else "  none")]
        lines += _root_table(roots, digits)
    if found.hidden:
        lines += ["", "  hidden (cancelled between numerator and denominator)"]
        lines += _root_table([h.root for h in found.hidden], digits)
    lines += ["", "  radius bounds the distance from the printed value to the root [rad/s]"]
    return "\n".join(lines)


def _root_table(roots: Sequence[Root], digits: int) -> list[str]:
    if not roots:
        return []
    rows = [("", "Re [rad/s]", "Im [rad/s]", "radius", "f [Hz]", "zeta")]
    for root in roots:
        if root.im < 0:
            continue
        printed = root.decimal(digits)
        pair = not root.is_real
        times = f"x{root.multiplicity}" if root.multiplicity > 1 else ""
        zeta = root.damping_ratio()
        flags = ("" if root.certified else "?") + ("|" if root.on_boundary else "")
        rows.append(
            (
                times + flags,
                printed.re,
                ("+-" if pair else "") + printed.im,
                printed.radius,
                f"{root.frequency_hz():.6g}",
                "" if zeta is None else f"{zeta:.6g}",
            )
        )
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return ["  " + "  ".join(c.rjust(w) for c, w in zip(row, widths, strict=True)).rstrip() for row in rows]
