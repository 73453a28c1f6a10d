"""Reading blocks; a ``model`` block resolves another specification."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import isqrt
from pathlib import Path
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE
from symflex.budget import spend
from symflex.errors import Source, SymflexError, Text
from symflex.expressions import (
    Expression,
    Name,
    Negative,
    Number,
    Product,
    is_number,
    negative,
    power,
    product_of,
    sum_of,
)
from symflex.library.blocks import BLOCKS, MODEL_BLOCK, Block
from symflex.library.elements import ELEMENTS
from symflex.library.words import hint_of_type
from symflex.model.analysis import named_pairs, pick_tf
from symflex.model.linearity import EXPONENT_LIMIT
from symflex.model.model import Model, NamedExpressions, PlacedBlock
from symflex.model.reading import Reader, has_ports, signed_number
from symflex.model.scope import RESERVED
from symflex.model.spec import ArrayValue, NumberValue, StringValue, TableValue, parse_with_recovery, read
from symflex.model.units import lower

if TYPE_CHECKING:
    from symflex.model.settings import Setting
    from symflex.model.spec import KeyValue, Value

NESTING_LIMIT = 8
DECLARATION = "symflex"
ALLOW_HINT = "--allow-outside FOLDER, in Python allow_outside, lets model blocks read another folder"
BLOCK_LIMIT = 100  # ``model`` blocks in all: files of two blocks each would double them at every level


@dataclass(slots=True)
class Loads:
    """What one run has read for ``model`` blocks: a file is read once, and blocks are bounded in number."""

    models: dict[Path, Model] = field(default_factory=dict)  # by file, those that were resolved
    # Files with mistakes, which are reported where they are first read.
    failed: set[Path] = field(default_factory=set)
    # By file, how many ``model`` blocks it holds, counted with those inside them.
    blocks: dict[Path, int] = field(default_factory=dict)
    # Resolved folders that may be read, with their subfolders; the first is that of the outermost file.
    folders: tuple[Path, ...] = ()
    # What parameters are, in whichever file they are declared, instead of what is declared.
    settings: Mapping[str, Setting] = field(default_factory=dict)

    @staticmethod
    def of(
        source: Source, allow_outside: Iterable[str | Path], settings: Mapping[str, Setting] | None = None
    ) -> Loads:
        """Return what a specification may read besides itself: what stands in its folder, or is allowed."""
        folders = (Path(source.name).parent.resolve(), *(Path(folder).resolve() for folder in allow_outside))
        return Loads(folders=folders, settings=settings or {})


@dataclass(frozen=True, slots=True)
class Origin:
    """Where a specification stands, which ones led to it, what was read, and how nested ones are resolved."""

    source: Source
    ancestors: tuple[Path, ...]
    loads: Loads
    resolve: Callable[[Source, tuple[Path, ...], Loads], Model]


def read_blocks(reader: Reader, section: TableValue | None, origin: Origin) -> tuple[PlacedBlock, ...]:
    """Return the blocks in order."""
    return reader.entries(section, "a block", lambda entry: _read_block(reader, entry, origin), RESERVED)


def _read_block(reader: Reader, entry: KeyValue, origin: Origin) -> PlacedBlock | None:
    what = f"block '{entry.key}'"
    if isinstance(entry.value, StringValue):
        formula = reader.expression(entry.value, what)
        if formula is None:
            return None
        ratio = (("num", formula), ("den", signed_number(Fraction(1))))
        return PlacedBlock(entry.key, BLOCKS["tf"], ratio, span=entry.key_span)
    table = reader.table(entry, what, 'for instance { type = "integrator" }')
    if table is None:
        return None
    block = BLOCKS["tf"]  # a numerator needs no type
    if table.get("type") is not None or table.get("num") is None:
        types = ", ".join((*BLOCKS, MODEL_BLOCK))
        kind = reader.needed(table, "type", entry, f"{what} has no type", f"block types: {types}")
        text = reader.string(kind, f"type of {what}") if kind else None
        if text is None:
            return None
        if text.value == MODEL_BLOCK:
            return _read_model_block(reader, entry, table, origin)
        if text.value not in BLOCKS:
            hint = hint_of_type(text.value, (*BLOCKS, MODEL_BLOCK), ELEMENTS, "an element, of [elements]")
            message = f"unknown block type '{text.value[:60]}'"
            reader.note("SF216", message, text.span, hint or f"types: {types}")
            return None
        block = BLOCKS[text.value]
        if has_ports(table):
            return None  # its outputs are signals
    values = _read_values(reader, entry, table, block)
    if values is not None and block.kernel_time and is_number(lower(values[0][1]), 0):
        # Without delay it is rational: a lag of no time.
        block, values = BLOCKS["lag"], (("k", signed_number(Fraction(1))), *values)
    return None if values is None else PlacedBlock(entry.key, block, values, span=entry.key_span)


def _read_values(reader: Reader, entry: KeyValue, table: TableValue, block: Block) -> NamedExpressions | None:
    keys = ("type", "doc", *(p.name for p in block.parameters))
    meant = reader.keys(table, keys, f"{block.type_name} '{entry.key}'")
    values: list[tuple[str, Expression]] = []
    complete = True
    is_matrix = block.type_name == "ss"
    for parameter in block.parameters:
        where = f"{parameter.name} of {block.type_name} '{entry.key}'"
        given = table.get(parameter.name)
        if given is not None and is_matrix:
            size = sum(name.startswith("A[") for name, _ in values)
            entries = _matrix(reader, given.value, parameter.name, where, isqrt(size))
            values += entries or ()
            complete = complete and entries is not None
            continue
        if given is not None:
            expression = _value(reader, given.value, where, coefficients=block.type_name == "tf")
        elif parameter.default is not None:
            expression = signed_number(Fraction(parameter.default))
        else:
            expression = None
            names = ", ".join(p.name for p in block.parameters)
            message = f"{block.type_name} '{entry.key}' lacks {parameter.name}, {parameter.doc}"
            if parameter.name not in meant:
                reader.note("SF214", message, entry.key_span, f"parameters of {block.type_name}: {names}")
        if expression is None:
            complete = False
        else:
            values.append((parameter.name, expression))
    return tuple(values) if complete else None


def _value(reader: Reader, value: Value, where: str, *, coefficients: bool) -> Expression | None:
    """Return an expression; a list of coefficients, highest power first, becomes a polynomial in s."""
    if not (coefficients and isinstance(value, ArrayValue)):
        return reader.expression(value, where)
    rows = [item.items for item in value.items if isinstance(item, ArrayValue)]
    if len(rows) == len(value.items) and (len(rows) == 1 or all(len(row) == 1 for row in rows)):
        # A matrix of one row or column, as ``scipy.signal.ss2tf`` returns.
        value = replace(value, items=tuple(x for row in rows for x in row))
    if not value.items:
        reader.note("SF206", f"{where} is an empty list of coefficients", value.span)
        return None
    if len(value.items) > EXPONENT_LIMIT + 1:
        message = f"{where} has {len(value.items)} coefficients; at most {EXPONENT_LIMIT + 1} are allowed"
        reader.note("SF103", message, value.span, "write a product of blocks of lower order")
        return None
    items = [reader.expression(item, where) for item in value.items]
    parts = [None if part is None else lower(part) for part in items]
    terms = [
        _term(part, degree)
        for degree, part in zip(range(len(parts) - 1, -1, -1), parts, strict=True)
        if part is not None
    ]
    return sum_of(terms) if len(terms) == len(parts) else None


def _matrix(reader: Reader, value: Value, name: str, where: str, size: int) -> NamedExpressions | None:
    """Return the entries of a matrix of ``ss``, ``A[1][2]``; ``size`` is that of A, 0 if it is not known."""
    size = len(items_of(value)) if name == "A" else size
    shape = {"A": (size, size), "B": (size, 1), "C": (1, size), "D": (1, 1)}[name]
    # Where A is wrong, and told so, nothing fits.
    rows = matrix_rows(reader, value, where, shape) if size or name == "A" else None
    if rows is None or name == "D":
        return None if rows is None else (("D", rows[0][0]),)
    if name == "A":
        return tuple((f"A[{i}][{j}]", x) for i, row in enumerate(rows, 1) for j, x in enumerate(row, 1))
    return tuple((f"{name}[{i}]", x) for i, x in enumerate((x for row in rows for x in row), 1))


def items_of(value: Value) -> tuple[Value, ...]:
    """Return the items of an array, and anything else as the only one."""
    return value.items if isinstance(value, ArrayValue) else (value,)


def matrix_rows(
    reader: Reader, value: Value, where: str, wanted: tuple[int, int]
) -> list[list[Expression]] | None:
    """Return a matrix of so many rows and columns."""
    # A column or row may be written as one array, what has one entry as that, and a matrix of zeros as 0.
    rows = [items_of(row) for row in items_of(value)]
    if len(rows) > EXPONENT_LIMIT:
        message = f"{where} has {len(rows)} rows; at most {EXPONENT_LIMIT} are allowed"
        reader.note("SF103", message, value.span, "write its equations in [equations]")
        return None
    if isinstance(value, NumberValue) and not value.value:
        rows = [(value,) * wanted[1]] * wanted[0]
    entries = [x for row in rows for x in row]
    is_flat = all(len(row) == 1 for row in rows) and not where.startswith("A ")
    columns = {len(row) for row in rows}
    fits = columns == {wanted[1]} and len(rows) == wanted[0]
    if not entries or not (fits or (is_flat and len(entries) == max(wanted) and min(wanted) == 1)):
        found = (
            f"{len(rows)} x {min(columns)}" if entries and len(columns) == 1 else "rows of several lengths"
        )
        found = f"{len(entries)} entries" if is_flat else found
        size = "square" if where.startswith("A ") and found[0] == "r" else f"{wanted[0]} x {wanted[1]}"
        hint = 'several inputs and outputs are listed: from = ["u_1", "u_2"], to = ["y_1", "y_2"]'
        hint_here = None if where.startswith("A ") or is_flat else hint
        reader.note("SF206", f"{where} must be {size}, found {found}", value.span, hint_here)
        return None
    read = [x for x in (reader.expression(x, where) for x in entries) if x is not None]
    if len(read) < len(entries):
        return None
    return [read[i : i + wanted[1]] for i in range(0, len(read), wanted[1])]


def _term(coefficient: Expression, degree: int) -> Expression:
    """Return a coefficient times a power of s; a 1 stays, as its unit is open and that of s^2 is not."""
    factor = power(Name(LAPLACE), Number(Fraction(degree)))
    term = product_of([coefficient, factor])
    if not degree or term not in (factor, negative(factor)):
        return term
    one = Product((Number(Fraction(1)), factor))
    return one if term == factor else Negative(one)


def _read_model_block(
    reader: Reader, entry: KeyValue, table: TableValue, origin: Origin
) -> PlacedBlock | None:
    what = f"block '{entry.key}'"
    reader.keys(table, ("type", "spec", "tf", "doc"), what)
    hint = 'spec = "file.toml", tf = "OUT/IN"'
    given = [reader.needed(table, key, entry, f"{what} lacks {key}", hint) for key in ("spec", "tf")]
    path_text, tf_text = (reader.string(each, f"{each.key} of {what}") if each else None for each in given)
    if path_text is None or tf_text is None:
        return None
    submodel = _load(reader, path_text, origin)
    if submodel is None:
        return None
    where = f" in '{path_text.value}'"
    tf = pick_tf(reader, tf_text.value, tf_text.span, named_pairs(submodel), where)
    return None if tf is None else PlacedBlock(entry.key, None, (), submodel, tf, entry.key_span)


def _load(reader: Reader, path_text: Text, origin: Origin) -> Model | None:
    if "\0" in path_text.value:
        reader.note("SF901", "a path cannot contain a NUL character", path_text.span)
        return None
    shown = Path(origin.source.name).parent / path_text.value
    try:
        path = shown.resolve()
    except (OSError, RuntimeError):  # a circle of symbolic links
        reader.note("SF901", f"cannot read '{path_text.value}': the path leads in a circle", path_text.span)
        return None
    if not any(path.is_relative_to(folder) for folder in origin.loads.folders):
        message = f"'{path_text.value}' is not in the folder of the specification or one of its subfolders"
        reader.note("SF258", message, path_text.span, ALLOW_HINT)
        return None
    if path in origin.ancestors:
        circle = " -> ".join(p.name for p in (*origin.ancestors, path))
        reader.note("SF215", f"specifications refer to each other in a circle: {circle}", path_text.span)
        return None
    if len(origin.ancestors) >= NESTING_LIMIT:
        message = f"model blocks are nested deeper than {NESTING_LIMIT}"
        hint = "copy the innermost models into the files that use them"
        reader.note("SF103", message, path_text.span, hint)
        return None
    loads, outer = origin.loads, origin.ancestors[-1]
    if path not in loads.models and path not in loads.failed:
        try:
            source = _read(reader, shown, path_text)
            if source is not None:
                loads.models[path] = origin.resolve(source, (*origin.ancestors, path), loads)
        except SymflexError as error:
            spend()
            if path.is_relative_to(loads.folders[0]):
                reader.take(d if d.span else replace(d, span=path_text.span) for d in error.diagnostics)
            else:
                count = len(error.diagnostics)
                message = f"'{path_text.value}' is invalid: {count} problem{'s' if count > 1 else ''}"
                reader.note("SF258", message, path_text.span, "run 'symflex check' on that file to see which")
        if path not in loads.models:
            loads.failed.add(path)
    loads.blocks[outer] = loads.blocks.get(outer, 0) + 1 + loads.blocks.get(path, 0)
    if loads.blocks[outer] > BLOCK_LIMIT:
        message = f"more than {BLOCK_LIMIT} model blocks, including nested ones"
        hint = "name a product of them once and use that name"
        reader.note("SF103", message, path_text.span, hint)
        return None
    return loads.models.get(path)


def _read(reader: Reader, path: Path, said: Text) -> Source | None:
    """Return the text of a file that says it is a specification; of any other, messages show nothing."""
    try:
        source = read(path)
    except SymflexError as error:
        reader.take(replace(d, span=said.span) for d in error.diagnostics)
        return None
    if parse_with_recovery(source)[0].root.get(DECLARATION) is None:
        message = f"'{said.value}' is not a specification: it does not declare {DECLARATION}"
        reader.note("SF258", message, said.span, f"a specification begins with {DECLARATION} = 1")
        return None
    return source
