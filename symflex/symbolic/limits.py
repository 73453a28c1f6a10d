"""What a transfer function is for s -> 0 and for s -> infinity, in symbols.

Input: a transfer function in expanded form.
Output: its leading term at both ends, in words and with its value, and the frequency at which both meet.

    1/(m*s^2 + b*s + k)    s -> 0: 1/k, static compliance    s -> infinity: 1/(m*s^2), mass line

At s = 0 kernels are their Taylor series, exactly, in which powers of wavenumbers are powers of s. For large
s > 0 one exponential outweighs all others in numerator and denominator, and a wavenumber is a root of what
leads in its square or fourth power; of terms with that exponential the highest power of s leads. So terms are
exact where they are not zero. If no wavenumber vanishes at s = 0, the term is the value there. Before one is
shown, its text is read again and divided into the function, in balls at points of the positive axis ever
closer to that end: the quotient has to tend to 1.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from math import factorial, inf, prod, tau
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from flint import acb, fmpz, fmpz_mpoly

from symflex import expressions as e
from symflex.algebra import LAPLACE, NO_KERNELS, Factored, Ring
from symflex.algebra.dispersion import Dispersion, Kernel
from symflex.algebra.factored import composed
from symflex.algebra.ring import by_powers, coefficients_of
from symflex.balls import ball, precision
from symflex.errors import Diagnostic, SymflexError, UsageError
from symflex.expressions import Expression, Name, Number, format_expression, number, product_of
from symflex.expressions.derivative import simplified
from symflex.print.forms import print_form
from symflex.print.forms.notation import reachable
from symflex.print.forms.printed import S
from symflex.print.forms.root_of_s import in_roots
from symflex.print.forms.shapes import of_powers, powers_of
from symflex.print.latex.equation import model_labels, ratio_latex
from symflex.print.latex.expression import Writer
from symflex.print.text import WIDTH, broken, hanging, shown
from symflex.quantities import Dimension, unit_of
from symflex.symbolic.routh import aligned, read
from symflex.transfer import AnyTransferFunction
from symflex.transfer.enclose import enclosure
from symflex.transfer.lowest_terms import cancel
from symflex.transfer.probes import probes_of

if TYPE_CHECKING:
    import sympy

Key = tuple[int, ...]
Powers = dict[Expression, Fraction]
Lead = tuple[Factored, Fraction, Mapping[Any, int]]
"""A value, in which wavenumbers stand for themselves, a power of s, and exponentials and oscillations."""

ENDS: Final = ("0", "infinity")
CORNER: Final = "corner frequency"  # of both leading terms
MINUS: Final = Number(Fraction(-1))
ORDERS: Final = (8, 16, 32)  # powers of a wavenumber up to which kernels are expanded, one after the other
STEPS: Final = (16, 32, 48)  # binary orders by which a check's points lie beyond its parameters' scale
FARTHER: Final = 8  # times as many without exponentials, whose values would have too many digits
BITS: Final = 512
CLOSE, WANING, NOTHING = 0.01, 0.75, 1e-30
"""Differences: the last one at most, the part left at the next point, and what need not become smaller."""
MOTIONS: Final = {"receptance": 0, "compliance": 0, "mobility": 1, "accelerance": 2}
"""Powers of s in a quantity beside those of the displacement for a force."""
EFFORTS: Final = {"dynamic stiffness": 0, "mechanical impedance": -1, "apparent mass": -2}
"""The same beside those of the force for a displacement."""
IN_SPRINGS: Final = {0: "spring line", -1: "damper line", -2: "mass line"}
STATIC: Final = {0: "static gain", -1: "integrator", -2: "double integrator", 1: "differentiator"}
RIGHT: Final = "s -> infinity on the positive axis; on s = j*omega only with damping"


class NotSymbolicError(UsageError):
    """A statement in symbols is not had; the argument says why."""

    def __init__(self, reason: str) -> None:
        super().__init__(Diagnostic("SF902", reason))


class Row(NamedTuple):
    """A line of what is read off a formula."""

    name: str
    relation: str  # between name and expression, in a terminal
    left: str  # both in LaTeX
    expression: Expression
    words: str = ""  # what a person calls it
    value: float | None = None  # with the declared numbers, in SI units
    unit: str = ""
    power: Fraction | None = None  # of s, where there is nothing but that beside the value
    where: tuple[tuple[str, Expression], ...] = ()  # names in it that the model does not have

    @property
    def comment(self) -> str:
        """Words and value, as far as there are any."""
        value = "" if self.value is None else f"{self.value:.6g} {self.unit}".removesuffix(" 1").rstrip()
        return ", ".join(filter(None, (self.words, value)))


@dataclass(frozen=True)
class SymbolicForm:
    """What is read off a formula: lines, and what is said below them."""

    tf: AnyTransferFunction
    rows: tuple[Row, ...]
    notes: tuple[str, ...] = ()

    def row(self, name: str) -> Row | None:
        """Return the line of a name; ``both meet at`` is an earlier one of ``corner frequency``."""
        name = CORNER if name == "both meet at" else name
        return next((row for row in self.rows if row.name == name), None)

    def expr(self, name: str) -> sympy.Expr | None:
        """Return what a line has, such as ``"s -> 0"`` or ``"scale"``, as SymPy; None without that line."""
        from symflex.print.sympy import symbols_of, to_sympy  # a terminal does without SymPy

        row = self.row(name)
        if row is None:
            return None
        return to_sympy(with_lines(row.expression, dict(row.where)), symbols_of(self.tf.model))

    def __str__(self) -> str:
        return self.text()

    @property
    def where(self) -> list[Row]:
        """Lines for the names of the model that occur."""
        row_lines = {name: line for row in self.rows for name, line in row.where}
        lines, writer = [*definitions_of(self.tf), *row_lines.items()], Writer(model_labels(self.tf.model))
        used = reachable([row.expression for row in self.rows], lines)
        return [Row(f"where {name}", " =", f"{writer.label(name).latex} &=", line) for name, line in used]

    def text(self, width: int = WIDTH) -> str:
        """Return the lines for a terminal."""
        tf, lines = self.tf, []
        for row in (*self.rows, *self.where):
            comment = f"   {row.comment}" if row.comment else ""
            head, right = f"  {row.name}", row.expression
            if (both := shown(row.name, right))[1] != right:
                head, right = f"  {format_expression(both[0])}", both[1]
            lines += hanging(f"{head}{row.relation} ", right, width, comment)
        lines += [part for note in self.notes for part in broken(f"  {note}", width)]
        unit = f" [{tf.unit}]" if tf.unit else ""
        return "\n".join([f"{tf.name}   {tf.quantity}{unit}", "", *lines, ""])

    def latex(self) -> str:
        """Return the lines as a display."""
        writer = Writer(model_labels(self.tf.model))
        rows = []
        for row in (*self.rows, *self.where):
            left, (power, right) = row.left, shown(row.name, row.expression)
            left = left if right == row.expression else f"{writer.piece(power).markup} &="
            rows.append(f"  {left} {writer.piece(right).markup}")
        return "\n".join([*(f"% {note}" for note in self.notes), *aligned([*rows])])

    def to_json_dict(self) -> dict[str, object]:
        """Return one entry of the JSON document."""
        keys, rows = ("name", "is", "words", "value", "unit"), (*self.rows, *self.where)
        values = [(r.name, format_expression(r.expression), r.words, r.value, r.unit) for r in rows]
        lines = [dict(zip(keys, line, strict=True)) for line in values]
        return {"tf": self.tf.name, "lines": lines, "notes": list(self.notes)}


def limits_of(tf: AnyTransferFunction) -> SymbolicForm:
    """Return the leading terms of a transfer function at both ends, and where they meet."""
    found: dict[str, tuple[Row, Powers]] = {}
    notes = []
    for end in ENDS:
        try:
            found[end] = LimitFinder(tf, end).limit()
        except SymflexError as error:
            notes.append(f"s -> {end}: no symbolic term, {error.diagnostics[0].message}")
    rows = [row for row, _ in found.values()]
    slopes = [row.power for row in rows if row.power is not None]
    if len(slopes) == len(ENDS) and slopes[0] != slopes[1]:
        between = slopes[0] - slopes[1]
        powers = times((found[ENDS[1]][1], 1 / between), (found[ENDS[0]][1], -1 / between))
        corner = written_powers({base: n for base, n in powers.items() if base != MINUS})
        at = value_of(tf, with_lines(corner, dict(rows[0].where)))
        if at or (at is None and not any(isinstance(n, e.Negative) for n in e.nodes(corner))):
            said = f"{at / tau:.6g} Hz" if at else ""
            rows.append(Row(CORNER, ":  ", r"\omega &=", corner, said, at, "rad/s"))
    if ENDS[1] in found and tf.kernels.wavenumbers:
        notes.append(RIGHT)
    return SymbolicForm(tf, tuple(rows), tuple(notes))


@dataclass(frozen=True)
class LimitFinder:
    """Finds the leading term at one end."""

    tf: Any  # a transfer function
    end: str

    @property
    def _ring(self) -> Ring:
        ring: Ring = self.tf.ratio.ring
        return ring

    @cached_property
    def laws(self) -> dict[str, tuple[Factored, int]]:
        """What powers of wavenumbers are, and which powers."""
        laws = self.tf.kernels.dispersions
        if any(law.kind in ("general", "varying") for law in laws) or (self.end != ENDS[0] and self._pairs):
            raise NotSymbolicError("its waves are not roots of one term")
        named = ((n, law.kind, law.characteristic[0]) for law in laws for n in law.wavenumbers)
        by_kind = {"wave": (-1, 2), "bending": (Fraction(1, 4), 4), "pair": (1, 4)}
        return {name: (c * by_kind[kind][0], by_kind[kind][1]) for name, kind, c in named}

    @cached_property
    def _pairs(self) -> list[Dispersion]:
        """The laws of two waves that come to rest together, as in Timoshenko beams."""
        return [law for law in self.tf.kernels.dispersions if law.kind == "pair"]

    @cached_property
    def _waves(self) -> dict[str, Fraction]:
        """To which powers of s wavenumbers are proportional at this end."""
        rates = {name: self._end(x, {})[1] / n for name, (x, n) in self.laws.items()}
        delays = [self._end(k.dispersion.shift, {})[1] for k in self.tf.kernels.kernels if not k.wavenumber]
        sums = [self._end(x.characteristic[2], {})[1] - 2 * rates[x.wavenumbers[0]] for x in self._pairs]
        if min((*rates.values(), *delays), default=1) <= 0 or min(sums, default=0) < 0:
            at_rest = "vanish at s = 0, as under tension or on a foundation"
            where = at_rest if self.end == ENDS[0] else "grow with s"
            raise NotSymbolicError(f"it contains waves whose wavenumbers do not {where}")
        return rates

    def _end(self, value: Factored, waves: Mapping[str, Fraction]) -> tuple[Factored, Fraction]:
        """Return what leads in a value, without its power of s, and this, in which wavenumbers count."""
        ring = self._ring
        total, power = Factored.number(ring, value.unit), Fraction(0)
        for factor, exponent in value.factors:
            leads: dict[Fraction, fmpz_mpoly] = {}
            parts = coefficients_of(ring, factor, [0, *(ring.index[w] for w in waves)])
            for (n, *powers), part in parts.items():
                power_of_s = n + sum(
                    (n * rate for n, rate in zip(powers, waves.values(), strict=True)), Fraction(0)
                )
                lead = prod((ring.generator(w) ** n for w, n in zip(waves, powers, strict=True)), start=part)
                leads[power_of_s] = leads[power_of_s] + lead if power_of_s in leads else lead
            best = (min if self.end == ENDS[0] else max)(leads)
            total, power = total * Factored.polynomial(ring, leads[best]) ** exponent, power + best * exponent
        return total, power

    def limit(self) -> tuple[Row, Powers]:
        """Return the leading term, checked, and what stands before the power of s."""
        tf = self.tf
        if not tf.is_reduced or tf.is_zero:
            raise NotSymbolicError("it is zero" if tf.is_reduced else "its formula is too long, and nested")
        if any(p.is_imaginary for p in tf.model.parameters):
            raise NotSymbolicError("loss factors hold on s = j*omega alone")
        if self.end == ENDS[0] and self.laws and not any(self._end(x, {})[1] for x, _ in self.laws.values()):
            return self._where_waves_stay()
        value, power = Factored.number(self._ring, tf.ratio.unit), Fraction(0)
        others: dict[Any, int] = {}
        factors = tf.ratio.factors
        if self._pairs:
            sides = tf.ratio.numerator(), tf.ratio.denominator()
            factors = tuple(((side / side.unit).expand(), n) for side, n in zip(sides, (1, -1), strict=True))
        for factor, exponent in factors:
            is_static = self.end == ENDS[0]
            lead = (
                (*self._end(self.expanded(factor), self._waves), {}) if is_static else self._far_out(factor)
            )
            value, power = value * lead[0] ** exponent, power + lead[1] * exponent
            others |= {key: others.get(key, 0) + n * exponent for key, n in lead[2].items()}
        growth = {key: n for key, n in others.items() if n and isinstance(key, Kernel)}
        turns = {key: Fraction(n) for key, n in others.items() if n and isinstance(key, Expression)}
        front, root = self._front(value), tf.model.root
        power /= 1 if root is None else root.order
        if root is not None and (growth or turns):
            raise NotSymbolicError("waves of a root of s are left in it")
        waves = {e.Call("exp", self._phase(growth)): Fraction(1)} if growth else {}
        leading = written_powers(front | turns | waves | {S: power})
        if root is not None:
            leading = e.substitute(leading, {LAPLACE: e.sum_of([product_of([root.slope, S]), root.shift])})
        self._check(leading)
        name, mark = f"s -> {self.end}", "0" if self.end == ENDS[0] else r"\infty"
        amount = None if turns else value_of(tf, written_powers(front))
        if amount == 0:
            raise NotSymbolicError(f"{format_expression(leading)} is zero for the declared values")
        unit = str(unit_of(tf.unit).dimension * Dimension(s=power)) if tf.unit and power else tf.unit
        shown_power = None if growth or turns else power
        slope = f"{20 * float(power):+.4g} dB/decade" if shown_power else ""
        words = ", ".join(filter(None, (self._words(power), slope)))
        left_side = rf"{ratio_latex(tf)} &\overset{{s \to {mark}}}{{\sim}}"
        relation = ":".ljust(len(ENDS[1]) - len(self.end) + 2)
        return Row(name, relation, left_side, leading, words, amount, unit, shown_power), front

    def _where_waves_stay(self) -> tuple[Row, Powers]:
        """Return the value at s = 0 of a function whose wavenumbers are not 0 there, as of a cooled fin."""
        form = print_form(self.tf)
        taken = {n.name for _, line in form.where for n in e.names(line)} | {*self._ring.names}
        waves = {name: Name(f"{name}_0") for name, _ in form.where if f"{name}_0" not in taken}
        try:
            at_rest = {LAPLACE: number(0)} | waves
            lines = {f"{name}_0": simplified(line, at_rest) for name, line in form.where if name in waves}
            value = simplified(e.quotient(form.num, form.den), at_rest)
        except ZeroDivisionError:
            raise NotSymbolicError("it has a pole at s = 0 beside waves") from None
        expanded = with_lines(value, lines)
        if len(lines) < len(form.where) or e.is_number(value, 0):
            raise NotSymbolicError("it has a zero at s = 0 beside waves")
        self._check(expanded)
        left_side, power = rf"{ratio_latex(self.tf)} &\overset{{s \to 0}}{{\sim}}", Fraction(0)
        row = Row("s -> 0", ":".ljust(len(ENDS[1]) + 1), left_side, value, self._words(power))
        row = row._replace(value=value_of(self.tf, expanded), unit=self.tf.unit, power=power)
        return row._replace(where=tuple(lines.items())), {value: Fraction(1)}

    def expanded(self, factor: fmpz_mpoly, count: int = 1) -> Factored:
        """Return a function with the same first terms of its power series in s, so many, as a factor."""
        ring, laws, waves = self._ring, self.laws, self._waves
        kernels = [k for k in self.tf.kernels.kernels if int(factor.degrees()[ring.index[k.generator]])]
        slowest = min((waves.get(k.wavenumber, Fraction(1)) for k in kernels), default=inf)
        for most in ORDERS:
            series = {k.generator: self._series(k, most) for k in kernels}
            composed_factor, total = (
                composed(Factored.polynomial(ring, factor), series),
                Factored.number(ring, 0),
            )
            parts = coefficients_of(
                ring, composed_factor.numerator().expand(), [ring.index[name] for name in laws]
            )
            weights = {key: sum(n * waves[name] for n, name in zip(key, laws, strict=True)) for key in parts}
            # Further terms of the series would be added to those that are left out.
            terms = {
                k: Factored.polynomial(ring, c) for k, c in parts.items() if weights[k] <= slowest * most
            }
            for law in self._pairs:
                terms = self._symmetric(law, terms, slowest * most)
            for powers, term in terms.items():
                wave_powers = [term]
                for n, (name, (square, order)) in zip(powers, laws.items(), strict=True):
                    wave_powers += [square ** (n // order), Factored.generator(ring, name) ** (n % order)]
                total = total + prod(wave_powers[1:], start=term)
            power = self._end(total, waves)[1]
            if not total.is_zero and power + count - 1 < slowest * (most + 1):
                return total / composed_factor.denominator()
        raise NotSymbolicError("its power series at s = 0 is too long")

    def _symmetric(
        self, law: Dispersion, terms: Mapping[Key, Factored], most: Fraction | float
    ) -> dict[Key, Factored]:
        """Return a function of a pair of wavenumbers up to a power of s, without all that is even in them.

        In ``u x + v``, u = 0 for a symmetric function; one that changes its sign is ``u (x - y)/2``.
        """
        i, j = map([*self.laws].index, law.wavenumbers)
        one, other = (Factored.generator(self._ring, name) for name in law.wavenumbers)
        both, product, zero = -law.characteristic[2], law.characteristic[0], one * 0
        s = self._ring.generator(LAPLACE)

        def cut(value: Factored, power: Fraction | float) -> Factored:
            parts = by_powers(self._ring, value.numerator().expand())
            kept = sum((c * s**n for n, c in parts.items() if n <= power), self._ring.constant(0))
            return Factored.polynomial(self._ring, kept) / value.denominator()

        slopes, found = [zero, zero + 1], dict[Any, tuple[Factored, Factored]]()
        for key, x in terms.items():
            a, b = key[i] // 2, key[j] // 2
            while len(slopes) <= (apart := abs(a - b)):
                slopes.append(both * slopes[-1] - product * slopes[-2])
            front = x * product ** min(a, b)
            u, v = front * slopes[apart], front * (-product * slopes[apart - 1] if apart else 1)
            parities = tuple(e % 2 if n in (i, j) else e for n, e in enumerate(key))
            p, q = found.get(parities, (zero, zero))
            found[parities] = (p + u, q + v) if a >= b else (p - u, q + v + u * both)
        symmetric, rate = dict[Any, Factored](), self._waves[law.wavenumbers[0]]
        for key, (u, v) in found.items():
            room = most - rate * (key[i] + key[j])
            p, q, r = cut(u, room - 2 * rate), cut(v, room), cut(u * both + v * 2, room)
            if not (p.is_zero or r.is_zero):
                raise NotSymbolicError("its waves are not roots of one term")
            symmetric[key] = q if p.is_zero else p * (one**2 - other**2) / 2
        return symmetric

    def _series(self, kernel: Kernel, most: int) -> Factored:
        """Return the Taylor series of a kernel, up to a power of its argument."""
        ring, wave = self._ring, kernel.wavenumber
        argument = (Factored.generator(ring, wave) if wave else -kernel.dispersion.shift) * kernel.length
        step = 1 if kernel.function == "exp" else 2
        sign = -1 if kernel.function in ("cos", "sin") else 1
        powers = range(int(kernel.function in ("sinh", "sin")), most + 1, step)
        terms = (argument**i * Fraction(sign ** (i // 2), factorial(i)) for i in powers)
        return sum(terms, start=Factored.number(ring, 0))

    def _far_out(self, factor: fmpz_mpoly) -> Lead:
        """Return what leads in a factor far out: cosh and sinh are half an exponential."""
        ring, kernels = self._ring, self.tf.kernels.kernels
        pairs = [(even, odd) for even, odd in self.tf.kernels.pairs if even.function == "cosh"]
        evened = ring.replaced(factor, {odd.generator: ring.generator(even.generator) for even, odd in pairs})
        growing = [*(even for even, _ in pairs), *(k for k in kernels if k.function == "exp")]
        parts = coefficients_of(ring, evened, [ring.index[k.generator] for k in growing])
        # A delay decays where a wave grows.
        columns = zip(growing, zip(*parts, strict=True), strict=True)
        top = [max(n) if k.wavenumber else min(n) for k, n in columns]
        if tuple(top) not in parts:
            raise NotSymbolicError("which of its exponentials is the largest depends on its parameters")
        halves = sum(n for k, n in zip(growing, top, strict=True) if k.wavenumber)
        value, power = self._end(Factored.polynomial(ring, parts[tuple(top)]) / 2**halves, self._waves)
        others: dict[Any, int] = dict(zip(growing, top, strict=True))
        turning = [k for k in kernels if k.function in ("cos", "sin") and value.depends_on(k.generator)]
        if turning:
            oscillation, below = value.numerator().expand(), value.denominator()
            parts = coefficients_of(ring, oscillation, [ring.index[k.generator] for k in turning])
            value = Factored.polynomial(ring, next(iter(parts.values())))
            terms = []
            for powers, part in parts.items():
                if not (ratio := Factored.polynomial(ring, part) / value).is_constant:
                    raise NotSymbolicError("several oscillations lead together")
                calls = [e.Call(k.function, self._phase({k: 1})) for k in turning]
                turns = (e.power(call, n) for call, n in zip(calls, powers, strict=True))
                terms.append(product_of([number(ratio.unit), *turns]))
            value, others = value / below, others | {e.sum_of(terms): 1}
        return value, power, others

    def _front(self, value: Factored) -> Powers:
        """Return a value, wavenumbers without their powers of s, as powers."""
        parts = []
        for name, (square, order) in self.laws.items():
            n = value.exponent_of(self._ring.generator(name))
            value = value / Factored.generator(self._ring, name) ** n
            parts.append((self._powers(self._end(square, {})[0]), Fraction(n, order)))
            if value.depends_on(name):
                raise NotSymbolicError("several terms lead together")
        value, _ = cancel(value.numerator(), value.denominator(), radicals=self.tf.radicals)
        return times((self._powers(value), Fraction(1)), *parts)

    def _phase(self, growth: Mapping[Kernel, int]) -> Expression:
        """Return the sum of arguments of kernels, each so many times, as a function of s."""
        terms, s = [], self._ring.generator(LAPLACE)
        for k, n in growth.items():
            square, order = self.laws[k.wavenumber] if k.wavenumber else (k.dispersion.shift, 1)
            of_s = {S: Fraction(square.exponent_of(s))}
            wave = self._powers(square.filter(lambda f: f != s) * square.unit) | of_s
            length = self._powers(k.length * abs(n))
            size = written_powers(times((length, Fraction(1)), (wave, Fraction(1, order))))
            terms.append(size if n > 0 and k.wavenumber else e.negative(size))
        return e.sum_of(terms)

    def _powers(self, value: Factored) -> Powers:
        """Return a function without kernels, as it prints shortest, as powers; its sign is one of -1."""
        kept = Ring(tuple(n for n in self._ring.names if n not in self.tf.kernels.generators))
        plain = replace(self.tf, reduced=value.over(kept), closed=None, hidden=(), parts=None, solve=None)
        plain = replace(plain, kernels=NO_KERNELS)
        form = print_form(plain)
        front, powers = powers_of(e.quotient(form.num, form.den))
        found = {base: Fraction(n) for base, n in powers.items()}
        found |= {MINUS: Fraction(1)} if front < 0 else {}
        for side, sign in ((front.numerator, 1), (front.denominator, -1)):
            found |= {number(int(p)): Fraction(sign * int(n)) for p, n in fmpz.factor(fmpz(abs(side)))}
        return found

    def _words(self, power: Fraction) -> str:
        """Return what a person calls a power of s in the quantity."""
        quantity, is_static, n = self.tf.quantity.removeprefix("angular "), self.end == ENDS[0], int(power)
        if n != power:
            return ""
        if quantity in MOTIONS or quantity in EFFORTS:
            what = "compliance" if quantity in MOTIONS else "stiffness"
            n = n - MOTIONS[quantity] if quantity in MOTIONS else EFFORTS[quantity] - n
            return f"static {what}" if is_static and not power and not n else IN_SPRINGS.get(n, "")
        return (STATIC if is_static else {0: "feedthrough"}).get(n, "")

    def _check(self, leading: Expression) -> None:
        """Compare the function with the term, read again, ever closer to the end."""
        sign, root = -1 if self.end == ENDS[0] else 1, self.tf.model.root
        argument, term = S if root is None else in_roots(S, root), opened(self.tf, leading)
        for setting, s in dict(probes_of(self.tf).points).items():
            with precision(BITS):
                known = {name: acb(enclosure(v)()) for name, v in setting.values.items()} | {"pi": acb.pi()}
                errors = list[float]()
                for step in STEPS:
                    far = step if self.tf.kernels else FARTHER * step
                    known[LAPLACE] = abs(acb(*map(ball, s))) * acb(2) ** (sign * far)
                    at, printed = (read(x, known.__getitem__) for x in (argument, term))
                    errors.append(float(abs(setting.evaluate(None, BITS)(at) / printed - 1).upper()))
            is_waning = all(b < WANING * a or b < NOTHING for a, b in pairwise(errors))
            if not (is_waning and errors[-1] < CLOSE):
                raise NotSymbolicError(f"{format_expression(leading)} seems to lead; that is not proved")


def definitions_of(tf: AnyTransferFunction) -> list[tuple[str, Expression]]:
    """Return what names of a model stand for, its own and those it prints."""
    return [*((d.name, d.expression) for d in tf.model.definitions), *tf.model.analysis.print]


def opened(tf: AnyTransferFunction, expression: Expression) -> Expression:
    """Return an expression without the names that a model defines."""
    return with_lines(expression, dict(definitions_of(tf)))


def with_lines(expression: Expression, lines: Mapping[str, Expression]) -> Expression:
    """Return an expression without the names of lines, which may use one another."""
    for _ in lines:
        expression = e.substitute(expression, lines)
    return expression


def value_of(tf: AnyTransferFunction, expression: Expression) -> float | None:
    """Return the value with the declared numbers, None where one is missing."""
    expression = opened(tf, expression)
    declared = {p.name: p.value for p in tf.model.parameters}
    with precision(BITS):
        known = {n: acb(enclosure(v)()) for n, v in declared.items() if v is not None} | {"pi": acb.pi()}
        if any(n.name in declared and n.name not in known for n in e.names(expression)):
            return None
        found = read(expression, known.__getitem__).real
        return 0.0 if found.contains(0) else float(found.mid())


def times(*parts: tuple[dict[Any, Fraction], Fraction]) -> dict[Any, Fraction]:
    """Return the product of powers of products."""
    total: dict[Any, Fraction] = {}
    for powers, exponent in parts:
        total |= {base: total.get(base, Fraction(0)) + n * exponent for base, n in powers.items()}
    return {base: n for base, n in total.items() if n}


def written_powers(powers: Powers) -> Expression:
    """Return powers as one fraction, equal roots as one, and the power of s apart."""
    groups: dict[int, dict[Expression, int]] = {}
    for base, n in powers.items():
        integer = int(n) if base != S else 0
        for share in (Fraction(integer), n - integer) if base != S else ():
            if share:
                groups.setdefault(share.denominator, {})[base] = share.numerator
    factors = []
    for root, of_root in sorted(groups.items()):
        # 1/sqrt(x) rather than sqrt(1/x)
        sign = 1 if any(n > 0 for n in of_root.values()) else -1
        front = prod(
            (b.value ** (n * sign) for b, n in of_root.items() if isinstance(b, Number)), start=Fraction(1)
        )
        inside = of_powers(front, {b: n * sign for b, n in of_root.items() if not isinstance(b, Number)})
        factors.append((_power(inside, Fraction(1, root)), sign))
    if of_s := powers.get(S):
        factors.append((_power(S, abs(of_s)), 1 if of_s > 0 else -1))
    return of_powers(*powers_of(product_of([f if n > 0 else e.quotient(number(1), f) for f, n in factors])))


def _power(base: Expression, exponent: Fraction) -> Expression:
    """Return a positive power as one writes it: ``sqrt(s)``, ``s^2``, ``s^(3/2)``."""
    if exponent == Fraction(1, 2):
        return e.Call("sqrt", base)
    return e.power(base, e.quotient(number(exponent.numerator), number(exponent.denominator)))
