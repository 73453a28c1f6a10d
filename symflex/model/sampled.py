"""Controllers that a computer works out: what ``[sampled]`` says, and the loop opened at their samples.

Input: the section, and a model whose blocks it names. Output: :class:`SampledBlocks`; the continuous part of
the model with one input and one output for each place at which a controller acts.

    [sampled]
    period = "T"
    blocks = ["wall"]            wall = "K + B*(z - 1)/(T*z)"
    "m*s^2*x + b*s*x + wall*x = F"    becomes    "m*s^2*x + b*s*x + held_1 = F" with the output "x"

A block that is written in z multiplies what it samples, as one in s multiplies what it filters. What stands
to the right of it in a product comes before the sampler, and what stands to the left after the hold.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE
from symflex.errors import Diagnostic, ModelError, Span, nearest
from symflex.expressions import (
    Call,
    Equation,
    Expression,
    Name,
    Negative,
    Number,
    Product,
    Quotient,
    Sum,
    format_expression,
    names,
    names_among,
    nodes,
    product_of,
    quotient,
    substitute,
    sum_of,
)
from symflex.library.blocks import BLOCKS
from symflex.model.model import Input, Model, ModelParameter, Output, PlacedBlock, SampledBlocks, Z
from symflex.model.reading import QuantityLiteral, Reader, signed_number
from symflex.model.scope import scope_of

if TYPE_CHECKING:
    from symflex.model.network import Draft
    from symflex.model.spec import KeyValue

KEYS = ("period", "hold", "delay", "blocks", "by", "doc")
HOLD = "zero-order"
VARIABLE = ModelParameter(Z, None, "1", "real", doc="of sampled blocks")
"""The variable of sampled blocks, which has no value: it moves by one sample."""
ONE, TWO = Number(Fraction(1)), Number(Fraction(2))
IN_Z = "write it in z: K + B*(z - 1)/(T*z); or say how s becomes z: by = 'tustin'"


def _tustin(period: Expression) -> Expression:
    return Quotient(Product((TWO, Sum((Name(Z), Negative(ONE))))), Product((period, Sum((Name(Z), ONE)))))


def _backward(period: Expression) -> Expression:
    return Quotient(Sum((Name(Z), Negative(ONE))), Product((period, Name(Z))))


def _forward(period: Expression) -> Expression:
    return Quotient(Sum((Name(Z), Negative(ONE))), period)


RULES: Mapping[str, Callable[[Expression], Expression]] = {
    "tustin": _tustin,
    "backward": _backward,
    "forward": _forward,
}
"""What stands for s in a block that is sampled ``by`` a rule, given the period."""


def read_sampled(
    reader: Reader, entry: KeyValue | None, blocks: Sequence[PlacedBlock]
) -> SampledBlocks | None:
    """Return what ``[sampled]`` says; None without it, or where a mistake is noted."""
    table = None if entry is None else reader.table(entry, "[sampled]")
    if entry is None or table is None:
        return None
    reader.keys(table, KEYS, "[sampled]")
    needs = "[sampled] lacks period, the time from sample to sample"
    given = reader.needed(table, "period", entry, needs, 'for instance: period = "1 ms"')
    period = reader.expression(given.value, "period of [sampled]") if given else None
    late = table.get("delay")
    delay = reader.expression(late.value, "delay of [sampled]") if late else signed_number(Fraction(0))
    hold, by = reader.text(table, "hold", "[sampled]"), reader.text(table, "by", "[sampled]")
    if hold is not None and hold.value != HOLD:
        message = f"the hold '{hold.value[:64]}' is not known"
        reader.note("SF260", message, hold.span, f'the output is held from sample to sample: hold = "{HOLD}"')
    if by is not None and by.value not in RULES:
        hint = nearest(by.value, RULES) or f"rules: {', '.join(RULES)}; or write the block in z"
        reader.note("SF260", f"'{by.value[:64]}' does not make a function of z", by.span, hint)
    known = {b.name: b for b in blocks}
    named = table.get("blocks")
    chosen = (reader.strings(named, "blocks of [sampled]") or ()) if named else ()
    for text in chosen:
        if text.value not in known:
            hint = nearest(text.value, known) or f"blocks: {', '.join(known) or 'none'}"
            reader.note("SF260", f"there is no block '{text.value[:64]}' to sample", text.span, hint)
    picked = tuple(text.value for text in chosen) if named else _meant(known)
    if not picked:
        message = "[sampled] does not say which block is sampled, and none is written in z"
        reader.note(
            "SF260", message, entry.key_span, 'name it: blocks = ["C"], with C = "K + B*(z - 1)/(T*z)"'
        )
    rule = "" if by is None else by.value
    found = [_problem(known[name], rule, set(picked)) for name in picked if name in known]
    reader.take(problem for problem in found if problem is not None)
    if period is None or delay is None or any(found) or not all(name in known for name in picked):
        return None
    return SampledBlocks(picked, period, delay, rule, entry.key_span)


def _meant(known: Mapping[str, PlacedBlock]) -> tuple[str, ...]:
    """Return the blocks that are written in z; where none is, the only block."""
    in_z = tuple(name for name, block in known.items() if any(names_among(e, {Z}) for _, e in block.values))
    return in_z or (tuple(known) if len(known) == 1 else ())


def _problem(block: PlacedBlock, rule: str, sampled: set[str]) -> Diagnostic | None:
    """Return what keeps a block from being a function of z."""
    formula, what = block_formula(block), f"block '{block.name}' is sampled"
    if formula is None:
        return Diagnostic("SF260", f"{what}, but is not one formula", block.span, IN_Z)
    used = {n.name for n in names(formula) if isinstance(n, Name)}
    if LAPLACE in used and Z in used:
        return Diagnostic("SF260", f"{what} and contains both s and z", block.span, IN_Z)
    if LAPLACE in used and not rule:
        return Diagnostic("SF260", f"{what}, but is written in s", block.span, IN_Z)
    if (block.block is not None and block.block.kernel_time) or any(
        isinstance(n, Call) and names_among(n, {LAPLACE, Z}) for n in nodes(formula)
    ):
        hint = "a delay of samples is a power of z, as in K/z^2; that of computing is 'delay' of [sampled]"
        return Diagnostic("SF260", f"{what} and contains a delay in s", block.span, hint)
    return None


def block_formula(block: PlacedBlock) -> Expression | None:
    """Return the formula of a block with its values, None of state equations and models."""
    values = dict(block.values)
    if block.block is BLOCKS["tf"]:
        return quotient(values["num"], values["den"])
    formula = block.formula
    return None if formula is None else substitute(formula, values)


def misplaced(draft: Draft) -> Iterator[Diagnostic]:
    """Yield what stands where it may not: z beside sampled blocks, a frequency in a period."""
    sampled = draft.sampled
    if sampled is None:
        return
    inside = {id(e) for b in draft.blocks if b.name in sampled.blocks for _, e in b.values}
    for expression in draft.expressions():
        if id(expression) not in inside and names_among(expression, {Z}):
            message = f"z stands in '{format_expression(expression)[:80]}', which is not sampled"
            hint = "z is the variable of the blocks that [sampled] lists"
            yield Diagnostic("SF260", message, expression.span, hint)
    cyclic = {p.name for p in draft.declared if p.measured is not None and p.measured.cycles}
    for time in (sampled.period, sampled.delay):
        counts = isinstance(time, QuantityLiteral) and time.quantity.cycles
        if counts or names_among(time, {LAPLACE, Z, *cyclic}):
            hint = 'write it as a time: "1 ms" for "1 kHz"'
            yield Diagnostic("SF260", "a time of [sampled] is no time", time.span, hint)


def refused(model: Model) -> ModelError:
    """Return what says that a model with a sampled controller is asked for what takes it as continuous."""
    message = "the controller is sampled, and what is asked for takes a model as continuous"
    hint = (
        "'symflex roots', 'stability' and 'passivity' answer for the sampled loop; for a controller that is "
        "continuous with a delay, leave out [sampled] and write the block in s, with exp(-s*T/2) for the hold"
    )
    span = None if model.sampled is None else model.sampled.span
    return ModelError(Diagnostic("SF261", message, span, hint))


@dataclass(frozen=True, slots=True)
class SampledChannel:
    """One place at which a controller acts: what it samples, and the input that it holds."""

    held: str  # the input of the opened model
    seen: str  # the output of the opened model
    controller: Expression  # from one to the other, in z and parameters


@dataclass(frozen=True)
class OpenedLoop:
    """The continuous part of a model, and the controllers between its last outputs and inputs."""

    model: Model
    channels: tuple[SampledChannel, ...]
    period: Expression  # [s]
    delay: Expression  # [s]


def continuous_part(model: Model) -> Model:
    """Return a model without its sampled controllers, what they hold being inputs; others as they are."""
    return model if model.sampled is None else opened(model).model


def opened(model: Model) -> OpenedLoop:
    """Return the continuous part of a model with sampled blocks, and what closes it; SF222, SF260."""
    sampled = model.sampled
    if sampled is None:
        raise ValueError("nothing is sampled")
    opener = _LoopOpener.of(model, sampled)

    def cut(expression: Expression) -> Expression:
        return opener.cut(expression)

    kept = tuple(b for b in model.blocks if b.name not in opener.formulas)
    plain = replace(
        model,
        sampled=None,
        definitions=tuple(d for d in model.definitions if d.name not in opener.written),
        blocks=kept,
        elements=tuple(replace(x, values=tuple((n, cut(e)) for n, e in x.values)) for x in model.elements),
        signals=tuple(replace(x, expression=cut(x.expression)) for x in model.signals),
        outputs=tuple(replace(x, expression=cut(x.expression)) for x in model.outputs),
        fields=tuple(f.rewritten(cut) for f in model.fields),
        parameters=tuple(p for p in model.parameters if p.name != Z),
        figures=(),
        published=(),
        tables=(),
    )
    taken = {*scope_of(model).meanings, *(o.name for o in model.outputs)}
    if clash := taken & {*(c.held for c in opener.channels), *(c.seen for c in opener.channels)}:
        message = f"'{min(clash)}' is a name of what a sampled block holds or sees"
        raise ModelError(Diagnostic("SF260", message, sampled.span, "rename it"))
    inputs = tuple(Input(c.held, "signal") for c in opener.channels)
    outputs = tuple(Output(c.seen, e) for c, e in zip(opener.channels, opener.seen, strict=True))
    plain = replace(plain, inputs=(*model.inputs, *inputs), outputs=(*plain.outputs, *outputs))
    if not opener.channels:
        message = "no signal passes the sampled block: nothing is sampled"
        raise ModelError(Diagnostic("SF260", message, sampled.span, "use it as a factor: f = '-wall*x'"))
    named = {d.name: d.expression for d in model.definitions if d.name not in opener.written}

    def written_out(expression: Expression) -> Expression:
        for _ in named:
            expression = substitute(expression, named)
        return expression

    channels = (replace(c, controller=written_out(c.controller)) for c in opener.channels)
    times = written_out(sampled.period), written_out(sampled.delay)
    return OpenedLoop(plain, tuple(channels), *times)


@dataclass
class _LoopOpener:
    """Takes sampled blocks out of expressions, and keeps what they stood between."""

    model: Model
    formulas: Mapping[str, Expression]  # of sampled blocks, in z
    written: Mapping[str, Expression]  # blocks and definitions that hold one, written out
    still: frozenset[str]  # names of constants
    channels: list[SampledChannel] = field(default_factory=list)
    seen: list[Expression] = field(default_factory=list)

    @classmethod
    def of(cls, model: Model, sampled: SampledBlocks) -> _LoopOpener:
        """Return what opens a model."""
        blocks = {b.name: b for b in model.blocks}
        formulas: dict[str, Expression] = {}
        for name in sampled.blocks:
            formula = block_formula(blocks[name])
            if formula is not None:
                rule = RULES.get(sampled.by)
                turned = {} if rule is None else {LAPLACE: rule(sampled.period)}
                formulas[name] = substitute(formula, turned)
        for _ in formulas:  # blocks may be made of one another
            formulas = {
                n: substitute(e, {m: f for m, f in formulas.items() if m != n}) for n, e in formulas.items()
            }
        written: dict[str, Expression] = {}
        others = [(b.name, block_formula(b)) for b in model.blocks if b.name not in formulas]
        others += [(d.name, d.expression) for d in model.definitions]
        for _ in others:
            held = {*formulas, *written}
            for name, expression in others:
                if name not in held and expression is not None and names_among(expression, held):
                    written[name] = substitute(expression, written)
        still = {p.name for p in model.parameters} | {d.name for d in model.definitions} | {"pi"}
        return cls(model, formulas, written, frozenset(still))

    def cut(self, expression: Expression) -> Expression:
        """Return an expression with held inputs in place of what sampled blocks multiply."""
        expression = substitute(expression, self.written)
        if isinstance(expression, Equation):
            return replace(expression, left=self.cut(expression.left), right=self.cut(expression.right))
        if not self._holds(expression):
            return expression
        match expression:
            case Sum(terms):
                return sum_of([self.cut(term) for term in terms])
            case Negative(operand):
                return Negative(self.cut(operand))
            case Quotient(numerator, denominator) if not self._holds(denominator):
                return Quotient(self.cut(numerator), denominator)
            case Product(factors):
                return self._product(factors, expression.span)
        raise self._no_operator(expression)

    def _product(self, factors: Sequence[Expression], span: Span | None) -> Expression:
        """Return a product with a held input in place of its sampled blocks and what they see."""
        place = next((i for i, f in enumerate(factors) if self._controls(f)), None)
        if place is None:  # within a bracket, as in ``k*(r - wall*x)``, or in a sum of blocks of both kinds
            at = next(i for i, f in enumerate(factors) if self._holds(f))
            return self._opened(factors, at, span)
        before, after = list(factors[:place]), list(factors[place + 1 :])
        controller = [factors[place]]
        while after and (self._controls(after[0]) or (self._is_constant(after[0]) and len(after) > 1)):
            controller.append(after.pop(0))
        if all(map(self._is_constant, after)):  # ``(r - x)*wall``: what is seen stands before it
            moving = [f for f in before if not self._is_constant(f)]
            if len(moving) != 1 or self._holds(moving[0]):
                raise self._no_operator(Product(tuple(factors), span=span))
            controller += [*after, *(f for f in before if self._is_constant(f))]
            return self._held(product_of(controller), moving[0])
        acting = product_of([*before, self._held(product_of(controller), self.cut(product_of(after)))])
        return self.cut(acting)

    def _opened(self, factors: Sequence[Expression], at: int, span: Span | None) -> Expression:
        """Return a product of which one factor is a sum, or a quotient, with a sampled block in it."""
        before, factor, after = list(factors[:at]), factors[at], list(factors[at + 1 :])
        match factor:
            case Sum(terms) if not all(map(self._is_constant, after)):
                return product_of([*before, sum_of([self.cut(product_of([term, *after])) for term in terms])])
            case Sum() if after or before:
                return product_of([*before, *after, self.cut(factor)])
            case Quotient(above, below) if not self._holds(below):
                return self.cut(product_of([*before, above, Quotient(ONE, below), *after]))
            case Negative(operand):
                return Negative(self.cut(product_of([*before, operand, *after])))
        raise self._no_operator(Product(tuple(factors), span=span))

    def _held(self, controller: Expression, seen: Expression) -> Expression:
        """Return the input that holds what a controller makes of what it sees; alike places are one."""
        controller = substitute(controller, self.formulas)
        for channel, known in zip(self.channels, self.seen, strict=True):
            if channel.controller == controller and known == seen:
                return Name(channel.held)
        number = len(self.channels) + 1
        self.channels.append(SampledChannel(f"held_{number}", f"seen_{number}", controller))
        self.seen.append(seen)
        return Name(f"held_{number}")

    def _holds(self, expression: Expression) -> bool:
        return bool(names_among(expression, {*self.formulas, *self.written}))

    def _controls(self, expression: Expression) -> bool:
        """Tell whether an expression is made of sampled blocks and constants alone."""
        used = {n.name if isinstance(n, Name) else "." for n in names(expression)}
        return bool(used & self.formulas.keys()) and used <= {*self.formulas, *self.still}

    def _is_constant(self, expression: Expression) -> bool:
        return all(isinstance(n, Name) and n.name in self.still for n in names(expression))

    def _no_operator(self, expression: Expression) -> ModelError:
        message = f"'{format_expression(expression)[:80]}' does not say what the sampled block sees"
        hint = "write the block as a factor before what it samples: f = '-wall*x', u = 'C*(r - y)'"
        return ModelError(Diagnostic("SF260", message, expression.span, hint))
