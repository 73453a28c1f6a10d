"""Transfer functions compared with the equations they were derived from, before anything is made of them.

Input: the equations without kernels, ready to be solved at points, and what evaluates a transfer function.
Output: nothing where they agree, why that is not decided, or InternalError (SF991) where they differ.

Two rational or meromorphic functions that agree at one random point are almost surely equal (Schwartz 1980,
Zippel 1979). A point is a complex frequency, and parameters beside the declared values: a root there is real
as it is at these, and no coincidence of them is taken for an identity. Both values are balls, and no rounding
is compared.

Example: ``1/(m s^2 - k)`` for a mass m on a spring k at s = 1 + 1j rad/s, m = 2 kg, k = 8 N/m.

    derived 1/(-8 + 4j), the equation 1/(8 + 4j): they differ, and nothing is shown.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, partial
from random import Random

from flint import acb

from symflex.algebra import LAPLACE
from symflex.balls import ball, current_bits, precision
from symflex.budget import uncollected
from symflex.equations import Equations, assemble
from symflex.equations.assemble import Nested
from symflex.errors import REPORT, Diagnostic, InternalError, ModelError
from symflex.model import ExactValue, Model
from symflex.model.along import is_tapered
from symflex.transfer.direct_solve import DirectSolve, NotFollowedError, Point, SingularPointError
from symflex.transfer.enclose import enclosure

BITS = 192  # precision that is tried first; then one or two more an unknown, as long chains of members need
WANTED = 40  # bits of both values that are proved before they are compared
SPREADS = (Fraction(1, 8), Fraction(1, 128), Fraction(0))  # how far values are off declared ones, in turn
FREQUENCY = (Fraction(-15, 13), Fraction(17, 9))  # real and imaginary part of s [rad/s]
WHOLE = (1237, -1373)  # two of them where all is polynomial: integers, short in the engine
MOST = 1 << 20  # an integer in place of a parameter is smaller


@dataclass(frozen=True, eq=False)
class ModelSolve:
    """A model's equations without kernels, assembled when they are first solved at a point."""

    model: Model
    nested: Nested  # returns the transfer functions of blocks that are models
    plain: Equations | None = None  # of a lumped model, those it was derived from

    @property
    def is_lumped(self) -> bool:
        """True where the equations contain nothing but polynomials in s."""
        return self.plain is not None and self.plain.propagation is None

    @cached_property
    def direct(self) -> DirectSolve:
        """The equations, ready to be solved."""
        if self.plain is not None and self.is_lumped:
            return DirectSolve(self.plain)
        is_sparse = not is_tapered(self.model) and all(b.submodel is None for b in self.model.blocks)
        with uncollected():
            return DirectSolve(assemble(self.model, self.nested, is_sparse=is_sparse, is_cut=True))

    def parameters(self) -> Iterator[Mapping[str, ExactValue]]:
        """Return values beside the declared ones, nearer and nearer; of a lumped model integers before."""
        random = Random(20)
        if self.is_lumped:
            yield {p.name: ExactValue(Fraction(random.randrange(1, MOST))) for p in self.model.parameters}
        shares = {p.name: Fraction(random.randrange(-64, 65), 64) for p in self.model.parameters}
        for spread in SPREADS:
            yield {p.name: _beside(p.value, shares[p.name] * spread) for p in self.model.parameters}


def _beside(value: ExactValue | None, share: Fraction) -> ExactValue:
    if value is None or not value.rational:
        return ExactValue(1 + share)
    return ExactValue(value.rational * (1 + share), value.pi_power)


Values = Callable[[Point, Mapping[str, acb]], Sequence[acb]]  # where generators have the values given


@dataclass(frozen=True, eq=False)
class Agreement:
    """What is said of one pair of output and input."""

    pair: tuple[str, str]
    values: Values  # by every form there is; the equations give each
    determinant: Callable[[Point, Mapping[str, acb]], acb] | None = None  # of a lumped model's equations


def compare(
    solve: ModelSolve, agreements: Sequence[Agreement], values: Mapping[str, ExactValue] | None = None
) -> str:
    """Return why functions cannot be compared with the equations at random points; SF991 if they differ."""
    reason = solve.direct.unsolved
    if not reason and not all(solve.direct.has(each.pair) for each in agreements):
        reason = "the function has been given other names than its equations have"
    tried: list[Mapping[str, ExactValue]] = []
    for beside in () if reason else solve.parameters():
        units = {p.name: p.value for p in solve.model.parameters if p.is_imaginary and p.value}
        parameters = {**beside, **units, **(values or {})}
        if parameters in tried:
            continue
        tried.append(parameters)
        points = list(_points(parameters, is_lumped=solve.is_lumped))
        more = max(BITS, len(solve.direct.equations.unknowns))
        for bits in (BITS, BITS + more, BITS + 2 * more):
            try:
                with precision(bits):
                    reason = _compare_at(solve.direct, agreements, points)
            except NotFollowedError:
                return "a member that tapers needs too many Taylor steps"
            except (SingularPointError, ZeroDivisionError):
                reason = "the equations or the function have no value at the points tried"
            except ModelError as error:
                reason = error.diagnostics[0].message
                break
            if not reason:
                return ""
    return reason


def _points(parameters: Mapping[str, ExactValue], *, is_lumped: bool) -> Iterator[Point]:
    enclosed = {name: enclosure(value) for name, value in parameters.items()}
    integers = {
        name: int(v.rational)
        for name, v in parameters.items()
        if not (v.pi_power or v.is_imaginary) and v.rational.denominator == 1
    }
    for s in WHOLE if is_lumped else ():
        yield Point(partial(acb, s), enclosed, {**integers, LAPLACE: s})
    if not is_lumped:
        yield Point(lambda: acb(ball(FREQUENCY[0]), ball(FREQUENCY[1])), enclosed)


def _compare_at(direct: DirectSolve, agreements: Sequence[Agreement], points: Sequence[Point]) -> str:
    """Return why functions were not compared at some points with the same parameters."""
    solutions = [direct.at(here, [c.pair for c in agreements]) for here in points]
    for agreement in agreements:
        quotients = []
        for here, solution in zip(points, solutions, strict=True):
            right = solution.values[agreement.pair]
            for value in agreement.values(here, solution.generators):
                if not (_is_narrow(value) and _is_narrow(right)):
                    return "values are not narrow enough to be compared"
                if not value.overlaps(right):
                    raise _differs(agreement, here, "does not agree with the model's equations")
            if agreement.determinant is not None:
                left = agreement.determinant(here, solution.generators)
                quotients.append(solution.determinant * solution.divisors[agreement.pair[0]] / left)
        if not all(map(_is_narrow, quotients)):
            return "determinants are not narrow enough to be compared"
        if any(not q.overlaps(quotients[0]) for q in quotients):
            raise _differs(agreement, points[-1], "has lost a mode of the model's equations")
    return ""


def _is_narrow(value: acb) -> bool:
    """Tell whether a ball is narrow, or so small that a zero is what it encloses."""
    if not value.is_finite():
        return False
    is_zero = value.contains(0) and float(abs(value).upper()) < 2.0 ** -(current_bits() // 2)
    return bool(value == 0 or is_zero or value.rel_accuracy_bits() >= WANTED)


def _differs(agreement: Agreement, here: Point, fault: str) -> InternalError:
    name, s = "/".join(agreement.pair), complex(float(here.s().real.mid()), float(here.s().imag.mid()))
    message = f"the transfer function {name} {fault} at s = {s:.4g}; nothing of it is shown"
    return InternalError(Diagnostic("SF991", message, None, REPORT))
