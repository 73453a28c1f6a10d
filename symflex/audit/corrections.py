"""The smallest change that makes a printed formula right.

    printed     1/(m*s^2 - k)
    derived     1/(m*s^2 + k)
    with ? for the printed -k:   1/(m*s^2 + ?) = 1/(m*s^2 + k),   so ? = k, which is -1 times the part

One part of the formula after the other is taken as unknown. Where the formula is linear in it, the value
that makes printed and derived function equal is exact; the change is small when that value is the part times
a number, the part with another exponent, another symbol, or a sum of the same terms.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from itertools import chain, combinations, islice, product
from math import prod

from symflex.algebra import LAPLACE, Factored, by_powers
from symflex.audit.field import GrowError, UnreadError
from symflex.audit.notation import in_symbols, monomial_expression, solve_linear, symbols_of
from symflex.audit.numeric import Numbers, numbers_of
from symflex.audit.reading import Formula, FormulaReading, read
from symflex.budget import spend
from symflex.errors import BudgetError, SpecError
from symflex.expressions import (
    Call,
    Expression,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    is_number,
    negative,
    nodes,
    number,
    product_of,
    quotient,
    substitute,
    sum_of,
)
from symflex.print.forms import print_form
from symflex.print.forms.shapes import of_powers, powers_of
from symflex.transfer import TransferFunction

# Limits of the search, which is an offer and need not find anything.
MOST_PARTS = 150
MOST_TERMS = 1000
MOST_WORK = 20_000  # number of terms in all values that parts would need
EXPONENTS = tuple(Fraction(n, 2) for n in (2, 4, -2, 1, 6, -1, 8, -4, 3, 0, -3, -6))
MOST_OFFERED, MOST_LEFT_OUT = 30, 4000  # terms that a sum may have lost, and places with terms that are tried
MOST_FACTORS = 6  # of a product of which some are tried on the other side of the bar; of more, all are
FACTORS = (Fraction(2), Fraction(1, 2), Fraction(-1), Fraction(4), Fraction(1, 4))
REAL_POINT, FEW_DIGITS = (Fraction(1), Fraction(0)), 15
"""First point at which a formula with another line is tried, and its digits: roots are unambiguous there."""
LINE_EXPONENTS = tuple(Fraction(n, 4) for n in (2, 1, 4, 8, -2, 12, 16, -1, -4))
MOST_PAIRS, FEW_SLIPS = 1500, 20  # pairs of slips in a line that are tried, and slips in each of two lines
S = Name(LAPLACE)
ODD = ("sin", "tan", "sinh", "tanh")
FUNCTION_SWAPS = ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp")


@dataclass(frozen=True, slots=True)
class Change:
    """One part that is printed differently from what was derived."""

    place: str  # ``numerator``, ``denominator``, ``factor``, ``scale``, or ``line NAME``
    # printed and derived: the part; number 0 for a term that is not printed.
    printed: Expression
    derived: Expression


@dataclass(frozen=True, slots=True)
class Correction:
    """The derived function in the printed formula's own symbols."""

    changes: tuple[Change, ...]  # all there is to change
    expression: Expression  # the corrected formula
    scale: Expression | None  # the corrected scale
    lines: tuple[tuple[str, Expression], ...]  # the corrected ``where`` lines


def find_correction(reading: FormulaReading, tf: TransferFunction) -> Correction | None:
    """Return the smallest change found that makes the formula right; it is proved to do so."""
    if sum(len(f) for f, _ in (*reading.derived.factors, *reading.printed.factors)) > MOST_TERMS:
        return None
    numbers = numbers_of(reading.formula, tf, tf.model)
    lines = _mended_lines(reading, numbers), _other_lines(reading, numbers)
    inside = _mended_calls(reading, tf, numbers), _exchanged_names(reading, numbers)
    sums = _both_sums(reading), _inverted_ratios(reading, numbers)
    last = lines[1], _derived_lines(reading, tf, numbers), _slipped_twice(reading, numbers)
    for change in chain(lines[0], inside[0], _in_expression(reading, tf, numbers), inside[1], *sums, *last):
        corrected = Formula(change.expression, change.scale, change.lines, reading.formula.parameters)
        try:
            again = read(corrected, tf)
        except (UnreadError, SpecError, BudgetError):
            continue
        if again.field.equal(again.printed, again.derived):
            return change
    return None


def _in_expression(reading: FormulaReading, tf: TransferFunction, numbers: Numbers) -> Iterator[Correction]:
    formula = reading.formula
    parts = [(p, side) for p, side in _parts(formula.expression) if p is not formula.expression]
    if formula.scale is not None:
        parts += [(p, "scale") for p, _ in _parts(formula.scale)]
    wanted: list[_Wanted] = []
    work = 0
    for part, side in parts[:MOST_PARTS]:
        spend()
        if work > MOST_WORK:
            break
        try:
            value = _needed(reading, part)
        except (UnreadError, GrowError, BudgetError, SpecError, ZeroDivisionError):
            continue
        if value is not None:
            wanted.append(_Wanted(reading, part, side, value))
            work += sum(len(f) for f, _ in value.factors)
    yield from _by_rules((_times_number, _other_exponent, _other_symbol), wanted)
    yield from _left_out(reading, tf, numbers)
    yield from _by_rules((_times_monomial, _other_terms, _more_terms), wanted)


def _by_rules(
    rules: Sequence[Callable[[_Wanted], Iterator[Correction]]], wanted: Sequence[_Wanted]
) -> Iterator[Correction]:
    for rule in rules:
        for each in wanted:
            spend()
            try:
                yield from rule(each)
            except (UnreadError, GrowError, BudgetError, ZeroDivisionError):
                continue


def _left_out(reading: FormulaReading, tf: TransferFunction, numbers: Numbers) -> Iterator[Correction]:
    """Yield sums that lost a term, a sum that is missing as a factor, and sums and inverses exchanged.

    Terms and factors are those of the derived function, as a person looks for what is not printed.
    """
    formula = reading.formula
    form = print_form(tf)
    parameters = formula.parameters | {p.name for p in tf.parameters}
    known = {*parameters, *(name for name, _ in formula.lines), LAPLACE, "pi"}
    derived = [
        n
        for n in (*nodes(form.num), *nodes(form.den))
        if isinstance(n, Sum) and all(x.name in known for x in nodes(n) if isinstance(x, Name))
    ]
    named = dict.fromkeys(t for each in derived for t in each.terms)
    terms = list(islice(named, MOST_OFFERED))
    terms += [n for n in (number(1), *map(Name, sorted(parameters))) if n not in named]
    terms += [quotient(number(1), Name(n)) for n in sorted(parameters)]
    parts = list(_parts(formula.expression))[:MOST_PARTS]
    summands = [t for part, _ in parts if isinstance(part, Sum) for t in part.terms]

    def offered() -> Iterator[tuple[Expression, Expression, Change]]:
        for part, side in sorted(parts, key=lambda p: len(nodes(p[0]))):
            for new, before, after in _exchanged_inverses(part):
                yield part, new, Change(side, before, after)
            for before, more in _places_for_terms(part):
                if before is part and any(part is t for t in summands):  # its sum loses the term
                    continue
                printed = before.terms if isinstance(before, Sum) else (before,)
                for term in terms:
                    if term not in printed:
                        # The change of a sum, or of a side of the bar, is the missing term alone.
                        is_side = isinstance(part, Quotient) and part is formula.expression
                        is_sum = isinstance(before, Sum) or is_side
                        change = (number(0), term) if is_sum else (before, sum_of([before, term]))
                        yield part, more(term), Change(side, *change)
        whole = formula.expression
        for missing in dict.fromkeys(derived):
            yield whole, product_of([whole, missing]), Change("numerator", number(1), missing)
            yield whole, quotient(whole, missing), Change("denominator", number(1), missing)

    for part, new, change in islice(offered(), MOST_LEFT_OUT):
        expression = _replaced(formula.expression, part, new)
        if _agrees(replace(numbers, formula=replace(formula, expression=expression))):
            yield Correction((change,), expression, formula.scale, formula.lines)


def _places_for_terms(part: Expression) -> Iterator[tuple[Expression, Callable[[Expression], Expression]]]:
    """Yield what may have lost a term: a sum, or some factors of a product, with what makes one of them."""
    match part:
        case Sum():
            yield part, lambda term: sum_of([*part.children, term])
        case Product(factors) if len(factors) <= MOST_FACTORS:
            for begin, end in combinations(range(len(factors) + 1), 2):
                inside = product_of(factors[begin:end])
                if not isinstance(inside, Sum | Number):
                    yield (
                        part if end - begin == len(factors) else inside,
                        partial(_with_term, inside, factors[:begin], factors[end:]),
                    )
        case Quotient(above, below):
            if isinstance(above, Name | Call | Power):
                yield above, lambda term: quotient(sum_of([above, term]), below)
            if isinstance(below, Name | Call | Power):
                yield below, lambda term: quotient(above, sum_of([below, term]))


def _with_term(
    inside: Expression, before: Sequence[Expression], after: Sequence[Expression], term: Expression
) -> Expression:
    return product_of([*before, sum_of([inside, term]), *after])


def _exchanged_inverses(part: Expression) -> Iterator[tuple[Expression, Expression, Expression]]:
    """Yield a sum with terms turned over, as inverses, both, or multiplied, and what these terms become."""
    if not isinstance(part, Sum):
        return
    every = tuple(range(len(part.terms)))
    for chosen in dict.fromkeys((every, *combinations(every, 2))):
        inside = [part.terms[i] for i in chosen]
        others = [t for i, t in enumerate(part.terms) if i not in chosen]
        inverses = sum_of([quotient(number(1), t) for t in inside])
        plain = sum_of(inside)
        for new in (quotient(number(1), plain), inverses, quotient(number(1), inverses), product_of(inside)):
            yield sum_of([*others, new]), plain, new


def _parts(expression: Expression) -> Iterator[tuple[Expression, str]]:
    """Yield every part with where it stands, outer ones first; a bar within a sum does not count."""
    pending = [(expression, "numerator", False)]
    while pending:
        node, side, within = pending.pop()
        yield node, side
        match node:
            case Quotient(above, below) if not within:
                other = "denominator" if side == "numerator" else "numerator"
                pending += [(below, other, False), (above, side, False)]
            case Power(base, _):
                pending.append((base, side, within))
            case _:
                inner = within or isinstance(node, Sum | Call)
                pending += [(child, side, inner) for child in reversed(node.children)]


def _needed(reading: FormulaReading, part: Expression) -> Factored | None:
    """Return the value of a part with which printed and derived function would be equal."""
    formula, field = reading.formula, reading.field
    gap = reading.value(formula.whole, part) - reading.derived
    index = field.ring.index["?"]
    polynomial = field.number(1)
    for factor, exponent in gap.factors:
        if exponent > 0 and int(factor.degrees()[index]):
            polynomial = polynomial * Factored.polynomial(field.ring, factor) ** exponent
    expanded = field.reduce(polynomial.expand())
    if not len(expanded) or int(expanded.degrees()[index]) != 1:
        return None
    powers = by_powers(field.ring, expanded, index)
    constant = Factored.polynomial(field.ring, powers.get(0, field.ring.constant(0)))
    return None if constant.is_zero else -constant / Factored.polynomial(field.ring, powers[1])


@dataclass(frozen=True, eq=False)
class _Wanted:
    """A part of a formula, where it stands, and the value with which the formula would be right."""

    reading: FormulaReading
    part: Expression
    place: str
    value: Factored

    def replaced_by(self, new: Expression, *changes: Change) -> Correction:
        """Return the formula with another part; the part itself is the change where none is given."""
        formula = self.reading.formula
        expression = _replaced(formula.expression, self.part, new)
        scale = None if formula.scale is None else _replaced(formula.scale, self.part, new)
        return Correction(changes or (Change(self.place, self.part, new),), expression, scale, formula.lines)


def _times_number(wanted: _Wanted) -> Iterator[Correction]:
    """Yield the part times a rational number: a coefficient, sign or factor."""
    reading, part = wanted.reading, wanted.part
    ratio = reading.field.constant_ratio(wanted.value, reading.value(part))
    if ratio is not None and ratio.is_constant:
        yield wanted.replaced_by(_times(ratio.unit, part))


def _times(ratio: Fraction, part: Expression) -> Expression:
    """Return a part times a number: one number, in lowest terms, in front of it and below its bar."""
    front, rest = _parted(part)
    value = ratio * front
    above: Expression = rest
    below: Expression = number(1)
    while isinstance(above, Quotient) and (abs(value.numerator) != 1 or is_number(below, 1)):
        below = product_of([above.denominator, below])
        above = above.numerator
    product = product_of([number(value.numerator), above])
    divisor = product_of([number(value.denominator), below])
    return product if is_number(divisor, 1) else quotient(product, divisor)


def _parted(part: Expression) -> tuple[Fraction, Expression]:
    """Return the number in front of a part, and the rest."""
    match part:
        case Number(value):
            return value, number(1)
        case Negative(operand):
            front, rest = _parted(operand)
            return -front, rest
        case Product(factors):
            each = [_parted(factor) for factor in factors]
            return prod((front for front, _ in each), start=Fraction(1)), product_of(rest for _, rest in each)
        case Quotient(above, below):
            (front, rest), (under, divisor) = _parted(above), _parted(below)
            if under:
                return front / under, rest if is_number(divisor, 1) else quotient(rest, divisor)
    return Fraction(1), part


def _times_monomial(wanted: _Wanted) -> Iterator[Correction]:
    """Yield the part times powers of s and the parameters."""
    reading, part = wanted.reading, wanted.part
    ratio = reading.field.constant_ratio(wanted.value, reading.value(part))
    factor = None if ratio is None else monomial_expression(reading.field, ratio)
    if factor is not None:
        front, powers = powers_of(product_of([part, factor]))
        ordered = sorted(powers.items(), key=lambda item: item[0] == S)
        yield wanted.replaced_by(of_powers(front, dict(ordered)))


def _other_exponent(wanted: _Wanted) -> Iterator[Correction]:
    """Yield the part with another exponent."""
    field, part = wanted.reading.field, wanted.part
    base, known = (part.base, part.exponent) if isinstance(part, Power) else (part, Number(Fraction(1)))
    if not isinstance(part, Power | Name | Call | Sum | Quotient):
        return
    inner = wanted.reading.value(base)
    for exponent in EXPONENTS:
        if number(exponent) == known:
            continue
        try:
            power = field.power(inner, exponent)
        except (UnreadError, GrowError):
            continue
        if field.equal(power, wanted.value):
            new = number(1) if exponent == 0 else _raised(base, exponent)
            yield wanted.replaced_by(new)


def _other_symbol(wanted: _Wanted) -> Iterator[Correction]:
    """Yield another name, or another function of the same argument."""
    reading, part = wanted.reading, wanted.part
    others: list[Expression] = []
    if isinstance(part, Name):
        available = (*reading.lines, "s", *sorted(reading.formula.parameters))
        others = [Name(n) for n in available if n != part.name]
    elif isinstance(part, Call):
        others = [Call(f, part.argument) for f in FUNCTION_SWAPS if f != part.name]
    quotients = [n for n in nodes(reading.formula.expression) if isinstance(n, Quotient)]
    around = [(len(nodes(q)), i) for i, q in enumerate(quotients) if any(n is part for n in nodes(q))]
    for other in others:
        if reading.field.equal(reading.value(other), wanted.value):
            if around and isinstance(part, Name):
                replaced = _replaced(within := quotients[min(around)[1]], part, other)
                plain = of_powers(*powers_of(replaced))
                if len(nodes(plain)) < len(nodes(replaced)):  # T_22 is no T_22*Z_1/Z_1
                    yield replace(wanted, part=within).replaced_by(plain)
                    continue
            yield wanted.replaced_by(other)


def _other_terms(wanted: _Wanted) -> Iterator[Correction]:
    """Yield a sum of the same terms with other coefficients, and another number in front of all."""
    reading, part, side = wanted.reading, wanted.part, wanted.place
    if not isinstance(part, Sum):
        return
    coefficients = solve_linear(reading.field, wanted.value, [reading.value(t) for t in part.terms])
    if coefficients is None:
        return
    common = _shared(reading, part, coefficients)
    changes, terms = [], []
    for term, coefficient in zip(part.terms, coefficients, strict=True):
        new = _times(coefficient / common, term)
        terms.append(new)
        if coefficient != common:
            changes.append(Change(side, term, new))
    corrected = wanted.replaced_by(sum_of(terms))
    expression = corrected.expression
    if common != 1:
        expression, before, after = _scaled(expression, common if side == "numerator" else 1 / common)
        changes.insert(0, Change("factor", before, after))
    yield Correction(tuple(changes), expression, corrected.scale, corrected.lines)


def _shared(reading: FormulaReading, part: Sum, coefficients: tuple[Fraction, ...]) -> Fraction:
    """Return the number most coefficients share, one where the formula is not proportional to the sum."""
    without = reading.value(reading.formula.whole, part)
    index = reading.field.ring.index["?"]
    holding = [(f, e) for f, e in without.factors if int(f.degrees()[index])]
    if len(holding) != 1 or len(holding[0][0]) > 1 or abs(holding[0][1]) != 1:
        return Fraction(1)
    nonzero = [c for c in coefficients if c]
    common, times = Counter(nonzero).most_common(1)[0]
    return common if times > 1 and nonzero.count(Fraction(1)) < times else Fraction(1)


def _scaled(expression: Expression, ratio: Fraction) -> tuple[Expression, Expression, Expression]:
    """Return an expression times a number, and the number in front of it before and after."""
    front, above, below = _numbers_in_front(expression)
    before, after = _rational(front), _rational(front * ratio)
    top = product_of([number(-1 if front * ratio < 0 else 1), _joined(abs(front * ratio), above)])
    return (top if below is None else quotient(top, below)), before, after


def _joined(coefficient: Fraction, factors: list[Expression]) -> Expression:
    """Return a product with a positive number in front, written as a fraction rather than a decimal."""
    if coefficient == 1 and factors:
        return product_of(factors)
    return Product((_rational(coefficient), *factors)) if factors else _rational(coefficient)


def _rational(value: Fraction) -> Expression:
    return quotient(number(value.numerator), number(value.denominator))


def _numbers_in_front(expression: Expression) -> tuple[Fraction, list[Expression], Expression | None]:
    """Return the number a formula begins with, the other factors, and what stands below them."""
    front = Fraction(1)
    factors: list[Expression] = []
    below: Expression | None = None
    pending = [expression]
    while pending:
        node = pending.pop()
        match node:
            case Negative(operand):
                front = -front
                pending.append(operand)
            case Number(value):
                front *= value
            case Product(inner):
                pending.extend(reversed(inner))
            case Quotient(Number(n), Number(d)):
                front *= n / d
            case Quotient(above, under) if below is None and not factors and not pending:
                below = under
                pending.append(above)
            case _:
                factors.append(node)
    return front, factors, below


def _both_sums(reading: FormulaReading) -> Iterator[Correction]:
    """Yield sums above and below the bar, both with other coefficients."""
    field, formula = reading.field, reading.formula
    sums = [(p, side) for p, side in _parts(formula.expression) if isinstance(p, Sum)]
    for above in (p for p, side in sums if side == "numerator"):
        for below in (p for p, side in sums if side == "denominator"):
            ratio = reading.printed / reading.value(above) * reading.value(below)
            uppers = [ratio * reading.value(t) for t in above.terms]
            lowers = [reading.derived * reading.value(t) for t in below.terms]
            for i, reference in enumerate(lowers):
                others = [-v for j, v in enumerate(lowers) if j != i]
                solved = solve_linear(field, reference, [*uppers, *others])
                if solved is None:
                    continue
                tops, bottoms = solved[: len(uppers)], list(solved[len(uppers) :])
                bottoms.insert(i, Fraction(1))
                yield _with_sums(reading, (above, tops), (below, tuple(bottoms)))
                break


def _with_sums(
    reading: FormulaReading, upper: tuple[Sum, tuple[Fraction, ...]], lower: tuple[Sum, tuple[Fraction, ...]]
) -> Correction:
    expression, changes, ratio = reading.formula.expression, [], Fraction(1)
    for (part, coefficients), side in ((upper, "numerator"), (lower, "denominator")):
        common = Counter(c for c in coefficients if c).most_common(1)[0][0]
        ratio = ratio * common if side == "numerator" else ratio / common
        terms = []
        for term, coefficient in zip(part.terms, coefficients, strict=True):
            terms.append(_times(coefficient / common, term))
            if coefficient != common:
                changes.append(Change(side, term, terms[-1]))
        expression = _replaced(expression, part, sum_of(terms))
    if ratio != 1:
        expression, before, after = _scaled(expression, ratio)
        changes.insert(0, Change("factor", before, after))
    return Correction(tuple(changes), expression, reading.formula.scale, reading.formula.lines)


def _more_terms(wanted: _Wanted) -> Iterator[Correction]:
    """Yield terms that are not printed."""
    reading, part = wanted.reading, wanted.part
    if not isinstance(part, Sum | Name | Product):
        return
    field = reading.field
    missing = field.reduced(wanted.value - reading.value(part))
    term = monomial_expression(field, missing)
    if term is None and isinstance(part, Sum):
        term = in_symbols(field, missing, symbols_of(reading))
    if term is not None and not (_falls(term) and not _falls(part)):
        printed = part.terms if isinstance(part, Sum) else (part,)
        yield wanted.replaced_by(sum_of([*printed, term]), Change(wanted.place, number(0), term))


def _falls(expression: Expression) -> bool:
    """Return whether s stands below a bar: a term k/s^2 of a polynomial would be a silly repair."""
    return any(
        isinstance(n, Quotient) and any(x == S for x in nodes(n.denominator)) for n in nodes(expression)
    )


def _inverted_ratios(reading: FormulaReading, numbers: Numbers) -> Iterator[Correction]:
    """Yield the formula with a ratio in it turned over, of the smallest part that can be mended so."""
    formula = reading.formula
    parts = list(_parts(formula.expression))[:MOST_PARTS]
    for part, side in sorted(parts, key=lambda p: len(nodes(p[0]))):
        for new in _turned_over(part):
            spend()
            expression = _replaced(formula.expression, part, new)
            if _agrees(replace(numbers, formula=replace(formula, expression=expression))):
                yield Correction((Change(side, part, new),), expression, formula.scale, formula.lines)


def _turned_over(part: Expression) -> Iterator[Expression]:
    """Yield a product with some of its factors on the other side of the bar."""
    if not isinstance(part, Product | Quotient):
        return
    front, powers = powers_of(part)
    if not front:
        return
    ordered = sorted(powers.items(), key=lambda item: isinstance(item[0], Sum))
    fewest = 1 if len(powers) <= MOST_FACTORS else len(powers)
    for count in range(len(powers), fewest - 1, -1):
        for turned, scale in product(combinations(powers, count), dict.fromkeys((front, 1 / front))):
            yield of_powers(scale, {base: -n if base in turned else n for base, n in ordered})


def _exchanged_names(reading: FormulaReading, numbers: Numbers) -> Iterator[Correction]:
    """Yield the formula with two names exchanged, everywhere or in one of its sums."""
    formula = reading.formula
    parts = list(_parts(formula.expression))[:MOST_PARTS]
    for part, side in [p for p in parts if isinstance(p[0], Sum)] + parts[:1]:
        names = dict.fromkeys(n for n in nodes(part) if isinstance(n, Name) and n.name != LAPLACE)
        for one, other in combinations(names, 2):
            new = substitute(part, {one.name: other, other.name: one})
            expression = _replaced(formula.expression, part, new)
            if _agrees(replace(numbers, formula=replace(formula, expression=expression))):
                changes = Change(side, one, other), Change(side, other, one)
                yield Correction(changes, expression, formula.scale, formula.lines)


def _mended_calls(reading: FormulaReading, tf: TransferFunction, numbers: Numbers) -> Iterator[Correction]:
    """Yield slips in the argument of a function, one function too many, and a delay that is left out."""
    formula = reading.formula
    others = [Name(n) for n in (*sorted(formula.parameters), *reading.lines)]
    derived_form = print_form(tf) if any(k.function == "exp" for k in tf.kernels.kernels) else None
    parts = (*nodes(derived_form.num), *nodes(derived_form.den)) if derived_form else ()
    late = dict.fromkeys(n for n in parts if isinstance(n, Call) and n.name == "exp")
    for part, side in list(_parts(formula.expression))[:MOST_PARTS]:
        new: list[Expression] = []
        if isinstance(part, Call):
            scaled = (
                replace(part, argument=argument)
                for argument in _multiples(part.argument)
                # That sign is the one before the function.
                if not (part.name in ODD and argument == negative(part.argument))
            )
            new = [*scaled, *_slips(part, others), number(1)]
        terms = part.terms if isinstance(part, Sum) else (part,) if part is formula.expression else ()
        changes = [(part, n) for n in new]
        changes += [(t, quotient(product_of([_above(t), e]), _below(t))) for t in terms for e in late]
        for old, other in changes:
            expression = _replaced(formula.expression, old, other)
            if _agrees(replace(numbers, formula=replace(formula, expression=expression))):
                yield Correction((Change(side, old, other),), expression, formula.scale, formula.lines)


def _multiples(part: Expression) -> Iterator[Expression]:
    front, powers = powers_of(part)
    yield from (of_powers(front * f, powers) for f in FACTORS)


def _derived_lines(reading: FormulaReading, tf: TransferFunction, numbers: Numbers) -> Iterator[Correction]:
    """Yield a line that is what the derived function has in its own: a wavenumber."""
    derived = {} if tf.is_rational else dict(print_form(tf).where)
    for _ in derived:
        derived = {name: substitute(line, derived) for name, line in derived.items()}
    for i, (name, line) in enumerate(reading.formula.lines):
        for new in derived.values():
            yield from _with_lines(reading, numbers, {i: (name, line, new)})


def _slipped_twice(reading: FormulaReading, numbers: Numbers) -> Iterator[Correction]:
    """Yield two slips in one line, or in two lines."""
    others = [Name(n) for n in sorted(reading.formula.parameters)]

    def slips(line: Expression) -> dict[Expression, None]:
        return dict.fromkeys((*_multiples(line), *_slips(line, others)))

    lines = [(i, *line) for i, line in enumerate(reading.formula.lines) if not _only_renames(line[1])]
    for i, name, line in lines:
        for new in islice(dict.fromkeys(n for one in slips(line) for n in slips(one)), MOST_PAIRS):
            yield from _with_lines(reading, numbers, {i: (name, line, new)})
    for (i, one, first), (j, other, second) in combinations(lines, 2):
        for a, b in product(islice(slips(first), FEW_SLIPS), islice(slips(second), FEW_SLIPS)):
            yield from _with_lines(reading, numbers, {i: (one, first, a), j: (other, second, b)})


def _mended_lines(reading: FormulaReading, numbers: Numbers) -> Iterator[Correction]:
    """Yield slips in a line: what is turned over or exchanged, another name, a sign, a factor."""
    for i, (name, line) in enumerate(reading.formula.lines):
        if _only_renames(line):
            continue
        earlier = (other for other, _ in reading.formula.lines[:i])
        known = reading.formula.parameters | {p.name for p in numbers.bound.source.parameters}
        others = [Name(n) for n in (*sorted(known), *earlier)]
        parts = islice(nodes(line), MOST_PARTS)
        turned = (_replaced(line, part, new) for part in parts for new in _turned_over(part))
        for new in chain(_slips(line, others), turned):
            yield from _with_lines(reading, numbers, {i: (name, line, new)})


def _slips(line: Expression, others: Sequence[Name]) -> Iterator[Expression]:
    """Yield what a line may have been meant to be."""
    inside = [n.argument for n in nodes(line) if isinstance(n, Call)]
    for part in (*inside, line) if isinstance(line, Call) else (line, *inside):
        yield from (_replaced(line, part, new) for new in _other_powers(part))
    named = [n for n in nodes(line) if isinstance(n, Name)]
    for one, other in combinations(dict.fromkeys(named), 2):
        yield substitute(line, {one.name: other, other.name: one})
    yield from (_replaced(line, n, other) for n in named for other in others if other != n)
    for part in nodes(line):
        if isinstance(part, Power):
            yield from (_replaced(line, part, _raised(part.base, n)) for n in LINE_EXPONENTS)
            yield _replaced(line, part, Power(negative(part.base), part.exponent))
            more = (
                p for other in others for p in (product_of([part.base, other]), quotient(part.base, other))
            )
            yield from (_replaced(line, part, Power(base, part.exponent)) for base in more)
        for term in part.terms if isinstance(part, Sum) else ():
            for new in (negative(term), product_of([term, S]), quotient(term, S)):
                yield _replaced(line, part, sum_of([new if t is term else t for t in part.children]))
    yield from (new for other in others for new in (product_of([other, line]), quotient(line, other)))
    yield from (_replaced(line, part, new) for part in (*inside, line) for new in _rooted(part))


def _raised(base: Expression, exponent: Fraction) -> Expression:
    if exponent < 0:
        return quotient(_raised(_below(base), -exponent), _raised(_above(base), -exponent))
    return base if exponent == 1 or is_number(base, 1) else Power(base, _rational(exponent))


def _other_powers(part: Expression) -> Iterator[Expression]:
    """Yield a product turned over, with a factor on the other side or none, and with a root of a side."""
    front, powers = powers_of(part)
    if not front:
        return
    yield of_powers(1 / front, {base: -n for base, n in powers.items()})
    for base, n in powers.items():
        yield of_powers(front, {**powers, base: -n})
        yield of_powers(front, {b: n for b, n in powers.items() if b != base})
    for side in (1, -1):
        inside = product_of([base for base, n in powers.items() if n == side])
        other_powers = {base: n for base, n in powers.items() if n != side}
        yield of_powers(front, {**other_powers, Call("sqrt", inside): side})


def _rooted(part: Expression) -> Iterator[Expression]:
    """Yield a product with some of its factors below a root."""
    front, powers = powers_of(part)
    for count in range(1, len(powers) + 1) if front and len(powers) <= MOST_FACTORS else ():
        for chosen in combinations(powers, count):
            inside = of_powers(Fraction(1), {base: powers[base] for base in chosen})
            others = {base: n for base, n in powers.items() if base not in chosen}
            yield of_powers(front, {**others, Call("sqrt", inside): 1})


def _other_lines(reading: FormulaReading, numbers: Numbers) -> Iterator[Correction]:
    """Yield two lines exchanged, a line times a number, its square or root, a square or 1 left out."""
    lines = [(i, *line) for i, line in enumerate(reading.formula.lines) if not _only_renames(line[1])]
    for (i, one, first), (j, other, second) in combinations(lines, 2):
        yield from _with_lines(reading, numbers, {i: (one, first, second), j: (other, second, first)})
    for i, name, line in lines:
        for new in (*(_times(f, line) for f in FACTORS), Call("sqrt", line), Power(line, number(2))):
            yield from _with_lines(reading, numbers, {i: (name, line, new)})
        for part in nodes(line):
            if isinstance(part, Name):
                squared = _replaced(line, part, Power(part, number(2)))
                yield from _with_lines(reading, numbers, {i: (name, line, squared)})
            factors = part.factors if isinstance(part, Product) else (part,)
            for begin, end in combinations(range(len(factors) + 1), 2):
                more = sum_of([number(1), product_of(factors[begin:end])])
                new = _replaced(line, part, product_of([*factors[:begin], more, *factors[end:]]))
                yield from _with_lines(reading, numbers, {i: (name, line, new)})


def _with_lines(
    reading: FormulaReading, numbers: Numbers, new: Mapping[int, tuple[str, Expression, Expression]]
) -> Iterator[Correction]:
    """Yield the formula with other printed lines where it then has a value of the derived function."""
    spend()
    formula, given = reading.formula, numbers.bound.source.model.definitions
    lines = list(formula.lines)
    for i, (name, old, line) in new.items():
        lines[i] = name, line
        if any((name, old) == (d.name, d.expression) for d in given):
            return
    try:
        is_right = _agrees(replace(numbers, formula=replace(formula, lines=tuple(lines))))
    except KeyError:  # a line would use one that comes later
        return
    if is_right:
        changes = tuple(Change(f"line {name}", old, line) for name, old, line in new.values())
        yield Correction(changes, formula.expression, formula.scale, tuple(lines))


def _agrees(numbers: Numbers) -> bool:
    """Return whether a formula has the derived function's value at a point."""
    both = numbers.both_at(REAL_POINT, FEW_DIGITS)
    return both is not None and bool(both[0].overlaps(both[1]))


def _only_renames(line: Expression) -> bool:
    """Return whether a line is s in other words, such as -s^2 for the square of a frequency, and no slip."""
    return all(n.name == LAPLACE for n in nodes(line) if isinstance(n, Name))


def _replaced(expression: Expression, part: Expression, new: Expression) -> Expression:
    """Return the expression with the very node ``part`` replaced."""
    if expression is part:
        return new
    if not expression.children:
        return expression
    children = [_replaced(c, part, new) for c in expression.children]
    if all(a is b for a, b in zip(children, expression.children, strict=True)):
        return expression
    match expression:
        case Sum():
            return sum_of(children)
        case Product() if isinstance(new, Quotient) and new in children:
            return quotient(product_of(map(_above, children)), product_of(map(_below, children)))
        case Product():
            flat = (f for c in children for f in (c.factors if isinstance(c, Product) else (c,)))
            return product_of(children) if is_number(new, 1) else Product(tuple(flat))
        case Negative():
            inner = children[0]
            return inner.operand if isinstance(inner, Negative) else Negative(inner)
        case Quotient(above, below) if isinstance(children[1], Quotient) and children[1] is not below:
            return quotient(product_of([_below(children[1]), above]), _above(children[1]))
        case Quotient():
            return children[0] if is_number(children[1], 1) else Quotient(children[0], children[1])
        case Power():
            return Power(children[0], children[1])
        case Call(name):
            return Call(name, children[0])
    raise TypeError(f"unexpected expression {type(expression).__name__}")


def _above(expression: Expression) -> Expression:
    return expression.numerator if isinstance(expression, Quotient) else expression


def _below(expression: Expression) -> Expression:
    return expression.denominator if isinstance(expression, Quotient) else number(1)
