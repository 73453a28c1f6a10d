"""Transfer functions as the content of an entry, and back.

An entry holds what is costly to derive. What is read off the equations and the model (names, units,
definitions) is taken from those at hand.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Final

from symflex.cache.exact import Reader, Writer, mapping, nonnegative, nonzero, pick, sequence, text
from symflex.elimination import Closure
from symflex.kernels import NO_KERNELS
from symflex.transfer import ClosedForm, HiddenFactor, TransferFunction
from symflex.transfer.expansion import Expansion, Opening
from symflex.transfer.quantity import name_quantity, unit_of_quotient

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.equations import Equations

SCHEMA: Final = "symflex.derivation/1"


def numbers_in(derived: Sequence[TransferFunction]) -> int:
    """Return about how many exponents and coefficients an entry would hold."""
    total = 0
    for tf in derived:
        closed = [] if tf.closed is None else [tf.closed.num, tf.closed.den]
        shared = [f for v in (*tf.kernels.values, *(tf.parts or ())) for f, _ in v.factors]
        polynomials = [
            *closed,
            *shared,
            *(f for f, _ in (tf.reduced.factors if tf.reduced is not None else ())),
            *(h.polynomial for h in tf.hidden),
        ]
        total += sum(len(p) * (p.context().nvars() + 1) for p in polynomials)
    return total


def entry_content(derived: Sequence[TransferFunction]) -> bytes:
    """Return the content of an entry: JSON."""
    writer = Writer()
    closures: list[Closure] = []
    functions = [_function(writer, closures, tf) for tf in derived]
    rows = [_closure(writer, c) for c in closures]
    document = {"schema": SCHEMA, "functions": functions, "closures": rows, **writer.data}
    return json.dumps(document, separators=(",", ":")).encode()


def read_entry(
    content: bytes, equations: Equations, pairs: Sequence[tuple[str, str]]
) -> tuple[TransferFunction, ...] | None:
    """Return the transfer functions of some pairs, ``None`` where the content is not that of an entry."""
    try:
        document = mapping(json.loads(content))
        if document.get("schema") != SCHEMA:
            return None
        reader = Reader(document)
        expansion = Expansion.of(equations)
        closures = [_read_closure(reader, row) for row in sequence(document.get("closures"))]
        openings = [Opening(closure, expansion) for closure in closures]
        rows = sequence(document.get("functions"), len(pairs))
        return tuple(
            _read_function(reader, openings, row, equations, pair)
            for row, pair in zip(rows, pairs, strict=True)
        )
    except (ValueError, OverflowError, RecursionError):
        return None


def _function(writer: Writer, closures: list[Closure], tf: TransferFunction) -> list[Any]:
    closed = None
    if tf.closed is not None:
        closure = tf.closed.closure
        place = next((i for i, c in enumerate(closures) if c is closure), len(closures))
        if place == len(closures):
            closures.append(closure)
        ring = closure.ring
        num, den = writer.polynomial(ring, tf.closed.num), writer.polynomial(ring, tf.closed.den)
        closed = [place, num, den, None if tf.closed.order is None else list(tf.closed.order)]
    return [
        tf.output.name,
        tf.input.name,
        None if tf.reduced is None else writer.value(tf.reduced),
        closed,
        [[writer.polynomial(tf.ring, h.polynomial), h.multiplicity] for h in tf.hidden],
        None if tf.kernels is NO_KERNELS else writer.table(tf.kernels),
        None if tf.parts is None else [writer.value(part) for part in tf.parts],
    ]


def _closure(writer: Writer, closure: Closure) -> list[Any]:
    sums = [[name, writer.polynomial(closure.base, value)] for name, value in closure.sums]
    return [writer.ring(closure.base), writer.ring(closure.ring), sums]


def _read_closure(reader: Reader, row: object) -> Closure:
    base, ring, sums = sequence(row, 3)
    known = pick(reader.rings, base)
    pairs = [sequence(pair, 2) for pair in sequence(sums)]
    return Closure(
        known,
        pick(reader.rings, ring),
        tuple((text(name), reader.polynomial(value, known)) for name, value in pairs),
    )


def _read_function(
    reader: Reader, openings: list[Opening], row: object, equations: Equations, pair: tuple[str, str]
) -> TransferFunction:
    name, source, position, closed, hidden, table, parts = sequence(row, 7)
    if (name, source) != pair:
        raise ValueError
    model = equations.model
    output = next(o for o in model.outputs if o.name == name)
    given = next(i for i in model.inputs if i.name == source)
    known = dict(model.quotients).get(pair)
    form = None if closed is None else _read_closed(reader, openings, closed)
    reduced = None if position is None else pick(reader.values, position)
    if reduced is not None:
        ring = reduced.ring
    elif form is not None:
        ring = form.opening.expansion.ring
    else:
        raise ValueError
    return TransferFunction(
        output,
        given,
        reduced,
        form,
        tuple(
            HiddenFactor(reader.polynomial(f, ring), nonzero(e))
            for f, e in (sequence(h, 2) for h in sequence(hidden))
        ),
        name_quantity(output, given, known),
        unit_of_quotient(output, given, known),
        equations.ring,
        equations.definitions,
        equations.constants,
        model,
        NO_KERNELS if table is None else pick(reader.tables, table),
        None if parts is None else _read_parts(reader, parts),
    )


def _read_closed(reader: Reader, openings: list[Opening], row: object) -> ClosedForm:
    place, num, den, degrees = sequence(row, 4)
    opening = pick(openings, place)
    ring = opening.closure.ring
    order = None
    if degrees is not None:
        above, below = sequence(degrees, 2)
        order = nonnegative(above), nonnegative(below)
    return ClosedForm(opening, reader.polynomial(num, ring), reader.polynomial(den, ring), order)


def _read_parts(reader: Reader, row: object) -> tuple[Any, Any]:
    num, den = sequence(row, 2)
    return pick(reader.values, num), pick(reader.values, den)
