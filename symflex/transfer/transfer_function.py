"""The transfer function: an exact rational function of s with names, units and what was cancelled from it.

What it is called follows from the dimensions of its ends.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence, Set
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import ClassVar, Literal

from flint import acb, arb, fmpz_mpoly

from symflex.algebra import LAPLACE, NO_KERNELS, Factored, KernelTable, Radicals, Ring, degree_in
from symflex.equations import ConstantFunction, radicals_of
from symflex.equations.elimination import Closure
from symflex.expressions import Name, names
from symflex.model import Input, Model, ModelParameter, Output
from symflex.quantities import Dimension, unit_of
from symflex.transfer.against_equations import ModelSolve
from symflex.transfer.expansion import Opening

LARGE = 50_000  # expanded terms from which a transfer function is opened only when that is asked for


@dataclass(frozen=True, slots=True)
class HiddenFactor:
    """A polynomial in s that cancelled: its roots are uncontrollable or unobservable modes."""

    polynomial: fmpz_mpoly
    multiplicity: int


@dataclass(frozen=True)
class ClosedForm:
    """The same function with sub-impedances and definitions kept as single symbols."""

    opening: Opening  # the ring with one generator per closed sum, and the way to the one without
    num: fmpz_mpoly  # num and den: polynomials in that ring, coprime also when they are opened
    den: fmpz_mpoly
    order: tuple[int, int] | None = None  # degrees in s of both when opened, if known without that

    @property
    def closure(self) -> Closure:
        """The ring, and what each sum is."""
        return self.opening.closure

    @cached_property
    def length(self) -> int | None:
        """How many terms both have at most when their sums are opened; None when no quick bound is known."""
        lengths = [self.closure.opened_length(p) for p in (self.num, self.den)]
        known = [n for n in lengths if n is not None]
        return sum(known) if len(known) == len(lengths) else None

    @property
    def is_large(self) -> bool:
        """True when opening it may cost more than what else is done with a transfer function."""
        return len(self.num) + len(self.den) > LARGE or (self.length or 0) > LARGE

    def sides(
        self, known: dict[str, acb], value: Callable[[fmpz_mpoly, Sequence[str]], acb]
    ) -> tuple[acb, acb]:
        """Return the values of numerator and denominator, of which no sum is opened.

        ``known`` are the values of s, parameters, definitions and functions of constants, and takes those of
        the sums; ``value`` returns that of a polynomial in the generators named.
        """
        for name, opened in self.closure.sums:
            known[name] = value(opened, self.closure.base.names)
        names = self.closure.ring.names
        return value(self.num, names), value(self.den, names)

    @cached_property
    def ratio(self) -> Factored:
        """The function with all sums and definitions opened.

        Raises BudgetError: SF501 when it would be too large.
        """
        return self.opening.expansion.radicals.shortest(self.opening(self.num) / self.opening(self.den))

    @cached_property
    def generators(self) -> frozenset[str]:
        """The names that occur in it, also within its sums; those of definitions are not opened."""
        used = self.closure.ring.used_in((self.num, self.den))
        return used | self.closure.base.used_in(p for name, p in self.closure.sums if name in used)


@dataclass(frozen=True)
class TransferFunction:
    """``output = ratio(s) * input``, in lowest terms."""

    is_reduced: ClassVar[Literal[True]] = True  # what they had in common is in ``hidden``
    solves_network: ClassVar[bool] = False  # values are those of the formula
    output: Output  # what is measured
    input: Input  # what drives
    reduced: Factored | None  # in lowest terms; None if that of ``closed``, to be opened
    closed: ClosedForm | None  # the compact form; None when it could not be reduced without opening its sums
    hidden: tuple[HiddenFactor, ...]  # the common factors in s that were cancelled
    quantity: str  # ``receptance``, ``mobility``, ...
    unit: str  # SI unit, empty when unknown
    base: Ring  # the equations' ring: as :attr:`ring`, and one generator per definition
    definitions: tuple[tuple[str, Factored], ...]  # over ``base``, each in terms of earlier ones
    constants: tuple[ConstantFunction, ...]  # what function generators such as ``sqrt(k*m)`` stand for
    model: Model  # where it comes from
    kernels: KernelTable = NO_KERNELS  # what wavenumbers and kernels are; empty if lumped
    parts: tuple[Factored, Factored] | None = None  # of a distributed system, :attr:`num` and :attr:`den`
    # The equations it was compared with, for comparing it again when it has numbers.
    solve: ModelSolve | None = field(default=None, compare=False, repr=False)
    # The same over a ring with kernels, where only what cancelled has any; then ``hidden`` lacks these.
    with_waves: TransferFunction | None = None
    # Parameters without value that are real numbers all the same, known at any precision.
    fixed: tuple[tuple[str, Callable[[], arb]], ...] = ()

    @cached_property
    def ratio(self) -> Factored:
        """Numerator over denominator, expanded in s and the parameters; SF501 when it would be too large."""
        if self.reduced is not None:
            return self.reduced
        if self.closed is None:
            raise ValueError(f"{self.name} has neither form")
        return self.closed.ratio

    def __getstate__(self) -> dict[str, object]:
        """Leave out what is kept of earlier computations."""
        return {f.name: getattr(self, f.name) for f in fields(self)}

    def __repr__(self) -> str:
        kind = "" if self.is_rational else ", distributed"
        return f"<TransferFunction {self.name}: {self.quantity}{kind}>"

    @property
    def ring(self) -> Ring:
        """Where :attr:`ratio` lives."""
        return self.ratio.ring if self._large is None else self._large.opening.expansion.ring

    @cached_property
    def radicals(self) -> Radicals:
        """The relations of the roots among the generators of :attr:`ring`."""
        return radicals_of(self.ring, self.constants, self.model.parameters)

    @property
    def is_zero(self) -> bool:
        """True when the output does not depend on the input."""
        return self._large is None and self.ratio.is_zero

    @cached_property
    def _large(self) -> ClosedForm | None:
        """The closed form where that stands for all, as opening it may cost more than all else."""
        return self.closed if self.reduced is None and self.closed and self.closed.is_large else None

    @property
    def is_large(self) -> bool:
        """True when it is expanded only if asked: see :attr:`closed`."""
        return self._large is not None

    @property
    def length(self) -> int:
        """The number of terms of all factors when expanded; of a large function a bound."""
        if self._large is not None:
            return self._large.length or len(self._large.num) + len(self._large.den)
        return sum(len(f) for f, _ in self.ratio.factors)

    @property
    def num(self) -> Factored:
        """The numerator, entire in s, maybe with negative powers of waves where the kernels vanish."""
        return self.ratio.numerator() if self.parts is None else self.parts[0]

    @property
    def den(self) -> Factored:
        """The denominator, entire in s; see :attr:`num`."""
        return self.ratio.denominator() if self.parts is None else self.parts[1]

    @property
    def is_rational(self) -> bool:
        """True when the function contains no kernels: a quotient of polynomials in s, or in a root of s."""
        return not self.kernels

    @cached_property
    def is_nameless(self) -> bool:
        """True when it contains kernels of wavenumbers that have no formula."""
        return any(
            self.ratio.depends_on(k.generator) for k in self.kernels.kernels if k.function == "fundamental"
        )

    @property
    def has_formula(self) -> bool:
        """True when all its kernels are functions of wavenumbers with a formula."""
        return not self.is_nameless and not any(k.function == "entry" for k in self.kernels.kernels)

    @property
    def is_mixed(self) -> bool:
        """True when some of its wavenumbers have a formula and others have none."""
        named = (*self.kernels.wavenumbers, *(k.generator for k in self.kernels.kernels if k.wavenumber))
        return self.is_nameless and any(self.ratio.depends_on(name) for name in named)

    @property
    def name(self) -> str:
        """``OUT/IN``."""
        return f"{self.output.name}/{self.input.name}"

    @cached_property
    def parameters(self) -> tuple[ModelParameter, ...]:
        """The parameters that occur, in declared order."""
        if self._large is not None:
            return self.parameters_below(self._large.generators)
        return self.parameters_in([f for f, _ in self.all_factors])

    @property
    def all_factors(self) -> tuple[tuple[fmpz_mpoly, int], ...]:
        """The factors of the ratio and of everything its wavenumbers and kernels are made of."""
        return (*self.ratio.factors, *(f for v in self.kernels.values for f in v.factors))

    @property
    def whole(self) -> TransferFunction:
        """The function whose denominator and hidden factors are all that the equations' determinant has."""
        return self.with_waves or self

    @cached_property
    def hidden_parameters(self) -> tuple[ModelParameter, ...]:
        """The parameters that occur in hidden factors, in declared order."""
        uncut = self.whole
        inside = [f for v in uncut.kernels.values for f, _ in v.factors] if self.with_waves else []
        return uncut.parameters_in([*(h.polynomial for h in uncut.hidden), *inside])

    def parameters_in(self, polynomials: Sequence[fmpz_mpoly]) -> tuple[ModelParameter, ...]:
        """Return the parameters that polynomials over the function's ring hold."""
        return parameters_named(self.model, self.constants, self.ring.used_in(polynomials))

    def parameters_below(self, names_above: frozenset[str]) -> tuple[ModelParameter, ...]:
        """Return the parameters among names, in definitions among them, and in definitions of these."""
        used = set(names_above)
        for name, value in reversed(self.definitions):
            if name in used:
                used |= value.ring.used_in(f for f, _ in value.factors)
        return parameters_named(self.model, self.constants, used)

    @property
    def extent(self) -> str:
        """What numerator and denominator are, and how long, in words."""
        if not self.is_rational:
            return f"sums of kernels of {self.length} terms"
        above, below = self.order
        return f"polynomials of degree {above} and {below}"

    @property
    def order(self) -> tuple[int, int]:
        """Degrees in s of numerator and denominator, of large ones with random numbers for all but s."""
        if self._large is not None and self._large.order is not None:
            return self._large.order
        return degree(self.ratio.numerator()), degree(self.ratio.denominator())


def parameters_named(
    model: Model, constants: Iterable[ConstantFunction], used: Set[str]
) -> tuple[ModelParameter, ...]:
    """Return the parameters among some names, and those in the functions of constants that are among them."""
    for constant in constants:
        if constant.generator in used:
            used |= {n.name for n in names(constant.expression) if isinstance(n, Name)}
    if model.root is not None:
        used |= {n.name for e in (model.root.slope, model.root.shift) for n in names(e)}
    return tuple(p for p in model.parameters if p.name in used)


def degree(value: Factored) -> int:
    """Return the degree in s of a product of polynomials."""
    i = value.ring.index[LAPLACE]
    return sum(degree_in(f, i) * e for f, e in value.factors)


_MOTIONS = {"m": "receptance", "m/s": "mobility", "m/s^2": "accelerance"}
_TURNS = {
    "rad": ("angle", "angular compliance"),
    "rad/s": ("angular velocity", "angular mobility"),
    "rad/s^2": ("angular acceleration", "angular accelerance"),
}  # what turns, and its quotient by a torque
_EFFORTS = tuple(unit_of(unit).dimension for unit in ("N", "N*m"))
"""What a free signal may be that loads a field: a force or a torque."""
_FLEXIBILITIES = (("m/N", "receptance"), ("m/(N*s)", "mobility"), ("m/(N*s^2)", "accelerance"))
NAMELESS = "transfer function"
_PER_MOTION = {
    "displacement": ("N", "dynamic stiffness"),
    "velocity": ("N", "mechanical impedance"),
    "acceleration": ("N", "apparent mass"),
    "angle": ("N*m", "dynamic stiffness"),
    "angular_velocity": ("N*m", "mechanical impedance"),
    "angular_acceleration": ("N*m", "apparent inertia"),
}  # an effort per imposed motion; the same motion elsewhere is a transmissibility (ISO 2041)
_RATIOS = {
    ("V", "V"): "voltage gain",
    ("A", "A"): "current gain",
    ("A", "V"): "admittance",
    ("V", "A"): "impedance",
    ("N", "N"): "force ratio",
    ("N*m", "N*m"): "torque ratio",
}


def name_quantity(output: Output, source: Input, known: Dimension | None = None) -> str:
    """Return the field's name for output over input, ``transfer function`` when there is none.

    Receptance, mobility and accelerance are displacement, velocity and acceleration per force or torque
    (Ewins 2000, table 1.1), their inverses are of an effort per imposed motion. ``known`` is the quotient's
    dimension: a field's equations are homogeneous, and tell no more.
    """
    if output.dimension is None or source.dimension is None:
        return next((name for unit, name in _FLEXIBILITIES if known == unit_of(unit).dimension), NAMELESS)
    if source.kind in ("force", "torque") or source.dimension in _EFFORTS:
        if output.unit in _TURNS:
            motion, per_torque = _TURNS[output.unit]
            return per_torque if source.dimension == unit_of("N*m").dimension else f"{motion} per force"
        for unit, name in _MOTIONS.items():
            if output.dimension == unit_of(unit).dimension:
                return name
    if source.kind in _PER_MOTION:
        effort, name = _PER_MOTION[source.kind]
        if output.dimension == source.dimension:
            return "transmissibility"
        if output.dimension == unit_of(effort).dimension:
            return name
    for (above, below), name in _RATIOS.items():
        if output.dimension == unit_of(above).dimension and source.dimension == unit_of(below).dimension:
            return name
    return NAMELESS


def unit_of_quotient(output: Output, source: Input, known: Dimension | None) -> str:
    """Return the SI unit of output over input, empty when unknown; ``known`` is their dimension."""
    if output.dimension is None or source.dimension is None:
        return "" if known is None else str(known)
    if output.dimension == source.dimension:
        return "1"
    above = output.unit or str(output.dimension)
    below = source.unit if "rad" in above and source.unit.startswith("rad") else str(source.dimension)
    is_written = source.kind == "signal" and quotient_of_units(source.unit, "1") == source.unit
    # What turns above is not known: 1/s over rad/s is 1, and not 1/rad.
    if is_written and not above.startswith("1"):
        if "kg" in above:
            return str(output.dimension / source.dimension)
        return quotient_of_units(above, source.unit)
    return quotient_of_units(above, below)


def unit_of_response(output: Output, source: Input) -> str:
    """Return the SI unit of an output in time: that of the input, rad/s, where 1/s could mean more."""
    return source.unit if source.unit and output.dimension == source.dimension else output.unit


def quotient_of_units(above: str, below: str) -> str:
    """Return one unit over another in the words of both, so that m/s over A is not called V/N.

    >>> quotient_of_units("m/s^2", "N"), quotient_of_units("V", "V"), quotient_of_units("A", "V/m")
    ('m/(N*s^2)', '1', 'A*m/V')
    >>> quotient_of_units("m/s^2", "m/s"), quotient_of_units("m", "m/s^2")
    ('1/s', 's^2')
    """
    exponents: dict[str, int] = {}
    sides = [(_parts(above), 1), (_parts(below), -1)]
    # In this order the symbols above the line come first as they are written, then those that get there.
    for side in (0, 1):
        for parts, sign in sides if side == 0 else reversed(sides):
            for symbol, power in parts[side]:
                exponents[symbol] = exponents.get(symbol, 0) + (power if side == 0 else -power) * sign
    up = [_raised(symbol, e) for symbol, e in exponents.items() if e > 0]
    down = [_raised(symbol, -e) for symbol, e in exponents.items() if e < 0]
    numerator = "*".join(up) or "1"
    if not down:
        return numerator
    return f"{numerator}/{down[0]}" if len(down) == 1 else f"{numerator}/({'*'.join(down)})"


def _raised(symbol: str, exponent: int) -> str:
    return symbol if exponent == 1 else f"{symbol}^{exponent}"


def _parts(unit: str) -> tuple[list[tuple[str, int]], list[tuple[str, int]]]:
    """Return the symbols above and below the slash of a preferred unit, with their powers."""
    above, _, below = unit.partition("/")
    sides = []
    for part in (above, below.strip("()")):
        pairs = [(f, *f.partition("^")) for f in part.split("*") if f not in ("", "1")]
        # A root's exponent is a fraction in brackets, and stays as it is written.
        sides.append([(s, int(p or 1)) if (p or "1").isdigit() else (f, 1) for f, s, _, p in pairs])
    return sides[0], sides[1]
