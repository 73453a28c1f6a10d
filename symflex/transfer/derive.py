"""From equations to transfer functions, by Cramer's rule on one shared elimination.

Input: :class:`symflex.equations.Equations`.
Output: :class:`TransferFunction` for every pair asked for, reduced exactly.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from symflex.elimination import Determinants, explain_singular
from symflex.errors import Diagnostic, ModelError
from symflex.kernels import LAPLACE, NO_KERNELS, Factored, KernelTable, Ring, degree_in
from symflex.transfer.cancel import cancel
from symflex.transfer.compose import compose_rational
from symflex.transfer.coprimality import Images
from symflex.transfer.distributed import KernelReduction, embedded_table
from symflex.transfer.quantity import name_quantity, unit_of_quotient
from symflex.transfer.transfer_function import ClosedForm, HiddenFactor, TransferFunction

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import fmpz_mpoly

    from symflex.elimination import Closure
    from symflex.equations import Equations, OutputRow
    from symflex.kernels import Propagation
    from symflex.model import Input, Output


def derive(equations: Equations, output: str, source: str) -> TransferFunction:
    """Return one transfer function.

    Parameters
    ----------
    equations : Equations
        Assembled.
    output, source : str
        Names of an output and an input.

    Raises
    ------
    ModelError
        SF30x when the equations are singular, with the reason.
    BudgetError
        SF50x when the closed form would be too large.
    """
    return derive_all(equations, ((output, source),))[0]


def derive_all(equations: Equations, pairs: Sequence[tuple[str, str]]) -> tuple[TransferFunction, ...]:
    """Return several transfer functions that share one elimination; see :func:`derive`."""
    determinants = Determinants.of(equations)
    workshop = _Workshop(equations, determinants.system.closure, determinants.den)
    outputs = {row.name: row for row in equations.outputs}
    return tuple(
        workshop.finish(outputs[output], source, determinants.num(output, source)) for output, source in pairs
    )


class _Workshop:
    """Reduces one Cramer quotient after the other over the same denominator."""

    def __init__(self, equations: Equations, closure: Closure, den: fmpz_mpoly) -> None:
        self._equations = equations
        self._closure = closure
        self._den = den
        model = equations.model
        plain = (
            LAPLACE,
            *(p.name for p in model.parameters),
            "pi",
            *(c.generator for c in equations.constants),
        )
        propagation = equations.propagation
        self._plain = Ring(plain)
        self._ring = self._plain if propagation is None else Ring((*plain, *propagation.table.generators))
        self._images = Images(self._ring)
        self._denominators: list[tuple[fmpz_mpoly, Factored]] = []
        self._definitions: dict[str, Factored] = {}
        if propagation is not None:
            # Propagators hold no definitions, but definitions may hold delays.
            images = [self._generator(n) for n in propagation.kernel_ring.names]
            for p in propagation.propagators:
                self._definitions[p.generator] = compose_rational(self._ring, p.image, images)
        for name, value in equations.definitions:
            self._definitions[name] = self._expanded(value)
        self._reduction = None if propagation is None else self._kernel_reduction(propagation)

    def _kernel_reduction(self, propagation: Propagation) -> KernelReduction:
        """Return how quotients of kernels are reduced, with definitions opened everywhere."""
        table = propagation.table
        opened = [(v, self._expanded(propagation.embed(v))) for v in table.values]
        self._cleared = self._expanded(self._equations.cleared or Factored.number(propagation.ring, 1))
        parameters = [p.name for p in self._equations.model.parameters]
        return KernelReduction(self._ring, embedded_table(table, opened), parameters, propagation.coordinates)

    def finish(self, row: OutputRow, source: str, num: fmpz_mpoly) -> TransferFunction:
        """Return the reduced transfer function ``num / den / divisor``."""
        model = self._equations.model
        output = next(o for o in model.outputs if o.name == row.name)
        given = next(i for i in model.inputs if i.name == source)
        known = dict(model.quotients).get((output.name, given.name))
        # For a zero numerator the common factor is the whole denominator: every mode is hidden.
        common = num.gcd(self._den)
        num_closed, den_closed = num / common, self._den / common
        shared = self._expanded(self._closure.open(common))
        divisor = self._closure.close(row.divisor)
        den_closed = den_closed * divisor
        final = num_closed.gcd(den_closed)
        num_closed, den_closed = num_closed / final, den_closed / final
        shared = shared * self._expanded(self._closure.open(final))
        denominator = self._opened_denominator(den_closed)
        if self._reduction is not None:
            return self._finish_distributed(output, given, num_closed, denominator, shared)
        if denominator.is_zero:
            raise explain_singular(self._equations)
        if denominator.unit < 0:
            num_closed, den_closed, denominator = -num_closed, -den_closed, -denominator
        numerator = self._expanded(self._closure.open(num_closed))
        ratio, cancelled = cancel(numerator, denominator, self._images)
        return TransferFunction(
            output,
            given,
            ratio,
            ClosedForm(self._closure, num_closed, den_closed) if cancelled.is_one else None,
            self._hidden(shared * cancelled),
            name_quantity(output, given, known),
            unit_of_quotient(output, given, known),
            self._equations.ring,
            self._equations.definitions,
            self._equations.constants,
            model,
        )

    def _finish_distributed(
        self,
        output: Output,
        given: Input,
        num: fmpz_mpoly,
        denominator: Factored,
        hidden: Factored,
    ) -> TransferFunction:
        """Return the transfer function of a distributed system, with the kernels' relations used."""
        reduction = self._reduction
        numerator = self._expanded(self._closure.open(num))
        reduced = (
            None
            if reduction is None or denominator.is_zero
            else reduction.reduce(numerator, denominator, hidden / self._cleared)
        )
        if reduction is None or reduced is None:
            raise explain_singular(self._equations)
        above, below, table = reduced.num, reduced.den, reduced.table
        if below.unit < 0:
            above, below = -above, -below
        determinant = self._expanded(self._closure.open(self._den)) / self._cleared
        cancelled = reduced.shared * reduction.hidden_where_waves_vanish(determinant, reduced)
        ratio = above / below
        if not any(reduction.has_kernels(f) for f, _ in ratio.factors):
            table = NO_KERNELS
            ratio, above, below, cancelled = (
                self._without_kernels(v) for v in (ratio, above, below, cancelled)
            )
        if table:
            table = table.restricted(_generators_in(above, below, cancelled))
        model = self._equations.model
        known = dict(model.quotients).get((output.name, given.name))
        return TransferFunction(
            output,
            given,
            ratio,
            None,
            self._hidden(cancelled, table),
            name_quantity(output, given, known),
            unit_of_quotient(output, given, known),
            self._equations.ring,
            self._equations.definitions,
            self._equations.constants,
            model,
            table,
            (above, below) if table else None,
        )

    def _without_kernels(self, value: Factored) -> Factored:
        """Return the factors that hold no kernel or wavenumber, over the ring without them."""
        gens = self._plain.context.gens()
        zero = self._plain.constant(0)
        images = [gens[i] if i < len(gens) else zero for i in range(len(self._ring.names))]
        count = len(gens)
        result = Factored.number(self._plain, value.unit)
        for factor, exponent in value.factors:
            if not any(int(d) for d in factor.degrees()[count:]):
                plain = Factored.polynomial(self._plain, factor.compose(*images, ctx=self._plain.context))
                result = result * plain**exponent
        return result

    def _opened_denominator(self, closed: fmpz_mpoly) -> Factored:
        """Return a closed denominator over the parameters; most pairs share one."""
        for known, opened in self._denominators:
            if known == closed:
                return opened
        opened = self._expanded(self._closure.open(closed))
        self._denominators.append((closed, opened))
        return opened

    def _expanded(self, value: Factored) -> Factored:
        """Return a value over the equations' ring with its definitions opened."""
        if self._ring == self._equations.ring:
            return value
        names = self._equations.ring.names
        images = [self._definitions[n] if n in self._definitions else self._generator(n) for n in names]
        return value.map_factors(self._ring, lambda factor: self._open(factor, images))

    def _generator(self, name: str) -> Factored | None:
        return Factored.generator(self._ring, name) if name in self._ring.index else None

    def _open(self, factor: fmpz_mpoly, images: Sequence[Factored | None]) -> Factored:
        degrees = factor.degrees()
        used = [images[i] for i, d in enumerate(degrees) if int(d)]
        known = [image for image in used if image is not None]
        if len(known) != len(used):
            message = "a definition uses one that is not resolved yet"
            raise ModelError(Diagnostic("SF215", message))
        if len(factor) == 1:
            return known[0]
        return compose_rational(self._ring, factor, images)

    def _hidden(self, value: Factored, table: KernelTable = NO_KERNELS) -> tuple[HiddenFactor, ...]:
        """Return the factors that depend on s, directly or through a kernel."""
        ring = value.ring
        varying = [ring.index[name] for name in (LAPLACE, *(k.generator for k in table.kernels))]
        return tuple(
            HiddenFactor(f, e) for f, e in value.factors if e > 0 and any(degree_in(f, i) for i in varying)
        )


def _generators_in(*values: Factored) -> set[str]:
    """Return the names of all generators that occur."""
    names = values[0].ring.names
    return {
        names[i] for v in values for f, _ in v.factors for i, degree in enumerate(f.degrees()) if int(degree)
    }
