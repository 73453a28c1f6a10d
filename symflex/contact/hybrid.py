"""Is a machine with a sampled controller passive where it is touched: Colgate and Schenkel's condition.

Input: a model with ``[sampled]`` and a port. Output: a :class:`HybridPassivity`.

What supplies no energy may be connected to that mass, beams too, and touched anywhere: then the whole is
passive if the mass is.

A mass m with a damper b, the force ``-H(z) x`` of whose motor is held between samples of its position, is
passive at the mass exactly if, for all frequencies up to half of the sampling frequency,

    b > T/2 Re{(1 - exp(-j omega T)) H(exp(j omega T))}/(1 - cos omega T)

and the machine alone is stable (Colgate and Schenkel 1997). At the bound itself it is passive, too, if it is
stable: while it moves by d between two samples, the damper takes ``b d^2/T`` at least. The right side is a
quotient of polynomials in ``c = cos omega T``; where it is a straight line in c, its ends say all, and for
``H = K + B (z - 1)/(T z)`` that is ``b > K T/2 + |B|``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property

from flint import arb, fmpq, fmpq_poly, fmpz_mpoly

from symflex.algebra import LAPLACE, Factored, Ring, by_powers, degree_in
from symflex.analysis.sampled_loop import SampledPoles, sampled_poles
from symflex.balls import ball, precision
from symflex.contact.one_place import PROOF, at_one_place
from symflex.contact.passivity import UNSTABLE
from symflex.contact.port import at_port
from symflex.errors import Diagnostic, ModelError
from symflex.expressions import (
    Expression,
    Name,
    format_expression,
    negative,
    number,
    power,
    product_of,
    quotient,
    substitute,
    sum_of,
)
from symflex.model import ContactPort, Input, Model, Output, with_numbers
from symflex.model.model import Z
from symflex.model.ports import port_named
from symflex.model.sampled import OpenedLoop, opened
from symflex.print.notebook import Printed
from symflex.print.text import Passage
from symflex.roots import RootProblem, find_polynomial_roots
from symflex.roots.passivity import energy_proof
from symflex.roots.root import figure, hertz, real_json, short_hertz
from symflex.transfer.lowest_terms import cancel
from symflex.transfer.of_model import derive_all

DIGITS = 30  # of places where the right side is largest
BITS = 192  # of what is needed there
SHOWN_DIGITS = 12
INFINITE = "the controller has a pole at z = 1: no damper is large enough"
CONTROLLER, PERIOD, UNIT = "controller", "period", "unit input"
WHAT = "the condition of Colgate and Schenkel does not apply to this machine: "


@dataclass(frozen=True)
class HybridPassivity(Printed):
    """Whether a mass with a damper and a sampled controller is passive at the mass."""

    port: str
    damping: Fraction  # of the machine
    needed: arb | None  # damping from which on it is passive, if stable alone; None where none is enough
    omega: arb | None  # where that much is needed [rad/s]
    condition: str  # in symbols; empty where its ends do not say all
    excess: int | None  # the sign of what the damping is beyond what is needed; None where it is not known
    alone: SampledPoles  # the poles of the machine alone
    proof: str = ""  # why a machine is passive of which this is said of one place

    @property
    def passive(self) -> bool | None:
        """Whether it is; None where that is not proved."""
        if self.excess == -1 or self.alone.verdict.word == "unstable":
            return False
        return None if self.reasons else True

    @property
    def faults(self) -> tuple[str, ...]:
        """What is wrong with the machine alone, with a pole outside of the unit circle."""
        if self.alone.verdict.word != "unstable":
            return ()
        outside = [p for p in (*self.alone.poles, *self.alone.hidden) if p.side > 0]
        return (f"{UNSTABLE}: {self.alone.sentence}", *(f"pole at {p.words}" for p in outside[-1:]))

    @property
    def reasons(self) -> tuple[str, ...]:
        """What is not proved."""
        reasons = []
        if self.alone.verdict.right is None:
            reasons.append(f"the poles of the machine alone: {self.alone.verdict.reason}")
        if self.excess is None:
            reasons.append(f"the damping is what is needed, to {DIGITS} digits: which one is larger is open")
        elif not self.excess and self.alone.verdict.word != "stable":
            reasons.append(
                "the damping is exactly what is needed, and the machine alone is not proved stable"
            )
        return tuple(reasons)

    def passages(self) -> list[Passage]:
        """Return the verdict and the condition."""
        word = {True: "PASSIVE, proved", False: "ACTIVE, proved", None: "NOT DECIDED"}[self.passive]
        lines = [f"port {self.port}, with a sampled controller   {word}"]
        lines += [f"  {self.proof}"] if self.proof else []
        lines += [f"  {fault}" for fault in self.faults]
        if self.passive is None:
            lines += [f"  not proved: {reason}" for reason in self.reasons]
        if self.condition:
            place = "there " if self.proof else ""
            lines.append(f"  if stable alone, passive {place}exactly for {self.condition}, and at that bound")
        if self.needed is None:
            return [Passage([*lines, f"  {INFINITE}"])]
        place = "" if self.omega is None else f", at {short_hertz(self.omega)} Hz"
        lines.append(f"  damping {float(self.damping):.12g}")
        alone = " of a machine that is stable alone" if self.faults else ""
        lines.append(f"  needed{alone}: at least {figure(self.needed, SHOWN_DIGITS, trimmed=True)}{place}")
        return [Passage(lines)]

    def to_json_dict(self) -> dict[str, object]:
        """Return the result in the schema ``symflex.passivity/1``."""
        return {
            "schema": "symflex.passivity/1",
            "port": self.port,
            "sampled": True,
            "passive": self.passive,
            "damping": float(self.damping),
            "needed_damping": None if self.needed is None else real_json(self.needed, SHOWN_DIGITS),
            "frequency_hz": None if self.omega is None else float(hertz(self.omega).mid()),
            "condition": self.condition,
            "proof": self.proof,
            "faults": list(self.faults),
            "reasons": [] if self.passive is False else list(self.reasons),
        }


def find_hybrid(model: Model, port: str | None) -> HybridPassivity:
    """Return whether a machine with a sampled controller is passive at a port.

    ModelError: SF262 where the machine there is no mass with a damper that the controller acts on and sees.
    """
    chosen = port_named(model, port)
    try:
        return _at_mass(model, chosen)
    except ModelError:
        parts = at_one_place(model)
        if parts is None or not energy_proof(parts[2]).is_passive:
            raise
        part, place, _ = parts
        found = _at_mass(part, place)
        if not found.passive:
            raise
        return replace(found, port=chosen.name, proof=PROOF.format(place.name))


def _at_mass(model: Model, chosen: ContactPort) -> HybridPassivity:
    loop = opened(model)
    if len(loop.channels) > 1:
        raise _other("several places take samples")
    driven, pair = at_port(loop.model, chosen)
    exact = _DampingNeeded.of(driven, loop, pair)
    needed, cosine = exact.largest
    with precision(128):
        omega = None if cosine is None else cosine.acos() / ball(exact.rational(exact.period))
    condition = _DampingNeeded.of(driven, loop, pair, None).symbolic
    damping, alone = exact.rational(exact.damping), sampled_poles(model)
    return HybridPassivity(chosen.name, damping, needed, omega, condition, exact.excess, alone)


def _other(reason: str) -> ModelError:
    hint = (
        "it applies to a mass with a damper whose position is sampled, and on which the held force acts; "
        "what is connected to it must supply no energy"
    )
    return ModelError(Diagnostic("SF262", WHAT + reason, None, hint))


@dataclass(frozen=True)
class _DampingNeeded:
    """The damping of a machine, and what of it is needed at every ``c = cos omega T``, the ring's s."""

    damping: Factored
    needed: Factored
    period: Factored
    controller: Factored  # -H(z), the ring's s for z

    @classmethod
    def of(
        cls, driven: Model, loop: OpenedLoop, pair: tuple[str, str], symbols: Sequence[str] | None = ()
    ) -> _DampingNeeded:
        """Return it from the machine and the controller, some parameters symbols, or all: None."""
        (channel,) = loop.channels
        controller = substitute(channel.controller, {Z: Name(LAPLACE)})
        seen = next(o for o in loop.model.outputs if o.name == channel.seen)
        times = {CONTROLLER: controller, PERIOD: loop.period, "delay": loop.delay}
        model = replace(
            driven,
            inputs=(*driven.inputs, Input(UNIT, "signal")),
            outputs=(
                *driven.outputs,
                seen,
                *(Output(n, product_of([e, Name(UNIT)])) for n, e in times.items()),
            ),
        )
        velocity, force = pair
        pairs = [pair, (velocity, channel.held), (channel.seen, force), *((n, UNIT) for n in times)]
        derived = derive_all(model if symbols is None else with_numbers(model, symbols), pairs)
        ratios = [tf.ratio for tf in derived]
        ring = ratios[0].ring
        if not all(r.ring == ring for r in ratios) or any(tf.kernels for tf in derived):
            raise _other("it is not lumped")
        if ratios[0].is_zero or ratios[1].is_zero or ratios[2].is_zero:
            raise _other("the controller does not act there, or does not see what moves there")
        impedance, s = 1 / ratios[0], Factored.generator(ring, LAPLACE)
        acts, sees = ratios[1] / ratios[0], ratios[2] * s / ratios[0]
        top, below = _split(impedance)
        if _degree(ring, below) or _degree(ring, top) != 1:
            raise _other("it is no mass with a damper at the port")
        if any(_degree(ring, f) for x in (acts, sees) for f in _split(x)):
            raise _other("the controller does not act and see at the port alone")
        at_rest = by_powers(ring, top).get(0, ring.constant(0))
        damping = Factored.polynomial(ring, at_rest) * impedance.unit / Factored.polynomial(ring, below)
        late = ratios[5] / ratios[4]
        samples = 0 if ratios[5].is_zero else _whole(late)
        h = -1 * acts * sees * ratios[3] / s**samples
        return cls(damping, _right_side(h, ratios[4]), ratios[4], h)

    def rational(self, value: Factored) -> Fraction:
        """Return a number; SF262 where it contains pi."""
        if not value.is_constant:
            raise _other("its numbers are not rational")
        return Fraction(0) if value.is_zero else Fraction(value.unit)

    @property
    def changes(self) -> list[fmpz_mpoly]:
        """What vanishes at values of symbols where the verdict may change.

        There the damping is what is needed at an end of the cosine, or twice at a place between, or the
        controller has a pole or a zero at z = 1 or z = -1. Where a pole of the loop meets the unit circle
        elsewhere, the damping is less than what is needed.
        """
        ring = self.needed.ring
        name = str(ring.context.gen(0))
        sides = [(x.numerator().expand(), x.denominator().expand()) for x in (self.damping, self.needed)]
        (own, own_below), (other, below) = sides
        found = []
        for f in (own * below - other * own_below, below):
            found += [f.discriminant(name)] if degree_in(f, 0) > 1 else []
            found += [_end(f, end) for end in (1, -1)]
        # What vanishes there for all values says nothing of any of them.
        found += [_end(f, end) for f in _split(self.controller) for end in (1, -1)]
        return [f for f in found if not f.is_zero()]

    @cached_property
    def _everywhere(self) -> list[tuple[fmpq | arb, arb]] | None:
        """What is needed at both ends of the cosine, exactly, and where it is stationary; None if endless."""
        ring = self.needed.ring
        above, below = (_rationals(ring, f) for f in _split(self.needed))
        above = above * fmpq(self.needed.unit.numerator, self.needed.unit.denominator)
        ends = [fmpq(1), fmpq(-1)]
        if below(ends[0]) == 0 and above(ends[0]) != 0:
            # What is left next to z = 1 has the sign of the numerator there, over a positive denominator.
            if above(ends[0]) * below(fmpq(99, 100)) > 0:
                return None
            ends = ends[1:]
        if _inside(below) or below(fmpq(-1)) == 0:
            raise _other("its controller has a pole on the unit circle")
        between = _inside(above.derivative() * below - above * below.derivative())
        with precision(BITS):
            exact: list[tuple[fmpq | arb, arb]] = [(above(c) / below(c), arb(c)) for c in ends]
            return exact + [(_at(above, c) / _at(below, c), c) for c in between]

    @property
    def largest(self) -> tuple[arb | None, arb | None]:
        """The most damping that is needed, and the cosine at which it is."""
        if self._everywhere is None:
            return None, None
        with precision(BITS):
            values = [(arb(value), c) for value, c in self._everywhere]
            return max(values, key=lambda pair: float(pair[0].mid()))

    @property
    def excess(self) -> int | None:
        """The sign of what the damping is beyond what is needed anywhere; None where it is not known."""
        damping = self.rational(self.damping)
        if self._everywhere is None:
            return -1
        with precision(BITS):
            signs = [
                _sign(fmpq(damping.numerator, damping.denominator) - value) for value, _ in self._everywhere
            ]
        if -1 in signs:
            return -1
        return None if None in signs else min(sign for sign in signs if sign is not None)

    @property
    def symbolic(self) -> str:
        """The condition in symbols, where what is needed is a straight line in the cosine."""
        ring = self.needed.ring
        above, below = _split(self.needed)
        if _degree(ring, below) or _degree(ring, above) > 1:
            return ""
        parts = by_powers(ring, above)
        sides = []
        for k in (0, 1):
            part = Factored.polynomial(ring, parts.get(k, ring.constant(0)))
            sides.append(_letters(part * self.needed.unit / Factored.polynomial(ring, below)))
        constant, slope = sides
        most = [*([] if constant is None else [constant]), *([] if slope is None else [_size(slope)])]
        damping = _letters(self.damping)
        left = "0" if damping is None else format_expression(damping)
        return f"{left} > {format_expression(sum_of(most)) if most else 0}"


def changes_of(model: Model, port: ContactPort, name: str) -> list[fmpz_mpoly]:
    """Return what vanishes at values of a parameter where a machine may become passive or active."""
    driven, pair = at_port(opened(model).model, port)
    return _DampingNeeded.of(driven, opened(model), pair, (name,)).changes


def _end(polynomial: fmpz_mpoly, at: int) -> fmpz_mpoly:
    """Return a polynomial at a value of its first generator."""
    context = polynomial.context()
    return polynomial.compose(context.constant(at), *context.gens()[1:], ctx=context)


def _sign(value: fmpq | arb) -> int | None:
    is_known = not isinstance(value, arb) or value == 0 or not value.contains(0)
    return (value > 0) - (value < 0) if is_known else None


def _size(value: Expression) -> Expression:
    text = format_expression(value)
    return Name(f"|{text.removeprefix('-')}|")


def _right_side(h: Factored, period: Factored) -> Factored:
    """Return ``T/2 Re{(1 - 1/z) H}/(1 - c)`` as a function of c, which s stands for."""
    ring = h.ring
    above, below = (by_powers(ring, f) for f in _split(h))
    ahead = {0: ring.constant(1), 1: ring.constant(-1)}  # 1 - 1/z, mirrored
    size = _times(below, _mirrored(below))
    twice = _times(_times(_mirrored(ahead), above), _mirrored(below))
    twice = _plus(twice, _mirrored(twice))
    c = ring.context.gen(0)
    num = Factored.polynomial(ring, _in_cosine(ring, twice)) * h.unit * period
    den = Factored.polynomial(ring, 4 * (1 - c) * _in_cosine(ring, size))
    return cancel(num, den)[0]


Laurent = dict[int, fmpz_mpoly]  # by powers of z


def _mirrored(value: Laurent) -> Laurent:
    return {-k: x for k, x in value.items()}


def _times(one: Laurent, two: Laurent) -> Laurent:
    product: Laurent = {}
    for i, x in one.items():
        for j, y in two.items():
            product[i + j] = product[i + j] + x * y if i + j in product else x * y
    return product


def _plus(one: Laurent, two: Laurent) -> Laurent:
    total = dict(one)
    for k, x in two.items():
        total[k] = total[k] + x if k in total else x
    return total


def _in_cosine(ring: Ring, value: Laurent) -> fmpz_mpoly:
    """Return a sum that is its own mirror image as a polynomial in c, by Chebyshev's (1854)."""
    c, last = ring.context.gen(0), max(value)
    chebyshev = [ring.constant(1), c]
    while len(chebyshev) <= last:
        chebyshev.append(2 * c * chebyshev[-1] - chebyshev[-2])
    total = ring.constant(0)
    for k, x in value.items():
        total += x * chebyshev[k] * (1 if not k else 2) if k >= 0 else ring.constant(0)
    return total


def _split(value: Factored) -> tuple[fmpz_mpoly, fmpz_mpoly]:
    """Return numerator and denominator as polynomials, without the number in front."""
    ring = value.ring
    above, below = ring.constant(1), ring.constant(1)
    for factor, exponent in value.factors:
        if exponent > 0:
            above = above * factor**exponent
        else:
            below = below * factor**-exponent
    return above, below


def _degree(ring: Ring, polynomial: fmpz_mpoly) -> int:
    return degree_in(polynomial, ring.index[LAPLACE])


def _whole(value: Factored) -> int:
    if not value.is_constant or Fraction(value.unit).denominator != 1:
        raise _other("its output is late by a part of a sample")
    return int(value.unit)


def _rationals(ring: Ring, polynomial: fmpz_mpoly) -> fmpq_poly:
    """Return a polynomial in c whose coefficients are numbers."""
    parts = by_powers(ring, polynomial)
    if any(sum(map(int, m)) for part in parts.values() for m in part.monoms()):
        raise _other("its numbers are not rational")
    last = max(parts, default=0)
    return fmpq_poly([int(parts[k].leading_coefficient()) if parts.get(k) else 0 for k in range(last + 1)])


def _inside(polynomial: fmpq_poly) -> list[arb]:
    """Return the real roots of a polynomial between -1 and 1."""
    coefficients = [Fraction(int(c.p), int(c.q)) for c in polynomial.coeffs()]
    if polynomial.degree() < 1:
        return []
    roots = find_polynomial_roots(RootProblem.from_rationals(coefficients), DIGITS)
    return [root.re for root in roots if root.is_real and root.re > -1 and root.re < 1]


def _at(polynomial: fmpq_poly, c: arb) -> arb:
    value = arb(0)
    for coefficient in reversed(polynomial.coeffs()):
        value = value * c + arb(coefficient)
    return value


def _letters(value: Factored) -> Expression | None:
    """Return a value as a sum of terms over what is common; None where it is zero."""
    if value.is_zero:
        return None
    ring, (above, below) = value.ring, _split(value)
    is_one = len(below) == 1
    terms = []
    for monomial, integer in above.terms():
        share = Fraction(int(integer)) * Fraction(value.unit)
        exponents = [int(e) for e in monomial]
        if is_one:
            ((lower, by),) = below.terms()
            share /= int(by)
            exponents = [e - int(d) for e, d in zip(exponents, lower, strict=True)]
        up = [power(Name(ring.names[i]), number(e)) for i, e in enumerate(exponents) if e > 0]
        down = [power(Name(ring.names[i]), number(-e)) for i, e in enumerate(exponents) if e < 0]
        size = abs(share)
        term = quotient(
            product_of([number(size.numerator), *up]), product_of([number(size.denominator), *down])
        )
        terms.append(negative(term) if share < 0 else term)
    total = sum_of(terms)
    return total if is_one else quotient(total, _written(ring, below))


def _written(ring: Ring, polynomial: fmpz_mpoly) -> Expression:
    written = _letters(Factored.polynomial(ring, polynomial))
    return number(0) if written is None else written
