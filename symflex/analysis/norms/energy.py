"""The H2 norm of a matrix of transfer functions: the RMS of its outputs when white noise drives its inputs.

Input: bound transfer functions, by output and input, and what shapes the noise. Output: an :class:`H2Norm`.

Example: ``1/(s + a)`` has ``1/sqrt(2 a)``.

White noise is of two-sided density 1: the square of the input's unit per Hz, over positive and negative
frequencies. The mean square of the outputs is then ``1/pi`` times the integral of the squared Frobenius norm
over positive frequencies (Parseval 1799; Zhou, Doyle and Glover 1996). Rational functions have a formula in
their coefficients (Astrom, Jury and Agniel 1970). Others are integrated as powers with bounds on pieces of
the axis; beyond a frequency they are at most a power of it.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import inf

from flint import acb, arb, arb_poly

from symflex.algebra import Factored, by_powers
from symflex.analysis.norms.axis import MOST_PIECES, NARROWEST, RATIO, MatrixOnAxis, TaylorForm
from symflex.analysis.norms.expanded import BITS, FAR, Expanded, expanded, is_delay
from symflex.balls import Branching, Open, Part, at_centre, branch, halved, precision, settled
from symflex.errors import BudgetError, Diagnostic, Source, UncertifiedError
from symflex.expressions.format import number_text
from symflex.loops.axis import pieces
from symflex.loops.peak import h2_norm
from symflex.model import Model, load_with
from symflex.model.spec.write import write
from symflex.print.notebook import Printed
from symflex.print.text import Passage
from symflex.roots.distributed.far_out import SECTORS, FunctionFarOut
from symflex.roots.problem import polynomial_in_s
from symflex.roots.root import real_json, short_hertz
from symflex.transfer import AnyBoundFunction, BoundTransferFunction
from symflex.transfer.of_model import derive_bound

NOISE, SHAPED = "white_noise", "shaped_noise"  # names in a model of what shapes it
SCHEMA = "symflex.h2/1"
DIGITS = 6  # of an integral
PRINTED = 12  # of a rational function's norm
FURTHER, STEP = 45, 2.0  # frequencies from which on a bound is tried
MODES = 8  # whose poles lie in the disc about 0, at first
SLOW, SLOW_TAIL = -1.5, 1e-3  # power above which so large a share is left beyond the last frequency
TURNING_TAIL = 2e-2  # the same beside delays
LARGEST_SHARE = 2**BITS  # of an integral on a piece that counts as known
ANYWHERE = (1.1, 2.3, 3.7)  # frequencies [rad/s] at which a sum of delays is not 0, most likely
SLOWEST = -0.5  # power of the frequency below which a square has an integral

Rows = Sequence[Sequence[AnyBoundFunction]]


@dataclass(frozen=True)
class H2Norm(Printed):
    """The RMS of the outputs under white noise at the inputs, or why it is infinite."""

    name: str
    unit: str  # of the RMS per density of the noise
    value: arb  # enclosure; infinite where it is
    noise: str = ""  # what shapes the noise
    reasons: tuple[str, ...] = ()  # what is not proved
    because: str = ""  # why it is infinite
    channels: tuple[tuple[arb, ...], ...] = ()  # of each pair, a row per output

    @property
    def certified(self) -> bool:
        """Whether the enclosure is proved."""
        return not self.reasons

    def to_json_dict(self) -> dict[str, object]:
        """Return the norm in the schema ``symflex.h2/1``, ready for :func:`json.dumps`."""
        return {
            "schema": SCHEMA,
            "tf": self.name,
            "unit": self.unit,
            "noise": self.noise or None,
            "h2": real_json(self.value, 12),
            "infinite": self.because or None,
            "certified": self.certified,
            "reasons": list(self.reasons),
            "channels": [[real_json(x, 12) for x in row] for row in self.channels],
        }

    def passages(self) -> list[Passage]:
        """Return the norm, and what noise it is the answer to."""
        status = "certified" if self.certified else "NOT CERTIFIED"
        lines = [f"{self.name}{self.unit and f' [{self.unit}]'}   {status}"]
        lines += [f"  not proved: {reason}" for reason in self.reasons]
        decimals = real_json(self.value, 12)
        if decimals is None:
            lines.append(f"  H2 norm infinite: {self.because}" if self.because else "  H2 norm not known")
        else:
            lines.append("  H2 norm {value}, radius {radius}".format(**decimals))
            shaped = f" through {self.noise}" if self.noise else ""
            lines.append(f"  RMS of the output for white noise of two-sided density 1 per Hz{shaped};")
            lines.append("  for a one-sided density of 1 per Hz it is smaller by sqrt(2)")
        return [Passage(lines)]


class InfiniteError(Exception):
    """The integral has no end; with the reason."""


def find_h2_norm(rows: Rows, noise: BoundTransferFunction | None = None, shown: str = "") -> H2Norm:
    """Return the H2 norm of a matrix; ``noise`` multiplies every input.

    SF802 where no principal parts are known, SF405 where residues are not known.
    """
    name, unit = matrix_name(rows)
    channels: list[list[arb]] = []
    reasons: list[str] = []
    because = ""
    for row in rows:
        channels.append([])
        for bound in row:
            try:
                square, lacking = _square(bound, noise)
            except InfiniteError as error:
                square, lacking = arb("inf"), ()
                because = because or str(error)
            channels[-1].append(square)
            reasons += lacking
    with precision(BITS):
        total = sum((x for row in channels for x in row), arb(0)).sqrt()
        roots = tuple(tuple(x.sqrt() for x in row) for row in channels)
    return H2Norm(name, unit, total, shown, tuple(dict.fromkeys(reasons)), because, roots)


def matrix_name(rows: Rows) -> tuple[str, str]:
    """Return the name of a pair, or of a matrix, and the unit that all pairs have."""
    first = rows[0][0].source
    if len(rows) == len(rows[0]) == 1:
        return rows[0][0].name, first.unit
    units = {bound.source.unit for row in rows for bound in row}
    outputs = ",".join(row[0].source.output.name for row in rows)
    inputs = ",".join(bound.source.input.name for bound in rows[0])
    return f"[{outputs}]/[{inputs}]", units.pop() if len(units) == 1 else ""


def _square(bound: AnyBoundFunction, noise: BoundTransferFunction | None) -> tuple[arb, tuple[str, ...]]:
    """Return the square of the norm of one function, and what is not proved."""
    if bound.is_zero:
        return arb(0), ()
    shaper = None if noise is None else expanded(noise, 0)
    function = expanded(bound, MODES)
    _check_stable(function)
    if shaper is not None:
        _check_stable(shaper)
    if function.radius == inf and (shaper is None or shaper.radius == inf):
        return _rational([f.bound for f in (function, shaper) if f is not None]), function.reasons
    if shaper is None and _stays(function.bound):
        raise InfiniteError(f"{bound.name} does not fall off as the frequency grows")
    matrix = MatrixOnAxis(((function,),))
    total, reasons = integrated(matrix, shaper)
    if not total.rad() < abs(total.mid()):
        reasons += ("no digit of the integral is known",)
    with precision(BITS):
        return total / arb.pi(), reasons


def _stays(bound: AnyBoundFunction) -> bool:
    """Tell whether the square of a function is proved to have no integral far out.

    Either its inverse grows there no faster than the root of s, or it is a sum of delays over a polynomial:
    the coefficient of its highest power of s is a sum of turning numbers, which does not tend to 0 once it
    has been anything else (Bohr 1925).
    """
    if isinstance(bound, BoundTransferFunction):
        inverse = FunctionFarOut.of(replace(bound, ratio=bound.ratio**-1, parts=None), SECTORS)
        size = None if inverse is None else inverse.size(FAR)
        if size is not None and size.power <= Fraction(1, 2):
            return True
    if not isinstance(bound, BoundTransferFunction) or any(
        bound.den.depends_on(name) for name in bound.kernels.generators
    ):
        return False
    ring = bound.ratio.ring
    above, below = (by_powers(ring, side.expand()) for side in (bound.num, bound.den))
    if not all(is_delay(kernel, ring) for kernel in bound.kernels.kernels) or max(above) < max(below):
        return False
    with precision(BITS):
        leading, kernels = Factored.polynomial(ring, above[max(above)]), bound.kernel_values()
        values = (kernels.value(leading, kernels.at(acb(0, omega))) for omega in ANYWHERE)
        return any(not value.contains(0) for value in map(at_centre, values))


def _check_stable(function: Expanded) -> None:
    """Raise InfiniteError if a pole is not in the open left half-plane, SF405 if that is not proved."""
    verdict, name = function.located.verdict, function.bound.name
    on_axis = [part.root for part in function.parts if part.root.on_imaginary_axis and not part.root.im < 0]
    if on_axis:
        where = "s = 0" if on_axis[0].is_zero else f"{short_hertz(on_axis[0].im)} Hz"
        raise InfiniteError(f"{name} has a pole on the imaginary axis, at {where}")
    if verdict.word == "unstable":
        raise InfiniteError(f"{name} is unstable")
    if verdict.word != "stable" or not verdict.certified:
        message = f"{name} is not proved to be stable: {verdict.sentence}"
        raise UncertifiedError(Diagnostic("SF405", message))


def _rational(factors: Sequence[AnyBoundFunction]) -> arb:
    """Return the square of the norm of a product of rational functions."""

    def compute() -> arb:
        above, below = arb_poly([1]), arb_poly([1])
        for bound in factors:
            if not isinstance(bound, BoundTransferFunction):
                raise UncertifiedError(Diagnostic("SF802", f"{bound.name} is not written out"))
            above = above * polynomial_in_s(bound, bound.num.expand()).enclosure()
            below = below * polynomial_in_s(bound, bound.den.expand()).enclosure()
        if above.degree() >= below.degree():
            raise InfiniteError(f"{factors[0].name} does not fall off as the frequency grows")
        return h2_norm(above, below, PRINTED) ** 2

    return settled(compute, BITS)


@dataclass(frozen=True, slots=True)
class _Share:
    ends: Part
    value: arb  # of the integral on the piece
    in_disc: bool


class _Integral:
    """The integral of the squared Frobenius norm of a matrix times a function, in pieces."""

    def __init__(self, matrix: MatrixOnAxis, shaper: Expanded | None) -> None:
        self.matrix = matrix
        self.shaper = None if shaper is None else MatrixOnAxis(((shaper,),))
        self.total, self.off, self.open = arb(0), arb(0), 0
        self.share_open = arb(10) ** -DIGITS  # of the integral that may be open

    def share(self, ends: Part, *, in_disc: bool) -> _Share:
        """Return the part of a piece, and count it."""
        low, high = ends
        with precision(BITS):
            form = self._form(low, high, in_disc=in_disc)
            value = _over(form, arb(high - low) / 2) if form.is_finite else arb("inf")
            # Beside larger ones the sum of all, from which they are taken again, would lose its digits.
            share = _Share(ends, value if value.rad() < LARGEST_SHARE else arb("inf"), in_disc)
        self._count(share, 1)
        return share

    def _form(self, low: float, high: float, *, in_disc: bool) -> TaylorForm:
        form = (self.matrix.in_disc if in_disc else self.matrix.beyond_disc)(low, high)
        if self.shaper is None or not form.is_finite:
            return form
        return form.times(self.shaper.in_disc(low, high), arb(high - low) / 2)

    def _count(self, share: _Share, times: int) -> None:
        if not share.value.is_finite():
            self.open += times
            return
        with precision(3 * BITS):  # what is added is taken away again
            self.total = (self.total + times * share.value.mid()).mid()
            self.off = (self.off + times * share.value.rad()).mid()

    def decide(self, share: _Share) -> Open[_Share]:
        """Return that a piece is to be halved."""
        return Open(share)

    def halves(self, share: _Share) -> list[_Share]:
        """Return both parts of a piece; none of one that is narrow."""
        low, high = share.ends
        if high - low < NARROWEST * high:
            return []
        self._count(share, -1)
        return [self.share(part, in_disc=share.in_disc) for part in halved(share.ends)]

    def is_enough(self) -> bool:
        """Tell whether the integral is known to its digits."""
        return not self.open and bool(self.off < self.total * self.share_open)


def _over(form: TaylorForm, half: arb) -> arb:
    """Return the integral of a form's squared norm within ``half`` of its middle."""
    total = arb(0)
    for i, first in enumerate(form.powers):
        for k in range(i % 2, len(form.powers), 2):
            pairs = zip(first.entries(), form.powers[k].entries(), strict=True)
            inner = sum((x * y.conjugate() for x, y in pairs), acb(0))
            total += inner.real * 2 * half ** (i + k + 1) / (i + k + 1)
    width = 2 * half
    off = 2 * form.off * (total.upper().max(arb(0)) * width).sqrt() + form.off**2 * width
    return total + arb(0, off.upper())


def integrated(
    matrix: MatrixOnAxis, shaper: Expanded | None = None, band: Part | None = None
) -> tuple[arb, tuple[str, ...]]:
    """Return the integral of the squared Frobenius norm over frequencies [rad/s], and what is not proved."""
    low, high = band or (0.0, inf)
    integral = _Integral(matrix, shaper)
    starts, edge, _ = matrix.in_discs(low, high)
    shares = [integral.share(ends, in_disc=True) for ends in starts]
    end, tail, reasons = high, arb(0), matrix.reasons
    if high == inf:
        end, tail = _tail(matrix, shaper, edge, integral.total)
        if tail > integral.total * integral.share_open:
            integral.share_open = arb(_slow_tail(matrix))
        if tail == inf:
            reasons += (f"above {short_hertz(arb(edge))} Hz no bound on the magnitude is known",)
            end, tail = edge, arb(0)
    in_disc = matrix.used == inf
    shares += [integral.share(ends, in_disc=in_disc) for ends in pieces(edge, end, RATIO)]
    done: Branching[_Share, None] = branch(
        shares,
        integral.decide,
        integral.halves,
        order=lambda share: float(share.value.rad()) if share.value.is_finite() else inf,
        most=MOST_PIECES,
        until=lambda found, _: integral.is_enough(),
    )
    open_share = next((share for share in done.undecided if not share.value.is_finite()), None)
    if open_share is not None:
        message = f"the integral near {short_hertz(arb(open_share.ends[0]))} Hz is not decided"
        hint = "ask for single pairs, or give more damping"
        raise BudgetError(Diagnostic("SF505", message, None, hint))
    with precision(BITS):
        total = sum((share.value for share in done.undecided), arb(0))
        return total + arb(0).union(tail), reasons


def _slow_tail(matrix: MatrixOnAxis) -> float:
    """Return how large a share may be left beyond the last frequency: every turn of a delay costs pieces."""
    bounds = (f.bound for f in matrix.every if f.radius < inf and f.bound.is_reduced)
    turns = any(is_delay(k, b.ratio.ring) for b in bounds for k in b.kernels.kernels)
    return TURNING_TAIL if turns else SLOW_TAIL


def _tail(matrix: MatrixOnAxis, shaper: Expanded | None, edge: float, total: arb) -> tuple[float, arb]:
    """Return a frequency from which on the integral is next to nothing, and what it is at most."""
    known: list[tuple[float, arb]] = []
    for i in range(FURTHER):
        omega = edge * STEP**i
        with precision(BITS):
            size = matrix.tail_power(omega)
            if size is None:
                continue
            most, power = size
            if shaper is not None:
                more = MatrixOnAxis(((shaper,),)).tail_power(omega)
                if more is None:
                    continue
                most, power = most * more[0], power + more[1]
            if power >= SLOWEST:
                continue
            rate = -2 * arb(power) - 1
            known.append((omega, (most**2 * arb(omega) ** -rate / rate).upper()))
            share = _slow_tail(matrix) if power > SLOW else arb(10) ** -(DIGITS + 1)
            if known[-1][1] < total * share:
                return known[-1]
    return min(known, key=lambda each: float(each[1])) if known else (edge, arb("inf"))


def noise_filter(model: Model, expression: str) -> BoundTransferFunction | None:
    """Return what shapes noise, an expression in s and the model's parameters; None if it is empty.

    SpecError for what is no such expression.
    """
    if not expression:
        return None
    named = set(re.findall(r"[A-Za-z_]\w*", expression))
    parameters = {
        p.name: f"{'-' * (p.value.rational < 0)}{number_text(abs(p.value.rational))}"
        f"{f'*pi^{p.value.pi_power}' if p.value.pi_power else ''} {p.unit}".rstrip()
        for p in model.parameters
        if p.name in named and p.value is not None
    }
    spec = {
        "symflex": 1,
        "parameters": parameters,
        "inputs": {NOISE: {}},
        "outputs": {SHAPED: f"({expression})*{NOISE}"},
    }
    shaper = load_with(Source("noise", write(spec)), {})
    (bound,) = derive_bound(shaper, [(SHAPED, NOISE)])
    return bound
