"""Frequency equations of undamped beams, rods, shafts and strings, and the certified numbers solving them.

Input: a transfer function in symbols, and its certified roots.
Output: for each factor an equation in q, a wavenumber times a length, and in ratios of parameters; and with
what :mod:`symflex.symbolic.roots` says of factors without waves, all that is said of a function.

    a cantilever with a mass    cosh(q)*cos(q) + 1 + mu*q*(sinh(q)*cos(q) - cosh(q)*sin(q)) = 0
                                mu = m/(rho*A*l), omega = q^2*sqrt(E*I/(rho*A))/l^2

Theorem: s enters only through the wavenumber, ``q^4 = rho A l^4 omega^2/(E I)``, so a factor divided by one
of its coefficients depends on q and on quotients of coefficients, which have no unit (Rayleigh 1877, 172). A
q_n is that of a certified root of the function, and the equation as it is printed changes its sign there.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations_with_replacement
from math import lcm, prod
from typing import Final

from flint import acb, arb, fmpz_mpoly

from symflex.algebra import LAPLACE, Factored, Ring, irreducible_factors, terms_of
from symflex.balls import precision
from symflex.errors import UsageError
from symflex.expressions import Call, Expression, Name, Quotient, names, power, product_of, quotient, sum_of
from symflex.library.elements import LineElement
from symflex.print.forms.arrange import Arranger, ProductPrinter
from symflex.print.forms.frequency import FrequencyPage
from symflex.print.forms.invariants import IMAGINARY
from symflex.print.forms.naming import RATIOS, Naming
from symflex.print.forms.notation import plain_printer, wave_times_length, wavenumber_laws
from symflex.print.roots import roots_of
from symflex.quantities import unit_of
from symflex.roots import PoleZeroMap, Root
from symflex.symbolic.roots import MOST_TERMS, LetterReader, RootFormula, SymbolicFactor, numbered
from symflex.symbolic.routh import BITS, Signs
from symflex.transfer import AnyBoundFunction, AnyTransferFunction
from symflex.transfer.enclose import enclosure, later

Key = tuple[int, ...]  # powers of q and of every kernel
MOST_RATIOS: Final = 3  # ratios of parameters that an equation may contain beside q
BESIDE: Final = arb("1e-6")  # part of q by which the two sides of a root are apart from it
Q: Final = "q"
EXACT: Final = {"cos": "all solutions: q = (2*n - 1)*pi/2", "sin": "all solutions: q = n*pi"}
"""The solutions of an equation that is one function, n = 1, 2, ..."""
NO_EQUATION: Final = (
    "a frequency equation takes undamped Euler beams, rods, shafts or strings without tension and delays, of "
    "one wavenumber, whose lengths are multiples of one, and at most three ratios of parameters"
)


def symbolic_roots(
    tf: AnyTransferFunction, bound: AnyBoundFunction, located: PoleZeroMap
) -> tuple[SymbolicFactor, ...]:
    """Return what can be said in symbols of a function's factors, as far as the map lists their roots."""
    if not tf.is_reduced or tf.is_large or tf.model.imaginary or tf.model.root is not None:
        why = "the formula is large, or has roots of s or complex coefficients"
        return (SymbolicFactor("", None, note=why),)
    given = {p.name: p.value for p in tf.model.parameters if p.value is not None}
    given |= dict(bound.values) if bound.is_reduced else {}
    known = {name: enclosure(x) for name, x in given.items()}
    known |= {d.name: later(d.expression, known) for d in tf.model.definitions}
    reader = LetterReader(tf, known, plain_printer(tf), Signs.of(tf))
    sides = {"poles": [f for f, _ in tf.den.factors], "zeros": [f for f, _ in tf.num.factors]}
    sides["hidden"] = [h.polynomial for h in tf.hidden]
    with precision(BITS):
        found = [
            each
            for kind, factors in sides.items()
            for factor in factors
            if tf.ring.used_in([factor]).isdisjoint(tf.kernels.generators)
            for part, _ in irreducible_factors(factor)[1]
            if (each := reader.said_of(kind, part, roots_of(located, kind))) is not None
        ]
        said = [*numbered(found, Naming.of(tf))]
        said += [] if tf.is_rational else frequency_equations(reader, located)
    return tuple(said) or (SymbolicFactor("", None, note="no factor has symbols"),)


def frequency_equations(reader: LetterReader, located: PoleZeroMap) -> list[SymbolicFactor]:
    """Return the frequency equations whose roots are listed, and why there is none of a factor."""
    tf, naming = reader.tf, Naming.of(reader.tf)
    try:
        page = FrequencyPage(tf) if {d.kind for d in tf.kernels.dispersions} <= {"bending", "wave"} else None
    except UsageError:
        page = None
    if page is None:
        return [SymbolicFactor("", None, note=NO_EQUATION)]
    naming.keep([Q])
    plain = {k.generator: (k.function, k.wavenumber, k.length) for k in tf.kernels.kernels}
    turning = {g: (f, a.wavenumber, a.length) for a, own in page.angles() for f, g in own.items()}
    named: list[tuple[str, Factored]] = []
    axes = (
        (_Axis(reader, "omega", page.ring, turning, page.laws(), naming, named), page.value().factors),
        (_Axis(reader, "sigma", tf.ring, plain, wavenumber_laws(tf), naming, named), tf.ratio.factors),
    )
    made = [
        axis.equation(part, kind, functions)
        for axis, factors in axes
        for part, exponent in factors
        for kind in ["zeros" if exponent > 0 else "poles"]
        if (functions := [r for r in roots_of(located, kind) if axis.place(r) > 0])
        and not axis.ring.used_in([part]).isdisjoint(axis.functions)
    ]
    for kind in ("poles", "zeros"):
        roots = [r for r in roots_of(located, kind) if not r.is_zero]
        if roots and not any(axis.place(r) > 0 for axis, _ in axes for r in roots):
            made.append(SymbolicFactor(kind, None, note=NO_EQUATION))
    return [each for each in made if each.solutions or not each.factor]


@dataclass(frozen=True, eq=False)
class _Axis:
    """Factors on one axis of the s plane: their ring, what its kernels are, and the laws of wavenumbers."""

    reader: LetterReader
    name: str  # of the distance of a root from 0
    ring: Ring
    functions: Mapping[str, tuple[str, str, Factored]]
    laws: Mapping[str, Factored]  # products that are one
    naming: Naming
    named: list[tuple[str, Factored]]  # ratios that have letters, of any factor

    def place(self, root: Root) -> arb:
        """Return where a root is on the axis, 0 of one that is not proved to be there."""
        where = (root.on_imaginary_axis, root.im) if self.name == "omega" else (root.is_real, root.re)
        return where[1] if where[0] else arb(0)

    def equation(self, part: fmpz_mpoly, kind: str, roots: Sequence[Root]) -> SymbolicFactor:
        """Return the equation of a factor with those of the roots that are its own, or why there is none."""
        used, native = self.ring.used_in([part]), self.reader.tf.ring
        kernels = {g: x for g, x in self.functions.items() if g in used}
        waves = {w for _, w, _ in kernels.values()} | (used & {*self.laws})
        lengths, silent = [x for _, _, x in kernels.values()], SymbolicFactor(kind, None, note=NO_EQUATION)
        longest = [x for x in lengths if all((y / x).is_constant and y.unit <= x.unit for y in lengths)]
        is_one = len(waves) == 1 and waves <= self.laws.keys() and longest and IMAGINARY not in used
        if not is_one or len(part) > MOST_TERMS:
            return silent
        (wave,), length = waves, longest[0]
        # omega^2 = square*wavenumber^order
        law, beta, s = self.laws[wave], *(Factored.generator(self.ring, n) for n in (wave, LAPLACE))
        order = law.exponent_of(self.ring.generator(wave))
        square = (law * s**2 / beta**order).over(native)
        terms: dict[Key, Factored] = {}
        lowest = min(dict(m).get(0, 0) for m, _ in terms_of(part))
        for monomial, c in terms_of(part):
            powers = {self.ring.names[i]: e for i, e in monomial}
            times, odd = divmod(powers.pop(LAPLACE, 0) - lowest, 2)
            if odd or square.depends_on(LAPLACE):
                return silent
            n, *shape = (powers.pop(g, 0) for g in (wave, *kernels))
            term = prod(
                (Factored.generator(native, a) ** e for a, e in powers.items()), start=square**times * c
            )
            terms[n + order * times, *shape] = terms.get((n + order * times, *shape), term * 0) + term
        ratios, factor = self._equation(terms, length, kernels)
        if len(ratios) > MOST_RATIOS:
            return silent
        printer, value = self.reader.printer, self.reader.value
        scale = printer.square_root(square / length**order)
        above, *below = scale.children if isinstance(scale, Quotient) else (scale,)
        frequency = product_of([power(Name(Q), order // 2), above])
        frequency = quotient(frequency, *below) if below else frequency
        said = [(a, printer.quotient(x)) for a, x in ratios.items()]
        formulas = [RootFormula(a, e, value(e).real) for a, e in said]
        known = {a: value(e) for a, e in said}
        solutions = tuple(self._solutions(factor, value(scale).real, order // 2, known, roots))
        formulas.append(RootFormula(self.name, frequency, None, "rad/s", tuple(r for _, r in solutions)))
        note = EXACT.get(factor.name, "") if isinstance(factor, Call) else ""
        return SymbolicFactor(kind, factor, tuple(formulas), (), solutions, note)

    def _equation(
        self,
        terms: Mapping[Key, Factored],
        length: Factored,
        kernels: Mapping[str, tuple[str, str, Factored]],
    ) -> tuple[dict[str, Factored], Expression]:
        """Return names of ratios of parameters, and what is zero in them."""
        ring, model, ratios = self.reader.tf.ring, self.reader.tf.model, dict[str, Factored]()
        used = [e for u in model.elements if isinstance(u.element, LineElement) for _, e in u.values]
        native = {n.name for e in used for n in names(e) if isinstance(n, Name)}

        def weight(item: tuple[Key, Factored]) -> tuple[int, int, int]:
            names_used = ring.used_in(f for f, _ in item[1].factors)
            alike = sum((c / item[1]).is_constant for c in terms.values())
            return len(names_used & native) - 2 * len(names_used - native), alike, -item[0][0]

        (first, *_), reference = max(terms.items(), key=weight)
        found = [(key, c / reference * length ** (first - key[0])) for key, c in terms.items()]
        groups: dict[tuple[tuple[str, ...], int], dict[Key, Fraction]] = {}
        for (n, *shape), ratio in sorted(found, key=lambda item: len(item[1].factors)):
            products = [(), *((a,) for a in ratios), *combinations_with_replacement(ratios, 2)]
            rests = [(held, ratio / prod((ratios[a] for a in held), start=ratio**0)) for held in products]
            held, remainder = next(((held, x) for held, x in rests if x.is_constant), ((), ratio))
            if not remainder.is_constant:
                plain_ratio = ratio / ratio.unit
                known = next((name for name, x in self.named if (x / plain_ratio).is_one), None)
                held = (
                    (known,)
                    if known
                    else self.naming.take(self._letter(ratio, "mu" if n > first else "kappa"))
                )
                self.named.append((held[0], plain_ratio))
                ratios[held[0]], remainder = plain_ratio, ratio**0 * ratio.unit
            groups.setdefault((held, n), {})[0, *shape] = remainder.unit
        small, least = Ring((LAPLACE, *kernels)), min(n for _, n in groups)
        below = lcm(*(c.denominator for group in groups.values() for c in group.values()))
        plain, q = self.reader.printer, Name(Q)
        angles = {g: wave_times_length(plain, q, x / length) for g, (_, _, x) in kernels.items()}
        symbols = {g: Call(f, angles[g]) for g, (f, _, _) in kernels.items()}
        printer, parts = ProductPrinter(Arranger.plain(small, symbols, kernels)), list[Expression]()
        for (held, n), group in groups.items():
            total = printer.sum(small.context.from_dict({m: int(c * below) for m, c in group.items()}))
            parts.append(product_of([*map(Name, held), power(q, n - least), total]))
        return ratios, sum_of(parts)

    def _letter(self, ratio: Factored, usual: str) -> str:
        """Return the letter of a ratio, by the unit of what is divided where one is declared."""
        above = self.reader.tf.ring.used_in(f for f, e in ratio.factors if e > 0)
        units = [
            str(unit_of(p.unit).dimension)
            for p in self.reader.tf.model.parameters
            if p.name in above and p.unit
        ]
        letters = [RATIOS[unit][0] for unit in units if unit in RATIOS and unit != "m"]
        return letters[0] if letters else usual

    def _solutions(
        self, factor: Expression, scale: arb, order: int, known: Mapping[str, acb], roots: Sequence[Root]
    ) -> Iterator[tuple[arb, Root]]:
        """Yield the q of every root at which the equation as printed changes its sign, or is zero."""
        for root in roots:
            q = self.place(root) / scale
            q = q.sqrt() if order > 1 else q
            points = (q, q * (1 - BESIDE), q * (1 + BESIDE))
            middle, low, high = (self.reader.value(factor, **known, **{Q: acb(x)}).real for x in points)
            if middle.contains(0) and (low * high < 0 or (root.multiplicity > 1 and low * high > 0)):
                yield q, root
