"""The linear equations of a model, with the names of everything in them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from symflex.algebra import Dispersion, Factored, Radicals, Ring
from symflex.expressions import Call, format_expression
from symflex.library.elements import EquationRow, LinearForm, Variable
from symflex.model import Model, ModelParameter
from symflex.model.along import COORDINATE, varies_along_x
from symflex.model.linearity import factored_of

if TYPE_CHECKING:
    from symflex.algebra.propagators import Propagation
    from symflex.library.fields import FieldSystem


@dataclass(frozen=True, slots=True)
class ConstantFunction:
    """A generator for an elementary function of constants, named by its own text: ``sqrt(k*m)``."""

    generator: str
    expression: Call


@dataclass(frozen=True, slots=True)
class OutputRow:
    """An output ``y = form / divisor``; the divisor contains s when the output is filtered."""

    name: str
    form: LinearForm
    divisor: Factored
    poles: Factored  # what the output is written with; the divisor has fields' powers of s, too


@dataclass(frozen=True, slots=True, eq=False)
class Continuum:
    """One distributed part, for what goes on inside it: ``dz/dx = matrix z + load u`` from its start on."""

    name: str  # the element's or field's
    kind: str  # the element's type, or ``field``
    system: FieldSystem  # over the ring without kernels
    start: Factored  # start and length: where x begins, and how far it reaches; over the same ring
    length: Factored
    initial: tuple[Variable | None, ...]  # per state, the unknown it equals at the start; None if zero
    loads: tuple[Variable, ...] = ()  # what acts all along it, per column of ``system.loads``
    final: tuple[tuple[Variable | None, int], ...] = ()  # per state, unknown at the end, and sign
    parts: tuple[tuple[tuple[int, ...], Dispersion], ...] = ()  # coupled states, and their law


@dataclass(frozen=True)
class Equations:
    """``A(s) x + B u = 0``, ``y = C x + D u``, over an exact ring."""

    model: Model  # where they come from
    ring: Ring  # generators: s, parameters, closed definitions, pi, functions of constants
    definitions: tuple[tuple[str, Factored], ...]  # in terms of the generators before each
    constants: tuple[ConstantFunction, ...]  # what the function generators stand for
    unknowns: tuple[Variable, ...]  # unknowns and inputs: the names of x and u
    inputs: tuple[Variable, ...]
    rows: tuple[EquationRow, ...]  # as many as unknowns; polynomial but over a sparse ring
    outputs: tuple[OutputRow, ...]  # the names of y and their forms
    propagation: Propagation | None = None  # what generators of distributed parts are
    cleared: Factored | None = None
    continua: tuple[Continuum, ...] = ()  # the distributed parts
    is_split: bool = False  # what is coupled has several laws somewhere, or equal wavenumbers
    # What was computed of them, by output and input.
    memo: dict[tuple[str, str], object] = field(default_factory=dict, init=False, compare=False, repr=False)

    @property
    def delays(self) -> dict[str, tuple[Factored, Factored]]:
        """Rate and time of the exponential functions that are generators."""
        if self.propagation is None:
            return {}
        laws, lengths = self.propagation.table.dispersions, self.propagation.lengths
        return {
            p.generator: (laws[p.dispersion].shift, lengths[p.dispersion][p.length])
            for p in self.propagation.propagators
        }

    def __repr__(self) -> str:
        counts = f"{len(self.unknowns)} unknowns, {len(self.inputs)} inputs, {len(self.outputs)} outputs"
        return f"<Equations: {counts}>"


def radicals_of(
    ring: Ring,
    constants: Sequence[ConstantFunction],
    parameters: Sequence[ModelParameter],
    value: Callable[[str], Factored] | None = None,
) -> Radicals:
    """Return relations of the roots among a ring's generators, given ``value`` for a parameter's name."""
    roots = [c.expression for c in constants if c.expression.name == "sqrt"]
    if not any(p.name == COORDINATE for p in parameters):
        roots = [c for c in roots if not varies_along_x(c)]
    roots = [c for c in roots if format_expression(c) in ring.index]
    units = [ring.index[p.name] for p in parameters if p.is_imaginary and p.name in ring.index]
    signed = {p.name for p in parameters if p.assume != "real"} | {"pi"}
    positive = frozenset(i for n, i in ring.index.items() if n in signed or n.startswith("exp("))
    if not (roots or units) or ring.is_sparse:
        return Radicals(ring, positive=positive)

    def named(name: str) -> Factored:
        return Factored.generator(ring, name) if value is None or name == "pi" else value(name)

    radicands = dict.fromkeys(units, Factored.number(ring, -1))
    for c in roots:
        # What divides by zero, or holds s or a block, has no value, which is reported where one is asked for.
        with suppress(ZeroDivisionError, KeyError):
            radicands[ring.index[format_expression(c)]] = factored_of(c.argument, ring, named)
    return Radicals.of(ring, radicands, positive)
