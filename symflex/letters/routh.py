"""For which values of its parameters every pole, or every zero, of a lumped model lies left of the axis.

Input: a characteristic polynomial, or a numerator, in s and letters. Output: :class:`Conditions`.

Example: ``m s^3 + b s^2 + (k + K) s + K_i`` is stable exactly when ``b*(k + K) > m*K_i``.

Coefficients ``a_0 s^n + ... + a_n`` with ``a_0 > 0`` have all roots left of the axis exactly when ``a_n``,
``a_(n-2)``, ... are positive, or ``a_n``, ``a_(n-1)``, ``a_(n-3)``, ..., and so are the Hurwitz determinants
``D_(n-1)``, ``D_(n-3)``, ... (Liénard and Chipart 1914; Gantmacher 1959, XV.13). A polynomial ``Q(s^2)``
has simple roots on the axis and no others exactly when this holds for ``Q(s^2) + s Q'(s^2)`` (Hermite and
Biehler).
What follows from signs of parameters, or from other conditions, is left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from math import prod
from random import Random
from typing import TYPE_CHECKING, Final, Literal

from flint import acb, acb_poly

from symflex.algebra import Ring, by_powers, degree_in, irreducible_factors, summed, terms_of
from symflex.balls import precision
from symflex.budget import spend
from symflex.errors import REPORT, BudgetError, Diagnostic, InternalError, ModelError, Text, UsageError
from symflex.expressions import PROGRAM_LIMITS, format_expression, number, parse
from symflex.library.elements import CIRCUITS
from symflex.loops.over import seen_pair
from symflex.model.loss_factors import check_causal
from symflex.print.forms import Arranger
from symflex.print.forms.arrange import length
from symflex.print.forms.notation import constant_symbols
from symflex.print.latex import latex_expression
from symflex.print.latex.equation import model_labels
from symflex.print.text import broken
from symflex.roots.passivity import energy_proof
from symflex.transfer.enclose import principal_values
from symflex.transfer.of_model import derive_all, pick_pairs

if TYPE_CHECKING:
    from collections.abc import Iterable

    from flint import fmpz_mpoly

    from symflex.expressions import Expression
    from symflex.model import Model
    from symflex.transfer import TransferFunction

LONGEST: Final = 40
"""Terms of a condition that a person still reads: half a page."""
MOST_PRODUCTS: Final = 1_000_000
"""Products of terms in one step of the elimination, which take about half a second."""
SQUARES: Final = 3
"""Generators one after the other whose squares are completed to prove a sign."""
POINTS: Final = 12
BITS: Final = 192
"""Random values of all letters at which conditions are compared with roots, and precision of these."""
POLES: Final = "poles"
ALL_LEFT: Final = "all left of the imaginary axis"
Relation = Literal[">", "!="]
Factor = tuple["fmpz_mpoly", int]


@dataclass(frozen=True, slots=True)
class Inequality:
    """``left > right`` or ``left != right``; without sides where these are too long to be read."""

    terms: int
    relation: Relation
    sides: tuple[Expression, Expression] | None

    def __str__(self) -> str:
        if self.sides is None:
            return f"a sum of {self.terms} terms, too long to be read, {self.relation} 0"
        return f" {self.relation} ".join(map(format_expression, self.sides))


Found = Sequence[tuple["fmpz_mpoly", Inequality]]


@dataclass(frozen=True)
class Conditions:
    """Where the poles or zeros of a model lie, in letters; its text says so."""

    model: Model
    of: str  # ``poles`` or ``zeros of OUT/IN``
    conditions: tuple[Inequality, ...]
    never: str  # why roots lie right of the axis for all values; empty where they need not
    on_axis: tuple[tuple[str, int], ...]  # factors whose roots stay on the axis, with multiplicities

    @property
    def sentence(self) -> str:
        """What holds exactly under the conditions."""
        if self.never:
            return f"{self.of}: for no values {ALL_LEFT}: {self.never}"
        parts = ", ".join(text + (f" ({n} times)" if n > 1 else "") for text, n in self.on_axis)
        said = f"those of {parts} on the imaginary axis, all others left of it" if parts else ALL_LEFT
        return f"{self.of}: {said}{' exactly when' if self.conditions else ''}"

    def __str__(self) -> str:
        loose = ", ".join(p.name for p in self.model.parameters if p.assume != "positive")
        values = f"for positive values of all letters{f' but {loose}' if loose else ''}"
        return "\n".join(
            [*broken(self.sentence), *(f"    {line}" for line in (*map(str, self.conditions), values))]
        )

    def latex(self) -> str:
        """Return the conditions as a display, the sentence above them as a comment."""
        labels, signs = model_labels(self.model), {">": ">", "!=": r"\neq"}
        shown = [(c.sides, f" &{signs[c.relation]} ") for c in self.conditions if c.sides]
        rows = [sign.join(latex_expression(e, labels) for e in sides) for sides, sign in shown]
        long = [f"% {c}" for c in self.conditions if not c.sides]
        display = [r"\begin{align*}", " \\\\\n".join(rows), r"\end{align*}"] if rows else []
        return "\n".join([f"% {self.sentence}", *long, *display])

    def to_json_dict(self) -> dict[str, object]:
        """Return the conditions in the schema ``symflex.stability/1``."""
        return {
            "schema": "symflex.stability/1",
            "of": self.of,
            "never": self.never or None,
            "on_axis": [list(each) for each in self.on_axis],
            "conditions": [
                {"condition": str(c) if c.sides else None, "terms": c.terms} for c in self.conditions
            ],
        }


def conditions(model: Model, of: str = POLES, tf: str | None = None) -> Conditions:
    """Return when all poles of a lumped model, or all zeros of a function, lie left of the imaginary axis.

    Raises ModelError: SF801 with beams, rods or delays; UsageError: SF902 for no such function; BudgetError:
    SF501, SF502 when the conditions are too large to be found.

    Examples
    --------
    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... parameters = { K = {}, T_1 = {}, T_2 = {} }
    ... signals.y = "K/(s*(T_1*s + 1)*(T_2*s + 1))*(r - y)"
    ... inputs.r = {}
    ... outputs.Y = "y"
    ... ''')
    >>> print(conditions(model))
    poles: all left of the imaginary axis exactly when
        T_1 + T_2 > K*T_1*T_2
        for positive values of all letters
    """
    if of not in (POLES, "zeros"):
        raise UsageError(Diagnostic("SF902", f"conditions are those of poles or zeros, not of '{of[:64]}'"))
    check_causal(model, "stability in letters")
    if model.is_distributed:
        message = "conditions in letters are for models without beams, rods and delays"
        hint = "boundaries in numbers are: --gain K, or --over any parameter"
        raise ModelError(Diagnostic("SF801", message, None, hint))
    pairs = pick_pairs(model, [tf] if tf else [])
    (own,) = derive_all(model, [seen_pair(model) if of == POLES else pairs[0]])
    if of == POLES:
        hidden = ((h.polynomial, h.multiplicity) for h in own.hidden)
        return conditions_of(own, of, [*own.den.factors, *hidden])
    return conditions_of(own, f"zeros of {own.name}", own.num.factors)


def conditions_of(tf: TransferFunction, of: str, polynomials: Iterable[Factor]) -> Conditions:
    """Return when all roots of some polynomials of a transfer function's ring lie left of the axis."""
    signs = Signs.of(tf)
    arranger = Arranger.plain(signs.ring, constant_symbols(tf))
    every: dict[str, Factor] = {}
    for polynomial, times in polynomials:
        for factor, n in irreducible_factors(polynomial)[1]:
            if degree_in(factor, 0):
                every[str(factor)] = factor, n * times + every.get(str(factor), (factor, 0))[1]
    needed: list[fmpz_mpoly] = []
    on_axis, moving = [], []
    for factor, times in every.values():
        is_even = not any(m[0] % 2 for m in factor.monoms())
        if is_even or len(factor) == 1:
            is_long = len(factor) > LONGEST
            text = (
                f"a factor of {len(factor)} terms"
                if is_long
                else format_expression(arranger.collected(factor))
            )
            on_axis.append((text, times))
        # Energy keeps poles from the right of the axis: then poles that are their own mirror images lie on
        # it, and others meet it only where the last determinant vanishes.
        is_kept_left = of == POLES and is_passive(tf.model)
        if len(factor) > 1 and not (is_even and is_kept_left):
            moving.append((factor, is_even))
            needed += _hurwitz(signs, factor, is_even=is_even, is_kept_left=is_kept_left)
    try:
        found, never = (
            [(f, inequality_of(arranger, f, relation)) for f, relation in signs.reduced(needed)],
            "",
        )
    except NeverError as error:
        (impossible,) = error.args
        found, never = [], f"{inequality_of(arranger, impossible, '>')} would have to hold"
        if impossible.is_zero():
            never = "a power of s is missing, or a Hurwitz determinant is 0"
    _check(tf, signs, moving, None if never else found)
    return Conditions(tf.model, of, tuple(condition for _, condition in found), never, tuple(on_axis))


def inequality_of(arranger: Arranger, polynomial: fmpz_mpoly, relation: Relation) -> Inequality:
    """Return a condition in its shortest print: all on the left, or no minus sign."""
    if len(polynomial) > LONGEST:
        return Inequality(len(polynomial), relation, None)
    parts = [{m: c * sign for m, c in polynomial.terms() if c * sign > 0} for sign in (1, -1)]
    above, below = (arranger.grouped(polynomial.context().from_dict(part)) for part in parts)
    tried = (arranger.grouped(polynomial), number(0)), (above, below)
    return Inequality(len(polynomial), relation, min(tried, key=lambda sides: length(*sides)))


class NeverError(Exception):
    """A condition that no values meet: its argument would have to be positive."""


def is_passive(model: Model) -> bool:
    """Tell whether a model is a mechanism that supplies no energy, whatever positive values it has."""
    elements = [use.element for use in model.elements]
    return (
        all(p.assume != "real" for p in model.parameters)
        and all(e.passive is not None and all(p.domain not in CIRCUITS for p in e.ports) for e in elements)
        and energy_proof(model, free=[p.name for p in model.parameters]).is_passive
    )


def _hurwitz(signs: Signs, polynomial: fmpz_mpoly, *, is_even: bool, is_kept_left: bool) -> list[fmpz_mpoly]:
    """Return what is positive exactly when all roots lie left of the axis, or on it and are simple."""
    ring = signs.ring
    a = ring.coefficients(polynomial)[::-1]
    if is_even:  # the derivative of Q by s^2, times s
        a = [c if i % 2 == 0 else a[i - 1] * ((len(a) - i) // 2) for i, c in enumerate(a)]
    known = [c for c in a if signs.of_polynomial(c)]
    front = ring.constant(signs.of_polynomial(known[0])) if known else a[0]
    a = [c * front for c in a]
    n, zero = len(a) - 1, ring.constant(0)
    pivots = _pivots(
        [[a[k] if 0 <= (k := 2 * j - i + 1) <= n else zero for j in range(n - 1)] for i in range(n - 1)]
    )
    halves = [a[n::-2], [a[n], *a[n - 1 :: -2]]]
    half = min(halves, key=lambda each: sum(len(c) for c in each if signs.of_polynomial(c) != 1))
    return [a[0], a[n], *pivots[-1:]] if is_kept_left else [a[0], *half, *pivots[::-2]]


def _pivots(rows: list[list[fmpz_mpoly]]) -> list[fmpz_mpoly]:
    """Return the leading principal minors of a matrix (Bareiss 1968); 0 from the first that vanishes on."""
    minors: list[fmpz_mpoly] = []
    last = None
    for k in range(len(rows)):
        pivot = rows[k][k]
        minors.append(pivot)
        if pivot.is_zero():
            return minors + [pivot] * (len(rows) - k - 1)
        for i, j in product(range(k + 1, len(rows)), repeat=2):
            spend()
            terms = len(pivot) * len(rows[i][j]) + len(rows[i][k]) * len(rows[k][j])
            if terms > MOST_PRODUCTS:
                message = f"conditions in letters would be sums of more than {MOST_PRODUCTS} products"
                hint = "give numbers to the letters that do not matter: write them in place of their names"
                raise BudgetError(Diagnostic("SF501", message, None, hint))
            value = pivot * rows[i][j] - rows[i][k] * rows[k][j]
            rows[i][j] = value if last is None else value / last
        last = pivot
    return minors


@dataclass(frozen=True)
class Signs:
    """Which generators of a ring are positive or at least not negative, and what follows from that."""

    ring: Ring
    positive: frozenset[str]
    nonnegative: frozenset[str]  # and those that are positive

    @classmethod
    def of(cls, tf: TransferFunction) -> Signs:
        """Return what a model assumes of its parameters; real roots and exponentials are positive."""
        positive = {p.name for p in tf.model.parameters if p.assume == "positive"} | {"pi"}
        positive |= {c.generator for c in tf.constants if c.expression.name in ("sqrt", "exp", "cosh")}
        loose = {p.name for p in tf.model.parameters if p.assume == "nonnegative"}
        return cls(tf.ratio.ring, frozenset(positive), frozenset(positive | loose))

    def of_polynomial(self, polynomial: fmpz_mpoly) -> int:
        """Return 1 where it is proved to be positive, -1 negative, and 0 where its sign is not known."""
        return int(self.is_positive(polynomial)) - int(self.is_positive(-polynomial))

    def is_positive(self, polynomial: fmpz_mpoly, depth: int = SQUARES) -> bool:
        """Tell whether a polynomial is proved to be positive for all values.

        Its terms are, or its coefficients in one letter, or a quadratic in it whose discriminant is negative.
        """
        names = self.ring.names
        terms = [([(names[i], e) for i, e in m], c) for m, c in terms_of(polynomial)]
        is_sum = all(c > 0 and all(n in self.nonnegative or e % 2 == 0 for n, e in m) for m, c in terms)
        if is_sum and any(all(n in self.positive for n, _ in m) for m, _ in terms):
            return True
        if depth == 0 or len(terms) > LONGEST or all(c < 0 for _, c in terms):
            return False
        number, factors = irreducible_factors(polynomial)
        if len(factors) > 1 or (factors and factors[0][1] > 1):
            known = [self.of_polynomial(f) for f, _ in factors]
            return all(known) and number * prod(s**e for s, (_, e) in zip(known, factors, strict=True)) > 0
        for i, name in enumerate(names):
            parts = by_powers(self.ring, polynomial, i)
            if len(parts) == 1 or 0 not in parts:
                continue
            if name in self.nonnegative and all(self.is_positive(c, depth - 1) for c in parts.values()):
                return True
            if max(parts) == 2 and self.is_positive(parts[2], depth - 1):  # noqa: PLR2004 (a quadratic)
                middle = parts.get(1, self.ring.constant(0))
                if self.is_positive(4 * parts[2] * parts[0] - middle * middle, depth - 1):
                    return True
        return False

    def reduced(self, needed: Sequence[fmpz_mpoly]) -> list[tuple[fmpz_mpoly, Relation]]:
        """Return what holds exactly where some polynomials are positive, without conditions that follow."""
        products: list[tuple[int, list[fmpz_mpoly]]] = []
        nonzero: dict[str, fmpz_mpoly] = {}
        for polynomial in needed:
            number, factors = (-1, []) if polynomial.is_zero() else irreducible_factors(polynomial)
            signs = [(f, self.of_polynomial(f), times) for f, times in factors]
            sign = prod((s**times for _, s, times in signs if s), start=1 if number > 0 else -1)
            odd = [f for f, s, times in signs if not s and times % 2]
            nonzero |= {str(f): f for f, s, times in signs if not s and not times % 2}
            if not odd and sign < 0:
                raise NeverError(polynomial)
            products.append((sign, odd))
        known: dict[str, int] = {}
        kept: dict[str, fmpz_mpoly] = {}
        for sign, odd in sorted(products, key=lambda each: len(each[1])):
            left = [f for f in odd if str(f) not in known or len(odd) == 1]
            front = sign * prod(known[str(f)] for f in odd if f not in left)
            whole = prod(left, start=self.ring.constant(front))
            if not left and front < 0:
                raise NeverError(whole)
            known |= {str(left[0]): front} if len(left) == 1 else {}
            kept |= {str(whole): whole} if left else {}
        scales = [self.ring.constant(1), *(c for c in needed if self.of_polynomial(c) == 1)]
        chosen = sorted(kept.values(), key=len)
        for one in chosen[::-1]:
            others = [c for c in chosen if c is not one]
            more = (c * one - other for other in others for c in scales)
            if any(each.is_zero() or self.is_positive(each, 0) for each in more):
                chosen = others
        signed = {str(f) for _, odd in products for f in odd}
        loose = [f for text, f in nonzero.items() if text not in signed]
        return [*((c, ">") for c in chosen), *((f, "!=") for f in loose)]


def _check(
    tf: TransferFunction, signs: Signs, moving: Sequence[tuple[fmpz_mpoly, bool]], found: Found | None
) -> None:
    """Compare conditions with roots, and what is printed with its polynomial, at random values.

    ``found`` is None where they are never met. Raises InternalError: SF992 where they differ.
    """
    random, names = Random(tf.name), signs.ring.names
    known: dict[str, acb] = {}

    def value(polynomial: fmpz_mpoly) -> acb:
        return acb(summed(terms_of(polynomial), names, known.__getitem__, acb(1)))

    def read(side: Expression) -> acb:
        text = Text.alone("<printed>", format_expression(side))
        return principal_values(parse(text, limits=PROGRAM_LIMITS), 1, lambda name: [known[name]])[0]

    for _ in range(POINTS):
        for n in names:
            size = random.randrange(1, 2 ** random.randrange(2, 9))
            known[n] = acb(size if n in signs.nonnegative else random.choice((1, -1)) * size)
        with precision(BITS):
            known["pi"] = acb.pi()
            known |= {c.generator: read(c.expression) for c in tf.constants}
            holds, wrong = found is not None, ""
            for polynomial, condition in found or ():
                own = value(polynomial)
                holds &= bool(own.real > 0 if condition.relation == ">" else own != 0)
                left, right = map(read, condition.sides or (number(0), number(0)))
                wrong = wrong or ("" if not condition.sides or own.overlaps(left - right) else str(condition))
            placed = [
                _is_placed([value(c) for c in signs.ring.coefficients(f)], is_even=e) for f, e in moving
            ]
        if wrong or (None not in placed and holds != all(placed)):
            message = f"conditions are not shown, as they are wrong: {wrong or known}"
            raise InternalError(Diagnostic("SF992", message, None, REPORT))


def _is_placed(numbers: Sequence[acb], *, is_even: bool) -> bool | None:
    """Tell whether all roots lie left of the axis, or on it if even; None where one is too close."""
    try:
        roots = acb_poly(numbers[::2] if is_even else numbers).roots()
    except ValueError:  # they are not simple
        return None
    if numbers[-1].contains(0) or any(root.real.contains(0) for root in roots):
        return None
    return all(root.real < 0 and not (is_even and root.imag != 0) for root in roots)
