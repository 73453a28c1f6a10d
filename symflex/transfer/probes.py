"""Values of a transfer function at test points, with which what is printed of it is compared.

Input: a transfer function, with numbers for none of its parameters, some or all.
Output: points, each a complex s and a value of every parameter, and the function's values there in balls.

    1/(m*s^2 + b*s + k)    m = 41/64, b = 107/64, k = 33/64 and s = -83/64,   m = 121/64, b = 47/64, ...

A wrong root, sign or power changes the value at almost every point. Points lie where principal branches part:
s is negative, on either half of the imaginary axis and in all four quadrants, and every parameter is below 1
in one half of them and above 1 in the other. Parameters keep the sign that is assumed of them; lengths are
positive and roots of constants real. A last pair of points has values near the declared ones. Values are not
put into polynomials, as :func:`symflex.transfer.bind` puts them: nothing cancels at a point of no meaning.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, partial
from math import sqrt, tau
from random import Random
from typing import Final, Literal

from flint import acb, arb, fmpz_mpoly

from symflex.algebra import LAPLACE, Factored, PolynomialMemo, evaluated
from symflex.balls import at_centre, ball, current_bits, plan, precision
from symflex.errors import ModelError
from symflex.model import ExactValue
from symflex.model.along import COORDINATE
from symflex.transfer.bound import BoundTransferFunction
from symflex.transfer.enclose import enclosure, later, principal_values
from symflex.transfer.nested_form import AnyTransferFunction, BoundNested, NestedTransferFunction
from symflex.transfer.transfer_function import TransferFunction

Kind = Literal["drawn", "declared", "solved"]
Directions = tuple[tuple[str, str], ...]
Values = Mapping[str, ExactValue]
Evaluate = Callable[[Factored | None, int], Callable[[acb], acb]]

FIRST: Final = (("-1", "0"), ("0", "1"), ("-5/13", "12/13"), ("12/13", "-5/13"))
SECOND: Final = (("0", "-1"), ("-1", "0"), ("-3/5", "-4/5"), ("4/5", "3/5"))
NEARBY: Final = (("-1", "0"), ("0", "1"))  # directions of s: branches differ on an axis only exactly there
SOLVED: Final = (("-1/4", "0"),)  # the same where laws that vary along x are solved, with fewer waves
FIRST_BITS: Final = 64
SOLVED_BITS: Final = 96  # for test points of laws that vary along x; with half of them it may take two
TINY: Final = 2.0**-40  # share of s by which a law that is solved at s may be varied
LARGE: Final = 1000  # terms or steps from which a function is evaluated at two points only
PARTS: Final = 64  # values are multiples of one over this
TRIES: Final = 12  # draws of parameters before those are taken that lie near the declared ones
STRICT: Final = 8  # draws with another side of 1 for all parameters but one; later ones have any
NEAR: Final = 16  # how many times a declared value is larger than the step to the value taken for it
DECLARED_BAND: Final = (Fraction(1, 10), Fraction(1000))  # of a model that declares none [Hz]


@dataclass(frozen=True, eq=False)
class ProbeSetting:
    """Values of all parameters, the points s taken with them, and the function there."""

    values: Values
    points: tuple[tuple[Fraction, Fraction], ...]
    evaluate: Evaluate  # the function, or another over its ring, at a precision
    bound: BoundTransferFunction | None = None  # of a function whose parts can be evaluated by themselves


class Probes:
    """The test points of one transfer function; its values at them are found once."""

    def __init__(self, tf: AnyTransferFunction, kind: Kind = "drawn") -> None:
        self._tf, self._kind = tf, kind
        self._known: dict[tuple[int, int], acb] = {}

    @cached_property
    def points(self) -> tuple[tuple[ProbeSetting, tuple[Fraction, Fraction]], ...]:
        """All points."""
        tf = self._tf
        draw = _Draw(tf, Random(tf.name), self.is_solved)
        settings: list[ProbeSetting | None]
        match self._kind:
            case "declared":
                settings = [draw.declared((*FIRST, *SECOND))]
            case "solved":
                settings = [draw.nearby(SOLVED) or draw.half(SOLVED, 0)]
            case _:
                if _is_large(tf):
                    settings = [draw.half((FIRST[0], SECOND[0]), 0)]
                else:
                    settings = [draw.half(FIRST, 0), draw.half(SECOND, 1), draw.nearby(NEARBY)]
        return tuple((setting, s) for setting in settings if setting is not None for s in setting.points)

    @cached_property
    def declared(self) -> Probes:
        """The function with the declared values themselves, for what is printed in decimals."""
        return Probes(self._tf, "declared")

    @cached_property
    def solved(self) -> Probes:
        """The function at few points at which laws that vary along x are solved, which takes longer."""
        return Probes(self._tf, "solved")

    @property
    def is_solved(self) -> bool:
        """Whether laws that vary along x are solved: else functions that they determine are any."""
        return self._kind == "solved"

    def numbers(self, chosen: Sequence[int], bits: int) -> dict[str, list[acb]]:
        """Return s, pi and every parameter at some of the points."""
        with precision(bits):
            points = [self.points[i] for i in chosen]
            values = {
                LAPLACE: [acb(ball(re), ball(im)) for _, (re, im) in points],
                "pi": [acb(arb.pi())] * len(points),
            }
            for parameter in self._tf.model.parameters:
                values[parameter.name] = [acb(enclosure(s.values[parameter.name])()) for s, _ in points]
            return values

    def values(self, bits: int, chosen: Sequence[int] | None = None) -> list[acb]:
        """Return balls around the function's values at some of the points, all by default."""
        wanted = range(len(self.points)) if chosen is None else chosen
        missing = [i for i in wanted if (i, bits) not in self._known]
        missing_values = self.values_of(None, bits, missing)
        self._known.update(zip(((i, bits) for i in missing), missing_values, strict=True))
        return [self._known[i, bits] for i in wanted]

    def values_of(self, value: Factored | None, bits: int, chosen: Sequence[int]) -> list[acb]:
        """Return balls around any function over the ring of the transfer function; None is that itself."""
        enclosed: dict[int, Callable[[acb], acb]] = {}
        values = []
        for i in chosen:
            setting, (re, im) = self.points[i]
            with precision(bits):
                function = enclosed.get(id(setting)) or setting.evaluate(value, bits)
                enclosed[id(setting)] = function
                values.append(function(acb(ball(re), ball(im))))
        return values

    def along(self, value: Factored, x: Sequence[acb], bits: int, chosen: Sequence[int]) -> list[acb]:
        """Return balls around a function of s and the coordinate along a member, each point at its own x."""
        values = []
        for i, position in zip(chosen, x, strict=True):
            setting, (re, im) = self.points[i]
            assert setting.bound is not None
            with precision(bits):
                kernels = setting.bound.kernel_values(is_along=False)
                known = kernels.generators_at(acb(ball(re), ball(im)))
                known[COORDINATE] = position
                for name, function in setting.bound.along.items():
                    local_values = {n: [acb(enclosure(v)())] for n, v in setting.values.items()}
                    local_values |= {COORDINATE: [position], "pi": [acb(arb.pi())]}
                    known[name] = principal_values(function, 1, local_values.__getitem__)[0]
                values.append(evaluated(value, known.__getitem__, acb(1)))
        return values


def probes_of(tf: AnyTransferFunction) -> Probes:
    """Return the test points of a function, which keeps them: all that is printed of it is compared there."""
    kept = vars(tf)
    if "probes" not in kept:
        kept["probes"] = Probes(tf)
    probes: Probes = kept["probes"]
    return probes


def _is_large(tf: AnyTransferFunction) -> bool:
    """Tell whether a function is so long that few points have to do."""
    if not tf.is_reduced:
        return tf.size > LARGE
    sides = (tf.closed.num, tf.closed.den) if tf.closed is not None else (f for f, _ in tf.ratio.factors)
    return sum(map(len, sides)) > LARGE


@dataclass(frozen=True, eq=False)
class _Draw:
    """Draws settings of one function; none of them is one that the model does not allow."""

    tf: AnyTransferFunction
    random: Random
    is_solved: bool  # laws that vary along x are solved

    def half(self, directions: Directions, half: int) -> ProbeSetting | None:
        """Return values on one side of 1 for every other parameter, and on the other side for the others."""
        parameters = self.tf.model.parameters
        for turn in range(TRIES):
            values = {}
            for i, parameter in enumerate(parameters):
                size = Fraction(self.random.randrange(PARTS // 3, PARTS - 3), PARTS)
                # A damping ratio may have to stay below 1: one after the other may stay on its side.
                is_turned = turn > 0 and i == (turn - 1) % len(parameters)
                is_below = bool((i + half) % 2) != is_turned if turn < STRICT else self.random.randrange(2)
                size = size if is_below else 1 / size
                given = parameter.value
                if parameter.is_imaginary and given is not None:
                    values[parameter.name] = given
                    continue
                is_negative = bool(half) if given is None else given.rational < 0
                values[parameter.name] = ExactValue(
                    -size if is_negative and parameter.assume == "real" else size
                )
            if (setting := self._setting(values, directions, Fraction(1))) is not None:
                return setting
        return self.nearby(directions)

    def nearby(self, directions: Directions) -> ProbeSetting | None:
        """Return values near the declared ones, these themselves where others are none."""
        return self.declared(directions, is_moved=True) or self.declared(directions)

    def declared(self, directions: Directions, *, is_moved: bool = False) -> ProbeSetting | None:
        """Return the declared values, or some that are moved a little."""
        model = self.tf.model
        given = {p.name: p.value for p in model.parameters if p.value is not None}
        if any(p.name not in given for p in self.tf.parameters):
            return None
        values = {}
        for parameter in model.parameters:
            value = given.get(parameter.name, ExactValue(Fraction(1)))
            step = Fraction(self.random.randrange(-PARTS, PARTS), PARTS * NEAR) if is_moved else 0
            step = 0 if value.is_imaginary else step
            values[parameter.name] = replace(value, rational=value.rational * (1 + step))
        low, high = model.analysis.band or DECLARED_BAND
        return self._setting(values, directions, Fraction(f"{tau * sqrt(low * high):.3g}"))

    def _setting(self, values: Values, directions: Directions, scale: Fraction) -> ProbeSetting | None:
        points = []
        for re, im in directions:
            size = scale * Fraction(self.random.randrange(PARTS // 2, 2 * PARTS), PARTS)
            points.append((size * Fraction(re), size * Fraction(im)))
        try:
            evaluator = self._evaluator(values)
            if evaluator is None:
                return None
            # Where a constant is not real, or a coefficient not analytic along x, this says so.
            with precision(SOLVED_BITS if self.is_solved else FIRST_BITS):
                function = evaluator[0](None, current_bits())
                if self.is_solved:
                    function(acb(*map(ball, points[0])))
        except ModelError:
            return None
        return ProbeSetting(values, tuple(points), *evaluator)

    def _evaluator(self, values: Values) -> tuple[Evaluate, BoundTransferFunction | None] | None:
        tf, exact = self.tf, tuple(values.items())
        if isinstance(tf, NestedTransferFunction):
            nested = BoundNested(tf, exact)
            return lambda _, bits: nested.enclosed(bits), None
        if tf.is_rational:
            return _lumped(tf, values), None
        bound = BoundTransferFunction(tf, exact, tf.ratio, (), tf.kernels)
        if any(d.matrix for d in tf.kernels.dispersions):
            return _tapered(bound, is_solved=self.is_solved), bound
        kernels = bound.enclosed_part(tf.ratio, FIRST_BITS).kernels
        numbers = kernels.generators_at(acb(1))
        lengths = [at_centre(kernels.value(k.length, numbers)) for k in tf.kernels.kernels]
        if not all(x.imag == 0 and x.real > 0 for x in lengths):
            return None

        def of_ring(value: Factored | None, bits: int) -> Callable[[acb], acb]:
            return replace(bound.enclosed_part(tf.ratio if value is None else value, bits), root=None)

        return of_ring, bound


def _tapered(bound: BoundTransferFunction, *, is_solved: bool) -> Evaluate:
    """Return what evaluates functions of entries of fundamental matrices, arbitrary where not solved."""
    known: dict[tuple[int, str], dict[str, acb]] = {}

    def evaluate(value: Factored | None, bits: int) -> Callable[[acb], acb]:
        with precision(bits):
            kernels = bound.kernel_values(is_along=False)

        def at(s: acb) -> acb:
            with precision(bits):
                key = bits, str(s)
                if key not in known:
                    known[key] = _solved(bound, s) if is_solved else _arbitrary(bound, s)
                generators = {**kernels.at(s), **known[key]}
                return at_centre(kernels.value(bound.ratio if value is None else value, generators))

        return at

    return evaluate


def _arbitrary(bound: BoundTransferFunction, s: acb) -> dict[str, acb]:
    random = Random(str(s))
    names = [k.generator for k in bound.kernels.kernels if k.function == "entry"]
    return {name: acb(random.randrange(1, PARTS), random.randrange(1, PARTS)) / PARTS for name in names}


def _solved(bound: BoundTransferFunction, s: acb) -> dict[str, acb]:
    """Return the entries at one s: matrices that serve for many take far longer."""
    from symflex.along.matrices import VaryingMatrices
    from symflex.along.minors import MinorSums  # few beams are tapered

    values = {name: enclosure(value) for name, value in bound.values}
    minors = MinorSums(bound.ratio.ring, bound.kernels)
    entries = {}
    for law in VaryingMatrices(minors, dict(bound.constants), bound.along, values).laws:
        expansion = law.expanded_about(s, (abs(s) * TINY).upper(), 1)
        for kernel in bound.kernels.kernels_of(law.law):
            if kernel.length == law.length:
                i, j = divmod(kernel.order, law.law.order)
                entry = acb("nan") if expansion is None else expansion.series((i,), (j,), acb(0))[0]
                entries[kernel.generator] = entry
    return entries


def _lumped(tf: TransferFunction, values: Values) -> Evaluate:
    """Return what evaluates functions of a lumped system; its own in closed sums, of which none is opened."""
    enclosures = {name: enclosure(value) for name, value in values.items()}
    plans = PolynomialMemo(plan)

    def polynomial(value: fmpz_mpoly, names: Sequence[str], known: Mapping[str, acb]) -> acb:
        steps = plans(value)
        return at_centre(steps.value([known[names[i]] ** e for i, e in steps.powers]))

    def evaluate(value: Factored | None, bits: int) -> Callable[[acb], acb]:
        with precision(bits):
            numbers: dict[str, acb] = {name: acb(enclose()) for name, enclose in enclosures.items()}
            numbers["pi"] = acb(arb.pi())
            numbers.update((c.generator, acb(later(c.expression, enclosures)())) for c in tf.constants)

        def at(s: acb) -> acb:
            known = {**numbers, LAPLACE: s}
            with precision(bits):
                if value is None and tf.closed is not None:
                    for name, definition in tf.definitions:
                        known[name] = evaluated(definition, known.__getitem__, acb(1))
                    num, den = tf.closed.sides(known, partial(polynomial, known=known))
                    return num / den
                return acb(evaluated(tf.ratio if value is None else value, known.__getitem__, acb(1)))

        return at

    return evaluate
