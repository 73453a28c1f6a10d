"""From equations to transfer functions, by Cramer's rule on one shared elimination.

Input: :class:`symflex.equations.Equations`.
Output: :class:`TransferFunction` for every pair asked for, reduced exactly.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from symflex.elimination import Minors, close, eliminate_unit_pivots, expansion_order, explain_singular
from symflex.errors import Diagnostic, ModelError
from symflex.kernels import LAPLACE, Factored, Ring, degree_in
from symflex.transfer.cancel import cancel
from symflex.transfer.coprimality import Images
from symflex.transfer.quantity import name_quantity, unit_of_quotient
from symflex.transfer.transfer_function import ClosedForm, HiddenFactor, TransferFunction

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import fmpz_mpoly

    from symflex.elimination import Closure
    from symflex.equations import Equations, OutputRow


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
    system = close(equations)
    reduced = eliminate_unit_pivots(system.rows, system.outputs, len(system.unknowns))
    if len(reduced.rows) != len(reduced.columns):
        raise explain_singular(equations)
    order = expansion_order(reduced.rows, reduced.columns)
    minors = Minors(system.closure.ring, tuple(reduced.rows[i] for i in order))
    every = sum(1 << c for c in reduced.columns)
    den = minors.determinant(every)
    if den.is_zero():
        raise explain_singular(equations)
    workshop = _Workshop(equations, system.closure, den)
    outputs = {
        row.name: (row, sparse) for row, sparse in zip(equations.outputs, reduced.outputs, strict=True)
    }
    found = []
    for output, source in pairs:
        row, sparse = outputs[output]
        column = len(system.unknowns) + [v.owner for v in system.inputs].index(source)
        # Cramer: det [C D; A B] over det A, up to the sign of moving the border from last row to first.
        num = minors.bordered(sparse, every | 1 << column)
        if len(reduced.columns) & 1:
            num = -num
        found.append(workshop.finish(row, source, num))
    return tuple(found)


class _Workshop:
    """Reduces one Cramer quotient after the other over the same denominator."""

    def __init__(self, equations: Equations, closure: Closure, den: fmpz_mpoly) -> None:
        self._equations = equations
        self._closure = closure
        self._den = den
        model = equations.model
        self._ring = Ring(
            (
                LAPLACE,
                *(p.name for p in model.parameters),
                "pi",
                *(c.generator for c in equations.constants),
            )
        )
        self._images = Images(self._ring)
        self._denominators: list[tuple[fmpz_mpoly, Factored]] = []
        self._definitions: dict[str, Factored] = {}
        for name, value in equations.definitions:
            self._definitions[name] = self._expanded(value)

    def finish(self, row: OutputRow, source: str, num: fmpz_mpoly) -> TransferFunction:
        """Return the reduced transfer function ``num / den / divisor``."""
        model = self._equations.model
        output = next(o for o in model.outputs if o.name == row.name)
        given = next(i for i in model.inputs if i.name == source)
        # For a zero numerator the common factor is the whole denominator: every mode is hidden.
        common = num.gcd(self._den)
        num_closed, den_closed = num / common, self._den / common
        hidden = self._hidden(self._expanded(self._closure.open(common)))
        divisor = self._closure.close(row.divisor)
        den_closed = den_closed * divisor
        final = num_closed.gcd(den_closed)
        num_closed, den_closed = num_closed / final, den_closed / final
        hidden = (*hidden, *self._hidden(self._expanded(self._closure.open(final))))
        denominator = self._opened_denominator(den_closed)
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
            _merge_hidden((*hidden, *self._hidden(cancelled))),
            name_quantity(output, given),
            unit_of_quotient(output, given, dict(model.quotients).get((output.name, given.name))),
            self._equations.ring,
            self._equations.definitions,
            self._equations.constants,
            model,
        )

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
        if all(_is_monomial(image) for image in known):
            zero = self._ring.constant(0)
            plain = [
                image.expand() if image is not None and int(d) else zero
                for image, d in zip(images, degrees, strict=True)
            ]
            return Factored.polynomial(self._ring, self._ring.compose(factor, plain))
        return _compose_rational(self._ring, factor, images)

    def _hidden(self, value: Factored) -> tuple[HiddenFactor, ...]:
        i = self._ring.index[LAPLACE]
        return tuple(HiddenFactor(f, e) for f, e in value.factors if degree_in(f, i))


def _is_monomial(image: Factored) -> bool:
    """Tell whether a definition or generator is one product of generators."""
    return image.unit == 1 and all(len(f) == 1 and e > 0 for f, e in image.factors)


def _compose_rational(ring: Ring, factor: fmpz_mpoly, images: Sequence[Factored | None]) -> Factored:
    """Return ``factor`` with rational functions in place of its generators."""
    degrees = [int(d) for d in factor.degrees()]
    denominators = {
        i: image.denominator()
        for i, (d, image) in enumerate(zip(degrees, images, strict=True))
        if d and image is not None
    }
    total = ring.constant(0)
    for monomial, coefficient in factor.terms():
        term = Factored.number(ring, Fraction(int(coefficient)))
        for i, exponent in enumerate(monomial):
            image = images[i]
            if degrees[i] and image is not None:
                below = denominators[i]
                term = term * (image * below) ** int(exponent) * below ** (degrees[i] - int(exponent))
        total = total + term.expand()
    scale = Factored.number(ring, 1)
    for i, below in denominators.items():
        scale = scale * below ** degrees[i]
    return Factored.polynomial(ring, total) / scale


def _merge_hidden(factors: Sequence[HiddenFactor]) -> tuple[HiddenFactor, ...]:
    merged: list[HiddenFactor] = []
    for factor in factors:
        for i, known in enumerate(merged):
            if known.polynomial == factor.polynomial:
                merged[i] = HiddenFactor(known.polynomial, known.multiplicity + factor.multiplicity)
                break
        else:
            merged.append(factor)
    return tuple(merged)
