"""The models of a report beside each other, as a computed table.

A new column is a function of :class:`~symflex.report.facts.ModelFacts` and a line in :data:`COLUMNS`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from math import inf
from typing import Final

from symflex.errors import counted
from symflex.report.document import (
    Aside,
    Badge,
    Cell,
    Code,
    PageLink,
    Paragraph,
    Run,
    Section,
    Side,
    Table,
    columns,
    text,
)
from symflex.report.facts import ModelFacts, TransferFacts
from symflex.report.structure import PLACES

NONE: Final = "–"
ANCHOR: Final = "comparison"


def model_cell(facts: ModelFacts) -> Cell:
    """Return the model's file and a link to its chapter."""
    return (PageLink(facts.stem, f"#{facts.stem}"),)


def flexibility_cell(facts: ModelFacts) -> Iterator[Run]:
    """Return which kinds of flexibility a model describes."""
    for location in PLACES:
        parts = [c for c in facts.compliances if c.place == location]
        if parts:
            how = "bending" if all(c.is_bending for c in parts) else "axial or torsional"
            yield from (location, " ", Aside(how), "\n")


def modes_cell(facts: ModelFacts) -> Cell:
    """Return the number of flexible modes."""
    is_infinite = any(f.is_infinite for f in facts.functions)
    return ("∞" if is_infinite else str(max((f.modes for f in facts.functions), default=0)),)


def added_cell(facts: ModelFacts) -> Iterable[Run]:
    """Return the poles and zeros that each flexible mode adds to the rigid system."""
    runs: list[Run] = []
    for function in representatives(facts):
        if function.added is None or not function.modes:
            continue
        zeros, poles = function.added
        where = {True: ", colocated", False: ", noncolocated", None: ""}[function.colocated]
        is_even = not (poles % function.modes or zeros % function.modes)
        per, of = (function.modes, "") if is_even else (1, f" in {counted(function.modes, 'mode')}")
        each = f"{counted(poles // per, 'pole')}, {counted(zeros // per, 'zero')}{of}"
        runs += [each, "\n", Aside(function.tf + where), "\n"]
    if not runs and any(f.modes and f.rigid and f.rigid[0] is None for f in facts.functions):
        return (NONE, "\n", Aside("no response when rigid"))
    return runs


def phase_cell(facts: ModelFacts) -> Iterator[Run]:
    """Return which functions are minimum phase, and for which values of the parameters."""
    for function in representatives(facts):
        yield from (Code(function.tf), " ", *phase_runs(function), "\n")


def both_cell(facts: ModelFacts) -> Cell:
    """Return whether a model has colocated and noncolocated transfer functions."""
    kinds = {f.colocated for f in facts.functions} - {None}
    if kinds == {True, False}:
        return (Badge("both", "good"),)
    return ("colocated only" if kinds == {True} else "noncolocated only" if kinds else NONE,)


def together_cell(facts: ModelFacts) -> Iterator[Run]:
    """Return up to which frequency outputs elsewhere move with colocated ones."""
    for pair in facts.colocations:
        end = f"{pair.bandwidth_hz:.4g} Hz" if pair.bandwidth_hz else f"over {pair.examined_hz:.4g} Hz"
        yield from (end if pair.is_together else "not at all", " ", Aside(pair.tf), "\n")


def data_cell(facts: ModelFacts) -> Iterator[Run]:
    """Return how far a model is off measured responses."""
    for misfit in facts.data:
        source = Aside(f"{misfit.tf}, synthetic data" if misfit.is_synthetic else misfit.tf)
        yield from (f"{misfit.decibels:.3g} dB, {misfit.degrees:.3g}° rms", "\n", source, "\n")


def loop_cell(facts: ModelFacts) -> Iterator[Run]:
    """Return for which gains a loop is stable."""
    for loop in facts.loops:
        for low, high in loop.stable:
            above = "" if not low else f"{_short(low)} < "
            unit = f" {loop.unit}" if loop.unit else ""
            below = "" if high is None else f" < {_short(high)}{unit}"
            yield from (f"{above}{loop.gain}{below}" if above or below else f"all {loop.gain} > 0", "\n")
        if not loop.stable:
            yield from (f"no {loop.gain}", "\n")


def _short(value: float) -> str:
    """Return a number with four digits, without an exponent where one would be harder to read."""
    return f"{value:.0f}" if 1e4 <= abs(value) < 1e7 else f"{value:.4g}"  # noqa: PLR2004


def bandwidth_cell(facts: ModelFacts) -> Iterator[Run]:
    """Return the gain crossover a loop allows with a gain margin of 6 dB."""
    for loop in facts.loops:
        if loop.bandwidth_hz == inf:
            yield from ("no limit", "\n")
        elif loop.bandwidth_hz is not None:
            at_least = "" if loop.is_bandwidth_limited else "≥ "
            yield from (f"{at_least}{loop.bandwidth_hz:.4g} Hz", "\n")


ComparisonColumn = tuple[Callable[[ModelFacts], Iterable["Run"]], Side]
"""What returns the cell of a model's row, lines that end, and how its column stands."""
COLUMNS: dict[str, ComparisonColumn] = {  # columns of the table of structures, by their heads and in order
    "Model": (model_cell, "plain"),
    "Flexibility": (flexibility_cell, "text"),
    "Modes": (modes_cell, "number"),
    "Added by each mode": (added_cell, "plain"),
    "Minimum phase": (phase_cell, "text"),
    "Colocated or not": (both_cell, "text"),
}
DATA_COLUMNS: dict[str, ComparisonColumn] = {  # columns of the table of models with measured responses
    "Model": (model_cell, "plain"),
    "Off the data by": (data_cell, "text"),
}
LOOP_COLUMNS: dict[str, ComparisonColumn] = {
    "Model": (model_cell, "plain"),
    "Outputs together up to": (together_cell, "text"),
    "Loop stable for": (loop_cell, "text"),
    "Crossover allowed": (bandwidth_cell, "text"),
}  # columns of what matters to control: models with loops, or with outputs here and elsewhere


def comparison_section(models: Sequence[ModelFacts]) -> Section | None:
    """Return the table of models, None for fewer than two."""
    if len(models) < 2:  # noqa: PLR2004 - one model compares with nothing
        return None
    structures = [facts for facts in models if not facts.loops]
    compared = [facts for facts in models if facts.data]
    controlled = [facts for facts in models if facts.loops or facts.colocations]
    chosen = ((structures, COLUMNS), (compared, DATA_COLUMNS), (controlled, LOOP_COLUMNS))
    tables = [_table(rows, heads) for rows, heads in chosen if rows]
    explained: tuple[Paragraph, ...] = (
        text(
            "Poles and zeros are counted with multiplicity, and compared with those of the same model with "
            "all its springs and massless beams made rigid (exact limits). For beams and other distributed "
            "parts, those up to the highest pole listed are counted. If several functions agree in all of "
            "this, one is shown. A dash means that the rigid model has no response to compare with, for "
            "example because only springs hold it to ground."
        ),
        text(
            "Minimum phase means: no zero in the open right half-plane. “For all values” is proved for all "
            "positive values of the parameters. A function is colocated if its output is taken where the "
            "input acts, or rigidly joined to it. A compliance with an end on ground belongs to the base, or "
            "is a contact if its force is measured. Between moving parts, a compliance in bending belongs to "
            "a link, any other to the transmission."
        ),
    )
    if controlled:
        words = (
            "Two outputs move together if one differs from the colocated output by at "
            "most 10 degrees of phase and 1 dB. A loop is stable if all closed-loop poles are in the "
            "left half-plane; the model's chapter states how far the stable gains are proved. The "
            "crossover allowed is the frequency at which the loop gain first falls below one, with half "
            "of the gain at which the loop becomes unstable (a gain margin of 6 dB)."
        )
        explained = (*explained, text(words))
    return Section("Comparison of models", (*tables, *explained), ANCHOR)


def _table(models: Sequence[ModelFacts], chosen: dict[str, ComparisonColumn]) -> Table:
    rows = tuple(tuple(_cell(cell(facts)) for cell, _ in chosen.values()) for facts in models)
    return Table(columns(*((head, side) for head, (_, side) in chosen.items())), rows)


def _cell(runs: Iterable[Run]) -> Cell:
    """Return a cell without the end of its last line; a dash where there is nothing to say."""
    cells = tuple(runs)
    return (cells[:-1] if cells[-1:] == ("\n",) else cells) or (NONE,)


def representatives(facts: ModelFacts) -> tuple[TransferFacts, ...]:
    """Return one function of each kind: those that differ only in the power of s of their output are one."""
    distinct: dict[tuple[object, ...], TransferFacts] = {}
    for f in facts.functions:
        distinct.setdefault((f.colocated, f.added, f.modes, f.condition, f.right_half_plane_zeros), f)
    return tuple(distinct.values())


def phase_runs(function: TransferFacts) -> tuple[Run, ...]:
    """Return whether a function is minimum phase, and the condition where one is known."""
    shown = ", as far as listed" if function.is_infinite else ""
    if function.condition == "always":
        return (Badge("yes", "good"), " for all values")
    if function.condition == "if positive" and function.bracket_mathematics is not None:
        verdict = Badge("yes", "good") if function.is_minimum_phase else Badge("no", "bad")
        return (verdict, " exactly when ", function.bracket_mathematics, " ≥ 0")
    if not function.is_minimum_phase:
        count = f", with {counted(function.right_half_plane_zeros, 'zero')} in the right half-plane{shown}"
        for_all = " for all values" if function.condition in ("never", "as given") else " for these values"
        return (Badge("no", "bad"), for_all + count)
    return (Badge("yes", "good"), f" for these values{shown}")
