r"""LaTeX labels: an allow-list of commands, so that no label can reach ``\input`` or ``\def``."""

from __future__ import annotations

import re

from symflex.errors import Diagnostic, SpecError, Text

GREEK = (
    "alpha beta gamma delta epsilon varepsilon zeta eta theta vartheta iota kappa lambda mu nu xi pi "
    "varpi rho varrho sigma varsigma tau upsilon phi varphi chi psi omega Gamma Delta Theta Lambda Xi Pi "
    "Sigma Upsilon Phi Psi Omega"
).split()
ACCENTS = "dot ddot bar hat tilde vec check breve acute grave overline underline".split()
FONTS = "mathrm mathit mathbf mathsf mathcal text textrm textit operatorname boldsymbol".split()
SYMBOLS = "ell hbar prime infty star ast circ parallel perp ast dagger cdot times pm mp ldots".split()
ALLOWED_COMMANDS = frozenset((*GREEK, *ACCENTS, *FONTS, *SYMBOLS))
LABEL_LIMIT = 120
LABEL_HINT = r"labels may use letters, digits, _ ^ { }, Greek letters, accents and \mathrm{...}"

_TOKEN = re.compile(r"\\(?P<command>[A-Za-z]+)|\\(?P<space>[,;:! ])|(?P<plain>[A-Za-z0-9_^{}'+\-=/.,()| *])")


def check_label(label: Text) -> str:
    r"""Return the label when it is harmless LaTeX mathematics; SF230 at characters that are not.

    >>> from symflex.errors import Source, Span, Text
    >>> source = Source("a.toml", r"\omega_{p1}")
    >>> check_label(Text(source.text, Span(source, 0, 11)))
    '\\omega_{p1}'
    """
    value = label.value
    if not value or len(value) > LABEL_LIMIT:
        hint = "shorten it" if value else "leave the key out for the usual label"
        raise _refused(label, 0, len(value), f"a LaTeX label has 1 to {LABEL_LIMIT} characters", hint)
    depth = position = 0
    while position < len(value):
        match = _TOKEN.match(value, position)
        if match is None:
            message = f"{value[position]!r} is not allowed in a LaTeX label"
            raise _refused(label, position, position + 1, message)
        command = match["command"]
        if command and command not in ALLOWED_COMMANDS:
            raise _refused(label, match.start(), match.end(), f"\\{command} is not an allowed LaTeX command")
        depth += {"{": 1, "}": -1}.get(match["plain"] or "", 0)
        if depth < 0:
            message = "closing brace without an opening one"
            raise _refused(label, position, position + 1, message, "remove it or add '{'")
        position = match.end()
    if depth:
        raise _refused(label, 0, len(value), "a brace is not closed", "add '}'")
    if not _scripts_are_single(value):
        hint = "put what belongs to one script into braces: k_{a,b}"
        raise _refused(label, 0, len(value), "a subscript or superscript is empty or doubled", hint)
    return value


def _scripts_are_single(value: str) -> bool:
    """Tell whether no atom bears two subscripts or two superscripts and none is empty."""
    used: list[set[str]] = [set()]
    position = 0
    while position < len(value):
        character = value[position]
        if character in "_^":
            following = value[position + 1 : position + 2]
            if character in used[-1] or not following or following in "_^} ":
                return False
            used[-1].add(character)
            if following == "{":
                used.append(set())
            position += 2
            continue
        if character == "{":
            used.append(set())
        elif character == "}":
            used.pop()
        elif not character.isspace():
            used[-1].clear()
        position += 1
    return True


def _refused(label: Text, start: int, end: int, message: str, hint: str = LABEL_HINT) -> SpecError:
    return SpecError(Diagnostic("SF230", message, label.at(start, end), hint))
