"""Natural frequencies, damping ratios and kinds of roots in symbols, beside the certified roots.

Input: a transfer function with numbers whose formula has letters, and its certified roots.
Output: for each irreducible factor, formulas and conditions, each read back and checked in balls.

    m*s^2 + b*s + k     omega_p = sqrt(k/m), zeta_p = b/(2*sqrt(k*m)); a complex pair if b^2 < 4*k*m
    a*s^4 + b*s^2 + c   a quartet if b^2 < 4*a*c

Theorem: the discriminant of a quadratic or cubic is positive exactly if its roots are real and distinct. A
quartic ``a z^4 + b z^3 + c z^2 + d z + e`` with a positive discriminant has four real roots if
``8 a c < 3 b^2`` and ``64 a^3 e + 16 a b^2 c < 16 a^2 c^2 + 16 a^2 b d + 3 b^4``, else none (Rees 1922, Amer.
Math. Monthly 29, 51). Of real roots, as many are positive as the signs of coefficients change (Descartes).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Final

from flint import acb, arb, fmpz_mpoly

from symflex import expressions as e
from symflex.algebra import LAPLACE, Factored, Ring, irreducible_factors
from symflex.expressions import Call, Expression, Name, format_expression
from symflex.model import Model
from symflex.print.forms.arrange import ProductPrinter, length, with_squares
from symflex.print.forms.naming import Naming
from symflex.print.forms.shapes import SumSigns
from symflex.print.latex import latex_expression
from symflex.print.latex.equation import model_labels
from symflex.print.roots import SHORT_DIGITS
from symflex.print.text import INDENT, WIDTH, broken
from symflex.roots import Root, figure
from symflex.roots.passivity import energy_proof
from symflex.symbolic.routh import (
    Factor,
    Signs,
    SymbolicRelation,
    aligned,
    read,
    relation_of,
    without_content,
    without_minus,
)
from symflex.transfer import TransferFunction
from symflex.transfer.lowest_terms import cancel

Kind = tuple[str, bool | None, Sequence[SymbolicRelation]]
"""What roots are if inequalities hold, whether these do at the model's values, None if undecided."""

PAIR: Final = 2  # degree of a factor with a natural frequency and a damping ratio
IF: Final = " if "
LONGEST: Final = 140  # characters of a formula or a side of a condition that one still reads off
MOST_OFF: Final = 0.2  # part of a value by which an approximation of a mode may be off
SMALL: Final = 0.06  # part of the largest term of a coefficient from which an approximation keeps others
MOST_TERMS: Final = 200  # terms of a factor that is read back; longer ones have no short formulas


@dataclass(frozen=True, slots=True)
class RootFormula:
    """What a name is in symbols: ``omega_p = sqrt(k/m)``, proved of some roots."""

    name: str
    expression: Expression
    value: arb | None  # of the roots, not of the expression; None of what is different for each
    unit: str = ""
    roots: tuple[Root, ...] = ()
    off: arb | None = None  # of an approximation, how much larger than the value it is, as a part of that

    def __str__(self) -> str:
        return f"{self.name} {'=' if self.off is None else '~'} {format_expression(self.expression)}"


@dataclass(frozen=True, slots=True)
class SymbolicFactor:
    """A factor of numerator or denominator with what is said of its roots."""

    kind: str  # ``poles``, ``zeros`` or ``hidden``
    factor: Expression | None  # None of the reason why more is not said
    formulas: tuple[RootFormula, ...] = ()
    kinds: tuple[Kind, ...] = ()
    solutions: tuple[tuple[arb, Root], ...] = ()  # q of a frequency equation, and the root it belongs to
    note: str = ""  # why there is no formula, or what all solutions are
    approximations: tuple[RootFormula, ...] = ()  # of modes that are far apart

    def lines(self) -> Iterator[str]:
        """Yield what is said, a sentence a line; 1/(2 zeta) is for programs."""
        for f in (f for f in self.formulas if not f.name.startswith("Q")):
            value = "" if f.value is None else f" = {figure(f.value, SHORT_DIGITS, trimmed=True)} {f.unit}"
            yield f"{f}{value}".rstrip()
        yield from self.more()

    def more(self) -> Iterator[str]:
        """Yield what is no formula."""
        if self.solutions:
            yield f"q = {', '.join(figure(q, 2 * SHORT_DIGITS) for q, _ in self.solutions)}, ..."
        yield from (f"{text}{', as here' * bool(holds and IF in text)}" for text, holds, _ in self.kinds)
        yield from [self.note] * bool(self.note)
        for f in self.approximations:
            if f.value is not None and f.off is not None:
                exact = f"{figure(f.value, SHORT_DIGITS, trimmed=True)} {f.unit}".rstrip()
                side = "above" if f.off > 0 else "below"
                yield f"{f}, {figure(abs(f.off) * 100, 2, trimmed=True)} % {side} {exact}"

    def to_json_dict(self, digits: int) -> dict[str, object]:
        """Return the factor as JSON data."""
        return {
            "of": self.kind,
            "factor": format_expression(self.factor) if self.factor else "",
            "formulas": {f.name: format_expression(f.expression) for f in self.formulas},
            "values": {f.name: figure(f.value, digits) for f in self.formulas if f.value is not None},
            "q": [figure(q, digits) for q, _ in self.solutions],
            "kinds": [{"statement": text, "holds": holds} for text, holds, _ in self.kinds],
            "note": self.note,
            "approximations": {f.name: format_expression(f.expression) for f in self.approximations},
        }


def symbolic_text(found: Sequence[SymbolicFactor], width: int = WIDTH) -> str:
    """Return what is said of factors as lines for a terminal."""
    lines = []
    for each in found:
        zero = f" {format_expression(each.factor)} = 0" if each.factor else ""
        head = f"symbolic {each.kind}:{zero}".lstrip()
        lines += ["", INDENT + head, *(2 * INDENT + line for line in each.lines())]
    return "\n".join(part for line in lines for part in broken(line, width) or [""])


def symbolic_latex(found: Sequence[SymbolicFactor], model: Model) -> str:
    """Return what is said of factors as displays, reasons as comments."""
    labels, lines = model_labels(model), []
    for each in found:
        rows = [f"{latex_expression(each.factor, labels)} &= 0"] if each.factor else []
        for f in each.formulas:
            rows.append(f"{latex_expression(Name(f.name), {})} &= {latex_expression(f.expression, labels)}")
        for f in each.approximations:
            about = latex_expression(f.expression, labels)
            rows.append(rf"{latex_expression(Name(f.name), {})} &\approx {about}")
        q = [figure(q, 2 * SHORT_DIGITS) for q, _ in each.solutions]
        rows += [f"q &= {', '.join([*q, chr(92) + 'dots'])}"] if q else []
        for text, _, shown in each.kinds:
            words, conditions = text.partition(IF)[0], r" \text{ and } ".join(x.latex(labels) for x in shown)
            rows.append(rf"&\text{{{words}{IF if shown else ''}}} {conditions}".rstrip())
        lines += [f"% symbolic {each.kind}", *([f"% {each.note}"] * bool(each.note)), *aligned(rows)]
    return "\n".join(lines)


@dataclass(frozen=True, eq=False)
class LetterReader:
    """Says in symbols what the factors of one function have for roots, and reads what it says."""

    tf: TransferFunction
    numbers: Mapping[str, Callable[[], arb]]  # the values of names

    printer: ProductPrinter
    signs: Signs

    @cached_property
    def turns(self) -> SumSigns:
        """What writes sums as the model does."""
        return SumSigns.of(self.tf.model)

    def value(self, expression: Expression, **more: acb) -> acb:
        """Return a ball around what the text of an expression says."""
        known = {"pi": acb.pi(), **more}
        return read(expression, lambda n: known[n] if n in known else acb(self.numbers[n]()))

    def said_of(self, kind: str, factor: fmpz_mpoly, roots: Sequence[Root]) -> SymbolicFactor | None:
        """Return what is said of a factor; None if it contains no letters, or none of its roots is listed."""
        c = self.tf.ring.coefficients(factor)
        degree = len(c) - 1
        if not degree or not self.tf.ring.used_in([factor]) - {LAPLACE} or len(factor) == 1:
            return None
        arranger = self.printer.arranger
        printed = arranger.grouped_by_s(without_content(arranger.closed(factor)))
        silent = SymbolicFactor(kind, None, note=f"a factor of degree {degree} in s has no short formula")
        if len(factor) > MOST_TERMS:
            return silent
        of_factor = [r for r in roots if self.value(printed, s=r.enclosure()).contains(0)]
        if (
            not of_factor
            or len(of_factor) > degree
            or (degree <= PAIR and sum(r.multiplicity for r in of_factor) < degree)
        ):
            return None
        formulas, kinds = tuple(self._formulas(c, of_factor)), tuple(self._kinds(kind, c))
        equation = without_minus(printed, self.turns.turning)
        if formulas or kinds:
            return SymbolicFactor(kind, equation, formulas, kinds)
        return replace(silent, approximations=tuple(self._approximations(c, of_factor)))

    def _formulas(self, c: Sequence[fmpz_mpoly], roots: Sequence[Root]) -> Iterator[RootFormula]:
        """Yield the formulas of a factor whose values are those of its roots."""
        degree = len(c) - 1
        ratio = Factored.polynomial(self.tf.ring, c[0]) / Factored.polynomial(self.tf.ring, c[-1])
        first, last = roots[0], roots[-1]
        omega = (first.size() * last.size()).sqrt()
        tried: list[tuple[str, Expression, arb, str]] = []
        if degree == 1 and first.re < 0:
            tried = [("tau", self.printer.quotient(1 / ratio), -1 / first.re, "s")]
        elif degree == 1:
            tried = [("s", self.printer.quotient(-ratio), first.re, "rad/s")]
        elif degree == PAIR and not first.re * last.re < 0:
            tried = [("omega", self.root(ratio), omega, "rad/s")]
            if not c[1].is_zero():
                zeta, (damping, quality) = -(first.re + last.re) / (2 * omega), self._damping(c)
                tried += [("zeta", damping, zeta, ""), ("Q", quality, 1 / (2 * zeta), "")]
        elif degree == PAIR and c[1].is_zero():
            tried = [("sigma", self.root(-ratio), omega, "rad/s")]
        elif degree == 2 * PAIR and c[1].is_zero() and c[3].is_zero():
            ring, halves = self.tf.ring, not any(int(n) % 2 for n in c[2].coeffs())
            middle, below = (c[2] / 2, c[4]) if halves else (c[2], 2 * c[4])
            others = c[0] * below**2 / c[4]
            terms = ((middle, below), (middle**2 - others, below**2))
            sides = (map(partial(Factored.polynomial, ring), each) for each in terms)
            mean, square = (cancel(above, below)[0] for above, below in sides)
            over, mean_text = self.printer.sum(middle), self.printer.quotient(mean)
            square_root = Call("sqrt", e.sum_of([e.power(over, 2), e.negative(self.printer.sum(others))]))
            sizes = [r.size() for r in roots if r.im > 0 and r.on_imaginary_axis]
            for sign in (-1, 1):
                one, other = (x if sign > 0 else e.negative(x) for x in (square_root, self.root(square)))
                two = e.quotient(e.sum_of([over, one]), self.printer.sum(below)), e.sum_of([mean_text, other])
                root = min((Call("sqrt", x) for x in two), key=length)
                tried += [("omega", root, x, "rad/s") for x in sizes]
        for name, printed, value, unit in tried:
            expression = without_minus(printed, self.turns)
            apart = self.value(expression) - value  # not finite where zeta is 0
            if length(expression) <= LONGEST and apart.is_finite() and apart.contains(0):
                mine = roots if degree <= PAIR else [r for r in roots if r.size().overlaps(value)]
                yield RootFormula(name, expression, value, unit, tuple(mine))

    def _approximations(self, c: Sequence[fmpz_mpoly], roots: Sequence[Root]) -> Iterator[RootFormula]:
        """Yield formulas of two modes far apart, each of three coefficients with their large terms."""
        modes = sorted(
            (r for r in roots if r.im > 0 and r.multiplicity == 1), key=lambda r: float(r.size().mid())
        )
        if len(c) - 1 != 2 * PAIR or len(modes) != PAIR:
            return
        for low, mode in zip((0, PAIR), modes, strict=True):
            own = [self._leading(x) for x in c[low : low + PAIR + 1]]
            if any(x.is_zero() for x in own):
                return
            first, last = (Factored.polynomial(self.tf.ring, x) for x in (own[0], own[-1]))
            zeta = -mode.re / mode.size()
            tried = (
                ("omega", self.root(first / last), mode.size(), "rad/s"),
                ("zeta", self._damping(own)[0], zeta, ""),
            )
            for name, printed, value, unit in tried:
                expression = without_minus(printed, self.turns)
                off = (self.value(expression) / value - 1).real
                if length(expression) <= LONGEST and off.is_finite() and abs(off) < MOST_OFF:
                    yield RootFormula(name, expression, value, unit, (mode,), off)

    def _leading(self, coefficient: fmpz_mpoly) -> fmpz_mpoly:
        """Return a coefficient without the terms that are small at the declared values."""
        context, sizes = coefficient.context(), dict[tuple[int, ...], tuple[int, arb]]()
        for m, x in coefficient.terms():
            key, part = tuple(map(int, m)), context.from_dict({m: x})
            sizes[key] = int(x), abs(self.value(self.printer.sum(part)))
        most = max((size for _, size in sizes.values()), key=float, default=arb(0))
        return context.from_dict({key: x for key, (x, size) in sizes.items() if not size < SMALL * most})

    def root(self, square: Factored, front: Factored | None = None) -> Expression:
        """Return a positive square root times what is in front; squares of unknown sign stay below it."""
        ring = square.ring
        square = self.tf.radicals.shortest(square).map_factors(ring, lambda f: with_squares(ring, f))
        if all(self.signs.of_polynomial(f) for f, e in square.factors if abs(e) > 1):
            return self.printer.square_root(square, front)
        above, below = self.printer.sides(square**0 if front is None else front)
        return e.quotient(e.product_of([above, Call("sqrt", self.printer.quotient(square))]), below)

    def _damping(self, c: Sequence[fmpz_mpoly]) -> tuple[Expression, Expression]:
        """Return zeta, ``b/(2 sqrt(a c))``, and 1/(2 zeta); what has a known sign is taken into the root."""
        low, middle, high = (Factored.polynomial(self.tf.ring, each) for each in c)
        number, factors = irreducible_factors(c[1])
        front = Factored.number(self.tf.ring, 1 if number > 0 else -1)
        for factor, times in factors:
            sign = self.signs.of_polynomial(factor)
            front = front * (sign**times if sign else Factored.polynomial(self.tf.ring, factor) ** times)
        square = low * high * front**2 / middle**2
        return self.root(1 / (square * 4), front), self.root(square, 1 / front)

    def _kinds(self, kind: str, c: Sequence[fmpz_mpoly]) -> Iterator[Kind]:
        """Yield what the roots may be, each with its conditions."""
        model, degree = self.tf.model, len(c) - 1
        is_even, free = not any(map(len, c[1::2])), [p.name for p in model.parameters if p.assume != "real"]
        tried: Sequence[tuple[str, Sequence[Factor]]] = ()
        if is_even and kind == "poles" and energy_proof(model, (), self.tf.output, free).is_passive:
            tried = (("on the imaginary axis, as nothing supplies energy", ()),)
        elif is_even and degree <= 4 * PAIR:
            tried = _even_kinds(self.tf.ring, c[::2])
        elif degree == PAIR:
            spread = c[1] ** 2 - 4 * c[0] * c[2]
            tried = (("a complex pair", [(spread, -1)]), ("two real roots", [(spread, 1)]))
        for words, terms in tried:
            plain = [(self.tf.radicals.reduced(Factored.polynomial(self.tf.ring, f)), x) for f, x in terms]
            needed = self.signs.reduced([f.numerator().expand() * x for f, x in plain])
            if self.signs.is_never(needed):
                continue
            shown = [relation_of(self.printer.arranger, f, sign, self.turns) for f, sign in needed]
            sides = [(each, *each.sides) for each in shown if each.sides]
            over = [((self.value(a) - self.value(b)).real, each.sign) for each, a, b in sides]
            if len(over) == len(shown):
                said = " and ".join(map(str, shown))
                text = f"{words}{IF}{said}" if said else f"{words}: for all positive values"
                is_met = all(x > 0 if sign == ">" else x != 0 for x, sign in over)
                is_open = any(x.contains(0) and not x.is_zero() for x, _ in over)
                yield text, None if is_open else is_met, shown


def _even_kinds(ring: Ring, c: Sequence[fmpz_mpoly]) -> Sequence[tuple[str, Sequence[Factor]]]:
    """Return the kinds of roots of a polynomial in s^2, each with signs that imply it."""
    pairs, last, s = len(c) - 1, c[0] * c[-1], ring.generator(LAPLACE)
    imaginary, real = ([(x * c[-1], sign ** (pairs - i)) for i, x in enumerate(c[:-1])] for sign in (1, -1))
    if pairs == 1:
        return ("an imaginary pair", imaginary), ("a real pair", real)
    spread = sum((x * s**i for i, x in enumerate(c)), ring.constant(0)).discriminant(0)
    apart, mixed = [(spread, 1)], [(spread, -1)]
    if pairs == PAIR:
        others = {"a quartet": mixed, "an imaginary and a real pair": [(last, -1)]}
    elif pairs == PAIR + 1:
        others = {"a quartet and an imaginary pair": [*mixed, (last, 1)]}
        others |= {"a quartet and a real pair": [*mixed, (last, -1)]}
    else:
        e, d, middle, b, a = c
        fold = 8 * a * middle - 3 * b**2
        constant = (
            64 * a**3 * e - 16 * a**2 * middle**2 + 16 * a * b**2 * middle - 16 * a**2 * b * d - 3 * b**4
        )
        others = {"a quartet and two imaginary pairs": [*mixed, *imaginary]}
        others |= {"a quartet, an imaginary and a real pair": [*mixed, (last, -1)]}
        others |= {"two quartets": [*apart, (fold, 1)], "two quartets, too,": [*apart, (constant, 1)]}
        apart += [(fold, -1), (constant, -1)]
    count = ("two", "three", "four")[pairs - PAIR]
    alike = {f"{count} imaginary pairs": [*apart, *imaginary], f"{count} real pairs": [*apart, *real]}
    return tuple((alike | others).items())


def numbered(found: Sequence[SymbolicFactor], naming: Naming) -> Iterator[SymbolicFactor]:
    """Yield what is said with names that nothing else has: ``omega_p1`` is the lowest of several."""
    every = [
        (f"{f.name}_{each.kind[0]}", f) for each in found for f in (*each.formulas, *each.approximations)
    ]
    every.sort(key=lambda item: float(item[1].roots[0].size().mid()))
    stems, names = [stem for stem, _ in every], dict[int, str]()
    for i, (stem, formula) in enumerate(every):
        count = stems[:i].count(stem) + 1 if stems.count(stem) > 1 else ""
        (names[id(formula)],) = naming.take(f"{stem}{count}")
    for each in found:
        exact, about = (
            tuple(replace(f, name=names[id(f)]) for f in of) for of in (each.formulas, each.approximations)
        )
        yield replace(each, formulas=exact, approximations=about)
