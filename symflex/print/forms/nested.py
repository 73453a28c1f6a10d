"""The nested form: a short quotient, and the sub-impedances it is made of, one line each.

Input: a :class:`symflex.transfer.NestedTransferFunction`.
Output: a :class:`PrintedForm` whose ``where`` lines use only those before them. What occurs once stands where
it is used; what occurs more often, and what would be long or deep, has a name. Fundamental functions of
beams, rods and shafts are ``h(l)``, ``h'(l)``, one h for all that have the same differential equation, its
law.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import count
from typing import TYPE_CHECKING

from symflex.algebra import LAPLACE
from symflex.algebra.straight_line import ZERO, Step
from symflex.budget import spend
from symflex.expressions import (
    Call,
    Derivative,
    Equation,
    Expression,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    nodes,
    number,
    power,
    product_of,
    quotient,
    substitute,
    sum_of,
)
from symflex.print.forms.arrange import length, power_of_s
from symflex.print.forms.definitions import tidied_sum
from symflex.print.forms.naming import Naming, names_of
from symflex.print.forms.notation import reachable
from symflex.print.forms.printed import PrintedForm
from symflex.print.forms.shapes import of_powers, powers_of
from symflex.transfer import NestedTransferFunction

if TYPE_CHECKING:
    from symflex.equations.elimination.star_mesh import Waves

DEEPEST = 8  # levels of an expression from which it gets a name
LONGEST_PRODUCT = 24  # factors beyond which a product is continued in a line of its own
SHORT = 3  # factors up to which a product of parameters is written out wherever it occurs
LONGEST_SUM = 100  # terms beyond which a sum is
BAR = 20  # characters that a fraction within a side may save, and of a product used once without a line
STEMS = {Step.ADD: "S", Step.MULTIPLY: "P", Step.DIVIDE: "T", Step.POWER: "P"}
"""Names of shared sums, products and quotients; ``w`` and ``Z`` are what the elimination calls so."""


def nested_form(tf: NestedTransferFunction) -> PrintedForm:
    """Return a nested transfer function for print."""
    return _Printer(tf, step_names(tf)).form()


def step_names(tf: NestedTransferFunction) -> dict[int, str]:
    """Return the names of the steps that have one in the nested form, in order."""
    program = tf.program
    kinds, roles = program.kinds, program.roles
    uses: dict[int, int] = {}
    for i in tf.steps:
        for x in program.inner(i):
            uses[x] = uses.get(x, 0) + 1
    ends = {tf.num, tf.den}
    names: dict[int, str] = {}
    fresh = _fresh_names(tf)
    depth: dict[int, int] = {}
    length: dict[int, int] = {}
    for i in tf.steps:
        kind = kinds[i]
        inner = program.inner(i)
        depth[i] = 1 + max((depth[x] for x in inner), default=-1)
        length[i] = sum(length[x] for x in inner) if kind in (Step.MULTIPLY, Step.DIVIDE) else 1
        if kind in (Step.GENERATOR, Step.NUMBER, Step.NEGATE):
            continue
        role = roles.get(i, "")
        is_monomial = role != "Z" and _is_monomial(tf, i)
        # What one is divided by has a name already.
        is_inverse = kind == Step.DIVIDE and kinds[inner[0]] == Step.NUMBER and inner[1] in names
        is_shared = uses.get(i, 0) + (i in ends) > 1 and not (is_monomial or is_inverse)
        is_long = depth[i] >= DEEPEST or length[i] >= LONGEST_PRODUCT
        if role.startswith("=") or is_shared or (is_long and i not in ends):
            names[i] = role[1:] if role.startswith("=") else next(fresh[role or STEMS[Step(kind)]])
            depth[i], length[i] = 0, 1
    return names


def _is_monomial(tf: NestedTransferFunction, i: int) -> bool:
    """Tell whether a step is a short product of powers of generators, which needs no name."""
    kinds, operands = tf.program.kinds, tf.program.operands
    if kinds[i] == Step.POWER:
        return kinds[operands[i][0]] == Step.GENERATOR
    if kinds[i] == Step.DIVIDE:  # 1/R, and no quotient of functions
        leaves = [x for x in operands[i] if kinds[x] in (Step.GENERATOR, Step.NUMBER)]
        is_plain = not any(kinds[x] == Step.GENERATOR and operands[x][0] in tf.wave_of for x in leaves)
        return is_plain and all(x in leaves or _is_monomial(tf, x) for x in operands[i])
    if kinds[i] != Step.MULTIPLY or len(operands[i]) > SHORT:
        return False
    return all(
        kinds[x] in (Step.GENERATOR, Step.NUMBER)
        or (kinds[x] == Step.POWER and kinds[operands[x][0]] == Step.GENERATOR)
        for x in operands[i]
    )


def _fresh_names(tf: NestedTransferFunction) -> dict[str, Iterator[str]]:
    taken = names_of(tf.model) | tf.generators | {name for name, _ in _laws(tf).values()}

    def numbered(stem: str) -> Iterator[str]:
        return (name for n in count(1) if (name := f"{stem}_{n}") not in taken)

    return {stem: numbered(stem) for stem in ("w", "Z", *dict.fromkeys(STEMS.values()))}


def _laws(tf: NestedTransferFunction) -> dict[tuple[int, ...], tuple[str, Waves]]:
    """Return, by the coefficients of a differential equation, what its solution is called, and a user."""
    users = {w.coefficients: w for w in reversed(tf.waves) if w.coefficients}
    ordered = [users[c] for c in dict.fromkeys(w.coefficients for w in tf.waves if w.coefficients)]
    names_of_laws = Naming(names_of(tf.model) | tf.generators).take("h", len(ordered))
    return {w.coefficients: (name, w) for name, w in zip(names_of_laws, ordered, strict=True)}


@dataclass
class _Printer:
    """Turns steps into expressions, earlier ones first."""

    tf: NestedTransferFunction
    names: dict[int, str]
    lines: list[tuple[str, Expression]] = field(default_factory=list)
    known: dict[int, Expression] = field(default_factory=dict)
    split: dict[int, tuple[tuple[Expression, ...], tuple[Expression, ...]]] = field(default_factory=dict)
    """Products and quotients that have no name: their factors above and below the bar."""

    def form(self) -> PrintedForm:
        tf = self.tf
        self.symbols = {c.generator: c.expression for c in tf.constants}
        names = sorted(tf.program.names, key=lambda name: not name.startswith("zeta"))  # 2*zeta*omega_n*s
        self.order = {name: n for n, name in enumerate(names)}
        self.order |= {"pi": -1, LAPLACE: len(self.order)}
        self.sums = 0
        self.functions = _laws(tf)
        for i in tf.steps:
            spend()
            expression = self._made(i)
            name = self.names.get(i)
            if name is not None:
                self.order.setdefault(name, len(self.order) + 1)
                self.lines.append((name, expression))
                expression = Name(name)
                self.split.pop(i, None)
            self.known[i] = expression
        num, den = self.known[tf.num], self.known[tf.den]
        laws = tuple(map(self._law, self.functions.values()))
        equations, where, own = [law for _, law in laws], tuple(self.lines), names_of(tf.model)
        for _ in range(2):  # what cancels may leave one name
            where = reachable((num, den, *equations), where)
            lines = dict(where)
            parts = (num, den, *lines.values(), *equations)
            used = Counter(n for e in parts for n in nodes(e) if isinstance(n, Name))
            num, den = (
                lines.get(e.name, e) if isinstance(e, Name) and used[e] == 1 else e for e in (num, den)
            )
            spared = {n: e for n, e in where if n not in own and used[Name(n)] == 1 and length(e) <= BAR}
            once = {n: e for n, e in spared.items() if isinstance(e, Product | Power)}
            num, den, *rest = (substitute(e, once) for e in (num, den, *lines.values()))
            where = tuple(zip(lines, rest, strict=True))
            num, den = min(self._cleared(num, den), (num, den), key=_bars)
        where = reachable((num, den, *equations), where)
        return PrintedForm("nested", num, den, where, laws)

    def _cleared(self, num: Expression, den: Expression) -> tuple[Expression, Expression]:
        """Return ``A/(Z + B)`` for ``A/Z`` over ``1 + B/Z``."""
        below = [{b: -n for b, n in powers_of(t)[1].items() if n < 0} for t in (*_terms(num), *_terms(den))]
        times = of_powers(Fraction(1), {b: max(p.get(b, 0) for p in below) for own in below for b in own})

        def spread(side: Expression) -> Expression:
            barred = [t for t in _terms(side) if min(powers_of(t)[1].values(), default=0) < 0]
            plain = sum_of(t for t in _terms(side) if t not in barred)
            made = [self._ordered(*powers_of(product_of([t, times]))) for t in (plain, *barred)]
            return sum_of(sorted(made, key=lambda t: isinstance(t, Negative)))

        num = tidied_sum(spread(num), self.order)  # k*T_1*T_2 - k*T_2
        front, powers = powers_of(quotient(num, spread(den)))
        num = self._ordered(Fraction(abs(front.numerator)), {b: n for b, n in powers.items() if n > 0})
        den = self._ordered(Fraction(front.denominator), {b: -n for b, n in powers.items() if n < 0})
        return _negated(num) if front < 0 else num, den

    def _ordered(self, front: Fraction, powers: Mapping[Expression, int]) -> Expression:
        return of_powers(front, {b: powers[b] for b in sorted(powers, key=self._place)})

    def _law(self, function: tuple[str, Waves]) -> tuple[str, Equation]:
        """Return the differential equation of a fundamental function."""
        name, waves = function
        order = len(waves.coefficients)
        terms: list[Expression] = [Derivative(name, order)]
        for k in reversed(range(order)):
            if waves.coefficients[k] != ZERO:
                state = Derivative(name, k) if k else Name(name)
                terms.append(_times(self.known[waves.coefficients[k]], state))
        return name, Equation(Sum(tuple(terms)), number(0))

    def _function(self, waves: Waves, order: int) -> Expression:
        """Return a fundamental function at its length."""
        length = self.known[waves.length]
        if order >= 0:
            return Call(self.functions[waves.coefficients][0], length, order)
        return Call("exp", _negated(of_powers(*powers_of(Product((length, self.known[waves.shift]))))))

    def _made(self, i: int) -> Expression:
        program = self.tf.program
        operands = program.operands[i]
        match program.kinds[i]:
            case Step.GENERATOR:
                if operands[0] in self.tf.wave_of:
                    waves, place = self.tf.wave_of[operands[0]]
                    return self._function(waves, waves.generators[place][1])
                name = program.names[operands[0]]
                return self.symbols.get(name, Name(name))
            case Step.NUMBER:
                return Number(program.fraction(i))
            case Step.NEGATE:
                return _negated(self.known[operands[0]])
            case Step.POWER:
                return Power(self.known[operands[0]], number(operands[1]))
            case Step.ADD:
                return self._sum([self.known[x] for x in operands])
            case _:
                return self._product(i, operands)

    def _sum(self, terms: Sequence[Expression]) -> Expression:
        flat: list[Expression] = []
        for term in terms:
            if isinstance(term, Sum):
                flat += term.terms
            elif isinstance(term, Negative) and isinstance(term.operand, Sum):
                flat += [_negated(t) for t in term.operand.terms]
            else:
                flat.append(term)
        while opposite := {t.operand for t in flat if isinstance(t, Negative)}.intersection(flat):
            for term in opposite:
                flat.remove(term)
                flat.remove(Negative(term))
        if len(flat) <= 1:
            return flat[0] if flat else number(0)
        first = next((n for n, t in enumerate(flat) if not isinstance(t, Negative)), 0)
        flat.insert(0, flat.pop(first))
        if len(flat) <= LONGEST_SUM:
            return Sum(tuple(flat))
        parts: list[Expression] = []
        taken = {name for name, _ in self.lines} | set(self.names.values()) | names_of(self.tf.model)
        for start in range(0, len(flat), LONGEST_SUM):
            name = next(n for k in count(self.sums + 1) if (n := f"R_{k}") not in taken)
            self.sums += 1
            taken.add(name)
            self.lines.append((name, Sum(tuple(flat[start : start + LONGEST_SUM]))))
            parts.append(Name(name))
        return self._sum(parts)

    def _product(self, i: int, operands: Sequence[int]) -> Expression:
        """Return a product or quotient with everything that is divided by below one bar."""
        is_quotient = self.tf.program.kinds[i] == Step.DIVIDE
        above: list[Expression] = []
        below: list[Expression] = []
        for n, x in enumerate(operands):
            over, under = self.split.get(x, ((self.known[x],), ()))
            if is_quotient and n == 1:
                over, under = under, over
            above += over
            below += under
        ratio, all_powers = powers_of(Quotient(_multiplied(above), _multiplied(below)))
        powers = self._with_sums_cleared(all_powers)
        above = [power(base, n) for base, n in powers.items() if n > 0]
        below = [power(base, -n) for base, n in powers.items() if n < 0]
        turned = next((n for n, f in enumerate(above) if isinstance(f, Sum) and _turned(f) is not f), None)
        if ratio < 0 and turned is not None:
            ratio, above[turned] = -ratio, _turned(above[turned])
        if ratio.numerator == 1 != ratio:
            below.append(Number(1 / ratio))
        elif ratio != 1:
            above.append(Number(ratio))
        above, below = sorted(above, key=self._place), sorted(below, key=self._place)
        self.split[i] = (tuple(above), tuple(below))
        top = _multiplied(above)
        return Quotient(top, _multiplied(below)) if below else top

    def _with_sums_cleared(self, powers: Mapping[Expression, int]) -> Mapping[Expression, int]:
        """Return ``1/(L*s + R)`` for ``1/(L*R*s*(1/(L*s) + 1/R))``: what sums divide by and is a factor."""
        for total, n in [(b, n) for b, n in powers.items() if isinstance(b, Sum) and abs(n) == 1]:
            inner = [powers_of(term)[1] for term in total.terms]
            divisors = {b: max(-p.get(b, 0) for p in inner) for p in inner for b, m in p.items() if m < 0}
            if divisors and all(powers.get(b, 0) * n >= m for b, m in divisors.items()):
                times = of_powers(Fraction(1), divisors)
                terms = [self._ordered(*powers_of(product_of([t, times]))) for t in total.terms]
                cleared = sum_of(sorted(terms, key=lambda t: -power_of_s(t)))
                rest = {b: m - n * divisors.get(b, 0) for b, m in powers.items() if b != total}
                powers = {b: m for b, m in rest.items() if m} | {cleared: n}
        return powers

    def _place(self, factor: Expression) -> tuple[int, int]:
        """Return what sorts factors: numbers, parameters as declared, powers of s, and then the rest."""
        base = factor.base if isinstance(factor, Power) else factor
        if isinstance(base, Number):
            return 0, 0
        if isinstance(base, Name) and base.name in self.order:
            return 1, self.order[base.name]
        return 2, 0


def _terms(side: Expression) -> tuple[Expression, ...]:
    return side.terms if isinstance(side, Sum) else (side,)


def _bars(sides: tuple[Expression, Expression]) -> int:
    """Return the length of a fraction, and more where it has a bar to spare."""
    has_bar = any(isinstance(e.operand if isinstance(e, Negative) else e, Quotient) for e in sides)
    return length(*sides) + BAR * has_bar


def _multiplied(factors: Sequence[Expression]) -> Expression:
    if not factors:
        return number(1)
    return factors[0] if len(factors) == 1 else Product(tuple(factors))


def _times(left: Expression, right: Expression) -> Expression:
    """Return a product of two factors, a sign in front."""
    if isinstance(left, Negative):
        return _negated(_times(left.operand, right))
    if isinstance(left, Quotient):
        return Quotient(_times(left.numerator, right), left.denominator)
    if left == number(1):
        return right
    return Product((*left.factors, right) if isinstance(left, Product) else (left, right))


def _negated(expression: Expression) -> Expression:
    turned = _turned(expression)
    return Negative(expression) if turned is expression else turned


def _turned(expression: Expression) -> Expression:
    """Return minus an expression that has a minus sign, another one as it is."""
    match expression:
        case Negative(operand):
            return operand
        case Sum(terms) if any(isinstance(t, Negative) for t in terms):
            return Sum(tuple(sorted(map(_negated, terms), key=lambda t: isinstance(t, Negative))))
    return expression
