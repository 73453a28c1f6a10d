"""Short formulas: a transfer function with fewer terms, whose coefficients are proved to change little.

Input: a transfer function, a bound, and the ends of the parameters that may be off.
Output: the shortest print that was found whose coefficients of s keep within the bound, and its distance.

    m_1 m_2 s^2 + k (m_1 + m_2)   with m_2 = m_1/200 and 1 %   ->   m_1 m_2 s^2 + k m_1 = m_1 (m_2 s^2 + k)

Terms of one sign add up to ``P(x) >= P(x_0) prod(t_i^a_i)`` where every letter is ``t_i`` times its value and
``a_i`` is the mean of its exponents, weighted by the terms at the values (the inequality of arithmetic and
geometric means). So a term M is at most ``M(x_0)/P(x_0) prod(t_i^(e_i - a_i))`` of them, each factor at one
end of its letter. Terms of the other sign take away what they are at most.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from math import inf, prod

from flint import acb, acb_poly, arb, fmpz_mpoly

from symflex.algebra import Factored
from symflex.algebra.ring import irreducible_factors
from symflex.algebra.vanishing import OriginSeries
from symflex.balls import at_centre, ball, precision
from symflex.budget import spend
from symflex.errors import BudgetError, Diagnostic, ModelError, UsageError, counted
from symflex.model import spread_box
from symflex.model.model import IMAGINARY
from symflex.options import DeriveOptions, share_of
from symflex.print.forms import PrintedForm, print_form
from symflex.print.forms.arrange import length
from symflex.print.forms.printed import Approximation, terms_of
from symflex.print.forms.shapes import shaped
from symflex.print.read_back import read_back
from symflex.roots import PoleZeroMap
from symflex.symbolic.distance import BITS, alike, band_of, distance, moved_over, percent, roots_of, upper
from symflex.symbolic.nested import NestedForm, Parts
from symflex.symbolic.order import truncated
from symflex.transfer import AnyTransferFunction, BoundTransferFunction, TransferFunction, bind
from symflex.transfer.bind import values_for
from symflex.transfer.bound import EnclosedTransferFunction
from symflex.transfer.enclose import enclose, enclosure
from symflex.transfer.lowest_terms import cancel

Key = tuple[int, ...]
Term = tuple[tuple[int, ...], int]
Share = tuple[arb, int]
Box = Mapping[str, tuple[Fraction, Fraction]]
Image = tuple[fmpz_mpoly, Factored, int]  # a factor, the shorter one in its place, and its exponent
Maps = tuple[PoleZeroMap, PoleZeroMap]
"""A short function, its print, and the changes of a coefficient at the values and over the box."""

MOST_NESTED = 4_000  # terms up to which every term of a print is compared over a box: in ten seconds
MOST_TERMS = 20_000  # terms of a side up to which coefficients are compared, in about ten seconds
FACTORED_TERMS = 120  # terms of a shortened polynomial up to which it is tried whether it has factors now
BUDGETS = (1.0, 0.85, 0.7, 0.5, 0.35, 0.25, 0.15, 0.1, 0.05, 0.0)
"""Shares of the bound that are tried for each factor of a product."""
COARSE = 0.002  # shortest piece of a band, as a share of its logarithm, that is examined over a box
TINY = 2.0**-60  # relative radius up to which a value counts as one number


@dataclass(frozen=True, eq=False)
class _Letters:
    """The generators of a ring that have values, and how far these may be off."""

    keys: tuple[int, ...]  # positions of the others: s, wavenumbers, kernels, the imaginary unit
    values: Mapping[int, arb]
    ends: Mapping[int, tuple[arb, arb]]  # logarithms of what they may be multiplied by
    box: Box

    @staticmethod
    def of(tf: TransferFunction, box: Box) -> _Letters:
        """Return the letters of a function."""
        known = {"pi": arb.pi()} | {p.name: enclosure(p.value)() for p in tf.model.parameters if p.value}
        wide = {n: ball(box[n][0]).union(ball(box[n][1])) if n in box else v for n, v in known.items()}
        known.pop(IMAGINARY, None)
        for values in (known, wide):
            for constant in tf.constants:
                each = {name: (lambda v=v: v) for name, v in values.items()}
                try:
                    values[constant.generator] = enclose(constant.expression, each)
                except (ModelError, KeyError):
                    continue  # of parameters without value, or wider than the function is defined
        index, ends = tf.ratio.ring.index, {}
        for name in index.keys() & known.keys():
            scale = wide.get(name, arb("nan")) / known[name]
            if known[name] != 0 and not scale.rad() < TINY:
                ends[index[name]] = scale.lower().log(), scale.upper().log()
        keys = tuple(i for name, i in index.items() if name not in known)
        return _Letters(keys, {index[n]: v for n, v in known.items() if n in index}, ends, box)

    def groups(self, polynomial: fmpz_mpoly) -> dict[Key, list[Term]]:
        """Return the terms of each coefficient of s and of kernels."""
        groups: dict[Key, list[Term]] = {}
        for monomial, number in polynomial.terms():
            exponents = tuple(map(int, monomial))
            groups.setdefault(tuple(exponents[i] for i in self.keys), []).append((exponents, int(number)))
        return groups

    def value(self, term: Term) -> arb:
        """Return a term of a coefficient at the values."""
        return prod((v ** term[0][i] for i, v in self.values.items() if term[0][i]), start=arb(term[1]))

    def shares(self, coefficient: Sequence[Term], wanted: Sequence[Term]) -> list[Share]:
        """Return how large terms are at most beside a whole coefficient, and their signs; nan if unknown."""
        sizes = [(term, self.value(term)) for term in coefficient]
        sign = 1 if sum((v for _, v in sizes), arb(0)) > 0 else -1
        main = [(term, v) for term, v in sizes if v * sign > 0]
        weight = sum((v for _, v in main), arb(0))
        means = {i: sum((v * m[i] for (m, _), v in main), arb(0)) / weight for i in self.ends}

        def share(term: Term, size: arb) -> arb:
            grows = arb(0)
            for i, (low, high) in self.ends.items():
                exponent = term[0][i] - means[i]
                grows += (exponent * low).max(exponent * high)
            return abs(size / weight) * grows.exp()

        floor = 1 - sum((share(*each) for each in sizes if not each[1] * sign > 0), arb(0))
        floor = floor if floor > 0 else arb("nan")
        found = [(term, self.value(term)) for term in wanted]
        return [(share(t, v) / floor, 1 if v > 0 else -1) for t, v in found]

    def change(self, before: fmpz_mpoly, after: fmpz_mpoly) -> tuple[float, float]:
        """Return the largest relative change of a coefficient, at the values and over the box, rounded up."""
        gone, groups_before, worst = self.groups(before - after), self.groups(before), (0.0, 0.0)
        for key, terms in gone.items():
            spend()
            if key not in groups_before:  # its terms had cancelled
                return inf, inf
            total = sum(map(self.value, groups_before[key]), arb(0))
            each = (
                abs(sum(map(self.value, terms), arb(0)) / total),
                _most(self.shares(groups_before[key], terms)),
            )
            worst = max(worst[0], upper(each[0])), max(worst[1], upper(each[1]))
        return worst

    def displacement(self, before: fmpz_mpoly, after: fmpz_mpoly, high: float) -> float:
        """Return how far roots up to a frequency [Hz] move over the box, relative to them; inf if unknown."""
        groups = self.groups(before), self.groups(before - after)
        least, (top, *others) = min(groups[0])[0], map(max, zip(*groups[0], strict=True))
        if not groups[1] or any(others):
            return inf if groups[1] else 0.0
        terms_before, gone = (
            [(key[0] - least, acb(self.value(t)), [t[0][i] for i in self.ends]) for key in g for t in g[key]]
            for g in groups
        )
        side = [sum((v for n, v, _ in terms_before if n == k), arb(0)) for k in range(top - least + 1)]
        try:
            roots = acb_poly(side).roots()
        except ValueError:  # some root is a multiple one
            return inf
        shown = [r for r in roots if not (r.imag < 0 or abs(r) > 2 * arb.pi() * high)]
        halves = [abs(a).max(abs(b)) for a, b in self.ends.values()]
        return max((moved_over(terms_before, gone, r, halves) for r in shown), default=0.0)


def _most(shares: Sequence[Share]) -> arb:
    """Return a bound of a sum of terms, of which those of either sign may be next to nothing."""
    one, other = (sum((x for x, each in shares if each == sign), arb(0)) for sign in (1, -1))
    return one.max(other)


class _Pruned:
    """A polynomial of one side, and which of its terms may go."""

    def __init__(self, polynomial: fmpz_mpoly, exponent: int, letters: _Letters) -> None:
        self.polynomial, self.exponent = polynomial, exponent
        self.inner = letters.keys[1:]  # positions of kernels
        self.whole: set[Key] = set()  # coefficients that stay as they are
        groups = letters.groups(polynomial)
        self.shares = {key: [*zip(letters.shares(g, g), g, strict=True)] for key, g in groups.items()}
        for shares in self.shares.values():
            shares.sort(key=lambda each: upper(each[0][0]))

    def gone(self, most: float) -> dict[Key, list[tuple[Share, Term]]]:
        """Return the terms that go where every coefficient may change by so much, at most all but one."""
        gone: dict[Key, list[tuple[Share, Term]]] = {}
        for key in self.shares.keys() - self.whole:
            for each in self.shares[key][:-1]:
                if not _most([share for share, _ in (*gone.get(key, ()), each)]) < most:
                    break
                gone.setdefault(key, []).append(each)
        # A sum of kernels is a function of s only with all its terms: those with the same letters.
        there = Counter(self.letters_of(term) for shares in self.shares.values() for _, term in shares)
        there.subtract(self.letters_of(term) for pruned in gone.values() for _, term in pruned)
        kept = (
            (key, [each for each in pruned if not there[self.letters_of(each[1])]])
            for key, pruned in gone.items()
        )
        return {key: pruned for key, pruned in kept if pruned}

    def letters_of(self, term: Term) -> tuple[int, ...]:
        """Return the exponents of letters and s in a term."""
        return tuple(0 if i in self.inner else n for i, n in enumerate(term[0]))


def _sums_of(tf: TransferFunction, letters: _Letters) -> list[_Pruned]:
    """Return the factors that may lose terms."""
    # What kernels of other waves divide by vanishes with them only as a whole.
    is_plain = all(law.kind in ("exponential", "wave", "bending") for law in tf.kernels.dispersions)
    opaque = frozenset() if is_plain else frozenset(tf.kernels.generators)
    factors = [(f, n) for f, n in tf.ratio.factors if len(f) > 1]
    return [_Pruned(f, n, letters) for f, n in factors if not tf.ratio.ring.used_in([f]) & opaque]


def _without(each: _Pruned, gone: Mapping[Key, Sequence[tuple[Share, Term]]]) -> fmpz_mpoly:
    context = each.polynomial.context()
    return each.polynomial - context.from_dict(dict(term for pruned in gone.values() for _, term in pruned))


def _shorter(
    tf: TransferFunction, sums: Sequence[_Pruned], letters: _Letters, most: float
) -> tuple[TransferFunction, tuple[float, float], list[tuple[float, _Pruned, Key]], list[Image]]:
    """Return a function without terms that both sides allow, the changes, what went where, new factors."""
    ring, one = tf.ratio.ring, tf.ratio.ring.constant(1)
    changes: list[tuple[float, float]] = []
    images: list[Image] = []
    dropped: list[tuple[float, _Pruned, Key]] = []
    for sign in (1, -1):
        side = [each for each in sums if each.exponent * sign > 0]
        if prod(len(each.polynomial) ** abs(each.exponent) for each in side) > MOST_TERMS:
            message = f"a side of {tf.name} has more than {MOST_TERMS} terms, which are not compared"
            raise BudgetError(Diagnostic("SF501", message, None, "keep repeated sums in [definitions]"))
        before = prod((each.polynomial ** abs(each.exponent) for each in side), start=one)
        for budget in BUDGETS:
            gone = [each.gone(most * budget) for each in side]
            after = [_without(*pair) for pair in zip(side, gone, strict=True)]
            powers = (p ** abs(each.exponent) for p, each in zip(after, side, strict=True))
            change = letters.change(before, prod(powers, start=one))
            if max(change) <= most:
                break
        changes.append(change)
        for each, pruned, polynomial in zip(side, gone, after, strict=True):
            image = Factored.polynomial(ring, polynomial)
            if pruned and len(polynomial) <= FACTORED_TERMS and not tf.kernels:
                number, factors = irreducible_factors(polynomial)
                image = Factored(ring, Fraction(number), tuple(factors))
            images.append((each.polynomial, image, each.exponent))
            dropped += [(upper(_most([x for x, _ in terms])), each, key) for key, terms in pruned.items()]

    def shorter(factor: fmpz_mpoly) -> Factored:
        return next((new for old, new, _ in images if old == factor), Factored.polynomial(ring, factor))

    parts = (tf.num.map_factors(ring, shorter), tf.den.map_factors(ring, shorter)) if tf.parts else None
    ratio = tf.ratio.map_factors(ring, shorter)
    short = replace(tf, reduced=ratio, closed=None, hidden=(), parts=parts, solve=None)
    return short, (max(x for x, _ in changes), max(x for _, x in changes)), dropped, images


@dataclass(frozen=True, slots=True)
class _Candidate:
    """A function that may be shown in place of the exact one."""

    tf: TransferFunction
    images: Sequence[Image]  # what its factors were, and are
    changes: tuple[float, float]  # of its coefficients, at the values and over the spread
    printed: PrintedForm | None = None
    kept: int = 0  # parts that stay whole
    roots: PoleZeroMap | None = None

    @property
    def print(self) -> PrintedForm:
        """How it prints."""
        assert self.printed is not None
        return self.printed

    def size(self) -> float:
        """Return how long it prints."""
        return length(self.print.num, self.print.den, *dict(self.print.where).values())


def _by_coefficients(
    tf: TransferFunction, sums: Sequence[_Pruned], letters: _Letters, most: float
) -> Iterator[_Candidate]:
    """Yield functions without monomials, one more coefficient kept whole each time."""
    while True:
        with precision(BITS):
            short, changes, dropped, images = _shorter(tf, sums, letters, most)
        if not dropped:
            return
        yield _Candidate(short, images, changes)
        _, owner, key = max(dropped, key=lambda each: each[0])
        owner.whole.add(key)


def _by_print(
    tf: TransferFunction, form: PrintedForm, letters: _Letters, most: float, has_box: bool
) -> Iterator[_Candidate]:
    """Yield prints without terms of sums, also those in lines below, one more term kept each time."""
    values = {n: letters.values[i] for n, i in tf.ratio.ring.index.items() if i in letters.values}
    nested = NestedForm(form, tf.ratio.ring, values)
    if not tf.is_rational or tf.model.root is not None or (has_box and terms_of(tf.ratio) > MOST_NESTED):
        return

    def images(parts: Parts) -> list[Image]:
        (_, *before), (_, *after) = nested.sides(nested.parts), nested.sides(parts)
        both = zip(before, after, (1, -1), strict=True)
        pairs = ((x.numerator() * y.denominator(), y.numerator() * x.denominator(), n) for x, y, n in both)
        return [(old.expand(), new, n) for old, new, n in pairs]

    def over_box(parts: Parts) -> float:
        if not has_box or nested.sides(parts)[0]:  # of functions nothing is proved over a box
            return inf if has_box else 0.0
        return max(letters.change(x, y.expand())[1] for x, y, _ in images(parts))

    with precision(BITS):
        found = nested.without(most, over_box)
    for parts, change in found[::-1]:
        constants, num, den = nested.sides(parts)
        ratio, _ = cancel(num.numerator() * den.denominator(), num.denominator() * den.numerator())
        short = replace(tf, reduced=ratio, closed=None, hidden=(), parts=None, solve=None)
        short = replace(short, constants=(*tf.constants, *constants))
        printed = shaped(tf.model, nested.shown(parts))
        read_back(short, printed)
        with precision(BITS):
            changes = (change, max(change, over_box(parts)))
            yield _Candidate(short, images(parts) if has_box else (), changes, printed)


def _apart(tf: TransferFunction, short: _Candidate, letters: _Letters, roots: Maps) -> Approximation:
    """Return how far a short function is from the other, also over a box."""
    exact, after, images, box = bind(tf), bind(short.tf), short.images, letters.box
    band = band_of(exact, roots[0])
    if not box or tf.model.root is not None:
        return distance(exact, after, roots, over_box=(inf, inf) if box else (None, None))
    fixed = tuple((name, partial(arb, ball(low).union(ball(high)))) for name, (low, high) in box.items())
    others = tuple((p.name, p.value) for p in tf.model.parameters if p.value and p.name not in box)
    kernels = BoundTransferFunction(tf, others, tf.ratio, (), tf.kernels, fixed=fixed).kernel_values()
    lost = [((Factored.polynomial(tf.ratio.ring, old) - new) / new, n) for old, new, n in images]

    def quotient(low: float, high: float) -> acb:
        at = kernels.at(acb(0, 2 * arb.pi() * arb(low).union(arb(high))))
        return prod((at_centre(1 + kernels.value(x, at)) ** -n for x, n in lost), start=acb(1))

    with precision(BITS):
        moves = [(n, letters.displacement(x, y.expand(), band[1])) for x, y, n in images]
        bands, where = alike(quotient, band, COARSE)
    most = [max((x for n, x in moves if n * sign > 0), default=0.0) for sign in (-1, 1)]
    apart, facts = distance(exact, after, roots, over_box=most), {"within_1_db_over_spread_hz": bands}
    return Approximation((*apart.said, f"magnitude over the spread {where}"), apart.facts | facts)


def _counts(located: PoleZeroMap, end: float) -> list[int]:
    """Return the numbers of roots up to a frequency on the right; of a rational function also on the axis."""
    sides = [[r for r in side for _ in range(r.multiplicity)] for side in (located.poles, located.zeros)]
    right = [sum(bool(r.re > 0) and r.frequency_hz() <= end for r in side) for side in sides]
    if located.is_infinite:
        return right
    return [*right, *(sum(r.re.contains(0) for r in side) for side in sides), *map(len, sides)]


def _at_rest(tf: TransferFunction) -> list[int | None]:
    """Return the orders of numerator and denominator at s = 0, of functions with kernels."""
    series = OriginSeries(tf.ratio.ring, tf.kernels) if tf.kernels else None
    return [series.order(part) if series else None for part in (tf.num, tf.den)]


def shortened(
    tf: TransferFunction, most: Fraction, share: Fraction | None = None, form: str | None = None
) -> tuple[TransferFunction, PrintedForm]:
    """Return a function with as few terms as a bound on its coefficients allows.

    ``share`` is the spread of every parameter; by default each has its own. Raises ModelError: SF229 for a
    parameter without value; BudgetError: SF501 for a side of too many terms.
    """
    values_for(tf.model, tf.parameters, {})
    has_box = share is not None or any(p.spread is not None for p in tf.parameters)
    box = spread_box(tf.parameters, share) if has_box else {}
    bound = bind(tf)
    first, _ = roots_of(bound, bound)
    end = band_of(bound, first)[1]
    with precision(BITS):
        letters = _Letters.of(tf, box)
        sums = _sums_of(tf, letters)
    exact = _Candidate(tf, (), (0.0, 0.0), print_form(tf, form), roots=first)
    ways = [_by_coefficients(tf, sums, letters, float(most))]
    ways += [_by_print(tf, exact.print, letters, float(most), bool(box))] if form is None else []
    at_rest = _at_rest(tf)

    def holds(found: _Candidate) -> _Candidate | None:
        """Return a candidate with its roots, None if one crossed the axis or cancelled."""
        if _at_rest(found.tf) != at_rest:
            return None
        after = bind(found.tf)
        roots = roots_of(bound, after, first)[1]
        if after.symbolic is not None or _counts(first, end) != _counts(roots, end):
            return None
        return replace(found, roots=roots, printed=found.printed or print_form(found.tf, form))

    tried = []
    for way in ways:
        kept = -1
        for kept, found in enumerate(way):
            if (held := holds(found)) is not None:
                tried.append(replace(held, kept=kept))
                break
        else:
            tried.append(replace(exact, kept=kept + 1))
    best = min((*tried, exact), key=_Candidate.size)
    fewest = min(terms_of(each.tf.ratio) for each in (*tried, exact))
    described = _described(tf, best, float(most), fewest, has_box=bool(box))
    if best.tf is not tf and best.roots is not None:
        apart = _apart(tf, best, letters, (first, best.roots))
        described = replace(described, said=described.said + apart.said, facts=described.facts | apart.facts)
    return best.tf, replace(best.print, approximation=described)


def _described(
    tf: TransferFunction, best: _Candidate, most: float, fewest: int, *, has_box: bool
) -> Approximation:
    """Say how many terms went, and what that changed."""
    terms, changes, is_exact = (terms_of(best.tf.ratio), terms_of(tf.ratio)), best.changes, best.tf is tf
    over = f", over the spread by {percent(changes[1])}" if has_box else ""
    said = [f"{terms[0]} of {terms[1]} terms; coefficients change by at most {percent(changes[0])}{over}"]
    if is_exact:
        stay = f"no term can be dropped within {100 * most:g} %: all {terms[1]} stay"
        longer = f"all {terms[1]} terms stay: with {fewest} the formula would be longer"
        said = [longer if fewest < terms[1] else stay if terms[1] > 1 else stay.partition(":")[0]]
    static, before, after = None, bind(tf), bind(best.tf)
    if before.is_rational:
        with precision(BITS):
            unit = acb(ball(after.ratio.unit / before.ratio.unit))
            static = upper(abs(unit * _first(after) / _first(before) - 1))
    if static and static > TINY:
        said.append(f"value for s -> 0: changed by {percent(static)}")
    if best.kept:
        part = counted(best.kept, "part")
        said.append(f"{part} kept whole, as a root would cross the imaginary axis or cancel")
    coefficients = {"nominal": changes[0], "spread": changes[1] if has_box else None}
    facts = {"kind": "short", "bound": most, "terms": [*terms], "coefficients": coefficients}
    facts |= {"static": static, "kept_whole": best.kept}
    return Approximation(tuple(said), facts, is_exact)


def _first(bound: BoundTransferFunction) -> acb:
    """Return the coefficient of the leading term of a rational function at s = 0."""
    made = bound.enclosed(BITS)
    factors = made.factors if isinstance(made, EnclosedTransferFunction) else ()
    return prod((next(c for c in f.coeffs() if not c.is_zero()) ** n for f, n in factors), start=acb(1))


def approximation(tf: AnyTransferFunction, given: DeriveOptions) -> tuple[TransferFunction, PrintedForm]:
    """Return a function as ``--short`` or ``--order`` asks for it; UsageError: SF902 where there is none."""
    if not tf.is_reduced:
        message = f"{tf.name} was derived in nested form, which has no coefficients"
        raise UsageError(Diagnostic("SF902", message, None, "ask for the expanded representation"))
    if (given.short is None) == (given.order is None) or (given.spread is not None and given.short is None):
        message = "--short and --order exclude each other; --spread is for --short"
        raise UsageError(Diagnostic("SF902", message))
    if tf.is_zero:
        return tf, print_form(tf)
    if given.order is not None:
        return truncated(tf, given.order)
    spread = None if given.spread is None else share_of(given.spread, "--spread")
    return shortened(tf, share_of(given.short or "", "--short"), spread, given.form)
