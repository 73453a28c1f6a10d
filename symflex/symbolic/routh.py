"""For which values of its parameters all poles, or all zeros, of a lumped model lie in the left half-plane.

Input: a characteristic polynomial, or a numerator, in s and letters. Output: :class:`Conditions`.

Example: ``m s^3 + b s^2 + (k + K) s + K_i`` is stable exactly when ``b*(k + K) > m*K_i``.

Coefficients ``a_0 s^n + ... + a_n`` with ``a_0 > 0`` have all roots in the left half-plane exactly when
``a_n``, ``a_(n-2)``, ... are positive, or ``a_n``, ``a_(n-1)``, ``a_(n-3)``, ..., and so are the Hurwitz
determinants ``D_(n-1)``, ``D_(n-3)``, ... (Liénard and Chipart 1914; Gantmacher 1959, XV.13). A polynomial
``Q(s^2)`` has simple roots on the axis and no others exactly when this holds for ``Q(s^2) + s Q'(s^2)``
(Hermite and Biehler). What follows from signs of parameters, or from other conditions, is left out.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import gcd, isqrt, prod
from random import Random
from typing import Final, Literal

from flint import acb, acb_poly, fmpz_mpoly

from symflex.algebra import Ring, by_powers, degree_in, irreducible_factors, summed, terms_of
from symflex.balls import precision
from symflex.budget import spend
from symflex.equations.elimination.determinants import Minors
from symflex.errors import REPORT, BudgetError, Diagnostic, InternalError, ModelError, Text, UsageError
from symflex.expressions import (
    PROGRAM_LIMITS,
    Call,
    Expression,
    Name,
    Negative,
    Product,
    Quotient,
    Sum,
    format_expression,
    negative,
    nodes,
    number,
    parse,
    power,
    product_of,
    quotient,
    sum_of,
)
from symflex.library.elements import CIRCUITS
from symflex.model import Model
from symflex.model.loss_factors import check_causal
from symflex.print.forms import CLOSED, Arranger
from symflex.print.forms.arrange import length
from symflex.print.forms.notation import Line, constant_symbols, reachable
from symflex.print.forms.shapes import SumSigns, of_powers, powers_of, rebuilt
from symflex.print.latex import latex_expression
from symflex.print.latex.equation import model_labels
from symflex.print.text import broken
from symflex.roots.passivity import energy_proof, observed
from symflex.transfer import TransferFunction
from symflex.transfer.derive import ClosedDefinitions
from symflex.transfer.enclose import principal_values
from symflex.transfer.expansion import Expansion
from symflex.transfer.of_model import UNASKED, assemble, derive_all, pick_pairs

LONGEST: Final = 40  # terms of a condition that a person still reads: half a page
FEW: Final = 20  # terms of a condition in which squares of sums are sought
MOST_TERMS: Final = 20_000  # terms of a determinant, which take about a second
SQUARES: Final = 3  # generators one after the other whose squares are completed to prove a sign
POINTS: Final = 12
BITS: Final = 192
"""Random values of all letters at which conditions are compared with roots, and precision of these."""
POLES: Final = "poles"
LEFT: Final = "in the open left half-plane"
Sign = Literal[">", "!=", "="]
Factor = tuple["fmpz_mpoly", int]


@dataclass(frozen=True, slots=True)
class SymbolicRelation:
    """``left > right``, ``left != right`` or ``left = right``; without sides too long to be read."""

    terms: int
    sign: Sign
    sides: tuple[Expression, Expression] | None

    def __str__(self) -> str:
        if self.sides is None:
            return f"a sum of {self.terms} terms, too long to be read, {self.sign} 0"
        return f" {self.sign} ".join(map(format_expression, self.sides))

    def latex(self, labels: Mapping[str, str], mark: str = "") -> str:
        """Return the relation as LaTeX; what has no readable sides as its words."""
        sign = f" {mark}{self.sign} ".replace("!=", r"\neq")
        sides = (latex_expression(side, labels) for side in self.sides or ())
        return sign.join(sides) if self.sides else rf"\text{{{self}}}"


Found = Sequence[tuple["fmpz_mpoly", SymbolicRelation]]


@dataclass(frozen=True)
class Conditions:
    """Where the poles or zeros of a model lie, in symbols; its text says so."""

    model: Model
    of: str  # ``poles`` or ``zeros of OUT/IN``
    sentence: str  # what holds exactly under the conditions
    conditions: tuple[SymbolicRelation, ...]
    on_axis: tuple[tuple[str, int], ...] = ()  # factors whose roots stay on the axis, with multiplicities
    is_never: bool = False  # True if no values meet the conditions
    where: tuple[Line, ...] = ()  # the definitions that stay closed in it

    def __str__(self) -> str:
        loose = ", ".join(p.name for p in self.model.parameters if p.assume != "positive")
        symbols = "parameters" if self.where else "symbols"
        values = f"for positive values of all {symbols}{f' but {loose}' if loose else ''}"
        lines = (f"where {name} = {format_expression(e)}" for name, e in self.where)
        realness = (f"where {root} is real" for root in self.roots_at_rest)
        return "\n    ".join(
            ["\n".join(broken(self.sentence)), *map(str, self.conditions), values, *realness, *lines]
        )

    @property
    def roots_at_rest(self) -> list[str]:
        """Square roots that were solved for at rest, and that parameters may make imaginary."""
        deciding = {Name(p.name) for p in self.model.parameters if p.is_solved_with}
        values = ((d.name, d.expression) for d in self.model.definitions if deciding & {*nodes(d.expression)})
        roots = ((n, e.operand if isinstance(e, Negative) else e) for n, e in values)
        return [f"{n} = {format_expression(e)}" for n, e in roots if isinstance(e, Call) and e.name == "sqrt"]

    def latex(self) -> str:
        """Return the conditions as a display, the sentence above them as a comment."""
        labels = model_labels(self.model)
        comments = [f"% {x}" for x in (self.sentence, *(c for c in self.conditions if not c.sides))]
        rows = [c.latex(labels, "&") for c in self.conditions if c.sides]
        rows += [
            f"{latex_expression(Name(n), labels)} &= {latex_expression(e, labels)}" for n, e in self.where
        ]
        return "\n".join([*comments, *aligned(rows)])

    def to_json_dict(self) -> dict[str, object]:
        """Return the conditions in the schema ``symflex.stability/1``."""
        shown = [{"condition": str(c) if c.sides else None, "terms": c.terms} for c in self.conditions]
        document = {"of": self.of, "never": self.is_never, "on_axis": [*map(list, self.on_axis)]}
        document |= {"real": roots} if (roots := self.roots_at_rest) else {}
        lines = {name: format_expression(e) for name, e in self.where}
        document |= {"definitions": lines} if lines else {}
        return {"schema": "symflex.stability/1", **document, "conditions": shown}


def conditions(model: Model, of: str = POLES, tf: str | None = None) -> Conditions:
    """Return when all poles of a lumped model, or all zeros of a function, lie in the left half-plane.

    Raises SF801 with kernels; SF902 for no such function; SF501, SF502 when the conditions are too large.
    """
    if of not in (POLES, "zeros"):
        raise UsageError(Diagnostic("SF902", f"conditions are those of poles or zeros, not of '{of[:64]}'"))
    check_causal(model, "symbolic stability")
    if model.is_distributed:
        message = "symbolic conditions are for models without beams, rods and delays"
        hint = "a symbolic boundary of two parameters: --symbolic --over K --over T"
        raise ModelError(Diagnostic("SF801", message, None, hint))
    pairs = pick_pairs(model, [tf] if tf else [])
    if of != POLES:
        (derived,) = derive_all(model, pairs[:1])
        opened = conditions_of(derived, f"zeros of {derived.name}", derived.num.factors)
        return _shortest(opened, derived, lambda tf: tf.num.factors)
    from symflex.loops.over import seen_pair  # live pages ask for signs alone

    pair = seen_pair(model)
    (derived,) = derive_all(observed(model, pair[0]), [pair])
    loose = _of_outputs(model) if is_passive(model) else None
    opened = conditions_of(derived, of, _characteristic(derived), loose)
    return opened if loose is not None else _shortest(opened, derived, _characteristic)


def _characteristic(tf: TransferFunction) -> list[Factor]:
    return [*tf.den.factors, *((h.polynomial, h.multiplicity) for h in tf.hidden)]


def _shortest(
    opened: Conditions, tf: TransferFunction, polynomials: Callable[[TransferFunction], Sequence[Factor]]
) -> Conditions:
    """Return conditions with definitions closed, as letters, where they say the same and are shorter."""
    closed = ClosedDefinitions(UNASKED).of(tf) if opened.conditions and not opened.is_never else None
    if closed is None or any(c.expression.name == "sqrt" for c in closed.constants):
        return opened  # a root of a definition might be imaginary
    if _powers(polynomials(closed)) != _powers(polynomials(tf)):
        return opened  # some factors, or coefficients that vanish, are seen only so
    try:
        kept = conditions_of(closed, opened.of, polynomials(closed))
    except BudgetError:
        spend()
        return opened
    is_short = CLOSED * _read(kept) < _read(opened) and all(c.sides for c in kept.conditions)
    return kept if is_short and len(kept.conditions) <= len(opened.conditions) else opened


def _powers(polynomials: Sequence[Factor]) -> list[tuple[list[int], int]]:
    """Return the powers of s in every factor, with its multiplicity."""
    factors = ((f, n * times) for p, times in polynomials for f, n in irreducible_factors(p)[1])
    return sorted((sorted({int(m[0]) for m in f.monoms()}), n) for f, n in factors if degree_in(f, 0))


def _read(found: Conditions) -> float:
    """Return the length of conditions and half of that of their definitions; of long ones that is large."""
    sides = [length(*c.sides) if c.sides else MOST_TERMS for c in found.conditions]
    return sum(sides) + length(*(e for _, e in found.where)) / 2


def conditions_of(
    tf: TransferFunction, of: str, polynomials: Iterable[Factor], loose: Container[str] | None = None
) -> Conditions:
    """Return when all roots of some polynomials of a transfer function's ring lie in the left half-plane.

    Energy keeps roots out of the right half-plane but for ``loose`` factors; ``None``: it says nothing.
    """
    signs = Signs.of(tf)
    arranger = Arranger.plain(signs.ring, constant_symbols(tf))
    every: dict[str, Factor] = {}
    for polynomial, times in polynomials:
        for factor, n in irreducible_factors(polynomial)[1]:
            if degree_in(factor, 0):
                every[str(factor)] = factor, n * times + every.get(str(factor), (factor, 0))[1]
    needed: list[fmpz_mpoly] = []
    on_axis, moving = [], []
    for key, (factor, times) in every.items():
        is_kept_left = loose is not None and key not in loose
        is_even = not any(m[0] % 2 for m in factor.monoms())
        if is_even or len(factor) == 1:
            on_axis.append((format_expression(arranger.collected(factor)), times))
        # Energy keeps poles out of the right half-plane: then poles that are their own mirror images lie on
        # it, and others meet it only where the last determinant vanishes.
        if len(factor) > 1 and not (is_even and is_kept_left):
            moving.append((factor, 1 + is_even))
            needed += _hurwitz(signs, factor, is_even=is_even)[: 3 if is_kept_left else None]
    kept = signs.reduced(needed)
    turns, is_never = SumSigns.of(tf.model), signs.is_never(kept)
    found = [(f, relation_of(arranger, f, sign, turns)) for f, sign in kept]
    _check(tf, signs, moving, found)
    stay = ", ".join(text + (f" ({n} times)" if n > 1 else "") for text, n in on_axis)
    said = f"those of {stay} on the imaginary axis, all others {LEFT}" if on_axis else f"all {LEFT}"
    said = f"never all {LEFT}, which would require" if is_never else said + " exactly when" * bool(found)
    relations = tuple(relation for _, relation in found)
    shown = [*signs.ring.used_in(f for f, _ in moving)] if on_axis else []
    parts = [*map(Name, shown), *(side for r in relations for side in r.sides or ())]
    lines = ((d.name, d.expression) for d in tf.model.definitions if d.name in signs.ring.index)
    where = reachable(parts, lines)
    return Conditions(tf.model, of, f"{of}: {said}", relations, tuple(on_axis), is_never, where)


def aligned(rows: Sequence[str]) -> list[str]:
    """Return rows of LaTeX as a display, nothing without rows."""
    return [r"\begin{align*}", " \\\\\n".join(rows), r"\end{align*}"] if rows else []


def relation_of(arranger: Arranger, polynomial: fmpz_mpoly, sign: Sign, turns: SumSigns) -> SymbolicRelation:
    """Return a condition in its shortest print: all on the left, or no minus sign."""
    if len(polynomial) > LONGEST:
        return SymbolicRelation(len(polynomial), sign, None)
    polynomial = without_content(arranger.closed(polynomial))
    parts = [{m: c * sign for m, c in polynomial.terms() if c * sign > 0} for sign in (1, -1)]
    above, below = (arranger.grouped(polynomial.context().from_dict(part)) for part in parts)
    left = without_minus(arranger.grouped(polynomial), turns)
    tried = [(left, number(0)), (turns.oriented(above), turns.oriented(below))]
    tried += [(without_minus(each, turns), number(0)) for each in _with_squares(arranger, polynomial)]
    if isinstance(left, Sum):
        taken = [term.operand for term in left.terms if isinstance(term, Negative)]
        tried.append((sum_of(t for t in left.terms if not isinstance(t, Negative)), sum_of(taken)))
    return SymbolicRelation(len(polynomial), sign, min(tried, key=lambda sides: length(*sides)))


def _with_squares(arranger: Arranger, polynomial: fmpz_mpoly) -> Iterator[Expression]:
    """Yield a sum as ``(a - b)^2`` and the rest, for each pair of squares in it whose product it has, too."""
    terms = {tuple(map(int, m)): int(c) for m, c in polynomial.terms()}
    roots = {
        m: isqrt(c) for m, c in terms.items() if c > 0 and isqrt(c) ** 2 == c and not any(e % 2 for e in m)
    }
    for (m, x), (n, y) in combinations(roots.items(), 2) if len(terms) <= FEW else ():
        between = tuple((a + b) // 2 for a, b in zip(m, n, strict=True))
        if abs(terms.get(between, 0)) == 2 * x * y:
            halves = ({tuple(e // 2 for e in k): z} for k, z in ((m, x), (n, y)))
            a, b = (polynomial.context().from_dict(half) for half in halves)
            square = a - b if terms[between] < 0 else a + b
            rest = polynomial - square**2
            yield sum_of(
                [power(arranger.grouped(square), 2), *([arranger.grouped(rest)] if len(rest) else [])]
            )


def without_content(polynomial: fmpz_mpoly) -> fmpz_mpoly:
    """Return a polynomial divided by the whole number that divides all of it, as closed definitions bring."""
    return polynomial / gcd(*map(int, polynomial.coeffs())) if len(polynomial) else polynomial


def without_minus(expression: Expression, turns: SumSigns) -> Expression:
    """Return an expression with its sums as the model writes them, and its sign taken into one of them."""

    def absorbed(whole: Expression) -> Expression:
        match whole:
            case Quotient() if gcd(*(powers_of(side)[0].numerator for side in whole.children)) > 1:
                return absorbed(of_powers(*powers_of(whole)))
            case Negative(Quotient(above, below)) | Quotient(Negative(above), below):
                if (turned := _turned(above)) is None and (other := _turned(below)) is not None:
                    return quotient(above, other)
                return quotient(turned or negative(above), below)
            case Negative(inner):
                return _turned(inner) or whole
            case Sum(terms) if all(isinstance(term, Negative) for term in terms):
                return _turned(sum_of(map(negative, terms))) or whole
        return whole

    def in_roots(part: Expression) -> Expression:
        return replace(part, argument=absorbed(part.argument)) if isinstance(part, Call) else part

    return absorbed(rebuilt(turns.oriented(expression), in_roots))


def _turned(expression: Expression) -> Expression | None:
    """Return minus an expression, the sign within a difference in it; nothing without one."""
    match expression:
        case Negative(operand):
            return operand
        case Product(factors):
            turned = ((i, _turned(f)) for i, f in enumerate(factors))
            found = next(((i, f) for i, f in turned if f is not None), None)
            return found and product_of([*factors[: found[0]], found[1], *factors[found[0] + 1 :]])
        case Sum(terms):
            is_difference = any(isinstance(t, Negative) for t in terms)
            made = [negative(t) if is_difference else _turned(t) or negative(t) for t in terms]
            made.sort(key=lambda t: isinstance(t, Negative))
            return None if isinstance(made[0], Negative) else sum_of(made)
    return None


def is_passive(model: Model) -> bool:
    """Tell whether a model is a mechanism that supplies no energy, whatever positive values it has."""
    elements = [use.element for use in model.elements]
    return (
        all(p.assume != "real" for p in model.parameters)
        and all(e.passive is not None and all(p.domain not in CIRCUITS for p in e.ports) for e in elements)
        and energy_proof(model, free=[p.name for p in model.parameters]).is_passive
    )


def _of_outputs(model: Model) -> set[str]:
    """Return the factors that outputs of a lumped model are divided by, of which its energy says nothing."""
    equations = assemble(model)
    expansion = Expansion.of(equations)
    divisors = [expansion.expanded(row.divisor) for row in equations.outputs]
    return {str(f) for value in divisors for g, _ in value.factors for f, _ in irreducible_factors(g)[1]}


def _hurwitz(signs: Signs, polynomial: fmpz_mpoly, *, is_even: bool) -> list[fmpz_mpoly]:
    """Return ends and determinant, positive exactly when roots lie to the left, or simple on the axis."""
    ring = signs.ring
    a = ring.coefficients(polynomial)[::-1]
    if is_even:  # the derivative of Q by s^2, times s
        a = [c if i % 2 == 0 else a[i - 1] * ((len(a) - i) // 2) for i, c in enumerate(a)]
    known = [c for c in a if signs.of_polynomial(c)]
    front = ring.constant(signs.of_polynomial(known[0])) if known else a[0]
    a = [c * front for c in a]
    n = len(a) - 1

    def determinant(size: int) -> fmpz_mpoly:
        rows = ({j: a[k] for j in range(size) if 0 <= (k := 2 * j - i + 1) <= n} for i in range(size))
        return Minors(tuple(rows), ring=ring, most=MOST_TERMS).determinant((1 << size) - 1)

    halves = [a[n::-2], a[n - 1 :: -2]]
    half = min(halves, key=lambda each: sum(len(c) for c in each if signs.of_polynomial(c) != 1))
    return [a[0], a[n], *(determinant(k) for k in range(n - 1, 0, -2)), *half]


@dataclass(frozen=True)
class Signs:
    """Which generators of a ring are positive or at least not negative, and what follows from that."""

    ring: Ring
    positive: frozenset[str]
    nonnegative: frozenset[str]  # and those that are positive

    @classmethod
    def of(cls, tf: TransferFunction) -> Signs:
        """Return what a model assumes of its parameters; real roots and exponentials are positive.

        Definitions that are letters of the ring have the signs that follow from their formulas.
        """
        roots = {c.generator for c in tf.constants if c.expression.name == "sqrt"}
        signed = frozenset(roots | {tf.ratio.ring.names[i] for i in tf.radicals.positive})
        loose = {p.name for p in tf.model.parameters if p.assume == "nonnegative"}
        known = cls(tf.ratio.ring, signed - loose, signed)
        for name, value in tf.definitions:
            if name in known.ring.index and value.ring == known.ring and value.unit > 0:
                factors = [f for f, _ in value.factors]
                positive = frozenset([name] if all(map(known.is_positive, factors)) else [])
                nonnegative = positive or frozenset([name] if all(map(known.is_sum, factors)) else [])
                known = cls(known.ring, known.positive | positive, known.nonnegative | nonnegative)
        return known

    def is_sum(self, polynomial: fmpz_mpoly) -> bool:
        """Tell whether all terms of a polynomial are positive or zero."""
        names = self.ring.names
        return all(
            c > 0 and all(names[i] in self.nonnegative or e % 2 == 0 for i, e in m)
            for m, c in terms_of(polynomial)
        )

    def of_polynomial(self, polynomial: fmpz_mpoly, depth: int = SQUARES) -> int:
        """Return 1 where it is proved to be positive, -1 negative, and 0 where its sign is not known."""
        return int(self.is_positive(polynomial, depth)) - int(self.is_positive(-polynomial, depth))

    def is_positive(self, polynomial: fmpz_mpoly, depth: int = SQUARES) -> bool:
        """Tell whether a polynomial is proved positive: by its terms, its coefficients, or as a quadratic."""
        names = self.ring.names
        terms = [([(names[i], e) for i, e in m], c) for m, c in terms_of(polynomial)]
        if self.is_sum(polynomial) and any(all(n in self.positive for n, _ in m) for m, _ in terms):
            return True
        # Where one letter exceeds all later ones by far, the sign is that of the first term, or the last.
        if depth == 0 or len(terms) > LONGEST or not terms or terms[0][1] < 0 or terms[-1][1] < 0:
            return False
        number, factors = irreducible_factors(polynomial)
        if len(factors) > 1 or (factors and factors[0][1] > 1):
            known = [self.of_polynomial(f, depth) for f, _ in factors]
            return all(known) and number * prod(s**e for s, (_, e) in zip(known, factors, strict=True)) > 0
        for i, name in enumerate(names):
            parts = by_powers(self.ring, polynomial, i) if degree_in(polynomial, i) else {}
            if len(parts) < 2 or 0 not in parts:  # noqa: PLR2004 (it is in one power only)
                continue
            if name in self.nonnegative and all(self.is_positive(c, depth - 1) for c in parts.values()):
                return True
            if max(parts) == 2 and self.is_positive(parts[2], depth - 1):  # noqa: PLR2004 (a quadratic)
                middle = parts.get(1, self.ring.constant(0))
                if self.is_positive(4 * parts[2] * parts[0] - middle * middle, depth - 1):
                    return True
        return False

    def is_never(self, reduced: Iterable[tuple[fmpz_mpoly, Sign]]) -> bool:
        """Tell whether what :meth:`reduced` returned is met for no values."""
        return any(f.is_zero() or self.of_polynomial(f) < 0 for f, _ in reduced)

    def reduced(self, needed: Sequence[fmpz_mpoly]) -> list[tuple[fmpz_mpoly, Sign]]:
        """Return conditions given that some polynomials are positive, one alone where it is never met."""
        known: dict[str, int] = {}
        nonzero, kept = dict[str, "fmpz_mpoly"](), dict[str, "fmpz_mpoly"]()
        split = [((-1, []) if f.is_zero() else irreducible_factors(f), f) for f in needed]
        split.sort(key=lambda each: sum(not self.of_polynomial(f) for f, _ in each[0][1]))
        for (front, factors), polynomial in split:
            sign, undecided = (1 if front > 0 else -1), []
            for factor, times in factors:
                if factor_sign := self.of_polynomial(factor) or known.get(str(factor), 0):
                    sign *= factor_sign**times
                elif times % 2:
                    undecided.append(factor)
                else:
                    nonzero[str(factor)] = factor
            if not undecided and sign < 0:  # for its own signs, or because another condition contradicts it
                return [(polynomial if self.of_polynomial(polynomial) else self.ring.constant(-1), ">")]
            if len(undecided) == 1:
                known[str(undecided[0])] = sign
            reduced_product = prod(undecided, start=self.ring.constant(sign))
            kept |= {str(reduced_product): reduced_product} if undecided else {}
        scales = [self.ring.constant(1), *(c for c in needed if self.of_polynomial(c) == 1)]
        chosen = sorted(kept.values(), key=len)
        for one in chosen[::-1]:
            others = [c for c in chosen if c is not one]
            more = (c * one - other for other in others for c in scales)
            if any(each.is_zero() or self.is_positive(each, 0) for each in more):
                chosen = others
        return [*((c, ">") for c in chosen), *((f, "!=") for text, f in nonzero.items() if text not in known)]


def _check(tf: TransferFunction, signs: Signs, moving: Sequence[Factor], found: Found) -> None:
    """Compare conditions, and what is printed, with the roots of ``moving`` at random values; SF992."""
    random, ring, known = Random(tf.name), signs.ring, dict[str, acb]()

    def value(polynomial: fmpz_mpoly) -> acb:
        return acb(summed(terms_of(polynomial), ring.names, known.__getitem__, acb(1)))

    scales = dict[int, int]()  # what is shown may lack a whole number, the same at all points
    for _ in range(POINTS):
        for n in ring.names:
            size = random.randrange(1, 2 ** random.randrange(2, 9))
            known[n] = acb(size if n in signs.nonnegative else random.choice((1, -1)) * size)
        with precision(BITS):
            known["pi"] = acb.pi()
            known |= {c.generator: read(c.expression, known.__getitem__) for c in tf.constants}
            holds, wrong = True, ""
            for i, (polynomial, shown) in enumerate(found):
                left_side, sides = (
                    value(polynomial),
                    [read(side, known.__getitem__) for side in shown.sides or ()],
                )
                holds &= bool(left_side.real > 0 if shown.sign == ">" else left_side != 0)
                difference = sides[0] - sides[1] if sides else left_side
                if i not in scales and not difference.contains(0):
                    ratio = (left_side / difference).real.unique_fmpz()
                    scales[i] = max(1, int(ratio)) if ratio is not None else 1
                wrong = wrong if left_side.overlaps(scales.get(i, 1) * difference) else str(shown)
            placed = [_is_placed([*map(value, ring.coefficients(f))][::step], step) for f, step in moving]
        if wrong or (None not in placed and holds != all(placed)):
            message = f"conditions are not shown, as they are wrong: {wrong or known}"
            raise InternalError(Diagnostic("SF992", message, None, REPORT))


def read(expression: Expression, known: Callable[[str], acb]) -> acb:
    """Return the value of what is printed, read as a user's text would be."""
    parsed = parse(Text.alone("<printed>", format_expression(expression)), limits=PROGRAM_LIMITS)
    return principal_values(parsed, 1, lambda name: [known(name)])[0]


def _is_placed(numbers: Sequence[acb], step: int) -> bool | None:
    """Tell whether all roots lie in the left half-plane, squares on the negative axis; None if close."""
    try:
        roots = acb_poly(numbers).roots()
    except ValueError:  # they are not simple
        return None
    if numbers[-1].contains(0) or any(root.real.contains(0) for root in roots):
        return None
    return all(root.real < 0 and not (step > 1 and root.imag != 0) for root in roots)
