"""Values of wavenumbers and kernels in balls, at a complex frequency or as a Taylor series about one.

Input: a kernel table whose coefficients are polynomials in s and constants with known enclosures.
Output: one value per generator of the ring, wavenumbers and kernels included.

Wavenumbers are square roots, on a branch that is analytic where they are asked for, or roots of a
characteristic polynomial, whose coefficients may be wide. The roots of the middle polynomial are isolated,
and boxes about them are proved to hold one root of every polynomial in the ball by interval Newton steps.

Example: a rod with ``gamma^2 = rho s^2/E``, c = sqrt(E/rho) = 5000 m/s, l = 1 m, at s = 10000j rad/s.

    gamma = s/c = 2j 1/m     cosh(gamma l) = cos(2) = -0.416...     sinh(gamma l) = j sin(2) = 0.909...j
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from flint import acb, acb_mat, acb_poly, acb_series, arb, fmpz_mpoly

from symflex.algebra.modal_sum import ModalSums, modal_amplitudes, mode_values
from symflex.balls import Arithmetic, Value, at_centre, ball, current_bits, narrowed, raised, stays_inside

if TYPE_CHECKING:
    from symflex.algebra import Dispersion, Factored, Kernel, KernelTable, PolynomialMemo
    from symflex.along.matrices import VaryingMatrices
    from symflex.along.minors import Minor
    from symflex.balls import EvaluationPlan


SIGNS = (1, -1)
ZERO = acb(0)
PAIR = 2  # terms of a series to first order: those for which roots of dispersions are found


@dataclass(frozen=True, eq=False)
class KernelValues:
    """Evaluates a ring of wavenumbers and kernels at the current precision."""

    names: Sequence[str]  # generators of the ring: s, constants, wavenumbers, kernels
    table: KernelTable  # over the same ring
    constants: Mapping[str, Arithmetic]  # enclosures of the constants, or how they vary
    sums: ModalSums  # over the same ring
    plans: PolynomialMemo[EvaluationPlan]  # shared by all precisions
    matrices: VaryingMatrices | None = None  # of laws whose coefficients vary along x
    is_modal: bool = True  # fundamental functions are sums over the roots of dispersions, if these are apart
    expands_modes: bool = False  # long series of them are such sums, too

    def at(
        self, s: Value, near: Mapping[str, Value] | None = None, root: Callable[[Value], Value] | None = None
    ) -> dict[str, Value]:
        """Return all generators at ``s`` [rad/s], a point, ball or series, on the branch of ``near``."""
        values: dict[str, Value] = {"s": s, **self._numbers}
        coefficients: dict[Dispersion, tuple[Value, ...]] = {}
        shifts: dict[Dispersion, Value] = {}
        for law in self.table.dispersions:
            characteristic = tuple(ZERO if c.is_zero else self.value(c, values) for c in law.characteristic)
            coefficients[law] = characteristic
            if not law.shift.is_zero:
                shifts[law] = self.value(law.shift, values)
            values.update(
                law.roots(characteristic, root) if root else _wavenumbers(law, characteristic, near)
            )
        fundamental: dict[tuple[Dispersion, Factored], tuple[Value, ...]] = {}
        is_long = isinstance(s, acb_series) and s.prec > PAIR
        roots = {} if is_long and not self.expands_modes else self._roots(coefficients)
        values.update(roots)
        for kernel in self.table.kernels:
            law = kernel.dispersion
            if kernel.function == "exp":
                length = self.value(kernel.length, values)
                values[kernel.generator] = (-shifts.get(law, acb(0)) * length + acb(0)).exp()
            elif kernel.function == "fundamental" and not roots:
                key = (law, kernel.length)
                if key not in fundamental:
                    length = self.value(kernel.length, values)
                    fundamental[key] = fundamental_functions(coefficients[law], length)
                values[kernel.generator] = fundamental[key][kernel.order]
            elif kernel.wavenumber:
                argument = values[kernel.wavenumber] * self.value(kernel.length, values)
                values[kernel.generator] = _kernel(kernel, argument)
        return values

    def generators_at(self, s: Value, near: Mapping[str, Value] | None = None) -> dict[str, Value]:
        """Return the values of all generators but kernels; see :meth:`at`."""
        values: dict[str, Value] = {"s": s, **self._numbers}
        for law in self.table.dispersions:
            if law.wavenumbers:
                characteristic = tuple(
                    ZERO if c.is_zero else self.value(c, values) for c in law.characteristic
                )
                values.update(_wavenumbers(law, characteristic, near))
        return values

    @cached_property
    def _numbers(self) -> dict[str, Value]:
        known = self.constants.items()
        return {name: acb(value) if isinstance(value, arb) else value for name, value in known}

    @cached_property
    def _laws(self) -> tuple[tuple[int, Dispersion], ...]:
        """The dispersions with fundamental functions, and their positions."""
        used = {m.dispersion for m in self.sums.modes if not m.is_decay}
        laws = enumerate(self.table.dispersions) if self.is_modal else ()
        return tuple((n, law) for n, law in laws if law in used)

    def _roots(self, coefficients: Mapping[Dispersion, Sequence[Value]]) -> dict[str, Value]:
        """Return the roots of all dispersions that have fundamental functions; none if some nearly meet."""
        named: dict[str, Value] = {}
        for number, law in self._laws:
            # Where waves of both directions are alike, roots come in pairs x, -x.
            even = law.order % 2 == 0 and all(c.is_zero for c in law.characteristic[1::2])
            roots = characteristic_roots(coefficients[law], even=even)
            if roots is None:
                return {}
            named.update({_root_name(number, i): root for i, root in enumerate(roots)})
        return named

    def _modal_sum(self, polynomial: fmpz_mpoly, values: Mapping[str, Value]) -> Value:
        """Return a polynomial in fundamental functions without the cancellation of what grows fastest."""
        modes = []
        for mode in self.sums.modes:
            length = self.value(mode.length, values)
            if mode.is_decay:
                roots = [-self.value(mode.dispersion.shift, values)]
            else:
                number = next(n for n, law in self._laws if law is mode.dispersion)
                roots = [values[_root_name(number, i)] for i in range(mode.roots)]
            modes.append(mode_values(roots, length))
        made = self.sums.of(polynomial)
        coefficients = [self._monomials(c, values) for c in made.coefficients]
        frames = [(f.slots, f.terms, f.keys) for f in made.frames]
        total: Value = acb(0)
        for amplitude, exponent in modal_amplitudes(modes, coefficients, frames):
            total = total + amplitude * (exponent + acb(0)).exp()
        return total

    def value(self, value: Factored, values: Mapping[str, Value]) -> Value:
        """Return a product of powers of polynomials."""
        known = self._products.get(value)
        if known is None:
            # What does not depend on s is evaluated once.
            varying = {self.names[0], *self.table.generators}
            plans = [(self.plans(f), e) for f, e in value.factors]
            is_constant = not any(self.names[i] in varying for p, _ in plans for i, _ in p.powers)
            total: Value = acb(ball(value.unit))
            moving = []
            for factor, exponent in value.factors:
                if is_constant:
                    total = total * raised(self.polynomial(factor, values), exponent)
                else:
                    moving.append((factor, exponent))
            known = self._products[value] = (total, tuple(moving))
        total, moving_factors = known
        for factor, exponent in moving_factors:
            total = total * raised(self.polynomial(factor, values), exponent)
        return total

    @cached_property
    def _products(self) -> dict[Factored, tuple[Value, tuple[tuple[fmpz_mpoly, int], ...]]]:
        return {}

    def polynomial(self, polynomial: fmpz_mpoly, values: Mapping[str, Value]) -> Value:
        """Return a polynomial of the ring."""
        named = self._laws and all(_root_name(n, 0) in values for n, _ in self._laws)
        if self.matrices is not None and self.matrices.minors.has_entries(polynomial):
            return self._sum_of_minors(self.matrices, polynomial, values)
        if named and self.sums.has_functions(polynomial):
            return self._modal_sum(polynomial, values)
        return self._monomials(polynomial, values)

    def _sum_of_minors(
        self, matrices: VaryingMatrices, polynomial: fmpz_mpoly, values: Mapping[str, Value]
    ) -> Value:
        """Return a polynomial in entries of fundamental matrices, by minors of these."""
        known: dict[Minor, Value] = {}
        total: Value = acb(0)
        for coefficient, product in matrices.minors.of(polynomial):
            term = self.polynomial(coefficient, values)
            for minor in product:
                if minor not in known:
                    known[minor] = matrices.value(minor, values["s"])
                term = term * known[minor]
            total = total + term
        return total

    def _monomials(self, polynomial: fmpz_mpoly, values: Mapping[str, Value]) -> Value:
        plan = self.plans(polynomial)
        return plan.value([raised(values[self.names[i]], e) for i, e in plan.powers])


def _wavenumbers(law: Dispersion, c: Sequence[Value], near: Mapping[str, Value] | None) -> dict[str, Value]:
    """Return the roots by their names; every branch serves, because functions are symmetric in them."""
    if law.kind == "pair":
        known = [_middle(near[name]) ** 2 for name in law.wavenumbers] if near else []
        named = dict(zip(law.wavenumbers, map(square_root, _squares(c, *known)), strict=True))
    else:
        named = law.roots(c, square_root)
    if near is None:
        return named
    return {
        name: _closest(_turned(value, 4 if law.kind == "bending" else 2), _middle(near[name]))
        for name, value in named.items()
    }


def _squares(c: Sequence[Value], *near: acb) -> tuple[Value, Value]:
    """Return the squares of a pair, the smaller one from their product if that is sharper."""
    middle = -c[2] / 2
    root = square_root(middle * middle - c[0])
    if near:
        root = _closest((root, -root), (near[0] - near[1]) / 2)
    plus, minus = middle + root, middle - root
    if abs(_middle(plus)) < abs(_middle(minus)):
        return _sharper(plus, c[0], minus), minus
    return plus, _sharper(minus, c[0], plus)


def _sharper(direct: Value, product: Value, other: Value) -> Value:
    if at_centre(other).contains(0):
        return direct
    return min((direct, product / other), key=lambda value: float(at_centre(value).rad()))


def _middle(value: Value) -> acb:
    return at_centre(value).mid()


def _turned(value: Value, branches: int) -> tuple[Value, ...]:
    """Return the values a root of a number has."""
    turned = value * acb(0, 1)
    return (value, -value) if branches == len(SIGNS) else (value, turned, -value, -turned)


def _closest(candidates: Sequence[Value], goal: acb) -> Value:
    return min(candidates, key=lambda value: float(abs(_middle(value) - goal).mid()))


def _kernel(kernel: Kernel, argument: Value) -> Value:
    """Return a kernel; to first order by its derivative, as sums of exponentials leave no exact zeros."""
    if isinstance(argument, acb_series) and argument.prec > PAIR:
        if kernel.function in ("cos", "sin"):
            return argument.cos() if kernel.function == "cos" else argument.sin()
        grown, decayed = argument.exp(), (-argument).exp()
        return (grown + decayed) / 2 if kernel.function == "cosh" else (grown - decayed) / 2
    x = at_centre(argument)
    value: acb = getattr(x, kernel.function)()
    if isinstance(argument, acb):
        return value
    slope = {"cosh": x.sinh, "sinh": x.cosh, "sin": x.cos}.get(kernel.function, lambda: -x.sin())
    return acb_series([value, slope() * argument[1]], PAIR)


def _root_name(dispersion: int, i: int) -> str:
    return f"x_{i}[{dispersion}]"


def fundamental_functions(coefficients: Sequence[Value], length: Value) -> tuple[Value, ...]:
    """Return ``h, h', ..., h^(n-1)`` at a length for ``lambda^n + ... + c_0``, numbers or series.

    They are the last column of the exponential of the companion matrix times the length. That of a matrix of
    series stands in the first row of blocks of the exponential of a block Toeplitz matrix (Mathias 1996, A
    chain rule for matrix functions, theorem 4.1).
    """
    n, given = len(coefficients), (*coefficients, length)
    terms = min((x.prec for x in given if isinstance(x, acb_series)), default=1)
    *rows, reach = ([x[k] for k in range(terms)] if isinstance(x, acb_series) else [x] for x in given)
    block = acb_mat(n * terms, n * terms)
    for k in range(terms):
        known = range(max(0, k + 1 - len(reach)), k + 1)
        steep = [
            sum((series_row[i] * reach[k - i] for i in known if i < len(series_row)), ZERO)
            for series_row in rows
        ]
        for start in range(terms - k):
            row, column = n * start, n * (start + k)
            for i in range(n - 1 if k < len(reach) else 0):
                block[row + i, column + i + 1] = reach[k]
            for j, c in enumerate(steep):
                block[row + n - 1, column + j] = -c
    grown = block.exp()
    last = [[grown[i, n * k + n - 1] for k in range(terms)] for i in range(n)]
    return tuple(x[0] if terms == 1 else acb_series(x, terms) for x in last)


NOWHERE = acb("nan", "nan")
NARROW = 2.0**-30  # relative radius of balls whose square root needs no special care


def square_root(x: Value) -> Value:
    """Return a square root that is analytic on the ball, tight where the ball is wide.

    Whether the ball crosses the cut of the principal root does not matter then.

    >>> from flint import acb, arb
    >>> bool((square_root(acb(arb(-4, 1))) ** 2).contains(acb(-4)))
    True
    """
    base = at_centre(x)
    middle = base.mid()
    if middle == 0:
        return x.sqrt()
    reach = (base / middle - 1).abs_upper()
    if reach < NARROW:
        root = (base / middle).sqrt() * middle.sqrt()
    elif reach < 1:
        # sqrt(m) sqrt(1 + e) with abs(e) <= d differs from sqrt(m) by at most (1 - sqrt(1 - d)) sqrt(m).
        off = (1 - (1 - reach).sqrt()).upper()
        root = middle.sqrt() * acb(arb(1, off), arb(0, off))
    else:
        root = NOWHERE  # of a ball that contains 0 no branch is analytic
    if isinstance(x, acb):
        return root
    coefficients = [root]
    for n in range(1, x.prec):
        crossed = sum((coefficients[k] * coefficients[n - k] for k in range(1, n)), acb(0))
        coefficients.append((x[n] - crossed) / (2 * root))
    return acb_series(coefficients, x.prec)


FINER = 2**30  # parts of the least distance of two roots to which they are isolated at the second try
ROOM = 2  # box that is tried about a root, over the step to the root of an outermost polynomial
WIDENINGS = 6  # boxes that are tried about one root: 1.5^6 is eleven times the first
GROWTH = 1.5
STEPS = 8  # Newton steps that narrow a box at most; few are taken, as each has to leave a part of it
HALF = 0.5  # steps that leave more than this of a box no longer double its digits
LITTLE = 7 / 8  # boxes that Newton's operator makes no smaller than this share are left


def characteristic_roots(coefficients: Sequence[Value], *, even: bool = False) -> tuple[Value, ...] | None:
    """Return all roots of ``x^n + ... + c_0``, in pairs if ``even``; ``None`` if not separated."""
    roots = _roots(coefficients[:: 2 if even else 1])
    if roots is None:
        return None
    if even:
        roots = [x for root in map(square_root, roots) for x in (root, -root)]
    boxes = [at_centre(x) for x in roots]
    return tuple(roots) if all(x.is_finite() for x in boxes) and _are_apart(boxes) else None


def _roots(coefficients: Sequence[Value]) -> list[Value] | None:
    base = [at_centre(c) for c in coefficients]
    if not all(c.is_finite() for c in base):
        return None
    polynomial = acb_poly([*base, acb(1)])
    slope = polynomial.derivative()
    boxes = _isolated(polynomial, slope)
    if boxes is None:
        return None
    series: list[Value] = []
    if any(isinstance(c, acb_series) and c.prec > PAIR for c in coefficients):
        return [_expanded(coefficients, root) for root in boxes]
    for root in boxes:
        terms = [c[1] * root**i for i, c in enumerate(coefficients) if isinstance(c, acb_series)]
        series.append(acb_series([root, -sum(terms, acb(0)) / slope(root)], 2) if terms else root)
    return series


def _expanded(coefficients: Sequence[Value], root: acb) -> acb_series:
    """Return a simple root as a long series, by Newton's method: each step doubles the exact terms."""
    terms, known = min(c.prec for c in coefficients if isinstance(c, acb_series)), [root]
    while len(known) < terms:
        exact = min(2 * len(known), terms)
        series, value, slope = (acb_series(start, exact) for start in (known, [1], [0]))
        for c in reversed(coefficients):
            value, slope = value * series + c, slope * series + value
        # The first term is a root, though its ball does not say so.
        step = acb_series([ZERO, *(value[k] for k in range(1, exact))], exact) / slope
        known = [series[k] - step[k] for k in range(exact)]
    return acb_series(known, terms)


def _isolated(polynomial: acb_poly, slope: acb_poly) -> list[acb] | None:
    """Return disjoint boxes, each of which holds one root of every polynomial in the ball."""
    middle = acb_poly([c.mid() for c in polynomial.coeffs()])
    derivative = middle.derivative()
    try:
        discs = middle.roots()
        exact = [_refined(middle, derivative, disc) for disc in discs]
        gap = min((abs(a.mid() - b.mid()) for i, a in enumerate(discs) for b in discs[:i]), default=arb(1))
        if not all(root.rad() < gap / FINER for root in exact):
            # Separated, but too roughly for Newton's method.
            exact = [_refined(middle, derivative, disc) for disc in middle.roots(tol=gap.mid() / FINER)]
    except ValueError:
        return None
    boxes = []
    for root in exact:
        box = _boxed(polynomial, slope, root.mid())
        if box is None:
            return None
        boxes.append(box)
    return boxes if _are_apart(boxes) else None


def _are_apart(boxes: Sequence[acb]) -> bool:
    return not any(a.overlaps(b) for i, a in enumerate(boxes) for b in boxes[:i])


def _refined(polynomial: acb_poly, slope: acb_poly, disc: acb) -> acb:
    """Return an isolated root to the working precision, by interval Newton steps."""

    def newton(root: acb) -> acb:
        middle = root.mid()
        return middle - polynomial(middle) / slope(root)

    return narrowed(disc, newton, current_bits().bit_length() + 2, HALF)


def _boxed(polynomial: acb_poly, slope: acb_poly, middle: acb) -> acb | None:
    """Return a box that contains one root of every polynomial in a ball, next to a root of the middle one."""
    value = polynomial(middle)
    reach = ((value / slope(middle)).abs_upper() * ROOM).upper()
    for _ in range(WIDENINGS):
        if not reach.is_finite():
            return None
        box = middle + acb(arb(0, reach), arb(0, reach))
        step = value / slope(box)
        if not step.is_finite():
            return None
        if step == 0:
            return middle
        if stays_inside(step, reach):
            return narrowed(middle - step, lambda root: middle - value / slope(root), STEPS, LITTLE)
        reach = (reach * GROWTH).upper()
    return None
