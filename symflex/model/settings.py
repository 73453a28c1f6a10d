"""Values given from outside in place of those a specification declares: ``k=80 kN/m``.

Also the same model with numbers in place of its valued parameters, for what needs no symbols.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from math import isfinite
from numbers import Rational
from typing import TYPE_CHECKING

from symflex.errors import Diagnostic, ModelError, Source, Span, Text, UsageError, nearest, refused
from symflex.expressions import (
    Expression,
    Product,
    is_number,
    names_among,
    nodes,
    number,
    replace_node,
    substitute,
)
from symflex.model.declarations import DeclaredParameter, one_of, without_sign
from symflex.model.model import ONE, ExactValue, Model, ModelParameter, rewritten
from symflex.model.signs import line_of
from symflex.model.units import exact_expression
from symflex.quantities import DIMENSIONLESS, Quantity, parse_quantity, unit_of

if TYPE_CHECKING:
    from symflex.model.reading import Reader

Setting = str | int | float | Fraction | Decimal  # a quantity with its unit, or a number in SI units
OPTION = "--set"


def read_settings(texts: Sequence[str], option: str = OPTION) -> dict[str, str]:
    """Return what ``NAME=VALUE`` texts of an option say; SF902 for others, and a name given twice.

    >>> read_settings(["k=80 kN/m", "m = 2"])
    {'k': '80 kN/m', 'm': '2'}
    """
    settings: dict[str, str] = {}
    for text in texts:
        name, sign, value = (part.strip() for part in text.partition("="))
        if not (sign and name and value):
            message = f"{option} takes NAME=VALUE, found '{text[:60]}'"
            example = f"{option} k='80 kN/m'" if option == OPTION else f"{option} x='1 mm'"
            raise refused(message, f"for instance {example}")
        if len(value) > 1 and value[0] == value[-1] and value[0] in "'\"":
            value = value[1:-1]  # as a specification writes it
        if name in settings:
            raise refused(f"'{name[:64]}' is set twice")
        settings[name] = value
    return settings


def check_names(model: Model, settings: Mapping[str, Setting]) -> None:
    """Refuse names that are not parameters of a model: SF902 with the nearest name."""
    known = [p.name for p in model.parameters]
    others = {d.name: "a definition, and follows from parameters" for d in model.definitions}
    others |= {b.name: "a block" for b in model.blocks} | {u.name: "an element" for u in model.elements}
    for name in settings:
        if name not in known:
            hint = nearest(name, known) or "parameters: " + (", ".join(known[:8]) or "none")
            kind = f"'{name}' is {others[name]}: " if name in others else ""
            raise refused(f"{kind}there is no parameter '{name[:64]}'", hint)


def settled(
    reader: Reader, declared: Sequence[DeclaredParameter], settings: Mapping[str, Setting]
) -> tuple[DeclaredParameter, ...]:
    """Return the parameters with the given values in place of declared ones; what does not fit is noted."""
    return tuple(
        _settled(reader, parameter, settings[parameter.name]) if parameter.name in settings else parameter
        for parameter in declared
    )


def _settled(reader: Reader, parameter: DeclaredParameter, given: Setting) -> DeclaredParameter:
    name = parameter.name
    text = Text(str(given), Span(Source(OPTION, f"{name}={given}"), len(name) + 1, len(f"{name}={given}")))

    def read(text: Text) -> Quantity:
        if isinstance(given, str):
            return parse_quantity(text)
        return Quantity(exact_number(name, given), 0, 0, DIMENSIONLESS, 0, "")

    quantity = reader.read(read, text)
    if quantity is None:
        return parameter
    nominal = one_of(parameter.unit_text) if parameter.unit_text else parameter.quantity
    if nominal is not None and (parameter.has_unit or parameter.unit_text):
        declared = f"'{name}' is declared in '{nominal.unit}'"
        if quantity.unit and quantity.dimension != nominal.dimension:
            reader.note("SF203", f"{declared}, the value given is in '{quantity.unit}'", text.span)
            return parameter
        turns = [q.cycles + q.radians for q in (nominal, quantity)]
        is_zero = not quantity.unit and not quantity.magnitude
        if (nominal.cycles or quantity.cycles) and turns[0] != turns[1] and not is_zero:
            # Whether 60 is 60 Hz or 60 rad/s, and 1 mm one per turn or per radian, nobody can tell.
            what = f"is in '{quantity.unit}'" if quantity.unit else "has no unit"
            hint = f"give it in a unit that counts turns, such as '{nominal.unit or quantity.unit}'"
            reader.note("SF203", f"{declared}, the value given {what}", text.span, hint)
            return parameter
        if not quantity.unit:
            quantity = replace(nominal, magnitude=quantity.magnitude, pi_power=quantity.pi_power)
    if problem := without_sign(name, quantity, parameter.assume, text.span):
        reader.take((problem,))
        return parameter
    return replace(parameter, quantity=quantity, has_unit=bool(quantity.unit) or parameter.has_unit)


def value_in_unit(parameter: ModelParameter, quantity: Quantity) -> ExactValue:
    """Return a quantity in the unit of a parameter's value; SF203 if it has another, or needs one."""
    wanted = unit_of(parameter.unit) if parameter.unit else None
    if quantity.unit and wanted is not None and quantity.dimension != wanted.dimension:
        message = f"'{parameter.name}' is in '{parameter.unit}', the value given in '{quantity.unit}'"
        raise UsageError(Diagnostic("SF203", message))
    if parameter.cycles and not quantity.unit and quantity.magnitude and parameter.scale != ONE:
        message = f"'{parameter.name}' is declared in '{parameter.written_unit}', the value given has no unit"
        hint = f"give it with its unit, such as '{parameter.written_unit}'"
        raise UsageError(Diagnostic("SF203", message, None, hint))
    turns = parameter.cycles
    if turns and quantity.cycles != turns and quantity.radians == turns:  # "314 rad/s" for what is in Hz
        return ExactValue(quantity.magnitude / Fraction(2) ** turns, quantity.pi_power - turns)
    angular = not turns and (wanted is None or bool(wanted.radians))
    return ExactValue(*(quantity.angular() if angular else quantity.cyclic()))


def check_free(parameter: ModelParameter) -> None:
    """Refuse to vary a parameter with which a number at equilibrium was solved for; SF801."""
    if parameter.is_solved_with:
        message = (
            f"values at equilibrium were found with this value of '{parameter.name}', and would not follow it"
        )
        hint = f"--set {parameter.name}=VALUE solves anew, as does load(FILE, values=...) in Python"
        raise ModelError(Diagnostic("SF801", message, parameter.span, hint))


def spread_box(
    parameters: Iterable[ModelParameter], share: Fraction | None = None
) -> dict[str, tuple[Fraction, Fraction]]:
    """Return the ends of each parameter that has a ``spread``, or of all for a share; SF804 for none."""
    box = {}
    for p in parameters:
        spread = p.spread if share is None else share
        if p.value is None or spread is None or p.value.is_imaginary:
            continue
        value = p.value.nearly
        width = spread
        if isinstance(width, Fraction):
            width = replace(p.value, rational=abs(p.value.rational) * width)
        half = width.nearly
        if p.assume != "real" and (value < half or (value == half and p.assume == "positive")):
            message = f"the spread of '{p.name}' reaches values that it is assumed not to have"
            raise UsageError(Diagnostic("SF804", message, p.span))
        # PI_NEARLY has 30 digits.
        around = (abs(value) + half) / 10**28 if p.value.pi_power or width.pi_power else 0
        if half:
            check_free(p)
            box[p.name] = (value - half - around, value + half + around)
    if not box:
        hint = 'give one for all of them: --spread 10%, or declare m = { value = ..., spread = "10 %" }'
        raise UsageError(Diagnostic("SF804", "no parameter has a value and a spread", None, hint))
    return box


def exact_number(name: str, given: object) -> Fraction:
    """Return the value given for a parameter, of a double the shortest decimal that prints it."""
    if isinstance(given, float | Decimal) and isfinite(given):
        # A numpy double is a float whose own repr is not a number.
        return Fraction(Decimal(float.__repr__(given)) if isinstance(given, float) else given)
    as_python = getattr(given, "item", None)
    if callable(as_python) and getattr(given, "size", 1) == 1:
        return exact_number(name, as_python())
    if isinstance(given, Rational):
        return Fraction(int(given.numerator), int(given.denominator))
    hint = "give an int, float, Fraction or Decimal, or a text with a unit"
    raise refused(f"the value of '{name}' must be a finite number", hint)


def with_numbers(
    model: Model,
    symbolic: Collection[str] = (),
    values: Mapping[str, ExactValue] | None = None,
    *,
    in_kernels: bool = False,
) -> Model:
    """Return a model whose valued parameters are replaced by exact numbers; the others stay symbolic."""
    # Its transfer functions, bound, are those of the model; deriving them costs no symbols. Parameters in
    # ``symbolic`` stay so; ``values`` stand in place of declared ones. In a distributed model 0 is put in
    # alone: wavenumbers and kernels are named by their parameters, and values are put in when they are bound,
    # but a law that loses a term has other points where waves vanish or meet. With ``in_kernels`` numbers
    # stand there, too, as they may in the nested form.
    only_zeros = model.is_distributed and not in_kernels
    given = {**{p.name: p.value for p in model.parameters}, **(values or {})}
    numbers = {
        name: exact_expression(value)
        for name, value in given.items()
        if value is not None
        and name not in symbolic
        and not (value.is_imaginary or (only_zeros and value.rational))
    }
    if not numbers:
        return model
    model = rewritten(model, lambda expression: substitute(expression, numbers))
    model = replace(
        model,
        parameters=tuple(p for p in model.parameters if p.name not in numbers),
        definitions=tuple(
            replace(d, expression=substitute(d.expression, numbers)) for d in model.definitions
        ),
        blocks=tuple(
            replace(b, submodel=b.submodel and with_numbers(b.submodel, symbolic, values))
            for b in model.blocks
        ),
    )
    return _without_vanishing_products(model) if any(is_number(n, 0) for n in numbers.values()) else model


def _without_vanishing_products(model: Model) -> Model:
    """Return a model without what is multiplied by 0: derivatives in fields, x, and j in ``k*(1 + j*0)``."""
    line = line_of(model, ())

    def without(expression: Expression) -> Expression:
        for node in nodes(expression):
            if isinstance(node, Product) and any(map(line.is_zero, node.factors)):
                expression = replace_node(expression, node, number(0))
        return expression

    definitions = tuple(replace(d, expression=without(d.expression)) for d in model.definitions)
    model = replace(rewritten(model, without), definitions=definitions)
    unit = model.imaginary
    if unit is None or any(names_among(expression, {unit.name}) for _, expression in model.expressions()):
        return model
    return replace(model, parameters=tuple(p for p in model.parameters if p is not unit))
