"""Poles and zeros of a lumped transfer matrix: roots of irreducible factors of its determinants.

Input: a lumped model with numbers. Output: :class:`.matrix_roots.MatrixRoots`.

Example: ``G = [1/(s+1), 2/(s+3); 1/(s+1), 1/(s+1)]``. Candidates are s + 1 and s + 3, of det A, and s - 1, of
the equations with both outputs imposed. The determinant of A has s + 1 twice and s + 3 once, that of
the system matrix has s - 1 once, and no feedback leaves any of them: poles at -1, -1, -3, a zero at 1.

The candidates are exact. Arithmetic modulo a prime shows how often each divides the determinants of parts of
the system matrix; these numbers have to add up to the degrees.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from flint import fmpz, fmpz_mpoly, nmod_poly

from symflex.algebra import LAPLACE, Factored, Ring, degree_in, irreducible_factors
from symflex.budget import spend
from symflex.matrices.constrained import driven_at_once, imposed
from symflex.matrices.matrix_roots import DecouplingZero, MatrixRoots, directions, matrix_name
from symflex.matrices.system_matrix import ByPart, PrimeSystem, SystemMatrix
from symflex.model import Model
from symflex.roots import Mode, Modes, Region, RootProblem, find_pole_zero_map, find_polynomial_roots
from symflex.roots.pole_zero_map import chosen
from symflex.roots.polynomial_roots import in_order
from symflex.roots.problem import PolynomialInS, cancelled, problem_of
from symflex.transfer.of_model import assemble, derive_bound


@dataclass(frozen=True, eq=False)
class ExactMatrix:
    """A lumped matrix with numbers, and the irreducible factors of all its determinants."""

    name: str
    matrix: SystemMatrix
    factors: tuple[tuple[RootProblem, ByPart[int]], ...]
    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    rank: int

    @staticmethod
    def of(numbers: Model, outputs: tuple[str, ...], inputs: tuple[str, ...]) -> ExactMatrix | None:
        """Return the matrix; ``None`` where factors do not make up the determinants modulo a prime."""
        matrix = SystemMatrix.of(assemble(numbers), outputs, inputs)
        modulo = matrix.modulo
        if modulo is None or (divisors := modulo.divisors) is None:
            return None
        pairs = [(outputs[i], inputs[j]) for i, j in modulo.independent]
        found = _of_integers(matrix, modulo)
        if found is None:
            models = [driven_at_once(numbers, outputs, inputs), *([imposed(numbers, pairs)] if pairs else [])]
            found = _of_models(models, modulo)
        images = [image for _, image in found]
        orders = [divisors.orders(image) for image in images]
        for i, divisor in enumerate(divisors.each):
            if sum(o.each[i] * f.degree() for o, f in zip(orders, images, strict=True)) != divisor.degree():
                return None
        factors = tuple((problem, own) for (problem, _), own in zip(found, orders, strict=True))
        return ExactMatrix(matrix_name(outputs, inputs), matrix, factors, outputs, inputs, len(pairs))

    def _problem(self, order: Callable[[ByPart[int]], int]) -> RootProblem:
        parts = ((problem.factors, order(orders)) for problem, orders in self.factors)
        return RootProblem(tuple((f, e * n) for factors, n in parts if n for f, e in factors))

    def roots(self, region: Region | None, digits: int) -> MatrixRoots:
        """Return the roots in a region, all by default."""
        hidden = self._problem(lambda orders: orders.hidden)
        poles = self._problem(lambda orders: orders.modes - orders.hidden)
        zeros = self._problem(lambda orders: orders.system - orders.hidden)
        located = find_pole_zero_map(self.name, poles, zeros, region, digits, [(hidden, "cancelled")])
        where = located.region
        apart = []
        for factor, orders in ((f, o) for f, o in self.factors if o.hidden):
            both = orders.input_decoupling + orders.output_decoupling - orders.hidden
            for root in find_polynomial_roots(factor, digits):
                if isinstance(where, Modes | Mode) or chosen([root], where):
                    times = replace(root, multiplicity=orders.hidden)
                    counts = (orders.input_decoupling, orders.output_decoupling, both)
                    apart.append(DecouplingZero(times, *counts))
        order = {id(root): i for i, root in enumerate(in_order([each.root for each in apart]))}
        invariant = find_polynomial_roots(self._problem(lambda orders: orders.invariant), digits)
        return MatrixRoots(
            located,
            self.outputs,
            self.inputs,
            self.rank,
            chosen(invariant, where),
            tuple(sorted(apart, key=lambda each: order[id(each.root)])),
            directions(self.matrix, self.rank, located.zeros),
        )


Factors = list[tuple[RootProblem, nmod_poly]]  # irreducible, each with its image modulo the prime


def _of_integers(matrix: SystemMatrix, modulo: PrimeSystem) -> Factors | None:
    """Return the factors of the determinants of a matrix whose entries have no number but rational ones."""
    determinants = matrix.determinants(modulo.independent)
    if determinants is None:
        return None
    context, factors = Ring((LAPLACE,)).context, dict[tuple[int, ...], None]()
    for determinant in determinants:
        spend()
        terms: dict[tuple[int, ...], int | fmpz] = {(k,): int(c) for k, c in enumerate(determinant.coeffs())}
        for factor, _ in irreducible_factors(context.from_dict(terms))[1]:
            own = {int(power): int(c) for (power,), c in factor.terms()}
            factors[tuple(own.get(k, 0) for k in range(max(own) + 1))] = None
    return [
        (RootProblem(((PolynomialInS.from_integers(f), 1),)), nmod_poly([*f], modulo.prime))
        for f in factors
        if len(f) > 1
    ]


def _of_models(models: Sequence[Model], modulo: PrimeSystem) -> Factors:
    """Return the factors of the denominators of models, which are the determinants of their equations."""
    bounds = [derive_bound(m, [(m.outputs[0].name, m.inputs[0].name)])[0] for m in models]
    ring = Ring(tuple(dict.fromkeys(name for bound in bounds for name in bound.ratio.ring.names)))
    # Together with what cancelled, the denominators are the determinants of all equations.
    candidates = [f for b in bounds for f, _ in (b.den * cancelled(b)).over(ring).factors]
    irreducible: list[fmpz_mpoly] = []
    for candidate in candidates:
        parts = (f for f, _ in irreducible_factors(candidate)[1] if degree_in(f, 0))
        irreducible += [f for f in parts if f not in irreducible]
    bound = replace(bounds[0], ratio=Factored.number(ring, 1))
    return [(problem_of(bound, [(f, 1)]), modulo.image(f, ring)) for f in irreducible]
