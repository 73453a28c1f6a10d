"""Propagators, normal forms, exponential coordinates and orders of vanishing, against mpmath."""

from __future__ import annotations

from itertools import islice, product

import mpmath as mp
import pytest

from symflex.kernels import Dispersion, Factored, Ring, propagate
from symflex.kernels.exponentials import Exponentials
from symflex.kernels.multiple_angles import lift
from symflex.kernels.normal_form import NormalForm
from symflex.kernels.origin import Origin
from symflex.kernels.taylor import TaylorField, primes, square_root
from symflex.kernels.vanishing import Vanishing
from symflex.transfer.cancel import cancel
from symflex.transfer.distributed import embedded_table

BASE = Ring(("s", "r", "p", "l", "x"))
S, R, P, L, X = (Factored.generator(BASE, name) for name in BASE.names)
ZERO = S * 0
KINDS = {
    "wave": (R * S**2 * -1, ZERO),
    "bending": (R * S**2, ZERO, ZERO, ZERO),
    "pair": (R * S**2, ZERO, P * S**2 * -1 - R, ZERO),
    "general": (R * S**2, P, S, R),
}
POINT = {
    "s": mp.mpc("0.7", "1.9"),
    "r": mp.mpf("1.3"),
    "p": mp.mpf("0.6"),
    "l": mp.mpf("1.1"),
    "x": mp.mpf("0.4"),
}


def propagation(kind, lengths=(L, X, L - X)):
    return propagate(BASE, [(Dispersion("w", kind, KINDS[kind], ZERO), list(lengths))])


def embedded(found):
    """The table of a propagation over its ring of kernels."""
    ring, table = found.kernel_ring, found.table
    gens = ring.context.gens()[: len(BASE.names)]

    def over(v):
        factors = tuple((f.compose(*gens, ctx=ring.context), e) for f, e in v.factors)
        return Factored(ring, v.unit, factors)

    return embedded_table(table, [(v, over(v)) for v in table.values])


def value(factored, values):
    total = mp.mpf(factored.unit.numerator) / factored.unit.denominator
    for polynomial, exponent in factored.factors:
        total *= polynomial_value(polynomial, factored.ring.names, values) ** exponent
    return total


def polynomial_value(polynomial, names, values):
    return mp.fsum(
        int(c) * mp.fprod(values[n] ** int(e) for n, e in zip(names, m, strict=True) if e)
        for m, c in polynomial.terms()
    )


def fundamental(kind, length):
    """h, h', ... from the exponential of the companion matrix."""
    c = [value(k, POINT) for k in KINDS[kind]]
    n = len(c)
    companion = mp.matrix(n, n)
    for i in range(n - 1):
        companion[i, i + 1] = 1
    for j in range(n):
        companion[n - 1, j] = -c[j]
    grown = mp.expm(companion * length, method="taylor")
    return [grown[i, n - 1] for i in range(n)]


def generator_values(found):
    values = dict(POINT)
    for law in found.table.dispersions:
        c = [value(k, POINT) for k in law.characteristic]
        if law.kind == "wave":
            waves = [mp.sqrt(-c[0])]
        elif law.kind == "bending":
            waves = [mp.root(c[0] / 4, 4)]
        elif law.kind == "pair":
            root = mp.sqrt(c[2] ** 2 / 4 - c[0])
            waves = [mp.sqrt(-c[2] / 2 + root), mp.sqrt(-c[2] / 2 - root)]
        else:
            waves = []
        values.update(zip(law.wavenumbers, waves, strict=True))
    for kernel in found.table.kernels:
        length = value(kernel.length, POINT)
        if kernel.function == "fundamental":
            values[kernel.generator] = fundamental("general", length)[kernel.order]
        else:
            values[kernel.generator] = getattr(mp, kernel.function)(values[kernel.wavenumber] * length)
    for p in found.propagators:
        values[p.generator] = polynomial_value(p.image, found.kernel_ring.names, values)
    return values


@pytest.fixture(autouse=True)
def _precision():
    with mp.workdps(40):
        yield


@pytest.mark.parametrize("kind", list(KINDS))
@pytest.mark.parametrize("length", [L, X, L - X], ids=str)
def test_fundamental_functions_are_those_of_the_companion_matrix(kind, length):
    found = propagation(kind)
    values = generator_values(found)
    expected = fundamental(kind, value(length, POINT))
    for h, wanted in zip(found.fundamental(0, length), expected, strict=True):
        assert mp.almosteq(value(h, values), wanted, 1e-30)


def test_at_length_zero_only_the_highest_derivative_is_one():
    assert [str(h) for h in propagation("bending").fundamental(0, ZERO)] == ["0", "0", "0", "1"]


@pytest.mark.parametrize("kind", ["wave", "bending", "pair"])
def test_normal_form_keeps_the_value(kind):
    found = propagation(kind, (L,))
    values = generator_values(found)
    normal = NormalForm(found.kernel_ring, embedded(found))
    gens = [found.kernel_ring.generator(g) for g in found.table.generators]
    polynomial = (gens[0] + 2 * gens[-1] ** 3 + 3 * gens[1] ** 5 - gens[-2] * gens[0] ** 6) ** 2
    before = polynomial_value(polynomial, found.kernel_ring.names, values)
    assert mp.almosteq(value(normal.reduce(polynomial), values), before, 1e-28)


@pytest.mark.parametrize("kind", ["wave", "bending", "pair"])
def test_what_the_relations_make_zero_is_zero(kind):
    found = propagation(kind, (L,))
    table = embedded(found)
    normal = NormalForm(found.kernel_ring, table)
    for kernel in found.table.kernels:
        if kernel.function not in ("cosh", "cos"):
            continue
        odd = {"cosh": "sinh", "cos": "sin"}[kernel.function]
        c = found.kernel_ring.generator(kernel.generator)
        s = found.kernel_ring.generator(kernel.generator.replace(kernel.function, odd))
        one = c * c - s * s if kernel.function == "cosh" else c * c + s * s
        assert normal.reduce(one**3 - 1).is_zero
    law = table.dispersions[0]
    waves = [Factored.generator(found.kernel_ring, w) for w in law.wavenumbers]
    c = law.characteristic
    relation = {
        "wave": lambda: waves[0] ** 2 + c[0],
        "bending": lambda: waves[0] ** 4 * 4 - c[0],
        "pair": lambda: waves[0] ** 4 + c[2] * waves[0] ** 2 + c[0],
    }[kind]()
    assert normal.reduce_factored(relation).is_zero


@pytest.mark.parametrize("kind", ["wave", "bending", "pair"])
def test_exponential_coordinates_are_restored(kind):
    found = propagation(kind, (L, X))
    change = Exponentials(found.kernel_ring, found.table)
    normal = NormalForm(found.kernel_ring, embedded(found))
    for p in found.propagators:
        transformed = change.transform(p.image)
        back = Factored.number(found.kernel_ring, transformed.unit)
        for factor, exponent in transformed.factors:
            names = [a.coordinates[0] for a in change.angles if a.kind == "hyperbolic"]
            if any(factor == change.coordinates.generator(n) for n in names):
                continue
            if any(change.parity(factor)):
                break
            restored, _ = change.restore(factor)
            back = back * restored**exponent
        else:
            assert (normal.reduce_factored(back) - normal.reduce(p.image)).is_zero


def test_a_product_of_half_angles_is_found_as_a_common_factor():
    found = propagation("wave", (L,))
    change = Exponentials(found.kernel_ring, found.table)
    c, s = (found.kernel_ring.generator(k.generator) for k in found.table.kernels)
    _, common = cancel(change.transform(s).numerator(), change.transform(c - 1).numerator())
    ((half, power),) = common.factors
    assert power == 1
    assert change.parity(half) == (1,)


@pytest.mark.parametrize(
    ("function", "order"),
    [
        (lambda c, s, co, si: c * si - s * co, 3),
        (lambda c, s, co, si: c * si + s * co, 1),
        (lambda c, s, co, si: s * si, 2),
        (lambda c, s, co, si: c * co - 1, 4),
        (lambda c, s, co, si: c * co, 0),
    ],
)
def test_the_order_at_a_zero_wavenumber_is_that_of_the_taylor_series(function, order):
    found = propagation("bending", (L,))
    kernels = [found.kernel_ring.generator(k.generator) for k in found.table.kernels]
    vanishing = Vanishing(found.kernel_ring, found.table, [()])
    assert vanishing.at_zero(function(*kernels), found.table.wavenumbers[0]) == order


@pytest.mark.parametrize(("power", "order"), [(0, 0), (4, 2), (8, 4)])
def test_orders_at_the_origin_follow_the_dispersion_relation(power, order):
    found = propagation("bending", (L,))
    origin = Origin(found.kernel_ring, embedded(found))
    assert origin.order(Factored.generator(found.kernel_ring, "mu[0]") ** power) == order


def test_square_roots_modulo_primes_are_roots_or_do_not_exist():
    for prime, number in product(islice(primes(), 3), range(2, 40)):
        root = square_root(number, prime)
        squares = pow(number, (prime - 1) // 2, prime) == 1
        assert (root is not None) == squares
        if root is not None:
            assert root * root % prime == number


def test_series_roots_square_back():
    field = TaylorField(12)
    series = field.power(4) * 9 + field.power(7) * 5
    root = field.root(series)
    assert root is not None
    assert (
        field.times(root, root) == series.truncate(12) or field.order(field.times(root, root) - series) >= 10
    )


@pytest.mark.parametrize("kind", ["hyperbolic", "circular"])
@pytest.mark.parametrize("n", [2, 3, 4])
def test_what_holds_only_multiples_of_an_angle_is_rewritten_in_the_multiple(kind, n):
    found = propagation("bending", (L,))
    ring = found.kernel_ring
    angle = next(a for a in Exponentials(ring, found.table).angles if a.kind == kind)
    c, s = ring.generator(angle.even.generator), ring.generator(angle.odd.generator)
    even, odd = ring.constant(1), ring.constant(0)
    sign = 1 if kind == "hyperbolic" else -1
    for _ in range(n):
        even, odd = even * c + sign * (odd * s), odd * c + even * s
    normal = NormalForm(ring, embedded(found))
    polynomial = normal.reduce(3 * even**2 - 2 * even * odd + 5 * odd + 7)
    ((plain, _),) = polynomial.factors
    lifted = lift(ring, plain, angle, n)
    assert lifted is not None
    assert (lifted * polynomial.unit - normal.reduce(3 * c**2 - 2 * c * s + 5 * s + 7)).is_zero


def test_what_holds_other_multiples_is_not():
    found = propagation("wave", (L,))
    ring = found.kernel_ring
    (angle,) = Exponentials(ring, found.table).angles
    c, s = ring.generator(angle.even.generator), ring.generator(angle.odd.generator)
    assert lift(ring, c**2 + s, angle, 2) is None
    assert lift(ring, c**2 + c, angle, 3) is None
