"""The motion of a lumped model from initial values.

Input: a model, an output, values of states before t = 0. Output: ``C (s - A)^-1 w_0`` of its state equations,
a function of s whose impulse response is the motion. States that are not named begin at 0.

    2 s x = -x,  x(0) = 3    is    3/(s + 1/2)    in time    3 e^(-t/2)
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from operator import add
from typing import TYPE_CHECKING

from symflex.analysis.time_response.enclosed_response import FREE, EnclosedResponse
from symflex.analysis.time_response.find import time_response
from symflex.balls import precision
from symflex.equations import assemble
from symflex.errors import Diagnostic, ModelError, Source, SpecError, Text, UsageError, nearest, refused
from symflex.expressions import format_expression, quotient
from symflex.model import Model, Output, load_with, with_numbers
from symflex.print.forms.arrange import Arranger
from symflex.quantities import parse_quantity, unit_of
from symflex.state_space.popov import FieldElement
from symflex.state_space.realise import StateSpace, derivative, quantity_of, realise, unit_of_quantity
from symflex.transfer import AnyBoundFunction, nested_transfer
from symflex.transfer.of_model import derive_bound
from symflex.transfer.transfer_function import unit_of_response

if TYPE_CHECKING:
    from symflex.analysis.input_shaping import InputShaper
    from symflex.analysis.time_response.sample_times import SampleTimes

BITS = 256  # precision of sums: rounding adds nothing to the balls of their terms
_QUANTITY = re.compile(r"(?P<s>s(\^(?P<order>\d))?\*)?(?P<quantity>\w+(\.\w+)?)")


def free_motion(model: Model, pair: tuple[str, str], initial: Mapping[str, str]) -> AnyBoundFunction:
    r"""Return the function of the motion of an output from initial values of quantities.

    Quantities are nodes, signals, currents and forces, and their derivatives: ``x``, ``s*x``, ``coil.i``.
    Raises ModelError: SF235 for beams, rods and delays; UsageError: SF203 for a value in another unit, SF902
    for what is no state nor a multiple of one.

    >>> from symflex import pipeline
    >>> text = 'symflex = 1\nsignals.y = "(u - y)/(2*s)"\ninputs.u = {}\noutputs.Y = "y"'
    >>> free_motion(pipeline.loads(text), ("Y", "u"), {"y": "3"}).ratio.denominator().expand()
    2*s + 1
    """
    if model.is_distributed:
        message = "initial values are those of finitely many states, and beams, rods and delays have more"
        hint = "start from rest, with an input that brings the model where it begins"
        raise ModelError(Diagnostic("SF235", message, None, hint))
    model = with_numbers(model)
    unknowns = {str(v): v for v in assemble(model, nested_transfer).unknowns}
    shown, sizes = [], []
    for i, (name, text) in enumerate(initial.items()):
        match = _QUANTITY.fullmatch(name.replace(" ", ""))
        if match is None or match["quantity"] not in unknowns:
            hint = nearest(name, unknowns) or f"x, s*x or coil.i for instance; here {', '.join(unknowns)}"
            raise refused(f"'{name[:64]}' is not a quantity whose initial value can be given", hint)
        variable, order = unknowns[match["quantity"]], int(match["order"] or bool(match["s"]))
        sizes.append(_value(name, text, unit_of_quantity(model, variable, order)))
        shown.append(Output(f"_{i}", derivative(quantity_of(variable), order)))
    pairs = [pair, *((output.name, pair[1]) for output in shown)]
    system = realise(replace(model, outputs=(*model.outputs, *shown)), pairs)
    begins: dict[int, str] = {}
    for name, row, size in zip(initial, system.c[1:], sizes, strict=True):
        (column, share), *others = row.items() or [(-1, None)]
        if others or share is None or column in begins:
            states = ", ".join(format_expression(state.terms[0][0]) for state in system.states)
            message = f"'{name}' is not a state, nor a multiple of one that has no other value"
            raise refused(message, f"give values of {states}")
        begins[column] = f"{size}/({_text(system, share)})"
    return derive_bound(load_with(Source("initial values", _spec(system, begins)), {}), [("y", "u")])[0]


def response_from(
    free: AnyBoundFunction | None,
    bound: AnyBoundFunction,
    kind: str,
    times: SampleTimes,
    digits: int,
    shaper: InputShaper | None,
) -> EnclosedResponse:
    """Return a response from rest to an input of unit size, or none, and the motion from initial values."""
    if free is None:
        return time_response(bound, kind, times, digits, shaper)
    motion = time_response(free, "impulse", times, digits)
    if kind == FREE:
        unit = unit_of_response(bound.source.output, bound.source.input)
        return replace(motion, tf=bound.name, unit=unit, input=FREE)
    driven = time_response(bound, kind, times, digits, shaper)
    with precision(BITS):
        return replace(driven, enclosures=tuple(map(add, driven.enclosures, motion.enclosures)), modes=None)


def _value(name: str, text: str, unit: str) -> str:
    """Return an initial value in SI units, exactly."""
    try:
        quantity = parse_quantity(Text.alone(f"initial value of {name}", text))
    except SpecError as error:
        raise UsageError(*error.diagnostics) from None
    if quantity.unit and unit and quantity.dimension != unit_of(unit).dimension:
        message = f"'{name}' is in '{unit}', its initial value in '{quantity.unit}'"
        raise UsageError(Diagnostic("SF203", message))
    number, power = quantity.angular()
    return f"({number})*pi^({power})"


def _text(system: StateSpace, value: FieldElement) -> str:
    arranger = Arranger.plain(system.ring, {c.generator: c.expression for c in system.constants})
    return format_expression(quotient(*map(arranger.coefficient, (value.num, value.den))))


def _spec(system: StateSpace, begins: Mapping[int, str]) -> str:
    """Return a model of the state equations whose input is an impulse that sets the states."""
    sums = [
        " + ".join([f"({_text(system, v)})*w_{j}" for j, v in r.items()]) for r in (*system.a, *system.c[:1])
    ]
    *rates, output = (f"{each} + " if each else "" for each in sums)
    rows = [f'w_{i} = "({rate}{begins.get(i, "0")}*u)/s"' for i, rate in enumerate(rates)]
    return "\n".join(["symflex = 1", "inputs.u = {}", f'outputs.y = "{output}0*u"', "[signals]", *rows])
