"""Models of one input and one output whose poles say where a transfer matrix has its poles and zeros.

Input: a model, the names of outputs and inputs.
Output: the same model driven and read in one way: by all inputs at once, or with outputs imposed.

Example: F_1 and F_2 push two carts on springs, X_1 and X_2 are read. With both imposed, by whatever forces
that takes, nothing moves by itself: the matrix has no zero. With X_1 imposed by F_2, the second cart moves as
the first one at rest lets it.

    all at once   F_1 - 17 w = 0 imposed by F_1, F_2 - 29 w = 0 by F_2; read is 5 X_1 + 3 X_2
    imposed       X_1 - 17 w = 0 imposed by F_1, X_2 - 29 w = 0 by F_2; read is 5 F_1 + 3 F_2

The determinant of the equations with outputs imposed is that of the system matrix ``[A B; C D]`` (Rosenbrock
1970): its poles, hidden ones among them, are the invariant zeros. Numbers are drawn so that one input moves
all that moves in one way, and one output shows it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from random import Random

from symflex.expressions import Expression, Name, Negative, Number, product_of, sum_of
from symflex.model import Input, Model, Output

LARGEST_WEIGHT = 97  # of sums of inputs and of outputs
Names = Sequence[str]


def driven_at_once(model: Model, outputs: Names, inputs: Names) -> Model:
    """Return a model in which one input drives all, and one output sums all.

    Each output is an unknown, so that what filters it is a mode of its own.
    """
    given, read, *names = _new_names(model, 2 + len(inputs) + 2 * len(outputs))
    into, kept, shown = names[: len(inputs)], names[len(inputs) : -len(outputs)], names[-len(outputs) :]
    drives = _imposing(into, [Name(name) for name in inputs], given)
    keeps = [
        Output(name, sum_of([e, Negative(Name(unknown))]))
        for name, e, unknown in zip(kept, _read(model, outputs), shown, strict=True)
    ]
    wider = replace(model, inputs=(*model.inputs, *(Input(name, "signal") for name in shown)))
    return _turned(wider, [*drives, *keeps], [*inputs, *shown], given, Output(read, _sum(shown)))


def imposed(model: Model, pairs: Sequence[tuple[str, str]]) -> Model:
    """Return a model in which each pair's input imposes its output, all at once, and all these are summed."""
    given, read, *names = _new_names(model, 2 + len(pairs))
    outputs, inputs = [y for y, _ in pairs], [u for _, u in pairs]
    return _turned(
        model, _imposing(names, _read(model, outputs), given), inputs, given, Output(read, _sum(inputs))
    )


def closed(model: Model, pairs: Sequence[tuple[str, str]]) -> tuple[Model, Names, Names]:
    """Return a model whose loops are closed with minus, with the names of its new inputs and outputs.

    Each pair's input is what is given minus its output. The outputs are the inputs, S, then the outputs, T,
    and then S - T, in order.
    """
    count = len(pairs)
    names = _new_names(model, 5 * count)
    given, laws, read = names[:count], names[count : 2 * count], names[2 * count :]
    outputs, inputs = [y for y, _ in pairs], [u for _, u in pairs]
    fed_back = _read(model, outputs)
    free = [Name(u) for u in inputs]
    shown = [*free, *fed_back, *(sum_of([u, Negative(y)]) for u, y in zip(free, fed_back, strict=True))]
    law = [
        Output(name, sum_of([u, y, Negative(Name(r))]))
        for name, u, y, r in zip(laws, free, fed_back, given, strict=True)
    ]
    whole = replace(
        model,
        inputs=(*(Input(name, "signal") for name in given), *model.inputs),
        outputs=(*(Output(name, e) for name, e in zip(read, shown, strict=True)), *law),
        imposed=tuple((each.name, u) for each, u in zip(law, inputs, strict=True)),
        figures=(),
        published=(),
        tables=(),
    )
    return whole, given, read


def closed_at_once(model: Model, pairs: Sequence[tuple[str, str]]) -> Model:
    """Return a model of one input and one output whose poles are those of the loops closed with minus."""
    given, read, *names = _new_names(model, 2 + len(pairs))
    outputs, inputs = [y for y, _ in pairs], [u for _, u in pairs]
    sums = [sum_of([Name(u), y]) for u, y in zip(inputs, _read(model, outputs), strict=True)]
    return _turned(model, _imposing(names, sums, given), inputs, given, Output(read, _sum(inputs)))


def _imposing(names: Names, values: Sequence[Expression], given: str) -> list[Output]:
    """Return the outputs that are zero where values are what is given, times numbers."""
    weights = _drawn(len(values), 1)
    return [
        Output(name, sum_of([e, Negative(product_of([Number(Fraction(w)), Name(given)]))]))
        for name, e, w in zip(names, values, weights, strict=True)
    ]


def _turned(model: Model, laws: Sequence[Output], free: Names, given: str, read: Output) -> Model:
    return replace(
        model,
        inputs=(Input(given, "signal"), *model.inputs),
        outputs=(read, *laws),
        imposed=tuple((law.name, name) for law, name in zip(laws, free, strict=True)),
        figures=(),
        published=(),
        tables=(),
    )


def _new_names(model: Model, count: int) -> list[str]:
    named = (model.parameters, model.definitions, model.nodes, model.signals, model.elements, model.blocks)
    taken = {each.name for some in (*named, model.fields, model.inputs, model.outputs) for each in some}
    free = (name for name in (f"matrix_{i}" for i in range(len(taken) + count)) if name not in taken)
    return [next(free) for _ in range(count)]


def _read(model: Model, outputs: Names) -> list[Expression]:
    return [next(o.expression for o in model.outputs if o.name == name) for name in outputs]


def _sum(names: Names) -> Expression:
    weights = _drawn(len(names), 2)
    return sum_of(product_of([Number(Fraction(w)), Name(n)]) for w, n in zip(weights, names, strict=True))


def _drawn(count: int, draw: int) -> list[int]:
    """Return numbers that no model has by chance, the same in every run."""
    random = Random(draw)
    return [random.randint(1, LARGEST_WEIGHT) for _ in range(count)]
