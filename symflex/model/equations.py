"""Reading ``[equations]``: linear equations of motion as they stand on paper, as many as unknowns.

Input: the section. Output: a :class:`~symflex.model.model.Signal` for each unknown, whose expression is an
equation; which equation an unknown is listed with does not matter.

    unknowns  = ["x", "theta"]
    equations = ["(M + m)*s^2*x + m*l*s^2*theta = F", "s^2*x + l*s^2*theta - g*theta = 0"]
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.errors import counted, nearest
from symflex.expressions import Attribute, Equation, Name, names
from symflex.model.fields import name_problem, parsed
from symflex.model.model import Signal

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Sequence

    from symflex.expressions import Expression
    from symflex.model.reading import Reader
    from symflex.model.spec import TableValue

KEYS = ("unknowns", "equations", "doc")
EXAMPLE = 'for instance: unknowns = ["x"], equations = ["m*s^2*x + k*x = F"]'


def read_equations(
    reader: Reader, section: TableValue | None, taken: Collection[str], signals: Collection[str]
) -> tuple[Signal, ...]:
    """Return the unknowns of ``[equations]``; ``taken`` names parameters, definitions and blocks."""
    if section is None:
        return ()
    what = "[equations]"
    reader.keys(section, KEYS, what, EXAMPLE)
    entries = {key: section.get(key) for key in KEYS[:2]}
    for key, entry in entries.items():
        if entry is None and all(e.key in KEYS for e in section.entries):
            place = section.entries[0].key_span if section.entries else section.span
            reader.note("SF214", f"{what} has no {key}", place, EXAMPLE)
    named, written = entries["unknowns"], entries["equations"]
    if named is None or written is None:
        return ()
    texts = reader.strings(named, f"unknowns of {what}", "an array of names")
    equations = parsed(reader, reader.strings(written, f"equations of {what}", "an array of equations"))
    if texts is None or equations is None:
        return ()
    owners = dict.fromkeys(signals, "signals")
    good = True
    for text in texts:
        problem = name_problem(text.value, taken, {})
        if problem is None and text.value in owners:
            again = "is named twice" if not owners[text.value] else "is a signal already"
            problem = "SF211", f"the unknown '{text.value}' {again}", "rename one of them"
        if problem is not None:
            code, message, hint = problem
            reader.note(code, message, text.span, hint)
            good = False
        owners.setdefault(text.value, "")
    if good and len(texts) != len(equations):
        message = f"{what} has {counted(len(equations), 'equation')} for {counted(len(texts), 'unknown')}"
        more = len(equations) > len(texts)
        hint = "list in 'unknowns' what the equations determine" if more else "each unknown needs an equation"
        spare = equations[len(texts)].span if more else texts[len(equations)].span
        reader.note("SF242", message, spare, hint)
        return ()
    if not good:
        return ()
    pairs = zip(texts, equations, strict=True)
    return tuple(Signal(text.value, equation, text.span) for text, equation in pairs)


def check_unknowns(reader: Reader, signals: Sequence[Signal], others: Iterable[Expression]) -> None:
    """Note every unknown of ``[equations]`` that no equation holds, nor anything else that acts."""
    unknowns = [x for x in signals if isinstance(x.expression, Equation)]
    everything = (*(x.expression for x in signals), *others)
    used = {
        n.owner if isinstance(n, Attribute) else n.name
        for e in (everything if unknowns else ())
        for n in names(e)
        if isinstance(n, Name | Attribute)
    }
    for unknown in unknowns:
        if unknown.name not in used:
            hint = nearest(unknown.name, used) or "leave it out, together with one equation"
            message = f"no equation contains the unknown '{unknown.name}'"
            reader.note("SF242", message, unknown.span, hint)
