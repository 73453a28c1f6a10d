"""Whether a machine with two ports is passive, and stable whatever passive things are at both.

Input: a model with numbers and two ports. Output: a :class:`TwoPorts`.

What is delivered at both ports answers with the matrix Y of driving-point and transfer functions. It is
passive where Y is positive real: no pole in the open right half-plane, and ``Y + Y^H >= 0`` on the axis
(Anderson and Vongpanitlerd 1973, chapter 2). It is absolutely stable, stable with every pair of passive
things that are not connected to each other, where ``Re Y11 >= 0``, ``Re Y22 >= 0`` and ::

    2 Re Y11 Re Y22 - Re(Y12 Y21) >= abs(Y12 Y21)

at all frequencies (Llewellyn 1952). ``eta``, the left side over the right one, is the same for impedances,
admittances and hybrid matrices (Rollett 1962); from 1 on it is a margin. Example: two manipulators with
friction b and B, held together by a spring k whose force comes T late both ways, are passive, and absolutely
stable, exactly where ``b B >= (k T)^2``.

On the axis the mirror image f(-s) of a polynomial is its conjugate, and that of a delay its inverse. So both
conditions become signs of one function each, which :mod:`symflex.contact.real_part` proves at all
frequencies.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import sqrt

from flint import acb, arb, fmpz_mpoly

from symflex.algebra import LAPLACE, Factored
from symflex.balls import precision
from symflex.contact.passivity import (
    DOUBLE,
    NEGATIVE_RESIDUE,
    UNSTABLE,
    passive_by_parts,
    residue_at,
)
from symflex.contact.port import at_port
from symflex.contact.real_part import ActiveBand, LeastPart, RealPart, least_part, real_part
from symflex.errors import refused
from symflex.loops.loop_function import LoopFunction
from symflex.model import ContactPort, Model, with_numbers
from symflex.model.loss_factors import check_causal
from symflex.model.ports import port_named
from symflex.print.notebook import Printed
from symflex.print.text import INDENT, Passage
from symflex.roots.locate import locate
from symflex.roots.passivity import energy_proof
from symflex.roots.root import figure, hertz, real_json, short_hertz
from symflex.transfer import BoundTransferFunction
from symflex.transfer.of_model import derive_bound

SCHEMA = "symflex.two_ports/1"
BITS = 160
SHOWN_DIGITS = 6  # of impedances
WAVES = "a machine with waves is proved by energy, and by what a controller does that acts where it measures"
NOT_ALONE = "poles on the imaginary axis of a machine that is not reciprocal, or has equal modes there"


@dataclass(frozen=True)
class TwoPorts(Printed):
    """What is proved of a machine at two ports."""

    ports: tuple[ContactPort, ContactPort]
    functions: tuple[str, ...]  # Y11, Y12, Y21, Y22 as output over input
    digits: int
    passive: bool | None
    absolutely_stable: bool | None
    is_reciprocal: bool | None  # None where waves hide it
    proof: str = ""  # what proves it, where that is not the real part at all frequencies
    active: tuple[ActiveBand, ...] = ()  # where the Hermitian part is not positive semidefinite
    unsafe: tuple[ActiveBand, ...] = ()  # where eta is below 1, or a real part at a port negative
    least: LeastPart | None = None  # the least eta
    faults: tuple[str, ...] = ()
    reasons: tuple[str, ...] = ()
    shown: tuple[
        tuple[float, arb, arb], ...
    ] = ()  # Hz, and sizes at the first port, the second free and held

    def __repr__(self) -> str:
        words = {True: "passive", False: "active", None: "not decided"}
        stable = {True: ", absolutely stable", False: ", not absolutely stable", None: ""}
        names = " and ".join(port.name for port in self.ports)
        return f"<TwoPorts {names}: {words[self.passive]}{stable[self.absolutely_stable]}>"

    @property
    def certified(self) -> bool:
        """Whether both questions are decided."""
        return self.passive is not None and self.absolutely_stable is not None

    def passages(self) -> list[Passage]:
        """Return both verdicts, the bands that break them, and the margin."""
        words = {True: "PASSIVE, proved", False: "ACTIVE, proved", None: "NOT DECIDED"}
        safe = {True: "yes, proved", False: "no, proved", None: "not decided"}
        names = " and ".join(port.name for port in self.ports)
        lines = [f"ports {names}   {words[self.passive]}"]
        lines += [f"{INDENT}{self.proof}"] if self.proof else []
        lines.append(f"{INDENT}absolutely stable (Llewellyn): {safe[self.absolutely_stable]}")
        if self.is_reciprocal is not None:
            lines.append(f"{INDENT}{'' if self.is_reciprocal else 'not '}reciprocal")
        lines += [f"{INDENT}{fault}" for fault in self.faults]
        lines += [f"{INDENT}Hermitian part with a negative eigenvalue {_said(b)}" for b in self.active]
        lines += [f"{INDENT}eta below 1 {_said(b)}" for b in self.unsafe]
        if self.least is not None and self.least.value.is_finite():
            omega = self.least.omega
            at = "as the frequency grows" if omega is None else f"at {short_hertz(omega)} Hz"
            lines.append(f"{INDENT}least eta {figure(self.least.value, self.digits)}, {at}")
        lines += [f"{INDENT}not proved: {reason}" for reason in self.reasons]
        if not self.shown:
            return [Passage(lines)]
        one, other = (port.name for port in self.ports)
        rows = [("f [Hz]", f"{other} free", f"{other} held")]
        rows += [
            (f"{f:.6g}", figure(free, SHOWN_DIGITS), figure(held, SHOWN_DIGITS))
            for f, free, held in self.shown
        ]
        return [Passage(lines), Passage([f"{INDENT}size of the impedance shown at {one}"], rows)]

    def to_json_dict(self) -> dict[str, object]:
        """Return the result in the schema ``symflex.two_ports/1``."""
        least = self.least
        omega = None if least is None else least.omega
        return {
            "schema": SCHEMA,
            "ports": [port.name for port in self.ports],
            "functions": list(self.functions),
            "passive": self.passive,
            "absolutely_stable": self.absolutely_stable,
            "reciprocal": self.is_reciprocal,
            "proof": self.proof,
            "active": [band.to_json_dict() for band in self.active],
            "unsafe": [band.to_json_dict() for band in self.unsafe],
            "least_eta": least
            and {
                "eta": real_json(least.value, self.digits),
                "frequency_hz": None if omega is None else float(hertz(omega).mid()),
            },
            "transparency": [
                {
                    "frequency_hz": f,
                    "free": real_json(free, SHOWN_DIGITS),
                    "held": real_json(held, SHOWN_DIGITS),
                }
                for f, free, held in self.shown
            ],
            "faults": list(self.faults),
            "reasons": list(self.reasons),
        }


def find_two_ports(model: Model, names: Sequence[str], digits: int = 12) -> TwoPorts:
    """Return whether a machine is passive, and absolutely stable, at two ports.

    Raises ModelError: SF229 for a parameter without value, SF251 with loss factors.
    """
    check_causal(with_numbers(model), "passivity")
    ports = port_named(model, names[0]), port_named(model, names[1])
    if ports[0].nodes == ports[1].nodes:
        raise refused(f"'{names[0]}' and '{names[1]}' are the same port")
    driven, (answers, sources) = _driven(model, ports)
    pairs = [(o, i) for o in answers for i in sources]
    functions = tuple("/".join(pair) for pair in pairs)
    bounds = derive_bound(driven, pairs)
    conditions = _Conditions.of(bounds)
    is_reciprocal = None if conditions is None else conditions.is_reciprocal
    shown = _shown(model, bounds)
    asked = TwoPorts(ports, functions, digits, None, None, is_reciprocal, shown=shown)
    energy = energy_proof(driven)
    if energy.is_passive:
        margin = None if conditions is None else conditions.least_eta(digits)
        return replace(asked, passive=True, absolutely_stable=True, proof=energy.reason, least=margin)
    if conditions is None:
        proof = passive_by_parts(driven, digits)
        decided = True if proof else None
        return replace(
            asked, passive=decided, absolutely_stable=decided, proof=proof, reasons=() if proof else (WAVES,)
        )
    faults, reasons = _faults(bounds, has_rank_one=conditions.is_reciprocal and conditions.has_rank_one)
    diagonal = [conditions.sign_of(f, digits) for f in conditions.diagonal]
    hermitian = [*diagonal, conditions.sign_of(conditions.determinant, digits)]
    llewellyn = [*diagonal, *(conditions.sign_of(f, digits) for f in conditions.llewellyn)]
    least = conditions.least_eta(digits)
    if not faults and any(part.active for part in llewellyn):
        least = None if least is None or least.value >= 1 else least
    return replace(
        asked,
        passive=_verdict(hermitian, faults, reasons),
        absolutely_stable=_verdict(llewellyn, faults, reasons),
        active=_bands(hermitian),
        unsafe=_bands(llewellyn),
        least=least,
        faults=faults,
        reasons=tuple(
            dict.fromkeys((*reasons, *(r for part in (*hermitian, *llewellyn) for r in part.reasons)))
        ),
    )


def _shown(model: Model, bounds: Sequence[BoundTransferFunction]) -> tuple[tuple[float, arb, arb], ...]:
    """Return sizes of what is delivered at the first port over its answer, in the band of the model.

    With the second port free that is 1/Y11, and held ``Y22/(Y11 Y22 - Y12 Y21)``: between both lies what the
    first port can show of anything at the second (Lawrence 1993).
    """
    if model.analysis.band is None:
        return ()
    low, high = (float(x) for x in model.analysis.band)
    found = []
    with precision(BITS):
        functions = [bound.enclosed(BITS) for bound in bounds]
        for f in (low, sqrt(low * high), high):
            y = [function(acb(0, 2 * arb.pi() * arb(f))) for function in functions]
            determinant = y[0] * y[3] - y[1] * y[2]
            if not (y[0].contains(0) or determinant.contains(0)):
                found.append((f, abs(1 / y[0]), abs(y[3] / determinant)))
    return tuple(found)


def _driven(
    model: Model, ports: tuple[ContactPort, ContactPort]
) -> tuple[Model, tuple[tuple[str, str], tuple[str, str]]]:
    """Return a model that is driven at both ports, with the names of its two answers and inputs."""
    first, (answer, source) = at_port(model, ports[0])
    second, (other, other_source) = at_port(first, ports[1])
    both = replace(
        second, outputs=(*first.outputs, *second.outputs), quotients=(*first.quotients, *second.quotients)
    )
    return both, ((answer, other), (source, other_source))


def _verdict(parts: Sequence[RealPart], faults: Sequence[str], reasons: Sequence[str]) -> bool | None:
    if faults or any(part.active for part in parts):
        return False
    return None if reasons or any(part.reasons for part in parts) else True


def _bands(parts: Sequence[RealPart]) -> tuple[ActiveBand, ...]:
    """Return the bands of all conditions, those that touch as one."""
    found: list[ActiveBand] = []
    for band in sorted((b for part in parts for b in part.active), key=lambda b: float(b.low.mid())):
        last = found[-1] if found else None
        if last is None or (last.high is not None and last.high < band.low):
            found.append(band)
        elif last.high is not None and (band.high is None or band.high > last.high):
            found[-1] = replace(last, high=band.high)
    return tuple(found)


def _faults(
    bounds: Sequence[BoundTransferFunction], *, has_rank_one: bool
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return what is wrong with poles, and what is not proved of them.

    Residues with ``has_rank_one`` are a real symmetric matrix of rank one, which is positive semidefinite
    where its diagonal is.
    """
    faults, reasons = list[str](), list[str]()
    for i, bound in enumerate(bounds):
        if bound.is_zero:
            continue
        located = locate(bound, with_zeros=False)
        verdict = located.verdict
        faults += [f"{UNSTABLE}: {verdict.sentence}"] if verdict.word == "unstable" else []
        reasons += [f"the poles of the machine alone: {verdict.reason}"] if verdict.right is None else []
        for pole in (p for p in located.poles if p.on_imaginary_axis and not p.im < 0):
            if pole.is_zero and _is_regular_at_rest(bound):
                continue
            at = f"{short_hertz(pole.im)} Hz"
            if pole.multiplicity > 1:
                faults.append(f"{DOUBLE}: {at}")
                continue
            residue = residue_at(bound, pole) if i in (0, 3) else None
            if residue is not None and residue < 0:
                faults.append(f"{NEGATIVE_RESIDUE}: {at}")
            elif i in (0, 3) and (residue is None or not residue > 0):
                reasons.append(f"the residue of the pole at {at}")
            reasons += [] if has_rank_one else [NOT_ALONE]
    return tuple(dict.fromkeys(faults)), tuple(dict.fromkeys(reasons))


def _is_regular_at_rest(bound: BoundTransferFunction) -> bool:
    """Tell whether the numerator vanishes at s = 0 as often as the denominator, which delays may hide."""
    if bound.is_rational:
        return False
    origin = LoopFunction.of(bound, bound.num, bound.den).at_origin()
    return origin is not None and origin.orders[0] >= origin.orders[1]


@dataclass(frozen=True, eq=False)
class _Conditions:
    """Numerators over one denominator, and their mirror images, which are their conjugates on the axis.

    An image is multiplied with the highest power of each delay, as all others are.
    """

    bound: BoundTransferFunction  # of the ring and its kernels
    entries: tuple[fmpz_mpoly, ...]  # 11, 12, 21, 22
    den: fmpz_mpoly
    delays: tuple[tuple[int, int], ...]  # generators of delays, and their highest powers

    @classmethod
    def of(cls, bounds: Sequence[BoundTransferFunction]) -> _Conditions | None:
        """Return the functions so; None with waves, or where they are over different rings."""
        first = bounds[0]
        names = first.ratio.ring.names
        known = {k.generator for k in first.kernels.kernels}
        if any(b.ratio.ring.names != names or _delays(b) != _delays(first) for b in bounds):
            return None
        for kernel in first.kernels.kernels:
            law = kernel.dispersion
            is_delay = kernel.function == "exp" and not law.wavenumbers and law.shift is not None
            if not (is_delay and not kernel.wavenumber and _is_s(law.shift)):
                return None
        context = first.ratio.ring.context
        parts = [[context.from_dict(f.to_dict()) for f in _parts(b)] for b in bounds]
        den = parts[0][1]
        for _, other in parts[1:]:
            den = den * (other // den.gcd(other))
        entries = tuple(above * (den // below) for above, below in parts)
        every = (*entries, den)
        delays = tuple(
            (i, max(int(f.degrees()[i]) for f in every)) for i, name in enumerate(names) if name in known
        )
        return cls(first, entries, den, delays)

    @property
    def is_reciprocal(self) -> bool:
        """Whether both transfer functions are the same."""
        return bool(self.entries[1] == self.entries[2])

    @property
    def has_rank_one(self) -> bool:
        """Whether residues at simple poles have: the denominator divides the determinant of numerators."""
        n = self.entries
        _, remainder = divmod(n[0] * n[3] - n[1] * n[2], self.den)
        return bool(remainder.is_zero())

    def image(self, polynomial: fmpz_mpoly) -> fmpz_mpoly:
        """Return the conjugate on the axis, times the highest power of each delay."""
        terms = {}
        for monomial, coefficient in zip(polynomial.monoms(), polynomial.coeffs(), strict=True):
            powers = [int(e) for e in monomial]
            sign = -1 if powers[0] % 2 else 1
            for i, most in self.delays:
                powers[i] = most - powers[i]
            terms[tuple(powers)] = sign * coefficient
        return polynomial.context().from_dict(terms)

    @cached_property
    def diagonal(self) -> tuple[tuple[fmpz_mpoly, int], ...]:
        """``2 Re(Y11)`` and ``2 Re(Y22)``, times ``abs(D)^2``."""
        below = self.image(self.den)
        return tuple((self.entries[i] * below + self.image(self.entries[i]) * self.den, 1) for i in (0, 3))

    @cached_property
    def _products(self) -> tuple[fmpz_mpoly, fmpz_mpoly]:
        """``4 Re(Y11) Re(Y22)`` and ``2 Re(Y12 Y21)``, each times ``abs(D)^2`` twice."""
        own, mirrored = self.entries, [self.image(f) for f in self.entries]
        below = self.image(self.den)
        (one, _), (other, _) = self.diagonal
        return one * other, own[1] * own[2] * below**2 + mirrored[1] * mirrored[2] * self.den**2

    @cached_property
    def determinant(self) -> tuple[fmpz_mpoly, int]:
        """That of ``Y + Y^H`` times ``abs(D)^2``, and how many of the highest powers of delays it has."""
        own, mirrored = self.entries, [self.image(f) for f in self.entries]
        below = self.image(self.den)
        above = (own[1] * below + mirrored[2] * self.den) * (mirrored[1] * self.den + own[2] * below)
        return self._over_den(self._products[0] - above)

    @cached_property
    def llewellyn(self) -> tuple[tuple[fmpz_mpoly, int], ...]:
        """What must not be negative: ``u = 4 Re Y11 Re Y22 - 2 Re(Y12 Y21)``, and ``u^2 - abs(2 Y12 Y21)^2``.

        If the machine is reciprocal, that is the determinant.
        """
        if self.is_reciprocal:
            return (self.determinant,)
        u, times, across = self._sides
        return (u, times), (u**2 - across, 2 * times)

    @cached_property
    def _sides(self) -> tuple[fmpz_mpoly, int, fmpz_mpoly]:
        """``u`` times ``abs(D)^2``, its powers of delays, and ``abs(2 Y12 Y21)^2`` like its square.

        What ``abs(D)^2`` does not divide has it twice, as where two modes of a machine are alike.
        """
        u, times = self._over_den(self._products[0] - self._products[1])
        one, other = self.entries[1], self.entries[2]
        across = 4 * one * other * self.image(one) * self.image(other)
        return u, times, across if times == 1 else across * (self.den * self.image(self.den)) ** 2

    def least_eta(self, digits: int) -> LeastPart | None:
        """Return the least of eta, of a function without delays that is nowhere below 0; None else."""
        u, _, across = self._sides
        if self.delays or across.is_zero():
            return None
        ring = self.bound.ratio.ring
        squared = Factored.polynomial(ring, u**2) / Factored.polynomial(ring, across)
        if self.sign_of((u, 0), digits).active:
            return None
        least = least_part(replace(self.bound, ratio=squared, parts=None), (), 2 * digits)
        if least is None or not least.value.is_finite():
            return None
        with precision(BITS):
            return replace(
                least, value=least.value.union(arb(0)).sqrt() if least.value < 0 else least.value.sqrt()
            )

    def sign_of(self, condition: tuple[fmpz_mpoly, int], digits: int) -> RealPart:
        """Return where a condition, a polynomial with some of the highest powers of delays, is negative."""
        polynomial, times = condition
        if polynomial.is_zero():
            return RealPart((), is_zero=True)
        ring = self.bound.ratio.ring
        ratio = Factored.polynomial(ring, polynomial) / Factored.polynomial(ring, self._power(times))
        return real_part(replace(self.bound, ratio=ratio, parts=None), digits)

    def _power(self, times: int) -> fmpz_mpoly:
        context = self.den.context()
        product = context.constant(1)
        for i, most in self.delays:
            product *= context.gen(i) ** (most * times)
        return product

    def _over_den(self, value: fmpz_mpoly) -> tuple[fmpz_mpoly, int]:
        """Return a value with two of the highest powers of delays over ``abs(D)^2``, if it divides it."""
        square = self.den * self.image(self.den)
        quotient, remainder = divmod(value, square)
        return (quotient, 1) if remainder.is_zero() else (value, 2)


def _delays(bound: BoundTransferFunction) -> list[tuple[str, str]]:
    """Return the generators of kernels with what they are, which rings of their own do not share."""
    return [(k.generator, f"{k.function} {k.length}") for k in bound.kernels.kernels]


def _is_s(shift: Factored) -> bool:
    return (shift / Factored.generator(shift.ring, LAPLACE)).is_one


def _parts(bound: BoundTransferFunction) -> tuple[fmpz_mpoly, fmpz_mpoly]:
    """Return numerator and denominator with whole coefficients."""
    context, unit = bound.ratio.ring.context, Fraction(bound.ratio.unit)
    above, below = context.constant(unit.numerator), context.constant(unit.denominator)
    for factor, exponent in bound.ratio.factors:
        if exponent > 0:
            above *= factor**exponent
        else:
            below *= factor ** (-exponent)
    return above, below


def _said(band: ActiveBand) -> str:
    low = short_hertz(band.low)
    return f"from {low} Hz on" if band.high is None else f"from {low} to {short_hertz(band.high)} Hz"
