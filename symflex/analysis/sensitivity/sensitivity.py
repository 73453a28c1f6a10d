"""How poles and zeros of a model move with its parameters, by implicit differentiation.

Input: a transfer function with the parameters as symbols, their values, and the roots found with numbers.
Output: a :class:`RootDerivative` per root and parameter. What is differentiated is the factor of the
numerator or denominator that makes the root: a :class:`RootBranch`.

Derivatives of polynomials are balls, carried forward from s or the parameter, through functions of constants,
the coefficients of the dispersion relations, wavenumbers and lengths, to the kernels (Griewank and Walther
2008, chapter 3).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Literal

from flint import acb, acb_mat, acb_series, arb, fmpz_mpoly

from symflex.algebra import (
    LAPLACE,
    NO_KERNELS,
    Dispersion,
    Factored,
    PolynomialMemo,
    Ring,
    square_free_factors,
)
from symflex.algebra.modal_sum import ModalSums
from symflex.algebra.vanishing import OriginSeries
from symflex.along.law import BoundLaw
from symflex.along.matrices import VaryingMatrices
from symflex.along.minors import MinorSums
from symflex.analysis.sensitivity.of_equations import (
    MOST_TIMES,
    SingularMatrix,
    derivatives,
    is_fixed_at_zero,
)
from symflex.balls import Arithmetic, EvaluationPlan, Value, bits_for_digits, plan, precision, precisions
from symflex.budget import spend
from symflex.expressions import Call, Expression
from symflex.loops import pick_gain
from symflex.model import ExactValue, Model, ModelParameter, with_numbers
from symflex.model.along import COORDINATE, is_tapered, varies_along_x
from symflex.model.brackets import slope_along_x
from symflex.model.loss_factors import check_causal
from symflex.roots import PoleZeroMap, Root
from symflex.roots.root import GUARD_BITS, decimals, exact_fraction, real_json
from symflex.transfer import AnyBoundFunction, TransferFunction
from symflex.transfer.enclose import constant_tangent, enclosure, first_order, later
from symflex.transfer.enclose_kernels import KernelValues
from symflex.transfer.equations_at import EquationsAt
from symflex.transfer.of_model import NEVER_LARGE, assemble_sparse, derive_all

Kind = Literal["pole", "zero"]
Status = Literal["certified", "multiple", "undecided"]

LEAST_DIGITS = 15


@dataclass(frozen=True, slots=True, eq=False)
class RootDerivative:
    """The derivative of a root with respect to a parameter."""

    kind: Kind  # ``pole`` or ``zero``
    index: int  # position of the root among the map's poles or zeros
    root: Root  # the root
    parameter: ModelParameter  # what varies
    value: ExactValue  # the parameter's value [its unit]
    status: Status  # proved, without one as roots coincide and part, or not enclosed
    place: acb  # the root, perhaps closer than in ``root`` [rad/s]
    derivative: acb | None = None  # ds/dp [rad/s per unit of the parameter]

    @property
    def relative(self) -> acb | None:
        """``(1/s) ds/dp`` [1 per unit of the parameter], ``None`` at s = 0."""
        if self.derivative is None or self.place.contains(0):
            return None
        with precision(self._bits):
            return self.derivative / self.place

    @property
    def normalised(self) -> acb | None:
        """``(p/s) ds/dp``, the relative change of the root per relative change of the parameter.

        Its real part is that of the natural frequency; ``None`` at s = 0.
        """
        relative = self.relative
        if relative is None:
            return None
        with precision(self._bits):
            return relative * self.exact_value()

    @property
    def _loss(self) -> arb | None:
        """The loss factor of ``s^2 = -omega_r^2 (1 + j eta_r)``, None without."""
        if self.root.loss_factor() is None:
            return None
        with precision(self._bits):
            square = self.place**2
            return square.imag / square.real

    @property
    def rate(self) -> arb | None:
        """``(1/f) df/dp`` of the natural frequency f [1 per unit of the parameter], ``None`` at s = 0.

        With loss factors f is ``omega_r/(2 pi)``, and ``2 ds/s = 2 df/f + j deta/(1 + j eta)``.
        """
        relative, loss = self.relative, self._loss
        if relative is None or loss is None:
            return None if relative is None else relative.real
        with precision(self._bits):
            return relative.real - loss * relative.imag

    @property
    def frequency(self) -> arb | None:
        """df/dp of the natural frequency ``f = abs(s)/(2 pi)`` [Hz per unit of the parameter]."""
        rate = self.rate
        if rate is None:
            return None
        with precision(self._bits):
            size = abs(self.place) if self._loss is None else (-(self.place**2).real).sqrt()
            return size * rate / (2 * arb.pi())

    @property
    def damping_ratio(self) -> arb | None:
        """dzeta/dp of ``zeta = -re/abs(s)`` [1 per unit of the parameter]; ``None`` for real roots.

        With s in polar coordinates zeta is minus the cosine of its angle, which turns by
        the imaginary part of (1/s) ds/dp. ``None`` with loss factors, too.
        """
        relative = self.relative
        if relative is None or self.root.is_real or self._loss is not None:
            return None
        with precision(self._bits):
            return relative.imag * self.place.imag / abs(self.place)

    @property
    def loss_factor(self) -> arb | None:
        """deta/dp of the loss factor [1 per unit of the parameter]; ``None`` without."""
        relative, loss = self.relative, self._loss
        if relative is None or loss is None:
            return None
        with precision(self._bits):
            return 2 * (1 + loss**2) * relative.imag

    def exact_value(self) -> arb:
        """Return the parameter's value at the current precision."""
        return enclosure(self.value)()

    @property
    def _bits(self) -> int:
        derivative = acb(0) if self.derivative is None else self.derivative
        return max(bits_for_digits(LEAST_DIGITS), self.place.bits(), derivative.bits()) + GUARD_BITS

    def to_json_dict(self, digits: int) -> dict[str, object]:
        """Return the sensitivity as JSON data, with at most so many digits in each number."""
        decimal = decimals(self.root.re, self.root.im, digits)
        return {
            "of": self.kind,
            "index": self.index,
            "re": decimal.re,
            "im": decimal.im,
            "parameter": self.parameter.name,
            "unit": self.parameter.unit,
            "status": self.status,
            "derivative": _complex_json(self.derivative, digits),
            "normalised": _complex_json(self.normalised, digits),
            "frequency_hz": real_json(self.frequency, digits),
            "damping_ratio": real_json(self.damping_ratio, digits),
            **({} if self._loss is None else {"loss_factor": real_json(self.loss_factor, digits)}),
        }


def _complex_json(value: acb | None, digits: int) -> dict[str, str] | None:
    if value is None:
        return None
    printed = decimals(value.real, value.imag, digits)
    return {"re": printed.re, "im": printed.im, "radius": printed.radius}


def differentiate(
    tf: TransferFunction,
    values: Mapping[str, ExactValue],
    located: PoleZeroMap,
    parameters: Sequence[ModelParameter] | None = None,
    digits: int = 15,
) -> tuple[RootDerivative, ...]:
    """Return how roots that are ``located`` move with parameters, by default all: poles first."""
    used = [p for p in tf.parameters if parameters is None or p in parameters]
    if tf.ratio.is_zero:
        return ()
    tangents = Tangents(tf, values)
    sides: tuple[tuple[Kind, Factored, Sequence[Root]], ...] = (
        ("pole", tf.den, located.poles),
        ("zero", tf.num, located.zeros),
    )
    moved: list[RootDerivative] = []
    for kind, part, roots in sides:
        side = _Side(tangents, part, digits, {})
        for i, root in enumerate(roots):
            for parameter in used:
                spend()
                status, location, derivative = side.moved(root, parameter.name)
                value = values[parameter.name]
                moved.append(RootDerivative(kind, i, root, parameter, value, status, location, derivative))
    return tuple(moved)


Movement = tuple["Status", acb, "acb | None"]


@dataclass(frozen=True, slots=True, eq=False)
class _Side:
    """A numerator or denominator; what is known of its roots is kept, the upper of each pair."""

    tangents: Tangents
    part: Factored
    digits: int
    branches: dict[tuple[Fraction, Fraction], RootBranch | Obstacle]

    def moved(self, root: Root, parameter: str) -> Movement:
        """Return the status, the place and the derivative of a root."""
        if root.im < 0:
            with precision(root.working_bits()):
                upper = replace(root, im=-root.im)
            status, location, derivative = self.moved(upper, parameter)
            return status, _conjugate(location), None if derivative is None else _conjugate(derivative)
        if root.is_zero and self._is_fixed_at_zero(root):
            return "certified", acb(0), acb(0)
        key = (exact_fraction(root.re), exact_fraction(root.im))
        if key not in self.branches:
            self.branches[key] = find_branch(self.tangents, self.part, root)
        branch = self.branches[key]
        if not isinstance(branch, RootBranch):
            return branch, root.enclosure(), None
        wanted = bits_for_digits(self.digits)
        first = max(root.working_bits(), 2 * wanted)
        derivative = None
        for bits in precisions(first, MOST_TIMES * first):
            closer = branch.refined(bits)
            if closer is None:
                return "undecided", root.enclosure(), None
            branch = self.branches[key] = closer
            derivative = branch.derivative(parameter, bits)
            if derivative.is_finite() and derivative.rel_accuracy_bits() >= wanted:
                break
        if derivative is None or not derivative.is_finite():
            return "undecided", branch.root, None
        return "certified", branch.root, derivative

    def _is_fixed_at_zero(self, root: Root) -> bool:
        """Tell whether for all values of the parameters as many roots are at 0 as for these."""
        ring, table = self.tangents.tf.ratio.ring, self.tangents.tf.kernels
        if not table:
            return self.part.exponent_of(ring.context.gen(0)) == root.multiplicity
        return OriginSeries(ring, table).order(self.part) == root.multiplicity


def _conjugate(value: acb) -> acb:
    with precision(max(2, value.bits())):
        return value.conjugate()


Obstacle = Literal["multiple", "undecided"]


@dataclass(frozen=True, slots=True, eq=False)
class RootBranch:
    """A function that is zero at a root, where its slope in s is not: so roots follow the parameters."""

    tangents: Tangents  # evaluates the function
    factor: fmpz_mpoly  # the function
    root: acb  # holds one root of it [rad/s]

    def refined(self, bits: int) -> RootBranch | None:
        """Return the branch with the root to about so many bits (Moore 1966), ``None`` if it has none."""
        with precision(bits):
            root = self.root
            for _ in range(bits.bit_length()):
                middle = root.mid()
                value, _ = self.tangents.polynomial(self.factor, self.tangents.along("s", middle))
                _, slope = self.tangents.polynomial(self.factor, self.tangents.along("s", root))
                step = middle - value / slope
                if not step.is_finite():
                    break
                if not step.overlaps(root):
                    return None
                closer = acb(step.real.intersection(root.real), step.imag.intersection(root.imag))
                if not closer.rad() < root.rad() / 2:
                    break
                root = closer
            return RootBranch(self.tangents, self.factor, root)

    def derivative(self, parameter: str, bits: int) -> acb:
        """Return ``ds/dp = -(df/dp)/(df/ds)`` at the current enclosure of the root."""
        with precision(bits):
            along_s, along_p = (self.tangents.along(name, self.root) for name in ("s", parameter))
            _, slope = self.tangents.polynomial(self.factor, along_s)
            _, change = self.tangents.polynomial(self.factor, along_p)
            return -change / slope


def find_branch(tangents: Tangents, part: Factored, root: Root) -> RootBranch | Obstacle:
    """Return the factor that alone is zero at a root, and simply; else why there is none."""
    location, first = root.enclosure(), root.working_bits()
    for bits in precisions(first, MOST_TIMES * first):
        meeting = _meeting(tangents, [f for f, _ in part.factors], location, bits)
        if meeting is not None and len(meeting) == 1 and root.multiplicity > 1:
            # Twice the same factor, multiplied out: such a root stays double, and moves.
            _, square_free = square_free_factors(meeting[0])
            meeting = _meeting(tangents, [f for f, _ in square_free], location, bits)
        if meeting is not None and len(meeting) == 1 and _is_simple(tangents, meeting[0], location, bits):
            return RootBranch(tangents, meeting[0], location)
        if meeting == []:
            return "undecided"
    return "multiple" if root.multiplicity > 1 and root.certified else "undecided"


def _meeting(tangents: Tangents, factors: Sequence[fmpz_mpoly], s: acb, bits: int) -> list[fmpz_mpoly] | None:
    """Return the factors that may be zero at a root, ``None`` when some have no value there."""
    with precision(bits):
        point = tangents.along("s", s)
        values = [(f, tangents.polynomial(f, point)[0]) for f in factors]
    if not all(value.is_finite() for _, value in values):
        return None
    return [f for f, value in values if value.contains(0)]


def _is_simple(tangents: Tangents, factor: fmpz_mpoly, s: acb, bits: int) -> bool:
    with precision(bits):
        _, slope = tangents.polynomial(factor, tangents.along("s", s))
        return slope.is_finite() and not slope.contains(0)


def sensitivities(
    model: Model, bound: AnyBoundFunction, located: PoleZeroMap, names: Sequence[str] = (), digits: int = 15
) -> tuple[RootDerivative, ...]:
    """Return how poles and zeros move with parameters, by default all; SF902 for an unknown name."""
    check_causal(model, "a sensitivity")
    for name in names:
        pick_gain(model.parameters, name)
    given = dict(bound.values)
    values = {p.name: given.get(p.name, p.value) for p in model.parameters}
    real = {name: value for name, value in values.items() if value is not None}
    settable = [p.name for p in model.settable if not p.is_solved_with]
    chosen = [p for p in model.settable if p.name in real and p.name in (names or settable)]
    pair = (bound.source.output.name, bound.source.input.name)
    if (
        not bound.is_reduced
        or model.imaginary
        or (not model.is_distributed and len(model.elements) > NEVER_LARGE)
    ):
        return _of_equations(model, pair, real, located, chosen, digits)
    if model.is_distributed:
        return differentiate(bound.symbolic or bound.source, real, located, chosen, digits)
    # One symbol at a time, among numbers, is far less than all at once.
    moved: list[RootDerivative] = []
    for parameter in chosen:
        (tf,) = derive_all(with_numbers(model, (parameter.name,), real), [pair])
        moved += differentiate(tf, real, located, [parameter], digits)
    return tuple(sorted(moved, key=lambda m: (m.kind, m.index)))


def _of_equations(
    model: Model,
    pair: tuple[str, str],
    values: Mapping[str, ExactValue],
    located: PoleZeroMap,
    parameters: Sequence[ModelParameter],
    digits: int,
) -> tuple[RootDerivative, ...]:
    """Return how roots of a function move whose closed form is large; see :func:`sensitivities`."""
    at, names = EquationsAt(assemble_sparse(model), tuple(values.items())), tuple(p.name for p in parameters)
    sides: tuple[tuple[Kind, SingularMatrix, Sequence[Root]], ...] = (
        ("pole", SingularMatrix(at, at.entries()), located.poles),
        ("zero", SingularMatrix(at, at.entries(*pair)), located.zeros),
    )
    moved: list[RootDerivative] = []
    is_real = model.imaginary is None
    for kind, matrix, roots in sides:
        upper: tuple[acb, dict[str, acb | None]] | None = None
        for i, root in enumerate(roots):
            status: Status = "certified"
            slopes: dict[str, acb | None]
            if root.is_zero and is_fixed_at_zero(at, pair, root, is_pole=kind == "pole"):
                location, slopes = acb(0), dict.fromkeys(names, acb(0))
            elif root.multiplicity > 1:
                # Whether it parts is not read off the equations.
                status, location, slopes = "undecided", root.enclosure(), {}
            elif (
                root.im < 0
                and is_real
                and upper is not None
                and upper[0].conjugate().overlaps(root.enclosure())
            ):
                location = _conjugate(upper[0])
                slopes = {n: x if x is None else _conjugate(x) for n, x in upper[1].items()}
            else:
                location, slopes = upper = derivatives(matrix, root, names, digits)
            for parameter in parameters:
                slope = slopes.get(parameter.name)
                said: Status = "undecided" if status == "certified" and slope is None else status
                moved.append(
                    RootDerivative(kind, i, root, parameter, values[parameter.name], said, location, slope)
                )
    return tuple(moved)


@dataclass(frozen=True, eq=False, slots=True)
class TangentPoint:
    """The generators of a ring to first order, and what evaluates polynomials in them."""

    kernels: KernelValues
    values: dict[str, Value]


@dataclass(frozen=True, eq=False)
class Tangents:
    """Evaluates what a transfer function is made of, to first order."""

    tf: TransferFunction  # with symbols
    values: Mapping[str, ExactValue]  # of all parameters that occur

    def along(self, direction: str, s: acb) -> TangentPoint:
        """Return all generators at ``s`` [rad/s] to first order in ``direction``: ``s`` or a parameter."""
        real = {name: first_order(enclosure(v)(), int(name == direction)) for name, v in self.values.items()}
        tangents = {"pi": first_order(arb.pi()), **real}
        for constant in self.tf.constants:
            if constant.generator in self._used and constant.generator not in self._functions:
                tangents[constant.generator] = constant_tangent(constant.expression, real)
        ring, table = self.tf.ratio.ring, self.tf.kernels
        numbers: dict[str, Arithmetic] = {name: _series(acb(x[0]), acb(x[1])) for name, x in tangents.items()}
        kernels = KernelValues(ring.names, table, numbers, ModalSums(ring, NO_KERNELS), self._plans)
        point = TangentPoint(kernels, kernels.at(_series(s, acb(int(direction == LAPLACE)))))
        for law in table.dispersions:
            if law.matrix:
                point.values.update(self._entries(law, direction, point))
        return point

    def _entries(self, law: Dispersion, direction: str, point: TangentPoint) -> dict[str, Value]:
        """Return the entries of the fundamental matrices of a law that varies along x.

        In s their series are known. In a parameter ``Z' = A Z`` is differentiated: what takes z and
        dz/dp along has A on its diagonal and dA/dp below; and where x begins and ends may move. From a tip
        the way is differentiated at, not x: solutions are power series in it.
        """
        s, kernels = _lifted(point.values[LAPLACE]), self.tf.kernels.kernels_of(law)
        if direction == LAPLACE:
            minors = self._varying.minors.entries
            places = [minors[self.tf.ratio.ring.index[k.generator]] for k in kernels]
            values = (self._varying.value(position, s) for position in places)
            return {k.generator: _lifted(x) for k, x in zip(kernels, values, strict=True)}
        n, entries = law.order, dict[str, Value]()
        tangent, start = self._tangent_law(law, direction), self.product(law.start[0], point)
        matrices: dict[Factored, tuple[list[list[acb]], acb_mat]] = {}
        for kernel in kernels:
            if kernel.length not in matrices:
                end = start + self.product(kernel.length, point)
                matrix = tangent.matrix_at(s[0], (start[0].real, end[0].real))
                slopes = acb_mat([row[:n] for row in matrix[n:]])
                fundamental = acb_mat([row[:n] for row in matrix[:n]])
                rate = end[1] if law.singular is None else end[1] - start[1]
                slopes += _coefficients(tangent, n, end[0], s[0]) * rate * fundamental
                if law.singular is None:
                    slopes -= fundamental * _coefficients(tangent, n, start[0], s[0]) * start[1]
                matrices[kernel.length] = matrix, slopes
            matrix, slopes = matrices[kernel.length]
            row, column = divmod(kernel.order, n)
            entries[kernel.generator] = _series(matrix[row][column], slopes[row, column])
        return entries

    def _tangent_law(self, law: Dispersion, parameter: str) -> BoundLaw:
        """Return the law of states and of their derivatives by a parameter, at x or the way from a tip."""
        if (law, parameter) in self._laws:
            return self._laws[law, parameter]
        source, values = self.tf.ratio.ring, {n: enclosure(v) for n, v in self.values.items()}
        moving, functions = [parameter], dict[str, Expression](self._functions)
        constants = dict(self._constants)
        for each in (c for c in self.tf.constants if c.generator in self._used):
            slope, name = slope_along_x(each.expression, parameter), f"d[{each.generator}]"
            if slope is None:
                continue
            moving.append(each.generator)
            if each.generator in self._functions:
                functions[name] = slope
            else:
                constants[name] = later(slope, values)
        along = {} if law.singular is None else {g: slope_along_x(f) for g, f in self._functions.items()}
        functions |= {f"x[{g}]": slope for g, slope in along.items() if slope is not None}
        ring = Ring((*source.names, *(f"d[{name}]" for name in moving[1:]), *(f"x[{g}]" for g in along)))

        def slope_of(value: Factored) -> Factored:
            total = Factored.number(ring, 0)
            for name in moving:
                rate = value.slope(name).over(ring)
                total = total + (rate if name == parameter else rate * Factored.generator(ring, f"d[{name}]"))
            return total + (0 if origin.is_zero else origin * slope_along(value))

        def slope_along(value: Factored) -> Factored:
            total = value.slope(COORDINATE).over(ring)
            for g in along:
                total = total + value.slope(g).over(ring) * Factored.generator(ring, f"x[{g}]")
            return total

        def doubled(matrix: Sequence[Sequence[Factored]]) -> tuple[tuple[Factored, ...], ...]:
            upper = [(*(x.over(ring) for x in row), *zero) for row in matrix]
            return (*upper, *((*map(slope_of, row), *(x.over(ring) for x in row)) for row in matrix))

        zero = (Factored.number(ring, 0),) * law.order
        start = tuple(x.over(ring) for x in law.start)
        origin, tip = zero[0], law.singular
        if tip is not None:
            origin = slope_of(law.start[0])
            orders = [(*row, *(0 for _ in row)) for row in tip.orders]
            tip = replace(
                tip,
                powers=2 * tip.powers,
                orders=(*orders, *(2 * row for row in tip.orders)),
                matrix=doubled(tip.matrix),
                values=doubled(tip.values),
            )
        made = replace(law, matrix=doubled(law.matrix), start=start, shift=start[0] * 0, singular=tip)
        self._laws[law, parameter] = BoundLaw(made, functions, start[0], constants, values)
        return self._laws[law, parameter]

    @cached_property
    def _functions(self) -> Mapping[str, Call]:
        """The functions of the coordinate along x among the generators."""
        if not is_tapered(self.tf.model):
            return {}
        used = (c for c in self.tf.constants if c.generator in self._used)
        return {c.generator: c.expression for c in used if varies_along_x(c.expression)}

    @property
    def _constants(self) -> Mapping[str, Callable[[], arb]]:
        """How to enclose every generator free of s and x."""
        values: dict[str, Callable[[], arb]] = {n: enclosure(v) for n, v in self.values.items()}
        used = (c for c in self.tf.constants if c.generator in self._used)
        more = {c.generator: later(c.expression, values) for c in used if c.generator not in self._functions}
        return {**values, "pi": arb.pi, **more}

    @cached_property
    def _varying(self) -> VaryingMatrices:
        values = {n: enclosure(v) for n, v in self.values.items()}
        minors = MinorSums(self.tf.ratio.ring, self.tf.kernels)
        return VaryingMatrices(minors, self._constants, self._functions, values)

    @cached_property
    def _laws(self) -> dict[tuple[Dispersion, str], BoundLaw]:
        return {}

    def polynomial(self, polynomial: fmpz_mpoly, point: TangentPoint) -> tuple[acb, acb]:
        """Return the value of a polynomial of the ring, and its derivative."""
        value = _lifted(point.kernels.polynomial(polynomial, point.values))
        return value[0], value[1]

    def product(self, value: Factored, point: TangentPoint) -> acb_series:
        """Return a product of powers of polynomials to first order."""
        return _lifted(point.kernels.value(value, point.values))

    @cached_property
    def _plans(self) -> PolynomialMemo[EvaluationPlan]:
        return PolynomialMemo(plan)

    @cached_property
    def _used(self) -> frozenset[str]:
        """The generators that occur; constants that do not may have no value."""
        parts = (self.tf.num, self.tf.den, *self.tf.kernels.values)
        return self.tf.ratio.ring.used_in(factor for part in parts for factor, _ in part.factors)


def _coefficients(law: BoundLaw, size: int, x: acb, s: acb) -> acb_mat:
    """Return the coefficients of the first states at a place."""
    along = law.along(x)
    return acb_mat([[law.value(c, along, s) for c in row[:size]] for row in law.law.matrix[:size]])


def _series(value: acb, slope: acb) -> acb_series:
    return acb_series([value, slope], 2)


def _lifted(value: acb | acb_series) -> acb_series:
    return _series(value, acb(0)) if isinstance(value, acb) else value
