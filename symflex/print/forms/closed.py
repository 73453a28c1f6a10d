r"""Closed forms of fundamental functions whose coefficients vary along x: Bessel's, or hyperbolic ones.

Input: the law ``z' = A(x, s) z`` of a member whose stiffness and mass are powers of one length, the way d
from where they vanish, or exponentials of x. Output: entries of Z as an author would write them.

    a string that hangs from x = 0:  (rhoA*g*(l - x)*w')' = rhoA*s^2*w
    Z_11(0) = I_0(q),  q = 2*s*sqrt(l/g)

Of second order, ``(a u')' = b u`` with ``a ~ d^p`` and ``b ~ d^q``, Lommel's transformation gives (Watson
1944, section 4.31), with ``beta = (q - p + 2)/2`` and ``nu = (1 - p)/(2*beta)``,

    u = d^((1 - p)/2) * I_nu(z) or K_nu(z),   z = d/beta * sqrt(b/a)

Half an odd number for nu, as of cones, leaves cosh and sinh; so do a stiffness and a mass that are the same
exponential. A beam whose stiffness is d^(n + 2) and whose mass is d^n, a wedge or a cone, has the solutions
``d^(-n/2)`` times J_n, Y_n, I_n and K_n of z, where ``z^4 = 16 d^4 c`` at a place where ``w'''' ~ c w``
(Kirchhoff 1879). Their Wronskians, constant along x, make of them the solutions that begin as a unit matrix.

All is said in rates, ``d'/d`` and ``a'/a``, which exponentials have too: with ``d'/d = 0``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import factorial, prod
from typing import Final

from symflex.algebra import Dispersion, Factored, composed, degree_in
from symflex.expressions import (
    Bessel,
    Call,
    Expression,
    Name,
    Negative,
    Quotient,
    negative,
    number,
    power,
    product_of,
    quotient,
    sum_of,
)
from symflex.model.along import COORDINATE, varies_along_x
from symflex.model.linearity import factored_of
from symflex.print.forms.arrange import ProductPrinter, Sides, length_sides
from symflex.print.forms.naming import Naming
from symflex.transfer import TransferFunction

Line = tuple[Expression, Expression]  # what is defined, and what it is
Places = Mapping[Factored, Sequence[tuple[int, int, Expression]]]
"""Per length the rows and columns of entries of a fundamental matrix, and what they are called."""
ONE: Final = number(1)
HALF: Final = Fraction(1, 2)
SIGNS: Final = {"J": (1, -1, 1, 1), "Y": (1, -1, 1, 1), "I": (1, 1, 1, 1), "K": (1, -1, 1, -1)}
"""Signs of w, slope, moment and force: ``(z^-n J_n)' = -z^-n J_(n+1)``, ``(z^n J_n)' = z^n J_(n-1)``."""


class _NoClosedFormError(Exception):
    """The law is none of those that have a closed form here."""


def closed_entries(
    tf: TransferFunction, law: Dispersion, places: Places, naming: Naming, printer: ProductPrinter
) -> tuple[Line, ...]:
    """Return what entries of a fundamental matrix are, and the names in them; nothing if none is known."""
    families = {(2, False): _wave, (2, True): _wave_from_tip, (4, False): _beam, (4, True): _beam_from_tip}
    lines = families.get((law.order, law.singular is not None))
    if lines is None:
        return ()
    functions = {c.generator: c.expression for c in tf.constants}
    try:
        return tuple(lines(_Taper(law, functions, printer, naming), places))
    except _NoClosedFormError:
        return ()


@dataclass(frozen=True, eq=False)
class _Taper:
    """A law whose coefficients are powers of one length, or exponentials of x."""

    law: Dispersion
    functions: Mapping[str, Expression]  # what generators stand for that are functions of parameters and x
    printer: ProductPrinter
    naming: Naming

    @property
    def start(self) -> Factored:
        """Where x begins."""
        return self.law.start[0]

    @cached_property
    def exponentials(self) -> Mapping[str, Factored]:
        """The rates of exponentials in coefficients, by their generators; all are 1 at the start."""
        rates = {}
        for name, function in self.functions.items():
            if not varies_along_x(function) or not any(c.depends_on(name) for c in self._coefficients):
                continue
            if not isinstance(function, Call) or function.name != "exp":
                raise _NoClosedFormError
            try:
                exponent = factored_of(function.argument, self.start.ring)
            except (TypeError, KeyError):
                raise _NoClosedFormError from None
            rates[name] = exponent.slope(COORDINATE)
            if rates[name].depends_on(COORDINATE) or not _put(exponent, self.start).is_zero:
                raise _NoClosedFormError
        return rates

    @cached_property
    def length(self) -> Factored | None:
        """The length that coefficients are powers of, but for a constant."""
        ring = self.start.ring
        x, others = ring.index[COORDINATE], [ring.index[name] for name in self.exponentials]
        factors = [f for c in self._coefficients for f, _ in c.factors]
        if any(len(f) > 1 and degree_in(f, i) for f in factors for i in others):
            raise _NoClosedFormError
        lengths = [f for f in factors if degree_in(f, x)]
        if not lengths:
            return None
        if any(f != lengths[0] for f in lengths) or others or degree_in(lengths[0], x) > 1:
            raise _NoClosedFormError
        return Factored.polynomial(ring, lengths[0])

    @property
    def _coefficients(self) -> list[Factored]:
        return [c for row in self.law.matrix for c in row]

    def at(self, value: Factored, place: Factored) -> Factored:
        """Return it, with ``u' = c v`` and ``v' = b u + e v``, where v is the second state and a'/a = -e."""
        names = [value.ring.generator(name) for name in self.exponentials]
        factors = tuple((f, e) for f, e in value.factors if f not in names)
        return _put(Factored(value.ring, value.unit, factors), place)

    def way(self, place: Factored) -> Factored:
        """Return one over the distance of a place from where the length vanishes; 0 without a length."""
        if self.length is None:
            return place * 0
        distance = _put(self.length, place)
        if distance.is_zero:  # an inertia or a foundation vanishes there, and no stiffness
            raise _NoClosedFormError
        return self.length.slope(COORDINATE) / distance

    def rate(self, value: Factored, way: Factored) -> Factored:
        """Return the derivative of a coefficient over itself where the distance is one over ``way``."""
        x = value.ring.index[COORDINATE]
        total = way * sum(exponent for factor, exponent in value.factors if degree_in(factor, x))
        for name, rate in self.exponentials.items():
            total = total + rate * value.exponent_of(value.ring.generator(name))
        return total

    def ratio(self, length: Factored) -> Factored:
        """Return how often as large as at the start the length that coefficients are powers of becomes."""
        if self.length is None:
            return length**0
        return _put(self.length, self.start + length) / _put(self.length, self.start)

    def grown(self, rate: Factored, length: Factored) -> tuple[Factored, Sides]:
        """Return factors: how often as large as at the start, along a length, what has a rate there is."""
        way = self.way(self.start)
        if rate.is_zero:
            return rate**0, (ONE, ONE)
        if way.is_zero:
            return way**0, (Call("exp", self.printer.quotient(rate * length)), ONE)
        ratio, twice = self.ratio(length), int(_number(rate / way * 2))
        root = ONE if twice % 2 == 0 else Call("sqrt", self.printer.quotient(ratio))
        return ratio ** int(twice / 2), (root, ONE) if twice > 0 else (ONE, root)

    def product(self, *parts: Factored | Sides | Expression) -> Expression:
        """Return the product of all parts as one fraction."""
        values = [p for p in parts if isinstance(p, Factored)]
        sides = [length_sides(self.printer, prod(values[1:], start=values[0]))] if values else []
        for part in parts:
            if not isinstance(part, Factored):
                sides.append(part if isinstance(part, tuple) else (part, ONE))
        return quotient(product_of(above for above, _ in sides), product_of(below for _, below in sides))

    def bessel(self, kind: str, order: Fraction, argument: Expression) -> Bessel:
        """Return a Bessel function of the first or second kind, or a modified one, by a name that is free."""
        name = f"{kind}_{order}" if order.denominator == 1 and order >= 0 else f"{kind}_({order})"
        is_free = name not in self.naming.taken
        return Bessel(name if is_free else f"Bessel{name}", argument, kind=kind, index=order)


def _wave(taper: _Taper, places: Places) -> Iterator[Line]:
    wave = _Wave.at(taper, taper.start)
    if wave.rate.is_zero:
        yield from _exponential(taper, wave, places)
    elif wave.orders[0].denominator == 2 and not wave.way.is_zero:  # noqa: PLR2004  (half an odd number)
        yield from _hyperbolic(taper, wave, places)
    else:
        names = [Name(n) for n in taper.naming.take("q", 1 + len(places))]
        for z, (length, entries) in zip(names[1:], places.items(), strict=True):
            for i, j, called in entries:
                orders = wave.orders[i], wave.orders[1 - j]
                pair = _paired(taper, "IK", orders, (z, names[0]), (1, (-1) ** (i - j)))
                front = wave.slope ** (i - j), _raised(names[0], 1 + i - j)
                yield called, taper.product(*front, *taper.grown(wave.growths[i], length), pair)
        yield names[0], taper.printer.square_root(wave.square)
        for z, length in zip(names[1:], places, strict=True):
            yield z, taper.product(names[0], *taper.grown(wave.rate, length))


@dataclass(frozen=True, slots=True)
class _Wave:
    """An equation of second order, ``(a u')' = b u``, at one place."""

    way: Factored
    rate: Factored  # of z
    square: Factored  # of z; where its rate is 0, of one over a length
    slope: Factored  # the second state is so often ``z I_(nu - 1)(z)`` as the first is ``I_nu(z)``
    growths: tuple[Factored, Factored]  # rates of what Bessel functions are multiplied by
    orders: tuple[Fraction, Fraction]  # of the states
    inner: Factored  # half the rate of a

    @staticmethod
    def at(taper: _Taper, place: Factored) -> _Wave:
        """Return it, with ``u' = c v`` and ``v' = b u + e v``, where v is the second state.

        Of a law in the form ``u'' = b u + e u'``, a is what makes it the other one: a'/a = -e.
        """
        (zero, c), (b, e) = taper.law.matrix
        way = taper.way(place)
        if not zero.is_zero or c.is_zero or b.is_zero:
            raise _NoClosedFormError
        here = taper.at(e, place)
        if not e.is_zero and not (taper.rate(e, way) + way).is_zero:
            raise _NoClosedFormError
        stiffness, mass = -taper.rate(c, way) - here, taper.rate(b, way) - here
        rate = (mass - stiffness) / 2 + way
        across, own = (way - stiffness) / 2, taper.at(c, place)
        square = own * taper.at(b, place)
        growths = across, across - taper.rate(c, way) + rate - way
        if rate.is_zero:
            if not way.is_zero:
                raise _NoClosedFormError
            return _Wave(way, rate, square, 1 / own, growths, (Fraction(0), Fraction(0)), stiffness / 2)
        nu = _number(across / rate)
        orders = (nu, nu - 1) if nu > 0 else (-nu, 1 - nu)
        return _Wave(way, rate, square / rate**2, rate / own, growths, orders, stiffness / 2)


def _exponential(taper: _Taper, wave: _Wave, places: Places) -> Iterator[Line]:
    """Yield lines where stiffness and mass are the same exponential: the coefficients of u'' are constant."""
    names = [Name(n) for n in taper.naming.take("q", len(places))]
    for q, (length, entries) in zip(names, places.items(), strict=True):
        cosh, sinh = Call("cosh", q), (Call("sinh", q), q)
        turn = wave.inner * length
        for i, j, called in entries:
            grown = taper.grown(wave.growths[i], length)
            if i == j:
                yield called, taper.product(*grown, sum_of([cosh, taper.product(turn * (-1) ** i, sinh)]))
            else:
                factor = length / wave.slope if i == 0 else wave.square * wave.slope * length
                yield called, taper.product(factor, *grown, sinh)
    for q, length in zip(names, places, strict=True):
        yield q, taper.printer.square_root((wave.square + wave.inner**2) * length**2)


def _hyperbolic(taper: _Taper, wave: _Wave, places: Places) -> Iterator[Line]:
    """Yield lines in cosh and sinh of ``q = z - z_0``, where orders are half odd numbers.

    With y_m Bessel's polynomials, I_(m + 1/2) is ``(e^z y_m(-1/z) - (-1)^m e^-z y_m(1/z))/sqrt(2 pi z)``, and
    ``K_(m + 1/2)(z) = sqrt(pi/(2 z)) e^-z y_m(1/z)``; in products of both, e^(z + z_0) cancels.
    """
    names = [Name(n) for n in taper.naming.take("q", len(places))]
    beta = int(_number(wave.rate / wave.way))
    for q, (length, entries) in zip(names, places.items(), strict=True):
        ratio = taper.ratio(length)
        far = ratio**beta - 1  # z = q*ratio^beta/far, and z_0 = q/far
        for i, j, called in entries:
            outer = _bessel_polynomial(wave.orders[i], -far / ratio**beta)
            inner = _bessel_polynomial(wave.orders[1 - j], far)
            growth = int(_number(wave.growths[i] / wave.way) - HALF * beta)
            front = (wave.slope / far) ** (i - j) * ratio**growth
            terms = {k: front * 0 for k in range(len(outer) + len(inner) - 1)}
            for m, c in enumerate(outer):
                for n, d in enumerate(inner):
                    terms[m + n] = terms[m + n] + c * d
            yield (
                called,
                sum_of(
                    taper.product(front * c, _raised(q, i - j - k), Call(_even_or_odd(k + i + j), q))
                    for k, c in terms.items()
                    if not c.is_zero
                ),
            )
    for q, length in zip(names, places, strict=True):
        ratio = taper.ratio(length)
        yield q, taper.printer.square_root(wave.square * (ratio**beta - 1) ** 2)


def _wave_from_tip(taper: _Taper, places: Places) -> Iterator[Line]:
    """Yield lines where the stiffness vanishes at the start: ``u = Gamma(n + 1) (2/z)^n I_n(z)``."""
    _check_tip(taper, [0])
    names = [Name(n) for n in taper.naming.take("q", len(places))]
    waves = [_Wave.at(taper, taper.start + length) for length in places]
    for z, wave, entries in zip(names, waves, places.values(), strict=True):
        n, following = wave.orders
        m = int(n)
        if following < n or n.denominator > 2:  # noqa: PLR2004  (another power would need a gamma function)
            raise _NoClosedFormError
        for i, _, called in entries:
            if n == m:
                front = wave.slope**i * factorial(m) * 2**m
                yield called, taper.product(front, _raised(z, i - m), taper.bessel("I", n + i, z))
                continue
            # Here n = m + 1/2, and Gamma(n + 1) is sqrt(pi) times (2 m + 1)!!/2^(m + 1).
            front = wave.slope**i * prod(range(1, 2 * m + 2, 2))
            coefficients = _bessel_polynomial(n + i, front**0 * -1)
            yield (
                called,
                sum_of(
                    taper.product(front * c, _raised(z, i - m - 1 - k), Call(_even_or_odd(m + i + k + 1), z))
                    for k, c in enumerate(coefficients)
                ),
            )
    for z, wave in zip(names, waves, strict=True):
        yield z, taper.printer.square_root(wave.square)


@dataclass(frozen=True, slots=True)
class _Beam:
    """A wedge's or a cone's equations at one place: ``w' = c_0 theta``, and so on to the force."""

    states: tuple[int, ...]  # deflection, slope, moment and force among the states of the law
    thickness: int  # the power n of the length that the mass is
    rates: tuple[Fraction, ...]  # of what Bessel functions are multiplied by, over the length's
    scales: tuple[Factored, ...]  # of the states, over powers of z
    fourth: Factored  # of z/2 the fourth power

    @staticmethod
    def at(taper: _Taper, place: Factored) -> _Beam:
        """Return it. Of the two states that could be the deflection it is the one with n positive."""
        way = taper.way(place)
        for states in ((0, 1, 2, 3), (0, 1, 3, 2), (0, 2, 1, 3), (0, 2, 3, 1), (0, 3, 1, 2), (0, 3, 2, 1)):
            for first in range(len(states)):
                turned = (*states[first:], *states[:first])
                own = [taper.law.matrix[i][j] for i, j in zip(turned, (*turned[1:], turned[0]), strict=True)]
                if way.is_zero or any(c.is_zero for c in own):
                    continue
                powers = [_number(taper.rate(c, way) / way) for c in own]
                n = int(powers[-1])
                if n >= 0 and powers == [0, -n - 2, 0, n]:
                    c = [taper.at(each, place) for each in own]
                    scales = [way**0]
                    for each in c[:-1]:
                        scales.append(scales[-1] * way / 2 / each)
                    rates = (Fraction(-n, 2), Fraction(-n - 1, 2), Fraction(n + 2, 2), Fraction(n + 1, 2))
                    return _Beam(turned, n, rates, tuple(scales), c[0] * c[1] * c[2] * c[3] / way**4)
        raise _NoClosedFormError

    def orders(self, state: int) -> Fraction:
        """Return the order of the Bessel functions of a state."""
        return Fraction(self.thickness + (0, 1, 2, 1)[state])

    def argument(self, taper: _Taper, j: Expression) -> Expression:
        """Return z."""
        if self.fourth.unit > 0:
            return product_of([number(2), Call("sqrt", taper.printer.square_root(self.fourth))])
        root = taper.printer.square_root(-self.fourth)
        above, below = (root.numerator, root.denominator) if isinstance(root, Quotient) else (root, ONE)
        return product_of([number(2), Call("sqrt", negative(quotient(product_of([j, above]), below)))])


def _checked_beam(taper: _Taper, place: Factored) -> _Beam:
    """Return a beam whose law has no more than the four entries that one has."""
    if sum(not c.is_zero for row in taper.law.matrix for c in row) != len(taper.law.matrix):
        raise _NoClosedFormError
    return _Beam.at(taper, place)


def _beam(taper: _Taper, places: Places) -> Iterator[Line]:
    beam = _checked_beam(taper, taper.start)
    names = [Name(n) for n in taper.naming.take("q", 1 + len(places))]
    way = taper.way(taper.start)
    for z, (length, entries) in zip(names[1:], places.items(), strict=True):
        for row, column, called in entries:
            i, j = beam.states.index(row), beam.states.index(column)
            pairs: list[tuple[int, Expression]] = []
            for (first, second), factor in (("JY", Name("pi")), ("IK", number(2))):
                signs = SIGNS[first][i] * SIGNS[second][3 - j], -SIGNS[second][i] * SIGNS[first][3 - j]
                orders = beam.orders(i), beam.orders(3 - j)
                pair = _paired(taper, first + second, orders, (z, names[0]), signs)
                sign, plain = (-1, pair.operand) if isinstance(pair, Negative) else (1, pair)
                pairs.append((sign, product_of([factor, plain])))
            yield (
                called,
                taper.product(
                    beam.scales[i] / beam.scales[j] * Fraction(-((-1) ** j), 4),
                    _raised(names[0], 1 + i - j),
                    *taper.grown(way * beam.rates[i], length),
                    _sum(pairs),
                ),
            )
    j_name = Name(*taper.naming.take("j"))
    yield names[0], beam.argument(taper, j_name)
    for z, length in zip(names[1:], places, strict=True):
        yield z, taper.product(names[0], *taper.grown(way / 2, length))
    yield j_name, Call("sqrt", number(-1))


def _beam_from_tip(taper: _Taper, places: Places) -> Iterator[Line]:
    """Yield lines where the beam ends in an edge or a point: solutions are sums of J and I alone."""
    names = [Name(n) for n in taper.naming.take("q", len(places))]
    beams = [_checked_beam(taper, taper.start + length) for length in places]
    _check_tip(taper, beams[0].states[:2])
    for z, beam, entries in zip(names, beams, places.values(), strict=True):
        n = beam.thickness
        for row, column, called in entries:
            i, j = beam.states.index(row), beam.states.index(column)
            first, second = (taper.bessel(kind, beam.orders(i), z) for kind in "JI")
            total = _sum([(SIGNS["J"][i] * (-1) ** j, first), (1, second)])
            front = beam.scales[i] / beam.scales[j] * factorial(n + j) * Fraction(2) ** (n + j - 1)
            yield called, taper.product(front, _raised(z, i - n - 2 * j), total)
    j_name = Name(*taper.naming.take("j"))
    for z, beam in zip(names, beams, strict=True):
        yield z, beam.argument(taper, j_name)
    yield j_name, Call("sqrt", number(-1))


def _check_tip(taper: _Taper, free: Sequence[int]) -> None:
    """Let pass a start where the length vanishes and each of some states may be 1, others of them being 0."""
    own, length = taper.law.singular, taper.length
    if own is None or length is None or not _put(length, taper.start).is_zero:
        raise _NoClosedFormError
    if set(own.free) != set(free):
        raise _NoClosedFormError
    beginning = own.at_start()
    if any(not (beginning[i][j] - int(i == j)).is_zero for i in free for j in free):
        raise _NoClosedFormError


def _paired(
    taper: _Taper,
    kinds: str,
    orders: tuple[Fraction, Fraction],
    arguments: tuple[Expression, Expression],
    signs: tuple[int, int],
) -> Expression:
    """Return ``+-A_m(z)*B_n(z_0) +- B_m(z)*A_n(z_0)``."""
    return _sum(
        (
            sign,
            product_of([taper.bessel(a, orders[0], arguments[0]), taper.bessel(b, orders[1], arguments[1])]),
        )
        for sign, a, b in zip(signs, kinds, reversed(kinds), strict=True)
    )


def _sum(terms: Iterable[tuple[int, Expression]]) -> Expression:
    """Return a sum of terms with signs, what is positive first."""
    ordered = sorted(terms, key=lambda term: -term[0])
    front = ordered[0][0]
    return product_of([number(front), sum_of(product_of([number(front * sign), e]) for sign, e in ordered)])


def _bessel_polynomial(order: Fraction, x: Factored) -> list[Factored]:
    """Return the coefficients of powers of u in ``y_m(x*u)``, with m one half less than an order.

    ``y_m(x) = sum (m + k)!/((m - k)! k!) (x/2)^k`` (Krall & Frink 1949), and y_(-1) = 1.
    """
    m = max(int(order - HALF), 0)
    return [x**k * Fraction(factorial(m + k), factorial(m - k) * factorial(k) * 2**k) for k in range(m + 1)]


def _even_or_odd(parity: int) -> str:
    return "sinh" if parity % 2 else "cosh"


def _raised(base: Expression, exponent: int) -> Sides:
    """Return numerator and denominator of an integer power."""
    raised = power(base, abs(exponent))
    return (raised, ONE) if exponent >= 0 else (ONE, raised)


def _number(value: Factored) -> Fraction:
    """Return a constant."""
    if not value.is_constant:
        raise _NoClosedFormError
    return value.unit


def _put(value: Factored, place: Factored) -> Factored:
    """Return a function of x at a place."""
    return composed(value, {COORDINATE: place})
