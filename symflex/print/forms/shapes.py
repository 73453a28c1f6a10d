"""The shape a person gives a formula: signs, decimals, one function for two, lines that say something.

Input: a form as it is arranged, over whole numbers and with every sum led by its highest power.
Output: the same function as an author would write it:

    -1/(C*R*s*(k^2 - 1) - 1)        1/(C*R*s*(1 - k^2) + 1)     at the declared k = 0.7, or written so
    10/(10*s^2 + 9*s + 10)          1/(s^2 + 0.9*s + 1)         where the model has decimals
    exp(-T_1*s)*exp(-T_2*s)         exp(-(T_1 + T_2)*s)
    sinh(q)/(k*l*gamma*cosh(q))     tanh(q)/(k*q)               where q = gamma*l

Every sum has a sign: that of its highest power of s, at the declared values of the parameters. A negative sum
is turned, and its minus sign travels outwards. A wrong choice here is only ugly, as all prints are read back.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import combinations
from math import gcd
from typing import Final

from flint import acb

from symflex.algebra import LAPLACE
from symflex.expressions import (
    FUNCTIONS,
    Call,
    Expression,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    format_expression,
    is_longer,
    names,
    negative,
    nodes,
    number,
    power,
    product_of,
    quotient,
    substitute,
    sum_of,
)
from symflex.expressions.format import number_text
from symflex.model import Model
from symflex.model.model import IMAGINARY
from symflex.print.forms.arrange import length
from symflex.print.forms.printed import PrintedForm
from symflex.transfer.enclose import enclosure, principal_values

LARGEST: Final = 4000  # parts of a form up to which it is shaped: nobody reads longer ones
FAR: Final = 1e60  # a frequency at which every sum has the sign of its highest power of s
DIGITS: Final = 7  # significant digits of a decimal that reads better than a shorter whole number elsewhere
MOST: Final = 15  # the same where whole numbers have as many
FEW_DOUBLES: Final = 2  # so many longer numbers in a model are printed in full, such as 1/60 as a double
TOO_LONG: Final = 10**30  # a whole number in which nobody looks for numbers as they were typed
LARGE: Final = 10**5  # a whole number from which a polynomial in s reads better with s^n alone in front
MORE: Final = 1.3  # how many times as long a form with decimals may be
SCALED: Final = ("monic", "constant")  # forms that say what a coefficient is divided by
LINE: Final = 4  # characters by which one line in place of two has to be shorter than these
RATIOS: Final = (("sinh", "cosh", "tanh"), ("sin", "cos", "tan"))
OTHERS: Final = {"cosh": "sinh", "cos": "sin"}
ONE: Final = number(1)
S: Final = Name(LAPLACE)
PI: Final = Name("pi")


def shaped(model: Model, form: PrintedForm, signs: SumSigns | None = None) -> PrintedForm:
    """Return a form in the shape a person would give it; one too long to be read as it is."""
    if is_longer(_parts(form), LARGEST):
        return form
    form = _with_plain_lines(form)
    signs = (signs or SumSigns.of(model)).with_decays(form.where)
    made = _signed(form, signs, model)
    if _minus_signs(*_parts(form)):
        # Differences turned by the declared values: as often as not that gives more minus signs.
        turned = _signed(form, signs.turning, model)
        made = min(made, turned, key=lambda f: _minus_signs(*_parts(f)))
    if counted := {Name(p.name) for p in model.parameters if p.cycles == 1}:
        num, den = (rebuilt(e, lambda part: _with_turns(part, counted)) for e in (made.num, made.den))
        made = replace(made, num=num, den=den)
    return made


def _with_turns(part: Expression, counted: Collection[Expression]) -> Expression:
    """Return a product with what is in Hz beside its 2 pi, and 0.8*pi before brackets in them."""
    plain = _in_radians(part, counted)
    if not isinstance(part, Product) or PI not in plain.children:
        return plain
    inside = _pi_inside(part, Fraction(1), 0, counted)
    return plain if inside is None else min(plain, inside, key=_turns_read)


def _turns_read(expression: Expression) -> tuple[int, int]:
    """Return how many pi have another number than 2 before them, and the length."""
    parts = nodes(expression)
    twos = sum(isinstance(n, Product) and n.factors[:2] == (number(2), PI) for n in parts)
    return parts.count(PI) - twos, length(expression)


def _pi_inside(
    part: Expression, scale: Fraction, turns: int, counted: Collection[Expression]
) -> Expression | None:
    """Return a part times a number and a power of pi, none of which is left without what is in Hz."""
    if isinstance(part, Sum):
        terms = [t for t in (_pi_inside(t, scale, turns, counted) for t in part.terms) if t is not None]
        return sum_of(terms) if len(terms) == len(part.terms) else None
    front, powers = powers_of(part)
    front, left = front * scale, powers.pop(PI, 0) + turns
    own = next((powers[b] for b in powers if b in counted and 0 < powers[b] <= left), 0)

    def joined(number_in_front: Fraction, factors: Iterable[Expression]) -> Expression:
        return _in_radians(product_of([number(number_in_front), power(PI, own), *factors]), counted)

    is_short = own == left and _number_in(front, DIGITS) is not None
    tried = [joined(front, (power(b, n) for b, n in powers.items()))] if is_short else []
    for total in [b for b, n in powers.items() if isinstance(b, Sum) and n == 1]:
        inside = _pi_inside(total, abs(front) / 2**own, left - own, counted)
        if inside is not None:
            factors = (inside if b is total else power(b, n) for b, n in powers.items())
            tried.append(joined(Fraction(2**own if front > 0 else -(2**own)), factors))
    return min(tried, key=_turns_read, default=None)


def _in_radians(part: Expression, counted: Collection[Expression]) -> Expression:
    """Return a product with what is in Hz beside its 2 pi: ``2*zeta*(2*pi*f)*s``, ``(2*pi*f)^2``."""
    front, powers = powers_of(part) if isinstance(part, Product) else (Fraction(1), {})
    n = powers.pop(PI, 0)
    found = next((b for b in powers if b in counted and powers[b] == n > 0), None)
    front /= Fraction(2) ** n
    if found is None or front.denominator != 1 or n == abs(front) == 1:
        return part
    turns = Product((number(2), PI, found))
    factors = [
        turns if (b, n) == (found, 1) else power(turns if b == found else b, k) for b, k in powers.items()
    ]
    factors = [*([number(front)] if front != 1 else []), *factors]
    return Product(tuple(factors)) if len(factors) > 1 else factors[0]


def _parts(form: PrintedForm) -> tuple[Expression, ...]:
    return (form.num, form.den, *(e for _, e in form.where))


def _minus_signs(*parts: Expression) -> int:
    return sum(isinstance(n, Negative) for e in parts for n in nodes(e))


def _differ_in_sign(num: Expression, den: Expression) -> bool:
    """Tell whether a sum stands on one side and minus that sum on the other."""
    if not _minus_signs(num, den):
        return False
    above = {_texts(n.terms) for n in nodes(num) if isinstance(n, Sum)}
    below = (n for n in nodes(den) if isinstance(n, Sum))
    return any(_texts([negative(t) for t in n.terms]) in above for n in below)


def _signed(form: PrintedForm, signs: SumSigns, model: Model) -> PrintedForm:
    where = tuple((name, signs.oriented(e)) for name, e in form.where)
    num, den = signs.oriented(form.num), signs.oriented(form.den)
    if _differ_in_sign(num, den):
        # A sum stands below the bar as above it, where that takes no more minus signs.
        alike = (num, signs.like(num).oriented(form.den)), (signs.like(den).oriented(form.num), den)
        num, den = min(*alike, (num, den), key=lambda sides: _minus_signs(*sides))
    num, den = _in_ratios(num, den)
    num, den = (num, den) if form.name in SCALED else _decimals(model, num, den)
    is_negative = isinstance(num, Negative) is not isinstance(den, Negative)
    num, den = (e.operand if isinstance(e, Negative) else e for e in (num, den))
    if is_negative and isinstance(den, Sum) and not _holds_power_of_s(den) and (turned := _difference(den)):
        den, is_negative = turned, False  # 1/(1 - R*exp(-T*s))
    return replace(form, num=signs.absorbed(num) if is_negative else num, den=den, where=where)


def _holds_power_of_s(total: Sum) -> bool:
    """Tell whether s is in a sum outside of functions."""
    return S in names(rebuilt(total, lambda part: ONE if isinstance(part, Call) else part))


@dataclass(frozen=True, eq=False)
class SumSigns:
    """Turns sums, so that they are positive or as the model writes them."""

    known: Mapping[str, acb]
    written: Mapping[frozenset[str], Sum]  # the sums free of s in a model, by the texts of their terms
    typed: Sequence[Sequence[Expression]] = ()  # the names of products in a model, in their order
    lines: frozenset[str] = frozenset()  # names that where lines explain, as arguments of functions of s
    turns: bool = False  # differences of parameters are turned by their values, too

    @staticmethod
    def of(model: Model) -> SumSigns:
        """Return what turns the sums of formulas of a model."""
        values = {p.name: acb(enclosure(p.value)()) for p in model.parameters if p.value is not None}
        values |= {LAPLACE: acb(FAR), "pi": acb.pi()}
        for d in model.definitions:
            if {n.name for n in names(d.expression)} <= {*values, *FUNCTIONS}:
                (values[d.name],) = principal_values(d.expression, 1, lambda name: [values[name]])
        parts = [n for _, e in model.expressions() for n in nodes(e)]
        sums = (n for n in parts if isinstance(n, Sum) and S not in names(n))
        fixed = (S, Name("pi"), Name(IMAGINARY))
        products = (map(_base, n.factors) for n in parts if isinstance(n, Product))
        typed = dict.fromkeys(tuple(b for b in bases if b not in fixed) for bases in products)
        return SumSigns(values, {_texts(n.terms): n for n in sums}, sorted(typed, key=len))

    def with_decays(self, where: Sequence[tuple[str, Expression]]) -> SumSigns:
        """Return these with what decays by the where lines, as ``exp(-gamma*l)``: it is zero far away."""
        if not where:
            return self
        values = dict(self.known)
        for name, line in reversed(where):
            if {n.name for n in names(line)} <= {*values, *FUNCTIONS}:
                (values[name],) = principal_values(line, 1, lambda name: [values[name]])
        decays = {name: acb(0) for name, _ in where if name in values and abs(values[name]) < 1 / FAR}
        return replace(self, known={**self.known, **decays}, lines=frozenset(name for name, _ in where))

    def like(self, other: Expression) -> SumSigns:
        """Return these with the sums of another expression as they are written there."""
        sums = {_texts(n.terms): n for n in nodes(other) if isinstance(n, Sum)}
        return replace(self, written={**sums, **self.written})

    def oriented(self, expression: Expression) -> Expression:
        """Return an expression with every sum in it as a person would write it."""
        return rebuilt(expression, self._oriented, self._turned)

    @cached_property
    def _turned(self) -> dict[Expression, Expression]:
        """The sums that were written so."""
        return {}

    @cached_property
    def turning(self) -> SumSigns:
        """The same, but differences of parameters are turned by their values, too."""
        return replace(self, turns=True)

    def _oriented(self, part: Expression) -> Expression:
        match part:
            case Sum(terms):
                # Closed sums side by side may share a term: (c*s + k_1) + (c*s + k_2).
                merged = sum_of(product_of([number(n), t]) for t, n in Counter(terms).items())
                return self._sum(merged.terms) if isinstance(merged, Sum) else merged
            case Negative(Product() as product):
                return negative(self._oriented(product))
            case Product(factors):
                joined = _joined(factors)
                if any(map(_is_decay, joined)):
                    # Behind plain factors, before functions, above as below the bar.
                    joined = sorted(
                        joined, key=lambda f: (any(isinstance(n, Call) for n in nodes(f)), not _is_decay(f))
                    )
                return self._rejoined(product_of(self._as_typed(joined)))
            case Call("exp", argument) if any(isinstance(n, Product) for n in nodes(argument)):
                return replace(part, argument=min(argument, of_powers(*powers_of(argument)), key=length))
            case Call("sqrt", Negative(Sum(terms))):
                return replace(part, argument=sum_of(_led([negative(t) for t in terms])))
        return part

    def _as_typed(self, factors: Sequence[Expression]) -> Sequence[Expression]:
        """Return factors in the order in which the model multiplies them: ``m*g*l``, ``2*zeta*omega``."""
        bases = {base for f in factors if isinstance(base := _base(f), Name)}
        for product in self.typed:
            if len(bases.intersection(product)) > 1:
                own = [f for f in factors if _base(f) in bases and _base(f) in product]
                ordered = iter(sorted(own, key=lambda f: product.index(_base(f))))
                factors = [next(ordered) if f in own else f for f in factors]
        return factors

    def _rejoined(self, product: Expression) -> Expression:
        """Return a product with ``1 - nu^2`` for ``(1 - nu)*(nu + 1)`` where the model has it."""
        factors = product.factors if isinstance(product, Product) else ()
        for one, other in combinations([f for f in factors if isinstance(f, Sum)], 2):
            same = [t for t in one.terms if t in other.terms]
            turned = [t for t in one.terms if negative(t) in other.terms]
            if (len(one.terms), len(other.terms), len(same), len(turned)) != (2, 2, 1, 1):
                continue
            first, second = (of_powers(*powers_of(product_of([t, t]))) for t in (*same, *turned))
            joined = self._sum((first, negative(second)))
            again = self._rejoined(product_of([joined if f is one else f for f in factors if f is not other]))
            if any(self.written.get(_texts(f.terms)) is f for f in nodes(again) if isinstance(f, Sum)):
                return again
        return product

    def _sum(self, terms: Sequence[Expression]) -> Expression:
        """Return a sum as it is written in the model, or turned if it is negative."""
        terms = _without_ones(terms)
        if len(terms) == 1:
            return terms[0]
        turned = [negative(t) for t in terms]
        first = terms[0]
        if (
            isinstance(first, Call)
            and first.name == "cosh"
            and (*terms[1:],) == (replace(first, name="sinh"),)
        ):
            return replace(first, name="exp")
        if (as_written := self.written.get(_texts(terms))) is not None:
            return as_written
        if (as_written := self.written.get(_texts(turned))) is not None:
            return Negative(as_written)
        below, whole = 2 * sum(isinstance(t, Negative) for t in terms), Sum(tuple(terms))
        has_number = any(isinstance(t, Number) for t in (*terms, *turned))
        has_s = _holds_power_of_s(whole)
        may_turn = below > len(terms) and (has_s or not has_number)
        may_turn |= not has_s and below == len(terms) and (self.turns or has_number)
        sign = self._sign(whole) if may_turn else 0
        # Where no sign is known, fewer minus signs.
        is_negative = sign < 0 if sign else below > len(terms) if may_turn else below == 2 * len(terms)
        ordered = map(self._added, _led(self._gathered(turned if is_negative else terms)))
        total = sum_of(_real_first([*ordered]))
        return negative(total) if is_negative else total

    def _added(self, term: Expression) -> Expression:
        """Return ``R*C*(3 - A)*s`` for ``-R*C*(A - 3)*s``, where the sign of the difference is not known."""
        for total in [f for f in nodes(term) if isinstance(term, Negative) and isinstance(f, Sum)]:
            if self._sign(total) or self.written.get(_texts(total.terms)) is total:
                return term
        return _turned(term.operand) or term if isinstance(term, Negative) else term

    def _gathered(self, terms: Sequence[Expression]) -> Sequence[Expression]:
        """Return terms with powers of s side by side: ``s^2 + 6*s + 5 + K*(s + 1)``."""
        powers = [i for i, t in enumerate(terms) if not any(map(self._holds_s, nodes(t)))]
        if not any(S in names(terms[i]) for i in powers):
            return terms
        held = [t for i, t in enumerate(terms[: powers[-1]]) if i not in powers and i > powers[0]]
        return [*terms[: powers[0]], *(terms[i] for i in powers), *held, *terms[powers[-1] + 1 :]]

    def _holds_s(self, part: Expression) -> bool:
        """Tell whether a part is a sum or a root with s, or a function of what is no constant."""
        if isinstance(part, Sum) or (isinstance(part, Call) and part.name == "sqrt"):
            return S in names(part)
        if not isinstance(part, Call):
            return False
        return part.name not in FUNCTIONS or any(n == S or n.name in self.lines for n in names(part.argument))

    def absorbed(self, num: Expression) -> Expression:
        """Return minus a numerator, the sign within a sum that ends with a negative term if there is one."""
        factors = list(num.factors) if isinstance(num, Product) else [num]
        if (turned := _turned(num)) is not None:
            return turned
        for i, factor in enumerate(factors):
            if isinstance(factor, Sum) and isinstance(factor.terms[-1], Negative):
                if len(factor.terms) == 2 or self._sign(factor):  # noqa: PLR2004
                    factors[i] = sum_of(_led([negative(t) for t in factor.terms]))
                    return product_of(factors)
        return negative(num)

    def _sign(self, expression: Expression) -> int:
        """Return the sign for large s, where what decays is zero; 0 if it is not known."""
        try:
            (value,) = principal_values(expression, 1, lambda name: [self.known[name]])
        except KeyError:
            return 0
        return int(value.real > 0) - int(value.real < 0)


def _is_negative_number(term: Expression) -> bool:
    return isinstance(term, Negative) and isinstance(term.operand, Number)


def _without_ones(terms: Sequence[Expression]) -> Sequence[Expression]:
    """Return terms with ``sinh(q)^2`` for ``cosh(q)^2 - 1``, and ``-sin(q)^2`` for ``cos(q)^2 - 1``."""
    for term in terms if any(isinstance(t, Number) or _is_negative_number(t) for t in terms) else ():
        front, powers = powers_of(term)
        (call, n), *more = powers.items() if powers else ((ONE, 0),)
        one = number(-front)
        if more or n != 2 or not isinstance(call, Call) or call.name not in OTHERS or one not in terms:  # noqa: PLR2004 (a square)
            continue
        square = power(replace(call, name=OTHERS[call.name]), 2)
        joined = product_of([number(front if call.name == "cosh" else -front), square])
        return _without_ones([joined if t is term else t for t in terms if t != one])
    return terms


def _base(factor: Expression) -> Expression:
    return factor.base if isinstance(factor, Power) else factor


def _texts(terms: Iterable[Expression]) -> frozenset[str]:
    return frozenset(map(format_expression, terms))


def _turned(expression: Expression) -> Expression | None:
    """Return minus an expression if that has no minus sign in front of it or of a term, else nothing."""
    match expression:
        case Negative(operand):
            return operand
        case Product(factors):
            for i, factor in enumerate(factors):
                if isinstance(factor, Sum) and (turned := _difference(factor)) is not None:
                    return product_of([*factors[:i], turned, *factors[i + 1 :]])
        case Sum():
            return _difference(expression)
    return None


def _difference(total: Sum) -> Expression | None:
    """Return minus a sum, whose terms are all turned themselves or one of two; nothing where that fails."""
    turned = [_turned(t) for t in total.terms]
    if None not in turned:
        return sum_of([t for t in turned if t])
    if len(turned) == 2 and turned[0] is None and turned[1] is not None:  # noqa: PLR2004
        return sum_of([turned[1], negative(total.terms[0])])
    return None


def _real_first(terms: Sequence[Expression]) -> Sequence[Expression]:
    """Return terms whose part without s adds before it subtracts: ``s + 1 - K``, ``999 + 70*j``."""
    places = [i for i, t in enumerate(terms) if not any(n == S or isinstance(n, Call) for n in nodes(t))]
    own = [terms[i] for i in places]
    if len({frozenset(names(t)) for t in own}) == len(own):  # powers of one symbol keep falling
        own.sort(key=lambda t: (isinstance(t, Negative), Name(IMAGINARY) in names(t)))
    put = dict(zip(places, own, strict=True))
    return [put.get(i, t) for i, t in enumerate(terms)]


def _led(terms: Sequence[Expression]) -> list[Expression]:
    """Return terms with a positive one in front, if there is one."""
    first = next((i for i, t in enumerate(terms) if not isinstance(t, Negative)), 0)
    return [terms[first], *terms[:first], *terms[first + 1 :]]


def powers_of(expression: Expression) -> tuple[Fraction, dict[Expression, int]]:
    """Return a product as a number times powers; a root that is squared is gone."""
    front, powers = Fraction(1), dict[Expression, int]()
    pending: list[tuple[Expression, int]] = [(expression, 1)]
    while pending:
        match pending.pop():
            case Number(value), n if value or n > 0:
                front *= value**n
            case Negative(operand), n:
                front *= (-1) ** abs(n)
                pending.append((operand, n))
            case Product(factors), n:
                pending += [(f, n) for f in reversed(factors)]
            case Quotient(above, below), n:
                pending += [(below, -n), (above, n)]
            case Power(base, Number(exponent)), n if exponent.denominator == 1:
                pending.append((base, n * int(exponent)))
            case base, n:
                powers[base] = powers.get(base, 0) + n
                if isinstance(base, Call) and base.name == "sqrt" and abs(powers[base]) > 1:
                    half = int(powers[base] / 2)
                    powers[base] -= 2 * half
                    pending.append((base.argument, half))
    return front, {base: n for base, n in powers.items() if n}


def of_powers(front: Fraction, powers: Mapping[Expression, int]) -> Expression:
    """Return a number times powers as one fraction."""
    above = [power(base, n) for base, n in powers.items() if n > 0]
    below = [power(base, -n) for base, n in powers.items() if n < 0]
    top = product_of([number(front.numerator), *above])
    return quotient(top, product_of([number(front.denominator), *below]))


def _joined(factors: Sequence[Expression]) -> Sequence[Expression]:
    """Return factors with ``exp(-(T_1 + T_2)*s)`` for several exponentials, and no squares of roots."""
    bases = [_base(f) for f in factors]
    is_squared = any(
        isinstance(f, Power) and isinstance(f.base, Call) and f.base.name == "sqrt" for f in factors
    )
    if is_squared or len({*bases}) < len(bases):
        factors = (of_powers(*powers_of(product_of(factors))),)
    decays = [f for f in factors if isinstance(f, Call) and _is_decay(f)]
    times = [powers_of(f.argument) for f in decays]
    if len(decays) < 2:  # noqa: PLR2004
        return factors
    if all(front < 0 and powers.get(S) == 1 for front, powers in times):
        for _, powers in times:
            del powers[S]
        numbers = number(-sum((front for front, powers in times if not powers), start=Fraction(0)))
        total = sum_of([*(of_powers(-front, powers) for front, powers in times if powers), numbers])
        merged: list[Expression] = [Call("exp", negative(product_of([total, S])))]
    else:  # those of one wave, which cancel where they travel opposite ways
        fronts: dict[frozenset[tuple[Expression, int]], Fraction] = {}
        for front, powers in times:
            wave = frozenset(powers.items())
            fronts[wave] = fronts.get(wave, Fraction(0)) + front
        if len(fronts) == len(decays):
            return factors
        alike = {frozenset(powers.items()): powers for _, powers in times}
        merged = [Call("exp", of_powers(x, alike[wave])) for wave, x in fronts.items() if x]
    first = factors.index(decays[0])
    return [*factors[:first], *merged, *(f for f in factors[first:] if f not in decays)]


def _is_decay(factor: Expression) -> bool:
    return isinstance(factor, Call) and factor.name == "exp"


def _in_ratios(num: Expression, den: Expression) -> tuple[Expression, Expression]:
    """Return a fraction with ``tanh`` and ``tan`` for what they are quotients of."""
    (front, powers), (below, divisors) = powers_of(num), powers_of(den)
    sides = [dict(powers), dict(divisors)]
    for one, other, ratio in RATIOS:
        for call in [c for c in (*powers, *divisors) if isinstance(c, Call) and c.name == one]:
            for above, under in (sides, sides[::-1]):
                n, cofactor = above.get(call, 0), replace(call, name=other)
                if n and n == under.get(cofactor, 0):
                    above[replace(call, name=ratio)] = n
                    del above[call], under[cofactor]
        for above, under in (sides, sides[::-1]):
            for call in [c for c, n in above.items() if isinstance(c, Call) and (c.name, n) == (other, 1)]:
                sums = [b for b in under if isinstance(b, Sum) and call in nodes(b)]
                made = _over(sums[0], call, one, ratio) if len(sums) == 1 and under[sums[0]] == 1 else None
                if made is not None:
                    del above[call], under[sums[0]]
                    under[made[1]] = 1
                    front, below = (front, below * made[0]) if under is sides[1] else (front * made[0], below)
    for call in [c for c in sides[1] if isinstance(c, Call) and c.name == "exp"]:
        if isinstance(call.argument, Name):  # exp(q), which stood as cosh(q) + sinh(q)
            sides[0][Call("exp", negative(call.argument))] = sides[1].pop(call)
    if not front or sides == [powers, divisors]:
        return num, den
    front /= below
    return of_powers(Fraction(front.numerator), sides[0]), of_powers(Fraction(front.denominator), sides[1])


def _over(total: Sum, call: Call, one: str, ratio: str) -> tuple[int, Expression] | None:
    """Return n and ``a + b*tanh(q)`` for ``n*(a*cosh(q) + b*sinh(q))``, None for other sums."""
    terms = [powers_of(t) for t in total.terms]
    whole = gcd(*(x.numerator for x, _ in terms)) if all(x.denominator == 1 for x, _ in terms) else 1
    other = replace(call, name=one)
    for _, powers in terms:
        degrees = powers.pop(call, 0), powers.pop(other, 0)
        if sum(degrees) != 1 or 1 not in degrees or any(n in (call, other) for b in powers for n in nodes(b)):
            return None
        powers.update({replace(call, name=ratio): 1} if degrees[1] else {})
    return whole, sum_of([of_powers(x / whole, p) for x, p in terms])


def rebuilt(
    expression: Expression,
    change: Callable[[Expression], Expression],
    known: dict[Expression, Expression] | None = None,
) -> Expression:
    """Return an expression made anew from its parts, so that numbers are multiplied, each changed.

    What becomes of sums may be known, and is added to that.
    """
    sums: dict[Expression, Expression] = {} if known is None else known

    def again(part: Expression) -> Expression:
        match part:
            case Sum(terms):
                if part not in sums:
                    sums[part] = change(sum_of(map(again, terms)))
                return sums[part]
            case Product(factors):
                return change(product_of(map(again, factors)))
            case Negative(operand):
                return negative(again(operand))
            case Quotient(above, below):
                return quotient(again(above), again(below))
            case Power(base, exponent):
                return power(again(base), exponent)
            case Call(_, argument):
                return change(replace(part, argument=again(argument)))
        return part

    return again(expression)


def plain(expression: Expression, put: Mapping[str, Expression]) -> Expression:
    """Return an expression with others for some names, made anew so that no factor 1 is left."""
    return rebuilt(substitute(expression, put), lambda part: part)


def _with_plain_lines(form: PrintedForm) -> PrintedForm:
    """Return a form whose lines all say something, in lowest terms, and whose lengths are used."""
    laws = {n.name for _, law in (*form.laws, *form.closed) for n in names(law)}
    for name, _ in form.where:
        lines = dict(form.where)
        line = lines.get(name)
        if line is None:
            continue
        waves = [n.name for n in names(line) if isinstance(n, Name) and n.name in lines]
        if laws & {name, *waves}:
            continue
        if isinstance(line, Number) or (waves and line == Name(waves[0])):
            old, new = (name, line) if isinstance(line, Number) else (waves[0], Name(name))
            lines[name] = lines.pop(old) if old != name else line
            put = {old: new}
            where = tuple((n, plain(e, put)) for n, e in lines.items() if n != old)
            form = replace(form, num=plain(form.num, put), den=plain(form.den, put), where=where)
        elif len(waves) == 1 and powers_of(line)[1].get(Name(waves[0])) == 1:
            form = _through_argument(form, name, Name(waves[0]))
    return form


def _through_argument(form: PrintedForm, argument: str, wave: Name) -> PrintedForm:
    """Return a form with ``q`` for ``gamma*l`` in products, without a line for ``gamma`` if it can go."""
    lines = dict(form.where)
    own = lines[wave.name]
    front, powers = powers_of(lines[argument])

    def through(part: Expression) -> Expression:
        scale, factors = powers_of(part)
        times = min(factors.get(base, 0) // n if n > 0 else 0 for base, n in powers.items())
        if isinstance(part, Sum | Call) or times < 1:
            return part
        placed: dict[Expression, int] = {}
        for base, n in factors.items():
            placed |= {Name(argument): times} if base == wave else {}
            placed[base] = n - times * powers.get(base, 0)
        return of_powers(scale / front**times, {base: n for base, n in placed.items() if n})

    num, den = (rebuilt(e, through) if len(powers) > 1 else e for e in (form.num, form.den))
    scale, factors = powers_of(quotient(num, den))
    is_apart = wave in factors and not any(wave in names(base) for base in factors if base != wave)
    if is_apart and not any(isinstance(n, Call) for n in nodes(own)):
        # A wavenumber without a root is no shorter than what it is.
        whole = of_powers(*powers_of(plain(of_powers(scale, factors), {wave.name: own})))
        num, den = (whole.numerator, whole.denominator) if isinstance(whole, Quotient) else (whole, number(1))
    scale, factors = powers_of(substitute(lines[argument], {wave.name: own}))
    ordered = sorted(factors, key=lambda base: (base != S, isinstance(base, Call)))
    line = of_powers(scale, {base: factors[base] for base in ordered})
    others = [num, den, *(e for name, e in lines.items() if name != argument)]
    is_fourth_root = isinstance(own, Call) and isinstance(own.argument, Call)
    is_shorter = length(line) + LINE <= length(lines[argument], own) and not is_fourth_root
    if is_shorter and not any(wave in names(e) for e in others):
        lines[argument] = line
        del lines[wave.name]
    return replace(form, num=num, den=den, where=tuple(lines.items()))


def _decimals(model: Model, num: Expression, den: Expression) -> tuple[Expression, Expression]:
    """Return a fraction of polynomials with decimals as the model has them, or as it is."""
    written = [n.value for _, e in model.expressions() for n in nodes(e) if isinstance(n, Number)]
    calls = (n for e in (num, den) for n in nodes(e) if isinstance(n, Call))
    if all(x.denominator == 1 for x in written) or any(n.name not in ("exp", "sqrt") for n in calls):
        return num, den
    wanted = {*written, Fraction(1)}
    typed = {
        _in_powers(map(powers_of, n.terms))
        for _, e in model.expressions()
        for n in nodes(e)
        if isinstance(n, Sum)
    }
    numbers = [n.value.numerator for e in (num, den) for n in nodes(e) if isinstance(n, Number)]
    longest = max((len(str(n).strip("-0")) for n in numbers), default=0)
    doubles = [n for n in map(_digits_of, {*written}) if n > MOST]
    digits = min(max(DIGITS, longest + 1), max(doubles) if 0 < len(doubles) <= FEW_DOUBLES else MOST)

    def led_by_s(part: Expression) -> Expression:
        if not isinstance(part, Sum):
            return part
        fronts = [powers_of(term)[0] for term in part.terms]
        if powers_of(part.terms[0])[1].keys() == {S}:
            divisor = _typed_scale(part, wanted, typed)
        else:  # what several parts were divided by goes on to the front
            are_whole = all(x.denominator == 1 for x in fronts)
            divisor = Fraction(gcd(*map(int, fronts)) if are_whole else 1)
        scaled = None if divisor == 1 else _scaled(part, divisor, digits)
        return part if scaled is None else product_of([number(divisor), scaled])

    (above, powers), (below, divisors) = (powers_of(rebuilt(e, led_by_s)) for e in (num, den))
    scale = above / below
    for parts, side in ((divisors, -1), (powers, 1)):
        for part in [p for p in parts if isinstance(p, Sum)]:
            divisor = _typed_scale(part, wanted, typed)
            if divisor != 1 and (scaled := _scaled(part, divisor, digits)) is not None:
                scale *= divisor ** (parts[part] * side)
                ordered = [(scaled if base == part else base, n) for base, n in parts.items()]
                parts.clear()
                for base, n in ordered:
                    parts[base] = parts.get(base, 0) + n
    if (own := _number_in(scale, digits)) is None:
        return num, den
    tried = [product_of([own, *(power(b, n) for b, n in powers.items())])]
    sums = [b for b, n in powers.items() if isinstance(b, Sum) and n == 1 and Name(IMAGINARY) not in names(b)]
    # A resonance, s^2 + 2*zeta*omega*s + omega^2, keeps its s^2, and 4*K_0^2 - 1 its whole numbers.
    inside = next((b for b in sums if powers_of(b.terms[0])[1].keys() != {S} or {*names(b)} == {S}), None)
    fronts = [scale, *(powers_of(t)[0] for t in inside.terms)] if inside is not None else []
    stays = scale == 1 or len(sums) > 1 or all(x.denominator == 1 for x in fronts)  # as 6*(3*T*s + 1)
    spread = None if inside is None or stays else _scaled(inside, 1 / abs(scale), digits)
    if inside is not None and spread is not None and ({*names(inside)} == {S} or len({*names(inside)}) > 1):
        whole = product_of([spread if b == inside else power(b, n) for b, n in powers.items()])
        tried.append(negative(whole) if scale < 0 else whole)
    new = min(tried, key=length), product_of([power(b, n) for b, n in divisors.items()])
    return new if length(*new) <= MORE * length(num, den) else (num, den)


_Powers = frozenset[tuple[Fraction, frozenset[tuple[Expression, int]]]]


def _in_powers(terms: Iterable[tuple[Fraction, Mapping[Expression, int]]]) -> _Powers:
    """Return the terms of a sum, however their numbers and squares are written."""
    return frozenset((front, frozenset(powers.items())) for front, powers in terms)


def _typed_scale(total: Sum, wanted: set[Fraction], typed: set[_Powers]) -> Fraction:
    """Return the number that divides a sum to be typed, have the numbers wanted, or ``s^n`` in front."""
    parts = [powers_of(t) for t in total.terms]
    fronts = [abs(f) for f, _ in parts]
    is_monic = powers_of(total.terms[0])[1].keys() == {S}
    are_whole = all(f.denominator == 1 for f in fronts)
    holds_sums = any(isinstance(base, Sum) for t in total.terms for base in powers_of(t)[1])
    # Nobody types numbers as long as those of large matrices become, nor looks for theirs in them.
    few = wanted if max(fronts) < TOO_LONG else {Fraction(1)}
    tried = dict.fromkeys([Fraction(1), fronts[0], *(f / w for f in fronts for w in few if w)])
    has_symbols = {*names(total)} != {S}

    def rank(divisor: Fraction) -> tuple[bool | int, ...]:
        divided = [f / divisor for f in fronts]
        is_whole, is_wanted = [x.denominator == 1 for x in divided], [x in wanted for x in divided]
        is_typed = all(is_wanted)
        # Whole numbers stay in a sum of longer parts, and where its first would be as odd as 2.5*m.
        is_odd = not (is_whole[0] or is_wanted[0]) or (fronts[0] == 1 and (holds_sums or not is_typed))
        is_large = not has_symbols and (fronts[0] == 1 or max(fronts) >= LARGE)
        is_large = is_large and not any("/" in number_text(x) for x in divided)
        as_usual = is_monic and divided[0] == 1 and (is_large or sum(is_whole) >= len(divided) - 1)
        return (
            _in_powers((f / divisor, p) for f, p in parts) in typed,
            is_typed and (divisor == 1 or not has_symbols),
            as_usual,
            has_symbols and len({*names(total)}) == 1 and all(is_whole),  # as 16*K_0^4 - 20*K_0^2 + 5
            0 if are_whole and divisor != 1 and is_odd else sum(is_wanted),
            is_whole[0],
            sum(is_whole),
            not has_symbols and divided[-1] == 1,
        )

    return max(tried, key=rank)


def _scaled(total: Sum, divisor: Fraction, digits: int) -> Expression | None:
    """Return a sum divided by a number, None if that has no short decimals."""
    terms = []
    for term in total.terms:
        front, powers = powers_of(term)
        inner = next((b for b, n in powers.items() if isinstance(b, Sum) and n == 1), None)
        within = None if inner is None or abs(front) != 1 else _scaled(inner, divisor, digits)
        own = number(front) if within is not None else _number_in(front / divisor, digits)
        if own is None:
            return None
        raised = (power(within if within is not None and b is inner else b, n) for b, n in powers.items())
        terms.append(product_of([own, *raised]))
    return sum_of(terms)


def _number_in(value: Fraction, digits: int) -> Expression | None:
    """Return a number that is a whole one or a short decimal, None otherwise."""
    is_short = value.denominator == 1 or 0 < _digits_of(value) <= digits
    return number(value) if is_short else None


def _digits_of(value: Fraction) -> int:
    """Return how many significant digits the decimal of a number has; 0 for a quotient."""
    text = number_text(abs(value))
    return 0 if "/" in text else len(text.strip("0.").replace(".", ""))
