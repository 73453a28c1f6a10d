"""Reading boundary-value problems along x; what they say is checked in :mod:`symflex.model.boundary`."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from symflex.errors import Span, Text, counted
from symflex.expressions import FUNCTIONS, RECIPROCALS, Equation, Expression, parse_equation
from symflex.model.brackets import open_brackets
from symflex.model.declarations import read_label
from symflex.model.model import FieldProblem
from symflex.model.reading import NAME, Reader
from symflex.model.scope import RESERVED

if TYPE_CHECKING:
    from symflex.model.spec import KeyValue, TableValue

FIELD_LIMIT = 100
UNKNOWN_LIMIT = 12  # as high as a field's order in x may be, :data:`symflex.model.boundary.ORDER_LIMIT`
CONDITION_LIMIT = 200
SPLIT = "split it into several fields, which conditions may join"
KEYS = ("domain", "unknowns", "equation", "equations", "conditions", "latex", "doc")
EXAMPLE = """for instance: domain = ["0", "l"], equation = "E*A*u'' = rho*A*s^2*u", conditions = [...]"""


def read_fields(
    reader: Reader, section: TableValue | None, taken: Collection[str]
) -> tuple[FieldProblem, ...]:
    """Return ``[fields]`` in order; no unknown may bear a name of a parameter, definition or block."""
    fields: list[FieldProblem] = []
    owners: dict[str, str] = {}
    for i, entry in enumerate(section.entries if section else ()):
        if i >= FIELD_LIMIT:
            count = len(section.entries) if section else 0
            message = f"{count} fields; at most {FIELD_LIMIT} are allowed"
            reader.note("SF103", message, entry.key_span, "join parts of equal equations into one field")
            break
        field = _read_field(reader, entry, taken, owners)
        if field is not None:
            fields.append(field)
    return tuple(fields)


def with_brackets_opened(
    reader: Reader, fields: Sequence[FieldProblem], *, has_coordinate: bool
) -> tuple[FieldProblem, ...]:
    """Return fields without brackets with primes; a field with one that cannot be opened is left out."""
    opened_fields = []
    for each in fields:
        every = [u for other in fields for u in other.unknowns]
        opened = [
            [
                open_brackets(e, unknowns, has_coordinate=has_coordinate, is_condition=is_condition)
                for e in equations
            ]
            for equations, unknowns, is_condition in (
                (each.equations, each.unknowns, False),
                (each.conditions, every, True),
            )
        ]
        problems = [p for group in opened for _, noted in group for p in noted]
        reader.take(problems)
        if not problems:
            equations, conditions = (tuple(e for e, _ in group) for group in opened)
            given = (*each.equations, *each.conditions)
            written = given if given != (*equations, *conditions) else ()
            opened_fields.append(replace(each, equations=equations, conditions=conditions, written=written))
    return tuple(opened_fields)


def _read_field(
    reader: Reader, entry: KeyValue, taken: Collection[str], owners: dict[str, str]
) -> FieldProblem | None:
    what = f"field '{entry.key[:64]}'"
    if not reader.name(entry, "a field"):
        return None
    table = reader.table(entry, what, EXAMPLE)
    if table is None:
        return None
    reader.keys(table, KEYS, what)
    unknowns = _unknowns(reader, entry, table, taken, owners)
    domain = _domain(reader, entry, table)
    equations = _equations(reader, entry, table)
    conditions = _conditions(reader, entry, table)
    label, doc = read_label(reader, table, what), reader.plain(table, "doc", what)
    if unknowns is None or domain is None or equations is None or conditions is None:
        return None
    if len(equations) != len(unknowns):
        one, other = counted(len(equations), "equation"), counted(len(unknowns), "unknown")
        hint = "each unknown needs an equation"
        if len(equations) > len(unknowns):
            hint = 'list what the equations determine: unknowns = ["w", "phi"]'
        location = equations[-1].span if equations else entry.key_span
        reader.note("SF242", f"{what} has {one} for {other}", location, hint)
        return None
    return FieldProblem(entry.key, unknowns, *domain, equations, conditions, entry.key_span, label, doc)


def _unknowns(
    reader: Reader, entry: KeyValue, table: TableValue, taken: Collection[str], owners: dict[str, str]
) -> tuple[str, ...] | None:
    """Return the names of the functions of x; ``owners`` keeps which field has which."""
    what, given = f"field '{entry.key}'", table.get("unknowns")
    if given is None:
        texts: tuple[Text, ...] | None = (Text(entry.key, entry.key_span),)
    else:
        texts = reader.strings(given, f"unknowns of {what}", "an array of names")
    if texts is None:
        return None
    location = given.value.span if given else entry.key_span
    if not texts:
        reader.note(
            "SF242", f"{what} has no unknowns", location, "leave the key out to name one as the field"
        )
        return None
    if _few(reader, texts, f"{what} has", "unknowns", UNKNOWN_LIMIT, location) is None:
        return None
    good = True
    for text in texts:
        problem = name_problem(text.value, taken, owners)
        if problem is not None:
            code, message, hint = problem
            reader.note(code, message, text.span, hint)
            good = False
        owners.setdefault(text.value, entry.key)
    return tuple(t.value for t in texts) if good else None


def name_problem(
    name: str, taken: Collection[str], owners: dict[str, str]
) -> tuple[str, str, str | None] | None:
    """Return what is wrong with the name of an unknown: code, message and hint."""
    if not NAME.match(name):
        hint = "names are a letter followed by up to 63 letters, digits and underscores"
        return "SF213", f"'{name[:80]}' is not a name for an unknown", hint
    if name in RESERVED:
        return "SF213", f"'{name}' is reserved and cannot name an unknown", RESERVED[name]
    if name in FUNCTIONS or name in RECIPROCALS:
        return "SF213", f"'{name}' is a function and cannot name an unknown", None
    if name in taken:
        message = f"'{name}' is an unknown and a parameter, definition or block"
        return "SF211", message, "rename one of them"
    if name in owners:
        message = f"'{name}' is an unknown of field '{owners[name]}' already"
        return "SF211", message, 'name the unknowns of each field: unknowns = ["w_2"]'
    return None


def _domain(reader: Reader, entry: KeyValue, table: TableValue) -> tuple[Expression, Expression] | None:
    what, message = f"domain of field '{entry.key}'", f"field '{entry.key}' has no domain"
    given = reader.needed(table, "domain", entry, message, 'for instance domain = ["0", "l"]')
    if given is None:
        return None
    ends = reader.pair(given.value, f"{what} must be an array of its two ends", 'for instance ["0", "l"]')
    if ends is None:
        return None
    start, end = (reader.expression(item, what) for item in ends)
    return None if start is None or end is None else (start, end)


def _equations(reader: Reader, entry: KeyValue, table: TableValue) -> tuple[Equation, ...] | None:
    what = f"field '{entry.key}'"
    one, many = table.get("equation"), table.get("equations")
    if one is not None and many is not None:
        message = f"{what} is given by 'equation' and by 'equations'"
        reader.note("SF242", message, many.key_span, "write all of them under 'equations'")
        return None
    given = one or many
    if given is None:
        reader.note("SF214", f"{what} has no equation", entry.key_span, EXAMPLE)
        return None
    texts: tuple[Text, ...] | None
    if one is not None:
        text = reader.string(one, f"equation of {what}")
        texts = None if text is None else (text,)
    else:
        texts = reader.strings(given, f"equations of {what}", "an array of equations")
    return parsed(reader, _few(reader, texts, f"{what} has", "equations", UNKNOWN_LIMIT, given.value.span))


def _conditions(reader: Reader, entry: KeyValue, table: TableValue) -> tuple[Equation, ...] | None:
    hint = "give as many as its order in x, or conditions = [] when another field has them"
    given = reader.needed(table, "conditions", entry, f"field '{entry.key}' has no conditions", hint)
    if given is None:
        return None
    texts = reader.strings(given, f"conditions of field '{entry.key}'", "an array of equations")
    who = f"field '{entry.key}' has"
    return parsed(reader, _few(reader, texts, who, "conditions", CONDITION_LIMIT, given.value.span))


def _few(
    reader: Reader, texts: tuple[Text, ...] | None, who: str, what: str, limit: int, span: Span
) -> tuple[Text, ...] | None:
    """Return the texts when they are no more than the limit."""
    if texts is None or len(texts) <= limit:
        return texts
    reader.note("SF103", f"{who} {len(texts)} {what}; at most {limit} are allowed", span, SPLIT)
    return None


def parsed(reader: Reader, texts: tuple[Text, ...] | None) -> tuple[Equation, ...] | None:
    """Return the equations that texts hold; None without texts, or when one cannot be read."""
    read = [reader.read(parse_equation, text) for text in texts or ()]
    equations = [equation for equation in read if equation is not None]
    return tuple(equations) if texts is not None and len(equations) == len(texts) else None
