"""From equations to transfer functions, by Cramer's rule on one shared elimination.

Input: :class:`symflex.equations.Equations`.
Output: :class:`TransferFunction` for every pair asked for, reduced exactly.

A ``model`` block stands for a transfer function of its own model, over the ring of the model that uses it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import TYPE_CHECKING

from flint import fmpz_mpoly

from symflex.algebra import LAPLACE, NO_KERNELS, Factored, KernelTable, Radicals, Ring, degree_in
from symflex.budget import spend
from symflex.equations import Equations, assemble, radicals_of
from symflex.equations.elimination import Closure, Determinants, explain_singular
from symflex.errors import BudgetError, Diagnostic, ModelError
from symflex.model import Input, Output, PlacedBlock
from symflex.model.along import is_tapered
from symflex.transfer.against_equations import ModelSolve, compare
from symflex.transfer.agreement import agreement
from symflex.transfer.expansion import Expansion, Opening
from symflex.transfer.lowest_terms import DeterminantsOnLine, LineImages, cancel
from symflex.transfer.transfer_function import (
    ClosedForm,
    HiddenFactor,
    TransferFunction,
    name_quantity,
    unit_of_quotient,
)

if TYPE_CHECKING:
    from symflex.algebra.propagators import Propagation
    from symflex.transfer.distributed import KernelReduction


@dataclass(frozen=True)
class Terms:
    """How many terms a distributed system's determinants may have."""

    closed: int  # with sums and definitions closed
    opened: int  # in wavenumbers, kernels and parameters, before they are reduced


def derive(equations: Equations, output: str, source: str) -> TransferFunction:
    """Return one transfer function; SF30x of singular equations, SF50x too large, SF991 if they disagree."""
    return derive_all(equations, ((output, source),))[0]


def derive_all(
    equations: Equations,
    pairs: Sequence[tuple[str, str]],
    most: Terms | None = None,
    *,
    alike: bool = False,
) -> tuple[TransferFunction, ...]:
    """Return transfer functions of one elimination; ``most`` refuses distributed systems earlier.

    Each function is in the kernels in which it is shortest; with ``alike`` all are in the same ones.
    """
    workshop = _CramerQuotients(equations, most, alike=alike)
    derived = tuple(workshop.finish(output, source) for output, source in pairs)
    if not (workshop.is_sure or is_tapered(equations.model)):
        from symflex.transfer.named_coefficients import named_coefficients  # only with beams

        # Common factors may be left; with names for coefficients others may be, once these are opened.
        named, kept = named_coefficients(equations)
        other = _CramerQuotients(assemble(named, nested_transfer), most, equations, kept, alike=alike)
        again = tuple(other.finish(output, source) for output, source in pairs)
        if alike:
            derived = min(derived, again, key=lambda tfs: sum(map(_terms, tfs)))
        else:
            derived = tuple(min(two, key=_terms) for two in zip(derived, again, strict=True))
    compare(workshop.solve, [agreement(tf) for tf in derived])
    return derived


def _terms(tf: TransferFunction) -> int:
    return sum(len(factor) * abs(exponent) for factor, exponent in tf.ratio.factors)


class ClosedDefinitions:
    """Distributed functions over rings in which definitions are as good as parameters, for print."""

    def __init__(self, most: Terms) -> None:
        self._quotients = cache(lambda equations, kept: _CramerQuotients(equations, most, None, kept))

    def of(self, tf: TransferFunction) -> TransferFunction | None:
        """Return the same function in the names of definitions, None where there are none to be kept."""
        equations = None if tf.solve is None else tf.solve.plain
        if equations is None or not tf.has_formula:
            return None
        free = {"pi", *(p.name for p in tf.model.parameters), *(c.generator for c in tf.constants)}
        kept: list[str] = []
        for name, value in equations.definitions:
            if not value.is_constant and value.ring.used_in(f for f, _ in value.factors) <= free:
                kept.append(name)
                free.add(name)
        try:
            return (
                self._quotients(equations, tuple(kept)).finish(tf.output.name, tf.input.name)
                if kept
                else None
            )
        except BudgetError:
            spend()
            return None


class _CramerQuotients:
    """Reduces Cramer's quotients over one denominator; definitions in ``kept`` stay closed."""

    def __init__(
        self,
        equations: Equations,
        most: Terms | None,
        origin: Equations | None = None,
        kept: Sequence[str] = (),
        *,
        alike: bool = False,
    ) -> None:
        self._equations = equations
        self._alike = alike
        self._most = most
        self._origin = origin or equations
        opened = None if most is None else most.opened
        self._expansion = Expansion.of(equations, kept, opened)
        self._opened = Expansion.of(equations, (), opened) if kept and origin else self._expansion
        self._images = LineImages(self._expansion.ring)
        self._radicals = self._expansion.radicals
        self.solve = ModelSolve(self._origin.model, nested_transfer, self._origin)
        propagation = equations.propagation
        self._reduction = None if propagation is None else self._kernel_reduction(propagation, kept)

    @property
    def is_sure(self) -> bool:
        """True where no common factor is overlooked."""
        return self._reduction is None or self._reduction.is_sure

    @cached_property
    def _determinants(self) -> Determinants:
        return Determinants.of(self._equations, None if self._most is None else self._most.closed)

    @cached_property
    def _closure(self) -> Closure:
        return self._determinants.system.closure

    @cached_property
    def _opening(self) -> Opening:
        return Opening(self._closure, self._expansion)

    @cached_property
    def _line(self) -> DeterminantsOnLine:
        return DeterminantsOnLine(self._determinants, self._expansion.plain, self._expansion.images)

    @cached_property
    def _line_at_roots(self) -> DeterminantsOnLine | None:
        """The line in s on which roots are what they are, modulo a prime; None when it is not found."""
        plain, definitions = self._expansion.plain, self._expansion.images
        if (point := self._radicals.point()) is None:
            return None
        return DeterminantsOnLine(self._determinants, plain, definitions, LAPLACE, point)

    def _are_coprime(self, output: str, source: str) -> bool:
        """Tell whether determinants are proved coprime, also modulo the relations of roots."""
        if not self._determinants.minors.are_expanded:  # a gcd in s alone is no work
            return False
        if not self._line.prove_coprime(output, source):
            return False
        line = self._line_at_roots if self._radicals else self._line
        return line is not None and line.prove_coprime(output, source)

    @cached_property
    def _line_in_s(self) -> DeterminantsOnLine:
        plain, definitions = self._expansion.plain, self._expansion.images
        return DeterminantsOnLine(self._determinants, plain, definitions, LAPLACE)

    def _kernel_reduction(self, propagation: Propagation, kept: Sequence[str]) -> KernelReduction:
        """Return how quotients of kernels are reduced, with definitions opened everywhere."""
        from symflex.transfer.distributed import KernelReduction  # only with beams
        from symflex.transfer.named_coefficients import in_order_of_use

        table = propagation.table
        opened = [(v, _lowest(self._expansion.expanded(propagation.embed(v)))) for v in table.values]
        self._cleared = self._expansion.expanded(
            self._equations.cleared or Factored.number(propagation.ring, 1)
        )
        parameters = [*in_order_of_use(self._equations.model), *kept]
        ring = self._expansion.ring
        table = table.embedded(opened)
        lengths = () if self._alike else propagation.coordinates
        return KernelReduction(ring, table, parameters, lengths, self._radicals)

    def finish(self, name: str, source: str) -> TransferFunction:
        """Return the reduced transfer function ``num / den / divisor``."""
        row = next(row for row in self._equations.outputs if row.name == name)
        num, den = self._determinants.num(name, source), self._determinants.den
        model = self._origin.model
        output = next(o for o in model.answers if o.name == row.name)
        given = next(i for i in model.causes if i.name == source)
        if self._reduction is None and row.divisor.is_one and self._are_coprime(row.name, source):
            return self._made(output, given, self._primitive(row.name, source, num), None)
        # For a zero numerator the common factor is the whole denominator: every mode is hidden.
        common = num.gcd(den)
        num_closed, den_closed = num / common, den / common
        shared = self._expansion.expanded(self._closure.open(common))
        divisor = self._closure.close(row.divisor)
        den_closed = den_closed * divisor
        final = num_closed.gcd(den_closed)
        num_closed, den_closed = num_closed / final, den_closed / final
        shared = shared * self._expansion.expanded(self._closure.open(final))
        denominator = self._opening(den_closed)
        if shared.is_zero:  # a loop of gain one, once definitions are put in, that the output does not see
            raise explain_singular(self._equations)
        if self._reduction is not None:
            modes = den * self._closure.close(row.poles)
            return self._finish_distributed(output, given, num_closed, denominator, shared, modes)
        if denominator.is_zero:
            raise explain_singular(self._equations)
        if denominator.unit < 0:
            num_closed, den_closed, denominator = -num_closed, -den_closed, -denominator
        numerator = self._expansion.expanded(self._closure.open(num_closed))
        num_closed, den_closed = self._without_squares(num_closed, den_closed)
        ratio, cancelled = cancel(numerator, denominator, self._images, self._radicals)
        if numerator.is_zero:
            cancelled = denominator
        closed = ClosedForm(self._opening, num_closed, den_closed) if cancelled.is_one else None
        return self._made(output, given, closed, ratio, self._hidden(shared * cancelled))

    def _without_squares(self, num: fmpz_mpoly, den: fmpz_mpoly) -> tuple[fmpz_mpoly, fmpz_mpoly]:
        """Return a closed quotient without squares of roots: ``sqrt(x)^2`` is ``x``."""
        roots = self._closed_radicals
        if num.is_zero() or not (roots.has_squares(num) or roots.has_squares(den)):
            return num, den
        above, below = (roots.tidy(Factored.polynomial(roots.ring, p)) for p in (num, den))
        ratio = above / below
        num, den = ratio.numerator().expand(), ratio.denominator().expand()
        common = num.gcd(den)
        return num / common, den / common

    @cached_property
    def _closed_radicals(self) -> Radicals:
        ring, equations = self._closure.ring, self._equations
        if not self._radicals:
            return Radicals(ring)
        return radicals_of(ring, equations.constants, equations.model.parameters)

    def _primitive(self, output: str, source: str, num: fmpz_mpoly) -> ClosedForm:
        """Return a quotient of coprime determinants without common integer, the denominator positive."""
        num, den = self._without_squares(num, self._determinants.den)
        above, below = (x.term_content().leading_coefficient() for x in (num, den))
        common = above.gcd(below)
        if common != 1:
            num, den = num / common, den / common
        closed = ClosedForm(self._opening, num, den)
        if not closed.is_large:
            return closed if self._opening(den).unit > 0 else ClosedForm(self._opening, -num, -den)
        order = self._line_in_s.order(output, source)
        sign = 1 if den.leading_coefficient() > 0 else -1
        return ClosedForm(self._opening, sign * num, sign * den, order)

    def _made(
        self,
        output: Output,
        given: Input,
        closed: ClosedForm | None,
        ratio: Factored | None,
        hidden: tuple[HiddenFactor, ...] = (),
        table: KernelTable = NO_KERNELS,
        parts: tuple[Factored, Factored] | None = None,
        with_waves: TransferFunction | None = None,
    ) -> TransferFunction:
        equations, model = self._origin, self._origin.model
        known = dict(model.quotients).get((output.name, given.name))
        quantity, unit = name_quantity(output, given, known), unit_of_quotient(output, given, known)
        found = (output, given, ratio, closed, hidden, quantity, unit)
        context = (equations.ring, equations.definitions, equations.constants, model)
        return TransferFunction(*found, *context, table, parts, self.solve, with_waves)

    def _finish_distributed(
        self,
        output: Output,
        given: Input,
        num: fmpz_mpoly,
        denominator: Factored,
        hidden: Factored,
        modes: fmpz_mpoly,  # of the model and of the output's own filters
    ) -> TransferFunction:
        """Return the transfer function of a distributed system, with the kernels' relations used."""
        reduction = self._reduction
        numerator = self._expansion.expanded(self._closure.open(num))
        reduced = None
        if reduction is not None and not denominator.is_zero:
            reduced = reduction.reduce(numerator, denominator, hidden / self._cleared)
        if reduction is None or reduced is None:
            raise explain_singular(self._equations)
        determinant = self._expansion.expanded(self._closure.open(modes)) / self._cleared
        cancelled = reduced.shared * reduction.hidden_where_waves_vanish(determinant, reduced)
        table = reduced.table.embedded((v, _lowest(self._opened.expanded(v))) for v in reduced.table.values)
        above, below, cancelled = map(self._opened.expanded, (reduced.num, reduced.den, cancelled))
        if self._opened is not self._expansion:
            from symflex.transfer.distributed import opened

            above, below = opened(above, below, table)
        if below.unit < 0:
            above, below = -above, -below
        ratio = above / below
        table = table.restricted(
            above.ring.used_in(f for v in (above, below, cancelled) for f, _ in v.factors)
        )
        kernels = {k.generator for k in table.kernels}
        factors, parts = self._hidden(cancelled, table), (above, below) if table else None
        made = self._made(output, given, None, ratio, factors, table, parts)
        if not ratio.ring.used_in(f for f, _ in ratio.factors).isdisjoint(kernels):
            return made
        hides_waves = not ratio.ring.used_in(h.polynomial for h in made.hidden).isdisjoint(kernels)
        ratio, cancelled = (self._without_kernels(v) for v in (ratio, cancelled))
        with_waves = made if hides_waves else None
        return self._made(output, given, None, ratio, self._hidden(cancelled), with_waves=with_waves)

    def _without_kernels(self, value: Factored) -> Factored:
        """Return the factors that contain no kernel or wavenumber, over the ring without them."""
        ring = self._opened.plain
        plain = value.filter(lambda f: not any(int(d) for d in f.degrees()[len(ring.names) :])) * value.unit
        return plain.over(ring)

    def _hidden(self, value: Factored, table: KernelTable = NO_KERNELS) -> tuple[HiddenFactor, ...]:
        """Return the factors that depend on s, directly or through a kernel."""
        ring = value.ring
        varying = [ring.index[name] for name in (LAPLACE, *(k.generator for k in table.kernels))]
        return tuple(
            HiddenFactor(f, e) for f, e in value.factors if e > 0 and any(degree_in(f, i) for i in varying)
        )


def _lowest(value: Factored) -> Factored:
    """Return a coefficient or length without common factors that putting definitions in has left."""
    return cancel(value.numerator(), value.denominator())[0]


def nested_transfer(block: PlacedBlock, ring: Ring) -> tuple[Factored, Factored]:
    """Return a ``model`` block's function and what cancelled but powers of s; SF910 if either has waves."""
    if block.submodel is None or block.tf is None:
        raise ValueError(f"block '{block.name}' contains no model")
    tf = derive(assemble(block.submodel, nested_transfer), *block.tf)
    if not tf.whole.is_rational or tf.model.root:
        message = f"block '{block.name}' contains waves, a delay or a root of s, which no block can hold"
        hint = "write its elements and fields into this file"
        raise ModelError(Diagnostic("SF910", message, block.span, hint))
    inner = tf.ratio
    # What the outer ring lacks stands in a part of the inner model that its function does not use.
    hidden = Factored.number(inner.ring, 1)
    for factor in (f for f in tf.hidden if len(inner.ring.coefficients(f.polynomial)[0])):
        hidden = hidden * Factored.polynomial(inner.ring, factor.polynomial) ** factor.multiplicity
    return inner.over(ring), hidden.over(ring)
