"""Modelica models: state equations with names, units and descriptions, in symbols.

Input: the transfer functions of a model of finitely many states, and delays. Output: one model::

    model Axis "A load on a rail"
      parameter Real m(unit = "kg") = 2;
      input Real F(unit = "N");
      output Real X(unit = "m");
      Real x(start = 0, fixed = true, unit = "m");
    equation
      der(x) = x_dot;
      ...
      X = x;
    end Axis;

The equations are those of :mod:`symflex.state_space`, which satisfy the model's identically; a delay is
``if time < T then 0 else delay(x, T)``. Source: Modelica Language Specification 3.6, 2023.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from symflex.codegen.export import Export
from symflex.codegen.module_text import default_value, identifiers, inert, origin_lines, wrapped
from symflex.codegen.state_space import StateEquations
from symflex.expressions import Name, format_expression, product_of, substitute, sum_of
from symflex.model import Model
from symflex.model.loss_factors import check_causal
from symflex.state_space import realise
from symflex.state_space.opened import without_delays
from symflex.state_space.popov import Vector
from symflex.transfer import AnyTransferFunction

RESERVED: Final = frozenset(
    "algorithm and annotation block break class connect connector constant constrainedby der discrete "
    "each else elseif elsewhen encapsulated end enumeration equation expandable extends external false "
    "final flow for function if import impure in initial inner input loop model not operator or outer "
    "output package parameter partial protected public pure record redeclare replaceable return stream "
    "then true type when while within time pi Real Integer Boolean String abs sqrt sin cos tan sinh "
    "cosh tanh atan exp log pre delay sample edge change".split()
)
PI: Final = 'constant Real pi = 3.141592653589793 "the number pi"'
WIDTH: Final = 100


@dataclass(frozen=True, slots=True)
class ModelicaExporter:
    """State equations as a Modelica model."""

    suffix = ".mo"
    summary = "Modelica model: symbolic state equations, states named"
    solves = False

    def export(
        self, model: Model, tfs: Sequence[AnyTransferFunction], stem: str = "", *, is_alone: bool = True
    ) -> Export:
        """Return the model; SF235 for members and delays between nodes, SF236 for more zeros than poles."""
        check_causal(model, "a Modelica model")
        cut, late = without_delays(model)
        sources = list(dict.fromkeys([*(tf.input.name for tf in tfs), *late]))
        asked = list(dict.fromkeys([*(tf.output.name for tf in tfs), *(name for name, _ in late.values())]))
        system = realise(cut, [(output, source) for output in asked for source in sources])
        equations = StateEquations(system)
        groups = {
            "parameter": [p.name for p in model.parameters],
            "input": [x.name for x in system.inputs],
            "state": [x.name for x in system.states],
            "output": [x.name for x in system.outputs],
        }
        wanted = {f"{kind} {name}": name for kind, names in groups.items() for name in names}
        title = identifiers({"": "".join(w.capitalize() for w in (stem or "model").split("_"))}, RESERVED)[""]
        named = identifiers(wanted, RESERVED | {title})
        letters = {n: Name(named[f"parameter {n}"]) for n in groups["parameter"]}
        moving = [Name(named[f"state {n}"]) for n in groups["state"]]
        moving += [Name(named[f"input {n}"]) for n in groups["input"]]

        def right(states: Vector, inputs: Vector) -> str:
            parts = {**states, **{len(system.states) + j: value for j, value in inputs.items()}}
            entries = (
                (substitute(equations.entry(value), letters), moving[j]) for j, value in sorted(parts.items())
            )
            return format_expression(sum_of(product_of(pair) for pair in entries))

        lines = [f"model {title} {_string(model.title)}".rstrip()]
        lines += [f"  // {line}".rstrip() for line in origin_lines(model, WIDTH - 5)]
        derivatives = zip(system.states, system.a, system.b, strict=True)
        texts = [f"der({named[f'state {x.name}']}) = {right(a, b)};" for x, a, b in derivatives]
        results = zip(system.outputs, system.c, system.d, strict=True)
        texts += [f"{named[f'output {x.name}']} = {right(c, d)};" for x, c, d in results]
        for back, (ahead, time) in late.items():
            by = format_expression(substitute(time, letters))
            delayed = f"delay({named[f'output {ahead}']}, {by})"
            texts.append(f"{named[f'input {back}']} = if time < {by} then 0 else {delayed};")
        if any("pi" in text for text in texts):
            lines.append(f"  {PI};")
        for p in model.parameters:
            value = default_value(p)
            given = f" = {value}" if value else ""
            name = named[f"parameter {p.name}"]
            lines.append(f"  parameter Real {name}{_unit(p.unit)}{given} {_string(p.doc)}".rstrip() + ";")
        inner = {*late, *(name for name, _ in late.values())}
        for kind, channels in (("input", system.inputs), ("output", system.outputs)):
            for channel in channels:
                start = "  " if channel.name in inner else f"  {kind} "
                lines.append(f"{start}Real {named[f'{kind} {channel.name}']}{_unit(channel.unit)};")
        for state in system.states:
            meaning = _string(format_expression(equations.meaning(state)))
            attributes = _unit(state.unit, "start = 0, fixed = true")
            lines.append(f"  Real {named[f'state {state.name}']}{attributes} {meaning};")
        lines.append("equation")
        for text in texts:
            lines += wrapped(text, WIDTH, "  ", "    ")
        return Export("\n".join([*lines, f"end {title};", ""]), name=title)


def _unit(unit: str, *others: str) -> str:
    """Return what stands in brackets after a variable: its unit, as Modelica writes it."""
    plain = unit.replace("*", ".").replace("^", "").replace("ohm", "Ohm")
    parts = [*others, *([f'unit = "{plain}"'] if plain and "(1/" not in plain and "j" not in plain else [])]
    return f"({', '.join(parts)})" if parts else ""


def _string(text: str) -> str:
    """Return a description, empty for none."""
    plain = inert(text).replace("\\", "\\\\").replace('"', '\\"')
    return f'"{plain}"' if plain else ""
